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

Dense and band are LAPACK's. The third needs compiled kernels, with which its 304 blocks take 2.1 (3.0) ms; the table is
NumPy's. It is multifrontal (Duff & Reid 1983) by nested dissection (George 1973): blocks are halved by a least set of
blocks between the halves, and so on; halves first, what separates them last, each in a dense matrix of its own.
"""

from typing import Any

import numpy as np
from scipy import sparse
from scipy.linalg import lapack
from scipy.sparse.csgraph import reverse_cuthill_mckee

from slopekit.core.arrays import Floats, Ints
from slopekit.core.errors import Fault, SolverError
from slopekit.preie.kernels import compiled
from slopekit.preie.solvers.dissection import touching_blocks
from slopekit.preie.solvers.fronts import Fronts, Solver
from slopekit.preie.solvers.work_limit import SECOND, factorisation, spend
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.system.patterns import compiled_contacts

_MOST_BYTES = 900_000_000  # of the factors of one model: what needs more is refused
_DENSE = 60  # unknowns from which the narrowest band is as fast, and the widest not slower
_DISSECT = 1e-3  # s a factorisation in a band takes, below which a dissection does not pay


class SparseStiffness:
    """Where the stiffness of each contact goes; `factored` makes a solver.

    Parameters
    ----------
    way : Dense, Band or Fronts; the fastest by estimate where it is not given
    symmetric : whether the first K is; the other kind is planned when it comes

    Raises
    ------
    SolverError
        E504 the factors do not fit into memory.
    """

    def __init__(
        self, model: AssemblyModel, way: "type[Dense | Band | Fronts] | None" = None, symmetric: bool = True
    ) -> None:
        self.model, self.way = model, way
        self.motion = np.concatenate([model.plus_motion, model.minus_motion], axis=2)
        self.motion_t = np.ascontiguousarray(self.motion.transpose(0, 2, 1))
        self.contacts = compiled_contacts(model)
        self.plans = {symmetric: self._planned(self._chosen(symmetric))}
        self._dense_index: Ints | None = None
        self._work = factorisation(model.load.size)

    def factored(
        self, stiffness: Floats, shift: float, symmetric: bool = True, inertia: Floats | None = None
    ) -> Solver:
        """A solver of K x = b, with K = Σ Jᵀ S J of the contact stiffnesses S (k, u, u) and `shift` on its diagonal.

        Parameters
        ----------
        symmetric : K is symmetric and is to be positive definite
        inertia : (n u,) added to the diagonal
        shift : in parts of the diagonal and of its mean

        Returns
        -------
        Takes b (n u,) or (n u, r) and gives x of the same shape.

        Raises
        ------
        SolverError
            E504 the factors do not fit into memory; E599 K is singular, or not positive definite.
        WorkSpentError
            The work that is allowed is done (`solvers.work_limit`).
        """
        if symmetric not in self.plans:
            self.plans[symmetric] = self._planned(self._chosen(symmetric))
        spend(self._work)
        plan = self.plans[symmetric]
        whole = self.contacts is not None
        values = stiffness if whole else np.matmul(self.motion_t, np.matmul(stiffness, self.motion)).ravel()
        solve = plan.factored(values, shift, inertia)
        if solve is None and not symmetric and self.way is None and isinstance(plan.way, Fronts):
            # pivots from one front do not do: the band's come from wherever they are
            band = Band(self.model, False)
            spend(SECOND, band.seconds)
            _fitting(band)
            solve = self._planned(band).factored(values, shift, inertia)
        if solve is not None:
            return solve
        what = "not positive definite" if symmetric else "singular"
        raise SolverError([Fault("E599", f"the stiffness of the assembly is {what}")])

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
        return summed[:-1].astype(np.float64).reshape(size, size)

    def _planned(self, way: "Dense | Band | Fronts") -> "_Plan":
        return _Plan(self.model, way, self.contacts)

    def _chosen(self, symmetric: bool) -> "Dense | Band | Fronts":
        if self.way is not None:
            return _fitting(self.way(self.model, symmetric))
        if self.model.load.size <= _DENSE:
            return Dense(self.model, symmetric)
        band = Band(self.model, symmetric)
        if band.seconds < _DISSECT or self.contacts is None:
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
            solution: Floats = inner(placed)[order]
            return solution.reshape(right.shape)

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
        a, b = touching_blocks(model)
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
