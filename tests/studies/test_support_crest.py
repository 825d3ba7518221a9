"""A row of anchors from the crest of a plane failure, against Hoek & Bray's formula with an anchor (1981, ch. 7).

The formula, with the anchor's angle off the normal of the plane, is also in the lecture notes of IIT (BHU) Varanasi on
slopes, 4.1.7. Tolerances without a cause of their own are rounding of the plunge to 1e-4 degrees.
"""

import math

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.errors import DesignError

WATER, ROCK = 9.81, 26.0
CRACKED = {
    "slopekit": 1, "kind": "plane", "slope": {"face": "60/180", "height": 12}, "joints": {"J1": {"plane": "35/180"}},
    "strength": {"s": {"c": 25, "phi": 37}}, "rock": {"unit_weight": ROCK}, "crack": {"depth": 4.35, "water": 3.0},
}  # fmt: skip
PRESSED = {
    "slopekit": 1, "kind": "plane", "slope": {"face": "60/180", "height": 12}, "joints": {"J1": {"plane": "20/180"}},
    "strength": {"s": {"c": 0, "phi": 45}}, "rock": {"unit_weight": ROCK}, "water": {"pressures": [75]},
}  # fmt: skip


def by_hand(design, plunge, factor):
    """T per metre from the formula, and the factor it is solved for."""
    height, face = design["slope"]["height"], math.radians(60.0)
    dip = math.radians(float(design["joints"]["J1"]["plane"].split("/")[0]))
    c, friction = design["strength"]["s"]["c"], math.tan(math.radians(design["strength"]["s"]["phi"]))
    if "crack" in design:
        deep, wet = design["crack"]["depth"], design["crack"]["water"]
        area = (height - deep) / math.sin(dip)
        weight = 0.5 * ROCK * height**2 * ((1.0 - (deep / height) ** 2) / math.tan(dip) - 1.0 / math.tan(face))
        uplift, thrust = 0.5 * WATER * wet * area, 0.5 * WATER * wet**2
    else:
        area = height / math.sin(dip)
        weight = 0.5 * ROCK * height**2 * (1.0 / math.tan(dip) - 1.0 / math.tan(face))
        uplift, thrust = design["water"]["pressures"][0] * area, 0.0
    off = math.pi / 2.0 - dip - np.radians(plunge)  # of the normal
    presses = weight * math.cos(dip) - uplift - thrust * math.sin(dip)
    drives = weight * math.sin(dip) + thrust * math.cos(dip)
    return (factor * drives - c * area - presses * friction) / (np.cos(off) * friction + factor * np.sin(off))


@pytest.mark.parametrize(("acts", "plunge"), [("active", 48.0), ("active", 60.0), ("passive", 50.0)])
def test_the_force_at_a_plunge_is_hoek_and_brays(acts, plunge) -> None:
    """A passive anchor pulls with its capacity divided by the factor."""
    row = sk.support(sk.load(CRACKED), 1.5, toward=f"0/{plunge}", acts=acts).crest[0]
    expected = by_hand(CRACKED, plunge, 1.5) * (1.5 if acts == "passive" else 1.0)
    assert row.which == "given"
    assert row.closed_form.force == pytest.approx(expected, rel=1e-6)
    assert row.pre_ie.force == pytest.approx(expected, rel=1e-5)
    assert row.use_kn * row.spacing == pytest.approx(200.0)


@pytest.mark.parametrize(("design", "fos"), [(CRACKED, 1.5), (PRESSED, 1.2)])
def test_the_best_plunge_is_the_least_of_a_dense_sweep_of_the_formula(design, fos) -> None:
    best = sk.support(sk.load(design), fos, acts="active").crest[-1]
    low, high = best.plunges
    plunges = np.linspace(low, high, 100_001)
    forces = by_hand(design, plunges, fos)
    forces[forces <= 0.0] = np.inf  # too steep: they drive more than they press
    assert best.closed_form.force == pytest.approx(float(forces.min()), rel=1e-6)
    assert best.toward.plunge_deg == pytest.approx(float(plunges[forces.argmin()]), abs=2e-3)


def test_the_best_plunge_is_hoek_and_brays_where_it_crosses_the_plane() -> None:
    best = sk.support(sk.load(PRESSED), 1.2, acts="active").crest[-1]
    expected = math.degrees(math.atan(math.tan(math.radians(45.0)) / 1.2)) - 20.0
    assert best.plunges[0] < expected < best.plunges[1]
    assert best.toward.plunge_deg == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize("upper", [0.0, 10.0])
def test_the_flattest_is_hardly_steeper_than_the_upper_slope(upper) -> None:
    """By hand: it crosses the crack and then the plane, where rock hangs on it as before the crack."""
    design = CRACKED | {"slope": {"face": "60/180", "height": 12, "upper": f"{upper}/180"}}
    best = sk.support(sk.load(design), 1.9, acts="active").crest[-1]
    assert best.plunges[0] == pytest.approx(0.1 - upper, abs=0.1 + 1e-9)
    behind = 12.0 / math.tan(math.radians(35.0)) - 12.0 / math.tan(math.radians(60.0))
    assert best.crosses > sk.run(design).geometry.crack_distance_m
    assert upper or best.crosses == pytest.approx(behind, rel=0.01)
    assert best.toward.plunge_deg == pytest.approx(best.plunges[0], abs=1e-3)
    # law of sines in the triangle of crest, toe and crossing: the face is 12 / sin 60 long
    at_toe, at_crest = math.radians(60.0 - 35.0), math.radians(180.0 - 60.0 - best.toward.plunge_deg)
    long = 12.0 / math.sin(math.radians(60.0)) * math.sin(at_toe) / math.sin(math.pi - at_toe - at_crest)
    assert best.crosses == pytest.approx(long, rel=1e-9)


def test_an_anchor_too_steep_holds_nothing() -> None:
    """At 85° it drives more than it presses; a passive one square to the plane, beyond 55°, is not drawn out."""
    assert by_hand(CRACKED, 85.0, 1.5) < 0.0
    for acts, plunge, code in (("active", 85.0, "E322"), ("passive", 60.0, "E323")):
        row = sk.support(sk.load(CRACKED), 1.5, toward=f"0/{plunge}", acts=acts).crest[0]
        assert (row.use_kn, row.closed_form.notice.code) == (None, code)


@pytest.mark.parametrize("acts", ["active", "passive"])
def test_put_back_it_meets_the_target(acts) -> None:
    row = sk.support(sk.load(CRACKED), 1.5, acts=acts).crest[-1]
    bolt = row.bolts[0]
    found = sk.run({**CRACKED, "support": {"bolts": [
        {"force": bolt.force_kn, "toward": str(bolt.toward), "acts": acts, "head": list(bolt.head_m),
         "length": bolt.length_m}]}})  # fmt: skip
    assert row.reached
    assert row.yaml
    assert 1.5 <= min(found.fos.limit, found.fos.closed_form) < 1.5005


def test_forces_grow_with_the_square_of_lengths() -> None:
    """Per metre of slope, without cohesion."""
    one = sk.support(sk.load(PRESSED), 1.2, acts="active").crest[-1]
    large = PRESSED | {"slope": {"face": "60/180", "height": 36}, "water": {"pressures": [225]}}
    other = sk.support(sk.load(large), 1.2, acts="active").crest[-1]
    assert other.use_kn == pytest.approx(9.0 * one.use_kn, rel=1e-6)
    assert other.crosses == pytest.approx(3.0 * one.crosses, rel=1e-4)


def test_limits_of_plunge_capacity_and_length_are_judged() -> None:
    design = sk.load(CRACKED)
    flat = sk.support(design, 1.5, acts="active", plunge="-20,-5").crest[0]
    assert (flat.toward, flat.use_kn, [notice.code for notice in flat.notices]) == (None, None, ["E392"])
    steep = sk.support(design, 1.5, acts="active", plunge="50,70", spacing=4, length=6).crest[0]
    assert steep.toward.plunge_deg == pytest.approx(50.0)
    assert {notice.code for notice in steep.notices} == {"E327", "E393"}
    assert not steep.reached
    assert steep.yaml is None


def test_a_crack_in_the_face_leaves_no_crest_and_a_wedge_has_none() -> None:
    found = sk.support(sk.load(CRACKED | {"crack": {"distance": -2.0, "water": 1.0}}), 1.9, acts="active")
    assert found.crest == ()
    assert "the crest is no part of the block" in str(found.sheet)
    wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
    assert "crest" not in sk.support(sk.load(wedge), 1.6, acts="active").to_dict()
    with pytest.raises(DesignError, match="E321"):
        sk.support(sk.load(CRACKED), 1.5, plunge="a")
