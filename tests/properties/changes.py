"""What may be done to a design without changing its factor of safety, and how near two answers have to be."""

import copy
import json
import math
import tempfile
from collections.abc import Callable
from functools import lru_cache, reduce
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import slopekit as sk
from slopekit.result import Result

Design = dict[str, Any]
UTM = (5e5, 4e6, 1e3)


def reduced(design: Design, factor: float, only: str | None = None) -> Design:
    """c, tan φ and the pull of passive bolts divided by a factor, on every joint or on one."""
    out = copy.deepcopy(design)
    for name, strength in out["strength"].items():
        if only is None or name == only:
            strength["c"] /= factor
            strength["phi"] = math.degrees(
                math.atan(math.tan(math.radians(strength["phi"])) / factor)
            )
    for bolt in out.get("support", {}).get("bolts", ()):
        if bolt.get("acts") == "passive" and only is None:
            bolt["force"] /= factor
    return out


def heavier(design: Design, by: float = 2.0) -> Design:
    """Every weight, force, pressure and cohesion multiplied."""
    out = copy.deepcopy(design)
    out["rock"]["unit_weight"] *= by
    _forced(out, by, by)
    return out


def scaled(design: Design, by: float) -> Design:
    """Every length multiplied, cohesion and pressures with it, forces with the weight of the blocks."""
    out = thicker(design, by)
    _forced(out, by, by**3 if "solids" in out or out["kind"] == "bench" else by**2)
    _placed(out, lambda point: [by * x for x in point])
    for key in ("height", "length", "depth"):
        if key in out.get("slope", {}):
            out["slope"][key] *= by
    for joint_set in out.get("sets", {}).values():
        joint_set["spacing"] *= by
        joint_set["offset"] *= by
    if "columns" in out:
        columns = out["columns"]
        columns |= {key: by * columns[key] for key in ("width", "base_step")}
        columns["heights"] = [by * height for height in columns["heights"]]
    return out


def thicker(design: Design, by: float = 4.0) -> Design:
    """A section so many times as thick, and the forces on it; nothing else has a thickness."""
    out = copy.deepcopy(design)
    if "columns" in out:
        out["columns"]["thickness"] = by * out["columns"].get("thickness", 1.0)
    elif "blocks" in out:
        out["section"] = {"thickness": by * out.get("section", {}).get("thickness", 1.0)}
    else:
        return out
    _forced(out, 1.0, by)
    return out


def in_turn(*changes: Callable[[Design], Design]) -> Callable[[Design], Design]:
    """One change after the other."""
    return lambda design: reduce(lambda found, change: change(found), changes, design)


def with_rests(design: Design) -> Design:
    """With a block that lies on level rock beside the scene, and one that is fixed and touches nothing."""
    out = copy.deepcopy(design)
    out["blocks"] |= {
        "ledge": {"polygon": [[90.0, -2.0], [99.0, -2.0], [99.0, 0.0], [90.0, 0.0]], "fixed": True},
        "idle": {"polygon": [[92.0, 0.0], [95.0, 0.0], [95.0, 2.0], [92.0, 2.0]]},
        "far": {"polygon": [[190.0, 0.0], [199.0, 0.0], [199.0, 9.0], [190.0, 9.0]], "fixed": True},
    }
    return out


def moved(design: Design, to: tuple[float, float, float] = UTM) -> Design:
    """The scene elsewhere; a section by x and z."""
    out = copy.deepcopy(design)
    if out["kind"] == "bench":
        out["slope"]["origin"] = list(to)
    _placed(
        out,
        lambda point: [
            a + b for a, b in zip(point, to if len(point) == 3 else (to[0], to[2]), strict=True)
        ],
    )
    return out


def mirrored(design: Design) -> Design:
    """East for west."""
    out = copy.deepcopy(design)
    _placed(out, lambda point: [-point[0], *point[1:]])
    _directed(out, lambda azimuth: -azimuth % 360.0, lambda force: [-force[0], *force[1:]])
    return out


def turned(design: Design, by: float) -> Design:
    """The scene turned clockwise (seen from above) about the vertical; not for sections."""
    c, s = math.cos(math.radians(by)), math.sin(math.radians(by))

    def turn(point: list[float]) -> list[float]:
        return [c * point[0] + s * point[1], c * point[1] - s * point[0], point[2]]

    out = copy.deepcopy(design)
    _placed(out, turn)
    _directed(out, lambda azimuth: (azimuth + by) % 360.0, turn)
    return out


def reordered(design: Design) -> Design:
    """Blocks and joint sets in the opposite order."""
    out = copy.deepcopy(design)
    for key in ("blocks", "solids", "sets", "strength"):
        if key in out:
            out[key] = dict(reversed(out[key].items()))
    return out


def _placed(design: Design, place: Callable[[list[float]], list[float]]) -> None:
    for block in design.get("blocks", {}).values():
        block["polygon"] = [place(point) for point in block["polygon"]]
    for name, corners in design.get("solids", {}).items():
        design["solids"][name] = [place(point) for point in corners]


def _directed(
    design: Design, azimuth: Callable[[float], float], vector: Callable[[list[float]], list[float]]
) -> None:
    for key in ("face", "upper"):
        if key in design.get("slope", {}):
            dip, direction = design["slope"][key]
            design["slope"][key] = [dip, azimuth(direction)]
    for joint_set in design.get("sets", {}).values():
        joint_set["plane"] = [joint_set["plane"][0], azimuth(joint_set["plane"][1])]
    loads = design.get("loads", {})
    if "seismic" in loads:
        loads["seismic"]["toward"] = azimuth(loads["seismic"]["toward"])
    for force in loads.get("forces", ()):
        force["force"] = vector(force["force"])
    for bolt in design.get("support", {}).get("bolts", ()):
        bolt["toward"] = [azimuth(bolt["toward"][0]), bolt["toward"][1]]


def _forced(design: Design, pressure: float, force: float) -> None:
    for strength in design["strength"].values():
        strength["c"] *= pressure
    pressures = design.get("water", {}).get("pressures", {})
    pressures.update({name: pressure * value for name, value in pressures.items()})
    for push in design.get("loads", {}).get("forces", ()):
        push["force"] = [force * part for part in push["force"]]
    for bolt in design.get("support", {}).get("bolts", ()):
        bolt["force"] *= force


# -- running and comparing --------------------------------------------------------------------------------------------

_FACES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))


def run(design: Design) -> Result:
    """Analyse a design; what is asked for again is not solved again."""
    return _run(json.dumps(design))


@lru_cache(maxsize=256)
def _run(text: str) -> Result:
    design = json.loads(text)
    solids = design.pop("solids", None)
    if solids is None:
        return sk.run(design)
    with tempfile.TemporaryDirectory() as folder:
        design["blocks"] = {}
        for name, corners in solids.items():
            path = Path(folder) / f"{name}.obj"
            path.write_text(_obj(np.array(corners)), encoding="utf-8")
            design["blocks"][name] = {"mesh": str(path), "fixed": name == "base"}
        return sk.run(design)


def _obj(corners: np.ndarray) -> str:
    """A body of eight corners (x, then y, then z fastest) as a mesh of triangles, all digits of its coordinates."""
    away = corners - corners.mean(axis=0)
    lines = ["v {!r} {!r} {!r}".format(*corner) for corner in corners.tolist()]
    for face in _FACES:
        a, b, c = away[list(face[:3])]
        out = float(np.cross(b - a, c - a) @ a) > 0.0
        p, q, r, s = (k + 1 for k in (face if out else face[::-1]))
        lines += [f"f {p} {q} {r}", f"f {p} {r} {s}"]
    return "\n".join(lines) + "\n"


def swing(*results: Result) -> float:
    """How surely these analyses know their factor, as they report it themselves.

    The bracket of a motion that did not settle (W317); a limit state has none.
    """
    return sum(result.model.residual for result in results)


def same(one: Result, other: Result, rel: float = 1e-6, times: float = 1.0) -> None:
    """The same status, factor (`times` the first) and static bound.

    `rel` is what settles exactly; where it did not (W317, or moments that govern one block) the answers may differ by
    the swing that both report: such a limit is not unique to more digits.
    """
    assert other.status == one.status
    allowed = rel + swing(one, other)
    if one.fos.limit is None:
        assert other.fos.limit is None
        return
    assert other.fos.limit == pytest.approx(times * one.fos.limit, rel=allowed)
    assert (one.fos.static_bound is None) == (other.fos.static_bound is None)
    if one.fos.static_bound is not None:
        assert other.fos.static_bound == pytest.approx(times * one.fos.static_bound, rel=1e-4 + rel)
