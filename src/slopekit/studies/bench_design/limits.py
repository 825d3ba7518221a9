"""PRE-IE of the wedges and planes of all benches that the closed forms let stand: what falls short fails too.

A limit is never above the factor of the forces, so that what fails by the closed form fails.
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
from slopekit.studies.bench_design.bench import CLOSED_OUTCOMES, PLANE, WEDGE, Bench, Part, bench_of, parts_of
from slopekit.studies.bench_design.given import BenchInputs
from slopekit.studies.bench_design.trials import Trials
from slopekit.studies.evaluation.rows import BlockRows, evaluated
from slopekit.studies.joint_wedges import limits_of_wedges
from slopekit.studies.outcomes import BothMethods, ByMethod, compared, one_after_the_other
from slopekit.studies.protocol import Workplace
from slopekit.studies.running import Crew


def _limits(asked: BenchInputs, every: Floats, rows: Ints) -> LimitsOfMany:
    """What PRE-IE says of some blocks (m,) in benches.

    Parameters
    ----------
    every : (n, 5) the mode of blocks, the dip of the face, their joints by number (the second of a plane is none), how
        high they are in m
    """
    blocks, toward, upper = every[rows], asked.toward_deg, Plane(0.0, asked.toward_deg)
    status, (limit, forces) = np.empty(len(rows), dtype=object), np.empty((2, len(rows)))
    for mode, limits_of in ((WEDGE, _wedges), (PLANE, _planes)):
        own = np.flatnonzero(blocks[:, 0] == mode)
        if len(own):
            dip: Any = blocks[own, 1]
            slope = replace(asked.slope, face=Plane(dip, toward), upper=upper)
            first, second = blocks[own, 2:4].astype(np.int64).T
            found = limits_of(asked, slope, first, second, blocks[own, 4])
            status[own], limit[own], forces[own] = found.status, found.limit, found.forces
    return LimitsOfMany(status.astype(np.str_), limit, forces)


def _wedges(asked: BenchInputs, slope: Any, first: Ints, second: Ints, height: Floats) -> LimitsOfMany:
    strengths = asked.cohesion_kpa, asked.friction_deg
    return limits_of_wedges(slope, asked.joints, strengths, first, second, height)


def _planes(asked: BenchInputs, slope: Any, first: Ints, _: Ints, height: Any) -> LimitsOfMany:
    common = {field.name: getattr(slope, field.name) for field in fields(Design)}
    if slope.water.mode == "pressures":
        common["water"] = Water("pressures", 0.0, slope.water.pressures_kpa[:1])
    dip: Any = asked.joints.dips_deg[first]  # in the section, as the closed form has it
    own: list[Any] = [of[first] for of in (asked.cohesion_kpa, asked.friction_deg)]
    strength = Strength(*own)
    plane = PlaneDesign(
        **common, joint=Plane(dip, asked.toward_deg), joint_name="J1", face=slope.face, upper=slope.upper,
        height_m=height, strength=strength,
    )  # fmt: skip
    return limits_on_arrays(plane, PLANES, [strength], len(first))


def judged_benches(
    asked: BenchInputs, trials: Trials, crew: Crew, desk: Workplace
) -> tuple[list[Bench], list[BothMethods]]:
    """Return all benches judged by both methods, and how far these agree in each mode of each."""
    sizes = [(height, dip) for height in asked.heights_m for dip in asked.face_dips_deg]
    parts = [parts_of(asked, trials, *size) for size in sizes]
    standing, blocks, closed = list[tuple[Part, Ints, Ints]](), list[Floats](), list[ByMethod]()
    # blocks of all sizes have the same factor: there is neither cohesion nor a pressure given in kPa
    is_free_of_size, count = not asked.has_cohesion and asked.slope.water.mode != "pressures", 0
    for (height, face), of_bench in zip(sizes, parts, strict=True):
        for mode in (WEDGE, PLANE):
            part = of_bench[mode]
            rows = np.flatnonzero(part["forms"] & ~part["fails"])
            second = trials.second[rows] if mode == WEDGE else np.full(len(rows), -1)
            heights = np.full(len(rows), height) if is_free_of_size else part["block_height_m"][rows]
            of_all = np.stack([trials.first[rows], second, heights], axis=1)
            different, at, back = np.unique(of_all, axis=0, return_index=True, return_inverse=True)
            standing.append((part, rows, back.reshape(-1) + count))
            blocks.append(np.insert(different, 0, np.array([[mode], [face]]), axis=1))
            closed.append(ByMethod(CLOSED_OUTCOMES[mode], part["outcome"][rows[at]], part["factor"][rows[at]]))
            count += len(different)
    every = np.concatenate(blocks)
    source = [asked.input_hash(), asked.has_cohesion]
    block_rows = BlockRows(asked.slope, one_after_the_other(closed), source, partial(_limits, asked, every))
    outcomes = evaluated(block_rows, "bench-design", crew, desk, label="blocks")
    target = asked.number("fos")
    both = list[BothMethods]()
    for part, rows, places in standing:
        of_part = outcomes.of(places)
        part["fails"][rows] = of_part.limit.falls_short(target)
        both.append(compared(of_part, part["fails"][rows], of_part.closed_form.falls_short(target)))
    return [bench_of(*size, of_bench) for size, of_bench in zip(sizes, parts, strict=True)], both
