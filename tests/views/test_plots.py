"""The charts: what is drawn is what the JSON says; figures are looked at by their artists, not their files."""

import copy
import json

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.errors import DesignError
from slopekit.core.orientation import Line
from slopekit.design.templates import path_of
from slopekit.kinds.single_block import ladders
from slopekit.views.charts.stereonet import project

pytest.importorskip("matplotlib")
from slopekit.studies.kinematic.criteria import planes_of_poles
from slopekit.views.charts.charts import draw_histogram, draw_reduction, draw_speed_errors
from slopekit.views.charts.drawing import new_figure
from slopekit.views.charts.orientation_charts import draw_orientations, orientations_of
from slopekit.views.charts.stereonet import cells
from slopekit.views.charts.survey_charts import draw_kinematic
from slopekit.views.charts.sweep_charts import draw_contour, draw_curve, draw_tornado
from slopekit.views.plots import EVERY, draw, offers
from slopekit.views.solid.scenes import SCENES
from tests.support import result_of

WEDGE = {
    "slopekit": 1,
    "kind": "wedge",
    "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
}


def plain(study) -> dict:
    """The JSON as it comes back from a file."""
    return json.loads(json.dumps(study.to_dict(), allow_nan=False))


def figure_of(draw, document, *options):
    with new_figure("x") as figure:
        draw(figure, document, *options)
    return figure


def drawn(line) -> np.ndarray:
    """Points (n, 2) of a line that are seen: it breaks at nan."""
    return line.get_xydata()[np.isfinite(line.get_xydata()).all(axis=1)]


def labelled(axes, begins: str) -> np.ndarray:
    """Points (n, 2) of the lines of an axes whose label begins so."""
    found = [drawn(line) for line in axes.lines if str(line.get_label()).startswith(begins)]
    assert found, [line.get_label() for line in axes.lines]
    return np.concatenate(found)


def legend(figure) -> str:
    holders = [*figure.legends, *(axes.get_legend() for axes in figure.axes if axes.get_legend())]
    return " | ".join(text.get_text() for holder in holders for text in holder.get_texts())


# -- sweeps -----------------------------------------------------------------------------------------------------------


def test_a_curve_from_its_json() -> None:
    """Factors at their values, one line for each method, the place where the level is passed, E203 without a number."""
    document = plain(sk.sweep(sk.load(WEDGE), {"slope.face.dip": [20, 60, 80]}, fos=1.5))
    axes = figure_of(draw_curve, document).axes[0]
    expected = [[p["values"][0], p["limit"]] for p in document["points"] if p["limit"]]
    assert [at for at, _ in expected] == [60.0, 80.0]
    assert labelled(axes, "PRE-IE").tolist() == expected
    closed = [[p["values"][0], p["closed_form"]] for p in document["points"] if p["closed_form"]]
    assert labelled(axes, "closed form").tolist() == closed
    (line,) = [line for line in axes.lines if line.get_label() == "PRE-IE"]
    assert np.isnan(line.get_ydata()[0])  # no line is drawn to a point without a factor
    diamond = [
        line.get_xydata()[0]
        for line in axes.lines
        if line.get_marker() == "D" and len(line.get_xydata())
    ]
    assert diamond == [pytest.approx([document["critical"][0]["at"], 1.5])]
    assert labelled(axes, "no block")[:, 0].tolist() == [20.0]
    now = sk.load(WEDGE).inputs()["face"]
    assert now == "60/180"
    assert labelled(axes, "the design as it is").tolist() == [pytest.approx(expected[0])]
    assert axes.get_title().endswith("factor of safety over dip of the face")
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("dip of the face (°)", "factor of safety")
    other = figure_of(draw_curve, document | {"kind": "of another program"}).axes[0]
    assert other.get_xlabel() == "slope.face.dip (°)"


@pytest.mark.slow
def test_a_contour_and_a_tornado_from_their_json() -> None:
    grid = plain(
        sk.sweep(
            sk.load(WEDGE),
            {"slope.face.dip": [60, 70, 80], "water.fill": [0, 0.5, 1]},
            closed_form=True,
        )
    )
    axes = figure_of(draw_contour, grid).axes[0]
    assert labelled(axes, "computed").tolist() == [point["values"] for point in grid["points"]]
    assert (axes.get_xlim(), axes.get_ylim()) == ((60.0, 80.0), (0.0, 1.0))
    assert axes.get_title().endswith("factor of safety over dip of the face and part of full water")
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("dip of the face (°)", "part of full water")
    frame = axes.get_window_extent()
    shown = [text for text in axes.texts if text.get_visible()]
    assert all(
        frame.x0 <= (box := text.get_window_extent()).x0 and box.x1 <= frame.x1 for text in shown
    )
    study = plain(sk.tornado(sk.load(WEDGE), closed_form=True))
    axes = figure_of(draw_tornado, study).axes[0]
    first, base = study["bars"][0], study["base"]["closed_form"]
    widths = [bar.get_width() for bar in axes.patches[:2]]
    assert widths == pytest.approx(
        [first[end]["closed_form"] - base for end in ("at_low", "at_high")], rel=1e-12
    )
    assert [text.get_text() for text in axes.texts[:2]] == first["shown"]
    assert (first["key"], axes.get_yticklabels()[0].get_text()) == (
        "strength.joints.phi",
        "friction angle of joints",
    )


def test_two_values_carry_no_contours() -> None:
    grid = plain(
        sk.sweep(
            sk.load(WEDGE), {"slope.face.dip": [60, 70, 80], "water.fill": [0, 1]}, closed_form=True
        )
    )
    with pytest.raises(
        DesignError, match="E273 there is nothing to draw: contours need three values"
    ):
        figure_of(draw_contour, grid)


def test_many_pictures_of_odd_studies_are_refused_or_drawn() -> None:
    """A single point is a curve of one marker; no point with a factor is E273."""
    single = plain(sk.sweep(sk.load(WEDGE), {"slope.face.dip": [60]}, closed_form=True))
    (line,) = [
        line
        for line in figure_of(draw_curve, single).axes[0].lines
        if line.get_label() == "closed form"
    ]
    assert (len(drawn(line)), line.get_marker()) == (1, "o")
    none = plain(sk.sweep(sk.load(WEDGE), {"slope.face.dip": [15, 20]}, closed_form=True))
    with pytest.raises(DesignError) as caught:
        figure_of(draw_curve, none)
    assert caught.value.codes == ("E273",)


# -- probability ------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def scattered() -> dict:
    return plain(sk.prob(sk.load(path_of("wedge-scatter")), 600, fos=1.2))


def test_a_histogram(scattered) -> None:
    """Bars hold all samples; the diamond is P(F < target) with its limits, and the cumulated line passes by it."""
    figure = figure_of(draw_histogram, scattered)
    axes, right = figure.axes[:2]
    share, bins = scattered["probability_of_failure"]["all_samples"], scattered["histogram"]
    tops: dict[float, float] = {}
    for bar in axes.patches:
        if bar.get_width() and bar.get_height():
            edge = max(edge for edge in bins["edges"] if edge <= bar.get_x() + 1e-12)
            tops[edge] = bar.get_height()
    assert sum(tops.values()) + bins["below"] + bins["above"] == scattered["fos"]["samples"] == 600
    diamond = right.containers[0]
    assert diamond[0].get_xydata().tolist() == [pytest.approx([1.2, 100.0 * share["probability"]])]
    low, high = diamond[2][0].get_segments()[0][:, 1]
    assert [low, high] == pytest.approx([100.0 * share["low"], 100.0 * share["high"]])
    line = labelled(right, "cumulated")
    within = 100.0 * max(bins["counts"]) / 600
    assert abs(np.interp(1.2, *line.T) - 100.0 * share["probability"]) < within
    assert line[-1, 1] == pytest.approx(100.0 * (1.0 - bins["above"] / 600))
    assert f"P(FoS < 1.2) = {100 * share['probability']:.3g} %" in axes.get_title()


def test_histograms_of_odd_samples(scattered) -> None:
    """All factors equal: one bar, one step. None at all: E273 with the outcomes."""
    alike = copy.deepcopy(scattered)
    alike["fos"] |= {"min": 1.5, "max": 1.5}
    alike["histogram"] |= {"edges": [1.0, 2.0], "counts": [600], "below": 0, "above": 0}
    axes, right = figure_of(draw_histogram, alike).axes[:2]
    assert [(bar.get_x() + bar.get_width() / 2, bar.get_height()) for bar in axes.patches] == [
        (pytest.approx(1.5), 600.0)
    ]
    assert labelled(right, "cumulated").tolist() == [[1.5, 0.0], [1.5, 100.0]]
    none = scattered | {"histogram": None, "fos": None, "outcomes": {"lifted": 600}}
    with pytest.raises(DesignError, match="no sample has a factor of safety: lifted 600") as caught:
        figure_of(draw_histogram, none)
    assert caught.value.codes == ("E273",)


# -- checks and results -----------------------------------------------------------------------------------------------


def test_speed_against_error(monkeypatch) -> None:
    """Every rung of a method with its own time."""
    monkeypatch.setattr(ladders, "_MOST_REFINED", 1)
    document = plain(sk.check(sk.load(path_of("plane"))))
    axes = figure_of(draw_speed_errors, document).axes[0]
    times = {
        float(time)
        for line in axes.lines
        if line.get_marker() != "None"
        for time in line.get_xdata()
    }
    expected = {
        timing["seconds"]
        for rung, timing in zip(document["ladder"], document["timing_s"]["ladder"], strict=True)
        if rung["error"] is not None
    }
    assert times == expected


def test_reduction_is_the_papers_figure() -> None:
    """Sheng et al. 2023, table 3: from 0 to all nine pairs at 1.334, where the block no longer stands."""
    document = plain(result_of("paper-footing"))
    left, right = figure_of(draw_reduction, document).axes[:2]
    pairs = dict(labelled(right, "failed node pairs").tolist())
    assert (pairs[1.0], pairs[1.2], pairs[1.333]) == (0.0, 4.0, 8.0)
    assert labelled(right, "no longer stands").tolist() == [
        [at, 9.0] for at in (1.334, 1.34, 1.35, 1.36, 1.37)
    ]
    moved = labelled(left, "displacement")
    step = document["series"][0]["displacement_m"]
    assert moved[0] == pytest.approx([1.0, 1e3 * np.linalg.norm(step)])
    assert "limit 1.333" in [text.get_text() for text in left.texts]


def test_labels_of_upright_lines_stand_apart() -> None:
    """The smaller of limit and all-pairs factor is written at the left of its line, whichever it is."""
    document = plain(result_of("paper-wedge"))
    fos = document["fos"]
    assert fos["all_pairs_failed"] < fos["limit"]
    for values in (fos, fos | {"all_pairs_failed": 1.6}):
        left, right = figure_of(draw_reduction, document | {"fos": values}).axes[:2]
        sides = {text.get_text().rsplit(" ", 1)[0]: text.get_ha() for text in left.texts}
        lower = "all pairs failed" if values["all_pairs_failed"] < values["limit"] else "limit"
        assert sides == {"limit": "left", "all pairs failed": "left"} | {lower: "right"}
    assert (
        right.yaxis.label.get_color() == right.lines[0].get_color()
    )  # no series: the search alone is drawn


# -- stereonets -------------------------------------------------------------------------------------------------------


def test_the_stereonet_of_a_wedge() -> None:
    """The line of intersection of Hoek & Bray's wedge stands where its trend and plunge are; friction in the legend."""
    document = plain(sk.run(WEDGE))
    figure = figure_of(draw_orientations, document)
    line = document["geometry"]["line"]
    expected = project(Line(line["trend_deg"], line["plunge_deg"]).vector()[None])[0]
    assert labelled(figure.axes[0], "line J1 x J2: 180/22.9")[0] == pytest.approx(
        expected, abs=1e-12
    )
    assert "J1 45/115, φ 20°" in legend(figure)
    assert "face 60/180" in legend(figure)
    circle = labelled(figure.axes[0], "friction circle, φ 20°: steeper within")
    assert np.hypot(*circle.T) == pytest.approx(np.sqrt(2.0) * np.sin(np.radians(35.0)), abs=1e-12)


def test_friction_circles_of_two_joints() -> None:
    """Each angle at its own radius; the zone says which it takes."""
    strength = {"a": {"c": 50, "phi": 20}, "b": {"c": 50, "phi": 30}}
    joints = {
        "J1": {"plane": "45/115", "strength": "a"},
        "J2": {"plane": "45/245", "strength": "b"},
    }
    document = plain(sk.run(WEDGE | {"strength": strength, "joints": joints}))
    figure = figure_of(draw_orientations, document)
    axes = figure.axes[0]
    lines = {str(line.get_label()): line for line in axes.lines}
    for angle in (20.0, 30.0):
        circle = lines[f"friction circle, φ {angle:g}°: steeper within"]
        radius = np.sqrt(2.0) * np.sin(np.radians((90.0 - angle) / 2.0))
        assert np.hypot(*circle.get_xydata().T) == pytest.approx(radius, abs=1e-12)
    assert "steeper than φ 20°, the least" in legend(figure)


def test_the_crack_of_a_plane_is_upright() -> None:
    assert str(orientations_of(plain(result_of("plane"))).slope["crack"]) == "90/180"


@pytest.mark.slow
def test_a_plane_has_the_zone_of_poles() -> None:
    """Shaded cells against the planar test of joints with these poles (φ 37°, ±20°); no zone of lines, no circle."""
    figure = figure_of(draw_orientations, plain(result_of("plane")))
    said, (wide, narrow) = (
        legend(figure),
        [image.get_array()[..., 3] > 0 for image in figure.axes[0].images],
    )
    assert "poles here daylight, steeper than φ 37°" in said
    assert "lines here" not in said
    assert "friction circle" not in said
    vectors, inside = cells()
    some = np.linspace(0, len(vectors) - 1, 2000).astype(int)
    planes = planes_of_poles(vectors[some])
    asked = list(zip(planes.dips_deg, planes.dip_directions_deg, strict=True))
    modes = sk.kinematic(asked, face="60/180", phi=37).modes
    assert narrow[inside][some].tolist() == modes.planar.tolist()
    assert wide[inside][some].tolist() == modes.planar_without_limits.tolist()
    assert 0 < modes.planar.sum() < modes.planar_without_limits.sum()


@pytest.mark.slow
def test_zones_say_which_friction_angle() -> None:
    """Of joints with their own angles the zones take the least, direct toppling the greatest."""
    said = legend(
        figure_of(draw_kinematic, plain(sk.kinematic("examples/joints.csv", face="65/180", phi=30)))
    )
    assert "critical at φ 27°, the least" in said
    assert "primary zone at φ 27°, the least" in said
    assert "direct at φ 35°, the greatest" in said
    alike = plain(sk.kinematic(["40/175", "35/090"], face="65/180", phi=30))
    assert "the least" not in legend(figure_of(draw_kinematic, alike))


def test_orientations_of_other_documents() -> None:
    plane, bench = plain(result_of("plane")), sk.load(path_of("bench")).inputs()
    assert [str(joint) for joint in orientations_of(plane).joints.values()] == ["35/180"]
    found = orientations_of({"kind": "bench", "inputs": json.loads(json.dumps(bench))})
    assert list(found.joints) == ["S1", "S2", "S3"]
    assert found.frictions == [40.0, 42.0]
    assert not orientations_of(plain(result_of("footing"))).joints


@pytest.mark.slow
def test_the_stereonets_of_a_survey() -> None:
    """Counts in the legend are the study's; the shaded share of the net is that of the critical cells."""
    study = sk.kinematic("examples/joints.csv", face="65/180", phi=30)
    document, counts = plain(study), study.counts
    figure = figure_of(draw_kinematic, document)
    said = legend(figure)
    assert len(figure.axes) == 4
    assert f"slides ({counts['planar']})" in said or not counts["planar"]
    assert f"primary: line steeper than friction ({counts['wedge_primary']})" in said
    assert f"topples ({counts['flexural']})" in said
    assert f"lines, direct ({counts['direct']})" in said
    ringed = labelled(figure.axes[2], "topples")
    critical = -study.joints.normals()[study.modes.flexural]
    assert ringed == pytest.approx(project(critical), abs=1e-12)
    image = figure.axes[0].images[-1].get_array()
    assert image.shape[:2] == cells()[1].shape
    assert 0.0 < (image[..., 3] > 0).mean() < 0.2


@pytest.mark.slow
@pytest.mark.parametrize("joints", [["45/170"], ["0/0", "90/0", "90/90"]])
@pytest.mark.parametrize("face", ["0/180", "90/180", "25/000"])
def test_stereonets_of_odd_surveys(joints, face) -> None:
    """One joint, level and upright ones; a face that is level, upright, or lets nothing slide: all are drawn."""
    document = plain(sk.kinematic(joints, face=face, phi=30))
    figure = figure_of(draw_kinematic, document, "planar")
    assert len(figure.axes) == 1
    at = labelled(figure.axes[0], "poles")
    assert len(at) == len(joints)
    assert (np.hypot(*at.T) <= 1.0 + 1e-12).all()


# -- earthquakes -------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_motion_in_six_degrees_of_freedom() -> None:
    """Ends at the displacements of the table, its parts at the vector."""
    found = sk.quake(sk.load(WEDGE), "triangular:0.5g,0.4s", toward=150, six=True)
    document = plain(found)
    assert set(offers(document)) == {"motion"}
    motion, most = document["six_motion"], max(found.six, key=lambda one: one.slid_m)
    ends = [motion[f"{name}_m"][-1] for name in ("east", "north", "up")]
    assert ends == pytest.approx(most.displacement_m, rel=1e-6, abs=1e-9)
    turned = [motion[f"about_{name}_deg"][-1] for name in ("east", "north", "up")]
    assert float(np.linalg.norm(turned)) == pytest.approx(most.rotation_deg, rel=1e-6, abs=1e-12)


# -- what a document can give -----------------------------------------------------------------------------------------


def test_offers(scattered) -> None:
    assert set(offers(scattered)) == {"stereonet", "histogram"}
    assert "curve" in offers(
        plain(sk.sweep(sk.load(WEDGE), {"slope.face.dip": [60, 80]}, closed_form=True))
    )
    assert set(offers(plain(result_of("paper-footing")))) >= {"scene", "reduction"}
    assert offers({"slopekit": "0"}) == {}
    assert set(offers(plain(sk.quake(sk.load(WEDGE), "triangular:0.5g,0.4s")))) == {"motion"}
    assert len(set(EVERY)) == len(EVERY) == 17


@pytest.mark.slow
def test_whole_documents_have_what_charts_need(scattered, tmp_path) -> None:
    """What slopekit writes is never called damaged."""
    swept = [
        sk.sweep(sk.load(WEDGE), keys, closed_form=True)
        for keys in (
            {"slope.face.dip": [20, 60, 80]},
            {"slope.face.dip": [60, 70, 80], "water.fill": [0, 0.5, 1]},
        )
    ]
    runs = [
        result_of(name) for name in ("paper-wedge", "paper-footing", "plane", "blocks", "topple")
    ]
    studies = [
        *swept,
        *runs,
        sk.tornado(sk.load(WEDGE), closed_form=True),
        sk.kinematic(["40/175", "35/090"], face="65/180"),
    ]
    for document in (scattered, *map(plain, studies)):
        for what in [what for what in offers(document) if what not in SCENES]:
            draw(document, what, tmp_path / "a.svg")


@pytest.mark.slow
def test_plot_from_python(tmp_path, scattered) -> None:
    """A dict, a study or a path; the same bytes twice; beside the JSON by default."""
    first = sk.plot(scattered, "histogram", tmp_path / "a.png")
    file = tmp_path / "prob.json"
    file.write_text(json.dumps(scattered))
    assert sk.plot(file, "histogram") == tmp_path / "prob-histogram.png"
    assert (tmp_path / "prob-histogram.png").read_bytes() == first.read_bytes()
    with pytest.raises(DesignError) as caught:
        sk.plot(3, "histogram")
    assert caught.value.codes == ("E340",)
