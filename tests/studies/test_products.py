"""Every feature of a wedge in every study: run's numbers, or one refusal that docs/howto/prob.md names."""

import copy
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.errors import DesignError
from slopekit.studies.evaluation import rows
from slopekit.studies.points import point_with

CRACKED: dict[str, Any] = {
    "slopekit": 1,
    "kind": "wedge",
    "joints": {
        "J1": {"plane": "45/105", "strength": "s"},
        "J2": {"plane": "70/235", "strength": "s"},
    },
    "slope": {"face": "65/185", "upper": "12/195", "height": 30},
    "strength": {"s": {"c": 24, "phi": 28}},
    "rock": {"unit_weight": 25},
    "crack": {"plane": "80/185", "distance": "3 m"},
}
BOLT = {"force": 800, "toward": "005/10"}
FEATURES: dict[str, dict[str, Any]] = {
    "no crack": {"crack": None},
    "crack half full": {"water": {"fill": 0.4}},
    "worst crack": {"crack": {"plane": "80/185", "distance": "worst"}},
    "basal joint": {"crack": None, "basal": {"plane": "20/185", "height": "4 m"}},
    "water table": {"water": {"mode": "table", "depth": "6 m"}},
    "pond": {"water": {"mode": "table", "depth": "6 m", "pond": "3 m"}},
    "water in the crack": {"crack": {"plane": "80/185", "distance": "3 m", "water": "2 m"}},
    "surcharge": {"loads": {"surcharge": "20 kPa"}},
    "earthquake": {"loads": {"seismic": {"k": 0.1}}},
    "force": {"loads": {"forces": [{"force": 500, "toward": "185/20"}]}},
    "passive bolts": {"support": {"bolts": [BOLT | {"acts": "passive"}]}},
    "active bolts": {"support": {"bolts": [BOLT]}},
    "residual strength": {"strength": {"s": {"c": 24, "phi": 28, "residual": {"c": 0, "phi": 25}}}},
    "limits of size": {"crack": None, "limits": {"persistence": 20}},
    "barton-bandis": {
        "strength": {"s": {"law": "barton-bandis", "jrc": 8, "jcs": "80 MPa", "phi_r": 26}}
    },
    "power": {"strength": {"s": {"law": "power", "a": 1.2, "b": 0.8}}},
    "dilation": {"strength": {"s": {"c": 24, "phi": 28, "dilation": 5}}},
}
#: What a study refuses, by its code.
REFUSED = {("support", "barton-bandis"): "E288", ("support", "power"): "E288"}
#: Designs that fail as they are: there is no yield acceleration.
FALLEN = ("crack half full", "water table", "pond")
KEY, NOW = "rock.unit_weight", 25.0


def with_feature(name: str) -> dict[str, Any]:
    document = copy.deepcopy(CRACKED) | FEATURES[name]
    return {key: value for key, value in document.items() if value is not None}


@pytest.mark.slow
@pytest.mark.parametrize("name", FEATURES)
def test_a_feature_in_every_study(name: str) -> None:
    document = with_feature(name)
    design = sk.load(document)
    run = sk.run(design)
    swept = sk.sweep(design, {KEY: [NOW, 1.1 * NOW]}).points[0].factors
    assert (swept.status, swept.limit) == (run.status, pytest.approx(run.fos.limit, rel=1e-12))
    assert swept.closed_form == pytest.approx(run.fos.closed_form, rel=1e-12)
    solved = sk.solve(design, KEY, fos=run.fos.limit)
    assert solved.answer.value == pytest.approx(NOW, rel=1e-6)
    drawn = document | {
        "rock": {"unit_weight": {"dist": "uniform", "min": NOW, "max": NOW * (1.0 + 1e-10)}}
    }
    study = sk.prob(sk.load(drawn), n=3)
    judged = study.judged.block_only or study.judged
    assert judged.factor == pytest.approx(run.fos.limit, rel=1e-8)
    assert study.outcomes.closed_form.factor == pytest.approx(run.fos.closed_form, rel=1e-8)
    assert {judged.names[number] for number in judged.outcome} == {run.status}
    assert "all at once" in judged.evaluator
    if name in FALLEN:
        with pytest.raises(DesignError) as caught:
            sk.quake(design, "sine:0.5g,2Hz")
        assert caught.value.codes == ("E520",)
    else:
        coefficient = sk.quake(design, "sine:0.5g,2Hz").yields[0].coefficient
        seismic = {"loads": document.get("loads", {}) | {"seismic": {"k": coefficient}}}
        assert sk.run(sk.load(document | seismic)).fos.limit == pytest.approx(1.0, abs=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("name", FEATURES)
def test_a_feature_in_many_rows_at_once(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of sixteen rows the extreme ones and a few are designs of their own; each of the others says what a run says."""
    document, weights = with_feature(name), np.linspace(20.0, 32.0, 16)
    design, single = sk.load(document), list[float]()

    def counted(*given: Any) -> Any:
        single.append(float(given[-1][KEY]))
        return point_with(*given)

    monkeypatch.setattr(rows, "point_with", counted)
    found = sk.evaluate(design, {KEY: weights})
    assert len(single) == 9
    for weight, point in zip(weights.tolist(), found.points, strict=True):
        if weight not in single:
            run, factors = sk.run(document, set={KEY: weight}), point.factors
            assert (factors.status, factors.agree) == (run.status, run.agree)
            assert (factors.moments_govern, factors.limit) == (
                run.moments_govern,
                pytest.approx(run.fos.limit, rel=1e-8),
            )
            assert factors.closed_form == pytest.approx(run.fos.closed_form, rel=1e-9)
            assert set(factors.notes) <= set(run.warnings)


@pytest.mark.slow
@pytest.mark.parametrize("name", FEATURES)
def test_a_feature_under_support(name: str) -> None:
    """The bolts that are found reach the target in a run of the design with them, or the study says that none do."""
    design = sk.load(with_feature(name))
    target = 1.05 * sk.run(design).fos.limit
    if ("support", name) in REFUSED:
        with pytest.raises(DesignError) as caught:
            sk.support(design, fos=target)
        assert caught.value.codes == (REFUSED["support", name],)
        return
    found = sk.support(design, fos=target)
    assert found.stands or any(case.bolts for case in found.cases)
    for case in found.cases:
        if case.reached:
            built = sk.run(replace(design, bolts=(*design.bolts, *case.bolts)))
            assert built.fos.limit == pytest.approx(case.factors.limit, rel=1e-9)
            assert built.fos.limit >= target * (1.0 - 1e-9)


def test_the_page_names_what_is_refused() -> None:
    page = Path("docs/howto/prob.md").read_text(encoding="utf-8")
    table = [[cell.strip() for cell in line.strip("|").split("|")] for line in page.splitlines()]
    for name in FEATURES:
        _, samples, support = next(cells for cells in table if cells[0] == name)
        assert samples == "all at once"
        assert support == REFUSED.get(("support", name), "run's limit")
