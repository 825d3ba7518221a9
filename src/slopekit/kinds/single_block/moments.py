"""The limit of one block on flat joints, with the node pairs that carry it and where its joints open.

The limit is the lower of that of the forces alone and that of the block on its elastic bed (`preie` `flat_limit`).
Where the bed settles it, the points of the bed are the node pairs of the result.
"""

from dataclasses import replace

import numpy as np

from slopekit.core.arrays import frozen
from slopekit.core.records import dataclass
from slopekit.evidence import ContactOpening
from slopekit.geometry.interfaces import BEDROCK, NodePairs
from slopekit.kinds.single_block.one_block_states import Bedding, ContactModel
from slopekit.preie.one_block.cracked import CrackedBase
from slopekit.preie.one_block.flat_limit import FlatLimit, flat_limit, forces_limit
from slopekit.preie.one_block.limit import LimitAnalysis, governed
from slopekit.preie.one_block.passes import Limit, Outcome
from slopekit.preie.one_block.polygon_bed import PointForces, PolygonBed
from slopekit.preie.system.model import Model


@dataclass(frozen=True, slots=True)
class MomentLimit:
    """The limit of one block on flat joints.

    Attributes
    ----------
    scene : the node pairs and the model that carry it; analysis : on them
    factors : of the forces and on the bed
    openings : interface -> what of the joint is pressed at the limit of the bed, in local axes
    """

    scene: ContactModel
    analysis: LimitAnalysis
    factors: FlatLimit
    openings: dict[int, ContactOpening]


def moment_limit(scene: ContactModel) -> MomentLimit:
    """Return the limit of one block on flat joints.

    Parameters
    ----------
    scene : with its bedding
    """
    model, bedding = scene.model, scene.bedding
    assert bedding is not None
    factors = flat_limit(model, bedding.polygons, bedding.centroid)
    forces, bed, state = factors.forces, factors.bed, factors.state
    if factors.exact is not None:
        exact = factors.exact
        if model.lines is not None:
            from slopekit.preie.system.strength_lines import drawn  # only curved laws pay for it

            scene = replace(scene, model=drawn(model, exact.normal_force))
        return MomentLimit(scene, LimitAnalysis(exact, exact, exact, False, _curved(scene.model)), factors, {})
    if bed is None or state is None:
        return MomentLimit(scene, LimitAnalysis(forces, forces, forces, False), factors, {})
    if state.factor is None:
        limit = Limit(Outcome.NO_REST, None, np.zeros(model.unknowns), 0.0 * forces.normal_force, forces.bond, 0, 0.0)
        return MomentLimit(scene, LimitAnalysis(limit, forces, limit, True), factors, {})
    carried = state.forces(bed)
    on_bed, limit = _on_bed_points(model, bedding, bed, state, carried)
    analysis = governed(on_bed.model, replace(forces_limit(on_bed.model), factor=forces.factor), limit)
    return MomentLimit(
        on_bed, replace(analysis, model=_curved(on_bed.model)), factors, _openings(bed, state, carried, scene)
    )


def _curved(model: Model) -> Model | None:
    return None if model.lines is None else model


def _on_bed_points(
    model: Model, bedding: Bedding, bed: PolygonBed, state: CrackedBase, forces: PointForces
) -> tuple[ContactModel, Limit]:  # fmt: skip
    """Return the points of the bed as node pairs, with the model on them, and the limit there."""
    keys, count = bed.keys[forces.contact], len(forces.area)
    pairs = NodePairs(
        points=frozen(forces.points * bed.length_scale + bedding.centroid),
        normals=frozen(bed.axes[forces.contact, 0]),
        control_areas=frozen(forces.area * model.area_scale),
        interface=keys,
        plus=np.zeros(count, dtype=np.int64),
        minus=np.full(count, BEDROCK),
    )
    on_points = bedding.model_of(pairs)
    if on_points.lines is not None:
        from slopekit.preie.system.strength_lines import drawn

        on_points = drawn(on_points, forces.normal)
    moved = bed.in_units_of(on_points, state.velocity)
    limit = Limit(
        outcome=Outcome.SLIDES,
        factor=state.factor,
        velocity=moved / np.sqrt(moved @ moved),
        normal_force=forces.normal,
        bond=forces.pressed.astype(np.float64),
        passes=state.points,
        change=0.0,
        friction=forces.shear,
        pulls=forces.pulls,
    )
    return ContactModel(pairs, on_points, bedding), limit


def _openings(
    bed: PolygonBed, state: CrackedBase, forces: PointForces, scene: ContactModel
) -> dict[int, ContactOpening]:
    """Return by interface what is pressed, its force and where that acts, and the corner that opens most."""
    opening, model = state.opening, scene.model
    assert scene.bedding is not None
    openings, centroid = dict[int, ContactOpening](), scene.bedding.centroid
    for k, key in enumerate(bed.keys.tolist()):
        contact = forces.contact == k
        push, area = forces.normal[contact], forces.area[contact]
        total, pressed = float(push.sum()), float(area[forces.pressed[contact]].sum())
        gaps = bed.corner_rows(k)[:, 0] @ opening
        widest = int(np.argmax(gaps))
        at = (push @ forces.points[contact]) / total * bed.length_scale + centroid if total > 0.0 else None
        corner = bed.corners[k][widest] * bed.length_scale + centroid if gaps[widest] > 0.0 else None
        openings[key] = ContactOpening(pressed / float(area.sum()), total * model.force_scale, at, corner)
    return openings
