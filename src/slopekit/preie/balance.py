"""What the node-pair forces at the limit are worth: do they balance the loads, and does every pair allow them?

Read off the answer afterwards, from the normal forces and the mechanism alone: a limit that came with its forces is
believed because they balance, not because the search for it says so.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from slopekit.arrays import Floats
from slopekit.preie.limit import LimitAnalysis
from slopekit.preie.model import Model
from slopekit.preie.passes import Limit, Outcome

if TYPE_CHECKING:  # one block needs no sparse matrices
    from slopekit.preie.assembly import AssemblyModel

_SOUND = 1e-6


@dataclass(frozen=True, slots=True)
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

    def to_dict(self) -> dict[str, Any]:
        """The balance as JSON values."""
        return {
            "factor": self.factor,
            "force": self.force,
            "moment": self.moment,
            "pull": self.pull,
            "friction_excess": self.friction_excess,
            "node_pairs": self.node_pairs,
        }


def block_balance(model: Model, analysis: LimitAnalysis) -> Balance | None:
    """The forces of one block at its limit; None where there is no factor.

    Where the forces alone govern although the block could be held to more by its moments, the state with turning is
    the one that balances both; it stands at a higher factor, so at the limit too.
    """
    governing, turning = analysis.governing, analysis.with_turning
    limit = governing
    if turning.factor is not None and turning.outcome is Outcome.SLIDES and governing.factor is not None:
        limit = turning if turning.factor >= governing.factor * (1.0 - _SOUND) else governing
    if not limit.factor or limit.friction is None or limit.pulls is None:
        return None
    return _balance(model, limit, limit.friction, limit.pulls, limit.factor)


def _balance(model: Model, limit: Limit, friction: Floats, pulls: Floats, factor: float) -> Balance:
    most = limit.velocity.size if limit.velocity.size < model.unknowns else model.translations
    normal = limit.normal_force
    forces = np.column_stack([normal, friction]).ravel()
    out = forces @ model.flat_rows + model.load + pulls @ model.bolt_rows
    size = np.sqrt((friction * friction).sum(axis=1))
    allowed = (limit.bond * model.cohesion + model.tan_friction * normal) / factor
    over = np.concatenate([size - allowed, pulls - model.bolt_capacity / factor, -pulls])
    return Balance(
        factor, float(np.abs(out[:most]).max()), float(np.abs(out[most:]).max(initial=0.0)),
        max(0.0, -float(normal.min())) / max(float(np.abs(normal).mean()), 1e-300), max(float(over.max()), 0.0),
        len(normal),
    )  # fmt: skip


@dataclass(frozen=True, slots=True)
class Carried:
    """A model of many blocks with its forces at a factor: N (m,), T (g, t) and what bonds are left (m,)."""

    model: "AssemblyModel"
    factor: float
    normal: Floats
    friction: Floats
    bond: Floats


def assembly_balance(parts: Sequence[Carried]) -> Balance | None:
    """The forces of many blocks, the worst of each figure over all blocks; None where no part has a factor."""
    if not parts:
        return None
    force = moment = pull = excess = 0.0
    for part in parts:
        model = part.model
        out = np.abs(model.unbalanced(part.normal, part.friction))
        weights = np.sqrt((model.load * model.load).sum(axis=1))
        weights = np.maximum(weights, _SOUND * float(weights.max()))
        most = 2 if model.unknowns == 3 else 3
        force = max(force, float(out[:, :most].max()))
        moment = max(moment, float(out[:, most:].max()))
        normal = part.normal[model.joint_pairs]
        pull = max(pull, -float(normal.min()) / max(float(np.abs(normal).mean()), 1e-300))
        size = np.sqrt((part.friction * part.friction).sum(axis=1))
        allowed = model.by_group(part.bond * model.cohesion) + model.tan_friction * model.by_group(part.normal)
        over = np.maximum(size - allowed / part.factor, 0.0)
        over = np.maximum(over, np.where(model.bolted, -part.friction[:, 0], 0.0))  # a bolt does not push
        bedrock = np.append(weights, np.inf)
        beside = np.minimum(bedrock[model.plus], bedrock[model.minus])[model.group_contact]
        excess = max(excess, float((over / beside).max()))
    return Balance(
        min(part.factor for part in parts), force, moment, pull, excess,
        sum(len(part.normal[part.model.joint_pairs]) for part in parts),
    )  # fmt: skip
