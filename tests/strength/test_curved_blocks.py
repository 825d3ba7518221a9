"""Curved strength among many blocks: the elastic path asks the law itself, and its limit is one of the law."""

import math
from dataclasses import replace

import numpy as np
import pytest
from ruamel.yaml import YAML

import slopekit as sk
from benchmarks import populations
from slopekit.design.templates import path_of
from slopekit.kinds import cut, factors_of
from slopekit.kinds.assemblies.many_blocks_scene import scene_loads
from slopekit.kinds.solver_inputs import joint_strength
from slopekit.preie.many_blocks import blocks
from slopekit.preie.many_blocks.blocks_limit import Basis
from slopekit.preie.many_blocks.ravelling import SolvedComponent, critical_load, ravel
from slopekit.preie.outcome import Outcome
from slopekit.preie.system import strength_lines
from slopekit.preie.tolerances import BOUND_ACCURACY
from tests.preie import path_oracle

LAWS = {
    "power": {"law": "power", "a": 1.5, "b": 0.75},
    "steep": {"law": "power", "a": 3.0, "b": 0.5},
    "power with d": {"law": "power", "a": 1.5, "b": 0.75, "d": "3 kPa"},
    "barton-bandis": {"law": "barton-bandis", "jrc": 8, "jcs": "30 MPa", "phi_r": 25},
    "bilinear": {"law": "bilinear", "phi": 22, "i": 14, "sigma_t": "15 kPa"},
    "waves": {"law": "barton-bandis", "jrc": 6, "jcs": "20 MPa", "phi_r": 22, "waviness": 4},
}


def with_law(design, law):
    """A plain design with one law on all joints."""
    strengths = {name: dict(LAWS[law]) for name in design["strength"]}
    return {**design, "strength": strengths}


def first_part(design) -> SolvedComponent:
    """The first component that fails, with its model and limit."""
    scene = cut(sk.load(design))
    return (
        ravel(scene.assembly, scene_loads(scene), joint_strength(scene.strengths), ranged=False)
        .failures[0]
        .parts[0]
    )


def in_units(model):
    """Normal force (m,) of each pair at a traction of one kPa."""
    return model.control_area * (model.area_scale / model.force_scale)


#: Sections and laws that take every branch of five sections with each law.
SECTIONS = [
    (0, "power"),
    (0, "power with d"),
    (3, "barton-bandis"),
    (3, "power"),
    (3, "waves"),
    (8, "bilinear"),
    (8, "power with d"),
    (13, "bilinear"),
    (13, "steep"),
    (16, "barton-bandis"),
    (16, "steep"),
    (16, "waves"),
]


@pytest.mark.parametrize(("number", "law"), SECTIONS)
def test_the_limit_is_a_limit_state_of_the_law(law, number) -> None:
    """By the arrays of the model and the law alone: balance, no pull, no more friction than τ(σ) / F, and the work.

    Along the motion the load works what τ(σ) / F of every pair takes, each at its own traction.
    """
    part = first_part(with_law(populations.section(number), law))
    model, limit = part.model, part.limit
    assert limit.basis in (Basis.LIMIT, Basis.PEAK)
    shear, kpa = model.lines.laws[0].resistance, in_units(model)
    lost = kpa * shear(np.zeros(len(kpa))) * (1.0 - limit.bond)
    most = model.by_group(kpa * shear(limit.normal_force / kpa) - lost) / limit.factor
    friction = np.abs(limit.friction[:, 0])
    assert np.abs(model.unbalanced(limit.normal_force, limit.friction)).max() < 1e-5
    assert limit.normal_force.min() >= 0.0
    assert (friction - most).max() < 1e-7
    if limit.basis is Basis.LIMIT:
        _, slip = model.opening_and_slip(limit.velocity)
        size = np.abs(slip[:, 0])
        assert float(model.load.ravel() @ limit.velocity.ravel()) == pytest.approx(
            float(most @ size), rel=1e-6
        )
        assert limit.change == 0.0


@pytest.mark.parametrize(("law", "number"), [("barton-bandis", 3), ("power", 12)])
def test_histories_with_slip_that_stays_come_to_the_same_limit(law, number) -> None:
    """Another law of slip, by another code, whose slopes of τ(σ) are differences: strength is lowered slowly."""
    design = with_law(populations.section(number), law)
    model, factor = path_oracle.model_of(design), sk.run(design).fos.limit
    given = path_oracle.arrays_of(model)
    joints = path_oracle.CurvedJoints(given, 0.4, model.lines.laws[0].resistance, in_units(model))
    found = path_oracle.history(model, 2.0 / factor, bed=joints)
    assert found.end == "settled"
    assert factor == pytest.approx(found.factor, rel=1e-8)


def yaml_of(name):
    """A template as a plain design."""
    return dict(YAML(typ="safe").load(path_of(name).read_text(encoding="utf-8")))


def test_a_steep_curve_has_a_limit_state_of_its_own() -> None:
    """A wall under 2 σ^0.75. No lines were those of their own tractions: 1.703 led to 1.713, and back (W317).

    The law itself has a limit state, found at once; it is the same at any part of the strength.
    """
    design = {**yaml_of("wall"), "strength": {"joint": {"law": "power", "a": 2.0, "b": 0.75}}}
    result = sk.run(design)
    assert result.model.residual == 0.0
    assert "W317" not in [notice.code for notice in result.warnings]
    assert result.fos.limit == pytest.approx(1.70160, abs=5e-5)
    weaker = {**design, "strength": {"joint": {"law": "power", "a": 2.0 / 1.7, "b": 0.75}}}
    assert sk.run(weaker).fos.limit * 1.7 == pytest.approx(result.fos.limit, rel=1e-9)


@pytest.mark.parametrize("times", [2.0])
def test_where_the_path_starts_says_hardly_anything(times, monkeypatch) -> None:
    """From half and from twice the strength: the same wall to six digits, as blocks at rest may be so in other ways."""
    design = {**yaml_of("wall"), "strength": {"joint": LAWS["barton-bandis"]}}
    exact = factors_of(sk.load(design)).limit
    monkeypatch.setattr(blocks, "START", times * blocks.START)
    assert factors_of(sk.load(design)).limit == pytest.approx(exact, rel=2e-6)


def test_one_path_is_enough(monkeypatch) -> None:
    """A bench of Barton-Bandis: its limit is looked for once."""
    asked, found = [], blocks._on_path
    monkeypatch.setattr(
        blocks, "_on_path", lambda *given, **more: asked.append(1) or found(*given, **more)
    )
    part = first_part(with_law(populations.bench(0, 40), "barton-bandis"))
    assert part.limit.basis is Basis.LIMIT
    assert len(asked) == 1
    assert part.model.lines.rounds == 2


@pytest.mark.parametrize(("number", "apart"), [(3, 1e-9), (35, 0.05)])
def test_a_ladder_looks_for_the_limit_of_the_law(number, apart) -> None:
    """Section 3 has one limit on joints of any stiffness, section 35 another where k_t is a tenth of k_n.

    On the lines that the limit settled on it was the other way round: 14 % apart, and the same.
    """
    design = sk.load(with_law(populations.section(number), "steep"))
    found = sk.check(design)
    factor, judged = found.result.fos.limit, {one.name: one for one in found.findings}
    softer, stiffer, same = (rung.factor for rung in found.ladder)
    assert same == pytest.approx(factor, rel=1e-12)
    assert [softer, stiffer] == pytest.approx([factor, factor], rel=apart)
    assert (abs(softer / factor - 1.0) > 0.03) == (number == 35)
    assert judged["other strengths"].met
    assert judged["stiffness ratio"].met == (number == 3)


@pytest.mark.parametrize("law", ["power", "barton-bandis"])
def test_the_bound_is_one_of_all_tangents(law) -> None:
    """That of the tangents at the limit's tractions, by linear programs, or of others that lie lower."""
    part = first_part(with_law(populations.section(3), law))
    bound = path_oracle.static_bound(strength_lines.with_tangents(part.model))
    assert part.limit.factor < part.limit.static_bound < bound * (1.0 + BOUND_ACCURACY)


def test_a_factor_above_a_bound_of_tangents_is_none() -> None:
    """Forces that a law allows lie within its tangents: a factor that lies above their bound has lost its way."""
    part = first_part(with_law(populations.section(3), "power"))
    limit = strength_lines._with_bound(part.model, part.limit, None)
    assert limit.factor == part.limit.factor
    bound = limit.static_bound
    for times, outcome in (
        (1.0 + 0.5 * BOUND_ACCURACY, Outcome.SLIDES),
        (1.001, Outcome.NOT_CONVERGED),
    ):
        far = strength_lines._with_bound(part.model, replace(limit, factor=times * bound), None)
        assert far.outcome is outcome
        assert (far.factor is None) == (outcome is Outcome.NOT_CONVERGED)


def test_the_load_at_the_limit_by_hand() -> None:
    """A block 2 m wide and 1 m high on a level joint, pushed at half its height: T = Σ A τ(σ), σ linear in T.

    25 kPa in the middle, 6 M / L² more and less at the edges with M = T / 2, by Simpson's rule; the law bends at 20.
    """
    design = {
        "slopekit": 1,
        "kind": "blocks",
        "rock": {"unit_weight": 25.0},
        "section": {"thickness": 1.0},
        "blocks": {
            "base": {
                "polygon": [[-5.0, -1.0], [5.0, -1.0], [5.0, 0.0], [-5.0, 0.0]],
                "fixed": True,
            },
            "B1": {"polygon": [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]},
        },
        "strength": {"joint": {"law": "bilinear", "phi": 20, "i": 10, "sigma_t": "20 kPa"}},
        "loads": {"seismic": {"k": 0.1, "toward": 90}},
    }
    scene = cut(sk.load(design))
    loads = scene_loads(scene)
    without = replace(
        loads, forces=loads.forces - loads.live[0], moments=loads.moments - loads.live[1]
    )
    found = critical_load(scene.assembly, without, loads.live, joint_strength(scene.strengths), 1.0)
    steep, flat = (math.tan(math.radians(angle)) for angle in (30.0, 20.0))
    push = 0.0
    for _ in range(60):
        edges = 25.0 + 0.75 * push, 25.0, 25.0 - 0.75 * push
        shear = [steep * min(sigma, 20.0) + flat * max(sigma - 20.0, 0.0) for sigma in edges]
        push = 2.0 * (shear[0] + 4.0 * shear[1] + shear[2]) / 6.0
    assert 25.0 - 0.75 * push > 0.0
    assert found[0] * 0.1 * 50.0 == pytest.approx(push, rel=1e-9)


def test_joints_that_dilate_follow_the_law_up_to_their_friction_angle() -> None:
    """A wall under 2 σ^0.75 with ψ = 3°: one limit state of the law; with 18° of Barton-Bandis on lines, drawn anew."""
    found = []
    for dilation in (3, 18):
        law = {"law": "power", "a": 2.0, "b": 0.75} if dilation == 3 else LAWS["barton-bandis"]
        part = first_part({**yaml_of("wall"), "strength": {"joint": {**law, "dilation": dilation}}})
        found.append(part.model.lines.rounds)
        most = law_strength(part)
        assert (np.abs(part.limit.friction[:, 0]) - most).max() < 1e-7
        assert part.limit.basis is Basis.LIMIT
    assert found[0] == 2
    assert found[1] > 2


def law_strength(part: SolvedComponent) -> np.ndarray:
    """Σ A τ(N / A) / F (g,) of a part, by the law alone."""
    model, kpa = part.model, in_units(part.model)
    shear = model.lines.laws[0].resistance(part.limit.normal_force / kpa)
    return model.by_group(kpa * shear) / part.limit.factor


@pytest.mark.parametrize(
    ("strength", "counted"),
    [
        ({"c": 24, "phi": 28}, True),
        ({"law": "barton-bandis", "jrc": 8, "jcs": "80 MPa", "phi_r": 26}, False),
    ],
    ids=["line", "law"],
)
def test_dilation_of_one_block_counts_on_lines_alone(strength, counted) -> None:
    """A law says nothing of how far its joint dilates: the limit is that without dilation, and W310 says so."""
    wedge = {
        "slopekit": 1,
        "kind": "wedge",
        "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
        "slope": {"face": "65/180", "upper": "12/180", "height": 30},
    }
    plain, dilating = (
        sk.run(sk.load(wedge | {"strength": {"s": strength | {"dilation": given}}}))
        for given in (0, 6)
    )
    assert (dilating.fos.limit > plain.fos.limit * 1.001) == counted
    assert counted or dilating.fos.limit == plain.fos.limit
    (said,) = [notice.message for notice in dilating.warnings if notice.code == "W310"]
    assert ("the limit is that without dilation" in said) != counted
    assert (dilating.status == plain.status) or counted
