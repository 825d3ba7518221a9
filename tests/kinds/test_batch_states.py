"""Many single blocks at once end as each of them does alone: status, factor, and whether moments govern."""

from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import slopekit as sk
from benchmarks.basal import random_design
from benchmarks.batch import blocks_of
from benchmarks.ordinary_cuts import ordinary_cut
from slopekit.design.common import Design
from slopekit.kinds import cut, factors_of
from slopekit.kinds.single_block.blocks_on_arrays import block_statuses
from slopekit.kinds.wedge.design import wedge_design
from slopekit.preie.batch import limits_of_blocks


def compared(designs: list[Design]) -> Counter[str]:
    """Compare each design with its row of the batch; return how often each status came."""
    limits = limits_of_blocks(blocks_of([cut(design) for design in designs]))
    single = [factors_of(design) for design in designs]
    statuses = block_statuses(limits).tolist()
    assert statuses == [one.status for one in single]
    assert limits.moments_govern.tolist() == [one.moments_govern for one in single]
    factors = np.array([np.nan if one.limit is None else one.limit for one in single])
    assert np.where(limits.factor == 0.0, np.nan, limits.factor) == pytest.approx(
        factors, rel=1e-6, nan_ok=True
    )
    return Counter(statuses)


def formed(designs: Iterator[Design], count: int) -> list[Design]:
    """The first designs that form a block."""
    found = list[Design]()
    for design in designs:
        try:
            cut(design)
        except sk.GeometryError:
            continue
        found.append(design)
        if len(found) == count:
            break
    return found


def ordinary(seed: int, **others: Any) -> Iterator[Design]:
    rng = np.random.default_rng(seed)
    while True:
        yield wedge_design(ordinary_cut(rng) | others)


def basal(seed: int) -> Iterator[Design]:
    """Random wedges on three joints, without passive bolts."""
    rng = np.random.default_rng(seed)
    while True:
        design = random_design(rng)
        if "passive" not in str(design):
            yield sk.load(design)


@pytest.mark.slow
def test_three_hundred_ordinary_cuts() -> None:
    found = compared(formed(ordinary(5), 300))
    assert {
        "slides_on_both",
        "slides_on_J1",
        "slides_on_J2",
        "rotates",
        "lifted",
        "topples",
    } <= set(found)


def test_wedges_on_three_joints() -> None:
    """Some of them stand without strength."""
    found = compared(formed(basal(3), 60))
    assert found["no_driving_force"] > 0
    assert len(found) > 6


@pytest.mark.parametrize(
    ("others", "status"),
    [
        ({"c": (0.0, 0.0), "phi": (0.0, 0.0)}, "slides_on_both"),
        ({"forces": [{"force": "40 MN", "toward": "180/-60"}]}, "lifted"),
        ({"forces": [{"force": "90 MN", "toward": "0/0"}]}, "slides_up"),
    ],
    ids=["without strength", "pulled off", "pushed up"],
)
def test_wedges_that_end_otherwise(others: dict[str, Any], status: str) -> None:
    assert compared(formed(ordinary(2, **others), 12))[status] > 0


def planes(seed: int) -> Iterator[Design]:
    """Random plane failures per metre: some level or rising into the slope, some with water or forces."""
    rng = np.random.default_rng(seed)
    while True:
        u, height = rng.uniform, float(rng.uniform(5, 30))
        dip = float(rng.choice([0.0, u(-10, 10), u(20, 50)], p=[0.1, 0.2, 0.7]))
        design: dict[str, Any] = {
            "slopekit": 1,
            "kind": "plane",
            "slope": {"face": f"{u(55, 85)}/180", "height": height, "upper": "0/180"},
            "joints": {"J1": {"plane": f"{abs(dip)}/{180 if dip >= 0 else 0}", "strength": "s"}},
            "crack": {"depth": float(height * u(0.05, 0.4) if dip > 10 else u(0.8, 0.99) * height)},
            "strength": {
                "s": {
                    "c": float(rng.choice([0.0, u(0, 60)])),
                    "phi": float(rng.choice([0.0, u(5, 45)])),
                }
            },
            "rock": {"unit_weight": 26},
        }
        if rng.integers(0, 2):
            design["water"] = {"fill": float(u(0.0, 1.0))}
        if rng.integers(0, 2):
            force = {
                "force": float(height**2 * u(0, 40)),
                "toward": f"{rng.choice([0, 180])}/{u(-60, 60)}",
            }
            design["loads"] = {"forces": [force]}
        yield sk.load(design)


def test_planes_in_their_sections() -> None:
    found = compared(formed(planes(4), 100))
    assert {"slides_on_J1", "slides_up", "lifted", "topples"} == set(found)


def test_nearly_parallel_joints_that_push_a_thousand_times_the_load() -> None:
    """A millionth of the water moved these from 28.7 to 24.5 and from 75.6 to 35.5, alone or in batch: 1e-5 now."""
    wedges = (
        {
            "dips": (
                (31.3857506832471, 181.71535579560128),
                (31.812523495287714, 183.61068739413741),
            ),
            "height": 21.0447,
            "face": (76.03320422848438, 180.0),
            "upper": (10.23159406176788, 180.0),
            "c": (10.40389790948893, 33.595),
            "phi": (32.737397038037734, 32.772222111663325),
            "unit_weight": 26.0,
            "water": 0.765378697317069,
        },
        {
            "dips": (
                (55.39276903821835, 179.0304800702344),
                (56.663784582949546, 177.78352222780026),
            ),
            "height": 27.055,
            "face": (73.55896537184844, 180.0),
            "upper": (4.419431323817861, 180.0),
            "c": (36.59271558634349, 25.2729),
            "phi": (44.52550591157052, 38.30139204769621),
            "unit_weight": 26.0,
            "water": 0.8389027353698193,
        },
    )
    for wedge in wedges:
        near = [
            wedge_design(wedge | {"water": wedge["water"] * (1.0 + 1e-6 * step)})
            for step in range(12)
        ]
        compared(near)
        factors = [factors_of(design).limit for design in near]
        assert factors == pytest.approx([factors[0]] * len(near), rel=1e-5)
