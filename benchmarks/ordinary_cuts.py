"""Random wedges of ordinary cuts: what the limit is beside Hoek & Bray, and whether it is smooth and monotone.

    python -m benchmarks.ordinary_cuts [COUNT] [SEED]

Cuts of 8 to 30 m, faces of 50 to 80°, two joints with c 0 to 60 kPa and φ 20 to 45°, dry to half full, a quarter of
them with an earthquake, a quarter with a tension crack. More c or φ may not lower the limit, 0.1 % of an input may not
move it by more than 2 %, and none of these may take it away. Strength divided by k has the limit divided by k, and no
limit lies above its upper bound. Less water or shaking may lower it where their moments hold the block: how often is
counted. Prints what breaks a rule, the share with the same factor as Hoek & Bray, quantiles of the ratio, times, and
notices a sheet.
"""

import sys
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from functools import partial
from typing import Any

import numpy as np

import slopekit as sk
from slopekit.core.arrays import Floats
from slopekit.design.reading.files import load
from slopekit.kinds.single_block.blocks_on_arrays import LimitsOfMany
from slopekit.studies.evaluation.vectorised import Vectorised, vectorised
from slopekit.studies.prob.sampling import samples

#: Part of the limit that rounding, and points of the bed that begin to slip, may take from it.
LEAST_FALL = 1e-6
#: Part of the limit that a change of one input by 0.1 % may move.
MOST_MOVE = 0.02
#: By so much strength is divided.
LESS_STRENGTH = 1.3
#: Sheets whose notices and upper bounds are looked at.
SHEETS = 500


def ordinary_cut(rng: np.random.Generator) -> dict[str, Any]:
    """Return the inputs of a random wedge; most of them form one."""
    inputs: dict[str, Any] = {
        "dips": (
            (rng.uniform(30, 80), rng.uniform(95, 180)),
            (rng.uniform(30, 80), rng.uniform(180, 265)),
        ),
        "face": (rng.uniform(50, 80), 180.0),
        "upper": (rng.uniform(0, 15), 180.0),
        "height": rng.uniform(8, 30),
        "c": tuple(rng.uniform(0, 60, 2)),
        "phi": tuple(rng.uniform(20, 45, 2)),
        "unit_weight": rng.uniform(23, 27),
        "water": rng.uniform(0, 0.5),
    }
    if rng.random() < 0.25:
        inputs["seismic"] = rng.uniform(0, 0.2)
    if rng.random() < 0.25:
        inputs["crack"] = f"{rng.uniform(70, 90):.2f}/180@{rng.uniform(1, 5):.2f}m"
    return inputs


def scattering(shaken: bool, cracked: bool) -> dict[str, Any]:
    """Return the design of which such cuts are samples."""

    def between(low: float, high: float) -> dict[str, Any]:
        return {"dist": "uniform", "min": low, "max": high}

    def joint(low: float, high: float, strength: str) -> dict[str, Any]:
        return {
            "plane": {"dip": between(30, 80), "dip_direction": between(low, high)},
            "strength": strength,
        }

    design: dict[str, Any] = {
        "slopekit": 1,
        "kind": "wedge",
        "joints": {"J1": joint(95, 180, "a"), "J2": joint(180, 265, "b")},
        "slope": {
            "face": {"dip": between(50, 80), "dip_direction": 180},
            "upper": {"dip": between(0, 15), "dip_direction": 180},
            "height": between(8, 30),
        },
        "strength": {name: {"c": between(0, 60), "phi": between(20, 45)} for name in "ab"},
        "rock": {"unit_weight": between(23, 27)},
        "water": {"fill": between(0, 0.5)},
    }
    if shaken:
        design["loads"] = {"seismic": {"k": between(0, 0.2)}}
    if cracked:
        design["crack"] = {
            "plane": {"dip": between(70, 90), "dip_direction": 180},
            "distance": between(1, 5),
        }
    return design


def stronger(names: Sequence[str], values: Floats) -> Iterator[tuple[str, Floats]]:
    """Yield changes of samples (n, k) that may not lower the limit, by name."""
    for change, key, times, more in (
        ("c + 0.1 %", ".c", 1.001, 0.0),
        ("c + 10 %", ".c", 1.1, 0.0),
        ("φ + 0.02°", ".phi", 1.0, 0.02),
        ("φ + 2°", ".phi", 1.0, 2.0),
        ("water - 0.1 %", "water.fill", 0.999, 0.0),
        ("water - 20 %", "water.fill", 0.8, 0.0),
        ("seismic - 10 %", "seismic.k", 0.9, 0.0),
    ):
        columns = [name.endswith(key) for name in names]
        if any(columns):
            changed = values.copy()
            changed[:, columns] = changed[:, columns] * times + more
            yield change, changed


def limits_of_cuts(
    count: int, seed: int
) -> Iterator[tuple[Sequence[str], Floats, Callable[[Floats], LimitsOfMany]]]:
    """Yield random wedges with a factor of safety: names of columns, values (n, k), and what gives their limits.

    Each with or without an earthquake and a crack; `count` of all four together, about.
    """
    for shaken in (False, True):
        for cracked in (False, True):
            share = (0.25 if shaken else 0.75) * (0.25 if cracked else 0.75)
            design = load(scattering(shaken, cracked))
            drawn = samples(design.variables, (), round(1.3 * share * count), seed)
            fast = vectorised(design, drawn.values, drawn.settings)
            assert fast is not None
            rows = fast.rows(drawn.values)
            rows = rows.take(np.flatnonzero(~rows.closed_form.starts_with("E")))
            yield (
                drawn.names,
                rows.values[rows.limits().limit > 0.0],
                partial(limits_of_values, fast),
            )


def limits_of_values(columns: Vectorised, values: Floats) -> LimitsOfMany:
    """Return what PRE-IE says of samples (n, k)."""
    return columns.rows(values).limits()


def broken_rules(count: int, seed: int) -> tuple[int, list[tuple[str, float, float]]]:
    """Return how many wedges were looked at, and which changes broke a rule: their names, the limits before and after.

    The limit after is not a number where there is none any more.
    """
    looked_at, broken = 0, list[tuple[str, float, float]]()
    for names, values, limits in limits_of_cuts(count, seed):
        looked_at, before = looked_at + len(values), limits(values)
        for change, changed in stronger(names, values):
            after = limits(changed)
            moved = after.limit / before.limit - 1.0
            lower = (moved < -LEAST_FALL) & (change[0] in "cφ")
            ends = np.isnan(after.limit) & np.isin(after.status, ("topples", "lifted", "falls"))
            far = (abs(moved) > MOST_MOVE) & change.endswith(" 0.1 %")
            rows = np.flatnonzero(lower | ends | far)
            broken += [(change, float(before.limit[row]), float(after.limit[row])) for row in rows]
    return looked_at, broken


def with_less_load(count: int, seed: int) -> tuple[int, Floats]:
    """Return how many limits with less water or shaking were looked at, and (m,) after / before of those that fell."""
    ratios = list[Floats]()
    for names, values, limits in limits_of_cuts(count, seed):
        before = limits(values).limit
        ratios += [
            limits(changed).limit / before
            for change, changed in stronger(names, values)
            if change[0] in "ws"
        ]
    every = np.concatenate(ratios)
    return len(every), every[every < 1.0 - LEAST_FALL]


def with_strength_divided(count: int, seed: int) -> Floats:
    """Return (n,) by how much the limit differs, in parts, from that of strength divided, times the divisor."""
    off = list[Floats]()
    for names, values, limits in limits_of_cuts(count, seed):
        divided = values.copy()
        c, phi = ([name.endswith(key) for name in names] for key in (".c", ".phi"))
        divided[:, c] /= LESS_STRENGTH
        divided[:, phi] = np.degrees(np.arctan(np.tan(np.radians(divided[:, phi])) / LESS_STRENGTH))
        off.append(np.abs(limits(divided).limit * LESS_STRENGTH / limits(values).limit - 1.0))
    return np.concatenate(off)


def sheets_of_cuts(count: int, seed: int) -> Iterator[sk.Result]:
    """Yield results of random wedges that have a factor of safety."""
    rng, found = np.random.default_rng(seed), 0
    while found < count:
        try:
            result = sk.wedge(**ordinary_cut(rng))
        except sk.GeometryError:
            continue
        if result.fos.limit:
            found += 1
            yield result


def notices_of_sheets(sheets: Iterable[sk.Result]) -> tuple[Counter[str], int]:
    """Return on how many sheets each notice stands, and how many have none."""
    codes = [{notice.code for notice in sheet.warnings} for sheet in sheets]
    return Counter(code for sheet in codes for code in sheet), sum(not sheet for sheet in codes)


def above_bound(sheets: Iterable[sk.Result]) -> tuple[int, list[float]]:
    """Return how many sheets have an upper bound, and limit / bound of those whose limit lies above it."""
    factors = [(sheet.fos.limit, sheet.fos.static_bound) for sheet in sheets]
    ratios = [limit / bound for limit, bound in factors if limit is not None and bound is not None]
    return len(ratios), [ratio for ratio in ratios if ratio > 1.0 + 1e-9]


def main(count: int = 2000, seed: int = 1) -> None:
    """Run the wedges and print what was found."""
    began = time.process_time()
    looked_at, broken = broken_rules(count, seed)
    taken = time.process_time() - began
    for change, before, after in broken:
        print(f"{change}: {before:.6g} to {after:.6g}")
    print(f"{looked_at} wedges, {len(broken)} broken rules; {taken:.1f} s of processor")
    lessened, fell = with_less_load(count, seed)
    print(
        f"less water or shaking lowers {len(fell)} of {lessened} limits, at most to {min(fell, default=1.0):.4f} of it"
    )
    off = with_strength_divided(count, seed)
    print(
        f"strength / {LESS_STRENGTH}: limit times that off by",
        {q: float(f"{np.nanquantile(off, q):.1e}") for q in (0.5, 0.99, 1.0)},
        f"; {int(np.isnan(off).sum())} without a limit, {int((off > LEAST_FALL).sum())} beyond 1e-6",
    )
    every = [limits(values) for _, values, limits in limits_of_cuts(count, seed)]
    ratio = np.concatenate([of.limit / of.forces for of in every])
    ratio = ratio[np.isfinite(ratio)]
    print(f"the same factor as Hoek & Bray (0.1 %): {np.mean(np.abs(ratio - 1.0) < 1e-3):.1%}")
    print(
        "limit / Hoek & Bray at",
        {q: round(float(np.quantile(ratio, q)), 4) for q in (0.0, 0.01, 0.05, 0.25, 0.5)},
    )
    rng, seconds = np.random.default_rng(seed), []
    for _ in range(300):
        began = time.process_time()
        with suppress(sk.GeometryError):
            sk.wedge(**ordinary_cut(rng))
            seconds.append(time.process_time() - began)
    print(
        f"CPU of an analysis: median {np.median(seconds) * 1e3:.1f} ms, most {max(seconds) * 1e3:.0f} ms"
    )
    sheets = list(sheets_of_cuts(SHEETS, seed))
    bounds, above = above_bound(sheets)
    print(f"limits above their upper bound: {len(above)} of {bounds}")
    notices, without = notices_of_sheets(sheets)
    print(
        f"of {SHEETS} sheets without a notice: {without / SHEETS:.1%};", dict(notices.most_common())
    )


if __name__ == "__main__":
    main(*(int(word) for word in sys.argv[1:]))
