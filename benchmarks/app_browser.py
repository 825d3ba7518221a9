"""How long the page of `slopekit app` takes from a slider to the painted answer, in chromium, by kind.

`python -m benchmarks.app_browser [SECONDS]` drags one slider of each kind for so long [10], every value sent when the
answer to the last is painted, and prints p50 and p95 beside what the library itself took, answers a second, and the
heap of the page before and after. Kinds that answer on release are sent as let go; benches, analysed on a button, are
left out. WebGL is drawn in software here: a graphics card is faster.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from tests.app.browsing import Page, started

DRAGGED = {
    "wedge": "strength.weak.phi",
    "plane": "strength.bedding.phi",
    "footing": "strength.seam.phi",
    "topple": "strength.joint.phi",
    "sphere": "strength.clay.c",
}
_DRAG = """
var done = arguments[2], path = arguments[0], seconds = arguments[1];
Promise.all(['live.js', 'controls.js', 'link.js'].map(n => import(new URL('static/' + n, location.href).href)))
.then(async ([live, controls, link]) => {
  var own = controls.control(path), low = 0.9 * own.value, high = 1.1 * own.value, took = [], inner = [];
  link.on('answer', a => { if (a.ms && !a.stale) { inner.push([a.ms.analysis, a.ms.all]); } });
  var final = document.documentElement.dataset.live !== 'drag', end = performance.now() + 1000 * seconds;
  for (var k = 0; performance.now() < end; k++) {
    var value = Number((low + (high - low) * (0.5 + 0.5 * Math.sin(k / 9))).toFixed(4));
    var began = performance.now();
    controls.take(path, { value: value, text: String(value) });
    live.change({ [path]: value }, final);
    await live.quiet();
    await new Promise(r => requestAnimationFrame(() => setTimeout(r, 0)));
    took.push(performance.now() - began);
  }
  live.change({ [path]: own.value }, true); await live.quiet();
  done([took, inner]);
});
"""


@contextmanager
def app_and_browser() -> Iterator[Page]:
    """The app with its page open, both ended afterwards."""
    chromium, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if not chromium or not driver:
        raise SystemExit("there is no chromium with its chromedriver here")
    command = [sys.executable, "-m", "slopekit.cli", "app", "--no-browser"]
    own = {**os.environ, "PYTHONUNBUFFERED": "1"}
    with (
        tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder,
        subprocess.Popen(
            command, stdout=subprocess.PIPE, text=True, env=own | {"HOME": folder}
        ) as server,
    ):
        assert server.stdout is not None
        found = re.search(r"http://\S+/", server.stdout.readline())
        assert found is not None
        browser = started(chromium, driver, Path(folder) / "profile")
        try:
            yield Page(browser, found[0], 1440)
        finally:
            browser.quit()
            server.terminate()


def dragged(page: Page, template: str, path: str, seconds: float) -> dict[str, Any]:
    """Drag a slider of a template for so long."""
    page.ask("open", template=template)
    live = page.modules("controls.js", "1") and page.script(
        "return document.documentElement.dataset.live"
    )
    before = page.heap()
    page.browser.set_script_timeout(seconds + 120)
    took, inner = page.browser.execute_async_script(_DRAG, path, seconds)
    after = page.heap()
    return {
        "live": live,
        "answers": len(took),
        "took_ms": np.asarray(took),
        "library_ms": np.asarray(inner)[:, 0],
        "server_ms": np.asarray(inner)[:, 1],
        "heap_before": before,
        "heap_after": after,
    }


def main() -> None:
    """Measure every kind and print a table."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 10.0
    head = (
        "kind",
        "live",
        "answers",
        "p50 ms",
        "p95 ms",
        "library p50",
        "server p50",
        "heap MB before",
        "after",
    )
    print(" | ".join(head))
    print("|".join("---" for _ in head))
    with app_and_browser() as page:
        for template, path in DRAGGED.items():
            one = dragged(page, template, path, seconds)
            p50, p95 = np.percentile(one["took_ms"], [50, 95])
            print(
                f"{template} | {one['live']} | {one['answers']} | {p50:.0f} | {p95:.0f} | "
                f"{np.median(one['library_ms']):.1f} | {np.median(one['server_ms']):.1f} | "
                f"{one['heap_before'] / 1e6:.2f} | {one['heap_after'] / 1e6:.2f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
