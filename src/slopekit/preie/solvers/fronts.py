"""The stiffness of an assembly factorised by compiled fronts: multifrontal (Duff & Reid 1983), nested dissection."""

from collections.abc import Callable
from typing import Any

import numpy as np

from slopekit.core.arrays import Floats, Ints
from slopekit.preie.kernels import compiled
from slopekit.preie.solvers.dissection import dissection, joint_set_coordinates, touching_blocks
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.tolerances import PIVOT_GROWTH

#: Pieces of so many unknowns are not halved again: half or twice as many take a tenth more time.
_LEAF_UNKNOWNS = 24
_FRONT_SECONDS = 3e-6  # s of overhead of one front

Solver = Callable[[Floats], Floats]


class Fronts:
    """The storage of K by nested dissection: for each piece or separator a front of its own and its later unknowns.

    Later unknowns are those of later fronts that it touches. The storage holds, front by front, the entries among its
    own unknowns (p, p), those of the later unknowns with its own (q, p), and, of a K that is not symmetric, the
    transpose (q, p) of those of its own with the later unknowns.
    """

    def __init__(self, model: AssemblyModel, symmetric: bool) -> None:
        u = model.unknowns
        # at least two blocks: with a leaf of one, pieces of two would be halved for ever (the cheapest cut is the end)
        self._plan_fronts(
            touching_blocks(model),
            joint_set_coordinates(model),
            max(_LEAF_UNKNOWNS // u, 2),
            u,
            symmetric,
        )

    @classmethod
    def of_graph(cls, edges: Ints, coordinates: Floats, leaf: int, unknowns: int) -> "Fronts":
        """Return the fronts of an unsymmetric matrix from the graph of its nodes.

        Parameters
        ----------
        edges : (2, k) nodes; coordinates : (d, n) along which the graph may be cut
        leaf : pieces of at most so many nodes are not halved
        unknowns : of each node
        """
        fronts = cls.__new__(cls)
        fronts._plan_fronts(edges, coordinates, leaf, unknowns, False)
        return fronts

    def _plan_fronts(
        self, edges: Ints, coordinates: Floats, leaf: int, u: int, symmetric: bool
    ) -> None:
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
        higher_neighbours = np.split(high[in_order], np.searchsorted(low[in_order], starts[1:]))
        children: list[list[int]] = [[] for _ in counts]
        later: list[Ints] = []
        for front, end in enumerate(ends):
            neighbours = np.unique(
                np.concatenate(
                    [higher_neighbours[front], *(later[child] for child in children[front])]
                )
            )
            later.append(neighbours[np.searchsorted(neighbours, end) :])
            if len(later[front]):
                children[self.owner[later[front][0]]].append(front)
        own_sizes, later_sizes = counts * u, np.array([len(blocks) for blocks in later]) * u
        offsets = np.concatenate(
            [
                [0],
                np.cumsum(
                    own_sizes * own_sizes + (1 if symmetric else 2) * own_sizes * later_sizes
                ),
            ]
        )
        self.size = int(offsets[-1])
        self.starts, self.own_sizes, self.later_sizes, self.offsets = (
            starts * u,
            own_sizes,
            later_sizes,
            offsets[:-1],
        )
        self.later_keys = np.concatenate([front * n + blocks for front, blocks in enumerate(later)])
        self.later_first = np.cumsum(later_sizes // u) - later_sizes // u
        self._compiled = (
            None if self._kernels is None else self._kernel_fronts(counts, children, later)
        )
        updates = later_sizes * later_sizes
        released = np.array([int(updates[child_fronts].sum()) for child_fronts in children])
        self.bytes = 8 * (
            self.size + int((np.cumsum(updates) - np.cumsum(released) + released).max())
        )
        p, q = own_sizes.astype(float), later_sizes.astype(float)
        self.flops = float((p**3 / 3.0 + p * p * q + p * q * q).sum())
        work, update_entries = (1.0 if symmetric else 2.0) * np.array(
            [self.flops, float((q * q).sum())]
        )
        self.seconds = (
            float(work) / 30e9 + float(update_entries) * 3e-9 + _FRONT_SECONDS * len(counts)
        )  # with two solutions

    def _kernel_fronts(self, counts: Ints, children: list[list[int]], later: list[Ints]) -> Any:
        """Return the fronts as the object that the compiled kernels take."""
        u, ends = self.u, np.cumsum(counts)
        starts, place = ends - counts, np.zeros(len(self.later_keys), dtype=np.int64)
        for parent, child_fronts in enumerate(children):
            for child in child_fronts:
                blocks, first = later[child], int(self.later_first[child])
                later_place = counts[parent] + np.searchsorted(later[parent], blocks)
                place[first : first + len(blocks)] = np.where(
                    blocks < ends[parent], blocks - starts[parent], later_place
                )
        update, work = _workspace_offsets([int(q * q) for q in self.later_sizes], children)
        list_starts = [
            np.cumsum([0, *(len(entries) for entries in lists)]) for lists in (later, children)
        ]
        return self._kernels.fronts(
            u,
            self.symmetric,
            int(ends[-1]) * u,
            self.size,
            work,
            self.starts,
            self.own_sizes,
            self.later_sizes,
            np.ascontiguousarray(self.offsets),
            update,
            *list_starts,
            np.array(
                [child for child_fronts in children for child in child_fronts], dtype=np.int64
            ),
            np.concatenate(later),
            place,
        )

    def storage_index(self, row: Ints, column: Ints) -> Ints:
        """Return the indices at which entries (row, column) of K are stored."""
        lower = row >= column
        first, last = np.where(lower, column, row), np.where(lower, row, column)
        front = self.owner[first // self.u]
        own_size, later_size, start = (
            self.own_sizes[front],
            self.later_sizes[front],
            self.starts[front],
        )
        block, component = np.divmod(last, self.u)
        position = (
            np.searchsorted(self.later_keys, front * len(self.place) + block)
            - self.later_first[front]
        )
        off_diagonal = (
            own_size * own_size
            + (first - start) * later_size
            + position * self.u
            + component
            + np.where(lower, 0, own_size * later_size)
        )
        diagonal = (column - start) * own_size + row - start
        index: Ints = self.offsets[front] + np.where(
            last < start + own_size, diagonal, off_diagonal
        )
        return index

    def factored(self, entries: Floats) -> Solver | None:
        """Return a solver, or None where K is singular or not positive definite, or without kernels.

        `entries` are overwritten.
        """
        kernels, fronts, pivots = (
            self._kernels,
            self._compiled,
            np.empty(len(self.place) * self.u, dtype=np.intc),
        )
        if kernels is None or not kernels.factored(fronts, PIVOT_GROWTH, entries, pivots):
            return None

        def solve(right: Floats) -> Floats:
            solution = right.T.copy()
            for right_side in solution if solution.ndim == 2 else solution[None]:
                kernels.solved(fronts, entries, pivots, right_side)
            return solution.T

        return solve


def _workspace_offsets(sizes: list[int], children: list[list[int]]) -> tuple[Ints, int]:
    """Return the offset of each front's update in one workspace, and the size of that workspace.

    An update lies there until its parent has assembled it. It takes the first gap that is large enough; those of its
    children are released after it.
    """
    offsets, occupied, workspace = (
        np.zeros(len(sizes), dtype=np.int64),
        dict[int, tuple[int, int]](),
        0,
    )
    for front, size in enumerate(sizes):
        offset = 0
        for start, end in sorted(occupied.values()):
            if start - offset >= size:
                break
            offset = max(offset, end)
        offsets[front], workspace = offset, max(workspace, offset + size)
        occupied[front] = offset, offset + size
        for child in children[front]:
            del occupied[child]
    return offsets, workspace
