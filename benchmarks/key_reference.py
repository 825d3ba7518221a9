"""Writes what the docs list of kinds: the key tables of docs/design-files.md from the declared fields, the templates.

`python -m benchmarks.key_reference`
"""

import re
from pathlib import Path

from benchmarks.key_tables import tables
from slopekit.design.templates import names, summary

PAGE = Path(__file__).parents[1] / "docs/design-files.md"
LIST = PAGE.parent / "howto/templates.md"


_BEHIND_KINDS = "## Distributions\n"


def written(page: str) -> str:
    """The page with the tables of today between their marks; a kind that is new has its heading and mark behind all."""
    for name, table in tables().items():
        begins = f"<!-- keys of {name} -->\n"
        if begins not in page:
            own = f"## {name}\n\n{summary(name)}.\n\n{begins}<!-- end of keys -->\n\n"
            page = page.replace(_BEHIND_KINDS, own + _BEHIND_KINDS)
        mark = re.escape(begins)
        page, count = re.subn(
            rf"({mark}).*?(<!-- end of keys -->)",
            lambda m, t=table: m[1] + t + m[2],
            page,
            flags=re.S,
        )
        if count != 1:
            raise ValueError(f"{PAGE.name} has {count} places for the keys of {name}")
    return page


def listed(page: str) -> str:
    """The page of templates with the list of today, as `slopekit templates list` prints it."""
    rows = "".join(f"{name:<20}{summary(name)}\n" for name in names())
    return re.sub(
        r"(slopekit templates list\n```\n\n```text\n).*?(```\n)",
        lambda m: m[1] + rows + m[2],
        page,
        flags=re.S,
    )


if __name__ == "__main__":
    LIST.write_text(listed(LIST.read_text(encoding="utf-8")), encoding="utf-8")
    PAGE.write_text(written(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
