"""A bench cut into blocks by joint sets, and the contact patches between them.

How many blocks there will be is counted before; cells too small to be blocks are joined to their neighbours.
"""

import math
from dataclasses import dataclass

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints, frozen
from slopekit.core.errors import Fault, GeometryError
from slopekit.geometry.patches import Assembly, Patches
from slopekit.geometry.rock.bench import ConvexBody
from slopekit.geometry.rock.cells import (
    Cells,
    Faces,
    cells_of,
    corners_of_faces,
    faces_of,
    opposite_faces,
    plane_error,
)
from slopekit.geometry.rock.joint_sets import SetPlanes
from slopekit.geometry.rock.plane_stacks import (
    PlaneStack,
    Soup,
    ascending,
    cut_with_stacks,
    stacks_of_planes,
)
from slopekit.geometry.tolerances import (
    CUT_BALANCE,
    INSIDE,
    NO_AREA,
    NUMERICAL_SLIVER,
    OFF_PLANE,
    PARALLEL,
    STRAIGHT,
)

#: Of max_blocks: planes through one line or point cut fewer cells than are counted; above this they are refused uncut.
_REFUSAL_MARGIN = 1.5
_COUNTING_LIMIT = 50  # times max_blocks: stop counting


def refuse_too_many(
    normals: Floats,
    offsets: Floats,
    faces: tuple[Floats, Floats],
    stacks: list[PlaneStack],
    max_blocks: int,
) -> None:
    """Refuse planes that cut many more blocks than allowed.

    Parameters
    ----------
    normals (p, 3), offsets (p,) : of the planes; stacks : those that do not meet within the body
    faces : normals (k, 3) and offsets (k,) of the body, `normal · x <= offset`

    Raises
    ------
    GeometryError
        E220 more blocks than `max_blocks`.
    """
    if math.prod(len(planes) + 1 for planes, _ in stacks) <= max_blocks:
        return
    count = count_cells(normals, offsets, faces, stacks, _COUNTING_LIMIT * max_blocks)
    if count > _REFUSAL_MARGIN * max_blocks:
        raise too_many(
            count, max_blocks, "more than " if count > _COUNTING_LIMIT * max_blocks else "about "
        )


def too_many(count: int, max_blocks: int, about: str = "") -> GeometryError:
    """Return the error E220 of a bench with too many blocks, with the spacing that would do."""
    message = f"the joint sets cut the bench into {about}{count:,} blocks, more than max_blocks = {max_blocks:,}"
    factor = math.ceil(100.0 * (count / max_blocks) ** (1.0 / 3.0)) / 100.0
    advice = f"Take all spacings {factor:.3g} times as large, a smaller bench, or raise max_blocks."
    return GeometryError([Fault("E220", message, "", advice)])


def count_cells(
    normals: Floats,
    offsets: Floats,
    faces: tuple[Floats, Floats],
    stacks: list[PlaneStack],
    most: int = 2**62,
) -> int:
    """Count the cells of a convex body cut by planes: 1 + planes + lines + points in which planes meet within the body.

    Exact for planes in general position (Zaslavsky 1975); an upper bound where more planes share a line or a point.
    Counting stops when there are more than `most`.
    """
    order = np.concatenate([*(planes for planes, _ in stacks), np.zeros(0, dtype=np.int64)]).astype(
        np.int64
    )
    stack = np.repeat(np.arange(len(stacks)), [len(planes) for planes, _ in stacks])
    normals, offsets = normals[order], offsets[order]
    total = 1 + len(order)
    for i in range(len(order)):
        rest = int(
            np.searchsorted(stack, stack[i], side="right")
        )  # planes of its own stack do not meet it
        across = np.cross(normals[i], normals[rest:])
        squared = (across * across).sum(axis=1)
        meets = squared > PARALLEL**2
        j, across, squared = rest + np.flatnonzero(meets), across[meets], squared[meets, None]
        point = (
            offsets[i] * np.cross(normals[j], across)
            + offsets[j, None] * np.cross(across, normals[i])
        ) / squared
        along = across / np.sqrt(squared)
        low, high = _clipped_lines(point, along, *faces)
        hit = high - low > INSIDE
        j, point, along, low, high = j[hit], point[hit], along[hit], low[hit], high[hit]
        total += len(j)
        if len(j):
            rate = along @ normals[rest:].T
            with np.errstate(divide="ignore", invalid="ignore"):
                position = (offsets[rest:] - point @ normals[rest:].T) / rate
            third = (np.abs(rate) > PARALLEL) & (stack[rest:] > stack[j, None])
            total += int(
                (
                    third & (position > low[:, None] + INSIDE) & (position < high[:, None] - INSIDE)
                ).sum()
            )
        if total > most:
            break
    return total


def _clipped_lines(
    point: Floats, along: Floats, normals: Floats, offsets: Floats
) -> tuple[Floats, Floats]:
    """Return the positions at which lines enter and leave a convex body, in reverse order where they miss it."""
    low, high = np.full(len(point), -math.inf), np.full(len(point), math.inf)
    for normal, offset in zip(normals, offsets, strict=True):
        rate, distance = along @ normal, offset - point @ normal
        with np.errstate(divide="ignore", invalid="ignore"):
            position = distance / rate
        high = np.where(rate > PARALLEL, np.minimum(high, position), high)
        low = np.where(rate < -PARALLEL, np.maximum(low, position), low)
        high = np.where((np.abs(rate) <= PARALLEL) & (distance < INSIDE), -math.inf, high)
    return low, high


def join_slivers(
    volumes: Floats, fixed: Bools, first: Ints, second: Ints, areas: Floats, least: float
) -> tuple[Ints, Bools]:
    """Join every cell with less than the `least` volume to the neighbour that shares most area with it.

    Slivers that choose each other become one cell and choose again, until all are large enough or have no neighbour.
    A fixed sliver goes to a fixed neighbour where it has one. What they make is fixed if its largest cell is, or if its
    fixed cells together are half of it or no sliver: rock that goes on beyond the model is not let go by naming all
    cells slivers.

    Parameters
    ----------
    volumes, fixed : (n,) of the cells
    first, second, areas : (k,) the cells on the two sides of each patch, and its area

    Returns
    -------
    the block (n,) of each cell, -1 where it is left out, and whether each block is fixed

    Examples
    --------
    >>> cells = np.array([1.0, 1e-12, 1.0])
    >>> join_slivers(cells, cells < 0, np.array([0, 1]), np.array([1, 2]), np.array([1.0, 2.0]), 1e-9)[0].tolist()
    [0, 1, 1]
    """
    count = len(volumes)
    root = np.arange(count)
    volume = volumes.copy()
    small, is_fixed = volume < least, fixed
    while small.any():
        best = _best_neighbour(root[first], root[second], areas, small, is_fixed)
        joining = np.flatnonzero(best >= 0)
        if len(joining) == 0:
            break
        root, volume = _joined(root, volume, volumes, joining, best[joining])
        small = (volume < least) & (root == np.arange(count))
        is_fixed = fixed | (
            np.bincount(root[fixed], volumes[fixed], count) >= np.minimum(least, 0.5 * volume)
        )
    is_isolated = small[root]
    hosts, block = np.unique(root[~is_isolated], return_inverse=True)
    cell_block = np.full(count, -1, dtype=np.int64)
    cell_block[~is_isolated] = block
    return cell_block, is_fixed[hosts]


def _best_neighbour(first: Ints, second: Ints, areas: Floats, small: Bools, fixed: Bools) -> Ints:
    """Return the neighbour that each small cell is joined to, (n,), -1 for all other cells."""
    count = len(small)
    cell, neighbour = np.concatenate([first, second]), np.concatenate([second, first])
    is_candidate = small[cell] & (cell != neighbour)
    keys, index = np.unique(
        cell[is_candidate] * count + neighbour[is_candidate], return_inverse=True
    )
    shared = np.bincount(index.reshape(-1), np.concatenate([areas, areas])[is_candidate], len(keys))
    cell, neighbour = keys // count, keys % count
    order = np.lexsort((shared, fixed[cell] & fixed[neighbour], cell))
    best = np.full(count, -1, dtype=np.int64)
    best[cell[order]] = neighbour[order]  # the last assignment wins: the largest shared area
    return best


def _joined(
    root: Ints, volume: Floats, cells: Floats, joining: Ints, hosts: Ints
) -> tuple[Ints, Floats]:
    """Return roots and volumes once the cells `joining` are part of the cells `hosts`; the largest cell is the root."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count = len(root)
    graph = coo_array(
        (np.ones(len(joining), dtype=np.bool_), (joining, hosts)), shape=(count, count)
    )
    components, component = connected_components(graph, directed=False)
    order = np.lexsort((cells, component[root]))
    host = np.zeros(components, dtype=np.int64)
    host[component[root[order]]] = (
        order  # the last assignment wins: the largest cell of each component
    )
    new_root: Ints = host[component[root]]
    return new_root, np.where(
        new_root == np.arange(count), np.bincount(new_root, cells, count), volume
    )


@dataclass(frozen=True)
class BenchCut:
    """A body cut into blocks, with the evidence that nothing is lost.

    Attributes
    ----------
    assembly : the blocks; those at the far faces of the body are `fixed`
    body_volume : m³
    volume_error : |blocks + left out - body| / body
    area_error : sum over all joint faces of |area - area of the face on its other side|, in parts of their sum; faces
        without another side count in full
    plane_error : how far corners are at most from the planes that made their faces, m
    joint_area : half the sum of all joint faces before slivers were joined, m²
    blocks, fixed : how many
    slivers_joined : cells smaller than `min_volume` joined to a neighbour; volume_joined : m³
    slivers_left_out, volume_left_out : cells without a neighbour, m³
    min_volume : m³
    """

    assembly: Assembly
    body_volume: float
    volume_error: float
    area_error: float
    plane_error: float
    joint_area: float
    blocks: int
    fixed: int
    slivers_joined: int
    volume_joined: float
    slivers_left_out: int
    volume_left_out: float
    min_volume: float


def cut_bench(
    body: ConvexBody, planes: SetPlanes, max_blocks: int = 20000, min_volume: float = 0.0
) -> BenchCut:
    """Cut a convex body into blocks along planes that all go through it.

    Cells smaller than `min_volume` (m³; at least 1e-9 of the body) are joined to the neighbour with which they share
    the largest patch; cells at the far faces rather to one that is there too. A block is fixed where it (not slivers
    joined to it, unless they make up half of it or `min_volume` together) has a face on a far face of the body.

    Raises
    ------
    GeometryError
        E220 more blocks than `max_blocks`; E224 volumes or areas do not add up; E225 the body is below `min_volume`.

    Examples
    --------
    >>> from slopekit.geometry.rock.bench import bench_body
    >>> from slopekit.geometry.rock.joint_sets import JointSet, planes_of_sets
    >>> body = bench_body(np.array([0.0, -1.0, 0.0]), np.array([0.0, 0.0, 1.0]), 9.0, 9.0, 9.0)
    >>> sets = [JointSet(np.eye(3)[axis], spacing=3.0, offset=1.5 * (axis == 0)) for axis in range(3)]
    >>> cut = cut_bench(body, planes_of_sets(sets, body, np.random.default_rng(0)))
    >>> cut.blocks, cut.fixed, len(cut.assembly.patches)
    (27, 23, 54)
    """
    lowest, highest = body.corners.min(axis=0), body.corners.max(axis=0)
    middle, half = (lowest + highest) / 2.0, body.size / 2.0
    corners = (body.corners - middle) / half
    normals, offsets = ascending(
        planes.normals, (planes.offsets - planes.normals @ middle) / half, planes.joint
    )
    face_offsets = (body.offsets - body.normals @ middle) / half
    stacks = stacks_of_planes(normals, offsets, planes.joint, corners)
    refuse_too_many(normals, offsets, (body.normals, face_offsets), stacks, max_blocks)

    rock, soup = cut_with_stacks((body.normals, face_offsets), normals, offsets, stacks, corners)
    cells = cells_of(soup, normals, offsets, stacks)
    faces = faces_of(soup, cells.of_triangle, normals)
    opposite = opposite_faces(cells, faces, len(offsets))
    body_volume = float(rock.volume())

    is_inner = faces.plane < len(offsets)
    joint_area = float(faces.areas[is_inner].sum()) / 2.0
    differences = np.where(opposite >= 0, np.abs(faces.areas - faces.areas[opposite]), faces.areas)[
        is_inner
    ]
    area_error = float(differences.sum()) / (2.0 * joint_area) if joint_area else 0.0
    volume_error = abs(float(cells.volumes.sum()) - body_volume) / body_volume
    corner_error = plane_error(soup, normals, offsets)
    if max(volume_error, area_error) > CUT_BALANCE or corner_error > OFF_PLANE:
        message = (
            f"the blocks do not add up to the bench (volume to {volume_error:.2g}, joints to {area_error:.2g}, "
            f"corners {corner_error * half:.2g} m off their planes)"
        )
        raise GeometryError(
            [Fault("E224", message, "", "Please report it; another offset of a set may help.")]
        )

    is_at_end = np.zeros(len(cells.volumes), dtype=np.bool_)
    is_far = np.concatenate([np.zeros(len(offsets), dtype=np.bool_), body.is_far])
    is_at_end[faces.cell[is_far[faces.plane] & (faces.areas > NO_AREA)]] = True
    below = np.flatnonzero(faces.is_below & (opposite >= 0))
    least = max(min_volume / half**3, NUMERICAL_SLIVER * body_volume)
    sides = faces.cell[below], faces.cell[opposite[below]]
    block, fixed = join_slivers(cells.volumes, is_at_end, *sides, faces.areas[below], least)
    count, slivers_left_out = len(fixed), int((block < 0).sum())
    slivers_joined = len(block) - count - slivers_left_out
    if count > max_blocks:
        raise too_many(count, max_blocks)
    if count == 0:
        message = f"the bench has {body_volume * half**3:.4g} m³, less than min_volume = {min_volume:.4g} m³"
        raise GeometryError([Fault("E225", message)])
    if count == 1 and slivers_joined:
        message = f"min_volume = {min_volume:.4g} m³ joins all {len(cells.volumes)} blocks into one, on no joint"
        raise GeometryError([Fault("E225", message, "", "It is the volume of slivers: 0.01 m3.")])
    scale = (middle, half)
    patches = _patches(soup, faces, below, opposite[below], block, planes.joint, normals, scale)
    assembly = _assembly(soup, cells, faces, opposite, block, fixed, patches, scale)
    volume_left_out = float(cells.volumes[block < 0].sum()) * half**3
    small = cells.volumes < least
    volume_joined = float(cells.volumes[small & (block >= 0)].sum()) * half**3
    return BenchCut(
        assembly,
        body_volume * half**3,
        volume_error,
        area_error,
        corner_error * half,
        joint_area * half**2,
        count,
        int(fixed.sum()),
        slivers_joined,
        volume_joined,
        slivers_left_out,
        volume_left_out,
        least * half**3,
    )


def _patches(
    soup: Soup,
    faces: Faces,
    below: Ints,
    above: Ints,
    block: Ints,
    joint: Ints,
    normals: Floats,
    scale: tuple[Floats, float],
) -> Patches:
    """Return the patches between different blocks; `below`, `above` are the faces on the two sides of each."""
    minus, plus = block[faces.cell[below]], block[faces.cell[above]]
    is_patch = (minus != plus) & (minus >= 0) & (plus >= 0) & (faces.areas[below] > NO_AREA)
    below = below[is_patch]
    corners, first = corners_of_faces(soup, faces.of_triangle, below, STRAIGHT)
    middle, half = scale
    plane = faces.plane[below]
    return Patches(
        plus[is_patch],
        minus[is_patch],
        joint[plane],
        frozen(normals[plane]),
        frozen(faces.areas[below] * half**2),
        frozen(faces.centroids[below] * half + middle),
        frozen(corners * half + middle),
        first,
    )


def _assembly(
    soup: Soup,
    cells: Cells,
    faces: Faces,
    opposite: Ints,
    cell_block: Ints,
    fixed: Bools,
    patches: Patches,
    scale: tuple[Floats, float],
) -> Assembly:
    # `scale`: the middle (3,) and half the size of the body, m
    middle, half = scale
    in_block = cell_block >= 0
    block, count = cell_block[in_block], len(fixed)
    weights = cells.volumes[in_block]
    volumes = np.bincount(block, weights, count)
    moments = [np.bincount(block, weights * cells.centroids[in_block, k], count) for k in range(3)]
    centroids = np.stack(moments, axis=1) / volumes[:, None]
    # faces between cells of one block are within it
    face_block = cell_block[faces.cell]
    outer = (face_block >= 0) & ((opposite < 0) | (face_block[opposite] != face_block))
    on_surface = outer[faces.of_triangle]
    return Assembly(
        frozen(volumes * half**3),
        frozen(centroids * half + middle),
        fixed,
        patches,
        False,
        frozen(soup.vertices * half + middle),
        soup.triangles[on_surface],
        cell_block[cells.of_triangle[on_surface]],
    )
