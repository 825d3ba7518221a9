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
from slopekit.preie.one_block.bed_limits import BedStatus, Slides
from slopekit.preie.one_block.cracked import CrackedBase, cracked_base, early_factor
from slopekit.preie.one_block.limit import dilating_limit, forces_only_limit, stands_without_strength
from slopekit.preie.one_block.passes import Limit, Outcome
from slopekit.preie.one_block.polygon_bed import PolygonBed, bed_of
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import TINY
from slopekit.strength.mohr_coulomb import line

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
    bed, slides, state : the elastic bed, where its limit is looked for, and that; None where forces alone settle it
    """

    forces: Limit
    exact: Limit | None = None
    bed: PolygonBed | None = None
    slides: Slides | None = None
    state: CrackedBase | None = None


def flat_limit(model: Model, polygons: Mapping[int, Floats], centroid: Floats) -> FlatLimit:
    """Return the limits of one block by its forces and on its bed.

    Parameters
    ----------
    model : of the block, from node pairs on the polygons
    polygons : interface -> (k, 3) corners in m, or (2, 3) ends of a line in a section; centroid : (3,) m
    """
    if model.dilates and (exact := dilating_limit(model)) is not None:
        return FlatLimit(exact, exact)
    forces = forces_limit(model)
    stands = forces.outcome is Outcome.NO_DRIVING_FORCE and stands_without_strength(model)
    if stands or forces.outcome in (Outcome.LIFTED, Outcome.NOT_CONVERGED) or forces.factor == 0.0:
        return FlatLimit(forces)
    bed = bed_of(model, polygons, centroid)
    slides = slides_of(model, bed, forces)
    state = cracked_base(bed, slides)
    if state.status is BedStatus.PRESSED and not model.dilates:
        exact = _pressed_slide(model, forces, bed.in_units_of(model, state.opening))
        return FlatLimit(exact, exact)
    return FlatLimit(forces, bed=bed, slides=slides, state=state)


def slides_of(model: Model, bed: PolygonBed, forces: Limit) -> Slides:
    """Return the slide of the forces alone as those of a bed are given."""
    touching = [bool(forces.bond[model.interface == key].any()) for key in bed.keys.tolist()]
    velocity = forces.velocity_of(model)
    if not forces.factor:
        return Slides(np.ones(1), velocity[None], np.zeros(len(touching), dtype=bool))
    return Slides(np.array([1.0 / forces.factor]), velocity[None], np.array(touching))


def _pressed_slide(model: Model, forces: Limit, opening: Floats) -> Limit:
    """Return the slide of the forces alone with its moments balanced by linear pressures, on node pairs."""
    assert forces.factor is not None
    normal = np.maximum(-model.control_area * (model.normal_rows @ opening), 0.0)
    strength = line(model.cohesion, model.tan_friction, normal) / forces.factor
    velocity = forces.velocity_of(model)
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
    """Return the limit factor with each triangle of a pressed part split in four `split` times; None without one."""
    if limit.bed is None or limit.slides is None:
        return (limit.exact or limit.forces).factor
    bed_factor = cracked_base(limit.bed, limit.slides, (split,)).factor
    return None if bed_factor is None else lower(limit.forces.factor, bed_factor)


def lowest_factor(limit: FlatLimit) -> float | None:
    """Return the limit with other shear stiffness, or soon after a path begins to creep; None where they matter little.

    `SHEAR_RATIOS` bound the shear stiffness; a path that goes on for more than 30 elastic displacements has all but
    failed there.
    """
    bed, slides, state = limit.bed, limit.slides, limit.state
    if bed is None or slides is None or state is None or state.factor is None:
        return None
    factor = lower(limit.forces.factor, state.factor)
    others = [early_factor(bed, state)]
    for ratio in SHEAR_RATIOS:
        others.append(cracked_base(replace(bed, shear_ratio=ratio), slides).factor)
    lowest = min(other for other in (*others, factor) if other is not None)
    return lowest if lowest < factor * (1.0 - RANGE_MATTERS) else None


def lower(forces: float | None, bed: float) -> float:
    """Return the lower of a factor of the forces, which may be none, and one of the bed."""
    return bed if forces is None else min(forces, bed)
