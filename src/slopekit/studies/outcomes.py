"""What both methods say of many designs: an array of each number, and what they make of a target together."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints, NDArray, number_or_none
from slopekit.core.errors import Notice
from slopekit.evidence import WithoutBasal
from slopekit.kinds.protocol import Factors
from slopekit.preie.tolerances import SAME_LIMIT
from slopekit.studies.points import SAME_FACTOR, UNSETTLED, Method, Point, status_of
from slopekit.studies.running import RowArrays

#: What an outcome that is no block begins with, but for bolts that do not hold it; and values no design can have.
NO_BLOCK = ("E", "impossible")
#: Outcomes that are not judged: no answer, bolts that the block does not hold, a crack that leaves two blocks.
UNJUDGED = ("E5", "E208", "E211", "E212", UNSETTLED)
STANDS = "no_driving_force"
#: The arrays of `Outcomes` that compare the methods.
COMPARED = ("difference", "agree", "moments_govern")
_MOST = "largest"  # of `BothMethods`: no sum
#: The methods, and what their factors are called.
_OF_METHODS: tuple[tuple[Method, str], ...] = (("pre_ie", "limit"), ("closed_form", "closed_form"))


@dataclass(frozen=True)
class ByMethod:
    """What one method says of n designs: `names` of outcomes, `outcome` (n,) the number of each, `factor` (n,) or nan.

    An outcome is a status, or the code of why there is no block.
    """

    names: tuple[str, ...]
    outcome: NDArray[np.int16]
    factor: Floats

    @classmethod
    def of(cls, words: Sequence[str], factor: Any) -> "ByMethod":
        """Return it from the outcome of each, in a word, and the factors, None where there is none."""
        names = tuple(dict.fromkeys(words))
        numbers = {name: number for number, name in enumerate(names)}
        return cls(
            names, np.array([numbers[word] for word in words], dtype=np.int16), np.array(factor, dtype=np.float64)
        )

    @classmethod
    def joined(cls, columns: RowArrays, name: str) -> "ByMethod":
        """Return what `record` made of all pieces of many designs; once, as their outcomes are numbered anew.

        A piece that has none of it is taken to have the outcome "" everywhere.
        """
        pieces = [(columns.pieces[piece], columns[piece].get(f"{name}_names")) for piece in sorted(columns)]
        every = tuple(dict.fromkeys(word for _, words in pieces for word in (words or [""])))
        outcome, factor = (columns.arrays[f"{name}_{what}"] for what in ("outcome", "factor"))
        for (start, stop), words in pieces:
            numbers = np.array([every.index(word) for word in (words or [""])], dtype=np.int16)
            outcome[start:stop] = numbers[outcome[start:stop]]
            if words is None:
                factor[start:stop] = np.nan
        return cls(every, outcome.astype(np.int16, copy=False), factor)

    def take(self, rows: Ints) -> "ByMethod":
        """Return what it says of some of them, in the order of `rows`."""
        return ByMethod(self.names, self.outcome[rows], self.factor[rows])

    def record(self, name: str) -> dict[str, Any]:
        """Return it as parts of the record of a piece of many designs, by names that begin with this one."""
        return {f"{name}_names": list(self.names), f"{name}_outcome": self.outcome, f"{name}_factor": self.factor}

    @property
    def words(self) -> list[str]:
        """The outcome of each, in a word."""
        words: list[str] = np.array(self.names, dtype=object)[self.outcome].tolist()
        return words

    def among(self, *beginnings: str) -> Bools:
        """Return which outcomes begin with one of these, (n,)."""
        return np.array([name.startswith(beginnings) for name in self.names], dtype=bool)[self.outcome]

    def refused(self, words: Any) -> "ByMethod":
        """Return the same without blocks where another method forms none, by its outcomes in words (n,)."""
        without = np.char.startswith(np.asarray(words, dtype=np.str_), "E")
        factor = np.where(without, np.nan, self.factor)
        return ByMethod.of(np.where(without, words, self.words).tolist(), factor) if without.any() else self

    @property
    def unjudged(self) -> Bools:
        """Those without an answer."""
        return self.among(*UNJUDGED)

    @cached_property
    def forms(self) -> Bools:
        """Those that form a block, as far as is known."""
        return ~self.among(*NO_BLOCK) | self.unjudged

    def falls_short(self, target: float) -> Bools:
        """Return which fall short of a target, (n,): `points.falls_short` for arrays; without an answer they do.

        A factor that is the target but for rounding reaches it, by either method: a dip that is the friction angle.
        """
        stays = self.among(*NO_BLOCK, STANDS) & ~self.unjudged
        with np.errstate(invalid="ignore"):
            return np.asarray(~stays & ~(self.factor >= target * (1.0 - SAME_FACTOR)))


@dataclass(frozen=True)
class Outcomes:
    """What both methods say of n designs, or the closed form alone.

    Attributes
    ----------
    limit : by PRE-IE, or the closed form where that was asked alone
    closed_form : by that, with the outcome "" where the kind has none, or it has a factor and no status
    difference : (n,) of forces with forces, not a number where they are not compared
    agree : (n,) 1 where the methods agree, 0 where they do not, -1 where they are not compared
    moments_govern : (n,) the limit lies below what forces alone give
    whole : what acceptance is held against too, with the outcome "" where there is nothing; None where nowhere is
    notes : (n) what a run says of each, or why it forms no block; empty where nobody asked
    pre_ie : whether PRE-IE was asked
    """

    limit: ByMethod
    closed_form: ByMethod
    difference: Floats
    agree: NDArray[np.int8]
    moments_govern: Bools
    whole: ByMethod | None = None
    notes: Sequence[Sequence[Notice]] = ()
    pre_ie: bool = True

    @classmethod
    def by_closed_form(
        cls, closed: ByMethod, whole: ByMethod | None, notes: Sequence[Sequence[Notice]] = ()
    ) -> "Outcomes":
        """Return what the closed form says, asked alone."""
        count = len(closed.outcome)
        nan, open_, governs = np.full(1, np.nan), np.full(1, -1, dtype=np.int8), np.zeros(1, dtype=bool)
        difference, agree, moments_govern = (np.broadcast_to(one, count) for one in (nan, open_, governs))
        return cls(closed, closed, difference, agree, moments_govern, whole, notes, False)

    @classmethod
    def joined(cls, columns: RowArrays, pre_ie: bool) -> "Outcomes":
        """Return what `record` made of all pieces of many designs; once, as their outcomes are numbered anew."""
        if not columns.count:
            return outcomes_from_points([], [], pre_ie)
        pieces = [columns[piece] for piece in sorted(columns)]
        notes = [[Notice(*note) for note in own] for piece in pieces for own in piece.get("notes", ())]
        closed = ByMethod.joined(columns, "closed_form")
        whole = ByMethod.joined(columns, "whole") if "whole_factor" in columns.arrays else None
        if not pre_ie:
            return cls.by_closed_form(closed, whole, notes)
        difference, agree, moments_govern = (columns.arrays[name] for name in COMPARED)
        return cls(ByMethod.joined(columns, "limit"), closed, difference, agree, moments_govern, whole, notes)

    def record(self) -> dict[str, Any]:
        """Return it as the record of a piece of many designs."""
        record: dict[str, Any] = self.closed_form.record("closed_form")
        if self.pre_ie:
            record |= self.limit.record("limit") | {name: getattr(self, name) for name in COMPARED}
        if self.whole is not None:
            record |= self.whole.record("whole")
        if self.notes:
            record["notes"] = [[[note.code, note.message] for note in own] for own in self.notes]
        return record

    def of(self, rows: Ints) -> "Outcomes":
        """Return what is said of some of them, in the order of `rows`."""
        whole, notes = None if self.whole is None else self.whole.take(rows), self.notes
        return Outcomes(
            self.limit.take(rows), self.closed_form.take(rows), self.difference[rows], self.agree[rows],
            self.moments_govern[rows], whole, [notes[row] for row in rows.tolist()] if notes else (), self.pre_ie,
        )  # fmt: skip

    @property
    def points(self) -> list[Point]:
        """Each of them as a design of its own; where nobody asked for notes, without reasons of what forms no block."""
        limit, closed, wholes = self.limit.words, self.closed_form.words, self.wholes()
        agree = [None if verdict < 0 else bool(verdict) for verdict in self.agree]
        points = []
        for row, notes in enumerate(self.notes or [()] * len(limit)):
            if limit[row].startswith("E"):
                points.append(Point(None, limit[row], notes[0].message if notes else ""))
                continue
            factor = number_or_none(self.limit.factor[row]) if self.pre_ie else None
            factors = Factors(
                limit[row], factor, closed[row] or None, number_or_none(self.closed_form.factor[row]),
                number_or_none(self.difference[row]), agree[row], bool(self.moments_govern[row]), notes=tuple(notes),
                also=wholes[row],
            )  # fmt: skip
            points.append(Point(factors))
        return points

    def wholes(self) -> list[WithoutBasal | None]:
        """What acceptance of each is held against too."""
        whole = self.whole
        if whole is None:
            return [None] * len(self.agree)
        factors = map(number_or_none, whole.factor)
        return [WithoutBasal(word, factor) if word else None for word, factor in zip(whole.words, factors, strict=True)]


def outcomes_from_points(points: Sequence[Point], wholes: Sequence[WithoutBasal | None], pre_ie: bool) -> Outcomes:
    """Return what both methods say of designs of their own, or the closed form alone.

    Parameters
    ----------
    wholes : (n) what acceptance of each is held against too, also where it forms no block
    """
    every = [point.factors for point in points]
    limit, closed = (
        ByMethod.of([status_of(point, method) for point in points], [getattr(own, name, None) for own in every])
        for method, name in _OF_METHODS
    )
    whole = None
    if any(wholes):
        words = ["" if one is None else one.status for one in wholes]
        whole = ByMethod.of(words, [None if one is None else one.factor for one in wholes])
    notes = [point.notes if point.factors is not None else [Notice(point.code, point.message)] for point in points]
    if not pre_ie:
        return Outcomes.by_closed_form(closed, whole, notes)
    return Outcomes(
        limit,
        closed,
        np.array([None if own is None else own.difference for own in every], dtype=np.float64),
        np.where(limit.unjudged, -1, [-1 if point.agree is None else point.agree for point in points]).astype(np.int8),
        np.array([point.moments_govern for point in points], dtype=bool),
        whole,
        notes,
    )


def merged(parts: Sequence[tuple[Ints, Outcomes]]) -> Outcomes:
    """Return what is said of parts of n designs as what is said of all.

    Parameters
    ----------
    parts : the numbers of designs, each in one part, and what is said of these
    """
    if len(parts) == 1:
        return parts[0][1]
    order = np.argsort(np.concatenate([rows for rows, _ in parts]))
    every = [outcomes for _, outcomes in parts]
    difference, agree, moments_govern = (np.concatenate([getattr(own, name) for own in every]) for name in COMPARED)
    whole = None
    if any(own.whole is not None for own in every):
        whole = one_after_the_other(
            [own.whole or ByMethod.of([""] * len(own.agree), [None] * len(own.agree)) for own in every]
        )
    limit, closed = (one_after_the_other([getattr(own, name) for own in every]) for name in ("limit", "closed_form"))
    return Outcomes(
        limit, closed, difference, agree, moments_govern, whole, [note for own in every for note in own.notes],
        every[0].pre_ie,
    ).of(order)  # fmt: skip


def one_after_the_other(methods: Sequence[ByMethod]) -> ByMethod:
    """Return what is said of designs by several, the first's first."""
    words = [word for method in methods for word in method.words]
    return ByMethod.of(words, np.concatenate([method.factor for method in methods]))


def agreement(
    limit: ByMethod,
    forces: Floats,
    closed: ByMethod,
    within: float,
    *,
    whole: ByMethod | None = None,
    compared: Bools | bool = True,
) -> Outcomes:
    """Return what both methods say of designs, held against each other as `kinds.protocol.compare` has it.

    Parameters
    ----------
    forces : (n,) PRE-IE's factors of the forces alone; whole : as `Outcomes` has it
    compared : (n,) which of them rest on the same assumptions
    """
    status, other = (np.array(method.names)[method.outcome] for method in (limit, closed))
    has_one, has_other = forces > 0.0, closed.factor > 0.0
    with np.errstate(invalid="ignore", divide="ignore"):
        difference = np.where(has_one & has_other & compared, np.abs(forces / closed.factor - 1.0), np.nan)
    alike = (status == other) | (status == "topples") | ((other == STANDS) & (status == "rotates"))
    agree = np.where(has_one & has_other, difference <= within, ~has_one & ~has_other & alike)
    judged = limit.forms & ~limit.unjudged
    moves = np.isfinite(limit.factor) | (status == "topples")
    with np.errstate(invalid="ignore"):
        governs = judged & moves & ~(limit.factor >= forces * (1.0 - SAME_LIMIT))
    return Outcomes(limit, closed, difference, np.where(judged & compared, agree, -1).astype(np.int8), governs, whole)


@dataclass(frozen=True)
class BothMethods:
    """How far both methods agree on many designs, and on what they judge otherwise.

    Attributes
    ----------
    agree, disagree, not_compared : on so many; without_answer : of PRE-IE
    largest : the largest relative difference on the same assumptions, None where none is compared
    governed : where moments govern, so that the closed form is too high
    unsafe, safe : fail by PRE-IE and not by the closed form, and the other way round
    """

    agree: int
    disagree: int
    not_compared: int
    without_answer: int
    largest: float | None = field(metadata={"json": "largest_difference"})
    governed: int = field(metadata={"json": "moments_govern"})
    unsafe: int = field(metadata={"json": "fails_by_pre_ie_only"})
    safe: int = field(metadata={"json": "fails_by_closed_form_only"})

    @property
    def looked_at(self) -> int:
        """How many PRE-IE was asked of."""
        return self.agree + self.disagree + self.not_compared

    def in_words(self) -> list[str]:
        """How far they agree, and what they judge otherwise."""
        words = [f"agree on {self.agree}", f"DISAGREE on {self.disagree}" if self.disagree else "disagree on 0"]
        words += [f"{self.not_compared} not compared"] if self.not_compared else []
        words += [f"{self.without_answer} WITHOUT ANSWER"] if self.without_answer else []
        largest = "" if self.largest is None else f"; largest difference {self.largest * 100:.2g} %"
        return [
            f"{', '.join(words)}{largest}",
            f"moments govern in {self.governed}; {self.unsafe} fail by PRE-IE only, {self.safe} by the closed form "
            "only",
        ]

    def notices(self, called: str, of: int) -> Iterator[Notice]:
        """Yield W353 where moments change the judgement; `called`: what was judged, `of` so many."""
        if self.unsafe:
            yield Notice(
                "W353", f"{self.unsafe} of {of} {called} fail by PRE-IE alone: the closed form balances no moments"
            )


def compared(outcomes: Outcomes, fails: Bools, fails_by_closed_form: Bools) -> BothMethods:
    """Return how far both methods agree, and what each judges otherwise.

    Parameters
    ----------
    fails : (n,) by PRE-IE
    """
    limit = outcomes.limit
    forms, known, settled = limit.forms, np.isfinite(outcomes.difference), limit.forms & ~limit.unjudged
    agree, disagree, open_ = (int((forms & (outcomes.agree == verdict)).sum()) for verdict in (1, 0, -1))
    return BothMethods(
        agree,
        disagree,
        open_,
        int(limit.among(UNSETTLED).sum()),
        float(outcomes.difference[known].max()) if known.any() else None,
        int((forms & outcomes.moments_govern).sum()),
        int((settled & fails & ~fails_by_closed_form).sum()),
        int((settled & fails_by_closed_form & ~fails).sum()),
    )


def total(parts: Sequence[BothMethods]) -> BothMethods:
    """Return how far both methods agree on all of some parts together."""
    sums = {
        own.name: sum(getattr(part, own.name) for part in parts) for own in fields(BothMethods) if own.name != _MOST
    }
    return BothMethods(**sums, largest=max((part.largest for part in parts if part.largest is not None), default=None))
