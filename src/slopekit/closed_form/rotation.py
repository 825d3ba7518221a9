"""Rotation of a purely cohesive mass (φ = 0) on a surface of revolution about a horizontal axis: exact.

The normal stresses have no moment about the axis and give no strength, so moment equilibrium alone settles the
factor. Sources: Fröhlich's and Fellenius' slip circle with φ = 0; in 3-D Baligh & Azzouz (1975), J. Geotech. Eng.
Div. 101 (GT11), and Gens, Hutchinson & Cavounidis (1988), Géotechnique 38; the sphere of Hungr, Salgado & Byrne
(1989), Can. Geotech. J. 26, in the tests.

Slices square to the axis have exact areas and moments (Green's theorem over arcs and ground segments); Gauss's rule
adds them up between the places where a slice changes its kind.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from slopekit.closed_form.tolerances import ON_CIRCLE, SMALL
from slopekit.core.array_types import ArrayLike, Floats
from slopekit.core.errors import Fault, GeometryError

_NODES = 16  # slices between two changes of kind


@dataclass(frozen=True)
class ClosedFormRotation:
    """The closed form of a mass that rotates about the axis of its slip surface.

    Attributes
    ----------
    factor : factor of safety, None without a driving moment; status : rotates or no_driving_force
    volume_m3 : m³; area_m2 : of slip surface, m²
    driving_moment_knm, resisting_moment_knm : kN m about the axis; driving is positive where the base moves toward x
    """

    factor: float | None
    status: str
    volume_m3: float
    area_m2: float
    driving_moment_knm: float
    resisting_moment_knm: float


def rotational_failure(
    centre: Sequence[float],
    radius: float,
    half_width: float,
    profile: ArrayLike,
    cohesion_kpa: float,
    unit_weight_kn_m3: float,
    shape: str = "ellipsoid",
    seismic: float = 0.0,
) -> ClosedFormRotation:
    """Return the factor of safety of the ground within a surface of revolution about the line through `centre` along y.

    Parameters
    ----------
    centre : (3,) m; radius : m, in x and z; half_width : m, along y (the radius for a sphere)
    profile : (k, 2) x and z of the ground surface, m; level beyond its ends
    shape : ellipsoid (a sphere is one) or cylinder
    seismic : horizontal, toward x, fraction of the weight

    All of the surface below the ground shears, where it hangs over too; the two ends of a cylinder do not. Several
    pieces of ground within the surface count as one body.

    Raises
    ------
    GeometryError
        E214 the surface encloses no ground, E218 the profile turns back.

    Formula: F = c ∫ρ dA / |M|, M = γ ∫(x_c - x + k (z_c - z)) dV, ρ the distance from the axis.

    >>> ball = rotational_failure((0, 0, 0), 10, 10, [(-20, 10), (20, -10)], 20, 20)
    >>> ball.status, round(ball.factor, 4)
    ('rotates', 1.405)
    """
    ground = ground_surface(profile, (centre[0], centre[2]), (radius, radius))
    if shape == "cylinder":
        nodes, along, across = np.zeros(1), np.array([half_width]), np.array([half_width])
    else:
        nodes, weights = panels(np.arccos(changes(ground)), _NODES)
        along = half_width * np.cos(nodes) * weights
        across = np.hypot(radius * np.sin(nodes), half_width * np.cos(nodes)) * weights
    r = np.cos(nodes)
    angle, area, moment_x, moment_z = _slices(ground, r)
    volume = 2.0 * float(along @ area) * radius**2
    surface = 2.0 * float(across @ (r * angle)) * radius
    if not volume > SMALL * radius**2 * half_width:
        raise GeometryError([Fault("E214", "the slip surface encloses none of the ground")])
    resisting = 2.0 * cohesion_kpa * float(across @ (r * r * angle)) * radius**2
    driving = -2.0 * unit_weight_kn_m3 * float(along @ (moment_x + seismic * moment_z)) * radius**3
    if abs(driving) <= SMALL * unit_weight_kn_m3 * volume * radius:
        return ClosedFormRotation(None, "no_driving_force", volume, surface, driving, resisting)
    return ClosedFormRotation(
        resisting / abs(driving), "rotates", volume, surface, driving, resisting
    )


def ground_surface(profile: ArrayLike, centre: Sequence[float], radii: Sequence[float]) -> Floats:
    """Return the ground surface as points (k, 2), scaled so that an ellipse becomes the unit circle about the origin.

    They run from left to right, level beyond the circle; the profile (k, 2) in m is listed in either direction.

    Raises
    ------
    GeometryError
        E218 the profile turns back: it gives no height of the ground at each x.
    """
    points = np.array(profile, dtype=np.float64).reshape(-1, 2)
    steps = np.diff(points[:, 0])
    if (steps < 0.0).any() and (steps > 0.0).any():
        advice = "Closed forms of slip surfaces need one height of the ground at each x."
        raise GeometryError([Fault("E218", "the slope profile turns back on itself", "", advice)])
    points = (points[::-1] if (steps < 0.0).any() else points) - np.asarray(
        centre, dtype=np.float64
    )
    points = points / np.asarray(radii, dtype=np.float64)
    points = points[np.append(True, (np.diff(points, axis=0) != 0.0).any(axis=1))]
    first_point, last_point = (
        (min(points[0, 0], -1.0) - 1.0, points[0, 1]),
        (max(points[-1, 0], 1.0) + 1.0, points[-1, 1]),
    )
    return np.vstack([first_point, points, last_point])


def height_of_ground(ground: Floats, x: Floats) -> Floats:
    """Return the height of the ground at x (any shape)."""
    return np.interp(x, ground[:, 0], ground[:, 1])


def changes(ground: Floats) -> Floats:
    """Return the radii at which a circle meets a corner or touches the ground, and 0 and 1: slices change there."""
    start, segment = ground[:-1], np.diff(ground, axis=0)
    square = (segment * segment).sum(axis=1)
    nearest = np.clip(-(start * segment).sum(axis=1) / square, 0.0, 1.0)
    feet = start + nearest[:, None] * segment
    radii = np.concatenate([[0.0, 1.0], np.hypot(*feet.T), np.hypot(*ground.T)])
    return np.unique(radii[radii <= 1.0])


def crossings(ground: Floats, r: Floats) -> Floats:
    """Return where circles of radius r (n,) meet the segments: (n, k - 1, 2) fractions of a segment, 0 to 1."""
    start, segment = ground[:-1], np.diff(ground, axis=0)
    square = (segment * segment).sum(axis=1)
    foot = -(start * segment).sum(axis=1) / square
    squared_distance = ((start + foot[:, None] * segment) ** 2).sum(axis=1)
    half = np.sqrt(np.maximum(r[:, None] ** 2 - squared_distance, 0.0) / square)
    shares: Floats = np.clip(np.stack([foot - half, foot + half], axis=-1), 0.0, 1.0)
    return shares


def panels(ends: Floats, count: int) -> tuple[Floats, Floats]:
    """Return nodes and weights of Gauss's rule between `ends`, concentrated at each end for square roots there.

    >>> nodes, weights = panels(np.array([0.0, 1.0]), 16)
    >>> round(float(weights @ np.sqrt(nodes)), 12)
    0.666666666667
    """
    ends = np.unique(ends)
    u, weight = np.polynomial.legendre.leggauss(count)
    u = 0.5 * (u + 1.0)
    stretched, slope = u * u * (3.0 - 2.0 * u), 3.0 * u * (1.0 - u) * weight
    width = np.diff(ends)[:, None]
    return (ends[:-1, None] + width * stretched).ravel(), (width * slope).ravel()


def _slices(ground: Floats, r: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Return, of circles of radius r (n,), the angle below the ground, and the area and first moments below it."""
    start, segment = ground[:-1], np.diff(ground, axis=0)
    ends = start[:, None, :] + crossings(ground, r)[..., None] * segment[:, None, :]
    x, z = ends[..., 0], ends[..., 1]
    # the ground within the circle, from right to left, then the arcs below the ground: counterclockwise
    area = 0.5 * (x[..., 1] * z[..., 0] - x[..., 0] * z[..., 1])
    moment_x = (z[..., 0] - z[..., 1]) * ((x**2).sum(axis=-1) + x.prod(axis=-1)) / 6.0
    moment_z = (x[..., 1] - x[..., 0]) * ((z**2).sum(axis=-1) + z.prod(axis=-1)) / 6.0
    on_circle = (
        np.abs(np.hypot(x, z) - r[:, None, None]) <= ON_CIRCLE
    )  # corners on the circle among them
    arc_ends = np.where(on_circle, np.arctan2(z, x), math.pi).reshape(len(r), -1)
    arc_ends = np.concatenate(
        [np.full((len(r), 1), -math.pi), np.sort(arc_ends, axis=1), np.full((len(r), 1), math.pi)],
        axis=1,
    )
    middle = 0.5 * (arc_ends[:, 1:] + arc_ends[:, :-1])
    below = r[:, None] * np.sin(middle) < height_of_ground(ground, r[:, None] * np.cos(middle))
    angle = (below * np.diff(arc_ends, axis=1)).sum(axis=1)
    arc_x = np.sin(arc_ends) - np.sin(arc_ends) ** 3 / 3.0
    arc_z = np.cos(arc_ends) ** 3 / 3.0 - np.cos(arc_ends)
    return (
        angle,
        area.sum(axis=1) + 0.5 * r**2 * angle,
        moment_x.sum(axis=1) + 0.5 * r**3 * (below * np.diff(arc_x, axis=1)).sum(axis=1),
        moment_z.sum(axis=1) + 0.5 * r**3 * (below * np.diff(arc_z, axis=1)).sum(axis=1),
    )
