"""Random designs that could stand in a report: wedges, sections of polygons, rows of columns, bricks, benches.

A design is a plain mapping, as a file would give it, so that `changes` can turn, mirror, move and scale it.
"""

import math
from itertools import pairwise
from typing import Any

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st

import slopekit as sk
from slopekit.core.errors import SlopekitError
from slopekit.kinds import cut

Mapping = dict[str, Any]


def rounded(low: float, high: float, digits: int = 3) -> st.SearchStrategy[float]:
    """Numbers as a person writes them."""
    return st.floats(low, high).map(lambda value: round(value, digits))


frictions = rounded(12.0, 48.0, 1)
cohesions = st.sampled_from([0.0, 0.0, 0.0, 2.0, 8.0])


def _section(draw, outlines: list[list[tuple[float, float]]], dip: float) -> Mapping:
    """Outlines (x, z) on a level base, B1 upward, all turned to fall toward -x; with loads or without."""
    a = math.radians(dip)

    def turned(outline) -> list[list[float]]:
        return [
            [x * math.cos(a) - z * math.sin(a), x * math.sin(a) + z * math.cos(a)]
            for x, z in outline
        ]

    x = [point[0] for outline in outlines for point in outline]
    base = [(min(x) - 2.0, -2.0), (max(x) + 2.0, -2.0), (max(x) + 2.0, 0.0), (min(x) - 2.0, 0.0)]
    blocks: Mapping = {"base": {"polygon": turned(base), "fixed": True}}
    blocks |= {f"B{k}": {"polygon": turned(outline)} for k, outline in enumerate(outlines, 1)}
    design = {
        "slopekit": 1,
        "kind": "blocks",
        "blocks": blocks,
        "interfaces": {"default": "joint", "base/B1": "base"},
        "strength": {
            "joint": {"c": draw(cohesions), "phi": draw(frictions)},
            "base": {"c": draw(cohesions), "phi": draw(frictions)},
        },
        "rock": {"unit_weight": 25.0},
    }
    return design | draw(_section_loads())


@st.composite
def _section_loads(draw) -> Mapping:
    """Nothing, an earthquake, water below B1, a push on B1, a bolt that holds it."""
    found: Mapping = {}
    what = draw(st.sampled_from(["nothing", "nothing", "earthquake", "water", "push", "bolt"]))
    if what == "earthquake":
        found["loads"] = {"seismic": {"k": 0.1, "toward": 270.0}}
    elif what == "water":
        found["water"] = {"pressures": {"base/B1": draw(rounded(0.5, 3.0))}}
    elif what == "push":
        found["loads"] = {
            "forces": [
                {"force": [draw(rounded(-4.0, 4.0)), 0.0, draw(rounded(-6.0, 0.0))], "block": "B1"}
            ]
        }
    elif what == "bolt":
        found["support"] = {
            "bolts": [
                {
                    "force": draw(rounded(0.5, 4.0)),
                    "toward": [90.0, -10.0],
                    "block": "B1",
                    "acts": "active",
                }
            ]
        }
    return found


def _box(x: float, z: float, wide: float, high: float) -> list[tuple[float, float]]:
    return [(x, z), (x + wide, z), (x + wide, z + high), (x, z + high)]


@st.composite
def stacks(draw) -> Mapping:
    """One to four blocks on top of each other, each set back or forward by up to a fifth of the one below."""
    outlines, x, z, wide = [], 0.0, 0.0, draw(rounded(2.0, 5.0))
    for _ in range(draw(st.integers(1, 4))):
        high = draw(rounded(0.4, 1.5))
        outlines.append(_box(x, z, wide, high))
        x, z = round(x + wide * draw(rounded(-0.2, 0.2)), 3), round(z + high, 3)
        wide = round(wide * draw(rounded(0.6, 1.1)), 3)
    return _section(draw, outlines, draw(rounded(8.0, 35.0, 1)))


@st.composite
def rows(draw) -> Mapping:
    """Two to four blocks of different heights side by side on a slope: they lean on each other and push."""
    outlines, x = [], 0.0
    for _ in range(draw(st.integers(2, 4))):
        wide = draw(rounded(0.6, 3.0))
        outlines.append(_box(x, 0.0, wide, round(wide * draw(rounded(0.3, 2.0)), 3)))
        x = round(x + wide, 3)
    return _section(draw, outlines, draw(rounded(8.0, 40.0, 1)))


@st.composite
def shards(draw) -> Mapping:
    """A slab cut by one to three lines into convex polygons."""
    wide, high = draw(rounded(3.0, 8.0)), draw(rounded(1.0, 4.0))
    pieces = [_box(0.0, 0.0, wide, high)]
    for _ in range(draw(st.integers(1, 3))):
        angle, at = (
            math.radians(draw(rounded(0.0, 180.0, 0))),
            (draw(rounded(0.2, 0.8)), draw(rounded(0.3, 0.7))),
        )
        normal = np.array([math.sin(angle), math.cos(angle)])
        offset = float(normal @ [at[0] * wide, at[1] * high])
        pieces = [part for piece in pieces for part in _halves(piece, normal, offset)]
    assume(min(_area(piece) for piece in pieces) > 0.01 * wide * high)
    pieces.sort(key=lambda piece: sum(point[1] for point in piece) / len(piece))
    return _section(draw, pieces, draw(rounded(8.0, 35.0, 1)))


@st.composite
def bonds(draw) -> Mapping:
    """Two or three courses of bricks, the second course moved by part of a brick: more contacts than equations."""
    wide, high, shift = draw(rounded(1.0, 3.0)), draw(rounded(0.5, 1.2)), draw(rounded(0.2, 0.8))
    count = draw(st.integers(1, 3))
    outlines = []
    for course in range(draw(st.integers(2, 3))):
        joints = [wide * k for k in range(count + 1)]
        if course % 2:
            joints = [0.0, *(round(wide * (k + shift), 6) for k in range(count)), wide * count]
        outlines += [
            [
                (a, course * high),
                (b, course * high),
                (b, (course + 1) * high),
                (a, (course + 1) * high),
            ]
            for a, b in pairwise(joints)
        ]
    return _section(draw, outlines, draw(rounded(8.0, 30.0, 1)))


def _halves(piece, normal: np.ndarray, offset: float) -> list[list[tuple[float, float]]]:
    """The parts of a convex polygon on the two sides of a line."""
    points = np.array(piece)
    height = points @ normal - offset
    found = []
    for sign in (1.0, -1.0):
        part: list[tuple[float, float]] = []
        for k in range(len(points)):
            here, there = sign * height[k], sign * height[(k + 1) % len(points)]
            if here >= 0.0:
                part.append((float(points[k, 0]), float(points[k, 1])))
            if here * there < 0.0:
                low, high = sorted(
                    (k, (k + 1) % len(points))
                )  # the same point for both pieces, bit for bit
                share = height[low] / (height[low] - height[high])
                cut = points[low] + share * (points[high] - points[low])
                part.append((float(cut[0]), float(cut[1])))
        if len(part) > 2 and _area(part) > 1e-9:
            found.append(part)
    return found


def _area(piece) -> float:
    x, z = np.array(piece).T
    return abs(float(x @ np.roll(z, -1) - z @ np.roll(x, -1))) / 2.0


@st.composite
def columns(draw) -> Mapping:
    """A row of three to six columns on a stepped base that topple, slide or stand."""
    count, width, dip = (
        draw(st.integers(3, 6)),
        draw(rounded(1.0, 4.0)),
        draw(rounded(55.0, 80.0, 1)),
    )
    step = round(width * draw(rounded(0.05, 0.3)), 3)
    heights = [round(step + width * draw(rounded(0.4, 3.0)), 3) for _ in range(count)]
    base = {"c": draw(cohesions), "phi": draw(rounded(25.0, 48.0, 1))}
    side = {"c": 0.0, "phi": draw(rounded(15.0, 45.0, 1))}
    design = {
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
        "strength": {"base": base, "side": side},
        "rock": {"unit_weight": 25.0},
    }
    if draw(st.booleans()):
        design["loads"] = {"seismic": {"k": 0.05, "toward": 270.0}}
    return design


@st.composite
def bolted(draw, families: st.SearchStrategy[Mapping]) -> Mapping:
    """A design of blocks with one to three passive bolts, up or down the slope, weak to strong."""
    design = dict(draw(families))
    names = [name for name in (design.get("solids") or design["blocks"]) if name != "base"]
    bolts = [
        {
            "force": draw(rounded(1.0, 150.0)),
            "toward": [draw(st.sampled_from([90.0, 90.0, 270.0])), draw(rounded(-60.0, 80.0, 1))],
            "acts": "passive",
            "block": draw(st.sampled_from(names)),
        }
        for _ in range(draw(st.integers(1, 3)))
    ]
    return design | {"support": {"bolts": bolts}}


@st.composite
def bricks(draw) -> Mapping:
    """Two to four blocks of six flat faces each, none quite square, on a slope; corners (x, y, z) by their names.

    Three families of planes, each plane tilted by up to 6 degrees from its family: where three of them meet is a
    corner, and neighbours share their faces.
    """
    counts = draw(
        st.sampled_from([(1, 1, 2), (2, 1, 1), (1, 2, 1), (1, 1, 3), (2, 1, 2), (2, 2, 1)])
    )
    size = [draw(rounded(2.0, 4.0)), draw(rounded(2.0, 4.0)), draw(rounded(1.0, 2.0))]
    planes: list[list[tuple[np.ndarray, float]]] = []
    for axis, count in enumerate(counts):
        family = []
        for k in range(count + 1):
            normal = np.eye(3)[axis]
            if axis < 2 or k:  # the lowest plane is the base
                tilt = [math.tan(math.radians(draw(rounded(-6.0, 6.0, 1)))) for _ in range(2)]
                normal[[(axis + 1) % 3, (axis + 2) % 3]] = tilt
            middle = np.array([counts[j] * size[j] / 2.0 for j in range(3)])
            middle[axis] = k * size[axis]
            family.append((normal, float(normal @ middle)))
        planes.append(family)
    a = math.radians(draw(rounded(10.0, 32.0, 1)))
    slope = np.array(
        [[math.cos(a), 0.0, -math.sin(a)], [0.0, 1.0, 0.0], [math.sin(a), 0.0, math.cos(a)]]
    )

    def corner(*index: int) -> list[float]:
        faces = [planes[axis][k] for axis, k in enumerate(index)]
        found = np.linalg.solve(
            np.array([normal for normal, _ in faces]), [offset for _, offset in faces]
        )
        return (slope @ found).tolist()

    solids: Mapping = {
        "base": [
            (slope @ [x, y, z]).tolist()
            for x in (-30.0, 30.0)
            for y in (-30.0, 30.0)
            for z in (-2.0, 0.0)
        ]
    }
    for number, (i, j, k) in enumerate(np.ndindex(*counts), 1):
        solids[f"B{number}"] = [
            corner(i + x, j + y, k + z) for x in (0, 1) for y in (0, 1) for z in (0, 1)
        ]
    return {
        "slopekit": 1,
        "kind": "blocks",
        "solids": solids,
        "strength": {"joint": {"c": draw(cohesions), "phi": draw(frictions)}},
        "rock": {"unit_weight": 25.0},
        "loads": {"seismic": {"k": draw(st.sampled_from([0.0, 0.0, 0.05])), "toward": 270.0}},
    }


@st.composite
def benches(draw, most: int = 60) -> Mapping:
    """A bench of 10 to `most` blocks by three joint sets of any orientation."""
    face, height = draw(rounded(50.0, 85.0, 1)), draw(rounded(8.0, 20.0, 1))
    planes = [(draw(rounded(15.0, 88.0, 1)), draw(rounded(0.0, 359.9, 1))) for _ in range(3)]
    design: Mapping = {
        "slopekit": 1,
        "kind": "bench",
        "slope": {
            "face": [face, 180.0],
            "upper": [0.0, 180.0],
            "height": height,
            "length": 2.0 * height,
            "depth": height,
        },
        "sets": {
            f"S{k}": {"plane": list(plane), "offset": 0.3, "strength": "joint"}
            for k, plane in enumerate(planes, 1)
        },
        "strength": {"joint": {"c": draw(cohesions), "phi": draw(frictions)}},
        "rock": {"unit_weight": 26.0},
        "loads": {"seismic": {"k": draw(st.sampled_from([0.0, 0.0, 0.05])), "toward": 180.0}},
    }
    spacing, wanted = height, draw(st.integers(15, most - 10))
    for _ in range(8):
        for joint_set in design["sets"].values():
            joint_set["spacing"] = round(spacing, 3)
        blocks = _blocks_of(design)
        if 10 <= blocks <= most:
            return design
        spacing *= (max(blocks, 2) / wanted) ** (1.0 / 3.0)
    assume(False)
    return design


def _blocks_of(design: Mapping) -> int:
    """How many blocks a bench has; 2 where none can move."""
    try:
        return len(cut(sk.load(design)).assembly)
    except SlopekitError:
        return 2
