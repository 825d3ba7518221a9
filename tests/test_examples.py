"""Every example and every notebook runs from start to end; each ends in an assertion of its own."""

import json
import runpy
from pathlib import Path

import pytest

from benchmarks.notebooks import notebooks, run

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("[0-9]*.py"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.name)
def test_example(path, capsys) -> None:
    runpy.run_path(str(path))
    assert capsys.readouterr().out
    assert path.read_text().rstrip().splitlines()[-1].startswith("assert ")


@pytest.mark.parametrize("path", notebooks(), ids=lambda path: path.name)
def test_notebook(path) -> None:
    pytest.importorskip("ipykernel")
    pytest.importorskip("nbclient")
    made, stored = run(path), json.loads(path.read_text(encoding="utf-8"))
    assert made.cells[-1].source.startswith("assert ")
    assert [cell["cell_type"] for cell in stored["cells"]] == [cell.cell_type for cell in made.cells]
    ran = [cell for cell in stored["cells"] if cell["cell_type"] == "code"]
    assert all(cell["execution_count"] for cell in ran), "python -m benchmarks.notebooks"


def test_there_are_examples() -> None:
    assert EXAMPLES
    assert len(notebooks()) == 2
