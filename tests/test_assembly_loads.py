"""Loads on many blocks, added up by hand: each force at its place, each pressure on both sides of its contact."""

import math

import numpy as np
import pytest

import slopekit as sk
from slopekit.design.templates import path_of
from slopekit.kinds import cut
from slopekit.kinds.assemblies.many_blocks_scene import last_block_left, scene_loads
from slopekit.loads import BlockLoad, PointForce, assembly_loads, drained, without_anchors_of

BLOCKS = {
    "base": {"polygon": [[-9, -1], [9, -1], [9, 0], [-9, 0]], "fixed": True},
    "A": {"polygon": [[0, 0], [2, 0], [2, 3], [0, 3]]},
    "B": {"polygon": [[2, 0], [5, 0], [5, 2], [2, 2]]},
}
DESIGN = {
    "slopekit": 1,
    "kind": "blocks",
    "blocks": BLOCKS,
    "strength": {"j": {"c": 0, "phi": 60}},
    "rock": {"unit_weight": 25},
}


@pytest.fixture
def scene():
    return cut(sk.load(DESIGN))


def sides(scene) -> np.ndarray:
    """Pressures by contact: 4 kPa below A, 6 below B, 8 between them."""
    names = [(scene.names[a], scene.names[b]) for a, b in zip(*pair_of(scene), strict=True)]
    known = {
        frozenset(("base", "A")): 4.0,
        frozenset(("base", "B")): 6.0,
        frozenset(("A", "B")): 8.0,
    }
    return np.array([known[frozenset(pair)] for pair in names])


def pair_of(scene):
    return scene.assembly.patches.plus, scene.assembly.patches.minus


def test_every_load_at_its_place(scene) -> None:
    """A: 3 m² at its height of 1.5 m, B: 2 m² of the 2 m that they share; moments about y are z Fx - x Fz."""
    push = PointForce(np.array([-7.0, 0.0, -5.0]), np.array([2.0, 0.0, 2.5]))
    found = assembly_loads(
        scene.assembly,
        scene.unit_weights,
        np.array([0.1, 0.0, 0.0]),
        sides(scene),
        (BlockLoad("force 1", 1, push),),
    )
    a, b = 150.0, 150.0  # weights
    assert found.weights[1:] == pytest.approx([a, b])
    # the water between them pushes A west and B east over the 2 m that they share
    assert found.forces[1] == pytest.approx([0.1 * a - 16.0 - 7.0, 0.0, -a + 8.0 - 5.0])
    assert found.forces[2] == pytest.approx([0.1 * b + 16.0, 0.0, -b + 18.0])
    # about A's centroid (1, 1.5): water between at z = 1, the push at (2, 2.5); uplift is even
    assert found.moments[1, 1] == pytest.approx(-0.5 * -16.0 + (1.0 * -7.0 - 1.0 * -5.0))
    assert found.moments[2, 1] == pytest.approx(0.0, abs=1e-12)


def test_uplift_on_part_of_a_base_turns_its_block() -> None:
    """A block that overhangs: 1 of its 3 m rests on the base."""
    low = {
        "base": {"polygon": [[-9, -1], [1, -1], [1, 0], [-9, 0]], "fixed": True},
        "A": {"polygon": [[0, 0], [3, 0], [3, 1], [0, 1]]},
    }
    scene = cut(sk.load(DESIGN | {"blocks": low}))
    found = assembly_loads(scene.assembly, scene.unit_weights, np.zeros(3), np.array([5.0]))
    assert found.forces[1] == pytest.approx([0.0, 0.0, -75.0 + 5.0])
    assert found.moments[1, 1] == pytest.approx(-(0.5 - 1.5) * 5.0)
    dry = drained(scene.assembly, found, np.array([True]))
    assert dry.forces[1] == pytest.approx([0.0, 0.0, -75.0])
    assert dry.moments[1] == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)


def test_water_drains_from_the_contacts_that_are_named(scene) -> None:
    """The same loads as if there had been none there."""
    wet, between = sides(scene), sides(scene) == 8.0
    whole = assembly_loads(scene.assembly, scene.unit_weights, np.zeros(3), wet)
    found = drained(scene.assembly, whole, between)
    dry = assembly_loads(
        scene.assembly, scene.unit_weights, np.zeros(3), np.where(between, 0.0, wet)
    )
    assert found.forces == pytest.approx(dry.forces)
    assert found.moments == pytest.approx(dry.moments, abs=1e-9)
    assert found.water == pytest.approx(dry.water)


@pytest.mark.parametrize(("part", "status"), [(0.998, "slides"), (1.002, "topples")])
def test_a_block_tips_under_a_push_at_its_top(part, status) -> None:
    """H h = W b / 2: just below it slides at tan φ W / H, just above no strength holds it."""
    wide, high = 1.0, 2.0
    weight = 25.0 * wide * high
    push = part * weight * wide / 2.0 / high
    block = {"base": BLOCKS["base"], "A": {"polygon": [[0, 0], [wide, 0], [wide, high], [0, high]]}}
    force = {"force": [-push, 0, 0], "at": [wide / 2.0, 0, high], "block": "A"}
    result = sk.run(DESIGN | {"blocks": block, "loads": {"forces": [force]}})
    assert result.status == status
    if status == "slides":
        assert result.fos.limit == pytest.approx(
            math.tan(math.radians(60.0)) * weight / push, rel=1e-4
        )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("loads", "place"),
    [
        (
            "support:\n  bolts:\n    - {force: 10, toward: 000/05, head: [0, 1.3, 3]}\n"
            "    - {force: 10, toward: 000/05, head: [500, 0, 3]}\n",
            ":6:7  - {force: 10",
        ),
        (
            "loads:\n  forces:\n    - {force: [0, 9, 0], at: [500, 0, 3]}\n",
            ":5:7  - {force: [0, 9, 0]",
        ),
    ],
)
def test_a_load_that_meets_no_block_names_its_line(loads, place, tmp_path) -> None:
    """`solve` refuses the design as `run` does, whatever the value; a sweep ends as bad input, not as no block."""
    path = tmp_path / "bench.yaml"
    bench = (
        "slope: {face: 70/180, height: 6, upper: 0/180, length: 8, depth: 6}\n"
        "sets: {S1: {plane: 30/175, spacing: 3}, S2: {plane: 85/265, spacing: 4}, S3: {plane: 75/350, spacing: 4}}\n"
        "strength: {joint: {c: 0, phi: 40}}\nrock: {unit_weight: 26}\n"
    )
    path.write_text(f"slopekit: 1\nkind: bench\n{loads}{bench}")
    with pytest.raises(sk.DesignError) as of_run:
        sk.run(path)
    *_, fault = of_run.value.faults
    assert fault.code == "E250"
    assert fault.where.startswith(f"bench.yaml{place}")
    with pytest.raises(sk.DesignError) as of_solve:
        sk.solve(sk.load(path), "strength.joint.phi=30:50", fos=1.5)
    assert of_solve.value.faults == of_run.value.faults
    assert sk.sweep(sk.load(path), {"strength.joint.phi": [30, 40]}).exit_code == 2
    assert sk.tornado(sk.load(path)).exit_code == 2


STACK = {
    "slopekit": 1,
    "kind": "blocks",
    "strength": {"joint": {"c": 0, "phi": 35}},
    "rock": {"unit_weight": 25},
    "blocks": {
        "base": {"polygon": [[-2, 0], [10, 0], [10, -2], [-2, -2]], "fixed": True},
        "A": {"polygon": [[0, 0], [4, 0], [4, 2], [0, 2]]},
        "B": {"polygon": [[0, 2], [4, 2], [4, 4], [0, 4]]},
    },
    "loads": {"seismic": {"k": 0.2, "toward": 90}},
}


def stacked(length: float, acts: str = "active"):
    bolt = {
        "force": 200,
        "toward": "090/90",
        "head": [2, 0, 4],
        "length": length,
        "acts": acts,
        "block": "B",
    }
    return sk.load(STACK | {"support": {"bolts": [bolt]}})


def test_an_anchor_between_two_blocks_holds_neither_to_the_rock() -> None:
    """Both slide at tan φ / k whatever ties them to each other; anchored in rock, 200 kN more lie on 400 kN."""
    tan = math.tan(math.radians(35.0))
    tied, held = sk.run(stacked(3.0)), sk.run(stacked(5.0))
    assert tied.fos.limit == pytest.approx(tan / 0.2, rel=1e-9)
    assert held.fos.limit == pytest.approx(1.5 * tan / 0.2, rel=1e-9)
    with pytest.raises(sk.DesignError, match=r"E212 bolt 1 is 1\.5 m long and ends in B"):
        sk.run(stacked(1.5))


def test_an_anchor_goes_with_the_block_at_either_end() -> None:
    """What is left has the loads that it has without the bolt, of its weight and the earthquake alone."""
    tied, bare = cut(stacked(3.0)), cut(sk.load(STACK))
    loads, own = scene_loads(tied), scene_loads(bare)
    assert loads.forces[1:, 2] == pytest.approx([-200.0 + 200.0, -200.0 - 200.0])
    for gone in (1, 2):
        left, name = without_anchors_of(tied.assembly, loads, np.arange(3) == gone), 3 - gone
        assert left.forces[name] == pytest.approx(own.forces[name])
        assert left.moments[name] == pytest.approx(own.moments[name], abs=1e-9)
        assert left.live[0][name] == pytest.approx(own.live[0][name])
        assert not left.pushes
        assert not tied.acting.without_blocks(np.arange(3) == gone).pushes
    assert len(tied.acting.without_blocks(np.zeros(3, dtype=bool)).pushes) == 2
    assert without_anchors_of(tied.assembly, loads, np.zeros(3, dtype=bool)) is loads


def test_a_surcharge_comes_after_the_water_of_a_pond() -> None:
    """1 m of water lifts A by 2 γ_w and B by 3 γ_w, as weight does; 10 kPa on A come after."""
    scene = cut(sk.load(DESIGN | {"water": {"pond": 1}, "loads": {"surcharge": {"A": 10}}}))
    loads = scene_loads(scene)
    assert sorted(load.name for load in loads.pushes) == ["surcharge", "water", "water"]
    live, turning = loads.live
    assert live[1:] == pytest.approx(np.array([[0.0, 0.0, -20.0], [0.0, 0.0, 0.0]]))
    assert turning[1:] == pytest.approx(0.0, abs=1e-9)
    dry = scene_loads(cut(sk.load(DESIGN | {"loads": {"surcharge": {"A": 10}}})))
    lifted = np.array([[0.0, 0.0, 2.0 * 9.81], [0.0, 0.0, 3.0 * 9.81]])
    assert (loads.forces - dry.forces)[1:] == pytest.approx(lifted, abs=1e-9)


WALL = {
    "slopekit": 1,
    "kind": "blocks",
    "strength": {"joint": {"c": 0, "phi": 35}},
    "rock": {"unit_weight": 25},
    "section": {"thickness": "2 m"},
    "blocks": STACK["blocks"],
    "loads": STACK["loads"],
}


@pytest.mark.parametrize(
    ("bolt", "ends"),
    [
        (
            {"head": [4, 0, 1], "toward": "270/00", "length": 10, "block": "A"},
            "comes out of A and ends in the air",
        ),
        (
            {"head": [4, 0, 3], "toward": "270/10", "length": 9, "block": "B"},
            "comes out of B and ends in the air",
        ),
        (
            {"head": [2, 0, 4], "toward": "090/80", "length": 7, "block": "B"},
            "",
        ),  # through the base, into rock
        ({"head": [4, 0, 1], "toward": "270/00", "block": "A"}, ""),  # rock holds it
    ],
)
@pytest.mark.parametrize("acts", ["active", "passive"])
def test_a_bolt_that_comes_out_into_the_air_is_refused(bolt, ends, acts) -> None:
    """In a section and in space: a bolt through a wall held it as if there were rock behind."""
    bolts = {"support": {"bolts": [{"force": 20, "acts": acts} | bolt]}}
    if ends:
        with pytest.raises(sk.DesignError, match=f"E211 bolt 1 {ends}"):
            sk.run(WALL | bolts)
    else:
        cut(sk.load(WALL | bolts))


def test_the_last_block_of_a_line_in_space(scene) -> None:
    """Of the template's bench, block by block: out of the last one a line comes that its faces let pass."""
    bench = cut(sk.load(str(path_of("bench"))))
    rng = np.random.default_rng(4)
    assembly, seen = bench.assembly, set()
    for _ in range(20):
        block = int(rng.integers(len(assembly)))
        head = assembly.centroids[block]
        way = rng.normal(size=3)
        end = head + 300.0 * way / np.linalg.norm(way)
        last = last_block_left(bench, head, end)
        at = [k for k in range(len(assembly)) if leaves(assembly, k, head, end) is not None]
        assert last == max(at, key=lambda k: leaves(assembly, k, head, end))
        seen.add(bool(assembly.fixed[last]))
    assert last_block_left(bench, head, head + 1e-9) == -1
    assert seen == {True, False}


def leaves(assembly, block: int, head, end) -> float | None:
    """Where a line leaves a convex block, by its planes; None where it does not pass it."""
    corners = assembly.vertices[assembly.triangles[assembly.triangle_block == block]]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    gap, slope = ((corners[:, 0] - head) * normals).sum(axis=1), normals @ (end - head)
    at = gap / slope
    first, last = at[slope < 0.0].max(initial=-np.inf), at[slope > 0.0].min(initial=np.inf)
    return float(last) if first < last and last > 0.0 else None


@pytest.mark.parametrize(
    ("bolt", "misses"),
    [
        ({"head": [4, 0, 30], "toward": "270/00"}, True),
        ({"head": [9, 0, 30], "toward": "090/90"}, True),
        ({"head": [2, 0, 30], "toward": "090/90", "length": 10}, True),
        ({"head": [2, 0, 4], "toward": "090/-90"}, True),
        ({"head": [2, 0, 30], "toward": "090/90", "length": 50}, False),
        ({"head": [4, 0, 3], "toward": "270/45"}, False),
        ({"head": [4, 0, 4], "toward": "270/90"}, False),
    ],
)
def test_a_bolt_that_misses_its_block_is_refused(bolt, misses, tmp_path) -> None:
    """26 m above the block it is named for it added 7 % to its factor; in space as in a section."""
    bolts = {"support": {"bolts": [{"force": 20, "acts": "active", "block": "B"} | bolt]}}
    meshes = {
        name: box(one["polygon"], tmp_path / f"{name}.obj")
        | {key: one[key] for key in one if key == "fixed"}
        for name, one in STACK["blocks"].items()
    }
    for design in (STACK, STACK | {"blocks": meshes}):
        if misses:
            with pytest.raises(sk.DesignError, match="E211 bolt 1 misses B"):
                cut(sk.load(design | bolts))
        else:
            cut(sk.load(design | bolts))


def box(polygon, path) -> dict:
    """A block of a section as a mesh of its own, a metre to either side."""
    (x0, z0), (x1, z1) = np.min(polygon, axis=0), np.max(polygon, axis=0)
    corners = [(x, y, z) for x in (x0, x1) for y in (-1, 1) for z in (z0, z1)]
    faces = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
    lines = [f"v {x} {y} {z}" for x, y, z in corners] + [
        "f " + " ".join(map(str, face)) for face in faces
    ]
    path.write_text("\n".join(lines))
    return {"mesh": str(path)}


def test_what_goes_next_has_lost_the_anchor_of_what_went_before() -> None:
    """B goes at (W + T) tan 10° / (k W); A, which the anchor had lifted off its base, then at tan 35° / k."""
    bolt = {
        "force": 200,
        "toward": "090/90",
        "head": [2, 0, 4],
        "length": 3,
        "acts": "active",
        "block": "B",
    }
    found = sk.run(
        STACK
        | {
            "strength": {"joint": {"c": 0, "phi": 35}, "smooth": {"c": 0, "phi": 10}},
            "support": {"bolts": [bolt]},
            "interfaces": {"default": "joint", "A/B": "smooth"},
            "analysis": {"mechanisms": 2},
        }
    )
    first, then = (one.fos for one in found.mechanisms)
    assert first == pytest.approx(2.0 * math.tan(math.radians(10.0)) / 0.2, rel=1e-9)
    assert then == pytest.approx(math.tan(math.radians(35.0)) / 0.2, rel=1e-9)


@pytest.mark.parametrize("head", ["A", "B"])
def test_an_anchor_is_lost_by_a_block_that_touches_no_other(head) -> None:
    """A slides from under it at (k W + T) F = W tan 10°; B, which it had held, then at tan 35° / k, as it does bare."""
    bolt = {
        "force": 20,
        "toward": "090/00",
        "head": [0, 0, 1],
        "length": 7,
        "acts": "active",
        "block": "A",
    }
    bolt |= {} if head == "A" else {"toward": "270/00", "head": [10, 0, 1], "block": "B"}
    square = {
        name: {"polygon": [[x, 0], [x + 4, 0], [x + 4, 2], [x, 2]]}
        for name, x in (("A", 0), ("B", 6))
    }
    found = sk.run(
        DESIGN
        | {
            "blocks": {"base": {"polygon": [[-20, -1], [20, -1], [20, 0], [-20, 0]], "fixed": True}}
            | square,
            "strength": {"joint": {"c": 0, "phi": 35}, "smooth": {"c": 0, "phi": 10}},
            "interfaces": {"default": "joint", "base/A": "smooth"},
            "support": {"bolts": [bolt]},
            "loads": {"seismic": {"k": 0.2, "toward": 90}},
            "analysis": {"mechanisms": 2},
        }
    )
    first, then = (one.fos for one in found.mechanisms)
    assert first == pytest.approx(
        200.0 * math.tan(math.radians(10.0)) / (0.2 * 200.0 + 20.0), rel=1e-9
    )
    assert then == pytest.approx(math.tan(math.radians(35.0)) / 0.2, rel=1e-9)
