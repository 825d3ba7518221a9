"""A mass on a curved slip surface: from its design to its result."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from slopekit.analysis.scene import Scene
from slopekit.analysis.stages import (
    Clock,
    ClosedForm,
    Solved,
    block_status,
    bolt_forces,
    driving_and_resisting,
    joint_strength,
    normal_forces,
    point_force,
    result,
    solve,
)
from slopekit.arrays import Floats, frozen
from slopekit.closed_form import columns as lem
from slopekit.closed_form.rotation import rotational_failure
from slopekit.design.kinds import SurfaceDesign
from slopekit.errors import Fault, GeometryError, Notice
from slopekit.extents import SurfaceGeometry
from slopekit.geometry.cutting import Block
from slopekit.geometry.interfaces import NodePairs
from slopekit.geometry.meshes import read_mesh
from slopekit.geometry.shapes import GROUND, SLIP, Cutter, Cylinder, Ellipsoid, profile_prism, sheet_solid
from slopekit.geometry.sliding_mass import SlidingMass, analytic_mass, cut_mass, facet_pairs, halvings, through
from slopekit.loads import Loads, PointForce, block_loads, judge_bolt
from slopekit.notices import Interface
from slopekit.orientation import Line
from slopekit.preie.limit import curved_limit_analysis
from slopekit.preie.model import build_model
from slopekit.preie.passes import Outcome
from slopekit.preie.slippage import Slippage, slippable
from slopekit.result import Forces, Result

NAME = "slip surface"
_FAR_M = 1e4
_LEVEL_OF_FACETS = 4
_COARSEST = 2  # level from which the wanted edge is reached by halving
_NOT_DRIVEN = 1e6  # a factor beyond this is that of level ground
_OVERHUNG = 1e-6  # of the weight
_TENSION = 0.2  # of the base: beyond that the normal stresses assumed are not to be trusted


@dataclass(frozen=True, slots=True)
class _Cut:
    """The mass with its node pairs, in coordinates about `origin`; `grain` (m): what its mesh files round to."""

    mass: SlidingMass
    pairs: NodePairs
    origin: Floats
    grain: float


def analyse_surface(design: SurfaceDesign) -> Result:
    """Cut the mass, find its factor of safety by PRE-IE and by the closed forms there are.

    Raises
    ------
    GeometryError
        Where slip surface and ground make no mass that can move.
    """
    clock = Clock()
    with clock("cut"):
        cut = _cut(design)
        mass = cut.mass
        loads = _loads(design, cut)
    with clock("normals"):
        slip, scene = _scene(design, cut, loads)
    with clock("closed_form"):
        closed, methods, extra = _closed_forms(design, cut)
    solved = solve(design, lambda refine: scene, 0, clock, curved_limit_analysis, most_refined=0)
    status = block_status(solved.limit, solved.analysis, scene, (SLIP,))
    if status in ("slides_on_J1", "slides_up") and _turns(solved.limit.velocity):
        status = "rotates"
    water = {NAME: 0.0} if "water" not in loads.parts else {NAME: float(np.linalg.norm(loads.parts["water"]))}
    forces = Forces(
        float(-loads.parts["weight"][2]),
        normal_forces(solved, {SLIP: NAME}),
        water,
        *(driving_and_resisting(solved) if status != "rotates" else (None, None)),
    )
    misfit = 0.0 if design.slip.normals == "facet" else slip.misfit_deg
    geometry = SurfaceGeometry(
        mass.volume, float(np.ptp(mass.vertices[:, 2])), {NAME: mass.area}, frozen(mass.centroid + cut.origin),
        mass.edge, design.slip.normals, slip.motions, misfit, mass.pieces, frozen(mass.vertices + cut.origin),
        mass.triangles, mass.on == SLIP,
    )  # fmt: skip
    left_out = ["bedrock (no unknowns)", "ground surface (free)", "deformation of the mass"]
    if design.slip.shape == "cylinder":
        left_out.append("strength at the two ends of the cylinder")
    if mass.pieces:
        left_out.append(f"{len(mass.pieces)} smaller pieces within the slip surface, {sum(mass.pieces):.4g} m³")
    moves = solved.limit.outcome is not Outcome.NO_DRIVING_FORCE
    told = _notices(design, cut, misfit if moves else 0.0, slip.left_as_it_was and moves)
    notes = [*told, *_columns_below(design, solved, methods), *extra]
    return result(
        design, solved, status, closed, geometry, forces, [Interface(SLIP, NAME, design.strength)], left_out, clock,
        methods=methods, extra=notes, to_map=cut.origin, loads=loads,
    )  # fmt: skip


def prepare(design: SurfaceDesign) -> Scene:
    """The stages before the solver, from a design to its node pairs and its model."""
    return prepare_meshed(design)[0]


def prepare_meshed(design: SurfaceDesign) -> tuple[Scene, float]:
    """The same, with the mean edge (m) of the triangles on the slip surface."""
    cut = _cut(design)
    return _scene(design, cut, _loads(design, cut))[1], cut.mass.edge


def _scene(design: SurfaceDesign, cut: _Cut, loads: Loads) -> tuple[Slippage, Scene]:
    slip = slippable(cut.pairs, cut.mass.centroid, np.concatenate([loads.force, loads.moment]))
    pairs = cut.pairs if design.slip.normals == "facet" else slip.pairs
    return slip, Scene(pairs, build_model(pairs, loads, cut.mass.centroid, joint_strength([design.strength])))


def _turns(velocity: Floats) -> bool:
    return float(velocity[3:] @ velocity[3:]) > 1e-6 * float(velocity @ velocity)


def _cut(design: SurfaceDesign) -> _Cut:
    slip = design.slip
    ground_mesh = slip_mesh = None
    if design.ground_mesh is not None:
        ground_mesh = read_mesh(Path(design.ground_mesh.path), design.ground_mesh.name, design.ground_mesh.where)
        if not ground_mesh[2]:
            name = design.ground_mesh.name
            advice = "Close its holes (every edge belongs to two triangles) and save it again."
            raise GeometryError([Fault("E216", f"the mesh {name} of the slope is not closed", "", advice)])
    if slip.mesh is not None:
        slip_mesh = read_mesh(Path(slip.mesh.path), slip.mesh.name, slip.mesh.where)
    if slip_mesh is None:
        origin = np.array(slip.centre_m)
        radii = np.array(slip.radii_m)
        shape = Cylinder(float(radii[0]), 2.0 * float(radii[1])) if slip.shape == "cylinder" else Ellipsoid(radii)
        body = shape.cutter(_LEVEL_OF_FACETS)
    else:
        origin = (slip_mesh[0].min(axis=0) + slip_mesh[0].max(axis=0)) / 2.0
        body = Cutter(slip_mesh[0] - origin, slip_mesh[1], np.full(len(slip_mesh[1]), SLIP))
    lowest, highest = body.vertices.min(axis=0), body.vertices.max(axis=0)
    size = float((highest - lowest).max())
    if ground_mesh is not None:
        ground = Cutter(ground_mesh[0] - origin, ground_mesh[1], np.full(len(ground_mesh[1]), GROUND))
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
            body = shape.cutter(_COARSEST + halvings(cut_mass(ground, shape.cutter(_COARSEST)), slip.edge_m))
        mass = cut_mass(ground, body)
        pairs = facet_pairs(mass, body, slip.normals)
    _refuse_walls(mass, slip_mesh is not None)
    grain = max(_grain(mesh[0]) for mesh in (ground_mesh, slip_mesh) if mesh) if ground_mesh or slip_mesh else 0.0
    return _Cut(mass, pairs, origin, grain)


def _grain(vertices: Floats) -> float:
    """What single precision, which STL files have, rounds these coordinates to (m); 0 in double precision."""
    single = vertices.astype(np.float32)
    rounded = (single == vertices).all() and not (vertices == vertices.round()).all()
    return float(np.spacing(np.abs(single).max())) if rounded else 0.0


def _refuse_walls(mass: SlidingMass, is_sheet: bool) -> None:
    """A sheet that ends within the ground leaves upright walls that hold nothing."""
    walls = mass.triangles[(mass.on != SLIP) & (mass.on != GROUND)]
    if not is_sheet or len(walls) == 0:
        return
    a, b, c = (mass.vertices[walls[:, k]] for k in range(3))
    area = float(np.sqrt((np.cross(b - a, c - a) ** 2).sum(axis=1)).sum()) / 2.0
    if area > 1e-6 * mass.area:
        message = f"the slip surface ends within the ground: {area:.4g} m² of the mass would hang in the air"
        raise GeometryError([Fault("E215", message, "", "Extend the sheet until it comes out at the ground surface.")])


def _loads(design: SurfaceDesign, cut: _Cut) -> Loads:
    mass, pairs = cut.mass, cut.pairs

    def check(name: str, head: Floats, way: Floats, length: float | None, where: str) -> None:
        leaves, anchored = through(mass, head, way)
        judge_bolt(name, leaves, anchored, length, where)

    block = Block({}, {SLIP: mass.area}, mass.volume, mass.centroid)
    active, passive = bolt_forces(design, cut.origin, check)
    pushes = {}
    if design.water.mode == "pressures":
        shares = pairs.control_areas[:, None] * pairs.normals * design.water.pressures_kpa[0]
        couple = np.cross(pairs.points - mass.centroid, shares).sum(axis=0)
        pushes["water"] = PointForce(shares.sum(axis=0), None, couple)
    return block_loads(
        block, design.unit_weight_kn_m3, {}, _seismic(design),
        [point_force(force, cut.origin) for force in design.forces], active, passive, pushes,
    )  # fmt: skip


def _seismic(design: SurfaceDesign) -> Floats:
    """(3,) parts of the weight; without a trend the way the profile falls."""
    coefficient, trend = design.seismic.coefficient, design.seismic.trend_deg
    if trend is not None:
        return coefficient * Line(trend, 0.0).vector()
    return coefficient * np.array([_falls(design), 0.0, 0.0])


def _falls(design: SurfaceDesign) -> float:
    """1 where the profile falls toward x, -1 where it rises."""
    if design.profile_m is None:
        return 1.0
    line = sorted(design.profile_m)
    return 1.0 if line[-1][1] <= line[0][1] else -1.0


# -- closed forms -------------------------------------------------------------------------------------


def _closed_forms(
    design: SurfaceDesign, cut: _Cut
) -> tuple[ClosedForm, dict[str, float | None], list[Notice]]:  # fmt: skip
    """The exact answer where there is one (φ = 0, turning about an axis), and the methods of columns."""
    plain = not (design.forces or design.bolts) and design.strength.law is None
    rest: list[Notice] = []
    if design.strength.law is not None:
        rest.append(Notice("W324", "the methods of columns are left out: they take one cohesion and friction angle"))
    elif not plain:
        rest.append(Notice("W324", "the methods of columns are left out: they know no forces and bolts"))
    try:
        rotation = _rotation(design, cut) if plain else None
        methods = _columns(design, cut, rest) if plain else {}
    except GeometryError as error:  # ground that turns back over itself has no columns
        rest.append(Notice("W324", f"the methods of columns are left out: {error.faults[0].message}"))
        rotation, methods = None, {}
    if rotation is not None:
        return rotation, methods, rest
    return ClosedForm(None, "", "there is no closed form of this surface: judge by the static bound"), methods, rest


def _rotation(design: SurfaceDesign, cut: _Cut) -> ClosedForm | None:
    """The exact answer of a surface of revolution about the y axis with φ = 0, None for any other."""
    strength, slip, profile = design.strength, design.slip, design.profile_m
    round_ = slip.shape != "mesh" and math.isclose(slip.radii_m[0], slip.radii_m[2], rel_tol=1e-12)
    if (
        strength.law is not None
        or not (profile and round_ and strength.friction_angle_deg == 0.0)
        or _sideways(design)
        or cut.mass.pieces
    ):
        return None
    found = rotational_failure(
        slip.centre_m, slip.radii_m[0], slip.radii_m[1], profile, strength.cohesion_kpa, design.unit_weight_kn_m3,
        "cylinder" if slip.shape == "cylinder" else "ellipsoid", seismic=float(_seismic(design)[0]),
    )  # fmt: skip
    return ClosedForm(found.factor, found.status, _why_not(design))


def _sideways(design: SurfaceDesign) -> bool:
    return design.seismic.trend_deg is not None and design.seismic.coefficient != 0.0


def _why_not(design: SurfaceDesign) -> str:
    if design.strength.dilation_deg:
        return "the closed form knows no dilation: it is printed, not compared"
    return "the closed form turns on the true surface" if design.slip.normals == "facet" else ""


def _columns(design: SurfaceDesign, cut: _Cut, notes: list[Notice]) -> dict[str, float | None]:
    """Factors of the methods of columns; what there is to say of them goes to `notes`."""
    slip = design.slip
    if slip.shape == "mesh" or design.profile_m is None:
        notes.append(Notice("W324", "the methods of columns take analytic surfaces below a profile: none here"))
        return {}
    if _sideways(design):
        notes.append(Notice("W324", "the methods of columns are left out: the seismic load has a direction of its own"))
        return {}
    if cut.mass.pieces:
        notes.append(Notice("W324", "the methods of columns are left out: they would count all pieces together"))
        return {}
    x, y, z = slip.centre_m
    if slip.shape == "cylinder":
        made = lem.cylinder_columns(
            (x, z), slip.radii_m[0], 2.0 * slip.radii_m[1], design.profile_m, design.unit_weight_kn_m3
        )
        y = 0.0  # the cylinder's columns lie about it
    else:
        made = lem.ellipsoid_columns(slip.centre_m, slip.radii_m, design.profile_m, design.unit_weight_kn_m3)
    if made.overhung_share > _OVERHUNG:
        share = f"{made.overhung_share * 100:.1f} % of the weight hangs under the slip surface"
        notes.append(Notice("W324", f"{share}: the columns carry it, that part of the surface holds nothing in them"))
    if design.water.mode == "pressures":
        made = replace(made, pore_pressure=np.full_like(made.weights, design.water.pressures_kpa[0]))
    along, axis = np.array([_falls(design), 0.0]), np.array([x, y, z])
    inputs = (made, design.strength.cohesion_kpa, design.strength.friction_angle_deg, along, axis)
    seismic = design.seismic.coefficient
    bishop = lem.bishop(*inputs, seismic=seismic)
    if bishop is not None and bishop > _NOT_DRIVEN:
        return {}
    whole = lem.global_equilibrium(*inputs, seismic=seismic)
    if whole is not None and whole.tension_share > _TENSION:
        pulled = f"{whole.tension_share * 100:.0f} % of the base would have to pull"
        notes.append(Notice("W324", f"the method of all equilibrium is left out: {pulled}"))
        whole = None
    return {
        "fellenius": lem.fellenius(*inputs, seismic=seismic),
        "janbu": lem.janbu(*inputs, seismic=seismic),
        "bishop": bishop,
        "all_equilibrium": None if whole is None else whole.factor,
    }


def _columns_below(design: SurfaceDesign, solved: Solved, methods: Mapping[str, float | None]) -> list[Notice]:
    """A rule that the limit meets and a method of columns does not is worth a second look."""
    limit = solved.limit.factor
    found = []
    for rule in design.rules:
        below = [f"{name.capitalize()} {value:.3f}" for name, value in methods.items()
                 if value is not None and name in ("bishop", "janbu", "fellenius") and not rule.met(value)]  # fmt: skip
        if rule.name in ("fos", "fos.limit") and rule.met(limit) and below:
            found.append(Notice("W330", f"the limit meets {rule}, {', '.join(below)} would not"))
    return found


def _notices(design: SurfaceDesign, cut: _Cut, misfit: float, left: bool) -> list[Notice]:
    found = []
    if design.slip.normals == "facet":
        message = "facet normals interlock like a ratchet, facets that open lose cohesion: a study, not an answer"
        found.append(Notice("W326", message))
    elif left:
        message = f"no motion follows this surface within {misfit:.1f}°: it must dilate to slip, and the limit says so"
        found.append(Notice("W325", message))
    elif misfit > 0.5:
        message = (
            f"the normals were turned by {misfit:.2g}° (root mean square) to let the mass slip without dilating: the "
            "surface itself opens by that"
        )
        found.append(Notice("W325", message))
    if design.profile_m is not None:
        ends = [x for x, _ in design.profile_m]
        low, high = (float(cut.mass.vertices[:, 0].min()), float(cut.mass.vertices[:, 0].max()))
        beyond = max(min(ends) - low - float(cut.origin[0]), high + float(cut.origin[0]) - max(ends))
        if beyond > 1e-6 * (high - low):
            message = f"the mass reaches {beyond:.4g} m beyond the profile, where the ground is taken as level"
            found.append(Notice("W331", message))
    if cut.mass.pieces:
        message = (
            f"the slip surface cuts {len(cut.mass.pieces) + 1} pieces off: the largest is analysed, "
            f"{sum(cut.mass.pieces):.4g} m³ are left out"
        )
        found.append(Notice("W322", message))
    if float(np.abs(cut.origin).max()) > _FAR_M:
        message = "map coordinates: computed about the slip surface and put back, no digits lost"
        if cut.grain:
            message = (
                f"map coordinates in a mesh file of single precision: its corners are rounded to {cut.grain:.2g} m"
            )
        found.append(Notice("W305", message))
    return found
