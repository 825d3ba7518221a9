"""The report of results without a limit, with several, without comparison: what it says has to be so."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import slopekit as sk
from slopekit.block_scene import packed
from slopekit.core.sheet import factor_text
from slopekit.design.templates import path_of
from slopekit.kinds.protocol import compare
from slopekit.views.pages import report as room
from slopekit.views.pages.report import report_of
from slopekit.views.pages.report_words import limit_of
from slopekit.views.solid import layers
from slopekit.views.solid import viewer_data as viewer
from slopekit.views.solid.stage import Stage
from slopekit.views.solid.viewer_data import viewer_data
from tests.support import result_of
from tests.views import scenes
from tests.views.test_report import document, wet_wedge, words

pytest.importorskip("jinja2")


def test_without_convergence_nothing_was_compared() -> None:
    """The combination that a result has: `compare` gives (None, False), which is no disagreement of two numbers."""
    closed = SimpleNamespace(status="slides_on_both", factor=1.2, why_not="")
    difference, agree = compare(None, "not_converged", closed, 0.01)
    assert (difference, agree) == (None, False)
    found = document("wedge") | {
        "status": "not_converged",
        "agree": agree,
        "difference": difference,
    }
    seen = words(report_of(found, with_pictures=False).html)
    assert "did not converge: no number" in seen
    assert "DISAGREE" not in seen


def no_limit() -> dict:
    """A wet wedge that moments turn over: forces alone agree, there is no limit."""
    result = wet_wedge()
    fos = replace(result.fos, limit=None, static_bound=None, highest=0.1986)
    state = replace(result.limit_state, balance=None)
    comparisons = replace(result.comparisons, forces_only=0.1986)
    toppling = replace(result, limit_state=state, comparisons=comparisons)
    return replace(toppling, fos=fos, moments_govern=True, status="topples").to_dict()


def test_the_range_of_the_mechanism_is_in_the_table() -> None:
    result = result_of("goodman-bray")
    found = replace(result, fos=replace(result.fos, lowest=0.7989, highest=1.1112)).to_dict()
    seen = words(report_of(found, with_pictures=False).html)
    assert "0.799 1.111 range for other load paths and locked-in stresses" in seen


def test_what_a_limit_of_many_blocks_is() -> None:
    """That of a path says so, and how it ended; that of one block is PRE-IE's."""
    found = document("goodman-bray")
    seen = words(report_of(found, with_pictures=False).html)
    assert f"{factor_text(found['fos']['limit'])} limit of the elastic path (k_t/k_n 0.4)" in seen
    first = found["mechanisms"][0] | {"basis": "peak", "change": 0.01, "fos": 1.0}
    assert limit_of(found | {"mechanisms": [first]}).endswith(
        "(k_t/k_n 0.4); fails at 1.010, 1 % higher"
    )
    assert limit_of(document("wet")) == "PRE-IE"


@pytest.mark.slow
def test_without_a_limit_no_number_is_praised() -> None:
    seen = words(report_of(no_limit(), with_pictures=False).html)
    for text in (
        "forces only would give 0.199: do not use it",
        "the methods AGREE on forces alone",
        "none PRE-IE",
    ):
        assert text in seen, text
    for text in (
        "the number to use",
        "limit is none",
        "at the limit.",
        "N' / kN",
        "mean σ'",
        "its bound",
        "moments lower the limit",
    ):
        assert text not in seen, text
    assert 'class="badge good">the methods' not in report_of(no_limit(), with_pictures=False).html


def test_pressure_on_a_curved_surface_is_the_designs() -> None:
    """The resultant of 5 kPa on a bowl, divided by its area, is less than 5 kPa: a sum of vectors has no mean."""
    found = sk.run(path_of("cylinder"), set={"water": "u=5kPa"}).to_dict()
    (name,) = found["geometry"]["areas_m2"]
    assert 0.0 < found["forces_kn"]["water"][name] < 5.0 * found["geometry"]["areas_m2"][name]
    assert found["sheet"]["FORCES"][0]["shown"][0][-1] == "5"


def test_why_a_block_has_no_factor() -> None:
    names = [f"B{k}" for k in range(1, 7)]
    found = scenes_of_none(names)
    seen = words(report_of(found, with_pictures=False).html)
    assert "was not asked for" not in seen
    assert "3 1.500 - - unknown" in seen
    data = viewer_data(found)
    assert data["falls"] == [0, 0, 1, 0, 0, 0]
    assert data["unsettled"] == [0, 0, 0, 1, 0, 0]


def scenes_of_none(names: list[str]) -> dict:
    """A bench by hand: one mechanism with a factor, one that falls whatever the strength, one that did not settle."""
    found = [
        scenes.mechanism("slides", 1.25, scenes.motions(names[:2], "slides")),
        scenes.mechanism("falls", None, scenes.motions(names[2:3], "falls")),
        scenes.mechanism("not_converged", 1.5, scenes.motions(names[3:4], "topples")),
    ]
    result = scenes.result(sk.load(path_of("bench")), found, names, fixed=names[5:])
    made = json.loads(json.dumps(result.to_dict()))
    made["scene"]["shapes"]["centroids"] = packed(np.zeros((len(names), 3)))
    return made


@pytest.mark.parametrize("face", ["60/180", "60/090", "60/035"])
def test_the_view_looks_as_the_stills_do(face) -> None:
    """A section is seen along its strike whatever way it faces; from its right, so that out of the slope is right."""
    found = json.loads(json.dumps(document("plane")))
    found["inputs"]["face"] = face
    bearing, above = np.radians(viewer_data(found)["look_from"])
    eye = np.array(
        [np.sin(bearing) * np.cos(above), np.cos(bearing) * np.cos(above), np.sin(above)]
    )
    np.testing.assert_allclose(eye, Stage.from_document(found).eye, atol=1e-12)
    toward = np.radians(float(face[-3:]))
    assert abs(eye @ [np.sin(toward), np.cos(toward), 0.0]) < 0.25


def test_the_view_has_the_colours_of_the_stills() -> None:
    found = document("goodman-bray")
    data, order = viewer_data(found), Stage.from_document(found).scene.order
    first, other = (
        "#" + "".join(f"{part:02x}" for part in colour) for colour in (layers.BLOCK, layers.STANDS)
    )
    assert data["plain"] == [first if place == 1 else other for place in order]
    assert len(set(data["plain"])) == 2


def test_a_fault_of_the_program_is_no_damage(monkeypatch) -> None:
    """What breaks after the document was read is a bug, and is not blamed on the file."""

    def broken(*_):
        raise ValueError("a bug")

    for module, name in (
        (room, "_rendered"),
        (room, "_verification"),
        (viewer, "_edges"),
        (viewer, "_surfaces"),
    ):
        with monkeypatch.context() as patch:
            patch.setattr(module, name, broken)
            with pytest.raises(ValueError, match="a bug"):
                report_of(document("wedge"), with_pictures=False)


@pytest.mark.parametrize("part", ["velocity", "order", "factor"])
def test_arrays_that_do_not_fit_are_damage(part) -> None:
    found = json.loads(json.dumps(document("wedge")))
    found["scene"][part] = packed(np.zeros((3, 2)))
    made = report_of(found, with_pictures=False)
    assert [notice.code for notice in made.notices] == ["W372"]
    assert "do not fit" in made.notices[0].message


@pytest.mark.slow
def test_a_chart_too_large_for_a_drawing_is_a_picture(monkeypatch) -> None:
    from slopekit.views.pages import page_pictures

    found = sk.sweep(
        sk.load(path_of("wedge")), {"slope.face.dip": [60, 65]}, closed_form=True
    ).to_dict()
    assert page_pictures.page_picture(found, "curve").startswith("data:image/svg+xml;base64,")
    monkeypatch.setattr(page_pictures, "_LARGEST_SVG", 100)
    assert page_pictures.page_picture(found, "curve").startswith("data:image/png;base64,")
