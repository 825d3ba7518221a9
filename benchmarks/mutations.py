"""What the tests see when the code is a little wrong: ``python -m benchmarks.mutations``.

Each mutation of `mutation_table` is made in a copy of the sources, and the tests that should see it are run there up
to the first failure. ``--all`` goes on and counts every failing test; words choose groups or names that contain them.
What is run is written to docs/mutations.md; with words, the rows of the others stay as they were run last. The exit
code is 1 where one survives. ``check`` runs no test: it says which lines are no longer in the sources.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.mutation_table import MUTATIONS, Mutation

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "mutations.md"
_COPIED = ("src", "tests", "templates", "examples", "benchmarks", "pyproject.toml", "README.md")
_PYTEST = (
    "-m", "pytest", "-o", "addopts=--strict-markers --doctest-modules --import-mode=importlib", "-q", "--no-header",
    "-p", "no:cacheprovider", "--tb=no", "-rfE",
)  # fmt: skip
_SHOWN = 3  # failing tests that are named
_NONE = "**none**"
_LONGEST = 600  # s; tests that hang have seen it


def stale(mutations: Sequence[Mutation] = MUTATIONS) -> list[str]:
    """What no longer fits the sources: lines that do not occur once, test modules that are not there."""
    found = []
    for mutation in mutations:
        path = ROOT / mutation.file
        times = path.read_text(encoding="utf-8").count(mutation.old) if path.is_file() else 0
        if times != 1:
            found.append(f"{mutation.name}: {mutation.old!r} occurs {times} times in {mutation.file}")
        found += [f"{mutation.name}: {test} is not there" for test in mutation.tests if not (ROOT / test).exists()]
    return found


@dataclass(frozen=True, slots=True)
class Outcome:
    """The tests that failed with a mutation."""

    mutation: Mutation
    failed: tuple[str, ...]

    @property
    def caught(self) -> bool:
        return bool(self.failed)


def copied(folder: Path) -> Path:
    """A copy of all that the tests need."""
    for name in _COPIED:
        source, target = ROOT / name, folder / name
        if source.is_dir():
            shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__", "*.pyc"))
        elif source.exists():
            shutil.copy(source, target)
    return folder


def _python(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Python in the copy; its sources come before an editable installation."""
    variables = os.environ | {"PYTHONPATH": str(folder / "src")}
    return subprocess.run(
        [sys.executable, *words], cwd=folder, env=variables, capture_output=True, text=True, timeout=_LONGEST,
        check=False,
    )  # fmt: skip


def checked(folder: Path) -> None:
    """Refuse to go on where the installed package would be tested instead of the copy."""
    found = _python(folder, "-c", "import slopekit; print(slopekit.__file__)").stdout.strip()
    if not Path(found).resolve().is_relative_to(folder.resolve()):
        sys.exit(f"the tests would import {found}, not the copy")


def _write(path: Path, text: str) -> None:
    """Write a source and forget how it was compiled: a file changed within a second looks the same to Python."""
    path.write_text(text, encoding="utf-8")
    for compiled in (path.parent / "__pycache__").glob(f"{path.stem}.*.pyc"):
        compiled.unlink()


def run(folder: Path, mutation: Mutation, everything: bool) -> Outcome:
    """Break the copy, run the tests, mend it."""
    path = folder / mutation.file
    whole = path.read_text(encoding="utf-8")
    if whole.count(mutation.old) != 1:
        sys.exit(f"{mutation.name}: {mutation.old!r} occurs {whole.count(mutation.old)} times in {mutation.file}")
    _write(path, whole.replace(mutation.old, mutation.new))
    tests = list(dict.fromkeys(mutation.tests))
    try:
        found = _python(folder, *_PYTEST, *([] if everything else ["-x"]), *tests)
    except subprocess.TimeoutExpired:
        return Outcome(mutation, ("(the tests did not end)",))
    finally:
        _write(path, whole)
    lines = found.stdout.splitlines()
    failed = [line.split(" - ")[0].split(" ", 1)[1] for line in lines if line.startswith(("FAILED ", "ERROR "))]
    if not failed and found.returncode not in (0, 1):
        sys.exit(f"{mutation.name}: pytest could not run\n{found.stdout[-2000:]}{found.stderr[-2000:]}")
    return Outcome(mutation, tuple(failed))


def rows_of(text: str) -> dict[tuple[str, str], str]:
    """The rows of a page by group and name."""
    rows: dict[tuple[str, str], str] = {}
    group = ""
    for line in text.splitlines():
        if line.startswith("## "):
            group = line.removeprefix("## ").lower()
        elif line.startswith("| ") and not line.startswith("| what was made wrong |"):
            rows[group, line.split(" | ")[0].removeprefix("| ")] = line
    return rows


def _row(outcome: Outcome, everything: bool) -> str:
    named = "<br>".join(f"`{test.removeprefix('tests/')}`" for test in outcome.failed[:_SHOWN])
    count = f"{len(outcome.failed)}: " if everything and outcome.caught else ""
    file = outcome.mutation.file.removeprefix("src/slopekit/")
    return f"| {outcome.mutation.name} | `{file}` | {count}{named or _NONE} |"


def page(outcomes: Sequence[Outcome], everything: bool, before: str = "") -> str:
    """The outcome as a page.

    Parameters
    ----------
    before : the page so far; its rows stay where nothing was run again and the mutation is still there
    """
    rows = rows_of(before)
    rows |= {(one.mutation.group.lower(), one.mutation.name): _row(one, everything) for one in outcomes}
    there = [one for one in MUTATIONS if (one.group.lower(), one.name) in rows]
    caught = sum(_NONE not in rows[one.group.lower(), one.name] for one in there)
    lines = [
        "# What the tests see when the code is a little wrong", "",
        "`python -m benchmarks.mutations` breaks one line at a time in a copy of the sources, by 1 % or by a term, a "
        f"sign or a bound: {caught} of {len(there)} mutations are caught.",
        "The tests that should see it are run " + (
            "to their end." if everything else "up to the first that fails; `--all` counts every one."
        ) + " Words run some of them: the other rows are those of the run before.", "",
    ]  # fmt: skip
    for group in dict.fromkeys(one.group for one in there):
        lines += [
            f"## {group.capitalize()}",
            "",
            "| what was made wrong | file | tests that fail |",
            "|---|---|---|",
            *(rows[group.lower(), one.name] for one in there if one.group == group),
            "",
        ]
    return "\n".join(lines)


def main(words: list[str]) -> int:
    """Run them; 1 where one survives, or is none."""
    old = stale()
    print(*old, sep="\n", end="\n" if old else "")
    if old or words == ["check"]:
        return 1 if old else 0
    everything = "--all" in words
    chosen = [word.lower() for word in words if word != "--all"]
    wanted = [m for m in MUTATIONS if not chosen or any(word in f"{m.group} {m.name}".lower() for word in chosen)]
    outcomes: list[Outcome] = []
    with tempfile.TemporaryDirectory() as made:
        folder = copied(Path(made))
        checked(folder)
        for mutation in wanted:
            began = time.perf_counter()
            outcome = run(folder, mutation, everything)
            outcomes.append(outcome)
            seen = ", ".join(outcome.failed[:_SHOWN]) if outcome.caught else "SURVIVES"
            took = time.perf_counter() - began
            print(f"{mutation.group}: {mutation.name}: {len(outcome.failed)} ({took:.0f} s) {seen}", flush=True)
    survivors = [outcome.mutation.name for outcome in outcomes if not outcome.caught]
    print(f"{len(outcomes) - len(survivors)} of {len(outcomes)} caught")
    if survivors:
        print("survive: " + "; ".join(survivors))
    before = PAGE.read_text(encoding="utf-8") if chosen and PAGE.exists() else ""
    PAGE.write_text(page(outcomes, everything, before), encoding="utf-8")
    return 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
