"""The first factor at which something no longer stands, with its bracket."""

import math
from collections.abc import Callable, Sequence
from typing import Any, TypeVar, cast

import numpy as np

from slopekit.core.array_types import Bools, Floats

_LEAST, _MOST = 1e-6, 1e6
_STEPS = 2001  # over the whole range: 1.4 % each
_PARTS = 65
_SAME_WAY = 12  # decimals of a direction: bolts that differ in a later one pull the same way

#: The parts of a force.
Bolt = TypeVar("Bolt", bound=tuple[Any, ...])


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


def loss_with_bolts(judged: Callable[[Floats], tuple[Bools, Bools]], touches: bool) -> tuple[float, float]:
    """The factor of safety of a block with passive bolts, and the reduction λ = 1/F with which it is lost.

    Parameters
    ----------
    judged : takes reductions λ (m,), by which all strength is multiplied and the capacity of the bolts with it; returns
        (m,) whether the block stands, and whether it has lost contact
    touches : whether it is in contact without bolts: such strong ones that they would lift it off pull no more than
        keeps it there

    nan where it is lost by losing contact or never, 0 where it slides whatever its strength.
    """

    def stands(factors: Floats) -> Bools:
        return judged(1.0 / factors)[0]

    low, high = first_loss(stands)
    if low == 0.0 and touches and judged(np.array([1.0 / high]))[1][0]:
        factors = np.geomspace(_LEAST, _MOST, _STEPS)
        regained = np.flatnonzero(stands(factors))
        if regained.size:
            least = factors[regained[0]]
            low, high = first_loss(lambda factors: (factors <= least) | stands(factors))
    if high == np.inf:
        return np.nan, 1.0 / low
    if low == 0.0:
        return (np.nan if judged(np.array([1.0 / high]))[1][0] else 0.0), 1.0 / high
    return low, 1.0 / high


def together(bolts: Sequence[Bolt]) -> list[Bolt]:
    """The bolts, those of one direction as one of all their capacities: forces alone do not tell them apart.

    >>> together([(3.0, 0.0, 4.0), (0.0, 1.0, 0.0), (0.6, 0.0, 0.8), (0.0, -1.0, 0.0)])
    [(3.6, 0.0, 4.8), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0)]
    """
    by_direction: dict[tuple[float, ...], Bolt] = {}
    for bolt in bolts:
        size = math.hypot(*bolt) or 1.0
        way = tuple(round(part / size, _SAME_WAY) for part in bolt)
        by_direction[way] = (
            cast(Bolt, tuple(map(sum, zip(by_direction[way], bolt, strict=True)))) if way in by_direction else bolt
        )
    return list(by_direction.values())
