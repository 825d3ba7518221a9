"""Random wedges of ordinary cuts: what the limit is beside Hoek & Bray, and whether it is smooth and monotone.

    python -m benchmarks.ordinary_cuts [COUNT] [SEED]

Cuts of 8 to 30 m, faces of 50 to 80°, two joints with c 0 to 60 kPa and φ 20 to 45°, dry to half full, a quarter of
them with an earthquake, a quarter with a tension crack. More c or φ may not lower the limit, nor may 0.1 % of an input
move it by more than 2 %. Less water or shaking may lower it where their moments hold the block; how often is counted.
Prints what breaks a rule, the share with the same factor as Hoek & Bray, quantiles of the ratio, notices a sheet, and
times.
"""

import sys
import time
from collections import Counter
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

import slopekit as sk
from slopekit.core.onlooker import Clock
from slopekit.kinds import cut
from slopekit.kinds.single_block.one_block_limit import FoundLimit, find_limit
from slopekit.kinds.wedge.design import wedge_design

#: Part of the limit that rounding, and points of the bed that begin to slip, may take from it.
LEAST_FALL = 1e-6
#: Part of the limit that a change of one input by 0.1 % may move.
MOST_MOVE = 0.02
#: Sheets whose notices are counted.
SHEETS = 500


def ordinary_cut(rng: np.random.Generator) -> dict[str, Any]:
    """Return the inputs of a random wedge; most of them form one."""
    inputs: dict[str, Any] = {
        "dips": ((rng.uniform(30, 80), rng.uniform(95, 180)), (rng.uniform(30, 80), rng.uniform(180, 265))),
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


def limit_of(inputs: dict[str, Any]) -> FoundLimit | None:
    """Return the limit of a wedge; None where its planes form none."""
    try:
        made = cut(wedge_design(inputs))
    except sk.GeometryError:
        return None
    return find_limit(made, Clock())


def cuts(count: int, seed: int) -> Iterator[tuple[dict[str, Any], FoundLimit]]:
    """Yield that many random wedges with a factor of safety."""
    rng = np.random.default_rng(seed)
    while count:
        inputs = ordinary_cut(rng)
        found = limit_of(inputs)
        if found is not None and found.analysis.governing.factor:
            count -= 1
            yield inputs, found


def stronger(inputs: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield changes that may not lower the limit, by name; the first is the smallest."""
    yield "c + 0.1 %", inputs | {"c": tuple(1.001 * c for c in inputs["c"])}
    yield "c + 10 %", inputs | {"c": tuple(1.1 * c for c in inputs["c"])}
    yield "φ + 0.02°", inputs | {"phi": tuple(phi + 0.02 for phi in inputs["phi"])}
    yield "φ + 2°", inputs | {"phi": tuple(phi + 2.0 for phi in inputs["phi"])}
    yield "water - 0.1 %", inputs | {"water": 0.999 * inputs["water"]}
    yield "water - 20 %", inputs | {"water": 0.8 * inputs["water"]}
    if "seismic" in inputs:
        yield "seismic - 10 %", inputs | {"seismic": 0.9 * inputs["seismic"]}


def broken_rules(inputs: dict[str, Any], found: FoundLimit, changes: Iterable[tuple[str, dict[str, Any]]]) -> list[str]:
    """Return which changes (as of `stronger`) lower the limit of a wedge or, where they are small, move it too far."""
    limit, forces = found.analysis.governing, found.analysis.forces_only
    broken = []
    for name, changed in changes:
        again = limit_of(changed)
        if again is None or limit.factor is None:
            continue
        after, alone = again.analysis.governing, again.analysis.forces_only
        if after.factor is None:  # no longer driven, which is stronger; or it no longer comes to rest
            if again.analysis.moments_govern:
                broken.append(f"{name}: {limit.factor:.6g} to none")
            continue
        change = after.factor / limit.factor - 1.0
        lost_contact = forces.bond.reshape(-1).sum() != alone.bond.reshape(-1).sum()
        weaker = change < -LEAST_FALL and name[0] in "cφ"
        if weaker or (name.endswith(" 0.1 %") and abs(change) > MOST_MOVE and not lost_contact):
            broken.append(f"{name}: {limit.factor:.6g} to {after.factor:.6g}")
    return broken


def notices_of_sheets(count: int, seed: int) -> tuple[Counter[str], int]:
    """Return on how many sheets of random wedges each notice stands, and how many have none."""
    rng, codes = np.random.default_rng(seed), list[set[str]]()
    while len(codes) < count:
        try:
            found = sk.wedge(**ordinary_cut(rng))
        except sk.GeometryError:
            continue
        if found.fos.limit:
            codes.append({notice.code for notice in found.warnings})
    return Counter(code for sheet in codes for code in sheet), sum(not sheet for sheet in codes)


def main(count: int = 2000, seed: int = 1) -> None:
    """Run the wedges and print what was found."""
    ratios, seconds, broken = [], [], 0
    for number, (inputs, found) in enumerate(cuts(count, seed)):
        for said in broken_rules(inputs, found, stronger(inputs)):
            broken += 1
            print(f"{number}: {said}   {inputs}", flush=True)
        forces = found.analysis.forces_only.factor
        if forces:
            ratios.append((found.analysis.governing.factor or 0.0) / forces)
        if number < 300:
            began = time.process_time()
            sk.wedge(**inputs)
            seconds.append(time.process_time() - began)
    notices, without = notices_of_sheets(SHEETS, seed)
    ratio = np.array(ratios)
    print(f"{count} wedges, {broken} broken rules")
    print(f"the same factor as Hoek & Bray (0.1 %): {np.mean(np.abs(ratio - 1.0) < 1e-3):.1%}")
    print("limit / Hoek & Bray at", {q: round(float(np.quantile(ratio, q)), 4) for q in (0.0, 0.01, 0.05, 0.25, 0.5)})
    print(f"of {SHEETS} sheets without a notice: {without / SHEETS:.1%};", dict(notices.most_common()))
    print(f"CPU of an analysis: median {np.median(seconds) * 1e3:.1f} ms, most {max(seconds) * 1e3:.0f} ms")


if __name__ == "__main__":
    main(*(int(word) for word in sys.argv[1:]))
