"""Judges of the many-block limit that share no line with the solver: they take an assembly's arrays alone.

The law of elastic joints: normal forces N at node pairs, friction forces T of groups of pairs, B their kinematics,

    Bᵀ (N, T) + P = 0,   N >= 0,   |T| <= λ r,   r = Σ c + μ Σ N,   λ = 1 / F.

`static_bound` is the highest F at which such forces exist at all. `certified_range` encloses every limit state of a
section of a few blocks by branch and bound over its contact modes. `history` follows one path to a limit state:
elastic, no-tension joints whose slip is incremental, strength lowered slowly, motion slowed down by viscosity.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import clarabel
import numpy as np
from scipy import sparse
from scipy.optimize import Bounds, LinearConstraint, linprog, milp

import slopekit as sk
from slopekit.kinds import cut
from slopekit.kinds.solver_inputs import joint_strength
from slopekit.loads import assembly_loads
from slopekit.preie.system.assembly import AssemblyModel, build_assembly
from tests.preie.bisection import around


def model_of(design: Mapping[str, Any], refine: int = 0) -> AssemblyModel:
    """The model of a design with all of its blocks free."""
    scene = cut(sk.load(dict(design)))
    blocks, patches = scene.assembly, scene.assembly.patches
    loads = assembly_loads(
        blocks, scene.unit_weights, scene.acting.seismic, scene.pressures, scene.acting.pushes
    )
    touched = np.zeros(len(blocks) + 1, dtype=bool)
    touched[patches.plus] = touched[patches.minus] = True
    return build_assembly(
        patches,
        blocks.fixed | ~touched[:-1],
        blocks.centroids,
        loads.forces,
        loads.moments,
        joint_strength(scene.strengths),
        blocks.in_section,
        np.full(len(patches), refine),
        loads.live,
    )


@dataclass(frozen=True)
class Arrays:
    """What a judge sees of a model: m node pairs, g friction forces of t components, n unknowns.

    normal (m, n) and slip (g t, n) rows of B; load (n,); area, cohesion (m,); friction (g,); group (m,) of each pair;
    contact (m,) of each pair; bolted (g,) friction forces that are bolts: 0 <= T <= λ r. `history` alone knows those.
    """

    normal: np.ndarray
    slip: np.ndarray
    load: np.ndarray
    area: np.ndarray
    cohesion: np.ndarray
    friction: np.ndarray
    group: np.ndarray
    contact: np.ndarray
    bolted: np.ndarray

    @property
    def directions(self) -> int:
        """Components of a friction force: 1 in a section, 2 in space."""
        return len(self.slip) // len(self.friction)

    def of_groups(self, of_pairs: np.ndarray) -> np.ndarray:
        """Sums over the pairs of each friction force, (m,) to (g,)."""
        return np.bincount(self.group, of_pairs, len(self.friction))


def arrays_of(model: AssemblyModel) -> Arrays:
    """The arrays of a model, dense."""
    rows, pairs = model.kinematics.toarray(), len(model.control_area)
    return Arrays(
        rows[:pairs],
        rows[pairs:],
        model.load.ravel(),
        model.control_area,
        model.cohesion,
        model.tan_friction,
        model.group_of_pair,
        model.pair_contact,
        model.bolted,
    )


def in_parts_of_blocks(given: Arrays) -> Arrays:
    """The same in other units: the balance of a block in parts of its load, forces in parts of the lighter block's.

    A pebble's balance counts as much as a boulder's; λ is the same.
    """
    size = 3 if given.directions == 1 else 6
    loads = np.linalg.norm(given.load.reshape(-1, size), axis=1)
    of_unknown = np.repeat(np.maximum(loads, 1e-6 * loads.max()), size)

    def scaled(rows: np.ndarray, forces: np.ndarray) -> np.ndarray:
        return rows * forces[:, None] / of_unknown

    of_pairs = np.where(given.normal != 0.0, of_unknown, np.inf).min(axis=1)
    of_groups = of_pairs[np.searchsorted(given.group, np.arange(len(given.friction)))]
    return replace(
        given,
        normal=scaled(given.normal, of_pairs),
        cohesion=given.cohesion / of_pairs,
        slip=scaled(given.slip, np.repeat(of_groups, given.directions)),
        load=given.load / of_unknown,
    )


# -- the static bound -------------------------------------------------------------------------------------------------

_LEAST, _MOST = 1e-4, 1e4  # strength factors λ between which a bound is looked for
_CLOSE = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
_NEARLY_NOTHING = 1e-7  # and what Clarabel does, which ends within 1e-8 of the largest force
_NOTHING = 1e-9  # of a block's load: what HiGHS leaves of a friction force too large


def static_bound(
    model: AssemblyModel, parts: float | None = None, near: float | None = None
) -> float | None:
    """The highest F at which admissible forces are in equilibrium with the loads; all blocks are free.

    The least excess s of friction, |T| <= λ r + s, is a linear program in a section (HiGHS) and a cone program in space
    (Clarabel). It falls with λ, which is bisected until it is known to `parts` (1e-8 in a section, 1e-5 in space), at
    `near` first where a number is held against it.
    None: there is no equilibrium at any friction; infinite: there is without any.
    """
    given = in_parts_of_blocks(arrays_of(model))
    in_section = given.directions == 1
    stands = (_linear if in_section else _conic)(given)
    parts = (1e-8 if in_section else 1e-5) if parts is None else parts
    if (sides := around(lambda factor: stands(1.0 / factor), near, parts)) is not None:
        return _bisected(stands, 1.0 / sides[1], 1.0 / sides[0], parts)
    low, high = _LEAST, 1.0
    while not stands(high):
        low, high = high, 4.0 * high
        if high > _MOST:
            return None
    if low == _LEAST:
        while stands(low := high / 4.0):
            high = low
            if high < _LEAST:
                return math.inf
    return _bisected(stands, low, high, parts)


def _bisected(stands: Callable[[float], bool], low: float, high: float, parts: float) -> float:
    while high / low > 1.0 + parts:
        middle = math.sqrt(low * high)
        low, high = (low, middle) if stands(middle) else (middle, high)
    return 1.0 / high


def _linear(given: Arrays) -> Callable[[float], bool]:
    """Whether admissible forces exist in a section, by λ."""
    pairs, groups = len(given.area), len(given.friction)
    sums = sparse.csr_matrix(
        (given.friction[given.group], (given.group, np.arange(pairs))), shape=(groups, pairs)
    )
    one, excess = sparse.identity(groups), sparse.csr_matrix(np.ones((groups, 1)))
    balance = sparse.csr_matrix(
        np.hstack([given.normal.T, given.slip.T, np.zeros((len(given.load), 1))])
    )
    cost = np.append(np.zeros(pairs + groups), 1.0)
    bounds = [(0.0, None)] * pairs + [(None, None)] * groups + [(0.0, None)]

    def stands(strength: float) -> bool:
        cone = sparse.vstack(
            [sparse.hstack([-strength * sums, sign * one, -excess]) for sign in (1.0, -1.0)]
        ).tocsr()
        most = np.tile(strength * given.of_groups(given.cohesion), 2)
        found = linprog(
            cost, cone, most, balance, -given.load, bounds, method="highs", options=_CLOSE
        )
        return found.status == 0 and found.fun <= _NOTHING

    return stands


def _conic(given: Arrays) -> Callable[[float], bool]:
    """Whether admissible forces exist in space, by λ: every node pair has a friction force of its own."""
    pairs, unknowns = len(given.area), len(given.load)
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-9
    # slivers among boulders have forces of thousands of their loads: Clarabel's own 1e-8 moved a bound by 5e-4
    settings.static_regularization_constant, settings.static_regularization_proportional = (
        1e-13,
        0.0,
    )
    cones = [
        clarabel.ZeroConeT(unknowns),
        clarabel.NonnegativeConeT(pairs + 1),
        *[clarabel.SecondOrderConeT(3)] * pairs,
    ]
    balance = sparse.csr_matrix(np.hstack([given.normal.T, given.slip.T, np.zeros((unknowns, 1))]))
    pressed = sparse.diags(np.append(-np.ones(pairs), np.append(np.zeros(2 * pairs), -1.0))).tocsr()
    pressed = pressed[np.append(np.arange(pairs), 3 * pairs)]
    cost, curved = (
        np.append(np.zeros(3 * pairs), 1.0),
        sparse.csc_matrix((3 * pairs + 1, 3 * pairs + 1)),
    )
    first, each = 3 * np.arange(pairs), np.arange(pairs)

    def stands(strength: float) -> bool:
        rows = np.concatenate([first, first, first + 1, first + 2])
        columns = np.concatenate(
            [each, np.full(pairs, 3 * pairs), pairs + 2 * each, pairs + 2 * each + 1]
        )
        values = np.concatenate([-strength * given.friction, -np.ones(3 * pairs)])
        cone = sparse.csr_matrix((values, (rows, columns)), shape=(3 * pairs, 3 * pairs + 1))
        right = np.zeros(3 * pairs)
        right[first] = strength * given.cohesion
        right = np.concatenate([-given.load, np.zeros(pairs + 1), right])
        left = sparse.vstack([balance, pressed, cone]).tocsc()
        found = clarabel.DefaultSolver(curved, cost, left, right, cones, settings).solve()
        return str(found.status) in ("Solved", "AlmostSolved") and found.x[-1] <= _NEARLY_NOTHING

    return stands


# -- every limit state of a few blocks --------------------------------------------------------------------------------

#: What a flat contact may do: which ends touch, and the sign of its slip (None: it is open and carries nothing).
_MODES = (
    *((ends, sign) for ends in ("both", "first", "last") for sign in (0, 1, -1)),
    ("none", None),
)
_WIDTH = 1e-4  # of the range: the certificate is an interval of λ this narrow at either end


@dataclass(frozen=True)
class CertifiedRange:
    """The range of F outside which no limit state lies, how many contact modes have one, and linear programs solved."""

    lowest: float
    highest: float
    modes: int
    programs: int


class _Contacts:
    """The contacts of a section with their modes, as bounds of two linear programs: motions, and forces."""

    def __init__(self, model: AssemblyModel, cohesion: np.ndarray | None) -> None:
        self.given = given = arrays_of(model)
        if given.directions != 1:
            raise ValueError("only sections have contacts whose modes can be listed")
        self.bond = given.of_groups(given.cohesion if cohesion is None else cohesion)
        self.programs = 0
        self.pairs = [np.flatnonzero(given.group == g) for g in range(len(given.friction))]
        where = [model.points[pairs] for pairs in self.pairs]
        along = [((points - points[0]) @ (points[-1] - points[0])).argsort() for points in where]
        self.pairs = [pairs[order] for pairs, order in zip(self.pairs, along, strict=True)]
        self.sums = np.zeros((len(given.friction), len(given.area)))
        self.sums[given.group, np.arange(len(given.area))] = given.friction[given.group]

    def _touching(self, contact: int, ends: str) -> np.ndarray:
        pairs = self.pairs[contact]
        return {"both": pairs, "first": pairs[:1], "last": pairs[-1:], "none": pairs[:0]}[ends]

    def moves(self, modes: tuple[int, ...]) -> bool:
        """Is there a motion on which the loads do work, whose first contacts are in these modes?"""
        given, closed = self.given, np.zeros(len(self.given.area), dtype=bool)
        equal, above = [], []
        for contact, mode in enumerate(modes):
            ends, sign = _MODES[mode]
            closed[self._touching(contact, ends)] = True
            if sign == 0:
                equal.append(given.slip[contact])
            elif sign is not None:
                above.append(-sign * given.slip[contact])
        return self._feasible(
            np.concatenate([-given.normal[~closed], np.reshape(above, (-1, len(given.load)))]),
            0.0,
            np.concatenate(
                [given.normal[closed], np.reshape(equal, (-1, len(given.load))), given.load[None]]
            ),
            np.append(np.zeros(int(closed.sum()) + len(equal)), 1.0),
            (-np.inf, np.inf),
        )

    def carries(self, modes: tuple[int, ...], low: float, high: float) -> bool:
        """Are there forces at a λ between two values, or nearly so: λ may differ from contact to contact?

        A slipping contact has low r <= |T| <= high r, a sticking one |T| <= high r: linear, and more than what is
        there at any one λ. Where nothing is found there is no limit state in these modes.
        """
        given, bond = self.given, self.bond.copy()
        idle, slips = np.zeros(len(given.area), dtype=bool), np.zeros(len(bond))
        for contact, mode in enumerate(modes):
            ends, sign = _MODES[mode]
            idle[np.setdiff1d(self.pairs[contact], self._touching(contact, ends))] = True
            bond[contact] *= ends == "both"  # a contact that opens anywhere has lost its cohesion
            slips[contact] = sign or 0
        one, at = np.eye(len(bond)), slips != 0.0
        rows = [
            np.hstack([-high * self.sums, one]),
            np.hstack([-high * self.sums, -one]),
            np.hstack([low * self.sums, one * slips[:, None]])[at],
        ]
        most = np.concatenate([high * bond, high * bond, -low * bond[at]])
        bounds = (
            np.append(0.0 * idle, np.where(slips < 0.0, 0.0, -np.inf)),
            np.append(np.where(idle, 0.0, np.inf), np.where(slips > 0.0, 0.0, np.inf)),
        )
        balance = np.hstack([given.normal.T, given.slip.T])
        return self._feasible(np.concatenate(rows), most, balance, -given.load, bounds)

    def _feasible(
        self, above: np.ndarray, most: Any, equal: np.ndarray, to: np.ndarray, bounds: Any
    ) -> bool:
        """Is there an x within `bounds` with `above` x <= `most` and `equal` x = `to`? Doubtful ones count as there."""
        self.programs += 1
        least = np.concatenate([np.full(len(above), -np.inf), to])
        rows = LinearConstraint(
            np.concatenate([above, equal]), least, np.append(np.broadcast_to(most, len(above)), to)
        )
        found = milp(np.zeros(equal.shape[1]), constraints=rows, bounds=Bounds(*bounds))
        return bool(found.status != 2)  # 2: proven infeasible

    def listed(self, low: float, high: float, modes: tuple[int, ...] = ()) -> list[tuple[int, ...]]:
        """The modes of all contacts that have a motion and, as far as `carries` knows, forces."""
        if not self.moves(modes) or not self.carries(modes, low, high):
            return []
        if len(modes) == len(self.bond):
            return [modes]
        return [
            found for mode in range(len(_MODES)) for found in self.listed(low, high, (*modes, mode))
        ]

    def edge(self, modes: tuple[int, ...], low: float, high: float, lowest: bool) -> float | None:
        """The first λ from below, or from above, at which `carries` finds forces in an interval of that width."""
        if low >= high or not self.carries(modes, low, high):
            return None
        if high / low < 1.0 + _WIDTH:
            return low if lowest else high
        middle = math.sqrt(low * high)
        halves = [(low, middle), (middle, high)]
        for half in halves if lowest else halves[::-1]:
            found = self.edge(modes, *half, lowest)
            if found is not None:
                return found
        return None


def certified_range(
    model: AssemblyModel, bound: float, least: float = 0.05, cohesion: np.ndarray | None = None
) -> CertifiedRange | None:
    """The range of all limit states of a section of a few blocks from `least` static bounds up; None: there are none.

    A limit state is a motion on which the loads do work, and admissible forces: no contact opens where it is pressed,
    and friction is fully used, against the slip, where it slips. Every contact has ten modes; those whose motion and
    forces are both possible are listed, and for each λ is halved until no limit state is left outside the range.
    """
    contacts = _Contacts(model, cohesion)
    low, high = (1.0 - _WIDTH) / bound, 1.0 / (least * bound)
    modes = contacts.listed(low, high)
    first, last = math.inf, 0.0
    for mode in modes:
        first = min(first, contacts.edge(mode, low, min(first, high), True) or math.inf)
        last = max(last, contacts.edge(mode, max(last, low), high, False) or 0.0)
    if math.isinf(first):
        return None
    return CertifiedRange(1.0 / last, 1.0 / first, len(modes), contacts.programs)


# -- one history ------------------------------------------------------------------------------------------------------

_RESTS = 1e-7  # of a mean load: what a state at rest leaves unbalanced
_RUNS = 30.0  # the work of the loads, in parts of the elastic work, from which an assembly runs
_FALLS = 0.97  # the strength of one step in parts of that of the last
_BRACKET = 2e-3  # between the last strength at rest and the first that runs
_OPENS = 1e-3  # of the fastest opening or slip
_SETTLED = 1e-6  # change of λ while the work of the loads grows tenfold


_PRESSED = 3e-3  # of the load, spread over all pairs: the force from which cohesion acts

_LEAST_KPA, _APART = (
    1e-4,
    1e-6,
)  # traction below which curves are straight, and how far apart slopes are read off

#: The tangent -dR/du (n, n) and dR/dλ (n,), where they are asked for.
Slopes = Callable[[], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class History:
    """Where a history ends: F, the peak (the last F at rest), the opening and slip rates, and how it ended in words."""

    factor: float | None
    peak: float | None
    end: str
    opening: np.ndarray
    slip: np.ndarray
    steps: int


@dataclass(frozen=True)
class State:
    """Displacements and the forces that a history has left in the joints; `along` (g, t) is what was slipped so far."""

    u: np.ndarray
    slipped: np.ndarray
    friction: np.ndarray


def unmoved(given: Arrays) -> State:
    """No displacement, no forces."""
    groups, t = len(given.friction), given.directions
    return State(np.zeros(len(given.load)), np.zeros(groups * t), np.zeros((groups, t)))


class Joints:
    """Joints of unit normal stiffness per area and `stiffness` of that along them, no tension, Coulomb friction."""

    def __init__(self, given: Arrays, cohesion: np.ndarray, stiffness: float) -> None:
        self.given = given
        self.bond = given.of_groups(cohesion)
        self.along = np.repeat(stiffness * given.of_groups(given.area), given.directions)
        self.elastic = (given.normal.T * given.area) @ given.normal + (
            given.slip.T * self.along
        ) @ given.slip
        self.elastic += (
            1e-12 * np.trace(self.elastic) / len(self.elastic) * np.eye(len(self.elastic))
        )
        self.scale = float(np.abs(given.load).max())
        self.work = float(given.load @ np.linalg.solve(self.elastic, given.load))
        self.steps = 0

    def law(
        self, u: np.ndarray, old: State, strength: float
    ) -> tuple[np.ndarray, np.ndarray, Slopes]:
        """Unbalanced forces (n,), friction (g, t), and what gives the tangent -dR/du and dR/dλ."""
        given, t = self.given, self.given.directions
        opening = given.normal @ u
        pressed = given.area * (opening < 0.0)
        normal = -pressed * opening
        trial = old.friction - (self.along * (given.slip @ u)).reshape(-1, t) + self._reached(old)
        limit = np.where(given.bolted & (trial[:, 0] < 0.0), 0.0, self.bond) + given.of_groups(
            self.resists(normal)
        )
        most = strength * limit
        size = np.sqrt((trial * trial).sum(axis=1))
        slips = size > most
        e = trial / np.maximum(size, 1e-300)[:, None]
        friction = np.where(slips[:, None], most[:, None] * e, trial)
        left = given.normal.T @ normal + given.slip.T @ friction.ravel() + given.load

        def slopes() -> tuple[np.ndarray, np.ndarray]:
            closing = pressed[:, None] * given.normal
            part = np.where(slips, most / np.maximum(size, 1e-300), 1.0)
            away = np.where(slips, 1.0, 0.0)[:, None, None] * e[:, :, None] * e[:, None]
            turn = part[:, None, None] * (np.eye(t) - away)
            rows = (self.along[:, None] * given.slip).reshape(len(limit), t, -1)
            tangent = given.normal.T @ closing + given.slip.T @ np.matmul(turn, rows).reshape(
                len(given.slip), -1
            )
            sums = np.zeros((len(limit), len(u)))
            np.add.at(sums, given.group, self.follows(normal)[:, None] * closing)
            pull = (e * (slips * strength)[:, None])[:, :, None] * sums[:, None, :]
            tangent += given.slip.T @ pull.reshape(len(given.slip), -1)
            return tangent, given.slip.T @ (e * (slips * limit)[:, None]).ravel()

        return left, friction, slopes

    def resists(self, normal: np.ndarray) -> np.ndarray:
        """What friction makes of normal forces (m,), (m,)."""
        return self.given.friction[self.given.group] * normal

    def follows(self, normal: np.ndarray) -> np.ndarray:
        """How that changes with them, (m,)."""
        return self.given.friction[self.given.group]

    def _reached(self, old: State) -> np.ndarray:
        return (self.along * old.slipped).reshape(old.friction.shape)

    def step(
        self,
        old: State,
        strength: float,
        viscosity: float,
        work: float | None = None,
        guess: np.ndarray | None = None,
    ) -> tuple[State, float, float] | None:
        """One step in time, R(u) = η K (u - u_old), at a strength or, with λ free, at a work of the loads.

        Returns the state, λ and what the viscous forces are at most; None where Newton's method does not get there.
        """
        load, u, drag = self.given.load, old.u if guess is None else guess, viscosity * self.elastic
        best, there = math.inf, self.law(u, old, strength)
        for _ in range(25):
            self.steps += 1
            left, friction, slopes = there
            viscous = drag @ (u - old.u)
            off = left - viscous
            miss = 0.0 if work is None else work - float(load @ u)
            size = float(np.abs(off).max())
            if size < 1e-9 * self.scale and abs(miss) <= 1e-9 * abs(work or 1.0):
                return (
                    State(u, self.given.slip @ u, friction),
                    strength,
                    float(np.abs(viscous).max()),
                )
            if size > 1e6 * best:
                return None
            best = min(best, size)
            tangent, rate = slopes()
            try:
                both = np.linalg.solve(
                    tangent + drag + 1e-13 * self.elastic, np.stack([off, rate], axis=1)
                )
            except np.linalg.LinAlgError:
                return None
            change, more = both[:, 0], 0.0
            if work is not None:
                works = float(load @ both[:, 1])
                more = (miss - float(load @ both[:, 0])) / works if works else math.inf
                if not abs(more) < 0.5 * strength:
                    return None
                change = both[:, 0] + more * both[:, 1]
            whole, least = 1.0, (math.inf, u, strength, there)
            while (
                whole > 0.05
            ):  # the longest of the halved steps that lowers what is left, or the best of them
                beyond, to = u + whole * change, strength + whole * more
                found = self.law(beyond, old, to)
                after = float(np.abs(found[0] - drag @ (beyond - old.u)).max())
                least = min(least, (after, beyond, to, found), key=lambda one: one[0])
                if least[0] < (1.0 - 0.1 * whole) * max(size, 1e-8 * self.scale):
                    break
                whole *= 0.5
            _, u, strength, there = least
        return None

    def rest(
        self, old: State, strength: float, onward: bool = False
    ) -> tuple[State, str, float, State]:
        """Flow at a strength until it rests or runs: the state, which, the last viscosity and the state before.

        Work by which it runs counts from no displacement, or with `onward` from the old state.
        """
        state, before, viscosity = old, old, 1e-2
        done = float(self.given.load @ old.u) if onward else 0.0
        for _ in range(200):
            found = self.step(state, strength, viscosity)
            if found is None:
                viscosity *= 8.0
                if viscosity > 1e4:
                    return state, "lost", viscosity, before
                continue
            before, state = state, found[0]
            if found[2] < _RESTS * self.scale:
                return state, "rests", viscosity, before
            if float(self.given.load @ state.u) - done > _RUNS * self.work:
                return state, "runs", viscosity, before
            viscosity = max(0.3 * viscosity, 1e-9)
        return state, "lost", viscosity, before


class CurvedJoints(Joints):
    """The same whose pairs have a curved law all over: its strength τ(σ) (kPa) and, by differences, its slope."""

    def __init__(
        self,
        given: Arrays,
        stiffness: float,
        shear: Callable[[np.ndarray], np.ndarray],
        kpa: np.ndarray,
    ) -> None:
        """`kpa` (m,) is the normal force of each pair at a traction of one kPa."""
        self._shear, self._kpa = shear, kpa
        super().__init__(given, kpa * shear(np.zeros(len(kpa))), stiffness)

    def resists(self, normal: np.ndarray) -> np.ndarray:
        """What friction makes of normal forces (m,), (m,)."""
        return self._kpa * (self._shear(normal / self._kpa) - self._shear(np.zeros(len(normal))))

    def follows(self, normal: np.ndarray) -> np.ndarray:
        """How that changes with them, (m,)."""
        at = np.maximum(normal / self._kpa, _LEAST_KPA)
        return (self._shear(at * (1.0 + _APART)) - self._shear(at * (1.0 - _APART))) / (
            2.0 * _APART * at
        )


class PressedJoints(Joints):
    """The same whose cohesion acts at pairs that are pressed: all of it from some thousandths of a mean force on."""

    def __init__(self, given: Arrays, stiffness: float) -> None:
        super().__init__(given, np.zeros_like(given.cohesion), stiffness)
        self._cohesion, self._full = (
            given.cohesion,
            _PRESSED * self.scale * given.area / given.area.sum(),
        )

    def resists(self, normal: np.ndarray) -> np.ndarray:
        return super().resists(normal) + self._cohesion * np.tanh(normal / self._full)

    def follows(self, normal: np.ndarray) -> np.ndarray:
        return (
            super().follows(normal)
            + self._cohesion / self._full / np.cosh(np.minimum(normal / self._full, 50.0)) ** 2
        )


def history(
    model: AssemblyModel,
    start: float,
    stiffness: float = 0.4,
    cohesion: np.ndarray | None = None,
    bed: Joints | None = None,
) -> History:
    """The limit state of one history: loads come on at strengths λ = `start`, which then go down slowly.

    Joints are elastic without tension, their slip is incremental: what slipped stays slipped. Every state is reached by
    viscous flow. When the assembly runs, λ is freed and the work of the loads grows until λ stays.

    Trust the factor where it `end`s "settled". Dry walls near tipping often do not: some come to rest only at many
    times their friction, and lose their way from there.
    """
    given = arrays_of(model)
    bed = bed or Joints(given, given.cohesion if cohesion is None else cohesion, stiffness)
    groups, t = len(given.friction), given.directions
    state = unmoved(given)
    nothing = np.zeros(len(given.area)), np.zeros((groups, t))
    for _ in range(8):
        found, how, _, _ = bed.rest(state, start)
        if how == "rests":
            break
        start *= 2.0
    else:
        return History(None, None, "no rest at the start", *nothing, bed.steps)
    state, strength, ratio = found, start, _FALLS
    while True:
        trial = ratio * strength
        found, how, viscosity, before = bed.rest(state, trial)
        if how == "rests":
            state, strength = found, trial
            if strength < 1e-4 * start:
                return History(math.inf, None, "stands", *nothing, bed.steps)
        elif 1.0 - ratio < _BRACKET:
            break
        else:
            ratio = math.sqrt(ratio)
    if how != "runs":
        return History(None, 1.0 / strength, "lost its way at the peak", *nothing, bed.steps)
    return _settled(bed, found, before, trial, viscosity, 1.0 / strength)


def _settled(
    bed: Joints, state: State, before: State, strength: float, viscosity: float, peak: float
) -> History:
    """From a running state: viscosity goes, the work of the loads grows, λ follows."""
    load, given = bed.given.load, bed.given
    work, done = float(load @ state.u), float(load @ (state.u - before.u))
    grows, fades, marks, end = 1.3, 0.5, [(work, strength)], "not settled"
    motion = state.u - before.u
    for _ in range(400):
        wanted = work * grows
        slower = fades * viscosity * done / (wanted - work)
        found = bed.step(
            state, strength, slower, wanted, state.u + motion * ((wanted - work) / done)
        )
        if found is None:
            grows, fades = grows**0.5, fades**0.5
            if grows < 1.0 + 1e-5:
                end = "lost its way running"
                break
            continue
        motion, done, viscosity = found[0].u - state.u, wanted - work, slower
        state, strength, left = found
        work = wanted
        marks.append((work, strength))
        grows, fades = min(grows**1.2, 2.0), max(0.9 * fades, 0.2)
        earlier = [value for at, value in marks if at < work / 10.0]
        if earlier and abs(strength / earlier[-1] - 1.0) < _SETTLED and left < 1e-6 * bed.scale:
            end = "settled"
            break
        if work > 1e9 * bed.work:
            break
    rates = given.normal @ motion, (given.slip @ motion).reshape(-1, given.directions)
    return History(1.0 / strength, peak, end, *rates, bed.steps)


def with_bonds(
    model: AssemblyModel, start: float, stiffness: float = 0.4
) -> tuple[History, np.ndarray]:
    """`history` again and again: a contact that opens anywhere in the last motion loses all its cohesion for good.

    Not the rule of `many_blocks.bonds`, where bonds come back or are kept: it ends at the same limit where each motion
    opens what the last one leaves open, and else below it. `breaking` is the judge of what falling strength comes to.
    """
    given = arrays_of(model)
    cohesion = given.cohesion.copy()
    while True:
        found = history(model, start, stiffness, cohesion)
        opens = found.opening > _OPENS * max(
            float(np.abs(found.opening).max()), float(np.abs(found.slip).max())
        )
        lost = np.isin(given.contact, given.contact[opens]) & (cohesion > 0.0)
        if not lost.any():
            return found, cohesion
        cohesion[lost] = 0.0


def breaking(
    model: AssemblyModel, start: float, stiffness: float = 0.4
) -> tuple[float, float, np.ndarray]:
    """The last F at rest and the first that is not of a history whose bonds break for good, and what cohesion is left.

    Strength goes down as in `history`. A contact that no pair of it presses at rest has lost all of its cohesion from
    then on, and the blocks come to rest again at the same strength, or run. What the motion opens that they end in
    counts with its cohesion: a limit that leaves it out lies below.
    """
    given = arrays_of(model)
    cohesion, contacts = given.cohesion.copy(), len(model.plus)
    state, strength, ratio = unmoved(given), start, 1.0

    def settled(
        state: State, strength: float, cohesion: np.ndarray
    ) -> tuple[State, str, np.ndarray]:
        while True:
            found, how, _, _ = Joints(given, cohesion, stiffness).rest(state, strength, onward=True)
            presses = np.bincount(given.contact, given.normal @ found.u < 0.0, contacts) > 0
            breaks = ~presses[given.contact] & (cohesion > 0.0)
            if how != "rests" or not breaks.any():
                return found, how, cohesion
            state, cohesion = found, np.where(breaks, 0.0, cohesion)

    while True:
        found, how, left = settled(state, ratio * strength, cohesion)
        if how == "rests":
            state, strength, cohesion = found, ratio * strength, left
            ratio = _FALLS if ratio == 1.0 else ratio
        elif ratio == 1.0 or 1.0 - ratio < _BRACKET:
            return 1.0 / strength, 1.0 / (ratio * strength), cohesion
        else:
            ratio = math.sqrt(ratio)
