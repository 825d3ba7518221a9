"""Node pairs: the rule is exact for linear traction (degree two with its moments), on any polygon, refined or not."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from slopekit.core.errors import GeometryError
from slopekit.core.orientation import Plane
from slopekit.geometry import interfaces
from slopekit.geometry.interfaces import node_pairs
from slopekit.geometry.rock import cutting
from slopekit.geometry.rock.cutting import cut_wedge
from slopekit.geometry.rock.rockmass import J1, J2, UPPER, RockMass, wedge_rock_mass
from slopekit.preie.system.patch_pairs import fan_rule
from slopekit.views.charts.stereonet import cells

TRIANGLE = [(0.0, 0.0), (4.0, 0.0), (1.0, 3.0)]
SQUARE = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
PENTAGON = [(0.0, 0.0), (4.0, -1.0), (6.0, 2.0), (3.0, 5.0), (-1.0, 3.0)]


def moment(corners, p: int, q: int) -> float:
    """∫ xᵖ yᑫ over a polygon, p + q <= 2 (Steger 1996, closed formulas by edges)."""
    total = 0.0
    for (x0, y0), (x1, y1) in zip(corners, corners[1:] + corners[:1], strict=True):
        cross = x0 * y1 - x1 * y0
        total += (
            cross
            * {
                (0, 0): 1 / 2,
                (1, 0): (x0 + x1) / 6,
                (0, 1): (y0 + y1) / 6,
                (2, 0): (x0 * x0 + x0 * x1 + x1 * x1) / 12,
                (0, 2): (y0 * y0 + y0 * y1 + y1 * y1) / 12,
                (1, 1): (2 * x0 * y0 + x0 * y1 + x1 * y0 + 2 * x1 * y1) / 24,
            }[p, q]
        )
    return total


def lifted(corners, plane: Plane):
    """The polygon laid on a plane, and the plane's two axes."""
    normal = plane.normal()
    first = np.cross(normal, [0.3, 0.5, 0.7])
    first /= np.linalg.norm(first)
    second = np.cross(normal, first)
    return np.array([x * first + y * second for x, y in corners]), first, second


@pytest.mark.parametrize("corners", [TRIANGLE, SQUARE, PENTAGON], ids=["triangle", "square", "pentagon"])
@pytest.mark.parametrize("refine", [0, 1, 3])
@pytest.mark.parametrize("powers", [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)])
def test_exact_to_degree_two(corners, refine, powers) -> None:
    polygon, first, second = lifted(corners, Plane(37, 211))
    pairs = node_pairs({0: polygon}, refine)
    x, y = pairs.points @ first, pairs.points @ second
    p, q = powers
    assert pairs.control_areas @ (x**p * y**q) == pytest.approx(moment(corners, p, q), rel=1e-12)


@pytest.mark.parametrize("refine", [0, 2])
def test_corners_carry_pairs_so_that_hinges_are_exact(refine) -> None:
    polygon, _, _ = lifted(PENTAGON, Plane(60, 100))
    pairs = node_pairs({0: polygon}, refine)
    for corner in polygon:
        assert np.abs(pairs.points - corner).sum(axis=1).min() < 1e-12
    assert pairs.control_areas.min() > 0.0


@pytest.mark.parametrize("refine", [0, 1, 2, 3])
def test_each_refinement_splits_a_triangle_in_four(refine) -> None:
    """Corners of the small triangles, shared by them, and a middle of each."""
    polygon, _, _ = lifted(TRIANGLE, Plane(60, 100))
    n = 2**refine
    assert len(node_pairs({0: polygon}, refine)) == (n + 1) * (n + 2) // 2 + n * n


def test_normals_point_into_the_block() -> None:
    """The polygon runs anticlockwise seen from outside: its vector area points out of the block."""
    polygon, _, _ = lifted(SQUARE, Plane(20, 300))
    outward = np.cross(polygon[1] - polygon[0], polygon[2] - polygon[0])
    pairs = node_pairs({0: polygon})
    assert (pairs.normals @ outward < 0.0).all()
    assert (pairs.plus == 0).all()
    assert (pairs.minus == -1).all()


def test_pairs_that_are_remembered_are_those_of_their_corners() -> None:
    """Moved by the last digit they are others, with other ids too; what several hold cannot be written on."""
    polygon, _, _ = lifted(PENTAGON, Plane(60, 100))
    pairs = node_pairs({3: polygon}, 1)
    moved = np.nextafter(polygon, np.inf)
    for others in (node_pairs({3: moved}, 1), node_pairs({3: polygon}), node_pairs({4: polygon}, 1)):
        same = others.points.shape == pairs.points.shape and (others.points == pairs.points).all()
        assert not same or (others.interface != pairs.interface).all()
    polygon += 1.0  # the caller's own array
    again = node_pairs({3: polygon - 1.0}, 1)
    assert np.abs(again.points - pairs.points).max() < 1e-15
    assert node_pairs({3: polygon}, 1).points - pairs.points == pytest.approx(1.0, abs=1e-14)
    for values in (pairs.points, pairs.normals, pairs.control_areas, pairs.interface, pairs.plus, pairs.minus):
        assert not values.flags.writeable


def rock_mass(height: float, dip: float = 45.0):
    joints = np.array([Plane(dip, 105).normal(), Plane(70, 235).normal()])
    return wedge_rock_mass(joints, Plane(65, 185).normal(), Plane(12, 195).normal(), height)


def test_a_wedge_that_is_remembered_is_that_of_its_planes() -> None:
    """Half as high it has an eighth of the volume, again and again; a wedge that is none fails every time."""
    for _ in range(2):
        whole, half, other = (cut_wedge(rock) for rock in (rock_mass(30.0), rock_mass(15.0), rock_mass(30.0, 45.5)))
        assert whole.volume == pytest.approx(8.0 * half.volume, rel=1e-12)
        assert abs(other.volume / whole.volume - 1.0) > 1e-3
        assert not whole.centroid.flags.writeable
        assert not any(face.flags.writeable for face in whole.faces.values())
        rock = rock_mass(30.0)
        shut = RockMass(rock.normals, rock.offsets - [0.0, 0.0, 0.0, 99.0], *rock.corners)
        with pytest.raises(GeometryError, match="E208"):
            cut_wedge(shut)


def all_of(rock: RockMass, cut, pairs_on) -> list[object]:
    """Every number of a wedge and of its node pairs, by its bytes."""
    try:
        block = cut(rock)
    except GeometryError as error:
        return [str(error)]
    pairs = pairs_on({face: block.faces[face] for face in (J1, J2)})
    arrays = [*block.faces.values(), block.centroid, pairs.points, pairs.normals, pairs.control_areas, pairs.interface]
    return [list(block.faces), list(block.areas.items()), block.volume, *(array.tobytes() for array in arrays)]


def as_new(rock: RockMass):
    return cutting._wedge_of.__wrapped__(rock.normals.tobytes(), rock.offsets.tobytes(), rock.corners.tobytes())


def pairs_as_new(polygons):
    return interfaces._pairs_on.__wrapped__(tuple((key, face.tobytes()) for key, face in polygons.items()), 0)


def nearly(rock: RockMass, change: str) -> RockMass:
    """The same wedge but for the least that could be told apart, or not even that."""
    normals, offsets, corners = rock.normals.copy(), rock.offsets.copy(), [*rock.corners]
    if change == "normal":
        normals[J2, 1] += 1e-12
    elif change == "last digit":
        normals[J1, 2] = np.nextafter(normals[J1, 2], 2.0)
    elif change == "offset":
        offsets[UPPER] += 1e-12
    elif change == "zeros":
        normals, offsets = np.where(normals == 0.0, -normals, normals), np.where(offsets == 0.0, -0.0, offsets)
    elif change == "corner":
        corners[1] = corners[1] * (1.0 + 1e-12)
    else:
        normals[[J1, J2]], corners[2:] = normals[[J2, J1]], corners[:1:-1]
    return RockMass(normals, offsets, *corners)


@pytest.mark.parametrize("change", ["normal", "last digit", "offset", "zeros", "corner", "joints swapped"])
def test_wedges_that_are_nearly_equal_are_never_taken_for_each_other(change) -> None:
    """Each to the last bit as without memory, one after the other and by several threads at once."""
    rng = np.random.default_rng(7)
    rocks = [rock_mass(rng.uniform(5.0, 60.0), rng.uniform(40.0, 50.0)) for _ in range(6)]
    asked = [rock for one in rocks for rock in (one, nearly(one, change))] * 2
    new = [all_of(rock, as_new, pairs_as_new) for rock in asked]
    assert [all_of(rock, cut_wedge, node_pairs) for rock in asked] == new
    others = sum(one != other for one, other in zip(new[:12:2], new[1:12:2], strict=True))
    # the corners say where to look, not what is there; a last digit may be rounded away
    assert others == 6 or change in ("zeros", "corner") or (change == "last digit" and others >= 4)
    with ThreadPoolExecutor(4) as threads:
        assert list(threads.map(lambda rock: all_of(rock, cut_wedge, node_pairs), asked[::-1])) == new[::-1]


def test_no_array_that_is_remembered_can_be_written() -> None:
    """Several designs, studies and threads hold the same one."""
    for array in (*fan_rule(4, 1), *cells()):
        assert not array.flags.writeable
