"""The controls of every template: their sliders' ends are designs or coded faults; they say what the fields say."""

import re
from dataclasses import replace

import pytest

from slopekit.app import answers
from slopekit.app.controls import groups_of, slider_range, text_at, values_of
from slopekit.app.session import Session, opened_template
from slopekit.core.errors import DesignError
from slopekit.design.reading.files import load
from slopekit.design.templates import names
from slopekit.studies.keys import Key
from tests.app.pages import controls_of

LIVE = ("wedge", "plane", "footing")
#: Templates whose controls others have as well.
LIKE_OTHERS = (
    "paper-wedge",
    "paper-footing",
    "paper-ellipsoid",
    "wedge",
    "goodman-bray",
    "cylinder",
    "sphere",
)
CODE = re.compile(r"E[0-9]{3}")


def both_ends(session, control):
    return control["words"] if control["type"] == "words" else [control["low"], control["high"]]


@pytest.mark.slow
@pytest.mark.parametrize("template", [name for name in names() if name not in LIKE_OTHERS])
def test_every_end_of_every_slider_is_a_design_or_a_fault_with_a_code(template):
    session = Session(opened_template(template))
    tried = 0
    for path, control in controls_of(session.design, session.opened.design).items():
        if control["type"] == "text" or (
            ".polygon." in path and tried % 7
        ):  # of a wall's many corners some
            tried += 1
            continue
        for value in both_ends(session, control):
            session.open(session.opened)
            session.set({path: value}, final=True)  # a path that fits nowhere would raise
            faults = session.moment.faults
            assert all(CODE.fullmatch(fault.code) and fault.code != "E599" for fault in faults), (
                path,
                value,
                faults,
            )
            if not faults and control["type"] == "number":
                now = session.numbers[path].value
                assert now == pytest.approx(value, rel=1e-9, abs=1e-12), path
            tried += 1
    assert tried > 20


@pytest.mark.slow
@pytest.mark.parametrize("template", LIVE)
def test_the_same_are_answered_with_a_number_or_a_fault(template):
    """No exception comes through: analysing the ends is what dragging a slider does."""
    session = Session(opened_template(template))
    answered = 0
    for path, control in controls_of(session.design, session.opened.design).items():
        if control["type"] == "text" or path.startswith("analysis."):
            continue
        for value in both_ends(session, control):
            session.open(session.opened)
            session.set({path: value}, final=True)
            answer, _ = answers.analysed_answer(session.moment, with_scene=False)
            assert bool(answer["status"]) != bool(answer["faults"]), (path, value)
            assert all(CODE.fullmatch(fault["code"]) for fault in answer["faults"])
            assert answer["net"] is not None
            answered += 1
    assert answered > 20


@pytest.mark.parametrize("template", names())
def test_every_control_says_what_its_field_says(template):
    session = Session(opened_template(template))
    keys = values_of(session.design)
    for path, control in controls_of(session.design, session.opened.design).items():
        assert control["label"], path
        assert not control["changed"], path
        assert control["is_default"] is not control["given"], path
        if control["type"] in ("number", "count"):
            key = keys[path]
            assert key.low <= control["low"] < control["high"] <= key.high, path
            assert control["unit"] in (key.unit, key.with_unit)
            if key.value is not None:
                assert control["low"] <= key.reduced(key.value) <= control["high"], path
                assert key.read(control["text"].replace("°", " deg")) == pytest.approx(
                    key.value, rel=1e-9
                ), path
            assert (
                0.0 < control["step"] <= (control["high"] - control["low"]) / 2.0
                or control["type"] == "count"
            )
            assert not control["log"] or control["low"] > 0.0
        elif control["type"] == "words":
            assert control["value"] in (None, *control["words"]), path


def test_groups_come_in_the_order_of_a_file_and_what_is_given_first():
    design = Session(opened_template("wedge")).design
    groups = groups_of(design, design)
    assert [group["name"] for group in groups] == [
        "title",
        "slope",
        "joints",
        "strength",
        "rock",
        "water",
        "loads",
        "analysis",
    ]
    for group in groups:
        given = [control["given"] for control in group["controls"]]
        assert given == sorted(given, reverse=True), group["name"]


def test_a_default_is_grey_until_it_is_touched_and_marked_then():
    session = Session(opened_template("wedge"))
    before = controls_of(session.design, session.opened.design)["rock.gravity"]
    assert (before["given"], before["value"]) == (False, 9.81)
    session.set({"rock.gravity": 9.8}, final=True)
    after = controls_of(session.design, session.opened.design)["rock.gravity"]
    assert (after["given"], after["changed"], after["value"], after["opened"]) == (
        True,
        True,
        9.8,
        "9.81 m/s²",
    )


def test_words_offer_the_names_that_the_design_has():
    session = Session(opened_template("wedge-scatter"))
    controls = controls_of(session.design, session.opened.design)
    assert controls["joints.J1.strength"]["words"] == ["clay", "rough"]
    assert controls["joints.J1.strength"]["value"] == "clay"
    assert controls["water.mode"]["words"] == ["dry", "full"]
    assert "basal.strength" not in controls  # there is none


def test_a_number_that_scatters_stands_by_its_mean():
    session = Session(opened_template("wedge-scatter"))
    controls = controls_of(session.design, session.opened.design)
    assert "strength.clay.phi" not in controls
    assert controls["strength.clay.phi.mean"]["scatter"]["sd"] == 2.5
    session.set({"strength.clay.phi.mean": 26}, final=True)
    assert [
        one.value
        for one in (
            session.numbers["strength.clay.phi.mean"],
            session.numbers["strength.clay.phi.sd"],
        )
    ] == [26.0, 2.5]


@pytest.mark.parametrize(
    ("path", "new", "text"),
    [
        ("slope.height", 70.0, "70 m"),
        ("strength.weak.c", 12.5, "12.5 kPa"),
        ("strength.weak.phi", 0.5, "0.5 deg"),  # a bare 0.5 would be taken for radians
        ("strength.weak.phi", 1.0, "1"),
        ("rock.density", 2500.0, "2500 kg/m3"),
        ("analysis.agree_within", 0.02, "2 %"),
        ("joints.J1.plane.dip_direction", 365.0, "5"),
    ],
)
def test_a_number_is_written_in_the_unit_that_stands_there(path, new, text):
    session = Session(opened_template("wedge"))
    session.set({path: new}, final=True)
    assert session.moment.faults == ()
    assert text_at(session.moment.document, path) == text


def test_sliders_reach_about_what_is_there():
    assert slider_range(Key("slope.height", "length", 10.0, 1e-3, 1e5)) == (2.5, 30.0)
    assert slider_range(Key("a", "angle", 200.0, 0.0, 360.0, period=360.0)) == (0.0, 360.0)
    assert slider_range(Key("a", "stiffness", 1e7, 1.0, 1e12)) == (1e5, 1e9)
    assert slider_range(Key("a", "length", 3.0, -1e5, 1e5, "coordinate")) == (-17.0, 23.0)
    assert slider_range(Key("loads.seismic.k", "ratio", 0.0, 0.0, 2.0)) == (0.0, 0.5)


def test_a_design_that_is_not_from_a_file_has_controls_too():
    wedge = {
        "slopekit": 1,
        "kind": "wedge",
        "joints": {"J1": {"plane": [45, 115]}, "J2": {"plane": "45/245"}},
    }
    design = load(wedge)
    found = controls_of(design, design)
    assert found["joints.J1.plane.dip"]["value"] == 45.0
    bare = replace(design, source=None)
    with pytest.raises(DesignError, match="E280"):
        controls_of(bare, bare)


@pytest.mark.parametrize("water", ["50 %", {"fill": 0.5}, {"pressures": {"J1": 3}}])
def test_a_word_that_does_not_count_says_what_does(water):
    design = load(
        {
            "slopekit": 1,
            "kind": "wedge",
            "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
            "water": water,
        }
    )
    mode = controls_of(design, design)["water.mode"]
    assert (mode["value"], mode["instead"]) == (
        None,
        "pressures" if isinstance(water, dict) and "pressures" in water else "fill",
    )


def test_the_numbers_of_a_design_are_found_once(monkeypatch) -> None:
    """What is set asks for them three times; another design has its own."""
    from slopekit.app import controls

    asked = []
    found = controls.keys_of
    monkeypatch.setattr(controls, "keys_of", lambda design: asked.append(design) or found(design))
    session = Session(opened_template("wedge"))
    for height in (30.0, 31.0):
        asked.clear()
        session.set({"slope.height": height}, final=True)
        answers.analysed_answer(session.moment, with_scene=False)
        assert "slope.height" in session.changed
        assert session.values_at(["slope.height"])["slope.height"]["value"] == height
        assert len(asked) == 1
