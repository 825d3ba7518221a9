"""Contacts of closed meshes against areas counted by hand: stacked cubes, beams, frames, overlaps, gaps, bad meshes."""

import itertools

import numpy as np
import pytest

from slopekit.core.errors import GeometryError
from slopekit.geometry.solids.meshes import read_mesh
from slopekit.geometry.solids.solids import mesh_assembly

TRIANGLES = np.array(
    [
        [0, 2, 1],
        [0, 3, 2],
        [4, 5, 6],
        [4, 6, 7],
        [0, 1, 5],
        [0, 5, 4],
        [1, 2, 6],
        [1, 6, 5],
        [2, 3, 7],
        [2, 7, 6],
        [3, 0, 4],
        [3, 4, 7],
    ]
)
UTM = np.array([500000.0, 4.0e6, 300.0])


def box(lowest, highest):
    (a, b, c), (d, e, f) = lowest, highest
    corners = [[x, y, z] for z in (c, f) for x, y in ((a, b), (d, b), (d, e), (a, e))]
    return np.array(corners, dtype=np.float64), TRIANGLES


def cube(x: float, y: float, z: float, size: float = 1.0):
    return box((x, y, z), (x + size, y + size, z + size))


def turned(meshes, shift=(0.0, 0.0, 0.0)):
    """By 20° about x and 35° about z, then moved."""
    (cx, sx), (cz, sz) = ((np.cos(a), np.sin(a)) for a in np.radians([20.0, 35.0]))
    turn = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]]) @ np.array(
        [[1, 0, 0], [0, cx, -sx], [0, sx, cx]]
    )
    return [(vertices @ turn.T + shift, triangles) for vertices, triangles in meshes]


def assemble(meshes, tolerance: float | None = None):
    return mesh_assembly(meshes, np.arange(len(meshes)) == 0, tolerance)


def frame():
    """A square frame 3 x 3 x 1 with a hole 1 x 1 through it, one closed mesh: top and bottom are not convex."""
    from manifold3d import Manifold

    body = Manifold.cube([3.0, 3.0, 1.0]) - Manifold.cube([1.0, 1.0, 3.0]).translate(
        [1.0, 1.0, -1.0]
    )
    mesh = body.to_mesh64()
    return np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts).astype(np.int64)


@pytest.mark.parametrize("shift", [np.zeros(3), UTM], ids=["local", "UTM"])
def test_stacked_cubes(shift) -> None:
    """4 x 4 x 4 unit cubes touch in 3 x 4 x 4 x 3 squares, one patch each; UTM coordinates are rounded to 5e-10 m."""
    cut = assemble(turned([cube(*place) for place in itertools.product(range(4), repeat=3)], shift))
    patches, digits = cut.assembly.patches, 1e-9 if shift[0] else 1e-12
    assert len(patches) == 144
    assert (np.diff(patches.first) == 4).all()
    assert patches.areas == pytest.approx(np.ones(144), rel=digits * 10.0)
    assert cut.contact == pytest.approx(144.0, rel=digits)
    a, b, c = cut.assembly.vertices[cut.assembly.triangles].transpose(1, 0, 2)
    whole = float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2.0
    assert whole - 2.0 * cut.contact == pytest.approx(96.0, rel=digits * 10.0)
    assert cut.assembly.volumes == pytest.approx(np.ones(64), rel=digits * 10.0)
    assert (len(cut.overlaps), len(cut.gaps), len(cut.untouching), len(cut.unchecked)) == (
        0,
        0,
        0,
        0,
    )
    middle = patches.corners.reshape(-1, 4, 3).mean(axis=1)
    assert patches.centroids == pytest.approx(middle, abs=1e-8)
    # into the plus block: from the middle of the minus block to that of the plus block is one normal
    step = cut.assembly.centroids[patches.plus] - cut.assembly.centroids[patches.minus]
    assert patches.normals == pytest.approx(step, abs=1e-8)
    around = np.cross(
        patches.corners.reshape(-1, 4, 3)[:, 1] - patches.corners.reshape(-1, 4, 3)[:, 0],
        patches.corners.reshape(-1, 4, 3)[:, 2] - patches.corners.reshape(-1, 4, 3)[:, 1],
    )
    assert around == pytest.approx(patches.normals, abs=1e-8)


def test_a_beam_on_many_cubes_that_do_not_match() -> None:
    """A beam 20.5 m long on 20 cubes, and a second beam across half of it, 0.35 m wide."""
    beam = box((0.0, 0.25, 1.0), (20.5, 0.75, 1.5))
    cut = assemble(
        turned(
            [beam, *(cube(k, 0.0, 0.0) for k in range(20)), box((3.3, 0.5, 1.5), (3.65, 4.0, 2.0))]
        )
    )
    areas = np.sort(cut.assembly.patches.areas)
    assert areas == pytest.approx(np.sort([0.35 * 0.25] + [0.5] * 20 + [1.0] * 19), rel=1e-12)
    assert cut.contact == pytest.approx(0.0875 + 10.0 + 19.0, rel=1e-12)
    assert (len(cut.overlaps), len(cut.gaps)) == (0, 0)


def test_faces_with_a_hole() -> None:
    """A plate on a frame: 8 of 9 m² in convex parts; a cube in the hole: four sides of 1 m² and the plate on top."""
    plate = box((0.0, 0.0, 1.0), (3.0, 3.0, 1.5))
    cut = assemble(turned([plate, frame(), cube(1.0, 1.0, 0.0)], (5.0, 1.0, 0.0)))
    patches = cut.assembly.patches
    between = [{int(a), int(b)} for a, b in zip(patches.plus, patches.minus, strict=True)]
    for pair, area in (({0, 1}, 8.0), ({1, 2}, 4.0), ({0, 2}, 1.0)):
        assert sum(patches.areas[[at == pair for at in between]]) == pytest.approx(area, rel=1e-12)
    assert cut.assembly.volumes[1] == pytest.approx(8.0)
    assert np.diff(cut.assembly.centroids[[1, 2]], axis=0)[0] == pytest.approx(
        np.zeros(3), abs=1e-12
    )
    assert assemble([frame()]).assembly.centroids[0] == pytest.approx([1.5, 1.5, 0.5])
    assert len(cut.overlaps) == 0


def test_overlaps_have_their_volume() -> None:
    """2 mm deep over 1 m², a corner 0.5 x 0.5 x 0.25, and a small cube within."""
    blocks = [cube(0, 0, 0), cube(0.998, 0, 0), cube(-0.5, 0.5, 0.75), cube(0.4, 0.4, 0.4, 0.1)]
    for found in (assemble(blocks), assemble(turned(blocks))):
        assert found.overlaps.pairs.tolist() == [[0, 1], [0, 2], [0, 3]]
        assert found.overlaps.amounts == pytest.approx([0.002, 0.0625, 0.001], rel=1e-9)
        assert found.overlaps.distances[0] == pytest.approx(0.002, rel=5e-3)


def test_gaps_and_tolerance() -> None:
    """2 mm apart over 1 m²: a gap by default, a contact halfway between at a tolerance of 3 mm."""
    blocks = [cube(0, 0, 0), cube(0, 0, 1.002), cube(7, 0, 0)]
    cut = assemble(turned(blocks))
    assert cut.gaps.pairs.tolist() == [[0, 1]]
    assert (cut.gaps.distances[0], cut.gaps.amounts[0]) == pytest.approx((0.002, 1.0))
    assert cut.untouching.tolist() == [0, 1, 2]
    closed = assemble(blocks, tolerance=0.003)
    assert closed.assembly.patches.centroids[0] == pytest.approx([0.5, 0.5, 1.001])
    assert len(closed.gaps) == 0
    assert closed.untouching.tolist() == [2]


def test_plus_is_the_block_that_is_not_fixed() -> None:
    cut = mesh_assembly([cube(0, 0, 1), cube(0, 0, 0)], np.array([False, True]))
    assert (cut.assembly.patches.plus.tolist(), cut.assembly.patches.minus.tolist()) == ([0], [1])
    assert cut.assembly.patches.normals[0] == pytest.approx([0.0, 0.0, 1.0])


def test_inside_out_and_loose_triangles_and_two_bodies() -> None:
    """A mesh inside out is turned and said; repeated vertices are merged; two bodies are two shells."""
    vertices, triangles = cube(0, 0, 1)
    soup = (vertices[triangles].reshape(-1, 3), np.arange(36).reshape(-1, 3)[:, ::-1])
    far = cube(5, 0, 0)
    both = (
        np.concatenate([vertices + np.array([0, 0, 1]), far[0]]),
        np.concatenate([triangles, far[1] + 8]),
    )
    cut = assemble([cube(0, 0, 0), soup, both])
    assert cut.shells.tolist() == [1, 1, 2]
    assert cut.assembly.volumes == pytest.approx([1.0, 1.0, 2.0])
    assert cut.assembly.patches.areas == pytest.approx([1.0, 1.0])


@pytest.mark.parametrize("suffix", ["stl", "obj", "glb"])
def test_files(tmp_path, suffix) -> None:
    """Two cubes through files: GLB with a normal for each face repeats its vertices, STL all of them."""
    import trimesh

    meshes = []
    for k in range(2):
        vertices, triangles = cube(0, 0, float(k))
        split = trimesh.Trimesh(
            vertices[triangles].reshape(-1, 3), np.arange(36).reshape(-1, 3), process=False
        )
        split.vertex_normals = np.repeat(split.face_normals, 3, axis=0)
        path = tmp_path / f"cube{k}.{suffix}"
        path.write_bytes(
            split.export(file_type=suffix)
            if suffix != "obj"
            else split.export(file_type="obj").encode()
        )
        points, corners, closed = read_mesh(path, "cube")
        assert closed
        assert len(points) == 8
        meshes.append((points, corners))
    assert assemble(meshes).contact == pytest.approx(1.0, rel=1e-6)


def broken(what: str):
    vertices, triangles = cube(0, 0, 1)
    if what == "hole":
        return vertices, triangles[1:]
    if what == "sense":
        return vertices, np.concatenate([triangles[:1, ::-1], triangles[1:]])
    if what == "flat":
        return vertices[:4], np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    if what == "twice":
        return vertices, np.concatenate([triangles, triangles])
    return vertices * 1e-5, triangles  # dust


@pytest.mark.parametrize(
    ("what", "code"),
    [("hole", "E216"), ("sense", "E216"), ("twice", "E216"), ("flat", "E227"), ("dust", "E230")],
)
def test_meshes_that_are_no_blocks(what, code) -> None:
    with pytest.raises(GeometryError) as caught:
        mesh_assembly([cube(0, 0, 0), broken(what)], np.array([True, False]), names=["base", "B7"])
    assert caught.value.codes == (code,)
    assert "B7" in caught.value.faults[0].message


def test_the_hole_is_counted() -> None:
    with pytest.raises(GeometryError, match="3 edges bound one triangle only"):
        assemble([cube(0, 0, 0), broken("hole")])
