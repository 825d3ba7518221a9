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
    contact : (c,) of each cell, ascending
    corners : (c, v) node pairs at its corners; v is 3, in a section 2
    groups : (c, e) friction forces that have some of their cohesion there
    parts : (c, e) how much of it
    """

    contact: Ints
    corners: Ints
    groups: Ints
    parts: Floats

    def renumbered(self, contact: Ints, pair: Ints, group: Ints) -> "ContactCells":
        """Return the cells of the contacts that have a number; contacts, pairs and groups have none where it is -1."""
        kept = contact[self.contact] >= 0
        return ContactCells(
            contact[self.contact[kept]], pair[self.corners[kept]], group[self.groups[kept]], self.parts[kept]
        )

    def pressed_share(self, gaps: Floats, rows: Floats, groups: int) -> tuple[Floats, Floats]:
        """Return the share of its cohesion that each friction force (g,) has, and its slopes (g, u).

        Forces without cells have all of theirs.

        Parameters
        ----------
        gaps : (m,) of the node pairs; rows : (m, u) how they follow the motion of the contact
        """
        fraction, slopes = pressed_fraction(gaps[self.corners])
        by_motion = np.einsum("cv,cvu->cu", slopes, rows[self.corners])
        share, of_motion = np.ones(groups), np.zeros((groups, rows.shape[1]))
        share[self.groups] = 0.0
        np.add.at(share, self.groups, self.parts * fraction[:, None])
        np.add.at(of_motion, self.groups, self.parts[:, :, None] * by_motion[:, None, :])
        return share, of_motion


def pressed_fraction(gaps: Floats) -> tuple[Floats, Floats]:
    """Return the part of each cell (c,) whose gap, linear between its corners (c, v), is negative, and its slopes.

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
    turned = (lone[:, None] + np.arange(corners)) % corners
    gap = np.take_along_axis(gaps[cut], turned, axis=1)
    to_others = gap[:, :1] - gap[:, 1:]
    side = np.prod(gap[:, :1] / to_others, axis=1)
    by_others = side[:, None] / to_others
    with np.errstate(divide="ignore", invalid="ignore"):
        by_lone = side * ((corners - 1) / gap[:, 0]) - by_others.sum(axis=1)
    by_lone = np.where(gap[:, 0] == 0.0, 0.0, by_lone)
    fraction[cut] = np.where(is_alone, side, 1.0 - side)
    of_corners = np.empty_like(gap)
    np.put_along_axis(of_corners, turned, np.concatenate([by_lone[:, None], by_others], axis=1), axis=1)
    slopes[cut] = np.where(is_alone, 1.0, -1.0)[:, None] * of_corners
    return fraction, slopes
