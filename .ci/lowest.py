"""The lowest versions that pyproject.toml allows of what slopekit needs and of its extras, as pip's constraints."""

import re
import tomllib
from pathlib import Path

_NOT_FOR_USERS = {"docs", "test"}


def lowest(project: dict) -> dict[str, str]:
    """Return the lower bound of every library by its name."""
    extras = project["optional-dependencies"]
    lines = [
        *project["dependencies"],
        *(line for name in extras.keys() - _NOT_FOR_USERS for line in extras[name]),
    ]
    return {
        line[: match.start()]: match[1]
        for line in lines
        if (match := re.search(r">=([\d.]+)", line))
    }


if __name__ == "__main__":
    text = Path(__file__).parents[1].joinpath("pyproject.toml").read_text(encoding="utf-8")
    print(
        "\n".join(
            f"{name}=={version}"
            for name, version in sorted(lowest(tomllib.loads(text)["project"]).items())
        )
    )
