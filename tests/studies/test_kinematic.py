"""`slopekit kinematic`: against trigonometry joint by joint, the closed forms, and worked examples by hand."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.errors import DesignError, GeometryError
from slopekit.core.orientation import Plane
from slopekit.studies.kinematic import Kinematic, kinematic
from slopekit.studies.kinematic.criteria import (
    DIRECT,
    JOINT_MODES,
    LINE_MODES,
    NO_WEDGE,
    OBLIQUE,
    OBLIQUE_RELEASE,
    PRIMARY_BOTH,
    PRIMARY_ONE,
    RELEASE,
    SECONDARY,
    SLIDING_BASE,
)
from tests.closed_form.scalar_plane import plane_failure
from tests.closed_form.scalar_wedge import hoek_bray_wedge
from tests.commands import slopekit
from tests.geometry.manifold_wedge import wedge_rock_mass

LIST = str(Path(__file__).parents[2] / "examples" / "joints.csv")
FACE = Plane(65, 180)


def survey(seed: int, n: int = 60) -> list[tuple[float, float]]:
    rng = np.random.default_rng(seed)
    return [(float(dip), float(way)) for dip, way in rng.uniform((1.0, 0.0), (89.5, 360.0), (n, 2))]


def refused(**inputs) -> DesignError:
    with pytest.raises(DesignError) as caught:
        sk.kinematic(**({"joints": ["45/115", "45/245"], "face": "65/180"} | inputs))
    return caught.value


# -- a second implementation: angles on the stereonet, one joint after the other ---------------------------------------


def apart(a: float, b: float) -> float:
    return abs((a - b + 180.0) % 360.0 - 180.0)


def apparent(dip: float, off: float) -> float:
    """Apparent dip of a plane so far from its dip direction, negative where it rises."""
    return math.degrees(math.atan(math.tan(math.radians(dip)) * math.cos(math.radians(off))))


def line(one: tuple[float, float], two: tuple[float, float]) -> tuple[float, float]:
    """Trend and plunge of the line of intersection (Wyllie & Mah 2004, eq. 7.1 and 7.2)."""
    (dip_a, way_a), (dip_b, way_b) = (
        [math.radians(angle) for angle in plane] for plane in (one, two)
    )
    up = math.tan(dip_a) * math.cos(way_a) - math.tan(dip_b) * math.cos(way_b)
    down = math.tan(dip_b) * math.sin(way_b) - math.tan(dip_a) * math.sin(way_a)
    trend = math.atan2(up, down)
    plunge = math.atan(math.tan(dip_a) * math.cos(way_a - trend))
    if plunge < 0.0:
        trend, plunge = trend + math.pi, -plunge
    return math.degrees(trend) % 360.0, math.degrees(plunge)


@pytest.mark.parametrize(
    "face", [Plane(65, 180), Plane(80, 10), Plane(40, 287), Plane(90, 359)], ids=str
)
def test_joints_and_lines_as_a_stereonet_has_them(face) -> None:
    """Poles, dip vectors and lines against great circles and small circles, by trigonometry alone."""
    joints, phi, lateral, toppling = survey(3), 32.0, 25.0, 35.0
    found = sk.kinematic(joints, face=face, phi=phi, lateral=lateral, lateral_toppling=toppling)
    for k, (dip, way) in enumerate(joints):
        off = apart(way, face.dip_direction_deg)
        free = dip >= phi and off < 90.0 and dip < apparent(face.dip_deg, off)
        slip, off_pole = face.dip_deg - phi, 180.0 - off
        flexural = off_pole <= toppling and 90.0 - dip <= apparent(slip, off_pole)
        base = 0
        if dip <= face.dip_deg and off <= toppling:
            base = SLIDING_BASE if dip >= phi else RELEASE
        elif dip <= face.dip_deg and off <= 90.0 and dip < phi:
            base = OBLIQUE_RELEASE
        modes = found.modes
        assert (modes.planar_without_limits[k], modes.planar[k]) == (free, free and off <= lateral)
        assert (modes.flexural[k], modes.base[k]) == (flexural, base)
    kinds = set()
    for k, (a, b) in enumerate(zip(found.lines.first, found.lines.second, strict=True)):
        trend, plunge = line(joints[a], joints[b])
        assert apart(trend, found.lines.trend_deg[k]) < 1e-6
        assert plunge == pytest.approx(found.lines.plunge_deg[k], abs=1e-7)
        off = apart(trend, face.dip_direction_deg)
        daylights = off < 90.0 and plunge < apparent(face.dip_deg, off)
        assert (found.modes.wedge[k] in (PRIMARY_BOTH, PRIMARY_ONE)) == (
            daylights and plunge >= phi
        )
        assert found.modes.secondary_of_dips[k] == (
            daylights and plunge < phi and plunge > apparent(phi, off)
        )
        into = 180.0 - off
        column = DIRECT if into <= toppling and plunge >= 90.0 - face.dip_deg else 0
        column = OBLIQUE if toppling < into <= 90.0 and plunge >= 90.0 - phi else column
        assert found.modes.column[k] == column
        kinds |= {int(found.modes.wedge[k]), 10 + column}
    assert kinds >= {NO_WEDGE, PRIMARY_BOTH, 10, 10 + (OBLIQUE if face.dip_deg == 40 else DIRECT)}


def test_by_hand() -> None:
    """Wyllie & Mah's conditions in the section square to the face, where they are sums of angles.

    Face 70°, φ 30°: 70 > 50 > 30 slides, 25 < 30 does not, 75 > 70 does not daylight; (90 - 70) + 30 = 50: layers at
    50° into the slope topple, at 49° they do not. Lines: the joints 60/240 and 60/120 meet at tan ψ = tan 60 cos 60,
    40.89° toward 180; 80/290 and 80/070 dip back at tan ψ = tan 80 cos 70, 62.7° toward 000, steeper than 90 - 70.
    """
    names = {
        "slides": "50/180",
        "flat": "25/180",
        "steep": "75/180",
        "layers": "50/000",
        "flatter": "49/000",
        "left": "60/240",
        "right": "60/120",
        "edge1": "80/290",
        "edge2": "80/070",
    }
    found = sk.kinematic(names, face="70/180", phi=30)
    assert found.joint_names("planar") == ("slides",)
    assert found.joint_names("flexural") == ("layers",)
    assert found.joint_names("base_release") == ("flat",)
    assert found.joint_names("base_sliding") == ("slides",)
    lines = {
        frozenset((list(names)[a], list(names)[b])): k
        for k, (a, b) in enumerate(zip(found.lines.first, found.lines.second, strict=True))
    }
    wedge, edge = lines[frozenset(("left", "right"))], lines[frozenset(("edge1", "edge2"))]
    assert found.lines.plunge_deg[wedge] == pytest.approx(40.8934, abs=1e-4)
    assert found.modes.wedge[wedge] == PRIMARY_BOTH
    assert found.lines.plunge_deg[edge] == pytest.approx(
        math.degrees(math.atan(math.tan(math.radians(80)) * math.cos(math.radians(70))))
    )
    assert found.modes.column[edge] == DIRECT
    assert found.toppling[0]


# -- against the closed forms ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("face_dip", [35.0, 60.0, 90.0])
def test_planes_parallel_to_the_face_daylight_where_the_closed_form_has_a_block(face_dip) -> None:
    """`plane_failure` refuses what does not daylight (E203); c = 0, dry: F <= 1 is the friction cone."""
    joints = [(float(dip), 180.0) for dip in range(5, 90, 5)]
    found = sk.kinematic(joints, face=(face_dip, 180), phi=30)
    assert found.counts["planar"] > 0
    for (dip, _), flagged in zip(joints, found.modes.planar, strict=True):
        if dip < face_dip:
            block = plane_failure(face_dip, 0.0, dip, 10.0, 0.0, 30.0, 26.0, crack_distance_m=None)
            assert flagged == (block.factor <= 1.0 + 1e-12)
            continue
        assert not flagged
        with pytest.raises(GeometryError, match="E203"):
            plane_failure(face_dip, 0.0, dip, 10.0, 0.0, 30.0, 26.0, crack_distance_m=None)


@pytest.mark.slow
@pytest.mark.parametrize("face", [Plane(65, 180), Plane(85, 140)], ids=str)
def test_wedges_against_the_rock_mass_and_the_closed_form(face) -> None:
    """Flat ground: a line daylights where `wedge_corners` finds a wedge. c = 0, dry, two friction angles:

    F <= 1 is exactly `by_friction`; every such wedge is flagged, primary or secondary. A primary line on both joints
    may well have F > 1 (the joints pinch the wedge), on one alone or a secondary it has F <= 1 where that joint dips
    at its friction angle or more: kinematic tests are on the safe side, never off it.
    """
    joints = survey(11, 45)
    phi = np.random.default_rng(5).uniform(20.0, 45.0, len(joints))
    found = measured(joints, phi, face)
    upper = Plane(0, 180)
    seen = dict.fromkeys(("wedges", "pinched", "secondary", "one"), 0)
    for k, (a, b) in enumerate(zip(found.lines.first, found.lines.second, strict=True)):
        planes, kind = (Plane(*joints[a]), Plane(*joints[b])), int(found.modes.wedge[k])
        normals = np.array([plane.normal() for plane in planes])
        try:
            wedge_rock_mass(normals, face.normal(), upper.normal(), 10.0)
        except GeometryError:
            assert kind == NO_WEDGE
            assert not found.modes.by_friction[k]
            continue
        answer = hoek_bray_wedge(planes, face, upper, 10.0, (0, 0), (phi[a], phi[b]), 26.0)
        seen["wedges"] += 1
        assert found.modes.by_friction[k] == (answer.factor <= 1.0)
        assert kind != NO_WEDGE or answer.factor > 1.0
        if kind in (PRIMARY_BOTH, PRIMARY_ONE):
            assert (kind == PRIMARY_BOTH) == (answer.status == "slides_on_both")
            seen["pinched"] += kind == PRIMARY_BOTH and answer.factor > 1.0
            seen["one"] += kind == PRIMARY_ONE
        if kind == SECONDARY:
            seen["secondary"] += 1
            assert answer.status != "slides_on_both"
            assert answer.factor <= 1.0
    assert seen["wedges"] > 150
    assert min(seen.values()) >= 3


def measured(joints, phi, face) -> Kinematic:
    """A survey whose joints have friction angles of their own."""
    from slopekit.design.survey import MeasuredJoint

    listed = [
        MeasuredJoint(f"J{k}", Plane(*plane), k, None, float(angle))
        for k, (plane, angle) in enumerate(zip(joints, phi, strict=True))
    ]
    return kinematic(listed, face=face)


@pytest.mark.parametrize(
    "joints", [("45/115", "45/245"), ("60/130", "50/215"), ("55/150", "70/220")]
)
def test_friction_fails_where_the_factor_of_safety_falls_below_one(joints) -> None:
    """Both joints of one friction angle: F is proportional to tan φ, so that F = 1 at a φ known from any other."""
    one, two = (Plane(*map(float, joint.split("/"))) for joint in joints)
    at_45 = hoek_bray_wedge((one, two), FACE, Plane(0, 180), 10.0, (0, 0), (45, 45), 26.0).factor
    limit = math.degrees(math.atan(1.0 / at_45))
    for phi, fails in ((limit - 1e-4, True), (limit + 1e-4, False)):
        assert sk.kinematic(joints, face=FACE, phi=phi).modes.by_friction.tolist() == [fails]


def test_a_joint_that_strikes_with_the_face_releases_a_block_that_has_no_end() -> None:
    """The rock mass refuses it (E206: no corner), the test of the stereonet does not: it slides as its plane would."""
    found = sk.kinematic(["45/180", "80/250", "25/180"], face="65/180", phi=30)
    assert found.modes.wedge.tolist() == [
        PRIMARY_ONE,
        NO_WEDGE,
        NO_WEDGE,
    ]  # 45/180 and 25/180 meet in a level line
    assert found.modes.by_friction.tolist() == [True, False, False]


# -- limits ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("way", [0.0, 77.0, 180.0, 303.0])
def test_limits_are_met_where_they_are_reached(way) -> None:
    """A joint at the friction angle or at the lateral limit counts; one parallel to the face does not daylight."""
    off = (way + 20.0) % 360.0
    planes = {
        "friction": (30.0, way),
        "limit": (45.0, off),
        "face": (65.0, way),
        "layers": (55.0, (way + 180.0) % 360.0),
        "vertical": (90.0, way),
        "level": (0.0, (way + 130.0) % 360.0),
    }
    found = sk.kinematic(planes, face=(65, way), phi=30)
    assert found.joint_names("planar") == ("friction", "limit")
    assert found.joint_names("flexural") == ("layers", "vertical")
    assert found.joint_names("base_release") == ("level",)
    assert found.joint_names("base_sliding") == ("friction", "limit", "face")
    closer = sk.kinematic(planes, face=(65, way), phi=30 + 1e-6, lateral=20 - 1e-6)
    assert closer.joint_names("planar") == ()
    assert closer.joint_names("flexural") == ("vertical",)


def test_vertical_edges_and_parallel_joints() -> None:
    found = sk.kinematic(
        {"a": "90/030", "b": "90/140", "b again": "90/320", "c": "15/200"}, face="65/180"
    )
    assert len(found.lines.first) == 5  # b and b again are one plane
    columns = dict(
        zip(
            zip(found.lines.first, found.lines.second, strict=True), found.modes.column, strict=True
        )
    )
    assert columns[0, 1] == DIRECT
    assert found.to_dict()["pairs"] - found.to_dict()["intersections"] == 1


def test_counts_by_set_add_up(tmp_path) -> None:
    rows = [
        f"N{k},{'AB'[k % 2] if k % 5 else ''},{dip:.1f},{way:.1f}"
        for k, (dip, way) in enumerate(survey(6, 30))
    ]
    (tmp_path / "joints.csv").write_text("name,set,dip,dip_direction\n" + "\n".join(rows))
    found = sk.kinematic(tmp_path / "joints.csv", face="70/180")
    assert set(found.by_set()) == {"A", "B", ""}
    assert sum(counts["joints"] for counts in found.by_set().values()) == 30
    for kind in JOINT_MODES:
        assert sum(counts[kind] for counts in found.by_set().values()) == found.counts[kind]
    for kind in LINE_MODES:
        assert sum(counts[kind] for counts in found.by_set_pair().values()) == found.counts[kind]
    assert sum(counts["lines"] for counts in found.by_set_pair().values()) == 435
    assert "A x single" in str(found)
    rows = {name: len(table.rows) for name, table in found.tables().items()}
    assert rows == {
        "joints": 30,
        "intersections": 435,
        "sets": 3,
        "sets_2": len(found.by_set_pair()),
    }
    assert sk.kinematic(survey(6), face="70/180").by_set() == {}


# -- what is said ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("code", "inputs", "says"),
    [
        ("E143", {"face": None}, "face is missing"),
        ("E101", {"face": "95/180"}, "dip of face is 95"),
        ("E103", {"joints": ["115/45"]}, "J1 is 115/45: dip and dip direction look swapped"),
        ("E113", {"phi": 0.5}, "phi is 0.5°, that looks like radians"),
        ("E115", {"phi": 95}, "phi is 95°"),
        ("E107", {"lateral": "20 m"}, "lateral has the unit m"),
        (
            "E125",
            {"joints": np.full((100_001, 2), 45.0)},
            "joints holds 100001 joints: more than 100000 joints",
        ),
        ("E307", {"lateral": 95}, "lateral is 95°, it lies between 0 and 90"),
        ("E307", {"lateral_toppling": -5}, "lateral toppling is -5°, it lies between 0 and 90"),
        ("E405", {"joints": 5}, "joints are int"),
        ("E405", {"joints": []}, "there are no joints"),
    ],
)
def test_faults(code, inputs, says) -> None:
    error = refused(**inputs)
    assert error.codes == (code,)
    assert says in error.faults[0].message


def test_all_faults_at_once(tmp_path) -> None:
    (tmp_path / "joints.csv").write_text("dip,dd\n195,115\n45,x\n")
    codes = refused(joints=tmp_path / "joints.csv", face="65-180", phi=-1, lateral=99).codes
    assert codes == ("E101", "E104", "E104", "E115", "E307")
    with pytest.raises(DesignError) as caught:
        kinematic([Plane(45, 115), "x", (45, 500)], face="65/180")
    assert caught.value.codes == ("E104", "E102")
    (swapped,) = refused(
        joints=[f"{190 + k % 7}/76" for k in range(1500)]
    ).faults  # 1,500 were said
    assert swapped.code == "E103"
    assert swapped.message.endswith("look swapped, and 1499 rows more like it")


def test_notices(tmp_path) -> None:
    good = "".join(f"D{k},45,245,,25,\n" for k in range(8))
    content = f"name,dip,dip_direction,c,phi,remark\nA,45,115,10,20,x\nB,45,245,,25,\nC,195,200,,,\n{good}"
    (tmp_path / "joints.csv").write_text(content)
    found = sk.kinematic(tmp_path / "joints.csv", face="15/180", skip_bad=True)
    said = {notice.code: notice.message for notice in found.warnings}
    assert set(said) == {"W366", "W369"}
    assert any("line 4 (E101 dip of C is 195" in notice.message for notice in found.warnings)
    assert said["W366"].startswith("the cohesion of the list is left out")
    assert "no steeper than friction" in said["W369"]
    assert refused(joints=tmp_path / "joints.csv").codes == ("E101",)
    assert sk.kinematic(["45/115"], face="65/180").warnings == ()


def test_json_sheet_and_tables() -> None:
    found = sk.kinematic(survey(4), face="65/180")
    document = json.loads(json.dumps(found.to_dict(), allow_nan=False))
    assert document["counts"] == found.counts
    assert document["percent"]["planar"] == pytest.approx(100 * found.counts["planar"] / 60)
    assert document["percent"]["wedge"] == pytest.approx(100 * found.counts["wedge"] / 1770)
    assert document["defaults"] == ["lateral", "lateral_toppling", "phi"]
    sheet = str(found)
    assert max(map(len, sheet.splitlines())) <= 100
    assert f"friction alone does not hold {found.counts['wedge_by_friction']}" in " ".join(
        sheet.split()
    )
    assert found.line.startswith(f"planar {found.counts['planar']}  wedge ")
    joints, lines = (
        found.sheet.tables[f"{name}.csv"].csv().splitlines() for name in ("joints", "intersections")
    )
    assert (len(joints), len(lines)) == (61, 1771)
    assert sum(row.split(",")[4] != "" for row in lines[1:]) == found.counts["wedge"]
    assert sum(int(row.split(",")[5]) for row in joints[1:]) == found.counts["planar"]
    alone = sk.kinematic(["45/115"], face="65/180")
    assert alone.to_dict()["percent"]["wedge"] is None
    assert "not possible: there are no edges" in str(alone)


@pytest.mark.slow
def test_the_command(tmp_path) -> None:
    folder = tmp_path / "out"
    run = slopekit("kinematic", LIST, "--face", "65/180", "-o", str(folder))
    assert (run.returncode, run.stderr) == (0, "")
    assert {path.name for path in folder.iterdir()} == {
        "kinematic.json",
        "kinematic.txt",
        "joints.csv",
        "intersections.csv",
        "stereonet.png",
    }
    full = (folder / "kinematic.txt").read_text().splitlines()
    sheet = [line.partition("   sha ")[0] for line in full if not line.startswith("TIME ")]
    assert sheet == run.stdout.splitlines()
    assert any(line.startswith("TIME ") for line in full)
    wrong = slopekit("kinematic", LIST, "--lateral", "99", "--json")
    assert wrong.returncode == 2
    assert [fault["code"] for fault in json.loads(wrong.stdout)["errors"]] == ["E143", "E307"]
    assert "--lateral 99" in wrong.stderr


# -- many joints --------------------------------------------------------------------------------------------------


def test_of_many_joints_pairs_are_drawn_and_said(monkeypatch) -> None:
    """The shares among the pairs drawn lie within four standard errors of those among all pairs."""
    from slopekit.studies.kinematic import criteria

    every = sk.kinematic(survey(1, 400), face="70/180", phi=30)
    monkeypatch.setattr(criteria, "MAX_PAIRS", 1000)
    monkeypatch.setattr(criteria, "DRAWN_PAIRS", 20_000)
    found, again = (sk.kinematic(survey(1, 400), face="70/180", phi=30) for _ in range(2))
    assert (found.pairs, len(found.lines.first), every.is_sample) == (20_000, 20_000, False)
    assert (
        len(set(zip(found.lines.first.tolist(), found.lines.second.tolist(), strict=True)))
        == 20_000
    )
    for kind in ("wedge_primary", "wedge_by_friction", "direct", "oblique"):
        share = every.percent[kind] / 100.0
        error = 4.0 * math.sqrt(share * (1.0 - share) / found.pairs)
        assert found.percent[kind] / 100.0 == pytest.approx(share, abs=error)
    assert found.counts["planar"] == every.counts["planar"]
    assert again.input_hash() == found.input_hash()
    assert again.counts == found.counts
    document = found.to_dict()
    assert (document["pairs"], document["drawn_pairs"], document["inputs"]["seed"]) == (
        79_800,
        20_000,
        1,
    )
    assert "79800 pairs, 20000 of them drawn at random (seed 1)" in " ".join(str(found).split())
    assert "drawn_pairs" not in every.to_dict()


@pytest.mark.slow
def test_the_list_of_a_pit(tmp_path) -> None:
    """A list of more than 5 MB, every joint tested, a million pairs drawn; combos ranks every pair, and takes fewer."""
    rows = (f"{k},{'seen from the haul road ' * 50},{40 + k % 50},{k % 360}" for k in range(4500))
    path = tmp_path / "pit.csv"
    path.write_text("id,remark,dip,dip_direction\n" + "\n".join(rows), encoding="utf-8")
    assert path.stat().st_size > 5_000_000
    found = sk.kinematic(path, face="75/180", phi=30)
    assert (len(found.joints), found.pairs) == (4500, 1_000_000)
    with pytest.raises(DesignError) as caught:
        sk.combos(path, face="75/180", c=0, phi=30)
    assert caught.value.codes == ("E125",)
