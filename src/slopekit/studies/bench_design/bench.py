"""One bench against all trials: what forms at each place, what of it fails, how much of crest and rock goes with it.

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
from slopekit.studies.bench_design.given import BenchInputs
from slopekit.studies.bench_design.trials import Trials
from slopekit.studies.kinematic.criteria import beside_deg
from slopekit.studies.outcomes import ByMethod

MODES: Final = ("wedge", "plane", "toppling")
WEDGE, PLANE, TOPPLING = range(3)
_ANGLE: Final = 1e-9  # degrees, as in studies.kinematic.criteria


@dataclass(frozen=True)
class Bench:
    """What becomes of the trials in one bench; (3, n) by mode, in the order of `MODES`.

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


def parts_of(asked: BenchInputs, trials: Trials, height_m: float, face_dip_deg: float) -> "list[Part]":
    """Every trial in a bench of one height and face by the closed forms, in the order of `MODES`."""
    return [part(asked, trials, height_m, face_dip_deg) for part in (_wedges, _planes, _columns)]


def bench_of(height_m: float, face_dip_deg: float, parts: "Sequence[Part]") -> Bench:
    """What becomes of the trials in a bench, once its modes are judged."""
    forms, fails, factor, block, setback, volume, spill, width = (
        np.stack([part[name] for part in parts]) for name in _OF_BENCH
    )
    lost = np.where(fails, setback, -1.0)
    governs = np.where(fails.any(axis=0), lost.argmax(axis=0), -1)
    at = np.maximum(governs, 0), np.arange(len(governs))
    own = [np.where(governs < 0, 0.0, values[at]) for values in (setback, volume, spill, width)]
    return Bench(height_m, face_dip_deg, forms, fails, factor, block, governs.astype(np.int64), *own)


#: What becomes of one mode: arrays (n,) by their names; sizes are 0 where nothing forms.
Part: TypeAlias = dict[str, np.ndarray]
_OF_BENCH: Final = ("forms", "fails", "factor", "block_height_m", "setback_m", "volume_m3", "spill_m", "width_m")
_NAMES: Final = (*_OF_BENCH, "outcome")
#: Outcomes of the closed forms that PRE-IE is asked beside, by mode.
CLOSED_OUTCOMES: Final = (WEDGE_OUTCOMES, ("slides_on_J1", *PLANE_OUTCOMES[1:]))


def _part(n: int) -> Part:
    """A mode in which nothing forms at any of n places."""
    kinds = {"forms": np.bool_, "fails": np.bool_, "outcome": np.int16}
    part: Part = {name: np.zeros(n, dtype=kinds.get(name, np.float64)) for name in _NAMES}
    part["factor"][:] = np.nan
    return part


def _with_blocks(part: Part, those: Ints, **values: np.ndarray) -> Part:
    """A mode with what forms at some of its places."""
    part["forms"][those] = True
    for name, own in values.items():
        part[name][those] = own
    return part


def strengths_at(asked: BenchInputs, trials: Trials) -> tuple[Floats, Floats]:
    """Cohesion and friction (2, n) of the first and second joint of each place."""
    joints = np.stack([trials.first, trials.second])
    return asked.cohesion_kpa[joints], asked.friction_deg[joints]


def _wedges(asked: BenchInputs, trials: Trials, height: float, face: float) -> Part:
    a, b = trials.first, trials.second
    cohesion, friction = strengths_at(asked, trials)
    dips, ways = asked.joints.dips_deg, asked.joints.dip_directions_deg
    whole = wedge_sizes(dips[a], ways[a], dips[b], ways[b], face, asked.toward_deg, 0.0, asked.toward_deg, height)
    free = largest_scale(whole, asked.trace_m[a], asked.trace_m[b])
    up = 1.0 - trials.toe
    scale = free if asked.toe == "bench" else up
    heights = height * scale
    long_enough = np.isfinite(free) & (scale > 0.0) & (scale <= free * (1.0 + REACHES))
    those = np.flatnonzero(long_enough)
    one, two = a[those], b[those]
    wedges = hoek_bray_wedges(
        WedgeArrays(
            joint1_dip_deg=dips[one], joint1_dip_direction_deg=ways[one], joint2_dip_deg=dips[two],
            joint2_dip_direction_deg=ways[two],
            face_dip_deg=face, face_dip_direction_deg=asked.toward_deg, upper_dip_deg=0.0,
            upper_dip_direction_deg=asked.toward_deg, height_m=heights[those],
            cohesion1_kpa=cohesion[0, those], cohesion2_kpa=cohesion[1, those],
            friction1_deg=friction[0, those], friction2_deg=friction[1, those],
            pressures_kpa=asked.slope.water.pressures_kpa[:1] * 2,
            seismic_trend_deg=asked.slope.seismic.trend_deg, **asked.loads,
        ), forces=False,
    )  # fmt: skip
    kept = wedges.outcome < WEDGE_OUTCOMES.index("E201")
    those, scales = those[kept], scale[those][kept]
    closed = ByMethod(CLOSED_OUTCOMES[WEDGE], wedges.outcome[kept].astype(np.int16), wedges.factor[kept])
    volume = whole.volume_m3[those] * scales**3
    return _with_blocks(
        _part(len(trials)), those, fails=closed.falls_short(asked.number("fos")), outcome=closed.outcome,
        factor=closed.factor, block_height_m=heights[those],
        setback_m=whole.setback_m[those] * scales, volume_m3=volume,
        spill_m=cone_spill_width(volume, face, asked.number("repose"), asked.number("swell")),
        width_m=whole.face_width_m[those] * scales,
    )  # fmt: skip


def _planes(asked: BenchInputs, trials: Trials, height: float, face: float) -> Part:
    a = trials.first
    dips = asked.joints.dips_deg[a]
    whole = plane_sizes(dips, face, 0.0, height)
    beside = beside_deg(asked.joints.dip_directions_deg[a], asked.toward_deg)
    with np.errstate(invalid="ignore"):
        free = np.minimum(1.0, asked.trace_m[a] / whole.length_m)
    scale = free if asked.toe == "bench" else 1.0 - trials.toe
    long_enough = np.isfinite(free) & (scale > 0.0) & (scale <= free * (1.0 + REACHES))
    those = np.flatnonzero(long_enough & (beside <= asked.number("lateral") + _ANGLE))
    cohesion, friction = strengths_at(asked, trials)
    heights = (height * scale)[those]
    blocks = plane_failures(
        PlaneArrays(
            face_dip_deg=face, upper_dip_deg=0.0, plane_dip_deg=dips[those], height_m=heights,
            cohesion_kpa=cohesion[0, those], friction_deg=friction[0, those],
            pressure_kpa=next(iter(asked.slope.water.pressures_kpa), None), **asked.loads,
        )
    )  # fmt: skip
    kept = blocks.outcome < PLANE_OUTCOMES.index("E203")
    those, scales = those[kept], scale[those][kept]
    closed = ByMethod(CLOSED_OUTCOMES[PLANE], blocks.outcome[kept].astype(np.int16), blocks.factor[kept])
    area = whole.area_m2[those] * scales**2
    return _with_blocks(
        _part(len(trials)), those, fails=closed.falls_short(asked.number("fos")), outcome=closed.outcome,
        factor=closed.factor, block_height_m=heights[kept],
        setback_m=whole.setback_m[those] * scales, volume_m3=area * asked.step_m(height),
        spill_m=prism_spill_width(area, face, asked.number("repose"), asked.number("swell")),
        width_m=np.full(those.size, asked.step_m(height)),
    )  # fmt: skip


def _columns(asked: BenchInputs, trials: Trials, height: float, face: float) -> Part:
    """Either joint of a place may be the steep one."""
    heights, limit = height * (1.0 - trials.toe), asked.number("lateral_toppling")
    part = _part(len(trials))
    friction = strengths_at(asked, trials)[1]
    for at, (steep, base) in enumerate(((trials.first, trials.second), (trials.second, trials.first))):
        dip, out = asked.joints.dips_deg[steep], asked.joints.dips_deg[base]
        into = beside_deg(asked.joints.dip_directions_deg[steep], asked.toward_deg + 180.0)
        toward = beside_deg(asked.joints.dip_directions_deg[base], asked.toward_deg)
        can = (into <= limit + _ANGLE) & (toward <= limit + _ANGLE)
        can &= (dip >= 90.0 - face + friction[at] - _ANGLE) & (out > 0.0) & (out < face) & (dip < 90.0)
        those = np.flatnonzero(can & ~part["forms"])
        widths = asked.spacing_m[steep[those]]
        known = np.isfinite(widths)
        sides, bases = np.radians(dip[those]), np.radians(out[those])
        first = column_sizes(dip[those], out[those], face, heights[those], 1.0).height_m
        # from where the base daylights to the foot of the first column, and what is left of it behind
        foot = heights[those] / math.tan(math.radians(face)) + first * np.cos(sides)
        left = asked.trace_m[base[those]] * np.cos(bases) - foot
        reach = np.minimum(left, heights[those])
        rows = column_sizes(dip[those], out[those], face, heights[those], np.where(known, widths, 1.0),
                            np.maximum(0.0, reach))  # fmt: skip
        held = (first > 0.0) & (first <= asked.trace_m[steep[those]] * (1.0 + REACHES)) & (left > 0.0)
        with np.errstate(divide="ignore"):
            factor = np.where(known, 1.0 / rows.slenderness, np.nan)
        turns = known & (factor < asked.number("fos")) & (rows.columns > 0.0)
        some = those[held]
        _with_blocks(
            part, some, fails=turns[held], factor=factor[held], block_height_m=heights[some],
            setback_m=rows.setback_m[held], volume_m3=rows.area_m2[held] * asked.step_m(height),
            spill_m=prism_spill_width(rows.area_m2[held], face, asked.number("repose"), asked.number("swell")),
            width_m=np.full(some.size, asked.step_m(height)),
        )  # fmt: skip
    return part
