"""The paper's criterion for many blocks: a block has failed when no chain of sticking contacts ties it to bedrock.

For one block it is the criterion of §3.3 (every node pair slips or debonds; `preie.reduction`). Like that one it
depends on the stiffness of the contacts and is reported beside the limit, never instead of it. A block that topples
turns about a pair that sticks: nothing unties it, and the search ends where the blocks no longer stand.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from slopekit.arrays import Bools, Floats, frozen
from slopekit.preie.assembly import AssemblyModel
from slopekit.preie.contact import JointStiffness
from slopekit.preie.rest import AtRest, ElasticBed

_APPROACH = (0.25, 0.5, 0.75, 0.9, 0.97, 0.99)  # parts of the limit: each is near enough to start the next from
_DOWN = tuple(0.25**k for k in range(6))  # first trials where there is no limit
_LEAST = 1e-6


@dataclass(frozen=True, slots=True)
class UntiedSearch:
    """The factors at which the first block and the last come untied, and the way there.

    Attributes
    ----------
    factor : smallest F found at which some block is untied or the blocks no longer stand; None where neither was
        found, or where they stand at no factor tried (`lost_equilibrium`): a bed without stress may let columns
        topple that their neighbours could hold
    bracket : (F with every block tied, factor)
    all_factor, all_bracket : the same for the F at which every block is untied
    lost_equilibrium, all_lost_equilibrium : at that factor the blocks do not stand, or it is the limit
    untied : (n,) the blocks untied at `factor`; none where that is where equilibrium is lost
    untied_at : (n,) smallest F tried at which each block was untied, infinite for those that never were
    history : (F, untied blocks, failed friction forces) of every trial in its order; -1 where the blocks do not stand
    """

    factor: float | None
    bracket: tuple[float, float]
    lost_equilibrium: bool
    all_factor: float | None
    all_bracket: tuple[float, float]
    all_lost_equilibrium: bool
    untied: Bools
    untied_at: Floats
    history: tuple[tuple[float, int, int], ...]


def blocks_untied(model: AssemblyModel, at_rest: AtRest) -> Bools:
    """The blocks that no chain of sticking contacts ties to bedrock, (n,).

    A contact ties its two blocks where at least one of its friction forces sticks.
    """
    blocks = len(model.load)
    contact = model.group_contact[at_rest.sticks]
    minus = np.where(model.minus[contact] < 0, blocks, model.minus[contact])  # bedrock is the last
    graph = sparse.coo_matrix((np.ones(len(contact)), (model.plus[contact], minus)), shape=(blocks + 1, blocks + 1))
    _, part = connected_components(graph, directed=False)
    untied: Bools = part[:blocks] != part[blocks]
    return untied


def all_blocks_untied(
    model: AssemblyModel, stiffness: JointStiffness, limit: float | None = None, relative: float = 1e-4,
    growth: float = 1.5,
) -> UntiedSearch:  # fmt: skip
    """Bracket and bisect the factors at which the first block and the last come untied.

    Parameters
    ----------
    limit : the limit factor of safety, above which nothing stands; None: found by walking up from 1
    relative : width of the final brackets in parts of the factor
    growth : of the trial factors where there is no limit

    Raises
    ------
    SolverError
        E504 the model is too large for memory.
    """
    search = _Search(model, ElasticBed(model, stiffness), relative)
    blocks = len(model.load)
    for part in _APPROACH if limit is not None else _DOWN:
        if (limit is None and search.found) or part * (limit or 1.0) >= search.lost:
            break
        search.walk(part * (limit or 1.0))
    lowest = min(search.found, default=0.0)
    while search.lowest_untied(1) == lowest > _LEAST:  # also where nothing stands: 0 is no untied factor
        search.walk(_DOWN[1] * lowest)
        if min(search.found) == lowest:
            break
        lowest = min(search.found)
    if limit is not None:
        if search.found and search.lost > limit:
            search.walk(limit * (1.0 - 0.5 * relative))
        search.lost = min(search.lost, limit)
    high = max(search.found, default=math.inf)
    while min(search.lost, search.lowest_untied(blocks)) == math.inf and high < 1.0 / _LEAST:
        high *= growth
        search.walk(high)
    if not search.found:
        none = np.zeros(blocks, dtype=bool)
        bracket = (0.0, min(factor for factor, *_ in search.history))
        return UntiedSearch(
            None, bracket, True, None, bracket, True, none, frozen(search.untied_at), tuple(search.history)
        )
    first = search.bisected(1)
    last = search.bisected(blocks)
    factor, everywhere = first[1], last[1]
    there = search.found.get(factor)
    return UntiedSearch(
        factor if math.isfinite(factor) else None, first, factor >= search.lost,
        everywhere if math.isfinite(everywhere) else None, last, everywhere >= search.lost,
        there.untied if there is not None else np.zeros(blocks, dtype=bool),
        frozen(search.untied_at), tuple(search.history),
    )  # fmt: skip


@dataclass(frozen=True, slots=True)
class _Trial:
    state: AtRest
    untied: Bools
    count: int


class _Search:
    """Trials by their factor, all of which stand; `lost` is the smallest factor above one of them that did not."""

    def __init__(self, model: AssemblyModel, bed: ElasticBed, relative: float) -> None:
        self.model, self.bed, self.relative = model, bed, relative
        self.found: dict[float, _Trial] = {}
        self.lost = math.inf
        self.untied_at = np.full(len(model.load), np.inf)
        self.history: list[tuple[float, int, int]] = []

    def walk(self, factor: float) -> None:
        """Go to the factor from the nearest one below."""
        below = [known for known in self.found if known < factor]
        start = self.found[max(below)].state if below else None
        for state in self.bed.path(factor, start, 0.5 * self.relative):
            if not state.stands:
                if self.found and state.factor > min(self.found):
                    self.lost = min(self.lost, state.factor)
                self.history.append((state.factor, -1, -1))
                return
            untied = blocks_untied(self.model, state)
            count = int(untied.sum())
            self.found[state.factor] = _Trial(state, untied, count)
            self.untied_at = np.where(untied, np.minimum(self.untied_at, state.factor), self.untied_at)
            self.history.append((state.factor, count, state.failed - len(self.model.bolts)))  # bolts never stick

    def lowest_untied(self, blocks: int) -> float:
        """Smallest factor with so many blocks untied."""
        return min((factor for factor, trial in self.found.items() if trial.count >= blocks), default=math.inf)

    def bisected(self, blocks: int) -> tuple[float, float]:
        """The bracket of the factor at which so many blocks are untied or equilibrium is lost."""
        last = (-1.0, -1.0)
        while True:
            high = min(self.lowest_untied(blocks), self.lost)
            low = max((factor for factor in self.found if factor < high), default=0.0)
            narrow = high - low <= self.relative * low or high < _LEAST
            if not math.isfinite(high) or narrow or (low, high) == last:  # below which nothing stands
                return low, high
            last = (low, high)
            self.walk(0.5 * (low + high))
