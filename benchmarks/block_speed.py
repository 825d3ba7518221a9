"""Many blocks: slopekit against a plain sequence of generic conic solves, by ``python -m benchmarks.blocks speed``.

The word ``quick`` after it leaves out 10,000 blocks. Every case runs in a process of its own, whose largest memory is
measured before the conic solver is loaded.

Scenes: a stack of 100 blocks a column on a 30° incline, in as many columns that do not touch as it takes; Goodman &
Bray's 16 columns (φ = 38.15°) in rows behind each other that do not touch, all in one model; a wall in running bond,
10 courses on a base of 20° (φ = 35°); the same wall 32 x 32, which slides and turns and has no closed form.

`bound s` is the static bound's program alone, `both s` the static bound, the path to its limit and the range of the
mechanism; steps: those of the bound and factorisations of the path; basis: a limit state, settled, a peak, or none.

The other side is METHOD.md §4 done plainly, on the same model in the same process: Clarabel (qdldl, 1e-8), friction
frozen at the normal forces of the last pass, until three factors agree to 1e-4, at most 40 passes. At 10,000 blocks one
pass is timed and multiplied by the passes of the same scene at 1,000.
"""

import json
import math
import resource
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np

SIZES = (100, 1000, 10000)
_SECONDS = 3600.0  # a case that takes longer is given up


def slides_at(phi: float, dip: float) -> float:
    """The factor of what slides on one plane without cohesion, tan φ / tan β."""
    return math.tan(math.radians(phi)) / math.tan(math.radians(dip))


def scene_of(name: str, blocks: int):
    """A scene, its friction angle and its exact factor (None: there is none)."""
    from tests.preie.block_scenes import Scene, columns, stack, wall

    if name == "stack":
        one = stack(100, width=300.0)
        p, times = one.patches, max(1, blocks // 100)
        shift = np.repeat(np.arange(times), len(p)) * len(one)
        minus = np.tile(p.minus, times)
        patches = replace(
            p,
            plus=np.tile(p.plus, times) + shift,
            minus=np.where(minus < 0, -1, minus + shift),
            joint=np.tile(p.joint, times),
            normals=np.tile(p.normals, (times, 1)),
            areas=np.tile(p.areas, times),
            centroids=np.tile(p.centroids, (times, 1)),
            corners=np.tile(p.corners, (times, 1)),
            first=2 * np.arange(times * len(p) + 1),
        )
        whole = (np.tile(part, (times, 1)) for part in (one.centroids, one.forces, one.moments))
        return (
            Scene(patches, *whole, np.zeros(times * len(one), dtype=bool), True),
            35.0,
            slides_at(35.0, 30.0),
        )
    if name == "columns":
        from slopekit.closed_form.toppling import ColumnSlope, toppling_factor_of_safety
        from tests.preie.block_scenes import GOODMAN_BRAY

        exact = toppling_factor_of_safety(ColumnSlope(GOODMAN_BRAY, 10.0, 1.0, 30.0, 25.0, 38.15))[
            0
        ]
        return columns(rows=math.ceil(blocks / 16)), 38.15, exact
    if name == "square wall":
        return wall(32, 32), 35.0, None
    return wall(10, blocks // 10), 35.0, slides_at(35.0, 20.0)


def case(name: str, blocks: int, passes: int | None) -> dict:
    """Both solvers on one scene; `passes`: how many the other one is said to need, None: run them."""
    from slopekit.preie.many_blocks.blocks import limit_of_blocks
    from slopekit.preie.programs.bounds import static_bound

    scene, phi, exact = scene_of(name, blocks)
    began = time.perf_counter()
    model = scene.model(phi)
    built = time.perf_counter() - began
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    began = time.perf_counter()
    static_bound(model)
    bound = time.perf_counter() - began
    began = time.perf_counter()
    found = limit_of_blocks(model)
    both = time.perf_counter() - began
    ours = {
        "name": name,
        "blocks": len(scene),
        "pairs": len(model.control_area),
        "built": built,
        "bound_s": bound,
        "limit_s": max(both - bound, 0.0),
        "both_s": both,
        "factor": found.factor,
        "bound": found.static_bound,
        "outcome": found.outcome.name,
        "change": found.change,
        "basis": found.basis.name.lower(),
        "steps": found.steps,
        "bound_steps": found.bound_steps,
        "exact": exact,
        "before_mb": before,
        "memory_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
    }
    from tests.preie.assembly_oracle import conic_sequence

    theirs = conic_sequence(model, most=40 if passes is None else 1)
    return ours | {
        "conic_s": theirs.seconds if passes is None else theirs.seconds * passes,
        "conic_passes": theirs.passes if passes is None else passes,
        "conic_settled": theirs.settled,
        "conic_factor": theirs.factor if passes is None else None,
        "conic_pass_s": float(np.mean(theirs.each)),
        "estimated": passes is not None,
        "conic_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
    }


def in_a_process(name: str, blocks: int, passes: int | None) -> dict | None:
    """`case` in a fresh interpreter, one thread; None where it was given up."""
    command = [
        sys.executable,
        "-m",
        "benchmarks.block_speed",
        "case",
        name,
        str(blocks),
        str(passes or 0),
    ]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=_SECONDS)
    except (subprocess.TimeoutExpired, subprocess.CalledProcessError) as error:
        print(f"{name}, {blocks} blocks: {str(error.stderr or error)[-300:]}")
        return None
    found: dict = json.loads(done.stdout.splitlines()[-1])
    return found


def printed(x: dict) -> str:
    """A row of the table."""
    factor = f"{x['factor']:.6f}" if x["factor"] else x["outcome"]
    bound = f"{x['bound']:.5f}" if x["bound"] else "none"
    error = f"{x['factor'] / x['exact'] - 1:.0e}" if x["exact"] and x["factor"] else "-"
    other = f"{x['conic_factor']:.5f}" if x["conic_factor"] else "-"
    passes = f"{x['conic_passes']}{'e' if x['estimated'] else '' if x['conic_settled'] else '!'}"
    return (
        f"{x['name']:12s}{x['blocks']:7d}{x['pairs']:8d}{x['bound_s']:8.2f}{x['both_s']:8.2f}"
        f"{x['bound_steps']:5d}+{x['steps']:<5d}{x['basis']:>8s}{factor:>11s}{bound:>9s}{error:>8s}"
        f"{x['memory_mb']:7.0f}{x['conic_s']:9.2f}{passes:>5s}{other:>10s}{x['conic_pass_s']:8.2f}"
        f"{x['conic_mb']:7.0f}{x['conic_s'] / x['both_s']:7.1f}"
    )


def table(quick: bool) -> None:
    """All scenes and sizes."""
    print(
        f"{'scene':12s}{'blocks':>7s}{'pairs':>8s}{'bound s':>8s}{'both s':>8s}{'steps':>10s} {'basis':>8s}{'F':>11s}"
        f"{'bound':>9s}{'error':>8s}{'MB':>7s}{'conic s':>9s}{'pass':>5s}{'F':>10s}{'s/pass':>8s}{'MB':>7s}"
        f"{'times':>7s}"
    )
    for name in ("stack", "columns", "wall", "square wall"):
        rows: list[dict] = []
        for blocks in SIZES if name != "square wall" else (1000,):
            if blocks == SIZES[-1] and quick:
                continue
            passes = rows[-1]["conic_passes"] if blocks == SIZES[-1] and rows else None
            found = in_a_process(name, blocks, passes)
            if found:
                rows.append(found)
                print(printed(found), flush=True)
        if len(rows) > 1:
            first, last = rows[0], rows[-1]
            size = math.log(last["blocks"] / first["blocks"])
            ours, other = (math.log(last[key] / first[key]) / size for key in ("both_s", "conic_s"))
            print(f"{'':12s}time grows with blocks^{ours:.2f}, conic^{other:.2f}")
    print(
        "both: bound and limit. pass: e estimated from 1,000 blocks, ! not settled after 40. MB: peak of the process"
    )


if __name__ == "__main__":
    print(json.dumps(case(sys.argv[2], int(sys.argv[3]), int(sys.argv[4]) or None)))
