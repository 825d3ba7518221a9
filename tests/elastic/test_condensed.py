"""Newton's step condensed to the nodes of the contacts is the step of the whole matrix; work that ends, and says so."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse
from scipy.sparse.linalg import splu

import slopekit as sk
from slopekit.elastic import rest
from slopekit.elastic.condensed import Condensed
from slopekit.elastic.rest import Search
from slopekit.kinds import cut
from slopekit.kinds.elastic import _many_blocks


@pytest.fixture(scope="module")
def scene():
    design = sk.load("templates/wall.yaml")
    return _many_blocks(design, cut(design), sk.analyse(design))


def by_the_whole(model, law, off, balance, springs):
    """The same changes of d and γ from one matrix of all d and γ."""
    bolts = sparse.csr_matrix(-(model.bolt_rows.T * springs) @ model.bolt_rows)
    upper, right = sparse.identity(len(off)), -model.rows
    if model.give is not None:
        upper, right = upper - model.give @ law, right - model.give_load @ bolts
    whole = sparse.bmat([[upper, right], [model.rows.T @ law, bolts]], format="csc")
    found = splu(whole).solve(np.concatenate([-off, -balance]))
    return found[: len(off)], found[len(off) :]


@pytest.mark.parametrize("rigid", [False, True])
@pytest.mark.parametrize("pulling", [0, 2])
def test_the_condensed_step_is_the_step(scene, rigid: bool, pulling: int) -> None:
    model = scene.model.rigid() if rigid else scene.model
    size, unknowns = model.rows.shape
    assert not model.is_dense
    draw = np.random.default_rng(7)
    springs = np.array([3e3, 5e3, 4e3]) * (np.arange(3) < pulling)
    model = replace(model, bolt_rows=draw.normal(size=(3, unknowns)), bolt_capacity=np.ones(3))
    slopes = draw.normal(size=(size // 3, 3, 3)) * 50.0 - 1e4 * np.eye(3)  # friction: not symmetric
    law = sparse.block_diag(list(slopes), format="csr")
    off = (abs(model.rows) @ np.ones(unknowns) > 0) * draw.normal(size=size)  # none out of the section
    balance = 1e3 * draw.normal(size=unknowns)
    found = Condensed(model).step(law, off, balance, springs)
    assert found is not None
    for own, whole in zip(found, by_the_whole(model, law, off, balance, springs), strict=True):
        assert own == pytest.approx(whole, abs=1e-9 * np.abs(whole).max())


def test_a_wall_comes_to_rest_by_the_condensed_step_alone(scene, monkeypatch: pytest.MonkeyPatch) -> None:
    search = Search(scene.model, scene.stiffness)
    found = search.rest(1.0)
    assert found.stands
    monkeypatch.setattr(Condensed, "step", lambda *_: None)  # the whole matrix instead
    slow = Search(scene.model, scene.stiffness).rest(1.0)
    assert slow.steps == found.steps
    assert (slow.parted == found.parted).all()
    assert found.forces == pytest.approx(slow.forces, abs=1e-9 * np.abs(slow.forces).max())


def test_what_still_parts_is_not_at_rest(scene) -> None:
    """Rounds or steps that run out leave pairs in tension: that is no rest."""
    search = Search(scene.model, scene.stiffness)
    search.releases = 2
    assert not search.rest(1.0).stands
    short = Search(scene.model, scene.stiffness)
    short.most = 5
    found = short.rest(1.0)
    assert short.spent
    assert not found.stands


def test_work_that_runs_out_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rest, "_WORK", 1e4)
    found = sk.run("templates/wall.yaml", elastic=True)
    assert found.elastic is None
    (said,) = [str(one) for one in found.warnings if one.code == "W451"]
    assert "steps" in said
    assert "pulled open" in said


def test_a_bracket_that_runs_out_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rest, "_WORK_OF_BRACKET", 1e4)
    plane = {
        "slopekit": 1, "kind": "plane", "slope": {"face": "60/180", "height": 12, "upper": "0/180"},
        "joints": {"J1": {"plane": "35/180"}}, "strength": {"joint": {"c": 20, "phi": 30}},
        "rock": {"density": 2600}, "contact": {"shear_stiffness": 1e6}, "analysis": {"elastic": {"edge": "3 m"}},
    }  # fmt: skip
    plane.pop("contact")
    found = sk.run(plane, elastic_bracket=True)
    assert "W456" in [one.code for one in found.warnings]
