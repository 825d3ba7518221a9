"""What a run says of a factor its studies say too, of every design that they analyse."""

from functools import cache

import pytest

import slopekit as sk
from slopekit.design.templates import path_of

BASAL = str(path_of("wedge-basal"))
WEDGE = str(path_of("wedge"))
#: Not of the factor: of the inputs (studies say those of their own), of other methods, of what a run asks besides.
APART = {"W320"}
DESIGNS = {
    "moments": (
        WEDGE,
        {"joints.J1.plane": "40/160", "joints.J2.plane": "80/220", "strength.weak.c": 20},
        "strength.weak.phi",
        0.62,
    ),
    "into the slope": (
        str(path_of("plane")),
        {"joints.J1.plane": "35/190", "loads.seismic": "0.1@000"},
        "strength.bedding.phi",
        None,
    ),
    "typed in Pa": (
        str(path_of("plane")),
        {"strength.bedding.c": 50000},
        "strength.bedding.phi",
        None,
    ),
    "dilates": (
        WEDGE,
        {"strength.weak.dilation": 10, "strength.weak.tension": 50},
        "strength.weak.phi",
        1.5,
    ),
    "bolts": (WEDGE, {"support.bolts": ["100 MN@000/10,passive"]}, "strength.weak.phi", 1.6),
    "dry crack": (
        WEDGE,
        {"crack": {"plane": "80/180", "distance": 5}, "water": {"pressures": [5, 5]}},
        "strength.weak.phi",
        None,
    ),
}


def codes(outcome) -> set[str]:
    return {notice.code for notice in outcome.warnings}


@pytest.mark.slow
@pytest.mark.parametrize("name", DESIGNS)
def test_studies_say_what_the_run_says(name) -> None:
    """The codes of `run` at each point, and at the value found for a factor."""
    source, values, key, target = DESIGNS[name]
    if target is None:
        value = 30.0
    else:
        found = sk.solve(sk.load(source, set=values), key, fos=target)
        value = found.answer.value
    at = sk.run(source, set=values | {key: value})
    assert codes(at) - APART
    assert target is None or codes(at) - APART <= codes(found)
    swept = sk.sweep(sk.load(source, set=values), {key: [value]})
    assert codes(at) - APART <= codes(swept)


@pytest.mark.slow
def test_support_says_what_the_run_says_with_its_bolts_and_without() -> None:
    """W410: the whole wedge, which the basal joint cuts off, may need the bolts more than the block above it."""
    found = sk.support(sk.load(BASAL), 1.5, acts="active")
    assert "W410" in codes(found)
    (of_whole,) = (notice for notice in found.warnings if notice.code == "W410")
    assert "as it stands: " in of_whole.message


def test_a_point_of_many_names_its_place() -> None:
    """W302 where a swept cohesion is that of intact rock, at how many points, and at which first."""
    swept = sk.sweep(sk.load(str(path_of("plane"))), {"strength.bedding.c": [25, 4000, 6000, 8000]})
    (notice,) = swept.warnings
    assert str(notice).startswith(
        "W302 2 of 4 points, at strength.bedding.c = 6000 kPa: a cohesion of 6000 kPa"
    )


def test_a_probability_says_what_the_run_says_of_the_means() -> None:
    scattered = {"strength.bedding.phi": {"dist": "normal", "mean": 24, "sd": 2}}
    found = sk.prob(sk.load(BASAL, set=scattered), n=200)
    (of_whole,) = (notice for notice in found.warnings if notice.code == "W410")
    assert of_whole.message.startswith(
        "of the design at its means: the basal joint cuts the toe off"
    )


@pytest.mark.parametrize(
    "study",
    [
        lambda design: sk.sweep(design, {"strength.weak.phi": [20, 22]}),
        lambda design: sk.tornado(design, closed_form=True),
        lambda design: sk.solve(design, "strength.weak.phi", fos=1.6),
        lambda design: sk.support(design, 1.6, acts="active"),
    ],
)
def test_studies_are_of_the_peak_strength(study) -> None:
    """W417 with the factor of the residual strength, which `run` has beside the peak's."""
    left = {"c": 0, "phi": 16}
    alone = sk.run(WEDGE, set={"strength.weak.residual": left}).comparisons.residual
    found = study(sk.load(WEDGE, set={"strength.weak.residual": left}))
    (notice,) = (notice for notice in found.warnings if notice.code == "W417")
    assert f"has {alone.limit:.4g}" in notice.message
    assert alone.limit < 1.0


def test_without_a_residual_strength_nothing_is_said_of_it() -> None:
    assert "W417" not in codes(sk.sweep(sk.load(WEDGE), {"strength.weak.phi": [20, 22]}))


def test_check_judges_the_residual_strength() -> None:
    """A rule on it was not met for want of the number; W417 is said as `run` says it."""
    design = sk.load(
        WEDGE,
        set={
            "strength.weak.residual": {"c": 0, "phi": 18},
            "acceptance.rules": ["fos >= 1.1", "fos.residual >= 1"],
        },
    )
    found, run = sk.check(design), sk.run(design)
    assert found.exit_code == run.exit_code == 0
    assert codes(found) == codes(run) == {"W417"}


def test_joints_that_dilate_are_not_compared_in_an_earthquake() -> None:
    """The closed form knows no dilation: its lower k_y is no disagreement, as W310 of the run says."""
    found = sk.quake(sk.load(WEDGE, set={"strength.weak.dilation": 10}), "sine:0.5g,1Hz")
    ours, other = (one.coefficient for one in found.yields)
    assert ours > 1.05 * other
    assert (found.agree, found.exit_code) == (None, 0)
    assert "DISAGREE" not in str(found.sheet)
    assert "W310" in codes(found)


@cache
def solved_for_both():
    """The friction of the basal joint for 1.3 and for 3.5."""
    cases = {"low": {"accept": "fos >= 1.3"}, "high": {"accept": "fos >= 3.5"}}
    return sk.solve(sk.load(BASAL, set={"cases": cases}), "strength.bedding.phi")


@pytest.mark.slow
def test_a_value_that_the_whole_wedge_does_not_bear_is_not_enough() -> None:
    """W507: the block above the basal joint has 3.5 with 61.6° on that joint, the wedge that it is cut from 3.171."""
    short = solved_for_both().cases["high"]
    (notice,) = (notice for notice in short.warnings if notice.code == "W507")
    run = sk.run(
        BASAL, set={"strength.bedding.phi": short.answer.value, "acceptance.rules": "fos >= 3.4999"}
    )
    assert (
        f"falls short of 3.5: slides on both, FoS {run.comparisons.without_basal.closed_form:.4g}"
        in notice.message
    )
    assert (short.exit_code, run.exit_code) == (1, 1)
    enough = solved_for_both().cases["low"]
    assert "W507" not in codes(enough)
    assert enough.exit_code == 0


@pytest.mark.slow
def test_bolts_that_hold_a_part_of_a_wedge_alone_are_said() -> None:
    found = sk.support(sk.load(BASAL, set={"strength.joint.phi": 10}), 1.5, acts="passive")
    (lacks,) = (case.lacks for case in found.cases)
    assert lacks.startswith(
        "NOT REACHED, FoS 1.5: W507 with these bolts the whole wedge without the basal joint falls"
    )
    assert lacks in " ".join(str(found).split())
    assert (found.exit_code, found.reached) == (1, False)
    assert found.cases[0].yaml.startswith("# NOT REACHED, FoS 1.5: W507")
    assert found.cases[0].factors.limit == pytest.approx(
        1.5032, abs=1e-3
    )  # each bolt is rounded up to 10 kN
    none = sk.support(sk.load(BASAL, set={"strength.bedding.phi": 70}), 3.5, acts="active")
    assert none.stands
    assert "as it stands the whole wedge" in next(
        one.message for one in none.warnings if one.code == "W507"
    )
    assert none.exit_code == 1


@pytest.mark.slow
def test_no_load_case_is_met_that_the_whole_wedge_does_not_meet() -> None:
    """The value that governs is that of the block above the basal joint: 3.5 with 61.6°, the whole wedge has 3.171."""
    found = solved_for_both()
    assert {name: one.exit_code for name, one in found.cases.items()} == {"low": 0, "high": 1}
    assert found.exit_code == 1


@pytest.mark.slow
def test_rules_that_a_study_does_not_judge_are_named() -> None:
    """W332: the value found gives the factor of the rule on fos, a rule on the lowest breaks there."""
    rules = {"acceptance.rules": ["fos >= 1.2", "fos.lowest >= 1.2"]}
    columns = sk.load(str(path_of("topple")), set=rules)
    found = sk.solve(columns, "strength.bedding.phi")
    (notice,) = (one for one in found.warnings if one.code == "W332")
    assert (
        notice.message
        == "acceptance also asks for fos.lowest >= 1.2: not looked at here, run judges it"
    )
    run = sk.run(str(path_of("topple")), set=rules | {"strength.bedding.phi": found.answer.value})
    assert run.fos.lowest < 1.2
    assert "W332" in codes(sk.sweep(columns, {"strength.bedding.phi": [20]}))
    assert "W332" not in codes(sk.solve(columns, "strength.bedding.phi", fos=1.2))


@pytest.mark.parametrize(
    ("study", "names"),
    [
        (
            lambda design: sk.sweep(design, {"strength.joints.phi": [20]}),
            "face, upper, height, c, density",
        ),
        (
            lambda design: sk.tornado(design, closed_form=True),
            "face, upper, height, c, phi, density",
        ),
        (lambda design: sk.solve(design, "slope.height", fos=1.3), "face, upper, c, phi, density"),
        (lambda design: sk.quake(design, "sine:0.5g,1Hz"), "face, upper, height, c, phi, density"),
        (
            lambda design: sk.support(design, 1.6, acts="active"),
            "face, upper, height, c, phi, density",
        ),
    ],
)
def test_what_was_not_given_is_said(study, names) -> None:
    """W379, DEFAULTS of a run: what was taken from the paper's wedge, but for what a study varies itself."""
    design = sk.load(
        {
            "slopekit": 1,
            "kind": "wedge",
            "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
        }
    )
    found = study(design)
    (notice,) = (one for one in found.warnings if one.code == "W379")
    assert notice.message == f"not given, taken from the paper's wedge: {names}"
    assert "W379 not given" in str(found.sheet)
