"""The elastic model as arrays, in kN, m and kPa: the rigid model's rows and strengths, and what the rock gives.

Eq. 23 of Sheng et al. (2023) with one term more, C -> C + D:

    d = B γ + D f + H q(γ),   f = A law(d; F),   Bᵀ f + q(γ) = 0

d are the relative displacements of the node pairs, γ the motions of the blocks, q the loads with the pulls of passive
bolts. D = 0 and H = 0 is the rigid model.
"""

from dataclasses import field, replace
from typing import Any

import numpy as np
from scipy import sparse

from slopekit.core.arrays import Bools, Floats, Ints, frozen
from slopekit.core.records import dataclass
from slopekit.elastic.flexibility import CondensedBlock, Flexibility
from slopekit.preie.motion.equilibrium import BOLT_GIVE_M

_DENSE = 600  # unknowns up to which matrices are dense


@dataclass(frozen=True, slots=True)
class ElasticModel:
    """Blocks on their node pairs.

    Attributes
    ----------
    rows : (3n, N) B, dense or sparse; N unknowns in m, turns times `length`
    load : (N,) kN, moments over `length`
    area : (n,) m²; cohesion, tension : (n,) kPa; tan_friction, tan_dilation : (n,)
    bolt_rows : (b, N); bolt_capacity : (b,) kN
    give : (3n, 3n) D, None where rigid or of many blocks; give_load : (3n, N) H
    seen : of each elastic block its flexibility, of many its condensed body, the rows of its pairs and its unknowns
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
    give: Any = None
    give_load: Any = None
    seen: "tuple[tuple[Flexibility | CondensedBlock, Ints, Ints], ...]" = field(default=())
    bends: bool = False

    @property
    def is_dense(self) -> bool:
        """Whether its matrices are dense."""
        return not sparse.issparse(self.rows)

    def rigid(self) -> "ElasticModel":
        """The same blocks, rigid."""
        return replace(self, give=None, give_load=None, bends=False)

    @property
    def unbonded(self) -> Bools:
        """Pairs (n,) that have no bond to lose."""
        is_unbonded: Bools = (self.cohesion == 0.0) & (self.tension == 0.0)
        return is_unbonded

    @property
    def bodies(self) -> tuple[tuple[CondensedBlock, Ints, Ints], ...]:
        """The condensed bodies of many elastic blocks."""
        return (
            tuple((one, pairs, own) for one, pairs, own in self.seen if isinstance(one, CondensedBlock))
            if self.bends
            else ()
        )

    def pulls(self, motion: Floats, factor: float) -> tuple[Floats, Floats]:
        """Pulls (b,) of the passive bolts, and by how much they grow per m that a bolt is drawn out."""
        most, stiff = self.bolt_capacity / factor, self.bolt_capacity / BOLT_GIVE_M
        pull = -stiff * (self.bolt_rows @ motion)
        return np.clip(pull, 0.0, most), np.where((pull > 0.0) & (pull < most), stiff, 0.0)

    def seen_of(self, block: int, forces: Floats, motion: Floats, factor: float, bent: Floats | None = None) -> Floats:
        """Displacements (q, 3) of what is seen of a block: its elastic part; bent (k,) those of the bodies' nodes."""
        flexible, pairs, unknowns = self.seen[block]
        if not self.bends:
            return np.zeros((len(flexible.seen_by_load) // 3, 3))
        loads = (self.load + self.pulls(motion, factor)[0] @ self.bolt_rows)[unknowns]
        if isinstance(flexible, CondensedBlock):
            assert bent is not None
            first = sum(one.seen.shape[1] for one, *_ in self.bodies[:block])
            shown = flexible.seen @ bent[first : first + flexible.seen.shape[1]]
        else:
            shown = flexible.seen_by_force @ forces[pairs]
        displacements: Floats = (shown + flexible.seen_by_load @ loads).reshape(-1, 3)
        return displacements


def with_blocks(
    model: ElasticModel, blocks: "tuple[tuple[Flexibility | CondensedBlock, Ints, Ints], ...]"
) -> ElasticModel:
    """The model with elastic blocks, each with the rows (3m,) of its pairs and its unknowns (u,): dense ones with D."""
    size, unknowns = model.rows.shape
    if not model.is_dense:
        return replace(model, seen=blocks, bends=True)
    give, give_load = np.zeros((size, size)), np.zeros((size, unknowns))
    for one, rows, own in blocks:
        if isinstance(one, Flexibility):
            give[np.ix_(rows, rows)] += one.by_force
            give_load[np.ix_(rows, own)] += one.by_load
    return replace(model, give=frozen(give), give_load=frozen(give_load), seen=blocks, bends=True)


def dense_or_sparse(rows: Any) -> Any:
    """Rows in the form that their size asks for."""
    if rows.shape[0] <= _DENSE:
        return rows.toarray() if sparse.issparse(rows) else np.asarray(rows)
    return sparse.csr_matrix(rows)
