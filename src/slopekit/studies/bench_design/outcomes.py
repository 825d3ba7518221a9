"""Statistics of one bench: probabilities with limits, backbreak, volume and spill, berms and inter-ramp angles."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from slopekit.closed_form.berms import effective_face_angle, inter_ramp_angle
from slopekit.core.arrays import Floats
from slopekit.studies.bench_design.bench import MODES, Bench
from slopekit.studies.bench_design.inputs import BenchInputs
from slopekit.studies.bench_design.trials import Trials, bootstrapped_shares, survey_share
from slopekit.studies.prob.estimates import Share

STRETCH_M = 100.0
PERCENTILES = (0.5, 0.8, 0.9, 0.95, 0.99)
#: Of the curves in JSON.
_CURVE_SHARES = tuple(k / 100.0 for k in range(101))
_MODE_KEYS = (*MODES, "any")


def length_statistics(values: Floats, weights: Floats | None = None) -> dict[str, Any]:
    """Return mean, quantiles by share and maximum of values (n,) of places or stretches, weighted."""
    shares = dict(zip(PERCENTILES, quantiles(values, PERCENTILES, weights), strict=True))
    return {
        "mean": float(np.average(values, weights=weights)),
        "quantiles": shares,
        "max": float(values.max()),
    }


def quantiles(
    values: Floats, shares: Sequence[float], weights: Floats | None = None
) -> list[float]:
    """Return for each share the least drawn value that this share of the values does not exceed.

    `weights` (n,), one for all where None.

    >>> quantiles(np.array([0.0, 0.0, 0.0, 0.0, 3.0]), [0.8, 0.81])
    [0.0, 3.0]
    """
    order = np.argsort(values, kind="stable")
    cumulative_weights = np.cumsum(np.ones(len(values)) if weights is None else weights[order])
    positions = np.searchsorted(
        cumulative_weights, np.array(shares) * cumulative_weights[-1] * (1.0 - 1e-12), side="left"
    )
    least_values: list[float] = values[order][np.minimum(positions, len(values) - 1)].tolist()
    return least_values


@dataclass(frozen=True)
class BermStatistics:
    """A berm width on a bench, with its reliability.

    Attributes
    ----------
    reliability : the share of the length whose berm stays as wide as the catch width; inter_ramp_deg : of the design
    left_m : what is left of the berm, by the share of the length where it is at least that
    spill_kept : the share of places whose broken rock stays on such a berm
    accepted : None where no reliability has to be reached
    """

    height_m: float
    face_dip_deg: float
    berm_m: float
    catch_width_m: float
    inter_ramp_deg: float
    reliability: Share
    left_m: Mapping[float, float] = field(metadata={"json": "berm_left_m"})
    spill_kept: float
    accepted: bool | None = None


@dataclass(frozen=True)
class BenchStatistics:
    """Statistics of a bench of one height and face angle.

    Attributes
    ----------
    modes : by the words of `MODES`, and `any`: how often a block forms, how often one that forms fails, how often both,
        `forms`, `fails_if_formed` and `fails`
    backbreak : along the bench, m; as `along_the_bench` has it, as volume and spill
    curve_m : backbreak at 0, 1 ... 100 % of the length
    effective_face_deg : at the target reliability
    volume_m3, crest_lost : on 100 m of bench: what fails, and the part of the crest above it
    spill : where something fails, m
    berm_needed_m : so that the share wanted of the length keeps the catch width; inter_ramp_deg : with that berm
    bare : without cohesion, as `without_cohesion` has it; None where there is none
    """

    height_m: float
    face_dip_deg: float
    catch_width_m: float
    modes: Mapping[str, Mapping[str, Share]] = field(metadata={"json": "probability"})
    backbreak: Mapping[str, Any] = field(metadata={"json": "backbreak_m"})
    curve_m: tuple[float, ...] = field(metadata={"json": "backbreak_curve_m"})
    effective_face_deg: float
    volume_m3: Mapping[str, Any] | None = field(metadata={"json": "volume_per_100_m_m3"})
    crest_lost: float = field(metadata={"json": "share_of_crest_lost"})
    spill: Mapping[str, Any] | None = field(metadata={"json": "spill_width_m"})
    berm_needed_m: float
    inter_ramp_deg: float = field(metadata={"json": "inter_ramp_at_berm_needed_deg"})
    berms: tuple[BermStatistics, ...] = field(metadata={"json": "reliability"})
    bare: Mapping[str, Any] | None = field(default=None, metadata={"json": "without_cohesion"})


def without_cohesion(inputs: BenchInputs, bench: Bench, outcome: BenchStatistics) -> dict[str, Any]:
    """Return statistics of a bench without cohesion: failing shares, berm needed, whether cohesion decides.

    It decides where half or more of what fails without it is held by it, and that is more than the limits of the share
    with it allow.

    Parameters
    ----------
    bench : without cohesion; outcome : what is said of it with cohesion
    """
    forms, fails_by_mode = (
        [*mode_flags, mode_flags.any(axis=0)] for mode_flags in (bench.forms, bench.fails)
    )
    shares = {
        name: float(mode_flags.mean())
        for name, mode_flags in zip(_MODE_KEYS, fails_by_mode, strict=True)
    }
    share_of_forming = {
        name: float((is_failed & is_formed).sum() / is_formed.sum()) if is_formed.any() else None
        for name, is_failed, is_formed in zip(_MODE_KEYS, fails_by_mode, forms, strict=True)
    }
    steps = place_lengths(bench, inputs.step_m(bench.height_m))
    backbreak = quantiles(bench.setback_m, [inputs.number("reliability")], steps)[0]
    with_cohesion = outcome.modes["any"]["fails"]
    decides = (
        shares["any"] > with_cohesion.high and 2.0 * (with_cohesion.share or 0.0) <= shares["any"]
    )
    berm_needed = inputs.catch_m(bench.height_m) + backbreak
    return {
        "fails_if_formed": share_of_forming,
        "fails": shares,
        "berm_needed_m": berm_needed,
        "decides": decides,
    }


def bench_statistics(inputs: BenchInputs, trials: Trials, bench: Bench) -> BenchStatistics:
    """Return the statistics of one bench."""
    height, face, confidence = bench.height_m, bench.face_dip_deg, inputs.number("confidence")
    reliability, catch = inputs.number("reliability"), inputs.catch_m(height)
    backbreak, steps = bench.setback_m, place_lengths(bench, inputs.step_m(height))
    design_backbreak = quantiles(backbreak, [reliability], steps)[0]
    berm_needed = catch + design_backbreak
    berms = (berm_needed,) if inputs.berms_m is None else inputs.berms_m
    forms = [*bench.forms, bench.forms.any(axis=0)]
    fails = [*bench.fails, bench.fails.any(axis=0)]
    # a berm narrower than the catch width by rounding alone keeps it
    keeps = [berm - backbreak >= catch * (1.0 - 1e-12) - 1e-12 for berm in berms]
    seed = int(inputs.number("seed"))
    places, length = (np.array(flags, dtype=np.float64).T for flags in ([*forms, *fails], keeps))
    surveys = bootstrapped_shares(inputs.joints, trials, places, seed)
    survey_forms, survey_fails = surveys[:, :4], surveys[:, 4:]
    survey_keeps = bootstrapped_shares(inputs.joints, trials, length, seed, steps)
    with np.errstate(invalid="ignore", divide="ignore"):
        survey_fails_if_formed = survey_fails / survey_forms
    modes = {
        name: {
            "forms": survey_share(forms[k], None, survey_forms[:, k], confidence),
            "fails_if_formed": survey_share(
                fails[k], forms[k], survey_fails_if_formed[:, k], confidence
            ),
            "fails": survey_share(fails[k], None, survey_fails[:, k], confidence),
        }
        for k, name in enumerate(_MODE_KEYS)
    }
    failed = bench.governs >= 0
    volumes, crest_lost = stretch_volumes(bench, steps)
    curve = quantiles(backbreak, _CURVE_SHARES, steps)
    return BenchStatistics(
        height,
        face,
        catch,
        modes,
        length_statistics(backbreak, steps),
        tuple(curve),
        float(effective_face_angle(height, face, design_backbreak)),
        length_statistics(volumes) if len(volumes) else None,
        crest_lost,
        length_statistics(bench.spill_m[failed]) if failed.any() else None,
        berm_needed,
        float(inter_ramp_angle(height, face, berm_needed)),
        tuple(
            BermStatistics(
                height,
                face,
                berm,
                catch,
                float(inter_ramp_angle(height, face, berm)),
                survey_share(keep, None, survey_keeps[:, k], confidence, steps),
                {
                    share: max(0.0, berm - value)
                    for share, value in zip(
                        PERCENTILES, quantiles(backbreak, PERCENTILES, steps), strict=True
                    )
                },
                float((bench.spill_m <= berm).mean()),
            )
            for k, (berm, keep) in enumerate(zip(berms, keeps, strict=True))
        ),
    )


def place_lengths(bench: Bench, every_m: float) -> Floats:
    """Return the length of bench (n,) in m that each place stands for: `every_m`, or the width that failed if wider."""
    return np.maximum(every_m, bench.width_m)


def stretch_volumes(bench: Bench, steps: Floats) -> tuple[Floats, float]:
    """Return the failing volumes (k,) in m³ by 100 m of consecutive places, and the lost fraction of the crest."""
    ends = np.cumsum(steps)
    stretch = ((ends - steps) // STRETCH_M).astype(np.int64)
    stretches = math.floor(ends[-1] / STRETCH_M)
    volumes: Floats = np.bincount(stretch, bench.volume_m3, minlength=stretches)[:stretches].astype(
        np.float64
    )
    return volumes, float(bench.width_m.sum() / ends[-1])
