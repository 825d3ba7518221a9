"""Every public function, and what the notebooks ask of what they return, as a caller under mypy --strict sees it."""

from pathlib import Path
from typing import Any, assert_type

import slopekit as sk

design = sk.load("wedge.yaml", set={"slope.height": 20})
result = sk.run(design)
assert_type(result, sk.Result | sk.Cases[sk.Result])  # which of them, the file says when it is read
assert isinstance(result, sk.Result)
assert_type(sk.run("wedge.yaml", {"slope.height": 20}), sk.Result | sk.Cases[sk.Result])
assert_type(sk.run({"kind": "wedge"}, case="quake"), sk.Result)
assert_type(sk.run("wedge.yaml", {"slope.height": 20}, "quake"), sk.Result)
assert_type(sk.analyse(design), sk.Result | sk.Cases[sk.Result])
one = sk.wedge(dips=("45/115", "45/245"), c=(50, 50), water="full", accept=1.5)
assert_type(one.fos.limit, float | None)
assert_type(one.status, str)
assert_type(one.agree, bool | None)
assert_type(one.exit_code, int)
assert_type(one.to_dict(), dict[str, Any])
assert_type(one.line, str)
one.geometry.volume_m3 + one.geometry.total_height_m
if one.forces.driving is not None:
    one.forces.driving / 2.0
[notice.code for notice in one.warnings]
str(one.sheet)
frame: Any = one.to_frame()
frames: dict[str, Any] = one.to_frames()
[table.records() for table in one.tables().values()]

assert_type(sk.check("wedge.yaml"), sk.Check | sk.Cases[sk.Check])
rows = sk.evaluate(design, {"strength.weak.phi": [20, 25], "water.fill": 0.5})
print(rows.limit.words, rows.limit.factor, rows.agree, rows.points[0].message)
swept = sk.sweep(design, {"strength.weak.phi": [20, 25]}, closed_form=True, fos=1.2)
assert_type(swept, sk.Sweep | sk.Cases[sk.Sweep])
assert isinstance(swept, sk.Sweep)
for point in swept.points:
    if point.factors is not None:
        assert_type(point.factors.limit, float | None)
torn = sk.tornado(design, {"strength.weak.c": "40:60"})
assert_type(torn, sk.Tornado | sk.Cases[sk.Tornado])
drawn = sk.prob(design, 500, fos=1.1, by="pre-ie", seed=2, accept=0.05)
assert_type(drawn, sk.Probability | sk.Cases[sk.Probability])
assert isinstance(drawn, sk.Probability)
assert_type(drawn.all_samples.share, float | None)
drawn.sensitivities[0][0].upper()
solved = sk.solve(design, "slope.height", fos=1.3, within=(10, 20))
assert_type(solved, sk.Solution | sk.Cases[sk.Solution])
assert isinstance(solved, sk.Solution)
if solved.answer is not None:
    assert_type(solved.answer.value, float)
    assert_type(solved.answer.factor, float)
needed = sk.support(design, 1.5, acts="active", toward="180/-5")
assert_type(needed, sk.Support | sk.Cases[sk.Support])
assert isinstance(needed, sk.Support)
for case in needed.cases:
    assert_type(case.force, float | None)
    assert_type(case.yaml, str | None)
pairs = sk.combos("joints.csv", face="65/180", phi=30, fos=1.2)
assert_type(pairs, sk.Combos)
worst = pairs.worst[0]
titled = {
    "title": " x ".join(worst.names),
    "joints": {"J1": {"plane": worst.planes[0]}},
    "slope": worst.height_m,
}
assert_type(pairs.removable > 0, bool)
if design.source is not None and isinstance(plain := design.source.root.plain(), dict):
    sk.load(plain, {"water.fill": 1.0})
if one.fos.limit is not None and one.fos.closed_form is not None:
    one.fos.limit / one.fos.closed_form
poles = sk.kinematic(["45/115"], face="65/180")
assert_type(poles, sk.Kinematic)
assert_type(sk.sets("joints.csv", n=3), sk.JointSets)
assert_type(
    sk.bench_design("joints.csv", height=10, face="60:80:5", dip_direction=180), sk.BenchDesigns
)
assert_type(sk.check(design), sk.Check | sk.Cases[sk.Check])
assert_type(sk.quake(design, "sine:0.5g,1Hz"), sk.Quake | sk.Cases[sk.Quake])
found = sk.sets(["45/115", "46/116"])
assert_type(found, sk.JointSets)
benches = sk.bench_design(
    ["45/115", "46/245"], height=15, face=65, dip_direction=180, c=5, phi=30, berm=9, accept=0.8
)
assert_type(benches, sk.BenchDesigns)
chosen = benches.steepest_accepted
if chosen is not None:
    chosen.accepted, chosen.height_m + chosen.face_dip_deg + chosen.berm_m + chosen.inter_ramp_deg
several = sk.run("cut.yaml")
assert isinstance(several, sk.Cases)
assert_type(several.cases["static"], sk.Result)
assert_type(several.governing, str)
bolted = sk.support(design)
assert isinstance(bolted, sk.Cases)
for case in bolted.cases[bolted.governing].cases:
    [(bar.force_kn, bar.acts, bar.head_m, bar.length_m) for bar in case.bolts]
value = sk.solve(design, "water.fill", fos=1.2)
if isinstance(value, sk.Cases):
    assert_type([one.margin for one in value.cases.values()], list[float | None])
written = sk.export(result, "wedge.dxf").written[0]
written.files[0].name, written.bolts

picture = sk.plot(result, "scene", "scene.png")
picture.path.with_suffix(".svg").exists()
assert_type(sk.plot(result), dict[str, str])
page = sk.report([result, swept], "report.html", pictures=False, project={"client": "X"})
assert_type(page, Path)
assert_type(page.name, str)
assert_type(page.stat().st_size, int)
files = sk.export(result, "wedge.stl", case=None)
assert_type(files.files, tuple[Path, ...])
one.view()
try:
    sk.load("x")
except sk.SlopekitError as error:
    assert_type(error.codes, tuple[str, ...])
    assert_type(error.faults[0], sk.Fault)
sk.__version__.split(".")
