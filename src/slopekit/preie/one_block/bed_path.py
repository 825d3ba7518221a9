"""The elastic path of n single blocks at once: what their displacement does as the strength of their joints goes down.

Each block rests on its no-tension elastic bed (`polygon_bed`) at λ = 1/F. From a strength that holds it λ goes down,
and the displacement u is followed by arc length in x = (u / |u|, ln λ). F_bed = 1/λ at the least λ on the way. All
blocks take a step together, each of its own length; NumPy's calls are shared by them, which makes n blocks cheap.

Where no step leads on (a corner of the path), or no rest is found, the blocks flow: dashpots in parts of the bonded
stiffness, implicit steps, until they rest or run.
"""

import math
from collections.abc import Callable
from enum import IntEnum

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.core.records import dataclass
from slopekit.preie.one_block.polygon_bed import BedSprings
from slopekit.preie.tolerances import LEVEL, PATH_ENDS, POLISHED, ROUNDING, SETTLED, TINY

#: Split of the triangles along the path: its turns are found there, and settled on finer ones.
COARSE = 1
#: Elastic displacements after which a block runs, and to which one that creeps is followed. One is the size of the
#: displacement in which a block rests as a first point slips.
FAR = 1e4
#: Elastic displacements: a block that comes to rest again within them has not failed.
SNAP = 10.0
#: Elastic displacements, beyond which a path that creeps has all but failed.
EARLY = 30.0
_TURNED, _BACK = math.log(1.2), math.log(20.0)  # ln λ so far above its least value does not come back, or sticks
_FIRST, _LONGEST = 0.1, 1.5  # steps along the path
_TURNS, _STRAYS = 0.8, 0.5  # cosine of the angle that a step may turn by, and parts of it that it may leave the tangent
_CORNER = 1e-3  # steps may turn by more where they are as short: points begin to slip
_LONGER = ((0.9999, 3, 4.0), (0.98, 4, 2.0), (-1.0, 6, 1.0))  # cosine and Newton steps: so much longer is the next step
_MOST_STEPS = 150  # along one path
_MOST_NEWTON = 12  # to one point of it
_MOST_STUCK = 150  # to where every point sticks
_MOST_RESTS = 100  # to a rest at one strength
_SHORTEST = 0.05  # part of a damped step
_FARTHEST = 3.0  # of x in one step of Newton's method
_WEAKER = 0.97  # of λ at the first slip
_STRONGER = (1.0, 2.0, 8.0, 32.0)  # times the strength of the first slip at which a block is looked for at rest
_STRONG = 4.0  # times the strength that forces in balance need: blocks that do not stick start there
#: So many times the strength that forces in balance need is the most that is tried.
STRONGEST = 4096.0
_CALMER, _FLOWS, _STIFFEST, _MOST_FLOW = 0.7, 30.0, 1e3, 40  # of viscous flow
_MARCH = (0.05, 2e-3, 1e-4)  # parts of λ: less strength alone, where the path has a corner
_MOST_POLISH = 14  # points to the least λ on a turn of the path
_LEAST = 1e-10  # of ln λ: so near is the least value found

Equations = Callable[[Ints, Floats], tuple[Floats, Floats, Floats]]


@dataclass(frozen=True, slots=True)
class Roots:
    """What Newton's method found for n rows: x (n, k), whether it settled (n,), slopes there, evaluations (n,)."""

    x: Floats
    settled: Bools
    slopes: Floats
    evaluations: Ints


def solve_rows(
    equations: Equations, start: Floats, most: int, damped: bool = False, patience: int = 4, farthest: float = np.inf
) -> Roots:  # fmt: skip
    """Solve n small systems of equations by Newton's method, all at once.

    Parameters
    ----------
    equations : rows (m,) and their x (m, k) -> residual (m, k), slopes (m, k, k), and the size (m,) that is none
    start : (n, k)
    damped : shorten a step that does not lower the residual; else such a row is given up after `patience` steps
    farthest : a row whose step is longer is given up
    """
    count, unknowns = start.shape
    x, base, step = start.copy(), start.copy(), np.zeros_like(start)
    size, length, settled = np.full(count, np.inf), np.ones(count), np.zeros(count, dtype=bool)
    slopes, used = np.zeros((count, unknowns, unknowns)), np.zeros(count, dtype=np.int64)
    rows = np.arange(count)
    for number in range(most):
        residual, slope, small = equations(rows, x[rows])
        used[rows] += 1
        now = np.nan_to_num(np.abs(residual).max(axis=1), nan=np.inf)
        done = now <= small
        settled[rows[done]], slopes[rows[done]] = True, slope[done]
        good = np.isfinite(now) & ~done
        if damped or number > patience:
            good &= now < size[rows] * (1.0 - 0.1 * length[rows] * damped)
        better = rows[good]
        base[better], size[better], length[better] = x[better], now[good], 1.0
        step[better] = -solved(slope[good], residual[good])
        length[rows[~good]] *= 0.5 * damped
        lost = length[rows] < _SHORTEST
        lost[good] |= ~(np.abs(step[better]).max(axis=1, initial=0.0) < farthest)
        rows = rows[~done & ~lost]
        if not len(rows):
            break
        x[rows] = base[rows] + length[rows, None] * step[rows]
    return Roots(x, settled, slopes, used)


def solved(matrices: Floats, vectors: Floats) -> Floats:
    """Return the solutions (n, k) of n systems; nothing useful, but finite numbers, of those that are singular."""
    if not len(vectors):
        return vectors
    try:
        return np.asarray(np.linalg.solve(matrices, vectors[:, :, None])[:, :, 0])
    except np.linalg.LinAlgError:
        unit, size = np.eye(vectors.shape[1]), np.abs(matrices).max(axis=(1, 2))
        size = np.where(np.isfinite(size) & (size > 0.0), size, 1.0)[:, None, None]
        shifted = np.nan_to_num(matrices, posinf=0.0, neginf=0.0) + PATH_ENDS**2 * size * unit
        return np.asarray(np.linalg.solve(shifted, vectors[:, :, None])[:, :, 0])


def lengths(vectors: Floats) -> Floats:
    """Return the lengths (n,) of vectors (n, k)."""
    return np.sqrt(np.einsum("nk,nk->n", vectors, vectors))


@dataclass(frozen=True, slots=True)
class PathPoints:
    """Points of the paths of n blocks.

    Attributes
    ----------
    displacement : (n, u); log_reduction : (n,) ln λ
    tangent : (n, u + 1) unit vectors in (u / |u|, ln λ)
    """

    displacement: Floats
    log_reduction: Floats
    tangent: Floats


class PathEnd(IntEnum):
    """How the path of a block ends."""

    FAR = 0  # followed to `FAR` elastic displacements
    TURNED = 1  # λ rose for good
    BACK = 2  # λ rose to a stuck state near by: less strength alone may lead to another rest
    CORNER = 3  # no step leads on


@dataclass(frozen=True, slots=True)
class Path:
    """What was found along the paths of n blocks.

    Attributes
    ----------
    end : the last point of each
    lowest : (n, u + 1) u and ln λ where that is least; turns : (n,) whether λ rises again behind it
    heading : (n, u) unit direction of u there; curvature : (n,) of ln λ along it, per |u|²
    early : (n,) the least ln λ within `EARLY` elastic displacements; steps : (n,)
    outcome : (n,) `PathEnd`
    """

    end: PathPoints
    lowest: Floats
    turns: Bools
    heading: Floats
    curvature: Floats
    early: Floats
    steps: Ints
    outcome: Ints


class BedPath:
    """The elastic paths of some blocks on one set of springs."""

    def __init__(self, springs: BedSprings) -> None:
        self.springs = springs

    def on_planes(self, blocks: Ints, planes: Floats, offsets: Floats, scale: Floats, start: Floats) -> Roots:
        """Balance the forces where x = (u / scale, ln λ) lies on planes: normal (n, u + 1) times x is the offset."""
        springs = self.springs

        def equations(rows: Ints, x: Floats) -> tuple[Floats, Floats, Floats]:
            size, reduction = scale[rows], np.exp(np.minimum(x[:, -1], 50.0))
            u = x[:, :-1] * size[:, None]
            at = springs.unbalanced(blocks[rows], u, u, reduction)
            slopes = np.empty((len(x), x.shape[1], x.shape[1]))
            slopes[:, :-1, :-1] = (at.by_opening + at.by_slip) * size[:, None, None]
            slopes[:, :-1, -1] = at.by_reduction * reduction[:, None]
            slopes[:, -1] = planes[rows]
            off = np.einsum("nk,nk->n", planes[rows], x) - offsets[rows]
            return np.concatenate([at.out, off[:, None]], axis=1), slopes, SETTLED * np.maximum(1.0, reduction)

        return solve_rows(equations, start, _MOST_NEWTON, farthest=_FARTHEST)

    def rests(
        self, blocks: Ints, start: Floats, reduction: Floats, sticks: bool = False, drag: Floats | None = None
    ) -> Roots:
        """Balance the forces at fixed λ (n,); a drag (n, u, u) holds the blocks back to where they start."""
        springs = self.springs

        def equations(rows: Ints, u: Floats) -> tuple[Floats, Floats, Floats]:
            at = springs.unbalanced(blocks[rows], u, u, reduction[rows], sticks=sticks)
            out, slopes = at.out, at.by_opening + at.by_slip
            if drag is not None:
                out = out - (drag[rows] @ (u - start[rows])[:, :, None])[:, :, 0]
                slopes = slopes - drag[rows]
            return out, slopes, SETTLED * np.maximum(1.0, reduction[rows])

        if sticks:  # full steps: each takes a third of a pressed part that is too large
            return solve_rows(equations, start, _MOST_STUCK, patience=_MOST_STUCK)
        return solve_rows(equations, start, _MOST_RESTS, damped=True)

    def flow(self, blocks: Ints, start: Floats, reduction: Floats) -> tuple[Floats, Bools]:
        """Let blocks move slowly at one λ (n,) each; return where (n, u) they come to rest, and which of them do."""
        u, rested = start.copy(), np.zeros(len(blocks), dtype=bool)
        slow, pushed = np.ones(len(blocks)), np.full(len(blocks), np.inf)
        stiffness, rows = self.springs.stiffness[blocks], np.arange(len(blocks))
        far = _FLOWS * np.maximum(self.springs.first[blocks], lengths(start))
        for _ in range(_MOST_FLOW):
            drag = slow[rows, None, None] * stiffness[rows]
            step = self.rests(blocks[rows], u[rows], reduction[rows], drag=drag)
            moves = rows[step.settled]
            moved = step.x[step.settled] - u[moves]
            push = slow[moves] * np.abs((stiffness[moves] @ moved[:, :, None])[:, :, 0]).max(axis=1, initial=0.0)
            u[moves] += moved
            slow[rows] *= np.where(step.settled, 0.2, 4.0)
            calmer = moves[push < _CALMER * pushed[moves]]  # driven by more and more there is no rest near
            rest = self.rests(blocks[calmer], u[calmer], reduction[calmer])
            u[calmer[rest.settled]], rested[calmer[rest.settled]] = rest.x[rest.settled], True
            pushed[moves] = push
            ends = rested[rows] | (slow[rows] > _STIFFEST) | (lengths(u[rows]) > far[rows])
            ends[step.settled] |= ~(np.abs(moved).max(axis=1, initial=0.0) > 0.0)
            rows = rows[~ends]
            if not len(rows):
                break
        return u, rested

    def start(self, blocks: Ints, reduction: Floats) -> tuple[Floats, Floats]:
        """Find each block at rest a little below the strength at which a first point slips.

        Else at a strength that is that of `reduction` or larger. Returns displacements (n, u), and λ (n,), not a number
        where a block rests at no strength.
        """
        count, springs = len(blocks), self.springs
        stuck = self.rests(blocks, springs.bonded[blocks], reduction, sticks=True)
        u = np.where(stuck.settled[:, None], stuck.x, springs.bonded[blocks])
        slips = np.clip(_WEAKER * springs.first_slip(blocks, u), TINY, STRONGEST * reduction)
        first = np.where(stuck.settled, slips, _STRONG * reduction)
        at, rows = np.full(count, np.nan), np.arange(count)
        for stronger in _STRONGER:
            found = self.rests(blocks[rows], u[rows], stronger * first[rows])
            done = rows[found.settled]
            u[done], at[done] = found.x[found.settled], stronger * first[done]
            rows = rows[~found.settled]
        for stronger in (1.0, STRONGEST / _STRONG):
            rest, settled = self.flow(blocks[rows], u[rows], stronger * first[rows])
            u[rows[settled]], at[rows[settled]] = rest[settled], stronger * first[rows[settled]]
            rows = rows[~settled]
        return u, at

    def lower(self, blocks: Ints, u: Floats, log_reduction: Floats, elastic: Floats) -> tuple[Floats, Floats]:
        """Lower λ alone from a rest at a corner of the path; returns rests (n, u) and λ, not a number without one.

        A rest more than `SNAP` elastic displacements away is none.
        """
        rest, at, rows = u.copy(), np.full(len(blocks), np.nan), np.arange(len(blocks))
        for part in _MARCH:
            if not len(rows):
                break
            here = np.exp(log_reduction[rows]) * (1.0 - part)
            found, settled = self.flow(blocks[rows], u[rows], here)
            rest[rows[settled]], at[rows[settled]] = found[settled], here[settled]
            rows = rows[~settled]
        at[lengths(rest - u) > SNAP * elastic] = np.nan
        return rest, at

    def follow(self, blocks: Ints, u: Floats, reduction: Floats, elastic: Floats, ends: Floats) -> Path:
        """Follow the paths from states of rest, each until its block runs or λ has turned for good.

        Parameters
        ----------
        u : (n, u); reduction : (n,); elastic : (n,) size of an elastic displacement
        ends : (n,) ln λ to which a path is known to rise in the end: it is left once λ turned up; infinite: not known
        """
        count = len(blocks)
        u, log_reduction, scale = u.copy(), np.log(reduction), lengths(u)
        goal = np.concatenate([u / scale[:, None], log_reduction[:, None]], axis=1)
        down = np.zeros_like(goal)
        down[:, -1] = -1.0
        begun = self.on_planes(blocks, down, -log_reduction, scale, goal)
        tangent = tangents(begun)
        lowest = np.concatenate([u, log_reduction[:, None]], axis=1)
        turns, heading, curvature = np.zeros(count, dtype=bool), tangent[:, :-1].copy(), np.ones(count)
        early = np.where(scale <= EARLY * elastic, log_reduction, np.inf)
        length, steps = np.full(count, _FIRST), np.zeros(count, dtype=np.int64)
        outcome = np.where(begun.settled, -1, PathEnd.CORNER)
        rows = np.flatnonzero(begun.settled)
        while len(rows):
            along, tan, here = length[rows], tangent[rows], scale[rows]
            goal = np.concatenate([u[rows] / here[:, None], log_reduction[rows, None]], axis=1)
            ahead = goal + along[:, None] * tan
            found = self.on_planes(blocks[rows], tan, np.einsum("nk,nk->n", tan, ahead), here, ahead)
            steps[rows] += 1
            after = tangents(found)
            after[np.abs(after[:, -1]) < ROUNDING, -1] = -ROUNDING  # level, not turned
            cosine, off = np.einsum("nk,nk->n", after, tan), lengths(found.x - ahead)
            before_slope, slope, change = tan[:, -1], after[:, -1], found.x[:, -1] - goal[:, -1]
            strays = (cosine < _TURNS) | (off > _STRAYS * along)
            # λ does between two points what its slopes at them cannot make: it turned on the way
            strays |= (before_slope * slope > 0.0) & (before_slope * change < 0.0) & (np.abs(change) > POLISHED)
            good = found.settled & ~(strays & (along > _CORNER))
            length[rows[~good]] = along[~good] / 4.0
            outcome[rows[~good & (length[rows] < PATH_ENDS)]] = PathEnd.CORNER
            at = rows[good]
            new = found.x[good, :-1] * here[good, None]
            far, ln_after = lengths(new), found.x[good, -1]
            fold = (before_slope[good] < 0.0) & (slope[good] >= 0.0)
            part, least = cubic_least(along[good], goal[good, -1], before_slope[good], ln_after, slope[good])
            part, least = np.where(fold, part, 1.0), np.where(fold, least, ln_after)
            lower = least < lowest[at, -1] - _LEAST
            low = at[lower]
            way = new[lower] - u[low]
            lowest[low, :-1], lowest[low, -1] = u[low] + part[lower, None] * way, least[lower]
            turns[low], heading[low] = fold[lower], way / np.maximum(lengths(way), TINY)[:, None]
            curvature[low] = ((slope - before_slope)[good] / along[good])[lower]
            was, most = scale[at], EARLY * elastic[at]
            inside = np.clip((most - was) / np.maximum(far - was, TINY), 0.0, 1.0)
            inside = np.where(far <= most, 1.0, inside)
            reached = goal[good, -1] + inside * (ln_after - goal[good, -1])
            early[at] = np.minimum(early[at], np.where(was <= most, reached, np.inf))
            longer = np.full(len(at), 0.6)
            for least_cosine, most_used, times in reversed(_LONGER):
                longer[(cosine[good] > least_cosine) & (found.evaluations[good] <= most_used)] = times
            length[at] = np.minimum(along[good] * longer, _LONGEST)
            renewed = after[good]
            renewed[:, :-1] *= (here[good] / far)[:, None]
            tangent[at] = renewed / lengths(renewed)[:, None]
            u[at], log_reduction[at], scale[at] = new, ln_after, far
            rise = ln_after - lowest[at, -1]
            gone = lengths(new - lowest[at, :-1]) > SNAP * elastic[at]
            turned = ((rise > _TURNED) & gone) | (turns[at] & (rise > 0.5 * (ends[at] - lowest[at, -1])))
            outcome[at[steps[at] >= _MOST_STEPS]] = PathEnd.CORNER
            outcome[at[rise > _BACK]] = PathEnd.BACK
            outcome[at[turned]] = PathEnd.TURNED
            outcome[at[far > FAR * elastic[at]]] = PathEnd.FAR
            rows = rows[outcome[rows] < 0]
        return Path(PathPoints(u, log_reduction, tangent), lowest, turns, heading, curvature, early, steps, outcome)

    def settle(
        self, blocks: Ints, lowest: Floats, heading: Floats, curvature: Floats
    ) -> tuple[Floats, Floats, Bools]:  # fmt: skip
        """Find the least λ on the turns of paths that were found with coarser triangles.

        Parameters
        ----------
        lowest : (n, u + 1) u and ln λ; heading, curvature : as of `Path`

        Returns
        -------
        u and ln λ (n, u + 1), unit tangents (n, u + 1), and which of them were found
        """
        count = len(blocks)
        scale = lengths(lowest[:, :-1])
        planes = np.concatenate([heading, np.zeros((count, 1))], axis=1)
        x = lowest.copy()
        x[:, :-1] /= scale[:, None]
        origin = np.einsum("nk,nk->n", planes, x)
        at, best, tangent = np.zeros(count), x.copy(), planes.copy()
        best[:, -1], known = np.inf, np.zeros(count, dtype=bool)
        # on either side of the least value: where, ln λ and its slope
        down, up = np.full((count, 3), np.nan), np.full((count, 3), np.nan)
        curvature, last = np.maximum(curvature, LEVEL), np.full((count, 2), np.nan)
        rows = np.arange(count)
        for number in range(_MOST_POLISH):
            found = self.on_planes(blocks[rows], planes[rows], origin[rows] + at[rows], scale[rows], x[rows])
            ok = found.settled
            again = rows[~ok]  # half as far from where the last point was found
            at[again] = np.where(known[again], 0.5 * (at[again] + last[again, 0]), np.nan)
            good, after = rows[ok], tangents(found)[ok]
            along = np.einsum("nk,nk->n", after, planes[good])
            after /= np.where(along == 0.0, 1.0, along)[:, None]
            slope, ln = after[:, -1], found.x[ok, -1]
            here = at[good]
            bent = (slope - last[good, 1]) / (here - last[good, 0])
            curvature[good] = np.where(bent > 0.0, bent, curvature[good])
            last[good, 0], last[good, 1], known[good] = here, slope, True
            lower = good[ln < best[good, -1]]
            best[lower], tangent[lower] = found.x[ok][ln < best[good, -1]], after[ln < best[good, -1]]
            for side, those in ((down, slope < 0.0), (up, slope >= 0.0)):
                side[good[those]] = np.stack([here, ln, slope], axis=1)[those]
            span = up[good, 0] - down[good, 0]
            both = span > 0.0
            fall = down[good, 2] * (up[good, 1] - down[good, 1] - up[good, 2] * span) / (down[good, 2] - up[good, 2])
            spare = np.where(both, best[good, -1] - down[good, 1] - fall, np.inf)
            spare = np.minimum(spare, 0.5 * slope * slope / curvature[good])
            step = -slope / curvature[good]
            part, _ = cubic_least(span, down[good, 1], down[good, 2], up[good, 1], up[good, 2])
            inside = down[good, 0] + np.where(number % 4 == 3, 0.5, part) * span
            following = np.where(both, inside, here + np.clip(step, -0.3, 0.3))
            x[good] = found.x[ok] + (following - here)[:, None] * after
            at[good] = following
            ends = np.isnan(at[rows])
            ends[ok] |= spare < _LEAST
            rows = rows[~ends]
            if not len(rows):
                break
        best[:, :-1] *= scale[:, None]
        return best, tangent / lengths(tangent)[:, None], known


def tangents(roots: Roots) -> Floats:
    """Return the unit tangents (n, k) of the paths through points that settled, the way their planes look."""
    ahead = np.zeros_like(roots.x)
    ahead[:, -1] = 1.0
    tangent = np.zeros_like(ahead)
    tangent[roots.settled] = solved(roots.slopes[roots.settled], ahead[roots.settled])
    return tangent / np.maximum(lengths(tangent), TINY)[:, None]


def cubic_least(
    span: Floats, before: Floats, before_slope: Floats, after: Floats, slope: Floats
) -> tuple[Floats, Floats]:  # fmt: skip
    """Return where in parts of their span (n,) cubics with these ends and slopes are least, and what they are there."""
    with np.errstate(all="ignore"):
        rise = 3.0 * (before - after) / span + before_slope + slope
        root = np.sqrt(np.maximum(rise * rise - before_slope * slope, 0.0))
        part = np.clip(1.0 - (slope + root - rise) / (slope - before_slope + 2.0 * root), 0.0, 1.0)
    rest = 1.0 - part
    value = before * rest * rest * (1.0 + 2.0 * part) + after * part * part * (3.0 - 2.0 * part)
    return part, value + span * part * rest * (before_slope * rest - slope * part)
