"""One block whose joints moments open: the limit on its elastic bed against thousands of separate springs.

    python -m benchmarks.moments [COUNT] [SEED]

Random wedges (`tests.support.random_wedge`) are drawn until moments open part of a cohesive joint of COUNT of them;
those with passive bolts are left out, which the springs do not know. For each the factor by springs
(`tests.preie.cracked_oracle`) is a bracket; the deviation of the bed from it is 0 inside. Prints a line a wedge and, at
the end, the shares within 0.2, 1, 2 and 5 %, and the times.
"""

import sys
import time

import numpy as np

from slopekit.core.onlooker import Clock
from slopekit.geometry.rock.rockmass import J1, J2
from slopekit.kinds import cut
from slopekit.kinds.single_block.one_block_limit import find_limit
from slopekit.kinds.wedge.design import wedge_design
from tests.preie.cracked_oracle import Block, springs_on
from tests.support import random_wedge

_SPRINGS = 1500  # on each joint
_WITHIN = 2e-3  # width of the oracle's bracket
_AGAIN = 0.02  # a deviation beyond which the springs are started again ...
_STARTS = (0.5, 2.0)  # ... from these times the strength


def bed_factor(found):
    """Return the limit on the bed, None where it rests at no strength."""
    factor = float(found.factors.state.factor[0])
    return None if np.isnan(factor) else factor


def compare(kwargs, made, found):
    """Return the oracle's bracket of one wedge, None where it finds no rest, and how far the bed lies off it."""
    block, loads = made.block, made.loads
    springs = springs_on(
        [block.faces[J1], block.faces[J2]], kwargs["c"], np.tan(np.radians(kwargs["phi"])), block.centroid, _SPRINGS
    )
    bed = Block(springs, loads.force, loads.moment)
    factor = bed_factor(found)
    guess = factor or found.factors.forces.factor or 1.0
    bracket = bed.factor(guess, _WITHIN)
    if factor is None:
        return bracket, None
    if bracket is None or abs(_beside(factor, bracket)) > _AGAIN:
        # springs that nearly float rest in one way or another: the best of other strengths to start from
        tries = [again for start in _STARTS if (again := bed.factor(guess * start, _WITHIN)) is not None]
        bracket = max([*tries, *([] if bracket is None else [bracket])], default=None)
    return bracket, None if bracket is None else _beside(factor, bracket)


def _beside(value, bracket):
    """Return how far a value lies outside of a bracket, in parts of its near end."""
    low, high = bracket
    return min(value / low - 1.0, 0.0) + max(value / high - 1.0, 0.0)


def opens_cohesive(kwargs, found) -> bool:
    """Whether the bed has no rest, or opens part of a cohesive joint at its limit."""
    if found.factors.state is None:
        return False
    shares = [opening["pressed_share"] for opening in found.openings.values()]
    return not shares or any(share < 1.0 and c > 0.0 for share, c in zip(shares, kwargs["c"], strict=True))


def main(count: int = 400, seed: int = 11) -> None:
    """Run the comparison and print it."""
    rng = np.random.default_rng(seed)
    deviations, times, drawn, no_limit, no_rest = [], [], 0, 0, 0
    while len(deviations) + no_limit + no_rest < count:
        kwargs = random_wedge(rng)
        drawn += 1
        if any(bolt["acts"] == "passive" for bolt in kwargs.get("bolts", [])):
            continue
        made = cut(wedge_design(kwargs))
        began = time.process_time()
        found = find_limit(made, Clock())
        times.append(time.process_time() - began)
        if found.factors is None or not opens_cohesive(kwargs, found):
            continue
        bracket, deviation = compare(kwargs, made, found)
        shown = "none" if bracket is None else f"{bracket[0]:.5g} .. {bracket[1]:.5g}"
        off = "" if deviation is None else f"{deviation * 100:+.3f} %"
        factor = bed_factor(found)
        print(f"{drawn:5d}  bed {factor}  springs {shown}  {off}", flush=True)
        if factor is None:
            no_limit += 1
        elif bracket is None:
            no_rest += 1
        else:
            deviations.append(abs(deviation))
    off = np.array(deviations)
    print(
        f"{drawn} wedges drawn; of {count} that moments open {no_limit} rest at no strength on the bed, for {no_rest}"
    )
    print(f"only the springs found no rest; of the other {len(off)}")
    for part in (0.002, 0.01, 0.02, 0.05):
        print(f"  {int((off <= part).sum())} within {part * 100:g} % of the springs' bracket")
    print(f"  median {np.median(off) * 100:.3g} %, worst {off.max() * 100:.3g} %")
    print(f"CPU time of a limit: median {np.median(times):.3g} s, 95 % {np.percentile(times, 95):.3g} s")


if __name__ == "__main__":
    main(*(int(word) for word in sys.argv[1:]))
