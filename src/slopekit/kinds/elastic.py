"""Elastic blocks of a design, beside its rigid answer: what opens, the tractions, the displacements, the limit.

A block that slides has the rigid limit but for the cohesion of the pairs that its deformation pulls open (METHOD-2
§10): the state at full strength and one rigid limit are enough. `benchmarks.elastic_oracle` holds it against the factor
at which elastic blocks no longer come to rest.
"""

import math
import time
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from slopekit.core.arrays import Floats, frozen
from slopekit.core.errors import Notice
from slopekit.core.onlooker import say
from slopekit.design.common import Design
from slopekit.elastic.model import ElasticModel
from slopekit.elastic.outcome import ElasticBlocks, ElasticPairs, OnElasticJoint
from slopekit.elastic.rest import Rest, RestSearch
from slopekit.kinds.elastic_scene import (
    ElasticScene,
    rock_of,
    scene_of_many,
    scene_of_one,
)
from slopekit.kinds.protocol import Kind
from slopekit.kinds.single_block.one_block import Cut
from slopekit.result import Result

_BELOW = 0.95  # of a limit below 1: where the state is looked at
_LINES = 12  # rounds of strength lines that follow the normal forces
_WORK_OF_LINES = 2.4e7  # steps of Newton's method times rows of the model: four minutes
_LINES_STEADY = 1e-6
_SAME = 1e-6
_LOCKED = 0.01  # width of the range of locked-in forces, in parts, that is worth a word


def with_elastic(kind: Kind[Any], result: Result) -> Result:
    """The result with its elastic blocks.

    Raises
    ------
    DesignError
        E140 without scikit-fem, E125 and E288 for what cannot be had.
    """
    design, began = result.design, time.perf_counter()
    say("elastic", head=True)
    made = kind.cut(design)
    scene = scene_of_one(design, made) if isinstance(made, Cut) else scene_of_many(design, made, result)
    stands = result.status == "no_driving_force"
    if scene.rigid_limit is None and not stands:
        said = Notice("W450", f"no elastic blocks: {result.status_text}, nothing comes to rest at any strength")
        return replace(result, warnings=(*result.warnings, said))
    below = _BELOW * min(scene.rigid_limit or math.inf, 1.0)  # elastic blocks may not stand where rigid ones just do
    factors = (below,) if not stands and (scene.rigid_limit or 0.0) <= 1.0 else (1.0, below)
    for factor in factors:
        search, rest = _at_rest(scene, scene.model, factor)
        if rest.stands:
            break
    else:
        pairs = f"{int(rest.opened(scene.model).sum())} of {len(rest.parted)} node pairs pulled open"
        how = f"in {search.steps} steps, {pairs}" if search.spent else f"({pairs})"
        said = Notice("W450", f"no elastic blocks: Newton's method finds no rest at F = {factor:.4g} {how}")
        return replace(result, warnings=(*result.warnings, said), timing_s=_timed(result, began))
    _, rigid = _at_rest(scene, scene.model.rigid(), factor)
    limit, spent = scene.rigid_limit, False
    rigid_limit = limit
    if not stands:
        limit, spent = scene.limit_without(rest.opened(scene.model))
        without = scene.limit_without(rigid.opened(scene.model))[0] if rigid.stands else None
        rigid_limit = min((one for one in (rigid_limit, without) if one is not None), default=None)
    other = limit is not None and rigid_limit is not None and limit > rigid_limit * (1.0 + _SAME)
    limit = rigid_limit if other else limit
    last, guess = rest, limit or rigid_limit
    if spent and guess is not None:
        say("elastic range", head=True)
        last = search.upward(rest, guess)
    between = _between(scene, last) if spent else None
    answer = _answer(design, scene, rest, rigid, (limit, rigid_limit), between, search.steps)
    notes = [*result.warnings, *_notices(result, answer)]
    if factor < factors[0] and limit is not None:
        known = f"come to rest at F = {factor:.4g}, at {factors[0]:.4g} none was found"
        notes.append(Notice("W455", f"elastic blocks {known}: their limit may lie between, below the {limit:.4f} under "
                            f"ELASTIC, which is without what is open at the first: rely on {factor:.4g}"))  # fmt: skip
    if not stands and limit is None:
        notes.append(_no_limit(spent, between))
    if other:
        why = "without the cohesion that is pulled open another limit state is found, with a higher factor"
        notes.append(Notice("W455", f"{why}: the lower of the two is the limit under ELASTIC"))
    return replace(result, elastic=answer, warnings=tuple(notes), timing_s=_timed(result, began))


def _between(scene: "ElasticScene", last: Rest) -> tuple[float, float] | None:
    """Where elastic blocks rest, and the static bound without what is open there: above it no forces hold them.

    What has parted stays so, and all forces of a rest are in balance, within strength and pressing: whatever the way
    on, it ends below. None where nothing bounds them.
    """
    bound = None if scene.bound_without is None else scene.bound_without(last.parted)
    return None if bound is None or bound < last.factor else (last.factor, bound)


def _no_limit(spent: bool, between: tuple[float, float] | None) -> Notice:
    """Why there is none without the cohesion that is pulled open: for want of work, or as nothing holds the blocks."""
    without = "no limit under ELASTIC: without the cohesion that is pulled open"
    if spent:
        ends = "" if between is None else f"; it lies between {between[0]:.4f} and {between[1]:.4f}"
        return Notice("W360", f"{without} it was not settled within the effort of one analysis{ends}")
    return Notice("W308", f"{without} none was found, and not for want of work: the rigid blocks may tip or fall then")


def _timed(result: Result, began: float) -> dict[str, float]:
    took = time.perf_counter() - began
    return dict(result.timing_s) | {"elastic": took, "total": result.timing_s.get("total", 0.0) + took}


def _notices(result: Result, answer: ElasticBlocks) -> Iterator[Notice]:
    lowest, highest = result.fos.lowest, result.fos.highest
    wide = lowest is not None and (highest is None or highest > lowest * (1.0 + _LOCKED))
    if answer.block is not None and wide:
        far = "far above it" if highest is None else f"{highest:.3f}"
        span = f"{lowest:.3f} .. {far}"
        message = f"the limit under ELASTIC is that of the rigid path, other load paths and locked-in stresses: {span}"
        yield Notice("W455", f"{message}; rely on the lowest")


# -- at rest ----------------------------------------------------------------------------------------------------------


def _at_rest(scene: ElasticScene, model: ElasticModel, factor: float) -> tuple[RestSearch, Rest]:
    """Rest at a factor, where laws are curved on the lines of its own normal forces."""
    search = RestSearch(model, scene.stiffness)
    rest = search.rest(factor)
    steps = search.steps
    for _ in range(_LINES if scene.redrawn is not None else 0):
        if not rest.stands or scene.redrawn is None:
            break
        friction = scene.redrawn(rest.forces.reshape(-1, 3)[:, 0])
        if float(np.abs(friction - model.tan_friction).max()) < _LINES_STEADY:
            break
        model = replace(model, tan_friction=friction)
        search = RestSearch(model, scene.stiffness)
        rest = search.rest(factor)
        steps += search.steps
        if steps * len(rest.forces) > _WORK_OF_LINES:
            return search, replace(rest, residual=math.inf)
    return search, rest


# -- the answer -------------------------------------------------------------------------------------------------------


def _answer(
    design: Design, scene: ElasticScene, rest: Rest, rigid: Rest, limits: tuple[float | None, float | None],
    between: tuple[float, float] | None, steps: int,
) -> ElasticBlocks:  # fmt: skip
    model, (rock, taken) = scene.model, rock_of(design)
    area = model.area
    elastic, stiff = (state.forces.reshape(-1, 3)[:, 0] / area for state in (rest, rigid))
    joints = {}
    names = np.array(scene.joint)
    for name in dict.fromkeys(scene.joint):
        on = names == name
        joints[name] = OnElasticJoint(
            (float(elastic[on].min()), float(elastic[on].max())), (float(stiff[on].min()), float(stiff[on].max())),
            float(area[on & rest.opened(model)].sum() / area[on].sum()),
        )  # fmt: skip
    moved = _displacements(scene, model, rest)
    most = int(np.argmax((moved * moved).sum(axis=1)))
    both, bonded = [state.opened(model) for state in (rest, rigid)], model.cohesion > 0.0
    opened, rigid_opened = (float(area[open_].sum() / area.sum()) for open_ in both)
    lost, rigid_lost = (float(area[open_ & bonded].sum() / area.sum()) for open_ in both)
    rigid_moved = _displacements(scene, model.rigid(), rigid)
    return ElasticBlocks(
        limits[0], limits[1], between, rest.factor, opened, rigid_opened, lost, rigid_lost, joints,
        frozen(moved[most]), frozen(rigid_moved[most]),
        scene.names[most] if scene.names else None, rest.failed_pairs, len(area),
        sum(one.degrees for one in scene.blocks) + 3 * len(area) + len(model.load),
        sum(one.cells for one in scene.blocks), rock.modulus_kpa, rock.poisson, scene.edge, rock.order,
        taken, rest.residual, steps,
        ElasticPairs(
            frozen(scene.points), tuple(scene.joint), frozen(scene.normals), frozen(area), frozen(elastic),
            frozen(stiff), tuple(rest.opened(model).tolist()),
        ),
    )  # fmt: skip


def _displacements(scene: ElasticScene, model: ElasticModel, state: Rest) -> Floats:
    """The mean displacement of each block in the user's axes, (b, 3) m."""
    out = np.zeros((len(model.seen), 3))
    in_section = scene.unknowns <= 3
    for k in range(len(out)):
        own = state.motion[k * scene.unknowns : (k + 1) * scene.unknowns]
        out[k, [0, 2] if in_section else [0, 1, 2]] = own[: 2 if in_section else 3]
        out[k] += model.seen_of(k, state.forces, state.motion, state.factor, state.bent)[0]
    turned: Floats = out @ scene.axes
    return turned
