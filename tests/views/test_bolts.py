"""Bolts in pictures, looked at by their layers and artists; nothing that is written lies on anything else."""

import copy
import json
import math
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from slopekit.block_scene import packed
from slopekit.cli import app
from slopekit.core.errors import DesignError
from slopekit.design.templates import path_of
from slopekit.views.charts import drawing
from slopekit.views.plots import draw as draw_any
from slopekit.views.plots import offers
from slopekit.views.solid import rendering
from slopekit.views.solid.layers import ACTIVE_BOLT, PASSIVE_BOLT, Bar, Picture
from slopekit.views.solid.rendering import Camera, lay_out
from slopekit.views.solid.scene_parts import grouped_loads, loads_summary
from slopekit.views.solid.scenes import compose
from slopekit.views.solid.viewer_data import viewer_data
from tests.bolted import bolted

pytest.importorskip("matplotlib")
from slopekit.views.charts.drawing import new_figure
from slopekit.views.charts.elevation import draw_elevation

NAMES = ("three", "pattern", "plane", "bench")


@cache
def document(name: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(json.dumps(bolted(name).to_dict()))
    return found


# -- scenes -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("what", ["scene", "exploded", "forces"])
@pytest.mark.parametrize("name", NAMES)
def test_rods_reach_from_head_to_end(name: str, what: str) -> None:
    """Their heads and ends are vertices, moved as the block of the head where blocks are drawn apart."""
    bolts, picture = bolted(name).scene.bolts, compose(document(name), what)
    layers = {layer.name: layer for layer in picture.layers}
    for acts, own, colour in (
        ("active", ~bolts.passive, ACTIVE_BOLT),
        ("passive", bolts.passive, PASSIVE_BOLT),
    ):
        assert (f"bolts, {acts}: rods" in layers) == bool(own.any())
        if not own.any():
            continue
        rods, plates = layers[f"bolts, {acts}: rods"], layers[f"bolts, {acts}: plates"]
        assert {tuple(one) for one in [*rods.colours.tolist(), *plates.colours.tolist()]} == {
            colour
        }
        ends = rods.vertices.reshape(int(own.sum()), -1, 3)[:, -2:]
        moved = ends - np.stack([bolts.heads_m[own], bolts.ends_m[own]], axis=1)
        np.testing.assert_allclose(moved[:, 0], moved[:, 1], atol=1e-9)
        assert (np.linalg.norm(moved, axis=2) > 0.1).any() == (what == "exploded")
        middle = plates.vertices.reshape(int(own.sum()), -1, 3).mean(axis=1) - ends[:, 0]
        assert ((middle * bolts.plates[own]).sum(axis=1) > 0.0).all()  # outside the rock
    if what != "forces":  # that has the loads, also of bolts without a head
        legend = [text for text, _, _ in picture.legend]
        assert sum("bolt" in text for text in legend) == len({*bolts.passive.tolist()}), legend


def test_what_is_not_drawn_is_said() -> None:
    for what in ("scene", "exploded", "forces"):
        notes = compose(document("three"), what).notes
        assert "bolt 3 has no head and is not drawn: a force through the centroid" in notes
        assert "bolts without a length are drawn to where they leave their block" in notes


def test_equal_arrows_share_a_line_with_the_numbers_of_the_design() -> None:
    """48 bolts one line; a lone one keeps the number that the design lists it by, not that among its sort."""
    legend = [text for text, _, _ in compose(document("pattern"), "forces").legend]
    (said,) = [text for text in legend if "bolt" in text]
    assert said.startswith("48 passive bolts: ")
    assert " each" in said
    one = copy.deepcopy(document("three"))
    said = " | ".join(text for text, _, _ in compose(one, "forces").legend)
    assert "passive bolt 2: " in said
    bench = [text for text, _, _ in compose(document("bench"), "forces").legend]
    assert any(text.startswith("3 active bolts: 150 kN each") for text in bench)  # not "forces"


def test_many_sizes_are_a_range() -> None:
    names = ["weight", *(f"force {k}" for k in range(1, 6)), "passive bolt 1, full capacity"]
    assert grouped_loads(names) == [
        ("weight", [0]),
        ("5 forces", [1, 2, 3, 4, 5]),
        ("passive bolt 1, full capacity", [6]),
    ]
    assert (
        loads_summary("5 forces", [np.array([float(k)]) for k in range(1, 6)])
        == "5 forces: 1 kN to 5 kN"
    )


# -- words about a picture --------------------------------------------------------------------------------------------


def overlaps(boxes: list[Any]) -> list[tuple[str, str]]:
    """Which of (name, box) lie on each other by more than a pixel."""
    return [
        (one, other)
        for k, (one, a) in enumerate(boxes)
        for other, b in boxes[k + 1 :]
        if min(a.x1, b.x1) - max(a.x0, b.x0) > 1.0 and min(a.y1, b.y1) - max(a.y0, b.y0) > 1.0
    ]


def figure_of(picture: Picture) -> Any:
    """The picture without a pixel of the scene, laid out."""
    with drawing.new_figure("a.png") as figure:
        lay_out(figure, picture, Camera.about(picture.points, picture.eye), np.ones((4, 5, 3)))
    figure.draw_without_rendering()
    return figure


def eyes() -> list[np.ndarray]:
    found = []
    for bearing in range(0, 360, 40):
        for above in (9.0, 27.0):
            a, e = math.radians(bearing), math.radians(above)
            found.append(
                np.array([math.sin(a) * math.cos(e), math.cos(a) * math.cos(e), math.sin(e)])
            )
    return found


@pytest.mark.slow
@pytest.mark.parametrize("lines", [4, 40])
def test_legend_scale_compass_and_bar_never_overlap(lines: int) -> None:
    """From any side, with a legend of forty long lines, a colour bar and notes: nothing lies on another or is cut."""
    plain = compose(document("three"), "scene")
    legend = [
        (f"W{k} " + "a legend entry of capital LETTERS WWWWW that is long", (9, 9, 9), 1.0)
        for k in range(lines)
    ]
    labels = tuple((point, f"block {k}") for k, point in enumerate(plain.layers[0].vertices[:60]))
    changed = {
        "legend": tuple(legend),
        "bar": Bar("what it is", 0.5, 2.5),
        "labels": labels,
        "notes": ("a note " * 40,),
    }
    for eye in eyes()[:: 3 if lines == 4 else 6]:
        figure = figure_of(replace(plain, eye=eye, has_label_lines=True, **changed))
        renderer = figure.canvas.get_renderer()
        axes, bar = figure.axes
        (compass,) = axes.child_axes
        words = [*axes.texts, axes._left_title, figure._supxlabel]
        boxes = [
            (text.get_text(), text.get_window_extent(renderer)) for text in words if text.get_text()
        ]
        boxes += [
            ("legend", figure.legends[0].get_window_extent(renderer)),
            ("bar", bar.get_tightbbox(renderer)),
            ("compass", compass.get_tightbbox(renderer)),
        ]
        assert overlaps(boxes) == []
        wide, high = figure.get_size_inches() * figure.dpi
        assert all(
            box.x0 >= -1 and box.x1 <= wide + 1 and box.y0 >= -1 and box.y1 <= high + 1
            for _, box in boxes
        )
        names = [
            (text.get_text(), text.get_window_extent(renderer))
            for text in compass.texts
            if text.get_text()
        ]
        assert {name.split()[0] for name, _ in names} == {"N", "up", "E"}
        assert overlaps(names) == []
        said = [text.get_text() for text in figure.legends[0].get_texts()]
        assert len([text for text in said if text.startswith("W")]) == min(lines, 18)
        assert ("and 22 more that have no room here" in said) == (lines == 40)


# -- the elevation ----------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("name", [*NAMES, "two hundred"])
def test_the_elevation_has_heads_at_their_places_and_numbers_that_can_be_read(name: str) -> None:
    with new_figure("x") as figure:
        draw_elevation(figure, document(name))
    (axes,) = figure.axes
    bolts = bolted(name).scene.bolts
    heads = np.concatenate(
        [part.get_offsets() for part in axes.collections if part.get_zorder() == 5]
    )
    order = np.argsort(bolts.passive, kind="stable")  # active ones first
    np.testing.assert_allclose(heads[:, 1], bolts.heads_m[order, 2], atol=1e-9)
    np.testing.assert_allclose(
        np.ptp(heads[:, 0]), np.ptp(bolts.heads_m[:, 0]), atol=1e-9
    )  # the faces strike east
    assert axes.get_aspect() == 1.0  # to scale
    numbers = [text for text in axes.texts if text.get_gid() == "number"]
    figure.draw_without_rendering()
    renderer = figure.canvas.get_renderer()
    boxes = [(text.get_text(), text.get_window_extent(renderer)) for text in numbers]
    assert overlaps(boxes) == []
    frame = axes.get_window_extent(renderer)
    assert all(frame.x0 <= box.x0 and box.x1 <= frame.x1 for _, box in boxes)
    assert {text for text, _ in boxes} <= {str(number) for number in bolts.number.tolist()}
    said = " ".join(text.get_text() for text in axes.texts)
    assert (
        len(numbers) == len(bolts) or f"{len(numbers)} of {len(bolts)} numbers are written" in said
    )
    assert len(numbers) >= min(len(bolts), 40)
    (legend,) = figure.legends
    others = [
        ("legend", legend.get_window_extent(renderer)),
        ("axes", axes.get_tightbbox(renderer)),
    ]
    assert overlaps(others) == []


def test_a_pattern_is_numbered_at_the_ends_of_its_rows() -> None:
    with new_figure("x") as figure:
        draw_elevation(figure, document("two hundred"))
    written = {text.get_text() for text in figure.axes[0].texts if text.get_gid() == "number"}
    assert {str(20 * row + end) for row in range(10) for end in (1, 20)} <= written
    assert "200 bolts in 10 rows" in figure.axes[0].get_title()


def test_who_offers_an_elevation(tmp_path: Path) -> None:
    assert "elevation" in offers(document("three"))
    bare = copy.deepcopy(document("three"))
    del bare["scene"]["bolts"]
    assert "elevation" not in offers(bare)
    with pytest.raises(DesignError) as caught:
        draw_any(bare, "elevation", tmp_path / "x.png")
    assert caught.value.codes == ("E273",)
    draw_any(document("three"), "elevation", tmp_path / "x.svg")
    assert (tmp_path / "x.svg").stat().st_size > 5000


# -- files ------------------------------------------------------------------------------------------------------------


def test_run_writes_the_schedule_and_the_elevation(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        rendering, "save", lambda picture, path: path.write_bytes(b"drawn elsewhere")
    )
    bolts = "[{force: 30 kN, toward: 000/-5, head: [0, 0.57735, 1], length: 6 m}]"
    design, out = str(path_of("plane")), tmp_path / "out"
    run = CliRunner().invoke(
        app, ["run", design, "--set", f"support.bolts={bolts}", "--quiet", "-o", str(out)]
    )
    assert run.exit_code == 0, run.output
    assert (out / "elevation.png").stat().st_size > 5000
    text = (out / "bolts.csv").read_text()
    assert text.splitlines()[1] == "1,0.000,0.577,1.000,6.000,0.00,-5.00,30.000,1,active,"
    again = CliRunner().invoke(app, ["run", design, "--quiet", "--no-pictures", "-o", str(out)])
    assert "the bolts of an earlier result were removed: bolts.csv" in again.stderr
    assert "removed: " in again.stderr
    assert not (out / "bolts.csv").exists()
    (out / "bolts.csv").write_text("mine\n")  # not written by slopekit: stays
    CliRunner().invoke(app, ["run", design, "--quiet", "--no-pictures", "-o", str(out)])
    assert (out / "bolts.csv").read_text() == "mine\n"


def test_the_view_has_the_bolts() -> None:
    import base64

    data, bolts = viewer_data(document("three")), bolted("three").scene.bolts

    def values(key: str, kind: str) -> np.ndarray:
        return np.frombuffer(base64.b64decode(data[key]["base64"]), kind)

    assert values("bolt_number", "<i4").tolist() == [1, 2]
    heads = values("bolt_heads", "<f4").reshape(-1, 3) + np.array(data["middle_m"])
    ends = values("bolt_ends", "<f4").reshape(-1, 3) + np.array(data["middle_m"])
    np.testing.assert_allclose(heads, bolts.heads_m, atol=1e-5)
    np.testing.assert_allclose(ends, bolts.ends_m, atol=1e-5)
    assert values("bolt_passive", "<i4").tolist() == [0, 1]
    bare = copy.deepcopy(document("three"))
    bare["scene"]["bolts"]["heads_m"]["shape"] = [1, 6]
    with pytest.raises(DesignError) as caught:
        viewer_data(bare)
    assert caught.value.codes == ("E350",)


def test_crowded_heads_leave_numbers_out_and_say_how_many() -> None:
    """All but one head drawn together to a sixth: numbers still lie on no other and on no head."""
    crowded = copy.deepcopy(document("two hundred"))
    heads = bolted("two hundred").scene.bolts.heads_m.copy()
    heads[:-1] += (heads[:-1].mean(axis=0) - heads[:-1]) * 0.85
    crowded["scene"]["bolts"]["heads_m"] = packed(heads)
    with new_figure("x") as figure:
        draw_elevation(figure, crowded)
    (axes,) = figure.axes
    figure.draw_without_rendering()
    renderer = figure.canvas.get_renderer()
    numbers = [text for text in axes.texts if text.get_gid() == "number"]
    boxes = [(text.get_text(), text.get_window_extent(renderer)) for text in numbers]
    assert overlaps(boxes) == []
    places = axes.transData.transform(
        np.concatenate([p.get_offsets() for p in axes.collections if p.get_zorder() == 5])
    )
    assert not any(
        box.x0 < x < box.x1 and box.y0 < y < box.y1 for _, box in boxes for x, y in places.tolist()
    )
    assert 10 < len(numbers) < 200
    assert f"{len(numbers)} of 200 numbers are written" in axes.texts[-1].get_text()
