"""The stiffness of contacts as weighted sums over their node pairs and friction forces.

The opening of a pair depends on three components of its contact's motion and its slip on the three others (two and
one in a section): their products are computed once, and a step of the solver only weighs and sums them.
"""

from typing import Any

import numpy as np

from slopekit.core.arrays import Floats, Ints
from slopekit.preie.kernels import compiled
from slopekit.preie.system.assembly import AssemblyModel


def compiled_contacts(model: AssemblyModel) -> Any:
    """Return the contacts of a model as the object of the compiled kernels, None without kernels."""
    kernels = compiled()
    if kernels is None:
        return None
    normal, slip = _motion_components(model)
    contact_numbers = np.arange(len(model.plus) + 1)
    pairs, groups = len(model.control_area), len(model.group_first)
    return kernels.contacts(
        model.unknowns,
        model.slip_rows.shape[1],
        len(model.load),
        len(model.plus),
        groups,
        pairs,
        model.plus,
        model.minus,
        np.searchsorted(model.group_contact, contact_numbers),
        np.append(model.group_first, pairs),
        np.ascontiguousarray(model.normal_rows[:, normal]),
        np.ascontiguousarray(model.slip_rows[:, :, slip]),
        np.ascontiguousarray(model.plus_motion),
        np.ascontiguousarray(model.minus_motion),
    )


def _motion_components(model: AssemblyModel) -> tuple[Ints, Ints]:
    """Return the components of a contact's motion on which openings depend, and those of slips."""
    in_space = model.unknowns == 6
    return np.array([0, 4, 5] if in_space else [0, 2]), np.array([1, 2, 3] if in_space else [1])


class ContactPattern:
    """The products of a model's rows and their places in the stiffness (k, u, u) of its contacts."""

    def __init__(self, model: AssemblyModel) -> None:
        self.normal, self.slip = _motion_components(model)
        self.unknowns, self.size = model.unknowns, len(model.plus)
        self.kernels, self.contacts = compiled(), compiled_contacts(model)
        if self.kernels is not None:
            return
        self.pairs_first = np.searchsorted(model.pair_contact, np.arange(len(model.plus)))
        self.group_first = model.group_first
        self.one_group_per_contact = len(model.group_first) == len(
            model.plus
        )  # a friction force a contact: a section
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
        """Return the stiffness (k, u, u) of contacts with normal springs (m,) and tangent stiffnesses (g, t, t)."""
        stiffness = np.zeros((self.size, self.unknowns, self.unknowns))
        if self.kernels is not None:
            self.kernels.stiffness(self.contacts, springs, np.ascontiguousarray(tangent), stiffness)
            return stiffness
        weights = tangent[:, self.tangents[0], self.tangents[1]]
        slip_entries = np.matmul(self.slip_products, weights[:, :, None])[:, :, 0]
        self._add(
            stiffness,
            self.normal,
            self.upper,
            np.add.reduceat(self.products * springs[:, None], self.pairs_first),
        )
        self._add(stiffness, self.slip, self.slip_upper, self._by_contact(slip_entries))
        return stiffness

    def _by_contact(self, group_values: Floats) -> Floats:
        """Return the sums over the friction forces of each contact."""
        if self.one_group_per_contact:
            return group_values
        return np.add.reduceat(group_values, self.pairs_first)

    @staticmethod
    def _add(
        stiffness: Floats, components: Ints, upper: tuple[Ints, Ints], entries: Floats
    ) -> None:
        """Add entries of an upper triangle to a stiffness (k, u, u), and their mirror images."""
        for k, (i, j) in enumerate(
            zip(components[upper[0]].tolist(), components[upper[1]].tolist(), strict=True)
        ):
            stiffness[:, i, j] += entries[:, k]
            if i != j:
                stiffness[:, j, i] += entries[:, k]
