"""One design under work: undo, redo, back to what was opened; faults leave the last sound design standing."""

import random

import pytest

from slopekit.app.controls import text_at
from slopekit.app.session import Session, differing_paths, opened_template, opened_text
from slopekit.core.errors import DesignError
from slopekit.design.reading.files import load
from slopekit.design.reading.nodes import document_from
from slopekit.design.registry import KINDS
from slopekit.design.templates import path_of
from slopekit.kinds import kind_named
from tests.app.pages import controls_of

DIP = "joints.J1.plane.dip"


@pytest.fixture
def wedge():
    return Session(opened_template("wedge"))


def test_every_kind_says_when_it_is_answered():
    """As docs/app.md says, by what an analysis takes: hundredths of a second, half a second, many seconds."""
    records = {name: kind_named(name).record for name in KINDS}
    said = {
        name: "drag" if record.HAS_CLOSED_FORM else record.ANSWERED
        for name, record in records.items()
    }
    assert set(said.values()) == {"drag", "release", "button"}
    dragged, let_go = ("wedge", "plane", "footing"), ("topple", "blocks", "surface")
    assert (
        said.items()
        >= (
            dict.fromkeys(dragged, "drag") | dict.fromkeys(let_go, "release") | {"bench": "button"}
        ).items()
    )


def test_a_change_is_what_set_makes_of_the_file(wedge):
    """Against `load` with the same values, which reads the text anew."""
    wedge.set(
        {DIP: 50, "strength.weak.phi": 24, "water.fill": 0.25, "slope.height": "120 ft"}, final=True
    )
    of_file = load(
        path_of("wedge"),
        [(DIP, 50), ("strength.weak.phi", 24), ("water.fill", 0.25), ("slope.height", "120 ft")],
    )
    assert wedge.design.input_hash() == of_file.input_hash()


def test_a_run_of_changes_that_are_not_final_is_one_step(wedge):
    for dip in (46, 47, 48):
        wedge.set({DIP: dip}, final=False)
    assert not wedge.done
    wedge.set({DIP: 49}, final=True)
    wedge.set({"slope.height": 60}, final=True)
    assert len(wedge.done) == 2
    wedge.undo()
    assert (wedge.numbers[DIP].value, wedge.numbers["slope.height"].value) == (49.0, 64.89)
    wedge.undo()
    assert wedge.numbers[DIP].value == 45.0
    assert (wedge.can_undo, wedge.can_redo, wedge.changed, wedge.is_saved) == (
        False,
        True,
        [],
        True,
    )
    wedge.redo()
    wedge.redo()
    assert wedge.changed == ["slope.height", DIP]
    assert not wedge.can_redo


def test_a_change_after_undo_forgets_what_was_undone(wedge):
    wedge.set({DIP: 50}, final=True)
    wedge.undo()
    wedge.set({DIP: 40}, final=True)
    wedge.redo()
    assert wedge.numbers[DIP].value == 40.0


def test_undo_takes_back_what_is_being_dragged(wedge):
    wedge.set({DIP: 50}, final=False)
    assert wedge.can_undo
    wedge.undo()
    assert wedge.numbers[DIP].value == 45.0
    wedge.undo()
    wedge.undo()  # there is nothing more


def test_every_change_has_a_number_of_its_own(wedge):
    seen = [wedge.rev]
    for step in (
        lambda: wedge.set({DIP: 50}, final=True),
        wedge.undo,
        wedge.redo,
        lambda: wedge.reset(DIP),
        lambda: wedge.open(wedge.opened),
    ):
        step()
        seen.append(wedge.rev)
    assert seen == sorted(set(seen))


def test_a_fault_leaves_the_last_sound_design(wedge):
    wedge.set({DIP: 95}, final=True)
    assert [fault.code for fault in wedge.moment.faults] == ["E101"]
    assert wedge.design.joints[0].dip_deg == 45.0
    assert text_at(wedge.moment.document, DIP) == "95"
    wedge.set({"slope.height": 60}, final=True)  # the fault stays until it is put right
    assert wedge.moment.faults
    wedge.set({DIP: 55}, final=True)
    assert wedge.moment.faults == ()
    assert (wedge.design.joints[0].dip_deg, wedge.design.height_m) == (55.0, 60.0)
    wedge.set({DIP: 95}, final=True)  # the last one, not that which was opened
    assert wedge.moment.faults
    assert (wedge.design.joints[0].dip_deg, wedge.design.height_m) == (55.0, 60.0)


def test_values_that_fit_nowhere_change_nothing(wedge):
    before = wedge.moment
    for values in (
        {"title.x": 3},
        {"a..b": 1},
        {"slope.height": 3, "kind.of": 2},
        {"title": "x" * 3000},
    ):
        with pytest.raises(DesignError):
            wedge.set(values, final=True)
        assert wedge.moment is before
        assert not wedge.can_undo


@pytest.mark.parametrize(
    "template", ["wedge", "rough", "blocks", "goodman-bray", "wedge-scatter", "footing"]
)
def test_reset_puts_back_what_was_opened_and_leaves_nothing_else(template):
    session = Session(opened_template(template))
    generator = random.Random(template)
    every = [
        one
        for one in controls_of(session.design, session.opened.design).values()
        if one["type"] != "text"
    ]
    for control in generator.sample(every, 14):
        path = control["path"]
        session.set(
            {path: control["words"][-1] if control["words"] else control["high"]}, final=True
        )
        session.reset(path)
        assert session.changed == [], path
        assert differing_paths(session.opened.document.root, session.moment.document.root) == [], (
            path
        )


def test_reset_of_one_leaves_the_others(wedge):
    wedge.set({DIP: 50, "joints.J1.plane.dip_direction": 120, "strength.weak.phi": 22}, final=True)
    wedge.reset(DIP)
    assert wedge.changed == ["joints.J1.plane.dip_direction", "strength.weak.phi"]


def test_what_excludes_each_other_takes_the_place_of_the_other(wedge):
    wedge.set({"water.fill": 0.5}, final=True)
    wedge.set({"water.mode": "full"}, final=True)
    wedge.set({"water.pressures.J1": 5}, final=True)
    assert wedge.moment.document.root.get("water").plain() == {"pressures": {"J1": "5"}}
    wedge.set({"rock.unit_weight": 26}, final=True)
    assert wedge.moment.document.root.get("rock").plain() == {"unit_weight": "26"}
    assert wedge.design.rock.unit_weight_kn_m3 == 26.0


def test_a_title_is_words_whatever_they_begin_with(wedge):
    for title in ("[a] b", "{", "045", "'quoted", "a: b # c"):
        wedge.set({"title": title}, final=True)
        assert (wedge.moment.faults, wedge.design.title) == ((), title)


def test_a_plane_that_the_design_leaves_to_a_default_is_written_out():
    session = Session(
        opened_text(
            "slopekit: 1\nkind: wedge\njoints: {J1: {plane: 45/115}, J2: {plane: 45/245}}\n",
            "short.yaml",
        )
    )
    session.set({"slope.face.dip": 65}, final=True)
    assert session.moment.document.root.get("slope").plain() == {"face": "65/180.0"}
    session.reset("slope.face.dip")
    assert not session.moment.document.root.get("slope")


def test_what_is_different_is_named_as_high_as_it_differs():
    a = document_from(
        {"slope": {"height": 10}, "joints": {"J1": {"plane": "45/115"}}, "list": [1, 2]}
    ).root
    b = document_from(
        {"slope": {"height": 10, "face": "60/180"}, "list": [1, 3], "water": {"mode": "full"}}
    ).root
    assert differing_paths(a, b) == ["slope.face", "joints", "list.1", "water"]
    assert differing_paths(a, a) == []


def test_load_cases_stand_aside():
    text = (
        path_of("wedge").read_text(encoding="utf-8") + "cases: {wet: {set: {water.mode: full}}}\n"
    )
    session = Session(opened_text(text, "cases.yaml"))
    assert not session.moment.document.root.get("cases")
    session.set({DIP: 50}, final=True)
    assert session.moment.faults == ()
    with pytest.raises(DesignError, match="E471"):
        opened_text(text.replace("water.mode", "kind"), "cases.yaml")


def test_a_plane_typed_for_its_dip_is_the_plane_and_nonsense_can_be_typed_over():
    session = Session(opened_template("wedge"))
    session.set({"joints.J1.plane.dip": "46/116"}, final=True)
    first = session.design.joints[0]
    assert (first.dip_deg, first.dip_direction_deg) == (46.0, 116.0)
    session.set({"joints.J1.plane.dip": "46/116/3"}, final=True)
    assert session.moment.faults
    session.set({"joints.J1.plane.dip": "47"}, final=True)
    assert not session.moment.faults
    assert (session.design.joints[0].dip_deg, session.design.joints[0].dip_direction_deg) == (
        47.0,
        116.0,
    )


def test_the_box_of_what_is_no_number_holds_what_was_typed():
    session = Session(opened_template("wedge"))
    session.set({"rock.density": "<b>"}, final=True)
    assert session.values_at(["rock.density"])["rock.density"]["text"] == "<b>"
