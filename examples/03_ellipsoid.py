"""The ellipsoid of Sheng, Li, Liu & Qi (2023), section 4.2, as a report. Run: python examples/03_ellipsoid.py"""

import slopekit as sk

# The slip surface is equation (34). The slope is not given: a face x + z = 40 from (40, 0) to (0, 40) is inferred from
# the columns, which then come close to those of Table 9 (docs/method.md).
DESIGN = {
    "slopekit": 1,
    "kind": "surface",
    "slope": {"profile": [[60, 0], [40, 0], [0, 40], [-20, 40]]},
    "slip": {"shape": "ellipsoid", "centre": [40, 0, 40], "radii": [40, 28.2842712, 40]},
    "strength": {"slip surface": {"c": "30 kPa", "phi": 30}},
    "rock": {"unit_weight": "21.56 kN/m3"},  # 2200 kg/m³ at 9.8 m/s²
}
true = sk.run(DESIGN)
print(
    f"{true.geometry.volume_m3:.1f} m³ on {true.geometry.areas_m2['slip surface']:.1f} m²: {true.status_text}"
)

print(f"\n{'method':34s}{'slopekit':>10s}{'Table 9':>10s}")
for method, ours, paper in (
    ("Fellenius", true.methods["fellenius"], "1.15"),
    ("Janbu (simplified)", true.methods["janbu"], "1.25"),
    ("Bishop (simplified)", true.methods["bishop"], "1.30"),
    ("PFE-IE", None, "1.42"),
    ("PRE-IE limit, zero dilation", true.fos.limit, "1.464"),
    ("static bound (free to dilate)", true.fos.static_bound, ""),
):
    print(f"{method:34s}{'' if ours is None else f'{ours:.4f}':>10s}{paper:>10s}")

# A mesh of flat facets interlocks like a ratchet: its normals are smoothed over the mesh, and turned square to the
# motion that the surface lets through. The factor then tends to that of the true surface.
print(f"\n{'normals':12s}{'edge m':>8s}{'pairs':>8s}{'limit':>10s}{'bound':>10s}")
for normals in ("smoothed", "true"):
    for edge in (10, 5, 2.5):
        found = sk.run(DESIGN, set={"slip.normals": normals, "slip.edge": edge})
        size, fos = found.geometry.edge_m, found.fos
        print(
            f"{normals:12s}{size:8.2f}{found.model.node_pairs:8d}{fos.limit:10.4f}{fos.static_bound:10.4f}"
        )

# With φ = 0 on a sphere moments alone decide, and the answer is exact (Hungr, Salgado & Byrne 1989).
sphere = sk.run(
    DESIGN,
    set={
        "slope.profile": [[30, -20.5901699], [-30, 9.4098301]],
        "slip": {"shape": "sphere", "centre": [0, 0, 0], "radius": 10},
        "strength.slip surface": {"c": 20, "phi": 0},
        "rock.unit_weight": 20,
    },
)
print(
    f"\nsphere, φ = 0: limit {sphere.fos.limit:.5f}, closed form {sphere.fos.closed_form:.5f} (published: 1.402)"
)
assert abs(sphere.fos.limit - 1.4016) < 5e-4
assert abs(true.fos.limit - 1.3436) < 1e-3
