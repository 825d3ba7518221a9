"""Sections and boxes whose answer is known by hand: wedges in slots, chains of wedges, arches, boxes that twist.

The numbers come from statics written out here, not from slopekit.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import pytest

import slopekit as sk

Polygon = Sequence[tuple[float, float]]


def tangent(degrees: float) -> float:
    return math.tan(math.radians(degrees))


def section(moving: Mapping[str, Polygon], fixed: Mapping[str, Polygon], phi: float, **more: Any) -> dict[str, Any]:
    """A design of blocks 1 m thick, 25 kN/m³, with one friction angle unless `more` says otherwise."""
    blocks: dict[str, Any] = {name: {"polygon": [list(at) for at in polygon]} for name, polygon in moving.items()}
    blocks |= {name: {"polygon": [list(at) for at in polygon], "fixed": True} for name, polygon in fixed.items()}
    design: dict[str, Any] = {"slopekit": 1, "kind": "blocks", "blocks": blocks, "rock": {"unit_weight": 25}}
    return design | {"strength": {"joint": {"c": 0, "phi": phi}}} | more


def pushed(k: float, toward: float = 90) -> dict[str, Any]:
    """Loads of an earthquake."""
    return {"seismic": {"k": k, "toward": toward}}


# -- a wedge between two walls ----------------------------------------------------------------------------------------


def slot(taper: float, phi: float, **more: Any) -> dict[str, Any]:
    """A block 1 m high and 1 m wide below, between walls that lean back by `taper` degrees."""
    lean = tangent(taper)
    left = [(-3.0, 0.0), (0.0, 0.0), (-lean, 1.0), (-3.0, 1.0)]
    right = [(1.0, 0.0), (4.0, 0.0), (4.0, 1.0), (1.0 + lean, 1.0)]
    block = [(0.0, 0.0), (1.0, 0.0), (1.0 + lean, 1.0), (-lean, 1.0)]
    return section({"B": block}, {"left": left, "right": right}, phi, **more)


@pytest.mark.parametrize("phi", [0, 30])
@pytest.mark.parametrize("k", [0.0, 0.1])
@pytest.mark.parametrize("taper", [0.1, 1.0, 5.0])
def test_a_wedge_in_a_slot_stands_without_friction(taper, k, phi) -> None:
    """N1 + N2 = W / sin α and N1 - N2 = k W / cos α: both press while k tan α < 1, however flat α is."""
    found = sk.run(slot(taper, phi, loads=pushed(k)))
    assert found.status == "no_driving_force"
    assert found.fos.limit is None


@pytest.mark.parametrize("taper", [0.0, -0.1, -5.0])
def test_a_block_in_a_slot_that_widens_downward_falls(taper) -> None:
    """Nothing presses it against the walls, which is all that friction could live on; locked-in forces are none."""
    assert sk.run(slot(taper, 30)).status == "falls"
