"""Methods of columns in 3-D: Fellenius, Janbu (simplified) and Bishop.

Sources: Fellenius (1936); Janbu (1954); Bishop (1955), Géotechnique 5; in 3-D Hovland (1977), J. Geotech. Eng. Div.
103 (GT9), and Hungr, Salgado & Byrne (1989), Can. Geotech. J. 26.

The columns stand on the nodes of Gauss's rule (slices square to y, angles within a slice), not on a grid: some
thousand give five digits, also where the margins of the surface are upright.

Signs: base normals point up into the mass, N and pore pressure are positive in compression; α is the apparent dip of
a base along the direction of sliding d, tan α = n·d / n_z, and shear acts in the vertical plane through d.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from slopekit.closed_form.rotation import (
    changes,
    crossings,
    ground_surface,
    height_of_ground,
    panels,
)
from slopekit.closed_form.tolerances import LEAST_GRIP, SMALL
from slopekit.core.array_types import ArrayLike, Floats
from slopekit.core.errors import Fault, GeometryError

_NODES = 12  # nodes between two changes, in either direction
_MAX_STEPS = 200


@dataclass(frozen=True)
class Columns:
    """The mass above a slip surface, divided into vertical columns.

    Attributes
    ----------
    base_points : (n, 3) m; base_normals : (n, 3) unit, upward; plan_areas : (n,) m²
    weights : (n,) kN; pore_pressure : (n,) kPa on the base; column_heights : (n,) m
    overhung_share : fraction of the weight with slip surface above it, too; that surface has no columns, no strength
    """

    base_points: Floats
    base_normals: Floats
    plan_areas: Floats
    weights: Floats
    pore_pressure: Floats
    column_heights: Floats
    overhung_share: float = 0.0


def ellipsoid_columns(
    centre: Sequence[float],
    radii: Sequence[float],
    profile: ArrayLike,
    unit_weight_kn_m3: float,
    count: int = _NODES,
) -> Columns:
    """Return the columns of the ground within an ellipsoid with axes along x, y and z.

    Parameters
    ----------
    centre, radii : (3,) m; profile : (k, 2) x and z of the ground surface, m; level beyond its ends
    count : nodes between two changes of the section, in either direction

    Raises
    ------
    GeometryError
        E214 the surface encloses no ground, E218 the profile turns back.

    >>> ball = ellipsoid_columns((0, 0, 0), (10, 10, 10), [(-20, 0), (20, 0)], 20)
    >>> round(float(ball.weights.sum()) / 20, 4), ball.overhung_share  # half a sphere
    (2094.3951, 0.0)
    """
    ground = ground_surface(profile, (centre[0], centre[2]), (radii[0], radii[2]))
    t, share = panels(np.arccos(_changes(ground)), count)
    t, share = np.concatenate([t, -t]), np.concatenate([share, share])
    return _columns(
        ground, centre, radii, np.cos(t), np.sin(t), share * np.cos(t), unit_weight_kn_m3, count
    )


def cylinder_columns(
    centre: Sequence[float],
    radius: float,
    length: float,
    profile: ArrayLike,
    unit_weight_kn_m3: float,
    count: int = 2 * _NODES,
) -> Columns:
    """Return the columns of the ground within a horizontal cylinder along y of a length (m); its ends have no strength.

    Parameters
    ----------
    centre : x and z of the axis, m; radius, length : m; profile, count : as for `ellipsoid_columns`

    Raises
    ------
    GeometryError
        E214 the surface encloses no ground, E218 the profile turns back.

    >>> tube = cylinder_columns((0, 0), 10, 4, [(-20, 0), (20, 0)], 20)
    >>> round(float(tube.weights.sum()) / 20, 6)  # half of π r² l
    628.318531
    """
    ground = ground_surface(profile, centre, (radius, radius))
    s, share = np.polynomial.legendre.leggauss(4)
    middle, radii = (centre[0], 0.0, centre[1]), (radius, length / 2.0, radius)
    return _columns(
        ground, middle, radii, np.ones(4), s, share, unit_weight_kn_m3, count, bulges=False
    )


def fellenius(
    columns: Columns,
    cohesion_kpa: float,
    friction_angle_deg: float,
    direction: ArrayLike,
    axis_point: ArrayLike,
    seismic: float = 0.0,
) -> float | None:
    """Return the factor of safety without forces between columns, None where nothing drives the mass along d.

    Parameters
    ----------
    direction : (2,) d in plan; axis_point : (3,) not used; seismic : along d, part of the weight

    Formula: F = Σ(cA + (N - uA) tan φ) / Σ W (sin α + k cos α), N = W (n_z - k n·d), A = plan area / n_z.
    """
    base = _Base.from_columns(columns, direction, axis_point)
    normal = columns.weights * (base.up - seismic * base.along)
    driving = float((columns.weights * (base.sin + seismic * base.cos)).sum())
    if driving <= SMALL * float(columns.weights.sum()):
        return None
    tangent = math.tan(math.radians(friction_angle_deg))
    return float((cohesion_kpa * base.area + (normal - base.pore) * tangent).sum()) / driving


def janbu(
    columns: Columns,
    cohesion_kpa: float,
    friction_angle_deg: float,
    direction: ArrayLike,
    axis_point: ArrayLike,
    seismic: float = 0.0,
) -> float | None:
    """Return the factor of safety from horizontal equilibrium along d, horizontal forces between columns (no f₀).

    Parameters and None as for `bishop`; axis_point : not used.

    Formula: F = Σ(cA + (N - uA) tan φ) cos α / (Σ N n·d + k ΣW).
    """
    base = _Base.from_columns(columns, direction, axis_point)
    push = seismic * float(columns.weights.sum())
    return _vertical_balance(
        base, columns, cohesion_kpa, friction_angle_deg, base.cos, base.along, push
    )


def bishop(
    columns: Columns,
    cohesion_kpa: float,
    friction_angle_deg: float,
    direction: ArrayLike,
    axis_point: ArrayLike,
    seismic: float = 0.0,
) -> float | None:
    """Return the factor of safety from moments about the horizontal axis through `axis_point` normal to d.

    Parameters
    ----------
    direction : (2,) d in plan; axis_point : (3,) m; seismic : along d, part of the weight, at mid-height of a column

    None where nothing drives the mass along d, or where a base climbs so steeply against it that friction takes more
    than 0.8 of N's hold on the column, n_z + sin α tan φ / F < 0.2 n_z: there N, and F with it, goes out of bounds.

    Formula: F = Σ ρ (cA + (N - uA) tan φ) / Σ(-W ξ - k W ζ_m + N (ξ n_z - ζ n·d)), ρ = -ζ cos α - ξ sin α;
    N = (W - (cA - uA tan φ) sin α / F) / (n_z + sin α tan φ / F); ξ along d and ζ up, from the axis.
    """
    base = _Base.from_columns(columns, direction, axis_point)
    middle = base.rise + columns.column_heights / 2.0
    push = -float((columns.weights * (base.reach + seismic * middle)).sum())
    lever = -base.rise * base.cos - base.reach * base.sin
    turning = base.reach * base.up - base.rise * base.along
    return _vertical_balance(base, columns, cohesion_kpa, friction_angle_deg, lever, turning, push)


@dataclass(frozen=True)
class _Base:
    """The bases of columns in the direction d: normals, apparent dips, areas, and positions relative to the axis."""

    area: Floats
    pore: Floats
    along: Floats
    up: Floats
    sin: Floats
    cos: Floats
    reach: Floats
    rise: Floats

    @staticmethod
    def from_columns(columns: Columns, direction: ArrayLike, axis_point: ArrayLike) -> "_Base":
        d = np.asarray(direction, dtype=np.float64)
        d = d / math.hypot(*d)
        along, up = columns.base_normals[:, :2] @ d, columns.base_normals[:, 2]
        length = np.hypot(along, up)
        area = columns.plan_areas / up
        arms = columns.base_points - np.asarray(axis_point, dtype=np.float64)
        return _Base(
            area,
            columns.pore_pressure * area,
            along,
            up,
            along / length,
            up / length,
            arms[:, :2] @ d,
            arms[:, 2],
        )


def _vertical_balance(
    base: _Base,
    columns: Columns,
    cohesion: float,
    friction_angle: float,
    shear: Floats,
    normal: Floats,
    push: float,
) -> float | None:
    """Return F from Σ shear·S = Σ normal·N + push, N from vertical equilibrium of columns: Newton's method on 1 / F."""
    tangent = math.tan(math.radians(friction_angle))
    bond = cohesion * base.area - base.pore * tangent
    strength, step = (
        0.0,
        0.0,
    )  # 1 / F from 0 upward: the sum is concave, so that no step passes the root
    for _ in range(_MAX_STEPS):
        grip = base.up + base.sin * tangent * strength
        if not (grip > 0.0).all():
            step /= 2.0
            strength -= step
            continue
        n = (columns.weights - bond * base.sin * strength) / grip
        slope = -base.sin * (bond + n * tangent) / grip
        resisting = float((shear * (bond + n * tangent)).sum())
        driving = float((normal * n).sum()) + push
        if strength == 0.0 and driving <= SMALL * (float(np.abs(normal * n).sum()) + abs(push)):
            return None
        if strength == 0.0 and resisting == 0.0:
            return 0.0
        rise = resisting + float(((strength * tangent * shear - normal) * slope).sum())
        if not rise > 0.0:
            return None
        step = (driving - strength * resisting) / rise
        strength += step
        if abs(step) <= SMALL * strength:
            return 1.0 / float(strength) if (grip >= LEAST_GRIP * base.up).all() else None
    return None


def _changes(ground: Floats) -> Floats:
    """Return the radii at which the columns of a slice change: those of the circle, at its width, at its mid-height."""
    start, end = ground[:-1], ground[1:]
    through = start[:, 1] * end[:, 1] < 0.0
    (x, z), (right, top) = start[through].T, end[through].T
    wide = np.abs(np.concatenate([ground[:, 0], x - z * (right - x) / (top - z)]))
    return np.unique(np.concatenate([changes(ground), wide[wide <= 1.0]]))


def _columns(
    ground: Floats,
    centre: Sequence[float],
    radii: Sequence[float],
    r: Floats,
    s: Floats,
    share: Floats,
    unit_weight: float,
    count: int,
    bulges: bool = True,
) -> Columns:
    """Return the columns on slices of radius r (n,) at s (n,), in units of the radii.

    bulges : whether the surface narrows along y
    """
    start, segment = ground[:-1, 0], np.diff(ground[:, 0])
    x = (start[:, None] + crossings(ground, r) * segment[:, None]).reshape(len(r), -1)
    x = np.concatenate([x, np.tile(ground[:, 0], (len(r), 1))], axis=1) / r[:, None]
    ends = np.sort(
        np.concatenate(
            [np.arcsin(np.clip(x, -1.0, 1.0)), np.full((len(r), 1), math.pi / 2)], axis=1
        )
    )
    ends = np.concatenate([np.full((len(r), 1), -math.pi / 2), ends], axis=1)
    node, weight = np.polynomial.legendre.leggauss(count)
    width = np.diff(ends)[..., None]
    theta = ends[:, :-1, None] + width * 0.5 * (node + 1.0)
    plan = share[:, None, None] * width * 0.5 * weight * r[:, None, None] * np.cos(theta)
    x, half = r[:, None, None] * np.sin(theta), r[:, None, None] * np.cos(theta)
    roof = np.minimum(height_of_ground(ground, x), half)
    keep = (roof > -half) & (plan > 0.0)
    height, x, z = (roof + half)[keep], x[keep], -half[keep]
    y = np.broadcast_to(s[:, None, None], half.shape)[keep]
    plan_areas = plan[keep] * radii[0] * radii[1]
    if not plan_areas.size:
        raise GeometryError([Fault("E214", "the slip surface encloses none of the ground")])
    normals = -np.stack([x / radii[0], (y if bulges else 0.0 * y) / radii[1], z / radii[2]], axis=1)
    normals /= np.sqrt((normals**2).sum(axis=1))[:, None]
    points = np.asarray(centre, dtype=np.float64) + np.stack([x, y, z], axis=1) * np.asarray(
        radii, dtype=np.float64
    )
    heights = height * radii[2]
    weights = unit_weight * heights * plan_areas
    return Columns(
        points,
        normals,
        plan_areas,
        weights,
        np.zeros_like(weights),
        heights,
        float(weights[height_of_ground(ground, x) > -z].sum() / weights.sum()),
    )
