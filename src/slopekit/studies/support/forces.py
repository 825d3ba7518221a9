"""The least force on a block at one factor of safety: exact along a direction, exact over all directions.

At a factor F the loads R under which a block stands form one convex set for each mode of sliding. With inward normals
nᵢ, Nᵢ the normal force that R gives joint i, and l along the line of intersection:

- on both joints (N₁ > 0, N₂ > 0): |R·l| <= (c₁A₁ + c₂A₂ + N₁ tan φ₁ + N₂ tan φ₂) / F, a polyhedron;
- on joint i alone (N > 0, the other leaves): |R + N nᵢ| <= (cᵢAᵢ + N tan φᵢ) / F with N = -R·nᵢ, part of a cone.

The force wanted is the shortest way from R to their union: along a given direction the first point of a line in each
set, over all directions the nearest point of each set. Both have closed forms, so that the least of them is a global
minimum. The modes: Warburton (1981); Goodman & Shi (1985), ch. 9. For one joint the direction is that of Hoek & Bray
(1981), ch. 7: it rises above the direction against sliding by tan⁻¹(tan φ / F) less the dip.

A passive bolt of capacity T pulls with T / F at that factor while the movement draws it out: the same sets with the
pull instead of the force.
"""

import math
from collections.abc import Iterator
from itertools import combinations

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.core.records import dataclass

_KEEPS = 1e-9  # least normal force (in parts of the size of the loads) of a joint that counts as closed
_SMALL = 1e-12
_DRAWN = 1e-9  # cosine below which a movement square to a passive bolt does not draw it out
_HALVINGS = 40
_AFTER = 1e-7  # part of a pull past the one at which a joint opens
#: of the factor: where a passive bolt has to hold the block as well, lowest first
_LOWER = (1e-3, 0.01, 0.03, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.94, 0.97, 0.99, 0.999)
_MOST_PULLS = 4  # directions of passive bolts whose pulls (all or nothing) are tried in every combination


@dataclass(frozen=True, slots=True)
class BoltedBlock:
    """A block on its joints at one factor of safety, in axes of its own; kN.

    Attributes
    ----------
    load : (3,) everything that does not depend on the strength
    normals : (k, 3) unit normals into the block of its one or two joints
    bonds : (k,) c A; tangents : (k,) tan φ, both at full strength
    pulls : (g, 3) what passive bolts that are there pull at most at this factor, those of one direction together
    factor : F; size : of the loads, what small forces are measured by
    """

    load: Floats
    normals: Floats
    bonds: Floats
    tangents: Floats
    pulls: Floats
    factor: float
    size: float

    @property
    def has_strength(self) -> bool:
        """Whether any joint resists at all."""
        return bool(self.bonds.any() or self.tangents.any())


@dataclass(frozen=True, slots=True)
class Slides:
    """How a block moves under loads (m, 3): its direction (m, 3), zero where nothing drives it; kN."""

    direction: Floats
    driving: Floats
    resisting: Floats
    touches: Bools


def slides(held: BoltedBlock, loads: Floats) -> Slides:
    """Mode and direction of sliding under each of (m, 3) loads, and what resists it at full strength."""
    on = loads @ held.normals.T
    count, joints = len(loads), len(held.normals)
    direction, resisting = np.zeros((count, 3)), np.zeros(count)
    touches = np.zeros((count, joints), dtype=bool)
    if joints == 2:
        between = float(held.normals[0] @ held.normals[1])
        line = _line(held)
        normal = (on[:, ::-1] * between - on) / (1.0 - between * between)
        both = (normal > 0.0).all(axis=1)
        along = loads[both] @ line
        direction[both] = along[:, None] * line
        resisting[both] = held.bonds.sum() + normal[both] @ held.tangents
        touches[both] = True
    else:
        between, both = 0.0, np.zeros(count, dtype=bool)
    for k in range(joints):
        alone = ~both & (on[:, k] < 0.0)
        if joints == 2:
            alone &= on[:, 1 - k] - on[:, k] * between >= 0.0
        direction[alone] = loads[alone] - on[alone, k, None] * held.normals[k]
        resisting[alone] = held.bonds[k] - on[alone, k] * held.tangents[k]
        touches[alone, k] = True
    off = ~touches.any(axis=1)
    direction[off] = loads[off]
    driving = np.sqrt((direction * direction).sum(axis=1))
    moves = driving > _SMALL * held.size
    direction[moves] /= driving[moves, None]
    direction[~moves] = 0.0
    return Slides(direction, driving, resisting, touches)


# -- along given directions ---------------------------------------------------------------------------


def windows(held: BoltedBlock, load: Floats, directions: Floats) -> Iterator[tuple[Floats, Floats]]:
    """For each mode where each line `load + t direction` lies in its set: ends (m,) of t, empty where low > high."""
    keeps = _KEEPS * held.size
    on, turns = held.normals @ load, directions @ held.normals.T
    for k in range(len(held.normals)):
        ends = _linear(-on[k] - keeps, -turns[:, k])
        if len(held.normals) == 2:
            between = float(held.normals[0] @ held.normals[1])
            ends = _common(ends, _linear(on[1 - k] - between * on[k], turns[:, 1 - k] - between * turns[:, k]))
        yield _common(ends, _cone(held, load, directions, k))
    if len(held.normals) == 2:
        between, line = float(held.normals[0] @ held.normals[1]), _line(held)
        share = 1.0 - between * between
        normal, rates = (on[::-1] * between - on) / share, (turns[:, ::-1] * between - turns) / share
        ends = _common(_linear(normal[0] - keeps, rates[:, 0]), _linear(normal[1] - keeps, rates[:, 1]))
        strength = float(held.bonds.sum() + normal @ held.tangents) / held.factor
        gain = rates @ held.tangents / held.factor
        for sign in (1.0, -1.0):
            ends = _common(ends, _linear(strength - sign * float(load @ line), gain - sign * (directions @ line)))
        yield ends


def least_along(held: BoltedBlock, directions: Floats, passive: bool = False) -> Floats:
    """The least force (m,) along each of (m, 3) directions that makes the block stand, inf where none does.

    Parameters
    ----------
    passive : the force is the pull of a passive bolt, which ends where the movement no longer draws it out
    """
    least = np.full(len(directions), np.inf)
    for load, pulling in _pulled(held):
        for low, high in windows(held, load, directions):
            start = np.maximum(low, 0.0)
            at = np.flatnonzero((start <= high) & (start < least))
            if len(at) == 0:
                continue
            moves = slides(held, load + start[at, None] * directions[at]).direction
            sound = _pulls_as_taken(held, moves, pulling)
            if passive:
                sound &= (moves * directions[at]).sum(axis=1) < -_DRAWN
                at, sound = at[sound], np.ones(int(sound.sum()), dtype=bool)
                sound &= _stands_before(held, load, directions[at], start[at])
            least[at[sound]] = start[at[sound]]
    return least


def _stands_before(held: BoltedBlock, load: Floats, directions: Floats, pulls: Floats) -> Bools:
    """Whether passive bolts that pull (m,) at the factor hold the block at every lower factor as well.

    At a lower factor they pull with more, up to what stops the movement along them, and may open a joint. At very low
    ones they may lift the block off; they then pull no more than keeps it down, as the closed form has it.
    """
    stop = np.full(len(pulls), np.inf)
    far = 1e3 * held.size + 1e3 * pulls
    ends = _drawn(held, load, directions, far) >= 0.0
    low, high = pulls[ends], far[ends]
    for _ in range(_HALVINGS if ends.any() else 0):
        middle = 0.5 * (low + high)
        drawn = _drawn(held, load, directions[ends], middle) < 0.0
        low, high = np.where(drawn, middle, low), np.where(drawn, high, middle)
    stop[ends] = low
    shares = np.array(_LOWER)[:, None]
    pulled = np.minimum(pulls / shares, stop)[:, :, None] * directions
    moved = slides(held, load + pulled.reshape(-1, 3))
    on, driving = moved.touches.any(axis=1), moved.driving.reshape(len(_LOWER), -1)
    stand: Bools = on.reshape(driving.shape) & (
        driving * held.factor * shares <= moved.resisting.reshape(driving.shape) * (1.0 + 1e-9)
    )
    stand |= driving <= _SMALL * held.size
    began: Bools = np.logical_or.accumulate(stand)
    before = np.concatenate([np.zeros((1, len(pulls)), dtype=bool), began[:-1]])
    sound: Bools = np.logical_and.reduce(stand | (~before & ~on.reshape(driving.shape)))
    for change in _mode_changes(held, load, directions):
        after = change * (1.0 + _AFTER)
        moved = slides(held, load + np.where(np.isfinite(after), after, 0.0)[:, None] * directions)
        falls = moved.driving * held.factor * pulls > moved.resisting * after * (1.0 + 1e-9)
        sound &= ~((pulls < change) & (after < stop) & moved.touches.any(axis=1) & falls)
    held_back: Bools = sound & began[-1]
    return held_back


def _mode_changes(held: BoltedBlock, load: Floats, directions: Floats) -> Iterator[Floats]:
    """Pulls (m,) along directions (m, 3) at which a joint may open or close."""
    on, turns = held.normals @ load, directions @ held.normals.T
    between = float(held.normals[0] @ held.normals[1]) if len(on) == 2 else 0.0
    for k in range(len(on)):
        for share in (0.0, between) if len(on) == 2 else (0.0,):
            a, b = on[k] - share * on[len(on) - 1 - k], turns[:, k] - share * turns[:, len(on) - 1 - k]
            yield np.where(b != 0.0, -a / np.where(b == 0.0, 1.0, b), np.inf)


def _drawn(held: BoltedBlock, load: Floats, directions: Floats, pulls: Floats) -> Floats:
    """Below 0 where the movement under pulls (m,) along directions (m, 3) draws the bolts out."""
    moves = slides(held, load + pulls[:, None] * directions).direction
    drawn: Floats = (moves * directions).sum(axis=1)
    return drawn


def most_along(held: BoltedBlock, direction: Floats, least: float) -> float:
    """Up to which force along one direction the block goes on standing from `least`, kN; inf without an end."""
    ends = [
        (float(low[0]), float(high[0]))
        for load, _ in _pulled(held) for low, high in windows(held, load, direction[None, :])
    ]  # fmt: skip
    reach, gap = least, 4.0 * _KEEPS * held.size / max(float(np.abs(held.normals @ direction).max()), _SMALL)
    for low, high in sorted(ends):
        if low <= reach + gap:
            reach = max(reach, high)
    return reach


def _linear(a: float, b: Floats) -> tuple[Floats, Floats]:
    """Where a + b t >= 0."""
    low, high = np.full(len(b), -np.inf), np.full(len(b), np.inf)
    with np.errstate(divide="ignore", over="ignore"):
        at = -a / np.where(b == 0.0, 1.0, b)
    low[b > 0.0], high[b < 0.0] = at[b > 0.0], at[b < 0.0]
    if a < 0.0:
        low[b == 0.0] = np.inf
    return low, high


def _cone(held: BoltedBlock, load: Floats, directions: Floats, k: int) -> tuple[Floats, Floats]:
    """Where |u + t v| <= a + b t: sliding on joint k alone, tangential load against reduced strength."""
    n = held.normals[k]
    u, v = load - (load @ n) * n, directions - (directions @ n)[:, None] * n
    a = float(held.bonds[k] - (load @ n) * held.tangents[k]) / held.factor
    b = -(directions @ n) * held.tangents[k] / held.factor
    # |u + t v|² - (a + b t)² = square t² + 2 half t + rest
    square, half, rest = (v * v).sum(axis=1) - b * b, v @ u - a * b, float(u @ u) - a * a
    root = half * half - square * rest
    has = root >= 0.0
    part = -half - np.copysign(np.sqrt(np.maximum(root, 0.0)), half)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        one = np.where(square != 0.0, part / square, np.inf * np.sign(part))
        two = np.where(part != 0.0, rest / part, 0.0)
    left, right = np.minimum(one, two), np.maximum(one, two)
    upper = _linear(a, b)
    closed = square >= 0.0  # between the roots, else beyond one of them
    low = np.where(closed, left, np.where(b > 0.0, right, -np.inf))
    high = np.where(closed, right, np.where(b > 0.0, np.inf, left))
    still = (square == 0.0) & (half == 0.0)  # neither side changes along the line
    low, high = np.where(still, -np.inf, low), np.where(still, np.inf, high)
    has = np.where(still, rest <= 0.0, has)
    low, high = np.where(has, low, np.inf), np.where(has, high, -np.inf)
    return _common((low, high), upper)


def _common(one: tuple[Floats, Floats], two: tuple[Floats, Floats]) -> tuple[Floats, Floats]:
    return np.maximum(one[0], two[0]), np.minimum(one[1], two[1])


def _line(held: BoltedBlock) -> Floats:
    line = np.cross(held.normals[0], held.normals[1])
    unit: Floats = line / math.sqrt(float(line @ line))
    return unit


def _pulled(held: BoltedBlock) -> Iterator[tuple[Floats, Ints]]:
    """The load with each combination of passive bolts that pull with all they have."""
    count = len(held.pulls)
    every = range(count)
    chosen: list[tuple[int, ...]] = [()]
    if count <= _MOST_PULLS:
        chosen = [some for size in range(count + 1) for some in combinations(every, size)]
    elif count:
        chosen = [(), tuple(every)]
    for some in chosen:
        yield held.load + held.pulls[list(some)].sum(axis=0), np.array(some, dtype=np.int64)


def _pulls_as_taken(held: BoltedBlock, moves: Floats, pulling: Ints) -> Bools:
    """Whether the movement (m, 3) draws out those passive bolts that were taken to pull, and no others."""
    if len(held.pulls) == 0:
        return np.ones(len(moves), dtype=bool)
    drawn = moves @ held.pulls.T < 0.0
    taken = np.isin(np.arange(len(held.pulls)), pulling)
    sound: Bools = (drawn == taken).all(axis=1)
    return sound
