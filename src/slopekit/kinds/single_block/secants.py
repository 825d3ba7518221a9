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

from slopekit.core.records import dataclass
from slopekit.design.parts import Strength

Found = TypeVar("Found")
_FIRST_KPA = 100.0
_STEADY = 1e-14
_MOST_ROUNDS = 60


@dataclass(frozen=True, slots=True)
class Secant:
    """The line that a closed form was given for a curved law: where, kPa, and its cohesion (kPa) and angle."""

    traction_kpa: float
    cohesion_kpa: float
    friction_angle_deg: float


def on_secants(
    strengths: Sequence[Strength], closed: Callable[[Sequence[Strength]], Found],
    tractions: Callable[[Found], Sequence[float]],
) -> tuple[Found, tuple[Secant | None, ...]]:  # fmt: skip
    """What a closed form says, and the lines it was given; None for the planes whose law is straight.

    Parameters
    ----------
    closed : the closed form with these cohesions and friction angles
    tractions : mean effective normal traction of each plane, kPa, from what it said
    """
    if not any(strength.law for strength in strengths):
        return closed(strengths), tuple(None for _ in strengths)
    lines = [secant_of(strength, _FIRST_KPA) for strength in strengths]
    for _ in range(_MOST_ROUNDS):
        given = [
            strength if line is None else replace(
                strength, cohesion_kpa=line.cohesion_kpa, friction_angle_deg=line.friction_angle_deg
            )
            for strength, line in zip(strengths, lines, strict=True)
        ]  # fmt: skip
        answer = closed(given)
        before, lines = lines, [secant_of(*pair) for pair in zip(strengths, tractions(answer), strict=True)]
        if all(
            new is None or old is None or abs(new.traction_kpa - old.traction_kpa) <= _STEADY * new.traction_kpa
            for new, old in zip(lines, before, strict=True)
        ):
            break
    return answer, tuple(lines)


def secant_of(strength: Strength, traction_kpa: float) -> Secant | None:
    """The line of a curved law through its strength at a traction; None where the law is straight."""
    if strength.law is None:
        return None
    from slopekit.strength.protocol import secant

    pressed = max(traction_kpa, 0.0)
    cohesion, tangent = secant(strength.law, np.array([pressed]))
    return Secant(pressed, float(cohesion[0]), math.degrees(math.atan(float(tangent[0]))))


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
