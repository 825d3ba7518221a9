"""Probability of failure against quadrature, against one sample at a time, and against itself on other workers."""

import csv
import json
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.stats import binom, multivariate_normal, norm

import slopekit as sk
from slopekit.core.errors import DesignError
from slopekit.core.orientation import Plane
from slopekit.design.reading.files import load
from slopekit.kinds.protocol import Factors
from slopekit.studies import running
from slopekit.studies.points import Point, point_of
from slopekit.studies.prob import prob
from slopekit.studies.prob.estimates import clopper_pearson, share_of, summary_of
from slopekit.studies.prob.rows import SampleRows
from slopekit.studies.protocol import Workplace
from slopekit.studies.running import Interrupted
from tests.closed_form.scalar_wedge import hoek_bray_wedge
from tests.commands import slopekit

PHI = {"dist": "normal", "mean": 20, "sd": 2}


def default_wedge(correlation: float | None = None) -> dict:
    """The paper's wedge with φ = N(20, 2) on each plane."""
    wedge = {
        "slopekit": 1,
        "kind": "wedge",
        "joints": {
            "J1": {"plane": "45/115", "strength": "a"},
            "J2": {"plane": "45/245", "strength": "b"},
        },
        "slope": {"face": "60/180", "upper": "10/180", "height": 64.89},
        "strength": {"a": {"c": 50, "phi": PHI}, "b": {"c": 50, "phi": PHI}},
        "rock": {"density": 2600},
    }
    return wedge | ({} if correlation is None else {"correlation": {"J1.phi/J2.phi": correlation}})


DILATING = default_wedge() | {
    "strength": {"a": {"c": 50, "phi": PHI, "dilation": 2}, "b": {"c": 50, "phi": PHI}}
}
#: Samples of it are read one by one.
FOOTING = {
    "slopekit": 1,
    "kind": "footing",
    "footing": {"load": 2000, "at": 2.5},
    "weak_plane": {"dip": 40, "length": 8, "strength": "seam"},
    "strength": {"seam": {"c": 120, "phi": PHI}},
}


def by_quadrature(target: float, rank: float) -> float:
    """P(F < target): F is a + b (tan φ₁ + tan φ₂), φ₁ and φ₂ normal with r = 2 sin(π ρ / 6) (Pearson 1907).

    a and b come from two factors of the scalar closed form, which other tests hold to 50 digits.
    """

    def factor(phi: float) -> float:
        wedge = hoek_bray_wedge(
            (Plane(45, 115), Plane(45, 245)),
            Plane(60, 180),
            Plane(10, 180),
            64.89,
            (50, 50),
            (phi, phi),
            2600 * 9.81 / 1000,
        )
        return wedge.factor

    a = factor(0.0)
    b = (factor(45.0) - a) / 2.0

    def limit(phi: float) -> float:
        return math.degrees(math.atan((target - a) / b - math.tan(math.radians(phi))))

    r = 2.0 * math.sin(math.pi * rank / 6.0)
    if rank == 1.0:
        return float(norm.cdf(brentq(lambda phi: factor(phi) - target, 0.0, 80.0), 20.0, 2.0))

    def inner(z: float) -> float:
        return norm.pdf(z) * norm.cdf(((limit(20 + 2 * z) - 20) / 2 - r * z) / math.sqrt(1 - r * r))

    return quad(inner, -9.0, 9.0, epsabs=1e-12, limit=200)[0]


@pytest.mark.parametrize("method", ["monte-carlo", "latin-hypercube"])
@pytest.mark.parametrize("rank", [None, 0.8])
def test_the_default_wedge_against_quadrature(rank, method) -> None:
    for target in (1.0, 1.4, 1.5):
        exact = by_quadrature(target, rank or 0.0)
        study = prob(
            load(default_wedge(rank)),
            20_000,
            method=method,
            fos=target,
            by="closed-form",
            confidence=0.999,  # 27 comparisons: one in twenty would miss at 0.95
        )
        assert study.judged.evaluator == "closed form of every sample, all at once"
        assert study.all_samples.low <= exact <= study.all_samples.high
        assert study.all_samples == study.forming
        if target == 1.5:
            assert study.all_samples.share == pytest.approx(
                exact, abs=0.012 if method == "monte-carlo" else 0.006
            )
    if method != "monte-carlo":  # what the replicates are for: their limits are the narrower ones
        low, high = clopper_pearson(study.all_samples.count, study.all_samples.of, 0.999)
        assert study.all_samples.limits_by.endswith("replicates")
        assert study.all_samples.high - study.all_samples.low < 0.8 * (high - low)


def test_quadrature_itself_against_the_bivariate_normal() -> None:
    """Where tan is nearly straight, F < target is nearly φ₁ + φ₂ < s: the sum of two normals."""
    for rank in (0.3, 0.8):
        r = 2.0 * math.sin(math.pi * rank / 6.0)
        limit = brentq(lambda s: by_quadrature(1.5, 1.0) - norm.cdf(s / 2, 20, 2), 30, 45)
        assert by_quadrature(1.5, rank) == pytest.approx(
            norm.cdf(limit, 40.0, 2 * math.sqrt(2 + 2 * r)), abs=2e-3
        )
    assert multivariate_normal([0, 0], [[1, 0.5], [0.5, 1]]).cdf([0, 0]) == pytest.approx(
        1 / 3, abs=1e-6
    )


WILD = {
    "slopekit": 1,
    "kind": "wedge",
    "joints": {
        "J1": {"plane": {"dist": "fisher", "mean": "45/125", "k": 60}, "strength": "a"},
        "J2": {
            "plane": {
                "dip": {"dist": "normal", "mean": 60, "sd": 12},
                "dip_direction": {"dist": "uniform", "min": 200, "max": 290},
            },
            "strength": "b",
        },
    },
    "slope": {
        "face": {"dist": "fisher", "mean": "65/180", "k": 800},
        "upper": "10/180",
        "height": {"dist": "triangular", "min": 10, "mode": 20, "max": 40},
    },
    "strength": {
        "a": {"c": {"dist": "lognormal", "mean": 20, "sd": 10}, "phi": PHI},
        "b": {"c": 30, "phi": {"dist": "normal", "mean": 30, "sd": 4, "min": 20, "max": 40}},
    },
    "rock": {"density": {"dist": "normal", "mean": 2600, "sd": 50}},
    "water": {"fill": {"dist": "uniform", "min": 0, "max": 1}},
    "loads": {"seismic": {"k": {"dist": "uniform", "min": 0, "max": 0.2}}},
    "support": {
        "bolts": [{"force": {"dist": "normal", "mean": 2000, "sd": 300}, "toward": "000/10"}]
    },
    "correlation": {"a.phi/a.c": -0.5, "a.phi/b.phi": 0.6},
}


SHELF = {
    "slopekit": 1,
    "kind": "plane",
    "slope": {
        "face": {"dip": {"dist": "normal", "mean": 60, "sd": 3}, "dip_direction": 180},
        "height": "12 m",
        "upper": "5/180",
    },
    "joints": {"J1": {"plane": {"dist": "fisher", "mean": "35/185", "k": 60}, "strength": "s"}},
    "strength": {
        "s": {"c": {"dist": "lognormal", "mean": 25, "sd": 10}, "phi": PHI | {"mean": 37}}
    },
    "rock": {"unit_weight": 26},
    "crack": {"depth": {"dist": "uniform", "min": 2, "max": 6}},
    "water": {"fill": {"dist": "uniform", "min": 0, "max": 1}},
    "loads": {"seismic": {"k": 0.05, "toward": 170}},
    "support": {
        "bolts": [{"force": {"dist": "normal", "mean": 200, "sd": 30}, "toward": "010/05"}]
    },
}


def test_directions_about_north_have_a_mean_about_north() -> None:
    """Directions N(2°, 10°) lie about 2°; the factor falls as J1 turns away from the line, whatever the 360 in between.

    Turned by 90°, where no direction passes 360, the same seed gives the same sds, coefficients and factors.
    """

    def at(turn: float) -> tuple[dict[str, float], dict[str, float]]:
        found = prob(
            sk.load(
                {
                    **default_wedge(),
                    "slope": {"face": [60, turn], "upper": [10, turn], "height": 64.89},
                    "joints": {
                        "J1": {
                            "plane": {
                                "dip": 45,
                                "dip_direction": {"dist": "normal", "mean": turn + 2.0, "sd": 10},
                            },
                            "strength": "a",
                        },
                        "J2": {"plane": [45, turn + 65.0], "strength": "b"},
                    },
                }
            ),
            n=400,
            by="closed-form",
            seed=3,
        )
        drawn = {one["path"]: one for one in found.variables}["joints.J1.plane.dip_direction"]
        assert (drawn["min"] - turn) % 360.0 > 320.0
        assert (drawn["max"] - turn) % 360.0 < 40.0
        return {"mean": (drawn["mean"] - turn) % 360.0, "sd": drawn["sd"]}, dict(
            found.sensitivities
        )

    north, east = at(0.0), at(90.0)
    assert north[0] == pytest.approx({"mean": 2.0, "sd": 10.0}, abs=1.5)
    assert north[0] == pytest.approx(east[0], abs=1e-9)
    assert north[1] == pytest.approx(east[1], abs=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("values", "met"),
    [
        (WILD, {"slides_on_both", "slides_on_J1", "slides_on_J2", "E204"}),
        (SHELF, {"slides_on_J1", "E207", "E213"}),
    ],
    ids=["wedge", "plane"],
)
def test_all_at_once_is_one_at_a_time(values, met) -> None:
    design = load(values)
    study = prob(design, 2_000, seed=3, by="closed-form")
    assert study.judged.evaluator == "closed form of every sample, all at once"
    seen = set()
    for row in range(0, 2_000, 12):
        point = point_of(design, study.samples.settings(row), pre_ie=False)
        name = study.judged.names[study.judged.outcome[row]]
        seen.add(name)
        if point.factors is None:
            assert name == point.code
            continue
        assert name == point.factors.status
        if point.factors.closed_form is None:
            assert np.isnan(study.judged.factor[row])
        else:
            assert study.judged.factor[row] == pytest.approx(point.factors.closed_form, rel=1e-12)
    assert met <= seen
    assert sum(study.counts.values()) == 2_000
    assert study.forming.of == sum(
        count for name, count in study.counts.items() if not name.startswith("E")
    )
    assert study.all_samples.of == 2_000
    assert study.all_samples.count == study.forming.count == int(study.judged.fails.sum())
    assert study.forming.share > study.all_samples.share


def test_joints_that_dilate_bolts_and_directions_go_all_at_once() -> None:
    study = prob(load(DILATING), 5, fos=1.6)
    assert study.judged.evaluator == "closed form and PRE-IE of every sample, all at once"
    assert (study.both.agree, study.both.not_compared) == (0, 5)
    bolts = {"bolts": [{"force": 2e5, "toward": "000/10", "acts": "passive"}]}
    turning = {"force": 500, "toward": {"dist": "fisher", "mean": "180/10", "k": 200}}
    study = prob(load(default_wedge() | {"loads": {"forces": [turning]}, "support": bolts}), 20)
    assert study.judged.evaluator == "closed form and PRE-IE of every sample, all at once"
    assert (study.both.agree, study.both.not_compared) == (20, 0)


def test_both_methods_judge_every_sample_and_agree_where_no_moment_governs() -> None:
    study = prob(load(default_wedge(0.8)), 2_000, fos=1.5)
    alone = prob(load(default_wedge(0.8)), 2_000, fos=1.5, by="closed-form")
    assert study.judged.evaluator == "closed form and PRE-IE of every sample, all at once"
    assert (study.both.agree, study.both.governed, study.both.unsafe, study.both.safe) == (
        2_000,
        0,
        0,
        0,
    )
    assert study.both.largest < 1e-9
    assert study.all_samples == study.by_closed_form == alone.all_samples
    assert study.judged.factor == pytest.approx(alone.judged.factor, rel=1e-9)
    assert study.exit_code == 0
    assert (alone.both, alone.by_closed_form) == (None, None)


#: A wedge that turns (cases.json, 9_single-plane): its two joints are bonded, and the one that opens scatters.
TURNING = {
    "slopekit": 1,
    "kind": "wedge",
    "joints": {
        "J1": {"plane": "45/160", "strength": "a"},
        "J2": {"plane": "80/240", "strength": "b"},
    },
    "slope": {"face": "65/180", "upper": "0/180", "height": 10},
    "strength": {
        "a": {"c": 20, "phi": PHI | {"mean": 30, "sd": 0.6}},
        "b": {"c": {"dist": "normal", "mean": 20, "sd": 2}, "phi": 30},
    },
    "rock": {"unit_weight": 26},
}


def test_where_moments_govern_pre_ie_counts_and_the_closed_form_is_said_beside_it() -> None:
    """The closed form's probability is the one that it has alone; PRE-IE's is that of each sample by itself."""
    design = load(TURNING)
    means = sk.analyse(design)
    assert means.moments_govern
    target = 0.5 * (means.fos.limit + means.fos.closed_form)
    study = prob(design, 20, fos=target)
    alone = prob(design, 20, fos=target, by="closed-form")
    single = [point_of(design, study.samples.settings(row)).factors for row in range(0, 20, 4)]
    assert study.judged.factor[::4] == pytest.approx(
        [factors.limit for factors in single], rel=1e-6
    )
    assert study.outcomes.moments_govern[::4].tolist() == [
        factors.moments_govern for factors in single
    ]
    assert study.both.governed == 20
    assert study.by_closed_form == alone.all_samples
    assert study.all_samples.share > study.by_closed_form.share + 0.2
    assert study.both.unsafe == study.all_samples.count - study.by_closed_form.count > 3
    assert (study.both.safe, study.both.disagree) == (0, 0)
    (said,) = (notice.message for notice in study.warnings if notice.code == "W353")
    assert said.startswith(f"{study.both.unsafe} of 20 samples fail by PRE-IE alone")
    assert study.margin == 1.0 - study.all_samples.share
    text = " ".join(str(study).split())
    for share, among in (
        (study.all_samples, "of all samples"),
        (study.by_closed_form, "by the closed form, forces"),
    ):
        assert f"{share.share * 100:.4g} % {among}" in text
    assert f"closed form {study.by_closed_form.share * 100:.4g} %" in study.line
    assert f"{study.both.unsafe} fail by PRE-IE only, 0 by the closed form only" in text
    found = study.to_dict()
    assert found["probability_of_failure"]["closed_form"]["count"] == study.by_closed_form.count
    assert found["methods"]["fails_by_pre_ie_only"] == study.both.unsafe
    assert "METHODS   the closed form alone" in str(alone)


@pytest.mark.slow
@pytest.mark.parametrize("values", [WILD, FOOTING], ids=["all at once", "one by one"])
def test_the_same_numbers_whoever_works(values, monkeypatch) -> None:
    monkeypatch.setattr("slopekit.studies.evaluation.rows.PIECE", 3)  # several tasks
    design = load(values)
    alone = prob(design, 8, seed=7, by="pre-ie")
    pool = prob(design, 8, seed=7, by="pre-ie", jobs=2)
    assert alone.judged.factor.tobytes() == pool.judged.factor.tobytes()
    assert alone.counts == pool.counts
    other = prob(design, 3, seed=8, by="pre-ie")
    assert not set(other.judged.factor.tolist()) & set(alone.judged.factor.tolist())


@pytest.mark.parametrize("values", [default_wedge(), FOOTING], ids=["all at once", "one by one"])
@pytest.mark.parametrize("by", ["pre-ie", "closed-form"])
def test_an_interrupted_study_goes_on(values, by, tmp_path, monkeypatch) -> None:
    """What was done is read back as it was, also where its columns stand on disk."""
    monkeypatch.setattr("slopekit.studies.evaluation.rows.PIECE", 1)
    monkeypatch.setattr("slopekit.studies.evaluation.rows.PIECE_OF_CLOSED_FORMS", 1)
    design, calls = load(values), []

    def counted(work, *tasks, **options):
        def one(task):
            if len(calls) == 12:
                calls.append(0)
                raise KeyboardInterrupt
            calls.append(1)
            return work(task)

        return running.run_all(one, *tasks, **options)

    whole = prob(design, 30, by=by)
    monkeypatch.setattr("slopekit.studies.points.run_all", counted)
    monkeypatch.setattr(running, "_MOST_ROWS_IN_MEMORY", 29)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(Interrupted) as caught:
        prob(design, 30, by=by)
    assert "12 of 30" in str(caught.value)
    assert len(list(tmp_path.glob("prob-*.journal"))) == 1
    again = prob(design, 30, by=by)
    assert len(calls) == 31
    assert again.judged.factor.tobytes() == whole.judged.factor.tobytes()
    assert again.to_dict() | {"timing_s": None} == whole.to_dict() | {"timing_s": None}
    assert isinstance(again.judged.factor, np.memmap)
    assert not list(tmp_path.iterdir())


def test_samples_that_cannot_be_are_counted_apart() -> None:
    design = load(
        default_wedge()
        | {
            "strength": {"s": {"c": {"dist": "normal", "mean": 50, "sd": 20}, "phi": 20}},
            "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
        }
    )
    study = prob(design, 20_000, by="closed-form")
    assert 50 < study.counts["impossible"] < 200  # 0.62 % of them
    assert study.all_samples.of == 20_000 - study.counts["impossible"]
    assert "W350" in {notice.code for notice in study.warnings}


def test_what_is_drawn_has_its_unit() -> None:
    """An orientation, an angle, a pressure, a share."""
    made = default_wedge() | {"water": {"fill": {"dist": "uniform", "min": 0, "max": 0.5}}}
    made["joints"]["J1"]["plane"] = {"dist": "fisher", "mean": "45/115", "k": 400}
    made["strength"]["b"] = {"c": {"dist": "uniform", "min": 40, "max": 60}, "phi": 20}
    rows = (
        str(prob(load(made), n=100, by="closed-form"))
        .split("RANDOM")[1]
        .split("SAMPLES")[0]
        .splitlines()[1:]
    )
    units = {row.split()[0]: row.split()[3:] for row in rows if row.strip()}
    angles = ("joints.J1.plane.dip", "joints.J1.plane.dip_direction", "strength.a.phi")
    assert units == {key: ["°"] for key in angles} | {"strength.b.c": ["kPa"], "water.fill": []}


def test_too_many_of_them_are_refused_and_small_friction_is_no_radian() -> None:
    joints = {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}
    wide = {"c": {"dist": "normal", "mean": 5, "sd": 5}, "phi": 20}
    with pytest.raises(DesignError) as caught:
        prob(load(default_wedge() | {"joints": joints, "strength": {"s": wide}}), 10)
    assert caught.value.codes == ("E281",)
    smooth = {"c": 20, "phi": {"dist": "uniform", "min": 0.5, "max": 1.5}}
    design = load(default_wedge() | {"joints": joints, "strength": {"s": smooth}})
    by_pre_ie = prob(design, 5, by="pre-ie")
    assert by_pre_ie.counts == {"slides_on_both": 5}
    assert prob(design, 5, by="closed-form").judged.factor == pytest.approx(
        by_pre_ie.judged.factor, rel=1e-9
    )


def test_nothing_that_speaks_against_it_is_accepted(monkeypatch) -> None:
    monkeypatch.setattr(SampleRows, "point", lambda *_: Point(None, "E212", "bolt 1 is too short"))
    by_pre_ie = prob(load(FOOTING), 6, fos=1.7, accept=0.99)
    assert by_pre_ie.counts == {"E212": 6}
    assert (
        by_pre_ie.judged.unjudged.sum(),
        by_pre_ie.all_samples.count,
        by_pre_ie.all_samples.of,
    ) == (6, 0, 0)
    assert by_pre_ie.accepted is False
    assert by_pre_ie.by_closed_form.share is None
    said = " ".join(str(by_pre_ie).split())
    assert "not compared" in by_pre_ie.line
    assert "agree on 0, disagree on 0, 6 not compared" in said
    assert "<= 99 %: NOT MET, 6 samples not judged" in said
    assert "W350" in {notice.code for notice in by_pre_ie.warnings}
    monkeypatch.undo()
    away = default_wedge() | {
        "joints": {
            "J1": {"plane": "45/020", "strength": "a"},
            "J2": {"plane": "45/340", "strength": "b"},
        }
    }
    assert prob(load(away), 50).exit_code == 3


def test_the_line_on_acceptance_says_what_the_exit_code_says() -> None:
    """No limit is met where the methods disagree (exit code 4), nor where no sample forms a block (3)."""
    study = prob(load(default_wedge()), 300, fos=1.0, accept=0.99)
    assert (study.accepted, study.exit_code) == (True, 0)
    apart = replace(study, both=replace(study.both, agree=299, disagree=1))
    assert (apart.accepted, apart.exit_code) == (False, 4)
    assert "99 %: NOT MET, the methods disagree" in " ".join(str(apart).split())
    assert "not met" in apart.line
    away = default_wedge() | {
        "joints": {
            "J1": {"plane": "45/020", "strength": "a"},
            "J2": {"plane": "45/340", "strength": "b"},
        }
    }
    none = prob(load(away), 50, accept=0.99)
    assert (none.accepted, none.exit_code) == (False, 3)
    assert "NOT MET, no sample forms a block" in " ".join(str(none).split())


def test_an_upper_limit_shows_on_which_side_of_the_accepted_one_it_lies() -> None:
    """Three digits, as all probabilities for people; six where three would hide why it is met or not."""
    study = prob(load(default_wedge()), 300, fos=1.0, accept=0.1)
    share = replace(study.all_samples, share=0.0812345, low=0.0512345, high=0.100049)
    assert "upper limit 10.0049 % <= 10 %: NOT MET" in str(replace(study, all_samples=share))
    further = str(replace(study, all_samples=replace(share, high=0.123456)))
    assert "upper limit 12.3 % <= 10 %: NOT MET" in further
    assert "8.12 %  of all samples" in further


def test_both_estimates_have_the_same_denominator() -> None:
    joints = {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}
    strength = {
        "s": {
            "c": {"dist": "normal", "mean": 50, "sd": 20.5},
            "phi": {"dist": "normal", "mean": 12, "sd": 2},
        }
    }
    study = prob(load(default_wedge() | {"joints": joints, "strength": strength}), 4_000)
    assert study.counts["impossible"] > 5
    assert study.both.agree == study.all_samples.of == 4_000 - study.counts["impossible"]
    assert study.by_closed_form == study.all_samples


def test_what_scatters_without_changing_the_factor(capsys) -> None:
    stiff = {
        "c": 50,
        "phi": 20,
        "stiffness": {"normal": {"dist": "uniform", "min": 1e6, "max": 1e7}},
    }
    joints = {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}
    study = prob(load(default_wedge() | {"joints": joints, "strength": {"s": stiff}}), 30)
    assert study.judged.factor == pytest.approx(1.5574, abs=1e-4)
    assert len(study.judged.factor) == 30


def test_samples_without_an_answer_and_too_few_failures_are_said(monkeypatch) -> None:
    broken = Point(None, "E599", "LinAlgError: singular")
    wild = Point(Factors("not_converged", None, "slides_on_both", 0.9, None, False, False))
    stands = Point(Factors("slides_on_both", 1.2, "slides_on_both", 1.2, 0.0, True, False))
    points = [broken, wild, *[stands] * 18]
    monkeypatch.setattr(SampleRows, "point", lambda _, row, pre_ie: points[row])
    study = prob(load(FOOTING), 20)
    assert study.counts == {"slides_on_both": 18, "E599": 1, "not_converged": 1}
    assert (study.all_samples.count, study.all_samples.of) == (
        2,
        20,
    )  # without an answer: counted as failures
    assert {"W350"} <= {notice.code for notice in study.warnings}


@pytest.mark.parametrize(
    ("options", "code"),
    [
        ({"n": 0}, "E307"),
        ({"seed": -1}, "E307"),
        ({"fos": 0.0}, "E307"),
        ({"confidence": 1.0}, "E307"),
        ({"accept": 1.5}, "E307"),
        ({"method": "monte carlo"}, "E126"),
        ({"by": "bishop"}, "E126"),
    ],
)
def test_what_is_refused(options, code) -> None:
    with pytest.raises(DesignError) as caught:
        prob(load(default_wedge()), **({"n": 10} | options))
    assert caught.value.codes == (code,)


def test_a_design_in_which_nothing_scatters_is_refused() -> None:
    with pytest.raises(DesignError) as caught:
        prob(load("templates/wedge.yaml"), 10)
    assert caught.value.codes == ("E302",)


def test_limits_of_shares() -> None:
    """Clopper and Pearson's definition: at the limits, a result as extreme has a probability of 2.5 %."""
    low, high = clopper_pearson(7, 50)
    assert binom.sf(6, 50, low) == pytest.approx(0.025)
    assert binom.cdf(7, 50, high) == pytest.approx(0.025)
    assert clopper_pearson(50, 50)[1] == 1.0
    rng = np.random.default_rng(5)
    hits = 0
    for _ in range(300):
        shares = rng.uniform(size=1600) < 0.3
        found = share_of(shares, np.ones(1600, dtype=bool), np.repeat(np.arange(16), 100))
        hits += found.low <= 0.3 <= found.high
    assert 270 <= hits <= 298
    assert share_of(np.zeros(9, bool), np.zeros(9, bool), np.zeros(9, int)).share is None
    assert summary_of([np.nan]) is None
    even = summary_of([1.5] * 10)
    assert (even.mean, even.sd, sum(even.counts)) == (1.5, 0.0, 10)


@pytest.mark.slow
def test_the_command(tmp_path) -> None:
    file = tmp_path / "wedge.json.yaml"
    file.write_text(json.dumps(default_wedge(0.8)))
    run = slopekit(
        "prob",
        str(file),
        "-n",
        "500",
        "--fos",
        "1.5",
        "--accept-pf",
        "10%",
        "--json",
        "-o",
        str(tmp_path / "out"),
    )
    assert run.returncode == 1, run.stderr
    found = json.loads(run.stdout)
    assert found["accepted"] is False
    assert found["probability_of_failure"]["all_samples"]["of"] == found["n"] == 500
    assert found == json.loads((tmp_path / "out" / "prob.json").read_text())
    rows = list(csv.DictReader((tmp_path / "out" / "samples.csv").read_text().splitlines()))
    fails = sum(int(row["fails"]) for row in rows)
    assert fails == found["probability_of_failure"]["all_samples"]["count"]
    by_closed_form = found["probability_of_failure"]["closed_form"]["count"]
    assert sum(float(row["fos_limit"]) < 1.5 for row in rows) == fails
    assert sum(float(row["fos_closed_form"]) < 1.5 for row in rows) == by_closed_form
    assert sum(int(row["moments_govern"]) for row in rows) == found["methods"]["moments_govern"]
    assert found["methods"]["agree"] == 500
    sheet = (tmp_path / "out" / "prob.txt").read_text()
    assert all(len(line) <= 100 for line in sheet.splitlines())
    assert "P(FoS < 1.5)" in sheet
    assert "of 500" in sheet
    wrong = slopekit("prob", str(file), "-n", "many")
    assert wrong.returncode == 2
    assert wrong.stderr.startswith("E106")


def test_what_is_accepted_is_a_probability_and_the_old_word_is_understood(tmp_path) -> None:
    """`--accept` of `wedge` is a factor of safety, that of `prob` was not: each has a word of its own."""
    file = tmp_path / "wedge.json.yaml"
    file.write_text(json.dumps(default_wedge()))
    few = ("prob", str(file), "-n", "50", "--quiet")
    said = [
        slopekit(*few, word, level)
        for word in ("--accept-pf", "--accept")
        for level in ("50%", "0.1%")
    ]
    assert [run.returncode for run in said] == [0, 1, 0, 1]
    assert said[0].stdout == said[2].stdout
    assert "  met" in said[0].stdout
    factor = slopekit(*few, "--accept", "1.3")
    assert factor.returncode == 2
    assert "E307 accept is 1.3" in factor.stderr
    assert "probability of failure" in factor.stderr
    assert slopekit(*few, "--accept", "5%", "--accept-pf", "50%").stderr.startswith("E100")


@pytest.mark.slow
def test_samples_csv_has_every_digit_of_every_sample(tmp_path, monkeypatch) -> None:
    """The table of the sheet, its file and its records are the same; the journal goes when all is written."""
    file = tmp_path / "wedge.json.yaml"
    file.write_text(json.dumps(WILD))
    run = slopekit("prob", str(file), "-n", "40", "-o", str(tmp_path / "out"))
    assert run.returncode == 0, run.stderr
    assert {path.name for path in (tmp_path / "out").iterdir()} - {"histogram.png"} == {
        "prob.json",
        "prob.txt",
        "samples.csv",
    }
    study = prob(load(WILD), 40)
    table = study.sheet.tables["samples.csv"]
    assert (tmp_path / "out/samples.csv").read_text(encoding="utf-8") == table.csv()
    rows = list(csv.DictReader(table.csv().splitlines()))
    for k, (row, record) in enumerate(zip(rows, table.records(), strict=True)):
        drawn = [float(row[name]) for name in study.samples.names]
        assert (
            drawn
            == study.samples.values[k].tolist()
            == [record[name] for name in study.samples.names]
        )
        assert row["outcome"] == study.judged.names[study.judged.outcome[k]]
        for key, factor in (
            ("fos_limit", study.judged.factor),
            ("fos_closed_form", study.outcomes.closed_form.factor),
        ):
            assert (float(row[key]) if row[key] else None) == record[key]
            assert float(row[key] or "nan") == pytest.approx(factor[k], rel=0, abs=0, nan_ok=True)
        assert row["moments_govern"] == str(int(study.outcomes.moments_govern[k]))
    monkeypatch.setattr("slopekit.core.sheet._AT_ONCE", 7)
    assert study.sheet.tables["samples.csv"].csv() == table.csv()
    assert str(list(table.rows)[17]) == str(table.rows[17])  # nan is not nan


def test_a_journal_is_kept_until_all_is_written(tmp_path) -> None:
    """With a folder the study leaves it to whoever writes its results."""
    desk = Workplace(tmp_path)
    prob(load(default_wedge()), 6, by="pre-ie", desk=desk)
    assert [path.suffix for path in tmp_path.iterdir()] == [".journal"]
    (written,) = desk.when_written
    written()
    assert not list(tmp_path.iterdir())


def test_dips_beyond_the_vertical_are_planes_that_dip_the_other_way_and_that_is_said() -> None:
    """92/115 is 88/295: what is drawn beyond 90° is judged so; the tornado ends at the vertical."""
    joints = {
        "J1": {"plane": {"dip": {"dist": "normal", "mean": 86, "sd": 5}, "dip_direction": 115}},
        "J2": {"plane": "50/245"},
    }
    design = load(
        {
            "slopekit": 1,
            "kind": "wedge",
            "slope": {"face": "88/185", "upper": "12/195"},
            "joints": joints,
        }
    )
    study = prob(design, 400, by="closed-form")
    names = study.samples.names
    dips, directions = (
        study.samples.values[:, names.index(f"joints.J1.plane.{name}")]
        for name in ("dip", "dip_direction")
    )
    over = directions == 295.0
    assert 0.1 < over.mean() < 0.35
    beyond = norm.sf(90.0, 86.0, 5.0)
    assert (
        f"{beyond * 100:.3g} % of the dips of joints.J1.plane lie beyond 0 to 90°: those dip"
        in str(study)
    )
    assert dips.max() <= 90.0
    assert set(directions.tolist()) == {115.0, 295.0}
    one = int(np.flatnonzero(over & np.isfinite(study.judged.factor))[0])
    there = point_of(design, {"joints.J1.plane": f"{float(dips[one])!r}/295"}, pre_ie=False)
    assert study.judged.factor[one] == pytest.approx(there.factors.closed_form, rel=1e-9)
    bar = next(
        bar
        for bar in sk.tornado(design, closed_form=True).bars
        if bar.key.path == "joints.J1.plane.dip"
    )
    assert (bar.high, bar.at_high.code) == (90.0, "")
