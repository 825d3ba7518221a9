"""Reading curved strength laws of design files: `{law: barton-bandis, jrc: 8, jcs: 50 MPa, phi_r: 25, waviness: 5}`.

The keys of a law with their units and limits are declared at the fields of its class (`slopekit.strength`).
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
_VERTICAL_DEG = 90.0


def fields_of_law(law: Any) -> Mapping[str, Field]:
    """Return the declared fields of a strength law by attribute."""
    declared = {}
    for attribute in fields(law):
        metadata = attribute.metadata
        if not metadata:
            continue
        low, high = (
            metadata.get("least", metadata.get("above", -inf)),
            metadata.get("most", metadata.get("below", inf)),
        )
        declared[attribute.name] = declare(
            metadata["key"],
            metadata["unit"],
            low,
            high,
            above="above" in metadata,
            below="below" in metadata,
            is_required=attribute.default is MISSING,
            default=None if attribute.default is MISSING else attribute.default,
            code=_CODES.get(metadata["unit"], "E127"),
            example=metadata["example"],
            doc=metadata["doc"],
            is_attribute=True,
            axis=metadata["doc"].partition(",")[0].partition(";")[0],
            check=metadata.get("check"),
        )
    return declared


#: Keys of a strength under any law: those of `Strength` except c and phi, and waviness.
COMMON_KEYS = {
    field.path
    for field in (*fields_of(Strength).values(), *fields_of_law(Wavy).values())
    if not field.may_lack
}


def keys_of_laws(laws: Iterable[Any]) -> Mapping[str, Field]:
    """Return the keys of the laws; a key of two laws has the limits of both, and a text with both meanings."""
    keys: dict[str, Field] = {}
    for law in laws:
        for law_field in fields_of_law(law).values():
            if law_field.path in ("c", "phi"):
                continue
            field, previous = (
                replace(law_field, is_required=False, left_out=""),
                keys.get(law_field.path),
            )
            if previous is not None and replace(previous, default=None) != replace(
                field, default=None
            ):
                low, high = min(field.least, previous.least), max(field.most, previous.most)
                doc = f"{previous.doc}; {law.name}: {law_field.doc}"
                field = replace(
                    previous,
                    least=low,
                    most=high,
                    above=False,
                    below=False,
                    axis="",
                    doc=doc,
                    check=None,
                )
            keys[law_field.path] = field
    return keys


#: The keys of all curved laws, and waviness.
KEYS = keys_of_laws([*(law for law in LAWS.values() if law is not MohrCoulomb), Wavy])


def key_of_law(law: str | None, key: str) -> Field | None:
    """Return the declaration of a law's key; None for an unknown law or a key that it does not have."""
    declared = fields_of_law(LAWS[law]) if law is not None and law in LAWS else {}
    return next((field for field in declared.values() if field.path == key), None)


def named_law(node: Node) -> str | None:
    """Return the name of a strength's law; None for Mohr-Coulomb."""
    law = node.get("law").text
    return None if law == MohrCoulomb.name else law


def read_law(reader: Reader, node: Node, owner: str) -> StrengthLaw | None:
    """Read the curved law of a strength; None with faults E142, E143, E114, E115, E127 or E553."""
    name = named_law(node) or ""
    if name not in LAWS:
        advice = did_you_mean(name, LAWS, f"There are: {', '.join(LAWS)}.", cutoff=0.4)
        reader.fault("E142", f"{name} is no strength law", node.get("law"), advice)
        return None
    declared = fields_of_law(LAWS[name])
    field_of_key = {field.path: field for field in declared.values()}
    for key, below in node.items():
        if key not in field_of_key and key not in COMMON_KEYS:
            reader.fault(
                "E142",
                f"{key} is not a key of the law {name}",
                below,
                f"It takes {', '.join(field_of_key)}.",
            )
    for key, field in field_of_key.items():
        if field.is_required and not node.get(key):
            advice = f"Add {key}: {field.example} ({field.doc})."
            reader.fault("E143", f"{node.path}.{key} is missing", node, advice)
    values = {
        attribute: reader.field(field, node.get(field.path), owner)
        for attribute, field in declared.items()
    }
    is_required_or_set = {
        attribute: field.is_required or bool(node.get(field.path))
        for attribute, field in declared.items()
    }
    if any(
        values[attribute] is None and is_given for attribute, is_given in is_required_or_set.items()
    ):
        return None
    steepest = (values.get("phi_deg") or 0.0) + (values.get("i_deg") or 0.0)
    if steepest >= _VERTICAL_DEG:
        reader.fault(
            "E115",
            f"phi and i of {owner} are {number(steepest)}° together, below 90 is needed",
            node,
        )
        return None
    law: StrengthLaw = LAWS[name](**values)
    return law


def with_waves(reader: Reader, node: Node, owner: str, strength: Strength) -> Strength:
    """Return the strength with the waviness of its node added to its law."""
    waves = reader.field(fields_of_law(Wavy)["waviness_deg"], node.get("waviness"), owner)
    if not node.get("waviness") or waves is None:
        return strength
    law = strength.named_law or MohrCoulomb(strength.cohesion_kpa, strength.friction_angle_deg)
    return Strength.by_law(
        Wavy(law, waves) if waves else law, strength.dilation_deg, strength.tension_kpa
    )


def refuse_keys(reader: Reader, node: Node) -> None:
    """Add fault E142 for each key of a curved law where no law is named."""
    for key, below in node.items():
        if key in KEYS and key not in COMMON_KEYS:
            laws = [
                name
                for name, law in LAWS.items()
                if any(field.path == key for field in fields_of_law(law).values())
            ]
            advice = f"Add law: {' or '.join(laws)}."
            reader.fault(
                "E142", f"{key} is a key of a curved law, and none is named", below, advice
            )
