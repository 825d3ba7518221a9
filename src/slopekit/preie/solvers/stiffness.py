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
NumPy's. It is multifrontal (Duff & Reid 1983) by nested dissection (George 1973): blocks are halved recursively by a
least separating set; halves are eliminated first, separators last, each in a dense matrix of its own.
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
from slopekit.preie.solvers.work_limit import UNITS_PER_SECOND, factorisation, spend
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.system.patterns import compiled_contacts

_MAX_BYTES = 900_000_000  # memory for the factors of one model; E504 above
_DENSE_UNKNOWNS = 60  # unknowns from which the narrowest band is as fast, and the widest not slower
_DISSECTION_SECONDS = 1e-3  # s of a factorisation in a band, below which a dissection does not pay


class SparseStiffness:
    """Assemble and factorise the stiffness K of a model, with the places of its contacts' stiffnesses found once.

    Parameters
    ----------
    storage : Dense, Band or Fronts; None takes the fastest by estimate
    symmetric : whether the first K is symmetric; the other kind is planned when it is needed

    Raises
    ------
    SolverError
        E504 the factors do not fit into memory.
    """

    def __init__(
        self,
        model: AssemblyModel,
        storage: "type[Dense | Band | Fronts] | None" = None,
        symmetric: bool = True,
    ) -> None:
        self.model, self.storage = model, storage
        self.motion = np.concatenate([model.plus_motion, model.minus_motion], axis=2)
        self.motion_t = np.ascontiguousarray(self.motion.transpose(0, 2, 1))
        self.contacts = compiled_contacts(model)
        self.plans = {symmetric: self._assembly_plan(self._fastest_storage(symmetric))}
        self._dense_index: Ints | None = None
        self._work = factorisation(model.load.size)

    def factored(
        self, stiffness: Floats, shift: float, symmetric: bool = True, inertia: Floats | None = None
    ) -> Solver:
        """Return a solver of K x = b, with K = Σ Jᵀ S J of the contact stiffnesses S (k, u, u) and a shifted diagonal.

        Parameters
        ----------
        symmetric : K is symmetric and is to be positive definite
        inertia : (n u,) added to the diagonal
        shift : added to the diagonal, as a fraction of it and of its mean

        Returns
        -------
        Takes b (n u,) or (n u, r) and gives x of the same shape.

        Raises
        ------
        SolverError
            E504 the factors do not fit into memory; E599 K is singular, or not positive definite.
        WorkSpentError
            The budget of work is spent (`solvers.work_limit`).
        """
        if symmetric not in self.plans:
            self.plans[symmetric] = self._assembly_plan(self._fastest_storage(symmetric))
        spend(self._work)
        plan = self.plans[symmetric]
        is_compiled = self.contacts is not None
        values = (
            stiffness
            if is_compiled
            else np.matmul(self.motion_t, np.matmul(stiffness, self.motion)).ravel()
        )
        solve = plan.factored(values, shift, inertia)
        if (
            solve is None
            and not symmetric
            and self.storage is None
            and isinstance(plan.storage, Fronts)
        ):
            # pivots from within a front do not suffice: a band takes pivots from any row
            band = Band(self.model, False)
            spend(UNITS_PER_SECOND, band.seconds)
            _within_memory(band)
            solve = self._assembly_plan(band).factored(values, shift, inertia)
        if solve is not None:
            return solve
        defect = "not positive definite" if symmetric else "singular"
        raise SolverError([Fault("E599", f"the stiffness of the assembly is {defect}")])

    def dense(self, stiffness: Floats) -> Floats:
        """Return K as a dense matrix (n u, n u), for small models."""
        model, u = self.model, self.model.unknowns
        size = model.load.size
        values = np.matmul(self.motion_t, np.matmul(stiffness, self.motion))
        if self._dense_index is None:
            side = np.stack(
                [model.plus, np.where(model.minus < 0, len(model.load), model.minus)], axis=1
            )
            place = (side[:, :, None] * u + np.arange(u)).reshape(len(side), -1)
            row, column = np.broadcast_arrays(place[:, :, None], place[:, None, :])
            self._dense_index = np.where(
                (row < size) & (column < size), row * size + column, size * size
            ).ravel()
        summed = np.bincount(self._dense_index, values.ravel(), size * size + 1)
        return summed[:-1].astype(np.float64).reshape(size, size)

    def _assembly_plan(self, storage: "Dense | Band | Fronts") -> "_Plan":
        return _Plan(self.model, storage, self.contacts)

    def _fastest_storage(self, symmetric: bool) -> "Dense | Band | Fronts":
        if self.storage is not None:
            return _within_memory(self.storage(self.model, symmetric))
        if self.model.load.size <= _DENSE_UNKNOWNS:
            return Dense(self.model, symmetric)
        band = Band(self.model, symmetric)
        if band.seconds < _DISSECTION_SECONDS or self.contacts is None:
            return _within_memory(band)
        fronts = Fronts(self.model, symmetric)
        return _within_memory(fronts if fronts.seconds < band.seconds else band)


def _within_memory(storage: "Dense | Band | Fronts") -> "Dense | Band | Fronts":
    if storage.bytes > _MAX_BYTES:
        message = (
            f"the stiffness of {len(storage.place)} blocks needs {storage.bytes * 1e-9:.1f} GB"
        )
        raise SolverError([Fault("E504", message, "", "Take fewer blocks, or larger ones.")])
    return storage


class _Plan:
    """The places in one storage of the entries of the contacts' products Jᵀ S J (k, 2u, 2u)."""

    def __init__(
        self, model: AssemblyModel, storage: "Dense | Band | Fronts", contacts: Any = None
    ) -> None:
        self.storage, self._kernels = storage, compiled() if contacts is not None else None
        u = model.unknowns
        blocks = np.stack([model.plus, model.minus], axis=1)
        unknown = (storage.place[blocks][:, :, None] * u + np.arange(u)).reshape(len(blocks), 2 * u)
        is_unknown = np.repeat(blocks >= 0, u, axis=1)
        row, column = np.broadcast_arrays(unknown[:, :, None], unknown[:, None, :])
        is_stored = is_unknown[:, :, None] & is_unknown[:, None, :]
        self.stored_entries = np.flatnonzero(
            is_stored & (row >= column) if storage.symmetric else is_stored
        )
        chunks = np.array_split(
            self.stored_entries, 1 + len(self.stored_entries) // 100_000
        )  # 3 million of 7,251 blocks
        self.index = np.concatenate(
            [storage.storage_index(row.flat[chunk], column.flat[chunk]) for chunk in chunks]
        )
        self.order = (storage.place[:, None] * u + np.arange(u)).ravel()  # the row of each unknown
        self.diagonal = storage.storage_index(self.order, self.order)
        if self._kernels is not None:
            self._plan = self._kernels.plan(
                contacts,
                storage.symmetric,
                storage.size,
                self.stored_entries,
                self.index,
                self.diagonal,
            )

    def factored(self, values: Floats, shift: float, inertia: Floats | None) -> Solver | None:
        """Return a solver, or None where K is singular or not positive definite.

        values : entries of Jᵀ S J, flat; with compiled kernels the contact stiffnesses S (k, u, u) themselves
        """
        if self._kernels is not None:
            entries = np.zeros(self.storage.size)
            self._kernels.assembled(
                self._plan, np.ascontiguousarray(values), shift, inertia, entries
            )
        else:
            entries = np.bincount(self.index, values[self.stored_entries], self.storage.size).view(
                np.float64
            )
            diagonal = entries[self.diagonal]
            if inertia is not None:
                diagonal += inertia
            sizes = np.abs(diagonal)
            added = diagonal if self.storage.symmetric else sizes
            entries[self.diagonal] = diagonal + shift * (added + sizes.sum() / len(sizes))
        solve = self.storage.factored(entries)
        if solve is None or isinstance(self.storage, Dense):
            return solve
        inner, order = solve, self.order

        def solve_in_order(right: Floats) -> Floats:
            ordered = np.empty_like(right)
            ordered[order] = right
            solution: Floats = inner(ordered)[order]
            return solution.reshape(right.shape)

        return solve_in_order


class Dense:
    """The storage of all of K, column by column."""

    def __init__(self, model: AssemblyModel, symmetric: bool) -> None:
        self.symmetric, self.unknowns = symmetric, model.load.size
        self.place = np.arange(len(model.load))
        self.size = self.unknowns**2
        self.bytes = 8 * self.size

    def storage_index(self, row: Ints, column: Ints) -> Ints:
        """Return the indices at which entries (row, column) of K are stored."""
        return column * self.unknowns + row

    def factored(self, entries: Floats) -> Solver | None:
        """Return a solver, or None where K is singular or not positive definite; `entries` are overwritten."""
        matrix = entries.reshape(self.unknowns, self.unknowns).T
        if self.symmetric:
            factor, info = lapack.dpotrf(matrix, lower=1, clean=0, overwrite_a=1)
            return (
                None
                if info
                else lambda right: lapack.dpotrs(factor, right, lower=1)[0].reshape(right.shape)
            )
        factor, pivots, info = lapack.dgetrf(matrix, overwrite_a=1)
        return (
            None
            if info
            else lambda right: lapack.dgetrs(factor, pivots, right)[0].reshape(right.shape)
        )


class Band:
    """The storage of K in a band, with blocks numbered by reverse Cuthill-McKee."""

    def __init__(self, model: AssemblyModel, symmetric: bool) -> None:
        n, u = model.load.shape
        a, b = touching_blocks(model)
        graph = sparse.coo_matrix((np.ones(len(a)), (a, b)), shape=(n, n))
        self.place = np.empty(n, dtype=np.int64)
        self.place[reverse_cuthill_mckee((graph + graph.T).tocsr(), True)] = np.arange(n)
        self.symmetric, self.unknowns = symmetric, n * u
        self.half_bandwidth = (
            int(np.abs(self.place[a] - self.place[b]).max(initial=0)) + 1
        ) * u - 1
        self.rows = (1 if symmetric else 3) * self.half_bandwidth + 1
        self.size = self.unknowns * self.rows
        self.bytes = 8 * self.size
        work = (1.0 if symmetric else 3.0) * self.unknowns * self.half_bandwidth**2
        self.seconds = work / 25e9 + self.unknowns * (1e-7 + self.half_bandwidth * 3e-9)

    def storage_index(self, row: Ints, column: Ints) -> Ints:
        """Return the indices at which entries (row, column) of K are stored."""
        index: Ints = (
            column * self.rows + (row - column) + (0 if self.symmetric else 2 * self.half_bandwidth)
        )
        return index

    def factored(self, entries: Floats) -> Solver | None:
        """Return a solver, or None where K is singular or not positive definite; `entries` are overwritten."""
        band, half_bandwidth = entries.reshape(self.unknowns, self.rows).T, self.half_bandwidth
        if self.symmetric:
            factor, info = lapack.dpbtrf(band, lower=1, overwrite_ab=1)
            return None if info else lambda right: lapack.dpbtrs(factor, right, lower=1)[0]
        factor, pivots, info = lapack.dgbtrf(band, half_bandwidth, half_bandwidth, overwrite_ab=1)
        return (
            None
            if info
            else lambda right: lapack.dgbtrs(factor, half_bandwidth, half_bandwidth, right, pivots)[
                0
            ]
        )
