"""Elastic blocks, each condensed to the nodes of its contacts, and Newton's step of all of them by fronts.

    K w = Pᵀ f + G q(γ),   d = B γ + P w,   f = A law(d; F),   Bᵀ f + q(γ) = 0

Eq. 23 of Sheng et al. (2023) with one term more, in kN, m and kPa: d are the relative displacements of the node pairs,
γ the motions of the blocks, q the loads with the pulls of passive bolts. w are the displacements of the nodes of a
block relative to its motion, P its shape functions at the pairs, K its condensed stiffness and G its condensed load
(`CondensedBlock`). The residual of the first equation contains that of the blocks, since rigid motions Z are among
the w: Zᵀ Pᵀ = Bᵀ, Zᵀ G = 1, Zᵀ K = 0. With the slopes S of the pairs the step is

    (K - Pᵀ S P) u = r,   Δγ = R u,   Δw = u - Z Δγ,   R = (BᵀB)⁻¹ Bᵀ P

with a matrix of the nodes, factorised by fronts (`preie/solvers/fronts.py`). No flexibility D of all pairs is made,
which has as many numbers as a block has pairs, squared. Rigid blocks: K = 0, P = B, Z = R = 1, w = 0.
"""

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.core.errors import DesignError, Fault
from slopekit.elastic.flexibility import CondensedBlock, rigid_body
from slopekit.preie.motion.equilibrium import BOLT_GIVE_M
from slopekit.preie.solvers.fronts import Fronts


@dataclass(frozen=True)
class ElasticModel:
    """Elastic blocks, their loads and the node pairs between them.

    Attributes
    ----------
    rows : (3n, N) B, sparse; N unknowns in m, turns times `length`
    load : (N,) kN, moments over `length`
    area : (n,) m²; cohesion, tension : (n,) kPa; tan_friction, tan_dilation : (n,)
    bolt_rows : (b, N); bolt_capacity : (b,) kN
    blocks : of each block its condensed body, the rows (3m,) of its pairs and its unknowns (u,)
    """

    rows: Any
    load: Floats
    area: Floats
    cohesion: Floats
    tension: Floats
    tan_friction: Floats
    tan_dilation: Floats
    bolt_rows: Floats
    bolt_capacity: Floats
    blocks: tuple[tuple[CondensedBlock, Ints, Ints], ...]

    def rigid(self) -> "ElasticModel":
        """Return a model of the same blocks, rigid."""
        return replace(
            self,
            blocks=tuple(
                (
                    rigid_body(self.rows[pairs][:, unknowns], body.nodes.mean(axis=0)),
                    pairs,
                    unknowns,
                )
                for body, pairs, unknowns in self.blocks
            ),
        )

    @property
    def unbonded(self) -> Bools:
        """Pairs (n,) that have no bond to lose."""
        is_unbonded: Bools = (self.cohesion == 0.0) & (self.tension == 0.0)
        return is_unbonded

    def pulls(self, motion: Floats, factor: float) -> tuple[Floats, Floats]:
        """Return the pulls (b,) kN of the passive bolts at a strength reduction factor, and their stiffness (kN/m)."""
        capacity, stiffness = self.bolt_capacity / factor, self.bolt_capacity / BOLT_GIVE_M
        pull = -stiffness * (self.bolt_rows @ motion)
        return np.clip(pull, 0.0, capacity), np.where(
            (pull > 0.0) & (pull < capacity), stiffness, 0.0
        )

    def mean_bending(self, motion: Floats, factor: float, bent: Floats) -> Floats:
        """Return the elastic part of each block's mean displacement, (b, 3) m.

        bent : (k,) m, displacements of the nodes of all blocks relative to their motion
        """
        means = np.zeros((len(self.blocks), 3))
        loads = self.load + self.pulls(motion, factor)[0] @ self.bolt_rows
        first = 0
        for k, (body, _, unknowns) in enumerate(self.blocks):
            end = first + body.mean_displacement.shape[1]
            means[k] = (
                body.mean_displacement @ bent[first:end] + body.mean_by_load @ loads[unknowns]
            )
            first = end
        return means


_SOLVE_TOLERANCE = 1e-6  # residual of a linear solve, as a fraction of its right side
_SAME_SET_COSINE = 0.9  # cosine between normals of one joint set
_NODE_SHIFT = 1e-3  # scale of a block's nodes about their mean, so that cuts fall between blocks
_MAX_BYTES = 2e9
_CHUNK = 1_000_000  # entries placed at a time


Displacements = tuple[Floats, Floats, Floats]  # d (3n,), γ (N,), and w (k,) of the bodies


class Condensed:
    """Residuals and Newton steps of an elastic model, with its matrices assembled once."""

    def __init__(self, model: ElasticModel) -> None:
        self.model = model
        size, bodies = model.rows.shape[0], [body for body, *_ in model.blocks]
        self.weight = float(np.sqrt(model.load @ model.load)) + float(model.bolt_capacity.sum())
        self.first = np.cumsum([0, *(body.shapes.shape[1] for body in bodies)])
        self.bent, self.width = (
            int(self.first[-1]),
            bodies[0].shapes.shape[1] // len(bodies[0].nodes),
        )
        places, motions = list[Any](), list[Any]()
        for (body, pairs, unknowns), first in zip(model.blocks, self.first.tolist(), strict=False):
            shapes = body.shapes.tocoo()
            places.append((shapes.data, pairs[shapes.row], shapes.col + first))
            motions.append(np.linalg.pinv(model.rows[pairs][:, unknowns].toarray()) @ body.shapes)
        values, rows, columns = (np.concatenate(arrays) for arrays in zip(*places, strict=True))
        self.shapes = sparse.csr_matrix((values, (rows, columns)), shape=(size, self.bent))
        order = np.argsort(np.concatenate([unknowns for *_, unknowns in model.blocks]))
        self.motions = sparse.block_diag(motions, format="csr")[order]
        self.rigid = sparse.block_diag([body.rigid for body in bodies], format="csc")[
            :, order
        ].tocsr()
        self.loads = sparse.block_diag([body.load for body in bodies], format="csc")[
            :, order
        ].tocsr()
        self.stiffness = sparse.block_diag([body.stiffness for body in bodies], format="csr")
        self.shapes_transposed, self.rigid_transposed = self.shapes.T.tocsr(), self.rigid.T.tocsr()
        self.fronts: Fronts | None = None
        self.pattern: tuple[Ints, Ints, Ints] | None = None

    # -- residuals ----------------------------------------------------------------------------------------------------

    def compatible(self, displacements: Displacements) -> Displacements:
        """Return displacements with the relative displacements d of their γ and w, d = B γ + P w."""
        _, motion, bent = displacements
        return self.model.rows @ motion + self.shapes @ bent, motion, bent

    def residual(self, bent: Floats, forces: Floats, loads: Floats) -> Floats:
        """Return the residual force r (k,) kN at the nodes: Pᵀ f + G q - K w."""
        residual: Floats = (
            self.shapes_transposed @ forces + self.loads @ loads - self.stiffness @ bent
        )
        return residual

    def size(self, node_residual: Floats) -> float:
        """Return the norm of a residual at the nodes and of the blocks, as a fraction of the load."""
        block_residual = self.rigid_transposed @ node_residual
        return (
            math.sqrt(float(node_residual @ node_residual) + float(block_residual @ block_residual))
            / self.weight
        )

    # -- the step -----------------------------------------------------------------------------------------------------

    def step(self, slopes: Floats, residual: Floats, springs: Floats) -> Displacements:
        """Return the Newton step that removes a residual (k,) kN.

        Parameters
        ----------
        slopes : (n, 3, 3) kN/m, derivative of the forces of the pairs by d
        springs : (b,) kN/m, stiffness of the passive bolts
        """
        law = sparse.bsr_matrix(
            (slopes, np.arange(len(slopes)), np.arange(len(slopes) + 1))
        ).tocsr()
        contacts = (self.shapes_transposed @ (law @ self.shapes)).tocsr()
        solve = self._factored(contacts)
        increment = solve(residual)
        active = np.flatnonzero(springs)
        if len(active):  # the passive bolts change the matrix by a low rank
            pulled = self.model.bolt_rows[active] @ self.motions
            responses = np.array(
                [solve(bolt_load) for bolt_load in (self.loads @ self.model.bolt_rows[active].T).T]
            )
            reduced_matrix = np.diag(1.0 / springs[active]) + pulled @ responses.T
            if np.isfinite(reduced_matrix).all() and np.isfinite(increment).all():
                increment = (
                    increment
                    - np.linalg.lstsq(reduced_matrix, pulled @ increment, rcond=None)[0] @ responses
                )
        motion = self.motions @ increment
        return self.shapes @ increment, motion, increment - self.rigid @ motion

    def _factored(self, contacts: Any) -> Callable[[Floats], Floats]:
        """Return a solver of K - Pᵀ S P, by fronts; where these are inaccurate by SuperLU, with pivots from any row."""
        fronts = self.fronts = self.fronts or self._planned_fronts(contacts)
        entries = np.zeros(fronts.size)
        if self.pattern is None or not (
            np.array_equal(self.pattern[0], contacts.indptr)
            and np.array_equal(self.pattern[1], contacts.indices)
        ):
            self.pattern = (
                contacts.indptr,
                contacts.indices,
                self._storage_indices(fronts, contacts),
            )
        entries[self.pattern[2]] = -contacts.data
        entries[self.stiffness_indices] += self.stiffness.data
        front_solver, matrix = fronts.factored(entries), self.stiffness - contacts

        def solve(right: Floats) -> Floats:
            if front_solver is not None:
                solution: Floats = front_solver(right[self.inverse_order])[self.order]
                solution = (
                    solution
                    + front_solver((right - matrix @ solution)[self.inverse_order])[self.order]
                )
                remainder: Floats = right - matrix @ solution
                if float(remainder @ remainder) <= _SOLVE_TOLERANCE**2 * float(right @ right):
                    return solution
            return self._solved_with_any_pivots(matrix, right)

        return solve

    def _solved_with_any_pivots(self, matrix: Any, right: Floats) -> Floats:
        """Return the solution by SuperLU; zeros where the matrix is singular."""
        solution = np.zeros(len(right))
        with suppress(RuntimeError):
            factors = splu(
                matrix[self.inverse_order][:, self.inverse_order].tocsc(), permc_spec="NATURAL"
            )
            solution[self.inverse_order] = factors.solve(right[self.inverse_order])
        return solution

    def _planned_fronts(self, contacts: Any) -> Fronts:
        """Return the fronts of the nodes, cut between blocks along the joints' normals, their sums and differences."""
        width = self.width
        touching = contacts.tocoo()
        edges = [np.stack([touching.row // width, touching.col // width])]
        counts = np.diff(self.first) // width
        edges += [
            first // width + np.stack(np.triu_indices(count, 1))
            for first, count in zip(self.first.tolist(), counts.tolist(), strict=False)
        ]
        graph = np.concatenate(edges, axis=1)
        graph = graph[:, graph[0] != graph[1]]
        nodes = np.concatenate([body.nodes for body, *_ in self.model.blocks])
        middle = np.repeat(
            [body.nodes.mean(axis=0) for body, *_ in self.model.blocks], counts, axis=0
        )
        nodes = middle + _NODE_SHIFT * (nodes - middle)
        normals, axes = self._normals(nodes.shape[1]), list[Floats]()
        while len(normals) and len(axes) < nodes.shape[1]:
            same_set = np.abs(normals @ normals[0]) > _SAME_SET_COSINE
            axes.append(normals[0])
            normals = normals[~same_set]
        signs = np.stack(
            np.meshgrid(*[[0.0, 1.0, -1.0]] * len(axes), indexing="ij"), axis=-1
        ).reshape(-1, len(axes))
        fronts = Fronts.of_graph(
            graph, signs[1:] @ np.array(axes) @ nodes.T, max(int(counts.max()), 2), width
        )
        if fronts.bytes > _MAX_BYTES:
            message = f"the matrix of {len(self.model.blocks)} elastic blocks needs {fronts.bytes * 1e-9:.1f} GB"
            advice = "Give a longer edge, or fewer blocks."
            raise DesignError([Fault("E125", message, "analysis.elastic.edge", advice)])
        self.order = (
            width * fronts.place[:, None] + np.arange(width)
        ).ravel()  # the row of each unknown
        self.inverse_order = np.argsort(self.order)
        self.stiffness_indices = self._storage_indices(fronts, self.stiffness)
        return fronts

    def _normals(self, dim: int) -> Floats:
        """Return the normals (n, d) of the pairs: their opening per translation of a block."""
        opening = self.model.rows[::3].tocoo()
        axis = opening.col % (self.model.rows.shape[1] // len(self.model.blocks))
        normals, moving = np.zeros((opening.shape[0], dim)), axis < dim
        normals[opening.row[moving], axis[moving]] = opening.data[moving]
        return normals

    def _storage_indices(self, fronts: Fronts, matrix: Any) -> Ints:
        """Return the indices of a sparse matrix's entries in the storage of the fronts."""
        rows = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
        chunks = np.array_split(np.arange(len(rows)), 1 + len(rows) // _CHUNK)
        order, columns = self.order, matrix.indices
        return np.concatenate(
            [fronts.storage_index(order[rows[chunk]], order[columns[chunk]]) for chunk in chunks]
        )
