"""Passive bolts of many blocks: 0 <= T <= capacity / F along the bolt, as on one block.

Held against closed forms by hand, against one block's limit state, against active bolts that pull as much, and against
a linear program of its own.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import linprog, lsq_linear, nnls

import slopekit as sk
from benchmarks.wedge_paths import as_assembly, compared
from slopekit.core.errors import DesignError
from slopekit.geometry.patches import BEDROCK
from slopekit.kinds import cut
from slopekit.kinds.assemblies.many_blocks_scene import scene_loads
from slopekit.kinds.solver_inputs import joint_strength
from slopekit.kinds.wedge.design import wedge_design
from slopekit.loads import PassiveBolts
from slopekit.preie.many_blocks.blocks import limit_of_blocks
from slopekit.preie.many_blocks.blocks_limit import Basis, BlocksLimit
from slopekit.preie.one_block.flat_limit import forces_limit
from slopekit.preie.one_block.forces_limits import _linear_pieces, forces_limits
from slopekit.preie.one_block.pairs_limit import pairs_limit
from slopekit.preie.one_block.polygon_bed import elastic_bed
from slopekit.preie.programs.distance import Distance
from slopekit.preie.solvers.linear import non_negative_least_squares
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.system.components import whole_model
from slopekit.result import Result
from slopekit.studies.check import check
from tests.preie import path_oracle
from tests.preie.block_scenes import boxes_in_space, stack

DIP, WEIGHT = 30.0, 200.0  # blocks 4 m by 2 m, 25 kN/m³
ALONG, ACROSS = math.sin(math.radians(DIP)), math.cos(math.radians(DIP))
UP, IN = (
    [math.cos(math.radians(DIP)), math.sin(math.radians(DIP))],
    [ALONG, -ACROSS],
)  # the slope, and into it


def on_slope(corners) -> list[list[float]]:
    """Points (along the slope, above it) as x, z; the slope falls toward -x."""
    return [[x * UP[0] - z * IN[0], x * UP[1] - z * IN[1]] for x, z in corners]


def box(x: float, wide: float = 4.0, high: float = 2.0, above: float = 0.0) -> dict[str, Any]:
    low, top = above, above + high
    return {"polygon": on_slope([(x, low), (x + wide, low), (x + wide, top), (x, top)])}


def design(
    blocks: dict[str, Any], bolts: list[dict[str, Any]] = (), phi: float = 20.0, **more: Any
) -> dict[str, Any]:
    base = {
        "polygon": on_slope([(-3.0, -3.0), (20.0, -3.0), (20.0, 0.0), (-3.0, 0.0)]),
        "fixed": True,
    }
    passive = [{"acts": "passive", **bolt} for bolt in bolts]
    return {
        "slopekit": 1,
        "kind": "blocks",
        "blocks": {"base": base, **blocks},
        "strength": {"j": {"c": 0, "phi": phi}},
        "interfaces": {"default": "j"},
        "rock": {"unit_weight": 25},
        "support": {"bolts": passive},
        **more,
    }


def bolt(force: float, block: str = "A", steeper: float = 0.0, **more: Any) -> dict[str, Any]:
    """A bolt up the slope, or into it by so many degrees."""
    plunge = steeper - DIP
    toward = [90.0, plunge] if plunge <= 90.0 else [270.0, 180.0 - plunge]
    return {"force": force, "toward": toward, "block": block, **more}


def model_of(given: dict[str, Any]) -> AssemblyModel:
    scene = cut(sk.load(given))
    model = whole_model(scene.assembly, scene_loads(scene), joint_strength(scene.strengths))
    assert model is not None
    return model


def limit_of(given: dict[str, Any]) -> BlocksLimit:
    return limit_of_blocks(model_of(given))


def by_hand(capacity: float, steeper: float, phi: float = 20.0) -> float:
    """D F² - (N μ + T cos a) F - T sin a μ = 0 for a bolt into the slope at an angle, drawn out."""
    friction, a = math.tan(math.radians(phi)), math.radians(steeper)
    drives, b = WEIGHT * ALONG, WEIGHT * ACROSS * friction + capacity * math.cos(a)
    return (b + math.sqrt(b * b + 4.0 * drives * capacity * math.sin(a) * friction)) / (
        2.0 * drives
    )


# -- as part of the model ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("in_section", [True, False])
def test_a_bolt_shortens_by_the_motion_of_its_ends(in_section: bool) -> None:
    """d · (v of the head's block - v of the toe's), both at a point of its line; either end may be bedrock."""
    scene = (
        stack(3, 25.0, 4.0) if in_section else boxes_in_space((2, 1, 1), (2.0, 3.0, 1.0), 25.0, 0.3)
    )
    rng, blocks = np.random.default_rng(3), np.flatnonzero(~scene.fixed)
    head, toe = np.array([blocks[0], blocks[1], BEDROCK]), np.array([blocks[1], BEDROCK, blocks[0]])
    flat = np.array([1.0, 0.0, 1.0]) if in_section else np.ones(3)
    forces, points = rng.normal(size=(3, 3)) * flat, rng.normal(size=(3, 3)) * flat
    model = replace(scene, bolts=PassiveBolts(head, toe, forces, points)).model(30.0)
    velocity = rng.normal(size=model.load.shape)
    motion = np.zeros((len(scene) + 1, 6))  # the last is bedrock
    motion[np.ix_(model.moving, [0, 2, 4] if in_section else range(6))] = velocity
    centroids = np.append(scene.centroids, [[0.0, 0.0, 0.0]], axis=0)

    def of(ends: np.ndarray) -> np.ndarray:
        arms = (points - centroids[ends]) / model.length_scale
        return motion[ends, :3] + np.cross(motion[ends, 3:], arms)

    along = forces / np.sqrt((forces * forces).sum(axis=1))[:, None]
    _, slip = model.opening_and_slip(velocity)
    assert slip[model.bolted, 0] == pytest.approx(
        (along * (of(head) - of(toe))).sum(axis=1), abs=1e-12
    )
    assert not slip[model.bolted, 1:].any()
    capacity = model.cohesion[model.joint_pairs.stop :] * model.force_scale
    assert capacity == pytest.approx(np.sqrt((forces * forces).sum(axis=1)))


# -- one block --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("steeper", [0.0, 25.0, 60.0, -15.0])
@pytest.mark.parametrize("capacity", [1e-6, 30.0, 150.0, 5000.0])
def test_one_block_on_a_slope(capacity: float, steeper: float) -> None:
    """A quadratic by hand, to rounding; 5000 kN hold 25 times the weight."""
    if steeper < 0.0 and capacity > 1000.0:
        pytest.skip("it lifts the block")
    ends = {} if steeper < 0.0 else {"length": 50.0}  # else in the air: refused (E211)
    found = limit_of(
        design({"A": box(0.0)}, [bolt(capacity, steeper=steeper, head=middle(2.0), **ends)])
    )
    exact = by_hand(capacity, steeper)
    assert found.basis is Basis.LIMIT
    assert found.factor == pytest.approx(exact, rel=1e-11)
    assert found.lowest == pytest.approx(exact, rel=1e-6)
    assert found.static_bound is not None
    assert found.static_bound >= exact * (1.0 - 1e-9)


def middle(x: float, above: float = 0.0) -> list[float]:
    """A point of the slope, as a head."""
    (point,) = on_slope([(x, above)])
    return [point[0], 0.0, point[1]]


def test_the_papers_wedge_as_one_block_and_as_an_assembly() -> None:
    """1e-9: what the path settles to in space."""
    for force, toward in ((1e6, (0.0, 10.0)), (5e5, (20.0, 40.0)), (3e6, (340.0, -15.0))):
        wedge = {
            "dips": ("45/115", "45/245"),
            "bolts": [{"force": force, "toward": toward, "acts": "passive"}],
        }
        scene = cut(wedge_design(wedge)).scene_at(0)
        analysis = pairs_limit(scene.model)
        assert not analysis.moments_govern
        many = limit_of_blocks(as_assembly(scene), ranged=False)
        assert many.factor == pytest.approx(analysis.governing.factor, rel=1e-9)


@pytest.mark.slow
def test_random_wedges_with_passive_bolts() -> None:
    """The limit of a wedge on its exact polygons, and of one block of many (`benchmarks.wedge_paths`)."""
    rng = np.random.default_rng(4)
    off = [
        off
        for word, off in (compared(rng, passive=True) for _ in range(8))
        if not word.startswith("no factor")
    ]
    assert len(off) >= 6
    assert max(abs(each) for each in off) < 0.01
    assert min(abs(each) for each in off) < 1e-9


def test_a_bolt_square_to_the_movement() -> None:
    """It pulls anything from nothing to T / F: the range is what friction makes of that, by hand."""
    found = limit_of(
        design({"A": box(0.0)}, [bolt(60.0, steeper=90.0, head=middle(2.0), length=50.0)])
    )
    slides = math.tan(math.radians(20.0)) / math.tan(math.radians(DIP))
    held = by_hand(60.0, 90.0)
    assert found.lowest == pytest.approx(slides, rel=2e-5)  # how near an end of the range is found
    assert found.highest == pytest.approx(held, rel=2e-5)
    assert found.lowest <= found.factor <= found.highest


def test_a_bolt_that_is_pushed_in_adds_nothing() -> None:
    """W311; and it does not push."""
    given = design({"A": box(0.0)}, [bolt(60.0, steeper=180.0)])
    assert limit_of(given).factor == pytest.approx(
        limit_of(design({"A": box(0.0)})).factor, rel=1e-12
    )
    result = sk.run(given)
    assert "W311" in [notice.code for notice in result.warnings]
    assert pulls(result) == [0.0]


def pulls(result: Result) -> list[float]:
    arrows = result.limit_state.acting
    passive = ["passive" in arrows.names[k] for k in arrows.what.tolist()]
    return np.sqrt((arrows.force_kn[passive] ** 2).sum(axis=1)).tolist()


# -- several blocks ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("capacity", [10.0, 40.0, 100.0, 300.0])
def test_two_blocks_tied_by_a_bolt(capacity: float) -> None:
    """A smooth block below a rough one: it tears the bolt, or draws the other along; one that goes takes it away."""
    blocks = {"A": box(0.0), "B": box(5.0)}
    given = design(
        blocks,
        [bolt(capacity, head=middle(2.0, 1.0), length=5.0)],
        interfaces={"default": "j", "base/B": "rough"},
        strength={"j": {"c": 0, "phi": 20}, "rough": {"c": 0, "phi": 45}},
        analysis={"mechanisms": 2},
    )
    drives, smooth, rough = (
        WEIGHT * ALONG,
        WEIGHT * ACROSS * math.tan(math.radians(20.0)),
        WEIGHT * ACROSS,
    )
    torn, along = (smooth + capacity) / drives, (smooth + rough) / (2.0 * drives)
    result = sk.run(given)
    assert result.fos.limit == pytest.approx(min(torn, along), rel=1e-12)
    pulled = min(capacity / torn, drives - smooth / along)
    assert pulls(result) == pytest.approx([pulled, pulled], rel=1e-9)  # on both of its blocks
    ends = [mechanism.fos for mechanism in result.mechanisms]
    if torn < along:
        assert ends == pytest.approx([torn, rough / drives], rel=1e-12)
        assert result.findings.first.interfaces[-1].mode in ("pull", "slip")
        assert sum(one.share for one in result.findings.first.interfaces) == pytest.approx(
            1.0, rel=1e-9
        )
    else:
        assert len(ends) == 1


def test_a_bolt_whose_toe_has_gone() -> None:
    """A rough block is bolted to a smooth one above it, which slides first: then friction alone holds the rough one."""
    given = design(
        {"A": box(0.0), "B": box(5.0)},
        [bolt(100.0, head=middle(2.0, 1.0), length=5.0)],
        interfaces={"default": "j", "base/A": "rough"},
        analysis={"mechanisms": 2},
        strength={"j": {"c": 0, "phi": 20}, "rough": {"c": 0, "phi": 45}},
    )
    slopes = [math.tan(math.radians(phi)) / math.tan(math.radians(DIP)) for phi in (20.0, 45.0)]
    found = sk.run(given).mechanisms
    assert [one.blocks for one in found] == [("B",), ("A",)]
    assert [one.fos for one in found] == pytest.approx(slopes, rel=1e-11)


def test_a_stack_of_three() -> None:
    """Each joint carries what lies above it, with its bolts: the weakest of three by hand."""
    blocks = {"A": box(0.0), "B": box(0.0, above=2.0), "C": box(0.0, above=4.0)}
    for capacities in ((90.0, 10.0, 5.0), (5.0, 60.0, 1.0), (10.0, 10.0, 90.0)):
        bolts = [bolt(force, name) for force, name in zip(capacities, blocks, strict=True)]
        slides = math.tan(math.radians(20.0)) / math.tan(math.radians(DIP))
        exact = min(slides + sum(capacities[k:]) / ((3 - k) * WEIGHT * ALONG) for k in range(3))
        assert limit_of(design(blocks, bolts)).factor == pytest.approx(exact, rel=1e-11)


def test_blocks_that_hang_on_bolts() -> None:
    """Nothing but bolts holds them: F is what they pull over the weight, as on one block; without one a block falls."""
    w = math.tan(math.radians(20.0))
    outlines = {
        "left": [[-10, 0], [0, 0], [2 * w, 2], [2 * w, 4], [-10, 4]],
        "A": [[0, 0], [4, 0], [4 - 2 * w, 2], [2 * w, 2]],
        "middle": [[4, 0], [8, 0], [8 + 2 * w, 2], [8 + 2 * w, 4], [4 - 2 * w, 4], [4 - 2 * w, 2]],
        "B": [[8, 0], [12, 0], [12 - 2 * w, 2], [8 + 2 * w, 2]],
        "right": [[12, 0], [20, 0], [20, 4], [12 - 2 * w, 4], [12 - 2 * w, 2]],
    }
    weight = 25.0 * 2.0 * (4.0 - 2.0 * w)

    def roof(*bolts: tuple[str, float, float]) -> Result:
        hung = [
            {"force": force, "toward": "000/-90", "block": name, "head": [x, 0.0, 1.0]}
            for name, force, x in bolts
        ]
        given = design({}, hung, phi=30.0, analysis={"mechanisms": 2})
        given["blocks"] = {
            name: {"polygon": outline} | ({"fixed": True} if name.islower() else {})
            for name, outline in outlines.items()
        }
        return sk.run(given)

    both = roof(("A", 200.0, 2.0), ("B", 300.0, 10.0))
    assert [one.fos for one in both.mechanisms] == pytest.approx(
        [200.0 / weight, 300.0 / weight], rel=1e-12
    )
    assert roof(
        ("A", 100.0, 1.5), ("A", 100.0, 2.5), ("B", 300.0, 10.0)
    ).fos.limit == pytest.approx(200.0 / weight)
    one = roof(("A", 200.0, 2.0))
    assert one.status == "falls"
    assert [found.blocks for found in one.mechanisms] == [("B",), ("A",)]
    # at full strength the bolt is drawn out by a millimetre times its share, and the joints open
    assert both.displacements.at_factor_one is not None
    down = both.displacements.at_factor_one.block_movements[[1, 3], 2]
    assert down == pytest.approx([-1e-3 * weight / 200.0, -1e-3 * weight / 300.0], rel=1e-9)


#: Blocks that lean on each other, push and turn, with bolts of several kinds.
ASSEMBLIES: dict[str, dict[str, Any]] = {
    "row": design(
        {"A": box(0.0, 2.0, 3.0), "B": box(2.0, 3.0, 2.0), "C": box(5.0, 2.0, 4.0)},
        [
            bolt(30.0, "A", 20.0),
            bolt(60.0, "C", 40.0, head=middle(6.0, 3.0)),
            bolt(20.0, "B", 170.0),
        ],
    ),
    "bond": design(
        {"A": box(0.0), "B": box(4.0), "C": box(0.0, 2.0, above=2.0), "D": box(2.0, above=2.0)},
        [
            bolt(30.0, "D", 30.0, head=middle(4.0, 3.0), length=3.0),
            bolt(50.0, "A", 10.0),
            bolt(40.0, "C"),
        ],
    ),
    "thin": design(
        {"A": box(0.0, 1.0, 4.0), "B": box(1.0, 1.0, 5.0), "C": box(2.0, 1.0, 3.0)},
        [bolt(60.0, "A", 10.0, head=middle(0.5, 3.5)), bolt(6.0, "B", 0.0, head=middle(1.5, 4.5))],
        phi=35.0,
    ),
}


@pytest.fixture(scope="module", params=ASSEMBLIES)
def assembly(request) -> tuple[dict[str, Any], AssemblyModel, BlocksLimit]:
    given = ASSEMBLIES[request.param]
    model = model_of(given)
    return given, model, limit_of_blocks(model)


def with_bolts(given: dict[str, Any], change) -> dict[str, Any]:
    changed = [new for one in given["support"]["bolts"] for new in change(dict(one))]
    return {**given, "support": {"bolts": changed}}


def test_bolts_stay_within_their_range(assembly) -> None:
    """0 <= T <= capacity / F; forces that balance; F between its ends and below the static bound."""
    _, model, found = assembly
    assert found.basis is Basis.LIMIT
    pulled = found.friction[model.bolted, 0]
    most = model.cohesion[model.joint_pairs.stop :] / found.factor
    assert (pulled >= -1e-12).all()
    assert (pulled <= most * (1.0 + 1e-9)).all()
    assert np.abs(model.unbalanced(found.normal_force, found.friction)).max() < 1e-10
    assert found.lowest <= found.factor <= found.static_bound
    assert found.factor <= found.highest <= found.static_bound * (1.0 + 1e-9)


def test_the_strength_divided_by_k(assembly) -> None:
    """c, tan φ and capacities: k F(strength / k) = F, by construction."""
    _, model, found = assembly
    for k in (0.4, found.factor, 3.0):
        weaker = replace(model, tan_friction=model.tan_friction / k, cohesion=model.cohesion / k)
        assert limit_of_blocks(weaker, ranged=False).factor * k == pytest.approx(
            found.factor, rel=1e-10
        )


def test_one_bolt_or_two_of_half_its_capacity(assembly) -> None:
    given, _, found = assembly
    halved = with_bolts(given, lambda one: [one | {"force": 0.5 * one["force"]}] * 2)
    assert limit_of(halved).factor == pytest.approx(found.factor, rel=1e-10)


def test_other_orders_of_blocks_and_bolts(assembly) -> None:
    given, _, found = assembly
    turned = {
        **given,
        "blocks": dict(reversed(given["blocks"].items())),
        "support": {"bolts": given["support"]["bolts"][::-1]},
    }
    assert limit_of(turned).factor == pytest.approx(found.factor, rel=1e-9)


def test_in_the_mirror(assembly) -> None:
    given, _, found = assembly

    def seen(one: dict[str, Any]) -> list[dict[str, Any]]:
        one["toward"] = [360.0 - one["toward"][0], one["toward"][1]]
        if "head" in one:
            one["head"] = [-one["head"][0], *one["head"][1:]]
        return [one]

    blocks = {
        name: one | {"polygon": [[-x, z] for x, z in one["polygon"]]}
        for name, one in given["blocks"].items()
    }
    assert limit_of(with_bolts({**given, "blocks": blocks}, seen)).factor == pytest.approx(
        found.factor, rel=1e-9
    )


def test_weak_bolts_are_none(assembly) -> None:
    given, _, found = assembly
    if given is ASSEMBLIES["thin"]:
        pytest.skip("without bolts the columns topple, and their motion does not settle")
    none = limit_of({**given, "support": {"bolts": []}}).factor
    weak = limit_of(with_bolts(given, lambda one: [one | {"force": 1e-7 * one["force"]}])).factor
    assert weak == pytest.approx(none, rel=1e-6)
    assert found.factor > none * 1.02


def test_active_bolts_that_pull_as_much(assembly) -> None:
    """At the limit a passive bolt is a load of what it pulls there: the same forces, the same factor."""
    given, model, found = assembly
    pulled = iter((found.friction[model.bolted, 0] * model.force_scale).tolist())

    def active(one: dict[str, Any]) -> list[dict[str, Any]]:
        force = next(pulled)
        toe = one.pop("length", None)
        if toe is not None:
            pytest.skip("an active bolt acts on the block of its head alone")
        return [one | {"force": force, "acts": "active"}] if force > 1e-9 else []

    assert limit_of(with_bolts(given, active)).factor == pytest.approx(found.factor, rel=1e-6)


def test_the_static_bound_against_a_linear_program(assembly) -> None:
    """The smallest λ with N >= 0, |T| <= λ μ ΣN and 0 <= T <= λ capacity on bolts, bisected; HiGHS on dense arrays."""
    _, model, found = assembly
    pairs, groups = len(model.control_area), len(model.group_contact)
    bolts = len(model.bolts)
    statics = model.statics.toarray()
    statics = np.delete(
        statics, np.s_[pairs - bolts : pairs], axis=1
    )  # node pairs that stand for bolts carry nothing
    pairs -= bolts
    sums = np.zeros((groups, pairs))
    sums[model.group_of_pair[:pairs], np.arange(pairs)] = 1.0
    capacity = model.cohesion[pairs:]

    def stands(reduction: float) -> bool:
        pressed = reduction * model.tan_friction[:, None] * sums
        joints = groups - bolts
        pick = np.eye(groups)
        cone = np.block([[-pressed[:joints], sign * pick[:joints]] for sign in (1.0, -1.0)])
        ends = (
            [(0.0, None)] * pairs
            + [(None, None)] * joints
            + [(0.0, reduction * most) for most in capacity]
        )
        found = linprog(
            np.zeros(pairs + groups), cone, np.zeros(len(cone)), statics, -model.load.ravel(), ends
        )
        return found.status == 0

    low, high = 0.1 / found.static_bound, 3.0 / found.static_bound
    assert stands(high)
    assert not stands(low)
    while high / low > 1.0 + 1e-7:
        middle_ = math.sqrt(low * high)
        low, high = (low, middle_) if stands(middle_) else (middle_, high)
    assert found.static_bound == pytest.approx(1.0 / high, rel=2e-6)


def test_an_incremental_history(assembly) -> None:
    """Slip and pull that stay what they were, strength lowered slowly (`path_oracle.history`): the same limit, 1e-6.

    In the thin row forces may be locked in: its mechanism alone has factors from 1.438 to 1.552.
    """
    _, model, found = assembly
    told = path_oracle.history(model, 2.0 / found.static_bound)
    assert told.end == "settled"
    assert found.factor == pytest.approx(told.factor, rel=1e-6)


def test_the_slope_of_the_range(assembly) -> None:
    """How the distance of forces from a mechanism's changes with λ, beyond an end of its range: central differences."""
    _, model, found = assembly
    away = Distance(model, found.velocity.ravel(), found.bond, 1.0 / found.factor)
    for at in (1.2 / found.lowest, 0.8 / found.highest):
        ahead, behind = (away.evaluate(at * (1.0 + step)).distance for step in (1e-4, -1e-4))
        there = away.evaluate(at)
        assert there.distance > 1e-4
        assert there.slope == pytest.approx((ahead - behind) / (2e-4 * at), rel=1e-3)


def test_joints_that_dilate_by_all_their_friction_have_the_static_bound() -> None:
    """Normality: the limit is the bound, with bolts as without."""
    given = ASSEMBLIES["row"]
    given = {**given, "strength": {"j": {"c": 0, "phi": 20, "dilation": 20}}}
    found = limit_of(given)
    assert found.factor == pytest.approx(found.static_bound, rel=1e-4)


# -- around it --------------------------------------------------------------------------------------------------------


def test_the_papers_criterion_and_check() -> None:
    """All pairs failed lies below the limit; check finds forces, bolts and other strengths in order."""
    result = sk.run({**ASSEMBLIES["row"], "analysis": {"criterion": "all-pairs"}})
    assert 0.5 * result.fos.limit < result.fos.all_pairs_failed <= result.fos.limit * (1.0 + 1e-9)
    checked = check(sk.load(ASSEMBLIES["row"]))
    assert not [finding for finding in checked.findings if finding.met is False]


@pytest.mark.parametrize("ways", [[180.0], [0.0], [0.0, 180.0]])
def test_the_papers_criterion_by_hand(ways: list[float]) -> None:
    """The joint slips at F = N μ / (its part of D); springs side by side: k_t A, and T / 1 mm if drawn out. 1e-4."""
    capacity, shear = 150.0, 1e5
    given = design(
        {"A": box(0.0)},
        [bolt(capacity, steeper=way, head=middle(2.0)) for way in ways],
        strength={"j": {"c": 0, "phi": 20, "stiffness": {"normal": 1e7, "shear": shear}}},
        analysis={"criterion": "all-pairs"},
    )
    joint, pull = shear * 4.0, capacity / 1e-3 if 0.0 in ways else 0.0
    exact = ACROSS * math.tan(math.radians(20.0)) / ALONG * (joint + pull) / joint
    assert sk.run(given).fos.all_pairs_failed == pytest.approx(exact, rel=2e-4)


def test_solve_for_a_capacity() -> None:
    """F = (N μ + T) / D by hand."""
    given = design({"A": box(0.0)}, [bolt(50.0)])
    found = sk.solve(sk.load(given), "support.bolts.0.force", fos=1.5)
    exact = 1.5 * WEIGHT * ALONG - WEIGHT * ACROSS * math.tan(math.radians(20.0))
    assert found.answer is not None
    assert found.answer.value == pytest.approx(exact, rel=1e-6)


def test_solve_for_an_earthquake() -> None:
    """The path in the load at λ = 1 / 1.2: W (sin + k cos) = λ (W (cos - k sin) μ + T), by hand."""
    given = design({"A": box(0.0)}, [bolt(80.0)], loads={"seismic": {"k": 0.1, "toward": 270}})
    found = sk.solve(sk.load(given), "loads.seismic.k", fos=1.2)
    friction = math.tan(math.radians(20.0)) / 1.2
    exact = (ACROSS * friction + 80.0 / 1.2 / WEIGHT - ALONG) / (ACROSS + ALONG * friction)
    assert found.answer is not None
    assert found.answer.value == pytest.approx(exact, rel=1e-9)


def test_bolts_alone_hold_smooth_blocks() -> None:
    """Without friction and cohesion F = T / D."""
    given = design({"A": box(0.0), "B": box(5.0)}, [bolt(150.0), bolt(120.0, "B")], phi=0.0)
    assert limit_of(given).factor == pytest.approx(120.0 / (WEIGHT * ALONG), rel=1e-11)


def test_bolts_that_hold_nothing_are_refused() -> None:
    """All faults at once: too short for its block, on bedrock, in no block."""
    given = design(
        {"A": box(0.0), "B": box(5.0)},
        [bolt(50.0, head=middle(2.0, 1.0), length=1.0), bolt(9.0, "C")],
    )
    with pytest.raises(DesignError) as caught:
        sk.run(given)
    assert caught.value.codes == ("E250",)
    given["support"]["bolts"].pop()
    with pytest.raises(DesignError, match="1 m long and ends in A: it is too short") as caught:
        sk.run(given)
    assert caught.value.codes == ("E212",)


def test_the_sheet_says_what_bolts_pull() -> None:
    result = sk.run(ASSEMBLIES["row"])
    text = result.sheet.full
    assert "by interface and bolt" in text
    assert "W311" in text


def forces_factor(scene) -> float | None:
    bed = elastic_bed(scene.model, scene.bedding.polygons, scene.bedding.centroid)
    return forces_limit(scene.model, forces_limits(bed)).factor


@pytest.mark.parametrize("each", [10, 30], ids=["180 bolts", "540 bolts"])
def test_many_bolts_of_one_direction_are_one_of_all_their_capacity(each) -> None:
    """Of more than 400 columns the least squares let in 400 and gave up without a word: a limit too low."""
    given = {"dips": ("45/125", "50/235"), "height": 10, "c": 5, "phi": 25, "unit_weight": 26}
    one = {"force": 60.0, "toward": (0.0, 0.0), "acts": "passive"}
    strong = [one | {"toward": (float(trend % 360), 0.0)} for trend in range(-9, 9)]
    weak = [bolt | {"force": 60.0 / each} for bolt in strong for _ in range(each)]
    whole, parted = (
        forces_factor(cut(wedge_design(given | {"bolts": bolts})).scene_at(0))
        for bolts in (strong, weak)
    )
    assert whole == pytest.approx(parted, rel=1e-9)


@pytest.mark.parametrize(("contacts", "bolts"), [(1, 8), (2, 5), (3, 4)])
def test_pieces_leave_the_least_of_the_load_at_every_strength(contacts, bolts) -> None:
    """Just below the end of each piece pushes N >= 0 and pulls 0 <= T <= λ C of least |load + Σ N n + Σ T b|, by SciPy.

    What is left is one vector; the forces are one set where some is left. Nothing more is asked once nothing is left.
    """
    rng, count, apart = np.random.default_rng(contacts), 150, 0
    sides = rng.normal(size=(count, contacts + bolts, 3))
    sides[:, :contacts, 2] = np.abs(sides[:, :contacts, 2])
    sides /= np.linalg.norm(sides, axis=2)[:, :, None]
    load, capacity = (
        0.3 * rng.normal(size=(count, 3)) - [0.0, 0.0, 1.0],
        rng.uniform(0.1, 1.0, (count, bolts)) ** 2,
    )
    on_contacts = [nnls(sides[row, :contacts].T, -load[row])[0] for row in range(count)]
    full = np.concatenate([np.zeros((count, contacts)), capacity], axis=1)
    pieces, ends = _linear_pieces(sides, load, np.array(on_contacts), full)
    for row in range(count):
        for reduction in (1.0 - 1e-6) * np.unique(ends[row][ends[row] < 5.0]):
            piece = pieces[row, int((reduction > ends[row]).sum())]
            forces, left = np.split(piece[:, 0] + reduction * piece[:, 1], [contacts + bolts])
            most = np.concatenate([np.full(contacts, np.inf), reduction * capacity[row]])
            exact = lsq_linear(
                sides[row].T, -load[row], (np.zeros(len(most)), most), method="bvls", tol=1e-14
            ).x
            left_over = load[row] + exact @ sides[row]
            if np.linalg.norm(left_over) < 1e-9:
                break  # more strength balances the load as well: the block stands without friction
            assert left == pytest.approx(left_over, abs=1e-9)
            if np.linalg.norm(left) > 1e-6:
                assert forces == pytest.approx(exact, abs=1e-8)
                apart += 1
    assert apart > 100


def test_least_squares_let_in_as_many_columns_as_they_need() -> None:
    found, left = non_negative_least_squares(np.eye(450), np.full(450, 2.0))
    assert found == pytest.approx(np.full(450, 2.0))
    assert left == pytest.approx(np.zeros(450))
