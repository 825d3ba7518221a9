"""Hoek & Bray's wedge by triple products: no corner is computed, no wedge needs a branch.

With the upward normals n₁, n₂ of the joints, n_f of the face and n_u of the upper slope, L = n₁ × n₂ and

    D₁ = n₁·(n_f × n_u)   D₂ = n₂·(n_f × n_u)   D₃ = n_u·L   D₄ = n_f·L   a₁ = (n₁ × n_f)_z,

the crest meets J1 in H (n₁ × n_f) / a₁, and by (a × b) × (c × d) = [a b d] c - [a b c] d areas and weight follow:

    A₁/W = 3 |a₁ D₂ / (γ H D₁ D₄)|   A₂/W = 3 |a₁ / (γ H D₄)|   W = γ H³ |D₁² D₄² / (6 a₁³ D₂ D₃)|.

The planes cut a wedge where D₃ D₄ < 0, L_z D₄ < 0 and D₁ a₁ > 0. By the weight, the load without water is -g with
g = (0, 0, 1) where nothing else acts; with b = n₁·n₂ and both joints in contact, the effective normal forces are

    N₁ = ± (g·n₁ - b g·n₂) / (1 - b²) - u₁ A₁/W   (N₂ likewise; + where n points into the wedge)

and what drives is |g·L| / √(1 - b²). Where one of them is not positive, the other joint alone carries N + b N', and
√(driving² + (1 - b²) N'²) drives; where that is not positive either, the wedge is off both.

The frame is the face's: x along its strike, y the way it dips, so that n_f = (0, sin, cos) and a₁ = x₁ sin.

All functions take floats, arrays or the steps of a tape alike.
"""

import math
from collections.abc import Mapping
from typing import Final, NamedTuple, TypeAlias

import numpy as np

from slopekit.closed_form.given import Value
from slopekit.closed_form.wedge_arrays import NUMBER_OF

Pair: TypeAlias = tuple[Value, Value]
Vector: TypeAlias = tuple[Value, Value, Value]
_RADIAN: Final = math.pi / 180.0
_HALF: Final = _RADIAN / 2.0  # exactly half of what the scalar function makes of a degree

# Where a wedge is as thin, flat or finely balanced as this, the last bit of a sine shows in the twelfth digit of the
# factor, whoever computes it, or decides: there `wedge_steps` goes through the very steps of the scalar function. The
# limits are sines, or parts of the weight.
_CLEAR: Final = 1e-3  # D₁, D₂ and a₁
_FLAT: Final = 2e-3  # D₃, L_z and 1 - b²
_THIN: Final = 5e-3  # D₄, by which what is lost in areas and volumes is divided
_CONTACT: Final = 1e-6  # a normal force
_BALANCE: Final = 0.06  # what is left, by the forces whose difference it is
_SIGN: Final = 1e-9  # a product that only has to have a sign
_TRACE: Final = 1e-5  # a₁: below 1e-6 it counts as a trace along the crest
UNSURE: Final = -1


class Turns(NamedTuple):
    """Sine and cosine of the dips, and of the dip directions as seen from the face's."""

    face: Pair
    upper: tuple[Value, Value, Value, Value]
    joint1: tuple[Value, Value, Value, Value]
    joint2: tuple[Value, Value, Value, Value]


class Cut(NamedTuple):
    """What the planes cut, in the names of the formulas above."""

    joint1: Vector
    joint2: Vector
    line: Vector
    between: Value
    square: Value  # 1 - b²
    across1: Value  # x of n₁ × n_f
    across2: Value
    edge: Value  # x of n_f × n_u
    aside: Value  # x of n_u
    d1: Value
    d2: Value
    d3: Value
    d4: Value
    a1: Value


class Forces(NamedTuple):
    """What decides how a wedge moves, by its weight; pairs are of J1 and J2.

    Areas and normal forces of J1 have the sign that turns -n₁ into the wedge, those of J2 the sign that n₂ needs.
    """

    areas: Pair
    normal: Pair
    up: Pair  # z of n₁ and n₂
    rise: Value  # L_z
    between: Value  # b
    square: Value  # 1 - b²
    driving: Value  # g·L
    bonds: Pair
    tangents: Pair
    balance: Value  # the forces whose differences these are: 0 where the weight alone acts
    effort: Value  # the weight and those of them that are not water: 0 where there is weight alone, and water


def turns_of(given: Mapping[str, Value]) -> Turns:
    facing = given["face_dip_direction_deg"] * _HALF

    def turn(plane: str) -> tuple[Value, Value, Value, Value]:
        direction = given[f"{plane}_dip_direction_deg"] * _HALF - facing
        return (*_turn(given[f"{plane}_dip_deg"] * _HALF), *_turn(direction))

    return Turns(_turn(given["face_dip_deg"] * _HALF), turn("upper"), turn("joint1"), turn("joint2"))


def _turn(half: Value) -> Pair:
    """Sine and cosine of twice an angle: 2 t / (1 + t²) and 2 / (1 + t²) - 1 with its tangent t.

    NumPy takes eight times as long for a sine and a cosine as for a tangent.
    """
    tangent = np.tan(half)
    part = 2.0 / (tangent * tangent + 1.0)
    return tangent * part, part - 1.0


def cut_of(turns: Turns) -> Cut:
    sine, cosine = turns.face
    (x, y, z), one, two = (
        (steep * east, steep * north, flat) for steep, flat, east, north in (turns.upper, turns.joint1, turns.joint2)
    )
    line = (
        one[1] * two[2] - one[2] * two[1],
        one[2] * two[0] - one[0] * two[2],
        one[0] * two[1] - one[1] * two[0],
    )
    between = one[0] * two[0] + one[1] * two[1] + one[2] * two[2]
    across1 = cosine * one[1] - sine * one[2]
    across2 = cosine * two[1] - sine * two[2]
    edge = sine * z - cosine * y
    return Cut(
        joint1=one, joint2=two, line=line, between=between, square=1.0 - between * between,
        across1=across1, across2=across2, edge=edge, aside=x,
        d1=x * across1 + edge * one[0], d2=x * across2 + edge * two[0],
        d3=x * line[0] + y * line[1] + z * line[2], d4=sine * line[1] + cosine * line[2], a1=one[0] * sine,
    )  # fmt: skip


def forms(cut: Cut) -> Value:
    """Whether the planes cut a wedge beyond doubt."""
    thin, low = np.abs(cut.d4), np.abs(cut.a1)
    least = thin * -_FLAT
    apart = (cut.square > _FLAT) & (low > _CLEAR) & (np.abs(cut.d2) > _CLEAR) & (thin > _THIN)
    return apart & (cut.d3 * cut.d4 < least) & (cut.line[2] * cut.d4 < least) & (cut.d1 * cut.a1 > low * _CLEAR)


def forces_of(given: Mapping[str, Value], cut: Cut) -> Forces:
    ratio = cut.d2 / cut.d1
    area2 = cut.a1 * -3.0 / (given["height_m"] * given["unit_weight_kn_m3"] * cut.d4)
    area1 = area2 * ratio
    size1, size2 = np.abs(area1), np.abs(area2)

    pull, effort = _pull(given, cut)
    pull1, pull2, driving = (_dot(pull, vector) for vector in (cut.joint1, cut.joint2, cut.line))
    normal1 = (cut.between * pull2 - pull1) / cut.square
    normal2 = (pull2 - cut.between * pull1) / cut.square
    balance = effort
    pressures = _pressures(given, cut, ratio)
    if pressures is not None:
        normal1, normal2 = normal1 - pressures[0] * area1, normal2 - pressures[1] * area2
        if pressures[0] is pressures[1]:
            water = pressures[0] * (size1 + size2)
        else:
            water = np.abs(pressures[0]) * size1 + np.abs(pressures[1]) * size2
        balance = water if _is_none(effort) else effort + water
    bonds = size1 * given["cohesion1_kpa"], size2 * given["cohesion2_kpa"]
    tangents = np.tan(given["friction1_deg"] * _RADIAN), np.tan(given["friction2_deg"] * _RADIAN)
    return Forces(
        (area1, area2), (normal1, normal2), (cut.joint1[2], cut.joint2[2]), cut.line[2], cut.between, cut.square,
        driving, bonds, tangents, balance, effort,
    )  # fmt: skip


def _pressures(given: Mapping[str, Value], cut: Cut, ratio: Value) -> Pair | None:
    """Mean pressures on J1 and J2, as given or γ_w H/6 with the total height H; None where it is dry."""
    if "pressure1_kpa" in given:
        return given["pressure1_kpa"], given["pressure2_kpa"]
    fill = given["fill"]
    if isinstance(fill, float) and fill == 0.0:
        return None
    # heights of crest 2 and of the back, by that of crest 1
    crest2 = cut.joint2[0] / (cut.joint1[0] * ratio)
    back = cut.line[2] * cut.d1 / (cut.a1 * cut.d3)
    total = np.maximum(np.maximum(crest2, back), 1.0) - np.minimum(crest2, 0.0)
    mean = total * given["height_m"] * fill * (given["water_unit_weight_kn_m3"] / 6.0)
    return mean, mean


def _pull(given: Mapping[str, Value], cut: Cut) -> tuple[Vector | None, Value]:
    """What the rock has to hold against, g, and its size; None and 0 where the weight alone acts beside the water."""
    if not ("seismic" in given or "force_east_kn" in given):
        return None, 0.0
    along, out, up, effort = 0.0, 0.0, 1.0, 1.0
    facing = given["face_dip_direction_deg"] * _RADIAN
    if "seismic" in given:
        shake = given["seismic"]
        if "seismic_trend_deg" in given:
            trend = given["seismic_trend_deg"] * _RADIAN - facing
            toward = np.sin(trend), np.cos(trend)
        else:  # down the line of intersection
            east, north, rise = cut.line
            level = np.copysign(np.sqrt(east * east + north * north), rise)
            toward = east / -level, north / -level
        along, out = -shake * toward[0], -shake * toward[1]
        effort = effort + np.abs(shake)
    if "force_east_kn" in given:
        east, north, rise = (given[f"force_{way}_kn"] for way in ("east", "north", "up"))
        sine, cosine = np.sin(facing), np.cos(facing)
        high = given["height_m"] / cut.a1
        thick = cut.d1 * cut.d4
        part = np.abs(cut.d2 * cut.d3 / (high * high * high * thick * thick)) * 6.0 / given["unit_weight_kn_m3"]  # 1/W
        along = along - (east * cosine - north * sine) * part
        out = out - (east * sine + north * cosine) * part
        up = up - rise * part
        effort = effort + (np.abs(east) + np.abs(north) + np.abs(rise)) * part
    return (along, out, up), effort


def _dot(pull: Vector | None, vector: Vector) -> Value:
    """The scalar product; the vector's z where the pull is the weight's."""
    return vector[2] if pull is None else pull[0] * vector[0] + pull[1] * vector[1] + pull[2] * vector[2]


class Modes(NamedTuple):
    """What the normal forces say: factor on both joints, and which wedges are, or may be, on which joints."""

    factor: Value
    on_both: Value  # beyond doubt
    upward: Value  # if on both
    on_first: Value  # if on one: J1 rather than J2


def modes_of(forces: Forces) -> Modes:
    size1, size2 = np.abs(forces.normal[0]), np.abs(forces.normal[1])
    resisting = forces.bonds[0] + forces.bonds[1] + size1 * forces.tangents[0] + size2 * forces.tangents[1]
    root, driving = np.sqrt(forces.square), np.abs(forces.driving)
    presses1, presses2 = (normal * area > 0.0 for normal, area in zip(forces.normal, forces.areas, strict=True))
    on_both = presses1 & presses2 & (size1 > _CONTACT) & (size2 > _CONTACT)
    if not _is_none(forces.balance):
        on_both = on_both & (resisting > _BALANCE * forces.balance)
    upward: Value = False
    if not _is_none(forces.effort):
        on_both = on_both & (driving > _BALANCE * forces.effort * root)
        upward = forces.driving * forces.rise < 0.0
    # where neither presses, the one that pulls less
    on_first = presses1 | ((size1 < size2) & ~presses2)
    return Modes(resisting * root / driving, on_both, upward, on_first)


class Alone(NamedTuple):
    """Of wedges that J1 or J2 carries alone, if any joint does: the forces by its own part and the other's."""

    normal: Value
    area: Value
    up: Value
    bond: Value
    tangent: Value
    other_normal: Value
    other_area: Value
    other_up: Value
    rise: Value
    between: Value
    square: Value
    driving: Value
    balance: Value


def alone_on(forces: Forces, own: int) -> Alone:
    """The forces as J1 (0) or J2 (1) needs them."""
    other = 1 - own
    return Alone(
        forces.normal[own], forces.areas[own], forces.up[own], forces.bonds[own], forces.tangents[own],
        forces.normal[other], forces.areas[other], forces.up[other],
        forces.rise, forces.between, forces.square, forces.driving, forces.balance,
    )  # fmt: skip


def slides_on_one(joint: int, alone: Alone) -> Pair:
    """Outcome and factor of a wedge on J1 (0) or J2 (1), or off both; `UNSURE` where it is too close to call."""
    other = alone.other_normal
    normal = alone.normal - alone.between * other
    carried = np.abs(normal)
    resisting = alone.bond + carried * alone.tangent
    along = np.sqrt(alone.driving * alone.driving / alone.square + alone.square * (other * other))
    # z of the resultant along the joint: up where water under the other joint pushes it there
    push = other * (alone.other_up - alone.up * alone.between)
    climb = (push if joint == 1 else -push) - alone.driving * alone.rise / alone.square
    size = np.abs(alone.normal) + np.abs(other) + 2.0 * np.abs(alone.balance)
    least = _CONTACT * (1.0 + size)

    sure = (other * alone.other_area < 0.0) & (np.abs(other) > least) & (carried > least)
    presses = normal * alone.area > 0.0
    slides = sure & presses & (np.abs(climb) > least)
    slides = slides & (resisting > _BALANCE * size * alone.tangent)
    slides = slides & (along > _BALANCE * size * np.sqrt(alone.square))
    code = NUMBER_OF["slides_on_J1"] + joint
    outcome = slides * float(code - UNSURE) + (slides & (climb > 0.0)) * float(NUMBER_OF["slides_up"] - code)
    # never "falls": were both normals to point down, the wedge would reach down between them without end
    outcome = outcome + (sure & ~presses) * float(NUMBER_OF["lifted"] - UNSURE) + float(UNSURE)
    return outcome, resisting * slides / (along * slides)  # 0 / 0 where it does not slide


def refused(turns: Turns) -> Pair:
    """Why planes cut no wedge: the tests of `geometry.rockmass` in its order, by signs; `UNSURE` where they are small.

    The factor is nan.
    """
    sine, cosine = turns.face
    cut = cut_of(turns)
    east, north, rise = cut.line
    apart = np.minimum(east * east + north * north + rise * rise, cut.edge * cut.edge + cut.aside * cut.aside)
    for across, joint in ((cut.across1, cut.joint1), (cut.across2, cut.joint2)):
        apart = np.minimum(apart, across * across + joint[0] * joint[0])  # the joint and the face
    ordinary = (apart > _SIGN) & (sine > _SIGN) & (cosine > -_SIGN)  # a face that hangs over dips the other way

    out_of_face, over_upper, ahead = rise * cut.d4, cut.d3 * cut.d4, north * rise
    steep, reaches = ordinary & (out_of_face > _SIGN), ordinary & (out_of_face < -_SIGN)
    no_crest = (over_upper < -_SIGN) & (cut.d1 * cut.a1 < -_SIGN) & (np.abs(cut.a1) > _TRACE)
    outcome: Value = float(UNSURE)
    for code, where in (
        ("E204", steep & (ahead > _SIGN)),
        ("E203", steep & (ahead < -_SIGN)),
        ("E205", reaches & (over_upper > _SIGN)),
        ("E209", reaches & no_crest),
    ):
        outcome = outcome + where * float(NUMBER_OF[code] - UNSURE)
    return outcome, math.nan


def _is_none(value: Value) -> bool:
    return isinstance(value, float) and value == 0.0
