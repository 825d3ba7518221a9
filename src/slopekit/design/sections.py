"""What designs of every kind share, read from their documents: weight, loads, strengths, stiffness, water."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from slopekit.core.errors import Fault
from slopekit.core.orientation import Line
from slopekit.core.orientation import number as shown
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
from slopekit.design.reading.structure import is_distribution, spread, without_name

_MOST_FACTORS = 200

# -- what every kind has ------------------------------------------------------------------------------------------


def read_common(reader: Reader, on_blocks: bool = False) -> dict[str, Any]:
    """The values that every kind of design has, by attribute; call it after the kind's own.

    Parameters
    ----------
    on_blocks : whether forces and bolts name their blocks, and are read with them
    """
    attributes = reader.fields(Design, only=(
        "gravity_m_s2", "water_unit_weight_kn_m3", "criterion", "agree_within",
        "modulus_kpa", "poisson", "elastic_edge_m",
    ))  # fmt: skip
    reader.field(BEDROCK, reader.at(BEDROCK.path))
    attributes |= read_weight(reader, attributes["gravity_m_s2"])
    own = fields_of(reader.record)
    if "seismic" in own:
        attributes["seismic"] = read_seismic(reader)
    if "forces" in own and not on_blocks:
        attributes["forces"] = reader.many("loads.forces", read_force)
        attributes["bolts"] = reader.many("support.bolts", read_bolt)
    attributes["rules"] = reader.many("acceptance.rules", read_rule)
    attributes["factors"] = read_factors(reader) if "factors" in own else ()
    return attributes | {
        "title": reader.at("title").text or "",
        "project": Project(**reader.fields(Project, reader.at("project"))),
        "stiffness": read_stiffness(reader),
    }


def read_weight(reader: Reader, gravity: float | None) -> dict[str, Any]:
    """Unit weight (kN/m³) and, where that was given, the density (kg/m³): one of the two, E112."""
    own = fields_of(reader.record)
    weight, density = reader.at("rock.unit_weight"), reader.at("rock.density")
    if weight and density:
        where = f"{density.place}, {weight.place}"
        reader.faults.append(Fault("E112", "density and unit weight are both given", where, "Give one of the two."))
        return {"unit_weight_kn_m3": None, "density_kg_m3": None}
    if weight:
        return {"unit_weight_kn_m3": reader.field(own["unit_weight_kn_m3"], weight), "density_kg_m3": None}
    density_kg_m3 = reader.field(own["density_kg_m3"], density)
    if not density and density_kg_m3 is None and reader.at("rock") and "rock" in reader.record.REQUIRED:
        reader.fault("E143", "rock.density is missing", reader.at("rock"), "Give rock.density.")
    by_density = None if density_kg_m3 is None or gravity is None else density_kg_m3 * gravity / 1e3
    return {"unit_weight_kn_m3": by_density, "density_kg_m3": density_kg_m3}


def read_seismic(reader: Reader) -> Seismic:
    """The seismic load as a number, in words (0.1@180), or by its keys."""
    node = reader.at("loads.seismic")
    if node.value is None:
        return Seismic()
    own = fields_of(Seismic)
    given = spread(node, "loads.seismic")
    k = given.get("k") if given.is_mapping and not is_distribution(node) else node
    if not k:
        advice = "Add k: 0.1, a fraction of gravity, or leave loads.seismic out."
        reader.fault("E143", "loads.seismic.k is missing", node, advice)
    coefficient = reader.field(own["coefficient"], k) if k else None
    toward = given.get("toward")
    trend = reader.field(own["trend_deg"], toward)
    if coefficient and not toward:
        reader.defaults.append("seismic.trend")
    return Seismic() if coefficient is None or (toward and trend is None) else Seismic(coefficient, trend)


def read_rule(reader: Reader, node: Node) -> Rule | None:
    """An acceptance rule."""
    return reader.faults.of(words.rule, reader.written(node), str(node.place))


def read_force(reader: Reader, node: Node) -> Force | None:
    """A force: its components, or its size and direction, in words or by its keys."""
    own, keys = fields_of(Force), spread(node, "loads.forces.0")
    size, toward = keys.get("force") if keys.is_mapping else node, keys.get("toward")
    if size and not toward:  # force: 300 kN@180/10, with its place beside it
        written = spread(size, "loads.forces.0")
        size, toward = written.get("force") or size, written.get("toward")
    components: Any = None
    line: Line | None = None
    if size and toward:
        amount, line = reader.number(own["components_kn"], size, "force"), reader.field(own["toward"], toward)
        components = None if amount is None or line is None else tuple((amount * line.vector()).tolist())
    elif size.elements and _has_keys_of(keys, Force):
        components = reader.faults.of(words.point, reader.value(size), "force", str(node.place), "force")
    else:
        message = (
            f"force is {words.shown(reader.written(size or node))}, it is written 500kN@180/10 or (east, north, up)"
        )
        reader.fault("E123", message, node)
    at_m = reader.field(own["at_m"], keys.get("at"))
    return None if components is None else Force(components, at_m, toward=line)


def read_bolt(reader: Reader, node: Node) -> Bolt | None:
    """A bolt in words or by its keys."""
    keys = spread(node, "support.bolts.0")
    if not keys.is_mapping or not _has_keys_of(keys, Bolt):
        said = "it is written 200kN@000/10,passive or as force, toward, acts, head, length"
        reader.fault("E124", f"bolt is {words.shown(reader.written(node))}, {said}", node)
        return None
    values = reader.fields(Bolt, keys)
    if values["length_m"] is not None and not keys.get("head"):
        reader.fault("E124", "a bolt with a length needs its head", node)
    needed = (values["force_kn"], values["toward"], values["acts"])
    return None if None in needed else Bolt(**values)


def _has_keys_of(node: Node, record: type) -> bool:
    """Whether all keys are those of a record: nobody else has looked at those of a call."""
    known = {field.path for field in fields_of(record).values()}
    return all(key in known for key, _ in node.items())


def read_factors(reader: Reader) -> tuple[float, ...]:
    """Strength reduction factors of the series, sorted."""
    node = reader.at("analysis.factors")
    factors = reader.field(fields_of(Design)["factors"], node)
    if len(factors) > _MOST_FACTORS:
        reader.fault("E127", f"{len(factors)} factors are too many for one series (most: {_MOST_FACTORS})", node)
    return tuple(sorted(set(factors)))


# -- strengths ----------------------------------------------------------------------------------------------------


def read_strength(
    reader: Reader,
    node: Node,
    owner: str,
    standard: Mapping[str, float] | None = None,
    listed: Mapping[str, float | None] | None = None,
    beside: Node = NOTHING,
) -> Strength | None:
    """One strength: E143 without c or φ, E115 a dilation above φ.

    Parameters
    ----------
    owner : its name; standard : what it takes by key where it says nothing
    listed : what a joint list says in its place, from the file `beside`
    """
    if not node.is_mapping and not listed and not standard:
        return None
    peak = _peak_strength(reader, node, owner, standard, listed, beside)
    return _with_residual(reader, node.get("residual"), owner, peak)


def _peak_strength(
    reader: Reader,
    node: Node,
    owner: str,
    standard: Mapping[str, float] | None,
    listed: Mapping[str, float | None] | None,
    beside: Node,
) -> Strength | None:
    is_curved = _is_curved(node)
    if is_curved:
        from slopekit.design.strength_laws import named_law, refuse_keys, with_waves

        if named_law(node) is not None:
            return _curved_strength(reader, node, owner)
        refuse_keys(reader, node)
    attributes = reader.fields(Strength, node, owner)
    for name, field in fields_of(Strength).items():
        given = node.get(field.path)
        if listed and field.path in listed:
            attributes[name] = listed[field.path]
        elif not given and standard and field.path in standard:
            attributes[name] = standard[field.path]
        elif not given and field.may_lack and (node or not (listed and beside)):
            path = f"{node.path}.{field.path}" if node else f"{field.path} of {owner}"
            reader.fault("E143", f"{path} is missing", node or beside, f"Add {field.path}.")
    friction, dilation = attributes["friction_angle_deg"], attributes["dilation_deg"]
    below = node.get("dilation")
    if friction is not None and dilation is not None and below and dilation > friction:
        message = f"dilation of {owner} is {shown(dilation)}°, it lies between 0 and the friction angle"
        reader.fault("E115", f"{message} {shown(friction)}°", below)
    straight = None if None in attributes.values() else Strength(**attributes)
    return with_waves(reader, node, owner, straight) if is_curved and straight is not None else straight


def _with_residual(reader: Reader, below: Node, owner: str, peak: Strength | None) -> Strength | None:
    """A strength with what is left of it after slip: E453 where that is more than the peak."""
    attributes = reader.fields(Residual, below, f"residual {owner}") if below.is_mapping else {}
    if not attributes or None in attributes.values() or peak is None:
        return peak
    residual = Residual(**attributes)
    for value, most, what, unit in (
        (residual.cohesion_kpa, peak.cohesion_kpa, "cohesion", " kPa"),
        (residual.friction_angle_deg, peak.friction_angle_deg, "friction angle", "°"),
    ):
        if value > most and peak.law is None:
            message = f"the residual {what} of {owner} is {shown(value)}{unit}, its peak {shown(most)}{unit}"
            reader.fault("E453", message, below, "Residual strength is what is left after slip: at most the peak.")
    return replace(peak, residual=residual)


def _is_curved(node: Node) -> bool:
    """Whether a strength has keys beside those of a straight line."""
    straight = {field.path for field in fields_of(Strength).values()} - {"law"}
    return any(key not in straight for key, _ in node.items())


def _curved_strength(reader: Reader, node: Node, owner: str) -> Strength | None:
    from slopekit.design.strength_laws import read_law, with_waves

    law = read_law(reader, node, owner)
    own = {name: reader.field(fields_of(Strength)[name], node.get(name.partition("_")[0]), owner)
           for name in ("dilation_deg", "tension_kpa")}  # fmt: skip
    if law is None or None in own.values():
        with_waves(reader, node, owner, Strength(0.0, 0.0))  # what is wrong with them is said all the same
        return None
    return with_waves(reader, node, owner, Strength.by_law(law, own["dilation_deg"], own["tension_kpa"]))


def standard_strength(reader: Reader, nodes: Iterable[Node], beside: Collection[str] = ()) -> dict[str, float]:
    """What c and φ are, by key, where none of the strengths says so: a wedge takes the paper's."""
    given = [node for node in nodes if not node.get("law") or node.get("c")]
    if not given and list(nodes):
        return {}
    defaults = {
        key: value for key, value in reader.record.DEFAULTS.items()
        if key in ("c", "phi") and key not in beside and not any(node.get(key) for node in given)
    }  # fmt: skip
    reader.defaults += defaults
    return defaults


def strength_names(reader: Reader, users: Sequence[tuple[str, Node, Node]]) -> list[str | None]:
    """The name of each interface's strength: the one it names, or the only one there is; E176, E195.

    None where it has none, as all have none where the design gives no strengths.

    Parameters
    ----------
    users : name of the interface, the node of its `strength` key, the node of the interface itself
    """
    strengths = reader.at("strength")
    if not strengths or without_name(strengths, record_spec(Strength)):  # the structure says so
        return [None] * len(users)
    named = {wanted.text for _, wanted, _ in users}
    slips = [name for name, node in strengths.items() if str(node.key_place).startswith("--set") and name not in named]
    names = [name for name, _ in strengths.items() if name not in slips] or slips
    assigned: list[str | None] = []
    for user, wanted, own in users:
        name = names[0] if len(names) == 1 else None
        if wanted.text is not None:
            name = wanted.text if wanted.text in names else None
            if name is None:
                message = f"{user} has the strength {wanted.text}, which is not under strength"
                reader.fault("E176", message, wanted, reader.nearest(wanted.text, names))
        elif len(names) > 1:
            message = f"{user} names no strength, and there are {len(names)}"
            reader.fault("E176", message, own, f"Add strength: {' or '.join(names[:4])}.")
        assigned.append(name)
    for name, node in strengths.items() if users else ():
        is_idle = len(names) > 1 and None not in assigned and name not in assigned
        if name not in names or is_idle:  # a name that was typed beside those of the file; one that nothing has
            advice = "Use it or take it out." if name in names else reader.nearest(name, names)
            reader.fault("E195", f"the strength {name} is used by no interface", node, advice)
    return assigned


def read_strengths(reader: Reader, users: Sequence[tuple[str, Node, Node]]) -> list[Strength | None]:
    """The strength of each interface."""
    names = strength_names(reader, users)
    strengths = reader.at("strength")
    nodes = {name: node for name in names if name is not None and (node := strengths.get(name))}
    standard = standard_strength(reader, nodes.values()) if None not in names else {}
    read = {name: read_strength(reader, node, name, standard) for name, node in nodes.items()}
    return [None if name is None else read.get(name) for name in names]


def read_stiffness(reader: Reader) -> Stiffness:
    """The stiffness that is one for all strengths; E112 where it is not."""
    given = [node for _, own in reader.names("strength") if (node := own.get("stiffness"))]
    if len({str(node.plain()) for node in given}) > 1:
        advice = "Give both strengths the same stiffness; the limit factor does not depend on it."
        message = "the strengths have different stiffness: displacements take one for all"
        reader.fault("E112", message, given[-1], advice)
    if not given or len({str(node.plain()) for node in given}) > 1:
        return Stiffness()
    own = fields_of(Stiffness)
    normal = reader.field(own["normal_kn_m3"], given[0].get("normal")) or Stiffness().normal_kn_m3
    shear = given[0].get("shear")
    if shear.is_mapping and not is_distribution(shear):
        law = shear.get("law")
        if law and str(law.text).lower() != "clough-duncan":
            advice = "Leave law out: it is clough-duncan (k1, n, Rf, phi)."
            reader.fault("E127", f"{law.text} is no shear law", law, advice)
        return Stiffness(normal, None, HyperbolaParameters(**reader.fields(HyperbolaParameters, shear)))
    return Stiffness(normal, reader.field(own["shear_kn_m3"], shear))


# -- water --------------------------------------------------------------------------------------------------------


def read_water(reader: Reader, order: Sequence[str], joints: int) -> tuple[Water, Node]:
    """Water of the interfaces in `order`: dry, a fraction of full, or pressures; and where it stands.

    Parameters
    ----------
    joints : of how many of the first interfaces one pressure is
    """
    node = reader.at("water")
    if node.value is None:
        return Water(), NOTHING
    said = {key: below for key in ("mode", "fill", "pressures") if (below := node.get(key))}
    said = said if node.is_mapping else {"mode": node}
    if said.keys() == {"mode", "fill"} and said["mode"].text == "full":
        del said["mode"]  # so much of full
    if len(said) > 1:
        second = list(said)[1]
        message = f"water has {' and '.join(said)}: they exclude each other"
        reader.fault("E112", message, said[second], "Keep one of them.")
    if len(said) != 1:
        return Water(), node
    ((key, only),) = said.items()
    pressures = only if key == "pressures" or only.elements else spread(only, "water").get("pressures")
    if pressures:
        return _by_pressures(reader, pressures, order, joints), only
    value = reader.value(only)
    part = None if value is None else reader.faults.of(words.fill, value, str(only.place))
    return (Water("full", part) if part else Water()), only


def _by_pressures(reader: Reader, node: Node, order: Sequence[str], joints: int) -> Water:
    """Water by its mean pressures: one of the first `joints` interfaces, a list, or by the names of the interfaces."""
    values = reader.each(fields_of(Water)["pressures_kpa"], node, order)
    values = values * joints if len(values) == 1 else values
    while len(values) > joints and values[-1] is None:  # what says nothing of the crack leaves it to the design
        values.pop()
    return Water("pressures", 0.0, tuple(value or 0.0 for value in values)) if any(values) else Water()
