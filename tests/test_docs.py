"""What the documentation shows is run: every command, its exit code and its output, Python, designs, links.

A page (README.md, docs/*.md, docs/howto/*.md) is run from top to bottom in a folder of its own that holds `templates`
and `examples`, so that a command may use what an earlier one wrote.

- ```sh: one command a line, `\\` goes on; `# exit 1` behind it where it does not end with 0.
- ```text: what the command above prints. A line `...` leaves lines out; TIME entries, milliseconds, rounding errors,
  versions and hashes may differ.
- ```python: executed, the blocks of a page one after the other, in the same folder.
- ```yaml: a whole design, kept as the file that its first line names (`# my.yaml`); or with a template's name behind it
  (```yaml bench) keys that replace those of the template.
- ```json: with `...` left out, part of what the command above prints.
- ```: as sh where it starts with a command, else as text.
"""

import json
import re
import shlex
import shutil
import sys
from collections.abc import Iterator
from contextlib import chdir, nullcontext, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from functools import cache
from io import StringIO
from pathlib import Path
from typing import Any

import pytest

from benchmarks.key_reference import PAGE, written
from slopekit.cli import app, main
from slopekit.core.explanations import explanations
from slopekit.design.fields import record_spec
from slopekit.design.registry import KINDS as KINDS_OF_DESIGN
from slopekit.design.registry import record_of
from slopekit.design.templates import names, path_of
from tests.support import forget_kinds, study_of_the_page

ROOT = Path(__file__).parents[1]
GENERATED = (
    "verification.md",
    "hard-cases.md",
    "speed.md",
    "mutations.md",
    "studies.md",
    "messages.md",
    "gallery.md",
)
WRITTEN = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
PAGES = [path for path in WRITTEN if path.name not in GENERATED]
#: Lines of sh blocks that are not run: what installs, fetches, tests and measures.
NOT_RUN = (
    "git clone",
    "cd ",
    "pip install",
    "python -m pip",
    "python -m venv",
    ". ",
    "python -m pytest",
    "python -m benchmarks",
    "python examples/",
    "dask ",
    "slopekit check --suite",
    "slopekit app",
)
#: Commands that are run with less work than they are shown with, and not compared; "": run by a test of its own.
LESS = {
    "slopekit prob templates/wedge-scatter.yaml -n 20000": "-n 100",
    "slopekit run my-cut.yaml -o my-cut": "--no-pictures",  # tests/views draws them
    "slopekit report my-cut/result.json -o cut.html": "--no-pictures",
    "slopekit check my-cut.yaml -o checked": "",  # the how-to of check runs one
    "slopekit support templates/wedge.yaml --fos 1.8": "--acts passive --toward 000/10",
    "slopekit run templates/bench.yaml": "",  # tests/test_templates.py, which runs doctor too
    "slopekit doctor": "",
}
KINDS = ("sh", "console", "text", "python", "yaml", "json", "")


@dataclass(frozen=True)
class Block:
    """A fenced block: the line it starts at, the words behind its fence, its lines."""

    line: int
    info: str
    lines: tuple[str, ...]

    @property
    def kind(self) -> str:
        """The language; of a block without one what it holds."""
        kind, first = self.info.partition(" ")[0], self.lines[0] if self.lines else ""
        if not kind:
            return (
                "sh" if re.match(r"slopekit [a-z]", first) or first.startswith(NOT_RUN) else "text"
            )
        return "sh" if kind == "console" else kind


def blocks_of(text: str) -> Iterator[Block]:
    """The fenced blocks of a page, in its order."""
    lines: list[str] | None = None
    start, info = 0, ""
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("```"):
            if lines is None:
                lines, start, info = [], number, line[3:].strip()
            else:
                yield Block(start, info, tuple(lines))
                lines = None
        elif lines is not None:
            lines.append(line)
    assert lines is None, f"the block of line {start} has no end"


def commands_of(block: Block) -> list[tuple[str, int]]:
    """The commands of a block with the exit code each says."""
    found = []
    for line in re.sub(r"\\\n\s*", "", "\n".join(block.lines)).splitlines():
        if line.strip() and not line.startswith("#"):
            code = re.search(r"#.*\bexit (\d)\b", line)
            command = re.sub(r"\s+#.*", "", line.removeprefix("$ ")).strip()
            found += [(part.strip(), int(code[1]) if code else 0) for part in command.split("&&")]
    return found


def called(arguments: list[str]) -> tuple[int, str]:
    """A slopekit command in this process: exit code, and what it prints on both streams."""
    out, before = StringIO(), sys.argv
    try:
        sys.argv = ["slopekit", *arguments]
        with redirect_stdout(out), redirect_stderr(out):
            main()
    except SystemExit as end:
        return int(end.code or 0), out.getvalue()
    finally:
        sys.argv = before
    raise AssertionError("the command did not end")


@cache
def _elsewhere(command: str) -> tuple[int, str]:
    return called(shlex.split(command)[1:])


def run_command(command: str) -> tuple[int, str]:
    """Run a command, once for all pages where it reads nothing but templates and examples and writes nothing."""
    arguments = shlex.split(command)[1:]
    files = [part for part in arguments if part.endswith((".yaml", ".csv", ".json", ".html"))]
    writes = {"-o", "--picture", "new", "plot", "report", "export"} & set(arguments)
    if writes or any(not part.startswith(("templates/", "examples/")) for part in files):
        return called(arguments)
    return _elsewhere(command)


_VARIES = (
    (re.compile(r"\bsha [0-9a-f]{6}"), "sha ······"),
    (re.compile(r"^slopekit \d+\.\d+\.\d+\S*"), "slopekit"),
    (re.compile(r"\d[\d.,]* (?:ms|s|pairs/s)\b"), "· s"),
    (re.compile(r"\b(?:\d(?:\.\d+)?e-1\d|0\.0e\+00)\b"), "rounding"),
)


def normal(text: str) -> list[str]:
    """The lines of an output without what differs from run to run."""
    lines: list[str] = []
    in_time = False
    for line in text.rstrip().splitlines():
        in_time = line.startswith("TIME") or (in_time and line.startswith(" "))
        if not in_time:
            for pattern, instead in _VARIES:
                line = pattern.sub(instead, line)
            lines.append(line.rstrip())
    return lines


def difference(shown: str, true: str) -> str:
    """What a block shows and the program does not print; empty where all is right. `...` stands for lines left out."""
    found, at = normal(true), 0
    parts: list[list[str]] = [[]]
    for line in normal(shown):
        if line.strip() == "...":
            parts.append([])
        else:
            parts[-1].append(line)
    for k, part in enumerate(parts):
        if not part:
            continue
        first = range(at, at + 1) if k == 0 else range(at, len(found) - len(part) + 1)
        if k == len(parts) - 1:
            first = [len(found) - len(part)] if len(found) - len(part) in first else []
        place = next((start for start in first if found[start : start + len(part)] == part), None)
        if place is None:
            near = next((line for line in part if line not in found), part[0])
            return f"the program does not print: {near}"
        at = place + len(part)
    return (
        ""
        if (len(parts) > 1 and not parts[-1]) or at == len(found)
        else f"left out without ...: {found[at]}"
    )


class Page:
    """One page as it is run: what its last command printed, the names its Python has made, what is wrong."""

    def __init__(self, path: Path) -> None:
        self.path, self.faults, self.commands = path, [], 0
        self.output: str | None = None
        self.names: dict[str, Any] = {}

    def run(self) -> None:
        for block in blocks_of(self.path.read_text(encoding="utf-8")):
            if block.kind.startswith("{"):  # a directive of the site
                continue
            fault = getattr(self, f"_{block.kind}", self._unknown)(block)
            self.faults += [f"{self.path.name}:{block.line}: {one}" for one in fault]

    def _unknown(self, block: Block) -> Iterator[str]:
        yield f"a block of {block.info} is not tested; known: {', '.join(KINDS)}"

    def _sh(self, block: Block) -> Iterator[str]:
        for command, wanted in commands_of(block):
            if command.startswith(NOT_RUN):
                continue
            self.output = None
            if not command.startswith("slopekit "):
                yield f"not a command of slopekit: {command}"
                continue
            self.commands += 1
            shorter = command in LESS
            if shorter and not LESS[command]:
                continue
            words = shlex.split(LESS.get(command, ""))
            run = re.sub(r" -n \d+", "", command) + " " + shlex.join(words) if shorter else command
            code, printed = run_command(run)
            self.output = None if shorter else printed
            if code != wanted and not (
                self.path.name == "README.md" and code == 1
            ):  # the README is short
                yield f"{command} ends with {code}, not {wanted}: {printed[-300:]}"

    def _text(self, block: Block) -> Iterator[str]:
        if self.output is None:
            yield "output of no command"
        elif wrong := difference("\n".join(block.lines), self.output):
            yield wrong

    _json = _text

    def _python(self, block: Block) -> Iterator[str]:
        out = StringIO()
        code = "\n" * block.line + "\n".join(block.lines)
        try:
            with redirect_stdout(out):
                exec(compile(code, str(self.path), "exec"), self.names)
        except Exception as error:
            yield f"{type(error).__name__}: {error}"
        self.output = out.getvalue()

    def _yaml(self, block: Block) -> Iterator[str]:
        text = "\n".join(block.lines) + "\n"
        template = block.info.partition(" ")[2].strip()
        if template:
            keys = re.findall(r"^(\w+):", text, re.MULTILINE)
            text = without(path_of(template).read_text(encoding="utf-8"), keys) + text
        named = re.match(r"# (\S+\.yaml)\n", text)
        path = Path(named[1] if named else "of-the-page.yaml")
        path.write_text(text, encoding="utf-8")
        code, printed = called(["lint", str(path)])
        if code:
            yield f"not a design: {printed}"


def without(design: str, keys: list[str]) -> str:
    """A design without some of its keys of the first level."""
    kept = []
    is_kept = True
    for line in design.splitlines(keepends=True):
        if re.match(r"\w", line):
            is_kept = line.partition(":")[0] not in keys
        if is_kept:
            kept.append(line)
    return "".join(kept)


@pytest.mark.slow
@pytest.mark.parametrize("path", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_page(path, tmp_path, monkeypatch) -> None:
    monkeypatch.delenv("SLOPEKIT_DEBUG", raising=False)
    for folder in ("templates", "examples"):
        shutil.copytree(ROOT / folder, tmp_path / folder)
    page = Page(path)
    added = (
        study_of_the_page(tmp_path / "found") if path.name == "add-a-study.md" else nullcontext()
    )
    with chdir(tmp_path), added:
        page.run()
    forget_kinds()
    assert not page.faults, "\n".join(page.faults)


def test_links_lead_somewhere() -> None:
    """Files, and headings within them, by GitHub's way to name them."""

    def anchors(path: Path) -> set[str]:
        text = re.sub(
            r"^```.*?^```", "", path.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL
        )
        heads = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
        return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}

    wrong = []
    for page in WRITTEN:
        text = re.sub(
            r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL
        )
        for link in re.findall(r"\]\(([^)\s]+)\)", text):
            if link.startswith(("https://", "http://", "mailto:")):
                continue
            name, _, anchor = link.partition("#")
            target = (page.parent / name).resolve() if name else page
            if not target.exists() or (anchor and anchor not in anchors(target)):
                wrong.append(f"{page.relative_to(ROOT)}: {link}")
    assert not wrong, "\n".join(wrong)


def commands_by_name() -> dict[str, Any]:
    import typer

    group: Any = typer.main.get_command(app)
    return {
        name: group.get_command(None, name) for name in group.list_commands(None)
    }  # some are made when asked for


def test_every_command_has_its_page_and_every_page_its_command() -> None:
    pages = {path.stem for path in (ROOT / "docs/howto").glob("*.md")}
    assert pages == set(commands_by_name())


def test_every_option_is_named_on_its_page() -> None:
    """--help, which every command has, is left out."""
    missing = []
    for name, command in commands_by_name().items():
        page = (ROOT / f"docs/howto/{name}.md").read_text(encoding="utf-8")
        every = [command, *getattr(command, "commands", {}).values()]
        for parameter in (parameter for one in every for parameter in one.params):
            long = max(parameter.opts, key=len)
            if (
                long.startswith("-")
                and long != "--help"
                and not re.search(rf"{long}(?![\w-])", page)
            ):
                missing.append(f"{name} {long}")
    assert not missing, missing


def test_every_template_stands_in_the_docs() -> None:
    page = (ROOT / "docs/howto/templates.md").read_text(encoding="utf-8")
    assert [name for name in names() if not re.search(rf"\b{name}\b", page)] == []


def _keys_of(spec: Any) -> Iterator[str]:
    for key, below in (spec.keys or {}).items():
        yield key
        yield from _keys_of(below)
    for below in (spec.names, spec.items):
        yield from () if below is None else _keys_of(below)


def test_every_key_of_a_design_stands_on_its_page() -> None:
    page = (ROOT / "docs/design-files.md").read_text(encoding="utf-8")
    sections = dict(re.findall(r"^## (\w+)\n(.*?)(?=^## |\Z)", page, re.MULTILINE | re.DOTALL))
    shared = page.partition("\n## wedge\n")[0]
    missing = [
        f"{kind}: {key}"
        for kind in KINDS_OF_DESIGN
        for key in _keys_of(record_spec(record_of(kind)))
        if not re.search(
            rf"[`.{{ ]{key}\b", shared + sections[kind] + sections["Distributions"] + page[-4000:]
        )
    ]
    assert missing == []


def test_the_key_tables_are_those_of_the_declared_fields() -> None:
    """`python -m benchmarks.key_reference` writes them."""
    page = PAGE.read_text(encoding="utf-8")
    assert written(page) == page


def test_defaults_of_a_kind_are_not_told_of_their_namesakes() -> None:
    """A wedge takes 50 kPa and 20° for c and φ, and for no partial factor of c nor the φ of Clough & Duncan's law."""
    page = PAGE.read_text(encoding="utf-8")
    wedge = page.partition("<!-- keys of wedge -->")[2].partition("<!-- end of keys -->")[0]
    told = dict(
        re.findall(r"^\| `([\w.]+\.(?:c|phi))` \|[^|]*\| ([^|]*) \|", wedge, flags=re.MULTILINE)
    )
    assert told == {"strength.NAME.c": "50", "strength.NAME.phi": "20"}


#: Groups of a document whose keys are names of the design, of outcomes, stages or changes, shares, or a design's own.
_NAMED = {
    "areas_m2",
    "trace_lengths_m",
    "corners_m",
    "normal",
    "water",
    "methods",
    "inputs",
    "assumed",
    "timing_s",
    "pairs_by_mode",
    "sheet",
    "outcomes",
    "counts",
    "quantiles",
    "support",
}


def _keys_in(value: Any, group: str = "") -> Iterator[str]:
    if isinstance(value, dict) and group not in _NAMED and "zlib_base64" not in value:
        for key, below in value.items():
            yield key
            yield from _keys_in(below, key)
    for one in value if isinstance(value, list) else ():
        yield from _keys_in(one, group)


@pytest.mark.parametrize(
    "command",
    [
        *(
            f"run templates/{name}.yaml"
            for name in ("paper-wedge", "paper-footing", "paper-ellipsoid", "goodman-bray")
        ),
        "run templates/plane.yaml",
        "run templates/bench.yaml",
        "run templates/blocks.yaml",
        "prob templates/wedge-scatter.yaml -n 100 --fos 1.1",
        "sweep templates/wedge-basal.yaml slope.height=10:30:3",
        "sweep templates/wedge.yaml strength.weak.phi=10:30:3",
        "sweep templates/wedge.yaml --tornado",
        "solve templates/wedge.yaml strength.weak.phi --fos 1.3",
        "support templates/plane.yaml --fos 1.6",
    ],
)
def test_every_key_of_a_document_stands_on_its_page(command) -> None:
    page = (ROOT / "docs/json.md").read_text(encoding="utf-8")
    with chdir(ROOT):
        document = json.loads(run_command(f"slopekit {command} --json")[1])
    assert sorted({key for key in _keys_in(document) if not re.search(rf"[`.]{key}`", page)}) == []


def test_every_key_of_a_study_stands_on_its_page() -> None:
    """Keys of the first level of what the goldens hold of every study, in the row of its file or of all studies."""
    page = (ROOT / "docs/json.md").read_text(encoding="utf-8")
    studies = page.partition("## Studies")[2]
    shared = studies.partition("| file |")[0]
    missing, seen = set(), set()
    for path in sorted((ROOT / "tests/goldens/studies").glob("*.txt")):
        for part in re.split(r"^=== ", path.read_text(encoding="utf-8"), flags=re.MULTILINE):
            file, _, lines = part.partition("\n")
            keys = set(re.findall(r"^(\w+)(?:\.[^=\n]*)? = ", lines, re.MULTILINE))
            if file.endswith(".json") and "study" in keys:
                rows = re.findall(rf"^\| `{file.removeprefix('out/')}`.*$", studies, re.MULTILINE)
                seen.add(file)
                missing |= {(file, key) for key in keys if f"`{key}`" not in shared + "".join(rows)}
    assert len(seen) >= 8
    assert sorted(missing) == []


def test_files_that_add_a_kind_names_exist() -> None:
    text = (ROOT / "docs/add-a-kind.md").read_text(encoding="utf-8")
    named = [name for name in re.findall(r"`([\w/.-]+\.py)`", text) if "KIND" not in name]
    folders = (ROOT, ROOT / "src/slopekit", ROOT / "src/slopekit/design", ROOT / "tests")
    assert len(named) > 5
    assert [
        name for name in named if not any((folder / name).is_file() for folder in folders)
    ] == []


def test_the_page_of_messages_is_up_to_date() -> None:
    code, page = called(["explain", "--all"])
    assert code == 0
    assert page == (ROOT / "docs/messages.md").read_text(encoding="utf-8"), (
        "slopekit explain --all > docs/messages.md"
    )
    assert set(re.findall(r"^### (\w+)$", page, re.MULTILINE)) == set(explanations())


@pytest.mark.parametrize("arguments", [[], ["E203", "--all"]])
def test_explain_takes_codes_or_all(arguments) -> None:
    code, said = called(["explain", *arguments])
    assert code == 2
    assert said.startswith("E100 explain takes codes or --all\n")


def test_explain_takes_several_codes() -> None:
    """Each once, in their order."""
    code, said = called(["explain", "W307", "e203", "w307"])
    assert (code, [line for line in said.splitlines() if re.fullmatch(r"[EW]\d{3}", line)]) == (
        0,
        ["W307", "E203"],
    )


def test_codes_that_pages_name_exist() -> None:
    for path in PAGES:
        codes = set(re.findall(r"\b[EW][1-5]\d\d\b", path.read_text(encoding="utf-8")))
        assert codes <= set(explanations()) | {"E599"}, path


def test_no_page_names_a_place_on_somebodys_machine() -> None:
    for path in WRITTEN:
        found = re.search(
            r"(?<![\w.])(/home/|/work/|/tmp/|/root/|C:\\)", path.read_text(encoding="utf-8")
        )
        assert found is None, f"{path.name}: {found}"


def test_the_index_names_every_page() -> None:
    text = (ROOT / "docs/index.md").read_text(encoding="utf-8")
    pages = {str(path.relative_to(ROOT / "docs")) for path in (ROOT / "docs").rglob("*.md")} - {
        "index.md"
    }
    assert {page for page in pages if f"]({page})" not in text} == set()


def test_what_is_shown_wrongly_is_found(tmp_path) -> None:
    """The checker itself: a page with one fault of each sort."""
    page = tmp_path / "page.md"
    page.write_text(
        "```sh\nslopekit wedge --dips 45/115 45/245 --quiet\n```\n"
        "```text\nslides_on_both  1.5575  agree\n```\n"
        "```sh\nslopekit wedge --dips 45/115 45/245 --quiet  # exit 1\n```\n"
        "```sh\nslopekit wedge --dips 45/115 45/245 --nonsense\n```\n"
        "```python\nassert False\n```\n"
        "```yaml wedge\njoints: {J1: {plane: 95/115}, J2: {plane: 45/245}}\n```\n"
        "```bash\nls\n```\n"
    )
    with chdir(tmp_path):
        found = Page(page)
        found.run()
    assert [fault.split(": ")[0] for fault in found.faults] == [
        f"page.md:{line}" for line in (4, 7, 10, 13, 16, 19)
    ]


@pytest.mark.parametrize(
    ("shown", "is_right"),
    [
        ("a\nb\nc", True),
        ("a\n...\nc", True),
        ("...\nc", True),
        ("a\n...", True),
        ("a\nb", False),
        ("b\nc", False),
        ("a\n...\nd", False),
        ("a\nc\n...", False),
        ("...\nb", False),
    ],
)
def test_lines_are_left_out_with_three_dots_only(shown, is_right) -> None:
    assert (difference(shown, "a\nb\nc\n") == "") is is_right
