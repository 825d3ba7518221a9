"""Every example runs from start to end; each ends in an assertion of its own."""

import runpy
from pathlib import Path

import pytest

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("[0-9]*.py"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.name)
def test_example(path, capsys) -> None:
    runpy.run_path(str(path))
    assert capsys.readouterr().out
    assert path.read_text().rstrip().splitlines()[-1].startswith("assert ")


def test_there_are_examples() -> None:
    assert EXAMPLES
