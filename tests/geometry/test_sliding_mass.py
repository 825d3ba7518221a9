"""Masses on curved slip surfaces against formulas of caps and segments, and what holds for every closed body."""

import math

import numpy as np
import pytest
from scipy.integrate import dblquad

from slopekit.closed_form.rotation import rotational_failure
from slopekit.core.errors import GeometryError
from slopekit.geometry.solids.shapes import GROUND, SLIP, Cutter, Cylinder, Ellipsoid, sheet_solid
from slopekit.geometry.solids.sliding_mass import analytic_mass, cut_mass, facet_pairs
from tests.scenes import ground_about, sheet, slab, tilted


def ellipsoid_cap(radii, distance: float, dip: float):
    """Volume, area, centroid and the cut's vector area of an ellipsoid below a plane whose normal lies in x-z.

    The map x / r makes it a cap of the unit sphere: V = π h² (3 - h) / 3, centroid 3 (2 - h)² / (4 (3 - h)) below the
    centre, plane cut π (1 - d²). The area has no closed form: it is integrated over the unit sphere.
    """
    radii = np.array(radii, dtype=float)
    normal = np.array([math.sin(math.radians(dip)), 0.0, math.cos(math.radians(dip))])
    mapped = normal * radii
    size = math.sqrt(mapped @ mapped)
    axis, d = mapped / size, distance / size
    h = 1.0 + d
    volume = math.prod(radii) * math.pi * h * h * (3.0 - h) / 3.0
    centroid = -3.0 * (2.0 - h) ** 2 / (4.0 * (3.0 - h)) * axis * radii
    cut = math.pi * (1.0 - d * d) * math.prod(radii) * axis / radii
    first = np.array([axis[2], 0.0, -axis[0]])

    def stretch(turn: float, level: float) -> float:
        across = math.sqrt(1.0 - level * level)
        u = level * axis + across * (
            math.cos(turn) * first + math.sin(turn) * np.array([0.0, 1.0, 0.0])
        )
        return math.prod(radii) * math.sqrt(((u / radii) ** 2).sum())

    area = dblquad(stretch, -1.0, d, 0.0, 2.0 * math.pi, epsabs=1e-9, epsrel=1e-9)[0]
    return volume, area, centroid, cut


@pytest.mark.slow
@pytest.mark.parametrize("radii", [(10, 10, 10), (10, 4, 7), (5, 20, 8)])
@pytest.mark.parametrize(("share", "dip"), [(-0.5, 26.565), (0.1, 40.0), (0.6, 0.0), (-0.85, 60.0)])
def test_caps_of_ellipsoids(radii, share, dip) -> None:
    """Volume and centroid to 4e-6 at the default mesh, area and vector area to 3e-4 (rims of flat ellipsoids: O(h²)).

    Volume and centroid are ten times nearer than at edges twice as long (O(h⁴) is 16); the areas three times or, where
    slivers along the rim lend each other area, within 2e-5.
    """
    shape = Ellipsoid(np.array(radii, dtype=float))
    distance = share * math.hypot(
        radii[0] * math.sin(math.radians(dip)), radii[2] * math.cos(math.radians(dip))
    )
    ground = ground_about(shape.cutter(4), tilted(distance, dip, 60.0))
    volume, area, centroid, cut = ellipsoid_cap(radii, distance, dip)
    errors = []
    for edge in (1e9, None):
        mass, pairs = analytic_mass(ground, shape, edge)
        push = pairs.control_areas @ pairs.normals
        errors.append(
            [
                abs(mass.volume / volume - 1.0),
                abs(mass.area / area - 1.0),
                np.abs(mass.centroid - centroid).max() / max(radii),
                np.abs(push - cut).max() / np.linalg.norm(cut),
            ]
        )
        assert pairs.control_areas.sum() == pytest.approx(mass.area, rel=1e-12)
        assert pairs.control_areas.min() > 0.0
        assert np.linalg.norm(pairs.normals, axis=1) == pytest.approx(
            np.ones(len(pairs)), rel=1e-12
        )
        assert ((pairs.points / shape.radii) ** 2).sum(axis=1) == pytest.approx(
            np.ones(len(pairs)), rel=1e-9
        )
        assert mass.pieces == ()
    rough, fine = np.array(errors)
    assert max(fine[::2]) < 4e-6
    assert max(fine[1::2]) < (3e-4 if len(set(radii)) > 1 else 2e-5)
    assert (fine[::2] < np.maximum(rough[::2] / 10.0, 1e-9)).all()
    assert (fine[1::2] < np.maximum(rough[1::2] / 3.0, 2e-5)).all()


@pytest.mark.parametrize("distance", [-6.0, 0.0, 4.0])
@pytest.mark.parametrize("dip", [0.0, 35.0])
def test_segments_of_cylinders(distance, dip) -> None:
    """Area of segment R² (ω - sin ω cos ω), arc 2 R ω, centroid 2 R sin³ω / (3 (ω - sin ω cos ω)); O(h⁴)."""
    shape = Cylinder(10.0, 6.0)
    ground = ground_about(shape.cutter(4), tilted(distance, dip, 60.0))
    omega = math.acos(-distance / 10.0)
    segment = omega - math.sin(omega) * math.cos(omega)
    normal = np.array([math.sin(math.radians(dip)), 0.0, math.cos(math.radians(dip))])
    mass, pairs = analytic_mass(ground, shape, None)
    assert mass.volume == pytest.approx(600.0 * segment, rel=1e-6)
    assert mass.area == pytest.approx(120.0 * omega, rel=1e-6)
    assert mass.centroid == pytest.approx(
        -20.0 * math.sin(omega) ** 3 / (3.0 * segment) * normal, abs=1e-5
    )
    chord = 20.0 * math.sin(omega) * 6.0
    assert pairs.control_areas @ pairs.normals == pytest.approx(chord * normal, abs=1e-5 * chord)
    ends = mass.triangles[(mass.face_kinds != SLIP) & (mass.face_kinds != GROUND)]
    assert np.abs(np.abs(mass.vertices[ends][:, :, 1]) - 3.0).max() < 1e-9


PROFILES = {
    "slope": [(60, 0), (40, 0), (0, 40), (-20, 40)],
    "bench": [(-10, 35), (5, 38), (12, 25), (20, 25), (20, 12), (70, 5)],
    "cliff": [(60, 0), (30, 0), (30, 30), (-20, 30)],
    "two pieces": [(0, 10), (30, 30), (50, 2), (62, 30)],
    "deep": [(20, 75), (45, 60), (60, 20)],
}


@pytest.mark.parametrize("name", PROFILES)
@pytest.mark.parametrize("half_width", [28.0, 40.0])
def test_profiles_with_corners(name, half_width) -> None:
    """Volume, area, resisting and driving moment by slices (Green's theorem and Gauss's rule, closed_form.rotation).

    1e-4: where the ground has a corner the rim keeps one there and its strips are of second order.
    """
    shape = Ellipsoid(np.array([40.0, half_width, 40.0]))
    exact = rotational_failure((40, 0, 40), 40.0, half_width, PROFILES[name], 1.0, 1.0)
    for line in (PROFILES[name], PROFILES[name][::-1]):
        ground = ground_about(shape.cutter(4), np.array(line, dtype=float) - 40.0)
        mass, pairs = analytic_mass(ground, shape, None)
        arms = np.hypot(pairs.points[:, 0], pairs.points[:, 2])
        assert pairs.control_areas.min() > 0.0
        assert mass.volume == pytest.approx(exact.volume_m3, rel=1e-5)
        assert mass.area == pytest.approx(exact.area_m2, rel=1e-4)
        assert pairs.control_areas @ arms == pytest.approx(exact.resisting_moment_knm, rel=1e-4)
        assert -mass.centroid[0] * mass.volume == pytest.approx(exact.driving_moment_knm, rel=2e-5)


def test_a_profile_that_overhangs() -> None:
    """Ground under a ledge: the part of a cylinder within a polygon, summed on a fine grid of its section (1e-3)."""
    line = np.array([(60, 5), (25, 5), (30, 20), (15, 20), (20, 40), (-20, 40)], dtype=float) - 40.0
    shape = Cylinder(40.0, 10.0)
    mass, _ = analytic_mass(ground_about(shape.cutter(4), line), shape, None)
    ring = np.vstack(
        [line, [-100.0, line[-1, 1]], [-100.0, -100.0], [100.0, -100.0], [100.0, line[0, 1]]]
    )
    x, z = np.meshgrid(*2 * [np.arange(-39.975, 40.0, 0.05)])
    inside = np.zeros(x.shape, dtype=bool)
    for (x0, z0), (x1, z1) in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        if z0 != z1:
            inside ^= ((z0 > z) != (z1 > z)) & (x < (x1 - x0) * (z - z0) / (z1 - z0) + x0)
    inside &= x * x + z * z < 1600.0
    assert mass.volume == pytest.approx(10.0 * inside.sum() * 0.05**2, rel=1e-3)
    assert mass.centroid[[0, 2]] == pytest.approx([x[inside].mean(), z[inside].mean()], abs=0.05)


def closes(mass) -> None:
    """The vector area of a closed body is nothing, and every edge of it belongs to two triangles."""
    a, b, c = (mass.vertices[mass.triangles[:, k]] for k in range(3))
    vectors = np.cross(b - a, c - a) / 2.0
    assert np.abs(vectors.sum(axis=0)).max() < 1e-9 * np.abs(vectors).sum()
    on_slip, free = (
        vectors[mass.face_kinds == SLIP].sum(axis=0),
        vectors[mass.face_kinds != SLIP].sum(axis=0),
    )
    assert on_slip == pytest.approx(-free, abs=1e-9 * np.abs(vectors).sum())
    edges = np.sort(np.concatenate([mass.triangles[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()


@pytest.mark.parametrize("name", PROFILES)
@pytest.mark.parametrize(
    "shape", [Ellipsoid(np.array([40.0, 25.0, 38.0])), Cylinder(42.0, 30.0)], ids=["e", "c"]
)
def test_the_mass_is_a_closed_body(name, shape) -> None:
    ground = ground_about(shape.cutter(4), np.array(PROFILES[name], dtype=float) - 40.0)
    closes(cut_mass(ground, shape.cutter(4)))
    closes(analytic_mass(ground, shape, None)[0])


def test_pairs_on_facets() -> None:
    """Control areas sum to the facets; their smoothed normals balance the free faces to O(h²)."""
    shape = Ellipsoid(np.array([40.0, 28.0, 40.0]))
    body = shape.cutter(4)
    mass = cut_mass(ground_about(body, np.array(PROFILES["slope"], dtype=float) - 40.0), body)
    pairs = facet_pairs(mass, body)
    a, b, c = (mass.vertices[mass.triangles[mass.face_kinds != SLIP][:, k]] for k in range(3))
    free = np.cross(b - a, c - a).sum(axis=0) / 2.0
    assert pairs.control_areas.sum() == pytest.approx(mass.area, rel=1e-12)
    push = pairs.control_areas @ pairs.normals
    assert push == pytest.approx(free, rel=2e-3, abs=1e-6 * np.abs(free).max())


def test_pieces_that_are_left_out() -> None:
    """Two hills in one sphere: the larger is taken, the smaller reported; together they are the whole."""
    shape = Ellipsoid(np.array([40.0, 40.0, 40.0]))
    line = (
        np.array([(-5, 20), (20, 30), (38, -8), (42, -8), (60, 25), (90, 20)], dtype=float) - 40.0
    )
    ground = ground_about(shape.cutter(4), line)
    mass = cut_mass(ground, shape.cutter(4))
    assert len(mass.pieces) == 1
    whole = rotational_failure((0, 0, 0), 40.0, 40.0, line, 1.0, 1.0).volume_m3
    assert mass.volume > mass.pieces[0] > 0.0
    assert mass.volume + mass.pieces[0] == pytest.approx(
        whole, rel=0.02
    )  # the facets of level 4 cut 1 % off


def test_a_flat_sheet_cuts_a_prism() -> None:
    """A sheet dipping 30° through the toe of a 45° face 40 m high, slab 10 m wide: a triangle, by hand."""
    points, triangles = sheet(30.0, 20.0, 200.0)
    vertices, faces = slab([(70, -60), (40, 0), (0, 40), (-60, 40)], 5.0, -80.0, (-90.0, 100.0))
    body = sheet_solid(points, triangles, 100.0)
    mass = cut_mass(Cutter(vertices, faces, np.full(len(faces), GROUND)), body)
    back = 40.0 / math.tan(
        math.radians(30.0)
    )  # behind the toe the plane comes out level with the crest
    assert mass.volume == pytest.approx(10.0 * 40.0 * (back - 40.0) / 2.0, rel=1e-9)
    assert mass.area == pytest.approx(10.0 * 80.0, rel=1e-9)
    closes(mass)


BALL = Ellipsoid(np.array([5.0, 5.0, 5.0])).cutter(3)
HOLE = Cutter(BALL.vertices, BALL.triangles[1:], BALL.face_kinds[1:])
INSIDE_OUT = Cutter(BALL.vertices, BALL.triangles[:, ::-1].copy(), BALL.face_kinds)


@pytest.mark.parametrize(
    ("body", "level", "code"),
    [(BALL, 6.0, "E214"), (BALL, -6.0, "E214"), (HOLE, 0.0, "E216"), (INSIDE_OUT, 0.0, "E216")],
    ids=["within the ground", "in the air", "a hole", "inside out"],
)
def test_faults(body, level, code) -> None:
    with pytest.raises(GeometryError) as caught:
        cut_mass(ground_about(BALL, [(-9.0, level), (9.0, level)]), body)
    assert caught.value.codes == (code,)
