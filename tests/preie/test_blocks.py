"""The limit of many blocks against closed forms, symmetries and its own bound."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog

from slopekit.closed_form.blocks import two_blocks
from slopekit.closed_form.toppling import ColumnSlope, toppling_factor_of_safety
from slopekit.preie.blocks import BlocksLimit, limit_of_blocks
from slopekit.preie.passes import Outcome
from tests.preie import assembly_oracle
from tests.preie.block_scenes import (
    GOODMAN_BRAY,
    Scene,
    active_passive,
    bench,
    boxes_in_space,
    columns,
    random_bench,
    stack,
    turned_about_vertical,
    wall,
)

TWO_BLOCKS = [(0.0, 0.0, 3.291798), (10.0, 0.0, 1.941039), (0.0, 10.0, 4.070999)]  # 7c_two_block_1, 2 and 6
BENCH = (("45/170", 7.0), ("80/350", 8.0), ("85/80", 8.0))

CLOSER = (("45/170", 6.0), ("80/350", 7.0), ("85/80", 7.0))


def tangent(degrees: float) -> float:
    return math.tan(math.radians(degrees))


def holds(found: BlocksLimit, factor: float, parts: float) -> None:
    """The factor, below a bound and settled."""
    assert found.outcome is Outcome.SLIDES
    assert found.factor == pytest.approx(factor, rel=parts)
    assert found.static_bound is not None
    assert found.factor <= found.static_bound


# -- closed forms -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("per_course", [10, 100])
def test_a_long_wall_slides_on_its_base(per_course) -> None:
    """tan 35° / tan 20°; the elastic bed in the program raises the load factor by 1e-5 at most."""
    found = limit_of_blocks(wall(10, per_course).model(35.0))
    holds(found, tangent(35) / tangent(20), 1e-5)
    assert found.static_bound == pytest.approx(tangent(35) / tangent(20), rel=1e-5)


@pytest.mark.parametrize(("count", "width"), [(3, 2.0 * 3), (100, 300.0)])
def test_a_stack_on_an_incline(count, width) -> None:
    """tan 35° / tan 30°, whichever joints slip."""
    holds(limit_of_blocks(stack(count, width=width).model(35.0)), tangent(35) / tangent(30), 1e-6)


def test_a_stack_whose_base_is_rougher() -> None:
    """Joints at 31°, the base at 40°: the second joint from below slides, tan 31° / tan 30°; the lowest block stays."""
    found = limit_of_blocks(stack(5, width=12.0, joint_of_base=1).model([31.0, 40.0]))
    holds(found, tangent(31) / tangent(30), 1e-6)
    moves = np.abs(found.velocity).max(axis=1)
    assert moves[0] < 1e-3  # what the elastic bed gives
    assert moves[-1] == pytest.approx(1.0)


@pytest.mark.parametrize(("passive_dip", "c", "factor"), TWO_BLOCKS)
def test_an_active_block_pushes_a_passive_one(passive_dip, c, factor) -> None:
    """cases.json 7c_two_block_1, 2 and 6: forces by hand. The interface is smooth and without cohesion."""
    scene = active_passive(passive_dip)
    found = limit_of_blocks(scene.model([30.0, 30.0, 0.0], [c, c, 0.0]))
    holds(found, factor, 1e-5)
    bases = 50.0**0.5, 10.0 / math.cos(math.radians(passive_dip))
    exact = two_blocks(tuple(-scene.forces[:, 2]), (45.0, passive_dip), bases, (30.0, 30.0), (c, c))
    assert found.factor == pytest.approx(exact.factor, rel=1e-5)
    assert (found.bond == 1.0).all()


@pytest.mark.parametrize("dip", [20.0, 45.0, 60.0])
@pytest.mark.parametrize("space", [False, True])
def test_a_block_alone_tips_at_its_geometric_limit(dip, space) -> None:
    """b / h = tan β: a hair lower it slides at tan φ / tan β, a hair higher nothing holds it and it turns."""
    for ratio, stands in ((1.0 + 1e-3, True), (1.0 - 1e-3, False)):
        height = 2.0 / tangent(dip) / ratio
        scene = boxes_in_space((1, 1, 1), (2.0, 3.0, height), dip) if space else stack(1, dip, 2.0, height)
        found = limit_of_blocks(scene.model(70.0))
        if stands:
            holds(found, tangent(70) / tangent(dip), 1e-5)
        else:
            assert found.outcome is Outcome.LIFTED
            assert found.factor is None
            if not space:  # in space it may fly off as well as turn: both open its base
                assert found.velocity[0, 2] == pytest.approx(-1.0) or abs(found.velocity[0, 2]) > 0.2


@pytest.mark.parametrize("scene", [stack(2, dip=0.0, width=6.0), boxes_in_space((2, 1, 2), (2.0, 2.0, 1.0), 0.0)])
def test_nothing_drives_blocks_on_level_ground(scene) -> None:
    found = limit_of_blocks(scene.model(30.0))
    assert found.outcome is Outcome.NO_DRIVING_FORCE
    assert found.factor is None


@pytest.mark.parametrize("scene", [stack(1, width=5.0), wall(2, 2), wall(4, 4)])
def test_blocks_pulled_off_the_ground_are_lifted(scene) -> None:
    assert limit_of_blocks(replace(scene, forces=-scene.forces).model(30.0)).outcome is Outcome.LIFTED


# -- columns ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("risers", "bound"), [(False, 1.1892), (True, 1.19089)])
def test_goodman_and_bray(risers, bound) -> None:
    """16 columns (5a_goodman_bray): the closed form 0.99996; bounds by LP, 1.19089 with the steps' sides in contact.

    Columns 4 to 13 turn about their lower edge and lift off at the upper one, 1 to 3 slide, 14 to 16 stand.
    """
    exact = toppling_factor_of_safety(ColumnSlope(GOODMAN_BRAY, 10.0, 1.0, 30.0, 25.0, 38.15)).factor
    model = columns(risers=risers).model(38.15)
    found = limit_of_blocks(model)
    holds(found, exact, 1e-5)
    assert found.static_bound == pytest.approx(bound, abs=1e-4)
    size = np.abs(found.velocity).max(axis=1)
    turns = np.abs(found.velocity[:, 2]) > 1e-3 * np.abs(found.velocity).max()
    modes = ["stable" if s < 1e-4 else "topple" if t else "slide" for s, t in zip(size, turns, strict=True)]
    assert modes == 3 * ["slide"] + 10 * ["topple"] + 3 * ["stable"]
    opening, _ = model.opening_and_slip(found.velocity)
    base = (model.minus < 0) & (np.arange(len(model.minus)) < 16)
    ends = opening[base[model.pair_contact]].reshape(16, 2)
    assert (ends[3:13].max(axis=1) > 1e-3).all()  # lifts off at one end,
    assert ends[3:13].min(axis=1) == pytest.approx(0.0, abs=1e-3)  # turns about the other
    assert np.abs(ends[:3]).max() < 1e-3


@pytest.mark.parametrize("phi", [33.0, 38.6598, 45.0])
def test_columns_at_other_strengths(phi) -> None:
    """F = tan φ / tan 38.1512°: all strength is friction."""
    exact = toppling_factor_of_safety(ColumnSlope(GOODMAN_BRAY, 10.0, 1.0, 30.0, 25.0, phi)).factor
    assert limit_of_blocks(columns().model(phi)).factor == pytest.approx(exact, rel=1e-5)


def test_slender_columns() -> None:
    """The outline of Goodman & Bray's slope in 64 columns: they topple at 0.48324, all bases hold (closed form)."""
    heights = np.interp(np.linspace(0.0, 15.0, 64), np.arange(16), GOODMAN_BRAY)
    width, step = 150.0 / 63.0, 15.0 / 63.0
    exact = toppling_factor_of_safety(ColumnSlope(heights, width, step, 30.0, 25.0, 38.15))
    assert exact.table.base_holds.all()
    found = limit_of_blocks(columns(heights, width, step).model(38.15))
    assert found.outcome is Outcome.NOT_CONVERGED or found.factor == pytest.approx(exact.factor, rel=1e-3)


def test_rows_that_do_not_touch_have_the_factor_of_one() -> None:
    """Three rows of columns side by side: one model, three components."""
    found = limit_of_blocks(columns(rows=3).model(38.15))
    assert found.factor == pytest.approx(0.99996, abs=1e-4)
    assert found.factor <= found.static_bound


# -- cohesion ---------------------------------------------------------------------------------------------------------


def test_cohesion_of_a_plane_that_slides_counts_in_full() -> None:
    """F = (c A + W cos β tan φ) / (W sin β)."""
    weight, dip = 25.0 * 8.0, math.radians(30.0)
    exact = (5.0 * 8.0 + weight * math.cos(dip) * tangent(20)) / (weight * math.sin(dip))
    found = limit_of_blocks(stack(1, width=8.0).model(20.0, 5.0))
    holds(found, exact, 1e-6)
    assert (found.bond == 1.0).all()


def test_cohesion_of_a_joint_that_opens_is_lost() -> None:
    """Two blocks side by side: the lower base is smooth, and their joint, bonded along the slip, opens without work.

    The lower block leaves at F = 0: nothing drives the upper one. With friction 10° below the lower and 35° below the
    upper one it goes alone, at tan 10° / tan 30°, and the cohesion of the joint between them is gone.
    """
    scene = boxes_in_section_side_by_side()
    found = limit_of_blocks(scene.model([35.0, 10.0, 30.0], [0.0, 0.0, 50.0]))
    holds(found, tangent(10) / tangent(30), 1e-5)
    model = scene.model([35.0, 10.0, 30.0], [0.0, 0.0, 50.0])
    between = (model.minus >= 0)[model.pair_contact]
    assert (found.bond[between] == 0.0).all()
    assert (found.bond[~between] == 1.0).all()


def test_a_wall_that_cohesion_alone_holds() -> None:
    """F = c A / (W sin β) on the base, 5 x 20 / (25 x 200 x sin 20°)."""
    found = limit_of_blocks(wall(10, 10).model(0.0, 5.0))
    holds(found, 5.0 * 20.0 / (25.0 * 200.0 * math.sin(math.radians(20.0))), 1e-4)


def test_no_strength_at_all() -> None:
    """φ = 0 and c = 0: an answer, not a number out of range."""
    assert limit_of_blocks(wall(10, 10).model(0.0)).factor is None


def test_more_cohesion_is_never_less_safe() -> None:
    """On a bench with a small light block: the cohesion of its base, which slides and stays pressed, is its own.

    Without cohesion it slides at tan 30° / tan 45°, with 1 kPa nothing moves before 0.7.
    """
    assert limit_of_blocks(bench(BENCH).model(30.0, 1.0)).factor > 1.1 * tangent(30) / tangent(45)


def boxes_in_section_side_by_side() -> Scene:
    """Two low blocks on an incline of 30°; joints: 0 below the upper, 1 below the lower, 2 between them."""
    scene = wall(1, 2, dip=30.0, width=3.0)
    patches = scene.patches
    lower = int(np.argmin(scene.centroids[:, 2]))
    joint = np.where(patches.minus >= 0, 2, np.where(patches.plus == lower, 1, 0))
    return replace(scene, patches=replace(patches, joint=joint))


# -- what does not matter ---------------------------------------------------------------------------------------------


SCENES = {
    "wall": (wall(6, 4), 35.0, 0.0),
    "columns": (columns(), 38.15, 0.0),
    "boxes": (boxes_in_space((2, 2, 2), (2.0, 3.0, 1.0), 25.0, 0.3), 35.0, 1.0),
    "bench": (bench(BENCH), 30.0, 0.0),
}


@pytest.fixture(scope="module", params=SCENES)
def known(request) -> tuple[Scene, float, float, BlocksLimit]:
    scene, phi, c = SCENES[request.param]
    return scene, phi, c, limit_of_blocks(scene.model(phi, c))


def same(found: BlocksLimit, known: BlocksLimit, parts: float = 3e-6) -> None:
    """Ten times what the method calls settled (3e-7): another frame rounds, and steps, otherwise."""
    assert found.outcome is known.outcome
    assert found.factor == pytest.approx(known.factor, rel=parts)
    if known.static_bound is not None and found.static_bound is not None:
        assert found.static_bound == pytest.approx(known.static_bound, rel=parts)


def test_units_do_not_matter(known) -> None:
    """m and kN to km and MN: kPa become GPa."""
    scene, phi, c, reference = known
    in_km = scene.mapped(length=1e-3, force=1e-3)
    same(limit_of_blocks(in_km.model(phi, c * 1e-3 / 1e-6)), reference)


def test_a_mirror_image_is_as_safe(known) -> None:
    scene, phi, c, reference = known
    same(limit_of_blocks(scene.mapped(np.diag([-1.0, 1.0, 1.0])).model(phi, c)), reference)


@pytest.mark.parametrize("angle", [31.0, 180.0])
def test_the_compass_does_not_matter(known, angle) -> None:
    scene, phi, c, reference = known
    if not scene.in_section or angle == 180.0:
        same(limit_of_blocks(scene.mapped(turned_about_vertical(angle)).model(phi, c)), reference)


def test_the_place_does_not_matter(known) -> None:
    """500 km east and 4,000 km north: coordinates keep 1e-9 m."""
    scene, phi, c, reference = known
    moved = scene.mapped(shift=(5e5, 0.0, 300.0) if scene.in_section else (5e5, 4e6, 300.0))
    same(limit_of_blocks(moved.model(phi, c)), reference, 1e-5)


def test_the_numbering_of_blocks_and_contacts_does_not_matter(known) -> None:
    scene, phi, c, reference = known
    rng = np.random.default_rng(3)
    name = rng.permutation(len(scene))
    inverse, patches = np.argsort(name), scene.patches
    renamed = replace(
        scene, centroids=scene.centroids[inverse], forces=scene.forces[inverse], fixed=scene.fixed[inverse],
        patches=replace(
            patches, plus=name[patches.plus], minus=np.where(patches.minus < 0, -1, name[patches.minus])
        ),
    )  # fmt: skip
    same(limit_of_blocks(renamed.model(phi, c)), reference)


def test_a_block_that_touches_nothing_changes_nothing(known) -> None:
    scene, phi, c, reference = known
    same(limit_of_blocks(scene.with_untouched_block().model(phi, c)), reference)


def test_strength_reduced_by_the_factor_leaves_one(known) -> None:
    scene, phi, c, reference = known
    reduced = math.degrees(math.atan(tangent(phi) / reference.factor))
    assert limit_of_blocks(scene.model(reduced, c / reference.factor)).factor == pytest.approx(1.0, abs=1e-5)


def test_more_strength_is_never_less_safe(known) -> None:
    scene, phi, c, reference = known
    assert limit_of_blocks(scene.model(phi + 1.0, 1.1 * c)).factor > reference.factor


# -- what a limit state is --------------------------------------------------------------------------------------------


LIMITS = SCENES | {
    "stack": (stack(6, width=20.0), 35.0, 2.0),
    "rough wall": (wall(12, 4), 40.0, 0.0),
    "bench of scattered joints": (bench(BENCH, scatter=3.0, seed=4), 30.0, 0.0),
    "cohesive columns": (columns(), 38.15, 10.0),
}


@pytest.mark.parametrize("name", LIMITS)
def test_the_answer_is_a_limit_state(name) -> None:
    """Balance, strength, contact and flow with zero dilation, checked one by one; 2e-3: the give of the elastic bed.

    Work: what the loads do on the mechanism is what friction takes, λ Σ (c A + μ N) |slip|.
    """
    scene, phi, c = LIMITS[name]
    model = scene.model(phi, c)
    found = limit_of_blocks(model)
    assert found.outcome is Outcome.SLIDES
    assert found.factor <= (found.static_bound or math.inf)
    load = float(np.abs(model.load).max())
    assert np.abs(model.forces_on_blocks(found.normal_force, found.friction) + model.load).max() < 1e-5 * load
    assert (found.normal_force >= 0.0).all()
    strength = model.by_group(model.cohesion * found.bond) + model.tan_friction * model.by_group(found.normal_force)
    opening, slip = model.opening_and_slip(found.velocity)
    fastest = max(float(np.abs(opening).max()), float(np.abs(slip).max()))
    opening, slip = opening / fastest, slip / fastest
    size = np.sqrt((slip * slip).sum(axis=1))
    carried = np.sqrt((found.friction**2).sum(axis=1)) * found.factor
    slack = 2e-3 * max(1.0, float(strength.mean()))
    assert (carried <= strength + 1e-4 * strength.mean()).all()
    assert opening.min() > -2e-3
    pressed = found.normal_force / found.normal_force.max()
    assert np.minimum(pressed, np.abs(opening)).max() < 2e-3  # a pair presses or opens
    assert ((strength - carried) * size).max() < slack
    taken = (found.friction * slip).sum(axis=1) * found.factor
    assert np.abs(taken + strength * size).max() < slack  # friction opposes the slip
    work = float((model.load * found.velocity).sum()) / fastest
    assert work == pytest.approx(float((strength * size).sum()) / found.factor, rel=2e-2)


@pytest.mark.parametrize("name", ["stack", "columns", "boxes"])
def test_the_limit_against_a_conic_sequence(name) -> None:
    """METHOD.md §4 with Clarabel: friction frozen at the last normal forces, until the factor stays (1e-4).

    Such a sequence creeps: of the columns METHOD.md has 0.9976 to 1.0019 of it, hence 2e-3.
    """
    scene, phi, c = LIMITS[name]
    model = scene.model(phi, c)
    assert limit_of_blocks(model).factor == pytest.approx(assembly_oracle.conic_sequence(model).factor, rel=2e-3)


# -- benches ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", [3, 6, 8, 12, 17, 22])
def test_random_benches(seed) -> None:
    """Three random sets, 20 to 200 blocks: an answer, no higher than its bound; strength reduced by F leaves 1."""
    scene, phi = random_bench(seed)
    model = scene.model(phi)
    found = limit_of_blocks(model)
    assert found.outcome is Outcome.SLIDES
    assert found.static_bound is not None
    assert found.factor <= found.static_bound
    reduced = math.degrees(math.atan(tangent(phi) / found.factor))
    assert limit_of_blocks(scene.model(reduced)).factor == pytest.approx(1.0, abs=2e-4)


def slides_alone(scene: Scene, phi: float) -> float:
    """The least factor of a block, touched by bedrock alone, that slides on one plane or two without turning.

    Hoek & Bray: N from the balance across the slip, F = tan φ Σ N / (W · v). The slip v closes no contact, and normal
    forces on the corners of the planes that slide balance the moments too (linear program): a limit state.
    """
    patches, down, least = scene.patches, np.array([0.0, 0.0, -1.0]), math.inf
    for block in np.flatnonzero(~scene.fixed):
        mine = np.flatnonzero((patches.plus == block) | (patches.minus == block))
        others = np.where(patches.plus[mine] == block, patches.minus[mine], patches.plus[mine])
        if not np.append(scene.fixed, True)[others].all():
            continue
        normals = patches.normals[mine] * np.where(patches.plus[mine] == block, 1.0, -1.0)[:, None]
        planes = np.unique(normals.round(9), axis=0)
        for i, j in itertools.combinations_with_replacement(range(len(planes)), 2):
            base = planes[sorted({i, j})]
            slip = down - (down @ base[0]) * base[0] if i == j else np.cross(*base)
            if np.linalg.norm(slip) < 1e-6 or (planes @ slip * np.sign(slip[2]) > 1e-9).any():
                continue
            slip = -slip * np.sign(slip[2]) / np.linalg.norm(slip)
            push = np.linalg.solve(base @ base.T, -base @ down)
            if slip @ down < 1e-9 or (push <= 0.0).any():
                continue
            factor = tangent(phi) * push.sum() / (slip @ down)
            points, forces = [], []
            for k, normal in zip(mine, normals, strict=True):
                if (np.abs(base - normal).max(axis=1) < 1e-6).any():
                    corners = patches.corners[patches.first[k] : patches.first[k + 1]] - scene.centroids[block]
                    points.append(corners)
                    forces.append(np.tile(normal - tangent(phi) / factor * slip, (len(corners), 1)))
            arms, forces = np.concatenate(points), np.concatenate(forces)
            wrench = np.vstack([forces.T, np.cross(arms, forces).T])
            if linprog(np.zeros(len(arms)), A_eq=wrench, b_eq=[0, 0, 1, 0, 0, 0], bounds=(0, None)).status == 0:
                least = min(least, float(factor))
    return least


@pytest.mark.parametrize("seed", [1, 8, 18, 24, 25, 27, 50, 58, 65, 80])
def test_a_block_that_can_slide_alone_does(seed) -> None:
    """The limit is no higher than that of any one block by itself, however its other contacts could wedge it.

    That block governs, and the two agree: 5e-4 is what settled passes may differ by.
    """
    scene, phi = random_bench(seed)
    alone = slides_alone(scene, phi)
    assert limit_of_blocks(scene.model(phi)).factor == pytest.approx(alone, rel=5e-4)


def test_a_factor_that_light_blocks_do_not_carry_is_none() -> None:
    """A light block nearly wedged: the passes agree at 3.5, Clarabel's bound is 1.784; its forces give it away."""
    scene, phi = random_bench(5)
    model = scene.model(phi)
    found = limit_of_blocks(model)
    bound = assembly_oracle.static_bound(model, 0.5, 10.0, 1e-3)
    assert found.outcome is Outcome.NOT_CONVERGED or found.factor <= bound


HARD = {1: random_bench(1), 7: random_bench(7), 19: random_bench(19), "closer": (bench(CLOSER), 30.0)}


@pytest.mark.parametrize("name", HARD)
def test_benches_whose_bound_is_hard(name) -> None:
    """Joints that nearly lock, where the method for the bound creeps: the limit lies below Clarabel's bound anyhow."""
    scene, phi = HARD[name]
    model = scene.model(phi)
    found = limit_of_blocks(model)
    assert found.outcome is Outcome.SLIDES
    assert found.factor <= assembly_oracle.static_bound(model, 0.5, 50.0, 1e-3) * (1.0 + 1e-3)
    if found.static_bound is None:
        pytest.xfail("no bound: its complementarity stops falling")
    assert found.factor <= found.static_bound


# -- regression: numbers of slopekit itself ---------------------------------------------------------------------------


def test_regression_square_wall() -> None:
    """32 x 32 blocks: part of the wall turns. No closed form; 1.5238 and the bound 1.55324 are slopekit's own.

    Its normal forces are not unique: where Newton does not settle the passes stop within some 1e-3.
    """
    found = limit_of_blocks(wall(32, 32).model(35.0))
    holds(found, 1.5238, 2e-3)
    assert found.static_bound == pytest.approx(1.55324, rel=1e-4)
