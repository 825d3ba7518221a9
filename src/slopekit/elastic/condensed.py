"""Newton's step for many blocks: each condensed to the nodes of its contacts.

    d = B γ + D f + H q,   Bᵀ f + q = 0,   f = S d   (slopes S of the pairs)

D is that of one block beside the other, and has as many numbers as a block has pairs, squared. With its shapes P at
the pairs and its condensed stiffness K, motions of the block as a whole in it, the same step is

    (K - Pᵀ S P) u = Rᵀ balance - Pᵀ S off,   Δd = P u - off,   Δγ = R u,   R = (BᵀB)⁻¹ Bᵀ P

with a sparse matrix of the nodes on the contacts, whose order of elimination is sought once. Rigid blocks: K = 0,
u = γ, P = B, R = 1.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from slopekit.core.arrays import Floats, Ints
from slopekit.elastic.model import ElasticModel

_PIVOT = 0.01  # a pivot on the diagonal is taken where it is no smaller than this part of its column
_EXACT = 1e-6  # what is left of a step's right side, in parts of it
_FLOOR = 1e-4  # and of the step itself, where there is next to no right side

Step = tuple[Floats, Floats]


class Condensed:
    """Newton's steps of a model with sparse rows."""

    def __init__(self, model: ElasticModel) -> None:
        self.model = model
        size, unknowns = model.rows.shape
        if model.give is None:
            self.shapes, self.motions = model.rows.tocsr(), sparse.identity(unknowns, format="csr")
            self.stiffness: Any = None
            width = unknowns // max(len(model.seen), 1)
        else:
            at, stiff, motions, first = [], [], [], 0
            back = np.empty(unknowns, dtype=np.int64)
            place = 0
            for block, pairs, own in model.seen:
                shapes = block.shapes.tocoo()
                at.append((shapes.data, pairs[shapes.row], shapes.col + first))
                stiff.append(block.stiffness)
                motions.append(np.linalg.pinv(model.rows[pairs][:, own].toarray()) @ block.shapes)
                back[own] = place + np.arange(len(own))
                first, place = first + shapes.shape[1], place + len(own)
            values, rows, columns = (np.concatenate(one) for one in zip(*at, strict=True))
            self.shapes = sparse.csr_matrix((values, (rows, columns)), shape=(size, first))
            self.stiffness = sparse.block_diag(stiff, format="csr")
            self.motions = sparse.block_diag(motions, format="csr")[back]
            width = 1
        self.turned, self.turned_rows = self.shapes.T.tocsr(), model.rows.T.tocsr()
        self.order = self._order(width)

    def _order(self, width: int) -> Ints:
        """The order of elimination: minimum degree, of blocks where each has `width` unknowns."""
        pairs = len(self.model.area)
        ones = abs(self.shapes)
        joined = sparse.csr_matrix((np.ones(3 * pairs), (np.arange(3 * pairs) // 3, np.arange(3 * pairs)))) @ ones
        if width > 1:
            n = self.shapes.shape[1]
            joined = joined @ sparse.csr_matrix((np.ones(n), (np.arange(n), np.arange(n) // width)))
        pattern = joined.T @ joined
        if self.stiffness is not None:
            pattern = pattern + abs(self.stiffness)
        graph = pattern.tocsc()
        graph.data[:] = -1.0
        graph = graph + sparse.diags(np.asarray(-graph.sum(axis=1)).ravel() + 2.0)
        factor = splu(graph, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        order = np.argsort(factor.perm_c)
        found: Ints = (width * order[:, None] + np.arange(width)).ravel()
        return found

    def step(self, law: Any, off: Floats, balance: Floats, springs: Floats) -> Step | None:
        """The changes of d and γ that take away what is off; None where no factors are found that do.

        Parameters
        ----------
        law : (3n, 3n) sparse, slopes of the forces by d; springs : (b,) of the passive bolts, kN/m
        """
        model = self.model
        solve = self._factored(law)
        if solve is None:
            return None

        def once(off: Floats, balance: Floats) -> Step:
            u = solve(self.motions.T @ balance - self.turned @ (law @ off))
            return self.shapes @ u - off, self.motions @ u

        def left(step: Step, off: Floats, balance: Floats) -> Step:
            forces = law @ step[0]
            rest = off + step[0] - model.rows @ step[1]
            if model.give is not None:
                rest = rest - model.give @ forces
            return rest, balance + self.turned_rows @ forces

        def refined(off: Floats, balance: Floats) -> Step | None:
            found = once(off, balance)
            rest = left(found, off, balance)
            if not all(np.isfinite(one).all() for one in rest):
                return None
            more = once(*rest)
            found = found[0] + more[0], found[1] + more[1]
            rest = left(found, off, balance)
            exact = all(
                float(one @ one) <= _EXACT**2 * max(float(given @ given), _FLOOR**2 * float(moved @ moved))
                for one, given, moved in ((rest[0], off, found[0]), (rest[1], balance, law @ found[0]))
            )
            return found if exact else None

        found = refined(off, balance)
        active = np.flatnonzero(springs)
        if found is None or not len(active):
            return found
        pulled = model.bolt_rows[active]
        ways = list[Step]()
        for row in pulled:  # what a bolt's pull moves
            way = refined(np.zeros(len(off)) if model.give_load is None else model.give_load @ row, -row)
            if way is None:
                return None
            ways.append(way)
        small = np.diag(1.0 / springs[active]) - pulled @ np.array([way[1] for way in ways]).T
        try:
            pulls = np.linalg.solve(small, pulled @ found[1])
        except np.linalg.LinAlgError:
            return None
        for pull, way in zip(pulls.tolist(), ways, strict=True):
            found = found[0] + pull * way[0], found[1] + pull * way[1]
        return found

    def _factored(self, law: Any) -> Callable[[Floats], Floats] | None:
        matrix = -(self.turned @ (law @ self.shapes))
        if self.stiffness is not None:
            matrix = matrix + self.stiffness
        order = self.order
        try:
            factor = splu(
                matrix[order][:, order].tocsc(), permc_spec="NATURAL", diag_pivot_thresh=_PIVOT,
                options={"SymmetricMode": True},
            )  # fmt: skip
        except RuntimeError:  # singular
            return None

        def solve(right: Floats) -> Floats:
            out = np.empty(len(right))
            out[order] = factor.solve(right[order])
            return out

        return solve
