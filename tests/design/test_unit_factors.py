"""Every unit from the definitions of NIST SP 811 (2008): the foot, the inch, the pound-force."""

import math

import pytest

from slopekit.core.units import quantity

FOOT, INCH, POUND, KILOGRAM_FORCE = 0.3048, 0.0254, 4.4482216152605e-3, 9.80665e-3  # m, m, kN, kN


@pytest.mark.parametrize(
    ("text", "kind", "value"),
    [
        ("2 mm", "length", 2e-3),
        ("2 cm", "length", 2e-2),
        ("2 km", "length", 2e3),
        ("2 ft", "length", 2 * FOOT),
        ("2 in", "length", 2 * INCH),
        ("2 cm3", "volume", 2e-6),
        ("2 dm3", "volume", 2e-3),
        ("2 ft3", "volume", 2 * FOOT**3),
        ("2 Pa", "pressure", 2e-3),
        ("2 MPa", "pressure", 2e3),
        ("2 psf", "pressure", 2 * POUND / FOOT**2),
        ("2 psi", "pressure", 2 * POUND / INCH**2),
        ("2 N/m3", "unit weight", 2e-3),
        ("2 MN/m3", "unit weight", 2e3),
        ("2 pcf", "unit weight", 2 * POUND / FOOT**3),
        ("2 lbf/ft3", "unit weight", 2 * POUND / FOOT**3),
        ("2 t/m3", "density", 2e3),
        ("2 g/cm3", "density", 2e3),
        ("2 N", "force", 2e-3),
        ("2 MN", "force", 2e3),
        ("2 tf", "force", 2e3 * KILOGRAM_FORCE),
        ("2 lbf", "force", 2 * POUND),
        ("2 kip", "force", 2e3 * POUND),
        ("2 rad", "angle", math.degrees(2.0)),
        ("2 MPa/m", "stiffness", 2e3),
        ("2 GPa/m", "stiffness", 2e6),
        ("2 %", "ratio", 2e-2),
        ("2 g", "ratio", 2.0),
    ],
)
def test_a_unit_is_its_definition(text, kind, value) -> None:
    """To the eight digits that the factors are written with."""
    assert quantity(text, kind, "x") == pytest.approx(value, rel=1e-8)
