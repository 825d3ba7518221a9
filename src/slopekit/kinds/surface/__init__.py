"""A mass on a curved slip surface."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from slopekit.closed_form import columns as lem
from slopekit.closed_form.rotation import rotational_failure
from slopekit.core.arrays import Floats, Ints, cross, frozen
from slopekit.core.errors import DesignError, Fault, GeometryError, Notice
from slopekit.core.orientation import Line, coordinates, millimetre
from slopekit.core.orientation import number as number_text
from slopekit.core.progress import report_stage
from slopekit.core.sheet import Section
from slopekit.design.parts import MeshFile
from slopekit.extents import SurfaceGeometry
from slopekit.geometry.interfaces import NodePairs
from slopekit.geometry.polytopes import Block
from slopekit.geometry.pressure import Height, Pressure, table_through_points
from slopekit.geometry.solids.meshes import outward, read_mesh
from slopekit.geometry.solids.shapes import (
    GROUND,
    SLIP,
    Cutter,
    Cylinder,
    Ellipsoid,
    profile_prism,
    sheet_solid,
)
from slopekit.geometry.solids.sliding_mass import (
    CLOSE_IT,
    SlidingMass,
    analytic_mass,
    cut_mass,
    facet_pairs,
    halvings,
    mass_exit,
    volume_moments,
)
from slopekit.kinds.protocol import ClosedForm
from slopekit.kinds.single_block.one_block import SingleBlock
from slopekit.kinds.single_block.one_block_limit import ContactModel, Cut, FoundLimit, Interface
from slopekit.kinds.solver_inputs import bolt_forces, joint_strength, point_force
from slopekit.kinds.surface.design import SurfaceDesign, along_x, read_surface
from slopekit.kinds.water import pressure_below, raise_misfit, table_above_ground
from slopekit.kinds.words import short, slope_sections, strength_in_words, water_in_words
from slopekit.loads import Loads, PointForce, block_loads
from slopekit.preie.one_block.pairs_limit import pairs_limit
from slopekit.preie.one_block.slippage import slippable
from slopekit.preie.outcome import Outcome
from slopekit.preie.system.model import build_model
from slopekit.preie.tolerances import FARTHEST_DEG
from slopekit.result import Result, Words

if TYPE_CHECKING:
    from slopekit.kinds.single_block.ladders import Rung

NAME = "slip surface"
_EDGE_RATIOS = (4.0, 2.0, 1.0, 0.5)  # times the edge of the design; meshes halve
_EDGE_MARGIN = 1.01  # asked for so much more than a halving, to get that and not the next
_LEVEL_OF_FACETS = 4
_COARSEST = 2  # level from which the wanted edge is reached by halving
_NOT_DRIVEN = 1e6  # a factor beyond this is that of level ground
_OVERHUNG = 1e-6  # of the weight
_X_AXIS = np.array([1.0, 0.0, 0.0])  # what places of points count along


def cut(design: SurfaceDesign) -> Cut:
    """Cut the mass, turn the normals so that it can slip, and load it.

    Raises
    ------
    GeometryError
        Where slip surface and ground make no mass that can move.
    """
    mass, pairs = _cut(design)
    loads = _loads(design, mass, pairs)
    slip = slippable(pairs, mass.centroid, np.concatenate([loads.force, loads.moment]))
    strength = joint_strength([replace(design.strength, dilation_deg=0.0)])
    scene = ContactModel(slip.pairs, build_model(slip.pairs, loads, mass.centroid, strength))
    left_out = ["bedrock (no unknowns)", "ground surface (free)", "deformation of the mass"]
    left_out += (
        ["strength at the two ends of the cylinder"] if design.slip.shape == "cylinder" else []
    )
    if mass.pieces:
        left_out.append(
            f"{len(mass.pieces)} smaller pieces within the slip surface, {sum(mass.pieces):.4g} m³"
        )

    def geometry() -> SurfaceGeometry:
        return SurfaceGeometry(
            mass.volume,
            float(np.ptp(mass.vertices[:, 2])),
            {NAME: mass.area},
            frozen(mass.centroid + mass.origin),
            mass.edge,
            design.slip.normals,
            slip.motions,
            slip.misfit_deg,
            mass.pieces,
            frozen(mass.vertices + mass.origin),
            mass.triangles,
            mass.face_kinds == SLIP,
        )

    return Cut(
        _block(mass),
        loads,
        lambda _: scene,
        [Interface(SLIP, NAME, design.strength)],
        geometry,
        left_out,
        {SLIP: NAME} | ({} if design.water.pond_m is None else {GROUND: "ground"}),
        origin=mass.origin,
    )


def _block(mass: SlidingMass) -> Block:
    return Block({}, {SLIP: mass.area}, mass.volume, mass.centroid)


def _cut(design: SurfaceDesign) -> tuple[SlidingMass, NodePairs]:
    """Return the mass and its node pairs, about the origin of the mass."""
    slip = design.slip
    ground_mesh = slip_mesh = None
    if design.ground_mesh is not None:
        ground_mesh = _read(design.ground_mesh)
        if not ground_mesh[2]:
            name = design.ground_mesh.name
            raise GeometryError(
                [Fault("E216", f"the mesh {name} of the slope is not closed", "", CLOSE_IT)]
            )
    if slip.mesh is not None:
        slip_mesh = _read(slip.mesh)
    if slip_mesh is None:
        origin = np.array(slip.centre_m)
        radii = np.array(slip.radii_m)
        shape = (
            Cylinder(float(radii[0]), 2.0 * float(radii[1]))
            if slip.shape == "cylinder"
            else Ellipsoid(radii)
        )
        body = shape.cutter(_LEVEL_OF_FACETS)
    else:
        origin = (slip_mesh[0].min(axis=0) + slip_mesh[0].max(axis=0)) / 2.0
        body = Cutter(slip_mesh[0] - origin, slip_mesh[1], np.full(len(slip_mesh[1]), SLIP))
    lowest, highest = body.vertices.min(axis=0), body.vertices.max(axis=0)
    size = float((highest - lowest).max())
    if ground_mesh is not None:
        ground = Cutter(
            ground_mesh[0] - origin, ground_mesh[1], np.full(len(ground_mesh[1]), GROUND)
        )
    else:
        profile = np.array(design.profile_m) - origin[[0, 2]]
        low = min(float(lowest[2]), float(profile[:, 1].min())) - 0.1 * size
        half = float(max(-lowest[1], highest[1])) + 0.1 * size
        reach = (float(lowest[0]) - 0.1 * size, float(highest[0]) + 0.1 * size)
        ground = profile_prism(profile, low, half, reach)
    if slip_mesh is not None and not slip_mesh[2]:
        top = max(float(highest[2]), float(ground.vertices[:, 2].max())) + 0.1 * size
        body = sheet_solid(body.vertices, body.triangles, top)
    if slip_mesh is None and slip.normals == "true":
        mass, pairs = analytic_mass(ground, shape, slip.edge_m)
    else:
        if slip_mesh is None and slip.edge_m is not None:
            body = shape.cutter(
                _COARSEST + halvings(cut_mass(ground, shape.cutter(_COARSEST)), slip.edge_m)
            )
        mass = cut_mass(ground, body)
        pairs = facet_pairs(mass, body)
    _refuse_walls(mass, slip_mesh is not None)
    if design.profile_m is not None:
        _refuse_mass_off_profile(mass.vertices[:, 0] + origin[0], [x for x, _ in design.profile_m])
    return replace(mass, origin=origin), pairs


def _refuse_mass_off_profile(across: Floats, profile: Sequence[float]) -> None:
    """Raise E551 where the mass lies wholly beyond the ends of the profile, mostly by a centre in other coordinates."""
    low, high, first, last = float(across.min()), float(across.max()), min(profile), max(profile)
    if low >= last or high <= first:
        mass, ground = (
            f"{millimetre(low)} to {millimetre(high)}",
            f"{millimetre(first)} to {millimetre(last)}",
        )
        message = f"the mass lies at x {mass} m, the profile goes from {ground} m"
        advice = "Are slip and profile in the same coordinates? Beyond its ends the ground is taken as level."
        raise GeometryError([Fault("E551", message, "", advice)])


def _read(file: MeshFile) -> tuple[Floats, Ints, bool]:
    """Read vertices, triangles and whether they close; a mesh that is inside out is reversed."""
    vertices, triangles, closed = read_mesh(Path(file.path), file.name, file.where, file.up)
    return vertices, outward(vertices, triangles) if closed else triangles, closed


def _refuse_walls(mass: SlidingMass, is_sheet: bool) -> None:
    """Raise E215 for a sheet that ends within the ground: the mass would have upright walls without resistance."""
    walls = mass.triangles[(mass.face_kinds != SLIP) & (mass.face_kinds != GROUND)]
    if not is_sheet or len(walls) == 0:
        return
    a, b, c = (mass.vertices[walls[:, k]] for k in range(3))
    area = float(np.sqrt((np.cross(b - a, c - a) ** 2).sum(axis=1)).sum()) / 2.0
    if area > 1e-6 * mass.area:
        message = f"the slip surface ends within the ground: {area:.4g} m² of the mass would hang in the air"
        raise GeometryError(
            [
                Fault(
                    "E215",
                    message,
                    "",
                    "Extend the sheet until it comes out at the ground surface.",
                )
            ]
        )


def _loads(design: SurfaceDesign, mass: SlidingMass, pairs: NodePairs) -> Loads:
    active, passive = bolt_forces(design, mass.origin, partial(mass_exit, mass))
    pushes = {}
    if design.water.mode == "pressures":
        shares = pairs.control_areas[:, None] * pairs.normals * design.water.pressures_kpa[0]
        couple = np.cross(pairs.points - mass.centroid, shares).sum(axis=0)
        pushes[f"water {SLIP}"] = PointForce(shares.sum(axis=0), None, couple)
    elif design.water.has_table:
        pushes = pushes_of(design, mass)
    return block_loads(
        _block(mass),
        design.rock.unit_weight_kn_m3,
        _seismic(design),
        [point_force(force, mass.origin) for force in design.forces],
        active,
        passive,
        pushes,
    )


def _seismic(design: SurfaceDesign) -> Floats:
    """Return the seismic load (3,) in parts of the weight; without a trend it acts down the profile."""
    coefficient, trend = design.seismic.coefficient, design.seismic.trend_deg
    if trend is not None and _shakes_sideways(design):
        return coefficient * Line(trend, 0.0).vector()
    return coefficient * np.array([_fall_direction(design), 0.0, 0.0])


def _fall_direction(design: SurfaceDesign) -> float:
    """Return 1 where the profile falls toward x, -1 where it rises."""
    if design.profile_m is None:
        return 1.0
    line = sorted(design.profile_m)
    return 1.0 if line[-1][1] <= line[0][1] else -1.0


# -- water ------------------------------------------------------------------------------------------------------------


def water_of(design: SurfaceDesign) -> Pressure:
    """Return the water pressure of a design, in the coordinates of the design."""

    def at_depth(depth: float) -> tuple[Height, ...]:
        places, levels = zip(*along_x(design.profile_m or ()), strict=True)
        return table_through_points(_X_AXIS, places, [level - depth for level in levels])

    return pressure_below(design, _X_AXIS, 0.0, at_depth)


def pushes_of(design: SurfaceDesign, mass: SlidingMass) -> dict[str, PointForce]:
    """Return the water forces on the slip surface, and of a pond on the ground: at the centroid, with their couples.

    Between the facets and an analytic surface lies a sliver of ground. There, too, the pressure is hydrostatic: on the
    surface itself presses what presses on the facets, and γ_w times the sliver, upward, by the share of the facets that
    is wet. So a drowned mass has its buoyant weight to the last digit.

    Raises
    ------
    GeometryError
        E456 the table lies above the ground.
    """
    water, vertices = water_of(design), mass.vertices + mass.origin
    ground, slip = (vertices[mass.triangles[mass.face_kinds == face]] for face in (GROUND, SLIP))
    raise_misfit(table_above_ground(design, water, ground[None], float(np.ptp(vertices[:, 2]))))
    centre = mass.centroid + mass.origin
    force, couple, wet = _water_on_facets(water, slip, centre)
    volume, moment = volume_moments(mass.vertices, mass.triangles)
    sliver, first = mass.volume - volume, mass.volume * mass.centroid - moment
    lift = np.array([0.0, 0.0, water.unit_weight * wet])
    loads = {
        f"water {SLIP}": PointForce(
            force + sliver * lift, None, couple + cross(first - sliver * mass.centroid, lift)
        )
    }
    if water.pond is not None:
        force, couple, _ = _water_on_facets(
            Pressure((), water.pond, water.unit_weight), ground, centre
        )
        loads[f"water {GROUND}"] = PointForce(force, None, couple)
    return loads


def _water_on_facets(
    water: Pressure, facets: Floats, centre: Floats
) -> tuple[Floats, Floats, float]:
    """Return force (3,) kN, couple (3,) kNm about a point, and wet fraction of the area of triangles (n, 3, 3)."""
    areas = cross(facets[:, 1] - facets[:, 0], facets[:, 2] - facets[:, 0]) / 2.0
    sizes = np.sqrt((areas * areas).sum(axis=1))
    thrusts, points = water.resultants(facets)
    is_wet = (thrusts > 0.0) & (sizes > 0.0)
    pushes = -(thrusts / np.where(is_wet, sizes, np.inf))[:, None] * areas
    wet, total = float(sizes[is_wet].sum()), float(sizes.sum())
    return (
        pushes.sum(axis=0),
        cross(points - centre, pushes).sum(axis=0),
        wet / total if total else 0.0,
    )


# -- closed forms -------------------------------------------------------------------------------------


def closed_form(design: SurfaceDesign, block_cut: Cut) -> ClosedForm:
    """Return the exact solution where there is one (φ = 0, rotation about an axis), and the methods of columns."""
    rotation, methods, notes = None, dict[str, float | None](), list[Notice]()
    geometry = block_cut.geometry()
    is_whole = isinstance(geometry, SurfaceGeometry) and not geometry.pieces_m3
    reason = _why_no_columns(design, is_whole)
    try:
        if is_whole and not (design.forces or design.bolts or design.water.pond_m is not None):
            rotation = _rotation(design)
        if not reason:
            methods = _columns(design, notes)
    except GeometryError as error:  # ground that turns back over itself has no columns
        rotation, methods, reason = None, {}, error.faults[0].message
    if reason:
        notes.append(Notice("W324", f"the methods of columns are left out: {reason}"))
    none = ClosedForm(
        None, "", "there is no closed form of this surface: the upper bound alone is beside it"
    )
    return replace(rotation or none, methods=methods, notices=notes)


def _why_no_columns(design: SurfaceDesign, is_whole: bool) -> str:
    """Return in words why the methods of columns do not take a design; empty where they do."""
    reasons = {
        "they take one cohesion and friction angle": design.strength.law is not None,
        "they know no pond": design.water.pond_m is not None,
        "they know no forces and bolts": bool(design.forces or design.bolts),
        "they take analytic surfaces below a profile": design.slip.shape == "mesh"
        or design.profile_m is None,
        "the seismic load has a direction of its own": _shakes_sideways(design),
        "they would count all pieces together": not is_whole,
    }
    return next((reason for reason, holds in reasons.items() if holds), "")


def _rotation(design: SurfaceDesign) -> ClosedForm | None:
    """Return the exact solution of a surface of revolution about the y axis with φ = 0, None for any other surface."""
    strength, slip, profile = design.strength, design.slip, design.profile_m
    round_ = slip.shape != "mesh" and math.isclose(slip.radii_m[0], slip.radii_m[2], rel_tol=1e-12)
    if (
        strength.law is not None
        or not (profile and round_ and strength.friction_angle_deg == 0.0)
        or _shakes_sideways(design)
    ):
        return None
    rotation = rotational_failure(
        slip.centre_m,
        slip.radii_m[0],
        slip.radii_m[1],
        profile,
        strength.cohesion_kpa,
        design.rock.unit_weight_kn_m3,
        "cylinder" if slip.shape == "cylinder" else "ellipsoid",
        seismic=float(_seismic(design)[0]),
    )
    return ClosedForm(rotation.factor, rotation.status)


def _shakes_sideways(design: SurfaceDesign) -> bool:
    """Return whether the seismic load acts in another direction than down the slope."""
    trend = design.seismic.trend_deg
    return (
        trend is not None
        and design.seismic.coefficient != 0.0
        and trend != (90.0 if _fall_direction(design) > 0 else 270.0)
    )


def _columns(design: SurfaceDesign, notes: list[Notice]) -> dict[str, float | None]:
    """Return the factors of the methods of columns by name; their notices are added to `notes`."""
    slip, profile = design.slip, design.profile_m
    assert profile is not None
    x, y, z = slip.centre_m
    if slip.shape == "cylinder":
        columns = lem.cylinder_columns(
            (x, z), slip.radii_m[0], 2.0 * slip.radii_m[1], profile, design.rock.unit_weight_kn_m3
        )
        y = 0.0  # the cylinder's columns lie about it
    else:
        columns = lem.ellipsoid_columns(
            slip.centre_m, slip.radii_m, profile, design.rock.unit_weight_kn_m3
        )
    if columns.overhung_share > _OVERHUNG:
        share = f"{columns.overhung_share * 100:.1f} % of the weight hangs under the slip surface"
        notes.append(
            Notice(
                "W324",
                f"{share}: the columns carry it, that part of the surface holds nothing in them",
            )
        )
    if design.water.has_table:
        columns = replace(columns, pore_pressure=water_of(design).pressure(columns.base_points))
    if design.water.mode == "pressures":
        columns = replace(
            columns, pore_pressure=np.full_like(columns.weights, design.water.pressures_kpa[0])
        )
    along, axis = np.array([_fall_direction(design), 0.0]), np.array([x, y, z])
    inputs = (
        columns,
        design.strength.cohesion_kpa,
        design.strength.friction_angle_deg,
        along,
        axis,
    )
    seismic = design.seismic.coefficient
    bishop = lem.bishop(*inputs, seismic=seismic)
    if bishop is not None and bishop > _NOT_DRIVEN:
        return {}
    return {
        "fellenius": lem.fellenius(*inputs, seismic=seismic),
        "janbu": lem.janbu(*inputs, seismic=seismic),
        "bishop": bishop,
    }


def _notices(
    design: SurfaceDesign, block_cut: Cut, solution: FoundLimit, closed: ClosedForm
) -> Iterator[Notice]:
    geometry = block_cut.geometry()
    assert isinstance(geometry, SurfaceGeometry)
    misfit = 0.0 if solution.limit.outcome is Outcome.NO_DRIVING_FORCE else geometry.misfit_deg
    if design.strength.dilation_deg:
        message = "a curved surface cannot dilate evenly: its dilation is not counted"
        yield Notice("W310", message)
    if misfit > FARTHEST_DEG:
        message = f"no motion follows this surface within {misfit:.1f}°: it must dilate to slip, and the limit says so"
        yield Notice("W325", message)
    elif misfit > 0.5:
        message = (
            f"the normals were turned by {misfit:.2g}° (root mean square) to let the mass slip without dilating: the "
            "surface itself opens by that"
        )
        yield Notice("W325", message)
    low, high = geometry.vertices_m.min(axis=0), geometry.vertices_m.max(axis=0)
    if design.profile_m is not None:
        ends = [x for x, _ in design.profile_m]
        distance = float(max(min(ends) - low[0], high[0] - max(ends)))
        if distance > 1e-6 * (high[0] - low[0]):
            message = f"the mass reaches {distance:.4g} m beyond the profile, where the ground is taken as level"
            yield Notice("W322", message)
    if geometry.pieces_m3:
        message = (
            f"the slip surface cuts {len(geometry.pieces_m3) + 1} pieces off: the largest is analysed, "
            f"{sum(geometry.pieces_m3):.4g} m³ are left out"
        )
        yield Notice("W322", message)
    if design.water.pond_m is not None and design.water.pond_m <= low[2]:
        yield Notice(
            "W419",
            f"the pond stands at {number_text(design.water.pond_m)} m, below the mass: it wets nothing",
        )
    for rule in (
        design.rules
    ):  # that the limit meets and a method of columns does not is worth a second look
        below = [
            f"{name.capitalize()} {value:.3f}"
            for name, value in closed.methods.items()
            if value is not None
            and name in ("bishop", "janbu", "fellenius")
            and not rule.is_met_by(value)
        ]
        if rule.is_on_factor and rule.is_met_by(solution.limit.factor) and below:
            yield Notice("W324", f"the limit meets {rule}, {', '.join(below)} would not")
    yield from closed.notices


# -- what check looks at ----------------------------------------------------------------------------------------------


class OnSurface(SingleBlock[SurfaceDesign]):
    """The kind of a mass on a curved slip surface, whose node pairs are cut again for each mesh."""

    def finer(self, design: SurfaceDesign, result: Result, block_cut: Cut) -> "Iterator[Rung]":
        """Yield the limit for edges four times as long as the design's, to half as long; a mesh file is what it is.

        What has too many node pairs, and edges too coarse to cut this mass, are left out.
        """
        from slopekit.kinds.single_block.ladders import MOST_PAIRS, limit_rung

        if design.slip.shape == "mesh":
            return
        geometry = result.geometry
        rungs: list[Rung] = []
        assert isinstance(geometry, SurfaceGeometry)
        for level, times in enumerate(_EDGE_RATIOS):
            if result.model.node_pairs / times**2 > MOST_PAIRS:
                break
            edge_m = times * geometry.edge_m
            report_stage(f"edges of {edge_m:.3g} m", head=True)
            try:
                block_cut = self.cut(
                    replace(design, slip=replace(design.slip, edge_m=_EDGE_MARGIN * edge_m))
                )
            except (DesignError, GeometryError):
                continue
            meshed, scene = block_cut.geometry(), block_cut.scene_at(0)
            assert isinstance(meshed, SurfaceGeometry)
            if (
                rungs and len(scene.pairs) == rungs[-1].node_pairs
            ):  # the coarsest mesh there is, once more
                rungs.pop()
            rung = limit_rung(scene, pairs_limit, f"edges of {edge_m:.3g} m", level)
            rungs.append(replace(rung, edge_m=meshed.edge_m))
        yield from rungs


def _slope(design: SurfaceDesign, result: Result) -> list[Section]:
    geometry = result.geometry
    assert isinstance(geometry, SurfaceGeometry)
    area = short(geometry.areas_m2["slip surface"])
    ground = (
        f"ground mesh {design.ground_mesh.label}"
        if design.ground_mesh is not None
        else "ground profile " + " ".join(map(coordinates, design.profile_m or ()))
    )
    rigid = {0: "no rigid motion fits", 1: "one rigid motion fits"}.get(
        geometry.motions, f"{geometry.motions} rigid motions fit"
    )
    misfit = (
        f"; normals turned by {geometry.misfit_deg:.2g}° to fit one" if geometry.misfit_deg else ""
    )
    entries = [
        f"{design.slip.in_words()}  {strength_in_words(design.strength)}  area {area} m²",
        f"{geometry.normals} normals, mesh edges {geometry.edge_m:.3g} m; {rigid} the surface{misfit}",
        ground,
    ]
    return slope_sections(result, Section("SURFACE", entries), water_in_words(result))


WORDS = Words(
    "mass on a curved slip surface",
    "mass",
    "the way the profile falls",
    "closed form (φ = 0, turning about its axis)",
    "φ = 0, turning about its axis",
    {
        "slides_on_J1": "slides on its slip surface without turning",
        "rotates": "turns on its slip surface",
        "lifted": "contact lost on its slip surface (uplift)",
    },
    no_closed_form="there is none for this surface; judge by bound and columns",
    assumes=" (normal stresses of a rigid mass on an even elastic bed)",
    turns=False,
)
KIND = OnSurface(SurfaceDesign, read_surface, WORDS, cut, closed_form, _slope, _notices)
