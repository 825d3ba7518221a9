"""Convex blocks from their planes: against solids whose sizes are known, and manifold's cut of the same wedges."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull, HalfspaceIntersection

from slopekit.core.orientation import Plane
from slopekit.geometry.polytopes import Polytopes, polytopes
from tests.geometry.manifold_wedge import cut_wedge, wedge_rock_mass

CUBE = np.concatenate([np.eye(3), -np.eye(3)])
WEDGES = [
    (("45/115", "45/245"), "60/180", "10/180", 64.89),
    (("52/140", "61/222"), "75/180", "0/180", 12.0),
    (("78/130", "35/200"), "80/175", "5/185", 30.0),
    (("33/170", "85/260"), "65/180", "15/180", 8.0),
]


def block(
    outward: np.ndarray, offsets: np.ndarray, size: float = 1.0, at: object = (0.0, 0.0, 0.0)
) -> Polytopes:
    """One block, moved to a place."""
    return polytopes(
        outward[None], (offsets + outward @ np.asarray(at, dtype=float))[None], np.array([size])
    )


def areas(solid: Polytopes) -> np.ndarray:
    """The area of every face of the first block, along its outward normal: below 0 where corners run the wrong way."""
    found = []
    for plane, normal in enumerate(solid.outward[0]):
        corners = solid.faces[0, plane]
        found.append(0.5 * np.cross(corners, np.roll(corners, -1, axis=0)).sum(axis=0) @ normal)
    return np.array(found)


def by_hull(outward: np.ndarray, offsets: np.ndarray, inside: np.ndarray) -> ConvexHull:
    """The same block by Qhull."""
    half = HalfspaceIntersection(np.column_stack([outward, -offsets]), inside)
    return ConvexHull(half.intersections)


def test_a_box() -> None:
    """Two by three by four metres: volume, centroid, faces anticlockwise as seen from outside."""
    solid = block(CUBE, np.array([2.0, 3.0, 4.0, 0.0, 0.0, 0.0]))
    assert solid.volume[0] == pytest.approx(24.0, rel=1e-14)
    assert solid.centroid[0] == pytest.approx([1.0, 1.5, 2.0], rel=1e-14)
    assert solid.counts[0].tolist() == [4] * 6
    assert areas(solid) == pytest.approx([12.0, 8.0, 6.0] * 2, rel=1e-14)
    assert areas(solid) @ solid.outward[0] == pytest.approx(np.zeros(3), abs=1e-13)


def test_a_tetrahedron() -> None:
    """Below x + y + z = 1 in the first octant: a sixth of a cube, its centroid at a quarter of each axis."""
    outward = np.concatenate([-np.eye(3), np.full((1, 3), 1.0 / np.sqrt(3.0))])
    solid = block(outward, np.array([0.0, 0.0, 0.0, 1.0 / np.sqrt(3.0)]))
    assert solid.volume[0] == pytest.approx(1.0 / 6.0, rel=1e-14)
    assert solid.centroid[0] == pytest.approx([0.25] * 3, rel=1e-14)
    assert solid.counts[0].tolist() == [3] * 4
    assert areas(solid) == pytest.approx([0.5, 0.5, 0.5, np.sqrt(3.0) / 2.0], rel=1e-14)


def test_planes_that_bound_nothing_and_planes_that_miss_the_block() -> None:
    """A plane beyond the cube has no face; planes that leave nothing have no volume."""
    far = np.concatenate([CUBE, [[0.6, 0.8, 0.0]]])
    solid = block(far, np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.5]))
    assert solid.counts[0].tolist() == [4] * 6 + [0]
    assert solid.volume[0] == pytest.approx(1.0, rel=1e-14)
    empty = block(far, np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0, -0.1]))
    assert empty.counts[0].tolist() == [0] * 7
    assert np.isnan(empty.volume[0])


@pytest.mark.parametrize("seed", range(5))
def test_random_blocks_by_qhull(seed: int) -> None:
    """Twelve random planes about a ball, 20 blocks at once."""
    rng = np.random.default_rng(seed)
    outward = rng.normal(size=(20, 12, 3))
    outward = np.concatenate([outward, np.broadcast_to(CUBE, (20, 6, 3))], axis=1)
    outward /= np.linalg.norm(outward, axis=2)[:, :, None]
    offsets = rng.uniform(0.5, 1.0, (20, 18))
    solids = polytopes(outward, offsets, np.full(20, 2.0))
    for row in range(20):
        hull = by_hull(outward[row], offsets[row], np.zeros(3))
        assert solids.volume[row] == pytest.approx(hull.volume, rel=1e-9)
        corners = solids.faces[row][solids.counts[row] > 0].reshape(-1, 3)
        beyond = corners @ outward[row].T - offsets[row]
        assert beyond.max() <= 1e-9
        assert np.linalg.norm(hull.points[:, None] - corners, axis=2).min(axis=1).max() <= 1e-9


def planes_of(
    joints: tuple[str, str], face: str, upper: str, height: float
) -> tuple[np.ndarray, np.ndarray, float]:
    """Outward normals and offsets of a wedge from its toe, and about its size, by the corners of the closed form."""
    one, two, front, top = (
        Plane(*map(float, plane.split("/"))) for plane in (*joints, face, upper)
    )
    rock = wedge_rock_mass(
        np.array([one.normal(), two.normal()]), front.normal(), top.normal(), height
    )
    toe, _, crest, _ = rock.corners
    outward = np.array([-one.normal(), -two.normal(), front.normal(), top.normal()])
    return (
        outward,
        np.array([outward[0] @ toe, outward[1] @ toe, outward[2] @ toe, outward[3] @ crest]),
        height,
    )


@pytest.mark.parametrize("wedge", WEDGES)
@pytest.mark.parametrize("at", [(0.0, 0.0, 0.0), (5e5, -3e5, 1e3)], ids=["origin", "500 km"])
def test_wedges_as_manifold_cuts_them(wedge: tuple, at: tuple[float, float, float]) -> None:
    """Volume, centroid and faces; 500 km away within the rounding of such coordinates."""
    joints, face, upper, height = wedge
    one, two, front, top = (
        Plane(*map(float, plane.split("/"))) for plane in (*joints, face, upper)
    )
    cut = cut_wedge(
        wedge_rock_mass(
            np.array([one.normal(), two.normal()]), front.normal(), top.normal(), height
        )
    )
    solid = block(*planes_of(*wedge), at)
    within = 1e-9 if not any(at) else 1e-6
    assert solid.volume[0] == pytest.approx(cut.volume, rel=within)
    assert solid.centroid[0] - at == pytest.approx(cut.centroid, abs=within * height)
    assert solid.counts[0].tolist() == [3] * 4
    own = block(*planes_of(*wedge))
    assert np.sort(areas(own)) == pytest.approx(np.sort(list(cut.areas.values())), rel=1e-9)
    assert own.block().areas == pytest.approx(dict(enumerate(areas(own))), rel=1e-12)


@pytest.mark.parametrize("thin", [1e-3, 1e-6])
def test_a_sliver(thin: float) -> None:
    """A plate so thin that its faces nearly meet keeps its volume; below the corners' tolerance there is none."""
    offsets = np.array([1.0, 1.0, thin, 0.0, 0.0, 0.0])
    solid = block(CUBE, offsets)
    assert solid.volume[0] == pytest.approx(thin, rel=1e-9)
    assert solid.counts[0].tolist() == [4] * 6
    tilted = np.concatenate(
        [CUBE, [[0.0, -np.sin(thin), np.cos(thin)]]]
    )  # a second plane nearly along the top
    wedge = block(
        tilted, np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0, np.cos(thin) * (1.0 - np.tan(thin))])
    )
    assert wedge.volume[0] == pytest.approx(1.0 - np.tan(thin) / 2.0, rel=1e-9)
