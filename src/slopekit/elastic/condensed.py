"""Elastic blocks, each condensed to the nodes of its contacts, and Newton's step of all of them by fronts.

    K w = Pᵀ f + G q,   d = B γ + P w,   f = A law(d; F)

w are the displacements of those nodes of a block beside its motion γ, P its shapes at the pairs, K what is left of its
stiffness there and G of its load (`CondensedBlock`). What is off of the first is the unbalance of the blocks too,
since motions Z as a whole are among the w: Zᵀ Pᵀ = Bᵀ, Zᵀ G = 1, Zᵀ K = 0. With the slopes S of the pairs the step is

    (K - Pᵀ S P) u = r,   Δγ = R u,   Δw = u - Z Δγ,   R = (BᵀB)⁻¹ Bᵀ P

with a matrix of the nodes, factorised by fronts (`preie/solvers/fronts.py`). No flexibility D of all pairs is made,
which has as many numbers as a block has pairs, squared. Rigid blocks: K = 0, P = B, Z = R = 1, no w.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from slopekit.core.arrays import Floats, Ints
from slopekit.core.errors import DesignError, Fault
from slopekit.elastic.model import ElasticModel
from slopekit.preie.solvers.fronts import Fronts

_EXACT = 1e-6  # what is left of a step's right side, in parts of it
_ALIKE = 0.9  # cosine between normals of one joint set
_NUDGE = 1e-3  # of a node within its block, so that cuts fall between blocks
_MOST_BYTES = 2e9
_CHUNK = 1_000_000  # entries placed at a time


Place = tuple[Floats, Floats, Floats]  # d (3n,), γ (N,), and w (k,) of the bodies


class Condensed:
    """Newton's steps of a model."""

    def __init__(self, model: ElasticModel) -> None:
        self.model, self.bodies = model, model.bodies
        size, unknowns = model.rows.shape
        self.weight = float(np.sqrt(model.load @ model.load)) + float(model.bolt_capacity.sum())
        if not self.bodies:
            self.shapes, self.width = model.rows.tocsr(), unknowns // len(model.blocks)
            self.motions = self.loads = sparse.identity(unknowns, format="csr")
            self.first = self.width * np.arange(len(model.blocks) + 1)
            self.bent = 0
        else:
            at, motions, rigid, loads = [], [], [], []
            self.first = np.cumsum([0, *(one.shapes.shape[1] for one, *_ in self.bodies)])
            back = np.concatenate([own for *_, own in self.bodies])
            for (one, pairs, own), first in zip(self.bodies, self.first.tolist(), strict=False):
                shapes = one.shapes.tocoo()
                at.append((shapes.data, pairs[shapes.row], shapes.col + first))
                motions.append(np.linalg.pinv(model.rows[pairs][:, own].toarray()) @ one.shapes)
                rigid.append(one.rigid)
                loads.append(one.load)
            values, rows, columns = (np.concatenate(one) for one in zip(*at, strict=True))
            self.bent = int(self.first[-1])
            self.shapes = sparse.csr_matrix((values, (rows, columns)), shape=(size, self.bent))
            order = np.argsort(back)
            self.motions = sparse.block_diag(motions, format="csr")[order]
            self.rigid = sparse.block_diag(rigid, format="csc")[:, order].tocsr()
            self.turned_rigid = self.rigid.T.tocsr()
            self.loads = sparse.block_diag(loads, format="csc")[:, order].tocsr()
            self.width = self.bodies[0][0].where.shape[1]
        self.turned = self.shapes.T.tocsr()
        self.fronts: Fronts | None = None
        self.pattern: tuple[Ints, Ints, Ints] | None = None

    # -- what is off --------------------------------------------------------------------------------------------------

    def fitting(self, place: Place) -> Place:
        """A place with the relative displacements d that its γ and w have."""
        _, motion, bent = place
        relative = self.model.rows @ motion
        return relative + self.shapes @ bent if self.bent else relative, motion, bent

    def off(self, bent: Floats, forces: Floats, loads: Floats) -> Floats:
        """What is off of balance at the nodes: r (k,) kN."""
        residual: Floats = self.turned @ forces + self.loads @ loads
        self._take_stiffness(residual, bent)
        return residual

    def _take_stiffness(self, off: Floats, bent: Floats) -> None:
        for (one, *_), first, end in zip(self.bodies, self.first, self.first[1:], strict=False):
            off[first:end] -= one.stiffness @ bent[first:end]

    def size(self, at_nodes: Floats) -> float:
        """Of what is off, in parts of the load: at the nodes and of the blocks."""
        of_blocks = self.turned_rigid @ at_nodes if self.bent else at_nodes
        return math.sqrt(float(at_nodes @ at_nodes) + float(of_blocks @ of_blocks)) / self.weight

    # -- the step -----------------------------------------------------------------------------------------------------

    def step(self, slopes: Floats, off: Floats, springs: Floats) -> Place:
        """The changes that take away what is off.

        Parameters
        ----------
        slopes : (n, 3, 3) of the forces by d; springs : (b,) of the passive bolts, kN/m
        """
        law = sparse.bsr_matrix((slopes, np.arange(len(slopes)), np.arange(len(slopes) + 1))).tocsr()
        contacts = (self.turned @ (law @ self.shapes)).tocsr()
        solve = self._factored(contacts)
        increment = solve(off)
        active = np.flatnonzero(springs)
        if len(active):  # what a bolt's pull moves
            pulled = self.model.bolt_rows[active] @ self.motions
            ways = np.array([solve(way) for way in (self.loads @ self.model.bolt_rows[active].T).T])
            small = np.diag(1.0 / springs[active]) + pulled @ ways.T
            if np.isfinite(small).all() and np.isfinite(increment).all():
                increment = increment - np.linalg.lstsq(small, pulled @ increment, rcond=None)[0] @ ways
        motion = self.motions @ increment
        return self.shapes @ increment, motion, increment - self.rigid @ motion if self.bent else np.zeros(0)

    def _factored(self, contacts: Any) -> Callable[[Floats], Floats]:
        """A solver of K - Pᵀ S P, by fronts and where they do not do by SuperLU, which takes pivots from wherever."""
        fronts = self.fronts = self.fronts or self._laid_out(contacts)
        entries = np.zeros(fronts.size)
        if self.pattern is None or not (
            np.array_equal(self.pattern[0], contacts.indptr) and np.array_equal(self.pattern[1], contacts.indices)
        ):
            rows = np.repeat(np.arange(contacts.shape[0]), np.diff(contacts.indptr))
            self.pattern = contacts.indptr, contacts.indices, self._at(fronts, rows, contacts.indices)
        entries[self.pattern[2]] = -contacts.data
        for (one, *_), at in zip(self.bodies, self.own, strict=True):
            entries[at] += one.stiffness.ravel()
        inner = fronts.factored(entries)

        def by_fronts(right: Floats) -> Floats:
            assert inner is not None
            placed = np.empty(len(right))
            placed[self.order] = right
            solution: Floats = inner(placed)[self.order]
            return solution

        def left(solution: Floats, right: Floats) -> Floats:
            rest: Floats = right + contacts @ solution
            self._take_stiffness(rest, solution)
            return rest

        slow: list[Any] = []

        def by_any_pivots(right: Floats) -> Floats:
            if not slow:
                whole = -contacts
                if self.bent:
                    whole = whole + sparse.block_diag([one.stiffness for one, *_ in self.bodies], format="csr")
                try:
                    slow.append(splu(whole[self.back][:, self.back].tocsc(), permc_spec="NATURAL"))
                except RuntimeError:  # singular
                    slow.append(None)
            solution = np.zeros(len(right))
            if slow[0] is not None:
                solution[self.back] = slow[0].solve(right[self.back])
            return solution

        def solve(right: Floats) -> Floats:
            if inner is not None and not slow:
                solution = by_fronts(right)
                solution = solution + by_fronts(left(solution, right))
                rest = left(solution, right)
                if float(rest @ rest) <= _EXACT**2 * float(right @ right):
                    return solution
            return by_any_pivots(right)

        return solve

    def _laid_out(self, contacts: Any) -> Fronts:
        """The fronts of the nodes, cut between blocks: along the normals of the joints, their sums and differences."""
        width = self.width
        touching = contacts.tocoo()
        edges = [np.stack([touching.row // width, touching.col // width])]
        counts = np.diff(self.first) // width
        edges += [first // width + np.stack(np.triu_indices(count, 1))
                  for first, count in zip(self.first.tolist(), counts.tolist(), strict=False)]  # fmt: skip
        joined = np.concatenate(edges, axis=1)
        joined = joined[:, joined[0] != joined[1]]
        if self.bent:
            where = np.concatenate([one.where for one, *_ in self.bodies])
            middle = np.repeat([one.where.mean(axis=0) for one, *_ in self.bodies], counts, axis=0)
            where = middle + _NUDGE * (where - middle)
        else:
            where = np.array([one.where.mean(axis=0) for one, *_ in self.model.blocks])
        normals, axes = self._normals(where.shape[1]), list[Floats]()
        while len(normals) and len(axes) < where.shape[1]:
            alike = np.abs(normals @ normals[0]) > _ALIKE
            axes.append(normals[0])
            normals = normals[~alike]
        signs = np.stack(np.meshgrid(*[[0.0, 1.0, -1.0]] * len(axes), indexing="ij"), axis=-1).reshape(-1, len(axes))
        fronts = Fronts.of_graph(joined, signs[1:] @ np.array(axes) @ where.T, max(int(counts.max()), 2), width)
        if fronts.bytes > _MOST_BYTES:
            message = f"the matrix of {len(self.bodies)} elastic blocks needs {fronts.bytes * 1e-9:.1f} GB"
            advice = "Give a longer edge, or fewer blocks."
            raise DesignError([Fault("E125", message, "analysis.elastic.edge", advice)])
        self.order = (width * fronts.place[:, None] + np.arange(width)).ravel()  # where each unknown goes
        self.back = np.argsort(self.order)
        self.own = list[Ints]()
        for first, end in zip(self.first[:-1].tolist(), self.first[1:].tolist(), strict=True):
            if self.bent:
                row, column = np.broadcast_arrays(np.arange(first, end)[:, None], np.arange(first, end)[None])
                self.own.append(self._at(fronts, row.ravel(), column.ravel()))
        return fronts

    def _normals(self, dim: int) -> Floats:
        """Of the pairs (n, d): by what they open where a block moves."""
        opening = self.model.rows[::3].tocoo()
        axis = opening.col % (self.model.rows.shape[1] // len(self.model.blocks))
        normals, moving = np.zeros((opening.shape[0], dim)), axis < dim
        normals[opening.row[moving], axis[moving]] = opening.data[moving]
        return normals

    def _at(self, fronts: Fronts, row: Ints, column: Ints) -> Ints:
        """Where entries of the matrix are stored."""
        parts = np.array_split(np.arange(len(row)), 1 + len(row) // _CHUNK)
        return np.concatenate([fronts.at(self.order[row[part]], self.order[column[part]]) for part in parts])
