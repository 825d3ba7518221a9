"""Mesh files: what is read, what is refused, and in which precision."""

import json

import numpy as np
import pytest

from slopekit.core.errors import DesignError
from slopekit.exchange.solids import save_gltf
from slopekit.geometry.solids import meshes
from slopekit.geometry.solids.meshes import outward, read_mesh
from tests.scenes import ellipsoid_mesh, save, sheet


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply", "off", "glb"])
def test_formats(tmp_path, suffix) -> None:
    """The same closed body from each; single precision in STL, PLY and GLB, which is y-up (glTF 2.0, 3.4)."""
    vertices, triangles = ellipsoid_mesh(2)
    x, y, z = vertices.T
    written = np.stack([x, z, -y], axis=1) if suffix == "glb" else vertices
    found, faces, closed = read_mesh(
        save(tmp_path / f"body.{suffix}", (written, triangles)), "body"
    )
    assert closed
    assert (len(found), len(faces)) == (len(vertices), len(triangles))
    tolerance = 1e-8 if suffix in ("obj", "off") else 1e-5
    assert np.sort(found, axis=0) == pytest.approx(np.sort(vertices, axis=0), abs=tolerance)


@pytest.mark.parametrize(
    ("suffix", "up"), [("obj", "y"), ("stl", "y"), ("dxf", "y"), ("glb", "z"), ("glb", "y")]
)
def test_the_axis_that_points_up_where_the_format_does_not_say_it(tmp_path, suffix, up) -> None:
    vertices, triangles = ellipsoid_mesh(2)
    x, y, z = vertices.T
    written = np.stack([x, z, -y], axis=1) if up == "y" else vertices
    path = tmp_path / f"body.{suffix}"
    if suffix == "dxf":
        drawing = pytest.importorskip("ezdxf").new()
        with drawing.modelspace().add_mesh().edit_data() as data:
            data.vertices, data.faces = written.tolist(), triangles.tolist()
        drawing.saveas(path)
    else:
        save(path, (written, triangles))
    found, faces, closed = read_mesh(path, "body", up=up)
    assert closed
    assert np.sort(found, axis=0) == pytest.approx(np.sort(vertices, axis=0), abs=1e-5)
    assert (outward(found, faces) == faces).all()  # turned, not mirrored


@pytest.mark.parametrize("suffix", ["glb", "gltf"])
def test_nodes_of_gltf_stand_where_their_matrices_put_them(tmp_path, suffix) -> None:
    """A box of 1 x 2 x 3 m (east, north, up) about (10, 20, 30), as a y-up scene of nested and mirrored nodes."""
    import trimesh

    box = trimesh.creation.box([1.0, 3.0, 2.0])  # x, up, south
    turn = trimesh.transformations.rotation_matrix(np.pi / 2, [0.0, 0.0, 1.0])
    box.apply_transform(np.linalg.inv(turn))
    scene = trimesh.Scene()
    place = trimesh.transformations.translation_matrix([10.0, 30.0, -20.0])
    scene.graph.update(
        frame_from="world", frame_to="place", matrix=place @ np.diag([-1.0, 1.0, 1.0, 1.0])
    )
    scene.add_geometry(box, node_name="box", parent_node_name="place", transform=turn)
    save_gltf(scene, tmp_path / f"box.{suffix}")
    vertices, triangles, closed = read_mesh(tmp_path / f"box.{suffix}", "box")
    assert closed
    assert vertices.min(axis=0) == pytest.approx([9.5, 19.0, 28.5], abs=1e-5)
    assert vertices.max(axis=0) == pytest.approx([10.5, 21.0, 31.5], abs=1e-5)
    assert (outward(vertices, triangles) == triangles).all()


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"mode": 6}, "it has fans of triangles; save it with triangles"),
        ({"normalized": True}, "its coordinates are normalized whole numbers; save it with floats"),
    ],
)
def test_gltf_that_the_reader_would_pass_over_is_refused(tmp_path, change, says) -> None:
    """KHR_mesh_quantization writes 1 as 32767 of a normalized short: the body was 32767 times as large."""
    path = save_gltf_of(tmp_path / "body.gltf", ellipsoid_mesh(1))
    document = json.loads(path.read_text())
    (primitive,) = document["meshes"][0]["primitives"]
    (
        primitive
        if "mode" in change
        else document["accessors"][primitive["attributes"]["POSITION"]]
    ).update(change)
    path.write_text(json.dumps(document))
    with pytest.raises(DesignError, match=f"E172 the mesh body cannot be read .{says}"):
        read_mesh(path, "body")


def save_gltf_of(path, mesh):
    import trimesh

    save_gltf(trimesh.Scene(trimesh.Trimesh(*mesh, process=False)), path)
    return path


def test_a_body_that_is_inside_out_is_turned(tmp_path) -> None:
    vertices, triangles = ellipsoid_mesh(2)
    found, faces, closed = read_mesh(
        save(tmp_path / "body.obj", (vertices, triangles[:, ::-1])), "body"
    )
    a, b, c = (found[outward(found, faces)[:, k]] for k in range(3))
    assert closed
    assert np.einsum("ni,ni->", a - 40.0, np.cross(b - 40.0, c - 40.0)) > 0.0


def test_sheets_and_bodies_with_holes_are_open(tmp_path) -> None:
    vertices, triangles = ellipsoid_mesh(2)
    assert not read_mesh(save(tmp_path / "hole.obj", (vertices, triangles[1:])), "hole")[2]
    assert not read_mesh(save(tmp_path / "sheet.obj", sheet(30.0, 20.0, 40.0)), "sheet")[2]


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("empty.stl", b""),
        ("junk.stl", b"hello"),
        ("none.stl", b"solid x\nendsolid x\n"),
        ("no.format", b"1 2 3"),
        ("cut.stl", b"\0" * 80 + b"\xff\xff\0\0" + b"\0" * 60),
        ("flat.obj", b"v 0 0 0\nv 1 0 0\n"),
        ("odd.ply", b"ply\nformat ascii 1.0\nelement vertex many\n"),
        ("nan.obj", b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ],
)
def test_what_is_no_mesh(tmp_path, name, content) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(DesignError) as caught:
        read_mesh(path, name)
    assert caught.value.codes == ("E172",)


def test_too_many_triangles(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(meshes, "_MOST_TRIANGLES", 100)
    with pytest.raises(DesignError, match="Decimate") as caught:
        read_mesh(save(tmp_path / "body.obj", ellipsoid_mesh(2)), "body")
    assert caught.value.codes == ("E172",)
