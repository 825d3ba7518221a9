"""A page of the app in chromium: hands, eyes and what the browser counts. Used by tests and benchmarks."""

import json
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service

ARGUMENTS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-gpu-rasterization",
    "--disable-extensions",
    "--disable-sync",
)
_CODES = {
    "ArrowLeft": 37,
    "ArrowUp": 38,
    "ArrowRight": 39,
    "ArrowDown": 40,
    "Home": 36,
    "Enter": 13,
}


def started(chromium: str, driver: str, profile: Path, width: int = 1120, height: int = 700) -> Any:
    """A browser that nobody sees, with its logs on; its window in pixels."""
    options = Options()
    options.binary_location = chromium
    for argument in (*ARGUMENTS, f"--window-size={width},{height}", f"--user-data-dir={profile}"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    found = webdriver.Chrome(options=options, service=Service(driver))
    found.set_page_load_timeout(60)
    found.set_script_timeout(60)
    return found


class Page:
    """The app's page, open in a browser."""

    def __init__(self, browser: Any, address: str, width: int = 1120, height: int = 700) -> None:
        self.browser, self.address = browser, address
        self.wide(width, height)
        browser.get(address)
        self.until(lambda: self.fos() not in ("", "…"), 30)

    def wide(self, width: int, height: int = 700) -> None:
        """As wide as that, in pixels of CSS."""
        self.command(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=False,
        )

    def command(self, name: str, **given: Any) -> Any:
        """A command of the browser's own protocol."""
        return self.browser.execute_cdp_cmd(name, given)

    def script(self, text: str, *given: Any) -> Any:
        """What a script returns."""
        return self.browser.execute_script(text, *given)

    def modules(self, name: str, expression: str) -> Any:
        """The value of an expression, `m` being a module of the page."""
        return self.browser.execute_async_script(
            "var done = arguments[1]; import(new URL('static/' + arguments[0], location.href).href)"
            f".then(async m => done(await ({expression})));",
            name,
        )

    def ask(self, verb: str, **given: Any) -> Any:
        """Ask the server over the page's own socket, and let the page show what comes."""
        found = self.modules("link.js", f"m.ask({json.dumps(verb)}, {json.dumps(given)})")
        self.quiet()
        return found

    def quiet(self) -> None:
        """Wait until nothing waits for an answer, and two frames have passed."""
        frames = "new Promise(d => requestAnimationFrame(() => requestAnimationFrame(d)))"
        self.modules("live.js", f"m.quiet().then(() => {frames}).then(() => 1)")

    def until(self, holds: Callable[[], object], seconds: float = 10.0) -> None:
        """Wait until something holds."""
        end = time.monotonic() + seconds
        while not holds():
            assert time.monotonic() < end, "it never came"
            time.sleep(0.03)

    def text(self, name: str) -> str:
        """What an element says, by its id."""
        found = self.script(
            "var e = document.getElementById(arguments[0]); return e ? e.textContent : ''", name
        )
        return str(found)

    def fos(self) -> str:
        """The large figure."""
        return self.text("fos")

    def tab(self, name: str) -> None:
        """Go to a screen."""
        self.script("document.getElementById('tab-' + arguments[0]).click()", name)

    def value(self, path: str) -> float:
        """The number that stands in the box of a control."""
        shown = self.script(
            "return document.getElementById('c-' + arguments[0] + '-box').value", path
        )
        return float(str(shown).split()[0].rstrip("°"))

    def type(self, path: str, text: str) -> None:
        """Write into the box of a control."""
        self.script(
            "var b = document.getElementById('c-' + arguments[0] + '-box'); b.value = arguments[1];"
            " b.dispatchEvent(new Event('change'))",
            path,
            text,
        )

    def box(self, name: str) -> list[float]:
        """Left, top, width and height of an element."""
        found = self.script(
            "var b = document.getElementById(arguments[0]).getBoundingClientRect();"
            " return [b.left, b.top, b.width, b.height]",
            name,
        )
        return [float(one) for one in found]

    def pole(self, name: str) -> tuple[float, float]:
        """Where a pole is on the screen."""
        found = self.script(
            "var p = document.querySelector('.pole[data-name=\"' + arguments[0] + '\"] .spot');"
            " p.scrollIntoView({block: 'center'}); var b = p.getBoundingClientRect();"
            " return [b.left + b.width / 2, b.top + b.height / 2]",
            name,
        )
        return float(found[0]), float(found[1])

    def mouse(self, what: str, x: float, y: float) -> None:
        """The mouse, its left button down or going down or up."""
        self.command(
            "Input.dispatchMouseEvent",
            type=what,
            x=x,
            y=y,
            button="left",
            buttons=0 if what == "mouseReleased" else 1,
            clickCount=1,
        )

    def key(self, name: str, control: bool = False, shift: bool = False) -> None:
        """A key, down and up."""
        code = _CODES.get(name) or ord(name.upper())
        modifiers = 2 * control + 8 * shift
        for what in ("rawKeyDown", "keyUp"):
            self.command(
                "Input.dispatchKeyEvent",
                type=what,
                key=name.upper() if shift and len(name) == 1 else name,
                code=name if len(name) > 1 else f"Key{name.upper()}",
                windowsVirtualKeyCode=code,
                modifiers=modifiers,
            )

    def updates(self, path: str, values: Sequence[float]) -> None:
        """Set a value many times as a slider does, each after the answer to the last; the last is let go."""
        self.browser.execute_async_script(
            "var done = arguments[2], path = arguments[0], values = arguments[1];"
            "Promise.all(['live.js', 'controls.js'].map(n => import(new URL('static/' + n, location.href).href)))"
            ".then(async ([live, controls]) => { for (var k = 0; k < values.length; k++) {"
            " var v = Number(values[k].toFixed(6)); controls.take(path, {value: v, text: String(v)});"
            " live.change({[path]: v}, k === values.length - 1); await live.quiet(); } done(); });",
            path,
            list(values),
        )
        self.quiet()

    def heap(self) -> float:
        """Bytes that live scripts hold, after collection."""
        for _ in range(2):
            self.command("HeapProfiler.collectGarbage")
        return float(self.command("Runtime.getHeapUsage")["usedSize"])

    def counters(self) -> dict[str, int]:
        """Documents, nodes and listeners that live."""
        return dict(self.command("Memory.getDOMCounters"))

    def scene(self) -> Any:
        """The scene of the present design, as the server sends it."""
        return self.ask("set", values={"rock.density": 2600}, final=True)["scene"]

    def complaints(self) -> list[str]:
        """What stands in the browser's console."""
        return [entry["message"] for entry in self.browser.get_log("browser")]

    def requests(self) -> list[str]:
        """The addresses that were asked for."""
        messages = [
            json.loads(entry["message"])["message"] for entry in self.browser.get_log("performance")
        ]
        found = [
            m["params"]["request"]["url"]
            for m in messages
            if m["method"] == "Network.requestWillBeSent"
        ]
        found += [m["params"]["url"] for m in messages if m["method"] == "Network.webSocketCreated"]
        return [url for url in found if not url.startswith(("chrome", "about:"))]
