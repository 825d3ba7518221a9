"""The corners of the largest wedge that planes can form, or why they form none, in the local frame, toe at the origin.

All planes are `normal · x = offset`. The joints and the face pass through the toe; the upper slope passes through
the point where the trace of joint 1 meets the crest, `height` above the toe (Hoek & Bray's H1).
"""

import math
from collections.abc import Sequence

import numpy as np

from slopekit.core.arrays import Floats, cross
from slopekit.core.errors import Fault, GeometryError
from slopekit.core.orientation import downward, line_of, opposite
from slopekit.geometry.tolerances import NEARLY_PARALLEL, SAME_DIRECTION

_COULD_OVERHANG = (
    70.0  # dip from which a face written by its other side is an overhang, not a slip of 180°
)


def wedge_corners(
    joints: Floats,
    face: Floats,
    upper: Floats,
    height: float,
    crack: Floats | None = None,
    distance: float = 0.0,
) -> tuple[Floats, Floats, Floats]:
    """Return the back of a wedge without its crack, and the points where J1 and J2 meet the crest, (3,) m each.

    The line of intersection runs from the back down to the toe.

    Parameters
    ----------
    joints : (2, 3); face, upper, crack : (3,) upward unit normals
    height : vertical height (m) from the toe to where the trace of joint 1 meets the crest
    distance : from the crest to the crack along the trace of joint 1 on the upper slope (m)

    Raises
    ------
    GeometryError
        E201 parallel joints, E203-E205 the line of intersection does not daylight, E206 a joint parallel to
        the face, E207 crack outside the wedge, E209 face and upper slope make no crest.
    """
    line, crest1, crest2, offset = traces_of(joints, face, upper, height, daylights=True)
    into_rock = _into_rock(line, face)
    back = into_rock * (offset / float(upper @ into_rock))
    if crack is not None:
        _refuse_crack(crack, distance, back, crest1, (*joints, upper))
    return back, crest1, crest2


def traces_of(
    joints: Floats, face: Floats, upper: Floats, height: float, *, daylights: bool
) -> tuple[Floats, Floats, Floats, float]:
    """Return the line of intersection, the points where the joints meet the crest, and the upper slope's offset.

    Parameters
    ----------
    daylights : whether the line of intersection has to daylight

    Raises
    ------
    GeometryError
        E201, E206, E209 and, where the line has to daylight, E203-E205.
    """
    line = cross(joints[0], joints[1])
    sine = math.sqrt(float(line @ line))
    if sine < SAME_DIRECTION:
        raise GeometryError(
            [_parallel_fault("E201", "J1 and J2", "they never meet in a line", sine)]
        )
    crest_edge = cross(face, upper)
    if math.sqrt(float(crest_edge @ crest_edge)) < SAME_DIRECTION:
        raise no_crest()
    traces = [cross(joint, face) for joint in joints]
    for k, trace in enumerate(traces):
        if math.sqrt(float(trace @ trace)) < SAME_DIRECTION:
            raise GeometryError(
                [
                    _parallel_fault(
                        "E206", f"J{k + 1} and the face", "the joint does not cut the face", 0.0
                    )
                ]
            )
    if daylights:
        _check_daylight(line / sine, _into_rock(line / sine, face), face, upper, sine)
    if abs(traces[0][2]) < SAME_DIRECTION:
        message = "the trace of J1 on the face is horizontal: it never climbs to the crest"
        advice = (
            "Number the joints the other way round." if abs(traces[1][2]) > SAME_DIRECTION else ""
        )
        raise GeometryError([Fault("E206", message, "", advice)])

    crest1 = traces[0] * (height / traces[0][2])
    offset = float(upper @ crest1)
    if offset <= 0.0:
        message = "the upper slope climbs faster than the face: they make no crest above the toe"
        raise GeometryError([Fault("E209", message)])
    climb = float(upper @ traces[1])
    if abs(climb) < SAME_DIRECTION * math.sqrt(float(traces[1] @ traces[1])):
        message = "the trace of J2 on the face runs along the crest and never meets it"
        raise GeometryError([Fault("E206", message)])
    return line / sine, crest1, traces[1] * (offset / climb), offset


def _into_rock(line: Floats, face: Floats) -> Floats:
    return -line if face @ line > 0.0 else line


def no_crest() -> GeometryError:
    """Return the error E209 of a face and an upper slope of the same orientation: they make no crest."""
    return GeometryError(
        [Fault("E209", "face and upper slope have the same orientation: there is no crest")]
    )


def _check_daylight(
    line: Floats, into_rock: Floats, face: Floats, upper: Floats, sine: float
) -> None:
    """Refuse a line of intersection that does not come out of the face below the upper slope."""
    if (
        float(upper @ into_rock) > 1e-12
        and into_rock[2] > 1e-12
        and float(face @ into_rock) < -1e-12
    ):
        return
    down = line_of(downward(line))
    parallel_note = ""
    if sine < NEARLY_PARALLEL:
        parallel_note = (
            f" J1 and J2 are only {math.degrees(math.asin(sine)):.2g}° apart: "
            "a small change of either moves the line far."
        )
    if abs(down.plunge_deg) < 1e-9:
        message = f"the line of intersection is horizontal (trend {down.trend_deg:05.1f}): it does not daylight"
        raise GeometryError([Fault("E204", message, "", parallel_note.strip())])
    face_dip, upper_dip = line_of(_dip_vector(face)), line_of(_dip_vector(upper))
    trend_difference = math.radians(down.trend_deg - face_dip.trend_deg)
    if math.cos(trend_difference) <= 0.0:
        message = (
            f"the line of intersection plunges {down.plunge_deg:.1f}° toward {down.trend_deg:05.1f}, into the slope "
            f"(the face dips toward {face_dip.trend_deg:05.1f}): it does not daylight"
        )
        trends = f"It trends {math.degrees(math.acos(math.cos(trend_difference))):.1f}° from the face's dip direction."
        if face_dip.plunge_deg >= _COULD_OVERHANG:
            trends += (
                f" A face that overhangs toward {opposite(face_dip.trend_deg):05.1f} cuts no wedge here; "
                "blocks below one are meshes of kind: blocks."
            )
        raise GeometryError([Fault("E204", message, "", trends + parallel_note)])
    apparent_face = math.degrees(
        math.atan(math.tan(math.radians(face_dip.plunge_deg)) * math.cos(trend_difference))
    )
    if down.plunge_deg >= apparent_face - 1e-9:
        steeper = f"the face ({face_dip.plunge_deg:.4g}°)"
        if down.plunge_deg <= face_dip.plunge_deg:
            steeper = f"the face along its trend ({apparent_face:.1f}°)"
        message = (
            f"the line plunges {down.plunge_deg:.1f}°, steeper than {steeper}: it does not daylight"
        )
        advice = (
            f"Along trend {down.trend_deg:05.1f} the face falls at {apparent_face:.1f}°: "
            f"{down.plunge_deg - apparent_face:.2g}° too steep.{parallel_note}"
        )
        raise GeometryError([Fault("E203", message, "", advice)])
    trend_difference = math.radians(down.trend_deg - upper_dip.trend_deg)
    apparent_upper = math.degrees(
        math.atan(math.tan(math.radians(upper_dip.plunge_deg)) * math.cos(trend_difference))
    )
    message = (
        f"the line plunges {down.plunge_deg:.1f}°, flatter than the upper slope ({upper_dip.plunge_deg:.4g}°): "
        "it never reaches the upper slope"
    )
    advice = (
        f"Along trend {down.trend_deg:05.1f} the upper slope falls at {apparent_upper:.1f}°: "
        f"{apparent_upper - down.plunge_deg:.2g}° too flat.{parallel_note}"
    )
    raise GeometryError([Fault("E205", message, "", advice)])


def _dip_vector(normal: Floats) -> Floats:
    """Return the down-dip vector of a plane (not of unit length); the y axis where the plane is horizontal."""
    flat = math.hypot(normal[0], normal[1])
    if flat < 1e-12:
        return np.array([0.0, 1.0, 0.0])
    return np.array([normal[0] * normal[2] / flat, normal[1] * normal[2] / flat, -flat])


def _parallel_fault(code: str, planes: str, consequence: str, sine: float) -> Fault:
    degrees = math.degrees(math.asin(min(1.0, sine)))
    return Fault(code, f"{planes} are parallel (to {degrees:.2g}°): {consequence}")


def _refuse_crack(
    crack: Floats, distance: float, back: Floats, crest1: Floats, planes: Sequence[Floats]
) -> None:
    """Refuse a crack that does not cross the wedge."""
    for plane, name in zip(planes, ("J1", "J2", "the upper slope"), strict=True):
        across = cross(crack, plane)
        if math.sqrt(float(across @ across)) < SAME_DIRECTION:
            raise GeometryError(
                [Fault("E207", f"the crack is parallel to {name}: it cuts no wedge off")]
            )
    trace = back - crest1
    length = math.sqrt(float(trace @ trace))
    if distance >= length:
        message = (
            f"the crack lies {distance:.6g} m behind the crest, the wedge ends at {length:.6g} m"
        )
        raise GeometryError(
            [
                Fault(
                    "E207",
                    message,
                    "",
                    "The wedge has no tension crack there: leave the crack out.",
                )
            ]
        )
    crossing = float(crack @ back)
    if abs(crossing) < SAME_DIRECTION * math.sqrt(float(back @ back)):
        raise GeometryError(
            [
                Fault(
                    "E207", "the crack is parallel to the line of intersection: it never crosses it"
                )
            ]
        )
    fraction = float(crack @ (crest1 + trace * (distance / length))) / crossing
    if not 1e-9 < fraction < 1.0 - 1e-9:
        message = "the crack does not cross the line of intersection inside the wedge"
        advice = "It would cut off the toe." if fraction <= 0.0 else "It passes behind the wedge."
        raise GeometryError([Fault("E207", message, "", advice)])
