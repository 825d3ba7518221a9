"""Designs of many blocks by number: random sections, dry walls and benches, and published walls, arches and columns.

Every design is a plain mapping that goes through the public reader. The same number gives the same design on every
machine; nothing here knows how slopekit solves them.
"""

import json
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

Design = dict[str, Any]
Outline = list[tuple[float, float]]

_VERIFICATION = (
    Path(__file__).parents[1] / "src" / "slopekit" / "studies" / "suite" / "verification.json"
)

# -- sections ---------------------------------------------------------------------------------------------------------


def section(number: int) -> Design:
    """Row, stack, shards, bonded bricks or columns, in turn."""
    makers = (_row, _stack, _shards, _bonded, _columns)
    return makers[number % len(makers)](np.random.default_rng([1, number]))


def _row(rng: np.random.Generator) -> Design:
    """Two to five blocks of different heights side by side on a slope."""
    outlines, x = [], 0.0
    for _ in range(rng.integers(2, 6)):
        wide = _rounded(rng, 0.6, 3.0)
        outlines.append(_box(x, 0.0, wide, round(wide * rng.uniform(0.3, 2.0), 3)))
        x = round(x + wide, 3)
    return _on_a_slope(rng, outlines, _rounded(rng, 8.0, 40.0, 1))


def _stack(rng: np.random.Generator) -> Design:
    """One to five blocks on top of each other, each moved by up to a fifth of the one below."""
    outlines, x, z, wide = [], 0.0, 0.0, _rounded(rng, 2.0, 5.0)
    for _ in range(rng.integers(1, 6)):
        high = _rounded(rng, 0.4, 1.5)
        outlines.append(_box(x, z, wide, high))
        x, z = round(x + wide * rng.uniform(-0.2, 0.2), 3), round(z + high, 3)
        wide = round(wide * rng.uniform(0.6, 1.1), 3)
    return _on_a_slope(rng, outlines, _rounded(rng, 8.0, 35.0, 1))


def _shards(rng: np.random.Generator) -> Design:
    """A slab cut by one to three lines into convex polygons of at least a fiftieth of it."""
    wide, high = _rounded(rng, 3.0, 8.0), _rounded(rng, 1.0, 4.0)
    while True:
        pieces = [_box(0.0, 0.0, wide, high)]
        for _ in range(rng.integers(1, 4)):
            angle = math.radians(_rounded(rng, 0.0, 180.0, 0))
            through = rng.uniform([0.2 * wide, 0.3 * high], [0.8 * wide, 0.7 * high])
            pieces = [part for piece in pieces for part in _halves(piece, angle, through)]
        if min(_area(piece) for piece in pieces) > 0.02 * wide * high:
            break
    pieces.sort(key=lambda piece: sum(point[1] for point in piece) / len(piece))
    return _on_a_slope(rng, pieces, _rounded(rng, 8.0, 35.0, 1))


def _bonded(rng: np.random.Generator) -> Design:
    """Two or three courses of one to three bricks, the second moved by a part of a brick; most have cohesion."""
    wide, high, shift = _rounded(rng, 1.0, 3.0), _rounded(rng, 0.5, 1.2), _rounded(rng, 0.2, 0.8)
    count, outlines = int(rng.integers(1, 4)), []
    for course in range(rng.integers(2, 4)):
        joints = [wide * k for k in range(count + 1)]
        if course % 2:
            joints = [0.0, *(round(wide * (k + shift), 6) for k in range(count)), wide * count]
        outlines += [_box(a, course * high, b - a, high) for a, b in pairwise(joints)]
    return _on_a_slope(rng, outlines, _rounded(rng, 8.0, 30.0, 1), cohesions=(0.0, 1.0, 3.0, 8.0))


def _columns(rng: np.random.Generator) -> Design:
    """Three to eight columns on a stepped base."""
    width, dip = _rounded(rng, 1.0, 4.0), _rounded(rng, 55.0, 80.0, 1)
    step = round(width * rng.uniform(0.05, 0.3), 3)
    heights = [round(step + width * rng.uniform(0.4, 3.0), 3) for _ in range(rng.integers(3, 9))]
    design: Design = {
        "slopekit": 1,
        "kind": "topple",
        "columns": {
            "dip": dip,
            "width": width,
            "heights": heights,
            "base_step": step,
            "base": "base",
            "sides": "side",
        },
        "strength": {
            "base": {"c": _one_of(rng, (0.0, 0.0, 8.0)), "phi": _rounded(rng, 25.0, 48.0, 1)},
            "side": {"c": 0.0, "phi": _rounded(rng, 15.0, 45.0, 1)},
        },
        "rock": {"unit_weight": 25.0},
    }
    if rng.uniform() < 0.5:
        design["loads"] = {"seismic": {"k": _rounded(rng, 0.02, 0.15), "toward": 270.0}}
    return design


def _on_a_slope(
    rng: np.random.Generator,
    outlines: list[Outline],
    dip: float,
    cohesions: tuple[float, ...] = (0.0, 0.0, 0.0, 4.0),
) -> Design:
    """Outlines (x, z) on a level base, B1 upward, all turned to fall toward -x; with loads or without."""
    a = math.radians(dip)
    x = [point[0] for outline in outlines for point in outline]
    base = [(min(x) - 2.0, -2.0), (max(x) + 2.0, -2.0), (max(x) + 2.0, 0.0), (min(x) - 2.0, 0.0)]
    design: Design = {
        "slopekit": 1,
        "kind": "blocks",
        "blocks": {
            name: {
                "polygon": [
                    [u * math.cos(a) - v * math.sin(a), u * math.sin(a) + v * math.cos(a)]
                    for u, v in outline
                ]
            }
            for name, outline in [
                ("base", base),
                *((f"B{k}", outline) for k, outline in enumerate(outlines, 1)),
            ]
        },
        "interfaces": {"default": "joint", "base/B1": "base"},
        "strength": {
            name: {"c": _one_of(rng, cohesions), "phi": _rounded(rng, 12.0, 48.0, 1)}
            for name in ("joint", "base")
        },
        "rock": {"unit_weight": 25.0},
    }
    design["blocks"]["base"]["fixed"] = True
    what = rng.choice(["nothing", "nothing", "earthquake", "water", "push"])
    if what == "earthquake":
        design["loads"] = {"seismic": {"k": _rounded(rng, 0.02, 0.3), "toward": 270.0}}
    elif what == "water":
        design["water"] = {"pressures": {"base/B1": _rounded(rng, 0.5, 3.0)}}
    elif what == "push":
        force = [_rounded(rng, -4.0, 4.0), 0.0, _rounded(rng, -6.0, 0.0)]
        design["loads"] = {"forces": [{"force": force, "block": "B1"}]}
    return design


# -- dry walls --------------------------------------------------------------------------------------------------------


def wall(number: int) -> Design:
    """A dry wall of 5 to 23 blocks in running bond; load 0.4 to 1.0 of what slides or tips it as one piece."""
    rng = np.random.default_rng([2, number])
    while True:
        length, high = float(rng.integers(1, 3)), float(rng.choice([0.5, 0.75, 1.0, 1.5]))
        per_course = int(rng.integers(1, 5))
        whole, broken = (
            [length] * per_course,
            [length / 2.0, *[length] * (per_course - 1), length / 2.0],
        )
        turn = int(rng.integers(2))
        courses = [(whole, broken)[(k + turn) % 2] for k in range(rng.integers(2, 8))]
        if 5 <= sum(map(len, courses)) <= 23:
            break
    phi = _rounded(rng, 20.0, 42.0)
    as_one = min(math.tan(math.radians(phi)), sum(whole) / (high * len(courses)))
    return masonry(courses, 1.0, high, round(as_one * rng.uniform(0.4, 1.0), 4), phi, 25.0)


def masonry(
    courses: list[list[float]], length: float, high: float, k: float, phi: float, unit_weight: float
) -> Design:
    """Courses from the lowest up, of blocks so many `length` long (negative: an opening), pushed toward +x by k W."""
    wide = length * sum(map(abs, courses[0]))
    blocks: Design = {
        "base": {"polygon": [[0.0, -high], [wide, -high], [wide, 0.0], [0.0, 0.0]], "fixed": True}
    }
    for course, parts in enumerate(courses):
        ends = [round(length * float(x), 9) for x in np.cumsum([0.0, *map(abs, parts)])]
        low, top = round(course * high, 9), round((course + 1) * high, 9)
        spans = [span for span, part in zip(pairwise(ends), parts, strict=True) if part > 0.0]
        for place, (a, b) in enumerate(spans, 1):
            blocks[f"r{course + 1}b{place}"] = {"polygon": [[a, low], [b, low], [b, top], [a, top]]}
    return {
        "slopekit": 1,
        "kind": "blocks",
        "blocks": blocks,
        "strength": {"joint": {"c": 0.0, "phi": phi}},
        "rock": {"unit_weight": unit_weight},
        "loads": {"seismic": {"k": k, "toward": 90.0}},
    }


# -- benches ----------------------------------------------------------------------------------------------------------


def bench(number: int, most: int = 60) -> Design:
    """A bench of 10 to `most` blocks by three joint sets; every second one with cohesion, some wet, some scattered."""
    for attempt in range(100):
        rng = np.random.default_rng([3, number, attempt])
        found = _bench_of(rng, 5.0 * (number % 2), most)
        if found is not None:
            return found
    raise ValueError(f"no bench of 10 to {most} blocks in 100 attempts for number {number}")


def _bench_of(rng: np.random.Generator, cohesion: float, most: int) -> Design | None:
    height = _rounded(rng, 8.0, 20.0, 1)
    design: Design = {
        "slopekit": 1,
        "kind": "bench",
        "slope": {
            "face": [_rounded(rng, 50.0, 85.0, 1), 180.0],
            "upper": [0.0, 180.0],
            "height": height,
            "length": 2.0 * height,
            "depth": height,
        },
        "sets": {
            f"S{k}": {
                "plane": [_rounded(rng, 15.0, 88.0, 1), _rounded(rng, 0.0, 359.9, 1)],
                "offset": _rounded(rng, 0.0, 1.0, 2),
                "strength": "joint",
            }
            for k in (1, 2, 3)
        },
        "strength": {"joint": {"c": cohesion, "phi": _rounded(rng, 20.0, 48.0, 1)}},
        "rock": {"unit_weight": 26.0},
        "cut": {"seed": int(rng.integers(1000))},
        "loads": {"seismic": {"k": _one_of(rng, (0.0, 0.0, 0.05)), "toward": 180.0}},
    }
    if rng.uniform() < 1.0 / 3.0:
        design["water"] = {"pressures": {"S1": _rounded(rng, 2.0, 12.0, 1)}}
    if rng.uniform() < 1.0 / 3.0:
        for joint_set in design["sets"].values():
            joint_set |= {"scatter": 3.0, "spacing_scatter": 0.2}
    closer, spacing, wanted = rng.uniform(0.6, 1.6, 3), height, rng.uniform(15.0, most - 10.0)
    for _ in range(8):
        for joint_set, share in zip(design["sets"].values(), closer, strict=True):
            joint_set["spacing"] = round(float(spacing * share), 3)
        blocks = blocks_of(design)
        if 10 <= blocks <= most:
            return design
        spacing *= (max(blocks, 2) / wanted) ** (1.0 / 3.0)
    return None


def blocks_of(design: Design) -> int:
    """How many blocks a bench has; 2 where none can be cut or none can move."""
    import slopekit as sk
    from slopekit.core.errors import SlopekitError
    from slopekit.kinds import cut

    try:
        return len(cut(sk.load(design)).assembly)
    except SlopekitError:
        return 2


#: What `python -m benchmarks.blocks populations` runs, and how many of each there are.
POPULATIONS: Mapping[str, tuple[Callable[[int], Design], int]] = {
    "sections": (section, 700),
    "walls": (wall, 300),
    "benches": (bench, 200),
}


def designs(population: str, count: int | None = None) -> Iterator[Design]:
    """The first `count` designs of a population, or all."""
    make, size = POPULATIONS[population]
    return (make(number) for number in range(size if count is None else count))


# -- published --------------------------------------------------------------------------------------------------------

_HALF, _WINDOW = 0.5, -1.0
_LOW = [[1.0] * 5, [_HALF, *[1.0] * 4, _HALF]]  # walls 1 and 2
_W3 = {
    "E": [1.0] * 4,
    "U": [_HALF, 1.0, 1.0, 1.0, _HALF],
    "e": [1.0, _HALF, _WINDOW, _HALF, 1.0],
    "u": [_HALF, 1.0, _WINDOW, 1.0, _HALF],
}
_W4 = {
    "E": _LOW[1],
    "U": _LOW[0],
    "u": [1.0, _WINDOW, 1.0, _WINDOW, 1.0],
    "e": [_HALF, _HALF, _WINDOW, _HALF, _HALF, _WINDOW, _HALF, _HALF],
}
_W5 = {
    "E": [_HALF, 1.0, 1.0, _HALF],
    "U": [1.0] * 3,
    "u": [1.0, _WINDOW, 1.0],
    "e": [_HALF, _HALF, _WINDOW, _HALF, _HALF],
}
_W6 = {
    "E": [_HALF, *[1.0] * 6, _HALF],
    "U": [1.0] * 7,
    "u": [_HALF, 1.0, _WINDOW, 1.0, 1.0, _WINDOW, 1.0, _HALF],
    "e": [1.0, _HALF, _WINDOW, _HALF, 1.0, _HALF, _WINDOW, _HALF, 1.0],
}


@dataclass(frozen=True)
class PublishedWall:
    """Ferris & Tin-Loi (2001): the multipliers of the horizontal load at which a wall fails, with μ = 0.65.

    Patterns of the courses as in the public examples of HybriDFEM (thlgrs/HybriDFEM-3.1, Examples/Refactored_Legacy/
    FTL_Walls); blocks 0.4 m by 0.175 m, 10 kN/m³. `associated` with dilation at the friction angle, `multiplier`
    without. Capitals are full courses, small letters those with openings; the lowest comes first.
    """

    pattern: str
    courses: Mapping[str, list[float]]
    blocks: int
    associated: float
    multiplier: float

    def design(self, k: float | None = None) -> Design:
        """The wall at a multiplier of the horizontal load, the published one by default."""
        k = self.multiplier if k is None else k
        phi = math.degrees(math.atan(0.65))
        return masonry([self.courses[letter] for letter in self.pattern], 0.4, 0.175, k, phi, 10.0)


WALLS: Mapping[str, PublishedWall] = {
    "W1": PublishedWall("EUEUEU", _W4, 33, 0.64286, 0.640),
    "W2": PublishedWall("EUEUEUEUEU", _W4, 55, 0.58000, 0.563),
    "W3": PublishedWall("EUEueueuEUE", _W3, 46, 0.40369, 0.356),
    "W4": PublishedWall("EUEueueuEUE", _W4, 55, 0.33195, 0.264),
    "W5": PublishedWall("EUEueueuEUEueueuEUE", _W5, 61, 0.23964, 0.215),
    "W6": PublishedWall("EUEUueueuUEUueueuUEUE", _W6, 146, 0.34782, 0.297),
}


def goodman_bray(columns: int = 16) -> Design:
    """Goodman & Bray's slope with so many columns 10 m wide: 16 as they had it, more the same slope made higher."""
    rising = round(10 * columns / 16)
    heights = [4.0 * min(k, rising) - 6.0 * max(k - rising, 0) for k in range(1, columns + 1)]
    return {
        "slopekit": 1,
        "kind": "topple",
        "columns": {"dip": 60, "width": 10, "base_step": 1, "heights": heights},
        "strength": {"joint": {"c": 0, "phi": 38.15}},
        "rock": {"unit_weight": 25},
    }


def goodman_bray_factor(columns: int = 16) -> float | None:
    """The closed form of `goodman_bray`: limit equilibrium of the columns one after the other."""
    from slopekit.closed_form.toppling import ColumnSlope, toppling_factor_of_safety

    given = goodman_bray(columns)["columns"]
    return toppling_factor_of_safety(ColumnSlope(given["heights"], 10.0, 1.0, 30.0, 25.0, 38.15))[0]


def arch(thickness: float = 0.200637, friction: float = 0.6, voussoirs: int = 44) -> Design:
    """A semicircular arch of radius 10 m and so many times that thickness between fixed springings.

    Cocchetti & Rizzi (2020): at t/R = 0.200637 the least friction coefficient that holds it is 0.309215; below
    t/R = 0.1075 (Milankovitch) no friction does.
    """
    radius = 10.0
    inner, outer = radius * (1.0 - thickness / 2.0), radius * (1.0 + thickness / 2.0)
    angles = np.linspace(math.pi, 0.0, voussoirs + 1)
    directions = [(math.cos(a), max(math.sin(a), 0.0)) for a in angles]

    def at(r: float, direction: tuple[float, float]) -> list[float]:
        return [r * direction[0], r * direction[1] if abs(direction[0]) < 1.0 else 0.0]

    blocks: Design = {
        f"v{k}": {"polygon": [at(outer, a), at(outer, b), at(inner, b), at(inner, a)]}
        for k, (a, b) in enumerate(pairwise(directions), 1)
    }
    low, high = inner - 0.5, outer + 0.5
    for name, (a, b) in {"L": (-high, -low), "R": (low, high)}.items():
        blocks[name] = {"polygon": [[a, -1.0], [b, -1.0], [b, 0.0], [a, 0.0]], "fixed": True}
    return {
        "slopekit": 1,
        "kind": "blocks",
        "blocks": blocks,
        "rock": {"unit_weight": 25.0},
        "strength": {"joint": {"c": 0.0, "phi": math.degrees(math.atan(friction))}},
    }


def frame() -> Design:
    """A frame of 13 blocks under a beam that is pushed (`grid4_4` of the project's outside cases): static bound 1.

    The associated multiplier 11.227424439243126 of its horizontal force, 20 kN times that, is published with μ = 0.58.
    """
    boxes = [
        (0, 3, 1, 4),
        (0, 2, 1, 3),
        (1, 2, 2, 4),
        (2, 3, 3, 4),
        (3, 3, 4, 4),
        (2, 2, 4, 3),
        (0, 1, 2, 2),
        (2, 1, 3, 2),
        (3, 1, 4, 2),
        (0, 0, 1, 1),
        (1, 0, 2, 1),
        (2, 0, 3, 1),
        (3, 0, 4, 1),
    ]
    outlines = {
        f"b{k}": _box(x, z, end - x, top - z) for k, (x, z, end, top) in enumerate(boxes, 1)
    }
    outlines |= {"base": _box(0, -1, 4, 1), "beam": _box(0, 4, 4, 1)}
    blocks: Design = {
        name: {"polygon": [list(map(float, point)) for point in o]} for name, o in outlines.items()
    }
    blocks["base"]["fixed"] = True
    blocks["beam"]["unit_weight"] = 120.0
    push = {"force": [20.0 * 11.227424439243126, 0.0, 0.0], "block": "beam", "at": [2.0, 0.0, 4.5]}
    return {
        "slopekit": 1,
        "kind": "blocks",
        "blocks": blocks,
        "rock": {"unit_weight": 5.0},
        "strength": {"joint": {"c": 0.0, "phi": math.degrees(math.atan(0.58))}},
        "loads": {"forces": [push]},
    }


def stack(count: int = 10, dip: float = 30.0, phi: float = 35.0) -> Design:
    """Blocks 3 m by 1 m per block of the stack on an incline: tan φ / tan β, whichever joints slip."""
    return turned_section([_box(0.0, float(k), 3.0 * count, 1.0) for k in range(count)], dip, phi)


def turned_section(outlines: list[Outline], dip: float, phi: float) -> Design:
    """Outlines (x, z) on a level base, turned to fall toward -x; one friction, no cohesion, no loads."""
    made = _on_a_slope(np.random.default_rng(0), outlines, dip, (0.0,))
    keep = {key: made[key] for key in ("slopekit", "kind", "blocks", "rock")}
    return keep | {"strength": {"joint": {"c": 0.0, "phi": phi}}}


def active_passive(number: int = 1) -> tuple[Design, float]:
    """An active block pushes a passive one: `7c_two_block` 1, 2 or 6 of verification.json, and forces by hand."""
    cases = json.loads(_VERIFICATION.read_text(encoding="utf-8"))["cases"]
    case = next(case for case in cases if case["id"] == f"7c_two_block_{number}")
    return case["design"], {1: 3.291798, 2: 1.941039, 6: 4.070999}[number]


def torsion(factor: float = 2.2956) -> Design:
    """A cube of 2 m, pressed on its square base by its weight and twisted about the vertical by two forces.

    Friction fully used about the middle carries μ W a (√2 + ln(1 + √2)) / 6, the mean distance of a square from its
    middle times μ W. As `solids`, for `tests.properties.changes.run`.
    """
    side, unit_weight, phi = 2.0, 25.0, 35.0
    weight = unit_weight * side**3
    moment = math.tan(math.radians(phi)) * weight * side * _MEAN_DISTANCE / factor
    push, half = moment / side, side / 2.0

    def box(x: float, low: float, high: float) -> list[list[float]]:
        return [[a, b, c] for a in (-x, x) for b in (-x, x) for c in (low, high)]

    forces = [
        {"force": [sign * push, 0.0, 0.0], "block": "B1", "at": [0.0, -sign * half, half]}
        for sign in (1, -1)
    ]
    return {
        "slopekit": 1,
        "kind": "blocks",
        "solids": {"base": box(9.0, -2.0, 0.0), "B1": box(half, 0.0, side)},
        "strength": {"joint": {"c": 0.0, "phi": phi}},
        "rock": {"unit_weight": unit_weight},
        "loads": {"forces": forces},
    }


_MEAN_DISTANCE = (
    math.sqrt(2.0) + math.log(1.0 + math.sqrt(2.0))
) / 6.0  # of a unit square from its middle

# -- numbers and polygons ---------------------------------------------------------------------------------------------


def rolled(design: Design) -> Design:
    """Every polygon from its second corner on."""
    blocks = {
        name: block
        | ({"polygon": [*block["polygon"][1:], block["polygon"][0]]} if "polygon" in block else {})
        for name, block in design.get("blocks", {}).items()
    }
    return design | ({"blocks": blocks} if blocks else {})


def _rounded(rng: np.random.Generator, low: float, high: float, digits: int = 3) -> float:
    """A number as a person writes it."""
    return round(float(rng.uniform(low, high)), digits)


def _one_of(rng: np.random.Generator, values: tuple[float, ...]) -> float:
    return float(rng.choice(values))


def _box(x: float, z: float, wide: float, high: float) -> Outline:
    return [(x, z), (x + wide, z), (x + wide, z + high), (x, z + high)]


def _halves(piece: Outline, angle: float, through: np.ndarray) -> list[Outline]:
    """The parts of a convex polygon on the two sides of a line through a point, its normal at `angle` to z."""
    points = np.array(piece)
    height = (points - through) @ [math.sin(angle), math.cos(angle)]
    return [part for part in map(partial(_above, points), (height, -height)) if len(part) > 2]


def _above(points: np.ndarray, height: np.ndarray) -> Outline:
    """The part of a convex polygon where `height`, given at its corners, is not negative."""
    found: list[np.ndarray] = []
    for k in range(len(points)):
        after = (k + 1) % len(points)
        if height[k] >= 0.0:
            found.append(points[k])
        if height[k] * height[after] < 0.0:
            low, high = sorted((k, after))  # the same point for both parts, bit for bit
            found.append(
                points[low]
                + height[low] / (height[low] - height[high]) * (points[high] - points[low])
            )
    return [(float(x), float(z)) for x, z in found]


def _area(piece: Outline) -> float:
    x, z = np.array(piece).T
    return abs(float(x @ np.roll(z, -1) - z @ np.roll(x, -1))) / 2.0
