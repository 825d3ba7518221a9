"""One block whose joints moments open: the limit on its elastic bed against thousands of separate springs.

    python -m benchmarks.moments [COUNT] [SEED]
    python -m benchmarks.moments lower [COUNT] [SEED]

Random wedges (`tests.support.random_wedge`) are drawn until moments open part of a cohesive joint of COUNT of them;
those with passive bolts are left out, which the springs do not know. For each the factor by springs
(`tests.preie.cracked_oracle`) is a bracket; the deviation of the bed from it is 0 inside. Prints a line a wedge and, at
the end, the shares within 0.2, 1, 2 and 5 %, and the times.

`lower`: any random wedge, its limit against the lower of Hoek & Bray's factor (`tests.closed_form.scalar_wedge`) and
the springs' bracket; polygons and loads of the springs are those of the wedge.
"""

import sys
import time

import numpy as np

import slopekit as sk
from slopekit.core.orientation import Line, Plane
from slopekit.core.progress import Clock
from slopekit.kinds import cut
from slopekit.kinds.single_block.one_block_limit import find_limit
from slopekit.kinds.wedge.cutting import J1, J2
from slopekit.kinds.wedge.design import wedge_design
from tests.closed_form.scalar_wedge import WedgeWater, hoek_bray_wedge
from tests.preie.cracked_oracle import Block, springs_on
from tests.support import random_wedge

_SPRINGS = 1500  # on each joint
_WITHIN = 2e-3  # width of the oracle's bracket
_AGAIN = 0.02  # a deviation beyond which the springs are started again ...
_STARTS = (0.5, 2.0)  # ... from these times the strength
_SHARES = (0.002, 0.01, 0.02, 0.05)


def bed_factor(found):
    """Return the limit on the bed, None where it rests at no strength."""
    factor = float(found.factors.state.factor[0])
    return None if np.isnan(factor) else factor


def springs_of(kwargs, made, count=_SPRINGS):
    """Return a wedge on that many separate springs on each joint."""
    block, faces = made.block, [made.block.faces[joint] for joint in (J1, J2)]
    springs = springs_on(
        faces, kwargs["c"], np.tan(np.radians(kwargs["phi"])), block.centroid, count
    )
    return Block(springs, made.loads.force, made.loads.moment)


def compare(kwargs, made, found):
    """Return the oracle's bracket of one wedge, None where it finds no rest, and how far the bed lies off it."""
    bed, factor = springs_of(kwargs, made), bed_factor(found)
    guess = factor or found.factors.forces.factor or 1.0
    bracket = best_bracket(
        bed, guess, lambda known: factor is None or abs(beside(factor, known)) <= _AGAIN
    )
    return bracket, None if bracket is None or factor is None else beside(factor, bracket)


def best_bracket(bed, guess, agrees):
    """Return the bracket of springs; where it does not agree the best of other strengths to start from.

    Springs that nearly float rest in one way or another.
    """
    bracket = bed.factor(guess, _WITHIN)
    if bracket is not None and agrees(bracket):
        return bracket
    tries = [bracket, *(bed.factor(guess * start, _WITHIN) for start in _STARTS)]
    return max((each for each in tries if each is not None), default=None)


def lower_of_both(kwargs, count=_SPRINGS):
    """Return the limit of a wedge and (low, high) of the lower of Hoek & Bray's factor and that of springs.

    None in place of the bracket where either has no number.
    """
    limit = sk.wedge(**kwargs).fos.limit
    (joint1, joint2), (face, upper) = (
        [Plane(*plane) for plane in planes]
        for planes in (kwargs["dips"], (kwargs["face"], kwargs["upper"]))
    )
    forces = [bolt["force"] * Line(*bolt["toward"]).vector() for bolt in kwargs.get("bolts", [])]
    closed = hoek_bray_wedge(
        (joint1, joint2),
        face,
        upper,
        kwargs["height"],
        kwargs["c"],
        kwargs["phi"],
        kwargs["unit_weight"],
        water=WedgeWater(pressures=tuple(kwargs.get("water", ()))),
        seismic=(kwargs.get("seismic", 0.0), None),
        forces=forces,
    )
    if closed.factor is None or limit is None:
        return limit, None
    bed = springs_of(kwargs, cut(wedge_design(kwargs)), count)

    def within(bracket):
        return abs(beside(limit, tuple(min(end, closed.factor) for end in bracket))) <= _AGAIN

    bracket = best_bracket(bed, closed.factor, within)
    return limit, None if bracket is None else tuple(min(end, closed.factor) for end in bracket)


def has_passive_bolts(kwargs) -> bool:
    """Whether a wedge has what the springs do not know."""
    return any(bolt["acts"] == "passive" for bolt in kwargs.get("bolts", []))


def any_wedge(count: int = 500, seed: int = 12) -> None:
    """Compare the limits of that many random wedges with the lower of both."""
    rng, off, without = np.random.default_rng(seed), list[float](), list[int]()
    for number in range(count):
        while has_passive_bolts(kwargs := random_wedge(rng)):
            continue
        limit, bracket = lower_of_both(kwargs)
        if bracket is None:
            without.append(number)
            print(f"{number:5d}  limit {limit}  no number to compare with", flush=True)
            continue
        off.append(beside(limit, bracket))
        if abs(off[-1]) > 0.01:
            print(
                f"{number:5d}  limit {limit:.5g}  {bracket[0]:.5g} .. {bracket[1]:.5g}  {off[-1]:+.2%}",
                flush=True,
            )
    print(
        f"{count} wedges, {len(without)} without a number to compare with; of the other {len(off)}"
    )
    for part in _SHARES:
        print(f"  {int((np.abs(off) <= part).sum())} within {part:g} of the lower of both")


def beside(value, bracket):
    """Return how far a value lies outside of a bracket, in parts of its near end."""
    low, high = bracket
    return min(value / low - 1.0, 0.0) + max(value / high - 1.0, 0.0)


def opens_cohesive(kwargs, found) -> bool:
    """Whether the bed has no rest, or opens part of a cohesive joint at its limit."""
    if found.factors.state is None:
        return False
    shares = [opening["pressed_share"] for opening in found.openings.values()]
    return not shares or any(
        share < 1.0 and c > 0.0 for share, c in zip(shares, kwargs["c"], strict=True)
    )


def main(count: int = 400, seed: int = 11) -> None:
    """Run the comparison and print it."""
    rng = np.random.default_rng(seed)
    deviations, times, drawn, no_limit, no_rest = [], [], 0, 0, 0
    while len(deviations) + no_limit + no_rest < count:
        kwargs = random_wedge(rng)
        drawn += 1
        if has_passive_bolts(kwargs):
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
    for part in _SHARES:
        print(f"  {int((off <= part).sum())} within {part * 100:g} % of the springs' bracket")
    print(f"  median {np.median(off) * 100:.3g} %, worst {off.max() * 100:.3g} %")
    print(
        f"CPU time of a limit: median {np.median(times):.3g} s, 95 % {np.percentile(times, 95):.3g} s"
    )


if __name__ == "__main__":
    words = sys.argv[1:]
    run = any_wedge if words[:1] == ["lower"] else main
    run(*(int(word) for word in words if word != "lower"))
