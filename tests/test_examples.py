"""Every example and every notebook runs from start to end; each ends in an assertion of its own."""

import json
import runpy
from pathlib import Path

import pytest

from benchmarks.notebooks import notebooks, one_kernel, run

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("[0-9]*.py"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.name)
def test_example(path, capsys) -> None:
    runpy.run_path(str(path))
    assert capsys.readouterr().out
    assert path.read_text().rstrip().splitlines()[-1].startswith("assert ")


def kinds_shown(cell) -> list[list[str]]:
    """What a cell shows of the value of its last line, by MIME type."""
    return [sorted(one["data"]) for one in cell["outputs"] if one["output_type"] == "execute_result"]


@pytest.fixture(scope="module")
def kernel():
    """One for all notebooks: it is imported once."""
    for extra in ("ipykernel", "nbclient", "pandas", "jinja2", "ezdxf"):
        pytest.importorskip(extra)
    with one_kernel() as started:
        yield started


@pytest.mark.parametrize("path", notebooks(), ids=lambda path: path.name)
def test_notebook(path, kernel) -> None:
    """Run with a kernel: no cell fails, and each shows what is stored of its kind."""
    made, stored = run(path, kernel), json.loads(path.read_text(encoding="utf-8"))
    assert made.cells[-1].source.startswith("assert ")
    assert [cell["cell_type"] for cell in stored["cells"]] == [cell.cell_type for cell in made.cells]
    for cell, again in zip(stored["cells"], made.cells, strict=True):
        if cell["cell_type"] == "code":
            assert cell["execution_count"], "python -m benchmarks.notebooks"
            assert kinds_shown(cell) == kinds_shown(again), "python -m benchmarks.notebooks"


def test_there_are_examples() -> None:
    assert EXAMPLES
    assert len(notebooks()) == 3
