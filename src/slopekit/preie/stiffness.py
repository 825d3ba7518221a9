"""Stiffness of an assembly, K = Σ Jᵀ S J over its contacts, and solvers of K x = b.

Three ways, the fastest for a model chosen once; ms of one symmetric (general) factorisation and assembly, one core:

===================  ========  =============  =============  =============
model                unknowns  dense          band           fronts
===================  ========  =============  =============  =============
columns of a slope         48  0.03 (0.03)    0.02 (0.02)    0.03 (0.05)
bench of 41 blocks        246  0.25 (0.43)    0.19 (0.20)    0.20 (0.32)
5 x 5 x 5 boxes           750  4.3 (8.6)      0.95 (1.9)     1.2 (2.2)
stack of 1,000           3000                 0.22 (0.38)    1.7 (3.8)
bench of 501             3006                 8.3 (17)       7.7 (14)
wall 50 x 100           15075                 36 (75)        25 (46)
bench of 7,251          43506                 3200 (-)       710 (1330)
===================  ========  =============  =============  =============

With compiled kernels the fronts of 304 blocks take 2.1 (3.0) ms for 5.1 (6.9), those of 4,860 boxes 0.55 (1.1) s for
1.1 (1.6).

Dense and band are LAPACK's. The third is multifrontal (Duff & Reid 1983) by nested dissection (George 1973): blocks are
halved by a least set of blocks between the halves, and so on; halves first, what separates them last, each in a dense
matrix of its own.
"""

import itertools
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy import sparse
from scipy.linalg import blas, lapack
from scipy.sparse.csgraph import breadth_first_order, maximum_bipartite_matching, reverse_cuthill_mckee

from slopekit.arrays import Bools, Floats, Ints
from slopekit.errors import Fault, SolverError
from slopekit.preie.assembly import AssemblyModel
from slopekit.preie.kernels import compiled
from slopekit.preie.patterns import compiled_contacts

_MOST_BYTES = 900_000_000
_MOST_TRIALS = 8
_LEAF = 96  # unknowns of pieces that are not halved again: half or twice as many take a tenth more time
_UNEVEN = 0.15  # of a piece, how far from its middle it may be cut
_ALIKE = 0.9  # cosine between normals of one joint set
_GROWTH = 1e8  # of multipliers, where pivots of one front only no longer do
_DENSE = 60  # unknowns from which the narrowest band is as fast, and the widest not slower
_DISSECT = 4e-3  # s a factorisation in a band takes, below which a dissection does not pay
_FRONT, _COMPILED_FRONT = 50e-6, 3e-6  # s that a front takes beside its work
_FINER = 4  # times smaller are pieces, and dissected is what takes so much less time, with compiled kernels

Solver = Callable[[Floats], Floats]


class Stiffness:
    """Where the stiffness of each contact goes; `factored` makes a solver.

    Parameters
    ----------
    way : Dense, Band or Fronts; the fastest by estimate where it is not given

    Raises
    ------
    SolverError
        E504 the factors do not fit into memory.
    """

    def __init__(self, model: AssemblyModel, way: "type[Dense | Band | Fronts] | None" = None) -> None:
        self.model, self.way = model, way
        self.motion = np.concatenate([model.plus_motion, model.minus_motion], axis=2)
        self.motion_t = np.ascontiguousarray(self.motion.transpose(0, 2, 1))
        self.contacts = compiled_contacts(model)
        self.plans = {True: self._planned(self._chosen(True))}
        self._dense_index: Ints | None = None

    def factored(
        self, stiffness: Floats, shift: float, symmetric: bool = True, inertia: Floats | None = None
    ) -> Solver:
        """A solver of K x = b, with K = Σ Jᵀ S J of the contact stiffnesses S (k, u, u) and `shift` on its diagonal.

        Parameters
        ----------
        symmetric : K is symmetric and is to be positive definite
        inertia : (n u,) added to the diagonal
        shift : in parts of the diagonal and of its mean; it grows where a symmetric K is not positive definite

        Returns
        -------
        Takes b (n u,) or (n u, r) and gives x of the same shape.

        Raises
        ------
        SolverError
            E504 the factors do not fit into memory; E505 K is singular, or no shift makes it positive definite.
        """
        if symmetric not in self.plans:
            self.plans[symmetric] = self._planned(self._chosen(symmetric))
        plan = self.plans[symmetric]
        values = stiffness
        if self.contacts is None:
            values = np.matmul(self.motion_t, np.matmul(stiffness, self.motion)).ravel()
        solve = plan.factored(values, shift, inertia)
        for _ in range(1, _MOST_TRIALS if symmetric else 1):
            if solve is not None:
                break
            shift = max(100.0 * shift, 1e-16)
            solve = plan.factored(values, shift, inertia)
        if solve is None and not symmetric and self.way is None and isinstance(plan.way, Fronts):
            # pivots from one front do not do: the band's come from wherever they are
            solve = self._planned(_fitting(Band(self.model, False))).factored(values, shift, inertia)
        if solve is not None:
            return solve
        what = "not positive definite" if symmetric else "singular"
        raise SolverError([Fault("E505", f"the stiffness of the assembly is {what}")])

    def dense(self, stiffness: Floats) -> Floats:
        """K itself, (n u, n u), of a small model."""
        model, u = self.model, self.model.unknowns
        size = model.load.size
        values = np.matmul(self.motion_t, np.matmul(stiffness, self.motion))
        if self._dense_index is None:
            side = np.stack([model.plus, np.where(model.minus < 0, len(model.load), model.minus)], axis=1)
            place = (side[:, :, None] * u + np.arange(u)).reshape(len(side), -1)
            row, column = np.broadcast_arrays(place[:, :, None], place[:, None, :])
            self._dense_index = np.where((row < size) & (column < size), row * size + column, size * size).ravel()
        summed = np.bincount(self._dense_index, values.ravel(), size * size + 1)
        matrix: Floats = summed[:-1].astype(np.float64).reshape(size, size)
        return matrix

    def _planned(self, way: "Dense | Band | Fronts") -> "_Plan":
        return _Plan(self.model, way, self.contacts)

    def _chosen(self, symmetric: bool) -> "Dense | Band | Fronts":
        if self.way is not None:
            return _fitting(self.way(self.model, symmetric))
        if self.model.load.size <= _DENSE:
            return Dense(self.model, symmetric)
        band = Band(self.model, symmetric)
        if band.seconds < _DISSECT / (1 if self.contacts is None else _FINER):
            return _fitting(band)
        fronts = Fronts(self.model, symmetric)
        return _fitting(fronts if fronts.seconds < band.seconds else band)


def _fitting(way: "Dense | Band | Fronts") -> "Dense | Band | Fronts":
    if way.bytes > _MOST_BYTES:
        message = f"the stiffness of {len(way.place)} blocks needs {way.bytes * 1e-9:.1f} GB"
        raise SolverError([Fault("E504", message, "", "Take fewer blocks, or larger ones.")])
    return way


class _Plan:
    """Which entries of the contacts' products Jᵀ S J (k, 2u, 2u) go where in the storage of one way."""

    def __init__(self, model: AssemblyModel, way: "Dense | Band | Fronts", contacts: Any = None) -> None:
        self.way, self._kernels = way, compiled() if contacts is not None else None
        u = model.unknowns
        blocks = np.stack([model.plus, model.minus], axis=1)
        unknown = (way.place[blocks][:, :, None] * u + np.arange(u)).reshape(len(blocks), 2 * u)
        there = np.repeat(blocks >= 0, u, axis=1)
        row, column = np.broadcast_arrays(unknown[:, :, None], unknown[:, None, :])
        kept = there[:, :, None] & there[:, None, :]
        self.kept = np.flatnonzero(kept & (row >= column) if way.symmetric else kept)
        parts = np.array_split(self.kept, 1 + len(self.kept) // 100_000)  # 3 million of 7,251 blocks
        self.index = np.concatenate([way.at(row.flat[part], column.flat[part]) for part in parts])
        self.order = (way.place[:, None] * u + np.arange(u)).ravel()  # where each unknown goes
        self.diagonal = way.at(self.order, self.order)
        if self._kernels is not None:
            self._plan = self._kernels.plan(contacts, way.symmetric, way.size, self.kept, self.index, self.diagonal)

    def factored(self, values: Floats, shift: float, inertia: Floats | None) -> Solver | None:
        """A solver, or None; compiled kernels take the contact stiffnesses themselves."""
        if self._kernels is not None:
            entries = np.zeros(self.way.size)
            self._kernels.assembled(self._plan, np.ascontiguousarray(values), shift, inertia, entries)
        else:
            entries = np.bincount(self.index, values[self.kept], self.way.size).view(np.float64)
            diagonal = entries[self.diagonal]
            if inertia is not None:
                diagonal += inertia
            sizes = np.abs(diagonal)
            own = diagonal if self.way.symmetric else sizes
            entries[self.diagonal] = diagonal + shift * (own + sizes.sum() / len(sizes))
        solve = self.way.factored(entries)
        if solve is None or isinstance(self.way, Dense):
            return solve
        inner, order = solve, self.order

        def solve_in_order(right: Floats) -> Floats:
            placed = np.empty_like(right)
            placed[order] = right
            found: Floats = inner(placed)[order]
            return found.reshape(right.shape)

        return solve_in_order


class Dense:
    """All of K, column by column."""

    def __init__(self, model: AssemblyModel, symmetric: bool) -> None:
        self.symmetric, self.unknowns = symmetric, model.load.size
        self.place = np.arange(len(model.load))
        self.size = self.unknowns**2
        self.bytes = 8 * self.size

    def at(self, row: Ints, column: Ints) -> Ints:
        """Where entries of K are stored."""
        return column * self.unknowns + row

    def factored(self, entries: Floats) -> Solver | None:
        """A solver, or None where K is singular or not positive definite; `entries` are lost."""
        matrix = entries.reshape(self.unknowns, self.unknowns).T
        if self.symmetric:
            factor, info = lapack.dpotrf(matrix, lower=1, clean=0, overwrite_a=1)
            return None if info else lambda right: lapack.dpotrs(factor, right, lower=1)[0].reshape(right.shape)
        factor, pivots, info = lapack.dgetrf(matrix, overwrite_a=1)
        return None if info else lambda right: lapack.dgetrs(factor, pivots, right)[0].reshape(right.shape)


class Band:
    """K in a band, blocks numbered from one end to the other (reverse Cuthill-McKee)."""

    def __init__(self, model: AssemblyModel, symmetric: bool) -> None:
        n, u = model.load.shape
        a, b = _touching(model)
        graph = sparse.coo_matrix((np.ones(len(a)), (a, b)), shape=(n, n))
        self.place = np.empty(n, dtype=np.int64)
        self.place[reverse_cuthill_mckee((graph + graph.T).tocsr(), True)] = np.arange(n)
        self.symmetric, self.unknowns = symmetric, n * u
        self.reach = (int(np.abs(self.place[a] - self.place[b]).max(initial=0)) + 1) * u - 1
        self.rows = (1 if symmetric else 3) * self.reach + 1
        self.size = self.unknowns * self.rows
        self.bytes = 8 * self.size
        work = (1.0 if symmetric else 3.0) * self.unknowns * self.reach**2
        self.seconds = work / 25e9 + self.unknowns * (1e-7 + self.reach * 3e-9)

    def at(self, row: Ints, column: Ints) -> Ints:
        """Where entries of K are stored."""
        at: Ints = column * self.rows + (row - column) + (0 if self.symmetric else 2 * self.reach)
        return at

    def factored(self, entries: Floats) -> Solver | None:
        """A solver, or None where K is singular or not positive definite; `entries` are lost."""
        band, reach = entries.reshape(self.unknowns, self.rows).T, self.reach
        if self.symmetric:
            factor, info = lapack.dpbtrf(band, lower=1, overwrite_ab=1)
            return None if info else lambda right: lapack.dpbtrs(factor, right, lower=1)[0]
        factor, pivots, info = lapack.dgbtrf(band, reach, reach, overwrite_ab=1)
        return None if info else lambda right: lapack.dgbtrs(factor, reach, reach, right, pivots)[0]


class Fronts:
    """K by nested dissection: for each piece or separator its own unknowns and those later ones that they touch.

    Its storage holds, front by front, the entries among its own unknowns (p, p), those of the later unknowns with them
    (q, p), and, of a K that is not symmetric, the transpose (q, p) of those of its own with the later ones.
    """

    def __init__(self, model: AssemblyModel, symmetric: bool) -> None:
        n, u = model.load.shape
        edges = np.unique(np.sort(_touching(model), axis=0), axis=1)
        self._kernels = compiled()
        leaf = _LEAF if self._kernels is None else _LEAF // _FINER
        # at least two blocks: halves of two would never be done, a cut beyond the second is the cheapest
        self.place, counts = _dissection(edges, _along_joints(model), max(leaf // u, 2))
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
        if self._kernels is not None:
            self._compiled = self._for_kernels(counts, children, later)
        self.fronts = [] if self._kernels is not None else [
            (
                int(starts[i] * u), int(own[i]), int(others[i]), int(offsets[i]),
                (later[i][:, None] * u + np.arange(u)).ravel(),
                [(child, *_runs(later[child], later[i], int(starts[i]), int(ends[i]), u)) for child in children[i]],
            )
            for i in range(len(counts))
        ]  # fmt: skip
        updates = others * others
        taken = np.array([int(updates[kids].sum()) for kids in children])
        self.bytes = 8 * (self.size + int((np.cumsum(updates) - np.cumsum(taken) + taken).max()))
        p, q = own.astype(float), others.astype(float)
        self.flops = float((p**3 / 3.0 + p * p * q + p * q * q).sum())
        work, moved = (1.0 if symmetric else 2.0) * np.array([self.flops, float((q * q).sum())])
        each = _FRONT if self._kernels is None else _COMPILED_FRONT
        self.seconds = float(work) / 30e9 + float(moved) * 3e-9 + each * len(counts)  # with two solutions

    def _for_kernels(self, counts: Ints, children: list[list[int]], later: list[Ints]) -> Any:
        """The fronts as the compiled kernels take them."""
        u, ends = self.u, np.cumsum(counts)
        starts, place = ends - counts, np.zeros(len(self.later_keys), dtype=np.int64)
        for parent, kids in enumerate(children):
            for child in kids:
                blocks, first = later[child], int(self.later_first[child])
                beyond = counts[parent] + np.searchsorted(later[parent], blocks)
                place[first : first + len(blocks)] = np.where(blocks < ends[parent], blocks - starts[parent], beyond)
        update, work = _places_in_turn([int(q * q) for q in self.others], children)
        numbers = [np.cumsum([0, *(len(part) for part in parts)]) for parts in (later, children)]
        return self._kernels.fronts(
            u, self.symmetric, int(ends[-1]) * u, self.size, work, self.starts, self.own, self.others,
            np.ascontiguousarray(self.offsets), update, *numbers,
            np.array([child for kids in children for child in kids], dtype=np.int64), np.concatenate(later), place,
        )  # fmt: skip

    def _factored_by_kernels(self, entries: Floats) -> Solver | None:
        kernels, fronts, pivots = self._kernels, self._compiled, np.empty(len(self.place) * self.u, dtype=np.intc)
        if not kernels.factored(fronts, _GROWTH, entries, pivots):
            return None

        def solve(right: Floats) -> Floats:
            found = right.T.copy()
            for one in found if found.ndim == 2 else found[None]:
                kernels.solved(fronts, entries, pivots, one)
            return found.T

        return solve

    def at(self, row: Ints, column: Ints) -> Ints:
        """Where entries of K are stored."""
        lower = row >= column
        first, last = np.where(lower, column, row), np.where(lower, row, column)
        front = self.owner[first // self.u]
        own, others, start = self.own[front], self.others[front], self.starts[front]
        block, part = np.divmod(last, self.u)
        found = np.searchsorted(self.later_keys, front * len(self.place) + block) - self.later_first[front]
        beyond = own * own + (first - start) * others + found * self.u + part + np.where(lower, 0, own * others)
        inside = (column - start) * own + row - start
        at: Ints = self.offsets[front] + np.where(last < start + own, inside, beyond)
        return at

    def factored(self, entries: Floats) -> Solver | None:
        """A solver, or None where K is singular or not positive definite; `entries` are lost."""
        if self._kernels is not None:
            return self._factored_by_kernels(entries)
        symmetric, done = self.symmetric, []
        updates: dict[int, Floats] = {}
        for i, (start, p, q, at, later, children) in enumerate(self.fronts):
            own = entries[at : at + p * p].reshape(p, p).T
            at += p * p
            below = entries[at : at + p * q].reshape(p, q).T
            beside = below if symmetric else entries[at + p * q : at + 2 * p * q].reshape(p, q).T
            rest = np.zeros((q, q)).T
            for child, inside, outside in children:
                more = updates.pop(child)
                for k, (a, b, c, d) in enumerate(inside):
                    for e, f, g, h in inside[k if symmetric else 0 :]:
                        own[g:h, c:d] += more[e:f, a:b]
                    for e, f, g, h in outside:
                        below[g:h, c:d] += more[e:f, a:b]
                        if not symmetric:
                            beside[g:h, c:d] += more[a:b, e:f].T
                for k, (a, b, c, d) in enumerate(outside):
                    for e, f, g, h in outside[k if symmetric else 0 :]:
                        rest[g:h, c:d] += more[e:f, a:b]
            if symmetric:
                factor, info = lapack.dpotrf(own, lower=1, clean=0, overwrite_a=1)
                swaps = None
            else:
                factor, pivots, info = lapack.dgetrf(own, overwrite_a=1)
                swaps = _swapped(pivots)
            if info:
                return None
            if q and symmetric:
                below = blas.dtrsm(1.0, factor, below, side=1, lower=1, trans_a=1, overwrite_b=1)
                updates[i] = blas.dsyrk(-1.0, below, 1.0, rest, lower=1, overwrite_c=1)
                beside = below
            elif q:
                below = blas.dtrsm(1.0, factor, below, side=1, overwrite_b=1)
                if not np.abs(below).max() < _GROWTH:
                    return None
                beside[:] = beside[:, swaps]
                beside = blas.dtrsm(1.0, factor, beside, side=1, lower=1, trans_a=1, diag=1, overwrite_b=1)
                updates[i] = blas.dgemm(-1.0, below, beside, 1.0, rest, trans_b=1, overwrite_c=1)
            done.append((start, start + p, later, factor, swaps, below, beside))

        def solve(right: Floats) -> Floats:
            found = right.copy()
            unit = 0 if symmetric else 1
            for start, end, later, factor, swaps, below, _ in done:
                own = found[start:end]
                if swaps is not None:
                    own[:] = own[swaps]
                blas.dtrsv(factor, own, lower=1, diag=unit, overwrite_x=1)
                if len(later):
                    found[later] -= below @ own
            for start, end, later, factor, _, _, beside in reversed(done):
                own = found[start:end]
                if len(later):
                    own -= found[later] @ beside
                blas.dtrsv(factor, own, lower=1 - unit, trans=1 - unit, overwrite_x=1)
            return found

        # dtrsv is 4 to 6 times as fast as dtrsm of two columns
        return lambda right: solve(right) if right.ndim == 1 else np.stack([solve(b) for b in right.T], axis=1)


def _touching(model: AssemblyModel) -> Ints:
    """The two blocks of each contact between moving blocks, (2, k)."""
    both = model.minus >= 0
    return np.stack([model.plus[both], model.minus[both]])


def _swapped(pivots: Ints) -> Ints:
    """The order that LAPACK's row exchanges end in."""
    order = list(range(len(pivots)))
    for k, other in enumerate(pivots.tolist()):
        order[k], order[other] = order[other], order[k]
    return np.array(order)


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


def _runs(blocks: Ints, later: Ints, start: int, end: int, u: int) -> tuple[Any, Any]:
    """Where unknowns of `blocks` are among those of a front, [start, end), and among its `later` ones.

    As runs (from, to, there from, there to), first those among its own. There are 4 to 7 of a child, about as many as
    it touches separators: adding slices, 1 ns an entry, beats indices, 3 ns.
    """
    own = blocks < end
    at = np.where(own, blocks - start, np.searchsorted(later, blocks))
    breaks = np.flatnonzero((np.diff(at) != 1) | (own[1:] != own[:-1])) + 1
    first, last = np.concatenate([[0], breaks]), np.append(breaks, len(blocks))
    runs = np.stack([first, last, at[first], at[first] + last - first], axis=1) * u
    inside = own[first]
    return runs[inside].tolist(), runs[~inside].tolist()


def _along_joints(model: AssemblyModel) -> Floats:
    """Coordinates of blocks along the normals of the joint sets, in blocks, with all their sums and differences.

    (d, n). Between blocks cut by joint sets the least separators are diagonals: of 7,251 blocks, planes along the sets
    alone take 36 Gflop, with the diagonals 14 (METIS: 13).
    """
    dimensions = [0, 1, 2] if model.unknowns == 6 else [0, 2]
    n, both = len(model.load), model.minus >= 0
    pairs = np.maximum(np.bincount(model.pair_contact, minlength=len(model.plus)), 1)
    of_block = np.concatenate([model.plus, model.minus]) + 1
    contacts = np.maximum(np.bincount(of_block, minlength=n + 1), 1)
    centres = np.empty((n, len(dimensions)))
    for k, axis in enumerate(dimensions):
        middle = np.bincount(model.pair_contact, model.points[:, axis], len(pairs)) / pairs
        centres[:, k] = (np.bincount(of_block, np.tile(middle, 2), n + 1) / contacts)[1:]
    normals = model.plus_motion[both, 0, : len(dimensions)]
    apart = centres[model.plus[both]] - centres[model.minus[both]]
    axes: list[Floats] = []
    while len(normals) and len(axes) < len(dimensions):
        cosines = normals @ normals[0]
        alike = np.abs(cosines) > _ALIKE
        normal = (normals[alike] * np.sign(cosines[alike])[:, None]).mean(axis=0)
        axes.append(normal / max(float(np.median(np.abs(apart[alike] @ normal))), 1e-9))
        normals, apart = normals[~alike], apart[~alike]
    axes = axes or [*np.eye(len(dimensions))]
    signs = [sign for sign in itertools.product((0, 1, -1), repeat=len(axes)) if sign > tuple(-s for s in sign)]
    coordinates: Floats = np.array(signs) @ np.array(axes) @ centres.T
    return coordinates


def _dissection(edges: Ints, coordinates: Floats, leaf: int) -> tuple[Ints, Ints]:
    """The place (n,) of each block in the order of elimination, and the blocks (f,) of the fronts in that order.

    All pieces of one level are halved at once. A piece is cut where, along one of the coordinates (d, n), the fewest
    blocks on one side have a neighbour on the other; what separates it is the least cover of the contacts cut.
    """
    n = coordinates.shape[1]
    piece = np.ones(n, dtype=np.int64)  # numbered as a heap: the halves of i are 2i and 2i + 1
    halving = np.ones(n, dtype=bool)
    a, b = edges
    every = np.arange(n)
    while True:
        ids, of, sizes = np.unique(piece, return_inverse=True, return_counts=True)
        halving &= sizes[of] > leaf
        if not halving.any():
            break
        inner = halving[a] & halving[b] & (piece[a] == piece[b])
        a, b = a[inner], b[inner]
        first = np.cumsum(sizes) - sizes
        off = np.abs((every - np.repeat(first, sizes) + 1) / np.repeat(sizes, sizes) - 0.5)
        best, beyond = np.full(len(ids), np.inf), np.zeros(n, dtype=bool)
        for along in coordinates:
            order = np.lexsort((along, of))
            rank = np.empty(n, dtype=np.int64)
            rank[order] = every
            low, high = np.minimum(rank[a], rank[b]), np.maximum(rank[a], rank[b])
            farthest, nearest = every.copy(), every.copy()
            np.maximum.at(farthest, low, high)
            np.minimum.at(nearest, high, low)
            # how many up to a place have a neighbour after it, and the other way round
            before = np.cumsum(1 - np.bincount(farthest, minlength=n))
            after = np.cumsum(np.bincount(nearest, minlength=n) - 1)
            cost = np.where(off <= max(_UNEVEN, 0.5 / leaf), (np.minimum(before, after) + 1e-3) * (1.0 + off), np.inf)
            least = np.minimum.reduceat(cost, first)
            cut = np.empty(len(ids), dtype=np.int64)
            found = np.flatnonzero(cost == np.repeat(least, sizes))
            cut[of[order[found]]] = found
            better = (least < best)[of]
            best = np.minimum(best, least)
            beyond = np.where(better, rank > cut[of], beyond)
        crossing = beyond[a] != beyond[b]
        near, far = np.where(beyond[a], b, a)[crossing], np.where(beyond[a], a, b)[crossing]
        halving &= ~_cover(near, far, n)
        piece = np.where(halving, 2 * piece + beyond, piece)
    level = np.frexp(piece)[1]
    after_all = ((piece + 1) << (level.max() - level)) * 64 - level  # children before parents
    first_neighbour = np.full(n, np.iinfo(np.int64).max)
    for one, other in (edges, edges[::-1]):
        np.minimum.at(first_neighbour, one, after_all[other])
    order = np.lexsort((first_neighbour, after_all))  # so that what a piece touches lies together
    place = np.empty(n, dtype=np.int64)
    place[order] = every
    return place, np.unique(after_all, return_counts=True)[1]


def _cover(near: Ints, far: Ints, n: int) -> Bools:
    """The least set of blocks (n,) with at least one of each pair near-far (König's theorem)."""
    covered = np.zeros(n, dtype=bool)
    if len(near) == 0:
        return covered
    lefts, left = np.unique(near, return_inverse=True)
    rights, right = np.unique(far, return_inverse=True)
    pairs = sparse.csr_matrix((np.ones(len(left)), (left, right)), shape=(len(lefts), len(rights)))
    partner = maximum_bipartite_matching(pairs, perm_type="column")
    matched, alone = np.flatnonzero(partner >= 0), np.flatnonzero(partner < 0)
    # paths from those alone: over any pair, back along the matching
    root, split = len(lefts) + len(rights), len(lefts)
    starts = np.concatenate([left, split + partner[matched], np.full(len(alone), root)])
    ends = np.concatenate([split + right, matched, alone])
    paths = sparse.csr_matrix((np.ones(len(starts)), (starts, ends)), shape=(root + 1, root + 1))
    reached = np.zeros(root + 1, dtype=bool)
    reached[breadth_first_order(paths, root, return_predecessors=False)] = True
    covered[lefts[~reached[:split]]] = True
    covered[rights[reached[split:root]]] = True
    return covered
