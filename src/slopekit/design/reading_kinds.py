"""Designs of one block beside the wedge, from their documents: all faults at once."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from slopekit.design.common import MeshFile, Stiffness, Strength, Water
from slopekit.design.fields import fields_of
from slopekit.design.joints import joints_of, strengths_of
from slopekit.design.kinds import FootingDesign, PlaneDesign, Points, Slip, SurfaceDesign, VerticalCrack
from slopekit.design.named_files import mesh_file
from slopekit.design.nodes import Node
from slopekit.design.reader import Reader
from slopekit.design.sections import read_common, read_strengths, read_water
from slopekit.orientation import Plane
from slopekit.units import quantity

#: What gives the size of each shape of slip surface.
_SIZES = {"ellipsoid": ("radii",), "sphere": ("radius",), "cylinder": ("radius", "length")}


def read_plane(reader: Reader) -> PlaneDesign:
    """A plane failure.

    Raises
    ------
    DesignError
        With every fault found.
    """
    joints = joints_of(reader, 1)
    own = reader.fields(PlaneDesign)
    if own["upper"] is None and reader.at("slope.upper") is None:
        own["upper"] = reader.default("upper", Plane(0.0, 0.0 if own["face"] is not None else 180.0))
    node = reader.at("crack")
    if node is not None and not ({"depth", "distance"} & {key for key, _ in node.items()}):
        reader.fault("E143", "crack.depth is missing", node, "Add depth: 4.35 m, or distance: 4 m from the crest.")
        node = None
    crack, said = None, None if node is None else node.get("water")
    fills = said is not None and said.text in ("dry", "full")
    if node is not None:
        without = replace(node, value={key: below for key, below in node.items() if not (fills and key == "water")})
        crack = VerticalCrack(**reader.fields(VerticalCrack, without))
    strengths = strengths_of(reader, joints)
    names = [joint.name for joint in joints] or ["J1"]
    water = _water_of_plane(reader, names, said if fills else None, crack is not None)
    if said is not None and (reader.at("water") is not None if fills else water != Water()):
        reader.fault("E198", "crack.water and water both say how full it is", said, "Keep one of them.")
    common = read_common(reader)
    return reader.made(
        PlaneDesign, own, common, joint=joints[0].plane if joints else None, joint_name=names[0], crack=crack,
        strength=strengths[0] if strengths else None, water=water,
    )  # fmt: skip


def _water_of_plane(reader: Reader, names: list[str], in_crack: Node | None, has_crack: bool) -> Water:
    if in_crack is not None and reader.at("water") is None:
        return Water("full", 1.0) if in_crack.text == "full" else Water()
    water, at = read_water(reader, [*names, *(["crack"] if has_crack else [])])
    if at is not None and not has_crack and len(at.elements) > 1:
        message = f"{len(at.elements)} water pressures given, there is one plane and no crack"
        reader.fault("E109", message, at)
    if water.mode == "pressures" and not has_crack:
        return Water("pressures", 0.0, water.pressures_kpa[:1])
    return water


def read_footing(reader: Reader) -> FootingDesign:
    """A footing on a weak plane.

    Raises
    ------
    DesignError
        With every fault found; E199 for a number of node pairs that the rule does not take.
    """
    own = reader.fields(FootingDesign)
    node = reader.at("weak_plane")
    strength = _strength(reader, "weak_plane", node, None if node is None else node.get("strength"))
    common = read_common(reader)
    if common["unit_weight_kn_m3"] is None:
        common["unit_weight_kn_m3"] = 0.0  # the paper leaves the weight out
    if all(reader.at(f"strength.{name}.stiffness.shear") is None for name, _ in reader.names("strength")):
        # a seam with a modulus: G is a third of E for ν = 0.5, as the paper has it
        normal = common["stiffness"].normal_kn_m3
        common["stiffness"] = Stiffness(normal, normal / 3.0)
    return reader.made(FootingDesign, own, common, strength=strength)


def _strength(reader: Reader, user: str, own: Node | None, wanted: Node | None) -> Strength | None:
    """The one strength of a design with one interface."""
    if reader.at("strength") is None:
        return None
    return read_strengths(reader, [(user, wanted, own if own is not None else reader.root)])[0]


def read_surface(reader: Reader) -> SurfaceDesign:
    """A mass on a curved slip surface.

    Raises
    ------
    DesignError
        With every fault found.
    """
    slope, node = reader.at("slope"), reader.at("slip")
    ground = _mesh(reader, slope, "profile")
    profile = _profile(reader, reader.at("slope.profile"))
    slip = _slip(reader, node, _mesh(reader, node, "shape"))
    strength = _strength(reader, "slip", node, None)
    water, at = read_water(reader, ["slip"])
    if water.mode == "full":
        message = "how full a curved surface is says no pressure"
        reader.fault("E119", message, at, "Write water: {pressures: 5 kPa}.")
    if water.mode == "pressures":
        if at is not None and len(at.elements) > 1:
            reader.fault("E109", f"{len(at.elements)} water pressures given, there is one slip surface", at)
        water = Water("pressures", 0.0, water.pressures_kpa[:1])
    common = read_common(reader)
    if profile is None and common["seismic"].coefficient and common["seismic"].trend_deg is None:
        message = "the seismic load has no direction, and a mesh of the ground does not say which way it falls"
        reader.fault("E122", message, reader.at("loads.seismic"), "Write seismic: {k: 0.1, toward: 90}.")
    return reader.made(
        SurfaceDesign, common, profile_m=profile, ground_mesh=ground, slip=slip, strength=strength, water=water
    )


def _mesh(reader: Reader, holder: Node | None, other: str) -> MeshFile | None:
    """The mesh of a slope or of a slip surface, in place of its `other` description; E112 both, E143 none."""
    if holder is None or not holder.is_mapping:
        return None
    node = holder.get("mesh")
    if node is None or node.text is None:
        if holder.get(other) is None:
            reader.fault("E143", f"{holder.path}.{other} is missing", holder, f"Add {other}: or mesh:.")
        return None
    if holder.get(other) is not None:
        reader.fault("E112", f"{holder.path} has mesh and {other}", node, "Give one of the two.")
    return mesh_file(reader, node)


def _profile(reader: Reader, node: Node | None) -> Points | None:
    if node is None or reader.value(node) is None:
        return None
    points: list[tuple[float, ...]] = []
    for k, item in enumerate(node.elements, 1):
        name = f"point {k} of the profile"
        found = reader.kept(_lengths, reader.value(item), name, str(item.place))
        if found is not None and found in points:
            advice = "Give each point once, from the toe to behind the crest."
            reader.fault("E109", f"{name} is the same as an earlier one", item, advice)
        elif found is not None:
            points.append(found)
    return tuple(points)


def _slip(reader: Reader, node: Node | None, mesh: MeshFile | None) -> Slip | None:
    """The slip surface; E170 an unknown shape, E171 what its size says."""
    if node is None or not node.is_mapping:
        return None
    own = fields_of(Slip)
    edge = reader.field(own["edge_m"], node.get("edge"))
    is_mesh = node.get("mesh") is not None
    shape = _word(node, "shape", "mesh" if is_mesh else "")
    normals = _word(node, "normals", "smoothed" if is_mesh else "true")
    allowed = ("smoothed", "facet") if is_mesh else ("true", "smoothed", "facet")
    if normals not in allowed:
        advice = "A mesh has no true normals." if is_mesh and normals == "true" else ""
        reader.fault("E170", f"normals are {normals}: they are {' or '.join(allowed)}", node.get("normals"), advice)
    made: Any = normals
    if is_mesh:
        for key in ("centre", "radii", "radius", "length", "edge"):
            if (said := node.get(key)) is not None:
                reader.fault("E170", f"slip.{key} says nothing beside a mesh", said)
        return Slip("mesh", mesh=mesh, edge_m=edge, normals=made)
    if shape not in _SIZES:
        if shape:
            advice = "Known: ellipsoid, sphere, cylinder; or mesh: slip.stl."
            reader.fault("E170", f"{shape} is not a shape of slip surface", node.get("shape"), advice)
        return None
    needs = _SIZES[shape]
    for key in ("radii", "radius", "length"):
        said = node.get(key)
        if said is not None and key not in needs:
            advice = f"Its size is {' and '.join(f'slip.{need}' for need in needs)}."
            reader.fault("E170", f"slip.{key} says nothing of the shape {shape}", said, advice)
        elif said is None and key in needs and key != "length":
            reader.fault("E143", f"slip.{key} is missing", node, f"Give slip.{key}.")
    centre = _centre(reader, node, shape)
    radii = _radii(reader, node, shape)
    if centre is None or radii is None:
        return None
    kind: Any = shape
    return Slip(kind, centre, radii, edge_m=edge, normals=made)


def _word(node: Node, key: str, otherwise: str) -> str:
    said = node.get(key)
    return otherwise if said is None or said.text is None else said.text.lower()


def _lengths(parts: Sequence[Any], name: str, where: str) -> tuple[float, ...]:
    return tuple(quantity(part, "length", name, where) for part in parts)


def _centre(reader: Reader, holder: Node, shape: str) -> tuple[float, float, float] | None:
    node = holder.get("centre")
    if node is None:
        reader.fault("E143", "slip.centre is missing", holder, "Give slip.centre.")
        return None
    given = () if reader.value(node) is None else node.elements
    parts = [reader.kept(quantity, reader.value(part), "length", "centre", str(part.place)) for part in given]
    sure = [part for part in parts if part is not None]
    if not sure or len(sure) < len(parts):
        return None
    if len(sure) == 2 and shape == "cylinder":
        return sure[0], 0.0, sure[1]
    if len(sure) != 3:
        reader.fault("E109", f"the centre of a {shape} is x, y, z", node)
        return None
    return sure[0], sure[1], sure[2]


def _radii(reader: Reader, holder: Node, shape: str) -> tuple[float, float, float] | None:
    own = fields_of(Slip)
    if shape == "ellipsoid":
        node = holder.get("radii")
        if node is None or reader.value(node) is None:
            return None
        parts = [reader.number(own["radii_m"], part) for part in node.elements]
        sure = [part for part in parts if part is not None]
        return (sure[0], sure[1], sure[2]) if len(sure) == 3 else None
    radius = reader.field(own["radius"], holder.get("radius"))
    half = radius if shape == "sphere" else reader.field(own["length"], holder.get("length"))
    if radius is None or half is None:
        return None
    return radius, half if shape == "sphere" else half / 2.0, radius
