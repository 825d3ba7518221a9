"""Every message as one Markdown page, `slopekit explain --all`: its code, and the long text."""

import re

from slopekit.core.explanations import explanations

_HEAD = """# Messages

Made by `slopekit explain --all`. Do not edit: run it again.

Every message has a code whose meaning never changes. `E` stops the run: exit code 2 (bad input), 3 (these planes form
no block) or 5 (a bug of ours); in a study, where one point of many has it, it is a reason in the sheet. `W` stands
below the sheet as a NOTE and in the JSON under `warnings`. Below each code what `slopekit explain CODE` prints.
"""
_PARTS = (
    ("E1", "Input: values, files, keys"),
    ("E2", "Planes, blocks, loads, and check"),
    ("E3", "Studies, pictures, reports, files for other programs"),
    ("E4", "Calls from Python, and later inputs"),
    ("E5", "Faults of the program"),
    ("W", "Notices"),
)


def messages_page() -> str:
    """Every code with its long text, as Markdown; signs of the text are kept from Markdown."""
    lines = [_HEAD]
    for start, title in _PARTS:
        lines.append(f"## {title}\n")
        for code, text in sorted(explanations().items()):
            if code.startswith(start):
                lines += [f"### {code}\n", re.sub(r"([*<])", r"\\\1", text), ""]
    return "\n".join(lines).rstrip() + "\n"
