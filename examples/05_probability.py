"""The paper's wedge when its friction is not known exactly, as a report. Run: python examples/05_probability.py"""

import math

from scipy.stats import norm

import slopekit as sk

# The wedge of Table 4 with φ = N(20°, 2°) on both planes, wet to the same unknown part of full.
wedge = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "60/180", "upper": "10/180", "height": "64.89 m"},
    "joints": {
        "J1": {"plane": "45/115", "strength": "east"},
        "J2": {"plane": "45/245", "strength": "west"},
    },
    "strength": {
        name: {"c": "50 kPa", "phi": {"dist": "normal", "mean": 20, "sd": 2}}
        for name in ("east", "west")
    },
    "rock": {"density": "2600 kg/m3"},
}

print("P(FoS < 1.4), dry, 20,000 samples each, by the correlation of the two friction angles:")
print(f"{'rank correlation':>18s}{'estimate':>11s}{'95 % limits':>22s}")
for rank in (0.0, 0.5, 1.0):
    study = sk.prob(sk.load(wedge, set={"correlation": {"J1.phi/J2.phi": rank}}), fos=1.4)
    share = study.all_samples
    print(f"{rank:18.1f}{share.share:11.4f}{share.low:12.4f} to {share.high:.4f}")

# With correlation 1 both planes have one φ, and F = (c A + 2 N tan φ) / T has an inverse by hand.
at_20, without = (
    sk.wedge(dips=("45/115", "45/245")),
    sk.wedge(dips=("45/115", "45/245"), phi=(0, 0)),
)
slope = (at_20.fos.closed_form - without.fos.closed_form) / math.tan(math.radians(20.0))
limit = math.degrees(math.atan((1.4 - without.fos.closed_form) / slope))
exact = float(norm.cdf(limit, 20.0, 2.0))
print(f"\nby hand for correlation 1: φ < {limit:.3f}° has a probability of {exact:.4f}")

both = study.both
print(
    f"both methods agree on {both.agree} samples, disagree on {both.disagree}: the largest difference is "
    f"{both.largest:.1e}"
)
assert share.low <= exact <= share.high
