"""How far the blocks of an assembly settle on their elastic joints: displacements in metres.

The law is that of `elastic_path.bed` with the design's stiffnesses. On Clough and Duncan's hyperbola each joint has
the secant stiffness K (1 - R_f τ / (σ_n tan φ₁)), K = k₁ γ_w (σ_n/P_a)ⁿ, at its own mean tractions, found again until
it stays. With the paper's parameters the hyperbola cannot reach the strength of a joint at low normal traction, where
Newton's method on it finds no rest: the secant is kept above a part of K, and the joint slips at its strength. A
passive bolt carries its full capacity once it is drawn out by a millimetre, as on one block.
"""

from dataclasses import dataclass

import numpy as np

from slopekit.core.arrays import Bools, Floats, frozen
from slopekit.preie.elastic_path.bed import Bed
from slopekit.preie.elastic_path.bed_states import Drive
from slopekit.preie.elastic_path.flow import THICK, relaxed, stepped
from slopekit.preie.motion.equilibrium import BOLT_GIVE_M
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.system.contact import CloughDuncan, JointStiffness
from slopekit.preie.tolerances import SETTLEMENT_STEADY

_ROUNDS = 16  # of stiffnesses that follow the normal tractions, and of cohesion lost where pairs open
_LEAST = 0.05  # of K: the secant of a joint that the hyperbola lets creep away


@dataclass(frozen=True)
class Settlement:
    """Blocks at rest.

    Attributes
    ----------
    displacement : (n, u) m and radians
    slips : (g,) friction forces at their strength, or in an open contact; no bolts
    failed_pairs : node pairs that share in those
    residual : largest unbalanced force in parts of the largest load
    at, ratio : (N,) displacement in the model's units and (g,) k_t / k_n, to go on from
    """

    displacement: Floats
    slips: Bools
    failed_pairs: int
    residual: float
    at: Floats
    ratio: Floats


def settlement(
    model: AssemblyModel, stiffness: JointStiffness, factor: float = 1.0, start: Settlement | None = None
) -> Settlement | None:
    """The blocks at rest with their strength divided by the factor; None where they come to none.

    Parameters
    ----------
    start : the same at a smaller factor, to go on from
    """
    if model.lines is not None:
        from slopekit.preie.system.strength_lines import by_lines, drawn  # only curved laws pay for it

        model = by_lines(model)
    per_metre = stiffness.normal * model.area_scale * model.length_scale / model.force_scale
    group_area = model.by_group(model.control_area) * model.area_scale
    law = stiffness.tangential
    bolted, capacity = model.bolted, model.by_group(model.cohesion) * model.force_scale
    of_bolts = (capacity / (BOLT_GIVE_M * stiffness.normal * group_area))[bolted]
    if start is None:
        ratio = np.full(len(group_area), 0.1 if isinstance(law, CloughDuncan) else law / stiffness.normal)
        ratio[bolted] = of_bolts
        at: Floats = Bed(model, Drive(model.load.ravel()), ratio=ratio).elastic_displacement
    else:
        at, ratio = start.at, start.ratio
    for taken in range(_ROUNDS):
        bed, before = Bed(model, Drive(model.load.ravel()), ratio=ratio), at
        step = stepped(bed, at, at, 1.0 / factor, 0.0)
        if step.settled:
            forces, at = step.forces, step.at
        else:
            origin, viscosity = (np.zeros(bed.size), 1.0) if start is None else (at, THICK)
            flow = relaxed(bed, origin, 1.0 / factor, viscosity)
            if flow.ended != "rest":
                return None
            forces, at = flow.forces, flow.at
        if isinstance(law, CloughDuncan):
            stiff, bent, *_ = law.hyperbola(model.by_group(forces.normal) * model.force_scale / group_area)
            shear = np.sqrt((forces.friction * forces.friction).sum(axis=1)) * model.force_scale / group_area
            ratio = np.sqrt(ratio) * np.sqrt(stiff * np.maximum(1.0 - bent * shear, _LEAST) / stiffness.normal)
            ratio[bolted] = of_bolts
        if model.lines is not None:
            model = drawn(model, forces.normal)
        moved = float(np.abs(at - before).max()) / float(np.abs(at).max())
        settled = taken > 0 and moved < SETTLEMENT_STEADY
        constant = not isinstance(law, CloughDuncan) and model.lines is None
        if settled or constant:
            break
    unknowns = model.unknowns
    to_metres = np.where(np.arange(unknowns) < unknowns // 2 + unknowns % 2, model.length_scale, 1.0) / per_metre
    slips: Bools = (forces.slips | ~(model.by_group(forces.normal) > 0.0)) & ~bolted
    return Settlement(
        frozen(at.reshape(model.load.shape) * to_metres), slips, int(slips[model.group_of_pair].sum()),
        forces.residual / bed.load_size, at, ratio,
    )  # fmt: skip
