"""The limit of one block on flat joints: the lower of what its forces alone allow and what its elastic bed allows.

    limit = min(F_forces, F_bed)

F_forces balances the forces, with cohesion on the whole of every joint in contact, as Hoek & Bray do. F_bed balances
the moments too, on a no-tension elastic bed of the exact joint polygons (`polygon_bed`): cohesion and friction act
where a joint is pressed, and strength is reduced from the stuck state. Where the exact slide with every joint closed
presses on the whole of each joint both are the same number, and no path is followed.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.records import dataclass
from slopekit.preie.one_block.cracked import CrackedBase, cracked_base, cracked_limit
from slopekit.preie.one_block.limit import dilating_limit, forces_only_limit, stands_without_strength
from slopekit.preie.one_block.limit_state import LimitState, intact_limit_state
from slopekit.preie.one_block.passes import Limit, Outcome, exact_limit
from slopekit.preie.one_block.polygon_bed import PolygonBed, bed_of
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import NO_FORCE

#: Ratios of tangential to normal stiffness between which that of rock joints lies: the range of a limit on its bed.
SHEAR_RATIOS = 0.1, 1.0
#: Part of the limit that another ratio, or an early end of a creeping path, must take off to be told.
RANGE_MATTERS = 0.01


@dataclass(frozen=True, slots=True)
class FlatLimit:
    """The two limits of one block on flat joints.

    Attributes
    ----------
    forces : the limit of the forces alone
    exact : the same slide with its moments balanced, pressed on the whole of each joint; None where there is none
    bed, state : the elastic bed and its limit; None where the forces alone settle the limit
    """

    forces: Limit
    exact: Limit | None = None
    bed: PolygonBed | None = None
    state: CrackedBase | None = None


def flat_limit(model: Model, polygons: Mapping[int, Floats], centroid: Floats) -> FlatLimit:
    """Return the limits of one block by its forces and on its bed.

    Parameters
    ----------
    model : of the block, from node pairs on the polygons
    polygons : interface -> (k, 3) corners in m, or (2, 3) ends of a line in a section; centroid : (3,) m
    """
    limit = forces_and_bed(model, polygons, centroid)
    if limit.bed is None:
        return limit
    return replace(limit, state=cracked_base(limit.bed, limit.forces.factor or 1.0))


def forces_and_bed(model: Model, polygons: Mapping[int, Floats], centroid: Floats) -> FlatLimit:
    """Return the limit of one block by its forces and the bed that is to be followed, whose limit is not yet found."""
    if model.dilates and (exact := dilating_limit(model)) is not None:
        return FlatLimit(exact, exact)
    forces = forces_limit(model)
    stands = forces.outcome is Outcome.NO_DRIVING_FORCE and stands_without_strength(model)
    if stands or forces.outcome in (Outcome.LIFTED, Outcome.NOT_CONVERGED) or forces.factor == 0.0:
        return FlatLimit(forces)
    bed = bed_of(model, polygons, centroid)
    if model.lines is None and not model.dilates:
        slide = intact_limit_state(model)
        if slide is not None and presses_everywhere(bed, slide):
            exact = exact_limit(slide, np.ones(len(model.control_area)), 0)
            return FlatLimit(exact, exact)
    return FlatLimit(forces, bed=bed)


def forces_limit(model: Model) -> Limit:
    """Return the limit of the forces alone; curved laws at the mean traction of each joint, as closed forms take it."""
    if model.lines is None:
        return forces_only_limit(model)
    from slopekit.preie.system.strength_lines import mean_stress_limit  # only curved laws pay for it

    return mean_stress_limit(model)


def presses_everywhere(bed: PolygonBed, slide: LimitState) -> bool:
    """Return whether an elastic displacement closes every corner: linear pressure is then nowhere below zero."""
    return all(float((bed.corner_rows(k)[:, 0] @ slide.displacement).max()) < NO_FORCE for k in range(len(bed.corners)))


def refined_factor(limit: FlatLimit, split: int) -> float | None:
    """Return the limit factor with each triangle of a pressed part split in four `split` times; None without one."""
    if limit.bed is None:
        return (limit.exact or limit.forces).factor
    bed_factor = cracked_limit(limit.bed, limit.forces.factor or 1.0, split).factor
    return None if bed_factor is None else lower(limit.forces.factor, bed_factor)


def lowest_factor(limit: FlatLimit) -> float | None:
    """Return the limit with other shear stiffness, or soon after a path begins to creep; None where they matter little.

    `SHEAR_RATIOS` bound the shear stiffness; a path that goes on for more than 30 elastic displacements has all but
    failed there.
    """
    if limit.bed is None or limit.state is None or limit.state.factor is None:
        return None
    factor = lower(limit.forces.factor, limit.state.factor)
    others = [limit.state.early_factor]
    for ratio in SHEAR_RATIOS:
        others.append(cracked_base(replace(limit.bed, shear_ratio=ratio), factor).factor)
    lowest = min(other for other in (*others, factor) if other is not None)
    return lowest if lowest < factor * (1.0 - RANGE_MATTERS) else None


def lower(forces: float | None, bed: float) -> float:
    """Return the lower of a factor of the forces, which may be none, and one of the bed."""
    return bed if forces is None else min(forces, bed)
