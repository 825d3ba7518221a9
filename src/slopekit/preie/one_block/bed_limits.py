"""The limits of n single blocks on their no-tension elastic beds, all at once.

Four stages, each for the blocks that the previous ones did not settle:

1. The slide of the forces alone with every joint pressed: linear pressure, one linear system for each block. Where no
   corner opens the limit on the bed is that of the forces.
2. The running state: every pressed point slips along a motion that keeps the pressed joints closed,

       g = Y y,   direction of slip = Z z,   |z| = 1,   forces balance at λ

   by Newton's method (Z: motions that keep the pressed joints closed, Y: the rest). At large displacements R along that
   motion a path has λ(R) = λ_T + a / R; where a > 0 it falls to λ_T, which then is its least.
3. The elastic path (`bed_path`) of the other blocks, on coarse triangles.
4. Its least λ on finer triangles: on a turn of the path, at a running state, or at the end of a creeping path.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum
from math import inf

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints, cross
from slopekit.preie.one_block.bed_path import (
    COARSE,
    BedPath,
    PathEnd,
    Paths,
    Roots,
    bordered,
    dots,
    lengths,
    on_scale,
    solve_rows,
    solved,
    units,
)
from slopekit.preie.one_block.polygon_bed import Beds, BedSprings, PointForces
from slopekit.preie.tolerances import (
    FAR,
    FINER_PRESSED,
    LEVEL,
    NO_FORCE,
    PARALLEL,
    POLISHED,
    ROUGHLY_SETTLED,
    SETTLED,
    SPRING_ROUNDING,
    TINY,
)

#: Splits of the triangles on which limits are settled; the next is used where it changes one by more than
#: `FINER_PRESSED`.
SPLITS = (3, 4)
#: λ of a path that runs lies within so many times its slope of λ of the running state.
_SLOPE_TOLERANCE = 5
#: Part of F by forces alone below which a path may turn before it reaches the running state (4 of 328 wedges).
_MAY_TURN_BELOW = 0.95
#: Elastic displacements along the motion at which the slope of a path towards its running state is evaluated.
_FAR_OUT = 100_000
_RUNNING_EFFORT = 40, 0, inf, 0.05  # of Newton's method to a running state, see `bed_path.Effort`
#: To the end of a creeping path, at large displacements, where few points are pressed.
_LANDING_EFFORT = 200, 0, inf, 1e-3
_OTHER_PATH_GAP = (
    0.015  # ln λ by which a turn on finer triangles is higher that belongs to another path
)
_MAX_RESTARTS = 6  # continuations of a path from a state of rest at less strength

#: Motions that keep some contacts of n blocks closed, (n, u, d), and the others, (n, u, u - d).
Bases = tuple[Floats, Floats]


class BedStatus(IntEnum):
    """State of a block on its bed when its strength is reduced to the limit."""

    PRESSED = 0  # slides, pressed on the whole of each joint
    RUNS = 1  # slides on the pressed parts of its joints
    RESTS = 2  # at rest at the least λ, where its pressed part begins to shrink too fast
    CREEPS = 3  # turns about an edge; the limit is that at `FAR` elastic displacements
    NO_REST = 4  # no equilibrium at any strength


@dataclass(frozen=True)
class BedLimits:
    """The limits of n blocks on their beds.

    Attributes
    ----------
    status : (n,) `BedStatus`; reduction : (n,) λ at the limit, not a number without one
    displacement : (n, u) elastic; velocity : (n, u) unit motion
    early : (n,) the least λ within `EARLY` elastic displacements, not a number where the path was not followed
    change : (n,) first-order relative change of λ by splitting the triangles once more
    split : (n,) number of splits of the triangles; steps : (n,) along the path
    """

    status: Ints
    reduction: Floats
    displacement: Floats
    velocity: Floats
    early: Floats
    change: Floats
    split: Ints
    steps: Ints

    @property
    def factor(self) -> Floats:
        """(n,) F, not a number where a block rests at no strength."""
        return 1.0 / self.reduction

    @classmethod
    def none(cls, beds: Beds, split: int) -> "BedLimits":
        """Return limits of blocks that rest at no strength, as initial values that the stages overwrite."""
        count = len(beds.load)
        return cls(
            status=np.full(count, BedStatus.NO_REST, dtype=np.int64),
            reduction=np.full(count, np.nan),
            displacement=np.zeros_like(beds.load),
            velocity=np.zeros_like(beds.load),
            early=np.full(count, np.nan),
            change=np.zeros(count),
            split=np.full(count, split),
            steps=np.zeros(count, dtype=np.int64),
        )

    def point_forces(self, beds: Beds) -> PointForces:
        """Return the forces at the points of the bed of a single block at its limit."""
        slides, opening = (
            self.status[0] in (BedStatus.PRESSED, BedStatus.RUNS),
            self.displacement[0],
        )
        slip, springs = (
            self.velocity[0] if slides else opening,
            BedSprings(beds, int(self.split[0])),
        )
        return springs.point_forces(opening, slip, float(self.reduction[0]), slides)

    def put(self, blocks: Ints, status: BedStatus | Ints, points: Floats, velocity: Floats) -> None:
        """Record the limits of blocks: status, displacements and ln λ (n, u + 1), velocities (n, u) of any length."""
        self.status[blocks], self.reduction[blocks] = status, np.exp(points[:, -1])
        self.displacement[blocks], self.velocity[blocks] = points[:, :-1], units(velocity)


def bed_limits(
    beds: Beds, slides: Floats, splits: tuple[int, ...] = SPLITS, along: int = COARSE
) -> BedLimits:
    """Return the limits of blocks on their elastic beds, by all four stages of this module.

    Parameters
    ----------
    slides : (n, u + 1) of their forces alone: velocity of length one without turning, none where it is not known, and
        λ = 1/F, or a guess of about the right size; a block with λ not a number is skipped
    splits : of the triangles on which limits are settled; the next where it changes one by more than `FINER_PRESSED`
    along : split of the triangles along paths
    """
    limits, ends = running_limits(beds, slides, splits)
    follow_paths(beds, limits, slides[:, -1], ends, splits, along)
    return limits


def running_limits(
    beds: Beds, slides: Floats, splits: tuple[int, ...] = SPLITS
) -> tuple[BedLimits, Floats]:
    """Return the limits of blocks that need no path (stages 1 and 2), and where the paths of the others end.

    Parameters
    ----------
    slides : (n, u + 1) as of `bed_limits`

    Returns
    -------
    limits, and ln λ (n,) to which paths rise in the end: infinite where it is not known, not a number without a path
    """
    limits, ends = BedLimits.none(beds, splits[0]), np.full(len(beds.load), np.inf)
    stages = _LimitStages(beds, splits, limits)
    if not beds.laws:
        motions = beds.rows[:, 0] * np.repeat(slides[:, :-1], np.diff(beds.contact), axis=0)
        closing = np.add.reduceat(np.abs(motions.sum(axis=1)), beds.contact[:-1])
        blocks = np.flatnonzero(
            (closing < PARALLEL) & slides[:, :-1].any(axis=1) & (slides[:, -1] > 0.0)
        )
        for rows, bases in stages.groups_by_free_motions(
            blocks, np.ones(len(beds.rows), dtype=bool)
        ):
            stages.slide(blocks[rows], bases, slides[blocks[rows]], ends)
    ends[(limits.status != BedStatus.NO_REST) | ~(slides[:, -1] > 0.0)] = np.nan
    return limits, ends


def follow_paths(
    beds: Beds,
    limits: BedLimits,
    guess: Floats,
    ends: Floats,
    splits: tuple[int, ...] = SPLITS,
    along: int = COARSE,
) -> None:
    """Follow the elastic paths of blocks and record the limits on them (stages 3 and 4).

    Parameters
    ----------
    limits : of all blocks, in which these are recorded
    guess : (n,) λ of about the right size; ends : (n,) as of `running_limits`
    """
    blocks = np.flatnonzero(~np.isnan(ends))
    if len(blocks):
        _LimitStages(beds, splits, limits, along).along_paths(blocks, guess[blocks], ends[blocks])


class _LimitStages:
    """The four stages of `bed_limits`, which record their results in `limits`."""

    def __init__(
        self, beds: Beds, splits: Sequence[int], limits: BedLimits, along: int = COARSE
    ) -> None:
        self.beds, self.limits = beds, limits
        self.coarsest, self.coarse = (
            BedSprings(beds, 1),
            BedPath(BedSprings(beds, along), ROUGHLY_SETTLED),
        )
        self.finer = [BedPath(BedSprings(beds, split)) for split in splits]

    def gaps(self, blocks: Ints, opening: Floats, extreme: np.ufunc) -> Floats:
        """Return the widest or the narrowest gap (m,) of each contact, with openings (n, u) of some of the blocks."""
        displacements = np.zeros_like(self.beds.load)
        displacements[blocks] = opening
        return extreme.reduceat(self.beds.motions(displacements, 1)[:, 0], self.beds.corner[:-1])

    # -- stages 1 and 2 ------------------------------------------------------------------------------------------

    def groups_by_free_motions(self, blocks: Ints, closed: Bools) -> Iterator[tuple[Ints, Bases]]:
        """Yield blocks grouped by their number of motions that keep closed contacts closed, with bases of the motions.

        closed : (m,) which contacts are; the blocks are rows of `blocks`. Blocks without a closed contact, or without
        such a motion, are left out.
        """
        if not len(blocks):
            return
        first, unknowns = self.beds.contact, self.beds.rows.shape[2]
        contacts = first[blocks, None] + np.arange(max(int(np.diff(first).max()), 2))
        inside = contacts < first[blocks + 1, None]
        contacts[~inside] = 0
        inside &= closed[contacts]
        normals = self.beds.rows[
            np.take_along_axis(contacts, (~inside).argsort(axis=1)[:, :2], axis=1), 0, :3
        ]
        line = cross(normals[:, 0], normals[:, 1])
        slides = (inside.sum(axis=1) == 2) & (lengths(line) > PARALLEL) & (unknowns == 6)
        rows = np.flatnonzero(slides)
        if len(rows):
            yield rows, _along_lines(line[rows], normals[rows, 0])
        rest = np.flatnonzero(~slides)
        opening = self.beds.rows[contacts[rest], :3] * inside[rest, :, None, None]
        _, sizes, basis = np.linalg.svd(
            opening.reshape(len(rest), 3 * contacts.shape[1], unknowns), full_matrices=False
        )
        rank = (sizes > PARALLEL * sizes[:, :1]).sum(axis=1)
        for size in range(1, unknowns):
            rows = np.flatnonzero(rank == size)
            if len(rows):
                singular_vectors = basis[rows].transpose(0, 2, 1)
                yield rest[rows], (singular_vectors[:, :, size:], singular_vectors[:, :, :size])

    def slide(self, blocks: Ints, bases: Bases, slides: Floats, ends: Floats) -> None:
        """Record the limits of blocks that slide on all contacts, and of those whose path ends at a running state.

        Writes into `ends` ln λ of the running states to which the paths of other blocks rise.
        """
        reduction, velocity = slides[:, -1], slides[:, :-1]
        elastic, is_pressed = self.solve_pressed_slide(blocks, bases, reduction, velocity)
        points = np.concatenate([elastic, np.log(reduction)[:, None]], axis=1)
        self.limits.put(
            blocks[is_pressed], BedStatus.PRESSED, points[is_pressed], velocity[is_pressed]
        )
        rows = np.flatnonzero(~is_pressed)
        if not len(rows):
            return
        blocks, reduction, row_bases = (
            blocks[rows],
            reduction[rows],
            (bases[0][rows], bases[1][rows]),
        )
        runs = self.running_states(blocks, row_bases, velocity[rows], points[rows])
        v, w, lam = _motions(row_bases, runs.x)
        closest = self.gaps(blocks, w, np.minimum)
        good = (
            runs.settled
            & (np.maximum.reduceat(closest, self.beds.contact[:-1])[blocks] < 0.0)
            & (lam > 0.0)
        )
        far_slip = (
            w + (_FAR_OUT * np.maximum(self.beds.elastic_size[blocks], lengths(w)))[:, None] * v
        )
        residual = self.coarsest.unbalanced(blocks, w, far_slip, lam, running=True).force
        rising = good & ~(_reduction_change(runs.slopes, residual) > 0.0)
        ends[blocks[rising]] = np.log(lam[rising])
        # either the bed carries what the forces alone allow, or the path comes down to this state
        good &= (lam <= reduction * (1.0 + SETTLED)) | (
            ~rising & (lam < reduction / _MAY_TURN_BELOW)
        )
        self.limits.put(blocks[good], BedStatus.RUNS, _points(w, lam)[good], v[good])

    def solve_pressed_slide(
        self, blocks: Ints, bases: Bases, reduction: Floats, velocity: Floats
    ) -> tuple[Floats, Bools]:
        """Solve for linear pressures on whole joints under blocks that slide at λ (n,) with velocities (n, u).

        Returns
        -------
        elastic displacements (n, u), and whether forces balance and no corner opens (n,)
        """
        beds, springs = self.beds, self.coarsest
        count, rest = np.diff(beds.contact)[blocks], bases[1].transpose(0, 2, 1)
        block_row, first = np.repeat(np.arange(len(blocks)), count), np.cumsum([0, *count[:-1]])
        contacts = np.arange(len(block_row)) + (beds.contact[blocks] - first)[block_row]
        rows, moments, lam = (
            beds.rows[contacts].reshape(len(contacts), 3, 3, -1),
            beds.contact_moments[contacts],
            reduction[block_row],
        )
        cohesion, tan_friction = lam * beds.line[contacts, 1], lam * beds.line[contacts, 2]
        speed = (rows[:, 1:] @ velocity[block_row][:, None, :, None])[
            :, :, 0, 0
        ]  # of slip, the same at all points of a contact
        direction = speed / np.maximum(lengths(speed), NO_FORCE)[:, None]
        drag = np.einsum(
            "mj,mjku->mku", direction, rows[:, 1:]
        )  # (m, 3, u) forces of a shear traction of 1, ξ and η
        push = rows[:, 0] - tan_friction[:, None, None] * drag
        matrix = -np.add.reduceat(push.transpose(0, 2, 1) @ (moments @ rows[:, 0]), first)
        force = beds.load[blocks] - np.add.reduceat(
            cohesion[:, None] * (moments[:, :1] @ drag)[:, 0], first
        )
        if beds.bolt_capacity.shape[1]:
            pulls, _, _ = springs.pulls(blocks, velocity, reduction, True)
            force = force + (pulls[:, None] @ beds.bolt_rows[blocks])[:, 0]
        elastic = solved(rest @ matrix @ bases[1], -(rest @ force[:, :, None])[:, :, 0])
        opening = (bases[1] @ elastic[:, :, None])[:, :, 0]
        imbalance = np.abs(force + (matrix @ opening[:, :, None])[:, :, 0]).max(axis=1)
        widest = np.maximum.reduceat(self.gaps(blocks, opening, np.maximum), beds.contact[:-1])[
            blocks
        ]
        return opening, (widest < NO_FORCE) & (imbalance < SETTLED)

    def running_states(self, blocks: Ints, bases: Bases, velocity: Floats, points: Floats) -> Roots:
        """Solve for the running states of blocks with equally many free motions, from motions and points near them.

        With one free motion a contact slips in one direction, and the coarsest triangles are exact for linear strength.
        """
        if bases[0].shape[2] == 1 and not self.beds.laws:
            return _solve_running(self.coarsest, blocks, bases, velocity, points)
        runs = _solve_running(self.finer[0].springs, blocks, bases, velocity, points)
        rows = np.flatnonzero(runs.settled)
        for fine in self.finer:
            row_bases = bases[0][rows], bases[1][rows]
            if fine is not self.finer[0]:
                v, w, lam = _motions(row_bases, runs.x[rows])
                better = _solve_running(fine.springs, blocks[rows], row_bases, v, _points(w, lam))
                runs.x[rows[better.settled]] = better.x[better.settled]
            v, w, lam = _motions(row_bases, runs.x[rows])
            residual = fine.springs.finer().unbalanced(blocks[rows], w, v, lam, running=True).force
            rows = self.record_refinement(
                fine, blocks, rows, np.abs(_reduction_change(runs.slopes[rows], residual) / lam)
            )
        return runs

    def record_refinement(self, fine: BedPath, blocks: Ints, rows: Ints, change: Floats) -> Ints:
        """Record by how much finer triangles would change λ in these rows; return the rows where that matters."""
        self.limits.split[blocks[rows]], self.limits.change[blocks[rows]] = (
            fine.springs.split,
            change,
        )
        return rows[change > FINER_PRESSED]

    def check_refinement(
        self, fine: BedPath, blocks: Ints, rows: Ints, lowest: Floats, tangent: Floats
    ) -> Ints:
        """Record how much finer triangles change ln λ at points (n, u + 1) of paths; return the rows to refine."""
        springs, row_blocks, points = fine.springs, blocks[rows], lowest[rows]
        u, reduction = points[:, :-1], np.exp(points[:, -1])
        residual = springs.unbalanced(row_blocks, u, u, reduction)
        scaled = (residual.by_opening + residual.by_slip) * lengths(u)[:, None, None]
        slopes = bordered(scaled, residual.by_reduction * reduction[:, None], tangent[rows])
        finer_force = springs.finer().unbalanced(row_blocks, u, u, reduction).force
        return self.record_refinement(
            fine, blocks, rows, np.abs(_reduction_change(slopes, finer_force))
        )

    # -- stages 3 and 4 ------------------------------------------------------------------------------------------

    def along_paths(self, blocks: Ints, guess: Floats, ends: Floats) -> None:
        """Follow the paths of blocks to their least λ, refine it, and record the limits."""
        u, reduction = self.coarse.start(blocks, guess)
        rests = np.isfinite(reduction)
        blocks, u, reduction, ends = blocks[rests], u[rests], reduction[rests], ends[rests]
        if not len(blocks):
            return
        elastic = lengths(u)
        path = self.follow_to_ends(blocks, u, reduction, elastic, ends)
        self.limits.early[blocks], self.limits.steps[blocks] = np.exp(path.early), path.steps
        is_coarse = np.ones(len(blocks), dtype=bool)  # no balance on finer triangles yet
        lowest, tangent, is_far = (
            path.lowest.copy(),
            path.tangent.copy(),
            path.outcome == PathEnd.FAR,
        )

        def refine(rows: Ints, move: Callable[..., Bools], place: str) -> None:
            for fine in self.finer:
                settled = move(fine, blocks, rows, path, FAR * elastic, lowest, tangent)
                lost = rows[~settled]
                retried_paths = fine.follow(
                    blocks[lost], u[lost], reduction[lost], elastic[lost], ends[lost]
                )
                as_low = getattr(retried_paths, place)[:, -1] < lowest[lost, -1] + _OTHER_PATH_GAP
                retried_paths = retried_paths.take(
                    np.flatnonzero(
                        as_low & (retried_paths.turns | (retried_paths.outcome == PathEnd.FAR))
                    )
                )
                retried = lost[
                    retried_paths.rows
                ]  # their path on finer triangles ends in the same way
                path.continue_with(retried, retried_paths)
                lowest[retried], tangent[retried] = (
                    getattr(retried_paths, place),
                    retried_paths.tangent,
                )
                settled[np.isin(rows, retried)] = move(
                    fine, blocks, retried, path, FAR * elastic, lowest, tangent
                )
                is_coarse[rows[settled]] = False
                rows = self.check_refinement(fine, blocks, rows[settled], lowest, tangent)

        refine(np.flatnonzero(path.turns), _move_to_turns, "lowest")
        path.turns &= ~is_far | (
            path.point[:, -1] - path.lowest[:, -1] > POLISHED
        )  # else λ only flattens out
        may_run = np.flatnonzero(path.outcome != PathEnd.TURNED)
        is_left = np.ones(len(blocks), dtype=bool)
        is_left[
            may_run[
                self.settle_running_states(blocks[may_run], path.take(may_run), lowest[may_run])
            ]
        ] = False
        creeps = is_left & is_far & ~path.turns
        rows = np.flatnonzero(creeps & is_coarse)
        lowest[rows], tangent[rows] = (
            path.point[rows],
            path.tangent[rows],
        )  # as low, and nearer to the end of the path
        refine(rows, _move_to_farthest, "point")
        self.limits.split[blocks[creeps & is_coarse]] = self.coarse.springs.split
        status = np.where(creeps, BedStatus.CREEPS, BedStatus.RESTS)
        motion = _onward_motion(tangent, lowest)
        motion *= np.where(dots(self.beds.load[blocks], motion) < 0.0, -1.0, 1.0)[
            :, None
        ]  # on some paths the displacement decreases
        self.limits.put(blocks[is_left], status[is_left], lowest[is_left], motion[is_left])

    def follow_to_ends(
        self, blocks: Ints, u: Floats, reduction: Floats, elastic: Floats, ends: Floats
    ) -> Paths:
        """Follow paths until blocks run, with finer triangles or from a rest at less strength where paths end early.

        Such a rest replaces the start of the path in `u` (n, u) and `reduction` (n,).
        """
        path = self.coarse.follow(blocks, u, reduction, elastic, ends)
        lost = np.flatnonzero(path.outcome == PathEnd.CORNER)
        if len(lost):
            path.continue_with(
                lost,
                self.finer[0].follow(
                    blocks[lost], u[lost], reduction[lost], elastic[lost], ends[lost]
                ),
            )
        for _ in range(_MAX_RESTARTS):
            lost = np.flatnonzero(path.outcome >= PathEnd.BACK)
            turns = lost[path.turns[lost]]
            turning_points, _ = self.coarse.settle(
                blocks[turns], path.lowest[turns], path.heading[turns], path.side[turns]
            )
            path.lowest[turns] = np.where(
                np.isfinite(turning_points[:, -1:]), turning_points, path.lowest[turns]
            )
            rest, lower = self.coarse.lower(blocks[lost], path.lowest[lost], elastic[lost])
            goes_on = np.isfinite(lower)
            if not goes_on.any():
                break
            lost, rest, lower = lost[goes_on], rest[goes_on], lower[goes_on]
            path.continue_with(
                lost, self.coarse.follow(blocks[lost], rest, lower, elastic[lost], ends[lost])
            )
            u[lost], reduction[lost] = rest, lower
        return path

    def settle_running_states(self, blocks: Ints, path: Paths, lowest: Floats) -> Bools:
        """Find the running states that paths approach, record them, and return which paths (n,) have one."""
        settled, is_far = np.zeros(len(blocks), dtype=bool), path.outcome == PathEnd.FAR
        points = np.concatenate(
            [np.where(is_far[:, None], path.point, lowest)[:, :-1], lowest[:, -1:]], axis=1
        )
        motion, least = _onward_motion(path.tangent, points), np.exp(lowest[:, -1])
        slope = np.where(is_far & ~path.turns, np.abs(path.tangent[:, -1]), 0.0)
        for rows, bases in self.groups_by_free_motions(
            blocks, self.gaps(blocks, points[:, :-1], np.minimum) < 0.0
        ):
            nearest = _solve_running(
                self.coarse.springs, blocks[rows], bases, motion[rows], points[rows]
            )
            v, w, lam = _motions(bases, nearest.x)
            is_near = nearest.settled & (
                np.abs(lam / least[rows] - 1.0) <= POLISHED + _SLOPE_TOLERANCE * slope[rows]
            )
            near_bases = bases[0][is_near], bases[1][is_near]
            runs = self.running_states(
                blocks[rows[is_near]], near_bases, v[is_near], _points(w, lam)[is_near]
            )
            v, w, lam = _motions(near_bases, runs.x)
            good = rows[is_near][runs.settled]
            settled[good] = True
            self.limits.put(
                blocks[good], BedStatus.RUNS, _points(w, lam)[runs.settled], v[runs.settled]
            )
        return settled


def _along_lines(line: Floats, normal: Floats) -> Bases:
    """Return motions along lines (n, 3) of intersection of two planes, and all others; normals (n, 3) of one plane."""
    bases, along = np.zeros((len(line), 6, 6)), units(line)
    bases[:, :3, 0], bases[:, :3, 1], bases[:, :3, 2] = along, normal, cross(along, normal)
    bases[:, 3:, 3:] = np.eye(3)
    return bases[:, :, :1], bases[:, :, 1:]


def _motions(bases: Bases, x: Floats) -> tuple[Floats, Floats, Floats]:
    """Return velocities v (n, u), displacements w (n, u) and λ (n,) of running states x."""
    free = bases[0].shape[2]
    return (
        (bases[0] @ x[:, :free, None])[:, :, 0],
        (bases[1] @ x[:, free:-1, None])[:, :, 0],
        x[:, -1],
    )


def _points(displacement: Floats, reduction: Floats) -> Floats:
    """Return displacements and ln λ in one array (n, u + 1); λ is at least `TINY`."""
    return np.concatenate([displacement, np.log(np.maximum(reduction, TINY))[:, None]], axis=1)


def _onward_motion(tangent: Floats, points: Floats) -> Floats:
    """Return the motion (n, u) of blocks at the end of a path: its tangent; at a corner, where it is zero, u itself."""
    return np.where(lengths(tangent[:, :-1])[:, None] < LEVEL, points[:, :-1], tangent[:, :-1])


def _reduction_change(slopes: Floats, residual: Floats) -> Floats:
    """Return the first-order change of λ (n,) due to unbalanced forces (n, u), by the slopes (n, u + 1, u + 1)."""
    return solved(slopes, np.concatenate([-residual, np.zeros((len(residual), 1))], axis=1))[:, -1]


def _solve_running(
    springs: BedSprings, blocks: Ints, bases: Bases, velocity: Floats, points: Floats
) -> Roots:
    """Balance the forces of blocks that run, by Newton's method from velocities (n, u) and points (n, u + 1)."""
    free, size = bases[0].shape[2], springs.beds.load.shape[1]
    along, elastic = (
        (basis.transpose(0, 2, 1) @ vector[:, :, None])[:, :, 0]
        for basis, vector in zip(bases, (velocity, points[:, :-1]), strict=True)
    )
    start = np.concatenate([units(along), elastic, np.exp(points[:, -1:])], axis=1)

    def equations(rows: Ints, x: Floats) -> tuple[Floats, Floats, Floats]:
        row_bases = bases[0][rows], bases[1][rows]
        v, w, lam = _motions(row_bases, x)
        residual = springs.unbalanced(blocks[rows], w, v, lam, running=True)
        slopes = np.concatenate(
            [residual.by_slip @ row_bases[0], residual.by_opening @ row_bases[1]], axis=2
        )
        speed = np.concatenate([x[:, :free], np.zeros((len(x), size + 1 - free))], axis=1)
        length_error = 0.5 * ((speed * speed).sum(axis=1) - 1.0)
        # contact forces of a block that is wedged in may be many times its load
        pushes = (np.abs(residual.by_opening) @ np.abs(w)[:, :, None]).max(axis=(1, 2))
        small = np.maximum(NO_FORCE * np.maximum(1.0, np.abs(lam)), SPRING_ROUNDING * pushes)
        return (
            np.concatenate([residual.force, length_error[:, None]], axis=1),
            bordered(slopes, residual.by_reduction, speed),
            small,
        )

    return solve_rows(equations, start, _RUNNING_EFFORT)


def _move_to_turns(
    fine: BedPath,
    blocks: Ints,
    rows: Ints,
    path: Paths,
    farthest: Floats,
    lowest: Floats,
    tangent: Floats,
) -> Bools:
    """Move points to the least λ on turns of paths, on finer triangles; return which rows were moved.

    A turn that lies farther away, or much higher, belongs to another path and is not taken.
    """
    turning_points, along = fine.settle(
        blocks[rows], lowest[rows], path.heading[rows], path.side[rows]
    )
    good: Bools = (turning_points[:, -1] < lowest[rows, -1] + _OTHER_PATH_GAP) & (
        lengths(turning_points[:, :-1]) <= farthest[rows]
    )
    lowest[rows[good]], tangent[rows[good]] = turning_points[good], along[good]
    return good


def _move_to_farthest(
    fine: BedPath,
    blocks: Ints,
    rows: Ints,
    path: Paths,
    farthest: Floats,
    lowest: Floats,
    tangent: Floats,
) -> Bools:
    """Move points of creeping paths to the farthest displacement, on finer triangles; return which rows were moved."""
    goal, start = farthest[rows], lowest[rows]
    start[:, :-1] = units(start[:, :-1])
    planes = np.concatenate([start[:, :-1], np.zeros((len(rows), 1))], axis=1)
    landings = fine.on_planes(blocks[rows], planes, goal, start, _LANDING_EFFORT)
    good = rows[landings.settled]
    lowest[good], tangent[good] = (
        on_scale(landings.x, goal)[landings.settled],
        landings.tangent[landings.settled],
    )
    return landings.settled
