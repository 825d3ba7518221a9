"""Plane failure against the formulas of the books, free bodies solved by hand, and limits."""

import dataclasses
import math
from types import SimpleNamespace

import numpy as np
import pytest

from slopekit.closed_form.plane import OUTCOMES, PlaneArrays, plane_failures

BOOK = {
    "face_dip_deg": 60.0,
    "upper_dip_deg": 0.0,
    "plane_dip_deg": 35.0,
    "height_m": 12.0,
    "cohesion_kpa": 25.0,
    "friction_deg": 37.0,
    "unit_weight_kn_m3": 26.0,
    "crack_distance_m": 4.0,
}


def failure(forces=(), **changes):
    """The example of Wyllie & Mah, changed: its status, and its numbers as floats; `forces` (x, z) one by one."""
    force = tuple(np.sum(forces, axis=0)) if len(forces) else None
    found = plane_failures(PlaneArrays(**{**BOOK, **changes}, force_kn=force))
    numbers = {
        field.name: float(getattr(found, field.name)[0]) for field in dataclasses.fields(found)
    }
    return SimpleNamespace(
        status=OUTCOMES[found.outcome[0]],
        uplift_kn=numbers["pressure_kpa"] * numbers["length_m"],
        **numbers,
    )


def by_depth(depth, **changes):
    """With the crack given by its depth."""
    return failure(crack_distance_m=None, crack_depth_m=depth, **changes)


def tan(degrees: float) -> float:
    return math.tan(math.radians(degrees))


@pytest.mark.parametrize(
    ("cohesion", "water", "recomputed", "published"),
    [(25.0, 3.0, 1.24666, 1.25), (25.0, 0.0, 1.54448, 1.54), (0.0, 0.0, 1.07619, 1.08)],
)
def test_the_example_of_wyllie_and_mah(cohesion, water, recomputed, published) -> None:
    """Wyllie & Mah (2004), ch. 6: crack 4.35 m deep, b rounded to 4 m in print; cases.json 4a, 4c, 4d (five digits)."""
    exact = by_depth(4.35, cohesion_kpa=cohesion, water_in_crack_m=water)
    assert exact.status == "slides"
    assert exact.crack_depth_m == pytest.approx(4.35, rel=1e-12)
    assert exact.factor == pytest.approx(recomputed, abs=6e-6)
    printed = failure(cohesion_kpa=cohesion, water_in_crack_m=water)  # b = 4: 2e-5 beside it
    assert printed.factor == pytest.approx(recomputed, abs=1e-4)
    assert printed.factor == pytest.approx(published, abs=0.006)


@pytest.mark.parametrize("depth", [0.5, 2.0, 4.0])
@pytest.mark.parametrize(("face", "plane"), [(60.0, 35.0), (85.0, 50.0), (45.0, 25.0)])
def test_weight_and_length_of_hoek_and_bray_behind_the_crest(depth, face, plane) -> None:
    """W = ½ γ H² ((1 - (z/H)²) cot ψ_p - cot ψ_f), A = (H - z) / sin ψ_p (1981, eq. 7.1 and 7.3): to rounding."""
    block = by_depth(depth, face_dip_deg=face, plane_dip_deg=plane)
    weight = 0.5 * 26.0 * 12.0**2 * ((1.0 - (depth / 12.0) ** 2) / tan(plane) - 1.0 / tan(face))
    assert block.weight_kn == pytest.approx(weight, rel=1e-12)
    assert block.length_m == pytest.approx(
        (12.0 - depth) / math.sin(math.radians(plane)), rel=1e-12
    )
    assert block.crack_depth_m == pytest.approx(depth, rel=1e-12)


@pytest.mark.parametrize("distance", [-1.0, -3.0, -6.0])
def test_weight_with_the_crack_in_the_face(distance) -> None:
    """W = ½ γ H² (1 - z/H)² cot ψ_p (cot ψ_p tan ψ_f - 1) (1981, eq. 7.4), z measured from the top: to rounding.

    There z is the height from the crest's level to the foot of the crack.
    """
    block = failure(crack_distance_m=distance)
    foot = 12.0 - (12.0 / tan(60.0) + distance) * tan(35.0)
    weight = (
        0.5 * 26.0 * 12.0**2 * (1.0 - foot / 12.0) ** 2 / tan(35.0) * (tan(60.0) / tan(35.0) - 1.0)
    )
    assert block.weight_kn == pytest.approx(weight, rel=1e-12)


def test_weight_below_a_dipping_upper_slope() -> None:
    """The depth between ground and plane, summed from front to back (linear in three parts: exact)."""
    for distance, upper in (
        (None, 15.0),
        (9.0, 15.0),
        (4.0, -10.0),
        (None, -10.0),
        (20.0, 40.0),
        (0.0, 20.0),
    ):
        block = failure(upper_dip_deg=upper, crack_distance_m=distance)
        crest = 12.0 / tan(60.0)
        end = block.length_m * math.cos(math.radians(35.0))
        x = np.array([0.0, min(crest, end), end])
        ground = np.where(x <= crest, x * tan(60.0), 12.0 + (x - crest) * tan(upper))
        depth = ground - x * tan(35.0)
        assert block.weight_kn == pytest.approx(
            26.0 * float(np.diff(x) @ (depth[1:] + depth[:-1])) / 2.0, rel=1e-12
        )
        assert block.crack_depth_m == pytest.approx(
            depth[-1] if distance is not None else 0.0, abs=1e-9
        )
        assert distance is None or end == pytest.approx(crest + distance, rel=1e-12)
        assert distance is not None or depth[-1] == pytest.approx(0.0, abs=1e-9)


LOADED = [
    {},
    {"water_in_crack_m": 2.5},
    {"water_in_crack_m": 2.5, "water_unit_weight_kn_m3": 10.3, "seismic": 0.12},
    {"pressure_kpa": 17.0, "crack_pressure_kpa": 4.0},
    {"forces": ((-200.0, -40.0), (30.0, 5.0))},
    {"upper_dip_deg": 12.0, "crack_distance_m": None, "fill": 0.35, "seismic": 0.05},
]


@pytest.mark.parametrize("loads", LOADED)
def test_free_body_solved_by_two_equations(loads) -> None:
    """N' and T from horizontal and vertical equilibrium under every load, to rounding."""
    block = failure(**loads)
    thrust = (
        0.5 * loads.get("water_unit_weight_kn_m3", 9.81) * loads.get("water_in_crack_m", 0.0) ** 2
    )
    thrust += loads.get("crack_pressure_kpa", 0.0) * block.crack_depth_m
    high = block.length_m * math.sin(
        math.radians(35.0)
    )  # above the crest, where the upper slope dips toward it
    mean = loads.get("fill", 0.0) * 9.81 * high / 4.0  # γ_w H/2 at mid-length, nothing at both ends
    in_crack = loads.get("water_unit_weight_kn_m3", 9.81) * loads.get("water_in_crack_m", 0.0) / 2.0
    mean += loads.get("pressure_kpa", in_crack)
    uplift = mean * block.length_m
    assert (block.uplift_kn, block.thrust_kn) == pytest.approx((uplift, thrust), rel=1e-12)
    sine, cosine = math.sin(math.radians(35.0)), math.cos(math.radians(35.0))
    pushes = np.array(loads.get("forces", ()) or [(0.0, 0.0)]).sum(axis=0)
    outward = thrust + loads.get("seismic", 0.0) * block.weight_kn + uplift * sine + pushes[0]
    upward = uplift * cosine - block.weight_kn + pushes[1]
    normal, shear = np.linalg.solve([[sine, -cosine], [cosine, sine]], [-outward, -upward])
    assert (block.normal_kn, block.driving_kn) == pytest.approx((normal, shear), rel=1e-12)
    resisting = 25.0 * block.length_m + normal * tan(37.0)
    assert block.resisting_kn == pytest.approx(resisting, rel=1e-12)
    assert block.factor == pytest.approx(resisting / shear, rel=1e-12)


def test_water_scales() -> None:
    """U grows with the water's depth, V with its square, both with its unit weight."""
    one, two = failure(water_in_crack_m=1.5), failure(water_in_crack_m=3.0)
    assert (two.uplift_kn / one.uplift_kn, two.thrust_kn / one.thrust_kn) == pytest.approx(
        (2.0, 4.0)
    )
    heavy = failure(water_in_crack_m=1.5, water_unit_weight_kn_m3=2 * 9.81)
    assert (heavy.uplift_kn, heavy.thrust_kn) == pytest.approx(
        (2 * one.uplift_kn, 2 * one.thrust_kn)
    )
    assert one.thrust_kn == pytest.approx(0.5 * 9.81 * 1.5**2)
    assert failure(pressure_kpa=3.0).uplift_kn == pytest.approx(3.0 * one.length_m)
    bare = failure(crack_distance_m=None, fill=0.5)
    assert bare.uplift_kn == pytest.approx(0.5 * 9.81 * 12.0 / 4.0 * bare.length_m)


def test_limits() -> None:
    """F = tan φ / tan ψ without cohesion and water, whatever the block; scale and water's absence change nothing."""
    for distance in (None, 2.0, -2.0):
        dry = failure(cohesion_kpa=0.0, crack_distance_m=distance)
        assert dry.factor == pytest.approx(tan(37.0) / tan(35.0), rel=1e-12)
    assert failure(cohesion_kpa=0.0, friction_deg=0.0).factor == 0.0
    small = failure(
        height_m=0.012, cohesion_kpa=0.025, crack_distance_m=0.004, water_in_crack_m=0.003
    )
    assert small.factor == pytest.approx(failure(water_in_crack_m=3.0).factor, rel=1e-9)


def test_statuses() -> None:
    """Contact lost drops the cohesion and the number; a level plane drives nothing; bolts may reverse the sliding."""
    lifted = failure(pressure_kpa=200.0)
    assert (lifted.status, lifted.normal_kn, lifted.resisting_kn) == ("lifted", 0.0, 0.0)
    assert math.isnan(lifted.factor)
    just = failure(pressure_kpa=0.999 * failure().normal_kn / failure().length_m)
    assert just.status == "slides"
    weight = failure().weight_kn
    floats = failure(forces=[(0.0, weight)])
    assert (floats.status, floats.driving_kn) == ("no_driving_force", 0.0)
    assert math.isnan(floats.factor)
    over = failure(face_dip_deg=100.0, plane_dip_deg=90.0, crack_distance_m=None)
    assert over.status == "falls"
    assert math.isnan(over.factor)
    upward = failure(forces=[(-2000.0, 0.0)])
    sine, cosine = math.sin(math.radians(35.0)), math.cos(math.radians(35.0))
    driving = 2000.0 * cosine - weight * sine
    resisting = 25.0 * upward.length_m + (weight * cosine + 2000.0 * sine) * tan(37.0)
    assert (upward.status, upward.factor) == (
        "slides_up",
        pytest.approx(resisting / driving, rel=1e-12),
    )


def root(a: float, b: float, c: float) -> float:
    """The larger root of a x² + b x + c = 0."""
    return (-b + math.sqrt(b * b - 4.0 * a * c)) / (2.0 * a)


@pytest.mark.parametrize("bolt", [(-300.0, 0.0), (-300.0, -80.0), (-100.0, 60.0)])
def test_a_passive_bolt_is_divided_by_the_factor(bolt) -> None:
    """D - λ T_s = λ (c L + (N + λ T_n) tan φ), solved for λ = 1/F; bisection ends at rounding."""
    bare = failure()
    sine, cosine = math.sin(math.radians(35.0)), math.cos(math.radians(35.0))
    held = -bolt[0] * cosine + bolt[1] * sine
    pressed = -bolt[0] * sine - bolt[1] * cosine
    strength = root(pressed * tan(37.0), bare.resisting_kn + held, -bare.driving_kn)
    block = failure(passive_kn=[bolt])
    assert (block.status, block.factor) == ("slides", pytest.approx(1.0 / strength, rel=1e-9))
    twice = failure(passive_kn=[(0.4 * bolt[0], 0.4 * bolt[1]), (0.6 * bolt[0], 0.6 * bolt[1])])
    assert twice.factor == pytest.approx(block.factor, rel=1e-9)


def test_passive_bolts_that_are_not_drawn_out() -> None:
    """Pushed in, or of no size, they add nothing; after a reversal the one that points down the slope works."""
    assert failure(passive_kn=[(100.0, -60.0)]).factor == pytest.approx(failure().factor, rel=1e-9)
    assert failure(passive_kn=[(0.0, 0.0)]).factor == failure().factor
    upward = {"forces": [(-2000.0, 0.0)]}
    assert failure(**upward, passive_kn=[(-100.0, 0.0)]).factor == pytest.approx(
        failure(**upward).factor, rel=1e-9
    )
    assert failure(**upward, passive_kn=[(100.0, 0.0)]).factor > failure(**upward).factor
    floats = failure(passive_kn=[(-100.0, 0.0)], forces=[(0.0, failure().weight_kn)])
    assert floats.status == "no_driving_force"


def test_a_passive_bolt_holds_a_block_that_water_lifts() -> None:
    """Square to the plane: D = λ (c L + (λ T - N₀) tan φ), N₀ the uplift beyond the weight's part."""
    lifted = {"pressure_kpa": 90.0}
    assert failure(**lifted).status == "lifted"
    bare = failure()
    excess = 90.0 * bare.length_m - bare.normal_kn
    sine, cosine = math.sin(math.radians(35.0)), math.cos(math.radians(35.0))
    capacity = 3000.0
    block = failure(**lifted, passive_kn=[(-capacity * sine, -capacity * cosine)])
    strength = root(
        capacity * tan(37.0), 25.0 * bare.length_m - excess * tan(37.0), -bare.driving_kn
    )
    assert strength * capacity > excess
    assert block.factor == pytest.approx(1.0 / strength, rel=1e-9)
    alone = failure(**lifted, cohesion_kpa=0.0, friction_deg=0.0, passive_kn=[(-1.0, -1.0)])
    assert alone.factor == pytest.approx((cosine - sine) / bare.driving_kn, rel=1e-9)  # λ T_s = D
    out = failure(
        **lifted, passive_kn=[(1.0, -1.0)]
    )  # more down the slope than it presses: nothing holds the block down
    assert out.status == "lifted"
    assert math.isnan(out.factor)


@pytest.mark.parametrize(
    ("changes", "code"),
    [
        ({"plane_dip_deg": 60.0}, "E203"),
        ({"plane_dip_deg": 0.0}, "E204"),
        ({"crack_distance_m": None, "upper_dip_deg": 35.0}, "E205"),
        ({"crack_distance_m": None, "upper_dip_deg": 50.0}, "E205"),
        ({"crack_distance_m": 10.3}, "E207"),
        ({"crack_distance_m": -7.0}, "E207"),
        ({"water_in_crack_m": 4.5}, "E207"),
        ({"crack_distance_m": None, "water_in_crack_m": 1.0}, "E207"),
        ({"upper_dip_deg": 60.0}, "E209"),
    ],
)
def test_faults(changes, code) -> None:
    refused = failure(**changes)
    assert refused.status == code
    assert math.isnan(refused.factor)
    assert math.isnan(refused.weight_kn)


def test_a_crack_by_its_depth_is_the_one_by_its_distance() -> None:
    """The depth found again, to rounding; E207 where no crack behind the crest is so deep, or all are alike."""
    for upper, depth in ((0.0, 0.1), (10.0, 5.0), (45.0, 9.0), (-10.0, 3.0)):
        block = by_depth(depth, upper_dip_deg=upper)
        assert block.crack_depth_m == pytest.approx(depth, rel=1e-9)
        behind = block.length_m * math.cos(math.radians(35.0)) - 12.0 / tan(60.0)
        again = failure(upper_dip_deg=upper, crack_distance_m=behind)
        assert (again.crack_depth_m, again.factor) == pytest.approx((depth, block.factor), rel=1e-9)
    for upper, depth in ((0.0, 7.2), (45.0, 7.0), (35.0, 7.0), (0.0, 0.0), (0.0, -1.0)):
        assert by_depth(depth, upper_dip_deg=upper).status == "E207"
