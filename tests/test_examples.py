"""Every example and every notebook runs from start to end; each ends in an assertion of its own."""

import json
import runpy
import shutil
import sys
from pathlib import Path

import pytest

from benchmarks.notebooks import notebooks
from slopekit.views import notebook

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("[0-9]*.py"))


@pytest.mark.slow
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.name)
def test_example(path, capsys) -> None:
    runpy.run_path(str(path))
    assert capsys.readouterr().out
    assert path.read_text().rstrip().splitlines()[-1].startswith("assert ")


def kinds_stored(cell) -> list[str]:
    """What a cell is stored with of the value of its last line, by MIME type."""
    return [
        kind
        for one in cell["outputs"]
        if one["output_type"] == "execute_result"
        for kind in sorted(one["data"])
    ]


@pytest.mark.slow
@pytest.mark.parametrize("path", notebooks(), ids=lambda path: path.name)
def test_notebook(path, tmp_path, monkeypatch) -> None:
    """Run as a kernel runs it, in this process: no cell fails, and each shows what is stored of its kind.

    With a kernel of its own, and stored: `python -m benchmarks.notebooks`. Pictures are drawn in one notebook:
    tests/views draws the others.
    """
    shell = pytest.importorskip("IPython.core.interactiveshell").InteractiveShell()
    monkeypatch.setitem(sys.modules, "pandas", None)  # no extra of slopekit brings it
    if path.stem != "wedge":
        monkeypatch.setattr(notebook, "page_picture", lambda document, what: "")
    for data in path.parent.glob("*.csv"):
        shutil.copy(data, tmp_path)
    monkeypatch.chdir(tmp_path)
    shown: list[str] = []
    monkeypatch.setattr(
        shell.displayhook, "write_format_data", lambda data, _: shown.extend(sorted(data))
    )
    cells = [
        one
        for one in json.loads(path.read_text(encoding="utf-8"))["cells"]
        if one["cell_type"] == "code"
    ]
    assert "".join(cells[-1]["source"]).startswith("assert ")
    for cell in cells:
        assert cell["execution_count"], "python -m benchmarks.notebooks"
        shown.clear()
        shell.run_cell("".join(cell["source"])).raise_error()
        assert shown == kinds_stored(cell), "python -m benchmarks.notebooks"


def test_there_are_examples() -> None:
    assert EXAMPLES
    assert len(notebooks()) == 3
