"""A water table and a pond on a curved slip surface: the pressure integrated over the facets of the mass.

Between the facets and an analytic surface lies a sliver of ground. There, too, the pressure is hydrostatic: on the
surface itself presses what presses on the facets, and γ_w times the sliver, upward, by the share of the facets that is
wet. So a drowned mass has its buoyant weight to the last digit.
"""

import numpy as np

from slopekit.core.arrays import Floats, cross
from slopekit.geometry.pressure import Height, Pressure, in_strips
from slopekit.geometry.solids.shapes import GROUND, SLIP
from slopekit.geometry.solids.sliding_mass import SlidingMass, volume_moments
from slopekit.kinds.surface.design import SurfaceDesign, along_x
from slopekit.kinds.water import above_ground, pressure_below, refuse
from slopekit.loads import PointForce

_ALONG = np.array([1.0, 0.0, 0.0])  # what places of points count along


def water_of(design: SurfaceDesign) -> Pressure:
    """The water of a design, in its own coordinates."""

    def at_depth(depth: float) -> tuple[Height, ...]:
        places, levels = zip(*along_x(design.profile_m or ()), strict=True)
        return in_strips(_ALONG, places, [level - depth for level in levels])

    return pressure_below(design, _ALONG, 0.0, at_depth)


def pushes_of(design: SurfaceDesign, mass: SlidingMass) -> dict[str, PointForce]:
    """Water on the slip surface, and of a pond on the ground: forces through the centroid, with their couples.

    Raises
    ------
    GeometryError
        E456 the table lies above the ground.
    """
    water, vertices = water_of(design), mass.vertices + mass.origin
    ground, slip = (vertices[mass.triangles[mass.on == face]] for face in (GROUND, SLIP))
    refuse(above_ground(design, water, ground[None], float(np.ptp(vertices[:, 2]))))
    centre = mass.centroid + mass.origin
    force, couple, wet = _on_facets(water, slip, centre)
    volume, moment = volume_moments(mass.vertices, mass.triangles)
    sliver, first = mass.volume - volume, mass.volume * mass.centroid - moment
    lift = np.array([0.0, 0.0, water.unit_weight * wet])
    loads = {f"water {SLIP}": PointForce(
        force + sliver * lift, None, couple + cross(first - sliver * mass.centroid, lift)
    )}  # fmt: skip
    if water.pond is not None:
        force, couple, _ = _on_facets(Pressure((), water.pond, water.unit_weight), ground, centre)
        loads[f"water {GROUND}"] = PointForce(force, None, couple)
    return loads


def _on_facets(water: Pressure, facets: Floats, centre: Floats) -> tuple[Floats, Floats, float]:
    """Force (3,), couple (3,) about a point and the share of the area that is wet, of triangles (n, 3, 3)."""
    areas = cross(facets[:, 1] - facets[:, 0], facets[:, 2] - facets[:, 0]) / 2.0
    sizes = np.sqrt((areas * areas).sum(axis=1))
    thrusts, at = water.on(facets)
    is_wet = (thrusts > 0.0) & (sizes > 0.0)
    pushes = -(thrusts / np.where(is_wet, sizes, np.inf))[:, None] * areas
    wet, whole = float(sizes[is_wet].sum()), float(sizes.sum())
    return pushes.sum(axis=0), cross(at - centre, pushes).sum(axis=0), wet / whole if whole else 0.0
