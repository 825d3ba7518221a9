"""Slip surfaces as shapes: triangulated to cut the ground with, and lifted back from the triangles to the true surface.

All coordinates are local: about the centre of an analytic shape, about the middle of the mesh of a drawn one.
"""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from slopekit.core.arrays import Floats, Ints
from slopekit.core.errors import Fault, GeometryError
from slopekit.geometry.tolerances import ON_EDGE, TINY, UPRIGHT

SLIP, GROUND, END = 0, 1, 2  # kinds of faces of the sliding mass
_LEVELS = 7
_END_MARGIN = 0.01  # of the width


@dataclass(frozen=True)
class Cutter:
    """A closed triangulated body to cut with.

    Attributes
    ----------
    vertices : (n, 3) m; triangles : (m, 3), outward; face_kinds : (m,) SLIP or END
    """

    vertices: Floats
    triangles: Ints
    face_kinds: Ints


@dataclass(frozen=True)
class Lifted:
    """Points of flat triangles moved to the surface.

    Attributes
    ----------
    points, normals : (n, 3) on the surface, unit normals out of the sliding mass
    areas : (n,) m² of the surface; volumes, moments : (n,) m³ and (n, 3) m⁴ of the shell between triangle and surface
    """

    points: Floats
    normals: Floats
    areas: Floats
    volumes: Floats
    moments: Floats


@dataclass(frozen=True)
class Ellipsoid:
    """An ellipsoid about the origin with its axes along x, y and z; a sphere where they are equal. Radii (3,) m."""

    radii: Floats

    @property
    def metric(self) -> Floats:
        """The metric 1/r² (3,) of the surface Σ m x² = 1, 1/m²."""
        return 1.0 / (self.radii * self.radii)

    def cutter(self, level: int) -> Cutter:
        """Return a triangulated ellipsoid: an octahedron with edges split in 3/2 · 2^level, vertices on the surface."""
        from manifold3d import Manifold

        mesh = Manifold.sphere(1.0, 6 * 2 ** min(level, _LEVELS)).to_mesh64()
        vertices = np.asarray(mesh.vert_properties, dtype=np.float64)[:, :3]
        vertices = vertices / np.sqrt((vertices * vertices).sum(axis=1))[:, None]
        triangles = np.asarray(mesh.tri_verts, dtype=np.int64)
        return Cutter(vertices * self.radii, triangles, np.full(len(triangles), SLIP))

    def lift(self, points: Floats, vector_areas: Floats) -> Lifted:
        """Lift points (n, 3) of flat triangles along rays from the centre to the ellipsoid.

        On the unit sphere u = x / r the solid angle of a flat piece is dω = u·dA' / |u|³; the ellipsoid's area there
        is abc |u / r| dω, the sector's volume abc dω / 3, and its centroid lies at 3/4 of the ray.
        """
        product = float(self.radii.prod())
        flat = points / self.radii
        length = np.sqrt((flat * flat).sum(axis=1))
        unit = flat / length[:, None]
        angle = np.einsum("ni,ni->n", flat, vector_areas * self.radii) / (product * length**3)
        gradient = unit / self.radii
        steep = np.sqrt((gradient * gradient).sum(axis=1))
        sector, flat_sector = (
            product * angle / 3.0,
            np.einsum("ni,ni->n", points, vector_areas) / 3.0,
        )
        lifted = unit * self.radii
        moments = 0.75 * (sector[:, None] * lifted - flat_sector[:, None] * points)
        return Lifted(
            lifted,
            gradient / steep[:, None],
            product * steep * angle,
            sector - flat_sector,
            moments,
        )


@dataclass(frozen=True)
class Cylinder:
    """A horizontal circular cylinder about the y axis through the origin, cut off square at both ends; m."""

    radius: float
    length: float

    @property
    def metric(self) -> Floats:
        """The metric (3,) of the surface Σ m x² = 1: 1/R² in x and z, 0 along the axis, 1/m²."""
        return np.array([1.0, 0.0, 1.0]) / self.radius**2

    def cutter(self, level: int) -> Cutter:
        """Return a prism of 10 · 2^level sides, its rows of triangles about as long as they are wide."""
        sides = 10 * 2**level
        rows = max(1, min(sides, round(self.length / (2.0 * np.pi * self.radius / sides))))
        angle = 2.0 * np.pi * np.arange(sides) / sides
        ring = self.radius * np.stack([np.cos(angle), np.zeros(sides), np.sin(angle)], axis=1)
        positions = np.linspace(-0.5, 0.5, rows + 1) * self.length
        vertices = (ring[None] + np.array([0.0, 1.0, 0.0]) * positions[:, None, None]).reshape(
            -1, 3
        )
        k, row = np.meshgrid(np.arange(sides), np.arange(rows) * sides)
        a, b = (row + k).ravel(), (row + (k + 1) % sides).ravel()
        side = np.concatenate(
            [np.stack([a, a + sides, b], axis=1), np.stack([b, a + sides, b + sides], axis=1)]
        )
        fan = np.stack(
            [np.zeros(sides - 2, dtype=np.int64), np.arange(1, sides - 1), np.arange(2, sides)],
            axis=1,
        )
        ends = np.concatenate([fan, fan[:, ::-1] + rows * sides])
        face_kinds = np.repeat([SLIP, END], [len(side), len(ends)])
        return Cutter(vertices, np.concatenate([side, ends]), face_kinds)

    def lift(self, points: Floats, vector_areas: Floats) -> Lifted:
        """Lift points (n, 3) of flat triangles radially to the cylinder; a sector has the volume R²/2 dθ dy."""
        flat = points * [1.0, 0.0, 1.0]
        length = np.sqrt((flat * flat).sum(axis=1))
        normals = flat / length[:, None]
        outward = np.einsum("ni,ni->n", flat, vector_areas)
        angle = outward / length**2
        along = points * [0.0, 1.0, 0.0]
        sector, flat_sector = 0.5 * self.radius**2 * angle, 0.5 * outward
        moments = sector[:, None] * (2.0 / 3.0 * self.radius * normals + along)
        moments -= flat_sector[:, None] * (2.0 / 3.0 * flat + along)
        return Lifted(
            self.radius * normals + along,
            normals,
            self.radius * angle,
            sector - flat_sector,
            moments,
        )


#: Shapes that know their surface: Σ m x² = 1 about their centre, m their `metric`.
AnalyticShape: TypeAlias = Ellipsoid | Cylinder


def profile_prism(
    profile: Floats, lowest: float, half_width: float, reach: tuple[float, float]
) -> Cutter:
    """Return the ground below a profile as a prism along y; beyond its ends the profile continues horizontally.

    Parameters
    ----------
    profile : (k, 2) x, z of the ground surface, from either side to the other
    lowest : z of the bottom; half_width : of the prism; reach : x of its two ends at least

    Raises
    ------
    GeometryError
        E218 the profile crosses itself or runs below its own bottom.
    """
    from manifold3d import triangulate

    line = profile if profile[0, 0] <= profile[-1, 0] else profile[::-1]
    leftmost, rightmost = (
        min(reach[0], float(line[:, 0].min())),
        max(reach[1], float(line[:, 0].max())),
    )
    if leftmost == line[0, 0]:  # room for a step at the end
        leftmost -= _END_MARGIN * (rightmost - leftmost)
    if rightmost == line[-1, 0]:
        rightmost += _END_MARGIN * (rightmost - leftmost)
    outline = np.array(
        [
            [leftmost, lowest],
            [rightmost, lowest],
            [rightmost, line[-1, 1]],
            *line[::-1],
            [leftmost, line[0, 1]],
        ]
    )
    if _crosses_itself(outline):
        message = "the slope profile crosses or touches itself"
        raise GeometryError(
            [Fault("E218", message, "", "List its points in order, from one side to the other.")]
        )
    triangles = np.asarray(triangulate([outline]), dtype=np.int64)
    count = len(outline)
    front = np.stack([outline[:, 0], np.full(count, -half_width), outline[:, 1]], axis=1)
    k = np.arange(count)
    following = (k + 1) % count
    sides = np.concatenate(
        [
            np.stack([k, following, k + count], axis=1),
            np.stack([following, following + count, k + count], axis=1),
        ]
    )
    faces = np.concatenate([triangles, triangles[:, ::-1] + count, sides[:, [0, 2, 1]]])
    vertices = np.concatenate([front, front + np.array([0.0, 2.0 * half_width, 0.0])])
    return Cutter(vertices, faces, np.full(len(faces), GROUND))


def _crosses_itself(outline: Floats) -> bool:
    """Return whether edges of a closed outline cross, or a corner lies on an edge that does not end in it."""
    a, b = outline, np.roll(outline, -1, axis=0)

    def side(p: Floats, q: Floats, r: Floats) -> Floats:
        return (q[..., 0] - p[..., 0]) * (r[..., 1] - p[..., 1]) - (q[..., 1] - p[..., 1]) * (
            r[..., 0] - p[..., 0]
        )

    first, last = a[:, None], b[:, None]
    is_separated = side(first, last, a[None]) * side(first, last, b[None]) < 0.0
    along = (b - a)[:, None]
    to_corner = a[None] - first
    fraction = np.clip((to_corner * along).sum(axis=2) / (along * along).sum(axis=2), 0.0, 1.0)
    offset = to_corner - fraction[:, :, None] * along
    touching = (offset * offset).sum(axis=2) <= (
        ON_EDGE * float(np.ptp(outline, axis=0).max())
    ) ** 2
    count = np.arange(len(a))
    touching[count, count] = touching[count, (count + 1) % len(a)] = False
    return bool((is_separated & is_separated.T).any() or touching.any())


def sheet_solid(vertices: Floats, triangles: Ints, top: float) -> Cutter:
    """Return the closed body above an open sheet, with upright walls and a level top.

    Raises
    ------
    GeometryError
        E216 the sheet stands upright or folds over itself.
    """
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    rises = normal[:, 2] / np.maximum(np.sqrt((normal * normal).sum(axis=1)), TINY)
    if rises.mean() > 0.0:  # out of the body above it is down
        triangles, rises = triangles[:, ::-1], -rises
    if (rises > -UPRIGHT).any():
        message = (
            f"{int((rises > -UPRIGHT).sum())} facets of the slip surface stand upright or fold over"
        )
        advice = "A sheet must lie over its plan once. A mesh that should be closed has holes: close them."
        raise GeometryError([Fault("E216", message, "", advice)])
    count = len(vertices)
    lid = vertices * [1.0, 1.0, 0.0] + [0.0, 0.0, top]
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    keys = edges[:, 0] * count + edges[:, 1]
    rim = edges[~np.isin(keys, edges[:, 1] * count + edges[:, 0])]
    walls = np.concatenate(
        [
            np.stack([rim[:, 1], rim[:, 0], rim[:, 0] + count], axis=1),
            np.stack([rim[:, 1], rim[:, 0] + count, rim[:, 1] + count], axis=1),
        ]
    )
    faces = np.concatenate([triangles, triangles[:, ::-1] + count, walls])
    face_kinds = np.repeat([SLIP, END], [len(triangles), len(faces) - len(triangles)])
    return Cutter(np.concatenate([vertices, lid]), faces, face_kinds)


def smooth_normals(vertices: Floats, triangles: Ints) -> Floats:
    """Return unit normals (n, 3) at the vertices of a mesh, exact where the vertices lie on a sphere (Max 1999)."""
    total = np.zeros_like(vertices)
    for k in range(3):
        corner, following, previous = (triangles[:, (k + step) % 3] for step in range(3))
        first, second = (
            vertices[following] - vertices[corner],
            vertices[previous] - vertices[corner],
        )
        sizes = (first * first).sum(axis=1) * (second * second).sum(axis=1)
        np.add.at(total, corner, np.cross(first, second) / np.maximum(sizes, TINY)[:, None])
    length = np.sqrt((total * total).sum(axis=1))
    unit: Floats = total / np.maximum(length, TINY)[:, None]
    return unit
