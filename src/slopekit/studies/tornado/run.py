"""Rank the numbers of a design by their effect on its factor of safety, changed one at a time.

>>> import slopekit as sk
>>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
>>> study = tornado(sk.load(wedge), closed_form=True)
>>> study.bars[0].key.path, study.bars[0].low, study.bars[0].high
('strength.joints.phi', 18.0, 22.0)
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar

import numpy as np

from slopekit.core.codec import json_of
from slopekit.core.errors import Faults, Notice
from slopekit.design.common import Design
from slopekit.design.reading.nodes import NOTHING
from slopekit.design.scatter.distributions import Distribution
from slopekit.kinds import notices_of_inputs, peak_strength_notice
from slopekit.studies.evaluation.rows import Rows, chosen_methods, evaluated
from slopekit.studies.keys import Key, key_of, keys_of, values_of
from slopekit.studies.points import (
    Method,
    Point,
    code_without_blocks,
    evaluated_methods,
    factor_at,
    notices_of_points,
)
from slopekit.studies.protocol import (
    DESK,
    ADesign,
    ClosedFormAlone,
    Jobs,
    Scheduler,
    StudyOutcome,
    Workplace,
    study,
)
from slopekit.studies.ranges import SearchRange, parse_within
from slopekit.studies.running import checked_crew
from slopekit.studies.sweep.run import KEYS

ANGLE, FRACTION, FILL, TAIL = 2.0, 0.10, 0.1, 0.05
RULE = (
    f"angles ±{ANGLE:g}°, how full the joints are ±{FILL:g}, what scatters from its {TAIL * 100:g} % to its "
    f"{(1 - TAIL) * 100:g} % quantile, all else ±{FRACTION * 100:g} %, one at a time"
)
_NORMAL_TAIL = 1.6448536269514722  # standard deviations: 95 % quantile of the normal distribution
_CONSTANTS = ("rock.gravity", "water.unit_weight")
_NO_CHANGE = 1e-9
_NOT_COMPARED_CODE = (
    "W310"  # the closed form is not compared: no notice where only the ends of the study are so
)


@dataclass(frozen=True)
class TornadoBar:
    """One number of the design, its two ends, and the factors there.

    Attributes
    ----------
    low, high : its ends; how : given, quantiles, or by the rule
    at_low, at_high : the points there
    swings : by method how far the factor moves between the ends and the design itself; inf where nothing drives it at
        an end, None where an end has no answer: that is no swing
    """

    key: Key
    low: float
    high: float
    how: str
    at_low: Point
    at_high: Point
    swings: Mapping[Method, float | None]


@dataclass(frozen=True, repr=False)
class Tornado(StudyOutcome):
    """The outcome of a tornado study: the numbers of a design ranked by their effect on the factor.

    Attributes
    ----------
    base : the point of the design as it is
    bars : the one with the largest swing first, by the governing method
    left_out : (key, why) of numbers that were not changed
    of_inputs : notices on the design: means taken by all bars but their own, implausible inputs
    """

    name: ClassVar[str] = "tornado"
    charts: ClassVar[tuple[str, ...]] = ("tornado",)
    design: Design
    base: Point
    bars: tuple[TornadoBar, ...]
    left_out: tuple[tuple[str, str], ...]
    methods: str
    of_inputs: tuple[Notice, ...] = ()

    @property
    def asked(self) -> tuple[Method, ...]:
        """The methods evaluated, the governing one first."""
        return evaluated_methods(self.methods, [self.base])

    @property
    def points(self) -> list[Point]:
        """The points of the design as it is and of every end."""
        return [self.base, *(point for bar in self.bars for point in (bar.at_low, bar.at_high))]

    @property
    def disagree(self) -> int:
        """The number of points at which the methods disagree or PRE-IE did not converge."""
        return sum(point.is_in_doubt for point in self.points)

    @property
    def exit_code(self) -> int:
        """0 done, 4 the methods disagree at a point, 3 the design itself forms no block, 2 it is bad input."""
        if self.base.factors is None:
            return code_without_blocks([self.base])
        return 4 if self.disagree else 0

    @property
    def warnings(self) -> tuple[Notice, ...]:
        """The notices of the study: ends without a factor, those of single runs, and those on the inputs."""
        level, method = self.design.accepted_fos or 1.0, self.asked[0]
        compared = all(note.code != _NOT_COMPARED_CODE for note in self.base.notes)
        notices = notices_of_points(
            self.points, self._place_in_words, method, [level], self.of_inputs
        )
        return tuple(note for note in notices if not (compared and note.code == _NOT_COMPARED_CODE))

    def _place_in_words(self, number: int) -> str:
        """Return the key and the value of a point in words."""
        if number == 0:
            return "as it is"
        bar = self.bars[(number - 1) // 2]
        return (
            f"at {bar.key.path} = {bar.key.value_text(bar.high if number % 2 == 0 else bar.low, 6)}"
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the study as JSON values; an infinite swing, and one of an end without a factor, is null."""
        return {
            **self.head(self.design),
            "methods": self.methods,
            "rule": RULE,
            "base": self.base.to_dict(),
            "bars": [
                {
                    "key": bar.key.path,
                    "unit": bar.key.unit,
                    "now": bar.key.value,
                    "low": bar.low,
                    "high": bar.high,
                    "shown": [bar.key.value_text(bar.low, 5), bar.key.value_text(bar.high, 5)],
                    "how": bar.how,
                    "at_low": bar.at_low.to_dict(),
                    "at_high": bar.at_high.to_dict(),
                    "swing": json_of(bar.swings),
                }
                for bar in self.bars
            ],
            "left_out": [{"key": path, "why": reason} for path, reason in self.left_out],
            "disagree": self.disagree,
            "timing_s": {"total": self.seconds},
            **self.words(),
        }


@study
def tornado(
    design: ADesign,
    ranges: Annotated[Mapping[str, SearchRange] | None, KEYS] = None,
    *,
    closed_form: ClosedFormAlone = False,
    jobs: Jobs = 1,
    scheduler: Scheduler = None,
    desk: Workplace = DESK,
) -> Tornado:
    """Every number of the design, one at a time.

    Each goes from one end to the other, `ranges` or by `RULE`; they are ranked by what they do.

    Raises
    ------
    DesignError
        E280, E310 and E311 for a key, E312 for its range, E313 for what does not go together.

    Notes
    -----
    The swing of a number is how far F(high) and F(low) lie apart with all others as they are: one at a time, which sees
    no interaction. What moves the factor up and down again between its ends has a small swing all the same: `sweep` it.

    Examples
    --------
    >>> import slopekit as sk
    >>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
    >>> first = sk.tornado(sk.load(wedge)).bars[0]
    >>> first.key.path, first.how, round(first.swings["pre_ie"], 4)
    ('strength.joints.phi', '±2°', 0.2438)
    """
    crew = checked_crew(jobs, scheduler)
    methods = chosen_methods(design, closed_form)
    ranges_by_path, faults = dict[str, tuple[Key, tuple[float, float]]](), Faults()
    for path, text in (ranges or {}).items():
        with faults.collecting():
            key = key_of(design, path)
            ranges_by_path[key.path] = key, parse_within(key, text)
    faults.refuse()
    chosen: list[tuple[Key, float, float, str]] = []
    left_out: list[tuple[str, str]] = []
    for key in keys_of(design):
        if key.path in ranges_by_path:
            continue
        ends = ends_of(key)
        reason = _reason_left_out(design, key) or (
            "" if ends is not None else "nothing now: give it a range, KEY=lo:hi"
        )
        if reason:
            left_out += [(key.path, reason)] if reason != _SILENT else []
        elif ends is not None:
            chosen.append((key, *ends))
    chosen += [(key, low, high, "given") for key, (low, high) in ranges_by_path.values()]
    tasks: list[dict[str, object]] = [{}]
    tasks += [
        values_of(design, [key], [value]) for key, low, high, _ in chosen for value in (low, high)
    ]
    points = evaluated(
        Rows(design, tasks, keeps_bolts=True), "tornado", crew, desk, methods != "closed-form"
    ).points
    input_notices = (*notices_of_inputs(design), *peak_strength_notice(design, "factors are those"))
    study = Tornado(design, points[0], (), tuple(left_out), methods, of_inputs=input_notices)
    bars = [
        _bar(study, chosen_range, points[1 + 2 * k], points[2 + 2 * k])
        for k, chosen_range in enumerate(chosen)
    ]
    first = study.asked[0]
    bars.sort(
        key=lambda bar: (bar.swings[first] is None, -(bar.swings[first] or 0.0), bar.key.path)
    )
    return replace(study, bars=tuple(bars))


def ends_of(key: Key) -> tuple[float, float, str] | None:
    """Return the two ends of a number by `RULE`, and the rule in words; None where there is nothing to change.

    >>> ends_of(Key("strength.weak.phi", "angle", 20.0, 0.0, 89.99))
    (18.0, 22.0, '±2°')
    """
    if key.scatters is not None:
        return (*_quantiles(key), f"{TAIL * 100:g} % to {(1 - TAIL) * 100:g} %")
    value = key.value
    if value is None:
        return None
    if key.kind == "angle":
        low, high = value - ANGLE, value + ANGLE
        if key.period is not None:
            return low, high, f"±{ANGLE:g}°"
        return max(low, key.low), min(high, key.high), f"±{ANGLE:g}°"
    if not value:
        return None
    step = FILL if key.path.endswith(".fill") else abs(value) * FRACTION
    rule = f"±{FILL:g}" if key.path.endswith(".fill") else f"±{FRACTION * 100:g} %"
    return max(value - step, key.low), min(value + step, key.high), rule


_SILENT = "-"  # left out without a notice: another key stands for it


def _reason_left_out(design: Design, key: Key) -> str:
    """Return the reason why a number is left out, empty where it is changed."""
    parent = key.path.rpartition(".")[0]
    if any(variable.path == parent for variable in design.variables) and key.scatters is None:
        return _SILENT  # a part of a distribution that is changed as a whole
    if key.role == "coordinate":
        return "a coordinate"
    if key.role in ("setting", "scatter") or (key.path in _CONSTANTS and not key.given):
        return _SILENT
    if not key.given and key.value and not _counts_by_default(design, key):
        return _SILENT
    return "not given: give it a range, KEY=lo:hi" if not key.given and not key.value else ""


def _counts_by_default(design: Design, key: Key) -> bool:
    """Return whether the default of a key is a number of the slope: an example value that a wedge takes."""
    paper_keys = design.PAPER_KEYS
    if paper_keys and key.path in ("rock.density", "rock.unit_weight"):
        rock = design.source.root.get("rock") if design.source is not None else NOTHING
        says = rock.get("density") or rock.get("unit_weight")
        return key.path == "rock.density" and not says
    return key.path.startswith(paper_keys)


def _quantiles(key: Key) -> tuple[float, float]:
    distribution = key.scatters
    if isinstance(distribution, Distribution):
        from slopekit.studies.marginals import marginal

        of_tail, tail = marginal(distribution).of_tail, np.array([TAIL])
        low, high = float(of_tail(tail.copy(), -1.0)[0]), float(of_tail(tail.copy(), 1.0)[0])
        return (low, high) if key.period is not None else (max(low, key.low), min(high, key.high))
    assert distribution is not None
    assert key.value is not None
    # of a Fisher distribution about its mean each angle scatters by 1/√k radians across the pole (Fisher 1953)
    reach = math.degrees(_NORMAL_TAIL / math.sqrt(distribution.k))
    if key.period is not None:
        dip_deg = distribution.mean.dip_deg if hasattr(distribution.mean, "dip_deg") else 90.0
        sine_of_dip = math.sin(math.radians(dip_deg)) if dip_deg else 0.0
        reach = min(reach / sine_of_dip, 180.0) if sine_of_dip else 180.0
        return key.value - reach, key.value + reach
    return max(key.value - reach, key.low), min(key.value + reach, key.high)


def _bar(
    study: Tornado, chosen: tuple[Key, float, float, str], at_low: Point, at_high: Point
) -> TornadoBar:
    key, low, high, rule = chosen
    swings = {method: _swing([study.base, at_low, at_high], method) for method in study.asked}
    return TornadoBar(key, low, high, rule, at_low, at_high, swings)


def _swing(points: Sequence[Point], method: Method) -> float | None:
    """Return the greatest less the least factor of points; None where one of them has no factor."""
    factors = [factor for point in points if (factor := factor_at(point, method)) is not None]
    if len(factors) < len(points):
        return None
    if math.isinf(max(factors)) and math.isinf(min(factors)):
        return 0.0
    swing = max(factors) - min(factors)
    return 0.0 if swing <= _NO_CHANGE * max(factors) and math.isfinite(swing) else swing
