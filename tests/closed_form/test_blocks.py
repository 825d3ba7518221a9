"""Blocks on inclines against free bodies solved at once, formulas of other arrangement, and limits."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slopekit.closed_form.toppling import ColumnSlope, toppling_factor_of_safety
from tests.closed_form.blocks import (
    block_on_incline,
    running_bond_wall,
    stack_on_incline,
    two_blocks,
)


def tan(degrees: float) -> float:
    return math.tan(math.radians(degrees))


# ---- one block, a stack, a wall


@pytest.mark.parametrize("dip", [1.0, 20.0, 45.0, 80.0])
@pytest.mark.parametrize(("cohesion", "friction"), [(0.0, 30.0), (12.0, 0.0), (8.0, 40.0)])
def test_sliding_of_one_block(dip, cohesion, friction) -> None:
    """N and T from two equations of a free body; to rounding."""
    block = block_on_incline(dip, 3.0, 0.1, cohesion, friction, 24.0)
    sine, cosine = math.sin(math.radians(dip)), math.cos(math.radians(dip))
    normal, shear = np.linalg.solve([[sine, -cosine], [cosine, sine]], [0.0, 24.0 * 3.0 * 0.1])
    assert block.status == "slides"
    assert block.factor == block.sliding_factor
    assert block.factor == pytest.approx(
        (cohesion * 3.0 + normal * tan(friction)) / shear, rel=1e-12
    )


@pytest.mark.parametrize("dip", [10.0, 30.0, 45.0, 70.0])
def test_a_block_tips_at_its_geometric_limit(dip) -> None:
    """The weight passes the lower edge at b / h = tan β; beyond, no strength keeps it (Hoek & Bray 1981, fig. 2.9)."""
    edge = 2.0 / tan(dip)
    stands = block_on_incline(dip, 2.0, edge, 5.0, 35.0, 25.0)
    assert stands.status == "slides"
    assert stands.overturning_ratio == pytest.approx(1.0, rel=1e-14)
    tips = block_on_incline(dip, 2.0, edge * (1.0 + 1e-9), 5.0, 35.0, 25.0)
    assert (tips.status, tips.factor) == ("topples", 0.0)
    assert tips.sliding_factor == pytest.approx(stands.sliding_factor, rel=1e-8)
    for height in (0.3 * edge, 1.7 * edge):  # the same column in the other module
        block = block_on_incline(dip, 2.0, height, 5.0, 35.0, 25.0)
        factor, status = toppling_factor_of_safety(
            ColumnSlope([height], 2.0, 0.0, dip, 25.0, 35.0, cohesion_kpa=5.0)
        )
        assert block.status == status
        assert block.factor == pytest.approx(factor, rel=1e-12)


def test_level_ground() -> None:
    block = block_on_incline(0.0, 2.0, 50.0, 0.0, 0.0, 25.0)
    assert (block.status, block.factor, block.sliding_factor) == ("no_driving_force", None, None)
    assert block.overturning_ratio == math.inf


@pytest.mark.parametrize("count", [1, 2, 7, 200])
def test_a_stack_of_equal_joints(count) -> None:
    """tan φ / tan β on every joint without cohesion; with it the lowest governs, as one block of that height."""
    plain = stack_on_incline(30.0, 2.0, 0.01, count, 0.0, 35.0, 25.0)
    assert plain.factor == pytest.approx(tan(35.0) / tan(30.0), rel=1e-12)
    assert plain.joint == 1
    bonded = stack_on_incline(30.0, 2.0, 0.01, count, 3.0, 35.0, 25.0)
    assert bonded.joint == 1
    assert bonded.factor == pytest.approx(
        block_on_incline(30.0, 2.0, 0.01 * count, 3.0, 35.0, 25.0).factor, rel=1e-12
    )


def test_a_stack_with_weaker_joints() -> None:
    """Joint 2 of c = 2 kPa carries four of five blocks: by hand; a strong joint leaves the base in charge."""
    stack = stack_on_incline(
        25.0, 2.0, 0.5, 5, 20.0, 35.0, 25.0, joint_cohesion_kpa=2.0, joint_friction_angle_deg=28.0
    )
    weight = 25.0 * 2.0 * 0.5 * 4
    by_hand = (2.0 * 2.0 / weight + math.cos(math.radians(25.0)) * tan(28.0)) / math.sin(
        math.radians(25.0)
    )
    assert (stack.status, stack.joint) == ("slides", 2)
    assert stack.factor == pytest.approx(by_hand, rel=1e-12)
    strong = stack_on_incline(25.0, 2.0, 0.5, 5, 0.0, 35.0, 25.0, joint_cohesion_kpa=2.0)
    assert strong.joint == 1


def test_a_stack_tips_as_a_whole_first() -> None:
    """Five blocks stand where b / 5 h = tan β, a sixth overturns all."""
    high = 2.0 / (5.0 * tan(20.0))
    assert stack_on_incline(20.0, 2.0, high, 5, 0.0, 35.0, 25.0).status == "slides"
    six = stack_on_incline(20.0, 2.0, high, 6, 0.0, 35.0, 25.0)
    assert (six.status, six.factor) == ("topples", 0.0)
    assert six.overturning_ratio == pytest.approx(5.0 / 6.0, rel=1e-12)


def test_running_bond() -> None:
    """1.92380 at 20° and 35°, whatever the length and the size, and tipping of a wall that is all height."""
    for length in (20.0, 200.0, 2000.0):
        wall = running_bond_wall(20.0, 35.0, length, 10, 1.0)
        assert wall.status == "slides"
        assert round(wall.factor, 5) == 1.9238
        assert wall.overturning_ratio == pytest.approx(length / 10.0 / tan(20.0), rel=1e-12)
    assert running_bond_wall(20.0, 35.0, 3.0, 10, 1.0).status == "topples"


# ---- two blocks

CASES = {  # manufactured; the closed form equals a linear program to six digits (cases.json, 7c)
    "level, smooth": (
        3.291798,
        {
            "weights_kn": (250.0, 1000.0),
            "base_dips_deg": (45.0, 0.0),
            "base_lengths_m": (50.0**0.5, 10.0),
            "friction_angles_deg": (30.0, 30.0),
        },
    ),
    "10 degrees": (
        1.941039,
        {
            "weights_kn": (250.0, 20.0 * 10.0 * (5.0 + tan(10.0) * 5.0)),
            "base_dips_deg": (45.0, 10.0),
            "base_lengths_m": (50.0**0.5, 10.0 / math.cos(math.radians(10.0))),
            "friction_angles_deg": (30.0, 30.0),
        },
    ),
    "cohesion": (
        4.070999,
        {
            "weights_kn": (250.0, 1000.0),
            "base_dips_deg": (45.0, 0.0),
            "base_lengths_m": (50.0**0.5, 10.0),
            "friction_angles_deg": (30.0, 30.0),
            "cohesions_kpa": (10.0, 10.0),
        },
    ),
}
ROUGH = {
    "rough interface": {"interface_friction_angle_deg": 25.0, "interface_height_m": 5.0},
    "bonded interface": {
        "interface_friction_angle_deg": 15.0,
        "interface_height_m": 5.0,
        "interface_cohesion_kpa": 4.0,
    },
    "climbing base": {
        "base_dips_deg": (50.0, -8.0),
        "interface_friction_angle_deg": 20.0,
        "cohesions_kpa": (3.0, 0.0),
    },
}


@pytest.mark.parametrize("name", CASES)
def test_the_manufactured_cases(name) -> None:
    """To the six decimals printed."""
    factor, inputs = CASES[name]
    found = two_blocks(**inputs)
    assert found.status == "slides"
    assert found.factor == pytest.approx(factor, abs=6e-7)
    low, high = found.bracket
    assert low == found.factor < high < low * (1.0 + 1e-12)


@pytest.mark.parametrize("name", ["level, smooth", "10 degrees"])
def test_smooth_and_without_cohesion(name) -> None:
    """W₁ tan(α₁ - φ₁*) = W₂ tan(φ₂* - α₂) at the factor: to rounding."""
    _, inputs = CASES[name]
    found = two_blocks(**inputs)
    reduced = math.degrees(math.atan(tan(30.0) / found.factor))
    (w1, w2), (a1, a2) = inputs["weights_kn"], inputs["base_dips_deg"]
    assert w1 * tan(a1 - reduced) == pytest.approx(w2 * tan(reduced - a2), rel=1e-12)
    assert found.push_kn == pytest.approx(w1 * tan(a1 - reduced), rel=1e-12)


def given_case(name) -> dict:
    return {**CASES["level, smooth"][1], **ROUGH[name]} if name in ROUGH else CASES[name][1]


@pytest.mark.parametrize("outward", [1.0, -1.0], ids=["to the right", "mirrored"])
@pytest.mark.parametrize("name", [*CASES, *ROUGH])
def test_four_equations_in_world_coordinates(name, outward) -> None:
    """Forces on both blocks, x and z: push, normals and the factor of the passive base solve them to 1e-10."""
    case = given_case(name)
    found = two_blocks(**case)
    assert found.status == "slides"
    factor = found.factor
    cohesion = case.get("cohesions_kpa", (0.0, 0.0))
    side = tan(case.get("interface_friction_angle_deg", 0.0)) / factor
    bond = case.get("interface_cohesion_kpa", 0.0) * case.get("interface_height_m", 0.0) / factor
    matrix, right = (
        np.zeros((4, 4)),
        np.zeros(4),
    )  # unknown: N1, N2, E and the mobilised tan φ of base 2, times N2
    for i, (weight, dip) in enumerate(zip(case["weights_kn"], case["base_dips_deg"], strict=True)):
        slope = math.radians(dip)
        off = np.array([outward * math.sin(slope), math.cos(slope)])
        back = np.array([-outward * math.cos(slope), math.sin(slope)])
        rows = slice(2 * i, 2 * i + 2)
        matrix[rows, i] = off
        if i == 0:
            matrix[rows, 0] += back * tan(case["friction_angles_deg"][0]) / factor
        else:
            matrix[rows, 3] = back
        sign = 1.0 if i == 0 else -1.0
        matrix[rows, 2] = sign * np.array([-outward, side])
        stuck = back * cohesion[i] * case["base_lengths_m"][i] / factor + sign * np.array(
            [0.0, bond]
        )
        right[rows] = -stuck - np.array([0.0, -weight])
    n1, n2, push, friction = np.linalg.solve(matrix, right)
    assert found.normals_kn == pytest.approx((n1, n2), rel=1e-10)
    assert found.push_kn == pytest.approx(push, rel=1e-10)
    assert found.interface_shear_kn == pytest.approx(bond + side * push, rel=1e-10)
    assert friction == pytest.approx(n2 * tan(case["friction_angles_deg"][1]) / factor, rel=1e-10)


def test_friction_on_the_interface_helps() -> None:
    case = CASES["level, smooth"][1]
    factors = [
        two_blocks(**case, interface_friction_angle_deg=angle).factor for angle in (0, 10, 20, 30)
    ]
    assert factors == sorted(factors)
    assert factors[-1] > factors[0] * 1.05
    bonds = [
        two_blocks(**case, interface_height_m=5.0, interface_cohesion_kpa=c).factor
        for c in (0, 2, 5, 10)
    ]
    assert bonds == sorted(bonds)
    assert bonds[0] == factors[0] < bonds[1]


def test_limits_of_two_blocks() -> None:
    """No passive weight: the active block alone. Equal dips (nearly): one block. A climbing base holds."""
    case = CASES["level, smooth"][1]
    assert two_blocks(**{**case, "weights_kn": (250.0, 1e-9)}).factor == pytest.approx(
        tan(30) / tan(45), rel=1e-9
    )
    one = two_blocks(**{**case, "base_dips_deg": (30.0 + 1e-9, 30.0)})
    assert one.factor == pytest.approx(tan(30.0) / tan(30.0), rel=1e-9)
    held = two_blocks(**{**case, "base_dips_deg": (45.0, -60.0)})
    assert (held.status, held.factor) == ("held", None)
    assert two_blocks(**{**case, "friction_angles_deg": (0.0, 0.0)}).factor == 0.0


def test_a_passive_block_that_slides_without_a_push() -> None:
    """The active block is bonded to its base: the passive one slides alone at tan φ / tan α, and is the first lost."""
    case = {**CASES["10 degrees"][1], "cohesions_kpa": (1000.0, 0.0)}
    found = two_blocks(**case)
    assert found.status == "passive_slides"
    assert found.push_kn == 0.0
    assert found.factor == pytest.approx(tan(30.0) / tan(10.0), rel=1e-12)


def test_an_interface_that_carries_the_active_block() -> None:
    """c_i h / F above what the active block needs: no push, its missing hold hangs on the passive one.

    There (W₂ + T) tan α₂ = (W₂ + T) tan φ₂ / F with the weight that hangs on it, the same F as alone.
    """
    case = {**CASES["10 degrees"][1], "interface_height_m": 5.0, "interface_cohesion_kpa": 400.0}
    found = two_blocks(**case, cohesions_kpa=(3.0, 0.0))
    assert (found.status, found.push_kn) == ("passive_slides", 0.0)
    assert found.factor == pytest.approx(tan(30.0) / tan(10.0), rel=1e-12)
    bond, reduced = 3.0 * 50.0**0.5 / found.factor, tan(30.0) / found.factor
    (missing,) = np.roots([-(1.0 - reduced) * 0.5**0.5, (1.0 - reduced) * 0.5**0.5 * 250.0 - bond])
    assert found.interface_shear_kn == pytest.approx(missing, rel=1e-12)
    assert 0.0 < missing < 2000.0 / found.factor


@pytest.mark.slow
@settings(max_examples=80, deadline=None)
@given(
    weights=st.tuples(st.floats(1.0, 1e4), st.floats(1.0, 1e4)),
    active=st.floats(20.0, 80.0),
    less=st.floats(1.0, 60.0),
    frictions=st.tuples(st.floats(3.0, 50.0), st.floats(3.0, 50.0)),
    cohesions=st.tuples(st.floats(0.0, 50.0), st.floats(0.0, 50.0)),
    side=st.floats(0.0, 40.0),
    scale=st.floats(0.1, 10.0),
)
def test_random_two_blocks(weights, active, less, frictions, cohesions, side, scale) -> None:
    """Between the factors of the blocks alone; the same with k² weight, k length and k c; 1 with c and tan φ over F."""
    dips, lengths = (active, active - less), (5.0, 8.0)
    found = two_blocks(
        weights, dips, lengths, frictions, cohesions, interface_friction_angle_deg=side
    )
    scaled = two_blocks(
        (weights[0] * scale**2, weights[1] * scale**2),
        dips,
        (5.0 * scale, 8.0 * scale),
        frictions,
        (cohesions[0] * scale, cohesions[1] * scale),
        interface_friction_angle_deg=side,
    )
    assert scaled.status == found.status
    if found.factor is None:
        assert dips[1] < 0.0
        return
    assert scaled.factor == pytest.approx(found.factor, rel=1e-9)
    alone = [
        (c * length + w * math.cos(math.radians(dip)) * tan(f)) / (w * math.sin(math.radians(dip)))
        if dip > 0.01
        else math.inf
        for c, length, w, dip, f in zip(cohesions, lengths, weights, dips, frictions, strict=True)
    ]
    assert min(alone) * (1.0 - 1e-9) <= found.factor <= max(alone) * (1.0 + 1e-9)

    def reduced(angle: float) -> float:
        return math.degrees(math.atan(tan(angle) / found.factor))

    again = two_blocks(
        weights,
        dips,
        lengths,
        (reduced(frictions[0]), reduced(frictions[1])),
        (cohesions[0] / found.factor, cohesions[1] / found.factor),
        interface_friction_angle_deg=reduced(side),
    )
    assert again.factor == pytest.approx(1.0, abs=1e-9)
