"""Every pair of a joint survey as a wedge in a slope: removable or not and why, ranked, PRE-IE on the worst.

>>> import slopekit as sk
>>> found = sk.combos(["45/115", "45/245", "50/240", "80/350"], face="65/180", height=15, c=10, phi=30)
>>> found.counts["slides_on_both"], sum(found.counts.values()), found.removable
(2, 6, 2)
>>> [(pair.names, round(pair.closed_form, 3), pair.agree) for pair in found.worst]
[(('J1', 'J3'), 1.858, True), (('J1', 'J2'), 2.134, True)]
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Annotated, Any, ClassVar

import numpy as np

from slopekit.core.arrays import Bools
from slopekit.core.codec import json_of
from slopekit.core.errors import Notice
from slopekit.core.orientation import Plane
from slopekit.design.joint_lists import JointList
from slopekit.kinds.protocol import Factors
from slopekit.kinds.wedge.limits import LIMITED_BY
from slopekit.studies.combos.pairs import NEVER, PAIR_OUTCOMES, JointPairs, PairInputs, evaluated, pair_inputs
from slopekit.studies.points import UNSETTLED, Point, both_methods, kept_points
from slopekit.studies.protocol import DESK, Jobs, Option, Scheduler, StudyOutcome, Workplace, documented
from slopekit.studies.running import Crew, checked_crew
from slopekit.studies.surveys import AFace, AJointList, Columns, Convention, SkipBad, left_out, survey_head

_NOTHING_HOLDS = ("lifted", "falls", "topples")


@dataclass(frozen=True)
class PairCheck(Factors):
    """A pair that PRE-IE has looked at: what both methods say of it.

    Attributes
    ----------
    index : among all pairs; names, planes : of its joints
    height_m : at the trace of the first joint; volume_m3 to plunge_deg : of the wedge
    """

    index: int
    names: tuple[str, str]
    planes: tuple[Plane, Plane]
    height_m: float
    volume_m3: float
    face_width_m: float
    setback_m: float
    scale: float
    limited_by: str
    trend_deg: float
    plunge_deg: float

    @property
    def is_in_doubt(self) -> bool:
        """Whether the methods disagree, or PRE-IE did not settle."""
        return self.agree is False or not self.settled

    def falls_short(self, target: float) -> bool:
        """Whether PRE-IE finds it below a factor of safety, or that nothing holds it."""
        return self.status in _NOTHING_HOLDS or (self.limit is not None and self.limit < target)

    def severity(self) -> tuple[int, float, float]:
        """Where it stands among others by PRE-IE: what has no factor, then by factor, then what stands."""
        if self.status == "no_driving_force":
            return 2, 0.0, -self.volume_m3
        return (0, 0.0, -self.volume_m3) if self.factor is None else (1, self.factor, -self.volume_m3)

    def to_dict(self) -> dict[str, Any]:
        """The pair as JSON values."""
        return {
            "joints": list(self.names), "planes": [str(plane) for plane in self.planes], "status": self.status,
            "fos": {"limit": self.limit, "closed_form": self.closed_form}, "closed_form_status": self.closed_status,
            "difference": self.difference, "agree": self.agree, "moments_govern": self.moments_govern,
            "settled": self.settled, "volume_m3": self.volume_m3, "height_m": self.height_m, "scale": self.scale,
            "face_width_m": self.face_width_m, "setback_m": self.setback_m,
            "limited_by": self.limited_by or None, "line": {"trend_deg": self.trend_deg, "plunge_deg": self.plunge_deg},
        }  # fmt: skip


@dataclass(frozen=True, repr=False)
class Combos(StudyOutcome):
    """A survey's pairs against a slope.

    Attributes
    ----------
    given : the joints with their strengths, the slope, the limits of size
    worst : the pairs that PRE-IE has looked at, worst first by the closed form; by PRE-IE where it looked at all
    """

    name: ClassVar[str] = "combos"
    given: PairInputs
    pairs: JointPairs
    worst: tuple[PairCheck, ...]
    timing_s: Mapping[str, float] = field(default_factory=dict, compare=False)

    @property
    def charts(self) -> tuple[str, ...]:
        """The stereonet of the worst."""
        return ("stereonet",) if self.worst else ()

    @property
    def exit_code(self) -> int:
        """0 done, 1 pairs below the target, 4 the methods disagree or PRE-IE did not converge."""
        if any(pair.is_in_doubt for pair in self.worst):
            return 4
        return 1 if self.target is not None and self.target["below"] else 0

    @property
    def joints(self) -> JointList:
        """The joints of the list."""
        return self.given.joints

    @property
    def counts(self) -> dict[str, int]:
        """How many pairs there are of each outcome; they add up to all pairs."""
        frequencies = np.bincount(self.pairs.outcome, minlength=len(PAIR_OUTCOMES))
        counted = zip(PAIR_OUTCOMES, map(int, frequencies), strict=True)
        return {name: count for name, count in counted if name not in NEVER}

    @property
    def removable(self) -> int:
        """How many pairs form a wedge that could leave the slope."""
        return int(self.pairs.is_removable.sum())

    def below(self, fos: float) -> Bools:
        """Which of all pairs lie below: by PRE-IE where it looked; by either method where they are in doubt of it."""
        is_below = self.pairs.fails(fos)
        for pair in self.worst:
            is_below[pair.index] = pair.falls_short(fos) or (pair.is_in_doubt and is_below[pair.index])
        return is_below

    @property
    def target(self) -> dict[str, Any] | None:
        """What lies `below` the target `fos`, None without one; volumes are None where nothing does.

        `judged_by_pre_ie`: of the removable pairs, those for which PRE-IE counts: of the others the closed form does;
        `by_pre_ie_only`: below by PRE-IE, not by the closed form.
        """
        fos = self.given.target
        if fos is None:
            return None
        below = self.below(fos)
        volumes = self.pairs.volume_m3[below]
        return {
            "fos": fos, "below": int(below.sum()), "judged_by_pre_ie": sum(not one.is_in_doubt for one in self.worst),
            "by_pre_ie_only": int((below & ~self.pairs.fails(fos)).sum()),
            "largest_volume_m3": float(volumes.max()) if len(volumes) else None,
            "median_volume_m3": float(np.median(volumes)) if len(volumes) else None,
        }  # fmt: skip

    @property
    def warnings(self) -> tuple[Notice, ...]:
        """What a reader must know: where moments govern, what is not used of the list."""
        own = left_out(self.joints)
        if self.joints.has_quantities:
            whole = f"{len(self.joints)} joints, {self.joints.quantities.sum():.6g} by quantity"
            message = f"quantities of {self.joints.name} ({whole}) count nothing here: each pair of joints stands once"
            own.append(Notice("W373", message))
        governed = [pair for pair in self.worst if pair.moments_govern]
        if not governed:
            return tuple(own)
        lowered = [1.0 - pair.limit / pair.closed_form for pair in governed if pair.limit and pair.closed_form]
        topple = sum(pair.status == "topples" for pair in governed)
        by = [f"by up to {max(lowered) * 100:.1f} %"] if lowered else []
        by += [f"{topple} of them topple"] if topple else []
        rest = self.removable - len(self.worst)
        last = f"; the other {rest} removable pairs have the closed form alone, which knows no moments" if rest else ""
        message = f"moments govern {len(governed)} of the {len(self.worst)} pairs that PRE-IE looked at"
        return (Notice("W353", ", ".join([message, *by]) + last), *own)

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
                name.replace(" ", "_"): int((self.pairs.is_removable & (self.pairs.by == kind)).sum())
                for kind, name in enumerate(LIMITED_BY) if name
            },
            "target": self.target,
            "worst": json_of(self.worst),
            "pre_ie": {
                "pairs": len(self.worst), "agree": sum(pair.agree is True for pair in self.worst),
                "disagree": sum(pair.agree is False for pair in self.worst),
                "not_compared": sum(pair.agree is None for pair in self.worst),
                "moments_govern": sum(pair.moments_govern for pair in self.worst),
                "not_settled": sum(not pair.settled for pair in self.worst),
                "largest_difference": max(
                    (pair.difference for pair in self.worst if pair.difference is not None), default=None
                ),
            },
            "timing_s": dict(self.timing_s),
            **self.words(),
        }  # fmt: skip


@documented
def combos(
    joints: AJointList,
    *,
    face: AFace = None,
    upper: Annotated[Any, Option("Upper slope, D/DD [level].")] = None,
    height: Annotated[Any, Option("Vertical, from a wedge's toe up the dip of the face to the crest [15 m].")] = None,
    c: Annotated[Any, Option("Cohesion of joints without their own.")] = None,
    phi: Annotated[Any, Option("Friction angle of joints without their own.")] = None,
    density: Annotated[Any, Option("Density [2600 kg/m3].")] = None,
    unit_weight: Annotated[Any, Option("Unit weight, kN/m3, instead of a density.")] = None,
    water: Annotated[Any, Option("dry, full, 50% or u=9.8kPa [dry].")] = None,
    seismic: Annotated[Any, Option("Pseudo-static coefficient, K or K@TREND.")] = None,
    fos: Annotated[Any, Option("Target: exit code 1 where a removable pair lies below.")] = None,
    top: Annotated[float | str | None, Option("How many of the worst PRE-IE looks at, or all [10].")] = None,
    slope_length: Annotated[Any, Option("Longest stretch of the crest that a wedge takes, m.")] = None,
    trace_length: Annotated[Any, Option("Longest trace of a joint, on face or upper slope, m.")] = None,
    persistence: Annotated[Any, Option("Longest edge of a joint in a wedge, m.")] = None,
    bench_width: Annotated[Any, Option("How far behind the crest wedges reach, m.")] = None,
    max_volume: Annotated[Any, Option("Wedges are scaled down to it, m3.")] = None,
    min_volume: Annotated[Any, Option("Smaller wedges are left out, and counted, m3.")] = None,
    limit_by: Annotated[Any, Option("scale or filter: larger wedges are made smaller, or left out [scale].")] = None,
    convention: Convention = None,
    columns: Columns = None,
    skip_bad: SkipBad = False,
    jobs: Jobs = 1,
    scheduler: Scheduler = None,
    desk: Workplace = DESK,
) -> Combos:
    """Every pair of a joint list as a wedge: removable or not and why, ranked; PRE-IE on the worst.

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

    n joints have n (n - 1) / 2 pairs; the closed form of the wedge judges all at once. A pair is removable where its
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
    given, began = dict(locals()), time.perf_counter()
    crew = checked_crew(jobs, scheduler)
    asked = pair_inputs(given, desk.named)
    read = time.perf_counter()
    pairs = evaluated(asked.joints, asked.slope, asked.limits, asked.cohesion_kpa, asked.friction_deg)
    closed = time.perf_counter()
    worst = _looked_at(asked, pairs, crew, desk)
    end = time.perf_counter()
    times = {"read": read - began, "closed_form": closed - read, "pre_ie": end - closed, "total": end - began}
    return Combos(asked, pairs, worst, times)


def _looked_at(asked: PairInputs, pairs: JointPairs, crew: Crew, desk: Workplace) -> tuple[PairCheck, ...]:
    """PRE-IE on the worst, or on all; what is done is kept in a journal until all are."""
    chosen = pairs.ranked()[: asked.top]
    joints, cohesion, friction = asked.joints.joints, asked.cohesion_kpa, asked.friction_deg
    one, two = pairs.first, pairs.second
    designs = [
        replace(
            asked.slope, joints=(joints[a].plane, joints[b].plane), joint_names=(joints[a].name, joints[b].name),
            height_m=float(pairs.height_m[k]),
            strengths=asked.slope.with_c_and_phi(cohesion[[a, b]].tolist(), friction[[a, b]].tolist()),
        )
        for k, a, b in zip(chosen, one[chosen], two[chosen], strict=True)
    ]  # fmt: skip
    points, journal = kept_points(both_methods, designs, crew, desk, "combos", "PRE-IE", asked.input_hash())
    journal.remove()
    checks = tuple(
        PairCheck(
            **_said_of(point), index=int(k), names=design.joint_names, planes=design.joints, height_m=design.height_m,
            volume_m3=float(pairs.volume_m3[k]), face_width_m=float(pairs.sizes.face_width_m[k]),
            setback_m=float(pairs.sizes.setback_m[k]), scale=float(pairs.scale[k]),
            limited_by=LIMITED_BY[pairs.by[k]], trend_deg=float(pairs.trend_deg[k]),
            plunge_deg=float(pairs.plunge_deg[k]),
        )
        for k, design, point in zip(chosen, designs, points, strict=True)
    )  # fmt: skip
    return tuple(sorted(checks, key=PairCheck.severity)) if asked.top is None else checks


def _said_of(point: Point) -> dict[str, Any]:
    """What both methods say of a pair; one that broke is not settled."""
    factors = point.factors or Factors(UNSETTLED, None, "", None, None, None, False, False)
    settled = factors.settled and factors.status != UNSETTLED
    return {each.name: getattr(factors, each.name) for each in fields(Factors)} | {"settled": settled}
