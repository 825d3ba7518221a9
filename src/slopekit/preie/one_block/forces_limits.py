"""The limits of the forces of n single blocks alone, which may move but not turn: what closed forms compute.

At a reduction λ the contacts push with N >= 0 and the passive bolts pull with 0 <= T <= λ C so as to leave the least of
the load: that is the driving force D, and its direction the velocity. A block stands where λ Σ A τ(N / A) is more. The
limit is the first loss as λ falls. Without bolts the pushes do not depend on λ (Moreau's decomposition). With bolts
pushes and pulls are straight lines in λ while the same contacts push and the same bolts are drawn out: from piece to
piece one contact or bolt changes, as of a parametric quadratic program (Best 1996, An algorithm for the solution of the
parametric quadratic programming problem).
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from functools import partial
from itertools import chain, combinations

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.preie.one_block.bed_path import lengths
from slopekit.preie.one_block.polygon_bed import Beds, strength_and_slope
from slopekit.preie.solvers.linear import non_negative_least_squares
from slopekit.preie.tolerances import FARTHEST, NO_FORCE, PARALLEL, ROUNDING, TINY

# ratio of λ between steps to the first instability; times λ without bolts, above which steps halve λ
_STRIDE, _FAR = 1.05, 30.0
_HALVINGS = 60  # of a bracket of λ
_MOST_PIECES = 8  # for each contact and bolt
_ZERO, _FREE, _FULL = range(3)  # what a contact pushes, or a bolt pulls


class ForcesStatus(IntEnum):
    """State of a block under its forces alone, moments left out."""

    SLIDES = 0
    LIFTED = 1  # the load lifts it off every contact
    FALLS = 2  # lifted, and no contact is below it
    NOT_DRIVEN = 3  # no driving force, but balance of moments needs strength
    STANDS = 4  # normal forces alone balance forces and moments


@dataclass(frozen=True)
class ForcesLimits:
    """The limits of the forces of n blocks, in the scaled units of each.

    Attributes
    ----------
    status : (n,) `ForcesStatus`
    slides : (n, u + 1) velocity of length one, 0 without motion, and λ = 1/F, as input of `bed_limits`: not a number
        where no bed needs to be solved, a guess where there is no driving force
    pushes : (n, k) of the contacts; pulls : (n, b) of the bolts
    """

    status: Ints
    slides: Floats
    pushes: Floats
    pulls: Floats

    @property
    def factor(self) -> Floats:
        """(n,) F, 0 without strength, not a number without a slide."""
        return np.where(
            self.status == ForcesStatus.SLIDES, np.nan_to_num(1.0 / self.slides[:, -1]), np.nan
        )


def forces_limits(beds: Beds) -> ForcesLimits:
    """Return the limits of blocks by their forces alone, which may move but not turn.

    Normal forces leave the least of the load: of all sets of contacts it is the one whose normal forces are not
    negative, and to which no other contact would add.
    """
    first, count, moves = beds.contact[:-1], np.diff(beds.contact), beds.translations
    inside = np.arange(int(count.max())) < count[:, None]
    contact = np.where(inside, first[:, None] + np.arange(inside.shape[1]), 0)
    normals, load = beds.rows[contact, 0, :moves] * inside[:, :, None], beds.load[:, :moves]
    pushes, pull = _least_load(normals, inside, load)
    touching, driving = (pushes > 0.0).any(axis=1), lengths(pull)
    least = NO_FORCE * np.maximum(
        1.0, pushes.sum(axis=1)
    )  # contact forces of a block that is wedged in may be many times its load
    lifted = np.where(
        (normals[:, :, -1] <= 0.0).all(axis=1), ForcesStatus.FALLS, ForcesStatus.LIFTED
    )
    status = np.where(
        driving > least, np.where(touching, ForcesStatus.SLIDES, lifted), ForcesStatus.NOT_DRIVEN
    )
    rows, pulls = np.flatnonzero(status == ForcesStatus.SLIDES), np.zeros_like(beds.bolt_capacity)
    reduction = np.full(len(load), np.nan)
    with np.errstate(divide="ignore"):
        reduction[rows] = driving[rows] / _resistance(beds, contact[rows], pushes[rows, None])[:, 0]
    rows = np.flatnonzero(
        (status != ForcesStatus.NOT_DRIVEN) & (beds.bolt_capacity > 0.0).any(axis=1)
    )
    if len(rows):
        directions, contacts = beds.bolt_rows[rows, :, :moves], inside.shape[1]
        # bolts that are parallel in every block act as one bolt of their total capacity
        rounded = directions.swapaxes(0, 1).reshape(directions.shape[1], -1).round(12)
        _, representatives, group = np.unique(
            rounded, axis=0, return_index=True, return_inverse=True
        )
        capacity = beds.bolt_capacity[rows] @ np.eye(len(representatives))[group.ravel()]
        sides, resistance = (
            np.concatenate([normals[rows], directions[:, representatives]], axis=1),
            partial(_resistance, beds, contact[rows]),
        )
        reduction[rows], forces, pull[rows] = _first_instability(
            sides, load[rows], pushes[rows], capacity, resistance
        )
        pushes[rows] = forces[:, :contacts]
        share = forces[:, contacts:] / np.maximum(capacity, TINY)
        pulls[rows] = share[:, group.ravel()] * beds.bolt_capacity[rows]
        ends = [reduction[rows] == 0.0, np.isnan(reduction[rows])]
        status[rows] = np.select(ends, [ForcesStatus.NOT_DRIVEN, lifted[rows]], ForcesStatus.SLIDES)
    for row in np.flatnonzero(status == ForcesStatus.NOT_DRIVEN).tolist():
        if _stands_without_strength(beds, row):
            status[row] = ForcesStatus.STANDS
    reduction[~np.isfinite(reduction)] = np.nan  # blocks without strength have no λ
    reduction[status == ForcesStatus.NOT_DRIVEN] = 1.0
    slides, driving = np.zeros((len(load), beds.load.shape[1] + 1)), lengths(pull)
    slides[:, :moves] = (
        np.where(driving > least, 1.0 / np.maximum(driving, TINY), 0.0)[:, None] * pull
    )
    slides[:, -1] = reduction
    return ForcesLimits(status, slides, pushes, pulls)


def _stands_without_strength(beds: Beds, block: int) -> bool:
    """Return whether normal forces at the corners of a block balance its forces and moments."""
    corners = np.flatnonzero(
        (beds.contact[block] <= beds.contact_of_corners)
        & (beds.contact_of_corners < beds.contact[block + 1])
    )
    across = np.concatenate([np.ones((len(corners), 1)), beds.plane[corners]], axis=1)
    lifts = (across[:, None] @ beds.rows[beds.contact_of_corners[corners], :3])[:, 0]
    _, rest = non_negative_least_squares(lifts.T, -beds.load[block])
    return float(np.abs(rest).max()) < NO_FORCE


def _least_load(normals: Floats, inside: Bools, load: Floats) -> tuple[Floats, Floats]:
    """Return normal forces (n, k) that leave the least of loads (n, 3), and the remaining loads (n, 3).

    normals : (n, k, 3); inside : (n, k) which contacts exist. Where only rounding decides between two sets of contacts
    the larger is taken: a contact that is hardly pressed is pressed.
    """
    pushes, pull, is_found = np.zeros(inside.shape), load.copy(), np.zeros(len(load), dtype=bool)
    most, moves = normals.shape[1:]
    for carriers in chain.from_iterable(
        combinations(range(most), size) for size in range(min(most, moves), 0, -1)
    ):
        rows = np.flatnonzero(~is_found & inside[:, carriers].all(axis=1))
        carrier_normals = normals[rows][:, carriers]
        left_vectors, sizes, right_vectors = np.linalg.svd(
            carrier_normals, full_matrices=False
        )  # by SVD: normal equations of normals 1e-5 apart lose digits
        is_clear = sizes[:, -1] > PARALLEL * sizes[:, 0]
        inverse = 1.0 / np.where(is_clear[:, None], sizes, 1.0)[:, :, None]
        force = -(left_vectors @ (inverse * (right_vectors @ load[rows, :, None])))[:, :, 0]
        remainder = load[rows] + (force[:, None] @ carrier_normals)[:, 0]
        is_admissible = ((normals[rows] @ remainder[:, :, None])[:, :, 0] > -NO_FORCE).all(axis=1)
        fits = is_clear & is_admissible & (force > ROUNDING).all(axis=1)
        pushes[rows[fits][:, None], list(carriers)] = force[fits]
        pull[rows[fits]], is_found[rows[fits]] = remainder[fits], True
    return pushes, pull


def _resistance(beds: Beds, contact: Ints, pushes: Floats) -> Floats:
    """Return the total shear strength (n, s) of contacts (n, k) under normal forces (n, s, k), each spread evenly."""
    area, line = beds.contact_moments[contact, 0, 0], beds.line[contact]
    strength = (pushes > 0.0) * (line[:, :, 1] * area)[:, None] + line[:, None, :, 2] * pushes
    curved = np.array([law is not None for law in beds.laws], dtype=bool)
    for row, k in np.argwhere(curved[contact]) if beds.laws else ():
        push, size = pushes[row, :, k], area[row, k]
        strength[row, :, k] = (
            (push > 0.0) * size * strength_and_slope(beds, int(contact[row, k]), push / size)[0]
        )
    return np.asarray(strength.sum(axis=2))


def _first_instability(
    sides: Floats,
    load: Floats,
    pushes: Floats,
    capacity: Floats,
    resistance: Callable[[Floats], Floats],
) -> tuple[Floats, Floats, Floats]:
    """Lower λ of blocks with bolts from a stable state to the first λ at which each is unstable, then bisect.

    Parameters
    ----------
    sides : (n, v, 3) normals of contacts, then directions of bolts; load : (n, 3)
    pushes : (n, k) without bolts; capacity : (n, v - k)
    resistance : strength (n, s) of the contacts under pushes (n, s, k)

    Returns
    -------
    λ (n,) of the first instability: 0 where a block is stable at all strengths, infinite where at none, not a number
    where it is lifted; forces (n, v) and pull (n, 3) at that λ. Bolts so strong that they would lift a block off its
    contacts pull no more than keeps it on one.
    """
    (count, contacts), most = pushes.shape, sides.shape[1]
    pieces, ends = _linear_pieces(
        sides, load, pushes, np.concatenate([np.zeros_like(pushes), capacity], axis=1)
    )
    rows = np.arange(count)[:, None]

    def state(reduction: Floats) -> tuple[Floats, Floats, Bools]:
        """Return forces (n, s, v), driving forces (n, s, 3) and whether blocks are stable (n, s) at λ (n, s)."""
        piece = pieces[rows, (reduction[:, :, None] > ends[:, None]).sum(axis=2)]
        forces, pull = np.split(
            piece[..., 0] + reduction[:, :, None] * piece[..., 1], [most], axis=2
        )
        forces, driving = np.maximum(forces, 0.0), np.sqrt((pull * pull).sum(axis=2))
        is_stable = reduction * resistance(forces[:, :, :contacts]) >= driving
        return forces, pull, is_stable | (driving < NO_FORCE)

    # far above λ without bolts these may lift a block off between two stable λ: steps are longer there
    top, touches = FARTHEST / capacity.sum(axis=1), (pushes > 0.0).any(axis=1)
    bare = lengths(load + (pushes[:, None] @ sides[:, :contacts])[:, 0]) / np.maximum(
        resistance(pushes[:, None])[:, 0], TINY
    )
    longer = (
        np.where(touches, np.log2(top / np.maximum(_FAR * bare, TINY)).clip(-1.0), -1.0)[:, None]
        // 1.0
        + 1.0
    )
    steps = np.arange(np.ceil(np.log(FARTHEST * top.max()) / np.log(_STRIDE)))
    walk = (
        top[:, None] / 2.0 ** np.minimum(steps, longer) / _STRIDE ** np.maximum(steps - longer, 0.0)
    )
    forces, _, is_stable = state(walk)
    touching = (forces[:, 0, :contacts] > 0.0).any(axis=1)
    begin = np.where(touches & ~touching, np.argmax(is_stable, axis=1), 0)
    lost = ~is_stable & (steps >= begin[:, None]) & (walk >= 1.0 / FARTHEST)
    first = np.argmax(lost, axis=1)
    low, high = walk[rows[:, 0], first], walk[rows[:, 0], np.maximum(first - 1, 0)]
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        is_held = state(middle[:, None])[2][:, 0]
        low, high = np.where(is_held, low, middle), np.where(is_held, middle, high)
    forces, pull, _ = state(low[:, None])
    outcomes = [~is_stable[rows[:, 0], begin], ~lost.any(axis=1)]
    reduction = np.select(outcomes, [np.where(touching, np.inf, np.nan), np.zeros(count)], high)
    return reduction, forces[:, 0], pull[:, 0]


def _linear_pieces(
    sides: Floats, load: Floats, pushes: Floats, full: Floats
) -> tuple[Floats, Floats]:
    """Return the forces along sides and the remaining load as piecewise linear functions of λ, and the ends of pieces.

    Parameters
    ----------
    full : (n, v) capacities of bolts, 0 of contacts

    Returns
    -------
    (n, p, v + 3, 2) values at λ = 0 and slopes by λ, and λ (n, p - 1) at the end of each piece but the last
    """
    (count, contacts), most = pushes.shape, full.shape[1]
    rows, is_bolt = np.arange(count), np.arange(most) >= contacts
    exists = (sides != 0.0).any(axis=2) & (~is_bolt | (full > 0.0))
    gain = (sides @ (load + (pushes[:, None] @ sides[:, :contacts])[:, 0])[:, :, None])[:, :, 0]
    state = np.where(exists & (gain < -ROUNDING * lengths(load)[:, None]), _FULL, _ZERO)
    state[:, :contacts] = np.where(pushes > 0.0, _FREE, _ZERO)
    low, lines, ends = np.zeros(count), list[Floats](), list[Floats]()
    while np.isfinite(low).any() and len(lines) < _MOST_PIECES * most:
        free, full_pulls = state == _FREE, np.where(state == _FULL, full, 0.0)
        fixed = np.stack([load, (full_pulls[:, None] @ sides)[:, 0]], axis=2)
        gram = (sides @ sides.transpose(0, 2, 1)) * (free[:, :, None] & free[:, None])
        forces = (
            -np.linalg.pinv(gram, rcond=PARALLEL, hermitian=True)
            @ (sides @ fixed)
            * free[:, :, None]
        )
        remainder = fixed + sides.transpose(0, 2, 1) @ forces
        forces[:, :, 1] += full_pulls
        lines.append(np.concatenate([forces, remainder], axis=1))
        room = (
            np.where(free[:, :, None], forces, sides @ remainder)
            * np.where(state == _FULL, -1.0, 1.0)[:, :, None]
        )
        above = (
            np.stack([-forces[:, :, 0], full - forces[:, :, 1]], axis=2)
            * (is_bolt & free)[:, :, None]
        )
        lacks = (np.stack([room, above], axis=2) * exists[:, :, None, None]).reshape(
            count, -1, 2
        )  # distances of forces from their bounds, not negative
        falls = lacks[:, :, 1] < -ROUNDING
        crossings = np.where(falls, -lacks[:, :, 0] / np.where(falls, lacks[:, :, 1], 1.0), np.inf)
        change = np.argmin(crossings, axis=1)
        low = np.maximum(crossings[rows, change], low)
        ends.append(low)
        side = change // 2
        next_state = np.where(free[rows, side], np.where(change % 2 == 1, _FULL, _ZERO), _FREE)
        state[rows, side] = np.where(np.isinf(low), state[rows, side], next_state)
    return np.stack(lines, axis=1), np.stack(ends, axis=1)[:, :-1]
