"""A bench cut into blocks by joint sets, and the contact patches between them."""

from dataclasses import dataclass

import numpy as np

from slopekit.arrays import Floats, Ints, frozen
from slopekit.errors import Fault, GeometryError
from slopekit.geometry.bench import ConvexBody
from slopekit.geometry.cells import Cells, Faces, cells_of, corners_of_faces, faces_of, facing, plane_error
from slopekit.geometry.combs import Soup, ascending, combs_of_planes, cut_with_combs
from slopekit.geometry.counting import refuse_too_many, too_many
from slopekit.geometry.joint_sets import SetPlanes
from slopekit.geometry.patches import Assembly, Patches
from slopekit.geometry.slivers import Joined, join_slivers

__all__ = ["Cut", "cut_bench"]

_NUMERICAL_SLIVER = 1e-9  # of the body's volume: cells that rounding made or may unmake
_NO_AREA = 1e-12  # of the square of half the body's size
_STRAIGHT = 1e-11  # of half the body's size: corners as near as this to a straight edge are none
_OFF_PLANE = 1e-9  # of half the body's size
_BALANCE = 1e-6  # what volumes and areas may be off before the cut is refused


@dataclass(frozen=True, slots=True)
class Cut:
    """A body cut into blocks, with the evidence that nothing is lost.

    Attributes
    ----------
    assembly : the blocks; those at the far faces of the body are `fixed`
    body_volume, blocks_volume : m³
    volume_error : |blocks + left out - body| / body
    area_error : sum over all joint faces of |area - area of the face on its other side|, in parts of their sum; faces
        without another side count in full
    plane_error : how far corners are at most from the planes that made their faces, m
    joint_area : half the sum of all joint faces before slivers were joined, m²
    blocks, fixed : how many
    slivers_joined : cells smaller than `min_volume` joined to a neighbour
    slivers_left_out, volume_left_out : cells without a neighbour, m³
    planes_merged, planes_on_body_faces : see `SetPlanes`
    min_volume : m³
    """

    assembly: Assembly
    body_volume: float
    blocks_volume: float
    volume_error: float
    area_error: float
    plane_error: float
    joint_area: float
    blocks: int
    fixed: int
    slivers_joined: int
    slivers_left_out: int
    volume_left_out: float
    planes_merged: int
    planes_on_body_faces: int
    min_volume: float


def cut_bench(body: ConvexBody, planes: SetPlanes, max_blocks: int = 20000, min_volume: float = 0.0) -> Cut:
    """Cut a convex body into blocks along planes that all go through it.

    Cells smaller than `min_volume` (m³; at least 1e-9 of the body) are joined to the neighbour with which they share
    the largest patch; cells at the far faces rather to one that is there too. A block is fixed where it (not a sliver
    joined to it) has a face on a far face of the body.

    Raises
    ------
    GeometryError
        E220 more blocks than `max_blocks`; E224 volumes or areas do not add up; E225 the body is below `min_volume`.

    Examples
    --------
    >>> from slopekit.geometry.bench import bench_body
    >>> from slopekit.geometry.joint_sets import JointSet, planes_of_sets
    >>> body = bench_body(np.array([0.0, -1.0, 0.0]), np.array([0.0, 0.0, 1.0]), 9.0, 9.0, 9.0)
    >>> sets = [JointSet(np.eye(3)[axis], spacing=3.0, offset=1.5 * (axis == 0)) for axis in range(3)]
    >>> cut = cut_bench(body, planes_of_sets(sets, body, np.random.default_rng(0)))
    >>> cut.blocks, cut.fixed, len(cut.assembly.patches)
    (27, 23, 54)
    """
    lowest, highest = body.corners.min(axis=0), body.corners.max(axis=0)
    middle, half = (lowest + highest) / 2.0, body.size / 2.0
    corners = (body.corners - middle) / half
    normals, offsets = ascending(planes.normals, (planes.offsets - planes.normals @ middle) / half, planes.joint)
    faces_at = (body.offsets - body.normals @ middle) / half
    combs = combs_of_planes(normals, offsets, planes.joint, corners)
    refuse_too_many(normals, offsets, (body.normals, faces_at), combs, max_blocks)

    whole, soup = cut_with_combs((body.normals, faces_at), normals, offsets, combs, corners)
    cells = cells_of(soup, normals, offsets, combs)
    faces = faces_of(soup, cells.of_triangle, normals)
    other = facing(cells, faces, len(offsets))
    body_volume = float(whole.volume())

    is_inner = faces.plane < len(offsets)
    joint_area = float(faces.areas[is_inner].sum()) / 2.0
    differences = np.where(other >= 0, np.abs(faces.areas - faces.areas[other]), faces.areas)[is_inner]
    area_error = float(differences.sum()) / (2.0 * joint_area) if joint_area else 0.0
    volume_error = abs(float(cells.volumes.sum()) - body_volume) / body_volume
    away = plane_error(soup, normals, offsets)
    if max(volume_error, area_error) > _BALANCE or away > _OFF_PLANE:
        message = (
            f"the blocks do not add up to the bench (volume to {volume_error:.2g}, joints to {area_error:.2g}, "
            f"corners {away * half:.2g} m off their planes)"
        )
        raise GeometryError([Fault("E224", message, "", "Please report it; another offset of a set may help.")])

    at_far = np.zeros(len(cells.volumes), dtype=np.bool_)
    is_far = np.concatenate([np.zeros(len(offsets), dtype=np.bool_), body.is_far])
    at_far[faces.cell[is_far[faces.plane] & (faces.areas > _NO_AREA)]] = True
    below = np.flatnonzero(faces.is_below & (other >= 0))
    least = max(min_volume / half**3, _NUMERICAL_SLIVER * body_volume)
    sides = faces.cell[below], faces.cell[other[below]]
    joined = join_slivers(cells.volumes, at_far, *sides, faces.areas[below], least)
    if joined.count > max_blocks:
        raise too_many(joined.count, max_blocks)
    if joined.count == 0:
        message = f"the bench has {body_volume * half**3:.4g} m³, less than min_volume = {min_volume:.4g} m³"
        raise GeometryError([Fault("E225", message)])
    where = (middle, half)
    patches = _patches(soup, faces, below, other[below], joined.block, planes.joint, normals, where)
    assembly = _assembly(soup, cells, faces, other, joined, patches, where)
    left_out = float(cells.volumes[joined.block < 0].sum()) * half**3
    return Cut(
        assembly, body_volume * half**3, float(assembly.volumes.sum()), volume_error, area_error,
        away * half, joint_area * half**2, joined.count, int(joined.fixed.sum()), joined.joined,
        int((joined.block < 0).sum()), left_out, planes.merged, planes.on_body_faces, least * half**3,
    )  # fmt: skip


def _patches(
    soup: Soup, faces: Faces, below: Ints, above: Ints, block: Ints, joint: Ints, normals: Floats,
    where: tuple[Floats, float],
) -> Patches:  # fmt: skip
    """The patches between different blocks; `below`, `above` are the faces on the two sides of each."""
    minus, plus = block[faces.cell[below]], block[faces.cell[above]]
    kept = (minus != plus) & (minus >= 0) & (plus >= 0) & (faces.areas[below] > _NO_AREA)
    below = below[kept]
    corners, first = corners_of_faces(soup, faces.of_triangle, below, _STRAIGHT)
    middle, half = where
    plane = faces.plane[below]
    return Patches(
        plus[kept], minus[kept], joint[plane], frozen(normals[plane]), frozen(faces.areas[below] * half**2),
        frozen(faces.centroids[below] * half + middle), frozen(corners * half + middle), first,
    )  # fmt: skip


def _assembly(
    soup: Soup, cells: Cells, faces: Faces, other: Ints, joined: Joined, patches: Patches, where: tuple[Floats, float]
) -> Assembly:
    middle, half = where
    in_block = joined.block >= 0
    block, count = joined.block[in_block], joined.count
    weights = cells.volumes[in_block]
    volumes = np.bincount(block, weights, count)
    moments = [np.bincount(block, weights * cells.centroids[in_block, k], count) for k in range(3)]
    centroids = np.stack(moments, axis=1) / volumes[:, None]
    # faces between cells of one block are within it
    of_face = joined.block[faces.cell]
    outer = (of_face >= 0) & ((other < 0) | (of_face[other] != of_face))
    on_surface = outer[faces.of_triangle]
    return Assembly(
        frozen(volumes * half**3), frozen(centroids * half + middle), joined.fixed, patches, False,
        frozen(soup.vertices * half + middle), soup.triangles[on_surface],
        joined.block[cells.of_triangle[on_surface]],
    )  # fmt: skip
