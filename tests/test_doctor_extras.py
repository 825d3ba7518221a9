"""The doctor names every extra that a user may install."""

import tomllib
from pathlib import Path

from slopekit.views.doctor import _EXTRAS

_FOR_WORK_ON_IT = {"test", "docs", "dev", "all"}


def test_doctor_knows_every_extra_of_the_package() -> None:
    table = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8"))
    assert set(_EXTRAS.values()) == set(table["project"]["optional-dependencies"]) - _FOR_WORK_ON_IT
