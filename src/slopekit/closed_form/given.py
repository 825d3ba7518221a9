"""What closed forms over arrays are given, by name: one number for all of them, or one for each."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any, TypeAlias

import numpy as np

from slopekit.core.array_types import ArrayLike, NDArray

Codes = NDArray[np.int8]
#: One of the values that a formula takes: a float or an array.
Value: TypeAlias = Any
#: No name for what is absent, so that nothing is computed of it.
Columns: TypeAlias = dict[str, Value]


@dataclass(frozen=True, kw_only=True)
class BlockLoads:
    """What acts on blocks of rock, each value one number for all of them or an (n,) array.

    Attributes
    ----------
    unit_weight_kn_m3 : of the rock; water_unit_weight_kn_m3 : of the water
    fill : part of full water pressure, 0 dry, 1 full
    seismic : coefficient
    force_kn : the sum of the forces and the active bolts; None without any
    passive_kn : each passive bolt at full capacity, 0 where it holds no block: it pulls with capacity / F where it is
        drawn out, with less where that would already stop the movement along it
    """

    unit_weight_kn_m3: ArrayLike
    water_unit_weight_kn_m3: ArrayLike = 9.81
    fill: ArrayLike = 0.0
    seismic: ArrayLike = 0.0
    force_kn: Sequence[ArrayLike] | None = None
    passive_kn: Sequence[Sequence[ArrayLike]] = ()


def with_passive(columns: Columns, count: int, bolts: Sequence[Sequence[ArrayLike]]) -> tuple[Columns, int]:
    """The columns with bolts (n, b, parts) in one more of them; n."""
    parts = np.broadcast_arrays(np.empty(count), *chain.from_iterable(bolts))
    passive = np.stack(parts, axis=1)[:, 1:].reshape(len(parts[0]), len(bolts), -1 if bolts else 0)
    return columns | {"passive_kn": passive}, len(passive)


def columns_of(given: Mapping[str, ArrayLike | None]) -> tuple[Columns, int]:
    """Floats, and arrays (n,); n.

    Raises
    ------
    ValueError
        Where an array has two dimensions or more, or two have different lengths.

    >>> columns_of({"height_m": [10, 12], "fill": 0, "crack_fill": None})
    ({'height_m': array([10., 12.]), 'fill': 0.0}, 2)
    """
    columns: Columns = {}
    lengths = set()
    for name, value in given.items():
        if isinstance(value, float):
            columns[name] = float(value)
        elif value is not None:
            array = np.asarray(value, dtype=np.float64)
            columns[name] = float(array.item()) if array.size == 1 else array
            if array.size != 1:
                lengths.add(array.shape)
    if len(lengths) > 1 or any(len(shape) > 1 for shape in lengths):
        shapes = ", ".join(f"{name} {value.shape}" for name, value in columns.items() if isinstance(value, np.ndarray))
        raise ValueError(f"give floats and arrays of one length, not {shapes}")
    return columns, lengths.pop()[0] if lengths else 1


def of_chunk(columns: Columns, some: NDArray[np.intp] | slice) -> Columns:
    """The columns of some of the designs."""
    return {name: value if isinstance(value, float) else value[some] for name, value in columns.items()}


def counted(outcome: Codes, names: Sequence[str]) -> dict[str, int]:
    """How many there are of each outcome, in the order of the names, the absent ones left out."""
    counts = np.bincount(outcome, minlength=len(names))
    return {name: int(number) for name, number in zip(names, counts, strict=True) if number}
