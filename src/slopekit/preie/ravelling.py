"""What fails first, what fails next: the mechanisms of an assembly one after the other.

Blocks that touch only through bedrock form components, and each is solved for itself: a block that touches nothing
changes nothing. The component with the lowest factor gives the mechanism; its moving blocks are taken away, and only
what is left of that component is solved anew.

In a large component in space the first mechanism is looked for near the free surface: blocks deeper than some layers
are held, and layers are set free until another one changes nothing. That is a check, not a proof: `Part` says so.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from threadpoolctl import threadpool_limits

from slopekit.arrays import Bools, Floats, Ints
from slopekit.geometry.patches import Assembly
from slopekit.loads import AssemblyLoads, drained
from slopekit.preie.assembly import AssemblyModel, build_assembly
from slopekit.preie.blocks import BlocksLimit, limit_of_blocks, with_bound
from slopekit.preie.key_blocks import depths, slide_alone
from slopekit.preie.model import JointStrength
from slopekit.preie.parts import Part, chosen, split_contacts
from slopekit.preie.passes import Outcome

MOVES = 1e-3  # of the fastest block of a mechanism: slower ones are at rest
_SAME = 1e-6  # factors this near are one
_LAYERS_FROM = 200  # moving blocks in space beyond which the first mechanism is looked for in layers
_FIRST_LAYERS = 1
_ROUGHLY, _ALIKE = 1.5e-2, 3.0  # how well the mechanism of many blocks is found, before its factor is settled
_SMALL = 6  # blocks of a mechanism whose neighbours are tried
_ALONE = 12  # so many of them
_LAYER = 2e-3  # what another layer may change, in parts of the factor


@dataclass(frozen=True, slots=True)
class Failure:
    """One mechanism: the parts that fail together (at the same factor), and the blocks (k,) that move.

    `motion` (k, 6) displacement and rotation (per m) of the blocks, the fastest motion 1.
    """

    parts: tuple[Part, ...]
    blocks: Ints
    motion: Floats

    @property
    def limit(self) -> BlocksLimit:
        """The limit of its first part."""
        return self.parts[0].limit


@dataclass(frozen=True, slots=True)
class Ravelling:
    """The sequence of mechanisms, the parts of the first round, and the blocks (b,) left at the end.

    `ended` says why the sequence ends: count, stands, gone or not_converged.
    """

    failures: tuple[Failure, ...]
    parts: tuple[Part, ...]
    left: Bools
    ended: str


def ravel(
    assembly: Assembly,
    loads: AssemblyLoads,
    strength: JointStrength,
    count: int = 1,
    stop_when: float = 1e-4,
    idle: Bools | None = None,
) -> Ravelling:
    """The first `count` mechanisms of an assembly.

    Parameters
    ----------
    strength : indexed by the patches' joint
    stop_when : see `limit_of_blocks`
    idle : (k,) patches that nothing presses on: they count in the static bound only
    """
    idle = np.zeros(len(assembly.patches), dtype=bool) if idle is None else idle
    scene = _Scene(assembly, loads, strength, stop_when, idle, block_sizes(assembly))
    with threadpool_limits(1):  # bands are narrow: threads would only wait for each other
        return _ravel(scene, count)


def _ravel(scene: "_Scene", count: int) -> Ravelling:
    assembly, size = scene.assembly, scene.sizes
    there = ~assembly.fixed
    parts = list(_solved(scene, there, np.flatnonzero(there)))
    first = parts
    failures: list[Failure] = []
    ended = "count"
    while len(failures) < count:
        parts = _refined(scene, parts)
        rank = min((part.rank for part in parts), default=math.inf)
        if rank == math.inf:
            ended = "stands" if parts else "gone"
            break
        together = [_bounded(scene, there, part) for part in parts if part.rank <= rank + abs(rank) * _SAME]
        moved = [_moving(part, size) for part in together]
        blocks = np.concatenate([found for found, _ in moved])
        failures.append(Failure(tuple(together), blocks, np.concatenate([motion for _, motion in moved])))
        if any(part.limit.outcome is Outcome.NOT_CONVERGED for part in together):
            ended = "not_converged"
            break
        left = [part for part in parts if part.rank > rank + abs(rank) * _SAME]
        if len(failures) == 1:
            first = [*together, *left]
        there[blocks] = False
        out = np.append(~there & ~assembly.fixed, False)
        opened = out[assembly.patches.plus] | out[assembly.patches.minus]
        scene = replace(scene, loads=drained(assembly, scene.loads, opened))
        if len(failures) == count:
            break
        for part in together:
            left += _solved(scene, there, part.blocks[there[part.blocks]])
        parts = left
    return Ravelling(tuple(failures), tuple(first), there, ended)


@dataclass(frozen=True, slots=True, eq=False)
class _Scene:
    """What every part of an assembly shares."""

    assembly: Assembly
    loads: AssemblyLoads
    strength: JointStrength
    stop_when: float
    idle: Bools
    sizes: Floats


def whole_model(assembly: Assembly, loads: AssemblyLoads, strength: JointStrength) -> AssemblyModel | None:
    """One model of all blocks that touch something and are not fixed; None where there is none."""
    patches = assembly.patches
    touched = np.zeros(len(assembly) + 1, dtype=bool)
    touched[patches.plus] = touched[patches.minus] = True
    held = assembly.fixed | ~touched[:-1]
    free = np.append(~held, False)
    if not (free[patches.plus] | free[patches.minus]).any():
        return None
    return build_assembly(
        patches, held, assembly.centroids, loads.forces, loads.moments, strength, assembly.in_section,
        fewest_pairs=False,
    )  # fmt: skip


def _refined(scene: "_Scene", parts: list[Part]) -> list[Part]:
    """The parts, those that come first with finer node pairs where their mechanism opens contacts with cohesion.

    How much of such a contact opens depends on its pairs; where none is lost, or nothing has cohesion, they do not
    matter much (torsion, at most).
    """
    done: set[int] = set()
    while True:
        first = min(range(len(parts)), key=lambda k: parts[k].rank, default=None)
        if first is None or first in done:
            return parts
        done.add(first)
        part = parts[first]
        if not part.limit.factor or part.limit.outcome is not Outcome.SLIDES or part.limit.bond.all():
            continue
        parts = [
            *parts[:first],
            split_contacts(scene.assembly, scene.loads, scene.strength, part, scene.stop_when),
            *parts[first + 1 :],
        ]


def _solved(scene: _Scene, there: Bools, among: Ints) -> Iterator[Part]:
    """The components among some blocks, each solved; blocks that are not `there` nor fixed are gone."""
    gone = ~there & ~scene.assembly.fixed
    for blocks in _components(scene.assembly, among):
        if scene.assembly.in_section or len(blocks) <= _LAYERS_FROM:
            yield _limit(scene, gone, blocks, blocks)
        else:
            yield _in_layers(scene, gone, blocks)


def _components(assembly: Assembly, among: Ints) -> list[Ints]:
    """Blocks that touch each other, not only bedrock or what is held, together."""
    if len(among) == 0:
        return []
    patches = assembly.patches
    inside = np.zeros(len(assembly) + 1, dtype=bool)
    inside[among] = True
    both = inside[patches.plus] & inside[patches.minus] & (patches.minus >= 0) & (patches.plus >= 0)
    graph = sparse.coo_matrix(
        (np.ones(int(both.sum())), (patches.plus[both], patches.minus[both])), shape=(len(assembly),) * 2
    )
    _, label = connected_components(graph, directed=False)
    order = np.argsort(label[among], kind="stable")
    ends = np.flatnonzero(np.diff(label[among][order])) + 1
    return np.split(among[order], ends)


def _model(scene: _Scene, gone: Bools, free: Ints, idle: bool) -> tuple[AssemblyModel, Ints] | None:
    """The model with the blocks `free` moving and all others held, those `gone` taken away, and its patches."""
    assembly, patches = scene.assembly, scene.assembly.patches
    held = np.ones(len(assembly), dtype=bool)
    held[free] = False
    out, moves = np.append(gone, False), np.append(~held, False)  # bedrock is never gone and never moves
    kept = (moves[patches.plus] | moves[patches.minus]) & ~out[patches.plus] & ~out[patches.minus]
    kept &= ~scene.idle | idle
    if not kept.any():
        return None
    model = build_assembly(
        chosen(patches, kept), held, assembly.centroids, scene.loads.forces, scene.loads.moments, scene.strength,
        assembly.in_section,
    )  # fmt: skip
    return model, np.flatnonzero(kept)[model.patch]


def _limit(scene: _Scene, gone: Bools, blocks: Ints, free: Ints) -> Part:
    """The limit of a component with some of its blocks free and the others held."""
    part = _together(scene, gone, blocks, free)
    if scene.assembly.in_section or len(free) == 1 or part.limit.outcome is Outcome.LIFTED:
        return part
    # normal forces are not unique where blocks wedge each other, and neither are limit states: single blocks that
    # would slide out by themselves are tried for themselves
    for block in slide_alone(scene.assembly, scene.loads, scene.strength, gone, free, part.rank)[:_ALONE]:
        alone = _together(scene, gone, blocks, np.array([block]))
        if alone.rank < part.rank - abs(part.rank) * _SAME:
            part = replace(alone, at_rest=len(free) - 1)
    return _grown(scene, gone, part, free)


def _grown(scene: _Scene, gone: Bools, part: Part, free: Ints) -> Part:
    """A small mechanism with the neighbours that lower its factor: what rests on a block may push it out."""
    patches = scene.assembly.patches
    may = np.zeros(len(scene.assembly) + 1, dtype=bool)
    may[free] = True
    while len(part.free) <= _SMALL and 0.0 < part.rank < math.inf:
        inside = np.zeros(len(may), dtype=bool)
        inside[part.free] = True
        near = np.concatenate([patches.minus[inside[patches.plus]], patches.plus[inside[patches.minus]]])
        near = np.unique(near[may[near] & ~inside[near]])
        groups = [np.sort(np.append(part.free, block)) for block in near.tolist()]
        ranks = [_roughly(scene, gone, part.blocks, group).rank for group in groups]
        if not ranks or not min(ranks) < part.rank * (1.0 - _LAYER):
            break
        best = _together(scene, gone, part.blocks, groups[int(np.argmin(ranks))])
        if not best.rank < part.rank * (1.0 - 10.0 * _SAME):
            break
        part = replace(best, at_rest=len(free) - len(best.free))
    return part


def _roughly(scene: _Scene, gone: Bools, blocks: Ints, free: Ints) -> Part:
    """The limit of blocks that may move together, as well as it takes to know which of them do."""
    found = _model(scene, gone, free, idle=False)
    if found is None:
        return Part(*_untouched(scene.loads, free), blocks, free, np.zeros(0, dtype=np.int64))
    model, patch = found
    return Part(model, limit_of_blocks(model, max(scene.stop_when, _ROUGHLY), bounded=False), blocks, free, patch)


def _together(scene: _Scene, gone: Bools, blocks: Ints, free: Ints) -> Part:
    """The limit of blocks that may move together."""
    rough = _roughly(scene, gone, blocks, free)
    if rough.limit.factor is None or rough.limit.change == 0.0:
        return rough
    # what is at rest in the mechanism only reacts: the factor is settled with the blocks that move
    moving, _ = _moving(rough, scene.sizes)
    if len(moving) < len(free):
        parts = [_together(scene, gone, blocks, group) for group in _components(scene.assembly, np.sort(moving))]
        part = min(parts, key=lambda found: found.rank)
        if abs(part.rank / rough.rank - 1.0) < _ALIKE * max(rough.limit.change, _ROUGHLY):
            return replace(part, at_rest=len(free) - len(part.free))
    return replace(rough, limit=limit_of_blocks(rough.model, scene.stop_when, bounded=False, after=rough.limit))


def _bounded(scene: _Scene, there: Bools, part: Part) -> Part:
    """A part with its static bound."""
    found = _model(scene, ~there & ~scene.assembly.fixed, part.free, idle=True)
    return part if found is None else replace(part, limit=with_bound(found[0], part.limit))


def _in_layers(scene: _Scene, gone: Bools, blocks: Ints) -> Part:
    """The first mechanism of a large component, layer by layer from the free surface."""
    depth = depths(scene.assembly, gone, blocks)
    deepest, layers = int(depth.max()), _FIRST_LAYERS
    before: float | None = None
    while True:
        free = blocks[depth < layers]
        parts = [_limit(scene, gone, blocks, group) for group in _components(scene.assembly, free)]
        part = min(parts, key=lambda found: found.rank)
        held = len(blocks) - len(free)
        if part.limit.outcome in (Outcome.LIFTED, Outcome.NO_STRENGTH) or layers > deepest:
            return replace(part, held=held, layers=min(layers, deepest + 1))
        if before is not None and before > 0.0 and (before < math.inf or layers > deepest):
            change = 0.0 if part.rank == before else abs(part.rank / before - 1.0) if before < math.inf else math.inf
            if change < max(scene.stop_when, _LAYER):
                return replace(part, held=held, layers=layers, change=change)
        before, layers = part.rank, layers + 1


def _untouched(loads: AssemblyLoads, free: Ints) -> tuple[AssemblyModel, BlocksLimit]:
    """A block that touches nothing: its load moves it."""
    none, pairs = np.zeros(0, dtype=np.int64), np.zeros(0)
    load = np.concatenate([loads.forces[free], loads.moments[free]], axis=1)
    size = max(float(np.abs(load).max()), 1e-300)
    model = AssemblyModel(
        plus=none, minus=none, plus_motion=np.zeros((0, 6, 6)), minus_motion=np.zeros((0, 6, 6)),
        pair_contact=none, normal_rows=np.zeros((0, 6)), group_contact=none, slip_rows=np.zeros((0, 2, 6)),
        group_first=none, control_area=pairs, cohesion=pairs, tan_friction=pairs, tan_dilation=pairs, patch=none,
        points=np.zeros((0, 3)), moving=free, load=load / size, length_scale=1.0, force_scale=size, area_scale=1.0,
        kinematics=sparse.csr_matrix((0, load.size)), statics=sparse.csr_matrix((load.size, 0)),
    )  # fmt: skip
    driven = float(np.abs(load).max()) > 0.0
    limit = BlocksLimit(
        Outcome.LIFTED if driven else Outcome.NO_DRIVING_FORCE, None, 0.0, load / size, pairs, np.zeros((0, 2)),
        pairs, None, 0, 0, 0,
    )  # fmt: skip
    return model, limit


def block_sizes(assembly: Assembly) -> Floats:
    """Half the size of each block, m: in a section that of its area, whatever the thickness."""
    root = np.cbrt(assembly.volumes)
    if assembly.in_section and len(assembly.patches):
        ends = assembly.patches.corners.reshape(-1, 2, 3)
        length = float(np.sqrt(((ends[:, 1] - ends[:, 0]) ** 2).sum(axis=1)).sum())
        root = np.sqrt(assembly.volumes * length / float(assembly.patches.areas.sum()))
    return root / 2.0


def _moving(part: Part, size: Floats) -> tuple[Ints, Floats]:
    """The blocks of a part that move, and their motion (k, 6): displacement, rotation per m; the fastest has 1."""
    velocity = part.limit.velocity
    moves = np.zeros((len(velocity), 6))
    if velocity.shape[1] == 3:
        moves[:, [0, 2, 4]] = velocity
    else:
        moves[:] = velocity
    moves[:, 3:] /= part.model.length_scale
    speed = np.maximum(
        np.sqrt((moves[:, :3] ** 2).sum(axis=1)),
        np.sqrt((moves[:, 3:] ** 2).sum(axis=1)) * size[part.model.moving],
    )
    fastest = max(float(speed.max()), 1e-300)
    found = np.flatnonzero(speed > MOVES * fastest)
    return part.model.moving[found], moves[found] / fastest
