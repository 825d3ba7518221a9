"""What acceptance of a run is held against besides its own factor, studies and files of its blocks judge too.

The whole wedge that a basal joint cuts the toe off is another file without that joint: the closed form of two joints.
"""

import numpy as np
import pytest

import slopekit as sk
from benchmarks import populations

WHOLE = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "65/180", "upper": "5/180", "height": 20},
    "joints": {
        "J1": {"plane": "60/130", "strength": "joint"},
        "J2": {"plane": "60/230", "strength": "joint"},
    },
    "strength": {"joint": {"c": 0, "phi": 30}},
    "rock": {"unit_weight": 26},
    "acceptance": {"rules": ["fos >= 1.3"]},
}
CUT = WHOLE | {
    "basal": {"plane": "20/180", "height": 6, "strength": "bedding"},
    "strength": {"joint": {"c": 0, "phi": 30}, "bedding": {"c": 15, "phi": 40}},
}
GENTLE = {
    "joints.J1.plane": "45/115",
    "joints.J2.plane": "45/245",
    "basal.plane": "5/180",
    "strength.joint.phi": 33,
    "strength.joint.c": 20,
}


def notices(outcome, code: str) -> list[str]:
    return [notice.message for notice in outcome.warnings if notice.code == code]


def closed_form(design: dict, values: dict) -> float:
    return (
        sk.sweep(sk.load(design, set=values), {"slope.height": [20.0]}, closed_form=True)
        .points[0]
        .factors
    )


@pytest.mark.parametrize(
    "more",
    [
        {"crack": {"plane": "85/180", "distance": 6}, "water": "full"},
        {
            "support": {
                "bolts": [{"force": 900, "toward": "000/05", "head": [0, 5, 12], "length": 30}]
            }
        },
    ],
)
def test_of_each_sample_the_lower_of_block_and_whole_wedge_counts(more) -> None:
    """Each sample is read as a design of its own, with and without the basal joint."""
    joint = {"c": 0, "phi": {"dist": "uniform", "min": 25, "max": 60}}
    strengths = {
        "joint": joint,
        "bedding": {"c": 15, "phi": {"dist": "uniform", "min": 15, "max": 60}},
    }
    design = CUT | more | {"strength": strengths}
    found = sk.prob(sk.load(design), 12, fos=1.2, by="closed-form", seed=3)
    lowest, only = [], 0
    for row in range(12):
        values = found.samples.settings(row)
        block = closed_form(design, values)
        of_joint = {path: value for path, value in values.items() if "bedding" not in path}
        whole = closed_form(WHOLE | more | {"strength": {"joint": joint}}, of_joint)
        assert block.also.closed_form == pytest.approx(whole.closed_form, rel=1e-12)
        lowest.append(min(block.closed_form, whole.closed_form))
        only += whole.closed_form < 1.2 <= block.closed_form
    assert found.judged.factor == pytest.approx(np.array(lowest), rel=1e-12)
    assert found.all_samples.count == sum(factor < 1.2 for factor in lowest)
    assert only > 0
    (said,) = notices(found, "W507")
    assert said.startswith(
        f"in {only} of 12 samples the whole wedge without the basal joint falls short of 1.2"
    )
    assert any(name.startswith("whole_wedge_slides") for name in found.counts)


def test_samples_taken_one_by_one_are_judged_alike() -> None:
    strength = {
        "joint": {"c": 0, "phi": {"dist": "uniform", "min": 25, "max": 60}},
        "bedding": {"c": 15, "phi": 40},
    }
    passive = {"bolts": [{"force": 1e-6, "toward": "000/05", "acts": "passive"}]}
    at_once = sk.prob(sk.load(CUT | {"strength": strength}), 8, by="closed-form")
    apart = sk.prob(sk.load(CUT | {"strength": strength, "support": passive}), 8, by="closed-form")
    by_pre_ie = sk.prob(sk.load(CUT | {"strength": strength}), 2, by="pre-ie")
    assert apart.judged.factor == pytest.approx(at_once.judged.factor, rel=1e-6)
    assert apart.all_samples.count == at_once.all_samples.count > 0
    assert (by_pre_ie.judged.factor <= at_once.judged.factor[:2] * (1.0 + 1e-9)).all()
    assert (by_pre_ie.judged.fails == at_once.judged.fails[:2]).all()


def test_bolts_of_samples_hold_the_whole_wedge_where_they_pass_it() -> None:
    """All samples at once, as each by itself: the first bolt ends in the toe of some whole wedges."""
    bolt = {"force": 1500, "toward": "000/60", "head": [0, 3.3, 7], "length": 2.4}
    others = [{"force": 500, "toward": "000/10", "head": [0, 5, 11], "length": 14}]
    dips = {
        "joints": {
            name: {
                "plane": {"dip": {"dist": "uniform", "min": 50, "max": 66}, "dip_direction": way},
                "strength": "joint",
            }
            for name, way in (("J1", 130), ("J2", 230))
        }
    }
    design = sk.load(CUT | dips | {"support": {"bolts": [bolt, *others]}})
    found = sk.prob(design, 12, by="closed-form")
    for row in range(12):
        point = found.rows.point(row, False)
        both = point.factors.closed_form, point.factors.also.closed_form
        assert found.judged.factor[row] == pytest.approx(min(both), rel=1e-12)
    bare = sk.prob(sk.load(CUT | dips | {"support": {"bolts": others}}), 12, by="closed-form")
    held = found.judged.factor > bare.judged.factor * (1.0 + 1e-9)
    assert 0 < held.sum() < 12


@pytest.mark.parametrize(
    "more", [{}, {"bolts": [{"force": 1e-9, "toward": "000/05", "acts": "passive"}]}]
)
def test_where_the_basal_joint_closes_no_block_the_whole_wedge_is_there_all_the_same(more) -> None:
    """All samples have the same wedge on J1 and J2, F 0.693, whatever the joint below does."""
    high = {
        "basal": {
            "plane": "20/180",
            "height": {"dist": "uniform", "min": 12, "max": 30},
            "strength": "bedding",
        }
    }
    design = sk.load(CUT | high | {"support": more})
    found = sk.prob(design, 12)
    assert found.all_samples.share == 1.0
    assert (
        sum(
            n
            for name, n in sk.prob(design, 12, fos=0.5, by="closed-form").counts.items()
            if name[0] == "E"
        )
        > 0
    )
    assert (found.both.disagree, found.both.without_answer) == (0, 0)
    assert found.judged.factor == pytest.approx(closed_form(WHOLE, {}).closed_form, rel=1e-9)


def test_an_accepted_probability_is_not_met_by_the_block_alone() -> None:
    """As `run`: with 30° on the joints the block stands and the whole wedge does not."""
    scatters = {"strength.bedding.phi": {"dist": "normal", "mean": 40, "sd": 0.1}}
    found = sk.prob(sk.load(CUT, set=scatters), 50, accept=0.2)
    assert found.accepted is False
    assert found.exit_code == 1
    assert found.all_samples.share == 1.0
    assert (found.both.unsafe, found.both.safe) == (0, 0)
    assert "the whole wedge without the basal joint: slides on both" in str(found.sheet)


def test_a_sweep_says_where_the_whole_wedge_falls_short() -> None:
    found = sk.sweep(sk.load(CUT), {"strength.joint.phi": [30, 44, 60]}, fos=1.1)
    factors = [point.factors for point in found.points]
    alone = [closed_form(WHOLE, {"strength.joint.phi": phi}).closed_form for phi in (30, 44, 60)]
    assert [one.also.closed_form for one in factors] == pytest.approx(alone, rel=1e-12)
    assert min(one.limit for one in factors) > 1.3 > alone[1] > 1.1 > 1.0 > alone[0]
    said = notices(found, "W507")
    assert [text.split(":")[0] for text in said] == [
        "1 of 3 points, at strength.joint.phi = 30°",
        "2 of 3 points, at strength.joint.phi = 30°",
        "1 of 3 points, at strength.joint.phi = 30°",
    ]
    assert found.margin == pytest.approx(alone[0])
    assert [
        row["whole_wedge"]["closed_form"] for row in found.to_dict()["points"]
    ] == pytest.approx(alone)
    curve = next(section for section in str(found.sheet).split("\n") if section.startswith("CURVE"))
    assert "whole wedge" in curve
    assert max(map(len, str(found.sheet).split("\n"))) <= 100


def test_a_tornado_says_it_too() -> None:
    found = sk.tornado(sk.load(CUT), closed_form=True)
    assert any(
        "the whole wedge without the basal joint falls short of 1.3" in text
        for text in notices(found, "W507")
    )


def test_a_rule_on_what_is_too_much_asks_for_no_level_of_a_tornado() -> None:
    found = sk.tornado(
        sk.load(CUT, set={"acceptance.rules": ["fos >= 0.3", "fos <= 2"]}), closed_form=True
    )
    assert all("falls short of 0.3" in text for text in notices(found, "W507"))


@pytest.mark.slow
def test_an_earthquake_that_moves_the_whole_wedge_before_is_not_passed() -> None:
    found = sk.quake(sk.load(CUT, set=GENTLE), "sine:0.5g,1Hz")
    (said,) = notices(found, "W507")
    assert "the whole wedge without the basal joint falls short of 1:" in said
    assert found.exit_code == 1
    run = sk.run(
        CUT, set=GENTLE | {"loads.seismic.k": found.coefficient, "acceptance.rules": "fos >= 0.99"}
    )
    assert run.exit_code == 1


def test_a_slope_whose_whole_wedge_does_not_stand_is_shaken_by_nothing() -> None:
    with pytest.raises(
        sk.DesignError, match=r"E520 the slope does not stand.*the whole wedge.*FoS 0\.693"
    ):
        sk.quake(sk.load(CUT), "sine:0.5g,1Hz")


# -- blocks that turn -------------------------------------------------------------------------------------------------


def test_studies_of_a_block_that_turns_have_its_factor_without() -> None:
    """Bench 130: B8 turns; see `tests/properties/test_not_unique.py`, where a wedge of its own has the lower number."""
    design, target = (
        sk.load(populations.bench(130)),
        5.9,
    )  # between the 5.53 of the wedge and its limit
    swept = sk.sweep(
        design, {"strength.joint.phi": [design.strengths[0][1].friction_angle_deg]}, fos=target
    )
    (factors,) = (point.factors for point in swept.points)
    assert factors.limit == pytest.approx(5.5309, rel=1e-4)
    assert swept.margin == factors.limit < target


def test_ends_that_only_the_tornado_makes_dilate_say_nothing() -> None:
    found = sk.tornado(sk.load(WHOLE), {"strength.joint.dilation": [0, 4]})
    assert not notices(found, "W310")
    dilates = sk.tornado(
        sk.load(WHOLE, set={"strength.joint.dilation": 2}), {"strength.joint.dilation": [0, 4]}
    )
    assert notices(dilates, "W310")


# -- pictures -------------------------------------------------------------------------------------------------------


def test_charts_of_a_sweep_show_what_acceptance_asks_besides() -> None:
    """A curve of its own; in contours the lower of the two. Drawn of the JSON alone."""
    from slopekit.views.charts import sweep_charts
    from slopekit.views.charts.drawing import new_figure

    design = sk.load(CUT)
    one = sk.sweep(design, {"strength.joint.phi": [30, 44]}, closed_form=True)
    with new_figure("a.png") as figure:
        sweep_charts.draw_curve(figure, one.to_dict())
    (axes,) = figure.axes
    (drawn,) = (
        line
        for line in axes.lines
        if line.get_linestyle() == "--" and len(line.get_xdata()) == 2 and line.get_marker() == "s"
    )
    assert list(drawn.get_ydata()) == pytest.approx(
        [point.factors.also.closed_form for point in one.points]
    )
    keys = {"strength.joint.phi": [30, 40, 50], "strength.bedding.phi": [30, 35, 40]}
    two = sk.sweep(design, keys, closed_form=True)
    assert "not of the whole wedge without the basal joint: W507" in str(two.sheet)
    with new_figure("a.png") as figure:
        sweep_charts.draw_contour(figure, two.to_dict())
    assert (
        figure.axes[1].get_ylabel() == "factor of safety (closed form, or whole wedge where lower)"
    )
    assert (
        figure.axes[1].get_ylim()[0]
        < min(point.factors.also.closed_form for point in two.points) * 1.05
    )
