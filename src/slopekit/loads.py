"""Loads on blocks: weight, water, seismic, forces, bolts, each where it acts.

Everything that does not depend on the strength becomes one force and one moment about each centroid. Passive bolts
stay apart: their capacity is strength, and is divided by the strength reduction factor.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints, cross, frozen
from slopekit.core.errors import Fault, MisfitError
from slopekit.geometry.polytopes import Block

if TYPE_CHECKING:  # one block has no patches between blocks
    from slopekit.geometry.patches import Assembly


@dataclass(frozen=True)
class PointForce:
    """A force (3,) in kN through a point (3,) in m; without a point it acts through the centroid.

    `couple` (3,) in kNm comes on top: a pressure on a curved surface is no single force.
    """

    force: Floats
    at: Floats | None = None
    couple: Floats | None = None


@dataclass(frozen=True)
class Loads:
    """The loads on a block.

    Attributes
    ----------
    force : (3,) kN; moment : (3,) kNm about the block's centroid
    parts : name -> (3,) kN, the forces that add up to `force`
    passive_forces : (b, 3) kN, full capacity along each passive bolt; passive_points : (b, 3) m
    acting : name, force (3,) kN and the point (3,) m that it acts through, one by one
    """

    force: Floats
    moment: Floats
    parts: Mapping[str, Floats]
    passive_forces: Floats
    passive_points: Floats
    acting: tuple[tuple[str, Floats, Floats], ...] = ()


def block_loads(
    block: Block,
    unit_weight: float,
    seismic: Floats,
    forces: Sequence[PointForce] = (),
    active: Sequence[PointForce] = (),
    passive: Sequence[PointForce] = (),
    pushes: Mapping[str, PointForce] | None = None,
) -> Loads:
    """Add up the loads on a block.

    Parameters
    ----------
    unit_weight : kN/m³
    seismic : (3,) parts of the weight, acting at the centroid
    forces, active, passive : forces, active bolts and passive bolts
    pushes : further forces by the name they have in `parts`: water on faces among them
    """
    weight = unit_weight * block.volume
    parts = {"weight": np.array([0.0, 0.0, -weight]), "seismic": weight * seismic}
    moment = np.zeros(3)
    acting = [(name, force, block.centroid) for name, force in parts.items() if force.any()]
    for name, push in (pushes or {}).items():
        parts[name] = push.force
        acting.append((name, push.force, block.centroid + line_of_action(push) if push.at is None else push.at))
        if push.at is not None:
            moment += cross(push.at - block.centroid, push.force)
        if push.couple is not None:
            moment += push.couple
    for name, one, group in (("forces", "force", forces), ("active bolts", "active bolt", active)):
        parts[name] = np.zeros(3)
        for k, load in enumerate(group, 1):
            parts[name] = parts[name] + load.force
            acting.append((f"{one} {k}", load.force, block.centroid if load.at is None else load.at))
            if load.at is not None:
                moment += cross(load.at - block.centroid, load.force)
    points = [block.centroid if load.at is None else load.at for load in passive]
    acting += [
        (f"passive bolt {k}", load.force, at) for k, (load, at) in enumerate(zip(passive, points, strict=True), 1)
    ]
    return Loads(
        frozen(sum(parts.values())), frozen(moment), parts,
        frozen(np.reshape([load.force for load in passive], (-1, 3))), frozen(np.reshape(points, (-1, 3))),
        tuple(acting),
    )  # fmt: skip


def line_of_action(push: PointForce) -> Floats:
    """From the centroid to the line on which a force has the moment of its couple (all but what turns about it)."""
    size = float(push.force @ push.force)
    if push.couple is None or not size > 0.0:
        return np.zeros(3)
    return cross(push.force, push.couple) / size


def judge_bolt(name: str, sound: float | None, anchored: bool, length: float | None, where: str) -> None:
    """Refuse a bolt by what it meets.

    Parameters
    ----------
    sound : how far (m) from its head it leaves the block for good, None where it misses it
    anchored : whether sound rock begins there; length : m

    Raises
    ------
    GeometryError
        E211 the bolt misses the block or is anchored in nothing, E212 it is too short.
    """
    if sound is None:
        raise MisfitError([Fault("E211", f"{name} misses the block", where)])
    if not anchored:
        message = f"{name} leaves the block through a free face: it is anchored in nothing"
        raise MisfitError([Fault("E211", message, where)])
    if length is not None and length <= sound:
        message = f"{name} is {length:.4g} m long and sound rock begins after {sound:.4g} m: it is too short"
        raise MisfitError([Fault("E212", message, where, "It needs its anchorage behind the joint on top of that.")])


@dataclass(frozen=True)
class PassiveBolts:
    """Passive bolts of an assembly, each along a line between two blocks or a block and bedrock.

    Attributes
    ----------
    head, toe : (b,) the blocks at its two ends, -1 for bedrock
    forces : (b, 3) kN, full capacity along the bolt, as it pulls the block of its head; points : (b, 3) m on its line
    """

    head: Ints
    toe: Ints
    forces: Floats
    points: Floats

    def chosen(self, which: Ints) -> "PassiveBolts":
        """Return some of them, by their numbers."""
        return PassiveBolts(self.head[which], self.toe[which], self.forces[which], self.points[which])


NO_BOLTS = PassiveBolts(
    np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64), frozen(np.zeros((0, 3))), frozen(np.zeros((0, 3)))
)


@dataclass(frozen=True, eq=False)
class BlockLoad:
    """A force on one block of an assembly.

    Attributes
    ----------
    name : as pictures call it; block : its number
    tied : the block at the other end of an anchor, which goes with either of them; -1 for none
    is_live : whether it is a force, a bolt or a surcharge: loads that come after weight and water
    """

    name: str
    block: int
    push: PointForce
    tied: int = -1
    is_live: bool = True


@dataclass(frozen=True)
class AssemblyLoads:
    """Loads on the blocks of an assembly: forces (n, 3) kN and moments (n, 3) kNm about their centroids.

    `weights` (n,) kN; `water` (k,) kN, what pushes on each side of a patch through `water_points` (k, 3); `live` forces
    and moments that are part of them and neither weight nor water. Passive `bolts` are strength and no part of them;
    `pushes` are.
    """

    forces: Floats
    moments: Floats
    weights: Floats
    water: Floats
    live: tuple[Floats, Floats]
    bolts: PassiveBolts
    water_points: Floats
    pushes: tuple[BlockLoad, ...]


def drained(assembly: "Assembly", loads: AssemblyLoads, patches: Bools) -> AssemblyLoads:
    """The loads without the water on some patches (k,): a joint that a block has left stands open."""
    lost = np.where(patches, loads.water, 0.0)
    if not lost.any():
        return loads
    forces, moments = loads.forces.copy(), loads.moments.copy()
    _add_water(assembly, forces, moments, -lost, loads.water_points)
    return replace(loads, forces=frozen(forces), moments=frozen(moments), water=frozen(loads.water - lost))


def without_anchors_of(assembly: "Assembly", loads: AssemblyLoads, gone: Bools) -> AssemblyLoads:
    """The loads without the anchors of blocks (n,) that are gone: at their other ends nothing pulls any more."""
    lost = [load for load in loads.pushes if load.tied >= 0 and (gone[load.block] or gone[load.tied])]
    if not lost:
        return loads
    forces, moments = np.zeros((2, len(assembly), 3))
    _add_pushes(assembly, forces, moments, lost)
    return replace(
        loads,
        forces=frozen(loads.forces - forces),
        moments=frozen(loads.moments - moments),
        live=(frozen(loads.live[0] - forces), frozen(loads.live[1] - moments)),
        pushes=tuple(load for load in loads.pushes if load not in lost),
    )


def assembly_loads(
    assembly: "Assembly",
    unit_weights: Floats,
    seismic: Floats,
    pressures: Floats,
    pushes: Sequence[BlockLoad] = (),
    bolts: PassiveBolts = NO_BOLTS,
    water_points: Floats | None = None,
) -> AssemblyLoads:
    """Add up the loads on the blocks of an assembly.

    Parameters
    ----------
    unit_weights : (n,) kN/m³
    seismic : (3,) parts of the weight, acting at the centroids
    pressures : (k,) mean water pressure on each patch (kPa); water_points : (k, 3) where it acts, None: in its middle
    bolts : the passive ones
    """
    weights, water = unit_weights * assembly.volumes, pressures * assembly.patches.areas
    points = assembly.patches.centroids if water_points is None else water_points
    live, turning = weights[:, None] * seismic, np.zeros((len(weights), 3))
    _add_pushes(assembly, live, turning, [load for load in pushes if load.is_live])
    forces, moments = live + weights[:, None] * np.array([0.0, 0.0, -1.0]), turning.copy()
    _add_water(assembly, forces, moments, water, points)
    _add_pushes(assembly, forces, moments, [load for load in pushes if not load.is_live])
    return AssemblyLoads(
        frozen(forces), frozen(moments), frozen(weights), frozen(water), (frozen(live), frozen(turning)), bolts, points,
        tuple(pushes),
    )  # fmt: skip


def _add_pushes(assembly: "Assembly", forces: Floats, moments: Floats, pushes: Sequence[BlockLoad]) -> None:
    """Add single forces on the blocks to forces and moments (n, 3)."""
    for load in pushes:
        block, push = load.block, load.push
        forces[block] += push.force
        if push.at is not None:
            moments[block] += cross(push.at - assembly.centroids[block], push.force)
        if push.couple is not None:
            moments[block] += push.couple


def _add_water(assembly: "Assembly", forces: Floats, moments: Floats, thrusts: Floats, points: Floats) -> None:
    """Add water that pushes (k,) kN on each side of the patches through points (k, 3) to forces and moments (n, 3)."""
    for side, sign in ((assembly.patches.plus, 1.0), (assembly.patches.minus, -1.0)):
        wet = np.flatnonzero((side >= 0) & (thrusts != 0.0))
        push = sign * thrusts[wet, None] * assembly.patches.normals[wet]
        np.add.at(forces, side[wet], push)
        np.add.at(moments, side[wet], cross(points[wet] - assembly.centroids[side[wet]], push))
