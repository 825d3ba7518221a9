"""Records in six degrees of freedom: the block of a design on its springs, shaken both ways, with its work.

Sliding one way, rigid, is integrated exactly (Newmark 1965). While the block slides its acceleration against the base
is κ (a(t) - a_y); the record is linear between its samples, so the velocity is a quadratic there and the displacement a
cubic. With V the integral of κ (a - a_y), v(t) = V(t) - min over s <= t of V(s): a block at rest starts where V is at
its lowest, and stops where V is back there. Nothing is stepped.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np

from slopekit.core.arrays import Floats, frozen
from slopekit.core.errors import DesignError, Fault
from slopekit.core.orientation import number
from slopekit.core.records import dataclass
from slopekit.design.common import Design
from slopekit.design.parts import Strength
from slopekit.design.reading.files import with_values
from slopekit.kinds import cut, kind_of
from slopekit.kinds.single_block.one_block_limit import Cut
from slopekit.kinds.solver_inputs import joint_stiffness
from slopekit.preie.motion.shaking import Shake, ShakenBlock, Work, inertia_of, shake, shaken_block
from slopekit.preie.system.contact import SHEAR_TO_NORMAL, JointStiffness
from slopekit.studies.quake.records import Record
from slopekit.studies.quake.yielding import KEY


@dataclass(frozen=True, slots=True)
class RecordSlide:
    """What comes of one record.

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
    sample = np.arange(len(times)) + np.searchsorted(turns, np.arange(len(times)))  # where the samples went
    h, r0, r1 = np.diff(t), r[:-1], r[1:]
    gained = np.concatenate([[0.0], np.cumsum(0.5 * (r0 + r1) * h)])
    v = gained - np.minimum.accumulate(gained)
    v0, slows = v[:-1], (r0 <= 0.0) & (r1 <= 0.0)
    x = np.where(slows & (v[1:] <= 0.0), np.minimum(_until_rest(v0, r0, r1, h), h), h)
    bend = np.divide(r1 - r0, h, out=np.zeros_like(h), where=h > 0.0)
    moved = np.where(slows & (v0 <= 0.0), 0.0, x * (v0 + x * (0.5 * r0 + x * bend / 6.0)))
    d = np.concatenate([[0.0], np.cumsum(moved)])
    after = float(v[-1]) ** 2 / (2.0 * yield_acceleration)
    return RecordSlide(float(d[-1]) + after, after, v[sample], d[sample])


def _until_rest(v0: Floats, r0: Floats, r1: Floats, h: Floats) -> Floats:
    """First x > 0 where v0 + r0 x + (r1 - r0) x² / 2h is 0, with r0, r1 <= 0; by the form that does not cancel."""
    bend = np.divide(r1 - r0, h, out=np.zeros_like(h), where=h > 0.0)
    root = np.sqrt(np.maximum(r0 * r0 - 2.0 * bend * v0, 0.0)) - r0
    return np.divide(2.0 * v0, root, out=np.full_like(h, math.inf), where=root > 0.0)


_STEP = 0.005  # s: springs of joints follow and do not ring, and the block slides to some 1e-3
_SAME_VOLUME = 1e-6
#: Of what slides, that finer node pairs may still change.
SETTLED = 0.01
_SLIDES = 1e-3  # m: what slides less does not ask for finer ones
_MOST_REFINED = 4  # times that the parts of the joints are split
_MOST_PAIRS = 2000
_TURNS_DEG = 0.05  # a rotation that is a cause, not the give of the springs
#: Polarities by their names.
WAYS = {"as recorded": 1.0, "reversed": -1.0}


@dataclass(frozen=True, slots=True)
class Shaking:
    """What one record does to the block in six degrees of freedom, in one polarity.

    Attributes
    ----------
    displacement_m : (3,) of the centroid in the end, east, north, up (of a section: out of the slope, along it, up)
    slid_m : its size; rotation_deg : how much it has turned
    slipped, opened, debonded : shares of the joints' area: that slipped, open at once at most, that lost its cohesion
    steps, halved : of time; ended : rest, moves (still), refused (a step did not settle: what stands here is up to it)
    until_s : how far it got
    """

    record: str
    way: str
    displacement_m: Floats
    slid_m: float
    rotation_deg: float
    slipped: float
    opened: float
    debonded: float
    steps: int
    halved: int
    ended: str
    until_s: float
    work_kj: Work


@dataclass(frozen=True, slots=True)
class SixMotion:
    """The motion of the block in six degrees of freedom, against bedrock from rest before the shaking.

    Attributes
    ----------
    times_s : (m,); moved : (m, 3) m east, north, up, of the centroid; turned_deg : (m, 3) about these axes
    """

    record: str
    way: str
    times_s: Floats
    moved: Floats
    turned_deg: Floats


@dataclass(frozen=True, slots=True)
class SixBlock:
    """The block of a design, and the ways (translations,) that its shaking pushes: toward, to the right of that, up.

    `finer` makes its node pairs finer: None where there are none, or it does not come to rest on them.
    """

    block: ShakenBlock
    made: Cut
    ways: tuple[Floats, Floats, Floats]
    finer: Callable[[int], ShakenBlock | None]


@dataclass(frozen=True, slots=True)
class InSix:
    """What the records do to the block in six degrees of freedom.

    Attributes
    ----------
    shaken : each record in both polarities; motion : in the one that slides farthest
    pairs : node pairs; change : what the last refinement of them did to the strongest record's sliding, in parts of
        it, None where none was made
    components : which further records shake it, across or vertical
    """

    shaken: tuple[Shaking, ...]
    motion: SixMotion
    pairs: int
    change: float | None
    components: tuple[str, ...] = ()

    @property
    def is_settled(self) -> bool:
        """Whether every step of every record settled, without which there is no displacement."""
        return all(one.ended != "refused" for one in self.shaken)

    def means_m(self) -> list[float]:
        """The displacement in each record, the mean of both polarities, m."""
        slid = [one.slid_m for one in self.shaken]
        return [0.5 * (first + second) for first, second in zip(slid[::2], slid[1::2], strict=True)]

    def causes(self, has_residual: bool) -> list[str]:
        """What the block does in six degrees of freedom that one sliding one way does not, in words."""
        most = {name: max(getattr(one, name) for one in self.shaken) for name in ("opened", "debonded", "rotation_deg")}
        words = [f"the {' and '.join(self.components)} shaking acts here alone"] if self.components else []
        if has_residual:
            words.append("joints that have slipped keep their residual strength alone")
        if most["debonded"]:
            words.append(f"{100.0 * most['debonded']:.3g} % of the area of the joints opens and loses its cohesion")
        elif most["opened"]:
            words.append(f"{100.0 * most['opened']:.3g} % of the area of the joints is open at once")
        if most["rotation_deg"] >= _TURNS_DEG:
            words.append(f"the block turns by {most['rotation_deg']:.2g}°")
        return words or ["the springs of its joints give as the shaking turns round"]

    @property
    def percent(self) -> str:
        """The change in percent, two digits; empty where none was made."""
        return "" if self.change is None else number(float(f"{100.0 * self.change:.2g}"))


def six_block(static: Design, records: int, across: Record | None, vertical: Record | None) -> SixBlock:
    """The block of a design at rest on its springs.

    Raises
    ------
    DesignError
        E313 components that do not go together, E288 a design that has no such block.
    """
    if (across is not None or vertical is not None) and records != 1:
        message = f"--across and --vertical belong to one record, {records} are given"
        raise DesignError([Fault("E313", message, "", "Run each earthquake by itself.")])
    at_rest = _block_of(static)
    if across is not None and at_rest.block.translations == 2:
        raise DesignError([Fault("E313", "a section does not move across itself: --across says nothing of it")])
    return at_rest


def shaken_in_six(
    of: SixBlock, records: Sequence[Record], across: Record | None, vertical: Record | None,
    advance: Callable[[int], None],
) -> InSix:  # fmt: skip
    """Every record in both polarities, on node pairs that are fine enough for the strongest of them."""
    strongest = max(records, key=lambda one: one.pga_g)
    block, known, change = _settled(of, _components(strongest, across, vertical, of.ways))
    shaken: list[Shaking] = []
    most: tuple[float, SixMotion] | None = None
    for record in records:
        pushes = _components(record, across, vertical, of.ways)
        for way, sign in WAYS.items():
            out = known[way] if record is strongest else shake(block, _STEP, sign * pushes)
            motion = _in_space(record, way, out, block, of.made)
            shaken.append(_said(motion, out))
            if most is None or shaken[-1].slid_m > most[0]:
                most = shaken[-1].slid_m, motion
            advance(1)
    assert most is not None  # there is a record
    components = (*(["across"] if across is not None else []), *(["vertical"] if vertical is not None else []))
    return InSix(tuple(shaken), most[1], len(block.area), change, components)


def _settled(of: SixBlock, pushes: Floats) -> tuple[ShakenBlock, dict[str, Shake], float | None]:
    """The block on node pairs that finer ones no longer change, its motions, and what the last refinement did.

    Where a joint opens at a corner the pair there loses the cohesion of all its area: few pairs lose too much or too
    little.
    """

    def shaken(block: ShakenBlock) -> dict[str, Shake]:
        return {way: shake(block, _STEP, sign * pushes) for way, sign in WAYS.items()}

    block, motions = of.block, shaken(of.block)
    change: float | None = None
    for level in range(of.made.refine + 1, _MOST_REFINED + 1):
        finer = of.finer(level)
        if finer is None or not len(block.area) < len(finer.area) <= _MOST_PAIRS:
            break
        after = shaken(finer)
        if any(one.ended == "refused" for one in after.values()):
            break
        before, motions, block = motions, after, finer
        slid = [[_slid(one[way], block) for one in (before, motions)] for way in WAYS]
        change = max(abs(a - b) / max(a, b, _SLIDES) for a, b in slid)
        opens = any(one.opened or one.debonded for one in motions.values())
        if change < SETTLED and (level > of.made.refine + 1 or not opens):
            break
    return block, motions, change


def _slid(out: Shake, block: ShakenBlock) -> float:
    last = out.motion[-1, : block.translations]
    return math.sqrt(float(last @ last))


def _components(
    record: Record, across: Record | None, vertical: Record | None, ways: tuple[Floats, Floats, Floats]
) -> Floats:
    """Mean pushes (m, translations) m/s² of up to three records in equal steps, until the last has ended."""
    given = [(one, way) for one, way in zip((record, across, vertical), ways, strict=True) if one is not None]
    count = math.ceil(max(one.duration_s for one, _ in given) / _STEP - 1e-9)
    grid: Floats = np.linspace(0.0, _STEP * count, count + 1)
    pushes = np.zeros((count, len(ways[0])))
    for one, way in given:
        pushes += (np.diff(_velocity_at(one, grid)) / _STEP)[:, None] * way
    return pushes


def _velocity_at(record: Record, times: Floats) -> Floats:
    """Velocity of the ground (k,) at any times, exact; after the end it stays."""
    t, a = record.times_s, record.accelerations
    k = np.clip(np.searchsorted(t, times, side="right") - 1, 0, len(t) - 2)
    length = t[k + 1] - t[k]
    x = np.minimum(times - t[k], length)
    bend = np.divide(a[k + 1] - a[k], length, out=np.zeros_like(length), where=length > 0.0)
    velocity: Floats = record.ground_velocity[k] + x * (a[k] + 0.5 * x * bend)
    return np.where(times >= t[-1], record.ground_velocity[-1], velocity)


def _block_of(static: Design) -> SixBlock:
    kind = kind_of(static)
    made, shaken = cut(static), cut(with_values(static, {KEY: 1.0}))
    if not isinstance(made, Cut):
        raise _none("several blocks: six degrees of freedom are those of one")
    model = made.scene_at(made.refine).model
    strengths: Sequence[Strength] = kind.strengths(static)
    if model.dilates:
        raise _none("its joints dilate")
    if model.lines is not None:
        raise _none("its joints have a curved strength")
    if len(model.bolt_capacity):
        raise _none("it has passive bolts, which would be drawn out and in")
    weight = float(-made.loads.parts["weight"][2])
    volume, inertia = inertia_of(list(made.block.faces.values()), made.block.centroid)
    if abs(volume / made.block.volume - 1.0) > _SAME_VOLUME:
        raise _none("its faces are not flat")
    residual = None
    if any(strength.residual for strength in strengths):
        left = [interface.strength.at_residual() for interface in made.interfaces]
        keys = [interface.key for interface in made.interfaces]
        cohesion, friction = np.zeros(max(keys) + 1), np.zeros(max(keys) + 1)
        cohesion[keys] = [one.cohesion_kpa for one in left]
        friction[keys] = np.tan(np.radians([one.friction_angle_deg for one in left]))
        residual = cohesion, friction
    mass = weight / static.rock.gravity_m_s2

    def on_pairs(level: int) -> ShakenBlock | None:
        finer = model if level == made.refine else made.scene_at(level).model
        return shaken_block(finer, mass, inertia * (mass / volume), _springs(static), residual)

    block = on_pairs(made.refine)
    if block is None:
        raise _none("on its springs it does not come to rest without an earthquake")
    toward = (shaken.loads.parts["seismic"] - made.loads.parts["seismic"]) / weight
    right, up = np.array([toward[1], -toward[0], 0.0]), np.array([0.0, 0.0, 1.0])
    in_plane = [0, 2] if block.translations == 2 else [0, 1, 2]
    return SixBlock(block, made, (toward[in_plane], right[in_plane], up[in_plane]), on_pairs)


def _springs(static: Design) -> JointStiffness:
    """The design's stiffness; in place of a hyperbola, which has no memory, a constant part of the normal one."""
    own = joint_stiffness(static)
    give = own.tangential if isinstance(own.tangential, float | int) else SHEAR_TO_NORMAL * own.normal
    return JointStiffness(own.normal, 0.0, float(give))


def springs_in_words(static: Design) -> str:
    """The springs, as the sheet has them."""
    springs = _springs(static)
    return f"springs {springs.normal:g} kN/m³ normal, {springs.tangential:g} shear"


def _none(why: str) -> DesignError:
    return DesignError([Fault("E288", f"--six has no answer for this design: {why}", "", "Leave --six out.")])


def _in_space(record: Record, way: str, out: Shake, block: ShakenBlock, made: Cut) -> SixMotion:
    moved, turned = np.zeros((len(out.times), 3)), np.zeros((len(out.times), 3))
    section = block.translations == 2
    moved[:, [0, 2] if section else [0, 1, 2]] = out.motion[:, : block.translations]
    turned[:, [1] if section else [0, 1, 2]] = out.motion[:, block.translations :]
    moved, turned = moved @ made.axes, turned @ made.axes
    return SixMotion(record.name, way, out.times, frozen(moved), frozen(np.degrees(turned)))


def _said(motion: SixMotion, out: Shake) -> Shaking:
    last, turned = motion.moved[-1], motion.turned_deg[-1]
    return Shaking(
        motion.record, motion.way, last, math.sqrt(float(last @ last)), math.sqrt(float(turned @ turned)),
        out.slipped, out.opened, out.debonded, out.steps, out.halved, out.ended, float(out.times[-1]), out.work,
    )  # fmt: skip
