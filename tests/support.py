"""Random wedges and other things that several tests and benchmarks need."""

import math
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import slopekit as sk
from slopekit import studies
from slopekit.design.registry import KINDS
from slopekit.design.templates import path_of
from slopekit.result import Result
from slopekit.studies.protocol import STUDIES

PAPER = {"dips": ("45/115", "45/245")}
#: The template of a bench, with a few blocks: a quarter of its work, where any bench will do.
SMALL_BENCH = {"slope.height": 5, "slope.length": 8, "slope.depth": 5}


@cache
def result_of(template: str) -> Result:
    """The result of a template as it is, analysed once for all files of tests that a worker runs."""
    return sk.run(path_of(template))


def random_wedge(rng: np.random.Generator) -> dict[str, Any]:
    """Inputs of a random wedge that daylights: dips 10-89°, any directions, different strengths on the two joints.

    Half of them carry water (up to 1.5 times full), a quarter a bolt or an earthquake. Whether the planes form a
    wedge is decided here by corner points, apart from slopekit's own checks.
    """
    while True:
        joints = rng.uniform((10.0, 0.0), (89.0, 360.0), (2, 2))
        face = np.array([rng.uniform(30.0, 89.0), rng.uniform(0.0, 360.0)])
        upper = np.array([rng.uniform(0.0, min(30.0, face[0] - 2.0)), face[1]])
        height = float(10.0 ** rng.uniform(0.0, 2.0))
        back = _back_corner(joints, face, upper, height)
        if back is not None:
            break
    volume, total = back
    unit_weight = float(rng.uniform(20.0, 30.0))
    wedge: dict[str, Any] = {
        "dips": joints.tolist(),
        "face": face.tolist(),
        "upper": upper.tolist(),
        "height": height,
        "c": rng.uniform(0.0, 100.0, 2).tolist(),
        "phi": rng.uniform(5.0, 50.0, 2).tolist(),
        "unit_weight": unit_weight,
    }
    if rng.random() < 0.5:
        wedge["water"] = (rng.uniform(0.0, 1.5, 2) * 9.81 * total / 6.0).tolist()
    if rng.random() < 0.25:
        weight = unit_weight * volume
        if rng.random() < 0.5:
            wedge["seismic"] = float(rng.uniform(0.0, 0.3))
        else:
            trend, plunge = (
                (face[1] + 180.0 + rng.uniform(-40.0, 40.0)) % 360.0,
                rng.uniform(-20.0, 40.0),
            )
            acts = "active" if rng.random() < 0.5 else "passive"
            wedge["bolts"] = [
                {
                    "force": float(rng.uniform(0.01, 0.5) * weight),
                    "toward": (trend, plunge),
                    "acts": acts,
                }
            ]
    return wedge


def upward_normal(plane: Any) -> np.ndarray:
    """Upward unit normal of (dip, dip direction)."""
    dip, direction = math.radians(plane[0]), math.radians(plane[1])
    return np.array(
        [math.sin(dip) * math.sin(direction), math.sin(dip) * math.cos(direction), math.cos(dip)]
    )


def _back_corner(joints: Any, face: Any, upper: Any, height: float) -> tuple[float, float] | None:
    """Volume and total height of a wedge above both joints, None where they form none."""
    n1, n2, nf, nu = (upward_normal(plane) for plane in (*joints, face, upper))
    if abs(n1 @ n2) > math.cos(math.radians(1.0)):
        return None
    trace1, trace2, line = np.cross(n1, nf), np.cross(n2, nf), np.cross(n1, n2)
    if min(abs(trace1[2]), abs(nu @ trace2), abs(nu @ line)) < 1e-9:
        return None
    crest1 = trace1 * height / trace1[2]
    offset = nu @ crest1
    crest2, back = trace2 * offset / (nu @ trace2), line * offset / (nu @ line)
    above = n1 @ crest2 > 0.0 and n2 @ crest1 > 0.0
    if not (above and offset > 0.0 and nf @ back < 0.0 and crest2[2] > 0.0 and back[2] > 0.0):
        return None
    highest = max(crest1[2], crest2[2], back[2])
    return abs(float(np.linalg.det([crest1, crest2, back]))) / 6.0, highest


def forget_kinds() -> None:
    """Take the kinds from outside away again."""
    for name in [name for name, kind in KINDS.items() if not isinstance(kind, str)]:
        del KINDS[name]


@contextmanager
def study_of_the_page(folder: Path) -> Iterator[None]:
    """The study of docs/add-a-study.md: its files where the page says that they are, and its line of registration."""
    text = (Path(__file__).parents[1] / "docs/add-a-study.md").read_text(encoding="utf-8")
    files = re.findall(
        r"`src/slopekit/studies/flip/(\w+\.py)`.*?```python\n(.*?)```", text, re.DOTALL
    )
    assert [name for name, _ in files] == ["__init__.py", "run.py", "sheet.py"]
    (folder / "flip").mkdir(parents=True)
    for name, code in files:
        (folder / "flip" / name).write_text(code, encoding="utf-8")
    ((name, place),) = re.findall(r'^    "(\w+)": "([\w.]+)",$', text, re.MULTILINE)
    studies.__path__.append(str(folder))
    STUDIES[name] = place
    try:
        yield
    finally:
        del STUDIES[name], studies.__path__[-1]
        for module in [one for one in sys.modules if one.startswith(place)]:
            del sys.modules[module]
        vars(studies).pop(name, None)
