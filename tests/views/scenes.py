"""Results of many blocks made by hand, for the sheet: numbers from the closed form, or made up where it has none."""

import math
from typing import Any

import numpy as np

import slopekit as sk
from slopekit.block_scene import Arrows, Contacts, NodePairState
from slopekit.closed_form.toppling import ColumnSlope, toppling_factor_of_safety, toppling_table
from slopekit.core.errors import Notice
from slopekit.design.templates import path_of
from slopekit.evidence import (
    Comparisons,
    Displacements,
    FactorsOfSafety,
    Forces,
    LimitState,
    ModelSize,
)
from slopekit.findings import AssemblyGeometry, Findings, GoverningInterface, Mechanism
from slopekit.kinds import kind_of
from slopekit.result import Result

NONE, NONE3, WHOLE = np.zeros(0), np.zeros((0, 3)), np.zeros(0, dtype=np.int64)
CHECKS = {"volume_error": 3.1e-16, "area_error": 0.0, "largest_unbalanced_force": 4.2e-12}
LEFT_OUT = ("bedrock (no unknowns)", "deformation of the rock")


def motions(names: list[str], how: str, down: float = -0.5) -> tuple[tuple[str, str, float], ...]:
    """Blocks that move alike, outward along -x: name, how, and how far up while it moves by one."""
    return tuple((name, how, down) for name in names)


def mechanism(status: str, fos: float | None, blocks, interfaces=(), **more: Any):
    """A mechanism; `more` are its other attributes."""
    names, how, up = zip(*blocks, strict=True)
    moved = np.array([[-1.0, 0.0, one] for one in up])
    given = {"change": 0.0, "pairs_by_mode": {"stick": 12, "slip": 30, "open": 18}} | more
    return Mechanism(
        status, fos, names, how, moved, np.zeros_like(moved), interfaces=tuple(interfaces), **given
    )


def interfaces(count: int) -> list[GoverningInterface]:
    """Interfaces with falling shares that add up to one."""
    shares = np.arange(count, 0, -1.0) / (count * (count + 1) / 2)
    return [
        GoverningInterface(
            f"B{k}/B{k + 1}", f"S{1 + k % 2}", "slip" if k % 3 else "open", float(share), 1e3, 4.0
        )
        for k, share in enumerate(shares, 1)
    ]


def result(
    design, mechanisms, names, fixed=(), table=(), closed=None, standing="", **more: Any
) -> Result:
    """A result of many blocks from its mechanisms."""
    first = mechanisms[0] if mechanisms else None
    limit = more.pop("limit", first.fos if first else None)
    status = more.pop("status", first.status if first else "no_driving_force")
    fos = FactorsOfSafety(
        limit, closed, more.pop("static_bound", None), more.pop("all_pairs_failed", None)
    )
    is_fixed = tuple(name in fixed for name in names)
    moving = len(names) - sum(is_fixed)
    findings = Findings(
        tuple(mechanisms),
        standing,
        len(names),
        sum(is_fixed),
        more.pop("contacts", 3 * moving),
        more.pop("components", 1),
        more.pop("checks", CHECKS),
        tuple(table),
    )
    thickness = None if design.kind == "bench" else 1.0
    geometry = AssemblyGeometry(
        12.5 * moving,
        10.0,
        more.pop("areas", {"joint": 123.4}),
        tuple(names),
        is_fixed,
        thickness,
        NONE3,
        {},
        NONE3,
        np.zeros((0, 3), dtype=np.int64),
        WHOLE,
        Contacts(NONE3, np.zeros(1, dtype=np.int64), WHOLE, WHOLE, WHOLE),
    )
    difference = abs(limit - closed) / closed if limit and closed else None
    settings: dict[str, Any] = {
        "difference": difference,
        "agree": None if closed is None else difference is not None and difference < 0.01,
        "moments_govern": False,
        "geometry": geometry,
        "forces": Forces(312.5 * moving, {"joint": 900.0}, {}, None, None),
        "model": ModelSize(moving, 3 * moving, 60, 0, None, LEFT_OUT, 7, 1e-12),
        "warnings": (),
        "limit_state": LimitState(
            NodePairState(NONE3, WHOLE, NONE, NONE3, WHOLE, WHOLE, NONE, NONE3, WHOLE),
            Arrows((), WHOLE, WHOLE, NONE3, NONE3),
        ),
        "displacements": Displacements(),
        "comparisons": Comparisons(),
        "findings": findings,
        "timing_s": {"cut": 0.012, "contacts": 0.003, "solve": 12.5, "total": 12.6},
    }
    return Result(design, kind_of(design).words, status, fos, **(settings | more))


def goodman_bray(heights: list[float] | None = None) -> Result:
    """Goodman & Bray's columns, or others, with their own table and factor; PRE-IE's beside it made up."""
    design = sk.load(
        path_of("goodman-bray"), set=None if heights is None else {"columns.heights": heights}
    )
    slope = ColumnSlope(design.heights_m, 10.0, 1.0, 30.0, 25.0, 38.15)
    factor, _ = toppling_factor_of_safety(slope)
    table = toppling_table(slope, factor)

    def number(value: float) -> float | None:
        return None if math.isnan(value) else float(value)

    columns = [
        {
            "n": k + 1,
            "y_m": float(table.heights_m[k]),
            "M_m": number(table.upper_contact_m[k]),
            "L_m": number(table.lower_contact_m[k]),
            "P_topple_kn": number(table.topple_force_kn[k]),
            "P_slide_kn": number(table.slide_force_kn[k]),
            "P_kn": float(table.force_kn[k]),
            "R_kn": float(table.normal_kn[k]),
            "S_kn": float(table.shear_kn[k]),
            "mode": table.modes[k],
            "mode_preie": "topple" if k + 1 == 3 else table.modes[k],
        }
        for k in range(len(design.heights_m))
    ]
    ways = {"topple": "topples", "slide": "slides"}
    moving = [
        motion
        for way, how in ways.items()
        for motion in motions([f"C{one['n']}" for one in columns if one["mode"] == way], how)
    ]
    sides = [
        GoverningInterface("C4/C3", "joint", "slip", 0.4, 2825.48, 11.0),
        GoverningInterface("bedrock/C1", "joint", "open", 0.1, 812.4, 10.0),
    ]
    one = mechanism("topples", 1.0006, moving, sides)
    names = [f"C{k}" for k in range(1, len(columns) + 1)]
    return result(
        design,
        [one],
        names,
        (),
        columns,
        factor,
        "3 columns are left; one mechanism was asked for",
        static_bound=1.1904,
    )


def bench(blocks: int = 10_000, mechanisms: int = 40, **more: Any) -> Result:
    """A bench whose blocks ravel in some order, six at a time."""
    design = sk.load(
        path_of("bench"),
        set={
            "sets.S3.scatter": 3,
            "sets.S3.spacing_scatter": "20 %",
            "water": {"pressures": {"S1": "5 kPa"}},
            **more,
        },
    )
    names = [f"B{k}" for k in range(1, blocks + 1)]
    found = [
        mechanism(
            "slides", 0.9, motions([f"B{2 * k}" for k in range(1, 50)], "slides"), interfaces(43)
        )
    ]
    for k in range(1, mechanisms):
        few = [f"B{200 + 7 * k + i}" for i in range(6)]
        if k == 2:
            found.append(mechanism("falls", None, motions(few, "falls")))
        else:
            fos = 0.85 if k == 1 else 0.9 + 0.01 * k
            found.append(
                mechanism(
                    "rotates", fos, (*motions(few[:4], "slides"), *motions(few[4:], "rotates"))
                )
            )
    moving = blocks - 500
    standing = f"{moving - 49 - 6 * (mechanisms - 1)} blocks are left; {mechanisms} were asked for"
    notice = Notice(
        "W317",
        "the passes did not settle: the limit swings between 0.9 and 0.902; the lower is printed",
    )
    return result(
        design,
        found,
        names,
        names[-500:],
        standing=standing,
        components=3,
        warnings=(notice,),
        areas={"S1": 5123.4, "S2": 2345.6, "S3": 1e4, "cut at the ends": 3.0},
    )


def two_blocks(status: str = "falls", **more: Any) -> Result:
    """The active and the passive block with a result of that status and without a factor."""
    design = sk.load(path_of("blocks"), set=more.pop("set", None))
    moves = {"falls": "falls", "lifted": "lifts"}.get(status)
    found = [mechanism(status, None, motions(["B1"], moves))] if moves else []
    return result(design, found, ["base", "B1", "B2"], ["base"], status=status, **more)
