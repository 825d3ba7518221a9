"""One thread for the linear algebra of blocks: bands and fronts are narrow, threads would only wait for each other."""

from contextlib import AbstractContextManager
from functools import cache
from typing import Any

import scipy.linalg  # noqa: F401  it brings a linear algebra of its own, which is counted once it is there
from threadpoolctl import ThreadpoolController


@cache
def _libraries() -> Any:
    """The libraries that have threads: to look for them takes a millisecond, to set their threads a hundredth of it."""
    return ThreadpoolController()


def one_thread() -> AbstractContextManager[Any]:
    """While it is open linear algebra works with one thread."""
    limited: AbstractContextManager[Any] = _libraries().limit(limits=1)
    return limited
