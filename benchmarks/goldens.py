"""What slopekit says today, stored and compared: the guard of changes that must change nothing.

``python -m benchmarks.goldens compare [WORD ...]`` runs the cases whose names hold one of the words (without one all of
them, two minutes of processor time, half of it `benchmarks.golden_cases.HEAVY`) and names case, key, old and
new value of every difference; it ends with 1 if there is one. ``store`` writes them to tests/goldens (a value that is
the same within its tolerance keeps its old text), ``list`` names them, ``budget`` prints modules, lines and cold times
(`benchmarks.golden_budget`); the word ``all`` shows every difference.

What changes on purpose is stored again in the commit that changes it and stands in CHANGELOG.md.
"""

import os
import sys
import tempfile
import time
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path

from benchmarks import golden_budget
from benchmarks.golden_cases import STORE, Answer, Case, cases, in_store, is_values, prepare
from benchmarks.golden_text import Difference, compare_text, compare_values, kept

MOST_SHOWN = 12
_MARK = "=== "
#: Processor time of the cases of this run.
SECONDS: dict[str, float] = {}


def chosen(words: Sequence[str]) -> list[Case]:
    """The cases whose names hold one of the words; all without words."""
    return [case for case in cases() if not words or any(word in case.name for word in words)]


def answers(some: Sequence[Case]) -> Iterator[tuple[Case, Answer]]:
    """What the cases give now, one after the other."""
    with tempfile.TemporaryDirectory() as name, warnings.catch_warnings():
        warnings.simplefilter("error")
        prepare(Path(name))
        for case in some:
            began = time.process_time()
            answer = case.run(Path(name))
            SECONDS[case.name] = time.process_time() - began
            yield case, answer


def read(path: Path) -> Answer:
    """The sections of a stored case."""
    found: Answer = {}
    lines: list[str] = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith(_MARK):
            lines = found.setdefault(line.removeprefix(_MARK), [])
        else:
            lines.append(line)
    return found


def differences(name: str, old: Answer, new: Answer) -> list[Difference]:
    """How what a case gives differs from what is stored."""
    found = []
    for section in [*old, *(section for section in new if section not in old)]:
        if section not in new:
            found.append(
                Difference(name, section, "all of it", f"{len(old[section])} lines", "(gone)")
            )
        elif section not in old:
            found.append(
                Difference(name, section, "all of it", "(not stored)", f"{len(new[section])} lines")
            )
        else:
            compare = compare_values if is_values(section) else compare_text
            found += compare(name, section, old[section], new[section])
    return found


def compare(some: Sequence[Case]) -> Iterator[tuple[str, list[Difference]]]:
    """Case by case what differs from the store."""
    stored = in_store()
    for case, answer in answers(some):
        if case.name in stored:
            yield case.name, differences(case.name, read(stored[case.name]), answer)
        else:
            yield case.name, [Difference(case.name, "", "the case", "(not stored)", "store it")]


def store(some: Sequence[Case], whole: bool) -> list[str]:
    """Write the cases, and the names of what changed; where all are written, cases that are gone are removed."""
    changed, stored = [], in_store()
    for case, answer in answers(some):
        path = STORE / f"{case.name}.txt"
        old = read(path) if path.exists() else {}
        same = {
            name: kept(case.name, is_values(name), old[name], lines) if name in old else lines
            for name, lines in answer.items()
        }
        text = "".join(
            f"{_MARK}{name}\n" + "".join(f"{line}\n" for line in lines)
            for name, lines in same.items()
        )
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.parent.mkdir(exist_ok=True)
            path.write_text(text, encoding="utf-8")
            changed.append(case.name)
    if whole:
        for name in stored.keys() - {case.name for case in some}:
            stored[name].unlink()
            changed.append(f"{name} (removed)")
    return changed


def main(words: list[str]) -> int:
    """Do what the first word says; the number of cases that differ, for the exit code."""
    what, rest = (words or [""])[0], words[1:]
    if what == "budget":
        golden_budget.main(rest)
        return 0
    names = [word for word in rest if word != "all"]
    some = chosen(names)
    if what not in ("compare", "store", "list") or not some:
        sys.exit((__doc__ or "") if some else f"no case has {' or '.join(names)} in its name")
    began = time.process_time()
    if what == "list":
        print("\n".join(case.name for case in some))
        return 0
    if what == "store":
        changed = store(some, not names)
        print(*changed, f"{len(some)} cases, {len(changed)} files changed", _slowest(), sep="\n")
        return 0
    wrong = 0
    for _, found in compare(some):
        wrong += bool(found)
        shown = found if "all" in rest else found[:MOST_SHOWN]
        for one in shown:
            print(one, flush=True)
        if len(shown) < len(found):
            print(f"    ... and {len(found) - len(shown)} more")
    took = time.process_time() - began
    print(
        f"{len(some)} cases in {took:.0f} s of processor time: {wrong or 'none'} differ{'s' if wrong == 1 else ''}"
    )
    print(_slowest())
    return wrong


def _slowest() -> str:
    slow = sorted(SECONDS, key=lambda name: -SECONDS[name])[:8]
    return "most time: " + ", ".join(f"{name} {SECONDS[name]:.1f} s" for name in slow)


if __name__ == "__main__":
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    sys.exit(1 if main(sys.argv[1:]) else 0)
