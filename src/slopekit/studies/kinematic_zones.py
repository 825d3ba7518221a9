"""The kinematic tests as zones of the stereonet: the same criteria, asked of directions in place of joints."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slopekit.arrays import Bools, Floats
from slopekit.orientation import Plane, normals
from slopekit.studies.kinematic_criteria import NO_WEDGE, SECONDARY, Lines, Modes, modes_of


@dataclass(frozen=True, slots=True)
class Planes:
    """Orientations (n,) in degrees, as the criteria take them."""

    dips_deg: Floats
    dip_directions_deg: Floats

    def __len__(self) -> int:
        return len(self.dips_deg)

    def normals(self) -> Floats:
        """(n, 3) upward unit normals."""
        return normals(self.dips_deg, self.dip_directions_deg)

    def pairs(self) -> tuple[NDArray[Any], NDArray[Any]]:
        """The first and second of every pair."""
        return np.triu_indices(len(self), 1)


def planes_of_poles(poles: Floats) -> Planes:
    """The planes of downward poles (n, 3).

    >>> found = planes_of_poles(np.array([[0.0, 0.6, -0.8]]))
    >>> found.dips_deg.round(4).tolist(), found.dip_directions_deg.tolist()
    ([36.8699], [180.0])
    """
    dips = np.degrees(np.arctan2(np.hypot(poles[:, 0], poles[:, 1]), -poles[:, 2]))
    return Planes(dips, np.degrees(np.arctan2(-poles[:, 0], -poles[:, 1])) % 360.0)


def zones_of_poles(
    poles: Floats, face: Plane, friction_deg: float, lateral_deg: float, lateral_toppling_deg: float
) -> dict[str, Bools]:
    """Where joints with these downward poles (n, 3) could move: (n,) for each of `OF_JOINTS`."""
    planes = planes_of_poles(poles)
    none = np.zeros(0)
    no_lines = Lines(none.astype(np.intp), none.astype(np.intp), np.zeros((0, 3)), none, none, none, none)
    friction = np.full(len(planes), friction_deg)
    return modes_of(planes, no_lines, face, friction, lateral_deg, lateral_toppling_deg).of_joints()


def zones_of_lines(
    down: Floats, face: Plane, friction_deg: float, lateral_deg: float, lateral_toppling_deg: float
) -> dict[str, Bools]:
    """Where lines of intersection (n, 3), downward, could be the way of a wedge or the edge of a column: (n,) each.

    wedge_primary, wedge_secondary_of_dips, direct, oblique: what depends on the line alone. Whether a wedge slides in
    the secondary zone depends on its joints.
    """
    any_two, count = Planes(np.array([45.0, 45.0]), np.array([115.0, 245.0])), len(down)
    trend = np.degrees(np.arctan2(down[:, 0], down[:, 1])) % 360.0
    plunge = np.degrees(np.arctan2(-down[:, 2], np.hypot(down[:, 0], down[:, 1])))
    first = np.zeros(count, dtype=np.intp)
    lines = Lines(first, first + 1, down, trend, plunge, np.zeros(count), np.ones(count))
    modes: Modes = modes_of(any_two, lines, face, np.full(2, friction_deg), lateral_deg, lateral_toppling_deg)
    found = modes.of_lines()
    return {
        "wedge_primary": (modes.wedge != NO_WEDGE) & (modes.wedge != SECONDARY),
        "wedge_secondary_of_dips": modes.secondary_of_dips,
        "direct": found["direct"], "oblique": found["oblique"],
    }  # fmt: skip
