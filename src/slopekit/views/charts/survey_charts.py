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

    def zones(self, of: Callable[..., dict[str, Bools]], friction: float | None = None) -> dict[str, Bools]:
        return of(cells()[0], self.face, self.least if friction is None else friction, *self.limits)


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
    head = f"{name}: {n} joint{'s' * (n != 1)}, face {survey.face}, φ {_friction(survey)}"
    head += ("\n" if across == 1 else "   ") + f"(lower hemisphere, {NET}; sha {document['input_sha256'][:6]})"
    arrange(figure, panels, across, head)


def _at(survey: _Survey, most: bool = False) -> str:
    """Which friction angle a zone is drawn for, where joints have their own."""
    if survey.least == survey.most:
        return ""
    return f" at φ {number(survey.most)}°, the greatest" if most else f" at φ {number(survey.least)}°, the least"


def _friction(survey: _Survey) -> str:
    low, high = number(survey.least), number(survey.most)
    return f"{low}°" if low == high else f"{low} to {high}°, each joint its own"


def _planar(on: Stereonet, survey: _Survey) -> None:
    planar, free = survey.modes.planar, survey.modes.planar_without_limits
    on.start(f"Planar sliding, poles: {_share(planar, 'joint')}, {int(free.sum())} without lateral limits")
    zone = survey.zones(zones_of_poles)
    on.shade(zone["planar_without_limits"], LIGHT, "critical without lateral limits")
    on.shade(zone["planar"], SHADE, f"critical{_at(survey)}")
    on.arc(daylight_envelope(survey.face), color=FACE, label="daylight envelope")
    _face(on, survey)
    for friction, style in _frictions(survey):
        label = f"pole friction cone, φ {number(friction)}°"
        on.steeper_than(90.0 - friction, color=BLUE, linestyle=style, label=label)
    on.spokes(survey.face.dip_direction_deg + 180.0, survey.limits[0])
    _poles(on, survey, planar, "slides")


def _wedge(on: Stereonet, survey: _Survey) -> None:
    lines = survey.modes.of_lines()
    primary, secondary, many = lines["wedge_primary"], lines["wedge_secondary"], lines["wedge"]
    on.start(f"Wedge sliding, lines of intersection: {_share(many, 'line')}")
    zone = survey.zones(zones_of_lines)
    on.shade(zone["wedge_secondary_of_dips"], LIGHT, "secondary zone as Dips draws it")
    on.shade(zone["wedge_primary"], SHADE, f"primary zone{_at(survey)}")
    _face(on, survey)
    for friction, style in _frictions(survey):
        label = f"friction circle, φ {number(friction)}°: steeper within"
        on.steeper_than(friction, color=BLUE, linestyle=style, label=label)
    _dots(on, survey, ~many, GREY, ".", "not critical")
    _dots(on, survey, secondary, PURPLE, "^", "secondary: slides on one joint")
    _dots(on, survey, primary, RED, "o", "primary: line steeper than friction")


def _flexural(on: Stereonet, survey: _Survey) -> None:
    flexural = survey.modes.flexural
    on.start(f"Flexural toppling, poles: {_share(flexural, 'joint')}")
    on.shade(survey.zones(zones_of_poles)["flexural"], SHADE, f"critical{_at(survey)}")
    _face(on, survey)
    for friction, style in _frictions(survey):
        slip = survey.face.dip_deg - friction
        if slip >= 0.0:
            on.arc(great_circle(Plane(slip, survey.face.dip_direction_deg)), color=BLUE, linestyle=style,
                   label=f"slip limit: face less φ, {number(slip)}°")  # fmt: skip
    on.spokes(survey.face.dip_direction_deg, survey.limits[1])
    _poles(on, survey, flexural, "topples")


def _direct(on: Stereonet, survey: _Survey) -> None:
    lines, joints = survey.modes.of_lines(), survey.modes.of_joints()
    base = joints["base_sliding"] | joints["base_release"] | joints["base_oblique"]
    edges = lines["direct"] | lines["oblique"]
    on.start(f"Direct toppling: {_share(edges, 'line')}; base planes: {_share(base, 'joint')}")
    zone = survey.zones(zones_of_lines, survey.most)
    on.shade(zone["oblique"], LIGHT, "oblique")
    on.shade(zone["direct"], SHADE, f"direct{_at(survey, most=True)}")
    _face(on, survey)
    on.steeper_than(90.0 - survey.face.dip_deg, color=BLUE,
                    label="lines: plunge of the normal to the face; poles: its dip")  # fmt: skip
    on.steeper_than(90.0 - survey.most, color=BLUE, linestyle="--",
                    label=f"friction cone about the vertical, φ {number(survey.most)}°")  # fmt: skip
    on.spokes(survey.face.dip_direction_deg + 180.0, survey.limits[1])
    _dots(on, survey, ~edges, GREY, ".", "lines, not critical")
    _dots(on, survey, lines["oblique"], PURPLE, "^", "lines, oblique")
    _dots(on, survey, lines["direct"], RED, "o", "lines, direct")
    for kind, face, said in (
        ("base_sliding", "black", "bases that slide too"), ("base_release", "white", "bases that release"),
        ("base_oblique", "#bbbbbb", "bases that release obliquely"),
    ):  # fmt: skip
        some = survey.poles[joints[kind]]
        on.points(some, marker="s", color="black", markerfacecolor=face, zorder=MARKED,
                  label=f"{said}, poles ({len(some)})")  # fmt: skip


# -- parts ------------------------------------------------------------------------------------------------------------


def _share(critical: Bools, what: str) -> str:
    return f"{int(critical.sum())} of {len(critical)} {what}{'s' * (len(critical) != 1)}"


def _frictions(survey: _Survey) -> list[tuple[float, str]]:
    """The least and the greatest friction angle with their line styles."""
    both = [(survey.least, "-"), (survey.most, ":")]
    return both[:1] if survey.least == survey.most else both


def _face(on: Stereonet, survey: _Survey) -> None:
    on.arc(great_circle(survey.face), color=FACE, linewidth=2.0, label=f"face {survey.face}")


def _poles(on: Stereonet, survey: _Survey, critical: Bools, what: str) -> None:
    """Poles by set, the critical ones ringed."""
    poles_by_set(on, survey.poles, survey.sets, survey.named_sets)
    on.points(survey.poles[critical], marker="o", color=RED, markerfacecolor="none", markersize=8, zorder=MARKED,
              label=f"{what} ({int(critical.sum())})")  # fmt: skip


def _dots(on: Stereonet, survey: _Survey, chosen: Bools, colour: str, marker: str, said: str) -> None:
    """Lines of intersection."""
    on.points(survey.lines.down[chosen], marker=marker, color=colour, label=f"{said} ({int(chosen.sum())})")


# -- joint sets -------------------------------------------------------------------------------------------------------


def draw_sets(figure: Any, document: Document) -> None:
    """One net with all of it."""
    rows, inputs = document["orientations"], document["inputs"]
    planes = np.array([(row["dip_deg"], row["dip_direction_deg"]) for row in rows], dtype=float).reshape(-1, 2)
    poles = -normals(planes[:, 0], planes[:, 1])
    weights = np.array([row["weight"] for row in rows], dtype=float)
    named = [str(one["set"]) for one in document["sets"]]
    on = Stereonet(figure.subplots())
    on.start("")
    _contours(on, poles, weights, float(document["survey"].get("quantity", len(rows))))
    marks = poles_by_set(on, poles, [str(row["set"] or "") for row in rows], named)
    for one in document["sets"]:
        _mean(on, one, marks[str(one["set"])], inputs["confidence"])
    if named:
        for style, said in (
            ("-", f"holds the true mean ({inputs['confidence']:.0%})"),
            ("--", "holds 95 % of its joints"),
        ):
            on.axes.plot([], [], color="black", linestyle=style, label=f"cone that {said}")
    if inputs["scanline"] is not None:
        line = Line(float(inputs["scanline"]["trend_deg"]), float(inputs["scanline"]["plunge_deg"]))
        on.points(lower(line.vector()[None]), marker="*", color=RED, markersize=11, zorder=MARKED,
                  label=f"scanline {line}")  # fmt: skip
    name = short(str(document["survey"]["name"]), 40)
    head = f"{name}: poles of {len(rows)} joint{'s' * (len(rows) != 1)}, {len(named)} set{'s' * (len(named) != 1)}"
    arrange(figure, [on.axes], 1, f"{head}\n(lower hemisphere, {NET}; sha {document['input_sha256'][:6]})")


def _contours(on: Stereonet, poles: Floats, weights: Floats, joints: float) -> None:
    axes, middle = on.axes, np.linspace(-1.0, 1.0, _ACROSS)
    x, y = np.meshgrid(middle, middle)
    square = x * x + y * y
    # on the rim and beyond it stands the nearest direction of the rim, so that contours reach it; the rim cuts them
    inward = np.minimum(1.0, (1.0 - 1e-9) / np.sqrt(np.maximum(square, 1e-12)))
    at = unproject(np.column_stack([(x * inward).ravel(), (y * inward).ravel()]))
    values = density(at, poles, weights, joints).reshape(x.shape)
    levels = [level for level in _KAMB if level < values.max()]
    if not levels:
        return
    from matplotlib.patches import Circle

    most = float(values.max())
    shades = axes.contourf(x, y, values, levels=[*levels, most], cmap="Greys", alpha=0.5, vmin=0.0, vmax=2.0 * most)
    lines = axes.contour(x, y, values, levels=levels, colors=GREY, linewidths=0.5)
    for drawn in (shades, lines):
        drawn.set_clip_path(Circle((0.0, 0.0), 1.0, transform=axes.transData))
    axes.plot([], [], color=GREY, label=f"{', '.join(f'{level:g}' for level in levels)} σ above uniform (Kamb)")
    axes.set(xlim=FRAME, ylim=FRAME)


def _mean(on: Stereonet, one: Mapping[str, Any], mark: tuple[str, str], confidence: float) -> None:
    """The mean pole of a set, the cone that holds the true mean, and that which holds 95 % of its joints."""
    plane = Plane(float(one["dip_deg"]), float(one["dip_direction_deg"]))
    pole, (colour, marker) = -plane.normal(), mark
    k = "" if one["k"] is None else f", K {one['k']:.3g}"
    mean = f"{plane.dip_deg:.0f}/{round(plane.dip_direction_deg) % 360:03d}{k}"
    on.points(pole[None], marker=marker, color=colour, markeredgecolor="black", markersize=10, zorder=MARKED,
              label=f"mean {short(str(one['set']), 10)} {mean}")  # fmt: skip
    for angle, style in ((one["cone_of_mean_deg"], "-"), (one["variability_deg"].get("95%"), "--")):
        if angle is not None and _LEAST_DEG < angle < 90.0:
            on.cone_circle(pole, float(angle), color=colour, linestyle=style)
