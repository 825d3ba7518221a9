"""Blocks of one bench at all trial places: which form, which fail, how much of crest and rock is lost with them.

wedge
    Two joints whose line of intersection daylights; free where both joints run as far as its edges do. It fails by
    `closed_form.wedge`, or by PRE-IE where that lets it stand (`limits`).
plane
    The first joint of a place, flatter than the face and within the lateral limit of its dip direction (Hoek & Bray
    1981, ch. 7); its sides are taken as free. It is judged likewise, by `closed_form.plane` and PRE-IE.
toppling
    One joint steep into the slope, the other a base that dips out of it and daylights, both within the lateral limit
    of toppling: ψ_d >= (90 - ψ_f) + φ_d lets columns slip on each other (Goodman & Bray 1976; Wyllie & Mah 2004,
    §9.2-9.3). A column fails that turns over under its own weight; its width is the spacing of the steep joint. Columns
    behind the first count as far as the base runs, and no farther behind the crest than the block is high.

All three end at the level crest. Toe anywhere: where the toe lies is drawn, and a joint too short for the block forms
none. Largest: the toe is that of the bench, and a joint too short makes the block smaller, its toe moves up.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np

from slopekit.closed_form.berms import cone_spill_width, prism_spill_width
from slopekit.closed_form.plane import OUTCOMES as PLANE_OUTCOMES
from slopekit.closed_form.plane import PlaneArrays, plane_failures
from slopekit.closed_form.sizes import column_sizes, largest_scale, plane_sizes, wedge_sizes
from slopekit.closed_form.tolerances import REACHES
from slopekit.closed_form.wedge import OUTCOMES as WEDGE_OUTCOMES
from slopekit.closed_form.wedge import WedgeArrays, hoek_bray_wedges
from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.studies.bench_design.inputs import BenchInputs
from slopekit.studies.bench_design.trials import Trials
from slopekit.studies.kinematic.criteria import direction_difference_deg
from slopekit.studies.outcomes import ByMethod

MODES: Final = ("wedge", "plane", "toppling")
WEDGE, PLANE, TOPPLING = range(3)
_ANGLE_TOLERANCE_DEG: Final = 1e-9  # degrees, as in studies.kinematic.criteria


@dataclass(frozen=True)
class Bench:
    """Blocks that form and fail in one bench at n trial places; (3, n) by mode, in the order of `MODES`.

    Attributes
    ----------
    forms, fails, factor : (3, n); a factor is the closed form's, nan where nothing slides or topples or is known
    block_height_m : (3, n) from the toe of the block to the crest
    governs : (n,) the failing mode that takes most of the crest, -1 where none fails
    setback_m, volume_m3, spill_m : (n,) of what fails, 0 where nothing does; width_m : (n,) along the crest
    """

    height_m: float
    face_dip_deg: float
    forms: Bools
    fails: Bools
    factor: Floats
    block_height_m: Floats
    governs: Ints
    setback_m: Floats
    volume_m3: Floats
    spill_m: Floats
    width_m: Floats


def closed_form_modes(
    inputs: BenchInputs, trials: Trials, height_m: float, face_dip_deg: float
) -> "list[ModeResult]":
    """Return the blocks of all trials in a bench by the closed forms, one result a mode in the order of `MODES`."""
    return [mode(inputs, trials, height_m, face_dip_deg) for mode in (_wedges, _planes, _columns)]


def bench_of(height_m: float, face_dip_deg: float, modes: "Sequence[ModeResult]") -> Bench:
    """Return the bench of three mode results: the failing mode with the largest setback governs each place."""
    forms, fails, factor, block, setback, volume, spill, width = (
        np.stack([mode[name] for mode in modes]) for name in _BENCH_FIELDS
    )
    crest_loss = np.where(fails, setback, -1.0)
    governs = np.where(fails.any(axis=0), crest_loss.argmax(axis=0), -1)
    index = np.maximum(governs, 0), np.arange(len(governs))
    governing_sizes = [
        np.where(governs < 0, 0.0, values[index]) for values in (setback, volume, spill, width)
    ]
    return Bench(
        height_m,
        face_dip_deg,
        forms,
        fails,
        factor,
        block,
        governs.astype(np.int64),
        *governing_sizes,
    )


#: Blocks of one mode at n places: arrays (n,) by name; sizes are 0 where no block forms.
ModeResult: TypeAlias = dict[str, np.ndarray]
_BENCH_FIELDS: Final = (
    "forms",
    "fails",
    "factor",
    "block_height_m",
    "setback_m",
    "volume_m3",
    "spill_m",
    "width_m",
)
_MODE_FIELDS: Final = (*_BENCH_FIELDS, "outcome")
#: Outcomes of the closed forms that PRE-IE judges too, by mode.
CLOSED_OUTCOMES: Final = (WEDGE_OUTCOMES, ("slides_on_J1", *PLANE_OUTCOMES[1:]))


def _empty_mode(n: int) -> ModeResult:
    """Return a mode result of n places without a block."""
    kinds = {"forms": np.bool_, "fails": np.bool_, "outcome": np.int16}
    mode: ModeResult = {
        name: np.zeros(n, dtype=kinds.get(name, np.float64)) for name in _MODE_FIELDS
    }
    mode["factor"][:] = np.nan
    return mode


def _with_blocks(mode: ModeResult, places: Ints, **values: np.ndarray) -> ModeResult:
    """Fill in the blocks that form at some places of a mode result, and return it."""
    mode["forms"][places] = True
    for name, block_values in values.items():
        mode[name][places] = block_values
    return mode


def joint_strengths(inputs: BenchInputs, trials: Trials) -> tuple[Floats, Floats]:
    """Return cohesion in kPa and friction in degrees, (2, n) each, of the first and second joint of each place."""
    joints = np.stack([trials.first, trials.second])
    return inputs.cohesion_kpa[joints], inputs.friction_deg[joints]


def _wedges(inputs: BenchInputs, trials: Trials, height: float, face: float) -> ModeResult:
    a, b = trials.first, trials.second
    cohesion, friction = joint_strengths(inputs, trials)
    dips, dip_directions = inputs.joints.dips_deg, inputs.joints.dip_directions_deg
    full_wedge = wedge_sizes(
        dips[a],
        dip_directions[a],
        dips[b],
        dip_directions[b],
        face,
        inputs.toward_deg,
        0.0,
        inputs.toward_deg,
        height,
    )
    persistent_scale = largest_scale(full_wedge, inputs.trace_m[a], inputs.trace_m[b])
    scale_above_toe = 1.0 - trials.toe
    scale = persistent_scale if inputs.toe == "bench" else scale_above_toe
    heights = height * scale
    long_enough = (
        np.isfinite(persistent_scale)
        & (scale > 0.0)
        & (scale <= persistent_scale * (1.0 + REACHES))
    )
    places = np.flatnonzero(long_enough)
    joint1, joint2 = a[places], b[places]
    wedges = hoek_bray_wedges(
        WedgeArrays(
            joint1_dip_deg=dips[joint1],
            joint1_dip_direction_deg=dip_directions[joint1],
            joint2_dip_deg=dips[joint2],
            joint2_dip_direction_deg=dip_directions[joint2],
            face_dip_deg=face,
            face_dip_direction_deg=inputs.toward_deg,
            upper_dip_deg=0.0,
            upper_dip_direction_deg=inputs.toward_deg,
            height_m=heights[places],
            cohesion1_kpa=cohesion[0, places],
            cohesion2_kpa=cohesion[1, places],
            friction1_deg=friction[0, places],
            friction2_deg=friction[1, places],
            pressures_kpa=inputs.slope.water.pressures_kpa[:1] * 2,
            seismic_trend_deg=inputs.slope.seismic.trend_deg,
            **inputs.loads,
        ),
        forces=False,
    )
    forms = wedges.outcome < WEDGE_OUTCOMES.index("E201")
    places, scales = places[forms], scale[places][forms]
    closed = ByMethod(
        CLOSED_OUTCOMES[WEDGE], wedges.outcome[forms].astype(np.int16), wedges.factor[forms]
    )
    volume = full_wedge.volume_m3[places] * scales**3
    return _with_blocks(
        _empty_mode(len(trials)),
        places,
        fails=closed.falls_short(inputs.number("fos")),
        outcome=closed.outcome,
        factor=closed.factor,
        block_height_m=heights[places],
        setback_m=full_wedge.setback_m[places] * scales,
        volume_m3=volume,
        spill_m=cone_spill_width(volume, face, inputs.number("repose"), inputs.number("swell")),
        width_m=full_wedge.face_width_m[places] * scales,
    )


def _planes(inputs: BenchInputs, trials: Trials, height: float, face: float) -> ModeResult:
    a = trials.first
    dips = inputs.joints.dips_deg[a]
    full_plane = plane_sizes(dips, face, 0.0, height)
    lateral_deviation = direction_difference_deg(
        inputs.joints.dip_directions_deg[a], inputs.toward_deg
    )
    with np.errstate(invalid="ignore"):
        persistent_scale = np.minimum(1.0, inputs.trace_m[a] / full_plane.length_m)
    scale = persistent_scale if inputs.toe == "bench" else 1.0 - trials.toe
    long_enough = (
        np.isfinite(persistent_scale)
        & (scale > 0.0)
        & (scale <= persistent_scale * (1.0 + REACHES))
    )
    places = np.flatnonzero(
        long_enough & (lateral_deviation <= inputs.number("lateral") + _ANGLE_TOLERANCE_DEG)
    )
    cohesion, friction = joint_strengths(inputs, trials)
    heights = (height * scale)[places]
    blocks = plane_failures(
        PlaneArrays(
            face_dip_deg=face,
            upper_dip_deg=0.0,
            plane_dip_deg=dips[places],
            height_m=heights,
            cohesion_kpa=cohesion[0, places],
            friction_deg=friction[0, places],
            pressure_kpa=next(iter(inputs.slope.water.pressures_kpa), None),
            **inputs.loads,
        )
    )
    forms = blocks.outcome < PLANE_OUTCOMES.index("E203")
    places, scales = places[forms], scale[places][forms]
    closed = ByMethod(
        CLOSED_OUTCOMES[PLANE], blocks.outcome[forms].astype(np.int16), blocks.factor[forms]
    )
    area = full_plane.area_m2[places] * scales**2
    return _with_blocks(
        _empty_mode(len(trials)),
        places,
        fails=closed.falls_short(inputs.number("fos")),
        outcome=closed.outcome,
        factor=closed.factor,
        block_height_m=heights[forms],
        setback_m=full_plane.setback_m[places] * scales,
        volume_m3=area * inputs.step_m(height),
        spill_m=prism_spill_width(area, face, inputs.number("repose"), inputs.number("swell")),
        width_m=np.full(places.size, inputs.step_m(height)),
    )


def _columns(inputs: BenchInputs, trials: Trials, height: float, face: float) -> ModeResult:
    """Return the toppling columns of each place; either joint may be the steep one."""
    heights, limit = height * (1.0 - trials.toe), inputs.number("lateral_toppling")
    mode = _empty_mode(len(trials))
    friction = joint_strengths(inputs, trials)[1]
    for index, (steep, base) in enumerate(
        ((trials.first, trials.second), (trials.second, trials.first))
    ):
        dip, base_dip = inputs.joints.dips_deg[steep], inputs.joints.dips_deg[base]
        deviation_into_slope = direction_difference_deg(
            inputs.joints.dip_directions_deg[steep], inputs.toward_deg + 180.0
        )
        deviation_out_of_slope = direction_difference_deg(
            inputs.joints.dip_directions_deg[base], inputs.toward_deg
        )
        is_kinematic = (deviation_into_slope <= limit + _ANGLE_TOLERANCE_DEG) & (
            deviation_out_of_slope <= limit + _ANGLE_TOLERANCE_DEG
        )
        is_kinematic &= (
            (dip >= 90.0 - face + friction[index] - _ANGLE_TOLERANCE_DEG)
            & (base_dip > 0.0)
            & (base_dip < face)
            & (dip < 90.0)
        )
        places = np.flatnonzero(is_kinematic & ~mode["forms"])
        widths = inputs.spacing_m[steep[places]]
        has_spacing = np.isfinite(widths)
        sides, bases = np.radians(dip[places]), np.radians(base_dip[places])
        first = column_sizes(dip[places], base_dip[places], face, heights[places], 1.0).height_m
        # horizontal distance from the daylight of the base to the foot of the first column, and the base behind it
        foot = heights[places] / math.tan(math.radians(face)) + first * np.cos(sides)
        base_length = inputs.trace_m[base[places]] * np.cos(bases) - foot
        reach = np.minimum(base_length, heights[places])
        rows = column_sizes(
            dip[places],
            base_dip[places],
            face,
            heights[places],
            np.where(has_spacing, widths, 1.0),
            np.maximum(0.0, reach),
        )
        has_column = (
            (first > 0.0)
            & (first <= inputs.trace_m[steep[places]] * (1.0 + REACHES))
            & (base_length > 0.0)
        )
        with np.errstate(divide="ignore"):
            factor = np.where(has_spacing, 1.0 / rows.slenderness, np.nan)
        topples = has_spacing & (factor < inputs.number("fos")) & (rows.columns > 0.0)
        columns = places[has_column]
        _with_blocks(
            mode,
            columns,
            fails=topples[has_column],
            factor=factor[has_column],
            block_height_m=heights[columns],
            setback_m=rows.setback_m[has_column],
            volume_m3=rows.area_m2[has_column] * inputs.step_m(height),
            spill_m=prism_spill_width(
                rows.area_m2[has_column], face, inputs.number("repose"), inputs.number("swell")
            ),
            width_m=np.full(columns.size, inputs.step_m(height)),
        )
    return mode
