"""PRE-IE limits of the wedges and planes that are stable by the closed forms: blocks below the target fail too.

A PRE-IE limit is never above the factor by forces alone, so a block that fails by the closed form fails.
"""

from dataclasses import fields, replace
from functools import partial
from typing import Any

import numpy as np

from slopekit.core.arrays import Floats, Ints
from slopekit.core.orientation import Plane
from slopekit.design.common import Design
from slopekit.design.parts import Strength, Water
from slopekit.kinds.plane import ON_ARRAYS as PLANES
from slopekit.kinds.plane import PlaneDesign
from slopekit.kinds.single_block.blocks_on_arrays import LimitsOfMany, limits_on_arrays
from slopekit.studies.bench_design.bench import (
    CLOSED_OUTCOMES,
    PLANE,
    WEDGE,
    Bench,
    ModeResult,
    bench_of,
    closed_form_modes,
)
from slopekit.studies.bench_design.inputs import BenchInputs
from slopekit.studies.bench_design.trials import Trials
from slopekit.studies.evaluation.rows import BlockRows, evaluated
from slopekit.studies.joint_wedges import limits_of_wedges
from slopekit.studies.outcomes import BothMethods, ByMethod, agreement_of_methods, concatenated
from slopekit.studies.protocol import Workplace
from slopekit.studies.running import ExecutorOptions


def _block_limits(inputs: BenchInputs, all_blocks: Floats, rows: Ints) -> LimitsOfMany:
    """Return the PRE-IE limits of some blocks (m,) in benches.

    Parameters
    ----------
    all_blocks : (n, 5) mode, dip of the face in degrees, numbers of both joints (the second of a plane is -1), height
        in m
    """
    blocks, toward, upper = all_blocks[rows], inputs.toward_deg, Plane(0.0, inputs.toward_deg)
    status, (limit, forces) = np.empty(len(rows), dtype=object), np.empty((2, len(rows)))
    for mode, limits_of in ((WEDGE, _wedge_limits), (PLANE, _plane_limits)):
        mode_rows = np.flatnonzero(blocks[:, 0] == mode)
        if len(mode_rows):
            dip: Any = blocks[mode_rows, 1]
            slope = replace(inputs.slope, face=Plane(dip, toward), upper=upper)
            first, second = blocks[mode_rows, 2:4].astype(np.int64).T
            limits = limits_of(inputs, slope, first, second, blocks[mode_rows, 4])
            status[mode_rows], limit[mode_rows], forces[mode_rows] = (
                limits.status,
                limits.limit,
                limits.forces,
            )
    return LimitsOfMany(status.astype(np.str_), limit, forces)


def _wedge_limits(
    inputs: BenchInputs, slope: Any, first: Ints, second: Ints, height: Floats
) -> LimitsOfMany:
    strengths = inputs.cohesion_kpa, inputs.friction_deg
    return limits_of_wedges(slope, inputs.joints, strengths, first, second, height)


def _plane_limits(
    inputs: BenchInputs, slope: Any, first: Ints, _: Ints, height: Any
) -> LimitsOfMany:
    common = {field.name: getattr(slope, field.name) for field in fields(Design)}
    if slope.water.mode == "pressures":
        common["water"] = Water("pressures", 0.0, slope.water.pressures_kpa[:1])
    dip: Any = inputs.joints.dips_deg[first]  # in the section, as the closed form has it
    cohesion_friction: list[Any] = [
        joint_values[first] for joint_values in (inputs.cohesion_kpa, inputs.friction_deg)
    ]
    strength = Strength(*cohesion_friction)
    plane = PlaneDesign(
        **common,
        joint=Plane(dip, inputs.toward_deg),
        joint_name="J1",
        face=slope.face,
        upper=slope.upper,
        height_m=height,
        strength=strength,
    )
    return limits_on_arrays(plane, PLANES, [strength], len(first))


def evaluated_benches(
    inputs: BenchInputs, trials: Trials, crew: ExecutorOptions, desk: Workplace
) -> tuple[list[Bench], list[BothMethods]]:
    """Return all benches judged by both methods, and the agreement of the methods by bench and mode."""
    sizes = [(height, dip) for height in inputs.heights_m for dip in inputs.face_dips_deg]
    bench_modes = [closed_form_modes(inputs, trials, *size) for size in sizes]
    stable_blocks, blocks, closed = (
        list[tuple[ModeResult, Ints, Ints]](),
        list[Floats](),
        list[ByMethod](),
    )
    # without cohesion and pressures in kPa the factor does not depend on the size of a block
    is_free_of_size, count = not inputs.has_cohesion and inputs.slope.water.mode != "pressures", 0
    for (height, face), modes in zip(sizes, bench_modes, strict=True):
        for mode in (WEDGE, PLANE):
            mode_result = modes[mode]
            rows = np.flatnonzero(mode_result["forms"] & ~mode_result["fails"])
            second = trials.second[rows] if mode == WEDGE else np.full(len(rows), -1)
            heights = (
                np.full(len(rows), height)
                if is_free_of_size
                else mode_result["block_height_m"][rows]
            )
            block_keys = np.stack([trials.first[rows], second, heights], axis=1)
            unique_keys, first_rows, inverse = np.unique(
                block_keys, axis=0, return_index=True, return_inverse=True
            )
            stable_blocks.append((mode_result, rows, inverse.reshape(-1) + count))
            blocks.append(np.insert(unique_keys, 0, np.array([[mode], [face]]), axis=1))
            closed.append(
                ByMethod(
                    CLOSED_OUTCOMES[mode],
                    mode_result["outcome"][rows[first_rows]],
                    mode_result["factor"][rows[first_rows]],
                )
            )
            count += len(unique_keys)
    all_blocks = np.concatenate(blocks)
    source = [inputs.input_hash(), inputs.has_cohesion]
    block_rows = BlockRows(
        inputs.slope,
        concatenated(closed),
        source,
        partial(_block_limits, inputs, all_blocks),
    )
    outcomes = evaluated(block_rows, "bench-design", crew, desk, label="blocks")
    target = inputs.number("fos")
    both = list[BothMethods]()
    for mode_result, rows, places in stable_blocks:
        mode_outcomes = outcomes.take(places)
        mode_result["fails"][rows] = mode_outcomes.limit.falls_short(target)
        both.append(
            agreement_of_methods(
                mode_outcomes,
                mode_result["fails"][rows],
                mode_outcomes.closed_form.falls_short(target),
            )
        )
    return [bench_of(*size, modes) for size, modes in zip(sizes, bench_modes, strict=True)], both
