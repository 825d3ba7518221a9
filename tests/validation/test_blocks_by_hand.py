"""Sections and boxes whose answer is known by hand: wedges in slots, chains of wedges, arches, boxes that twist.

The numbers come from statics written out here, not from slopekit.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq, linprog

import slopekit as sk
from tests.hard_cases.cases import stack as incline_block

Polygon = Sequence[tuple[float, float]]


def tangent(degrees: float) -> float:
    return math.tan(math.radians(degrees))


def section(
    moving: Mapping[str, Polygon], fixed: Mapping[str, Polygon], phi: float, **more: Any
) -> dict[str, Any]:
    """A design of blocks 1 m thick, 25 kN/m³, with one friction angle unless `more` says otherwise."""
    blocks: dict[str, Any] = {
        name: {"polygon": [list(at) for at in polygon]} for name, polygon in moving.items()
    }
    blocks |= {
        name: {"polygon": [list(at) for at in polygon], "fixed": True}
        for name, polygon in fixed.items()
    }
    design: dict[str, Any] = {
        "slopekit": 1,
        "kind": "blocks",
        "blocks": blocks,
        "rock": {"unit_weight": 25},
    }
    return design | {"strength": {"joint": {"c": 0, "phi": phi}}} | more


def pushed(k: float, toward: float = 90) -> dict[str, Any]:
    """Loads of an earthquake."""
    return {"seismic": {"k": k, "toward": toward}}


def reduced(phi: float, factor: float) -> float:
    """The friction angle (radians) of a strength divided by a factor."""
    return math.atan(tangent(phi) / factor)


def factor_at(missing: Callable[[float], float]) -> float:
    """The factor at which nothing is missing."""
    return float(brentq(missing, 0.8, 20.0, xtol=1e-13))


def turned(polygon: Polygon, dip: float) -> list[tuple[float, float]]:
    """Anticlockwise about the origin."""
    c, s = math.cos(math.radians(dip)), math.sin(math.radians(dip))
    return [(c * x - s * z, s * x + c * z) for x, z in polygon]


def box(left: float, right: float, low: float, high: float) -> Polygon:
    return [(left, low), (right, low), (right, high), (left, high)]


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
    assert "W419" not in {notice.code for notice in found.warnings}


def test_a_table_in_front_of_a_face_is_no_reservoir() -> None:
    """The same table with nothing behind the block: γ_w h² / 2 = 122.6 kN would press there, and does not; W419."""
    found = sk.run(dam())
    assert found.status == "no_driving_force"
    assert [
        notice.message
        for notice in found.warnings
        if notice.code == "W419" and "122.6 kN" in notice.message
    ]


def test_blocks_under_water_slide_at_the_factor_of_dry_ones() -> None:
    """A stack of three, wholly below a pond: all its forces are those of its buoyant weight, F = tan φ / tan β."""
    moving = {f"B{n}": turned(box(0, 4, n, n + 1), 20) for n in range(3)}
    water = {"mode": "table", "pond": 15}
    found = sk.run(section(moving, {"base": turned(box(-10, 14, -1, 0), 20)}, 30, water=water))
    assert found.fos.limit == pytest.approx(tangent(30) / tangent(20), rel=1e-9)


# -- wedges that slide on a bent base, by the polygon of their forces -------------------------------------------------


@pytest.mark.parametrize(
    ("lengths", "dips", "heights", "phi", "sides", "k"),
    [
        ((8, 8), (10, 50), (3, 5, 0), 30, 30, 0.0),
        ((6, 7), (-8, 55), (2, 6, 0), 35, 0, 0.0),
        ((8, 6, 8), (-10, 25, 55), (2, 6, 5, 0), 28, 15, 0.1),
        ((5, 5, 5, 5), (0, 15, 35, 60), (2, 4, 4, 3, 0), 30, 20, 0.05),
    ],
)
def test_a_chain_of_wedges(lengths, dips, heights, phi, sides, k) -> None:
    """Upright joints between two to four wedges, all slipping: the forces on each meet its base and sides at φ.

    Square to the resultant on the base, from the highest down, α the dip and θ the angle of friction of the sides:
    P cos(α - φ - θ) = P_above cos(α - φ - θ) + W (sin(α - φ) + k cos(α - φ)), and nothing holds the lowest.
    """
    ends, weights, moving = [(0.0, 0.0)], [], {}
    for length, dip in zip(lengths, dips, strict=True):
        along = math.radians(dip)
        ends.append(
            (ends[-1][0] + length * math.cos(along), ends[-1][1] + length * math.sin(along))
        )
    for n, ((x, z), (beyond, above)) in enumerate(pairwise(ends)):
        top = [(beyond, above + heights[n + 1])] if heights[n + 1] else []
        moving[f"W{n}"] = [(x, z), (beyond, above), *top, (x, z + heights[n])]
        weights.append(25.0 * 0.5 * (heights[n] + heights[n + 1]) * (beyond - x))

    def missing(factor: float) -> float:
        push, friction, side = 0.0, reduced(phi, factor), reduced(sides, factor)
        for weight, dip in zip(weights[::-1], dips[::-1], strict=True):
            flat = math.radians(dip) - friction
            push += weight * (math.sin(flat) + k * math.cos(flat)) / math.cos(flat - side)
        return push

    below = [
        *ends,
        (ends[-1][0] + 3, ends[-1][1]),
        (ends[-1][0] + 3, -5.0),
        (-3.0, -5.0),
        (-3.0, 0.0),
    ]
    names = [f"W{n}/W{n + 1}" for n in range(len(lengths) - 1)]
    strength = {"base": {"c": 0, "phi": phi}} | (
        {} if sides == phi else {"side": {"c": 0, "phi": sides}}
    )
    more: dict[str, Any] = {"strength": strength, "loads": pushed(k, 270)}
    if sides != phi:
        more["interfaces"] = {"default": "base"} | dict.fromkeys(names, "side")
    found = sk.run(section(moving, {"rock": below}, phi, **more))
    assert found.status == "slides"
    assert found.fos.limit == pytest.approx(factor_at(missing), rel=1e-9)


@pytest.mark.parametrize(("lean", "push"), [(5, 60), (10, 80), (0, 60), (-5, 60)])
def test_a_keystone_held_by_a_jack(lean, push) -> None:
    """It widens downward by `lean` on either side; the forces there are H tan(φ - α) upward: F = tan φ / tan(α + ω).

    tan ω = W / 2H: a jack pushes with H against a block that slides on a smooth floor and holds the keystone.
    """
    narrower = tangent(lean)
    key = [(0.0, 0.0), (1.0, 0.0), (1.0 - narrower, 1.0), (narrower, 1.0)]
    jack = [(1.0, 0.0), (4.0, 0.0), (4.0, 1.0), (1.0 - narrower, 1.0)]
    wall = [(-3.0, 0.0), (0.0, 0.0), (narrower, 1.0), (-3.0, 1.0)]
    force = {"force": [-push, 0, 0], "block": "jack", "at": [4, 0, 0.5]}
    design = section({"key": key, "jack": jack}, {"wall": wall, "floor": box(1.5, 6, -1, 0)}, 30)
    design |= {
        "strength": {"joint": {"c": 0, "phi": 30}, "smooth": {"c": 0, "phi": 0}},
        "loads": {"forces": [force]},
    }
    found = sk.run(design | {"interfaces": {"default": "joint", "jack/floor": "smooth"}})
    half = 0.5 * 25.0 * (1.0 - narrower)
    assert found.fos.limit == pytest.approx(
        tangent(30) / math.tan(math.radians(lean) + math.atan(half / push)), rel=1e-9
    )


def test_a_wedge_that_drives_two_blocks_apart() -> None:
    """Each side gets (W/2) / tan(α + φ) outward and W/2 downward, and slides on its base at φ_b; all divided by F."""
    lean = tangent(15)
    wedge = [(0.0, 0.0), (1.0, 0.0), (1.0 + lean, 1.0), (-lean, 1.0)]
    left = [(-2.0, -1.0), (0.0, -1.0), (0.0, 0.0), (-lean, 1.0), (-2.0, 1.0)]
    right = [(1.0 - x, z) for x, z in left]
    design = section(
        {"wedge": wedge, "left": left, "right": right}, {"floor": box(-5, 6, -2, -1)}, 15
    )
    design |= {"strength": {"joint": {"c": 0, "phi": 15}, "floor": {"c": 0, "phi": 20}}}
    found = sk.run(
        design | {"interfaces": {"default": "joint", "left/floor": "floor", "right/floor": "floor"}}
    )
    half, side = 0.5 * 25.0 * (1.0 + lean), 25.0 * (4.0 - 0.5 * lean)

    def missing(factor: float) -> float:
        out = half / math.tan(math.radians(15) + reduced(15, factor))
        return out - (side + half) * tangent(20) / factor

    assert found.fos.limit == pytest.approx(factor_at(missing), rel=1e-9)


@pytest.mark.parametrize(("capacity", "together"), [(10, False), (20, False), (400, True)])
def test_two_blocks_on_an_incline_tied_by_a_rod(capacity, together) -> None:
    """A (100 kN, φ 15°) would slide from B (200 kN, φ 38°): alone with the rod drawn, or both, whichever is lower.

    A: W sin β = (W cos β tan φ + capacity) / F. Both: Σ W cos β tan φ / (Σ W sin β).
    """
    dip = 30.0
    moving = {"A": turned(box(0, 4, 0, 1), dip), "B": turned(box(6, 14, 0, 1), dip)}
    head = turned([(2.0, 0.5)], dip)[0]
    rod = {
        "force": capacity,
        "toward": f"090/{-dip}",
        "block": "A",
        "head": [head[0], 0, head[1]],
        "length": 7,
    }
    design = section(moving, {"base": turned(box(-5, 20, -1, 0), dip)}, 38)
    design |= {"strength": {"low": {"c": 0, "phi": 15}, "high": {"c": 0, "phi": 38}}}
    design |= {
        "interfaces": {"default": "high", "A/base": "low"},
        "support": {"bolts": [rod | {"acts": "passive"}]},
    }
    drive, press = math.sin(math.radians(dip)), math.cos(math.radians(dip))
    alone = (100.0 * press * tangent(15) + capacity) / (100.0 * drive)
    both = (100.0 * press * tangent(15) + 200.0 * press * tangent(38)) / (300.0 * drive)
    assert (both < alone) == together
    assert sk.run(design).fos.limit == pytest.approx(min(alone, both), rel=1e-6)


# -- arches: the line of thrust ---------------------------------------------------------------------------------------


class Arch:
    """A circular arch of equal voussoirs on radial joints, its middle line at radius 10 m, on rock at either end."""

    def __init__(self, thickness: float, voussoirs: int, embrace: float) -> None:
        self.inner, self.outer = 10.0 - 5.0 * thickness, 10.0 + 5.0 * thickness
        self.angles = np.radians(90.0 + embrace * (0.5 - np.arange(voussoirs + 1) / voussoirs))

    def joint(self, n: int) -> tuple[np.ndarray, np.ndarray]:
        """The ends of a joint, the inner one first."""
        along = np.array([math.cos(self.angles[n]), math.sin(self.angles[n])])
        return self.inner * along, self.outer * along

    def design(self, phi: float, **more: Any) -> dict[str, Any]:
        """For slopekit."""
        corners = [self.joint(n) for n in range(len(self.angles))]
        moving = {
            f"V{n}": [tuple(at) for at in (low[0], low[1], high[1], high[0])]
            for n, (low, high) in enumerate(pairwise(corners))
        }
        fixed = {}
        for name, (inside, outside), way in (
            ("left", corners[0], 1.0),
            ("right", corners[-1], -1.0),
        ):
            out = way * 2.0 * np.array([inside[1], -inside[0]]) / self.inner * -1.0
            fixed[name] = [tuple(at) for at in (inside, outside, outside + out, inside + out)]
        return section(moving, fixed, phi, **more)

    def rows(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """N at the inner and outer end and T of each joint: matrix (3 j, 3) of what the first carries; W; k W."""
        step = abs(float(self.angles[1] - self.angles[0]))
        area = 0.5 * (self.outer**2 - self.inner**2) * math.sin(step)
        low, high = self.joint(0), self.joint(1)
        corners = np.array([low[0], low[1], high[1], high[0]])
        x, z = corners.T
        cross = x * np.roll(z, -1) - np.roll(x, -1) * z
        radius = float(
            np.hypot(
                *(
                    ((corners + np.roll(corners, -1, 0)) * cross[:, None]).sum(0)
                    / (3.0 * cross.sum())
                )
            )
        )
        matrix, dead, live = [], [], []
        force, still, shaken = (
            np.eye(3),
            np.zeros(3),
            np.zeros(3),
        )  # (x, z, moment about the origin) on what follows
        for n, angle in enumerate(self.angles):
            if n:
                middle = 0.5 * (self.angles[n - 1] + angle)
                at = radius * np.array([math.cos(middle), math.sin(middle)])
                still = still + 25.0 * area * np.array([0.0, -1.0, -at[0]])
                shaken = shaken + 25.0 * area * np.array([1.0, 0.0, -at[1]])
            on = np.array([math.sin(angle), -math.cos(angle)])  # the way on, through the joint
            up = np.array([math.cos(angle), math.sin(angle)])
            size = self.outer - self.inner
            to_normals = (
                np.array(
                    [[*(self.outer * on), 1.0], [*(-self.inner * on), -1.0], [*(size * up), 0.0]]
                )
                / size
            )
            matrix.append(to_normals @ force)
            dead.append(to_normals @ still)
            live.append(to_normals @ shaken)
        return np.concatenate(matrix), np.concatenate(dead), np.concatenate(live)

    def best(self, tan_friction: float, shakes: bool) -> float | None:
        """The largest k with a line of thrust in the arch, or 0 without shaking; None where there is none."""
        matrix, dead, live = self.rows()
        if not shakes:
            live = 0.0 * live
        inner, outer, shear = (slice(part, None, 3) for part in range(3))
        rooms, rights = [], []
        for room in (
            (1.0, 0.0, 0.0),
            (0.0, 1.0, 0.0),
            (tan_friction, tan_friction, 1.0),
            (tan_friction, tan_friction, -1.0),
        ):
            both = np.column_stack([matrix, live])
            rooms.append(
                -sum(part * both[at] for part, at in zip(room, (inner, outer, shear), strict=True))
            )
            rights.append(
                sum(part * dead[at] for part, at in zip(room, (inner, outer, shear), strict=True))
            )
        found = linprog(
            [0, 0, 0, -1],
            np.concatenate(rooms),
            np.concatenate(rights),
            bounds=[(None, None)] * 3 + [(0, 1)],
        )
        return float(found.x[3]) if found.status == 0 else None


@pytest.mark.slow
@pytest.mark.parametrize(
    ("thickness", "voussoirs", "embrace", "phi"),
    [(0.12, 27, 180, 40), (0.07, 12, 157.5, 40), (0.045, 12, 140, 40)],
)
def test_the_friction_that_an_arch_needs(thickness, voussoirs, embrace, phi) -> None:
    """A line of thrust within the joints, no steeper to them than φ: a linear program in three unknowns, bisected."""
    arch, low, high = Arch(thickness, voussoirs, embrace), 0.0, tangent(80)
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if arch.best(middle, False) is not None else (middle, high)
    assert sk.run(arch.design(phi)).fos.limit == pytest.approx(tangent(phi) / high, rel=1e-6)


@pytest.mark.parametrize(
    ("voussoirs", "embrace", "least"),
    [(27, 180, 0.10676), (12, 157.5, 0.06382), (40, 120, 0.02282)],
)
def test_the_least_thickness_of_an_arch(voussoirs, embrace, least) -> None:
    """Just above it a line of thrust fits in, and the arch stands; just below it no friction helps.

    For ever more voussoirs the semicircle needs Milankovitch's t/R = 0.1075.
    """
    thin, thick = Arch(0.998 * least, voussoirs, embrace), Arch(1.002 * least, voussoirs, embrace)
    assert thin.best(10.0, False) is None
    assert thick.best(10.0, False) is not None
    assert sk.run(thin.design(60)).status == "topples"
    assert (sk.run(thick.design(60)).fos.limit or 0.0) > 1.0


def test_the_earthquake_that_an_arch_carries() -> None:
    """Oppenheim (1992): seven voussoirs over 157.5°, t/R 0.15: 0.37 g; the line of thrust gives 0.3736."""
    arch = Arch(0.15, 7, 157.5)
    by_thrust = arch.best(tangent(45), True)
    assert by_thrust == pytest.approx(0.37, abs=0.005)
    found = sk.solve(sk.load(arch.design(45, loads=pushed(0.01))), "loads.seismic.k", fos=1.0)
    assert found.answer is not None
    assert found.answer.value == pytest.approx(by_thrust, rel=1e-6)


# -- a box that slides and turns on its base --------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(("wide", "deep", "off"), [(2.0, 2.0, 0.9), (4.0, 1.0, 1.5)])
def test_a_box_pushed_off_its_middle(tmp_path: Path, wide, deep, off) -> None:
    """A push along y at the level of the base, `off` from its middle: even pressure, slip about a point on the x axis.

    Its place balances the moment, its friction the push: ∫ μ p (x + s)/r and ∫ μ p ((x + s) x + y²)/r by Gauss.
    """
    push, weight = 10.0, 25.0 * wide * deep * 0.5
    nodes, gauss = np.polynomial.legendre.leggauss(200)
    x, y = np.meshgrid(0.5 * wide * nodes, 0.5 * deep * nodes, indexing="ij")
    strength = np.outer(gauss, gauss) / 4.0 * weight * tangent(30)

    def held(s: float) -> tuple[float, float]:
        r = np.hypot(x + s, y)
        return float((strength * (x + s) / r).sum()), float(
            (strength * ((x + s) * x + y * y) / r).sum()
        )

    place = float(brentq(lambda s: held(s)[1] - off * held(s)[0], 1e-6, 1e3))
    blocks: dict[str, Any] = {}
    for name, sides in {
        "base": (5.0, 5.0, -1.0, 0.0),
        "box": (0.5 * wide, 0.5 * deep, 0.0, 0.5),
    }.items():
        corners = [
            (i * sides[0], j * sides[1], z) for z in sides[2:] for j in (-1, 1) for i in (-1, 1)
        ]
        quads = ["0 2 3 1", "4 5 7 6", "0 1 5 4", "2 6 7 3", "0 4 6 2", "1 3 7 5"]
        lines = [
            "OFF",
            "8 6 0",
            *(f"{a} {b} {c}" for a, b, c in corners),
            *(f"4 {quad}" for quad in quads),
        ]
        (tmp_path / f"{name}.off").write_text("\n".join(lines) + "\n", "utf-8")
        blocks[name] = {"mesh": str(tmp_path / f"{name}.off")} | (
            {"fixed": True} if name == "base" else {}
        )
    force = {"force": [0, push, 0], "block": "box", "at": [off, 0, 0]}
    design = {"slopekit": 1, "kind": "blocks", "blocks": blocks, "rock": {"unit_weight": 25}}
    found = sk.run(
        design | {"strength": {"joint": {"c": 0, "phi": 30}}, "loads": {"forces": [force]}}
    )
    assert found.fos.limit == pytest.approx(held(place)[0] / push, rel=1e-3)


# -- blocks that lean out over each other -----------------------------------------------------------------------------


def stack(part: float) -> dict[str, Any]:
    """Six blocks 2 m long, each out by a part of what it may be: 2 m / 2n for n blocks above and with it."""
    out, ends = 0.0, [0.0]
    for n in range(1, 6):
        out += part * 2.0 / (2 * n)
        ends.append(out)
    moving = {
        f"B{n}": box(out - end, out - end + 2.0, 0.5 * (5 - n), 0.5 * (6 - n))
        for n, end in enumerate(ends)
    }
    return section(moving, {"base": box(-3, 2, -1, 0)}, 35, loads=pushed(0.0))


@pytest.mark.slow
@pytest.mark.parametrize("part", [0.9, 0.999])
def test_a_stack_that_leans_out_stands(part) -> None:
    """The harmonic series: it tips at k where the weight above a joint, 1/4 m or more high, reaches the edge.

    The n highest lie (1 - part) m within it and are n/2 m high: k n/4 = 1 - part, first over all six but the lowest.
    """
    assert sk.run(stack(part)).status == "no_driving_force"
    found = sk.solve(sk.load(stack(part)), "loads.seismic.k", fos=1.0)
    assert found.answer is not None
    assert found.answer.value == pytest.approx((1.0 - part) / 1.25, rel=1e-6)


def test_a_stack_that_leans_out_too_far_topples() -> None:
    """At any friction, and a solve on that says so."""
    assert sk.run(stack(1.001)).status == "topples"
    found = sk.solve(sk.load(stack(1.001)), "strength.joint.phi", fos=1.5)
    assert found.answer is None
    assert found.reason.code == "E316"
    assert "slopekit run says how" in found.reason.advice


@pytest.mark.slow
@pytest.mark.parametrize(("wide", "pressure"), [(1.0, 0.0), (0.8, 0.0), (4.0, 19.0), (4.0, 21.0)])
def test_the_pressed_part_of_a_base_has_the_cohesion(wide, pressure) -> None:
    """A block 1 m high on 20°: its base is pressed on 3 (1/2 - e / b) of it, e = M / N; node pairs give 0.4 %."""
    dip, weight, cohesion = math.radians(20.0), 25.0 * wide, 3.0
    presses, slides = weight * math.cos(dip) - pressure * wide, weight * math.sin(dip)
    pressed = 3.0 * (0.5 - 0.5 * slides / presses / wide)
    assert 0.2 < pressed < 0.96
    exact = (cohesion * pressed * wide + presses * math.tan(math.radians(35.0))) / slides
    found = sk.run(incline_block(wide, c=cohesion, pressure=pressure).design)
    assert found.fos.limit == pytest.approx(exact, rel=4e-3)
    assert "W307" in [notice.code for notice in found.warnings]
