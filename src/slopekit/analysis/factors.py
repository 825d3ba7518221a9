"""The factor of safety of a design, twice, and nothing else: what studies ask thousands of times.

`analyse` gives the static bound, displacements, sensitivities and all that a sheet prints beside it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from slopekit.analysis.scene import Scene
from slopekit.analysis.stages import Clock, ClosedForm, block_status, comparable, compare, find_limit
from slopekit.design.common import Design
from slopekit.design.kinds import FootingDesign, PlaneDesign
from slopekit.design.wedge import WedgeDesign

_STATUSES = {"slides": "slides_on_J1"}
_DILATES = "the closed form knows no dilation"


@dataclass(frozen=True, slots=True)
class Factors:
    """What the two methods say of a design.

    Attributes
    ----------
    status : of PRE-IE, as `Result.status`; that of the closed form where PRE-IE was not asked
    limit : PRE-IE's factor of safety, None where nothing moves, or it was not asked
    closed_status, closed_form : of the closed form, None where the kind has none
    difference, agree : of the two on the same assumptions, None where they are not compared
    moments_govern : the limit lies below what the forces alone give
    settled : whether the passes settled to the design's `stop_when`
    """

    status: str
    limit: float | None
    closed_status: str | None
    closed_form: float | None
    difference: float | None
    agree: bool | None
    moments_govern: bool
    settled: bool

    @property
    def factor(self) -> float | None:
        """The limit where there is one, else the closed form's factor."""
        return self.limit if self.limit is not None else self.closed_form


def has_closed_form(design: Design) -> bool:
    """Whether the kind has a closed form of the same assumptions that takes next to no time."""
    return isinstance(design, WedgeDesign | PlaneDesign | FootingDesign)


def closed_form_of(design: Design) -> ClosedForm | None:
    """The closed form of a design, None where its kind has none.

    Raises
    ------
    GeometryError
        Where no block can be formed. Heads and lengths of bolts are not looked at.
    """
    if isinstance(design, WedgeDesign):
        from slopekit.analysis import wedge

        wedge.check_forms(design)
        found = wedge.closed_form(design)
        return ClosedForm(found.factor or None, found.status, _DILATES if any(design.dilation_deg) else "")
    if isinstance(design, PlaneDesign):
        from slopekit.analysis import plane

        slide = plane.closed_form(design, plane.section_of(design))
        why_not = _DILATES if design.strength.dilation_deg else ""
        return ClosedForm(slide.factor or None, _STATUSES.get(slide.status, slide.status), why_not)
    if isinstance(design, FootingDesign):
        from slopekit.analysis import footing

        press = footing.closed_form(design, footing.weight_of(design))
        why_not = _DILATES if design.strength.dilation_deg else ""
        return ClosedForm(press.factor or None, _STATUSES.get(press.status, press.status), why_not)
    return None


def factors_of(design: Design, pre_ie: bool = True) -> Factors:
    """Both factors of safety of a design.

    Parameters
    ----------
    pre_ie : False asks the closed form alone, where there is one

    Raises
    ------
    GeometryError
        Where no block can be formed.

    >>> from slopekit.design.reading import wedge_design
    >>> found = factors_of(wedge_design({"dips": ["45/115", "45/245"]}))
    >>> found.status, round(found.limit, 4), round(found.closed_form, 4), found.agree
    ('slides_on_both', 1.5574, 1.5574, True)
    """
    closed = closed_form_of(design)
    if closed is not None and not pre_ie:
        return Factors(closed.status, None, closed.status, closed.factor, None, None, False, True)
    stages = _stages(design)
    if closed is None or stages is None:
        from slopekit.analysis import analyse
        from slopekit.design.blocky import AssemblyDesign

        if isinstance(design, AssemblyDesign):
            from slopekit.analysis.assembly import assembly_factors

            status, factor, beside, settled = assembly_factors(design)
            difference, agree = compare(factor, status, beside, design.agree_within)
            return Factors(status, factor, None, beside.factor, difference, agree, False, settled)
        result = analyse(design)
        settled = result.status != "not_converged" and result.model.residual <= design.stop_when
        return Factors(
            result.status, result.fos.limit, None, result.fos.closed_form, result.difference, result.agree,
            result.moments_govern, settled,
        )  # fmt: skip
    scene_at, refine, interfaces = stages
    found = find_limit(design, scene_at, refine, Clock())
    limit = found.analysis.governing
    status = block_status(limit, found.analysis, found.scene, interfaces)
    governs = found.analysis.moments_govern
    compared = comparable(found.analysis, found.scene.model)
    difference, agree = compare(compared, status, closed, design.agree_within)
    return Factors(
        status, limit.factor or None, closed.status, closed.factor, difference, agree, governs,
        limit.settled_to(design.stop_when),
    )  # fmt: skip


def _stages(design: Design) -> tuple[Callable[[int], Scene], int, Sequence[int]] | None:
    """How a kind of one block comes to its node pairs, where it starts, and the ids of its joints."""
    from slopekit.geometry import rockmass, section

    if isinstance(design, WedgeDesign):
        from slopekit.analysis import wedge

        return wedge.scenes(design), design.refine, (rockmass.J1, rockmass.J2)
    if isinstance(design, PlaneDesign):
        from slopekit.analysis import plane

        return plane.scenes(design), design.refine, (section.J1,)
    if isinstance(design, FootingDesign):
        from slopekit.analysis import footing

        return footing.scenes(design), 0, (section.J1,)
    return None
