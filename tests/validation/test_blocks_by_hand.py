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


# -- water that a table does not press with ---------------------------------------------------------------------------


def dam(**blocks: Polygon) -> dict[str, Any]:
    """A block of 5 m x 6 m on level rock, and a table 5 m above its heel that falls to its toe."""
    table = {"mode": "table", "points": [[-10, 5], [0, 5], [5, 0], [15, 0]]}
    fixed = {"base": [(-10.0, -2.0), (15.0, -2.0), (15.0, 0.0), (-10.0, 0.0)]} | blocks
    return section({"B": [(0.0, 0.0), (5.0, 0.0), (5.0, 6.0), (0.0, 6.0)]}, fixed, 35, water=table)


def test_water_behind_a_block_drives_it() -> None:
    """Held in by a smooth wall of rock: F = (W - γ_w h b / 2) tan φ / (γ_w h² / 2)."""
    design = dam(back=[(-8.0, 0.0), (0.0, 0.0), (0.0, 6.0), (-8.0, 6.0)])
    design |= {"strength": {"joint": {"c": 0, "phi": 35}, "smooth": {"c": 0, "phi": 0}}}
    found = sk.run(design | {"interfaces": {"default": "joint", "B/back": "smooth"}})
    by_hand = (25.0 * 30.0 - 0.5 * 9.81 * 5.0 * 5.0) * tangent(35) / (0.5 * 9.81 * 5.0**2)
    assert found.fos.limit == pytest.approx(by_hand, rel=1e-9)
    assert "W499" not in {notice.code for notice in found.warnings}


def test_a_table_in_front_of_a_face_is_no_reservoir() -> None:
    """The same table with nothing behind the block: γ_w h² / 2 = 122.6 kN would press there, and does not; W499."""
    found = sk.run(dam())
    assert found.status == "no_driving_force"
    assert [notice.message for notice in found.warnings if notice.code == "W499" and "122.6 kN" in notice.message]
