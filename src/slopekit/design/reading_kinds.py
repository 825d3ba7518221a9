"""Checked designs of the kinds beside the wedge, from their flat inputs: all faults at once."""

from collections.abc import Mapping
from typing import Any

from slopekit.design import words
from slopekit.design.common import Stiffness, Water
from slopekit.design.kinds import FootingDesign, PlaneDesign, Slip, SurfaceDesign, VerticalCrack
from slopekit.design.reader import Reader, Spelling
from slopekit.errors import DesignError, Fault
from slopekit.orientation import Plane, number, parse_plane
from slopekit.units import quantity

_STRENGTH_KEYS = ("c", "phi", "dilation", "tension")
_MOST_PAIRS = 2001


def plane_design(given: Mapping[str, Any], spelling: Spelling) -> PlaneDesign:
    """Check and convert the inputs of a plane failure.

    Raises
    ------
    DesignError
        With every fault found.
    """
    keys = ("joint", "joint_name", "face", "upper", "height", "crack_depth", "crack_distance", "crack_water", "refine")
    reader = Reader(given, spelling, "plane", (*keys, *_STRENGTH_KEYS), {"upper": Plane(0.0, 180.0)})
    if "upper" not in reader.given and "face" in reader.given:
        reader.standard = {"upper": Plane(0.0, 0.0)}
    joint = reader.read("joint", lambda value, where: parse_plane(value, str(given.get("joint_name", "J1")), where))
    face, upper = reader.plane("face"), reader.plane("upper")
    height = reader.positive("height", "length", "E116")
    strength = reader.strength()
    crack = _crack(reader)
    if "crack_water" in reader.given and crack is None:
        reader.faults.append(Fault("E143", "crack.depth is missing", reader.where("crack_water", "")))
    water = reader.read("water", lambda value, where: words.water(value, where, False)) or Water()
    pressures = reader.given.get("water")
    if crack is None and isinstance(pressures, list) and len(pressures) > 1:
        message = f"{len(pressures)} water pressures given, there is one plane and no crack"
        reader.faults.append(Fault("E109", message, reader.where("water", "")))
    if water.mode == "pressures" and crack is None:
        water = Water("pressures", 0.0, water.pressures_kpa[:1])
    refine = reader.read("refine", reader.refine) or 0
    if "joint" not in reader.given:
        reader.default("joint")
    common = reader.common()
    if reader.faults or joint is None or face is None or upper is None or height is None or strength is None:
        raise DesignError(reader.faults)
    return PlaneDesign(
        joint=joint, joint_name=str(given.get("joint_name", "J1")), face=face, upper=upper, height_m=height,
        strength=strength, crack=crack, water=water, refine=refine, **common,
    )  # fmt: skip


def _crack(reader: Reader) -> VerticalCrack | None:
    if not {"crack_depth", "crack_distance"} & reader.given.keys():
        return None
    depth = reader.read("crack_depth", lambda value, where: words.above_zero(value, "length", "depth", "E121", where))
    distance = reader.read("crack_distance", lambda value, where: quantity(value, "length", "distance", where))
    water = reader.read("crack_water", lambda value, where: _from_zero(value, "water in the crack", where))
    return VerticalCrack(depth, distance, water)


def _from_zero(value: object, name: str, where: str) -> float:
    found = quantity(value, "length", name, where)
    if found < 0.0:
        raise DesignError([Fault("E119", f"{name} is {number(found)} m, it is never negative", where)])
    return found


def footing_design(given: Mapping[str, Any], spelling: Spelling) -> FootingDesign:
    """Check and convert the inputs of a footing on a weak plane.

    Raises
    ------
    DesignError
        With every fault found; E199 for a number of node pairs that the rule does not take.
    """
    keys = ("load", "load_at", "dip", "length", "pairs")
    reader = Reader(given, spelling, "footing", (*keys, *_STRENGTH_KEYS), {})
    load = reader.positive("load", "force", "E123")
    at = reader.read("load_at", lambda value, where: _from_zero(value, "place of the load", where))
    dip = reader.positive("dip", "angle", "E101")
    if dip is not None and not dip <= 89.9:
        message = f"dip of the weak plane is {number(dip)}, it lies between 0 and 89.9"
        reader.faults.append(Fault("E101", message, reader.where("dip", dip)))
    length = reader.positive("length", "length", "E116")
    pairs = reader.read("pairs", _pairs) or 9
    strength = reader.strength()
    weightless = "unit_weight" not in reader.given and "density" not in reader.given
    if weightless:
        reader.given["unit_weight"] = 25.0  # takes the reader through; the paper leaves the weight out
    common = reader.common()
    if weightless:
        common["unit_weight_kn_m3"] = 0.0
    if "shear_stiffness" not in reader.given:  # a seam with a modulus: G is a third of E for ν = 0.5, as the paper has
        normal = common["stiffness"].normal_kn_m3
        common["stiffness"] = Stiffness(normal, normal / 3.0)
    if reader.faults or load is None or dip is None or length is None or strength is None:
        raise DesignError(reader.faults)
    return FootingDesign(
        load_kn=load, load_at_m=at, dip_deg=dip, length_m=length, pairs=pairs, strength=strength, **common
    )


def _pairs(value: object, where: str) -> int:
    count = quantity(value, "ratio", "pairs", where)
    if count != int(count) or not 3 <= count <= _MOST_PAIRS or int(count) % 2 == 0:
        message = f"pairs is {number(count)}, it must be an odd number from 3 to {_MOST_PAIRS}"
        raise DesignError([Fault("E199", message, where, "Simpson's rule takes two pairs an element and one more.")])
    return int(count)


def surface_design(given: Mapping[str, Any], spelling: Spelling) -> SurfaceDesign:
    """Check and convert the inputs of a mass on a curved slip surface.

    Raises
    ------
    DesignError
        With every fault found.
    """
    keys = (
        "profile",
        "shape",
        "centre",
        "radii",
        "radius",
        "slip_length",
        "edge",
        "normals",
        "slip_mesh",
        "ground_mesh",
    )
    reader = Reader(given, spelling, "surface", (*keys, *_STRENGTH_KEYS), {})
    profile = reader.read("profile", lambda value, _: _profile(reader, value))
    slip = _slip(reader, given.get("slip_mesh"))
    strength = reader.strength()
    water = reader.read("water", lambda value, where: words.water(value, where, False)) or Water()
    if water.mode == "full":
        message = "how full a curved surface is says no pressure"
        advice = "Write water: {pressures: 5 kPa}."
        reader.faults.append(Fault("E119", message, reader.where("water", ""), advice))
    if water.mode == "pressures":
        given_pressures = reader.given["water"]
        if isinstance(given_pressures, list) and len(given_pressures) > 1:
            message = f"{len(given_pressures)} water pressures given, there is one slip surface"
            reader.faults.append(Fault("E109", message, reader.where("water", "")))
        water = Water("pressures", 0.0, water.pressures_kpa[:1])
    common = reader.common()
    if profile is None and common["seismic"].coefficient and common["seismic"].trend_deg is None:
        message = "the seismic load has no direction, and a mesh of the ground does not say which way it falls"
        reader.faults.append(
            Fault("E122", message, reader.where("seismic", ""), "Write seismic: {k: 0.1, toward: 90}.")
        )
    if reader.faults or strength is None or slip is None:
        raise DesignError(reader.faults)
    return SurfaceDesign(
        profile_m=profile, ground_mesh=given.get("ground_mesh"), slip=slip, strength=strength, water=water, **common
    )


def _profile(reader: Reader, value: Any) -> tuple[tuple[float, ...], ...]:
    points: list[tuple[float, ...]] = []
    faults: list[Fault] = []
    for k, item in enumerate(value):
        where, name = reader.where("profile", value, k), f"point {k + 1} of the profile"
        try:
            points.append(tuple(quantity(part, "length", name, where) for part in item))
        except DesignError as error:
            faults += error.faults
            continue
        if points[-1] in points[:-1]:
            advice = "Give each point once, from the toe to behind the crest."
            faults.append(Fault("E109", f"{name} is the same as an earlier one", where, advice))
    if faults:
        raise DesignError(faults)
    return tuple(points)


def _slip(reader: Reader, mesh: Any) -> Slip | None:
    """The slip surface; E170 an unknown shape, E171 what its size says."""
    edge = reader.read("edge", lambda value, where: words.above_zero(value, "length", "edge", "E171", where))
    shape = str(reader.given.get("shape", "mesh" if mesh else "")).lower()
    normals = str(reader.given.get("normals", "smoothed" if mesh else "true")).lower()
    allowed = ("smoothed", "facet") if mesh else ("true", "smoothed", "facet")
    if normals not in allowed:
        message = f"normals are {normals}: they are {' or '.join(allowed)}"
        advice = "A mesh has no true normals." if mesh and normals == "true" else ""
        reader.faults.append(Fault("E170", message, reader.where("normals", normals), advice))
    made: Any = normals
    if mesh:
        for key in ("centre", "radii", "radius", "slip_length", "edge"):
            if key in reader.given:
                message = f"{reader.spelling.key(key)} says nothing beside a mesh"
                reader.faults.append(Fault("E170", message, reader.where(key, "")))
        return Slip("mesh", mesh=mesh, edge_m=edge, normals=made)
    if shape not in ("ellipsoid", "sphere", "cylinder"):
        if shape:
            advice = "Known: ellipsoid, sphere, cylinder; or mesh: slip.stl."
            reader.faults.append(
                Fault("E170", f"{shape} is not a shape of slip surface", reader.where("shape", shape), advice)
            )
        return None
    centre = reader.read("centre", lambda value, where: _centre(reader, value, shape, where))
    if "centre" not in reader.given:
        reader.default("centre")
    needs = {"ellipsoid": ("radii",), "sphere": ("radius",), "cylinder": ("radius", "slip_length")}[shape]
    for key in ("radii", "radius", "slip_length"):
        if key in reader.given and key not in needs:
            advice = f"Its size is {' and '.join(reader.spelling.key(need) for need in needs)}."
            message = f"{reader.spelling.key(key)} says nothing of the shape {shape}"
            reader.faults.append(Fault("E170", message, reader.where(key, ""), advice))
    radii = reader.read("radii", lambda value, where: _radii(reader, value, where)) if shape == "ellipsoid" else None
    if shape == "ellipsoid" and "radii" not in reader.given:
        reader.default("radii")
    if shape != "ellipsoid":
        radius = reader.positive("radius", "length", "E171")
        half = radius
        if shape == "cylinder":
            length = reader.positive("slip_length", "length", "E171", default=1.0)
            half = None if length is None else length / 2.0
        radii = None if radius is None or half is None else (radius, half, radius)
    if centre is None or radii is None:
        return None
    return Slip(_named(shape), centre, radii, edge_m=edge, normals=made)


def _named(shape: str) -> Any:
    return shape


def _centre(reader: Reader, value: Any, shape: str, where: str) -> tuple[float, float, float]:
    parts = [quantity(part, "length", "centre", reader.where("centre", value, k)) for k, part in enumerate(value)]
    if len(parts) == 2 and shape == "cylinder":
        return parts[0], 0.0, parts[1]
    if len(parts) != 3:
        raise DesignError([Fault("E109", f"the centre of a {shape} is x, y, z", where)])
    return parts[0], parts[1], parts[2]


def _radii(reader: Reader, value: Any, where: str) -> tuple[float, float, float]:
    at = [reader.where("radii", value, k) for k in range(len(value))]
    parts = [words.above_zero(part, "length", "radius", "E171", at[k]) for k, part in enumerate(value)]
    if len(parts) != 3:
        raise DesignError([Fault("E109", "an ellipsoid has three radii, along x, y and z", where)])
    return parts[0], parts[1], parts[2]
