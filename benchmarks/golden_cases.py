"""What `benchmarks.goldens` runs: templates, examples, rich designs, the suite, studies, broken files, bad options.

A case is a name (group/name) and commands of slopekit, run in this process in a folder that holds `templates`,
`examples`, `inputs` (tests/goldens/inputs) and `designs` (of `benchmarks.fuzz_seeds`). What it gives are sections: what
was printed, and every file that was written. Commands of studies and broken input stand in tests/goldens/commands.txt;
a template, an example or a broken file that is new is a case without more ado.
"""

import json
import os
import re
import runpy
import shutil
from collections.abc import Callable, Iterator, Mapping
from contextlib import chdir, contextmanager, redirect_stdout
from dataclasses import dataclass
from importlib import import_module
from io import StringIO
from pathlib import Path
from typing import Any

import slopekit as sk
from benchmarks.fuzz_seeds import SEEDS, write_files
from benchmarks.golden_text import Section, lines_of, text_of
from slopekit.design.templates import folder as templates_folder
from slopekit.design.templates import names
from slopekit.studies.suite import suite
from slopekit.studies.suite.references import selected_cases
from tests.commands import slopekit

ROOT = Path(__file__).parents[1]
STORE = ROOT / "tests" / "goldens"
INPUTS = STORE / "inputs"
COMMANDS = STORE / "commands.txt"
EXAMPLES = ROOT / "examples"
#: Cases that take more than five seconds of processor time.
HEAVY = ("checks/bench", "checks/paper-ellipsoid", "suite/rows")
RESULTS = "run {} --quiet --no-pictures -o out"
#: The functions whose results are kept where an example calls them.
RECORDED = (
    "run",
    "wedge",
    "prob",
    "combos",
    "kinematic",
    "check",
    "solve",
    "support",
    "sweep",
    "tornado",
)
#: Rows of the suite: what stands in verification.json already is left out.
ROW = ("value", "status", "closed_form", "limit", "static_bound", "error", "ok", "reason")
_TEXTS = (".txt", ".csv", ".yaml", ".obj", ".md")

Answer = dict[str, Section]


@dataclass(frozen=True)
class Case:
    """A name and what gives its sections, in a folder prepared by `prepare`."""

    name: str
    run: Callable[[Path], Answer]

    @property
    def group(self) -> str:
        """The first part of the name."""
        return self.name.partition("/")[0]


def is_values(section: str) -> bool:
    """Whether the lines of a section are ``key = value``."""
    return section.endswith((".json", "values"))


def prepare(folder: Path) -> None:
    """Put what the cases read into a folder."""
    shutil.copytree(templates_folder(), folder / "templates")
    shutil.copytree(EXAMPLES, folder / "examples", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(INPUTS, folder / "inputs")
    (folder / "designs").mkdir()
    for name in rich_designs():
        (folder / "designs" / f"{name.replace(' ', '-')}.yaml").write_text(
            SEEDS[name], encoding="utf-8"
        )
    for place in ("inputs", "designs"):
        write_files(folder / place)


def rich_designs() -> list[str]:
    """The designs of `benchmarks.fuzz_seeds` that are no templates."""
    return [name for name in SEEDS if name not in names()]


def cases() -> list[Case]:
    """All cases, sorted by name."""
    found: dict[str, list[str]] = {}
    for name in names():
        found[f"templates/{name}"] = [RESULTS.format(f"templates/{name}.yaml")]
        found[f"checks/{name}"] = [f"check templates/{name}.yaml --quiet -o out"]
    for name in rich_designs():
        word = name.replace(" ", "-")
        found[f"designs/{word}"] = [
            f"lint designs/{word}.yaml --json",
            RESULTS.format(f"designs/{word}.yaml"),
        ]
    for path in sorted(INPUTS.glob("*.yaml")):
        found[f"broken/{path.stem}"] = [f"lint inputs/{path.name}"]
    for name, command in listed():
        found.setdefault(name, []).append(command)
    made = [Case(name, _commands(commands)) for name, commands in found.items()]
    made += [Case(f"examples/{path.stem}", _example(path.name)) for path in EXAMPLES.glob("*.py")]
    made.append(Case("suite/rows", _suite))
    return sorted(made, key=lambda case: case.name)


def listed() -> Iterator[tuple[str, str]]:
    """Names and commands of commands.txt."""
    for line in COMMANDS.read_text(encoding="utf-8").splitlines():
        if line.strip() and not line.startswith("#"):
            name, _, command = line.partition(":")
            yield name.strip(), command.strip()


# -- running ----------------------------------------------------------------------------------------------------------


def _commands(commands: list[str]) -> Callable[[Path], Answer]:
    def run(folder: Path) -> Answer:
        answer: Answer = {}
        for k, command in enumerate(commands, start=1):
            number = f" {k}" if len(commands) > 1 else ""
            before = _files(folder)
            with _undrawn() as drawn:
                ran = slopekit(*_words(command), cwd=folder)
            head = [f"$ slopekit {command}", f"exit {ran.returncode}"]
            is_json = ran.stdout.startswith("{")
            said = [] if is_json else text_of(ran.stdout)
            answer[f"command{number}"] = (
                head + said + [f"2> {line}" for line in text_of(ran.stderr)]
            )
            if is_json:
                answer[f"stdout{number} values"] = lines_of(_document(ran.stdout))
            for path in sorted(
                Path(name) for name, stamp in _files(folder).items() if before.get(name) != stamp
            ):
                answer[str(path.relative_to(folder))] = _content(path)
            if drawn:
                answer[f"drawn{number}"] = drawn
        shutil.rmtree(folder / "out", ignore_errors=True)
        return answer

    return run


def _words(command: str) -> list[str]:
    """The words of a command: '...' keeps blanks together, and nothing else is special."""
    return [quoted or plain for quoted, plain in re.findall(r"'([^']*)'|(\S+)", command)]


def _files(folder: Path) -> dict[str, tuple[int, int]]:
    """When each file of a folder was written last, and its size: looked at twice a command."""
    found = {}
    for root, folders, files in os.walk(folder):
        folders[:] = [name for name in folders if name != "__pycache__"]
        for name in files:
            stamp = os.stat(path := f"{root}/{name}")
            found[path] = stamp.st_mtime_ns, stamp.st_size
    return found


def _content(path: Path) -> Section:
    if path.suffix == ".json":
        return lines_of(_document(path.read_text(encoding="utf-8")))
    if path.suffix in _TEXTS:
        return text_of(path.read_text(encoding="utf-8"))
    return ["(not compared)"]


def _document(text: str) -> Any:
    """A document, of a study without its sheet, of a result with the tables of its sheet as they are shown."""
    document = json.loads(text)
    if "study" in document:
        return _without_sheet(document)
    if isinstance(sheet := document.get("sheet"), dict):
        document["sheet"] = {
            label: [entry if isinstance(entry, str) else entry["shown"] for entry in entries]
            for label, entries in sheet.items()
        }
    return document


def _without_sheet(document: dict[str, Any]) -> dict[str, Any]:
    """A document without its sheet, which is compared as text."""
    return {key: value for key, value in document.items() if key not in ("sheet", "line")}


@contextmanager
def _undrawn() -> Iterator[list[str]]:
    """Pictures are named instead of drawn: what they show stands in the JSON."""
    plots = import_module("slopekit.views.plots")
    import_module(
        "slopekit.views.pages.page_pictures"
    )  # takes `draw` by name: loaded later it would keep what stands here
    drawn: list[str] = []
    before = plots.draw

    def named(document: Mapping[str, Any], what: str, path: Path, **_: Any) -> None:
        drawn.append(f"{what}: {path.name}")

    plots.draw = named
    try:
        yield drawn
    finally:
        plots.draw = before


def _example(name: str) -> Callable[[Path], Answer]:
    """What an example prints, and the JSON and sheet of every result it asks for."""

    def run(folder: Path) -> Answer:
        out = StringIO()
        with _recorded() as calls, chdir(folder), redirect_stdout(out):
            runpy.run_path(str(folder / "examples" / name))
        answer = {"printed": [_TIMES.sub("#", line) for line in text_of(out.getvalue())]}
        for k, (call, result) in enumerate(calls, start=1):
            answer[f"{k} {call} values"] = lines_of(_without_sheet(result.to_dict()))
            answer[f"{k} {call} sheet"] = text_of(str(result))
        return answer

    return run


#: Of the first example: the machine that its times, which are in ms, were taken on.
_TIMES = re.compile(r"(?<= on ).*cores, Python .*")


@contextmanager
def _recorded() -> Iterator[list[tuple[str, Any]]]:
    calls: list[tuple[str, Any]] = []
    before = {name: getattr(sk, name) for name in RECORDED}

    def recording(name: str) -> Callable[..., Any]:
        def call(*args: Any, **options: Any) -> Any:
            result = before[name](*args, **options)
            calls.append((name, result))
            return result

        return call

    for name in before:
        setattr(sk, name, recording(name))
    try:
        yield calls
    finally:
        for name, function in before.items():
            setattr(sk, name, function)


def _suite(_: Path) -> Answer:
    """`slopekit check --suite`: its counts and last line, and of every row what slopekit found."""
    verification = suite()
    document = verification.to_dict()
    lines = lines_of({key: document[key] for key in ("counts", "exit_code")})
    for name, row in zip(names_of_rows(), document["rows"], strict=True):
        lines += [f"{name} {line}" for line in lines_of({key: row[key] for key in ROW})]
    return {"printed": text_of(verification.line), "values": lines}


def names_of_rows() -> list[str]:
    """A name for each row of the suite: case, quantity and source."""
    found: list[str] = []
    for case in selected_cases(None):
        for reference in case.references:
            of = "" if reference.of is None else f"@{reference.of:g}"
            name = f"{case.id}: {reference.quantity}{of} ({reference.source})"
            found.append(f"{name} {found.count(name) + 1}" if name in found else name)
    return found


def in_store() -> dict[str, Path]:
    """Names of what is stored, and its files."""
    return {
        str(path.relative_to(STORE).with_suffix("")): path
        for path in STORE.glob("*/*.txt")
        if path.parent != INPUTS
    }
