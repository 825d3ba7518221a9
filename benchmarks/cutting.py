"""Cutting a bench into about 100, 1,000 and 10,000 blocks. By hand: ``python -m benchmarks.cutting``.

Each case in a process of its own: microseconds per block of the median of five runs, peak memory, errors.
"""

import math
import resource
import statistics
import subprocess
import sys
import time
from collections import defaultdict
from collections.abc import Callable

import numpy as np

from slopekit.geometry.rock import splitting
from slopekit.geometry.rock.bench import bench_body
from slopekit.geometry.rock.joint_sets import JointSet, planes_of_sets

STAGES = {
    "cut_with_combs": "manifold3d",
    "cells_of": "cells",
    "faces_of": "faces",
    "opposite_faces": "match",
    "_patches": "patches",
}


def normal(dip_deg: float, dip_direction_deg: float) -> np.ndarray:
    """The upward normal of a plane."""
    dip, direction = math.radians(dip_deg), math.radians(dip_direction_deg)
    return np.array(
        [math.sin(dip) * math.sin(direction), math.sin(dip) * math.cos(direction), math.cos(dip)]
    )


def case(spacing: float, scatter_deg: float) -> None:
    """One bench 20 m high and 40 m long, three sets; prints one line."""
    spent: dict[str, list[float]] = defaultdict(list)

    def timed(name: str) -> Callable[..., object]:
        stage = getattr(splitting, name)

        def run(*args: object) -> object:
            start = time.perf_counter()
            result = stage(*args)
            spent[name].append(time.perf_counter() - start)
            return result

        return run

    for name in STAGES:
        setattr(splitting, name, timed(name))
    body = bench_body(normal(70.0, 180.0), normal(5.0, 180.0), 20.0, 40.0, 25.0)
    dips = ((40.0, 175.0), (75.0, 95.0), (70.0, 350.0))
    sets = [
        JointSet(normal(*dip), spacing, share * spacing, scatter_deg)
        for dip, share in zip(dips, (0.3, 0.2, 0.1), strict=True)
    ]
    for _ in range(6):  # the first one imports
        start = time.perf_counter()
        planes = planes_of_sets(sets, body, np.random.default_rng(1))
        spent["planes"].append(time.perf_counter() - start)
        cut = splitting.cut_bench(body, planes, max_blocks=100_000)
        spent["all"].append(time.perf_counter() - start)
    us = {name: statistics.median(times[1:]) * 1e6 / cut.blocks for name, times in spent.items()}
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    stages = "".join(f"{us[name]:10.1f}" for name in (*STAGES, "all"))
    print(
        f"{scatter_deg:6.0f}{cut.blocks:8d}{cut.fixed:7d}{len(cut.assembly.patches):9d}{stages}{memory:8.0f}"
        f"{cut.volume_error:9.0e}{cut.area_error:9.0e}{cut.slivers_joined:6d}"
    )


def main() -> None:
    """All cases."""
    print("µs per block".rjust(48))
    print(
        "scatter  blocks  fixed  patches"
        + "".join(f"{name:>10s}" for name in (*STAGES.values(), "all"))
        + "      MB   volume    areas joined"
    )
    for spacing in (8.0, 3.2, 1.4, 0.83):
        for scatter_deg in (0.0, 3.0):
            command = [sys.executable, "-m", "benchmarks.cutting", str(spacing), str(scatter_deg)]
            subprocess.run(command, check=True)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        case(float(sys.argv[1]), float(sys.argv[2]))
    else:
        main()
