"""Readers of the groups of keys that all kinds of design share: weight, loads, strengths, stiffness, water."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from slopekit.core.errors import Fault
from slopekit.core.orientation import Line
from slopekit.core.orientation import number as number_text
from slopekit.design import words
from slopekit.design.common import BEDROCK, Design
from slopekit.design.fields import fields_of, record_spec
from slopekit.design.parts import (
    Bolt,
    Force,
    HyperbolaParameters,
    Project,
    Residual,
    Rule,
    Seismic,
    Stiffness,
    Strength,
    Water,
)
from slopekit.design.reading.nodes import NOTHING, Node
from slopekit.design.reading.reader import Reader
from slopekit.design.reading.structure import expand_short_form, is_distribution, nameless_keys

_MOST_FACTORS = 200

# -- attributes of every kind -------------------------------------------------------------------------------------


def read_common(reader: Reader, on_blocks: bool = False) -> dict[str, Any]:
    """Read the attributes that every kind of design has; call it after reading those of the kind.

    Parameters
    ----------
    on_blocks : whether forces and bolts name their blocks, and are read with these
    """
    attributes = reader.fields(
        Design,
        only=(
            "gravity_m_s2",
            "water_unit_weight_kn_m3",
            "criterion",
            "agree_within",
            "modulus_kpa",
            "poisson",
            "elastic_edge_m",
        ),
    )
    reader.field(BEDROCK, reader.find(BEDROCK.path))
    attributes |= read_weight(reader, attributes["gravity_m_s2"])
    declared_fields = fields_of(reader.record)
    if "seismic" in declared_fields:
        attributes["seismic"] = read_seismic(reader)
    if "forces" in declared_fields and not on_blocks:
        attributes["forces"] = reader.many("loads.forces", read_force)
        attributes["bolts"] = reader.many("support.bolts", read_bolt)
    attributes["rules"] = reader.many("acceptance.rules", read_rule)
    attributes["factors"] = read_factors(reader) if "factors" in declared_fields else ()
    return attributes | {
        "title": reader.find("title").text or "",
        "project": Project(**reader.fields(Project, reader.find("project"))),
        "stiffness": read_stiffness(reader),
    }


def read_weight(reader: Reader, gravity: float | None) -> dict[str, Any]:
    """Read the unit weight (kN/m³) or the density (kg/m³) of the rock; fault E112 if both are given."""
    declared_fields = fields_of(reader.record)
    weight, density = reader.find("rock.unit_weight"), reader.find("rock.density")
    if weight and density:
        location = f"{density.place}, {weight.place}"
        reader.faults.append(
            Fault(
                "E112", "density and unit weight are both given", location, "Give one of the two."
            )
        )
        return {"unit_weight_kn_m3": None, "density_kg_m3": None}
    if weight:
        return {
            "unit_weight_kn_m3": reader.field(declared_fields["unit_weight_kn_m3"], weight),
            "density_kg_m3": None,
        }
    density_kg_m3 = reader.field(declared_fields["density_kg_m3"], density)
    if (
        not density
        and density_kg_m3 is None
        and reader.find("rock")
        and "rock" in reader.record.REQUIRED
    ):
        reader.fault("E143", "rock.density is missing", reader.find("rock"), "Give rock.density.")
    unit_weight = (
        None if density_kg_m3 is None or gravity is None else density_kg_m3 * gravity / 1e3
    )
    return {"unit_weight_kn_m3": unit_weight, "density_kg_m3": density_kg_m3}


def read_seismic(reader: Reader) -> Seismic:
    """Read the seismic load from a number, from the short form 0.1@180, or by its keys."""
    node = reader.find("loads.seismic")
    if node.value is None:
        return Seismic()
    declared_fields = fields_of(Seismic)
    keys = expand_short_form(node, "loads.seismic")
    k = keys.get("k") if keys.is_mapping and not is_distribution(node) else node
    if not k:
        advice = "Add k: 0.1, a fraction of gravity, or leave loads.seismic out."
        reader.fault("E143", "loads.seismic.k is missing", node, advice)
    coefficient = reader.field(declared_fields["coefficient"], k) if k else None
    toward = keys.get("toward")
    trend = reader.field(declared_fields["trend_deg"], toward)
    if coefficient and not toward:
        reader.defaults.append("seismic.trend")
    return (
        Seismic()
        if coefficient is None or (toward and trend is None)
        else Seismic(coefficient, trend)
    )


def read_rule(reader: Reader, node: Node) -> Rule | None:
    """Read an acceptance rule."""
    return reader.faults.of(words.rule, reader.written(node), str(node.place))


def read_force(reader: Reader, node: Node) -> Force | None:
    """Read a force from its components, or from its size and direction in short form or by keys."""
    declared_fields, keys = fields_of(Force), expand_short_form(node, "loads.forces.0")
    size, toward = keys.get("force") if keys.is_mapping else node, keys.get("toward")
    if size and not toward:  # force: 300 kN@180/10, next to the key `at` of its point
        written = expand_short_form(size, "loads.forces.0")
        size, toward = written.get("force") or size, written.get("toward")
    components: Any = None
    line: Line | None = None
    if size and toward:
        amount, line = (
            reader.number(declared_fields["components_kn"], size, "force"),
            reader.field(declared_fields["toward"], toward),
        )
        components = (
            None if amount is None or line is None else tuple((amount * line.vector()).tolist())
        )
    elif size.elements and _has_only_keys_of(keys, Force):
        components = reader.faults.of(
            words.point, reader.value(size), "force", str(node.place), "force"
        )
    else:
        message = (
            f"force is {words.value_text(reader.written(size or node))}, it is written "
            "500kN@180/10 or (east, north, up)"
        )
        reader.fault("E123", message, node)
    at_m = reader.field(declared_fields["at_m"], keys.get("at"))
    return None if components is None else Force(components, at_m, toward=line)


def read_bolt(reader: Reader, node: Node) -> Bolt | None:
    """Read a bolt from its short form or by its keys."""
    keys = expand_short_form(node, "support.bolts.0")
    if not keys.is_mapping or not _has_only_keys_of(keys, Bolt):
        expected_form = "it is written 200kN@000/10,passive or as force, toward, acts, head, length"
        reader.fault(
            "E124", f"bolt is {words.value_text(reader.written(node))}, {expected_form}", node
        )
        return None
    values = reader.fields(Bolt, keys)
    if values["length_m"] is not None and not keys.get("head"):
        reader.fault("E124", "a bolt with a length needs its head", node)
    needed = (values["force_kn"], values["toward"], values["acts"])
    return None if None in needed else Bolt(**values)


def _has_only_keys_of(node: Node, record: type) -> bool:
    """Return whether all keys are those of a record; the keys of a call's values are checked only here."""
    paths = {field.path for field in fields_of(record).values()}
    return all(key in paths for key, _ in node.items())


def read_factors(reader: Reader) -> tuple[float, ...]:
    """Read the strength reduction factors of the series, sorted, without repeats."""
    node = reader.find("analysis.factors")
    factors = reader.field(fields_of(Design)["factors"], node)
    if len(factors) > _MOST_FACTORS:
        reader.fault(
            "E127",
            f"{len(factors)} factors are too many for one series (most: {_MOST_FACTORS})",
            node,
        )
    return tuple(sorted(set(factors)))


# -- strengths ----------------------------------------------------------------------------------------------------


def read_strength(
    reader: Reader,
    node: Node,
    owner: str,
    defaults: Mapping[str, float] | None = None,
    listed: Mapping[str, float | None] | None = None,
    joint_list: Node = NOTHING,
) -> Strength | None:
    """Read a strength; faults: E143 without c or φ, E115 a dilation angle above φ.

    Parameters
    ----------
    owner : name of the strength, for messages
    defaults : values of missing keys
    listed : values of a joint list, which replace those of the design
    joint_list : node of the joint list's file
    """
    if not node.is_mapping and not listed and not defaults:
        return None
    peak = _peak_strength(reader, node, owner, defaults, listed, joint_list)
    return _with_residual(reader, node.get("residual"), owner, peak)


def _peak_strength(
    reader: Reader,
    node: Node,
    owner: str,
    defaults: Mapping[str, float] | None,
    listed: Mapping[str, float | None] | None,
    joint_list: Node,
) -> Strength | None:
    is_curved = _is_curved(node)
    if is_curved:
        from slopekit.design.strength_laws import named_law, refuse_keys, with_waves

        if named_law(node) is not None:
            return _curved_strength(reader, node, owner)
        refuse_keys(reader, node)
    attributes = reader.fields(Strength, node, owner)
    for name, field in fields_of(Strength).items():
        key_node = node.get(field.path)
        if listed and field.path in listed:
            attributes[name] = listed[field.path]
        elif not key_node and defaults and field.path in defaults:
            attributes[name] = defaults[field.path]
        elif not key_node and field.may_lack and (node or not (listed and joint_list)):
            path = f"{node.path}.{field.path}" if node else f"{field.path} of {owner}"
            reader.fault("E143", f"{path} is missing", node or joint_list, f"Add {field.path}.")
    friction, dilation = attributes["friction_angle_deg"], attributes["dilation_deg"]
    below = node.get("dilation")
    if friction is not None and dilation is not None and below and dilation > friction:
        message = f"dilation of {owner} is {number_text(dilation)}°, it lies between 0 and the friction angle"
        reader.fault("E115", f"{message} {number_text(friction)}°", below)
    straight = None if None in attributes.values() else Strength(**attributes)
    return (
        with_waves(reader, node, owner, straight)
        if is_curved and straight is not None
        else straight
    )


def _with_residual(
    reader: Reader, below: Node, owner: str, peak: Strength | None
) -> Strength | None:
    """Return the strength with its residual strength; fault E453 where the residual exceeds the peak."""
    attributes = reader.fields(Residual, below, f"residual {owner}") if below.is_mapping else {}
    if not attributes or None in attributes.values() or peak is None:
        return peak
    residual = Residual(**attributes)
    for value, peak_value, quantity, unit in (
        (residual.cohesion_kpa, peak.cohesion_kpa, "cohesion", " kPa"),
        (residual.friction_angle_deg, peak.friction_angle_deg, "friction angle", "°"),
    ):
        if value > peak_value and peak.law is None:
            message = (
                f"the residual {quantity} of {owner} is {number_text(value)}{unit}, "
                f"its peak {number_text(peak_value)}{unit}"
            )
            reader.fault(
                "E453",
                message,
                below,
                "Residual strength is what is left after slip: at most the peak.",
            )
    return replace(peak, residual=residual)


def _is_curved(node: Node) -> bool:
    """Return whether a strength has keys besides those of a linear (Mohr-Coulomb) envelope."""
    straight = {field.path for field in fields_of(Strength).values()} - {"law"}
    return any(key not in straight for key, _ in node.items())


def _curved_strength(reader: Reader, node: Node, owner: str) -> Strength | None:
    from slopekit.design.strength_laws import read_law, with_waves

    law = read_law(reader, node, owner)
    values = {
        name: reader.field(fields_of(Strength)[name], node.get(name.partition("_")[0]), owner)
        for name in ("dilation_deg", "tension_kpa")
    }
    if law is None or None in values.values():
        with_waves(
            reader, node, owner, Strength(0.0, 0.0)
        )  # reports the faults of its waviness too
        return None
    return with_waves(
        reader, node, owner, Strength.by_law(law, values["dilation_deg"], values["tension_kpa"])
    )


def default_strength_values(
    reader: Reader, nodes: Iterable[Node], measured_keys: Collection[str] = ()
) -> dict[str, float]:
    """Return the defaults of c (kPa) and φ (degrees) by key if no strength gives them: a wedge's example values."""
    straight_nodes = [node for node in nodes if not node.get("law") or node.get("c")]
    if not straight_nodes and list(nodes):
        return {}
    defaults = {
        key: value
        for key, value in reader.record.DEFAULTS.items()
        if key in ("c", "phi")
        and key not in measured_keys
        and not any(node.get(key) for node in straight_nodes)
    }
    reader.defaults += defaults
    return defaults


def strength_names(reader: Reader, users: Sequence[tuple[str, Node, Node]]) -> list[str | None]:
    """Return the name of each interface's strength: the one it names, or the only strength; None without any.

    Faults: E176 an unknown name or no name among several strengths, E195 a strength that no interface uses.

    Parameters
    ----------
    users : name of the interface, the node of its `strength` key, the node of the interface itself
    """
    strengths = reader.find("strength")
    if not strengths or nameless_keys(
        strengths, record_spec(Strength)
    ):  # a fault of the structure, reported there
        return [None] * len(users)
    used_names = {strength_key.text for _, strength_key, _ in users}
    unused_overrides = [
        name
        for name, node in strengths.items()
        if str(node.key_place).startswith("--set") and name not in used_names
    ]
    names = [
        name for name, _ in strengths.items() if name not in unused_overrides
    ] or unused_overrides
    assigned: list[str | None] = []
    for user, strength_key, interface_node in users:
        name = names[0] if len(names) == 1 else None
        if strength_key.text is not None:
            name = strength_key.text if strength_key.text in names else None
            if name is None:
                message = (
                    f"{user} has the strength {strength_key.text}, which is not under strength"
                )
                reader.fault(
                    "E176", message, strength_key, reader.nearest(strength_key.text, names)
                )
        elif len(names) > 1:
            message = f"{user} names no strength, and there are {len(names)}"
            reader.fault(
                "E176", message, interface_node, f"Add strength: {' or '.join(names[:4])}."
            )
        assigned.append(name)
    for name, node in strengths.items() if users else ():
        is_idle = len(names) > 1 and None not in assigned and name not in assigned
        if (
            name not in names or is_idle
        ):  # a misspelt name of --set, or a strength that no interface uses
            advice = "Use it or take it out." if name in names else reader.nearest(name, names)
            reader.fault("E195", f"the strength {name} is used by no interface", node, advice)
    return assigned


def read_strengths(
    reader: Reader, users: Sequence[tuple[str, Node, Node]]
) -> list[Strength | None]:
    """Read the strength of each interface; None where it has none or a faulty one."""
    names = strength_names(reader, users)
    strengths = reader.find("strength")
    nodes = {name: node for name in names if name is not None and (node := strengths.get(name))}
    defaults = default_strength_values(reader, nodes.values()) if None not in names else {}
    read = {name: read_strength(reader, node, name, defaults) for name, node in nodes.items()}
    return [None if name is None else read.get(name) for name in names]


def read_stiffness(reader: Reader) -> Stiffness:
    """Read the stiffness, which must be the same for all strengths; fault E112 where it is not."""
    stiffness_nodes = [
        node
        for _, strength_node in reader.names("strength")
        if (node := strength_node.get("stiffness"))
    ]
    if len({str(node.plain()) for node in stiffness_nodes}) > 1:
        advice = "Give both strengths the same stiffness; the limit factor does not depend on it."
        message = "the strengths have different stiffness: displacements take one for all"
        reader.fault("E112", message, stiffness_nodes[-1], advice)
    if not stiffness_nodes or len({str(node.plain()) for node in stiffness_nodes}) > 1:
        return Stiffness()
    declared_fields = fields_of(Stiffness)
    normal = (
        reader.field(declared_fields["normal_kn_m3"], stiffness_nodes[0].get("normal"))
        or Stiffness().normal_kn_m3
    )
    shear = stiffness_nodes[0].get("shear")
    if shear.is_mapping and not is_distribution(shear):
        law = shear.get("law")
        if law and str(law.text).lower() != "clough-duncan":
            advice = "Leave law out: it is clough-duncan (k1, n, Rf, phi)."
            reader.fault("E127", f"{law.text} is no shear law", law, advice)
        return Stiffness(
            normal, None, HyperbolaParameters(**reader.fields(HyperbolaParameters, shear))
        )
    return Stiffness(normal, reader.field(declared_fields["shear_kn_m3"], shear))


# -- water --------------------------------------------------------------------------------------------------------


def read_water(reader: Reader, order: Sequence[str], joints: int) -> tuple[Water, Node]:
    """Read the water of the interfaces in `order` (dry, a fraction of full, or pressures), with its node.

    Parameters
    ----------
    joints : number of the first interfaces that a single pressure applies to
    """
    node = reader.find("water")
    if node.value is None:
        return Water(), NOTHING
    forms = {key: below for key in ("mode", "fill", "pressures") if (below := node.get(key))}
    forms = forms if node.is_mapping else {"mode": node}
    if forms.keys() == {"mode", "fill"} and forms["mode"].text == "full":
        del forms["mode"]  # a fraction of full
    if len(forms) > 1:
        second = list(forms)[1]
        message = f"water has {' and '.join(forms)}: they exclude each other"
        reader.fault("E112", message, forms[second], "Keep one of them.")
    if len(forms) != 1:
        return Water(), node
    ((key, only),) = forms.items()
    pressures = (
        only
        if key == "pressures" or only.elements
        else expand_short_form(only, "water").get("pressures")
    )
    if pressures:
        return _water_of_pressures(reader, pressures, order, joints), only
    value = reader.value(only)
    fraction = None if value is None else reader.faults.of(words.fill, value, str(only.place))
    return (Water("full", fraction) if fraction else Water()), only


def _water_of_pressures(reader: Reader, node: Node, order: Sequence[str], joints: int) -> Water:
    """Read mean water pressures (kPa): one for the first `joints` interfaces, a list, or by interface name."""
    values = reader.per_interface(fields_of(Water)["pressures_kpa"], node, order)
    values = values * joints if len(values) == 1 else values
    while (
        len(values) > joints and values[-1] is None
    ):  # without a pressure in the crack, the design's own water of the crack applies
        values.pop()
    return (
        Water("pressures", 0.0, tuple(value or 0.0 for value in values)) if any(values) else Water()
    )
