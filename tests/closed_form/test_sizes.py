"""Sizes of what fails in a bench, on arrays, against other ways to the same numbers.

Independent sources: manifold3d's cut through `slopekit.geometry`, the corners of `plane_section`, polygons of columns
drawn one by one with their centroids by the shoelace formula; laws of scaling.
"""

import math

import numpy as np
import pytest

from slopekit.closed_form.plane import PlaneArrays, plane_failures
from slopekit.closed_form.sizes import (
    column_sizes,
    largest_scale,
    plane_sizes,
    wedge_sizes,
)
from slopekit.closed_form.wedge import WedgeArrays, hoek_bray_wedges
from slopekit.core.errors import GeometryError
from slopekit.core.orientation import Plane
from slopekit.geometry.sections.section import plane_section
from tests.closed_form.extents import block_extents
from tests.geometry.manifold_wedge import cut_wedge, wedge_rock_mass

CUT = 1e-9  # manifold's predicates round to 1e-12 of the body; a thin wedge loses three digits


def random_planes(count: int, seed: int) -> np.ndarray:
    """Joints, face and upper slope (8, count): many of them cut a wedge."""
    rng = np.random.default_rng(seed)
    low = [30, 60, 30, 180, 55, 140, 0, 100]
    high = [80, 170, 80, 300, 89, 220, 20, 260]
    return rng.uniform(low, high, (count, 8)).T


def test_wedge_against_the_cut_body() -> None:
    """Volume, areas, edges, width, setback and height of random wedges against the corners that manifold cuts."""
    planes, height = random_planes(120, 7), 12.5
    found = wedge_sizes(*planes, height)
    compared = 0
    for k, (d1, t1, d2, t2, df, tf, du, tu) in enumerate(planes.T.tolist()):
        joints = np.array([Plane(d1, t1).normal(), Plane(d2, t2).normal()])
        try:
            rock = wedge_rock_mass(joints, Plane(df, tf).normal(), Plane(du, tu).normal(), height)
            block = cut_wedge(rock)
        except GeometryError:
            assert math.isnan(found.volume_m3[k])
            continue
        compared += 1
        edge = np.cross(Plane(df, tf).normal(), Plane(du, tu).normal())
        across = np.array([-edge[1], edge[0], 0.0]) / math.hypot(edge[0], edge[1])
        behind = abs((block.corners - rock.crest1) @ across)[
            np.isclose(block.corners @ Plane(du, tu).normal(), rock.offsets[3])
        ].max()
        expected = {
            "volume_m3": block.volume,
            "setback_m": behind,
            "height_m": np.ptp(block.corners[:, 2]),
            "face_width_m": math.dist(rock.crest1, rock.crest2),
            "trace1_m": math.dist(rock.crest1, rock.toe),
            "trace2_m": math.dist(rock.crest2, rock.toe),
            "upper_trace1_m": math.dist(rock.crest1, rock.back),
            "upper_trace2_m": math.dist(rock.crest2, rock.back),
            "line_m": math.dist(rock.back, rock.toe),
        }
        for name, value in expected.items():
            assert getattr(found, name)[k] == pytest.approx(value, rel=CUT), name
    assert compared > 40


def test_height_up_the_face() -> None:
    """A level crest: H straight up the face is the height of every trace, a dipping one brings them apart."""
    planes = random_planes(50, 3)
    planes[6:] = 0.0
    by_trace, up = wedge_sizes(*planes, 10.0), wedge_sizes(*planes, 10.0, up_the_face=True)
    np.testing.assert_allclose(by_trace.volume_m3, up.volume_m3, rtol=1e-12)
    tilted = wedge_sizes(45, 135, 45, 225, 60, 180, 20, 90, 10.0, up_the_face=True)
    # the crest straight up the face lies between the two traces, one of which climbs higher than it
    steep = wedge_sizes(45, 135, 45, 225, 60, 180, 20, 90, 10.0)
    assert tilted.volume_m3[0] != pytest.approx(steep.volume_m3[0], rel=1e-3)


@pytest.mark.parametrize("by", [0.5, 3.0])
def test_scaling_laws(by: float) -> None:
    """Lengths grow with the height, areas with its square, volumes with its cube; c = 0 and dry: F stays."""
    planes, heights = random_planes(200, 11), np.linspace(2.0, 30.0, 200)
    one, other = wedge_sizes(*planes, heights), wedge_sizes(*planes, heights * by)
    scaled = one.scaled(by)
    for name, power in {"setback_m": 1, "line_m": 1, "volume_m3": 3}.items():
        np.testing.assert_allclose(getattr(other, name), getattr(one, name) * by**power, rtol=1e-12)
        np.testing.assert_allclose(getattr(scaled, name), getattr(other, name), rtol=1e-12)

    def wedges(height: np.ndarray) -> WedgeArrays:
        names = ("joint1", "joint2", "face", "upper")
        given = {
            f"{name}_dip{way}_deg": planes[2 * k + side]
            for k, name in enumerate(names)
            for side, way in enumerate(("", "_direction"))
        }
        return WedgeArrays(
            **given,
            height_m=height,
            cohesion1_kpa=0.0,
            cohesion2_kpa=0.0,
            friction1_deg=30.0,
            friction2_deg=25.0,
            unit_weight_kn_m3=26.0,
        )

    small, large = hoek_bray_wedges(wedges(heights)), hoek_bray_wedges(wedges(heights * by))
    np.testing.assert_array_equal(small.outcome, large.outcome)
    np.testing.assert_allclose(small.factor, large.factor, rtol=1e-10)
    np.testing.assert_allclose(large.weight_kn, small.weight_kn * by**3, rtol=1e-10)
    np.testing.assert_allclose(one.volume_m3, small.volume_m3, rtol=1e-10)
    np.testing.assert_allclose(one.line_m, np.linalg.norm(small.line_m, axis=0), rtol=1e-10)
    blocks, larger = (plane_sizes(35.0, 60.0, 5.0, height) for height in (8.0, 8.0 * by))
    assert larger.area_m2[0] == pytest.approx(blocks.area_m2[0] * by**2, rel=1e-12)


def test_joints_that_end() -> None:
    """A wedge made smaller until its joints are long enough has edges that are no longer than they."""
    planes = random_planes(200, 5)
    whole = wedge_sizes(*planes, 15.0)
    reach = np.linspace(1.0, 30.0, 200)
    scale = largest_scale(whole, reach, 12.0)
    cut = whole.scaled(scale)
    there = ~np.isnan(scale)
    slack = np.minimum(reach - cut.longest1_m, 12.0 - cut.longest2_m)[there]
    assert slack.min() > -1e-9
    shorter = scale[there] < 1.0
    assert shorter.any()
    assert abs(slack[shorter]).max() < 1e-9


@pytest.mark.parametrize(("upper", "crack"), [(0.0, None), (12.0, None), (0.0, 3.0), (12.0, 2.0)])
def test_plane_against_the_corners_of_the_section(upper: float, crack: float | None) -> None:
    """Area, setback and length against the outline of `plane_section`; the weight against `plane_failures`."""
    outline = np.array(plane_section(35.0, 65.0, upper, 12.0, crack_distance=crack).outline)
    found = plane_sizes(35.0, 65.0, upper, 12.0, crack)
    x, z = outline.T
    area = abs(np.dot(x, np.roll(z, -1)) - np.dot(z, np.roll(x, -1))) / 2.0
    crest = -12.0 / math.tan(math.radians(65.0))
    assert found.area_m2[0] == pytest.approx(area, rel=1e-12)
    assert found.setback_m[0] == pytest.approx(crest - x.min(), rel=1e-12)
    assert found.height_m[0] == pytest.approx(np.ptp(z), rel=1e-12)
    block = plane_failures(
        PlaneArrays(
            face_dip_deg=65.0,
            upper_dip_deg=upper,
            plane_dip_deg=35.0,
            height_m=12.0,
            cohesion_kpa=0.0,
            friction_deg=30.0,
            unit_weight_kn_m3=26.0,
            crack_distance_m=crack,
        )
    )
    assert found.area_m2[0] * 26.0 == pytest.approx(block.weight_kn[0], rel=1e-12)
    assert found.length_m[0] == pytest.approx(block.length_m[0], rel=1e-12)


@pytest.mark.parametrize(("plane", "face"), [(70.0, 60.0), (-10.0, 60.0), (60.0, 60.0)])
def test_no_block_on_such_a_plane(plane: float, face: float) -> None:
    """Steeper than the face, into the slope, along the face: nothing is free to slide."""
    assert np.isnan(plane_sizes(plane, face, 0.0, 10.0).setback_m[0])


def drawn_columns(
    joint: float, base: float, face: float, height: float, width: float
) -> tuple[int, float, float]:
    """Columns drawn as polygons one behind the other: how many lean over their toe, their setback, their area."""
    dip, climb = math.radians(joint), math.tan(math.radians(base))
    crest = height / math.tan(math.radians(face))
    apart = width / math.sin(dip)

    def foot(behind: float) -> np.ndarray:
        """Where the side whose top lies so far behind the crest meets the base: x into the rock, z up."""
        top = np.array([crest + behind, height])
        down = np.array([math.cos(dip), -math.sin(dip)])  # into the rock as it goes down
        way = (top[1] - top[0] * climb) / (down[0] * climb - down[1])
        return top + down * way

    count, area = 0, 0.0
    while True:
        outer, inner = foot(count * apart), foot((count + 1) * apart)
        side = np.array([crest + count * apart, height]) - outer
        # a parallelogram on the base, its sides as high as the outer one
        centre = outer + (side + (inner - outer)) / 2.0
        if side[1] <= 0.0 or centre[0] >= outer[0]:
            return count, count * apart, area
        corners = np.array(
            [outer, inner, [crest + (count + 1) * apart, height], [crest + count * apart, height]]
        )
        x, z = corners.T
        area += abs(np.dot(x, np.roll(z, -1)) - np.dot(z, np.roll(x, -1))) / 2.0
        count += 1


@pytest.mark.parametrize(
    ("joint", "base", "width"),
    [(60.0, 30.0, 1.0), (70.0, 30.0, 1.0), (75.0, 25.0, 0.7), (60.0, 30.0, 9.0)],
)
def test_columns_against_polygons(joint: float, base: float, width: float) -> None:
    """How many columns turn over on their own, the setback and the area that they leave."""
    count, setback, area = drawn_columns(joint, base, 75.0, 15.0, width)
    found = column_sizes(joint, base, 75.0, 15.0, width)
    assert found.columns[0] == count
    assert found.setback_m[0] == pytest.approx(setback, rel=1e-12)
    assert found.area_m2[0] == pytest.approx(area, rel=1e-12)


def test_slenderness_is_that_of_goodman_and_bray() -> None:
    """On a base square to the sides the column of height y just turns over where Δx / y = tan ψ_b."""
    found = column_sizes(55.0, 35.0, 80.0, 20.0, 2.0)
    expected = found.height_m[0] * math.tan(math.radians(35.0)) / 2.0
    assert found.slenderness[0] == pytest.approx(expected, rel=1e-12)


def test_extents_of_the_corners_of_a_wedge() -> None:
    """The corners of a wedge give the setback and the width that its formulas give."""
    found = wedge_sizes(50, 130, 60, 235, 70, 180, 0, 0, 10.0)
    joints = np.array([Plane(50, 130).normal(), Plane(60, 235).normal()])
    rock = wedge_rock_mass(joints, Plane(70, 180).normal(), Plane(0, 0).normal(), 10.0)
    extents = block_extents(rock.corners, 180.0, rock.crest1)
    assert extents.setback_m == pytest.approx(found.setback_m[0], rel=1e-12)
    assert extents.face_width_m == pytest.approx(found.face_width_m[0], rel=1e-12)
    assert extents.height_m == pytest.approx(found.height_m[0], rel=1e-12)
