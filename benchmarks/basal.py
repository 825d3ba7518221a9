"""Random wedges on three joints: PRE-IE against the closed form by vectors. By hand: ``python -m benchmarks.basal``.

Water, cracks, seismic load, forces, active and passive bolts come and go. Where moments govern, the closed form is
compared with the limit of the forces alone.
"""

import sys
from collections import Counter
from dataclasses import dataclass

import numpy as np

import slopekit as sk
from slopekit.core.errors import GeometryError
from slopekit.kinds import cut
from slopekit.kinds.protocol import compare
from slopekit.kinds.single_block.one_block import block_status
from slopekit.kinds.single_block.one_block_limit import moment_limit
from slopekit.kinds.wedge import closed_form

COUNT = 1000


def random_design(rng: np.random.Generator) -> dict:
    """A wedge above a basal joint, in one of seven a socket wedge; some of them close no block."""
    u = rng.uniform
    height = float(10 ** u(0.3, 2.0))
    face = float(u(180, 190))
    socket = rng.integers(0, 7) == 0
    side = (82, 88.5) if socket else (35, 86)
    design: dict = {
        "slopekit": 1,
        "kind": "wedge",
        "slope": {
            "face": f"{u(55, 85)}/{face}",
            "upper": f"{u(0, 12)}/{u(150, 210)}",
            "height": height,
        },
        "joints": {
            "J1": {"plane": f"{u(*side)}/{u(92, 150)}", "strength": "J1"},
            "J2": {"plane": f"{u(*side)}/{u(210, 268)}", "strength": "J2"},
        },
        "basal": {
            "plane": f"{u(13, 50)}/{u(150, 210)}",
            "strength": "base",
            "height": float(height * (u(-0.5, -0.1) if socket else u(0.05, 0.8))),
        },
        "strength": {
            name: {"c": float(rng.choice([0.0, u(0.0, 2.0 * height)])), "phi": float(u(5, 50))}
            for name in ("J1", "J2", "base")
        },
        "rock": {"unit_weight": float(u(20, 28))},
    }
    if rng.integers(0, 3) == 0:
        design["crack"] = {
            "plane": f"{u(75, 90)}/{u(170, 190)}",
            "distance": float(height * u(0.05, 0.5)),
        }
    wet = rng.integers(0, 4)
    if wet == 1:
        design["water"] = {"fill": float(u(0.0, 0.6))}
    if wet == 2:
        pressures = {name: float(u(0.0, 3.0 * height)) for name in ("J1", "J2", "basal")}
        design["water"] = {
            "pressures": pressures | ({"crack": float(u(0.0, height))} if "crack" in design else {})
        }
    if rng.integers(0, 3) == 0:
        design["loads"] = {
            "seismic": {"k": float(u(0.0, 0.3)), **({"toward": float(u(120, 240))} if wet else {})}
        }
    size = design["rock"]["unit_weight"] * height**3 * 0.02
    if rng.integers(0, 3) == 0:
        acts = rng.choice(["active", "passive"])
        bolt = {
            "force": float(size * u(0.0, 1.0)),
            "toward": f"{u(0, 360)}/{u(-30, 30)}",
            "acts": str(acts),
        }
        design["support"] = {"bolts": [bolt]}
    if rng.integers(0, 4) == 0:
        design.setdefault("loads", {})["forces"] = [
            {"force": float(size * u(0, 0.5)), "toward": f"{u(120, 240)}/{u(-20, 20)}"}
        ]
    return design


@dataclass(frozen=True)
class Compared:
    """One design: status, whether moments govern, relative difference on the closed form's assumptions, or a code."""

    design: dict
    status: str
    agree: bool | None
    moments_govern: bool
    difference: float | None


def compared(design: dict) -> Compared:
    """Both methods on one design, PRE-IE on the coarsest node pairs."""
    loaded = sk.load(design)
    try:
        made = cut(loaded)
        closed = closed_form(loaded)
    except GeometryError as error:
        return Compared(design, error.codes[0], None, False, None)
    found = moment_limit(made.scene_at(0))
    status, governs = block_status(found, made.joints), found.analysis.moments_govern
    difference, agree = compare(found.comparable, status, closed, loaded.analysis.agree_within)
    if found.comparable and not governs and status != "rotates":  # some joint opens in part
        agree = agree and status == closed.status
    return Compared(design, status, agree, governs, difference)


def compared_until(count: int, seed: int = 18) -> list[Compared]:
    """As many random designs as it takes for `count` blocks."""
    rng, found, blocks = np.random.default_rng(seed), [], 0
    while blocks < count:
        found.append(compared(random_design(rng)))
        blocks += found[-1].status[0] != "E"
    return found


def main(count: int = COUNT) -> None:
    """Counts by status, and the differences."""
    found = compared_until(count)
    print(f"{len(found)} designs, {count} of them close a block")
    for status, number in Counter(one.status for one in found).most_common():
        print(f"  {status:28s}{number:6d}")
    blocks = [one for one in found if one.status[0] != "E"]
    for name, governs in (
        ("moments do not govern", False),
        ("moments govern (forces alone)", True),
    ):
        parts = [one for one in blocks if one.moments_govern is governs]
        sizes = sorted(one.difference for one in parts if one.difference is not None)
        last = f"median {sizes[len(sizes) // 2]:.1e}, worst {sizes[-1]:.1e}" if sizes else ""
        agree = sum(one.agree is True for one in parts)
        print(f"{name}: {len(parts)}, {agree} agree, {len(sizes)} with two numbers: {last}")
        for one in (
            sorted(parts, key=lambda one: -(one.difference or 0.0))[:3]
            + [p for p in parts if not p.agree][:5]
        ):
            if not one.agree or (one.difference or 0.0) > 1e-9:
                print("   ", one.status, one.difference, one.design)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
