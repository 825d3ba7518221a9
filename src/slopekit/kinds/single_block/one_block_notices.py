"""What a reader must know of one analysed block: of its factor, what that rests on, and how it was found."""

import math
from collections.abc import Iterator

import numpy as np

from slopekit.core.errors import Notice
from slopekit.design.common import Design
from slopekit.kinds.protocol import ClosedForm
from slopekit.kinds.single_block.one_block_limit import Cut, FoundLimit
from slopekit.notices import SQUARE, bolt_notices, common_notices, mesh_notices, undrawn_notice
from slopekit.preie.outcome import Outcome
from slopekit.preie.tolerances import LIMIT_SETTLED
from slopekit.result import Words

_ACROSS, _AGAINST = 0.34, 0.1  # cosines of 70°, and of 84° the other way
_ALL = 0.999999  # of an interface


def notices(
    design: Design, cut: Cut, solution: FoundLimit, closed: ClosedForm, words: Words
) -> Iterator[Notice]:  # fmt: skip
    """The notices of one analysed block."""
    strengths = [interface.strength for interface in cut.interfaces]
    limit, model = solution.limit, solution.scene.model
    yield from common_notices(design, strengths)
    if limit.factor and not limit.settled_to(LIMIT_SETTLED):
        runs = f"the block rests at {limit.factor:.4g} and runs at {limit.factor * (1.0 + limit.change):.4g}"
        yield Notice("W317", f"the motion did not settle into a limit state: {runs}; the lower is printed")
    if limit.factor is not None or limit.outcome is Outcome.NO_STRENGTH:
        yield from _lost_contact(design, cut, solution)
    if limit.factor is not None:
        yield from _shaking(cut, solution)
        passive = any(bolt.acts == "passive" for bolt in design.bolts)
        if passive and not (-model.bolt_rows @ limit.velocity > SQUARE).any():
            yield undrawn_notice()
    has_strength = any(strength.cohesion_kpa or strength.friction_angle_deg for strength in strengths)
    if not has_strength and not len(model.bolt_capacity):
        yield without_strength(words.block)
    if closed.why_not and any(strength.dilation_deg for strength in strengths):
        yield dilating(closed.why_not, solution.factors is None or solution.factors.exact is not None)
    yield from bolt_notices(design)
    yield from mesh_notices(solution.change or 0.0)


def _lost_contact(design: Design, cut: Cut, solution: FoundLimit) -> Iterator[Notice]:
    """W307: joints that have lost contact where the forces alone govern, or that a curved surface opens on.

    A flat joint that opens on a part of its area alone has the limit of its bed, which does not jump.
    """
    if solution.analysis.moments_govern:
        return
    area, least = solution.scene.model.control_area, 0.0 if solution.factors is None else _ALL
    for interface in cut.interfaces:
        joint = solution.scene.pairs.interface == interface.key
        lost = float(area[joint & (solution.limit.bond == 0.0)].sum() / area[joint].sum())
        if interface.strength.cohesion_kpa > 0.0 and lost > least:
            yield lost_contact(design.in_own_names(interface.name), lost)


def _shaking(cut: Cut, solution: FoundLimit) -> Iterator[Notice]:
    """W328: a seismic load that does not drive the movement."""
    seismic, model = cut.loads.parts["seismic"], solution.scene.model
    motion = model.moved(solution.limit.velocity)[0]
    size = float(np.linalg.norm(seismic) * np.linalg.norm(motion))
    if size:
        yield from shaking(float(seismic @ motion) / size)


def without_strength(block: str) -> Notice:
    """W308: nothing holds what moves."""
    return Notice("W308", f"the joints have no strength: nothing holds the {block}, there is no factor of safety")


def dilating(why_not: str, dilates: bool) -> Notice:
    """W310: joints that dilate, which the closed form does not know; whether the limit is one with dilation."""
    assumption = "" if dilates else "; a joint opens or has a curved law: the limit is that without dilation"
    return Notice("W310", why_not + assumption)


def lost_contact(joint: str, lost: float = 1.0) -> Notice:
    """W307: a joint that has lost contact, or opens on a part of its area."""
    opens = "has lost contact" if lost > _ALL else f"opens on {max(lost * 100, 1.0):.0f} % of its area"
    jumps = "with a little less water or seismic load it may, and the factor of safety jumps"
    return Notice("W307", f"{joint} {opens}, so its cohesion there does not act: {jumps}")


def shaking(along: float) -> Iterator[Notice]:
    """W328, where a seismic load does not drive the movement; `along`: cosine of the angle between the two."""
    if along < -_AGAINST:
        yield Notice("W328", "the seismic load acts against the movement: it raises the factor of safety")
    elif along < _ACROSS:
        angle_deg = math.degrees(math.acos(along))
        yield Notice("W328", f"the seismic load acts across the movement, {angle_deg:.0f}° off it: is its trend right?")
