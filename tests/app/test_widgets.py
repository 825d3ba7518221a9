"""Widgets of notebooks: what `sk.explore` and `Result.view` answer, and how they look in a real browser."""

import importlib
import json
import shutil

import pytest

import slopekit as sk
from slopekit.app import notebook
from slopekit.core.errors import DesignError
from slopekit.design.templates import path_of

pytest.importorskip("anywidget", reason="anywidget is not installed (extra: notebook)")
WEDGE = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}


def heard(explorer: sk.Explorer, *messages: object) -> list[dict]:
    """What the page is told after some messages of it."""
    told: list[dict] = []
    explorer.widget.send = told.append
    for message in messages:
        explorer._heard(message)
    return told


def paths(explorer: sk.Explorer) -> list[str]:
    return [control["path"] for group in explorer.widget.groups for control in group["controls"]]


def test_a_moved_slider_is_answered_as_the_library_does() -> None:
    explorer = sk.explore(WEDGE, ["joints", "water.fill"])
    assert set(paths(explorer)) == {*(f"joints.{j}.plane.{a}" for j in ("J1", "J2") for a in ("dip", "dip_direction")),
                                    "water.fill"}  # fmt: skip
    drag = {"do": "set", "values": {"joints.J1.plane.dip": 47.0}, "final": False}
    first, last = heard(explorer, drag, {"do": "set", "values": {"joints.J1.plane.dip": 50.0}, "final": True})
    alone = sk.wedge(dips=("50/115", "45/245"))
    assert last["answer"]["fos"]["limit"] == alone.fos.limit == explorer.result.fos.limit
    assert first["answer"]["fos"]["limit"] == sk.wedge(dips=("47/115", "45/245")).fos.limit
    assert explorer.widget.answer["lead"] == last["answer"]["lead"]  # what another view of it begins with
    assert explorer.changed == ["joints.J1.plane.dip"]
    (back,) = heard(explorer, {"do": "reset", "path": "joints.J1.plane.dip"})
    assert back["answer"]["fos"]["limit"] == sk.wedge(dips=("45/115", "45/245")).fos.limit


def test_what_cannot_be_is_said_and_nothing_is_lost() -> None:
    explorer = sk.explore(WEDGE)
    (steep,) = heard(explorer, {"do": "set", "values": {"joints.J1.plane.dip": 88.0, "joints.J2.plane.dip": 88.0}})
    assert steep["answer"]["faults"][0]["code"] == "E203"
    assert steep["answer"]["lead"] is None
    assert explorer.result is None
    with pytest.raises(DesignError, match="E118"):
        explorer.set({"water.fill": "200 %"})
    explorer.set({"joints.J1.plane.dip": 45, "joints.J2.plane.dip": 45})
    assert explorer.result.fos.limit == sk.wedge(dips=("45/115", "45/245")).fos.limit
    for message in (None, 3, {}, {"do": "set"}, {"do": "set", "values": 5}, {"do": "reset", "path": 7}):
        (told,) = heard(explorer, message)  # as it was
        assert told["answer"]["lead"] == "1.557"


def test_sliders_that_a_change_makes_stand_in_another_view_too() -> None:
    """A view that is opened later begins with them; where there are no others it keeps what it has."""
    explorer = sk.explore(WEDGE)
    begun = explorer.widget.groups
    explorer.set({"joints.J1.plane.dip": 46})
    assert explorer.widget.groups is begun
    explorer.set({"crack.plane": "80/185", "crack.distance": "5 m"})
    assert {"crack.distance", "crack.plane.dip"} <= set(paths(explorer))


def test_kinds_that_take_long_wait_for_their_button() -> None:
    explorer = sk.explore(path_of("bench"), ["slope"])
    assert explorer.widget.live == "button"
    assert explorer.result is None
    assert explorer.widget.answer["stale"]


def test_a_scene_is_that_of_the_page() -> None:
    from slopekit.views.solid.viewer_data import viewer_data

    result = sk.wedge(dips=("45/115", "45/245"))
    scene = result.view().scene
    assert json.dumps(scene) == json.dumps(viewer_data(result.to_dict()))


def test_wrong_input_has_a_code(monkeypatch) -> None:
    with pytest.raises(DesignError, match="E405"):
        sk.explore(5)
    with pytest.raises(DesignError, match="E405"):
        sk.explore(WEDGE, "water")
    with pytest.raises(DesignError, match="E310"):
        sk.explore(WEDGE, ["wter"])
    real = importlib.import_module
    missing = {"anywidget"}

    def without(name: str, *rest: str) -> object:
        if name in missing:
            raise ImportError(name)
        return real(name, *rest)

    monkeypatch.setattr(notebook, "import_module", without)
    with pytest.raises(DesignError, match=r"E140 .*\(anywidget\)"):
        sk.wedge(dips=("45/115", "45/245")).view()


#: A model as a notebook has it: what the widget sends is kept, what it hears is handed on.
MODEL = """
const done = arguments[arguments.length - 1], values = JSON.parse(arguments[1]), listeners = {};
window.sent = [];
const model = { get: (name) => values[name], send: (message) => window.sent.push(message),
  on: (name, act) => { (listeners[name] = listeners[name] || []).push(act); },
  off: (name, act) => { listeners[name] = (listeners[name] || []).filter((one) => one !== act); } };
window.hear = (message) => (listeners["msg:custom"] || []).forEach((act) => act(message));
const script = URL.createObjectURL(new Blob([arguments[0]], { type: "text/javascript" }));
import(script).then((it) => { window.stopIt = it.default.render({ model, el: document.body }); done("ok"); },
  (error) => done(String(error)));
"""


def test_the_page_of_a_widget_in_a_browser(browser) -> None:
    explorer = sk.explore(WEDGE, ["joints"])
    begin = {name: getattr(explorer.widget, name) for name in ("what", "live", "groups", "answer")}
    browser.get("about:blank")
    assert browser.execute_async_script(MODEL, explorer.widget._esm, json.dumps(begin)) == "ok"
    lead = "return document.querySelector('.slopekit-lead').textContent"
    assert browser.execute_script(lead) == "1.557"
    move = """const slider = document.querySelector("input[type=range]");
        for (const value of [46, 48, 50]) { slider.value = value; slider.dispatchEvent(new Event("input")); }
        return window.sent.splice(0);"""
    asked = browser.execute_script(move)
    assert [one["values"] for one in asked] == [{"joints.J1.plane.dip": 46}]  # the others wait: one question at a time
    for _ in range(2):
        told = heard(explorer, *asked)
        asked = browser.execute_script("window.hear(arguments[0]); return window.sent.splice(0);", told[-1])
    assert asked == []
    assert browser.execute_script(lead) == f"{sk.wedge(dips=('50/115', '45/245')).fos.limit:.3f}"
    drawn = """const c = document.querySelector("canvas"), gl = c.getContext("webgl"), p = new Uint8Array(4 * 400);
        gl.readPixels(c.width / 2 - 10, c.height / 2 - 10, 20, 20, gl.RGBA, gl.UNSIGNED_BYTE, p);
        return new Set(p).size"""
    assert browser.execute_script(drawn) > 3
    assert [one for one in browser.get_log("browser") if one["level"] == "SEVERE"] == []
    browser.execute_script("window.stopIt()")


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    pytest.importorskip("selenium", reason="selenium is not installed (extra: test)")
    chromium, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if not chromium or not driver:
        pytest.skip("no chromium with its chromedriver on this machine")
    from tests.app.browsing import started

    found = started(chromium, driver, tmp_path_factory.mktemp("profile"))
    yield found
    found.quit()
