"""Stiffness of an assembly in a band, and its Cholesky factors (LAPACK pbtrf).

Blocks of a slope touch their neighbours only: numbered from one end to the other (reverse Cuthill-McKee) their
stiffness lies in a narrow band, where LAPACK is faster than any sparse factorisation that Python can reach.
"""

from collections.abc import Callable

import numpy as np
from scipy import sparse
from scipy.linalg import lapack
from scipy.sparse.csgraph import reverse_cuthill_mckee

from slopekit.arrays import Floats, Ints
from slopekit.errors import Fault, SolverError
from slopekit.preie.assembly import AssemblyModel

_MOST_BYTES = 900_000_000
_MOST_TRIALS = 8


class BandedStiffness:
    """Where the stiffness of each contact goes in the band; `factored` makes a solver.

    Raises
    ------
    SolverError
        E504 the band does not fit into memory.
    """

    def __init__(self, model: AssemblyModel) -> None:
        self.model = model
        blocks, u = model.load.shape
        both = model.minus >= 0
        plus, minus = model.plus, model.minus
        graph = sparse.coo_matrix((np.ones(int(both.sum())), (plus[both], minus[both])), shape=(blocks, blocks))
        order = np.asarray(reverse_cuthill_mckee((graph + graph.T).tocsr(), True))
        place = np.empty(blocks, dtype=np.int64)
        place[order] = np.arange(blocks)
        widest = int(np.abs(place[plus[both]] - place[minus[both]]).max(initial=0))
        self.size, self.height = blocks * u, (widest + 1) * u
        if self.size * self.height * 8 > _MOST_BYTES:
            message = f"{blocks} blocks with a band of {self.height} need {self.size * self.height * 8e-9:.1f} GB"
            raise SolverError([Fault("E504", message, "", "Take fewer blocks, or larger ones.")])
        self.both = both
        self.order = (place[:, None] * u + np.arange(u)).ravel()  # where each unknown goes
        low_row, low_column = np.tril_indices(u)
        self.lower = (low_row, low_column)
        diagonal = [self._at(place[side][:, None] * u + low_row, place[side][:, None] * u + low_column)
                    for side in (plus, minus[both])]  # fmt: skip
        above = place[plus[both]] > place[minus[both]]
        row = np.where(above, place[plus[both]], place[minus[both]])
        column = np.where(above, place[minus[both]], place[plus[both]])
        a, b = np.divmod(np.arange(u * u), u)
        self.transposed = ~above
        across = self._at(row[:, None] * u + a, column[:, None] * u + b)
        self.index = np.concatenate([part.ravel() for part in (*diagonal, across)])

    def _at(self, row: Ints, column: Ints) -> Ints:
        at: Ints = column * self.height + (row - column)
        return at

    def factored(
        self, stiffness: Floats, shift: float, symmetric: bool = True, inertia: Floats | None = None
    ) -> Callable[[Floats], Floats]:
        """A solver of K x = b, with K = Σ Jᵀ S J of the contact stiffnesses S (k, u, u) and `shift` on its diagonal.

        Parameters
        ----------
        inertia : (n u,) added to the diagonal of a symmetric K
        shift : in parts of the diagonal and of its mean; it grows where K is not positive definite

        Returns
        -------
        Takes b (n u,) or (n u, r) and gives x of the same shape.

        Raises
        ------
        SolverError
            E505 no shift makes it positive definite.
        """
        if not symmetric:
            return self._factored_general(stiffness, shift)
        model, both = self.model, self.both
        on_plus = np.matmul(stiffness, model.plus_motion)
        plus_t = model.plus_motion.transpose(0, 2, 1)
        minus = model.minus_motion[both]
        row, column = self.lower
        first = np.matmul(plus_t, on_plus)[:, row, column]
        second = np.matmul(minus.transpose(0, 2, 1), np.matmul(stiffness[both], minus))[:, row, column]
        across = np.matmul(minus.transpose(0, 2, 1), on_plus[both])
        across = np.where(self.transposed[:, None, None], across, across.transpose(0, 2, 1))
        band = np.bincount(
            self.index, np.concatenate([first.ravel(), second.ravel(), across.ravel()]), self.size * self.height
        ).reshape(self.size, self.height)
        diagonal = band[:, 0].copy()
        if inertia is not None:
            diagonal[self.order] += inertia
        mean = float(np.abs(diagonal).mean())
        for _ in range(_MOST_TRIALS):
            trial = band.copy()
            trial[:, 0] = diagonal + shift * (diagonal + mean)
            factor, info = lapack.dpbtrf(trial.T, lower=1, overwrite_ab=1)
            if info == 0:
                break
            shift = max(100.0 * shift, 1e-16)
        else:
            raise SolverError([Fault("E505", "the stiffness of the assembly is not positive definite")])

        def solve(right: Floats) -> Floats:
            placed = np.empty_like(right)
            placed[self.order] = right
            found, _ = lapack.dpbtrs(factor, placed, lower=1)
            out: Floats = found[self.order]
            return out.reshape(right.shape)

        return solve

    def _factored_general(self, stiffness: Floats, shift: float) -> Callable[[Floats], Floats]:
        """The same for contact stiffnesses that are not symmetric, by LU (LAPACK gbtrf)."""
        model, both, u = self.model, self.both, self.model.unknowns
        band = self.height - 1
        place = self.order[::u] // u
        a, b = np.divmod(np.arange(u * u), u)
        plus, minus = place[model.plus], place[model.minus[both]]
        motion, other = model.plus_motion, model.minus_motion[both]
        on_plus, on_minus = np.matmul(stiffness, motion), np.matmul(stiffness[both], other)
        parts = (
            (plus, plus, np.matmul(motion.transpose(0, 2, 1), on_plus)),
            (minus, minus, np.matmul(other.transpose(0, 2, 1), on_minus)),
            (minus, plus[both], np.matmul(other.transpose(0, 2, 1), on_plus[both])),
            (plus[both], minus, np.matmul(motion[both].transpose(0, 2, 1), on_minus)),
        )
        rows = 3 * band + 1
        index = np.concatenate([
            ((column[:, None] * u + b) * rows + 2 * band + (row[:, None] * u + a) - (column[:, None] * u + b)).ravel()
            for row, column, _ in parts
        ])  # fmt: skip
        full = np.bincount(index, np.concatenate([part.ravel() for *_, part in parts]), self.size * rows)
        full = full.reshape(self.size, rows)
        diagonal = full[:, 2 * band]
        full[:, 2 * band] = diagonal + shift * (np.abs(diagonal) + float(np.abs(diagonal).mean()))
        factor, pivots, info = lapack.dgbtrf(full.T, band, band, overwrite_ab=1)
        if info != 0:
            raise SolverError([Fault("E505", "the stiffness of the assembly is singular")])

        def solve(right: Floats) -> Floats:
            placed = np.empty_like(right)
            placed[self.order] = right
            found, _ = lapack.dgbtrs(factor, band, band, placed, pivots)
            out: Floats = found[self.order]
            return out.reshape(right.shape)

        return solve
