"""The picture of elastic tractions shows what the document has."""

import json

import numpy as np
import pytest

import slopekit as sk
from slopekit.views.charts.drawing import misfit, new_figure
from slopekit.views.charts.elastic_charts import _beyond, draw_elastic_tractions
from slopekit.views.pages.report import report_of
from slopekit.views.plots import draw, need_of, offers

pytest.importorskip("matplotlib")
from matplotlib.tri import Triangulation


def document(design, **more):
    return json.loads(json.dumps(sk.run(design, elastic=True, **more).to_dict()))


@pytest.fixture(scope="module")
def cracked():
    found = sk.wedge(("45/115", "45/245"), crack="80/180@20", shear_stiffness=1e5, edge="60 m", elastic=True)
    return json.loads(json.dumps(found.to_dict()))


def test_maps_of_a_wedge(cracked) -> None:
    """A row for each joint; crosses where pairs are open; the areas of the maps are those of the joints."""
    assert "elastic-tractions" in offers(cracked)
    assert misfit(cracked, need_of("elastic-tractions")) == ""
    figure = new_figure("x")
    draw_elastic_tractions(figure, cracked)
    pairs = cracked["elastic"]["pairs"]
    opened = np.array(pairs["opened"])
    assert opened.any()
    joints = list(dict.fromkeys(pairs["joint"]))
    maps = figure.axes[: 2 * len(joints)]
    for joint, rigid, elastic in zip(joints, maps[::2], maps[1::2], strict=True):
        on = np.array(pairs["joint"]) == joint
        for axes, side in ((rigid, "rigid"), (elastic, "elastic")):
            low, high = cracked["elastic"]["joints"][joint][f"{side}_kpa"]
            assert axes.get_title().startswith(f"{joint}, {side}: {0.0 if abs(low) < 1e-4 else low:.4g} .. {high:.4g}")
            filled = sum(polygon_area(path) for path in axes.collections[0].get_paths())
            assert filled == pytest.approx(float(np.array(pairs["control_areas_m2"])[on].sum()), rel=1e-6)
        assert len(elastic.lines[0].get_xdata()) == int(opened[on].sum())


def test_the_page_has_elastic_blocks_under_a_heading_of_their_own(cracked) -> None:
    """The limit, the tractions, what was not modelled; the page of a rigid block has none of it."""
    pytest.importorskip("jinja2")
    page = report_of(cracked, with_pictures=False).html
    elastic = cracked["elastic"]
    assert "<h2>Elastic blocks</h2>" in page
    assert f"{elastic['limit']:.3f}  limit of elastic blocks" in page
    assert "(except in Elastic blocks)" in page
    assert f"{elastic['joints']['J1']['elastic_kpa'][1]:.4g}" in page[page.index("<h2>Elastic blocks</h2>") :]
    rigid = sk.wedge(("45/115", "45/245"), crack="80/180@20").to_dict()
    assert "Elastic blocks" not in report_of(json.loads(json.dumps(rigid)), with_pictures=False).html


def test_gaps_between_contacts_stay_white() -> None:
    """An L of three squares of 1 m: the triangles over the missing fourth are left out."""
    places = np.array([[x, y] for x in np.linspace(0, 2, 9) for y in np.linspace(0, 2, 9) if x <= 1 or y <= 1])
    found = Triangulation(*places.T)
    shown = found.triangles[~_beyond(places, found.triangles, 3.0)]
    middles = places[shown].mean(axis=1)
    sides = places[shown[:, 1:]] - places[shown[:, :1]]
    area = 0.5 * np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]).sum()
    assert area == pytest.approx(3.0, abs=0.2)
    assert not ((middles > 1.2).all(axis=1)).any()
    full = Triangulation(*np.array([[x, y] for x in (0, 1, 2) for y in (0, 1, 2)], dtype=float).T)
    assert not _beyond(np.column_stack([full.x, full.y]), full.triangles, 4.0).any()


def polygon_area(path) -> float:
    """Of the outlines of one colour, holes taken away."""
    total = 0.0
    for outline in path.to_polygons(closed_only=False):
        x, z = outline.T
        total += 0.5 * float(x @ np.roll(z, -1) - z @ np.roll(x, -1))
    return abs(total)


def test_a_plane_along_its_length_and_columns_in_their_places(tmp_path) -> None:
    plane = {
        "slopekit": 1, "kind": "plane", "slope": {"face": "60/180", "height": 12, "upper": "0/180"},
        "joints": {"J1": {"plane": "35/180"}}, "strength": {"joint": {"c": 20, "phi": 30}}, "rock": {"density": 2600},
    }  # fmt: skip
    found = document(plane)
    figure = new_figure("x")
    draw_elastic_tractions(figure, found)
    (axes,) = figure.axes
    for line, side in zip(axes.lines[:2], ("rigid", "elastic"), strict=True):
        assert sorted(line.get_ydata()) == pytest.approx(sorted(found["elastic"]["pairs"][f"{side}_kpa"]))
    assert max(axes.lines[0].get_xdata()) == pytest.approx(12.0 / np.sin(np.radians(35.0)), rel=1e-9)
    opened = [line for line in axes.lines if line.get_label() == "open"]
    assert sum(len(line.get_xdata()) for line in opened) == sum(found["elastic"]["pairs"]["opened"])
    toppling = {
        "slopekit": 1, "kind": "topple", "columns": {"dip": 65, "width": 4, "heights": [4, 9, 6], "base_step": 1},
        "strength": {"joint": {"c": 0, "phi": 38}}, "rock": {"density": 2600},
    }  # fmt: skip
    many = document(toppling)
    figure = new_figure("x")
    draw_elastic_tractions(figure, many)
    assert len(figure.axes[0].collections[0].get_offsets()) == many["elastic"]["node_pairs"]
    draw(many, "elastic-tractions", tmp_path / "one.png")
    assert (tmp_path / "one.png").stat().st_size > 10_000
