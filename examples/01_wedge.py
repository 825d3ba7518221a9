"""The symmetric wedge of Sheng, Li, Liu & Qi (2023), section 4.1, as a report. Run: python examples/01_wedge.py"""

import os
import platform
from importlib.util import find_spec

import slopekit as sk

# Table 4: two joints, an upper slope and a face; Table 5: c = 50 kPa, φ = 20°, rock of 2600 kg/m³.
wedge = sk.wedge(
    dips=("45/115", "45/245"),
    face="60/180",
    upper="10/180",
    height="64.89 m",
    c="50 kPa",
    phi=20,
    density="2600 kg/m3",
    criterion="all-pairs",
)
# The same wedge elastic, on joints of a constant shear stiffness (kN/m³). The paper prints no modulus: 20 GPa is ours.
has_elastic = find_spec("skfem") is not None
plain = sk.wedge(
    dips=("45/115", "45/245"), shear_stiffness=1e5, modulus="20 GPa", elastic=has_elastic
)

print(f"The wedge has {wedge.geometry.volume_m3:.0f} m³ and {wedge.status.replace('_', ' ')}.")
if not has_elastic:
    print("No row of elastic blocks: they need scikit-fem, pip install 'slopekit[elastic]'.")


def row(name: str, *values: float | str | None) -> None:
    """A line of a table: numbers with four decimals, a dash for none."""
    shown = (
        "-" if value is None else value if isinstance(value, str) else f"{value:.4f}"
        for value in values
    )
    print(f"{name:46s}" + "".join(f"{one:>18s}" for one in shown))


# The printed 1.556 needs a unit weight of 25.588 kN/m³ (docs/method.md); at 2600 kg/m³ and 9.81 m/s² it is 1.5574.
print()
row("Table 6, factor of safety", "paper", "slopekit")
row("analytical, Hoek & Bray", "1.556", wedge.fos.closed_form)
if plain.elastic is not None:
    row("elastic blocks (paper: PFE-IE)", "1.554", plain.elastic.limit)
row("PRE-IE, all pairs failed", "1.554", wedge.fos.all_pairs_failed)
row("PRE-IE, limit at zero dilation", None, wedge.fos.limit)
row("static bound (joints dilate)", None, wedge.fos.static_bound)
if plain.elastic is not None:
    opened = (
        f"{plain.elastic.opened_share:.1%} of the contact area is pulled open, its cohesion gone"
    )
    print(f"elastic: {plain.elastic.modulus_kpa * 1e-6:g} GPa on rigid bedrock; {opened}")

print("\nfactor  failed node pairs")
for factor, failed in sorted(wedge.all_pairs.history):
    print(f"{factor:.4f}  {failed} of {wedge.model.node_pairs}")

# Table 7: the paper does not name its machine. A single iteration is one factor tried.
print()
row("Table 7: one iteration / in all", "paper", "slopekit")
tried = len(wedge.all_pairs.history)
seconds = wedge.timing_s["all_pairs"]
row(
    "PRE-IE, search for all pairs failed",
    "1 s / 5 s",
    f"{1e3 * seconds / tried:.0f} ms / {1e3 * seconds:.0f} ms",
)
if plain.elastic is not None:
    steps, seconds = plain.elastic.steps, plain.timing_s["elastic"]
    row(
        "elastic blocks (paper: PFE-IE)",
        "52..70 s / 305 s",
        f"{1e3 * seconds / steps:.0f} ms / {1e3 * seconds:.0f} ms",
    )
rest = plain.timing_s["total"] - plain.timing_s.get("elastic", 0.0)
row("PRE-IE, limit, closed form and bound", None, f"{1e3 * rest:.1f} ms")
print(
    f"slopekit on {platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}"
)

if plain.elastic is not None:
    assert abs(plain.elastic.limit - 1.5489) < 2e-3  # its bracket: 1.5483 .. 1.5484
assert abs(wedge.fos.limit - 1.5574) < 5e-5
