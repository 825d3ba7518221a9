"""A large component in space by groups of it: the limit of a few blocks, all others held, proposes that of all."""

from dataclasses import replace

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.geometry.patches import Assembly
from slopekit.preie.elastic_path.contact_model import ElasticContactModel
from slopekit.preie.elastic_path.contact_states import Drive
from slopekit.preie.elastic_path.flow import Flow
from slopekit.preie.elastic_path.path_limit import PathLimit, PathOutcome
from slopekit.preie.elastic_path.rests import (
    CONFIRMATION_GAP,
    equilibrium_at_strength,
    equilibrium_below,
    is_at_limit,
)
from slopekit.preie.many_blocks.blocks import first_limit, unit_bound
from slopekit.preie.many_blocks.blocks_limit import Span
from slopekit.preie.many_blocks.key_blocks import blocks_that_slide_alone
from slopekit.preie.programs.bounds import mechanism_range
from slopekit.preie.solvers import work_limit
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.system.components import WholeAssembly, model_of_blocks
from slopekit.preie.tolerances import BOUND_ACCURACY, FLOWS, RESTS_NEAR

MOST_GROUPS = 8  # that are tried, one after the other
_MOST_GROUP = 0.5  # how much of all a group may be
_OF_GROUP = 0.6  # of the work that is left, for the limit of a group

Solution = tuple[AssemblyModel, PathLimit]
"""The model of a group, and its limit."""


class Groups:
    """A large component in space: the limit of a group, the others held, proposes that of all.

    The first group is the single block that slides out most easily, with its neighbours. All blocks together, none
    held, then come to rest at just a little more strength than the group's limit, or flow: who flows is the next
    group. Where they rest just before it, their strength along its motion used up or running beyond, it is that of all.
    """

    def __init__(
        self,
        scene: WholeAssembly,
        present: Bools,
        blocks: Ints,
        model: AssemblyModel,
        refine: Ints | None = None,
    ) -> None:
        self.scene, self.present, self.blocks, self.model, self.refine = (
            scene,
            present,
            blocks,
            model,
            refine,
        )
        gone = ~present & ~scene.assembly.fixed
        self.sliders, _ = blocks_that_slide_alone(
            scene.assembly, scene.loads, scene.strength, gone, blocks
        )
        self.solution: Solution | None = None

    def span(self, motion: Floats, top: float | None) -> Span | None:
        """Return the range of the group's mechanism, or None where the limit's motion is another.

        The blocks held beside the group can carry any force.

        Parameters
        ----------
        motion : (n, 6) of the limit whose range is asked for; top : a factor that none exceeds
        """
        if self.solution is None:
            return None
        model, limit = self.solution
        assert limit.parameter is not None
        if not np.array_equal(self._of_all(self.solution).motion, motion.ravel()):
            return None
        forces = limit.normal, limit.friction
        return mechanism_range(model, limit.motion, 1.0 / limit.parameter, limit.bond, forces, top)

    def limit(self, top: float) -> PathLimit | None:
        """Return the limit of all blocks, at most `top`; None where groups lead nowhere."""
        self.solution = None
        if not len(self.sliders):
            return None
        group, work = _with_neighbours(self.scene.assembly, self._first(), self.blocks), 0
        bed = ElasticContactModel(self.model, Drive(self.model.load.ravel()))
        for _ in range(MOST_GROUPS):
            solution = self._of_group(group)
            if solution is None:
                return None
            _, limit = solution
            assert limit.parameter is not None
            if not limit.is_limit and bed.cells is None:  # it may be a snap of slivers
                return None
            work += limit.factorisations
            factor = 1.0 / limit.parameter
            below = min(factor, top)
            flow, gap = self._rest_of_all(bed, solution), 0.0
            if flow is None or factor > top:
                flow, gap = equilibrium_below(bed, below, RESTS_NEAR)
            if flow.ended == "rest":
                if factor > top * (1.0 + BOUND_ACCURACY):
                    return None
                return self._vouched(bed, solution, flow, below, gap, work)
            if flow.ended == "lost":
                return None
            movers = self._movers(flow.displacement - flow.previous)
            group = group if np.isin(movers, group).all() else movers
            group = _with_neighbours(self.scene.assembly, group, self.blocks)
        return None

    def _vouched(
        self,
        bed: ElasticContactModel,
        solution: Solution,
        flow: Flow,
        below: float,
        gap: float,
        work: int,
    ) -> PathLimit | None:
        """Return the limit of a group as that of all blocks, which rest near it; None where they are not at it."""
        limit = self._of_all(solution)
        assert limit.parameter is not None
        if limit.is_limit and not is_at_limit(
            bed, flow, limit
        ):  # a group that runs by itself has run
            return None
        self.solution = solution
        factor, rested = 1.0 / limit.parameter, 1.0 / (below * (1.0 - gap))
        width = 1.0 - (1.0 - gap) * below / factor
        displacement, forces = (
            (flow.displacement, flow.forces)
            if flow.rounding
            else bed.refined_equilibrium(flow.displacement, rested)
        )
        if (
            gap > CONFIRMATION_GAP or not limit.is_limit
        ):  # what all blocks vouch for is the last state at rest
            limit = replace(
                limit, outcome=PathOutcome.BRACKET, parameter=rested, peak=(rested, 1.0 / factor)
            )
            width = 0.0
        pressed, outcome = forces.pressed, PathOutcome.SETTLED if limit.is_limit else limit.outcome
        return replace(
            limit,
            outcome=outcome,
            width=width,
            group=len(solution[0].load),
            displacement=displacement,
            normal=forces.normal,
            friction=forces.friction,
            residual=forces.residual / bed.load_size,
            factorisations=bed.factorisations + work,
            rounding=flow.rounding,
            bond=bed.bond if pressed is None else pressed.share[self.model.group_of_pair],
            touching=flow.forces.touching if flow.rounding else None,
        )

    def _first(self) -> Ints:
        """Return the single block to begin with: bolts hold what would slide out without them."""
        bolts = self.scene.loads.bolts
        return self.sliders[
            np.argsort(np.isin(self.sliders, np.append(bolts.head, bolts.toe)), kind="stable")
        ][:1]

    def _of_group(self, group: Ints) -> Solution | None:
        """Return the limit of a group with all others held."""
        if len(group) > _MOST_GROUP * len(self.blocks):
            return None
        model_patch = model_of_blocks(self.scene, self.present, group, self.refine)
        if model_patch is None:
            return None
        model, _ = model_patch
        try:
            with work_limit.budget_fraction(_OF_GROUP):
                limit = first_limit(model, unit_bound(model))
        except work_limit.WorkSpentError:
            return None
        return None if limit is None or limit.parameter is None else (model, limit)

    def _of_all(self, solution: Solution) -> PathLimit:
        """Return a limit of a group, its motion that of all blocks."""
        model, limit = solution
        return replace(
            limit, motion=self._embedded_motion(model, limit.motion, np.zeros(self.model.load.size))
        )

    def _rest_of_all(self, bed: ElasticContactModel, solution: Solution) -> Flow | None:
        """Return all blocks at rest where a group was last, from there and joints that stick, or None."""
        small, limit = solution
        if limit.is_limit or limit.parameter is None:
            return None
        model, unit = self.model, small.force_scale / small.area_scale
        displacement = limit.displacement * unit * model.area_scale / model.force_scale
        return equilibrium_at_strength(
            bed,
            self._embedded_motion(small, displacement, bed.elastic_displacement),
            limit.parameter,
        )

    def _embedded_motion(
        self, small: AssemblyModel, motion: Floats, other_motion: Floats
    ) -> Floats:
        """Return a motion of the blocks of a group and that of all others (N,)."""
        model, rolls = self.model, np.arange(6) >= 3
        embedded = other_motion.reshape(model.load.shape).copy()
        group_motion = motion.reshape(small.load.shape) * np.where(
            rolls, model.length_scale / small.length_scale, 1.0
        )
        embedded[np.searchsorted(model.moving, small.moving)] = group_motion
        return embedded.ravel()

    def _movers(self, motion: Floats) -> Ints:
        """Return the blocks that move in a motion (N,) of all."""
        speed = np.sqrt((motion.reshape(self.model.load.shape)[:, :3] ** 2).sum(axis=1))
        movers: Ints = self.model.moving[speed > FLOWS * float(speed.max())]
        return movers


def _with_neighbours(assembly: Assembly, group: Ints, candidates: Ints) -> Ints:
    """A group of blocks with those among others that touch it."""
    patches, inside = assembly.patches, np.zeros(len(assembly) + 1, dtype=bool)
    inside[group] = True
    neighbours = np.concatenate(
        [
            group,
            patches.plus[inside[patches.minus] & (patches.minus >= 0)],
            patches.minus[inside[patches.plus]],
        ]
    )
    return np.intersect1d(neighbours, candidates)
