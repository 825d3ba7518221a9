"""The notebooks of examples/, run from start to end: ``python -m benchmarks.notebooks`` stores what they show.

A test runs them too (`tests/test_examples.py`), with `run`, and compares nothing but that no cell fails.
"""

import os
import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

EXAMPLES = Path(__file__).parents[1] / "examples"
_SECONDS = 300
#: No extra of slopekit brings pandas: a notebook that asks for it fails for who installed what it says.
_WITHOUT_PANDAS = "__import__('sys').modules['pandas'] = None\n"


def notebooks() -> list[Path]:
    """The notebooks, in order."""
    return sorted(EXAMPLES.glob("*.ipynb"))


def run(path: Path, kernel: Any = None) -> Any:
    """A notebook with what its cells give, run in a folder of its own beside the data of the examples.

    Parameters
    ----------
    kernel : of `one_kernel`, which starts without a name of an earlier notebook; None: a kernel of its own

    Raises
    ------
    nbclient.exceptions.CellExecutionError
        A cell fails.
    """
    import nbformat
    from nbclient import NotebookClient

    with TemporaryDirectory() as folder, _found_here():
        for data in EXAMPLES.glob("*.csv"):
            shutil.copy(data, folder)
        notebook = nbformat.read(path, as_version=4)
        notebook.cells.insert(0, nbformat.v4.new_code_cell(_WITHOUT_PANDAS))
        client = NotebookClient(
            notebook, timeout=_SECONDS, km=kernel, resources={"metadata": {"path": folder}}
        )
        if kernel is None:
            made = client.execute()
        else:
            notebook.cells[0].source += f"__import__('os').chdir({folder!r})\n%reset -f"
            try:
                made = client.execute()
            finally:
                client.kc.stop_channels()
        del made.cells[0]
        return made


@contextmanager
def one_kernel() -> Iterator[Any]:
    """A kernel for several notebooks: what it has imported it need not import again."""
    from jupyter_client.manager import KernelManager

    with TemporaryDirectory() as folder, _found_here():
        kernel = KernelManager(kernel_name="python3")
        kernel.start_kernel(cwd=folder)
        try:
            yield kernel
        finally:
            kernel.shutdown_kernel(now=True)


@contextmanager
def _found_here() -> Iterator[None]:
    """The kernel is another process: it looks for packages where this one does."""
    before = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = os.pathsep.join(path for path in sys.path if path)
    try:
        yield
    finally:
        if before is None:
            del os.environ["PYTHONPATH"]
        else:
            os.environ["PYTHONPATH"] = before


def main() -> None:
    """Run and store all of them."""
    import nbformat

    for path in notebooks():
        made = run(path)
        for cell in made.cells:
            cell["metadata"].pop("execution", None)  # when it ran
        nbformat.write(made, path)
        print(f"{path.name}: {len(made.cells)} cells, {path.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
