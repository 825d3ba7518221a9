"""The elastic model as arrays, in kN, m and kPa: the rigid model's rows and strengths, and what the rock gives.

Eq. 23 of Sheng et al. (2023) with one term more:

    d = B γ + P w,   f = A law(d; F),   Bᵀ f + q(γ) = 0

d are the relative displacements of the node pairs, γ the motions of the blocks, w what their contacts give
(`condensed`), q the loads with the pulls of passive bolts. w = 0 is the rigid model.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.elastic.flexibility import CondensedBlock
from slopekit.preie.motion.equilibrium import BOLT_GIVE_M


@dataclass(frozen=True)
class ElasticModel:
    """Blocks on their node pairs.

    Attributes
    ----------
    rows : (3n, N) B, sparse; N unknowns in m, turns times `length`
    load : (N,) kN, moments over `length`
    area : (n,) m²; cohesion, tension : (n,) kPa; tan_friction, tan_dilation : (n,)
    bolt_rows : (b, N); bolt_capacity : (b,) kN
    blocks : of each its condensed body, the rows (3m,) of its pairs and its unknowns (u,)
    bends : whether the blocks are elastic
    """

    rows: Any
    load: Floats
    area: Floats
    cohesion: Floats
    tension: Floats
    tan_friction: Floats
    tan_dilation: Floats
    bolt_rows: Floats
    bolt_capacity: Floats
    blocks: tuple[tuple[CondensedBlock, Ints, Ints], ...]
    bends: bool = True

    def rigid(self) -> "ElasticModel":
        """The same blocks, rigid."""
        return replace(self, bends=False)

    @property
    def unbonded(self) -> Bools:
        """Pairs (n,) that have no bond to lose."""
        is_unbonded: Bools = (self.cohesion == 0.0) & (self.tension == 0.0)
        return is_unbonded

    @property
    def bodies(self) -> tuple[tuple[CondensedBlock, Ints, Ints], ...]:
        """The blocks that are elastic."""
        return self.blocks if self.bends else ()

    def pulls(self, motion: Floats, factor: float) -> tuple[Floats, Floats]:
        """Pulls (b,) of the passive bolts, and by how much they grow per m that a bolt is drawn out."""
        most, stiff = self.bolt_capacity / factor, self.bolt_capacity / BOLT_GIVE_M
        pull = -stiff * (self.bolt_rows @ motion)
        return np.clip(pull, 0.0, most), np.where((pull > 0.0) & (pull < most), stiff, 0.0)

    def mean_bending(self, motion: Floats, factor: float, bent: Floats) -> Floats:
        """The elastic part of the mean displacement of each block, (b, 3) m; bent (k,) of the nodes of all."""
        means = np.zeros((len(self.blocks), 3))
        loads = self.load + self.pulls(motion, factor)[0] @ self.bolt_rows
        first = 0
        for k, (body, _, unknowns) in enumerate(self.bodies):
            end = first + body.seen.shape[1]
            means[k] = body.seen @ bent[first:end] + body.seen_by_load @ loads[unknowns]
            first = end
        return means
