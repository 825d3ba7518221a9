"""Array types and the one way to freeze an array before it is stored."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


def frozen(values: ArrayLike) -> Floats:
    """Return `values` as a read-only, C-ordered float64 array (a copy only where one is needed).

    >>> frozen([1, 2]).flags.writeable
    False
    """
    array = np.array(values, dtype=np.float64, order="C")
    array.setflags(write=False)
    return array
