"""Check of the node-pair forces at the limit: balance of the loads, and admissibility at every pair.

Computed from the result alone, its normal forces and mechanism: a limit is trusted because its forces balance, not
because the search for it converged.
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
    """Unbalanced forces and violations of the contact law of the node-pair forces at the limit.

    Attributes
    ----------
    factor : the strength reduction factor of the limit
    force, moment : largest unbalanced force and moment of a block, in parts of its load (times the model's length)
    pull : largest tensile force on a pair, in parts of the mean normal force; 0 where every pair pushes
    friction_excess : largest friction beyond (c A + N tan φ) / F, in parts of the load of the block it acts on
    node_pairs : number of pairs checked
    """

    factor: float
    force: float
    moment: float
    pull: float
    friction_excess: float
    node_pairs: int

    def admissible_within(self, tolerance: float) -> bool:
        """Return whether every pair can carry its force, to a tolerance in parts of the load."""
        return self.pull <= tolerance and self.friction_excess <= tolerance


def worst_balance(balances: Sequence[Balance]) -> Balance | None:
    """Return the worst of each figure over several balances; None without any."""
    if not balances:
        return None
    return Balance(
        min(block_balance.factor for block_balance in balances),
        max(block_balance.force for block_balance in balances),
        max(block_balance.moment for block_balance in balances),
        max(block_balance.pull for block_balance in balances),
        max(block_balance.friction_excess for block_balance in balances),
        sum(block_balance.node_pairs for block_balance in balances),
    )


def _balance_of_forces(
    factor: float, unbalanced: Floats, translations: int, normal: Floats, excess: Floats
) -> Balance:
    """Return the balance of unbalanced forces (n, u), normal forces (m,) and forces in excess of the contact law."""
    return Balance(
        factor,
        float(np.abs(unbalanced[:, :translations]).max()),
        float(np.abs(unbalanced[:, translations:]).max(initial=0.0)),
        max(0.0, -float(normal.min())) / max(float(np.abs(normal).mean()), TINY),
        max(float(excess.max()), 0.0),
        len(normal),
    )


def balances_of_block(model: Model, analysis: LimitAnalysis) -> list[Balance]:
    """Return the balance of one block at its limit, in a list that is empty without a factor."""
    limit = analysis.balanced
    factor, normal, friction, pulls = limit.factor, limit.normal_force, limit.friction, limit.pulls
    if not factor or friction is None or pulls is None:
        return []
    residual = (
        np.column_stack([normal, friction]).ravel() @ model.flat_rows
        + model.load
        + pulls @ model.bolt_rows
    )
    allowed = line(limit.bond * model.cohesion, model.tan_friction, normal) / factor
    excess = np.concatenate(
        [_sizes(friction) - allowed, pulls - model.bolt_capacity / factor, -pulls]
    )
    turns = limit.velocity.size == model.unknowns
    return [
        _balance_of_forces(
            factor,
            residual[None, :],
            model.translations if turns else limit.velocity.size,
            normal,
            excess,
        )
    ]


def balance_of_assembly(
    model: "AssemblyModel", factor: float, normal: Floats, friction: Floats, bond: Floats
) -> Balance:
    """Return the balance of many blocks with normal forces (m,), friction (g, t) and remaining bonds (m,)."""
    block_loads = _sizes(model.load)
    weights = np.append(
        np.maximum(block_loads, LIGHTEST * float(block_loads.max())), np.inf
    )  # bedrock is the last
    reference_load = np.minimum(weights[model.plus], weights[model.minus])[model.group_contact]
    allowed = line(
        model.by_group(bond * model.cohesion), model.tan_friction, model.by_group(normal)
    )
    excess = np.maximum(
        _sizes(friction) - allowed / factor, np.where(model.bolted, -friction[:, 0], 0.0)
    )
    return _balance_of_forces(
        factor,
        model.unbalanced(normal, friction),
        2 if model.unknowns == 3 else 3,
        normal[model.joint_pairs],
        excess / reference_load,
    )


def _sizes(rows: Floats) -> Floats:
    sizes: Floats = np.sqrt((rows * rows).sum(axis=1))
    return sizes
