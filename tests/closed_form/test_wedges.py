"""Wedges over arrays against the scalar functions, one by one: the same outcomes, the same factors to 1e-12.

Independent source: `geometry.rock.rockmass.wedge_corners` and `scalar_wedge.hoek_bray_wedge`, which share no line
with the arrays.
"""

import dataclasses
import math
from collections import Counter
from functools import cache
from typing import Any

import numpy as np
import pytest

from slopekit.closed_form.inputs import float_columns, selected_columns
from slopekit.closed_form.wedge import (
    CHUNK,
    OUTCOMES,
    ClosedFormWedges,
    WedgeArrays,
    hoek_bray_wedges,
)
from slopekit.core.errors import GeometryError
from slopekit.core.orientation import Plane, line_of, normals
from tests.closed_form.scalar_wedge import ClosedFormWedge, WedgeWater, hoek_bray_wedge
from tests.geometry.manifold_wedge import RockMass, wedge_rock_mass

PLANES = ("joint1", "joint2", "face", "upper")
REL = 1e-12
NUMBERS = [field.name for field in dataclasses.fields(ClosedFormWedges) if field.name != "outcome"]
COUNT = 300


def scalar(
    wedges: WedgeArrays, at: int
) -> tuple[str, float, ClosedFormWedge | None, RockMass | None]:
    """Outcome and factor of one of the wedges, by the functions of plain floats."""

    def of(value: Any) -> float:
        values = np.ravel(value)
        return float(values[at if values.size > 1 else 0])

    def plane(name: str) -> Plane:
        return Plane(
            of(getattr(wedges, f"{name}_dip_deg")), of(getattr(wedges, f"{name}_dip_direction_deg"))
        )

    joint1, joint2, face, upper = map(plane, PLANES)
    crack = None if wedges.crack_dip_deg is None else plane("crack")
    water = WedgeWater(
        of(wedges.fill),
        tuple(map(of, wedges.pressures_kpa)),
        of(wedges.water_unit_weight_kn_m3),
        None if wedges.crack_fill is None else of(wedges.crack_fill),
    )
    trend = None if wedges.seismic_trend_deg is None else of(wedges.seismic_trend_deg)
    try:
        rock = wedge_rock_mass(
            np.array([joint1.normal(), joint2.normal()]),
            face.normal(),
            upper.normal(),
            of(wedges.height_m),
            None if crack is None else crack.normal(),
            of(wedges.crack_distance_m),
        )
        found = hoek_bray_wedge(
            (joint1, joint2),
            face,
            upper,
            of(wedges.height_m),
            (of(wedges.cohesion1_kpa), of(wedges.cohesion2_kpa)),
            (of(wedges.friction1_deg), of(wedges.friction2_deg)),
            of(wedges.unit_weight_kn_m3),
            water=water,
            crack=crack,
            crack_distance=of(wedges.crack_distance_m),
            seismic=(of(wedges.seismic), trend),
            forces=[] if wedges.force_kn is None else [tuple(map(of, wedges.force_kn))],
            passive=wedges.passive_kn,
        )
    except GeometryError as error:
        return error.codes[0], math.nan, None, None
    return found.status, math.nan if found.factor is None else found.factor, found, rock


def compare(wedges: WedgeArrays) -> Counter[str]:
    """Every wedge against the scalar functions; how many there are of each outcome."""
    found = hoek_bray_wedges(wedges)
    answers = [scalar(wedges, at)[:2] for at in range(found.outcome.size)]
    assert [OUTCOMES[outcome] for outcome in found.outcome] == [status for status, _ in answers]
    np.testing.assert_allclose(found.factor, [factor for _, factor in answers], rtol=REL, atol=0.0)
    counts = Counter(status for status, _ in answers)
    assert found.counts() == counts
    return counts


def random(seed: int, count: int = COUNT, **changes: Any) -> dict[str, Any]:
    """Joints of any direction, a quarter of which cut a wedge, with water; `changes` take the place of values."""
    rng = np.random.default_rng(seed)
    facing = rng.uniform(0.0, 360.0, count)
    given = {
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
    return given | changes


def around(seed: int, count: int = COUNT, degrees: float = 5.0, **changes: Any) -> dict[str, Any]:
    """The paper's wedge, scattered: nearly all of them form."""
    rng = np.random.default_rng(seed)
    angles = {
        "joint1_dip_deg": 45.0,
        "joint1_dip_direction_deg": 115.0,
        "joint2_dip_deg": 45.0,
        "joint2_dip_direction_deg": 245.0,
        "face_dip_deg": 60.0,
        "face_dip_direction_deg": 180.0,
        "upper_dip_deg": 10.0,
        "upper_dip_direction_deg": 180.0,
    }
    given = random(seed, count)
    return (
        given
        | {name: angle + degrees * rng.normal(size=count) for name, angle in angles.items()}
        | changes
    )


def rounded(given: dict[str, Any], to: float) -> dict[str, Any]:
    """All planes to round angles: lines in faces, vertical joints, joints square to each other."""
    return given | {
        name: np.round(value / to) * to for name, value in given.items() if "dip" in name
    }


def close_calls(seed: int, count: int = COUNT) -> dict[str, Any]:
    """Planes parallel, lines level or in the face or the upper slope, traces level: to 1° ... 1e-12°, or exactly."""
    rng = np.random.default_rng(seed)
    given = random(seed, count)
    near = (
        10.0 ** rng.uniform(-12.0, 0.0, count)
        * rng.choice([-1.0, 1.0], count)
        * (rng.random(count) < 0.8)
    )
    dips = {plane: (f"{plane}_dip_deg", f"{plane}_dip_direction_deg") for plane in PLANES}
    for kind, (plane, other, turned) in enumerate(
        (
            ("joint2", "joint1", 0.0),
            ("upper", "face", 0.0),
            ("joint1", "face", 0.0),
            ("joint2", "face", 0.0),
            ("joint2", "joint1", 180.0),
            ("upper", "joint1", 0.0),
            ("joint2", "joint1", 90.0),
        )
    ):
        those = np.arange(count) % 8 == kind
        (dip, way), (other_dip, other_way) = dips[plane], dips[other]
        given[way] = np.where(those, given[other_way] + turned + near, given[way])
        given[dip] = np.where(those & (turned == 0.0), given[other_dip] + near, given[dip])
    given["joint1_dip_deg"] = np.where(np.arange(count) % 8 == 6, 90.0, given["joint1_dip_deg"])
    given["joint1_dip_direction_deg"] = np.where(
        np.arange(count) % 8 == 7,
        given["face_dip_direction_deg"] + near,
        given["joint1_dip_direction_deg"],
    )
    given["fill"] = given["fill"] * (rng.random(count) < 0.5)
    some = rng.random(count) < 0.3
    return {
        name: np.where(some, rounded({name: value}, 15.0)[name], value)
        for name, value in given.items()
    }


def along_the_slope(seed: int, count: int = COUNT) -> dict[str, Any]:
    """Upright joints that strike along the face's dip and slope, at round angles: lines 90° from the face's direction.

    Whether such a line runs into the slope (E204) or is too steep for it (E203), the last bit of the scalar path says.
    """
    rng = np.random.default_rng(seed)
    given = rounded(random(seed, count), 5.0)
    facing = given["face_dip_direction_deg"]
    square = rng.random(count) < 0.5
    upright = {"joint1_dip_deg": np.full(count, 90.0), "joint1_dip_direction_deg": facing}
    mirrored = {
        "joint2_dip_deg": np.where(square, given["joint1_dip_deg"], given["joint2_dip_deg"]),
        "joint2_dip_direction_deg": np.where(
            square,
            180.0 + 2.0 * facing - given["joint1_dip_direction_deg"],
            given["joint2_dip_direction_deg"],
        ),
    }
    return (
        given
        | mirrored
        | {name: np.where(square, given[name], value) for name, value in upright.items()}
    )


def thin(seed: int, count: int = COUNT) -> dict[str, Any]:
    """Faces 1° ... 1e-9° steeper than the line of intersection: wedges without a body, areas without a size."""
    rng = np.random.default_rng(seed)
    given = random(seed, count)
    one, two = (
        normals(given[f"{joint}_dip_deg"], given[f"{joint}_dip_direction_deg"])
        for joint in ("joint1", "joint2")
    )
    east, north, up = np.cross(one, two).T
    down = np.where(up > 0.0, -1.0, 1.0)
    apart = rng.uniform(-50.0, 50.0, count)
    facing = np.degrees(np.arctan2(down * east, down * north)) + apart
    flattest = np.degrees(np.arctan2(np.abs(up), np.hypot(east, north) * np.cos(np.radians(apart))))
    steeper = 10.0 ** rng.uniform(-9.0, 0.0, count)
    planes = {
        "face_dip_direction_deg": facing,
        "face_dip_deg": np.minimum(flattest + steeper, 90.0),
        "upper_dip_direction_deg": facing,
        "upper_dip_deg": rng.uniform(0.0, 0.5, count) * flattest,
    }
    return given | planes | {"fill": given["fill"] * (rng.random(count) < 0.2)}


def loads(given: dict[str, Any], seed: int, strong: float) -> dict[str, Any]:
    rng = np.random.default_rng(seed)
    size = strong * given["height_m"] ** 3
    return given | {"force_kn": tuple(rng.normal(size=np.size(size)) * size for _ in range(3))}


def cracked(given: dict[str, Any], seed: int) -> dict[str, Any]:
    rng = np.random.default_rng(seed)
    count = np.size(given["face_dip_deg"])
    return given | {
        "crack_dip_deg": rng.uniform(60.0, 90.0, count),
        "crack_dip_direction_deg": given["face_dip_direction_deg"]
        + rng.uniform(-30.0, 30.0, count),
        "crack_distance_m": rng.uniform(0.0, 0.8, count) * given["height_m"],
    }


def uniform(seed: int, least: float, most: float) -> np.ndarray:
    return np.random.default_rng(seed).uniform(least, most, COUNT)


def trace_of_the_paper() -> float:
    """From the crest to the back of the paper's wedge, along J1: m."""
    joints = np.array([Plane(45.0, 115.0).normal(), Plane(45.0, 245.0).normal()])
    rock = wedge_rock_mass(joints, Plane(60.0, 180.0).normal(), Plane(10.0, 180.0).normal(), 64.89)
    return float(np.linalg.norm(rock.back - rock.crest1))


TRACE_M = trace_of_the_paper()
CASES: dict[str, dict[str, Any]] = {
    "any direction": random(1),
    "any direction, dry": random(2, fill=0.0),
    "around the paper's wedge": around(3),
    "twice to four times full": around(4, degrees=15.0, fill=uniform(4, 2.0, 4.0)),
    "without cohesion": around(5, degrees=15.0, cohesion1_kpa=0.0, cohesion2_kpa=0.0),
    "pressures": random(6, pressures_kpa=(uniform(6, 0.0, 100.0), uniform(7, 0.0, 100.0))),
    "suction on J1": around(7, degrees=15.0, pressures_kpa=(uniform(8, -100.0, 0.0), 50.0)),
    "shaken along the line": random(8, seismic=uniform(9, 0.0, 0.3)),
    "shaken any way": random(
        9, seismic=uniform(10, 0.0, 0.4), seismic_trend_deg=uniform(11, 0.0, 360.0)
    ),
    "forces": loads(random(10), 12, 2.0),
    "strong forces": loads(around(11, degrees=10.0), 13, 20.0),
    "forces, shaken, dry": loads(
        random(12, fill=0.0, seismic=0.15, seismic_trend_deg=200.0), 14, 1.0
    ),
    "crack": cracked(around(13, degrees=10.0), 15),
    "crack in any wedge, shaken": cracked(random(14, seismic=uniform(16, 0.0, 0.2)), 17),
    "crack of any direction, where the wedge ends": cracked(
        around(23, degrees=0.0, height_m=64.89), 25
    )
    | {
        "crack_dip_deg": uniform(26, 0.0, 90.0),
        "crack_dip_direction_deg": uniform(27, 0.0, 360.0),
        "crack_distance_m": TRACE_M * uniform(28, 0.95, 1.02),
    },
    "pressures, crack filled by itself": cracked(
        around(24, pressures_kpa=(10.0, 20.0, 30.0), crack_fill=uniform(29, 0.0, 1.0)), 30
    ),
    "lines just along the slope": along_the_slope(25),
    "crack filled by itself": cracked(around(15, crack_fill=uniform(18, 0.0, 1.0)), 19),
    "pressures on three": cracked(
        around(16, pressures_kpa=(20.0, uniform(20, 0.0, 60.0), 30.0)), 21
    ),
    "crack and forces": loads(cracked(around(17, degrees=10.0), 22), 23, 5.0),
    "round angles": rounded(random(18, fill=0.0), 5.0),
    "very round angles": rounded(random(19, face_dip_direction_deg=180.0, upper_dip_deg=0.0), 15.0),
    "close calls": close_calls(20, 2 * COUNT),
    "thin": thin(22, 2 * COUNT),
    "the same water, heavy": random(21, water_unit_weight_kn_m3=uniform(24, 9.0, 12.0), fill=1.0),
}


@cache
def counts_of(case: str) -> Counter[str]:
    return compare(WedgeArrays(**CASES[case]))


@pytest.mark.parametrize("case", CASES)
def test_every_wedge_is_the_scalar_one(case) -> None:
    assert counts_of(case).total() >= COUNT


def test_the_cases_hold_every_outcome_that_there_is() -> None:
    """All but "falls", which no wedge that the planes cut can do, and E208; what is exact comes in the tests below."""
    total = sum((counts_of(case) for case in CASES), Counter())
    rare = {"no_driving_force": 0, "E208": 0, "falls": 0, "E207": 30}
    assert all(total[name] >= rare.get(name, 60) for name in OUTCOMES), total
    assert total["falls"] == 0
    assert sum(total[name] for name in OUTCOMES[:4]) > 3000


@pytest.mark.parametrize("seed", range(30))
def test_what_all_share_may_be_one_number(seed) -> None:
    """Any mixture of floats and arrays: strengths alone, planes alone, one joint, nothing."""
    rng = np.random.default_rng(seed)
    given = (random, around)[seed % 2](seed, 40)
    if seed % 3 == 0:
        given["seismic"] = 0.1
    if seed % 5 == 0:
        given["fill"] = 0.0
    if seed % 7 == 0:
        given = loads(given, seed, 1.0)
    if seed % 11 == 0:
        given = cracked(given, seed)
    share = rng.random()
    mixed = {
        name: value if name == "force_kn" or rng.random() > share else float(np.ravel(value)[0])
        for name, value in given.items()
    }
    compare(WedgeArrays(**mixed))


def one(**changes: Any) -> WedgeArrays:
    """The paper's wedge."""
    paper = {
        "joint1_dip_deg": 45.0,
        "joint1_dip_direction_deg": 115.0,
        "joint2_dip_deg": 45.0,
        "joint2_dip_direction_deg": 245.0,
        "face_dip_deg": 60.0,
        "face_dip_direction_deg": 180.0,
        "upper_dip_deg": 10.0,
        "upper_dip_direction_deg": 180.0,
        "height_m": 64.89,
        "cohesion1_kpa": 50.0,
        "cohesion2_kpa": 50.0,
        "friction1_deg": 20.0,
        "friction2_deg": 20.0,
        "unit_weight_kn_m3": 25.506,
    }
    return WedgeArrays(**paper | changes)


@pytest.mark.parametrize(
    ("changes", "outcome"),
    [
        ({"joint2_dip_direction_deg": 115.0}, "E201"),
        ({"upper_dip_deg": 60.0}, "E209"),
        ({"joint1_dip_deg": 60.0, "joint1_dip_direction_deg": 180.0}, "E206"),
        ({"joint1_dip_deg": 30.0, "joint1_dip_direction_deg": 180.0}, "E206"),
        ({"joint2_dip_deg": 35.0, "joint2_dip_direction_deg": 180.0}, "E206"),
        ({"joint1_dip_deg": 80.0, "joint2_dip_deg": 80.0}, "E203"),
        ({"face_dip_direction_deg": 0.0, "upper_dip_direction_deg": 0.0}, "E204"),
        ({"joint2_dip_direction_deg": 295.0}, "E204"),
        ({"upper_dip_deg": 30.0}, "E205"),
        ({"height_m": -1.0}, "E209"),
        ({"height_m": 1e-120}, "E208"),
        ({"height_m": math.nan}, "E208"),
        (
            {"crack_dip_deg": 80.0, "crack_dip_direction_deg": 180.0, "crack_distance_m": 1e4},
            "E207",
        ),
        ({"unit_weight_kn_m3": 0.0}, "no_driving_force"),
        ({"pressures_kpa": (2e3, 2e3)}, "lifted"),
        ({"force_kn": (0.0, 5e6, 1e6)}, "slides_up"),
        (
            {
                "cohesion1_kpa": 0.0,
                "cohesion2_kpa": 0.0,
                "friction1_deg": 0.0,
                "friction2_deg": 0.0,
            },
            "slides_on_both",
        ),
        ({"cohesion1_kpa": math.nan}, "slides_on_both"),
    ],
)
def test_each_code_and_status_by_hand(changes, outcome) -> None:
    assert compare(one(**changes)) == {outcome: 1}
    paper = one()
    if all(isinstance(getattr(paper, name), float) for name in changes):
        # as one of many, too: arrays meet other code
        tenth = np.arange(50) % 10 == 7
        many = {
            name: np.where(tenth, value, getattr(paper, name)) for name, value in changes.items()
        }
        assert compare(one(**many)) == Counter({outcome: 5}) + Counter({"slides_on_both": 45})


def test_a_force_that_leaves_nothing_to_drive() -> None:
    """What drives is taken away along the line: 1e-12 of the load decides, both ways."""
    bare = scalar(one(), 0)[2]
    assert bare is not None
    assert bare.sliding is not None
    parts = np.array([1.0, 1.0 + 1e-14, 1.0 - 1e-14, 1.0 + 1e-9, 1.0 - 1e-9])
    force = tuple(-bare.driving * part * parts for part in bare.sliding)
    assert compare(one(force_kn=force)) == {
        "no_driving_force": 3,
        "slides_up": 1,
        "slides_on_both": 1,
    }


@pytest.mark.slow
@pytest.mark.parametrize(
    "given",
    [
        random(70),
        around(72, degrees=12.0, fill=uniform(73, 0.0, 3.0)),
        cracked(around(71, degrees=10.0), 71),
        loads(cracked(around(74, pressures_kpa=(10.0, 20.0, 30.0)), 75), 76, 5.0),
    ],
)
def test_shapes_and_forces_are_the_scalar_ones(given) -> None:
    """All that laws of strength and lists of pairs ask of each plane; nan where the planes cut no wedge.

    Forces are differences: to 1e-12 of the weight, water and other loads.
    """
    wedges = WedgeArrays(**given)
    found = hoek_bray_wedges(wedges)
    trend, plunge = found.line_trend_plunge_deg()
    formed = 0
    for at in range(COUNT):
        _, _, scalar_one, rock = scalar(wedges, at)
        numbers = [
            getattr(found, field.name)[..., at]
            for field in dataclasses.fields(found)
            if field.name != "outcome"
        ]
        if scalar_one is None or rock is None:
            assert all(np.isnan(value).all() for value in numbers)
            continue
        formed += 1
        line, back = line_of(rock.line_of_intersection), rock.back
        if len(rock.normals) > 4:
            back = back * (rock.offsets[4] / (rock.normals[4] @ back))
        expected = [
            scalar_one.volume,
            scalar_one.weight,
            scalar_one.total_height,
            *scalar_one.areas,
            line.trend_deg,
            line.plunge_deg,
            *back,
        ]
        shape = [
            found.volume_m3[at],
            found.weight_kn[at],
            found.total_height_m[at],
            *found.areas_m2[:, at],
            trend[at],
            plunge[at],
            *found.line_m[:, at],
        ]
        assert shape == pytest.approx(expected, rel=REL, abs=REL * math.sqrt(back @ back))
        pushes = found.pressures_kpa[:, at] * found.areas_m2[:, at]
        size = found.weight_kn[at] + float(np.abs(pushes).sum())
        size += (
            0.0 if wedges.force_kn is None else math.hypot(*(part[at] for part in wedges.force_kn))
        )
        forces = [*pushes, *found.normal_kn[:, at], found.driving_kn[at]]
        answer = [*scalar_one.water, *scalar_one.normal, scalar_one.driving]
        assert forces == pytest.approx(answer, rel=REL, abs=10.0 * REL * size)
        assert found.resisting_kn[at] == pytest.approx(
            scalar_one.resisting, rel=REL, abs=10.0 * REL * size
        )
    assert formed > 50


@pytest.mark.slow
@pytest.mark.parametrize("seed", [*range(16), 51])  # every branch that sixty take
def test_passive_bolts_are_the_scalar_ones(seed) -> None:
    """Bolts that may pull any way, from a thousandth of the weight to all of it, one to three, with water and a force.

    The scalar function goes down by 5 % and bisects, its bolts by the Illinois rule; to 1e-9 where either ends.
    """
    rng = np.random.default_rng(900 + seed)
    weight = scalar(one(), 0)[2].weight  # type: ignore[union-attr]
    size = weight * 10.0 ** rng.uniform(-3.0, 0.0, (int(rng.integers(1, 4)), 1))
    bolts = (size * rng.normal(size=(len(size), 3))).tolist()
    force = tuple(rng.normal(size=3) * 0.3 * weight * (rng.random() < 0.5))
    wedges = one(
        passive_kn=bolts,
        force_kn=force,
        pressures_kpa=(rng.uniform(0.0, 300.0), 60.0),
        cohesion2_kpa=20.0,
    )
    found, (status, factor, answer, _) = hoek_bray_wedges(wedges), scalar(wedges, 0)
    assert answer is not None
    assert OUTCOMES[found.outcome[0]] == status
    assert found.factor[0] == pytest.approx(factor, rel=1e-9, nan_ok=True)
    assert [*found.normal_kn[:, 0], found.driving_kn[0]] == pytest.approx(
        [*answer.normal, answer.driving], rel=1e-6, abs=1e-9 * weight
    )


def test_each_wedge_of_many_has_its_own_pull() -> None:
    """Passive bolts are the same for all; what they do differs from wedge to wedge."""
    cohesion, bolts = np.array([0.0, 50.0, 100.0]), [[0.0, 3e5, 1e5]]
    found = hoek_bray_wedges(one(cohesion1_kpa=cohesion, passive_kn=bolts))
    alone = [hoek_bray_wedges(one(cohesion1_kpa=c, passive_kn=bolts)).factor[0] for c in cohesion]
    assert found.factor.tolist() == alone
    assert (np.diff(found.factor) > 0.0).all()
    assert (found.factor > hoek_bray_wedges(one(cohesion1_kpa=cohesion)).factor).all()


def same(a: ClosedFormWedges, b: ClosedFormWedges) -> None:
    np.testing.assert_array_equal(a.outcome, b.outcome)
    np.testing.assert_array_equal(a.factor, b.factor)


def test_chunks_and_strides_change_nothing() -> None:
    """Two chunks and a rest, against the same wedges one chunk at a time and against columns of a matrix."""
    given = random(80, 2 * CHUNK + 777)
    found = hoek_bray_wedges(WedgeArrays(**given))
    columns, _ = float_columns(given)
    for first in (0, CHUNK, 2 * CHUNK):
        part = slice(first, min(first + CHUNK, found.outcome.size))
        alone = hoek_bray_wedges(WedgeArrays(**selected_columns(columns, part)))
        np.testing.assert_array_equal(alone.outcome, found.outcome[part])
        np.testing.assert_allclose(alone.factor, found.factor[part], rtol=REL, atol=0.0)
    matrix = np.column_stack(list(given.values()))
    same(
        hoek_bray_wedges(WedgeArrays(**{name: matrix[:, k] for k, name in enumerate(given)})), found
    )


def test_none_and_one() -> None:
    nothing = hoek_bray_wedges(one(fill=np.zeros(0)))
    assert nothing.outcome.size == nothing.factor.size == 0
    assert nothing.counts() == {}
    found = hoek_bray_wedges(one())
    assert (OUTCOMES[found.outcome[0]], found.factor.round(4).tolist()) == (
        "slides_on_both",
        [1.5574],
    )
    same(found, hoek_bray_wedges(one(fill=[0.0])))
    alone = hoek_bray_wedges(one(), forces=False)
    same(found, alone)
    assert (alone.areas_m2.size, found.areas_m2.shape) == (0, (3, 1))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"fill": np.zeros(3), "height_m": np.ones(4)}, r"height_m \(4,\)"),
        ({"fill": np.zeros((3, 2))}, r"fill \(3, 2\)"),
        ({"crack_dip_deg": 80.0}, "both or neither"),
        ({"pressures_kpa": (1.0,)}, "holds 1 values"),
    ],
)
def test_what_does_not_fit_together_is_refused(changes, message) -> None:
    with pytest.raises(ValueError, match=message):
        hoek_bray_wedges(one(**changes))
