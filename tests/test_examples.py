"""Every example and every notebook runs from start to end; each ends in an assertion of its own."""

import ast
import json
import runpy
import shutil
from contextlib import chdir
from pathlib import Path
from typing import Any

import pytest

from benchmarks.notebooks import notebooks

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("[0-9]*.py"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.name)
def test_example(path, capsys) -> None:
    runpy.run_path(str(path))
    assert capsys.readouterr().out
    assert path.read_text().rstrip().splitlines()[-1].startswith("assert ")


def shown(source: str, names: dict[str, Any]) -> dict[str, str]:
    """A cell as a notebook runs it: what it shows of the value of its last line, by MIME type."""
    body = ast.parse(source).body
    last = body.pop() if isinstance(body[-1], ast.Expr) else None
    exec(compile(ast.Module(body, []), "cell", "exec"), names)
    value = None if last is None else eval(compile(ast.Expression(last.value), "cell", "eval"), names)
    if value is None:
        return {}
    page = value._repr_html_() if hasattr(value, "_repr_html_") else None
    return {"text/plain": repr(value)} | ({} if page is None else {"text/html": page})


@pytest.mark.parametrize("path", notebooks(), ids=lambda path: path.name)
def test_notebook(path, tmp_path) -> None:
    """In this process; `python -m benchmarks.notebooks` runs and stores them with a kernel."""
    for extra in ("pandas", "jinja2", "ezdxf"):
        pytest.importorskip(extra)
    for data in path.parent.glob("*.csv"):
        shutil.copy(data, tmp_path)
    cells = [cell for cell in json.loads(path.read_text(encoding="utf-8"))["cells"] if cell["cell_type"] == "code"]
    names: dict[str, Any] = {}
    with chdir(tmp_path):
        for cell in cells:
            results = [one["data"].keys() for one in cell["outputs"] if one["output_type"] == "execute_result"]
            made = shown("".join(cell["source"]), names).keys()
            assert results == ([made] if made else []), "python -m benchmarks.notebooks"
            assert cell["execution_count"], "python -m benchmarks.notebooks"
    assert "".join(cells[-1]["source"]).startswith("assert ")


def test_there_are_examples() -> None:
    assert EXAMPLES
    assert len(notebooks()) == 3
