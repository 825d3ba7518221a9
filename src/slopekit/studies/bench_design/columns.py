"""PRE-IE beside the criterion of columns: the first column of some places, cut to its own shape, on its base.

`kind: topple` stands its columns square on their bases; here the base is a joint of the survey, which dips as it was
measured. So the column is a parallelogram between two joints on that base (`kind: blocks`): the shape that
`closed_form.sizes.column_sizes` weighs.
"""

import math
from collections.abc import Sequence
from dataclasses import field
from typing import ClassVar

import numpy as np

from slopekit.closed_form.sizes import column_sizes
from slopekit.core.records import dataclass
from slopekit.design.common import Design
from slopekit.studies.bench_design.bench import TOPPLING, Bench, strengths_at
from slopekit.studies.bench_design.given import BenchInputs
from slopekit.studies.bench_design.trials import Trials
from slopekit.studies.kinematic.criteria import beside_deg
from slopekit.studies.points import GIVEN_UP, Point
from slopekit.studies.prob.judged import chosen
from slopekit.studies.protocol import Workplace
from slopekit.studies.running import Crew, run_all

_TURNS = ("topples", "rotates", "falls", "lifts")


@dataclass(frozen=True, slots=True)
class ConfirmedColumns:
    """What PRE-IE says of columns on their own.

    Attributes
    ----------
    samples, near : how many were looked at, and how many of them lie near turning over
    topple, stand : against turning over, by both; pre_ie_only, closed_form_only : turn over by one of the two
    slide : of those that stand against turning over, they slide by PRE-IE below the target
    unanswered : PRE-IE did not converge
    doubted : heights and faces of benches in which a column turns over by PRE-IE alone, or has no answer of it
    """

    JSON_ALSO: ClassVar = ()
    samples: int
    near: int = field(metadata={"json": "near_target"})
    topple: int
    stand: int
    pre_ie_only: int = field(metadata={"json": "topple_by_pre_ie_only"})
    closed_form_only: int = field(metadata={"json": "topple_by_closed_form_only"})
    slide: int
    unanswered: int
    doubted: frozenset[tuple[float, float]] = field(metadata={"json": None})


def confirmed_columns(
    asked: BenchInputs, trials: Trials, benches: Sequence[Bench], crew: Crew, desk: Workplace
) -> ConfirmedColumns | None:
    """PRE-IE's judgement of the first column of places that are chosen; None where none is asked for.

    A random part, and all within the part `near` of turning over: that is a matter of shape, whatever the target.
    """
    factor = np.concatenate([bench.factor[TOPPLING] for bench in benches])
    known = np.isfinite(factor)
    count, within = int(asked.number("confirm")), asked.near
    index = chosen(known, factor, 1.0, count, within, int(asked.number("seed")))
    if not count or not len(index.all):
        return None
    rows = [divmod(int(one), len(trials)) for one in index.all]
    designs = [_column(asked, trials, benches[part], trial) for part, trial in rows]
    from slopekit.studies.bench_design.confirmed import both_methods

    with desk.bar("columns", len(designs)) as advance:
        records = run_all(both_methods, designs, crew, advance=advance, given_up=GIVEN_UP)
    points = [Point.from_record(record) for record in records]
    turns = factor[index.all] < 1.0
    counts = {"topple": 0, "stand": 0, "pre_ie_only": 0, "closed_form_only": 0, "slide": 0, "unanswered": 0}
    doubted = set()
    for (part, _), point, turned in zip(rows, points, turns.tolist(), strict=True):
        said = point.factors
        if said is None or said.status == "not_converged":
            counts["unanswered"] += 1
        else:
            too = said.status in _TURNS
            name = ("topple" if too else "closed_form_only") if turned else "pre_ie_only" if too else "stand"
            counts[name] += 1
            counts["slide"] += not too and not turned and said.limit is not None and said.limit < asked.number("fos")
            if turned or not too:
                continue
        if not turned:
            doubted.add((benches[part].height_m, benches[part].face_dip_deg))
    return ConfirmedColumns(len(points), int(index.near.sum()), **counts, doubted=frozenset(doubted))


def _column(asked: BenchInputs, trials: Trials, bench: Bench, trial: int) -> Design:
    """The first column of a place on its base, per metre: x against the dip of the base, z up."""
    from slopekit.design.reading.files import load

    ground = asked.ground(bench.height_m)
    joints = int(trials.first[trial]), int(trials.second[trial])
    at = 0 if float(beside_deg(ground.dip_directions_deg[[joints[0]]], ground.toward_deg)[0]) < 90.0 else 1
    base, steep = joints[at], joints[1 - at]
    dip, out, width = float(ground.dips_deg[steep]), float(ground.dips_deg[base]), float(ground.spacing_m[steep])
    top = float(bench.block_height_m[TOPPLING, trial])
    high = float(column_sizes(dip, out, bench.face_dip_deg, top, width).height_m[0])
    cohesion, friction = (float(part[at, trial]) for part in strengths_at(ground, trials))
    foot = width / math.sin(math.radians(dip + out))
    along = np.array([math.cos(math.radians(out)), math.sin(math.radians(out))])
    up = high * np.array([-math.cos(math.radians(dip)), math.sin(math.radians(dip))])
    corners = np.array([[0.0, 0.0], foot * along, foot * along + up, up])
    bed = np.array([-0.5 * foot * along, 1.5 * foot * along])
    low = float(bed[0, 1]) - foot
    under = [*bed.tolist(), [float(bed[1, 0]), low], [float(bed[0, 0]), low]]
    return load({
        "slopekit": 1, "kind": "blocks",
        "blocks": {"base": {"polygon": under, "fixed": True}, "C1": {"polygon": corners.tolist()}},
        "strength": {"base": {"c": cohesion, "phi": f"{friction!r} deg"}},
        "rock": {"unit_weight": ground.unit_weight_kn_m3},
    })  # fmt: skip
