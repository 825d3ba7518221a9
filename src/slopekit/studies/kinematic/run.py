"""A joint survey tested against a slope: planar and wedge sliding, flexural and direct toppling.

The criteria and their sources stand in `criteria`.

>>> import slopekit as sk
>>> found = sk.kinematic(["40/175", "35/090", "75/010"], face="65/180", phi=30)
>>> found.counts["planar"], found.joint_names("planar"), found.joint_names("flexural")
(1, ('J1',), ('J3',))
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.codec import digest
from slopekit.core.errors import Faults, Notice
from slopekit.core.orientation import Plane, number
from slopekit.core.units import quantity
from slopekit.design.fields import fields_of
from slopekit.design.joint_lists import JointList, joint_list, measured_or_common, slope_plane
from slopekit.design.parts import Strength
from slopekit.studies.kinematic.criteria import (
    JOINT_MODES,
    Lines,
    Modes,
    lines_of,
    modes_of,
    tested_pairs,
)
from slopekit.studies.protocol import (
    DESK,
    Option,
    StudyOutcome,
    Workplace,
    documented,
    numbers_given,
    timed,
)
from slopekit.studies.surveys import (
    LATERAL_LIMITS,
    MOST_JOINTS,
    AFace,
    AJointList,
    Columns,
    Convention,
    SkipBad,
    joint_list_notices,
    range_of,
    survey_head,
)

PHI_DEG = 30.0
SEED = 1  # of the pairs that are drawn where there are too many


@dataclass(frozen=True, repr=False)
class Kinematic(StudyOutcome):
    """A survey tested against a slope.

    Attributes
    ----------
    friction_deg : (n,) of each joint; measured : how many have their own
    lines, modes : see there; a stereonet needs no more than these, the joints and the limits
    pairs : whose lines these are, all or as many as were drawn
    percent : parts of the joints and of the lines. A joint counts by its quantity, a line by the product of those of
        its two joints, as that many joints would
    """

    name: ClassVar[str] = "kinematic"
    charts: ClassVar[tuple[str, ...]] = ("stereonet",)
    joints: JointList
    face: Plane
    friction_deg: Floats
    measured: int
    lateral_deg: float
    lateral_toppling_deg: float
    lines: Lines
    pairs: int
    modes: Modes
    percent: Mapping[str, float | None]
    defaults: tuple[str, ...]
    warnings: tuple[Notice, ...]

    @property
    def counts(self) -> dict[str, int]:
        """Numbers of joints and lines of intersection by failure mode."""
        return self.modes.counts()

    @property
    def is_sample(self) -> bool:
        """Whether pairs were drawn, as there are too many to test all."""
        return self.pairs < len(self.joints) * (len(self.joints) - 1) // 2

    @property
    def toppling(self) -> tuple[bool, bool]:
        """Whether columns could topple directly, and obliquely: edges and bases are there."""
        counts = self.counts
        direct = bool(counts["direct"] and counts["base_sliding"] + counts["base_release"])
        return direct, bool(counts["oblique"] and counts["base_release"] + counts["base_oblique"])

    def joint_names(self, kind: str) -> tuple[str, ...]:
        """The joints of one kind (`JOINT_MODES`), in the order of the list."""
        is_critical = self.modes.of_joints()[kind]
        return tuple(
            joint.name
            for joint, critical in zip(self.joints.joints, is_critical, strict=True)
            if critical
        )

    def by_set(self) -> dict[str, dict[str, int]]:
        """Joints of each set, and those of them that could move; joints without a set stand under an empty name."""
        if not self.joints.sets():
            return {}
        set_names = np.array([joint.set_name for joint in self.joints.joints])
        kinds = self.modes.of_joints()
        return {
            name: {"joints": int((set_names == name).sum())}
            | {
                kind: int((critical & (set_names == name)).sum())
                for kind, critical in kinds.items()
            }
            for name in (*self.joints.sets(), *([""] if (set_names == "").any() else []))
        }

    def by_set_pair(self) -> dict[tuple[str, str], dict[str, int]]:
        """Lines of intersection of each two sets, and those of them that could move."""
        if not self.joints.sets():
            return {}
        sets = list(self.by_set())
        number_of = {name: k for k, name in enumerate(sets)}
        set_numbers = np.array([number_of[joint.set_name] for joint in self.joints.joints])
        a, b = set_numbers[self.lines.first], set_numbers[self.lines.second]
        key = np.minimum(a, b) * len(sets) + np.maximum(a, b)
        size = len(sets) ** 2
        counted = {"lines": np.bincount(key, minlength=size)}
        counted |= {
            kind: np.bincount(key[lines], minlength=size)
            for kind, lines in self.modes.of_lines().items()
        }
        return {
            (sets[k // len(sets)], sets[k % len(sets)]): {
                kind: int(lines[k]) for kind, lines in counted.items()
            }
            for k in np.flatnonzero(counted["lines"])
        }

    def input_hash(self) -> str:
        """SHA-256 of the face, the limits and the joints with their friction angles."""
        face = (self.face.dip_deg, self.face.dip_direction_deg)
        exact = [
            face,
            (self.lateral_deg, self.lateral_toppling_deg),
            self.joints.rows(),
            self.friction_deg.tolist(),
        ]
        exact += [self.joints.quantities.tolist()] if self.joints.has_quantities else []
        exact += [SEED] if self.is_sample else []
        return digest(exact)

    def inputs(self) -> dict[str, Any]:
        """The inputs beside the joints, as JSON values."""
        return {
            "face": str(self.face),
            "friction_deg": range_of(self.friction_deg, self.measured),
            "lateral_deg": self.lateral_deg,
            "lateral_toppling_deg": self.lateral_toppling_deg,
        } | ({"seed": SEED} if self.is_sample else {})

    def to_dict(self) -> dict[str, Any]:
        """The result as JSON values; critical lines are counted by joint, `intersections.csv` has them all."""
        n, m = len(self.joints), len(self.lines.first)
        direct, oblique = self.toppling
        return {
            **survey_head("kinematic", self.joints, self.input_hash()),
            "inputs": self.inputs(),
            "defaults": list(self.defaults),
            "joints": n,
            "orientations": [
                {
                    "joint": name,
                    "set": set_name,
                    "dip_deg": dip,
                    "dip_direction_deg": direction,
                    "friction_deg": friction,
                }
                for (name, set_name, dip, direction), friction in zip(
                    self.joints.rows(), self.friction_deg.tolist(), strict=True
                )
            ],
            "pairs": n * (n - 1) // 2,
            **({"drawn_pairs": self.pairs} if self.is_sample else {}),
            "intersections": m,
            "counts": self.counts,
            "percent": dict(self.percent),
            "direct_toppling": direct,
            "oblique_toppling": oblique,
            "critical_joints": {kind: list(self.joint_names(kind)) for kind in JOINT_MODES},
            "sets": [{"set": name} | tally for name, tally in self.by_set().items()],
            "set_pairs": [
                {"sets": list(names)} | tally for names, tally in self.by_set_pair().items()
            ],
            "timing_s": {"total": self.seconds},
            **self.words(),
        }


@timed
@documented
def kinematic(
    joints: AJointList,
    *,
    face: AFace = None,
    phi: Annotated[Any, Option("Friction angle of joints without their own [30].")] = None,
    lateral: Annotated[Any, Option("Lateral limit of planar sliding [20].")] = None,
    lateral_toppling: Annotated[Any, Option("Lateral limit of toppling [30].")] = None,
    convention: Convention = None,
    columns: Columns = None,
    skip_bad: SkipBad = False,
    desk: Workplace = DESK,
) -> Kinematic:
    """Planar and wedge sliding, flexural and direct toppling of every joint and pair, by orientation and friction.

    Raises
    ------
    DesignError
        With every fault: of the list, E113, E115 for phi, E143 without a face, E312 for the faces, E307 for the
        lateral limits.

    Notes
    -----
    In Python `joints` are the path of a CSV file, planes ("45/115", (45, 115)), an (n, 2) array of dip and dip
    direction, or {name: plane}; `faces` may be a list. Of more than 3000 joints a million pairs are drawn.

    With face dip ψ_f, plane or line ψ and friction φ: planar and wedge sliding where φ < ψ < the apparent dip of the
    face that way, planes within `lateral` of the dip direction of the face; flexural toppling where
    (90° - ψ) + φ <= ψ_f and the plane strikes within its lateral limit; direct toppling by the lines that two joints
    form into the slope and the planes they stand on. Cohesion, water and size have no say: see `combos`.

    References
    ----------
    Goodman (1980), Introduction to Rock Mechanics; Wyllie & Mah (2004), Rock Slope Engineering, ch. 2 and 9.

    Examples
    --------
    >>> import slopekit as sk
    >>> sk.kinematic(["40/175", "75/010"], face="65/180", phi=30).joint_names("planar")
    ('J1',)
    """
    faults, defaults = Faults(), list[str]()

    listed: JointList | None = faults.of(
        lambda: joint_list(
            joints,
            convention,
            skip_bad,
            1,
            desk.named("convention"),
            most=MOST_JOINTS,
            columns=columns,
        )
    )
    plane: Plane | None = faults.of(lambda: slope_plane(face, "face", desk.named("face")))
    friction_angle = (
        faults.of(lambda: _friction(phi, f"{desk.named('phi')} {phi}"))
        if phi is not None
        else PHI_DEG
    )
    limits = {"lateral": lateral, "lateral_toppling": lateral_toppling}
    defaults += [key for key, value in limits.items() if value is None]
    limits_deg = numbers_given(LATERAL_LIMITS, limits, desk.named, faults)
    faults.refuse()
    assert listed is not None and plane is not None  # noqa: PT018  # no fault: nothing is missing
    lateral_deg, toppling_deg = (limit or 0.0 for limit in limits_deg.values())
    friction, measured, _ = measured_or_common(listed, "phi", friction_angle, desk.named("phi"))
    if phi is None and measured < len(listed):
        defaults.append("phi")
    pairs = tested_pairs(listed, np.random.default_rng(SEED))
    lines = lines_of(listed, pairs)
    weights = listed.quantities, listed.quantities[lines.first] * listed.quantities[lines.second]
    modes = modes_of(listed, lines, plane, friction, lateral_deg, toppling_deg)
    return Kinematic(
        listed,
        plane,
        friction,
        measured,
        lateral_deg,
        toppling_deg,
        lines,
        len(pairs[0]),
        modes,
        modes.shares(*weights),
        tuple(defaults),
        tuple(_notices(listed, plane, friction)),
    )


def _friction(value: object, option: str) -> float:
    friction_deg = quantity(value, "angle", "phi", option)
    return fields_of(Strength)["friction_angle_deg"].checked(
        friction_deg, "phi", option, str(value)
    )


def _notices(joints: JointList, face: Plane, friction: Floats) -> Iterator[Notice]:
    """Yield what is not used of the list, and how percentages are counted."""
    yield from joint_list_notices(joints)
    if joints.has_quantities:
        yield Notice(
            "W373",
            f"percentages count each joint of {joints.name} by its quantity ({len(joints)} joints, "
            f"{joints.quantities.sum():.6g} by quantity) and each line by the product of its two; counts are of rows",
        )
    if any(joint.cohesion_kpa for joint in joints.joints):
        yield Notice(
            "W366",
            "the cohesion of the list is left out: kinematic tests know friction alone, combos takes it",
        )
    if face.dip_deg <= float(friction.min()):
        yield Notice(
            "W369",
            f"the face dips {number(face.dip_deg)}°, no steeper than friction: nothing slides out of it",
        )
