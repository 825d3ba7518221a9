"""Every worker of the test run gets one thread: matrices are small, and the cores are the workers'.

Hypothesis mixes the constants of all loaded modules of the project into its examples: which ones it tries would then
depend on which tests ran before on the same worker. Here it does not see them.

Compiled modules are kept even where the environment asks for none, as containers do: else every worker compiles three
hundred files and rewrites the assertions of a hundred anew, 7 s each, and every command that is started the rest.

What is there after collection stays to the end: the garbage collector need not go through five thousand tests again.
"""

import gc
import os
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from _pytest.doctest import DoctestModule
from hypothesis.internal.conjecture import providers

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")

sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # workers and commands inherit it

if hasattr(providers, "_get_local_constants"):
    none_yet = providers._local_constants
    providers._get_local_constants = lambda: none_yet

#: A script for mypy, not for running.
collect_ignore = ["caller.py"]

gc.disable()


@pytest.fixture(autouse=True, scope="session")
def _times_are_not_compared() -> None:
    """How long a rung of a check takes is shown and never compared."""
    from slopekit.kinds.single_block import ladders

    ladders._REPEATS, ladders._REPEATED_ONCE_BELOW_S = 1, 0.0


@pytest.hookimpl(wrapper=True)
def pytest_collect_file(file_path: Path) -> Iterator[None]:
    """Modules of tests without an example are not looked through for one: a second a worker."""
    found = yield
    if ">>>" in file_path.read_text(encoding="utf-8", errors="replace"):
        return found
    return [one for one in found if not isinstance(one, DoctestModule)]


def pytest_collection_finish() -> None:
    gc.freeze()
    gc.enable()
    gc.set_threshold(
        50_000, 20, 100
    )  # what tests leave behind is little: 4 % of their time went into looking for it
