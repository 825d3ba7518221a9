"""The Hoek & Bray wedge in vector form: forces only, zero dilation, cohesion only on planes in contact.

Sources: Hoek & Bray (1981), Rock Slope Engineering, ch. 8 and appendix 2 (geometry, water, tension crack);
Warburton (1981) and Goodman & Shi (1985), ch. 9 (the mode from the resultant); Wyllie & Mah (2004), ch. 7.

Plain floats on purpose: one wedge takes some tens of microseconds, and no line is shared with the solver it judges.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from slopekit.core.errors import Fault, GeometryError
from slopekit.core.orientation import Plane

Vector = tuple[float, float, float]
_SMALL = 1e-12
_SQUARE = 1e-12  # a bolt that the movement draws out by less (times the load) is square to it and does not act
_STRONGEST = 1e6  # strength multiplied by this much holds whatever can be held
_STRIDE = 1.05  # steps of λ on the way to the first loss
_ROUNDS = 40  # over several bolts, one after the other


@dataclass(frozen=True, slots=True)
class WedgeWater:
    """Water: `fill` of full pressure (0 dry, 1 full), or the mean pressures on J1, J2 and the crack (kPa).

    `crack_fill` is the crack's own part of full pressure, None where it has what the joints have.
    """

    fill: float = 0.0
    pressures: tuple[float, ...] = ()
    unit_weight: float = 9.81
    crack_fill: float | None = None


@dataclass(frozen=True, slots=True)
class ClosedFormWedge:
    """What the closed form says of a wedge.

    Attributes
    ----------
    status : slides_on_both, slides_on_J1, slides_on_J2, slides_up, lifted, falls or no_driving_force
    factor : factor of safety, None unless the wedge slides
    normal : effective normal forces on J1 and J2, kN (the joints' own strength carries them)
    driving, resisting : kN, along the direction of sliding; sliding : that direction, None where there is none
    areas : J1, J2, crack, m²; volume : m³; weight : kN; total_height : m; water : forces on J1, J2, crack, kN
    """

    status: str
    factor: float | None
    normal: tuple[float, float]
    driving: float
    resisting: float
    sliding: Vector | None
    areas: tuple[float, float, float]
    volume: float
    weight: float
    total_height: float
    water: tuple[float, float, float]


def hoek_bray_wedge(
    joints: tuple[Plane, Plane],
    face: Plane,
    upper: Plane,
    height: float,
    cohesion: tuple[float, float],
    friction_angle_deg: tuple[float, float],
    unit_weight: float,
    *,
    water: WedgeWater = WedgeWater(),
    crack: Plane | None = None,
    crack_distance: float = 0.0,
    seismic: tuple[float, float | None] = (0.0, None),
    forces: Sequence[Sequence[float]] = (),
    passive: Sequence[Sequence[float]] = (),
) -> ClosedFormWedge:
    """Factor of safety of a wedge on two joints, maybe with a tension crack.

    Parameters
    ----------
    height : m, vertical, from the toe to where the trace of J1 meets the crest
    cohesion : kPa; unit_weight : kN/m³
    crack_distance : m from the crest along the trace of J1
    seismic : coefficient and trend (degrees; None: the trend of the line of intersection)
    forces : (east, north, up) kN; active bolts count among them
    passive : (east, north, up) kN at full capacity; a passive bolt pulls with capacity / F where it is drawn out, with
        less where that would already stop the movement along it

    Raises
    ------
    GeometryError
        E208 the planes enclose no wedge.

    Formula: F = (c₁A₁ + c₂A₂ + N₁ tan φ₁ + N₂ tan φ₂) / |R·l| on both planes; on plane i alone
    F = (cᵢAᵢ + Nᵢ tan φᵢ) / |R - (R·nᵢ) nᵢ|.

    >>> wedge = hoek_bray_wedge((Plane(45, 115), Plane(45, 245)), Plane(60, 180), Plane(10, 180), 64.89,
    ...                         (50, 50), (20, 20), 25.506)
    >>> wedge.status, round(wedge.factor, 4)
    ('slides_on_both', 1.5574)
    """
    shape = _Shape.of(joints, face, upper, height, crack, crack_distance)
    weight = unit_weight * shape.volume
    pressures = _pressures(water, shape, crack is not None)
    pushes = [pressure * area for pressure, area in zip(pressures, shape.areas, strict=True)]
    trend = shape.trend if seismic[1] is None else math.radians(seismic[1])
    load = (weight * seismic[0] * math.sin(trend), weight * seismic[0] * math.cos(trend), -weight)
    for push, normal in zip(pushes, shape.inward, strict=True):
        load = _add(load, normal, push)
    for force in forces:
        load = _add(load, force, 1.0)
    tangents = tuple(math.tan(math.radians(angle)) for angle in friction_angle_deg)
    bonds = (cohesion[0] * shape.areas[0], cohesion[1] * shape.areas[1])
    size = weight + sum(abs(push) for push in pushes) + sum(_length(force) for force in forces)

    strength = bonds, (tangents[0], tangents[1])
    bolts = [(bolt[0], bolt[1], bolt[2]) for bolt in passive]
    slide = _slide(load, shape.inward[0], shape.inward[1], size)
    factor: float | None = None
    if bolts and slide.status != "no_driving_force":
        slide, factor = _with_passive_bolts(load, bolts, shape, strength, size)
    elif slide.direction is not None and slide.touches != (False, False):
        factor = _resisting(slide, strength) / slide.driving
    return ClosedFormWedge(
        slide.status,
        factor,
        slide.normal,
        slide.driving,
        _resisting(slide, strength),
        slide.direction,
        shape.areas,
        shape.volume,
        weight,
        shape.total_height,
        (pushes[0], pushes[1], pushes[2]),
    )


@dataclass(frozen=True, slots=True)
class _Shape:
    areas: tuple[float, float, float]
    volume: float
    total_height: float
    crack_depth: float
    inward: tuple[Vector, Vector, Vector]
    trend: float

    @staticmethod
    def of(
        joints: tuple[Plane, Plane],
        face: Plane,
        upper: Plane,
        height: float,
        crack: Plane | None,
        distance: float,
    ) -> "_Shape":
        n1, n2, nf, nu = (_normal(plane) for plane in (*joints, face, upper))
        try:
            crest1 = _scaled(_cross(n1, nf), height / _cross(n1, nf)[2])
            offset = _dot(nu, crest1)
            crest2 = _scaled(_cross(n2, nf), offset / _dot(nu, _cross(n2, nf)))
            line = _cross(n1, n2)
            back = _scaled(line, offset / _dot(nu, line))
        except ZeroDivisionError:
            raise GeometryError([Fault("E208", "the planes enclose no wedge")]) from None
        volume = abs(_dot(crest1, _cross(crest2, back))) / 6.0
        areas = [_length(_cross(crest1, back)) / 2.0, _length(_cross(crest2, back)) / 2.0, 0.0]
        if not volume > 0.0:
            raise GeometryError([Fault("E208", "the planes enclose no wedge")])
        inward = [
            n1 if _dot(n1, crest2) > 0.0 else _scaled(n1, -1.0),
            n2 if _dot(n2, crest1) > 0.0 else _scaled(n2, -1.0),
        ]
        depth, n5 = 0.0, (0.0, 0.0, 0.0)
        if crack is not None:
            n5 = _normal(crack)
            along = _add(back, crest1, -1.0)
            offset5 = _dot(n5, _add(crest1, along, distance / _length(along)))
            bottom = _scaled(back, offset5 / _dot(n5, back))
            top1, top2 = (_where(crest, back, n5, offset5) for crest in (crest1, crest2))
            to_bottom, to_1, to_2 = (_add(point, back, -1.0) for point in (bottom, top1, top2))
            volume -= abs(_dot(to_bottom, _cross(to_1, to_2))) / 6.0
            areas[0] -= _length(_cross(to_bottom, to_1)) / 2.0
            areas[1] -= _length(_cross(to_bottom, to_2)) / 2.0
            areas[2] = _length(_cross(_add(top1, bottom, -1.0), _add(top2, bottom, -1.0))) / 2.0
            depth = (offset - _dot(nu, bottom)) / nu[2]
            n5 = _scaled(n5, -1.0) if offset5 > 0.0 else n5
            corners = [crest1, crest2, bottom, top1, top2]
        else:
            corners = [crest1, crest2, back]
        down = line if line[2] < 0.0 else _scaled(line, -1.0)
        total = max(0.0, *(corner[2] for corner in corners)) - min(
            0.0, *(corner[2] for corner in corners)
        )
        trend = math.atan2(down[0], down[1])
        return _Shape(
            (areas[0], areas[1], areas[2]), volume, total, depth, (inward[0], inward[1], n5), trend
        )


@dataclass(frozen=True, slots=True)
class _Slide:
    status: str
    direction: Vector | None
    driving: float
    normal: tuple[float, float]
    touches: tuple[bool, bool]
    load: Vector


def _slide(load: Vector, n1: Vector, n2: Vector, size: float) -> _Slide:
    """Mode of sliding from the resultant: off both, along one, along both joints."""
    on1, on2, between = _dot(load, n1), _dot(load, n2), _dot(n1, n2)
    if on1 >= 0.0 and on2 >= 0.0:
        if _length(load) <= _SMALL * size:
            return _Slide("no_driving_force", None, 0.0, (0.0, 0.0), (False, False), load)
        return _Slide(
            "falls" if max(n1[2], n2[2]) <= 0.0 else "lifted",
            None,
            0.0,
            (0.0, 0.0),
            (False, False),
            load,
        )
    for k, (own, other, n) in enumerate(((on1, on2, n1), (on2, on1, n2))):
        if own < 0.0 and other - own * between >= 0.0:
            along = _add(load, n, -own)
            driving = _length(along)
            normal = (-own, 0.0) if k == 0 else (0.0, -own)
            if driving <= _SMALL * size:
                return _Slide("no_driving_force", None, 0.0, normal, (k == 0, k == 1), load)
            direction = _scaled(along, 1.0 / driving)
            status = "slides_up" if direction[2] > 0.0 else f"slides_on_J{k + 1}"
            return _Slide(status, direction, driving, normal, (k == 0, k == 1), load)
    line = _cross(n1, n2)
    line = _scaled(line, 1.0 / _length(line))
    driving = _dot(load, line)
    share = 1.0 - between * between
    normal = ((on2 * between - on1) / share, (on1 * between - on2) / share)
    if abs(driving) <= _SMALL * size:
        return _Slide("no_driving_force", None, 0.0, normal, (True, True), load)
    direction = line if driving > 0.0 else _scaled(line, -1.0)
    status = "slides_up" if direction[2] > 0.0 else "slides_on_both"
    return _Slide(status, direction, abs(driving), normal, (True, True), load)


def _resisting(slide: _Slide, strength: tuple[tuple[float, float], tuple[float, float]]) -> float:
    bonds, tangents = strength
    return sum(
        bond + normal * tangent
        for bond, tangent, normal, touches in zip(
            bonds, tangents, slide.normal, slide.touches, strict=True
        )
        if touches
    )


def _pulled(load: Vector, bolts: Sequence[Vector], pulls: Sequence[float]) -> Vector:
    for bolt, pull in zip(bolts, pulls, strict=True):
        load = _add(load, bolt, pull)
    return load


def _with_passive_bolts(
    load: Vector,
    bolts: Sequence[Vector],
    shape: _Shape,
    strength: tuple[tuple[float, float], tuple[float, float]],
    size: float,
) -> tuple[_Slide, float | None]:
    """The slide and the factor with passive bolts: λ = 1/F falls from where all stands to the first loss.

    At each λ a bolt pulls with all of λ times its capacity where the movement draws it out, with nothing where it is
    pushed in, and with what stops the movement along it in between.
    """

    def at(reduction: float) -> tuple[_Slide, bool]:
        slide = _resting(load, bolts, shape, size, reduction)
        stands = slide.direction is None and slide.status == "no_driving_force"
        return slide, stands or (
            slide.touches != (False, False)
            and reduction * _resisting(slide, strength) >= slide.driving
        )

    high = _STRONGEST * size / sum(_length(bolt) for bolt in bolts)
    low = high
    slide, stands = at(high)
    bare, top = _slide(load, *shape.inward[:2], size), slide
    # bolts so strong that they would lift the wedge off pull no more than keeps it on a joint
    hangs = top.touches == (False, False) != bare.touches and not stands
    guess = bare.driving / max(_resisting(bare, strength), _SMALL * size)
    while hangs and not stands and low > 1e-3 * guess:
        high, low = low, low / (2.0 if low > 30.0 * guess else _STRIDE)
        slide, stands = at(low)
    if not stands:
        return top, None if top.touches == (False, False) else 0.0
    while stands:
        high, low = low, low / (2.0 if low > 30.0 * guess > 0.0 else _STRIDE)
        slide, stands = at(low)
        if low < 1.0 / _STRONGEST:
            return slide, None
    while True:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        below, stands = at(middle)
        low, high, slide = (low, middle, slide) if stands else (middle, high, below)
    return slide, 1.0 / high


def _resting(
    load: Vector, bolts: Sequence[Vector], shape: _Shape, size: float, reduction: float
) -> _Slide:
    """The slide that the bolts leave, each pulling between 0 and λ times its capacity so as to leave the least."""
    pulls = [0.0] * len(bolts)
    for _ in range(_ROUNDS):
        before = list(pulls)
        for k, bolt in enumerate(bolts):

            def along(pull: float, k: int = k, bolt: Vector = bolt) -> float:
                slide = _slide(
                    _pulled(load, bolts, [*pulls[:k], pull, *pulls[k + 1 :]]),
                    *shape.inward[:2],
                    size,
                )
                if slide.direction is None:
                    return 0.0 if slide.status == "no_driving_force" else _dot(slide.load, bolt)
                return _dot(slide.direction, bolt) * slide.driving

            low, high = 0.0, reduction
            if along(low) >= -_SQUARE * _length(bolt) * size:
                pulls[k] = low
            elif along(high) <= 0.0:
                pulls[k] = high
            else:
                pulls[k] = _crossing(along, low, high)
        if len(bolts) == 1 or all(
            abs(a - b) <= 1e-12 * reduction for a, b in zip(pulls, before, strict=True)
        ):
            break
    return _slide(_pulled(load, bolts, pulls), *shape.inward[:2], size)


def _crossing(slope: Callable[[float], float], low: float, high: float) -> float:
    """Where a rising, piecewise linear function crosses zero, by the Illinois rule (Dowell & Jarratt 1971)."""
    at_low, at_high = slope(low), slope(high)
    for _ in range(60):
        middle = high - at_high * (high - low) / (at_high - at_low)
        here = slope(middle)
        if here == 0.0 or not low < middle < high:
            return middle
        if here > 0.0:
            high, at_high, at_low = middle, here, 0.5 * at_low
        else:
            low, at_low, at_high = middle, here, 0.5 * at_high
        if high - low <= 1e-15 * high:
            break
    return high


def _pressures(water: WedgeWater, shape: _Shape, has_crack: bool) -> tuple[float, float, float]:
    """Mean pressures on J1, J2 and the crack: γ_w H/6, with a crack γ_w h₅/3 on all three."""
    full = water.unit_weight * shape.crack_depth / 3.0
    own = None if water.crack_fill is None else water.crack_fill * full
    if water.pressures:
        u1, u2, u5 = (*water.pressures, 0.0)[:3]
        return u1, u2, u5 if own is None else own
    if has_crack:
        mean = water.fill * full
        return mean, mean, mean if own is None else own
    mean = water.fill * water.unit_weight * shape.total_height / 6.0
    return mean, mean, 0.0


def _normal(plane: Plane) -> Vector:
    dip, direction = math.radians(plane.dip_deg), math.radians(plane.dip_direction_deg)
    return math.sin(dip) * math.sin(direction), math.sin(dip) * math.cos(direction), math.cos(dip)


def _where(start: Vector, end: Vector, normal: Vector, offset: float) -> Vector:
    """Where the line from start to end crosses a plane."""
    way = _add(end, start, -1.0)
    return _add(start, way, (offset - _dot(normal, start)) / _dot(normal, way))


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _add(a: Sequence[float], b: Sequence[float], times: float) -> Vector:
    return a[0] + times * b[0], a[1] + times * b[1], a[2] + times * b[2]


def _scaled(a: Vector, by: float) -> Vector:
    return a[0] * by, a[1] * by, a[2] * by


def _length(a: Sequence[float]) -> float:
    return math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
