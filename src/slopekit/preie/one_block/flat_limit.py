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
#: Part of the limit by which another ratio, or an early end of a creeping path, must lower it to be reported.
RANGE_MATTERS = 0.01
#: Outcomes in the order of `ForcesStatus`.
_OUTCOMES = (
    Outcome.SLIDES,
    Outcome.LIFTED,
    Outcome.LIFTED,
    Outcome.NO_DRIVING_FORCE,
    Outcome.NO_DRIVING_FORCE,
)


@dataclass(frozen=True)
class FlatLimit:
    """The two limits of one block on flat joints.

    Attributes
    ----------
    forces : the limit of the forces alone
    exact : the same slide with its moments balanced, pressed on the whole of each joint; None where there is none
    bed, by_forces, state : the elastic bed, the limit of its forces, at which `bed_limits` starts, and the limit on
        the bed; None where forces alone decide
    """

    forces: Limit
    exact: Limit | None = None
    bed: Beds | None = None
    by_forces: ForcesLimits | None = None
    state: BedLimits | None = None

    @property
    def factor(self) -> float | None:
        """The limit factor F, the lower of the two limits; None without one."""
        if self.state is None or self.exact is not None:
            return (self.exact or self.forces).factor
        return governing_factor(self.forces.factor, self.state)


def flat_limit(model: Model, polygons: Mapping[int, Floats], centroid: Floats) -> FlatLimit:
    """Return the limits of one block on flat joints, by its forces alone and on its elastic bed.

    Parameters
    ----------
    model : of the block, from node pairs on the polygons
    polygons : interface -> (k, 3) corners in m, or (2, 3) ends of a line in a section; centroid : (3,) m
    """
    bed = elastic_bed(model, polygons, centroid)
    if model.dilates and not bed.laws:
        from slopekit.preie.one_block.dilating import (
            dilating_slides,
        )  # only joints that dilate pay for it

        _, by_forces, state = dilating_slides(bed)
        if state.status[0] == BedStatus.PRESSED:
            return _moments_balanced(
                forces_limit(model, by_forces), model, bed.in_units_of(model, state.displacement[0])
            )
    by_forces = forces_limits(bed)
    forces = forces_limit(model, by_forces)
    if np.isnan(by_forces.slides[0, -1]):
        return FlatLimit(forces)
    state = bed_limits(bed, by_forces.slides)
    if state.status[0] == BedStatus.PRESSED and not model.dilates:
        return _moments_balanced(forces, model, bed.in_units_of(model, state.displacement[0]))
    return FlatLimit(forces, bed=bed, by_forces=by_forces, state=state)


def _moments_balanced(forces: Limit, model: Model, displacement: Floats) -> FlatLimit:
    """Return the limit of a slide whose moments an elastic displacement (u,) balances, every node pair pressed."""
    assert forces.factor is not None
    slips, relative_motion = model.relative(forces.velocity)[:, 1:], model.relative(displacement)
    friction = model.tan_friction / forces.factor
    dilation = np.minimum(model.tan_dilation, friction)
    along = (slips * relative_motion[:, 1:]).sum(axis=1) / np.maximum(
        model.slip(forces.velocity), NO_FORCE
    )
    softer = (
        1.0 + dilation * friction / SHEAR_TO_NORMAL
    )  # elastic slip opens nothing, see `dilating`
    normal = np.maximum(
        -model.control_area * (relative_motion[:, 0] - dilation * along) / softer, 0.0
    )
    exact = _with_friction(forces, model, normal, np.ones(len(normal)))
    return FlatLimit(exact, exact)


def forces_limit(model: Model, by_forces: ForcesLimits) -> Limit:
    """Return the limit of the forces alone on node pairs; curved laws at the mean traction of each joint.

    Parameters
    ----------
    model : on any node pairs of its contacts; by_forces : limit of the forces of its bed
    """
    outcome, velocity, factor = (
        _OUTCOMES[by_forces.status[0]],
        by_forces.slides[0, :-1],
        float(by_forces.factor[0]),
    )
    joint = np.unique(model.interface, return_inverse=True)[1]
    normal = (
        by_forces.pushes[0, joint]
        * model.control_area
        / np.bincount(joint, model.control_area)[joint]
    )
    limit = Limit(outcome, None, velocity, normal, (normal > 0.0).astype(np.float64), 0, 0.0)
    if not factor > 0.0:
        return replace(limit, factor=0.0) if factor == 0.0 else limit
    if model.lines is not None:
        from slopekit.preie.system.strength_lines import with_secants  # only curved laws pay for it

        model = with_secants(model, normal)
    return _with_friction(
        replace(limit, factor=factor, pulls=by_forces.pulls[0]), model, normal, limit.bond
    )


def _with_friction(limit: Limit, model: Model, normal: Floats, bond: Floats) -> Limit:
    """Return the limit of a slide completed by its friction, for normal forces (n,) and remaining bonds (n,)."""
    assert limit.factor is not None
    strength = line(bond * model.cohesion, model.tan_friction, normal) / limit.factor
    friction = -(strength / np.maximum(model.slip(limit.velocity), NO_FORCE))[:, None]
    return replace(
        limit,
        normal_force=normal,
        bond=bond,
        friction=friction * model.relative(limit.velocity)[:, 1:],
    )


def refined_factor(limit: FlatLimit, split: int) -> float | None:
    """Return the limit factor with each triangle of the pressed parts split in four `split` times; None without one.

    The path is followed on triangles as fine, not on the coarse ones of `flat_limit`.
    """
    if limit.bed is None or limit.by_forces is None:
        return limit.factor
    return governing_factor(
        limit.forces.factor,
        bed_limits(limit.bed, limit.by_forces.slides, (split,), max(split, COARSE)),
    )


def factor_on_pressed(bed: Beds, pressed_share: Floats) -> float:
    """Return the factor of the forces alone with joints as large as their pressed shares (m,), NaN without one.

    Its difference from the factor on whole joints is due to the cohesion of open parts; the rest of the reduction on
    the bed is due to moments.
    """
    area = bed.line[:, 0] * np.maximum(pressed_share, NO_FORCE)
    return float(
        forces_limits(replace(bed, line=np.column_stack([area, bed.line[:, 1:]]))).factor[0]
    )


def lowest_factor(limit: FlatLimit) -> float | None:
    """Return the lowest limit factor for other shear stiffness or an early end of creep; None if it is hardly lower.

    `SHEAR_RATIOS` bound the shear stiffness; a path that goes on for more than 30 elastic displacements has all but
    failed there.
    """
    bed, by_forces, state = limit.bed, limit.by_forces, limit.state
    if bed is None or by_forces is None or state is None or limit.factor is None:
        return None
    early, blocks = state.early[0], np.zeros(1, dtype=np.int64)
    if np.isnan(early):
        path = BedPath(BedSprings(bed, COARSE))
        u, reduction = path.start(blocks, by_forces.slides[:, -1])
        early = np.exp(
            path.follow(blocks, u, reduction, lengths(u), np.log(state.reduction)).early[0]
        )
    ratios = [
        bed_limits(replace(bed, shear_ratio=ratio), by_forces.slides).factor[0]
        for ratio in SHEAR_RATIOS
    ]
    lowest = float(np.nanmin([limit.factor, 1.0 / early, *ratios]))
    return lowest if lowest < limit.factor * (1.0 - RANGE_MATTERS) else None


def governing_factor(forces: float | None, bed: BedLimits) -> float | None:
    """Return the lower of the factors by forces, which may be None, and on the bed; None without one on the bed."""
    factor = float(bed.factor[0])
    if math.isnan(factor):
        return None
    return factor if forces is None else min(forces, factor)
