"""The widget of notebooks: what `Result.view` holds, and how it looks in a real browser."""

import json
import shutil
import sys

import pytest

import slopekit as sk
from slopekit.core.errors import DesignError

pytestmark = pytest.mark.slow

pytest.importorskip("anywidget", reason="anywidget is not installed (extra: notebook)")


def test_a_scene_is_that_of_the_page() -> None:
    from slopekit.views.solid.viewer_data import viewer_data

    result = sk.wedge(dips=("45/115", "45/245"))
    scene = result.view().scene
    assert json.dumps(scene) == json.dumps(viewer_data(result.to_dict()))


def test_the_missing_extra_is_named(monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "anywidget", None)
    with pytest.raises(DesignError, match=r"E140 .*\(anywidget\)"):
        sk.wedge(dips=("45/115", "45/245")).view()


#: A model as a notebook has it.
MODEL = """
const done = arguments[arguments.length - 1], values = JSON.parse(arguments[1]);
const model = { get: (name) => values[name], on: () => {}, off: () => {} };
const script = URL.createObjectURL(new Blob([arguments[0]], { type: "text/javascript" }));
import(script).then((it) => { window.stopIt = it.default.render({ model, el: document.body }); done("ok"); },
  (error) => done(String(error)));
"""


def test_the_page_of_a_widget_in_a_browser(browser) -> None:
    widget = sk.wedge(dips=("45/115", "45/245")).view()
    browser.get("about:blank")
    assert (
        browser.execute_async_script(MODEL, widget._esm, json.dumps({"scene": widget.scene}))
        == "ok"
    )
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
