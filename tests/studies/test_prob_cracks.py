"""The worst crack of all samples at once: against the search of each design by itself, and Hoek & Bray's formula."""

import math

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.errors import GeometryError
from slopekit.design.common import Design
from slopekit.design.reading.files import with_values
from slopekit.kinds import factors_of, kind_of
from slopekit.studies.points import point_of, status_of
from slopekit.studies.prob.rows import SampleRows
from slopekit.studies.prob.run import _checked_options
from slopekit.studies.prob.sampling import Samples, samples
from tests.bolted import as_laid_out, standing

SCATTER = {
    "c": {"dist": "uniform", "min": 20, "max": 60},
    "phi": {"dist": "normal", "mean": 25, "sd": 3},
}
WEDGE = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "60/180", "upper": "10/180", "height": 30},
    "joints": {
        "J1": {"plane": {"dip": {"dist": "normal", "mean": 45, "sd": 6}, "dip_direction": 115}},
        "J2": {"plane": "45/245"},
    },
    "strength": {"s": SCATTER},
    "rock": {"density": 2600},
    "crack": {"plane": "80/180", "distance": "worst"},
}
PLANE = {
    "slopekit": 1,
    "kind": "plane",
    "slope": {"face": "60/180", "height": 12, "upper": "5/180"},
    "joints": {
        "J1": {"plane": {"dip": {"dist": "uniform", "min": 30, "max": 62}, "dip_direction": 180}}
    },
    "strength": {"s": SCATTER},
    "rock": {"density": 2600},
    "crack": {"distance": "worst", "water": "30 %"},
}
BOLT = {"force": 200, "head": [0, -3, 8], "toward": "000/-05", "length": 9, "acts": "active"}
CASES = {
    "wedge": WEDGE,
    "plane": PLANE,
    "wet wedge": {**WEDGE, "water": "full"},
    "bolted wedge": {**WEDGE, "support": {"bolts": [BOLT]}},
    "above a basal joint": {
        **WEDGE,
        "basal": {"plane": "15/180", "height": 3},
        "water": {"fill": 0.3},
    },
    "no block": {**WEDGE, "slope": {"face": "30/180", "upper": "10/180", "height": 30}},
    "basal joint": {
        **WEDGE,
        "slope": {"face": "70/180", "upper": "5/180", "height": 20},
        "basal": {
            "plane": {"dip": {"dist": "uniform", "min": 20, "max": 40}, "dip_direction": 180},
            "height": 3,
            "strength": "s",
        },
        "joints": {"J1": {"plane": "80/100"}, "J2": {"plane": "75/262"}},
    },
    "table above the ground behind": {
        **PLANE,
        "crack": {"distance": "worst"},
        "joints": {"J1": {"plane": "35/180"}},
        "water": {"mode": "table", "points": [[0, 0], [6, 6], [9, 8], [14, 14], [40, 30]]},
    },
    "dry plane": {**PLANE, "crack": {"distance": "worst"}, "loads": {"seismic": {"k": 0.1}}},
}


def places_of(design: Design, count: int, seed: int) -> tuple[Samples, np.ndarray]:
    """Samples of a design, and the places of their cracks."""
    drawn = samples(design.variables, (), count, seed)
    return drawn, SampleRows(design, drawn).columns.rows(drawn.values).values[:, -1]


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_as_each_sample_read_by_itself(name) -> None:
    """The single search is `crack: {distance: worst}` of a design with the sample's values, another way through.

    Factors agree to 1e-9: at a minimum they are flat, and its place is known to the root of that (1e-4 of the place).
    """
    design = sk.load(CASES[name])
    found = sk.prob(design, n=12, by="closed-form", seed=4)
    assert found.judged.evaluator == "closed form of every sample, all at once"
    drawn, places = places_of(design, 12, 4)
    own = kind_of(design).on_arrays
    for row in range(12):
        sample = standing(with_values(design, drawn.settings(row)), as_laid_out(design))
        outcome = found.judged.names[found.judged.outcome[row]]
        if outcome.startswith("E"):
            with pytest.raises(GeometryError, match=outcome):
                own.closed_form(sample)
            continue
        single = own.closed_form(sample)
        assert outcome == single.status
        if single.factor is None:
            assert math.isnan(found.judged.factor[row])
            continue
        assert found.judged.factor[row] == pytest.approx(single.factor, rel=1e-9)
        if sample.crack_searched == "inside":
            assert places[row] == pytest.approx(sample.crack.distance_m, rel=1e-4)
        else:
            assert places[row] == pytest.approx(sample.crack.distance_m, rel=1e-9)


def test_dry_planes_have_hoek_and_brays_crack() -> None:
    """b_c / H = sqrt(cot ψ_f cot ψ_p) - cot ψ_f below level ground (Hoek & Bray 1981, ch. 7), at every dip drawn."""
    design = sk.load(
        {
            **PLANE,
            "slope": {"face": "60/180", "height": 12, "upper": "0/180"},
            "crack": {"distance": "worst"},
        }
    )
    drawn, places = places_of(design, 50, 2)
    dips = np.radians(drawn.values[:, drawn.names.index("joints.J1.plane.dip")])
    slides = dips < math.radians(60.0)
    cot_f, cot_p = 1.0 / math.tan(math.radians(60.0)), 1.0 / np.tan(dips[slides])
    np.testing.assert_allclose(places[slides], 12.0 * (np.sqrt(cot_f * cot_p) - cot_f), rtol=1e-5)
    assert 20 < slides.sum() < 50


def test_pre_ie_is_asked_with_the_crack_at_the_place_found() -> None:
    """Both methods are those of a crack that is written there: it is looked for in none, and both agree."""
    design = sk.load(WEDGE)
    drawn, places = places_of(design, 6, 1)
    found = sk.prob(design, n=6, seed=1)
    for row, place in enumerate(places.tolist()):
        sample = with_values(design, drawn.settings(row) | {"crack.distance": place})
        assert sample.crack_searched == ""
        assert found.judged.factor[row] == pytest.approx(factors_of(sample).limit, rel=1e-8)
    assert (found.both.agree, found.both.disagree, found.both.not_compared) == (6, 0, 0)


def test_a_plane_flatter_than_the_ground_forms_no_block_whatever_the_crack() -> None:
    """Without its crack such a block ends nowhere (E205), as a run of it says: no place of the means stands for it."""
    dips = {"dip": {"dist": "uniform", "min": 3.0, "max": 35.0}, "dip_direction": 180}
    design = sk.load(PLANE | {"joints": {"J1": {"plane": dips}}})
    found = sk.prob(design, n=40, seed=2)
    words, drawn = found.judged.words, found.samples
    assert 1 <= words.count("E205") < 40
    assert words == [
        status_of(point_of(design, drawn.settings(row)), "pre_ie") for row in range(40)
    ]


def test_a_crack_with_a_place_is_not_looked_for() -> None:
    fixed = sk.load({**WEDGE, "crack": {"plane": "80/180", "distance": 3}})
    assert not SampleRows(fixed, samples(fixed.variables, (), 3, 1)).columns.searches_crack


@pytest.mark.slow
def test_with_passive_bolts_it_is_looked_for_in_all_at_once() -> None:
    """A place takes as long as 100 without them: one sample."""
    bolt = {"force": 150, "toward": "000/5", "acts": "passive"}
    design = sk.load({**PLANE, "support": {"bolts": [bolt]}})
    found = sk.prob(design, n=1)
    assert "all at once" in found.judged.evaluator
    alone = point_of(design, found.samples.settings(0)).factors
    assert found.judged.factor[0] == pytest.approx(alone.limit, rel=1e-8)
    assert found.outcomes.closed_form.factor[0] == pytest.approx(alone.closed_form, rel=1e-9)


IN_METRES = {"plane": "80/180", "distance": "worst", "water": "1 m"}
CUT = {
    "crack water in metres": {"crack": IN_METRES},
    "surcharge": {"loads": {"surcharge": "20 kPa"}},
}
CURVED = {"law": "barton-bandis", "jrc": 8, "jcs": "50 MPa", "phi_r": SCATTER["phi"]}
ALONE = CUT | {"curved strength": {"strength": {"s": CURVED}}}


@pytest.mark.slow
@pytest.mark.parametrize("why", ALONE)
def test_few_samples_are_drawn_where_the_crack_is_looked_for_in_each(why) -> None:
    """None are refused; where no number is given as many are drawn as a minute or two takes."""
    design = sk.load(WEDGE | ALONE[why])
    assert _checked_options(design, None, 1, "monte-carlo", "pre-ie", 1.0, 0.95, None, str).n == 200
    found = sk.prob(design, n=2, by="closed-form")
    assert found.judged.evaluator == "closed form of every sample, all at once"
    for row, factor in enumerate(found.judged.factor):
        alone = point_of(design, found.samples.settings(row), pre_ie=False)
        assert factor == pytest.approx(alone.factors.closed_form, rel=1e-9)
