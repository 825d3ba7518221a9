"""One rigid block on shaken bedrock: PRE-IE with mass, six degrees of freedom (three in a section).

    M γ̈ = P + M a + Bᵀ f(d, s),    d = B γ

γ is the motion against bedrock, a(t) how the shaking pushes a unit of mass (the ground moves the other way), f the
springs of the node pairs with Coulomb's law and a memory s of what has slipped. Implicit Euler, Newton's method with a
line search; the geometry stays as it is. A step that does not settle is halved, again and again, and where that does
not help the run ends there: it is never taken. The work of each step is added up: what the loads put in is what is
stored, moves, is lost in friction, and what implicit Euler damps.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from slopekit.core.arrays import Bools, Floats, frozen
from slopekit.preie.motion.equilibrium import MOST_RELEASES, equilibrium
from slopekit.preie.solvers.newton import balanced
from slopekit.preie.system.contact import CloughDuncan, ContactMode, JointStiffness, Tractions, breaks, tractions
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import EQUILIBRIUM, PARALLEL

_MOST_HALVINGS = 12  # of a step of the record, before it is refused
_AT_REST = 1e-4  # m/s of the fastest node pair after the record
_MOST_AFTER = 20.0  # s after the end of the record


@dataclass(frozen=True)
class Work:
    """Work from rest to rest, kJ; `unbalanced` is what the others leave of the input."""

    JSON_ALSO: ClassVar = ("unbalanced",)
    put_in: float
    friction: float
    stored: float
    kinetic: float
    damped: float

    @property
    def unbalanced(self) -> float:
        """Input less all the others."""
        return self.put_in - self.friction - self.stored - self.kinetic - self.damped


@dataclass(frozen=True)
class Shake:
    """What comes of one shaking.

    Attributes
    ----------
    times : (m,) s; motion : (m, u) m and radians, of the centroid against bedrock, from rest under the static loads
    slipped, opened : shares of the joints' area that have slipped, and that were open at once at most
    debonded : share that has lost its cohesion by opening
    steps : that were taken; halved : that had to be made shorter
    ended : rest, or why not: moves (still, when it was given up), refused (a step did not settle)
    work : from the state at rest before the shaking
    """

    times: Floats
    motion: Floats
    slipped: float
    opened: float
    debonded: float
    steps: int
    halved: int
    ended: str
    work: Work


@dataclass(frozen=True)
class ShakenBlock:
    """A block in m, kN and t.

    Attributes
    ----------
    rows : (n, 3, u) relative displacement of the node pairs by the unknowns; area : (n,) m²
    cohesion, tension : (n,) kPa; tan_friction : (n,); residual : c and tan φ (n,) after slip, None where they stay
    mass : (u, u) t, t m²; load : (u,) kN, kNm; stiffness : with a constant shear stiffness
    translations : how many unknowns are translations
    at_rest : displacement (u,), slip memory (n, 2) and lost bonds (n,) under the static loads
    """

    rows: Floats
    area: Floats
    cohesion: Floats
    tension: Floats
    tan_friction: Floats
    residual: tuple[Floats, Floats] | None
    mass: Floats
    load: Floats
    stiffness: JointStiffness
    translations: int
    at_rest: tuple[Floats, Floats, Bools]

    @property
    def unknowns(self) -> int:
        """Number of unknowns."""
        return int(self.rows.shape[2])


def shaken_block(
    model: Model, mass_t: float, inertia: Floats, stiffness: JointStiffness, residual: tuple[Floats, Floats] | None
) -> ShakenBlock | None:
    """The block of a model with its mass, at rest under its loads; None where it does not come to rest.

    Parameters
    ----------
    inertia : (3, 3) t m² about the centroid
    stiffness : its tangential one is a number
    residual : c (kPa) and tan φ of each interface after slip
    """
    still = equilibrium(model, 1.0, stiffness)
    if not still.stands:
        return None
    section = model.translations == 2
    scale = np.where(np.arange(model.unknowns) < model.translations, 1.0, model.length_scale)
    area = model.control_area * model.area_scale
    turning = inertia[1:2, 1:2] if section else inertia
    mass = np.zeros((model.unknowns, model.unknowns))
    mass[: model.translations, : model.translations] = mass_t * np.eye(model.translations)
    mass[model.translations :, model.translations :] = turning
    rows = model.rows * scale
    relative = (rows.reshape(-1, model.unknowns) @ still.displacement).reshape(-1, 3)
    slipped = relative[:, 1:] + still.forces[:, 1:] / (_shear_stiffness(stiffness) * area[:, None])
    per_area = model.force_scale / area
    after = None if residual is None else (residual[0][model.interface], residual[1][model.interface])
    return ShakenBlock(
        frozen(rows), frozen(area), frozen(model.cohesion * per_area), frozen(model.tension * per_area),
        model.tan_friction, after, frozen(mass), frozen(model.load * model.force_scale * scale), stiffness,
        model.translations, (still.displacement, slipped, still.debonded),
    )  # fmt: skip


def _shear_stiffness(stiffness: JointStiffness) -> float:
    """k_t, kN/m³: a block is shaken on springs whose k_t is constant."""
    assert not isinstance(stiffness.tangential, CloughDuncan)
    return stiffness.tangential


@dataclass(frozen=True)
class _Motion:
    """Where a block is: displacement (u,), velocity (u,), slip memory (n, 2), lost bonds (n,), which have slipped."""

    at: Floats
    velocity: Floats
    memory: Floats
    debonded: Bools
    slid: Bools
    law: Tractions


def shake(block: ShakenBlock, step: float, pushes: Floats, advance: Callable[[int], None] = lambda _: None) -> Shake:
    """Shake a block.

    Parameters
    ----------
    step : s; pushes : (m, translations) m/s², the mean of each step
    advance : told of every step

    Implicit Euler damps a spring by half its angular frequency times the step, in parts of the critical damping: with
    ω step about 1 the springs follow and do not ring. Undamped they would make a block slip earlier.
    """
    at, memory, debonded = block.at_rest
    none: Bools = np.zeros(len(block.area), dtype=bool)
    state = _Motion(at, np.zeros(block.unknowns), memory, debonded, none, _law(block, at, memory, debonded, none))
    motion, work = [np.zeros(block.unknowns)], np.zeros(5)
    steps = halved = 0
    opened, ended = 0.0, ""

    def onward(push: Floats) -> bool:
        """One step, in as many parts as it takes."""
        nonlocal state, steps, halved, opened, work
        done, part = 0.0, 1.0
        while done < 1.0:
            after = _step(block, state, part * step, push)
            if after is None:
                halved += 1
                part *= 0.5
                if part < 0.5**_MOST_HALVINGS:
                    return False
                continue
            work += _work(block, state, after, push)
            state, done, steps = after, done + part, steps + 1
            opened = max(opened, float(block.area[state.law.modes == ContactMode.DEBOND].sum()))
        motion.append(state.at - at)
        return True

    for push in pushes:
        if not onward(push):
            ended = "refused"
            break
        advance(1)
    quiet, after_it = np.zeros(block.translations), 0
    rows = block.rows.reshape(-1, block.unknowns)
    while not ended and float(np.abs(rows @ state.velocity).max()) > _AT_REST:  # m/s, of the fastest node pair
        after_it += 1
        if after_it * step > _MOST_AFTER:
            ended = "moves"
        elif not onward(quiet):
            ended = "refused"
    whole = float(block.area.sum())
    return Shake(
        frozen(step * np.arange(len(motion))), frozen(motion), float(block.area[state.slid].sum()) / whole,
        opened / whole, float(block.area[state.debonded].sum()) / whole, steps, halved, ended or "rest",
        Work(*(float(part) for part in work)),
    )  # fmt: skip


def _law(block: ShakenBlock, at: Floats, memory: Floats, debonded: Bools, slid: Bools) -> Tractions:
    relative = (block.rows.reshape(-1, block.unknowns) @ at).reshape(-1, 3)
    relative[:, 1:] -= memory
    cohesion, friction = block.cohesion, block.tan_friction
    if block.residual is not None:
        cohesion = np.where(slid, block.residual[0], cohesion)
        friction = np.where(slid, block.residual[1], friction)
    return tractions(relative, block.stiffness, cohesion, friction, np.zeros_like(friction), 1.0, debonded)


def _step(block: ShakenBlock, state: _Motion, length: float, push: Floats) -> _Motion | None:
    """The state one step later; None where it does not settle."""
    load = block.load.copy()
    load[: block.translations] += block.mass[: block.translations, : block.translations] @ push
    size = float(np.abs(block.load).max() + np.abs(load).max())
    debonded, velocity = state.debonded, state.velocity
    for _ in range(MOST_RELEASES):
        settled = _newton(block, state, length, load, size, debonded, velocity)
        if settled is None:
            return None
        velocity, law = settled
        rounding = EQUILIBRIUM * size / float(block.area.sum())
        broken: Bools = ~debonded & breaks(law, block.tension, 1.0, rounding)
        if not broken.any():
            at = state.at + length * velocity
            relative = (block.rows.reshape(-1, block.unknowns) @ at).reshape(-1, 3)
            memory = relative[:, 1:] + law.tractions[:, 1:] / _shear_stiffness(block.stiffness)
            return _Motion(at, velocity, memory, debonded, state.slid | (law.modes == ContactMode.SLIP), law)
        debonded = debonded | broken
    return None


def _newton(
    block: ShakenBlock, state: _Motion, length: float, load: Floats, size: float, debonded: Bools, start: Floats
) -> tuple[Floats, Tractions] | None:  # fmt: skip
    """Velocity at the end of a step, with its tractions."""
    flat, areas = block.rows.reshape(-1, block.unknowns), block.area[:, None]
    arms = np.ones(block.unknowns)  # moments in kN: by the size of the block
    turns = np.diag(block.mass)[block.translations :]
    arms[block.translations :] = np.maximum(np.sqrt(turns / block.mass[0, 0]), PARALLEL)

    def unbalanced(velocity: Floats) -> tuple[Floats, Tractions]:
        law = _law(block, state.at + length * velocity, state.memory, debonded, state.slid)
        out = block.mass @ (velocity - state.velocity) / length - load - (law.tractions * areas).ravel() @ flat
        return out / arms, law

    def slopes(_: Floats, law: Tractions) -> Floats:
        own = np.matmul(law.slopes * areas[:, :, None], block.rows).reshape(-1, block.unknowns)
        matrix: Floats = (block.mass / length - length * (flat.T @ own)) / arms[:, None]
        return matrix

    velocity, law, off = balanced(unbalanced, slopes, start, EQUILIBRIUM * size)
    return (velocity, law) if off <= EQUILIBRIUM * size else None


def _work(block: ShakenBlock, before: _Motion, after: _Motion, push: Floats) -> Floats:
    """Put in, friction, stored, kinetic, damped in one step, kJ; each from its own quantities."""
    load = block.load.copy()
    load[: block.translations] += block.mass[: block.translations, : block.translations] @ push
    moved = after.at - before.at
    gained = after.velocity - before.velocity
    give = np.array([block.stiffness.normal, *[_shear_stiffness(block.stiffness)] * 2])
    f0, f1 = before.law.tractions, after.law.tractions
    area = block.area[:, None]
    stored = 0.5 * (area * (f1 * f1 - f0 * f0) / give).sum()
    sprung = 0.5 * (area * (f1 - f0) ** 2 / give).sum()
    friction = -(area * f1[:, 1:] * (after.memory - before.memory)).sum()
    relative = block.rows.reshape(-1, block.unknowns) @ moved
    gap = relative.reshape(-1, 3)[:, 0] + (f1[:, 0] - f0[:, 0]) / block.stiffness.normal  # that opened or closed
    knocked = -(block.area * f1[:, 0] * gap).sum()
    kinetic = 0.5 * (after.velocity @ block.mass @ after.velocity - before.velocity @ block.mass @ before.velocity)
    return np.array([load @ moved, friction, stored, kinetic, sprung + knocked + 0.5 * gained @ block.mass @ gained])


def inertia_of(faces: list[Floats], centroid: Floats) -> tuple[float, Floats]:
    """Volume and inertia (3, 3) about the centroid, per unit of density, of a body of flat faces.

    Parameters
    ----------
    faces : (k, 3) corners each, anticlockwise seen from outside

    >>> cube = [[[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]], [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
    ...         [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]], [[0, 1, 0], [0, 1, 1], [1, 1, 1], [1, 1, 0]],
    ...         [[0, 0, 0], [0, 0, 1], [0, 1, 1], [0, 1, 0]], [[1, 0, 0], [1, 1, 0], [1, 1, 1], [1, 0, 1]]]
    >>> volume, inertia = inertia_of([np.array(face, dtype=float) for face in cube], np.full(3, 0.5))
    >>> round(volume, 12), (6.0 * inertia).round(12).tolist()
    (1.0, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    """
    volume, moment = 0.0, np.zeros((3, 3))
    for face in faces:
        p = face - centroid
        for k in range(1, len(p) - 1):  # tetrahedra from the centroid
            corners = np.stack([p[0], p[k], p[k + 1]])
            part = float(np.linalg.det(corners)) / 6.0
            volume += part
            total = corners.sum(axis=0)
            moment += part / 20.0 * (corners.T @ corners + np.outer(total, total))
    return volume, np.trace(moment) * np.eye(3) - moment
