"""The elastic path of n single blocks at once: what their displacement does as the strength of their joints goes down.

Each block rests on its no-tension elastic bed (`polygon_bed`) at λ = 1/F. From a strength that holds it λ goes down,
and the displacement u is followed by arc length in x = (u / |u|, ln λ). F_bed = 1/λ at the least λ on the way. All
blocks take a step together, each of its own length; NumPy's calls are shared by them, which makes n blocks cheap.

The path starts where the block rests while nothing slips: from the bonded displacement it flows, held back by dashpots
in parts of the bonded stiffness, in implicit steps, until it rests or runs. So it does at corners of the path.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, fields
from enum import IntEnum

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.preie.one_block.polygon_bed import BedSprings
from slopekit.preie.tolerances import FAR, FARTHEST, LEVEL, PATH_ENDS, ROUNDING, SETTLED, TINY

#: Split of the triangles along the path: its turns are found there, and settled on finer ones.
COARSE = 2
#: Elastic displacements: a block that comes to rest again within them has not failed.
SNAP = 10
#: Elastic displacements, beyond which a path that creeps has all but failed.
EARLY = 30
_TURNED, _BACK = math.log(1.2), math.log(20)  # ln λ so far above its least value does not come back, or sticks
_FIRST, _LONGEST = 0.1, 0.4  # steps along the path
_MISSED = 0.02  # of a step: ln λ may differ so much from what its slopes at both ends make
_CORNER = 1e-3  # steps may miss more where they are as short: points begin to slip
_STRAIGHT = 0.98  # cosine of the angle: where the path turns by less, the next step is twice as long
_EASY = 4, 6  # evaluations of Newton's method after which a step is not made longer, or is shortened
_MOST_STEPS = 150  # along one path
# of Newton's method: steps; after so many the residual must fall; size of a step at most; damped: its shortest part
_POINT = 12, 4, 3, 0  # to a point of the path
# to where every point sticks: each takes a third of a pressed part that is too large; what wanders may land by chance
_STUCK = 40, 12, math.inf, 0
_REST = 100, 0, math.inf, 0.05  # to a rest at one strength
_WEAKER = 0.97  # of λ at the first slip
_STRONGER = 1, 8, 32  # times the strength of the first slip at which a block is looked for at rest
#: So many times the strength that forces in balance need is the most that is tried.
STRONGEST = 4096
# of viscous flow: most dashpots, in parts of the bonded stiffness, and steps
_STIFFEST, _MOST_FLOW = 1000, 200
# of its displacement: a step at most, and a rest that it leads to; one after which that rest is looked for
_FLOW_STEP, _FLOW_ENDS = 0.5, 0.1
_FLOW_CHANGE = 0.2, 4.0  # of the dashpots from one step to the next
_MARCH = 0.01  # part of λ: less strength alone, where the path has a corner
_MOST_POLISH = 20  # points to the least λ on a turn of the path
_LEAST = 1e-10  # of ln λ: so near is the least value found

_NONE = np.zeros(0)

Equations = Callable[[Ints, Floats], tuple[Floats, Floats, Floats]]
Effort = tuple[int, int, float, float]


@dataclass(frozen=True)
class Roots:
    """What Newton's method found for n rows.

    Attributes
    ----------
    x : (n, k); settled : (n,) which of them were found; evaluations : (n,) of the equations
    slopes : (n, k, k) there, where NumPy solved them
    tangent : (n, k) unit tangents of the paths through points on planes, the way these look
    side : (n,) signs of the determinants of the slopes there: of one on each path that does not turn back
    """

    x: Floats
    settled: Bools
    evaluations: Ints
    slopes: Floats
    tangent: Floats
    side: Floats

    @classmethod
    def none(cls, start: Floats) -> "Roots":
        """Return roots at their start, none of which was found yet."""
        count, size = start.shape
        settled, evaluations = np.zeros(count, dtype=bool), np.zeros(count, dtype=np.int64)
        return cls(
            start.copy(), settled, evaluations, np.zeros((count, size, size)), np.zeros_like(start), np.zeros(count)
        )


def solve_rows(equations: Equations, start: Floats, effort: Effort) -> Roots:
    """Solve n small systems of equations by Newton's method, all at once; damped steps are halved until they gain.

    Parameters
    ----------
    equations : rows (m,) and their x (m, k) -> residual (m, k), slopes (m, k, k), and the size (m,) that is none
    start : (n, k); effort : steps, patience, size of a step, and the shortest part of a damped one
    """
    most_steps, patience, farthest, shortest = effort
    roots, count = Roots.none(start), len(start)
    rows, x, length = np.arange(count), start, np.ones(count)
    base, step, size = start, np.zeros_like(start), np.full(count, np.inf)
    for number in range(most_steps if count else 0):
        residual, slopes, small = equations(rows, x)
        now = np.abs(residual).max(axis=1)
        done = now <= small
        settled = rows[done]
        roots.settled[settled], roots.evaluations[settled] = True, number + 1
        roots.x[settled], roots.slopes[settled] = x[done], slopes[done]
        most = size * (1.0 - 0.1 * length) if shortest else size
        lower = now < (most if shortest or number > patience else np.inf)
        step = np.where(lower[:, None], solved(slopes, residual), step)
        base, size = np.where(lower[:, None], x, base), np.where(lower, now, size)
        length = np.where(lower, 1.0, 0.5 * length if shortest else 0.0)
        goes_on = ~done & (length > shortest) & (np.abs(step).max(axis=1) < farthest)
        rows, base, step, size, length = (each[goes_on] for each in (rows, base, step, size, length))
        if not len(rows):
            break
        x = base - length[:, None] * step
    return roots


def solved(matrices: Floats, vectors: Floats) -> Floats:
    """Return the solutions (n, k) of n systems; nothing useful, but finite numbers, of those that are singular."""
    try:
        return np.asarray(np.linalg.solve(matrices, vectors[:, :, None])[:, :, 0])
    except np.linalg.LinAlgError:
        unit, size = np.eye(vectors.shape[1]), np.abs(matrices).max(axis=(1, 2))
        size = np.where(np.isfinite(size) & (size > 0.0), size, 1.0)[:, None, None]
        shifted = np.nan_to_num(matrices, posinf=0.0, neginf=0.0) + PATH_ENDS**2 * size * unit
        return np.asarray(np.linalg.solve(shifted, vectors[:, :, None])[:, :, 0])


def lengths(vectors: Floats) -> Floats:
    """Return the lengths (n,) of vectors (n, k)."""
    return np.sqrt(dots(vectors, vectors))


def dots(ones: Floats, others: Floats) -> Floats:
    """Return the products (n,) of vectors (n, k)."""
    products: Floats = np.einsum("nk,nk->n", ones, others)
    return products


def units(vectors: Floats) -> Floats:
    """Return vectors (n, k) of unit length, or of none."""
    return vectors / np.maximum(lengths(vectors), TINY)[:, None]


class PathEnd(IntEnum):
    """How the path of a block ends."""

    FAR = 0  # followed to `FAR` elastic displacements
    TURNED = 1  # λ rose for good
    BACK = 2  # λ rose to a stuck state near by: less strength alone may lead to another rest
    CORNER = 3  # no step leads on


@dataclass
class Paths:
    """The elastic paths of some blocks: where they are, and what was found along them.

    Attributes
    ----------
    rows : (n,) their numbers among the paths that were begun together
    point : (n, u + 1) u and ln λ; tangent : (n, u + 1) unit vectors in (u / |u|, ln λ)
    length : (n,) of the next step
    lowest : (n, u + 1) u and ln λ where that is least; turns : (n,) whether λ rises again behind it
    heading : (n, u) direction of u there, half-way between those at both ends of a step, and as long as the step
    early : (n,) the least ln λ within `EARLY` elastic displacements; steps : (n,)
    outcome : (n,) `PathEnd`, -1 on the way
    """

    rows: Ints
    point: Floats
    tangent: Floats
    side: Floats
    length: Floats
    lowest: Floats
    turns: Bools
    heading: Floats
    early: Floats
    steps: Ints
    outcome: Ints

    def of(self, places: Ints) -> "Paths":
        """Return some of them."""
        return Paths(*(getattr(self, field.name)[places] for field in fields(self)))

    def put(self, some: "Paths") -> None:
        """Put some of them back, by their rows."""
        for field in fields(self):
            getattr(self, field.name)[some.rows] = getattr(some, field.name)

    def go_on(self, rows: Ints, onward: "Paths") -> None:
        """Put in place of some paths those that went on from them, begun together."""
        onward.early = np.minimum(onward.early, self.early[rows])
        onward.steps, onward.rows = onward.steps + self.steps[rows], rows
        self.put(onward)


class BedPath:
    """The elastic paths of some blocks on one set of springs; `balanced` is the unbalanced force that is none."""

    def __init__(self, springs: BedSprings, balanced: float = SETTLED) -> None:
        self.springs, self.balanced = springs, balanced

    def on_planes(
        self, blocks: Ints, planes: Floats, scale: Floats, start: Floats, effort: Effort = _POINT,
        sticks: bool = False, drag: Floats | None = None,
    ) -> Roots:  # fmt: skip
        """Balance the forces on planes (n, u + 1) through where they start, in x = (u / scale, ln λ).

        Parameters
        ----------
        sticks : no point slips; drag : (n, u, u) holds the blocks back to where they start
        """
        springs, offsets, held = self.springs, dots(planes, start), start[:, :-1] * scale[:, None]

        def equations(rows: Ints, x: Floats) -> tuple[Floats, Floats, Floats]:
            size, reduction = scale[rows], np.exp(np.minimum(x[:, -1], 50))
            u = x[:, :-1] * size[:, None]
            at = springs.unbalanced(blocks[rows], u, u, reduction, sticks=sticks)
            out, by_displacement = at.out, at.by_opening + at.by_slip
            if drag is not None:
                out = out - (drag[rows] @ (u - held[rows])[:, :, None])[:, :, 0]
                by_displacement = by_displacement - drag[rows]
            by_log_reduction = at.by_reduction * reduction[:, None]
            slopes = bordered(by_displacement * size[:, None, None], by_log_reduction, planes[rows])
            off = dots(planes[rows], x) - offsets[rows]
            return np.concatenate([out, off[:, None]], axis=1), slopes, self.balanced * np.maximum(1.0, reduction)

        if springs.kernels is None:
            roots = solve_rows(equations, start, effort)
            along = np.zeros_like(start)
            along[:, -1] = 1.0
            roots.tangent[roots.settled] = units(solved(roots.slopes[roots.settled], along[roots.settled]))
            roots.side[:] = np.sign(np.linalg.det(roots.slopes))
            return roots
        roots, limits = Roots.none(start), np.array([*effort, self.balanced])
        drags = (_NONE, _NONE) if drag is None else (drag, held)
        plain = map(np.ascontiguousarray, (planes, offsets, scale, *drags))
        springs.kernels.balanced(
            springs.polygons, blocks, springs.beds.load, *plain, sticks, limits, roots.x, roots.tangent, roots.side,
            roots.settled, roots.evaluations,
        )  # fmt: skip
        return roots

    def rests(
        self, blocks: Ints, start: Floats, reduction: Floats, sticks: bool = False, drag: Floats | None = None
    ) -> Roots:
        """Balance the forces at fixed λ (n,); see `on_planes`."""
        x = np.concatenate([start, np.log(reduction)[:, None]], axis=1)
        planes = np.zeros_like(x)
        planes[:, -1] = 1.0
        return self.on_planes(blocks, planes, np.ones(len(x)), x, _STUCK if sticks else _REST, sticks, drag)

    def flow(
        self, blocks: Ints, start: Floats, reduction: Floats, farthest: Floats, sticks: bool = False
    ) -> tuple[Floats, Bools]:
        """Let blocks move slowly at one λ (n,) each; return where (n, u) they come to rest, and which of them do.

        Parameters
        ----------
        start : (n, u); farthest : (n,) displacement beyond which a block runs; sticks : no point slips
        """
        u, rested = start.copy(), np.zeros(len(blocks), dtype=bool)
        slow, rows = np.ones(len(blocks)), np.arange(len(blocks))
        stiffness, first = self.springs.beds.stiffness[blocks], self.springs.beds.first[blocks]
        for _ in range(_MOST_FLOW):
            drag = slow[rows, None, None] * stiffness[rows]
            step = self.rests(blocks[rows], u[rows], reduction[rows], sticks, drag)
            moved = lengths(step.x[:, :-1] - u[rows]) / np.maximum(first[rows], lengths(u[rows]))
            good = step.settled & (moved <= _FLOW_STEP)
            u[rows[good]] = step.x[good, :-1]
            slow[rows] *= np.where(step.settled, np.clip(2.0 * moved / _FLOW_STEP, *_FLOW_CHANGE), _FLOW_CHANGE[1])
            slows = rows[good & (moved <= _FLOW_ENDS)]
            rest = self.rests(blocks[slows], u[slows], reduction[slows], sticks)
            leads = lengths(rest.x[:, :-1] - u[slows]) <= _FLOW_STEP * np.maximum(first[slows], lengths(u[slows]))
            leads &= rest.settled
            u[slows[leads]], rested[slows[leads]] = rest.x[leads, :-1], True
            rows = rows[~rested[rows] & (slow[rows] <= _STIFFEST) & (lengths(u[rows]) <= farthest[rows])]
            if not len(rows):
                break
        return u, rested

    def start(self, blocks: Ints, reduction: Floats) -> tuple[Floats, Floats]:
        """Find each block at rest a little below the strength at which a first point slips, or at more.

        A block that comes to no rest while it sticks tips over, whatever its strength. Returns displacements (n, u),
        and λ (n,), not a number where a block rests at no strength.
        """
        bonded = self.springs.beds.bonded[blocks]
        u, sticks = self.flow(blocks, bonded, reduction, FARTHEST**2 * self.springs.beds.first[blocks], sticks=True)
        first = np.clip(_WEAKER * self.springs.first_slip(blocks, u), TINY, STRONGEST * reduction)
        reduced = np.full(len(blocks), np.nan)
        for stronger in _STRONGER:
            lost = np.flatnonzero(sticks & np.isnan(reduced))
            rest = self.rests(blocks[lost], u[lost], stronger * first[lost])
            lost, points = lost[rest.settled], rest.x[rest.settled]
            u[lost], reduced[lost] = points[:, :-1], np.exp(points[:, -1])
        return u, reduced

    def lower(self, blocks: Ints, points: Floats, elastic: Floats) -> tuple[Floats, Floats]:
        """Lower λ alone from rests (n, u + 1) at corners of the path; return rests (n, u) and λ, not a number without.

        A rest more than `SNAP` elastic displacements away is none.
        """
        lower, begin = np.exp(points[:, -1]) * (1.0 - _MARCH), points[:, :-1]
        rest, settled = self.flow(blocks, begin, lower, lengths(begin) + SNAP * elastic)
        lower[~settled | (lengths(rest - begin) > SNAP * elastic)] = np.nan
        return rest, lower

    def follow(self, blocks: Ints, u: Floats, reduction: Floats, elastic: Floats, ends: Floats) -> Paths:
        """Follow the paths from states of rest, each until its block runs or λ has turned for good.

        Parameters
        ----------
        u : (n, u); reduction : (n,); elastic : (n,) size of an elastic displacement
        ends : (n,) ln λ to which a path is known to rise in the end: it is left once λ turned up; infinite: not known
        """
        scale, count = lengths(u), len(u)
        point = np.concatenate([u, np.log(reduction)[:, None]], axis=1)
        down = np.zeros_like(point)
        down[:, -1] = -1.0
        begun = self.on_planes(blocks, down, scale, on_scale(point, 1.0 / scale))
        every = Paths(
            rows=np.arange(count),
            point=point,
            tangent=begun.tangent,
            side=begun.side,
            length=np.full(count, _FIRST),
            lowest=point.copy(),
            turns=np.zeros(count, dtype=bool),
            heading=begun.tangent[:, :-1].copy(),
            early=np.where(scale <= EARLY * elastic, point[:, -1], np.inf),
            steps=np.zeros(count, dtype=np.int64),
            outcome=np.where(begun.settled, -1, PathEnd.CORNER),
        )
        at = every.of(np.flatnonzero(begun.settled))
        while len(at.rows):
            self._step(blocks[at.rows], at, elastic[at.rows], ends[at.rows])
            if (at.outcome >= 0).any():
                every.put(at.of(np.flatnonzero(at.outcome >= 0)))
                at = at.of(np.flatnonzero(at.outcome < 0))
        return every

    def _step(self, blocks: Ints, at: Paths, elastic: Floats, ends: Floats) -> None:
        """Take one step along each path, or shorten it."""
        along, tangent, before, here = at.length, at.tangent, at.point, lengths(at.point[:, :-1])
        start = on_scale(before, 1.0 / here) + along[:, None] * tangent
        found = self.on_planes(blocks, tangent, here, start)
        after, cosine = found.tangent, dots(found.tangent, tangent)
        after[np.abs(after[:, -1]) < ROUNDING, -1] = -ROUNDING  # level, not turned
        before_slope, slope, change = tangent[:, -1], after[:, -1], found.x[:, -1] - before[:, -1]
        # between two points λ did what its slopes at them do not make: it may have turned
        strays = np.abs(change - 0.5 * along * (before_slope + slope)) > _MISSED * along
        # another path, which passes close by, or one that is farther off than it was led, or hard to find
        strays |= (found.side != at.side) | (lengths(found.x - start) > along) | (found.evaluations > _EASY[1])
        good = found.settled & ~(strays & (along > _CORNER))
        at.side = np.where(good, found.side, at.side)
        at.point = np.where(good[:, None], on_scale(found.x, here), before)
        ln, scale = at.point[:, -1], lengths(at.point[:, :-1])
        turns = good & (before_slope < 0.0) & ((slope >= 0.0) | (change > 0.0)) & (before[:, -1] <= at.lowest[:, -1])
        lower = ln < at.lowest[:, -1]
        at.lowest[lower], at.turns = at.point[lower], np.where(lower, slope >= 0.0, at.turns | turns)
        bent = units((tangent + after)[:, :-1]) * lengths((at.point - before)[:, :-1])[:, None]
        at.heading[turns | lower] = bent[turns | lower]
        # between two points ln λ is a line of 1 / |u|, as it is far out
        inside = np.clip((1.0 - here / (EARLY * elastic)) / np.maximum(1.0 - here / scale, LEVEL), 0.0, 1.0)
        reached = np.where(here <= EARLY * elastic, before[:, -1] + inside * (ln - before[:, -1]), np.inf)
        at.early, at.steps = np.minimum(at.early, reached), at.steps + 1
        longer = np.where((cosine > _STRAIGHT) & (found.evaluations <= _EASY[0]), 2.0, 1.0)
        at.length = np.where(good, np.minimum(along * longer, _LONGEST), along / 4)
        at.tangent = np.where(good[:, None], units(on_scale(after, here / scale)), tangent)
        rise, gone = ln - at.lowest[:, -1], lengths((at.point - at.lowest)[:, :-1]) > SNAP * elastic
        spare = ends - at.lowest[:, -1]  # a path that ends lower than it turned goes on
        turned = ((rise > _TURNED) & gone) | (at.turns & (spare > 0.0) & (rise > 0.5 * spare))
        at.outcome[(at.steps >= _MOST_STEPS) | (at.length < PATH_ENDS)] = PathEnd.CORNER
        at.outcome[rise > _BACK] = PathEnd.BACK
        at.outcome[turned] = PathEnd.TURNED
        at.outcome[scale > FAR * elastic] = PathEnd.FAR

    def settle(self, blocks: Ints, lowest: Floats, heading: Floats, branch: Floats) -> tuple[Floats, Floats]:
        """Find the least λ on turns of paths: where its slope along a direction is none, by Illinois' rule.

        Parameters
        ----------
        lowest : (n, u + 1) u and ln λ near it; heading : (n, u) as of `Paths`; branch : (n,) its `side`

        Returns
        -------
        u and ln λ (n, u + 1), that infinite where no point was found, and unit tangents (n, u + 1)
        """
        count, scale = len(blocks), lengths(lowest[:, :-1])
        planes, x = np.concatenate([units(heading), np.zeros((count, 1))], axis=1), on_scale(lowest, 1.0 / scale)
        stride = lengths(heading) / scale
        best, tangent, rows = x.copy(), planes.copy(), np.arange(count)
        best[:, -1] = np.inf
        at, last, side_before = np.zeros(count), np.full((count, 2), np.nan), np.full(count, -1)
        sides = np.full((count, 2, 2), np.nan)  # where ln λ falls, and where it rises: place and slope
        for _ in range(_MOST_POLISH):
            found = self.on_planes(blocks[rows], planes[rows], scale[rows], x[rows])
            ours = found.settled & (found.side == branch[rows])
            good, lost = rows[ours], rows[~ours]
            back = 0.5 * (at[lost] - last[lost, 0])  # half as far from where the last point was found
            x[lost] -= back[:, None] * planes[lost]
            at[lost] -= back
            points, after = found.x[ours], found.tangent[ours]
            along = dots(after, planes[good])
            after /= np.where(along == 0.0, 1.0, along)[:, None]
            here, slope = at[good], after[:, -1]
            lower = points[:, -1] < best[good, -1]
            best[good[lower]], tangent[good[lower]] = points[lower], after[lower]
            side = (slope >= 0.0).astype(int)
            sides[good, side] = np.stack([here, slope], axis=1)
            again = side == side_before[good]  # Illinois' rule
            sides[good[again], 1 - side[again], 1] *= 0.5
            span, rise = (sides[good, 1] - sides[good, 0]).T
            is_between = span > 0.0
            with np.errstate(divide="ignore", invalid="ignore"):  # a slope that stayed as it was bends nowhere
                bent, twice = (slope - last[good, 1]) / (here - last[good, 0]), 2.0 * np.abs(here - last[good, 0])
                reach = np.fmax(np.abs(slope) / np.where(bent > 0.0, bent, 1.0), twice)
                reach = np.fmin(reach, np.fmax(stride[good], twice))  # another path may pass close by
                reach = np.where(is_between, np.abs(slope) * span / rise, reach)
            last[good, 0], last[good, 1], side_before[good] = here, slope, side
            at[good] = here - np.sign(slope) * reach
            x[good] = points + (at[good] - here)[:, None] * after
            goes_on = np.isfinite(at[rows])
            goes_on[ours] &= ~is_between | (np.abs(slope) * reach > _LEAST)
            rows = rows[goes_on]
            if not len(rows):
                break
        return on_scale(best, scale), units(tangent)


def on_scale(points: Floats, scale: Floats) -> Floats:
    """Return points (n, u + 1) of paths with their displacements times a scale (n,)."""
    return np.concatenate([points[:, :-1] * scale[:, None], points[:, -1:]], axis=1)


def bordered(slopes: Floats, by_log_reduction: Floats, planes: Floats) -> Floats:
    """Return slopes (n, u, u) of forces with those by ln λ beside them and planes (n, u + 1) below."""
    beside = np.concatenate([slopes, by_log_reduction[:, :, None]], axis=2)
    return np.concatenate([beside, planes[:, None]], axis=1)
