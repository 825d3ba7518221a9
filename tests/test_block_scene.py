"""The scene of a result: it holds the model that was solved, in the user's coordinates, and its JSON keeps it."""

import json
from functools import cache
from typing import Any

import numpy as np
import pytest

import slopekit as sk
from slopekit.block_scene import MODES, BlockScene, closed, packed, prism, unpacked
from slopekit.design.templates import path_of
from slopekit.result import Result
from tests.support import result_of

ONE_BLOCK = ("wedge", "wedge-scatter", "plane", "footing", "paper-footing", "cylinder")
MANY = ("blocks", "goodman-bray", "topple", "wall")


@cache
def solved(name: str) -> Result:
    return result_of(name)


def volume_of(vertices: Any, triangles: Any) -> float:
    about = vertices - vertices.mean(axis=0)
    a, b, c = (about[triangles[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0


@pytest.mark.parametrize("name", [*ONE_BLOCK, *MANY])
def test_solids_are_closed_and_hold_the_volume(name: str) -> None:
    result = solved(name)
    scene = result.scene
    volume = 0.0
    for block, fixed in enumerate(scene.shapes.fixed):
        vertices, triangles = scene.shapes.solids.block_surface(block)
        edges = np.concatenate(
            [triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]
        ).tolist()
        once = {(a, b) for a, b in edges}
        assert len(once) == len(edges)
        assert all((b, a) in once for a, b in once)
        assert volume_of(vertices, triangles) > 0.0
        volume += 0.0 if fixed else volume_of(vertices, triangles)
    within = 1e-2 if result.kind == "surface" else 1e-9  # the mesh of a round mass lies within it
    assert volume == pytest.approx(result.geometry.volume_m3, rel=within)


@pytest.mark.parametrize("name", [*ONE_BLOCK, *MANY])
def test_the_forces_of_the_node_pairs_carry_the_loads(name: str) -> None:
    scene = solved(name).scene
    pairs, loads = scene.pairs, scene.loads
    count = len(scene.shapes.names)
    carried, load = np.zeros((count, 3)), np.zeros((count, 3))
    forces = pairs.normal_kn[:, None] * pairs.normals + pairs.shear_kn
    np.add.at(carried, pairs.plus, forces)
    other = pairs.minus >= 0
    np.subtract.at(carried, pairs.minus[other], forces[other])
    np.add.at(load, loads.block, loads.force_kn)
    free = ~scene.shapes.fixed
    np.testing.assert_allclose(carried[free], -load[free], atol=1e-6 * np.abs(load).max())


def bolted() -> Result:
    return sk.wedge(
        dips=("45/115", "45/245"),
        water="50%",
        bolts=["2000000@000/10,passive", "100000@010/20,active"],
        origin=(300.0, -200.0, 50.0),
    )


@pytest.mark.parametrize("name", ["wedge-scatter", "plane", "cylinder", "surface", "bolted"])
def test_forces_and_moments_of_loads_and_pairs_cancel(name: str) -> None:
    """Points and forces stand in the same axes; passive bolts pull with what the limit leaves them."""
    scene = (bolted() if name == "bolted" else solved(name)).scene
    middle = scene.shapes.centroids[0]
    pairs, loads = scene.pairs, scene.loads
    forces = pairs.normal_kn[:, None] * pairs.normals + pairs.shear_kn
    turning = np.cross(pairs.points_m - middle, forces).sum(axis=0)
    turning = turning + np.cross(loads.at_m - middle, loads.force_kn).sum(axis=0)
    size = np.abs(loads.force_kn).sum()
    assert np.abs(forces.sum(axis=0) + loads.force_kn.sum(axis=0)).max() < 1e-6 * size
    assert np.abs(turning).max() < 1e-6 * size * np.ptp(pairs.points_m, axis=0).max()


def test_without_a_limit_state_the_node_pairs_carry_nothing() -> None:
    scene = sk.wedge(
        dips=("45/115", "45/245"), water="u=900kPa", bolts=["100@000/10,passive"]
    ).scene
    assert not scene.pairs.normal_kn.any()
    assert not scene.pairs.shear_kn.any()
    assert "passive bolt 1, full capacity" in scene.loads.names


@pytest.mark.parametrize("name", [*ONE_BLOCK, *MANY])
def test_node_pairs_lie_on_their_interfaces(name: str) -> None:
    scene = solved(name).scene
    contacts, pairs = scene.shapes.contacts, scene.pairs
    middle = contacts.corners.mean(axis=0)
    size = np.ptp(contacts.corners, axis=0).max()
    for joint in set(pairs.joint.tolist()):
        own = np.flatnonzero(contacts.joint == joint)
        planes = []
        for k in own.tolist():
            corners = contacts.corners[contacts.first[k] : contacts.first[k + 1]] - middle
            normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
            planes.append([*(normal / np.linalg.norm(normal)), *corners[0]])
        flat = np.array(planes)
        points = pairs.points_m[pairs.joint == joint] - middle
        apart = np.abs(
            np.einsum("pkx,kx->pk", points[:, None, :] - flat[None, :, 3:], flat[:, :3])
        ).min(axis=1)
        assert apart.max() < (1e-2 if solved(name).kind == "surface" else 1e-9) * size


def test_json_keeps_every_array() -> None:
    scene = solved("wall").scene
    again = BlockScene.from_dict(json.loads(json.dumps(solved("wall").to_dict()["scene"])))
    assert again.shapes.names == scene.shapes.names
    assert again.loads.names == scene.loads.names
    for part in (
        "points_m",
        "normals",
        "normal_kn",
        "shear_kn",
        "mode",
        "plus",
        "minus",
        "control_area_m2",
        "joint",
    ):
        np.testing.assert_array_equal(getattr(again.pairs, part), getattr(scene.pairs, part))
    for part in ("vertices", "triangles", "block", "face"):
        np.testing.assert_array_equal(
            getattr(again.shapes.solids, part), getattr(scene.shapes.solids, part)
        )
    np.testing.assert_array_equal(again.velocity, scene.velocity)
    np.testing.assert_array_equal(again.factor, scene.factor)


def test_modes_add_up_to_those_of_the_mechanism() -> None:
    result = solved("goodman-bray")
    counted = np.bincount(result.scene.pairs.mode, minlength=3)
    assert result.findings is not None
    assert dict(zip(MODES, counted.tolist(), strict=True)) == result.findings.first.pairs_by_mode


def test_map_coordinates_are_put_back() -> None:
    at = {"dips": ("45/115", "45/245"), "water": "full"}
    near, far = sk.wedge(**at).scene, sk.wedge(**at, origin=(4e6, 5.5e6, 300.0)).scene
    offset = np.array([4e6, 5.5e6, 300.0])
    for a, b in (
        (near.shapes.solids.vertices, far.shapes.solids.vertices),
        (near.pairs.points_m, far.pairs.points_m),
        (near.loads.at_m, far.loads.at_m),
        (near.shapes.contacts.corners, far.shapes.contacts.corners),
        (near.shapes.centroids, far.shapes.centroids),
    ):
        np.testing.assert_allclose(b - offset, a, atol=2e-9)


def test_a_plane_stands_in_map_axes() -> None:
    """A face that dips toward 090: the section's x is east, and the block slides that way."""
    scene = sk.run(
        path_of("plane"), set={"slope.face": "60/090", "joints.J1.plane": "35/090"}
    ).scene
    assert scene.velocity[0, 0] > 0.8
    assert abs(scene.velocity[0, 1]) < 1e-12
    assert np.ptp(scene.shapes.solids.vertices[:, 1]) == pytest.approx(1.0)
    assert "water on crack" in scene.loads.names


@pytest.mark.parametrize("broken", [{}, {"shapes": 3}, {"shapes": {"names": []}}])
def test_a_scene_that_cannot_be_read(broken: dict[str, Any]) -> None:
    with pytest.raises(sk.DesignError, match="E350"):
        BlockScene.from_dict(broken)


def test_packed_arrays() -> None:
    whole = packed(np.array([[1, -2], [3, 4]]))
    assert whole["type"] == "int32"
    assert unpacked(whole).tolist() == [[1, -2], [3, 4]]
    assert unpacked(packed(np.array([True, False]))).tolist() == [1, 0]
    assert unpacked(packed(np.zeros((0, 3)))).shape == (0, 3)


def test_a_prism_of_an_outline_that_is_not_convex() -> None:
    outline = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [0.0, 4.0]])
    for line in (outline, outline[::-1]):
        assert volume_of(*prism(line, 2.0, 5.0)) == pytest.approx(2.0 * 10.0)


def test_corners_that_faces_share_are_one() -> None:
    square = np.array([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
    up = np.array([0.0, 0.0, 1.0])
    top = square[::-1] + up
    sides = [
        np.array([square[k], square[k - 1], square[k - 1] + up, square[k] + up]) for k in range(4)
    ]
    vertices, triangles, face = closed([square, top, *sides])
    assert (len(vertices), len(triangles), set(face.tolist())) == (8, 12, set(range(6)))
    assert abs(volume_of(vertices, triangles)) == pytest.approx(1.0)
