"""Designs of one block beside the wedge: plane failure, the footing on a weak plane, curved slip surfaces."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Literal

from slopekit.design.common import Design, MeshFile, Strength
from slopekit.design.fields import Field, count, group, number, orientation, text
from slopekit.design.structure import Leaf, ListOf
from slopekit.design.wedge import JOINTS
from slopekit.orientation import Plane

Points = tuple[tuple[float, ...], ...]


@dataclass(frozen=True, slots=True)
class VerticalCrack:
    """A vertical tension crack of a plane failure: depth or distance behind the crest, and the water in it; m."""

    depth_m: float | None = number("depth", "length", default=None, above=0.0, code="E121", example="4.35 m",
                                   left_out="by the distance")  # fmt: skip
    distance_m: float | None = number("distance", "length", default=None, axis="distance of the crack",
                                      left_out="by the depth",
                                      doc="behind the crest; below 0 in the face; both where they agree")  # fmt: skip
    water_m: float | None = number(
        "water", "length", default=None, least=0.0, code="E119", label="water in the crack",
        doc="depth of it (`dry`, `full`); triangular there, falling to nothing at the toe",
    )  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class PlaneDesign(Design):
    """Plane failure per metre of slope (Hoek & Bray; Wyllie & Mah): one joint, maybe a vertical tension crack."""

    ALSO: ClassVar[tuple[Field, ...]] = (JOINTS,)
    INTO: ClassVar[Mapping[str, str]] = {"joints": "joint"}
    FILLS: ClassVar[bool] = True

    joint: Plane
    joint_name: str
    face: Plane = orientation("slope.face", axis="the face", example="60/180")
    upper: Plane = orientation("slope.upper", axis="the upper slope", default=None, example="0/180", left_out="level")
    height_m: float = number("slope.height", "length", above=0.0, code="E116", example="12 m")
    strength: Strength
    crack: VerticalCrack | None = group("crack", VerticalCrack, default=None, left_out="no crack")
    refine: int = count(
        "analysis.refine", 0, 6, default=0, code="E131", advice="Each step makes four triangles of one.",
    )  # fmt: skip

    @property
    def wet_interfaces(self) -> tuple[str, ...]:
        """The joint, and the crack where there is one."""
        return (self.joint_name, "crack") if self.crack is not None else (self.joint_name,)


@dataclass(frozen=True, slots=True, kw_only=True)
class FootingDesign(Design):
    """A footing above a weak plane that daylights in a vertical face (Sheng et al. 2023, §3.3), per metre.

    `load_at_m` is the distance of the load from the face, None for the middle of the top. A unit weight of 0 leaves
    the weight of the rock out, as the paper does.
    """

    ALSO: ClassVar[tuple[Field, ...]] = (
        Field("weak_plane.strength", "text", left_out="the only one", doc="a name under strength"),
    )
    REQUIRED: ClassVar[tuple[str, ...]] = ("strength",)
    WITHOUT: ClassVar[tuple[str, ...]] = ("water", "loads", "support")

    load_kn: float = number("footing.load", "force", above=0.0, code="E123", example="1500 kN", doc="downward")
    load_at_m: float | None = number(
        "footing.at", "length", default=None, least=0.0, code="E119", words=("middle",), example="middle",
        label="place of the load", taken="at_m", left_out="middle",
        doc="from the face; `middle`: over the middle of the plane",
    )  # fmt: skip
    dip_deg: float = number(
        "weak_plane.dip", "angle", above=0.0, most=89.9, code="E101", example="45", label="dip of the weak plane"
    )
    length_m: float = number("weak_plane.length", "length", above=0.0, code="E116", example="7.07 m")
    pairs: int = count(
        "weak_plane.pairs", 3, 2001, default=9, is_odd=True, code="E199",
        advice="Simpson's rule takes two pairs an element and one more.",
    )  # fmt: skip
    strength: Strength

    @property
    def at_m(self) -> float:
        """The distance of the load from the face."""
        middle = self.length_m * math.cos(math.radians(self.dip_deg)) / 2.0
        return middle if self.load_at_m is None else self.load_at_m

    @property
    def eccentricity_m(self) -> float:
        """How far the load passes the middle of the plane, away from the face."""
        middle = self.length_m * math.cos(math.radians(self.dip_deg)) / 2.0
        return 0.0 if self.load_at_m is None else self.load_at_m - middle


@dataclass(frozen=True, slots=True)
class Slip:
    """A slip surface: an ellipsoid (a sphere among them), a horizontal cylinder along y, or a mesh.

    Attributes
    ----------
    centre_m, radii_m : (3,) m; a cylinder's radii are (R, length / 2, R)
    edge_m : mean length wanted of the edges of its triangles, None for the default
    normals : true (analytic), smoothed (mesh) or facet
    """

    ALSO: ClassVar[tuple[Field, ...]] = (
        Field(
            "radius",
            "length",
            0.0,
            above=True,
            code="E171",
            axis="radius of the slip surface",
            left_out="required by sphere, cylinder",
            doc="of a sphere or a cylinder",
        ),
        Field(
            "length",
            "length",
            0.0,
            above=True,
            default=1.0,
            code="E171",
            label="length of the slip surface",
            doc="of a cylinder",
        ),
    )

    shape: Literal["ellipsoid", "sphere", "cylinder", "mesh"] = text(
        "shape",
        default="",
        example="ellipsoid",
        left_out="mesh where there is one",
        doc="`ellipsoid`, `sphere`, `cylinder` (level, along y)",
    )
    centre_m: tuple[float, float, float] = number(
        "centre", "length", default=(0.0, 0.0, 0.0), many="list", at_least=2, at_most=3, scatters=False,
        example="[40, 0, 40]", left_out="required", doc="[x, y, z]; of a cylinder also [x, z]",
    )  # fmt: skip
    radii_m: tuple[float, float, float] = number(
        "radii", "length", default=(0.0, 0.0, 0.0), above=0.0, code="E171", many="list", at_least=3, at_most=3,
        scatters=False, example="[40, 28, 40]", label="radius", left_out="required by an ellipsoid",
        doc="of an ellipsoid",
    )  # fmt: skip
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
        code="E171",
        scatters=False,
        role="setting",
        left_out="by the size",
        doc="mean length wanted of the edges of its triangles",
    )
    normals: Literal["true", "smoothed", "facet"] = text(
        "normals",
        default="true",
        example="true",
        left_out="true; of a mesh smoothed",
        doc="`true`, `smoothed`, `facet`",
    )

    def in_words(self) -> str:
        """The surface as the sheet prints it."""
        if self.mesh is not None:
            return f"mesh {self.mesh.name}"
        x, y, z = self.centre_m
        at = f"about ({x:.6g}, {y:.6g}, {z:.6g})"
        if self.shape == "ellipsoid":
            return "ellipsoid {:.6g} x {:.6g} x {:.6g} m ".format(*self.radii_m) + at
        if self.shape == "sphere":
            return f"sphere of {self.radii_m[0]:.6g} m {at}"
        return f"cylinder of {self.radii_m[0]:.6g} m, {2 * self.radii_m[1]:.6g} m long, {at}"


@dataclass(frozen=True, slots=True, kw_only=True)
class SurfaceDesign(Design):
    """A mass on a curved slip surface below a slope profile or within a closed mesh of the ground."""

    REQUIRED: ClassVar[tuple[str, ...]] = ("slope", "strength", "rock")

    profile_m: Points | None = text(
        "slope.profile", default=None, coordinates=2, left_out="one of the two",
        doc="[x, z] from one side to the other; level beyond its ends (W331)",
        forms=(ListOf(ListOf(Leaf(), 2, 2), 2, example="[[60, 0], [40, 0], [0, 40], [-20, 40]]"),),
        example="[[60, 0], [40, 0], [0, 40], [-20, 40]]",
    )  # fmt: skip
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
