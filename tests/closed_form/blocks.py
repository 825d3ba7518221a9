"""Blocks on inclines, per metre: one block, a stack, a wall in running bond, an active block on a passive one.

Sources: Hoek & Bray (1981), Rock Slope Engineering, ch. 2 (sliding and toppling of a block); the two blocks are the
bilinear slip surface of Sultan & Seed (1967), J. Soil Mech. Found. Div. 93 (SM4), with an upright interface.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slopekit.closed_form.toppling import first_loss

Floats = NDArray[np.float64]
_SMALL = 1e-12
_ROUNDING = 1e-14


@dataclass(frozen=True, slots=True)
class ClosedFormBlock:
    """What the closed form says of blocks on an incline.

    Attributes
    ----------
    status : slides, topples (whatever the strength) or no_driving_force
    factor : factor of safety; 0.0 where it topples, None where nothing drives it
    sliding_factor : against sliding alone, None where nothing drives it
    overturning_ratio : base / (height tan β), it topples below 1; inf on level ground
    joint : the joint that governs sliding, 1 the lowest
    """

    status: str
    factor: float | None
    sliding_factor: float | None
    overturning_ratio: float
    joint: int = 1


@dataclass(frozen=True, slots=True)
class ClosedFormTwoBlocks:
    """What the closed form says of an active block that pushes a passive one.

    Attributes
    ----------
    status : slides (the active block pushes), passive_slides (without a push), held (at any strength)
    factor : factor of safety, None where they are held; 0.0 where no friction is enough
    bracket : last factor that stands, first that does not
    push_kn, interface_shear_kn : on the interface, kN; normals_kn : on the bases of active and passive, kN
    residual_kn : driving less resisting force of the passive block; all at the factor, nan without one
    """

    status: str
    factor: float | None
    bracket: tuple[float, float]
    push_kn: float
    interface_shear_kn: float
    normals_kn: tuple[float, float]
    residual_kn: float


def block_on_incline(
    dip_deg: float,
    base_m: float,
    height_m: float,
    cohesion_kpa: float,
    friction_angle_deg: float,
    unit_weight_kn_m3: float,
) -> ClosedFormBlock:
    """Sliding and toppling of one rectangular block; nothing pulls on its base, so no strength stops toppling.

    Parameters
    ----------
    base_m, height_m : m, along the incline and square to it; per metre of depth

    Formula: F = (c b + W cos β tan φ) / (W sin β); it topples where b / h < tan β (Hoek & Bray 1981, ch. 2).

    >>> block = block_on_incline(30, 2, 1, 5, 35, 25)
    >>> block.status, round(block.factor, 4), round(block.overturning_ratio, 4)
    ('slides', 1.6128, 3.4641)
    """
    return stack_on_incline(
        dip_deg, base_m, height_m, 1, cohesion_kpa, friction_angle_deg, unit_weight_kn_m3
    )


def stack_on_incline(
    dip_deg: float,
    base_m: float,
    height_m: float,
    count: int,
    cohesion_kpa: float,
    friction_angle_deg: float,
    unit_weight_kn_m3: float,
    *,
    joint_cohesion_kpa: float | None = None,
    joint_friction_angle_deg: float | None = None,
) -> ClosedFormBlock:
    """Sliding and toppling of a stack of equal rectangular blocks, on its base or on any joint between two blocks.

    Parameters
    ----------
    base_m, height_m : m, of one block, along the incline and square to it; count : blocks
    cohesion_kpa, friction_angle_deg : of the base; joint_... : between blocks, None: the same

    Formula: the least of F_j = (c_j b + W_j cos β tan φ_j) / (W_j sin β), W_j what stands on joint j; the whole stack
    topples first, where b / (n h) < tan β.

    >>> stack = stack_on_incline(20, 2, 0.5, 10, 0, 35, 25, joint_friction_angle_deg=30)
    >>> stack.status, round(stack.factor, 4), stack.joint
    ('slides', 1.5863, 2)
    """
    joint_cohesion = cohesion_kpa if joint_cohesion_kpa is None else joint_cohesion_kpa
    joint_friction = (
        friction_angle_deg if joint_friction_angle_deg is None else joint_friction_angle_deg
    )
    dip = math.radians(dip_deg)
    if dip == 0.0:
        return ClosedFormBlock("no_driving_force", None, None, math.inf)
    weights = unit_weight_kn_m3 * base_m * height_m * np.arange(count, 0, -1)
    joints = np.arange(count)
    bond = np.where(joints == 0, cohesion_kpa, joint_cohesion) * base_m
    tangent = np.tan(np.radians(np.where(joints == 0, friction_angle_deg, joint_friction)))
    factors = (bond + weights * math.cos(dip) * tangent) / (weights * math.sin(dip))
    at = int(np.flatnonzero(factors <= factors.min() * (1.0 + _SMALL))[0])
    return _verdict(float(factors[at]), base_m / (count * height_m * math.tan(dip)), at + 1)


def running_bond_wall(
    dip_deg: float, friction_angle_deg: float, length_m: float, courses: int, course_height_m: float
) -> ClosedFormBlock:
    """A wall in running bond across an incline, without cohesion: it slides on its base or topples as a whole.

    An upper bound: the balance of the whole wall. A long, low wall reaches it; one about as high as it is long fails
    earlier, part of it turning, and has no closed form.

    Parameters
    ----------
    length_m : m, down the incline; courses : number of them; course_height_m : m

    Formula: F = tan φ / tan β; it topples where length / height < tan β.

    >>> wall = running_bond_wall(20, 35, 20, 10, 1)
    >>> wall.status, round(wall.factor, 5)
    ('slides', 1.9238)
    """
    return block_on_incline(
        dip_deg, length_m, courses * course_height_m, 0.0, friction_angle_deg, 1.0
    )


def two_blocks(
    weights_kn: tuple[float, float],
    base_dips_deg: tuple[float, float],
    base_lengths_m: tuple[float, float],
    friction_angles_deg: tuple[float, float],
    cohesions_kpa: tuple[float, float] = (0.0, 0.0),
    *,
    interface_height_m: float = 0.0,
    interface_friction_angle_deg: float = 0.0,
    interface_cohesion_kpa: float = 0.0,
) -> ClosedFormTwoBlocks:
    """Factor of safety of an active block that slides on its base and pushes a passive one over an upright interface.

    Forces only; bases and interface all use tan φ / F and c / F. Where the active block needs no push, the interface
    carries just the shear it needs.

    Parameters
    ----------
    weights_kn, base_dips_deg, base_lengths_m, friction_angles_deg, cohesions_kpa : active, passive; kN per metre,
        degrees down toward the passive block's free side (below 0: its base climbs), m, degrees, kPa

    Formula: with t = tan φ / F, c / F and T = c_i h + E t_i on the interface,
    E = ((W₁ - c_i h)(sin α₁ - t₁ cos α₁) - c₁ l₁) / (cos α₁ + t₁ sin α₁ + t_i (sin α₁ - t₁ cos α₁)) and
    (W₂ + T) sin α₂ + E cos α₂ = c₂ l₂ + ((W₂ + T) cos α₂ - E sin α₂) t₂ (Sultan & Seed 1967, here per base).
    Smooth and without cohesion: W₁ tan(α₁ - φ₁*) = W₂ tan(φ₂* - α₂).

    >>> found = two_blocks((250, 1000), (45, 0), (50**0.5, 10), (30, 30))
    >>> found.status, round(found.factor, 6)
    ('slides', 3.291798)
    """
    dips = tuple(math.radians(dip) for dip in base_dips_deg)
    tangents = tuple(math.tan(math.radians(angle)) for angle in friction_angles_deg)
    bonds = tuple(c * length for c, length in zip(cohesions_kpa, base_lengths_m, strict=True))
    side = (
        math.tan(math.radians(interface_friction_angle_deg)),
        interface_cohesion_kpa * interface_height_m,
    )

    def forces(factor: Floats) -> tuple[Floats, ...]:
        """Push, interface shear, both normals and what drives the passive block beyond its resistance."""
        (s1, c1), (s2, c2) = ((math.sin(dip), math.cos(dip)) for dip in dips)
        t1, t2, b1, b2, ti, bi = (x / factor for x in (*tangents, *bonds, *side))
        steeper = s1 - t1 * c1  # part of its weight with which the active block drives
        drives = (weights_kn[0] - bi) * steeper - b1
        pushes = (steeper > 0.0) & (drives > 0.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            hung = np.where(steeper > 0.0, np.maximum(weights_kn[0] - b1 / steeper, 0.0), 0.0)
            push = np.where(pushes, drives / (c1 + t1 * s1 + ti * steeper), 0.0)
        shear = np.where(pushes, bi + push * ti, hung)
        active = (weights_kn[0] - shear) * c1 + push * s1
        passive = (weights_kn[1] + shear) * c2 - push * s2
        drives = (weights_kn[1] + shear) * s2 + push * c2
        size = abs(weights_kn[1] + shear) + push
        beyond = drives - np.where(passive > 0.0, b2 + passive * t2, 0.0)
        beyond = np.where(abs(beyond) <= _ROUNDING * size, 0.0, beyond)
        return push, shear, active, passive, beyond

    low, high = first_loss(lambda factor: forces(factor)[4] <= 0.0)
    if math.isinf(high):
        return ClosedFormTwoBlocks(
            "held", None, (low, high), *(math.nan,) * 2, (math.nan,) * 2, math.nan
        )
    push, shear, active, passive, beyond = (float(x[0]) for x in forces(np.array([low or high])))
    status = "slides" if push > 0.0 else "passive_slides"
    return ClosedFormTwoBlocks(status, low, (low, high), push, shear, (active, passive), beyond)


def _verdict(sliding: float, ratio: float, joint: int) -> ClosedFormBlock:
    if ratio < 1.0 - _ROUNDING:
        return ClosedFormBlock("topples", 0.0, sliding, ratio, joint)
    return ClosedFormBlock("slides", sliding, sliding, ratio, joint)
