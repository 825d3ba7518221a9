"""Assemblies end to end: factors, mechanisms, what is said, what is refused."""

import json
import math
import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import trimesh

import slopekit as sk
from benchmarks import benches, populations
from slopekit.core.errors import DesignError, GeometryError
from slopekit.design.templates import path_of
from slopekit.kinds import cut, kind_of
from slopekit.kinds.assemblies.many_blocks_scene import scene_loads
from slopekit.kinds.solver_inputs import joint_strength
from slopekit.preie.many_blocks.blocks_limit import Basis
from slopekit.preie.many_blocks.ravelling import Ravelling, ravel
from slopekit.preie.outcome import Outcome
from slopekit.result import Result
from tests.preie import path_oracle
from tests.support import result_of

SQUARE = [[0, 0], [1, 0], [1, 1], [0, 1]]


def turned(points, degrees: float):
    """Points turned up by an angle about the origin: a level scene becomes one on an incline."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return [[x * c - z * s, x * s + z * c] for x, z in points]


def on_incline(outlines, dip: float, phi: float, c: float = 0.0, **more) -> dict:
    """Blocks by name above a fixed base, the whole turned by the dip."""
    blocks = {
        "base": {"polygon": turned([[-50, -5], [200, -5], [200, 0], [-50, 0]], dip), "fixed": True}
    }
    blocks |= {name: {"polygon": turned(outline, dip)} for name, outline in outlines.items()}
    design = {
        "slopekit": 1,
        "kind": "blocks",
        "blocks": blocks,
        "strength": {"joint": {"c": c, "phi": phi}},
        "rock": {"unit_weight": 25},
    }
    return design | more


def box(x: float, z: float, wide: float, high: float) -> list[list[float]]:
    return [[x, z], [x + wide, z], [x + wide, z + high], [x, z + high]]


def codes(result) -> set[str]:
    return {notice.code for notice in result.warnings}


def test_one_block_on_an_incline_slides_as_the_textbook_says() -> None:
    result = sk.run(on_incline({"B": box(0, 0, 4, 1)}, 20, 35, c=3))
    weight = 4 * 25
    expected = (3 * 4 + weight * math.cos(math.radians(20)) * math.tan(math.radians(35))) / (
        weight * math.sin(math.radians(20))
    )
    assert result.status == "slides"
    assert result.fos.limit == pytest.approx(expected, rel=1e-6)
    assert result.fos.static_bound == pytest.approx(expected, rel=1e-6)
    assert result.findings.first.how[0] == "slides"


@pytest.mark.parametrize(("dip", "status"), [(44.9, "slides"), (45.1, "topples")])
def test_a_square_block_tips_at_its_geometric_limit(dip, status) -> None:
    """b/h = tan β: just below it slides at tan φ / tan β, just above no strength holds it."""
    result = sk.run(on_incline({"B": SQUARE}, dip, 50))
    assert result.status == status
    if status == "slides":
        assert result.fos.limit == pytest.approx(
            math.tan(math.radians(50)) / math.tan(math.radians(dip)), rel=1e-5
        )
    else:
        assert result.fos.limit is None
        assert result.exit_code == 0


def test_a_second_block_that_touches_nothing_changes_nothing() -> None:
    alone = sk.run(on_incline({"B": box(0, 0, 4, 1)}, 20, 35))
    both = sk.run(on_incline({"B": box(0, 0, 4, 1), "C": box(30, 0, 4, 1)}, 20, 35))
    assert both.fos.limit == alone.fos.limit
    apart = on_incline({"B": box(0, 0, 4, 1), "rock": box(30, 8, 4, 1)}, 20, 35)
    apart["blocks"]["rock"]["fixed"] = True
    assert "W334" in codes(sk.run(apart))


@pytest.mark.parametrize(
    ("floating", "message"),
    [
        ({"C": box(30, 8, 4, 1)}, "C has no contact and would fall whatever the strength"),
        (
            {"C": box(4, 1, 4, 1)},
            "C has no contact and would fall whatever the strength",
        ),  # a corner carries nothing
        ({"C": box(30, 0.01, 4, 1), "D": box(30, 1.01, 4, 1)}, "C, D have no contact with bedrock"),
    ],
)
def test_blocks_that_nothing_carries_are_refused(floating, message) -> None:
    with pytest.raises(GeometryError, match=message) as error:
        sk.run(on_incline({"B": box(0, 0, 4, 1), **floating}, 20, 35))
    fault = error.value.faults[0]
    assert fault.code == "E257"
    assert ("base and C are 10 mm apart" in fault.advice) == ("D" in floating)


def test_a_stack_on_an_incline() -> None:
    """Every joint of a stack carries what lies on it: tan φ / tan β whatever the heights."""
    stack = {f"B{k}": box(0, k, 30, 1) for k in range(6)}
    result = sk.run(on_incline(stack, 30, 35))
    assert result.fos.limit == pytest.approx(
        math.tan(math.radians(35)) / math.tan(math.radians(30)), rel=1e-6
    )


def test_mechanisms_one_after_the_other() -> None:
    """Three blocks with joints of their own fail in the order of their friction angles."""
    design = on_incline({name: box(20 * k, 0, 4, 1) for k, name in enumerate("ABC")}, 20, 30)
    design["strength"] = {
        name: {"c": 0, "phi": phi} for name, phi in zip("abc", (30, 25, 35), strict=True)
    }
    design["interfaces"] = {"default": "a", "B/base": "b", "C/base": "c"}
    design["analysis"] = {"mechanisms": 5}
    result = sk.run(design)
    assert [(row.blocks, row.role) for row in result.mechanisms] == [
        (("B",), "first"),
        (("A",), "next"),
        (("C",), "next"),
    ]
    expected = [math.tan(math.radians(phi)) / math.tan(math.radians(20)) for phi in (25, 30, 35)]
    assert [row.fos for row in result.mechanisms] == pytest.approx(expected, rel=1e-6)
    assert result.findings.standing == "none of 3 blocks is left"


def test_what_stands_without_strength() -> None:
    result = sk.run(on_incline({"B": SQUARE}, 0, 30))
    assert result.status == "no_driving_force"
    assert result.fos.limit is None
    assert result.exit_code == 0


def test_seismic_forces_bolts_and_water() -> None:
    """By hand: T = W sin β + k W cos β, N = W cos β - k W sin β - u b; a bolt up the slope takes its pull off T."""
    dip, phi, k, u, pull = 20.0, 35.0, 0.1, 2.0, 6.0
    weight, wide = 100.0, 4.0
    s, c = math.sin(math.radians(dip)), math.cos(math.radians(dip))
    design = on_incline({"B": box(0, 0, 4, 1)}, dip, phi)
    design["loads"] = {"seismic": {"k": k, "toward": 270}}
    design["water"] = {"pressures": {"B/base": u}}
    design["support"] = {
        "bolts": [{"force": pull, "toward": f"090/{-dip}", "block": "B", "acts": "active"}]
    }
    expected = (
        (weight * (c - k * s) - u * wide)
        * math.tan(math.radians(phi))
        / (weight * (s + k * c) - pull)
    )
    result = sk.run(design)
    assert result.fos.limit == pytest.approx(expected, rel=1e-6)
    assert result.forces.weight == pytest.approx(weight)


def test_gaps_overlaps_corners_and_names_that_do_not_touch() -> None:
    gap = on_incline(
        {
            "A": box(0, 0, 1, 1),
            "B": box(1.002, 0, 1, 1),
            "C": box(2.002, 1, 1, 1),
            "D": box(2.002, 0, 1, 1),
        },
        0,
        30,
    )
    gap["strength"]["smooth"] = {"c": 0, "phi": 5}
    gap["interfaces"] = {"default": "joint", "A/C": "smooth"}
    said = [notice.message for notice in sk.run(gap).warnings if notice.code == "W334"]
    for part in ("A and B are 2 mm apart over 1 m", "A/C", "corner"):
        assert any(part in message for message in said)
    with pytest.raises(GeometryError, match=r"A and B overlap by 0\.1 m²") as error:
        sk.run(on_incline({"A": box(0, 0, 1, 1), "B": box(0.9, 0, 1, 1)}, 0, 30))
    assert error.value.faults[0].code == "E257"
    little = sk.run(on_incline({"A": box(0, 0, 1, 1), "B": box(0.9995, 0, 1, 1)}, 0, 30))
    assert any("A/B 0.0005 m²" in notice.message for notice in little.warnings)


def test_meshes_are_blocks_too(tmp_path) -> None:
    """Two cubes on a slab, one file inside out, one with two bodies: the same factor as in a section."""
    slope = trimesh.transformations.rotation_matrix(math.radians(-20), [0, 1, 0])
    parts = {
        "base": trimesh.creation.box(
            [60, 40, 2], trimesh.transformations.translation_matrix([0, 0, -1])
        ),
        "A": trimesh.creation.box(
            [4, 4, 1], trimesh.transformations.translation_matrix([0, 0, 0.5])
        ),
        "B": trimesh.util.concatenate(
            [
                trimesh.creation.box(
                    [4, 4, 1], trimesh.transformations.translation_matrix([10, y, 0.5])
                )
                for y in (-8, 8)
            ]
        ),
    }
    for name, mesh in parts.items():
        mesh.apply_transform(slope)
        if name == "A":
            mesh.invert()
        mesh.export(tmp_path / f"{name}.obj")
    text = "slopekit: 1\nkind: blocks\nblocks:\n"
    text += "  base: {mesh: base.obj, fixed: true}\n  A: {mesh: A.obj}\n  B: {mesh: B.obj}\n"
    text += "strength: {joint: {c: 0, phi: 35}}\nrock: {unit_weight: 25}\ncontact_tolerance: 1 mm\n"
    (tmp_path / "cubes.yaml").write_text(text)
    result = sk.run(tmp_path / "cubes.yaml")
    assert result.fos.limit == pytest.approx(
        math.tan(math.radians(35)) / math.tan(math.radians(20)), rel=1e-6
    )
    assert "W334" in codes(result)
    assert result.geometry.volume_m3 == pytest.approx(48.0)


BENCH = {
    "slopekit": 1,
    "kind": "bench",
    "slope": {"face": "70/180", "height": 15, "upper": "0/180", "length": 15},
    "sets": {
        "S1": {"plane": "45/170", "spacing": 5, "strength": "j"},
        "S2": {"plane": "80/350", "spacing": 7, "offset": 0.5, "strength": "j"},
        "S3": {"plane": "85/80", "spacing": 7, "strength": "j"},
    },
    "strength": {"j": {"c": 0, "phi": 35}},
    "rock": {"unit_weight": 26},
}


@cache
def the_bench() -> Result:
    """The bench as it stands, analysed once."""
    return sk.run(BENCH)


def test_a_bench_fails_by_its_key_block() -> None:
    """A block on the set that daylights slides at tan φ / tan β; nothing is lost in the cutting."""
    result = the_bench()
    findings = result.findings
    assert result.status == "slides"
    assert result.fos.limit == pytest.approx(math.tan(math.radians(35)), rel=1e-3)
    assert findings.checks["volume_error"] < 1e-9
    assert findings.checks["area_error"] < 1e-9
    assert findings.blocks == findings.fixed + result.model.moving_blocks
    assert "W338" in codes(result)
    assert json.dumps(result.to_dict(), allow_nan=False)


def test_a_bench_is_the_same_for_the_same_seed() -> None:
    """Wherever it lies, mirrored, turned or of another size: tests/properties/test_assemblies.py."""
    scattered = json.loads(json.dumps(BENCH))
    for joint_set in scattered["sets"].values():
        joint_set |= {"scatter": 4, "spacing_scatter": 0.2, "spacing": 1.2 * joint_set["spacing"]}
    scattered["cut"] = {"seed": 3, "min_volume": 0.05}
    first, again = sk.run(scattered), sk.run(scattered)
    assert first.to_dict()["assembly"] == again.to_dict()["assembly"]
    assert any("slivers below" in text for text in first.model.left_out)
    other = cut(sk.load(scattered, set={"cut.seed": 4}))  # cut, not solved
    assert len(other.assembly) != first.findings.blocks


def test_coincident_planes_and_benches_without_a_free_block() -> None:
    double = json.loads(json.dumps(BENCH))
    double["sets"]["S4"] = {"plane": "45/170", "spacing": 8, "strength": "j"}
    result = sk.run(double)
    assert result.fos.limit == pytest.approx(the_bench().fos.limit, rel=1e-6)
    with pytest.raises(GeometryError, match="can move") as error:
        sk.run(
            BENCH,
            set={
                f"sets.S{k}.{key}": size
                for k in (1, 2, 3)
                for key, size in (("spacing", 500), ("offset", 250))
            },
        )
    assert error.value.faults[0].code == "E225"


def test_loads_on_a_bench_find_their_block() -> None:
    free = the_bench()
    name = free.findings.first.blocks[0]
    at = free.geometry.centroids_m[free.geometry.names.index(name)]
    held = sk.run(BENCH, set={"loads.forces": [{"force": [0, 0, -1.0], "at": at.tolist()}]})
    assert held.fos.limit == pytest.approx(free.fos.limit, rel=1e-2)
    for forces in (
        [{"force": [0, 0, -1], "at": [0, 900, 0]}],
        [{"force": [0, 0, -1], "block": "B99999"}],
    ):
        with pytest.raises(DesignError) as error:
            sk.run(BENCH, set={"loads.forces": forces})
        assert error.value.faults[0].code == "E250"
    with pytest.raises(DesignError) as error:
        sk.run(
            BENCH,
            set={
                "support.bolts": [
                    {"force": 9, "toward": "000/10", "block": "B9999", "acts": "passive"}
                ]
            },
        )
    assert error.value.faults[0].code == "E250"


COLUMNS = {
    "slopekit": 1,
    "kind": "topple",
    "columns": {"dip": 60, "width": 10, "heights": [4, 8, 12, 10, 6], "base_step": 1},
    "strength": {"j": {"c": 0, "phi": 38}},
    "rock": {"unit_weight": 25},
}


def test_columns_agree_with_goodman_and_bray() -> None:
    result = sk.run(COLUMNS)
    assert result.fos.limit == pytest.approx(result.fos.closed_form, rel=1e-5)
    assert result.agree
    assert [row["mode"] for row in result.findings.table] == [
        row["mode_preie"] for row in result.findings.table
    ]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"loads.forces": [{"force": [1, 0, 0], "block": "C1"}]}, "without forces"),
        ({"strength.j.dilation": 2}, "knows no dilation"),
    ],
)
def test_columns_that_the_closed_form_does_not_cover(change, said) -> None:
    result = sk.run(COLUMNS, set=change)
    assert result.agree is None
    assert any(notice.code == "W310" and said in notice.message for notice in result.warnings)


def test_the_limit_never_lies_above_the_bound_and_full_reduction_gives_one() -> None:
    """Strength divided by F fails at 1; c of 2 kPa so that bonds may break."""
    design = on_incline({f"B{k}": box(2.0 * k, 0, 2, 1 + k) for k in range(4)}, 25, 40, c=2)
    result = sk.run(design)
    assert result.fos.limit <= result.fos.static_bound * (1 + 1e-9)
    factor = result.fos.limit
    phi = math.degrees(math.atan(math.tan(math.radians(40)) / factor))
    again = sk.run(design, set={"strength.joint.phi": phi, "strength.joint.c": 2 / factor})
    assert again.fos.limit == pytest.approx(1.0, rel=1e-3)
    assert np.isfinite(replace(again, timing_s={}).fos.static_bound)


def test_what_the_results_of_hard_scenes_say() -> None:
    """A motion that does not settle, contacts that open, loads that tip, no bound: each has its notice."""
    from slopekit.kinds.assemblies import many_blocks as room
    from slopekit.kinds.assemblies.many_blocks import notices_of
    from slopekit.kinds.assemblies.many_blocks_states import mechanism

    design = sk.load(on_incline({"B": box(0, 0, 4, 1)}, 20, 35, c=1))
    scene = cut(design)
    strength = room.joint_strength(scene.strengths)
    loads = room.scene_loads(scene)
    ravelling_ = room.ravel(scene.assembly, loads, strength)
    failure = ravelling_.failures[0]
    part = failure.parts[0]

    def said(mesh_change: float | None = None, **changes) -> dict[str, str]:
        limit = replace(part.limit, **changes)
        changed = replace(failure, parts=(replace(part, limit=limit, mesh_change=mesh_change),))
        sequence = replace(ravelling_, sequence=(changed,), parts=changed.parts)
        notices = notices_of(design, scene, sequence, [mechanism(changed, scene)])
        return {notice.code: notice.message for notice in notices}

    assert said() == {}
    bond = np.array([1.0, 0.0, 1.0])
    assert said(basis=Basis.PEAK, change=0.01, bond=bond, static_bound=None).keys() == {
        "W317",
        "W307",
    }
    lost = "1 of 1 contacts with cohesion are open or partly open in the state that gives the factor of safety"
    assert lost in said(bond=bond)["W307"]
    assert (
        "67 % of the cohesion does not act" in said(bond=bond)["W307"]
    )  # Simpson's middle pair has two thirds
    assert "for 0.4 % of the elastic energy" in said(rounding=0.0042)["W317"]
    without = {"factor": None, "outcome": Outcome.NO_REST, "basis": Basis.NONE}
    tips = said(tips=(0.45, 0.8), **without)
    assert (
        "strength divided by 0.8 or less the blocks topple at 0.45 of the loads beside weight and"
        in tips["W362"]
    )
    assert tips["W362"].endswith("no factor of safety is given")
    assert "came to rest at none" not in tips["W362"]
    assert said(**without)["W362"].endswith("not that they arise")
    assert said(static_bound=None, **without)["W362"].endswith("no factor of safety is given")
    gave_up = {
        "factor": None,
        "outcome": Outcome.NOT_CONVERGED,
        "basis": Basis.NONE,
        "static_bound": 1.75,
    }
    assert said(**gave_up)["W308"].endswith(
        "whose forces balance within strength; the upper bound is 1.75"
    )
    assert said(spent=True, **gave_up).keys() == {"W360"}
    assert "by 1.5 %" in said(mesh_change=0.015)["W312"]
    in_group = (replace(part, limit=replace(part.limit, group=3, width=7e-4)),)
    held = " ".join(room._left_out(scene, in_group, drained=False))
    assert "the limit is that of a group of 3 of 1 blocks that touch, the others fixed" in held
    assert "all rest at 0.9993 of it" in held
    assert "others fixed" not in " ".join(room._left_out(scene, (part,), drained=False))


@pytest.mark.slow
@pytest.mark.parametrize("number", [27])
def test_the_static_bound_is_that_of_all_blocks(number) -> None:
    """By a program of all blocks."""
    design = populations.bench(number)
    result = sk.run(design)
    assert result.fos.static_bound == pytest.approx(
        path_oracle.static_bound(path_oracle.model_of(design)), rel=1e-5
    )
    assert result.fos.limit <= result.fos.static_bound


@cache
def in_components() -> Ravelling:
    """Of a bench in several components."""
    scene = cut(sk.load(populations.bench(27)))
    return ravel(scene.assembly, scene_loads(scene), joint_strength(scene.strengths), ranged=False)


@pytest.mark.slow
@pytest.mark.parametrize(("locked", "known"), [(False, False), (True, True)])
def test_a_component_whose_bound_was_not_found_leaves_none_of_all(locked, known) -> None:
    """That of the others holds those alone; a component that is locked at any friction takes nothing away."""
    found = in_components()
    first, *others = found.parts
    assert first.limit.factor is not None
    without = replace(first, limit=replace(first.limit, static_bound=None, locked=locked))
    least = min(part.limit.static_bound for part in others if part.limit.static_bound is not None)
    assert replace(found, parts=(without, *others)).static_bound == (least if known else None)


def test_the_bound_of_blocks_that_fail_together_is_the_least() -> None:
    """One of two components is locked in a slot at any friction, the other is not."""
    result = sk.run(populations.bench(34))
    assert result.fos.static_bound == pytest.approx(14.026, rel=1e-4)


def test_blocks_locked_by_dilation_are_held_against_no_bound() -> None:
    result = sk.run(populations.bench(54))
    assert result.fos.limit is not None
    assert result.fos.static_bound is None
    assert "upper bound: not found" in str(result.sheet)


def test_goodman_and_bray_and_the_bound_of_dilating_joints() -> None:
    """cases.json 5a: 19 % between them; the table has 16 rows, P of column 10 is 2826.71 kN at full strength."""
    result = result_of("goodman-bray")
    assert result.fos.static_bound == pytest.approx(1.19089, abs=1e-4)
    rows = result.findings.table
    assert [row["mode_preie"] for row in rows] == ["slide"] * 3 + ["topple"] * 10 + ["stable"] * 3
    assert [row["mode"] for row in rows] == [row["mode_preie"] for row in rows]
    assert rows[9]["P_kn"] == pytest.approx(2826.71, rel=1e-3)


def test_meshes_that_are_inside_out_or_cross_themselves(tmp_path, monkeypatch) -> None:
    """An inside-out cube is turned; pairs that the geometry could not intersect are named."""
    from slopekit.geometry.solids import solids

    slab = trimesh.creation.box([9, 9, 2], trimesh.transformations.translation_matrix([0, 0, -1]))
    cube = trimesh.creation.box([1, 1, 1], trimesh.transformations.translation_matrix([0, 0, 0.5]))
    cube.invert()
    slab.export(tmp_path / "slab.obj")
    cube.export(tmp_path / "cube.obj")
    (tmp_path / "c.yaml").write_text(
        "slopekit: 1\nkind: blocks\nblocks: {slab: {mesh: slab.obj, fixed: true}, C: {mesh: cube.obj}}\n"
        "strength: {j: {c: 0, phi: 30}}\nrock: {unit_weight: 25}\n"
    )
    result = sk.run(tmp_path / "c.yaml")
    assert result.geometry.volume_m3 == pytest.approx(1.0)
    assert result.status == "no_driving_force"

    whole = solids.mesh_assembly
    monkeypatch.setattr(
        solids, "mesh_assembly", lambda *given: replace(whole(*given), unchecked=np.array([[0, 1]]))
    )
    again = {notice.code: notice.message for notice in sk.run(tmp_path / "c.yaml").warnings}
    assert "slab/C" in again["W334"]


def test_the_papers_criterion_for_many_blocks() -> None:
    """Even slip: every block of a low stack is detached where it slides, tan φ / tan β."""
    stack = {f"B{k}": box(0, k, 30, 1) for k in range(3)}
    result = sk.run(on_incline(stack, 30, 35, analysis={"criterion": "all-pairs"}))
    expected = math.tan(math.radians(35)) / math.tan(math.radians(30))
    found = result.fos.all_pairs_failed
    assert result.all_pairs is not None
    assert found == pytest.approx(expected, rel=2e-3)
    assert result.all_pairs.bracket[1] == pytest.approx(expected, rel=2e-3)


def test_water_drains_from_joints_that_a_block_has_left() -> None:
    """Once B1 has gone nothing pushes B2 back: tan φ / tan β of a dry block."""
    design = on_incline({"B1": box(0, 0, 6, 1), "B2": box(6, 0, 6, 1)}, 20, 22)
    design["water"] = {"pressures": {"B1/B2": 12}}
    design["analysis"] = {"mechanisms": 2}
    second = sk.run(design).mechanisms[1]
    assert second.fos == pytest.approx(
        math.tan(math.radians(22)) / math.tan(math.radians(20)), rel=1e-5
    )


@pytest.mark.parametrize("phi", [0, 1])
def test_nothing_stands_on_an_incline_without_strength(phi) -> None:
    """c = φ = 0: no number, and surely not "stands"; with 1° the textbook's number."""
    result = sk.run(on_incline({"B": box(0, 0, 2, 1)}, 30, phi))
    if phi:
        assert result.fos.limit == pytest.approx(
            math.tan(math.radians(1)) / math.tan(math.radians(30)), rel=1e-5
        )
    else:
        assert (
            result.status == "slides"
        )  # strength would hold it: "falls" is for what no strength holds
        assert result.fos.limit is None
        assert "W308" in [notice.code for notice in result.warnings]


@pytest.mark.parametrize("c", [0, 1, 15, 25])
def test_cohesion_does_not_keep_a_block_from_tipping(c) -> None:
    """Joints carry no tension: beyond 45° a square block tips whatever its cohesion."""
    assert sk.run(on_incline({"B": SQUARE}, 45.1, 60, c=c)).status == "topples"


def test_displacements_at_full_strength_are_those_of_the_block_alone() -> None:
    """The same block as kind plane and as one of two polygons; the law is followed in steps there, at once here."""
    both = {"slopekit": 1, "strength": {"joint": {"c": 20, "phi": 30}}, "rock": {"unit_weight": 25}}
    plane = sk.run(
        both
        | {
            "kind": "plane",
            "slope": {"face": "60/090", "height": "12 m", "upper": "0/090"},
            "joints": {"J1": {"plane": "35/090", "strength": "joint"}},
        }
    )
    outline = np.asarray(plane.geometry.outline_m)
    back, top = outline[-1].tolist()
    blocks = sk.run(
        both
        | {
            "kind": "blocks",
            "interfaces": {"default": "joint"},
            "blocks": {
                "base": {
                    "polygon": [[-40, -10], [5, -10], [0, 0], [back, top], [-40, top]],
                    "fixed": True,
                },
                "B1": {"polygon": outline.tolist()},
            },
        }
    )
    one, many = plane.displacements.at_factor_one, blocks.displacements.at_factor_one
    assert one is not None
    assert many is not None
    assert many.block == "B1"
    np.testing.assert_allclose(
        many.movement.displacement[[0, 2]], one.movement.displacement[[0, 2]], rtol=5e-3
    )
    np.testing.assert_allclose(many.movement.rotation[1], one.movement.rotation[1], rtol=1e-6)
    np.testing.assert_array_equal(blocks.scene.displacement[1], many.movement.vector())
    fails = sk.run(
        both
        | {
            "kind": "blocks",
            "interfaces": {"default": "joint"},
            "strength": {"joint": {"c": 2, "phi": 20}},
            "blocks": {
                "base": {
                    "polygon": [[-40, -10], [5, -10], [0, 0], [back, top], [-40, top]],
                    "fixed": True,
                },
                "B1": {"polygon": outline.tolist()},
            },
        }
    )
    assert fails.fos.limit < 1.0
    assert (fails.displacements.at_factor_one, fails.scene.displacement) == (None, None)


def test_a_wall_has_its_limit_state_or_says_that_its_factor_is_a_last_rest() -> None:
    """Wall 261 has the limit of an independent history of its path; wall 44 was last at rest, and says so."""
    result = sk.run(populations.wall(261))
    assert (result.status, result.fos.limit) == ("topples", pytest.approx(0.0821181, rel=1e-5))
    assert "DISAGREE" not in str(result)
    assert "W317" not in [notice.code for notice in result.warnings]  # a limit state, exact
    result = sk.run(populations.wall(44))
    assert result.fos.limit == pytest.approx(0.2325, rel=1e-3)
    assert [notice.code for notice in result.warnings].count("W317") == 1


@pytest.mark.slow
def test_a_last_rest_whose_mechanism_is_too_large_has_no_range() -> None:
    """The rest and where the blocks run are 8e-5 apart: no range for other load paths, which is not known."""
    result = sk.run(benches.bench(1.9, 5.0))
    assert result.fos.limit is not None
    assert (result.fos.lowest, result.fos.highest) == (None, None)
    assert "none  range for other load paths and locked-in stresses: not found" in str(result)


def test_a_quick_factor_agrees_with_nothing_that_the_result_does_not() -> None:
    """Columns at their last rest, and no closed form: a sweep called them `agree`, the result DISAGREE."""
    design = sk.load(populations.section(804))
    result, quick = sk.run(design), kind_of(design).factors(design)
    assert result.fos.closed_form is None
    assert quick.limit == pytest.approx(result.fos.limit, rel=1e-6)
    assert (result.agree, quick.agree) == (False, False)
    assert re.search(r"fails at [\d.]+, [\d.e-]+ % higher", " ".join(str(result.sheet).split()))


def test_a_tolerance_larger_than_the_blocks_is_named() -> None:
    with pytest.raises(sk.GeometryError) as caught:
        sk.run(path_of("blocks"), set={"contact_tolerance": "10 m"})
    assert set(caught.value.codes) == {"E227"}
    assert (
        caught.value.faults[0].advice
        == "Up to 100 m² count as none: the contact tolerance is 10 m."
    )
