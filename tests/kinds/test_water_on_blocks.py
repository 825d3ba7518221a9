"""Water tables, ponds and surcharges on many blocks: Archimedes, hand-solved columns, a section and its 3-D twin."""

import math

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.errors import DesignError, MisfitError
from slopekit.kinds import kind_named
from slopekit.kinds.assemblies.many_blocks_scene import scene_loads

WATER = 9.81
SECTION = {
    "slopekit": 1,
    "kind": "blocks",
    "strength": {"s": {"c": 5, "phi": 35}},
    "rock": {"unit_weight": 26},
    "blocks": {
        "base": {"polygon": [[-4, -3], [9, -3], [9, 6], [0, 0], [-4, 0]], "fixed": True},
        "B1": {"polygon": [[0, 0], [3, 2], [3, 6], [0.5, 4]]},
        "B2": {"polygon": [[3, 2], [9, 6], [9, 9], [3, 6]]},
    },
}
BENCH = {
    "slopekit": 1,
    "kind": "bench",
    "slope": {"face": "70/180", "height": "8 m", "length": "16 m"},
    "sets": {
        "S1": {"plane": "35/175", "spacing": "3 m"},
        "S2": {"plane": "80/270", "spacing": "4 m"},
    },
    "strength": {"s": {"c": 5, "phi": 30}},
    "rock": {"unit_weight": 25},
}
COLUMNS = {
    "slopekit": 1,
    "kind": "topple",
    "strength": {"s": {"c": 0, "phi": 42}},
    "rock": {"unit_weight": 25},
    "columns": {
        "dip": 60,
        "width": "10 m",
        "heights": [4, 10, 16, 22, 28, 24, 18, 12, 6],
        "base_step": "1 m",
    },
}


SMALL = BENCH | {"slope": {"face": "70/180", "height": "6 m", "length": "8 m"}}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("design", "level"), [(SECTION, 30.0), (SMALL, 20.0), (COLUMNS, 200.0)], ids="sbc"
)
def test_drowned_blocks_have_their_buoyant_weight(design, level) -> None:
    """Archimedes: γ_w V less, through the centroid, whatever the contacts; and the factor of that weight."""
    scene = kind_named(design["kind"]).cut(sk.load({**design, "water": {"pond": level}}))
    loads = scene_loads(scene)
    free = ~scene.assembly.fixed
    lighter = np.zeros((len(scene.assembly), 3))
    lighter[:, 2] = WATER * scene.assembly.volumes - loads.weights
    size = float(loads.weights.max())
    assert loads.forces[free] == pytest.approx(lighter[free], abs=1e-11 * size)
    assert loads.moments[free] == pytest.approx(0.0, abs=1e-10 * size)
    buoyant = {**design, "rock": {"unit_weight": design["rock"]["unit_weight"] - WATER}}
    drowned, lighter_one = sk.run({**design, "water": {"pond": level}}), sk.run(buoyant)
    assert drowned.fos.limit == pytest.approx(lighter_one.fos.limit, rel=1e-9)
    if design is COLUMNS:
        assert drowned.fos.closed_form == pytest.approx(lighter_one.fos.closed_form, rel=1e-9)
    assert drowned.forces.water["free faces"] > 0.0


def mesh(path, polygon, half):
    """A prism of a section as an OBJ file."""
    k = len(polygon)
    lines = [f"v {x!r} {y!r} {z!r}" for y in (-half, half) for x, z in polygon]
    for i in range(1, k - 1):  # the polygons are convex
        lines += [f"f 1 {i + 1} {i + 2}", f"f {k + 1} {k + i + 2} {k + i + 1}"]
    for i in range(k):
        j = (i + 1) % k
        lines += [f"f {i + 1} {k + i + 1} {k + j + 1}", f"f {i + 1} {k + j + 1} {j + 1}"]
    path.write_text("\n".join(lines) + "\n")


def test_a_section_and_its_prisms(tmp_path) -> None:
    """The same table, pond and surcharge on a section 2 m thick and on its blocks as meshes: forces and moments."""
    more = {
        "water": {"mode": "table", "points": [[0, 1.0], [3, 3.5], [8, 7.0]], "pond": 2.5},
        "loads": {"surcharge": {"B2": "20 kPa"}},
    }
    parts = {name: one["polygon"] for name, one in SECTION["blocks"].items()}
    parts["base"] = [[-4, -3], [9, -3], [9, 6], [0, 0]]  # convex, the same under the blocks
    section = {**SECTION, **more, "section": {"thickness": "2 m"}}
    section["blocks"] = {name: {"polygon": one} for name, one in parts.items()}
    solid = {**SECTION, **more, "blocks": {}}
    for name, polygon in parts.items():
        mesh(tmp_path / f"{name}.obj", [(float(x), float(z)) for x, z in polygon], 1.0)
        solid["blocks"][name] = {"mesh": str(tmp_path / f"{name}.obj")}
    for design in (section, solid):
        design["blocks"]["base"]["fixed"] = True
    flat, deep = (scene_loads(kind_named("blocks").cut(sk.load(one))) for one in (section, solid))
    assert flat.forces[1:] == pytest.approx(deep.forces[1:], abs=1e-6)
    assert flat.moments[1:] == pytest.approx(deep.moments[1:], abs=1e-5)
    assert flat.forces[2, 2] == pytest.approx(deep.forces[2, 2], rel=1e-9)


@pytest.mark.parametrize("level", [0.9, 1.8])
def test_a_column_in_a_pond_by_hand(level) -> None:
    """One column of 1 x 2 m on a base of 20°, wet to a level over its foot: hydrostatics of its base, face and back.

    Face and back take γ_w h² / 2 each over their wet lengths; the base γ_w times the depth of its middle where it is
    all wet, a triangle where it is not.
    """
    design = {
        **COLUMNS,
        "columns": {"dip": 70, "width": "1 m", "heights": [2]},
        "water": {"pond": level},
    }
    loads = scene_loads(kind_named("topple").cut(sk.load(design)))
    dip = math.radians(20.0)
    wet_face, wet_back = (
        level / math.cos(dip),
        (level - math.sin(dip)) / math.cos(dip),
    )  # along the column
    along = (
        WATER * (level * wet_face - (level - math.sin(dip)) * wet_back) / 2.0
    )  # of face and back, up the base
    base = WATER * (level - math.sin(dip) / 2.0)
    expected = along * np.array([math.cos(dip), 0, math.sin(dip)]) + base * np.array(
        [-math.sin(dip), 0, math.cos(dip)]
    )
    assert loads.forces[0] - [0, 0, -50.0] == pytest.approx(expected, abs=1e-9)
    weight = 50.0
    normal, driving = weight * math.cos(dip) - base, weight * math.sin(dip) - along
    result = sk.run(design)
    assert result.fos.limit == pytest.approx(
        normal * math.tan(math.radians(42)) / driving, rel=1e-6
    )
    assert result.fos.closed_form == pytest.approx(result.fos.limit, rel=1e-6)


@pytest.mark.parametrize(
    "more",
    [
        {"water": {"mode": "table", "points": [[0, 0], [20, 14], [60, 45]]}},
        {"water": {"pressures": {"base": 20, "sides": 6}}},
        {"loads": {"surcharge": {"C4": 60, "C8": 30}}},
    ],
    ids=str,
)
def test_goodman_and_bray_with_water(more) -> None:
    """The closed form has the loads of PRE-IE on each column: the same factor, and another than without them."""
    result, dry = sk.run({**COLUMNS, **more}), sk.run(COLUMNS)
    assert result.agree
    assert result.fos.closed_form == pytest.approx(result.fos.limit, rel=1e-4)
    assert abs(result.fos.closed_form / dry.fos.closed_form - 1.0) > 1e-3


def test_columns_that_slide_onto_those_that_topple_are_not_compared() -> None:
    """Goodman & Bray's P acts at the top of the column below, as a toppling one presses; a sliding one need not."""
    result = sk.run({**COLUMNS, "water": {"mode": "table", "points": [[0, 0], [20, 12], [60, 55]]}})
    assert result.agree is None
    assert any("C7" in str(notice) and "W310" in str(notice) for notice in result.warnings)


def test_a_bench_below_its_ground() -> None:
    """A table 2 m below the ground, by its depth and by points along face and upper slope; pond and surcharge."""
    face = 8.0 / math.tan(math.radians(70.0))
    waters = (
        {"mode": "table", "depth": "2 m"},
        {"mode": "table", "points": [[-3 * face, -26], [face, 6], [9, 6]]},
    )
    first, second = (
        kind_named("bench").cut(sk.load({**BENCH, "water": water})) for water in waters
    )
    assert first.pressures == pytest.approx(second.pressures, abs=1e-9)
    loaded = kind_named("bench").cut(sk.load({**BENCH, "loads": {"surcharge": 20}}))
    on_top = sum(float(load.push.force[2]) for load in loaded.acting.pushes)
    plan = 0.0
    for corners in loaded.assembly.vertices[
        loaded.assembly.triangles[~loaded.assembly.fixed[loaded.assembly.triangle_block]]
    ]:
        if (corners[:, 2] > 8.0 - 1e-9).all():
            plan += 0.5 * abs(float(np.cross(corners[1] - corners[0], corners[2] - corners[0])[2]))
    assert plan > 1.0
    assert on_top == pytest.approx(-20.0 * plan, rel=1e-9)
    with pytest.raises(MisfitError, match="E456"):  # between two points the table stands in the air
        sk.run({**BENCH, "water": {"mode": "table", "points": [[0, 0], [1, 7], [6, 7]]}})


def test_a_surcharge_is_a_force_on_the_top_of_a_block() -> None:
    """On B2: its top, 6 m in plan; B1 presses on it from the side alone. Typed as a force, the same factor."""
    pressed = sk.run({**SECTION, "loads": {"surcharge": {"B2": "50 kPa"}}})
    forced = sk.run(
        {
            **SECTION,
            "loads": {"forces": [{"force": [0, 0, -300], "at": [6, 0, 7.5], "block": "B2"}]},
        }
    )
    assert pressed.fos.limit == pytest.approx(forced.fos.limit, rel=1e-9)
    assert "surcharge 50 kPa on B2" in str(pressed.sheet)


@pytest.mark.parametrize(
    ("design", "more", "code"),
    [
        (SECTION, {"loads": {"surcharge": {"B7": 5}}}, "E250"),
        (SECTION, {"loads": {"surcharge": {"base": 5}}}, "E250"),
        (SECTION, {"loads": {"surcharge": {"B1": -5}}}, "E123"),
        (COLUMNS, {"loads": {"surcharge": {"D1": 5}}}, "E250"),
        (SECTION, {"water": {"pond": 3, "pressures": {"B1/B2": 5}}}, "E112"),
        (SECTION, {"water": {"pond": "x"}}, "E106"),
        (COLUMNS, {"water": {"mode": "table"}}, "E454"),
        (COLUMNS, {"water": {"mode": "table", "depth": 2}}, "E142"),
        (BENCH, {"water": {"mode": "table", "depth": -2}}, "E454"),
        (BENCH, {"loads": {"surcharge": -2}}, "E123"),
        (BENCH, {"water": {"mode": "table", "depth": 2, "plane": "5/180@1m"}}, "E112"),
    ],
    ids=str,
)
def test_what_is_wrong(design, more, code) -> None:
    """Each is said by its code."""
    with pytest.raises(DesignError) as found:
        sk.load({**design, **more})
    assert code in found.value.codes


def test_what_cannot_be() -> None:
    """A surcharge under another block (E461), and a pond that wets nothing (W419)."""
    stack = {
        **SECTION,
        "blocks": {
            "base": {"polygon": [[-2, -1], [2, -1], [2, 0], [-2, 0]], "fixed": True},
            "B1": {"polygon": [[-1, 0], [1, 0], [1, 1], [-1, 1]]},
            "B2": {"polygon": [[-1, 1], [1, 1], [1, 2], [-1, 2]]},
        },
        "loads": {"surcharge": {"B1": 5}},
    }
    with pytest.raises(MisfitError, match="E461"):
        sk.run(stack)
    dry = sk.run({**SECTION, "water": {"pond": -1}})
    assert "W419" in [notice.code for notice in dry.warnings]
    assert dry.fos.limit == pytest.approx(sk.run(SECTION).fos.limit, rel=1e-12)
