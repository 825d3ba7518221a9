"""Elastic blocks of a design: meshes and flexibility, their joints in arrays, the rigid limits beside them."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints, frozen
from slopekit.core.errors import DesignError, Fault
from slopekit.core.records import dataclass
from slopekit.design.common import Design
from slopekit.elastic.flexibility import CondensedBlock, Elements, Flexibility, Rock, body, flexibility
from slopekit.elastic.meshing import (
    cells_of,
    edges_of,
    fanned,
    is_convex,
    is_convex_outline,
    mesh_of,
    numbered,
    split_evenly,
)
from slopekit.elastic.model import ElasticModel, dense_or_sparse, with_blocks
from slopekit.kinds.assemblies.many_blocks_scene import AssemblyScene, scene_loads
from slopekit.kinds.single_block.one_block import Cut
from slopekit.kinds.solver_inputs import joint_stiffness, joint_strength
from slopekit.preie.system.assembly import section_axes
from slopekit.preie.system.contact import SHEAR_TO_NORMAL, CloughDuncan, JointStiffness
from slopekit.preie.system.model import Model, local_axes
from slopekit.result import Result

MODULUS_KPA, POISSON = 2e7, 0.25
ORDER = 2
_MOST_BLOCKS, _MOST_PAIRS, _MOST_OF_MANY = 300, 1500, 12_000
_MOST_CELLS, _AUTO_CELLS = 20_000, 1500  # of all blocks; of one with `edge: auto`
_HALVED = {"one": 3, "section": 2, "space": 1}  # how often the longest edge of a block is halved, `edge: auto`
_FEW = 50  # blocks in space; of more the edges are not halved
_MOST_REFINED = 5
_WITHOUT = 0.4  # of the work of one analysis, for the limit without what is open; the rest is the elastic blocks' own


@dataclass(frozen=True, slots=True)
class ElasticScene:
    """Elastic blocks in arrays, and what the rigid code makes of them.

    Attributes
    ----------
    redrawn : tan φ of the pairs at normal forces (n,) kN where laws are curved, None where none is
    limit_without : the rigid limit without the cohesion of pairs (n,), and whether there is none for want of work
    points, normals : (n, 3) in the user's axes; joint : (n,) names; axes : rows are the local axes
    names : of the blocks, empty of one; unknowns : of each block
    bound_without : of many blocks, the static bound without the bonds of pairs (n,), None where it bounds nothing
    """

    model: ElasticModel
    stiffness: JointStiffness
    redrawn: Callable[[Floats], Floats] | None
    rigid_limit: float | None
    limit_without: Callable[[Bools], tuple[float | None, bool]]
    points: Floats
    normals: Floats
    joint: Sequence[str]
    axes: Floats
    names: Sequence[str]
    unknowns: int
    length: float
    edge: float
    blocks: Sequence[Flexibility | CondensedBlock]
    bound_without: Callable[[Bools], float | None] | None = None


def elastic_stiffness(design: Design, many: bool) -> JointStiffness:
    """The design's, with a constant in place of Clough and Duncan's hyperbola: k₁ γ_w, of many blocks that of the path.

    With the paper's parameters the hyperbola cannot reach the strength of a joint pressed by less than 43 kPa, which
    elastic blocks have along their edges.
    """
    given = joint_stiffness(design)
    law = given.tangential
    if not isinstance(law, CloughDuncan):
        return given
    shear = SHEAR_TO_NORMAL * given.normal if many else law.modulus_number * law.water_unit_weight
    return replace(given, tangential=shear)


def rock_of(design: Design) -> tuple[Rock, tuple[str, ...]]:
    """The rock, and what of it was not given."""
    given = {"modulus": design.modulus_kpa, "poisson": design.poisson}
    taken = tuple(name for name, value in given.items() if value is None)
    return Rock(design.modulus_kpa or MODULUS_KPA, POISSON if design.poisson is None else design.poisson, ORDER), taken


def _meshed(mesh: Any, edge: float, name: str) -> Any:
    """A mesh with no edge longer than `edge`; E125 where that are too many elements."""
    cells = mesh.t.shape[1] * (2.0 ** len(mesh.p)) ** _times(mesh, edge)
    if cells > _MOST_CELLS:
        message = f"edges of {edge:.4g} m make {cells:.3g} finite elements of {name}, at most {_MOST_CELLS} are taken"
        raise DesignError([Fault("E125", message, "analysis.elastic.edge", "Give a longer edge, or auto.")])
    return split_evenly(mesh, edge)


def _times(mesh: Any, edge: float) -> int:
    """How often the edges of a mesh are halved until none is longer than `edge`."""
    return max(0, math.ceil(math.log2(float(edges_of(mesh).max()) / edge * (1.0 - 1e-9))))


def _auto(mesh: Any, halved: int) -> float:
    """The longest edge of elements that is taken where none is given: fewer are taken of a body of many faces."""
    while halved > 0 and mesh.t.shape[1] * 2 ** (len(mesh.p) * halved) > _AUTO_CELLS:
        halved -= 1
    return math.ldexp(float(edges_of(mesh).max()), -halved)


def _refuse(why: str, advice: str = "Leave --elastic out.") -> DesignError:
    return DesignError([Fault("E288", f"no elastic blocks of this design: {why}", "--elastic", advice)])


def scene_of_one(design: Design, made: Cut) -> ElasticScene:
    """A convex block on flat joints."""
    (rock, _), block = rock_of(design), made.block
    if not made.loads.parts["weight"].any():
        raise _refuse("the block has no weight, and what loads it stands on its surface")
    coarse = made.scene_at(0)
    if coarse.bedding is None:
        raise _refuse("the block lies on a curved surface, and is not convex")
    in_section = coarse.model.translations == 2
    points, faces = numbered(block.faces.values())
    if not is_convex(points, faces):
        raise _refuse("the block is not convex")
    if in_section:
        side = next(np.asarray(face) for face in block.faces.values() if np.ptp(np.asarray(face)[:, 1]) < 1e-9)
        outline = side[:, [0, 2]]
        mesh = mesh_of(outline, fanned([range(len(outline))]))
    else:
        mesh = mesh_of(points, cells_of(points, fanned(faces)))
    edge = design.elastic_edge_m or _auto(mesh, _HALVED["one"])
    joint_edge = max(float(np.sqrt((np.diff(corners, axis=0, append=corners[:1]) ** 2).sum(axis=1)).max())
                     for corners in map(np.asarray, coarse.bedding.polygons.values()))  # fmt: skip
    refine = max(made.refine, math.ceil(math.log2(joint_edge / edge * (1.0 - 1e-9))))
    scene = made.scene_at(min(max(refine, 0), _MOST_REFINED))
    if len(scene.pairs) > _MOST_PAIRS:
        message = f"edges of {edge:.4g} m make {len(scene.pairs)} node pairs, at most {_MOST_PAIRS} are taken"
        raise DesignError([Fault("E125", message, "analysis.elastic.edge", "Give a longer edge, or auto.")])
    elements, model = Elements(_meshed(mesh, edge, "the block"), rock), scene.model
    axes = local_axes(scene.pairs.normals)
    give = flexibility(elements, scene.pairs.points, axes, model.flat_rows, model.length_scale)
    rigid = made.limit(model)
    settled = rigid.model or model
    plain = elastic_model(settled)
    rows, own = np.arange(3 * len(scene.pairs)), np.arange(model.unknowns)
    whole = with_blocks(plain, ((give, rows, own),))
    turn = np.eye(3) if made.axes is None else made.axes

    def limit_without(parted: Bools) -> tuple[float | None, bool]:
        without = replace(settled, cohesion=frozen(settled.cohesion * ~parted))
        return made.limit(without).governing.factor or None, False

    def redrawn(normal: Floats) -> Floats:
        from slopekit.preie.system.strength_lines import drawn

        return drawn(settled, np.maximum(normal, 0.0) / settled.force_scale).tan_friction

    called = {interface.key: interface.name for interface in made.interfaces}
    return ElasticScene(
        whole, elastic_stiffness(design, False),
        None if settled.lines is None else redrawn, rigid.governing.factor or None, limit_without,
        scene.pairs.points @ turn + made.origin, scene.pairs.normals @ turn,
        [called[key] for key in scene.pairs.interface.tolist()], turn, (), model.unknowns, model.length_scale, edge,
        (give,),
    )  # fmt: skip


def elastic_model(model: Model) -> ElasticModel:
    """The rigid model of one block in kN, m and kPa."""
    area = model.control_area * model.area_scale
    per_area = model.force_scale / area
    return ElasticModel(
        model.flat_rows, model.load * model.force_scale, area, model.cohesion * per_area, model.tension * per_area,
        model.tan_friction, model.tan_dilation, model.bolt_rows, model.bolt_capacity * model.force_scale,
    )  # fmt: skip


# -- many blocks ------------------------------------------------------------------------------------------------------


def scene_of_many(design: Design, scene: AssemblyScene, result: Result) -> ElasticScene:
    """Convex blocks on flat contacts."""
    from slopekit.preie.many_blocks.blocks import bound_of
    from slopekit.preie.many_blocks.ravelling import ravel
    from slopekit.preie.solvers import work_limit
    from slopekit.preie.system.components import whole_model

    assembly, (rock, _) = scene.assembly, rock_of(design)
    moving = int((~assembly.fixed).sum())
    if moving > _MOST_BLOCKS:
        message = f"{moving} blocks move, elastic ones are at most {_MOST_BLOCKS}"
        raise DesignError([Fault("E125", message, "--elastic", "Leave --elastic out, or make the slope smaller.")])
    bodies = _bodies(scene)
    meshes = {block: bodies(block) for block in np.flatnonzero(~assembly.fixed).tolist()}
    halved = _HALVED["section"] if assembly.in_section else _HALVED["space"] * (moving <= _FEW)
    own_edges = {block: design.elastic_edge_m or _auto(mesh, halved) for block, mesh in meshes.items()}
    edge = float(np.median(list(own_edges.values())))
    halved_by = np.zeros(len(assembly) + 1, dtype=np.int64)  # bedrock last
    for block, mesh in meshes.items():
        halved_by[block] = _times(mesh, own_edges[block])
    levels = np.maximum(halved_by[assembly.patches.plus], halved_by[assembly.patches.minus])
    split, origin = _split(scene, 2**levels) if assembly.in_section else (scene, np.arange(len(assembly.patches)))
    strength, loads = joint_strength(scene.strengths), scene_loads(split)
    refine = None if assembly.in_section else np.minimum(levels, _MOST_REFINED)
    whole = whole_model(split.assembly, loads, strength, refine)
    if whole is None:
        raise _refuse("its blocks touch nothing")
    pairs = whole.joint_pairs.stop
    if pairs > _MOST_OF_MANY:
        message = f"{pairs} node pairs between elastic blocks, at most {_MOST_OF_MANY} are taken"
        raise DesignError([Fault("E125", message, "analysis.elastic.edge", "Give a longer edge, or fewer blocks.")])
    rows, bolt_rows = _rows(whole, pairs)
    contact = whole.pair_contact[:pairs]
    patch = whole.patch[contact]
    patches = split.assembly.patches
    plus, minus = whole.plus[contact], whole.minus[contact]
    turned = whole.moving[plus] != patches.plus[patch]
    normals = patches.normals[patch] * np.where(turned, -1.0, 1.0)[:, None]
    axes = section_axes(normals) if assembly.in_section else local_axes(normals)
    area = whole.control_area[:pairs] * whole.area_scale
    group = whole.group_of_pair[:pairs]
    bolted = slice(pairs, None)
    plain = ElasticModel(
        dense_or_sparse(rows), whole.load.ravel() * whole.force_scale, area,
        whole.cohesion[:pairs] * whole.force_scale / area, np.array(strength.tension)[patches.joint[patch]],
        whole.tan_friction[group], whole.tan_dilation[group], bolt_rows, whole.cohesion[bolted] * whole.force_scale,
    )  # fmt: skip
    flexible, cells = list[tuple[Flexibility | CondensedBlock, Ints, Ints]](), 0
    for k, block in enumerate(whole.moving.tolist()):
        own = np.flatnonzero((plus == k) | (minus == k))
        at = (3 * own[:, None] + np.arange(3)).ravel()
        unknowns = k * whole.unknowns + np.arange(whole.unknowns)
        mesh = _meshed(meshes[block], own_edges[block], scene.names[block])
        cells += mesh.t.shape[1]
        if cells > _MOST_CELLS:
            message = f"edges of {edge:.4g} m make more than {_MOST_CELLS} finite elements"
            raise DesignError([Fault("E125", message, "analysis.elastic.edge", "Give a longer edge, or auto.")])
        sides = np.where(plus[own] == k, 1.0, -1.0)[:, None, None] * axes[own]
        elements = Elements(mesh, rock, scene.thickness or 1.0)
        where, length = whole.points[own], whole.length_scale
        if plain.is_dense:
            part = plain.rows[at][:, unknowns]
            give: Flexibility | CondensedBlock = flexibility(elements, where, sides, part, length)
        else:
            give = body(elements, where, sides, length)
        flexible.append((give, at, unknowns))

    def limit_without(parted: Bools) -> tuple[float | None, bool]:
        lost = np.bincount(origin[patch], area * parted, len(assembly.patches))
        share = np.divide(lost, assembly.patches.areas, out=np.zeros_like(lost), where=assembly.patches.areas > 0.0)
        given = joint_strength(scene.strengths)
        joint = assembly.patches.joint
        if not (share * given.cohesion[joint]).any():
            return result.fos.limit, False
        each = replace(
            given, cohesion=given.cohesion[joint] * np.clip(1.0 - share, 0.0, 1.0),
            tan_friction=given.tan_friction[joint], tan_dilation=given.tan_dilation[joint],
            tension=given.tension[joint], laws=tuple(given.laws[k] for k in joint.tolist()) if given.laws else (),
        )  # fmt: skip
        own = replace(assembly, patches=replace(assembly.patches, joint=np.arange(len(joint))))
        with work_limit.allowed(_WITHOUT * work_limit.MOST):
            failures = ravel(own, scene_loads(scene), each, ranged=False).failures
        return (failures[0].limit.factor, failures[0].limit.spent) if failures else (None, False)

    def bound_without(parted: Bools) -> float | None:
        if whole.lines is not None or plain.tension.any() or plain.tan_dilation.any():
            return None  # forces of a rest are not those that it looks at
        kept = whole.cohesion.copy()
        kept[:pairs][parted] = 0.0
        return bound_of(replace(whole, cohesion=frozen(kept)))

    def redrawn(normal: Floats) -> Floats:
        from slopekit.preie.system.strength_lines import drawn

        scaled = np.append(np.maximum(normal, 0.0) / whole.force_scale, np.zeros(len(whole.bolts)))
        return drawn(whole, scaled).tan_friction[group]

    names = [scene.names[block] for block in whole.moving.tolist()]
    return ElasticScene(
        with_blocks(plain, tuple(flexible)), elastic_stiffness(design, True), None if whole.lines is None else redrawn,
        result.fos.limit, limit_without, whole.points[:pairs] + scene.origin, normals,
        [scene.joints[joint] for joint in patches.joint[patch].tolist()], np.eye(3), names, whole.unknowns,
        whole.length_scale, edge, [one for one, *_ in flexible], bound_without=bound_without,
    )  # fmt: skip


def _bodies(scene: AssemblyScene) -> Callable[[int], Any]:
    """The mesh of a block, one element where it can be; refused where it is not convex."""
    assembly = scene.assembly

    def body(block: int) -> Any:
        name = scene.names[block]
        if assembly.in_section:
            shown = [outline for called, outline in scene.outlines.items() if called != "bedrock" or called == name]
            outline = np.asarray(scene.outlines.get(name, shown[block % len(shown)]))
            if not is_convex_outline(outline):
                raise _refuse(f"{name} is not convex")
            return mesh_of(outline, fanned([range(len(outline))]))
        own = assembly.triangles[assembly.triangle_block == block]
        points, faces = numbered(assembly.vertices[own])
        if not is_convex(points, faces):
            raise _refuse(f"{name} is not convex")
        return mesh_of(points, cells_of(points, np.array(faces)))

    return body


def _split(scene: AssemblyScene, parts: Ints) -> tuple[AssemblyScene, Ints]:
    """A section with each contact split into parts (k,), no longer than its elements; the contact of each part."""
    assembly, patches = scene.assembly, scene.assembly.patches
    ends = patches.corners.reshape(-1, 2, 3)
    origin = np.repeat(np.arange(len(patches)), parts)
    first = np.repeat(np.cumsum(parts) - parts, parts)
    at = (np.arange(len(origin)) - first)[:, None] / parts[origin][:, None]
    step = (ends[origin, 1] - ends[origin, 0]) / parts[origin][:, None]
    start = ends[origin, 0] + at * (ends[origin, 1] - ends[origin, 0])
    corners = np.stack([start, start + step], axis=1)
    finer = replace(
        patches, plus=patches.plus[origin], minus=patches.minus[origin], joint=patches.joint[origin],
        normals=patches.normals[origin], areas=patches.areas[origin] / parts[origin],
        centroids=corners.mean(axis=1), corners=corners.reshape(-1, 3), first=2 * np.arange(len(origin) + 1),
    )  # fmt: skip
    where = patches.centroids if scene.water_points is None else scene.water_points
    own = replace(assembly, patches=finer)
    return replace(scene, assembly=own, pressures=scene.pressures[origin], water_points=where[origin]), origin


def _rows(model: Any, pairs: int) -> tuple[Any, Floats]:
    """B with three rows a pair, and the rows of passive bolts."""
    from scipy import sparse

    every, tangents, groups = len(model.control_area), model.slip_rows.shape[1], len(model.group_contact)
    padded = sparse.vstack([model.kinematics, sparse.csr_matrix((1, model.kinematics.shape[1]))]).tocsr()
    index = np.full((pairs, 3), padded.shape[0] - 1)
    index[:, 0] = np.arange(pairs)
    slip = every + tangents * model.group_of_pair[:pairs]
    for k in range(tangents):
        index[:, 1 + k] = slip + k
    bolts = every + tangents * np.arange(groups - len(model.bolts), groups)
    return padded[index.ravel()], padded[bolts].toarray()
