"""Each format written and read back, by slopekit and by an independent reader: trimesh, pyvista, ezdxf."""

import json

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

import slopekit as sk
from slopekit.block_scene import BlockScene
from slopekit.exchange import dxf
from slopekit.geometry.solids.meshes import outward, read_mesh
from slopekit.geometry.solids.sliding_mass import volume_moments
from tests.bolted import bolted
from tests.exchange.conftest import EAST, NORTH, TEMPLATES
from tests.exchange.meshes import read_blocks

ezdxf = pytest.importorskip("ezdxf")
SCENES = ("map", "map-bench", "goodman-bray", "paper-ellipsoid")
#: Largest error of a coordinate, in parts of a block's size: float32 has 24 bits; text and VTU hold doubles.
EXACT = {".stl": 0.0, ".obj": 0.0, ".vtu": 0.0, ".dxf": 0.0, ".glb": 2.0**-23, ".gltf": 2.0**-23}


@pytest.mark.parametrize("suffix", EXACT)
@pytest.mark.parametrize("scene", SCENES)
def test_blocks_come_back(result, tmp_path, scene, suffix) -> None:
    """Names, vertices, volume and centroid of every block, at small and at map coordinates.

    A double at 5.5e6 m has a grain of 1e-9 m, which sums of a GLB's nodes may round by.
    """
    if suffix == ".vtu":
        pytest.importorskip("pyvista")
    shapes = BlockScene.from_dict(result(scene)["scene"]).shapes
    chosen = shapes.names if len(shapes.names) < 20 else shapes.names[::13]
    sk.export(result(scene), tmp_path / f"x{suffix}")
    found = {
        name: (vertices, triangles)
        for name, vertices, triangles in read_blocks(tmp_path / f"x{suffix}")
    }
    assert set(found) == set(shapes.names)
    grain = 2e-9 if scene.startswith("map") and EXACT[suffix] else 1e-15
    for name in chosen:
        vertices, triangles = shapes.solids.block_surface(shapes.names.index(name))
        middle, size = vertices.mean(axis=0), float(np.ptp(vertices, axis=0).max())
        apart = cKDTree(found[name][0] - middle).query(vertices - middle)[0].max()
        assert apart <= EXACT[suffix] * size + (grain if EXACT[suffix] else 0.0)
        assert volume_moments(*found[name])[0] == pytest.approx(
            volume_moments(vertices, triangles)[0], rel=1e-12 + 20 * EXACT[suffix]
        )
        assert len(found[name][1]) == len(triangles)


@pytest.mark.parametrize("suffix", [".stl", ".obj", ".glb", ".dxf"])
def test_meshes_of_designs_keep_map_coordinates(result, tmp_path, suffix) -> None:
    sk.export(result("map"), tmp_path / f"x{suffix}")
    vertices, triangles, closed = read_mesh(tmp_path / f"x{suffix}", "x")
    assert closed
    assert volume_moments(vertices, triangles)[0] == pytest.approx(
        209461.4964585, rel=3e-6 if suffix == ".glb" else 1e-9
    )
    toe = np.array([EAST, NORTH, 300.0])
    assert np.abs(vertices - toe).max(axis=1).min() <= (1e-5 if suffix == ".glb" else 0.0)


def test_a_mesh_at_map_coordinates_that_is_inside_out_is_turned(tmp_path) -> None:
    """The sign of a volume of 1 m³ among products of three numbers of 5e6."""
    box = trimesh.creation.box()
    corners = np.asarray(box.vertices) + np.array([EAST, NORTH, 300.0])
    text = [f"v {x!r} {y!r} {z!r}" for x, y, z in corners.tolist()]
    text += [f"f {a} {c} {b}" for a, b, c in (np.asarray(box.faces) + 1).tolist()]
    (tmp_path / "box.obj").write_text("\n".join(text))
    vertices, triangles, closed = read_mesh(tmp_path / "box.obj", "box")
    assert closed
    assert volume_moments(vertices, outward(vertices, triangles))[0] == pytest.approx(1.0, rel=1e-8)


def test_stl_by_trimesh_and_by_its_text(result, tmp_path) -> None:
    sk.export(result("bench"), tmp_path / "x.stl")
    lines = (tmp_path / "x.stl").read_text().splitlines()
    names = [line[6:] for line in lines if line.startswith("solid ")]
    assert (len(names), names[:2]) == (132, ["B1", "B2"])
    scene = trimesh.load(tmp_path / "x.stl")
    shapes = BlockScene.from_dict(result("bench")["scene"]).shapes
    moving = [
        scene.geometry[name].volume
        for name, fixed in zip(shapes.names, shapes.fixed, strict=True)
        if not fixed
    ]
    assert sum(moving) == pytest.approx(987.4750107200935, rel=1e-12)
    assert all(mesh.is_watertight for mesh in scene.geometry.values())
    facet = next(k for k, line in enumerate(lines) if line.startswith("facet"))
    a, b, c = (np.array([float(word) for word in lines[facet + k].split()[1:]]) for k in (2, 3, 4))
    normal = np.array([float(word) for word in lines[facet].split()[2:]])
    assert np.cross(b - a, c - a) @ normal == pytest.approx(
        np.linalg.norm(np.cross(b - a, c - a)), rel=1e-5
    )


def test_names_that_stl_readers_take_for_words(tmp_path, result) -> None:
    document = json.loads(json.dumps(result("wedge")))
    document["scene"]["shapes"]["names"] = ["solid vertex 1"]
    sk.export(document, tmp_path / "x.stl")
    ((name, vertices, _),) = read_blocks(tmp_path / "x.stl")
    assert (name, len(vertices)) == ("s_olid v_ertex 1", 4)


def test_obj_has_faces_by_name(result, tmp_path) -> None:
    sk.export(result("wedge"), tmp_path / "x.obj")
    lines = (tmp_path / "x.obj").read_text().splitlines()
    assert [line[2:] for line in lines if line.startswith("o ")] == ["wedge"]
    assert {line for line in lines if line.startswith("g ")} == {
        "g wedge J1",
        "g wedge J2",
        "g wedge face",
        "g wedge upper_slope",
    }


def test_glb_turns_z_up_and_keeps_the_offset_in_its_nodes(result, tmp_path) -> None:
    """glTF 2.0, 3.4: y is up. The offset is a double of the JSON, vertices are small."""
    sk.export(result("map"), tmp_path / "x.gltf")
    document = json.loads((tmp_path / "x.gltf").read_text())
    offset = next(
        node["matrix"][12:15] for node in document["nodes"] if node["name"] == "map origin"
    )
    assert offset[:2] == pytest.approx([EAST, NORTH], abs=200.0)
    assert (
        max(max(map(abs, one["max"])) for one in document["accessors"] if one["type"] == "VEC3")
        < 200.0
    )
    block = next(mesh for mesh in document["meshes"] if mesh["name"] == "wedge")
    assert block["extras"]["factor_of_safety"] == pytest.approx(1.5574, abs=1e-4)
    bounds = trimesh.load_scene(tmp_path / "x.gltf").bounds  # east, up, -north
    geometry = BlockScene.from_dict(result("map")["scene"]).shapes.solids.vertices
    assert bounds[:, 1] == pytest.approx([geometry[:, 2].min(), geometry[:, 2].max()], abs=1e-4)
    assert bounds[:, 2] == pytest.approx([-geometry[:, 1].max(), -geometry[:, 1].min()], abs=1e-4)


def test_vtu_by_pyvista(result, tmp_path) -> None:
    """Volumes and fields, by VTK; the stresses against the forces of the sheet."""
    pyvista = pytest.importorskip("pyvista")
    document = result("map")
    done = sk.export(document, tmp_path / "x.vtu")
    assert [path.name for path in done.files] == ["x.vtu", "x-interfaces.vtu", "x-pairs.vtu"]
    blocks, interfaces, pairs = (pyvista.read(path) for path in done.files)
    assert blocks.points.dtype == np.float64
    assert blocks.cell_data["volume_m3"] == pytest.approx([209461.4964585], rel=1e-9)
    assert blocks.celltypes.tolist() == [42]
    assert blocks.cell_data["factor_of_safety"] == pytest.approx([document["fos"]["limit"]], rel=0)
    assert list(blocks.field_data["block_names"]) == ["wedge"]
    assert np.linalg.norm(blocks.cell_data["velocity"]) == pytest.approx(1.0)
    names = list(interfaces.field_data["joint_names"])
    for joint, area in zip(
        interfaces.cell_data["joint"], interfaces.cell_data["area_m2"], strict=True
    ):
        assert area == pytest.approx(document["geometry"]["areas_m2"][names[joint]], rel=1e-9)
        own = pairs.cell_data["joint"] == joint
        assert pairs.cell_data["normal_kn"][own].sum() == pytest.approx(
            document["forces_kn"]["normal"][names[joint]], rel=1e-6
        )
    assert float(pairs.cell_data["control_area_m2"].sum()) == pytest.approx(
        2 * 9057.538338, rel=1e-8
    )
    assert pairs.cell_data["shear_kn"].shape == (len(pairs.points), 3)
    assert {pairs.field_data["mode_names"][mode] for mode in pairs.cell_data["mode"]} == {"slip"}


def test_vtu_indices_mean_the_names_listed(result, tmp_path) -> None:
    """By VTK: each cell's block by its name has its volume, and the blocks beside a polygon share its joint."""
    pyvista = pytest.importorskip("pyvista")
    shapes = BlockScene.from_dict(result("bench")["scene"]).shapes
    done = sk.export(result("bench"), tmp_path / "x.vtu")
    blocks, interfaces = (pyvista.read(path) for path in done.files)
    names = [str(name) for name in blocks.field_data["block_names"]]
    for at, volume in zip(blocks.cell_data["block"], blocks.cell_data["volume_m3"], strict=True):
        assert volume == pytest.approx(
            volume_moments(*shapes.solids.block_surface(shapes.names.index(names[at])))[0], rel=1e-9
        )
    cells = {
        names[at]: blocks.extract_cells(k)
        for k, at in enumerate(blocks.cell_data["block"].tolist())
    }
    assert [str(name) for name in interfaces.field_data["block_names"]] == names
    for k, sides in enumerate(
        zip(interfaces.cell_data["plus_block"], interfaces.cell_data["minus_block"], strict=True)
    ):
        own = [cells[names[at]] for at in sides if at >= 0 and names[at] in cells]
        assert own
        for block in own:
            low, high = block.points.min(axis=0) - 1e-6, block.points.max(axis=0) + 1e-6
            corners = interfaces.get_cell(k).points
            assert ((corners >= low) & (corners <= high)).all()
    assert done.written[0].interfaces == interfaces.n_cells


def test_vtu_pairs_index_the_names_listed(tmp_path) -> None:
    """By VTK: the node pairs of each of three blocks lie within it."""
    pyvista = pytest.importorskip("pyvista")
    source = sk.run(TEMPLATES / "blocks.yaml")
    done = sk.export(source, tmp_path / "x.vtu")
    blocks, _, pairs = (pyvista.read(path) for path in done.files)
    names = [str(name) for name in pairs.field_data["block_names"]]
    assert list(blocks.field_data["block_names"]) == names == list(source.scene.shapes.names)
    sides = np.stack([pairs.cell_data["plus_block"], pairs.cell_data["minus_block"]], axis=1)
    assert {frozenset(names[k] for k in two) for two in sides.tolist()} == {
        frozenset(("B1", "base")),
        frozenset(("B2", "base")),
        frozenset(("B1", "B2")),
    }
    for k in range(3):
        corners = blocks.extract_cells(k).points
        own = pairs.points[(sides == blocks.cell_data["block"][k]).any(axis=1)]
        assert len(own)
        assert ((own >= corners.min(axis=0) - 1e-6) & (own <= corners.max(axis=0) + 1e-6)).all()


def test_dxf_by_ezdxf(result, tmp_path) -> None:
    sk.export(result("map"), tmp_path / "x.dxf")
    drawing = ezdxf.readfile(tmp_path / "x.dxf")
    assert drawing.units == 6
    audit = drawing.audit()
    assert (audit.errors, audit.fixes) == ([], [])
    layers = {entity.dxf.layer for entity in drawing.modelspace()}
    assert layers == {"BLOCKS-MOVING", "LINE-OF-INTERSECTION"}
    (line,) = drawing.modelspace().query("LINE")
    assert (line.dxf.end - line.dxf.start).magnitude == pytest.approx(256.9123443880054, rel=1e-9)
    assert min(line.dxf.start.z, line.dxf.end.z) == 300.0


def test_outlines_of_a_section(result, tmp_path) -> None:
    """LWPOLYLINEs stand upright in the middle of the section; their areas by the shoelace formula."""
    sk.export(result("blocks"), tmp_path / "x.dxf")
    lines = list(ezdxf.readfile(tmp_path / "x.dxf").modelspace().query("LWPOLYLINE"))
    corners = [np.array([tuple(point) for point in line.vertices_in_wcs()]) for line in lines]
    assert [len(own) for own in corners] == [5, 3, 4]
    assert np.abs(np.concatenate(corners)[:, 1]).max() < 1e-15
    x, z = corners[1][:, 0], corners[1][:, 2]
    assert abs(x @ np.roll(z, -1) - z @ np.roll(x, -1)) / 2.0 == pytest.approx(12.5, rel=1e-12)
    assert {tuple(corner) for corner in corners[1].round(12).tolist()} == {
        (0, 0, 0),
        (0, 0, 5),
        (-5, 0, 5),
    }


@pytest.mark.slow
def test_bolts_in_dxf(tmp_path) -> None:
    """By ezdxf: on the layer BOLTS a point with its number at each head, and a line to its end, to the millimetre."""
    bolts = bolted("bench").scene.bolts
    done = sk.export(bolted("bench"), tmp_path / "x.dxf")
    assert done.written[0].bolts == done.to_dict()["written"][0]["bolts"] == 6
    drawing = ezdxf.readfile(tmp_path / "x.dxf")
    audit = drawing.audit()
    assert (audit.errors, audit.fixes) == ([], [])
    space = drawing.modelspace()
    points = [one for one in space.query("POINT") if one.dxf.layer == "BOLTS"]
    known = {one.get_xdata("SLOPEKIT")[1].value: one for one in points}
    assert sorted(known) == bolts.number.tolist()
    for k, number in enumerate(bolts.number.tolist()):
        place = tuple(known[number].dxf.location)
        assert place == tuple(round(part, 3) for part in bolts.heads_m[k].tolist())
        tags = [tag.value for tag in known[number].get_xdata("SLOPEKIT")]
        assert tags == [
            f"bolt {number}",
            number,
            150.0,
            "passive" if bolts.passive[k] else "active",
        ]
    lines = {
        tuple(one.dxf.start): tuple(one.dxf.end)
        for one in space.query("LINE")
        if one.dxf.layer == "BOLTS"
    }
    ends = [tuple(round(part, 3) for part in end) for end in bolts.ends_m.tolist()]
    assert lines == dict(
        zip([tuple(known[n].dxf.location) for n in bolts.number.tolist()], ends, strict=True)
    )
    texts = {one.dxf.text: tuple(one.dxf.insert) for one in space.query("TEXT")}
    assert texts == {str(n): tuple(known[n].dxf.location) for n in bolts.number.tolist()}


def test_bolts_in_glb_and_back(tmp_path) -> None:
    """By trimesh: each bolt a node with its head and end among its vertices; a design reads the blocks alone."""
    bolts = bolted("three").scene.bolts
    sk.export(bolted("three"), tmp_path / "x.glb")
    scene = trimesh.load_scene(tmp_path / "x.glb")
    for k, number in enumerate(bolts.number.tolist()):
        matrix, name = scene.graph.get(f"bolt {number}", frame_from="slopekit: z is up")
        mesh = scene.geometry[name]
        assert mesh.is_watertight
        points = mesh.vertices @ matrix[:3, :3].T + matrix[:3, 3]
        for end in (bolts.heads_m[k], bolts.ends_m[k]):
            assert np.linalg.norm(points - end, axis=1).min() < 1e-5
        assert (mesh.metadata["number"], mesh.metadata["force_kn"]) == (number, bolts.force_kn[k])
    assert scene.geometry["bolt 2"].metadata["length_m"] is None
    assert [name for name, _, _ in read_blocks(tmp_path / "x.glb")] == ["wedge"]


def test_bolts_in_vtu(tmp_path) -> None:
    pyvista = pytest.importorskip("pyvista")
    bolts = bolted("three").scene.bolts
    done = sk.export(bolted("three"), tmp_path / "x.vtu")
    assert [path.name for path in done.files] == [
        "x.vtu",
        "x-interfaces.vtu",
        "x-pairs.vtu",
        "x-bolts.vtu",
    ]
    grid = pyvista.read(tmp_path / "x-bolts.vtu")
    assert grid.celltypes.tolist() == [3, 3]
    for k in range(2):
        np.testing.assert_array_equal(grid.get_cell(k).points, [bolts.heads_m[k], bolts.ends_m[k]])
    assert grid.cell_data["number"].tolist() == [1, 2]
    assert grid.cell_data["force_kn"].tolist() == [300.0, 100.0]
    assert grid.cell_data["passive"].tolist() == [0, 1]


def test_dxf_by_single_faces(result, tmp_path, monkeypatch) -> None:
    """Where a block has more corners than a polyface mesh can count: 3DFACEs, read as one body a layer."""
    monkeypatch.setattr(dxf, "_MOST_INDEX", 3)
    sk.export(result("map"), tmp_path / "x.dxf")
    assert not ezdxf.readfile(tmp_path / "x.dxf").query("POLYLINE")
    vertices, triangles, closed = read_mesh(tmp_path / "x.dxf", "x")
    assert closed
    assert volume_moments(vertices, triangles)[0] == pytest.approx(209461.4964585, rel=1e-9)
