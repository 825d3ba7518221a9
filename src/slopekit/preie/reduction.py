"""The paper's criterion: the smallest F at which every node pair slips or debonds (§3.3), found by its search (§3.4).

A yielded pair still carries load: on a stiff bed all pairs yield well before the block moves, so this factor depends
on the stiffness (METHOD.md §3). It is reported beside the limit, never instead of it.
"""

import math
from dataclasses import dataclass

from slopekit.preie.contact import JointStiffness
from slopekit.preie.equilibrium import Equilibrium, equilibrium
from slopekit.preie.model import Model


@dataclass(frozen=True, slots=True)
class AllPairsFailed:
    """The factor with its bracket and the way there.

    Attributes
    ----------
    factor : the upper end of the bracket, None where the search found none
    bracket : (F with pairs that still stick, F with none); lost_equilibrium : the blocks do not stand at the upper end
    history : (F, failed pairs) of every trial, in the order of the search
    """

    factor: float | None
    bracket: tuple[float, float]
    lost_equilibrium: bool
    history: tuple[tuple[float, int], ...]


def all_pairs_failed(
    model: Model, stiffness: JointStiffness, first: float = 1.0, growth: float = 1.5, relative: float = 1e-5
) -> AllPairsFailed:
    """Bracket and bisect the factor at which the last pair fails (Figure 9 of the paper; Dawson et al. 1999).

    Parameters
    ----------
    first : where the search starts; growth : its iteration coefficient m > 1
    relative : width of the final bracket in parts of the factor
    """
    history: list[tuple[float, int]] = []
    standing: Equilibrium | None = None
    count = len(model.control_area)

    def failed(factor: float) -> bool:
        nonlocal standing
        state = equilibrium(model, factor, stiffness, standing, until_all_failed=True)
        history.append((factor, state.failed_pairs if state.stands else count))
        if state.stands and state.failed_pairs < count:
            standing = state
            return False
        return True

    low, high = first, first
    if failed(first):
        while failed(low := low / growth):
            if low < 1e-6:
                return AllPairsFailed(None, (0.0, high), False, tuple(history))
            high = low
    else:
        while not failed(high := high * growth):
            if high > 1e6:
                return AllPairsFailed(None, (low, math.inf), False, tuple(history))
            low = high
    while high - low > relative * low:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if failed(middle) else (middle, high)
    stands = equilibrium(model, high, stiffness, standing).stands
    return AllPairsFailed(high, (low, high), not stands, tuple(history))
