"""Displacements in earthquakes: yield coefficient by both methods, sliding integrated exactly.

>>> import slopekit as sk
>>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
>>> found = quake(sk.load(wedge), ["sine:0.5g,1Hz"])
>>> round(found.coefficient, 6), round(found.factor, 6)
(0.196243, 1.105688)
>>> round(found.shaken[0].as_recorded_m, 5), round(found.shaken[0].newmark_m, 5)
(0.2649, 0.23958)
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np

from slopekit.core.codec import json_of
from slopekit.core.errors import Fault, Faults, Notice, fail
from slopekit.core.orientation import number, opposite
from slopekit.core.units import quantity
from slopekit.design.common import Design
from slopekit.design.reading.files import with_values
from slopekit.kinds import (
    dilates,
    kind_of,
    notices_of_inputs,
    peak_strength_notice,
    whole_wedge_notice,
)
from slopekit.notices import new_notices
from slopekit.studies.protocol import (
    DESK,
    ADesign,
    Argument,
    Jobs,
    Option,
    StudyOutcome,
    Workplace,
    number_of,
    study,
)
from slopekit.studies.quake.records import Record, read_record, read_records
from slopekit.studies.quake.six import (
    POLARITIES,
    SETTLED_CHANGE,
    RecordSlide,
    Shaking,
    SixDofResponse,
    six_dof_response,
    slide,
)
from slopekit.studies.quake.yielding import (
    KEY,
    MOST_K,
    NO_FORM,
    Yield,
    check_stands,
    shown_k,
    static_design,
    way_out,
    yields_of,
)
from slopekit.studies.running import checked_crew
from slopekit.studies.solve.solutions import seismic_coefficient_notices

_EXPECTED_EVALUATIONS = 150  # evaluations: for the bar
_MAX_MOTION_POINTS = 2000  # points of a motion in JSON
_POINTS_AFTER_END = 40  # of them on the way to rest after the end of the record
_PGA_RANGE_G = (1e-4, 10.0)  # g
_MAX_DISPLACEMENT_M = 1000.0  # no slope slides so far while it is shaken
_MIN_RECORDS_FOR_PERCENTILES = (
    7  # of fewer, the 16th and 84th percentile lie on the first and the last
)
_SLIDE_AFTER_END = 0.01  # of a displacement, beyond the end of the record


@dataclass(frozen=True)
class Shaken:
    """Sliding displacements in one earthquake record.

    Attributes
    ----------
    record : as it was used; as_recorded_m, reversed_m : displacement with κ, with both polarities
    newmark_m : as recorded with κ = 1, what plain Newmark has; newmark_reversed_m : the same reversed
    after_m : of the larger one, what it slides on after the end of the record
    """

    record: Record
    as_recorded_m: float
    reversed_m: float
    newmark_m: float
    newmark_reversed_m: float
    after_m: float

    @property
    def mean_m(self) -> float:
        """The mean displacement of both polarities, m."""
        return 0.5 * (self.as_recorded_m + self.reversed_m)

    @property
    def larger_m(self) -> float:
        """The larger displacement of both polarities, m."""
        return max(self.as_recorded_m, self.reversed_m)


@dataclass(frozen=True, repr=False)
class Quake(StudyOutcome):
    """Yield coefficients of a design and its displacements in earthquake records.

    Attributes
    ----------
    design : without its own seismic load; toward_deg : where the shaking pushes the block
    yields : by PRE-IE, then by the closed form where there is one
    shaken : record by record
    motion : in the record and polarity that move it most, its columns by name: `a_g` as it pushes the block, 0 after
        its end, `v_m_s` and `d_m` along the sliding, with κ; empty where none moves it
    scale_pga : the peak that all records were scaled to, g
    in_six : in six degrees of freedom, where that was asked for
    """

    name: ClassVar[str] = "quake"
    design: Design
    toward_deg: float | None
    yields: tuple[Yield, ...]
    shaken: tuple[Shaken, ...]
    motion: Mapping[str, Any]
    scale_pga: float | None
    warnings: tuple[Notice, ...] = ()
    in_six: SixDofResponse | None = None

    @property
    def six(self) -> tuple[Shaking, ...]:
        """In six degrees of freedom each record in both polarities; empty where that was not asked for."""
        return () if self.in_six is None else self.in_six.shaken

    @property
    def coefficient(self) -> float | None:
        """k_y by PRE-IE, None where no k up to 2 moves the block."""
        return self.yields[0].coefficient

    @property
    def factor(self) -> float | None:
        """κ by PRE-IE; None where there is none, and displacements are plain Newmark's."""
        return self.yields[0].factor

    @property
    def agree(self) -> bool | None:
        """Whether the methods agree at PRE-IE's k_y on the same assumptions, or have the same; None: not compared.

        What the closed form says nothing of, columns shaken into the slope and joints that dilate, is not compared.
        """
        if len(self.yields) < 2 or self.yields[1].why_not == NO_FORM or dilates(self.design):
            return None
        if self.yields[0].agree is not None and not self.moments_govern:
            return self.yields[0].agree
        pre_ie, closed_form = (method_yield.coefficient for method_yield in self.yields)
        if pre_ie is None or closed_form is None:
            return pre_ie is None and closed_form is None
        if self.moments_govern:
            return None
        return abs(pre_ie - closed_form) <= self.design.analysis.agree_within * max(
            pre_ie, closed_form
        )

    @property
    def moments_govern(self) -> bool:
        """Whether PRE-IE's k_y lies below the closed form's because the block turns."""
        return self.yields[0].why_not.startswith("moments")

    @property
    def exit_code(self) -> int:
        """0 done, 1 what acceptance asks besides moves before (W507), 4 the methods disagree, or no convergence."""
        if self.agree is False or any(shaking.ended == "refused" for shaking in self.six):
            return 4
        return 1 if any(notice.code == "W507" for notice in self.warnings) else 0

    @property
    def charts(self) -> tuple[str, ...]:
        """Acceleration, velocity and displacement."""
        return ("motion",) if self.motion else ()

    @property
    def one_way(self) -> dict[str, Any]:
        """Displacements of the rigid block that slides one way, as `leading`."""
        return _displacement(
            "one_way",
            [record_result.mean_m for record_result in self.shaken],
            [record_result.larger_m for record_result in self.shaken],
        )

    @property
    def leading(self) -> dict[str, Any]:
        """Displacements by the requested `model`: six degrees of freedom, else one-way sliding.

        `median_m`, `p16_m`, `p84_m` over the records of the mean of both polarities, and `largest_m`: None where the
        model has no answer, the percentiles where there are fewer than seven records.
        """
        if self.in_six is None:
            return self.one_way
        means = self.in_six.means_m() if self.in_six.is_settled else []
        return _displacement("six", means, [shaking.slid_m for shaking in self.six])

    def to_dict(self) -> dict[str, Any]:
        """The study as JSON values."""
        return {
            **self.head(self.design),
            "toward_deg": self.toward_deg,
            "scale_pga_g": self.scale_pga,
            "leading": self.leading,
            "beside": None if self.in_six is None else self.one_way,
            "yield": json_of(self.yields),
            "agree": self.agree,
            "moments_govern": self.moments_govern,
            "records": [
                {
                    "name": result.record.name,
                    "samples": len(result.record.times_s),
                    "duration_s": result.record.duration_s,
                    "unit": result.record.unit,
                    "pga_g": result.record.pga_g,
                    "pgv_m_s": result.record.pgv_m_s,
                    "arias_m_s": result.record.arias_m_s,
                    "as_recorded_m": result.as_recorded_m,
                    "reversed_m": result.reversed_m,
                    "mean_m": result.mean_m,
                    "newmark_m": result.newmark_m,
                    "newmark_reversed_m": result.newmark_reversed_m,
                    "after_m": result.after_m,
                }
                for result in self.shaken
            ],
            "six": json_of(self.six) or None,
            "motion": _thinned(self.motion) if self.motion else None,
            "six_pairs": None
            if self.in_six is None
            else {"pairs": self.in_six.pairs, "change": self.in_six.change},
            "six_motion": None if self.in_six is None else _thinned(self.in_six.motion),
            "timing_s": {"total": self.seconds},
            **self.words(),
        }


def _displacement(model: str, means: list[float], largest: list[float]) -> dict[str, Any]:
    low, median, high = (
        np.percentile(means, (16.0, 50.0, 84.0)).tolist() if means else (None, None, None)
    )
    most, has_spread = max(largest) if means else None, len(means) >= _MIN_RECORDS_FOR_PERCENTILES
    spread = {"p16_m": low if has_spread else None, "p84_m": high if has_spread else None}
    return {"model": model, "median_m": median, "largest_m": most, **spread}


def _thinned(motion: Mapping[str, Any]) -> dict[str, Any]:
    """A motion as JSON values; of a long one every k-th sample, k under `every`."""
    stride = max(1, math.ceil(len(motion["t_s"]) / _MAX_MOTION_POINTS))
    columns = {
        name: [float(f"{value:.7g}") for value in column[::stride]]
        for name, column in motion.items()
        if not isinstance(column, str)
    }
    return {"record": motion["record"], "way": motion["way"], "every": stride, **columns}


def _degrees(text: str, option: str) -> float:
    return quantity(text, "angle", option, f"{option} {text}")


@study
def quake(
    design: ADesign,
    records: Annotated[
        Any,
        Argument(
            "Records: CSV of time and acceleration, PEER .AT2, folders of them, or pulses: sine:0.5g,1Hz "
            "rectangular:0.5g,0.3s triangular:0.5g,0.3s",
            "RECORD...",
            many=True,
        ),
    ],
    *,
    toward: Annotated[
        float | None,
        Option(
            "Trend toward which the shaking pushes the block, degrees [the design's, else the way of the slope].",
            _degrees,
        ),
    ] = None,
    scale_pga: Annotated[
        float | None, Option("Peak that every record is scaled to, g.", number_of)
    ] = None,
    unit: Annotated[
        str | None, Option("Unit of files that name none: g, m/s2, cm/s2, gal.")
    ] = None,
    six: Annotated[
        bool,
        Option("In six degrees of freedom too: the block on its springs, which opens and turns."),
    ] = False,
    across: Annotated[
        Any,
        Option(
            "With --six: record of the same earthquake to the right of the first.", metavar="RECORD"
        ),
    ] = None,
    vertical: Annotated[
        Any, Option("With --six: vertical record, up where positive.", metavar="RECORD")
    ] = None,
    jobs: Jobs = 1,
    desk: Workplace = DESK,
) -> Quake:
    """How far a slope slides in earthquakes: yield coefficient by both methods, Newmark displacement, exactly.

    A record pushes the block toward --toward where it is positive; it is used reversed too. Exit codes: 0 done, 1 a
    larger wedge moves before (W507), 4 the methods disagree on the yield coefficient, or PRE-IE or a step of --six did
    not settle.

    Raises
    ------
    DesignError
        E510 to E517 for the records, E307 for a peak, E520 a slope that does not stand, E313 components that do not go
        together, E288 a design that --six has no answer for, E253 a design without a seismic coefficient or a direction
        of it, E524 a displacement of a kilometre, E280 a design without a file.

    Notes
    -----
    In Python `records` may be one or several of: a path, the name of a pulse, a `Record`.

    k_y is the seismic coefficient at which F = 1. While the block slides its acceleration against the ground is
    κ (a - k_y g), in m/s²; κ is the derivative of the net driving force by k in parts of the weight, on a plane
    cos(β - φ) / cos φ. Plain Newmark has κ = 1. A record is linear between samples: velocity (a quadratic) and
    displacement (a cubic) are integrated exactly.

    References
    ----------
    Newmark (1965), Effects of earthquakes on dams and embankments, Géotechnique 15, 139-160.

    Examples
    --------
    >>> import slopekit as sk
    >>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
    >>> found = sk.quake(sk.load(wedge), ["sine:0.5g,1Hz"])
    >>> round(found.coefficient, 4), round(found.factor, 4), round(found.shaken[0].as_recorded_m, 4)
    (0.1962, 1.1057, 0.2649)
    """
    if scale_pga is not None and not _PGA_RANGE_G[0] <= scale_pga <= _PGA_RANGE_G[1]:
        fail(
            "E307",
            f"{desk.named('scale_pga')} is {number(scale_pga)} g, it lies between {_PGA_RANGE_G[0]:g} and "
            f"{_PGA_RANGE_G[1]:g}",
            "",
            "Peaks are in g: 0.3.",
        )
    sources = (
        [records]
        if isinstance(records, str | Record) or not isinstance(records, Sequence)
        else list(records)
    )
    scaled_records = read_records(sources, unit)
    scaled_records = (
        scaled_records
        if scale_pga is None
        else tuple(record.scaled(scale_pga) for record in scaled_records)
    )
    components = [
        None
        if source is None
        else source
        if isinstance(source, Record)
        else read_record(source, unit)
        for source in (across, vertical)
    ]
    if not six and (across is not None or vertical is not None):
        fail(
            "E313",
            f"{desk.named('across')} and {desk.named('vertical')} belong to {desk.named('six')}",
            "",
            "Newmark's block knows the shaking along its slope alone.",
        )
    if scale_pga is not None and (across is not None or vertical is not None):
        fail(
            "E313",
            f"{desk.named('scale_pga')} would scale one of three components",
            "",
            "Scale the records, all three, by the same number.",
        )
    static = static_design(design, toward, desk.named("toward"))
    check_stands(static)
    with desk.bar(
        "evaluations and records", _EXPECTED_EVALUATIONS + (3 if six else 1) * len(scaled_records)
    ) as advance:
        in_six = (
            six_dof_response(static, scaled_records, components[0], components[1], advance)
            if six
            else None
        )
        yields = yields_of(static, checked_crew(jobs), advance)
        shaken, motion = _record_results(static, yields[0], scaled_records, advance)
        outward = way_out(static, yields[0], advance)
    warnings = tuple(dict.fromkeys(_notices(static, yields, shaken, outward, components, in_six)))
    return Quake(
        static, static.seismic.trend_deg, yields, shaken, motion, scale_pga, warnings, in_six
    )


def _record_results(
    static: Design, pre_ie: Yield, records: Sequence[Record], advance: Any
) -> tuple[tuple[Shaken, ...], dict[str, Any]]:
    """Return the displacements in every record with both polarities, and the motion with the largest one."""
    if pre_ie.coefficient is None:
        return tuple(Shaken(record, 0.0, 0.0, 0.0, 0.0, 0.0) for record in records), {}
    limit, factor = pre_ie.coefficient * static.rock.gravity_m_s2, pre_ie.factor or 1.0
    shaken: list[Shaken] = []
    faults = Faults()
    largest_m, motion = 0.0, dict[str, Any]()
    for record in records:
        slides = {
            way: slide(record.times_s, sign * record.accelerations, limit)
            for way, sign in POLARITIES.items()
        }
        newmark_m = [polarity.displacement_m for polarity in slides.values()]
        way = max(slides, key=lambda polarity: slides[polarity].displacement_m)
        shaken.append(
            Shaken(
                record,
                factor * newmark_m[0],
                factor * newmark_m[1],
                newmark_m[0],
                newmark_m[1],
                factor * slides[way].after_m,
            )
        )
        if slides[way].displacement_m > largest_m:
            largest_m = slides[way].displacement_m
            motion = _motion(record, way, slides[way], limit, factor, static.rock.gravity_m_s2)
        if shaken[-1].larger_m > _MAX_DISPLACEMENT_M:
            faults.append(_displacement_fault(shaken[-1], pre_ie.coefficient))
        advance(1)
    faults.refuse()
    return tuple(shaken), motion


def _displacement_fault(result: Shaken, coefficient: float) -> Fault:
    """Return E524 for a displacement that no earthquake causes."""
    record = result.record
    return Fault(
        "E524",
        f"{record.name}: a displacement of {result.larger_m * 1e-3:.3g} km is none of an earthquake, at k_y "
        f"{shown_k(coefficient)} in {record.duration_s:.4g} s with a peak velocity of the ground of "
        f"{record.pgv_m_s:.3g} m/s (the highest measured are about 4)",
        record.name,
        "Write times in s, correct a baseline that drifts. At a k_y next to 0 the slope hardly stands.",
    )


def _motion(
    record: Record, way: str, record_slide: RecordSlide, limit: float, factor: float, gravity: float
) -> dict[str, Any]:
    """The motion in a record, until the block is at rest."""
    t, a, v, d = (
        record.times_s,
        POLARITIES[way] * record.accelerations,
        record_slide.velocity,
        record_slide.displacement,
    )
    if v[-1] > 0.0:
        x = np.linspace(0.0, v[-1] / limit, _POINTS_AFTER_END + 1)[1:]
        t, a = np.concatenate([t, t[-1] + x]), np.concatenate([a, np.zeros(_POINTS_AFTER_END)])
        d = np.concatenate([d, d[-1] + x * (v[-1] - 0.5 * limit * x)])
        v = np.concatenate([v, v[-1] - limit * x])
    columns = {"t_s": t, "a_g": a / gravity, "v_m_s": factor * v, "d_m": factor * d}
    return {"record": record.name, "way": way, **columns}


def _notices(
    static: Design,
    yields: Sequence[Yield],
    shaken: Sequence[Shaken],
    outward: tuple[float, float] | None,
    components: Sequence[Record | None],
    six: SixDofResponse | None,
) -> Iterator[Notice]:
    """Yield what is to be known: of the direction, of the records, of κ, of the methods, of six degrees of freedom.

    Parameters
    ----------
    outward : the way out of the slope and a coefficient that moves it there, where the shaking pushes into it
    """
    pre_ie, trend = yields[0], static.seismic.trend_deg
    share = 1.0 if static.section_share is None else static.section_share
    if outward is not None:
        toward, back = (f"{number(way):0>3}" for way in (opposite(outward[0]), outward[0]))
        message = (
            f"toward {toward} pushes into the slope: k_y is {shown_k(pre_ie.coefficient)}; "
            f"toward {back} pushes out"
        )
        yield Notice(
            "W328", f"{message} of it, k_y is below {shown_k(outward[1])}: --toward {back}"
        )
    elif trend is not None and abs(share) <= 1.0 - 1e-6:
        consequence = "what acts along the face is left out, and moves a slope too: k_y is too high, or none is found"
        direction = (
            f"toward {number(trend):0>3} is off the section, "
            f"which knows {share * 100:.4g} % of the shaking alone"
        )
        yield Notice("W323", f"{direction}: {consequence}")
    for record in (*components, *(result.record for result in shaken)):
        yield from () if record is None else record.notices
    if pre_ie.coefficient is not None and pre_ie.factor is None:
        message = f"no factor: {pre_ie.why_not}; displacements are plain Newmark's, with 1, and may be too small"
        yield Notice("W462", message)
    if pre_ie.first_factor is not None:
        message = f"contacts change just above k_y: the factor is {pre_ie.first_factor:.4g} right at it and"
        message += f" {pre_ie.factor:.4g} a hundredth above, which is taken; further up more blocks may join in"
        yield Notice("W462", message)
    yield from pre_ie.notes
    if all(note.code != "W507" for note in pre_ie.notes):  # of a jump, or where nothing moves it
        k = MOST_K if pre_ie.coefficient is None else pre_ie.coefficient
        whole_wedge = kind_of(static).without_basal(with_values(static, {KEY: k}))
        yield from whole_wedge_notice(whole_wedge, 1.0, f"at k = {shown_k(k)}")
    if pre_ie.coefficient is None:
        yield Notice("W462", f"{pre_ie.why_not}: no displacement in any record")
    sliding_records = [
        result.record.name
        for result in shaken
        if result.after_m > _SLIDE_AFTER_END * result.larger_m and not result.record.is_pulse
    ]
    if sliding_records:
        listed = ", ".join(sliding_records[:6]) + (", ..." if len(sliding_records) > 6 else "")
        message = (
            f"the block still slides when the record ends ({listed}): what it slides "
            "on without shaking is counted"
        )
        yield Notice("W464", f"{message}; a record cut off lacks what came after")
    if len(yields) > 1 and pre_ie.why_not.startswith("moments"):
        message = (
            f"moments govern: PRE-IE has k_y {shown_k(pre_ie.coefficient)}, the closed "
            "form, which knows no moments,"
        )
        yield Notice("W353", f"{message} {shown_k(yields[1].coefficient)}")
    elif pre_ie.jumps:
        message = f"moments govern: at k_y {shown_k(pre_ie.coefficient)} a joint opens and strength is gone"
        yield Notice("W353", message)
    yield from seismic_coefficient_notices(KEY, pre_ie.coefficient) if outward is None else ()
    yield from new_notices(notices_of_inputs(static, [KEY]), pre_ie.notes)
    yield from peak_strength_notice(static, "displacements one way are those")
    yield from () if six is None else _six_notices(six)


def _six_notices(six: SixDofResponse) -> Iterator[Notice]:
    """Yield W312 where the displacement depends on the node pairs, W464 for records that did not end at rest."""
    if (six.change or 0.0) > SETTLED_CHANGE:
        yield Notice(
            "W312",
            f"the last refinement of the node pairs, to {six.pairs}, still moved what slides by {six.percent} %: where "
            "joints open it depends on them",
        )
    ends = {
        "refused": "a step did not settle however short, nothing of it was taken",
        "moves": "it still moves",
    }
    for shaking in six.shaken:
        if shaking.ended in ends:
            yield Notice(
                "W464",
                f"{shaking.record}, {shaking.way}, in six degrees of freedom: "
                f"at {shaking.until_s:.4g} s {ends[shaking.ended]}",
            )
