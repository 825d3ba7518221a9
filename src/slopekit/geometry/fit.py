"""How well the user's blocks fit together: what overlaps, what nearly touches. Values, for the caller to judge."""

from collections.abc import Sequence

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.core.errors import Fault, GeometryError
from slopekit.core.records import dataclass
from slopekit.geometry.tolerances import DOUBT, LARGEST_ROUNDING, LARGEST_ROUNDING_OF_THINNEST

_MOST_DECIMALS = 9


@dataclass(frozen=True, slots=True)
class Overlaps:
    """Pairs of blocks that lie in each other by more than the tolerance.

    Attributes
    ----------
    pairs : (n, 2) indices of the blocks, the lower first
    amounts : (n,) m² in a section, m³ of solids
    depths : (n,) m, how thick the overlap is where it is thin and long: amount / half of its boundary
    """

    pairs: Ints
    amounts: Floats
    depths: Floats

    def __len__(self) -> int:
        return len(self.amounts)


@dataclass(frozen=True, slots=True)
class Gaps:
    """Places where faces of two blocks nearly touch: farther apart than the tolerance, by less than 1 % of a block.

    Attributes
    ----------
    pairs : (n, 2) indices of the blocks, the lower first; a pair stands once for each place
    least, most : (n,) m, how far apart the faces are at the two ends (or corners) of the place
    amounts : (n,) m along which they face each other in a section, m² of solids
    """

    pairs: Ints
    least: Floats
    most: Floats
    amounts: Floats

    def __len__(self) -> int:
        return len(self.amounts)


@dataclass(frozen=True, slots=True)
class Closeness:
    """How near faces of two blocks lie that look at each other.

    Attributes
    ----------
    pairs : (n, 2) indices of the blocks, the lower first; a pair stands once for each pair of its faces
    least, most : (n,) m, how far apart the faces are where they face each other, negative where they overlap
    breadth : (n,) m of what they share: its length in a section, area / half of the perimeter of solids
    """

    pairs: Ints
    least: Floats
    most: Floats
    breadth: Floats

    def touches(self, tolerance: float, narrowest: float) -> Bools:
        """Return which faces touch: nowhere farther than the tolerance from each other, on more than the narrowest."""
        return np.asarray((self.most <= tolerance) & (self.least >= -tolerance) & (self.breadth > narrowest))


@dataclass(frozen=True, slots=True)
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


def refuse(faults: Sequence[Fault]) -> None:
    """Raise all faults, if there are any."""
    if faults:
        raise GeometryError(faults)


def contact_tolerance(given: float | None, sizes: Floats, rounding: float) -> float:
    """The tolerance (m) that was given, else 1e-5 of the mean size of the blocks, and not below rounding.

    Raises
    ------
    GeometryError
        E230 it is not more than 0.
    """
    if given is None:
        return max(1e-5 * float(sizes.mean()), rounding)
    if not 0.0 < given < np.inf:
        raise GeometryError([Fault("E230", f"the contact tolerance is {given:.6g} m, it must be more than 0")])
    return float(given)


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
        same = rounded.astype(np.float32) == single
        if not is_single:
            same = np.abs(coordinates - rounded) <= 4.0 * np.spacing(largest)
        if same.all():
            return max(10.0**-decimals, resolution)
    return resolution


def widest_rounding(sizes: Floats, thicknesses: Floats) -> float:
    """Return the largest tolerance (m) that rounded corners can ask for.

    Rounding to more than 1 % of the blocks leaves no shape to judge, and whole numbers are exact as a rule. Across a
    thin block its neighbours must not touch.
    """
    of_sizes, of_thinnest = LARGEST_ROUNDING * sizes.mean(), LARGEST_ROUNDING_OF_THINNEST * thicknesses.min()
    return float(min(of_sizes, of_thinnest))


def fitting_tolerance(
    usual: float, corner_rounding: float, dimensions: int, widest: float, closeness: Closeness
) -> ContactTolerance:
    """Return the usual tolerance, or that of corners that are rounded where the usual one loses contacts by it.

    A corner that is rounded to a unit u moves by up to u / 2 along each of k axes, √k u / 2 in all, and so does the
    face at it: two faces that touched lie up to √k u apart, or in each other.

    Parameters
    ----------
    usual : m, of blocks with exact corners; corner_rounding : m, 0 where the corners are exact
    dimensions : k, 2 in a section, 3 in space
    widest : m, the largest tolerance of rounded corners (`widest_rounding`)
    closeness : of faces of blocks of which one at least is not fixed
    """
    wider = min(float(np.sqrt(dimensions)) * corner_rounding, widest)
    distance, unit = usual, 0.0
    if wider > usual and (closeness.touches(usual, wider) != closeness.touches(wider, wider)).any():
        distance, unit = wider, corner_rounding
    usually, narrowly, widely = (closeness.touches(distance * times, distance) for times in (1.0, 1.0 / DOUBT, DOUBT))
    lost, gained = (np.unique(closeness.pairs[other], axis=0) for other in (usually & ~narrowly, widely & ~usually))
    return ContactTolerance(distance, unit, lost, gained)


def size_faults(sizes: Floats, tolerance: float, names: Sequence[str]) -> list[Fault]:
    """E230 where blocks are smaller than ten tolerances: what touches could not be told from what does not."""
    small = np.flatnonzero(sizes < 10.0 * tolerance).tolist()
    if not small:
        return []
    message = f"the contact tolerance ({tolerance:.3g} m) is no smaller than a tenth of {names[small[0]]}"
    more = f", and of {len(small) - 1} more blocks" if len(small) > 1 else ""
    return [Fault("E230", message + more + f", {sizes[small[0]]:.3g} m in size")]
