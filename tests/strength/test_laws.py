"""The strength laws against worked numbers and by what holds for every one of them."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slopekit.core.units import quantity
from slopekit.design.strength_laws import fields_of_law
from slopekit.strength import registry
from slopekit.strength.barton_bandis import BartonBandis
from slopekit.strength.bilinear import Bilinear
from slopekit.strength.bridged import Bridged
from slopekit.strength.mohr_coulomb import MohrCoulomb
from slopekit.strength.power import PowerCurve
from slopekit.strength.protocol import StrengthLaw, secant, tangent
from slopekit.strength.registry import LAWS, _by_name
from slopekit.strength.waviness import Wavy

EVERY = [
    MohrCoulomb(50.0, 20.0),
    BartonBandis(8.0, 50e3, 25.0),
    BartonBandis(16.0, 100e3, 28.0, length_m=5.0),
    PowerCurve(2.0, 0.75),
    PowerCurve(1.5, 0.6, 10.0),
    Bilinear(25.0, 15.0, 300.0),
    Wavy(BartonBandis(8.0, 50e3, 25.0), 5.0),
    Bridged(10.0, 30.0, 2e3, 45.0, 0.97),
    *(
        law(
            **{
                name: quantity(field.example, field.measures, name)
                for name, field in fields_of_law(law).items()
            }
        )
        for law in LAWS.values()
    ),
]
TRACTIONS = np.array([0.5, 20.0, 299.0, 301.0, 2000.0])


@pytest.mark.parametrize(
    ("normal", "shear", "slope", "angle", "cohesion"),
    [
        (0.360, 0.989, 1.652, 58.82, 0.394),
        (0.720, 1.538, 1.423, 54.91, 0.513),
        (1.440, 2.476, 1.213, 50.49, 0.730),
        (2.880, 4.073, 1.030, 45.85, 1.107),
        (5.759, 6.779, 0.872, 41.07, 1.760),
        (11.518, 11.344, 0.733, 36.22, 2.907),
        (23.036, 18.973, 0.609, 31.33, 4.953),
        (46.073, 31.533, 0.496, 26.40, 8.666),
    ],
)
def test_barton_bandis_as_hoek_works_it(normal, shear, slope, angle, cohesion) -> None:
    """Hoek, Practical Rock Engineering, ch. 4, spreadsheet: JRC 16.9, JCS 96 MPa, φ 29°; MPa, as printed there.

    The shear strength, its slope, and the instantaneous friction angle and cohesion, which are the tangent's.
    """
    law, at = BartonBandis(16.9, 96e3, 29.0), np.array([normal * 1e3])
    bond, steep = tangent(law, at)
    assert law.resistance(at)[0] / 1e3 == pytest.approx(shear, abs=6e-4)
    assert steep[0] == pytest.approx(slope, abs=6e-4)
    assert math.degrees(math.atan(steep[0])) == pytest.approx(angle, abs=6e-3)
    assert bond[0] / 1e3 == pytest.approx(cohesion, abs=6e-4)


def test_barton_bandis_of_a_long_joint() -> None:
    """JRC_n = JRC (L_n/L_0)^(-0.02 JRC) and JCS_n = JCS (L_n/L_0)^(-0.03 JRC), worked by hand for ten times the length.

    10^-0.2 and 10^-0.3 are 0.630957 and 0.501187.
    """
    assert BartonBandis(10.0, 100e3, 30.0, length_m=1.0).scaled == pytest.approx(
        (6.30957, 50118.7), rel=1e-5
    )
    short = BartonBandis(10.0, 100e3, 30.0, length_m=0.1)
    assert short.resistance(TRACTIONS) == pytest.approx(
        BartonBandis(10.0, 100e3, 30.0).resistance(TRACTIONS), rel=1e-14
    )


def test_barton_bandis_is_cut_off_at_70_degrees_and_comes_down_to_the_residual_angle() -> None:
    """Barton (1976): 70° where the logarithm has no bound; at JCS no roughness is left."""
    law = BartonBandis(16.0, 100e3, 28.0)
    assert secant(law, np.array([1e-3, 1.0]))[1] == pytest.approx(
        math.tan(math.radians(70.0)), rel=1e-14
    )
    assert secant(law, np.array([100e3, 1e6]))[1] == pytest.approx(
        math.tan(math.radians(28.0)), rel=1e-12
    )
    assert secant(BartonBandis(0.0, 1e3, 30.0), TRACTIONS)[1] == pytest.approx(
        math.tan(math.radians(30.0)), rel=1e-14
    )


def test_a_wall_as_strong_as_one_can_write_has_no_overflow() -> None:
    """Without a normal traction nothing holds, and 70° where there is one; warnings are errors here."""
    law = BartonBandis(8.0, 1e12, 25.0)
    assert law.resistance(np.array([0.0, 1e-3])) == pytest.approx(
        [0.0, 1e-3 * math.tan(math.radians(70.0))], rel=1e-12
    )


def test_patton_by_hand() -> None:
    """Patton (1966): φ 25° and i 15° below 300 kPa: 300 tan 40° = 251.73, and 200 tan 25° = 93.26 more at 500 kPa."""
    found = Bilinear(25.0, 15.0, 300.0).resistance(np.array([0.0, 300.0, 500.0]))
    assert found == pytest.approx([0.0, 251.7299, 344.9914], abs=1e-4)


def test_power_curve_by_hand() -> None:
    """2 · 16^0.75 = 16, and 5 more."""
    assert PowerCurve(2.0, 0.75, 5.0).resistance(np.array([0.0, 16.0])) == pytest.approx(
        [5.0, 21.0], abs=1e-13
    )


def test_waviness_adds_its_tangent() -> None:
    """Rocscience, joint shear strength, eq. 1: τ = c + σ tan φ + σ tan φ_w."""
    found = Wavy(MohrCoulomb(50.0, 20.0), 5.0).resistance(np.array([0.0, 100.0]))
    assert found == pytest.approx([50.0, 50.0 + 36.39702 + 8.74887], abs=1e-5)


@pytest.mark.parametrize("law", EVERY, ids=lambda law: law.in_words())
def test_every_law(law) -> None:
    """Strength grows, is concave, its slope is its derivative, and a reduced law has the strength over F."""
    assert isinstance(law, StrengthLaw)
    step = 1e-5 * TRACTIONS
    numeric = (law.resistance(TRACTIONS + step) - law.resistance(TRACTIONS - step)) / (2.0 * step)
    assert law.slope(TRACTIONS) == pytest.approx(numeric, rel=1e-8)
    assert (np.diff(law.slope(TRACTIONS)) <= 1e-12).all()
    assert (np.diff(law.resistance(TRACTIONS)) > 0.0).all()
    weaker = law.reduced(1.7).reduced(2.0)
    assert weaker.resistance(TRACTIONS) * 3.4 == pytest.approx(law.resistance(TRACTIONS), rel=1e-14)
    assert weaker.slope(TRACTIONS) * 3.4 == pytest.approx(law.slope(TRACTIONS), rel=1e-14)
    none = np.array([-5.0, 0.0])
    assert (law.resistance(none) == law.resistance(np.zeros(2))).all()
    bond, steep = secant(law, TRACTIONS)
    assert bond + steep * TRACTIONS == pytest.approx(law.resistance(TRACTIONS), rel=1e-14)
    assert law.in_words()


@given(
    st.floats(0.0, 20.0),
    st.floats(1e3, 2e5),
    st.floats(15.0, 40.0),
    st.floats(0.1, 900.0),
    st.floats(0.1, 900.0),
)
def test_a_tangent_lies_nowhere_below_its_law(jrc, jcs, phi, one, other) -> None:
    """What makes the static bound on tangents a bound: below JCS the law is concave."""
    law = BartonBandis(jrc, jcs, phi)
    bond, steep = tangent(law, np.array([one]))
    assert bond[0] + steep[0] * other >= law.resistance(np.array([other]))[0] * (1.0 - 1e-12)


def test_straight_laws_among_the_curved() -> None:
    """A power curve with b = 1 and a bilinear law of equal slopes are Mohr-Coulomb."""
    line = MohrCoulomb(50.0, 20.0).resistance(TRACTIONS)
    assert PowerCurve(math.tan(math.radians(20.0)), 1.0, 50.0).resistance(
        TRACTIONS
    ) == pytest.approx(line, rel=1e-14)
    flat = Bilinear(20.0, 0.0, 300.0).resistance(TRACTIONS)
    assert flat == pytest.approx(MohrCoulomb(0.0, 20.0).resistance(TRACTIONS), rel=1e-14)


def test_the_registry_names_every_law() -> None:
    """The names that design files write; every file of the folder is a law, but those that laws share."""
    shared = {"__init__", "protocol", "reduced", "registry", "waviness", "mohr_coulomb"}
    files = {path.stem for path in Path(registry.__file__).parent.glob("*.py")} - shared
    assert list(LAWS) == ["mohr-coulomb", *sorted(name.replace("_", "-") for name in files)]
    assert {"barton-bandis", "bilinear", "bridged", "power"} <= LAWS.keys()


def test_a_copy_of_a_law_beside_it_is_refused() -> None:
    """`power_old.py` beside `power.py`, as editors and hurried hands leave it, would have been taken in its place."""
    copied = type(
        "PowerCurve", (), {"name": PowerCurve.name, "__module__": "slopekit.strength.power_old"}
    )
    with pytest.raises(
        ValueError, match=r"power stands in slopekit\.strength\.power and in .*power_old"
    ):
        _by_name([PowerCurve, copied])
    assert _by_name([PowerCurve, PowerCurve]) == {"power": PowerCurve}
