"""The types of arrays, and no line of code: those whose formulas share none may share them."""

from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

import numpy as np

if (
    TYPE_CHECKING
):  # numpy.typing takes a millisecond of a cold run, to write the docstring of its NDArray
    from numpy.typing import ArrayLike as ArrayLike
else:
    ArrayLike = Any

S = TypeVar("S", bound=np.generic)

NDArray: TypeAlias = np.ndarray[tuple[Any, ...], np.dtype[S]]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
