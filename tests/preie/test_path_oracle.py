"""The judges of `path_oracle` against closed forms and published figures, and slopekit against the judges."""

import math
from dataclasses import replace

import numpy as np
import pytest

from benchmarks import populations
from benchmarks.blocks import judged, report
from slopekit.preie.many_blocks.blocks import limit_of_blocks
from slopekit.preie.system.assembly import AssemblyModel
from tests.preie.block_scenes import boxes_in_space
from tests.preie.load_oracle import comes_on, tips_whatever_the_strength
from tests.preie.path_oracle import certified_range, history, model_of, static_bound, with_bonds
from tests.properties import changes
from tests.properties import test_not_unique as known


def tangent(degrees: float) -> float:
    return math.tan(math.radians(degrees))


def one_block(c: float = 0.0, phi: float = 35.0, dip: float = 30.0) -> tuple[AssemblyModel, float]:
    """A block 4 m by 1 m on an incline, and (c A + W cos β tan φ) / (W sin β)."""
    design = populations.turned_section(
        [[(0.0, 0.0), (4.0, 0.0), (4.0, 1.0), (0.0, 1.0)]], dip, phi
    )
    design["strength"]["joint"]["c"] = c
    return model_of(design), (
        c * 4.0 / 100.0 + math.cos(math.radians(dip)) * tangent(phi)
    ) / math.sin(math.radians(dip))


def uniquely_limited() -> dict[str, tuple[AssemblyModel, float]]:
    """Assemblies with one limit factor, by hand: blocks on inclines, and an active block that pushes a passive one."""
    stack = model_of(populations.stack(5)), tangent(35.0) / tangent(30.0)
    found = {"block": one_block(), "bonded block": one_block(c=5.0), "stack of 5": stack}
    for number in (1, 2, 6):
        design, factor = populations.active_passive(number)
        found[f"active, passive {number}"] = model_of(design), factor
    return found


UNIQUE = uniquely_limited()


# -- the static bound -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", UNIQUE)
def test_the_static_bound_of_what_has_one_limit_is_that(name) -> None:
    model, factor = UNIQUE[name]
    assert static_bound(model, 2e-8, factor) == pytest.approx(factor, rel=2e-7)


@pytest.mark.parametrize("name", ["W1", "W3"])
def test_the_static_bound_is_one_at_a_published_associated_multiplier(name) -> None:
    """Ferris & Tin-Loi (2001), to the five digits that are known of it."""
    wall = populations.WALLS[name]
    model = model_of(wall.design(wall.associated))
    assert len(model.moving) == wall.blocks
    assert static_bound(model, 1e-6, 1.0) == pytest.approx(1.0, rel=5e-5)


def test_the_static_bound_of_a_frame_is_one_at_its_published_multiplier() -> None:
    assert static_bound(model_of(populations.frame()), 1e-7, 1.0) == pytest.approx(1.0, rel=1e-6)


def test_the_static_bound_of_an_arch_is_what_its_least_friction_says() -> None:
    """Cocchetti & Rizzi (2020): μ = 0.309215, six digits; t/R = 0.1 is below Milankovitch's 0.1075."""
    assert static_bound(model_of(populations.arch())) == pytest.approx(0.6 / 0.309215, rel=2e-6)
    assert static_bound(model_of(populations.arch(0.1, 0.7))) is None


def test_the_static_bound_in_space() -> None:
    """A box on an incline with and without cohesion, by hand; a bench of the prototype of the path."""
    box = boxes_in_space((1, 1, 1), (4.0, 4.0, 1.0), 30.0)
    slides = tangent(35.0) / tangent(30.0)
    assert static_bound(box.model(35.0)) == pytest.approx(slides, rel=2e-5)
    bonded = 5.0 * 16.0 / (-box.forces[0, 2] * math.sin(math.radians(30.0)))
    assert static_bound(box.model(35.0, 5.0)) == pytest.approx(slides + bonded, rel=2e-5)
    assert static_bound(model_of(known.BENCH)) == pytest.approx(2.634, rel=2e-4)


def test_what_needs_no_strength_has_no_bound() -> None:
    assert static_bound(model_of(populations.stack(3, dip=0.0))) == math.inf


# -- a history --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", UNIQUE)
@pytest.mark.parametrize("stiffness", [0.4, 1.0])
def test_a_history_ends_at_the_only_limit_state(name, stiffness) -> None:
    model, factor = UNIQUE[name]
    found, _ = with_bonds(model, 2.0 / factor, stiffness)
    assert (found.end, found.factor) == ("settled", pytest.approx(factor, rel=1e-5))
    assert found.peak == pytest.approx(factor, rel=5e-3)  # the bracket of the descent


@pytest.mark.parametrize(
    ("design", "factor", "parts"),
    [
        (known.SHARDS, 3.749624, 5e-3),
        (known.BONDED_ROW, 1.535061, 5e-3),
        (known.TWO_BLOCKS, 0.529555, 0.015),
    ],
    ids=["shards", "bonded row", "two blocks"],
)
def test_a_history_ends_near_the_limit_of_the_elastic_path(design, factor, parts) -> None:
    """The prototype of the path, Simpson's points; the path knows no history, so that forces locked in by slip differ.

    Two blocks end 1.0 % lower: where blocks slide together what is locked in between
    them is not defined by the motion.
    """
    model = model_of(design)
    bound = static_bound(model)
    assert bound is not None
    found, _ = with_bonds(model, 2.0 / bound)
    assert (found.end, found.factor) == ("settled", pytest.approx(factor, rel=parts))


def with_ends_alone(model: AssemblyModel) -> AssemblyModel:
    """A section's model with two pairs a contact, half of its area each, instead of Simpson's three."""
    pairs = len(model.control_area)
    kept = np.arange(pairs) % 3 != 1
    rows = model.kinematics[
        np.append(np.flatnonzero(kept), np.arange(pairs, model.kinematics.shape[0]))
    ]
    sums = (
        np.repeat(model.by_group(model.control_area), 2) / 2.0,
        np.repeat(model.by_group(model.cohesion), 2) / 2.0,
    )
    return replace(
        model,
        pair_contact=model.pair_contact[kept],
        normal_rows=model.normal_rows[kept],
        control_area=sums[0],
        cohesion=sums[1],
        group_first=model.group_first // 3 * 2,
        points=model.points[kept],
        kinematics=rows,
        statics=rows.T.tocsr(),
    )


def test_a_history_of_columns_ends_at_their_closed_form() -> None:
    """Goodman & Bray's 16 columns with pairs at the ends of their contacts; their peak is up to 3 % higher.

    With Simpson's points less is locked in between columns that slide on each other and the history ends 0.8 % lower.
    """
    found = history(with_ends_alone(model_of(populations.goodman_bray())), 2.0 / 1.19)
    assert found.factor == pytest.approx(populations.goodman_bray_factor(), rel=1e-3)
    assert 0.99 < (found.peak or 0.0) < 1.04


def test_a_history_in_space_of_a_block_in_torsion() -> None:
    """μ W a 0.3826 / M = 2.2956: friction about the middle of a square; the sixteenths of its base leave 0.11 %."""
    scene = boxes_in_space((1, 1, 1), (2.0, 2.0, 2.0), 0.0)
    weight = -scene.forces[0, 2]
    twist = (
        tangent(35.0)
        * weight
        * 2.0
        * (math.sqrt(2.0) + math.log(1.0 + math.sqrt(2.0)))
        / 6.0
        / 2.2956
    )
    twisted = replace(scene, moments=np.array([[0.0, 0.0, twist]]))
    assert history(twisted.model(35.0, refine=2), 1.0).factor == pytest.approx(2.2956, rel=2e-3)
    assert history(twisted.model(35.0), 1.0).factor == pytest.approx(
        math.sqrt(2.0), rel=1e-4
    )  # five pairs


@pytest.mark.parametrize(
    ("width", "strength", "tips"), [(1.0, 1.0, True), (1.0, 9.0, True), (4.0, 1.0, False)]
)
def test_what_comes_on_of_a_push_on_a_block_on_level_ground(width, strength, tips) -> None:
    """2 m high, φ = 40°, pushed by 0.9 of its weight: it tips at b / h, or slides at tan 40°.

    Tipping about its toe is a limit state whatever the strength; sliding is none.
    """
    design = populations.turned_section(
        [[(0.0, 0.0), (width, 0.0), (width, 2.0), (0.0, 2.0)]], 0.0, 40.0
    )
    model = model_of(design | {"loads": {"seismic": {"k": 0.9, "toward": 270.0}}})
    exact = (width / 2.0 if tips else tangent(40.0)) / 0.9
    assert comes_on(model, strength) == pytest.approx(exact - 1e-3, abs=1e-3)
    motions = [
        np.array([[-1.0, width / 2.0, turn]]) for turn in (1.0, 0.0, -1.0)
    ]  # of its middle, about its toe
    holds = [tips_whatever_the_strength(model, motion, exact, strength) for motion in motions]
    assert sum(holds) == tips
    assert not any(
        tips_whatever_the_strength(model, motion, 0.99 * exact, strength) for motion in motions
    )


def test_what_no_friction_holds_has_no_history() -> None:
    found = history(
        model_of(populations.turned_section([[(0, 0), (1, 0), (1, 3), (0, 3)]], 30.0, 35.0)), 1.0
    )
    assert (found.factor, found.end) == (None, "no rest at the start")


# -- every limit state ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["block", "bonded block", "active, passive 1"])
def test_the_certified_range_of_one_limit_is_a_point(name) -> None:
    model, factor = UNIQUE[name]
    found = certified_range(model, factor)
    assert found is not None
    assert found.lowest <= factor <= found.highest
    assert (found.lowest, found.highest) == (
        pytest.approx(factor, rel=3e-4),
        pytest.approx(factor, rel=3e-4),
    )


@pytest.mark.slow
def test_two_blocks_have_a_continuum_of_limits() -> None:
    """A global solver (docs/method.md) proves [0.52049, 0.52955]. The history and slopekit end inside."""
    model = model_of(known.TWO_BLOCKS)
    bound = static_bound(model)
    assert bound is not None
    found = certified_range(model, bound)
    assert found is not None
    assert (found.lowest, found.highest) == (
        pytest.approx(0.52049, rel=2e-4),
        pytest.approx(0.52955, rel=2e-4),
    )
    ours, slack = changes.run(known.TWO_BLOCKS).fos, 1e-4  # the certificate is that wide
    for factor in (history(model, 2.0 / bound).factor, ours.limit):
        assert factor is not None
        assert found.lowest <= factor <= found.highest
    assert (
        found.lowest * (1.0 - slack) <= ours.lowest <= ours.highest <= found.highest * (1.0 + slack)
    )


# -- slopekit before them ---------------------------------------------------------------------------------------------

SECTIONS = [2, 7, 16]  # without cohesion; the same numbers, whatever solves them


@pytest.mark.parametrize("number", SECTIONS)
def test_random_sections_end_where_a_history_does(number) -> None:
    """0.5 %, as nine in ten do (38 of 42 with the prototype of the path, 65 of 72 in its first comparison).

    Of the first dozen without cohesion 5 and 9 are left out: their limit states are far apart (0.586 and 0.504 by
    passes, 0.635 and 0.517 by a history, 0.644 and 0.517 by the path).
    """
    design = populations.section(number)
    model = model_of(design)
    found = changes.run(design).fos
    bound = static_bound(model, 1e-6, found.static_bound)
    assert bound is not None
    assert found.limit is not None
    assert found.limit <= bound * (1.0 + 1e-4)
    assert found.static_bound == pytest.approx(bound, rel=1e-4)
    assert found.limit == pytest.approx(history(model, 2.0 / bound).factor, rel=5e-3)


def test_no_factor_is_above_the_static_bound_of_all_blocks() -> None:
    """A frame at 0.9 of its published associated multiplier. (Walls: test_path.py.)"""
    design = populations.frame()
    for push in design["loads"].get("forces", ()):
        push["force"] = [0.9 * part for part in push["force"]]
    model = model_of(design)
    found = limit_of_blocks(model, ranged=False)
    bound = static_bound(model, 1e-6, found.static_bound)
    assert bound is not None
    assert found.static_bound == pytest.approx(bound, rel=1e-4)
    assert (found.factor or 0.0) <= bound * (1.0 + 1e-4)


@pytest.mark.parametrize("number", [7])
def test_random_benches_are_not_above_the_static_bound_of_all_blocks(number) -> None:
    design = populations.bench(number)
    found = changes.run(design).fos
    bound = static_bound(model_of(design), 1e-5, found.static_bound)
    assert bound is not None
    assert found.limit is not None
    assert found.limit <= bound * (1.0 + 1e-4)
    assert found.static_bound == pytest.approx(bound, rel=1e-4)


def test_designs_are_the_same_every_time_and_can_be_judged() -> None:
    walls = [populations.wall(number) for number in range(40)]
    assert walls == [populations.wall(number) for number in range(40)]
    assert {len(wall["blocks"]) - 1 for wall in walls} <= set(range(5, 24))
    assert populations.bench(0) == populations.bench(0)
    one = judged(("walls", 0, False))
    assert one.program == pytest.approx(one.first.bound, rel=1e-5)
    assert one.other == pytest.approx(dict.fromkeys(one.other, one.first.factor), rel=1e-5)
    assert "a number: 1 of 1" in report([one])
    tips = judged(("walls", 37, True))
    assert (tips.first.factor, tips.rests) == (None, None)
    assert tips.tips == pytest.approx(0.8640, abs=1e-4)
    assert "proved by a motion without slip: 1\n" in report([one, tips])
