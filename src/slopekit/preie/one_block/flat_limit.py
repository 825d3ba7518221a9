"""The limit of one block on flat joints: the lower of what its forces alone allow and what its elastic bed allows.

    limit = min(F_forces, F_bed)

F_forces balances the forces, with cohesion on the whole of every joint in contact, as Hoek & Bray do. F_bed balances
the moments too, on a no-tension elastic bed of the exact joint polygons (`polygon_bed`): cohesion and friction act
where a joint is pressed, and strength is reduced from the stuck state. Where the exact slide with every joint closed
presses on the whole of each joint both are the same number, and no path is followed.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.preie.one_block.bed_limits import BedLimits, BedStatus, bed_limits
from slopekit.preie.one_block.bed_path import COARSE, BedPath, lengths
from slopekit.preie.one_block.limit import forces_only_limit, stands_without_strength
from slopekit.preie.one_block.polygon_bed import Beds, BedSprings, elastic_bed
from slopekit.preie.outcome import Limit, Outcome
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import TINY
from slopekit.strength.mohr_coulomb import line

#: Ratios of tangential to normal stiffness between which that of rock joints lies: the range of a limit on its bed.
SHEAR_RATIOS = 0.1, 1.0
#: Part of the limit that another ratio, or an early end of a creeping path, must take off to be told.
RANGE_MATTERS = 0.01


@dataclass(frozen=True)
class FlatLimit:
    """The two limits of one block on flat joints.

    Attributes
    ----------
    forces : the limit of the forces alone
    exact : the same slide with its moments balanced, pressed on the whole of each joint; None where there is none
    bed, slides, state : the elastic bed, the slide that `bed_limits` begins at, and what it found; None where forces
        alone settle it
    """

    forces: Limit
    exact: Limit | None = None
    bed: Beds | None = None
    slides: Floats | None = None
    state: BedLimits | None = None

    @property
    def factor(self) -> float | None:
        """The limit factor, None without one."""
        if self.state is None or self.exact is not None:
            return (self.exact or self.forces).factor
        return lower(self.forces.factor, self.state)


def flat_limit(model: Model, polygons: Mapping[int, Floats], centroid: Floats) -> FlatLimit:
    """Return the limits of one block by its forces and on its bed.

    Parameters
    ----------
    model : of the block, from node pairs on the polygons
    polygons : interface -> (k, 3) corners in m, or (2, 3) ends of a line in a section; centroid : (3,) m
    """
    if model.dilates:
        from slopekit.preie.one_block.pairs_limit import pressed_limit  # only joints that dilate pay for the path

        exact = pressed_limit(model)
        if exact is not None:
            return FlatLimit(exact, exact)
    forces = forces_limit(model)
    stands = forces.outcome is Outcome.NO_DRIVING_FORCE and stands_without_strength(model)
    if stands or forces.outcome in (Outcome.LIFTED, Outcome.NOT_CONVERGED) or forces.factor == 0.0:
        return FlatLimit(forces)
    bed = elastic_bed(model, polygons, centroid)
    known = forces.full_velocity(model) * (forces.factor is not None)
    slides = np.append(known, 1.0 / (forces.factor or 1.0))[None]
    state = bed_limits(bed, slides)
    if state.status[0] == BedStatus.PRESSED and not model.dilates:
        exact = _pressed_slide(model, forces, bed.in_units_of(model, state.displacement[0]))
        return FlatLimit(exact, exact)
    return FlatLimit(forces, bed=bed, slides=slides, state=state)


def _pressed_slide(model: Model, forces: Limit, opening: Floats) -> Limit:
    """Return the slide of the forces alone with its moments balanced by linear pressures, on node pairs."""
    assert forces.factor is not None
    normal = np.maximum(-model.control_area * (model.normal_rows @ opening), 0.0)
    strength = line(model.cohesion, model.tan_friction, normal) / forces.factor
    velocity = forces.full_velocity(model)
    slip = model.relative(velocity)[:, 1:]
    friction = -(strength / np.maximum(model.slip(velocity), TINY))[:, None] * slip
    return replace(forces, velocity=velocity, normal_force=normal, bond=np.ones(len(normal)), friction=friction)


def forces_limit(model: Model) -> Limit:
    """Return the limit of the forces alone; curved laws at the mean traction of each joint, as closed forms take it."""
    if model.lines is None:
        return forces_only_limit(model)
    from slopekit.preie.system.strength_lines import mean_stress_limit  # only curved laws pay for it

    return mean_stress_limit(model)


def refined_factor(limit: FlatLimit, split: int) -> float | None:
    """Return the limit factor with each triangle of a pressed part split in four `split` times; None without one.

    The path is followed on triangles as fine, not on the coarse ones of `flat_limit`.
    """
    if limit.bed is None or limit.slides is None:
        return limit.factor
    return lower(limit.forces.factor, bed_limits(limit.bed, limit.slides, (split,), max(split, COARSE)))


def lowest_factor(limit: FlatLimit) -> float | None:
    """Return the limit with other shear stiffness, or soon after a path begins to creep; None where they matter little.

    `SHEAR_RATIOS` bound the shear stiffness; a path that goes on for more than 30 elastic displacements has all but
    failed there.
    """
    bed, slides, state = limit.bed, limit.slides, limit.state
    if bed is None or slides is None or state is None or limit.factor is None:
        return None
    early, one = state.early[0], np.zeros(1, dtype=np.int64)
    if np.isnan(early):
        path = BedPath(BedSprings(bed, COARSE))
        u, reduction = path.start(one, slides[:, -1])
        early = np.exp(path.follow(one, u, reduction, lengths(u), np.log(state.reduction)).early[0])
    ratios = [bed_limits(replace(bed, shear_ratio=ratio), slides).factor[0] for ratio in SHEAR_RATIOS]
    lowest = float(np.nanmin([limit.factor, 1.0 / early, *ratios]))
    return lowest if lowest < limit.factor * (1.0 - RANGE_MATTERS) else None


def lower(forces: float | None, bed: BedLimits) -> float | None:
    """Return the lower of a factor of the forces, which may be none, and that of a bed; None without one of a bed."""
    factor = float(bed.factor[0])
    if math.isnan(factor):
        return None
    return factor if forces is None else min(forces, factor)
