"""A joint survey against a bench: kinematic tests, every pair as a wedge, the worst of them twice.

Run: python examples/04_survey.py
"""

from pathlib import Path

import slopekit as sk

# 64 joints of a synthetic survey (no real slope): two sets that make wedges, one that dips into the face, flat joints.
JOINTS, FACE = Path(__file__).parent / "joints.csv", "65/180"

# What orientation and friction allow, joint by joint and line by line, as on a stereonet.
tests = sk.kinematic(JOINTS, face=FACE, phi=30)
counts, joints, lines = tests.counts, len(tests.joints), len(tests.lines.first)
print(
    f"{joints} joints, {lines} lines of intersection, face {FACE}, friction 30° where none was measured"
)
print(
    f"planar sliding     {counts['planar']} joints within ±20°, {counts['planar_without_limits']} without a limit"
)
print(f"wedge sliding      {counts['wedge_primary']} lines daylight steeper than friction,")
print(
    f"                   {counts['wedge_by_friction']} of these wedges slide, the others stick between their joints"
)
print(f"flexural toppling  {counts['flexural']} joints: {', '.join(tests.joint_names('flexural'))}")
bases = counts["base_release"] + counts["base_sliding"]
print(f"direct toppling    {counts['direct']} edges of columns, {bases} bases under them")

print(f"\n{'face':>5s}{'wedges %':>10s}{'by friction %':>15s}{'flexural %':>12s}")
for dip in (45, 55, 65, 75, 85):
    at = sk.kinematic(JOINTS, face=(dip, 180), phi=30).counts
    wedge, friction = 100 * at["wedge"] / lines, 100 * at["wedge_by_friction"] / lines
    print(f"{dip:4.0f}°{wedge:10.1f}{friction:15.1f}{100 * at['flexural'] / joints:12.1f}")

# Cohesion, water and size: every pair as a wedge of a 15 m bench, no joint longer than 12 m.
SLOPE = {
    "face": FACE,
    "height": "15 m",
    "c": "5 kPa",
    "phi": 30,
    "unit_weight": 26,
    "water": "20%",
    "fos": 1.3,
}
pairs = sk.combos(JOINTS, **SLOPE, persistence="12 m", min_volume="0.5 m3", top=12)
print(f"\n{len(pairs.pairs)} pairs:")
for outcome, count in pairs.counts.items():
    if count:
        print(f"  {outcome.replace('_', ' '):20s}{count:6d}")
target = pairs.target
print(
    f"{target['below']} of {pairs.removable} removable wedges lie below 1.3, the largest has "
    f"{target['largest_volume_m3']:.0f} m³"
)

print(f"\n{'worst pairs':14s}{'status':16s}{'closed form':>12s}{'PRE-IE':>9s}{'m³':>8s}")
for pair in pairs.worst:
    closed, limit = (
        "none" if value is None else f"{value:.4f}" for value in (pair.closed_form, pair.limit)
    )
    print(
        f"{' x '.join(pair.names):14s}{pair.status:16s}{closed:>12s}{limit:>9s}{pair.volume_m3:8.2f}"
    )
agree, governed = (
    sum(bool(pair.agree) for pair in pairs.worst),
    sum(pair.moments_govern for pair in pairs.worst),
)
print(
    f"the methods agree on {agree} of {len(pairs.worst)}; moments govern {governed}: the closed form is too high there"
)

# What the length of the joints is worth: the same slope where they reach from toe to crest.
full = sk.combos(JOINTS, **SLOPE).target
print(
    f"\nwithout the limit of 12 m: {full['below']} below 1.3, the largest has {full['largest_volume_m3']:.0f} m³"
)

assert target["below"] == 270
