"""The limit of one block on the node pairs that it needs: mesh, refinement, and which limit state is the number."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import TypeVar, TypeVarTuple

from slopekit.core.onlooker import Clock
from slopekit.core.records import dataclass
from slopekit.design.common import Design
from slopekit.kinds.single_block.moments import (
    CohesionRules,
    checked_by_path,
    limit_by_rules,
    opens_cohesive,
    with_finer_motion,
)
from slopekit.kinds.single_block.one_block_states import ContactModel
from slopekit.preie.one_block.limit import LimitAnalysis, limit_analysis
from slopekit.preie.one_block.passes import STEERED, Outcome
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import MESH_CHANGE, PASSES_SETTLED

A = TypeVar("A")
Ts = TypeVarTuple("Ts")
MOST_REFINED = 4
_BOUND_REFINED = 2  # the static bound does not see finer node pairs (1e-6 of it), but its time does
_JUMPS = 0.05  # of the limit: finer pairs that move it by more may have come to another limit state
_SINKS = 3.0  # times what one refinement did: all that the next ones together may do, and more


@dataclass(frozen=True, slots=True)
class FoundLimit:
    """The limit of a scene on the node pairs that it needs.

    Attributes
    ----------
    bounded : the scene that the static bound is asked of: finer pairs do not move it, but cost time
    refined : how often the triangles were split; change : what the last split did to the limit
    rules : on cohesion, where moments open part of a contact that has some: the limit is that of their headline then
    """

    scene: ContactModel
    bounded: ContactModel
    analysis: LimitAnalysis
    refined: int
    change: float | None
    rules: CohesionRules | None = None


def find_limit(
    design: Design,
    scene_at: Callable[[int], ContactModel],
    refine: int,
    clock: Clock,
    analyse: Callable[[Model], LimitAnalysis] = limit_analysis,
    most_refined: int = MOST_REFINED,
) -> FoundLimit:
    """Mesh, limit, and refinement where it is needed: the factor of safety and nothing else.

    Where moments govern, the elastic path says which limit state is the number; where it is another than the passes
    found, it is followed from the coarsest pairs on. No pairs are made twice, and no model is solved twice.
    """
    scene_at, analyse, by_path_of = cache(scene_at), once(analyse), once(checked_by_path)
    at_limit = _refined(design, scene_at, refine, clock, lambda scene: analyse(scene.model), most_refined)
    with clock("solve"):
        opens = opens_cohesive(at_limit.scene, at_limit.analysis)
        by_path = None if opens else _other_by_path(at_limit, analyse, by_path_of)
    if by_path is not None and not by_path.without_path:
        at_limit = _refined(
            design, scene_at, refine, clock, lambda scene: by_path_of(scene, analyse(scene.model)), most_refined
        )
    elif by_path is not None:
        at_limit = replace(at_limit, analysis=replace(at_limit.analysis, without_path=True))
    scene, bounded, analysis, refined = at_limit.scene, at_limit.bounded, at_limit.analysis, at_limit.refined
    if not opens_cohesive(scene, analysis):
        return at_limit
    with clock("solve"):
        by_rules = limit_by_rules(scene, analysis, analyse)
    settled = by_rules.without_bond is None or (by_rules.change is not None and by_rules.change < MESH_CHANGE)
    while refined < most_refined and not settled:
        with clock("mesh"):
            scene = scene_at(refined + 1)
        with clock("solve"):
            last, by_rules = by_rules, limit_by_rules(scene, analysis, analyse, by_rules)
        settled = by_rules is last or (by_rules.change is not None and by_rules.change < MESH_CHANGE)
        settled = settled or (by_rules.without_bond is not None and by_rules.without_bond.passes > STEERED)
        refined += 1
        bounded = scene if refined <= _BOUND_REFINED else bounded
    with clock("solve"):
        by_rules = with_finer_motion(by_rules, scene, analyse)
    return FoundLimit(by_rules.scene, bounded, by_rules.analysis, refined, by_rules.change, by_rules.rules)


def once(ask: Callable[[*Ts], A]) -> Callable[[*Ts], A]:
    """`ask` that remembers what it answered of the same objects before."""
    known: dict[tuple[int, ...], tuple[tuple[*Ts], A]] = {}

    def remembered(*of: *Ts) -> A:
        key = tuple(id(one) for one in of)
        if key not in known:
            known[key] = of, ask(*of)  # with the objects: their numbers are no others' then
        return known[key][1]

    return remembered


def _other_by_path(
    at_limit: FoundLimit,
    analyse: Callable[[Model], LimitAnalysis],
    by_path_of: Callable[[ContactModel, LimitAnalysis], LimitAnalysis],
) -> LimitAnalysis | None:
    """What the elastic path says otherwise, None where it says the same.

    It is asked on pairs refined twice, where the finest do not jump.
    """
    coarse, limit = at_limit.analysis, at_limit.analysis.governing
    if at_limit.bounded is not at_limit.scene and at_limit.analysis.moments_govern:
        coarse = analyse(at_limit.bounded.model)
        if abs((limit.factor or 0.0) / (coarse.governing.factor or math.inf) - 1.0) > _JUMPS:
            by_path = by_path_of(at_limit.scene, at_limit.analysis)
            return None if by_path is at_limit.analysis else by_path
    by_path = by_path_of(at_limit.bounded, coarse)
    return None if by_path is coarse else by_path


def _refined(
    design: Design, scene_at: Callable[[int], ContactModel], refine: int, clock: Clock,
    look: Callable[[ContactModel], LimitAnalysis], most_refined: int,
) -> FoundLimit:  # fmt: skip
    """The limit on ever finer pairs, until they do no more to it, or moments open a contact with cohesion."""
    with clock("mesh"):
        scene = bounded = scene_at(refine)
    with clock("solve"):
        scene, analysis = on_its_lines(scene, look(scene))
        bounded = scene
    refined, change = refine, None
    while refined < most_refined and not opens_cohesive(scene, analysis):
        before = analysis.governing
        depends = analysis.turns or scene.model.lines is not None  # curved strength: on the tractions of the pairs
        if before.settled_to(PASSES_SETTLED) and not (depends and before.factor):
            break  # a plain slide ends here
        with clock("mesh"):
            finer = scene_at(refined + 1)
        with clock("solve"):
            finer, again = on_its_lines(finer, look(finer))
        after = again.governing
        change, done = _mesh_change(analysis, again)
        if before.settled_to(PASSES_SETTLED) and not after.settled_to(PASSES_SETTLED):
            break  # the coarser answer stands, and `change` says what the finer one made of it
        scene, analysis, refined = finer, again, refined + 1
        bounded = scene if refined <= _BOUND_REFINED else bounded
        if done or after.passes > STEERED:
            break
    return FoundLimit(scene, bounded, analysis, refined, change)


def on_its_lines(scene: ContactModel, analysis: LimitAnalysis) -> tuple[ContactModel, LimitAnalysis]:
    """The scene with the model whose strength lines its limit settled on, where laws are curved."""
    return (scene if analysis.model is None else replace(scene, model=analysis.model)), analysis


def comparable(analysis: LimitAnalysis, model: Model) -> float | None:
    """The factor on the closed form's assumptions: no turning where moments govern, one traction a plane."""
    if model.lines is not None:
        from slopekit.preie.system.strength_lines import mean_stress_limit

        return mean_stress_limit(model).factor
    if analysis.moments_govern or analysis.governing.outcome is Outcome.NOT_CONVERGED:
        return analysis.forces_only.factor
    return analysis.governing.factor


def _mesh_change(coarse: LimitAnalysis, fine: LimitAnalysis) -> tuple[float | None, bool]:
    """What a refinement did to the limit, in parts of it, and whether more of them would do next to nothing.

    Where the forces alone govern, the limit with turning may still sink below theirs on a finer mesh: it is followed
    until it settles, or lies above theirs by more than further refinements can take from it.
    """
    before, after = coarse.governing.factor, fine.governing.factor
    change = abs(after / before - 1.0) if after and before else None
    alone, above, last = fine.forces_only.factor, fine.with_turning.factor, coarse.with_turning.factor
    if fine.moments_govern or not (alone and above and last):
        return change, change is not None and change < MESH_CHANGE
    sank = abs(above / last - 1.0)
    clear = above * (1.0 - _SINKS * sank) > alone
    return change if clear else max(change or 0.0, sank), clear or sank < MESH_CHANGE
