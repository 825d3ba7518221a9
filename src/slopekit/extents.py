"""The size and shape of what was analysed, by kind, and their JSON (a contract: keys never change)."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from slopekit.arrays import Bools, Floats, Ints


class Geometry(Protocol):
    """The size and shape of what was analysed."""

    @property
    def volume_m3(self) -> float:
        """Volume of the moving block."""
        ...

    @property
    def areas_m2(self) -> Mapping[str, float]:
        """Area of each interface."""
        ...

    def to_dict(self) -> dict[str, Any]:
        """The geometry as JSON values."""
        ...


@dataclass(frozen=True, slots=True)
class WedgeGeometry:
    """Size and shape of the wedge: areas in m² by joint, the line of intersection as trend and plunge.

    `faces_m` are all faces as (k, 3) polygons by name, anticlockwise seen from outside.
    """

    volume_m3: float
    total_height_m: float
    areas_m2: Mapping[str, float]
    line_trend_deg: float
    line_plunge_deg: float
    line_length_m: float
    corners_m: Mapping[str, Floats]
    centroid_m: Floats
    faces_m: Mapping[str, Floats] = field(repr=False)

    def to_dict(self) -> dict[str, Any]:
        """The geometry as JSON values."""
        return {
            "volume_m3": self.volume_m3,
            "total_height_m": self.total_height_m,
            "areas_m2": dict(self.areas_m2),
            "line": {"trend_deg": self.line_trend_deg, "plunge_deg": self.line_plunge_deg},
            "line_length_m": self.line_length_m,
            "corners_m": {name: point.tolist() for name, point in self.corners_m.items()},
            "centroid_m": self.centroid_m.tolist(),
        }


@dataclass(frozen=True, slots=True)
class SectionGeometry:
    """A block in a vertical section one metre thick: its outline (k, 2) as x (out of the slope) and z, toe at 0, 0."""

    volume_m3: float
    total_height_m: float
    areas_m2: Mapping[str, float]
    outline_m: Floats
    centroid_m: Floats
    crack_depth_m: float | None = None
    crack_distance_m: float | None = None

    def to_dict(self) -> dict[str, Any]:
        """The geometry as JSON values."""
        return {
            "volume_m3": self.volume_m3,
            "total_height_m": self.total_height_m,
            "areas_m2": dict(self.areas_m2),
            "thickness_m": 1.0,
            "outline_m": self.outline_m.tolist(),
            "centroid_m": self.centroid_m.tolist(),
            "crack": None if self.crack_depth_m is None else {
                "depth_m": self.crack_depth_m, "distance_m": self.crack_distance_m,
            },
        }  # fmt: skip


@dataclass(frozen=True, slots=True)
class SurfaceGeometry:
    """A mass on a curved slip surface: triangles of its whole boundary, and how its normals were taken."""

    volume_m3: float
    total_height_m: float
    areas_m2: Mapping[str, float]
    centroid_m: Floats
    edge_m: float
    normals: str
    motions: int
    misfit_deg: float
    pieces_m3: tuple[float, ...]
    vertices_m: Floats = field(repr=False)
    triangles: Ints = field(repr=False)
    on_slip: Bools = field(repr=False)

    def to_dict(self) -> dict[str, Any]:
        """The geometry as JSON values."""
        return {
            "volume_m3": self.volume_m3,
            "total_height_m": self.total_height_m,
            "areas_m2": dict(self.areas_m2),
            "centroid_m": self.centroid_m.tolist(),
            "edge_m": self.edge_m,
            "normals": self.normals,
            "slip_motions": self.motions,
            "normals_turned_deg": self.misfit_deg,
            "other_pieces_m3": list(self.pieces_m3),
        }
