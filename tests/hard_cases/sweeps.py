"""Sweeps of one parameter into the hard cases, and what slopekit gives along them."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import slopekit as sk
from slopekit.result import Result
from tests.hard_cases.cases import Case
from tests.hard_cases.exact import Exact

#: Relative errors that a cause explains.
ROUNDING = (
    1e-9,
    "double precision; the condition of thin and near-parallel wedges costs up to seven of sixteen digits",
)
PASSES = 2e-6, "one block: a path that has settled changes by no more than 1e-6"
SECTION = (
    1e-9,
    "sections of many blocks: limit states exact for their contact modes; slender blocks cost digits",
)
SPACE = 1e-5, "benches: in space the path ends where a step changes the limit by less than 1e-6"
MESH = 1e-5, "curved surface: triangles with an edge of a twentieth of its size"
LAST_DIGITS = (
    2e-15,
    "coordinates are floats: rounding of the corners, and of the sum with the offset",
)
#: A load that needs less than a millionth of the strength counts as none (`no_driving_force`).
NO_DRIVE = 1e6


@dataclass(frozen=True)
class Sweep:
    """One parameter, swept.

    Attributes
    ----------
    name : what is swept, of which kind; label : the parameter with its unit
    at : the case (design and exact answer) at a value; values : those of the full curve
    tolerance : relative error and its cause
    picture : sweeps with the same one share a chart
    quantity : what is compared: factor, volume or coordinates
    statuses : beside that of the reference, which knows no moments
    tested : how many of the values the tests take; left_out : of the last ones, which take seconds each
    """

    name: str
    label: str
    at: Callable[[float], Case]
    values: tuple[float, ...]
    tolerance: tuple[float, str]
    picture: str
    quantity: str = "factor"
    logarithmic: bool = True
    statuses: tuple[str, ...] = ()
    tested: int = 2
    left_out: int = 0

    @property
    def kind(self) -> str:
        """The kind of design."""
        return self.at(self.values[0]).kind

    @property
    def thinned(self) -> tuple[float, ...]:
        """The values that the tests take: both ends and evenly between."""
        last, many = len(self.values) - 1 - self.left_out, min(self.tested, len(self.values))
        return tuple(self.values[round(k * last / (many - 1))] for k in range(many))


@dataclass(frozen=True)
class Point:
    """What slopekit and the reference give at one value of a sweep.

    Attributes
    ----------
    error : relative, None where neither has a number; of the forces alone where moments govern
    flags : codes of the notices; refused : code of the message instead of a result
    below : how far moments bring the limit below the forces alone, 1 where no number is left; None where they do not
    """

    value: float
    status: str
    exact_status: str
    limit: float | None
    exact: float | None
    forces_only: float | None
    error: float | None
    below: float | None
    all_pairs: float | None
    agree: bool | None
    flags: tuple[str, ...]
    refused: str
    seconds: float


def analyse(case: Case) -> Result:
    """Run a case."""
    return sk.wedge(**case.design) if case.kind == "wedge" else sk.run(case.design)


def point(case: Case, value: float = 0.0, quantity: str = "factor") -> Point:
    """Run a case and hold it against its exact answer."""
    answer = case.answer()
    wanted = answer.as_float
    began = time.perf_counter()
    try:
        result = analyse(case)
    except sk.SlopekitError as refused:
        return Point(
            value,
            "",
            answer.status,
            None,
            wanted,
            None,
            None,
            None,
            None,
            None,
            (),
            refused.faults[0].code,
            time.perf_counter() - began,
        )
    seconds = time.perf_counter() - began
    limit, alone = result.fos.limit, result.comparisons.forces_only or None
    compared, below = limit, None
    if result.moments_govern and answer.factor is not None:
        compared, below = alone, 1.0 if limit is None or alone is None else 1.0 - limit / alone
    error = None if compared is None or wanted is None else abs(compared / wanted - 1.0)
    if quantity == "volume":
        error = abs(float(result.geometry.volume_m3 / answer.volume - 1))
    elif quantity == "coordinates":
        error = misplaced(result, answer, case.shift)
    return Point(
        value,
        result.status,
        answer.status,
        limit,
        wanted,
        alone,
        error,
        below,
        result.fos.all_pairs_failed,
        result.agree,
        tuple(dict.fromkeys(notice.code for notice in result.warnings)),
        "",
        seconds,
    )


def misplaced(result: Result, answer: Exact, shift: Sequence[float]) -> float:
    """Largest error of a wedge's corners in parts of the largest coordinate."""
    corners = result.to_dict()["geometry"]["corners_m"]
    worst, largest = 0.0, 0.0
    for name, corner in zip(("toe", "crest_J1", "crest_J2", "back"), answer.corners, strict=True):
        for x, local, moved in zip(corners[name], corner, shift, strict=True):
            worst = max(worst, abs(float(local + moved - float(x))))
            largest = max(largest, abs(float(x)))
    return worst / largest


def verdict(sweep: Sweep, found: Point) -> str:
    """What a point is worth, in one of four ways.

    "agrees": within the tolerance of the reference, or no number where there is none. "moments govern": the limit lies
    below the forces alone and has no reference; the number of the forces alone agrees. "said": no number, and it says
    so. "wrong: ...": why.
    """
    if found.refused:
        return (
            f"wrong: our own fault, {found.refused}" if found.refused.startswith("E5") else "said"
        )
    if found.status == "not_converged":
        return "said"
    if sweep.quantity != "factor":
        return _within(sweep, found) or "agrees"
    if found.exact is None:
        if found.limit is not None:
            return f"wrong: {found.limit:.6g} for no number"
        same = found.status in (found.exact_status, *sweep.statuses)
        return "agrees" if same else f"wrong: {found.status} for {found.exact_status}"
    if found.status == "no_driving_force" and found.exact > NO_DRIVE:
        return "said"
    if found.agree is False:
        return "wrong: the two methods disagree"
    if found.below is not None:
        if found.forces_only is None or (found.limit or 0.0) > found.exact * (
            1.0 + sweep.tolerance[0]
        ):
            return f"wrong: {found.limit} where forces alone give {found.exact:.6g}"
        return _within(sweep, found) or "moments govern"
    if found.limit is None:
        return f"wrong: {found.status}, no number for {found.exact:.6g}"
    if found.status not in (found.exact_status, *sweep.statuses):
        return f"wrong: {found.status} for {found.exact_status}"
    return _within(sweep, found) or "agrees"


def _within(sweep: Sweep, found: Point) -> str:
    assert found.error is not None
    return "" if found.error <= sweep.tolerance[0] else f"wrong: off by {found.error:.2g}"


def walk(sweep: Sweep, values: Sequence[float]) -> list[Point]:
    """The points of a sweep."""
    return [point(sweep.at(value), value, sweep.quantity) for value in values]
