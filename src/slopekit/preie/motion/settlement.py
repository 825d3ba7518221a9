"""Settlement of the blocks of an assembly on their elastic joints: displacements in metres.

The law is that of `elastic_path.contact_model` with the design's stiffnesses. On Clough and Duncan's hyperbola each
joint has the secant stiffness K (1 - R_f τ / (σ_n tan φ₁)), K = k₁ γ_w (σ_n/P_a)ⁿ, at its own mean tractions, updated
until it is constant. With the paper's parameters the hyperbola cannot reach the strength of a joint at low normal
traction, where Newton's method on it does not converge: the secant is kept above a part of K, and the joint slips at
its strength. A passive bolt carries its full capacity once it is drawn out by a millimetre, as on one block.
"""

from dataclasses import dataclass

import numpy as np

from slopekit.core.arrays import Bools, Floats, frozen
from slopekit.preie.elastic_path.contact_model import ElasticContactModel
from slopekit.preie.elastic_path.contact_states import Drive
from slopekit.preie.elastic_path.flow import THICK, viscous_relaxation, viscous_step
from slopekit.preie.motion.equilibrium import BOLT_GIVE_M
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.system.contact import CloughDuncan, JointStiffness
from slopekit.preie.tolerances import SETTLEMENT_STEADY

_ROUNDS = (
    16  # updates of stiffness with the normal tractions, and of cohesion lost where pairs open
)
_LEAST = 0.05  # least secant stiffness, in parts of K, of a joint that creeps on the hyperbola


@dataclass(frozen=True)
class Settlement:
    """State of rest of the blocks of an assembly.

    Attributes
    ----------
    displacement : (n, u) m and radians
    slips : (g,) friction forces at their strength, or in an open contact; no bolts
    failed_pairs : node pairs of those friction forces
    residual : largest unbalanced force in parts of the largest load
    scaled, ratio : (N,) displacement in the model's units and (g,) k_t / k_n, as a start of the next state
    """

    displacement: Floats
    slips: Bools
    failed_pairs: int
    residual: float
    scaled: Floats
    ratio: Floats


def settlement(
    model: AssemblyModel,
    stiffness: JointStiffness,
    factor: float = 1.0,
    start: Settlement | None = None,
) -> Settlement | None:
    """Return the state of rest with strength divided by the factor; None where blocks do not come to rest.

    Parameters
    ----------
    start : state of rest at a smaller factor, from which the iteration starts
    """
    if model.lines is not None:
        from slopekit.preie.system.strength_lines import (
            following_lines,
            with_secants,
        )  # only curved laws pay for it

        model = following_lines(model)
    per_metre = stiffness.normal * model.area_scale * model.length_scale / model.force_scale
    group_area = model.by_group(model.control_area) * model.area_scale
    law = stiffness.tangential
    bolted, capacity = model.bolted, model.by_group(model.cohesion) * model.force_scale
    bolt_ratio = (capacity / (BOLT_GIVE_M * stiffness.normal * group_area))[bolted]
    if start is None:
        ratio = np.full(
            len(group_area), 0.1 if isinstance(law, CloughDuncan) else law / stiffness.normal
        )
        ratio[bolted] = bolt_ratio
        scaled: Floats = ElasticContactModel(
            model, Drive(model.load.ravel()), ratio=ratio
        ).elastic_displacement
    else:
        scaled, ratio = start.scaled, start.ratio
    for round_number in range(_ROUNDS):
        bed, previous = ElasticContactModel(model, Drive(model.load.ravel()), ratio=ratio), scaled
        step = viscous_step(bed, scaled, scaled, 1.0 / factor, 0.0)
        if step.settled:
            forces, scaled = step.forces, step.displacement
        else:
            origin, viscosity = (np.zeros(bed.size), 1.0) if start is None else (scaled, THICK)
            flow = viscous_relaxation(bed, origin, 1.0 / factor, viscosity)
            if flow.ended != "rest":
                return None
            forces, scaled = flow.forces, flow.displacement
        if isinstance(law, CloughDuncan):
            stiff, bent, *_ = law.hyperbola(
                model.by_group(forces.normal) * model.force_scale / group_area
            )
            shear = (
                np.sqrt((forces.friction * forces.friction).sum(axis=1))
                * model.force_scale
                / group_area
            )
            ratio = np.sqrt(ratio) * np.sqrt(
                stiff * np.maximum(1.0 - bent * shear, _LEAST) / stiffness.normal
            )
            ratio[bolted] = bolt_ratio
        if model.lines is not None:
            model = with_secants(model, forces.normal)
        change = float(np.abs(scaled - previous).max()) / float(np.abs(scaled).max())
        settled = round_number > 0 and change < SETTLEMENT_STEADY
        constant = not isinstance(law, CloughDuncan) and model.lines is None
        if settled or constant:
            break
    unknowns = model.unknowns
    to_metres = (
        np.where(np.arange(unknowns) < unknowns // 2 + unknowns % 2, model.length_scale, 1.0)
        / per_metre
    )
    slips: Bools = (forces.slips | ~(model.by_group(forces.normal) > 0.0)) & ~bolted
    return Settlement(
        frozen(scaled.reshape(model.load.shape) * to_metres),
        slips,
        int(slips[model.group_of_pair].sum()),
        forces.residual / bed.load_size,
        scaled,
        ratio,
    )
