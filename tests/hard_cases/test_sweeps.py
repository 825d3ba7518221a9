"""The sweeps, thinned: no crash, no wrong number that does not say so. The full curves: `benchmarks/hard_cases.py`."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from tests.hard_cases import sweeps
from tests.hard_cases.catalogue import SWEEPS, apart
from tests.hard_cases.sweeps import point, verdict, walk

CURVES = Path(__file__).parents[2] / "docs" / "hard-cases.json"
NAMES = [f"{sweep.picture}: {sweep.name}" for sweep in SWEEPS]


@pytest.fixture(scope="module")
def walked() -> dict:
    """The points of each sweep, once."""
    return {}


@pytest.fixture(autouse=True)
def _each_design_once(monkeypatch, analysed) -> None:
    """What one sweep compares the factor of, another has the volume of."""
    run = sweeps.analyse

    def once(case):
        name = repr((case.kind, case.design))
        if name not in analysed:
            analysed[name] = run(case)
        return analysed[name]

    monkeypatch.setattr(sweeps, "analyse", once)


@pytest.fixture(scope="module")
def analysed() -> dict:
    """The results of designs."""
    return {}


@pytest.mark.parametrize("sweep", SWEEPS, ids=NAMES)
def test_every_point_agrees_or_says_why_not(sweep, walked) -> None:
    """Against 50 digits, at the tolerance that the sweep names with its cause."""
    points = walked[sweep.picture, sweep.name] = walk(sweep, sweep.thinned)
    wrong = {
        found.value: text for found in points if (text := verdict(sweep, found)).startswith("wrong")
    }
    assert not wrong
    assert any(verdict(sweep, found) != "said" for found in points)


@pytest.mark.parametrize("name", ["paper's wedge", "Wyllie & Mah's wedge", "plane"])
def test_the_joint_stiffness_moves_all_pairs_but_not_the_limit(name, walked) -> None:
    """METHOD.md §3: the paper's criterion depends on k_t/k_n; it stays below the limit (its bracket is 1e-5 wide)."""
    sweep = next(sweep for sweep in SWEEPS if (sweep.picture, sweep.name) == ("stiffness", name))
    points = walked.get(("stiffness", name)) or walk(sweep, sweep.thinned)
    assert len({found.limit for found in points}) == 1
    failed = [found.all_pairs for found in points]
    assert failed == sorted(failed)
    assert failed[-1] <= points[0].limit * (1.0 + 1.1e-5)
    assert failed[-1] == pytest.approx(points[0].limit, rel=1e-4)


@pytest.mark.parametrize(
    "spoilt",
    [{"limit": 1.01}, {"limit": None}, {"status": "lifted"}, {"agree": False}, {"refused": "E599"}],
    ids=lambda spoilt: next(iter(spoilt)),
)
def test_the_verdict_notices_what_is_wrong(spoilt) -> None:
    """A number 1 % off, none at all, another status, a dispute and our own fault are all called wrong."""
    sweep = SWEEPS[0]
    found = point(apart(30.0))
    assert verdict(sweep, found) == "agrees"
    change = dict(spoilt)
    if change.get("limit"):
        change = {"limit": found.limit * 1.01, "error": 0.01}
    assert verdict(sweep, replace(found, **change)).startswith("wrong")


def test_no_number_where_there_is_none_and_not_converged_is_said() -> None:
    sweep = SWEEPS[0]
    found = replace(point(apart(30.0)), exact=None, exact_status="lifted")
    assert verdict(sweep, found).startswith("wrong")
    assert verdict(sweep, replace(found, status="lifted", limit=None)) == "agrees"
    assert verdict(sweep, replace(found, status="not_converged", limit=None)) == "said"


#: One point of a few kinds, quick ones: the picture, the sweep and the number of the point.
KEPT = [
    ("angle", "dip directions apart", -1),
    ("size", "wedge, c = 0", 0),
    ("size-blocks", "stack of six", 7),
    ("size-blocks", "bench", 0),
    ("water", "wedge: J2", 12),
    ("water", "block", 9),
    ("plunge", "plane: dip below the face", 20),
    ("friction", "wedge", 5),
    ("pull", "wedge pulled uphill", 40),
    ("aspect", "slender column", 15),
]


@pytest.mark.parametrize(("picture", "name", "at"), KEPT)
def test_the_curves_on_file_are_what_slopekit_gives(picture, name, at, walked) -> None:
    """docs/hard-cases.json against a new run: the same status, the number to ten digits (rounding may differ)."""
    kept = next(
        sweep
        for sweep in json.loads(CURVES.read_text(encoding="utf-8"))["sweeps"]
        if (sweep["picture"], sweep["name"]) == (picture, name)
    )
    sweep = next(sweep for sweep in SWEEPS if (sweep.picture, sweep.name) == (picture, name))
    before = [
        found for found in walked.get((picture, name), ()) if found.value == kept["value"][at]
    ]
    found = before[0] if before else point(sweep.at(kept["value"][at]))
    assert found.status == kept["status"][at]
    assert found.limit == pytest.approx(
        kept["limit"][at], rel=1e-10 if kept["tolerance"] < 1e-6 else 1e-6
    )
    assert found.exact == pytest.approx(kept["exact"][at], rel=1e-15)
