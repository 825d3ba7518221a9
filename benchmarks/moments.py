"""One block whose contacts moments open: the cracked base against thousands of separate springs, and its figures.

    python -m benchmarks.moments [COUNT] [SEED]

Random wedges (`tests.support.random_wedge`) are drawn until COUNT of them are governed by moments that open part of a
cohesive joint; those with passive bolts are left out, which the springs do not know. For each the factor by springs
(`tests.preie.cracked_oracle`) is a bracket; the deviation of the cracked base from it is 0 inside. Prints a line a
wedge and, at the end, the shares within 0.2, 0.5 and 2 %, the spread of the three rules and the times.
"""

import sys
import time

import numpy as np

import slopekit as sk
from slopekit.geometry.rock.rockmass import J1, J2
from slopekit.kinds.wedge.cutting import cut
from tests.preie.cracked_oracle import Block, springs_on
from tests.support import random_wedge

_SPRINGS = 1500  # on each joint
_WITHIN = 2e-3  # width of the oracle's bracket
_AGAIN = 0.02  # a deviation beyond which the springs are started again ...
_STARTS = (0.5, 2.0)  # ... from these times the strength


def compare(kwargs, result):
    """The oracle's bracket of one wedge, None where it finds no rest, and the deviation of the cracked base from it."""
    made = cut(result.design)
    block, loads = made.block, made.loads
    springs = springs_on(
        [block.faces[J1], block.faces[J2]], kwargs["c"], np.tan(np.radians(kwargs["phi"])), block.centroid, _SPRINGS
    )
    bed = Block(springs, loads.force, loads.moment)
    cracked = result.cohesion_under_moments.cracked_base
    guess = cracked or result.forces_only or 1.0
    bracket = bed.factor(guess, _WITHIN)
    if cracked is None:
        return bracket, None
    if bracket is None or abs(_beside(cracked, bracket)) > _AGAIN:
        # springs that nearly float rest in one way or another: the best of other strengths to start from
        tries = [found for start in _STARTS if (found := bed.factor(guess * start, _WITHIN)) is not None]
        bracket = max([*tries, *([] if bracket is None else [bracket])], default=None)
    return bracket, None if bracket is None else _beside(cracked, bracket)


def _beside(value, bracket):
    """How far a value lies outside of a bracket, in parts of its near end."""
    low, high = bracket
    return min(value / low - 1.0, 0.0) + max(value / high - 1.0, 0.0)


def main(count: int = 400, seed: int = 11) -> None:
    """Run the comparison and print it."""
    rng = np.random.default_rng(seed)
    deviations, spreads, times, drawn, no_limit, no_rest = [], [], [], 0, 0, 0
    while len(deviations) + no_limit + no_rest < count:
        kwargs = random_wedge(rng)
        drawn += 1
        if any(bolt["acts"] == "passive" for bolt in kwargs.get("bolts", [])):
            continue
        began = time.perf_counter()
        result = sk.wedge(**kwargs)
        took = time.perf_counter() - began
        rules = result.cohesion_under_moments
        if rules is None:
            continue
        bracket, deviation = compare(kwargs, result)
        shown = "none" if bracket is None else f"{bracket[0]:.5g} .. {bracket[1]:.5g}"
        print(
            f"{drawn:5d}  {rules.rule:13s} cracked {rules.cracked_base}  springs {shown}  "
            f"{'' if deviation is None else f'{deviation * 100:+.3f} %'}  bond gone {rules.bond_gone}",
            flush=True,
        )
        times.append(took)
        if rules.cracked_base is None:
            no_limit += 1
        elif bracket is None:
            no_rest += 1
        else:
            deviations.append(abs(deviation))
        spreads.append(rules.highest / rules.lowest)
    found = np.array(deviations)
    print(f"{drawn} wedges drawn, {len(times)} of them opened by moments: {no_limit} without a limit on the cracked")
    print(f"base, {no_rest} where only the springs found no rest; of the other {len(found)}")
    for part in (0.002, 0.005, 0.02):
        print(f"  {int((found <= part).sum())} within {part * 100:g} % of the springs' bracket")
    print(f"  median {np.median(found) * 100:.3g} %, worst {found.max() * 100:.3g} %")
    print(f"highest / lowest rule: median {np.median(spreads):.3g}, 90 % {np.percentile(spreads, 90):.3g}")
    print(f"time of an analysis: median {np.median(times):.3g} s, 95 % {np.percentile(times, 95):.3g} s")


if __name__ == "__main__":
    main(*(int(word) for word in sys.argv[1:]))
