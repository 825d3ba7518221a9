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
    """The factor at which the first block has failed, with its bracket and the trials of the search.

    Attributes
    ----------
    factor : the upper end of the bracket, None where the search did not converge
    bracket : (F with every block attached, F with one that is not)
    lost_equilibrium : the blocks have no equilibrium at the upper end
    history : (F, failed pairs) of every trial, in the order of the search; all pairs where there is no equilibrium
    """

    factor: float | None
    bracket: tuple[float, float]
    lost_equilibrium: bool
    history: tuple[tuple[float, int], ...]


def all_pairs_failed(
    model: "Model | AssemblyModel",
    stiffness: JointStiffness,
    limit: float | None = None,
    growth: float = 1.5,
    relative: float = 1e-5,
    bound: float | None = None,
) -> AllPairsFailed:
    """Bracket and bisect the factor at which the first block fails (Figure 9 of the paper; Dawson et al. 1999).

    Parameters
    ----------
    limit : the factor above which there is no equilibrium; None: the search starts at 1
    growth : its iteration coefficient m > 1
    relative : width of the final bracket in parts of the factor
    bound : static bound of one block, above which no factor is tried
    """
    trials: _Trials = (
        _OneBlockTrials(model, stiffness, bound)
        if isinstance(model, Model)
        else _AssemblyTrials(model, stiffness)
    )
    history: list[tuple[float, int]] = []

    def failed(factor: float) -> bool:
        pairs, has_failed = trials.evaluate(factor)
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
    return AllPairsFailed(
        high, (low, high), high == limit or not trials.is_stable(high), tuple(history)
    )


class _Trials(Protocol):
    """Equilibrium states of blocks at trial factors."""

    def evaluate(self, factor: float) -> tuple[int, bool]:
        """Return the number of failed pairs at a factor, and whether a block has failed."""

    def is_stable(self, factor: float) -> bool:
        """Return whether all blocks are in equilibrium at a factor."""


class _OneBlockTrials:
    """Trials of one block, each from the largest factor so far at which some pair sticks.

    Every factor above the least at which equilibrium was lost, or all pairs had failed, fails too.
    """

    def __init__(self, model: Model, stiffness: JointStiffness, bound: float | None) -> None:
        self.model, self.stiffness = model, stiffness
        self.last_equilibrium: Equilibrium | None = None
        self.failed = math.inf if bound is None else bound * (1.0 + EQUILIBRIUM)

    def evaluate(self, factor: float) -> tuple[int, bool]:
        """Return failed pairs and failure at a factor, or at a smaller one on the path to it where no pair sticks."""
        count = len(self.model.control_area)
        if factor >= self.failed:
            return count, True
        state = equilibrium(
            self.model, factor, self.stiffness, self.last_equilibrium, until_all_failed=True
        )
        if not state.is_balanced or state.failed_pairs == count:
            self.failed = state.factor
            return count, True
        self.last_equilibrium = state
        return state.failed_pairs, False

    def is_stable(self, factor: float) -> bool:
        return equilibrium(self.model, factor, self.stiffness, self.last_equilibrium).is_balanced


class _AssemblyTrials:
    """Trials of many blocks, each from the largest factor so far at which all blocks are attached."""

    def __init__(self, model: "AssemblyModel", stiffness: JointStiffness) -> None:
        self.model, self.stiffness = model, stiffness
        self.attached: Settlement | None = None
        self.stable_factors: dict[float, bool] = {}

    def evaluate(self, factor: float) -> tuple[int, bool]:
        from slopekit.preie.motion.settlement import settlement

        at_rest = settlement(self.model, self.stiffness, factor, self.attached)
        self.stable_factors[factor] = at_rest is not None
        if at_rest is None:
            return len(self.model.control_area), True
        if blocks_detached(self.model, ~at_rest.slips & ~self.model.bolted).any():
            return at_rest.failed_pairs, True
        self.attached = at_rest
        return at_rest.failed_pairs, False

    def is_stable(self, factor: float) -> bool:
        return self.stable_factors[factor]


def blocks_detached(model: "AssemblyModel", sticks: Bools) -> Bools:
    """Return the blocks (n,) that no chain of sticking contacts joins to bedrock.

    A contact joins its two blocks where at least one of its friction forces (g,) sticks.
    """
    from scipy import sparse
    from scipy.sparse.csgraph import connected_components

    blocks = len(model.load)
    contact = model.group_contact[sticks]
    minus = np.where(model.minus[contact] < 0, blocks, model.minus[contact])  # bedrock is the last
    graph = sparse.coo_matrix(
        (np.ones(len(contact)), (model.plus[contact], minus)), shape=(blocks + 1, blocks + 1)
    )
    _, component = connected_components(graph, directed=False)
    detached: Bools = component[:blocks] != component[blocks]
    return detached
