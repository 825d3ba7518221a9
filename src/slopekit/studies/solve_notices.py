"""Why there is no value that gives the target, and what is to be known beside one that does."""

import math
from collections.abc import Iterator, Sequence

from slopekit.errors import Fault, Notice
from slopekit.orientation import number
from slopekit.studies.keys import Key
from slopekit.studies.solutions import ALIKE, TOLERANCE, Answers, Found, Solution

_HUGE = 1e6
_MOST_LISTED = 6
End = tuple[float, float] | None


def reason_of(
    key: Key, target: float, within: tuple[float, float], others: Sequence[Found], least: End, most: End,
    refused: Sequence[tuple[float, float, str, str]],
) -> Fault:  # fmt: skip
    """Why no value of a key gives the target: E315 to E319."""
    all_round = key.period is not None and within[1] - within[0] >= key.period
    span = "all round" if all_round else f"from {key.shown(within[0], 7)} to {key.shown(within[1], 7)}"
    if least is None or most is None:
        _, _, code, message = refused[0]
        more = f" (and {len(refused) - 1} more reasons)" if len(refused) > 1 else ""
        text = f"no value of {key.path} {span} gives a block with a factor: {code} {message}{more}"
        return Fault("E318", text, "", f"Another range: {key.path}=lo:hi.")
    low, high = least[1], most[1]
    if high - low <= ALIKE * max(low, 1.0) if math.isfinite(high) else low == high:
        text = f"the factor of safety does not depend on {key.path}: it is {shown(low)} {span}"
        return Fault("E316", text, "", _unused(key))
    jumps = [one for one in others if one.how == "jump"]
    if jumps:
        (a, at_a), (b, at_b) = jumps[0].bracket
        where = f"between {key.path} = {key.shown(a)} and {key.shown(b)}"
        where = f"at {key.path} = {key.shown(a)}" if key.shown(a) == key.shown(b) else where
        text = (
            f"the factor jumps across {number(target)} {where}: {shown(at_a)} below, {shown(at_b)} above; no value "
            f"gives {number(target)}"
        )
        return Fault("E317", text, "", "Contact with a joint is lost or gained there, or nothing drives the block.")
    if others:
        one = others[0]
        (a, at_a), (b, at_b) = one.bracket
        inside = next((part for part in refused if a < part[0] < b), ("", "", "", "no convergence"))
        text = (
            f"{number(target)} is passed between {key.path} = {key.shown(a)} ({shown(at_a)}) and {key.shown(b)} "
            f"({shown(at_b)}), where the input is refused: {inside[2]} {inside[3]}"
        )
        return Fault("E319", text)
    side, end = ("at most", most) if high < target else ("at least", least)
    text = (
        f"no value of {key.path} {span} gives {number(target)}: the factor is {side} {shown(end[1])}, "
        f"at {key.shown(end[0], 7)} (it lies between {shown(low)} and {shown(high)})"
    )
    return Fault("E315", text, "", end_advice(key, end[0], within))


def end_advice(key: Key, value: float, within: tuple[float, float]) -> str:
    """What to try where the nearest is reached at an end of the range that could be moved on."""
    further = key.kind in ("length", "force", "pressure") or key.low < value < key.high
    return f"That is the end of the range: try {key.path}=lo:hi." if value in within and further else ""


def _unused(key: Key) -> str:
    if key.path.startswith("strength.") and key.path.endswith((".phi", ".c")):
        return "No joint that carries a load has this strength, or another joint holds alone."
    if key.path.startswith("strength."):
        return "The limit does not depend on stiffness, nor on tension where joints open."
    if key.kind in ("density", "unit weight", "acceleration"):
        return "Without cohesion, water and other loads the weight drops out of the factor."
    return ""


def shown(factor: float) -> str:
    """A factor as a sentence has it."""
    if math.isinf(factor):
        return "infinite (nothing drives it)"
    return "none (nothing holds it)" if factor == 0.0 else f"{factor:.6g}" if factor < _HUGE else f"beyond {_HUGE:g}"


def notices(solution: Solution) -> Iterator[Notice]:
    """What is to be known beside the value: W355 to W358."""
    key, target, found = solution.key, solution.target, solution.answer
    closed = solution.closed_form
    other = closed.roots[0] if closed is not None and closed.roots else None
    if found is not None and solution.moments_govern:
        than = f"the closed form, which knows no moments, has {key.shown(other.value)}" if other else "it has none"
        yield Notice("W355", f"moments govern: use {key.shown(found.value)}, PRE-IE's; {than}")
    elif found is not None and closed is not None and other is None:
        yield Notice("W355", f"the closed form has no such value: {closed.reason.message if closed.reason else ''}")
    elif found is None and other is not None:
        point = other.both
        why = "with moments there is no such value" if point.factors else f"there {point.code} {point.message}"
        yield Notice("W355", f"the closed form has {key.shown(other.value)}, but {why}: do not use it")
    if len(solution.pre_ie.roots) > 1:
        further = [f"{key.shown(one.value)} ({one.status})" for one in solution.pre_ie.roots[1:]]
        others = ", ".join(further[:_MOST_LISTED]) + (", …" if len(further) > _MOST_LISTED else "")
        yield Notice("W356", f"{len(solution.pre_ie.roots)} values give {number(target)}; further: {others}")
    for answers in (closed, solution.pre_ie):
        if answers is not None:
            yield from _missed(answers, key, target)
    if found is not None:
        for one in solution.pre_ie.others:
            what = "jumps across" if one.how == "jump" else "passes (where the input is refused)"
            yield Notice("W358", f"the factor also {what} {number(target)} at {key.shown(one.value)}: "
                                 f"{shown(one.bracket[0][1])} below, {shown(one.bracket[1][1])} above")  # fmt: skip


def _missed(answers: Answers, key: Key, target: float) -> Iterator[Notice]:
    """A root that gives the target less well than it should when it is put back."""
    name = {"closed_form": "the closed form", "pre_ie": "PRE-IE"}[answers.method]
    for root in answers.roots:
        miss = abs(root.factor - target)
        if miss > TOLERANCE[answers.method]:
            (a, _), (b, _) = root.bracket
            text = f"{key.shown(root.value)}, put back into {name}, misses {number(target)} by {miss:.1g}: "
            text += f"between {key.shown(a, 16)} and {key.shown(b, 16)} the factor is no smoother"
            yield Notice("W357", text)
