"""What the trials of one bench come to: probabilities with limits, distributions, berms and inter-ramp angles."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from slopekit.closed_form.berms import effective_face_angle, inter_ramp_angle
from slopekit.core.arrays import Floats
from slopekit.studies.bench_design.bench import MODES, Bench
from slopekit.studies.bench_design.given import BenchInputs
from slopekit.studies.bench_design.trials import Trials, bootstrapped, share_of
from slopekit.studies.prob.estimates import Share

STRETCH_M = 100.0
PERCENTILES = (0.5, 0.8, 0.9, 0.95, 0.99)
#: Of the curves in JSON.
_CURVE = tuple(k / 100.0 for k in range(101))
_CALLED = (*MODES, "any")


def along_the_bench(values: Floats, weights: Floats | None = None) -> dict[str, Any]:
    """Mean, quantiles by share and max of values (n,) of places or stretches, each as often as its weight."""
    shares = dict(zip(PERCENTILES, quantiles(values, PERCENTILES, weights), strict=True))
    return {"mean": float(np.average(values, weights=weights)), "quantiles": shares, "max": float(values.max())}


def quantiles(values: Floats, shares: Sequence[float], weights: Floats | None = None) -> list[float]:
    """The least values that so large a share lies at or below: values that were drawn, none between them.

    `weights` (n,), one for all where None.

    >>> quantiles(np.array([0.0, 0.0, 0.0, 0.0, 3.0]), [0.8, 0.81])
    [0.0, 3.0]
    """
    order = np.argsort(values, kind="stable")
    below = np.cumsum(np.ones(len(values)) if weights is None else weights[order])
    at = np.searchsorted(below, np.array(shares) * below[-1] * (1.0 - 1e-12), side="left")
    least_values: list[float] = values[order][np.minimum(at, len(values) - 1)].tolist()
    return least_values


@dataclass(frozen=True)
class OfBerm:
    """A berm of a bench.

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
class OfBench:
    """A height and a face.

    Attributes
    ----------
    modes : by the words of `MODES`, and `any`: how often a block forms, how often one that forms fails, how often both,
        `forms`, `fails_if_formed` and `fails`
    backbreak : along the bench, m; as `along_the_bench` has it, as volume and spill
    curve_m : backbreak at 0, 1 ... 100 % of the length
    effective_face_deg : at the reliability wanted
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
    berms: tuple[OfBerm, ...] = field(metadata={"json": "reliability"})
    bare: Mapping[str, Any] | None = field(default=None, metadata={"json": "without_cohesion"})


def without_cohesion(inputs: BenchInputs, bench: Bench, outcome: OfBench) -> dict[str, Any]:
    """What is said of a bench without cohesion: shares that fail, the berm needed, whether cohesion decides.

    It decides where half or more of what fails without it is held by it, and that is more than the limits of the share
    with it allow.

    Parameters
    ----------
    bench : without cohesion; outcome : what is said of it with cohesion
    """
    forms, fails = ([*part, part.any(axis=0)] for part in (bench.forms, bench.fails))
    shares = {name: float(part.mean()) for name, part in zip(_CALLED, fails, strict=True)}
    among = {
        name: float((bad & there).sum() / there.sum()) if there.any() else None
        for name, bad, there in zip(_CALLED, fails, forms, strict=True)
    }
    steps = steps_of(bench, inputs.step_m(bench.height_m))
    lost = quantiles(bench.setback_m, [inputs.number("reliability")], steps)[0]
    with_cohesion = outcome.modes["any"]["fails"]
    decides = shares["any"] > with_cohesion.high and 2.0 * (with_cohesion.share or 0.0) <= shares["any"]
    needed = inputs.catch_m(bench.height_m) + lost
    return {"fails_if_formed": among, "fails": shares, "berm_needed_m": needed, "decides": decides}


def outcome_of(inputs: BenchInputs, trials: Trials, bench: Bench) -> OfBench:
    """Everything that is said of one bench."""
    height, face, confidence = bench.height_m, bench.face_dip_deg, inputs.number("confidence")
    wanted, catch = inputs.number("reliability"), inputs.catch_m(height)
    lost, steps = bench.setback_m, steps_of(bench, inputs.step_m(height))
    loss_at = quantiles(lost, [wanted], steps)[0]
    needed = catch + loss_at
    berms = (needed,) if inputs.berms_m is None else inputs.berms_m
    forms = [*bench.forms, bench.forms.any(axis=0)]
    fails = [*bench.fails, bench.fails.any(axis=0)]
    # a width lost to rounding is not lost
    keeps = [berm - lost >= catch * (1.0 - 1e-12) - 1e-12 for berm in berms]
    seed = int(inputs.number("seed"))
    places, length = (np.array(part, dtype=np.float64).T for part in ([*forms, *fails], keeps))
    surveys = bootstrapped(inputs.joints, trials, places, seed)
    of_forms, of_fails = surveys[:, :4], surveys[:, 4:]
    of_keeps = bootstrapped(inputs.joints, trials, length, seed, steps)
    with np.errstate(invalid="ignore", divide="ignore"):
        of_both = of_fails / of_forms
    modes = {
        name: {
            "forms": share_of(forms[k], None, of_forms[:, k], confidence),
            "fails_if_formed": share_of(fails[k], forms[k], of_both[:, k], confidence),
            "fails": share_of(fails[k], None, of_fails[:, k], confidence),
        }
        for k, name in enumerate(_CALLED)
    }  # fmt: skip
    failed = bench.governs >= 0
    volumes, crest_lost = along(bench, steps)
    curve = quantiles(lost, _CURVE, steps)
    return OfBench(
        height, face, catch, modes, along_the_bench(lost, steps), tuple(curve),
        float(effective_face_angle(height, face, loss_at)),
        along_the_bench(volumes) if len(volumes) else None, crest_lost,
        along_the_bench(bench.spill_m[failed]) if failed.any() else None, needed,
        float(inter_ramp_angle(height, face, needed)),
        tuple(
            OfBerm(
                height, face, berm, catch, float(inter_ramp_angle(height, face, berm)),
                share_of(keep, None, of_keeps[:, k], confidence, steps),
                {share: max(0.0, berm - value) for share, value in
                 zip(PERCENTILES, quantiles(lost, PERCENTILES, steps), strict=True)},
                float((bench.spill_m <= berm).mean()),
            )
            for k, (berm, keep) in enumerate(zip(berms, keeps, strict=True))
        ),
    )  # fmt: skip


def steps_of(bench: Bench, every_m: float) -> Floats:
    """How much of the bench each place stands for, (n,): `every_m`, or what has failed there where that is wider."""
    return np.maximum(every_m, bench.width_m)


def along(bench: Bench, steps: Floats) -> tuple[Floats, float]:
    """Volumes (k,) that fail on each 100 m of a bench on which the places follow each other; the part of crest lost."""
    ends = np.cumsum(steps)
    stretch = ((ends - steps) // STRETCH_M).astype(np.int64)
    whole = math.floor(ends[-1] / STRETCH_M)
    volumes: Floats = np.bincount(stretch, bench.volume_m3, minlength=whole)[:whole].astype(np.float64)
    return volumes, float(bench.width_m.sum() / ends[-1])
