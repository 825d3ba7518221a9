"""The stereonets of studies of surveys (matplotlib), from their JSON. Need the extra `plot`.

Of a kinematic study one for each test: the critical zones are the criteria themselves, asked of every cell of the net,
lines drawn on them are geometry. Of joint sets the poles by set, contours, means and cones.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.core.orientation import Line, Plane, normals, number, parse_plane
from slopekit.studies.kinematic.criteria import (
    Planes,
    lines_of,
    modes_of,
    tested_pairs,
    zones_of_lines,
    zones_of_poles,
)
from slopekit.studies.sets.density import density
from slopekit.views.charts.drawing import BLUE, GREY, PURPLE, RED, short
from slopekit.views.charts.stereonet import (
    FACE,
    FRAME,
    LIGHT,
    MARKED,
    NET,
    SHADE,
    Stereonet,
    arrange,
    cells,
    daylight_envelope,
    great_circle,
    lower,
    poles_by_set,
    unproject,
)

Document = Mapping[str, Any]
#: What `--test` takes; toppling is both of the last.
TESTS = ("planar", "wedge", "toppling", "flexural", "direct")
#: One net each.
NETS_OF = ("planar", "wedge", "flexural", "direct")
_ACROSS = 121  # points of the grid that contours are drawn through
_KAMB = (2, 4, 6, 8, 12, 16, 24, 32, 48, 64)  # σ above uniform
_LEAST_DEG = 0.3  # a cone that is seen


class _Survey:
    """A kinematic study as its JSON has it, and what could move in it."""

    def __init__(self, document: Document) -> None:
        rows, inputs = document["orientations"], document["inputs"]
        dips, ways, self.friction = (
            np.array([row[key] for row in rows], dtype=float)
            for key in ("dip_deg", "dip_direction_deg", "friction_deg")
        )
        self.planes = Planes(dips, ways)
        self.poles = -self.planes.normals()
        self.least, self.most = float(self.friction.min()), float(self.friction.max())
        self.sets = [str(row["set"]) for row in rows]
        self.named_sets = sorted({name for name in self.sets if name})
        self.face = parse_plane(inputs["face"], "face")
        self.limits: tuple[float, float] = inputs["lateral_deg"], inputs["lateral_toppling_deg"]
        pairs = tested_pairs(self.planes, np.random.default_rng(inputs.get("seed", 1)))
        self.lines = lines_of(self.planes, pairs)
        self.modes = modes_of(self.planes, self.lines, self.face, self.friction, *self.limits)

    def zones(
        self, criterion: Callable[..., dict[str, Bools]], friction: float | None = None
    ) -> dict[str, Bools]:
        return criterion(
            cells()[0], self.face, self.least if friction is None else friction, *self.limits
        )


def draw_kinematic(figure: Any, document: Document, test: str | None = None) -> None:
    """All tests, or one of `TESTS`."""
    by_test = {"planar": [_planar], "wedge": [_wedge], "flexural": [_flexural], "direct": [_direct]}
    by_test["toppling"] = by_test["flexural"] + by_test["direct"]
    chosen = by_test[test] if test else [panel for name in NETS_OF for panel in by_test[name]]
    across = min(2, len(chosen))
    survey = _Survey(document)
    panels = list(np.ravel(figure.subplots(len(chosen) // across, across)))
    for axes, panel in zip(panels, chosen, strict=True):
        panel(Stereonet(axes), survey)
    n = len(survey.planes)
    name = short(str(document["survey"]["name"]), 50)
    head = f"{name}: {n} joint{'s' * (n != 1)}, face {survey.face}, φ {_friction_range(survey)}"
    head += (
        "\n" if across == 1 else "   "
    ) + f"(lower hemisphere, {NET}; sha {document['input_sha256'][:6]})"
    arrange(figure, panels, across, head)


def _zone_friction(survey: _Survey, most: bool = False) -> str:
    """Which friction angle a zone is drawn for, where joints have their own."""
    if survey.least == survey.most:
        return ""
    return (
        f" at φ {number(survey.most)}°, the greatest"
        if most
        else f" at φ {number(survey.least)}°, the least"
    )


def _friction_range(survey: _Survey) -> str:
    low, high = number(survey.least), number(survey.most)
    return f"{low}°" if low == high else f"{low} to {high}°, each joint its own"


def _planar(net: Stereonet, survey: _Survey) -> None:
    planar, free = survey.modes.planar, survey.modes.planar_without_limits
    net.start(
        f"Planar sliding, poles: {_share(planar, 'joint')}, {int(free.sum())} without lateral limits"
    )
    zone = survey.zones(zones_of_poles)
    net.shade(zone["planar_without_limits"], LIGHT, "critical without lateral limits")
    net.shade(zone["planar"], SHADE, f"critical{_zone_friction(survey)}")
    net.arc(daylight_envelope(survey.face), color=FACE, label="daylight envelope")
    _draw_face(net, survey)
    for friction, style in _friction_styles(survey):
        label = f"pole friction cone, φ {number(friction)}°"
        net.steeper_than(90.0 - friction, color=BLUE, linestyle=style, label=label)
    net.spokes(survey.face.dip_direction_deg + 180.0, survey.limits[0])
    _draw_poles(net, survey, planar, "slides")


def _wedge(net: Stereonet, survey: _Survey) -> None:
    lines = survey.modes.of_lines()
    primary, secondary, many = lines["wedge_primary"], lines["wedge_secondary"], lines["wedge"]
    net.start(f"Wedge sliding, lines of intersection: {_share(many, 'line')}")
    zone = survey.zones(zones_of_lines)
    net.shade(zone["wedge_secondary_of_dips"], LIGHT, "secondary zone as Dips draws it")
    net.shade(zone["wedge_primary"], SHADE, f"primary zone{_zone_friction(survey)}")
    _draw_face(net, survey)
    for friction, style in _friction_styles(survey):
        label = f"friction circle, φ {number(friction)}°: steeper within"
        net.steeper_than(friction, color=BLUE, linestyle=style, label=label)
    _draw_intersections(net, survey, ~many, GREY, ".", "not critical")
    _draw_intersections(net, survey, secondary, PURPLE, "^", "secondary: slides on one joint")
    _draw_intersections(net, survey, primary, RED, "o", "primary: line steeper than friction")


def _flexural(net: Stereonet, survey: _Survey) -> None:
    flexural = survey.modes.flexural
    net.start(f"Flexural toppling, poles: {_share(flexural, 'joint')}")
    net.shade(survey.zones(zones_of_poles)["flexural"], SHADE, f"critical{_zone_friction(survey)}")
    _draw_face(net, survey)
    for friction, style in _friction_styles(survey):
        slip = survey.face.dip_deg - friction
        if slip >= 0.0:
            net.arc(
                great_circle(Plane(slip, survey.face.dip_direction_deg)),
                color=BLUE,
                linestyle=style,
                label=f"slip limit: face less φ, {number(slip)}°",
            )
    net.spokes(survey.face.dip_direction_deg, survey.limits[1])
    _draw_poles(net, survey, flexural, "topples")


def _direct(net: Stereonet, survey: _Survey) -> None:
    lines, joints = survey.modes.of_lines(), survey.modes.of_joints()
    base = joints["base_sliding"] | joints["base_release"] | joints["base_oblique"]
    edges = lines["direct"] | lines["oblique"]
    net.start(f"Direct toppling: {_share(edges, 'line')}; base planes: {_share(base, 'joint')}")
    zone = survey.zones(zones_of_lines, survey.most)
    net.shade(zone["oblique"], LIGHT, "oblique")
    net.shade(zone["direct"], SHADE, f"direct{_zone_friction(survey, most=True)}")
    _draw_face(net, survey)
    net.steeper_than(
        90.0 - survey.face.dip_deg,
        color=BLUE,
        label="lines: plunge of the normal to the face; poles: its dip",
    )
    net.steeper_than(
        90.0 - survey.most,
        color=BLUE,
        linestyle="--",
        label=f"friction cone about the vertical, φ {number(survey.most)}°",
    )
    net.spokes(survey.face.dip_direction_deg + 180.0, survey.limits[1])
    _draw_intersections(net, survey, ~edges, GREY, ".", "lines, not critical")
    _draw_intersections(net, survey, lines["oblique"], PURPLE, "^", "lines, oblique")
    _draw_intersections(net, survey, lines["direct"], RED, "o", "lines, direct")
    for kind, face, label in (
        ("base_sliding", "black", "bases that slide too"),
        ("base_release", "white", "bases that release"),
        ("base_oblique", "#bbbbbb", "bases that release obliquely"),
    ):
        base_poles = survey.poles[joints[kind]]
        net.points(
            base_poles,
            marker="s",
            color="black",
            markerfacecolor=face,
            zorder=MARKED,
            label=f"{label}, poles ({len(base_poles)})",
        )


# -- parts ------------------------------------------------------------------------------------------------------------


def _share(critical: Bools, noun: str) -> str:
    return f"{int(critical.sum())} of {len(critical)} {noun}{'s' * (len(critical) != 1)}"


def _friction_styles(survey: _Survey) -> list[tuple[float, str]]:
    """The least and the greatest friction angle with their line styles."""
    both = [(survey.least, "-"), (survey.most, ":")]
    return both[:1] if survey.least == survey.most else both


def _draw_face(net: Stereonet, survey: _Survey) -> None:
    net.arc(great_circle(survey.face), color=FACE, linewidth=2.0, label=f"face {survey.face}")


def _draw_poles(net: Stereonet, survey: _Survey, critical: Bools, verb: str) -> None:
    """Poles by set, the critical ones ringed."""
    poles_by_set(net, survey.poles, survey.sets, survey.named_sets)
    net.points(
        survey.poles[critical],
        marker="o",
        color=RED,
        markerfacecolor="none",
        markersize=8,
        zorder=MARKED,
        label=f"{verb} ({int(critical.sum())})",
    )


def _draw_intersections(
    net: Stereonet, survey: _Survey, chosen: Bools, colour: str, marker: str, label: str
) -> None:
    """Lines of intersection."""
    net.points(
        survey.lines.down[chosen],
        marker=marker,
        color=colour,
        label=f"{label} ({int(chosen.sum())})",
    )


# -- joint sets -------------------------------------------------------------------------------------------------------


def draw_sets(figure: Any, document: Document) -> None:
    """One net with all of it."""
    rows, inputs = document["orientations"], document["inputs"]
    planes = np.array(
        [(row["dip_deg"], row["dip_direction_deg"]) for row in rows], dtype=float
    ).reshape(-1, 2)
    poles = -normals(planes[:, 0], planes[:, 1])
    weights = np.array([row["weight"] for row in rows], dtype=float)
    set_names = [str(joint_set["set"]) for joint_set in document["sets"]]
    net = Stereonet(figure.subplots())
    net.start("")
    _contours(net, poles, weights, float(document["survey"].get("quantity", len(rows))))
    marks = poles_by_set(net, poles, [str(row["set"] or "") for row in rows], set_names)
    for joint_set in document["sets"]:
        _mean_pole(net, joint_set, marks[str(joint_set["set"])], inputs["confidence"])
    if set_names:
        for style, meaning in (
            ("-", f"holds the true mean ({inputs['confidence']:.0%})"),
            ("--", "holds 95 % of its joints"),
        ):
            net.axes.plot([], [], color="black", linestyle=style, label=f"cone that {meaning}")
    if inputs["scanline"] is not None:
        line = Line(float(inputs["scanline"]["trend_deg"]), float(inputs["scanline"]["plunge_deg"]))
        net.points(
            lower(line.vector()[None]),
            marker="*",
            color=RED,
            markersize=11,
            zorder=MARKED,
            label=f"scanline {line}",
        )
    name = short(str(document["survey"]["name"]), 40)
    head = (
        f"{name}: poles of {len(rows)} joint{'s' * (len(rows) != 1)}"
        f", {len(set_names)} set{'s' * (len(set_names) != 1)}"
    )
    arrange(
        figure,
        [net.axes],
        1,
        f"{head}\n(lower hemisphere, {NET}; sha {document['input_sha256'][:6]})",
    )


def _contours(net: Stereonet, poles: Floats, weights: Floats, joints: float) -> None:
    axes, middle = net.axes, np.linspace(-1.0, 1.0, _ACROSS)
    x, y = np.meshgrid(middle, middle)
    square = x * x + y * y
    # on the rim and beyond it stands the nearest direction of the rim, so that contours reach it; the rim cuts them
    inward = np.minimum(1.0, (1.0 - 1e-9) / np.sqrt(np.maximum(square, 1e-12)))
    directions = unproject(np.column_stack([(x * inward).ravel(), (y * inward).ravel()]))
    values = density(directions, poles, weights, joints).reshape(x.shape)
    levels = [level for level in _KAMB if level < values.max()]
    if not levels:
        return
    from matplotlib.patches import Circle

    most = float(values.max())
    shades = axes.contourf(
        x, y, values, levels=[*levels, most], cmap="Greys", alpha=0.5, vmin=0.0, vmax=2.0 * most
    )
    lines = axes.contour(x, y, values, levels=levels, colors=GREY, linewidths=0.5)
    for contours in (shades, lines):
        contours.set_clip_path(Circle((0.0, 0.0), 1.0, transform=axes.transData))
    axes.plot(
        [],
        [],
        color=GREY,
        label=f"{', '.join(f'{level:g}' for level in levels)} σ above uniform (Kamb)",
    )
    axes.set(xlim=FRAME, ylim=FRAME)


def _mean_pole(
    net: Stereonet, joint_set: Mapping[str, Any], mark: tuple[str, str], confidence: float
) -> None:
    """The mean pole of a set, the cone that holds the true mean, and that which holds 95 % of its joints."""
    plane = Plane(float(joint_set["dip_deg"]), float(joint_set["dip_direction_deg"]))
    pole, (colour, marker) = -plane.normal(), mark
    k = "" if joint_set["k"] is None else f", K {joint_set['k']:.3g}"
    mean = f"{plane.dip_deg:.0f}/{round(plane.dip_direction_deg) % 360:03d}{k}"
    net.points(
        pole[None],
        marker=marker,
        color=colour,
        markeredgecolor="black",
        markersize=10,
        zorder=MARKED,
        label=f"mean {short(str(joint_set['set']), 10)} {mean}",
    )
    for angle, style in (
        (joint_set["cone_of_mean_deg"], "-"),
        (joint_set["variability_deg"].get("95%"), "--"),
    ):
        if angle is not None and _LEAST_DEG < angle < 90.0:
            net.cone_circle(pole, float(angle), color=colour, linestyle=style)
