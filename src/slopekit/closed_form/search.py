"""The first factor at which something no longer stands, with its bracket."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
_LEAST, _MOST = 1e-6, 1e6
_STEPS = 2001  # over the whole range: 1.4 % each
_PARTS = 65


def first_loss(stands: Callable[[Floats], Bools]) -> tuple[float, float]:
    """The last factor at which it stands and the first at which it does not, neighbours in floating point.

    Parameters
    ----------
    stands : takes factors (m,), returns (m,) whether it stands when its strength is divided by each

    The factors run from 1e-6 to 1e6 in steps of 1.4 %, then in ever finer ones: where it is lost and regained, the
    first loss counts, unless it lies between two steps. (0, 1e-6) where it never stands; (1e6, inf) where it always
    does.

    >>> low, high = first_loss(lambda factor: factor**2 <= 2.0)
    >>> low, high - low < 1e-15
    (1.414213562373095, True)
    """
    factors = np.geomspace(_LEAST, _MOST, _STEPS)
    while True:
        lost = np.flatnonzero(~stands(factors))
        if not lost.size:
            return _MOST, np.inf
        at = int(lost[0])
        if at == 0:
            return 0.0, float(factors[0])
        low, high = float(factors[at - 1]), float(factors[at])
        if np.nextafter(low, high) == high:
            return low, high
        factors = np.unique(np.concatenate([[low], np.linspace(low, high, _PARTS), [high]]))
