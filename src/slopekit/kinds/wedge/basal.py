"""A wedge with a basal joint: its shape and water, its bounds, and what a reader must know of it."""

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.errors import GeometryError, Notice
from slopekit.core.orientation import Line, Plane, number, opposite
from slopekit.core.sheet import counted
from slopekit.design.parts import Bolt, Strength
from slopekit.evidence import WithoutBasal
from slopekit.extents import WedgeGeometry
from slopekit.geometry.rock.basal import (
    J1,
    J2,
    PLANE_NAMES,
    BasalRockMass,
    basal_rock_mass,
    cut_basal_wedge,
    trace_behind,
)
from slopekit.kinds.single_block.closed_forms import ClosedForms
from slopekit.kinds.single_block.held_bolts import Bounds, bounds_of, held, pulling, stand_off, upward
from slopekit.kinds.wedge import ON_ARRAYS, closed_form, crest_of
from slopekit.kinds.wedge import bounds as wedge_bounds
from slopekit.kinds.wedge.cutting import Shape
from slopekit.kinds.wedge.design import WedgeDesign
from slopekit.kinds.words import line_in_words, short

_ACROSS = 1e-9  # a cosine: along the strike of the face it dips neither way


def shape_of(design: WedgeDesign) -> Shape:
    """The wedge above its basal joint, cut out of its planes.

    Raises
    ------
    GeometryError
        Where the planes cut no such wedge, see `rock.basal`.
    """
    rock = _rock_mass(design)
    block = cut_basal_wedge(rock)
    corners = {"toe": np.zeros(3), "basal_J1": rock.basal_at, "crest_J1": rock.crest1, "crest_J2": rock.crest2}
    return Shape(
        block, PLANE_NAMES, rock.line, _shared_edge(block.faces[J1], block.faces[J2]),
        corners, design.face.dip_direction_deg,
        ("the rock below the basal joint (it stays)",),
    )  # fmt: skip


def crack_reach(design: WedgeDesign, crack: Plane) -> float:
    """How far from the crest along J1's trace a crack still cuts the block of a design without one, m.

    Raises
    ------
    GeometryError
        As `cut`.
    """
    rock = _rock_mass(design)
    corners = cut_basal_wedge(rock).corners
    trace, normal = trace_behind(rock), crack.normal()
    along = float(normal @ trace)
    return float(((corners - rock.crest1) @ normal / along).max()) if abs(along) > _ACROSS else 0.0


def _rock_mass(design: WedgeDesign) -> BasalRockMass:
    basal, crack = design.basal, design.crack
    assert basal is not None
    return basal_rock_mass(
        np.array([plane.normal() for plane in design.joints]), design.face.normal(), design.upper.normal(),
        design.height_m, basal.plane.normal(), basal.height_m,
        crack.plane.normal() if crack else None, crack.distance_m if crack else 0.0,
    )  # fmt: skip


def bounds(design: WedgeDesign) -> Bounds:
    """The planes that bound the block, of one design or of one whose numbers are arrays; see `rock.basal`."""
    basal, crack = design.basal, design.crack
    assert basal is not None
    (first, second, face, upper), traces, crest1, offset = crest_of(design)
    under = upward(basal.plane.dip_deg, basal.plane.dip_direction_deg)
    height, low = np.atleast_1d(design.height_m), np.atleast_1d(basal.height_m)
    with np.errstate(divide="ignore", invalid="ignore"):
        crest2 = traces[1] * (offset / _dots(upper, traces[1]))[:, None]
        below = np.where(low < 0.0, -1.0, 1.0)
        sides = [np.copysign(1.0, _dots(first, crest2)) * below, np.copysign(1.0, _dots(second, crest1)) * below]
        outward = [-sides[0][:, None] * first, -sides[1][:, None] * second, -under, face, upper]
        offsets: list[Any] = [0.0, 0.0, -_dots(under, crest1 * (low / height)[:, None]), 0.0, offset]
        if crack is not None:
            trace = np.cross(first, upper)
            trace /= (np.copysign(np.sqrt(_dots(trace, trace)), -_dots(face, trace)))[:, None]
            normal = upward(crack.plane.dip_deg, crack.plane.dip_direction_deg)
            ahead = _dots(normal, trace) * crack.distance_m
            sign = np.where(ahead > 0.0, 1.0, -1.0)
            outward.append(sign[:, None] * normal)
            offsets.append(sign * (_dots(normal, crest1) + ahead))
    size = np.sqrt(np.maximum(_dots(crest1, crest1), _dots(crest2, crest2)))
    return bounds_of(outward, offsets, None, np.array(design.origin_m), (0, 1, 2), (3, 4), size)


def _dots(one: Floats, other: Floats) -> Floats:
    products: Floats = (one * other).sum(axis=-1)
    return products


def _shared_edge(one: Floats, other: Floats) -> float:
    """Length of the edge that two faces of a block share: their corners are the same numbers."""
    both = [np.array(corner) for corner in set(map(tuple, one.tolist())) & set(map(tuple, other.tolist()))]
    return math.sqrt(float(((both[0] - both[1]) ** 2).sum())) if len(both) == 2 else 0.0


# -- words ----------------------------------------------------------------------------------------------------------


def plane_entry(design: WedgeDesign, area_m2: float, strength: str) -> str:
    """The basal joint as the sheet has it."""
    assert design.basal is not None
    plane, height = design.basal.plane, design.basal.height_m
    where = f"{abs(height):.4g} m {'above' if height >= 0.0 else 'below'} the toe along J1's trace"
    return f"basal {plane}  {plane.in_words()}, {where}  {strength}  area {short(area_m2)} m²"


def line_entry(geometry: WedgeGeometry) -> str:
    """The line of intersection of J1 and J2 as the sheet has it."""
    line = line_in_words(Line(geometry.line_trend_deg, geometry.line_plunge_deg))
    if not geometry.line_length_m:
        return f"line of intersection of J1 and J2 {line}, no edge of the block"
    length = short(geometry.line_length_m)
    return f"line of intersection of J1 and J2 {line}, {length} m of it above the basal joint"


def notices(design: WedgeDesign) -> Iterator[Notice]:
    """What a reader must know of a basal joint."""
    basal = design.basal
    assert basal is not None
    if basal.height_m < 0.0:
        height, meant = number(basal.height_m), number(-basal.height_m)
        yield Notice("W410", f"a socket wedge: basal.height is {height} m, so it lies under J1 and J2, below the point "
                     "where they and the face meet; what lies above them is not analysed (is "
                     f"{meant} m meant?)")  # fmt: skip
    elif (whole := without_basal(design)) is not None:
        too = "; acceptance is held against it too" if any(rule.is_least for rule in design.rules) else ""
        lost = len(design.bolts) - len(_bolts_of_whole(replace(design, basal=None)))
        within = f" and {lost} of {counted(len(design.bolts), 'bolt')} (that end within it, or miss it)" if lost else ""
        yield Notice(
            "W410",
            "the basal joint cuts the toe off the wedge on J1 and J2, and the rock below it is taken to stay; the "
            f"whole wedge without the basal joint{within}: {whole.in_words()} by the closed form{too}",
        )
    apart = math.radians(basal.plane.dip_direction_deg - design.face.dip_direction_deg)
    if basal.plane.dip_deg > 0.0 and math.cos(apart) < -_ACROSS:
        turned = Plane(basal.plane.dip_deg, opposite(basal.plane.dip_direction_deg))
        yield Notice(
            "W410",
            f"the basal joint ({basal.plane}) dips into the slope: the block does not slide out on it, it would have "
            f"to climb; is {turned} meant?",
        )
    if basal.plane.dip_deg == 0.0:
        yield Notice("W410", "the basal joint is level: on it alone nothing drives the block but other loads")


def without_basal(design: WedgeDesign) -> WithoutBasal | None:
    """What the wedge on J1 and J2 alone does by its closed form, where the basal joint cuts its toe off.

    The rock below the basal joint is part of it, and no part of the block that is analysed. None where J1 and J2 make
    no wedge that daylights, or the basal joint leaves its toe.
    """
    basal = design.basal
    if basal is None or basal.height_m < 0.0 or float(basal.plane.normal() @ _rock_mass(design).basal_at) <= 0.0:
        return None
    whole = _whole(design)
    whole = replace(whole, bolts=_bolts_of_whole(whole))
    for wedge in (whole, _without_crack(whole)) if whole.crack else (whole,):  # the crack may lie behind it
        with suppress(GeometryError):
            solution = closed_form(wedge)
            return WithoutBasal(solution.status, solution.factor)
    return None


def _bolts_of_whole(whole: WedgeDesign) -> tuple[Bolt, ...]:
    """The bolts that hold the whole wedge: what ends within it, below the basal joint, moves with it."""
    if not any(bolt.head_m is not None for bolt in whole.bolts):
        return whole.bolts
    around = wedge_bounds(whole)
    holds = held(around, whole.bolts, stand_off(around, whole.bolts))[0][:, 0]
    return tuple(bolt for bolt, own in zip(whole.bolts, holds.tolist(), strict=True) if own)


def without_basal_of_many(design: WedgeDesign, strengths: Sequence[Strength], before: Floats) -> ClosedForms:
    """`without_basal` of designs whose numbers may be arrays; "" where there is none.

    Parameters
    ----------
    strengths : of the joints; before : (b,) of the bolts, as `held` has it
    """
    basal = design.basal
    assert basal is not None
    whole = _whole(design)
    if any(bolt.head_m is not None for bolt in design.bolts):
        holds = held(wedge_bounds(whole), design.bolts, before)[0]
        whole = replace(whole, bolts=tuple(map(pulling, design.bolts, holds)))
    forms = ON_ARRAYS.forms(whole, strengths[:2])
    names, outcome, factor = forms.names, forms.outcome, forms.factor
    no_block = np.array([name.startswith("E") for name in names])
    if design.crack is not None:  # it may lie behind it
        bare = ON_ARRAYS.forms(_without_crack(whole), strengths[:2])
        behind = no_block[outcome]
        outcome, factor = np.where(behind, bare.outcome, outcome), np.where(behind, bare.factor, factor)
    low = np.atleast_1d(basal.height_m)
    with np.errstate(invalid="ignore"):
        crest1 = crest_of(design)[2] * (low / np.atleast_1d(design.height_m))[:, None]
        under = upward(basal.plane.dip_deg, basal.plane.dip_direction_deg)
        cuts_toe = (low >= 0.0) & (_dots(under, crest1) > 0.0)
    is_there = ~no_block[outcome] & cuts_toe
    outcome = np.where(is_there, outcome, len(names)).astype(np.int8)
    return ClosedForms((*names, ""), outcome, np.where(is_there, factor, np.nan))


def _whole(design: WedgeDesign) -> WedgeDesign:
    """The wedge on J1 and J2 alone."""
    water = replace(design.water, pressures_kpa=(*design.water.pressures_kpa[:2], *design.water.pressures_kpa[3:]))
    return replace(design, strengths=design.strengths[:2], basal=None, water=water)


def _without_crack(whole: WedgeDesign) -> WedgeDesign:
    return replace(whole, crack=None, water=replace(whole.water, crack_fill=None))
