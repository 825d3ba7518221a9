"""One wedge on two joints (Hoek & Bray)."""

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np

from slopekit.closed_form.wedge import OUTCOMES, WedgeArrays, hoek_bray_wedges
from slopekit.core.arrays import Floats
from slopekit.core.errors import GeometryError, Notice
from slopekit.core.orientation import Line, Plane
from slopekit.core.progress import Clock
from slopekit.core.sheet import Section
from slopekit.design.parts import Strength
from slopekit.extents import WedgeGeometry
from slopekit.kinds.protocol import ClosedForm
from slopekit.kinds.single_block.closed_forms import (
    MISFITS,
    NONE,
    Arguments,
    ClosedForms,
    OnArrays,
    pressures_and_force,
)
from slopekit.kinds.single_block.held_bolts import NEARLY_PARALLEL_DEG
from slopekit.kinds.single_block.one_block import SingleBlock
from slopekit.kinds.single_block.one_block_limit import Cut, find_limit
from slopekit.kinds.wedge import limits
from slopekit.kinds.wedge.cutting import (
    bounds,
    cut,
    design_corners,
    full_water,
    heights,
    shaken,
    shape_of,
)
from slopekit.kinds.wedge.design import WedgeDesign, read_wedge
from slopekit.kinds.words import (
    line_in_words,
    short,
    slope_sections,
    strength_in_words,
    water_in_words,
)
from slopekit.result import Result, Words

_DIP_ERROR_DEG = 0.1  # of a nearly parallel joint: as well as a compass and a survey know it
_PRESSURES = ("pressure1", "pressure2", "pressure3", "pressure5")


# -- the closed form ----------------------------------------------------------------------------------


def arguments(design: WedgeDesign) -> Arguments:
    """Return the arguments of Hoek & Bray's wedge for a design, without its passive bolts."""
    height, size_misfit = heights(design)
    columns: Arguments = {"height_m": height, "size_misfit": size_misfit}
    planes = {
        "joint1": design.joints[0],
        "joint2": design.joints[1],
        "face": design.face,
        "upper": design.upper,
    }
    for name, plane in planes.items():
        columns |= {
            f"{name}_dip_deg": plane.dip_deg,
            f"{name}_dip_direction_deg": plane.dip_direction_deg,
        }
    crack, basal = design.crack, design.basal
    pressures, loads = pressures_and_force(design, len(design.strengths), bounds, full_water)
    if basal is not None:
        columns |= {
            "basal_dip_deg": basal.plane.dip_deg,
            "basal_dip_direction_deg": basal.plane.dip_direction_deg,
            "basal_height_m": basal.height_m,
            "pressure3": pressures[2],
        }
    return (
        columns
        | loads
        | {
            **_strength_arguments(design.strengths),
            "unit_weight_kn_m3": design.rock.unit_weight_kn_m3,
            "fill": design.water.fill if pressures[0] is None else 0.0,
            "water_unit_weight_kn_m3": design.water_unit_weight_kn_m3,
            "crack_fill": design.water.crack_fill,
            "pressure1": pressures[0],
            "pressure2": pressures[1],
            "pressure5": pressures[-1],
            "crack_dip_deg": None if crack is None else crack.plane.dip_deg,
            "crack_dip_direction_deg": None if crack is None else crack.plane.dip_direction_deg,
            "crack_distance_m": 0.0 if crack is None else crack.distance_m,
            "seismic": design.seismic.coefficient,
            "seismic_trend_deg": design.seismic.trend_deg,
        }
    )


def _strength_arguments(strengths: Sequence[Strength]) -> Arguments:
    cohesions: Arguments = {
        f"cohesion{k}_kpa": strength.cohesion_kpa for k, strength in enumerate(strengths, 1)
    }
    return cohesions | {
        f"friction{k}_deg": strength.friction_angle_deg for k, strength in enumerate(strengths, 1)
    }


def closed_forms(arguments: Mapping[str, Any], bolts: Sequence[Sequence[float]]) -> ClosedForms:
    """Return the closed forms of designs by Hoek & Bray's wedge; each argument is a number or an array (n,).

    Parameters
    ----------
    bolts : east, north and up of the passive ones
    """
    columns = dict(arguments)
    size, misfit = columns.pop("size_misfit"), columns.pop("misfit")
    pressures = [columns.pop(name) for name in _PRESSURES if name in columns]
    force = [columns.pop(name) for name in ("force_east", "force_north", "force_up")]
    columns |= {
        "passive_kn": bolts,
        "pressures_kpa": () if pressures[0] is None else pressures,
        "force_kn": None if force[0] is None else force,
    }
    if "basal_dip_deg" in columns:
        from slopekit.closed_form import basal

        three = basal.basal_wedges(basal.BasalWedgeArrays(**columns))
        forces = list(three.normal_kn), list(three.areas_m2[:3])
        return ClosedForms(basal.OUTCOMES, three.outcome, three.factor, *forces).refused(
            misfit, MISFITS
        )
    wedges = hoek_bray_wedges(WedgeArrays(**columns))
    forms = ClosedForms(
        OUTCOMES, wedges.outcome, wedges.factor, list(wedges.normal_kn), list(wedges.areas_m2[:2])
    )
    return forms.refused(size, limits.CODES).refused(misfit, MISFITS)


def _sizes(design: WedgeDesign) -> Mapping[str, Floats]:
    """Return the sizes of the wedges of a design whose numbers may be arrays; empty with a basal joint or a crack."""
    if design.basal is not None or design.crack is not None:
        return {}
    fit = limits.fitted(design)
    columns = {
        key: getattr(fit.sizes, key)
        for key in ("volume_m3", "height_m", "face_width_m", "setback_m")
    }
    if design.limits is not None:
        columns["scale"] = fit.scale
    return columns


def crack_reach(design: WedgeDesign) -> Floats:
    """Return the length (n,) m of J1's trace on the upper slope, of a design whose numbers may be arrays.

    Of a wedge with a basal joint it is the largest distance along the trace at which a crack cuts the block.
    """
    if design.basal is not None:
        from slopekit.kinds.wedge import basal

        return basal.crack_reach(design)
    return limits.fitted(design).sizes.upper_trace1_m


def _whole_wedges(
    design: WedgeDesign, strengths: Sequence[Strength], offsets: Floats | None
) -> ClosedForms:
    if design.basal is None:
        return NONE
    from slopekit.kinds.wedge import basal

    return basal.without_basal(design, strengths, offsets)


ON_ARRAYS = OnArrays(
    arguments,
    _strength_arguments,
    closed_forms,
    bounds,
    _sizes,
    crack_reach,
    _whole_wedges,
    full_water,
    shaken,
)


def closed_form(design: WedgeDesign, block_cut: Cut | None = None) -> ClosedForm:
    """Return the closed form of a design by Hoek & Bray's wedge, as PRE-IE is compared with it.

    Raises
    ------
    GeometryError
        Where the planes cut no wedge; as `cut`, on two joints without a cut.
    """
    if block_cut is None:
        (design_corners if design.basal is None else shape_of)(design)
    return ON_ARRAYS.closed_form(design)


# -- reading the answer -------------------------------------------------------------------------------


def _notices(design: WedgeDesign) -> Iterator[Notice]:
    """Yield the notices about the planes and the water of a wedge."""
    cosine = abs(float(design.joints[0].normal() @ design.joints[1].normal()))
    angle_deg = math.degrees(math.acos(min(1.0, cosine)))
    if angle_deg < NEARLY_PARALLEL_DEG:
        yield Notice("W301", _parallel_note(design, angle_deg))
    if design.basal is not None:
        from slopekit.kinds.wedge import basal

        yield from basal.notices(design)
    water, joints, toe = design.water, len(design.strengths), design.origin_m[2]
    yield from design.ground_notices(
        toe, toe + limits.slope_height(design), design.crack.distance_m if design.crack else None
    )
    if (scaled := limits.scaled(design)) is not None and scaled["by"] is not None:
        points = [
            name
            for name, has_any in (
                ("points of forces", any(force.at_m is not None for force in design.forces)),
                ("heads of bolts", any(bolt.head_m is not None for bolt in design.bolts)),
                ("the water table or pond", water.has_table),
            )
            if has_any
        ]
        if points:
            yield Notice(
                "W435",
                f"{', '.join(points)} are taken from the toe of the wedge as its limits of size leave "
                "it, not from the toe of the slope",
            )
    if (
        design.crack
        and water.mode == "pressures"
        and len(water.pressures_kpa) <= joints
        and water.crack_fill is None
    ):
        only = "J1 and J2 only (a third" if joints == 2 else "the joints only (a fourth"
        yield Notice("W419", f"the crack is dry: pressures were given for {only} is the crack's)")
    if water.mode == "dry" and water.crack_fill:
        yield Notice(
            "W419",
            "the crack holds water, the joints below it are dry: full water (Hoek & Bray) fills both",
        )


def _notices_in_own_names(design: WedgeDesign, *_: object) -> Iterator[Notice]:
    return (
        replace(notice, message=design.in_own_names(notice.message)) for notice in _notices(design)
    )


def _parallel_note(design: WedgeDesign, angle_deg: float) -> str:
    """Return in words how sensitive line of intersection and factor are to the dip of nearly parallel joints."""
    first, second = design.joints
    normals = second.normal()
    line = np.cross(first.normal(), normals)
    swing_deg = 0.0
    for dip, direction in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)):
        turned_line = np.cross(
            Plane(first.dip_deg + dip, first.dip_direction_deg + direction).normal(), normals
        )
        sizes = math.sqrt(float(line @ line) * float(turned_line @ turned_line))
        if sizes > 0.0:
            swing_deg = max(
                swing_deg, math.degrees(math.acos(min(1.0, abs(float(line @ turned_line)) / sizes)))
            )
    less, more = (
        _limit_with_dip_change(design, turn) for turn in (-_DIP_ERROR_DEG, _DIP_ERROR_DEG)
    )
    is_insensitive = less > 0.0 and abs(more - less) <= design.analysis.agree_within * less
    ends = " or ".join(f"{factor:.4g}" if factor else "none" for factor in (less, more))
    return (
        f"J1 and J2 are only {angle_deg:.3g}° apart: one degree on J1 moves the line of intersection by up to "
        f"{swing_deg:.0f}°, and with {_DIP_ERROR_DEG:g}° less or more dip of J1 the factor of safety is {ends}"
        + ("" if is_insensitive else ": it is not settled by the digits of the planes")
    )


def _limit_with_dip_change(design: WedgeDesign, dip_change_deg: float) -> float:
    """Return the limit with the dip of J1 changed by an angle (°), 0 where there is no limit."""
    first, second = design.joints
    changed = replace(
        design,
        joints=(
            replace(first, dip_deg=min(max(first.dip_deg + dip_change_deg, 0.0), 90.0)),
            second,
        ),
    )
    with suppress(GeometryError):
        return find_limit(cut(changed), Clock()).limit.factor or 0.0
    return 0.0


def _slope(design: WedgeDesign, result: Result) -> list[Section]:
    joints, entries, geometry = [], [], result.geometry
    assert isinstance(geometry, WedgeGeometry)
    for name, joint, plane, strength in zip(
        ("J1", "J2"), design.joint_names, design.joints, design.strengths, strict=False
    ):
        title = name if joint == name else f"{name} ({joint})"
        area = short(geometry.areas_m2[name])
        joints.append(
            f"{title} {plane}  {plane.in_words()}  {strength_in_words(strength)}  area {area} m²"
        )
    if design.basal is not None:
        from slopekit.kinds.wedge import basal

        strength_said = strength_in_words(design.strengths[2])
        entries.append(basal.plane_entry(design, geometry.areas_m2["basal"], strength_said))
    slope = [
        (name, f"{name} {plane}  {plane.in_words()}")
        for name, plane in (("face", design.face), ("upper", design.upper))
    ]
    entries += [text for name, text in slope if name not in design.reading.defaults]
    details = [text for name, text in slope if name in design.reading.defaults]
    if design.crack:
        entries.append(
            f"crack {design.crack.plane}  {design.crack.plane.in_words()}, {design.crack.distance_m:.4g} m behind the "
            f"crest along J1{design.crack_in_words}"
        )
        details.append(f"crack area {short(geometry.areas_m2['crack'])} m²")
    if design.basal is not None:
        entries.append(basal.line_entry(geometry))
    else:
        line = Line(geometry.line_trend_deg, geometry.line_plunge_deg)
        length = short(geometry.line_length_m)
        entries.append(f"line of intersection {line_in_words(line)}, daylights at the toe")
        details.append(f"line of intersection {length} m long")
    made_from = Section("PLANES", [*joints, *map(design.in_own_names, entries)], details=details)
    mean = 3.0 if design.basal is None else 1.0
    wet = water_in_words(result, mean, "on the joints falling to nothing at their other edges")
    return slope_sections(
        result, made_from, wet, [] if design.limits is None else limits.in_words(design)
    )


_WORDS = Words(
    "wedge on two joints",
    "wedge",
    "along the line of intersection",
    "Hoek & Bray closed form",
    "Hoek & Bray: forces only",
    {},
    along=True,
)
_BASAL_WORDS = replace(
    _WORDS,
    title="wedge on two joints and a basal joint",
    seismic="along the dip direction of the face",
    closed_form="closed form by vectors",
    rests_on="vectors: forces only",
    statuses={
        "slides_on_J1": "slides on J1 alone",
        "slides_on_J2": "slides on J2 alone",
        "lifted": "contact lost on its joints (uplift)",
        "no_driving_force": "stands: nothing drives it out of its three joints",
    },
)


KIND = SingleBlock(
    WedgeDesign,
    read_wedge,
    replace(_WORDS, variants={"basal": _BASAL_WORDS}),
    cut,
    closed_form,
    _slope,
    _notices_in_own_names,
    ON_ARRAYS,
)
