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
from slopekit.geometry.polytopes import Polytopes, polytopes
from slopekit.kinds.single_block.batch_states import block_statuses
from slopekit.kinds.single_block.closed_forms import OnArrays
from slopekit.kinds.single_block.held_bolts import Bounds
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
    outward, offsets = list(bounds.outward), list(bounds.offsets)
    if bounds.along is not None:  # a metre of the slope
        outward += [bounds.along, -bounds.along]
        offsets += [np.full(1, 0.5)] * 2
    solids = polytopes(
        np.stack([np.broadcast_to(normals, (count, 3)) for normals in outward], axis=1),
        np.stack([np.broadcast_to(offset, count) for offset in offsets], axis=1),
        np.broadcast_to(bounds.size, count),
    )
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

    def _add(self, force: Floats, at_m: Any) -> None:
        """Add forces (n, 3) through a point in the coordinates of the user, or through the centroids."""
        self.load[:, :3] += force
        if at_m is not None:
            self.load[:, 3:] += cross(self._vectors(at_m) - self.bounds.origin - self.solids.centroid, force)

    def _weight(self, on_arrays: OnArrays[Any]) -> None:
        """Add the weight, and what an earthquake makes of it."""
        rock, seismic = self.design.rock, self.design.seismic
        weight = _each(rock.unit_weight_kn_m3, self.count) * self.solids.volume
        self.load[:, 2] -= weight
        if not np.any(seismic.coefficient):
            return
        self.load[:, :3] += (seismic.coefficient * weight)[:, None] * shaken_toward(self.design, on_arrays, self.count)

    def _forces(self) -> None:
        """Add forces and active bolts."""
        for force in self.design.forces:
            self._add(self._vectors(force.components_kn), force.at_m)
        for bolt in self.design.bolts:
            self._add(_each(bolt.force_kn, self.count)[:, None] * bolt.toward.vector(), bolt.head_m)

    def _water(self, on_arrays: OnArrays[Any]) -> None:
        """Add water on the joints and in the crack."""
        water, bounds = self.design.water, self.bounds
        crack = [plane for plane in range(len(bounds.outward)) if plane not in (*bounds.joints, *bounds.free)]
        wet = [*bounds.joints, *crack]
        given = water.mode == "pressures"
        if given:
            for plane, mean in zip(wet, water.pressures_kpa, strict=False):
                self._press(1.0, *self.solids.even(plane, _each(mean, self.count)))
        fill = 1.0 if water.crack_water_m is not None else 0.0 if given else water.fill
        parts = dict.fromkeys(wet, fill) | dict.fromkeys(crack, fill if water.crack_fill is None else water.crack_fill)
        if any(np.any(part) for part in parts.values()):
            assert on_arrays.full is not None
            for plane, triangles, pressures in on_arrays.full(self.design, self.solids):
                self._press(parts[plane], plane, triangles, pressures)

    def _press(self, part: Any, plane: int, triangles: Floats, pressures: Floats) -> None:
        """Add a part of pressures (n, t, 3) at the corners of triangles (n, t, 3, 3) of the faces of a plane.

        In a triangle of area A with pressures p_i at its corners x_i: ∫ p dA = A Σp / 3,
        ∫ p x dA = A (Σp Σx + Σ p_i x_i) / 12.
        """
        sides = cross(triangles[:, :, 1] - triangles[:, :, 0], triangles[:, :, 2] - triangles[:, :, 0])
        areas, total = 0.5 * np.sqrt((sides * sides).sum(axis=2)), pressures.sum(axis=2)
        arms = triangles - self.solids.centroid[:, None, None]
        weighed = total[:, :, None] * arms.sum(axis=2) + (pressures[..., None] * arms).sum(axis=2)
        inward = -_each(part, self.count)[:, None] * self.solids.outward[:, plane]
        self.load[:, :3] += (areas * total).sum(axis=1)[:, None] / 3.0 * inward
        self.load[:, 3:] += cross((areas[:, :, None] * weighed).sum(axis=1) / 12.0, inward)
