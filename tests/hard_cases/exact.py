"""Closed forms in 50 digits, as the reference of the hard cases; they share no line with slopekit.

Wedge: Goodman & Shi (1985), Block Theory, ch. 9 (the mode of sliding from the resultant), Hoek & Bray (1981), ch. 8
(water, F). Plane: Hoek & Bray (1981), ch. 7; Wyllie & Mah (2004), ch. 6. Columns: Goodman & Bray (1976). Block on an
incline: Hoek & Bray (1981), ch. 2. Sphere with φ = 0: Hungr, Salgado & Byrne (1989). Corners come from 3 by 3 systems
of plane equations, modes from trying each of them: another way than that of `slopekit.closed_form`.

Every number is taken as the float it is, so the reference answers the very input that slopekit gets.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from mpmath.ctx_mp import MPContext

mp = MPContext()
mp.dps = 50
#: What 50 digits leave of nothing, in parts of the load.
NOTHING = mp.mpf(10) ** -40
Number = Any  # an mpf


@dataclass(frozen=True)
class Exact:
    """An answer in 50 digits: the status in slopekit's words; factor None where it has none, 0 without strength.

    Forces in kN; `contact` are the names of the planes in contact, `normal` the force on each of them.
    """

    status: str
    factor: Number | None
    contact: tuple[str, ...] = ()
    normal: tuple[Number, ...] = ()
    driving: Number = None
    volume: Number = None
    areas: tuple[Number, ...] = ()
    total_height: Number = None
    weight: Number = None
    corners: tuple[Any, ...] = ()

    @property
    def as_float(self) -> float | None:
        """The factor as slopekit shows it: no number without strength."""
        return None if not self.factor else float(self.factor)


def sine(degrees: float) -> Number:
    """Sine of an angle in degrees."""
    return mp.sin(mp.mpf(degrees) * mp.pi / 180)


def cosine(degrees: float) -> Number:
    """Cosine of an angle in degrees."""
    return mp.cos(mp.mpf(degrees) * mp.pi / 180)


def tangent(degrees: float) -> Number:
    """Tangent of an angle in degrees."""
    return sine(degrees) / cosine(degrees)


def plane_normal(plane: Sequence[float]) -> list[Number]:
    """Upward normal of (dip, dip direction): east, north, up."""
    dip, direction = plane
    return [sine(dip) * sine(direction), sine(dip) * cosine(direction), cosine(dip)]


def line_vector(trend: float, plunge: float) -> list[Number]:
    """Unit vector of a line by trend and plunge (down: +)."""
    return [cosine(plunge) * sine(trend), cosine(plunge) * cosine(trend), -sine(plunge)]


def dot(a: Sequence[Number], b: Sequence[Number]) -> Number:
    """Scalar product."""
    return mp.fsum(x * y for x, y in zip(a, b, strict=True))


def cross(a: Sequence[Number], b: Sequence[Number]) -> list[Number]:
    """Vector product."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def length(a: Sequence[Number]) -> Number:
    """Length of a vector."""
    return mp.sqrt(dot(a, a))


def less(a: Sequence[Number], b: Sequence[Number]) -> list[Number]:
    """Difference of two vectors."""
    return [x - y for x, y in zip(a, b, strict=True)]


def corner(planes: Sequence[tuple[Sequence[Number], Number]]) -> list[Number]:
    """Where three planes n·x = d meet."""
    return list(
        mp.lu_solve(mp.matrix([list(n) for n, _ in planes]), mp.matrix([d for _, d in planes]))
    )


def wedge(
    dips: Sequence[Sequence[float]],
    face: Sequence[float],
    upper: Sequence[float],
    height: float,
    c: Any,
    phi: Any,
    unit_weight: float,
    *,
    water: Any = None,
    seismic: Any = None,
    forces: Sequence[Any] = (),
    water_unit_weight: float = 9.81,
    **_unused: Any,
) -> Exact:
    """The wedge on two joints; the arguments of `slopekit.wedge`, as numbers.

    Parameters
    ----------
    c, phi : kPa and degrees, one value or one for each joint
    water : mean pressures in kPa on J1 and J2, or a part of full (γ_w H/6, H the total height)
    seismic : coefficient (toward the trend of the line of intersection), or (coefficient, trend)
    forces : (east, north, up) kN, or {"force": kN, "toward": (trend, plunge)}, through the centroid
    """
    n1, n2, nf, nu = (plane_normal(plane) for plane in (*dips, face, upper))
    zero, up = mp.mpf(0), [mp.mpf(0), mp.mpf(0), mp.mpf(1)]
    toe, crest1 = [zero] * 3, corner([(n1, zero), (nf, zero), (up, mp.mpf(height))])
    offset = dot(nu, crest1)
    crest2, back = (corner([(n2, zero), (other, zero), (nu, offset)]) for other in (nf, n1))
    corners = (toe, crest1, crest2, back)
    volume = abs(mp.det(mp.matrix([crest1, crest2, back]))) / 6
    areas = tuple(length(cross(crest, back)) / 2 for crest in (crest1, crest2))
    levels = [point[2] for point in corners]
    total = max(levels) - min(levels)
    inward = [
        n if dot(n, other) > 0 else [-x for x in n] for n, other in ((n1, crest2), (n2, crest1))
    ]
    weight = mp.mpf(unit_weight) * volume
    down = [-x if back[2] > 0 else x for x in back]
    load = [zero, zero, -weight]
    if seismic is not None:
        coefficient, trend = seismic if isinstance(seismic, tuple) else (seismic, None)
        way = [down[0], down[1]] if trend is None else [sine(trend), cosine(trend)]
        size = mp.hypot(*way)
        load = [
            load[0] + mp.mpf(coefficient) * weight * way[0] / size,
            load[1] + mp.mpf(coefficient) * weight * way[1] / size,
            load[2],
        ]
    if water is None:
        pressures = (zero, zero)
    elif isinstance(water, tuple):
        pressures = tuple(mp.mpf(u) for u in water)
    else:
        pressures = (mp.mpf(water) * mp.mpf(water_unit_weight) * total / 6,) * 2
    for pressure, area, n in zip(pressures, areas, inward, strict=True):
        load = [x + pressure * area * y for x, y in zip(load, n, strict=True)]
    for force in forces:
        if isinstance(force, dict):
            force = [mp.mpf(force["force"]) * x for x in line_vector(*force["toward"])]
        load = [x + mp.mpf(y) for x, y in zip(load, force, strict=True)]
    size = (
        weight + mp.fsum(abs(u) * a for u, a in zip(pressures, areas, strict=True)) + length(load)
    )
    status, contact, normal, pull = _mode(load, inward, size)
    driving = length(pull)
    bonds, tangents = _each(c), [tangent(angle) for angle in _each(phi)]
    resisting = mp.fsum(
        mp.mpf(bonds[k]) * areas[k] + normal[at] * tangents[k] for at, k in enumerate(contact)
    )
    slides = status.startswith("slides")
    return Exact(
        status,
        resisting / driving if slides else None,
        tuple(f"J{k + 1}" for k in contact),
        tuple(normal),
        driving,
        volume,
        areas,
        total,
        weight,
        tuple(tuple(point) for point in corners),
    )


def _each(value: Any) -> tuple[float, float]:
    return tuple(value) if isinstance(value, (tuple, list)) else (value, value)


def _mode(
    load: list[Number], inward: list[list[Number]], size: Number
) -> tuple[str, tuple[int, ...], list[Number], list[Number]]:
    """Try each mode: planes that touch carry compression, the pull along them opens those that do not."""
    if length(load) <= NOTHING * size:
        return "no_driving_force", (), [], [mp.mpf(0)] * 3
    for touching in ((), (0,), (1,), (0, 1)):
        planes = [inward[k] for k in touching]
        if len(planes) == 2:
            gram = mp.matrix([[dot(a, b) for b in planes] for a in planes])
            normal = list(mp.lu_solve(gram, mp.matrix([-dot(load, n) for n in planes])))
        else:
            normal = [-dot(load, n) for n in planes]
        pull = load
        for push, n in zip(normal, planes, strict=True):
            pull = [x + push * y for x, y in zip(pull, n, strict=True)]
        others = [inward[k] for k in (0, 1) if k not in touching]
        if all(push > 0 for push in normal) and all(dot(pull, n) >= 0 for n in others):
            if not touching:
                overhangs = max(n[2] for n in inward) <= 0
                return "falls" if overhangs else "lifted", (), [], pull
            if length(pull) <= NOTHING * size:
                return "no_driving_force", touching, normal, pull
            on = "slides_on_both" if len(touching) == 2 else f"slides_on_J{touching[0] + 1}"
            return ("slides_up" if pull[2] > 0 else on), touching, normal, pull
    raise ArithmeticError("no mode of sliding fits: the reference is wrong")


def plane_failure(
    face: float,
    plane: float,
    height: float,
    c: float,
    phi: float,
    unit_weight: float,
    *,
    upper: float = 0.0,
    crack_depth: float | None = None,
    water_depth: float = 0.0,
    pressure: float | None = None,
    seismic: float = 0.0,
    forces: Sequence[Sequence[float]] = (),
    water_unit_weight: float = 9.81,
) -> Exact:
    """Plane failure per metre: dips in degrees, x out of the slope, z up, the toe at 0, 0.

    Parameters
    ----------
    crack_depth : m, of a vertical crack in the upper slope; water_depth : m in it, U = γ_w z_w L/2, V = γ_w z_w²/2
    pressure : kPa, even on the plane, instead of that U; forces : (x, z) kN
    """
    h = mp.mpf(height)
    crest = (-h / tangent(face), h)
    up, slope = tangent(plane), tangent(upper)
    # depth of the plane below the upper slope at x: h - (crest_x - x)·(-slope) - (-x)·up
    behind_full = (h + crest[0] * up) / (up - slope)
    behind = (
        behind_full
        if crack_depth is None
        else (h + crest[0] * up - mp.mpf(crack_depth)) / (up - slope)
    )
    top = (crest[0] - behind, h + behind * slope)
    bottom = (top[0], -top[0] * up)
    outline = [(mp.mpf(0), mp.mpf(0)), crest, top, bottom]
    area = (
        abs(
            mp.fsum(
                a[0] * b[1] - a[1] * b[0]
                for a, b in zip(outline, outline[1:] + outline[:1], strict=True)
            )
        )
        / 2
    )
    long = mp.hypot(*bottom)
    weight = mp.mpf(unit_weight) * area
    s, k = sine(plane), cosine(plane)
    gamma, deep = mp.mpf(water_unit_weight), mp.mpf(water_depth)
    uplift = gamma * deep * long / 2 if pressure is None else mp.mpf(pressure) * long
    x = (
        gamma * deep**2 / 2
        + mp.mpf(seismic) * weight
        + mp.fsum(mp.mpf(force[0]) for force in forces)
    )
    z = -weight + mp.fsum(mp.mpf(force[1]) for force in forces)
    along, normal = x * k - z * s, -(x * s + z * k) - uplift
    return _on_one_plane(along, normal, mp.mpf(c) * long, tangent(phi), area, long, weight)


def _on_one_plane(
    along: Number,
    normal: Number,
    bond: Number,
    friction: Number,
    area: Number,
    long: Number,
    weight: Number,
) -> Exact:
    """One plane, dipping out of the slope: `along` is positive downhill."""
    shape = {"volume": area, "areas": (long,), "weight": weight}
    if normal <= 0:
        return Exact("lifted", None, **shape)
    if abs(along) <= NOTHING * (abs(normal) + weight):
        return Exact("no_driving_force", None, ("J1",), (normal,), mp.mpf(0), **shape)
    factor = (bond + normal * friction) / abs(along)
    return Exact(
        "slides_on_J1" if along > 0 else "slides_up",
        factor,
        ("J1",),
        (normal,),
        abs(along),
        **shape,
    )


def footing(
    load: float, dip: float, long: float, c: float, phi: float, unit_weight: float = 0.0
) -> Exact:
    """A block between a weak plane that daylights in a vertical face and a level top (Sheng et al. 2023, §3.3)."""
    area = mp.mpf(long) ** 2 * sine(dip) * cosine(dip) / 2
    total = mp.mpf(load) + mp.mpf(unit_weight) * area
    return _on_one_plane(
        total * sine(dip),
        total * cosine(dip),
        mp.mpf(c) * mp.mpf(long),
        tangent(phi),
        area,
        mp.mpf(long),
        total,
    )


def block_on_incline(
    wide: float,
    high: float,
    dip: float,
    c: float,
    phi: float,
    unit_weight: float,
    *,
    pressure: float = 0.0,
    many: int = 1,
) -> Exact:
    """A stack of `many` rectangles on an incline: slides at the joint with the least factor, or tips at its toe.

    All of them tip together about the toe where T (many·high)/2 > N wide/2: the pressure (kPa) acts below the lowest.
    """
    weight = mp.mpf(unit_weight) * mp.mpf(wide) * mp.mpf(high) * many
    presses = weight * cosine(dip) - mp.mpf(pressure) * mp.mpf(wide)
    if presses > 0 and mp.mpf(many) * mp.mpf(high) * weight * sine(dip) > mp.mpf(wide) * presses:
        return Exact("topples", None, volume=mp.mpf(wide) * mp.mpf(high) * many)
    found = _on_one_plane(
        weight * sine(dip),
        presses,
        mp.mpf(c) * mp.mpf(wide),
        tangent(phi),
        mp.mpf(wide) * mp.mpf(high) * many,
        mp.mpf(wide),
        weight,
    )
    return Exact(found.status.replace("slides_on_J1", "slides"), found.factor, volume=found.volume)


def toppling_columns(
    heights: Sequence[float],
    width: float,
    step: float,
    base_dip: float,
    phi: float,
    unit_weight: float,
) -> Exact:
    """Columns on a stepped base: the factor at which column 1 starts to slide or to turn (Goodman & Bray 1976)."""
    y, wide, rise = [mp.mpf(h) for h in heights], mp.mpf(width), mp.mpf(step)
    weights = [mp.mpf(unit_weight) * h * wide for h in y]

    def stands(factor: Number) -> bool:
        rubs = tangent(phi) / factor
        push = mp.mpf(0)
        for n in range(len(y) - 1, -1, -1):
            drives, presses = weights[n] * sine(base_dip), weights[n] * cosine(base_dip)
            upper = min(y[n], y[n + 1] + rise) if n + 1 < len(y) else mp.mpf(0)
            turns = push * (upper - wide * rubs) + (drives * y[n] - presses * wide) / 2
            # sides and base so rough that a push only presses the column on: it never slides
            slides = push + (drives - presses * rubs) / (1 - rubs * rubs) if rubs < 1 else -mp.inf
            if n == 0:
                return turns <= 0 and slides <= 0
            push = max(turns / min(y[n - 1] - rise, y[n]), slides, mp.mpf(0))
        raise ArithmeticError("no columns")

    lowest = mp.mpf(10) ** -3
    if not stands(lowest):  # column 1 turns about its toe, whatever the friction
        return Exact("topples", None, volume=mp.fsum(y) * wide)
    factor = last_that_holds(stands, lowest, mp.mpf(10) ** 3)
    return Exact("topples", factor, volume=mp.fsum(y) * wide)


def sphere_without_friction(
    radius: float, distance: float, dip: float, c: float, unit_weight: float
) -> Exact:
    """The cap below a straight slope, turning about the level axis along the strike (Hungr, Salgado & Byrne 1989).

    F = c ∫ ρ dA / (W a), ρ the distance from the axis: c R³ ∫ 4 E(sin²θ) sin θ dθ over the cap.

    Parameters
    ----------
    distance : m, of the slope from the centre, positive where the centre lies above the ground
    """
    r, d = mp.mpf(radius), mp.mpf(distance)
    h = r - d
    volume = mp.pi * h**2 * (3 * r - h) / 3
    arm = 3 * (2 * r - h) ** 2 / (4 * (3 * r - h)) * sine(dip)
    edge = mp.acos(d / r)
    lever = r**3 * mp.quad(lambda t: 4 * mp.ellipe(mp.sin(t) ** 2) * mp.sin(t), [0, edge])
    return Exact("rotates", mp.mpf(c) * lever / (mp.mpf(unit_weight) * volume * arm), volume=volume)


def last_that_holds(holds: Callable[[Number], bool], low: Number, high: Number) -> Number:
    """Bisection to 45 digits: the end of the part of low..high, from low, on which `holds` is true."""
    low, high = mp.mpf(low), mp.mpf(high)
    if not holds(low) or holds(high):
        raise ArithmeticError("the ends do not bracket a change")
    while high - low > abs(high) * mp.mpf(10) ** -45:
        middle = (low + high) / 2
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low
