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
from slopekit.preie.one_block.forces_limits import ForcesLimits, forces_limits
from slopekit.preie.one_block.polygon_bed import Beds, BedSprings, elastic_bed
from slopekit.preie.outcome import Limit, Outcome
from slopekit.preie.system.contact import SHEAR_TO_NORMAL
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import NO_FORCE
from slopekit.strength.mohr_coulomb import line

#: Ratios of tangential to normal stiffness between which that of rock joints lies: the range of a limit on its bed.
SHEAR_RATIOS = 0.1, 1.0
#: Part of the limit that another ratio, or an early end of a creeping path, must take off to be told.
RANGE_MATTERS = 0.01
#: By `ForcesStatus`.
_OUTCOMES = (Outcome.SLIDES, Outcome.LIFTED, Outcome.LIFTED, Outcome.NO_DRIVING_FORCE, Outcome.NO_DRIVING_FORCE)


@dataclass(frozen=True)
class FlatLimit:
    """The two limits of one block on flat joints.

    Attributes
    ----------
    forces : the limit of the forces alone
    exact : the same slide with its moments balanced, pressed on the whole of each joint; None where there is none
    bed, by_forces, state : the elastic bed, the limit of its forces, which `bed_limits` begins at, and what that found;
        None where forces alone settle it
    """

    forces: Limit
    exact: Limit | None = None
    bed: Beds | None = None
    by_forces: ForcesLimits | None = None
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
    bed = elastic_bed(model, polygons, centroid)
    if model.dilates and not bed.laws:
        from slopekit.preie.one_block.dilating import dilating_slides  # only joints that dilate pay for it

        _, found, state = dilating_slides(bed)
        if state.status[0] == BedStatus.PRESSED:
            return _pressed(forces_limit(model, found), model, bed.in_units_of(model, state.displacement[0]))
    found = forces_limits(bed)
    forces = forces_limit(model, found)
    if np.isnan(found.slides[0, -1]):
        return FlatLimit(forces)
    state = bed_limits(bed, found.slides)
    if state.status[0] == BedStatus.PRESSED and not model.dilates:
        return _pressed(forces, model, bed.in_units_of(model, state.displacement[0]))
    return FlatLimit(forces, bed=bed, by_forces=found, state=state)


def _pressed(forces: Limit, model: Model, displacement: Floats) -> FlatLimit:
    """Return the limit of the forces with moments balanced by an elastic displacement (u,), every node pair pressed."""
    assert forces.factor is not None
    slips, moved = model.relative(forces.velocity)[:, 1:], model.relative(displacement)
    friction = model.tan_friction / forces.factor
    dilation = np.minimum(model.tan_dilation, friction)
    along = (slips * moved[:, 1:]).sum(axis=1) / np.maximum(model.slip(forces.velocity), NO_FORCE)
    softer = 1.0 + dilation * friction / SHEAR_TO_NORMAL  # elastic slip opens nothing, see `dilating`
    normal = np.maximum(-model.control_area * (moved[:, 0] - dilation * along) / softer, 0.0)
    exact = _with_friction(forces, model, normal, np.ones(len(normal)))
    return FlatLimit(exact, exact)


def forces_limit(model: Model, found: ForcesLimits) -> Limit:
    """Return the limit of the forces alone on node pairs; curved laws at the mean traction of each joint.

    Parameters
    ----------
    model : on any node pairs of its contacts; found : of its bed
    """
    outcome, velocity, factor = _OUTCOMES[found.status[0]], found.slides[0, :-1], float(found.factor[0])
    joint = np.unique(model.interface, return_inverse=True)[1]
    normal = found.pushes[0, joint] * model.control_area / np.bincount(joint, model.control_area)[joint]
    limit = Limit(outcome, None, velocity, normal, (normal > 0.0).astype(np.float64), 0, 0.0)
    if not factor > 0.0:
        return replace(limit, factor=0.0) if factor == 0.0 else limit
    if model.lines is not None:
        from slopekit.preie.system.strength_lines import drawn  # only curved laws pay for it

        model = drawn(model, normal)
    return _with_friction(replace(limit, factor=factor, pulls=found.pulls[0]), model, normal, limit.bond)


def _with_friction(limit: Limit, model: Model, normal: Floats, bond: Floats) -> Limit:
    """Return the limit of a slide with its friction under normal forces (n,), where bonds (n,) are left."""
    assert limit.factor is not None
    strength = line(bond * model.cohesion, model.tan_friction, normal) / limit.factor
    friction = -(strength / np.maximum(model.slip(limit.velocity), NO_FORCE))[:, None]
    return replace(limit, normal_force=normal, bond=bond, friction=friction * model.relative(limit.velocity)[:, 1:])


def refined_factor(limit: FlatLimit, split: int) -> float | None:
    """Return the limit factor with each triangle of a pressed part split in four `split` times; None without one.

    The path is followed on triangles as fine, not on the coarse ones of `flat_limit`.
    """
    if limit.bed is None or limit.by_forces is None:
        return limit.factor
    return lower(limit.forces.factor, bed_limits(limit.bed, limit.by_forces.slides, (split,), max(split, COARSE)))


def factor_on_pressed(bed: Beds, pressed_share: Floats) -> float:
    """Return the factor of the forces alone with joints no larger than their pressed parts (m,); not a number without.

    What it lies below the factor on whole joints is what the cohesion of open parts is worth; the rest of what a bed
    takes is due to moments.
    """
    area = bed.line[:, 0] * np.maximum(pressed_share, NO_FORCE)
    return float(forces_limits(replace(bed, line=np.column_stack([area, bed.line[:, 1:]]))).factor[0])


def lowest_factor(limit: FlatLimit) -> float | None:
    """Return the limit with other shear stiffness, or soon after a path begins to creep; None where they matter little.

    `SHEAR_RATIOS` bound the shear stiffness; a path that goes on for more than 30 elastic displacements has all but
    failed there.
    """
    bed, by_forces, state = limit.bed, limit.by_forces, limit.state
    if bed is None or by_forces is None or state is None or limit.factor is None:
        return None
    early, one = state.early[0], np.zeros(1, dtype=np.int64)
    if np.isnan(early):
        path = BedPath(BedSprings(bed, COARSE))
        u, reduction = path.start(one, by_forces.slides[:, -1])
        early = np.exp(path.follow(one, u, reduction, lengths(u), np.log(state.reduction)).early[0])
    ratios = [bed_limits(replace(bed, shear_ratio=ratio), by_forces.slides).factor[0] for ratio in SHEAR_RATIOS]
    lowest = float(np.nanmin([limit.factor, 1.0 / early, *ratios]))
    return lowest if lowest < limit.factor * (1.0 - RANGE_MATTERS) else None


def lower(forces: float | None, bed: BedLimits) -> float | None:
    """Return the lower of a factor of the forces, which may be none, and that of a bed; None without one of a bed."""
    factor = float(bed.factor[0])
    if math.isnan(factor):
        return None
    return factor if forces is None else min(forces, factor)
