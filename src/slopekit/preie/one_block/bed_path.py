"""The elastic path of n single blocks at once: what their displacement does as the strength of their joints goes down.

Each block rests on its no-tension elastic bed (`polygon_bed`) at λ = 1/F. From a strength that holds it λ goes down,
and the displacement u is followed by arc length in x = (u / |u|, ln λ). F_bed = 1/λ at the least λ on the way. All
blocks take a step together, each of its own length; NumPy's calls are shared by them, which makes n blocks cheap.

Where no step leads on (a corner of the path), or no rest is found, the blocks flow: dashpots in parts of the bonded
stiffness, implicit steps, until they rest or run.
"""

import math
from collections.abc import Callable
from dataclasses import fields
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
_STRAIGHT, _STRAIGHTER = 0.98, 0.9999  # where the path turns by less, the next step is twice or four times as long
_MOST_STEPS = 150  # along one path
_MOST_NEWTON, _PATIENCE = 12, 4  # to one point of it; after so many the residual must fall
_MOST_STUCK = 400  # to where every point sticks: some 300 where little of a contact is pressed
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
_LOWER = 1e-8  # of ln λ along a path: lower by less is rounding

_NONE = np.zeros(0)

Equations = Callable[[Ints, Floats], tuple[Floats, Floats, Floats]]


@dataclass(frozen=True, slots=True)
class Roots:
    """What Newton's method found for n rows: x (n, k), whether it settled (n,), slopes there, evaluations (n,)."""

    x: Floats
    settled: Bools
    slopes: Floats
    evaluations: Ints


@dataclass(frozen=True, slots=True)
class Newton:
    """How far Newton's method goes: steps at most, steps after which the residual must fall, the size of a step.

    With a `shortest` part of a step, each is halved until it lowers the residual.
    """

    most: int
    patience: int = 0
    farthest: float = np.inf
    shortest: float = 0.0


def solve_rows(equations: Equations, start: Floats, how: Newton) -> Roots:
    """Solve n small systems of equations by Newton's method, all at once.

    Parameters
    ----------
    equations : rows (m,) and their x (m, k) -> residual (m, k), slopes (m, k, k), and the size (m,) that is none
    start : (n, k)
    """
    count, unknowns = start.shape
    roots = Roots(start.copy(), np.zeros(count, bool), np.zeros((count, unknowns, unknowns)), np.full(count, how.most))
    rows, x, length = np.arange(count), start, np.ones(count)
    base, step, size = start, np.zeros_like(start), np.full(count, np.inf)
    for number in range(how.most if count else 0):
        residual, slopes, small = equations(rows, x)
        now = np.abs(residual).max(axis=1)
        done = now <= small
        settled = rows[done]
        roots.settled[settled], roots.evaluations[settled] = True, number + 1
        roots.x[settled], roots.slopes[settled] = x[done], slopes[done]
        most = size * (1.0 - 0.1 * length) if how.shortest else size
        lower = now < (most if how.shortest or number > how.patience else np.inf)
        step = np.where(lower[:, None], solved(slopes, residual), step)
        base, size = np.where(lower[:, None], x, base), np.where(lower, now, size)
        length = np.where(lower, 1.0, 0.5 * length if how.shortest else 0.0)
        goes_on = ~done & (length > how.shortest) & (np.abs(step).max(axis=1) < how.farthest)
        rows, base, step, size, length = (each[goes_on] for each in (rows, base, step, size, length))
        if not len(rows):
            break
        x = base - length[:, None] * step
    return roots


@dataclass(frozen=True, slots=True)
class _Sought:
    """Balance of some blocks where x = (u / scale, ln λ) lies on planes; see `BedPath`."""

    blocks: Ints
    planes: Floats
    offsets: Floats
    scale: Floats
    sticks: bool = False
    drag: Floats | None = None
    held: Floats | None = None

    def equations(self, springs: BedSprings, balanced: float) -> Equations:
        """Return the unbalanced forces and the distance from the planes, and their slopes, as `solve_rows` asks."""

        def equations(rows: Ints, x: Floats) -> tuple[Floats, Floats, Floats]:
            size, reduction = self.scale[rows], np.exp(np.minimum(x[:, -1], 50.0))
            u = x[:, :-1] * size[:, None]
            at = springs.unbalanced(self.blocks[rows], u, u, reduction, sticks=self.sticks)
            out, by_displacement = at.out, at.by_opening + at.by_slip
            if self.drag is not None and self.held is not None:
                out = out - (self.drag[rows] @ (u - self.held[rows])[:, :, None])[:, :, 0]
                by_displacement = by_displacement - self.drag[rows]
            slopes = np.empty((len(x), x.shape[1], x.shape[1]))
            slopes[:, :-1, :-1] = by_displacement * size[:, None, None]
            slopes[:, :-1, -1] = at.by_reduction * reduction[:, None]
            slopes[:, -1] = self.planes[rows]
            off = np.einsum("nk,nk->n", self.planes[rows], x) - self.offsets[rows]
            return np.concatenate([out, off[:, None]], axis=1), slopes, balanced * np.maximum(1.0, reduction)

        return equations


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
    size: Floats = np.sqrt(np.einsum("nk,nk->n", vectors, vectors))
    return size


@dataclass(frozen=True, slots=True)
class Balance:
    """States of n blocks whose forces balance.

    Attributes
    ----------
    x : (n, u + 1) u / scale and ln λ; settled : (n,) which of them were found; evaluations : (n,) of the forces
    tangent : (n, u + 1) unit tangents of the paths through them, the way their planes look
    """

    x: Floats
    settled: Bools
    tangent: Floats
    evaluations: Ints


class PathEnd(IntEnum):
    """How the path of a block ends."""

    FAR = 0  # followed to `FAR` elastic displacements
    TURNED = 1  # λ rose for good
    BACK = 2  # λ rose to a stuck state near by: less strength alone may lead to another rest
    CORNER = 3  # no step leads on


@dataclass(slots=True)
class Paths:
    """The elastic paths of some blocks: where they are, and what was found along them.

    Attributes
    ----------
    rows : (n,) their numbers among the paths that were begun together
    u : (n, u); ln : (n,) ln λ; scale : (n,) |u|; tangent : (n, u + 1) unit vectors in (u / |u|, ln λ)
    length : (n,) of the next step
    lowest : (n, u + 1) u and ln λ where that is least; turns : (n,) whether λ rises again behind it
    heading : (n, u) unit direction of u there; curvature : (n,) of ln λ along it, per |u|²
    early : (n,) the least ln λ within `EARLY` elastic displacements; steps : (n,)
    outcome : (n,) `PathEnd`, -1 on the way
    """

    rows: Ints
    u: Floats
    ln: Floats
    scale: Floats
    tangent: Floats
    length: Floats
    lowest: Floats
    turns: Bools
    heading: Floats
    curvature: Floats
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

    def on_planes(self, blocks: Ints, planes: Floats, offsets: Floats, scale: Floats, start: Floats) -> "Balance":
        """Balance the forces where x = (u / scale, ln λ) lies on planes: normal (n, u + 1) times x is the offset."""
        sought = _Sought(blocks=blocks, planes=planes, offsets=offsets, scale=scale)
        return self._balanced(sought, start, Newton(_MOST_NEWTON, _PATIENCE, _FARTHEST))

    def rests(
        self, blocks: Ints, start: Floats, reduction: Floats, sticks: bool = False, drag: Floats | None = None
    ) -> "Balance":
        """Balance the forces at fixed λ (n,); a drag (n, u, u) holds the blocks back to where they start."""
        x = np.concatenate([start, np.log(reduction)[:, None]], axis=1)
        planes = np.zeros_like(x)
        planes[:, -1] = 1.0
        sought = _Sought(blocks, planes, x[:, -1], np.ones(len(x)), sticks, drag, start)
        # where all sticks full steps: each takes a third of a pressed part that is too large
        how = Newton(_MOST_STUCK, _MOST_STUCK) if sticks else Newton(_MOST_RESTS, shortest=_SHORTEST)
        return self._balanced(sought, x, how)

    def _balanced(self, sought: "_Sought", start: Floats, how: "Newton") -> "Balance":
        """Balance the forces of some blocks by Newton's method."""
        springs, beds, count = self.springs, self.springs.beds, len(start)
        if springs.kernels is None or beds.bolt_capacity.shape[1]:
            roots = solve_rows(sought.equations(springs, self.balanced), start, how)
            return Balance(roots.x, roots.settled, tangents(roots), roots.evaluations)
        found = Balance(start.copy(), np.zeros(count, bool), np.zeros_like(start), np.zeros(count, np.int64))
        limits = np.array([how.most, how.patience, how.farthest, how.shortest, self.balanced])
        drag, held = (_NONE, _NONE) if sought.drag is None else (sought.drag, sought.held)
        springs.kernels.balanced(
            springs.polygons,
            sought.blocks,
            beds.load,
            np.ascontiguousarray(sought.planes),
            np.ascontiguousarray(sought.offsets),
            np.ascontiguousarray(sought.scale),
            np.ascontiguousarray(drag),
            np.ascontiguousarray(held),
            sought.sticks,
            limits,
            found.x,
            found.tangent,
            found.settled,
            found.evaluations,
        )
        return found

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
            moved = step.x[step.settled, :-1] - u[moves]
            push = slow[moves] * np.abs((stiffness[moves] @ moved[:, :, None])[:, :, 0]).max(axis=1, initial=0.0)
            u[moves] += moved
            slow[rows] *= np.where(step.settled, 0.2, 4.0)
            calmer = moves[push < _CALMER * pushed[moves]]  # driven by more and more there is no rest near
            rest = self.rests(blocks[calmer], u[calmer], reduction[calmer])
            u[calmer[rest.settled]], rested[calmer[rest.settled]] = rest.x[rest.settled, :-1], True
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
        u = np.where(stuck.settled[:, None], stuck.x[:, :-1], springs.bonded[blocks])
        slips = np.clip(_WEAKER * springs.first_slip(blocks, u), TINY, STRONGEST * reduction)
        first = np.where(stuck.settled, slips, _STRONG * reduction)
        at, rows = np.full(count, np.nan), np.arange(count)
        for stronger in _STRONGER:
            found = self.rests(blocks[rows], u[rows], stronger * first[rows])
            done = rows[found.settled]
            u[done], at[done] = found.x[found.settled, :-1], stronger * first[done]
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

    def follow(self, blocks: Ints, u: Floats, reduction: Floats, elastic: Floats, ends: Floats) -> Paths:
        """Follow the paths from states of rest, each until its block runs or λ has turned for good.

        Parameters
        ----------
        u : (n, u); reduction : (n,); elastic : (n,) size of an elastic displacement
        ends : (n,) ln λ to which a path is known to rise in the end: it is left once λ turned up; infinite: not known
        """
        scale = lengths(u)
        x = np.concatenate([u / scale[:, None], np.log(reduction)[:, None]], axis=1)
        down = np.zeros_like(x)
        down[:, -1] = -1.0
        begun = self.on_planes(blocks, down, -x[:, -1], scale, x)
        every = Paths(
            rows=np.arange(len(blocks)),
            u=u.copy(),
            ln=x[:, -1],
            scale=scale,
            tangent=begun.tangent,
            length=np.full(len(blocks), _FIRST),
            lowest=np.concatenate([u, x[:, -1:]], axis=1),
            turns=np.zeros(len(blocks), dtype=bool),
            heading=begun.tangent[:, :-1].copy(),
            curvature=np.ones(len(blocks)),
            early=np.where(scale <= EARLY * elastic, x[:, -1], np.inf),
            steps=np.zeros(len(blocks), dtype=np.int64),
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
        along, tangent, here = at.length, at.tangent, at.scale
        goal = np.concatenate([at.u / here[:, None], at.ln[:, None]], axis=1)
        ahead = goal + along[:, None] * tangent
        found = self.on_planes(blocks, tangent, np.einsum("nk,nk->n", tangent, ahead), here, ahead)
        after = found.tangent
        after[np.abs(after[:, -1]) < ROUNDING, -1] = -ROUNDING  # level, not turned
        cosine, off = np.einsum("nk,nk->n", after, tangent), lengths(found.x - ahead)
        before_slope, slope, ln = tangent[:, -1], after[:, -1], found.x[:, -1]
        change = ln - at.ln
        strays = (cosine < _TURNS) | (off > _STRAYS * along)
        # λ does between two points what its slopes at them cannot make: it turned on the way
        strays |= (before_slope * slope > 0.0) & (before_slope * change < 0.0) & (np.abs(change) > POLISHED)
        good = found.settled & ~(strays & (along > _CORNER))
        u = np.where(good[:, None], found.x[:, :-1] * here[:, None], at.u)
        ln, scale = np.where(good, ln, at.ln), np.where(good, lengths(u), here)
        fold = good & (before_slope < 0.0) & (slope >= 0.0)
        part, least = cubic_least(along, at.ln, before_slope, ln, slope)
        part, least = np.where(fold, part, 1.0), np.where(fold, least, ln)
        lower = least < at.lowest[:, -1] - _LOWER
        if lower.any():
            way = (u - at.u)[lower]
            at.lowest[lower] = np.concatenate([at.u[lower] + part[lower, None] * way, least[lower, None]], axis=1)
            at.turns[lower], at.heading[lower] = fold[lower], way / np.maximum(lengths(way), TINY)[:, None]
            at.curvature[lower] = ((slope - before_slope) / along)[lower]
        # between two points ln λ is a line of 1 / |u|, as it is far out
        inside = np.clip((1.0 - here / (EARLY * elastic)) / np.maximum(1.0 - here / scale, LEVEL), 0.0, 1.0)
        reached = np.where(here <= EARLY * elastic, at.ln + inside * (ln - at.ln), np.inf)
        at.early = np.minimum(at.early, reached)
        longer = np.where((cosine > _STRAIGHTER) & (found.evaluations <= 3), 4.0, 1.0)
        longer = np.maximum(longer, np.where((cosine > _STRAIGHT) & (found.evaluations <= 4), 2.0, 1.0))
        longer = np.where(found.evaluations > 6, 0.6, longer)
        at.length = np.where(good, np.minimum(along * longer, _LONGEST), along / 4.0)
        after[:, :-1] *= (here / scale)[:, None]
        at.tangent = np.where(good[:, None], after / np.maximum(lengths(after), TINY)[:, None], tangent)
        at.u, at.ln, at.scale, at.steps = u, ln, scale, at.steps + 1
        rise = ln - at.lowest[:, -1]
        gone = lengths(u - at.lowest[:, :-1]) > SNAP * elastic
        turned = ((rise > _TURNED) & gone) | (at.turns & (rise > 0.5 * (ends - at.lowest[:, -1])))
        at.outcome[(at.steps >= _MOST_STEPS) | (at.length < PATH_ENDS)] = PathEnd.CORNER
        at.outcome[rise > _BACK] = PathEnd.BACK
        at.outcome[turned] = PathEnd.TURNED
        at.outcome[scale > FAR * elastic] = PathEnd.FAR

    def settle(self, blocks: Ints, lowest: Floats, heading: Floats, curvature: Floats) -> tuple[Floats, Floats]:
        """Find the least λ on the turns of paths that were found with coarser triangles.

        Parameters
        ----------
        lowest : (n, u + 1) u and ln λ; heading, curvature : as of `Paths`

        Returns
        -------
        u and ln λ (n, u + 1), that infinite where no point was found, and unit tangents (n, u + 1)
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
            good, after = rows[ok], found.tangent[ok]
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
        return best, tangent / lengths(tangent)[:, None]


def tangents(roots: Roots) -> Floats:
    """Return the unit tangents (n, k) of the paths through points that settled, the way their planes look."""
    ahead = np.zeros_like(roots.x)
    ahead[:, -1] = 1.0
    tangent = np.zeros_like(ahead)
    tangent[roots.settled] = solved(roots.slopes[roots.settled], ahead[roots.settled])
    return tangent / np.maximum(lengths(tangent), TINY)[:, None]


def cubic_least(
    span: Floats, before: Floats, before_slope: Floats, after: Floats, slope: Floats
) -> tuple[Floats, Floats]:
    """Return where in parts of their span (n,) cubics with these ends and slopes are least, and what they are there."""
    with np.errstate(all="ignore"):
        rise = 3.0 * (before - after) / span + before_slope + slope
        root = np.sqrt(np.maximum(rise * rise - before_slope * slope, 0.0))
        part = np.clip(1.0 - (slope + root - rise) / (slope - before_slope + 2.0 * root), 0.0, 1.0)
    rest = 1.0 - part
    value = before * rest * rest * (1.0 + 2.0 * part) + after * part * part * (3.0 - 2.0 * part)
    return part, value + span * part * rest * (before_slope * rest - slope * part)
