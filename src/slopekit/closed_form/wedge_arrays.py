"""Many wedges at once: what is given of them, and what the closed form says of each."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from slopekit.closed_form.given import Codes, Columns, Floats, columns_of

#: What may become of a wedge: the statuses of `hoek_bray_wedge`, and the codes of the planes that cut none.
OUTCOMES: Final = (
    "slides_on_both", "slides_on_J1", "slides_on_J2", "slides_up", "lifted", "falls", "no_driving_force",
    "E201", "E203", "E204", "E205", "E206", "E207", "E208", "E209",
)  # fmt: skip
NUMBER_OF: Final = {name: number for number, name in enumerate(OUTCOMES)}


@dataclass(frozen=True, slots=True, kw_only=True)
class WedgeArrays:
    """Wedges, each value one number for all of them or an (n,) array; in degrees, m, kN and kPa.

    Attributes
    ----------
    joint1_dip_deg, joint1_dip_direction_deg, joint2_..., face_..., upper_... : the planes
    height_m : vertical, from the toe to where the trace of J1 meets the crest
    cohesion1_kpa, cohesion2_kpa, friction1_deg, friction2_deg : of J1 and J2
    unit_weight_kn_m3 : of the rock
    fill : part of full water pressure (0 dry, 1 full)
    pressures_kpa : mean pressures on J1, J2 and maybe the crack, instead of `fill`
    water_unit_weight_kn_m3 : of the water
    crack_fill : the crack's own part of full pressure, None where it has what the joints have
    crack_dip_deg, crack_dip_direction_deg : None without a tension crack
    crack_distance_m : from the crest along the trace of J1
    seismic : coefficient; seismic_trend_deg : None for the trend of the line of intersection
    force_kn : east, north and up: the sum of the forces and the active bolts; None without any
    """

    joint1_dip_deg: ArrayLike
    joint1_dip_direction_deg: ArrayLike
    joint2_dip_deg: ArrayLike
    joint2_dip_direction_deg: ArrayLike
    face_dip_deg: ArrayLike
    face_dip_direction_deg: ArrayLike
    upper_dip_deg: ArrayLike
    upper_dip_direction_deg: ArrayLike
    height_m: ArrayLike
    cohesion1_kpa: ArrayLike
    cohesion2_kpa: ArrayLike
    friction1_deg: ArrayLike
    friction2_deg: ArrayLike
    unit_weight_kn_m3: ArrayLike
    fill: ArrayLike = 0.0
    pressures_kpa: Sequence[ArrayLike] = ()
    water_unit_weight_kn_m3: ArrayLike = 9.81
    crack_fill: ArrayLike | None = None
    crack_dip_deg: ArrayLike | None = None
    crack_dip_direction_deg: ArrayLike | None = None
    crack_distance_m: ArrayLike = 0.0
    seismic: ArrayLike = 0.0
    seismic_trend_deg: ArrayLike | None = None
    force_kn: Sequence[ArrayLike] | None = None


@dataclass(frozen=True, slots=True)
class WedgeShapes:
    """The wedges themselves, nan where the planes cut none.

    Attributes
    ----------
    volume_m3, weight_kn, total_height_m : (n,)
    areas_m2 : (n, 3) of J1, J2 and the crack
    line_trend_deg, line_plunge_deg, line_length_m : (n,) of the line of intersection, as far as it bounds the wedge
    """

    volume_m3: Floats
    weight_kn: Floats
    total_height_m: Floats
    areas_m2: Floats
    line_trend_deg: Floats
    line_plunge_deg: Floats
    line_length_m: Floats


@dataclass(frozen=True, slots=True)
class ClosedFormWedges:
    """What the closed form says of many wedges.

    Attributes
    ----------
    outcome : (n,) int8, an index into `OUTCOMES`
    factor : (n,) factor of safety, nan unless the wedge slides
    shapes : the wedges themselves, where they were asked for
    """

    outcome: Codes
    factor: Floats
    shapes: WedgeShapes | None = None

    def counts(self) -> dict[str, int]:
        """How many wedges there are of each outcome, in the order of `OUTCOMES`, the absent ones left out."""
        found = np.bincount(self.outcome, minlength=len(OUTCOMES))
        return {name: int(number) for name, number in zip(OUTCOMES, found, strict=True) if number}


def wedge_columns(wedges: WedgeArrays) -> tuple[Columns, int]:
    """What is given, by name, each a float or an (n,) array; n.

    Raises
    ------
    ValueError
        Where the arrays do not fit together, or the crack lacks one of its angles.
    """
    given: dict[str, ArrayLike | None] = {field.name: getattr(wedges, field.name) for field in fields(WedgeArrays)}
    for several in ("pressures_kpa", "force_kn"):
        del given[several]
    if len(wedges.pressures_kpa) not in (0, 2, 3):
        raise ValueError(f"pressures_kpa holds {len(wedges.pressures_kpa)} values: J1, J2 and maybe the crack")
    given |= {f"pressure{k}_kpa": value for k, value in enumerate(wedges.pressures_kpa, 1)}
    if wedges.force_kn is not None:
        given |= dict(zip(("force_east_kn", "force_north_kn", "force_up_kn"), wedges.force_kn, strict=True))
    if (wedges.crack_dip_deg is None) != (wedges.crack_dip_direction_deg is None):
        raise ValueError("crack_dip_deg and crack_dip_direction_deg: give both or neither")
    columns, count = columns_of(given)
    if isinstance(columns["seismic"], float) and columns["seismic"] == 0.0:
        del columns["seismic"]
    return columns, count
