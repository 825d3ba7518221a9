"""The elastic paths of n single blocks at once: their displacements as the strength of their joints is reduced.

Each block rests on its no-tension elastic bed (`polygon_bed`) at λ = 1/F. From a strength at which it is stable λ is
lowered, and the displacement u is followed by arc length in x = (u / |u|, ln λ). F_bed = 1/λ at the least λ of the
path. All blocks take a step together, each of its own length, and share the calls of NumPy.

The path starts at rest without slip: from the bonded displacement the block flows on dashpots, whose viscosity is a
multiple of the bonded stiffness, in implicit steps, until it rests or runs. So it does at corners of the path.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, fields
from enum import IntEnum

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.preie.one_block.polygon_bed import BedSprings
from slopekit.preie.tolerances import FAR, FARTHEST, LEVEL, PATH_ENDS, ROUNDING, SETTLED, TINY

#: Split of the triangles along the path; the limit is then refined on finer triangles.
COARSE = 2
#: Elastic displacements within which a block that comes to rest again has not failed.
SNAP = 10
#: Elastic displacements, beyond which a path that creeps has all but failed.
EARLY = 30
# rise of ln λ above its least value, after which it does not fall again, or the block sticks
_TURNED, _BACK = math.log(1.2), math.log(20)
_FIRST, _LONGEST = 0.1, 0.4  # steps along the path
_MISSED = (
    0.02  # largest difference of a change of ln λ from the mean of its slopes, in parts of the step
)
_CORNER = 1e-3  # length of a step, below which this difference may be larger: points begin to slip
_STRAIGHT = 0.98  # cosine of the angle between steps, above which the next step is doubled
_EASY = 4, 6  # evaluations in Newton's method above which a step is not lengthened, or is shortened
_MOST_STEPS = 150  # along one path
# `Effort` of Newton's method to a point of the path, to rest without slip, and to rest at one strength. Without slip a
# step reduces a pressed part that is too large by a third, and the residual may grow in between.
_POINT = 12, 4, 3, 0
_STUCK = 40, 12, math.inf, 0
_REST = 100, 0, math.inf, 0.05
_WEAKER = 0.97  # λ of the first state of rest, in parts of λ at the first slip
_STRONGER = 1, 8, 32  # multiples of that λ at which a state of rest is tried
#: Largest strength at which a state of rest is tried, in multiples of that needed by the forces alone.
STRONGEST = 4096
# viscous flow: largest viscosity of the dashpots, in parts of the bonded stiffness, and number of steps
_STIFFEST, _MOST_FLOW = 1000, 200
# largest step, in parts of the displacement; step below which a state of rest without dashpots is tried
_FLOW_STEP, _FLOW_ENDS = 0.5, 0.1
_FLOW_CHANGE = 0.2, 4.0  # least and largest factor on the viscosity from one step to the next
_MARCH = 0.01  # relative reduction of λ at fixed displacement where the path has a corner
_MOST_POLISH = 20  # iterations to the least λ on a turn of the path
_LEAST = 1e-10  # accuracy of the least ln λ

_NONE = np.zeros(0)

#: Equations of Newton's method, see `solve_rows`.
Equations = Callable[[Ints, Floats], tuple[Floats, Floats, Floats]]
#: Limits of Newton's method: number of steps, steps after which the residual has to fall, largest step, and the least
#: part of a damped step (0: not damped).
Effort = tuple[int, int, float, float]


@dataclass(frozen=True)
class Roots:
    """Solutions of n small systems of equations by Newton's method.

    Attributes
    ----------
    x : (n, k); settled : (n,) which of them converged; evaluations : (n,) of the equations
    slopes : (n, k, k) at the solutions, where NumPy solved them
    tangent : (n, k) unit tangents of the paths through points on planes, towards the side of the normals of the planes
    side : (n,) signs of the determinants of the slopes: constant along a path that does not turn back
    """

    x: Floats
    settled: Bools
    evaluations: Ints
    slopes: Floats
    tangent: Floats
    side: Floats

    @classmethod
    def none(cls, start: Floats) -> "Roots":
        """Return roots at their start values, none of them solved yet."""
        count, size = start.shape
        settled, evaluations = np.zeros(count, dtype=bool), np.zeros(count, dtype=np.int64)
        return cls(
            start.copy(),
            settled,
            evaluations,
            np.zeros((count, size, size)),
            np.zeros_like(start),
            np.zeros(count),
        )


def solve_rows(equations: Equations, start: Floats, effort: Effort) -> Roots:
    """Solve n small systems of equations by Newton's method, all at once; damped steps are halved until errors fall.

    Parameters
    ----------
    equations : rows (m,) and their x (m, k) -> residual (m, k), slopes (m, k, k), and tolerance (m,) of the residual
    start : (n, k); effort : limits of Newton's method
    """
    most_steps, patience, farthest, shortest = effort
    roots, count = Roots.none(start), len(start)
    rows, x, length = np.arange(count), start, np.ones(count)
    base, step, size = start, np.zeros_like(start), np.full(count, np.inf)
    for number in range(most_steps if count else 0):
        residual, slopes, small = equations(rows, x)
        error = np.abs(residual).max(axis=1)
        done = error <= small
        settled = rows[done]
        roots.settled[settled], roots.evaluations[settled] = True, number + 1
        roots.x[settled], roots.slopes[settled] = x[done], slopes[done]
        most = size * (1.0 - 0.1 * length) if shortest else size
        lower = error < (most if shortest or number > patience else np.inf)
        step = np.where(lower[:, None], solved(slopes, residual), step)
        base, size = np.where(lower[:, None], x, base), np.where(lower, error, size)
        length = np.where(lower, 1.0, 0.5 * length if shortest else 0.0)
        goes_on = ~done & (length > shortest) & (np.abs(step).max(axis=1) < farthest)
        rows, base, step, size, length = (
            array[goes_on] for array in (rows, base, step, size, length)
        )
        if not len(rows):
            break
        x = base - length[:, None] * step
    return roots


def solved(matrices: Floats, vectors: Floats) -> Floats:
    """Return the solutions (n, k) of n linear systems; singular ones get finite numbers without meaning."""
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


def dots(first: Floats, second: Floats) -> Floats:
    """Return the scalar products (n,) of vectors (n, k)."""
    products: Floats = np.einsum("nk,nk->n", first, second)
    return products


def units(vectors: Floats) -> Floats:
    """Return vectors (n, k) scaled to unit length; zero vectors stay zero."""
    return vectors / np.maximum(lengths(vectors), TINY)[:, None]


class PathEnd(IntEnum):
    """State in which the elastic path of a block ends."""

    FAR = 0  # followed to `FAR` elastic displacements
    TURNED = 1  # λ rose for good
    BACK = 2  # λ rose to a stuck state near by: less strength alone may lead to another rest
    CORNER = 3  # no step leads on


@dataclass
class Paths:
    """The elastic paths of some blocks: their current points, and what was recorded along them.

    Attributes
    ----------
    rows : (n,) positions among the paths that were started together
    point : (n, u + 1) u and ln λ; tangent : (n, u + 1) unit vectors in (u / |u|, ln λ)
    length : (n,) of the next step
    lowest : (n, u + 1) u and ln λ where that is least; turns : (n,) whether λ rises again behind it
    heading : (n, u) direction of u there, half-way between those at both ends of a step, and as long as the step
    early : (n,) the least ln λ within `EARLY` elastic displacements; steps : (n,)
    outcome : (n,) `PathEnd`, -1 while the path is being followed
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

    def take(self, places: Ints) -> "Paths":
        """Return the paths at these positions."""
        return Paths(*(getattr(self, field.name)[places] for field in fields(self)))

    def put(self, paths: "Paths") -> None:
        """Write paths back into these, at the positions in their `rows`."""
        for field in fields(self):
            getattr(self, field.name)[paths.rows] = getattr(paths, field.name)

    def continue_with(self, rows: Ints, onward: "Paths") -> None:
        """Replace the paths of some rows by their continuations, keeping the earliest λ and the number of steps."""
        onward.early = np.minimum(onward.early, self.early[rows])
        onward.steps, onward.rows = onward.steps + self.steps[rows], rows
        self.put(onward)


class BedPath:
    """The elastic paths of some blocks on one set of springs; `balanced` is the tolerance of unbalanced force."""

    def __init__(self, springs: BedSprings, balanced: float = SETTLED) -> None:
        self.springs, self.balanced = springs, balanced

    def on_planes(
        self,
        blocks: Ints,
        planes: Floats,
        scale: Floats,
        start: Floats,
        effort: Effort = _POINT,
        sticks: bool = False,
        drag: Floats | None = None,
    ) -> Roots:
        """Solve for balanced forces on planes (n, u + 1) through the start points, in x = (u / scale, ln λ).

        Parameters
        ----------
        sticks : no point slips; drag : (n, u, u) stiffness of dashpots that pull the blocks back to the start
        """
        springs, offsets, anchor = self.springs, dots(planes, start), start[:, :-1] * scale[:, None]

        def equations(rows: Ints, x: Floats) -> tuple[Floats, Floats, Floats]:
            size, reduction = scale[rows], np.exp(np.minimum(x[:, -1], 50))
            u = x[:, :-1] * size[:, None]
            residual = springs.unbalanced(blocks[rows], u, u, reduction, sticks=sticks)
            force, by_displacement = residual.force, residual.by_opening + residual.by_slip
            if drag is not None:
                force = force - (drag[rows] @ (u - anchor[rows])[:, :, None])[:, :, 0]
                by_displacement = by_displacement - drag[rows]
            by_log_reduction = residual.by_reduction * reduction[:, None]
            slopes = bordered(by_displacement * size[:, None, None], by_log_reduction, planes[rows])
            plane_error = dots(planes[rows], x) - offsets[rows]
            return (
                np.concatenate([force, plane_error[:, None]], axis=1),
                slopes,
                self.balanced * np.maximum(1.0, reduction),
            )

        if springs.kernels is None:
            roots = solve_rows(equations, start, effort)
            along = np.zeros_like(start)
            along[:, -1] = 1.0
            roots.tangent[roots.settled] = units(
                solved(roots.slopes[roots.settled], along[roots.settled])
            )
            roots.side[:] = np.sign(np.linalg.det(roots.slopes))
            return roots
        roots, limits = Roots.none(start), np.array([*effort, self.balanced])
        drags = (_NONE, _NONE) if drag is None else (drag, anchor)
        plain = map(np.ascontiguousarray, (planes, offsets, scale, *drags))
        springs.kernels.balanced(
            springs.polygons,
            blocks,
            springs.beds.load,
            *plain,
            sticks,
            limits,
            roots.x,
            roots.tangent,
            roots.side,
            roots.settled,
            roots.evaluations,
        )
        return roots

    def rests(
        self,
        blocks: Ints,
        start: Floats,
        reduction: Floats,
        sticks: bool = False,
        drag: Floats | None = None,
    ) -> Roots:
        """Solve for balanced forces at fixed λ (n,); see `on_planes`."""
        x = np.concatenate([start, np.log(reduction)[:, None]], axis=1)
        planes = np.zeros_like(x)
        planes[:, -1] = 1.0
        return self.on_planes(
            blocks, planes, np.ones(len(x)), x, _STUCK if sticks else _REST, sticks, drag
        )

    def flow(
        self, blocks: Ints, start: Floats, reduction: Floats, farthest: Floats, sticks: bool = False
    ) -> tuple[Floats, Bools]:
        """Let blocks flow on dashpots at fixed λ (n,); return displacements (n, u), and which blocks (n,) came to rest.

        Parameters
        ----------
        start : (n, u); farthest : (n,) displacement beyond which a block runs; sticks : no point slips
        """
        u, rested = start.copy(), np.zeros(len(blocks), dtype=bool)
        slow, rows = np.ones(len(blocks)), np.arange(len(blocks))
        stiffness, first = (
            self.springs.beds.stiffness[blocks],
            self.springs.beds.elastic_size[blocks],
        )
        for _ in range(_MOST_FLOW):
            drag = slow[rows, None, None] * stiffness[rows]
            step = self.rests(blocks[rows], u[rows], reduction[rows], sticks, drag)
            movement = lengths(step.x[:, :-1] - u[rows]) / np.maximum(first[rows], lengths(u[rows]))
            good = step.settled & (movement <= _FLOW_STEP)
            u[rows[good]] = step.x[good, :-1]
            slow[rows] *= np.where(
                step.settled, np.clip(2.0 * movement / _FLOW_STEP, *_FLOW_CHANGE), _FLOW_CHANGE[1]
            )
            slows = rows[good & (movement <= _FLOW_ENDS)]
            rest = self.rests(blocks[slows], u[slows], reduction[slows], sticks)
            leads = lengths(rest.x[:, :-1] - u[slows]) <= _FLOW_STEP * np.maximum(
                first[slows], lengths(u[slows])
            )
            leads &= rest.settled
            u[slows[leads]], rested[slows[leads]] = rest.x[leads, :-1], True
            rows = rows[
                ~rested[rows] & (slow[rows] <= _STIFFEST) & (lengths(u[rows]) <= farthest[rows])
            ]
            if not len(rows):
                break
        return u, rested

    def start(self, blocks: Ints, reduction: Floats) -> tuple[Floats, Floats]:
        """Find a state of rest of each block a little below the strength at which a first point slips, or at more.

        A block that comes to no rest while it sticks tips over, whatever its strength. Returns displacements (n, u),
        and λ (n,), not a number where a block rests at no strength.
        """
        bonded = self.springs.beds.bonded[blocks]
        u, sticks = self.flow(
            blocks,
            bonded,
            reduction,
            FARTHEST**2 * self.springs.beds.elastic_size[blocks],
            sticks=True,
        )
        first = np.clip(_WEAKER * self.springs.first_slip(blocks, u), TINY, STRONGEST * reduction)
        reduced = np.full(len(blocks), np.nan)
        for stronger in _STRONGER:
            lost = np.flatnonzero(sticks & np.isnan(reduced))
            rest = self.rests(blocks[lost], u[lost], stronger * first[lost])
            lost, points = lost[rest.settled], rest.x[rest.settled]
            u[lost], reduced[lost] = points[:, :-1], np.exp(points[:, -1])
        return u, reduced

    def lower(self, blocks: Ints, points: Floats, elastic: Floats) -> tuple[Floats, Floats]:
        """Lower λ from states of rest (n, u + 1) at corners of the path; return the next rests (n, u) and their λ (n,).

        λ is not a number where there is no rest within `SNAP` elastic displacements.
        """
        lower, begin = np.exp(points[:, -1]) * (1.0 - _MARCH), points[:, :-1]
        rest, settled = self.flow(blocks, begin, lower, lengths(begin) + SNAP * elastic)
        lower[~settled | (lengths(rest - begin) > SNAP * elastic)] = np.nan
        return rest, lower

    def follow(
        self, blocks: Ints, u: Floats, reduction: Floats, elastic: Floats, ends: Floats
    ) -> Paths:
        """Follow elastic paths from states of rest, each until its block runs or λ has turned for good.

        Parameters
        ----------
        u : (n, u); reduction : (n,); elastic : (n,) size of an elastic displacement
        ends : (n,) ln λ to which a path is known to rise in the end: it is left once λ turned up; infinite if unknown
        """
        scale, count = lengths(u), len(u)
        point = np.concatenate([u, np.log(reduction)[:, None]], axis=1)
        down = np.zeros_like(point)
        down[:, -1] = -1.0
        first_roots = self.on_planes(blocks, down, scale, on_scale(point, 1.0 / scale))
        paths = Paths(
            rows=np.arange(count),
            point=point,
            tangent=first_roots.tangent,
            side=first_roots.side,
            length=np.full(count, _FIRST),
            lowest=point.copy(),
            turns=np.zeros(count, dtype=bool),
            heading=first_roots.tangent[:, :-1].copy(),
            early=np.where(scale <= EARLY * elastic, point[:, -1], np.inf),
            steps=np.zeros(count, dtype=np.int64),
            outcome=np.where(first_roots.settled, -1, PathEnd.CORNER),
        )
        active = paths.take(np.flatnonzero(first_roots.settled))
        while len(active.rows):
            self._step(blocks[active.rows], active, elastic[active.rows], ends[active.rows])
            if (active.outcome >= 0).any():
                paths.put(active.take(np.flatnonzero(active.outcome >= 0)))
                active = active.take(np.flatnonzero(active.outcome < 0))
        return paths

    def _step(self, blocks: Ints, paths: Paths, elastic: Floats, ends: Floats) -> None:
        """Take one step along each path, or shorten the step where it strays."""
        along, tangent, previous, size = (
            paths.length,
            paths.tangent,
            paths.point,
            lengths(paths.point[:, :-1]),
        )
        start = on_scale(previous, 1.0 / size) + along[:, None] * tangent
        roots = self.on_planes(blocks, tangent, size, start)
        next_tangent, cosine = roots.tangent, dots(roots.tangent, tangent)
        next_tangent[
            np.abs(next_tangent[:, -1]) < ROUNDING, -1
        ] = -ROUNDING  # a level path has not turned
        previous_slope, slope, change = (
            tangent[:, -1],
            next_tangent[:, -1],
            roots.x[:, -1] - previous[:, -1],
        )
        # λ changed by other than its slopes at both points predict: the path may have turned between them
        strays = np.abs(change - 0.5 * along * (previous_slope + slope)) > _MISSED * along
        # the point is on another path close by, farther away than the step, or took many evaluations
        strays |= (
            (roots.side != paths.side)
            | (lengths(roots.x - start) > along)
            | (roots.evaluations > _EASY[1])
        )
        good = roots.settled & ~(strays & (along > _CORNER))
        paths.side = np.where(good, roots.side, paths.side)
        paths.point = np.where(good[:, None], on_scale(roots.x, size), previous)
        log_reduction, next_size = paths.point[:, -1], lengths(paths.point[:, :-1])
        turns = (
            good
            & (previous_slope < 0.0)
            & ((slope >= 0.0) | (change > 0.0))
            & (previous[:, -1] <= paths.lowest[:, -1])
        )
        lower = log_reduction < paths.lowest[:, -1]
        paths.lowest[lower], paths.turns = (
            paths.point[lower],
            np.where(lower, slope >= 0.0, paths.turns | turns),
        )
        mean_direction = (
            units((tangent + next_tangent)[:, :-1])
            * lengths((paths.point - previous)[:, :-1])[:, None]
        )
        paths.heading[turns | lower] = mean_direction[turns | lower]
        # interpolate ln λ linearly in 1 / |u|, its behaviour at large displacements
        inside = np.clip(
            (1.0 - size / (EARLY * elastic)) / np.maximum(1.0 - size / next_size, LEVEL), 0.0, 1.0
        )
        early_value = np.where(
            size <= EARLY * elastic,
            previous[:, -1] + inside * (log_reduction - previous[:, -1]),
            np.inf,
        )
        paths.early, paths.steps = np.minimum(paths.early, early_value), paths.steps + 1
        longer = np.where((cosine > _STRAIGHT) & (roots.evaluations <= _EASY[0]), 2.0, 1.0)
        paths.length = np.where(good, np.minimum(along * longer, _LONGEST), along / 4)
        paths.tangent = np.where(
            good[:, None], units(on_scale(next_tangent, size / next_size)), tangent
        )
        rise, is_away = (
            log_reduction - paths.lowest[:, -1],
            lengths((paths.point - paths.lowest)[:, :-1]) > SNAP * elastic,
        )
        final_rise = ends - paths.lowest[:, -1]  # a path that ends lower than it turned goes on
        has_turned = ((rise > _TURNED) & is_away) | (
            paths.turns & (final_rise > 0.0) & (rise > 0.5 * final_rise)
        )
        paths.outcome[(paths.steps >= _MOST_STEPS) | (paths.length < PATH_ENDS)] = PathEnd.CORNER
        paths.outcome[rise > _BACK] = PathEnd.BACK
        paths.outcome[has_turned] = PathEnd.TURNED
        paths.outcome[next_size > FAR * elastic] = PathEnd.FAR

    def settle(
        self, blocks: Ints, lowest: Floats, heading: Floats, branch: Floats
    ) -> tuple[Floats, Floats]:
        """Find the least λ on turns of paths, where its slope along a direction vanishes, by the Illinois rule.

        Parameters
        ----------
        lowest : (n, u + 1) u and ln λ near it; heading : (n, u) as of `Paths`; branch : (n,) its `side`

        Returns
        -------
        u and ln λ (n, u + 1), ln λ infinite where no point was found, and unit tangents (n, u + 1)
        """
        count, scale = len(blocks), lengths(lowest[:, :-1])
        planes, x = (
            np.concatenate([units(heading), np.zeros((count, 1))], axis=1),
            on_scale(lowest, 1.0 / scale),
        )
        stride = lengths(heading) / scale
        best, tangent, rows = x.copy(), planes.copy(), np.arange(count)
        best[:, -1] = np.inf
        position, last, previous_side = (
            np.zeros(count),
            np.full((count, 2), np.nan),
            np.full(count, -1),
        )
        sides = np.full(
            (count, 2, 2), np.nan
        )  # where ln λ falls, and where it rises: place and slope
        for _ in range(_MOST_POLISH):
            roots = self.on_planes(blocks[rows], planes[rows], scale[rows], x[rows])
            is_same_path = roots.settled & (roots.side == branch[rows])
            good, lost = rows[is_same_path], rows[~is_same_path]
            back = 0.5 * (
                position[lost] - last[lost, 0]
            )  # half as far from where the last point was found
            x[lost] -= back[:, None] * planes[lost]
            position[lost] -= back
            points, row_tangents = roots.x[is_same_path], roots.tangent[is_same_path]
            along = dots(row_tangents, planes[good])
            row_tangents /= np.where(along == 0.0, 1.0, along)[:, None]
            current, slope = position[good], row_tangents[:, -1]
            lower = points[:, -1] < best[good, -1]
            best[good[lower]], tangent[good[lower]] = points[lower], row_tangents[lower]
            side = (slope >= 0.0).astype(int)
            sides[good, side] = np.stack([current, slope], axis=1)
            is_same_side = side == previous_side[good]  # Illinois' rule
            sides[good[is_same_side], 1 - side[is_same_side], 1] *= 0.5
            span, rise = (sides[good, 1] - sides[good, 0]).T
            is_between = span > 0.0
            with np.errstate(
                divide="ignore", invalid="ignore"
            ):  # a slope that stayed as it was bends nowhere
                curvature, double_step = (
                    (slope - last[good, 1]) / (current - last[good, 0]),
                    2.0 * np.abs(current - last[good, 0]),
                )
                reach = np.fmax(
                    np.abs(slope) / np.where(curvature > 0.0, curvature, 1.0), double_step
                )
                reach = np.fmin(
                    reach, np.fmax(stride[good], double_step)
                )  # another path may pass close by
                reach = np.where(is_between, np.abs(slope) * span / rise, reach)
            last[good, 0], last[good, 1], previous_side[good] = current, slope, side
            position[good] = current - np.sign(slope) * reach
            x[good] = points + (position[good] - current)[:, None] * row_tangents
            goes_on = np.isfinite(position[rows])
            goes_on[is_same_path] &= ~is_between | (np.abs(slope) * reach > _LEAST)
            rows = rows[goes_on]
            if not len(rows):
                break
        return on_scale(best, scale), units(tangent)


def on_scale(points: Floats, scale: Floats) -> Floats:
    """Return points (n, u + 1) of paths with displacements multiplied by a scale (n,)."""
    return np.concatenate([points[:, :-1] * scale[:, None], points[:, -1:]], axis=1)


def bordered(slopes: Floats, by_log_reduction: Floats, planes: Floats) -> Floats:
    """Return bordered matrices (n, u + 1, u + 1): slopes of forces by u and by ln λ (n, u), and planes as last rows."""
    upper_rows = np.concatenate([slopes, by_log_reduction[:, :, None]], axis=2)
    return np.concatenate([upper_rows, planes[:, None]], axis=1)
