"""How well the user's blocks fit together: what overlaps, what nearly touches. Values, for the caller to judge."""

from collections.abc import Sequence

import numpy as np

from slopekit.core.arrays import Floats, Ints
from slopekit.core.errors import Fault, GeometryError
from slopekit.core.records import dataclass


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


def size_faults(sizes: Floats, tolerance: float, names: Sequence[str]) -> list[Fault]:
    """E230 where blocks are smaller than ten tolerances: what touches could not be told from what does not."""
    small = np.flatnonzero(sizes < 10.0 * tolerance).tolist()
    if not small:
        return []
    message = f"the contact tolerance ({tolerance:.3g} m) is no smaller than a tenth of {names[small[0]]}"
    more = f", and of {len(small) - 1} more blocks" if len(small) > 1 else ""
    return [Fault("E230", message + more + f", {sizes[small[0]]:.3g} m in size")]
