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

from collections.abc import Iterator, Sequence
from enum import IntEnum

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.core.records import dataclass
from slopekit.preie.one_block.bed_path import (
    COARSE,
    FAR,
    BedPath,
    Newton,
    PathEnd,
    Paths,
    lengths,
    solve_rows,
    solved,
)
from slopekit.preie.one_block.polygon_bed import Beds, BedSprings, PointForces
from slopekit.preie.tolerances import FINER_PRESSED, LEVEL, NO_FORCE, PARALLEL, POLISHED, ROUGHLY_SETTLED, SETTLED, TINY

#: Splits of the triangles on which limits are settled; the next where it changes one by more than `FINER_PRESSED`.
SPLITS = (3, 4)
_FLAT = 1e-3  # of ln λ: a path that ends so far above its least value may run at that
_SETTLES = 5.0  # times its slope: λ of a path that runs is as near to that of the running state
_FAR_OUT = 1e5  # elastic displacements: so far out along its motion it is asked whether a path comes down or up
_DEEP = 0.95  # of F by forces: below it paths may turn before they come down to the running state (4 of 328 wedges)
_RUNNING = Newton(40, shortest=0.05)  # to a running state
_MOST_LOWERED = 6  # times that a path goes on from a rest at less strength


class BedStatus(IntEnum):
    """How a block on its bed ends as its strength goes down."""

    PRESSED = 0  # it slides, pressed on the whole of each joint
    RUNS = 1  # it runs on the parts of its joints that are pressed
    RESTS = 2  # λ turns while the block is still at rest: its pressed part shrinks too fast from there
    CREEPS = 3  # it runs about an edge; the limit is that at `FAR` elastic displacements
    NO_REST = 4  # it rests at no strength


@dataclass(frozen=True, slots=True)
class Slides:
    """The slides of n blocks by their forces alone, where they are known.

    Attributes
    ----------
    reduction : (n,) λ = 1/F, or a guess of about the right size; a block is left alone where it is not a number
    velocity : (n, u) of unit length, without turning; touching : (m,) contacts that carry force
    """

    reduction: Floats
    velocity: Floats
    touching: Bools


@dataclass(frozen=True, slots=True)
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

    def carried(self, beds: Beds) -> PointForces:
        """Return what the points of its bed carry at the limit of a single block."""
        slides = self.status[0] in (BedStatus.PRESSED, BedStatus.RUNS)
        opening = self.displacement[0]
        slip = self.velocity[0] if slides else opening
        return BedSprings(beds, int(self.split[0])).carried(opening, slip, float(self.reduction[0]), slides)

    @classmethod
    def none(cls, count: int, unknowns: int) -> "BedLimits":
        """Return records of blocks that nothing is known of."""
        return cls(
            status=np.full(count, BedStatus.NO_REST, dtype=np.int64),
            reduction=np.full(count, np.nan),
            displacement=np.zeros((count, unknowns)),
            velocity=np.zeros((count, unknowns)),
            early=np.full(count, np.nan),
            change=np.zeros(count),
            split=np.full(count, SPLITS[0]),
            steps=np.zeros(count, dtype=np.int64),
        )


def bed_limits(beds: Beds, slides: Slides, splits: tuple[int, ...] = SPLITS) -> BedLimits:
    """Return the limits of some blocks on their beds.

    Parameters
    ----------
    splits : of the triangles on which limits are settled; the next where it changes one by more than `FINER_PRESSED`
    """
    found = BedLimits.none(*beds.load.shape)
    coarse = BedPath(BedSprings(beds, COARSE), ROUGHLY_SETTLED)
    finer = [BedPath(BedSprings(beds, split)) for split in splits]
    ends = np.full(len(beds.load), np.inf)
    if not beds.laws:
        _slide_or_run(coarse.springs, finer, slides, found, ends)
    left = np.flatnonzero((found.status == BedStatus.NO_REST) & (slides.reduction > 0.0))
    if len(left):
        _along_paths(coarse, finer, left, slides.reduction[left], ends[left], found)
    return found


# -- stages 1 and 2 ----------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Bases:
    """Motions that keep some contacts of blocks closed, free (n, u, d), and the others, rest (n, u, u - d)."""

    free: Floats
    rest: Floats


def _slide_or_run(coarse: BedSprings, finer: Sequence[BedPath], slides: Slides, found: BedLimits, ends: Floats) -> None:
    """Settle the blocks that slide on all of their contacts, and those whose path ends at a running state.

    Notes in `ends` ln λ of the running states to which the paths of others rise.
    """
    beds = coarse.beds
    every = np.logical_and.reduceat(slides.touching, beds.contact[:-1])
    blocks = np.flatnonzero(every & (slides.reduction > 0.0))
    for rows, bases in _alike(beds, blocks, slides.touching):
        _slide(coarse, finer, blocks[rows], bases, slides, found, ends)


def _alike(beds: Beds, blocks: Ints, closed: Bools) -> Iterator[tuple[Ints, _Bases]]:
    """Yield blocks (their places) with as many motions that keep the closed contacts (m,) closed, and these motions.

    Blocks that nothing closed holds, or that have no such motion, are left out.
    """
    if not len(blocks):
        return
    unknowns = beds.rows.shape[2]
    opening = beds.rows[:, :3] * closed[:, None, None]
    most = max(int(np.diff(beds.contact).max()), unknowns // 3)
    each = beds.contact[blocks, None] + np.arange(most)
    inside = each < beds.contact[blocks + 1, None]
    stacked = (opening[np.where(inside, each, 0)] * inside[:, :, None, None]).reshape(len(blocks), -1, unknowns)
    _, sizes, basis = np.linalg.svd(stacked, full_matrices=False)
    rank = (sizes > PARALLEL * sizes[:, :1]).sum(axis=1)
    for size in range(1, unknowns):
        rows = np.flatnonzero(rank == size)
        if len(rows):
            yield rows, _Bases(basis[rows, size:].transpose(0, 2, 1), basis[rows, :size].transpose(0, 2, 1))


def _slide(
    coarse: BedSprings,
    finer: Sequence[BedPath],
    blocks: Ints,
    bases: _Bases,
    slides: Slides,
    found: BedLimits,
    ends: Floats,
) -> None:
    """Settle blocks with as many free motions each that slide, or run."""
    reduction, velocity = slides.reduction[blocks], slides.velocity[blocks]
    elastic, off, is_pressed = _pressed_slides(coarse, blocks, bases, reduction, velocity)
    whole = is_pressed & (off < SETTLED)
    displacement = (bases.rest @ elastic[:, :, None])[:, :, 0]
    _record(found, blocks[whole], BedStatus.PRESSED, reduction[whole], displacement[whole], velocity[whole])
    rows = np.flatnonzero(~whole)
    if not len(rows):
        return
    some = _Bases(bases.free[rows], bases.rest[rows])
    runs = _running(coarse, finer, blocks[rows], some, (velocity[rows], displacement[rows], reduction[rows]), found)
    good = runs.settled & _all_closed(coarse.beds, blocks[rows], runs.displacement) & (runs.reduction > 0.0)
    rising = good & runs.rises
    ends[blocks[rows[rising]]] = np.log(runs.reduction[rising])
    # the bed allows no less than the forces do, or the path comes down to this state
    never = runs.reduction <= reduction[rows] * (1.0 + SETTLED)
    good &= never | (~runs.rises & (runs.reduction < reduction[rows] / _DEEP))
    done = blocks[rows[good]]
    _record(found, done, BedStatus.RUNS, runs.reduction[good], runs.displacement[good], runs.velocity[good])


def _record(
    found: BedLimits, blocks: Ints, status: BedStatus | Ints, reduction: Floats, displacement: Floats, velocity: Floats
) -> None:
    found.status[blocks], found.reduction[blocks] = status, reduction
    found.displacement[blocks] = displacement
    found.velocity[blocks] = velocity / lengths(velocity)[:, None]


def _pressed_slides(
    springs: BedSprings, blocks: Ints, bases: _Bases, reduction: Floats, velocity: Floats
) -> tuple[Floats, Floats, Bools]:
    """Solve for linear pressures on the whole of each joint under slides at λ (n,), along velocities (n, u).

    Returns
    -------
    elastic displacements (n, e) by the motions that press, what is out of balance (n,), and whether no corner opens
    """
    beds = springs.beds
    which = np.concatenate([np.arange(beds.contact[k], beds.contact[k + 1]) for k in blocks]) if len(blocks) else blocks
    number = np.repeat(np.arange(len(blocks)), np.diff(beds.contact)[blocks])
    first = np.cumsum([0, *np.diff(beds.contact)[blocks][:-1]])
    rows, whole = beds.rows[which].reshape(len(which), 3, 3, -1), springs.whole[which]
    line, lam = beds.line[which], reduction[number]
    speed = (rows[:, 1:] @ velocity[number][:, None, :, None])[:, :, 0, 0]  # of slip, alike all over a contact
    way = speed / np.maximum(lengths(speed), NO_FORCE)[:, None]
    drag = np.einsum("mj,mjku->mku", way, rows[:, 1:])  # (m, 3, u) what a unit shear by 1, ξ and η does
    push = rows[:, 0] - (lam * line[:, 2])[:, None, None] * drag
    matrix = -np.add.reduceat(push.transpose(0, 2, 1) @ (whole @ rows[:, 0]), first)
    out = beds.load[blocks] - np.add.reduceat((lam * line[:, 1])[:, None] * (whole[:, :1] @ drag)[:, 0], first)
    if beds.bolt_capacity.shape[1]:
        pulls, _, _ = springs.pulls(blocks, velocity, reduction, True)
        out = out + (pulls[:, None] @ beds.bolt_rows[blocks])[:, 0]
    rest = bases.rest.transpose(0, 2, 1)
    elastic = solved(rest @ matrix @ bases.rest, -(rest @ out[:, :, None])[:, :, 0])
    opening = (bases.rest @ elastic[:, :, None])[:, :, 0]
    off = np.abs(out + (matrix @ opening[:, :, None])[:, :, 0]).max(axis=1)
    return elastic, off, _widest(beds, blocks, opening) < NO_FORCE


def corner_gaps(beds: Beds, blocks: Ints, opening: Floats) -> Floats:
    """Return the gaps (q,) at all corners of the beds, with openings (n, u) of some of the blocks."""
    every = np.zeros_like(beds.load)
    every[blocks] = opening
    return beds.motions(every, 1)[:, 0]


def _widest(beds: Beds, blocks: Ints, opening: Floats) -> Floats:
    """Return the widest gap (n,) at a corner of each of some blocks; below zero where all of it is pressed."""
    gaps = corner_gaps(beds, blocks, opening)
    widest: Floats = np.maximum.reduceat(gaps, beds.corner[beds.contact[:-1]])[blocks]
    return widest


def _all_closed(beds: Beds, blocks: Ints, opening: Floats) -> Bools:
    """Return which of some blocks press on a part of each of their contacts."""
    closest = np.minimum.reduceat(corner_gaps(beds, blocks, opening), beds.corner[:-1])
    pressed: Bools = np.maximum.reduceat(closest, beds.contact[:-1])[blocks] < 0.0
    return pressed


@dataclass(frozen=True, slots=True)
class _Running:
    """Running states of n blocks: which were found, w (n, u), v (n, u), λ (n,), whether paths rise to it far out."""

    settled: Bools
    displacement: Floats
    velocity: Floats
    reduction: Floats
    rises: Bools


def _running(
    coarse: BedSprings,
    finer: Sequence[BedPath],
    blocks: Ints,
    bases: _Bases,
    start: tuple[Floats, Floats, Floats],
    found: BedLimits,
) -> _Running:
    """Find the running states of blocks with as many free motions each.

    Where there is one, all of a contact slips one way, and the coarsest triangles are exact for straight laws.

    Parameters
    ----------
    start : motions and displacements (n, u), λ (n,)
    """
    if bases.free.shape[2] == 1 and not coarse.beds.laws:
        return _run(coarse, blocks, bases, start)[0]
    state, change = _run(finer[0].springs, blocks, bases, start, finer[0].springs.finer())
    found.change[blocks] = change
    rows = np.flatnonzero(state.settled & (change > FINER_PRESSED))
    if len(finer) == 1 or not len(rows):
        return state
    springs, some = finer[1].springs, _Bases(bases.free[rows], bases.rest[rows])
    again = state.velocity[rows], state.displacement[rows], state.reduction[rows]
    better, change = _run(springs, blocks[rows], some, again, springs.finer())
    good = rows[better.settled]
    for name in ("displacement", "velocity", "reduction", "rises"):
        getattr(state, name)[good] = getattr(better, name)[better.settled]
    found.change[blocks[good]], found.split[blocks[good]] = change[better.settled], springs.split
    return state


def _run(
    springs: BedSprings,
    blocks: Ints,
    bases: _Bases,
    start: tuple[Floats, Floats, Floats],
    finer: BedSprings | None = None,
) -> tuple[_Running, Floats]:
    """Balance the forces of blocks that run, by Newton's method; and say what finer triangles would change."""
    count, (free, size) = len(blocks), (bases.free.shape[2], springs.beds.load.shape[1])
    along = (bases.free.transpose(0, 2, 1) @ start[0][:, :, None])[:, :, 0]
    elastic = (bases.rest.transpose(0, 2, 1) @ start[1][:, :, None])[:, :, 0]
    first = np.concatenate([along / np.maximum(lengths(along), TINY)[:, None], elastic, start[2][:, None]], axis=1)

    def motions(rows: Ints, x: Floats) -> tuple[Floats, Floats]:
        return (bases.free[rows] @ x[:, :free, None])[:, :, 0], (bases.rest[rows] @ x[:, free:size, None])[:, :, 0]

    def equations(rows: Ints, x: Floats) -> tuple[Floats, Floats, Floats]:
        v, w = motions(rows, x)
        at = springs.unbalanced(blocks[rows], w, v, x[:, -1], running=True)
        slopes = np.zeros((len(x), size + 1, size + 1))
        slopes[:, :size, :free] = at.by_slip @ bases.free[rows]
        slopes[:, :size, free:size] = at.by_opening @ bases.rest[rows]
        slopes[:, :size, size] = at.by_reduction
        slopes[:, size, :free] = x[:, :free]
        off = 0.5 * (np.einsum("nk,nk->n", x[:, :free], x[:, :free]) - 1.0)
        return np.concatenate([at.out, off[:, None]], axis=1), slopes, NO_FORCE * np.maximum(1.0, np.abs(x[:, -1]))

    found = solve_rows(equations, first, _RUNNING)
    v, w = motions(np.arange(count), found.x)
    reduction = found.x[:, -1]

    def change_by(out: Floats) -> Floats:
        change: Floats = solved(found.slopes, -np.concatenate([out, np.zeros((count, 1))], axis=1))[:, -1]
        return change

    far = _FAR_OUT * np.maximum(springs.first[blocks], lengths(w))
    at_far = springs.unbalanced(blocks, w, far[:, None] * v + w, reduction, running=True)
    change = np.zeros(count)
    if finer is not None:
        out = finer.unbalanced(blocks, w, v, reduction, running=True).out
        change = np.abs(change_by(out) / np.maximum(np.abs(reduction), TINY))
    return _Running(found.settled, w, v, reduction, ~(change_by(at_far.out) > 0.0)), change


# -- stages 3 and 4 ----------------------------------------------------------------------------------------------


def _along_paths(
    coarse: BedPath, finer: Sequence[BedPath], blocks: Ints, guess: Floats, ends: Floats, found: BedLimits
) -> None:
    """Follow the paths of blocks to their least λ."""
    u, reduction = coarse.start(blocks, guess)
    rests = np.isfinite(reduction)
    blocks, u, reduction, ends = blocks[rests], u[rests], reduction[rests], ends[rests]
    if not len(blocks):
        return
    path = _followed(coarse, finer[0], blocks, u, reduction, ends)
    found.early[blocks], found.steps[blocks] = np.exp(path.early), path.steps
    lowest, tangent = path.lowest.copy(), path.tangent.copy()
    turns = np.flatnonzero(path.turns)
    for fine in (coarse, *finer):
        at, along = fine.settle(blocks[turns], lowest[turns], path.heading[turns], path.curvature[turns])
        known = np.isfinite(at[:, -1])
        lowest[turns[known]], tangent[turns[known]] = at[known], along[known]
        if fine is coarse:
            continue
        turns = _too_coarse(fine.springs, blocks, turns, lowest, tangent, found)
    ends_at = np.where(path.outcome == PathEnd.FAR, path.ln, lowest[:, -1])
    may_run = np.flatnonzero((path.outcome != PathEnd.TURNED) & (ends_at - lowest[:, -1] < _FLAT))
    runs = may_run[_settled_runs(coarse.springs, finer, blocks[may_run], path, lowest, may_run, found)]
    creeps = np.setdiff1d(np.flatnonzero((path.outcome == PathEnd.FAR) & ~path.turns), runs)
    rows = creeps
    for fine in finer:
        _land(fine, blocks, rows, lengths(u), lowest, tangent)
        rows = _too_coarse(fine.springs, blocks, rows, lowest, tangent, found)
    status = np.full(len(blocks), BedStatus.RESTS)
    status[creeps] = BedStatus.CREEPS
    motion = np.where(lengths(tangent[:, :-1])[:, None] < LEVEL, lowest[:, :-1], tangent[:, :-1])
    rows = np.setdiff1d(np.arange(len(blocks)), runs)
    _record(found, blocks[rows], status[rows], np.exp(lowest[rows, -1]), lowest[rows, :-1], motion[rows])


def _too_coarse(
    springs: BedSprings, blocks: Ints, rows: Ints, points: Floats, tangent: Floats, found: BedLimits
) -> Ints:
    """Note what finer triangles would change at points of some paths; return those where that matters."""
    if not len(rows):
        return rows
    found.split[blocks[rows]] = springs.split
    found.change[blocks[rows]] = _changes(springs, blocks[rows], points[rows], tangent[rows])
    return rows[found.change[blocks[rows]] > FINER_PRESSED]


def _followed(coarse: BedPath, fine: BedPath, blocks: Ints, u: Floats, reduction: Floats, ends: Floats) -> Paths:
    """Follow paths; on finer triangles, or from a rest at less strength, where one ends before its block runs."""
    elastic = lengths(u)
    path = coarse.follow(blocks, u, reduction, elastic, ends)
    lost = np.flatnonzero(path.outcome == PathEnd.CORNER)
    if len(lost):
        path.go_on(lost, fine.follow(blocks[lost], u[lost], reduction[lost], elastic[lost], ends[lost]))
    lost = np.flatnonzero(path.outcome >= PathEnd.BACK)
    for _ in range(_MOST_LOWERED):
        at = path.lowest[lost]
        rest, lower = coarse.lower(blocks[lost], at[:, :-1], at[:, -1], elastic[lost])
        goes_on = np.isfinite(lower)
        lost, rest, lower = lost[goes_on], rest[goes_on], lower[goes_on]
        if not len(lost):
            break
        path.go_on(lost, coarse.follow(blocks[lost], rest, lower, elastic[lost], ends[lost]))
        lost = lost[path.outcome[lost] >= PathEnd.BACK]
    return path


def _settled_runs(
    coarse: BedSprings,
    finer: Sequence[BedPath],
    blocks: Ints,
    path: Paths,
    lowest: Floats,
    rows: Ints,
    found: BedLimits,
) -> Bools:
    """Find the running states that paths settle to; return for which of them there is one."""
    beds, settled = coarse.beds, np.zeros(len(rows), dtype=bool)
    is_far, least = path.outcome[rows] == PathEnd.FAR, np.exp(lowest[rows, -1])
    u = np.where(is_far[:, None], path.u[rows], lowest[rows, :-1])
    # at a corner all sticks until all runs: as it was displaced it goes on
    tangent = path.tangent[rows]
    motion = np.where(lengths(tangent[:, :-1])[:, None] < LEVEL, u, tangent[:, :-1])
    slope = np.where(is_far & ~path.turns[rows], np.abs(tangent[:, -1]), 0.0)
    closest = np.minimum.reduceat(corner_gaps(beds, blocks, u), beds.corner[:-1])
    for those, bases in _alike(beds, blocks, closest < 0.0):
        nearest, _ = _run(coarse, blocks[those], bases, (motion[those], u[those], least[those]))
        near = np.abs(nearest.reduction / least[those] - 1.0) <= POLISHED + _SETTLES * slope[those]
        near &= nearest.settled
        those, bases = those[near], _Bases(bases.free[near], bases.rest[near])
        start = nearest.velocity[near], nearest.displacement[near], nearest.reduction[near]
        runs = _running(coarse, finer, blocks[those], bases, start, found)
        good = runs.settled
        settled[those[good]], done = True, blocks[those[good]]
        _record(found, done, BedStatus.RUNS, runs.reduction[good], runs.displacement[good], runs.velocity[good])
    return settled


def _land(fine: BedPath, blocks: Ints, rows: Ints, elastic: Floats, lowest: Floats, tangent: Floats) -> None:
    """Move points of paths that creep to `FAR` elastic displacements, on finer triangles."""
    if not len(rows):
        return
    u, goal = lowest[rows, :-1], FAR * elastic[rows]
    way = u / lengths(u)[:, None]
    planes = np.concatenate([way, np.zeros((len(rows), 1))], axis=1)
    start = np.concatenate([way, lowest[rows, -1:]], axis=1)
    found = fine.on_planes(blocks[rows], planes, np.ones(len(rows)), goal, start)
    good = rows[found.settled]
    lowest[good, :-1] = found.x[found.settled, :-1] * goal[found.settled, None]
    lowest[good, -1], tangent[good] = found.x[found.settled, -1], found.tangent[found.settled]


def _changes(springs: BedSprings, blocks: Ints, points: Floats, tangent: Floats) -> Floats:
    """Return what finer triangles would do to ln λ (n,) at points u and ln λ (n, u + 1) of paths, to first order."""
    u, reduction, size = points[:, :-1], np.exp(points[:, -1]), lengths(points[:, :-1])
    at = springs.unbalanced(blocks, u, u, reduction)
    slopes = np.empty((len(blocks), u.shape[1] + 1, u.shape[1] + 1))
    slopes[:, :-1, :-1] = (at.by_opening + at.by_slip) * size[:, None, None]
    slopes[:, :-1, -1] = at.by_reduction * reduction[:, None]
    slopes[:, -1] = tangent
    out = springs.finer().unbalanced(blocks, u, u, reduction).out
    change: Floats = np.abs(solved(slopes, np.concatenate([out, np.zeros((len(out), 1))], axis=1))[:, -1])
    return change
