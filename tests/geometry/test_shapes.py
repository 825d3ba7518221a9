"""Slip surfaces as shapes: what the lifted triangles measure against formulas of whole bodies; prisms and sheets."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from slopekit.core.errors import GeometryError
from slopekit.geometry.solids.shapes import (
    END,
    SLIP,
    Cylinder,
    Ellipsoid,
    profile_prism,
    sheet_solid,
    smooth_normals,
)
from tests.scenes import ellipsoid_mesh, sheet

RULE = (
    ((1, 0, 0), 1 / 12),
    ((0, 1, 0), 1 / 12),
    ((0, 0, 1), 1 / 12),
    ((1 / 3, 1 / 3, 1 / 3), 3 / 4),
)


def volume_of(vertices, triangles) -> float:
    """Divergence theorem; below 0 where the triangles look inward."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return float(np.einsum("ni,ni->", a, np.cross(b, c)) / 6.0)


def measured(shape, level: int) -> tuple[float, float, np.ndarray]:
    """Area, volume and first moment of a whole shape from its lifted triangles."""
    body = shape.cutter(level)
    a, b, c = (body.vertices[body.triangles[body.face_kinds == SLIP][:, k]] for k in range(3))
    vectors = np.cross(b - a, c - a) / 2.0
    parts = [shape.lift(u * a + v * b + w * c, share * vectors) for (u, v, w), share in RULE]
    volume = volume_of(body.vertices, body.triangles) + sum(part.volumes.sum() for part in parts)
    return (
        sum(part.areas.sum() for part in parts),
        volume,
        sum(part.moments.sum(axis=0) for part in parts),
    )


def spheroid_area(radius: float, half_width: float) -> float:
    """2π ∫ρ ds over the meridian."""

    def slope(t: float) -> float:
        return radius * math.cos(t) * math.hypot(radius * math.sin(t), half_width * math.cos(t))

    return 2.0 * math.pi * quad(slope, -math.pi / 2, math.pi / 2, epsabs=1e-12)[0]


@pytest.mark.parametrize("radii", [(10, 10, 10), (40, 28, 40), (3, 30, 3)])
def test_a_whole_ellipsoid(radii) -> None:
    """Area by the meridian, volume 4/3 π abc; the error falls by 16 each time the edges halve (rule of degree two)."""
    shape = Ellipsoid(np.array(radii, dtype=float))
    errors = []
    for level in (3, 4):
        area, volume, moment = measured(shape, level)
        exact = 4.0 / 3.0 * math.pi * math.prod(radii)
        errors.append(
            (abs(area / spheroid_area(radii[0], radii[1]) - 1.0), abs(volume / exact - 1.0))
        )
        assert np.abs(moment).max() < 1e-9 * exact * max(radii)
    assert max(errors[1]) < 2e-5
    assert all(fine < coarse / 10.0 for coarse, fine in zip(*errors, strict=True))


def test_a_whole_cylinder() -> None:
    shape = Cylinder(7.0, 12.0)
    area, volume, moment = measured(shape, 4)
    assert area == pytest.approx(2.0 * math.pi * 7.0 * 12.0, rel=1e-6)
    assert volume == pytest.approx(math.pi * 49.0 * 12.0, rel=1e-6)
    assert np.abs(moment).max() < 1e-9 * volume


@pytest.mark.parametrize(
    "shape", [Ellipsoid(np.array([4.0, 2.0, 3.0])), Cylinder(5.0, 30.0)], ids=["ellipsoid", "cyl"]
)
def test_cutters_are_closed_look_outward_and_lie_on_the_surface(shape) -> None:
    body = shape.cutter(3)
    edges = np.sort(np.concatenate([body.triangles[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
    _, times = np.unique(edges, axis=0, return_counts=True)
    assert (times == 2).all()
    assert volume_of(body.vertices, body.triangles) > 0.0
    assert (shape.metric * body.vertices**2).sum(axis=1) == pytest.approx(
        np.ones(len(body.vertices)), abs=1e-12
    )


def test_lifted_points_and_normals_lie_on_the_surface() -> None:
    """Normals along the gradient of Σ x²/r²: on a sphere along the radius."""
    rng = np.random.default_rng(0)
    points = rng.normal(size=(50, 3))
    radii = np.array([4.0, 2.0, 3.0])
    lifted = Ellipsoid(radii).lift(points, points)
    assert ((lifted.points / radii) ** 2).sum(axis=1) == pytest.approx(np.ones(50), abs=1e-12)
    gradient = lifted.points / radii**2
    assert lifted.normals == pytest.approx(
        gradient / np.linalg.norm(gradient, axis=1)[:, None], abs=1e-12
    )
    assert np.cross(lifted.points, points) == pytest.approx(
        np.zeros((50, 3)), abs=1e-12
    )  # along rays


PROFILES = {
    "slope": [(60, 0), (40, 0), (0, 40), (-20, 40)],
    "cliff": [(60, 0), (30, 0), (30, 30), (-20, 30)],
    "overhang": [(60, 5), (25, 5), (30, 20), (15, 20), (20, 40), (-20, 40)],
}


@pytest.mark.parametrize("name", PROFILES)
@pytest.mark.parametrize("turned", [False, True])
def test_the_ground_below_a_profile(name, turned) -> None:
    """Area between profile and bottom by the shoelace, times the width; either order; level beyond its ends."""
    line = PROFILES[name][::-1] if turned else PROFILES[name]
    body = profile_prism(np.array(line, dtype=float), -10.0, 15.0, (-50.0, 80.0))
    right, left = PROFILES[name][0], PROFILES[name][-1]
    ring = [(-50, -10), (80, -10), (80, right[1]), *PROFILES[name], (-50, left[1])]
    area = (
        sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(ring, ring[1:] + ring[:1], strict=True)) / 2.0
    )
    assert volume_of(body.vertices, body.triangles) == pytest.approx(30.0 * area, rel=1e-12)


@pytest.mark.parametrize(
    "line", [[(60, 0), (0, 40), (40, 40), (20, 0)], [(0, 0), (10, 10), (10, 0), (0, 10)]]
)
def test_a_profile_that_crosses_itself(line) -> None:
    with pytest.raises(GeometryError) as caught:
        profile_prism(np.array(line, dtype=float), -10.0, 15.0, (-50.0, 80.0))
    assert caught.value.codes == ("E218",)


@pytest.mark.parametrize("upward", [False, True])
def test_a_sheet_becomes_a_body(upward) -> None:
    """A tilted rectangle in plan 20 m x 40 cos 30° under a lid 60 m above its middle: base times mean height."""
    points, triangles = sheet(30.0, 20.0, 40.0, (0.0, 0.0, 0.0))
    body = sheet_solid(
        points, triangles[:, ::-1] if upward else triangles, points[:, 2].mean() + 60.0
    )
    plan = 20.0 * 40.0 * math.cos(math.radians(30.0))
    assert volume_of(body.vertices, body.triangles) == pytest.approx(60.0 * plan, rel=1e-12)
    assert (body.face_kinds == SLIP).sum() == len(triangles)
    assert set(body.face_kinds[len(triangles) :].tolist()) == {END}


@pytest.mark.parametrize("dip", [90.0, 100.0])
def test_a_sheet_that_folds_or_stands_upright(dip) -> None:
    flat, upright = sheet(10.0, 20.0, 40.0), sheet(dip, 20.0, 40.0, (100.0, 0.0, 0.0))
    points = np.concatenate([flat[0], upright[0]])
    triangles = np.concatenate([flat[1], upright[1] + len(flat[0])])
    with pytest.raises(GeometryError) as caught:
        sheet_solid(points, triangles, 100.0)
    assert caught.value.codes == ("E216",)


def test_smoothed_normals_are_exact_on_any_mesh_of_a_sphere() -> None:
    """Max (1999), J. Graphics Tools 4(2): his weights give the radius at every vertex, however the triangles lie."""
    vertices, triangles = ellipsoid_mesh(3, (7.0, 7.0, 7.0), (0.0, 0.0, 0.0))
    vertices = vertices + 0.1 * np.random.default_rng(1).normal(size=vertices.shape)
    vertices *= 7.0 / np.linalg.norm(vertices, axis=1)[:, None]
    assert smooth_normals(vertices, triangles) == pytest.approx(vertices / 7.0, abs=1e-9)


@pytest.mark.parametrize(
    "profile",
    [
        [
            [6.0, 0.0],
            [40.0, 0.0],
            [0.0, 40.0],
            [-20.0, 40.0],
        ],  # the level ground beyond its end runs back along it
        [[10.0, 0.0], [20.0, 0.0], [0.0, 20.0], [-20.0, 22.0]],
        [[60.0, 0.0], [20.0, 0.0], [10.0, 20.0], [20.0, 0.0], [-20.0, 40.0]],
    ],
)
def test_a_profile_that_touches_itself_is_refused(profile) -> None:
    with pytest.raises(GeometryError, match="E218 the slope profile crosses or touches itself"):
        profile_prism(np.array(profile), -10.0, 5.0, (-30.0, 70.0))


def test_steps_and_points_in_line_are_a_profile() -> None:
    steps = [
        [60.0, 0.0],
        [50.0, 0.0],
        [40.0, 0.0],
        [40.0, 10.0],
        [20.0, 10.0],
        [20.0, 20.0],
        [20.0, 40.0],
        [0.0, 40.0],
    ]
    assert len(profile_prism(np.array(steps), -10.0, 5.0, (-30.0, 70.0)).triangles)


def test_a_profile_may_end_in_a_step() -> None:
    ends = [[60.0, 0.0], [40.0, 0.0], [0.0, 40.0], [-20.0, 40.0], [-20.0, 45.0]]
    assert len(profile_prism(np.array(ends), -10.0, 5.0, (0.0, 60.0)).triangles)
