"""What holds for every plane, footing and curved surface (STYLE.md §7)."""

import math

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

import slopekit as sk
from tests.properties.changes import swing
from tests.scenes import PAPER, SLOPE, run

quick = settings(
    max_examples=8, deadline=None, derandomize=True, phases=(Phase.explicit, Phase.generate)
)
azimuths = st.floats(0.0, 360.0, exclude_max=True)


@st.composite
def planes(draw):
    face = draw(st.floats(35.0, 88.0))
    plane = draw(st.floats(10.0, face - 5.0))
    return {
        "face": face,
        "plane": plane,
        "upper": draw(st.floats(0.0, min(15.0, plane - 3.0))),
        "height": draw(st.floats(2.0, 60.0)),
        "c": draw(st.floats(0.0, 80.0)),
        "phi": draw(st.floats(5.0, 45.0)),
        "fill": draw(st.sampled_from([0.0, 0.3, 0.7])),
        "crack": draw(st.sampled_from([None, 0.1, 0.5])),
        "seismic": draw(st.sampled_from([0.0, 0.08])),
    }


def analyse(
    p: dict, azimuth: float = 180.0, scale: float = 1.0, reduced: float = 1.0, weight: float = 1.0
):
    height = p["height"] * scale
    phi = math.degrees(math.atan(math.tan(math.radians(p["phi"])) / reduced))
    more = {}
    if p["crack"] is not None:
        behind = height * (
            1.0 / math.tan(math.radians(p["plane"])) - 1.0 / math.tan(math.radians(p["face"]))
        )
        more["crack"] = {"distance": p["crack"] * behind * 0.8}
    if p["fill"]:
        more["water"] = {"mode": "full", "fill": p["fill"]}
    if p["seismic"]:
        more["loads"] = {"seismic": p["seismic"]}
    c = p["c"] * scale * weight / reduced
    return sk.run(
        {
            "slopekit": 1,
            "kind": "plane",
            "rock": {"unit_weight": 25.0 * weight},
            "slope": {
                "face": [p["face"], azimuth],
                "upper": [p["upper"], azimuth],
                "height": height,
            },
            "joints": {"J1": {"plane": [p["plane"], azimuth]}},
            "strength": {"s": {"c": c, "phi": phi}},
            **more,
        }
    )


def same(one, other, rel=1e-8) -> None:
    assert other.status == one.status
    if one.fos.limit is None:
        assert other.fos.limit is None
    else:
        # where moments open part of the plane the passes settle to 1e-4 of their own way
        assert other.fos.limit == pytest.approx(
            one.fos.limit, rel=1e-3 if one.moments_govern else rel
        )


@quick
@given(
    plane=planes(),
    azimuth=azimuths,
    scale=st.floats(1e-4, 1e3),
    which=st.sampled_from(["c", "phi"]),
)
def test_planes(plane, azimuth, scale, which) -> None:
    """Turned, in the mirror (east for west), of any size with its cohesion, twice as heavy; with strength / F, F is 1.

    Its bound is never below it, pairs push only, and more strength never lowers its factor.
    """
    one = analyse(plane)
    if plane["c"] * scale <= 1e5:
        same(one, analyse(plane, azimuth, scale))
    same(one, analyse(plane, -azimuth % 360.0))
    dry = plane | {"fill": 0.0}  # the unit weight of water is its own
    same(analyse(dry) if plane["fill"] else one, analyse(dry, weight=2.0))
    if one.fos.limit and not one.moments_govern and 0.3 < one.fos.limit < 5.0:
        assert analyse(plane, reduced=one.fos.limit).fos.limit == pytest.approx(1.0, rel=1e-8)
    assert one.limit_state.node_pairs.normal_kn.min() >= 0.0
    assert one.limit_state.node_pairs.control_area_m2.sum() == pytest.approx(
        one.geometry.areas_m2["J1"], rel=1e-12
    )
    if one.fos.limit and one.fos.static_bound:
        assert one.fos.limit <= one.fos.static_bound * (1.0 + 1e-9)
    if not one.moments_govern:
        assert one.agree is not False
    other = analyse(plane | {which: plane[which] * 1.1 + 0.1})
    if one.fos.limit and other.fos.limit:
        # where moments open part of the plane the passes settle to 1e-4 of their own way
        allowed = 1e-3 if one.moments_govern or other.moments_govern else 1e-8
        assert other.fos.limit >= one.fos.limit * (1.0 - allowed)


@quick
@given(
    load=st.floats(10.0, 1e5),
    dip=st.floats(5.0, 85.0),
    length=st.floats(0.5, 50.0),
    share=st.floats(0.05, 0.95),
    phi=st.floats(1.7, 40.0),
)
def test_footings(load, dip, length, share, phi) -> None:
    """F > 0 agrees with two forces; twice the load and cohesion leaves it; more pairs and another size leave it."""

    def footing(by=1.0, pairs=9, size=1.0, reduced=1.0):
        friction = math.degrees(math.atan(math.tan(math.radians(phi)) / reduced))
        return sk.run(
            {
                "slopekit": 1,
                "kind": "footing",
                "footing": {
                    "load": by * size * load,
                    "at": size * share * length * math.cos(math.radians(dip)),
                },
                "weak_plane": {"dip": dip, "length": size * length, "pairs": pairs},
                "strength": {"s": {"c": by * 50.0 / reduced, "phi": friction}},
            }
        )

    one = footing()
    assert one.agree is not False
    if one.fos.limit is None or one.moments_govern:
        return
    assert footing(by=2.0).fos.limit == pytest.approx(one.fos.limit, rel=1e-8)
    assert footing(pairs=21).fos.limit == pytest.approx(one.fos.limit, rel=1e-8)
    assert footing(size=30.0).fos.limit == pytest.approx(one.fos.limit, rel=1e-8)
    if (
        0.01 < one.fos.limit < math.tan(math.radians(phi)) / math.tan(math.radians(2.0))
    ):  # less reads as radians
        assert footing(reduced=one.fos.limit).fos.limit == pytest.approx(1.0, rel=1e-8)
    assert one.limit_state.node_pairs.normal_kn.min() >= 0.0
    assert one.limit_state.node_pairs.control_area_m2.sum() == pytest.approx(length, rel=1e-12)
    if one.fos.static_bound:
        assert one.fos.limit <= one.fos.static_bound * (1.0 + 1e-9)


@pytest.mark.slow
@settings(quick, max_examples=2)
@given(
    radius=st.floats(30.0, 60.0),
    wide=st.floats(0.4, 2.0),
    aside=st.floats(-1e3, 1e3),
    c=st.floats(5.0, 50.0),
    phi=st.floats(2.0, 40.0),
)
def test_surfaces_mirrored_moved_and_scaled(radius, wide, aside, c, phi) -> None:
    """To 1e-6: a mirrored octahedron is the same, a moved one but for rounding."""
    slip = {**PAPER, "radii": [radius, wide * radius, radius], "edge": 20}
    one = run(slip, c=c, phi=phi)
    mirrored_and_large = run(
        {
            **slip,
            "centre": [-400, 10 * aside, 400],
            "radii": [10 * r for r in slip["radii"]],
            "edge": 200,
        },
        [[-10 * x, 10 * z] for x, z in SLOPE],
        c=10 * c,
        phi=phi,
    )
    heavy_on_the_map = run(
        {**slip, "centre": [5e5 + 40, 4e6 + aside, 1040]},
        [[x + 5e5, z + 1e3] for x, z in SLOPE],
        c=2 * c,
        phi=phi,
        unit_weight=2 * 21.56,
    )
    for other in (mirrored_and_large, heavy_on_the_map):
        same(one, other, 1e-6)
    if one.fos.limit and 0.1 < one.fos.limit < 10.0:
        factor = one.fos.limit
        weaker = run(
            slip, c=c / factor, phi=math.degrees(math.atan(math.tan(math.radians(phi)) / factor))
        )
        assert weaker.fos.limit == pytest.approx(1.0, rel=1e-6 + swing(one, weaker))
        assert run(slip, c=1.1 * c, phi=phi).fos.limit >= factor
    pairs = one.limit_state.node_pairs
    assert pairs.normal_kn.min() >= 0.0
    assert pairs.control_area_m2.min() > 0.0
    assert pairs.control_area_m2.sum() == pytest.approx(
        one.geometry.areas_m2["slip surface"], rel=1e-9
    )
    if one.fos.limit and one.fos.static_bound:
        assert np.nextafter(one.fos.static_bound, math.inf) >= one.fos.limit
