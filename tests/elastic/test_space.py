"""Many elastic blocks in space, condensed to the nodes of their contacts, against what is known of them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.errors import DesignError
from slopekit.elastic.rest import RestSearch
from slopekit.kinds import cut
from slopekit.kinds.elastic import scene_of_many
from slopekit.preie.system.contact import ContactMode

FACES = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
E, K_N, GAMMA = 2e6, 1e5, 25.0


def in_section(ends: dict, depth: float, turn: float = 0.0) -> dict:
    """Boxes (x, x1, z, z1) of a section, all turned about y; the first is fixed."""
    turned = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    given = {
        name: {
            "polygon": (np.array([[x, z], [x1, z], [x1, z1], [x, z1]]) @ turned).tolist(),
            "unit_weight": GAMMA,
        }
        for name, (x, x1, z, z1) in ends.items()
    }
    given[next(iter(ends))]["fixed"] = True
    return {
        "slopekit": 1,
        "kind": "blocks",
        "section": {"thickness": depth},
        "blocks": given,
        "rock": {"modulus": E, "poisson": 0.0},
        "strength": {"joint": {"c": 10, "phi": 30, "stiffness": {"normal": K_N, "shear": K_N}}},
    }


def in_space(folder: Path, ends: dict, depth: float, turn: float = 0.0) -> dict:
    """The same as meshes of a depth."""
    design = in_section(ends, depth, turn)
    del design["section"]
    for name, given in design["blocks"].items():
        sides = np.array(given.pop("polygon"))
        corners = [(x, y, z) for y in (0.0, depth) for x, z in sides.tolist()]
        rows = [" ".join(map(repr, corner)) for corner in corners] + [
            f"4 {a} {b} {c} {d}" for a, b, c, d in FACES
        ]
        (folder / f"{name}.off").write_text("\n".join(["OFF", "8 6 0", *rows]) + "\n")
        given["mesh"] = str(folder / f"{name}.off")
    return design


def test_a_stack_settles_as_strength_of_materials_says(tmp_path: Path) -> None:
    """γ h² / 2E and γ h / k_n, of what stands on it too; node pairs cross the elements, which takes 1e-3."""
    lower, upper = 4.0, 7.0
    ends = {"base": (-5, 8, -5, 0), "A": (0, 3, 0, lower), "B": (0, 3, lower, lower + upper)}
    found = sk.run(in_space(tmp_path, ends, 2.0), elastic=True).elastic
    assert found is not None
    assert found.block == "B"
    springs = (GAMMA * (lower + upper) + GAMMA * upper) / K_N
    below = (GAMMA * lower**2 / 2.0 + GAMMA * upper * lower) / E
    mean = springs + below + GAMMA * upper**2 / 3.0 / E
    assert found.displacement_m[2] == pytest.approx(-mean, rel=2e-3)
    (tmp_path / "finer").mkdir()
    design = in_space(tmp_path / "finer", ends, 2.0) | {"analysis": {"elastic": {"edge": 2}}}
    finer = sk.run(design, elastic=True).elastic.displacement_m[2]
    assert abs(finer + mean) < 0.6 * abs(found.displacement_m[2] + mean)
    assert found.rigid_displacement_m[2] == pytest.approx(-springs, rel=1e-10)


def test_an_extruded_section_is_the_section(tmp_path: Path) -> None:
    """Two blocks and one on both, on a base that falls at 15 degrees, ν = 0: but for the meshes the same."""
    ends = {"base": (-4, 8, -3, 0), "A": (0, 2, 0, 1), "B": (2, 4, 0, 1), "C": (1, 3, 1, 2.5)}
    plane = sk.run(in_section(ends, 1.0, 0.26), elastic=True)
    space = sk.run(in_space(tmp_path, ends, 1.0, 0.26), elastic=True)
    assert plane.elastic is not None
    assert space.elastic is not None
    assert space.elastic.block == plane.elastic.block == "C"
    assert space.elastic.limit == pytest.approx(plane.elastic.limit, rel=5e-3)
    one, other = space.elastic.displacement_m, plane.elastic.displacement_m
    assert one == pytest.approx(other, abs=0.01 * float(np.abs(other).max()))
    assert not np.allclose(
        other, plane.elastic.rigid_displacement_m, rtol=0.05
    )  # it is the rock that gives


@pytest.fixture(scope="module")
def bench():
    """A corner of the bench of the template: its design and answer."""
    design = sk.load(
        "templates/bench.yaml",
        {
            "slope.height": "9 m",
            "slope.length": "7 m",
            "analysis.elastic.edge": "6 m",
            "rock.modulus": "5 GPa",
        },
    )
    return design, sk.analyse(design)


@pytest.mark.slow
def test_blocks_of_a_bench_balance(bench) -> None:
    design, answer = bench
    scene = scene_of_many(design, cut(design), answer)
    model = scene.model
    found = RestSearch(model, scene.stiffness).rest(1.0)
    assert found.is_balanced
    unbalanced = (model.rows.T @ found.forces + model.load).reshape(-1, 6)
    assert np.abs(unbalanced).max() < 1e-8 * np.abs(model.load).max()
    normal, *shear = found.forces.reshape(-1, 3).T
    assert (normal >= 0.0).all()
    assert (np.hypot(*shear) <= model.tan_friction * normal + 1e-9 * normal.max()).all()
    open_ = found.modes == ContactMode.DEBOND
    assert open_.any()
    assert (found.relative[open_, 0] >= 0.0).all()
    assert not found.forces.reshape(-1, 3)[open_].any()
    assert (found.opened(model) == open_).all()


@pytest.mark.slow
def test_lighter_dashpots_lead_to_rest_where_the_others_give_up(
    bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With no rounds of the heavy ones: another way, to forces within 5 % of the largest, in balance."""
    design, answer = bench
    scene = scene_of_many(design, cut(design), answer)
    usual = RestSearch(scene.model, scene.stiffness).rest(1.0)
    left, lightened = list[float](), RestSearch._lighter_rounds

    def seen(self: RestSearch, *given):
        best = lightened(self, *given)
        left.append(best.size)
        return best

    monkeypatch.setattr("slopekit.elastic.rest._ROUNDS", 0)
    monkeypatch.setattr(RestSearch, "_lighter_rounds", seen)
    found = RestSearch(scene.model, scene.stiffness).rest(1.0)
    assert len(left) == 1
    assert left[0] < 1e-8
    assert found.is_balanced
    assert not np.array_equal(found.forces, usual.forces)
    assert found.forces == pytest.approx(usual.forces, abs=0.05 * np.abs(usual.forces).max())
    unbalanced = scene.model.rows.T @ found.forces + scene.model.load
    assert np.abs(unbalanced).max() < 1e-8 * np.abs(scene.model.load).max()


@pytest.mark.slow
def test_stiff_rock_is_rigid_in_space(bench) -> None:
    design, answer = bench
    stiff = replace(design, rock=replace(design.rock, modulus_kpa=1e14))
    scene = scene_of_many(stiff, cut(stiff), answer)
    found = RestSearch(scene.model, scene.stiffness).rest(1.0)
    exact = RestSearch(scene.model.rigid(), scene.stiffness).rest(1.0)
    assert found.is_balanced
    assert exact.is_balanced
    assert found.forces == pytest.approx(exact.forces, abs=1e-6 * np.abs(exact.forces).max())
    assert found.motion == pytest.approx(exact.motion, abs=1e-6 * np.abs(exact.motion).max())


@pytest.mark.slow
def test_a_bench_says_what_it_took(bench, monkeypatch: pytest.MonkeyPatch) -> None:
    design, _ = bench
    found = sk.analyse(design, elastic=True)
    assert found.elastic is not None
    assert found.elastic.limit == found.fos.limit  # no cohesion to lose
    assert found.elastic.mesh.residual < 1e-8
    assert 0.0 < found.elastic.opened_share < 0.5
    assert found.fos.highest is None  # its mechanism holds at whatever strength
    (said,) = [str(notice) for notice in found.warnings if notice.code == "W455"]
    assert f"{found.fos.lowest:.3f} .. far above it" in said
    scene = scene_of_many(design, cut(design), found)
    monkeypatch.setattr("slopekit.elastic.condensed._MAX_BYTES", 1e3)
    with pytest.raises(DesignError) as caught:
        RestSearch(scene.model, scene.stiffness)
    assert [fault.code for fault in caught.value.faults] == ["E125"]
    monkeypatch.setattr("slopekit.kinds.elastic._MOST_OF_MANY", 50)
    with pytest.raises(DesignError) as caught:
        scene_of_many(design, cut(design), found)
    assert [fault.code for fault in caught.value.faults] == ["E125"]
