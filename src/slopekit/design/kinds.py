"""Designs of one block beside the wedge: plane failure, the footing on a weak plane, curved slip surfaces."""

import math
from dataclasses import dataclass
from typing import Literal

from slopekit.design.common import Design, MeshFile, Strength
from slopekit.orientation import Plane

Points = tuple[tuple[float, ...], ...]


@dataclass(frozen=True, slots=True)
class VerticalCrack:
    """A vertical tension crack of a plane failure: depth or distance behind the crest, and the water in it; m."""

    depth_m: float | None = None
    distance_m: float | None = None
    water_m: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class PlaneDesign(Design):
    """Plane failure per metre of slope (Hoek & Bray; Wyllie & Mah): one joint, maybe a vertical tension crack."""

    joint: Plane
    joint_name: str
    face: Plane
    upper: Plane
    height_m: float
    strength: Strength
    crack: VerticalCrack | None = None
    refine: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class FootingDesign(Design):
    """A footing above a weak plane that daylights in a vertical face (Sheng et al. 2023, §3.3), per metre.

    `load_at_m` is the distance of the load from the face, None for the middle of the top. A unit weight of 0 leaves
    the weight of the rock out, as the paper does.
    """

    load_kn: float
    load_at_m: float | None
    dip_deg: float
    length_m: float
    pairs: int
    strength: Strength

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

    shape: Literal["ellipsoid", "sphere", "cylinder", "mesh"]
    centre_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    radii_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    mesh: MeshFile | None = None
    edge_m: float | None = None
    normals: Literal["true", "smoothed", "facet"] = "true"

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

    profile_m: Points | None
    ground_mesh: MeshFile | None
    slip: Slip
    strength: Strength
