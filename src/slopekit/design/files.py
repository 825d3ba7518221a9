"""From a design file to a checked design: the tree of YAML, its structure, its names, then the reader of its kind.

Every value keeps its place, so that each fault names its line and column, whatever finds it.
"""

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

from slopekit.design.common import Design
from slopekit.design.document import read_document
from slopekit.design.inputs import NAMES, Inputs
from slopekit.design.named_files import beside, mesh_file
from slopekit.design.nodes import Document, Node, document_from
from slopekit.design.overrides import with_overrides
from slopekit.design.reading import wedge_design
from slopekit.design.specs import SPECS, VERSION
from slopekit.design.strength_laws import with_laws
from slopekit.design.structure import check_structure
from slopekit.errors import DesignError, Fault
from slopekit.units import is_unit_of, unit_of

if TYPE_CHECKING:
    from slopekit.design.survey import Joint

Overrides = Sequence[tuple[str, object]]
_PATHS = frozenset(NAMES.values())


def load(source: str | os.PathLike[str] | Mapping[str, Any], overrides: Overrides = ()) -> Design:
    """Read and check a design file (or the same as a Python mapping).

    Parameters
    ----------
    overrides : dotted paths and values that replace those of the file

    Raises
    ------
    DesignError
        With every fault found.
    """
    if isinstance(source, Mapping):
        return design_of(with_overrides(document_from(source), overrides))
    document, faults = read_document(source, overrides)
    try:
        design = design_of(document)
    except DesignError as error:
        raise DesignError(dict.fromkeys([*faults, *error.faults])) from None
    if faults:
        raise DesignError(faults)
    return design


def design_of(document: Document, other_values: bool = False) -> Design:
    """The design in a document.

    Parameters
    ----------
    other_values : whether values were put over those of a design that was sound: correlations of what scattered before
        and does not now are passed over

    Raises
    ------
    DesignError
        E174 another version, E175 an unknown kind, and what structure, names and values are wrong.
    """
    root = document.root
    kind = _kind(root)
    faults = check_structure(root, SPECS[kind], kind, {name: spec for name, spec in SPECS.items() if name != kind})
    faults += _version(root)
    unsound = {fault.where for fault in faults}
    misshapen = [fault.where for fault in faults if fault.code in ("E144", "E145", "E164")]
    try:
        design = _read(Inputs(document, kind, misshapen, other_values))
    except DesignError as error:
        # what the structure has said of a place is not said again by the reader, nor what is missing without a place
        faults += [fault for fault in error.faults if fault.where not in unsound and fault.where not in _PATHS]
        raise DesignError(dict.fromkeys(faults or error.faults)) from None
    if faults:
        raise DesignError(dict.fromkeys(faults))
    return replace(design, source=document)


def with_values(design: Design, values: Mapping[str, object]) -> Design:
    """The design once more with other values, read and checked as `load` reads them.

    Parameters
    ----------
    values : dotted paths of its file and what they shall be, as `--set` takes them

    Raises
    ------
    DesignError
        E280 where the design was not read from a file or a dict, and what `load` raises.

    >>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
    >>> with_values(load(wedge), {"slope.height": 20}).height_m
    20.0
    """
    if design.source is None:
        advice = "Give a design file, or the same as a dict: sk.load({...})."
        raise DesignError([Fault("E280", "this design has no file whose values could be changed", "", advice)])
    # a small friction angle of a study is no slip of radians
    given = [(path, f"{value!r} deg" if path.endswith(".phi") and isinstance(value, float) else value)
             for path, value in values.items()]  # fmt: skip
    document = with_overrides(design.source, given)
    return replace(design_of(document, other_values=True), source=document)


def _kind(root: Node) -> str:
    node = root.get("kind")
    known = ", ".join(SPECS)
    if node is None or node.text is None:
        where = str(node.place if node else root.place)
        raise DesignError([Fault("E175", "kind is missing: it says what the design is", where, f"Known: {known}.")])
    if node.text not in SPECS:
        near = get_close_matches(node.text.lower(), SPECS, n=1)
        advice = f"Did you mean {near[0]}?" if near else f"Known: {known}."
        raise DesignError([Fault("E175", f"{node.text} is not a kind of design", str(node.place), advice)])
    return node.text


def _version(root: Node) -> list[Fault]:
    node = root.get("slopekit")
    if node is None or node.text is None or node.text == str(VERSION):
        return []
    message = f"slopekit: {node.text} is not a version of design files that this slopekit reads"
    return [Fault("E174", message, str(node.place), f"Write slopekit: {VERSION}.")]


def _read(inputs: Inputs) -> Design:
    """Read all that is there; the kind's reader raises what is wrong with the values."""
    inputs.shared()
    try:
        design = _KINDS[inputs.kind](inputs)
    except DesignError as error:
        inputs.faults += error.faults
        raise DesignError(inputs.faults) from None
    correlation = inputs.correlation()
    if inputs.faults:
        raise DesignError(inputs.faults)
    design = with_laws(design, inputs.laws)
    return replace(design, variables=tuple(inputs.variables.values()), correlation=correlation)


# -- joints and files that a design names -----------------------------------------------------------------------------


def _joints(inputs: Inputs, count: int) -> list[str]:
    """`dips` or `joint` from the file or a CSV, with their strengths; returns their names."""
    node = inputs.at("joints")
    if node is None or not node.is_mapping:
        return []
    if node.get("csv") is not None:
        return _joints_from_csv(inputs, node, count)
    entries = [(name, below) for name, below in node.items() if below.is_mapping]
    if len(entries) != count:
        needed = "two joints" if count == 2 else "one joint"
        if len(node.items()) != count:
            inputs.fault("E109", f"a {inputs.kind} has {needed}, {len(node.items())} are given", node)
        return []
    planes = [below.get("plane") for _, below in entries]
    if all(plane is not None and plane.value is not None for plane in planes):
        sure = [plane for plane in planes if plane is not None]
        values = [inputs.value(plane) for plane in sure]
        if None not in values:
            inputs.given["dips" if count == 2 else "joint"] = values if count == 2 else values[0]
            inputs.spelling.places["dips" if count == 2 else "joint"] = sure if count == 2 else sure[0]
    users = [(name, below.get("strength"), below) for name, below in entries]
    if inputs.at("strength") is not None:
        inputs.take_strengths(inputs.strengths_of(users))
    return [name for name, _ in entries]


def _joints_from_csv(inputs: Inputs, node: Node, count: int) -> list[str]:
    from slopekit.design.survey import read_joints

    file, pick, convention = node.get("csv"), node.get("pick"), node.get("convention")
    assert file is not None
    try:
        survey = read_joints(beside(inputs, file), convention.text if convention is not None else None)
    except DesignError as error:
        # a list that cannot be opened, or a convention that is none, is a slip in the design; a bad row is the list's
        slips = dict.fromkeys(("E147", "E148", "E149"), file) | ({} if convention is None else {"E192": convention})
        for fault in error.faults:
            at = slips.get(fault.code)
            inputs.faults.append(fault if at is None else replace(fault, where=str(at.place)))
        return []
    inputs.left_out += [f"{part} of {file.text}" for part in survey.left_out]
    names = [joint.name for joint in survey.joints]
    wanted = names if pick is None else [item.text or "" for item in (pick.elements or (pick,))]
    missing = [name for name in wanted if name not in names]
    for name in missing:
        near = get_close_matches(name, names, n=1)
        advice = f"Did you mean {near[0]}?" if near else f"There are: {', '.join(names[:8])}."
        inputs.fault("E197", f"{file.text} has no joint {name}", pick, advice)
    if missing:
        return []
    if len(wanted) != count:
        needed = "two joints" if count == 2 else "one joint"
        message = f"a {inputs.kind} takes {needed}, {len(wanted)} come from {file.text}"
        inputs.fault("E109", message, pick or file, f"Add pick: [{', '.join(names[:count])}].")
        return []
    chosen = [survey.joints[names.index(name)] for name in wanted]
    inputs.given["dips" if count == 2 else "joint"] = (
        [joint.plane for joint in chosen] if count == 2 else chosen[0].plane
    )
    inputs.spelling.places["dips" if count == 2 else "joint"] = [file] * count if count == 2 else file
    _csv_strengths(inputs, node, file, chosen)
    return list(wanted)


def _csv_strengths(inputs: Inputs, node: Node, file: Node, chosen: "Sequence[Joint]") -> None:
    """Strengths of joints from a list: its own columns where they are filled, else those of the design."""
    own = {"c": [joint.cohesion_kpa for joint in chosen], "phi": [joint.friction_angle_deg for joint in chosen]}
    measured = {key: values for key, values in own.items() if any(value is not None for value in values)}
    if inputs.at("strength") is not None:
        inputs.take_strengths(inputs.strengths_of([(joint.name, node.get("strength"), file) for joint in chosen]))
    for key, values in measured.items():
        from_file = inputs.given.get(key)
        for k, (joint, value) in enumerate(zip(chosen, values, strict=True)):
            if value is None and from_file is None:
                advice = f"Fill in the column {key}, or give a strength in the design."
                inputs.fault("E143", f"{key} of {joint.name} is missing in {file.text}", file, advice)
            elif value is None:
                values[k] = from_file[k] if isinstance(from_file, list) else from_file
            elif from_file is not None:
                inputs.left_out.append(f"{key} of the design for {joint.name}: {file.text} has its own")
        inputs.given[key] = values if len(values) > 1 else values[0]
        inputs.spelling.places[key] = [file] * len(values) if len(values) > 1 else file


# -- the kinds --------------------------------------------------------------------------------------------------------


def _wedge(inputs: Inputs) -> Design:
    for name in ("face", "upper", "height", "origin", "refine"):
        inputs.take(name)
    names = _joints(inputs, 2)
    if "c" not in inputs.given and "phi" not in inputs.given and inputs.only_strength() and not names:
        inputs.take_strengths([inputs.at(f"strength.{inputs.only_strength()}")] * 2)
    crack = inputs.at("crack")
    inputs.water([*(names or ["J1", "J2"]), *(["crack"] if crack is not None else [])])
    if crack is not None and crack.is_mapping:
        inputs.spelling.places["crack"] = crack
        plane, distance = crack.get("plane"), crack.get("distance")
        if plane is not None and distance is not None:
            given = {"plane": inputs.value(plane), "distance": inputs.value(distance)}
            inputs.given["crack"] = None if None in given.values() else given
        _wedge_crack_water(inputs, crack)
    return wedge_design(
        inputs.given | {"joint_names": tuple(names or ("J1", "J2"))}, spelling=inputs.spelling
    )  # fmt: skip


def _wedge_crack_water(inputs: Inputs, crack: Node) -> None:
    """The crack's own word on water: how full it is, or its pressure, which is the third beside those of the joints."""
    node = crack.get("water")
    if node is None or node.value is None:
        return
    water, value = inputs.given.get("water", "dry"), inputs.value(node)
    joints = list(water) if isinstance(water, list) else [0.0, 0.0] if water in ("dry", 0.0) else None
    if not is_unit_of(unit_of(value), "pressure"):
        if joints is None or len(joints) < 3:
            inputs.put("crack_fill", node)
            return
    elif joints is not None and len(joints) < 3:
        inputs.given["water"] = [*(joints * 2)[:2], value]
        inputs.spelling.places["water"] = node
        return
    advice = "Give the crack's water in one place; beside full joints it is a part of full: crack: {water: 50 %}."
    inputs.fault("E198", f"the crack's water is {node.text}, and water says another thing", node, advice)


def _plane(inputs: Inputs) -> Design:
    from slopekit.design.reading_kinds import plane_design

    for name in ("face", "upper", "height", "refine", "crack_depth", "crack_distance"):
        inputs.take(name)
    crack = inputs.at("crack")
    if crack is not None and not ({"depth", "distance"} & {key for key, _ in crack.items()}):
        inputs.fault("E143", "crack.depth is missing", crack, "Add depth: 4.35 m, or distance: 4 m from the crest.")
        crack = None
    water = crack.get("water") if crack is not None else None
    if water is not None and water.value is not None:
        if water.text in ("dry", "full"):
            if inputs.at("water") is None:
                inputs.given["water"] = water.text
                inputs.spelling.places["water"] = water
            else:
                inputs.fault("E198", "crack.water and water both say how full it is", water, "Keep one of them.")
        else:
            inputs.put("crack_water", water)
    names = _joints(inputs, 1)
    inputs.water([*(names or ["J1"]), *(["crack"] if crack is not None else [])])
    if "crack_water" in inputs.given and inputs.given.get("water", "dry") != "dry":
        inputs.fault("E198", "crack.water and water both say how full it is", water, "Keep one of them.")
    return plane_design(inputs.given | {"joint_name": names[0] if names else "J1"}, inputs.spelling)


def _footing(inputs: Inputs) -> Design:
    from slopekit.design.reading_kinds import footing_design

    for name in ("load", "dip", "length", "pairs"):
        inputs.take(name)
    at = inputs.at("footing.at")
    if at is not None and at.text != "middle":
        inputs.take("load_at")
    node = inputs.at("weak_plane")
    if node is not None and inputs.at("strength") is not None:
        inputs.take_strengths(inputs.strengths_of([("weak_plane", node.get("strength"), node)]))
    return footing_design(inputs.given, inputs.spelling)


def _surface(inputs: Inputs) -> Design:
    from slopekit.design.reading_kinds import surface_design

    slip, slope = inputs.at("slip"), inputs.at("slope")
    for name in ("profile", "shape", "centre", "radii", "radius", "slip_length", "edge", "normals"):
        inputs.take(name)
    for key, holder, other in (("slip_mesh", slip, "shape"), ("ground_mesh", slope, "profile")):
        node = holder.get("mesh") if holder is not None else None
        if node is not None and node.text is not None:
            if holder is not None and holder.get(other) is not None:
                inputs.fault("E112", f"{holder.path} has mesh and {other}", node, "Give one of the two.")
            inputs.given[key] = mesh_file(inputs, node)
            inputs.spelling.places[key] = node
        elif holder is not None and holder.get(other) is None:
            inputs.fault("E143", f"{holder.path}.{other} is missing", holder, f"Add {other}: or mesh:.")
    if inputs.at("strength") is not None:
        where = slip if slip is not None else inputs.root
        inputs.take_strengths(inputs.strengths_of([("slip", None, where)]))
    inputs.water(["slip"])
    return surface_design(inputs.given, inputs.spelling)


def _topple(inputs: Inputs) -> Design:
    from slopekit.design.reading_blocky import topple_design

    return topple_design(inputs)


def _bench(inputs: Inputs) -> Design:
    from slopekit.design.reading_blocky import bench_design

    return bench_design(inputs)


def _blocks(inputs: Inputs) -> Design:
    from slopekit.design.reading_blocks import blocks_design

    return blocks_design(inputs)


_KINDS: Mapping[str, Callable[[Inputs], Design]] = {
    "wedge": _wedge, "plane": _plane, "footing": _footing, "surface": _surface, "topple": _topple, "bench": _bench,
    "blocks": _blocks,
}  # fmt: skip

__all__ = ["design_of", "load", "with_values"]
