"""Elastic blocks, each condensed to the nodes of its contacts, and Newton's step of all of them by fronts.

    K w = Pᵀ f + G q(γ),   d = B γ + P w,   f = A law(d; F),   Bᵀ f + q(γ) = 0

Eq. 23 of Sheng et al. (2023) with one term more, in kN, m and kPa: d are the relative displacements of the node pairs,
γ the motions of the blocks, q the loads with the pulls of passive bolts. w are the displacements of those nodes of a
block beside its motion, P its shapes at the pairs, K what is left of its stiffness there and G of its load
(`CondensedBlock`). What is off of the first is the unbalance of the blocks too, since motions Z as a whole are among
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
    """Blocks on their node pairs.

    Attributes
    ----------
    rows : (3n, N) B, sparse; N unknowns in m, turns times `length`
    load : (N,) kN, moments over `length`
    area : (n,) m²; cohesion, tension : (n,) kPa; tan_friction, tan_dilation : (n,)
    bolt_rows : (b, N); bolt_capacity : (b,) kN
    blocks : of each its condensed body, the rows (3m,) of its pairs and its unknowns (u,)
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
        """The same blocks, rigid."""
        return replace(
            self,
            blocks=tuple(
                (rigid_body(self.rows[pairs][:, unknowns], body.where.mean(axis=0)), pairs, unknowns)
                for body, pairs, unknowns in self.blocks
            ),
        )

    @property
    def unbonded(self) -> Bools:
        """Pairs (n,) that have no bond to lose."""
        is_unbonded: Bools = (self.cohesion == 0.0) & (self.tension == 0.0)
        return is_unbonded

    def pulls(self, motion: Floats, factor: float) -> tuple[Floats, Floats]:
        """Pulls (b,) of the passive bolts, and by how much they grow per m that a bolt is drawn out."""
        most, stiff = self.bolt_capacity / factor, self.bolt_capacity / BOLT_GIVE_M
        pull = -stiff * (self.bolt_rows @ motion)
        return np.clip(pull, 0.0, most), np.where((pull > 0.0) & (pull < most), stiff, 0.0)

    def mean_bending(self, motion: Floats, factor: float, bent: Floats) -> Floats:
        """The elastic part of the mean displacement of each block, (b, 3) m; bent (k,) of the nodes of all."""
        means = np.zeros((len(self.blocks), 3))
        loads = self.load + self.pulls(motion, factor)[0] @ self.bolt_rows
        first = 0
        for k, (body, _, unknowns) in enumerate(self.blocks):
            end = first + body.seen.shape[1]
            means[k] = body.seen @ bent[first:end] + body.seen_by_load @ loads[unknowns]
            first = end
        return means


_EXACT = 1e-6  # what is left of a step's right side, in parts of it
_ALIKE = 0.9  # cosine between normals of one joint set
_NUDGE = 1e-3  # of a node within its block, so that cuts fall between blocks
_MOST_BYTES = 2e9
_CHUNK = 1_000_000  # entries placed at a time


Place = tuple[Floats, Floats, Floats]  # d (3n,), γ (N,), and w (k,) of the bodies


class Condensed:
    """Newton's steps of a model."""

    def __init__(self, model: ElasticModel) -> None:
        self.model = model
        size, bodies = model.rows.shape[0], [body for body, *_ in model.blocks]
        self.weight = float(np.sqrt(model.load @ model.load)) + float(model.bolt_capacity.sum())
        self.first = np.cumsum([0, *(body.shapes.shape[1] for body in bodies)])
        self.bent, self.width = int(self.first[-1]), bodies[0].shapes.shape[1] // len(bodies[0].where)
        places, motions = list[Any](), list[Any]()
        for (body, pairs, unknowns), first in zip(model.blocks, self.first.tolist(), strict=False):
            shapes = body.shapes.tocoo()
            places.append((shapes.data, pairs[shapes.row], shapes.col + first))
            motions.append(np.linalg.pinv(model.rows[pairs][:, unknowns].toarray()) @ body.shapes)
        values, rows, columns = (np.concatenate(part) for part in zip(*places, strict=True))
        self.shapes = sparse.csr_matrix((values, (rows, columns)), shape=(size, self.bent))
        order = np.argsort(np.concatenate([unknowns for *_, unknowns in model.blocks]))
        self.motions = sparse.block_diag(motions, format="csr")[order]
        self.rigid = sparse.block_diag([body.rigid for body in bodies], format="csc")[:, order].tocsr()
        self.loads = sparse.block_diag([body.load for body in bodies], format="csc")[:, order].tocsr()
        self.stiffness = sparse.block_diag([body.stiffness for body in bodies], format="csr")
        self.turned, self.turned_rigid = self.shapes.T.tocsr(), self.rigid.T.tocsr()
        self.fronts: Fronts | None = None
        self.pattern: tuple[Ints, Ints, Ints] | None = None

    # -- what is off --------------------------------------------------------------------------------------------------

    def fitting(self, place: Place) -> Place:
        """A place with the relative displacements d that its γ and w have."""
        _, motion, bent = place
        return self.model.rows @ motion + self.shapes @ bent, motion, bent

    def off(self, bent: Floats, forces: Floats, loads: Floats) -> Floats:
        """What is off of balance at the nodes: r (k,) kN."""
        residual: Floats = self.turned @ forces + self.loads @ loads - self.stiffness @ bent
        return residual

    def size(self, at_nodes: Floats) -> float:
        """Of what is off, in parts of the load: at the nodes and of the blocks."""
        of_blocks = self.turned_rigid @ at_nodes
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
        return self.shapes @ increment, motion, increment - self.rigid @ motion

    def _factored(self, contacts: Any) -> Callable[[Floats], Floats]:
        """A solver of K - Pᵀ S P, by fronts and where they do not do by SuperLU, which takes pivots from wherever."""
        fronts = self.fronts = self.fronts or self._laid_out(contacts)
        entries = np.zeros(fronts.size)
        if self.pattern is None or not (
            np.array_equal(self.pattern[0], contacts.indptr) and np.array_equal(self.pattern[1], contacts.indices)
        ):
            self.pattern = contacts.indptr, contacts.indices, self._at(fronts, contacts)
        entries[self.pattern[2]] = -contacts.data
        entries[self.stiff] += self.stiffness.data
        by_fronts, whole = fronts.factored(entries), self.stiffness - contacts

        def solve(right: Floats) -> Floats:
            if by_fronts is not None:
                solution: Floats = by_fronts(right[self.back])[self.order]
                solution = solution + by_fronts((right - whole @ solution)[self.back])[self.order]
                rest: Floats = right - whole @ solution
                if float(rest @ rest) <= _EXACT**2 * float(right @ right):
                    return solution
            return self._by_any_pivots(whole, right)

        return solve

    def _by_any_pivots(self, whole: Any, right: Floats) -> Floats:
        """The solution by SuperLU; 0 where the matrix is singular."""
        solution = np.zeros(len(right))
        with suppress(RuntimeError):
            factors = splu(whole[self.back][:, self.back].tocsc(), permc_spec="NATURAL")
            solution[self.back] = factors.solve(right[self.back])
        return solution

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
        where = np.concatenate([body.where for body, *_ in self.model.blocks])
        middle = np.repeat([body.where.mean(axis=0) for body, *_ in self.model.blocks], counts, axis=0)
        where = middle + _NUDGE * (where - middle)
        normals, axes = self._normals(where.shape[1]), list[Floats]()
        while len(normals) and len(axes) < where.shape[1]:
            alike = np.abs(normals @ normals[0]) > _ALIKE
            axes.append(normals[0])
            normals = normals[~alike]
        signs = np.stack(np.meshgrid(*[[0.0, 1.0, -1.0]] * len(axes), indexing="ij"), axis=-1).reshape(-1, len(axes))
        fronts = Fronts.of_graph(joined, signs[1:] @ np.array(axes) @ where.T, max(int(counts.max()), 2), width)
        if fronts.bytes > _MOST_BYTES:
            message = f"the matrix of {len(self.model.blocks)} elastic blocks needs {fronts.bytes * 1e-9:.1f} GB"
            advice = "Give a longer edge, or fewer blocks."
            raise DesignError([Fault("E125", message, "analysis.elastic.edge", advice)])
        self.order = (width * fronts.place[:, None] + np.arange(width)).ravel()  # where each unknown goes
        self.back = np.argsort(self.order)
        self.stiff = self._at(fronts, self.stiffness)
        return fronts

    def _normals(self, dim: int) -> Floats:
        """Of the pairs (n, d): by what they open where a block moves."""
        opening = self.model.rows[::3].tocoo()
        axis = opening.col % (self.model.rows.shape[1] // len(self.model.blocks))
        normals, moving = np.zeros((opening.shape[0], dim)), axis < dim
        normals[opening.row[moving], axis[moving]] = opening.data[moving]
        return normals

    def _at(self, fronts: Fronts, matrix: Any) -> Ints:
        """Where the entries of a matrix are stored."""
        rows = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
        parts = np.array_split(np.arange(len(rows)), 1 + len(rows) // _CHUNK)
        order, columns = self.order, matrix.indices
        return np.concatenate([fronts.at(order[rows[part]], order[columns[part]]) for part in parts])
