"""What closed forms over arrays are given, by name: one number for all of them, or one for each."""

from collections.abc import Iterator, Mapping
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Codes = NDArray[np.int8]
Indices = NDArray[np.intp]
#: One of the values that a formula takes: a float, an array, or a step of a tape.
Value: TypeAlias = Any
#: No name for what is absent, so that nothing is computed of it.
Columns: TypeAlias = dict[str, float | Floats]
#: How many are taken at a time: of fewer the calls take the time, of more the cache does not hold the rows.
CHUNK: Final = 8192


def columns_of(given: Mapping[str, ArrayLike | None]) -> tuple[Columns, int]:
    """Floats, and arrays (n,); n.

    Raises
    ------
    ValueError
        Where an array has two dimensions or more, or two have different lengths.

    >>> columns_of({"height_m": [10, 12], "fill": 0, "crack_fill": None})
    ({'height_m': array([10., 12.]), 'fill': 0.0}, 2)
    """
    arrays = {name: np.asarray(value, dtype=np.float64) for name, value in given.items() if value is not None}
    lengths = {array.size for array in arrays.values() if array.ndim and array.size != 1}
    if len(lengths) > 1 or any(array.ndim > 1 for array in arrays.values()):
        shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items() if array.ndim)
        raise ValueError(f"give floats and arrays of one length, not {shapes}")
    columns: Columns = {name: float(array.item()) if array.size == 1 else array for name, array in arrays.items()}
    return columns, lengths.pop() if lengths else 1


def selected(columns: Columns, where: Indices | slice) -> Columns:
    """The columns of some of the designs."""
    return {name: value if isinstance(value, float) else value[where] for name, value in columns.items()}


def chunks(indices: Indices) -> Iterator[Indices]:
    """`CHUNK` of them at a time."""
    for first in range(0, indices.size, CHUNK):
        yield indices[first : first + CHUNK]
