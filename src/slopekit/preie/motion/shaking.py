"""One rigid block on shaken bedrock: PRE-IE with mass, six degrees of freedom (three in a section).

    M γ̈ = P + M a + Bᵀ f(d, s),    d = B γ

γ is the motion relative to bedrock, a(t) the inertial acceleration (opposite to that of the ground), f the forces of
springs of the node pairs with Coulomb's law and a memory s of past slip. Implicit Euler, Newton's method with a
line search; the geometry stays as it is. A step that does not converge is halved repeatedly, and where that does
not help the run ends before it. The work of each step is added up: the work of the loads equals stored and kinetic
energy, dissipation by friction, and damping by implicit Euler.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from slopekit.core.arrays import Bools, Floats, frozen
from slopekit.preie.motion.equilibrium import MOST_RELEASES, equilibrium
from slopekit.preie.solvers.newton import newton_equilibrium
from slopekit.preie.system.contact import (
    CloughDuncan,
    ContactMode,
    JointStiffness,
    Tractions,
    breaks,
    tractions,
)
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import EQUILIBRIUM, PARALLEL

_MOST_HALVINGS = 12  # of a step of the record, before it is refused
_AT_REST = 1e-4  # m/s of the fastest node pair after the record
_MOST_AFTER = 20.0  # s after the end of the record


@dataclass(frozen=True)
class Work:
    """Work from rest to rest, kJ; `unbalanced` is the input less all other terms."""

    JSON_ALSO: ClassVar = ("unbalanced",)
    put_in: float
    friction: float
    stored: float
    kinetic: float
    damped: float

    @property
    def unbalanced(self) -> float:
        """Input less all other terms, kJ."""
        return self.put_in - self.friction - self.stored - self.kinetic - self.damped


@dataclass(frozen=True)
class Shake:
    """Response of a block to one ground motion.

    Attributes
    ----------
    times : (m,) s; motion : (m, u) m and radians, of the centroid against bedrock, from rest under the static loads
    slipped, opened : shares of the joints' area that have slipped, and largest share open at one time
    debonded : share of the area that has lost its cohesion by opening
    steps : number of steps taken; halved : number of halvings
    ended : "rest", or without it "moves" (at the end of the time limit) or "refused" (a step did not converge)
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
    model: Model,
    mass_t: float,
    inertia: Floats,
    stiffness: JointStiffness,
    residual: tuple[Floats, Floats] | None,
) -> ShakenBlock | None:
    """Return the block of a model with its mass, at rest under its loads; None where it does not come to rest.

    Parameters
    ----------
    inertia : (3, 3) t m² about the centroid
    stiffness : of the joints, its tangential one is a number
    residual : c (kPa) and tan φ of each interface after slip
    """
    rest_state = equilibrium(model, 1.0, stiffness)
    if not rest_state.is_balanced:
        return None
    section = model.translations == 2
    scale = np.where(np.arange(model.unknowns) < model.translations, 1.0, model.length_scale)
    area = model.control_area * model.area_scale
    turning = inertia[1:2, 1:2] if section else inertia
    mass = np.zeros((model.unknowns, model.unknowns))
    mass[: model.translations, : model.translations] = mass_t * np.eye(model.translations)
    mass[model.translations :, model.translations :] = turning
    rows = model.rows * scale
    relative = (rows.reshape(-1, model.unknowns) @ rest_state.displacement).reshape(-1, 3)
    slipped = relative[:, 1:] + rest_state.forces[:, 1:] / (
        _shear_stiffness(stiffness) * area[:, None]
    )
    per_area = model.force_scale / area
    residual_strength = (
        None if residual is None else (residual[0][model.interface], residual[1][model.interface])
    )
    return ShakenBlock(
        frozen(rows),
        frozen(area),
        frozen(model.cohesion * per_area),
        frozen(model.tension * per_area),
        model.tan_friction,
        residual_strength,
        frozen(mass),
        frozen(model.load * model.force_scale * scale),
        stiffness,
        model.translations,
        (rest_state.displacement, slipped, rest_state.debonded),
    )


def _shear_stiffness(stiffness: JointStiffness) -> float:
    """Return k_t, kN/m³, which is constant while a block is shaken."""
    assert not isinstance(stiffness.tangential, CloughDuncan)
    return stiffness.tangential


@dataclass(frozen=True)
class _Motion:
    """State of a block: displacement (u,), velocity (u,), slip memory (n, 2), lost bonds (n,), slipped pairs (n,)."""

    displacement: Floats
    velocity: Floats
    memory: Floats
    debonded: Bools
    slid: Bools
    law: Tractions


def shake(
    block: ShakenBlock, step: float, pushes: Floats, advance: Callable[[int], None] = lambda _: None
) -> Shake:
    """Return the response of a block to a ground motion.

    Parameters
    ----------
    step : s; pushes : (m, translations) m/s², the mean of each step
    advance : called with 1 after every step

    Implicit Euler damps a spring by half its angular frequency times the step, in parts of the critical damping: with
    ω step about 1 the springs follow and do not ring. Undamped they would make a block slip earlier.
    """
    origin, memory, debonded = block.at_rest
    none: Bools = np.zeros(len(block.area), dtype=bool)
    state = _Motion(
        origin,
        np.zeros(block.unknowns),
        memory,
        debonded,
        none,
        _law(block, origin, memory, debonded, none),
    )
    motion, work = [np.zeros(block.unknowns)], np.zeros(5)
    steps = halved = 0
    opened, ended = 0.0, ""

    def advance_state(push: Floats) -> bool:
        """Take one step of the record, halved as often as needed; return whether it converged."""
        nonlocal state, steps, halved, opened, work
        done, fraction = 0.0, 1.0
        while done < 1.0:
            next_state = _step(block, state, fraction * step, push)
            if next_state is None:
                halved += 1
                fraction *= 0.5
                if fraction < 0.5**_MOST_HALVINGS:
                    return False
                continue
            work += _work(block, state, next_state, push)
            state, done, steps = next_state, done + fraction, steps + 1
            opened = max(opened, float(block.area[state.law.modes == ContactMode.DEBOND].sum()))
        motion.append(state.displacement - origin)
        return True

    for push in pushes:
        if not advance_state(push):
            ended = "refused"
            break
        advance(1)
    quiet, quiet_steps = np.zeros(block.translations), 0
    rows = block.rows.reshape(-1, block.unknowns)
    while (
        not ended and float(np.abs(rows @ state.velocity).max()) > _AT_REST
    ):  # m/s, of the fastest node pair
        quiet_steps += 1
        if quiet_steps * step > _MOST_AFTER:
            ended = "moves"
        elif not advance_state(quiet):
            ended = "refused"
    area = float(block.area.sum())
    return Shake(
        frozen(step * np.arange(len(motion))),
        frozen(motion),
        float(block.area[state.slid].sum()) / area,
        opened / area,
        float(block.area[state.debonded].sum()) / area,
        steps,
        halved,
        ended or "rest",
        Work(*(float(energy) for energy in work)),
    )


def _law(
    block: ShakenBlock, displacement: Floats, memory: Floats, debonded: Bools, slid: Bools
) -> Tractions:
    relative = (block.rows.reshape(-1, block.unknowns) @ displacement).reshape(-1, 3)
    relative[:, 1:] -= memory
    cohesion, friction = block.cohesion, block.tan_friction
    if block.residual is not None:
        cohesion = np.where(slid, block.residual[0], cohesion)
        friction = np.where(slid, block.residual[1], friction)
    return tractions(
        relative, block.stiffness, cohesion, friction, np.zeros_like(friction), 1.0, debonded
    )


def _step(block: ShakenBlock, state: _Motion, length: float, push: Floats) -> _Motion | None:
    """Return the state one step later; None where it does not converge."""
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
            displacement = state.displacement + length * velocity
            relative = (block.rows.reshape(-1, block.unknowns) @ displacement).reshape(-1, 3)
            memory = relative[:, 1:] + law.tractions[:, 1:] / _shear_stiffness(block.stiffness)
            return _Motion(
                displacement,
                velocity,
                memory,
                debonded,
                state.slid | (law.modes == ContactMode.SLIP),
                law,
            )
        debonded = debonded | broken
    return None


def _newton(
    block: ShakenBlock,
    state: _Motion,
    length: float,
    load: Floats,
    size: float,
    debonded: Bools,
    start: Floats,
) -> tuple[Floats, Tractions] | None:
    """Return the velocity (u,) at the end of a step, with its tractions; None without convergence."""
    flat, areas = block.rows.reshape(-1, block.unknowns), block.area[:, None]
    arms = np.ones(block.unknowns)  # moments are divided by radii of gyration (m), forces by one
    turns = np.diag(block.mass)[block.translations :]
    arms[block.translations :] = np.maximum(np.sqrt(turns / block.mass[0, 0]), PARALLEL)

    def unbalanced(velocity: Floats) -> tuple[Floats, Tractions]:
        law = _law(
            block, state.displacement + length * velocity, state.memory, debonded, state.slid
        )
        residual = (
            block.mass @ (velocity - state.velocity) / length
            - load
            - (law.tractions * areas).ravel() @ flat
        )
        return residual / arms, law

    def slopes(_: Floats, law: Tractions) -> Floats:
        area_slopes = np.matmul(law.slopes * areas[:, :, None], block.rows).reshape(
            -1, block.unknowns
        )
        matrix: Floats = (block.mass / length - length * (flat.T @ area_slopes)) / arms[:, None]
        return matrix

    velocity, law, error = newton_equilibrium(unbalanced, slopes, start, EQUILIBRIUM * size)
    return (velocity, law) if error <= EQUILIBRIUM * size else None


def _work(block: ShakenBlock, start: _Motion, end: _Motion, push: Floats) -> Floats:
    """Return input, friction, stored, kinetic and damped work (5,) of one step, kJ, each from its own quantities."""
    load = block.load.copy()
    load[: block.translations] += block.mass[: block.translations, : block.translations] @ push
    displacement = end.displacement - start.displacement
    gained = end.velocity - start.velocity
    give = np.array([block.stiffness.normal, *[_shear_stiffness(block.stiffness)] * 2])
    f0, f1 = start.law.tractions, end.law.tractions
    area = block.area[:, None]
    stored = 0.5 * (area * (f1 * f1 - f0 * f0) / give).sum()
    sprung = 0.5 * (area * (f1 - f0) ** 2 / give).sum()
    friction = -(area * f1[:, 1:] * (end.memory - start.memory)).sum()
    relative = block.rows.reshape(-1, block.unknowns) @ displacement
    gap = (
        relative.reshape(-1, 3)[:, 0] + (f1[:, 0] - f0[:, 0]) / block.stiffness.normal
    )  # change of the gap of open pairs
    knocked = -(block.area * f1[:, 0] * gap).sum()
    kinetic = 0.5 * (
        end.velocity @ block.mass @ end.velocity - start.velocity @ block.mass @ start.velocity
    )
    return np.array(
        [
            load @ displacement,
            friction,
            stored,
            kinetic,
            sprung + knocked + 0.5 * gained @ block.mass @ gained,
        ]
    )


def inertia_of(faces: list[Floats], centroid: Floats) -> tuple[float, Floats]:
    """Return volume and inertia (3, 3) about the centroid, per unit of density, of a body of flat faces.

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
            tetrahedron = float(np.linalg.det(corners)) / 6.0
            volume += tetrahedron
            total = corners.sum(axis=0)
            moment += tetrahedron / 20.0 * (corners.T @ corners + np.outer(total, total))
    return volume, np.trace(moment) * np.eye(3) - moment
