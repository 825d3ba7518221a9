"""Every sample by both methods, all at once: against designs that are read, cut and analysed one by one."""

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
import pytest

import slopekit as sk
from slopekit.studies.points import point_of
from slopekit.studies.prob.run import Probability
from tests.bolted import as_laid_out, standing
from tests.studies.test_prob_cracks import CASES as WORST
from tests.studies.test_probability import SHELF, WILD

BOLT = {"force": 800, "toward": "000/10", "head": [1, -1.0, 4.0], "length": 30}
SHAKEN = {
    "seismic": {"k": 0.1, "toward": 200},
    "forces": [{"force": 500, "toward": "180/40", "at": [0, 2, 9]}],
}
PRESSED = WILD | {
    "water": {"pressures": {"J1": 20, "J2": {"dist": "uniform", "min": 0, "max": 30}}},
    "support": {"bolts": [BOLT]},
    "loads": SHAKEN,
}
CRACKED = WILD | {
    "crack": {"plane": "80/180", "distance": {"dist": "uniform", "min": 0.2, "max": 6}}
}
CUT = WILD | {
    "basal": {"plane": "15/175", "height": "3 m", "strength": "b"},
    "slope": WILD["slope"] | {"height": 20},
}
DRY = WILD | {"water": {"fill": 0}, "loads": {}, "support": {}}
SLAB = {key: part for key, part in SHELF.items() if key != "crack"} | {
    "support": {"bolts": [{"force": 100, "toward": "010/05", "acts": "active"}]},
}
FILLED = {"distance": {"dist": "uniform", "min": 1, "max": 3}, "water": "2 m"}
STANDING = {key: part for key, part in SLAB.items() if key != "water"} | {"crack": FILLED}


def checked(study: Probability, settings: Any, rows: int, step: int) -> set[str]:
    """Compare samples, each `step`-th, with single designs; return the outcomes that were met.

    Parameters
    ----------
    settings : the values of a sample by its number
    """
    design, met = study.design, set[str]()
    assert study.judged.evaluator == "closed form and PRE-IE of every sample, all at once"
    assert study.outcomes is not None
    assert study.outcomes.closed_form is not None
    closed = study.outcomes.closed_form.factor
    for row in range(0, rows, step):
        outcome, factor = study.judged.names[study.judged.outcome[row]], study.judged.factor[row]
        if outcome.startswith("whole_wedge_"):  # judged by what acceptance is held against besides
            continue
        met.add(outcome)
        values: Mapping[str, object] = settings(row)
        point = point_of(design, values, True, partial(standing, before=as_laid_out(design)))
        if point.factors is None:
            assert outcome == point.code
            assert np.isnan([factor, closed[row]]).all()
            continue
        assert outcome == point.factors.status
        assert (point.factors.limit is None) == np.isnan(factor)
        assert point.factors.limit is None or factor == pytest.approx(point.factors.limit, rel=1e-6)
        assert closed[row] == pytest.approx(
            point.factors.closed_form or np.nan, rel=1e-9, nan_ok=True
        )
        assert bool(study.outcomes.moments_govern[row]) == point.factors.moments_govern
        assert study.outcomes.agree[row] == (
            -1 if point.factors.agree is None else point.factors.agree
        )
    return met


@pytest.mark.parametrize(
    ("values", "met"),
    [
        (DRY, {"slides_on_both", "rotates"}),
        (SLAB, {"slides_on_J1", "E213"}),
        (SHELF, {"slides_on_J1", "E207"}),
        pytest.param(
            WILD, {"slides_on_both", "rotates", "lifted", "topples", "E205"}, marks=pytest.mark.slow
        ),
        pytest.param(CRACKED, {"slides_on_both", "rotates", "E208"}, marks=pytest.mark.slow),
        pytest.param(
            CUT,
            {"slides_on_basal", "slides_on_J2_and_basal", "slides_on_J1_and_J2", "rotates"},
            marks=pytest.mark.slow,
        ),
        pytest.param(PRESSED, {"slides_on_both", "rotates"}, marks=pytest.mark.slow),
        pytest.param(STANDING, {"slides_on_J1", "E207"}, marks=pytest.mark.slow),
    ],
    ids=[
        "dry",
        "plane",
        "cracked plane",
        "wet",
        "crack",
        "basal",
        "pressures",
        "water in the crack",
    ],
)
def test_all_at_once_is_one_by_one(values: dict[str, Any], met: set[str]) -> None:
    """Outcome, factor, whether moments govern and whether the methods agree, of fifty samples of three hundred."""
    study = sk.prob(sk.load(values), 300, seed=3)
    assert met <= checked(study, study.samples.settings, 300, 6)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "met"),
    [
        ("wet wedge", {"topples"}),
        ("bolted wedge", {"slides_on_both"}),
        ("plane", {"slides_on_J1", "E203"}),
        ("dry plane", {"slides_on_J1", "E203"}),
    ],
)
def test_worst_cracks_all_at_once_are_cracks_at_those_places(name: str, met: set[str]) -> None:
    """Forty samples, each cut by a crack at the place that was found."""
    design = sk.load(WORST[name])
    study = sk.prob(design, 40, seed=4)
    assert study.rows.columns.searches_crack
    assert checked(study, study.samples.settings, 40, 1) == met
