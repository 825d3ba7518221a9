"""The value of one number of a design at which its factor of safety is a target, by both methods."""

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from itertools import pairwise

from slopekit.core.errors import DesignError, Fault, Notice
from slopekit.design.common import Design
from slopekit.design.parts import ON_FACTOR
from slopekit.design.reading.files import with_values
from slopekit.kinds import also_falls_short, dilates, kind_of, peak_only
from slopekit.kinds.protocol import AtLoad, Factors
from slopekit.notices import lost_cohesion_notices
from slopekit.preie.solvers import work_limit
from slopekit.studies.keys import key_of, values_of
from slopekit.studies.points import (
    UNSETTLED,
    Point,
    factor_at,
    rules_left_out,
    status_of,
)
from slopekit.studies.protocol import Advance
from slopekit.studies.ranges import Within, parse_within
from slopekit.studies.running import ALONE, Crew
from slopekit.studies.solve.factor_request import (
    SAME,
    FactorRequest,
    answers_of,
    crossings_of,
    level_at,
    look_roughly,
    runs_of,
    said_of_factor,
)
from slopekit.studies.solve.roots import Crossing, RootSearch, Sample
from slopekit.studies.solve.solutions import (
    ALIKE,
    TOLERANCE,
    Answers,
    Solution,
    SolvedValue,
    cut_short,
    notices,
    refuse_as_run,
    target_of,
)

_K, _UNIT_LOAD = "loads.seismic.k", 1.0
_OF_PATH = 0.5  # of the work that is allowed, for the path in a load
_PUT_BACK = 0.1 * work_limit.MOST  # for the factor of a limit state: it vouches for itself
_ABOVE = 1e-4  # of a value: a factor that falls on this by more than a jump does so at once
_FURTHER = (1.02, 1.1, 1.3, 2.0, 4.0)  # times the value of the path in a load, where the factor is above the target
_SECANTS = 10  # from there to the value where it is the target
_LOAD_RESOLUTION, _LOAD_NEAR, _LOAD_JUMP = 1e-7, 4e-7, (1e-4, 0.02)
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
    if spent and not answers.roots:
        return replace(answers, reason=cut_short(asked.key, asked.target, answers.least, answers.most)), True, beyond
    if answers.roots:
        first = answers.roots[0]
        if last is not None and direct is not last:
            first = replace(first, load_last=(last.multiplier, last.runs))
        first = replace(first, not_compared=_not_compared(asked, first, cut, beyond))
        answers = replace(answers, roots=(first, *answers.roots[1:]))
    return answers, spent, beyond


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
    lower: bool = False,
) -> Solution:  # fmt: skip
    """The value of one number of a design at which its factor of safety is a target.

    Parameters
    ----------
    fos : the target; None takes that of the design's acceptance rule
    within : between which values to look (numbers, or texts with units); None: what such a number can be
    crew : who evaluates the grid; advance : told of every evaluation
    lower : of a load on many blocks, what is lower: where they fail as it comes on last, at the strength divided by the
        target, or where their factor is the target, their strength divided last; else the latter

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
    spent, beyond = False, None
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
        search, whole = asked.search("pre_ie", slow=True), bool(equals) or within is not None
        if kind_of(design).at_load is not None and asked.in_load:
            pre_ie, spent, beyond = of_load(replace(asked, crew=ALONE), whole, lower)
        else:
            pre_ie = answers_of("pre_ie", asked, search, look_roughly(search, asked, whole))
    if pre_ie.least is None:
        refuse_as_run(design, asked.before(), asked.points.values())
    if pre_ie.roots:
        first = pre_ie.roots[0]
        first = replace(first, notes=(*first.notes, *_beside(asked, first)))
        pre_ie = replace(pre_ie, roots=(first, *pre_ie.roots[1:]))
    if closed is not None:
        closed = replace(closed, roots=tuple(replace(root, both=asked.both(root.value)) for root in closed.roots))
    solution = Solution(design, one, target, (low, high), own, asked.before(), closed, pre_ie, None, spent=spent,
                        load_last_beyond=beyond)  # fmt: skip
    said = tuple(notices(solution))
    known = {notice.code for notice in said}
    said += tuple(notice for notice in _of_nearest(solution, asked) if notice.code not in known)
    said += (*_at_peak(solution), *(rules_left_out(design, ON_FACTOR) if own else ()))
    solution = replace(solution, rounded=_rounded(solution, asked), warnings=said)
    return replace(solution, seconds=time.perf_counter() - began)


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
    if any(_moments(sample) for sample in search.samples):
        search.find_extremes(_SECTIONS // 3, within=_TURNS_WITHIN, ends=False)


def _towards_ends(search: RootSearch[Point], quick: RootSearch[Point], a: float, b: float) -> None:
    """Where the factor has not got above the target inside a stretch it may do so near an end that is high."""
    if any(level_at(sample) > 0.0 for sample in search.defined if a <= sample.at <= b):
        return
    for end, other in ((a, b), (b, a)):
        if level_at(quick.at(end)) > _TURNS_WITHIN:
            search.add(end + part * (other - end) for part in (1e-2, 1e-4))


def _moments(sample: Sample[Point]) -> bool:
    return sample.found.factors is not None and sample.found.factors.moments_govern


def _beside(asked: FactorRequest, solved: SolvedValue) -> Iterator[Notice]:
    """What else is known at a value: W504 of another history of many blocks, W507 of what acceptance asks besides."""
    if solved.both.factors is None or solved.both.factors.limit is None:
        return
    yield from also_falls_short(solved.both.factors.also, asked.target, f"at {asked.key.shown(solved.value, 4)}")
    if not solved.put_back:
        return
    design = with_values(asked.design, values_of(asked.design, [asked.key], [solved.value]))
    said = kind_of(design).beside(design)
    yield from said_of_factor(asked, solved.value, Point(replace(solved.both.factors, notes=said)))


def _of_nearest(solution: Solution, asked: FactorRequest) -> Iterator[Notice]:
    """What a run says of the factor that comes nearest to a target which no value gives: it may be one of a chip."""
    least, most = solution.pre_ie.least, solution.pre_ie.most
    if solution.answer is not None or least is None or most is None:
        return
    value, _ = most if most[1] < solution.target else least
    if value in asked.points:
        yield from said_of_factor(asked, value, asked.points[value], named=True)


def _rounded(solution: Solution, asked: FactorRequest) -> tuple[float, float] | None:
    """The first root in four digits, rounded to where the factor is the greater."""
    answer = solution.answer
    if answer is None or not answer.value or answer.from_path or solution.key.is_place:
        return None
    step = 10.0 ** (math.floor(math.log10(abs(answer.value))) - 3)
    up: Callable[[float], int] = math.ceil if answer.rises else math.floor
    value = float(f"{up(answer.value / step) * step:.12g}")
    if not asked.low <= value <= asked.high:
        return None
    factor = factor_at(asked.both(value), "pre_ie")
    return None if factor is None or factor < asked.target - TOLERANCE["pre_ie"] else (value, factor)
