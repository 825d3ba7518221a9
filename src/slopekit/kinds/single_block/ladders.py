"""Convergence ladders: the factor of a design by forces alone, and with coarser and finer node pairs.

Each rung is one method with its factor of safety and time. `check` judges the rungs.
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from slopekit.core.progress import Clock, report_stage
from slopekit.kinds.protocol import D
from slopekit.kinds.single_block.one_block_limit import ContactModel, Cut, find_limit
from slopekit.kinds.words import times
from slopekit.preie.motion.balance import Balance
from slopekit.preie.one_block.flat_limit import flat_limit, forces_limit, refined_factor
from slopekit.preie.one_block.forces_limits import forces_limits
from slopekit.preie.one_block.limit import LimitAnalysis
from slopekit.preie.one_block.polygon_bed import elastic_bed
from slopekit.preie.outcome import Outcome
from slopekit.preie.system.model import Model
from slopekit.result import Result

if TYPE_CHECKING:
    from slopekit.kinds.single_block.one_block import SingleBlock

#: What rungs vary, in words.
METHODS = {
    "closed form": "closed form",
    "forces alone": "forces alone, no turning",
    "mesh": "limit, by node pairs",
    "stiffness": "limit, by the shear stiffness of the elastic joints",
}
_MOST_REFINED = 4
MOST_PAIRS = 12_000  # node pairs of a finer mesh; beyond that the rung is left out
OTHER_STRENGTH = 0.5  # strength divided by so much, and by the limit itself
NEAR_STRENGTH = 0.01  # part by which the strength of one joint is made more and less
_REPEATED_BELOW_S, _REPEATS = 0.05, 5  # what is shorter is measured so often, and the median taken
_REPEATED_ONCE_BELOW_S = (
    5.0  # what is longer is measured once; the first run of the others may load a library
)


@dataclass(frozen=True)
class Rung:
    """One way to the factor of safety.

    Attributes
    ----------
    method : a key of `METHODS`; setting : in words
    node_pairs : None for a closed form
    setting_value : stiffness ratio, or level of the mesh (0 the coarsest); None where there is nothing to vary
    factor : None where there is none; seconds : median of a few runs
    edge_m : mean edge of the triangles of a curved slip surface, None for what has none
    """

    method: str
    setting: str
    node_pairs: int | None
    setting_value: float | None = field(metadata={"json": "effort"})
    factor: float | None = field(metadata={"json": "fos"})
    seconds: float = field(metadata={"json": None})
    edge_m: float | None = None


@dataclass(frozen=True)
class Ladder:
    """The evidence that `check` judges: a result and its factor by other methods, meshes and strengths.

    Attributes
    ----------
    result : of the design, with the all-pairs factor where it was looked for
    rungs : empty where there is no factor of safety
    factors_at_other_strengths : k F with the strength divided by k, which a unique limit gives as F again;
        None where the weaker or stronger block has no factor
    unrefined : why there are no finer node pairs, empty where there are
    rest : the forces of all blocks held against the strength at which they last rest, where the limit is that of a
        group of them; None where all blocks are at theirs
    neighbours : F with the strength of one joint changed by `NEAR_STRENGTH`, of each joint but the last
    """

    result: Result
    rungs: tuple[Rung, ...] = ()
    factors_at_other_strengths: tuple[float | None, ...] = ()
    unrefined: str = ""
    rest: Balance | None = None
    neighbours: tuple[float | None, ...] = ()


def timed(work: Callable[[], Any]) -> tuple[Any, float]:
    """Return the result of `work` and its duration in seconds, the median of several runs where they are short."""
    answer: Any = None
    durations: list[float] = []
    while (
        not durations
        or (len(durations) < _REPEATS and min(durations) < _REPEATED_BELOW_S)
        or (len(durations) < 2 and durations[0] < _REPEATED_ONCE_BELOW_S)
    ):
        began = time.perf_counter()
        answer = work()
        durations.append(time.perf_counter() - began)
    return answer, sorted(durations)[(len(durations) - 1) // 2]


def ladder_of_block(kind: "SingleBlock[D]", design: D) -> Ladder:
    """Return the ladder of a design of one block; times are those of the solvers alone."""
    by_pairs = replace(design, analysis=replace(design.analysis, criterion="all-pairs"))
    result = replace(kind.analyse(by_pairs), design=design)
    if not result.fos.limit:
        return Ladder(result)
    rungs: list[Rung] = []
    if design.HAS_CLOSED_FORM and result.agree is not None and result.fos.closed_form is not None:
        solution, seconds = timed(partial(kind.closed_form, design, None))
        rungs.append(Rung("closed form", "closed form", None, None, solution.factor, seconds))
    cut = kind.cut(design)
    scene = cut.scene_at(cut.refine)
    if scene.bedding is not None:
        bed = elastic_bed(scene.model, scene.bedding.polygons, scene.bedding.centroid)
        forces, seconds = timed(partial(forces_limits, bed))
        factor = forces_limit(scene.model, forces).factor
        rungs.append(Rung("forces alone", "no turning", len(scene.pairs), None, factor, seconds))
    rungs += kind.finer(design, result, cut)
    return Ladder(
        result,
        tuple(rungs),
        tuple(_factors_at_other_strengths(result, cut)),
        neighbours=tuple(_neighbours(scene, cut)),
    )


def meshes(cut: Cut) -> Iterator[Rung]:
    """Yield rungs of flat joints whose parts, or the pressed parts of their bed, are split further and further."""
    for level in range(cut.refine, _MOST_REFINED + 1):
        setting = f"parts split {times(level)}"
        report_stage(f"ladder, {setting}", head=True)
        scene = cut.scene_at(level)
        factor, seconds = timed(partial(_split_factor, scene, level))
        yield Rung("mesh", setting, len(scene.pairs), level, factor, seconds)


def _split_factor(scene: ContactModel, level: int) -> float | None:
    """Return the limit of a block on flat joints whose parts are split so often."""
    assert scene.bedding is not None
    return refined_factor(
        flat_limit(scene.model, scene.bedding.polygons, scene.bedding.centroid), level
    )


def limit_rung(
    scene: ContactModel, analyse: Callable[[Model], LimitAnalysis], setting: str, level: int
) -> Rung:
    """Return the rung of the limit of a scene, with its duration."""
    analysis, seconds = timed(partial(analyse, scene.model))
    limit = analysis.governing
    factor = limit.factor if limit.outcome is not Outcome.NOT_CONVERGED else None
    return Rung("mesh", setting, len(scene.pairs), level, factor, seconds)


def _factors_at_other_strengths(result: Result, cut: Cut) -> Iterator[float | None]:
    for k in (OTHER_STRENGTH, result.fos.limit or 1.0):
        report_stage("other strengths, divided by", k, head=True)
        factor = _factor(cut, partial(_reduced, k))
        yield None if factor is None else k * factor


def _neighbours(scene: ContactModel, cut: Cut) -> Iterator[float | None]:
    """Yield factors with the strength of one joint a little changed; of the last it is as if all others were.

    None of a block that presses on the whole of its joints, which has no path.
    """
    bedding = scene.bedding
    if bedding is None or scene.model.lines is not None:
        return
    has_path = flat_limit(scene.model, bedding.polygons, bedding.centroid).bed is not None
    for key in sorted(bedding.polygons)[:-1] if has_path else ():
        for k in (1.0 - NEAR_STRENGTH, 1.0 + NEAR_STRENGTH):
            yield _factor(cut, partial(_joint_reduced, key, k))


def _factor(cut: Cut, changed: Callable[[Model], Model]) -> float | None:
    """Return the factor of a block whose model is changed."""
    limit = find_limit(
        replace(cut, scene_at=lambda level: _scene_with(cut.scene_at(level), changed)), Clock()
    ).limit
    return limit.factor if limit.factor and limit.outcome is not Outcome.NOT_CONVERGED else None


def _reduced(k: float, model: Model) -> Model:
    """Return a model with the strength of all joints and bolts divided by k."""
    return replace(
        model,
        cohesion=model.cohesion / k,
        tan_friction=model.tan_friction / k,
        bolt_capacity=model.bolt_capacity / k,
        lines=None if model.lines is None else model.lines.reduced(k),
    )


def _joint_reduced(key: int, k: float, model: Model) -> Model:
    """Return a model with the strength of one joint divided by k."""
    divisor = np.where(model.interface == key, k, 1.0)
    return replace(
        model, cohesion=model.cohesion / divisor, tan_friction=model.tan_friction / divisor
    )


def _scene_with(scene: ContactModel, changed: Callable[[Model], Model]) -> ContactModel:
    """Return a scene whose model is changed, on whatever node pairs."""
    bedding = scene.bedding
    if bedding is not None:
        model_of = bedding.model_of
        bedding = replace(bedding, model_of=lambda pairs: changed(model_of(pairs)))
    return replace(scene, model=changed(scene.model), bedding=bedding)
