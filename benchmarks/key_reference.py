"""Writes the key tables of docs/design-files.md from the declared fields: `python -m benchmarks.key_reference`."""

import re
from pathlib import Path

from benchmarks.key_tables import tables

PAGE = Path(__file__).parents[1] / "docs/design-files.md"


def written(page: str) -> str:
    """The page with the tables of today between their marks."""
    for name, table in tables().items():
        mark = re.escape(f"<!-- keys of {name} -->")
        page, count = re.subn(
            rf"({mark}\n).*?(<!-- end of keys -->)", lambda m, t=table: m[1] + t + m[2], page, flags=re.S
        )
        if count != 1:
            raise ValueError(f"{PAGE.name} has {count} places for the keys of {name}")
    return page


if __name__ == "__main__":
    PAGE.write_text(written(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
