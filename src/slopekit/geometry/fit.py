"""Overlaps and gaps between the blocks of a user: how well they fit together, as values that the caller judges."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.core.errors import Fault, GeometryError
from slopekit.geometry.patches import Assembly
from slopekit.geometry.tolerances import DOUBT, LARGEST_ROUNDING, LARGEST_ROUNDING_OF_THINNEST

_MOST_DECIMALS = 9


@dataclass(frozen=True)
class Misfits:
    """Pairs of blocks that lie in each other by more than the tolerance, or nearly touch: by less than 1 % of a block.

    Attributes
    ----------
    pairs : (n, 2) indices of the blocks, the lower first; a pair stands once for each place at which it nearly touches
    amounts : (n,) of an overlap m² in a section, m³ of solids; of a gap m along which the faces face each other, m²
    distances : (n,) m, thickness of an overlap, or largest gap between faces that nearly touch
    """

    pairs: Ints
    amounts: Floats
    distances: Floats

    def __len__(self) -> int:
        return len(self.amounts)


@dataclass(frozen=True)
class Facing:
    """Pairs of opposite faces of two blocks.

    Attributes
    ----------
    plus, minus : (n,) blocks
    least, most : (n,) m, how far apart the faces are where they face each other, negative where they overlap
    breadth : (n,) m of what they share: its length in a section, area / half of the perimeter of solids
    """

    plus: Ints
    minus: Ints
    least: Floats
    most: Floats
    breadth: Floats

    @property
    def pairs(self) -> Ints:
        """(n, 2) indices of the blocks, the lower first."""
        return np.sort(np.stack([self.plus, self.minus], axis=1), axis=1)

    def touches(self, tolerance: float, narrowest: float) -> Bools:
        """Return which faces touch (n,): within the tolerance (m) everywhere, over a breadth above `narrowest` (m)."""
        return np.asarray(
            (self.most <= tolerance) & (self.least >= -tolerance) & (self.breadth > narrowest)
        )

    def nearly_touches(self, tolerance: float, reach: float) -> Bools:
        """Return which faces nearly touch (n,): beyond the tolerance (m), within `reach` (m), on a greater breadth."""
        is_separate = (
            (self.most > tolerance) & (self.least >= -tolerance) & (self.least + self.most > 0.0)
        )
        return np.asarray(is_separate & (self.most <= reach) & (self.breadth > reach))


@dataclass(frozen=True)
class BlocksCut:
    """The user's blocks with their contacts, and how well they fit together.

    Attributes
    ----------
    assembly : patches have the joint 0; the plus block is the one that is not fixed, else the later one
    tolerance : faces nearer than this touch, and what depends on it
    contact : of all patches, m in a section, m² in space
    overlaps, gaps : between blocks of which one at least is not fixed
    outlines : of a section (k, 2) x and z of each block, anticlockwise, without corners that repeat or are straight
    point_contacts : how many pairs of blocks of a section touch with a corner only: they have no patch
    shells : (n,) closed surfaces of each solid; more than one is several bodies in one file, or a cavity
    unchecked : pairs of solids whose overlap could not be computed (a mesh that crosses itself)
    """

    assembly: Assembly
    tolerance: "ContactTolerance"
    contact: float
    overlaps: Misfits
    gaps: Misfits
    outlines: tuple[Floats, ...] = ()
    point_contacts: int = 0
    shells: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    unchecked: Ints = field(default_factory=lambda: np.zeros((0, 2), dtype=np.int64))

    @property
    def untouching(self) -> Ints:
        """Blocks that share no patch with any other."""
        patches = self.assembly.patches
        return np.setdiff1d(
            np.arange(len(self.assembly)), np.concatenate([patches.plus, patches.minus])
        )


@dataclass(frozen=True)
class ContactTolerance:
    """The distance within which faces touch, and the contacts that depend on it.

    Attributes
    ----------
    distance : m
    corner_rounding : m, the unit to which the corners are rounded, where the distance follows from it; else 0
    lost : (n, 2) pairs of blocks that touch less with a third of the distance; gained : that touch more with three
        times the distance. One block at least is not fixed
    """

    distance: float
    corner_rounding: float
    lost: Ints
    gained: Ints


def raise_faults(faults: Sequence[Fault]) -> None:
    """Raise all faults, if there are any."""
    if faults:
        raise GeometryError(faults)


def contact_tolerance(user_tolerance: float | None, sizes: Floats, rounding: float) -> float:
    """Return the contact tolerance (m) of the user, else 1e-5 of the mean block size and at least the rounding."""
    return (
        max(1e-5 * float(sizes.mean()), rounding)
        if user_tolerance is None
        else float(user_tolerance)
    )


def corner_unit(coordinates: Floats, is_single: bool = False) -> float:
    """Return the unit (m) to which coordinates are rounded: of their last decimal, or of single precision if coarser.

    Nine decimals and more count as none: 0.

    Parameters
    ----------
    is_single : whether the file holds the coordinates in single precision

    Examples
    --------
    >>> corner_unit(np.array([1.25, 3.0, -0.125]))
    0.001
    >>> corner_unit(np.array([512300.14, 0.25]), is_single=True)
    0.03125
    """
    single = coordinates.astype(np.float32)
    largest = float(np.abs(coordinates).max())
    resolution = float(np.spacing(np.float32(largest))) if is_single else 0.0
    for decimals in range(_MOST_DECIMALS):
        rounded = coordinates.round(decimals)
        is_unchanged = rounded.astype(np.float32) == single
        if not is_single:
            is_unchanged = np.abs(coordinates - rounded) <= 4.0 * np.spacing(largest)
        if is_unchanged.all():
            return max(10.0**-decimals, resolution)
    return resolution


def widest_rounding(sizes: Floats, thicknesses: Floats) -> float:
    """Return the largest tolerance (m) that rounded corners can ask for.

    Rounding to more than 1 % of the blocks leaves no shape to judge, and whole numbers are exact as a rule. Across a
    thin block its neighbours must not touch.
    """
    size_bound, thickness_bound = (
        LARGEST_ROUNDING * sizes.mean(),
        LARGEST_ROUNDING_OF_THINNEST * thicknesses.min(),
    )
    return float(min(size_bound, thickness_bound))


def fitting_tolerance(
    exact_tolerance: float,
    corner_rounding: float,
    dimensions: int,
    widest: float,
    facing: Facing,
    movable: Bools,
) -> ContactTolerance:
    """Return the contact tolerance of exact corners, or that of rounded corners where the exact one loses contacts.

    A corner that is rounded to a unit u moves by up to u / 2 along each of k axes, √k u / 2 in all, and so does the
    face at it: two faces that touched lie up to √k u apart, or in each other.

    Parameters
    ----------
    exact_tolerance : m, of blocks with exact corners; corner_rounding : m, 0 where the corners are exact
    dimensions : k, 2 in a section, 3 in space
    widest : m, the largest tolerance of rounded corners (`widest_rounding`)
    movable : (n,) whether of the blocks of each pair of faces one at least is not fixed
    """
    wider = min(float(np.sqrt(dimensions)) * corner_rounding, widest)
    distance, unit = exact_tolerance, 0.0
    if (
        wider > exact_tolerance
        and (
            movable & (facing.touches(exact_tolerance, wider) != facing.touches(wider, wider))
        ).any()
    ):
        distance, unit = wider, corner_rounding
    touching, touching_narrow, touching_wide = (
        facing.touches(distance * multiple, distance) for multiple in (1.0, 1.0 / DOUBT, DOUBT)
    )
    changes = (movable & touching & ~touching_narrow, movable & touching_wide & ~touching)
    lost, gained = (np.unique(facing.pairs[change], axis=0) for change in changes)
    return ContactTolerance(distance, unit, lost, gained)


def size_faults(sizes: Floats, tolerance: float, names: Sequence[str]) -> list[Fault]:
    """Return the fault E230 where blocks are smaller than ten contact tolerances: their contacts would be arbitrary."""
    small = np.flatnonzero(sizes < 10.0 * tolerance).tolist()
    if not small:
        return []
    message = (
        f"the contact tolerance ({tolerance:.3g} m) is no smaller than a tenth of {names[small[0]]}"
    )
    more = f", and of {len(small) - 1} more blocks" if len(small) > 1 else ""
    return [Fault("E230", message + more + f", {sizes[small[0]]:.3g} m in size")]
