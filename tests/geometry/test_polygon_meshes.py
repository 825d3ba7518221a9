"""Faces of more than three corners: cut by their shape, whatever file, first corner and sense they come in."""

import struct
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slopekit.core.errors import DesignError
from slopekit.geometry.solids.meshes import read_mesh, triangulated
from slopekit.geometry.solids.sliding_mass import volume_moments

ELL = [(0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0)]  # 5 m²
ARROW = [(0.0, 0.0), (4.0, 2.0), (0.0, 4.0), (1.0, 2.0)]  # a concave quadrilateral, 6 m²


def prism(outline, first: int = 0):
    """Vertices and faces of an outline 1 m high, its two ends as polygons from the corner `first` on."""
    count = len(outline)
    here = [*range(first, count), *range(first)]
    vertices = [(x, y, z) for z in (0.0, 1.0) for x, y in outline]
    ends = [here[::-1], [k + count for k in here]]
    return vertices, [
        *ends,
        *([a, b, b + count, a + count] for a, b in pairwise([*range(count), 0])),
    ]


def as_obj(vertices, faces) -> bytes:
    rows = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices]
    return "\n".join(
        [*rows, *("f " + " ".join(f"{k + 1}" for k in face) for face in faces)]
    ).encode()


def as_odd_obj(vertices, faces) -> bytes:
    """Indices with texture and normals, from the end on, and a line that goes on in the next."""
    rows = [
        "# made by hand",
        *(f"v  {x!r}\t{y!r} {z!r} 0.5 0.5 0.5" for x, y, z in vertices),
        "vt 0 0",
        "vn 0 0 1",
    ]
    rows += [
        "usemtl rock",
        *("f " + " \\\n".join(f"{k - len(vertices)}/1/1" for k in face) + " # x" for face in faces),
    ]
    return "\r\n".join(rows).replace("\\\n", "\\\r\n").encode()


def as_off(vertices, faces) -> bytes:
    rows = [f"{x!r} {y!r} {z!r}" for x, y, z in vertices]
    rows += [" ".join(map(str, [len(face), *face])) for face in faces]
    return (
        f"OFF\n# a comment\n{len(vertices)} {len(faces)} 0\n\n".encode() + "\n".join(rows).encode()
    )


def as_coloured_off(vertices, faces) -> bytes:
    rows = [f"{x!r} {y!r} {z!r} 9 9 9 255" for x, y, z in vertices]
    rows += [" ".join(map(str, [len(face), *face, 0.1, 0.2, 0.3])) for face in faces]
    return f"COFF {len(vertices)} {len(faces)} 0\n".encode() + "\n".join(rows).encode()


def _ply_head(form: str, vertices, faces, more: str = "") -> bytes:
    xyz = "".join(f"property double {axis}\n" for axis in "xyz")
    return (
        f"ply\nformat {form} 1.0\ncomment by hand\nelement vertex {len(vertices)}\n{xyz}property uchar red\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\n{more}end_header\n"
    ).encode()


def as_ply(vertices, faces) -> bytes:
    rows = [f"{x!r} {y!r} {z!r} 7" for x, y, z in vertices]
    rows += [" ".join(map(str, [len(face), *face])) for face in faces]
    return _ply_head("ascii", vertices, faces) + "\n".join(rows).encode()


def as_binary_ply(vertices, faces) -> bytes:
    rows = [struct.pack("<3dB", *vertex, 7) for vertex in vertices]
    rows += [struct.pack(f"<B{len(face)}i", len(face), *face) for face in faces]
    return _ply_head("binary_little_endian", vertices, faces) + b"".join(rows)


def as_big_endian_ply(vertices, faces) -> bytes:
    """Faces with a number behind their list."""
    rows = [struct.pack(">3dB", *vertex, 7) for vertex in vertices]
    rows += [struct.pack(f">B{len(face)}if", len(face), *face, 0.5) for face in faces]
    return _ply_head("binary_big_endian", vertices, faces, "property float quality\n") + b"".join(
        rows
    )


WRITERS = {
    "plain.obj": as_obj,
    "odd.obj": as_odd_obj,
    "plain.off": as_off,
    "coloured.off": as_coloured_off,
    "text.ply": as_ply,
    "binary.ply": as_binary_ply,
    "big.ply": as_big_endian_ply,
}


@pytest.mark.parametrize("first", range(6))
@pytest.mark.parametrize("name", WRITERS)
def test_an_end_that_is_not_convex(tmp_path, name, first) -> None:
    """The volume and the surface of an L 1 m high are 5 m³ and 2 · 5 + 12 m²; as fans its ends were 7 m²."""
    (tmp_path / name).write_bytes(WRITERS[name](*prism(ELL, first)))
    vertices, triangles, closed = read_mesh(tmp_path / name, name)
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    assert closed
    assert len(vertices) == 12
    assert volume_moments(vertices, triangles)[0] == pytest.approx(5.0, rel=1e-12)
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0 == pytest.approx(
        22.0, rel=1e-12
    )


@pytest.mark.parametrize("first", range(4))
@pytest.mark.parametrize("kind", ["MESH", "3DFACE", "polyface"])
def test_faces_of_dxf_that_are_not_convex(tmp_path, kind, first) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    vertices, faces = prism(ARROW, first)
    drawing = ezdxf.new()
    space = drawing.modelspace()
    if kind == "MESH":
        with space.add_mesh().edit_data() as data:
            data.vertices, data.faces = vertices, faces
    elif kind == "3DFACE":
        for face in faces:
            space.add_3dface([vertices[k] for k in face])
    else:
        space.add_polyface().append_faces([[vertices[k] for k in face] for face in faces])
    drawing.saveas(tmp_path / "arrow.dxf")
    points, triangles, closed = read_mesh(tmp_path / "arrow.dxf", "arrow")
    a, b, c = points[triangles].transpose(1, 0, 2)
    assert closed
    assert volume_moments(points, triangles)[0] == pytest.approx(6.0, rel=1e-12)
    sides = 2 * np.hypot(4, 2) + 2 * np.hypot(1, 2)
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0 == pytest.approx(
        12.0 + sides, rel=1e-12
    )


@given(
    radii=st.lists(st.floats(0.2, 1.0), min_size=4, max_size=12),
    warp=st.floats(0.0, 0.02),
    seed=st.integers(0, 1000),
    first=st.integers(0, 11),
    backward=st.booleans(),
)
def test_a_warped_face_is_cut_alike_from_both_of_its_sides(
    radii, warp, seed, first, backward
) -> None:
    """Turned anyhow in space, at map coordinates: the same triangles, and without warp the area by the shoelace."""
    rng = np.random.default_rng(seed)
    count = len(radii)
    angle = 2.0 * np.pi * (np.arange(count) + rng.uniform(-0.2, 0.2, count)) / count
    flat = np.array(radii)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    points = np.column_stack([flat, warp * rng.uniform(-1, 1, count)]) @ turn + np.array(
        [512300.0, 4187650.0, 120.0]
    )
    face = np.roll(np.arange(count)[:: -1 if backward else 1], first).tolist()
    ours, theirs = (
        triangulated(points, [list(range(count))]),
        triangulated(points, [[0, 1, 2], face])[1:],
    )
    assert {frozenset(row) for row in ours.tolist()} == {frozenset(row) for row in theirs.tolist()}
    local = points - points[0]
    areas = [
        np.cross(local[t[:, 1]] - local[t[:, 0]], local[t[:, 2]] - local[t[:, 0]]).sum(axis=0)
        for t in (ours, theirs)
    ]
    np.testing.assert_allclose(areas[1], -areas[0] if backward else areas[0], atol=1e-9)
    if warp == 0.0:
        x, y = flat.T
        whole = x @ np.roll(y, -1) - y @ np.roll(x, -1)
        corners = local[ours]
        sizes = np.linalg.norm(
            np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
        )
        assert sizes.sum() == pytest.approx(whole, abs=1e-8)


@pytest.mark.parametrize(
    ("outline", "area"),
    [
        ([(0, 0), (1, 0), (2, 0), (2, 2), (0, 2)], 4.0),  # three corners in line
        (
            [(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 3), (3, 3), (3, 1), (1, 1)],
            12.0,
        ),  # a hole on a slit
        ([(0, 0), (2, 0), (2, 0), (2, 2), (0, 2), (0, 0)], 4.0),  # corners given twice
        ([(0, 0), (2, 0), (2, 2), (1, 1), (0, 2)], 3.0),
    ],
)
def test_outlines_that_touch_themselves(outline, area) -> None:
    points = np.array([(x, 0.0, y) for x, y in outline], dtype=float)
    a, b, c = points[triangulated(points, [list(range(len(points)))])].transpose(1, 0, 2)
    assert np.cross(b - a, c - a).sum(axis=0) / 2.0 == pytest.approx([0.0, -area, 0.0])
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0 == pytest.approx(area)


PENTAGRAM = [(float(np.cos(0.8 * np.pi * k)), float(np.sin(0.8 * np.pi * k))) for k in range(5)]
BOW, EVEN_BOW = (
    [(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 3.0)],
    [(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0)],
)


@pytest.mark.parametrize(
    "outline", [BOW, EVEN_BOW, PENTAGRAM, [*ELL[:2], ELL[4], *ELL[2:4], ELL[5]]]
)
@pytest.mark.parametrize("name", ["plain.obj", "plain.off", "binary.ply"])
def test_a_face_that_crosses_itself_is_refused(tmp_path, outline, name) -> None:
    (tmp_path / name).write_bytes(WRITERS[name](*prism(outline)))
    with pytest.raises(DesignError) as caught:
        read_mesh(tmp_path / name, name)
    (fault,) = caught.value.faults
    assert (fault.code, fault.advice) == ("E172", "Split it, or order its corners.")
    assert (
        f"the mesh {name} has a face that crosses itself: {len(outline)} corners, ("
        in fault.message
    )


def test_a_face_of_a_dxf_that_crosses_itself_is_refused(tmp_path) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    drawing = ezdxf.new()
    drawing.modelspace().add_3dface([(x, y, 0.0) for x, y in BOW])
    drawing.saveas(tmp_path / "bow.dxf")
    with pytest.raises(
        DesignError,
        match=r"E172 the mesh bow has a face that crosses itself: 4 corners, \(0\.000, ",
    ):
        read_mesh(tmp_path / "bow.dxf", "bow")


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("a.off", b"OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "it ends before the 2 faces"),
        ("a.off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n", "it ends before the 1 faces"),
        (
            "a.off",
            b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
            "a face names a vertex that is none of the 3",
        ),
        ("a.off", b"OFF BINARY\n\0\0\0", "it is no OFF file in text"),
        (
            "a.obj",
            b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n",
            "a face names a vertex that is none of the 3",
        ),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nf 1 2\n", "face 1 has fewer than three corners"),
        (
            "a.obj",
            b"v 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
            "a vertex has fewer than three coordinates",
        ),
        (
            "a.obj",
            b"v 0 0 0\nv 1 0 nan\nv 0 1 0\nv 1 1 0\nf 1 2 4 3\n",
            "a coordinate is no number",
        ),
        (
            "a.ply",
            b"ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\nend_header\n0\n",
            "has a type half",
        ),
        (
            "a.ply",
            _ply_head("binary_little_endian", [0], [0]) + b"\0" * 25 + b"\xff",
            "it has a list of 255 entries",
        ),
        ("a.ply", _ply_head("ascii", [], []), "it has no vertices, or no faces"),
        ("a.ply", _ply_head("ascii", [0, 0], [0]) + b"0 0 0 7\n", "it ends before all"),
        ("a.ply", _ply_head("binary_middle_endian", [0], [0]), "it has no header of a PLY file"),
        (
            "a.ply",
            b"ply\nformat ascii 1.0\nproperty int x\nelement vertex -1\nend_header\n",
            "it has no vertices",
        ),
        ("a.step", b"ISO-10303-21;", "its suffix is .step"),
    ],
)
def test_files_that_are_cut_short_or_no_mesh(tmp_path, name, content, says) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(DesignError) as caught:
        read_mesh(tmp_path / name, name)
    assert caught.value.codes == ("E172",)
    assert says in str(caught.value)
    assert "Error" not in str(caught.value)  # no name of Python's
