"""The closed form against hand formulas, and PRE-IE against it under every load it knows."""

import math

import numpy as np
import pytest

import slopekit as sk
from slopekit.closed_form.wedge import OUTCOMES, WedgeArrays, hoek_bray_wedges
from slopekit.core.orientation import Plane
from slopekit.kinds import cut
from slopekit.kinds.wedge import closed_form
from slopekit.kinds.wedge.design import wedge_design
from slopekit.preie.one_block.flat_limit import forces_limit
from slopekit.preie.one_block.forces_limits import forces_limits
from slopekit.preie.one_block.pairs_limit import pairs_limit
from slopekit.preie.one_block.polygon_bed import elastic_bed
from tests.support import random_wedge

DIPS = ("45/115", "45/245")
PLANES = ("joint1", "joint2", "face", "upper", "crack")


def arrays(planes, height: float, cohesion: float, friction: float, **changes) -> WedgeArrays:
    """A wedge of joints, face, upper slope and maybe a crack, (dip, dip direction) each; both joints alike."""
    angles = {f"{name}_dip_deg": dip for name, (dip, _) in zip(PLANES, planes, strict=False)}
    ways = {
        f"{name}_dip_direction_deg": way for name, (_, way) in zip(PLANES, planes, strict=False)
    }
    return WedgeArrays(
        **angles,
        **ways,
        height_m=height,
        cohesion1_kpa=cohesion,
        cohesion2_kpa=cohesion,
        friction1_deg=friction,
        friction2_deg=friction,
        unit_weight_kn_m3=25.506,
        **changes,
    )


@pytest.mark.parametrize(("dip", "half"), [(45.0, 65.0), (60.0, 50.0), (30.0, 80.0)])
def test_symmetric_wedge_of_friction_alone(dip, half) -> None:
    """F = (sin β / sin(ξ/2)) tan φ / tan ψ (Hoek & Bray 1981, eq. 8.1; β, ξ, ψ from the planes themselves)."""
    one, two = Plane(dip, 180.0 - half), Plane(dip, 180.0 + half)
    n1, n2 = one.normal(), two.normal()
    line = np.cross(n1, n2) / np.linalg.norm(np.cross(n1, n2))
    plunge = math.asin(abs(line[2]))
    half_angle = (
        math.acos(-(n1 @ n2)) / 2.0
    )  # half the angle between the planes, measured through the wedge
    # β = 90°: by symmetry the bisector of the wedge is square to the horizontal across the line
    exact = math.tan(math.radians(30.0)) / (math.sin(half_angle) * math.tan(plunge))
    planes = ((dip, 180.0 - half), (dip, 180.0 + half), (85.0, 180.0), (0.0, 180.0))
    assert hoek_bray_wedges(arrays(planes, 10.0, 0.0, 30.0)).factor[0] == pytest.approx(
        exact, rel=1e-12
    )


def test_sea_water_presses_by_its_own_unit_weight() -> None:
    """Full water of 10.1 kN/m³: 10.1 H/6 on both joints, given as pressures."""
    wedge = sk.wedge(dips=DIPS, water="full", water_unit_weight=10.1)
    given = sk.wedge(dips=DIPS, water=(10.1 * wedge.geometry.total_height_m / 6.0,) * 2)
    assert wedge.fos.closed_form == pytest.approx(given.fos.closed_form, rel=1e-12)
    assert wedge.fos.limit < sk.wedge(dips=DIPS, water="full").fos.limit


def test_full_water_is_the_classic_pyramid() -> None:
    """Mean pressure γ_w H/6 with H the total height (Hoek & Bray 1981, eq. 8.6)."""
    wedge = sk.wedge(dips=DIPS, water="full")
    mean = 9.81 * wedge.geometry.total_height_m / 6.0
    assert wedge.forces.water["J1"] == pytest.approx(
        mean * wedge.geometry.areas_m2["J1"], rel=1e-12
    )
    even = sk.wedge(dips=DIPS, water=(mean, mean))
    assert wedge.comparisons.forces_only == pytest.approx(
        even.comparisons.forces_only, rel=1e-12
    )  # its moments differ
    half = sk.wedge(dips=DIPS, water="50%")
    assert half.forces.water["J1"] == pytest.approx(wedge.forces.water["J1"] / 2, rel=1e-12)


def test_water_in_a_crack_has_mean_pressure_a_third_of_its_depth() -> None:
    """u = γ_w h₅/3 on the joints and the crack (Hoek & Bray 1981, appendix 2)."""
    wedge = sk.wedge(dips=DIPS, crack="80/180@30m", water="full")
    areas, water = wedge.geometry.areas_m2, wedge.forces.water
    means = [water[name] / areas[name] for name in ("J1", "J2", "crack")]
    bottom = np.array(wedge.geometry.corners_m["back"])
    crest = np.array(wedge.geometry.corners_m["crest_J1"])
    upper = Plane(10, 180).normal()
    depth = (upper @ crest - upper @ bottom) / upper[2]
    assert means == pytest.approx([9.81 * depth / 3.0] * 3, rel=1e-12)


def test_seismic_is_a_horizontal_force_of_k_times_the_weight() -> None:
    weight = sk.wedge(dips=DIPS).forces.weight
    pushed = sk.wedge(dips=DIPS, forces=f"{0.1 * weight}@180/0").fos
    assert sk.wedge(dips=DIPS, seismic="0.1@180").fos.limit == pytest.approx(
        pushed.limit, rel=1e-12
    )
    assert sk.wedge(dips=DIPS, seismic=0.1).fos.limit == pytest.approx(
        pushed.limit, rel=1e-12
    )  # the line trends 180


def test_active_bolt_is_a_load_and_passive_bolt_is_strength() -> None:
    """Passive: F = (R + tan φ ΔN/F + T_s/F ...) solved by hand for a bolt along the line of intersection.

    Along the line nothing presses on the joints: active F = R/(D - T), passive F = (R + T)/D.
    """
    bare = sk.wedge(dips=DIPS).forces
    line = sk.wedge(dips=DIPS).geometry.line_plunge_deg
    tension = 3e5
    active = sk.wedge(dips=DIPS, bolts=f"{tension}@000/{-line}")
    passive = sk.wedge(dips=DIPS, bolts=f"{tension}@000/{-line},passive")
    assert active.fos.limit == pytest.approx(bare.resisting / (bare.driving - tension), rel=1e-9)
    assert passive.fos.limit == pytest.approx((bare.resisting + tension) / bare.driving, rel=1e-9)
    assert passive.fos.closed_form == pytest.approx(passive.fos.limit, rel=1e-9)


def test_bolt_so_strong_that_the_wedge_slides_up() -> None:
    wedge = sk.wedge(dips=DIPS, bolts="5e6@000/-10")
    assert wedge.status == "slides_up"
    assert wedge.fos.limit == pytest.approx(wedge.fos.closed_form, rel=1e-9)


def test_a_passive_bolt_that_is_pushed_in_adds_nothing() -> None:
    wedge = sk.wedge(dips=DIPS, bolts="1e5@180/22,passive")
    assert wedge.fos.limit == pytest.approx(1.5573963, abs=1e-6)
    assert "W311" in [notice.code for notice in wedge.warnings]


def loaded(rng: np.random.Generator) -> dict:
    """A random wedge with a crack, water, an earthquake, a force and bolts that may pull any way."""
    wedge = {**random_wedge(rng), "bolts": None}
    wedge["water"] = f"{rng.uniform(0, 100):.3f}%"
    wedge["seismic"] = f"{rng.uniform(0, 0.2):.4f}@{rng.uniform(0, 360):.2f}"
    alone = wedge_design(wedge | {"water": "dry", "seismic": None})
    weight = cut(alone).scene_at(0).model.force_scale
    wedge["forces"] = [(rng.normal(size=3) * 0.05 * weight).tolist()]
    wedge["bolts"] = [
        {
            "force": float(rng.uniform(0.01, 0.5) * weight),
            "toward": (float(rng.uniform(0, 360)), float(rng.uniform(-60, 60))),
            "acts": "passive" if rng.random() < 0.7 else "active",
        }
        for _ in range(int(rng.integers(0, 3)))
    ]
    plane = ((wedge["face"][1] + rng.uniform(-20, 20)) % 360.0, rng.uniform(60, 90))
    cracked = {
        **wedge,
        "crack": {"plane": (plane[1], plane[0]), "distance": 0.05 * wedge["height"]},
    }
    try:
        cut(wedge_design(cracked)).scene_at(0)
    except sk.GeometryError:
        return wedge
    return cracked


def test_forces_alone_equal_the_closed_form_under_every_load() -> None:
    """Two codes without a line in common; to 1e-6 over 30 random wedges, most with a crack, some with two bolts."""
    rng = np.random.default_rng(77)
    cracks = numbers = 0
    for _ in range(30):
        wedge = loaded(rng)
        design = wedge_design(wedge)
        scene, closed = cut(design).scene_at(0), closed_form(design).factor
        model = scene.model
        bed = elastic_bed(model, scene.bedding.polygons, scene.bedding.centroid)
        alone = forces_limit(model, forces_limits(bed)).factor
        cracks += "crack" in wedge
        if not closed:
            assert not alone
        else:
            numbers += 1
            assert alone == pytest.approx(closed, rel=1e-6)
            if numbers % 5 == 0:
                limit = pairs_limit(model).governing.factor
                assert limit is None or limit <= closed * (1 + 1e-6)
    assert cracks > 5
    assert numbers > 20


def test_no_strength_is_a_factor_of_zero_and_a_status_to_the_user() -> None:
    """A status instead of a factor of safety of 0."""
    found = hoek_bray_wedges(arrays(((45, 115), (45, 245), (60, 180), (10, 180)), 10.0, 0.0, 0.0))
    assert (OUTCOMES[found.outcome[0]], found.factor[0]) == ("slides_on_both", 0.0)
    result = sk.wedge(dips=DIPS, c=0, phi=0)
    assert result.status == "slides_on_both"
    assert (result.fos.limit, result.fos.closed_form) == (None, None)
    assert result.agree
    assert "W308" in [notice.code for notice in result.warnings]


def test_pressures_may_be_given_for_each_plane() -> None:
    planes = ((45, 115), (45, 245), (60, 180), (10, 180), (80, 180))
    found = hoek_bray_wedges(
        arrays(planes, 64.89, 50.0, 20.0, pressures_kpa=(10.0, 20.0, 30.0), crack_distance_m=30.0)
    )
    assert found.pressures_kpa[:, 0].tolist() == [10.0, 20.0, 30.0]
    dry = hoek_bray_wedges(arrays(planes, 64.89, 50.0, 20.0, crack_distance_m=30.0))
    one, two, crack = (Plane(*planes[k]).normal() for k in (0, 1, 4))
    areas = found.areas_m2[
        :, 0
    ]  # upward normals of J1 and J2 point into the wedge, that of the crack out of the slope
    pushed = 10.0 * areas[0] * one + 20.0 * areas[1] * two + 30.0 * areas[2] * crack
    along = -found.line_m[:, 0] / np.linalg.norm(found.line_m[:, 0])
    assert found.driving_kn[0] - dry.driving_kn[0] == pytest.approx(
        float(pushed @ along), rel=1e-12
    )
