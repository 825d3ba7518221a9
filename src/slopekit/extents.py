"""The size and shape of the analysed blocks, by kind, and their JSON, whose keys never change."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar, Protocol

import numpy as np

from slopekit.block_scene import Shapes, Sizes, Solids, closed, contacts_of, prism
from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.core.codec import NO_JSON


class Geometry(Protocol):
    """The size and shape of the analysed blocks."""

    @property
    def volume_m3(self) -> float:
        """The volume of the moving blocks, m³."""
        ...

    @property
    def total_height_m(self) -> float:
        """The height from the lowest to the highest point, m."""
        ...

    @property
    def areas_m2(self) -> Mapping[str, float]:
        """The area of each interface by name, m²."""
        ...

    def shapes(self, block: str) -> Shapes:
        """Return the blocks and interfaces to be drawn; `block` is the name of a single block."""
        ...


class _Sized:
    """The `sizes` of a geometry as attributes, for JSON."""

    __slots__ = ()
    sizes: Sizes | None

    @property
    def height_m(self) -> float | None:
        """The height from the lowest to the highest corner, m; None where it was not measured."""
        return None if self.sizes is None else self.sizes.height_m

    @property
    def face_width_m(self) -> float | None:
        """The width along the crest, m."""
        return None if self.sizes is None else self.sizes.face_width_m

    @property
    def setback_m(self) -> float | None:
        """The largest distance behind the crest, m."""
        return None if self.sizes is None else self.sizes.setback_m

    @property
    def trace_lengths_m(self) -> Mapping[str, Mapping[str, float]]:
        """The trace lengths by joint and surface, m."""
        return {} if self.sizes is None else self.sizes.trace_lengths_m


_SIZES = ("height_m", "face_width_m", "setback_m", "trace_lengths_m")


@dataclass(frozen=True)
class WedgeGeometry(_Sized):
    """Size and shape of the wedge: areas in m² by joint, the line of intersection as trend and plunge.

    `faces_m` are all faces as (k, 3) polygons by name, anticlockwise seen from outside; `scaled` is what limits of size
    made of it: the `factor` of its lengths, and `by` which of them, None where it is 1.
    """

    volume_m3: float
    total_height_m: float
    areas_m2: Mapping[str, float]
    line_trend_deg: float = field(metadata=NO_JSON)
    line_plunge_deg: float = field(metadata=NO_JSON)
    line_length_m: float
    corners_m: Mapping[str, Floats]
    centroid_m: Floats
    faces_m: Mapping[str, Floats] = field(repr=False, metadata=NO_JSON)
    sizes: Sizes | None = field(default=None, metadata=NO_JSON)
    scaled: Mapping[str, float | str | None] | None = None
    JSON_ALSO: ClassVar = ("line", *_SIZES)

    @property
    def line(self) -> dict[str, float]:
        """The line of intersection as trend and plunge."""
        return {"trend_deg": self.line_trend_deg, "plunge_deg": self.line_plunge_deg}

    def shapes(self, block: str) -> Shapes:
        """Return the wedge with its faces by name; its joints are the interfaces."""
        names = tuple(self.faces_m)
        vertices, triangles, face = closed(list(self.faces_m.values()))
        joints = tuple(name for name in self.areas_m2 if name in self.faces_m)
        return _single_block_shapes(
            block,
            self.centroid_m,
            vertices,
            triangles,
            face,
            names,
            joints,
            [self.faces_m[joint] for joint in joints],
        )


@dataclass(frozen=True)
class SectionGeometry(_Sized):
    """A block in a vertical section one metre thick: its outline (k, 2) as x (out of the slope) and z, toe at 0, 0.

    `axes` (3, 3) are x, y, z of the section in the user's axes, one a row. The outline runs anticlockwise from the toe,
    so that its last edge lies on the plane, and the one before it on the crack where there is one.
    """

    volume_m3: float
    total_height_m: float
    areas_m2: Mapping[str, float]
    outline_m: Floats
    centroid_m: Floats
    crack_depth_m: float | None = field(default=None, metadata=NO_JSON)
    crack_distance_m: float | None = field(default=None, metadata=NO_JSON)
    axes: Floats = field(default_factory=lambda: np.eye(3), repr=False, metadata=NO_JSON)
    sizes: Sizes | None = field(default=None, metadata=NO_JSON)
    thickness_m: ClassVar = 1.0
    JSON_ALSO: ClassVar = ("thickness_m", "crack", *_SIZES)

    @property
    def crack(self) -> dict[str, float | None] | None:
        """The tension crack, None without one."""
        return (
            None
            if self.crack_depth_m is None
            else {
                "depth_m": self.crack_depth_m,
                "distance_m": self.crack_distance_m,
            }
        )

    def shapes(self, block: str) -> Shapes:
        """Return the block as one metre of the slope."""
        vertices, triangles = prism(self.outline_m, 1.0)
        ends = np.concatenate([self.outline_m, self.outline_m[:1]])
        polygons = []
        for k, _ in enumerate(self.areas_m2, 2):  # from the last edge back
            (a, c), (b, d) = ends[-k], ends[-k + 1]
            polygons.append(
                np.array([[a, -0.5, c], [a, 0.5, c], [b, 0.5, d], [b, -0.5, d]]) @ self.axes
            )
        centroid = np.array([self.centroid_m[0], 0.0, self.centroid_m[1]]) @ self.axes
        face = np.full(len(triangles), -1)
        return _single_block_shapes(
            block,
            centroid,
            vertices @ self.axes,
            triangles,
            face,
            (),
            tuple(self.areas_m2),
            polygons,
        )


@dataclass(frozen=True)
class SurfaceGeometry:
    """A mass on a curved slip surface: triangles of its whole boundary, and the kind of its normals."""

    volume_m3: float
    total_height_m: float
    areas_m2: Mapping[str, float]
    centroid_m: Floats
    edge_m: float
    normals: str
    motions: int = field(metadata={"json": "slip_motions"})
    misfit_deg: float = field(metadata={"json": "normals_turned_deg"})
    pieces_m3: tuple[float, ...] = field(metadata={"json": "other_pieces_m3"})
    vertices_m: Floats = field(repr=False, metadata=NO_JSON)
    triangles: Ints = field(repr=False, metadata=NO_JSON)
    on_slip: Bools = field(repr=False, metadata=NO_JSON)

    def shapes(self, block: str) -> Shapes:
        """Return the mass; every triangle of the slip surface is a piece of its interface."""
        face = np.where(self.on_slip, 0, 1)
        slip = self.vertices_m[self.triangles[self.on_slip]]
        joints = tuple(self.areas_m2)
        return _single_block_shapes(
            block,
            self.centroid_m,
            self.vertices_m,
            self.triangles,
            face,
            (*joints, "ground"),
            joints,
            list(slip),
        )


def _single_block_shapes(
    name: str,
    centroid: Floats,
    vertices: Floats,
    triangles: Ints,
    face: Ints,
    faces: tuple[str, ...],
    joints: tuple[str, ...],
    polygons: list[Floats],
) -> Shapes:
    """Return the shapes of one block; `polygons` are its interfaces, one for each joint or all of the first joint."""
    joint_index = range(len(polygons)) if len(polygons) == len(joints) else [0] * len(polygons)
    return Shapes(
        (name,),
        np.zeros(1, dtype=bool),
        centroid[None, :],
        joints,
        Solids(vertices, triangles, np.zeros(len(triangles), dtype=np.int64), face, faces),
        contacts_of(polygons, joint_index),
    )
