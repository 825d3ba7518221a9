"""Sizes of the samples of `prob` and limits of size, against designs that are read and cut one by one."""

from typing import Any

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.errors import GeometryError
from slopekit.design.reading.files import with_values
from slopekit.kinds.wedge import cut
from slopekit.studies.prob.run import Probability

WEDGE: dict[str, Any] = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "65/185", "upper": "12/195", "height": 20},
    "joints": {
        "A": {"plane": {"dist": "fisher", "mean": "45/115", "k": 80}},
        "B": {"plane": {"dist": "fisher", "mean": "68/235", "k": 80}},
    },
    "strength": {"joint": {"c": 5, "phi": {"dist": "normal", "mean": 32, "sd": 3}}},
    "rock": {"unit_weight": 25},
}
LIMITS = {
    "bench_width": 4,
    "trace_length": {"A": {"dist": "lognormal", "mean": 12, "sd": 4}},
    "max_volume": 60,
}


def drawn(limits: Any = None, **more: Any) -> Probability:
    """A study of the wedge."""
    design = WEDGE | ({} if limits is None else {"limits": limits})
    return sk.prob(sk.load(design), 300, **({"seed": 3} | more))


def test_sizes_of_samples_are_those_of_the_wedges_read_one_by_one() -> None:
    """Volume, height, width, setback and scale of twenty samples from the cut bodies; the factor stays PRE-IE's."""
    study = drawn(LIMITS)
    assert study.judged.evaluator == "closed form and PRE-IE of every sample, all at once"
    assert study.both is not None
    assert (study.both.disagree, study.both.not_compared) == (0, 0)
    columns = study.sizes
    for row in np.flatnonzero(~np.isnan(study.judged.factor))[:20].tolist():
        found = cut(with_values(study.design, study.samples.settings(row))).geometry()
        for key in ("volume_m3", "height_m", "face_width_m", "setback_m"):
            assert columns[key][row] == pytest.approx(getattr(found, key), rel=1e-7), key
        assert columns["scale"][row] == pytest.approx(found.scaled["factor"], rel=1e-9)
    scaled = study.scaled_down
    assert scaled == np.count_nonzero(columns["scale"] < 1.0) > 0
    assert f"{scaled} samples made smaller" in " ".join(
        str(study).split()
    )  # nothing is changed silently
    assert np.nanmax(columns["setback_m"]) <= 4.0 * (1 + 1e-12)
    assert study.to_dict()["scaled_down"] == scaled


def test_filtered_samples_form_no_wedge() -> None:
    """The same samples: those that scaling makes smaller are E486, and count among no wedges; E487 the smallest."""
    scaled = drawn({"bench_width": 7})
    left = drawn({"bench_width": 7, "min_volume": 30, "by": "filter"})
    whole = drawn()
    assert scaled.scaled_down == left.counts["E486"] > 0
    assert left.counts["E487"] > 0
    assert left.forming.of == whole.forming.of - left.counts["E486"] - left.counts["E487"] > 0
    gone = np.array(left.judged.names)[left.judged.outcome] == "E486"
    with pytest.raises(GeometryError, match="bench width"):
        cut(with_values(left.design, left.samples.settings(int(np.flatnonzero(gone)[0]))))
    assert scaled.all_samples.of == left.all_samples.of == whole.all_samples.of


def test_planes_have_sizes_per_metre() -> None:
    """Setback of a plane whose dip scatters, sample by sample; the CSV has it."""
    design = {
        "slopekit": 1,
        "kind": "plane",
        "slope": {"face": "65/180", "upper": "5/180", "height": 14},
        "joints": {
            "J1": {"plane": {"dip": {"dist": "normal", "mean": 38, "sd": 4}, "dip_direction": 185}}
        },
        "strength": {"joint": {"c": 10, "phi": 30}},
        "rock": {"unit_weight": 26},
    }
    study = sk.prob(sk.load(design), 100, by="closed-form")
    for row in range(5):
        alone = sk.run(with_values(study.design, study.samples.settings(row)))
        for key in ("setback_m", "height_m", "volume_m3"):
            assert study.sizes[key][row] == pytest.approx(getattr(alone.geometry, key), rel=1e-9)
    names = [column.key for column in study.sheet.tables["samples.csv"].columns]
    assert {"volume_m3", "setback_m", "height_m"} <= set(names)
