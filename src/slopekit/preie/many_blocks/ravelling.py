"""What fails first, what fails next: the mechanisms of an assembly one after the other.

Blocks that touch only through bedrock form components, and each is solved for itself: a block that touches nothing
changes nothing. The component with the lowest factor gives the mechanism; its moving blocks are taken away, and only
what is left of that component is solved anew. Contacts in space that twist get finer node pairs until the factor stays.

Mechanisms lighter than a given weight are chips: they are taken away first, and are no answer to whether a slope holds.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import takewhile
from operator import attrgetter

import numpy as np
from scipy import sparse

from slopekit.core.arrays import Bools, Floats, Ints, frozen
from slopekit.geometry.patches import Assembly
from slopekit.loads import AssemblyLoads, drained, without_anchors_of
from slopekit.preie.many_blocks.blocks import limit_of_blocks, load_limit, with_range
from slopekit.preie.many_blocks.blocks_limit import Basis, BlocksLimit
from slopekit.preie.many_blocks.groups import Groups
from slopekit.preie.many_blocks.key_blocks import slide_alone, sliding_direction
from slopekit.preie.outcome import Outcome
from slopekit.preie.solvers import work_limit
from slopekit.preie.solvers.threads import one_thread
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.system.components import WholeAssembly, block_sizes, components, model_of
from slopekit.preie.system.contact import SHEAR_TO_NORMAL
from slopekit.preie.system.model import JointStrength
from slopekit.preie.tolerances import MESH_CHANGE, MOVES, RESTS_NEAR, SAME_FACTOR, SAME_LIMIT, TINY, TWISTS

ModelPatch = tuple[AssemblyModel, Ints]  # of a component, and the assembly's patch of each of its contacts

_LARGE = 24  # blocks in space: fewer are one path
_MOST_SPLIT, _MOST_PAIRS = 3, 6000  # of contacts: splits, and node pairs


@dataclass(frozen=True, eq=False)
class Part:
    """A solved component.

    Attributes
    ----------
    blocks : (n,) indices in the assembly of the blocks that may move
    patch : (k,) the assembly's patch of each contact of the model
    refined : (p,) how often the triangles of each patch of the assembly were split, None where none was
    mesh_change : what the last split did to the factor, in parts of it, None where none was made
    groups : what its limit was found with, as long as the range of its mechanism may be asked for
    """

    model: AssemblyModel
    limit: BlocksLimit
    blocks: Ints
    patch: Ints
    refined: Ints | None = None
    mesh_change: float | None = None
    groups: Groups | None = field(default=None, repr=False)

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
        return self.limit.multiplier or self.limit.factor


@dataclass(frozen=True)
class Failure:
    """One mechanism: the parts that fail together (at the same factor), and the blocks (k,) that move.

    `motion` (k, 6) displacement and rotation (per m) of the blocks, the fastest motion 1; `is_chip`: it is too light to
    count.
    """

    parts: tuple[Part, ...]
    blocks: Ints
    motion: Floats
    is_chip: bool = False

    @property
    def limit(self) -> BlocksLimit:
        """The limit of its first part."""
        return self.parts[0].limit


@dataclass(frozen=True)
class Ravelling:
    """The sequence of mechanisms and chips, the parts at the first mechanism, and the blocks (b,) left at the end.

    `ended` says why the sequence ends: count, stands, gone or not_converged.
    """

    sequence: tuple[Failure, ...]
    parts: tuple[Part, ...]
    left: Bools
    ended: str

    @property
    def failures(self) -> tuple[Failure, ...]:
        """The mechanisms that are no chips."""
        return tuple(failure for failure in self.sequence if not failure.is_chip)

    @property
    def chips(self) -> tuple[Failure, ...]:
        """The chips that were taken away before the first mechanism."""
        return tuple(takewhile(attrgetter("is_chip"), self.sequence))

    def gone(self, most: float = math.inf) -> Bools:
        """Return the blocks (b,) of those chips that fail at no more than this factor."""
        gone = np.zeros(len(self.left), dtype=bool)
        for chip in self.chips:
            gone[chip.blocks] = chip.parts[0].rank <= most
        return gone

    @property
    def static_bound(self) -> float | None:
        """That of all blocks: some forces balance the loads where some do in every component, so the least.

        None where none is known, nothing balances one of them, or that of one with a factor was not found.
        """
        limits = [part.limit for part in self.parts]
        unknown = (limit.factor is not None and limit.static_bound is None and not limit.locked for limit in limits)
        if any(unknown) or any(limit.outcome is Outcome.LIFTED for limit in limits):
            return None
        return min((limit.static_bound for limit in limits if limit.static_bound is not None), default=None)


def ravel(
    assembly: Assembly,
    loads: AssemblyLoads,
    strength: JointStrength,
    count: int = 1,
    ranged: bool = True,
    lightest: float = 0.0,
) -> Ravelling:
    """The first `count` mechanisms of an assembly.

    Parameters
    ----------
    strength : indexed by the patches' joint
    ranged : whether the range of the mechanisms' factors is wanted
    lightest : weight of the lightest mechanism that counts, kN; lighter ones are chips, but where nothing heavier fails
    """
    scene = WholeAssembly(assembly, loads, strength, ranged)
    with one_thread():
        ravelling = _ravel(scene, count, lightest)
        return ravelling if ravelling.failures or not ravelling.sequence else _ravel(scene, count, 0.0)


def _ravel(scene: WholeAssembly, count: int, lightest: float) -> Ravelling:
    assembly, size = scene.assembly, block_sizes(scene.assembly)
    present = ~assembly.fixed
    with work_limit.allowed(work_limit.MOST):
        parts = list(_solved(scene, present, np.flatnonzero(present)))
    first = parts
    sequence: list[Failure] = []
    found = 0
    ended = "count"
    while True:
        with work_limit.allowed(work_limit.MOST):
            parts = _refined(scene, present, parts, _by_strength)
        rank = min((part.rank for part in parts), default=math.inf)
        if not found:
            first = parts
        if rank == math.inf:
            ended = "stands" if parts else "gone"
            break
        together = [part for part in parts if part.rank <= rank + abs(rank) * SAME_LIMIT]
        left = [part for part in parts if part.rank > rank + abs(rank) * SAME_LIMIT]
        slides = _sliding_alone(scene, present, parts, rank)
        if slides is not None:
            number, alone = slides
            together, left = [alone], [part for k, part in enumerate(parts) if k != number]
        light = [_is_chip(scene, part, size, lightest) for part in together]
        is_chip = any(light)
        if is_chip:  # those first, however heavy what fails with them
            left += [part for part, chip in zip(together, light, strict=True) if not chip]
            together = [part for part, chip in zip(together, light, strict=True) if chip]
        elif slides is None:
            with work_limit.allowed(work_limit.MOST):
                together = [_ranged(scene, part) for part in together]
        if not is_chip:
            together = [_with_lowest_alone(scene, present, part, lightest) for part in together]
        moved = [_moving(part, size) for part in together]
        blocks = np.concatenate([fallen for fallen, _ in moved])
        motion = np.concatenate([motion for _, motion in moved])
        sequence.append(Failure(tuple(together), blocks, motion, is_chip))
        if any(part.limit.outcome is Outcome.NOT_CONVERGED for part in together):
            ended = "not_converged"
            break
        if not found and not is_chip:
            first = [*together, *left]
        found += not is_chip
        present[blocks] = False
        freed = _let_go(scene.loads, present, assembly.fixed)
        scene = _drained(scene, present)
        if found == count:
            break
        again = [part for part in left if freed[part.blocks].any()]
        left = [part for part in left if not freed[part.blocks].any()]
        with work_limit.allowed(work_limit.MOST):
            for part in again:
                left += _solved(scene, present, part.blocks)
            for part in together:
                left += _solved(scene, present, part.blocks[present[part.blocks]])
        parts = left
    return Ravelling(tuple(sequence), tuple(replace(part, groups=None) for part in first), present, ended)


def _is_chip(scene: WholeAssembly, part: Part, size: Floats, lightest: float) -> bool:
    """Whether what moves of a part is lighter than what counts."""
    blocks, _ = _moving(part, size)
    known = part.limit.outcome is not Outcome.NOT_CONVERGED
    return known and float(scene.loads.weights[blocks].sum()) < lightest


def _sliding_alone(
    scene: WholeAssembly, present: Bools, parts: Sequence[Part], limit: float
) -> tuple[int, Part] | None:
    """Return the block that slides alone at the lowest factor by forces, as a part and the number of its part.

    None where no block does at less than the limit of all parts. Asked of blocks in space on which no other presses
    that may move, without dilation, passive bolts or curved strength: else forces alone have no one factor.
    """
    assembly, lowest, number = scene.assembly, limit * (1.0 - SAME_FACTOR), -1
    gone, slider = ~present & ~assembly.fixed, -1
    for k, part in enumerate(parts):
        if not _has_forces_alone(part):
            continue
        alone = part.blocks[~_pressed_by_others(assembly, present, part)[part.blocks]]
        blocks, factors = slide_alone(assembly, scene.loads, scene.strength, gone, alone)
        if len(blocks) and factors[0] < lowest:
            slider, lowest, number = int(blocks[0]), float(factors[0]), k
    if number < 0:
        return None
    part = parts[number]
    velocity = np.zeros_like(part.limit.velocity)
    direction = sliding_direction(assembly, scene.loads, scene.strength, gone, slider)
    velocity[part.model.moving == slider, :3] = direction
    of_path = replace(part.limit, highest=max(part.limit.factor or 0.0, part.limit.highest or 0.0))
    slides = replace(
        of_path, outcome=Outcome.SLIDES, factor=lowest, basis=Basis.ALONE, change=0.0, velocity=frozen(velocity),
        lowest=min(lowest, part.limit.lowest or lowest), group=0,
    )  # fmt: skip
    return number, replace(part, limit=slides, groups=None)


def _has_forces_alone(part: Part) -> bool:
    """Return whether forces alone have one factor of each block of a part."""
    model = part.model
    straight = model.lines is None and not len(model.bolts) and not bool(model.tan_dilation.any())
    return straight and model.unknowns == 6 and part.limit.factor is not None


def _pressed_by_others(assembly: Assembly, present: Bools, part: Part) -> Bools:
    """Return which blocks (b,) of the assembly another one presses on at the limit of a part that may move as well."""
    patches, model = assembly.patches, part.model
    pressed = np.bincount(model.pair_contact, part.limit.normal_force, len(model.plus))[: len(part.patch)] > 0.0
    plus, minus = patches.plus[part.patch[pressed]], patches.minus[part.patch[pressed]]
    moves = np.append(present & ~assembly.fixed, False)
    between = moves[plus] & moves[minus]
    crowded = np.zeros(len(assembly), dtype=bool)
    crowded[plus[between]] = crowded[minus[between]] = True
    return crowded


def _let_go(loads: AssemblyLoads, present: Bools, fixed: Bools) -> Bools:
    """Blocks (n,) at whose anchors nothing pulls any more, as those at the other ends are gone."""
    out = np.append(~present & ~fixed, False)
    freed = np.zeros(len(present), dtype=bool)
    freed[[load.block for load in loads.pushes if out[load.tied]]] = True
    return freed


def _drained(scene: WholeAssembly, present: Bools) -> WholeAssembly:
    """The scene without water in the joints of blocks that are gone, and without the anchors to them."""
    assembly = scene.assembly
    out = np.append(~present & ~assembly.fixed, False)
    opened = out[assembly.patches.plus] | out[assembly.patches.minus]
    return replace(scene, loads=without_anchors_of(assembly, drained(assembly, scene.loads, opened), out[:-1]))


def critical_load(
    assembly: Assembly,
    loads: AssemblyLoads,
    ramp: tuple[Floats, Floats],
    strength: JointStrength,
    reduction: float,
    lightest: float = 0.0,
) -> tuple[float, Failure] | None:
    """The lowest multiplier of a load on top of others at which the strength times λ just holds, over all components.

    Parameters
    ----------
    ramp : forces and moments (b, 3) that grow
    lightest : weight of the lightest mechanism that counts, kN; lighter ones are taken away, but where nothing heavier
        fails

    Returns
    -------
    multiplier (of the last state at rest, where the motion did not settle) and mechanism; None where the blocks do not
    stand without the ramp, or stand with any of it
    """
    scene = WholeAssembly(assembly, replace(loads, live=ramp), strength)
    with one_thread(), work_limit.allowed(work_limit.MOST):
        try:
            found = _critical_load(scene, reduction, lightest)
            return found if found is not None or not lightest else _critical_load(scene, reduction, 0.0)
        except work_limit.WorkSpentError:  # before the first step of a path
            return None


def _critical_load(scene: WholeAssembly, reduction: float, lightest: float) -> tuple[float, Failure] | None:
    """The multiplier and the mechanism of `critical_load`."""
    fixed, size, present = scene.assembly.fixed, block_sizes(scene.assembly), ~scene.assembly.fixed
    by_load = partial(_by_load, reduction)
    found: list[Part] = []
    waiting = [np.flatnonzero(present)]
    while waiting:
        among = waiting.pop()
        among = among[present[among]]
        blocks, *others = components(scene, among) or [among]
        waiting += others
        model_patch = model_of(scene, present, blocks) if len(blocks) else None
        gone = np.zeros(len(present), dtype=bool)
        if model_patch is not None and model_patch[0].live.any():
            part = by_load(scene, present, blocks, model_patch)
            if part.limit.multiplier:
                found.append(part)
            elif part.rank < math.inf:
                gone = _chips_at_once(scene, present, reduction, lightest)
                if not gone[blocks].any():
                    return None
                waiting.append(blocks)
        if found and not waiting:
            found = sorted(_refined(scene, present, found, by_load), key=attrgetter("rank"))
            if _is_chip(scene, found[0], size, lightest):
                chip = found.pop(0)
                gone[_moving(chip, size)[0]] = True
                waiting.append(chip.blocks)
        if gone.any():
            present &= ~gone
            freed = _let_go(scene.loads, present, fixed) | gone
            waiting += [part.blocks for part in found if freed[part.blocks].any()]
            found = [part for part in found if not freed[part.blocks].any()]
            left = _drained(scene, present)
            scene = replace(left, loads=replace(left.loads, live=scene.loads.live))
    if not found:
        return None
    return found[0].rank, Failure((found[0],), *_moving(found[0], size))


def _chips_at_once(scene: WholeAssembly, present: Bools, reduction: float, lightest: float) -> Bools:
    """The chips (b,) that do not stand where nothing grows, with the strength reduced."""
    gone = ~present & ~scene.assembly.fixed
    live = np.zeros_like(scene.loads.live[0]), np.zeros_like(scene.loads.live[1])
    still = replace(scene, assembly=scene.assembly.without(gone), loads=replace(scene.loads, live=live), ranged=False)
    chips = np.zeros(len(present), dtype=bool)
    for failure in _ravel(still, 1, lightest).chips:
        if failure.parts[0].rank * reduction >= 1.0:
            break
        chips[failure.blocks] = True
    return chips


def _by_load(
    reduction: float,
    scene: WholeAssembly,
    present: Bools,
    blocks: Ints,
    model_patch: ModelPatch,
    refine: Ints | None = None,
) -> Part:
    """A component at its limit in the live load, its strength reduced; where laws are curved on the lines of that."""
    model, patch = model_patch
    if model.lines is None:
        return Part(model, load_limit(model, model.live, reduction), blocks, patch, refine)
    from slopekit.preie.system.strength_lines import settled_load  # only curved laws pay for it

    return Part(*settled_load(model, reduction), blocks, patch, refine)


def _solved(scene: WholeAssembly, present: Bools, among: Ints) -> Iterator[Part]:
    """The components among some blocks, each solved; blocks that are not `there` nor fixed are gone."""
    for blocks in components(scene, among):
        model_patch = model_of(scene, present, blocks)
        if model_patch is None:
            yield Part(*_untouched(scene.loads, blocks), blocks, np.zeros(0, dtype=np.int64))
        else:
            yield _by_strength(scene, present, blocks, model_patch)


def _by_strength(
    scene: WholeAssembly, present: Bools, blocks: Ints, model_patch: ModelPatch, refine: Ints | None = None
) -> Part:
    """A component at its limit in strength."""
    model, patch = model_patch
    groups = Groups(scene, present, blocks, model, refine) if _large(model) else None
    return Part(*component_limit(model, groups), blocks, patch, refine, groups=groups)


def _large(model: AssemblyModel) -> bool:
    """Whether groups of a component propose its limit."""
    return model.unknowns == 6 and len(model.load) > _LARGE


def component_limit(
    model: AssemblyModel, proposal: Groups | None = None, ratio: float = SHEAR_TO_NORMAL
) -> tuple[AssemblyModel, BlocksLimit]:
    """The limit of a component, and its model: where laws are curved with the lines that the limit settled on.

    The range of its mechanism comes later, of those that fail first.
    """
    if model.lines is None:
        return model, limit_of_blocks(model, False, ratio, proposal)
    from slopekit.preie.system.strength_lines import settled_blocks  # only curved laws pay for it

    return settled_blocks(model, partial(limit_of_blocks, ranged=False, ratio=ratio), proposal)


def limit_again(model: AssemblyModel, divided_by: float = 1.0, ratio: float = SHEAR_TO_NORMAL) -> BlocksLimit:
    """The limit of a component whose limit is known, its strength divided, or on joints of another k_t / k_n.

    It is found as the first was: where laws are curved not on the lines that this settled on.
    """
    other = replace(model, cohesion=model.cohesion / divided_by, tan_friction=model.tan_friction / divided_by)
    if other.lines is not None:
        from slopekit.preie.system.strength_lines import by_laws  # only curved laws pay for it

        other = by_laws(replace(other, lines=other.lines.reduced(divided_by)))
    return component_limit(other, ratio=ratio)[1]


def _ranged(scene: WholeAssembly, part: Part) -> Part:
    """A part with the range of its mechanism, where that is wanted."""
    limit = with_range(part.model, part.limit, part.groups) if scene.ranged else part.limit
    return replace(part, limit=limit, groups=None)


def _with_lowest_alone(scene: WholeAssembly, present: Bools, part: Part, lightest: float) -> Part:
    """A part whose lowest factor is no higher than that of a block that would slide alone by forces.

    It may be held by what others press on it; it is no chip.
    """
    if not scene.ranged or not _has_forces_alone(part):
        return part
    assembly, heavy = scene.assembly, scene.loads.weights[part.blocks] >= lightest
    gone = ~present & ~assembly.fixed
    _, factors = slide_alone(assembly, scene.loads, scene.strength, gone, part.blocks[heavy])
    lowest = part.limit.lowest or part.limit.factor or 0.0
    if not len(factors) or factors[0] >= lowest * (1.0 - SAME_FACTOR):
        return part
    return replace(part, limit=replace(part.limit, lowest=float(factors[0])))


def finer_model(
    assembly: Assembly, loads: AssemblyLoads, strength: JointStrength, part: Part, level: int
) -> AssemblyModel:
    """The model of a part once more, the triangles of all its contacts split in four so often."""
    free = np.ones(len(assembly), dtype=bool)
    refine = np.full(len(assembly.patches), level, dtype=np.int64)
    model_patch = model_of(WholeAssembly(assembly, loads, strength), free, part.blocks, refine)
    assert model_patch is not None  # the part has a model
    return model_patch[0]


def _refined(scene: WholeAssembly, present: Bools, parts: list[Part], solved: Callable[..., Part]) -> list[Part]:
    """The parts, those that come first with finer node pairs where contacts twist or are partly open."""
    done: set[int] = set()
    while True:
        first = min(range(len(parts)), key=lambda k: parts[k].rank, default=None)
        if first is None or first in done:
            return parts
        done.add(first)
        parts = [*parts[:first], _split(scene, present, parts[first], solved), *parts[first + 1 :]]


def _split(scene: WholeAssembly, present: Bools, part: Part, solved: Callable[..., Part]) -> Part:
    """A part with contacts split where that matters until its limit stays, or its node pairs are too many."""
    for level in range(1, _MOST_SPLIT + 1):
        coarse, is_peak = _too_coarse(part), part.limit.basis is Basis.PEAK
        if not coarse.any() or (is_peak and _large(part.model)):
            break
        refine = np.zeros(len(scene.assembly.patches), dtype=np.int64) if part.refined is None else part.refined.copy()
        refine[part.patch[coarse[: len(part.patch)]]] = level
        model_patch = model_of(scene, present, part.blocks, refine)
        if model_patch is None or len(model_patch[0].control_area) > _MOST_PAIRS:
            break
        finer = solved(scene, present, part.blocks, model_patch, refine)
        if not 0.0 < finer.rank < math.inf:
            break
        if (finer.limit.multiplier or 0.0) > (1.0 + RESTS_NEAR) * part.rank:
            break  # they rest past the load at which a motion ends the path on coarser pairs
        change = abs(finer.rank / part.rank - 1.0)
        if finer.limit.basis is Basis.PEAK and not is_peak and finer.rank > part.rank:
            return replace(part, mesh_change=change)  # a last rest raises no limit of a motion
        part = replace(finer, mesh_change=change, groups=None)
        if change < MESH_CHANGE:
            break
    return part


def _too_coarse(part: Part) -> Bools:
    """Return the contacts (k,) whose forces depend on where their node pairs lie.

    Partly open ones with cohesion; in space those without as well, of a motion that has settled, but where blocks slide
    as one, which have one factor; and in space those that slip about a point near them.
    """
    model, limit = part.model, part.limit
    contacts = len(model.plus)
    if not limit.factor or contacts == 0:
        return np.zeros(contacts, dtype=bool)

    def summed(of_pairs: Floats) -> Floats:
        """Of contacts (k,), without bolts, which neither open in part nor twist."""
        total = np.bincount(model.pair_contact, of_pairs, contacts).astype(np.float64)
        total[len(part.patch) :] = 0.0
        return total

    area, bonds = summed(model.control_area), summed(model.cohesion)
    touching = summed(model.control_area * (limit.normal_force > 0.0))
    partly_open: Bools = (touching > 0.0) & (touching < (1.0 - SAME_LIMIT) * area)
    if model.unknowns == 3 or limit.basis is Basis.PEAK or _slides_rigidly(limit.velocity):
        partly_open &= bonds > 0.0
    if model.unknowns == 3:
        return partly_open
    velocity = np.concatenate([limit.velocity, np.zeros((1, model.unknowns))])
    motion = np.einsum("kij,kj->ki", model.plus_motion, velocity[model.plus])
    motion += np.einsum("kij,kj->ki", model.minus_motion, velocity[model.minus])
    carries = summed(limit.normal_force + model.cohesion * limit.bond / limit.factor)
    twist = np.abs(motion[:, 3]) * np.sqrt(area * model.area_scale) / model.length_scale / 2.0
    speed = np.sqrt((motion[:, 1:3] ** 2).sum(axis=1)) + twist
    twists: Bools = (twist > TWISTS * speed) & (carries * twist > TWISTS * float((carries * speed).sum()))
    return partly_open | twists


def _slides_rigidly(velocity: Floats) -> bool:
    """Return whether the blocks that move in space do so alike and do not turn."""
    speed = np.abs(velocity).max(axis=1)
    moving = velocity[speed > MOVES * float(speed.max())]
    differ = max(float(np.ptp(moving, axis=0).max()), float(np.abs(moving[:, 3:]).max()))
    return differ < TWISTS * float(speed.max())


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
        np.zeros((0, 2)), pairs,
    )  # fmt: skip
    return model, limit


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
