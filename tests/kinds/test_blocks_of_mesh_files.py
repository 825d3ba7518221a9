"""Blocks of mesh files: which way is up in them, and faces of any shape."""

import math

import numpy as np
import pytest
import trimesh

import slopekit as sk
from slopekit.block_scene import BlockScene
from slopekit.exchange.solids import save_gltf
from slopekit.geometry.solids.meshes import read_mesh
from slopekit.geometry.solids.solids import mesh_assembly
from tests.geometry.test_polygon_meshes import ELL, as_obj, prism


def slab_on_an_incline(folder, suffix: str, up: str, key: str = "") -> str:
    """A slab of 2 x 2 x 0.5 m on a block whose top dips 60° toward the south, as y-up or as z-up files."""
    turn = trimesh.transformations.rotation_matrix(math.radians(60.0), [1.0, 0.0, 0.0])
    for name, size, middle in (("base", [6.0, 4.0, 2.0], -1.0), ("slab", [2.0, 2.0, 0.5], 0.25)):
        body = trimesh.creation.box(
            size, trimesh.transformations.translation_matrix([0.0, 0.0, middle])
        )
        body.apply_transform(turn)
        if up == "y":
            body.vertices = body.vertices[:, [0, 2, 1]] * [1.0, 1.0, -1.0]
        path = folder / f"{name}.{suffix}"
        if suffix == "gltf":
            save_gltf(trimesh.Scene(body), path)
        else:
            body.export(path)
    more = f", up: {key}" if key else ""
    text = (
        f"slopekit: 1\nkind: blocks\nrock: {{unit_weight: 25}}\nblocks:\n  base: {{mesh: base.{suffix}, fixed: true"
        f"{more}}}\n  slab: {{mesh: slab.{suffix}{more}}}\nstrength: {{joint: {{c: 0, phi: 30}}}}\n"
    )
    (folder / "slab.yaml").write_text(text)
    return str(folder / "slab.yaml")


@pytest.mark.parametrize(
    ("suffix", "up", "key"),
    [
        ("obj", "z", ""),
        ("stl", "z", ""),
        ("ply", "z", ""),
        ("glb", "y", ""),
        ("gltf", "y", ""),
        ("glb", "z", "z"),
        ("off", "y", "y"),
    ],
)
def test_a_slab_slides_down_the_dip_of_its_file(tmp_path, suffix, up, key) -> None:
    """tan φ / tan β; a GLB read as z-up had the slab on 30°: 1.0000."""
    result = sk.run(slab_on_an_incline(tmp_path, suffix, up, key))
    assert result.fos.limit == pytest.approx(
        math.tan(math.radians(30)) / math.tan(math.radians(60)), rel=1e-5
    )
    assert ("y is up in the files of base, slab" in str(result.sheet)) == (up == "y")
    assert "toward 180/60.0" in result.sheet.full


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (("up: y", "up: x"), "E172 blocks.base.up is 'x', it is y or z"),
        (
            ("mesh: base.obj, fixed: true, up: y", "up: y, fixed: true"),
            "E172 blocks.base.up says nothing without a mesh",
        ),
    ],
)
def test_an_axis_that_is_none(tmp_path, change, says) -> None:
    path = tmp_path / "slab.yaml"
    slab_on_an_incline(tmp_path, "obj", "y", "y")
    path.write_text(path.read_text().replace(*change, 1))
    with pytest.raises(sk.DesignError) as caught:
        sk.run(path)
    assert says in str(caught.value)


def test_the_hash_of_a_design_knows_which_way_is_up(tmp_path) -> None:
    """As z-up the hash is what it was before there was a choice."""
    stated = {key: sk.load(slab_on_an_incline(tmp_path, "glb", "y", key)) for key in ("", "y", "z")}
    hashes = {key: design.input_hash() for key, design in stated.items()}
    assert hashes[""] == hashes["y"] != hashes["z"]
    assert [stated[key].inputs()["blocks"][0]["mesh"].get("up") for key in ("", "y", "z")] == [
        "y",
        "y",
        None,
    ]


@pytest.mark.parametrize("suffix", ["glb", "stl"])
def test_blocks_that_were_exported_are_the_same_blocks(tmp_path, suffix) -> None:
    result = sk.run(slab_on_an_incline(tmp_path, "obj", "z"))
    sk.export(result, tmp_path / f"both.{suffix}")
    scene = trimesh.load_scene(tmp_path / f"both.{suffix}")
    for node in scene.graph.nodes_geometry:
        matrix, name = scene.graph[node]
        scene.geometry[name].copy().apply_transform(matrix).export(tmp_path / f"{name}.{suffix}")
    text = (tmp_path / "slab.yaml").read_text().replace(".obj", f".{suffix}")
    (tmp_path / "back.yaml").write_text(text)
    back = sk.run(tmp_path / "back.yaml")
    assert back.fos.limit == pytest.approx(result.fos.limit, rel=1e-5)
    middles = [
        BlockScene.from_dict(one.to_dict()["scene"]).shapes.centroids for one in (back, result)
    ]
    np.testing.assert_allclose(*middles, atol=1e-6)


@pytest.mark.parametrize("first", [0, 3])
def test_a_block_on_a_face_that_is_not_convex(tmp_path, first) -> None:
    """An L of 5 m² and 100 kN, pushed by 0.2 of its weight: (5 c + 100 tan φ) / 20; fans gave 7 m²."""
    (tmp_path / "ell.obj").write_bytes(as_obj(*prism(ELL, first)))
    floor = trimesh.creation.box(
        [12.0, 12.0, 1.0], trimesh.transformations.translation_matrix([0.0, 0.0, -0.5])
    )
    floor.export(tmp_path / "floor.obj")
    (tmp_path / "ell.yaml").write_text(
        "slopekit: 1\nkind: blocks\nrock: {unit_weight: 20}\nblocks:\n  floor: {mesh: floor.obj, fixed: true}\n"
        "  ell: {mesh: ell.obj}\nstrength: {joint: {c: 10, phi: 30}}\nloads: {seismic: {k: 0.2, toward: 090}}\n"
    )
    result = sk.run(tmp_path / "ell.yaml")
    assert result.geometry.areas_m2["joint"] == pytest.approx(5.0, rel=1e-9)
    assert result.fos.limit == pytest.approx(
        (5.0 * 10.0 + 100.0 * math.tan(math.radians(30))) / 20.0, rel=1e-4
    )


@pytest.mark.parametrize("first", range(4))
def test_blocks_share_a_warped_face_whole(tmp_path, first) -> None:
    """Two blocks on each other along a face whose corners stand up by turns: the contact is all of it."""
    corners = [(0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (0.0, 2.0)]
    seam = [(x, y, 1.0 + 0.3 * (k % 2)) for k, (x, y) in enumerate(corners)]
    sides = [[k, (k + 1) % 4, (k + 1) % 4 + 4, k + 4] for k in range(4)]
    turned = [*range(first, 4), *range(first)]
    lower = [(x, y, 0.0) for x, y in corners] + seam, [[3, 2, 1, 0], [4, 5, 6, 7], *sides]
    upper = seam + [(x, y, 2.0) for x, y in corners], [turned[::-1], [4, 5, 6, 7], *sides]
    bodies = []
    for name, body in (("lower", lower), ("upper", upper)):
        (tmp_path / f"{name}.obj").write_bytes(as_obj(*body))
        bodies.append(read_mesh(tmp_path / f"{name}.obj", name)[:2])
    cut = mesh_assembly(bodies, np.array([True, False]))
    a, b, c, d = np.array(seam)
    halves = [((a, b, c), (a, c, d)), ((a, b, d), (b, c, d))]  # by one diagonal or by the other
    areas = [
        sum(np.linalg.norm(np.cross(q - p, r - p)) / 2.0 for p, q, r in pair) for pair in halves
    ]
    assert min(abs(cut.contact - area) for area in areas) < 1e-9
    assert len(cut.overlaps.amounts) == len(cut.gaps.pairs) == 0
