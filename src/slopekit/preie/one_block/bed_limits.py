"""The limits of n single blocks on their no-tension elastic beds, all at once.

Four stages, each for the rows that the one before did not settle:

1. The slide of the forces alone, every joint of it pressed: linear pressure, one linear system a block. Where no corner
   opens the bed allows what the forces allow.
2. The running state: every pressed point slips along a motion that keeps the pressed joints closed,

       g = Y y,   direction of slip = Z z,   |z| = 1,   forces balance at λ

   by Newton's method (Z: motions that keep the pressed joints closed, Y: the rest). Far out along that motion a path
   has λ(R) = λ_T + a / R; where a > 0 it comes down to λ_T, which then is its least.
3. The elastic path (`bed_path`) of the other blocks, on coarse triangles.
4. Its least λ on finer ones: on a turn of the path, at a running state, or where a path that creeps is left.
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

#: Splits of the triangles on which limits are settled; the next where it changes one by more than `FINER_PRESSED`.
SPLITS = (3, 4)
_SETTLES = 5  # times its slope: λ of a path that runs is as near to that of the running state
_DEEP = 0.95  # of F by forces: below it paths may turn before they come down to the running state (4 of 328 wedges)
_FAR_OUT = 100_000  # elastic displacements: so far out along its motion it is asked whether a path comes down or up
_RUNNING = 40, 0, inf, 0.05  # to a running state, as of `bed_path`
_LANDING = 200, 0, inf, 1e-3  # to where a path that creeps is left: far out, where few points carry
_ANOTHER = 0.015  # of ln λ: finer triangles move a turn by less; one that is so much higher is another path's
_MOST_LOWERED = 6  # times that a path goes on from a rest at less strength

#: Motions that keep some contacts of n blocks closed, (n, u, d), and the others, (n, u, u - d).
Bases = tuple[Floats, Floats]


class BedStatus(IntEnum):
    """How a block on its bed ends as its strength goes down."""

    PRESSED = 0  # it slides, pressed on the whole of each joint
    RUNS = 1  # it runs on the parts of its joints that are pressed
    RESTS = 2  # λ turns while the block is still at rest: its pressed part shrinks too fast from there
    CREEPS = 3  # it runs about an edge; the limit is that at `FAR` elastic displacements
    NO_REST = 4  # it rests at no strength


@dataclass(frozen=True)
class BedLimits:
    """The limits of n blocks on their beds.

    Attributes
    ----------
    status : (n,) `BedStatus`; reduction : (n,) λ at the limit, not a number without one
    displacement : (n, u) elastic; velocity : (n, u) unit motion
    early : (n,) the least λ within `EARLY` elastic displacements, not a number where the path was not followed
    change : (n,) what splitting the triangles once more does to λ, in parts of it (first order)
    split : (n,) how often triangles were split; steps : (n,) along the path
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
        """Return those of blocks that rest at no strength, for what is found of some of them."""
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

    def carried(self, beds: Beds) -> PointForces:
        """Return what the points of its bed carry at the limit of a single block."""
        slides, opening = self.status[0] in (BedStatus.PRESSED, BedStatus.RUNS), self.displacement[0]
        slip, springs = self.velocity[0] if slides else opening, BedSprings(beds, int(self.split[0]))
        return springs.carried(opening, slip, float(self.reduction[0]), slides)

    def put(self, blocks: Ints, status: BedStatus | Ints, points: Floats, velocity: Floats) -> None:
        """Note how blocks end: at displacements and ln λ (n, u + 1), with velocities (n, u) of any length."""
        self.status[blocks], self.reduction[blocks] = status, np.exp(points[:, -1])
        self.displacement[blocks], self.velocity[blocks] = points[:, :-1], units(velocity)


def bed_limits(beds: Beds, slides: Floats, splits: tuple[int, ...] = SPLITS, along: int = COARSE) -> BedLimits:
    """Return the limits of some blocks on their beds.

    Parameters
    ----------
    slides : (n, u + 1) of their forces alone: velocity of length one without turning, none where it is not known, and
        λ = 1/F, or a guess of about the right size; a block is left alone where that is not a number
    splits : of the triangles on which limits are settled; the next where it changes one by more than `FINER_PRESSED`
    along : split of the triangles along paths
    """
    found, ends = running_limits(beds, slides, splits)
    follow_paths(beds, found, slides[:, -1], ends, splits, along)
    return found


def running_limits(beds: Beds, slides: Floats, splits: tuple[int, ...] = SPLITS) -> tuple[BedLimits, Floats]:
    """Return the limits of blocks that need no path (stages 1 and 2), and where the paths of the others end.

    Parameters
    ----------
    slides : (n, u + 1) as of `bed_limits`

    Returns
    -------
    limits, and ln λ (n,) to which paths rise in the end: infinite where it is not known, not a number without a path
    """
    found, ends = BedLimits.none(beds, splits[0]), np.full(len(beds.load), np.inf)
    limits = _Limits(beds, splits, found)
    if not beds.laws:
        moves = beds.rows[:, 0] * np.repeat(slides[:, :-1], np.diff(beds.contact), axis=0)
        apart = np.add.reduceat(np.abs(moves.sum(axis=1)), beds.contact[:-1])
        blocks = np.flatnonzero((apart < PARALLEL) & slides[:, :-1].any(axis=1) & (slides[:, -1] > 0.0))
        for rows, bases in limits.alike(blocks, np.ones(len(beds.rows), dtype=bool)):
            limits.slide(blocks[rows], bases, slides[blocks[rows]], ends)
    ends[(found.status != BedStatus.NO_REST) | ~(slides[:, -1] > 0.0)] = np.nan
    return found, ends


def follow_paths(
    beds: Beds,
    found: BedLimits,
    guess: Floats,
    ends: Floats,
    splits: tuple[int, ...] = SPLITS,
    along: int = COARSE,
) -> None:
    """Note the limits that blocks have on their paths (stages 3 and 4).

    Parameters
    ----------
    found : where they are noted
    guess : (n,) λ of about the right size; ends : (n,) as of `running_limits`
    """
    blocks = np.flatnonzero(~np.isnan(ends))
    if len(blocks):
        _Limits(beds, splits, found, along).along_paths(blocks, guess[blocks], ends[blocks])


class _Limits:
    """The stages, and what they found."""

    def __init__(self, beds: Beds, splits: Sequence[int], found: BedLimits, along: int = COARSE) -> None:
        self.beds, self.found = beds, found
        self.whole, self.coarse = BedSprings(beds, 1), BedPath(BedSprings(beds, along), ROUGHLY_SETTLED)
        self.finer = [BedPath(BedSprings(beds, split)) for split in splits]

    def gaps(self, blocks: Ints, opening: Floats, extreme: np.ufunc) -> Floats:
        """Return the widest or the narrowest gap (m,) of each contact, with openings (n, u) of some of the blocks."""
        every = np.zeros_like(self.beds.load)
        every[blocks] = opening
        return extreme.reduceat(self.beds.motions(every, 1)[:, 0], self.beds.corner[:-1])

    # -- stages 1 and 2 ------------------------------------------------------------------------------------------

    def alike(self, blocks: Ints, closed: Bools) -> Iterator[tuple[Ints, Bases]]:
        """Yield blocks (their places) with as many motions that keep closed contacts (m,) closed, and these motions.

        Blocks that nothing closed holds, or that have no such motion, are left out.
        """
        if not len(blocks):
            return
        first, unknowns = self.beds.contact, self.beds.rows.shape[2]
        each = first[blocks, None] + np.arange(max(int(np.diff(first).max()), 2))
        inside = each < first[blocks + 1, None]
        each[~inside] = 0
        inside &= closed[each]
        normals = self.beds.rows[np.take_along_axis(each, (~inside).argsort(axis=1)[:, :2], axis=1), 0, :3]
        line = cross(normals[:, 0], normals[:, 1])
        slides = (inside.sum(axis=1) == 2) & (lengths(line) > PARALLEL) & (unknowns == 6)
        rows = np.flatnonzero(slides)
        if len(rows):
            yield rows, _along_lines(line[rows], normals[rows, 0])
        rest = np.flatnonzero(~slides)
        opening = self.beds.rows[each[rest], :3] * inside[rest, :, None, None]
        _, sizes, basis = np.linalg.svd(opening.reshape(len(rest), 3 * each.shape[1], unknowns), full_matrices=False)
        rank = (sizes > PARALLEL * sizes[:, :1]).sum(axis=1)
        for size in range(1, unknowns):
            rows = np.flatnonzero(rank == size)
            if len(rows):
                some = basis[rows].transpose(0, 2, 1)
                yield rest[rows], (some[:, :, size:], some[:, :, :size])

    def slide(self, blocks: Ints, bases: Bases, slides: Floats, ends: Floats) -> None:
        """Settle the blocks that slide on all of their contacts, and those whose path ends at a running state.

        Notes in `ends` ln λ of the running states to which the paths of others rise.
        """
        reduction, velocity = slides[:, -1], slides[:, :-1]
        elastic, is_pressed = self.pressed(blocks, bases, reduction, velocity)
        points = np.concatenate([elastic, np.log(reduction)[:, None]], axis=1)
        self.found.put(blocks[is_pressed], BedStatus.PRESSED, points[is_pressed], velocity[is_pressed])
        rows = np.flatnonzero(~is_pressed)
        if not len(rows):
            return
        blocks, reduction, some = blocks[rows], reduction[rows], (bases[0][rows], bases[1][rows])
        runs = self.running(blocks, some, velocity[rows], points[rows])
        v, w, lam = _motions(some, runs.x)
        closest = self.gaps(blocks, w, np.minimum)
        good = runs.settled & (np.maximum.reduceat(closest, self.beds.contact[:-1])[blocks] < 0.0) & (lam > 0.0)
        far = w + (_FAR_OUT * np.maximum(self.beds.first[blocks], lengths(w)))[:, None] * v
        out = self.whole.unbalanced(blocks, w, far, lam, running=True).out
        rising = good & ~(_change(runs.slopes, out) > 0.0)
        ends[blocks[rising]] = np.log(lam[rising])
        # the bed allows no less than the forces do, or the path comes down to this state
        good &= (lam <= reduction * (1.0 + SETTLED)) | (~rising & (lam < reduction / _DEEP))
        self.found.put(blocks[good], BedStatus.RUNS, _points(w, lam)[good], v[good])

    def pressed(self, blocks: Ints, bases: Bases, reduction: Floats, velocity: Floats) -> tuple[Floats, Bools]:
        """Solve for linear pressures on the whole of each joint under slides at λ (n,), along velocities (n, u).

        Returns
        -------
        elastic displacements (n, u) by the motions that press, and whether forces balance and no corner opens (n,)
        """
        beds, springs = self.beds, self.whole
        count, rest = np.diff(beds.contact)[blocks], bases[1].transpose(0, 2, 1)
        number, first = np.repeat(np.arange(len(blocks)), count), np.cumsum([0, *count[:-1]])
        which = np.arange(len(number)) + (beds.contact[blocks] - first)[number]
        rows, whole, lam = beds.rows[which].reshape(len(which), 3, 3, -1), beds.whole[which], reduction[number]
        cohesion, tan_friction = lam * beds.line[which, 1], lam * beds.line[which, 2]
        speed = (rows[:, 1:] @ velocity[number][:, None, :, None])[:, :, 0, 0]  # of slip, alike all over a contact
        way = speed / np.maximum(lengths(speed), NO_FORCE)[:, None]
        drag = np.einsum("mj,mjku->mku", way, rows[:, 1:])  # (m, 3, u) what a unit shear by 1, ξ and η does
        push = rows[:, 0] - tan_friction[:, None, None] * drag
        matrix = -np.add.reduceat(push.transpose(0, 2, 1) @ (whole @ rows[:, 0]), first)
        out = beds.load[blocks] - np.add.reduceat(cohesion[:, None] * (whole[:, :1] @ drag)[:, 0], first)
        if beds.bolt_capacity.shape[1]:
            pulls, _, _ = springs.pulls(blocks, velocity, reduction, True)
            out = out + (pulls[:, None] @ beds.bolt_rows[blocks])[:, 0]
        elastic = solved(rest @ matrix @ bases[1], -(rest @ out[:, :, None])[:, :, 0])
        opening = (bases[1] @ elastic[:, :, None])[:, :, 0]
        off = np.abs(out + (matrix @ opening[:, :, None])[:, :, 0]).max(axis=1)
        widest = np.maximum.reduceat(self.gaps(blocks, opening, np.maximum), beds.contact[:-1])[blocks]
        return opening, (widest < NO_FORCE) & (off < SETTLED)

    def running(self, blocks: Ints, bases: Bases, velocity: Floats, points: Floats) -> Roots:
        """Find the running states of blocks with as many free motions each, from motions and points near them.

        Where there is one, all of a contact slips one way, and the coarsest triangles are exact for straight laws.
        """
        if bases[0].shape[2] == 1 and not self.beds.laws:
            return _run(self.whole, blocks, bases, velocity, points)
        runs = _run(self.finer[0].springs, blocks, bases, velocity, points)
        rows = np.flatnonzero(runs.settled)
        for fine in self.finer:
            some = bases[0][rows], bases[1][rows]
            if fine is not self.finer[0]:
                v, w, lam = _motions(some, runs.x[rows])
                better = _run(fine.springs, blocks[rows], some, v, _points(w, lam))
                runs.x[rows[better.settled]] = better.x[better.settled]
            v, w, lam = _motions(some, runs.x[rows])
            out = fine.springs.finer().unbalanced(blocks[rows], w, v, lam, running=True).out
            rows = self.noted(fine, blocks, rows, np.abs(_change(runs.slopes[rows], out) / lam))
        return runs

    def noted(self, fine: BedPath, blocks: Ints, rows: Ints, change: Floats) -> Ints:
        """Note what triangles finer than these would change in some rows; return those where that matters."""
        self.found.split[blocks[rows]], self.found.change[blocks[rows]] = fine.springs.split, change
        return rows[change > FINER_PRESSED]

    def checked(self, fine: BedPath, blocks: Ints, rows: Ints, lowest: Floats, tangent: Floats) -> Ints:
        """Note what finer triangles would do to ln λ at points (n, u + 1) of paths, to first order, as `noted`."""
        springs, some, points = fine.springs, blocks[rows], lowest[rows]
        u, reduction = points[:, :-1], np.exp(points[:, -1])
        at = springs.unbalanced(some, u, u, reduction)
        scaled = (at.by_opening + at.by_slip) * lengths(u)[:, None, None]
        slopes = bordered(scaled, at.by_reduction * reduction[:, None], tangent[rows])
        out = springs.finer().unbalanced(some, u, u, reduction).out
        return self.noted(fine, blocks, rows, np.abs(_change(slopes, out)))

    # -- stages 3 and 4 ------------------------------------------------------------------------------------------

    def along_paths(self, blocks: Ints, guess: Floats, ends: Floats) -> None:
        """Follow the paths of blocks to their least λ."""
        u, reduction = self.coarse.start(blocks, guess)
        rests = np.isfinite(reduction)
        blocks, u, reduction, ends = blocks[rests], u[rests], reduction[rests], ends[rests]
        if not len(blocks):
            return
        elastic = lengths(u)
        path = self.followed(blocks, u, reduction, elastic, ends)
        self.found.early[blocks], self.found.steps[blocks] = np.exp(path.early), path.steps
        is_coarse = np.ones(len(blocks), dtype=bool)  # no finer triangles balance
        lowest, tangent, is_far = path.lowest.copy(), path.tangent.copy(), path.outcome == PathEnd.FAR

        def on_finer(rows: Ints, move: Callable[..., Bools], place: str) -> None:
            for fine in self.finer:
                settled = move(fine, blocks, rows, path, FAR * elastic, lowest, tangent)
                lost = rows[~settled]
                anew = fine.follow(blocks[lost], u[lost], reduction[lost], elastic[lost], ends[lost])
                as_low = getattr(anew, place)[:, -1] < lowest[lost, -1] + _ANOTHER
                anew = anew.of(np.flatnonzero(as_low & (anew.turns | (anew.outcome == PathEnd.FAR))))
                retried = lost[anew.rows]  # on these triangles such a path ends so too
                path.go_on(retried, anew)
                lowest[retried], tangent[retried] = getattr(anew, place), anew.tangent
                settled[np.isin(rows, retried)] = move(fine, blocks, retried, path, FAR * elastic, lowest, tangent)
                is_coarse[rows[settled]] = False
                rows = self.checked(fine, blocks, rows[settled], lowest, tangent)

        on_finer(np.flatnonzero(path.turns), _turn, "lowest")
        path.turns &= ~is_far | (path.point[:, -1] - path.lowest[:, -1] > POLISHED)  # else it is level
        may_run = np.flatnonzero(path.outcome != PathEnd.TURNED)
        is_left = np.ones(len(blocks), dtype=bool)
        is_left[may_run[self.settled_runs(blocks[may_run], path.of(may_run), lowest[may_run])]] = False
        creeps = is_left & is_far & ~path.turns
        rows = np.flatnonzero(creeps & is_coarse)
        lowest[rows], tangent[rows] = path.point[rows], path.tangent[rows]  # as low, and nearer to where it is left
        on_finer(rows, _land, "point")
        self.found.split[blocks[creeps & is_coarse]] = self.coarse.springs.split
        status = np.where(creeps, BedStatus.CREEPS, BedStatus.RESTS)
        motion = _onward(tangent, lowest)
        motion *= np.where(dots(self.beds.load[blocks], motion) < 0.0, -1.0, 1.0)[:, None]  # some paths lead back
        self.found.put(blocks[is_left], status[is_left], lowest[is_left], motion[is_left])

    def followed(self, blocks: Ints, u: Floats, reduction: Floats, elastic: Floats, ends: Floats) -> Paths:
        """Follow paths; on finer triangles, or from a rest at less strength, where one ends before its block runs.

        That rest is put in place of where the path began, u (n, u) and λ (n,).
        """
        path = self.coarse.follow(blocks, u, reduction, elastic, ends)
        lost = np.flatnonzero(path.outcome == PathEnd.CORNER)
        if len(lost):
            path.go_on(lost, self.finer[0].follow(blocks[lost], u[lost], reduction[lost], elastic[lost], ends[lost]))
        for _ in range(_MOST_LOWERED):
            lost = np.flatnonzero(path.outcome >= PathEnd.BACK)
            turns = lost[path.turns[lost]]
            at, _ = self.coarse.settle(blocks[turns], path.lowest[turns], path.heading[turns], path.side[turns])
            path.lowest[turns] = np.where(np.isfinite(at[:, -1:]), at, path.lowest[turns])
            rest, lower = self.coarse.lower(blocks[lost], path.lowest[lost], elastic[lost])
            goes_on = np.isfinite(lower)
            if not goes_on.any():
                break
            lost, rest, lower = lost[goes_on], rest[goes_on], lower[goes_on]
            path.go_on(lost, self.coarse.follow(blocks[lost], rest, lower, elastic[lost], ends[lost]))
            u[lost], reduction[lost] = rest, lower
        return path

    def settled_runs(self, blocks: Ints, path: Paths, lowest: Floats) -> Bools:
        """Find the running states that paths settle to; return for which of them there is one."""
        settled, is_far = np.zeros(len(blocks), dtype=bool), path.outcome == PathEnd.FAR
        points = np.concatenate([np.where(is_far[:, None], path.point, lowest)[:, :-1], lowest[:, -1:]], axis=1)
        motion, least = _onward(path.tangent, points), np.exp(lowest[:, -1])
        slope = np.where(is_far & ~path.turns, np.abs(path.tangent[:, -1]), 0.0)
        for rows, bases in self.alike(blocks, self.gaps(blocks, points[:, :-1], np.minimum) < 0.0):
            nearest = _run(self.coarse.springs, blocks[rows], bases, motion[rows], points[rows])
            v, w, lam = _motions(bases, nearest.x)
            near = nearest.settled & (np.abs(lam / least[rows] - 1.0) <= POLISHED + _SETTLES * slope[rows])
            some = bases[0][near], bases[1][near]
            runs = self.running(blocks[rows[near]], some, v[near], _points(w, lam)[near])
            v, w, lam = _motions(some, runs.x)
            good = rows[near][runs.settled]
            settled[good] = True
            self.found.put(blocks[good], BedStatus.RUNS, _points(w, lam)[runs.settled], v[runs.settled])
        return settled


def _along_lines(line: Floats, normal: Floats) -> Bases:
    """Return the motions along lines (n, 3) of intersection of two planes, one with normal (n, 3), and all others."""
    bases, along = np.zeros((len(line), 6, 6)), units(line)
    bases[:, :3, 0], bases[:, :3, 1], bases[:, :3, 2] = along, normal, cross(along, normal)
    bases[:, 3:, 3:] = np.eye(3)
    return bases[:, :, :1], bases[:, :, 1:]


def _motions(bases: Bases, x: Floats) -> tuple[Floats, Floats, Floats]:
    """Return velocities v (n, u), displacements w (n, u) and λ (n,) of running states x."""
    free = bases[0].shape[2]
    return (bases[0] @ x[:, :free, None])[:, :, 0], (bases[1] @ x[:, free:-1, None])[:, :, 0], x[:, -1]


def _points(displacement: Floats, reduction: Floats) -> Floats:
    """Return displacements and ln λ, (n, u + 1); that of no strength is none."""
    return np.concatenate([displacement, np.log(np.maximum(reduction, TINY))[:, None]], axis=1)


def _onward(tangent: Floats, points: Floats) -> Floats:
    """Return how blocks move on (n, u): at a corner all sticks until all runs, and goes on as it was displaced."""
    return np.where(lengths(tangent[:, :-1])[:, None] < LEVEL, points[:, :-1], tangent[:, :-1])


def _change(slopes: Floats, out: Floats) -> Floats:
    """Return by what λ (n,) of states with slopes (n, u + 1, u + 1) changes with unbalanced forces (n, u)."""
    return solved(slopes, np.concatenate([-out, np.zeros((len(out), 1))], axis=1))[:, -1]


def _run(springs: BedSprings, blocks: Ints, bases: Bases, velocity: Floats, points: Floats) -> Roots:
    """Balance the forces of blocks that run, by Newton's method from velocities (n, u) and points (n, u + 1)."""
    free, size = bases[0].shape[2], springs.beds.load.shape[1]
    along, elastic = (
        (basis.transpose(0, 2, 1) @ at[:, :, None])[:, :, 0]
        for basis, at in zip(bases, (velocity, points[:, :-1]), strict=True)
    )
    start = np.concatenate([units(along), elastic, np.exp(points[:, -1:])], axis=1)

    def equations(rows: Ints, x: Floats) -> tuple[Floats, Floats, Floats]:
        some = bases[0][rows], bases[1][rows]
        v, w, lam = _motions(some, x)
        at = springs.unbalanced(blocks[rows], w, v, lam, running=True)
        slopes = np.concatenate([at.by_slip @ some[0], at.by_opening @ some[1]], axis=2)
        speed = np.concatenate([x[:, :free], np.zeros((len(x), size + 1 - free))], axis=1)
        off = 0.5 * ((speed * speed).sum(axis=1) - 1.0)
        # what wedges a block in may push far more than its load
        pushes = (np.abs(at.by_opening) @ np.abs(w)[:, :, None]).max(axis=(1, 2))
        small = np.maximum(NO_FORCE * np.maximum(1.0, np.abs(lam)), SPRING_ROUNDING * pushes)
        return np.concatenate([at.out, off[:, None]], axis=1), bordered(slopes, at.by_reduction, speed), small

    return solve_rows(equations, start, _RUNNING)


def _turn(
    fine: BedPath, blocks: Ints, rows: Ints, path: Paths, farthest: Floats, lowest: Floats, tangent: Floats
) -> Bools:
    """Move points to the least λ on turns of paths, on finer triangles; return which were moved.

    One that lies farther away, or much higher, is that of another path.
    """
    at, along = fine.settle(blocks[rows], lowest[rows], path.heading[rows], path.side[rows])
    good: Bools = (at[:, -1] < lowest[rows, -1] + _ANOTHER) & (lengths(at[:, :-1]) <= farthest[rows])
    lowest[rows[good]], tangent[rows[good]] = at[good], along[good]
    return good


def _land(
    fine: BedPath, blocks: Ints, rows: Ints, path: Paths, farthest: Floats, lowest: Floats, tangent: Floats
) -> Bools:
    """Move points of paths that creep to the farthest displacement, on finer triangles; return which were moved."""
    goal, start = farthest[rows], lowest[rows]
    start[:, :-1] = units(start[:, :-1])
    planes = np.concatenate([start[:, :-1], np.zeros((len(rows), 1))], axis=1)
    found = fine.on_planes(blocks[rows], planes, goal, start, _LANDING)
    good = rows[found.settled]
    lowest[good], tangent[good] = on_scale(found.x, goal)[found.settled], found.tangent[found.settled]
    return found.settled
