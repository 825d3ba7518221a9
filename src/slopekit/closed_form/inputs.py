"""Inputs of closed forms over arrays, by name: one number for all designs, or one for each."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any, TypeAlias

import numpy as np

from slopekit.core.array_types import ArrayLike, NDArray

Codes = NDArray[np.int8]
#: One of the values that a formula takes: a float or an array.
Value: TypeAlias = Any
#: Inputs by name; an absent input has no entry, so that nothing is computed from it.
Columns: TypeAlias = dict[str, Value]


@dataclass(frozen=True, kw_only=True)
class BlockLoads:
    """Loads on blocks of rock, each value one number for all of them or an (n,) array.

    Attributes
    ----------
    unit_weight_kn_m3 : of the rock; water_unit_weight_kn_m3 : of the water
    fill : fraction of full water pressure, 0 dry, 1 full
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


def with_passive(
    columns: Columns, count: int, bolts: Sequence[Sequence[ArrayLike]]
) -> tuple[Columns, int]:
    """Return the columns with an entry `passive_kn` (n, bolts, components) for passive bolts, and n."""
    components = np.broadcast_arrays(np.empty(count), *chain.from_iterable(bolts))
    passive = np.stack(components, axis=1)[:, 1:].reshape(
        len(components[0]), len(bolts), -1 if bolts else 0
    )
    return columns | {"passive_kn": passive}, len(passive)


def float_columns(inputs: Mapping[str, ArrayLike | None]) -> tuple[Columns, int]:
    """Return inputs as floats and arrays (n,) without the absent ones, and n.

    Raises
    ------
    ValueError
        An array has two dimensions or more, or two arrays have different lengths.

    >>> float_columns({"height_m": [10, 12], "fill": 0, "crack_fill": None})
    ({'height_m': array([10., 12.]), 'fill': 0.0}, 2)
    """
    columns: Columns = {}
    lengths = set()
    for name, value in inputs.items():
        if isinstance(value, float):
            columns[name] = float(value)
        elif value is not None:
            array = np.asarray(value, dtype=np.float64)
            columns[name] = float(array.item()) if array.size == 1 else array
            if array.size != 1:
                lengths.add(array.shape)
    if len(lengths) > 1 or any(len(shape) > 1 for shape in lengths):
        shapes = ", ".join(
            f"{name} {value.shape}"
            for name, value in columns.items()
            if isinstance(value, np.ndarray)
        )
        raise ValueError(f"give floats and arrays of one length, not {shapes}")
    return columns, lengths.pop()[0] if lengths else 1


def selected_columns(columns: Columns, selection: NDArray[np.intp] | slice) -> Columns:
    """Return the inputs of some of the designs."""
    return {
        name: value if isinstance(value, float) else value[selection]
        for name, value in columns.items()
    }


def counted(outcome: Codes, names: Sequence[str]) -> dict[str, int]:
    """Return the number of each outcome, in the order of the names, without those that do not occur."""
    counts = np.bincount(outcome, minlength=len(names))
    return {name: int(number) for name, number in zip(names, counts, strict=True) if number}
