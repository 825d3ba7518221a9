"""Bolts in samples whose planes scatter: they were laid out on the face of the design, and stand on that of the sample.

Both methods judge each sample with the same bolts: those that hold its block.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.core.errors import SlopekitError
from slopekit.design.common import Design
from slopekit.design.reading.files import with_values
from slopekit.kinds import kind_of
from slopekit.kinds.single_block.held_bolts import D, held, stand_off, with_held


def as_laid_out(design: Design) -> Floats:
    """How far (m) before the face of the design the head of each bolt (b,) stands; 0 of bolts that do not enter it."""
    on_arrays = kind_of(design).on_arrays
    return np.zeros(len(design.bolts)) if on_arrays is None else stand_off(on_arrays.bounds(design), design.bolts)


def has_heads(design: Design) -> bool:
    """Whether any bolt has its place."""
    return any(bolt.head_m is not None for bolt in design.bolts)


def standing(design: D, before: Floats) -> D:
    """A sample with the bolts that hold its block, their heads on its face; as it is where a kind knows no such planes.

    Parameters
    ----------
    before : (b,) of the design that the sample is one of, as `as_laid_out` has it
    """
    if (on_arrays := kind_of(design).on_arrays) is None or not has_heads(design):
        return design
    return with_held(design, on_arrays.bounds(design), before)


def holding(design: Design, samples: Sequence[Mapping[str, object]]) -> Bools:
    """Which bolts (b, n) hold the block of each sample, read one by one; all where it has no values a design can have.

    Parameters
    ----------
    samples : their values, as `with_values` takes them
    """
    holds, before = np.ones((len(design.bolts), len(samples)), dtype=bool), as_laid_out(design)
    if (on_arrays := kind_of(design).on_arrays) is None:
        return holds
    for row, values in enumerate(samples):
        try:
            sample = with_values(design, values)
        except SlopekitError:
            continue
        holds[:, row] = held(on_arrays.bounds(sample), sample.bolts, before)[0][:, 0]
    return holds
