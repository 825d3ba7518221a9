"""What the node-pair forces at the limit are worth: do they balance the loads, and does every pair allow them?

Read off the answer afterwards, from the normal forces and the mechanism alone: a limit that came with its forces is
believed because they balance, not because the search for it says so.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.preie.one_block.limit import LimitAnalysis
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import LIGHTEST, TINY
from slopekit.strength.mohr_coulomb import line

if TYPE_CHECKING:  # one block needs no sparse matrices
    from slopekit.preie.system.assembly import AssemblyModel


@dataclass(frozen=True)
class Balance:
    """The forces of the node pairs at the limit, held against the loads and against the contact law.

    Attributes
    ----------
    factor : the strength reduction factor at which the forces were looked at
    force, moment : largest unbalanced force and moment of a block, in parts of its load (times the model's length)
    pull : largest force that pulls on a pair, in parts of the mean normal force; 0 where every pair pushes
    friction_excess : largest friction beyond (c A + N tan φ) / F, in parts of the load of the block it acts on
    node_pairs : how many were looked at
    """

    factor: float
    force: float
    moment: float
    pull: float
    friction_excess: float
    node_pairs: int

    def admissible_within(self, tolerance: float) -> bool:
        """Whether every pair's force is one that it can carry, within a part of the load."""
        return self.pull <= tolerance and self.friction_excess <= tolerance


def balance(parts: Sequence[Balance]) -> Balance | None:
    """The worst of each figure over all parts; None where there are none."""
    if not parts:
        return None
    return Balance(
        min(part.factor for part in parts), max(part.force for part in parts), max(part.moment for part in parts),
        max(part.pull for part in parts), max(part.friction_excess for part in parts),
        sum(part.node_pairs for part in parts),
    )  # fmt: skip


def _seen(factor: float, unbalanced: Floats, translations: int, normal: Floats, beyond: Floats) -> Balance:
    """Return what is off: forces (n, u) left of the loads, normal forces (m,), and forces beyond the contact law."""
    return Balance(
        factor,
        float(np.abs(unbalanced[:, :translations]).max()),
        float(np.abs(unbalanced[:, translations:]).max(initial=0.0)),
        max(0.0, -float(normal.min())) / max(float(np.abs(normal).mean()), TINY),
        max(float(beyond.max()), 0.0),
        len(normal),
    )


def of_one_block(model: Model, analysis: LimitAnalysis) -> list[Balance]:
    """What one block carries at its limit; nothing where there is no factor."""
    limit = analysis.balanced
    factor, normal, friction, pulls = limit.factor, limit.normal_force, limit.friction, limit.pulls
    if not factor or friction is None or pulls is None:
        return []
    out = np.column_stack([normal, friction]).ravel() @ model.flat_rows + model.load + pulls @ model.bolt_rows
    allowed = line(limit.bond * model.cohesion, model.tan_friction, normal) / factor
    beyond = np.concatenate([_sizes(friction) - allowed, pulls - model.bolt_capacity / factor, -pulls])
    turns = limit.velocity.size == model.unknowns
    return [_seen(factor, out[None, :], model.translations if turns else limit.velocity.size, normal, beyond)]


def of_blocks(model: "AssemblyModel", factor: float, normal: Floats, friction: Floats, bond: Floats) -> Balance:
    """What many blocks carry: N (m,), T (g, t), and what bonds are left (m,)."""
    own = _sizes(model.load)
    weights = np.append(np.maximum(own, LIGHTEST * float(own.max())), np.inf)  # bedrock is the last
    beside = np.minimum(weights[model.plus], weights[model.minus])[model.group_contact]
    allowed = line(model.by_group(bond * model.cohesion), model.tan_friction, model.by_group(normal))
    over = np.maximum(_sizes(friction) - allowed / factor, np.where(model.bolted, -friction[:, 0], 0.0))
    return _seen(
        factor, model.unbalanced(normal, friction), 2 if model.unknowns == 3 else 3, normal[model.joint_pairs],
        over / beside,
    )  # fmt: skip


def _sizes(rows: Floats) -> Floats:
    sizes: Floats = np.sqrt((rows * rows).sum(axis=1))
    return sizes
