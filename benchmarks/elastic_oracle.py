"""The elastic limit of random wedges against the rigid one without the cohesion that is pulled open.

python -m benchmarks.elastic_oracle [HOW_MANY [SEED]]: a line a wedge, and how far apart the two are at most. Wedges are
wet, cracked, bolted; rock of 1 to 20 GPa; elements of a quarter of the longest edge.
"""

import math
import sys
import time

import numpy as np

import slopekit as sk
from slopekit.core.errors import SlopekitError
from slopekit.elastic.rest import Rest, RestSearch
from slopekit.kinds import kind_of
from slopekit.kinds.elastic import ElasticScene, scene_of_one
from slopekit.result import Result

MOST_STEPS = 3000  # of Newton's method, to both ends of a bracket


def state_of(result: Result, factor: float = 1.0) -> tuple[ElasticScene, RestSearch, Rest]:
    """Return the elastic block of a result at rest at a strength reduction factor."""
    scene = scene_of_one(result.design, kind_of(result.design).cut(result.design))
    search = RestSearch(scene.model, scene.stiffness)
    return scene, search, search.rest(factor)


def last_rest(
    search: RestSearch, rest: Rest, guess: float, within: float = 1e-4
) -> tuple[Rest, float]:
    """Return the last state of one block at rest, and a factor no farther on than `within` where none is found.

    A factor at which there is no rest from far away is tried again from nearer. Where `search.spent` the steps ran out
    and the factor was not decided.
    """
    search.max_steps = search.steps + MOST_STEPS
    low, high, target = (
        rest,
        math.inf,
        max(guess * (1.0 - 5.0 * within), rest.factor * (1.0 + within)),
    )
    while True:
        before, trial = low.factor, search.equilibrium(low, target)
        if trial.is_balanced:
            low = trial
        elif search.spent or target <= before * (1.0 + within):
            return low, target
        else:
            high = target
        if low.factor >= high:  # it was tried from too far away
            high = math.inf
        if not math.isfinite(high):
            far = 1e-3 if low.factor < guess * 1.01 else 0.05
            target = max(guess * (1.0 + 5.0 * within), low.factor * (1.0 + far))
        elif high > low.factor * (1.0 + within):
            target = math.sqrt(low.factor * high)
        else:
            target = high


def random_wedge(rng: np.random.Generator) -> dict[str, object]:
    """The inputs of one wedge, whether it can be formed or not."""
    height = float(rng.uniform(15.0, 60.0))
    given: dict[str, object] = {
        "dips": (
            f"{rng.uniform(35, 70):.1f}/{rng.uniform(95, 150):.1f}",
            f"{rng.uniform(35, 70):.1f}/{rng.uniform(210, 265):.1f}",
        ),
        "face": f"{rng.uniform(60, 80):.1f}/180",
        "upper": f"{rng.uniform(0, 12):.1f}/180",
        "height": height,
        "c": tuple(rng.uniform(10, 80, 2).round(1).tolist()),
        "phi": tuple(rng.uniform(20, 40, 2).round(1).tolist()),
        "unit_weight": 26,
        "shear_stiffness": 1e5,
        "modulus": f"{rng.uniform(1, 20):.1f} GPa",
    }
    if rng.random() < 0.4:
        given["water"] = f"{rng.uniform(10, 60):.0f}%"
    if rng.random() < 0.4:
        given["crack"] = f"85/180@{0.2 * height:.2f}"
    if rng.random() < 0.4:
        acts = "passive" if rng.random() < 0.5 else "active"
        given["bolts"] = [f"{rng.uniform(0.3, 2.0) * height**2:.0f}@0/-10,{acts}"]
    return given


def main(wanted: int = 50, seed: int = 1) -> None:
    """Print a line a wedge, then the largest difference."""
    rng, off, began, left_out = np.random.default_rng(seed), list[float](), time.process_time(), 0
    print(" opened     rigid     limit  last one   bracket                 off  with")
    while len(off) < wanted:
        given = random_wedge(rng)
        try:
            plain = sk.wedge(**{**given, "edge": None})
            if plain.fos.limit is None or not 1.0 < plain.fos.limit < 5.0 or plain.moments_govern:
                left_out += 1
                continue
            sides = np.ptp(np.array([*plain.to_dict()["geometry"]["corners_m"].values()]), axis=0)
            found = sk.wedge(**given, edge=float(np.sqrt(sides @ sides)) / 3.0, elastic=True)
        except SlopekitError:
            left_out += 1
            continue
        blocks = found.elastic
        if blocks is None or blocks.limit is None or blocks.rigid_limit is None:
            print("no state at rest:", given)
            off.append(float("nan"))
            continue
        scene, search, rest = state_of(found, blocks.factor)
        end, high = last_rest(search, rest, blocks.limit)
        low, last = end.factor, scene.limit_without(end.opened(scene.model))[0]
        if last is None:
            print("no limit without what is open:", given)
            off.append(float("nan"))
            continue
        off.append(max(low / last - 1.0, last / high - 1.0, 0.0, key=abs))
        with_ = [key for key in ("water", "crack", "bolts") if key in given]
        print(
            f"{blocks.opened_share:7.2%} {blocks.rigid_limit:9.5f} {blocks.limit:9.5f} {last:9.5f}   "
            f"{low:.5f} .. {high:.5f}  {off[-1]:8.1e}  {', '.join(with_)}"
            f"{', gave up' * search.spent}",
            flush=True,
        )
    near = np.abs(off)
    print(
        f"{wanted} wedges, seed {seed}, {left_out} without one or beyond 1 < F < 5: within 3e-4 "
        f"{int((near <= 3e-4).sum())}, most {np.nanmax(near):.1e}, {int(np.isnan(near).sum())} without a state; "
        f"{time.process_time() - began:.0f} s"
    )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]))
