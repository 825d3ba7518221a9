"""Single blocks of n designs at once: cut by their planes, loaded, on the joints that carry them.

The designs are one whose numbers may be arrays (n,): what `OnArrays` takes.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints, NDArray, cross
from slopekit.design.ground_water import SlopeDesign
from slopekit.design.parts import Bolt, Strength
from slopekit.geometry.polytopes import Polytopes
from slopekit.kinds.single_block.closed_forms import OnArrays
from slopekit.kinds.single_block.held_bolts import Bounds, blocks_within
from slopekit.kinds.single_block.one_block_limit import motion_statuses
from slopekit.kinds.water import LocalSlope, pushes
from slopekit.loads import PointForce
from slopekit.notices import PERPENDICULAR
from slopekit.preie.batch import BlockLimits, Blocks, limits_of_blocks
from slopekit.preie.one_block.bed_limits import BedStatus
from slopekit.preie.one_block.forces_limits import ForcesStatus
from slopekit.strength.protocol import row_laws

_NO_BLOCK = "E208"  # a crack cuts it in two
_ALONG_SLOPE = 1e-9  # of the strongest: a bolt with less in a section runs along its slope


@dataclass(frozen=True)
class LimitsOfMany:
    """PRE-IE limits of n designs: `status` (n,) or the code of why there is no block, `limit` and `forces` (n,).

    `limit` is the factor of safety, `forces` that of the forces alone; not a number where there is none. `rows` (b,)
    are the numbers of those that form blocks, and `limits` is all that PRE-IE says of these, None of none. `has_bolts`
    and `draws_bolts` (b,) say which have passive bolts that hold them, and which draw any of these out.
    """

    status: NDArray[np.str_]
    limit: Floats
    forces: Floats
    rows: Ints = field(default_factory=lambda: np.arange(0))
    limits: BlockLimits | None = None
    has_bolts: Bools = field(default_factory=lambda: np.zeros(0, dtype=bool))
    draws_bolts: Bools = field(default_factory=lambda: np.zeros(0, dtype=bool))


def limits_on_arrays(
    design: SlopeDesign, on_arrays: OnArrays[Any], strengths: Sequence[Strength], count: int
) -> LimitsOfMany:
    """Return PRE-IE's limits of n designs.

    Parameters
    ----------
    design : whose numbers may be arrays (n,), as `OnArrays` takes it; strengths : of the joints, likewise
    """
    blocks = blocks_of(design, on_arrays, strengths, count)
    rows = np.flatnonzero((blocks.counts > 0).any(axis=1))
    status = np.full(count, _NO_BLOCK, dtype=object)
    limit, forces = np.full((2, count), np.nan)
    if not len(rows):
        return LimitsOfMany(status.astype(np.str_), limit, forces)
    blocks = blocks.take(rows)
    limits = limits_of_blocks(blocks)
    status[rows], forces[rows] = block_statuses(limits), limits.forces
    limit[rows] = np.where(
        limits.factor > 0.0, limits.factor, np.nan
    )  # no strength at all: a status, no number
    draws_bolts = has_bolts = np.asarray(blocks.bolts.any(axis=(1, 2)))
    if has_bolts.any():
        speed = (blocks.beds().bolt_rows @ limits.velocity[:, blocks.unknowns, None])[:, :, 0]
        draws_bolts = np.asarray((speed < -PERPENDICULAR).any(axis=1))
    return LimitsOfMany(status.astype(np.str_), limit, forces, rows, limits, has_bolts, draws_bolts)


def block_statuses(limits: BlockLimits) -> NDArray[np.str_]:
    """Return the statuses (n,) of blocks by their limits; contacts are J1, J2 and a basal joint, in this order."""
    ends = [
        limits.bed_status == BedStatus.NO_REST,
        *(
            limits.forces_status == end
            for end in (ForcesStatus.STANDS, ForcesStatus.LIFTED, ForcesStatus.FALLS)
        ),
    ]
    slides = motion_statuses(
        limits.velocity, 3, limits.opens_partly, limits.opens_wholly, limits.normal
    )
    return np.select(ends, ["topples", "no_driving_force", "lifted", "falls"], slides)


def blocks_of(
    design: SlopeDesign, on_arrays: OnArrays[Any], strengths: Sequence[Strength], count: int
) -> Blocks:
    """Return the blocks of n designs, as `limits_on_arrays` takes them; without contacts where planes cut none."""
    bounds = on_arrays.bounds(design)
    solids = blocks_within(bounds, count)
    joints = list(bounds.joints)
    cohesion, friction, dilation = (
        np.stack([_broadcast(getattr(strength, name), count) for strength in strengths], axis=1)
        for name in ("cohesion_kpa", "friction_angle_deg", "dilation_deg")
    )
    corners, counts = (
        solids.faces[:, joints] - solids.centroid[:, None, None],
        solids.counts[:, joints],
    )
    if bounds.along is not None:
        corners, counts = _section_lines(corners, counts, solids.outward[:, joints], bounds.along)
    return Blocks(
        corners=corners,
        counts=counts,
        cohesion=cohesion,
        tan_friction=np.tan(np.radians(friction)),
        tan_dilation=np.tan(np.radians(dilation)),
        laws=np.stack([row_laws(strength.law, count) for strength in strengths], axis=1),
        load=_loads(design, on_arrays, bounds, solids),
        bolts=_passive_bolts(design, bounds, solids),
    )


def motion_toward(design: SlopeDesign, on_arrays: OnArrays[Any], limits: LimitsOfMany) -> Floats:
    """Return cosines (b,) between motions of blocks at their limits and the earthquake, not numbers without motions."""
    assert limits.limits is not None
    directions, velocity = (
        shaken_toward(design, on_arrays, len(limits.status))[limits.rows],
        limits.limits.velocity[:, :3],
    )
    along = on_arrays.bounds(design).along
    if along is not None:
        axes = np.broadcast_to(_section_axes(along), (len(limits.status), 3, 3))[limits.rows]
        directions = (axes @ directions[:, :, None])[:, :, 0] * [1.0, 0.0, 1.0]
    size = np.sqrt((directions * directions).sum(axis=1) * (velocity * velocity).sum(axis=1))
    cosines: Floats = (directions * velocity).sum(axis=1) / np.where(size > 0.0, size, np.nan)
    return cosines


def shaken_toward(design: SlopeDesign, on_arrays: OnArrays[Any], count: int) -> Floats:
    """Return the level unit vectors (n, 3) that an earthquake acts along."""
    if design.seismic.trend_deg is None:
        return np.broadcast_to(on_arrays.shaken(design), (count, 3))
    trend = np.radians(_broadcast(design.seismic.trend_deg, count))
    return np.stack([np.sin(trend), np.cos(trend), np.zeros(count)], axis=1)


def _broadcast(values: Any, count: int) -> Floats:
    """Return a number of a design for each of n, (n,)."""
    return np.broadcast_to(np.asarray(values, dtype=np.float64), count)


def _loads(
    design: SlopeDesign, on_arrays: OnArrays[Any], bounds: Bounds, solids: Polytopes
) -> Floats:
    """Return the loads (n, 6) on n blocks: force in kN, and moment in kN m about the centroid.

    Blocks that are a metre of a slope have them in the axes of its section.
    """
    count = len(solids.volume)
    weight = _broadcast(design.rock.unit_weight_kn_m3, count)[:, None] * solids.volume[:, None]
    shaking = np.zeros((1, 3))
    if np.any(design.seismic.coefficient):
        shaking = _broadcast(design.seismic.coefficient, count)[:, None] * shaken_toward(
            design, on_arrays, count
        )
    loads = [PointForce(weight * (shaking - [0.0, 0.0, 1.0]))]
    loads += [
        PointForce(_vectors(force.components_kn), _place(force.at_m, bounds))
        for force in design.forces
    ]
    loads += [_pull(bolt, bounds, count) for bolt in design.bolts if bolt.acts == "active"]
    if design.is_wet or design.is_cut_for_loads:
        with np.errstate(divide="ignore", invalid="ignore"):
            loads += pushes(design, LocalSlope(bounds, solids), on_arrays.full)[0].values()
    return np.asarray(np.sum([_block_load(load, bounds, solids) for load in loads], axis=0))


def _passive_bolts(design: SlopeDesign, bounds: Bounds, solids: Polytopes) -> Floats:
    """Return what passive bolts at full capacity do to n blocks, (n, b, 6), as loads have it."""
    bolts, count = [bolt for bolt in design.bolts if bolt.acts == "passive"], len(solids.volume)
    pulls = np.zeros((count, len(bolts), 6))
    for k, bolt in enumerate(bolts):
        pulls[:, k] = _block_load(_pull(bolt, bounds, count), bounds, solids)
    forces = np.abs(pulls[:, :, :3]).max(axis=2)
    pulls[forces <= _ALONG_SLOPE * forces.max(initial=0.0)] = 0.0
    return pulls


def _pull(bolt: Bolt, bounds: Bounds, count: int) -> PointForce:
    return PointForce(
        _broadcast(bolt.force_kn, count)[:, None] * bolt.toward.vector(),
        _place(bolt.head_m, bounds),
    )


def _place(point_m: Any, bounds: Bounds) -> Floats | None:
    """Return a point, whose coordinates may be arrays, from the origin of the blocks; None is a centroid."""
    return None if point_m is None else _vectors(point_m) - bounds.origin


def _vectors(components: Any) -> Floats:
    return np.stack(np.broadcast_arrays(*components), axis=-1)


def _block_load(load: PointForce, bounds: Bounds, solids: Polytopes) -> Floats:
    """Return force (kN) and moment (kN m) about the centroid of n blocks (n, 6), as `_loads` has it."""
    force, count = load.force, len(solids.volume)
    moment = (
        np.zeros((count, 3)) if load.point is None else cross(load.point - solids.centroid, force)
    )
    both = np.stack([np.broadcast_to(force, (count, 3)), moment], axis=1)
    if bounds.along is not None:  # per metre: what acts along the slope says nothing
        both = (
            both @ _section_axes(bounds.along).swapaxes(1, 2) * [[1.0, 0.0, 1.0], [0.0, 1.0, 0.0]]
        )
    return both.reshape(count, 6)


def _section_axes(along: Floats) -> Floats:
    """Return axes of sections, (n, 3, 3) or one for all: rows are out of the slope, along it, up."""
    upright = np.broadcast_to([0.0, 0.0, 1.0], along.shape)
    return np.stack([cross(along, upright), along, upright], axis=1)


def _section_lines(
    faces: Floats, counts: Ints, outward: Floats, along: Floats
) -> tuple[Floats, Ints]:
    """Return the ends (n, k, 2, 3) of faces (n, k, c, 3) in their sections, with the block to the left, and counts."""
    axes = _section_axes(along)
    x, _, z = np.moveaxis(outward @ axes.swapaxes(1, 2), 2, 0)
    directions = np.stack([-z, np.zeros_like(x), x], axis=2)
    points = faces @ axes.swapaxes(1, 2)[:, None] * [1.0, 0.0, 1.0]
    places = (points * directions[:, :, None]).sum(axis=3)
    used = np.arange(faces.shape[2]) < counts[:, :, None]
    ends = [np.where(used, side * places, -np.inf).argmax(axis=2) for side in (-1.0, 1.0)]
    return np.take_along_axis(points, np.stack(ends, axis=2)[..., None], axis=2), np.where(
        counts > 0, 2, 0
    )
