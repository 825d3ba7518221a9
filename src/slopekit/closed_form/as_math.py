"""Functions of `math` over arrays, to the last bit: for code that has to say what a function of plain floats says."""

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np


def each(function: Callable[..., float], *values: Any) -> Any:
    """A function of `math` of floats or arrays.

    NumPy's own may differ in the last bit, and then not decide as the function of plain floats does where that counts;
    where it gives the very same it is taken, being several times as fast.

    >>> each(math.hypot, np.array([3.0, 5.0]), np.array([4.0, 12.0])).tolist(), float(each(math.sin, 0.0))
    ([5.0, 13.0], 0.0)
    """
    if all(isinstance(value, float) for value in values):
        return np.float64(function(*values))  # which may be divided by, even where it is 0
    if function in _same():
        return _same()[function](*values)
    lists = [np.asarray(part).ravel().tolist() for part in np.broadcast_arrays(*values)]
    return np.fromiter(map(function, *lists), dtype=np.float64, count=len(lists[0]))


@cache
def _same() -> dict[Callable[..., float], np.ufunc]:
    """The sine and the cosine of NumPy where they are those of `math` on this machine."""
    angles = np.linspace(-7.0, 7.0, 1001)
    pairs: dict[Callable[..., float], np.ufunc] = {math.sin: np.sin, math.cos: np.cos}
    return {ours: theirs for ours, theirs in pairs.items() if theirs(angles).tolist() == list(map(ours, angles))}
