"""The stereonets of a kinematic study (matplotlib), from its JSON: one for each test. Need the extra `plot`.

The critical zones are the criteria themselves, asked of every cell of the net; lines drawn on them are geometry.
"""

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.core.orientation import Plane, number, parse_plane
from slopekit.studies.kinematic.criteria import (
    Lines,
    Modes,
    Planes,
    lines_of,
    modes_of,
    planes_of_poles,
    tested_pairs,
    zones_of_lines,
    zones_of_poles,
)
from slopekit.views.charts.drawing import BLUE, GREY, PURPLE, RED, short
from slopekit.views.charts.stereonet import (
    FACE,
    LIGHT,
    NET,
    SHADE,
    Stereonet,
    arrange,
    cells,
    mean_axis,
    set_marks,
)

Document = Mapping[str, Any]
#: What `--test` takes; toppling is both of the last.
TESTS = ("planar", "wedge", "toppling", "flexural", "direct")
#: One net each.
NETS_OF = ("planar", "wedge", "flexural", "direct")
_OFTEN = 1500  # lines beyond which they are dots


class _Survey:
    """A kinematic study as its JSON has it."""

    def __init__(self, document: Document) -> None:
        self.document = document

    @cached_property
    def planes(self) -> Planes:
        rows = self.document["orientations"]
        return Planes(np.array([row["dip_deg"] for row in rows], dtype=float),
                      np.array([row["dip_direction_deg"] for row in rows], dtype=float))  # fmt: skip

    @cached_property
    def friction(self) -> Floats:
        return np.array([row["friction_deg"] for row in self.document["orientations"]], dtype=float)

    @cached_property
    def sets(self) -> list[str]:
        return [str(row["set"]) for row in self.document["orientations"]]

    @cached_property
    def named_sets(self) -> list[str]:
        return sorted({name for name in self.sets if name})

    @property
    def face(self) -> Plane:
        return parse_plane(self.document["inputs"]["face"], "face")

    @property
    def limits(self) -> tuple[float, float]:
        inputs = self.document["inputs"]
        return inputs["lateral_deg"], inputs["lateral_toppling_deg"]

    @cached_property
    def lines(self) -> Lines:
        rng = np.random.default_rng(self.document["inputs"].get("seed", 1))
        return lines_of(self.planes, tested_pairs(self.planes, rng))

    @cached_property
    def modes(self) -> Modes:
        return modes_of(self.planes, self.lines, self.face, self.friction, *self.limits)

    @property
    def poles(self) -> Floats:
        return -self.planes.normals()

    @property
    def least(self) -> float:
        return float(self.friction.min())

    @property
    def most(self) -> float:
        return float(self.friction.max())

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
    on.envelope(survey.face, color=FACE, linewidth=1.4, label="daylight envelope")
    _face(on, survey)
    for friction, style in _frictions(survey):
        on.steeper_than(90.0 - friction, color=BLUE, linewidth=1.3, linestyle=style,
                        label=f"pole friction cone, φ {number(friction)}°")  # fmt: skip
    on.spokes(survey.face.dip_direction_deg + 180.0, survey.limits[0])
    _poles(on, survey, planar, "slides")
    _means(on, survey)


def _wedge(on: Stereonet, survey: _Survey) -> None:
    lines = survey.modes.of_lines()
    primary, secondary, many = lines["wedge_primary"], lines["wedge_secondary"], lines["wedge"]
    on.start(f"Wedge sliding, lines of intersection: {_share(many, 'line')}")
    zone = survey.zones(zones_of_lines)
    on.shade(zone["wedge_secondary_of_dips"], LIGHT, "secondary zone as Dips draws it")
    on.shade(zone["wedge_primary"], SHADE, f"primary zone{_at(survey)}")
    _face(on, survey)
    for friction, style in _frictions(survey):
        on.steeper_than(friction, color=BLUE, linewidth=1.3, linestyle=style,
                        label=f"friction circle, φ {number(friction)}°: steeper within")  # fmt: skip
    _dots(on, survey, ~many, GREY, "o", "not critical")
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
            on.plane_circle(Plane(slip, survey.face.dip_direction_deg), color=BLUE, linewidth=1.3,
                            linestyle=style, label=f"slip limit: face less φ, {number(slip)}°")  # fmt: skip
    on.spokes(survey.face.dip_direction_deg, survey.limits[1])
    _poles(on, survey, flexural, "topples")
    _means(on, survey)


def _direct(on: Stereonet, survey: _Survey) -> None:
    lines, joints = survey.modes.of_lines(), survey.modes.of_joints()
    base = joints["base_sliding"] | joints["base_release"] | joints["base_oblique"]
    edges = lines["direct"] | lines["oblique"]
    on.start(f"Direct toppling: {_share(edges, 'line')}; base planes: {_share(base, 'joint')}")
    zone = survey.zones(zones_of_lines, survey.most)
    on.shade(zone["oblique"], LIGHT, "oblique")
    on.shade(zone["direct"], SHADE, f"direct{_at(survey, most=True)}")
    _face(on, survey)
    on.steeper_than(90.0 - survey.face.dip_deg, color=BLUE, linewidth=1.3,
                    label="lines: plunge of the normal to the face; poles: its dip")  # fmt: skip
    on.steeper_than(90.0 - survey.most, color=BLUE, linewidth=1.1, linestyle="--",
                    label=f"friction cone about the vertical, φ {number(survey.most)}°")  # fmt: skip
    on.spokes(survey.face.dip_direction_deg + 180.0, survey.limits[1])
    _dots(on, survey, ~edges, GREY, "o", "lines, not critical")
    _dots(on, survey, lines["oblique"], PURPLE, "^", "lines, oblique")
    _dots(on, survey, lines["direct"], RED, "o", "lines, direct")
    for kind, face, said in (
        ("base_sliding", "black", "bases that slide too"), ("base_release", "white", "bases that release"),
        ("base_oblique", "#bbbbbb", "bases that release obliquely"),
    ):  # fmt: skip
        some = survey.poles[joints[kind]]
        on.points(some, marker="s", color="black", markerfacecolor=face, markersize=4.5, zorder=4,
                  label=f"{said}, poles ({len(some)})")  # fmt: skip


# -- parts ------------------------------------------------------------------------------------------------------------


def _share(critical: Bools, what: str) -> str:
    return f"{int(critical.sum())} of {len(critical)} {what}{'s' * (len(critical) != 1)}"


def _frictions(survey: _Survey) -> list[tuple[float, str]]:
    """The least and the greatest friction angle with their line styles."""
    both = [(survey.least, "-"), (survey.most, ":")]
    return both[:1] if survey.least == survey.most else both


def _face(on: Stereonet, survey: _Survey) -> None:
    on.plane_circle(survey.face, color=FACE, linewidth=2.2, label=f"face {survey.face}")


def _poles(on: Stereonet, survey: _Survey, critical: Bools, what: str) -> None:
    """Poles by set, the critical ones ringed."""
    own = np.array(survey.sets)
    marks, size = set_marks(survey.named_sets), 3.8 if len(own) <= 600 else 2.4
    for name in (*survey.named_sets, ""):
        some = survey.poles[own == name]
        colour, marker = marks[name]
        said = f"set {short(name, 18)}" if name else "poles" if not survey.named_sets else "of no set"
        on.points(some, marker=marker, color=colour, markersize=size, markeredgewidth=0.6, zorder=3,
                  label=f"{said} ({len(some)})")  # fmt: skip
    on.points(survey.poles[critical], marker="o", color=RED, markerfacecolor="none",
              markersize=2.0 * size + 0.9, markeredgewidth=1.4, zorder=4,
              label=f"{what} ({int(critical.sum())})")  # fmt: skip


def _means(on: Stereonet, survey: _Survey) -> None:
    """The mean pole of each set."""
    own = np.array(survey.sets)
    marks = set_marks(survey.named_sets)
    for name in survey.named_sets:
        some = survey.poles[own == name]
        if len(some) < 2:
            continue
        pole = mean_axis(some)
        mean = planes_of_poles(pole[None])
        plane = f"{mean.dips_deg[0]:.0f}/{mean.dip_directions_deg[0]:03.0f}"
        on.points(pole[None], marker=marks[name][1], color="black",
                  markerfacecolor=marks[name][0], markersize=11, markeredgewidth=1.4, zorder=4.5,
                  label=f"mean of {short(name, 14)}: {plane}")  # fmt: skip


def _dots(on: Stereonet, survey: _Survey, chosen: Bools, colour: str, marker: str, said: str) -> None:
    """Lines of intersection."""
    size = 3.4 if len(chosen) <= _OFTEN else 2.2 if len(chosen) <= 10 * _OFTEN else 1.4
    quiet = colour == GREY
    on.points(survey.lines.down[chosen], marker="." if quiet else marker, color=colour,
              markersize=size if quiet else size + 0.6, markeredgewidth=0.3, alpha=0.7 if quiet else 1.0,
              zorder=2.0 if quiet else 3.0, label=f"{said} ({int(chosen.sum())})")  # fmt: skip
