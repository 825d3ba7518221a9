"""The symmetric wedge of Sheng, Li, Liu & Qi (2023), section 4.1, as a report. Run: python examples/01_wedge.py"""

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

# What decides: with the joints full of water the same wedge is at its limit.
wet = sk.wedge(dips=("45/115", "45/245"), water="full")
print(f"\nfull of water: {wet.fos.limit:.3f} (closed form {wet.fos.closed_form:.3f})")

assert abs(wedge.fos.limit - 1.5574) < 5e-5
