"""The pressed part of flat contacts: the area on which their cohesion acts (METHOD-4 §16).

The gap of a flat contact between rigid blocks is linear. Cut into triangles (in a section the contact is one segment),
the part of each where the gap is negative has a closed form: with the gaps a, b, c of the corners, a alone of its sign,

    a² / ((a - b)(a - c))    of a triangle is on the side of a,        a / (a - b)    of a segment.
"""

import numpy as np

from slopekit.core.arrays import Floats, Ints
from slopekit.core.records import dataclass
from slopekit.geometry.patches import Patches
from slopekit.preie.tolerances import TOUCHES


@dataclass(frozen=True, slots=True)
class ContactCells:
    """Contacts cut into cells.

    Attributes
    ----------
    contact : (c,) of each cell, ascending
    fraction : (c,) of the area of its contact
    gap_rows : (c, v, u) gap of its corners per relative motion of the contact; v is 3, in a section 2
    """

    contact: Ints
    fraction: Floats
    gap_rows: Floats

    def renumbered(self, number: Ints) -> "ContactCells":
        """Return the cells of the contacts that have a number (k,), which is -1 of all others."""
        contact = number[self.contact]
        there = contact >= 0
        return ContactCells(contact[there], self.fraction[there], self.gap_rows[there])

    def pressed_share(self, motion: Floats) -> tuple[Floats, Floats]:
        """Return the share of each contact (k,) that a relative motion (k, u) presses, and its slopes (k, u).

        Contacts without cells are pressed all over; one that just touches is as well.
        """
        gaps = np.einsum("cvu,cu->cv", self.gap_rows, motion[self.contact]) - TOUCHES
        fraction, slopes = pressed_fraction(gaps)
        share, of_motion = np.ones(len(motion)), np.zeros_like(motion)
        share[self.contact] = 0.0
        np.add.at(share, self.contact, self.fraction * fraction)
        rows = np.einsum("cv,cvu->cu", self.fraction[:, None] * slopes, self.gap_rows)
        np.add.at(of_motion, self.contact, rows)
        return share, of_motion

    def largest_gap(self, motion: Floats) -> Floats:
        """Return the largest gap at a corner of each cell, (c,), by a relative motion (k, u) of the contacts."""
        largest: Floats = np.einsum("cvu,cu->cv", self.gap_rows, motion[self.contact]).max(axis=1)
        return largest


def contact_cells(patches: Patches, kept: Ints, axes: Floats, length: float, in_section: bool) -> ContactCells:
    """Return the cells of some patches (k,): triangles about their first corner, in a section one segment each.

    Parameters
    ----------
    axes : (k, 3, 3) normal and tangents of each contact
    length : m, of one unit of a rotation
    """
    first, counts = patches.first[kept], np.diff(patches.first)[kept]
    cells = np.ones(len(kept), dtype=np.int64) if in_section else counts - 2
    contact = np.repeat(np.arange(len(kept)), cells)
    if in_section:
        corners = first[:, None] + np.array([0, 1])
    else:
        turn = np.arange(len(contact)) - np.repeat(np.cumsum(cells) - cells, cells)
        corners = first[contact][:, None] + np.stack([0 * turn, turn + 1, turn + 2], axis=1)
    arms = patches.corners[corners] - patches.centroids[kept][contact][:, None]
    _, first_arm, second_arm = np.einsum("cij,cvj->icv", axes[contact], arms) / length
    zero, one = np.zeros_like(first_arm), np.ones_like(first_arm)
    if in_section:
        return ContactCells(contact, np.ones(len(contact)), np.stack([one, zero, -first_arm], axis=2))
    along, across = first_arm - first_arm[:, :1], second_arm - second_arm[:, :1]
    areas = np.abs(along[:, 1] * across[:, 2] - along[:, 2] * across[:, 1])
    fraction = areas / np.bincount(contact, areas, len(kept))[contact]
    return ContactCells(contact, fraction, np.stack([one, zero, zero, zero, second_arm, -first_arm], axis=2))


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
    sign = np.where(is_alone, 1.0, -1.0)
    fraction[cut] = np.where(is_alone, side, 1.0 - side)
    of_corners = np.empty_like(gap)
    np.put_along_axis(of_corners, turned, np.concatenate([by_lone[:, None], by_others], axis=1), axis=1)
    slopes[cut] = sign[:, None] * of_corners
    return fraction, slopes
