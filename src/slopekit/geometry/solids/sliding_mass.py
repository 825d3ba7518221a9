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
_POINTS = (((1.0, 0.0, 0.0), 1 / 12), ((0.0, 1.0, 0.0), 1 / 12), ((0.0, 0.0, 1.0), 1 / 12), ((1 / 3,) * 3, 3 / 4))
#: What to do with a mesh that bounds no body.
CLOSE_IT = "Close its holes (every edge belongs to two triangles) and save it again."
_FIRST_LEVEL, _LAST_LEVEL = 3, 6
_PLENTY = 1500  # triangles on the slip surface that need no refining unless it is asked for
_FEWEST = 120  # triangles on the slip surface before it is refined
MOST_TRIANGLES = 12_000  # on the slip surface: two node pairs for each are what the solver takes in seconds


@dataclass(frozen=True)
class SlidingMass:
    """A mass on its slip surface, local coordinates.

    Attributes
    ----------
    vertices : (n, 3) m; triangles : (m, 3) outward; on : (m,) SLIP, GROUND or END
    facet : (m,) the triangle of the slip body that a face comes from (-1: the ground)
    volume : m³; centroid : (3,) m; area : m² of slip surface
    pieces : volumes (m³) of what else lies within the slip body, left out
    origin : (3,) taken from all coordinates
    """

    vertices: Floats
    triangles: Ints
    on: Ints
    facet: Ints
    volume: float
    centroid: Floats
    area: float
    pieces: tuple[float, ...]
    origin: Floats = field(default_factory=lambda: np.zeros(3))

    @property
    def edge(self) -> float:
        """Mean length (m) of the edges on the slip surface."""
        corners = self.vertices[self.triangles[self.on == SLIP]]
        sides = corners - np.roll(corners, 1, axis=1)
        return float(np.sqrt((sides * sides).sum(axis=2)).mean())


def cut_mass(ground: Cutter, body: Cutter) -> SlidingMass:
    """The largest piece of the ground within a slip body.

    Raises
    ------
    GeometryError
        E214 they share nothing, E215 the slip surface ends within the ground, E216 a mesh is not closed.
    """
    soil = _manifold(ground, np.full(len(ground.triangles), len(body.triangles)), "the slope")
    slip = _manifold(body, np.arange(len(body.triangles)), "the slip surface")
    whole, rest = soil.split(slip)
    if whole.is_empty() or not whole.volume() > 0.0:
        advice = "It must cut the ground surface; both are in metres and in the same coordinates."
        raise GeometryError(
            [Fault("E214", "the slip surface encloses none of the ground", _extents(ground, body), advice)]
        )
    lost = abs(whole.volume() + rest.volume() - soil.volume()) / soil.volume()
    if lost > MASS_BALANCE:
        message = f"slope and slip surface cannot be cut: mass and rest differ from the slope by {lost * 100:.2g} %"
        raise GeometryError([Fault("E216", message, "", "A mesh that crosses itself does this: repair it.")])
    parts = sorted(whole.decompose(), key=lambda part: -part.volume())
    mesh = parts[0].to_mesh64()
    vertices = np.asarray(mesh.vert_properties, dtype=np.float64)[:, :3]
    triangles = np.asarray(mesh.tri_verts, dtype=np.int64)
    made_by = np.asarray(mesh.face_id, dtype=np.int64)
    facet = np.where(made_by == len(body.triangles), -1, made_by)
    on = np.where(facet < 0, GROUND, body.on[facet])
    if not (on == SLIP).any() or not (on == GROUND).any():
        what = "touches none of the slip surface" if not (on == SLIP).any() else "lies wholly within the ground"
        advice = "The slip surface must come out at the ground surface."
        raise GeometryError([Fault("E214", f"the mass {what}: it cannot move", "", advice)])
    volume, moment = volume_moments(vertices, triangles)
    area = float(np.sqrt((_vector_areas(vertices, triangles[on == SLIP]) ** 2).sum(axis=1)).sum())
    others = tuple(part.volume() for part in parts[1:] if part.volume() > NUMERICAL_SLIVER * volume)
    return SlidingMass(
        frozen(vertices), triangles, on, facet, volume, frozen(moment / volume), area, others
    )  # fmt: skip


def analytic_mass(ground: Cutter, shape: AnalyticShape, edge: float | None) -> tuple[SlidingMass, NodePairs]:
    """The mass on an analytic surface with its true volume, area and normals.

    Parameters
    ----------
    edge : mean length (m) of the edges wanted on the slip surface, None for what four digits of a factor need

    Raises
    ------
    DesignError
        E125 so fine that the solver would take minutes. GeometryError as for `cut_mass`.
    """
    mass, level = cut_mass(ground, shape.cutter(_FIRST_LEVEL)), _FIRST_LEVEL
    if edge is not None:
        halvings(mass, edge)
    while level < _LAST_LEVEL and int((mass.on == SLIP).sum()) < _FEWEST and (edge is None or mass.edge > edge):
        level += 1
        mass = cut_mass(ground, shape.cutter(level))
    mass, refined = _snapped(mass, shape.metric), 0
    enough = int((mass.on == SLIP).sum()) > _PLENTY
    while (refined < 1 and not enough) if edge is None else mass.edge > edge:
        mass, refined = _refined(mass, shape.metric), refined + 1
    corners = mass.vertices[mass.triangles[mass.on == SLIP]]
    vector_areas = _vector_areas(mass.vertices, mass.triangles[mass.on == SLIP])
    lifted = [shape.lift(np.tensordot(corners, weights, (1, 0)), share * vector_areas) for weights, share in _POINTS]
    volume = mass.volume + sum(float(part.volumes.sum()) for part in lifted)
    moment = mass.volume * mass.centroid + sum(part.moments.sum(axis=0) for part in lifted)
    index = _index(mass)
    points, normals, areas = (
        np.concatenate([getattr(part, name) for part in lifted]) for name in ("points", "normals", "areas")
    )
    strips = np.concatenate([_rim_strips(mass, shape.metric), np.zeros(len(corners))])
    pairs = _merged(index, points, -normals, areas, strips)
    areas = pairs.control_areas
    better = SlidingMass(
        mass.vertices, mass.triangles, mass.on, mass.facet, volume, frozen(moment / volume), float(areas.sum()),
        mass.pieces,
    )  # fmt: skip
    return better, pairs


def halvings(mass: SlidingMass, edge: float) -> int:
    """How often the edges on the slip surface have to be halved to be as short as `edge` (m).

    Raises
    ------
    DesignError
        E125 that makes more triangles than the solver takes in seconds.
    """
    count = int((mass.on == SLIP).sum())
    times = max(0, math.ceil(math.log2(mass.edge / edge)))
    made = count * 4.0**times
    if made > MOST_TRIANGLES:
        allowed = math.floor(math.log(max(MOST_TRIANGLES / count, 1.0), 4.0))
        message = (
            f"edges of {edge:.6g} m make {made:.3g} triangles on the slip surface, at most {MOST_TRIANGLES} are taken"
        )
        advice = f"Give {math.ceil(1e3 * mass.edge / 2.0**allowed) / 1e3:.6g} m or more."
        raise DesignError([Fault("E125", message, "slip.edge", advice)])
    return times


def facet_pairs(mass: SlidingMass, body: Cutter) -> NodePairs:
    """Node pairs on the facets of a slip surface, with smoothed normals: a surface of facets interlocks like a ratchet.

    They are those at the corners of the facet that was cut (Max 1999), interpolated across it.
    """
    where = mass.triangles[mass.on == SLIP]
    if len(where) > MOST_TRIANGLES:
        message = f"the slip surface has {len(where)} triangles within the ground, at most {MOST_TRIANGLES} are taken"
        raise DesignError([Fault("E125", message, "slip.mesh", "Decimate its mesh: the answer does not need them.")])
    corners = mass.vertices[where]
    vector_areas = _vector_areas(mass.vertices, where)
    size = np.sqrt((vector_areas * vector_areas).sum(axis=1))
    points = np.concatenate([np.tensordot(corners, weights, (1, 0)) for weights, _ in _POINTS])
    areas = np.concatenate([share * size for _, share in _POINTS])
    at_vertices = smooth_normals(body.vertices, body.triangles[body.on == SLIP])
    facet = np.tile(body.triangles[mass.facet[mass.on == SLIP]], (len(_POINTS), 1))
    smooth = np.einsum("nk,nki->ni", _barycentric(points, body.vertices[facet]), at_vertices[facet])
    smooth /= np.sqrt((smooth * smooth).sum(axis=1))[:, None]
    return _merged(_index(mass), points, -smooth, areas)


def _extents(ground: Cutter, body: Cutter) -> str:
    """How large both are, about the slip surface's own middle."""
    low, high = body.vertices.min(axis=0), body.vertices.max(axis=0)
    floor, top = ground.vertices.min(axis=0), ground.vertices.max(axis=0)
    return "seen from the middle of the slip surface it reaches " + ", ".join(
        f"{axis} {low[k]:.4g} to {high[k]:.4g} (ground {floor[k]:.4g} to {top[k]:.4g})" for k, axis in enumerate("xyz")
    )


def through(mass: SlidingMass, start: Floats, direction: Floats) -> tuple[float | None, bool]:
    """How far (m) a ray goes until it leaves a mass for good, and whether through the slip surface; None: it misses.

    Parameters
    ----------
    start, direction : (3,) m and a unit vector
    """
    at, met = line_triangle_intersections(start, direction, mass.vertices[mass.triangles])
    if not (at > 0.0).any():
        return None, False
    return float(at.max()), bool(mass.on[met[at.argmax()]] == SLIP)


def _manifold(cutter: Cutter, ids: Ints, name: str) -> Manifold:
    mesh = Mesh64(
        np.ascontiguousarray(cutter.vertices), np.ascontiguousarray(cutter.triangles.astype(np.uint64)),
        face_id=ids.astype(np.uint64),
    )  # fmt: skip
    made = Manifold(mesh)
    if made.status() != Error.NoError or made.is_empty():
        reason = str(made.status()).rpartition(".")[2]
        raise GeometryError([Fault("E216", f"the mesh of {name} is not a closed body ({reason})", "", CLOSE_IT)])
    if made.volume() < 0.0:
        raise GeometryError([Fault("E216", f"the mesh of {name} is inside out", "", "Turn its triangles round.")])
    return made


def _vector_areas(vertices: Floats, triangles: Ints) -> Floats:
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return np.asarray(np.cross(b - a, c - a) / 2.0, dtype=np.float64)


def volume_moments(vertices: Floats, triangles: Ints) -> tuple[float, Floats]:
    """Volume and first moment of a closed mesh, by tetrahedra from its first vertex."""
    apex = vertices[0]
    a, b, c = (vertices[triangles[:, k]] - apex for k in range(3))
    parts = np.einsum("ni,ni->n", a, np.cross(b, c)) / 6.0
    volume = float(parts.sum())
    moment = (parts[:, None] * (a + b + c)).sum(axis=0) / 4.0 + volume * apex
    return volume, np.asarray(moment, dtype=np.float64)


@dataclass(frozen=True)
class _Sides:
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


def _sides(mass: SlidingMass) -> _Sides:
    triangles, count = mass.triangles, len(mass.vertices)
    both = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    ordered = np.sort(both, axis=1)
    keys, first, which = np.unique(ordered[:, 0] * count + ordered[:, 1], return_index=True, return_inverse=True)
    which = which.ravel()
    vertices = ordered[first]
    ends = mass.vertices[vertices]
    on = np.repeat(mass.on, 3)
    on_slip, on_other = np.zeros(len(keys), dtype=bool), np.zeros(len(keys), dtype=bool)
    on_slip[which[on == SLIP]] = True
    on_other[which[on != SLIP]] = True
    normals = _vector_areas(mass.vertices, triangles)
    across, outward = np.zeros((len(keys), 3)), np.zeros((len(keys), 3))
    free, slip = np.flatnonzero(on != SLIP), np.flatnonzero(on == SLIP)
    along = ends[:, 1] - ends[:, 0]
    across[which[free]] = np.cross(normals[free // 3], along[which[free]])
    run = mass.vertices[both[slip, 1]] - mass.vertices[both[slip, 0]]
    outward[which[slip]] = np.cross(run, normals[slip // 3])
    return _Sides(
        vertices, ends, which.reshape(-1, 3), on_slip & ~on_other, on_slip & on_other, across, outward
    )  # fmt: skip


def _refined(mass: SlidingMass, metric: Floats) -> SlidingMass:
    """Split every triangle in four, new vertices of the slip surface on the surface Σ m x² = 1."""
    sides = _sides(mass)
    middle = sides.ends.mean(axis=1)
    # straight away from the centre (or the axis); on the rim within the ground's plane
    along = np.where(sides.inside[:, None], middle * (metric > 0.0), np.where(sides.rim[:, None], sides.across, 0.0))
    middle = middle + _onto(middle, along, metric)[:, None] * along
    a, b, c = mass.triangles.T
    ab, bc, ca = sides.of_triangle.T + len(mass.vertices)
    split = np.concatenate([
        np.stack(part, axis=1) for part in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
    ])  # fmt: skip
    vertices = np.concatenate([mass.vertices, middle])
    on, facet = np.tile(mass.on, 4), np.tile(mass.facet, 4)
    volume, moment = volume_moments(vertices, split)
    area = float(np.sqrt((_vector_areas(vertices, split[on == SLIP]) ** 2).sum(axis=1)).sum())
    return SlidingMass(frozen(vertices), split, on, facet, volume, frozen(moment / volume), area, mass.pieces)


def _snapped(mass: SlidingMass, metric: Floats) -> SlidingMass:
    """The rim's corners moved from the facets of the cut to the surface Σ m x² = 1, within the faces they lie on."""
    slip, free = mass.triangles[mass.on == SLIP], mass.triangles[mass.on != SLIP]
    normals = _vector_areas(mass.vertices, free)
    normals /= np.maximum(np.sqrt((normals * normals).sum(axis=1)), TINY)[:, None]
    spread = np.zeros((len(mass.vertices), 3, 3))
    for k in range(3):
        np.add.at(spread, free[:, k], normals[:, :, None] * normals[:, None, :])
    rim = np.intersect1d(slip, free)
    sizes, axes = np.linalg.eigh(spread[rim])
    axes = np.where((sizes < NO_TURN * sizes[:, -1:])[:, None, :], axes, 0.0)  # what all faces at the corner leave free
    gradient = metric * mass.vertices[rim]
    along = np.einsum("nik,njk,nj->ni", axes, axes, gradient)
    vertices = mass.vertices.copy()
    vertices[rim] += _onto(vertices[rim], along, metric)[:, None] * along
    volume, moment = volume_moments(vertices, mass.triangles)
    return replace(mass, vertices=frozen(vertices), volume=volume, centroid=frozen(moment / volume))


def _rim_strips(mass: SlidingMass, metric: Floats) -> Floats:
    """Area (m²) that each vertex gains where the rim bends beyond its chords: two thirds of chord times height."""
    sides = _sides(mass)
    ends = sides.ends[sides.rim]
    chord = ends.mean(axis=1)
    lifted = chord + _onto(chord, chord * (metric > 0.0), metric)[:, None] * chord * (metric > 0.0)
    across = sides.across[sides.rim]
    bend = (chord + _onto(chord, across, metric)[:, None] * across) - lifted
    run = ends[:, 1] - ends[:, 0]
    sign = np.sign(np.einsum("ni,ni->n", bend, sides.outward[sides.rim]))
    strip = 2.0 / 3.0 * sign * np.sqrt((bend * bend).sum(axis=1) * (run * run).sum(axis=1))
    at = sides.vertices[sides.rim]
    gained = np.bincount(at.ravel(), np.repeat(strip / 2.0, 2), minlength=len(mass.vertices))
    return np.asarray(gained, dtype=np.float64)


def _onto(points: Floats, along: Floats, metric: Floats) -> Floats:
    """The smallest steps s for which points + s along lie on Σ m x² = 1; none where the line misses it."""
    square = (metric * along * along).sum(axis=1)
    half = (metric * points * along).sum(axis=1)
    rest = (metric * points * points).sum(axis=1) - 1.0
    root = half * half - square * rest
    meets = (square > 0.0) & (root >= 0.0)
    larger = half + np.where(half >= 0.0, 1.0, -1.0) * np.sqrt(np.where(meets, root, 0.0))
    return np.where(meets & (larger != 0.0), -rest / np.where(larger != 0.0, larger, 1.0), 0.0)


def _barycentric(points: Floats, corners: Floats) -> Floats:
    """Coordinates (n, 3) of points in their triangles (n, 3, 3)."""
    a, b, c = (corners[:, k] for k in range(3))
    normal = np.cross(b - a, c - a)
    size = (normal * normal).sum(axis=1)
    second = np.einsum("ni,ni->n", np.cross(points - a, c - a), normal) / size
    third = np.einsum("ni,ni->n", np.cross(b - a, points - a), normal) / size
    return np.stack([1.0 - second - third, second, third], axis=1)


def _index(mass: SlidingMass) -> Ints:
    """Which node pair each of the four points of each slip triangle belongs to: its vertex, or the triangle's own."""
    where = mass.triangles[mass.on == SLIP]
    return np.concatenate([*where.T, len(mass.vertices) + np.arange(len(where))])


def _merged(index: Ints, points: Floats, normals: Floats, areas: Floats, gained: Floats | None = None) -> NodePairs:
    """One pair for each vertex: the areas of the triangles around it added up, and what the rim adds."""
    used, first, which = np.unique(index, return_index=True, return_inverse=True)
    total = np.asarray(np.bincount(which.ravel(), areas), dtype=np.float64)
    if gained is not None:
        total = np.maximum(total + gained[used], 0.1 * total)
    is_kept = total > SLIVER_AREA * total.max()
    kept = first[is_kept]
    return NodePairs(
        frozen(points[kept]), frozen(normals[kept]), frozen(total[is_kept]), np.full(len(kept), SLIP),
        np.zeros(len(kept), dtype=np.int64), np.full(len(kept), BEDROCK),
    )  # fmt: skip
