"""What a reader must know of many blocks: notices of their limit, of how it was found and of what it leaves out."""

from collections.abc import Iterator, Sequence

import numpy as np

from slopekit.core.errors import Notice
from slopekit.findings import Mechanism
from slopekit.kinds.assemblies.many_blocks_design import AssemblyDesign
from slopekit.kinds.assemblies.many_blocks_scene import AssemblyScene
from slopekit.notices import (
    SQUARE,
    LostCohesion,
    bolt_notices,
    common_notices,
    lost_cohesion_notices,
    mesh_notices,
    undrawn_notice,
)
from slopekit.preie.many_blocks.blocks_limit import Basis, BlocksLimit
from slopekit.preie.many_blocks.ravelling import Failure, Part, Ravelling
from slopekit.preie.outcome import Outcome
from slopekit.preie.tolerances import LIMIT_SETTLED, SAME_LIMIT, TINY


def notices_of(
    design: AssemblyDesign, scene: AssemblyScene, ravelling: Ravelling, mechanisms: Sequence[Mechanism]
) -> Iterator[Notice]:
    """What a reader must know of the design, of how its first mechanism was found, and of what it depends on."""
    yield from scene.notices
    yield from common_notices(design, scene.strengths)
    if not mechanisms:
        return
    first, limit = mechanisms[0], ravelling.failures[0].limit
    yield from bolt_notices(design)
    if (
        first.fos
        and scene.acting.bolt_names
        and not any(_drawn_out(component) for component in ravelling.failures[0].parts)
    ):
        yield undrawn_notice()
    if limit.outcome is Outcome.NO_STRENGTH:
        yield Notice("W308", "the joints have no strength: nothing holds the blocks, there is no factor of safety")
    yield from mesh_notices(
        max((component.mesh_change or 0.0 for component in ravelling.failures[0].parts), default=0.0)
    )
    if limit.basis is Basis.PEAK and first.fos:
        yield Notice("W317", "the motion did not settle into a limit state: the factor is that of the last stable "
                     "state of the elastic path; the limit may lie lower (up to 4 % in random sections)")  # fmt: skip
    if first.fos and limit.change > LIMIT_SETTLED and any(strength.law for strength in scene.strengths):
        yield Notice("W317", "strength at the tractions of one limit state leads to another, and back: the lowest "
                     f"factor is printed, others lie up to {limit.change * 100:.2g} % above it")  # fmt: skip
    if limit.rounding and first.fos:
        where = "at" if limit.basis is Basis.PEAK else "just before"
        yield Notice("W317", f"all blocks rest {where} the factor but for a rounding of the law of their joints: "
                     "forces balance within strength, and what joints give, open and slip fits them but for "
                     f"{limit.rounding * 100.0:.1g} % of the elastic energy")  # fmt: skip
    if limit.outcome is Outcome.NO_REST:
        yield _without_rest(limit, design.seismic.coefficient)
    if limit.spent:
        yield _unsettled(limit)
    elif limit.outcome is Outcome.NOT_CONVERGED:
        above = "" if limit.static_bound is None else f"; the upper bound is {limit.static_bound:.4g}"
        yield Notice("W308", "the search for the limit of these blocks gave up: the motion that was followed led to no "
                     f"state whose forces balance within strength{above}")  # fmt: skip
    yield from lost_cohesion_notices(lost_cohesion(ravelling.failures[0]), "factor of safety")


def debonding_notice(stable: float, fails: float, limit: float) -> Notice:
    """W504: with progressive slip and debonding the blocks fail at less than the limit."""
    below = (1.0 - fails / limit) * 100.0
    return Notice("W504", f"with progressive slip and debonding the blocks are stable at {stable:.4f} and fail at "
                  f"{fails:.4f}, {below:.2g} % below the factor of safety: rely on the lower")  # fmt: skip


def lost_cohesion(failure: Failure) -> LostCohesion:
    """Return the part of the cohesion that does not act at a limit, and the numbers of such contacts and of all."""
    limit, model = failure.limit, failure.parts[0].model
    joints = model.joint_pairs
    full, contact = model.cohesion[joints], model.pair_contact[joints]
    acts = full * limit.bond[joints]
    open_somewhere = acts < full * (1.0 - SAME_LIMIT)
    lost = 1.0 - float(acts.sum()) / max(float(full.sum()), TINY) if full.any() else 0.0
    return lost, len(np.unique(contact[open_somewhere])), len(np.unique(contact[full > 0.0]))


def _unsettled(limit: BlocksLimit) -> Notice:
    """What is known of blocks whose limit takes more work than an analysis does."""
    rests = "no rest of all blocks that would say anything was seen"
    if limit.rested is not None:
        rests = (
            f"all blocks were last at rest with their strength divided by {limit.rested:.4g} (limits of random "
            "sections lay up to 4 % below such a rest)"
        )
    above = ", and no upper bound was found"
    if limit.static_bound is not None:
        above = f", and no forces balance the loads beyond {limit.static_bound:.4g}, the upper bound"
    return Notice("W360", "the limit of these blocks was not settled within the effort of one analysis (work is "
                  f"counted, not timed: every machine ends here): {rests}{above}")  # fmt: skip


def _without_rest(limit: BlocksLimit, seismic: float) -> Notice:
    """Why blocks that forces could balance have no factor, with what was tried; `seismic`: the coefficient, or 0."""

    def earthquake(share: float) -> str:
        return f" (k {share * seismic:.4g})" if seismic else ""

    if limit.tips is not None:
        share, factor = limit.tips
        topple = f"with their strength divided by {factor:.4g} or less the blocks topple at {share:.4g} of the loads"
        return Notice("W362", f"{topple} beside weight and water{earthquake(share)} without slipping anywhere: a wider "
                      "base or bolts would hold them; no factor of safety is given")  # fmt: skip
    exist = (
        "" if limit.static_bound is None else "; the upper bound says that forces in balance exist, not that they arise"
    )
    tip = " (mostly such blocks tip: a wider base or bolts hold them, more strength does not)"
    return Notice("W362", f"on elastic joints the blocks came to rest at none of the strengths that were tried{tip}: "
                  f"no factor of safety is given{exist}")  # fmt: skip


def _drawn_out(component: Part) -> bool:
    """Whether a mechanism draws out a passive bolt."""
    _, slip = component.model.opening_and_slip(component.limit.velocity)
    return bool((slip[component.model.bolted, 0] < -SQUARE).any())
