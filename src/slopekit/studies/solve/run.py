"""The value of one number of a design that gives a factor of safety.

>>> import slopekit as sk
>>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
...          "strength": {"weak": {"c": 50, "phi": 20}}}
>>> found = solve(sk.load(wedge), "strength.weak.c", fos=1.5).answer
>>> round(found.value, 3), round(found.factor, 9)
(43.41, 1.5)
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import groupby, pairwise
from typing import Annotated

from slopekit.core.errors import Notice, fail
from slopekit.design.common import Design
from slopekit.design.parts import ON_FACTOR
from slopekit.design.reading.files import with_values
from slopekit.kinds import also_falls_short, kind_of, peak_only
from slopekit.preie.solvers import work_limit
from slopekit.studies.keys import key_of, values_of
from slopekit.studies.points import UNSETTLED, Method, Point, factor_at, rules_left_out
from slopekit.studies.protocol import (
    DESK,
    ADesign,
    Advance,
    Argument,
    Jobs,
    Option,
    Scheduler,
    Workplace,
    number_of,
    study,
)
from slopekit.studies.ranges import Within, parse_within
from slopekit.studies.roots import Crossing, RootSearch, level_at
from slopekit.studies.running import Crew, checked_crew
from slopekit.studies.solve.factor_request import FINE, ROUGH, FactorRequest, Samples, factor_notices
from slopekit.studies.solve.solutions import (
    ALIKE,
    NO_CONVERGENCE,
    Answers,
    Solution,
    SolvedValue,
    notices,
    reason_of,
    refuse_as_run,
    target_of,
)

_ABOUT = 60  # evaluations: for the bar
_UNIT_LOAD = 1.0
_OF_PATH = 0.5  # of the work of one answer, for the path in a load
_FURTHER = (1.0 + 1e-6, 1.02, 1.1, 1.3, 2.0, 4.0)  # times the value at which that ends: blocks that tip do so at once
_BRACKET = 1e-7  # of a value, to both sides: where PRE-IE looks for its own root beside that of the closed form

_SHORT = 1e-2  # of a value: so far from where the planes cut none, a block is no sliver


@study
def solve(
    design: ADesign,
    key: Annotated[str, Argument("strength.weak.phi, or with a range: slope.height=10m:40m", "KEY")],
    *,
    fos: Annotated[float | None, Option("Factor of safety wanted [the acceptance rule's].", number_of)] = None,
    within: Within | None = None,
    jobs: Jobs = 1,
    scheduler: Scheduler = None,
    desk: Workplace = DESK,
) -> Solution:
    """The value of any one number of a design that gives a factor of safety, by both methods.

    Exit codes: 0 found, 1 there is no such value (the sheet says why), 4 the methods disagree at it.

    Raises
    ------
    DesignError
        E280 a design without a file, E310 and E311 for the key, E312 for the range, E314 for the target.
        Where no value gives the target, `answer` is None and `reason` says why.

    Notes
    -----
    In Python `within` may be the range, (low, high) or "lo:hi". The roots of F(value) - target are found by bracketing,
    all that the range has; `rounded` is the first in four digits, on the safe side.

    Examples
    --------
    >>> import slopekit as sk
    >>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
    >>> round(sk.solve(sk.load(wedge), "water.fill", fos=1.2).answer.value, 4)
    0.6805
    """
    crew = checked_crew(jobs, scheduler)
    with desk.bar("evaluations", _ABOUT) as advance:
        return for_factor(design, key, fos, within, crew, advance)


def for_factor(
    design: Design, key: str, fos: float | None, within: Within | None, crew: Crew, advance: Advance,
) -> Solution:  # fmt: skip
    """The value of one number of a design at which its factor of safety is a target.

    Parameters
    ----------
    fos : the target; None takes that of the design's acceptance rule
    within : between which values to look (numbers, or texts with units); None: what such a number can be
    crew : who evaluates the grid; advance : told of every evaluation

    The factor is looked at on a grid that is fine near the present value; every place where it passes the target is
    narrowed down, edges of validity and changes of status are looked at from both sides. Where nothing drives the
    block it counts as infinite, where nothing holds it as zero.

    Raises
    ------
    DesignError
        E280 a design without a file, E310 and E311 for the key, E312 for the range, E314 for the target.
    """
    path, equals, text = key.partition("=")
    if equals and within is not None:
        fail("E312", f"{path} has two ranges", f"{key}, within", "Give one of them.")
    one = key_of(design, path)
    if one.whole:
        fail(
            "E311",
            f"{one.path} counts something: it cannot be solved for",
            one.path,
            "Sweep it: slopekit sweep design.yaml KEY=1,2,3",
        )
    low, high = parse_within(one, text if equals else within)
    target, own = target_of(design, fos)
    asked = FactorRequest(design, one, low, high, target, crew, advance)
    if asked.design.HAS_CLOSED_FORM:
        asked, closed, pre_ie = _by_both(asked)
    else:
        closed, pre_ie = None, _by_pre_ie_alone(asked, bool(equals) or within is not None)
    if pre_ie.least is None:
        refuse_as_run(design, asked.before(), asked.points.values())
    if pre_ie.roots:
        first = pre_ie.roots[0]
        first = replace(first, notes=(*first.notes, *_beside(asked, first)))
        pre_ie = replace(pre_ie, roots=(first, *pre_ie.roots[1:]))
    solution = Solution(design, one, target, (low, high), own, asked.before(), closed, pre_ie)
    said = tuple(notices(solution))
    said += (*_at_peak(solution), *(rules_left_out(design, ON_FACTOR) if own else ()))
    return replace(solution, warnings=said)


def _at_peak(solution: Solution) -> tuple[Notice, ...]:
    """W417: the target is met by the peak strength, and what is left at the value found on the residual strength."""
    answer = solution.answer
    if answer is None:
        return peak_only(solution.design, "factors are those")
    found = with_values(solution.design, values_of(solution.design, [solution.key], [answer.value]))
    return peak_only(found, "the target is met by the factor")


def _by_both(asked: FactorRequest) -> tuple[FactorRequest, Answers | None, Answers]:
    """The closed form on a grid, and PRE-IE at its places: at all of them on arrays, else where they change."""
    for columns in (asked.on_arrays, None):
        asked = replace(asked, columns=columns)
        closed, search = asked.search("closed_form"), asked.search("pre_ie")
        closed.look(asked.grid(*FINE))
        search.look(_places(asked, closed))
        if columns is None or (asked.confirms("closed_form", closed) and asked.confirms("pre_ie", search)):
            break
    return asked, _answers(asked, "closed_form", closed), _answers(asked, "pre_ie", search)


def _places(asked: FactorRequest, closed: RootSearch[Point]) -> list[float]:
    """Where PRE-IE is asked first: where the closed form changes, about its roots, and short of where blocks end."""
    places = {asked.low, asked.high}
    for a, b in pairwise(closed.samples):
        if a.label != b.label and a.level is not None and b.level is not None:
            places |= {a.at, b.at}
        elif (a.level is None) is not (b.level is None):
            outside, inside = (a.at, b.at) if a.level is None else (b.at, a.at)
            size = max(abs(inside), 1e-6 * closed.span)
            places |= {outside, inside + math.copysign(_SHORT * size, inside - outside)}
    for crossing in closed.crossings():
        root = crossing.best.at
        width = _BRACKET * max(abs(root), 1e-6 * closed.span)
        if crossing.how != "gap":
            places |= {crossing.before.at, root - width, root, root + width, crossing.after.at}
    if asked.key.value is not None:
        places.add(asked.key.value)
    return sorted(place for place in places if asked.low <= place <= asked.high)


def _by_pre_ie_alone(asked: FactorRequest, whole: bool) -> Answers:
    """Where an answer takes long: outwards from the present value, or from where the path in a load ends.

    Parameters
    ----------
    whole : look at all of the range
    """
    search, grid, own = asked.search("pre_ie"), asked.grid(*ROUGH), asked.key.value
    start = own if own is not None and asked.low <= own <= asked.high else grid[len(grid) // 2]
    last = end_of_path(asked) if asked.drives_blocks else None
    if last is not None:
        further = [last * by for by in _FURTHER] + [last / by for by in _FURTHER]
        ends = max(asked.low, 0.0), asked.high
        search.look_outwards([*ends, *(place for place in further if asked.low < place < asked.high)], last)
    if not search.passes:
        search.add(grid if whole else ())
        search.look_outwards(grid, start)
    return _answers(asked, "pre_ie", search)


def end_of_path(asked: FactorRequest) -> float | None:
    """Where many blocks fail as a load comes on last, at the strength divided by the target; None outside the range.

    Wherever that path ends, the value is where the factor, the strength divided last, is the target, or falls past it.
    """
    without, unit = (
        with_values(asked.design, values_of(asked.design, [asked.key], [value])) for value in (0.0, _UNIT_LOAD)
    )
    with work_limit.allowed(_OF_PATH * work_limit.MOST):
        last = kind_of(asked.design).at_load(without, unit, asked.target)
    return None if last is None or not asked.low < last < asked.high else last


def _answers(asked: FactorRequest, method: Method, search: RootSearch[Point]) -> Answers:
    """What a method says: the root nearest to the present value first."""
    samples, own = search.samples, asked.key.value
    levels = [level_at(sample) for sample in search.defined]
    depends = len(levels) < 2 or max(levels) - min(levels) > ALIKE
    candidates = [_found(method, asked, crossing) for crossing in (search.crossings() if depends else ())]
    candidates.sort(key=lambda one: one.value if own is None else asked.key.apart(one.value, own))
    # the factor of many blocks may fall past the target at once as a load comes on: they tip, an answer too
    roots = tuple(one for one in candidates if one.how == "root" or (asked.drives_blocks and not one.rises))
    others = tuple(sorted((one for one in candidates if one not in roots), key=lambda one: one.value))
    reached = [(sample.at, factor_at(sample.found, method) or 0.0) for sample in search.defined]
    least = min(reached, key=lambda end: end[1], default=None)
    most = max(reached, key=lambda end: end[1], default=None)
    refused = tuple(_refused(asked, method, samples))
    reason = None
    if not roots:
        reason = reason_of(asked.key, asked.target, (asked.low, asked.high), others, least, most, refused)
    return Answers(method, roots, others, least, most, refused, (samples[0].at, samples[-1].at), len(samples), reason)


def _found(method: Method, asked: FactorRequest, crossing: Crossing[Point]) -> SolvedValue:
    best, status = crossing.best, crossing.best.label
    if crossing.how != "root" and asked.drives_blocks and not crossing.rises:
        best, status = crossing.before, crossing.after.label  # the last that stands, and how it goes
    ends = [(end.at, factor_at(end.found, method) or 0.0) for end in (crossing.before, crossing.after)]
    both = asked.both(best.at)
    notes = tuple(factor_notices(asked, best.at, both)) if method == "pre_ie" else ()
    return SolvedValue(
        crossing.how, best.at, factor_at(both, method) or 0.0, status, (ends[0], ends[1]), crossing.rises, both, notes
    )


def _refused(asked: FactorRequest, method: Method, samples: Samples) -> Iterator[tuple[float, float, str, str]]:
    """Stretches of neighbouring values that are refused for the same reason, with what is said in their middle."""
    single = replace(asked, columns=None)
    runs = groupby(samples, key=lambda sample: "" if sample.level is not None else sample.label)
    for run in [list(run) for label, run in runs if label]:
        low, high = run[0].at, run[-1].at
        middle = min(run, key=lambda sample: abs(sample.at - 0.5 * (low + high)))
        message = NO_CONVERGENCE if middle.label == UNSETTLED else middle.found.message
        yield low, high, middle.label, message or single.samples(method, [middle.at])[0].found.message


def _beside(asked: FactorRequest, solved: SolvedValue) -> Iterator[Notice]:
    """What else a run says at a value: W507 of what acceptance asks besides, W504 of bonds lost one by one."""
    if solved.both.factors is None or solved.both.factors.limit is None:
        return
    yield from also_falls_short(solved.both.factors.also, asked.target, f"at {asked.key.shown(solved.value, 4)}")
    said = kind_of(asked.design).reference_notices(
        with_values(asked.design, values_of(asked.design, [asked.key], [solved.value]))
    )
    yield from factor_notices(asked, solved.value, Point(replace(solved.both.factors, notes=said)))
