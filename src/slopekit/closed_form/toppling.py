"""Toppling of columns on a stepped base, per metre: each column in turn stands, topples or slides.

Sources: Goodman & Bray (1976), Toppling of rock slopes, ASCE Specialty Conf. Rock Engineering, Boulder, 201-234;
Wyllie & Mah (2004), Rock Slope Engineering, ch. 9. An earthquake is a second part of the weight. The points of
application come from the heights of the neighbours, not from the shape of the slope.

Column 1 is the toe, n the highest. The base of each column dips ψ out of the slope and lies a step b above the one
below it; P_n is the force between columns n and n + 1, square to the sides, whose friction is fully used.
"""

import math
from dataclasses import dataclass

import numpy as np

from slopekit.closed_form.search import first_loss
from slopekit.closed_form.tolerances import HOLDS, ROUNDING
from slopekit.core.array_types import ArrayLike, Bools, Floats
from slopekit.core.errors import DesignError, Fault


@dataclass(frozen=True, eq=False)
class ColumnSlope:
    """Columns on a stepped base, their strength and their loads.

    Attributes
    ----------
    heights_m : (n,) m, along the columns, from the toe up
    width_m : of every column; step_m : of the base between two columns, square to the bases, 0 or more
    base_dip_deg : of the bases out of the slope, ψ (90° less the dip of the columns)
    unit_weight_kn_m3 : kN/m³
    friction_angle_deg : of the bases; side_friction_angle_deg : of the sides, None: the same
    cohesion_kpa : of the bases, where a column slides. The sides have none: it would come and go with the contact.
    seismic : horizontal, out of the slope, and seismic_up : upward, parts of the weight
    toe_force_kn : kN per metre on column 1, into the slope; it is not divided by the factor of safety
    toe_force_plunge_deg : degrees below the horizontal
    toe_force_height_m : m, of its line above the base at the outer side of column 1; None: half way up
    loads : (n, 3) further loads on each column, water among them: kN per metre down along the bases and square into
        them, and their overturning moment (kNm per metre) about the outer corner of its base; None: none

    Raises
    ------
    DesignError
        E260 the earthquake acts into the slope, or the loads lift a column off its base.
    """

    heights_m: ArrayLike
    width_m: float
    step_m: float
    base_dip_deg: float
    unit_weight_kn_m3: float
    friction_angle_deg: float
    side_friction_angle_deg: float | None = None
    cohesion_kpa: float = 0.0
    seismic: float = 0.0
    seismic_up: float = 0.0
    toe_force_kn: float = 0.0
    toe_force_plunge_deg: float = 0.0
    toe_force_height_m: float | None = None
    loads: ArrayLike | None = None

    def __post_init__(self) -> None:
        if self.seismic < 0.0:
            message = (
                f"the seismic coefficient is {self.seismic:.6g}, it is 0 or more, out of the slope"
            )
            raise DesignError([Fault("E260", message)])
        heights = np.array(self.heights_m, dtype=np.float64)
        heights.setflags(write=False)
        object.__setattr__(self, "heights_m", heights)
        normal_load = _ColumnRow.from_slope(self).normal_load
        if not np.all(normal_load > 0.0):
            lifted = ", ".join(str(i + 1) for i in np.flatnonzero(normal_load <= 0.0)[:5])
            message = f"weight, earthquake and toe force together lift column {lifted} off its base"
            raise DesignError(
                [Fault("E260", message, "", "Give a smaller seismic coefficient or toe force.")]
            )


@dataclass(frozen=True, eq=False)
class TopplingTable:
    """The table of Goodman & Bray (1976), one row for each column from the toe up; nan where a number is undefined.

    Attributes
    ----------
    heights_m : (n,) y; upper_contact_m : (n,) M, height of P_n, nan for the highest column
    lower_contact_m : (n,) L, height of P_(n-1); for column 1 as if a column of no height stood below, -b
    topple_force_kn, slide_force_kn : (n,) P_(n-1) that just keeps the column from toppling, from sliding; below 0 it
        needs none. Column 1 has nothing to topple against: nan. ±inf: no force between sides
        that rough makes a difference (tan φ tan φ_side ≥ 1), and +inf in all rows below
    force_kn : (n,) P_(n-1), 0 or more; modes : stable, topple or slide
    normal_kn, shear_kn : (n,) R and S on the base; base_holds : (n,) R ≥ 0 and |S| ≤ R tan φ + c Δx. A tall column
        that leans on the top of a low one lifts off or slips back: there the method's forces are not to be trusted
    toe_force_kn : P_0, what column 1 still needs, along its base and at its top if it topples; below 0 it stands
    """

    heights_m: Floats
    upper_contact_m: Floats
    lower_contact_m: Floats
    topple_force_kn: Floats
    slide_force_kn: Floats
    force_kn: Floats
    modes: tuple[str, ...]
    normal_kn: Floats
    shear_kn: Floats
    base_holds: Bools
    toe_force_kn: float


def toppling_table(slope: ColumnSlope, factor: float = 1.0) -> TopplingTable:
    """Return the forces and modes of all columns with the strength (tan φ and c) divided by a factor.

    Formula: P_t = (P_n (M_n - Δx tan φ_s) + (D_n y_n - N_n Δx) / 2) / L_n and
    P_s = P_n + (D_n - N_n tan φ - c Δx) / (1 - tan φ tan φ_s), P_(n-1) = max(P_t, P_s, 0); D and N are the loads along
    and square to the base, M_n = min(y_n, y_(n+1) + b), L_n = min(y_(n-1) - b, y_n). A toe force T at L_1 plunging δ
    takes T cos(ψ + δ) from D_1, T cos(ψ + δ) L_1 from the moment and adds T sin(ψ + δ) to N_1 (Goodman & Bray 1976;
    Wyllie & Mah 2004, §9.4).

    >>> columns = ColumnSlope([4, 8, 12, 16, 20, 24, 28, 32, 36, 40, 34, 28, 22, 16, 10, 4], 10, 1, 30, 25, 38.15)
    >>> table = toppling_table(columns)
    >>> round(table.toe_force_kn, 3), table.modes.count("topple"), table.modes[:3]
    (1.182, 10, ('slide', 'slide', 'slide'))
    """
    row = _ColumnRow.from_slope(slope)
    topple, slide, force = (component[:, 0] for component in row.chain(np.array([factor])))
    above = np.append(force[1:], 0.0)
    with np.errstate(invalid="ignore"):  # infinite forces
        normal = row.normal_load + (above - force) * row.side / factor
        shear = row.down + (above - force)
        size = abs(row.normal_load) + abs(row.down) + above + force
        spare = normal * row.tangent / factor + row.bond / factor - abs(shear)
        holds = (normal >= -HOLDS * size) & (spare >= -HOLDS * size)
    modes = tuple(
        "stable" if p <= 0.0 else "topple" if s <= t < math.inf else "slide"
        for t, s, p in zip(topple, slide, force, strict=True)
    )
    arrays = (
        row.heights,
        np.append(row.upper[:-1], np.nan),
        row.lower,
        np.append(np.nan, topple[1:]),
        slide,
        force,
    )
    for array in (*arrays, normal, shear, holds):
        array.setflags(write=False)
    return TopplingTable(
        *arrays, modes, normal, shear, holds, max(float(topple[0]), float(slide[0]))
    )


def toppling_factor_of_safety(slope: ColumnSlope) -> tuple[float | None, str]:
    """Return the factor by which tan φ and c may be divided before column 1 needs a force at the toe, and a status.

    The toe force is an active load and is not reduced. Only forces decide; `base_holds` of the table checks the bases.

    Returns
    -------
    the factor, None where nothing is lost, 0.0 where no friction is enough; and the status: slides or topples (what
    column 1 does at the limit), no_driving_force, or held (at any strength)

    Formula: P_0(F) = 0 (Wyllie & Mah 2004, §9.4.5).

    >>> columns = ColumnSlope([4, 8, 12, 16, 20, 24, 28, 32, 36, 40, 34, 28, 22, 16, 10, 4], 10, 1, 30, 25, 38.6598)
    >>> factor, status = toppling_factor_of_safety(columns)
    >>> round(factor, 4), status
    (1.0184, 'slides')
    """
    row = _ColumnRow.from_slope(slope)
    low, high = first_loss(lambda factors: row.chain(factors)[2][0] <= 0.0)
    if math.isinf(high):
        return None, "held" if np.any(row.down > 0.0) else "no_driving_force"
    topple, slide, _ = row.chain(np.array([high]))
    return low, "topples" if topple[0, 0] >= slide[0, 0] else "slides"


def toe_force_required(slope: ColumnSlope, factor: float = 1.0) -> float:
    """Return the toe force (kN per metre, with the slope's plunge and height) that gives a factor of safety.

    0.0 where none is needed, inf where no force in that direction is enough.

    Formula: the larger of T = (P_1 (1 - tan φ tan φ_s) + D_1 - N_1 tan φ - c Δx) / (cos(ψ + δ) + sin(ψ + δ) tan φ)
    and T = (P_1 (M_1 - Δx tan φ_s) + (D_1 y_1 - N_1 Δx) / 2) / (L_1 cos(ψ + δ)) (Wyllie & Mah 2004, §9.4.4).

    >>> columns = ColumnSlope([4, 8, 12, 16, 20, 24, 28, 32, 36, 40, 34, 28, 22, 16, 10, 4], 10, 1, 30, 25, 33.0239)
    >>> round(toe_force_required(columns), 3)
    2012.857
    """
    row = _ColumnRow.from_slope(slope)
    _, __, forces = row.chain(np.array([factor]))
    push = float(forces[1, 0]) if len(forces) > 1 else 0.0
    base, side = row.tangent / factor, row.side / factor
    along, into = row.pull
    hold = along + into * base
    sliding_excess = (
        push * (1.0 - base * side) + row.down[0] - row.normal_load[0] * base - row.bond / factor
    )
    toppling_excess = push * (row.upper[0] - row.width * side) + row.moment[0]
    sliding_excess += slope.toe_force_kn * hold
    toppling_excess += slope.toe_force_kn * along * row.pull_height
    force = 0.0
    for needed, gain in ((sliding_excess, hold), (toppling_excess, along * row.pull_height)):
        if needed > 0.0:
            force = max(force, float(needed) / gain if gain > 0.0 else math.inf)
    return force


def seismic_gain(slope: ColumnSlope) -> tuple[float, int]:
    """Return how fast columns accelerate relative to the ground at their yield coefficient, and the fastest column.

    Parameters
    ----------
    slope : its `seismic` is the yield coefficient

    Returns
    -------
    acceleration of the centroid that moves fastest, as a multiple of (a - k_y g), and its column, 1 at the toe

    The columns that need a force move with column 1: one that topples rotates about its outer lower corner, one that
    slides moves along its base, and where two touch their speeds are equal: θ_n L_n or s_n = θ_(n-1) M_(n-1) or
    s_(n-1). Inertia takes W (y² + Δx²) θ / 3 from the moment, W s from the load along the base. P_0 is the sum of a
    term in k and one in the acceleration, and stays 0.

    Formula: the recursion of `toppling_table` in increments (Goodman & Bray 1976, with d'Alembert's forces).

    >>> one = ColumnSlope([2.0], 10.0, 0.0, 20.0, 25.0, 30.0, seismic=math.tan(math.radians(10.0)))
    >>> round(seismic_gain(one)[0], 12), round(math.cos(math.radians(20.0 - 30.0)) / math.cos(math.radians(30.0)), 12)
    (1.137158042603, 1.137158042603)
    """
    row = _ColumnRow.from_slope(slope)
    topple, slide, forces = row.chain(np.ones(1))
    topples = (topple >= slide)[:, 0]
    moving = 1 + int(np.argmin(np.append(forces[1:, 0] > 0.0, False)))
    rates = np.ones(moving)  # θ of those that topple, s of those that slide
    for i in range(1, moving):
        pushed = rates[i - 1] * (row.upper[i - 1] if topples[i - 1] else 1.0)
        rates[i] = pushed / row.lower[i] if topples[i] else pushed
    dip, width = math.radians(slope.base_dip_deg), row.width
    weights = slope.unit_weight_kn_m3 * width * row.heights
    per_k = per_gain = 0.0  # of the force on the column above
    for i in range(moving - 1, -1, -1):
        height, weight = row.heights[i], weights[i]
        down, normal_load = weight * math.cos(dip), -weight * math.sin(dip)
        if topples[i]:
            arm, lever = row.upper[i] - width * row.side, row.lower[i] if i else height
            per_k = (per_k * arm + (down * height - normal_load * width) / 2.0) / lever
            per_gain = (
                per_gain * arm - weight * (height * height + width * width) / 3.0 * rates[i]
            ) / lever
        else:
            locks = 1.0 - row.tangent * row.side
            per_k += (down - normal_load * row.tangent) / locks
            per_gain -= weight * rates[i] / locks
    radii = np.where(topples[:moving], np.hypot(row.heights[:moving], width) / 2.0, 1.0)
    speeds = rates * radii
    fastest = int(
        np.argmax(np.where(speeds > (1.0 - ROUNDING) * speeds.max(), weights[:moving], 0.0))
    )  # the heaviest
    return float(-per_k / per_gain * speeds[fastest]), fastest + 1


@dataclass(frozen=True, eq=False)
class _ColumnRow:
    """The columns as arrays, with loads along the bases (down) and normal to them (into the rock)."""

    heights: Floats
    width: float
    upper: Floats
    lower: Floats
    down: Floats
    normal_load: Floats
    moment: Floats
    tangent: float
    side: float
    bond: float
    pull: tuple[float, float]
    pull_height: float

    @classmethod
    def from_slope(cls, slope: ColumnSlope) -> "_ColumnRow":
        heights = np.array(slope.heights_m, dtype=np.float64)
        dip, width = math.radians(slope.base_dip_deg), slope.width_m
        weight = slope.unit_weight_kn_m3 * width * heights
        down = weight * ((1.0 - slope.seismic_up) * math.sin(dip) + slope.seismic * math.cos(dip))
        normal_load = weight * (
            (1.0 - slope.seismic_up) * math.cos(dip) - slope.seismic * math.sin(dip)
        )
        moment = (down * heights - normal_load * width) / 2.0
        if (
            slope.loads is not None
        ):  # V₁, V₂, V₃ of Wyllie & Mah (2004), eqs. 9.13 to 9.16, whatever their shape
            further_loads = np.asarray(slope.loads, dtype=np.float64)
            down, normal_load, moment = (
                down + further_loads[:, 0],
                normal_load + further_loads[:, 1],
                moment + further_loads[:, 2],
            )
        pull_angle = dip + math.radians(slope.toe_force_plunge_deg)
        pull = math.cos(pull_angle), math.sin(pull_angle)
        pull_height = (
            heights[0] / 2.0 if slope.toe_force_height_m is None else slope.toe_force_height_m
        )
        down[0] -= slope.toe_force_kn * pull[0]
        normal_load[0] += slope.toe_force_kn * pull[1]
        moment[0] -= slope.toe_force_kn * pull[0] * pull_height
        upper = np.minimum(heights, np.append(heights[1:], 0.0) + slope.step_m)
        lower = np.minimum(heights, np.append(0.0, heights[:-1]) - slope.step_m)
        side = (
            slope.friction_angle_deg
            if slope.side_friction_angle_deg is None
            else slope.side_friction_angle_deg
        )
        base_tangent, side_tangent = (
            math.tan(math.radians(angle)) for angle in (slope.friction_angle_deg, side)
        )
        strength = base_tangent, side_tangent, slope.cohesion_kpa * width
        return cls(
            heights,
            width,
            upper,
            lower,
            down,
            normal_load,
            moment,
            *strength,
            pull,
            float(pull_height),
        )

    def chain(self, factors: Floats) -> tuple[Floats, Floats, Floats]:
        """Return the forces P_t, P_s and P_(n-1) (n, m) of the columns at each factor (m,), see `TopplingTable`."""
        base, side, bond = self.tangent / factors, self.side / factors, self.bond / factors
        locks = 1.0 - base * side
        topple, slide, forces = (np.empty((self.heights.size, factors.size)) for _ in range(3))
        push = np.zeros(factors.size)
        for i in range(self.heights.size - 1, -1, -1):
            down, normal_load = self.down[i], self.normal_load[i]
            with np.errstate(
                invalid="ignore", divide="ignore"
            ):  # sides that lock, forces without end
                moment = push * (self.upper[i] - self.width * side) + self.moment[i]
                size = (
                    push * (self.upper[i] + self.width * side)
                    + abs(down) * self.heights[i]
                    + abs(normal_load) * self.width
                )
                moment = np.where(abs(moment) <= ROUNDING * size, 0.0, moment)
                excess = push * locks + down - normal_load * base - bond
                size = push * (1.0 + base * side) + abs(down) + normal_load * base + bond
                excess = np.where(abs(excess) <= ROUNDING * size, 0.0, excess)
                endless = np.isinf(push)
                moment, excess = (np.where(endless, np.inf, value) for value in (moment, excess))
                topple[i] = moment / (self.lower[i] if i else self.heights[0])
                slide[i] = np.where(
                    locks > 0.0,
                    excess / locks,
                    np.where(excess == 0.0, 0.0, np.copysign(np.inf, excess)),
                )
            push = np.maximum(np.maximum(topple[i], slide[i]), 0.0)
            forces[i] = push
        return topple, slide, forces
