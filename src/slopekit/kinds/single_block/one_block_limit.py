"""The limit of one block: on flat joints by `moments`, on a curved surface by passes on its node pairs."""

from collections.abc import Callable
from dataclasses import field, replace

from slopekit.core.onlooker import Clock
from slopekit.core.records import dataclass
from slopekit.evidence import ContactOpening
from slopekit.kinds.single_block.moments import moment_limit
from slopekit.kinds.single_block.one_block_states import ContactModel
from slopekit.preie.one_block.flat_limit import FlatLimit
from slopekit.preie.one_block.limit import LimitAnalysis, limit_analysis
from slopekit.preie.system.model import Model


@dataclass(frozen=True, slots=True)
class FoundLimit:
    """The limit of a scene on the node pairs that carry it.

    Attributes
    ----------
    bounded : the plain node pairs, which static bound and displacements are asked of: finer ones hardly move the bound
    change : what finer points of the bed would do to the limit, None where it is exact or not known
    factors : of forces and bed, None on a curved surface
    openings : interface -> where the joint is pressed, in local axes; empty where the bed did not settle the limit
    """

    scene: ContactModel
    bounded: ContactModel
    analysis: LimitAnalysis
    change: float | None = None
    factors: FlatLimit | None = None
    openings: dict[int, ContactOpening] = field(default_factory=dict)


def find_limit(
    scene_at: Callable[[int], ContactModel],
    refine: int,
    clock: Clock,
    analyse: Callable[[Model], LimitAnalysis] = limit_analysis,
) -> FoundLimit:
    """Return the limit of a block: mesh and factor of safety, nothing else.

    Parameters
    ----------
    scene_at : its node pairs and model by how often the parts of the joints are split; refine : how often that is
    analyse : what solves the model of a curved surface
    """
    with clock("mesh"):
        scene = scene_at(refine)
    with clock("solve"):
        if scene.bedding is None:
            analysis = analyse(scene.model)
            scene = scene if analysis.model is None else replace(scene, model=analysis.model)
            return FoundLimit(scene, scene, analysis)
        limit = moment_limit(scene)
        state = limit.factors.state
        settled = state is not None and limit.analysis.moments_govern and state.factor is not None
        return FoundLimit(
            scene=limit.scene,
            bounded=_drawn_at_limit(scene if limit.factors.exact is None else limit.scene, limit.factors),
            analysis=limit.analysis,
            change=state.change if state is not None and settled else None,
            factors=limit.factors,
            openings=limit.openings,
        )


def _drawn_at_limit(scene: ContactModel, factors: FlatLimit) -> ContactModel:
    """Return the scene with the lines of curved laws at the tractions of the limit on the bed."""
    model, bed, state = scene.model, factors.bed, factors.state
    if model.lines is None or bed is None or state is None or state.factor is None:
        return scene
    from slopekit.preie.system.strength_lines import drawn  # only curved laws pay for it

    normal = model.control_area * (-model.normal_rows @ bed.in_units_of(model, state.opening)).clip(0.0)
    return replace(scene, model=drawn(model, normal))


def comparable(found_limit: FoundLimit) -> float | None:
    """Return the factor on the closed form's assumptions: forces with forces, one traction a plane."""
    if found_limit.factors is None:
        return found_limit.analysis.governing.factor
    return found_limit.factors.forces.factor
