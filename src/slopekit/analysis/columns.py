"""Goodman & Bray's table beside the columns of PRE-IE."""

import math

import numpy as np

from slopekit.analysis.stages import ClosedForm
from slopekit.closed_form.toppling import ColumnSlope, TopplingTable, toppling_factor_of_safety, toppling_table
from slopekit.design.blocky import ToppleDesign
from slopekit.errors import DesignError
from slopekit.findings import Column, Mechanism

_BEYOND = 1e-6  # the table is that of columns which just fail
_MODES = {"slides": "slide", "topples": "topple", "rotates": "turn", "falls": "fall", "lifts": "lift"}


def goodman_bray(design: ToppleDesign, found: Mechanism | None) -> tuple[ClosedForm, tuple[Column, ...]]:
    """The closed form of a row of columns, and its table at the factor where the columns are at their limit."""
    why = _why_not(design)
    if why:
        return ClosedForm(None, "", why), ()
    base, sides = design.strength(design.base), design.strength(design.sides)
    toward, k = design.seismic.trend_deg, design.seismic.coefficient
    try:
        slope = ColumnSlope(
            heights_m=design.heights_m, width_m=design.width_m, step_m=design.base_step_m,
            base_dip_deg=90.0 - design.dip_deg, unit_weight_kn_m3=design.unit_weight_kn_m3,
            friction_angle_deg=base.friction_angle_deg, side_friction_angle_deg=sides.friction_angle_deg,
            cohesion_kpa=base.cohesion_kpa, seismic=k if toward is None or toward > 180.0 else -k,
        )  # fmt: skip
        closed = toppling_factor_of_safety(slope)
        table = toppling_table(slope, (closed.factor or 1.0) * (1.0 + _BEYOND))
    except DesignError as error:
        return ClosedForm(
            None, "", f"Goodman & Bray's method does not take these columns: {error.faults[0].message}"
        ), ()
    ways = {block.name: _MODES[block.how] for block in found.blocks} if found is not None else {}
    columns = tuple(_columns(design, table, ways))
    rough = math.tan(math.radians(base.friction_angle_deg)) * math.tan(math.radians(sides.friction_angle_deg))
    if closed.factor and rough >= closed.factor**2:
        why = (
            f"at {closed.factor:.4g} the columns are so rough (tan φ tan φ of the sides above 1) that Goodman & Bray's "
            "sliding has no meaning: not compared"
        )
        return ClosedForm(closed.factor, closed.status, why), columns
    if not table.base_holds.all():
        lifted = ", ".join(f"C{n + 1}" for n in np.flatnonzero(~table.base_holds)[:5])
        why = f"Goodman & Bray's forces are not admissible at {lifted} (lifted, or slipping back): not compared"
        return ClosedForm(closed.factor or None, closed.status, why), columns
    return ClosedForm(closed.factor or None, closed.status), columns


def _why_not(design: ToppleDesign) -> str:
    """Why Goodman & Bray's method says nothing of a design."""
    sides, base = design.strength(design.sides), design.strength(design.base)
    if sides.law or base.law:
        return "the closed form (Goodman & Bray) knows one friction angle for all bases: not compared"
    if sides.cohesion_kpa:
        return "the closed form (Goodman & Bray) knows no cohesion on the sides of columns: not compared"
    if any(design.pressures_kpa):
        return "the closed form (Goodman & Bray) is without water here: not compared"
    if design.forces or design.bolts:
        return "the closed form (Goodman & Bray) is without forces and bolts on single columns: not compared"
    if sides.dilation_deg or base.dilation_deg:
        return "the closed form (Goodman & Bray) knows no dilation: not compared"
    return ""


def _columns(design: ToppleDesign, table: TopplingTable, ways: dict[str, str]) -> list[Column]:
    rows = []
    for k in range(len(table.heights_m)):
        name = design.block_names[k]
        rows.append(
            Column(
                k + 1, float(table.heights_m[k]), _known(table.upper_contact_m[k]), _known(table.lower_contact_m[k]),
                _known(table.topple_force_kn[k]), _known(table.slide_force_kn[k]), _known(table.force_kn[k]),
                _known(table.normal_kn[k]), _known(table.shear_kn[k]), table.modes[k], ways.get(name, "stable"),
            )
        )  # fmt: skip
    return rows


def _known(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
