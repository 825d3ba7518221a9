"""What holds for every plane, footing and curved surface (STYLE.md §7)."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import slopekit as sk
from tests.scenes import PAPER, SLOPE, run

quick = settings(max_examples=15, deadline=None, derandomize=True)
azimuths = st.floats(0.0, 360.0, exclude_max=True)


@st.composite
def planes(draw):
    face = draw(st.floats(35.0, 88.0))
    plane = draw(st.floats(10.0, face - 5.0))
    return {
        "face": face, "plane": plane, "upper": draw(st.floats(0.0, min(15.0, plane - 3.0))),
        "height": draw(st.floats(2.0, 60.0)), "c": draw(st.floats(0.0, 80.0)), "phi": draw(st.floats(5.0, 45.0)),
        "fill": draw(st.sampled_from([0.0, 0.3, 0.7])), "crack": draw(st.sampled_from([None, 0.1, 0.5])),
        "seismic": draw(st.sampled_from([0.0, 0.08])),
    }  # fmt: skip


def analyse(p: dict, azimuth: float = 180.0, scale: float = 1.0, reduced: float = 1.0, strength=1.0):
    height = p["height"] * scale
    phi = math.degrees(math.atan(math.tan(math.radians(p["phi"])) / reduced))
    more = {}
    if p["crack"] is not None:
        behind = height * (1.0 / math.tan(math.radians(p["plane"])) - 1.0 / math.tan(math.radians(p["face"])))
        more["crack"] = {"distance": p["crack"] * behind * 0.8}
    if p["fill"]:
        more["water"] = {"mode": "full", "fill": p["fill"]}
    if p["seismic"]:
        more["loads"] = {"seismic": p["seismic"]}
    c = p["c"] * scale * strength / reduced
    return sk.run({
        "slopekit": 1, "kind": "plane", "rock": {"unit_weight": 25.0},
        "slope": {"face": [p["face"], azimuth], "upper": [p["upper"], azimuth], "height": height},
        "joints": {"J1": {"plane": [p["plane"], azimuth]}}, "strength": {"s": {"c": c, "phi": phi}}, **more,
    })  # fmt: skip


def same(one, other, rel=1e-8) -> None:
    assert other.status == one.status
    if one.fos.limit is None:
        assert other.fos.limit is None
    else:
        # where moments open part of the plane the passes settle to 1e-4 of their own way
        assert other.fos.limit == pytest.approx(one.fos.limit, rel=1e-3 if one.moments_govern else rel)


@quick
@given(plane=planes(), azimuth=azimuths)
def test_a_plane_turned_about_the_vertical(plane, azimuth) -> None:
    same(analyse(plane), analyse(plane, azimuth))


@quick
@given(plane=planes(), scale=st.floats(1e-4, 1e3))
def test_a_plane_of_any_size(plane, scale) -> None:
    """Cohesion grows with the size."""
    if plane["c"] * scale <= 1e5:
        same(analyse(plane), analyse(plane, scale=scale))


@quick
@given(plane=planes())
def test_a_plane_with_its_strength_divided_by_the_limit(plane) -> None:
    first = analyse(plane)
    if first.fos.limit and not first.moments_govern and 0.3 < first.fos.limit < 5.0:
        assert analyse(plane, reduced=first.fos.limit).fos.limit == pytest.approx(1.0, rel=1e-8)


@quick
@given(plane=planes())
def test_a_plane_never_stands_above_its_bound_and_pushes_only(plane) -> None:
    result = analyse(plane)
    assert result.node_pairs.normal_kn.min() >= 0.0
    assert result.node_pairs.control_area_m2.sum() == pytest.approx(result.geometry.areas_m2["J1"], rel=1e-12)
    if result.fos.limit and result.fos.static_bound:
        assert result.fos.limit <= result.fos.static_bound * (1.0 + 1e-9)
    if not result.moments_govern:
        assert result.agree is not False


@quick
@given(
    load=st.floats(10.0, 1e5), dip=st.floats(5.0, 85.0), length=st.floats(0.5, 50.0), share=st.floats(0.05, 0.95),
    phi=st.floats(1.7, 40.0),
)  # fmt: skip
def test_footings(load, dip, length, share, phi) -> None:
    """F > 0 agrees with two forces; twice the load and cohesion leaves it; more pairs leave it."""

    def footing(by=1.0, pairs=9):
        return sk.run({
            "slopekit": 1, "kind": "footing",
            "footing": {"load": by * load, "at": share * length * math.cos(math.radians(dip))},
            "weak_plane": {"dip": dip, "length": length, "pairs": pairs},
            "strength": {"s": {"c": by * 50.0, "phi": phi}},
        })  # fmt: skip

    one = footing()
    assert one.agree is not False
    if one.fos.limit is None or one.moments_govern:
        return
    assert footing(by=2.0).fos.limit == pytest.approx(one.fos.limit, rel=1e-8)
    assert footing(pairs=21).fos.limit == pytest.approx(one.fos.limit, rel=1e-8)


@settings(quick, max_examples=5)
@given(
    radius=st.floats(30.0, 60.0), wide=st.floats(0.4, 2.0), aside=st.floats(-1e3, 1e3), c=st.floats(5.0, 50.0),
    phi=st.floats(2.0, 40.0),
)  # fmt: skip
def test_surfaces_mirrored_moved_and_scaled(radius, wide, aside, c, phi) -> None:
    """To 1e-6: a mirrored octahedron is the same, a moved one but for rounding."""
    slip = {**PAPER, "radii": [radius, wide * radius, radius], "edge": 20}
    one = run(slip, c=c, phi=phi)
    mirrored = run({**slip, "centre": [-40, aside, 40]}, [[-x, z] for x, z in SLOPE], c=c, phi=phi)
    large = run(
        {**slip, "centre": [400, 0, 400], "radii": [10 * r for r in slip["radii"]], "edge": 200},
        [[10 * x, 10 * z] for x, z in SLOPE], c=10 * c, phi=phi,
    )  # fmt: skip
    for other in (mirrored, large):
        same(one, other, 1e-6)
    assert one.node_pairs.normal_kn.min() >= 0.0
    assert one.node_pairs.control_area_m2.min() > 0.0
    assert one.node_pairs.control_area_m2.sum() == pytest.approx(one.geometry.areas_m2["slip surface"], rel=1e-9)
    if one.fos.limit and one.fos.static_bound:
        assert np.nextafter(one.fos.static_bound, math.inf) >= one.fos.limit
