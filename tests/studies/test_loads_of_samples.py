"""Water tables, ponds, surcharge and water in the crack of many samples at once: each as `run` has it by itself."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

import slopekit as sk
from slopekit.studies.evaluation.vectorised import vectorised
from slopekit.studies.points import point_of
from slopekit.studies.prob.sampling import samples

SAMPLES = 20
DESIGNS = 40


def near(value: float, share: float) -> dict[str, Any]:
    """A distribution about a value."""
    least, most = sorted((value * (1.0 - share), value * (1.0 + share)))
    return {"dist": "uniform", "min": least, "max": most}


def near_plane(dip: float, direction: float) -> dict[str, Any]:
    return {"dip": near(dip, 0.05), "dip_direction": near(direction, 0.02)}


def random_design(rng: np.random.Generator) -> dict[str, Any]:
    """A wedge, one above a basal joint or a plane, with one to three of the loads; nearly every number scatters."""
    kind = str(rng.choice(["wedge", "basal", "plane"]))
    height = float(rng.uniform(8.0, 40.0))
    level = 0.0 if kind == "plane" else float(rng.uniform(-50.0, 50.0))
    document: dict[str, Any] = {
        "slopekit": 1,
        "kind": "plane" if kind == "plane" else "wedge",
        "rock": {"unit_weight": near(25.0, 0.05)},
        "joints": {
            "J1": {"plane": near_plane(rng.uniform(27, 45), rng.uniform(175, 185)), "strength": "s"}
        },
        "strength": {
            "s": {"c": near(rng.uniform(5, 40), 0.3), "phi": near(rng.uniform(20, 42), 0.1)}
        },
        "slope": {
            "face": near_plane(rng.uniform(62, 80), 180.0),
            "upper": near_plane(rng.uniform(1, 14), 180.0),
            "height": near(height, 0.1),
        },
    }
    if kind != "plane":
        for name, direction in (("J1", rng.uniform(100, 140)), ("J2", rng.uniform(215, 255))):
            plane = near_plane(rng.uniform(42, 68), direction)
            document["joints"][name] = {"plane": plane, "strength": "s"}
        document["slope"]["origin"] = [100.0, -20.0, level]
    if kind == "basal":
        document["basal"] = {
            "plane": near_plane(rng.uniform(5, 25), 180.0),
            "height": near(0.2 * height, 0.1),
        }
    water: dict[str, Any] = {}
    match int(rng.integers(5)):
        case 0:
            water = {"mode": "table", "depth": near(rng.uniform(0.1, 0.6) * height, 0.1)}
        case 1:
            places = [
                [0.0, level],
                [0.5 * height, level + 0.2 * height],
                [1.5 * height, level + 0.6 * height],
            ]
            water = {"mode": "table", "points": places}
        case 2:
            water = {
                "mode": "table",
                "plane": f"{rng.uniform(5, 25):.3f}/175@{level - 0.1 * height:.3f}m",
            }
    crack: dict[str, Any] = {"distance": near(rng.uniform(0.05, 0.25) * height, 0.1)}
    if kind != "plane":
        crack["plane"] = near_plane(rng.uniform(72, 88), 182.0)
    if water and rng.uniform() < 0.5:
        water["pond"] = near(level + rng.uniform(0.1, 0.9) * height, 0.02)
    elif not water:
        depth = rng.uniform(0.02, 0.2) * height
        crack["water"] = near(depth, 0.3) if kind == "plane" else f"{depth:.4f} m"
    if "water" in crack or rng.uniform() < 0.5:
        document["crack"] = crack
    if rng.uniform() < 0.5:
        document["loads"] = {"surcharge": near(rng.uniform(5, 100), 0.4)}
    return document | ({"water": water} if water else {})


def random_law(rng: np.random.Generator) -> dict[str, Any]:
    """A curved strength, or one that a law makes a line; its parameters scatter."""
    laws: list[dict[str, Any]] = [
        {
            "law": "barton-bandis",
            "jrc": near(rng.uniform(4, 14), 0.1),
            "jcs": "80 MPa",
            "phi_r": near(25, 0.1),
        },
        {
            "law": "power",
            "a": near(rng.uniform(1, 2), 0.2),
            "b": near(0.8, 0.08),
            "d": near(6, 0.5),
        },
        {"law": "bilinear", "phi": near(25, 0.1), "i": near(12, 0.2), "sigma_t": near(80, 0.5)},
        {
            "law": "bridged",
            "c": near(2, 0.5),
            "phi": near(28, 0.1),
            "c_rock": "3 MPa",
            "phi_rock": 45,
            "persistence": near(0.99, 0.005),
        },
        {"c": near(15, 0.5), "phi": near(30, 0.1), "waviness": near(5, 0.5)},
    ]
    return laws[int(rng.integers(len(laws)))]


def random_forces(rng: np.random.Generator, size: float) -> dict[str, Any]:
    """A force, active and passive bolts, whose sizes and directions scatter."""

    def towards(trend: float) -> dict[str, Any]:
        return {"trend": near(trend, 0.05), "plunge": near(rng.uniform(2, 30), 0.4)}

    bolts = [
        {
            "force": near(size * rng.uniform(0.05, 0.5), 0.2),
            "toward": towards(rng.uniform(1, 40)),
            "acts": acts,
        }
        for acts in rng.choice(["passive", "passive", "active"], int(rng.integers(1, 4))).tolist()
    ]
    force = {"force": near(0.1 * size, 0.5), "toward": towards(180.0), "at": [0.0, -1.0, 4.0]}
    return {"loads": {"forces": [force]}, "support": {"bolts": bolts}}


def compared(document: Mapping[str, Any], count: int = SAMPLES) -> tuple[set[str], int]:
    """The statuses of the samples of a design, and how many have a factor: those of `run`, to 1e-9 and 3e-6."""
    design = sk.load(dict(document))
    drawn = samples(design.variables, design.correlation, count, 1, "monte-carlo")
    together = vectorised(design, drawn.values, drawn.settings)
    assert together is not None
    every = together.rows(drawn.values)
    forms = every.closed_form
    outcomes = np.array(forms.names, dtype=object)[forms.outcome]
    rows = np.flatnonzero([not name.startswith("E") for name in outcomes])
    statuses, found = outcomes.copy(), dict[int, float]()
    if len(rows):
        limits = every.take(rows).limits()
        statuses[rows] = limits.status
        found = dict(zip(rows.tolist(), limits.limit.tolist(), strict=True))
    for row in range(count):
        point = point_of(design, drawn.settings(row))
        if point.factors is None:
            assert statuses[row] == point.code
            continue
        assert (statuses[row], outcomes[row]) == (point.factors.status, point.factors.closed_status)
        if point.factors.closed_form is not None:
            assert forms.factor[row] == pytest.approx(point.factors.closed_form, rel=1e-9)
        if point.factors.limit is not None:
            assert found[row] == pytest.approx(point.factors.limit, rel=3e-6)
    return set(statuses), len(rows)


@pytest.mark.slow
def test_samples_all_at_once_have_the_loads_of_each() -> None:
    """Forty designs of twenty samples: closed form to 1e-9, PRE-IE to 3e-6, the same status, the same refusal."""
    rng, statuses, judged = np.random.default_rng(43), set[str](), 0
    for _ in range(DESIGNS):
        met, count = compared(random_design(rng))
        statuses, judged = statuses | met, judged + count
    assert judged > DESIGNS * SAMPLES // 2
    assert statuses >= {"rotates", "slides_on_J1", "slides_on_both", "E207", "E456"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("laws", "bolts"), [(True, False), (False, True), (True, True)], ids=["laws", "bolts", "both"]
)
def test_samples_all_at_once_have_the_strength_and_the_bolts_of_each(
    laws: bool, bolts: bool
) -> None:
    """Six dry designs of eight samples each: as `compared` has it."""
    rng, judged = np.random.default_rng(44), 0
    for _ in range(6):
        document = random_design(rng)
        height = document["slope"]["height"]["max"]
        document = {
            key: of for key, of in document.items() if key not in ("water", "loads", "crack")
        }
        document |= {"strength": {"s": random_law(rng)}} if laws else {}
        weight = 5.0 * height ** (2 if document["kind"] == "plane" else 3)
        document |= random_forces(rng, weight) if bolts else {}
        judged += compared(document, 8)[1]
    assert judged > 20
