"""Ladders of effort: a design with fewer and more passes, looser and tighter tolerances, coarser and finer node pairs.

Each rung is one way to a factor of safety with the time that it took. What the rungs are worth, `check` says.
"""

import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from threadpoolctl import threadpool_limits

from slopekit.analysis.assembly import SolvedAssembly
from slopekit.analysis.scene import Scene
from slopekit.analysis.stages import joint_strength
from slopekit.design.common import Design
from slopekit.design.kinds import FootingDesign, PlaneDesign, SurfaceDesign
from slopekit.design.wedge import WedgeDesign
from slopekit.errors import DesignError, GeometryError
from slopekit.extents import SurfaceGeometry
from slopekit.onlooker import say
from slopekit.preie.blocks import limit_of_blocks
from slopekit.preie.limit import LimitAnalysis, curved_limit_analysis, forces_only_limit, limit_analysis, passes_limit
from slopekit.preie.mechanism import COLD, Stages
from slopekit.preie.model import Model
from slopekit.preie.passes import Outcome
from slopekit.preie.ravelling import component_limit, finer_model
from slopekit.result import Result

#: What rungs vary, in words.
METHODS = {
    "closed form": "closed form",
    "forces alone": "forces alone, no turning",
    "passes": "plain passes, by their number",
    "tolerance": "plain passes, by their tolerance",
    "mesh": "limit, by node pairs",
    "stiffness": "limit, by the shear stiffness of the elastic joints",
}
_PASSES = (1, 2, 3, 4, 6, 10, 16)
_MOST_REFINED = 4
_EDGES = (4.0, 2.0, 1.0, 0.5)  # times the edge of the design; meshes halve
_FACET_EDGES = (4.0, 2.0, 1.0)  # the same for facet normals: they show a trend, no answer
_ROOM = 1.01  # asked for so much more than a halving, to get that and not the next
_MOST_PAIRS = 12_000  # node pairs of a finer mesh; beyond that the rung is left out
_RATIOS = (0.1, 1.0)  # k_t / k_n of the path beside its own: where the limit depends on it, it is not the only one
_SETTLED_PASSES = 12
_STILL = 1e-13
_OTHER_STRENGTH = 0.5  # strength divided by so much, and by the limit itself
_SHORT_S, _REPEATS = 0.05, 5  # what is shorter is measured so often, and the median taken
_ONCE_S = 5.0  # what is longer is measured once; the first run of the others may load a library


@dataclass(frozen=True, slots=True)
class Rung:
    """One way to the factor of safety.

    Attributes
    ----------
    method : a key of `METHODS`; setting : in words
    node_pairs : None for a closed form
    effort : passes, tolerance, or level of the mesh (0 the coarsest); None where there is nothing to vary
    factor : None where there is none; seconds : median of a few runs
    edge_m : mean edge of the triangles of a curved slip surface, None for what has none
    """

    method: str
    setting: str
    node_pairs: int | None
    effort: float | None
    factor: float | None
    seconds: float
    edge_m: float | None = None


@dataclass(frozen=True, slots=True)
class NormalsRung:
    """The limit on a mesh of a curved slip surface whose node pairs have normals of one kind.

    Attributes
    ----------
    normals : true (of the surface), smoothed (of a mesh) or facet, on which the mass interlocks like a ratchet: never
        an answer
    edge_m : mean edge of the triangles; factor : None where there is none
    cohesive : factor with every bond kept, of facets only. They open all over as the mass moves on: with the cohesion
        that is lost there `factor` falls below that of the surface, without the loss this one lies above it
    """

    normals: str
    edge_m: float
    node_pairs: int
    factor: float | None
    cohesive: float | None = None


def timed(work: Callable[[], Any]) -> tuple[Any, float]:
    """What `work` returns and the seconds it takes: the median of several runs where they are short."""
    found: Any = None
    taken: list[float] = []
    while not taken or (len(taken) < _REPEATS and min(taken) < _SHORT_S) or (len(taken) < 2 and taken[0] < _ONCE_S):
        began = time.perf_counter()
        found = work()
        taken.append(time.perf_counter() - began)
    return found, sorted(taken)[(len(taken) - 1) // 2]


def block_ladder(design: Design, result: Result) -> tuple[Rung, ...]:
    """The rungs of a design of one block that has a factor of safety; times are those of the solvers alone."""
    rungs: list[Rung] = []
    closed = _closed_form(design)
    if closed is not None and result.agree is not None and result.fos.closed_form is not None:
        found, seconds = timed(closed)
        rungs.append(Rung("closed form", "closed form", None, None, found.factor, seconds))
    prepare, refine, analyse = _stages(design)
    scene = prepare(refine)
    model = scene.model
    if model.lines is not None:
        model = analyse(model).model or model  # on the lines of its limit
    if analyse is limit_analysis:
        alone, seconds = timed(lambda: forces_only_limit(model))
        rungs.append(Rung("forces alone", "no turning", len(scene.pairs), None, alone.factor, seconds))
    if not model.dilates:  # plain passes know no dilation
        rungs += _passes(model)
    if isinstance(design, SurfaceDesign):
        rungs += _surface_meshes(design, result)
    else:
        rungs += _meshes(prepare, refine, max(_MOST_REFINED, result.model.refined + 1), analyse)
    return tuple(rungs)


def _closed_form(design: Design) -> Callable[[], Any] | None:
    if isinstance(design, WedgeDesign):
        from slopekit.analysis import wedge

        return partial(wedge.closed_form, design)
    if isinstance(design, PlaneDesign):
        from slopekit.analysis import plane

        return partial(plane.closed_form, design, plane.section_of(design))
    if isinstance(design, FootingDesign):
        from slopekit.analysis import footing

        return partial(footing.closed_form, design, footing.weight_of(design))
    return None


def _stages(design: Design) -> tuple[Callable[[int], Scene], int, Callable[[Model], LimitAnalysis]]:
    """How a kind comes to its node pairs by refinement, where it starts, and how it is solved."""
    if isinstance(design, WedgeDesign):
        from slopekit.analysis import wedge

        return lambda refine: wedge.prepare(design, refine), design.refine, limit_analysis
    if isinstance(design, PlaneDesign):
        from slopekit.analysis import plane

        return lambda refine: plane.prepare(design, refine), design.refine, limit_analysis
    if isinstance(design, FootingDesign):
        from slopekit.analysis import footing

        return lambda refine: footing.prepare(design, refine), 0, limit_analysis
    if isinstance(design, SurfaceDesign):
        from slopekit.analysis import surface

        return lambda _: surface.prepare(design), 0, curved_limit_analysis
    raise TypeError(f"no ladder for {type(design).__name__}")


def _passes(model: Model) -> Iterator[Rung]:
    """Passes one by one until they stand still, then the tightness of the program that each of them solves."""
    pairs, before = len(model.control_area), math.inf
    for count in _PASSES:
        factor, seconds = timed(partial(_passed, model, count, COLD))
        yield Rung("passes", _times(count, "pass", "passes"), pairs, count, factor, seconds)
        if factor is None or abs(factor / before - 1.0) < _STILL:
            break
        before = factor
    for end in range(1, len(COLD) + 1):
        stages = COLD[:end]
        factor, seconds = timed(partial(_passed, model, _SETTLED_PASSES, stages))
        yield Rung("tolerance", f"12 passes, to {1.0 / stages[-1][0]:.0e}", pairs, 1.0 / stages[-1][0], factor,
                   seconds)  # fmt: skip


def _meshes(
    prepare: Callable[[int], Scene], refine: int, most: int, analyse: Callable[[Model], LimitAnalysis]
) -> Iterator[Rung]:
    for level in range(refine, most + 1):
        say(f"ladder, parts split {_often(level)}", head=True)
        yield _limit_rung(prepare(level), analyse, f"parts split {_often(level)}", level)


def _limit_rung(scene: Scene, analyse: Callable[[Model], LimitAnalysis], setting: str, level: int) -> Rung:
    found, seconds = timed(partial(analyse, scene.model))
    limit = found.governing
    factor = limit.factor if limit.outcome is not Outcome.NOT_CONVERGED else None
    return Rung("mesh", setting, len(scene.pairs), level, factor, seconds)


def _surface_meshes(design: SurfaceDesign, result: Result) -> Iterator[Rung]:
    """Edges four times as long as the design's, to half as long; a mesh file is what it is."""
    from slopekit.analysis import surface

    geometry = result.geometry
    if design.slip.shape == "mesh" or not isinstance(geometry, SurfaceGeometry):
        return
    rungs: list[Rung] = []
    for level, times in enumerate(_EDGES):
        if result.model.node_pairs / times**2 > _MOST_PAIRS:
            break
        other = replace(design, slip=replace(design.slip, edge_m=times * _ROOM * geometry.edge_m))
        say(f"ladder, edges of {times * geometry.edge_m:.3g} m", head=True)
        try:
            scene, edge = surface.prepare_meshed(other)
        except (DesignError, GeometryError):  # too coarse to cut this mass
            continue
        if rungs and len(scene.pairs) == rungs[-1].node_pairs:  # the coarsest mesh there is, once more
            rungs.pop()
        setting = f"edges of {times * geometry.edge_m:.3g} m"
        rungs.append(replace(_limit_rung(scene, curved_limit_analysis, setting, level), edge_m=edge))
    yield from rungs


def normals_rungs(design: Design, result: Result, ladder: Sequence[Rung]) -> tuple[NormalsRung, ...]:
    """Facet normals at a few edges of a curved slip surface, beside the ladder's with the design's own normals.

    Empty for other kinds, and where the design itself has facet normals.
    """
    geometry = result.geometry
    if not isinstance(design, SurfaceDesign) or not isinstance(geometry, SurfaceGeometry):
        return ()
    from slopekit.analysis import surface

    own, is_mesh = design.slip.normals, design.slip.shape == "mesh"
    if own == "facet":
        return ()
    found = [
        NormalsRung(own, rung.edge_m, rung.node_pairs, rung.factor)
        for rung in ladder if rung.edge_m is not None and rung.node_pairs is not None
    ]  # fmt: skip
    if not found:
        found.append(NormalsRung(own, geometry.edge_m, result.model.node_pairs, result.fos.limit))
    edges: list[float] = []
    for times in (1.0,) if is_mesh else _FACET_EDGES:
        if result.model.node_pairs / times**2 > _MOST_PAIRS:
            break
        wanted = None if is_mesh else times * _ROOM * geometry.edge_m
        say(f"facet normals, edges {times:g} times as long", head=True)
        try:
            scene, edge = surface.prepare_meshed(
                replace(design, slip=replace(design.slip, edge_m=wanted, normals="facet"))
            )
        except (DesignError, GeometryError):  # too coarse to cut this mass
            continue
        if edge in edges:  # the coarsest mesh there is, once more
            continue
        edges.append(edge)
        limit = curved_limit_analysis(scene.model).governing
        factor = limit.factor if limit.outcome is not Outcome.NOT_CONVERGED else None
        cohesive = _passed(scene.model, _SETTLED_PASSES, COLD)
        found.append(NormalsRung("facet", edge, len(scene.pairs), factor, cohesive))
    return tuple(found)


def block_at_other_strengths(design: Design, result: Result) -> tuple[float | None, ...]:
    """k F of the design with its strength divided by k: the same F again, where the limit is one (STYLE.md §7).

    None where the weaker or stronger block has no factor.
    """
    prepare, refine, analyse = _stages(design)
    model = prepare(max(refine, result.model.refined)).model
    found = []
    for k in (_OTHER_STRENGTH, result.fos.limit or 1.0):
        say("other strengths, divided by", k, head=True)
        other = replace(
            model, cohesion=model.cohesion / k, tan_friction=model.tan_friction / k,
            bolt_capacity=model.bolt_capacity / k, lines=None if model.lines is None else model.lines.reduced(k),
        )  # fmt: skip
        limit = analyse(other).governing
        found.append(k * limit.factor if limit.factor and limit.outcome is not Outcome.NOT_CONVERGED else None)
    return tuple(found)


def assembly_at_other_strengths(solved: SolvedAssembly) -> tuple[float | None, ...]:
    """The same of the blocks that fail first."""
    failures = solved.ravelling.failures
    if not failures or not failures[0].limit.factor:
        return ()
    model, found = failures[0].parts[0].model, []
    with threadpool_limits(1):
        for k in (_OTHER_STRENGTH, failures[0].limit.factor):
            say("other strengths", head=True)
            other = replace(model, cohesion=model.cohesion / k, tan_friction=model.tan_friction / k)
            limit = limit_of_blocks(other, ranged=False)
            found.append(k * limit.factor if limit.factor else None)
    return tuple(found)


def assembly_ladder(solved: SolvedAssembly) -> tuple[Rung, ...]:
    """The rungs of the blocks that fail first; those that were held stay so."""
    with threadpool_limits(1):  # as the analysis: bands are narrow
        return tuple(_assembly_rungs(solved))


def _assembly_rungs(solved: SolvedAssembly) -> Iterator[Rung]:
    result, scene, failures = solved.result, solved.scene, solved.ravelling.failures
    if result.agree is not None and result.fos.closed_form is not None:
        taken = result.timing_s["closed_form"]
        yield Rung("closed form", "closed form", None, None, result.fos.closed_form, taken)
    if not failures or not failures[0].limit.factor:
        return
    part = failures[0].parts[0]
    for ratio in _RATIOS:
        say(f"ladder, k_t/k_n {ratio:g}", head=True)
        limit, seconds = timed(partial(limit_of_blocks, part.model, ranged=False, ratio=ratio))
        yield Rung("stiffness", f"k_t / k_n {ratio:g}", part.model.joint_pairs.stop, ratio, limit.factor, seconds)
    for level in range(3 if refines(solved) else 1):
        model = part.model
        if level:
            model = finer_model(scene.assembly, solved.loads, joint_strength(scene.strengths), part, level)
        if level and len(model.control_area) > _MOST_PAIRS:
            break
        say(f"ladder, parts split {_often(level)}", head=True)
        limit, seconds = timed(lambda model=model: component_limit(model, False)[1])  # type: ignore[misc]
        setting = f"parts split {_often(level)}" if refines(solved) else "as analysed"
        yield Rung("mesh", setting, model.joint_pairs.stop, level, limit.factor, seconds)


def refines(solved: SolvedAssembly) -> bool:
    """Whether finer node pairs mean anything: in a section a flat contact slips as one, and its ends turn it."""
    return not solved.scene.assembly.in_section


def _passed(model: Model, count: int, stages: Stages) -> float | None:
    try:
        factor = passes_limit(model, count, stages)
    except (ZeroDivisionError, FloatingPointError):
        return None
    return factor if 0.0 < factor < math.inf else None


def _often(count: int) -> str:
    return {0: "never", 1: "once", 2: "twice"}.get(count, f"{count} times")


def _times(count: int, one: str, more: str) -> str:
    return f"{count} {one if count == 1 else more}"
