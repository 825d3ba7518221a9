"""Elastic blocks of a design in addition to its rigid result: open contacts, tractions, displacements, limit.

A block that slides has the rigid limit but for the cohesion of the pairs that its deformation pulls open
(docs/theory/elastic.md): the state at full strength and one rigid limit are enough. `benchmarks.elastic_oracle` holds
it against the factor at which elastic blocks no longer come to rest.
"""

import math
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy import sparse

from slopekit.core.arrays import Bools, Floats, Ints, frozen
from slopekit.core.errors import DesignError, Fault, Notice
from slopekit.core.progress import report_stage
from slopekit.design.common import Design
from slopekit.elastic.condensed import ElasticModel
from slopekit.elastic.flexibility import ORDER, Elements, body
from slopekit.elastic.meshing import convex_mesh, edges_of, halvings
from slopekit.elastic.outcome import ElasticBlocks, ElasticMesh, OnElasticJoint
from slopekit.elastic.rest import Rest, RestSearch
from slopekit.kinds.assemblies.many_blocks_design import AssemblyDesign
from slopekit.kinds.assemblies.many_blocks_scene import (
    AssemblyScene,
    least_counted_weight,
    scene_loads,
)
from slopekit.kinds.protocol import Kind
from slopekit.kinds.single_block.one_block_limit import Cut
from slopekit.kinds.solver_inputs import joint_stiffness, joint_strength
from slopekit.preie.one_block.pairs_limit import pairs_limit
from slopekit.preie.system.assembly import AssemblyModel, one_block
from slopekit.preie.system.contact import SHEAR_TO_NORMAL, CloughDuncan, JointStiffness
from slopekit.result import Result

MODULUS_KPA, POISSON = 2e7, 0.25
_MOST_BLOCKS, _MOST_PAIRS, _MOST_OF_MANY = 300, 1500, 12_000
_MOST_CELLS, _AUTO_CELLS = 20_000, 1500  # of all blocks; of one with `edge: auto`
_HALVED = {
    "one": 3,
    "section": 2,
    "space": 1,
}  # how often the longest edge of a block is halved, `edge: auto`
_MOST_HALVED_BLOCKS = 50  # blocks in space; of more the edges are not halved
_MOST_REFINED = 5
_WORK_SHARE = 0.4  # of the work of one analysis, for the limit without the open contacts; the rest: elastic blocks


@dataclass(frozen=True)
class ElasticScene:
    """Elastic blocks in arrays, and what the rigid code makes of them.

    Attributes
    ----------
    limit_without : the rigid limit without the cohesion of pairs (n,), and whether there is none for want of work
    joint : (n,) names; axes : rows are the local axes
    names : of the blocks, empty of one; edge : m, the longest of the finite elements
    """

    model: ElasticModel
    stiffness: JointStiffness
    rigid_limit: float | None
    limit_without: Callable[[Bools], tuple[float | None, bool]]
    joint: Sequence[str]
    axes: Floats
    names: Sequence[str]
    edge: float


def elastic_stiffness(design: Design, many: bool) -> JointStiffness:
    """Return the joint stiffness, constant in place of Clough and Duncan's hyperbola: k₁ γ_w, or that of the path.

    With the paper's parameters the hyperbola cannot reach the strength of a joint pressed by less than 43 kPa, which
    elastic blocks have along their edges.
    """
    stiffness = joint_stiffness(design)
    law = stiffness.tangential
    if not isinstance(law, CloughDuncan):
        return stiffness
    shear = (
        SHEAR_TO_NORMAL * stiffness.normal if many else law.modulus_number * law.water_unit_weight
    )
    return replace(stiffness, tangential=shear)


def rock_of(design: Design) -> tuple[float, float]:
    """Return Young's modulus (kPa) and Poisson's ratio of the rock."""
    poisson = design.rock.poisson
    return design.rock.modulus_kpa or MODULUS_KPA, POISSON if poisson is None else poisson


def _default_edge(mesh: Any, halved: int) -> float:
    """Return the default of the longest element edge (m), longer for a body of many faces."""
    while halved > 0 and mesh.t.shape[1] * 2 ** (len(mesh.p) * halved) > _AUTO_CELLS:
        halved -= 1
    return math.ldexp(float(edges_of(mesh).max()), -halved)


def _unsupported(reason: str, advice: str = "Leave --elastic out.") -> DesignError:
    return DesignError(
        [Fault("E288", f"no elastic blocks of this design: {reason}", "--elastic", advice)]
    )


def _too_many(message: str, advice: str = "Give a longer edge, or auto.") -> DesignError:
    return DesignError([Fault("E125", message, "analysis.elastic.edge", advice)])


def _mesh(polygons: Iterable[Floats], size: float, name: str) -> Any:
    """Return the `convex_mesh` of a block. Raises DesignError where the block is not convex."""
    mesh = convex_mesh(polygons, size)
    if mesh is None:
        raise _unsupported(f"{name} is not convex")
    return mesh


def elastic_model(
    joined: AssemblyModel,
    points: Floats,
    tension: Floats,
    meshes: Mapping[int, Any],
    edges: Mapping[int, float],
    rock: tuple[float, float],
    thickness: float = 1.0,
) -> ElasticModel:
    """Return the model of elastic blocks in kN, m and kPa.

    Parameters
    ----------
    joined : of the rigid blocks; points : (n, 3) m of their node pairs; tension : (n,) kPa
    meshes, edges : of each block its mesh, and the longest edge (m) that its elements may have
    rock : Young's modulus (kPa) and Poisson's ratio; thickness : m, of a section

    Raises
    ------
    DesignError
        E125 where that are too many elements.
    """
    times = {block: halvings(mesh, edges[block]) for block, mesh in meshes.items()}
    cells = sum(
        mesh.t.shape[1] * 2.0 ** (len(mesh.p) * times[block]) for block, mesh in meshes.items()
    )
    if cells > _MOST_CELLS:
        longest = float(np.median(list(edges.values())))
        raise _too_many(
            f"edges of {longest:.4g} m make {cells:.3g} finite elements, at most {_MOST_CELLS} are taken"
        )
    pairs = joined.joint_pairs.stop
    contact, group = joined.pair_contact[:pairs], joined.group_of_pair[:pairs]
    plus, minus, axes = joined.plus[contact], joined.minus[contact], joined.axes[contact]
    condensed = []
    for k, block in enumerate(joined.moving.tolist()):
        touching = np.flatnonzero((plus == k) | (minus == k))
        sides = np.where(plus[touching] == k, 1.0, -1.0)[:, None, None] * axes[touching]
        elements = Elements(meshes[block].refined(times[block]), *rock, thickness, ORDER)
        rows_of_block = (3 * touching[:, None] + np.arange(3)).ravel()
        unknowns = k * joined.unknowns + np.arange(joined.unknowns)
        condensed.append(
            (body(elements, points[touching], sides, joined.length_scale), rows_of_block, unknowns)
        )
    rows, bolt_rows = _rows(joined, pairs)
    area, strength = (
        joined.control_area[:pairs] * joined.area_scale,
        joined.cohesion * joined.force_scale,
    )
    return ElasticModel(
        sparse.csr_matrix(rows),
        joined.load.ravel() * joined.force_scale,
        area,
        strength[:pairs] / area,
        tension,
        joined.tan_friction[group],
        joined.tan_dilation[group],
        bolt_rows,
        strength[pairs:],
        tuple(condensed),
    )


def _rows(model: AssemblyModel, pairs: int) -> tuple[Any, Floats]:
    """Return the kinematic matrix B with three rows a node pair, and the rows of passive bolts."""
    pair_count, tangents, groups = (
        len(model.control_area),
        model.slip_rows.shape[1],
        len(model.group_contact),
    )
    padded = sparse.vstack(
        [model.kinematics, sparse.csr_matrix((1, model.kinematics.shape[1]))]
    ).tocsr()
    index = np.full((pairs, 3), padded.shape[0] - 1)
    index[:, 0] = np.arange(pairs)
    slip = pair_count + tangents * model.group_of_pair[:pairs]
    for k in range(tangents):
        index[:, 1 + k] = slip + k
    bolts = pair_count + tangents * np.arange(groups - len(model.bolts), groups)
    return padded[index.ravel()], padded[bolts].toarray()


# -- one block --------------------------------------------------------------------------------------------------------


def scene_of_one(design: Design, cut: Cut) -> ElasticScene:
    """Return the elastic scene of a convex block on flat joints."""
    if not cut.loads.components["weight"].any():
        raise _unsupported("the block has no weight, and what loads it stands on its surface")
    coarse = cut.scene_at(0)
    if coarse.bedding is None:
        raise _unsupported("the block lies on a curved surface, and is not convex")
    polygons = list(cut.block.faces.values())
    if coarse.model.translations == 2:
        polygons = [side[:, [0, 2]] for side in polygons if np.ptp(side[:, 1]) < 1e-9][:1]
    mesh = _mesh(polygons, cut.block.volume, "the block")
    edge = design.analysis.elastic_edge_m or _default_edge(mesh, _HALVED["one"])
    joint_edge = max(
        float(np.sqrt((np.diff(corners, axis=0, append=corners[:1]) ** 2).sum(axis=1)).max())
        for corners in map(np.asarray, coarse.bedding.polygons.values())
    )
    refine = max(cut.refine, math.ceil(math.log2(joint_edge / edge * (1.0 - 1e-9))))
    scene = cut.scene_at(min(max(refine, 0), _MOST_REFINED))
    if len(scene.pairs) > _MOST_PAIRS:
        raise _too_many(
            f"edges of {edge:.4g} m make {len(scene.pairs)} node pairs, at most {_MOST_PAIRS} are taken"
        )
    model = scene.model
    tension = model.tension * model.force_scale / (model.control_area * model.area_scale)
    elastic = elastic_model(
        one_block(model), scene.pairs.points, tension, {0: mesh}, {0: edge}, rock_of(design)
    )

    def limit_without(is_open: Bools) -> tuple[float | None, bool]:
        return pairs_limit(
            replace(model, cohesion=frozen(model.cohesion * ~is_open))
        ).governing.factor or None, False

    names = {interface.key: interface.name for interface in cut.interfaces}
    return ElasticScene(
        elastic,
        elastic_stiffness(design, False),
        pairs_limit(model).governing.factor or None,
        limit_without,
        [names[key] for key in scene.pairs.interface.tolist()],
        cut.axes,
        (),
        edge,
    )


# -- many blocks ------------------------------------------------------------------------------------------------------


def scene_of_many(design: Design, scene: AssemblyScene, result: Result) -> ElasticScene:
    """Return the elastic scene of convex blocks on flat contacts."""
    from slopekit.preie.many_blocks.ravelling import ravel
    from slopekit.preie.solvers import work_limit
    from slopekit.preie.system.components import whole_model

    assembly = scene.assembly
    moving = int((~assembly.fixed).sum())
    if moving > _MOST_BLOCKS:
        message = f"{moving} blocks move, elastic ones are at most {_MOST_BLOCKS}"
        raise DesignError(
            [Fault("E125", message, "--elastic", "Leave --elastic out, or make the slope smaller.")]
        )
    meshes = {
        block: _mesh_of_block(scene, block) for block in np.flatnonzero(~assembly.fixed).tolist()
    }
    halved = (
        _HALVED["section"]
        if assembly.in_section
        else _HALVED["space"] * (moving <= _MOST_HALVED_BLOCKS)
    )
    edges = {
        block: design.analysis.elastic_edge_m or _default_edge(mesh, halved)
        for block, mesh in meshes.items()
    }
    halved_by = np.zeros(len(assembly) + 1, dtype=np.int64)  # bedrock last
    halved_by[list(meshes)] = [halvings(mesh, edges[block]) for block, mesh in meshes.items()]
    levels = np.maximum(halved_by[assembly.patches.plus], halved_by[assembly.patches.minus])
    split, origin = (
        _split(scene, 2**levels)
        if assembly.in_section
        else (scene, np.arange(len(assembly.patches)))
    )
    strength = joint_strength(scene.strengths)
    refine = None if assembly.in_section else np.minimum(levels, _MOST_REFINED)
    joined = whole_model(split.assembly, scene_loads(split), strength, refine)
    if joined is None:
        raise _unsupported("its blocks touch nothing")
    pairs = joined.joint_pairs.stop
    if pairs > _MOST_OF_MANY:
        raise _too_many(
            f"{pairs} node pairs between elastic blocks, at most {_MOST_OF_MANY} are taken",
            "Give a longer edge, or fewer blocks.",
        )
    patch = joined.patch[joined.pair_contact[:pairs]]
    joint, area = (
        split.assembly.patches.joint[patch],
        joined.control_area[:pairs] * joined.area_scale,
    )
    model = elastic_model(
        joined,
        joined.points,
        strength.tension[joint],
        meshes,
        edges,
        rock_of(design),
        scene.thickness or 1.0,
    )
    loads_of_all = scene_loads(scene)
    assert isinstance(design, AssemblyDesign)  # blocks have no other
    lightest = least_counted_weight(design, scene, loads_of_all)

    def limit_without(is_open: Bools) -> tuple[float | None, bool]:
        lost = np.bincount(origin[patch], area * is_open, len(assembly.patches))
        share = np.divide(
            lost,
            assembly.patches.areas,
            out=np.zeros_like(lost),
            where=assembly.patches.areas > 0.0,
        )
        patch_strength = joint_strength(
            [scene.strengths[joint] for joint in assembly.patches.joint.tolist()]
        )
        if not (share * patch_strength.cohesion).any():
            return result.fos.limit, False
        weaker = replace(
            patch_strength, cohesion=patch_strength.cohesion * np.clip(1.0 - share, 0.0, 1.0)
        )
        patchwise = replace(
            assembly, patches=replace(assembly.patches, joint=np.arange(len(share)))
        )
        with work_limit.work_budget(_WORK_SHARE * work_limit.LIMIT_UNITS):
            failures = ravel(
                patchwise, loads_of_all, weaker, ranged=False, lightest=lightest
            ).failures
        return (failures[0].limit.factor, failures[0].limit.spent) if failures else (None, False)

    names = [scene.names[block] for block in joined.moving.tolist()]
    return ElasticScene(
        model,
        elastic_stiffness(design, True),
        result.fos.limit,
        limit_without,
        [scene.joints[key] for key in joint.tolist()],
        np.eye(3),
        names,
        float(np.median(list(edges.values()))),
    )


def _is_chip(scene: AssemblyScene, result: Result) -> Bools:
    """Return which blocks (b,) are chips that fail before the first mechanism."""
    chips = () if result.findings is None else result.findings.chips
    return np.isin(scene.names, [name for chip in chips for name in chip.blocks])


def _mesh_of_block(scene: AssemblyScene, block: int) -> Any:
    """Return the mesh of a block, a single element where possible. Raises DesignError where it is not convex."""
    assembly, name = scene.assembly, scene.names[block]
    size = float(assembly.volumes[block])
    if assembly.in_section:
        return _mesh([np.asarray(scene.outlines[name])], size / (scene.thickness or 1.0), name)
    return _mesh(
        assembly.vertices[assembly.triangles[assembly.triangle_block == block]], size, name
    )


def _split(scene: AssemblyScene, counts: Ints) -> tuple[AssemblyScene, Ints]:
    """Return a section with each contact split into `counts` (k,) segments, and the contact of each segment."""
    assembly, patches = scene.assembly, scene.assembly.patches
    ends = patches.corners.reshape(-1, 2, 3)
    origin = np.repeat(np.arange(len(patches)), counts)
    first = np.repeat(np.cumsum(counts) - counts, counts)
    share = (np.arange(len(origin)) - first)[:, None] / counts[origin][:, None]
    step = (ends[origin, 1] - ends[origin, 0]) / counts[origin][:, None]
    start = ends[origin, 0] + share * (ends[origin, 1] - ends[origin, 0])
    corners = np.stack([start, start + step], axis=1)
    finer = replace(
        patches,
        plus=patches.plus[origin],
        minus=patches.minus[origin],
        joint=patches.joint[origin],
        normals=patches.normals[origin],
        areas=patches.areas[origin] / counts[origin],
        centroids=corners.mean(axis=1),
        corners=corners.reshape(-1, 3),
        first=2 * np.arange(len(origin) + 1),
    )
    points = patches.centroids if scene.water_points is None else scene.water_points
    finer_assembly = replace(assembly, patches=finer)
    return replace(
        scene,
        assembly=finer_assembly,
        pressures=scene.pressures[origin],
        water_points=points[origin],
    ), origin


_FRACTION_OF_LIMIT = 0.95  # of a limit below 1: where the state is looked at
_EQUAL_LIMITS = 1e-6
_LOCKED_IN_WIDTH = 0.01  # width of the range of locked-in forces, in parts, that is worth a word


def with_elastic(kind: Kind[Any], result: Result) -> Result:
    """Return the result with its elastic blocks.

    Raises
    ------
    DesignError
        E140 without scikit-fem, E125 and E288 for what cannot be had.
    """
    design, began = result.design, time.perf_counter()
    report_stage("elastic", head=True)
    cut = kind.cut(design)
    if any(strength.law is not None for strength in design.joint_strengths):
        raise _unsupported(
            "strength is curved, and the lines of its law would follow the tractions"
        )
    scene = (
        scene_of_one(design, cut)
        if isinstance(cut, Cut)
        else scene_of_many(design, cut.without_blocks(_is_chip(cut, result)), result)
    )
    is_stable = result.status == "no_driving_force"
    if scene.rigid_limit is None and not is_stable:
        notice = Notice(
            "W450",
            f"no elastic blocks: {result.status_text}, nothing comes to rest at any strength",
        )
        return replace(result, warnings=(*result.warnings, notice))
    below = _FRACTION_OF_LIMIT * min(
        scene.rigid_limit or math.inf, 1.0
    )  # elastic blocks may not stand where rigid ones just do
    factors = (below,) if not is_stable and (scene.rigid_limit or 0.0) <= 1.0 else (1.0, below)
    for factor in factors:
        search = RestSearch(scene.model, scene.stiffness)
        rest = search.rest(factor)
        if rest.is_balanced:
            break
    else:
        pairs = (
            f"{int(rest.opened(scene.model).sum())} of {len(rest.parted)} node pairs pulled open"
        )
        search_note = f"in {search.steps} steps, {pairs}" if search.spent else f"({pairs})"
        notice = Notice(
            "W450",
            f"no elastic blocks: Newton's method finds no rest at F = {factor:.4g} {search_note}",
        )
        return replace(
            result,
            warnings=(*result.warnings, notice),
            timing_s=_timing_with_elastic(result, began),
        )
    rigid = RestSearch(scene.model.rigid(), scene.stiffness).rest(factor)
    limit, spent = scene.rigid_limit, False
    rigid_limit = limit
    if not is_stable:
        limit, spent = scene.limit_without(rest.opened(scene.model))
        rigid_limit_without = (
            scene.limit_without(rigid.opened(scene.model))[0] if rigid.is_balanced else None
        )
        rigid_limit = min(
            (
                factor_without
                for factor_without in (rigid_limit, rigid_limit_without)
                if factor_without is not None
            ),
            default=None,
        )
    is_higher = (
        limit is not None
        and rigid_limit is not None
        and limit > rigid_limit * (1.0 + _EQUAL_LIMITS)
    )
    limit = rigid_limit if is_higher else limit
    answer = _answer(design, scene, rest, rigid, (limit, rigid_limit), search.steps)
    notes = [*result.warnings, *_notices(result, answer)]
    if factor < factors[0] and limit is not None:
        rest_found = f"come to rest at F = {factor:.4g}, at {factors[0]:.4g} none was found"
        between = f"their limit may lie between, below the {limit:.4f} under ELASTIC, which is without what is open"
        notes.append(
            Notice(
                "W455", f"elastic blocks {rest_found}: {between} at the first: rely on {factor:.4g}"
            )
        )
    if not is_stable and limit is None:
        notes.append(_no_limit_notice(spent))
    if is_higher:
        reason = "without the cohesion that is pulled open another limit state is found, with a higher factor"
        notes.append(Notice("W455", f"{reason}: the lower of the two is the limit under ELASTIC"))
    comparisons = replace(result.comparisons, elastic=answer)
    return replace(
        result,
        comparisons=comparisons,
        warnings=tuple(notes),
        timing_s=_timing_with_elastic(result, began),
    )


def _no_limit_notice(spent: bool) -> Notice:
    """Return W360 or W308: no limit without the open cohesion, for lack of effort or for lack of resistance."""
    reason = "no limit under ELASTIC: without the cohesion that is pulled open"
    if spent:
        return Notice("W360", f"{reason} it was not settled within the effort of one analysis")
    return Notice(
        "W308",
        f"{reason} none was found, and not for want of work: the rigid blocks may tip or fall then",
    )


def _timing_with_elastic(result: Result, began: float) -> dict[str, float]:
    took = time.perf_counter() - began
    return dict(result.timing_s) | {
        "elastic": took,
        "total": result.timing_s.get("total", 0.0) + took,
    }


def _notices(result: Result, answer: ElasticBlocks) -> Iterator[Notice]:
    lowest, highest = result.fos.lowest, result.fos.highest
    wide = lowest is not None and (highest is None or highest > lowest * (1.0 + _LOCKED_IN_WIDTH))
    if answer.block is not None and wide:
        upper_end = "far above it" if highest is None else f"{highest:.3f}"
        span = f"{lowest:.3f} .. {upper_end}"
        message = f"the limit under ELASTIC is that of the rigid path, other load paths and locked-in stresses: {span}"
        yield Notice("W455", f"{message}; rely on the lowest")


# -- the answer -------------------------------------------------------------------------------------------------------


def _answer(
    design: Design,
    scene: ElasticScene,
    rest: Rest,
    rigid: Rest,
    limits: tuple[float | None, float | None],
    steps: int,
) -> ElasticBlocks:
    model, (modulus, poisson) = scene.model, rock_of(design)
    moduli = {"modulus": design.rock.modulus_kpa, "poisson": design.rock.poisson}
    assumed = tuple(name for name, value in moduli.items() if value is None)
    area = model.area
    elastic, stiff = (state.forces.reshape(-1, 3)[:, 0] / area for state in (rest, rigid))
    joints = {}
    names = np.array(scene.joint)
    for name in dict.fromkeys(scene.joint):
        of_joint = names == name
        joints[name] = OnElasticJoint(
            (float(elastic[of_joint].min()), float(elastic[of_joint].max())),
            (float(stiff[of_joint].min()), float(stiff[of_joint].max())),
            float(area[of_joint & rest.opened(model)].sum() / area[of_joint].sum()),
        )
    displacements = _displacements(scene, model, rest)
    most = int(np.argmax((displacements * displacements).sum(axis=1)))
    both, bonded = [state.opened(model) for state in (rest, rigid)], model.cohesion > 0.0
    opened, rigid_opened = (float(area[open_].sum() / area.sum()) for open_ in both)
    lost, rigid_lost = (float(area[open_ & bonded].sum() / area.sum()) for open_ in both)
    bodies = [body for body, *_ in model.blocks]
    degrees = sum(body.degrees for body in bodies) + 3 * len(area) + len(model.load)
    mesh = ElasticMesh(
        rest.failed_pairs,
        len(area),
        degrees,
        sum(body.cells for body in bodies),
        scene.edge,
        ORDER,
        assumed,
        rest.residual,
    )
    return ElasticBlocks(
        limits[0],
        limits[1],
        rest.factor,
        opened,
        rigid_opened,
        lost,
        rigid_lost,
        joints,
        frozen(displacements[most]),
        frozen(_displacements(scene, model.rigid(), rigid)[most]),
        scene.names[most] if scene.names else None,
        modulus,
        poisson,
        steps,
        mesh,
    )


def _displacements(scene: ElasticScene, model: ElasticModel, state: Rest) -> Floats:
    """Return the mean displacement of each block in the user's axes, (b, 3) m."""
    means = model.mean_bending(state.motion, state.factor, state.bent)
    motions = state.motion.reshape(len(means), -1)
    space = [0, 2] if motions.shape[1] == 3 else [0, 1, 2]  # of a section or not
    means[:, space] += motions[:, : len(space)]
    return means @ scene.axes
