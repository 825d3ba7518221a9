"""Records in six degrees of freedom: the block of a design on its springs, shaken both ways, with its work.

Sliding one way, rigid, is integrated exactly (Newmark 1965). While the block slides its acceleration against the base
is κ (a(t) - a_y); the record is linear between its samples, so the velocity is a quadratic there and the displacement a
cubic. With V the integral of κ (a - a_y), v(t) = V(t) - min over s <= t of V(s): a block at rest starts where V is at
its lowest, and stops where V is back there. Nothing is stepped.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.errors import DesignError, Fault, fail
from slopekit.core.orientation import number
from slopekit.design.common import Design
from slopekit.design.parts import Strength
from slopekit.design.reading.files import with_values
from slopekit.kinds import cut
from slopekit.kinds.single_block.one_block_limit import Cut
from slopekit.kinds.solver_inputs import joint_stiffness
from slopekit.preie.motion.shaking import Shake, ShakenBlock, Work, inertia_of, shake, shaken_block
from slopekit.preie.system.contact import SHEAR_TO_NORMAL, JointStiffness
from slopekit.studies.quake.records import Record
from slopekit.studies.quake.yielding import KEY


class RecordSlide(NamedTuple):
    """Sliding of a rigid block in one record.

    Attributes
    ----------
    displacement_m : in all, what it slides on after the end of the record too
    after_m : of that after the end
    velocity, displacement : (n,) m/s and m at the samples
    """

    displacement_m: float
    after_m: float
    velocity: Floats
    displacement: Floats


def slide(times: Floats, accelerations: Floats, yield_acceleration: float) -> RecordSlide:
    """Sliding of a block with κ = 1; with another κ velocity and displacement are κ times as large.

    Parameters
    ----------
    times : (n,) s, never falling; accelerations : (n,) m/s² as they push the block, linear between
    yield_acceleration : a_y > 0, m/s²

    >>> pulse = np.array([0.0, 0.0, 0.3, 0.3]), np.array([0.0, 0.5, 0.5, 0.0]) * 9.80665
    >>> round(slide(*pulse, 0.1 * 9.80665).displacement_m, 6)  # V²/(2 g N) (1 - N/A), Newmark 1965
    0.882598
    """
    drive = accelerations - yield_acceleration
    steps = np.diff(times)
    first, last = drive[:-1], drive[1:]
    turns = np.flatnonzero(first * last < 0.0)
    share = first[turns] / (first[turns] - last[turns])
    t = np.insert(times, turns + 1, times[turns] + share * steps[turns])
    r = np.insert(drive, turns + 1, 0.0)
    sample = np.arange(len(times)) + np.searchsorted(
        turns, np.arange(len(times))
    )  # where the samples went
    h, r0, r1 = np.diff(t), r[:-1], r[1:]
    velocity_integral = np.concatenate([[0.0], np.cumsum(0.5 * (r0 + r1) * h)])
    v = velocity_integral - np.minimum.accumulate(velocity_integral)
    v0, slows = v[:-1], (r0 <= 0.0) & (r1 <= 0.0)
    x = np.where(slows & (v[1:] <= 0.0), np.minimum(_time_to_rest(v0, r0, r1, h), h), h)
    bend = np.divide(r1 - r0, h, out=np.zeros_like(h), where=h > 0.0)
    increments = np.where(slows & (v0 <= 0.0), 0.0, x * (v0 + x * (0.5 * r0 + x * bend / 6.0)))
    d = np.concatenate([[0.0], np.cumsum(increments)])
    after_m = float(v[-1]) ** 2 / (2.0 * yield_acceleration)
    return RecordSlide(float(d[-1]) + after_m, after_m, v[sample], d[sample])


def _time_to_rest(v0: Floats, r0: Floats, r1: Floats, h: Floats) -> Floats:
    """First x > 0 where v0 + r0 x + (r1 - r0) x² / 2h is 0, with r0, r1 <= 0; by the form that does not cancel."""
    bend = np.divide(r1 - r0, h, out=np.zeros_like(h), where=h > 0.0)
    root = np.sqrt(np.maximum(r0 * r0 - 2.0 * bend * v0, 0.0)) - r0
    return np.divide(2.0 * v0, root, out=np.full_like(h, math.inf), where=root > 0.0)


_STEP_S = 0.005  # s: springs of joints follow and do not ring, and the block slides to some 1e-3
_VOLUME_TOLERANCE = 1e-6
#: Of what slides, that finer node pairs may still change.
SETTLED_CHANGE = 0.01
_MIN_SLIDE_M = 1e-3  # m: what slides less does not ask for finer ones
_MAX_REFINEMENTS = 4  # times that the parts of the joints are split
_MAX_PAIRS = 2000
_COLUMNS = ("east_m", "north_m", "up_m", "about_east_deg", "about_north_deg", "about_up_deg")
#: Polarities by their names.
POLARITIES = {"as recorded": 1.0, "reversed": -1.0}


@dataclass(frozen=True)
class Shaking:
    """Response of the block to one record and polarity, in six degrees of freedom.

    Attributes
    ----------
    displacement_m : (3,) of the centroid in the end, east, north, up (of a section: out of the slope, along it, up)
    slid_m : its size; rotation_deg : how much it has turned
    slipped, opened, debonded : shares of the joints' area: that slipped, open at once at most, that lost its cohesion
    ended : rest, moves (still), refused (a step did not settle: what stands here is up to it); until_s : how far it got
    """

    record: str
    way: str
    displacement_m: Floats
    slid_m: float
    rotation_deg: float
    slipped: float
    opened: float
    debonded: float
    ended: str
    until_s: float
    work_kj: Work


@dataclass(frozen=True)
class SixDofResponse:
    """Responses of the block to all records, in six degrees of freedom.

    Attributes
    ----------
    shaken : each record in both polarities
    motion : in the one that slides farthest, its columns by name: of the centroid east, north, up, and about these axes
    pairs : node pairs; change : what the last refinement of them did to the strongest record's sliding, in parts of
        it, None where none was made
    """

    shaken: tuple[Shaking, ...]
    motion: Mapping[str, Any]
    pairs: int
    change: float | None

    @property
    def is_settled(self) -> bool:
        """Whether every step of every record settled, without which there is no displacement."""
        return all(shaking.ended != "refused" for shaking in self.shaken)

    def means_m(self) -> list[float]:
        """The displacement in each record, the mean of both polarities, m."""
        slid = [shaking.slid_m for shaking in self.shaken]
        return [0.5 * (first + second) for first, second in zip(slid[::2], slid[1::2], strict=True)]

    @property
    def percent(self) -> str:
        """The change in percent, two digits; empty where none was made."""
        return "" if self.change is None else number(float(f"{100.0 * self.change:.2g}"))


def six_dof_response(
    static: Design,
    records: Sequence[Record],
    across: Record | None,
    vertical: Record | None,
    advance: Callable[[int], None],
) -> SixDofResponse:
    """Every record in both polarities, on node pairs that are fine enough for the strongest of them.

    Raises
    ------
    DesignError
        E313 components that do not go together, E288 a design that has no such block.
    """
    if (across is not None or vertical is not None) and len(records) != 1:
        fail(
            "E313",
            f"--across and --vertical belong to one record, {len(records)} are given",
            "",
            "Run each earthquake by itself.",
        )
    block_cut, on_pairs = _shaken_block_on_pairs(static)
    block = on_pairs(block_cut.refine)
    if block is None:
        raise _unsupported("on its springs it does not come to rest without an earthquake")
    if across is not None and block.translations == 2:
        fail("E313", "a section does not move across itself: --across says nothing of it")
    axes = _shaking_axes(static, block_cut, block.translations)
    strongest = max(records, key=lambda candidate: candidate.pga_g)
    block, strongest_motions, change = _refined_until_settled(
        block, block_cut.refine, on_pairs, _components(strongest, across, vertical, axes)
    )
    shaken, motions = list[Shaking](), list[Mapping[str, Any]]()
    for record in records:
        pushes = _components(record, across, vertical, axes)
        for way, sign in POLARITIES.items():
            response = (
                strongest_motions[way]
                if record is strongest
                else shake(block, _STEP_S, sign * pushes)
            )
            translation, rotation = _spatial_motion(response, block, block_cut)
            shaken.append(
                Shaking(
                    record.name,
                    way,
                    translation[-1],
                    float(np.linalg.norm(translation[-1])),
                    float(np.linalg.norm(rotation[-1])),
                    response.slipped,
                    response.opened,
                    response.debonded,
                    response.ended,
                    float(response.times[-1]),
                    response.work,
                )
            )
            columns = zip(_COLUMNS, np.hstack([translation, rotation]).T, strict=True)
            motions.append(
                {"record": record.name, "way": way, "t_s": response.times, **dict(columns)}
            )
            advance(1)
    farthest = max(range(len(shaken)), key=lambda k: shaken[k].slid_m)
    return SixDofResponse(tuple(shaken), motions[farthest], len(block.area), change)


def _refined_until_settled(
    block: ShakenBlock, refined: int, on_pairs: Callable[[int], ShakenBlock | None], pushes: Floats
) -> tuple[ShakenBlock, dict[str, Shake], float | None]:
    """The block on node pairs that finer ones no longer change, its motions, and what the last refinement did.

    Parameters
    ----------
    refined : how often its node pairs are refined; on_pairs : the block on finer ones, None where it does not rest

    Where a joint opens at a corner the pair there loses the cohesion of all its area: few pairs lose too much or too
    little.
    """

    def shaken(block: ShakenBlock) -> dict[str, Shake]:
        return {way: shake(block, _STEP_S, sign * pushes) for way, sign in POLARITIES.items()}

    motions = shaken(block)
    change: float | None = None
    for level in range(refined + 1, _MAX_REFINEMENTS + 1):
        finer = on_pairs(level)
        if finer is None or not len(block.area) < len(finer.area) <= _MAX_PAIRS:
            break
        finer_motions = shaken(finer)
        if any(response.ended == "refused" for response in finer_motions.values()):
            break
        coarser_motions, motions, block = motions, finer_motions, finer
        displacements = [
            [
                float(np.linalg.norm(response[way].motion[-1, : block.translations]))
                for response in (coarser_motions, motions)
            ]
            for way in POLARITIES
        ]
        change = max(abs(a - b) / max(a, b, _MIN_SLIDE_M) for a, b in displacements)
        opens = any(response.opened or response.debonded for response in motions.values())
        if change < SETTLED_CHANGE and (level > refined + 1 or not opens):
            break
    return block, motions, change


def _components(
    record: Record,
    across: Record | None,
    vertical: Record | None,
    axes: tuple[Floats, Floats, Floats],
) -> Floats:
    """Mean pushes (m, translations) m/s² of up to three records in equal steps, until the last has ended."""
    components = [
        (component, axis)
        for component, axis in zip((record, across, vertical), axes, strict=True)
        if component is not None
    ]
    count = math.ceil(max(component.duration_s for component, _ in components) / _STEP_S - 1e-9)
    grid: Floats = np.linspace(0.0, _STEP_S * count, count + 1)
    pushes = np.zeros((count, len(axes[0])))
    for component, axis in components:
        pushes += (np.diff(_ground_velocity(component, grid)) / _STEP_S)[:, None] * axis
    return pushes


def _ground_velocity(record: Record, times: Floats) -> Floats:
    """Velocity of the ground (k,) at any times, exact; after the end it stays."""
    t, a = record.times_s, record.accelerations
    k = np.clip(np.searchsorted(t, times, side="right") - 1, 0, len(t) - 2)
    length = t[k + 1] - t[k]
    x = np.minimum(times - t[k], length)
    bend = np.divide(a[k + 1] - a[k], length, out=np.zeros_like(length), where=length > 0.0)
    velocity: Floats = record.ground_velocity[k] + x * (a[k] + 0.5 * x * bend)
    return np.where(times >= t[-1], record.ground_velocity[-1], velocity)


def _shaken_block_on_pairs(static: Design) -> tuple[Cut, Callable[[int], ShakenBlock | None]]:
    """The block of a design, and how it is on node pairs refined so often: None where it does not come to rest."""
    block_cut = cut(static)
    if not isinstance(block_cut, Cut):
        raise _unsupported("several blocks: six degrees of freedom are those of one")
    model = block_cut.scene_at(block_cut.refine).model
    strengths: Sequence[Strength] = static.joint_strengths
    if model.dilates:
        raise _unsupported("its joints dilate")
    if model.lines is not None:
        raise _unsupported("its joints have a curved strength")
    if len(model.bolt_capacity):
        raise _unsupported("it has passive bolts, which would be drawn out and in")
    weight = float(-block_cut.loads.components["weight"][2])
    volume, inertia = inertia_of(list(block_cut.block.faces.values()), block_cut.block.centroid)
    if abs(volume / block_cut.block.volume - 1.0) > _VOLUME_TOLERANCE:
        raise _unsupported("its faces are not flat")
    residual = None
    if any(strength.residual for strength in strengths):
        residual_strengths = [
            interface.strength.at_residual() for interface in block_cut.interfaces
        ]
        keys = [interface.key for interface in block_cut.interfaces]
        cohesion, friction = np.zeros(max(keys) + 1), np.zeros(max(keys) + 1)
        cohesion[keys] = [strength.cohesion_kpa for strength in residual_strengths]
        friction[keys] = np.tan(
            np.radians([strength.friction_angle_deg for strength in residual_strengths])
        )
        residual = cohesion, friction
    mass = weight / static.rock.gravity_m_s2

    def on_pairs(level: int) -> ShakenBlock | None:
        finer = model if level == block_cut.refine else block_cut.scene_at(level).model
        return shaken_block(finer, mass, inertia * (mass / volume), _springs(static), residual)

    return block_cut, on_pairs


def _shaking_axes(
    static: Design, block_cut: Cut, translations: int
) -> tuple[Floats, Floats, Floats]:
    """The ways (translations,) that the shaking pushes: toward, to the right of that, up."""
    shaken = cut(with_values(static, {KEY: 1.0}))
    toward = (
        shaken.loads.components["seismic"] - block_cut.loads.components["seismic"]
    ) / -block_cut.loads.components["weight"][2]
    right, up = np.array([toward[1], -toward[0], 0.0]), np.array([0.0, 0.0, 1.0])
    in_plane = [0, 2] if translations == 2 else [0, 1, 2]
    return toward[in_plane], right[in_plane], up[in_plane]


def _springs(static: Design) -> JointStiffness:
    """The design's stiffness; in place of a hyperbola, which has no memory, a constant part of the normal one."""
    stiffness = joint_stiffness(static)
    shear_stiffness = (
        stiffness.tangential
        if isinstance(stiffness.tangential, float | int)
        else SHEAR_TO_NORMAL * stiffness.normal
    )
    return JointStiffness(stiffness.normal, 0.0, float(shear_stiffness))


def springs_in_words(static: Design) -> str:
    """The springs, as the sheet has them."""
    springs = _springs(static)
    return f"springs {springs.normal:g} kN/m³ normal, {springs.tangential:g} shear"


def _unsupported(reason: str) -> DesignError:
    return DesignError(
        [Fault("E288", f"--six has no answer for this design: {reason}", "", "Leave --six out.")]
    )


def _spatial_motion(response: Shake, block: ShakenBlock, block_cut: Cut) -> tuple[Floats, Floats]:
    """Return displacement of the centroid, m east, north, up, and rotation about these axes, degrees: (m, 3) each."""
    translation, rotation = np.zeros((len(response.times), 3)), np.zeros((len(response.times), 3))
    section = block.translations == 2
    translation[:, [0, 2] if section else [0, 1, 2]] = response.motion[:, : block.translations]
    rotation[:, [1] if section else [0, 1, 2]] = response.motion[:, block.translations :]
    return translation @ block_cut.axes, np.degrees(rotation @ block_cut.axes)
