"""Water on the joints of a wedge and on a plane: its forces by hand, and what they do to the factor."""

import math

import pytest

import slopekit as sk


@pytest.mark.parametrize("fill", [0.25, 1.0])
def test_a_wedge_that_is_partly_full(fill) -> None:
    """Hoek & Bray (1981), ch. 8: mean pressure γ_w H / 6 on each joint, H the total height."""
    result = sk.wedge(dips=("45/115", "45/245"), water=fill)
    mean = fill * 9.81 * result.geometry.total_height_m / 6.0
    for joint in ("J1", "J2"):
        assert result.forces.water[joint] == pytest.approx(
            mean * result.geometry.areas_m2[joint], rel=1e-12
        )
    assert result.comparisons.forces_only == pytest.approx(result.fos.closed_form, rel=1e-8)


@pytest.mark.parametrize("pressure", [5.0, 40.0])
def test_an_even_pressure_on_a_plane(pressure) -> None:
    """F = (c L + (W cos β - u L) tan φ) / (W sin β), W of the triangle above the plane."""
    dip, face, height, c, phi = 35.0, 60.0, 12.0, 25.0, 37.0
    result = sk.run(
        {
            "slopekit": 1,
            "kind": "plane",
            "slope": {"face": [face, 180], "upper": [0, 180], "height": height},
            "joints": {"J1": {"plane": [dip, 180]}},
            "strength": {"s": {"c": c, "phi": phi}},
            "rock": {"unit_weight": 26},
            "water": {"pressures": {"J1": pressure}},
        }
    )
    a = math.radians(dip)
    length = height / math.sin(a)
    weight = 13.0 * height**2 * (1.0 / math.tan(a) - 1.0 / math.tan(math.radians(face)))
    tangent = math.tan(math.radians(phi))
    exact = (c * length + (weight * math.cos(a) - pressure * length) * tangent) / (
        weight * math.sin(a)
    )
    assert result.forces.water["J1"] == pytest.approx(pressure * length, rel=1e-12)
    assert result.moments_govern or result.fos.limit == pytest.approx(exact, rel=1e-8)
    assert result.comparisons.forces_only == pytest.approx(exact, rel=1e-8)


PLANE = {
    "slopekit": 1,
    "kind": "plane",
    "slope": {"face": "60/180", "height": 12},
    "joints": {"J1": {"plane": "35/180"}},
    "strength": {"J1": {"c": 25, "phi": 37}},
    "rock": {"unit_weight": 26},
    "crack": {"depth": 4.35},
}
WEDGE = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "65/185", "upper": "12/195", "height": 30},
    "joints": {"J1": {"plane": "45/105"}, "J2": {"plane": "70/235"}},
    "strength": {"s": {"c": 24, "phi": 20}},
    "rock": {"unit_weight": 25},
    "crack": {"plane": "80/185", "distance": 3},
}


def without_crack(design):
    return {key: value for key, value in design.items() if key != "crack"}


@pytest.mark.parametrize("design", [PLANE, WEDGE, without_crack(PLANE), without_crack(WEDGE)])
def test_half_of_full_water_is_half_of_its_pressure(design) -> None:
    """50 % by `water` and by `crack.water` are half of what full water does to each interface, by both methods."""
    full, half = (sk.run(design | {"water": {"fill": fill}}) for fill in (1.0, 0.5))
    for name, push in full.forces.water.items():
        assert half.forces.water[name] == pytest.approx(0.5 * push, rel=1e-12)
    assert half.comparisons.forces_only == pytest.approx(half.fos.closed_form, rel=1e-8)
    if "crack" in design:
        crack = {"crack": design["crack"] | {"water": "50 %"}}
        by_crack = sk.run(design | crack | ({"water": {"mode": "full"}} if design is WEDGE else {}))
        assert by_crack.forces.water["crack"] == pytest.approx(
            half.forces.water["crack"], rel=1e-12
        )


@pytest.mark.parametrize(
    ("design", "water", "line"),
    [
        (
            PLANE,
            {"water": {"fill": "50 %"}},
            f"water 50 % of full pressure, highest {9.81 * 4.35 / 2:.4g} kPa",
        ),
        (without_crack(PLANE), {"water": "full"}, f"water full, highest {9.81 * 12 / 2:.4g} kPa"),
        (
            PLANE,
            {"crack": PLANE["crack"] | {"water": "2 m"}},
            "water 2 m deep in the crack, 19.62 kPa at its bottom, falling to nothing at the toe",
        ),
        (
            without_crack(WEDGE),
            {"water": "50 %"},
            "water 50 % of full pressure, highest {half} kPa",
        ),
    ],
)
def test_the_sheet_says_what_per_cent_are_of_and_the_highest_pressure(design, water, line) -> None:
    """γ_w z at the foot of a crack, γ_w H/2 halfway along without one (Hoek & Bray)."""
    result = sk.run(design | water)
    half = f"{9.81 * result.geometry.total_height_m / 4.0:.4g}"
    assert line.format(half=half) in " ".join(str(result.sheet).split())


def test_a_depth_of_water_without_a_table_names_the_crack() -> None:
    with pytest.raises(sk.DesignError, match=r"crack: \{water: 2 m\}"):
        sk.load(PLANE | {"water": {"depth": "2 m"}})
