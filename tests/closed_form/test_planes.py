"""Plane failures over arrays against the scalar functions, one by one: the same outcomes, the same factors to 1e-12.

Independent source: `geometry.sections.section.plane_section`, then `scalar_plane.plane_failure` with the water that
`kinds.plane` gives it.
"""

import math
from collections import Counter
from typing import Any

import numpy as np
import pytest

import slopekit as sk
from slopekit.closed_form.plane import OUTCOMES, PlaneArrays, plane_failures
from slopekit.core.errors import GeometryError
from slopekit.geometry.sections.section import plane_section
from slopekit.kinds import plane as analysis
from slopekit.kinds.plane import PlaneDesign
from tests.closed_form.scalar_plane import ClosedFormPlane, plane_failure

REL = 1e-12
COUNT = 400


def scalar(planes: PlaneArrays, at: int) -> tuple[str, float, ClosedFormPlane | None]:
    """Outcome and factor of one of the blocks, by the functions of plain floats."""

    def of(value: Any, default: float | None = None) -> Any:
        return default if value is None else float(np.ravel(value)[at if np.size(value) > 1 else 0])

    dips = of(planes.plane_dip_deg), of(planes.face_dip_deg), of(planes.upper_dip_deg)
    weight, pressure = of(planes.water_unit_weight_kn_m3), of(planes.pressure_kpa)
    deep = peak = 0.0
    forces = [] if planes.force_kn is None else [(of(planes.force_kn[0]), of(planes.force_kn[1]))]
    try:
        cut = plane_section(
            *dips, of(planes.height_m), of(planes.crack_depth_m), of(planes.crack_distance_m)
        )
        if (
            pressure is not None
            and cut.crack_depth is not None
            and planes.crack_pressure_kpa is not None
        ):
            forces.append((of(planes.crack_pressure_kpa) * cut.crack_depth, 0.0))
        elif pressure is None and cut.crack_depth is None:
            peak = of(planes.fill) * weight * float(np.ptp(cut.outline[:, 1])) / 2.0
        elif pressure is None and planes.water_in_crack_m is not None:
            deep = of(planes.water_in_crack_m)
        elif pressure is None:  # a part of the pressure of a crack full to the top
            pressure = of(planes.fill) * weight * cut.crack_depth / 2.0
            forces.append((pressure * cut.crack_depth, 0.0))
        found = plane_failure(
            dips[1],
            dips[2],
            dips[0],
            of(planes.height_m),
            of(planes.cohesion_kpa),
            of(planes.friction_deg),
            of(planes.unit_weight_kn_m3),
            crack_distance_m=cut.crack_distance,
            water_in_crack_m=deep,
            water_unit_weight_kn_m3=weight,
            mean_pressure_kpa=pressure,
            plane_water_peak_mid_kpa=peak,
            seismic=of(planes.seismic),
            forces=forces,
            passive=planes.passive_kn,
        )
    except GeometryError as error:
        return error.codes[0], math.nan, None
    return found.status, math.nan if found.factor is None else found.factor, found


def compare(planes: PlaneArrays) -> Counter[str]:
    """Every block against the scalar functions; how many there are of each outcome."""
    found = plane_failures(planes)
    answers = [scalar(planes, at) for at in range(found.outcome.size)]
    assert [OUTCOMES[outcome] for outcome in found.outcome] == [status for status, _, _ in answers]
    np.testing.assert_allclose(
        found.factor, [factor for _, factor, _ in answers], rtol=REL, atol=0.0
    )
    of = {
        name: np.array(
            [math.nan if block is None else getattr(block, name) for _, _, block in answers]
        )
        for name in (
            "weight_kn",
            "length_m",
            "crack_depth_m",
            "normal_kn",
            "driving_kn",
            "resisting_kn",
            "uplift_kn",
        )
    }
    for name in ("weight_kn", "length_m", "crack_depth_m"):
        np.testing.assert_allclose(getattr(found, name), of[name], rtol=REL, atol=0.0)
    size = of["weight_kn"] + np.abs(of["uplift_kn"]) + np.nan_to_num(found.thrust_kn)
    size = size + (0.0 if planes.force_kn is None else np.hypot(*planes.force_kn))
    forces = {name: getattr(found, name) for name in ("normal_kn", "driving_kn", "resisting_kn")}
    for name, values in (forces | {"uplift_kn": found.pressure_kpa * found.length_m}).items():
        off = np.abs(
            values - of[name]
        )  # differences, as is the depth of the water: to 1e-11 of the loads
        assert (np.isnan(of[name]) | (off <= 10.0 * REL * (size + of["resisting_kn"]))).all(), name
        assert np.isnan(values[np.isnan(of[name])]).all()
    counts = Counter(status for status, _, _ in answers)
    assert found.counts() == counts
    return counts


def random(seed: int, count: int = COUNT, **parts: tuple[float, float]) -> dict[str, Any]:
    """Slopes of which two in three hold a block; `parts` are further values, uniform between parts of the height."""
    rng = np.random.default_rng(seed)
    height = 10.0 ** rng.uniform(0.0, 2.0, count)
    given = {
        "face_dip_deg": rng.uniform(30.0, 90.0, count),
        "upper_dip_deg": rng.uniform(-20.0, 40.0, count),
        "plane_dip_deg": rng.uniform(-2.0, 75.0, count),
        "height_m": height,
        "cohesion_kpa": rng.uniform(0.0, 100.0, count),
        "friction_deg": rng.uniform(0.0, 50.0, count),
        "unit_weight_kn_m3": rng.uniform(20.0, 30.0, count),
        "fill": rng.uniform(0.0, 1.05, count),
    }
    return given | {name: height * rng.uniform(*part, count) for name, part in parts.items()}


def depth_and_distance(seed: int) -> dict[str, Any]:
    """Both of the crack, which agree to 3 % of either."""
    given = random(seed, crack_depth_m=(0.0, 0.8))
    face, upper, plane = (
        np.tan(np.radians(given[f"{name}_dip_deg"])) for name in ("face", "upper", "plane")
    )
    behind = (given["height_m"] * (1.0 - plane / face) - given["crack_depth_m"]) / (plane - upper)
    return given | {
        "crack_distance_m": behind * np.random.default_rng(seed).uniform(0.97, 1.03, COUNT)
    }


def forces(given: dict[str, Any], seed: int) -> dict[str, Any]:
    rng = np.random.default_rng(seed)
    count = len(given["height_m"])
    size = 8.0 * given["height_m"] ** 2
    return given | {
        "force_kn": (rng.normal(size=count) * size, rng.normal(size=count) * size),
        "seismic": rng.uniform(0.0, 0.3, count),
        "water_unit_weight_kn_m3": 10.0,
    }


def rounded(given: dict[str, Any], to: float) -> dict[str, Any]:
    return given | {
        name: np.round(value / to) * to for name, value in given.items() if "dip" in name
    }


CASES: dict[str, dict[str, Any]] = {
    "no crack": random(1),
    "crack by distance": random(2, crack_distance_m=(-0.8, 0.8)),
    "crack by depth": random(3, crack_depth_m=(-0.1, 1.0)),
    "crack by both": depth_and_distance(4),
    "water in the crack, m": random(5, crack_distance_m=(-0.2, 0.5), water_in_crack_m=(0.0, 0.6)),
    "pressure on the plane": random(6, pressure_kpa=(0.0, 15.0)),
    "pressures on both": random(
        7, crack_depth_m=(0.0, 0.5), pressure_kpa=(0.0, 8.0), crack_pressure_kpa=(0.0, 5.0)
    ),
    "forces": forces(random(8), 8),
    "forces and crack": forces(random(9, crack_distance_m=(-0.3, 0.5)), 9),
    "round angles": rounded(random(10), 5.0) | {"fill": 0.0},
    "round angles, crack at the crest": rounded(random(11), 5.0) | {"crack_distance_m": 0.0},
    "without cohesion": random(12, crack_depth_m=(0.0, 0.6)) | {"cohesion_kpa": 0.0},
}


def test_every_block_is_the_scalar_one() -> None:
    """All but "falls", which no plane can that lies below its face."""
    total = Counter[str]()
    for given in CASES.values():
        total += compare(PlaneArrays(**given))
    rare = {"falls": 0, "no_driving_force": 0}
    assert all(total[name] >= rare.get(name, 25) for name in OUTCOMES), total
    assert total["slides"] > 1500


@pytest.mark.parametrize("case", CASES)
def test_the_cut_itself_changes_nothing(case) -> None:
    first = {
        name: value[:6] if np.ndim(value) == 1 else value for name, value in CASES[case].items()
    }
    if "force_kn" in first:
        first["force_kn"] = tuple(value[:6] for value in first["force_kn"])
    assert compare(PlaneArrays(**first)).total() == 6


@pytest.mark.parametrize("seed", range(20))
def test_what_all_share_may_be_one_number(seed) -> None:
    rng = np.random.default_rng(seed)
    given = list(CASES.values())[seed % len(CASES)]
    share = rng.random()
    mixed = {}
    for name, value in given.items():
        fixed = name != "force_kn" and rng.random() < share
        first = (
            tuple(part[:30] for part in value)
            if name == "force_kn"
            else np.broadcast_to(value, COUNT)[:30]
        )
        mixed[name] = float(first[seed % 30]) if fixed else first
    compare(PlaneArrays(**mixed))


def book(**changes: Any) -> PlaneArrays:
    """The example of Wyllie & Mah (2004), ch. 6."""
    given = {
        "face_dip_deg": 60.0,
        "upper_dip_deg": 0.0,
        "plane_dip_deg": 35.0,
        "height_m": 12.0,
        "cohesion_kpa": 25.0,
        "friction_deg": 37.0,
        "unit_weight_kn_m3": 26.0,
    }
    return PlaneArrays(**given | changes)


@pytest.mark.parametrize(
    ("changes", "outcome"),
    [
        ({}, "slides"),
        ({"plane_dip_deg": 0.0}, "E204"),
        ({"plane_dip_deg": -20.0}, "E204"),
        ({"plane_dip_deg": 60.0}, "E203"),
        ({"upper_dip_deg": 60.0}, "E209"),
        ({"upper_dip_deg": 35.0}, "E205"),
        ({"upper_dip_deg": 35.0, "crack_distance_m": 5.0}, "slides"),
        ({"upper_dip_deg": 35.0, "crack_depth_m": 5.0}, "E207"),
        ({"crack_depth_m": 9.0}, "E207"),
        ({"crack_depth_m": 0.0}, "E207"),
        ({"crack_distance_m": 100.0}, "E207"),
        ({"crack_distance_m": -100.0}, "E207"),
        ({"crack_depth_m": 4.0, "crack_distance_m": 9.0}, "E207"),
        ({"crack_distance_m": 4.0, "water_in_crack_m": 9.0}, "E207"),
        ({"face_dip_deg": 90.0, "crack_depth_m": 4.0, "fill": 1.0}, "slides"),
        ({"pressure_kpa": 500.0}, "lifted"),
        ({"force_kn": (-2000.0, 0.0)}, "slides_up"),
        ({"unit_weight_kn_m3": 0.0}, "no_driving_force"),
        ({"friction_deg": 0.0, "cohesion_kpa": 0.0}, "slides"),
    ],
)
def test_each_code_and_status_by_hand(changes, outcome) -> None:
    assert compare(book(**changes)) == {outcome: 1}


def test_a_force_that_leaves_nothing_to_drive() -> None:
    """What drives is taken away along the plane, but for 1e-12 of all loads: the force counts among them."""
    bare = scalar(book(), 0)[2]
    assert bare is not None
    dip = math.radians(35.0)
    left = (
        1e-12
        * (bare.weight_kn + bare.driving_kn * np.array([0.0, 0.7, 1.3, 0.7, 1.3]))
        * [1, 1, 1, -1, -1]
    )
    force = left - bare.driving_kn
    found = compare(book(force_kn=(force * math.cos(dip), -force * math.sin(dip))))
    assert found == {"no_driving_force": 3, "slides": 1, "slides_up": 1}


def test_the_designs_of_the_analysis() -> None:
    """Files read, cut and analysed as a user's: the closed form of their results."""
    file: dict[str, Any] = {
        "slopekit": 1,
        "kind": "plane",
        "slope": {"face": "60/180", "height": 12, "upper": "5/180"},
        "joints": {"J1": {"plane": "35/180", "strength": "bedding"}},
        "strength": {"bedding": {"c": 25, "phi": 37}},
        "rock": {"unit_weight": 26},
    }
    for changes, arrays in (
        ({}, {}),
        ({"water": "60%"}, {"fill": 0.6}),
        ({"water": "60%", "crack": {"depth": "4 m"}}, {"fill": 0.6, "crack_depth_m": 4.0}),
        (
            {"crack": {"distance": 4, "water": 3}},
            {"crack_distance_m": 4.0, "water_in_crack_m": 3.0},
        ),
        (
            {"water": {"pressures": [20, 10]}, "crack": {"depth": 4}},
            {"crack_depth_m": 4.0, "pressure_kpa": 20.0, "crack_pressure_kpa": 10.0},
        ),
        ({"loads": {"seismic": 0.1}}, {"seismic": 0.1}),
    ):
        design = sk.load(file | changes)
        assert isinstance(design, PlaneDesign)
        expected = analysis.closed_form(design).factor
        found = plane_failures(book(upper_dip_deg=5.0, **arrays))
        assert found.factor[0] == pytest.approx(expected, rel=REL)


def test_none_and_what_does_not_fit_together() -> None:
    assert plane_failures(book(fill=np.zeros(0))).counts() == {}
    with pytest.raises(ValueError, match="one length"):
        plane_failures(book(fill=np.zeros(3), height_m=np.ones(2)))
    with pytest.raises(ValueError, match="goes with pressure_kpa"):
        plane_failures(book(crack_pressure_kpa=3.0))


@pytest.mark.parametrize("seed", range(40))
def test_passive_bolts_are_the_scalar_ones(seed) -> None:
    """Bolts that may pull any way, one to three, with water, a force and an earthquake; to 1e-9."""
    rng = np.random.default_rng(seed)
    bolts = [
        (rng.normal(size=2) * 10.0 ** rng.uniform(0.0, 2.5)).tolist()
        for _ in range(int(rng.integers(1, 4)))
    ]
    planes = book(
        crack_distance_m=4.0,
        passive_kn=bolts,
        force_kn=tuple(rng.normal(size=2) * 200.0 * (rng.random() < 0.5)),
        seismic=rng.uniform(0.0, 0.3),
        pressure_kpa=rng.uniform(0.0, 80.0),
    )
    found, (status, factor, answer) = plane_failures(planes), scalar(planes, 0)
    assert answer is not None
    assert OUTCOMES[found.outcome[0]] == status
    assert found.factor[0] == pytest.approx(factor, rel=1e-9, nan_ok=True)
    assert [found.normal_kn[0], found.driving_kn[0]] == pytest.approx(
        [answer.normal_kn, answer.driving_kn], rel=1e-6, abs=1e-6
    )
