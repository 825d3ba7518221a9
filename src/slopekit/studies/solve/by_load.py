"""A load on many blocks at which their factor of safety is a target.

The path in the load says where to look, and is the other end of what histories give.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import pairwise

from slopekit.core.errors import DesignError, Notice
from slopekit.design.reading.files import with_values
from slopekit.kinds import kind_of
from slopekit.kinds.protocol import AtLoad, Factors
from slopekit.notices import lost_cohesion_notices
from slopekit.preie.solvers import work_limit
from slopekit.studies.keys import values_of
from slopekit.studies.points import UNSETTLED, Point, factor_at, status_of
from slopekit.studies.solve.factor_request import (
    SAME,
    FactorRequest,
    answers_of,
    crossings_of,
    level_at,
    look_roughly,
    said_of_factor,
)
from slopekit.studies.solve.roots import Crossing, RootSearch, Sample
from slopekit.studies.solve.solutions import TOLERANCE, Answers, SolvedValue, cut_short

_K, _UNIT_LOAD = "loads.seismic.k", 1.0
_OF_PATH = 0.5  # of the work that is allowed, for the path in a load
_PUT_BACK = 0.1 * work_limit.MOST  # for the factor of a limit state: it vouches for itself
_ABOVE = 1e-4  # of a value: a factor that falls on this by more than a jump does so at once
_FURTHER = (1.02, 1.1, 1.3, 2.0, 4.0)  # times the value of the path in a load, where the factor is above the target
_SECANTS = 10  # from there to the value where it is the target
_LOAD_RESOLUTION, _LOAD_NEAR, _LOAD_JUMP = 1e-7, 4e-7, (1e-4, 0.02)
_MORE = 1e-3  # of a value: with less cohesion one that is higher by more is said
_FALLS = (0.0, 0.01, 0.1)  # of the range: where a factor below the target has to fall, to be left alone


def of_load(asked: FactorRequest, whole: bool, lower: bool) -> tuple[Answers, bool, float | None]:
    """What there is of a load on many blocks within the work of one answer.

    With it whether that work was all done, and where the blocks fail as the load comes on last, beyond the range.
    """
    search = RootSearch(partial(asked.samples, "pre_ie"), asked.high - asked.low, resolution=_LOAD_RESOLUTION,
                    near=_LOAD_NEAR, same=SAME, jump=_LOAD_JUMP)  # fmt: skip
    with work_limit.allowed(work_limit.MOST):
        with work_limit.part(_OF_PATH):
            last = _path_in_load(asked)
            cut = last is None and work_limit.is_spent()
        beyond = None
        if last is not None and not asked.low <= last.multiplier <= asked.high:
            beyond, last = last.multiplier, None
        direct, jumps, crossings = _driven(search, asked, whole, lower, last)
        spent = work_limit.is_spent()
        answers = answers_of("pre_ie", asked, search, crossings) if direct is None else _in_load(asked, direct, jumps)
        if answers.roots and not spent:
            first = answers.roots[0]
            first = replace(first, notes=(*first.notes, *_higher_without_cohesion(asked, first)))
            answers = replace(answers, roots=(first, *answers.roots[1:]))
    if spent and not answers.roots:
        return replace(answers, reason=cut_short(asked.key, asked.target, answers.least, answers.most)), True, beyond
    if answers.roots:
        first = answers.roots[0]
        if last is not None and direct is not last:
            first = replace(first, load_last=(last.multiplier, last.runs))
        first = replace(first, not_compared=_not_compared(asked, first, cut, beyond))
        answers = replace(answers, roots=(first, *answers.roots[1:]))
    return answers, spent, beyond


def _higher_without_cohesion(asked: FactorRequest, solved: SolvedValue) -> Iterator[Notice]:
    """W477: with less cohesion the same blocks stand a higher load.

    A state at rest without some cohesion is one with it, too: in balance, within strength, open where it was open. But
    bonds that hold longer let go under more load, of other contacts, and what is left may carry less.
    """
    lost = any(notice.code == "W307" for notice in solved.notes)
    cohesive = [name for name, given in getattr(asked.design, "strengths", ()) if given.cohesion_kpa > 0.0]
    highest: tuple[float, list[str]] | None = None
    for without in ([[name] for name in cohesive] + [cohesive] * (len(cohesive) > 1)) if lost else ():
        try:
            less = with_values(asked.design, {f"strength.{name}.c": 0.0 for name in without})
        except DesignError:  # a strength that is not given by c
            continue
        at = _path_in_load(replace(asked, design=less))
        if at is not None and at.multiplier > max(solved.value * (1.0 + _MORE), highest[0] if highest else 0.0):
            highest = at.multiplier, without
    if highest is not None:
        named, stands = " and ".join(highest[1]), asked.key.shown(highest[0], 4)
        yield Notice("W477", f"without the cohesion of {named} the blocks stand {asked.key.path} up to {stands}, with "
                     f"it {asked.key.shown(solved.value, 4)}: bonds that hold longer break under more load, and less "
                     "is left; the lower of the two is the answer")  # fmt: skip


def _not_compared(asked: FactorRequest, solved: SolvedValue, cut: bool, beyond: float | None) -> str:
    """Why the other of the two histories of a load says nothing of a value; empty where it does."""
    if cut:
        return "the work for the load coming on last was done before the blocks were at their limit"
    if beyond is not None:
        return f"as the load comes on last the blocks fail at {asked.key.shown(beyond)} only, beyond what was looked at"
    if solved.put_back or solved.strength_last is not None:
        return ""
    there = asked.points.get(solved.value)
    status = "" if there is None else status_of(there, "pre_ie")
    if status in ("", UNSETTLED):
        return "the work for their factor with the strength divided last was done, or it was not found"
    return f"with the strength divided last they have no factor there ({status})"


def _path_in_load(asked: FactorRequest) -> AtLoad | None:
    """Where the blocks fail as the load comes on last, at the strength divided by the target; None: nowhere."""
    at_load = kind_of(asked.design).at_load
    assert at_load is not None
    without, unit = (
        with_values(asked.design, values_of(asked.design, [asked.key], [value])) for value in (0.0, _UNIT_LOAD)
    )
    return at_load(without, unit, asked.target)


def _driven(
    search: RootSearch[Point], asked: FactorRequest, whole: bool, lower: bool, last: AtLoad | None
) -> tuple[AtLoad | None, bool, list[Crossing[Point]]]:
    """The value of the path in the load, or of a jump, where that is the answer; else where the target is passed.

    Between them whether the factor was seen to jump past the target there.
    """
    if last is None:
        falls = asked.key.path == _K and not whole and _falls_from_below(search, asked)
        return None, False, [] if falls else look_roughly(search, asked, whole)
    with work_limit.allowed(work_limit.MOST if lower or last.runs is not None else _PUT_BACK):
        here = search.at(last.multiplier)
    factor = factor_at(here.found, "pre_ie")
    if here.level is None or factor is None or (lower and factor >= asked.target - TOLERANCE["pre_ie"]):
        return last, False, []
    if abs(factor - asked.target) <= TOLERANCE["pre_ie"] * asked.target:
        return last, False, []
    other = here
    if here.level > 0.0:
        if here.at > 0.0 and _jumps_down(here, search.at(min(here.at * (1.0 + _ABOVE), asked.high))):
            return last, True, []  # they tip there, whatever their strength
        other = next((beyond for beyond in _further(search, asked, here.at) if level_at(beyond) < 0.0), here)
        if other is here:
            return last, False, []
    else:
        other = search.at(max(asked.low, 0.0))  # where the path in the load begins
        if level_at(other) < 0.0 and asked.low < 0.0:
            return None, False, look_roughly(search, asked, whole)
    if level_at(other) * here.level < 0.0:
        _close_in(search, other, here)
    crossings = crossings_of(search)
    if crossings and not crossings[0].rises:
        before = crossings[0].before
        if crossings[0].how == "jump":
            return AtLoad(before.at, crossings[0].after.label, None), True, []
        if crossings[0].how == "gap" and before.at == here.at:
            return last, True, []  # beyond it no factor is found, then one below the target
    return None, False, crossings


def _falls_from_below(search: RootSearch[Point], asked: FactorRequest) -> bool:
    """Whether the factor is below the target without the load, and falls as it comes on."""
    levels = [search.at(asked.low).level]
    if levels[0] is None or levels[0] >= 0.0:
        return False
    levels += [sample.level for sample in search.add(asked.low + part * (asked.high - asked.low) for part in _FALLS)]
    return all(b is not None and b <= a for a, b in pairwise(levels[1:]) if a is not None)


def _jumps_down(here: Sample[Point], above: Sample[Point]) -> bool:
    return above.level is not None and above.level < 0.0 and level_at(here) - above.level > _LOAD_JUMP[1]


def _further(search: RootSearch[Point], asked: FactorRequest, value: float) -> Iterator[Sample[Point]]:
    """Places beyond a value, ever further; at the end that of the range."""
    for place in (times * value for times in _FURTHER):
        if value < place < asked.high:
            yield search.at(place)
    yield search.at(asked.high)


def _close_in(search: RootSearch[Point], one: Sample[Point], other: Sample[Point]) -> None:
    """False positions between two places of either sign until a level is near zero (Illinois rule)."""
    at_one, at_other = level_at(one), level_at(other)
    for _ in range(_SECANTS):
        part = at_one / (at_one - at_other)
        new = search.at(one.at + part * (other.at - one.at))
        if new.level is None or abs(new.level) <= search.near or search.narrow(one.at, other.at):
            return
        if new.level * at_other < 0.0:
            one, at_one = other, at_other
        else:
            at_one *= 0.5
        other, at_other = new, new.level


def _in_load(asked: FactorRequest, at: AtLoad, jumps: bool) -> Answers:
    """The answer of the path in the load: at this value its limit state has the target for its factor, exactly.

    Where the motion did not settle the value is that of the last state at rest; the bracket ends where they run.
    """
    known = asked.points.get(at.multiplier)
    last = None if known is None else factor_at(known, "pre_ie")
    evaluations = 1 + len(asked.points)
    notes = () if at.lost is None else tuple(lost_cohesion_notices(at.lost, "load"))
    if known is not None and known.factors is not None:  # of the factor there, what the path in the load does not say
        said = {notice.code for notice in notes}
        notes += tuple(notice for notice in said_of_factor(asked, at.multiplier, known) if notice.code not in said)
    if last is not None and at.runs is None and abs(last - asked.target) <= TOLERANCE["pre_ie"] * asked.target:
        assert known is not None
        here = at.multiplier, last
        root = SolvedValue(
            "root", at.multiplier, last, at.status, (here, here), False, known, load_last=(at.multiplier, None),
            notes=notes,
        )  # fmt: skip
    else:
        also = None if known is None or known.factors is None else known.factors.also
        point = Point(Factors(at.status, asked.target, None, None, None, None, False, True, also=also))
        here = (at.multiplier, asked.target)
        beyond = here if at.runs is None else (at.runs, math.nan)
        root = SolvedValue(
            "root", at.multiplier, asked.target, at.status, (here, beyond), False, point, False, last, jumps=jumps,
            notes=notes,
        )  # fmt: skip
    return Answers("pre_ie", (root,), (), None, None, (), (0.0, root.runs or at.multiplier), evaluations, None)
