"""Many single blocks at once: against Hoek & Bray, hand calculations of dams, an independent bed, and one by one."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.batch import TEMPLATE, blocks_of, random_cuts, single_factors, wedges_of
from slopekit import load
from slopekit.kinds import cut
from slopekit.kinds.wedge.design import wedge_design
from slopekit.preie import batch
from slopekit.preie.batch import Blocks, limits_of_blocks
from slopekit.preie.one_block.bed_limits import BedStatus
from slopekit.preie.one_block.forces_limits import ForcesStatus
from slopekit.studies.evaluation.vectorised import vectorised
from slopekit.studies.prob.sampling import samples

CASES = json.loads(Path(__file__).with_name("moments.json").read_text(encoding="utf-8"))["cases"]
WIDTH, WEIGHT, THRUST = 8.0, 2400.0, 1500.0  # m, kN, kN of a dam 1 m long


def test_random_cuts_as_one_by_one() -> None:
    """200 cuts, to 1e-6; 2,000 of them: `python -m benchmarks.batch`."""
    cuts = random_cuts(200, 11)
    found, single = limits_of_blocks(blocks_of(cuts)), single_factors(cuts)
    slides = found.forces_status == ForcesStatus.SLIDES
    assert slides.sum() > 180
    assert (np.isfinite(found.factor) == np.isfinite(single))[slides].all()
    assert found.factor[slides] == pytest.approx(single[slides], rel=1e-6, nan_ok=True)
    assert {BedStatus.PRESSED, BedStatus.RUNS, BedStatus.RESTS, BedStatus.CREEPS} <= set(
        found.bed_status.tolist()
    )


def test_blocks_without_strength_have_none() -> None:
    """A factor of 0 beside others, as a single block's; no bed is looked at."""
    blocks, closed_form = scattered(3)
    bare = np.array([1.0, 0.0, 1.0])[:, None]
    found = limits_of_blocks(
        replace(blocks, cohesion=blocks.cohesion * bare, tan_friction=blocks.tan_friction * bare)
    )
    assert found.factor[1] == found.forces[1] == 0.0
    assert found.bed_status[1] == -1
    assert found.forces[[0, 2]] == pytest.approx(closed_form[[0, 2]], rel=1e-12)


def test_wedges_of_an_independent_bed() -> None:
    """Within 2 %, what a path that creeps about an edge leaves: as the single analyses are (`test_one_rule`)."""
    found = limits_of_blocks(blocks_of([cut(wedge_design(case["inputs"])) for case in CASES]))
    expected = [min(case["hoek_bray"], case["bed_limit"][0]) for case in CASES]
    assert found.factor == pytest.approx(expected, rel=0.02)
    assert found.forces == pytest.approx([case["hoek_bray"] for case in CASES], rel=1e-9)


def scattered(count: int) -> tuple[Blocks, np.ndarray]:
    """Samples of a template, and their factors by the closed form."""
    design = load(str(TEMPLATE))
    drawn = samples(design.variables, design.correlation, count, 3, "monte-carlo")
    columns = vectorised(design, drawn.values, drawn.settings)
    return wedges_of(columns.arguments(drawn.values), count), columns.rows(
        drawn.values
    ).closed_form.factor


def test_the_forces_are_those_of_hoek_and_bray() -> None:
    """And the lower of both is never above them; most of these wedges press on all of their joints."""
    blocks, closed_form = scattered(500)
    found = limits_of_blocks(blocks)
    assert found.forces == pytest.approx(closed_form, rel=1e-12)
    assert (found.factor <= found.forces).all()
    whole = found.bed_status == BedStatus.PRESSED
    assert 0.5 < whole.mean() < 0.7
    assert found.factor[whole] == pytest.approx(found.forces[whole], rel=1e-12)
    assert found.pressed[whole] == pytest.approx(1.0, abs=1e-12)
    assert (found.factor < 0.99 * found.forces).any()


@pytest.mark.slow
def test_more_friction_never_lowers_a_limit() -> None:
    """Nor a snap that comes to rest again: from 1.01 to 1.02 of its friction the first cut fell from 0.666 to 0.509."""
    cuts = blocks_of([random_cuts(751, 77)[750], *random_cuts(60, 3)])
    factors = [
        limits_of_blocks(replace(cuts, tan_friction=cuts.tan_friction * times)).factor
        for times in (1.0, 1.01, 1.02)
    ]
    rests = np.isfinite(factors[0])
    assert rests.sum() > 50
    assert (factors[1] >= factors[0] * (1.0 - 1e-6))[rests].all()
    assert (factors[2] >= factors[1] * (1.0 - 1e-6))[rests].all()


def dams(eccentricities: list[float]) -> Blocks:
    """Dams 8 m wide on a level base, their resultant so far downstream of the middle; a second contact is missing."""
    corners, load = np.zeros((len(eccentricities), 2, 4, 3)), np.zeros((len(eccentricities), 6))
    for row, eccentricity in enumerate(eccentricities):
        x, y = WIDTH / 2.0, 0.5
        corners[row, 0] = [[-x, -y, -1.0], [-x, y, -1.0], [x, y, -1.0], [x, -y, -1.0]]
        load[row, :3] = THRUST, 0.0, -WEIGHT
        load[row, 3:] = np.cross([eccentricity, 0.0, -1.0], load[row, :3])
    one = np.ones((len(eccentricities), 2))
    counts = np.tile([4, 0], (len(eccentricities), 1))
    return Blocks(
        corners=corners,
        counts=counts,
        cohesion=150.0 * one,
        tan_friction=math.tan(math.radians(40.0)) * one,
        tan_dilation=np.zeros(counts.shape),
        load=load,
        bolts=np.zeros((len(eccentricities), 0, 6)),
        laws=np.full(counts.shape, None),
    )


@pytest.mark.parametrize("in_section", [False, True], ids=["in space", "in a section"])
def test_dams_on_their_bases(in_section) -> None:
    """USACE EM 1110-2-2200: within the middle third the base is whole, else 3 (B/2 - e) of it is pressed. Exact.

    Beyond the edge a dam rests at no strength. The sliding factor is (c L + N tan φ) / T.
    """
    eccentricities = [0.0, 1.2, 1.5, -2.0, 3.0, 3.9, 4.001]
    blocks = dams(eccentricities)
    if in_section:  # from the first to the last corner
        blocks = replace(blocks, corners=blocks.corners[:, :, ::3], counts=blocks.counts // 2)
    found = limits_of_blocks(blocks)
    pressed = np.array([min(WIDTH, 3.0 * (WIDTH / 2.0 - abs(e))) for e in eccentricities])[:-1]
    factor = (150.0 * pressed + WEIGHT * math.tan(math.radians(40.0))) / THRUST
    assert found.factor[:-1] == pytest.approx(factor, rel=1e-9)
    assert found.pressed[:-1, 0] == pytest.approx(pressed / WIDTH, rel=1e-9)
    assert np.isnan(found.pressed[:, 1]).all()
    assert math.isnan(found.factor[-1])
    assert found.bed_status.tolist() == [
        *[BedStatus.PRESSED] * 2,
        *[BedStatus.RUNS] * 4,
        BedStatus.NO_REST,
    ]


def test_blocks_that_nothing_drives_and_that_are_lifted_have_no_limit() -> None:
    """A dam without thrust stands if its weight is within its base, else it rests at no strength; one falls."""
    blocks = dams([0.0, 0.0, 0.0, 4.1])
    blocks.load[[0, 2, 3], 0] = 0.0
    blocks.load[1, 2] = WEIGHT
    blocks.corners[2, 0] *= np.array([1.0, 1.0, -1.0])  # its base is above it
    blocks.corners[2, 0] = blocks.corners[2, 0, ::-1].copy()
    blocks.load[3, 4] = 4.1 * WEIGHT
    found = limits_of_blocks(blocks)
    ends = [ForcesStatus.STANDS, ForcesStatus.LIFTED, ForcesStatus.FALLS, ForcesStatus.NOT_DRIVEN]
    assert found.forces_status.tolist() == ends
    assert found.bed_status.tolist() == [-1, -1, -1, BedStatus.NO_REST]
    assert np.isnan(found.factor).all()
    assert found.normal[:3, 0] == pytest.approx([WEIGHT, 0.0, 0.0], rel=1e-12)


def test_chunks_and_numpy_give_the_same(monkeypatch) -> None:
    """To 1e-9: rows do not know of each other, nor of what adds up their forces."""
    blocks, _ = scattered(24)
    found = limits_of_blocks(blocks)
    monkeypatch.setattr(batch, "CHUNK", 7)
    monkeypatch.setenv("SLOPEKIT_KERNELS", "numpy")
    again = limits_of_blocks(blocks)
    assert (again.bed_status == found.bed_status).all()
    assert again.factor == pytest.approx(found.factor, rel=1e-9)
    assert again.pressed == pytest.approx(found.pressed, rel=1e-7)


def test_rounding_does_not_decide_whether_a_block_rests() -> None:
    """Newton's steps to its stuck state wander: three in six of these landed, and rested at 0.13."""
    blocks = blocks_of(random_cuts(145, 11)[-1:] * 8)
    blocks.load[:] *= 1.0 + 1e-14 * np.random.default_rng(1).standard_normal(blocks.load.shape)
    assert set(limits_of_blocks(blocks).bed_status.tolist()) == {BedStatus.NO_REST}
