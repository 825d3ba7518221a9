"""One thread for the linear algebra of blocks: bands and fronts are narrow, threads would only wait for each other."""

from contextlib import AbstractContextManager
from functools import cache
from typing import Any

import scipy.linalg  # noqa: F401  it loads its own BLAS, which the controller only finds once it is loaded
from threadpoolctl import ThreadpoolController


@cache
def _linear_algebra_libraries() -> Any:
    """Return a controller of the threaded libraries: finding them takes 1 ms, setting their threads 0.01 ms."""
    return ThreadpoolController()


def one_thread() -> AbstractContextManager[Any]:
    """Return a context in which linear algebra works with one thread."""
    limited: AbstractContextManager[Any] = _linear_algebra_libraries().limit(limits=1)
    return limited
