"""One point of a study: a design with some of its values changed, and what both methods say of it."""

import math
from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np

from slopekit.core.codec import json_of, record_of
from slopekit.core.errors import MisfitError, Notice, SlopekitError, fail
from slopekit.core.options import Workplace
from slopekit.core.orientation import number
from slopekit.core.sheet import is_number
from slopekit.design.common import Design
from slopekit.design.parts import Bolt
from slopekit.design.reading.files import with_values
from slopekit.evidence import WithoutBasal
from slopekit.kinds import also_falls_short, cut, factors_of
from slopekit.kinds.protocol import Factors
from slopekit.notices import new_notices
from slopekit.studies.running import Crew, Journal, Record, RowArrays, run_all

Method = Literal["closed_form", "pre_ie"]
_BUG = "E599"
_BAD_INPUT = ("E211", "E212", "E250", "E252", "E253")  # of bolts and forces: blocks there are
_OF_BOLTS = ("E211", "E212")  # a bolt misses the block, or ends within it
WITHOUT_FORCE = Notice("W311", "bolts that miss the block, or end within it, give no force there")
_BROKEN = (ArithmeticError, ValueError, IndexError, np.linalg.LinAlgError)
_OF_FACTORS = tuple(field.name for field in fields(Factors) if field.name not in ("notes", "also"))
SAME_FACTOR = 1e-9  # of a target: a factor this near below it reaches it
#: The status where PRE-IE ended without a number that it would vouch for.
UNSETTLED = "not_converged"


@dataclass(frozen=True)
class Point:
    """What a design with other values comes to: its factors, or the code and the message of why there are none."""

    factors: Factors | None
    code: str = ""
    message: str = ""

    @property
    def has_closed_form(self) -> bool:
        """Whether the closed form said anything."""
        return self.factors is not None and (self.factors.closed_form is not None or bool(self.factors.closed_status))

    @property
    def agree(self) -> bool | None:
        """Whether the methods agree; None where they are not compared."""
        return None if self.factors is None else self.factors.agree

    @property
    def moments_govern(self) -> bool:
        """Whether the limit lies below what the forces alone give."""
        return self.factors is not None and self.factors.moments_govern

    @property
    def notes(self) -> Sequence[Notice]:
        """What a run says of the factor."""
        return () if self.factors is None else self.factors.notes

    @property
    def also(self) -> WithoutBasal | None:
        """What acceptance is held against besides."""
        return None if self.factors is None else self.factors.also

    @property
    def is_in_doubt(self) -> bool:
        """Whether the methods disagree, or PRE-IE did not converge."""
        return self.agree is False or status_of(self, "pre_ie") == UNSETTLED

    def to_dict(self) -> dict[str, Any]:
        """What both methods say, as JSON values."""
        factors = self.factors
        record: dict[str, Any] = {name: getattr(factors, name, None) for name in _OF_FACTORS}
        if factors is not None and factors.also is not None:
            record[factors.also.NAME] = record_of(factors.also)
        document: dict[str, Any] = json_of(record | {"code": self.code or None, "message": self.message or None})
        return document

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> "Point":
        """Back from such values."""
        if record["status"] is None:
            return cls(None, record["code"] or "", record["message"] or "")
        whole = record.get(WithoutBasal.NAME)
        also = None if whole is None else WithoutBasal(**whole)
        return cls(Factors(**{name: record[name] for name in _OF_FACTORS}, also=also))


#: A design that kills every worker that takes it.
GIVEN_UP = Point(None, _BUG, "its worker died, three times")
#: The points of a sweep along its first key, by the value of the second, None without one.
Line: TypeAlias = "tuple[float | None, list[tuple[float, Point]]]"


def lines_of(points: Sequence[Point], first: Sequence[float], second: Sequence[float] = ()) -> list[Line]:
    """The points of a sweep in rising order of its first key, for each value of the second.

    Parameters
    ----------
    points : for each value of the second key those of the first
    """
    count = len(first)
    return [
        (other, sorted(zip(first, points[k * count : (k + 1) * count], strict=True), key=lambda pair: pair[0]))
        for k, other in enumerate(second or (None,))
    ]


def asked_of(methods: str, points: Sequence[Point]) -> tuple[Method, ...]:
    """The methods of a choice that said something at some points, the one that counts first."""
    if methods == "closed-form":
        return ("closed_form",)
    both = methods == "both" and any(point.has_closed_form for point in points)
    return ("pre_ie", "closed_form") if both else ("pre_ie",)


def factor_at(point: Point, method: Method) -> float | None:
    """The factor by one method: infinite where nothing drives, 0 where nothing holds.

    None where there is no block, and where PRE-IE did not settle: that is no slope that nothing holds.
    """
    factors = point.factors
    if factors is None:
        return None
    status, factor = factors.status, factors.limit
    if method == "closed_form":
        status, factor = factors.closed_status or "", factors.closed_form
    if factor is not None:
        return factor
    if status == "no_driving_force":
        return math.inf
    return None if status in (UNSETTLED, "") else 0.0


def status_of(point: Point, method: Method) -> str:
    """The status of a point by one method, or the code of why there is no block."""
    if point.factors is None:
        return point.code
    return point.factors.status if method == "pre_ie" else point.factors.closed_status or ""


def point_with(design: Design, pre_ie: bool, keeps_bolts: bool, values: Mapping[str, object]) -> Point:
    """The point of a design at some values, whose bolts may turn out to hold no block.

    Parameters
    ----------
    pre_ie : False asks the closed form alone, where there is one
    keeps_bolts : bolts stay where they are as values change, as in a slope that turns out otherwise: those that miss
        the block then, or end within it, give no force (W311), where else they would be a fault. Values of the bolts
        themselves are taken as they are
    """
    point = point_of(design, values, pre_ie)
    if keeps_bolts and values and point.code in _OF_BOLTS:
        point = point_of(design, values, pre_ie, holding_bolts)
        if point.factors is not None:
            point = replace(point, factors=replace(point.factors, notes=(WITHOUT_FORCE, *point.factors.notes)))
    return point


def holding_bolts(design: Design) -> Design:
    """A design with the bolts that hold its block from where they stand."""
    return replace(design, bolts=tuple(bolt for bolt in design.bolts if _holds(design, bolt)))


def _holds(design: Design, bolt: Bolt) -> bool:
    try:
        cut(replace(design, bolts=(bolt,)))
    except MisfitError as error:
        return not set(error.codes) & set(_OF_BOLTS)
    return True


def point_of(
    design: Design, values: Mapping[str, object], pre_ie: bool = True,
    also: Callable[[Design], Design] = lambda design: design,
) -> Point:  # fmt: skip
    """The point of a design at some values, by their dotted paths; a value that is refused is a point too.

    Parameters
    ----------
    also : what changes with the values, of the design with them

    >>> from slopekit.design.reading.files import load
    >>> wedge = load({"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}})
    >>> point_of(wedge, {"joints.J1.plane": "45/20"}).code
    'E204'
    """
    try:
        return Point(factors_of(also(with_values(design, values) if values else design), pre_ie))
    except SlopekitError as error:
        fault = error.faults[0]
        return Point(None, fault.code, fault.message)
    except _BROKEN as error:  # one sample of many: it is counted, the others go on
        return Point(None, _BUG, f"{type(error).__name__}: {error}")


def map_rows(
    work: Callable[[Any], Record], tasks: Sequence[Any], columns: RowArrays, crew: Crew, desk: Workplace, study: str,
    label: str, run: object, at_once: int = 1, given_up: Record | None = None,
) -> None:  # fmt: skip
    """Fill columns with the records of pieces of rows, by whoever does the work; a journal keeps them until the end.

    Parameters
    ----------
    work : gives the record of a piece; tasks : one a piece
    study, label : names of the journal and of the bar; run : everything that the records depend on, as JSON values
    at_once, given_up : as `run_all` has them
    """
    run = [run, columns.pieces]
    journal = Journal.of(desk.folder or Path.cwd(), study, run, desk.folder is not None, columns)
    with desk.bar(label, len(tasks)) as advance:
        run_all(work, tasks, crew, journal=journal, advance=advance, at_once=at_once, given_up=given_up)
    if desk.folder is None:
        journal.remove()
    else:
        desk.when_written.append(journal.remove)


def said_at(
    points: Sequence[Point], where: Callable[[int], str], besides: Iterable[Notice] = (), called: str = "points"
) -> Iterator[Notice]:
    """What runs would say of the factors at some places, each code once: at how many, and how it reads at the first.

    Parameters
    ----------
    points : what both methods say at each place; called : what these are
    where : the place of a point by its number, in words
    besides : what is said of the design already

    >>> there = Point(Factors("slides_on_J1", 1.0, None, None, None, None, False, notes=(Notice("W310", "so"),)))
    >>> [str(notice) for notice in said_at([Point(None, "E203", "no"), there], "at c = {}".format)]
    ['W310 1 of 2 points, at c = 1: so']
    """
    said, known = dict[str, list[tuple[int, str]]](), tuple(besides)
    for k, point in enumerate(points):
        notes = new_notices(point.notes, known)
        for code in dict.fromkeys(note.code for note in notes):
            text = "; ".join(note.message for note in notes if note.code == code)
            said.setdefault(code, []).append((k, text))
    for code, places in said.items():
        first, message = places[0]
        same = len(places) == len(points) and all(other == message for _, other in places)
        yield Notice(code, message if same else f"{len(places)} of {len(points)} {called}, {where(first)}: {message}")


def code_without_blocks(points: Iterable[Point]) -> int:
    """The exit code of points of which none has a factor: 3 where some form no block, 2 where all are bad input."""
    return 3 if any(one.code.startswith(("E2", "E44")) and one.code not in _BAD_INPUT for one in points) else 2


def lower_of(point: Point, method: Method) -> float | None:
    """The factor by one method, or what acceptance is held against besides where that is the lower; as `factor_at`."""
    factor, also = factor_at(point, method), point.also
    if factor is None or also is None or also.status == "no_driving_force":
        return factor
    return min(factor, also.factor or 0.0)


def notices_of_points(
    points: Sequence[Point], where: Callable[[int], str], method: Method, levels: Iterable[float],
    of_inputs: Sequence[Notice],
) -> Iterator[Notice]:  # fmt: skip
    """Yield W359 of points without a factor, W507 of what acceptance is held against besides, and what runs say.

    Parameters
    ----------
    where : as `said_at` has it; method : that counts; levels : what factors are held against
    of_inputs : what is said of all points
    """
    bare: dict[str, list[int]] = {}
    for k, point in enumerate(points):
        if not is_number(factor_at(point, method)):
            bare.setdefault(status_of(point, method), []).append(k)
    if bare:
        most_first = sorted(bare.items(), key=lambda entry: -len(entry[1]))
        text = ", ".join(f"{status} {len(at)} (first {where(at[0])})" for status, at in most_first)
        yield Notice("W359", f"{sum(map(len, bare.values()))} of {len(points)} points have no factor of safety: {text}")
    for level in levels:
        short = [
            (k, also) for k, point in enumerate(points)
            if (also := point.also) is not None and also.falls_short(level)
            and (factor_at(point, method) or 0.0) >= level
        ]  # fmt: skip
        if short:
            (first, also), many = short[0], f"{len(short)} of {len(points)} points, "
            yield from also_falls_short(also, level, f"{many if len(points) > 1 else ''}{where(first)}:")
    yield from said_at(points, where, of_inputs)
    yield from of_inputs


def rules_left_out(design: Design, judged: Container[str]) -> tuple[Notice, ...]:
    """W332: acceptance rules on numbers that a study does not find.

    Parameters
    ----------
    judged : the names of those that it does
    """
    others = [str(rule) for rule in design.rules if rule.name not in judged]
    return (
        (Notice("W332", f"acceptance also asks for {', '.join(others)}: not looked at here, run judges it"),)
        if others
        else ()
    )


def checked_target(fos: float, advice: str) -> None:
    """Refuse a target that is no factor of safety: E314."""
    if not (math.isfinite(fos) and 1e-6 <= fos <= 1e6):
        fail("E314", f"the target is a factor of safety of {number(fos)}, it lies between 1e-6 and 1e6", "", advice)


def falls_short(status: str, factor: float | None, target: float) -> bool:
    """Whether a block fails against a target: it moves at a lower factor, or moves and has none.

    >>> falls_short("slides_on_J1", 1.2, 1.3), falls_short("no_driving_force", None, 1.3), falls_short("falls", None, 1)
    (True, False, True)
    """
    if status == "no_driving_force":
        return False
    return factor is None or factor < target * (1.0 - SAME_FACTOR)
