"""The compiled kernels beside NumPy, in turns on the same designs, by ``python -m benchmarks.kernels [quick]``.

CPU seconds of whole analyses, cutting and bounds included; `step`: one Newton step of the largest bed of the last
design, its forces, tangent, factorisation and solution. `quick` leaves out the benches of hundreds of blocks. With one
thread: OPENBLAS_NUM_THREADS=1.
"""

import os
import sys
import time
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

import slopekit as sk
from benchmarks import populations
from benchmarks.benches import bench
from benchmarks.populations import Design
from slopekit.core.errors import SlopekitError
from slopekit.preie import kernels
from slopekit.preie.elastic_path.contact_model import ElasticContactModel

_WAYS = ("numpy", "compiled")
_STEPS = 20
_CASES: dict[str, Callable[[], Iterable[Design]]] = {
    "60 sections": lambda: (populations.section(k) for k in range(60)),
    "20 walls": lambda: (populations.wall(k) for k in range(20)),
    "Goodman & Bray": lambda: [populations.goodman_bray()],
    "8 benches": lambda: (populations.bench(k) for k in range(8)),
    "bench, 149 blocks": lambda: [bench(1.9, 0.0)],
    "the same, 5 kPa": lambda: [bench(1.9, 5.0)],
    "bench, 628 blocks": lambda: [bench(1.0, 0.0)],
}
_LARGE = ("the same, 5 kPa", "bench, 628 blocks")


def analysed(design: Design, beds: list[Any]) -> tuple[float, float | None]:
    """CPU seconds and the factor; what the beds are made of is added to `beds`."""
    first = ElasticContactModel.__init__

    def noted(bed: ElasticContactModel, *given: Any, **named: Any) -> None:
        beds.append((given, named))
        first(bed, *given, **named)

    ElasticContactModel.__init__ = noted  # type: ignore[method-assign]
    began = time.process_time()
    try:
        factor = sk.run(design).fos.limit
    except SlopekitError:
        factor = None
    finally:
        ElasticContactModel.__init__ = first  # type: ignore[method-assign]
    return time.process_time() - began, factor


def step(given: tuple[Any, ...], named: dict[str, Any]) -> float:
    """CPU seconds of one Newton step, the median."""
    bed = ElasticContactModel(*given, **named)
    at, taken = bed.elastic_displacement, []
    for _ in range(_STEPS):
        began = time.process_time()
        there = bed.forces(at, 1.0)
        bed.factored(bed.tangent(there, 1.0, 1e-2))(there.unbalanced)
        taken.append(time.process_time() - began)
    return float(np.median(taken))


def row(name: str, designs: Iterable[Design]) -> str:
    """Both ways on some designs, each design in turns."""
    seconds, steps, apart, beds = (
        dict.fromkeys(_WAYS, 0.0),
        dict.fromkeys(_WAYS, 0.0),
        0.0,
        list[Any](),
    )
    for number, design in enumerate(designs):
        found: dict[str, float | None] = {}
        for way in _WAYS if number % 2 else reversed(_WAYS):
            os.environ["SLOPEKIT_KERNELS"] = way
            beds.clear()
            took, found[way] = analysed(design, beds)
            seconds[way] += took
        one, other = (found[way] for way in _WAYS)
        if (one is None) != (other is None):
            apart = np.inf
        elif one is not None and other is not None:
            apart = max(apart, abs(other / one - 1.0))
    largest = max(beds, key=lambda bed: bed[0][0].load.size)
    for way in _WAYS:
        os.environ["SLOPEKIT_KERNELS"] = way
        steps[way] = 1e3 * step(*largest)
    return (
        f"{name:20s}{seconds['numpy']:9.2f}{seconds['compiled']:9.2f}{seconds['numpy'] / seconds['compiled']:7.2f}"
        f"{len(largest[0][0].load):9d}{steps['numpy']:9.3f}{steps['compiled']:9.3f}"
        f"{steps['numpy'] / steps['compiled']:7.2f}{apart:10.0e}"
    )


def main(quick: bool) -> None:
    """All rows."""
    os.environ.pop("SLOPEKIT_KERNELS", None)
    found, missing = kernels.chosen()
    if found is None:
        print(f"nothing to compare: {missing}")
        return
    sk.run(populations.section(0))  # imports
    print(
        f"{'designs':20s}{'NumPy s':>9s}{'comp. s':>9s}{'times':>7s}{'moving':>9s}{'step ms':>9s}{'comp. ms':>9s}"
        f"{'times':>7s}{'F apart':>10s}"
    )
    for name, make in _CASES.items():
        if not (quick and name in _LARGE):
            print(row(name, make()), flush=True)


if __name__ == "__main__":
    main("quick" in sys.argv[1:])
