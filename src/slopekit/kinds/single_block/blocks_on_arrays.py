"""Single blocks of n designs at once: cut by their planes, loaded, on the joints that carry them.

The designs are one whose numbers may be arrays (n,): what `OnArrays` takes.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from slopekit.core.arrays import Floats, Ints, NDArray, cross
from slopekit.design.ground_water import SlopeDesign
from slopekit.design.parts import Strength
from slopekit.geometry.polytopes import Polytopes
from slopekit.kinds.single_block.batch_states import block_statuses
from slopekit.kinds.single_block.closed_forms import OnArrays
from slopekit.kinds.single_block.held_bolts import Bounds
from slopekit.kinds.water import blocks_within, pushes, slope_of
from slopekit.loads import PointForce
from slopekit.preie.batch import BlockLimits, Blocks, limits_of_blocks

_NO_BLOCK = "E208"  # a crack cuts it in two


@dataclass(frozen=True)
class LimitsOfMany:
    """What PRE-IE says of n designs: `status` (n,) or the code of why there is no block, `limit` and `forces` (n,).

    `limit` is the factor of safety, `forces` that of the forces alone; not a number where there is none. `rows` (b,)
    are the numbers of those that form blocks, and `found` is all that PRE-IE says of these, None of none.
    """

    status: NDArray[np.str_]
    limit: Floats
    forces: Floats
    rows: Ints = field(default_factory=lambda: np.arange(0))
    found: BlockLimits | None = None


def limits_on_arrays(
    design: SlopeDesign, on_arrays: OnArrays[Any], strengths: Sequence[Strength], count: int
) -> LimitsOfMany:
    """Return PRE-IE's limits of n designs, without passive bolts.

    Parameters
    ----------
    design : whose numbers may be arrays (n,), as `OnArrays` takes it; strengths : of the joints, likewise
    """
    blocks = blocks_of(design, on_arrays, strengths, count)
    there = np.flatnonzero((blocks.counts > 0).any(axis=1))
    status = np.full(count, _NO_BLOCK, dtype=object)
    limit, forces = np.full((2, count), np.nan)
    found = limits_of_blocks(blocks.of(there)) if len(there) else None
    if found is not None:
        status[there], forces[there] = block_statuses(found), found.forces
        limit[there] = np.where(found.factor > 0.0, found.factor, np.nan)  # no strength at all: a status, no number
    return LimitsOfMany(status.astype(np.str_), limit, forces, there, found)


def blocks_of(design: SlopeDesign, on_arrays: OnArrays[Any], strengths: Sequence[Strength], count: int) -> Blocks:
    """Return the blocks of n designs, as `limits_on_arrays` takes them; without contacts where planes cut none."""
    bounds = on_arrays.bounds(design)
    solids = blocks_within(bounds, count)
    joints = list(bounds.joints)
    cohesion, friction = (
        np.stack([_each(getattr(strength, name), count) for strength in strengths], axis=1)
        for name in ("cohesion_kpa", "friction_angle_deg")
    )
    return Blocks(
        corners=solids.faces[:, joints] - solids.centroid[:, None, None],
        counts=solids.counts[:, joints],
        cohesion=cohesion,
        tan_friction=np.tan(np.radians(friction)),
        load=_loads(design, on_arrays, bounds, solids),
    )


def shaken_toward(design: SlopeDesign, on_arrays: OnArrays[Any], count: int) -> Floats:
    """Return the level unit vectors (n, 3) that an earthquake acts along."""
    if design.seismic.trend_deg is None:
        assert on_arrays.shaken is not None
        return np.broadcast_to(on_arrays.shaken(design), (count, 3))
    trend = np.radians(_each(design.seismic.trend_deg, count))
    return np.stack([np.sin(trend), np.cos(trend), np.zeros(count)], axis=1)


def _each(values: Any, count: int) -> Floats:
    """Return a number of a design for each of n, (n,)."""
    return np.broadcast_to(np.asarray(values, dtype=np.float64), count)


def _loads(design: SlopeDesign, on_arrays: OnArrays[Any], bounds: Bounds, solids: Polytopes) -> Floats:
    """Return the loads (n, 6) on n blocks: force in kN, and moment in kN m about the centroid."""
    count = len(solids.volume)

    def vectors(components: Any) -> Floats:
        return np.stack([_each(component, count) for component in components], axis=1)

    def place(point_m: Any) -> Floats | None:
        return None if point_m is None else vectors(point_m) - bounds.origin

    weight = _each(design.rock.unit_weight_kn_m3, count)[:, None] * solids.volume[:, None]
    loads = [PointForce(weight * (_shaking(design, on_arrays, count) - [0.0, 0.0, 1.0]))]
    loads += [PointForce(vectors(force.components_kn), place(force.at_m)) for force in design.forces]
    loads += [
        PointForce(_each(bolt.force_kn, count)[:, None] * bolt.toward.vector(), place(bolt.head_m))
        for bolt in design.bolts
    ]
    if design.is_wet or design.is_cut_for_loads:
        assert on_arrays.full is not None
        with np.errstate(divide="ignore", invalid="ignore"):
            loads += pushes(design, slope_of(bounds, solids, on_arrays.full))[0].values()
    total = np.zeros((count, 6))
    for load in loads:
        total[:, :3] += load.force
        if load.at is not None:
            total[:, 3:] += cross(load.at - solids.centroid, load.force)
    if bounds.along is not None:  # per metre: what acts along the slope says nothing
        along, turns = bounds.along, (total[:, 3:] * bounds.along).sum(axis=1)
        total[:, :3] -= (total[:, :3] * along).sum(axis=1)[:, None] * along
        total[:, 3:] = turns[:, None] * along
    return total


def _shaking(design: SlopeDesign, on_arrays: OnArrays[Any], count: int) -> Floats:
    """Return what an earthquake adds to the weight, (n, 3) parts of it."""
    if not np.any(design.seismic.coefficient):
        return np.zeros((count, 3))
    return _each(design.seismic.coefficient, count)[:, None] * shaken_toward(design, on_arrays, count)
