"""Wedges a second on one core: arrays, the scalar closed form, and NumPy written plainly, in one run.

Run by hand: ``python -m benchmarks.throughput`` (half a minute). ``python -m benchmarks.throughput equal`` compares
100,000 wedges of any direction, and as many around the paper's, with the scalar functions (a minute and more) instead.
All fifteen inputs vary. Times are CPU time of the one thread: other work on the machine still costs it cache and clock,
so the four are taken in turns, and the best of each counts, with the median behind it.
"""

import math
import statistics
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from slopekit.closed_form.plane import PlaneArrays, plane_failures
from slopekit.closed_form.wedge import OUTCOMES, WedgeArrays, hoek_bray_wedges
from slopekit.core.errors import GeometryError
from slopekit.core.orientation import Plane
from slopekit.geometry.rock.rockmass import wedge_corners
from tests.closed_form.scalar_wedge import WedgeWater, hoek_bray_wedge

Arrays = dict[str, np.ndarray]
COUNT, FEW, TURNS, CHUNK = 1_000_000, 1_000, 7, 8192
PLANES = ("joint1", "joint2", "face", "upper")
PAPER = {
    "joint1_dip_deg": 45.0,
    "joint1_dip_direction_deg": 115.0,
    "joint2_dip_deg": 45.0,
    "joint2_dip_direction_deg": 245.0,
    "face_dip_deg": 60.0,
    "face_dip_direction_deg": 180.0,
    "upper_dip_deg": 10.0,
    "upper_dip_direction_deg": 180.0,
}


def scattered(rng: np.random.Generator, count: int, degrees: float) -> Arrays:
    """The paper's wedge with every angle scattered: what a Monte Carlo draws."""
    return {
        **{name: angle + degrees * rng.normal(size=count) for name, angle in PAPER.items()},
        "height_m": rng.normal(64.89, 3.0, count),
        "cohesion1_kpa": rng.lognormal(math.log(50.0), 0.3, count),
        "cohesion2_kpa": rng.lognormal(math.log(50.0), 0.3, count),
        "friction1_deg": rng.normal(20.0, 2.0, count),
        "friction2_deg": rng.normal(20.0, 2.0, count),
        "unit_weight_kn_m3": rng.normal(25.5, 0.5, count),
        "fill": rng.uniform(0.0, 1.0, count),
    }


def any_direction(rng: np.random.Generator, count: int) -> Arrays:
    """Joints of any direction in slopes of any steepness; a quarter of them cut a wedge."""
    facing = rng.uniform(0.0, 360.0, count)
    return {
        "joint1_dip_deg": rng.uniform(10.0, 89.0, count),
        "joint1_dip_direction_deg": rng.uniform(0.0, 360.0, count),
        "joint2_dip_deg": rng.uniform(10.0, 89.0, count),
        "joint2_dip_direction_deg": rng.uniform(0.0, 360.0, count),
        "face_dip_deg": rng.uniform(40.0, 89.0, count),
        "face_dip_direction_deg": facing,
        "upper_dip_deg": rng.uniform(0.0, 30.0, count),
        "upper_dip_direction_deg": facing + rng.uniform(-30.0, 30.0, count),
        "height_m": 10.0 ** rng.uniform(0.0, 2.0, count),
        "cohesion1_kpa": rng.uniform(0.0, 100.0, count),
        "cohesion2_kpa": rng.uniform(0.0, 100.0, count),
        "friction1_deg": rng.uniform(5.0, 50.0, count),
        "friction2_deg": rng.uniform(5.0, 50.0, count),
        "unit_weight_kn_m3": rng.uniform(20.0, 30.0, count),
        "fill": rng.uniform(0.0, 1.0, count),
    }


def that_form(rng: np.random.Generator, count: int) -> Arrays:
    """Those of any direction that do cut a wedge."""
    given = any_direction(rng, 4 * count)
    formed = np.flatnonzero(
        hoek_bray_wedges(WedgeArrays(**given)).outcome < OUTCOMES.index("E201")
    )[:count]
    return {name: values[formed] for name, values in given.items()}


# -- one by one ---------------------------------------------------------------------------------------


def one_by_one(given: Arrays, tests: bool) -> Iterator[tuple[str, float]]:
    """Outcome and factor by the functions of plain floats; `tests`: whether the planes cut a wedge at all, too."""
    names = list(given)
    for row in zip(*(values.tolist() for values in given.values()), strict=True):
        value = dict(zip(names, row, strict=True))
        one, two, face, upper = (
            Plane(value[f"{p}_dip_deg"], value[f"{p}_dip_direction_deg"]) for p in PLANES
        )
        try:
            if tests:
                joints = np.array([one.normal(), two.normal()])
                wedge_corners(joints, face.normal(), upper.normal(), value["height_m"])
            found = hoek_bray_wedge(
                (one, two),
                face,
                upper,
                value["height_m"],
                (value["cohesion1_kpa"], value["cohesion2_kpa"]),
                (value["friction1_deg"], value["friction2_deg"]),
                value["unit_weight_kn_m3"],
                water=WedgeWater(value["fill"]),
            )
        except GeometryError as error:
            yield error.codes[0], math.nan
            continue
        yield found.status, math.nan if found.factor is None else found.factor


# -- NumPy, plainly -----------------------------------------------------------------------------------


def plainly(given: Mapping[str, np.ndarray]) -> np.ndarray:
    """Factors by corners and cross products, in chunks: no test whether planes cut a wedge, no status, no workspace."""
    count = len(given["height_m"])
    return np.concatenate(
        [
            _plain_chunk({k: v[at : at + CHUNK] for k, v in given.items()})
            for at in range(0, count, CHUNK)
        ]
    )


def _plain_chunk(v: Mapping[str, np.ndarray]) -> np.ndarray:
    def normal(plane: str) -> tuple[np.ndarray, ...]:
        dip, way = np.radians(v[f"{plane}_dip_deg"]), np.radians(v[f"{plane}_dip_direction_deg"])
        return np.sin(dip) * np.sin(way), np.sin(dip) * np.cos(way), np.cos(dip)

    def cross(a: Any, b: Any) -> tuple[np.ndarray, ...]:
        return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]

    def dot(a: Any, b: Any) -> np.ndarray:
        return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]

    def scaled(a: Any, by: np.ndarray) -> tuple[np.ndarray, ...]:
        return a[0] * by, a[1] * by, a[2] * by

    n1, n2, face, upper = map(normal, PLANES)
    trace1, trace2, line = cross(n1, face), cross(n2, face), cross(n1, n2)
    crest1 = scaled(trace1, v["height_m"] / trace1[2])
    offset = dot(upper, crest1)
    crest2, back = (
        scaled(trace2, offset / dot(upper, trace2)),
        scaled(line, offset / dot(upper, line)),
    )
    weight = v["unit_weight_kn_m3"] * np.abs(dot(crest1, cross(crest2, back))) / 6.0
    across1, across2 = cross(crest1, back), cross(crest2, back)
    area1, area2 = np.sqrt(dot(across1, across1)) / 2.0, np.sqrt(dot(across2, across2)) / 2.0
    n1 = scaled(n1, np.where(dot(n1, crest2) > 0.0, 1.0, -1.0))
    n2 = scaled(n2, np.where(dot(n2, crest1) > 0.0, 1.0, -1.0))
    highest = np.maximum(np.maximum(crest1[2], crest2[2]), back[2])
    mean = v["fill"] * 9.81 * (highest - np.minimum(crest2[2], 0.0)) / 6.0
    push1, push2 = mean * area1, mean * area2
    load = (
        n1[0] * push1 + n2[0] * push2,
        n1[1] * push1 + n2[1] * push2,
        n1[2] * push1 + n2[2] * push2 - weight,
    )
    on1, on2, b = dot(load, n1), dot(load, n2), dot(n1, n2)
    share = 1.0 - b * b
    both1, both2 = (on2 * b - on1) / share, (on1 * b - on2) / share
    tan1, tan2 = np.tan(np.radians(v["friction1_deg"])), np.tan(np.radians(v["friction2_deg"]))
    bond1, bond2 = v["cohesion1_kpa"] * area1, v["cohesion2_kpa"] * area2
    length = np.sqrt(dot(line, line))
    factor = (bond1 + bond2 + both1 * tan1 + both2 * tan2) * length / np.abs(dot(load, line))
    square = dot(load, load)
    alone1 = (bond1 - on1 * tan1) / np.sqrt(square - on1 * on1)
    alone2 = (bond2 - on2 * tan2) / np.sqrt(square - on2 * on2)
    factor = np.where(
        (on1 < 0.0) & (both2 <= 0.0), alone1, np.where((on2 < 0.0) & (both1 <= 0.0), alone2, factor)
    )
    return np.where((on1 >= 0.0) & (on2 >= 0.0), np.nan, factor)


# -- the page -----------------------------------------------------------------------------------------


def seconds_each(work: Callable[[], object], count: int) -> float:
    began = time.process_time()
    work()
    return (time.process_time() - began) / count


def speed(name: str, given: Arrays) -> None:
    wedges, few = WedgeArrays(**given), {key: values[:FEW] for key, values in given.items()}
    count = len(given["height_m"])
    runs: dict[str, tuple[Callable[[], object], int]] = {
        "arrays: tests, outcome, factor": (lambda: hoek_bray_wedges(wedges, forces=False), count),
        "NumPy plainly: factor alone": (lambda: plainly(given), count),
        "one by one, with the tests": (lambda: list(one_by_one(few, tests=True)), FEW),
        "one by one, without": (lambda: list(one_by_one(few, tests=False)), FEW),
    }
    times: dict[str, list[float]] = {run: [] for run in runs}
    with np.errstate(all="ignore"):
        for _ in range(TURNS):
            for run, (work, number) in runs.items():
                times[run].append(seconds_each(work, number))
    best = min(times["arrays: tests, outcome, factor"])
    print(f"\n## {name}: {count:,} wedges, {len(given)} inputs vary")
    for run, found in times.items():
        least = min(found)
        print(
            f"{run:32s} {1.0 / least:12,.0f} a second  {least * 1e9:9,.0f} ns"
            f"  (median {statistics.median(found) * 1e9:9,.0f})  {least / best:7.1f} x"
        )
    counts = hoek_bray_wedges(wedges).counts()
    print(
        "outcomes: "
        + ", ".join(f"{outcome} {number / count:.2%}" for outcome, number in counts.items())
    )


def planes(rng: np.random.Generator) -> None:
    slopes = PlaneArrays(
        face_dip_deg=rng.normal(60.0, 3.0, COUNT),
        upper_dip_deg=rng.normal(5.0, 2.0, COUNT),
        plane_dip_deg=rng.normal(35.0, 5.0, COUNT),
        height_m=rng.normal(12.0, 1.0, COUNT),
        cohesion_kpa=rng.lognormal(math.log(25.0), 0.3, COUNT),
        friction_deg=rng.normal(37.0, 3.0, COUNT),
        unit_weight_kn_m3=rng.normal(26.0, 0.5, COUNT),
        crack_distance_m=rng.uniform(0.0, 8.0, COUNT),
        fill=rng.uniform(0.0, 1.0, COUNT),
    )
    each = min(seconds_each(lambda: plane_failures(slopes), COUNT) for _ in range(3))
    print(
        f"\n## Plane failure: {COUNT:,} blocks with a crack, 9 inputs vary\n{1.0 / each:,.0f} a second"
    )
    print(
        "outcomes: "
        + ", ".join(
            f"{name} {k / COUNT:.2%}" for name, k in plane_failures(slopes).counts().items()
        )
    )


def mood() -> None:
    """What the machine gives at the moment: elements of 8192 in the cache."""
    x, out = np.linspace(0.1, 1.0, CHUNK), np.empty(CHUNK)
    found = {
        name: min(seconds_each(lambda run=run: run(x), CHUNK) for _ in range(200)) * 1e9  # type: ignore[misc]
        for name, run in (
            ("sin", np.sin),
            ("tan", np.tan),
            ("multiply", lambda a: np.multiply(a, a, out)),
        )
    }
    print("NumPy in the cache: " + ", ".join(f"{name} {ns:.2f} ns" for name, ns in found.items()))


def equal(name: str, given: Arrays) -> None:
    """Every wedge against the scalar functions."""
    found = hoek_bray_wedges(WedgeArrays(**given))
    different, errors, count = 0, [0.0], 0
    for status, factor in one_by_one(given, tests=True):
        different += OUTCOMES[found.outcome[count]] != status
        if math.isfinite(factor):
            errors.append(abs(float(found.factor[count]) / factor - 1.0))
        count += 1
    median, high, worst = np.quantile(errors, [0.5, 0.999, 1.0])
    print(
        f"{name}: {count:,} wedges, {different} with another outcome; {len(errors) - 1:,} factors, relative difference"
        f" median {median:.1e}, 99.9 % below {high:.1e}, worst {worst:.1e}"
    )
    print("  " + ", ".join(f"{outcome} {number}" for outcome, number in found.counts().items()))


def main(words: list[str]) -> None:
    rng = np.random.default_rng(20261122)
    if words == ["equal"]:
        equal("any direction", any_direction(rng, 100_000))
        equal("any direction, removable", that_form(rng, 100_000))
        equal("around the paper's wedge, 10°", scattered(rng, 100_000, 10.0))
        return
    mood()
    speed("Around the paper's wedge, angles to 4°", scattered(rng, COUNT, 4.0))
    speed("Around the paper's wedge, angles to 10°", scattered(rng, COUNT, 10.0))
    speed("Any direction that cuts a wedge", that_form(rng, COUNT))
    planes(rng)
    mood()


if __name__ == "__main__":
    main(sys.argv[1:])
