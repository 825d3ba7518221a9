"""The symmetric wedge of Sheng, Li, Liu & Qi (2023), section 4.1, as a report. Run: python examples/01_wedge.py"""

import os
import platform

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

print(f"The wedge has {wedge.geometry.volume_m3:.0f} m³ and {wedge.status.replace('_', ' ')}.")
print(f"{'method':42s}{'factor':>9s}")
for method, factor in (
    ("Hoek, analytical (Table 6)", 1.556),
    ("PRE-IE of the paper, all pairs failed", 1.554),
    ("slopekit, Hoek & Bray closed form", wedge.fos.closed_form),
    ("slopekit, PRE-IE limit, zero dilation", wedge.fos.limit),
    ("slopekit, PRE-IE, all pairs failed", wedge.fos.all_pairs_failed),
    ("slopekit, static bound (joints dilate)", wedge.fos.static_bound),
):
    print(f"{method:42s}{factor:9.4f}")

# The printed 1.556 needs a unit weight of 25.588 kN/m³ (METHOD.md §6); at 2600 kg/m³ and 9.81 m/s² it is 1.5574.
print("\nfactor  failed node pairs")
for factor, failed in sorted(wedge.all_pairs.history):
    print(f"{factor:.4f}  {failed} of {wedge.model.node_pairs}")

# Table 7: the paper's PRE-IE took 1 s an iteration and 5 s in all, PFE-IE 305 s, on a machine it does not name.
plain = sk.wedge(dips=("45/115", "45/245"))
machine = f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}"
print(f"\n{'time':42s}{'ms':>9s}   on {machine}")
for name, seconds in (
    ("PFE-IE of the paper (Table 7)", 305.0),
    ("PRE-IE of the paper (Table 7)", 5.0),
    ("slopekit, with the all-pairs search", wedge.timing_s["total"]),
    ("slopekit, limit, closed form and bound", plain.timing_s["total"]),
    ("  of this: model to limit", plain.timing_s["solve"]),
):
    print(f"{name:42s}{seconds * 1e3:9.2f}")

# What decides: with the joints full of water the same wedge is at its limit.
wet = sk.wedge(dips=("45/115", "45/245"), water="full")
print(f"\nfull of water: {wet.fos.limit:.3f} (closed form {wet.fos.closed_form:.3f})")

assert abs(wedge.fos.limit - 1.5574) < 5e-5
