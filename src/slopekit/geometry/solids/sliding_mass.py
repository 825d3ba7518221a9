"""The mass above a curved slip surface: cut from the ground with manifold3d, its surface refined where it bends.

The mass is the ground within the slip body. Faces keep where they come from by provenance. An analytic surface is
refined with its new vertices on the surface (on its rim: on the surface and the ground both), and every node pair
takes its place, area and normal from the surface itself; a drawn surface keeps its facets and has its normals smoothed.
"""

import math
from dataclasses import dataclass, field, replace

import numpy as np
from manifold3d import Error, Manifold, Mesh64

from slopekit.core.arrays import Bools, Floats, Ints, frozen
from slopekit.core.errors import DesignError, Fault, GeometryError
from slopekit.geometry.interfaces import BEDROCK, NodePairs
from slopekit.geometry.rays import line_triangle_intersections
from slopekit.geometry.solids.shapes import GROUND, SLIP, AnalyticShape, Cutter, smooth_normals
from slopekit.geometry.tolerances import MASS_BALANCE, NO_TURN, NUMERICAL_SLIVER, SLIVER_AREA, TINY

#: barycentric points of a triangle and their shares of its area: exact to degree two (docs/theory/preie.md)
_QUADRATURE = (
    ((1.0, 0.0, 0.0), 1 / 12),
    ((0.0, 1.0, 0.0), 1 / 12),
    ((0.0, 0.0, 1.0), 1 / 12),
    ((1 / 3,) * 3, 3 / 4),
)
#: Advice for a mesh that bounds no body.
CLOSE_IT = "Close its holes (every edge belongs to two triangles) and save it again."
_FIRST_LEVEL, _LAST_LEVEL = 3, 6
_FINE_TRIANGLES = 1500  # triangles on the slip surface that need no refining unless it is asked for
_FEWEST_TRIANGLES = 120  # triangles on the slip surface before it is refined
MOST_TRIANGLES = (
    12_000  # on the slip surface: two node pairs for each are what the solver takes in seconds
)


@dataclass(frozen=True)
class SlidingMass:
    """A mass on its slip surface, local coordinates.

    Attributes
    ----------
    vertices : (n, 3) m; triangles : (m, 3) outward; face_kinds : (m,) SLIP, GROUND or END
    facet : (m,) the triangle of the slip body that a face comes from (-1: the ground)
    volume : m³; centroid : (3,) m; area : m² of slip surface
    pieces : volumes (m³) of the smaller pieces within the slip body, which are ignored
    origin : (3,) m, subtracted from all coordinates
    """

    vertices: Floats
    triangles: Ints
    face_kinds: Ints
    facet: Ints
    volume: float
    centroid: Floats
    area: float
    pieces: tuple[float, ...]
    origin: Floats = field(default_factory=lambda: np.zeros(3))

    @property
    def edge(self) -> float:
        """Mean length (m) of the edges on the slip surface."""
        corners = self.vertices[self.triangles[self.face_kinds == SLIP]]
        sides = corners - np.roll(corners, 1, axis=1)
        return float(np.sqrt((sides * sides).sum(axis=2)).mean())


def cut_mass(ground: Cutter, body: Cutter) -> SlidingMass:
    """Return the largest piece of the ground within a slip body.

    Raises
    ------
    GeometryError
        E214 they share nothing, E215 the slip surface ends within the ground, E216 a mesh is not closed.
    """
    soil = _manifold(ground, np.full(len(ground.triangles), len(body.triangles)), "the slope")
    slip = _manifold(body, np.arange(len(body.triangles)), "the slip surface")
    mass, rest = soil.split(slip)
    if mass.is_empty() or not mass.volume() > 0.0:
        advice = "It must cut the ground surface; both are in metres and in the same coordinates."
        raise GeometryError(
            [
                Fault(
                    "E214",
                    "the slip surface encloses none of the ground",
                    _extents(ground, body),
                    advice,
                )
            ]
        )
    lost = abs(mass.volume() + rest.volume() - soil.volume()) / soil.volume()
    if lost > MASS_BALANCE:
        message = f"slope and slip surface cannot be cut: mass and rest differ from the slope by {lost * 100:.2g} %"
        raise GeometryError(
            [Fault("E216", message, "", "A mesh that crosses itself does this: repair it.")]
        )
    pieces = sorted(mass.decompose(), key=lambda piece: -piece.volume())
    mesh = pieces[0].to_mesh64()
    vertices = np.asarray(mesh.vert_properties, dtype=np.float64)[:, :3]
    triangles = np.asarray(mesh.tri_verts, dtype=np.int64)
    face_id = np.asarray(mesh.face_id, dtype=np.int64)
    facet = np.where(face_id == len(body.triangles), -1, face_id)
    face_kinds = np.where(facet < 0, GROUND, body.face_kinds[facet])
    if not (face_kinds == SLIP).any() or not (face_kinds == GROUND).any():
        position = (
            "touches none of the slip surface"
            if not (face_kinds == SLIP).any()
            else "lies wholly within the ground"
        )
        advice = "The slip surface must come out at the ground surface."
        raise GeometryError([Fault("E214", f"the mass {position}: it cannot move", "", advice)])
    volume, moment = volume_moments(vertices, triangles)
    area = float(
        np.sqrt((_vector_areas(vertices, triangles[face_kinds == SLIP]) ** 2).sum(axis=1)).sum()
    )
    other_volumes = tuple(
        piece.volume() for piece in pieces[1:] if piece.volume() > NUMERICAL_SLIVER * volume
    )
    return SlidingMass(
        frozen(vertices),
        triangles,
        face_kinds,
        facet,
        volume,
        frozen(moment / volume),
        area,
        other_volumes,
    )


def analytic_mass(
    ground: Cutter, shape: AnalyticShape, edge: float | None
) -> tuple[SlidingMass, NodePairs]:
    """Return the mass on an analytic slip surface with its true volume and area, and its node pairs with true normals.

    Parameters
    ----------
    edge : target of the mean edge length (m) on the slip surface, None for the mesh that four digits of a factor need

    Raises
    ------
    DesignError
        E125 the mesh is so fine that the solver would take minutes. GeometryError as for `cut_mass`.
    """
    mass, level = cut_mass(ground, shape.cutter(_FIRST_LEVEL)), _FIRST_LEVEL
    if edge is not None:
        halvings(mass, edge)
    while (
        level < _LAST_LEVEL
        and int((mass.face_kinds == SLIP).sum()) < _FEWEST_TRIANGLES
        and (edge is None or mass.edge > edge)
    ):
        level += 1
        mass = cut_mass(ground, shape.cutter(level))
    mass, refined = _with_rim_on_surface(mass, shape.metric), 0
    is_fine = int((mass.face_kinds == SLIP).sum()) > _FINE_TRIANGLES
    while (refined < 1 and not is_fine) if edge is None else mass.edge > edge:
        mass, refined = _refined(mass, shape.metric), refined + 1
    corners = mass.vertices[mass.triangles[mass.face_kinds == SLIP]]
    vector_areas = _vector_areas(mass.vertices, mass.triangles[mass.face_kinds == SLIP])
    lifted = [
        shape.lift(np.tensordot(corners, weights, (1, 0)), weight * vector_areas)
        for weights, weight in _QUADRATURE
    ]
    volume = mass.volume + sum(float(lift.volumes.sum()) for lift in lifted)
    moment = mass.volume * mass.centroid + sum(lift.moments.sum(axis=0) for lift in lifted)
    index = _pair_index(mass)
    points, normals, areas = (
        np.concatenate([getattr(lift, name) for lift in lifted])
        for name in ("points", "normals", "areas")
    )
    strips = np.concatenate([_rim_strips(mass, shape.metric), np.zeros(len(corners))])
    pairs = _merged_pairs(index, points, -normals, areas, strips)
    areas = pairs.control_areas
    lifted_mass = SlidingMass(
        mass.vertices,
        mass.triangles,
        mass.face_kinds,
        mass.facet,
        volume,
        frozen(moment / volume),
        float(areas.sum()),
        mass.pieces,
    )
    return lifted_mass, pairs


def halvings(mass: SlidingMass, edge: float) -> int:
    """Return how often the edges on the slip surface have to be halved to be as short as `edge` (m).

    Raises
    ------
    DesignError
        E125 there would be more triangles than the solver handles in seconds.
    """
    count = int((mass.face_kinds == SLIP).sum())
    halving_count = max(0, math.ceil(math.log2(mass.edge / edge)))
    triangle_count = count * 4.0**halving_count
    if triangle_count > MOST_TRIANGLES:
        allowed = math.floor(math.log(max(MOST_TRIANGLES / count, 1.0), 4.0))
        message = (
            f"edges of {edge:.6g} m make {triangle_count:.3g} triangles on the slip surface, at "
            f"most {MOST_TRIANGLES} are taken"
        )
        advice = f"Give {math.ceil(1e3 * mass.edge / 2.0**allowed) / 1e3:.6g} m or more."
        raise DesignError([Fault("E125", message, "slip.edge", advice)])
    return halving_count


def facet_pairs(mass: SlidingMass, body: Cutter) -> NodePairs:
    """Return the node pairs on the facets of a slip surface, with smoothed normals.

    Without smoothing the facets interlock like a ratchet. The normals are those at the corners of the facet that was
    cut (Max 1999), interpolated across it.
    """
    slip_triangles = mass.triangles[mass.face_kinds == SLIP]
    if len(slip_triangles) > MOST_TRIANGLES:
        message = (
            f"the slip surface has {len(slip_triangles)} triangles within the ground, "
            f"at most {MOST_TRIANGLES} are taken"
        )
        raise DesignError(
            [
                Fault(
                    "E125",
                    message,
                    "slip.mesh",
                    "Decimate its mesh: the answer does not need them.",
                )
            ]
        )
    corners = mass.vertices[slip_triangles]
    vector_areas = _vector_areas(mass.vertices, slip_triangles)
    size = np.sqrt((vector_areas * vector_areas).sum(axis=1))
    points = np.concatenate([np.tensordot(corners, weights, (1, 0)) for weights, _ in _QUADRATURE])
    areas = np.concatenate([weight * size for _, weight in _QUADRATURE])
    vertex_normals = smooth_normals(body.vertices, body.triangles[body.face_kinds == SLIP])
    facet = np.tile(body.triangles[mass.facet[mass.face_kinds == SLIP]], (len(_QUADRATURE), 1))
    normals = np.einsum(
        "nk,nki->ni", _barycentric(points, body.vertices[facet]), vertex_normals[facet]
    )
    normals /= np.sqrt((normals * normals).sum(axis=1))[:, None]
    return _merged_pairs(_pair_index(mass), points, -normals, areas)


def _extents(ground: Cutter, body: Cutter) -> str:
    """Return the extents of slip surface and ground in words, about the middle of the slip surface."""
    low, high = body.vertices.min(axis=0), body.vertices.max(axis=0)
    floor, top = ground.vertices.min(axis=0), ground.vertices.max(axis=0)
    return "seen from the middle of the slip surface it reaches " + ", ".join(
        f"{axis} {low[k]:.4g} to {high[k]:.4g} (ground {floor[k]:.4g} to {top[k]:.4g})"
        for k, axis in enumerate("xyz")
    )


def mass_exit(mass: SlidingMass, start: Floats, direction: Floats) -> tuple[float | None, bool]:
    """Return the distance (m) at which a ray last leaves a mass, and whether it does so through the slip surface.

    The distance is None where the ray misses the mass.

    Parameters
    ----------
    start, direction : (3,) m and a unit vector
    """
    distances, hits = line_triangle_intersections(start, direction, mass.vertices[mass.triangles])
    if not (distances > 0.0).any():
        return None, False
    return float(distances.max()), bool(mass.face_kinds[hits[distances.argmax()]] == SLIP)


def _manifold(cutter: Cutter, ids: Ints, name: str) -> Manifold:
    mesh = Mesh64(
        np.ascontiguousarray(cutter.vertices),
        np.ascontiguousarray(cutter.triangles.astype(np.uint64)),
        face_id=ids.astype(np.uint64),
    )
    body = Manifold(mesh)
    if body.status() != Error.NoError or body.is_empty():
        reason = str(body.status()).rpartition(".")[2]
        raise GeometryError(
            [Fault("E216", f"the mesh of {name} is not a closed body ({reason})", "", CLOSE_IT)]
        )
    if body.volume() < 0.0:
        raise GeometryError(
            [Fault("E216", f"the mesh of {name} is inside out", "", "Turn its triangles round.")]
        )
    return body


def _vector_areas(vertices: Floats, triangles: Ints) -> Floats:
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return np.asarray(np.cross(b - a, c - a) / 2.0, dtype=np.float64)


def volume_moments(vertices: Floats, triangles: Ints) -> tuple[float, Floats]:
    """Return the volume (m³) and first moment (3,) m⁴ of a closed mesh, by tetrahedra from its first vertex."""
    apex = vertices[0]
    a, b, c = (vertices[triangles[:, k]] - apex for k in range(3))
    tetrahedra = np.einsum("ni,ni->n", a, np.cross(b, c)) / 6.0
    volume = float(tetrahedra.sum())
    moment = (tetrahedra[:, None] * (a + b + c)).sum(axis=0) / 4.0 + volume * apex
    return volume, np.asarray(moment, dtype=np.float64)


@dataclass(frozen=True)
class _Edges:
    """The edges of a mass, each once.

    Attributes
    ----------
    vertices : (e, 2) vertex indices; ends : (e, 2, 3) m; of_triangle : (m, 3) the edges of each triangle in turn
    inside, rim : (e,) on the slip surface alone; between it and another face
    across : (e, 3) on the rim: within the other face, square to the edge
    outward : (e, 3) on the rim: away from the slip surface's triangle, square to the edge
    """

    vertices: Ints
    ends: Floats
    of_triangle: Ints
    inside: Bools
    rim: Bools
    across: Floats
    outward: Floats


def _edges(mass: SlidingMass) -> _Edges:
    triangles, count = mass.triangles, len(mass.vertices)
    half_edges = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    ordered = np.sort(half_edges, axis=1)
    keys, first, edge_index = np.unique(
        ordered[:, 0] * count + ordered[:, 1], return_index=True, return_inverse=True
    )
    edge_index = edge_index.ravel()
    vertices = ordered[first]
    ends = mass.vertices[vertices]
    face_kinds = np.repeat(mass.face_kinds, 3)
    touches_slip, touches_ground = np.zeros(len(keys), dtype=bool), np.zeros(len(keys), dtype=bool)
    touches_slip[edge_index[face_kinds == SLIP]] = True
    touches_ground[edge_index[face_kinds != SLIP]] = True
    normals = _vector_areas(mass.vertices, triangles)
    across, outward = np.zeros((len(keys), 3)), np.zeros((len(keys), 3))
    free, slip = np.flatnonzero(face_kinds != SLIP), np.flatnonzero(face_kinds == SLIP)
    along = ends[:, 1] - ends[:, 0]
    across[edge_index[free]] = np.cross(normals[free // 3], along[edge_index[free]])
    run = mass.vertices[half_edges[slip, 1]] - mass.vertices[half_edges[slip, 0]]
    outward[edge_index[slip]] = np.cross(run, normals[slip // 3])
    return _Edges(
        vertices,
        ends,
        edge_index.reshape(-1, 3),
        touches_slip & ~touches_ground,
        touches_slip & touches_ground,
        across,
        outward,
    )


def _refined(mass: SlidingMass, metric: Floats) -> SlidingMass:
    """Return the mass with every triangle split in four and new vertices of the slip surface on Σ m x² = 1."""
    sides = _edges(mass)
    middle = sides.ends.mean(axis=1)
    # straight away from the centre (or the axis); on the rim within the ground's plane
    along = np.where(
        sides.inside[:, None],
        middle * (metric > 0.0),
        np.where(sides.rim[:, None], sides.across, 0.0),
    )
    middle = middle + _steps_to_surface(middle, along, metric)[:, None] * along
    a, b, c = mass.triangles.T
    ab, bc, ca = sides.of_triangle.T + len(mass.vertices)
    split = np.concatenate(
        [
            np.stack(corners, axis=1)
            for corners in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
        ]
    )
    vertices = np.concatenate([mass.vertices, middle])
    face_kinds, facet = np.tile(mass.face_kinds, 4), np.tile(mass.facet, 4)
    volume, moment = volume_moments(vertices, split)
    area = float(
        np.sqrt((_vector_areas(vertices, split[face_kinds == SLIP]) ** 2).sum(axis=1)).sum()
    )
    return SlidingMass(
        frozen(vertices),
        split,
        face_kinds,
        facet,
        volume,
        frozen(moment / volume),
        area,
        mass.pieces,
    )


def _with_rim_on_surface(mass: SlidingMass, metric: Floats) -> SlidingMass:
    """Return the mass with the vertices of its rim moved to the surface Σ m x² = 1, within the faces they lie on."""
    slip, free = mass.triangles[mass.face_kinds == SLIP], mass.triangles[mass.face_kinds != SLIP]
    normals = _vector_areas(mass.vertices, free)
    normals /= np.maximum(np.sqrt((normals * normals).sum(axis=1)), TINY)[:, None]
    spread = np.zeros((len(mass.vertices), 3, 3))
    for k in range(3):
        np.add.at(spread, free[:, k], normals[:, :, None] * normals[:, None, :])
    rim = np.intersect1d(slip, free)
    sizes, axes = np.linalg.eigh(spread[rim])
    axes = np.where(
        (sizes < NO_TURN * sizes[:, -1:])[:, None, :], axes, 0.0
    )  # the directions that lie in all faces at the corner
    gradient = metric * mass.vertices[rim]
    along = np.einsum("nik,njk,nj->ni", axes, axes, gradient)
    vertices = mass.vertices.copy()
    vertices[rim] += _steps_to_surface(vertices[rim], along, metric)[:, None] * along
    volume, moment = volume_moments(vertices, mass.triangles)
    return replace(mass, vertices=frozen(vertices), volume=volume, centroid=frozen(moment / volume))


def _rim_strips(mass: SlidingMass, metric: Floats) -> Floats:
    """Return the area (m²) that each vertex gains where the rim bulges beyond its chords: 2/3 of chord times height."""
    sides = _edges(mass)
    ends = sides.ends[sides.rim]
    chord = ends.mean(axis=1)
    lifted = chord + _steps_to_surface(chord, chord * (metric > 0.0), metric)[:, None] * chord * (
        metric > 0.0
    )
    across = sides.across[sides.rim]
    bend = (chord + _steps_to_surface(chord, across, metric)[:, None] * across) - lifted
    run = ends[:, 1] - ends[:, 0]
    sign = np.sign(np.einsum("ni,ni->n", bend, sides.outward[sides.rim]))
    strip = 2.0 / 3.0 * sign * np.sqrt((bend * bend).sum(axis=1) * (run * run).sum(axis=1))
    rim_vertices = sides.vertices[sides.rim]
    gained = np.bincount(
        rim_vertices.ravel(), np.repeat(strip / 2.0, 2), minlength=len(mass.vertices)
    )
    return np.asarray(gained, dtype=np.float64)


def _steps_to_surface(points: Floats, along: Floats, metric: Floats) -> Floats:
    """Return the smallest steps s for which points + s along lie on Σ m x² = 1; 0 where the line misses the surface."""
    square = (metric * along * along).sum(axis=1)
    half = (metric * points * along).sum(axis=1)
    rest = (metric * points * points).sum(axis=1) - 1.0
    root = half * half - square * rest
    meets = (square > 0.0) & (root >= 0.0)
    larger = half + np.where(half >= 0.0, 1.0, -1.0) * np.sqrt(np.where(meets, root, 0.0))
    return np.where(meets & (larger != 0.0), -rest / np.where(larger != 0.0, larger, 1.0), 0.0)


def _barycentric(points: Floats, corners: Floats) -> Floats:
    """Return the barycentric coordinates (n, 3) of points in their triangles (n, 3, 3)."""
    a, b, c = (corners[:, k] for k in range(3))
    normal = np.cross(b - a, c - a)
    size = (normal * normal).sum(axis=1)
    second = np.einsum("ni,ni->n", np.cross(points - a, c - a), normal) / size
    third = np.einsum("ni,ni->n", np.cross(b - a, points - a), normal) / size
    return np.stack([1.0 - second - third, second, third], axis=1)


def _pair_index(mass: SlidingMass) -> Ints:
    """Return the node pair of each of the four quadrature points of the slip triangles: a vertex, or the centroid."""
    slip_triangles = mass.triangles[mass.face_kinds == SLIP]
    return np.concatenate([*slip_triangles.T, len(mass.vertices) + np.arange(len(slip_triangles))])


def _merged_pairs(
    index: Ints, points: Floats, normals: Floats, areas: Floats, gained: Floats | None = None
) -> NodePairs:
    """Return one node pair for each vertex and centroid, with the areas of its triangles and of the rim added up."""
    used, first, pair_index = np.unique(index, return_index=True, return_inverse=True)
    total = np.asarray(np.bincount(pair_index.ravel(), areas), dtype=np.float64)
    if gained is not None:
        total = np.maximum(total + gained[used], 0.1 * total)
    is_kept = total > SLIVER_AREA * total.max()
    rows = first[is_kept]
    return NodePairs(
        frozen(points[rows]),
        frozen(normals[rows]),
        frozen(total[is_kept]),
        np.full(len(rows), SLIP),
        np.zeros(len(rows), dtype=np.int64),
        np.full(len(rows), BEDROCK),
    )
