"""Blocks in section against corners computed by hand, and Simpson's rule along their plane."""

import math

import numpy as np
import pytest

from slopekit.core.errors import GeometryError
from slopekit.geometry.sections.section import footing_section, line_pairs, plane_section


def by_hand(plane: float, face: float, upper: float, height: float, distance: float | None):
    """Area and centroid of the block from lines that are intersected with NumPy, toe at the origin, x out."""
    tp, tf, tu = (math.tan(math.radians(dip)) for dip in (plane, face, upper))
    crest = np.array([-height / tf, height])
    if distance is None:
        x = (height - tu * -crest[0]) / (tp - tu)
        ring = [(0.0, 0.0), tuple(crest), (-x, x * tp)]
    else:
        at = crest[0] - distance
        top = height + distance * tu if distance >= 0.0 else -at * tf
        ring = [(0.0, 0.0), *([tuple(crest)] if distance > 0.0 else []), (at, top), (at, -at * tp)]
    area = cx = cz = 0.0
    for (x0, z0), (x1, z1) in zip(ring, ring[1:] + ring[:1], strict=True):
        cross = (x0 * z1 - x1 * z0) / 2.0
        area, cx, cz = area + cross, cx + cross * (x0 + x1) / 3.0, cz + cross * (z0 + z1) / 3.0
    return abs(area), np.array([cx, cz]) / area, ring


@pytest.mark.parametrize(
    ("plane", "face", "upper"), [(35, 60, 0), (20, 85, 10), (50, 55, -15), (5, 30, 4)]
)
@pytest.mark.parametrize("distance", [None, 0.5, -0.3, 0.0])
def test_area_centroid_and_corners(plane, face, upper, distance) -> None:
    """To rounding: corners are computed from the planes themselves."""
    section = plane_section(plane, face, upper, 12.0, crack_distance=distance)
    area, centroid, ring = by_hand(plane, face, upper, 12.0, distance)
    assert section.block.volume == pytest.approx(area, rel=1e-10)
    assert section.block.centroid[[0, 2]] == pytest.approx(centroid, rel=1e-9)
    assert len(section.outline) == len(ring)
    for corner in ring:
        assert np.abs(section.outline - corner).sum(axis=1).min() < 1e-9
    assert section.length == pytest.approx(math.hypot(*ring[-1]), rel=1e-10)
    if distance is not None:
        assert section.crack_depth == pytest.approx(ring[-2][1] - ring[-1][1], rel=1e-9)


def test_depth_and_distance_are_the_same_crack() -> None:
    """Depth 4.35 m lies (12 (1 - cot 60 tan 35) - 4.35) / tan 35 behind the crest."""
    behind = (
        12.0 - 12.0 * math.tan(math.radians(35)) / math.tan(math.radians(60)) - 4.35
    ) / math.tan(math.radians(35))
    one, two = (
        plane_section(35, 60, 0, 12.0, crack_depth=4.35),
        plane_section(35, 60, 0, 12.0, crack_distance=behind),
    )
    assert one.crack_distance == pytest.approx(behind, rel=1e-12)
    assert one.block.volume == pytest.approx(two.block.volume, rel=1e-12)


def test_an_upper_slope_steeper_than_the_plane_needs_a_crack() -> None:
    section = plane_section(20, 60, 25, 12.0, crack_distance=8.0)
    assert section.block.volume == pytest.approx(by_hand(20, 60, 25, 12.0, 8.0)[0], rel=1e-10)


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        ((60, 60, 0, 12), "E203"),
        ((61, 60, 0, 12), "E203"),
        ((0, 60, 0, 12), "E204"),
        ((-10, 60, 0, 12), "E204"),
        ((20, 60, 25, 12), "E205"),
        ((20, 60, 20, 12), "E205"),
        ((35, 60, 60, 12), "E209"),
        ((35, 60, 0, 12, 8.0), "E207"),
        ((35, 60, 0, 12, 4.35, 9.0), "E207"),
        ((35, 60, 0, 12, None, 10.3), "E207"),
        ((35, 60, 0, 12, None, -7.0), "E207"),
    ],
)
def test_faults(arguments, code) -> None:
    with pytest.raises(GeometryError) as caught:
        plane_section(*arguments)
    assert caught.value.codes == (code,)


@pytest.mark.parametrize(("upper", "said"), [(0, "the deepest has"), (40, "the shallowest has")])
def test_how_deep_a_crack_may_be(upper, said) -> None:
    """Behind the crest the joint rises towards the upper slope, or falls away below a steeper one."""
    depth = 12.0 * (
        1.0 - math.tan(math.radians(35)) / math.tan(math.radians(60))
    )  # below the crest
    plane_section(35, 60, upper, 12, depth + (0.1 if upper else -0.1))
    with pytest.raises(GeometryError, match=f"deep: {said} {depth:.6g} m"):
        plane_section(35, 60, upper, 12, depth + (-0.1 if upper else 0.1))


@pytest.mark.parametrize("elements", [1, 2, 5])
def test_simpson_along_the_plane(elements) -> None:
    """Exact to degree three, ends included: forces, moments and hinges."""
    section = plane_section(35, 60, 0, 12.0)
    pairs = line_pairs(section, elements)
    along = pairs.points @ np.array([-math.cos(math.radians(35)), 0.0, math.sin(math.radians(35))])
    assert len(pairs) == 2 * elements + 1
    for power in range(4):
        exact = section.length ** (power + 1) / (power + 1)
        assert pairs.control_areas @ along**power == pytest.approx(exact, rel=1e-12)
    assert pairs.normals[0] == pytest.approx(
        [math.sin(math.radians(35)), 0.0, math.cos(math.radians(35))], rel=1e-12
    )
    assert pairs.points[0] == pytest.approx(np.zeros(3))
    assert pairs.points[-1] == pytest.approx(section.bottom)


@pytest.mark.parametrize("dip", [5.0, 45.0, 80.0])
def test_the_block_under_a_footing(dip) -> None:
    """A right triangle: L² sin δ cos δ / 2."""
    section = footing_section(dip, 7.0)
    a = math.radians(dip)
    assert section.block.volume == pytest.approx(49.0 * math.sin(a) * math.cos(a) / 2.0, rel=1e-10)
    assert section.length == pytest.approx(7.0, rel=1e-12)
    assert section.bottom == pytest.approx([-7.0 * math.cos(a), 0.0, 7.0 * math.sin(a)], abs=1e-12)
