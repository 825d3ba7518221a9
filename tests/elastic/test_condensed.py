"""Blocks condensed to the nodes of their contacts: Newton's step is that of the whole matrix with the flexibilities of
all pairs, one block, stiff blocks and a bench are what they have to be; work that ends says so."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy import sparse
from scipy.sparse.linalg import splu

import slopekit as sk
from slopekit.elastic import rest
from slopekit.elastic.condensed import Condensed
from slopekit.elastic.rest import RestSearch
from slopekit.kinds import cut
from slopekit.kinds.elastic import scene_of_many
from slopekit.preie.system.contact import ContactMode


def wall(cohesion: float = 0.0, high: int = 4) -> dict:
    """Running bond on a base that falls at 20 degrees, courses of 2 m x 1 m: corners to all digits."""
    turn = np.array([[np.cos(0.35), np.sin(0.35)], [-np.sin(0.35), np.cos(0.35)]])
    courses = {"A": (0, 2, 4, 6), "B": (0, 1, 3, 5, 6), "C": (0, 2, 4, 6), "D": (0, 1, 3, 5, 6)}
    ends = {
        f"{name}{k}": (*pair, z, z + 1)
        for z, (name, at) in enumerate(list(courses.items())[:high])
        for k, pair in enumerate(pairwise(at), 1)
    } | {"base": (-1, 7, -2, 0)}
    blocks = {
        name: {"polygon": (np.array([[x, z], [x1, z], [x1, z1], [x, z1]]) @ turn).tolist()}
        for name, (x, x1, z, z1) in ends.items()
    }
    blocks["base"]["fixed"] = True
    return {
        "slopekit": 1,
        "kind": "blocks",
        "blocks": blocks,
        "strength": {"joint": {"c": cohesion, "phi": 35}},
        "rock": {"unit_weight": 25},
    }


@pytest.fixture(scope="module")
def scene():
    design = sk.load(wall(high=3))
    return scene_of_many(design, cut(design), sk.analyse(design))


def flexibilities(model):
    """D and H of d = B γ + D f + H q: what all pairs give per force there and per load, no motion as a whole in it.

    D = Π P K⁺ Pᵀ Π, H = Π (P K⁺ G - P K⁺ Pᵀ B (BᵀB)⁻¹), Π = I - B (BᵀB)⁻¹ Bᵀ: a load is balanced at the pairs first.
    """
    size, unknowns = model.rows.shape
    by_force, by_load = np.zeros((size, size)), np.zeros((size, unknowns))
    for one, pairs, own in model.blocks:
        rows, shapes = model.rows[pairs][:, own].toarray(), one.shapes.toarray()
        inverse, normal = (
            np.linalg.pinv(one.stiffness, rcond=1e-12, hermitian=True),
            np.linalg.pinv(rows),
        )
        free = np.eye(len(pairs)) - rows @ normal
        at_pairs = shapes @ inverse
        by_force[np.ix_(pairs, pairs)] += free @ at_pairs @ shapes.T @ free
        by_load[np.ix_(pairs, own)] += free @ at_pairs @ (one.load - shapes.T @ normal.T)
    return by_force, by_load


def by_the_whole(model, law, off, balance, springs):
    """The changes of d and γ from one matrix of all d and γ."""
    by_force, by_load = flexibilities(model)
    bolts = sparse.csr_matrix(-(model.bolt_rows.T * springs) @ model.bolt_rows)
    upper, right = (
        sparse.identity(len(off)) - by_force @ law,
        sparse.csr_matrix(-model.rows) - by_load @ bolts,
    )
    whole = sparse.bmat(
        [[sparse.csc_matrix(upper), right], [model.rows.T @ law, bolts]], format="csc"
    )
    found = splu(whole).solve(np.concatenate([-off, -balance]))
    return found[: len(off)], found[len(off) :]


@pytest.mark.parametrize("rigid", [False, True])
@pytest.mark.parametrize("pulling", [0, 2])
def test_the_condensed_step_is_the_step(scene, rigid: bool, pulling: int) -> None:
    """What is off is of the loads and of some forces, as it is on the way to rest."""
    model = scene.model.rigid() if rigid else scene.model
    size, unknowns = model.rows.shape
    draw = np.random.default_rng(7)
    springs, bolts = (
        np.array([3e3, 5e3, 4e3]) * (np.arange(3) < pulling),
        draw.normal(size=(3, unknowns)),
    )
    model = replace(model, bolt_rows=bolts, bolt_capacity=np.ones(3))
    slopes = draw.normal(size=(size // 3, 3, 3)) * 50.0 - 1e4 * np.eye(3)  # friction: not symmetric
    law = sparse.block_diag(list(slopes), format="csr")
    forces = 1e2 * draw.normal(size=size)
    loads = 1e3 * draw.normal(size=unknowns)
    by_force, by_load = flexibilities(model)
    equations = Condensed(model)
    found = equations.step(
        slopes, equations.residual(np.zeros(equations.bent), forces, loads), springs
    )
    exact = by_the_whole(
        model, law, -by_force @ forces - by_load @ loads, model.rows.T @ forces + loads, springs
    )
    for own, other in zip(found, exact, strict=False):
        assert own == pytest.approx(other, abs=1e-9 * np.abs(other).max())


def test_a_wall_rests_as_with_all_its_flexibilities(scene) -> None:
    """The forces balance the blocks, and the displacements are those of the flexibilities of all pairs under them."""
    model, found = scene.model, RestSearch(scene.model, scene.stiffness).rest(1.0)
    assert found.is_balanced
    assert (found.modes != ContactMode.STICK).any()
    by_force, by_load = flexibilities(model)
    bent = by_force @ found.forces + by_load @ model.load
    relative = found.relative.ravel()
    assert np.abs(bent).max() > 0.05 * np.abs(relative).max()
    assert relative == pytest.approx(
        model.rows @ found.motion + bent, abs=1e-7 * np.abs(relative).max()
    )
    assert model.rows.T @ found.forces == pytest.approx(
        -model.load, abs=1e-7 * np.abs(model.load).max()
    )


def test_what_still_parts_is_not_at_rest() -> None:
    """Rounds or steps that run out leave bonds in tension: that is no rest."""
    design = sk.load(wall(cohesion=1.0, high=2))
    scene = scene_of_many(design, cut(design), sk.analyse(design))
    assert RestSearch(scene.model, scene.stiffness).rest(1.0).parted.any()
    search = RestSearch(scene.model, scene.stiffness)
    search.releases = 2
    assert not search.rest(1.0).is_balanced
    short = RestSearch(scene.model, scene.stiffness)
    short.max_steps = 5
    found = short.rest(1.0)
    assert short.spent
    assert not found.is_balanced


def test_many_bonds_that_part_at_once_lead_to_the_same_rest(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of a crowd a quarter part together: fewer rounds, and the same bonds are gone as group after group."""
    design = sk.load(wall(cohesion=3.0))
    scene = scene_of_many(design, cut(design), sk.analyse(design))
    states = []
    for crowd in (10**9, 4):
        monkeypatch.setattr(rest, "_MANY_PAIRS", crowd)
        search = RestSearch(scene.model, scene.stiffness)
        found = search.rest(1.0)
        assert found.is_balanced
        normal, *shear = found.forces.reshape(-1, 3).T
        strength = np.where(found.parted, 0.0, scene.model.cohesion) * scene.model.area
        assert (normal >= -1e-9 * normal.max()).all()
        assert (
            np.hypot(*shear) <= strength + scene.model.tan_friction * normal + 1e-9 * normal.max()
        ).all()
        states.append((search.steps, found))
    (many, one), (few, other) = states
    assert few < many
    assert one.parted.sum() > 20
    assert (one.parted == other.parted).mean() > 0.97
    assert other.forces == pytest.approx(one.forces, abs=0.02 * np.abs(one.forces).max())


def test_work_that_runs_out_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rest, "_MAX_WORK", 1e3)
    found = sk.run("templates/wall.yaml", elastic=True)
    assert found.elastic is None
    (said,) = [str(one) for one in found.warnings if one.code == "W450"]
    assert "steps" in said
    assert "pulled open" in said


def test_a_limit_without_the_cohesion_that_is_not_found_is_no_infinite_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The work for it may run out: the state stays, the sheet says that the limit was not found."""

    def without_limit(*given):
        return replace(scene_of_many(*given), limit_without=lambda parted: (None, True))

    monkeypatch.setattr("slopekit.kinds.elastic.scene_of_many", without_limit)
    found = sk.run(wall(cohesion=1.0, high=1), elastic=True)
    assert found.elastic.limit is None
    assert "W360" in [one.code for one in found.warnings]
    shown = " ".join(str(found).split())
    assert "was not found; rigid" in shown
    assert "without strength" not in shown
    assert found.to_dict()["elastic"]["limit"] is None


def slabs(phi_deg: float) -> dict:
    """Three slabs of half a metre between two walls, 3 m high, held by cohesion that pulls open in part."""
    outlines = {
        f"B{k}": {"polygon": [[0.5 * k, 0], [0.5 * k + 0.5, 0], [0.5 * k + 0.5, 3], [0.5 * k, 3]]}
        for k in range(3)
    }
    left, right = [[-3, -1], [0, -1], [0, 4], [-3, 4]], [[1.5, -1], [4.5, -1], [4.5, 4], [1.5, 4]]
    return {
        "slopekit": 1,
        "kind": "blocks",
        "section": {"thickness": "1 m"},
        "blocks": {"L": {"polygon": left, "fixed": True}, "R": {"polygon": right, "fixed": True}}
        | outlines,
        "interfaces": {"default": "joint"},
        "strength": {"joint": {"c": 150, "phi": phi_deg}},
        "rock": {"unit_weight": 26, "modulus": "5 GPa", "poisson": 0.25},
    }


def test_slabs_between_walls_hang_on_the_cohesion_that_is_left(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """No friction: Σ c A / W, by hand, over half of both walls, and of the pairs of theirs that do not pull open.

    The outer slabs hang on their walls and are turned by the one between: each contact is pressed on half its height.
    """
    left: list[float] = []

    def watched(*given):
        scene = scene_of_many(*given)
        rows = np.concatenate([rows for _, rows, _ in scene.model.blocks])
        at_wall = np.bincount(rows // 3) == 3  # their three rows are those of one block

        def limit_without(parted):
            left.append(150.0 * float(scene.model.area[at_wall & ~parted].sum()))
            return scene.limit_without(parted)

        return replace(scene, limit_without=limit_without)

    monkeypatch.setattr("slopekit.kinds.elastic.scene_of_many", watched)
    found, weight = sk.run(slabs(0.0), elastic=True), 1.5 * 3.0 * 26.0
    assert found.fos.limit == pytest.approx(0.5 * 2.0 * 150.0 * 3.0 / weight, rel=1e-8)
    assert 0.0 < left[0] < 900.0
    assert found.elastic.limit == pytest.approx(0.5 * left[0] / weight, rel=1e-8)


def test_a_limit_that_nothing_holds_without_the_cohesion_is_not_for_want_of_work(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def without_limit(*given):
        return replace(scene_of_many(*given), limit_without=lambda parted: (None, False))

    monkeypatch.setattr("slopekit.kinds.elastic.scene_of_many", without_limit)
    found = sk.run(slabs(0.0), elastic=True)
    said = {one.code: one.message for one in found.warnings}
    assert found.elastic.limit is None
    assert "W360" not in said
    assert "none was found, and not for want of work" in said["W308"]


def test_a_wall_rests_up_to_its_limit() -> None:
    """It slides on its base at tan φ / tan 0.35, rigid or elastic: no cohesion to lose, no forces locked in."""
    exact = np.tan(np.radians(35.0)) / np.tan(0.35)
    design = sk.load(wall(high=2))
    scene = scene_of_many(design, cut(design), sk.analyse(design))
    search = RestSearch(scene.model, scene.stiffness)
    last = search.continued(search.rest(1.0), exact * (1.0 - 2.5e-5))
    assert last is not None
    assert not search.equilibrium(last, exact * (1.0 + 1e-6)).is_balanced
