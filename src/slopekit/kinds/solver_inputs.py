"""The inputs of the solver as arrays, from designs: strengths, stiffness, bolts, forces, a block in its section."""

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from slopekit.core.arrays import Floats, frozen
from slopekit.core.orientation import Line, coordinates
from slopekit.design.common import Design
from slopekit.design.ground_water import SlopeDesign
from slopekit.design.parts import Force, Strength
from slopekit.extents import SectionGeometry
from slopekit.geometry.polytopes import Block
from slopekit.kinds.single_block.held_bolts import Bounds, bolt_exit
from slopekit.kinds.sizes import sizes_of_section
from slopekit.loads import Loads, PointForce, block_loads, check_bolt_anchorage
from slopekit.preie.system.contact import CloughDuncan, JointStiffness
from slopekit.preie.system.model import JointStrength

if TYPE_CHECKING:
    from slopekit.geometry.sections.section import PlaneSection
    from slopekit.kinds.water import FullWater

_ALONG_SLOPE = 1e-9  # of the strongest bolt: one with less in a section runs along its slope
#: How far (m) from a head (3,) along a direction (3,) sound rock begins, None: the block is missed; whether it does so.
Meets = Callable[[Floats, Floats], tuple[float | None, bool]]


def joint_stiffness(design: Design) -> JointStiffness:
    """Return the contact stiffness of a design."""
    stiffness, weight = design.stiffness, design.water_unit_weight_kn_m3
    shear: float | CloughDuncan | None = stiffness.shear_kn_m3
    if shear is None:
        shear = CloughDuncan(**vars(stiffness.hyperbola), water_unit_weight=weight)
    return JointStiffness(normal=stiffness.normal_kn_m3, tangential=shear)


def joint_strength(strengths: Sequence[Strength]) -> JointStrength:
    """Return the strengths of the interfaces 0, 1, ... as arrays."""
    laws = tuple(strength.law for strength in strengths)
    return JointStrength(
        np.array([strength.cohesion_kpa for strength in strengths]),
        np.tan(np.radians([strength.friction_angle_deg for strength in strengths])),
        np.tan(np.radians([strength.dilation_deg for strength in strengths])),
        np.array([strength.tension_kpa for strength in strengths]),
        laws if any(laws) else (),
    )


def bolt_forces(
    design: Design, origin: Floats, meets: Meets, turn: Floats | None = None
) -> tuple[list[PointForce], list[PointForce]]:
    """Return the active and the passive bolts as forces, each checked against the block where its head is known.

    Parameters
    ----------
    turn : (3, 3) from the user's axes to the local ones
    """
    axes = np.eye(3) if turn is None else turn
    active: list[PointForce] = []
    passive: list[PointForce] = []
    for k, bolt in enumerate(design.bolts, 1):
        direction = axes @ bolt.toward.vector()
        head = None if bolt.head_m is None else axes @ (np.array(bolt.head_m) - origin)
        if head is not None:
            location = design.place_of("support", "bolts", k, len(design.bolts))
            location = location or f"head at {coordinates(bolt.head_m or ())}"
            check_bolt_anchorage(f"bolt {k}", *meets(head, direction), bolt.length_m, location)
        (active if bolt.acts == "active" else passive).append(
            PointForce(bolt.force_kn * direction, head)
        )
    return active, passive


def loads_in_slope(
    design: SlopeDesign,
    block: Block,
    bounds: Bounds,
    full: "FullWater",
    shaken: Floats,
    axes: Floats,
) -> Loads:
    """Return the loads on a block in a slope, in local axes about the origin of its planes.

    Parameters
    ----------
    full : the pressures of full water; shaken : (3,) level unit vector that an earthquake without a trend acts along
    axes : (3, 3) rows are the local axes in east, north, up; a row of zeros ignores the loads along its axis
    """
    trend = design.seismic.trend_deg
    shaking = shaken if trend is None else Line(trend, 0.0).vector()

    def meets(head: Floats, direction: Floats) -> tuple[float | None, bool]:
        (exit_distance,), (is_anchored,) = bolt_exit(bounds, head[None] @ axes, direction @ axes)
        return None if math.isnan(exit_distance) else float(exit_distance), bool(is_anchored)

    active, passive = bolt_forces(design, bounds.origin, meets, axes)
    strongest = max((bolt.force_kn for bolt in design.bolts), default=0.0)
    pushes: dict[str, PointForce] = {}
    if design.is_wet or design.is_cut_for_loads:  # plain designs do not pay
        from slopekit.kinds.water import pushes_on

        pushes = pushes_on(design, bounds, full, axes)
    return block_loads(
        block,
        design.rock.unit_weight_kn_m3,
        design.seismic.coefficient * (axes @ shaking),
        [point_force(force, bounds.origin, axes) for force in design.forces],
        active,
        [bolt for bolt in passive if float(np.abs(bolt.force).max()) > _ALONG_SLOPE * strongest],
        pushes,
    )


def point_force(force: Force, origin: Floats, turn: Floats | None = None) -> PointForce:
    """Return a force of the design in local axes."""
    axes = np.eye(3) if turn is None else turn
    point = None if force.at_m is None else axes @ (np.array(force.at_m) - origin)
    return PointForce(axes @ np.array(force.components_kn), point)


def section_geometry(
    section: "PlaneSection", name: str, axes: Floats | None = None, crest_x: float | None = None
) -> SectionGeometry:
    """Return the geometry of a block in its section.

    Parameters
    ----------
    axes : (3, 3) rows are its axes in those of the user; crest_x : of the crest of its slope, None where it has none
    """
    areas = {name: section.length}
    if section.crack_depth is not None:
        areas["crack"] = section.crack_depth
    height = float(np.ptp(section.outline[:, 1]))
    return SectionGeometry(
        section.block.volume,
        height,
        areas,
        section.outline,
        frozen(section.block.centroid[[0, 2]]),
        section.crack_depth,
        section.crack_distance,
        frozen(np.eye(3) if axes is None else axes),
        None if crest_x is None else sizes_of_section(section.outline, crest_x, areas),
    )
