"""Loads act where they act: resultants and moments against integration and against hand sums."""

import numpy as np
import pytest

import slopekit as sk
from slopekit.geometry.interfaces import node_pairs
from slopekit.geometry.polytopes import Block
from slopekit.geometry.pressure import Pieces, pyramid_pieces, resultant, uniform_pieces
from slopekit.kinds.wedge.cutting import J1, J2, shape_of
from slopekit.kinds.wedge.design import wedge_design
from slopekit.loads import Loads, PointForce, block_loads


@pytest.fixture(scope="module")
def block() -> Block:
    return shape_of(
        wedge_design({"dips": ("45/105", "70/235"), "face": "65/185", "upper": "12/195"})
    ).block


def moment_of(block: Block, forces=(), active=()) -> np.ndarray:
    return block_loads(block, 0.0, np.zeros(3), forces, active).moment


def loads_of_water(block: Block, joint: int, pieces: Pieces) -> Loads:
    polygon = block.faces[joint]
    (thrust,), (at,) = resultant(pieces, polygon[None])
    outward = np.cross(polygon[1] - polygon[0], polygon[2] - polygon[0])
    push = PointForce(-thrust * outward / np.linalg.norm(outward), at)
    return block_loads(block, 0.0, np.zeros(3), pushes={f"water {joint}": push})


def test_weight_and_seismic_act_at_the_centroid(block) -> None:
    loads = block_loads(block, 25.0, np.array([0.1, 0.0, 0.0]))
    assert loads.force == pytest.approx([2.5 * block.volume, 0.0, -25.0 * block.volume], rel=1e-12)
    assert np.abs(loads.moment).max() == 0.0


def test_even_pressure_acts_at_the_middle_of_its_face(block) -> None:
    """Integrated over node pairs, a rule exact to degree two that water does not use."""
    pairs = node_pairs({J1: block.faces[J1]})
    forces = 7.0 * pairs.control_areas[:, None] * pairs.normals
    exact = np.cross(pairs.points - block.centroid, forces).sum(axis=0)
    loads = loads_of_water(block, J1, uniform_pieces(block.faces[J1][None], 7.0))
    assert loads.moment == pytest.approx(exact, rel=1e-10)


@pytest.mark.parametrize("joint", [J1, J2])
def test_pyramid_of_pressure_acts_where_integration_says(block, joint) -> None:
    """Pressure rises linearly from the free edges to the middle of the line of intersection (12 m below the top).

    Integrated with the degree-two rule on the two triangles that meet at the peak: exact for linear pressure.
    """
    polygon = np.asarray(block.faces[joint])
    on_line = [
        point
        for point in polygon
        if min(np.abs(other - point).sum() for other in block.faces[1 - joint]) < 1e-9
    ]
    apex = sum(on_line) / 2.0
    rest = next(
        point for point in polygon if not any(np.array_equal(point, other) for other in on_line)
    )
    force, moment = np.zeros(3), np.zeros(3)
    outward = np.cross(polygon[1] - polygon[0], polygon[2] - polygon[0])
    for end in on_line:
        triangle = np.array([apex, end, rest])
        if np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0]) @ outward < 0.0:
            triangle = triangle[::-1]
        pairs = node_pairs({0: triangle})
        # the share of the peak at each node: barycentric coordinate of the apex
        share = np.array(
            [1.0 if np.abs(p - apex).sum() < 1e-9 else 0.0 for p in triangle] + [1.0 / 3.0]
        )
        pushes = (30.0 * share * pairs.control_areas)[:, None] * pairs.normals
        force, moment = (
            force + pushes.sum(axis=0),
            moment + np.cross(pairs.points - block.centroid, pushes).sum(axis=0),
        )
    loads = loads_of_water(block, joint, pyramid_pieces(block.faces[joint][None], 10.0, apex[None]))
    assert loads.force == pytest.approx(force, rel=1e-10)  # the mean is a third of the peak
    assert loads.moment == pytest.approx(moment, rel=1e-10)


def test_forces_and_bolts_act_where_they_are_put(block) -> None:
    at, force = np.array([3.0, -5.0, 20.0]), np.array([100.0, -40.0, 70.0])
    exact = np.cross(at - block.centroid, force)
    assert moment_of(block, forces=[PointForce(force, at)]) == pytest.approx(exact, rel=1e-12)
    assert moment_of(block, active=[PointForce(force, at)]) == pytest.approx(exact, rel=1e-12)
    assert np.abs(moment_of(block, forces=[PointForce(force)])).max() == 0.0


def test_a_force_far_off_the_centroid_makes_moments_govern() -> None:
    """The same force through the centroid changes nothing but the forces: the closed form cannot tell the two apart."""
    push = (0.0, -5e5, 0.0)
    near = sk.wedge(dips=("45/115", "45/245"), forces=[push])
    far = sk.wedge(dips=("45/115", "45/245"), forces=[{"force": push, "at": (1500.0, 77.9, 57.4)}])
    assert near.fos.closed_form == far.fos.closed_form
    assert not near.moments_govern
    assert far.moments_govern
    assert far.status in ("rotates", "topples")


def test_a_head_gives_a_bolt_its_moment_and_is_checked() -> None:
    wedge = {"dips": ("45/115", "45/245")}
    head = {"force": 1e5, "toward": "000/10", "head": (0.0, 20.0, 34.0), "length": 60}
    with_head, without = sk.wedge(**wedge, bolts=head), sk.wedge(**wedge, bolts="1e5@000/10")
    assert with_head.fos.closed_form == without.fos.closed_form
    assert [notice.code for notice in with_head.warnings] == ["W379"]
    assert [notice.code for notice in without.warnings if notice.code != "W379"] == ["W311"]
    moved = {**head, "head": (5e5, 4e6 + 20.0, 1e3 + 34.0)}
    assert sk.wedge(**wedge, bolts=moved, origin=(5e5, 4e6, 1e3)).fos == with_head.fos
