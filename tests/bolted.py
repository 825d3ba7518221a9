"""Designs with bolts for several tests."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

import slopekit as sk
from slopekit.core.arrays import Bools, Floats
from slopekit.core.errors import SlopekitError
from slopekit.design.reading.files import with_values
from slopekit.design.templates import path_of
from slopekit.kinds import kind_of
from slopekit.kinds.single_block.held_bolts import head_offset, holding_bolts
from slopekit.result import Result

#: A head on the face, in the user's coordinates, that passes through the wedge.
WEDGE: dict[str, Any] = {
    "slopekit": 1,
    "kind": "wedge",
    "title": "Bolted road cut",
    "slope": {"face": "65/180", "upper": "10/180", "height": 14},
    "joints": {"J1": {"plane": "50/120"}, "J2": {"plane": "48/240"}},
    "strength": {"rock": {"c": 0, "phi": 28}},
    "rock": {"density": 2600},
}
_SLOPE = 1.0 / math.tan(math.radians(65.0))


def bolt(
    east: float, up: float, force: float = 100.0, acts: str = "passive", length: float | None = 20.0
) -> dict:
    """A bolt with its head on the face of `WEDGE`."""
    given = {"force": force, "toward": "000/5", "acts": acts, "head": [east, up * _SLOPE, up]}
    return given if length is None else given | {"length": length}


def three() -> list[dict[str, Any]]:
    """An active bolt, a passive one without a length, and one without a head."""
    return [
        bolt(0.0, 5.0, 300.0, "active"),
        bolt(-1.0, 8.0, length=None),
        {"force": 50, "toward": "010/10"},
    ]


def grid(rows: int = 6, columns: int = 8) -> list[dict[str, Any]]:
    """Rows and columns on the upper part of the face; many of them active, which is quicker to analyse."""
    how = {"force": 10.0, "acts": "active"} if rows * columns > 100 else {}
    return [
        bolt(-4.0 + 8.0 * k / (columns - 1), 9.5 + 3.5 * row / (rows - 1), **how)
        for row in range(rows)
        for k in range(columns)
    ]


@cache
def bolted(name: str) -> Result:
    """A wedge with three bolts, or with a pattern of 6 x 8, or of 10 x 20; a plane; a bench of many blocks."""
    if name == "plane":
        bolts = [
            {
                "force": 30,
                "toward": "000/-5",
                "acts": "passive",
                "head": [0, z / math.tan(math.radians(60)), z],
                "length": 9,
            }
            for z in (1.0, 3.0, 5.0)
        ]
        return sk.run(path_of("plane"), set={"support": {"bolts": bolts}})
    if name == "bench":
        heads = [
            (x, z / math.tan(math.radians(70)) + 0.02, z)
            for z in (4.0, 6.0)
            for x in (-3.0, 0.0, 3.0)
        ]
        bolts = [
            {
                "force": 150,
                "toward": "000/5",
                "acts": "active" if z < 5 else "passive",
                "head": [x, y, z],
                "length": 9,
            }
            for x, y, z in heads
        ]
        return sk.run(path_of("bench"), set={"support": {"bolts": bolts}})
    bolts = three() if name == "three" else grid() if name == "pattern" else grid(10, 20)
    return sk.run(WEDGE | {"support": {"bolts": bolts}})


def as_laid_out(design: Any) -> Floats:
    """How far (m) before the face of the design the head of each bolt (b,) stands."""
    return head_offset(kind_of(design).on_arrays.bounds(design), design.bolts)


def standing(design: Any, before: Floats) -> Any:
    """A sample, read by itself, with the bolts that hold its block, their heads as far before its face as laid out."""
    holds, moved = holding_bolts(kind_of(design).on_arrays.bounds(design), design.bolts, before)
    bolts = [
        bolt
        if bolt.head_m is None
        else replace(bolt, head_m=tuple(np.array(bolt.head_m) + by * bolt.toward.vector()))
        for bolt, by in zip(design.bolts, moved[:, 0], strict=True)
    ]
    return replace(
        design, bolts=tuple(bolt for bolt, own in zip(bolts, holds[:, 0], strict=True) if own)
    )


def holding(design: Any, samples: Sequence[Mapping[str, object]], before: Floats) -> Bools:
    """Which bolts (b, n) hold the block of each sample, read by itself; all where no design can have its values."""
    holds = np.ones((len(design.bolts), len(samples)), dtype=bool)
    for row, values in enumerate(samples):
        try:
            sample = with_values(design, values)
        except SlopekitError:
            continue
        holds[:, row] = holding_bolts(
            kind_of(design).on_arrays.bounds(sample), sample.bolts, before
        )[0][:, 0]
    return holds
