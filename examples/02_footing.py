"""The footing of Sheng, Li, Liu & Qi (2023), section 3.3, as a report. Run: python examples/02_footing.py"""

import slopekit as sk

# A strip footing of 1500 kN/m above a weak plane of 45 degrees that daylights in a vertical face; c = 200, φ = 0, no
# weight. F = 1500 and c = 200 agree only in like units, on a plane 5 √2 m long (docs/method.md).
PAPER = {
    1.0: (-11.2, -17.0, 0),
    1.1: (-11.2, -17.0, 2),
    1.2: (-11.6, -17.5, 6),
    1.3: (-10.0, -17.4, 8),
    1.33: (-10.7, -17.8, 8),
    1.333: (-10.8, -17.8, 8),
    1.334: (-33.3, -40.3, 9),
    1.34: (-234.8, -241.9, 9),
    1.35: (-566.7, -573.7, 9),
    1.36: (-1039.9, -1047.1, 9),
    1.37: (-1415.8, -1422.9, 9),
}
DESIGN = {
    "slopekit": 1,
    "kind": "footing",
    "footing": {"load": "1500 kN", "at": "middle"},
    "weak_plane": {"dip": 45, "length": "7.0710678 m", "pairs": 9},
    "strength": {
        "seam": {"c": "200 kPa", "phi": 0, "stiffness": {"normal": 3.66e4, "shear": 7.52e3}}
    },
    "analysis": {"factors": list(PAPER)},
}

# Table 3 has the pairs fail one after the other. A rigid block slips evenly along a straight plane, so under a load
# over its middle and with one stiffness for all pairs they fail together. They fail in turn where the load stands off
# the middle and the shear stiffness grows with the normal stress (eq. 31 without its bend): both are inferred here.
even = sk.run(DESIGN)
hyperbola = {"law": "clough-duncan", "k1": 600, "n": 0.56, "Rf": 0}
uneven = sk.run(DESIGN, set={"footing.at": "3 m", "strength.seam.stiffness.shear": hyperbola})

print("Displacements in mm (x as the paper has it: negative out of the face) and failed pairs of 9")
print(f"{'':8s}{'Table 3':>26s}{'load 0.5 m off the middle':>30s}{'load over the middle':>26s}")
for (factor, (x, y, failed)), off, over in zip(
    PAPER.items(), uneven.series, even.series, strict=True
):
    row = f"{factor:<8.3f}{x:10.1f}{y:10.1f}{failed:6d}"
    for step in (off, over):
        if step.movement is None:
            row += f"{'no rest':>20s}{step.failed_pairs:6d}"
        else:
            out, _, up = step.movement.displacement * 1e3
            row += f"{-out:10.1f}{up:10.1f}{step.failed_pairs:6d}"
    print(row)

for name, result in (("off the middle", uneven), ("over the middle", even)):
    fos = result.fos
    print(
        f"load {name:16s} limit {fos.limit:.6f}, closed form {fos.closed_form:.6f}, bound {fos.static_bound:.6f}"
    )

failed = [step.failed_pairs for step in uneven.series]
stands = [step.stands for step in uneven.series]
print(f"failed pairs {failed}; it stands up to {max(s.factor for s in uneven.series if s.stands)}")
assert failed[0] == 0
assert failed[6] == 9
assert stands.index(False) == 6
assert abs(uneven.fos.limit - 4.0 / 3.0) < 1e-6
