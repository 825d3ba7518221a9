"""The cracked base against hand calculations of dams, against thousands of separate springs, and against itself."""

import math
from itertools import pairwise

import numpy as np
import pytest

import slopekit as sk
from benchmarks.moments import beside, has_passive_bolts, lower_of_both
from benchmarks.wedge_paths import as_assembly
from slopekit.geometry.interfaces import BEDROCK, NodePairs, node_pairs
from slopekit.kinds import cut, factors_of, wedge
from slopekit.kinds.single_block.one_block_limit import FoundLimit, moment_limit
from slopekit.kinds.wedge.cutting import J1, J2
from slopekit.kinds.wedge.design import wedge_design
from slopekit.loads import Loads
from slopekit.preie.many_blocks.blocks import limit_of_blocks
from slopekit.preie.one_block import bed_path
from slopekit.preie.one_block.bed_limits import SPLITS, BedLimits, BedStatus, bed_limits
from slopekit.preie.one_block.flat_limit import flat_limit
from slopekit.preie.one_block.polygon_bed import Beds, BedSprings, Unbalanced, elastic_bed
from slopekit.preie.system.model import JointStrength, build_model
from slopekit.result import Result
from tests.preie.cracked_oracle import Block, springs_on
from tests.properties.test_not_unique import two_paths
from tests.support import random_wedge

WIDTH, WEIGHT = 8.0, 2400.0  # m, kN per metre of dam


def limit_on(bed: Beds, guess: float, splits: tuple[int, ...] = SPLITS) -> BedLimits:
    """The limit on a bed, no slide of the forces alone known."""
    return bed_limits(bed, np.append(np.zeros(bed.load.shape[1]), 1.0 / guess)[None], splits)


def factor_on(bed: Beds, guess: float, split: int) -> float:
    """The limit factor with triangles that are split so often, not a number without one."""
    return float(limit_on(bed, guess, (split,)).factor[0])


def corner_motions(bed: Beds, k: int) -> np.ndarray:
    """Opening and slips (j, 3, u) of the corners of a contact per unknown."""
    moved = [bed.motions(motion[None]) for motion in np.eye(bed.load.shape[1])]
    return np.stack(moved, axis=2)[bed.corner[k] : bed.corner[k + 1]]


def unbalanced(
    springs: BedSprings, opening, slip, reduction: float, running=False, sticks=False
) -> Unbalanced:
    """The forces on the one block on these springs."""
    one = np.zeros(1, dtype=np.int64)
    at = springs.unbalanced(one, opening[None], slip[None], np.array([reduction]), running, sticks)
    return Unbalanced(at.force[0], at.by_opening[0], at.by_slip[0], at.by_reduction[0])


def dam(
    eccentricity: float, c: float, phi: float, thrust: float, in_section: bool, dip: float = 0.0
) -> Beds:
    """A block 8 m wide on a base that dips toward +x; its resultant meets the base so far downstream of the middle.

    Along the base `thrust` kN act, across it `WEIGHT`; the moment is such that the resultant has its eccentricity.
    """
    a = math.radians(dip)
    along, up = (
        np.array([math.cos(a), 0.0, -math.sin(a)]),
        np.array([math.sin(a), 0.0, math.cos(a)]),
    )
    across = np.array([0.0, 1.0, 0.0])
    centroid = 5.0 * up
    force = thrust * along - WEIGHT * up
    # moment about the centroid of the resultant through the point `eccentricity` on the base
    moment = np.cross(eccentricity * along - centroid, force)
    none = np.zeros((0, 3))
    loads = Loads(force, moment, {"weight": force}, none, none)
    one = np.ones(1)
    strength = JointStrength(c * one, math.tan(math.radians(phi)) * one, 0.0 * one, 0.0 * one)
    ends = [x * along for x in (-WIDTH / 2, WIDTH / 2)]
    if in_section:
        points = np.array([ends[1], (ends[0] + ends[1]) / 2.0, ends[0]])
        areas = np.array([1.0, 4.0, 1.0]) / 6.0 * WIDTH
        pairs = NodePairs(
            points,
            np.tile(up, (3, 1)),
            areas,
            np.zeros(3, dtype=np.int64),
            np.zeros(3, dtype=np.int64),
            np.full(3, BEDROCK),
        )
        polygon = np.array(ends[::-1])
    else:
        polygon = np.array(
            [ends[0] - across / 2, ends[0] + across / 2, ends[1] + across / 2, ends[1] - across / 2]
        )
        pairs = node_pairs({0: polygon})
    return elastic_bed(
        build_model(pairs, loads, centroid, strength, in_section=in_section), {0: polygon}, centroid
    )


@pytest.mark.parametrize("in_section", [True, False])
@pytest.mark.parametrize("dip", [0.0, 17.0])
@pytest.mark.parametrize("eccentricity", [0.0, 1.2, 4.0 / 3.0, 1.5, -2.0, 3.0, 3.9])
def test_a_dam_on_its_base(eccentricity, dip, in_section) -> None:
    """USACE EM 1110-2-2200 and USBR: the base is whole within the middle third, else L = 3 (B/2 - e) of it is pressed.

    The traction is 2 N / L at the toe, the sliding factor (c L + N tan φ) / T. Exact.
    """
    c, phi, thrust = 150.0, 40.0, 1500.0
    bed = dam(eccentricity, c, phi, thrust, in_section, dip)
    found = limit_on(bed, 1.0)
    pressed = min(WIDTH, 3.0 * (WIDTH / 2.0 - abs(eccentricity)))
    toe = (
        WEIGHT / WIDTH * (1.0 + 6.0 * abs(eccentricity) / WIDTH)
        if pressed == WIDTH
        else 2.0 * WEIGHT / pressed
    )
    assert found.factor[0] == pytest.approx(
        (c * pressed + WEIGHT * math.tan(math.radians(phi))) / thrust, rel=1e-9
    )
    assert found.status[0] == BedStatus.RUNS
    at = found.displacement[0], found.velocity[0], found.reduction[0]
    assert np.abs(unbalanced(BedSprings(bed, 3), *at, True).force).max() < 1e-12
    forces = found.point_forces(bed)
    assert forces.area[forces.pressed].sum() == pytest.approx(pressed / WIDTH, rel=1e-9)
    scale = math.hypot(WEIGHT, thrust) / WIDTH
    assert (forces.normal / forces.area).max() * scale == pytest.approx(toe, rel=1e-9)


@pytest.mark.parametrize("in_section", [True, False])
def test_a_dam_beyond_its_edge_does_not_rest(in_section) -> None:
    assert math.isnan(factor_on(dam(4.001, 150.0, 40.0, 1500.0, in_section), 1.0, 3))


@pytest.mark.parametrize("phi", [0.0, 30.0])
def test_a_square_base_in_torsion(phi) -> None:
    """A torque about the normal of an evenly pressed square: (c + σ tan φ) 0.38260 b³ / T (polar integral of |r|).

    ∫ |r| over a unit square is (√2 + ln(1 + √2)) / 6. No closed form of the pairs: it converges with the triangles.
    """
    square = np.array([[-1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [1.0, -1.0, 0.0]])
    torque, load, c = 900.0, 800.0, 120.0
    none, one = np.zeros((0, 3)), np.ones(1)
    force = np.array([0.0, 0.0, -load])
    loads = Loads(force, np.array([0.0, 0.0, torque]), {"weight": force}, none, none)
    strength = JointStrength(c * one, math.tan(math.radians(phi)) * one, 0.0 * one, 0.0 * one)
    model = build_model(node_pairs({0: square}), loads, np.array([0.0, 0.0, 1.0]), strength)
    bed = elastic_bed(model, {0: square}, np.array([0.0, 0.0, 1.0]))
    exact = (
        (c + load / 4.0 * math.tan(math.radians(phi)))
        * 8.0
        * (math.sqrt(2) + math.log(1 + math.sqrt(2)))
        / 6
    )
    errors = [abs(factor_on(bed, 1.0, split) * torque / exact - 1.0) for split in (1, 2, 3, 4)]
    assert errors[-1] < 2e-4
    assert all(finer < 0.5 * coarser for coarser, finer in pairwise(errors))


def opens(limit: FoundLimit, inputs: dict) -> bool:
    """Whether moments govern by a state that opens part of a cohesive joint."""
    if not limit.analysis.moments_govern or not limit.openings:
        return False
    shares = [opening["pressed_share"] for opening in limit.openings.values()]
    return any(share < 1.0 and c > 0.0 for share, c in zip(shares, inputs["c"], strict=True))


def opened_by_moments(count: int, seed: int) -> list[tuple[dict, object, float]]:
    """Random wedges without passive bolts that moments open: inputs, scene and limit."""
    rng = np.random.default_rng(seed)
    found = []
    while len(found) < count:
        inputs = random_wedge(rng)
        if any(bolt["acts"] == "passive" for bolt in inputs.get("bolts", [])):
            continue
        scene = cut(wedge_design(inputs)).scene_at(0)
        limit = moment_limit(scene)
        if opens(limit, inputs):
            found.append((inputs, scene, limit.analysis.governing.factor))
    return found


@pytest.fixture(scope="module")
def opened() -> list[tuple[dict, object, float]]:
    return opened_by_moments(13, 5)


@pytest.fixture(scope="module")
def analysed(opened) -> list[Result]:
    """The first ten of them by the whole analysis."""
    return [sk.wedge(**inputs) for inputs, _, _ in opened[:10]]


def bed_on(scene) -> Beds:
    return elastic_bed(scene.model, scene.bedding.polygons, scene.bedding.centroid)


def by_springs(inputs, guess: float, count: int) -> tuple[float, float] | None:
    made = wedge.cut(wedge_design(inputs))
    block, loads = made.block, made.loads
    polygons = [block.faces[J1], block.faces[J2]]
    springs = springs_on(
        polygons, inputs["c"], np.tan(np.radians(inputs["phi"])), block.centroid, count
    )
    return Block(springs, loads.force, loads.moment).factor(guess, within=5e-3)


def test_random_wedges_against_separate_springs(opened) -> None:
    """To 2 %, what 400 springs a joint know of its edge, or half as far off with four times as many.

    400 wedges with 1,500 springs a joint: `benchmarks.moments`.
    """
    compared = 0
    for inputs, scene, factor in (
        *opened[:2],
        *opened[3:5],
    ):  # the third needs as many springs as the second
        found = limit_on(bed_on(scene), factor)
        if found.status[0] in (BedStatus.NO_REST, BedStatus.CREEPS):
            continue
        limit = float(found.factor[0])
        bracket = by_springs(inputs, limit, 400)
        if bracket is None:
            continue
        compared += 1
        off = abs(limit / bracket[0] - 1.0)
        if off > 0.02:
            finer = by_springs(inputs, limit, 1600)
            assert abs(limit / finer[0] - 1.0) < 0.65 * off
    assert compared >= 3


@pytest.mark.slow
def test_the_limit_is_the_lower_of_hoek_and_bray_and_of_separate_springs() -> None:
    """40 random wedges to 2 %, by code that shares no line; 500 with 1,500 springs a joint: `benchmarks.moments`."""
    rng, off = np.random.default_rng(40), list[float]()
    while len(off) < 40:
        inputs = random_wedge(rng)
        if has_passive_bolts(inputs):
            continue
        limit, bracket = lower_of_both(inputs, 400)
        if bracket is not None:
            off.append(beside(limit, bracket))
    assert max(map(abs, off)) < 0.02
    assert np.median(np.abs(off)) < 1e-3


def test_the_slopes_are_those_of_the_forces(opened) -> None:
    """Against central differences to 1e-7, with the pressed part changing: its points move, and their areas grow."""
    rng = np.random.default_rng(1)
    cut = 0
    in_section = dam(2.0, 150.0, 40.0, 1500.0, True, 17.0)
    for bed in (*(bed_on(scene) for _, scene, _ in opened[:12]), in_section):
        springs = BedSprings(bed, 2)
        bonded, (first,) = springs.beds.bonded[0], springs.beds.elastic_size
        count = bed.load.shape[1]
        u, slip = (bonded * (1.0 + 0.2 * rng.standard_normal(count)) for _ in range(2))
        ends = zip(bed.corner[:-1], bed.corner[1:], strict=True)
        cut += any(0.0 < (bed.motions(u[None])[at:end, 0] < 0.0).mean() < 1.0 for at, end in ends)
        for running in (False, True):
            at = unbalanced(springs, u, slip, 0.3, running)
            scale = float(np.abs(at.by_opening + at.by_slip).max())
            for k, step in enumerate(1e-6 * first * np.eye(count)):
                opened_by = unbalanced(springs, u + step, slip, 0.3, running).force
                slopes = (opened_by - unbalanced(springs, u - step, slip, 0.3, running).force) / (
                    2.0 * step[k]
                )
                assert slopes == pytest.approx(at.by_opening[:, k], abs=1e-7 * scale)
                slipped = unbalanced(springs, u, slip + step, 0.3, running).force
                slopes = (slipped - unbalanced(springs, u, slip - step, 0.3, running).force) / (
                    2.0 * step[k]
                )
                assert slopes == pytest.approx(at.by_slip[:, k], abs=1e-7 * scale)
            weaker = unbalanced(springs, u, slip, 0.3 + 1e-6, running).force - at.force
            assert weaker / 1e-6 == pytest.approx(at.by_reduction, abs=1e-6 * scale)
    assert cut > 3


@pytest.mark.parametrize("seed", [1111, 17])
def test_the_limit_does_not_depend_on_the_steps_of_the_path(seed, monkeypatch) -> None:
    """Steps of half the length, and a start from another guess; with long steps past a least λ this was 4.9 to 6.3."""
    for _, scene, factor in opened_by_moments(2, seed):
        guess = factor
        factors = [factor_on(bed_on(scene), guess * times, 2) for times in (0.7, 1.0, 1.5)]
        with monkeypatch.context() as shorter:
            shorter.setattr(bed_path, "_FIRST", 0.05)
            shorter.setattr(bed_path, "_LONGEST", 0.5)
            factors.append(factor_on(bed_on(scene), guess, 2))
        assert factors == pytest.approx([factors[0]] * 4, rel=1e-5)


def test_no_force_jumps_where_a_corner_opens() -> None:
    """The sums on either side of the first opening of a corner differ by what the displacement does alone."""
    bed = dam(4.0 / 3.0, 150.0, 40.0, 1500.0, False)
    springs = BedSprings(bed, 1)
    rows, (first,) = corner_motions(bed, 0), springs.beds.elastic_size
    slip = np.random.default_rng(3).standard_normal(6) * springs.beds.bonded[0]
    opened = np.linalg.lstsq(rows[:, 0], np.array([0.0, -1.0, -2.0, -1.0]), rcond=None)[0] * first
    size = float(np.abs(opened).max())
    for away in (1e-6, 1e-9):
        tip = np.linalg.lstsq(rows[:, 0], np.array([away, 0.0, -away, 0.0]), rcond=None)[0] * first
        before, after = (
            unbalanced(springs, opened + way * tip, slip, 0.3, False).force for way in (-1.0, 1.0)
        )
        assert float(np.abs(after - before).max()) < 50.0 * away * size


def test_the_cracked_base_converges_with_its_triangles(opened) -> None:
    """And says beforehand what splitting them once more does: within a factor of three, or both are below 1e-4."""
    for _, scene, factor in opened[:5]:
        bed = bed_on(scene)
        limits = [limit_on(bed, factor, (split,)) for split in (1, 2, 3)]
        coarse, finer, finest = (limit.factor[0] for limit in limits)
        if np.isnan([coarse, finer, finest]).any() or limits[1].status[0] == BedStatus.CREEPS:
            continue
        done, next_ = abs(finer / coarse - 1.0), abs(finest / finer - 1.0)
        assert next_ < max(0.6 * done, 3e-4)
        assert next_ < max(3.0 * limits[1].change[0], 1e-4)


def turning_on_two_edges() -> dict:
    """The first wedge of seed 7 whose limit moved with the mesh (the prototype of the path), rounded."""
    return {
        "dips": ("44.785/86.243", "41.797/34.813"),
        "face": "87.102/77.401",
        "upper": "20.153/77.401",
        "height": 3.98878,
        "c": (66.2215, 13.1616),
        "phi": (43.0, 47.5),
        "unit_weight": 28.741,
    }


def mirrored(inputs: dict) -> dict:
    """The wedge in a mirror that stands north-south."""
    out = dict(inputs)
    for key in ("dips", "face", "upper"):
        planes = np.array(inputs[key], dtype=float)
        planes[..., 1] = (360.0 - planes[..., 1]) % 360.0
        out[key] = planes.tolist()
    for bolt in inputs.get("bolts", []):
        out["bolts"] = [bolt | {"toward": ((360.0 - bolt["toward"][0]) % 360.0, bolt["toward"][1])}]
    return out


def weaker(inputs: dict, by: float) -> dict:
    phi = [math.degrees(math.atan(math.tan(math.radians(value)) / by)) for value in inputs["phi"]]
    return inputs | {"c": [value / by for value in inputs["c"]], "phi": phi}


def larger(inputs: dict, by: float) -> dict:
    """Every length times `by`, and every force per area with it: the same model in other units."""
    bolts = [bolt | {"force": bolt["force"] * by**3} for bolt in inputs.get("bolts", [])]
    water = {"water": [value * by for value in inputs["water"]]} if "water" in inputs else {}
    return (
        inputs
        | {
            "height": inputs["height"] * by,
            "c": [value * by for value in inputs["c"]],
            "bolts": bolts,
        }
        | water
    )


CHANGES = {
    "mirrored and moved": (lambda w: mirrored(w) | {"origin": (5e5, 4e6, 300.0)}, 1.0),
    "1000 times as large, half the strength": (lambda w: weaker(larger(w, 1e3), 2.0), 0.5),
}


@pytest.mark.parametrize("name", CHANGES)
def test_the_limit_does_not_depend_on_how_the_wedge_is_written(opened, analysed, name) -> None:
    """Mirror, size, place, and F(strength / k) k = F, to 1e-6; to 1e-5 a path that creeps about an edge to its end."""
    change, times = CHANGES[name]
    for (inputs, _, _), first in zip(opened[:2], analysed, strict=False):
        again = sk.wedge(**change(inputs))
        assert again.fos.limit == pytest.approx(first.fos.limit * times, rel=1e-5)


def test_the_limit_is_the_lower_of_forces_and_bed_and_below_the_static_bound(analysed) -> None:
    """No forces at the limit are inadmissible, and all of them balance."""
    for result in analysed:
        assert result.fos.limit < result.comparisons.forces_only == result.fos.highest
        assert result.fos.limit <= result.fos.static_bound * (1.0 + 1e-6)
        assert result.fos.lowest is None or result.fos.lowest < 0.99 * result.fos.limit
        assert result.limit_state.balance.force < 1e-9
        assert result.limit_state.balance.moment < 1e-9
        assert result.limit_state.balance.friction_excess < 1e-9
        assert result.limit_state.balance.pull == 0.0


def test_what_moments_take_and_what_lost_cohesion_takes_are_two_shares() -> None:
    """Hoek & Bray with the cohesion of what is pressed lies between the forces on whole joints and the limit."""
    inputs = {
        "dips": ["55.0/148.5", "53.9/233.0"],
        "face": "70/180",
        "upper": "5.3/180",
        "height": 14.3,
        "phi": [41, 39],
        "unit_weight": 26,
        "crack": "80/180@2.5m",
        "water": "55%",
    }
    result = sk.wedge(**inputs, c=[53.9, 46])
    pressed = [opening["pressed_share"] for opening in result.to_dict()["openings"].values()]
    weaker = sk.wedge(**inputs, c=[53.9 * pressed[0], 46 * pressed[1]])
    assert result.comparisons.on_pressed == pytest.approx(weaker.fos.closed_form, rel=1e-9)
    forces, between, limit = result.fos.highest, weaker.fos.closed_form, result.fos.limit
    moments, lost = (
        f"{share / forces * 100:.2g} %" for share in (between - limit, forces - between)
    )
    line = " ".join(result.sheet.full.split("MOMENTS")[1].split("MODEL")[0].split())
    assert f"(forces only 1.450; moments alone take {moments}, cohesion lost {lost})" in line


def test_the_sheet_and_the_json_say_what_opens() -> None:
    result = sk.wedge(**turning_on_two_edges())
    found = result.to_dict()["openings"]
    assert found["J1"]["pressed_share"] == pytest.approx(0.930, abs=2e-3)
    assert found["J2"]["opens_at_m"] is None
    line = " ".join(result.sheet.full.split("MOMENTS")[1].split("MODEL")[0].split())
    shares = "forces only 4.604; moments alone take 13 %, cohesion lost 4.8 %"
    assert line.startswith(
        f"6.99 % of J1 opens at failure and carries no cohesion: FoS 3.764 ({shares})"
    )
    model = " ".join(result.sheet.full.split("MODEL")[1].split("MOVES")[0].split())
    points = len(result.limit_state.node_pairs.points_m)
    assert points > result.model.node_pairs
    assert (
        f"node pairs (bound, displacements), the limit on {points} points of the elastic bed"
        in model
    )


def test_a_wedge_that_presses_on_all_of_its_joints_follows_no_path(monkeypatch) -> None:
    def never(*_: object) -> None:
        raise AssertionError

    monkeypatch.setattr(bed_path.BedPath, "follow", never)
    result = sk.wedge(dips=("45/105", "70/235"), face="65/185", upper="12/195")
    assert result.to_dict()["openings"] == {}
    assert not result.moments_govern


def test_no_turn_of_a_path_lies_between_two_of_its_points() -> None:
    """A joint opens within three elastic displacements: a path in long steps passed the turn there, 5 % lower.

    Against the same block as one of many, whose path goes down in the strength.
    """
    design = wedge_design(
        {
            "dips": [
                [10.991020980985217, 89.85809374583152],
                [34.55425120453483, 117.32531901466191],
            ],
            "face": [43.55579301639267, 100.35160668358684],
            "upper": [0.776999742967952, 100.35160668358684],
            "height": 1.651764519949974,
            "c": [47.21858731897871, 6.256340620919598],
            "phi": [8.225853010644679, 24.582445497023976],
            "unit_weight": 28.350721813872532,
            "water": [4.097802301404191, 1.726054204321697],
            "bolts": [
                {
                    "force": 30.229490533557318,
                    "toward": (319.48891816311834, 19.195931995617578),
                    "acts": "active",
                }
            ],
        }
    )
    scene = cut(design).scene_at(0)
    found = flat_limit(scene.model, scene.bedding.polygons, scene.bedding.centroid)
    many = limit_of_blocks(as_assembly(scene), ranged=False)
    assert found.factor == pytest.approx(many.factor, rel=0.01)


def test_a_path_that_passes_close_to_another_keeps_to_itself() -> None:
    """Two paths cross where φ of J1 is 20.658°: below it the block comes past there, above it the limit is there.

    0.5318 to 0.4766 were jumped between in steps of 0.02° on both sides. Against strength that goes down in steps of
    2e-2 to 1e-5 from rest to rest, on triangles split 64 times: 0.53230, 0.47804, 0.47676, 0.47585 (finer: 0.47365).
    """
    angles, expected = (
        (20.64, 20.68, 20.7, 20.72, 20.8),
        (0.53230, 0.47804, 0.47676, 0.47585, 0.47365),
    )
    assert [factors_of(sk.load(two_paths(phi))).limit for phi in angles] == pytest.approx(
        expected, rel=3e-4
    )


@pytest.mark.slow
def test_both_paths_are_those_of_springs() -> None:
    """Within what 1,500 springs a joint leave of the limit; near the crossing they may take either path."""
    for phi in (20.6, 21.0):
        design = sk.load(two_paths(phi))
        made = cut(design)
        faces = [made.block.faces[joint] for joint in (J1, J2)]
        springs = springs_on(
            faces, (20.0, 30.0), np.tan(np.radians([phi, 33.0])), made.block.centroid, 1500
        )
        bracket = Block(springs, made.loads.force, made.loads.moment).factor(0.5)
        assert abs(beside(factors_of(design).limit, bracket)) < 2e-3
