"""Ravelling: the mechanisms of an assembly of blocks in the order in which they fail.

Blocks that touch each other form a component; components touch through bedrock only and are solved separately. The
component with the lowest factor gives the mechanism. Its moving blocks are removed, and the rest of that component is
solved again. Contacts in space that twist get finer node pairs until the factor no longer changes.

Mechanisms lighter than a given weight are chips: they are removed first and do not decide whether a slope is stable.
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
from slopekit.preie.many_blocks.key_blocks import blocks_that_slide_alone, sliding_direction
from slopekit.preie.outcome import Outcome
from slopekit.preie.solvers import work_limit
from slopekit.preie.solvers.threads import one_thread
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.system.components import WholeAssembly, block_sizes, components, model_of_blocks
from slopekit.preie.system.contact import SHEAR_TO_NORMAL
from slopekit.preie.system.model import JointStrength
from slopekit.preie.tolerances import (
    MESH_CHANGE,
    MOVES,
    RESTS_NEAR,
    SAME_FACTOR,
    SAME_LIMIT,
    TINY,
    TWISTS,
)

ModelPatch = tuple[
    AssemblyModel, Ints
]  # of a component, and the assembly's patch of each of its contacts

_MOST_WITHOUT_GROUPS = 24  # blocks in space whose limit is found by one path of all
_MOST_SPLIT, _MOST_PAIRS = 3, 6000  # of contacts: splits, and node pairs


@dataclass(frozen=True, eq=False)
class SolvedComponent:
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
        """The place in the order of failure: -1 where no strength holds the blocks, else by factor."""
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
    """One mechanism: the components that fail at the same factor, and the blocks (k,) that move.

    `motion` (k, 6) displacement and rotation (per m) of the blocks, the fastest motion 1; `is_chip`: it is too light to
    count.
    """

    parts: tuple[SolvedComponent, ...]
    blocks: Ints
    motion: Floats
    is_chip: bool = False

    @property
    def limit(self) -> BlocksLimit:
        """The limit of its first component."""
        return self.parts[0].limit


@dataclass(frozen=True)
class Ravelling:
    """The sequence of mechanisms and chips, the components at the first mechanism, and the blocks (b,) left at the end.

    `ended` says why the sequence ends: count, stands, gone or not_converged.
    """

    sequence: tuple[Failure, ...]
    parts: tuple[SolvedComponent, ...]
    blocks_left: Bools
    ended: str

    @property
    def failures(self) -> tuple[Failure, ...]:
        """The mechanisms that are no chips."""
        return tuple(failure for failure in self.sequence if not failure.is_chip)

    @property
    def chips(self) -> tuple[Failure, ...]:
        """The chips that were removed before the first mechanism."""
        return tuple(takewhile(attrgetter("is_chip"), self.sequence))

    def gone(self, most: float = math.inf) -> Bools:
        """Return the blocks (b,) of those chips that fail at no more than this factor."""
        gone = np.zeros(len(self.blocks_left), dtype=bool)
        for chip in self.chips:
            gone[chip.blocks] = chip.parts[0].rank <= most
        return gone

    @property
    def static_bound(self) -> float | None:
        """The static bound of all blocks: the least of those of their components.

        None where none is known, nothing balances one of them, or that of one with a factor was not found.
        """
        limits = [component.limit for component in self.parts]
        unknown = (
            limit.factor is not None and limit.static_bound is None and not limit.locked
            for limit in limits
        )
        if any(unknown) or any(limit.outcome is Outcome.LIFTED for limit in limits):
            return None
        return min(
            (limit.static_bound for limit in limits if limit.static_bound is not None), default=None
        )


def ravel(
    assembly: Assembly,
    loads: AssemblyLoads,
    strength: JointStrength,
    count: int = 1,
    ranged: bool = True,
    lightest: float = 0.0,
) -> Ravelling:
    """Return the first `count` mechanisms of an assembly.

    Parameters
    ----------
    strength : indexed by the patches' joint
    ranged : whether the range of the mechanisms' factors is wanted
    lightest : weight of the lightest mechanism that counts, kN; lighter ones are chips, but where nothing heavier fails
    """
    scene = WholeAssembly(assembly, loads, strength, ranged)
    with one_thread():
        ravelling = _ravel(scene, count, lightest)
        return (
            ravelling if ravelling.failures or not ravelling.sequence else _ravel(scene, count, 0.0)
        )


def _ravel(scene: WholeAssembly, count: int, lightest: float) -> Ravelling:
    assembly, size = scene.assembly, block_sizes(scene.assembly)
    present = ~assembly.fixed
    with work_limit.work_budget(work_limit.LIMIT_UNITS):
        remaining = list(_solve_components(scene, present, np.flatnonzero(present)))
    first = remaining
    sequence: list[Failure] = []
    mechanism_count = 0
    ended = "count"
    while True:
        with work_limit.work_budget(work_limit.LIMIT_UNITS):
            remaining = _with_finer_pairs(scene, present, remaining, _solve_for_strength)
        rank = min((component.rank for component in remaining), default=math.inf)
        if not mechanism_count:
            first = remaining
        if rank == math.inf:
            ended = "stands" if remaining else "gone"
            break
        failing = [
            component for component in remaining if component.rank <= rank + abs(rank) * SAME_LIMIT
        ]
        later_components = [
            component for component in remaining if component.rank > rank + abs(rank) * SAME_LIMIT
        ]
        slides = _sliding_alone(scene, present, remaining, rank)
        if slides is not None:
            number, sliding = slides
            failing, later_components = (
                [sliding],
                [component for k, component in enumerate(remaining) if k != number],
            )
        light = [_is_chip(scene, component, size, lightest) for component in failing]
        is_chip = any(light)
        if is_chip:  # those first, however heavy what fails with them
            later_components += [
                component for component, chip in zip(failing, light, strict=True) if not chip
            ]
            failing = [component for component, chip in zip(failing, light, strict=True) if chip]
        elif slides is None:
            with work_limit.work_budget(work_limit.LIMIT_UNITS):
                failing = [_with_range(scene, component) for component in failing]
        if not is_chip:
            failing = [
                _with_lowest_alone(scene, present, component, lightest) for component in failing
            ]
        motions = [_moving_blocks(component, size) for component in failing]
        blocks = np.concatenate([fallen for fallen, _ in motions])
        motion = np.concatenate([motion for _, motion in motions])
        sequence.append(Failure(tuple(failing), blocks, motion, is_chip))
        if any(component.limit.outcome is Outcome.NOT_CONVERGED for component in failing):
            ended = "not_converged"
            break
        if not mechanism_count and not is_chip:
            first = [*failing, *later_components]
        mechanism_count += not is_chip
        present[blocks] = False
        freed = _blocks_without_anchors(scene.loads, present, assembly.fixed)
        scene = _without_water_and_anchors(scene, present)
        if mechanism_count == count:
            break
        to_solve_anew = [
            component for component in later_components if freed[component.blocks].any()
        ]
        later_components = [
            component for component in later_components if not freed[component.blocks].any()
        ]
        with work_limit.work_budget(work_limit.LIMIT_UNITS):
            for component in to_solve_anew:
                later_components += _solve_components(scene, present, component.blocks)
            for component in failing:
                later_components += _solve_components(
                    scene, present, component.blocks[present[component.blocks]]
                )
        remaining = later_components
    return Ravelling(
        tuple(sequence),
        tuple(replace(component, groups=None) for component in first),
        present,
        ended,
    )


def _is_chip(
    scene: WholeAssembly, component: SolvedComponent, size: Floats, lightest: float
) -> bool:
    """Whether the moving blocks of a component are lighter than the lightest mechanism that counts."""
    blocks, _ = _moving_blocks(component, size)
    is_known = component.limit.outcome is not Outcome.NOT_CONVERGED
    return is_known and float(scene.loads.weights[blocks].sum()) < lightest


def _sliding_alone(
    scene: WholeAssembly, present: Bools, solved: Sequence[SolvedComponent], limit: float
) -> tuple[int, SolvedComponent] | None:
    """Return the component with its lowest factor by forces where a single block slides alone, and its number.

    None where no block does at less than the limit of all components. Asked of blocks in space on which no other
    movable block presses, without dilation, passive bolts or curved strength: else forces alone have no one factor.
    """
    assembly, lowest, number = scene.assembly, limit * (1.0 - SAME_FACTOR), -1
    gone, slider = ~present & ~assembly.fixed, -1
    for k, component in enumerate(solved):
        if not _has_forces_alone(component):
            continue
        candidates = component.blocks[
            ~_pressed_by_others(assembly, present, component)[component.blocks]
        ]
        blocks, factors = blocks_that_slide_alone(
            assembly, scene.loads, scene.strength, gone, candidates
        )
        if len(blocks) and factors[0] < lowest:
            slider, lowest, number = int(blocks[0]), float(factors[0]), k
    if number < 0:
        return None
    component = solved[number]
    velocity = np.zeros_like(component.limit.velocity)
    direction = sliding_direction(assembly, scene.loads, scene.strength, gone, slider)
    velocity[component.model.moving == slider, :3] = direction
    of_path = replace(
        component.limit, highest=max(component.limit.factor or 0.0, component.limit.highest or 0.0)
    )
    slides = replace(
        of_path,
        outcome=Outcome.SLIDES,
        factor=lowest,
        basis=Basis.ALONE,
        change=0.0,
        velocity=frozen(velocity),
        lowest=min(lowest, component.limit.lowest or lowest),
        group=0,
    )
    return number, replace(component, limit=slides, groups=None)


def _has_forces_alone(component: SolvedComponent) -> bool:
    """Return whether forces alone define one factor for each block of a component."""
    model = component.model
    straight = model.lines is None and not len(model.bolts) and not bool(model.tan_dilation.any())
    return straight and model.unknowns == 6 and component.limit.factor is not None


def _pressed_by_others(assembly: Assembly, present: Bools, component: SolvedComponent) -> Bools:
    """Return the blocks (b,) of the assembly that another movable block presses on at the limit of a component."""
    patches, model = assembly.patches, component.model
    pressed = (
        np.bincount(model.pair_contact, component.limit.normal_force, len(model.plus))[
            : len(component.patch)
        ]
        > 0.0
    )
    plus, minus = patches.plus[component.patch[pressed]], patches.minus[component.patch[pressed]]
    moves = np.append(present & ~assembly.fixed, False)
    between = moves[plus] & moves[minus]
    crowded = np.zeros(len(assembly), dtype=bool)
    crowded[plus[between]] = crowded[minus[between]] = True
    return crowded


def _blocks_without_anchors(loads: AssemblyLoads, present: Bools, fixed: Bools) -> Bools:
    """Return the blocks (n,) that lose an anchor because the block at its other end is gone."""
    is_gone = np.append(~present & ~fixed, False)
    freed = np.zeros(len(present), dtype=bool)
    freed[[load.block for load in loads.pushes if is_gone[load.tied]]] = True
    return freed


def _without_water_and_anchors(scene: WholeAssembly, present: Bools) -> WholeAssembly:
    """Return the scene without water in the joints of removed blocks and without the anchors to them."""
    assembly = scene.assembly
    is_gone = np.append(~present & ~assembly.fixed, False)
    opened = is_gone[assembly.patches.plus] | is_gone[assembly.patches.minus]
    return replace(
        scene,
        loads=without_anchors_of(assembly, drained(assembly, scene.loads, opened), is_gone[:-1]),
    )


def critical_load(
    assembly: Assembly,
    loads: AssemblyLoads,
    ramp: tuple[Floats, Floats],
    strength: JointStrength,
    reduction: float,
    lightest: float = 0.0,
) -> tuple[float, Failure] | None:
    """Return the lowest multiplier of a growing load at which the strength times λ just holds, over all components.

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
    with one_thread(), work_limit.work_budget(work_limit.LIMIT_UNITS):
        try:
            solution = _critical_load(scene, reduction, lightest)
            return (
                solution
                if solution is not None or not lightest
                else _critical_load(scene, reduction, 0.0)
            )
        except work_limit.WorkSpentError:  # before the first step of a path
            return None


def _critical_load(
    scene: WholeAssembly, reduction: float, lightest: float
) -> tuple[float, Failure] | None:
    """Return the multiplier and the mechanism of `critical_load`."""
    fixed, size, present = scene.assembly.fixed, block_sizes(scene.assembly), ~scene.assembly.fixed
    solve = partial(_solve_for_load, reduction)
    solved: list[SolvedComponent] = []
    waiting = [np.flatnonzero(present)]
    while waiting:
        group = waiting.pop()
        group = group[present[group]]
        blocks, *other_components = components(scene, group) or [group]
        waiting += other_components
        model_patch = model_of_blocks(scene, present, blocks) if len(blocks) else None
        gone = np.zeros(len(present), dtype=bool)
        if model_patch is not None and model_patch[0].live.any():
            component = solve(scene, present, blocks, model_patch)
            if component.limit.multiplier:
                solved.append(component)
            elif component.rank < math.inf:
                gone = _chips_at_once(scene, present, reduction, lightest)
                if not gone[blocks].any():
                    return None
                waiting.append(blocks)
        if solved and not waiting:
            solved = sorted(
                _with_finer_pairs(scene, present, solved, solve), key=attrgetter("rank")
            )
            if _is_chip(scene, solved[0], size, lightest):
                chip = solved.pop(0)
                gone[_moving_blocks(chip, size)[0]] = True
                waiting.append(chip.blocks)
        if gone.any():
            present &= ~gone
            freed = _blocks_without_anchors(scene.loads, present, fixed) | gone
            waiting += [component.blocks for component in solved if freed[component.blocks].any()]
            solved = [component for component in solved if not freed[component.blocks].any()]
            drained_scene = _without_water_and_anchors(scene, present)
            scene = replace(
                drained_scene, loads=replace(drained_scene.loads, live=scene.loads.live)
            )
    if not solved:
        return None
    return solved[0].rank, Failure((solved[0],), *_moving_blocks(solved[0], size))


def _chips_at_once(
    scene: WholeAssembly, present: Bools, reduction: float, lightest: float
) -> Bools:
    """Return the chips (b,) that fail at the reduced strength without the growing load."""
    gone = ~present & ~scene.assembly.fixed
    live = np.zeros_like(scene.loads.live[0]), np.zeros_like(scene.loads.live[1])
    scene_at_rest = replace(
        scene,
        assembly=scene.assembly.without_blocks(gone),
        loads=replace(scene.loads, live=live),
        ranged=False,
    )
    chips = np.zeros(len(present), dtype=bool)
    for failure in _ravel(scene_at_rest, 1, lightest).chips:
        if failure.parts[0].rank * reduction >= 1.0:
            break
        chips[failure.blocks] = True
    return chips


def _solve_for_load(
    reduction: float,
    scene: WholeAssembly,
    present: Bools,
    blocks: Ints,
    model_patch: ModelPatch,
    refine: Ints | None = None,
) -> SolvedComponent:
    """Solve a component for the multiplier of its live load, its strength reduced."""
    model, patch = model_patch
    if model.lines is None:
        return SolvedComponent(
            model, load_limit(model, model.live, reduction), blocks, patch, refine
        )
    from slopekit.preie.system.strength_lines import (
        load_limit_on_curved_laws,  # only curved laws pay for it
    )

    return SolvedComponent(*load_limit_on_curved_laws(model, reduction), blocks, patch, refine)


def _solve_components(
    scene: WholeAssembly, present: Bools, group: Ints
) -> Iterator[SolvedComponent]:
    """Solve the components among some blocks, one after the other; blocks neither `present` nor fixed are gone."""
    for blocks in components(scene, group):
        model_patch = model_of_blocks(scene, present, blocks)
        if model_patch is None:
            yield SolvedComponent(
                *_isolated_block(scene.loads, blocks), blocks, np.zeros(0, dtype=np.int64)
            )
        else:
            yield _solve_for_strength(scene, present, blocks, model_patch)


def _solve_for_strength(
    scene: WholeAssembly,
    present: Bools,
    blocks: Ints,
    model_patch: ModelPatch,
    refine: Ints | None = None,
) -> SolvedComponent:
    """Solve a component for its factor of safety."""
    model, patch = model_patch
    groups = Groups(scene, present, blocks, model, refine) if _has_groups(model) else None
    return SolvedComponent(*component_limit(model, groups), blocks, patch, refine, groups=groups)


def _has_groups(model: AssemblyModel) -> bool:
    """Whether groups of blocks propose the limit of a component."""
    return model.unknowns == 6 and len(model.load) > _MOST_WITHOUT_GROUPS


def component_limit(
    model: AssemblyModel, proposal: Groups | None = None, ratio: float = SHEAR_TO_NORMAL
) -> tuple[AssemblyModel, BlocksLimit]:
    """Return the model of a component, with curved laws on their final lines, and its limit.

    The range of the mechanism is computed later, for components that fail first.
    """
    if model.lines is None:
        return model, limit_of_blocks(model, False, ratio, proposal)
    from slopekit.preie.system.strength_lines import (
        limit_on_curved_laws,  # only curved laws pay for it
    )

    return limit_on_curved_laws(
        model, partial(limit_of_blocks, ranged=False, ratio=ratio), proposal
    )


def limit_with_other_strength(
    model: AssemblyModel, divided_by: float = 1.0, ratio: float = SHEAR_TO_NORMAL
) -> BlocksLimit:
    """Return the limit of a solved component with its strength divided, or with another ratio k_t / k_n.

    It is computed as the first was: curved laws begin anew, not on the lines of the known limit.
    """
    changed = replace(
        model, cohesion=model.cohesion / divided_by, tan_friction=model.tan_friction / divided_by
    )
    if changed.lines is not None:
        from slopekit.preie.system.strength_lines import (
            following_laws,  # only curved laws pay for it
        )

        changed = following_laws(replace(changed, lines=changed.lines.reduced(divided_by)))
    return component_limit(changed, ratio=ratio)[1]


def _with_range(scene: WholeAssembly, component: SolvedComponent) -> SolvedComponent:
    """Return a component with the range of its mechanism, where the scene asks for ranges."""
    limit = (
        with_range(component.model, component.limit, component.groups)
        if scene.ranged
        else component.limit
    )
    return replace(component, limit=limit, groups=None)


def _with_lowest_alone(
    scene: WholeAssembly, present: Bools, component: SolvedComponent, lightest: float
) -> SolvedComponent:
    """Return a component whose lowest factor includes those of blocks that would slide alone by forces.

    Such a block may be held by what others press on it; chips are not counted.
    """
    if not scene.ranged or not _has_forces_alone(component):
        return component
    assembly, heavy = scene.assembly, scene.loads.weights[component.blocks] >= lightest
    gone = ~present & ~assembly.fixed
    _, factors = blocks_that_slide_alone(
        assembly, scene.loads, scene.strength, gone, component.blocks[heavy]
    )
    lowest = component.limit.lowest or component.limit.factor or 0.0
    if not len(factors) or factors[0] >= lowest * (1.0 - SAME_FACTOR):
        return component
    return replace(component, limit=replace(component.limit, lowest=float(factors[0])))


def finer_model(
    assembly: Assembly,
    loads: AssemblyLoads,
    strength: JointStrength,
    component: SolvedComponent,
    level: int,
) -> AssemblyModel:
    """Return the model of a component with the triangles of all its contacts split in four `level` times."""
    free = np.ones(len(assembly), dtype=bool)
    refine = np.full(len(assembly.patches), level, dtype=np.int64)
    model_patch = model_of_blocks(
        WholeAssembly(assembly, loads, strength), free, component.blocks, refine
    )
    assert model_patch is not None  # the part has a model
    return model_patch[0]


def _with_finer_pairs(
    scene: WholeAssembly,
    present: Bools,
    solved_components: list[SolvedComponent],
    solve: Callable[..., SolvedComponent],
) -> list[SolvedComponent]:
    """Return the components, the first to fail with finer node pairs where contacts twist or are partly open."""
    done: set[int] = set()
    while True:
        first = min(
            range(len(solved_components)), key=lambda k: solved_components[k].rank, default=None
        )
        if first is None or first in done:
            return solved_components
        done.add(first)
        solved_components = [
            *solved_components[:first],
            _refine_contacts(scene, present, solved_components[first], solve),
            *solved_components[first + 1 :],
        ]


def _refine_contacts(
    scene: WholeAssembly,
    present: Bools,
    component: SolvedComponent,
    solve: Callable[..., SolvedComponent],
) -> SolvedComponent:
    """Refine the contacts of a component until its limit no longer changes, or its node pairs are too many."""
    for level in range(1, _MOST_SPLIT + 1):
        coarse, is_peak = _too_coarse(component), component.limit.basis is Basis.PEAK
        if not coarse.any() or (is_peak and _has_groups(component.model)):
            break
        refine = (
            np.zeros(len(scene.assembly.patches), dtype=np.int64)
            if component.refined is None
            else component.refined.copy()
        )
        refine[component.patch[coarse[: len(component.patch)]]] = level
        model_patch = model_of_blocks(scene, present, component.blocks, refine)
        if model_patch is None or len(model_patch[0].control_area) > _MOST_PAIRS:
            break
        finer = solve(scene, present, component.blocks, model_patch, refine)
        if not 0.0 < finer.rank < math.inf:
            break
        if (finer.limit.multiplier or 0.0) > (1.0 + RESTS_NEAR) * component.rank:
            break  # they rest past the load at which a motion ends the path on coarser pairs
        change = abs(finer.rank / component.rank - 1.0)
        if finer.limit.basis is Basis.PEAK and not is_peak and finer.rank > component.rank:
            return replace(component, mesh_change=change)  # a last rest raises no limit of a motion
        component = replace(finer, mesh_change=change, groups=None)
        if change < MESH_CHANGE:
            break
    return component


def _too_coarse(component: SolvedComponent) -> Bools:
    """Return the contacts (k,) whose forces depend on where their node pairs lie.

    Partly open ones with cohesion; in space those without as well, of a motion that has settled, but where blocks slide
    as one, which have one factor; and in space those that slip about a point near them.
    """
    model, limit = component.model, component.limit
    contacts = len(model.plus)
    if not limit.factor or contacts == 0:
        return np.zeros(contacts, dtype=bool)

    def summed(of_pairs: Floats) -> Floats:
        """Return sums over the contacts (k,); bolts, which neither open in part nor twist, have none."""
        total = np.bincount(model.pair_contact, of_pairs, contacts).astype(np.float64)
        total[len(component.patch) :] = 0.0
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
    twists: Bools = (twist > TWISTS * speed) & (
        carries * twist > TWISTS * float((carries * speed).sum())
    )
    return partly_open | twists


def _slides_rigidly(velocity: Floats) -> bool:
    """Return whether the blocks that move in space do so alike and do not turn."""
    speed = np.abs(velocity).max(axis=1)
    moving = velocity[speed > MOVES * float(speed.max())]
    differ = max(float(np.ptp(moving, axis=0).max()), float(np.abs(moving[:, 3:]).max()))
    return differ < TWISTS * float(speed.max())


def _isolated_block(loads: AssemblyLoads, free: Ints) -> tuple[AssemblyModel, BlocksLimit]:
    """Return the model and the limit of a block that touches nothing: its load moves it."""
    none, pairs = np.zeros(0, dtype=np.int64), np.zeros(0)
    load = np.concatenate([loads.forces[free], loads.moments[free]], axis=1)
    size = max(float(np.abs(load).max()), TINY)
    model = AssemblyModel(
        plus=none,
        minus=none,
        plus_motion=np.zeros((0, 6, 6)),
        minus_motion=np.zeros((0, 6, 6)),
        pair_contact=none,
        normal_rows=np.zeros((0, 6)),
        group_contact=none,
        slip_rows=np.zeros((0, 2, 6)),
        group_first=none,
        control_area=pairs,
        cohesion=pairs,
        tan_friction=pairs,
        tan_dilation=pairs,
        patch=none,
        points=np.zeros((0, 3)),
        moving=free,
        load=load / size,
        live=np.zeros_like(load),
        length_scale=1.0,
        force_scale=size,
        area_scale=1.0,
        kinematics=sparse.csr_matrix((0, load.size)),
        statics=sparse.csr_matrix((load.size, 0)),
    )
    driven = float(np.abs(load).max()) > 0.0
    limit = BlocksLimit(
        Outcome.LIFTED if driven else Outcome.NO_DRIVING_FORCE,
        None,
        Basis.NONE,
        0.0,
        load / size,
        pairs,
        np.zeros((0, 2)),
        pairs,
    )
    return model, limit


def _moving_blocks(component: SolvedComponent, size: Floats) -> tuple[Ints, Floats]:
    """Return the moving blocks of a component and their motion (k, 6), rotation per m; the fastest has 1."""
    velocity = component.limit.velocity
    moves = np.zeros((len(velocity), 6))
    if velocity.shape[1] == 3:
        moves[:, [0, 2, 4]] = velocity
    else:
        moves[:] = velocity
    moves[:, 3:] /= component.model.length_scale
    speed = np.maximum(
        np.sqrt((moves[:, :3] ** 2).sum(axis=1)),
        np.sqrt((moves[:, 3:] ** 2).sum(axis=1)) * size[component.model.moving],
    )
    fastest = max(float(speed.max()), TINY)
    fast = np.flatnonzero(speed > MOVES * fastest)
    return component.model.moving[fast], moves[fast] / fastest
