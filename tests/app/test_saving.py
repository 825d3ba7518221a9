"""Saving touches only the lines of what changed, writes what was shown, and nothing else."""

import os
import random
import stat
import sys

import pytest

from slopekit.app import saving
from slopekit.app.saving import Autosave, change_of, edited, save
from slopekit.app.session import Session, opened_file, opened_template, opened_text
from slopekit.core.errors import DesignError
from slopekit.design.reading.files import load
from tests.app.pages import controls_of

BLOCK = """\
# a wedge, written at length
slopekit: 1
kind: "wedge"
title: 'North''s wall'   # quoted
slope:
  face: 60/180     # measured
  upper: [10, 180]

  # the height is from the survey
  height: 64.89 m
joints:
  J1: &one
    plane: {dip: 45, dip_direction: 115}
    strength: weak
  J2:
    plane:
      dip: {dist: normal, mean: 45, sd: 3}   # a guess
      dip_direction: 245
    strength: weak
strength: {weak: {c: 50 kPa, phi: 20}}   # both joints
water: dry
rock:
  density: 2600 kg/m3
# the end
"""


def lines_changed(before, after):
    """Which lines of two texts are another; none is added or taken away."""
    one, two = before.splitlines(keepends=True), after.splitlines(keepends=True)
    assert len(one) == len(two)
    return [(a, b) for a, b in zip(one, two, strict=True) if a != b]


@pytest.mark.parametrize(
    ("values", "old", "new"),
    [
        (
            {"slope.face.dip": 65},
            "  face: 60/180     # measured\n",
            "  face: 65/180     # measured\n",
        ),
        ({"slope.upper.dip": 5}, "  upper: [10, 180]\n", "  upper: 5/180\n"),
        ({"slope.height": 70}, "  height: 64.89 m\n", "  height: 70 m\n"),
        (
            {"joints.J1.plane.dip": 50},
            "    plane: {dip: 45, dip_direction: 115}\n",
            "    plane: {dip: 50, dip_direction: 115}\n",
        ),
        (
            {"joints.J2.plane.dip.mean": 47},
            "      dip: {dist: normal, mean: 45, sd: 3}   # a guess\n",
            "      dip: {dist: normal, mean: 47, sd: 3}   # a guess\n",
        ),
        (
            {"joints.J2.plane.dip_direction": 250},
            "      dip_direction: 245\n",
            "      dip_direction: 250\n",
        ),
        ({"water.fill": "30 %"}, "water: dry\n", "water: {fill: 30 %}\n"),
        ({"rock.unit_weight": 26}, "  density: 2600 kg/m3\n", "  unit_weight: 26\n"),
        (
            {"title": "O'Hara: #1"},
            "title: 'North''s wall'   # quoted\n",
            "title: 'O''Hara: #1'   # quoted\n",
        ),
        (
            {"strength.weak.tension": 3},
            "strength: {weak: {c: 50 kPa, phi: 20}}   # both joints\n",
            "strength: {weak: {c: 50 kPa, phi: 20, tension: 3}}   # both joints\n",
        ),
    ],
)
@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_only_the_line_of_a_value_is_touched(values, old, new, newline):
    text = BLOCK.replace("\n", newline)
    session = Session(opened_text(text, "block.yaml"))
    session.set(values, final=True)
    assert session.moment.faults == ()
    after = edited(session.opened, session.moment.document)
    assert lines_changed(text, after) == [(old.replace("\n", newline), new.replace("\n", newline))]


def test_what_was_not_there_is_a_line_of_its_own():
    session = Session(opened_text(BLOCK.replace("# the end\n", ""), "block.yaml"))
    session.set({"rock.gravity": 9.8, "loads.seismic.k": 0.1, "slope.height": 70}, final=True)
    after = edited(session.opened, session.moment.document)
    added = [line for line in after.splitlines() if line not in BLOCK.splitlines()]
    assert added == ["  height: 70 m", "  gravity: 9.8", "loads: {seismic: {k: 0.1}}"]


def test_keys_that_are_written_as_synonyms_keep_their_words(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text(
        BLOCK.replace("{c: 50 kPa, phi: 20}", "{cohesion: 50 kPa, friction_angle: 20}"),
        encoding="utf-8",
    )
    session = Session(opened_file(path))
    session.set({"strength.weak.c": 40}, final=True)
    changed = lines_changed(
        path.read_text(encoding="utf-8"), edited(session.opened, session.moment.document)
    )
    assert [new for _, new in changed] == [
        "strength: {weak: {cohesion: 40 kPa, friction_angle: 20}}   # both joints\n"
    ]


def test_aliases_are_not_torn():
    """A value that two places share cannot change in one of them by its own line: it is said, not guessed."""
    text = BLOCK.replace(
        "  J2:\n    plane:\n      dip: {dist: normal, mean: 45, sd: 3}   # a guess\n"
        "      dip_direction: 245\n    strength: weak\n",
        "  J2: *one\n",
    )
    session = Session(opened_text(text, "alias.yaml"))
    session.set({"joints.J1.plane.dip": 50}, final=True)
    with pytest.raises(DesignError, match="E547"):
        edited(session.opened, session.moment.document)
    session.undo()
    session.set({"slope.height": 70}, final=True)
    assert lines_changed(text, edited(session.opened, session.moment.document)) == [
        ("  height: 64.89 m\n", "  height: 70 m\n")
    ]


@pytest.mark.slow
@pytest.mark.parametrize(
    "template", ["wedge", "wedge-scatter", "rough", "goodman-bray", "wall", "surface", "bench"]
)
def test_many_changes_read_again_are_the_design(template):
    """Each against the reader: the text that would be saved is the design on the page."""
    session, generator = Session(opened_template(template)), random.Random(template)
    every = [
        one
        for one in controls_of(session.design, session.opened.design).values()
        if one["type"] != "text"
    ]
    for control in generator.sample(every, 8):
        value = (
            generator.choice(control["words"])
            if control["words"]
            else generator.choice(
                [control["low"], control["high"], round((control["low"] + control["high"]) / 2)]
            )
        )
        session.set({control["path"]: value}, final=True)
        again, opened = edited(session.opened, session.moment.document), session.opened.text
        kept = set(opened.splitlines()) & set(again.splitlines())
        assert len(kept) >= len(set(opened.splitlines())) - len(session.changed) - 3
        assert "".join(line for line in again if line == "#") == "".join(
            line for line in opened if line == "#"
        )


# -- writing ----------------------------------------------------------------------------------------------------------


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "my wall.yaml"
    path.write_bytes(BLOCK.encode())
    return path


def changed(file):
    session = Session(opened_file(file))
    session.set({"slope.height": 70}, final=True)
    return session


def test_what_was_shown_is_written_and_nothing_beside_it(file):
    session = changed(file)
    change = change_of(session)
    assert (change.lines, change.changed_on_disk, change.target) == (1, False, file)
    assert change.diff.splitlines()[:2] == ["--- my wall.yaml", "+++ my wall.yaml"]
    assert [line for line in change.diff.splitlines()[2:] if line[0] in "+-"] == [
        "-  height: 64.89 m",
        "+  height: 70 m",
    ]
    assert save(session, None, change.diff) == file
    assert file.read_text(encoding="utf-8") == BLOCK.replace("64.89 m", "70 m")
    assert os.listdir(file.parent) == [file.name]
    assert session.is_saved
    assert load(file).height_m == 70.0
    session.undo()  # what was saved can still be taken back, and saved again
    assert not session.is_saved
    save(session, None, change_of(session).diff)
    assert file.read_bytes() == BLOCK.encode()


def test_another_difference_than_the_one_that_was_seen_is_not_written(file):
    session = changed(file)
    seen = change_of(session).diff
    session.set({"slope.height": 71}, final=True)
    for other in (seen, "", change_of(session).diff + " "):
        with pytest.raises(DesignError, match="E545"):
            save(session, None, other)
    assert file.read_bytes() == BLOCK.encode()


@pytest.mark.parametrize("what", ["changed", "gone"])
def test_a_file_that_changed_meanwhile_is_left_alone(file, what):
    session = changed(file)
    seen = change_of(session).diff
    if what == "changed":
        file.write_bytes(BLOCK.encode() + b"# someone else was here\n")
    else:
        file.unlink()
    assert change_of(session).changed_on_disk
    with pytest.raises(DesignError, match="E545"):
        save(session, None, seen)
    assert not file.exists() or file.read_bytes().endswith(b"here\n")


def test_a_new_name_never_writes_over_a_file(file, tmp_path):
    session = changed(file)
    other = tmp_path / "other.yaml"
    other.write_text("mine")
    with pytest.raises(DesignError, match="E547"):
        save(session, str(other), change_of(session, str(other)).diff)
    assert other.read_text() == "mine"
    third = tmp_path / "third.yaml"
    save(session, str(third), change_of(session, str(third)).diff)
    assert third.read_text(encoding="utf-8") == BLOCK.replace("64.89 m", "70 m")
    assert file.read_bytes() == BLOCK.encode()
    assert session.opened.path == third


@pytest.mark.parametrize("name", ["evil.sh", "x", ".bashrc", "a.yaml.exe"])
def test_only_design_files_are_written(file, name):
    with pytest.raises(DesignError, match="E547"):
        change_of(changed(file), str(file.parent / name))


def test_a_folder_that_is_not_there_is_said(file):
    session = changed(file)
    target = str(file.parent / "none" / "a.yaml")
    with pytest.raises(DesignError, match="E129"):
        save(session, target, change_of(session, target).diff)


def test_a_template_has_no_file_until_it_is_given_a_name():
    session = Session(opened_template("wedge"))
    session.set({"slope.height": 70}, final=True)
    with pytest.raises(DesignError, match="E547"):
        save(session, None, change_of(session).diff)


def test_a_design_with_faults_is_not_saved(file):
    session = changed(file)
    session.set({"slope.height": -1}, final=True)
    with pytest.raises(DesignError, match="E547"):
        change_of(session)


def test_a_byte_order_mark_and_the_rights_of_a_file_stay(file):
    file.write_bytes(b"\xef\xbb\xbf" + BLOCK.encode())
    if sys.platform != "win32":
        file.chmod(0o640)
    session = changed(file)
    save(session, None, change_of(session).diff)
    assert file.read_bytes() == b"\xef\xbb\xbf" + BLOCK.replace("64.89 m", "70 m").encode()
    if sys.platform != "win32":
        assert stat.S_IMODE(file.stat().st_mode) == 0o640
    session.set(
        {"slope.height": 71}, final=True
    )  # what was written is what the next save begins with
    save(session, None, change_of(session).diff)
    assert b"71 m" in file.read_bytes()


# -- what is not saved ------------------------------------------------------------------------------------------------


def test_what_is_not_saved_is_kept_and_offered_and_taken_up(file, tmp_path):
    folder = tmp_path / "state"
    first = Autosave(folder)
    session = changed(file)
    first.keep(session)
    assert first.offered() is None  # one's own is not offered
    later = Autosave(folder)
    offered = later.offered()
    assert (offered["title"], offered["id"]) == ("North's wall", first.number)
    other = Session(opened_template("plane"))
    later.restore(offered["id"], other)
    assert (other.changed, other.numbers["slope.height"].value) == (["slope.height"], 70.0)
    assert other.opened.path == file
    assert save(other, None, change_of(other).diff) == file
    later.keep(other)
    assert os.listdir(folder) == []


def test_nothing_is_kept_of_a_design_that_is_as_it_was_opened(tmp_path):
    folder, session = tmp_path / "state", Session(opened_template("wedge"))
    kept = Autosave(folder)
    kept.keep(session)
    assert not folder.exists()
    session.set({"slope.height": 70}, final=True)
    kept.keep(session)
    session.undo()
    kept.keep(session)
    assert os.listdir(folder) == []


def test_a_file_that_changed_since_is_still_refused_after_taking_up(file, tmp_path):
    kept = Autosave(tmp_path / "state")
    kept.keep(changed(file))
    file.write_bytes(BLOCK.encode() + b"# someone else\n")
    other = Session(opened_template("wedge"))
    Autosave(tmp_path / "state").restore(kept.number, other)
    with pytest.raises(DesignError, match="E545"):
        save(other, None, change_of(other).diff)


@pytest.mark.parametrize(
    "content", ["", "{}", "[1]", '{"title": 1}', "\udcff".encode("utf-8", "surrogateescape")]
)
def test_what_is_kept_and_cannot_be_read_is_not_offered(tmp_path, content):
    (tmp_path / "broken.json").write_bytes(
        content if isinstance(content, bytes) else content.encode()
    )
    kept = Autosave(tmp_path)
    assert kept.offered() is None
    with pytest.raises(DesignError, match="E548"):
        kept.restore("broken", Session(opened_template("wedge")))
    with pytest.raises(DesignError, match="E548"):
        kept.restore("../broken", Session(opened_template("wedge")))


def test_only_the_newest_are_kept(tmp_path, monkeypatch):
    session = Session(opened_template("wedge"))
    session.set({"slope.height": 70}, final=True)
    monkeypatch.setattr(saving, "_MOST_KEPT", 3)
    for _ in range(5):
        Autosave(tmp_path).keep(session)
    assert len(os.listdir(tmp_path)) == 3


def test_the_state_folder_goes_by_the_rule_of_the_system(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path))
    monkeypatch.setenv("HOME", str(tmp_path))
    for system, part in (
        ("linux", ("slopekit", "unsaved")),
        ("win32", ("slopekit", "unsaved")),
        ("darwin", ("Library", "Application Support", "slopekit", "unsaved")),
    ):
        monkeypatch.setattr(saving.sys, "platform", system)
        assert saving.state_folder() == tmp_path.joinpath(*part)


def test_keys_that_are_taken_away_take_their_lines_along() -> None:
    """In a block the whole line, in braces the key with its comma, from the front and behind; of nothing left {}."""
    text = (
        "slopekit: 1\nkind: wedge\njoints: {J1: {plane: 45/115}, J2: {plane: 45/245}}\nstrength:\n  weak:\n"
        "    c: 50 kPa   # tested\n    tension: 5 kPa   # a guess\n    phi: 20\nrock: {density: 2600 kg/m3}\n"
        "slope: {face: 60/180, upper: 10/180, height: 60}\nwater: {fill: 50 %}\n"
    )
    session = Session(opened_text(text, "my.yaml"))
    for path in ("strength.weak.tension", "rock.density", "slope.face", "slope.height"):
        session.set({path: None}, final=True)
    wanted = text.replace("    tension: 5 kPa   # a guess\n", "").replace("density: 2600 kg/m3", "")
    wanted = wanted.replace("face: 60/180, upper: 10/180, height: 60", "upper: 10/180")
    assert edited(session.opened, session.moment.document) == wanted
