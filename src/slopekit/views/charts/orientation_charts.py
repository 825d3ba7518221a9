"""The stereonet of any document with orientations (matplotlib): planes, poles, lines of intersection, friction cones.

Needs the extra `plot`.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.orientation import Line, Plane, downward, line_of, number, parse_plane, tenths
from slopekit.studies.kinematic.criteria import zones_of_lines, zones_of_poles
from slopekit.studies.surveys import LATERAL_DEG
from slopekit.views.charts.drawing import (
    BLUE,
    COLOURS,
    DARK,
    GREY,
    MARKERS,
    RED,
    refuse_empty_chart,
    short,
    title_of,
)
from slopekit.views.charts.stereonet import (
    FACE,
    LIGHT,
    MARKED,
    NET,
    SHADE,
    Stereonet,
    arrange,
    cells,
    daylight_envelope,
    great_circle,
)

Document = Mapping[str, Any]
_MOST_JOINTS = 12  # that are drawn and listed one by one
_MOST_LINES = 6  # of intersection that are written out
_MOST_CONES = 6  # friction angles beyond which only the least and the greatest are drawn
_PARALLEL = 1e-6


@dataclass(frozen=True)
class Oriented:
    """The orientations of a document: joints by name, the slope's planes, friction angles in degrees by joint."""

    joints: Mapping[str, Plane]
    slope: Mapping[str, Plane]
    friction_deg: Mapping[str, float]

    @property
    def is_planar(self) -> bool:
        """Whether one joint alone can slide: no lines of intersection, its pole says all."""
        return len(self.joints) == 1

    @property
    def frictions(self) -> list[float]:
        """The friction angles there are, rising."""
        return sorted(set(self.friction_deg.values()))


def orientations_of(document: Document) -> Oriented:
    """Return the orientations of a document; empty where it has none, or no joint with a direction."""
    inputs: Any = document.get("inputs")
    inputs = inputs if isinstance(inputs, Mapping) else {}
    joints: dict[str, Plane] = {}
    friction: dict[str, float] = {}
    if isinstance(inputs.get("joints"), Mapping):  # wedge
        joints = {name: parse_plane(plane, name) for name, plane in inputs["joints"].items()}
        if isinstance(basal := inputs.get("basal"), Mapping):
            joints["basal"] = parse_plane(basal["plane"], "basal")
        friction = dict(zip(joints, inputs.get("friction_angle_deg") or (), strict=False))
    elif isinstance(inputs.get("joint"), str):  # plane
        name = str(inputs.get("joint_name") or "J1")
        joints = {name: parse_plane(inputs["joint"], name)}
        friction = {name: inputs["strength"]["friction_angle_deg"]}
    elif isinstance(inputs.get("sets"), list):  # bench
        strengths = {
            name: strength["friction_angle_deg"] for name, strength in inputs.get("strengths") or ()
        }
        for joint_set in inputs["sets"]:
            joints[joint_set["name"]] = parse_plane(joint_set["plane"], joint_set["name"])
            if joint_set.get("strength") in strengths:
                friction[joint_set["name"]] = strengths[joint_set["strength"]]
    elif document.get("kind") == "combos":
        for pair in document.get("worst") or ():
            joints |= {
                name: parse_plane(plane, name)
                for name, plane in zip(pair["joints"], pair["planes"], strict=True)
            }
        friction = {f"φ {end}": inputs["friction_deg"][end] for end in ("least", "most")}
    slope = {
        name: parse_plane(inputs[name], name)
        for name in ("face", "upper")
        if isinstance(inputs.get(name), str)
    }
    crack = inputs.get("crack")
    if isinstance(crack, Mapping) and isinstance(crack.get("plane"), str):
        slope["crack"] = parse_plane(crack["plane"], "crack")
    elif (
        isinstance(crack, Mapping) and "face" in slope
    ):  # of a plane: upright, parallel to the face
        slope["crack"] = Plane(90.0, slope["face"].dip_direction_deg)
    return Oriented(joints, slope, friction)


def draw_orientations(figure: Any, document: Document) -> None:
    """Great circles and poles of joints and slope, lines of intersection, friction cones, the zone of sliding.

    Raises
    ------
    DesignError
        E273 where the document has no orientations.
    """
    orientations = orientations_of(document)
    if not orientations.joints:
        refuse_empty_chart("the document has no joint with dip and dip direction")
    net = Stereonet(figure.subplots())
    net.start("")
    face = orientations.slope.get("face")
    if face is not None and orientations.frictions:
        _sliding_zone(net, orientations, face)
    styles: dict[str, tuple[str, dict[str, Any]]] = {
        "face": ("face", {"color": FACE, "linewidth": 2.0}),
        "upper": ("upper slope", {"color": GREY}),
        "crack": ("tension crack", {"color": DARK, "linestyle": "--"}),
    }
    for name, plane in orientations.slope.items():
        label, style = styles[name]
        net.arc(great_circle(plane), label=f"{label} {plane}", **style)
    if face is not None:
        dashed = "-" if orientations.is_planar else "--"
        net.arc(
            daylight_envelope(face),
            color=FACE,
            linestyle=dashed,
            label="daylight envelope of poles",
        )
    _joints(net, orientations)
    _friction_cones(net, orientations)
    _intersections(net, document, orientations)
    arrange(figure, [net.axes], 1, f"{title_of(document)}\nlower hemisphere, {NET}")


def _sliding_zone(net: Stereonet, orientations: Oriented, face: Plane) -> None:
    """Draw the zone of sliding: lines of intersection, or poles of a single joint, that slide out of the face."""
    least = orientations.frictions[0]
    steeper = f"daylight, steeper than φ {number(least)}°{', the least' if len(orientations.frictions) > 1 else ''}"
    if not orientations.is_planar:
        zone = zones_of_lines(cells()[0], face, least, 90.0, 90.0)["wedge_primary"]
        net.shade(zone, SHADE, f"lines here {steeper}")
        return
    zones = zones_of_poles(cells()[0], face, least, LATERAL_DEG, 90.0)
    net.shade(zones["planar_without_limits"], LIGHT, f"poles here {steeper}")
    net.shade(zones["planar"], SHADE, "the same within the lateral limits")
    net.spokes(face.dip_direction_deg + 180.0, LATERAL_DEG)


def _friction_cones(net: Stereonet, orientations: Oriented) -> None:
    """Friction circle and cone of each angle."""
    frictions = orientations.frictions
    if len(frictions) > _MOST_CONES:
        frictions = [frictions[0], frictions[-1]]
    for friction in frictions:
        if not orientations.is_planar:
            net.steeper_than(
                friction,
                color=BLUE,
                label=f"friction circle, φ {number(friction)}°: steeper within",
            )
        net.steeper_than(
            90.0 - friction,
            color=BLUE,
            linestyle="--",
            label=f"friction cone of poles, φ {number(friction)}°: steeper outside",
        )


def _joints(net: Stereonet, orientations: Oriented) -> None:
    listed_joints = list(orientations.joints.items())[:_MOST_JOINTS]
    for k, (name, plane) in enumerate(listed_joints):
        line = {"color": COLOURS[k % len(COLOURS)], "linestyle": "-" if k < len(COLOURS) else "-."}
        pole = {
            "color": line["color"],
            "marker": MARKERS[k % len(MARKERS)],
            "markeredgecolor": "black",
        }
        friction = orientations.friction_deg.get(name)
        rough = "" if friction is None else f", φ {number(friction)}°"
        net.arc(great_circle(plane), **line)
        net.points(-plane.normal()[None], markersize=8, zorder=MARKED, **pole)
        net.axes.plot(
            [], [], label=f"{short(name, 16)} {tenths(plane)}{rough}, with its pole", **line | pole
        )
    unlisted_planes = list(orientations.joints.values())[_MOST_JOINTS:]
    if unlisted_planes:
        net.points(
            np.array([-plane.normal() for plane in unlisted_planes]),
            marker="o",
            color=GREY,
            label=f"poles of {len(unlisted_planes)} more joints",
        )


def _intersections(net: Stereonet, document: Document, orientations: Oriented) -> None:
    """Lines of intersection: of a combos document those of the worst pairs, else of all pairs of joints."""
    named_lines: list[tuple[str, Floats]] = []
    if document.get("kind") == "combos":
        for pair in document["worst"]:
            a, b = (parse_plane(plane, "joint").normal() for plane in pair["planes"])
            named_lines.append((" x ".join(pair["joints"]), downward(np.cross(a, b))))
    else:
        listed_joints = list(orientations.joints.items())[:_MOST_JOINTS]
        for (first_name, first), (second_name, second) in combinations(listed_joints, 2):
            line = downward(np.cross(first.normal(), second.normal()))
            named_lines.append((f"{short(first_name, 12)} x {short(second_name, 12)}", line))
    lines = [
        (name, line / size)
        for name, line in named_lines
        if (size := float(np.sqrt(line @ line))) >= _PARALLEL
    ]
    for k, (name, line) in enumerate(lines[:_MOST_LINES]):
        marker = MARKERS[k % len(MARKERS)]
        net.points(
            line[None],
            marker=marker,
            color=RED,
            markeredgecolor="black",
            markersize=9,
            zorder=MARKED,
            label=f"line {name}: {_direction(line)}",
        )
    unlisted_lines = lines[_MOST_LINES:]
    if unlisted_lines:
        net.points(
            np.array([line for _, line in unlisted_lines]),
            marker="o",
            color=RED,
            zorder=MARKED,
            label=f"{len(unlisted_lines)} more lines of intersection",
        )


def _direction(vector: Floats) -> str:
    """Trend and plunge to a tenth of a degree."""
    line = line_of(vector)
    return str(Line(round(line.trend_deg, 1) % 360.0, line.plunge_deg))
