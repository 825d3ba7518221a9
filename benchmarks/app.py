"""How long the app takes from a slider to its answer, over the socket, beside the library's own time.

`python -m benchmarks.app` starts a server as `slopekit app` does, drags one slider of each kind of design, and prints
the median and the 95th percentile; `python -m benchmarks.app docs` writes the table of docs/howto/app.md.
"""

import asyncio
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from slopekit.design.reading.files import load, with_values
from slopekit.design.templates import path_of
from slopekit.kinds import analyse

PAGE = Path(__file__).parents[1] / "docs/howto/app.md"
_BEGIN, _END = "<!-- benchmarks.app -->", "<!-- end -->"
#: By kind: the template, the slider, where it begins and what is added each time, how often.
DRAGGED: Mapping[str, tuple[str, str, float, float, int]] = {
    "wedge": ("wedge", "joints.J1.plane.dip", 42.0, 0.05, 150),
    "plane": ("plane", "joints.J1.plane.dip", 32.0, 0.03, 150),
    "footing": ("footing", "weak_plane.dip", 38.0, 0.03, 150),
    "topple": ("topple", "strength.bedding.phi", 34.0, 0.1, 30),
    "blocks": ("blocks", "strength.joint.phi", 28.0, 0.1, 40),
    "surface": ("surface", "strength.shear zone.phi", 27.0, 0.1, 25),
    "bench": ("bench", "strength.joint.phi", 39.0, 0.1, 6),
}


def library(template: str, path: str, values: list[float]) -> list[float]:
    """Seconds of the analysis alone, of each value."""
    design, seconds = load(path_of(template)), []
    for value in values:
        other = with_values(design, {path: value})
        began = time.perf_counter()
        analyse(other)
        seconds.append(time.perf_counter() - began)
    return seconds


class Page:
    """What a browser would do, without one."""

    def __init__(self, socket: Any) -> None:
        self.socket, self.number = socket, 0

    async def ask(self, **message: Any) -> dict[str, Any]:
        """Send a message and wait for what comes of it."""
        self.number += 1
        await self.socket.send(json.dumps({"id": self.number, **message}))
        while True:
            found: dict[str, Any] = json.loads(await self.socket.recv())
            if found.get("id") == self.number:
                return found

    async def done(self) -> dict[str, Any]:
        """Wait for the end of a job."""
        while True:
            found: dict[str, Any] = json.loads(await self.socket.recv())
            if found.get("of") == "done":
                return found


async def measured(page: Page, kind: str) -> tuple[list[float], str, list[float]]:
    """Seconds from a slider to its answer."""
    template, wanted, first, step, times = DRAGGED[kind]
    path = wanted
    answer = await page.ask(do="open", template=template)
    values, seconds = [first + step * k for k in range(times)], []
    if kind == "bench":
        await asyncio.sleep(1.0)
    for value in values:
        began = time.perf_counter()
        answer = await page.ask(
            do="set", values={path: value}, final=kind not in ("wedge", "plane", "footing")
        )
        if kind == "bench":
            await page.ask(do="start", job="analyse")
            answer = (await page.done())["result"]
        seconds.append(time.perf_counter() - began)
        assert answer["lead"] is not None, answer["faults"]
    return seconds[2:], path, values


async def run(address: str, kinds: list[str]) -> list[tuple[str, str, float, float, float]]:
    """Rows: kind, slider, median, 95th percentile, the library's median, in milliseconds."""
    from websockets.asyncio.client import connect

    host, token = address.split("/")[2:4]
    rows = []
    async with connect(
        f"ws://{host}/{token}/link", origin=f"http://{host}", max_size=None, compression=None
    ) as socket:
        page = Page(socket)
        for kind in kinds:
            seconds, path, values = await measured(page, kind)
            alone = (await asyncio.to_thread(library, DRAGGED[kind][0], path, values))[2:]
            rows.append(
                (kind, path, *(1e3 * part for part in (*both(seconds), statistics.median(alone))))
            )
    return rows


def both(seconds: list[float]) -> tuple[float, float]:
    """The median and the 95th percentile."""
    ordered = sorted(seconds)
    return statistics.median(ordered), ordered[min(len(ordered) - 1, int(0.95 * len(ordered)))]


def main(arguments: list[str]) -> None:
    """Measure and print."""
    kinds = [one for one in arguments if one in DRAGGED] or list(DRAGGED)
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "slopekit.cli", "app", "--no-browser"]
        own = os.environ | {
            "XDG_STATE_HOME": folder,
            "LOCALAPPDATA": folder,
            "PYTHONUNBUFFERED": "1",
        }
        server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=own)
        try:
            assert server.stdout is not None
            address = next(
                word for word in server.stdout.readline().split() if word.startswith("http")
            )
            rows = asyncio.run(run(address, kinds))
        finally:
            server.terminate()
            server.wait()
    for row in rows:
        print("{:<8} {:<24} p50 {:7.1f}  p95 {:7.1f}  library {:7.1f}  ms".format(*row))
    if "docs" in arguments:
        keep(rows)


def keep(rows: list[tuple[str, str, float, float, float]]) -> None:
    """Write the table of the page."""
    head = (
        "| kind | slider | median, ms | 95 %, ms | library alone, ms |\n|---|---|---:|---:|---:|\n"
    )
    table = head + "".join(
        "| {} | `{}` | {:.0f} | {:.0f} | {:.1f} |\n".format(*row) for row in rows
    )
    before, _, rest = PAGE.read_text(encoding="utf-8").partition(_BEGIN)
    after = rest.partition(_END)[2]
    PAGE.write_text(f"{before}{_BEGIN}\n{table}{_END}{after}", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
