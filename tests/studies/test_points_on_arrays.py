"""Points that a sweep takes all at once are those of runs: numbers, statuses, notices, and reasons where none forms."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import slopekit as sk
from slopekit.studies.evaluation import columns, rows, vectorised
from slopekit.studies.keys import key_of, values_of
from slopekit.studies.points import point_with

WEDGE: dict[str, Any] = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "65/185", "upper": "12/195", "height": 20},
    "joints": {
        "J1": {"plane": "45/105", "strength": "a"},
        "J2": {"plane": "70/235", "strength": "b"},
    },
    "strength": {"a": {"c": 12, "phi": 33}, "b": {"c": 5, "phi": 30}},
}
PLANE: dict[str, Any] = {
    "slopekit": 1,
    "kind": "plane",
    "slope": {"face": "65/185", "upper": "12/195", "height": 20},
    "joints": {"J1": {"plane": "38/185", "strength": "s"}},
    "strength": {"s": {"c": 12, "phi": 33}},
    "rock": {"unit_weight": 26},
}
GRIDS: dict[str, tuple[dict[str, Any], dict[str, list[float]]]] = {
    "water and friction": (
        WEDGE,
        {"water.fill": [0, 0.2, 0.5, 0.9, 1.0], "strength.a.phi": [20, 30, 40, 45]},
    ),
    "a joint turns until no wedge forms": (
        WEDGE,
        {
            "joints.J1.plane.dip_direction": [60, 100, 130, 160, 200, 230, 300],
            "slope.face.dip": [50, 65, 85],
        },
    ),
    "shaking, across and against": (
        WEDGE | {"loads": {"seismic": {"k": 0.1, "toward": 90}}, "water": {"fill": 0.4}},
        {
            "loads.seismic.toward": [0, 40, 90, 140, 180, 270, 320],
            "loads.seismic.k": [0, 0.05, 0.2],
        },
    ),
    "water lifts a joint": (
        WEDGE | {"water": {"fill": 0.5}},
        {
            "water.fill": [0.1, 0.4, 0.7, 0.8, 0.9, 0.95, 1.0],
            "joints.J2.plane.dip": [55, 62, 70],
        },
    ),
    "strength that is none": (
        WEDGE,
        {"strength.a.c": [0, 0.5, 1, 2, 3, 4, 5], "strength.b.phi": [0, 10, 20]},
    ),
    "a friction angle that looks like radians": (
        WEDGE,
        {"strength.a.phi": [0, 0.5, 1, 1.5, 2, 10, 20, 30, 40, 45], "strength.b.phi": [20, 25, 30]},
    ),
    "joints that become nearly parallel": (
        WEDGE | {"water": {"fill": 0.3}},
        {
            "joints.J1.plane.dip_direction": [*range(100, 260, 8), 233, 237],
            "joints.J1.plane.dip": [45, 60, 70],
        },
    ),
    "a crack": (
        WEDGE | {"crack": {"plane": "80/185", "distance": 3}, "water": {"fill": 0.2}},
        {"crack.distance": [0.5, 1, 2, 3, 5, 8, 12], "water.fill": [0, 0.3, 0.6]},
    ),
    "a basal joint": (
        WEDGE | {"basal": {"plane": "20/185", "height": 4, "strength": "a"}},
        {"basal.height": [1, 2, 3, 4, 6, 9, 15], "strength.a.c": [0, 10, 20]},
    ),
    "the second joint alone turns above a basal joint": (
        WEDGE | {"basal": {"plane": "20/185", "height": 4, "strength": "a"}},
        {
            "joints.J2.plane.dip": [60, 65, 70, 75, 80],
            "joints.J2.plane.dip_direction": [225, 235, 245],
        },
    ),
    "bolts that some slopes leave without hold": (
        WEDGE
        | {
            "support": {
                "bolts": [
                    {
                        "force": 300,
                        "toward": "005/5",
                        "head": [0.5, 2.1, 5],
                        "length": 8,
                        "acts": "passive",
                    },
                    {
                        "force": 200,
                        "toward": "000/-5",
                        "head": [0, 3, 8],
                        "length": 6.2,
                        "acts": "active",
                    },
                ]
            },
            "water": {"fill": 0.3},
        },
        {
            "slope.face.dip": [58, 60, 62, 64, 65, 66, 68, 70, 74, 78],
            "joints.J1.plane.dip": [41, 45, 50],
        },
    ),
    "joints that dilate, some of which open": (
        WEDGE
        | {
            "strength": {
                "a": {"c": 12, "phi": 33, "dilation": 4},
                "b": {"c": 5, "phi": 30, "dilation": 2},
            }
        },
        {"strength.a.dilation": [0, 2, 5, 8, 12, 20, 32, 33, 34, 40], "water.fill": [0, 0.15, 0.5]},
    ),
    "lengths and heads of bolts": (
        PLANE
        | {
            "support": {
                "bolts": [
                    {
                        "force": 80,
                        "toward": "005/0",
                        "head": [0, 3, 7],
                        "length": 9,
                        "acts": "active",
                    }
                ]
            }
        },
        {
            "support.bolts.0.length": [1, 3, 4, 5, 6, 7, 8, 12],
            "support.bolts.0.head.2": [4, 6.9, 7, 8],
        },
    ),
    "a worst crack": (
        WEDGE | {"crack": {"plane": "80/185", "distance": "worst"}},
        {"water.fill": [0, 0.2, 0.5, 1], "joints.J1.plane.dip_direction": [90, 105, 150, 200, 230]},
    ),
    "a worst crack of a plane": (
        PLANE | {"crack": {"distance": "worst", "water": "40 %"}, "loads": {"surcharge": "10 kPa"}},
        {"joints.J1.plane.dip": [8, 12.5, 25, 38, 45, 64, 70], "strength.s.phi": [0, 20, 33]},
    ),
    "a worst crack above a basal joint": (
        WEDGE
        | {
            "basal": {"plane": "20/185", "height": 4, "strength": "a"},
            "crack": {"plane": "80/185", "distance": "worst"},
        },
        {"basal.height": [1, 3, 4, 6, 9, 15], "water.fill": [0, 0.4]},
    ),
    "a plane shaken off its section": (
        PLANE | {"loads": {"seismic": {"k": 0.1, "toward": 185}}},
        {"loads.seismic.toward": [95, 140, 185, 200, 250], "loads.seismic.k": [0, 0.05, 0.2]},
    ),
    "bolts aside of a plane, some of which the movement does not draw out": (
        PLANE | {"support": {"bolts": [{"force": 80, "toward": "005/0", "acts": "passive"}]}},
        {
            "support.bolts.0.toward.trend": [5, 35, 95, 150, 185],
            "support.bolts.0.toward.plunge": [-20, 10, 60],
        },
    ),
    "a bolt that pulls out of the face": (
        WEDGE | {"support": {"bolts": [{"force": 80, "toward": "005/0", "acts": "active"}]}},
        {"support.bolts.0.toward.trend": [5, 35, 95, 150, 185], "rock.unit_weight": [12, 26, 60]},
    ),
    "a pond": (
        PLANE | {"water": {"mode": "table", "pond": 2}},
        {"water.pond": [-1, 0, 2, 12, 19, 25], "strength.s.phi": [25, 33]},
    ),
    "a plane": (
        PLANE | {"water": {"fill": 0.2}},
        {"joints.J1.plane.dip": [25, 30, 38, 45, 60, 64, 70, 80], "water.fill": [0, 0.5, 1.0]},
    ),
}


@pytest.mark.parametrize("name", GRIDS)
def test_points_at_once_are_those_of_runs(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    document, grid = GRIDS[name]
    design, analysed = sk.load(document), list[Any]()

    def counted(*given: Any) -> Any:
        analysed.append(given)
        return point_with(*given)

    monkeypatch.setattr(rows, "point_with", counted)
    swept = sk.sweep(design, grid)
    keys = [key_of(design, path) for path in grid]
    assert len(analysed) < len(swept.points)
    for place, point in zip(swept.places, swept.points, strict=True):
        run = point_with(
            design, True, not name.startswith("lengths"), values_of(design, keys, place)
        )
        assert (point.code, point.message) == (run.code, run.message)
        if run.factors is None or point.factors is None:
            assert run.factors is point.factors
            continue
        ours, runs = point.factors, run.factors
        assert (ours.status, ours.closed_status, ours.agree) == (
            runs.status,
            runs.closed_status,
            runs.agree,
        )
        assert (ours.moments_govern, set(ours.notes)) == (runs.moments_govern, set(runs.notes))
        assert (ours.also is None) == (runs.also is None)
        pairs = [(ours.limit, runs.limit, 1e-8), (ours.closed_form, runs.closed_form, 1e-12)]
        if ours.also is not None and runs.also is not None:
            assert ours.also.status == runs.also.status
            pairs.append((ours.also.factor, runs.also.factor, 1e-12))
        for own, of_run, part in pairs:
            assert own == (None if of_run is None else pytest.approx(of_run, rel=part))


def test_points_without_an_answer_on_arrays_are_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where PRE-IE does not converge the methods are not compared, which is no agreement."""
    limits_on_arrays, places = (
        vectorised.limits_on_arrays,
        {"strength.a.phi": [float(phi) for phi in range(20, 41)]},
    )

    def without_some(*given: Any) -> Any:
        limits = limits_on_arrays(*given)
        return replace(limits, status=np.where(limits.limit > 1.9, "not_converged", limits.status))

    design = sk.load(WEDGE)
    expected = sk.sweep(design, places)
    monkeypatch.setattr(vectorised, "limits_on_arrays", without_some)
    monkeypatch.setattr(columns, "_agrees_with_run", lambda *_: True)
    answers = [
        (point.factors.status, point.agree)
        for point in sk.sweep(design, places).points
        if point.factors
    ]
    assert answers == [
        (point.factors.status, point.agree) for point in expected.points if point.factors
    ]
