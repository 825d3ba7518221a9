"""Single blocks of n designs at once: cut by their planes, loaded, on the joints that carry them.

The designs are one whose numbers may be arrays (n,): what `OnArrays` takes.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from slopekit.core.arrays import Floats, NDArray, cross
from slopekit.design.ground_water import SlopeDesign
from slopekit.design.parts import Strength
from slopekit.geometry.polytopes import Polytopes
from slopekit.kinds.single_block.batch_states import block_statuses
from slopekit.kinds.single_block.closed_forms import OnArrays
from slopekit.kinds.single_block.held_bolts import Bounds
from slopekit.kinds.single_block.loads_on_arrays import blocks_within, slope_of
from slopekit.kinds.water import pushes
from slopekit.preie.batch import Blocks, limits_of_blocks

_NO_BLOCK = "E208"  # a crack cuts it in two


@dataclass(frozen=True)
class LimitsOfMany:
    """What PRE-IE says of n designs: `status` (n,) or the code of why there is no block, `limit` and `forces` (n,).

    `limit` is the factor of safety, `forces` that of the forces alone; not a number where there is none.
    """

    status: NDArray[np.str_]
    limit: Floats
    forces: Floats

    def to_record(self) -> dict[str, list[Any]]:
        """Return it as JSON values."""
        return {name: of.tolist() for name, of in vars(self).items()}


def limits_of(records: Sequence[Mapping[str, Sequence[Any]]]) -> LimitsOfMany:
    """Return what `LimitsOfMany.to_record` made of all parts of many designs."""
    names = ("status", "limit", "forces")
    status, limit, forces = ([of for record in records for of in record[name]] for name in names)
    return LimitsOfMany(np.array(status, dtype=np.str_), np.array(limit, np.float64), np.array(forces, np.float64))


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
    if len(there):
        found = limits_of_blocks(blocks.of(there))
        status[there], forces[there] = block_statuses(found), found.forces
        limit[there] = np.where(found.factor > 0.0, found.factor, np.nan)  # no strength at all: a status, no number
    return LimitsOfMany(status.astype(np.str_), limit, forces)


def blocks_of(design: SlopeDesign, on_arrays: OnArrays[Any], strengths: Sequence[Strength], count: int) -> Blocks:
    """Return the blocks of n designs, as `limits_on_arrays` takes them; without contacts where planes cut none."""
    bounds = on_arrays.bounds(design)
    solids = blocks_within(bounds, count)
    joints = list(bounds.joints)
    cohesion, friction = (
        np.stack([_each(getattr(own, name), count) for own in strengths], axis=1)
        for name in ("cohesion_kpa", "friction_angle_deg")
    )
    return Blocks(
        corners=solids.faces[:, joints] - solids.centroid[:, None, None],
        counts=solids.counts[:, joints],
        cohesion=cohesion,
        tan_friction=np.tan(np.radians(friction)),
        load=_Loads(design, on_arrays, bounds, solids).load,
    )


def _each(values: Any, count: int) -> Floats:
    """Return a number of a design for each of n, (n,)."""
    return np.broadcast_to(np.asarray(values, dtype=np.float64), count)


class _Loads:
    """The loads on n blocks: `load` (n, 6), force in kN and moment in kN m about the centroid."""

    def __init__(self, design: SlopeDesign, on_arrays: OnArrays[Any], bounds: Bounds, solids: Polytopes) -> None:
        self.design, self.bounds, self.solids, self.count = design, bounds, solids, len(solids.volume)
        self.load = np.zeros((self.count, 6))
        self._weight(on_arrays)
        self._forces()
        self._water(on_arrays)
        if bounds.along is not None:  # per metre: what acts along the slope says nothing
            along, turns = bounds.along, (self.load[:, 3:] * bounds.along).sum(axis=1)
            self.load[:, :3] -= (self.load[:, :3] * along).sum(axis=1)[:, None] * along
            self.load[:, 3:] = turns[:, None] * along

    def _vectors(self, parts: Any) -> Floats:
        """Return a vector of the design for each block, (n, 3)."""
        return np.stack([_each(part, self.count) for part in parts], axis=1)

    def _add(self, force: Floats, at: Floats | None) -> None:
        """Add forces (n, 3) through points (n, 3) from the origin, or through the centroids."""
        self.load[:, :3] += force
        if at is not None:
            self.load[:, 3:] += cross(at - self.solids.centroid, force)

    def _place(self, at_m: Any) -> Floats | None:
        """Return a point of the design from the origin, (n, 3)."""
        return None if at_m is None else self._vectors(at_m) - self.bounds.origin

    def _weight(self, on_arrays: OnArrays[Any]) -> None:
        """Add the weight, and what an earthquake makes of it."""
        rock, seismic = self.design.rock, self.design.seismic
        weight = _each(rock.unit_weight_kn_m3, self.count) * self.solids.volume
        self.load[:, 2] -= weight
        if not np.any(seismic.coefficient):
            return
        if seismic.trend_deg is None:
            assert on_arrays.shaken is not None
            ways = on_arrays.shaken(self.design)
        else:
            trend = np.radians(_each(seismic.trend_deg, self.count))
            ways = np.stack([np.sin(trend), np.cos(trend), np.zeros(self.count)], axis=1)
        self.load[:, :3] += (seismic.coefficient * weight)[:, None] * ways

    def _forces(self) -> None:
        """Add forces and active bolts."""
        for force in self.design.forces:
            self._add(self._vectors(force.components_kn), self._place(force.at_m))
        for bolt in self.design.bolts:
            self._add(_each(bolt.force_kn, self.count)[:, None] * bolt.toward.vector(), self._place(bolt.head_m))

    def _water(self, on_arrays: OnArrays[Any]) -> None:
        """Add water and surcharge."""
        if not (self.design.is_wet or np.any(self.design.surcharge_kpa)):
            return
        assert on_arrays.full is not None
        with np.errstate(divide="ignore", invalid="ignore"):
            loads, _ = pushes(self.design, slope_of(self.bounds, self.solids, on_arrays.full))
        for push in loads.values():
            self._add(push.force, push.at)
