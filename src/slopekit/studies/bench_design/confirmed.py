"""PRE-IE beside the closed forms: wedges and planes of all benches, a random part and all near the target."""

from collections.abc import Sequence
from dataclasses import fields, replace
from typing import TypeAlias

import numpy as np

from slopekit.core.orientation import Plane
from slopekit.design.common import Design
from slopekit.design.parts import Strength, Water
from slopekit.kinds.plane import PlaneDesign
from slopekit.studies.bench_design.bench import PLANE, WEDGE, Bench, strengths_at
from slopekit.studies.bench_design.given import BenchInputs
from slopekit.studies.bench_design.trials import Trials
from slopekit.studies.points import Point, both_methods, falls_short, kept_points
from slopekit.studies.prob.judged import Confirmation, chosen, confirmation_of
from slopekit.studies.protocol import Workplace
from slopekit.studies.running import Crew, Journal

_MODES = (WEDGE, PLANE)


#: Heights and faces of benches in which a block fails by PRE-IE alone, or has no answer of it.
Doubted: TypeAlias = frozenset[tuple[float, float]]


def confirmed(
    asked: BenchInputs, trials: Trials, benches: Sequence[Bench], crew: Crew, desk: Workplace
) -> tuple[Confirmation | None, Doubted, Journal | None]:
    """PRE-IE's judgement of the blocks that are chosen; None where none forms, or none is asked for."""
    forms, factor, fails = (
        np.concatenate([getattr(bench, name)[mode] for bench in benches for mode in _MODES])
        for name in ("forms", "factor", "fails")
    )
    target, within, seed = asked.number("fos"), asked.near, int(asked.number("seed"))
    index = chosen(forms, factor, target, int(asked.number("confirm")), within, seed)
    if not len(index[0]):
        return None, frozenset(), None
    rows = [divmod(int(one), len(trials)) for one in index[0]]
    keys, strengths = [], strengths_at(asked, trials)
    for part, trial in rows:
        bench, mode = benches[part // len(_MODES)], _MODES[part % len(_MODES)]
        first, second = int(trials.first[trial]), int(trials.second[trial])
        other = second if mode == WEDGE else -1
        strength = tuple(float(part[k, trial]) for part in strengths for k in range(2))
        keys.append((mode, first, other, float(bench.block_height_m[mode, trial]), bench.face_dip_deg, strength))
    different = list(dict.fromkeys(keys))
    designs = [_design(asked, *key) for key in different]
    found, journal = kept_points(both_methods, designs, crew, desk, "bench-design", "PRE-IE", asked.input_hash())
    points = dict(zip(different, found, strict=True))
    said = confirmation_of(
        index, tuple(points[key] for key in keys), forms, np.ones(len(forms), dtype=bool), fails, target, within,
        asked.number("confidence"),
    )  # fmt: skip
    stands = ~fails[index[0]]
    doubted = frozenset(
        (benches[part // len(_MODES)].height_m, benches[part // len(_MODES)].face_dip_deg)
        for (part, _), key, stood in zip(rows, keys, stands, strict=True) if stood and _is_doubted(points[key], target)
    )  # fmt: skip
    return said, doubted, journal


def _is_doubted(point: Point, target: float) -> bool:
    """Whether PRE-IE does not say that a block stands."""
    factors = point.factors
    return factors is None or factors.status == "not_converged" or falls_short(factors.status, factors.limit, target)


def _design(
    asked: BenchInputs, mode: int, first: int, second: int, height: float, face_dip: float, strength: tuple[float, ...]
) -> Design:  # fmt: skip
    """The block of a trial as a design of its own, per metre where it is a plane.

    `strength`: cohesion of both joints, then their friction angles.
    """
    joints, slope, face = asked.joints.joints, asked.slope, Plane(face_dip, asked.toward_deg)
    if mode == WEDGE:
        return replace(
            slope, joints=(joints[first].plane, joints[second].plane), face=face, height_m=height,
            joint_names=(joints[first].name, joints[second].name),
            strengths=slope.with_c_and_phi(strength[:2], strength[2:]),
        )  # fmt: skip
    common = {own.name: getattr(slope, own.name) for own in fields(Design)}
    if slope.water.mode == "pressures":
        common["water"] = Water("pressures", 0.0, slope.water.pressures_kpa[:1])
    # its dip in the section, as the closed form has it
    return PlaneDesign(
        **common, joint=Plane(joints[first].plane.dip_deg, asked.toward_deg), joint_name=joints[first].name, face=face,
        upper=Plane(0.0, asked.toward_deg), height_m=height,
        strength=Strength(strength[0], strength[2]),
    )  # fmt: skip
