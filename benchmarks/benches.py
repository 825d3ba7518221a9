"""Benches of three joint sets from cut to answer, and 200 random ones: `python -m benchmarks.benches [quick]`.

Times are wall clock on whatever machine this is; ratios and exponents are what to compare. Each size runs in a process
of its own, so that its peak memory is its own.
"""

import json
import math
import resource
import subprocess
import sys
import time
from collections import Counter
from itertools import pairwise

import numpy as np

import slopekit as sk
from slopekit.core.errors import SlopekitError

FRICTION = 35.0


def bench(scale: float, cohesion: float = 0.0) -> dict[str, object]:
    """Return the bench of docs/design-files.md with a third set, its spacings scaled."""
    return {
        "slopekit": 1,
        "kind": "bench",
        "slope": {"face": "70/180", "height": 15, "upper": "0/180", "length": 30},
        "sets": {
            "S1": {"plane": "45/170", "spacing": 2 * scale, "strength": "joint"},
            "S2": {"plane": "80/350", "spacing": 3 * scale, "offset": 0.5, "strength": "joint"},
            "S3": {"plane": "85/80", "spacing": 3 * scale, "strength": "joint"},
        },
        "strength": {"joint": {"c": cohesion, "phi": FRICTION}},
        "rock": {"density": 2600},
    }


def one(scale: float, cohesion: float) -> dict[str, float]:
    """One bench: sizes, times, errors."""
    began = time.perf_counter()
    result = sk.run(bench(scale, cohesion))
    total = time.perf_counter() - began
    assert result.findings is not None
    exact = math.tan(math.radians(FRICTION)) / math.tan(math.radians(45.0))
    return {
        "blocks": result.findings.blocks,
        "moving": result.model.moving_blocks,
        "cut": result.timing_s["cut"],
        "solve": result.timing_s["solve"],
        "total": total,
        "fos": result.fos.limit or math.nan,
        "bound": result.fos.static_bound or math.nan,
        "error": (result.fos.limit or math.nan) / exact - 1.0,
        "volume": result.findings.checks["volume_error"],
        "area": result.findings.checks["area_error"],
        "mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
    }


def sizes(scales: tuple[float, ...]) -> None:
    """The table of sizes; the key block of these benches slides at tan 35° / tan 45° when there is no cohesion."""
    print(
        "blocks  moving   cut s  solve s  total s   MB      FoS    bound    error   volume     area"
    )
    found = []
    for scale in scales:
        run = subprocess.run(
            [sys.executable, "-m", "benchmarks.benches", "one", str(scale)],
            capture_output=True,
            text=True,
            check=True,
        )
        row = json.loads(run.stdout)
        found.append(row)
        print(
            f"{row['blocks']:6.0f}  {row['moving']:6.0f}  {row['cut']:6.2f}  {row['solve']:7.2f}  {row['total']:7.2f}"
            f"  {row['mb']:4.0f}  {row['fos']:7.5f}  {row['bound']:7.4f}  {row['error']:7.0e}  {row['volume']:7.0e}"
            f"  {row['area']:7.0e}",
            flush=True,
        )
    for a, b in pairwise(found):
        ratio = math.log(b["blocks"] / a["blocks"])
        cut, whole = (math.log(b[key] / a[key]) / ratio for key in ("cut", "total"))
        print(f"exponent {a['blocks']:.0f} to {b['blocks']:.0f}: cut {cut:.2f}, all {whole:.2f}")


def random_design(seed: int) -> dict[str, object] | None:
    """A random bench of 20 to 200 blocks, or None where the seed gives none: three sets of any orientation."""
    rng = np.random.default_rng(seed)
    face, height = rng.uniform(50, 85), rng.uniform(8, 20)
    planes = [f"{rng.uniform(15, 89):.1f}/{rng.uniform(0, 360):.1f}" for _ in range(3)]
    phi, scatter, wanted = (
        rng.uniform(20, 45),
        float(rng.choice([0.0, 0.0, 3.0])),
        rng.uniform(20, 200),
    )
    cohesion = float(rng.choice([0.0, 0.0, 5.0]))
    spacing = height * 3.0 / wanted ** (1.0 / 3.0)
    for _ in range(10):
        design = {
            "slopekit": 1,
            "kind": "bench",
            "slope": {
                "face": f"{face:.1f}/180",
                "height": height,
                "length": 2 * height,
                "depth": height,
            },
            "sets": {
                f"S{k}": {
                    "plane": plane,
                    "spacing": spacing,
                    "offset": 0.3,
                    "scatter": scatter,
                    "strength": "j",
                }
                for k, plane in enumerate(planes, 1)
            },
            "strength": {"j": {"c": cohesion, "phi": phi}},
            "rock": {"unit_weight": 26},
            "cut": {"seed": seed},
        }
        from slopekit.kinds import cut

        try:
            blocks = len(cut(sk.load(design)).assembly)
        except SlopekitError:
            spacing *= 0.8
            continue
        if 20 <= blocks <= 200:
            return design
        spacing *= (blocks / wanted) ** (1.0 / 3.0)
    return None


def at_random(count: int) -> None:
    """Random benches: outcomes, the worst gap between limit and bound, the distribution of times."""
    statuses: Counter[str] = Counter()
    times: list[float] = []
    gaps: list[float] = []
    above = unsettled = seed = 0
    while len(times) < count:
        design = random_design(seed)
        seed += 1
        if design is None:
            continue
        began = time.perf_counter()
        result = sk.run(design)
        times.append(time.perf_counter() - began)
        statuses[result.status] += 1
        assert result.findings is not None
        if result.status == "not_converged":
            print("not_converged: seed", seed - 1)
        if result.findings.first and result.findings.first.change > 1e-3:
            unsettled += 1
        limit, bound = result.fos.limit, result.fos.static_bound
        if limit and bound:
            gaps.append(bound / limit - 1.0)
            above += limit > bound * (1.0 + 1e-9)
    seconds = np.array(times)
    print(f"{count} benches (seeds 0 to {seed - 1}): {dict(statuses)}")
    print(
        f"limit above bound: {above}; bound found for {len(gaps)}; {unsettled} whose last passes differ by over 0.1 %"
    )
    print(f"gap between limit and bound: median {np.median(gaps):.3f}, worst {max(gaps):.3f}")
    print(
        "seconds: median {:.2f}, 90 % {:.2f}, worst {:.2f}".format(
            *np.quantile(seconds, [0.5, 0.9, 1.0])
        )
    )


if __name__ == "__main__":
    if len(sys.argv) > 2 and sys.argv[1] == "one":
        print(json.dumps(one(float(sys.argv[2]), 0.0)))
    else:
        quick = "quick" in sys.argv
        sizes((1.9, 0.85) if quick else (1.9, 0.85, 0.36))
        at_random(20 if quick else 200)
