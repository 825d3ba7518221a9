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
    point: Floats | None = None
    couple: Floats | None = None


@dataclass(frozen=True)
class Loads:
    """The loads on a block.

    Attributes
    ----------
    force : (3,) kN; moment : (3,) kNm about the block's centroid
    components : name -> (3,) kN, the forces that add up to `force`
    passive_forces : (b, 3) kN, full capacity along each passive bolt; passive_points : (b, 3) m
    acting : name, force (3,) kN and the point (3,) m that it acts through, one by one
    """

    force: Floats
    moment: Floats
    components: Mapping[str, Floats]
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
    components = {"weight": np.array([0.0, 0.0, -weight]), "seismic": weight * seismic}
    moment = np.zeros(3)
    acting = [(name, force, block.centroid) for name, force in components.items() if force.any()]
    for name, push in (pushes or {}).items():
        components[name] = push.force
        acting.append(
            (
                name,
                push.force,
                block.centroid + line_of_action(push) if push.point is None else push.point,
            )
        )
        if push.point is not None:
            moment += cross(push.point - block.centroid, push.force)
        if push.couple is not None:
            moment += push.couple
    for name, label, group in (
        ("forces", "force", forces),
        ("active bolts", "active bolt", active),
    ):
        components[name] = np.zeros(3)
        for k, load in enumerate(group, 1):
            components[name] = components[name] + load.force
            acting.append(
                (f"{label} {k}", load.force, block.centroid if load.point is None else load.point)
            )
            if load.point is not None:
                moment += cross(load.point - block.centroid, load.force)
    points = [block.centroid if load.point is None else load.point for load in passive]
    acting += [
        (f"passive bolt {k}", load.force, point)
        for k, (load, point) in enumerate(zip(passive, points, strict=True), 1)
    ]
    return Loads(
        frozen(sum(components.values())),
        frozen(moment),
        components,
        frozen(np.reshape([load.force for load in passive], (-1, 3))),
        frozen(np.reshape(points, (-1, 3))),
        tuple(acting),
    )


def line_of_action(push: PointForce) -> Floats:
    """Return the vector (3,) m from the centroid to the line of action of a force with a couple.

    The part of the couple about the force itself has no such line.
    """
    size = float(push.force @ push.force)
    if push.couple is None or not size > 0.0:
        return np.zeros(3)
    return cross(push.force, push.couple) / size


def check_bolt_anchorage(
    name: str, exit_distance: float | None, is_anchored: bool, length: float | None, location: str
) -> None:
    """Raise where a bolt misses the block, has no anchorage behind it, or is too short.

    Parameters
    ----------
    exit_distance : how far (m) from its head it leaves the block for good, None where it misses it
    is_anchored : whether sound rock begins there; length : m

    Raises
    ------
    GeometryError
        E211 the bolt misses the block or is anchored in nothing, E212 it is too short.
    """
    if exit_distance is None:
        raise MisfitError([Fault("E211", f"{name} misses the block", location)])
    if not is_anchored:
        message = f"{name} leaves the block through a free face: it is anchored in nothing"
        raise MisfitError([Fault("E211", message, location)])
    if length is not None and length <= exit_distance:
        message = f"{name} is {length:.4g} m long and sound rock begins after {exit_distance:.4g} m: it is too short"
        raise MisfitError(
            [
                Fault(
                    "E212",
                    message,
                    location,
                    "It needs its anchorage behind the joint on top of that.",
                )
            ]
        )


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

    def chosen(self, indices: Ints) -> "PassiveBolts":
        """Return the bolts with these indices."""
        return PassiveBolts(
            self.head[indices], self.toe[indices], self.forces[indices], self.points[indices]
        )


NO_BOLTS = PassiveBolts(
    np.zeros(0, dtype=np.int64),
    np.zeros(0, dtype=np.int64),
    frozen(np.zeros((0, 3))),
    frozen(np.zeros((0, 3))),
)


@dataclass(frozen=True, eq=False)
class BlockLoad:
    """A force on one block of an assembly.

    Attributes
    ----------
    name : label in pictures; block : index of the block
    tied : index of the block at the other end of an anchor, which acts while both blocks are there; -1 for none
    is_live : whether the load is a force, bolt or surcharge, which a load path applies after weight and water
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
    """Return the loads without the water pressure on some patches (k,): joints whose block has failed are open."""
    drained_water = np.where(patches, loads.water, 0.0)
    if not drained_water.any():
        return loads
    forces, moments = loads.forces.copy(), loads.moments.copy()
    _add_water(assembly, forces, moments, -drained_water, loads.water_points)
    return replace(
        loads,
        forces=frozen(forces),
        moments=frozen(moments),
        water=frozen(loads.water - drained_water),
    )


def without_anchors_of(
    assembly: "Assembly", loads: AssemblyLoads, is_removed: Bools
) -> AssemblyLoads:
    """Return the loads without the anchors of removed blocks (n,), whose other ends no longer pull."""
    removed = [
        load
        for load in loads.pushes
        if load.tied >= 0 and (is_removed[load.block] or is_removed[load.tied])
    ]
    if not removed:
        return loads
    forces, moments = np.zeros((2, len(assembly), 3))
    _add_pushes(assembly, forces, moments, removed)
    return replace(
        loads,
        forces=frozen(loads.forces - forces),
        moments=frozen(loads.moments - moments),
        live=(frozen(loads.live[0] - forces), frozen(loads.live[1] - moments)),
        pushes=tuple(load for load in loads.pushes if load not in removed),
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
        frozen(forces),
        frozen(moments),
        frozen(weights),
        frozen(water),
        (frozen(live), frozen(turning)),
        bolts,
        points,
        tuple(pushes),
    )


def _add_pushes(
    assembly: "Assembly", forces: Floats, moments: Floats, pushes: Sequence[BlockLoad]
) -> None:
    """Add single forces on blocks to `forces` (n, 3) kN and `moments` (n, 3) kNm about the centroids, in place."""
    for load in pushes:
        block, push = load.block, load.push
        forces[block] += push.force
        if push.point is not None:
            moments[block] += cross(push.point - assembly.centroids[block], push.force)
        if push.couple is not None:
            moments[block] += push.couple


def _add_water(
    assembly: "Assembly", forces: Floats, moments: Floats, thrusts: Floats, points: Floats
) -> None:
    """Add water thrusts (k,) kN on both sides of the patches, through points (k, 3), to forces and moments (n, 3)."""
    for side, sign in ((assembly.patches.plus, 1.0), (assembly.patches.minus, -1.0)):
        wet = np.flatnonzero((side >= 0) & (thrusts != 0.0))
        push = sign * thrusts[wet, None] * assembly.patches.normals[wet]
        np.add.at(forces, side[wet], push)
        np.add.at(moments, side[wet], cross(points[wet] - assembly.centroids[side[wet]], push))
