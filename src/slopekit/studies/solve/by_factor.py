"""The value of one number of a design at which its factor of safety is a target, by both methods."""

import time
from collections.abc import Iterator
from dataclasses import replace

from slopekit.core.errors import DesignError, Fault, Notice
from slopekit.design.common import Design
from slopekit.design.parts import ON_FACTOR
from slopekit.design.reading.files import with_values
from slopekit.kinds import also_falls_short, dilates, kind_of, peak_only
from slopekit.preie.solvers import work_limit
from slopekit.studies.keys import key_of, values_of
from slopekit.studies.points import (
    Point,
    rules_left_out,
)
from slopekit.studies.protocol import Advance
from slopekit.studies.ranges import Within, parse_within
from slopekit.studies.running import Crew
from slopekit.studies.solve.factor_request import (
    FactorRequest,
    answers_of,
    crossings_of,
    factor_notices,
    level_at,
    look_roughly,
    runs_of,
)
from slopekit.studies.solve.roots import Crossing, RootSearch
from slopekit.studies.solve.solutions import (
    ALIKE,
    Answers,
    Solution,
    SolvedValue,
    notices,
    refuse_as_run,
    target_of,
)

_UNIT_LOAD = 1.0
_OF_PATH = 0.5  # of the work of one answer, for the path in a load
_ABOVE = 1.0 + 1e-6  # times the value at which that ends: blocks that tip do so at once there
_FURTHER = (1.02, 1.1, 1.3, 2.0, 4.0)  # times the value, or divided by it, until the target is passed


def look_from_path(search: RootSearch[Point], asked: FactorRequest) -> list[Crossing[Point]]:
    """Where many blocks fail as a load comes on last, at the strength divided by the target, and from there on.

    Wherever that path ends, the value is where the factor, the strength divided last, is the target, or falls past it.
    """
    at_load = kind_of(asked.design).at_load
    assert at_load is not None
    without, unit = (
        with_values(asked.design, values_of(asked.design, [asked.key], [value])) for value in (0.0, _UNIT_LOAD)
    )
    with work_limit.allowed(_OF_PATH * work_limit.MOST):
        last = at_load(without, unit, asked.target)
    if last is None or not asked.low < last < asked.high:
        return []
    here = search.at(last)
    if here.level is None or abs(here.level) <= search.near:
        return crossings_of(search)
    stands = here.level > 0.0
    steps = [_ABOVE, *_FURTHER] if stands else [1.0 / by for by in _FURTHER]
    values = [by * here.at for by in steps if asked.low < by * here.at < asked.high]
    for value in (*values, asked.high if stands else max(asked.low, 0.0)):
        if level_at(search.at(value)) * here.level < 0.0:
            break
    return crossings_of(search)


_EDGE = 1e-10  # of a value: how near edges of validity and changes of status are found
_SECTIONS = 24
_EACH_BRANCH = 8  # parts into which a stretch of one status is divided
_FINE = 33, 6, 3  # evenly over the range, closer to the present value, to a decade
_MOST_SHARED = 12  # places of the grid at which PRE-IE is asked too
_PARTS = (0.25, 0.5, 0.75)  # of a stretch that has no place of the grid
_BRACKET = 1e-7  # of a value, to both sides: where PRE-IE looks for its own root beside that of the closed form
_MOST_JUMPS = 4  # of the closed form that PRE-IE looks at from both sides
_BESIDE = 1e-3  # a level of PRE-IE at the closed form's root within this: its own root is beside it
_TURNS_WITHIN = 0.1  # of the target: where PRE-IE turns around further off it is let be


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
    began = time.perf_counter()
    path, equals, text = key.partition("=")
    if equals and within is not None:
        raise DesignError([Fault("E312", f"{path} has two ranges", f"{key}, within", "Give one of them.")])
    one = key_of(design, path)
    if one.whole:
        message = f"{one.path} counts something: it cannot be solved for"
        raise DesignError([Fault("E311", message, one.path, "Sweep it: slopekit sweep design.yaml KEY=1,2,3")])
    low, high = parse_within(one, text if equals else within)
    target, own = target_of(design, fos)
    closed: Answers | None = None
    asked = FactorRequest(design, one, low, high, target, crew, advance)
    if kind_of(design).closed_form is not None:
        quick = asked.search("closed_form")
        _look_closely(quick, asked)
        crossings = crossings_of(quick)
        closed = answers_of("closed_form", asked, quick, crossings)
        search = asked.search("pre_ie")
        _look_again(search, quick, crossings, asked)
        pre_ie = answers_of("pre_ie", asked, search, crossings_of(search))
    else:
        search = asked.search("pre_ie", slow=True)
        crossings = look_from_path(search, asked) if asked.drives_blocks else []
        if not crossings:
            crossings = look_roughly(search, asked, bool(equals) or within is not None)
        pre_ie = answers_of("pre_ie", asked, search, crossings)
    if pre_ie.least is None:
        refuse_as_run(design, asked.before(), asked.points.values())
    if pre_ie.roots:
        first = pre_ie.roots[0]
        first = replace(first, notes=(*first.notes, *_beside(asked, first)))
        pre_ie = replace(pre_ie, roots=(first, *pre_ie.roots[1:]))
    if closed is not None:
        closed = replace(closed, roots=tuple(replace(root, both=asked.both(root.value)) for root in closed.roots))
    solution = Solution(design, one, target, (low, high), own, asked.before(), closed, pre_ie)
    said = tuple(notices(solution))
    said += (*_at_peak(solution), *(rules_left_out(design, ON_FACTOR) if own else ()))
    return replace(solution, warnings=said, seconds=time.perf_counter() - began)


def _at_peak(solution: Solution) -> tuple[Notice, ...]:
    """W417: the target is met by the peak strength, and what is left at the value found on the residual strength."""
    answer = solution.answer
    if answer is None:
        return peak_only(solution.design, "factors are those")
    found = with_values(solution.design, values_of(solution.design, [solution.key], [answer.value]))
    return peak_only(found, "the target is met by the factor")


def _look_closely(search: RootSearch[Point], asked: FactorRequest) -> None:
    """A closed form takes a millisecond: edges, changes of status and turning points are all found."""
    search.add(asked.grid(*_FINE))
    search.find_edges(_EDGE)
    search.find_changes(_EDGE)
    # a narrow stretch of one kind may have no place of the grid
    for run in list(runs_of(search.samples, lambda sample: "" if sample.level is None else sample.label)):
        low, high = run[0].at, run[-1].at
        search.add(low + (high - low) * k / _EACH_BRANCH for k in range(1, _EACH_BRANCH))
    search.find_extremes(_SECTIONS)


def _look_again(
    search: RootSearch[Point], quick: RootSearch[Point], crossings: list[Crossing[Point]], asked: FactorRequest
) -> None:
    """PRE-IE where the closed form passes the target, and here and there where it lies above.

    Moments only take from the factor, so where the forces alone are below the target nothing crosses it; joints that
    dilate are looked at everywhere, and so is a factor that never gets there, for what it reaches.
    """
    taken = set[float]()
    if asked.key.value is not None and asked.low <= asked.key.value <= asked.high:
        taken.add(asked.key.value)
    jumps = [crossing for crossing in crossings if crossing.how != "root"][:_MOST_JUMPS]
    taken |= {end.at for crossing in jumps for end in (crossing.before, crossing.after)}
    roots = [crossing.best.at for crossing in crossings if crossing.how == "root"]
    for root, sample in zip(roots, search.add(roots), strict=True):
        width = _BRACKET * max(abs(root), 1e-6 * search.span)
        if abs(level_at(sample)) < _BESIDE:
            taken |= {place for place in (root - width, root + width) if asked.low <= place <= asked.high}
    everywhere = dilates(asked.design) or asked.key.path.endswith(".dilation") or not crossings
    # where the closed form lies above the target without a break, or wherever it has a factor
    above = runs_of(quick.samples, lambda sample: sample.level is not None and (everywhere or sample.level >= -ALIKE))
    stretches = [(run[0].at, run[-1].at) for run in above]
    if not crossings and stretches:
        taken |= {min(quick.defined, key=level_at).at, max(quick.defined, key=level_at).at}
    grid = set(asked.grid(*_FINE))
    for a, b in stretches:
        inside = [place for place in grid if a < place < b] or [a, b]
        inside = sorted({*inside, *(a + part * (b - a) for part in _PARTS)} if len(inside) < len(_PARTS) else inside)
        taken |= {inside[round(k * (len(inside) - 1) / _MOST_SHARED)] for k in range(_MOST_SHARED + 1)}
    search.add(sorted(taken) or [sample.at for sample in quick.samples[:: max(1, len(quick.samples) // 3)]])
    for a, b in stretches:
        _towards_ends(search, quick, a, b)
    if any(sample.found.moments_govern for sample in search.samples):
        search.find_extremes(_SECTIONS // 3, within=_TURNS_WITHIN, ends=False)


def _towards_ends(search: RootSearch[Point], quick: RootSearch[Point], a: float, b: float) -> None:
    """Where the factor has not got above the target inside a stretch it may do so near an end that is high."""
    if any(level_at(sample) > 0.0 for sample in search.defined if a <= sample.at <= b):
        return
    for end, other in ((a, b), (b, a)):
        if level_at(quick.at(end)) > _TURNS_WITHIN:
            search.add(end + part * (other - end) for part in (1e-2, 1e-4))


def _beside(asked: FactorRequest, solved: SolvedValue) -> Iterator[Notice]:
    """What else a run says at a value: W507 of what acceptance asks besides, W504 of bonds lost one by one."""
    if solved.both.factors is None or solved.both.factors.limit is None:
        return
    yield from also_falls_short(solved.both.factors.also, asked.target, f"at {asked.key.shown(solved.value, 4)}")
    said = kind_of(asked.design).beside(with_values(asked.design, values_of(asked.design, [asked.key], [solved.value])))
    yield from factor_notices(asked, solved.value, Point(replace(solved.both.factors, notes=said)))
