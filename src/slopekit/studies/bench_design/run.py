"""Benches from a joint survey: failures by height and face angle, and the berm that keeps the catch width.

trials -> blocks that form and fail in each bench -> shares, backbreak, volume, berms.

>>> import slopekit as sk
>>> found = sk.bench_design(["50/150", "55/215", "48/165", "60/200", "80/005"], height=15, face=[65, 80],
...                         dip_direction=180, c=0, phi=30, n=400)
>>> [round(bench.modes["any"]["fails"].share, 2) for bench in found.benches]
[0.59, 0.72]
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar

import numpy as np

from slopekit.core.codec import json_of, record_of
from slopekit.core.errors import Notice
from slopekit.core.orientation import number
from slopekit.design.joint_lists import JointList
from slopekit.studies.bench_design.inputs import BenchInputs, bench_inputs
from slopekit.studies.bench_design.limits import evaluated_benches
from slopekit.studies.bench_design.outcomes import (
    BenchStatistics,
    BermStatistics,
    bench_statistics,
    without_cohesion,
)
from slopekit.studies.bench_design.trials import drawn_trials
from slopekit.studies.outcomes import BothMethods, total_agreement
from slopekit.studies.protocol import (
    DESK,
    Argument,
    Jobs,
    Option,
    Scheduler,
    StudyOutcome,
    Workplace,
    documented,
    timed,
)
from slopekit.studies.running import checked_crew
from slopekit.studies.surveys import Columns, Convention, SkipBad, joint_list_notices, survey_head

_MIN_ORIENTATIONS = 30  # joints: below it, a survey says little of its sets


def notices_of(
    inputs: BenchInputs, benches: Sequence[BenchStatistics], agreement: BothMethods
) -> Iterator[Notice]:
    """Yield the notices on the survey, the options and the mechanisms that were not counted."""
    yield from joint_list_notices(inputs.joints)
    n = len(inputs.joints)
    n_orientations = len({joint.plane for joint in inputs.joints.joints})
    if n_orientations < _MIN_ORIENTATIONS:
        orientations = (
            f" in {n_orientations} orientation{'s' if n_orientations > 1 else ''}"
            if n_orientations < n
            else ""
        )
        yield Notice(
            "W390",
            f"{inputs.joints.name} holds {n} joints{orientations}: the same few meet again and again, "
            "see the limits",
        )
    n_traces = int(np.isfinite(inputs.trace_m).sum())
    if n_traces < n:
        yield Notice(
            "W391",
            f"{n - n_traces} of {n} joints have no trace length and run as far as a block needs: blocks are too large",
        )
    if not np.isfinite(inputs.spacing_m).all():
        n_missing = int((~np.isfinite(inputs.spacing_m)).sum())
        yield Notice(
            "W391",
            f"{n_missing} of {n} joints have no spacing: columns between them form and are not judged",
        )
    if inputs.every_m is None:
        yield Notice(
            "W391",
            "how often joints meet along the bench is not known: one place is taken for each bench height; volumes per "
            "100 m go with it",
        )
    narrow = sorted(
        {
            (berm.berm_m, berm.catch_width_m)
            for bench in benches
            for berm in bench.berms
            if berm.berm_m < berm.catch_width_m * (1.0 - 1e-12)
        }
    )
    if narrow:
        first, catch = narrow[0]
        yield Notice(
            "W394",
            f"a berm of {number(first)} m is narrower than the catch width of {number(round(catch, 3))} m before "
            "anything fails: no place keeps it; a wider berm, or a catch width of your own (--catch)",
        )
    wider = [
        bench
        for bench in benches
        if any(bench.backbreak["max"] > berm.berm_m for berm in bench.berms)
    ]
    if wider:
        worst = max(bench.backbreak["max"] for bench in wider)
        yield Notice(
            "W394",
            f"in {len(wider)} of {len(benches)} benches some places lose more than the whole berm (up "
            f"to {number(round(worst, 1))} m): the bench above, which would come along, is left out",
        )
    yield from _cohesion_notice(benches)
    slope = inputs.slope
    if any(bench.modes["toppling"]["forms"].count for bench in benches) and (
        slope.water.mode != "dry" or slope.seismic.coefficient
    ):
        yield Notice(
            "W395",
            "toppling columns are judged by their weight alone: water and earthquake do not act on them",
        )
    yield from agreement.notices("blocks", agreement.looked_at)


def _cohesion_notice(benches: Sequence[BenchStatistics]) -> Iterator[Notice]:
    """Yield W422 for the bench whose failing share grows most without cohesion."""
    decided = [
        (bench, bench.bare) for bench in benches if bench.bare is not None and bench.bare["decides"]
    ]
    if not decided:
        return
    bench, bare = max(
        decided,
        key=lambda pair: pair[1]["fails"]["any"] - (pair[0].modes["any"]["fails"].share or 0.0),
    )
    percent_failing = 100.0 * (bench.modes["any"]["fails_if_formed"].share or 0.0)
    yield Notice(
        "W422",
        f"the answer depends on cohesion in {len(decided)} of {len(benches)} benches: at {number(bench.height_m)} m "
        f"and {number(bench.face_dip_deg)}° {percent_failing:.3g} % of the blocks that form fail, with c = 0 "
        f"{100.0 * (bare['fails_if_formed']['any'] or 0.0):.3g} %; the berm needed is {bench.berm_needed_m:.3g} m or "
        f"{bare['berm_needed_m']:.3g} m",
    )


@dataclass(frozen=True, repr=False)
class BenchDesigns(StudyOutcome):
    """Benches of a joint survey: statistics by height and face angle.

    Attributes
    ----------
    given : the survey, the benches, the targets
    benches : statistics of each height and face angle
    both : agreement of the methods on the wedges and planes that are stable by the closed form
    """

    name: ClassVar[str] = "bench-design"
    charts: ClassVar[tuple[str, ...]] = ("backbreak",)
    given: BenchInputs
    benches: tuple[BenchStatistics, ...]
    both: BothMethods
    warnings: tuple[Notice, ...]

    @property
    def joints(self) -> JointList:
        """The joints of the survey."""
        return self.given.joints

    @property
    def berms(self) -> tuple[BermStatistics, ...]:
        """Every berm of every bench."""
        return tuple(berm for bench in self.benches for berm in bench.berms)

    @property
    def best(self) -> BenchStatistics:
        """The bench with the steepest inter-ramp angle at the target reliability."""
        return max(self.benches, key=lambda bench: bench.inter_ramp_deg)

    @property
    def steepest_accepted(self) -> BermStatistics | None:
        """The accepted berm with the steepest inter-ramp angle, None where no berm is accepted."""
        return max(
            (berm for berm in self.berms if berm.accepted),
            key=lambda berm: berm.inter_ramp_deg,
            default=None,
        )

    @property
    def accepted(self) -> bool | None:
        """Whether a berm reaches the required reliability, None where none is required."""
        verdicts = [berm.accepted for berm in self.berms]
        return None if verdicts[0] is None else any(verdicts)

    @property
    def exit_code(self) -> int:
        """0 done, 1 no bench is accepted, 4 the methods disagree or PRE-IE did not converge."""
        if self.both.disagree or self.both.without_answer:
            return 4
        return 1 if self.accepted is False else 0

    def to_dict(self) -> dict[str, Any]:
        """The result as JSON values; times stand in a block of their own."""
        best = self.best
        return {
            **survey_head("bench-design", self.joints, self.given.input_hash()),
            "inputs": self.given.to_dict(),
            "defaults": list(self.given.defaults),
            "benches": [record_of(bench) for bench in self.benches],
            "best": {
                name: getattr(best, name) for name in ("height_m", "face_dip_deg", "berm_needed_m")
            }
            | {
                "inter_ramp_deg": best.inter_ramp_deg,
                "reliability": self.given.number("reliability"),
            },
            "accept": self.given.numbers["accept"],
            "accepted": self.accepted,
            "methods": json_of(self.both),
            "timing_s": {"total": self.seconds},
            **self.words(),
        }


@timed
@documented
def bench_design(
    joints: Annotated[Any, Argument("A joint list (CSV, .xlsx, Dips, CloudCompare).", "JOINTS")],
    *,
    height: Annotated[
        Any, Option("Bench heights, m: 10,15 or 10:20:3 (how many) or 10:20:+5 (in steps).")
    ] = None,
    face: Annotated[Any, Option("Face angles, degrees: 60:80:5, 60:80:+5 or 65,75.")] = None,
    dip_direction: Annotated[Any, Option("Dip direction of the faces.")] = None,
    berm: Annotated[Any, Option("Berm widths, m [the width needed for --reliability].")] = None,
    c: Annotated[Any, Option("Cohesion of joints without their own.")] = None,
    phi: Annotated[Any, Option("Friction angle of joints without their own.")] = None,
    reliability: Annotated[
        Any, Option("Part of the length whose berm shall keep the catch width [80%].")
    ] = None,
    catch: Annotated[Any, Option("Catch width, m [modified Ritchie, 0.2 height + 4.5].")] = None,
    toe: Annotated[
        str | None,
        Option(
            "anywhere on the face, or of the bench: the largest block [anywhere].", metavar="WHERE"
        ),
    ] = None,
    trace: Annotated[
        Any, Option("Trace length of joints without their own, m [they run on].")
    ] = None,
    spacing: Annotated[
        Any, Option("Spacing of joints without their own, m [not known: no toppling].")
    ] = None,
    every: Annotated[
        Any, Option("From place to place along the bench, m [by spacing, else the height].")
    ] = None,
    lateral: Annotated[Any, Option("Lateral limit of planar sliding [20].")] = None,
    lateral_toppling: Annotated[Any, Option("Lateral limit of toppling [30].")] = None,
    density: Annotated[Any, Option("Density [2600 kg/m3].")] = None,
    unit_weight: Annotated[Any, Option("Unit weight, kN/m3, instead of a density.")] = None,
    water: Annotated[Any, Option("dry, full, 50% or u=9.8kPa [dry].")] = None,
    seismic: Annotated[Any, Option("Pseudo-static coefficient, out of the face.")] = None,
    swell: Annotated[Any, Option("Broken by solid volume [1.4].")] = None,
    repose: Annotated[Any, Option("Angle of repose of broken rock [37].")] = None,
    fos: Annotated[Any, Option("What fails has a factor of safety below this [1].")] = None,
    n: Annotated[Any, Option("Trials: places along the bench [10000].", flag="-n")] = None,
    confidence: Annotated[Any, Option("Of the confidence limits [95%].")] = None,
    accept: Annotated[
        Any,
        Option("Least reliability; exit code 1 where no bench reaches it with its lower limit."),
    ] = None,
    convention: Convention = None,
    columns: Columns = None,
    skip_bad: SkipBad = False,
    seed: Annotated[
        Any, Option("Seed of the random numbers: the same seed gives the same numbers [1].")
    ] = None,
    jobs: Jobs = 1,
    scheduler: Scheduler = None,
    desk: Workplace = DESK,
) -> BenchDesigns:
    """Benches from a joint survey: what fails by height and face angle, the berm that is left, the inter-ramp angle.

    A trial is a place along the bench where two joints of the survey meet: a wedge of both, a block on the first,
    columns of one on the other. Closed forms judge them all, PRE-IE the wedges and blocks that these let stand.
    Exit codes: 0 done, 1 no bench reaches --accept, 2 bad input, 4 the methods disagree.

    Raises
    ------
    DesignError
        Every fault: of the list, of the loads as for a wedge, E143 a strength that a joint needs, E101 and E116
        faces, heights and berms, E307 other numbers, E125 too many, E122 an earthquake that acts elsewhere.

    Notes
    -----
    Columns `trace` and `spacing` of the list count before --trace and --spacing. In Python `joints` are what
    `slopekit.combos` takes.

    With bench height H, face angle β and berm b the inter-ramp angle α has cot α = cot β + b / H. What fails breaks
    back behind the crest by x; a berm keeps its catch width w where b - x >= w. The reliability is the part of the
    length where it does.

    References
    ----------
    The modified Ritchie width 0.2 H + 4.5 m as given by Warren et al. (2025), SSIM 2025, doi 10.36487/ACG_repo/2535_04;
    the failures: Hoek & Bray (1981), Wyllie & Mah (2004).

    Examples
    --------
    >>> import slopekit as sk
    >>> found = sk.bench_design(["45/115", "45/245", "80/350"], height=15, face=70, dip_direction=180, c=2, phi=32,
    ...                         n=200)
    >>> found.best.catch_width_m, found.best.berm_needed_m, round(found.best.inter_ramp_deg, 2)
    (7.5, 7.5, 49.17)
    """
    options = dict(locals())
    crew = checked_crew(jobs, scheduler)
    inputs = bench_inputs(options, desk.named)
    trials = drawn_trials(
        inputs.joints, int(inputs.number("n")), int(inputs.number("seed")), inputs.toe == "anywhere"
    )
    benches, both = evaluated_benches(inputs, trials, crew, desk)
    outcomes = [bench_statistics(inputs, trials, bench) for bench in benches]
    agreement = total_agreement(both)
    if inputs.has_cohesion:
        bare = replace(inputs, cohesion_kpa=np.zeros(len(inputs.joints)))
        cohesionless_benches, _ = evaluated_benches(bare, trials, crew, desk)
        outcomes = [
            replace(outcome, bare=without_cohesion(bare, bench, outcome))
            for bench, outcome in zip(cohesionless_benches, outcomes, strict=True)
        ]
    is_sure = not (agreement.disagree or agreement.without_answer)
    outcomes = [with_acceptance(inputs, outcome, is_sure) for outcome in outcomes]
    notices = tuple(notices_of(inputs, outcomes, agreement))
    return BenchDesigns(inputs, tuple(outcomes), agreement, notices)


def with_acceptance(inputs: BenchInputs, bench: BenchStatistics, is_sure: bool) -> BenchStatistics:
    """Return the bench with the acceptance of its berms: by the lower limit, and only where the methods agree."""
    least = inputs.numbers["accept"]
    if least is None:
        return bench
    berms = (
        replace(berm, accepted=is_sure and berm.reliability.low >= least) for berm in bench.berms
    )
    return replace(bench, berms=tuple(berms))
