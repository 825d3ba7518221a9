"""The film strip of docs/app.md: a session of `slopekit app` in chromium, eight pictures of what a user does.

`python -m benchmarks.app_film docs/images` drags, types and clicks as hands do, and writes app-1-open.png to
app-8-page.png, each below 200 kB.
"""

import io
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from PIL import Image

from tests.app.browsing import Page, started

WIDE, HIGH = 1400, 880
DESIGN = """slopekit: 1
kind: wedge
title: North wall, bench 340
slope: {face: 65/185, upper: 8/185, height: 12 m}
joints:
  J1: {plane: 52/128, strength: joint}   # mapped, 2 m spacing
  J2: {plane: 48/248, strength: joint}
strength:
  joint: {c: 12 kPa, phi: 29}            # direct shear, 6 samples
rock: {unit_weight: 26 kN/m3}
water: {fill: 0 %}
acceptance: {rules: ["fos >= 1.5"]}
"""
_LARGEST = 200_000


def keep(page: Page, folder: Path, name: str) -> None:
    """A picture of the page as it is, small enough for a repository."""
    time.sleep(0.4)
    page.script("document.documentElement.scrollTop = 0")
    picture = Image.open(io.BytesIO(page.browser.get_screenshot_as_png())).convert("RGB")
    for colours in (256, 128, 64):
        made = io.BytesIO()
        picture.quantize(colours, dither=Image.Dither.NONE).save(made, "PNG", optimize=True)
        if made.tell() < _LARGEST:
            break
    (folder / name).write_bytes(made.getvalue())
    print(f"{name}: {made.tell() / 1000:.0f} kB, factor {page.fos()}", flush=True)


def session(page: Page, folder: Path, work: Path) -> None:
    """What a user does with the wedge of a bench."""
    keep(page, folder, "app-1-open.png")
    x, y = page.pole("J2")
    page.mouse("mousePressed", x, y)
    for step in range(1, 6):
        page.mouse("mouseMoved", x - 3 * step, y - 3 * step)
        page.quiet()
    keep(page, folder, "app-2-pole.png")
    page.mouse("mouseMoved", x - 110, y + 85)
    page.quiet()
    page.until(lambda: "no answer" in page.fos())
    keep(page, folder, "app-3-fault.png")
    page.mouse("mouseReleased", x - 120, y + 90)
    page.quiet()
    page.script("document.getElementById('undo').click()")
    page.until(lambda: page.fos() == "1.733")
    page.script("document.querySelector('.governs button').click()")
    page.type("water.fill", "70 %")
    page.quiet()
    keep(page, folder, "app-4-water.png")
    page.tab("curve")
    pick = "var p = document.getElementById('curve-path'); p.value = 'water.fill'; p.dispatchEvent(new Event('change'))"
    page.until(
        lambda: page.script("return !!document.querySelector('#screen-curve .dot .name')"), 30
    )
    page.script(pick)
    page.until(
        lambda: (
            "water"
            in page.script("return document.querySelector('#screen-curve .chart').innerHTML")
        ),
        30,
    )
    time.sleep(3)
    keep(page, folder, "app-5-curve.png")
    page.tab("support")
    page.script(
        "document.getElementById('support-fos').value = 1.5;"
        " document.getElementById('support-capacity').value = 150;"
        " document.getElementById('support-run').click()"
    )
    page.until(lambda: page.script("return !!document.getElementById('add-bolts')"), 60)
    page.script("document.getElementById('add-bolts').click()")
    page.until(lambda: page.fos().startswith("1.5"))
    page.quiet()
    keep(page, folder, "app-6-bolts.png")
    page.script("document.getElementById('save').click()")
    page.until(lambda: page.script("return !!document.querySelector('.diff .plus')"))
    keep(page, folder, "app-7-save.png")
    page.script("document.getElementById('save-go').click()")
    page.until(lambda: page.script("return !document.querySelector('dialog')"))
    page.tab("handover")
    page.command("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(work))
    page.script("document.querySelector('[data-make=page]').click()")
    page.until(lambda: page.script("return !!document.querySelector('[data-what=page] a')"), 60)
    page.script("document.querySelector('[data-what=page] a').click()")
    page.until(lambda: list(work.glob("*.html")), 30)
    time.sleep(0.5)
    page.browser.get(next(work.glob("*.html")).as_uri())
    picture = Path("app-8-page.png")
    time.sleep(1.0)
    shown = Image.open(io.BytesIO(page.browser.get_screenshot_as_png())).convert("RGB")
    shown.quantize(128, dither=Image.Dither.NONE).save(folder / picture, "PNG", optimize=True)
    print(f"{picture}: {(folder / picture).stat().st_size / 1000:.0f} kB")


def main() -> None:
    """Write the pictures into a folder."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/images")
    chromium, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if not chromium or not driver:
        raise SystemExit("there is no chromium with its chromedriver here")
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as made:
        work = Path(made)
        (work / "bench-340.yaml").write_text(DESIGN, encoding="utf-8")
        command = [sys.executable, "-m", "slopekit.cli", "app", "bench-340.yaml", "--no-browser"]
        own = {**os.environ, "PYTHONUNBUFFERED": "1", "HOME": made}
        with subprocess.Popen(
            command, stdout=subprocess.PIPE, text=True, env=own, cwd=work
        ) as server:
            assert server.stdout is not None
            found = re.search(r"http://\S+/", server.stdout.readline())
            assert found is not None
            browser = started(chromium, driver, work / "profile")
            try:
                session(Page(browser, found[0], WIDE, HIGH), folder, work)
            finally:
                browser.quit()
                server.terminate()


if __name__ == "__main__":
    main()
