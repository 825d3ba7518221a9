"""The stiffness of an assembly factorised by compiled fronts: multifrontal (Duff & Reid 1983), nested dissection."""

from collections.abc import Callable
from typing import Any

import numpy as np

from slopekit.core.arrays import Floats, Ints
from slopekit.preie.kernels import compiled
from slopekit.preie.solvers.dissection import along_joints, dissection, touching_blocks
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.tolerances import PIVOT_GROWTH

_LEAF = 24  # unknowns of pieces that are not halved again: half or twice as many take a tenth more time
_FRONT = 3e-6  # s that a front takes beside its work

Solver = Callable[[Floats], Floats]


class Fronts:
    """K by nested dissection: for each piece or separator its own unknowns and those later ones that they touch.

    Its storage holds, front by front, the entries among its own unknowns (p, p), those of the later unknowns with them
    (q, p), and, of a K that is not symmetric, the transpose (q, p) of those of its own with the later ones.
    """

    def __init__(self, model: AssemblyModel, symmetric: bool) -> None:
        u = model.unknowns
        # at least two blocks: halves of two would never be done, a cut beyond the second is the cheapest
        self._laid_out(touching_blocks(model), along_joints(model), max(_LEAF // u, 2), u, symmetric)

    @classmethod
    def of_graph(cls, edges: Ints, coordinates: Floats, leaf: int, unknowns: int) -> "Fronts":
        """Those of a matrix that is not symmetric, by the nodes that it joins.

        Parameters
        ----------
        edges : (2, k) nodes; coordinates : (d, n) along which they may be cut; leaf : nodes of pieces that are not
        unknowns : of each node
        """
        made = cls.__new__(cls)
        made._laid_out(edges, coordinates, leaf, unknowns, False)
        return made

    def _laid_out(self, edges: Ints, coordinates: Floats, leaf: int, u: int, symmetric: bool) -> None:
        n = coordinates.shape[1]
        low, high = np.sort(edges, axis=0)
        edges = np.stack(np.divmod(np.unique(low * n + high), n))
        self._kernels = compiled()
        self.place, counts = dissection(edges, coordinates, leaf)
        self.symmetric, self.u = symmetric, u
        ends = np.cumsum(counts)
        starts = ends - counts
        self.owner = np.repeat(np.arange(len(counts)), counts)
        low, high = np.sort(self.place[edges], axis=0)
        in_order = np.argsort(low, kind="stable")
        touched = np.split(high[in_order], np.searchsorted(low[in_order], starts[1:]))
        children: list[list[int]] = [[] for _ in counts]
        later: list[Ints] = []
        for front, end in enumerate(ends):
            seen = np.unique(np.concatenate([touched[front], *(later[child] for child in children[front])]))
            later.append(seen[np.searchsorted(seen, end) :])
            if len(later[front]):
                children[self.owner[later[front][0]]].append(front)
        own, others = counts * u, np.array([len(blocks) for blocks in later]) * u
        offsets = np.concatenate([[0], np.cumsum(own * own + (1 if symmetric else 2) * own * others)])
        self.size = int(offsets[-1])
        self.starts, self.own, self.others, self.offsets = starts * u, own, others, offsets[:-1]
        self.later_keys = np.concatenate([front * n + blocks for front, blocks in enumerate(later)])
        self.later_first = np.cumsum(others // u) - others // u
        self._compiled = None if self._kernels is None else self._for_kernels(counts, children, later)
        updates = others * others
        taken = np.array([int(updates[below].sum()) for below in children])
        self.bytes = 8 * (self.size + int((np.cumsum(updates) - np.cumsum(taken) + taken).max()))
        p, q = own.astype(float), others.astype(float)
        self.flops = float((p**3 / 3.0 + p * p * q + p * q * q).sum())
        work, moved = (1.0 if symmetric else 2.0) * np.array([self.flops, float((q * q).sum())])
        self.seconds = float(work) / 30e9 + float(moved) * 3e-9 + _FRONT * len(counts)  # with two solutions

    def _for_kernels(self, counts: Ints, children: list[list[int]], later: list[Ints]) -> Any:
        """The fronts as the compiled kernels take them."""
        u, ends = self.u, np.cumsum(counts)
        starts, place = ends - counts, np.zeros(len(self.later_keys), dtype=np.int64)
        for parent, below in enumerate(children):
            for child in below:
                blocks, first = later[child], int(self.later_first[child])
                beyond = counts[parent] + np.searchsorted(later[parent], blocks)
                place[first : first + len(blocks)] = np.where(blocks < ends[parent], blocks - starts[parent], beyond)
        update, work = _places_in_turn([int(q * q) for q in self.others], children)
        numbers = [np.cumsum([0, *(len(part) for part in parts)]) for parts in (later, children)]
        return self._kernels.fronts(
            u, self.symmetric, int(ends[-1]) * u, self.size, work, self.starts, self.own, self.others,
            np.ascontiguousarray(self.offsets), update, *numbers,
            np.array([child for below in children for child in below], dtype=np.int64), np.concatenate(later), place,
        )  # fmt: skip

    def at(self, row: Ints, column: Ints) -> Ints:
        """Where entries of K are stored."""
        lower = row >= column
        first, last = np.where(lower, column, row), np.where(lower, row, column)
        front = self.owner[first // self.u]
        own, others, start = self.own[front], self.others[front], self.starts[front]
        block, part = np.divmod(last, self.u)
        position = np.searchsorted(self.later_keys, front * len(self.place) + block) - self.later_first[front]
        beyond = own * own + (first - start) * others + position * self.u + part + np.where(lower, 0, own * others)
        inside = (column - start) * own + row - start
        at: Ints = self.offsets[front] + np.where(last < start + own, inside, beyond)
        return at

    def factored(self, entries: Floats) -> Solver | None:
        """A solver, or None where K is singular or not positive definite, or no kernel is there; `entries` are lost."""
        kernels, fronts, pivots = self._kernels, self._compiled, np.empty(len(self.place) * self.u, dtype=np.intc)
        if kernels is None or not kernels.factored(fronts, PIVOT_GROWTH, entries, pivots):
            return None

        def solve(right: Floats) -> Floats:
            solution = right.T.copy()
            for one in solution if solution.ndim == 2 else solution[None]:
                kernels.solved(fronts, entries, pivots, one)
            return solution.T

        return solve


def _places_in_turn(sizes: list[int], children: list[list[int]]) -> tuple[Ints, int]:
    """Where in one workspace the update of each front is kept until its parent has taken it, and how much that needs.

    The first gap that is large enough; a front's own is made before those of its children are given back.
    """
    places, live, most = np.zeros(len(sizes), dtype=np.int64), dict[int, tuple[int, int]](), 0
    for front, size in enumerate(sizes):
        at = 0
        for start, end in sorted(live.values()):
            if start - at >= size:
                break
            at = max(at, end)
        places[front], most = at, max(most, at + size)
        live[front] = at, at + size
        for child in children[front]:
            del live[child]
    return places, most
