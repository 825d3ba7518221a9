"""Elastic blocks at rest, against the rigid code, against displacements on nodes, and as the world turns."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse
from scipy.sparse.linalg import splu

import slopekit as sk
from benchmarks.elastic_oracle import last_rest, state_of
from slopekit.elastic.flexibility import Elements, body
from slopekit.elastic.meshing import convex_mesh, halvings
from slopekit.elastic.rest import RestSearch
from slopekit.kinds import cut
from slopekit.kinds.elastic import elastic_model
from slopekit.kinds.wedge.design import wedge_design
from slopekit.preie.motion.equilibrium import equilibrium
from slopekit.preie.system.assembly import one_block
from slopekit.preie.system.contact import JointStiffness, tractions
from slopekit.preie.system.model import local_axes

WEDGE = {
    "dips": ("45/105", "70/235"),
    "face": "65/185",
    "upper": "12/195",
    "height": 30,
    "c": (24, 48),
    "phi": (20, 30),
    "unit_weight": 25,
}
STIFFNESS = JointStiffness(normal=1e7, tangential=1e5)
COARSE = {"modulus": "2 GPa", "edge": "25 m", "shear_stiffness": 1e5}


def blocks(modulus: float, order: int = 2, **more):
    """The wedge on its pairs, elastic, with its elements."""
    made = cut(wedge_design({**WEDGE, **more}))
    scene = made.scene_at(2)
    mesh, model = convex_mesh(made.block.faces.values(), made.block.volume), scene.model
    elements = Elements(mesh.refined(halvings(mesh, 25.0)), modulus, 0.25, order=order)
    give = body(elements, scene.pairs.points, local_axes(scene.pairs.normals), model.length_scale)
    none, points = np.zeros(len(scene.pairs)), scene.pairs.points
    whole = elastic_model(one_block(model), points, none, {0: mesh}, {0: 25.0}, (modulus, 0.25))
    return replace(whole, blocks=((give, *whole.blocks[0][1:]),)), elements, scene, model


@pytest.mark.parametrize(
    "more", [{}, {"water": "50%", "bolts": ["3000@5/-10,passive"], "crack": "80/180@8"}]
)
def test_rock_that_does_not_give_is_rigid(more) -> None:
    model, _, scene, rigid = blocks(1e16, **more)
    found, exact = RestSearch(model, STIFFNESS).rest(1.0), equilibrium(rigid, 1.0, STIFFNESS)
    assert found.is_balanced
    assert exact.is_balanced
    assert found.forces.reshape(-1, 3) == pytest.approx(
        exact.forces, abs=1e-6 * float(np.abs(exact.forces).max())
    )
    turned = np.where(np.arange(6) < 3, 1.0, rigid.length_scale)
    assert found.motion == pytest.approx(
        exact.displacement * turned, abs=1e-6 * float(np.abs(found.motion).max())
    )
    assert len(scene.pairs) == len(found.modes)


def test_displacements_on_nodes_give_the_same_forces() -> None:
    """The same rest by Newton's method on all displacements of the elements: no D, no γ, nothing condensed."""
    model, elements, scene, rigid = blocks(2e6)
    found = RestSearch(model, STIFFNESS).rest(1.0)
    assert found.is_balanced
    assert found.parted.any()
    axes = sparse.block_diag(list(local_axes(scene.pairs.normals)), format="csr")
    shapes = axes @ elements.shapes(scene.pairs.points)
    load = elements.spread(rigid.length_scale) @ model.load
    area, at = model.area, np.linalg.lstsq(shapes.toarray(), found.relative.ravel(), rcond=None)[0]
    for _ in range(20):
        relative = (shapes @ at).reshape(-1, 3)
        relative[:, 1:] -= found.memory
        law = tractions(
            relative,
            STIFFNESS,
            model.cohesion,
            model.tan_friction,
            model.tan_dilation,
            1.0,
            found.parted,
        )
        off = load + shapes.T @ (law.tractions * area[:, None]).ravel() - elements.stiffness @ at
        if np.abs(off).max() < 1e-11 * np.abs(load).sum():
            break
        slopes = sparse.block_diag(list(law.slopes * area[:, None, None]), format="csr")
        at = at + splu((elements.stiffness - shapes.T @ slopes @ shapes).tocsc()).solve(off)
    forces = law.tractions * area[:, None]
    assert forces == pytest.approx(
        found.forces.reshape(-1, 3), abs=1e-8 * float(np.abs(forces).max())
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    "more", [{"water": "50%"}, {"crack": "80/180@8", "bolts": ["1000@5/-10,passive"]}]
)
def test_the_limit_is_the_rigid_one_without_the_cohesion_that_is_pulled_open(more) -> None:
    """The prototype of elastic blocks (docs/method.md): the factor up to which the elastic block comes to rest."""
    result = sk.wedge(**WEDGE, **COARSE, **more, elastic=True)
    found = result.elastic
    assert found is not None
    scene, search, state = state_of(result)
    last, high = last_rest(search, state, found.limit)
    assert not search.spent
    low, without = last.factor, scene.limit_without(last.opened(scene.model))[0]
    assert high / low - 1.0 < 1.1e-4
    assert low * (1.0 - 3e-4) <= without <= high * (1.0 + 3e-4)
    assert found.limit <= found.rigid_limit
    assert found.limit == pytest.approx(without, rel=0.02)


@pytest.mark.slow
def test_a_state_that_is_not_that_of_full_strength_is_said() -> None:
    """A wet, cracked wedge: no rest at F = 1 while the limit without what is open at 0.95 lies above (W455)."""
    given = {
        "dips": ("51.3/147.8", "67.8/259.5"),
        "face": "78.2/180",
        "upper": "1.8/180",
        "height": 52.22,
        "c": (55.4, 61.9),
        "phi": (30.6, 30.6),
        "unit_weight": 26,
        "shear_stiffness": 1e5,
        "modulus": "4.8 GPa",
        "water": "13%",
        "crack": "85/180@9.53",
        "bolts": ["929@0/-10,active"],
        "edge": 32.35,
    }
    found = sk.wedge(**given, elastic=True)
    assert (found.elastic.factor, found.elastic.limit) == (0.95, pytest.approx(1.0226, abs=1e-3))
    said = {notice.code: notice.message for notice in found.warnings}
    assert (
        "rest at F = 0.95, at 1 none was found: their limit may lie between, below the 1.0226"
        in said["W455"]
    )
    assert said["W455"].endswith("rely on 0.95")
    _, search, state = state_of(found, 0.95)
    assert not search.equilibrium(state, 0.96).is_balanced
    assert "W455" not in {
        notice.code for notice in sk.wedge(**WEDGE, **COARSE, elastic=True).warnings
    }


def test_the_oracle_sees_cohesion_go() -> None:
    found = sk.wedge(**WEDGE, **COARSE, elastic=True).elastic
    assert found.opened_share > 0.005
    assert found.limit < found.rigid_limit * (1.0 - 1e-3)
    assert (
        found.displacement_m @ found.displacement_m
        > found.rigid_displacement_m @ found.rigid_displacement_m
    )


def turned_by(plane: str, degrees: float) -> str:
    dip, direction = plane.split("/")
    return f"{dip}/{(float(direction) + degrees) % 360.0:g}"


@pytest.mark.slow
@pytest.mark.parametrize("changed", ["turned", "moved", "mirrored", "scaled"])
def test_the_same_wedge_elsewhere(changed: str) -> None:
    base = sk.wedge(**WEDGE, **COARSE, elastic=True).elastic
    given = {**WEDGE, **COARSE}
    size = 1.0
    if changed == "turned":
        given |= {"dips": [turned_by(one, 37.0) for one in given["dips"]]}
        given |= {key: turned_by(given[key], 37.0) for key in ("face", "upper")}
    elif changed == "moved":
        given |= {"origin": (500e3, 4.2e6, 300)}
    elif changed == "mirrored":

        def mirror(plane):
            dip, direction = plane.split("/")
            return f"{dip}/{360.0 - float(direction):g}"

        given |= {"dips": [mirror(one) for one in given["dips"]]}
        given |= {key: mirror(given[key]) for key in ("face", "upper")}
    else:  # lengths times 3, stresses times 3: strains and factors stay
        size = 3.0
        given |= {"height": 90, "c": (72, 144), "modulus": "6 GPa", "edge": "75 m"}
    found = sk.wedge(**given, elastic=True).elastic
    assert found.limit == pytest.approx(base.limit, rel=1e-6)
    assert found.opened_share == pytest.approx(base.opened_share, rel=1e-6)
    ours, theirs = (float(np.linalg.norm(one.displacement_m)) for one in (found, base))
    assert ours == pytest.approx(theirs * size, rel=1e-5)
    for name, joint in base.joints.items():
        assert found.joints[name].elastic_kpa[1] == pytest.approx(
            joint.elastic_kpa[1] * size, rel=1e-5
        )


@pytest.mark.slow
def test_where_moments_govern_once_cohesion_is_lost() -> None:
    """Wedge 41 of the oracle: it rests beyond the rigid limit with turning, and not up to that of the forces alone.

    The forces alone are Hoek & Bray's closed form with the cohesion of each joint cut by the share that opens at F = 1.
    """
    given: dict = {
        "dips": ("44.5/131.6", "67.4/212.5"),
        "face": "76.4/180",
        "upper": "2.8/180",
        "height": 54.241609561109826,
        "phi": (36.0, 28.0),
        "unit_weight": 26,
        "shear_stiffness": 1e5,
        "crack": "85/180@10.85",
        "bolts": ["5450@0/-10,active"],
    }
    cohesion = {"J1": 66.1, "J2": 55.0}
    result = sk.wedge(**given, c=(66.1, 55.0), modulus="9.6 GPa", edge="39 m", elastic=True)
    found = result.elastic
    assert found is not None
    scene, search, state = state_of(result)
    last, high = last_rest(search, state, found.limit)
    left = {name: c * (1.0 - found.joints[name].opened_share) for name, c in cohesion.items()}
    without = sk.wedge(**given, c=(left["J1"], left["J2"])).fos.closed_form
    assert found.joints["J2"].opened_share > 0.3
    assert scene.limit_without(last.opened(scene.model))[0] < 0.97 * last.factor
    assert 1.0 < high < without < result.comparisons.forces_only
