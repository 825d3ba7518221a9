"""The first strength reduction factor at which a block is unstable, with its bracket."""

import math
from collections.abc import Callable, Sequence
from typing import Any, TypeVar, cast

import numpy as np

from slopekit.core.array_types import Bools, Floats

_MIN_FACTOR, _MAX_FACTOR = 1e-6, 1e6
_STEPS = 2001  # over the whole range: 1.4 % each
_REFINEMENT = 65
_DIRECTION_DECIMALS = (
    12  # decimals of a direction: bolts that differ in a later one pull the same way
)

#: The parts of a force.
Bolt = TypeVar("Bolt", bound=tuple[Any, ...])


def first_loss(is_stable: Callable[[Floats], Bools]) -> tuple[float, float]:
    """Return the last stable and the first unstable strength reduction factor, neighbours in floating point.

    Parameters
    ----------
    is_stable : takes factors (m,), returns (m,) whether the block is stable with its strength divided by each

    The factors run from 1e-6 to 1e6 in steps of 1.4 %, then in ever finer ones: where stability is lost and regained,
    the first loss counts, unless it lies between two steps. (0, 1e-6) if never stable; (1e6, inf) if always stable.

    >>> low, high = first_loss(lambda factor: factor**2 <= 2.0)
    >>> low, high - low < 1e-15
    (1.414213562373095, True)
    """
    factors = np.geomspace(_MIN_FACTOR, _MAX_FACTOR, _STEPS)
    while True:
        losses = np.flatnonzero(~is_stable(factors))
        if not losses.size:
            return _MAX_FACTOR, np.inf
        loss = int(losses[0])
        if loss == 0:
            return 0.0, float(factors[0])
        low, high = float(factors[loss - 1]), float(factors[loss])
        if np.nextafter(low, high) == high:
            return low, high
        factors = np.unique(np.concatenate([[low], np.linspace(low, high, _REFINEMENT), [high]]))


def loss_with_bolts(
    evaluate: Callable[[Floats], tuple[Bools, Bools]], has_contact: bool
) -> tuple[float, float]:
    """Return the factor of safety of a block with passive bolts, and the first unstable λ = 1/F.

    Parameters
    ----------
    evaluate : takes values λ (m,) that multiply all strength and the capacity of the bolts; returns (m,) whether the
        block is stable, and whether it has lost contact
    has_contact : whether the block is in contact without bolts; bolts strong enough to lift it off then pull only with
        the force that keeps contact

    The factor is nan where the block loses contact or is always stable, 0 where it slides at any strength.
    """

    def is_stable(factors: Floats) -> Bools:
        return evaluate(1.0 / factors)[0]

    low, high = first_loss(is_stable)
    if low == 0.0 and has_contact and evaluate(np.array([1.0 / high]))[1][0]:
        factors = np.geomspace(_MIN_FACTOR, _MAX_FACTOR, _STEPS)
        regained = np.flatnonzero(is_stable(factors))
        if regained.size:
            least = factors[regained[0]]
            low, high = first_loss(lambda factors: (factors <= least) | is_stable(factors))
    if high == np.inf:
        return np.nan, 1.0 / low
    if low == 0.0:
        return (np.nan if evaluate(np.array([1.0 / high]))[1][0] else 0.0), 1.0 / high
    return low, 1.0 / high


def merged_bolts(bolts: Sequence[Bolt]) -> list[Bolt]:
    """Return the bolts with those of one direction merged into one of their total capacity: forces are the same.

    >>> merged_bolts([(3.0, 0.0, 4.0), (0.0, 1.0, 0.0), (0.6, 0.0, 0.8), (0.0, -1.0, 0.0)])
    [(3.6, 0.0, 4.8), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0)]
    """
    by_direction: dict[tuple[float, ...], Bolt] = {}
    for bolt in bolts:
        size = math.hypot(*bolt) or 1.0
        direction = tuple(round(component / size, _DIRECTION_DECIMALS) for component in bolt)
        by_direction[direction] = (
            cast(Bolt, tuple(map(sum, zip(by_direction[direction], bolt, strict=True))))
            if direction in by_direction
            else bolt
        )
    return list(by_direction.values())
