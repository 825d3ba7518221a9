"""`solve` on a bolt: the anchor of a toppling column and one from the crest of a plane failure, against the books.

Both stood in `support` as programs of their own; a bolt in the design and its force solved for say the same.
"""

import math

import pytest

import slopekit as sk
from slopekit.closed_form.toppling import ColumnSlope, toe_force_required

HEIGHTS = [4, 8, 12, 16, 20, 24, 28, 32, 36, 40, 34, 28, 22, 16, 10, 4]
GOODMAN_BRAY = {
    "slopekit": 1,
    "kind": "topple",
    "strength": {"joint": {"c": 0, "phi": 33.0239}},
    "rock": {"unit_weight": 25},
    "columns": {"dip": 60, "width": 10, "base_step": 1, "heights": HEIGHTS},
}
#: a tall column behind a low one
THREE = {
    "slopekit": 1,
    "kind": "topple",
    "strength": {"joint": {"c": 0, "phi": 30}},
    "rock": {"unit_weight": 25},
    "columns": {"dip": 70, "width": 2, "base_step": 0.5, "heights": [3, 9, 5]},
}
FORCE = "support.bolts.0.force"


def columns_by_hand(column: int, plunge: float, height: float, factor: float) -> float:
    """The force on C1 or C2 of `THREE` (per metre), column by column: Goodman & Bray (1976), every case tried.

    C3 pushes C2 with P2, C2 pushes C1 with P1. C1 allows so much P1 before it slides or topples; C2 needs the force
    that leaves no more. Each is a straight line in the force.
    """
    dip, width, slope = math.radians(20.0), 2.0, math.tan(math.radians(30.0)) / factor
    down, off = (
        {y: 25.0 * width * y * turn(dip) for y in (3.0, 9.0, 5.0)} for turn in (math.sin, math.cos)
    )
    along, into = math.cos(dip + math.radians(plunge)), math.sin(dip + math.radians(plunge))
    locks = 1.0 - slope**2
    p2 = max(
        (down[5.0] * 5.0 - off[5.0] * width) / 2.0 / 5.0,
        (down[5.0] - off[5.0] * slope) / locks,
        0.0,
    )
    # C3 pushes C2 at its own top, 5.5 m above the base of C2; C2 pushes C1 at the top of that, 2.5 m above its own base
    tips_c2 = (down[9.0] * 9.0 - off[9.0] * width) / 2.0
    tipped = (p2 * (5.5 - width * slope) + tips_c2) / 2.5
    slid = p2 + (down[9.0] - off[9.0] * slope) / locks
    slide_1 = (down[3.0] - off[3.0] * slope) / locks
    tip_1 = (down[3.0] * 3.0 - off[3.0] * width) / 2.0
    if column == 1:
        p1 = max(tipped, slid, 0.0)
        slides = (p1 + slide_1) * locks / (along + into * slope)
        return max(slides, (p1 * (3.0 - width * slope) + tip_1) / (along * height), 0.0)
    most = min(-slide_1, -tip_1 / (3.0 - width * slope))
    assert most >= 0.0
    return max(
        (tipped - most) * 2.5 / (along * height),
        (slid - most) * locks / (along + into * slope),
        0.0,
    )


def bolt_on(design: dict, column: int, height: float, plunge: float) -> dict:
    """A design with an anchor on the outer side of a column, so high above its base."""
    columns = design["columns"]
    dip = math.radians(90.0 - columns["dip"])
    along, up = (column - 1) * columns["width"], (column - 1) * columns["base_step"] + height
    head = [
        along * math.cos(dip) - up * math.sin(dip),
        0.5,
        along * math.sin(dip) + up * math.cos(dip),
    ]
    bolt = {
        "force": 100,
        "toward": f"090/{plunge:g}",
        "acts": "active",
        "head": head,
        "block": f"C{column}",
    }
    return design | {"support": {"bolts": [bolt]}}


@pytest.mark.parametrize("plunge", [0.0, 12.0])
@pytest.mark.parametrize("factor", [1.0, 1.3])
def test_the_toe_force_solved_by_hand(factor, plunge) -> None:
    slope = ColumnSlope(
        [3, 9, 5], 2, 0.5, 20, 25, 30, toe_force_plunge_deg=plunge, toe_force_height_m=1.5
    )
    by_hand = columns_by_hand(1, plunge, 1.5, factor)
    assert toe_force_required(slope, factor) == pytest.approx(by_hand, rel=1e-9)


@pytest.mark.parametrize(("column", "height"), [(1, 1.5)])
def test_an_anchor_of_a_column_is_that_by_hand(column, height) -> None:
    """PRE-IE's contacts are those of the method."""
    expected = columns_by_hand(column, 0.0, height, 1.3)
    near = (0.8 * expected, 1.3 * expected)
    found = sk.solve(sk.load(bolt_on(THREE, column, height, 0.0)), FORCE, fos=1.3, within=near)
    assert found.answer.value == pytest.approx(expected, rel=1e-5)


def test_the_published_anchor_of_the_toe_block() -> None:
    """tan φ = 0.65: 2013 kN per metre on block 1, level (Goodman & Bray 1976; Wyllie & Mah 2004, §9.4.5)."""
    found = sk.solve(sk.load(bolt_on(GOODMAN_BRAY, 1, 2.0, 0.0)), f"{FORCE}=1000:4000", fos=1.0)
    assert found.answer.value == pytest.approx(2012.857, rel=1e-5)


WATER, ROCK = 9.81, 26.0
CRACKED = {
    "slopekit": 1,
    "kind": "plane",
    "slope": {"face": "60/180", "height": 12},
    "joints": {"J1": {"plane": "35/180"}},
    "strength": {"s": {"c": 25, "phi": 37}},
    "rock": {"unit_weight": ROCK},
    "crack": {"depth": 4.35, "water": 3.0},
}


def plane_by_hand(plunge: float, factor: float) -> float:
    """T per metre from Hoek & Bray's formula with an anchor (1981, ch. 7), its angle off the normal of the plane."""
    face, dip, friction, deep, wet = (
        math.radians(60.0),
        math.radians(35.0),
        math.tan(math.radians(37.0)),
        4.35,
        3.0,
    )
    area = (12.0 - deep) / math.sin(dip)
    weight = (
        0.5 * ROCK * 144.0 * ((1.0 - (deep / 12.0) ** 2) / math.tan(dip) - 1.0 / math.tan(face))
    )
    uplift, thrust = 0.5 * WATER * wet * area, 0.5 * WATER * wet**2
    off = math.pi / 2.0 - dip - math.radians(plunge)
    presses = weight * math.cos(dip) - uplift - thrust * math.sin(dip)
    drives = weight * math.sin(dip) + thrust * math.cos(dip)
    return (factor * drives - 25.0 * area - presses * friction) / (
        math.cos(off) * friction + factor * math.sin(off)
    )


@pytest.mark.slow
@pytest.mark.parametrize(("acts", "plunge"), [("active", 48.0), ("passive", 50.0)])
def test_an_anchor_from_the_crest_is_hoek_and_brays(acts, plunge) -> None:
    """A passive anchor pulls with its capacity divided by the factor."""
    head = [0.0, 12.0 / math.tan(math.radians(60.0)), 12.0]
    bolt = {"force": 100, "toward": f"000/{plunge:g}", "acts": acts, "head": head}
    expected = plane_by_hand(plunge, 1.5) * (1.5 if acts == "passive" else 1.0)
    near = (0.8 * expected, 1.3 * expected)
    found = sk.solve(sk.load(CRACKED | {"support": {"bolts": [bolt]}}), FORCE, fos=1.5, within=near)
    assert found.closed_form.roots[0].value == pytest.approx(expected, rel=1e-6)
    assert found.answer.value == pytest.approx(expected, rel=1e-5)
