"""A survey that was dropped on the page: its planes, its sets, every pair as a wedge in the design's own slope.

>>> from slopekit.app.session import Session, opened_template
>>> text = "name,dip,dip_direction\\nA,45,115\\nB,45,245\\nC,80,350\\n"
>>> found = read_dropped_survey(Session(opened_template("wedge")).design, "joints.csv", text)
>>> [(pair["names"], round(pair["fos"], 4)) for pair in found.message["pairs"]]
[(['A', 'B'], 1.5574)]
>>> print(found.design_of_pair(found.message["pairs"][0]["n"]).partition("joints:")[2].partition("rock")[0], end="")
<BLANKLINE>
  A: {plane: 45.0/115.0, strength: joints}
  B: {plane: 45.0/245.0, strength: joints}
strength:
  joints: {c: 50.0, phi: 20.0}
"""

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from slopekit.app import answers
from slopekit.core.errors import DesignError, Fault, Notice
from slopekit.core.orientation import Plane, normals
from slopekit.design.common import Design
from slopekit.design.joint_lists import JointList
from slopekit.design.reading.nodes import as_text
from slopekit.design.survey import MeasuredJoint, read_joints_text
from slopekit.kinds import status_text
from slopekit.studies.combos import Combos, combos
from slopekit.studies.kinematic.criteria import planes_of_poles

_MOST_PAIRS = 200  # that the page is sent
_BY_BOTH = 100  # joints: pairs of more are ranked by the closed form, while somebody waits
_BY_FORCES = Notice(
    "W353",
    f"pairs of more than {_BY_BOTH} joints are ranked by the closed form here, which balances no moments: slopekit "
    "combos judges them by both methods",
)
_NAME = re.compile(r"[^\W_][\w-]{0,39}")


@dataclass(frozen=True)
class DroppedSurvey:
    """A survey and its pairs; `message` is what the page is told."""

    joints: JointList
    combinations: Combos | None
    message: dict[str, Any]

    def design_of_pair(self, number: int) -> str:
        """The text of a design file of a pair.

        Raises
        ------
        DesignError
            E548 for a number that is no pair.
        """
        pair_numbers = {pair["n"] for pair in self.message["pairs"]}
        if self.combinations is None or number not in pair_numbers:
            raise DesignError([Fault("E548", f"there is no pair {number} of the survey")])
        inputs, pairs = self.combinations.given, self.combinations.pairs
        both = [int(pairs.first[number]), int(pairs.second[number])]
        joints = [self.joints.joints[k] for k in both]
        laws = [(float(inputs.cohesion_kpa[k]), float(inputs.friction_deg[k])) for k in both]
        names = _names(joints)
        strength_names = ["joints", "joints"] if laws[0] == laws[1] else names
        slope = inputs.slope
        strengths = dict(zip(strength_names, laws, strict=True))
        title = f"{joints[0].name} and {joints[1].name} of {self.joints.name}"
        lines = [
            "slopekit: 1",
            "kind: wedge",
            f"title: {json.dumps(title, ensure_ascii=False)}",
            f"slope: {{face: {as_text(slope.face)}, upper: {as_text(slope.upper)}, "
            f"height: {float(pairs.height_m[number])!r} m}}",
            "joints:",
            *(
                f"  {name}: {{plane: {as_text(joint.plane)}, strength: {law}}}"
                for name, joint, law in zip(names, joints, strength_names, strict=True)
            ),
            "strength:",
            *(f"  {name}: {{c: {c!r}, phi: {phi!r}}}" for name, (c, phi) in strengths.items()),
            f"rock: {{unit_weight: {slope.rock.unit_weight_kn_m3!r} kN/m3}}",
        ]
        return "\n".join(lines) + "\n"


def _names(joints: Sequence[MeasuredJoint]) -> list[str]:
    """Names that a design file takes: the survey's own where they are such."""
    names = [joint.name for joint in joints]
    sound = all(_NAME.fullmatch(name) for name in names) and len(
        {name.casefold() for name in names}
    ) == len(names)
    return names if sound and "joints" not in names else ["J1", "J2"]


def read_dropped_survey(
    design: Design,
    name: str,
    text: str,
    c: float | None = None,
    phi: float | None = None,
    *,
    columns: str | None = None,
    skip_bad: bool = False,
) -> DroppedSurvey:
    """Read a survey, and cut every pair of it in the slope of a design; ask before bad rows are left out.

    Parameters
    ----------
    name, text : of the file that was dropped
    c, phi : strength of joints without their own, kPa and degrees [that of the design]
    columns : what the columns hold, in order, in place of a header; skip_bad : the user agrees to leave bad rows out

    Raises
    ------
    DesignError
        Every fault of the list, and of what its pairs need.
    """
    try:
        joints = read_joints_text(name, text, skip_bad, columns)
    except DesignError as error:
        return _ask_without_bad_rows(name, text, columns, error)
    notices = [
        {"code": "W366", "text": f"not used of {name}: {text}", "path": None}
        for text in joints.left_out
    ]
    notices += [
        {"code": "W373", "text": f"read of {name}: {text}", "path": None} for text in joints.read_as
    ]
    message: dict[str, Any] = {
        "name": name,
        "planes": [
            {
                "name": joint.name,
                "dip": joint.plane.dip_deg,
                "dip_direction": joint.plane.dip_direction_deg,
                "set": joint.set_name or None,
            }
            for joint in joints.joints
        ],
        "sets": list(_sets(joints)),
        "pairs": [],
        "left_out": list(joints.left_out),
        "notices": notices,
        "faults": [],
    }
    face = getattr(design, "face", None)
    if not isinstance(face, Plane) or len(joints) < 2:
        reason = (
            "two joints make a pair"
            if isinstance(face, Plane)
            else f"a {design.kind} design has no face for pairs"
        )
        message["faults"] = [answers.fault_of(Fault("E548", f"there are no pairs: {reason}"))]
        return DroppedSurvey(joints, None, message)
    strength = _strength(design)
    upper, height = getattr(design, "upper", None), getattr(design, "height_m", None)
    try:
        combinations = combos(
            list(joints.joints),
            face=face,
            upper=upper if isinstance(upper, Plane) else None,
            height=height,
            c=strength[0] if c is None else c,
            phi=strength[1] if phi is None else phi,
            unit_weight=design.rock.unit_weight_kn_m3 or None,
            top=_MOST_PAIRS,
            closed_form=len(joints) > _BY_BOTH,
        )
    except DesignError as error:
        message["faults"] = [answers.fault_of(fault) for fault in error.faults]
        return DroppedSurvey(joints, None, message)
    message["pairs"] = list(_pairs(combinations))
    message["counts"] = combinations.counts
    by_forces = [] if combinations.outcomes.pre_ie else [_BY_FORCES]
    message["notices"] += [answers.notice_of(text) for text in (*combinations.warnings, *by_forces)]
    return DroppedSurvey(joints, combinations, message)


def _ask_without_bad_rows(
    name: str, text: str, columns: str | None, error: DesignError
) -> DroppedSurvey:
    """Return a survey with its faults and the question whether to go on without its bad rows, where these are few.

    Raises
    ------
    DesignError
        The faults of the survey, where it cannot be read without them either.
    """
    try:
        survey = read_joints_text(name, text, True, columns)
    except DesignError:
        raise error from None
    message = {
        "name": name,
        "pairs": [],
        "question": f"Go on with {len(survey.joints)} joints, without the bad rows?",
        "faults": [answers.fault_of(fault) for fault in error.faults],
    }
    return DroppedSurvey(JointList(name, ()), None, message)


def _strength(design: Design) -> tuple[float, float]:
    """Cohesion and friction of the design: those of its first strength, where that is a straight one."""
    for strength in design.joint_strengths:
        c, phi = (
            getattr(strength, "cohesion_kpa", None),
            getattr(strength, "friction_angle_deg", None),
        )
        if isinstance(c, int | float) and isinstance(phi, int | float):
            return float(c), float(phi)
    return 0.0, 30.0


def _sets(joints: JointList) -> Iterator[dict[str, Any]]:
    """The sets that the survey names, each by the mean of its normals."""
    for name in joints.sets():
        planes = [joint.plane for joint in joints.joints if joint.set_name == name]
        poles = normals(
            np.array([plane.dip_deg for plane in planes]),
            np.array([plane.dip_direction_deg for plane in planes]),
        )
        poles = np.where((poles @ poles[0] < 0.0)[:, None], -poles, poles)
        mean = poles.sum(axis=0)
        mean_plane = planes_of_poles((mean if mean[2] < 0.0 else -mean)[None])
        dip, way = float(mean_plane.dips_deg[0]), float(mean_plane.dip_directions_deg[0])
        yield {"name": name, "dip": dip, "dip_direction": way, "count": len(planes)}


def _pairs(combinations: Combos) -> Iterator[dict[str, Any]]:
    """The pairs that form a wedge, the worst first."""
    pairs = combinations.pairs
    for pair in combinations.worst:
        number = pair.index
        first, second = (
            combinations.joints.joints[int(joint_numbers[number])]
            for joint_numbers in (pairs.first, pairs.second)
        )
        status, fos = pair.status, pair.limit
        method = "PRE-IE" if combinations.outcomes.pre_ie else "closed form"
        yield {
            "n": number,
            "names": [first.name, second.name],
            "planes": [str(first.plane), str(second.plane)],
            "fos": fos,
            "status": status,
            "words": status_text("wedge", status),
            "by": method,
            "agree": pair.agree,
            "volume_m3": pair.volume_m3,
        }
