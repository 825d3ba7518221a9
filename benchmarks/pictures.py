"""What pictures, files and the report cost: `python -m benchmarks.pictures [FOLDER]`.

Writes every picture, file and report of a wedge, the paper's ellipsoid, Goodman & Bray's columns and a bench of more
than a thousand blocks into a folder (a temporary one, unless one is named: to look at them), and prints seconds, sizes
and, where there is one, the time of the bare library for the same work (pyvista drawing the same triangles).
"""

import json
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import slopekit as sk
from slopekit.core.errors import DesignError
from slopekit.design.templates import path_of
from slopekit.views.solid.scenes import SCENES, compose

BENCH = {
    "slope.height": "18 m",
    "slope.length": "44 m",
    "sets.S1.spacing": "2 m",
    "sets.S2.spacing": "2.2 m",
    "sets.S3.spacing": "2.2 m",
}
DESIGNS: dict[str, tuple[str, dict[str, str]]] = {
    "wedge": ("wedge", {}),
    "ellipsoid": ("paper-ellipsoid", {}),
    "columns": ("goodman-bray", {}),
    "bench": ("bench", BENCH),
}
FILES = ("stl", "obj", "glb", "vtu", "dxf")


def seconds(work: Callable[[], object]) -> float:
    """Wall time of one call, after the libraries are loaded."""
    began = time.perf_counter()
    work()
    return time.perf_counter() - began


def bare(document: dict[str, Any], what: str) -> float:
    """pyvista alone: a window off-screen, the same triangles in one mesh each, one screenshot of the same size."""
    import pyvista

    layers = compose(document, what).layers

    def draw() -> None:
        plotter = pyvista.Plotter(off_screen=True, window_size=[1600, 1304])
        for layer in layers:
            if len(layer.triangles):
                plotter.add_mesh(
                    pyvista.PolyData(
                        layer.vertices, np.insert(layer.triangles, 0, 3, axis=1).ravel()
                    )
                )
        plotter.screenshot(None, return_img=True)
        plotter.close()

    return seconds(draw)


def main(folder: Path) -> None:
    """Write and time everything."""
    for name, (template, changes) in DESIGNS.items():
        began = time.perf_counter()
        result = sk.run(path_of(template), set=changes)
        solved = time.perf_counter() - began
        document = result.to_dict()
        text = json.dumps(document)
        target = folder / f"{name}.json"
        target.write_text(text)
        shapes = result.scene.shapes
        free = int((~shapes.fixed).sum())
        pairs = len(result.limit_state.node_pairs)
        print(
            f"\n{name}: {len(shapes.names)} blocks ({free} may move), {pairs} node pairs, "
            f"solved in {solved:.1f} s, JSON {len(text) / 1e3:.0f} kB"
        )
        sk.plot(document, "scene", folder / "warm.png")
        for what in (*SCENES, "stereonet"):
            out = folder / f"{name}-{what}.png"
            try:
                time_ = seconds(partial(sk.plot, document, what, out))
            except DesignError as error:
                print(f"  {what:<14}{error.faults[0].code} {error.faults[0].message}")
                continue
            ratio = (
                f"{time_ / bare(document, what):6.1f} times bare pyvista" if what in SCENES else ""
            )
            print(f"  {what:<14}{time_:6.2f} s {out.stat().st_size / 1e3:8.0f} kB  {ratio}")
        for ending in FILES:
            out = folder / f"{name}.{ending}"
            time_ = seconds(partial(sk.export, document, out))
            print(f"  {ending:<14}{time_:6.2f} s {out.stat().st_size / 1e3:8.0f} kB")
        out = folder / f"{name}.html"
        time_ = seconds(partial(sk.report, document, out))
        print(f"  {'report':<14}{time_:6.2f} s {out.stat().st_size / 1e3:8.0f} kB", flush=True)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        Path(sys.argv[1]).mkdir(parents=True, exist_ok=True)
        main(Path(sys.argv[1]))
    else:
        with tempfile.TemporaryDirectory() as place:
            main(Path(place))
