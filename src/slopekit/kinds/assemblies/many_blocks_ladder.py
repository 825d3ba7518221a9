"""The ladder of many blocks: the first mechanism on other elastic joints, on finer node pairs, at other strengths."""

from collections.abc import Iterator
from functools import partial

from slopekit.core.progress import report_stage
from slopekit.kinds.assemblies.many_blocks import (
    MOST_HISTORY_BLOCKS,
    SolvedAssembly,
    force_balance,
)
from slopekit.kinds.assemblies.many_blocks_scene import scene_loads
from slopekit.kinds.single_block.ladders import MOST_PAIRS, OTHER_STRENGTH, Ladder, Rung, timed
from slopekit.kinds.solver_inputs import joint_strength
from slopekit.kinds.words import times
from slopekit.preie.many_blocks.blocks_limit import Basis, BlocksLimit
from slopekit.preie.many_blocks.ravelling import finer_model, limit_with_other_strength
from slopekit.preie.solvers.threads import one_thread

_MOST_ALL_PAIRS_BLOCKS = (
    100  # moving blocks for which `check` looks for the all-pairs factor: its search takes long
)
_STIFFNESS_RATIOS = (
    0.1,
    1.0,
)  # k_t / k_n of the path beside its own: where the limit depends on it, it is not the only one


def ladder_of_blocks(solution: SolvedAssembly) -> Ladder:
    """Return the ladder of many blocks: result with all-pairs factor, rungs, and the limit at other strengths."""
    is_small = solution.result.model.moving_blocks <= _MOST_ALL_PAIRS_BLOCKS
    if is_small and solution.result.displacements.all_pairs is None:
        report_stage("all pairs", head=True)
        solution = solution.with_all_pairs()
    blocks = (
        len(solution.ravelling.failures[0].parts[0].blocks) if solution.ravelling.failures else 0
    )
    if blocks > MOST_HISTORY_BLOCKS:
        report_stage("history of falling strength", head=True)
        solution = solution.with_history(blocks)
    unrefined = (
        ""
        if _refines(solution)
        else "a flat contact of a section slips as one, and its ends turn it"
    )
    with one_thread():  # as the analysis
        rungs = tuple(_rungs(solution))
    components = solution.ravelling.parts
    rest = (
        force_balance(components, at_rest=True)
        if any(component.limit.width for component in components)
        else None
    )
    return Ladder(
        solution.result, rungs, _factors_at_other_strengths(solution), unrefined, rest=rest
    )


def _factors_at_other_strengths(solution: SolvedAssembly) -> tuple[float | None, ...]:
    """Return k times the factors of the first mechanism with its strength divided by k: the same F for a limit."""
    failures = solution.ravelling.failures
    if not failures or not failures[0].limit.factor:
        return ()
    model, factors = failures[0].parts[0].model, []
    with one_thread():
        for k in (OTHER_STRENGTH, failures[0].limit.factor):
            report_stage("other strengths", head=True)
            limit = limit_with_other_strength(model, k)
            factors.append(
                _capped_factor(k * limit.factor, failures[0].limit) if limit.factor else None
            )
    return tuple(factors)


def _capped_factor(factor: float | None, limit: BlocksLimit) -> float | None:
    """Return the factor of a path, no higher than that of a block which slides alone."""
    if factor is None or limit.factor is None or limit.basis is not Basis.ALONE:
        return factor
    return min(factor, limit.factor)


def _rungs(solution: SolvedAssembly) -> Iterator[Rung]:
    """Yield the rungs of the blocks of the first mechanism; blocks that were fixed for it stay fixed."""
    result, scene, failures = solution.result, solution.counted_scene, solution.ravelling.failures
    if result.agree is not None and result.fos.closed_form is not None:
        yield Rung(
            "closed form",
            "closed form",
            None,
            None,
            result.fos.closed_form,
            result.timing_s["closed_form"],
        )
    if not failures or not failures[0].limit.factor:
        return
    component = failures[0].parts[0]
    for ratio in _STIFFNESS_RATIOS:
        report_stage(f"ladder, k_t/k_n {ratio:g}", head=True)
        limit, seconds = timed(partial(limit_with_other_strength, component.model, ratio=ratio))
        factor = _capped_factor(limit.factor, component.limit)
        yield Rung(
            "stiffness",
            f"k_t / k_n {ratio:g}",
            component.model.joint_pairs.stop,
            ratio,
            factor,
            seconds,
        )
    for level in range(3 if _refines(solution) else 1):
        model = component.model
        if level:
            model = finer_model(
                scene.assembly,
                scene_loads(scene),
                joint_strength(scene.strengths),
                component,
                level,
            )
        if level and len(model.control_area) > MOST_PAIRS:
            break
        report_stage(f"ladder, parts split {times(level)}", head=True)
        limit, seconds = timed(partial(limit_with_other_strength, model))
        setting = f"parts split {times(level)}" if _refines(solution) else "as analysed"
        yield Rung(
            "mesh",
            setting,
            model.joint_pairs.stop,
            level,
            _capped_factor(limit.factor, component.limit),
            seconds,
        )


def _refines(solution: SolvedAssembly) -> bool:
    """Return whether node pairs can be refined: in a section a flat contact slips as one, with hinges at its ends."""
    return not solution.scene.assembly.in_section
