"""Points of a study: the factors by both methods of a design with some of its values changed."""

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
from slopekit.kinds import cut, factors_of, whole_wedge_notice
from slopekit.kinds.protocol import Factors
from slopekit.notices import new_notices
from slopekit.studies.running import ExecutorOptions, Journal, Record, RowArrays, run_all

Method = Literal["closed_form", "pre_ie"]
_ANALYSIS_ERROR_CODE = "E599"
_INPUT_FAULT_CODES = (
    "E211",
    "E212",
    "E250",
    "E252",
    "E253",
)  # faults of bolts and forces: a block does form
_BOLT_FAULT_CODES = ("E211", "E212")  # a bolt misses the block, or ends within it
WITHOUT_FORCE = Notice("W311", "bolts that miss the block, or end within it, give no force there")
_ANALYSIS_ERRORS = (ArithmeticError, ValueError, IndexError, np.linalg.LinAlgError)
_FACTOR_FIELDS = tuple(
    field.name for field in fields(Factors) if field.name not in ("notes", "also")
)
SAME_FACTOR = 1e-9  # relative: a factor this near below the target reaches it
#: The status of a factor for which PRE-IE did not converge.
UNSETTLED = "not_converged"


@dataclass(frozen=True)
class Point:
    """The factors of a design with changed values, or the code and the message of why there are none."""

    factors: Factors | None
    code: str = ""
    message: str = ""

    @property
    def has_closed_form(self) -> bool:
        """Whether there is a factor or a status by the closed form."""
        return self.factors is not None and (
            self.factors.closed_form is not None or bool(self.factors.closed_status)
        )

    @property
    def agree(self) -> bool | None:
        """Whether the methods agree; None where they are not compared."""
        return None if self.factors is None else self.factors.agree

    @property
    def moments_govern(self) -> bool:
        """Whether the limit lies below the one by forces alone."""
        return self.factors is not None and self.factors.moments_govern

    @property
    def notes(self) -> Sequence[Notice]:
        """The notices of a run on the factor."""
        return () if self.factors is None else self.factors.notes

    @property
    def also(self) -> WithoutBasal | None:
        """The wedge without its basal plane, whose factor acceptance requires too; None without one."""
        return None if self.factors is None else self.factors.also

    @property
    def is_in_doubt(self) -> bool:
        """Whether the methods disagree, or PRE-IE did not converge."""
        return self.agree is False or status_of(self, "pre_ie") == UNSETTLED

    def to_dict(self) -> dict[str, Any]:
        """Return the factors by both methods as JSON values."""
        factors = self.factors
        record: dict[str, Any] = {name: getattr(factors, name, None) for name in _FACTOR_FIELDS}
        if factors is not None and factors.also is not None:
            record[factors.also.NAME] = record_of(factors.also)
        document: dict[str, Any] = json_of(
            record | {"code": self.code or None, "message": self.message or None}
        )
        return document

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> "Point":
        """Return the point from the values of `to_dict`."""
        if record["status"] is None:
            return cls(None, record["code"] or "", record["message"] or "")
        basal_record = record.get(WithoutBasal.NAME)
        without_basal = None if basal_record is None else WithoutBasal(**basal_record)
        return cls(Factors(**{name: record[name] for name in _FACTOR_FIELDS}, also=without_basal))


#: The point of a design over which every worker dies.
GIVEN_UP = Point(None, _ANALYSIS_ERROR_CODE, "its worker died, three times")
#: A line of a sweep: the value of the second key (None without one), and (value, point) along the first.
Line: TypeAlias = "tuple[float | None, list[tuple[float, Point]]]"


def lines_of(
    points: Sequence[Point], first: Sequence[float], second: Sequence[float] = ()
) -> list[Line]:
    """Return the points of a sweep in rising order of its first key, for each value of the second.

    Parameters
    ----------
    points : in the order of the second key, within that of the first
    """
    count = len(first)
    return [
        (
            second_value,
            sorted(
                zip(first, points[k * count : (k + 1) * count], strict=True),
                key=lambda pair: pair[0],
            ),
        )
        for k, second_value in enumerate(second or (None,))
    ]


def evaluated_methods(methods: str, points: Sequence[Point]) -> tuple[Method, ...]:
    """Return the methods of a choice that have factors at some points, the governing one first."""
    if methods == "closed-form":
        return ("closed_form",)
    both = methods == "both" and any(point.has_closed_form for point in points)
    return ("pre_ie", "closed_form") if both else ("pre_ie",)


def factor_at(point: Point, method: Method) -> float | None:
    """Return the factor by one method: infinite where nothing drives the block, 0 where nothing holds it.

    None where there is no block, and where PRE-IE did not converge, which does not mean that nothing holds it.
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
    """Return the status of a point by one method, or the code of why there is no block."""
    if point.factors is None:
        return point.code
    return point.factors.status if method == "pre_ie" else point.factors.closed_status or ""


def point_with(
    design: Design, pre_ie: bool, keeps_bolts: bool, values: Mapping[str, object]
) -> Point:
    """Return the point of a design at some values, where bolts may miss the block.

    Parameters
    ----------
    pre_ie : False evaluates the closed form alone, where there is one
    keeps_bolts : bolts stay where they are as values change, as in a slope that turns out otherwise: those that then
        miss the block, or end within it, give no force (W311) and are no fault; this does not hold for changed
        values of the bolts themselves
    """
    point = point_of(design, values, pre_ie)
    if keeps_bolts and values and point.code in _BOLT_FAULT_CODES:
        point = point_of(design, values, pre_ie, holding_bolts)
        if point.factors is not None:
            point = replace(
                point, factors=replace(point.factors, notes=(WITHOUT_FORCE, *point.factors.notes))
            )
    return point


def holding_bolts(design: Design) -> Design:
    """Return a design with only those bolts that cross the joints of its block."""
    return replace(design, bolts=tuple(bolt for bolt in design.bolts if _holds(design, bolt)))


def _holds(design: Design, bolt: Bolt) -> bool:
    try:
        cut(replace(design, bolts=(bolt,)))
    except MisfitError as error:
        return not set(error.codes) & set(_BOLT_FAULT_CODES)
    return True


def point_of(
    design: Design,
    values: Mapping[str, object],
    pre_ie: bool = True,
    adjust: Callable[[Design], Design] = lambda design: design,
) -> Point:
    """Return the point of a design with values by their dotted paths; a refused value gives a point with its code.

    Parameters
    ----------
    adjust : returns the design to analyse from the design with the values

    >>> from slopekit.design.reading.files import load
    >>> wedge = load({"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}})
    >>> point_of(wedge, {"joints.J1.plane": "45/20"}).code
    'E204'
    """
    try:
        return Point(factors_of(adjust(with_values(design, values) if values else design), pre_ie))
    except SlopekitError as error:
        fault = error.faults[0]
        return Point(None, fault.code, fault.message)
    except _ANALYSIS_ERRORS as error:  # one sample of many: it is counted, the others go on
        return Point(None, _ANALYSIS_ERROR_CODE, f"{type(error).__name__}: {error}")


def map_rows(
    work: Callable[[Any], Record],
    tasks: Sequence[Any],
    columns: RowArrays,
    crew: ExecutorOptions,
    desk: Workplace,
    study: str,
    label: str,
    run: object,
    at_once: int = 1,
    given_up: Record | None = None,
) -> None:
    """Fill columns with the records of pieces of rows from the workers; a journal keeps them until the end.

    Parameters
    ----------
    work : returns the record of a piece; tasks : one for each piece
    study, label : names of the journal and of the progress bar
    run : everything that the records depend on, as JSON values; at_once, given_up : as in `run_all`
    """
    run = [run, columns.pieces]
    journal = Journal.for_run(
        desk.folder or Path.cwd(), study, run, desk.folder is not None, columns
    )
    with desk.bar(label, len(tasks)) as advance:
        run_all(
            work, tasks, crew, journal=journal, advance=advance, at_once=at_once, given_up=given_up
        )
    if desk.folder is None:
        journal.remove()
    else:
        desk.when_written.append(journal.remove)


def run_notices(
    points: Sequence[Point],
    place_of: Callable[[int], str],
    design_notices: Iterable[Notice] = (),
    subject: str = "points",
) -> Iterator[Notice]:
    """Yield the notices of runs at some points, each code once, with the number of points and the first message.

    Parameters
    ----------
    points : the points; subject : their name in the notice
    place_of : returns the place of a point in words, by its number
    design_notices : notices on the design, which are not repeated

    >>> there = Point(Factors("slides_on_J1", 1.0, None, None, None, None, False, notes=(Notice("W310", "so"),)))
    >>> [str(notice) for notice in run_notices([Point(None, "E203", "no"), there], "at c = {}".format)]
    ['W310 1 of 2 points, at c = 1: so']
    """
    texts_by_code, known_notices = dict[str, list[tuple[int, str]]](), tuple(design_notices)
    for k, point in enumerate(points):
        notes = new_notices(point.notes, known_notices)
        for code in dict.fromkeys(note.code for note in notes):
            text = "; ".join(note.message for note in notes if note.code == code)
            texts_by_code.setdefault(code, []).append((k, text))
    for code, texts in texts_by_code.items():
        first, message = texts[0]
        is_same = len(texts) == len(points) and all(
            further_message == message for _, further_message in texts
        )
        yield Notice(
            code,
            message
            if is_same
            else f"{len(texts)} of {len(points)} {subject}, {place_of(first)}: {message}",
        )


def code_without_blocks(points: Iterable[Point]) -> int:
    """Return the exit code of points without any factor: 3 where some form no block, 2 where all are bad input."""
    return (
        3
        if any(
            point.code.startswith(("E2", "E44")) and point.code not in _INPUT_FAULT_CODES
            for point in points
        )
        else 2
    )


def governing_factor(point: Point, method: Method) -> float | None:
    """Return the lower of the factor by one method and that of the wedge without basal plane; as `factor_at`."""
    factor, without_basal = factor_at(point, method), point.also
    if factor is None or without_basal is None or without_basal.status == "no_driving_force":
        return factor
    return min(factor, without_basal.factor or 0.0)


def notices_of_points(
    points: Sequence[Point],
    place_of: Callable[[int], str],
    method: Method,
    levels: Iterable[float],
    of_inputs: Sequence[Notice],
) -> Iterator[Notice]:
    """Yield W359 of points without a factor, W507 of wedges without basal plane, and the notices of runs.

    Parameters
    ----------
    place_of : as in `run_notices`; method : the governing one; levels : target factors of safety
    of_inputs : notices on the inputs of all points
    """
    numbers_by_status: dict[str, list[int]] = {}
    for k, point in enumerate(points):
        if not is_number(factor_at(point, method)):
            numbers_by_status.setdefault(status_of(point, method), []).append(k)
    if numbers_by_status:
        most_first = sorted(numbers_by_status.items(), key=lambda entry: -len(entry[1]))
        text = ", ".join(
            f"{status} {len(numbers)} (first {place_of(numbers[0])})"
            for status, numbers in most_first
        )
        yield Notice(
            "W359",
            f"{sum(map(len, numbers_by_status.values()))} of {len(points)} points have no factor of safety: {text}",
        )
    for level in levels:
        short = [
            (k, without_basal)
            for k, point in enumerate(points)
            if (without_basal := point.also) is not None
            and without_basal.falls_short(level)
            and (factor_at(point, method) or 0.0) >= level
        ]
        if short:
            (first, without_basal), many = short[0], f"{len(short)} of {len(points)} points, "
            yield from whole_wedge_notice(
                without_basal, level, f"{many if len(points) > 1 else ''}{place_of(first)}:"
            )
    yield from run_notices(points, place_of, of_inputs)
    yield from of_inputs


def rules_left_out(design: Design, evaluated_names: Container[str]) -> tuple[Notice, ...]:
    """Return W332: acceptance rules on numbers that a study does not evaluate.

    Parameters
    ----------
    evaluated_names : the names of the numbers that the study evaluates
    """
    other_rules = [str(rule) for rule in design.rules if rule.name not in evaluated_names]
    return (
        (
            Notice(
                "W332",
                f"acceptance also asks for {', '.join(other_rules)}: not looked at here, run judges it",
            ),
        )
        if other_rules
        else ()
    )


def checked_target(fos: float, advice: str) -> None:
    """Refuse a target that is no factor of safety: E314."""
    if not (math.isfinite(fos) and 1e-6 <= fos <= 1e6):
        fail(
            "E314",
            f"the target is a factor of safety of {number(fos)}, it lies between 1e-6 and 1e6",
            "",
            advice,
        )


def falls_short(status: str, factor: float | None, target: float) -> bool:
    """Return whether a block fails a target: its factor is lower, or it moves and has none.

    >>> falls_short("slides_on_J1", 1.2, 1.3), falls_short("no_driving_force", None, 1.3), falls_short("falls", None, 1)
    (True, False, True)
    """
    if status == "no_driving_force":
        return False
    return factor is None or factor < target * (1.0 - SAME_FACTOR)
