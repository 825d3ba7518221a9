"""Closed forms of curved strength: the line through the strength at the mean traction of each plane, until it stays.

Closed forms know one cohesion and one friction angle a plane. Under a curved law those of the secant at the plane's
mean effective normal traction are given, the traction that comes out gives the next ones. The normal forces of a wedge
on two joints do not depend on its strength: the second round ends it. With passive bolts they do, and it takes more.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import fields, replace
from typing import Any, TypeVar

import numpy as np

from slopekit.design.parts import Strength

Found = TypeVar("Found")
_FIRST_KPA = 100.0
_STEADY = 1e-14
_MOST_ROUNDS = 60


def on_secants(
    strengths: Sequence[Strength],
    closed: Callable[[Sequence[Strength]], Found],
    tractions: Callable[[Found], Sequence[float]],
) -> Found:
    """What a closed form says, on the secants of the laws that are curved.

    Parameters
    ----------
    closed : the closed form with these cohesions and friction angles
    tractions : mean effective normal traction of each plane, kPa, from what it said
    """
    if not any(strength.law for strength in strengths):
        return closed(strengths)
    after = [_FIRST_KPA] * len(strengths)
    for _ in range(_MOST_ROUNDS):
        answer = closed([secant_strength(*pair) for pair in zip(strengths, after, strict=True)])
        before, after = after, [max(traction, 0.0) for traction in tractions(answer)]
        changes = zip(strengths, before, after, strict=True)
        if all(strength.law is None or abs(new - old) <= _STEADY * new for strength, old, new in changes):
            break
    return answer


def secant_strength(strength: Strength, traction_kpa: float) -> Strength:
    """The strength with the line of a curved law through its strength at a traction, one below 0 taken as 0."""
    if strength.law is None:
        return strength
    from slopekit.strength.protocol import secant

    cohesion, tangent = secant(strength.law, np.array([max(traction_kpa, 0.0)]))
    angle_deg = math.degrees(math.atan(float(tangent[0])))
    return replace(strength, cohesion_kpa=float(cohesion[0]), friction_angle_deg=angle_deg)


def left_out_of_laws(strengths: Sequence[Strength]) -> list[str]:
    """What is not modelled where strength is curved."""
    if not any(strength.law for strength in strengths):
        return []
    return ["the range of the factor under other locked-in forces (strength is curved)"]


def changed_laws(strength: Strength) -> list[tuple[str, Strength]]:
    """A curved law with each of its parameters a little larger, one at a time: what SENSITIVITY asks of it."""
    law = strength.named_law
    if law is None:
        return []
    return [(name, Strength.by_law(other, strength.dilation_deg, strength.tension_kpa)) for name, other in _larger(law)]


def _larger(law: Any) -> Iterator[tuple[str, Any]]:
    for part in fields(law):
        value, sign = getattr(law, part.name), part.metadata.get("sign")
        if hasattr(value, "resistance"):
            yield from [(name, replace(law, **{part.name: other})) for name, other in _larger(value)]
        elif sign and value is not None:
            step = part.metadata.get("step")
            larger = value * 1.1 if step is None else value + step
            angle = "°" if part.metadata["unit"] == "angle" else ""
            within = larger < part.metadata.get("below", math.inf) and larger <= part.metadata.get("most", math.inf)
            if larger != value and within:
                yield (f"{sign} +10 %" if step is None else f"{sign} +{step:g}{angle}", replace(
                    law, **{part.name: larger}
                ))  # fmt: skip
