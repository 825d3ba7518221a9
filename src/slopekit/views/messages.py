"""Every message as one Markdown page, `slopekit explain --all`: the first line as the source has it, and the long text.

The first lines are read from the source and from the declared fields, values as `…`, so that the page cannot fall
behind the program.
"""

import ast
import re
from collections.abc import Iterator, Mapping
from itertools import pairwise
from math import isfinite
from pathlib import Path

from slopekit.core.explanations import explanations
from slopekit.design.fields import every_field
from slopekit.design.registry import KINDS, record_of

_CODE = re.compile(r"[EW]\d{3}")
_MOST = 4  # first lines of one code
_HEAD = """# Messages

Made by `slopekit explain --all`. Do not edit: run it again.

Every message has a code whose meaning never changes. `E` stops the run: exit code 2 (bad input), 3 (these planes form
no block) or 5 (a bug of ours); in a study, where one point of many has it, it is a reason in the sheet. `W` stands
below the sheet as a NOTE and in the JSON under `warnings`. Below each code the first line as the program prints it, `…`
for a value (at most four forms of it), then what `slopekit explain CODE` prints.
"""
_PARTS = (
    ("E1", "Input: values, files, keys"), ("E2", "Planes, blocks, loads, and check"),
    ("E3", "Studies, pictures, reports, files for other programs"), ("E4", "Calls from Python, and later inputs"),
    ("E5", "Faults of the program"), ("W", "Notices"),
)  # fmt: skip


def messages_page() -> str:
    """Every code with its first lines and its long text, as Markdown."""
    first_lines = _first_lines()
    codes = sorted(explanations())
    lines = [_HEAD]
    for start, title in _PARTS:
        lines.append(f"## {title}\n")
        for code in (code for code in codes if code.startswith(start)):
            lines.append(f"### {code}\n")
            lines += [f"    {code} {text}" for text in first_lines.get(code, [])[:_MOST]]
            lines += ["", _marked(code), ""] if first_lines.get(code) else [_marked(code), ""]
    return "\n".join(lines).rstrip() + "\n"


def _marked(code: str) -> str:
    """The long text, its signs kept from Markdown."""
    return re.sub(r"([*<])", r"\\\1", explanations()[code])


def _first_lines() -> Mapping[str, list[str]]:
    """The first lines of every code, in the order of the source."""
    first_lines: dict[str, list[str]] = {}
    for path in sorted(Path(__file__).parents[1].rglob("*.py")):
        source = path.read_text(encoding="utf-8")
        if not _CODE.search(source):
            continue
        lines = source.splitlines()
        for function in ast.walk(ast.parse(source)):
            if isinstance(function, ast.FunctionDef):
                if not any(map(_CODE.search, lines[function.lineno - 1 : function.end_lineno])):
                    continue  # most have none, and none of their parts need be looked at
                for code, text in _of_function(function):
                    if text not in first_lines.setdefault(code, []):
                        first_lines[code].append(text)
    for field in (field for kind in KINDS for field in every_field(record_of(kind))):
        if (
            field.is_number
            and field.refusal.code != "E105"
            and (isfinite(field.limits.least) or isfinite(field.limits.most))
        ):
            text = f"{field.in_words.format(k='…')} is …, {field.limits_in_words()}"
            if text not in first_lines.setdefault(field.refusal.code, []):
                first_lines[field.refusal.code].append(text)
    return first_lines


def _of_function(function: ast.FunctionDef) -> Iterator[tuple[str, str]]:
    """Codes with the text that follows them as an argument, or with that of the variable that does."""
    parts, named = list(ast.walk(function)), list[tuple[int, str, str]]()
    for part in parts:
        if isinstance(part, ast.Assign) and isinstance(part.targets[0], ast.Name) and (text := _text(part.value)):
            named.append((part.lineno, part.targets[0].id, text))
    for part in parts:
        pieces = part.args if isinstance(part, ast.Call) else part.elts if isinstance(part, ast.Tuple) else []
        for code, message in pairwise(pieces):
            if not (isinstance(code, ast.Constant) and isinstance(code.value, str) and _CODE.fullmatch(code.value)):
                continue
            text = _text(message)
            if isinstance(message, ast.Name):
                before = [one for one in named if one[1] == message.id and one[0] < code.lineno]
                text = max(before)[2] if before else ""
            if len(re.findall(r"[^\W\d_]{2,}", text)) >= 3:  # what is nearly all values says nothing
                yield code.value, text


def _text(node: ast.expr) -> str:
    """A text of the source with its values as …; empty for anything else."""
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else ""
    if isinstance(node, ast.JoinedStr):
        parts = [part.value if isinstance(part, ast.Constant) else "…" for part in node.values]
        return re.sub("…{2,}", "…", "".join(str(part) for part in parts))
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        return re.sub("…{2,}", "…", "".join(_text(part) or "…" for part in (node.left, node.right)))
    return _text(node.body) if isinstance(node, ast.IfExp) else ""
