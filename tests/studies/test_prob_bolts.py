"""Bolts in samples whose planes scatter: which hold the block, against lines cut with the faces of the block itself."""

import copy
from dataclasses import replace

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.errors import GeometryError
from slopekit.design.reading.files import load, with_values
from slopekit.kinds import cut, kind_of
from slopekit.kinds.single_block.held_bolts import holding_bolts
from slopekit.studies.evaluation.vectorised import vectorised
from slopekit.studies.prob import prob
from slopekit.studies.prob.sampling import samples
from tests.bolted import as_laid_out, holding, standing


def scatter(mean: float, sd: float) -> dict:
    return {"dist": "normal", "mean": mean, "sd": sd}


def bolt(
    east: float, up: float, length: float | None, before: float = 0.0, acts: str = "active"
) -> dict:
    """A bolt into a face that dips 65 toward 180, its head so far before it."""
    north = up / np.tan(np.radians(65.0))
    given = {
        "force": 150,
        "toward": "000/5",
        "acts": acts,
        "head": [east, float(north) - before, up - before * -0.087],
    }
    return given if length is None else given | {"length": length}


WEDGE = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {
        "face": {"dip": scatter(65, 4), "dip_direction": 180},
        "upper": "10/180",
        "height": 14,
    },
    "joints": {
        "J1": {"plane": {"dist": "fisher", "mean": "50/120", "k": 150}},
        "J2": {"plane": {"dip": scatter(48, 4), "dip_direction": 240}},
    },
    "strength": {"rock": {"c": 5, "phi": scatter(30, 2)}},
    "rock": {"unit_weight": 26},
    "support": {
        "bolts": [
            bolt(0.0, 5.0, 9.0),
            bolt(-1.0, 8.0, None, 0.5),
            bolt(3.0, 10.0, 6.0),
            bolt(-4.5, 12.0, 5.0),
            {"force": 50, "toward": "010/10"},
        ]
    },
}
CRACKED = WEDGE | {"crack": {"plane": "80/180", "distance": 2}}
PLANE = {
    "slopekit": 1,
    "kind": "plane",
    "slope": {
        "face": {"dip": scatter(65, 4), "dip_direction": scatter(180, 5)},
        "upper": "5/180",
        "height": 14,
    },
    "joints": {"J1": {"plane": {"dip": scatter(38, 4), "dip_direction": 185}}},
    "strength": {"rock": {"c": 5, "phi": scatter(33, 2)}},
    "rock": {"unit_weight": 26},
    "crack": {"depth": scatter(3, 0.5)},
    "support": {
        "bolts": [
            bolt(0.0, 4.0, 4.0),
            bolt(2.0, 9.0, 9.0),
            bolt(0.0, 12.5, None),
            bolt(0.0, 8.0, 6.5),
        ]
    },
}


def faces_met(block, head: np.ndarray, way: np.ndarray) -> list[tuple[float, int]]:
    """Where a line meets the faces of a block: how far from its head, and which; corner by corner of each polygon."""
    found = []
    for face, polygon in block.faces.items():
        normal = np.cross(polygon[1] - polygon[0], polygon[2] - polygon[0])
        if abs(normal @ way) < 1e-12:
            continue
        far = float(normal @ (polygon[0] - head) / (normal @ way))
        edges = np.roll(polygon, -1, axis=0) - polygon
        if (np.cross(edges, head + far * way - polygon) @ normal > 0.0).all():
            found.append((far, face))
    return sorted(found)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "values"), [("crack", CRACKED), ("plane", PLANE)])
def test_bolts_hold_whose_line_goes_in_by_a_free_face_and_out_by_a_joint(name, values) -> None:
    design = load(values)
    drawn, before, kind = samples(design.variables, (), 25, 5), as_laid_out(design), kind_of(design)
    off = {"wedge": 0.5, "crack": 0.5, "plane": 0.0}[name]
    assert before.max() == pytest.approx(off, abs=0.02)
    free = {"wedge": (2, 3), "plane": (1, 2)}[design.kind]
    seen = set()
    for row in range(25):
        sample = with_values(design, drawn.settings(row))
        try:
            made = cut(replace(sample, bolts=()))
        except GeometryError:
            continue
        onward = cut(
            replace(sample, bolts=(), crack=None, water=replace(sample.water, mode="dry"))
        ).block
        holds, _ = holding_bolts(kind.on_arrays.bounds(sample), sample.bolts, before)
        for k, one in enumerate(sample.bolts):
            if one.head_m is None:
                assert holds[k, 0]
                continue
            head, way = made.axes @ np.array(one.head_m), made.axes @ one.toward.vector()
            if design.kind == "plane":
                head, way = head * [1.0, 0.0, 1.0], way * [1.0, 0.0, 1.0]
            met = faces_met(made.block, head, way)
            last = faces_met(onward, head, way)[-1:]  # behind a crack as if it were not there
            passes = len(met) == 2 and met[0][1] in free and last[0][1] in made.joints
            ends = (one.length_m or np.inf) + (met[0][0] - before[k] if met else 0.0)
            assert holds[k, 0] == (passes and ends > last[0][0]), (row, k, met)
            seen.add(bool(holds[k, 0]))
        cut(standing(sample, before))  # refuses bolts that miss the block, or end within it
    assert seen == {True, False}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("values", "acts"),
    [(WEDGE, "passive"), (PLANE | {"slope": PLANE["slope"] | {"face": "65/180"}}, "active")],
    ids=["wedge", "plane"],
)
def test_both_methods_judge_the_same_bolts(values, acts) -> None:
    """PRE-IE cuts, loads and asks each sample by itself; its heads lie on that sample's face."""
    values = copy.deepcopy(values)
    for one in values["support"]["bolts"]:
        one["acts"] = acts
    count, target = 30 if acts == "passive" else 1_000, 1.6
    study = prob(load(values), count, seed=2, fos=target)
    assert (study.both.disagree, study.both.not_compared, study.both.without_answer) == (0, 0, 0)
    assert study.both.agree == study.forming.of == int(study.judged.forms.sum())
    (lost,) = (notice.message for notice in study.warnings if notice.code == "W311")
    holds = holding(
        study.design,
        [study.samples.settings(row) for row in range(count)],
        as_laid_out(study.design),
    )
    forms = study.judged.forms
    said = f"bolts give no force in {int((~holds.all(axis=0) & forms).sum())} of {int(forms.sum())} samples"
    assert lost.startswith(said)
    bare = prob(load(values | {"support": {"bolts": []}}), count, seed=2, fos=target)
    fixed = [
        {key: value for key, value in one.items() if key not in ("head", "length")}
        for one in values["support"]["bolts"]
    ]
    in_full = prob(load(values | {"support": {"bolts": fixed}}), count, seed=2, fos=target)
    assert (
        np.nanmean(bare.judged.factor)
        < np.nanmean(study.judged.factor)
        < np.nanmean(in_full.judged.factor)
    )
    assert in_full.all_samples.share <= study.all_samples.share <= bare.all_samples.share


def test_where_no_plane_scatters_heads_stay_and_all_bolts_hold() -> None:
    values = WEDGE | {
        "slope": WEDGE["slope"] | {"face": "65/180"},
        "joints": {"J1": {"plane": "50/120"}, "J2": {"plane": "48/240"}},
    }
    values["support"] = {"bolts": [bolt(0.0, 5.0, 12.0), bolt(-1.0, 8.0, None)]}
    design = load(values)
    assert standing(design, as_laid_out(design)).bolts[0].head_m == pytest.approx(
        design.bolts[0].head_m, abs=1e-12
    )
    study = prob(design, 50)
    assert "W311" not in [notice.code for notice in study.warnings]
    assert study.by_closed_form == study.all_samples


@pytest.mark.parametrize("given", [WEDGE, PLANE], ids=["wedge", "plane"])
def test_samples_one_by_one_are_held_as_all_at_once(given) -> None:
    design = load(given)
    drawn = samples(design.variables, design.correlation, 40, 1)
    fast = vectorised(design, drawn.values, drawn.settings)
    found = holding(design, [drawn.settings(row) for row in range(40)], as_laid_out(design))
    assert (found == fast.rows(drawn.values).holds).all()
    assert 0 < found.sum() < found.size


def test_a_bolt_that_holds_no_sample_counts_in_neither_method() -> None:
    short = {"bolts": [bolt(0.0, 5.0, 0.5)]}
    with_it, without = (prob(load(WEDGE | {"support": one}), 400) for one in (short, {"bolts": []}))
    assert with_it.judged.factor == pytest.approx(without.judged.factor, rel=1e-12, nan_ok=True)
    assert with_it.both.agree == with_it.forming.of > 300
    assert with_it.means.code == "E212"


#: A bolt from the face of a wedge, which sound rock begins 15.14 m behind.
SHORT_OR_LONG = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "65/185", "upper": "12/195", "height": 30},
    "joints": {"J1": {"plane": "45/105"}, "J2": {"plane": "70/235"}},
    "strength": {"weak": {"c": 24, "phi": 30}},
    "rock": {"unit_weight": 25},
    "support": {"bolts": [{"force": 500, "toward": "005/-10", "head": [-1, -6, 12], "length": 17}]},
}


@pytest.mark.parametrize("by", ["pre-ie", "closed-form"])
def test_samples_that_are_read_one_by_one_say_which_bolts_give_no_force(by, tmp_path) -> None:
    """A column phi of the joint list stands in place of the one that scatters: no sample is taken on arrays."""
    (tmp_path / "joints.csv").write_text("name,dip,dip_direction,phi\nJ1,45,105,30\nJ2,70,235,30\n")
    length = {"dist": "uniform", "min": 10, "max": 20}
    joints = {"csv": str(tmp_path / "joints.csv"), "pick": ["J1", "J2"], "strength": "weak"}
    design = load(
        SHORT_OR_LONG
        | {
            "joints": joints,
            "strength": {"weak": {"c": 24, "phi": scatter(30, 3)}},
            "support": {"bolts": [SHORT_OR_LONG["support"]["bolts"][0] | {"length": length}]},
        }
    )
    study = prob(design, 12, by=by)
    assert not study.rows.is_on_arrays
    lengths = study.samples.rows(0, 12)[:, [*study.samples.names].index("support.bolts.0.length")]
    bolted, bare = (
        sk.run(SHORT_OR_LONG | {"support": {"bolts": bolts}}).fos.closed_form
        for bolts in (SHORT_OR_LONG["support"]["bolts"], [])
    )
    assert study.judged.factor == pytest.approx(np.where(lengths > 15.14, bolted, bare), rel=1e-9)
    (said,) = (notice.message for notice in study.warnings if notice.code == "W311")
    assert said.startswith(
        f"bolts give no force in {int((lengths < 15.14).sum())} of 12 samples that form a block:"
    )


def test_the_closed_form_alone_counts_no_bolt_that_a_run_refuses() -> None:
    swept = sk.sweep(SHORT_OR_LONG, {"support.bolts.0.length": [14, 16]}, closed_form=True)
    assert [point.code for point in swept.points] == ["E212", ""]
