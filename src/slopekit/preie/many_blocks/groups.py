"""A large component in space by groups of it: the limit of a few blocks, all others held, proposes that of all."""

from dataclasses import replace

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.geometry.patches import Assembly
from slopekit.preie.elastic_path.bed import Bed
from slopekit.preie.elastic_path.bed_states import Drive
from slopekit.preie.elastic_path.falling import open_all_over
from slopekit.preie.elastic_path.flow import Flow
from slopekit.preie.elastic_path.path_limit import MANY, PathLimit, PathOutcome
from slopekit.preie.elastic_path.rests import JUST, at_their_limit, rest_at, rests_before
from slopekit.preie.many_blocks.blocks import first_limit, unit_bound
from slopekit.preie.many_blocks.blocks_limit import Span
from slopekit.preie.many_blocks.bonds import MOST_GROUPS
from slopekit.preie.many_blocks.key_blocks import slide_alone
from slopekit.preie.programs.bound import StaticBound
from slopekit.preie.programs.bounds import mechanism_range
from slopekit.preie.solvers import work_limit
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.system.components import WholeAssembly, model_of
from slopekit.preie.tolerances import BOUND_ACCURACY, FLOWS, RESTS_NEAR

_MOST_GROUP = 0.5  # how much of all a group may be
_OF_GROUP, _OF_OPEN = 0.6, 0.5  # of the work that is left, for the limit of a group, and a rest without more bonds

Solution = tuple[AssemblyModel, PathLimit, Floats]
"""The model of a group, its limit, and the bonds (m,) of all that are left there."""


class Groups:
    """A large component in space: the limit of a group, the others held, proposes that of all.

    The first group is the single block that slides out most easily, with its neighbours. All blocks together, none
    held, then come to rest at just a little more strength than the group's limit, or flow: who flows is the next
    group. Where they rest just before it, their strength along its motion used up or running beyond, it is that of all.
    Cohesive blocks may rest there with bonds that another group has broken by then, which fails sooner by itself: of
    those that are known the first to fail comes first.
    """

    def __init__(
        self, scene: WholeAssembly, there: Bools, blocks: Ints, model: AssemblyModel, patch: Ints,
        refine: Ints | None = None,
    ) -> None:  # fmt: skip
        self.scene, self.there, self.blocks, self.model, self.patch = scene, there, blocks, model, patch
        self.refine = refine
        gone = ~there & ~scene.assembly.fixed
        self.alone, _ = slide_alone(scene.assembly, scene.loads, scene.strength, gone, blocks)
        self.found: Solution | None = None
        self.known: dict[bytes, tuple[AssemblyModel, Ints] | None] = {}  # models of groups
        self.bounds: dict[bytes, StaticBound] = {}
        self.group = np.zeros(0, dtype=np.int64)  # the last that was found: with fewer bonds the first to try
        self.solved: dict[bytes, Solution | None] = {}  # of a group with some bonds
        self.last: Solution | None = None  # of them
        self.snapped: PathLimit | None = None  # the peak of a group, as one of all
        self.snaps = False  # whether the path of a group has ended in a peak: with fewer bonds it does so again
        self.near = self.group  # and that which is solved alone in between

    def _known(self, group: Ints) -> tuple[AssemblyModel, Ints] | None:
        """The model of a group."""
        key = group.tobytes()
        if key not in self.known:
            self.known[key] = model_of(self.scene, self.there, group, self.refine)
        return self.known[key]

    def _bound(self, group: Ints, model: AssemblyModel) -> StaticBound:
        """The bound of a group, which does not depend on what bonds are left."""
        key = group.tobytes()
        if key not in self.bounds:
            self.bounds[key] = unit_bound(model)
        return self.bounds[key]

    def span(self, motion: Floats) -> Span | None:
        """The range of the group's mechanism: what is held beside it can carry any force, so it is none too narrow.

        Parameters
        ----------
        motion : (n, 6) of the limit that is asked about; None where the group that was found last moves otherwise
        """
        if self.found is None:
            return None
        model, limit, _ = self.found
        assert limit.parameter is not None
        if not np.array_equal(self._of_all(self.found).motion, motion.ravel()):
            return None
        return mechanism_range(model, limit.motion, 1.0 / limit.parameter, limit.bond, (limit.normal, limit.friction))

    def _first(self, bond: Floats, falls: bool) -> Ints:
        """The group to begin with: of cohesive blocks the one that fails first."""
        bolts = self.scene.loads.bolts
        bolted = np.isin(self.alone, np.append(bolts.head, bolts.toe))  # bolts hold what would slide out without them
        first = self.alone[np.argsort(bolted, kind="stable")][:1]
        group = self.group if len(self.group) else _with_neighbours(self.scene.assembly, first, self.blocks)
        if not self.model.has_cohesion or not len(self.near):
            return group
        return max(group, self.near, key=lambda one: self._strength_at_limit(one, bond, falls))

    def _strength_at_limit(self, group: Ints, bond: Floats, falls: bool) -> float:
        """Of a group with all others held and some bonds (m,) of all; 0 where it has no limit."""
        solution = self._of_group(group, bond, falls)
        return solution[1].parameter or 0.0 if solution is not None and solution[1].found else 0.0

    def _of_group(self, group: Ints, bond: Floats, falls: bool) -> Solution | None:
        """The limit of a group with all others held and some bonds (m,) of all."""
        known = self._known(group) if len(group) <= _MOST_GROUP * len(self.blocks) else None
        if known is None:
            return None
        small, own = known
        lost = self._of_patches(self.model, self.patch, bond)
        own_bond = np.where(np.append(lost[own], np.zeros(len(small.bolts), dtype=bool))[small.pair_contact], 0.0, 1.0)
        key = group.tobytes() + own_bond.tobytes() + bytes(falls)
        if key not in self.solved:
            try:
                with work_limit.part(_OF_GROUP):
                    limit = first_limit(small, own_bond, self._bound(group, small), falls, at_once=not self.snaps)
            except work_limit.WorkSpentError:
                return None
            self.snaps |= limit is not None and limit.outcome is PathOutcome.BRACKET
            self.solved[key] = None
            if limit is not None and limit.parameter is not None:
                lost |= self._of_patches(small, own, limit.bond)
                broken = np.append(lost[self.patch], np.zeros(len(self.model.bolts), dtype=bool))
                self.solved[key] = small, limit, np.where(broken[self.model.pair_contact], 0.0, bond)
        self.last = self.solved[key]
        return self.last

    def _of_patches(self, model: AssemblyModel, patch: Ints, bond: Floats) -> Bools:
        """Patches (k,) of the assembly that have lost their cohesion, by the bonds (m,) of contacts on some of them."""
        lost, contacts = np.zeros(len(self.scene.assembly.patches), dtype=bool), model.pair_contact[bond == 0.0]
        lost[patch[contacts[contacts < len(patch)]]] = True  # bolts are contacts beyond them
        return lost

    def _of_all(self, solution: Solution) -> PathLimit:
        """A limit of a group, its motion and bonds those of all blocks."""
        small, limit, bond = solution
        return replace(limit, motion=self._moved(small, limit.motion, np.zeros(self.model.load.size)), bond=bond)

    def _rest_of_all(self, bed: Bed, solution: Solution) -> Flow | None:
        """All blocks at rest where a group was last, from there and joints that stick; None where they are not."""
        small, limit, _ = solution
        if limit.found or limit.parameter is None:
            return None
        model, unit = self.model, small.force_scale / small.area_scale
        moved = limit.displacement * unit * model.area_scale / model.force_scale
        at = self._moved(small, moved, bed.elastic_displacement)
        return rest_at(bed, at, limit.parameter)

    def _moved(self, small: AssemblyModel, motion: Floats, others: Floats) -> Floats:
        """A motion of the blocks of a group and that of all others (N,)."""
        model, rolls = self.model, np.arange(6) >= 3
        moved = others.reshape(model.load.shape).copy()
        own = motion.reshape(small.load.shape) * np.where(rolls, model.length_scale / small.length_scale, 1.0)
        moved[np.searchsorted(model.moving, small.moving)] = own
        return moved.ravel()

    def limit_alone(self, bond: Floats, falls: bool) -> PathLimit | None:
        """The limit of the group that failed last, with some bonds (m,); none of its forces are those of all."""
        solution = self._of_group(self.near, bond, falls) if len(self.near) else None
        if solution is None:
            return None
        return replace(self._of_all(solution), group=len(self.near))

    def held(self) -> tuple[float, int] | None:
        """The factor of the group that was solved last, all others held, and its blocks; None where none was found."""
        solution = self.last
        if solution is None or not solution[1].found or not solution[1].parameter:
            return None
        return 1.0 / solution[1].parameter, len(solution[0].load)

    def peak(self) -> PathLimit | None:
        """The peak of the group that the last limit of all was not found with; None of few blocks."""
        return self.snapped if self.model.load.size > MANY else None

    def begins_with(self, motion: Floats) -> None:
        """Blocks that move in a motion (N,) of all, and their neighbours, are solved alone from now on.

        They are the first group as well where the path of all takes long.
        """
        group = _with_neighbours(self.scene.assembly, self._movers(motion), self.blocks)
        if len(group) <= _MOST_GROUP * len(self.blocks):
            self.near = group
            if self.model.load.size > MANY:
                self.group = group

    def _movers(self, motion: Floats) -> Ints:
        """Blocks that move in a motion (N,) of all."""
        moved = motion.reshape(self.model.load.shape)
        speed = np.sqrt((moved[:, :3] ** 2).sum(axis=1))
        movers: Ints = self.model.moving[speed > FLOWS * float(speed.max())]
        return movers

    def limit(self, bond: Floats, falls: bool, top: float, peaks: bool = False) -> PathLimit | None:
        """The limit of all blocks with some bonds (m,), at most `top`; None where groups lead nowhere.

        Parameters
        ----------
        peaks : the peak of a group proposes as well
        """
        scene, model, blocks = self.scene, self.model, self.blocks
        self.found, self.snapped = None, None
        if not len(self.alone):
            return None
        group, work = self._first(bond, falls), 0
        for _ in range(MOST_GROUPS):
            solution = self._of_group(group, bond, falls)
            if solution is None:
                return None
            _, limit, left = solution
            assert limit.parameter is not None
            if not limit.found and not peaks:  # it may be a snap of slivers
                self.snapped = self._of_all(solution)
                return None
            bed = Bed(model, Drive(model.load.ravel()), left)
            work += limit.factorisations
            factor = 1.0 / limit.parameter
            below = min(factor, top)
            flow, gap = self._rest_of_all(bed, solution), 0.0
            if flow is None or factor > top:
                flow, gap = rests_before(bed, below, RESTS_NEAR)
            if flow.ended == "rest" and model.has_cohesion:
                bed, flow = _without_open(bed, flow, 1.0 / (below * (1.0 - gap)))
                if open_all_over(bed, flow) is not None and model.load.size <= MANY:
                    return None  # that rest counts on bonds of open contacts: the path of all decides
            if flow.ended == "rest":
                if factor > top * (1.0 + BOUND_ACCURACY):
                    return None
                self.group = self.near = group
                limit = replace(self._of_all(solution), bond=bed.bond)
                if limit.found and not at_their_limit(bed, flow, limit):  # a group that runs by itself has run
                    return None
                self.found = solution
                rested, width = 1.0 / (below * (1.0 - gap)), 1.0 - (1.0 - gap) * below / factor
                at, forces = (flow.at, flow.forces) if flow.rounding else bed.polished(flow.at, rested)
                if gap > JUST or not limit.found:  # what all blocks vouch for is the last state at rest
                    limit = replace(limit, outcome=PathOutcome.BRACKET, parameter=rested, peak=(rested, 1.0 / factor))
                    width = 0.0
                settled = PathOutcome.SETTLED if limit.found else limit.outcome
                return replace(
                    limit, outcome=settled, width=width, group=len(group), displacement=at,
                    normal=forces.normal, friction=forces.friction,
                    residual=forces.residual / bed.load_size, factorisations=bed.factorisations + work,
                    rounding=flow.rounding, touching=flow.forces.touching if flow.rounding else None,
                )  # fmt: skip
            if flow.ended == "lost":
                return None
            movers = self._movers(flow.at - flow.before)
            group = _with_neighbours(scene.assembly, group if np.isin(movers, group).all() else movers, blocks)
        return None


def _without_open(bed: Bed, flow: Flow, parameter: float) -> tuple[Bed, Flow]:
    """From a rest of all blocks to one without bonds of contacts that are open all over, if that is found in time."""
    after: Flow | None
    while (left := open_all_over(bed, flow)) is not None:
        weaker = bed.with_bonds(left)
        try:
            with work_limit.part(_OF_OPEN):
                after = rest_at(weaker, flow.at, parameter)
        except work_limit.WorkSpentError:
            after = None
        if after is None:
            break
        bed, flow = weaker, after
    return bed, flow


def _with_neighbours(assembly: Assembly, group: Ints, among: Ints) -> Ints:
    """A group of blocks with those among others that touch it."""
    patches, inside = assembly.patches, np.zeros(len(assembly) + 1, dtype=bool)
    inside[group] = True
    near = np.concatenate([
        group, patches.plus[inside[patches.minus] & (patches.minus >= 0)], patches.minus[inside[patches.plus]]
    ])  # fmt: skip
    return np.intersect1d(near, among)
