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

from dataclasses import replace
from enum import IntEnum

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.core.records import dataclass
from slopekit.preie.one_block.bed_path import COARSE, FAR, BedPath, Path, PathEnd, Roots, lengths, solve_rows, solved
from slopekit.preie.one_block.polygon_bed import Beds, BedSprings
from slopekit.preie.tolerances import (
    EQUILIBRIUM,
    FINER_PRESSED,
    NO_FORCE,
    PARALLEL,
    POLISHED,
    ROUNDING,
    SETTLED,
)

#: Splits of the triangles on which limits are settled; the next where it changes one by more than `FINER_PRESSED`.
SPLITS = (3, 4)
_SETTLES = 5.0  # times its slope: λ of a path that runs is as near to that of the running state
_FAR_OUT = 1e5  # elastic displacements: so far out along its motion it is asked whether a path comes down or up
_DEEP = 0.95  # of F by forces: below it paths may turn before they come down to the running state (4 of 328 wedges)
_MOST_RUNNING = 30  # steps of Newton's method to a running state
_MOST_LOWERED = 6  # times that a path goes on from a rest at less strength


class BedStatus(IntEnum):
    """How a block on its bed ends as its strength goes down."""

    PRESSED = 0  # it slides, pressed on the whole of each joint
    RUNS = 1  # it runs on the parts of its joints that are pressed
    RESTS = 2  # λ turns while the block is still at rest: its pressed part shrinks too fast from there
    CREEPS = 3  # it runs about an edge; the limit is that at `FAR` elastic displacements
    NO_REST = 4  # it rests at no strength
    LOST = 5  # no step led on: the least λ found so far


@dataclass(frozen=True, slots=True)
class Slides:
    """The slides of n blocks by their forces alone, where they are known.

    Attributes
    ----------
    reduction : (n,) λ = 1/F; a guess of about the right size where nothing slides
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
    residual : (n,) unbalanced force in parts of the load; steps : (n,) along the path
    """

    status: Ints
    reduction: Floats
    displacement: Floats
    velocity: Floats
    early: Floats
    change: Floats
    residual: Floats
    steps: Ints

    @classmethod
    def none(cls, count: int, unknowns: int) -> "BedLimits":
        """Return records of blocks that nothing is known of."""
        nan, zero = np.full(count, np.nan), np.zeros(count)
        return cls(
            np.full(count, BedStatus.NO_REST, dtype=np.int64), nan, np.zeros((count, unknowns)),
            np.zeros((count, unknowns)), nan.copy(), zero, zero.copy(), np.zeros(count, dtype=np.int64),
        )  # fmt: skip


def bed_limits(beds: Beds, slides: Slides, splits: tuple[int, ...] = SPLITS) -> BedLimits:
    """Return the limits of some blocks on their beds."""
    found = BedLimits.none(*beds.load.shape)
    coarse = BedPath(BedSprings(beds, COARSE))
    finer = [BedPath(BedSprings(beds, split)) for split in splits]
    left, ends = _slide_or_run(coarse.springs, finer[0].springs, slides, found)
    _along_paths(coarse, finer, left, slides.reduction[left], ends, found)
    return found


# -- stages 1 and 2 ----------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Bases:
    """Motions that keep some contacts of blocks closed, free (n, u, d), and the others, rest (n, u, u - d)."""

    free: Floats
    rest: Floats


def _bases(beds: Beds, blocks: Ints, closed: Bools) -> tuple[_Bases, Ints]:
    """Return bases (n, u, u) of the motions of blocks, those that close the closed contacts (m,) first, and how many.

    The singular vectors of the openings of each contact by 1, ξ and η.
    """
    unknowns = beds.rows.shape[2]
    opening = beds.rows[:, :3] * closed[:, None, None]
    most = int(np.diff(beds.contact).max())
    each = beds.contact[blocks, None] + np.arange(most)
    inside = each < beds.contact[blocks + 1, None]
    stacked = opening[np.where(inside, each, 0)] * inside[:, :, None, None]
    _, sizes, basis = np.linalg.svd(stacked.reshape(len(blocks), -1, unknowns), full_matrices=True)
    padded = np.zeros((len(blocks), unknowns))
    padded[:, : sizes.shape[1]] = sizes
    rank = (padded > PARALLEL * padded[:, :1]).sum(axis=1)
    return _Bases(basis.transpose(0, 2, 1), basis), rank


def _slide_or_run(coarse: BedSprings, fine: BedSprings, slides: Slides, found: BedLimits) -> tuple[Ints, Floats]:
    """Settle the blocks whose path ends at a slide or a running state; return the others, with ln λ of their ends."""
    beds = coarse.beds
    count = len(beds.load)
    ends = np.full(count, np.inf)
    if beds.laws:
        return np.arange(count), ends
    slips = slides.touching | False
    every = np.logical_and.reduceat(slips, beds.contact[:-1])
    blocks = np.flatnonzero(every & (slides.reduction > 0.0))
    basis, rank = _bases(beds, blocks, slides.touching)
    for size in np.unique(rank):
        rows = np.flatnonzero(rank == size)
        if size == beds.load.shape[1]:
            continue
        bases = _Bases(basis.free[rows][:, :, size:], basis.free[rows][:, :, :size])
        _run(coarse if size == beds.load.shape[1] - 1 else fine, blocks[rows], bases, slides, found, ends)
    settled = found.status < BedStatus.NO_REST
    left = np.flatnonzero(~settled)
    return left, ends[left]


def _run(
    springs: BedSprings, blocks: Ints, bases: _Bases, slides: Slides, found: BedLimits, ends: Floats
) -> None:  # fmt: skip
    """Settle blocks that slide or run with as many free motions each."""
    beds = springs.beds
    reduction, velocity = slides.reduction[blocks], slides.velocity[blocks]
    along = (bases.free.transpose(0, 2, 1) @ velocity[:, :, None])[:, :, 0]
    elastic, off, is_pressed = _pressed_slides(springs, blocks, bases, reduction, velocity)
    slides_whole = is_pressed & (off < np.sqrt(SETTLED))
    whole = blocks[slides_whole]
    displacement = (bases.rest @ elastic[:, :, None])[:, :, 0]
    _record(found, whole, BedStatus.PRESSED, reduction[slides_whole], displacement[slides_whole], velocity[slides_whole])
    found.residual[whole] = off[slides_whole]
    rows = np.flatnonzero(~slides_whole)
    if not len(rows):
        return
    some = _Bases(bases.free[rows], bases.rest[rows])
    runs, w, v, lam = running(springs, blocks[rows], some, along[rows], elastic[rows], reduction[rows])
    closed = _all_closed(beds, blocks[rows], w)
    good = runs.settled & closed & (lam > 0.0)
    rises = _rises(springs, blocks[rows], some, runs, w, v, lam)
    never = lam <= reduction[rows] * (1.0 + POLISHED**2)  # the bed allows no less than the forces do
    ends[blocks[rows[good]]] = np.log(lam[good])
    good &= (~rises & (lam < reduction[rows] / _DEEP)) | never
    _record(found, blocks[rows[good]], BedStatus.RUNS, lam[good], w[good], v[good])


def _record(
    found: BedLimits, blocks: Ints, status: BedStatus, reduction: Floats, displacement: Floats, velocity: Floats
) -> None:  # fmt: skip
    found.status[blocks], found.reduction[blocks] = status, reduction
    found.displacement[blocks] = displacement
    found.velocity[blocks] = velocity / lengths(velocity)[:, None]


def _pressed_slides(
    springs: BedSprings, blocks: Ints, bases: _Bases, reduction: Floats, velocity: Floats
) -> tuple[Floats, Floats, Bools]:
    """Solve for linear pressures on the whole of each joint under slides at λ (n,), along velocities (n, u).

    Returns
    -------
    elastic displacements (n, e) by the motions that press, what is left out of balance (n,), and whether no corner opens
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


def _corner_gaps(beds: Beds, blocks: Ints, opening: Floats) -> Floats:
    """Return the gaps (q,) at all corners of the beds, with openings (n, u) of some of the blocks."""
    every = np.zeros_like(beds.load)
    every[blocks] = opening
    gaps = beds.gaps(np.repeat(np.arange(len(every)), np.diff(beds.contact)), every)
    contact = np.repeat(np.arange(len(gaps)), np.diff(beds.corner))
    at: Floats = gaps[contact, 0] + (gaps[contact, 1:] * beds.plane).sum(axis=1)
    return at


def _widest(beds: Beds, blocks: Ints, opening: Floats) -> Floats:
    """Return the widest gap (n,) at a corner of each of some blocks; below zero where all of it is pressed."""
    gaps = _corner_gaps(beds, blocks, opening)
    widest: Floats = np.maximum.reduceat(gaps, beds.corner[beds.contact[:-1]])[blocks]
    return widest


def _all_closed(beds: Beds, blocks: Ints, opening: Floats) -> Bools:
    """Return which of some blocks press on a part of each of their contacts."""
    closest = np.minimum.reduceat(_corner_gaps(beds, blocks, opening), beds.corner[:-1])
    pressed: Bools = np.maximum.reduceat(closest, beds.contact[:-1])[blocks] < 0.0
    return pressed


def running(
    springs: BedSprings, blocks: Ints, bases: _Bases, along: Floats, elastic: Floats, reduction: Floats
) -> tuple[Roots, Floats, Floats, Floats]:
    """Balance the forces of blocks that run, by Newton's method.

    Parameters
    ----------
    bases : with as many free motions each; along (n, d), elastic (n, u - d), reduction (n,) : where to start

    Returns
    -------
    what Newton's method found, displacements w (n, u), motions v (n, u), λ (n,)
    """
    free, size = bases.free.shape[2], springs.beds.load.shape[1]
    start = np.concatenate([along / lengths(along)[:, None], elastic, reduction[:, None]], axis=1)

    def equations(rows: Ints, x: Floats) -> tuple[Floats, Floats, Floats]:
        moves, presses = bases.free[rows], bases.rest[rows]
        v, w = (moves @ x[:, :free, None])[:, :, 0], (presses @ x[:, free:size, None])[:, :, 0]
        at = springs.unbalanced(blocks[rows], w, v, x[:, -1], running=True)
        slopes = np.zeros((len(x), size + 1, size + 1))
        slopes[:, :size, :free] = at.by_slip @ moves
        slopes[:, :size, free:size] = at.by_opening @ presses
        slopes[:, :size, size] = at.by_reduction
        slopes[:, size, :free] = x[:, :free]
        off = 0.5 * (np.einsum("nk,nk->n", x[:, :free], x[:, :free]) - 1.0)
        small = 100.0 * ROUNDING * np.maximum(1.0, np.abs(x[:, -1]))
        return np.concatenate([at.out, off[:, None]], axis=1), slopes, small

    found = solve_rows(equations, start, _MOST_RUNNING, damped=True)
    v = (bases.free @ found.x[:, :free, None])[:, :, 0]
    w = (bases.rest @ found.x[:, free:size, None])[:, :, 0]
    return found, w, v, found.x[:, -1]


def _rises(
    springs: BedSprings, blocks: Ints, bases: _Bases, runs: Roots, w: Floats, v: Floats, reduction: Floats
) -> Bools:
    """Return for which blocks λ rises to that of the running state far out: a < 0 in λ(R) = λ_T + a / R."""
    far = _FAR_OUT * np.maximum(springs.first[blocks], lengths(w))
    out = springs.unbalanced(blocks, w, far[:, None] * v + w, reduction, running=True).out
    change = solved(runs.slopes, -np.concatenate([out, np.zeros((len(out), 1))], axis=1))
    rises: Bools = ~(change[:, -1] * far > 0.0)
    return rises


# -- stages 3 and 4 ----------------------------------------------------------------------------------------------


def _along_paths(
    coarse: BedPath, finer: list[BedPath], blocks: Ints, guess: Floats, ends: Floats, found: BedLimits
) -> None:  # fmt: skip
    """Follow the paths of blocks to their least λ."""
    u, reduction = coarse.start(blocks, guess)
    rests = np.isfinite(reduction)
    blocks, u, reduction, ends = blocks[rests], u[rests], reduction[rests], ends[rests]
    if not len(blocks):
        return
    path = _followed(coarse, finer[0], blocks, u, reduction, ends)
    found.early[blocks], found.steps[blocks] = np.exp(path.early), path.steps
    unknowns = u.shape[1]
    lowest, heading, curvature = path.lowest.copy(), path.heading.copy(), path.curvature
    tangent = path.end.tangent.copy()
    status = np.where(path.turns, BedStatus.RESTS, np.where(path.outcome == PathEnd.FAR, BedStatus.CREEPS, BedStatus.LOST))
    runs = np.flatnonzero((path.outcome == PathEnd.FAR) & ~path.turns)
    settled = _settled_runs(finer[0].springs, blocks[runs], path, runs, found)
    status[runs[settled]] = BedStatus.RUNS
    for number, fine in enumerate(finer):
        rows = np.flatnonzero(status == BedStatus.RESTS)
        if number:
            rows = rows[found.change[blocks[rows]] > FINER_PRESSED]
        at, tan, known = fine.settle(blocks[rows], lowest[rows], heading[rows], curvature[rows])
        lowest[rows[known]], tangent[rows[known]] = at[known], tan[known]
        status[rows[~known]] = np.where(number, status[rows[~known]], BedStatus.LOST)
        creeps = np.flatnonzero(status == BedStatus.CREEPS)
        if number:
            creeps = creeps[found.change[blocks[creeps]] > FINER_PRESSED]
        _land(fine, blocks, creeps, lowest, tangent)
        rows = np.concatenate([rows, creeps])
        if not len(rows):
            break
        finest = BedSprings(fine.springs.beds, SPLITS[0] + number + 1)
        _changes(fine.springs, finest, blocks[rows], lowest[rows], tangent[rows], found)
    rows = np.flatnonzero(status != BedStatus.RUNS)
    motion = tangent[:, :-1] + (lengths(tangent[:, :-1]) == 0.0)[:, None] * lowest[:, :unknowns]
    for each in (BedStatus.RESTS, BedStatus.CREEPS, BedStatus.LOST):
        those = rows[status[rows] == each]
        _record(found, blocks[those], each, np.exp(lowest[those, -1]), lowest[those, :-1], motion[those])


def _followed(
    coarse: BedPath, fine: BedPath, blocks: Ints, u: Floats, reduction: Floats, ends: Floats
) -> Path:  # fmt: skip
    """Follow paths; on finer triangles, or from a rest at less strength, where one ends before its block runs."""
    path = coarse.follow(blocks, u, reduction, ends)
    lost = np.flatnonzero(path.outcome == PathEnd.CORNER)
    if len(lost):
        path = _joined(path, lost, fine.follow(blocks[lost], u[lost], reduction[lost], ends[lost]))
    lost = np.flatnonzero(path.outcome >= PathEnd.BACK)
    for _ in range(_MOST_LOWERED):
        at = path.lowest[lost]
        rest, lower = coarse.lower(blocks[lost], at[:, :-1], at[:, -1])
        goes_on = np.isfinite(lower)
        lost, rest, lower = lost[goes_on], rest[goes_on], lower[goes_on]
        if not len(lost):
            break
        onward = coarse.follow(blocks[lost], rest, lower, ends[lost])
        path = _joined(path, lost, onward)
        lost = lost[onward.outcome >= PathEnd.BACK]
    return path


def _joined(path: Path, rows: Ints, onward: Path) -> Path:
    """Return paths of which some rows went on."""
    fields = {}
    for name in ("lowest", "turns", "heading", "curvature", "outcome"):
        values = getattr(path, name).copy()
        values[rows] = getattr(onward, name)
        fields[name] = values
    early, steps = path.early.copy(), path.steps.copy()
    early[rows] = np.minimum(early[rows], onward.early)
    steps[rows] += onward.steps
    end = []
    for name in ("displacement", "log_reduction", "tangent"):
        values = getattr(path.end, name).copy()
        values[rows] = getattr(onward.end, name)
        end.append(values)
    return replace(path, end=type(path.end)(*end), early=early, steps=steps, **fields)


def _settled_runs(springs: BedSprings, blocks: Ints, path: Path, rows: Ints, found: BedLimits) -> Bools:
    """Find the running states that paths settle to; return which of them were found."""
    beds, end, settled = springs.beds, path.end, np.zeros(len(rows), dtype=bool)
    if not len(rows):
        return settled
    u, motion = end.displacement[rows], end.tangent[rows, :-1]
    closest = np.minimum.reduceat(_corner_gaps(beds, blocks, u), beds.corner[:-1])
    basis, rank = _bases(beds, blocks, closest < 0.0)
    reduction, slope = np.exp(end.log_reduction[rows]), np.abs(end.tangent[rows, -1])
    unknowns = u.shape[1]
    for size in np.unique(rank):
        those = np.flatnonzero(rank == size)
        if size in (0, unknowns):
            continue
        bases = _Bases(basis.free[those][:, :, size:], basis.free[those][:, :, :size])
        along = (bases.free.transpose(0, 2, 1) @ motion[those, :, None])[:, :, 0]
        elastic = (bases.rest.transpose(0, 2, 1) @ u[those, :, None])[:, :, 0]
        runs, w, v, lam = running(springs, blocks[those], bases, along, elastic, reduction[those])
        near = POLISHED + _SETTLES * slope[those]
        good = runs.settled & (np.abs(lam / reduction[those] - 1.0) <= near)
        settled[those[good]] = True
        _record(found, blocks[those[good]], BedStatus.RUNS, lam[good], w[good], v[good])
    return settled


def _land(fine: BedPath, blocks: Ints, rows: Ints, lowest: Floats, tangent: Floats) -> None:
    """Move points of paths that creep to `FAR` elastic displacements, on finer triangles."""
    if not len(rows):
        return
    u, goal = lowest[rows, :-1], FAR * fine.springs.first[blocks[rows]]
    way = u / lengths(u)[:, None]
    planes = np.concatenate([way, np.zeros((len(rows), 1))], axis=1)
    start = np.concatenate([way, lowest[rows, -1:]], axis=1)
    from slopekit.preie.one_block.bed_path import tangents

    found = fine.on_planes(blocks[rows], planes, np.ones(len(rows)), goal, start)
    good = rows[found.settled]
    lowest[good, :-1] = found.x[found.settled, :-1] * goal[found.settled, None]
    lowest[good, -1], tangent[good] = found.x[found.settled, -1], tangents(found)[found.settled]


def _changes(
    springs: BedSprings, finer: BedSprings, blocks: Ints, points: Floats, tangent: Floats, found: BedLimits
) -> None:
    """Note what finer triangles would do to λ, to first order, and what is out of balance."""
    u, reduction = points[:, :-1], np.exp(points[:, -1])
    at = springs.unbalanced(blocks, u, u, reduction)
    size = lengths(u)
    slopes = np.empty((len(blocks), u.shape[1] + 1, u.shape[1] + 1))
    slopes[:, :-1, :-1] = (at.by_opening + at.by_slip) * size[:, None, None]
    slopes[:, :-1, -1] = at.by_reduction * reduction[:, None]
    slopes[:, -1] = tangent
    out = finer.unbalanced(blocks, u, u, reduction).out
    found.change[blocks] = np.abs(solved(slopes, np.concatenate([out, np.zeros((len(out), 1))], axis=1))[:, -1])
    found.residual[blocks] = np.abs(at.out).max(axis=1)
