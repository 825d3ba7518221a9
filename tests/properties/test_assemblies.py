"""What holds for every section of polygons, row of columns, heap of solids and bench (STYLE.md §7)."""

from functools import partial

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, assume, given, settings

import slopekit as sk
from slopekit.kinds import cut
from slopekit.kinds.assemblies import many_blocks as room
from slopekit.preie.system.components import whole_model
from tests.properties import changes
from tests.properties.strategies import (
    benches,
    bolted,
    bonds,
    bricks,
    columns,
    rows,
    shards,
    stacks,
)

SECTIONS = {"stacks and rows": stacks() | rows(), "shards and bonds": shards() | bonds()}
#: A limit state of a section is exact, one in space settles to this: the same arithmetic in another order, other units
#: or another place.
EXACTLY = 1e-6
#: The static bound is found to this: the last of its programs may move it by so much.
BOUND = 1e-4

quick = settings(
    max_examples=3,
    deadline=None,
    derandomize=True,
    phases=(Phase.explicit, Phase.generate),
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)
few = settings(quick, max_examples=2)

#: What leaves the factor as it is, several changes at a time: each is one analysis, and what any of them did to the
#: factor would show. With them the size of the scene.
SMALL, LARGE = 7.3e-3, 1e3
small, large = (partial(changes.scaled, by=by) for by in (SMALL, LARGE))
on_the_map = (
    changes.in_turn(changes.mirrored, changes.moved, changes.heavier, changes.reordered),
    1.0,
)
IN_SECTION = (on_the_map, (changes.in_turn(changes.with_rests, large), LARGE))
AS_COLUMNS = ((changes.in_turn(small, changes.heavier), SMALL),)
IN_SPACE = (on_the_map, (changes.in_turn(small, partial(changes.turned, by=123.4)), SMALL))


def hold(design, all_changes, rel: float = EXACTLY) -> None:
    for change, _ in all_changes:
        changes.same(changes.run(design), changes.run(change(design)), rel)


def at_its_limit(design, rel: float = EXACTLY) -> None:
    """With its strength divided by F it is just stable: F = 1, the same status, the same gap to the bound."""
    one = changes.run(design)
    assume(one.fos.limit is not None and 0.1 < one.fos.limit < 20.0)
    changes.same(
        one, changes.run(changes.reduced(design, one.fos.limit)), rel, times=1.0 / one.fos.limit
    )


def keeps_its_evidence(design) -> None:
    """Pushes only, forces that balance, a limit within its bound, control areas and their middles on every contact."""
    result = changes.run(design)
    if result.status == "not_converged":
        return
    assert result.limit_state.node_pairs.normal_kn.min(initial=0.0) >= 0.0
    assert (
        result.findings.checks["largest_unbalanced_force"] < 1e-6
    )  # `EACH_BALANCED` of the program
    if result.fos.limit and result.fos.static_bound:
        assert result.fos.limit <= result.fos.static_bound * (1.0 + 1e-9)
    if "solids" in design:
        return
    scene = cut(sk.load(design))
    loads = room.scene_loads(scene)
    model = whole_model(scene.assembly, loads, room.joint_strength(scene.strengths))
    assert model is not None
    patches = scene.assembly.patches
    real = model.joint_pairs
    area, contact = model.control_area[real] * model.area_scale, model.pair_contact[real]
    whole = patches.areas[model.patch]
    assert (area > 0.0).all()
    assert np.bincount(contact, area) == pytest.approx(whole, rel=1e-9)
    size = float(np.ptp(patches.corners, axis=0).max())
    for axis in range(
        3
    ):  # exact for linear traction: the middle of the pairs is that of the interface
        middle = np.bincount(contact, area * model.points[real, axis]) / whole
        assert middle == pytest.approx(patches.centroids[model.patch, axis], abs=1e-9 * size)


def more_strength_never_lowers_the_bound(design) -> None:
    """Forces that were admissible still are. (Not so for the limit: rough sides may let columns push harder.)"""
    bound = changes.run(design).fos.static_bound
    for name in design["strength"]:
        more = changes.run(changes.reduced(design, 0.8, only=name)).fos.static_bound
        if bound is not None and more is not None:
            assert more >= bound * (1.0 - BOUND)


# -- sections of polygons ---------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("family", SECTIONS.values(), ids=SECTIONS)
def test_a_section(family) -> None:
    @quick
    @given(design=family)
    def check(design) -> None:
        at_its_limit(design)
        keeps_its_evidence(design)
        hold(design, IN_SECTION)

    check()


@few
@given(design=stacks() | bonds())
def test_more_strength_never_lowers_the_bound_of_a_section(design) -> None:
    more_strength_never_lowers_the_bound(design)


@quick
@given(design=bolted(stacks() | rows() | shards() | bonds()))
def test_a_bolted_section(design) -> None:
    at_its_limit(design)
    keeps_its_evidence(design)
    hold(design, IN_SECTION)


# -- rows of columns --------------------------------------------------------------------------------------------------


@quick
@given(design=columns())
def test_a_row_of_columns(design) -> None:
    at_its_limit(design)
    keeps_its_evidence(design)
    more_strength_never_lowers_the_bound(design)
    hold(design, AS_COLUMNS)


# -- solids and benches -----------------------------------------------------------------------------------------------


@few
@given(design=bolted(bricks()))
def test_bolted_solids(design) -> None:
    at_its_limit(design)
    keeps_its_evidence(design)
    hold(design, IN_SPACE)


@few
@given(design=benches())
def test_a_bench(design) -> None:
    keeps_its_evidence(design)
    hold(design, IN_SPACE)
    one = changes.run(design)
    for change, size in IN_SPACE:
        other = changes.run(change(design))
        assert other.findings.blocks == one.findings.blocks
        assert other.geometry.volume_m3 == pytest.approx(size**3 * one.geometry.volume_m3, rel=1e-8)
