"""Solve for the value of one number of a design that gives a target factor of safety.

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
from slopekit.kinds import kind_of, peak_strength_notice, whole_wedge_notice
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
from slopekit.studies.ranges import SearchRange, parse_within
from slopekit.studies.roots import Crossing, RootSearch, level_at
from slopekit.studies.running import ExecutorOptions, checked_crew
from slopekit.studies.solve.factor_request import (
    COARSE_GRID,
    FINE_GRID,
    FactorRequest,
    Samples,
    factor_notices,
)
from slopekit.studies.solve.solutions import (
    NO_CONVERGENCE,
    SAME_FACTOR_TOLERANCE,
    Answers,
    Solution,
    SolvedValue,
    notices,
    reason_of,
    refuse_as_run,
    target_of,
)

_EXPECTED_EVALUATIONS = 60  # evaluations, for the progress bar
_UNIT_LOAD = 1.0
_PATH_WORK_FRACTION = (
    0.5  # fraction of the work allowed for one answer that the path in a load may take
)
_NEARBY_RATIOS = (
    1.0 + 1e-6,
    1.02,
    1.1,
    1.3,
    2.0,
    4.0,
)  # of the load at which the path ends, where the root is sought first: blocks that tip do so at once
_BRACKET = 1e-7  # relative distance to both sides of a root of the closed form at which PRE-IE is evaluated

_SLIVER_MARGIN = (
    1e-2  # relative distance from where no block is cut at which the block is no sliver
)


@study
def solve(
    design: ADesign,
    key: Annotated[
        str, Argument("strength.weak.phi, or with a range: slope.height=10m:40m", "KEY")
    ],
    *,
    fos: Annotated[
        float | None, Option("Factor of safety wanted [the acceptance rule's].", number_of)
    ] = None,
    within: SearchRange | None = None,
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
    with desk.bar("evaluations", _EXPECTED_EVALUATIONS) as advance:
        return for_factor(design, key, fos, within, crew, advance)


def for_factor(
    design: Design,
    key: str,
    fos: float | None,
    search_range: SearchRange | None,
    crew: ExecutorOptions,
    advance: Advance,
) -> Solution:
    """Return the value of one number of a design at which its factor of safety is a target.

    Parameters
    ----------
    fos : the target; None takes that of the design's acceptance rule
    search_range : between which values to look (numbers, or texts with units); None: what such a number can be
    crew : the workers that evaluate the grid; advance : called after every evaluation

    The factor is evaluated on a grid that is fine near the present value; every bracket in which it passes the target
    is narrowed, so are ends of the valid range and changes of status. Where nothing drives the block the factor counts
    as infinite, where nothing holds it as zero.

    Raises
    ------
    DesignError
        E280 a design without a file, E310 and E311 for the key, E312 for the range, E314 for the target.
    """
    path, equals, text = key.partition("=")
    if equals and search_range is not None:
        fail("E312", f"{path} has two ranges", f"{key}, within", "Give one of them.")
    unknown = key_of(design, path)
    if unknown.is_integer:
        fail(
            "E311",
            f"{unknown.path} counts something: it cannot be solved for",
            unknown.path,
            "Sweep it: slopekit sweep design.yaml KEY=1,2,3",
        )
    low, high = parse_within(unknown, text if equals else search_range)
    target, from_acceptance = target_of(design, fos)
    request = FactorRequest(design, unknown, low, high, target, crew, advance)
    if request.design.HAS_CLOSED_FORM:
        request, closed, pre_ie = _both_methods(request)
    else:
        closed, pre_ie = None, _pre_ie_only(request, bool(equals) or search_range is not None)
    if pre_ie.least is None:
        refuse_as_run(design, request.current_point(), request.points.values())
    if pre_ie.roots:
        first = pre_ie.roots[0]
        first = replace(first, notes=(*first.notes, *_notices_of_run(request, first)))
        pre_ie = replace(pre_ie, roots=(first, *pre_ie.roots[1:]))
    solution = Solution(
        design,
        unknown,
        target,
        (low, high),
        from_acceptance,
        request.current_point(),
        closed,
        pre_ie,
    )
    warnings = tuple(notices(solution))
    warnings += (
        *_peak_strength_notices(solution),
        *(rules_left_out(design, ON_FACTOR) if from_acceptance else ()),
    )
    return replace(solution, warnings=warnings)


def _peak_strength_notices(solution: Solution) -> tuple[Notice, ...]:
    """Return W417: the target is met with the peak strength only; and the factor with the residual strength there."""
    answer = solution.answer
    if answer is None:
        return peak_strength_notice(solution.design, "factors are those")
    solved = with_values(
        solution.design, values_of(solution.design, [solution.key], [answer.value])
    )
    return peak_strength_notice(solved, "the target is met by the factor")


def _both_methods(request: FactorRequest) -> tuple[FactorRequest, Answers | None, Answers]:
    """Solve by the closed form on a grid, then by PRE-IE at the places it suggests; return the request too."""
    for columns in (request.on_arrays, None):
        request = replace(request, columns=columns)
        closed, search = request.search("closed_form"), request.search("pre_ie")
        closed.search_grid(request.grid(*FINE_GRID))
        search.search_grid(_pre_ie_places(request, closed))
        if columns is None or (
            request.confirms("closed_form", closed) and request.confirms("pre_ie", search)
        ):
            break
    return request, _answers(request, "closed_form", closed), _answers(request, "pre_ie", search)


def _pre_ie_places(request: FactorRequest, closed: RootSearch[Point]) -> list[float]:
    """Return the first places of PRE-IE: the closed form's changes of status, its roots, the ends of valid blocks."""
    places = {request.low, request.high}
    for a, b in pairwise(closed.samples):
        if a.label != b.label and a.level is not None and b.level is not None:
            places |= {a.place, b.place}
        elif (a.level is None) is not (b.level is None):
            outside, inside = (a.place, b.place) if a.level is None else (b.place, a.place)
            size = max(abs(inside), 1e-6 * closed.span)
            places |= {outside, inside + math.copysign(_SLIVER_MARGIN * size, inside - outside)}
    for crossing in closed.crossings():
        root = crossing.best.place
        width = _BRACKET * max(abs(root), 1e-6 * closed.span)
        if crossing.how != "gap":
            places |= {crossing.lower.place, root - width, root, root + width, crossing.upper.place}
    if request.key.value is not None:
        places.add(request.key.value)
    return sorted(place for place in places if request.low <= place <= request.high)


def _pre_ie_only(request: FactorRequest, full_range: bool) -> Answers:
    """Solve by PRE-IE alone, outwards from the present value or from where the path in a load ends.

    Parameters
    ----------
    full_range : sample the whole range, not only until the target is passed
    """
    search, grid, present_value = (
        request.search("pre_ie"),
        request.grid(*COARSE_GRID),
        request.key.value,
    )
    start = (
        present_value
        if present_value is not None and request.low <= present_value <= request.high
        else grid[len(grid) // 2]
    )
    path_end = load_path_end(request) if request.drives_blocks else None
    if path_end is not None:
        nearby = [path_end * ratio for ratio in _NEARBY_RATIOS] + [
            path_end / ratio for ratio in _NEARBY_RATIOS
        ]
        ends = max(request.low, 0.0), request.high
        search.search_outwards(
            [*ends, *(place for place in nearby if request.low < place < request.high)], path_end
        )
    if not search.reaches_zero:
        search.add(grid if full_range else ())
        search.search_outwards(grid, start)
    return _answers(request, "pre_ie", search)


def load_path_end(request: FactorRequest) -> float | None:
    """Return the load at which many blocks fail when it is applied last, with the strength divided by the target.

    None outside the range. It only starts the search: the solution is where the factor, with the strength divided
    last, is the target or falls past it.
    """
    unloaded, unit_loaded = (
        with_values(request.design, values_of(request.design, [request.key], [value]))
        for value in (0.0, _UNIT_LOAD)
    )
    with work_limit.work_budget(_PATH_WORK_FRACTION * work_limit.LIMIT_UNITS):
        path_end = kind_of(request.design).at_load(unloaded, unit_loaded, request.target)
    return None if path_end is None or not request.low < path_end < request.high else path_end


def _answers(request: FactorRequest, method: Method, search: RootSearch[Point]) -> Answers:
    """Return the solutions of one method, the root nearest to the present value first, or the reason for none."""
    samples, present_value = search.samples, request.key.value
    levels = [level_at(sample) for sample in search.defined]
    depends = len(levels) < 2 or max(levels) - min(levels) > SAME_FACTOR_TOLERANCE
    candidates = [
        _solved_value(method, request, crossing)
        for crossing in (search.crossings() if depends else ())
    ]
    candidates.sort(
        key=lambda solved: (
            solved.value
            if present_value is None
            else request.key.distance(solved.value, present_value)
        )
    )
    # the factor of many blocks may fall past the target at once as a load comes on: they tip, an answer too
    roots = tuple(
        solved
        for solved in candidates
        if solved.how == "root" or (request.drives_blocks and not solved.rises)
    )
    jumps_and_gaps = tuple(
        sorted(
            (solved for solved in candidates if solved not in roots),
            key=lambda solved: solved.value,
        )
    )
    factors = [
        (sample.place, factor_at(sample.evaluation, method) or 0.0) for sample in search.defined
    ]
    least = min(factors, key=lambda end: end[1], default=None)
    most = max(factors, key=lambda end: end[1], default=None)
    refused = tuple(_refused_stretches(request, method, samples))
    reason = None
    if not roots:
        reason = reason_of(
            request.key,
            request.target,
            (request.low, request.high),
            jumps_and_gaps,
            least,
            most,
            refused,
        )
    return Answers(
        method,
        roots,
        jumps_and_gaps,
        least,
        most,
        refused,
        (samples[0].place, samples[-1].place),
        len(samples),
        reason,
    )


def _solved_value(method: Method, request: FactorRequest, crossing: Crossing[Point]) -> SolvedValue:
    best, status = crossing.best, crossing.best.label
    if crossing.how != "root" and request.drives_blocks and not crossing.rises:
        best, status = (
            crossing.lower,
            crossing.upper.label,
        )  # the last stable sample, and the status of the failure
    ends = [
        (end.place, factor_at(end.evaluation, method) or 0.0)
        for end in (crossing.lower, crossing.upper)
    ]
    both = request.both(best.place)
    notes = tuple(factor_notices(request, best.place, both)) if method == "pre_ie" else ()
    return SolvedValue(
        crossing.how,
        best.place,
        factor_at(both, method) or 0.0,
        status,
        (ends[0], ends[1]),
        crossing.rises,
        both,
        notes,
    )


def _refused_stretches(
    request: FactorRequest, method: Method, samples: Samples
) -> Iterator[tuple[float, float, str, str]]:
    """Yield (low, high, code, message) of stretches of values refused for the same reason, with the message midway."""
    single = replace(request, columns=None)
    runs = groupby(samples, key=lambda sample: "" if sample.level is not None else sample.label)
    for run in [list(run) for label, run in runs if label]:
        low, high = run[0].place, run[-1].place
        middle = min(run, key=lambda sample: abs(sample.place - 0.5 * (low + high)))
        message = NO_CONVERGENCE if middle.label == UNSETTLED else middle.evaluation.message
        yield (
            low,
            high,
            middle.label,
            message or single.samples(method, [middle.place])[0].evaluation.message,
        )


def _notices_of_run(request: FactorRequest, solved: SolvedValue) -> Iterator[Notice]:
    """Yield the other notices of a run at a value: W507 of further acceptance checks, W504 of progressive debonding."""
    if solved.both.factors is None or solved.both.factors.limit is None:
        return
    yield from whole_wedge_notice(
        solved.both.factors.also, request.target, f"at {request.key.value_text(solved.value, 4)}"
    )
    notices = kind_of(request.design).reference_notices(
        with_values(request.design, values_of(request.design, [request.key], [solved.value]))
    )
    yield from factor_notices(
        request, solved.value, Point(replace(solved.both.factors, notes=notices))
    )
