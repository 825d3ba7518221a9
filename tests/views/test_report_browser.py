"""The report in a real browser: Debian's chromium, headless, WebGL by software. Skipped where there is none."""

import base64
import io
import json
import shutil
import time
from pathlib import Path

import numpy as np
import pytest

import slopekit as sk
from slopekit.design.templates import path_of
from tests.bolted import bolted

pytest.importorskip("jinja2")
pytest.importorskip("selenium", reason="selenium is not installed (extra: test)")
CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
if not CHROMIUM or not DRIVER:
    pytest.skip("no chromium with its chromedriver on this machine", allow_module_level=True)
image = pytest.importorskip("PIL.Image", reason="pictures are read with pillow (extra: plot)")

from tests.app.browsing import started  # noqa: E402

pytestmark = pytest.mark.slow

PIXELS = 0.5  # of the view along a pixel of the page: drawn by software, a quarter of the work


@pytest.fixture(scope="module")
def pages(tmp_path_factory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("reports")
    columns = sk.run(path_of("topple"))
    return {
        "wedge": sk.report(
            sk.wedge(dips=("45/115", "45/245")), folder / "wedge.html", pictures=False
        ),
        "columns": sk.report(columns, folder / "columns.html", pictures=False),
        "two": sk.report([bolted("pattern"), columns], folder / "two.html", pictures=False),
        "bolts": sk.report(bolted("pattern"), folder / "bolts.html", pictures=False),
    }


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    driver = started(CHROMIUM, DRIVER, tmp_path_factory.mktemp("profile"), 1000, 900)
    yield driver
    driver.quit()


class Page:
    """A page that is open, and what its canvas shows."""

    def __init__(
        self, browser, path: Path, width: int = 1000, mobile: bool = False, pixels: float = PIXELS
    ) -> None:
        self.browser = browser
        for kind in ("browser", "performance"):
            browser.get_log(kind)
        self.command(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=900,
            deviceScaleFactor=pixels,
            mobile=mobile,
        )
        self.command("Emulation.setTouchEmulationEnabled", enabled=mobile)
        browser.get(path.as_uri())
        self.settled()

    def command(self, name: str, **given):
        return self.browser.execute_cdp_cmd(name, given)

    def script(self, text: str, *given):
        return self.browser.execute_script(text, *given)

    def settled(self) -> None:
        """Wait until two frames have passed."""
        self.browser.set_script_timeout(20)
        self.browser.execute_async_script(
            "var d = arguments[0]; requestAnimationFrame(function () {"
            " requestAnimationFrame(function () { d(); }); });"
        )

    def canvas(self) -> np.ndarray:
        """The pixels of the view (h, w, 3)."""
        self.settled()
        uri = self.script("return document.querySelector('#view canvas').toDataURL('image/png')")
        picture = image.open(io.BytesIO(base64.b64decode(uri.partition(",")[2]))).convert("RGB")
        return np.asarray(picture, dtype=np.int16)

    def middle(self) -> tuple[float, float]:
        box = self.script(
            "var c = document.querySelector('#view canvas'); c.scrollIntoView({block: 'center'});"
            " var b = c.getBoundingClientRect();"
            " return [b.left + b.width / 2, b.top + b.height / 2];"
        )
        return box[0], box[1]

    def set(self, name: str, value) -> None:
        """A slider, choice or check-box, as a user sets it."""
        self.script(
            "var i = document.getElementById(arguments[0]); if (i.type === 'checkbox') { i.checked = arguments[1]; }"
            " else { i.value = arguments[1]; } i.dispatchEvent(new Event('input', {bubbles: true}));",
            name,
            value,
        )

    def complaints(self) -> list[str]:
        return [entry["message"] for entry in self.browser.get_log("browser")]

    def requests(self) -> list[str]:
        """What was asked for from a network; the browser's own first page (chrome://) is not this one's."""
        messages = [
            json.loads(entry["message"])["message"] for entry in self.browser.get_log("performance")
        ]
        found = [
            m["params"]["request"]["url"]
            for m in messages
            if m["method"] == "Network.requestWillBeSent"
        ]
        return [url for url in found if url.startswith(("http", "ws", "ftp"))]


def changed(one: np.ndarray, two: np.ndarray) -> float:
    """The part of the pixels that differ visibly."""
    return float((np.abs(one - two).max(axis=2) > 12).mean())


@pytest.mark.parametrize("name", ["wedge", "columns"])
def test_the_page_opens_without_a_complaint_or_a_request(browser, pages, name) -> None:
    page = Page(browser, pages[name])
    drawn = page.canvas()
    assert (drawn.min(axis=2) < 235).mean() > 0.08  # not the white behind
    assert len(np.unique(drawn.reshape(-1, 3), axis=0)) > 20
    assert page.complaints() == []
    assert page.requests() == []
    assert page.script("return document.getElementById('scale-text').textContent").endswith(" m")
    assert page.script("return document.getElementById('view-none').hidden")


def test_it_turns_by_mouse_wheel_keyboard_and_comes_back(browser, pages) -> None:
    page = Page(browser, pages["wedge"])
    first = page.canvas()
    x, y = page.middle()
    page.command(
        "Input.dispatchMouseEvent",
        type="mousePressed",
        x=x,
        y=y,
        button="left",
        buttons=1,
        clickCount=1,
    )
    for step in range(1, 6):
        page.command(
            "Input.dispatchMouseEvent",
            type="mouseMoved",
            x=x + 20 * step,
            y=y + 5 * step,
            button="left",
            buttons=1,
        )
    page.command(
        "Input.dispatchMouseEvent",
        type="mouseReleased",
        x=x + 100,
        y=y + 25,
        button="left",
        clickCount=1,
    )
    turned = page.canvas()
    assert changed(first, turned) > 0.02
    page.command("Input.dispatchMouseEvent", type="mouseWheel", x=x, y=y, deltaX=0, deltaY=-300)
    time.sleep(0.2)
    nearer = page.canvas()
    assert (nearer.min(axis=2) < 235).mean() > (turned.min(axis=2) < 235).mean()
    page.script("document.querySelector('#view canvas').focus()")
    page.command(
        "Input.dispatchKeyEvent",
        type="keyDown",
        key="ArrowLeft",
        code="ArrowLeft",
        windowsVirtualKeyCode=37,
    )
    assert changed(nearer, page.canvas()) > 0.02
    page.script("document.getElementById('v-reset').click()")
    assert changed(first, page.canvas()) == 0.0


def test_it_turns_by_touch(browser, pages) -> None:
    page = Page(browser, pages["wedge"], 390, mobile=True)
    first = page.canvas()
    x, y = page.middle()
    page.command("Input.dispatchTouchEvent", type="touchStart", touchPoints=[{"x": x, "y": y}])
    for step in range(1, 6):
        page.command(
            "Input.dispatchTouchEvent", type="touchMove", touchPoints=[{"x": x + 15 * step, "y": y}]
        )
    page.command("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
    turned = page.canvas()
    assert changed(first, turned) > 0.02
    for step in range(6):
        fingers = [
            {"x": x + side * (20 + 8 * step), "y": y, "id": k} for k, side in enumerate((-1, 1))
        ]
        page.command(
            "Input.dispatchTouchEvent",
            type="touchMove" if step else "touchStart",
            touchPoints=fingers,
        )
    page.command("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
    assert (page.canvas().min(axis=2) < 235).mean() > 1.2 * (turned.min(axis=2) < 235).mean()
    page.script("document.getElementById('v-reset').click()")
    assert changed(first, page.canvas()) == 0.0


CONTROLS = {
    "wedge": {
        "explode": 1,
        "along": 1,
        "blocks": False,
        "rock": False,
        "clear": False,
        "slip": False,
        "loads": False,
        "contact": True,
        "pair": "kpa",
        "colour": "plain",
        "edges": False,
    },
    "columns": {
        "along": 1,
        "explode": 1,
        "joints": True,
        "colour": "block",
        "edges": False,
        "names": False,
    },
}


@pytest.mark.parametrize("name", ["wedge", "columns"])
def test_every_control_changes_the_view(browser, pages, name) -> None:
    """What is set back to what it was shows the same again; joints behind opaque blocks need them apart."""
    page = Page(browser, pages[name])
    for control, value in CONTROLS[name].items():
        page.set("v-explode", float(control == "joints"))
        first = page.canvas()
        was = page.script(
            "var i = document.getElementById(arguments[0]);"
            " return i.type === 'checkbox' ? i.checked : i.value;",
            f"v-{control}",
        )
        page.set(f"v-{control}", value)
        page.settled()
        if control == "names":
            assert page.script("return document.querySelectorAll('.tag:not([hidden])').length") == 0
        else:
            assert changed(first, page.canvas()) > 2e-4, control
        page.set(f"v-{control}", was)
        assert changed(first, page.canvas()) == 0.0, control
    assert page.complaints() == []


@pytest.mark.parametrize("name", ["wedge", "columns"])
def test_no_page_is_wider_than_a_phone(browser, pages, name) -> None:
    page = Page(browser, pages[name], 390, mobile=True)
    assert page.script("return document.documentElement.scrollWidth") <= 390
    assert page.script("return document.documentElement.clientWidth") == 390


def test_it_prints(browser, pages) -> None:
    """A PDF of A4 pages, the view as it was seen last on it and its controls not."""
    page = Page(browser, pages["wedge"])
    page.settled()
    assert page.script("return document.getElementById('view-still').src").startswith(
        "data:image/png;base64,"
    )
    printed = page.command("Page.printToPDF", preferCSSPageSize=True, printBackground=False)
    data = base64.b64decode(printed["data"])
    assert data.startswith(b"%PDF-")
    assert b"/Subtype /Image" in data
    assert 2 <= data.count(b"/Type /Page\n") <= 4
    page.command("Emulation.setEmulatedMedia", media="print")
    try:
        assert (
            page.script("return getComputedStyle(document.getElementById('view')).display")
            == "none"
        )
        assert (
            page.script(
                "return document.getElementById('view-still').getBoundingClientRect().width"
            )
            > 200
        )
    finally:
        page.command("Emulation.setEmulatedMedia", media="")


def test_no_printed_table_is_cut_off(browser, tmp_path) -> None:
    """Many bolts at map coordinates: on paper A4 every cell ends within the page (they stood in two columns)."""
    head = [512300.125, 4187645.0, 1245.0]
    bolts = [
        {"force": 300, "toward": "005/10", "head": [*head[:2], 1245.0 + 0.01 * k], "length": 12}
        for k in range(24)
    ]
    result = sk.run(
        {
            "slopekit": 1,
            "kind": "wedge",
            "rock": {"unit_weight": 26},
            "strength": {"s": {"c": 5, "phi": 30}},
            "slope": {
                "face": "65/185",
                "upper": "12/195",
                "height": 30,
                "origin": [512300, 4187650, 1234.5],
            },
            "joints": {"J1": {"plane": "45/105"}, "J2": {"plane": "70/235"}},
            "support": {"bolts": bolts},
        }
    )
    page = Page(browser, sk.report(result, tmp_path / "page.html", pictures=False), width=690)
    page.command("Emulation.setEmulatedMedia", media="print")
    try:
        ends = (
            "return Math.max(...[...document.querySelectorAll('td, th')].map((c) => "
            "c.getBoundingClientRect().right))"
        )
        assert page.script(ends) <= 690.0
    finally:
        page.command("Emulation.setEmulatedMedia", media="")


def test_each_scene_of_several_can_be_turned(browser, pages) -> None:
    """One view goes from place to place; where it is not stands its last picture, and all are printed."""
    page = Page(browser, pages["two"])
    first = page.canvas()
    stills = (
        "return ['', '-2'].map(function (n) "
        "{ return document.getElementById('view-still' + n).src.slice(0, 15); })"
    )
    assert page.script(stills) == ["data:image/png;"] * 2
    where = "return document.getElementById('view').closest('article').id"
    assert page.script(where) == "part-1"
    assert page.script("return document.getElementById('v-of-bolts').hidden") is False
    page.script("document.querySelectorAll('.turn')[1].click()")
    second = page.canvas()
    assert page.script(where) == "part-2"
    assert first.shape != second.shape or changed(first, second) > 0.05
    assert page.script("return document.getElementById('v-of-bolts').hidden") is True
    page.set("v-explode", 1.0)
    assert changed(second, page.canvas()) > 0.01
    page.script("document.querySelectorAll('.turn')[0].click()")
    assert changed(first, page.canvas()) == 0.0
    assert page.script("return document.querySelectorAll('canvas').length") == 1
    page.command("Emulation.setEmulatedMedia", media="print")
    try:
        shown = "return Array.from(document.querySelectorAll('.seen img')).map(function (i) { return i.offsetWidth; })"
        assert min(page.script(shown)) > 100
    finally:
        page.command("Emulation.setEmulatedMedia", media="")
    assert page.complaints() == []


def test_the_printed_view_has_its_legend_scale_and_north(browser, pages) -> None:
    """The canvas alone has none of them: they are drawn into the picture, the legend stands beneath it."""
    page = Page(browser, pages["columns"])
    uri = page.script("return document.getElementById('view-still').src")
    printed = np.asarray(
        image.open(io.BytesIO(base64.b64decode(uri.partition(",")[2]))).convert("RGB"), np.int16
    )
    seen = page.canvas()
    assert printed.shape == seen.shape
    differs = np.abs(printed - seen).max(axis=2) > 12
    assert differs[-94:, :94].sum() > 40  # the arrows and their letters
    assert differs[-40:, -150:].sum() > 40  # the scale bar
    page.command("Emulation.setEmulatedMedia", media="print")
    try:
        below = page.script(
            "var l = document.getElementById('view-still-legend');"
            " return [l.innerText, l.getBoundingClientRect().height];"
        )
        assert below[1] > 5
        assert "joint" in below[0] or "fails" in below[0] or "factor" in below[0]
        assert (
            page.script(
                "return document.querySelectorAll('#view-still-legend i, #view-still-legend b').length"
            )
            > 0
        )
    finally:
        page.command("Emulation.setEmulatedMedia", media="")


def test_names_of_the_arrows_never_lie_on_each_other(browser, pages) -> None:
    page = Page(browser, pages["wedge"])
    boxes = (
        "return Array.from(document.querySelectorAll('.stage svg text'))"
        ".filter(function (t) { return t.style.display !== 'none'; })"
        ".map(function (t) { var b = t.getBoundingClientRect(); return [b.left, b.right, b.top, b.bottom]; });"
    )
    for press in ("v-reset", "v-top", "v-side", "v-side", "v-side", "v-side"):
        page.script("document.getElementById(arguments[0]).click()", press)
        page.settled()
        found = page.script(boxes)
        assert found
        for k, one in enumerate(found):
            for two in found[:k]:
                assert (
                    one[1] <= two[0] + 1
                    or two[1] <= one[0] + 1
                    or one[3] <= two[2] + 4
                    or two[3] <= one[2] + 4
                )


def test_a_table_wider_than_a_phone_says_so(browser, pages) -> None:
    """Goodman & Bray's columns have eleven; every table that scrolls is shaded there and followed by a hint."""
    page = Page(browser, pages["columns"], 390, mobile=True)
    found = page.script(
        "return Array.from(document.querySelectorAll('.wide')).map(function (w) { var n = w.nextElementSibling;"
        " return [w.scrollWidth > w.clientWidth + 1, !!n && n.classList.contains('aside') && n.offsetHeight > 0,"
        " getComputedStyle(w).backgroundAttachment, w.scrollWidth - w.clientWidth]; });"
    )
    assert any(wide for wide, *_ in found)
    for wide, hinted, attachment, beyond in found:
        assert wide == hinted, (wide, hinted)
        assert "local" in attachment
        if wide:
            assert beyond > 1
    desk = Page(browser, pages["columns"])
    assert desk.script("return document.querySelectorAll('.aside').length") < sum(
        wide for wide, *_ in found
    )


def test_without_webgl_the_page_says_so(browser, pages) -> None:
    added = browser.execute_cdp_cmd(
        "Page.addScriptToEvaluateOnNewDocument",
        {"source": "HTMLCanvasElement.prototype.getContext = () => null;"},
    )
    try:
        page = Page(browser, pages["wedge"])
        assert "no WebGL" in page.script("return document.getElementById('view-none').textContent")
        assert page.script("return document.getElementById('view').hidden")
        assert page.complaints() == []
    finally:
        browser.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", added)


def test_bolts_are_shown_and_numbered_where_there_is_room(browser, pages) -> None:
    """Rods come and go with their box; no number lies on another, the axes or the scale; a bare page has no box."""
    page = Page(browser, pages["bolts"])
    with_bolts = page.canvas()
    page.set("v-bolts", False)
    assert changed(with_bolts, page.canvas()) > 1e-3
    page.set("v-bolts", True)
    assert "48 passive bolts" in page.script(
        "return document.getElementById('view-legend').textContent"
    )
    page.set("v-numbers", True)
    page.settled()
    boxes = page.script(
        "var found = Array.from(document.querySelectorAll('.tag:not([hidden]), .stage svg, .scalebar'));"
        " return found.map(function (e) { var b = e.getBoundingClientRect();"
        " return [e.textContent.trim(), b.left, b.top, b.right, b.bottom]; });"
    )
    assert len(boxes) >= 6
    for k, (one, *a) in enumerate(boxes):
        for other, *b in boxes[k + 1 :]:
            assert min(a[2], b[2]) - max(a[0], b[0]) < 1 or min(a[3], b[3]) - max(a[1], b[1]) < 1, (
                one,
                other,
            )
    assert page.complaints() == []
    bare = Page(browser, pages["wedge"])
    assert bare.script("return document.getElementById('v-bolts')") is None
