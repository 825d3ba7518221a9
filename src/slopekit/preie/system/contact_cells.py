"""The pressed part of flat contacts: the area on which their cohesion acts (docs/theory/many-blocks.md).

The gap of a flat contact between rigid blocks is linear. It is cut into triangles whose corners are node pairs (in a
section the contact is one segment); the part of each where the gap is negative has a closed form: with the gaps
a, b, c of the corners, a alone of its sign,

    a² / ((a - b)(a - c))    of a triangle is on the side of a,        a / (a - b)    of a segment.

Each node pair has its cohesion on the pressed parts of the triangles whose area it controls: where a contact is open
nothing holds it, however far the rest is pressed.
"""

from dataclasses import dataclass

import numpy as np

from slopekit.core.arrays import Floats, Ints


@dataclass(frozen=True)
class ContactCells:
    """Contacts cut into cells.

    Attributes
    ----------
    contact : (c,) contact of each cell, ascending
    corners : (c, v) node pairs at its corners; v is 3, in a section 2
    groups : (c, e) friction forces with some of their cohesion in the cell
    cohesion_shares : (c, e) fraction of the force's cohesion that lies in the cell
    """

    contact: Ints
    corners: Ints
    groups: Ints
    cohesion_shares: Floats

    def renumbered(self, contact: Ints, pair: Ints, group: Ints) -> "ContactCells":
        """Return the cells with new numbers of contacts, pairs and groups; contacts with number -1 are left out."""
        is_retained = contact[self.contact] >= 0
        return ContactCells(
            contact[self.contact[is_retained]],
            pair[self.corners[is_retained]],
            group[self.groups[is_retained]],
            self.cohesion_shares[is_retained],
        )

    def pressed_share(self, gaps: Floats, rows: Floats, groups: int) -> tuple[Floats, Floats]:
        """Return the fraction of its cohesion that acts in each friction force (g,), and its slopes (g, u).

        It is 1 for forces without cells.

        Parameters
        ----------
        gaps : (m,) of the node pairs, open +; rows : (m, u) gap per motion of the contact
        """
        fraction, slopes = pressed_fraction(gaps[self.corners])
        fraction_slopes = np.einsum("cv,cvu->cu", slopes, rows[self.corners])
        share, share_slopes = np.ones(groups), np.zeros((groups, rows.shape[1]))
        share[self.groups] = 0.0
        np.add.at(share, self.groups, self.cohesion_shares * fraction[:, None])
        np.add.at(
            share_slopes,
            self.groups,
            self.cohesion_shares[:, :, None] * fraction_slopes[:, None, :],
        )
        return share, share_slopes


def pressed_fraction(gaps: Floats) -> tuple[Floats, Floats]:
    """Return the fraction (c,) of each cell with a negative gap, linear between its corners (c, v), and its slopes.

    >>> pressed_fraction(np.array([[-1.0, 1.0, 1.0], [-1.0, -3.0, 1.0]]))[0].tolist()
    [0.25, 0.875]
    >>> pressed_fraction(np.array([[-1.0, 3.0]]))[0].tolist()
    [0.25]
    """
    pressed = gaps < 0.0
    corners, count = gaps.shape[1], pressed.sum(axis=1)
    fraction, slopes = (count == corners).astype(np.float64), np.zeros_like(gaps)
    cut = np.flatnonzero((count > 0) & (count < corners))
    if len(cut) == 0:
        return fraction, slopes
    is_alone = count[cut] == 1  # one corner is pressed, or one is open
    lone = np.argmax(pressed[cut] == is_alone[:, None], axis=1)
    corner_order = (lone[:, None] + np.arange(corners)) % corners
    gap = np.take_along_axis(gaps[cut], corner_order, axis=1)
    gap_differences = gap[:, :1] - gap[:, 1:]
    side = np.prod(gap[:, :1] / gap_differences, axis=1)
    opposite_slopes = side[:, None] / gap_differences
    with np.errstate(divide="ignore", invalid="ignore"):
        lone_slope = side * ((corners - 1) / gap[:, 0]) - opposite_slopes.sum(axis=1)
    lone_slope = np.where(gap[:, 0] == 0.0, 0.0, lone_slope)
    fraction[cut] = np.where(is_alone, side, 1.0 - side)
    corner_slopes = np.empty_like(gap)
    np.put_along_axis(
        corner_slopes,
        corner_order,
        np.concatenate([lone_slope[:, None], opposite_slopes], axis=1),
        axis=1,
    )
    slopes[cut] = np.where(is_alone, 1.0, -1.0)[:, None] * corner_slopes
    return fraction, slopes
