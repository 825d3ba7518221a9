"""What fails first, what fails next: the mechanisms of an assembly one after the other.

Blocks that touch only through bedrock form components, and each is solved for itself: a block that touches nothing
changes nothing. The component with the lowest factor gives the mechanism; its moving blocks are taken away, and only
what is left of that component is solved anew. Contacts in space that twist get finer node pairs until the factor stays.
"""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from threadpoolctl import threadpool_limits

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.core.records import dataclass
from slopekit.geometry.patches import BEDROCK, Assembly, Patches
from slopekit.loads import AssemblyLoads, drained
from slopekit.preie import effort
from slopekit.preie.assembly import AssemblyModel, build_assembly
from slopekit.preie.bed import Bed, Drive
from slopekit.preie.blocks import Basis, BlocksLimit, Span, first_limit, limit_of_blocks, load_limit, unit_bound
from slopekit.preie.bonds import Rounds
from slopekit.preie.bounds import mechanism_range
from slopekit.preie.distance import StaticBound
from slopekit.preie.key_blocks import slide_alone
from slopekit.preie.model import JointStrength
from slopekit.preie.passes import Outcome
from slopekit.preie.path_limit import PathLimit, PathOutcome
from slopekit.preie.rests import JUST, at_their_limit, rests_before
from slopekit.preie.tolerances import BOUND_ACCURACY, FLOWS, MESH_CHANGE, MOVES, RESTS_NEAR, SAME_RANK, TINY, TWISTS

_LARGE = 24  # blocks in space: fewer are one path
_MOST_GROUPS, _MOST_GROUP = 8, 0.5  # groups that are tried, and how much of all a group may be
_LONG = 100  # blocks of which the path takes seconds
_OF_GROUP = 0.3  # of the work that is left, for the limit of a group
_MOST_SPLIT, _MOST_PAIRS = 3, 6000  # of contacts that twist: splits, and node pairs


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """A solved component.

    Attributes
    ----------
    blocks : (n,) indices in the assembly of the blocks that may move
    patch : (k,) the assembly's patch of each contact of the model
    refined : (p,) how often the triangles of each patch of the assembly were split, None where none was
    mesh_change : what the last split did to the factor, in parts of it, None where none was made
    """

    model: AssemblyModel
    limit: BlocksLimit
    blocks: Ints
    patch: Ints
    refined: Ints | None = None
    mesh_change: float | None = None

    @property
    def rank(self) -> float:
        """Where it stands in the order of failure: what no strength holds comes first, what nothing drives last."""
        if self.limit.outcome in (Outcome.LIFTED, Outcome.NO_REST):
            return -1.0
        if self.limit.outcome is Outcome.NOT_CONVERGED and self.limit.factor is None:
            return -0.5  # it is not known to stand
        if self.limit.outcome is Outcome.NO_STRENGTH:
            return 0.0
        if self.limit.outcome is Outcome.NO_DRIVING_FORCE or self.limit.factor is None:
            return math.inf
        return self.limit.factor


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
    assembly: Assembly, loads: AssemblyLoads, strength: JointStrength, count: int = 1, ranged: bool = True
) -> Ravelling:
    """The first `count` mechanisms of an assembly.

    Parameters
    ----------
    strength : indexed by the patches' joint
    ranged : whether the range of the mechanisms' factors is wanted
    """
    scene = _WholeAssembly(assembly, loads, strength, ranged)
    with threadpool_limits(1):  # bands and fronts are narrow: threads would only wait for each other
        return _ravel(scene, count)


def _ravel(scene: "_WholeAssembly", count: int) -> Ravelling:
    assembly, size = scene.assembly, block_sizes(scene.assembly)
    there = ~assembly.fixed
    with effort.allowed(effort.MOST):
        parts = list(_solved(scene, there, np.flatnonzero(there)))
    first = parts
    failures: list[Failure] = []
    ended = "count"
    while len(failures) < count:
        with effort.allowed(effort.MOST):
            parts = _refined(scene, there, parts)
        rank = min((part.rank for part in parts), default=math.inf)
        if rank == math.inf:
            ended = "stands" if parts else "gone"
            break
        together = [part for part in parts if part.rank <= rank + abs(rank) * SAME_RANK]
        moved = [_moving(part, size) for part in together]
        blocks = np.concatenate([fallen for fallen, _ in moved])
        failures.append(Failure(tuple(together), blocks, np.concatenate([motion for _, motion in moved])))
        if any(part.limit.outcome is Outcome.NOT_CONVERGED for part in together):
            ended = "not_converged"
            break
        left = [part for part in parts if part.rank > rank + abs(rank) * SAME_RANK]
        if len(failures) == 1:
            first = [*together, *left]
        there[blocks] = False
        out = np.append(~there & ~assembly.fixed, False)
        opened = out[assembly.patches.plus] | out[assembly.patches.minus]
        scene = replace(scene, loads=drained(assembly, scene.loads, opened))
        if len(failures) == count:
            break
        with effort.allowed(effort.MOST):
            for part in together:
                left += _solved(scene, there, part.blocks[there[part.blocks]])
        parts = left
    return Ravelling(tuple(failures), tuple(first), there, ended)


@dataclass(frozen=True, slots=True, eq=False)
class _WholeAssembly:
    """What every part of an assembly shares."""

    assembly: Assembly
    loads: AssemblyLoads
    strength: JointStrength
    ranged: bool = True


def whole_model(
    assembly: Assembly, loads: AssemblyLoads, strength: JointStrength, refine: Ints | None = None
) -> AssemblyModel | None:
    """One model of all blocks that touch something and are not fixed; None where there is none.

    Parameters
    ----------
    refine : (k,) how often the triangles of each contact in space are split in four
    """
    patches = assembly.patches
    touched = np.zeros(len(assembly) + 1, dtype=bool)
    touched[patches.plus] = touched[patches.minus] = True
    held = assembly.fixed | ~touched[:-1]
    free = np.append(~held, False)
    if not (free[patches.plus] | free[patches.minus]).any():
        return None
    return build_assembly(
        patches, held, assembly.centroids, loads.forces, loads.moments, strength, assembly.in_section,
        refine, loads.live, loads.bolts,
    )  # fmt: skip


@dataclass(frozen=True, slots=True)
class CriticalLoad:
    """A multiplier of a load and the mechanism there.

    Attributes
    ----------
    multiplier : of the limit state, or, where the motion did not settle, of the last state at rest
    failure : the mechanism
    runs : in that case the first multiplier at which the blocks run, None otherwise
    """

    multiplier: float
    failure: Failure
    runs: float | None


def critical_load(
    assembly: Assembly, loads: AssemblyLoads, ramp: tuple[Floats, Floats], strength: JointStrength, reduction: float
) -> CriticalLoad | None:
    """The lowest multiplier of a load on top of others at which the strength times λ just holds, over all components.

    Parameters
    ----------
    ramp : forces and moments (b, 3) that grow

    None where the blocks do not stand without the ramp, or stand with any of it.
    """
    scene = _WholeAssembly(assembly, replace(loads, live=ramp), strength)
    there = ~assembly.fixed
    lowest: tuple[float, Part, float | None] | None = None
    with threadpool_limits(1), effort.allowed(effort.MOST):
        for blocks in _components(scene, np.flatnonzero(there)):
            model_patch = _model(scene, there, blocks)
            if model_patch is None or not model_patch[0].live.any():
                continue
            model, patch = model_patch
            try:
                model, path, limit = _load_limit(model, reduction)
            except effort.EffortSpentError:  # before the first step of a path
                return None
            if path.parameter is not None and (path.found or path.outcome is PathOutcome.BRACKET):
                if lowest is None or path.parameter < lowest[0]:
                    runs = None if path.found or path.peak is None else path.peak[1]
                    lowest = path.parameter, Part(model, limit, blocks, patch), runs
            elif path.outcome is not PathOutcome.STANDS:
                return None
    if lowest is None:
        return None
    multiplier, part, runs = lowest
    blocks, motion = _moving(part, block_sizes(assembly))
    return CriticalLoad(multiplier, Failure((part,), blocks, motion), runs)


def _load_limit(model: AssemblyModel, reduction: float) -> tuple[AssemblyModel, PathLimit, BlocksLimit]:
    """The limit in the live load, and the model: where laws are curved with the lines that it settled on."""
    if model.lines is None:
        return model, *load_limit(model, model.live, reduction)
    from slopekit.preie.strength_lines import settled_load  # only curved laws pay for it

    return settled_load(model, reduction)


def _solved(scene: _WholeAssembly, there: Bools, among: Ints) -> Iterator[Part]:
    """The components among some blocks, each solved; blocks that are not `there` nor fixed are gone."""
    for blocks in _components(scene, among):
        model_patch = _model(scene, there, blocks)
        if model_patch is None:
            yield Part(*_untouched(scene.loads, blocks), blocks, np.zeros(0, dtype=np.int64))
        else:
            model, patch = model_patch
            large = model.unknowns == 6 and len(blocks) > _LARGE and model.lines is None
            groups = _Groups(scene, there, blocks, model, patch) if large else None
            yield Part(*component_limit(model, scene.ranged, groups), blocks, patch)


def component_limit(
    model: AssemblyModel, ranged: bool, proposal: "_Groups | None" = None, begun: Rounds | None = None
) -> tuple[AssemblyModel, BlocksLimit]:  # fmt: skip
    """The limit of a component, and its model: where laws are curved with the lines that the limit settled on."""
    if model.lines is None:
        return model, limit_of_blocks(model, ranged, proposal=proposal, begun=begun)
    from slopekit.preie.strength_lines import settled_blocks  # only curved laws pay for it

    return settled_blocks(model, limit_of_blocks)


class _Groups:
    """A large component in space: the limit of a group, the others held, proposes that of all.

    The first group is the single block that slides out most easily, with its neighbours. All blocks together, none
    held, then come to rest at just a little more strength than the group's limit, or flow: who flows is the next
    group. Where they rest just before it, their strength along its motion used up or running beyond, it is that of all.
    """

    def __init__(self, scene: "_WholeAssembly", there: Bools, blocks: Ints, model: AssemblyModel, patch: Ints) -> None:
        self.scene, self.there, self.blocks, self.model, self.patch = scene, there, blocks, model, patch
        gone = ~there & ~scene.assembly.fixed
        self.alone, _ = slide_alone(scene.assembly, scene.loads, scene.strength, gone, blocks)
        self.found: tuple[AssemblyModel, PathLimit, Floats] | None = None
        self.known: dict[bytes, tuple[AssemblyModel, Ints] | None] = {}  # models of groups
        self.bounds: dict[bytes, StaticBound] = {}
        self.group = np.zeros(0, dtype=np.int64)  # the last that was found: with fewer bonds the first to try
        self.solved: tuple[bytes, tuple[AssemblyModel, PathLimit, Floats] | None] = b"", None  # the last, and its bonds
        self.snapped: PathLimit | None = None  # the peak of a group, as one of all
        self.near = self.group  # and that which is solved alone in between

    def _known(self, group: Ints) -> tuple[AssemblyModel, Ints] | None:
        """The model of a group."""
        key = group.tobytes()
        if key not in self.known:
            self.known[key] = _model(self.scene, self.there, group)
        return self.known[key]

    def _bound(self, group: Ints, model: AssemblyModel) -> StaticBound:
        """The bound of a group, which does not depend on what bonds are left."""
        key = group.tobytes()
        if key not in self.bounds:
            self.bounds[key] = unit_bound(model)
        return self.bounds[key]

    def span(self) -> Span | None:
        """The range of the group's mechanism: what is held beside it can carry any force, so it is none too narrow."""
        if self.found is None:
            return None
        model, limit, bond = self.found
        assert limit.parameter is not None
        return mechanism_range(model, limit.motion, 1.0 / limit.parameter, bond, (limit.normal, limit.friction))

    def _first(self) -> Ints:
        """The group to begin with."""
        bolts = self.scene.loads.bolts
        bolted = np.isin(self.alone, np.append(bolts.head, bolts.toe))  # bolts hold what would slide out without them
        first = self.alone[np.argsort(bolted, kind="stable")][:1]
        return self.group if len(self.group) else _with_neighbours(self.scene.assembly, first, self.blocks)

    def _of_group(self, group: Ints, bond: Floats) -> tuple[AssemblyModel, PathLimit, Floats] | None:
        """The model of a group with all others held, its limit with some bonds (m,) of all, and its own bonds."""
        known = self._known(group) if len(group) <= _MOST_GROUP * len(self.blocks) else None
        if known is None:
            return None
        small, own = known
        key = group.tobytes() + bond.tobytes()
        if key == self.solved[0]:
            return self.solved[1]
        broken, lost = np.zeros(len(self.scene.assembly.patches), dtype=bool), self.model.pair_contact[bond == 0.0]
        broken[self.patch[lost[lost < len(self.patch)]]] = True  # bolts are contacts beyond them
        opened = np.append(broken[own], np.zeros(len(small.bolts), dtype=bool))
        own_bond = np.where(opened[small.pair_contact], 0.0, 1.0)
        try:
            with effort.part(_OF_GROUP):
                limit = first_limit(small, own_bond, self._bound(group, small))
        except effort.EffortSpentError:
            return None
        solution = None if limit is None or limit.parameter is None else (small, limit, own_bond)
        self.solved = key, solution
        return solution

    def _of_all(self, small: AssemblyModel, limit: PathLimit) -> PathLimit:
        """A limit of a group, its motion that of all blocks."""
        model = self.model
        motion = np.zeros_like(model.load)
        motion[np.searchsorted(model.moving, small.moving)] = limit.motion.reshape(small.load.shape)
        motion *= np.where(np.arange(6) < 3, 1.0, model.length_scale / small.length_scale)
        return replace(limit, motion=motion.ravel())

    def limit_alone(self, bond: Floats) -> PathLimit | None:
        """The limit of the group that failed last, with some bonds (m,); none of its forces are those of all."""
        solution = self._of_group(self.near, bond) if len(self.near) else None
        if solution is None:
            return None
        small, limit, _ = solution
        return replace(self._of_all(small, limit), group=len(self.near))

    def peak(self) -> PathLimit | None:
        """The peak of the group that the last limit of all was not found with; None of few blocks."""
        return self.snapped if len(self.blocks) > _LONG else None

    def begins_with(self, motion: Floats) -> None:
        """Blocks that move in a motion (N,) of all, and their neighbours, are solved alone from now on.

        They are the first group as well where the path of all takes long.
        """
        group = _with_neighbours(self.scene.assembly, self._movers(motion), self.blocks)
        if len(group) <= _MOST_GROUP * len(self.blocks):
            self.near = group
            if len(self.blocks) > _LONG:
                self.group = group

    def _movers(self, motion: Floats) -> Ints:
        """Blocks that move in a motion (N,) of all."""
        moved = motion.reshape(self.model.load.shape)
        speed = np.sqrt((moved[:, :3] ** 2).sum(axis=1))
        movers: Ints = self.model.moving[speed > FLOWS * float(speed.max())]
        return movers

    def limit(self, bond: Floats, top: float, peaks: bool = False) -> PathLimit | None:
        """The limit of all blocks with some bonds (m,), at most `top`; None where groups lead nowhere.

        Parameters
        ----------
        peaks : the peak of a group proposes as well
        """
        scene, model, blocks = self.scene, self.model, self.blocks
        self.found, self.snapped = None, None
        if not len(self.alone):
            return None
        bed = Bed(model, Drive(model.load.ravel()), bond)
        group, work = self._first(), 0
        for _ in range(_MOST_GROUPS):
            solution = self._of_group(group, bond)
            if solution is None:
                return None
            small, limit, own_bond = solution
            assert limit.parameter is not None
            if not limit.found and not peaks:  # it may be a snap of slivers
                self.snapped = self._of_all(small, limit)
                return None
            work += limit.factorisations
            factor = 1.0 / limit.parameter
            below = min(factor, top)
            flow, gap = rests_before(bed, below, RESTS_NEAR)
            if flow.ended == "rest":
                if factor > top * (1.0 + BOUND_ACCURACY):
                    return None
                self.group, self.near, of_group = group, group, (small, limit, own_bond)
                limit = self._of_all(small, limit)
                if not at_their_limit(bed, flow, limit):
                    return None
                self.found = of_group
                rested, width = 1.0 / (below * (1.0 - gap)), 1.0 - (1.0 - gap) * below / factor
                at, forces = bed.polished(flow.at, rested)
                if gap > JUST or not limit.found:  # what all blocks vouch for is the last state at rest
                    limit = replace(limit, outcome=PathOutcome.BRACKET, parameter=rested, peak=(rested, 1.0 / factor))
                    width = 0.0
                settled = PathOutcome.SETTLED if limit.found else limit.outcome
                return replace(
                    limit, outcome=settled, width=width, group=len(group), displacement=at,
                    normal=forces.normal, friction=forces.friction,
                    residual=forces.residual / bed.load_size, factorisations=bed.factorisations + work,
                )  # fmt: skip
            if flow.ended == "lost":
                return None
            movers = self._movers(flow.at - flow.before)
            group = _with_neighbours(scene.assembly, group if np.isin(movers, group).all() else movers, blocks)
        return None


def _with_neighbours(assembly: Assembly, group: Ints, among: Ints) -> Ints:
    """A group of blocks with those among others that touch it."""
    patches, inside = assembly.patches, np.zeros(len(assembly) + 1, dtype=bool)
    inside[group] = True
    near = np.concatenate([
        group, patches.plus[inside[patches.minus] & (patches.minus >= 0)], patches.minus[inside[patches.plus]]
    ])  # fmt: skip
    return np.intersect1d(near, among)


def _components(scene: _WholeAssembly, among: Ints) -> list[Ints]:
    """Blocks that touch each other or are bolted together, not only bedrock or what is held, together."""
    if len(among) == 0:
        return []
    assembly, bolts = scene.assembly, scene.loads.bolts
    plus, minus = np.append(assembly.patches.plus, bolts.head), np.append(assembly.patches.minus, bolts.toe)
    inside = np.zeros(len(assembly) + 1, dtype=bool)
    inside[among] = True
    both = inside[plus] & inside[minus] & (minus >= 0) & (plus >= 0)
    graph = sparse.coo_matrix((np.ones(int(both.sum())), (plus[both], minus[both])), shape=(len(assembly),) * 2)
    _, label = connected_components(graph, directed=False)
    order = np.argsort(label[among], kind="stable")
    ends = np.flatnonzero(np.diff(label[among][order])) + 1
    return np.split(among[order], ends)


def _model(
    scene: _WholeAssembly, there: Bools, free: Ints, refine: Ints | None = None
) -> tuple[AssemblyModel, Ints] | None:
    """The model with the blocks `free` moving and all others held, those that are gone taken away, and its patches.

    A block that has gone takes its bolts with it.
    """
    assembly, patches, loads = scene.assembly, scene.assembly.patches, scene.loads
    held = np.ones(len(assembly), dtype=bool)
    held[free] = False
    out, moves = np.append(~there & ~assembly.fixed, False), np.append(~held, False)  # bedrock never goes nor moves
    kept = (moves[patches.plus] | moves[patches.minus]) & ~out[patches.plus] & ~out[patches.minus]
    if not kept.any():
        return None
    off = out[loads.bolts.head] | out[loads.bolts.toe]
    head, toe = (np.where(off, BEDROCK, end) for end in (loads.bolts.head, loads.bolts.toe))
    model = build_assembly(
        _chosen(patches, kept), held, assembly.centroids, loads.forces, loads.moments, scene.strength,
        assembly.in_section, None if refine is None else refine[kept], loads.live,
        replace(loads.bolts, head=head, toe=toe),
    )  # fmt: skip
    return model, np.flatnonzero(kept)[model.patch]


def finer_model(
    assembly: Assembly, loads: AssemblyLoads, strength: JointStrength, part: Part, level: int
) -> AssemblyModel:
    """The model of a part once more, the triangles of all its contacts split in four so often."""
    free = np.ones(len(assembly), dtype=bool)
    refine = np.full(len(assembly.patches), level, dtype=np.int64)
    model_patch = _model(_WholeAssembly(assembly, loads, strength), free, part.blocks, refine)
    assert model_patch is not None  # the part has a model
    return model_patch[0]


def _chosen(patches: Patches, kept: Bools) -> Patches:
    """Some patches (k,) of an assembly, in their order."""
    counts = np.diff(patches.first)
    first = np.concatenate([[0], np.cumsum(counts[kept])])
    return Patches(
        patches.plus[kept], patches.minus[kept], patches.joint[kept], patches.normals[kept], patches.areas[kept],
        patches.centroids[kept], patches.corners[np.repeat(kept, counts)], first,
    )  # fmt: skip


def _refined(scene: _WholeAssembly, there: Bools, parts: list[Part]) -> list[Part]:
    """The parts, those that come first with finer node pairs where their mechanism twists contacts."""
    done: set[int] = set()
    while True:
        first = min(range(len(parts)), key=lambda k: parts[k].rank, default=None)
        if first is None or first in done:
            return parts
        done.add(first)
        parts = [*parts[:first], _split(scene, there, parts[first]), *parts[first + 1 :]]


def _split(scene: _WholeAssembly, there: Bools, part: Part) -> Part:
    """A part with the contacts that twist split until its factor stays, or its node pairs are too many."""
    for level in range(1, _MOST_SPLIT + 1):
        twists = _twisting(part)
        if not twists.any():
            break
        refine = np.zeros(len(scene.assembly.patches), dtype=np.int64) if part.refined is None else part.refined.copy()
        refine[part.patch[twists[: len(part.patch)]]] = level
        model_patch = _model(scene, there, part.blocks, refine)
        if model_patch is None or len(model_patch[0].control_area) > _MOST_PAIRS:
            break
        model, limit = component_limit(model_patch[0], scene.ranged, begun=part.limit.rounds)
        if not limit.factor or not part.limit.factor:
            break
        change = abs(limit.factor / part.limit.factor - 1.0)
        part = replace(part, model=model, patch=model_patch[1], limit=limit, refined=refine, mesh_change=change)
        if change < MESH_CHANGE:
            break
    return part


def _twisting(part: Part) -> Bools:
    """Contacts in space (k,) that slip about a point near them: their friction depends on where their pairs lie."""
    model, limit = part.model, part.limit
    if model.unknowns == 3 or not limit.factor or len(model.plus) == 0:
        return np.zeros(len(model.plus), dtype=bool)
    velocity = np.concatenate([limit.velocity, np.zeros((1, model.unknowns))])
    motion = np.einsum("kij,kj->ki", model.plus_motion, velocity[model.plus])
    motion += np.einsum("kij,kj->ki", model.minus_motion, velocity[model.minus])
    radius = np.sqrt(np.bincount(model.pair_contact, model.control_area, len(model.plus)) * model.area_scale)
    twist = np.abs(motion[:, 3]) * radius / model.length_scale / 2.0
    slip = np.sqrt((motion[:, 1:3] ** 2).sum(axis=1))
    carries = np.bincount(model.pair_contact, limit.normal_force, len(model.plus)) + np.bincount(
        model.pair_contact, model.cohesion * limit.bond / limit.factor, len(model.plus)
    )  # what is left of cohesion at the limit: it does not depend on what the strength is divided by
    carries[len(part.patch) :] = 0.0  # bolts do not twist
    weighs = carries * twist
    twisting: Bools = (twist > TWISTS * (slip + twist)) & (weighs > TWISTS * float((carries * (slip + twist)).sum()))
    return twisting


def _untouched(loads: AssemblyLoads, free: Ints) -> tuple[AssemblyModel, BlocksLimit]:
    """A block that touches nothing: its load moves it."""
    none, pairs = np.zeros(0, dtype=np.int64), np.zeros(0)
    load = np.concatenate([loads.forces[free], loads.moments[free]], axis=1)
    size = max(float(np.abs(load).max()), TINY)
    model = AssemblyModel(
        plus=none, minus=none, plus_motion=np.zeros((0, 6, 6)), minus_motion=np.zeros((0, 6, 6)),
        pair_contact=none, normal_rows=np.zeros((0, 6)), group_contact=none, slip_rows=np.zeros((0, 2, 6)),
        group_first=none, control_area=pairs, cohesion=pairs, tan_friction=pairs, tan_dilation=pairs, patch=none,
        points=np.zeros((0, 3)), moving=free, load=load / size, live=np.zeros_like(load), length_scale=1.0,
        force_scale=size, area_scale=1.0, kinematics=sparse.csr_matrix((0, load.size)),
        statics=sparse.csr_matrix((load.size, 0)),
    )  # fmt: skip
    driven = float(np.abs(load).max()) > 0.0
    limit = BlocksLimit(
        Outcome.LIFTED if driven else Outcome.NO_DRIVING_FORCE, None, Basis.NONE, 0.0, load / size, pairs,
        np.zeros((0, 2)), pairs, None, None, None, None, False, 0, 0,
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
    fastest = max(float(speed.max()), TINY)
    fast = np.flatnonzero(speed > MOVES * fastest)
    return part.model.moving[fast], moves[fast] / fastest
