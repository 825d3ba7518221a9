"""Map coordinates in everything that a person reads: fixed to the millimetre, never rounded, never with an exponent."""

import html
import json
import re
from collections.abc import Iterator
from typing import Any

import pytest
from ruamel.yaml import YAML

import slopekit as sk
from slopekit.app.session import Session, opened_text
from slopekit.core.orientation import coordinates
from slopekit.design.templates import path_of
from slopekit.kinds.sheets.bolts import schedule, schedule_table
from slopekit.views.notebook import html_of
from tests.app.pages import controls_of

pytest.importorskip("jinja2")

EAST, NORTH, UP = 512300.0, 4187650.0, 1234.5
HEAD, PLACE = (EAST + 0.125, NORTH - 5.0, UP + 10.5), (EAST + 0.25, NORTH + 5.5, UP + 15.5)
WEDGE: dict[str, Any] = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "65/185", "upper": "12/195", "height": 30, "origin": [EAST, NORTH, UP]},
    "joints": {"J1": {"plane": "45/105"}, "J2": {"plane": "70/235"}},
    "strength": {"s": {"c": 5, "phi": 30}},
    "rock": {"unit_weight": 26},
    "loads": {"forces": [{"force": 100, "toward": "180/10", "at": list(PLACE)}]},
    "support": {"bolts": [{"force": 300, "toward": "005/10", "head": list(HEAD), "length": 12}]},
}
KEY = "support.bolts.0.head.1"
RANGE = f"{NORTH - 7.0}:{NORTH - 5.0}"
#: A number of the size of the coordinates, and any number with an exponent of theirs.
_NEAR = re.compile(r"(?<![\w.])(512[23]\d\d|4187[67]\d\d)(?:\.(\d+))?(?![\w.])")
_EXPONENT = re.compile(r"(?<![\w.])-?\d(?:\.\d+)?e\+?0?[56]\b")


def refuse(text: str, at_least: int = 1) -> None:
    """Every coordinate has three decimals, none is an exponent; so many stand in the text."""
    plain = re.sub(
        r"(?s)<script.*?</script>|<style.*?</style>|base64,[\w+/=]+", "", html.unescape(text)
    )
    found = list(_NEAR.finditer(plain))
    assert len(found) >= at_least, plain[:2000]
    wrong = [
        match
        for match in (*found, *_EXPONENT.finditer(plain))
        if match.re is _EXPONENT or len(match[2] or "") != 3
    ]
    assert [plain[max(0, match.start() - 40) : match.end() + 20] for match in wrong] == []


def texts(value: Any) -> Iterator[str]:
    """The texts of a document, without its keys."""
    if isinstance(value, str):
        yield value
    for part in (
        value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    ):
        yield from texts(part)


def template(name: str) -> dict[str, Any]:
    design: dict[str, Any] = YAML(typ="safe").load(path_of(name))
    return design


def blocks() -> dict[str, Any]:
    design = template("blocks")
    moved = {
        name: {**one, "polygon": [[x + EAST, z + NORTH] for x, z in one["polygon"]]}
        for name, one in design["blocks"].items()
    }
    force = {"force": 50, "toward": "270/00", "block": "B2", "at": [EAST + 10.0, 0.0, NORTH + 2.0]}
    return {**design, "blocks": moved, "loads": {"forces": [force]}}


def surface() -> dict[str, Any]:
    design = template("surface")
    profile = [[x + EAST, z + UP] for x, z in design["slope"]["profile"]]
    slip = {"shape": "sphere", "centre": [44 + EAST, NORTH, 44 + UP], "radius": 44}
    return {**design, "slope": {"profile": profile}, "slip": slip}


@pytest.mark.slow
@pytest.mark.parametrize("design", [WEDGE, blocks(), surface()], ids=["wedge", "blocks", "surface"])
def test_results(design, tmp_path) -> None:
    """Sheet, texts of the JSON, notebook, client page and schedule of bolts."""
    result = sk.run(design)
    refuse(str(result.sheet))
    refuse("\n".join(texts(json.loads(json.dumps(result.to_dict())))))
    refuse(html_of(result))
    refuse(sk.report(result, tmp_path / "page.html", pictures=False).read_text(encoding="utf-8"), 3)
    if (design.get("support") or {}).get("bolts"):
        refuse(schedule_table(schedule(result.to_dict())).csv())


def test_the_page_has_the_schedule_as_the_csv_has_it(tmp_path) -> None:
    """E 512300.125 was printed as 5.123e+05."""
    page = sk.report(sk.run(WEDGE), tmp_path / "page.html", pictures=False).read_text(
        encoding="utf-8"
    )
    for value in HEAD:
        assert f'<td class="num">{value:.3f}</td>' in page
    assert coordinates(PLACE)[1:-1] in page


@pytest.mark.slow
def test_studies_of_a_coordinate(tmp_path) -> None:
    """A key that is a coordinate: sheets, CSV, page and the ticks of the chart."""
    swept = sk.sweep(sk.load(WEDGE), {KEY: f"{RANGE}:3"}, closed_form=True)
    bars = sk.tornado(sk.load(WEDGE), {KEY: RANGE}, closed_form=True)
    found = sk.solve(sk.load(WEDGE), KEY, fos=3.0, within=(NORTH - 7.0, NORTH - 5.0))
    for study in (swept, found):
        refuse(str(study))
        refuse(html_of(study))
        refuse(
            sk.report(study, tmp_path / "study.html", pictures=False).read_text(encoding="utf-8")
        )
    refuse("\n".join(texts(json.loads(json.dumps(bars.to_dict())))))
    refuse(swept.tables()["sweep"].csv(), 3)


def test_the_ticks_of_charts_have_no_offset() -> None:
    """What matplotlib would write as +4.18764e6 at the end of the axis."""
    pytest.importorskip("matplotlib")
    from slopekit.views.charts.drawing import new_figure
    from slopekit.views.charts.sweep_charts import draw_curve

    swept = sk.sweep(sk.load(WEDGE), {KEY: f"{RANGE}:3"}, closed_form=True)
    with new_figure("x") as figure:
        draw_curve(figure, json.loads(json.dumps(swept.to_dict())))
    figure.canvas.draw()
    axis = figure.axes[0].xaxis
    assert axis.get_offset_text().get_text() == ""
    assert next(label.get_text() for label in axis.get_ticklabels()).startswith("41876")


def test_dxf_has_coordinates_in_full(tmp_path) -> None:
    pytest.importorskip("ezdxf")
    path = tmp_path / "bolts.dxf"
    sk.export(sk.run(WEDGE), path)
    text = path.read_text(encoding="utf-8")
    assert _EXPONENT.search(text) is None
    assert f"{HEAD[0]!r}" in text


def test_the_app_shows_and_takes_them_whole() -> None:
    """The box of a coordinate has its millimetres, its slider stays near, its chart rounds no coordinate."""
    session = Session(opened_text(json.dumps(WEDGE), "map.yaml"))
    control = controls_of(session.design, session.opened.design)[KEY]
    assert (control["text"], control["place"]) == (f"{HEAD[1]:.3f} m", True)
    assert control["high"] - control["low"] < 100.0
