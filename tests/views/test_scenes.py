"""Scenes: what is drawn stands where the result has it; PNG, GLB and glTF hold it."""

import json
import re
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

import slopekit as sk
from slopekit.block_scene import BlockScene, packed
from slopekit.core.arrays import Floats
from slopekit.core.sheet import factor_text
from slopekit.design.templates import path_of
from slopekit.geometry.solids.meshes import mesh_bodies
from slopekit.views.solid import rendering
from slopekit.views.solid.layers import (
    MODE_COLOURS,
    Bar,
    Picture,
    arrows,
    free_normal,
    rigid_displacement,
    rock_around,
    spheres,
)
from slopekit.views.solid.rendering import Camera
from slopekit.views.solid.scene_parts import resultants
from slopekit.views.solid.scenes import SCENES, compose, draw
from slopekit.views.solid.stage import Stage
from tests.support import result_of

KINDS = ("wedge", "plane", "footing", "cylinder", "blocks", "goodman-bray", "wall")


@cache
def document(name: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(json.dumps(result_of(name).to_dict()))
    return found


def made(name: str, what: str, **asked: Any) -> Picture:
    return compose(document(name), what, **asked)


def part(picture: Picture, name: str) -> Floats:
    """The corners (t, 3, 3) of the triangles of a layer."""
    layer = next(layer for layer in picture.layers if layer.name == name)
    return layer.vertices[layer.triangles]


def volume(corners: Floats) -> float:
    about = corners - corners.mean(axis=(0, 1))
    return float(np.einsum("ij,ij->", about[:, 0], np.cross(about[:, 1], about[:, 2]))) / 6.0


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize(
    "what", [what for what in SCENES if what not in ("displacement", "elevation")]
)
def test_every_kind_gives_every_scene(name: str, what: str) -> None:
    picture = made(name, what)
    moving = document(name)["geometry"]["volume_m3"]
    whole = [layer.name for layer in picture.layers]
    assert {"blocks", "moving"} & set(whole)
    if what in ("scene", "exploded", "factors"):
        blocks = volume(part(picture, "blocks"))
        fixed = (
            volume(part(picture, "bedrock")) if "bedrock" in whole and what == "exploded" else 0.0
        )
        assert blocks >= moving * 0.98 - fixed
    for layer in picture.layers:
        assert np.isfinite(layer.vertices).all()
        assert layer.colours.shape == layer.triangles.shape
    assert "FoS" in picture.subtitle
    assert document(name)["status_text"] in picture.subtitle
    assert len(picture.legend) == len({text for text, _, _ in picture.legend})


@pytest.mark.parametrize("name", ["wedge", "plane", "footing"])
def test_the_rock_and_its_block_fill_the_slope(name: str) -> None:
    """Together they are convex, and neither lies in the other."""
    scene = BlockScene.from_dict(document(name)["scene"])
    rock = rock_around(scene.shapes)
    assert rock is not None
    mesh = trimesh.Trimesh(*rock)
    assert mesh.is_watertight
    both = trimesh.convex.convex_hull(np.concatenate([rock[0], scene.shapes.solids.vertices]))
    assert both.volume == pytest.approx(
        mesh.volume + document(name)["geometry"]["volume_m3"], rel=1e-6
    )
    assert free_normal(scene.shapes)[2] > 0.3


def test_exploded_blocks_move_out_and_keep_their_shape() -> None:
    picture = made("goodman-bray", "exploded")
    scene = BlockScene.from_dict(document("goodman-bray")["scene"])
    rock = scene.shapes.centroids[scene.shapes.fixed].mean(axis=0)
    first = scene.shapes.solids.triangles[scene.shapes.solids.block == 0]
    corners = part(picture, "blocks")[: len(first)]
    expected = scene.shapes.solids.vertices[first] + 0.35 * (scene.shapes.centroids[0] - rock)
    np.testing.assert_allclose(corners, expected, atol=1e-9)


def test_contacts_are_coloured_on_both_blocks() -> None:
    picture = made("blocks", "exploded")
    scene = BlockScene.from_dict(document("blocks")["scene"])
    count = sum(len(contact) for contact in (np.flatnonzero(scene.shapes.contacts.joint == 0),))
    assert (
        len(part(picture, "joint")) == 2 * 2 * 2 * count
    )  # two triangles, on two blocks, and a ribbon on their sides


def test_tractions_are_forces_by_area() -> None:
    picture = made("plane", "tractions")
    pairs = BlockScene.from_dict(document("plane")["scene"]).pairs
    force = pairs.normal_kn[:, None] * pairs.normals + pairs.shear_kn
    longest = np.linalg.norm(force / pairs.control_area_m2[:, None], axis=1).max()
    assert any(f"longest {longest:.4g} kPa" in text for text, _, _ in picture.legend)
    assert any(text == "slip: 3 of 3 node pairs" for text, _, _ in picture.legend)


def test_modes_have_their_colours() -> None:
    picture = made("goodman-bray", "tractions")
    counts = document("goodman-bray")["mechanisms"][0]["pairs_by_mode"]
    for mode, count in counts.items():
        layer = next(layer for layer in picture.layers if layer.name == f"node pairs: {mode}")
        assert len(layer.triangles) == 80 * count
        assert (layer.colours == MODE_COLOURS[mode]).all()


def test_forces_on_a_block_cancel() -> None:
    stage = Stage.from_document(document("plane"))
    _, force, joint = resultants(stage, stage.free)
    assert joint.tolist() == [0]
    np.testing.assert_allclose(
        force.sum(axis=0), -stage.scene.loads.force_kn.sum(axis=0), atol=1e-6
    )
    texts = " ".join(text for text, _, _ in made("plane", "forces").legend)
    for load in ("weight", "water on J1", "water on crack", "J1 on the block"):
        assert load in texts


def test_each_flank_of_a_column_has_its_own_force() -> None:
    """Goodman & Bray's P on column 7 from column 6 below it: normal and shear of one side, not the sum of both."""
    stage = Stage.from_document(document("goodman-bray"))
    _, force, joint = resultants(stage, stage.free)
    sides = np.linalg.norm(force[joint == 1], axis=1)
    table = {row["n"]: row for row in document("goodman-bray")["assembly"]["table"]}
    largest = max(row["P_kn"] for row in table.values())
    shear = np.tan(np.radians(38.15)) / document("goodman-bray")["fos"]["limit"]
    assert sides.max() == pytest.approx(largest * np.hypot(1.0, shear), rel=1e-4)
    assert len(sides) == 2 * 15


def test_forces_are_shown_of_blocks_in_equilibrium() -> None:
    stage = Stage.from_document(document("wall"))
    assert stage.balanced.sum() == stage.free.sum()
    changed = document("wall") | {
        "scene": document("wall")["scene"] | {"pairs": dict(document("wall")["scene"]["pairs"])}
    }
    scene = BlockScene.from_dict(changed["scene"])
    halved = scene.pairs.normal_kn.copy()
    halved[scene.pairs.plus == scene.pairs.plus[0]] *= 0.5
    changed["scene"]["pairs"]["normal_kn"] = packed(halved)
    assert not Stage.from_document(changed).balanced[scene.pairs.plus[0]]


def test_displacement_is_magnified_as_said() -> None:
    picture = made("wedge", "displacement")
    times = float(re.search(r"magnified ([\d,]+) times", picture.notes[0])[1].replace(",", ""))
    scene = BlockScene.from_dict(document("wedge")["scene"])
    assert scene.displacement is not None
    moved, rest = part(picture, "displaced"), part(picture, "at rest")
    np.testing.assert_allclose(
        (moved - rest).mean(axis=(0, 1)), times * scene.displacement[0, :3], rtol=1e-3, atol=1e-9
    )
    size = np.linalg.norm(scene.displacement[0, :3])
    assert f"centroid {size * 1e3:.3g} mm" in picture.notes[0]


def test_displacement_of_many_blocks() -> None:
    picture = made("wall", "displacement")
    times = float(re.search(r"magnified ([\d,]+) times", picture.notes[0])[1].replace(",", ""))
    one = document("wall")["at_factor_one"]
    size = np.linalg.norm(one["displacement_m"])
    assert f"centroid of {one['block']} {size * 1e3:.3g} mm" in picture.notes[0]
    shift = np.linalg.norm(part(picture, "displaced") - part(picture, "at rest"), axis=2)
    assert size * 0.99 < shift.max() / times < 1.5 * size


def test_a_mechanism_keeps_proportions_and_shape() -> None:
    picture = made("goodman-bray", "mechanism")
    scene = BlockScene.from_dict(document("goodman-bray")["scene"])
    moved, rest = part(picture, "moving"), part(picture, "where they were")
    own = scene.order[scene.shapes.solids.block] == 1
    of = scene.shapes.solids.block[own]
    drawn = []
    for block in (0, 9):
        centre = np.linalg.norm(scene.velocity[block, :3])
        shift = (moved - rest)[of == block]
        drawn.append(np.linalg.norm(shift.mean(axis=(0, 1))) / centre)
        lengths = [
            np.linalg.norm(body[of == block][:, 1] - body[of == block][:, 0], axis=1)
            for body in (moved, rest)
        ]
        np.testing.assert_allclose(lengths[0], lengths[1], rtol=1e-9)  # turned, not stretched
    assert drawn[0] == pytest.approx(drawn[1], rel=0.3)
    words = {text for text, _, _ in picture.legend}
    assert {"slides: 3", "topples: 10", "at rest"} <= words


def test_rigid_motion_about_the_centroid() -> None:
    shapes = BlockScene.from_dict(document("wedge")["scene"]).shapes
    motion = np.array([[1.0, 0.0, 0.0, 0.0, 0.0, np.pi / 2]])
    point = shapes.centroids + np.array([2.0, 0.0, 0.0])
    np.testing.assert_allclose(
        rigid_displacement(shapes, motion, point, np.array([0])),
        [[1.0 - 2.0, 2.0, 0.0]],
        atol=1e-12,
    )
    assert not rigid_displacement(shapes, motion, point, np.array([-1])).any()


def test_factors_colour_by_value() -> None:
    picture = made("wall", "factors")
    limit = document("wall")["fos"]["limit"]
    assert picture.bar is None  # one value needs no scale
    # every block of the wall slides at tan φ / tan β
    assert picture.legend[0][0] == f"fails at {factor_text(limit)} (14)"
    scene = BlockScene.from_dict(document("wall")["scene"])
    two = np.where(np.arange(len(scene.factor)) % 2 == 0, scene.factor, 2.0 * scene.factor)
    spread = dict(document("wall")) | {
        "scene": dict(document("wall")["scene"]) | {"factor": packed(two)}
    }
    bar = compose(spread, "factors").bar
    assert bar is not None
    assert (bar.low, bar.high) == pytest.approx((limit, 2.0 * limit))
    assert Bar("", 1.0, 3.0).colours(np.array([1.0, 3.0, 9.0])).tolist() == [
        [68, 1, 84],
        [253, 231, 37],
        [253, 231, 37],
    ]


FALLING = {
    "slopekit": 1,
    "kind": "blocks",
    "strength": {"joint": {"c": 0, "phi": 30}},
    "rock": {"unit_weight": 20},
    "blocks": {
        "base": {"polygon": [[0, 0], [10, 0], [10, -2], [0, -2]], "fixed": True},
        "B1": {"polygon": [[2, 0], [4, 0], [4, 2], [2, 2]]},
        "B2": {"polygon": [[10, 0], [12, 0], [12, 2], [10, 2]]},
        "B3": {"polygon": [[10, 0], [10, 2], [9, 2], [9, 0]]},
    },
}


def test_what_falls_is_not_shown_as_standing() -> None:
    picture = compose(sk.run(FALLING).to_dict(), "factors")
    words = [text for text, _, _ in picture.legend]
    assert "held by no strength that was tried (1)" in words
    assert any(text.startswith("no factor: it stands") and text.endswith("(2)") for text in words)


def test_a_mechanism_that_did_not_settle_is_not_shown_as_fact() -> None:
    changed = json.loads(json.dumps(document("wall")))
    changed["mechanisms"][0] |= {"status": "not_converged"}
    scene = BlockScene.from_dict(changed["scene"])
    changed["scene"]["factor"] = packed(np.full(len(scene.factor), np.nan))
    words = " ".join(text for text, _, _ in compose(changed, "factors").legend)
    assert "did not settle (14)" in words
    assert "stands, or was not looked at" not in words


def test_a_later_mechanism_has_its_own_factor() -> None:
    result = sk.run(path_of("goodman-bray"), set={"analysis.mechanisms": 2})
    later = result.mechanisms[1].fos
    picture = compose(result.to_dict(), "mechanism", step=2)
    factor = "no factor of safety" if later is None else f"FoS {factor_text(later)} (PRE-IE)"
    assert factor in picture.subtitle
    assert picture.subtitle.startswith("mechanism 2: ")


def test_the_answer_says_what_decides() -> None:
    base = document("wedge")
    for more, word in (
        ({"fos": base["fos"] | {"lowest": 1.4321}}, "lowest estimate 1.432 "),
        ({"accepted": False}, "acceptance NOT MET"),
        ({"fos": base["fos"] | {"all_pairs_failed": 1.55}}, "all pairs failed 1.550"),
        ({"agree": False}, "DO NOT AGREE"),
    ):
        assert word in Stage.from_document(base | more).answer
    lost = Stage.from_document(
        base | {"status": "not_converged", "agree": False, "fos": base["fos"] | {"limit": None}}
    ).answer
    assert "AGREE" not in lost
    assert "no factor of safety" in lost


def test_without_a_limit_state_only_loads_are_drawn() -> None:
    lifted = sk.wedge(dips=("45/115", "45/245"), water="u=900kPa").to_dict()
    picture = compose(lifted, "forces")
    assert "no limit state" in " ".join(picture.notes)
    assert not any("J1 on the block" in text for text, _, _ in picture.legend)
    assert "no limit state" in " ".join(compose(lifted, "tractions").notes)


def test_arrows_stand_in_front_in_stills_alone() -> None:
    fronts = {layer.name: layer.front for layer in made("plane", "forces").layers}
    assert fronts["weight"] == 1
    assert fronts["blocks"] == 0


@pytest.mark.parametrize(
    ("name", "what", "asked", "code"),
    [
        ("goodman-bray", "displacement", {}, "E273"),
        ("goodman-bray", "mechanism", {"step": 2}, "E273"),
    ],
)
def test_what_cannot_be_drawn(name: str, what: str, asked: dict[str, Any], code: str) -> None:
    with pytest.raises(sk.DesignError, match=code):
        made(name, what, **asked)


def test_nothing_moves() -> None:
    stands = document("wedge")
    still = dict(stands) | {
        "scene": dict(stands["scene"]) | {"order": packed(np.zeros(1, dtype=np.int64))}
    }
    with pytest.raises(sk.DesignError, match="E273"):
        compose(still, "mechanism")
    with pytest.raises(sk.DesignError, match="E350"):
        compose({"kind": "wedge"}, "scene")


def test_arrows_reach_from_start_to_tip() -> None:
    starts, vectors = (
        np.array([[0.0, 0.0, 0.0], [5.0, 0.0, 0.0]]),
        np.array([[0.0, 0.0, 2.0], [0.0, 0.0, 0.0]]),
    )
    vertices, triangles = arrows(starts, vectors, 0.1)
    assert np.ptp(vertices[:, 0]) < 1.0  # an arrow without length is none
    assert vertices[:, 2].min() == pytest.approx(0.0)
    assert vertices[:, 2].max() == pytest.approx(2.0)
    assert trimesh.Trimesh(vertices, triangles).volume > 0.0
    points, faces = spheres(np.array([[0.0] * 3, [9.0] * 3]), 0.5)
    assert trimesh.Trimesh(points, faces).volume == pytest.approx(
        2 * 4 / 3 * np.pi * 0.125, rel=0.2
    )
    assert faces.shape == (160, 3)


@pytest.mark.slow
def test_the_frame_holds_every_layer() -> None:
    for name in ("wedge", "goodman-bray"):
        picture = made(name, "scene")
        camera = Camera.about(picture.points, picture.eye)
        seen = [
            camera.seen(point)
            for layer in picture.layers
            for point in layer.vertices[layer.triangles.ravel()]
        ]
        assert max(abs(above) for _, above in seen) <= camera.half[1]
        np.testing.assert_allclose(np.cross(camera.right, camera.up), camera.eye, atol=1e-12)


def test_map_coordinates_make_the_same_picture() -> None:
    far = sk.wedge(dips=("45/115", "45/245"), origin=(4e6, 5.5e6, 300.0)).to_dict()
    near = sk.wedge(dips=("45/115", "45/245")).to_dict()
    offset = np.array([4e6, 5.5e6, 300.0])
    for a, b in zip(compose(far, "exploded").layers, compose(near, "exploded").layers, strict=True):
        np.testing.assert_allclose(
            np.sort(a.vertices - offset, axis=0), np.sort(b.vertices, axis=0), atol=1e-6
        )


@pytest.mark.slow
def test_png_glb_and_gltf(tmp_path: Path) -> None:
    import matplotlib.image

    draw(document("wedge"), "exploded", tmp_path / "a.png")
    pixels = matplotlib.image.imread(tmp_path / "a.png")[:, :, :3]
    high, wide, _ = pixels.shape
    assert wide / high == pytest.approx(11.3 / 8.0, rel=2e-3)
    scene = pixels[high // 10 : high * 9 // 10, : wide * 7 // 10]
    blue = (scene[:, :, 2] > scene[:, :, 0] + 0.15) & (scene[:, :, 2] > scene[:, :, 1] + 0.1)
    tan = scene[:, :, 0] > scene[:, :, 2] + 0.25
    assert blue.mean() > 0.005  # J1 in the notch
    assert tan.mean() > 0.03  # the wedge
    for name in ("a.glb", "a.gltf"):
        draw(document("wedge"), "exploded", tmp_path / name)
        loaded = trimesh.load(tmp_path / name)
        assert {"blocks", "rock", "J1", "J2"} <= set(loaded.graph.nodes)
        size = np.ptp(
            np.concatenate([part.vertices for part in made("wedge", "exploded").layers]), axis=0
        )
        np.testing.assert_allclose(loaded.extents, size[[0, 2, 1]], rtol=1e-5)  # y is up there
        back = {node: vertices.min(axis=0) for node, vertices, _ in mesh_bodies(tmp_path / name)}
        least = {part.name: part.vertices.min(axis=0) for part in made("wedge", "exploded").layers}
        np.testing.assert_allclose(
            back["blocks"] - back["rock"], least["blocks"] - least["rock"], atol=1e-3
        )


@pytest.mark.slow
def test_run_draws_into_its_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from typer.testing import CliRunner

    from slopekit.cli import app

    out, arguments = tmp_path / "out", ["run", str(path_of("paper-footing")), "--quiet"]
    run = CliRunner().invoke(app, ["run", str(path_of("paper-footing")), "--quiet", "-o", str(out)])
    assert run.exit_code == 0
    assert {path.name for path in out.iterdir()} == {
        "result.json",
        "sheet.txt",
        "scene.png",
        "mechanism.png",
        "reduction.png",
    }
    bare = CliRunner().invoke(
        app,
        [
            "run",
            str(path_of("paper-footing")),
            "--quiet",
            "--no-pictures",
            "-o",
            str(tmp_path / "b"),
        ],
    )
    assert bare.exit_code == 0
    assert {path.name for path in (tmp_path / "b").iterdir()} == {"result.json", "sheet.txt"}
    (tmp_path / "b" / "scene.png").write_bytes(b"of another result")
    again = CliRunner().invoke(app, [*arguments, "--no-pictures", "-o", str(tmp_path / "b")])
    assert "removed: scene.png" in again.stderr
    assert not (tmp_path / "b" / "scene.png").exists()
    (out / "stereonet.png").write_bytes(b"of another result")
    monkeypatch.setattr(rendering, "save", lambda picture, path: path.write_bytes(b"drawn again"))
    once_more = CliRunner().invoke(app, [*arguments, "-o", str(out)])
    assert once_more.stderr.strip() == "pictures of an earlier result were removed: stereonet.png"
    assert {path.name for path in out.glob("*.png")} == {
        "scene.png",
        "mechanism.png",
        "reduction.png",
    }
    assert (out / "scene.png").read_bytes() == b"drawn again"
    monkeypatch.undo()
    monkeypatch.setattr("slopekit.core.extras.find_spec", lambda name: None)
    without = CliRunner().invoke(app, [*arguments, "-o", str(tmp_path / "c")])
    assert without.exit_code == 0
    assert "result.json and sheet.txt are written, pictures are left out: E140" in without.stderr
    assert {path.name for path in (tmp_path / "c").iterdir()} == {"result.json", "sheet.txt"}
    one = CliRunner().invoke(
        app, ["run", str(path_of("footing")), "--quiet", "--picture", str(tmp_path / "one.glb")]
    )
    assert (
        one.exit_code == 1
    )  # the acceptance rule of the template is not met, and it is drawn all the same
    assert (tmp_path / "one.glb").stat().st_size > 1000


@pytest.mark.slow
def test_the_scale_bar_is_true(tmp_path: Path) -> None:
    """The bar against the pixels that the whole scene takes across."""
    import matplotlib.image

    picture = made("wedge", "exploded")
    draw(document("wedge"), "exploded", tmp_path / "a.png")
    pixels = matplotlib.image.imread(tmp_path / "a.png")[:, :, :3]
    high, wide, _ = pixels.shape
    black = (pixels[high * 7 // 10 :, : wide // 3].max(axis=2) < 0.3).sum(axis=1)
    row = int(np.argmax(black)) + high * 7 // 10  # the longest line of black beneath the scene
    bar = np.flatnonzero(pixels[row, : wide // 3].max(axis=1) < 0.3)
    scene = pixels[high // 8 : row - 30, : wide * 3 // 4]
    seen = np.flatnonzero((scene < 0.97).any(axis=(0, 2)))
    right = np.cross([0.0, 0.0, 1.0], picture.eye)
    points = np.concatenate([layer.vertices[layer.triangles.ravel()] for layer in picture.layers])
    per_metre = (seen[-1] - seen[0] + 1) / np.ptp(points @ (right / np.linalg.norm(right)))
    assert (bar[-1] - bar[0]) / per_metre == pytest.approx(50.0, rel=0.015)
