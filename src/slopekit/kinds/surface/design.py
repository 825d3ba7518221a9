"""The design of a mass on a curved slip surface: its keys, and how it is read; all faults at once."""

from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar, Literal

from slopekit.core.orientation import coordinates
from slopekit.design.common import Design
from slopekit.design.fields import Field, declare, fields_of, group, number, text
from slopekit.design.ground_water import read_table
from slopekit.design.parts import MeshFile, Strength, axis_key
from slopekit.design.reading.named_files import mesh_file
from slopekit.design.reading.nodes import NOTHING, Node
from slopekit.design.reading.reader import Reader
from slopekit.design.reading.structure import VALUE, Spec
from slopekit.design.sections import read_common, read_strengths, read_water

Points = tuple[tuple[float, ...], ...]
#: What gives the size of each shape of slip surface.
_SIZES = {"ellipsoid": ("radii",), "sphere": ("radius",), "cylinder": ("radius", "length")}
_OPTIONAL = ("length", "edge")


@dataclass(frozen=True)
class Slip:
    """A slip surface: an ellipsoid (a sphere among them), a horizontal cylinder along y, or a mesh.

    Attributes
    ----------
    centre_m, radii_m : (3,) m; a cylinder's radii are (R, length / 2, R)
    edge_m : mean length wanted of the edges of its triangles, None for the default
    normals : true (analytic) or smoothed (mesh)
    """

    EXTRA_KEYS: ClassVar[tuple[Field, ...]] = (
        declare(
            "radius",
            "length",
            0.0,
            above=True,
            code="E116",
            axis="radius of the slip surface",
            left_out="required by sphere, cylinder",
            doc="of a sphere or a cylinder",
        ),
        declare(
            "length",
            "length",
            0.0,
            above=True,
            default=1.0,
            code="E116",
            label="length of the slip surface",
            doc="of a cylinder",
        ),
        axis_key("up"),
    )

    shape: Literal["ellipsoid", "sphere", "cylinder", "mesh"] = text(
        "shape",
        default="",
        words=("ellipsoid", "sphere", "cylinder"),
        code="E170",
        example="ellipsoid",
        left_out="mesh where there is one",
        doc="a cylinder lies level, along y",
    )
    centre_m: tuple[float, float, float] = number(
        "centre",
        "length",
        default=(0.0, 0.0, 0.0),
        many="list",
        at_least=2,
        at_most=3,
        scatters=False,
        example="[40, 0, 40]",
        left_out="required",
        doc="[x, y, z]; of a cylinder also [x, z]",
    )
    radii_m: tuple[float, float, float] = number(
        "radii",
        "length",
        default=(0.0, 0.0, 0.0),
        above=0.0,
        code="E116",
        many="list",
        at_least=3,
        at_most=3,
        scatters=False,
        example="[40, 28, 40]",
        label="radius",
        left_out="required by an ellipsoid",
        doc="of an ellipsoid",
    )
    mesh: MeshFile | None = text(
        "mesh",
        default=None,
        example="slip.stl",
        doc="instead of a shape: STL, OBJ, PLY, OFF, GLB, DXF, at most 400,000 triangles",
    )
    edge_m: float | None = number(
        "edge",
        "length",
        default=None,
        above=0.0,
        code="E116",
        scatters=False,
        role="setting",
        left_out="by the size",
        doc="mean length wanted of the edges of its triangles",
    )
    normals: Literal["true", "smoothed"] = text(
        "normals",
        default="true",
        words=("true", "smoothed"),
        code="E170",
        example="true",
        left_out="true; of a mesh smoothed",
        doc="of the surface itself, or of its mesh",
    )

    def in_words(self) -> str:
        """Return the surface as the sheet prints it."""
        if self.mesh is not None:
            return f"mesh {self.mesh.label}"
        centre_text = f"about {coordinates(self.centre_m)}"
        if self.shape == "ellipsoid":
            return "ellipsoid {:.6g} x {:.6g} x {:.6g} m ".format(*self.radii_m) + centre_text
        if self.shape == "sphere":
            return f"sphere of {self.radii_m[0]:.6g} m {centre_text}"
        return (
            f"cylinder of {self.radii_m[0]:.6g} m, {2 * self.radii_m[1]:.6g} m long, {centre_text}"
        )


@dataclass(frozen=True, kw_only=True)
class SurfaceDesign(Design):
    """A mass on a curved slip surface below a slope profile or within a closed mesh of the ground."""

    EXTRA_KEYS: ClassVar[tuple[Field, ...]] = (axis_key("slope.up"),)
    REQUIRED: ClassVar[tuple[str, ...]] = ("slope", "strength", "rock")
    ALONG = " (x)"

    profile_m: Points | None = text(
        "slope.profile",
        default=None,
        coordinates=2,
        left_out="one of the two",
        doc="[x, z] from one side to the other; level beyond its ends (W322)",
        forms=(Spec(items=Spec(items=VALUE, at_least=2, at_most=2), at_least=2),),
        example="[[60, 0], [40, 0], [0, 40], [-20, 40]]",
    )
    ground_mesh: MeshFile | None = text(
        "slope.mesh",
        default=None,
        example="slope.stl",
        left_out="one of the two",
        doc="a closed mesh file beside the design",
    )
    slip: Slip = group("slip", Slip, example="{shape: sphere, centre: [40, 0, 40], radius: 40}")
    strength: Strength

    @property
    def wet_interfaces(self) -> tuple[str, ...]:
        """The slip surface."""
        return ("slip",)


def along_x(profile: Points) -> Points:
    """Return a profile in the order of ascending x; the order of the points of a vertical part is kept."""
    return profile if profile[0][0] <= profile[-1][0] else profile[::-1]


def overhangs(profile: Points) -> bool:
    """Return whether the ground overhangs somewhere."""
    return any(following[0] < previous[0] for previous, following in pairwise(along_x(profile)))


def read_surface(reader: Reader) -> SurfaceDesign:
    """Read the design of a mass on a curved slip surface.

    Raises
    ------
    DesignError
        With every fault found.
    """
    slope, node = reader.find("slope"), reader.find("slip")
    ground = _mesh(reader, slope, "profile")
    profile = _profile(reader, reader.find("slope.profile"))
    slip = _slip(reader, node, _mesh(reader, node, "shape"))
    strength = read_strengths(reader, [("slip", NOTHING, node or reader.root)])[0]
    table = read_table(reader)
    has_depth = table is not None and table.table_depth_m is not None
    if has_depth and (profile is None or overhangs(profile)):
        ground_is = (
            "the ground is a mesh"
            if profile is None
            else "the profile overhangs: there are two over one x"
        )
        message = f"the water table lies below the ground, and {ground_is}"
        reader.fault("E454", message, reader.find("water.depth"), "Give its points or a plane.")
    water, water_node = (table, NOTHING) if table is not None else read_water(reader, ["slip"], 1)
    if water.mode == "full":
        message = "how full a curved surface is says no pressure"
        reader.fault("E118", message, water_node, "Write water: {pressures: 5 kPa}.")
    common = read_common(reader)
    if profile is None and common["seismic"].coefficient and common["seismic"].trend_deg is None:
        message = "the seismic load has no direction, and a mesh of the ground does not say which way it falls"
        reader.fault(
            "E122", message, reader.find("loads.seismic"), "Write seismic: {k: 0.1, toward: 90}."
        )
    return reader.build(
        SurfaceDesign,
        common,
        profile_m=profile,
        ground_mesh=ground,
        slip=slip,
        strength=strength,
        water=water,
    )


def _mesh(reader: Reader, holder: Node, alternative: str) -> MeshFile | None:
    """The mesh of a slope or of a slip surface, in place of its `alternative` description; E112 both, E143 none."""
    if not holder.is_mapping:
        return None
    node = holder.get("mesh")
    if node.text is None:
        if not holder.get(alternative):
            reader.fault(
                "E143",
                f"{holder.path}.{alternative} is missing",
                holder,
                f"Add {alternative}: or mesh:.",
            )
    elif holder.get(alternative):
        reader.fault(
            "E112", f"{holder.path} has mesh and {alternative}", node, "Give one of the two."
        )
    return mesh_file(reader, holder)


def _profile(reader: Reader, node: Node) -> Points | None:
    if not node or not reader.is_sound(node):
        return None
    points = reader.points(node, "the profile")
    for k, point in enumerate(points):
        if point in points[:k]:
            advice = "Give each point once, from the toe to behind the crest."
            message = f"point {k + 1} of the profile is the same as an earlier one"
            reader.fault("E109", message, node.elements[k], advice)
    return tuple(points)


def _slip(reader: Reader, node: Node, mesh: MeshFile | None) -> Slip | None:
    """Read the slip surface; E170 an unknown shape, E143 and E116 for its sizes."""
    if not node.is_mapping:
        return None
    is_mesh = bool(node.get("mesh"))
    values = reader.fields(Slip, node, only=("shape", "normals", "centre_m", "radii_m", "edge_m"))
    radius, length = (
        reader.field(fields_of(Slip)[key], node.get(key)) for key in ("radius", "length")
    )
    shape, normals = values["shape"], node.get("normals")
    if is_mesh and normals and values["normals"] == "true":
        reader.fault(
            "E170", "a mesh has no true normals", normals, "Leave normals out, or write smoothed."
        )
    if not is_mesh and not shape:
        return None
    sizes = [] if is_mesh else [f"slip.{size}" for size in _SIZES[shape]]
    needs = () if is_mesh else ("centre", "edge", *_SIZES[shape])
    shape_note = "beside a mesh" if is_mesh else f"of the shape {shape}"
    for key in ("centre", "radii", "radius", "length", "edge"):
        below = node.get(key)
        if below and key not in needs:
            advice = f"Its size is {' and '.join(sizes) or 'that of the mesh'}."
            reader.fault("E170", f"slip.{key} says nothing {shape_note}", below, advice)
        elif not below and key in needs and key not in _OPTIONAL:
            reader.fault("E143", f"slip.{key} is missing", node, f"Give slip.{key}.")
    if is_mesh:
        return Slip("mesh", mesh=mesh, edge_m=values["edge_m"], normals="smoothed")
    values["centre_m"] = _centre(reader, node, shape, values["centre_m"])
    if shape != "ellipsoid":
        values["radii_m"] = (radius, radius if shape == "sphere" else (length or 0.0) / 2.0, radius)
    return Slip(**values)


def _centre(
    reader: Reader, holder: Node, shape: str, centre: tuple[float, ...]
) -> tuple[float, ...]:
    """Return x, y, z of the centre, which a cylinder may give without y; E109."""
    node = holder.get("centre")
    if shape == "cylinder" and len(centre) == 2:
        return centre[0], 0.0, centre[1]
    if len(centre) == len(node.elements) == 2:
        reader.fault("E109", f"the centre of a {shape} is x, y, z", node)
    return centre
