"""Bolts in a scene: heads as the design has them, ends and plates against planes by hand; JSON and the schedule."""

import csv
import io
import json
import math

import numpy as np
import pytest
import trimesh

import slopekit as sk
from slopekit.block_scene import BlockScene
from slopekit.bolts import nearest, plates, rods
from slopekit.core.orientation import millimetre, parse_plane
from slopekit.core.sheet import Section
from slopekit.kinds.sheets.bolts import schedule, schedule_entries
from tests.bolted import WEDGE, bolt, bolted


def outward(plane: str) -> np.ndarray:
    dip, bearing = (
        math.radians(parse_plane(plane, "").dip_deg),
        math.radians(parse_plane(plane, "").dip_direction_deg),
    )
    return np.array(
        [math.sin(dip) * math.sin(bearing), math.sin(dip) * math.cos(bearing), math.cos(dip)]
    )


def test_heads_ends_and_plates() -> None:
    """A length is taken as given; without one a bolt ends on the joint that it meets first; plates lie on the face."""
    result = bolted("three")
    bolts = result.scene.bolts
    given = result.design.bolts
    assert bolts.number.tolist() == [1, 2]  # the third has no head
    assert bolts.heads_m.tolist() == [list(given[k].head_m) for k in (0, 1)]
    assert bolts.force_kn.tolist() == [300.0, 100.0]
    assert bolts.passive.tolist() == [False, True]
    assert bolts.length_m[0] == 20.0
    assert math.isnan(bolts.length_m[1])
    way = given[0].toward.vector()
    np.testing.assert_allclose(bolts.ends_m[0], bolts.heads_m[0] + 20.0 * way, rtol=0, atol=1e-12)
    np.testing.assert_allclose(bolts.plates, np.tile(outward("65/180"), (2, 1)), atol=1e-12)
    # both joints pass through the toe, which is the origin of a design without one
    joints = [outward("50/120"), outward("48/240")]
    reaches = [-float(normal @ bolts.heads_m[1]) / float(normal @ way) for normal in joints]
    reach = min(one for one in reaches if one > 0.0)
    np.testing.assert_allclose(bolts.ends_m[1], bolts.heads_m[1] + reach * way, atol=1e-9)


def test_map_coordinates_move_bolts_with_the_slope() -> None:
    east, north = 4_000_000.0, 5_500_000.0
    near = bolted("three")
    head = [east, north + 5.0 / math.tan(math.radians(65.0)), 305.0]
    moved = [{"force": 300, "toward": "000/5", "acts": "passive", "head": head}]
    slope = WEDGE["slope"] | {"origin": [east, north, 300.0]}
    far = sk.run(WEDGE | {"slope": slope, "support": {"bolts": moved}}).scene.bolts
    here = sk.run(WEDGE | {"support": {"bolts": [bolt(0.0, 5.0, length=None)]}}).scene.bolts
    np.testing.assert_allclose(far.ends_m - [east, north, 300.0], here.ends_m, atol=1e-8)
    np.testing.assert_allclose(far.plates, near.scene.bolts.plates[:1], atol=1e-8)


def test_bolts_of_many_blocks_belong_to_the_block_of_their_head() -> None:
    result = bolted("bench")
    scene = result.scene
    for head, block in zip(scene.bolts.heads_m, scene.bolts.block.tolist(), strict=True):
        vertices, triangles = scene.shapes.solids.block_surface(block)
        assert not scene.shapes.fixed[block]
        corners = vertices[triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        above = ((head - corners[:, 0]) * normals).sum(axis=1) / np.linalg.norm(normals, axis=1)
        assert above.max() <= 1e-9  # within, or on its surface: blocks of a bench are convex
    np.testing.assert_allclose(scene.bolts.plates, np.tile(outward("70/180"), (6, 1)), atol=1e-9)


def test_json_has_bolts_only_where_there_are_any() -> None:
    document = json.loads(json.dumps(bolted("three").to_dict()))
    back = BlockScene.from_dict(document["scene"]).bolts
    for name in (
        "number",
        "block",
        "heads_m",
        "ends_m",
        "plates",
        "passive",
        "force_kn",
        "length_m",
    ):
        np.testing.assert_array_equal(
            getattr(back, name), getattr(bolted("three").scene.bolts, name)
        )
    assert back.passive.dtype == bool
    bare = sk.run(WEDGE | {"support": {"bolts": [{"force": 50, "toward": "010/10"}]}}).to_dict()
    assert "bolts" not in bare["scene"]
    assert len(BlockScene.from_dict(bare["scene"]).known_bolts) == 0


def test_rods_and_plates_are_closed_and_in_place() -> None:
    heads, ends = (
        np.array([[1.0, 2.0, 3.0], [5e6, 0.0, 0.0]]),
        np.array([[1.0, 9.0, 3.0], [5e6, 3.0, 4.0]]),
    )
    vertices, triangles = rods(heads, ends, 0.05)
    mesh = trimesh.Trimesh(*rods(heads[:1], ends[:1], 0.05), process=False)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(
        7.0 * 12 / 2 * 0.05**2 * math.sin(math.radians(30.0)), rel=1e-9
    )
    np.testing.assert_array_equal(
        vertices.reshape(2, -1, 3)[:, -2:], np.stack([heads, ends], axis=1)
    )
    assert len(triangles) == 2 * 48
    plate = trimesh.Trimesh(*plates(heads[:1], np.array([[0.0, -1.0, 0.0]]), 0.2), process=False)
    assert plate.is_watertight
    assert plate.volume == pytest.approx(0.2**3 * 0.2)
    assert plate.bounds[:, 1].tolist() == pytest.approx([2.0 - 0.04, 2.0])  # out of the rock
    assert nearest(np.array([[0.0, 0.0, 0.0], [3.0, 4.0, 0.0], [0.0, 0.0, 0.0]])) == 5.0
    assert nearest(heads[:1]) == math.inf


@pytest.mark.parametrize("name", ["three", "pattern", "plane", "bench", "two hundred"])
def test_the_schedule_is_the_designs(name) -> None:
    """Every number of the CSV against the design, to the digits that it has; the sheet has the first and the last."""
    result = bolted(name)
    rows = list(csv.DictReader(io.StringIO(result.sheet.tables["bolts.csv"].csv())))
    assert [int(row["number"]) for row in rows] == list(range(1, len(result.design.bolts) + 1))
    for row, given in zip(rows, result.design.bolts, strict=True):
        place = [row[key] for key in ("east_m", "north_m", "z_m")]
        if given.head_m is None:
            assert place == ["", "", ""]
        else:
            assert all(len(text.partition(".")[2]) == 3 for text in place)
            assert [float(text) for text in place] == pytest.approx(
                list(given.head_m), abs=5.0001e-4
            )
        assert row["length_m"] == ("" if given.length_m is None else f"{given.length_m:.3f}")
        assert float(row["force_kn"]) == pytest.approx(given.force_kn, abs=5e-4)
        assert float(row["trend_deg"]) == pytest.approx(given.toward.trend_deg % 360.0, abs=5e-3)
        assert float(row["plunge_deg"]) == pytest.approx(given.toward.plunge_deg, abs=5e-3)
        assert (row["acts"], row["slice_m"]) == (given.acts, "1" if name == "plane" else "")
    (section,) = (one for one in result.sheet.sections if one.label == "BOLTS")
    lines = section.lines()
    lines = [line[10:] for line in lines]
    assert len(lines) <= 10
    assert all(len(line) <= 90 for line in lines)
    shown = [line.split()[0] for line in lines if line.strip()[0].isdigit()]
    count = len(rows)
    wanted = [*range(1, count + 1)] if count <= 8 else [*range(1, 6), count - 1, count]
    assert shown == [str(number) for number in wanted]
    if count > 8:
        assert f"... {count - 7} more" in lines[6]
    assert max(map(len, str(result).splitlines())) <= 100


def test_words_of_the_schedule() -> None:
    three = schedule(bolted("three").to_dict())
    lines = Section("", schedule_entries(three)).lines()
    assert lines[-1].strip() == "bolt 3 has no head and is not drawn: a force through the centroid"
    assert lines[1].split() == [
        "1",
        "0.000",
        millimetre(5.0 / math.tan(math.radians(65.0))),
        "5.000",
        "20.000",
        "000.0/5.0",
        "300.0",
        "active",
    ]
    assert lines[2].split()[4] == "-"  # no length
    assert schedule_entries(three[2:]) == []  # no place, no table
    assert (
        schedule_entries(schedule(bolted("plane").to_dict()))[-1]
        == "a section: forces are those on 1 m of slope"
    )


def test_bolts_with_heads_stand_in_their_table_alone() -> None:
    assert bolted("pattern").to_dict()["sheet"]["LOADS"] == ["48 bolts (BOLTS)"]
