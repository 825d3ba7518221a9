"""Curved strength in design files: `{law: barton-bandis, jrc: 8, jcs: 50 MPa, phi_r: 25, waviness: 5}`.

Which keys a law takes, in which units and between which limits, stands at its own fields (`slopekit.strength`).
"""

from collections.abc import Iterable, Mapping
from dataclasses import MISSING, fields, replace
from math import inf
from typing import Any

from slopekit.core.errors import did_you_mean
from slopekit.core.orientation import number
from slopekit.design.fields import Field, declare, fields_of
from slopekit.design.parts import Strength
from slopekit.design.reading.nodes import Node
from slopekit.design.reading.reader import Reader
from slopekit.strength.mohr_coulomb import MohrCoulomb
from slopekit.strength.protocol import StrengthLaw
from slopekit.strength.registry import LAWS
from slopekit.strength.waviness import Wavy

_CODES = {"pressure": "E114", "angle": "E115"}
_UPRIGHT = 90.0


def fields_of_law(law: Any) -> Mapping[str, Field]:
    """The declared fields of a strength law by attribute."""
    declared = {}
    for part in fields(law):
        said = part.metadata
        if not said:
            continue
        low, high = said.get("least", said.get("above", -inf)), said.get("most", said.get("below", inf))
        declared[part.name] = declare(
            said["key"], said["unit"], low, high, above="above" in said, below="below" in said,
            is_required=part.default is MISSING, default=None if part.default is MISSING else part.default,
            code=_CODES.get(said["unit"], "E127"), example=said["example"], doc=said["doc"], is_attribute=True,
            axis=said["doc"].partition(",")[0].partition(";")[0], check=said.get("check"),
        )  # fmt: skip
    return declared


#: Keys of a strength beside those of its law: what is not c or phi, and waves.
BESIDE = {field.path for field in (*fields_of(Strength).values(), *fields_of_law(Wavy).values()) if not field.may_lack}


def keys_of_laws(laws: Iterable[Any]) -> Mapping[str, Field]:
    """Every key of the curved laws; one of two laws takes what either takes, and says of which each meaning is."""
    keys: dict[str, Field] = {}
    for law in laws:
        for own in fields_of_law(law).values():
            if own.path in ("c", "phi"):
                continue
            field, other = replace(own, is_required=False, left_out=""), keys.get(own.path)
            if other is not None and replace(other, default=None) != replace(field, default=None):
                low, high = min(field.least, other.least), max(field.most, other.most)
                doc = f"{other.doc}; {law.name}: {own.doc}"
                field = replace(other, least=low, most=high, above=False, below=False, axis="", doc=doc, check=None)
            keys[own.path] = field
    return keys


#: Every key of the curved laws, those of waves among them.
KEYS = keys_of_laws([*(law for law in LAWS.values() if law is not MohrCoulomb), Wavy])


def key_of_law(law: str | None, key: str) -> Field | None:
    """A key as a law has it; None of a law that is not known or does not have it."""
    declared = fields_of_law(LAWS[law]) if law is not None and law in LAWS else {}
    return next((field for field in declared.values() if field.path == key), None)


def named_law(node: Node) -> str | None:
    """The law that a strength names, None where that is Mohr-Coulomb."""
    law = node.get("law").text
    return None if law == MohrCoulomb.name else law


def read_law(reader: Reader, node: Node, owner: str) -> StrengthLaw | None:
    """The curved law of a strength; what is wrong with it becomes faults: E142, E143, E114, E115, E127, E553."""
    name = named_law(node) or ""
    if name not in LAWS:
        advice = did_you_mean(name, LAWS, f"There are: {', '.join(LAWS)}.", cutoff=0.4)
        reader.fault("E142", f"{name} is no strength law", node.get("law"), advice)
        return None
    declared = fields_of_law(LAWS[name])
    known = {field.path: field for field in declared.values()}
    for key, below in node.items():
        if key not in known and key not in BESIDE:
            reader.fault("E142", f"{key} is not a key of the law {name}", below, f"It takes {', '.join(known)}.")
    for key, field in known.items():
        if field.is_required and not node.get(key):
            advice = f"Add {key}: {field.example} ({field.doc})."
            reader.fault("E143", f"{node.path}.{key} is missing", node, advice)
    values = {part: reader.field(field, node.get(field.path), owner) for part, field in declared.items()}
    given = {part: field.is_required or bool(node.get(field.path)) for part, field in declared.items()}
    if any(values[part] is None and is_given for part, is_given in given.items()):
        return None
    steepest = (values.get("phi_deg") or 0.0) + (values.get("i_deg") or 0.0)
    if steepest >= _UPRIGHT:
        reader.fault("E115", f"phi and i of {owner} are {number(steepest)}° together, below 90 is needed", node)
        return None
    law: StrengthLaw = LAWS[name](**values)
    return law


def with_waves(reader: Reader, node: Node, owner: str, strength: Strength) -> Strength:
    """The strength with the waves that its node adds to its law, or to its line."""
    waves = reader.field(fields_of_law(Wavy)["waviness_deg"], node.get("waviness"), owner)
    if not node.get("waviness") or waves is None:
        return strength
    law = strength.named_law or MohrCoulomb(strength.cohesion_kpa, strength.friction_angle_deg)
    return Strength.by_law(Wavy(law, waves) if waves else law, strength.dilation_deg, strength.tension_kpa)


def refuse_keys(reader: Reader, node: Node) -> None:
    """E142 for keys of a law that is not named."""
    for key, below in node.items():
        if key in KEYS and key not in BESIDE:
            laws = [
                name for name, law in LAWS.items() if any(field.path == key for field in fields_of_law(law).values())
            ]
            advice = f"Add law: {' or '.join(laws)}."
            reader.fault("E142", f"{key} is a key of a curved law, and none is named", below, advice)
