"""The paper's criterion: the smallest F at which a block has failed (§3.3), found by its search (§3.4).

A block has failed when no chain of sticking node pairs joins it to bedrock; one block alone, when every pair slips or
debonds. A yielded pair still carries load: on a stiff bed all pairs yield well before the blocks move, so this factor
depends on the stiffness (docs/theory/preie.md). It is reported beside the limit, never instead of it. A block that
topples turns about a pair that sticks: nothing detaches it, and the search ends where the blocks no longer stand.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from slopekit.core.arrays import Bools
from slopekit.preie.motion.equilibrium import Equilibrium, equilibrium
from slopekit.preie.system.contact import JointStiffness
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import EQUILIBRIUM, FARTHEST

if TYPE_CHECKING:  # one block needs no sparse matrices
    from slopekit.preie.motion.settlement import Settlement
    from slopekit.preie.system.assembly import AssemblyModel


@dataclass(frozen=True)
class AllPairsFailed:
    """The factor with its bracket and the way there.

    Attributes
    ----------
    factor : the upper end of the bracket, None where the search found none
    bracket : (F with every block attached, F with one that is not)
    lost_equilibrium : the blocks do not stand at the upper end
    history : (F, failed pairs) of every trial, in the order of the search; all pairs where the blocks do not stand
    """

    factor: float | None
    bracket: tuple[float, float]
    lost_equilibrium: bool
    history: tuple[tuple[float, int], ...]


def all_pairs_failed(
    model: "Model | AssemblyModel", stiffness: JointStiffness, limit: float | None = None, growth: float = 1.5,
    relative: float = 1e-5, bound: float | None = None,
) -> AllPairsFailed:  # fmt: skip
    """Bracket and bisect the factor at which the first block fails (Figure 9 of the paper; Dawson et al. 1999).

    Parameters
    ----------
    limit : the factor above which nothing stands; None: the search starts at 1
    growth : its iteration coefficient m > 1
    relative : width of the final bracket in parts of the factor
    bound : of one block, its static bound, above which it is not tried
    """
    trials: _Trials = _OfOneBlock(model, stiffness, bound) if isinstance(model, Model) else _OfBlocks(model, stiffness)
    history: list[tuple[float, int]] = []

    def failed(factor: float) -> bool:
        pairs, has_failed = trials.at(factor)
        history.append((factor, pairs))
        return has_failed

    low = high = limit or 1.0
    if limit or failed(1.0):
        while failed(low := low / growth):
            if low < 1.0 / FARTHEST:
                return AllPairsFailed(None, (0.0, high), False, tuple(history))
            high = low
    else:
        while not failed(high := high * growth):
            if high > FARTHEST:
                return AllPairsFailed(None, (low, math.inf), False, tuple(history))
            low = high
    while high - low > relative * low:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if failed(middle) else (middle, high)
    return AllPairsFailed(high, (low, high), high == limit or not trials.stand(high), tuple(history))


class _Trials(Protocol):
    """Blocks at rest at one factor after the other."""

    def at(self, factor: float) -> tuple[int, bool]:
        """Failed pairs, and whether a block has failed."""

    def stand(self, factor: float) -> bool:
        """Whether all blocks come to rest."""


class _OfOneBlock:
    """One block, from the largest factor at which some pair has been seen to stick.

    The least factor at which it was lost, or all pairs failed, lies on the way to every larger one: that fails too.
    """

    def __init__(self, model: Model, stiffness: JointStiffness, bound: float | None) -> None:
        self.model, self.stiffness = model, stiffness
        self.standing: Equilibrium | None = None
        self.failed = math.inf if bound is None else bound * (1.0 + EQUILIBRIUM)

    def at(self, factor: float) -> tuple[int, bool]:
        """On the way there no pair may stick: that ends it."""
        count = len(self.model.control_area)
        if factor >= self.failed:
            return count, True
        state = equilibrium(self.model, factor, self.stiffness, self.standing, until_all_failed=True)
        if not state.stands or state.failed_pairs == count:
            self.failed = state.factor
            return count, True
        self.standing = state
        return state.failed_pairs, False

    def stand(self, factor: float) -> bool:
        return equilibrium(self.model, factor, self.stiffness, self.standing).stands


class _OfBlocks:
    """Many blocks, from the largest factor at which all have been seen attached."""

    def __init__(self, model: "AssemblyModel", stiffness: JointStiffness) -> None:
        self.model, self.stiffness = model, stiffness
        self.attached: Settlement | None = None
        self.stood: dict[float, bool] = {}

    def at(self, factor: float) -> tuple[int, bool]:
        from slopekit.preie.motion.settlement import settlement

        at_rest = settlement(self.model, self.stiffness, factor, self.attached)
        self.stood[factor] = at_rest is not None
        if at_rest is None:
            return len(self.model.control_area), True
        if blocks_detached(self.model, ~at_rest.slips & ~self.model.bolted).any():
            return at_rest.failed_pairs, True
        self.attached = at_rest
        return at_rest.failed_pairs, False

    def stand(self, factor: float) -> bool:
        return self.stood[factor]


def blocks_detached(model: "AssemblyModel", sticks: Bools) -> Bools:
    """The blocks (n,) that no chain of sticking contacts joins to bedrock.

    A contact joins its two blocks where at least one of its friction forces (g,) sticks.
    """
    from scipy import sparse
    from scipy.sparse.csgraph import connected_components

    blocks = len(model.load)
    contact = model.group_contact[sticks]
    minus = np.where(model.minus[contact] < 0, blocks, model.minus[contact])  # bedrock is the last
    graph = sparse.coo_matrix((np.ones(len(contact)), (model.plus[contact], minus)), shape=(blocks + 1, blocks + 1))
    _, part = connected_components(graph, directed=False)
    detached: Bools = part[:blocks] != part[blocks]
    return detached
