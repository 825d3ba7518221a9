"""The elastic limit of random wedges against the rigid one without the cohesion that is pulled open (METHOD-2 §10).

python -m benchmarks.elastic_oracle [HOW_MANY [SEED]]: a line a wedge, and how far apart the two are at most. Wedges are
wet, cracked, bolted; rock of 1 to 20 GPa; elements of a quarter of the longest edge.
"""

import sys
import time

import numpy as np

import slopekit as sk
from slopekit.core.errors import SlopekitError


def random_wedge(rng: np.random.Generator) -> dict[str, object]:
    """The inputs of one wedge, whether it can be formed or not."""
    height = float(rng.uniform(15.0, 60.0))
    given: dict[str, object] = {
        "dips": (f"{rng.uniform(35, 70):.1f}/{rng.uniform(95, 150):.1f}",
                 f"{rng.uniform(35, 70):.1f}/{rng.uniform(210, 265):.1f}"),
        "face": f"{rng.uniform(60, 80):.1f}/180", "upper": f"{rng.uniform(0, 12):.1f}/180", "height": height,
        "c": tuple(rng.uniform(10, 80, 2).round(1).tolist()), "phi": tuple(rng.uniform(20, 40, 2).round(1).tolist()),
        "unit_weight": 26, "shear_stiffness": 1e5, "modulus": f"{rng.uniform(1, 20):.1f} GPa",
    }  # fmt: skip
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
            found = sk.wedge(**given, edge=float(np.sqrt(sides @ sides)) / 3.0, elastic_bracket=True).elastic
        except SlopekitError:
            left_out += 1
            continue
        if found is None or found.bracket is None or found.limit_at_bracket is None:
            print("no state at rest:", given)
            off.append(float("nan"))
            continue
        low, high = found.bracket
        last = found.limit_at_bracket
        off.append(max(low / last - 1.0, last / high - 1.0, 0.0, key=abs))
        with_ = [key for key in ("water", "crack", "bolts") if key in given]
        print(f"{found.opened_share:7.2%} {found.rigid_limit:9.5f} {found.limit:9.5f} {last:9.5f}   "
              f"{low:.5f} .. {high:.5f}  {off[-1]:8.1e}  {', '.join(with_)}"
              f"{', gave up' * found.gave_up}", flush=True)  # fmt: skip
    near = np.abs(off)
    print(f"{wanted} wedges, seed {seed}, {left_out} without one or beyond 1 < F < 5: within 3e-4 "
          f"{int((near <= 3e-4).sum())}, most {np.nanmax(near):.1e}, {int(np.isnan(near).sum())} without a state; "
          f"{time.process_time() - began:.0f} s")  # fmt: skip


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]))
