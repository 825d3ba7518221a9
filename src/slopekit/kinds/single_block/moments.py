"""Cohesion where moments open part of a contact: the limit of one block by three rules, and which of them is printed.

by mechanism   what the collapse motion opens loses its cohesion, pair by pair (`limit_analysis`). A rigid motion that
               opens part of a flat contact leaves at most a line of it closed: with finer pairs this sinks to
bond gone      a contact that the motion opens anywhere loses all of its cohesion, then again from there;
cracked base   on an elastic bed what is in tension at the limit has no cohesion, what is pressed has (`cracked`).

The last two converge with the pairs, and none is always the lower: the bed gives way before the rigid block does, or
holds on to pressed cohesion that the motion then takes. The headline is the lower of the two, so that no rule's forces
at their limit disprove it.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from slopekit.core.arrays import Bools, Floats, frozen
from slopekit.core.records import dataclass
from slopekit.evidence import ContactOpening
from slopekit.geometry.interfaces import BEDROCK, NodePairs
from slopekit.kinds.single_block.one_block_states import ContactModel, opening_pairs
from slopekit.preie.one_block.limit import LimitAnalysis, forces_only_limit, limit_analysis, limit_on_lines
from slopekit.preie.one_block.passes import STEERED, Limit, Outcome
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import SAME_LIMIT

if TYPE_CHECKING:  # only what moments open with cohesion pays for the cracked base
    from slopekit.preie.one_block.cracked import CrackedBase
    from slopekit.preie.one_block.polygon_bed import PointForces, PolygonBed

_DILATES = "its bed knows no joints that dilate"
_SAME_END = 0.05  # the end of a path that creeps about an edge lies so near the limit without the bond, or elsewhere


@dataclass(frozen=True, slots=True)
class CohesionRules:
    """The three factors; None where a rule has none.

    Attributes
    ----------
    rule : which is the headline: the lower of "cracked_base" and "bond_gone"; "forces_alone" where that is lower yet,
        "by_mechanism" where neither has a limit
    runs : the motion runs there; False: the block is still at rest when its pressed part gives way
    contacts : evidence by interface, in local axes
    why_not : why the cracked base has no limit
    rests_to : where it moves on the cracked base, but rests again farther off: the factor up to which it does
    """

    rule: str
    headline: float
    by_mechanism: float | None
    cracked_base: float | None
    bond_gone: float | None
    runs: bool
    contacts: Mapping[int, ContactOpening]
    why_not: str
    rests_to: float | None = None

    @property
    def numbers(self) -> tuple[float, ...]:
        """The factors that there are, the headline first."""
        numbers = (self.headline, self.by_mechanism, self.cracked_base, self.bond_gone, self.rests_to)
        return tuple(value for value in numbers if value is not None)


@dataclass(frozen=True, slots=True)
class CohesionLimit:
    """The limit by the headline's rule and the node pairs that carry it.

    `change`: what the last refinement did to it, or what finer triangles would do; None where that is not known.
    `base`, `without_bond`, `motion`: the cracked base, the limit with the bond gone, and that by mechanism.
    """

    scene: ContactModel
    analysis: LimitAnalysis
    change: float | None
    rules: CohesionRules
    base: "CrackedBase"
    without_bond: Limit | None
    motion: Limit


def opens_cohesive(scene: ContactModel, analysis: LimitAnalysis) -> bool:
    """Whether moments govern by a motion that opens part of a contact with cohesion, on a bed that is known."""
    if scene.bedding is None or not analysis.moments_govern:
        return False
    return bool(_opens_bonds(analysis.governing, scene.model).any())


def checked_by_path(scene: ContactModel, analysis: LimitAnalysis) -> LimitAnalysis:
    """The analysis with the limit that the elastic path comes to, where moments govern a block on flat contacts."""
    if scene.bedding is None or not analysis.moments_govern:
        return analysis
    if analysis.model is not None:
        return _by_path_on_lines(analysis.model, analysis)
    return _by_path(scene.model, analysis)


def locked_in_range(
    analysis: LimitAnalysis, scene: ContactModel, rules: CohesionRules | None
) -> tuple[float | None, float | None]:  # fmt: skip
    """The range of the mechanism where moments govern; none for the cracked base, whose forces are the bed's."""
    model, limit = scene.model, analysis.governing
    if not analysis.moments_govern or scene.bedding is None or model.dilates or model.unknowns != 6 or not limit.factor:
        return None, None
    if rules is not None and rules.rule in ("cracked_base", "by_mechanism"):
        return None, None
    if model.lines is not None:
        return None, None  # other forces mean other tractions, and other lines
    from slopekit.preie.one_block.one_path import range_of

    return range_of(model, limit)


def _by_path(model: Model, analysis: LimitAnalysis) -> LimitAnalysis:
    """In a section the limit state is one: a flat contact slips as a whole, or the block turns about its edge."""
    if not analysis.moments_govern or model.dilates or model.unknowns != 6:
        return analysis
    from slopekit.preie.one_block.one_path import by_path  # only what moments govern pays for SciPy

    return by_path(model, analysis)


def _by_path_on_lines(model: Model, analysis: LimitAnalysis) -> LimitAnalysis:
    """The same where laws are curved: the lines are drawn anew at the path's own tractions."""
    from slopekit.preie.system.strength_lines import settled

    by_path = settled(model, lambda drawn: _by_path(drawn, limit_on_lines(drawn)))
    one, other = analysis.governing.factor, by_path.governing.factor
    return analysis if one and other and abs(other / one - 1.0) < SAME_LIMIT else by_path


def limit_by_rules(
    scene: ContactModel,
    analysis: LimitAnalysis,
    analyse: Callable[[Model], LimitAnalysis] = limit_analysis,
    before: CohesionLimit | None = None,
) -> CohesionLimit:
    """The limit by the three rules.

    Parameters
    ----------
    scene : for the limit with the bond gone
    analysis : by mechanism, on these pairs or coarser ones, where `opens_cohesive`
    analyse : what solves a model, `limit_analysis` or what remembers its answers
    before : the same on pairs once less refined, None if there is none
    """
    model, bedding = scene.model, scene.bedding
    alone, motion = analysis.forces_only, analysis.governing
    assert bedding is not None
    without_bond, without_path = _bond_gone(model, analyse)
    if without_bond is None and before is not None:
        return before
    from slopekit.preie.one_block.cracked import CrackedBase, cracked_base
    from slopekit.preie.one_block.polygon_bed import bed_of

    bed = bed_of(model, bedding.polygons, bedding.centroid)
    if before is not None:
        base = before.base
    else:
        base = CrackedBase(None, _DILATES) if model.dilates else cracked_base(bed, motion.factor or 1.0)
    cracked, bare = base.factor, None if without_bond is None else without_bond.factor
    if base.creeps and cracked and bare and cracked < bare < cracked * (1.0 + _SAME_END):
        cracked = bare  # the line of contact that the path creeps to
    headline, change, rule = motion, None, "by_mechanism"
    if without_bond is not None and bare:
        headline, rule = without_bond, "bond_gone"
        last = None if before is None or before.without_bond is None else before.without_bond.factor
        change = None if last is None else abs(bare / last - 1.0)
    assert headline.factor is not None
    own = scene
    if cracked is not None and base.forces is not None and cracked < headline.factor * (1.0 - SAME_LIMIT):
        own, headline = _on_its_pairs(scene, bed, base, base.forces, cracked, motion)
        change, rule = base.change, "cracked_base"
        alone = forces_only_limit(own.model)
    assert headline.factor is not None
    govern = alone.factor is None or headline.factor < alone.factor * (1.0 - SAME_LIMIT)
    if not govern and len(alone.bond) != len(own.pairs):
        alone = forces_only_limit(own.model)  # it was found on coarser pairs
    governing = headline if govern else replace(alone, velocity=alone.velocity_of(own.model))
    assert governing.factor is not None
    rules = CohesionRules(
        rule if govern else "forces_alone", governing.factor, motion.factor, cracked, bare, base.runs,
        _evidence(bed, base, model, bedding.centroid), base.why_not, base.rests_to,
    )  # fmt: skip
    without_path = without_path and govern and rule == "bond_gone"
    by_rules = LimitAnalysis(governing, alone, headline, govern, govern, without_path)
    return CohesionLimit(own, by_rules, change, rules, base, without_bond, motion)


def with_finer_motion(
    by_rules: CohesionLimit, scene: ContactModel, analyse: Callable[[Model], LimitAnalysis]
) -> CohesionLimit:
    """The same with the factor by mechanism on the pairs of the last refinement, where its passes settle.

    Of joints that dilate, which no cracked base vouches for, it is no more with the bond gone: where that has no limit
    on those pairs the one on coarser pairs says nothing.
    """
    if by_rules.motion.passes > STEERED or len(by_rules.motion.bond) == len(scene.pairs):
        return by_rules
    analysis = analyse(scene.model)
    again, rules = analysis.governing, by_rules.rules
    if not again.factor or again.passes > STEERED:
        return by_rules
    rules = replace(rules, by_mechanism=again.factor)
    if not scene.model.dilates or again.factor >= rules.headline * (1.0 - SAME_LIMIT):
        return replace(by_rules, rules=rules)
    own = scene if analysis.model is None else replace(scene, model=analysis.model)
    rules = replace(rules, rule="by_mechanism", headline=again.factor)
    return replace(by_rules, scene=own, analysis=replace(analysis, by_rule=True), change=None, rules=rules)


def _bond_gone(
    model: Model, analyse: Callable[[Model], LimitAnalysis] = limit_analysis
) -> tuple[Limit | None, bool]:  # fmt: skip
    """The limit where every contact that the motion opens anywhere has lost all of its cohesion; None without one.

    The forces alone may govern it then; its own forces balance the moments too. Also whether the elastic path was
    asked and came to no limit.
    """
    without_path = False
    gone = np.zeros(len(model.control_area), dtype=bool)
    while True:
        bare = replace(model, cohesion=frozen(np.where(gone, 0.0, model.cohesion))) if gone.any() else model
        analysis = analyse(bare)
        bare = analysis.model or bare
        if gone.any() or not _opens_bonds(analysis.governing, bare).any():
            followed = _by_path(bare, analysis)
            # what rests at no strength keeps the number of the passes: none at all would raise the headline
            without_path = followed.without_path or not followed.governing.factor
            analysis = followed if followed.governing.factor else analysis
        opens = _opens_bonds(analysis.governing, bare)
        limit, held = analysis.governing, analysis.balanced
        if not limit.factor:
            return None, False
        if not opens.any():
            whole = replace(
                limit, bond=np.where(gone, 0.0, held.bond), normal_force=held.normal_force, friction=held.friction,
                pulls=held.pulls,
            )  # fmt: skip
            return whole, without_path
        gone |= np.isin(model.interface, model.interface[opens])


def _opens_bonds(limit: Limit, model: Model) -> Bools:
    """Pairs with cohesion that a motion with a factor opens, (n,)."""
    opens: Bools = opening_pairs(limit, model, limit.velocity_of(model)) & (model.cohesion > 0.0) & bool(limit.factor)
    return opens


def _on_its_pairs(
    scene: ContactModel, bed: "PolygonBed", base: "CrackedBase", forces: "PointForces", factor: float, motion: Limit
) -> tuple[ContactModel, Limit]:
    """The points of the bed as node pairs, with a model of their own, and the limit on them."""
    assert scene.bedding is not None
    assert base.velocity is not None
    model, bedding = scene.model, scene.bedding
    count = len(forces.area)
    keys = bed.keys[forces.contact]
    first = {int(key): int(np.flatnonzero(scene.pairs.interface == key)[0]) for key in bed.keys}
    normals = scene.pairs.normals[[first[int(key)] for key in bed.keys]]
    pairs = NodePairs(
        frozen(forces.points * model.length_scale + bedding.centroid), frozen(normals[forces.contact]),
        frozen(forces.area * model.area_scale), keys, np.zeros(count, dtype=np.int64), np.full(count, BEDROCK),
    )  # fmt: skip
    own = bedding.model_of(pairs)
    if own.lines is not None:
        from slopekit.preie.system.strength_lines import drawn

        own = drawn(own, forces.normal)
    velocity = base.velocity.copy()
    velocity[model.translations :] *= own.length_scale / model.length_scale  # turns are per length of the model
    velocity /= np.sqrt(velocity @ velocity)
    limit = Limit(
        Outcome.SLIDES, factor, velocity, forces.normal, forces.pressed.astype(np.float64), motion.passes,
        0.0, forces.shear, forces.pulls,
    )  # fmt: skip
    return ContactModel(pairs, own, bedding), limit


def _evidence(bed: "PolygonBed", base: "CrackedBase", model: Model, centroid: Floats) -> dict[int, ContactOpening]:
    forces, out = base.forces, dict[int, ContactOpening]()
    if forces is None or base.opening is None:
        return out
    for k, key in enumerate(bed.keys.tolist()):
        on = forces.contact == k
        push, area = forces.normal[on], forces.area[on]
        total, pressed = float(push.sum()), float(area[forces.pressed[on]].sum())
        gaps = bed.corner_rows(k)[:, 0] @ base.opening
        most = int(np.argmax(gaps))
        out[key] = ContactOpening(
            pressed / float(area.sum()), total * model.force_scale,
            (push @ forces.points[on]) / total * model.length_scale + centroid if total > 0.0 else None,
            bed.corners[k][most] * model.length_scale + centroid if gaps[most] > 0.0 else None,
        )  # fmt: skip
    return out
