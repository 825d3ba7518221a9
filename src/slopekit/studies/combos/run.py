"""Every pair of a joint survey as a wedge in a slope: removable or not and why, by both methods, ranked.

>>> import slopekit as sk
>>> found = sk.combos(["45/115", "45/245", "50/240", "80/350"], face="65/180", height=15, c=10, phi=30)
>>> found.counts["slides_on_both"], sum(found.counts.values()), found.removable
(2, 6, 2)
>>> [(pair.names, round(pair.closed_form, 3), pair.agree) for pair in found.worst]
[(('J1', 'J3'), 1.858, True), (('J1', 'J2'), 2.134, True)]
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Annotated, Any, ClassVar

import numpy as np

from slopekit.core.arrays import Floats, Ints
from slopekit.core.codec import json_of
from slopekit.core.errors import Notice
from slopekit.core.orientation import Line, Plane
from slopekit.design.joint_lists import JointList
from slopekit.kinds.single_block.blocks_on_arrays import LimitsOfMany
from slopekit.kinds.wedge.limits import LIMITED_BY
from slopekit.studies.combos.pairs import (
    PAIR_OUTCOMES,
    UNUSED_OUTCOMES,
    JointPairs,
    PairInputs,
    joint_pairs,
    pair_inputs,
)
from slopekit.studies.evaluation.rows import BlockRows, evaluated
from slopekit.studies.joint_wedges import limits_of_wedges
from slopekit.studies.outcomes import (
    STANDS,
    BothMethods,
    ByMethod,
    Outcomes,
    agreement_of_methods,
)
from slopekit.studies.points import Point
from slopekit.studies.protocol import (
    DESK,
    ClosedFormAlone,
    Jobs,
    Option,
    Scheduler,
    StudyOutcome,
    Workplace,
    documented,
)
from slopekit.studies.running import checked_crew
from slopekit.studies.surveys import (
    AFace,
    AJointList,
    Columns,
    Convention,
    SkipBad,
    joint_list_notices,
    survey_head,
)


@dataclass(frozen=True)
class PairCheck:
    """A listed pair of joints with the results of both methods.

    Attributes
    ----------
    index : among all pairs; names, planes : of its joints
    status, limit : of PRE-IE; the closed form's status and no limit where that was asked alone
    height_m : at the trace of the first joint; volume_m3 : of the wedge, `scale` of its lengths within limits of size
    extent_m : how wide it is on the face and how far it reaches behind the crest; line : of intersection
    """

    index: int
    names: tuple[str, str]
    planes: tuple[Plane, Plane]
    status: str
    limit: float | None
    closed_status: str
    closed_form: float | None
    difference: float | None
    agree: bool | None
    moments_govern: bool
    height_m: float
    volume_m3: float
    scale: float
    limited_by: str
    extent_m: Mapping[str, float]
    line: Line

    def to_dict(self) -> dict[str, Any]:
        """The pair as JSON values."""
        return {
            "joints": list(self.names),
            "planes": [str(plane) for plane in self.planes],
            "status": self.status,
            "fos": {"limit": self.limit, "closed_form": self.closed_form},
            "closed_form_status": self.closed_status,
            "difference": self.difference,
            "agree": self.agree,
            "moments_govern": self.moments_govern,
            "volume_m3": self.volume_m3,
            "height_m": self.height_m,
            "scale": self.scale,
            **self.extent_m,
            "limited_by": self.limited_by or None,
            "line": json_of(self.line),
        }


@dataclass(frozen=True, repr=False)
class Combos(StudyOutcome):
    """The pairs of a joint survey as wedges in a slope.

    Attributes
    ----------
    given : the joints with their strengths, the slope, the limits of size
    pairs : of all, by the closed form; ranked : (r,) the removable ones, worst first by the method that counts
    outcomes : what both methods say of the ranked, or the closed form alone
    """

    name: ClassVar[str] = "combos"
    given: PairInputs
    pairs: JointPairs
    ranked: Ints
    outcomes: Outcomes
    timing_s: Mapping[str, float] = field(default_factory=dict, compare=False)

    @cached_property
    def worst(self) -> tuple[PairCheck, ...]:
        """The listed pairs, worst first."""
        indices = self.ranked[: self.given.top].tolist()
        points = self.outcomes.take(np.arange(len(indices))).points
        return tuple(self._pair_check(k, point) for k, point in zip(indices, points, strict=True))

    def _pair_check(self, k: int, point: Point) -> PairCheck:
        pairs, factors = self.pairs, point.factors
        assert factors is not None  # a removable pair is a block
        joints = [
            self.joints.joints[int(joint_index[k])] for joint_index in (pairs.first, pairs.second)
        ]
        return PairCheck(
            index=k,
            names=(joints[0].name, joints[1].name),
            planes=(joints[0].plane, joints[1].plane),
            status=factors.status,
            limit=factors.limit,
            closed_status=factors.closed_status or "",
            closed_form=factors.closed_form,
            difference=factors.difference,
            agree=factors.agree,
            moments_govern=factors.moments_govern,
            height_m=float(pairs.height_m[k]),
            volume_m3=float(pairs.volume_m3[k]),
            scale=float(pairs.scale[k]),
            limited_by=LIMITED_BY[pairs.by[k]],
            extent_m={
                name: float(getattr(pairs.sizes, name)[k]) for name in ("face_width_m", "setback_m")
            },
            line=Line(float(pairs.trend_deg[k]), float(pairs.plunge_deg[k])),
        )

    @cached_property
    def both(self) -> BothMethods | None:
        """Agreement of the methods on the removable pairs; None with the closed form alone."""
        target, outcomes = self.given.target or 1.0, self.outcomes
        if not outcomes.pre_ie:
            return None
        return agreement_of_methods(
            outcomes, outcomes.limit.falls_short(target), outcomes.closed_form.falls_short(target)
        )

    @property
    def charts(self) -> tuple[str, ...]:
        """The stereonet of the worst pairs."""
        return ("stereonet",) if self.worst else ()

    @property
    def exit_code(self) -> int:
        """0 done, 1 pairs below the target, 4 the methods disagree or PRE-IE did not converge."""
        if self.both is not None and (self.both.disagree or self.both.without_answer):
            return 4
        return 1 if self.target is not None and self.target["below"] else 0

    @property
    def joints(self) -> JointList:
        """The joints of the list."""
        return self.given.joints

    @property
    def counts(self) -> dict[str, int]:
        """Number of pairs by outcome; the numbers add up to all pairs."""
        frequencies = np.bincount(self.pairs.outcome, minlength=len(PAIR_OUTCOMES))
        counted = zip(PAIR_OUTCOMES, map(int, frequencies), strict=True)
        return {name: count for name, count in counted if name not in UNUSED_OUTCOMES}

    @property
    def removable(self) -> int:
        """Number of pairs that form a removable wedge."""
        return int(self.pairs.is_removable.sum())

    @property
    def target(self) -> dict[str, Any] | None:
        """Number and volumes of the pairs `below` the target `fos`, None without a target; volumes None without pairs.

        By PRE-IE, by either method where they disagree; `by_pre_ie_only`: not by the closed form.
        """
        fos, outcomes = self.given.target, self.outcomes
        if fos is None:
            return None
        by_forces = outcomes.closed_form.falls_short(fos)
        below = outcomes.limit.falls_short(fos) | ((outcomes.agree == 0) & by_forces)
        volumes = self.pairs.volume_m3[self.ranked[below]]
        return {
            "fos": fos,
            "below": int(below.sum()),
            "by_pre_ie_only": int((below & ~by_forces).sum()),
            "largest_volume_m3": float(volumes.max()) if len(volumes) else None,
            "median_volume_m3": float(np.median(volumes)) if len(volumes) else None,
        }

    @property
    def warnings(self) -> tuple[Notice, ...]:
        """Notices: where moments govern, what of the list is not used."""
        notices = list(joint_list_notices(self.joints))
        if self.joints.has_quantities:
            contents = f"{len(self.joints)} joints, {self.joints.quantities.sum():.6g} by quantity"
            message = (
                f"quantities of {self.joints.name} ({contents}) count nothing here: "
                "each pair of joints stands once"
            )
            notices.append(Notice("W373", message))
        agreement = self.both if self.target is not None else None
        return (
            *(() if agreement is None else agreement.notices("removable pairs", self.removable)),
            *notices,
        )

    def to_dict(self) -> dict[str, Any]:
        """The result as JSON values; times stand in a block of their own."""
        return {
            **survey_head("combos", self.joints, self.given.input_hash()),
            "inputs": self.given.to_dict(),
            "defaults": list(self.given.defaults),
            "pairs": len(self.pairs),
            "counts": self.counts,
            "removable": self.removable,
            "scaled_down": {
                name.replace(" ", "_"): int(
                    (self.pairs.is_removable & (self.pairs.by == kind)).sum()
                )
                for kind, name in enumerate(LIMITED_BY)
                if name
            },
            "target": self.target,
            "worst": json_of(self.worst),
            "methods": json_of(self.both),
            "timing_s": dict(self.timing_s),
            **self.words(),
        }


@documented
def combos(
    joints: AJointList,
    *,
    face: AFace = None,
    upper: Annotated[Any, Option("Upper slope, D/DD [level].")] = None,
    height: Annotated[
        Any, Option("Vertical, from a wedge's toe up the dip of the face to the crest [15 m].")
    ] = None,
    c: Annotated[Any, Option("Cohesion of joints without their own.")] = None,
    phi: Annotated[Any, Option("Friction angle of joints without their own.")] = None,
    density: Annotated[Any, Option("Density [2600 kg/m3].")] = None,
    unit_weight: Annotated[Any, Option("Unit weight, kN/m3, instead of a density.")] = None,
    water: Annotated[Any, Option("dry, full, 50% or u=9.8kPa [dry].")] = None,
    seismic: Annotated[Any, Option("Pseudo-static coefficient, K or K@TREND.")] = None,
    fos: Annotated[Any, Option("Target: exit code 1 where a removable pair lies below.")] = None,
    top: Annotated[
        float | str | None, Option("How many of the worst are listed, or all [10].")
    ] = None,
    slope_length: Annotated[
        Any, Option("Longest stretch of the crest that a wedge takes, m.")
    ] = None,
    trace_length: Annotated[
        Any, Option("Longest trace of a joint, on face or upper slope, m.")
    ] = None,
    persistence: Annotated[Any, Option("Longest edge of a joint in a wedge, m.")] = None,
    bench_width: Annotated[Any, Option("How far behind the crest wedges reach, m.")] = None,
    max_volume: Annotated[Any, Option("Wedges are scaled down to it, m3.")] = None,
    min_volume: Annotated[Any, Option("Smaller wedges are left out, and counted, m3.")] = None,
    limit_by: Annotated[
        Any, Option("scale or filter: larger wedges are made smaller, or left out [scale].")
    ] = None,
    closed_form: ClosedFormAlone = False,
    convention: Convention = None,
    columns: Columns = None,
    skip_bad: SkipBad = False,
    jobs: Jobs = 1,
    scheduler: Scheduler = None,
    desk: Workplace = DESK,
) -> Combos:
    """Every pair of a joint list as a wedge: removable or not and why, by both methods, ranked.

    Columns c and phi of the list count before --c and --phi. Exit codes: 0 done, 1 pairs below --fos, 2 bad input, 4
    the methods disagree.

    Raises
    ------
    DesignError
        Every fault: of the list, of the slope as for a wedge, E143 a strength that a joint needs, E116 limits of size,
        E126 top, or neither scale nor filter, E307 fos, E109 two values where pairs have no order.
    GeometryError
        E209 the slope has no crest.

    Notes
    -----
    In Python `joints` are the path of a CSV file, planes ("45/115", (45, 115)), an (n, 2) array of dip and dip
    direction, or {name: plane}; what the slope takes is written as for `slopekit.wedge`.

    n joints have n (n - 1) / 2 pairs; both methods judge all that are removable at once. A pair is removable where its
    line of intersection daylights: steeper than the upper slope and flatter than the face along its own trend. Where it
    is, joints are taken to meet in the slope.

    References
    ----------
    Hoek & Bray (1981), Rock Slope Engineering, ch. 8; Goodman & Shi (1985), Block Theory, for removability.

    Examples
    --------
    >>> import slopekit as sk
    >>> found = sk.combos(["45/115", "45/245", "80/030"], face="60/180", c=50, phi=20, top=1)
    >>> found.counts["slides_on_both"], found.counts["too_steep"], found.worst[0].names, found.worst[0].agree
    (1, 1, ('J1', 'J2'), True)
    """
    options, start = dict(locals()), time.perf_counter()
    crew = checked_crew(jobs, scheduler)
    inputs = pair_inputs(options, desk.named)
    read = time.perf_counter()
    pairs = joint_pairs(
        inputs.joints, inputs.slope, inputs.limits, inputs.cohesion_kpa, inputs.friction_deg
    )
    closed = time.perf_counter()
    removable = np.flatnonzero(pairs.is_removable)
    by_forces = ByMethod(
        PAIR_OUTCOMES, pairs.outcome[removable].astype(np.int16), pairs.factor[removable]
    )
    if closed_form:
        count = len(removable)
        no_mechanism = ByMethod(("",), np.zeros(count, dtype=np.int16), np.full(count, np.nan))
        outcomes = Outcomes.by_closed_form(by_forces, no_mechanism)
    else:
        wedges = pairs.first[removable], pairs.second[removable], pairs.height_m[removable]
        rows = BlockRows(
            inputs.slope, by_forces, [inputs.input_hash()], partial(_wedge_limits, inputs, wedges)
        )
        outcomes = evaluated(rows, "combos", crew, desk, label="pairs")
        is_parallel = outcomes.limit.starts_with("E")  # planes so nearly parallel cut none
        pairs.outcome[removable[is_parallel]], pairs.factor[removable[is_parallel]] = (
            PAIR_OUTCOMES.index("no_wedge"),
            np.nan,
        )
        removable, outcomes = removable[~is_parallel], outcomes.take(np.flatnonzero(~is_parallel))
    order = _rank_order(outcomes.limit, pairs.volume_m3[removable])
    end = time.perf_counter()
    times = {
        "read": read - start,
        "closed_form": closed - read,
        "pre_ie": end - closed,
        "total": end - start,
    }
    return Combos(inputs, pairs, removable[order], outcomes.take(order), times)


def _rank_order(limit: ByMethod, volume_m3: Floats) -> Ints:
    """Return the order of wedges by a method: without a factor, by factor, without driving force; larger ones first."""
    rank = np.where(limit.starts_with(STANDS), 2, np.where(np.isnan(limit.factor), 0, 1))
    return np.lexsort((-volume_m3, np.nan_to_num(limit.factor), rank))


def _wedge_limits(
    inputs: PairInputs, wedges: tuple[Ints, Ints, Floats], rows: Ints
) -> LimitsOfMany:
    """Return the PRE-IE limits of the wedges `rows` (m,) among wedges of two joints and a height in m, (r,) each."""
    strengths, (first, second, height_m) = (inputs.cohesion_kpa, inputs.friction_deg), wedges
    return limits_of_wedges(
        inputs.slope, inputs.joints, strengths, first[rows], second[rows], height_m[rows]
    )
