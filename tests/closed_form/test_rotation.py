"""Rotation with φ = 0 against caps and segments of the textbooks, and against a brute-force count."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ellipe

from slopekit.closed_form.rotation import rotational_failure
from slopekit.core.errors import GeometryError


def cut(distance: float, dip: float) -> list[tuple[float, float]]:
    """The plane x sin β + z cos β = distance as a profile."""
    sine, cosine = math.sin(math.radians(dip)), math.cos(math.radians(dip))
    return [(x, (distance - x * sine) / cosine) for x in (-50.0, 50.0)]


@pytest.mark.parametrize(
    ("distance", "dip"), [(-5.0, 26.565051), (-1.0, 50.0), (-8.0, 10.0), (3.0, 35.0), (0.0, 80.0)]
)
def test_cap_of_a_sphere(distance, dip) -> None:
    """V = π h² (3R - h) / 3, A = 2πRh, centroid 3 (2R - h)² / (4 (3R - h)) from the centre; quadrature to 1e-9.

    ∫ρ dA over the cap: ρ² = R² (1 - sin²ψ cos²ω), so 4 R³ ∫ sin ψ E(sin²ψ) dψ, E the complete elliptic integral.
    """
    height = 10.0 + distance
    volume = math.pi * height**2 * (30.0 - height) / 3.0
    arm = 3.0 * (20.0 - height) ** 2 / (4.0 * (30.0 - height)) * math.sin(math.radians(dip))
    levers = quad(
        lambda psi: math.sin(psi) * ellipe(math.sin(psi) ** 2),
        0.0,
        math.acos(-distance / 10.0),
        epsabs=1e-13,
    )
    mass = rotational_failure((0.0, 0.0, 0.0), 10.0, 10.0, cut(distance, dip), 20.0, 20.0)
    assert mass.volume_m3 == pytest.approx(volume, rel=1e-9)
    assert mass.area_m2 == pytest.approx(2.0 * math.pi * 10.0 * height, rel=1e-9)
    assert mass.driving_moment_knm == pytest.approx(20.0 * volume * arm, rel=1e-9)
    assert mass.resisting_moment_knm == pytest.approx(20.0 * 4e3 * levers[0], rel=1e-8)
    assert mass.factor == pytest.approx(20.0 * 4e3 * levers[0] / (20.0 * volume * arm), rel=1e-8)
    assert mass.status == "rotates"


def test_the_sphere_of_hungr() -> None:
    """1.402 (Hungr, Salgado & Byrne 1989; their exact value to four digits)."""
    mass = rotational_failure((0.0, 0.0, 0.0), 10.0, 10.0, cut(-5.0, 26.565051), 20.0, 20.0)
    assert mass.factor == pytest.approx(1.402, abs=5e-4)
    assert mass.factor == pytest.approx(1.4016, abs=5e-5)


@pytest.mark.parametrize(("distance", "dip"), [(-4.0, 30.0), (0.0, 30.0), (2.5, 60.0)])
@pytest.mark.parametrize("seismic", [0.0, 0.2, -0.1])
def test_segment_of_a_circle(distance, dip, seismic) -> None:
    """A = R² (ω - sin ω cos ω), centroid 2 R³ sin³ω / (3 A), arc 2Rω, cos ω = -distance / R: to rounding."""
    half = math.acos(-distance / 10.0)
    moment = 2.0 * 10.0**3 * math.sin(half) ** 3 / 3.0  # area times the distance of its centroid
    driving = 18.0 * moment * (math.sin(math.radians(dip)) + seismic * math.cos(math.radians(dip)))
    mass = rotational_failure(
        (0.0, 3.0, 0.0), 10.0, 4.0, cut(distance, dip), 25.0, 18.0, "cylinder", seismic
    )
    assert mass.volume_m3 == pytest.approx(
        8.0 * 100.0 * (half - math.sin(half) * math.cos(half)), rel=1e-12
    )
    assert mass.area_m2 == pytest.approx(8.0 * 20.0 * half, rel=1e-12)
    assert mass.driving_moment_knm == pytest.approx(8.0 * driving, rel=1e-12)
    assert mass.factor == pytest.approx(25.0 * 10.0 * 20.0 * half / abs(driving), rel=1e-12)


PROFILES = [
    [(60.0, 0.0), (40.0, 0.0), (0.0, 40.0), (-20.0, 40.0)],
    [
        (-10.0, 35.0),
        (5.0, 38.0),
        (12.0, 25.0),
        (20.0, 25.0),
        (20.0, 12.0),
        (70.0, 5.0),
    ],  # a bench, a cliff
    [(20.0, 75.0), (45.0, 60.0), (60.0, 20.0)],  # nearly all of it in the ground
    [(0.0, 10.0), (30.0, 30.0), (50.0, 2.0), (62.0, 30.0)],  # two pieces
]


@pytest.mark.slow
@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("half_width", [28.2842712474619, 60.0])
def test_brute_force(profile, half_width) -> None:
    """A million places on the surface, 160,000 columns: the count itself is good to 5e-4."""
    centre, radius, cohesion, weight, seismic = (
        np.array([40.0, -7.0, 40.0]),
        40.0,
        30.0,
        21.56,
        0.07,
    )
    line = np.array(profile if profile[0][0] < profile[-1][0] else profile[::-1])

    def ground(x):
        return np.interp(x, line[:, 0], line[:, 1])

    middles = (np.arange(1000) + 0.5) / 1000 * math.pi
    t, turn = np.meshgrid(middles - math.pi / 2, 2.0 * middles)
    r = radius * np.cos(t)
    x, z = r * np.cos(turn), r * np.sin(turn)
    below = ground(centre[0] + x) > centre[2] + z
    patch = (
        r
        * np.hypot(radius * np.sin(t), half_width * np.cos(t))
        * (math.pi / 1000)
        * (math.pi / 500)
        * below
    )
    s, u = (
        axis.ravel()
        for axis in np.meshgrid(*2 * [((np.arange(400) + 0.5) / 400 * math.pi - math.pi / 2)])
    )
    r = radius * np.cos(s)
    x, half = r * np.sin(u), r * np.cos(u)
    top = np.minimum(ground(centre[0] + x) - centre[2], half)
    plan = r * np.cos(u) * half_width * np.cos(s) * (math.pi / 400) ** 2 * (top > -half)
    driving = weight * (plan * (-(top + half) * x - seismic * (top**2 - half**2) / 2.0)).sum()
    mass = rotational_failure(
        centre, radius, half_width, profile, cohesion, weight, seismic=seismic
    )
    assert mass.volume_m3 == pytest.approx(float((plan * (top + half)).sum()), rel=5e-4)
    assert mass.area_m2 == pytest.approx(float(patch.sum()), rel=5e-4)
    resisting = cohesion * float((patch * radius * np.cos(t)).sum())
    assert mass.resisting_moment_knm == pytest.approx(resisting, rel=5e-4)
    assert mass.driving_moment_knm == pytest.approx(
        driving, rel=5e-4, abs=5e-4 * weight * mass.volume_m3 * radius
    )


def test_what_changes_nothing() -> None:
    """Order of the profile, level points added, mirroring, 500 km, scale (c with length): to 1e-9."""
    profile = PROFILES[0]
    base = rotational_failure((40.0, 0.0, 40.0), 40.0, 28.0, profile, 30.0, 21.56, seismic=0.1)
    mirrored = [(-x, z) for x, z in profile]
    far = [(x + 5e5, z + 4e3) for x, z in profile]
    large = [(1e3 * x, 1e3 * z) for x, z in profile]
    longer = [(900.0, 0.0), (60.0, 0.0), *profile, (-900.0, 40.0)]  # the second point stands twice
    others = [
        rotational_failure((40.0, 0.0, 40.0), 40.0, 28.0, profile[::-1], 30.0, 21.56, seismic=0.1),
        rotational_failure((40.0, 9e6, 40.0), 40.0, 28.0, longer, 30.0, 21.56, seismic=0.1),
        rotational_failure((-40.0, 0.0, 40.0), 40.0, 28.0, mirrored, 30.0, 21.56, seismic=-0.1),
        rotational_failure((500040.0, 0.0, 4040.0), 40.0, 28.0, far, 30.0, 21.56, seismic=0.1),
        rotational_failure((4e4, 0.0, 4e4), 4e4, 2.8e4, large, 3e4, 21.56, seismic=0.1),
    ]
    for other in others:
        assert other.factor == pytest.approx(base.factor, rel=1e-9)
    assert others[2].driving_moment_knm == pytest.approx(-base.driving_moment_knm, rel=1e-9)


def test_statuses_and_faults() -> None:
    level = rotational_failure((0.0, 0.0, 5.0), 10.0, 6.0, [(-5.0, 0.0), (5.0, 0.0)], 20.0, 20.0)
    assert (level.status, level.factor) == ("no_driving_force", None)
    for profile, code in (
        ([(-20.0, -30.0), (20.0, -40.0)], "E214"),
        ([(-20.0, 0.0), (20.0, -5.0), (10.0, -9.0)], "E218"),
    ):
        with pytest.raises(GeometryError) as caught:
            rotational_failure((0.0, 0.0, 5.0), 10.0, 6.0, profile, 20.0, 20.0)
        assert caught.value.codes == (code,)
