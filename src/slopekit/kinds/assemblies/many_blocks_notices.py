"""What a reader must know of many blocks: notices of their limit, of how it was found and of what it leaves out."""

from collections.abc import Iterator, Sequence

import numpy as np

from slopekit.core.errors import Notice
from slopekit.findings import Mechanism
from slopekit.kinds.assemblies.many_blocks_design import AssemblyDesign
from slopekit.kinds.assemblies.many_blocks_scene import AssemblyScene
from slopekit.kinds.words import mass_in_words, size_number
from slopekit.notices import (
    SQUARE,
    LostCohesion,
    bolt_notices,
    common_notices,
    lost_cohesion_notices,
    mesh_notices,
    undrawn_notice,
)
from slopekit.preie.elastic_path.loads_last import STRONGER
from slopekit.preie.many_blocks.blocks_limit import Basis, BlocksLimit
from slopekit.preie.many_blocks.ravelling import Failure, Part, Ravelling
from slopekit.preie.one_block.passes import Outcome
from slopekit.preie.tolerances import PASSES_SETTLED

_ONE_PLACE = 1e-3  # of a factor: ends that lie nearer are one
_SMALL = 0.01  # of the volume that can move: the factor of less says little of the slope
_BOULDER_M3 = 1.0  # a piece that may be left to its neighbours; a larger one is a failure of its own
_FEW = 3  # mechanisms, of which one is mostly larger


def notices_of(
    design: AssemblyDesign, scene: AssemblyScene, ravelling: Ravelling, mechanisms: Sequence[Mechanism]
) -> Iterator[Notice]:
    """What a reader must know of the design, of how its first mechanism was found, and of what it hangs on."""
    yield from scene.notices
    yield from common_notices(design, scene.strengths)
    if not mechanisms:
        return
    first, limit = mechanisms[0], ravelling.failures[0].limit
    yield from said_of_size(design, scene, ravelling)
    yield from bolt_notices(design)
    if first.fos and scene.bolt_names and not any(_drawn_out(part) for part in ravelling.failures[0].parts):
        yield undrawn_notice()
    if limit.outcome is Outcome.NO_STRENGTH:
        yield Notice("W308", "the joints have no strength: nothing holds the blocks, there is no factor of safety")
    yield from mesh_notices(max((part.mesh_change or 0.0 for part in ravelling.failures[0].parts), default=0.0))
    if limit.basis is Basis.PEAK and first.fos:
        yield Notice("W317", "the motion did not settle into a limit state: the factor is that of the last state at "
                     "rest, the peak of the elastic path, on the way to it that holds least; where limits of random "
                     "sections were found they lay up to 4 % below their peaks, which bounds none")  # fmt: skip
    if first.fos and limit.change > PASSES_SETTLED and any(strength.law for strength in scene.strengths):
        yield Notice("W317", "strength at the tractions of one limit state leads to another, and back: the lowest "
                     f"factor is printed, others lie up to {limit.change * 100:.2g} % above it")  # fmt: skip
    if limit.rounding and first.fos:
        where = "at" if limit.basis is Basis.PEAK else "just before"
        yield Notice("W317", f"all blocks rest {where} the factor but for a rounding of the law of their joints: "
                     "forces balance within strength, and what joints give, open and slip fits them but for "
                     f"{limit.rounding * 100.0:.1g} % of the elastic energy")  # fmt: skip
    if limit.loads_last and first.fos:
        yield Notice("W317", "with all loads on at once no limit state was found: weight and water came first, the "
                     "other loads after them, and F is the strength found at which they just all fit on")  # fmt: skip
    if limit.begun and first.fos and limit.static_bound:
        last = "led to no limit state" if limit.fit_on is None else f"fit on at F = {limit.fit_on:.4f}"
        yield Notice("W317", "with all loads on at once the blocks come to rest at "
                     f"{limit.static_bound / limit.begun:.3g} times the strength of the upper bound and not at "
                     f"twice; those that came on after the weight {last}")  # fmt: skip
    if limit.outcome is Outcome.NO_REST:
        yield _without_rest(limit, design.seismic.coefficient)
    if limit.spent:
        yield _unsettled(limit)
    elif limit.outcome is Outcome.NOT_CONVERGED:
        yield _given_up(limit)
    yield from lost_cohesion_notices(lost_cohesion(ravelling.failures[0]), "factor of safety")


def debonding_notices(stable: float, fails: float, limit: float) -> Iterator[Notice]:
    """W504: with progressive slip and debonding the blocks fail at less than the limit."""
    below = (1.0 - fails / limit) * 100.0
    yield Notice("W504", f"with progressive slip and debonding the blocks are stable at {stable:.4f} and fail at "
                 f"{fails:.4f}, {below:.2g} % below the factor of safety: rely on the lower")  # fmt: skip


def said_of_size(design: AssemblyDesign, scene: AssemblyScene, ravelling: Ravelling) -> Iterator[Notice]:
    """W503: the factor is that of a small part of what can move, and how to come to larger ones."""
    assembly, first = scene.assembly, ravelling.failures[0]
    whole = float(assembly.volumes[~assembly.fixed].sum())
    volumes = [float(assembly.volumes[failure.blocks].sum()) for failure in ravelling.failures]
    small = volumes[0]
    if not first.limit.factor or small >= _SMALL * whole:
        return
    weight_kn = float(assembly.volumes[first.blocks] @ scene.unit_weights[first.blocks])
    mass = f" ({mass_in_words(weight_kn / design.gravity_m_s2)})" if weight_kn else ""
    share = f"{max(small / whole * 100.0, 0.001):.2g} %"
    larger = next((k for k, volume in enumerate(volumes) if volume >= _SMALL * whole), None)
    more = ""
    if larger is not None:
        factor = ravelling.failures[larger].limit.factor
        has = "no number" if factor is None else f"{factor:.4f}"
        more = f"; the first larger one under MECHANISM, n {larger + 1}, has {has}, those before it taken away"
    elif ravelling.ended == "count":
        more = f"; analysis.mechanisms: {max(_FEW, 2 * design.mechanisms)} goes on to what fails after it"
    if getattr(design, "min_volume_m3", None) is not None and small < _BOULDER_M3:
        more += f"; a cut.min_volume above {_four(small)} m3 joins such pieces to their neighbours"
    yield Notice("W503", f"the factor of safety is that of {_four(small)} m³{mass}, {share} of the {_four(whole)} m³ "
                 f"that can move{more}")  # fmt: skip


def _four(volume: float) -> str:
    """Four digits."""
    return size_number(float(f"{volume:.4g}"))


def lost_cohesion(failure: Failure) -> LostCohesion:
    """Return the part of the node pairs that has lost its cohesion at a limit, and the numbers of such contacts."""
    limit, model = failure.limit, failure.parts[0].model
    joints = model.joint_pairs
    gone, of = limit.bond[joints] == 0.0, model.pair_contact[joints]
    lost = float(gone.mean()) if gone.size else 0.0
    return lost, len(np.unique(of[gone])), len(np.unique(of[(model.cohesion[joints] > 0.0) | gone]))


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
    alone = ""
    if limit.held is not None:
        factor, count = limit.held
        few = "one block has its" if count == 1 else f"{count} blocks have their"
        alone = (
            f"; with all others held where they are {few} limit at {factor:.4g}, no number of all: theirs may be lower"
        )
    return Notice("W360", "the limit of these blocks was not settled within the effort of one analysis (work is "
                  f"counted, not timed: every machine ends here): {rests}{above}{alone}")  # fmt: skip


def _given_up(limit: BlocksLimit) -> Notice:
    """Why a search ended without a limit although work was left."""
    why = "the motion that was followed led to no state whose forces balance within strength"
    if limit.by_turns is not None:
        low, high = limit.by_turns
        fit = f"fit on and do not by turns with the strength divided by {low:.4g} to {high:.4g}"
        if high <= low * (1.0 + _ONE_PLACE):
            fit = f"just all fit on with the strength divided by {low:.4g}"
        why = f"the loads beside weight and water, coming on last, {fit}, and no rest under all of them was found there"
    above = "" if limit.static_bound is None else f"; the upper bound is {limit.static_bound:.4g}"
    return Notice("W308", f"the search for the limit of these blocks gave up: {why}{above}")


def _without_rest(limit: BlocksLimit, seismic: float) -> Notice:
    """Why blocks that forces could balance have no factor, with what was tried; `seismic`: the coefficient, or 0."""

    def earthquake(part: float) -> str:
        return f" (k {part * seismic:.4g})" if seismic else ""

    most = f"{STRONGER[-1]:g} times the strength of the upper bound"
    if limit.loads_last and limit.carried is not None and limit.carried < 1.0:
        tried = f"up to {most}" if limit.static_bound else "at any strength that was tried"
        tips = ""
        if limit.tips is not None:
            part, factor = limit.tips
            tips = (
                f"; with their strength divided by {factor:.4g} or less they go at {part:.4g} of "
                f"them{earthquake(part)} in a motion that slips nowhere: they tip, and no friction or cohesion hinders "
                "it: a wider base or bolts would"
            )
        return Notice("W362", f"at full strength the blocks fail at {limit.carried:.4g} of the loads beside weight "
                      f"and water{earthquake(limit.carried)}, and {tried} they did not carry all of them: no factor of "
                      f"safety is given{tips}")  # fmt: skip
    exist = (
        "" if limit.static_bound is None else "; the upper bound says that forces in balance exist, not that they arise"
    )
    bonds, tip = "without the cohesion that is lost, ", ""
    if not (limit.bond == 0.0).any():
        bonds, tip = "", " (mostly such blocks tip: a wider base or bolts hold them, more strength does not)"
    return Notice("W362", f"{bonds}on elastic joints the blocks came to rest at none of the strengths that were tried"
                  f"{tip}: no factor of safety is given{exist}")  # fmt: skip


def _drawn_out(part: Part) -> bool:
    """Whether a mechanism draws out a passive bolt."""
    _, slip = part.model.opening_and_slip(part.limit.velocity)
    return bool((slip[part.model.bolted, 0] < -SQUARE).any())
