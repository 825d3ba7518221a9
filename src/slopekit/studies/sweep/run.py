"""Evaluate a design at many values of one or two of its numbers, by both methods; no point is dropped.

>>> import slopekit as sk
>>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
>>> swept = sweep(sk.load(wedge), {"slope.face.dip": [60, 80]}, closed_form=True)
>>> [round(point.factors.closed_form, 4) for point in swept.points]
[1.5574, 1.4776]
"""

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product
from typing import Annotated, Any, ClassVar

from slopekit.core.codec import json_of
from slopekit.core.errors import Faults, Notice, fail
from slopekit.core.orientation import number
from slopekit.core.sheet import Column
from slopekit.design.common import Design
from slopekit.design.parts import ON_FACTOR
from slopekit.kinds import notices_of_inputs, peak_strength_notice
from slopekit.studies.evaluation.columns import ColumnRows
from slopekit.studies.evaluation.rows import chosen_methods, evaluated
from slopekit.studies.keys import Key, key_of
from slopekit.studies.points import (
    Line,
    Method,
    Point,
    checked_target,
    code_without_blocks,
    evaluated_methods,
    factor_at,
    governing_factor,
    lines_of,
    notices_of_points,
    rules_left_out,
    status_of,
)
from slopekit.studies.protocol import (
    DESK,
    ADesign,
    Argument,
    ClosedFormAlone,
    Jobs,
    Option,
    Scheduler,
    StudyOutcome,
    Workplace,
    number_of,
    study,
)
from slopekit.studies.ranges import MOST, how_written, parse_values
from slopekit.studies.running import checked_crew

_LEVEL_RULES = (
    *ON_FACTOR,
    "fos.closed_form",
)  # acceptance rules on a factor, whose crossings are sought


@dataclass(frozen=True, repr=False)
class Sweep(StudyOutcome):
    """The outcome of a sweep: a design at many values of one or two of its numbers.

    Attributes
    ----------
    keys : the one or two numbers that change; values : of each key
    points : for each value of the second key, those of the first
    methods : both, or closed-form
    levels : factors of safety whose crossings are sought: (level, words)
    of_inputs : notices on the keys and the design: means taken, implausible inputs
    """

    name: ClassVar[str] = "sweep"
    design: Design
    keys: tuple[Key, ...]
    values: tuple[tuple[float, ...], ...]
    points: tuple[Point, ...]
    methods: str
    levels: tuple[tuple[float, str], ...]
    of_inputs: tuple[Notice, ...] = ()

    @property
    def charts(self) -> tuple[str, ...]:
        """The name of the chart: a curve of one key, contours of two."""
        return ("curve" if len(self.keys) == 1 else "contour",)

    @property
    def places(self) -> list[tuple[float, ...]]:
        """The values of the keys at each point, the first key's first."""
        return [values[::-1] for values in product(*self.values[::-1])]

    @property
    def asked(self) -> tuple[Method, ...]:
        """The methods evaluated, the governing one first."""
        return evaluated_methods(self.methods, self.points)

    def status(self, point: Point) -> str:
        """Return the status of a point by the governing method, or the code of why there is no block."""
        return status_of(point, self.asked[0])

    def lines(self) -> list[Line]:
        """Return, for each value of the second key (None without one), the points in rising order of the first."""
        return lines_of(self.points, *self.values)

    @property
    def margin(self) -> float | None:
        """The least factor of safety of all points, None where there is none."""
        return min(self._factors, default=None)

    @property
    def largest(self) -> float | None:
        """The largest factor of safety of all points, None where there is none."""
        return max(self._factors, default=None)

    @property
    def _factors(self) -> list[float]:
        lowest_factors = (governing_factor(point, self.asked[0]) for point in self.points)
        return [factor for factor in lowest_factors if factor is not None]

    def case_columns(self) -> list[Column[Any]]:
        """Return the columns of the load case table: the least and the largest factor."""
        return [
            Column("least FoS", "margin", "fos_least", show=".4f", width=12),
            Column("largest FoS", "largest", "fos_largest", show=".4f", width=14),
        ]

    @property
    def changes(self) -> list[dict[str, Any]]:
        """Changes of status between neighbouring values of the first key; `line`: the value of the second, or None."""
        return [
            {
                "line": line,
                "between": (a, b),
                "statuses": (self.status(lower_point), self.status(upper_point)),
            }
            for line, points in self.lines()
            for (a, lower_point), (b, upper_point) in pairwise(points)
            if self.status(lower_point) != self.status(upper_point)
        ]

    @property
    def critical(self) -> list[dict[str, Any]]:
        """Crossings of the levels by the factors, each between two neighbouring values of the first key.

        `fos`, `what`: the level, and its words; `line` as in `changes`; `between`: the neighbours; `at`: the value by
        linear interpolation, None where a factor is not finite; `how`: interpolated, at a point, across a change of
        status, or to where there is no number.
        """
        return [
            crossing
            for (level, description), method in product(self.levels, self.asked)
            for line, points in self.lines()
            for crossing in self._level_crossings(level, description, method, line, points)
        ]

    def _level_crossings(
        self,
        level: float,
        description: str,
        method: Method,
        line: float | None,
        points: list[tuple[float, Point]],
    ) -> Iterator[dict[str, Any]]:
        record = {"fos": level, "what": description, "method": method, "line": line}
        for (a, lower_point), (b, upper_point) in pairwise(points):
            low, high = factor_at(lower_point, method), factor_at(upper_point, method)
            if (
                low is None
                or high is None
                or low == level
                or not min(low, high) < level <= max(low, high)
            ):
                continue
            value, basis = None, "to where there is no number"
            if high == level:
                value, basis = b, "at a point"
            elif math.isfinite(low + high) and low > 0.0 and high > 0.0:
                value = a + (b - a) * (level - low) / (high - low)
                basis = (
                    "interpolated"
                    if self.status(lower_point) == self.status(upper_point)
                    else "across a change of status"
                )
            yield record | {"between": (a, b), "at": value, "how": basis}
        first, point = points[0]
        if factor_at(point, method) == level:
            yield record | {"between": (first, first), "at": first, "how": "at a point"}

    @property
    def counts(self) -> dict[str, int]:
        """The number of points of each status, or of each code where there is no block, the most frequent first."""
        return dict(Counter(self.status(point) for point in self.points).most_common())

    @property
    def disagree(self) -> int:
        """The number of points at which the methods disagree or PRE-IE did not converge."""
        return sum(point.is_in_doubt for point in self.points)

    @property
    def exit_code(self) -> int:
        """0 done, 4 the methods disagree at a point, 3 no point forms a block, 2 every point is bad input."""
        if self.disagree:
            return 4
        if any(point.factors is not None for point in self.points):
            return 0
        return code_without_blocks(self.points)

    @property
    def warnings(self) -> tuple[Notice, ...]:
        """The notices of the sweep: points without a factor, those of single runs, and those on the inputs."""
        levels = [level for level, _ in self.levels]
        return tuple(
            notices_of_points(
                self.points, self.place_in_words, self.asked[0], levels, self.of_inputs
            )
        )

    def place_in_words(self, number: int) -> str:
        """Return the values of the keys at a point in words."""
        place = zip(self.keys, self.places[number], strict=True)
        return "at " + ", ".join(f"{key.path} = {key.value_text(value, 6)}" for key, value in place)

    def to_dict(self) -> dict[str, Any]:
        """Return the sweep as JSON values."""
        return {
            **self.head(self.design),
            "keys": [
                {"key": key.path, "unit": key.unit, "now": key.value, "values": list(values)}
                for key, values in zip(self.keys, self.values, strict=True)
            ],
            "methods": self.methods,
            "levels": [{"fos": level, "what": description} for level, description in self.levels],
            "points": [
                {"values": list(place)} | point.to_dict()
                for place, point in zip(self.places, self.points, strict=True)
            ],
            "counts": self.counts,
            "disagree": self.disagree,
            "changes": json_of(self.changes),
            "critical": json_of(self.critical),
            "timing_s": {"total": self.seconds},
            **self.words(),
        }


def read_key_arguments(texts: Sequence[str], _argument: str) -> dict[str, str]:
    """Return the paths of `KEY=VALUES` arguments with the texts of their values."""
    faults, by_path = Faults(), dict[str, str]()
    for text in texts:
        path, equals, values = text.partition("=")
        path = path.strip()
        if not equals:
            faults.add("E312", f"{path} has no values", text, how_written(path))
        elif path in by_path:
            faults.add("E313", f"{path} is given twice", text, "Give it once.")
        by_path[path] = values
    faults.refuse()
    return by_path


#: `KEY=VALUES ...` of a command.
KEYS = Argument(
    "KEY=from:to:how many, KEY=from:to:+step, KEY=a,b,c; one key or two. With --tornado KEY=lo:hi.",
    "KEY=VALUES",
    read_key_arguments,
    many=True,
    called="keys",
)


@study
def sweep(
    design: ADesign,
    keys: Annotated[Mapping[str, Any], KEYS],
    *,
    closed_form: ClosedFormAlone = False,
    fos: Annotated[
        float | None, Option("A factor of safety: where it is passed is said.", number_of)
    ] = None,
    jobs: Jobs = 1,
    scheduler: Scheduler = None,
    desk: Workplace = DESK,
) -> Sweep:
    """A design at many values of one number (a curve) or of two (a grid), or of each in turn (--tornado).

    Points that form no block are kept, with their code and reason. Exit codes: 0 done, 3 no point forms a block, 4 the
    methods disagree at a point, or no convergence.

    Raises
    ------
    DesignError
        E280 a design without a file, E310 and E311 for a key, E312 for its values, E313 for what does not go together,
        E314 for the target, and those of `run_all`.

    Notes
    -----
    `points` are in the order of the values, of two keys those of the first within each of the second: reshaped to
    `shape` they are the grid. Every point is a design of its own, cut and solved anew.

    Examples
    --------
    >>> import slopekit as sk
    >>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
    >>> swept = sk.sweep(sk.load(wedge), {"water.fill": [0, 1]})
    >>> [round(point.factors.limit, 4) for point in swept.points]
    [1.5574, 1.006]
    """
    crew = checked_crew(jobs, scheduler)
    check_key_count(keys)
    methods = chosen_methods(design, closed_form)
    faults, axes, input_notices = Faults(), list[tuple[Key, tuple[float, ...]]](), list[Notice]()
    for path, text in keys.items():
        with faults.collecting():
            key = key_of(design, path)
            axes.append((key, parse_values(key, text)))
    count = math.prod(len(values) for _, values in axes)
    if count > MOST:
        faults.add("E312", f"{count} points are too many for one sweep (most: {MOST})")
    faults.refuse()
    if len({key.path for key, _ in axes}) < len(axes):
        fail("E313", f"{axes[0][0].path} is given twice", "", "Name two different keys.")
    swept_keys, values = (
        tuple(key for key, _ in axes),
        tuple(axis_values for _, axis_values in axes),
    )
    input_notices += notices_of_inputs(design, [key.path for key in swept_keys])
    input_notices += (
        *peak_strength_notice(design, "factors are those"),
        *rules_left_out(design, _LEVEL_RULES),
    )
    swept = Sweep(
        design,
        swept_keys,
        values,
        (),
        methods,
        levels_of(design, fos),
        of_inputs=tuple(input_notices),
    )
    pre_ie = methods != "closed-form"
    outcomes = evaluated(
        ColumnRows(design, swept_keys, swept.places, pre_ie), "sweep", crew, desk, pre_ie
    )
    return replace(swept, points=tuple(outcomes.points))


def check_key_count(keys: Mapping[str, object]) -> None:
    """Refuse no keys, text in their place, or more than two: E313."""
    if isinstance(keys, str):
        fail(
            "E313",
            "keys are a text, a mapping of each key to its values is needed",
            keys,
            "Write {'slope.face.dip': '60:80:5'}, or {'slope.face.dip': [60, 70, 80]}.",
        )
    if not keys:
        fail("E313", "no key is given", "", "Write KEY=60:80:5, for example slope.face.dip=60:80:5")
    if len(keys) > 2:
        fail(
            "E313",
            f"{len(keys)} keys are given, a sweep takes one or two",
            ", ".join(keys),
            "For many keys one at a time: --tornado",
        )


def levels_of(design: Design, fos: float | None) -> tuple[tuple[float, str], ...]:
    """Return the levels whose crossings are sought, in order: 1, those of the acceptance rules, and the target.

    Raises
    ------
    DesignError
        E314 for a target that is none.
    """
    levels = {1.0: "FoS 1"}
    for rule in design.rules:
        if rule.name in _LEVEL_RULES:
            levels.setdefault(rule.value, f"acceptance, {rule}")
    if fos is not None:
        checked_target(fos, "Write --fos 1.5")
        levels.setdefault(fos, f"target, FoS {number(fos)}")
    return tuple(levels.items())
