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
        assert result.forces.water[joint] == pytest.approx(mean * result.geometry.areas_m2[joint], rel=1e-12)
    assert result.forces_only == pytest.approx(result.fos.closed_form, rel=1e-8)


@pytest.mark.parametrize("pressure", [5.0, 40.0])
def test_an_even_pressure_on_a_plane(pressure) -> None:
    """F = (c L + (W cos β - u L) tan φ) / (W sin β), W of the triangle above the plane."""
    dip, face, height, c, phi = 35.0, 60.0, 12.0, 25.0, 37.0
    result = sk.run({
        "slopekit": 1, "kind": "plane", "slope": {"face": [face, 180], "upper": [0, 180], "height": height},
        "joints": {"J1": {"plane": [dip, 180]}}, "strength": {"s": {"c": c, "phi": phi}},
        "rock": {"unit_weight": 26}, "water": {"pressures": {"J1": pressure}},
    })  # fmt: skip
    a = math.radians(dip)
    length = height / math.sin(a)
    weight = 13.0 * height**2 * (1.0 / math.tan(a) - 1.0 / math.tan(math.radians(face)))
    tangent = math.tan(math.radians(phi))
    exact = (c * length + (weight * math.cos(a) - pressure * length) * tangent) / (weight * math.sin(a))
    assert result.forces.water["J1"] == pytest.approx(pressure * length, rel=1e-12)
    assert result.moments_govern or result.fos.limit == pytest.approx(exact, rel=1e-8)
    assert result.forces_only == pytest.approx(exact, rel=1e-8)
