"""Times and errors of design files and of the kinds beside the wedge. By hand: ``python -m benchmarks.kinds``.

Speed against error of curved surfaces, facet normals against true ones, 1,500 random plane failures, cold runs of
every template as multiples of the cold wedge from the command line.
"""

import statistics
import subprocess
import sys
import time
from collections import Counter

import numpy as np

import slopekit as sk
from slopekit.design.templates import names, path_of

ELLIPSOID, SPHERE = path_of("paper-ellipsoid"), path_of("sphere")


def surfaces() -> None:
    """Error and time by mesh; the sphere has an exact answer, the ellipsoid its own finest."""
    print("\n## Curved surfaces: speed against error (ms in process, bound apart)")
    finest = sk.run(ELLIPSOID, set={"slip.edge": 1.21}).fos.limit
    exact = sk.run(SPHERE).fos.closed_form
    print(f"ellipsoid, finest true normals {finest:.6f}; sphere, closed form {exact:.6f}")
    print(
        f"{'surface':10s}{'normals':10s}{'edge m':>8s}{'pairs':>8s}{'limit':>10s}{'error':>10s}{'bound':>9s}"
        f"{'cut':>8s}{'limit ms':>9s}{'bound ms':>9s}"
    )
    for name, path, answer, edges in (
        ("ellipsoid", ELLIPSOID, finest, (10, 5, 2.5)),
        ("sphere", SPHERE, exact, (2, 1, 0.4)),
    ):
        for normals in ("true", "smoothed"):
            for edge in edges:
                found = sk.run(path, set={"slip.normals": normals, "slip.edge": edge})
                ms = {key: value * 1e3 for key, value in found.timing_s.items()}
                limit = found.fos.limit or float("nan")
                print(
                    f"{name:10s}{normals:10s}{found.geometry.edge_m:8.2f}{found.model.node_pairs:8d}{limit:10.5f}"
                    f"{limit / answer - 1:10.1e}{found.fos.static_bound or 0:9.4f}{ms['cut']:8.1f}"
                    f"{ms['solve']:9.1f}{ms['bound']:9.1f}"
                )


def random_plane(rng: np.random.Generator) -> dict:
    """A plane failure with some of crack, water, seismic and bolts."""
    face = float(rng.uniform(35, 90))
    dip = float(rng.uniform(8, face - 3))
    upper = float(rng.uniform(-10, min(dip - 2, 25)))
    height = float(10 ** rng.uniform(-1, 2.5))
    design: dict = {
        "slopekit": 1,
        "kind": "plane",
        "joints": {"J1": {"plane": f"{dip}/180"}},
        "slope": {
            "face": f"{face}/180",
            "height": height,
            "upper": f"{abs(upper)}/{180 if upper >= 0 else 0}",
        },
        "strength": {
            "s": {
                "c": float(rng.choice([0, rng.uniform(0, 3 * height)])),
                "phi": float(rng.choice([0, rng.uniform(5, 50)])),
            }
        },
        "rock": {"unit_weight": float(rng.uniform(18, 30))},
    }
    wet = rng.integers(0, 5)
    if wet == 1:
        design["crack"] = {"distance": float(rng.uniform(-0.25, 0.4) * height)}
    if wet in (1, 2):
        design["water"] = {"fill": float(rng.uniform(0, 1))}
    if wet == 3:
        design["water"] = {"pressures": float(rng.uniform(0, 4 * height))}
    if rng.random() < 0.3:
        design["loads"] = {"seismic": float(rng.uniform(0, 0.3))}
    if rng.random() < 0.3:
        design["support"] = {
            "bolts": [
                {
                    "force": float(rng.uniform(0.1, 2) * height * height * 3),
                    "acts": str(rng.choice(["active", "passive"])),
                    "toward": f"{rng.choice([0, 180])}/{rng.uniform(-60, 60)}",
                }
                for _ in range(rng.integers(1, 3))
            ]
        }
    return design


def planes(count: int = 1500, seed: int = 7) -> None:
    """Closed form against PRE-IE."""
    rng, outcomes, worst, began = np.random.default_rng(seed), Counter(), 0.0, time.perf_counter()
    above = 0
    for _ in range(count):
        try:
            found = sk.run(random_plane(rng))
        except sk.GeometryError as error:
            outcomes[", ".join(error.codes)] += 1
            continue
        outcomes[
            f"{found.status}, {'moments govern' if found.moments_govern else f'agree {found.agree}'}"
        ] += 1
        worst = max(worst, found.difference or 0.0)
        above += bool(
            found.fos.limit and (found.fos.limit > (found.fos.static_bound or 0.0) * (1 + 1e-7))
        )
    took = (time.perf_counter() - began) / count * 1e3
    print(
        f"\n## {count} random plane failures, seed {seed}: {took:.1f} ms each, worst difference {worst:.1e}, "
        f"{above} above the static bound"
    )
    for outcome, number in outcomes.most_common():
        print(f"{number:6d}  {outcome}")


def cold(repeat: int = 9) -> None:
    """Whole processes, interleaved, as multiples of the wedge from the command line."""
    command = [sys.executable, "-m", "slopekit.cli"]
    runs = {"wedge from the command line": [*command, "wedge", "--dips", "45/115", "45/245"]}
    runs |= {f"run {name}.yaml": [*command, "run", str(path_of(name))] for name in names()}
    times: dict[str, list[float]] = {name: [] for name in runs}
    for _ in range(repeat):
        for name, run in runs.items():
            began = time.perf_counter()
            subprocess.run(run, capture_output=True, check=False)
            times[name].append(time.perf_counter() - began)
    print("\n## Cold, whole process (median)")
    base = statistics.median(times["wedge from the command line"])
    for name, found in times.items():
        print(
            f"{name:32s}{statistics.median(found) * 1e3:8.0f} ms{statistics.median(found) / base:8.2f} x"
        )


if __name__ == "__main__":
    surfaces()
    planes()
    cold()
