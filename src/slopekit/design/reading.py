"""Wedges: from a design file, and from the inputs of a call (command line, Python); all faults at once."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from typing import Any

from slopekit.design import words
from slopekit.design.common import Strength, Water
from slopekit.design.joints import joints_of, strengths_of
from slopekit.design.nodes import Document, Node, Place, from_python
from slopekit.design.reader import Reader
from slopekit.design.sections import given_water, read_common, read_strength, read_water
from slopekit.design.wedge import Crack, WedgeDesign
from slopekit.errors import Fault
from slopekit.units import is_unit_of, unit_of


def read_wedge(reader: Reader) -> WedgeDesign:
    """A wedge from its document.

    Raises
    ------
    DesignError
        With every fault found.
    """
    joints = joints_of(reader, 2)
    own = reader.fields(WedgeDesign, only=("face", "upper", "height_m"))
    strengths = strengths_of(reader, joints) if joints else _without_joints(reader)
    crack_node = reader.at("crack")
    crack = None if crack_node is None or crack_node.value is None else _crack(reader, crack_node)
    has_crack = crack_node is not None and crack_node.value is not None
    names = tuple(joint.name for joint in joints) or ("J1", "J2")
    water = _water(reader, crack_node, [*names, *(["crack"] if has_crack else [])])
    own |= reader.fields(WedgeDesign, only=("refine", "origin_m"))
    common = read_common(reader)
    sound = [one or Strength(0.0, 0.0) for one in strengths]
    return reader.made(
        WedgeDesign, own, common, joints=tuple(joint.plane for joint in joints), joint_names=names, crack=crack,
        water=water, cohesion_kpa=tuple(one.cohesion_kpa for one in sound),
        friction_angle_deg=tuple(one.friction_angle_deg for one in sound),
        dilation_deg=tuple(one.dilation_deg for one in sound), tension_kpa=tuple(one.tension_kpa for one in sound),
        laws=tuple(one.law for one in sound),
    )  # fmt: skip


def _without_joints(reader: Reader) -> list[Strength | None]:
    """Strengths whose joints are wrong: what is wrong with them is said all the same."""
    for name, node in reader.names("strength"):
        read_strength(reader, node, name, reader.record.DEFAULTS)
    return [None, None]


def _crack(reader: Reader, node: Node) -> Crack | None:
    value = reader.value(node)
    if isinstance(value, dict):
        value.pop("water", None)
        if None in value.values():
            return None
    return None if value is None else reader.kept(words.crack, value, str(node.place))


def _water(reader: Reader, crack: Node | None, order: Sequence[str]) -> Water:
    """Water on the joints, with the crack's own word: how full it is, or its pressure, the third beside the joints'."""
    has_crack = crack is not None
    node = crack.get("water") if crack is not None else None
    if node is None or node.value is None:
        return read_water(reader, order, has_crack)[0]
    top = reader.at("water")
    given = None if top is None or top.value is None else given_water(reader, top, order)
    water, value = ("dry" if given is None else given[0]), reader.value(node)
    joints = list(water) if isinstance(water, list) else [0.0, 0.0] if water in ("dry", 0.0) else None

    def read(word: Any, at: Node) -> Water:
        return reader.kept(words.water, word, str(at.place), has_crack) or Water()

    if not is_unit_of(unit_of(value), "pressure"):
        if joints is None or len(joints) < 3:
            own = read(water, given[1]) if given is not None else Water()
            return replace(own, crack_fill=reader.kept(words.fill, value, str(node.place)))
    elif joints is not None and len(joints) < 3:
        return read([*(joints * 2)[:2], value], node)
    advice = "Give the crack's water in one place; beside full joints it is a part of full: crack: {water: 50 %}."
    reader.fault("E198", f"the crack's water is {node.text}, and water says another thing", node, advice)
    return Water()


# -- calls ------------------------------------------------------------------------------------------------------------

#: Where the inputs of a call stand in a design, by their names; strengths are one for each joint.
_PATHS: Mapping[str, str] = {
    "face": "slope.face", "upper": "slope.upper", "height": "slope.height", "origin": "slope.origin", "crack": "crack",
    "density": "rock.density", "unit_weight": "rock.unit_weight", "gravity": "rock.gravity", "water": "water.mode",
    "water_unit_weight": "water.unit_weight", "seismic": "loads.seismic", "forces": "loads.forces",
    "bolts": "support.bolts", "criterion": "analysis.criterion", "accept": "acceptance.rules",
    "agree_within": "analysis.agree_within", "stop_when": "analysis.stop_when", "refine": "analysis.refine",
    "factors": "analysis.factors", "title": "title",
}  # fmt: skip
_OF_JOINTS = ("c", "phi", "dilation", "tension")
_STIFFNESS = {"normal_stiffness": "normal", "shear_stiffness": "shear"}
_KNOWN = ("dips", *_OF_JOINTS, *_STIFFNESS, *_PATHS)
_LISTS = ("forces", "bolts", "factors", "accept")


def wedge_design(given: Mapping[str, Any], option: Callable[[str], str] = lambda key: f"{key} =") -> WedgeDesign:
    """Check and convert the inputs of one wedge.

    Parameters
    ----------
    given : what the user gave, by the Python names of `slopekit.wedge`; None means not given
    option : how a key is called where the user wrote it (`--dips` on the command line)

    Raises
    ------
    DesignError
        With every fault found, not only the first.
    """
    faults: list[Fault] = []
    tree: dict[str, Any] = {}

    def put(path: str, node: Node) -> None:
        *above, last = path.split(".")
        holder = tree
        for part in above:
            holder = holder.setdefault(part, {})
        holder[last] = node

    def node(key: str, value: Any, shown: Any = None) -> Node:
        place = Place("", 0, 0, f"{option(key)} {words.shown(value if shown is None else shown)}")
        return from_python(value, key, lambda _path, _value: place, faults)

    values = {key: _plain(value) for key, value in given.items() if value is not None}
    for key in values:
        if key not in _KNOWN:
            near = get_close_matches(key, _KNOWN, n=1)
            advice = f"Did you mean {near[0]}?" if near else f"Known: {', '.join(_KNOWN)}."
            faults.append(Fault("E128", f"{key} is not an input of a wedge", key, advice))
    for name, plane in zip(("J1", "J2"), _both_joints(values.get("dips"), option, faults), strict=False):
        put(f"joints.{name}.plane", node("dips", plane))
        put(f"joints.{name}.strength", node("dips", name))
    for key in _OF_JOINTS:
        for name, part in zip(("J1", "J2"), _both(key, values.get(key), option, faults), strict=False):
            put(f"strength.{name}.{key}", part if isinstance(part, Node) else node(key, part, values[key]))
    for key, path in _STIFFNESS.items():
        for name in ("J1", "J2") if key in values else ():
            put(f"strength.{name}.stiffness.{path}", node(key, values[key]))
    for key, path in _PATHS.items():
        value = values.get(key)
        if value is None:
            continue
        if key in _LISTS:
            one = isinstance(value, str | Mapping) or (key == "forces" and words.is_point(value))
            items = [value] if one or not isinstance(value, Sequence) else value
            put(path, replace(node(key, ""), value=[node(key, item) for item in items]))
        else:
            put(path, node(key, value))
    root = _nested(tree, Place("", 0, 0, ""))
    reader = Reader(Document(root, "call", option=option), WedgeDesign)
    reader.faults += faults
    return read_wedge(reader)


def _nested(tree: Mapping[str, Any], place: Place, path: str = "") -> Node:
    below = {
        key: value if isinstance(value, Node) else _nested(value, place, f"{path}.{key}" if path else key)
        for key, value in tree.items()
    }  # fmt: skip
    return Node(below, place, path, place)


def _plain(value: Any) -> Any:
    return value.tolist() if hasattr(value, "tolist") else value


def _both_joints(dips: Any, option: Callable[[str], str], faults: list[Fault]) -> Sequence[Any]:
    advice = "Give 45/115 45/245."
    if dips is None:
        faults.append(Fault("E109", "the two joints are missing", option("dips"), advice))
        return ()
    if isinstance(dips, str) or not isinstance(dips, Sequence) or len(dips) != 2:
        message = f"a wedge has two joints, {words.shown(dips)} is not two orientations"
        faults.append(Fault("E109", message, f"{option('dips')} {words.shown(dips)}", advice))
        return ()
    return dips


def _both(key: str, value: Any, option: Callable[[str], str], faults: list[Fault]) -> Sequence[Any]:
    """One value for both joints, or one for each."""
    if value is None:
        return ()
    parts = re.split(r"\s*,\s*", value.strip()) if isinstance(value, str) else value
    parts = list(parts) if isinstance(parts, Sequence) and not isinstance(parts, str) else [parts]
    if len(parts) == 1 or (len(parts) == 2 and parts[0] == parts[1]):
        place = Place("", 0, 0, f"{option(key)} {words.shown(value)}")
        same = from_python(parts[0], key, lambda _path, _value: place, faults)
        return same, same  # the same node: what is wrong with it is said once
    if len(parts) != 2:
        message = f"{key} has {len(parts)} values, a wedge has two joints: give one value or two"
        faults.append(Fault("E109", message, f"{option(key)} {words.shown(value)}"))
        return ()
    return parts
