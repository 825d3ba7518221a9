"""What holds for every wedge (STYLE.md §7): turn it, mirror it, move it, scale it, and the answer stays."""

import math
from functools import cache

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

import slopekit as sk
from slopekit.result import Result
from tests.properties.changes import swing
from tests.support import random_wedge

#: Random wedges of every kind: they slide on both joints or on one, turn, topple; with water, bolts of both sorts, an
#: earthquake; moments govern half of them.
seeds = st.sampled_from((0, 1, 4, 5, 7, 8, 10, 11, 12, 13, 15, 16, 20, 22, 23, 25))
quick = settings(
    max_examples=6, deadline=None, derandomize=True, phases=(Phase.explicit, Phase.generate)
)


def wedge_of(seed: int) -> dict:
    return random_wedge(np.random.default_rng(seed))


@cache
def analysed(seed: int) -> Result:
    """One of them as it is, once for all tests."""
    return sk.wedge(**wedge_of(seed))


def turned(plane, by: float):
    return (plane[0], (plane[1] + by) % 360.0)


def mirrored(plane):
    return (plane[0], (-plane[1]) % 360.0)


def assert_same(one, other, rel: float = 1e-7) -> None:
    assert one.status == other.status
    for a, b in ((one.fos.limit, other.fos.limit), (one.fos.closed_form, other.fos.closed_form)):
        if a is None:
            assert b is None
        elif one.moments_govern:
            # partly opened joints take discrete node pairs: equal only as far as the passes settle
            assert b == pytest.approx(a, rel=1e-3 + swing(one, other))
        else:
            assert b == pytest.approx(a, rel=rel)


@pytest.mark.slow
@quick
@given(seed=seeds)
def test_map_coordinates_change_no_digit_beyond_1e_9(seed) -> None:
    wedge = wedge_of(seed)
    assert_same(analysed(seed), sk.wedge(**wedge, origin=(5e5, 4e6, 1e3)), rel=1e-9)


@quick
@given(seed=seeds)
def test_forces_balance_across_the_slide(seed) -> None:
    """On both joints: what the normal forces push and what drives, minus the friction, adds up to the load."""
    wedge = {**wedge_of(seed), "bolts": None, "seismic": None, "water": None}
    result = sk.wedge(**wedge)
    if result.status != "slides_on_both" or result.moments_govern:
        return
    joints = [np.asarray(plane) for plane in wedge["dips"]]
    normals = [
        np.array([math.sin(d) * math.sin(a), math.sin(d) * math.cos(a), math.cos(d)])
        for d, a in np.radians(joints)
    ]
    pushes = sum(
        result.forces.normal[name] * n for name, n in zip(("J1", "J2"), normals, strict=True)
    )
    left = pushes - np.array([0.0, 0.0, result.forces.weight])
    along = result.limit_state.mechanism.displacement
    assert left @ along == pytest.approx(result.forces.driving, rel=1e-8)
    assert np.abs(left - (left @ along) * along).max() < 1e-8 * result.forces.weight


def strong(wedge: dict, by: float) -> dict:
    """c, tan φ and the pull of passive bolts multiplied."""
    phi = [math.degrees(math.atan(by * math.tan(math.radians(angle)))) for angle in wedge["phi"]]
    bolts = [
        {**bolt, "force": bolt["force"] * (by if bolt["acts"] == "passive" else 1.0)}
        for bolt in wedge.get("bolts", [])
    ]
    return {**wedge, "c": [by * c for c in wedge["c"]], "phi": phi, "bolts": bolts}


@quick
@given(seed=seeds)
def test_strength_divided_by_the_limit_is_just_enough(seed) -> None:
    """With passive bolts too; and the static bound and the closed form are divided with it."""
    wedge, one = wedge_of(seed), analysed(seed)
    if one.fos.limit is None or not 0.05 < one.fos.limit < 20.0:
        return
    weaker = strong(wedge, 1.0 / one.fos.limit)
    if not all(2.0 < angle < 89.0 for angle in weaker["phi"]):  # less reads as radians
        return
    other = sk.wedge(**weaker)
    assert other.status == one.status
    rel = 1e-3 + swing(one, other) if one.moments_govern else 1e-7
    assert other.fos.limit == pytest.approx(1.0, rel=rel)
    if one.fos.static_bound is not None and other.fos.static_bound is not None:
        bound = other.fos.static_bound * one.fos.limit
        assert bound == pytest.approx(
            one.fos.static_bound, rel=1e-6
        )  # the bracket of λ is 1e-7 of it wide
    if one.fos.closed_form and not one.moments_govern:
        assert other.fos.closed_form * one.fos.limit == pytest.approx(one.fos.closed_form, rel=1e-7)


@quick
@given(seed=seeds, which=st.integers(0, 1), more=st.floats(1.01, 1.5))
def test_more_strength_never_lowers_the_factor_nor_the_bound(seed, which, more) -> None:
    wedge = wedge_of(seed)
    other = {**wedge, "c": list(wedge["c"]), "phi": list(wedge["phi"])}
    other["c"][which] *= more
    other["phi"][which] = min(more * other["phi"][which], 60.0)
    one, two = analysed(seed), sk.wedge(**other)
    if one.fos.limit and two.fos.limit:
        allowed = 1e-3 + swing(one, two) if one.moments_govern or two.moments_govern else 1e-7
        assert two.fos.limit >= one.fos.limit * (1.0 - allowed)
    if one.fos.static_bound is not None and two.fos.static_bound is not None:
        assert two.fos.static_bound >= one.fos.static_bound * (1.0 - 1e-6)


@quick
@given(seed=seeds, to=st.floats(0.0, 360.0), by=st.floats(1e-3, 1e3))
def test_in_the_mirror_turned_of_any_size_and_twice_as_heavy_with_cohesion_pressures_and_bolts_to_match(
    seed, to, by
) -> None:
    """One analysis for all: what any of them did to the factor would show."""
    wedge, times = wedge_of(seed), 2.0 * by
    other = {**wedge, "height": by * wedge["height"], "unit_weight": 2.0 * wedge["unit_weight"]}
    other["dips"] = [turned(mirrored(plane), to) for plane in wedge["dips"]]
    other |= {key: turned(mirrored(wedge[key]), to) for key in ("face", "upper")}
    other["c"] = [times * c for c in wedge["c"]]
    if "water" in wedge:
        other["water"] = [times * pressure for pressure in wedge["water"]]
    other["bolts"] = [
        {
            **bolt,
            "force": 2.0 * by**3 * bolt["force"],
            "toward": ((to - bolt["toward"][0]) % 360.0, bolt["toward"][1]),
        }
        for bolt in wedge.get("bolts", [])
    ]
    one, two = analysed(seed), sk.wedge(**other)
    assert_same(one, two)
    assert two.geometry.volume_m3 == pytest.approx(by**3 * one.geometry.volume_m3, rel=1e-9)


@quick
@given(seed=seeds)
def test_the_joints_the_other_way_round(seed) -> None:
    """The height is that of the crest above the trace of the first joint."""
    wedge, one = wedge_of(seed), analysed(seed)
    corners = one.geometry.corners_m
    other = {
        **wedge,
        "dips": wedge["dips"][::-1],
        "c": wedge["c"][::-1],
        "phi": wedge["phi"][::-1],
        "height": float(corners["crest_J2"][2] - corners["toe"][2]),
    }
    if "water" in wedge:
        other["water"] = wedge["water"][::-1]
    two = sk.wedge(**other)
    swapped = {"slides_on_J1": "slides_on_J2", "slides_on_J2": "slides_on_J1"}
    assert two.status == swapped.get(one.status, one.status)
    assert two.geometry.volume_m3 == pytest.approx(one.geometry.volume_m3, rel=1e-9)
    if one.fos.limit is not None:
        rel = 1e-3 + swing(one, two) if one.moments_govern else 1e-7
        assert two.fos.limit == pytest.approx(one.fos.limit, rel=rel)


@quick
@given(seed=seeds, pull=st.floats(0.01, 0.3))
def test_a_passive_bolt_never_lowers_the_factor(seed, pull) -> None:
    """Drawn out it pulls against the movement, else not at all: where it also presses on the joints the more."""
    wedge = wedge_of(seed)
    wedge.pop("bolts", None)
    one = sk.wedge(**wedge)
    if (
        one.fos.limit is None
        or one.moments_govern
        or one.status not in ("slides_on_both", "slides_on_J1")
    ):
        return
    along = one.limit_state.mechanism.displacement
    trend = math.degrees(math.atan2(-along[0], -along[1])) % 360.0
    plunge = math.degrees(math.asin(max(-1.0, min(1.0, along[2]))))
    bolt = {"force": pull * one.forces.weight, "toward": (trend, plunge), "acts": "passive"}
    two = sk.wedge(**wedge, bolts=[bolt])
    if two.fos.limit is not None and not two.moments_govern:
        assert two.fos.limit >= one.fos.limit * (1.0 - 1e-7)
