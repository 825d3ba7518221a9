"""Outcomes of many designs by both methods, as arrays, and how far the methods agree."""

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

#: Beginnings of outcomes without a block: fault codes (but those of bolts that miss it), and impossible values.
NO_BLOCK = ("E", "impossible")
#: Beginnings of outcomes without a verdict: no answer, bolts that miss the block, a crack that leaves two blocks.
UNJUDGED = ("E5", "E208", "E211", "E212", UNSETTLED)
STANDS = "no_driving_force"
#: The arrays of `Outcomes` that compare the methods.
COMPARED = ("difference", "agree", "moments_govern")
_MAXIMUM_FIELD = "largest"  # the field of `BothMethods` that is a maximum, no count
#: The methods, and the fields of `Factors` with their factors.
_FACTOR_NAMES: tuple[tuple[Method, str], ...] = (
    ("pre_ie", "limit"),
    ("closed_form", "closed_form"),
)


@dataclass(frozen=True)
class ByMethod:
    """Outcomes of n designs by one method: `names` of outcomes, `outcome` (n,) indices into them, `factor` (n,) or nan.

    An outcome is a status, or the code of why there is no block.
    """

    names: tuple[str, ...]
    outcome: NDArray[np.int16]
    factor: Floats

    @classmethod
    def from_words(cls, words: Sequence[str], factor: Any) -> "ByMethod":
        """Return the outcomes from a word for each design and its factor, None where there is none."""
        names = tuple(dict.fromkeys(words))
        numbers = {name: number for number, name in enumerate(names)}
        return cls(
            names,
            np.array([numbers[word] for word in words], dtype=np.int16),
            np.array(factor, dtype=np.float64),
        )

    @classmethod
    def joined(cls, columns: RowArrays, name: str) -> "ByMethod":
        """Return the outcomes of all pieces that `record` made; only once, as it renumbers the arrays in place.

        A piece without this method has the outcome "" everywhere.
        """
        pieces = [
            (columns.pieces[piece], columns[piece].get(f"{name}_names"))
            for piece in sorted(columns)
        ]
        all_names = tuple(dict.fromkeys(word for _, words in pieces for word in (words or [""])))
        outcome, factor = (columns.arrays[f"{name}_{suffix}"] for suffix in ("outcome", "factor"))
        for (start, stop), words in pieces:
            numbers = np.array([all_names.index(word) for word in (words or [""])], dtype=np.int16)
            outcome[start:stop] = numbers[outcome[start:stop]]
            if words is None:
                factor[start:stop] = np.nan
        return cls(all_names, outcome.astype(np.int16, copy=False), factor)

    def take(self, rows: Ints) -> "ByMethod":
        """Return the outcomes of designs with numbers `rows`, in that order."""
        return ByMethod(self.names, self.outcome[rows], self.factor[rows])

    def record(self, name: str) -> dict[str, Any]:
        """Return the entries for the record of a piece of designs, whose names begin with `name`."""
        return {
            f"{name}_names": list(self.names),
            f"{name}_outcome": self.outcome,
            f"{name}_factor": self.factor,
        }

    @property
    def words(self) -> list[str]:
        """The outcome of each design as a word."""
        words: list[str] = np.array(self.names, dtype=object)[self.outcome].tolist()
        return words

    def starts_with(self, *beginnings: str) -> Bools:
        """Return which outcomes begin with one of these, (n,)."""
        return np.array([name.startswith(beginnings) for name in self.names], dtype=bool)[
            self.outcome
        ]

    def refused(self, words: Any) -> "ByMethod":
        """Return the outcomes with the fault codes of another method, by its words (n,), where that has no block."""
        is_refused = np.char.startswith(np.asarray(words, dtype=np.str_), "E")
        factor = np.where(is_refused, np.nan, self.factor)
        return (
            ByMethod.from_words(np.where(is_refused, words, self.words).tolist(), factor)
            if is_refused.any()
            else self
        )

    @property
    def unjudged(self) -> Bools:
        """Which designs have no verdict, (n,)."""
        return self.starts_with(*UNJUDGED)

    @cached_property
    def forms(self) -> Bools:
        """Which designs form a block, or may form one, (n,)."""
        return ~self.starts_with(*NO_BLOCK) | self.unjudged

    def falls_short(self, target: float) -> Bools:
        """Return which designs fall short of a target, (n,), as `points.falls_short`; those without an answer do.

        A factor that equals the target but for rounding reaches it, as where a dip is the friction angle.
        """
        stays = self.starts_with(*NO_BLOCK, STANDS) & ~self.unjudged
        with np.errstate(invalid="ignore"):
            return np.asarray(~stays & ~(self.factor >= target * (1.0 - SAME_FACTOR)))


@dataclass(frozen=True)
class Outcomes:
    """Outcomes of n designs by both methods, or by the closed form alone.

    Attributes
    ----------
    limit : by PRE-IE, or the closed form where that was evaluated alone
    closed_form : by the closed form, with the outcome "" where the kind has none, or it has a factor and no status
    difference : (n,) relative difference of both methods by forces alone, not a number where they are not compared
    agree : (n,) 1 where the methods agree, 0 where they do not, -1 where they are not compared
    moments_govern : (n,) the limit lies below that by forces alone
    whole : the wedges without basal plane, whose factor acceptance requires too, with the outcome "" where there is
        none; None where no design has one
    notes : (n) notices of a run of each, or why it forms no block; empty where they were not evaluated
    pre_ie : whether PRE-IE was evaluated
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
        cls,
        closed: ByMethod,
        without_basal: ByMethod | None,
        notes: Sequence[Sequence[Notice]] = (),
    ) -> "Outcomes":
        """Return the outcomes of the closed form, evaluated alone."""
        count = len(closed.outcome)
        nan, open_, governs = (
            np.full(1, np.nan),
            np.full(1, -1, dtype=np.int8),
            np.zeros(1, dtype=bool),
        )
        difference, agree, moments_govern = (
            np.broadcast_to(values, count) for values in (nan, open_, governs)
        )
        return cls(closed, closed, difference, agree, moments_govern, without_basal, notes, False)

    @classmethod
    def joined(cls, columns: RowArrays, pre_ie: bool) -> "Outcomes":
        """Return the outcomes of all pieces that `record` made; only once, as it renumbers the arrays in place."""
        if not columns.count:
            return outcomes_from_points([], [], pre_ie)
        pieces = [columns[piece] for piece in sorted(columns)]
        notes = [
            [Notice(*note) for note in row_notes]
            for piece in pieces
            for row_notes in piece.get("notes", ())
        ]
        closed = ByMethod.joined(columns, "closed_form")
        without_basal = (
            ByMethod.joined(columns, "whole") if "whole_factor" in columns.arrays else None
        )
        if not pre_ie:
            return cls.by_closed_form(closed, without_basal, notes)
        difference, agree, moments_govern = (columns.arrays[name] for name in COMPARED)
        return cls(
            ByMethod.joined(columns, "limit"),
            closed,
            difference,
            agree,
            moments_govern,
            without_basal,
            notes,
        )

    def record(self) -> dict[str, Any]:
        """Return the record of a piece of designs."""
        record: dict[str, Any] = self.closed_form.record("closed_form")
        if self.pre_ie:
            record |= self.limit.record("limit") | {name: getattr(self, name) for name in COMPARED}
        if self.whole is not None:
            record |= self.whole.record("whole")
        if self.notes:
            record["notes"] = [
                [[note.code, note.message] for note in row_notes] for row_notes in self.notes
            ]
        return record

    def take(self, rows: Ints) -> "Outcomes":
        """Return the outcomes of designs with numbers `rows`, in that order."""
        without_basal, notes = None if self.whole is None else self.whole.take(rows), self.notes
        return Outcomes(
            self.limit.take(rows),
            self.closed_form.take(rows),
            self.difference[rows],
            self.agree[rows],
            self.moments_govern[rows],
            without_basal,
            [notes[row] for row in rows.tolist()] if notes else (),
            self.pre_ie,
        )

    @property
    def points(self) -> list[Point]:
        """The outcomes one by one, as points; without reasons where no block forms if there are no notes."""
        limit, closed, without_basal = (
            self.limit.words,
            self.closed_form.words,
            self.wedges_without_basal(),
        )
        agree = [None if verdict < 0 else bool(verdict) for verdict in self.agree]
        points = []
        for row, notes in enumerate(self.notes or [()] * len(limit)):
            if limit[row].startswith("E"):
                points.append(Point(None, limit[row], notes[0].message if notes else ""))
                continue
            factor = number_or_none(self.limit.factor[row]) if self.pre_ie else None
            factors = Factors(
                limit[row],
                factor,
                closed[row] or None,
                number_or_none(self.closed_form.factor[row]),
                number_or_none(self.difference[row]),
                agree[row],
                bool(self.moments_govern[row]),
                notes=tuple(notes),
                also=without_basal[row],
            )
            points.append(Point(factors))
        return points

    def wedges_without_basal(self) -> list[WithoutBasal | None]:
        """Return the wedge without basal plane of each design, whose factor acceptance requires too; None without."""
        without_basal = self.whole
        if without_basal is None:
            return [None] * len(self.agree)
        factors = map(number_or_none, without_basal.factor)
        return [
            WithoutBasal(word, factor) if word else None
            for word, factor in zip(without_basal.words, factors, strict=True)
        ]


def outcomes_from_points(
    points: Sequence[Point], wholes: Sequence[WithoutBasal | None], pre_ie: bool
) -> Outcomes:
    """Return the outcomes of designs that were analysed one by one, by both methods or the closed form alone.

    Parameters
    ----------
    wholes : (n) the wedges without basal plane, also where the design forms no block
    """
    all_factors = [point.factors for point in points]
    limit, closed = (
        ByMethod.from_words(
            [status_of(point, method) for point in points],
            [getattr(factors, name, None) for factors in all_factors],
        )
        for method, name in _FACTOR_NAMES
    )
    without_basal = None
    if any(wholes):
        words = ["" if wedge is None else wedge.status for wedge in wholes]
        without_basal = ByMethod.from_words(
            words, [None if wedge is None else wedge.factor for wedge in wholes]
        )
    notes = [
        point.notes if point.factors is not None else [Notice(point.code, point.message)]
        for point in points
    ]
    if not pre_ie:
        return Outcomes.by_closed_form(closed, without_basal, notes)
    return Outcomes(
        limit,
        closed,
        np.array(
            [None if factors is None else factors.difference for factors in all_factors],
            dtype=np.float64,
        ),
        np.where(
            limit.unjudged, -1, [-1 if point.agree is None else point.agree for point in points]
        ).astype(np.int8),
        np.array([point.moments_govern for point in points], dtype=bool),
        without_basal,
        notes,
    )


def merged(pieces: Sequence[tuple[Ints, Outcomes]]) -> Outcomes:
    """Return the outcomes of n designs from those of pieces of them.

    Parameters
    ----------
    pieces : the numbers of the designs of each piece and their outcomes; each design is in one piece
    """
    if len(pieces) == 1:
        return pieces[0][1]
    order = np.argsort(np.concatenate([rows for rows, _ in pieces]))
    all_outcomes = [outcomes for _, outcomes in pieces]
    difference, agree, moments_govern = (
        np.concatenate([getattr(outcomes, name) for outcomes in all_outcomes]) for name in COMPARED
    )
    without_basal = None
    if any(outcomes.whole is not None for outcomes in all_outcomes):
        without_basal = concatenated(
            [
                outcomes.whole
                or ByMethod.from_words([""] * len(outcomes.agree), [None] * len(outcomes.agree))
                for outcomes in all_outcomes
            ]
        )
    limit, closed = (
        concatenated([getattr(outcomes, name) for outcomes in all_outcomes])
        for name in ("limit", "closed_form")
    )
    return Outcomes(
        limit,
        closed,
        difference,
        agree,
        moments_govern,
        without_basal,
        [note for outcomes in all_outcomes for note in outcomes.notes],
        all_outcomes[0].pre_ie,
    ).take(order)


def concatenated(methods: Sequence[ByMethod]) -> ByMethod:
    """Return the outcomes of several lists of designs, one list after the other."""
    words = [word for method in methods for word in method.words]
    return ByMethod.from_words(words, np.concatenate([method.factor for method in methods]))


def agreement(
    limit: ByMethod,
    forces: Floats,
    closed: ByMethod,
    tolerance: float,
    *,
    without_basal: ByMethod | None = None,
    compared: Bools | bool = True,
) -> Outcomes:
    """Return the outcomes of designs by both methods, compared as `kinds.protocol.compare` does.

    Parameters
    ----------
    forces : (n,) factors of PRE-IE by forces alone; without_basal : the field `whole` of `Outcomes`
    compared : (n,) for which designs both methods rest on the same assumptions
    """
    status, closed_status = (np.array(method.names)[method.outcome] for method in (limit, closed))
    has_forces, has_closed = forces > 0.0, closed.factor > 0.0
    with np.errstate(invalid="ignore", divide="ignore"):
        difference = np.where(
            has_forces & has_closed & compared, np.abs(forces / closed.factor - 1.0), np.nan
        )
    alike = (
        (status == closed_status)
        | (status == "topples")
        | ((closed_status == STANDS) & (status == "rotates"))
    )
    agree = np.where(
        has_forces & has_closed, difference <= tolerance, ~has_forces & ~has_closed & alike
    )
    is_judged = limit.forms & ~limit.unjudged
    moves = np.isfinite(limit.factor) | (status == "topples")
    with np.errstate(invalid="ignore"):
        governs = is_judged & moves & ~(limit.factor >= forces * (1.0 - SAME_LIMIT))
    return Outcomes(
        limit,
        closed,
        difference,
        np.where(is_judged & compared, agree, -1).astype(np.int8),
        governs,
        without_basal,
    )


@dataclass(frozen=True)
class BothMethods:
    """Numbers of designs on which both methods agree, disagree, or have different verdicts.

    Attributes
    ----------
    agree, disagree, not_compared : numbers of designs; without_answer : those without an answer of PRE-IE
    largest : the largest relative difference on the same assumptions, None where none is compared
    governed : those where moments govern, so that the closed form is too high
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
        """The number of designs that form a block: agreeing, disagreeing and not compared."""
        return self.agree + self.disagree + self.not_compared

    def in_words(self) -> list[str]:
        """Return in words how far the methods agree, and how often their verdicts differ."""
        words = [
            f"agree on {self.agree}",
            f"DISAGREE on {self.disagree}" if self.disagree else "disagree on 0",
        ]
        words += [f"{self.not_compared} not compared"] if self.not_compared else []
        words += [f"{self.without_answer} WITHOUT ANSWER"] if self.without_answer else []
        largest = "" if self.largest is None else f"; largest difference {self.largest * 100:.2g} %"
        return [
            f"{', '.join(words)}{largest}",
            f"moments govern in {self.governed}; {self.unsafe} fail by PRE-IE only, {self.safe} by the closed form "
            "only",
        ]

    def notices(self, subject: str, count: int) -> Iterator[Notice]:
        """Yield W353 where moments change verdicts; `subject` names the designs, `count` is their number."""
        if self.unsafe:
            yield Notice(
                "W353",
                f"{self.unsafe} of {count} {subject} fail by PRE-IE alone: the closed form balances no moments",
            )


def agreement_of_methods(
    outcomes: Outcomes, fails: Bools, fails_by_closed_form: Bools
) -> BothMethods:
    """Return how far both methods agree, and how often their verdicts differ.

    Parameters
    ----------
    fails, fails_by_closed_form : (n,) which designs fail by PRE-IE, and by the closed form
    """
    limit = outcomes.limit
    forms, is_compared, settled = (
        limit.forms,
        np.isfinite(outcomes.difference),
        limit.forms & ~limit.unjudged,
    )
    agree, disagree, open_ = (
        int((forms & (outcomes.agree == verdict)).sum()) for verdict in (1, 0, -1)
    )
    return BothMethods(
        agree,
        disagree,
        open_,
        int(limit.starts_with(UNSETTLED).sum()),
        float(outcomes.difference[is_compared].max()) if is_compared.any() else None,
        int((forms & outcomes.moments_govern).sum()),
        int((settled & fails & ~fails_by_closed_form).sum()),
        int((settled & fails_by_closed_form & ~fails).sum()),
    )


def total_agreement(pieces: Sequence[BothMethods]) -> BothMethods:
    """Return the agreement of both methods on all pieces together."""
    sums = {
        statistic.name: sum(getattr(piece, statistic.name) for piece in pieces)
        for statistic in fields(BothMethods)
        if statistic.name != _MAXIMUM_FIELD
    }
    return BothMethods(
        **sums,
        largest=max((piece.largest for piece in pieces if piece.largest is not None), default=None),
    )
