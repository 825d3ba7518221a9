"""Rows of `evaluate` are runs of designs with those numbers: statuses, factors, what is said, why no block forms."""

from typing import Any

import numpy as np
import pandas as pd
import pytest

import slopekit as sk

WEDGE: dict[str, Any] = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "65/185", "upper": "12/195", "height": 20},
    "joints": {
        "J1": {"plane": "45/105", "strength": "a"},
        "J2": {"plane": "70/235", "strength": "b"},
    },
    "strength": {"a": {"c": 12, "phi": 33}, "b": {"c": 5, "phi": 30}},
    "water": {"fill": 0.2},
}
FALLING = {"law": "power", "a": 1.5, "b": 0.8}
#: Few rows, each a design of its own, and many on arrays: they are the same either way.
DESIGNS = {
    "wedge": WEDGE,
    "curved": WEDGE | {"strength": {"a": FALLING, "b": {"c": 5, "phi": 30}}},
    "dilation": WEDGE
    | {"strength": {"a": {"c": 12, "phi": 33, "dilation": 3}, "b": {"c": 5, "phi": 30}}},
    "worst crack": WEDGE | {"crack": {"plane": "80/185", "distance": "worst"}},
    "passive": WEDGE
    | {"support": {"bolts": [{"force": 500, "toward": "005/10", "acts": "passive"}]}},
}


def rows_of(count: int, seed: int) -> dict[str, list[float]]:
    rng = np.random.default_rng(seed)
    return {
        "joints.J1.plane.dip_direction": rng.uniform(80, 190, count).tolist(),
        "slope.face.dip": rng.uniform(50, 80, count).tolist(),
        "water.fill": rng.uniform(0, 1, count).tolist(),
        "strength.b.phi": rng.uniform(0.5, 40, count).tolist(),
    }


@pytest.mark.parametrize(
    ("name", "count"),
    [("wedge", 60), ("curved", 4), ("dilation", 4), ("passive", 6), ("worst crack", 40)],
)
def test_rows_are_runs(name: str, count: int) -> None:
    design, columns = DESIGNS[name], rows_of(count, 3)
    found = sk.evaluate(design, columns)
    words, codes = found.limit.words, set[str]()
    for row in range(count):
        values = {path: of[row] for path, of in columns.items()}
        if words[row].startswith("E"):
            with pytest.raises(sk.SlopekitError) as refused:
                sk.run(design, set=values)
            first, point = refused.value.faults[0], found.points[row]
            assert (first.code, first.message) == (point.code, point.message)
            assert np.isnan(found.limit.factor[row])
            codes.add(words[row])
            continue
        run = sk.run(design, set=values)
        assert words[row] == run.status
        assert found.limit.factor[row] == pytest.approx(
            run.fos.limit or np.nan, rel=1e-8, nan_ok=True
        )
        assert found.closed_form.factor[row] == pytest.approx(
            run.fos.closed_form or np.nan, rel=1e-10, nan_ok=True
        )
        assert found.agree[row] == (-1 if run.agree is None else run.agree)
        assert found.moments_govern[row] == run.moments_govern
    assert len(codes) > 1 if name == "wedge" else True


def test_columns_are_numbers_texts_frames_or_one_for_all() -> None:
    plain = sk.evaluate(WEDGE, {"slope.height": [10, 20.0], "water.fill": 0.5})
    same: list[Any] = [
        {"slope.height": ["10 m", "2000 cm"], "water.fill": "50%"},
        {"slope.height": np.array([10, 20]), "water.fill": [0.5]},
        pd.DataFrame({"slope.height": [10, 20], "water.fill": [0.5, 0.5]}),
    ]
    for columns in same:
        assert sk.evaluate(WEDGE, columns).limit.factor.tolist() == plain.limit.factor.tolist()
    two = sk.evaluate(WEDGE, rows_of(30, 5), jobs=2)
    assert two.limit.factor.tobytes() == sk.evaluate(WEDGE, rows_of(30, 5)).limit.factor.tobytes()


def test_the_closed_form_alone_and_blocks_that_have_none() -> None:
    columns = rows_of(20, 4)
    alone, both = sk.evaluate(WEDGE, columns, closed_form=True), sk.evaluate(WEDGE, columns)
    np.testing.assert_array_equal(alone.closed_form.factor, both.closed_form.factor)
    assert alone.limit is alone.closed_form
    assert all(point.factors is None or point.factors.limit is None for point in alone.points)
    blocks = sk.load("templates/blocks.yaml")
    found = sk.evaluate(blocks, {"loads.seismic.k": [0.0, 0.05]})
    assert [
        point.factors.limit for point in found.points if point.factors
    ] == found.limit.factor.tolist()
    assert found.limit.factor[0] > found.limit.factor[1]
    with pytest.raises(sk.DesignError, match="E313"):
        sk.evaluate(blocks, {"loads.seismic.k": [0.0]}, closed_form=True)


@pytest.mark.parametrize(
    ("columns", "code"),
    [
        ({}, "E312"),
        ({"water.fill": [0, 1], "slope.height": [1, 2, 3]}, "E312"),
        ({"water.fil": [0]}, "E310"),
        ({"water": [0]}, "E311"),
        ({"water.fill": [0, np.nan]}, "E105"),
        ({"water.fill": ["full"]}, "E106"),
        (5, "E405"),
        ("water.fill", "E405"),
        ({"loads.seismic": [0.1], "loads.seismic.k": [0.2]}, "E313"),
        ({"water.fill": [None]}, "E106"),
    ],
)
def test_what_is_refused(columns: Any, code: str) -> None:
    with pytest.raises(sk.DesignError, match=code):
        sk.evaluate(WEDGE, columns)
