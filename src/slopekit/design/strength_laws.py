"""Curved strength in design files: `{law: barton-bandis, jrc: 8, jcs: 50 MPa, phi_r: 25, waviness: 5}`.

Which keys a law takes, in which units and between which limits, stands at its fields (`slopekit.strength`).
"""

from collections.abc import Mapping, Sequence
from dataclasses import MISSING, Field, dataclass, fields, replace
from difflib import get_close_matches
from math import inf
from typing import TYPE_CHECKING, Any

from slopekit.design.common import Design, Strength
from slopekit.design.wedge import WedgeDesign
from slopekit.errors import DesignError, Fault
from slopekit.orientation import number
from slopekit.units import quantity

if TYPE_CHECKING:
    from slopekit.design.inputs import Inputs
    from slopekit.design.nodes import Node
    from slopekit.strength.protocol import StrengthLaw

#: Keys of a strength beside those of its law.
BESIDE = ("law", "waviness", "dilation", "tension", "stiffness")
STRAIGHT = "mohr-coulomb"
_UNITS = {"pressure": " kPa", "angle": "°", "length": " m", "ratio": ""}
_UPRIGHT = 90.0
_CODES = {"pressure": "E114", "angle": "E115"}


@dataclass(frozen=True, slots=True)
class Bent:
    """What a strength of a file has beside c and φ: a law in their place, or waves on their line; None: nothing."""

    law: "StrengthLaw | None" = None
    waviness_deg: float | None = None

    def of(self, straight: Strength) -> Strength:
        """The strength with it; dilation and tension are the straight one's."""
        law = self.law
        if law is None and self.waviness_deg is not None:
            from slopekit.strength.mohr_coulomb import MohrCoulomb

            law = MohrCoulomb(straight.cohesion_kpa, straight.friction_angle_deg)
        if law is None:
            return straight
        if self.waviness_deg:
            from slopekit.strength.waviness import Wavy

            law = Wavy(law, self.waviness_deg)
        return Strength.by_law(law, straight.dilation_deg, straight.tension_kpa)


def named_law(node: "Node | None") -> str | None:
    """The law that a strength names, None where that is Mohr-Coulomb."""
    law = node.get("law") if node is not None else None
    return None if law is None or law.text in (None, STRAIGHT) else law.text


def bent(inputs: "Inputs", node: "Node | None") -> Bent:
    """The law of a strength of a file; what is wrong with it becomes faults: E142, E143, E114, E115, E127."""
    if node is None or not node.is_mapping or (named_law(node) is None and node.get("waviness") is None):
        return _straight_only(inputs, node)
    from slopekit.strength.registry import LAWS
    from slopekit.strength.waviness import Wavy

    name = named_law(node)
    wave = _value(inputs, node, next(part for part in fields(Wavy) if part.name == "waviness_deg"))
    if name is None:
        return Bent(None, wave)
    if name not in LAWS:
        near = get_close_matches(name, LAWS, n=1, cutoff=0.4)
        advice = f"Did you mean {near[0]}?" if near else f"There are: {', '.join(LAWS)}."
        inputs.fault("E142", f"{name} is no strength law", node.get("law"), advice)
        return Bent()
    parts: Mapping[str, Field[Any]] = {part.metadata["key"]: part for part in fields(LAWS[name])}
    for key, below in node.items():
        if key not in parts and key not in BESIDE:
            advice = f"It takes {', '.join(parts)}."
            inputs.fault("E142", f"{key} is not a key of the law {name}", below, advice)
    values: dict[str, float] = {}
    for key, part in parts.items():
        if node.get(key) is not None:
            if (value := _value(inputs, node, part)) is not None:
                values[part.name] = value
        elif part.default is MISSING:
            example = f"{key}: {part.metadata['example']}"
            inputs.fault("E143", f"{node.path}.{key} is missing", node, f"Add {example} ({part.metadata['doc']}).")
    if any(part.name not in values and part.default is MISSING for part in parts.values()):
        return Bent()
    steepest = values.get("phi_deg", 0.0) + values.get("i_deg", 0.0)
    if steepest >= _UPRIGHT:
        inputs.fault("E115", f"phi and i of {node.name} are {number(steepest)}° together, below 90 is needed", node)
        return Bent()
    return Bent(LAWS[name](**values), wave)


def _straight_only(inputs: "Inputs", node: "Node | None") -> Bent:
    """Keys of a law that is not named."""
    if node is None or not node.is_mapping:
        return Bent()
    for key, below in node.items():
        if key not in (*BESIDE, "c", "phi") and key in LAW_KEYS:
            inputs.fault("E142", f"{key} is a key of a curved law, and none is named", below, "Add law: barton-bandis.")
    return Bent()


def _value(inputs: "Inputs", node: "Node", part: "Field[Any]") -> float | None:
    below = node.get(part.metadata["key"])
    given = None if below is None else inputs.value(below)
    if below is None or given is None:
        return None
    said, name = part.metadata, f"{part.metadata['key']} of {node.name}"
    try:
        found = quantity(given, said["unit"], name, str(below.place))
    except DesignError as error:
        inputs.faults += error.faults
        return None
    least, most = said.get("least", said.get("above", -inf)), said.get("most", said.get("below", inf))
    off = found < least or found > most or (found == least and "above" in said) or (found == most and "below" in said)
    if not off and found == found:
        return found
    unit, code = _UNITS[said["unit"]], _CODES.get(said["unit"], "E127")
    low = f"from {number(least)}" if "least" in said else f"above {number(least)}"
    high = "" if most == inf else f" {'to' if 'most' in said else 'to below'} {number(most)}{unit}"
    inputs.faults.append(Fault(code, f"{name} is {number(found)}{unit}, it lies {low}{high}", str(below.place)))
    return None


def with_laws(design: Design, laws: Sequence[Bent]) -> Design:
    """A design of one block with the laws of its interfaces, in their order."""
    if not any(one.law is not None or one.waviness_deg is not None for one in laws):
        return design
    if isinstance(design, WedgeDesign):
        first, second = (one.of(own) for one, own in zip(laws, design.strengths, strict=True))
        return design.with_strengths(first, second)
    one: Any = design  # plane, footing, surface
    found: Design = replace(one, strength=laws[0].of(one.strength))
    return found


#: Every key of the curved laws, with the quantity of `slopekit.units` and the limits (a test holds them to the laws).
LAW_KEYS: Mapping[str, tuple[str, float, float]] = {
    "jrc": ("ratio", 0.0, 25.0), "jcs": ("pressure", 0.0, inf), "phi_r": ("angle", 0.0, 70.0),
    "length": ("length", 0.0, inf), "length_0": ("length", 0.0, inf), "a": ("ratio", 0.0, 1e3),
    "b": ("ratio", 0.0, 1.0), "d": ("pressure", 0.0, inf), "i": ("angle", 0.0, 90.0),
    "sigma_t": ("pressure", 0.0, inf), "waviness": ("angle", 0.0, 90.0),
}  # fmt: skip
