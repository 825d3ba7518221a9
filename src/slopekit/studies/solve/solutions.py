"""What is found when a number of a design is solved for: values, brackets, what both methods say of them, and why there
is no value that gives the target.
"""

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

#: What putting a value back may miss the target by.
TOLERANCE: dict[Method, float] = {"closed_form": 1e-9, "pre_ie": 1e-6}
#: Factors this near to each other (relative) are the same.
ALIKE = 1e-9
_HUGE = 1e6
GREATEST_K = 1.0  # of the ground's acceleration in g: hardly a record of a strong earthquake has more
#: Why there is no factor at a value whose input is sound.
NO_CONVERGENCE = "PRE-IE did not converge"
_MOST_LISTED = 6
#: What to do where there is a factor at no value: 0 nothing holds it, infinite nothing drives it.
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
    """What one method says.

    Attributes
    ----------
    method : closed_form or pre_ie
    roots : the one nearest to the present value first
    others : jumps across the target and gaps in which it is passed
    least, most : (value, factor) where the factor is least and greatest; None where there is none
    refused : (from, to, code, message) of values that form no block or are refused, in order, or at which PRE-IE did
        not converge (not_converged in place of a code)
    looked : (from, to) where the method was asked; evaluations : how often
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
    """The value that was asked for.

    Attributes
    ----------
    key, target, within : what was asked; from_acceptance : whether the target is that of the design's own rule
    before : the design as it is
    closed_form : None where the kind has none that is quick; pre_ie
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
        """Of load cases that one governs which needs most of the key, or the least where more is unsafe."""
        answer = self.answer
        return None if answer is None else -answer.value if answer.rises else answer.value

    def case_columns(self) -> list[Column[Any]]:
        """The value of each load case, and whether it is the least or the most."""

        def way(one: "Solution") -> str:
            return "" if one.answer is None else "at least" if one.answer.rises else "at most"

        return [
            Column("needs", way, "bound", width=10),
            Column(
                self.key.path,
                "answer.value",
                "value",
                self.key.unit,
                self.key.shown,
                max(14, len(self.key.path) + 2),
                blank="none",
            ),
        ]

    @property
    def reason(self) -> Fault | None:
        """Why there is no such value, None where there is one."""
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
        """Whether no value was found and there may be one: PRE-IE did not converge somewhere.

        Where the factor was seen to jump across the target there is none.
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
        """The solution as JSON values; infinite factors, where nothing drives the block, are null beside a status."""
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
            "roots": [self._found(crossing) for crossing in answers.roots],
            "jumps_and_gaps": [self._found(crossing) for crossing in answers.others],
            "reach": {
                name: None if end is None else {"value": self.key.reduced(end[0]), "fos": json_of(end[1])}
                for name, end in {"least": answers.least, "most": answers.most}.items()
            },
            "refused": [dict(zip(("from", "to", "code", "message"), one, strict=True)) for one in answers.refused],
            "looked": list(answers.looked),
            "evaluations": answers.evaluations,
            "reason": json_of(answers.reason),
        }

    def _found(self, crossing: SolvedValue) -> dict[str, Any]:
        return {
            "how": crossing.how, "value": self.key.reduced(crossing.value), "fos": json_of(crossing.factor),
            "status": crossing.status, "misses_by": json_of(abs(crossing.factor - self.target)),
            "rises": crossing.rises,
            "bracket": [{"value": at, "fos": json_of(factor)} for at, factor in crossing.bracket],
            "put_back": crossing.both.to_dict(),
        }  # fmt: skip


def target_of(design: Design, fos: float | None) -> tuple[float, bool]:
    """The factor that is wanted, and whether it comes from the acceptance rules."""
    advice = "Give the factor of safety that is wanted: --fos 1.5"
    if fos is None:
        wanted = design.accepted_fos
        if wanted is None:
            fail("E314", "no target is given, and no acceptance rule on fos or fos.limit", "", advice)
        return wanted, True
    checked_target(fos, advice)
    return fos, False


def refuse_as_run(design: Design, own: Point, points: Collection[Point]) -> None:
    """Where every value is refused for what the design itself is refused for, refuse it as a run of it does.

    Parameters
    ----------
    own, points : what both methods say of the design as it is, and at the values
    """
    if own.factors is None and points and all((one.code, one.message) == (own.code, own.message) for one in points):
        factors_of(design)


def reason_of(
    key: Key, target: float, within: tuple[float, float], others: Sequence[SolvedValue], least: End, most: End,
    refused: Sequence[tuple[float, float, str, str]],
) -> Fault:  # fmt: skip
    """Why no value of a key gives the target: E315 to E319."""
    all_round = key.period is not None and within[1] - within[0] >= key.period
    span = "all round" if all_round else f"from {key.shown(within[0], 7)} to {key.shown(within[1], 7)}"
    if least is None or most is None:
        _, _, code, message = refused[0]
        more = f" (and {len(refused) - 1} more reasons)" if len(refused) > 1 else ""
        why = message if code == UNSETTLED else f"{code} {message}"
        return Fault(
            "E318",
            f"no value of {key.path} {span} gives a block with a factor: {why}{more}",
            "",
            f"Another range: {key.path}=lo:hi.",
        )
    low, high = least[1], most[1]
    if high - low <= ALIKE * max(low, 1.0) if math.isfinite(high) else low == high:
        return Fault(
            "E316",
            f"the factor of safety does not depend on {key.path}: it is {shown(low)} {span}{_open(key, refused)}",
            "",
            _ADVICE_WITHOUT_FACTOR.get(low, ""),
        )
    jumps = [one for one in others if one.how == "jump"]
    if jumps:
        (a, at_a), (b, at_b) = jumps[0].bracket
        where = f"between {key.path} = {key.shown(a)} and {key.shown(b)}"
        where = f"at {key.path} = {key.shown(a)}" if key.shown(a) == key.shown(b) else where
        return Fault(
            "E317",
            f"the factor jumps across {number(target)} {where}: {shown(at_a)} below, {shown(at_b)} above; no value "
            f"gives {number(target)}",
            "",
            "Contact with a joint is lost or gained there, or nothing drives the block.",
        )
    if others:
        one = others[0]
        (a, at_a), (b, at_b) = one.bracket
        _, _, code, message = next((part for part in refused if a < part[0] < b), ("", "", UNSETTLED, NO_CONVERGENCE))
        where = message if code == UNSETTLED else f"the input is refused: {code} {message}"
        return Fault(
            "E319",
            f"{number(target)} is passed between {key.path} = {key.shown(a)} ({shown(at_a)}) and {key.shown(b)} "
            f"({shown(at_b)}), where {where}",
            "",
            _LESS_WORK.format(key.path) if code == UNSETTLED else "",
        )
    side, end = ("at most", most) if high < target else ("at least", least)
    is_movable = end[0] in within and (key.kind in ("length", "force", "pressure") or key.low < end[0] < key.high)
    return Fault(
        "E315",
        f"no value of {key.path} {span} gives {number(target)}: the factor is {side} {shown(end[1])}, "
        f"at {key.shown(end[0], 7)} (it lies between {shown(low)} and {shown(high)}){_open(key, refused)}",
        "",
        f"That is the end of the range: try {key.path}=lo:hi." if is_movable else "",
    )


def _open(key: Key, refused: Sequence[tuple[float, float, str, str]]) -> str:
    """Where a factor is not known: what was not computed is no proof."""
    ends = [(low, high) for low, high, code, _ in refused if code == UNSETTLED]
    if not ends:
        return ""
    low, high = (key.shown(end, 7) for end in ends[0])
    where = f"from {low} to {high}" if low != high else f"at {low}"
    more = f" and in {len(ends) - 1} more stretches" if len(ends) > 1 else ""
    return f"; {where}{more} {NO_CONVERGENCE}: it may lie there"


def shown(factor: float) -> str:
    """A factor as a sentence has it."""
    if math.isinf(factor):
        return "infinite (nothing drives it)"
    return "none (nothing holds it)" if factor == 0.0 else f"{factor:.6g}" if factor < _HUGE else f"beyond {_HUGE:g}"


def notices(solution: Solution) -> Iterator[Notice]:
    """Yield what is to be known beside the value: of moments, of other values, of the order of loads, of inputs."""
    key, target, answer = solution.key, solution.target, solution.answer
    closed = solution.closed_form
    other = closed.roots[0] if closed is not None and closed.roots else None
    if answer is not None and solution.moments_govern:
        than = f"the closed form, which knows no moments, has {key.shown(other.value)}" if other else "it has none"
        yield Notice("W353", f"moments govern: use {key.shown(answer.value)}, PRE-IE's; {than}")
    elif answer is not None and closed is not None and other is None:
        yield Notice("W353", f"the closed form has no such value: {closed.reason.message if closed.reason else ''}")
    elif answer is None and other is not None:
        point = other.both
        why = "with moments there is no such value" if point.factors else f"there {point.code} {point.message}"
        yield Notice("W353", f"the closed form has {key.shown(other.value)}, but {why}: do not use it")
    yield from beyond_sense(key.path, None if answer is None else answer.value)
    if answer is not None:
        yield from answer.notes
    if len(solution.pre_ie.roots) > 1:
        further = [f"{key.shown(one.value)} ({one.status})" for one in solution.pre_ie.roots[1:]]
        others = ", ".join(further[:_MOST_LISTED]) + (", …" if len(further) > _MOST_LISTED else "")
        yield Notice("W356", f"{len(solution.pre_ie.roots)} values give {number(target)}; further: {others}")
    for answers in (closed, solution.pre_ie):
        if answers is not None:
            yield from _missed(answers, key, target)
    if answer is not None:
        for one in solution.pre_ie.others:
            what = "jumps across" if one.how == "jump" else "passes (where there is no factor)"
            yield Notice("W356", f"the factor also {what} {number(target)} at {key.shown(one.value)}: "
                                 f"{shown(one.bracket[0][1])} below, {shown(one.bracket[1][1])} above")  # fmt: skip

    yield from new_notices(notices_of_inputs(solution.design, [key.path]), () if answer is None else answer.notes)


def beyond_sense(path: str, value: float | None) -> Iterator[Notice]:
    """W302 where a seismic coefficient is more than earthquakes give."""
    if path == "loads.seismic.k" and value is not None and value > GREATEST_K:
        yield Notice("W302", f"k {number(float(f'{value:.3g}'))} is beyond what nearly any earthquake gives (1 g): "
                             "something else than shaking decides")  # fmt: skip


def _missed(answers: Answers, key: Key, target: float) -> Iterator[Notice]:
    """A root that gives the target less well than it should when it is put back."""
    name = {"closed_form": "the closed form", "pre_ie": "PRE-IE"}[answers.method]
    for root in answers.roots:
        miss = abs(root.factor - target)
        (a, below), (b, above) = root.bracket
        if root.how != "root":
            yield Notice("W356", f"the factor falls past {number(target)} at once at {key.shown(root.value)}: from "
                                 f"{shown(below)} to {shown(above)}, or to none")  # fmt: skip
        elif miss > TOLERANCE[answers.method]:
            text = f"at {key.shown(root.value)} {name} misses {number(target)} by {miss:.1g}: "
            text += f"between {key.shown(a, 16)} and {key.shown(b, 16)} the factor is no smoother"
            yield Notice("W356", text)
