"""Outcome of solving for a number of a design: its values, their brackets, and the reasons where there is none."""

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from slopekit.core.codec import json_of
from slopekit.core.errors import Fault, Notice, fail
from slopekit.core.orientation import number
from slopekit.core.sheet import Column
from slopekit.design.common import Design
from slopekit.kinds import factors_of, notices_of_inputs
from slopekit.notices import new_notices
from slopekit.studies.keys import Key
from slopekit.studies.points import UNSETTLED, Method, Point, checked_target
from slopekit.studies.protocol import StudyOutcome

#: Largest difference from the target of the factor at the solved value, by method.
TOLERANCE: dict[Method, float] = {"closed_form": 1e-9, "pre_ie": 1e-6}
#: Factors this near to each other (relative) are the same.
SAME_FACTOR_TOLERANCE = 1e-9
_LARGEST_FACTOR_SHOWN = 1e6
GREATEST_K = (
    1.0  # of the ground's acceleration in g: hardly a record of a strong earthquake has more
)
#: Message of a value with valid input and no factor.
NO_CONVERGENCE = "PRE-IE did not converge"
_MOST_LISTED = 6
#: Advice where the factor is 0 at all values (nothing holds the block) or infinite (nothing drives it).
_ADVICE_WITHOUT_FACTOR = {
    0.0: "What tips, falls or is lifted there does so at any such value: slopekit run says how it moves.",
    math.inf: "Nothing moves it at any of these values.",
}
_LESS_WORK = "Fewer or larger blocks, or a narrower range: {}=lo:hi."
End = tuple[float, float] | None


@dataclass(frozen=True)
class SolvedValue:
    """A value at which the factor passes the target.

    Attributes
    ----------
    how : root; jump: the factor passes the target without taking it; gap: there is no factor, as the input is refused
        or PRE-IE does not converge
    value : of the key; of a jump or a gap the side that is nearer to the target
    factor, status : of the method at that value, put back
    bracket : values on both sides, with the factors there (inf where nothing drives, 0 where nothing holds)
    rises : whether the factor rises with the value there
    both : what both methods say at the value
    notes : what a run says of the factor there
    """

    how: Literal["root", "jump", "gap"]
    value: float
    factor: float
    status: str
    bracket: tuple[tuple[float, float], tuple[float, float]]
    rises: bool
    both: Point
    notes: tuple[Notice, ...] = ()


@dataclass(frozen=True)
class Answers:
    """The solutions of one method.

    Attributes
    ----------
    method : closed_form or pre_ie
    roots : values that give the target, the one nearest to the present value first
    others : jumps across the target, and gaps without a factor in which it is passed
    least, most : (value, factor) where the factor is least and greatest; None where there is none
    refused : (from, to, code, message) of values that form no block or are refused, in order, or at which PRE-IE did
        not converge (not_converged in place of a code)
    looked : (from, to) of the values evaluated; evaluations : their number
    reason : why there is no root, None where there is one
    """

    method: Method
    roots: tuple[SolvedValue, ...]
    others: tuple[SolvedValue, ...]
    least: tuple[float, float] | None
    most: tuple[float, float] | None
    refused: tuple[tuple[float, float, str, str], ...]
    looked: tuple[float, float]
    evaluations: int
    reason: Fault | None


@dataclass(frozen=True, repr=False)
class Solution(StudyOutcome):
    """The outcome of a solve study: the value of a key that gives the target factor of safety.

    Attributes
    ----------
    key, target, within : the number, the factor of safety, and the range that was searched
    from_acceptance : whether the target is that of the design's acceptance rule
    before : the point of the design as it is
    closed_form, pre_ie : the solutions of each method; no closed form where the kind has none
    """

    name: ClassVar[str] = "solve"
    design: Design
    key: Key
    target: float
    within: tuple[float, float]
    from_acceptance: bool
    before: Point
    closed_form: Answers | None
    pre_ie: Answers
    warnings: tuple[Notice, ...] = ()

    @property
    def answer(self) -> SolvedValue | None:
        """The root of PRE-IE nearest to the present value, None where there is none."""
        return self.pre_ie.roots[0] if self.pre_ie.roots else None

    @property
    def margin(self) -> float | None:
        """The value, negative where a higher one is safer: the load case with the least margin governs."""
        answer = self.answer
        return None if answer is None else -answer.value if answer.rises else answer.value

    def case_columns(self) -> list[Column[Any]]:
        """Return the columns of the load case table: the value, and whether it is a lower or an upper bound."""

        def bound(solution: "Solution") -> str:
            return (
                ""
                if solution.answer is None
                else "at least"
                if solution.answer.rises
                else "at most"
            )

        return [
            Column("needs", bound, "bound", width=10),
            Column(
                self.key.path,
                "answer.value",
                "value",
                self.key.unit,
                self.key.value_text,
                max(14, len(self.key.path) + 2),
                blank="none",
            ),
        ]

    @property
    def reason(self) -> Fault | None:
        """The fault that says why there is no such value; None where there is one."""
        return self.pre_ie.reason

    @property
    def agree(self) -> bool | None:
        """Whether the methods agree at the answer; None where they are not compared."""
        return None if self.answer is None else self.answer.both.agree

    @property
    def moments_govern(self) -> bool:
        """Whether moments govern at the answer."""
        return self.answer is not None and self.answer.both.moments_govern

    @property
    def is_open(self) -> bool:
        """Whether no value was found but one may exist, as PRE-IE did not converge somewhere.

        Where the factor jumps across the target there is none.
        """
        if self.reason is None or self.reason.code == "E317":
            return False
        return any(code == UNSETTLED for _, _, code, _ in self.pre_ie.refused)

    @property
    def exit_code(self) -> int:
        """0 found, 1 no such value or what acceptance asks besides falls short (W507), 4 the methods disagree there."""
        answer = self.answer
        if answer is None:
            return 4 if self.is_open else 1
        if self.agree is False or answer.status == UNSETTLED:
            return 4
        return 1 if any(note.code == "W507" for note in answer.notes) else 0

    def to_dict(self) -> dict[str, Any]:
        """Return the solution as JSON values; infinite factors (nothing drives the block) are null beside a status."""
        answer = self.answer
        return {
            **self.head(self.design),
            "key": self.key.path,
            "unit": self.key.unit,
            "target": {"fos": self.target, "from_acceptance": self.from_acceptance},
            "within": list(self.within),
            "before": {"value": self.key.value} | self.before.to_dict(),
            "value": None if answer is None else self.key.reduced(answer.value),
            "agree": self.agree,
            "moments_govern": self.moments_govern,
            "closed_form": None if self.closed_form is None else self._answers(self.closed_form),
            "pre_ie": self._answers(self.pre_ie),
            "reason": json_of(self.reason),
            "timing_s": {"total": self.seconds},
            **self.words(),
        }

    def _answers(self, answers: Answers) -> dict[str, Any]:
        return {
            "roots": [self._solved_value(crossing) for crossing in answers.roots],
            "jumps_and_gaps": [self._solved_value(crossing) for crossing in answers.others],
            "reach": {
                name: None
                if end is None
                else {"value": self.key.reduced(end[0]), "fos": json_of(end[1])}
                for name, end in {"least": answers.least, "most": answers.most}.items()
            },
            "refused": [
                dict(zip(("from", "to", "code", "message"), stretch, strict=True))
                for stretch in answers.refused
            ],
            "looked": list(answers.looked),
            "evaluations": answers.evaluations,
            "reason": json_of(answers.reason),
        }

    def _solved_value(self, crossing: SolvedValue) -> dict[str, Any]:
        return {
            "how": crossing.how,
            "value": self.key.reduced(crossing.value),
            "fos": json_of(crossing.factor),
            "status": crossing.status,
            "misses_by": json_of(abs(crossing.factor - self.target)),
            "rises": crossing.rises,
            "bracket": [
                {"value": value, "fos": json_of(factor)} for value, factor in crossing.bracket
            ],
            "put_back": crossing.both.to_dict(),
        }


def target_of(design: Design, fos: float | None) -> tuple[float, bool]:
    """Return the target factor, and whether it comes from the acceptance rules."""
    advice = "Give the factor of safety that is wanted: --fos 1.5"
    if fos is None:
        target = design.accepted_fos
        if target is None:
            fail(
                "E314", "no target is given, and no acceptance rule on fos or fos.limit", "", advice
            )
        return target, True
    checked_target(fos, advice)
    return fos, False


def refuse_as_run(design: Design, present: Point, points: Collection[Point]) -> None:
    """Raise the error of the design itself where every value is refused for the same reason as the design.

    Parameters
    ----------
    present, points : the points of the design as it is, and at the values
    """
    if (
        present.factors is None
        and points
        and all((point.code, point.message) == (present.code, present.message) for point in points)
    ):
        factors_of(design)


def reason_of(
    key: Key,
    target: float,
    search_range: tuple[float, float],
    jumps_and_gaps: Sequence[SolvedValue],
    least: End,
    most: End,
    refused: Sequence[tuple[float, float, str, str]],
) -> Fault:
    """Return the reason why no value of a key gives the target: E315 to E319."""
    all_round = key.period is not None and search_range[1] - search_range[0] >= key.period
    span = (
        "all round"
        if all_round
        else f"from {key.value_text(search_range[0], 7)} to {key.value_text(search_range[1], 7)}"
    )
    if least is None or most is None:
        _, _, code, message = refused[0]
        more = f" (and {len(refused) - 1} more reasons)" if len(refused) > 1 else ""
        cause = message if code == UNSETTLED else f"{code} {message}"
        return Fault(
            "E318",
            f"no value of {key.path} {span} gives a block with a factor: {cause}{more}",
            "",
            f"Another range: {key.path}=lo:hi.",
        )
    low, high = least[1], most[1]
    if high - low <= SAME_FACTOR_TOLERANCE * max(low, 1.0) if math.isfinite(high) else low == high:
        return Fault(
            "E316",
            f"the factor of safety does not depend on {key.path}: it is {factor_in_words(low)} {span}"
            f"{_unsettled_text(key, refused)}",
            "",
            _ADVICE_WITHOUT_FACTOR.get(low, ""),
        )
    jumps = [crossing for crossing in jumps_and_gaps if crossing.how == "jump"]
    if jumps:
        (a, factor_a), (b, factor_b) = jumps[0].bracket
        place = f"between {key.path} = {key.value_text(a)} and {key.value_text(b)}"
        place = (
            f"at {key.path} = {key.value_text(a)}"
            if key.value_text(a) == key.value_text(b)
            else place
        )
        return Fault(
            "E317",
            f"the factor jumps across {number(target)} {place}: {factor_in_words(factor_a)} below, "
            f"{factor_in_words(factor_b)} above; no value gives {number(target)}",
            "",
            "Contact with a joint is lost or gained there, or nothing drives the block.",
        )
    if jumps_and_gaps:
        crossing = jumps_and_gaps[0]
        (a, factor_a), (b, factor_b) = crossing.bracket
        _, _, code, message = next(
            (stretch for stretch in refused if a < stretch[0] < b),
            ("", "", UNSETTLED, NO_CONVERGENCE),
        )
        place = message if code == UNSETTLED else f"the input is refused: {code} {message}"
        return Fault(
            "E319",
            f"{number(target)} is passed between {key.path} = {key.value_text(a)} ({factor_in_words(factor_a)}) "
            f"and {key.value_text(b)} ({factor_in_words(factor_b)}), where {place}",
            "",
            _LESS_WORK.format(key.path) if code == UNSETTLED else "",
        )
    side, end = ("at most", most) if high < target else ("at least", least)
    is_movable = end[0] in search_range and (
        key.kind in ("length", "force", "pressure") or key.low < end[0] < key.high
    )
    return Fault(
        "E315",
        f"no value of {key.path} {span} gives {number(target)}: the factor is {side} {factor_in_words(end[1])}, "
        f"at {key.value_text(end[0], 7)} (it lies between {factor_in_words(low)} and {factor_in_words(high)})"
        f"{_unsettled_text(key, refused)}",
        "",
        f"That is the end of the range: try {key.path}=lo:hi." if is_movable else "",
    )


def _unsettled_text(key: Key, refused: Sequence[tuple[float, float, str, str]]) -> str:
    """Return where PRE-IE did not converge, in words: no solution is ruled out there."""
    ends = [(low, high) for low, high, code, _ in refused if code == UNSETTLED]
    if not ends:
        return ""
    low, high = (key.value_text(end, 7) for end in ends[0])
    place = f"from {low} to {high}" if low != high else f"at {low}"
    more = f" and in {len(ends) - 1} more stretches" if len(ends) > 1 else ""
    return f"; {place}{more} {NO_CONVERGENCE}: it may lie there"


def factor_in_words(factor: float) -> str:
    """Return a factor in words."""
    if math.isinf(factor):
        return "infinite (nothing drives it)"
    return (
        "none (nothing holds it)"
        if factor == 0.0
        else f"{factor:.6g}"
        if factor < _LARGEST_FACTOR_SHOWN
        else f"beyond {_LARGEST_FACTOR_SHOWN:g}"
    )


def notices(solution: Solution) -> Iterator[Notice]:
    """Yield the notices on a solution: moments, further values, jumps, residuals, and inputs."""
    key, target, answer = solution.key, solution.target, solution.answer
    closed = solution.closed_form
    closed_root = closed.roots[0] if closed is not None and closed.roots else None
    if answer is not None and solution.moments_govern:
        alternative = (
            f"the closed form, which knows no moments, has {key.value_text(closed_root.value)}"
            if closed_root
            else "it has none"
        )
        yield Notice(
            "W353", f"moments govern: use {key.value_text(answer.value)}, PRE-IE's; {alternative}"
        )
    elif answer is not None and closed is not None and closed_root is None:
        yield Notice(
            "W353",
            f"the closed form has no such value: {closed.reason.message if closed.reason else ''}",
        )
    elif answer is None and closed_root is not None:
        point = closed_root.both
        cause = (
            "with moments there is no such value"
            if point.factors
            else f"there {point.code} {point.message}"
        )
        yield Notice(
            "W353",
            f"the closed form has {key.value_text(closed_root.value)}, but {cause}: do not use it",
        )
    yield from seismic_coefficient_notices(key.path, None if answer is None else answer.value)
    if answer is not None:
        yield from answer.notes
    if len(solution.pre_ie.roots) > 1:
        further = [
            f"{key.value_text(solved.value)} ({solved.status})"
            for solved in solution.pre_ie.roots[1:]
        ]
        further_text = ", ".join(further[:_MOST_LISTED]) + (
            ", …" if len(further) > _MOST_LISTED else ""
        )
        yield Notice(
            "W356",
            f"{len(solution.pre_ie.roots)} values give {number(target)}; further: {further_text}",
        )
    for answers in (closed, solution.pre_ie):
        if answers is not None:
            yield from _residual_notices(answers, key, target)
    if answer is not None:
        for solved in solution.pre_ie.others:
            verb = "jumps across" if solved.how == "jump" else "passes (where there is no factor)"
            yield Notice(
                "W356",
                f"the factor also {verb} {number(target)} at {key.value_text(solved.value)}: "
                f"{factor_in_words(solved.bracket[0][1])} below, {factor_in_words(solved.bracket[1][1])} above",
            )

    yield from new_notices(
        notices_of_inputs(solution.design, [key.path]), () if answer is None else answer.notes
    )


def seismic_coefficient_notices(path: str, value: float | None) -> Iterator[Notice]:
    """Yield W302 where a seismic coefficient exceeds that of nearly any earthquake."""
    if path == "loads.seismic.k" and value is not None and value > GREATEST_K:
        yield Notice(
            "W302",
            f"k {number(float(f'{value:.3g}'))} is beyond what nearly any earthquake gives (1 g): "
            "something else than shaking decides",
        )


def _residual_notices(answers: Answers, key: Key, target: float) -> Iterator[Notice]:
    """Yield W356 of roots whose factor, evaluated again, misses the target by more than the tolerance."""
    name = {"closed_form": "the closed form", "pre_ie": "PRE-IE"}[answers.method]
    for root in answers.roots:
        miss = abs(root.factor - target)
        (a, below), (b, above) = root.bracket
        if root.how != "root":
            yield Notice(
                "W356",
                f"the factor falls past {number(target)} at once at {key.value_text(root.value)}: from "
                f"{factor_in_words(below)} to {factor_in_words(above)}, or to none",
            )
        elif miss > TOLERANCE[answers.method]:
            text = f"at {key.value_text(root.value)} {name} misses {number(target)} by {miss:.1g}: "
            text += f"between {key.value_text(a, 16)} and {key.value_text(b, 16)} the factor is no smoother"
            yield Notice("W356", text)
