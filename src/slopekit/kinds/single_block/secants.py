"""Closed forms of curved strength, iterated on the secant at the mean normal traction of each plane.

Closed forms know one cohesion and one friction angle a plane. Under a curved law those of the secant at the plane's
mean effective normal traction are given, the traction that comes out gives the next ones. The normal forces of a wedge
on two joints do not depend on its strength: the second round ends it. With passive bolts they do, and it takes more.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields, replace
from functools import partial
from typing import Any, TypeVar

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.orientation import Plane
from slopekit.design.common import Design
from slopekit.design.parts import Strength

D = TypeVar("D", bound=Design)
Found = TypeVar("Found")
_JOINT_NAMES = ("J1", "J2", "basal")  # of a wedge with a basal joint
_FIRST_KPA = 100.0
_CONVERGED = 1e-14
_MOST_ROUNDS = 60


def on_secants(
    strengths: Sequence[Strength],
    closed: Callable[[Sequence[Strength]], Found],
    tractions: Callable[[Found], Sequence[Floats]],
) -> Found:
    """Return the closed form of n designs on the secants of curved laws, iterated until the tractions converge.

    Parameters
    ----------
    closed : the closed form with these cohesions and friction angles
    tractions : mean effective normal traction (n,) of each plane, kPa, from what it said
    """
    if not any(strength.law for strength in strengths):
        return closed(strengths)
    next_tractions = [np.array([_FIRST_KPA])] * len(strengths)
    for _ in range(_MOST_ROUNDS):
        answer = closed(
            [secant_strength(*pair) for pair in zip(strengths, next_tractions, strict=True)]
        )
        last_tractions, next_tractions = (
            next_tractions,
            [np.maximum(np.nan_to_num(traction), 0.0) for traction in tractions(answer)],
        )
        changes = zip(strengths, last_tractions, next_tractions, strict=True)
        if all(
            strength.law is None or (np.abs(new - old) <= _CONVERGED * new).all()
            for strength, old, new in changes
        ):
            break
    return answer


def secant_strength(strength: Strength, traction_kpa: Any) -> Strength:
    """Return the strength with the secant of a curved law at tractions (kPa; below 0 counts as 0)."""
    if strength.law is None:
        return strength
    from slopekit.strength.protocol import secant

    cohesion, tangent = secant(strength.law, np.maximum(traction_kpa, 0.0))
    line: Any = {"cohesion_kpa": cohesion, "friction_angle_deg": np.degrees(np.arctan(tangent))}
    return replace(strength, **line)


def secant_at(strength: Strength, normal_kn: Floats, area_m2: Floats) -> Mapping[str, Any]:
    """Return the secant of a curved law at the mean normal traction of node pairs (n,), and the traction range."""
    traction, tractions = float(normal_kn.sum() / area_m2.sum()), normal_kn / area_m2
    line = secant_strength(strength, traction)
    return {
        "traction_kpa": max(traction, 0.0),
        "range_kpa": (float(tractions.min()), float(tractions.max())),
        "cohesion_kpa": line.cohesion_kpa,
        "friction_angle_deg": line.friction_angle_deg,
    }


def left_out_of_laws(strengths: Sequence[Strength]) -> list[str]:
    """Return what the model leaves out where strength is curved, in words."""
    if not any(strength.law for strength in strengths):
        return []
    return ["the range of the factor under other locked-in forces (strength is curved)"]


# -- designs with one input a little changed: what SENSITIVITY asks the closed form ------------------------------------


def steeper(plane: Plane) -> Plane:
    """Return a plane that dips one degree more steeply."""
    return replace(plane, dip_deg=plane.dip_deg + 1.0)


def other_strengths(design: D) -> Iterator[tuple[str, D]]:
    """Yield designs with a little more friction and cohesion, or more of each parameter of their laws, by name."""
    strengths = design.joint_strengths
    distinct = dict.fromkeys(strengths)
    for strength in distinct:
        joints = [
            joint
            for joint, strength_of_joint in zip(_JOINT_NAMES, strengths, strict=False)
            if strength_of_joint == strength
        ]
        suffix = f" of {' and '.join(joints)}" if len(distinct) > 1 else ""
        for name, changed in changed_laws(strength):
            yield name + suffix, design.each_strength(partial(_exchanged, strength, changed))
    if any(strength.named_law for strength in strengths):
        return
    if max(strength.friction_angle_deg for strength in strengths) < 88.0:
        yield (
            "φ +1°",
            design.each_strength(
                lambda strength: replace(
                    strength, friction_angle_deg=strength.friction_angle_deg + 1.0
                )
            ),
        )
    if any(strength.cohesion_kpa for strength in strengths):
        yield (
            "c +10 %",
            design.each_strength(
                lambda strength: replace(strength, cohesion_kpa=strength.cohesion_kpa * 1.1)
            ),
        )


def _exchanged(old: Strength, new: Strength, strength: Strength) -> Strength:
    return new if strength == old else strength


def changed_laws(strength: Strength) -> list[tuple[str, Strength]]:
    """Return a curved law with each of its parameters a little larger, one at a time, by name."""
    law = strength.named_law
    if law is None:
        return []
    return [
        (name, Strength.by_law(changed, strength.dilation_deg, strength.tension_kpa))
        for name, changed in _larger(law)
    ]


def _larger(law: Any) -> Iterator[tuple[str, Any]]:
    for parameter in fields(law):
        value, sign = getattr(law, parameter.name), parameter.metadata.get("sign")
        if hasattr(value, "resistance"):
            yield from [
                (name, replace(law, **{parameter.name: changed}))
                for name, changed in _larger(value)
            ]
        elif sign and value is not None:
            step = parameter.metadata.get("step")
            larger = value * 1.1 if step is None else value + step
            angle = "°" if parameter.metadata["unit"] == "angle" else ""
            is_allowed = larger < parameter.metadata.get(
                "below", math.inf
            ) and larger <= parameter.metadata.get("most", math.inf)
            if larger != value and is_allowed:
                yield (
                    f"{sign} +10 %" if step is None else f"{sign} +{step:g}{angle}",
                    replace(law, **{parameter.name: larger}),
                )
