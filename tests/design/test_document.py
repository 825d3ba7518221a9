"""Design files to located nodes: what is kept, every fault with its place, overrides, and odd files."""

import random
import re
from pathlib import Path

import numpy as np
import pytest

from slopekit.core.errors import DesignError
from slopekit.core.orientation import Line, Plane
from slopekit.design.reading import yaml as yaml_room
from slopekit.design.reading.document import (
    ALTERNATIVES,
    load_document,
    parse_override,
    read_document,
    with_overrides,
)
from slopekit.design.reading.nodes import Node, document_from

WALL = """\
slopekit: 1
kind: wedge            # a comment
title: North wall, bench 340
slope: {face: 60/180, upper: 10/180, height: 64.89 m}
joints:
  J1: {plane: 45/115, strength: weak}
  J2: {plane: 45/245, strength: weak}
strength:
  weak: {c: 50 kPa, phi: 20}
rock: {density: 2600 kg/m3}
water: {mode: dry}
support:
  bolts:
    - {force: 200 kN, toward: 000/-05}
    - {force: 100 kN, toward: 000/05}
"""
LAUGHS = "a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n" + "".join(
    f"{new}: &{new} [{', '.join([f'*{old}'] * 10)}]\n"
    for old, new in ("ab", "bc", "cd", "de", "ef", "fg")
)

# code, file, what the first line must say, the line it must stand at
BROKEN = [
    ("E150", "a: [1\nb: 2", "a bracket is not closed, or a comma is missing", 2),
    ("E150", "kind: wedge\na:\n\t- 1", "a tab stands where YAML takes only spaces", 3),
    ("E150", "a: 'x\nb: 2", "a quote is opened here and never closed", 1),
    ("E150", "kind: wedge\na: b: c", "a ':' where no key can stand", 2),
    ("E150", "a: 1\n  b: 2", "a ':' where no key can stand", 2),
    ("E150", "a: *weak", "*weak stands for nothing", 1),
    ("E150", 'file: "C:\\quarry"', "\\q means nothing inside double quotes", 1),
    ("E150", 'a: "\\Uffffffff"', "broken YAML", 1),
    ("E150", "a: @x", "a value cannot start with @", 1),
    ("E150", "a: }", "} stands where a value is needed", 1),
    ("E150", "a: 1\nnothing\n", "a line that is no 'key: value'", 2),
    (
        "E150",
        "  kind: wedge\nslope: 1\n",
        "text or a bracket stands behind the end of the design",
        2,
    ),
    ("E150", "a: - 1\n", "a '- ' where no list can stand", 1),
    ("E150", "a: !<foo x", "broken YAML", 1),
    ("E150", "%YAML 9.9\n---\na: 1", "broken YAML", 1),
    ("E149", "a: " + "[" * 10_000, "nested more than 100 deep", 1),
    ("E149", "{a: " * 10_000, "nested more than 100 deep", 1),
    (
        "E149",
        "".join(f"{k}: &n{k} {'[' * 40}{f'*n{k - 1}' if k else 1}{']' * 40}\n" for k in range(5)),
        "nested",
        3,
    ),
    (
        "E151",
        "kind: wedge\nslope: {face: 60/180}\nkind: plane",
        "kind is given twice, in lines 1 and 3",
        3,
    ),
    (
        "E151",
        "slope: {face: 60/180, face: 70/180}",
        "slope.face is given twice, in lines 1 and 1",
        1,
    ),
    ("E150", "a: &a {c: 1}\nb:\n  <<: *a", "<< under b is a merge key of YAML 1.1", 3),
    (
        "E150",
        "a: !!python/object:os.system ls",
        "a has the tag !!python/object:os.system, a design has none",
        1,
    ),
    ("E150", "a:\n - !foo 3", "a.0 has the tag !foo", 2),
    ("E150", "a: &a [1, *a]", "*a stands inside &a: a.1 contains itself", 1),
    ("E150", LAUGHS, "the aliases (*name) write out more than 50000 values", 5),
    ("E150", WALL + "---\nkind: plane\n", "a second design starts in line 16", 16),
    ("E150", "", "is empty", 0),
    ("E150", "# only a comment\n", "is empty", 0),
    ("E150", "---\n", "holds no design", 1),
    ("E150", "- kind: wedge\n", "holds a list, not keys with values", 1),
    ("E150", "kind wedge\n", "holds the text 'kind wedge', not keys", 1),
    ("E150", "? [a, b]\n: 1", "a key is a list or has keys of its own", 1),
    ("E150", "slope: {: 3}", "a key under slope is empty", 1),
    ("E159", 'a: "x\\0y"', "a holds the character U+0000", 1),
    ("E159", 'a: "\\ud800"', "a holds the character U+D800", 1),
    ("E159", "a: 1\nb: \x00", "line 2 of design.yaml holds the character U+0000", 2),
    ("E159", b"a: 1\nb: 20\xb0", "line 2 of design.yaml is not UTF-8 (byte 0xb0)", 2),
    ("E159", "a: 1".encode("utf-16"), "design.yaml is UTF-16, a design file is UTF-8", 0),
]


def written(folder: Path, content: str | bytes, name: str = "design.yaml") -> Path:
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def at(node: Node | None, path: str) -> Node:
    """The node at a dotted path."""
    for part in path.split("."):
        assert node is not None
        node = node.elements[int(part)] if part.isdigit() else node.get(part)
    assert node is not None
    return node


def caught(call) -> DesignError:
    with pytest.raises(DesignError) as error:
        call()
    return error.value


def test_every_value_knows_its_path_line_and_column(tmp_path) -> None:
    document = load_document(written(tmp_path, WALL, "north-wall.yaml"))
    joint = at(document.root, "joints.J1")
    assert str(joint.key_place) == "north-wall.yaml:6:3  J1: {plane: 45/115, strength: weak}"
    assert (joint.place.line, joint.place.column, joint.name) == (6, 7, "J1")
    bolt = at(document.root, "support.bolts.1.force")
    assert (bolt.path, bolt.text, bolt.key_place.line, bolt.place.column) == (
        "support.bolts.1.force",
        "100 kN",
        15,
        15,
    )
    assert document.name == "north-wall.yaml"
    assert [key for key, _ in document.root.items()][:3] == ["slopekit", "kind", "title"]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("045", "045"),
        ("0.10", "0.10"),
        ("1e5", "1e5"),
        ("0x10", "0x10"),
        ("yes", "yes"),
        ("2001-01-01", "2001-01-01"),
        ("60/180", "60/180"),
        ("'null'", "null"),
        ('""', ""),
        ("", None),
        ("~", None),
        ("null", None),
        ("!!str 5", "5"),
        ("12345678901234567890.123456789", "12345678901234567890.123456789"),
        ("φ = 20°", "φ = 20°"),
        (".nan", ".nan"),
    ],
)
def test_scalars_stay_as_written(text, value, tmp_path) -> None:
    assert at(load_document(written(tmp_path, f"a: {text}\nb: 1")).root, "a").value == value


def test_an_empty_value_stands_where_its_key_does(tmp_path) -> None:
    empty = at(load_document(written(tmp_path, "a:\n\n\nb: 1")).root, "a")
    assert empty.place.line == 1


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_line_ends_bom_and_unicode_keys(end, tmp_path) -> None:
    content = b"\xef\xbb\xbf" + end.join(["kind: wedge", "größe: {φ: 20}", "岩: 1"]).encode()
    root = load_document(written(tmp_path, content)).root
    assert at(root, "größe.φ").place.line == 2
    assert str(at(root, "岩").key_place) == "design.yaml:3:1  岩: 1"


def test_an_alias_is_written_out_with_its_own_path(tmp_path) -> None:
    root = load_document(written(tmp_path, "strength:\n  a: &weak {phi: 20}\n  b: *weak\n")).root
    assert at(root, "strength.b.phi").path == "strength.b.phi"
    assert at(root, "strength.b.phi").place.line == 2
    assert at(root, "strength.b").key_place.line == 3


def test_long_lines_are_cut_about_the_column(tmp_path) -> None:
    root = load_document(written(tmp_path, f"a: [{'x' * 300}, {'y' * 30}, 1]")).root
    source = at(root, "a.1").place.source
    assert source.startswith("…")
    assert "y" * 30 in source
    assert len(source) <= 80


@pytest.mark.parametrize(
    ("code", "content", "says", "line"), BROKEN, ids=lambda value: str(value)[:30]
)
def test_broken_files(code, content, says, line, tmp_path) -> None:
    error = caught(lambda: load_document(written(tmp_path, content)))
    assert error.codes[0] == code
    assert says in error.faults[0].message
    assert (
        f"design.yaml:{line}" in error.faults[0].where
        if line
        else "design.yaml" in error.faults[0].where
    )
    assert error.exit_code == 2


def test_faults_that_leave_the_file_readable_come_at_once(tmp_path) -> None:
    content = "a: 1\na: 2\nb: !x 3\n<<: {}\n? [c]\n: 1\n"
    _, faults = read_document(written(tmp_path, content), [("a.b", "1")])
    assert [fault.code for fault in faults] == ["E151", "E150", "E150", "E150", "E160"]
    assert caught(lambda: load_document(written(tmp_path, content))).codes == (
        "E151",
        "E150",
        "E150",
        "E150",
    )


def test_missing_files_and_folders(tmp_path) -> None:
    written(tmp_path, WALL, "north-wall.yaml")
    missing = caught(lambda: load_document(tmp_path / "nort-wall.yaml"))
    assert str(missing.faults[0]).splitlines()[0] == "E147 nort-wall.yaml does not exist"
    gone = caught(
        lambda: load_document(tmp_path / "templates" / "wedge.yaml")
    )  # as README has it, in another folder
    assert gone.faults[0].advice.endswith(
        "templates. wedge is a template: slopekit templates new wedge writes wedge.yaml."
    )
    assert missing.faults[0].advice.endswith("north-wall.yaml?")
    assert (
        caught(lambda: load_document(tmp_path / "north-wall"))
        .faults[0]
        .advice.endswith("north-wall.yaml?")
    )
    assert (
        "There is no folder"
        in caught(lambda: load_document(tmp_path / "no" / "x.yaml")).faults[0].advice
    )
    assert caught(lambda: load_document(tmp_path / "north-wall.yaml" / "x")).codes == ("E147",)
    assert caught(lambda: load_document("a\0b")).codes == ("E147",)
    assert caught(lambda: load_document("a\udcffb")).codes == ("E147",)
    written(tmp_path, WALL, ".hidden.yaml")
    folder = caught(lambda: load_document(tmp_path))
    assert folder.codes == ("E148",)
    assert "is a folder, a file is needed" in folder.faults[0].message
    assert folder.faults[0].advice == "It holds north-wall.yaml."  # no hidden file
    assert caught(lambda: load_document("x" * 5000)).codes == ("E148",)


def test_a_file_without_permission(tmp_path, monkeypatch) -> None:
    def refuse(*_args: object) -> None:
        raise PermissionError(13, "Permission denied")

    (tmp_path / "design.yaml").touch()
    monkeypatch.setattr("builtins.open", refuse)
    error = caught(lambda: load_document(tmp_path / "design.yaml"))
    assert (
        str(error.faults[0]).splitlines()[0] == "E148 design.yaml cannot be read: permission denied"
    )


@pytest.mark.slow
def test_files_that_are_too_large(tmp_path) -> None:
    large = caught(lambda: load_document(written(tmp_path, b"# " + b"x" * 5_000_000)))
    assert str(large.faults[0]).splitlines()[0] == (
        "E149 design.yaml is larger than 5 MB, that is no design"
    )
    many = caught(lambda: load_document(written(tmp_path, "a: [" + "1," * 1_000_000 + "1]")))
    assert "more than 200000 values" in many.faults[0].message


def test_a_file_of_a_hundred_thousand_lines(tmp_path) -> None:
    path = written(tmp_path, "# remark\n" * 99_000 + "".join(f"k{k}: {k}\n" for k in range(1_000)))
    assert at(load_document(path).root, "k999").place.line == 100_000


# -- overrides --------------------------------------------------------------------------------------------------------


def test_overrides_replace_create_and_remove(tmp_path) -> None:
    overrides = [
        ("strength.weak.phi", "25"),
        ("support.bolts.1.force", "150 kN"),
        ("loads.seismic.k", "0.1"),
        ("slope.profile", "[[0, 0], [1, 2]]"),
        ("strength.weak.c", "{dist: normal, mean: 5, sd: 1}"),
        ("title", ""),
        ("correlation.J1.phi/J2.phi", "0.5"),
        ("kind", "'null'"),
    ]
    root = with_overrides(load_document(written(tmp_path, WALL)), overrides).root
    assert str(at(root, "strength.weak.phi").place) == "--set strength.weak.phi=25"
    assert at(root, "strength.weak.phi").text == "25"
    assert at(root, "support.bolts").plain() == [
        {"force": "200 kN", "toward": "000/-05"},
        {"force": "150 kN", "toward": "000/05"},
    ]
    assert at(root, "loads.seismic.k").path == "loads.seismic.k"
    assert at(root, "slope.profile.1").plain() == ["1", "2"]
    assert at(root, "strength.weak.c.mean").path == "strength.weak.c.mean"
    assert not root.get("title")
    assert root.get("correlation").plain() == {"J1.phi/J2.phi": "0.5"}
    assert at(root, "kind").text == "null"


def test_overrides_take_python_values() -> None:
    document = document_from({"a": 1})
    overrides = [
        ("b", 25),
        ("c", [1, (2.5, np.float64(3))]),
        ("d", {"x": True}),
        ("a", None),
        ("e", np.arange(2)),
    ]
    assert with_overrides(document, overrides).root.plain() == {
        "b": "25",
        "c": ["1", ["2.5", "3.0"]],
        "d": {"x": "true"},
        "e": ["0", "1"],
    }
    assert document.root.plain() == {"a": "1"}


@pytest.mark.parametrize(
    ("overrides", "left"),
    [
        ([("water.fill", "50 %")], {"fill": "50 %"}),
        ([("water.pressures.J1", "5")], {"pressures": {"J1": "5"}}),
        ([("water", "{mode: full}")], {"mode": "full"}),
        ([("water.fill", "50 %"), ("water.mode", "full")], {"fill": "50 %", "mode": "full"}),
        (
            [("water.pressures.J1", "5"), ("water.mode", "full")],
            {"pressures": {"J1": "5"}, "mode": "full"},
        ),
        ([("water.fill", "null")], {"mode": "dry"}),
        ([("water.fillet", "1")], {"mode": "dry", "fillet": "1"}),
    ],
)
def test_alternatives_of_the_file_give_way(overrides, left) -> None:
    """What was set twice over is kept, for the fault that names both."""
    assert "water" in ALTERNATIVES
    document = document_from({"water": {"mode": "dry"}})
    assert with_overrides(document, overrides).root.get("water").plain() == left


# code, override, what the first line must say
BAD_OVERRIDES = [
    ("E160", ("a..b", "1"), "'a..b' is no path to a key"),
    ("E160", ("a", "[1, 2"), "the value of --set a is broken YAML"),
    ("E160", ("a", "x\x00"), "is no text"),
    ("E149", (".".join(["a"] * 200), "1"), "nested more than 100 deep"),
    ("E151", ("a", "{x: 1, x: 2}"), "a.x is given twice"),
    ("E150", ("a", "[!!python/name:os 1]"), "has the tag"),
    ("E160", ("slope.face.strike", "60"), "slope.face is the value 60/180, it has no strike"),
    ("E160", ("bolts.2.force", "1"), "bolts has 2 items, there is no item 2"),
    ("E160", ("bolts.-1", "1"), "bolts is a list, -1 is no number of an item"),
    ("E160", ("bolts.first", "1"), "bolts is a list, first is no number"),
    ("E160", ("bolts.0", ""), "bolts.0 cannot be taken out of its list"),
    ("E405", ("a", object()), "a is of the type object, no design holds that"),
    ("E405", ("a", 1j), "a is of the type complex"),
    ("E405", ("a", {"b": b"x"}), "a.b is of the type bytes"),
]


@pytest.mark.parametrize(
    ("code", "override", "says"),
    BAD_OVERRIDES,
    ids=lambda value: re.sub(" at 0x.*", "", str(value))[:30],
)
def test_bad_overrides(code, override, says) -> None:
    document = document_from({"slope": {"face": "60/180"}, "bolts": [{"force": 1}, {"force": 2}]})
    error = caught(lambda: with_overrides(document, [override]))
    assert error.codes == (code,)
    assert says in error.faults[0].message
    assert error.faults[0].where.startswith("--set ")


def test_all_bad_overrides_come_at_once() -> None:
    document = document_from({"a": "1"})
    error = caught(
        lambda: with_overrides(document, [("a.b", "1"), ("c", "1"), ("c", "2"), ("d", "{")])
    )
    assert error.codes == ("E160", "E151", "E160")
    assert error.faults[1].message == "c is set twice"


def test_parse_override() -> None:
    assert parse_override(" acceptance.rules = [fos >= 1.5]") == (
        "acceptance.rules",
        "[fos >= 1.5]",
    )
    for text in ("strength.weak.phi", "=25", ""):
        error = caught(lambda text=text: parse_override(text))
        assert error.codes == ("E160",)
        assert "is not key=value" in error.faults[0].message


# -- from Python ------------------------------------------------------------------------------------------------------


def test_a_mapping_gives_the_tree_that_its_file_gives(tmp_path) -> None:
    mapping = {
        "slope": {"face": Plane(60, 180), "height": 64.89, "upper": None},
        "mesh": Path("slip.stl"),
        "toward": Line(0.0, -5.0),
        "list": (1, 2),
    }
    document = document_from(mapping)
    text = "slope: {face: 60/180, height: 64.89}\nmesh: slip.stl\ntoward: 0.0/-5.0\nlist: [1, 2]\n"
    assert document.root.plain() == load_document(written(tmp_path, text)).root.plain()
    assert str(at(document.root, "slope.height").place) == "design: slope.height = 64.89"
    assert not at(document.root, "slope.height").get("x")


def test_mappings_no_file_could_hold() -> None:
    endless: dict = {}
    endless["a"] = {"b": endless}
    assert caught(lambda: document_from(endless)).codes == ("E150",)
    assert caught(lambda: document_from({"a": object(), "b": "\ud800", 1: 2, "1": 3})).codes == (
        "E405",
        "E405",
        "E151",
    )
    assert caught(lambda: document_from([1])).codes == ("E150",)
    deep: list = []
    for _ in range(2000):
        deep = [deep]
    assert caught(lambda: document_from({"a": deep})).codes == ("E149",)
    assert document_from({"a": 10**400, "b": float("nan")}).root.plain() == {"a": "inf", "b": "nan"}


def test_mutated_files_give_faults_and_no_traceback(tmp_path) -> None:
    """Seeded: pieces dropped, doubled and replaced by YAML's own marks."""
    rng = random.Random(3)
    pieces = [
        "{",
        "}",
        "[",
        "]",
        ":",
        ": ",
        "- ",
        "\t",
        "\n",
        "'",
        '"',
        "&a ",
        "*a",
        "!",
        "!!x ",
        "|",
        ">",
        "%",
        "@",
        "<<: ",
        "? ",
        "---\n",
        "...\n",
        "#",
        "\\",
        "\x00",
        "\x07",
        "\x85",
        " ",
        "ÿ",
        "~",
        ",",
        "\r",
    ]
    faults, loaded = [], 0
    for _ in range(200):
        text = WALL
        for _ in range(rng.randint(1, 4)):
            k, n = rng.randrange(len(text)), rng.randint(0, 6)
            text = (
                text[:k] + rng.choice([rng.choice(pieces), text[k : k + n] * 2, ""]) + text[k + n :]
            )
        try:
            load_document(written(tmp_path, text))
            loaded += 1
        except DesignError as error:
            faults += error.faults
    assert all(fault.code.startswith("E1") and fault.where for fault in faults)
    assert 14 < loaded < 186


def test_a_library_that_lacks_an_attribute_is_no_fault_of_the_file(tmp_path, monkeypatch) -> None:
    """ruamel.yaml 0.18, without the attribute that was looked at then, had every file called broken YAML."""
    from ruamel.yaml.parser import Parser

    path = tmp_path / "sound.yaml"
    path.write_text("kind: wedge\n", encoding="utf-8")
    monkeypatch.setattr(Parser, "get_event", lambda self: self.no_such_attribute)
    with pytest.raises(AttributeError, match="no_such_attribute"):
        load_document(path)


def test_as_many_values_as_the_message_says(tmp_path, monkeypatch) -> None:
    """A list of 2,500 numbers is more than 2,000 values; one of 1,990 is not. (Of 200,000 and a million: above.)"""
    monkeypatch.setattr(yaml_room, "MAX_VALUES", 2_000)
    many, few = (f"a: [{', '.join(['1'] * count)}]".encode() for count in (2_500, 1_990))
    refused = caught(lambda: load_document(written(tmp_path, many))).faults[0]
    assert (refused.code, refused.message) == ("E149", "there are more than 200000 values")
    assert len(load_document(written(tmp_path, few)).root.get("a").elements) == 1_990
