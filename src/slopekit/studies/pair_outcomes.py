"""All pairs of a joint list by the vectorised closed form: what becomes of each, and their ranking."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slopekit.arrays import Bools, Floats, Ints
from slopekit.closed_form.wedge import OUTCOMES, WedgeArrays, hoek_bray_wedges
from slopekit.design.joint_lists import JointList
from slopekit.design.wedge import WedgeDesign
from slopekit.studies.pair_shapes import PairShapes, SizeLimits, pair_shapes

#: Why a pair cuts no wedge that could leave the slope, by the code that one wedge would have (`explain CODE`).
NOT_REMOVABLE: Mapping[str, str] = {
    "E201": "parallel", "E203": "too_steep", "E204": "into_the_slope", "E205": "flatter_than_upper_slope",
    "E206": "along_the_face", "E207": "no_crack", "E208": "no_wedge", "E209": "no_crest",
}  # fmt: skip
#: What may become of a pair.
PAIR_OUTCOMES = (*(NOT_REMOVABLE.get(name, name) for name in OUTCOMES), "below_min_volume")
TOO_SMALL = len(OUTCOMES)
NEVER = ("no_crack", "no_crest")  # pairs have no crack, and the crest is looked at before
_STATUSES = OUTCOMES.index("E201")  # below it: a wedge is there
_SLIDES = tuple(OUTCOMES.index(f"slides_{way}") for way in ("on_both", "on_J1", "on_J2", "up"))
_STANDS = OUTCOMES.index("no_driving_force")
_NO_CORNER = OUTCOMES.index("E206")
_AT_ONCE = 1 << 18  # pairs: 4.5 million at a time would take gigabytes


@dataclass(frozen=True, slots=True)
class Pairs:
    """Every pair of the list, (m,) each.

    Attributes
    ----------
    shapes : the joints of each pair, its height and scale
    outcome : index into `PAIR_OUTCOMES`; factor : of the closed form, nan unless the wedge slides
    volume_m3, trend_deg, plunge_deg : of the wedge at its size and its line of intersection, nan where there is none
    """

    shapes: PairShapes
    outcome: NDArray[np.int8]
    factor: Floats
    volume_m3: Floats
    trend_deg: Floats
    plunge_deg: Floats

    def __len__(self) -> int:
        return len(self.outcome)

    @property
    def is_removable(self) -> Bools:
        """Which pairs form a wedge that could leave the slope, and is large enough to count."""
        found: Bools = self.outcome < _STATUSES
        return found

    def ranked(self) -> Ints:
        """The removable pairs: what nothing holds, then by factor, ties by volume (larger first), then what stands."""
        removable = np.flatnonzero(self.is_removable)
        outcome, factor = self.outcome[removable], self.factor[removable]
        rank = np.where(np.isin(outcome, _SLIDES), 1, np.where(outcome == _STANDS, 2, 0))
        order = np.lexsort((-self.volume_m3[removable], np.nan_to_num(factor), rank))
        return removable[order]

    def fails(self, target: float) -> Bools:
        """Which of all pairs lie below a factor of safety by the closed form; what nothing holds is among them."""
        slides = np.isin(self.outcome, _SLIDES)
        found: Bools = self.is_removable & ((slides & (self.factor < target)) | (~slides & (self.outcome != _STANDS)))
        return found


def evaluated(joints: JointList, slope: WedgeDesign, limits: SizeLimits, cohesion: Floats, friction: Floats) -> Pairs:
    """All pairs by the vectorised closed form, each wedge at the size that the limits leave it."""
    first, second = joints.pairs()
    parts = [
        _part(joints, slope, limits, cohesion, friction, first[at : at + _AT_ONCE], second[at : at + _AT_ONCE])
        for at in range(0, len(first), _AT_ONCE)
    ]
    if len(parts) == 1:
        return parts[0]
    shapes = PairShapes(
        *(np.concatenate([getattr(part.shapes, name) for part in parts]) for name in PairShapes.__slots__)
    )
    rest = ("outcome", "factor", "volume_m3", "trend_deg", "plunge_deg")
    return Pairs(shapes, *(np.concatenate([getattr(part, name) for part in parts]) for name in rest))


def _part(
    joints: JointList, slope: WedgeDesign, limits: SizeLimits, cohesion: Floats, friction: Floats, first: Ints,
    second: Ints,
) -> Pairs:  # fmt: skip
    shapes = pair_shapes(joints.normals(), first, second, slope.face, slope.upper, slope.height_m, limits)
    one, two = shapes.first, shapes.second
    climbs = shapes.height_m > 0.0
    dips, ways = joints.dips_deg, joints.dip_directions_deg
    found = hoek_bray_wedges(
        WedgeArrays(
            joint1_dip_deg=dips[one], joint1_dip_direction_deg=ways[one], joint2_dip_deg=dips[two],
            joint2_dip_direction_deg=ways[two], face_dip_deg=slope.face.dip_deg,
            face_dip_direction_deg=slope.face.dip_direction_deg, upper_dip_deg=slope.upper.dip_deg,
            upper_dip_direction_deg=slope.upper.dip_direction_deg, height_m=np.where(climbs, shapes.height_m, 1.0),
            cohesion1_kpa=cohesion[one], cohesion2_kpa=cohesion[two], friction1_deg=friction[one],
            friction2_deg=friction[two], unit_weight_kn_m3=slope.unit_weight_kn_m3, fill=slope.water.fill,
            pressures_kpa=slope.water.pressures_kpa[:2], water_unit_weight_kn_m3=slope.water_unit_weight_kn_m3,
            seismic=slope.seismic.coefficient, seismic_trend_deg=slope.seismic.trend_deg,
        ),
    )  # fmt: skip
    outcome, volume = found.outcome.copy(), found.volume_m3
    outcome[~climbs & (outcome < _STATUSES)] = _NO_CORNER
    if limits.min_volume_m3:
        outcome[(outcome < _STATUSES) & (volume < limits.min_volume_m3)] = TOO_SMALL
    factor = np.where(np.isin(outcome, _SLIDES), found.factor, np.nan)
    return Pairs(shapes, outcome, factor, volume, *found.line_trend_plunge_deg())
