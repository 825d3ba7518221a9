"""Methods of columns in 3-D: Fellenius, Janbu (simplified), Bishop, and one that satisfies all six equilibria.

Sources: Fellenius (1936); Janbu (1954); Bishop (1955), Géotechnique 5; in 3-D Hovland (1977), J. Geotech. Eng. Div.
103 (GT9), and Hungr, Salgado & Byrne (1989), Can. Geotech. J. 26; the global method Bell (1968), J. Soil Mech. Found.
Div. 94 (SM6), Zhu & Qian (2007), Chinese J. Rock Mech. Eng. 26 (8), and Zheng (2009), J. Geotech. Geoenviron. Eng. 135.

The columns stand on the nodes of Gauss's rule (slices square to y, angles within a slice), not on a grid: some
thousand give five digits, also where the margins of the surface are upright.

Signs: base normals point up into the mass, N and pore pressure are positive in compression; α is the apparent dip of
a base along the direction of sliding d, tan α = n·d / n_z, and shear acts in the vertical plane through d.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np

from slopekit.closed_form.rotation import GroundSurface, panels
from slopekit.closed_form.tolerances import BALANCED, LEAST_GRIP, SMALL
from slopekit.core.array_types import ArrayLike, Floats
from slopekit.core.errors import Fault, GeometryError
from slopekit.core.records import dataclass

_COUNT = 12  # nodes between two changes, in either direction
_PASSES = 200
_STEPS = 60
_STARTS = tuple((strength, turn) for turn in (0.0, 0.4, -0.4) for strength in (1.0, 0.6, 1.6))  # 1 / F, θ


@dataclass(frozen=True, slots=True)
class Columns:
    """The mass above a slip surface as vertical columns.

    Attributes
    ----------
    base_points : (n, 3) m; base_normals : (n, 3) unit, upward; plan_areas : (n,) m²
    weights : (n,) kN; pore_pressure : (n,) kPa on the base; column_heights : (n,) m
    overhung_share : part of the weight that has slip surface above it, too; that surface has no columns, no strength
    """

    base_points: Floats
    base_normals: Floats
    plan_areas: Floats
    weights: Floats
    pore_pressure: Floats
    column_heights: Floats
    overhung_share: float = 0.0


@dataclass(frozen=True, slots=True)
class AllEquilibrium:
    """What the method with all six equilibria found.

    Attributes
    ----------
    factor : factor of safety; turned_deg : from d to the direction of shear, counterclockwise from above
    shares : (λ₀, λ₁, λ₂, λ₃) of σ = σ₀ (λ₀ + λ₁ ξ + λ₂ η + λ₃ ξη); tension_share : of the base, where σ - u < 0
    residual : largest of the six sums, as part of the weight (moments: of weight times half the length)
    """

    factor: float
    turned_deg: float
    shares: tuple[float, float, float, float]
    tension_share: float
    residual: float


def ellipsoid_columns(
    centre: Sequence[float],
    radii: Sequence[float],
    profile: ArrayLike,
    unit_weight_kn_m3: float,
    count: int = _COUNT,
) -> Columns:
    """Columns of the ground within an ellipsoid with axes along x, y and z.

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
    ground = GroundSurface.of(profile, (centre[0], centre[2]), (radii[0], radii[2]))
    t, share = panels(np.arccos(_changes(ground)), count)
    t, share = np.concatenate([t, -t]), np.concatenate([share, share])
    return _columns(ground, centre, radii, np.cos(t), np.sin(t), share * np.cos(t), unit_weight_kn_m3, count)


def cylinder_columns(
    centre: Sequence[float],
    radius: float,
    length: float,
    profile: ArrayLike,
    unit_weight_kn_m3: float,
    count: int = 2 * _COUNT,
) -> Columns:
    """Columns of the ground within a level cylinder along y, from -length / 2 to length / 2; its ends carry nothing.

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
    ground = GroundSurface.of(profile, centre, (radius, radius))
    s, share = np.polynomial.legendre.leggauss(4)
    middle, radii = (centre[0], 0.0, centre[1]), (radius, length / 2.0, radius)
    return _columns(ground, middle, radii, np.ones(4), s, share, unit_weight_kn_m3, count, bulges=False)


def fellenius(
    columns: Columns, cohesion_kpa: float, friction_angle_deg: float, direction: ArrayLike, axis_point: ArrayLike,
    seismic: float = 0.0,
) -> float | None:  # fmt: skip
    """Factor of safety with no forces between columns, None where nothing drives the mass along d.

    Parameters
    ----------
    direction : (2,) d in plan; axis_point : (3,) not used; seismic : along d, part of the weight

    Formula: F = Σ(cA + (N - uA) tan φ) / Σ W (sin α + k cos α), N = W (n_z - k n·d), A = plan area / n_z.
    """
    base = _Base.of(columns, direction, axis_point)
    normal = columns.weights * (base.up - seismic * base.along)
    driving = float((columns.weights * (base.sin + seismic * base.cos)).sum())
    if driving <= SMALL * float(columns.weights.sum()):
        return None
    tangent = math.tan(math.radians(friction_angle_deg))
    return float((cohesion_kpa * base.area + (normal - base.pore) * tangent).sum()) / driving


def janbu(
    columns: Columns, cohesion_kpa: float, friction_angle_deg: float, direction: ArrayLike, axis_point: ArrayLike,
    seismic: float = 0.0,
) -> float | None:  # fmt: skip
    """Factor of safety from horizontal forces along d, level forces between columns (simplified, no f₀).

    Parameters and None as for `bishop`; axis_point : not used.

    Formula: F = Σ(cA + (N - uA) tan φ) cos α / (Σ N n·d + k ΣW).
    """
    base = _Base.of(columns, direction, axis_point)
    push = seismic * float(columns.weights.sum())
    return _vertical_balance(base, columns, cohesion_kpa, friction_angle_deg, base.cos, base.along, push)


def bishop(
    columns: Columns, cohesion_kpa: float, friction_angle_deg: float, direction: ArrayLike, axis_point: ArrayLike,
    seismic: float = 0.0,
) -> float | None:  # fmt: skip
    """Factor of safety from moments about the level axis through `axis_point` square to d (simplified).

    Parameters
    ----------
    direction : (2,) d in plan; axis_point : (3,) m; seismic : along d, part of the weight, at mid-height of a column

    None where nothing drives the mass along d, or where a base climbs so steeply against it that friction takes more
    than 0.8 of N's hold on the column, n_z + sin α tan φ / F < 0.2 n_z: there N, and F with it, goes out of bounds.

    Formula: F = Σ ρ (cA + (N - uA) tan φ) / Σ(-W ξ - k W ζ_m + N (ξ n_z - ζ n·d)), ρ = -ζ cos α - ξ sin α;
    N = (W - (cA - uA tan φ) sin α / F) / (n_z + sin α tan φ / F); ξ along d and ζ up, from the axis.
    """
    base = _Base.of(columns, direction, axis_point)
    middle = base.rise + columns.column_heights / 2.0
    push = -float((columns.weights * (base.reach + seismic * middle)).sum())
    lever = -base.rise * base.cos - base.reach * base.sin
    turning = base.reach * base.up - base.rise * base.along
    return _vertical_balance(base, columns, cohesion_kpa, friction_angle_deg, lever, turning, push)


def global_equilibrium(
    columns: Columns, cohesion_kpa: float, friction_angle_deg: float, direction: ArrayLike, axis_point: ArrayLike,
    seismic: float = 0.0,
) -> AllEquilibrium | None:  # fmt: skip
    """Three forces and three moments of the whole mass balanced by F, the direction of shear and four shares of σ.

    Parameters as for `bishop`; axis_point : not used. Of several roots the one with the least base in tension; None
    where Newton's method finds none (there may be none: one direction of shear balances no torsion about its normal).

    Formula: Σ(N n - S s + W (k d - e_z)) = 0 and its moments, N = σA, σ = σ₀ (λ₀ + λ₁ ξ + λ₂ η + λ₃ ξη) with
    σ₀ = W (n_z - k n·d) / A, S = (cA + (N - uA) tan φ) / F, s down the base, turned in plan by θ from d; ξ along d
    and η across it, from the middle of the mass, as parts of half its length (Bell 1968; Zhu & Qian 2007).
    The shape of σ is an assumption: six equilibria leave F open within some ten percent, so that F is no bound.
    """
    d = np.asarray(direction, dtype=np.float64)
    d = d / math.hypot(*d)
    area = columns.plan_areas / columns.base_normals[:, 2]
    tangent = math.tan(math.radians(friction_angle_deg))
    weight = float(columns.weights.sum())
    middle = columns.weights @ columns.base_points / weight
    size = float(np.ptp(columns.base_points[:, :2] @ d)) / 2.0
    away = (columns.base_points - middle) / size
    xi, eta = away[:, :2] @ d, away[:, :2] @ [-d[1], d[0]]
    start = columns.weights * (columns.base_normals[:, 2] - seismic * (columns.base_normals[:, :2] @ d))
    normal = (start * np.stack([np.ones_like(xi), xi, eta, xi * eta])).T / weight  # (n, 4) parts of N
    bond = (cohesion_kpa - columns.pore_pressure * tangent) * area / weight
    pushes = np.outer(columns.weights / weight, [seismic * d[0], seismic * d[1], -1.0])
    raised = away + np.outer(columns.column_heights / (2.0 * size), [0.0, 0.0, 1.0])
    loads = np.concatenate([pushes.sum(axis=0), np.cross(raised, pushes).sum(axis=0)])
    upward, at = np.array(columns.base_normals.T, order="C"), np.array(away.T, order="C")
    pressed = _six(upward, at, normal)  # (6, 4)
    sizes = np.column_stack([bond, normal])

    def residual(unknowns: Floats) -> tuple[Floats, Floats]:
        """The six sums (6,), and their slopes (6, 6) by 1 / F, θ and the shares."""
        strength, turn, shares = unknowns[0], unknowns[1], unknowns[2:]
        down, turned = _down(upward, d, turn)
        resisting = bond + tangent * (normal @ shares)
        sizes[:, 0] = resisting
        sums = _six(down, at, sizes)
        held, rows = sums[:, 0], pressed - strength * tangent * sums[:, 1:]
        slopes = np.column_stack([-held, -strength * _six(turned, at, resisting), rows])
        return pressed @ shares - strength * held + loads, slopes

    best: AllEquilibrium | None = None
    for strength, turn in _STARTS:
        root, error = _newton(residual, np.array([strength, turn, 1.0, 0.0, 0.0, 0.0]))
        if error > BALANCED or not root[0] > 0.0 or abs(root[1]) > math.pi / 2:
            continue
        tension = normal @ root[2:] * weight < columns.pore_pressure * area
        share = float(area[tension].sum() / area.sum())
        if best is None or share < best.tension_share:
            l0, l1, l2, l3 = (float(part) for part in root[2:])
            best = AllEquilibrium(1.0 / float(root[0]), math.degrees(root[1]), (l0, l1, l2, l3), share, error)
        if best.tension_share == 0.0:
            break
    return best


def _six(vectors: Floats, at: Floats, sizes: Floats) -> Floats:
    """Sums of the forces `sizes` (n,) or (n, m) along `vectors` (3, n) and of their moments: (6,) or (6, m)."""
    (x, y, z), (along_x, along_y, along_z) = at, vectors
    moments = y * along_z - z * along_y, z * along_x - x * along_z, x * along_y - y * along_x
    return np.stack([*vectors, *moments]) @ sizes


def _down(normals: Floats, d: Floats, turn: float) -> tuple[Floats, Floats]:
    """Unit vectors down the bases in the upright plane turned from d, and their change with the turn (3, n).

    normals : (3, n)
    """
    x, y = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]]) @ d
    up = normals[2]
    along, across = x * normals[0] + y * normals[1], x * normals[1] - y * normals[0]
    length = np.hypot(along, up)
    down = np.stack([x * up, y * up, -along]) / length
    change = np.stack([-y * up, x * up, -across]) / length
    return down, change - down * (along * across / length**2)


def _newton(residual: Callable[[Floats], tuple[Floats, Floats]], unknowns: Floats) -> tuple[Floats, float]:
    """Newton's method with halved steps: the unknowns, and the largest sum that is left."""
    sums, slopes = residual(unknowns)
    for _ in range(_STEPS):
        if float(np.abs(sums).max()) <= SMALL:
            break
        step = np.linalg.lstsq(slopes, -sums, rcond=None)[0]
        part = 1.0
        while part > SMALL:
            tried = unknowns + part * step
            after, after_slopes = residual(tried)
            if float(after @ after) < (1.0 - 1e-4 * part) * float(sums @ sums):
                break
            part /= 2.0
        else:
            break
        unknowns, sums, slopes = tried, after, after_slopes
    return unknowns, float(np.abs(sums).max())


@dataclass(frozen=True, slots=True)
class _Base:
    """Bases seen along d: normals, apparent dips, areas, and where they are from the axis."""

    area: Floats
    pore: Floats
    along: Floats
    up: Floats
    sin: Floats
    cos: Floats
    reach: Floats
    rise: Floats

    @staticmethod
    def of(columns: Columns, direction: ArrayLike, axis_point: ArrayLike) -> "_Base":
        d = np.asarray(direction, dtype=np.float64)
        d = d / math.hypot(*d)
        along, up = columns.base_normals[:, :2] @ d, columns.base_normals[:, 2]
        length = np.hypot(along, up)
        area = columns.plan_areas / up
        away = columns.base_points - np.asarray(axis_point, dtype=np.float64)
        return _Base(
            area, columns.pore_pressure * area, along, up, along / length, up / length, away[:, :2] @ d, away[:, 2]
        )


def _vertical_balance(
    base: _Base, columns: Columns, cohesion: float, friction_angle: float, shear: Floats, normal: Floats, push: float
) -> float | None:
    """F from Σ shear·S = Σ normal·N + push, N from the vertical forces on each column: Newton's method on 1 / F."""
    tangent = math.tan(math.radians(friction_angle))
    bond = cohesion * base.area - base.pore * tangent
    strength, step = 0.0, 0.0  # 1 / F from nothing upward: the sum is concave, so that no step passes the root
    for _ in range(_PASSES):
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


def _changes(ground: GroundSurface) -> Floats:
    """Radii at which the columns of a slice change their kind: as for the circle, at its width, at its mid-height."""
    start, end = ground.points[:-1], ground.points[1:]
    through = start[:, 1] * end[:, 1] < 0.0
    (x, z), (right, top) = start[through].T, end[through].T
    wide = np.abs(np.concatenate([ground.points[:, 0], x - z * (right - x) / (top - z)]))
    return np.unique(np.concatenate([ground.changes(), wide[wide <= 1.0]]))


def _columns(
    ground: GroundSurface, centre: Sequence[float], radii: Sequence[float], r: Floats, s: Floats, share: Floats,
    unit_weight: float, count: int, bulges: bool = True,
) -> Columns:  # fmt: skip
    """Columns on slices of radius r (n,) at s (n,), as parts of the radii; `bulges`: the surface narrows along y."""
    meet = ground.crossings(r)
    start, way = ground.points[:-1, 0], np.diff(ground.points[:, 0])
    x = (start[:, None] + meet * way[:, None]).reshape(len(r), -1)
    x = np.concatenate([x, np.tile(ground.points[:, 0], (len(r), 1))], axis=1) / r[:, None]
    ends = np.sort(np.concatenate([np.arcsin(np.clip(x, -1.0, 1.0)), np.full((len(r), 1), math.pi / 2)], axis=1))
    ends = np.concatenate([np.full((len(r), 1), -math.pi / 2), ends], axis=1)
    node, weight = np.polynomial.legendre.leggauss(count)
    width = np.diff(ends)[..., None]
    theta = ends[:, :-1, None] + width * 0.5 * (node + 1.0)
    plan = share[:, None, None] * width * 0.5 * weight * r[:, None, None] * np.cos(theta)
    x, half = r[:, None, None] * np.sin(theta), r[:, None, None] * np.cos(theta)
    roof = np.minimum(ground.height(x), half)
    keep = (roof > -half) & (plan > 0.0)
    height, x, z = (roof + half)[keep], x[keep], -half[keep]
    y = np.broadcast_to(s[:, None, None], half.shape)[keep]
    plan_areas = plan[keep] * radii[0] * radii[1]
    if not plan_areas.size:
        raise GeometryError([Fault("E214", "the slip surface encloses none of the ground")])
    normals = -np.stack([x / radii[0], (y if bulges else 0.0 * y) / radii[1], z / radii[2]], axis=1)
    normals /= np.sqrt((normals**2).sum(axis=1))[:, None]
    points = np.asarray(centre, dtype=np.float64) + np.stack([x, y, z], axis=1) * np.asarray(radii, dtype=np.float64)
    heights = height * radii[2]
    weights = unit_weight * heights * plan_areas
    under = ground.height(x) > -z
    return Columns(
        points, normals, plan_areas, weights, np.zeros_like(weights), heights,
        float(weights[under].sum() / weights.sum()),
    )  # fmt: skip
