"""The site of docs/, without building it: what it is made of, and what it leads to.

`python -m sphinx -W --keep-going -E -b html docs OUT` builds it (extra: docs) and fails at the first warning.
"""

import inspect
import re
import runpy
import shlex
import tomllib
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

import slopekit as sk
from benchmarks import gallery
from slopekit.views.plots import EVERY
from tests.test_docs import commands_by_name

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
CONF = runpy.run_path(str(DOCS / "conf.py"))
PAGES = sorted(str(path.relative_to(DOCS)) for path in DOCS.rglob("*.md"))
NAMES = sorted(set(sk.__all__) - {"__version__"})
FUNCTIONS = [name for name in NAMES if not isinstance(getattr(sk, name), type)]
#: Of a signature what only the command line knows.
HIDDEN = {"desk", "unknown"}


def _section(docstring: str, name: str) -> str:
    """What a section of a docstring in numpydoc's form says."""
    found = re.search(
        rf"^{name}\n-+\n(.*?)(?=^\w[\w ]*\n-+\n|\Z)", docstring, re.MULTILINE | re.DOTALL
    )
    return found[1] if found else ""


def _links(text: str) -> list[str]:
    text = re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)
    return [
        link
        for link in re.findall(r"\]\(([^)\s]+)\)", text)
        if not re.match(r"https?:|mailto:", link)
    ]


# -- what Python offers ------------------------------------------------------------------------------------------------


def test_every_public_name_stands_in_the_reference() -> None:
    page = (DOCS / "api.md").read_text(encoding="utf-8")
    shown = re.findall(
        r"^\.\. auto(?:function|class|exception|data):: (?:slopekit\.)?(\w+)$", page, re.MULTILINE
    )
    assert [name for name in shown if shown.count(name) > 1] == []
    assert set(sk.__all__) - set(shown) == set()
    assert [name for name in shown if not hasattr(sk, name)] == []
    from slopekit import _LAZY_EXPORTS

    assert set(_LAZY_EXPORTS) - set(shown) == set()


@pytest.mark.parametrize("name", NAMES)
def test_every_public_docstring_has_an_example_that_runs(name) -> None:
    said = inspect.getdoc(getattr(sk, name)) or ""
    assert ">>> " in _section(said, "Examples")
    assert said.partition("\n")[0].endswith(".")
    order = ["Parameters", "Attributes", "Returns", "Raises", "Notes", "References", "Examples"]
    heads = re.findall(r"^(\w+)\n-+$", said, re.MULTILINE)
    assert heads == [head for head in order if head in heads]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_function_says_what_it_takes_and_what_it_refuses(name) -> None:
    function = getattr(sk, name)
    said = inspect.getdoc(function) or ""
    rows = CONF["as_numpydoc"](
        ["Parameters", "----------", *_section(said, "Parameters").splitlines()]
    )[2:]
    told = {one for row in rows if re.match(r"\w", row) for one in row.split(", ")}
    # some are said under Notes
    told |= set(re.findall(r"`(\w+)`", _section(said, "Notes")))
    taken = set(inspect.signature(function).parameters) - HIDDEN
    assert taken - told == set()
    assert re.search(r"\b[EW]\d{3}\b|With every fault|GeometryError", _section(said, "Raises"))


def test_the_signature_on_the_site_is_without_what_the_command_line_adds() -> None:
    shown, _ = CONF["_signature"](None, "function", "", sk.sets, None, "", None)
    assert shown.startswith("(joints, *, ")
    assert "desk" not in shown
    assert "Annotated" not in shown


@pytest.mark.parametrize(
    ("line", "shown"),
    [
        ("c : Cohesion, kPa.", ["c", "    Cohesion, kPa."]),
        ("low, high : limits; at : where", ["low, high", "    limits", "at", "    where"]),
        ("seismic : K or K@TREND.", ["seismic", "    K or K\\@TREND."]),
        ("plain words", ["plain words"]),
    ],
)
def test_parameters_on_one_line_are_read_as_numpydoc(line, shown) -> None:
    head = ["Parameters", "----------"]
    assert CONF["as_numpydoc"]([*head, line]) == [*head, *shown]
    assert CONF["as_numpydoc"](["Notes", "-----", line]) == ["Notes", "-----", line]


# -- pages -------------------------------------------------------------------------------------------------------------


def _contents() -> str:
    return CONF["contents"]((DOCS / "index.md").read_text(encoding="utf-8"))


def test_every_page_stands_in_the_contents_once() -> None:
    trees = re.findall(r"^```\{toctree\}\n(.*?)^```", _contents(), re.MULTILINE | re.DOTALL)
    listed = [
        line for tree in trees for line in tree.splitlines() if line and not line.startswith(":")
    ]
    assert sorted(f"{name}.md" for name in listed) == [page for page in PAGES if page != "index.md"]


def test_parts_of_the_contents_are_called_as_in_the_index() -> None:
    heads = re.findall(r"^## (.*)$", (DOCS / "index.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert re.findall(r"^:caption: (.*)$", _contents(), re.MULTILINE) == [
        head for head in heads if head
    ]


@pytest.mark.parametrize("page", PAGES)
def test_links_stay_on_the_site(page) -> None:
    """A link to a file that the site does not hold would be dead there; `tests/test_docs.py` follows the others."""
    text = CONF["on_the_site"]((DOCS / page).read_text(encoding="utf-8"))
    for link in _links(text):
        target = (
            (DOCS / page).parent / link.partition("#")[0]
            if not link.startswith("#")
            else DOCS / page
        )
        assert target.resolve().is_relative_to(DOCS), link
        assert target.exists(), link


@pytest.mark.parametrize("page", PAGES)
def test_a_page_begins_with_its_title(page) -> None:
    """The sidebar takes it from there."""
    text = (DOCS / page).read_text(encoding="utf-8")
    heads = re.findall(
        r"^(#+) ", re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL), re.MULTILINE
    )
    assert text.startswith("# ")
    assert heads.count("#") == 1
    assert all(len(one) <= len(before) + 1 for before, one in pairwise(heads))


def test_every_picture_of_the_docs_is_shown() -> None:
    shown = {link for page in PAGES for link in _links((DOCS / page).read_text(encoding="utf-8"))}
    shown |= set(_links((ROOT / "README.md").read_text(encoding="utf-8")))
    names = {Path(link).name for link in shown}
    assert (
        sorted(path.name for path in (DOCS / "images").rglob("*.png") if path.name not in names)
        == []
    )


def test_the_gallery_has_every_picture_as_its_commands_make_it() -> None:
    """`python -m benchmarks.gallery` draws them and writes the page."""
    assert (DOCS / "gallery.md").read_text(encoding="utf-8") == gallery.page()
    pictures = [one for _, part in gallery.PARTS for one in part]
    assert {one.what for one in pictures} == set(EVERY)
    assert sorted(one.name for one in pictures) == sorted(
        path.stem for path in gallery.IMAGES.glob("*.png")
    )
    assert max(path.stat().st_size for path in gallery.IMAGES.glob("*.png")) < 130_000


def test_the_commands_of_the_gallery_have_the_options_that_they_use() -> None:
    commands = commands_by_name()
    for command in {
        command for _, part in gallery.PARTS for one in part for command in one.commands
    }:
        _, name, *words = shlex.split(command)
        known = {option for one in commands[name].params for option in one.opts}
        given = {word for word in words if re.match(r"--?[a-z]", word)}
        assert given - known == set(), command


def test_what_the_site_is_built_with_is_an_extra() -> None:
    extras: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))[
        "project"
    ]
    given = {re.split(r"[<>=]", one)[0] for one in extras["optional-dependencies"]["docs"]}
    assert given == {"sphinx", "docutils", "myst-parser", "furo"}
    assert CONF["html_theme"] in given
    assert {one.partition(".")[0] for one in CONF["extensions"]} <= {"sphinx", "myst_parser"}
