"""Sums of what node pairs and friction forces resist, as the stiffness of contacts.

A pair reads its opening off three numbers of the motion of its contact and its slip off three others (two and one in
a section): products of those are made once, and a step of the solver only weighs and adds them up.
"""

from typing import Any

import numpy as np

from slopekit.core.arrays import Floats, Ints
from slopekit.preie.kernels import compiled
from slopekit.preie.system.assembly import AssemblyModel


def compiled_contacts(model: AssemblyModel) -> Any:
    """The contacts of a model for the compiled kernels, None where there are none."""
    kernels = compiled()
    if kernels is None:
        return None
    normal, slip = _read_off(model)
    each = np.arange(len(model.plus) + 1)
    pairs, groups = len(model.control_area), len(model.group_first)
    return kernels.contacts(
        model.unknowns, model.slip_rows.shape[1], len(model.load), len(model.plus), groups, pairs, model.plus,
        model.minus, np.searchsorted(model.group_contact, each), np.append(model.group_first, pairs),
        np.ascontiguousarray(model.normal_rows[:, normal]), np.ascontiguousarray(model.slip_rows[:, :, slip]),
        np.ascontiguousarray(model.plus_motion), np.ascontiguousarray(model.minus_motion),
    )  # fmt: skip


def _read_off(model: AssemblyModel) -> tuple[Ints, Ints]:
    """Which numbers of the motion of a contact its openings, and its slips, are read off."""
    in_space = model.unknowns == 6
    return np.array([0, 4, 5] if in_space else [0, 2]), np.array([1, 2, 3] if in_space else [1])


class ContactPattern:
    """Where the products of the rows of a model go in the stiffness (k, u, u) of its contacts."""

    def __init__(self, model: AssemblyModel) -> None:
        self.normal, self.slip = _read_off(model)
        self.unknowns, self.size = model.unknowns, len(model.plus)
        self.kernels, self.contacts = compiled(), compiled_contacts(model)
        if self.kernels is not None:
            return
        self.pairs_first = np.searchsorted(model.pair_contact, np.arange(len(model.plus)))
        self.group_first = model.group_first
        self.one_each = len(model.group_first) == len(model.plus)  # a friction force a contact: a section
        self.rows = np.ascontiguousarray(model.normal_rows[:, self.normal])
        self.slips = np.ascontiguousarray(model.slip_rows[:, :, self.slip])
        self.upper = np.triu_indices(len(self.normal))
        self.slip_upper = np.triu_indices(len(self.slip))
        self.products = self.rows[:, self.upper[0]] * self.rows[:, self.upper[1]]
        self.tangents = np.triu_indices(self.slips.shape[1])
        a, b = self.slip_upper
        self.slip_products = np.stack(
            [
                self.slips[:, p][:, a] * self.slips[:, q][:, b]
                + (self.slips[:, q][:, a] * self.slips[:, p][:, b] if p != q else 0.0)
                for p, q in zip(*self.tangents, strict=True)
            ],
            axis=2,
        )  # (g, entries, entries of the tangent stiffness)

    def stiffness(self, springs: Floats, tangent: Floats) -> Floats:
        """Stiffness (k, u, u) of normal springs (m,) and symmetric tangent stiffnesses (g, t, t)."""
        out = np.zeros((self.size, self.unknowns, self.unknowns))
        if self.kernels is not None:
            self.kernels.stiffness(self.contacts, springs, np.ascontiguousarray(tangent), out)
            return out
        weights = tangent[:, self.tangents[0], self.tangents[1]]
        of_slip = np.matmul(self.slip_products, weights[:, :, None])[:, :, 0]
        self._add(out, self.normal, self.upper, np.add.reduceat(self.products * springs[:, None], self.pairs_first))
        self._add(out, self.slip, self.slip_upper, self._by_contact(of_slip))
        return out

    def _by_contact(self, of_groups: Floats) -> Floats:
        """Sums over the friction forces of each contact."""
        if self.one_each:
            return of_groups
        return np.add.reduceat(of_groups, self.pairs_first)

    @staticmethod
    def _add(out: Floats, part: Ints, upper: tuple[Ints, Ints], entries: Floats) -> None:
        """Add entries of an upper triangle, and mirror them."""
        for k, (i, j) in enumerate(zip(part[upper[0]].tolist(), part[upper[1]].tolist(), strict=True)):
            out[:, i, j] += entries[:, k]
            if i != j:
                out[:, j, i] += entries[:, k]
