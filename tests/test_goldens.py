"""The store of `benchmarks.goldens`: a cheap part of it compared, complete for what there is, and differences seen."""

import re
from pathlib import Path

import pytest

import slopekit as sk
from benchmarks import golden_budget
from benchmarks.golden_cases import COMMANDS, HEAVY, INPUTS, cases, in_store, listed, names_of_rows
from benchmarks.golden_text import LOOSER, compare_text, lines_of, same_value, text_of, tolerance_of
from benchmarks.goldens import compare, differences, read
from slopekit.cli import app
from slopekit.design.templates import names

#: Cases that stand for the rest in every run of the tests: some faults of designs (tests/design has each by itself),
#: some kinds, some studies.
CHEAP = re.compile(
    r"^(broken/(files|structure|results|quake|no-wedge|wedge-options)|wedge/paper|output/(templates|explain|help)|examples/02"
    r"|designs/(sheets|strike)|templates/(blocks|plane)|checks/footing"
    r"|studies/(sweep-curve|kinematic|support-short))"
)
#: Codes of reading that no file and no option reaches.
NOT_REACHED = {
    "E140": "a workbook where openpyxl is missing",
    "E405": "a value of a Python type, or a list of joints given in Python",
    "E280": "a design made in Python",
}


@pytest.mark.slow
def test_a_cheap_part_is_as_stored() -> None:
    """All of it: `python -m benchmarks.goldens compare`."""
    some = [case for case in cases() if CHEAP.search(case.name)]
    assert {case.group for case in some} == {case.group for case in cases()} - {"suite"}
    assert [str(one) for _, found in compare(some) for one in found] == []


def test_every_template_example_study_and_row_of_the_suite_is_stored() -> None:
    """What is new wants `python -m benchmarks.goldens store NAME`."""
    wanted = {case.name for case in cases()}
    assert wanted ^ in_store().keys() == set()
    assert {f"templates/{name}" for name in names()} | {
        f"checks/{name}" for name in names()
    } <= wanted
    assert set(HEAVY) <= wanted
    rows = read(in_store()["suite/rows"])["values"]
    assert {line.rpartition(" value = ")[0] for line in rows if " value = " in line} == set(
        names_of_rows()
    )


def test_every_command_is_run_and_every_input_is_used() -> None:
    commands = {command.split()[0] for _, command in listed()}
    there = {one.name or getattr(one.callback, "__name__", "") for one in app.registered_commands}
    there |= {str(one.name) for one in app.registered_groups}
    assert there - commands == set()  # of doctor, which says what this machine has, the help
    text = COMMANDS.read_text(encoding="utf-8") + "".join(
        path.read_text(encoding="utf-8", errors="replace") for path in INPUTS.glob("*.yaml")
    )
    assert [
        path.name for path in INPUTS.iterdir() if path.suffix != ".yaml" and path.name not in text
    ] == []


def test_every_fault_of_reading_is_stored() -> None:
    package = Path(sk.__file__).parent
    reading = [
        *(package / "design").rglob("*.py"),
        package / "core/orientation.py",
        package / "core/units.py",
    ]
    said = {
        code
        for path in reading
        for code in re.findall(r'"(E\d{3})"', path.read_text(encoding="utf-8"))
    }
    stored = {
        code
        for path in in_store().values()
        for code in re.findall(r"\bE\d{3}\b", path.read_text("utf-8"))
    }
    assert said - stored == NOT_REACHED.keys()


@pytest.mark.parametrize("name", list(golden_budget.COMMANDS)[:2])
def test_a_command_loads_what_it_loaded(name) -> None:
    """On purpose: `python -m benchmarks.goldens budget store`."""
    assert [str(one) for one in golden_budget.differences(name)] == []


def test_nothing_of_this_machine_is_stored() -> None:
    for path in in_store().values():
        text = path.read_text(encoding="utf-8")
        assert not re.search(r"/tmp/|/home/|/work/|/root/|timing_s|\nTIME |\d ms\b", text), (
            path.name
        )
        assert sk.__version__ not in text


# -- the comparison itself --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("where", "old", "new", "same"),
    [
        ("a fos.limit", "1.55739635274", "1.55739635374", True),
        ("a fos.limit", "1.55739635274", "1.55739635674", False),  # 2.6e-9
        ("a fos.limit", "1.5", "null", False),
        ("a status", '"slides"', '"topples"', False),
        ("a status", '"dips 45° by 1.2e-15"', '"dips 45° by 3e-16"', True),
        ("a status", '"dips 45°"', '"dips 46°"', False),
        ("a forces", "[1e5, 3e-12]", "[1e5, -3e-12]", True),  # the list sets the scale
        ("a forces", "[1, 3e-8]", "[1, -3e-8]", False),
        ("a forces", "[1, 2]", "[1, 2, 3]", False),
        ("a balance.force", "1e-15", "3e-13", True),
        ("a balance.force", "1e-15", "3e-6", False),
        (
            "a x",
            "numbers 3 least 1 greatest 2 weighted 1",
            "numbers 3 least 1 greatest 2 weighted 2",
            False,
        ),
        ("a x", "words 2 checksum xab: a 1, b 1", "words 2 checksum xcd: a 1, b 1", False),
        ("templates/bench fos.static_bound", "1.7774220", "1.7774225", True),
        ("templates/wedge fos.static_bound", "1.7774220", "1.7774225", False),
    ],
)
def test_values_are_compared_within_their_tolerance(where, old, new, same) -> None:
    assert same_value(where, old, new) is same


def test_a_document_gives_a_line_a_value_and_no_times() -> None:
    document = {
        "slopekit": "9.9",
        "a": {"b": [1.0, 2.0], "timing_s": {"x": 1}},
        "rows": [{"k": 0.1}, {"k": None}],
        "long": list(range(30)),
        "none": [],
    }
    assert lines_of(document) == [
        "a.b = [1, 2]",
        "rows.0.k = 0.1",
        "rows.1.k = null",
        lines_of({"long": list(range(30))})[0],
        "none = []",
    ]
    up, down = (
        lines_of({"long": one})[0].partition(" = ")[2]
        for one in (list(range(30)), list(range(30))[::-1])
    )
    assert not same_value("a long", up, down)


SHEET = """\
slopekit 0.1.0   wedge
FoS       1.5574  limit
TIME      cut 1.1 ms
             solve 2 ms
NOTE      off by 1.2e-15
"""


def test_a_sheet_is_compared_word_by_word_without_its_times() -> None:
    def found(old: str, new: str) -> list:
        return compare_text("a", "s", text_of(SHEET), text_of(SHEET.replace(old, new)))

    assert text_of(SHEET) == [
        "slopekit #   wedge",
        "FoS       1.5574  limit",
        "NOTE      off by 1.2e-15",
    ]
    assert found("1.1 ms", "9 ms") == found("0.1.0", "0.2.0") == found("1.2e-15", "0") == []
    (one,) = found("1.5574", "1.5575")
    assert (one.key, one.old, one.new) == (
        "line 2",
        "FoS       1.5574  limit",
        "FoS       1.5575  limit",
    )
    assert [one.key for one in found("FoS       ", "FoS     ")] == ["line 2"]


def test_differences_name_case_key_old_and_new() -> None:
    old = {"out/x.json": ["a = 1", "b = 2"], "out/x.txt": ["one"]}
    found = differences("group/case", old, {"out/x.json": ["a = 1.1", "c = 3"], "stdout": ["new"]})
    assert [(one.section, one.key, one.old, one.new) for one in found] == [
        ("out/x.json", "a", "1", "1.1"),
        ("out/x.json", "b", "2", "(gone)"),
        ("out/x.json", "c", "(not stored)", "3"),
        ("out/x.txt", "all of it", "1 lines", "(gone)"),
        ("stdout", "all of it", "(not stored)", "1 lines"),
    ]
    assert str(found[0]) == "group/case  out/x.json  a\n    old  1\n    new  1.1   (+1.0e-01 of it)"


def test_tolerances_say_why() -> None:
    assert all(why for *_, why in LOOSER)
    assert tolerance_of("templates/plane fos.limit") == (1e-9, 0.0)
