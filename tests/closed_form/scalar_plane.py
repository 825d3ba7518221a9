"""Plane failure per metre of slope: forces only, zero dilation, cohesion only where the plane is in contact.

Sources: Hoek & Bray (1981), Rock Slope Engineering, ch. 7; Wyllie & Mah (2004), Rock Slope Engineering, ch. 6.
The weight comes from the corners of the block, so that the upper slope may dip and the crack stand in the face.

Section: x out of the slope, z up, the toe at (0, 0). Plain floats on purpose, as in `wedge`.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from slopekit.core.errors import Fault, GeometryError

Vector = tuple[float, float]
_SMALL = 1e-12
_SQUARE = 1e-12  # a bolt that the movement draws out by less (times the load) is square to it and does not act
_STRONGEST = 1e6  # strength multiplied by this much holds whatever can be held
_STRIDE = 1.05  # steps of λ on the way to the first loss
_ROUNDS = 40  # over several bolts, one after the other


@dataclass(frozen=True, slots=True)
class ClosedFormPlane:
    """What the closed form says of a plane failure, per metre of slope.

    Attributes
    ----------
    status : slides, slides_up, lifted (contact is lost), no_driving_force or falls (the plane hangs over)
    factor : factor of safety, None unless the block slides
    weight_kn : kN; normal_kn : effective normal force on the plane, kN
    driving_kn, resisting_kn : kN, along the plane; with passive bolts under the pull they have at that factor
    uplift_kn, thrust_kn : water on the plane (U) and in the crack (V), kN
    length_m : of the sliding plane; crack_depth_m : 0 without a crack
    """

    status: str
    factor: float | None
    weight_kn: float
    normal_kn: float
    driving_kn: float
    resisting_kn: float
    uplift_kn: float
    thrust_kn: float
    length_m: float
    crack_depth_m: float


def plane_failure(
    face_dip_deg: float,
    upper_dip_deg: float,
    plane_dip_deg: float,
    height_m: float,
    cohesion_kpa: float,
    friction_angle_deg: float,
    unit_weight_kn_m3: float,
    *,
    crack_distance_m: float | None,
    water_in_crack_m: float = 0.0,
    water_unit_weight_kn_m3: float = 9.81,
    mean_pressure_kpa: float | None = None,
    plane_water_peak_mid_kpa: float = 0.0,
    seismic: float = 0.0,
    forces: Sequence[Sequence[float]] = (),
    passive: Sequence[Sequence[float]] = (),
) -> ClosedFormPlane:
    """Factor of safety of the block on a plane that daylights at the toe of the face.

    Parameters
    ----------
    face_dip_deg, upper_dip_deg, plane_dip_deg : degrees, positive out of the slope
    height_m : m, vertical, from the toe to the crest
    crack_distance_m : m, horizontal, from the crest back to a vertical crack (negative: in the face); None without one
    water_in_crack_m : m; U = γ_w z_w L / 2 on the plane (nothing at the toe), V = γ_w z_w² / 2 in the crack
    mean_pressure_kpa : kPa, even on the plane, instead of that U
    plane_water_peak_mid_kpa : kPa at mid-length, nothing at both ends of the plane (slopes without a crack)
    seismic : horizontal, out of the slope, part of the weight
    forces : (x, z) kN/m; active bolts count among them
    passive : (x, z) kN/m at full capacity; a passive bolt pulls with capacity / F where it is drawn out, with less
        where that would already stop the movement along it

    Raises
    ------
    GeometryError
        E203 the plane does not daylight, E205 it never meets the upper slope, E207 no such crack or more water than
        it holds, E209 the upper slope is as steep as the face.

    Formula: F = (c L + (W (cos ψ - k sin ψ) - U - V sin ψ + T_n) tan φ) / (W (sin ψ + k cos ψ) + V cos ψ - T_s)
    (Wyllie & Mah 2004, eq. 6.4 and 6.11-6.22).

    >>> block = plane_failure(60, 0, 35, 12, 25, 37, 26, crack_distance_m=4, water_in_crack_m=3)
    >>> block.status, round(block.factor, 4)
    ('slides', 1.2467)
    """
    corners, depth = _corners(
        face_dip_deg, upper_dip_deg, plane_dip_deg, height_m, crack_distance_m
    )
    if water_in_crack_m > depth * (1.0 + 1e-9):
        message = f"the water stands {water_in_crack_m:.6g} m deep in a crack of {depth:.6g} m"
        raise GeometryError([Fault("E207", message, "", "Give at most the depth of the crack.")])
    turned = zip(corners, corners[1:] + corners[:1], strict=True)
    weight = unit_weight_kn_m3 * abs(sum(a[0] * b[1] - a[1] * b[0] for a, b in turned)) / 2.0
    length = math.hypot(*corners[-1])
    mean = (
        water_unit_weight_kn_m3 * water_in_crack_m / 2.0
        if mean_pressure_kpa is None
        else mean_pressure_kpa
    )
    uplift = (mean + plane_water_peak_mid_kpa / 2.0) * length
    thrust = water_unit_weight_kn_m3 * water_in_crack_m**2 / 2.0

    dip = math.radians(plane_dip_deg)

    def on_plane(x: float, z: float) -> Vector:
        """Down the plane, and off it."""
        return x * math.cos(dip) - z * math.sin(dip), x * math.sin(dip) + z * math.cos(dip)

    along, off = on_plane(
        thrust + seismic * weight + sum(force[0] for force in forces),
        sum(force[1] for force in forces) - weight,
    )
    size = weight + abs(uplift) + thrust + sum(math.hypot(force[0], force[1]) for force in forces)
    plane = _Plane(
        cohesion_kpa * length,
        math.tan(math.radians(friction_angle_deg)),
        math.cos(dip) <= _SMALL,
        _SMALL * size,
    )
    load = along, off + uplift
    bolts = [on_plane(bolt[0], bolt[1]) for bolt in passive if any(bolt)]
    slide = plane.slide(load)
    factor: float | None = None
    if bolts and slide.status != "no_driving_force":
        slide, factor = _with_passive_bolts(plane, load, bolts, size)
    elif slide.driving > 0.0:
        factor = slide.resisting / slide.driving
    return ClosedFormPlane(
        slide.status,
        factor,
        weight,
        slide.normal,
        slide.driving,
        slide.resisting,
        uplift,
        thrust,
        length,
        depth,
    )


def crack_distance(
    face_dip_deg: float, upper_dip_deg: float, plane_dip_deg: float, height_m: float, depth_m: float
) -> float | None:
    """Horizontal distance (m) behind the crest of the vertical crack of a given depth (m), None where there is none.

    Formula: z = H (1 - cot ψ_f tan ψ_p) - b (tan ψ_p - tan ψ_s) (Wyllie & Mah 2004, eq. 6.1 and 6.2, solved for b).

    >>> round(crack_distance(60, 0, 35, 12, 4.35), 3)
    3.997
    """
    face, upper, plane = (math.radians(dip) for dip in (face_dip_deg, upper_dip_deg, plane_dip_deg))
    at_crest = height_m * (1.0 - math.tan(plane) * math.cos(face) / math.sin(face))
    lost = math.tan(plane) - math.tan(upper)
    if not depth_m > 0.0 or abs(lost) <= _SMALL:
        return None
    distance = (at_crest - depth_m) / lost
    return distance if distance >= 0.0 else None


def _corners(
    face_dip: float, upper_dip: float, plane_dip: float, height: float, crack: float | None
) -> tuple[list[Vector], float]:
    """The block from the toe over its top to the upper end of the plane, m; the depth of the crack, m."""
    if not plane_dip < face_dip:
        message = (
            f"the plane dips {plane_dip:.4g}°, as steep as the face ({face_dip:.4g}°) or steeper"
        )
        raise GeometryError([Fault("E203", message + ": it does not daylight")])
    if not upper_dip < face_dip:
        raise GeometryError(
            [Fault("E209", f"the upper slope ({upper_dip:.4g}°) is as steep as the face")]
        )
    face, upper, plane = (math.radians(dip) for dip in (face_dip, upper_dip, plane_dip))
    toe, crest = (0.0, 0.0), (-height * math.cos(face) / math.sin(face), height)
    # the depth of the plane below the ground: at the crest, and lost per metre behind it
    at_crest, lost = height + crest[0] * math.tan(plane), math.tan(plane) - math.tan(upper)
    if crack is None:
        if not lost > _SMALL:
            message = f"the plane dips {plane_dip:.4g}°, not steeper than the upper slope ({upper_dip:.4g}°)"
            raise GeometryError(
                [Fault("E205", message + ": they never meet", "", "Give a tension crack.")]
            )
        behind = crest[0] - at_crest / lost
        return [toe, crest, (behind, -behind * math.tan(plane))], 0.0
    at = crest[0] - crack
    top = (at, height + crack * math.tan(upper)) if crack >= 0.0 else (at, -at * math.tan(face))
    bottom = at, -at * math.tan(plane)
    depth = top[1] - bottom[1]
    if not (depth > 0.0 and at < 0.0):
        message = f"no crack {crack:.6g} m behind the crest meets the plane below the ground"
        raise GeometryError([Fault("E207", message)])
    return [toe, *([crest] if crack > 0.0 else []), top, bottom], depth


@dataclass(frozen=True, slots=True)
class _Slide:
    status: str
    driving: float
    normal: float
    resisting: float


@dataclass(frozen=True, slots=True)
class _Plane:
    bond: float
    tangent: float
    hangs_over: bool
    nothing: float

    def slide(self, load: Vector) -> _Slide:
        """Mode of sliding from the resultant (down the plane, off it)."""
        along, off = load
        if off >= -self.nothing:
            if math.hypot(along, off) <= self.nothing:
                return _Slide("no_driving_force", 0.0, 0.0, 0.0)
            return _Slide("falls" if self.hangs_over else "lifted", 0.0, 0.0, 0.0)
        status = (
            "no_driving_force"
            if abs(along) <= self.nothing
            else "slides"
            if along > 0.0
            else "slides_up"
        )
        driving = 0.0 if status == "no_driving_force" else abs(along)
        return _Slide(status, driving, -off, self.bond - off * self.tangent)


def _with_passive_bolts(
    plane: _Plane, load: Vector, bolts: Sequence[Vector], size: float
) -> tuple[_Slide, float | None]:
    """The slide and the factor with passive bolts: λ = 1/F falls from where all stands to the first loss."""

    def at(reduction: float) -> tuple[_Slide, bool]:
        slide = plane.slide(_pulled(load, bolts, reduction, size))
        held = (
            slide.status in ("slides", "slides_up") and reduction * slide.resisting >= slide.driving
        )
        return slide, held or slide.status == "no_driving_force"

    high = low = _STRONGEST * size / sum(math.hypot(*bolt) for bolt in bolts)
    slide, stands = at(high)
    bare, top = plane.slide(load), slide
    # bolts so strong that they would lift the block off pull no more than keeps it on its plane
    guess = bare.driving / max(bare.resisting, _SMALL * size)
    while top.status == "lifted" and bare.normal > 0.0 and not stands and low > 1e-3 * guess:
        high, low = low, low / (2.0 if low > 30.0 * guess else _STRIDE)
        slide, stands = at(low)
    if not stands:
        return top, 0.0 if top.driving > 0.0 else None
    while stands:
        high, low = low, low / (2.0 if low > 30.0 * guess > 0.0 else _STRIDE)
        slide, stands = at(low)
        if low < 1.0 / _STRONGEST:
            return slide, None
    while True:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            return slide, 1.0 / high
        below, stands = at(middle)
        low, high, slide = (low, middle, slide) if stands else (middle, high, below)


def _pulled(load: Vector, bolts: Sequence[Vector], reduction: float, size: float) -> Vector:
    """The load under bolts that pull between 0 and λ times their capacity, so as to leave the least movement."""
    pulls = [0.0] * len(bolts)
    for _ in range(_ROUNDS):
        before = list(pulls)
        for k, (along, off) in enumerate(bolts):
            rest = [
                (pull, bolt)
                for j, (pull, bolt) in enumerate(zip(pulls, bolts, strict=True))
                if j != k
            ]
            s = load[0] + sum(pull * bolt[0] for pull, bolt in rest)
            n = load[1] + sum(pull * bolt[1] for pull, bolt in rest)
            drawn = s * along + max(n, 0.0) * off  # below 0: the movement draws the bolt out
            if drawn >= -_SQUARE * math.hypot(along, off) * size:
                pulls[k] = 0.0
                continue
            # on the plane; off it, where the block is lifted; a bolt square to the plane presses with all it has
            stopped = -s / along if abs(along) > _SQUARE * abs(off) else math.inf
            if n + stopped * off > 0.0:
                stopped = -(s * along + n * off) / (along * along + off * off)
            pulls[k] = min(stopped, reduction)
        if all(abs(a - b) <= 1e-12 * reduction for a, b in zip(pulls, before, strict=True)):
            break
    return (
        load[0] + sum(pull * bolt[0] for pull, bolt in zip(pulls, bolts, strict=True)),
        load[1] + sum(pull * bolt[1] for pull, bolt in zip(pulls, bolts, strict=True)),
    )
