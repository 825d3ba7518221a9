"""The size of the source in counts that only go down: CI fails where one rises above `.ci/limits.json`.

    python -m benchmarks.census           the counts beside their limits; exit code 1 where one is exceeded
    python -m benchmarks.census --lower   writes the limits down to the counts

>>> counts = census_of(["x = 1 if y and z else 2"])
>>> counts["statements"], counts["decisions"]
(1, 2)
"""

import ast
import json
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path

ROOT = Path(__file__).parents[1]
LIMITS = ROOT / ".ci" / "limits.json"
_PLAIN = (0.0, 0.5, 1.0, 2.0, -1.0)  # floats that are no constants of a method
#: Words that name nothing: see CONTRIBUTING.md.
FUNCTION_WORDS = frozenset(
    Path(__file__).with_name("function_words.txt").read_text(encoding="utf-8").split()
)


def census_of(texts: Iterable[str]) -> Counter[str]:
    """Count statements, decisions, records, constants, function words, skips and message codes of Python files.

    Parameters
    ----------
    texts : the contents of the files

    Returns
    -------
    counts by name; `widest_record` is the most fields of a record, `function_words` are identifiers
    """
    counts: Counter[str] = Counter()
    codes: set[str] = set()
    for text in texts:
        counts["format_skips"] += text.count("# fmt: skip")
        codes.update(re.findall(r'"([EW]\d{3})"', text))
        for node in ast.walk(ast.parse(text)):
            _count(node, counts)
    counts["codes"] = len(codes)
    counts["notice_codes"] = sum(code.startswith("W") for code in codes)
    return counts


def _count(node: ast.AST, counts: Counter[str]) -> None:
    counts["statements"] += isinstance(node, ast.stmt)
    counts["decisions"] += isinstance(node, ast.If | ast.IfExp)
    if isinstance(node, ast.BoolOp):
        counts["decisions"] += len(node.values) - 1
    if isinstance(node, ast.Constant) and isinstance(node.value, float):
        counts["constants"] += node.value not in _PLAIN
    if isinstance(node, ast.ClassDef) and any(
        "dataclass" in ast.unparse(each) for each in node.decorator_list
    ):
        fields = sum(isinstance(statement, ast.AnnAssign) for statement in node.body)
        counts["records"] += 1
        counts["widest_record"] = max(counts["widest_record"], fields)
    counts["function_words"] += _identifier(node).strip("_") in FUNCTION_WORDS


def _identifier(node: ast.AST) -> str:
    match node:
        case ast.Name(id=name) | ast.arg(arg=name) | ast.Attribute(attr=name):
            return name
        case ast.FunctionDef(name=name) | ast.ClassDef(name=name):
            return name
    return ""


def source() -> list[str]:
    """Return the contents of every Python file of the package."""
    return [
        path.read_text(encoding="utf-8") for path in sorted((ROOT / "src/slopekit").rglob("*.py"))
    ]


def exceeded(counts: Mapping[str, int], limits: Mapping[str, int]) -> list[str]:
    """Name the counts above their limits, and those without one.

    >>> exceeded({"statements": 5, "records": 1}, {"statements": 4, "records": 1})
    ['statements: 5, limit 4']
    """
    return [
        f"{name}: {count}, limit {limits.get(name, 'none')}"
        for name, count in counts.items()
        if count > limits.get(name, -1)
    ]


def _raised(limits: Mapping[str, int]) -> list[str]:
    """Name the limits that lie above those of the commit before."""
    shown = subprocess.run(
        ["git", "show", "HEAD^:.ci/limits.json"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    before = json.loads(shown.stdout) if shown.returncode == 0 else {}
    raised = [name for name in before if limits.get(name, 0) > before[name]]
    return [
        f"the limit of {name} was raised from {before[name]} to {limits[name]}" for name in raised
    ]


def main() -> int:
    """Print the counts beside their limits; 1 where one is exceeded."""
    counts, limits = census_of(source()), json.loads(LIMITS.read_text(encoding="utf-8"))
    if "--lower" in sys.argv[1:]:
        limits = {name: min(count, limits.get(name, count)) for name, count in counts.items()}
        LIMITS.write_text(json.dumps(limits, indent=1) + "\n", encoding="utf-8")
    for name, count in counts.items():
        print(f"{name:16s} {count:7d}   limit {limits.get(name)}")
    faults = [*exceeded(counts, limits), *_raised(limits)]
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
