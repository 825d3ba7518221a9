"""Newton's step of one block, or a few: matrices of all its pairs, with their flexibility D.

    d = B γ + D f + H q,   Bᵀ f + q = 0

The unknowns are d and γ, d is eliminated.
"""

import math
from typing import Any

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from slopekit.core.arrays import Floats
from slopekit.elastic.model import ElasticModel

Place = tuple[Floats, Floats, Floats]  # d (3n,), γ (N,), and w (k,) of condensed bodies


class Whole:
    """Newton's steps of a model with dense rows."""

    def __init__(self, model: ElasticModel) -> None:
        self.model = model
        self.weight = float(np.sqrt(model.load @ model.load)) + float(model.bolt_capacity.sum())
        self.unit = 1.0  # m

    def fitting(self, place: Place) -> Place:
        """A place as it is: its displacements are unknowns of their own."""
        return place

    def off(self, place: Place, forces: Floats, loads: Floats) -> tuple[Floats, ...]:
        """What is off of displacements (3n,) and of balance (N,)."""
        model, (relative, motion, _) = self.model, place
        off = relative - model.rows @ motion
        if model.give is not None:
            off = off - model.give @ forces - model.give_load @ loads
        return off, model.rows.T @ forces + loads

    def size(self, off: tuple[Floats, ...]) -> float:
        """Of what is off, in parts of `unit` and of the load."""
        beside, balance = (math.sqrt(float(one @ one)) for one in off)
        return math.hypot(beside / math.sqrt(len(off[0])) / self.unit, balance / self.weight)

    def step(self, slopes: Floats, off: tuple[Floats, ...], springs: Floats) -> Place:
        """The changes that take away what is off.

        Parameters
        ----------
        slopes : (n, 3, 3) of the forces by d; springs : (b,) of the passive bolts, kN/m
        """
        model, (beside, balance) = self.model, off
        size, rows = len(beside), model.rows
        by_motion = rows
        bolts = -(model.bolt_rows.T * springs) @ model.bolt_rows  # dq/dγ
        if model.give is not None:
            matrix = -np.matmul(
                np.ascontiguousarray(model.give.reshape(size, -1, 3).transpose(1, 0, 2)), slopes
            ).transpose(1, 0, 2).reshape(size, size)  # fmt: skip
            matrix[np.arange(size), np.arange(size)] += 1.0
            by_motion = rows + model.give_load @ bolts if len(springs) else rows
            right = np.concatenate([by_motion, -beside[:, None]], axis=1)
            solved: Any = lu_solve(
                lu_factor(matrix, check_finite=False, overwrite_a=True), right, check_finite=False
            )  # fmt: skip
        else:
            solved = np.concatenate([by_motion, -beside[:, None]], axis=1)
        stiff = (rows.reshape(-1, 3, rows.shape[1]).transpose(0, 2, 1) @ slopes).transpose(1, 0, 2).reshape(
            rows.shape[1], size
        )  # fmt: skip
        small = stiff @ solved[:, :-1] + bolts
        motion = _solved(small, -balance - stiff @ solved[:, -1])
        return solved[:, -1] + solved[:, :-1] @ motion, motion, np.zeros(0)


def _solved(matrix: Floats, right: Floats) -> Floats:
    """A small system, where nothing holds a block the shortest of its answers."""
    try:
        return np.asarray(np.linalg.solve(matrix, right), dtype=np.float64)
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.lstsq(matrix, right, rcond=None)[0], dtype=np.float64)
