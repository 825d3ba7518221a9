"""Designs of every kind, each with its exact answer: one set of numbers makes both."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from tests.hard_cases import exact
from tests.hard_cases.exact import Exact

#: The paper's wedge; Wyllie & Mah's wedge; a wedge of 10 m below level ground; one that an earthquake can lift.
PAPER: Mapping[str, Any] = {
    "dips": ((45, 115), (45, 245)),
    "face": (60, 180),
    "upper": (10, 180),
    "height": 64.89,
    "c": 50,
    "phi": 20,
    "unit_weight": 25.506,
}
WYLLIE: Mapping[str, Any] = {
    "dips": ((45, 105), (70, 235)),
    "face": (65, 185),
    "upper": (12, 195),
    "height": 30.769688183203307,
    "c": (24, 48),
    "phi": (20, 30),
    "unit_weight": 25,
}
LEVEL: Mapping[str, Any] = {
    "dips": ((45, 115), (45, 245)),
    "face": (60, 180),
    "upper": (0, 180),
    "height": 10,
    "c": 20,
    "phi": 30,
    "unit_weight": 26,
}
STEEP: Mapping[str, Any] = {**LEVEL, "dips": ((55, 130), (55, 230)), "face": (80, 180)}
GOODMAN_BRAY = (4, 8, 12, 16, 20, 24, 28, 32, 36, 40, 34, 28, 22, 16, 10, 4)


@dataclass(frozen=True)
class Case:
    """A design and its answer in 50 digits.

    Attributes
    ----------
    design : keyword arguments of `slopekit.wedge` where the kind is wedge, else a design as a mapping
    answer : computes the exact answer (some take half a second)
    shift : (3,) m, what the user's coordinates add to those of the exact corners
    """

    kind: str
    design: Mapping[str, Any]
    answer: Callable[[], Exact]
    shift: tuple[float, float, float] = (0.0, 0.0, 0.0)


def wedge(base: Mapping[str, Any] = LEVEL, shift: float = 0.0, **changes: Any) -> Case:
    """A wedge, by the words of `slopekit.wedge`; moved by `shift` to the east, south and (a tenth of it) up."""
    numbers = {**base, **changes}
    moved = (shift, -shift, shift / 10.0)
    design = {**numbers, "origin": moved} if shift else numbers
    if isinstance(numbers.get("seismic"), tuple):
        design = {**design, "seismic": "{!r}@{!r}".format(*numbers["seismic"])}
    return Case("wedge", design, lambda: exact.wedge(**numbers), moved)


def plane(
    face: float = 60.0,
    dip: float = 35.0,
    height: float = 12.0,
    c: float = 25.0,
    phi: float = 37.0,
    unit_weight: float = 26.0,
    upper: float = 0.0,
    crack: float | None = None,
    water: float = 0.0,
    pressure: float | None = None,
    seismic: float = 0.0,
    force: tuple[float, float] | None = None,
    stiffness: float | None = None,
    criterion: str = "limit",
) -> Case:
    """Plane failure (the template's numbers); force as (x out of the slope, z) kN, stiffness as k_n/k_t."""
    strength: dict[str, Any] = {"c": c, "phi": phi}
    if stiffness:
        strength["stiffness"] = {"normal": 1e7, "shear": 1e7 / stiffness}
    design: dict[str, Any] = {
        "slopekit": 1,
        "kind": "plane",
        "strength": {"bedding": strength},
        "rock": {"unit_weight": unit_weight},
        "slope": {"face": [face, 180], "height": height, "upper": [upper, 180]},
        "joints": {"J1": {"plane": [dip, 180], "strength": "bedding"}},
        "analysis": {"criterion": criterion},
    }
    if crack is not None:
        design["crack"] = {"depth": crack, "water": water}
    if pressure is not None:
        design["water"] = {"pressures": {"J1": pressure}}
    loads: dict[str, Any] = {"seismic": seismic} if seismic else {}
    if force:
        loads["forces"] = [[0.0, -force[0], force[1]]]
    design |= {"loads": loads} if loads else {}

    def answer() -> Exact:
        return exact.plane_failure(
            face,
            dip,
            height,
            c,
            phi,
            unit_weight,
            upper=upper,
            crack_depth=crack,
            water_depth=water,
            pressure=pressure,
            seismic=seismic,
            forces=[force] if force else (),
        )

    return Case("plane", design, answer)


def footing(
    load: float = 2000.0,
    dip: float = 40.0,
    length: float = 8.0,
    c: float = 120.0,
    phi: float = 25.0,
    unit_weight: float = 24.0,
) -> Case:
    """A footing above a weak plane (the template's numbers, the load over the middle)."""
    design = {
        "slopekit": 1,
        "kind": "footing",
        "footing": {"load": load, "at": "middle"},
        "weak_plane": {"dip": dip, "length": length, "strength": "seam"},
        "strength": {"seam": {"c": c, "phi": phi}},
        "rock": {"unit_weight": unit_weight},
    }
    return Case("footing", design, lambda: exact.footing(load, dip, length, c, phi, unit_weight))


def sphere(radius: float = 10.0, c: float = 20.0, shift: float = 0.0) -> Case:
    """The template's sphere with φ = 0, a 2:1 slope at half its radius, moved by `shift` in x and z."""
    dip, distance = math.degrees(math.atan(0.5)), radius / 2.0
    s, k = math.sin(math.radians(dip)), math.cos(math.radians(dip))
    ends = [
        (distance * s * -1.0 + t * k, -distance * k - t * s) for t in (3.0 * radius, -3.0 * radius)
    ]
    design = {
        "slopekit": 1,
        "kind": "surface",
        "strength": {"clay": {"c": c, "phi": 0}},
        "rock": {"unit_weight": 20.0},
        "slope": {"profile": [[x + shift, z + shift] for x, z in ends]},
        "slip": {"shape": "sphere", "centre": [shift, 0.0, shift], "radius": radius},
    }
    return Case(
        "surface", design, lambda: exact.sphere_without_friction(radius, distance, dip, c, 20.0)
    )


def turned(points: Sequence[Sequence[float]], degrees: float) -> list[list[float]]:
    """Points (x, z) turned up by an angle about the origin: a level scene becomes one that dips toward -x."""
    k, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return [[x * k - z * s, x * s + z * k] for x, z in points]


def stack(
    wide: float = 4.0,
    high: float = 1.0,
    dip: float = 20.0,
    c: float = 0.0,
    phi: float = 35.0,
    many: int = 1,
    size: float = 1.0,
    shift: float = 0.0,
    pressure: float = 0.0,
) -> Case:
    """Rectangles on top of each other on an incline, `size` times as large as given, moved by `shift` in x and z."""
    left, right = -0.5 * wide, 1.5 * wide
    outlines = {"base": [[left, -wide], [right, -wide], [right, 0.0], [left, 0.0]]}
    for k in range(many):
        outlines[f"B{k}"] = [
            [0.0, k * high],
            [wide, k * high],
            [wide, (k + 1) * high],
            [0.0, (k + 1) * high],
        ]
    blocks: dict[str, dict[str, Any]] = {
        name: {"polygon": [[size * x + shift, size * z + shift] for x, z in turned(outline, dip)]}
        for name, outline in outlines.items()
    }
    blocks["base"]["fixed"] = True
    design: dict[str, Any] = {
        "slopekit": 1,
        "kind": "blocks",
        "blocks": blocks,
        "strength": {"joint": {"c": c, "phi": phi}},
        "rock": {"unit_weight": 25.0},
    }
    if pressure:
        design["water"] = {"pressures": {"B0/base": pressure}}
    return Case(
        "blocks",
        design,
        lambda: exact.block_on_incline(
            wide * size, high * size, dip, c, phi, 25.0, pressure=pressure, many=many
        ),
    )


def columns(
    phi: float = 38.15,
    size: float = 1.0,
    width: float = 10.0,
    heights: Sequence[float] = GOODMAN_BRAY,
) -> Case:
    """Goodman & Bray's columns (base dip 30°, step 1 m), `size` times as large."""
    tall = [size * height for height in heights]
    design = {
        "slopekit": 1,
        "kind": "topple",
        "strength": {"joint": {"c": 0, "phi": phi}},
        "rock": {"unit_weight": 25.0},
        "columns": {"dip": 60, "width": width * size, "base_step": size, "heights": tall},
    }
    return Case(
        "topple", design, lambda: exact.toppling_columns(tall, width * size, size, 30.0, phi, 25.0)
    )


def bench(
    size: float = 1.0,
    length: float = 30.0,
    spacings: Sequence[float] = (9.0, 12.0, 14.0),
    shift: float = 0.0,
    offsets: Sequence[float] = (0.0, 0.5, 0.0),
    phi: float = 35.0,
    more: Mapping[str, Any] | None = None,
) -> Case:
    """A bench whose key block slides on the set that dips 45° out of it: F = tan φ / tan 45°.

    Formula: without cohesion a block on one plane slides at tan φ / tan β whatever its shape (Hoek & Bray 1981, ch. 7).
    """
    planes = {"S1": [45, 170], "S2": [80, 350], "S3": [85, 80]}
    sets: dict[str, Any] = {
        name: {
            "plane": dips,
            "spacing": size * spacing,
            "offset": size * offset,
            "strength": "joint",
        }
        for (name, dips), spacing, offset in zip(planes.items(), spacings, offsets, strict=True)
    }
    design = {
        "slopekit": 1,
        "kind": "bench",
        "strength": {"joint": {"c": 0, "phi": phi}},
        "rock": {"unit_weight": 26.0},
        "slope": {
            "face": [70, 180],
            "height": 15.0 * size,
            "upper": [0, 180],
            "length": length * size,
            "origin": [shift, -shift, shift / 10.0],
        },
        "sets": sets | dict(more or {}),
        "cut": {"min_volume": 1e-4 * size**3},
        "analysis": {"smallest_block": 0},
    }
    return Case("bench", design, lambda: Exact("slides", exact.tangent(phi) / exact.tangent(45)))
