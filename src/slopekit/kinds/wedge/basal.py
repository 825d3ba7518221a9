"""A wedge with a basal joint: its shape, the faults of planes that cut no block, and its notices."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from slopekit.core.arrays import Floats, cross
from slopekit.core.errors import Fault, GeometryError, Notice
from slopekit.core.orientation import Line, Plane, number, opposite
from slopekit.core.sheet import counted
from slopekit.design.parts import Strength, Water
from slopekit.evidence import WithoutBasal
from slopekit.extents import WedgeGeometry
from slopekit.geometry.polytopes import Block
from slopekit.geometry.rock.rockmass import traces_of
from slopekit.geometry.tolerances import SAME_DIRECTION
from slopekit.kinds.single_block.closed_forms import ClosedForms
from slopekit.kinds.single_block.held_bolts import blocks_within, holding_bolts, pulling, upward
from slopekit.kinds.sizes import length_on_plane
from slopekit.kinds.wedge import ON_ARRAYS
from slopekit.kinds.wedge.cutting import (
    BASAL,
    J1,
    J2,
    Shape,
    basal_at,
    bounds,
    crest_geometry,
    dots,
    plane_names,
    trace_behind,
)
from slopekit.kinds.wedge.design import WedgeDesign
from slopekit.kinds.words import line_in_words, short

_LEVEL_COSINE = 1e-9  # a cosine: a dip direction along the strike of the face is neither out of the slope nor into it


#: Why planes cut no block above a basal joint, by the codes of the closed form: the message, and what to do.
_NO_BLOCK = {
    "E441": (
        "between J1 and J2 no rock lies above the basal joint and below the ground",
        "It passes over the crest: give it a lower height.",
    ),
    "E443": (
        "J1, J2 and the basal joint close no block: between them the rock goes on without end",
        "A basal joint that rises into the slope more steeply than the upper slope, or a crack, closes it.",
    ),
    "E442": (
        "the block above the basal joint has no part of the face: the basal joint does not daylight there",
        "Give it a flatter dip, or another height.",
    ),
    "E207": (
        "the crack does not bound the block above the basal joint",
        "It passes behind the block, or in front of it: leave it out or move it.",
    ),
}


def shape_of(design: WedgeDesign) -> Shape:
    """Return the wedge above its basal joint, cut out of its planes.

    Raises
    ------
    GeometryError
        E206, E209 as for two joints, E434 J1 and J2 are parallel, E441 nothing lies above the basal joint, E443 no
        closed block, E442 the block has no part of the face, E440 the basal joint does not bound it, E440 J1 or J2 does
        not, E207 the crack does not, E232 the block cannot leave.
    """
    line, crest1, crest2 = _traces(design)
    planes = bounds(design)
    block = blocks_within(planes, 1).block()
    for joint in (J1, J2):
        sine = cross(planes.outward[joint, 0], planes.outward[BASAL, 0])
        if math.sqrt(float(sine @ sine)) < SAME_DIRECTION:
            message = f"{plane_names(design)[joint]} is parallel to the basal joint: they cannot both bound a block"
            raise GeometryError(
                [Fault("E440", message, "", "Give the basal joint another orientation.")]
            )
    dry = replace(
        design, water=Water(), surcharge_kpa=0.0
    )  # which may not fit the block for another reason
    forms = ON_ARRAYS.forms(dry, [Strength(0.0, 0.0)] * 3)
    if (code := forms.names[forms.outcome[0]]).startswith("E"):
        raise GeometryError([_fault(design, code, block)])
    corners = {
        "toe": np.zeros(3),
        "basal_J1": basal_at(design)[1][0],
        "crest_J1": crest1,
        "crest_J2": crest2,
    }
    line_down = line if line[2] < 0.0 else -line
    return Shape(
        planes,
        block,
        line_down,
        length_on_plane(block.faces[J1], planes.outward[J2, 0], np.zeros(3)),
        corners,
    )


def _traces(design: WedgeDesign) -> tuple[Floats, Floats, Floats]:
    """Return the line of intersection of J1 and J2, and the points where their traces on the face meet the crest."""
    joints = np.array([plane.normal() for plane in design.joints])
    across = cross(joints[0], joints[1])
    if (sine := math.sqrt(float(across @ across))) < SAME_DIRECTION:
        degrees = math.degrees(math.asin(min(1.0, sine)))
        message = (
            f"J1 and J2 are parallel (to {degrees:.2g}°): they meet the face in no common point, over which the basal "
            "joint has its height"
        )
        advice = "Two joints of one set with a base between them: kind: plane on the base, per metre, or kind: bench."
        raise GeometryError([Fault("E434", message, "", advice)])
    face, upper = design.face.normal(), design.upper.normal()
    return traces_of(joints, face, upper, design.height_m, daylights=False)[:3]


def _fault(design: WedgeDesign, code: str, block: Block) -> Fault:
    """Return the fault of planes that cut no block, or a block that cannot leave the slope."""
    if code in _NO_BLOCK:
        message, advice = _NO_BLOCK[code]
    elif code == "E232":
        assert design.basal is not None
        message = "the block cannot leave the slope: its joints let it move into the rock behind the crack alone"
        height = design.basal.height_m
        height_text, opposite_text = (number(float(f"{size:.6g}")) for size in (height, -height))
        advice = (
            f"It lies under J1 and J2, as the height of the basal joint is {height_text} m: "
            f"was {opposite_text} m meant?"
        )
    elif BASAL not in block.faces:
        message = "the basal joint misses the wedge: J1 and J2 alone bound it"
        advice = "Leave the basal joint out, or give it another height."
    else:
        name = "J1" if J1 not in block.faces else "J2"
        message = f"{name} does not bound the block above the basal joint: it is cut off before"
        advice = "Give the basal joint another dip direction or height."
    return Fault(code, message, "", advice)


def crack_reach(design: WedgeDesign) -> Floats:
    """Return the largest distance (n,) m from the crest along J1's trace at which a crack cuts the block.

    The numbers of the design may be arrays; nan where no crack cuts the block.
    """
    assert design.crack is not None
    planes, ((first, _, face, upper), _, crest1, _) = (
        bounds(replace(design, crack=None)),
        crest_geometry(design),
    )
    corners = blocks_within(planes, planes.offsets.shape[1]).corners()
    crack = upward(design.crack.plane.dip_deg, design.crack.plane.dip_direction_deg)
    along = dots(crack, trace_behind(first, face, upper))
    with np.errstate(divide="ignore", invalid="ignore"):
        ahead = dots(crack[:, None], corners - crest1[:, None]) / along[:, None]
    reach = np.fmax.reduce(ahead, axis=1)
    return np.where((np.abs(along) > _LEVEL_COSINE) & (reach > 0.0), reach, np.nan)


# -- words ----------------------------------------------------------------------------------------------------------


def plane_entry(design: WedgeDesign, area_m2: float, strength: str) -> str:
    """Return the basal joint as the sheet prints it."""
    assert design.basal is not None
    plane, height = design.basal.plane, design.basal.height_m
    place = f"{abs(height):.4g} m {'above' if height >= 0.0 else 'below'} the toe along J1's trace"
    return f"basal {plane}  {plane.in_words()}, {place}  {strength}  area {short(area_m2)} m²"


def line_entry(geometry: WedgeGeometry) -> str:
    """Return the line of intersection of J1 and J2 as the sheet prints it."""
    line = line_in_words(Line(geometry.line_trend_deg, geometry.line_plunge_deg))
    if not geometry.line_length_m:
        return f"line of intersection of J1 and J2 {line}, no edge of the block"
    length = short(geometry.line_length_m)
    return f"line of intersection of J1 and J2 {line}, {length} m of it above the basal joint"


def notices(design: WedgeDesign) -> Iterator[Notice]:
    """Yield the notices about a basal joint."""
    basal = design.basal
    assert basal is not None
    if basal.height_m < 0.0:
        height, meant = number(basal.height_m), number(-basal.height_m)
        yield Notice(
            "W410",
            f"a socket wedge: basal.height is {height} m, so it lies under J1 and J2, below the point "
            "where they and the face meet; what lies above them is not analysed (is "
            f"{meant} m meant?)",
        )
    elif (closed := without_basal(design, design.joint_strengths, None).form()).status:
        whole_wedge = WithoutBasal(closed.status, closed.factor)
        acceptance_note = (
            "; acceptance is held against it too"
            if any(rule.is_least for rule in design.rules)
            else ""
        )
        bolts_lost = int(
            (~holding_bolts(bounds(_whole_wedge(design)), design.bolts, None)[0]).sum()
        )
        without_bolts = (
            f" and {bolts_lost} of {counted(len(design.bolts), 'bolt')} (that end within it, or miss it)"
            if bolts_lost
            else ""
        )
        yield Notice(
            "W410",
            "the basal joint cuts the toe off the wedge on J1 and J2, and the rock below it is taken to stay; the "
            f"whole wedge without the basal joint{without_bolts}: {whole_wedge.in_words()} by the closed form"
            f"{acceptance_note}",
        )
    angle = math.radians(basal.plane.dip_direction_deg - design.face.dip_direction_deg)
    if basal.plane.dip_deg > 0.0 and math.cos(angle) < -_LEVEL_COSINE:
        reversed_plane = Plane(basal.plane.dip_deg, opposite(basal.plane.dip_direction_deg))
        yield Notice(
            "W410",
            f"the basal joint ({basal.plane}) dips into the slope: the block does not slide out on it, it would have "
            f"to climb; is {reversed_plane} meant?",
        )
    if basal.plane.dip_deg == 0.0:
        yield Notice(
            "W410", "the basal joint is level: on it alone nothing drives the block but other loads"
        )


def without_basal(
    design: WedgeDesign, strengths: Sequence[Strength], offsets: Floats | None
) -> ClosedForms:
    """Return the closed form of the whole wedge on J1 and J2 alone, where the basal joint cuts its toe off.

    The rock below the basal joint is part of the whole wedge, but not of the analysed block. The outcome is "" where J1
    and J2 make no wedge that daylights, or the basal joint does not cut its toe off. Bolts that end within the whole
    wedge move with it and do not hold it. The numbers of the design may be arrays.

    Parameters
    ----------
    strengths : of the joints; offsets : (b,) of the bolt heads, as `head_offset` returns them
    """
    basal = design.basal
    assert basal is not None
    whole_wedge = _whole_wedge(design)
    if any(bolt.head_m is not None for bolt in design.bolts):
        holds = holding_bolts(bounds(whole_wedge), design.bolts, offsets)[0]
        whole_wedge = replace(whole_wedge, bolts=tuple(map(pulling, design.bolts, holds)))
    forms = ON_ARRAYS.forms(whole_wedge, strengths[:2])
    names, outcome, factor = forms.names, forms.outcome, forms.factor
    no_block = np.array([name.startswith("E") for name in names])
    if design.crack is not None:  # it may lie behind it
        bare = ON_ARRAYS.forms(
            replace(whole_wedge, crack=None, water=replace(whole_wedge.water, crack_fill=None)),
            strengths[:2],
        )
        behind = no_block[outcome]
        outcome, factor = (
            np.where(behind, bare.outcome, outcome),
            np.where(behind, bare.factor, factor),
        )
    with np.errstate(invalid="ignore"):
        cuts_toe = (np.atleast_1d(basal.height_m) >= 0.0) & (dots(*basal_at(design)) > 0.0)
    is_there = ~no_block[outcome] & cuts_toe
    outcome = np.where(is_there, outcome, len(names)).astype(np.int8)
    return ClosedForms((*names, ""), outcome, np.where(is_there, factor, np.nan))


def _whole_wedge(design: WedgeDesign) -> WedgeDesign:
    """Return the design of the whole wedge on J1 and J2 alone."""
    water = replace(
        design.water,
        pressures_kpa=(*design.water.pressures_kpa[:2], *design.water.pressures_kpa[3:]),
    )
    return replace(design, strengths=design.strengths[:2], basal=None, water=water)
