"""`--elastic` on designs: what it takes, what it refuses, what it says, and that nothing else pays for it."""

import json
import subprocess
import sys

import pytest

import slopekit as sk
from slopekit.core.errors import DesignError
from slopekit.elastic.rest import RestSearch
from slopekit.kinds import cut
from slopekit.kinds.elastic import scene_of_many
from slopekit.preie.system.contact import ContactMode

WEDGE = {"dips": ("45/115", "45/245"), "shear_stiffness": 1e5, "edge": "65 m"}
PLANE = {
    "slopekit": 1,
    "kind": "plane",
    "slope": {"face": "60/180", "height": 12, "upper": "0/180"},
    "joints": {"J1": {"plane": "35/180"}},
    "strength": {"joint": {"c": 20, "phi": 30}},
    "rock": {"density": 2600},
}


def faults(call) -> list[str]:
    with pytest.raises(DesignError) as caught:
        call()
    return [fault.code for fault in caught.value.faults]


def test_json_and_sheet_have_it_where_it_is_asked_for() -> None:
    found = sk.wedge(**WEDGE, elastic=True)
    document = json.loads(json.dumps(found.to_dict()))["elastic"]
    assert document["limit"] == found.elastic.limit <= document["rigid_limit"]
    assert document["rigid_limit"] == pytest.approx(found.fos.limit, rel=1e-9)
    assert document["taken"] == ["modulus", "poisson"]
    assert "ELASTIC" in str(found.sheet)
    assert found.timing_s["elastic"] > 0.0
    plain = sk.wedge(**{key: value for key, value in WEDGE.items() if key != "edge"})
    assert plain.elastic is None
    assert "elastic" not in plain.to_dict()
    assert "ELASTIC" not in str(plain.sheet)


def test_a_plane_in_its_section_and_a_slope_below_one() -> None:
    found = sk.run(PLANE, elastic=True).elastic
    assert found.factor == 1.0
    assert found.displacement_m[2] < found.rigid_displacement_m[2] < 0.0
    weak = sk.run(PLANE, {"strength.joint.c": 1}, elastic=True)
    assert weak.fos.limit < 1.0
    assert weak.elastic.factor == pytest.approx(0.95 * weak.fos.limit, rel=1e-9)


@pytest.mark.slow
def test_elastic_rock_may_not_stand_where_rigid_rock_just_does() -> None:
    """Its limit by forces is 1.013: what its deformation opens takes it below 1, and the state is one below."""
    found = sk.wedge(
        ("41.7/139.1", "41.7/214.5"),
        face="77.1/180",
        upper="10.3/180",
        height=50.42,
        c=(71.4, 43.0),
        phi=(25.5, 20.1),
        unit_weight=26,
        shear_stiffness=1e5,
        modulus="13.3 GPa",
        bolts="3526@0/-10,passive",
        edge="60 m",
        elastic=True,
    )
    assert found.comparisons.forces_only > 1.01
    assert found.elastic.factor == 0.95
    assert found.elastic.limit < 1.0
    assert found.elastic.opened_share > found.elastic.rigid_opened_share


def columns(cohesion: float) -> dict:
    return {
        "slopekit": 1,
        "kind": "topple",
        "columns": {"dip": 65, "width": 4, "heights": [4, 9, 6], "base_step": 1},
        "strength": {"joint": {"c": cohesion, "phi": 38}},
        "rock": {"density": 2600, "modulus": "5 GPa"},
    }


def test_columns() -> None:
    """Where there is no cohesion to lose, the limit is that of rigid columns; where there is, both lose much of it."""
    found = sk.run(columns(0), elastic=True)
    assert found.elastic.block in ("C1", "C2", "C3")
    assert found.elastic.limit == found.fos.limit
    assert (
        found.elastic.opened_share
        > found.elastic.lost_share
        == found.elastic.rigid_lost_share
        == 0.0
    )
    assert "no cohesion to lose" in " ".join(str(found.sheet).split())
    assert "without the cohesion" not in str(found.sheet)
    bonded = sk.run(columns(5), elastic=True)
    assert bonded.elastic.lost_share == bonded.elastic.opened_share > 0.0
    assert f"without the cohesion of {100.0 * bonded.elastic.lost_share:.2g} %" in " ".join(
        str(bonded.sheet).split()
    )
    assert bonded.elastic.limit == pytest.approx(bonded.elastic.rigid_limit, rel=0.02)
    assert "W455" in [notice.code for notice in bonded.warnings]
    assert (
        bonded.elastic.rigid_limit < bonded.fos.limit < bonded.fos.static_bound * 0.95
    )  # which keeps all of it
    assert bonded.elastic.opened_share == pytest.approx(bonded.elastic.rigid_opened_share, abs=0.05)


def test_columns_do_not_hang_on_what_is_open() -> None:
    """Elastic columns come to rest up to the rigid limit, no farther: springs of open pairs are no contact."""
    design = sk.load(columns(0))
    rigid = sk.analyse(design)
    scene = scene_of_many(design, cut(design), rigid)
    search = RestSearch(scene.model, scene.stiffness)
    last = search.continued(search.rest(1.0), rigid.fos.limit * 0.9997)
    assert last is not None
    assert not search.equilibrium(last, rigid.fos.limit * 1.0003).is_balanced


def test_open_pairs_carry_nothing() -> None:
    design = sk.load(columns(0))
    scene = scene_of_many(design, cut(design), sk.analyse(design))
    found = RestSearch(scene.model, scene.stiffness).rest(1.0)
    assert found.is_balanced
    open_ = found.modes == ContactMode.DEBOND
    assert open_.sum() > 10
    assert not found.forces.reshape(-1, 3)[open_].any()


def test_what_is_refused() -> None:
    assert faults(lambda: sk.run("templates/sphere.yaml", elastic=True)) == ["E288"]
    assert faults(lambda: sk.run("templates/paper-footing.yaml", elastic=True)) == ["E288"]
    rough = {"strength": {"s": {"law": "barton-bandis", "jrc": 8, "jcs": "50 MPa", "phi_r": 25}}}
    assert faults(lambda: sk.run({**PLANE, **rough}, elastic=True)) == ["E288"]
    assert faults(lambda: sk.wedge(**WEDGE | {"edge": "0.5 m"}, elastic=True)) == ["E125"]
    bad = {"modulus": "20 kPa", "poisson": 0.5, "edge": -1}
    assert faults(lambda: sk.wedge(**WEDGE | bad)) == ["E284", "E284", "E284"]
    assert faults(lambda: sk.wedge(**WEDGE, modulus="20 GP")) == ["E108"]
    many = columns(0)
    many["columns"] |= {"heights": [3] * 301, "width": 1}
    design = sk.load(many)
    assert faults(lambda: scene_of_many(design, cut(design), None)) == ["E125"]


def test_without_scikit_fem_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "skfem", None)
    with pytest.raises(DesignError) as caught:
        sk.wedge(**WEDGE, elastic=True)
    (fault,) = caught.value.faults
    assert fault.code == "E140"
    assert "pip install 'slopekit[elastic]'" in str(fault)


def test_a_plain_wedge_loads_nothing_of_it() -> None:
    code = (
        "import sys, slopekit as sk; sk.wedge(('45/115', '45/245')).to_dict();"
        "print([m for m in sys.modules if 'elastic' in m or 'skfem' in m])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_nothing_that_falls_has_elastic_blocks() -> None:
    found = sk.run(PLANE, {"water": "dry", "loads.forces": ["90000@180/-70"]}, elastic=True)
    assert found.status == "lifted"
    assert found.elastic is None
    assert "W450" in [notice.code for notice in found.warnings]


def test_where_no_rest_is_found_it_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("slopekit.elastic.rest.BALANCED", -1.0)  # no balance is good enough
    found = sk.wedge(**WEDGE, elastic=True)
    assert found.elastic is None
    assert "W450" in [notice.code for notice in found.warnings]


def test_moments_that_open_cohesion_and_the_line() -> None:
    """Elastic blocks are held against the rigid limit on their pairs, not against that on the bed."""
    found = sk.wedge(
        ("44.785/86.243", "41.797/34.813"),
        face="87.102/77.401",
        upper="20.153/77.401",
        height=3.98878,
        c=(66.2215, 13.1616),
        phi=(43.0, 47.5),
        unit_weight=28.741,
        shear_stiffness=1e5,
        edge="8 m",
        elastic=True,
    )
    assert f"rigid {found.elastic.rigid_limit:.3f}" in str(found.sheet)
    assert found.elastic.rigid_limit != pytest.approx(found.fos.limit, rel=1e-3)
    assert f"{found.fos.limit:.3f}, elastic {found.elastic.limit:.3f}  " in found.line


def test_the_table_of_cases_has_the_elastic_limit() -> None:
    cases = {"static": {"accept": "fos >= 1.2"}, "quake": {"set": {"loads.seismic.k": 0.1}}}
    design = PLANE | {"cases": cases, "analysis": {"elastic": {"edge": "6 m"}}}
    found = sk.run(design, elastic=True)
    one = found.cases["quake"]
    assert f"{one.elastic.limit:.3f}" in str(found.sheet).split("quake", 1)[1].split("\n", 1)[0]
    assert f"elastic {found.cases[found.governing].elastic.limit:.3f}" in found.line
    assert "elastic" not in str(sk.run(design).sheet)


@pytest.mark.parametrize("given", [{"modulus": "5 GPa"}, {"edge": 4}])
def test_what_is_of_elastic_blocks_alone_is_not_dropped_silently(given) -> None:
    said = {one.code: one.message for one in sk.wedge(dips=("45/115", "45/245"), **given).warnings}
    assert said["W366"].startswith("edge" if "edge" in given else "modulus")
