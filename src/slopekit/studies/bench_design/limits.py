"""PRE-IE of the wedges and planes of all benches that the closed forms let stand: what falls short fails too.

A limit is never above the factor of the forces, so that what fails by the closed form fails.
"""

from dataclasses import fields, replace
from functools import partial
from itertools import accumulate
from typing import Any, TypeAlias, cast

import numpy as np

from slopekit.core.arrays import Floats, Ints
from slopekit.core.orientation import Plane
from slopekit.design.common import Design
from slopekit.design.parts import Strength, Water
from slopekit.kinds.plane import ON_ARRAYS as PLANES
from slopekit.kinds.plane import PlaneDesign
from slopekit.kinds.single_block.blocks_on_arrays import limits_on_arrays
from slopekit.studies.bench_design.bench import CLOSED_OUTCOMES, PLANE, WEDGE, Bench, Part, bench_of, parts_of
from slopekit.studies.bench_design.given import BenchInputs
from slopekit.studies.bench_design.trials import Trials
from slopekit.studies.joint_wedges import limits_of_wedges
from slopekit.studies.outcomes import BothMethods, ByMethod, agreement, compared, joined_limits, record_of_limits
from slopekit.studies.points import map_rows
from slopekit.studies.protocol import Workplace
from slopekit.studies.running import Crew, Record, RowArrays

#: Blocks of a mode in benches with one face: their joints (m,) by number, the second of a plane means nothing; m high.
Task: TypeAlias = tuple[int, float, Ints, Ints, Floats]
_AT_ONCE = 2048  # blocks of a task


def judged_benches(
    inputs: BenchInputs, trials: Trials, crew: Crew, desk: Workplace
) -> tuple[list[Bench], list[BothMethods]]:
    """Return all benches judged by both methods, and how far these agree in each mode of each."""
    sizes = [(height, dip) for height in inputs.heights_m for dip in inputs.face_dips_deg]
    parts = [parts_of(inputs, trials, *size) for size in sizes]
    jobs, tasks, before = list[tuple[Part, int, Ints, Ints]](), list[Task](), 0
    for (height, face), of_bench in zip(sizes, parts, strict=True):
        for mode in (WEDGE, PLANE):
            blocks = of_bench[mode]
            rows = np.flatnonzero(blocks["forms"] & ~blocks["fails"])
            first, second = trials.first[rows], trials.second[rows] if mode == WEDGE else np.full(len(rows), -1)
            heights = np.full(len(rows), height) if _is_free_of_size(inputs) else blocks["block_height_m"][rows]
            different, back = np.unique(np.stack([first, second, heights], axis=1), axis=0, return_inverse=True)
            jobs.append((blocks, mode, rows, back.reshape(-1) + before))
            before += len(different)
            for where_in in range(0, len(different), _AT_ONCE):
                one, two, high = different[where_in : where_in + _AT_ONCE].T
                tasks.append((mode, face, one.astype(np.int64), two.astype(np.int64), high))
    run = [inputs.input_hash(), inputs.has_cohesion]
    columns = RowArrays([0, *accumulate(len(task[-1]) for task in tasks)])
    map_rows(partial(_limits, inputs), tasks, columns, crew, desk, "bench-design", "PRE-IE", run)
    limits = joined_limits(columns)
    both = [_judge(inputs, *one, limits) for one in jobs]
    return [bench_of(*size, of_bench) for size, of_bench in zip(sizes, parts, strict=True)], both


def _is_free_of_size(inputs: BenchInputs) -> bool:
    """Whether blocks of all sizes have the same factor: there is neither cohesion nor a pressure given in kPa."""
    return not inputs.has_cohesion and inputs.slope.water.mode != "pressures"


def _judge(
    inputs: BenchInputs, blocks: Part, mode: int, rows: Ints, where_in: Ints, limits: tuple[ByMethod, Floats]
) -> BothMethods:
    """Note what fails by PRE-IE among the blocks `rows` of a mode; return how far the methods agree on them.

    Parameters
    ----------
    where_in : (m,) the places of these blocks in what was found of all
    """
    target = inputs.number("fos")
    found, forces = limits
    limit = ByMethod(found.names, found.outcome[where_in], found.factor[where_in])
    closed = ByMethod(CLOSED_OUTCOMES[mode], blocks["outcome"][rows], blocks["factor"][rows])
    outcomes = agreement(limit, forces[where_in], closed, inputs.slope.analysis.agree_within)
    blocks["fails"][rows] = limit.falls_short(target)
    return compared(outcomes, blocks["fails"][rows], closed.falls_short(target))


def _limits(inputs: BenchInputs, task: Task) -> Record:
    """What PRE-IE says of the blocks of a task."""
    mode, face_dip, first, second, height = task
    toward, strengths = inputs.toward_deg, (inputs.cohesion_kpa, inputs.friction_deg)
    face, upper = Plane(face_dip, toward), Plane(0.0, toward)
    slope = replace(inputs.slope, face=face, upper=upper)
    if mode == WEDGE:
        return record_of_limits(limits_of_wedges(slope, inputs.joints, strengths, first, second, height))
    common = {field.name: getattr(slope, field.name) for field in fields(Design)}
    if slope.water.mode == "pressures":
        common["water"] = Water("pressures", 0.0, slope.water.pressures_kpa[:1])
    dip: Any = inputs.joints.dips_deg[first]  # in the section, as the closed form has it
    own: list[Any] = [of[first] for of in strengths]
    strength, high = Strength(*own), cast(Any, height)
    plane = PlaneDesign(
        **common, joint=Plane(dip, toward), joint_name="J1", face=face, upper=upper, height_m=high, strength=strength
    )
    return record_of_limits(limits_on_arrays(plane, PLANES, [strength], len(first)))
