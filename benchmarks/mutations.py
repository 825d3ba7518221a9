"""What the tests see when the code is a little wrong: ``python -m benchmarks.mutations``.

Each mutation of `mutation_table` is made in a copy of the sources, and the tests that should see it are run there up
to the first failure. ``--all`` goes on and counts every failing test; words choose groups or names that contain them.
What is run is written to docs/mutations.json, the page docs/mutations.md from it; with words, the others stay as they
were run last. The exit code is 1 where one survives. ``check`` runs no test: it says which lines are no longer in the
sources.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.mutation_table import MUTATIONS, Mutation

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "mutations.md"
RECORD = PAGE.with_suffix(".json")
_COPIED = ("src", "tests", "templates", "examples", "benchmarks", "pyproject.toml", "README.md")
_PYTEST = (
    "-m",
    "pytest",
    "-o",
    "addopts=--strict-markers --doctest-modules --import-mode=importlib",
    "-q",
    "--no-header",
    "-p",
    "no:cacheprovider",
    "--tb=no",
    "-rfE",
)
_SHOWN = 3  # failing tests that are named
Row = dict[str, Any]  # of the record: group, name, file, failed tests
_LONGEST = 600  # s; tests that hang have seen it


def stale(mutations: Sequence[Mutation] = MUTATIONS) -> list[str]:
    """What no longer fits the sources: lines that do not occur once, test modules that are not there."""
    found = []
    for mutation in mutations:
        path = ROOT / mutation.file
        times = path.read_text(encoding="utf-8").count(mutation.old) if path.is_file() else 0
        if times != 1:
            found.append(
                f"{mutation.name}: {mutation.old!r} occurs {times} times in {mutation.file}"
            )
        found += [
            f"{mutation.name}: {test} is not there"
            for test in mutation.tests
            if not (ROOT / test).exists()
        ]
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
        [sys.executable, *words],
        cwd=folder,
        env=variables,
        capture_output=True,
        text=True,
        timeout=_LONGEST,
        check=False,
    )


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
        sys.exit(
            f"{mutation.name}: {mutation.old!r} occurs {whole.count(mutation.old)} times in {mutation.file}"
        )
    _write(path, whole.replace(mutation.old, mutation.new))
    tests = list(dict.fromkeys(mutation.tests))
    try:
        found = _python(folder, *_PYTEST, *([] if everything else ["-x"]), *tests)
    except subprocess.TimeoutExpired:
        return Outcome(mutation, ("(the tests did not end)",))
    finally:
        _write(path, whole)
    lines = found.stdout.splitlines()
    failed = [
        line.split(" - ")[0].split(" ", 1)[1]
        for line in lines
        if line.startswith(("FAILED ", "ERROR "))
    ]
    if not failed and found.returncode not in (0, 1):
        sys.exit(
            f"{mutation.name}: pytest could not run\n{found.stdout[-2000:]}{found.stderr[-2000:]}"
        )
    return Outcome(mutation, tuple(failed))


def recorded(outcomes: Sequence[Outcome], before: Sequence[Row] = ()) -> list[Row]:
    """Every mutation that was ever run and is still there, with the tests that failed: the newest outcome of each.

    Parameters
    ----------
    before : the record so far; its rows stay where nothing was run again
    """
    rows = {(row["group"], row["name"]): row for row in before}
    for outcome in outcomes:
        one = outcome.mutation
        failed = [test.removeprefix("tests/") for test in outcome.failed]
        file = one.file.removeprefix("src/slopekit/")
        rows[one.group, one.name] = {
            "group": one.group,
            "name": one.name,
            "file": file,
            "failed": failed,
        }
    return [rows[one.group, one.name] for one in MUTATIONS if (one.group, one.name) in rows]


def page(rows: Sequence[Row]) -> str:
    """The page of a record."""
    caught = sum(bool(row["failed"]) for row in rows)
    lines = [
        "# What the tests see when the code is a little wrong",
        "",
        "`python -m benchmarks.mutations` breaks one line at a time in a copy of the sources, by 1 % or by a term, a "
        f"sign or a bound, and runs the tests that should see it: {caught} of {len(rows)} mutations are caught. The "
        "file of each and the test that failed are in [mutations.json](mutations.json). What has no line here was "
        "not tried.",
        "",
        "| part | lines | what was made wrong |",
        "|---|---|---|",
    ]
    for group in dict.fromkeys(row["group"] for row in rows):
        members = [row for row in rows if row["group"] == group]
        names = "; ".join(
            row["name"] if row["failed"] else f"**{row['name']}: not caught**" for row in members
        )
        lines.append(f"| {group} | {len(members)} | {names} |")
    return "\n".join([*lines, ""])


def write(rows: Sequence[Row]) -> None:
    """Write the record and its page."""
    RECORD.write_text(json.dumps(rows, ensure_ascii=False, indent=1) + "\n", encoding="utf-8")
    PAGE.write_text(page(rows), encoding="utf-8")


def main(words: list[str]) -> int:
    """Run them; 1 where one survives, or is none."""
    old = stale()
    print(*old, sep="\n", end="\n" if old else "")
    if old or words == ["check"]:
        return 1 if old else 0
    everything = "--all" in words
    chosen = [word.lower() for word in words if word != "--all"]
    wanted = [
        m
        for m in MUTATIONS
        if not chosen or any(word in f"{m.group} {m.name}".lower() for word in chosen)
    ]
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
            print(
                f"{mutation.group}: {mutation.name}: {len(outcome.failed)} ({took:.0f} s) {seen}",
                flush=True,
            )
    survivors = [outcome.mutation.name for outcome in outcomes if not outcome.caught]
    print(f"{len(outcomes) - len(survivors)} of {len(outcomes)} caught")
    if survivors:
        print("survive: " + "; ".join(survivors))
    before = json.loads(RECORD.read_text(encoding="utf-8")) if chosen and RECORD.exists() else []
    write(recorded(outcomes, before))
    return 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
