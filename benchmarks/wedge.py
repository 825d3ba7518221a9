"""Times and errors of one wedge: speed by stage, cold start, random wedges, the paper's search.

Run by hand: ``python -m benchmarks.wedge`` (about two minutes). Every time is a median; every ratio is of one run.
Speed against error: ``python -m benchmarks wedge``.
"""

import json
import statistics
import time
from collections import Counter
from collections.abc import Callable

import numpy as np

import slopekit as sk
from benchmarks.golden_budget import cold as seconds_cold
from benchmarks.golden_budget import packages_of
from slopekit.kinds import cut
from slopekit.kinds.wedge import closed_form
from slopekit.kinds.wedge.design import wedge_design
from slopekit.preie.one_block.flat_limit import flat_limit
from slopekit.preie.programs.bound import static_bound
from tests.support import random_wedge

PAPER = {"dips": ("45/115", "45/245")}


def median_ms(work: Callable[[], object], repeat: int = 101) -> float:
    """Median wall time of `work` in milliseconds, after one call to warm up."""
    work()
    times = []
    for _ in range(repeat):
        began = time.perf_counter()
        work()
        times.append(time.perf_counter() - began)
    return statistics.median(times) * 1e3


def stages() -> None:
    print("\n## One wedge in process (median ms)")
    design = wedge_design(PAPER)
    scene = cut(design).scene_at(0)
    assert scene.bedding is not None
    flat = scene.model, scene.bedding.polygons, scene.bedding.centroid
    limit = flat_limit(*flat).forces
    rows = {
        "closed form": lambda: closed_form(design),
        "read, cut, load, mesh: design to model": lambda: cut(wedge_design(PAPER)).scene_at(0),
        "model to limit": lambda: flat_limit(*flat),
        "static bound": lambda: static_bound(scene.model, limit.velocity, limit.factor),
        "orientation to checked result (all of it)": lambda: sk.wedge(**PAPER),
    }
    times = {name: median_ms(work) for name, work in rows.items()}
    for name, ms in times.items():
        print(f"{name:45s} {ms:8.3f} ms   {ms / times['closed form']:7.1f} x closed form")
    timing = [sk.wedge(**PAPER).timing_s for _ in range(51)]
    shown = {key: statistics.median(t[key] for t in timing) * 1e3 for key in timing[0]}
    print("by stage: " + "  ".join(f"{key} {ms:.2f}" for key, ms in shown.items()))


def cold() -> None:
    print("\n## Cold command against the bare imports of what it loads")
    packages = packages_of("wedge")
    ours, theirs, ratio = seconds_cold("wedge", packages)
    print(
        f"slopekit wedge {ours * 1e3:.0f} ms, import {', '.join(packages)} {theirs * 1e3:.0f} ms, ratio {ratio:.2f}"
    )


def random_wedges(count: int = 2000, seed: int = 2000) -> None:
    print(f"\n## {count} random wedges (seed {seed})")
    rng = np.random.default_rng(seed)
    outcomes, statuses, worst, worst_alone, above, over_bound, times = (
        Counter(),
        Counter(),
        0.0,
        0.0,
        0,
        0,
        [],
    )
    for _ in range(count):
        wedge = random_wedge(rng)
        began = time.perf_counter()
        result = sk.wedge(**wedge)
        times.append(time.perf_counter() - began)
        limit, closed = result.fos.limit, result.fos.closed_form
        statuses[result.status] += 1
        if result.status == "not_converged":
            outcomes["not converged"] += 1
        elif result.moments_govern:
            topples = "moments govern: no number (topples)"
            outcomes[topples if limit is None else "moments govern: below the closed form"] += 1
            above += limit is not None and limit >= closed
            worst_alone = max(worst_alone, abs(result.comparisons.forces_only / closed - 1.0))
        elif closed is None:
            outcomes["no number from either"] += 1
        else:
            outcomes["limit equals the closed form"] += 1
            worst = max(worst, abs(limit / closed - 1.0))
        bound = result.fos.static_bound
        over_bound += bound is not None and limit > bound * (1 + 1e-9)
    for name, number in outcomes.most_common():
        print(f"{number:6d}  {name}")
    print("statuses: " + ", ".join(f"{name} {number}" for name, number in statuses.most_common()))
    print(
        f"worst relative error: limit {worst:.1e}; forces alone where moments govern {worst_alone:.1e}"
    )
    print(
        f"limit above the closed form where moments govern: {above}; above the static bound: {over_bound}"
    )
    print(
        f"time per wedge: median {statistics.median(times) * 1e3:.1f} ms, largest {max(times) * 1e3:.0f} ms"
    )


def all_pairs() -> None:
    print("\n## The paper's criterion on the paper's wedge (k_n = 1e7 kN/m³)")
    for shear in ("clough-duncan", 1e5, 1e6, 2e6, 4e6, 1e7):
        began = time.perf_counter()
        result = sk.wedge(**PAPER, criterion="all-pairs", shear_stiffness=shear)
        seconds = time.perf_counter() - began
        pairs = result.all_pairs
        name = shear if isinstance(shear, str) else f"k_t/k_n = {shear / 1e7:g}"
        print(
            f"{name:16s} F = {result.fos.all_pairs_failed:.5f}, {len(pairs.history)} trials, {seconds * 1e3:.0f} ms"
        )
    result = sk.wedge(**PAPER, criterion="all-pairs", refine=2)
    print(
        f"failed pairs of {result.model.node_pairs}: "
        + json.dumps([[round(f, 5), n] for f, n in sorted(result.all_pairs.history)])
    )


if __name__ == "__main__":
    stages()
    cold()
    all_pairs()
    random_wedges()
