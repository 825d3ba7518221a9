"""Bench design: probabilities against every pair one by one, berms and angles against a few lines of their own.

Independent sources: `scalar_wedge` and manifold's cut for wedges, the formula of Hoek & Bray for planes, columns
weighed by hand; scipy for Wilson's limits; surveys really drawn again for the bootstrap.
"""

import json
import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.errors import DesignError, GeometryError
from slopekit.core.orientation import Plane
from slopekit.design.joint_lists import joint_list
from slopekit.kinds import factors_of
from slopekit.studies import joint_wedges
from slopekit.studies.bench_design import limits
from slopekit.studies.bench_design.bench import PLANE, WEDGE, Bench, bench_of, closed_form_modes
from slopekit.studies.bench_design.inputs import BenchInputs
from slopekit.studies.bench_design.outcomes import place_lengths, quantiles, stretch_volumes
from slopekit.studies.bench_design.run import notices_of, with_acceptance
from slopekit.studies.bench_design.trials import Trials, bootstrapped_shares, drawn_trials, wilson
from slopekit.studies.points import falls_short
from slopekit.studies.protocol import DESK
from slopekit.studies.running import checked_crew
from slopekit.views.pages.report import report_of
from slopekit.views.plots import draw
from tests.closed_form.scalar_wedge import hoek_bray_wedge
from tests.commands import slopekit
from tests.geometry.manifold_wedge import cut_wedge, wedge_rock_mass

HEIGHT, FACE, TOWARD = 12.0, 75.0, 180.0
COHESION, FRICTION, UNIT_WEIGHT = 4.0, 32.0, 26.0
SPACING = 1.5
JOINTS = (
    "52/140",
    "58/150",
    "47/128",
    "61/222",
    "55/232",
    "66/215",
    "44/178",
    "52/186",
    "38/170",
    "78/004",
    "82/352",
    "18/175",
    "25/182",
    "35/060",
)
WEIGHTS = np.array([1, 3, 1, 2, 1, 1, 2, 1, 1, 2, 1, 4, 1, 1], dtype=float)


def ground(planes: Any = JOINTS, toe: str = "bench", **other: Any) -> BenchInputs:
    """What all benches share, with the values above; arrays of the joints among others in place of its own."""
    arrays = {name: other.pop(name) for name in ("trace_m", "spacing_m") if name in other}
    asked = sk.bench_design(
        list(planes),
        height=HEIGHT,
        face=FACE,
        dip_direction=TOWARD,
        c=COHESION,
        phi=FRICTION,
        spacing=SPACING,
        unit_weight=UNIT_WEIGHT,
        every=5,
        toe=toe,
        n=100,
        **other,
    )
    return replace(asked.given, **arrays)


def closed_bench(asked: BenchInputs, trials: Trials, height: float, face: float) -> Bench:
    """A bench by the closed forms alone."""
    return bench_of(height, face, closed_form_modes(asked, trials, height, face))


def every_pair(n: int) -> Iterator[tuple[int, int]]:
    return ((a, b) for a in range(n) for b in range(n) if a != b)


def wedge_by_hand(a: Plane, b: Plane, height: float) -> tuple[bool, bool, float, float]:
    """Forms, fails, setback and volume of a wedge, by the scalar closed form and the cut body."""
    face, upper = Plane(FACE, TOWARD), Plane(0.0, TOWARD)
    try:
        found = hoek_bray_wedge(
            (a, b), face, upper, height, (COHESION, COHESION), (FRICTION, FRICTION), UNIT_WEIGHT
        )
        rock = wedge_rock_mass(
            np.array([a.normal(), b.normal()]), face.normal(), upper.normal(), height
        )
        block = cut_wedge(rock)
    except GeometryError:
        return False, False, 0.0, 0.0
    fails = found.factor < 1.0 if found.factor is not None else found.status in ("lifted", "falls")
    crest = -height / math.tan(
        math.radians(FACE)
    )  # the face dips to the south: into the rock is north
    return True, fails, float(block.corners[:, 1].max()) + crest, block.volume


def plane_by_hand(a: Plane, height: float) -> tuple[bool, bool, float, float]:
    """Of a block on a plane, per metre: F = (c L + W cos ψ tan φ) / (W sin ψ)."""
    if (
        not (0.0 < a.dip_deg < FACE)
        or abs((a.dip_direction_deg - TOWARD + 180.0) % 360.0 - 180.0) > 20.0
    ):
        return False, False, 0.0, 0.0
    dip, face = math.radians(a.dip_deg), math.radians(FACE)
    setback = height * (1.0 / math.tan(dip) - 1.0 / math.tan(face))
    weight, length = UNIT_WEIGHT * height * setback / 2.0, height / math.sin(dip)
    factor = (COHESION * length + weight * math.cos(dip) * math.tan(math.radians(FRICTION))) / (
        weight * math.sin(dip)
    )
    return True, factor < 1.0, setback, height * setback / 2.0


def columns_by_hand(steep: Plane, base: Plane, height: float) -> tuple[bool, bool]:
    """Whether columns form, and whether the first of them leans beyond its toe: by the centroid of a parallelogram."""
    into = abs((steep.dip_direction_deg - TOWARD) % 360.0 - 180.0)  # from the way into the slope
    beside = 180.0 - abs((base.dip_direction_deg - TOWARD) % 360.0 - 180.0)
    slips = steep.dip_deg >= 90.0 - FACE + FRICTION
    if max(into, beside) > 30.0 or not slips or not 0.0 < base.dip_deg < FACE:
        return False, False
    side, climb = math.radians(steep.dip_deg), math.tan(math.radians(base.dip_deg))
    crest = height / math.tan(math.radians(FACE))
    deep = (height - crest * climb) / (1.0 + climb / math.tan(side))
    lean = deep / math.tan(side)  # how far the top overhangs the foot
    run = (
        SPACING / math.sin(side + math.radians(base.dip_deg)) * math.cos(math.radians(base.dip_deg))
    )
    return deep > 0.0, deep > 0.0 and run < lean


def test_probabilities_against_every_pair() -> None:
    """20000 places in a bench against all pairs with their weights: shares within four standard deviations."""
    planes = [joint.plane for joint in joint_list(list(JOINTS)).joints]
    chance = {(a, b): WEIGHTS[a] * WEIGHTS[b] for a, b in every_pair(len(planes))}
    whole = sum(chance.values())
    expected = dict.fromkeys(
        ("wedge", "wedge fails", "plane", "plane fails", "toppling", "toppling fails", "any"), 0.0
    )
    lost = 0.0
    for (a, b), often in chance.items():
        wedge = wedge_by_hand(planes[a], planes[b], HEIGHT)
        plane = plane_by_hand(planes[a], HEIGHT)
        one, other = (
            columns_by_hand(planes[a], planes[b], HEIGHT),
            columns_by_hand(planes[b], planes[a], HEIGHT),
        )
        column = one if one[0] else other
        for name, is_so in zip(
            expected,
            (wedge[0], wedge[1], plane[0], plane[1], *column, wedge[1] or plane[1] or column[1]),
            strict=True,
        ):
            expected[name] += often / whole * is_so
        if not column[1]:
            lost += often / whole * max(wedge[2] * wedge[1], plane[2] * plane[1])
    joints = joint_list(list(JOINTS))
    weighed = replace(
        joints,
        joints=tuple(
            replace(one, quantity=w) for one, w in zip(joints.joints, WEIGHTS, strict=True)
        ),
    )
    count = 20_000
    bench = closed_bench(ground(), drawn_trials(weighed, count, 3, anywhere=False), HEIGHT, FACE)
    found = {
        "wedge": bench.forms[0],
        "wedge fails": bench.fails[0],
        "plane": bench.forms[1],
        "plane fails": bench.fails[1],
        "toppling": bench.forms[2],
        "toppling fails": bench.fails[2],
        "any": bench.fails.any(axis=0),
    }
    for name, share in expected.items():
        assert 0.0 < share < 1.0, name
        assert found[name].mean() == pytest.approx(
            share, abs=4.0 * math.sqrt(share * (1.0 - share) / count)
        ), name
    slid = np.where(bench.fails[2], 0.0, bench.setback_m)
    assert slid.mean() == pytest.approx(lost, abs=4.0 * slid.std() / math.sqrt(count))


@pytest.mark.parametrize("height", [6.0, 12.0])
def test_one_place_at_a_time(height: float) -> None:
    """Setback and volume of the block that takes most, pair by pair."""
    planes = [joint.plane for joint in joint_list(list(JOINTS)).joints]
    pairs = list(every_pair(len(planes)))
    first, second = (np.array(side) for side in zip(*pairs, strict=True))
    no_spacing = ground(spacing_m=np.full(len(planes), np.nan))
    bench = closed_bench(no_spacing, Trials(first, second, np.zeros(len(pairs))), height, FACE)
    for k, (a, b) in enumerate(pairs):
        wedge, plane = wedge_by_hand(planes[a], planes[b], height), plane_by_hand(planes[a], height)
        fails = [
            part
            for part in ((wedge[2], wedge[3], wedge[1]), (plane[2], plane[3] * 5.0, plane[1]))
            if part[2]
        ]
        setback, volume, _ = max(fails, default=(0.0, 0.0, False))
        assert bench.setback_m[k] == pytest.approx(setback, rel=1e-9, abs=1e-12)
        assert bench.volume_m3[k] == pytest.approx(volume, rel=1e-9, abs=1e-12)
    assert not bench.fails[2].any()  # no spacing, no width: columns are not judged


def test_toe_anywhere_is_a_smaller_bench() -> None:
    """A block whose toe lies at a third of the face is that of a bench of two thirds of the height."""
    one, two = np.array([0, 6, 9]), np.array([4, 3, 11])
    raised = closed_bench(
        ground(toe="anywhere"), Trials(one, two, np.full(3, 1.0 / 3.0)), 15.0, FACE
    )
    low = closed_bench(ground(), Trials(one, two, np.zeros(3)), 10.0, FACE)
    np.testing.assert_allclose(raised.setback_m, low.setback_m, rtol=1e-12)
    np.testing.assert_allclose(raised.factor, low.factor, rtol=1e-12)
    np.testing.assert_allclose(raised.volume_m3, low.volume_m3, rtol=1e-12)


def test_short_joints() -> None:
    """Anywhere: too short a joint forms nothing. Largest: the block shrinks until the joint just carries it."""
    one, two = np.array([0]), np.array([4])
    at_toe, n = Trials(one, two, np.zeros(1)), len(JOINTS)
    whole = closed_bench(ground(), at_toe, HEIGHT, FACE)
    assert whole.forms[0, 0]
    short = np.full(n, 6.0)
    assert not closed_bench(ground(toe="anywhere", trace_m=short), at_toe, HEIGHT, FACE).forms[0, 0]
    shrunk = closed_bench(ground(trace_m=short), at_toe, HEIGHT, FACE)
    scale = shrunk.block_height_m[0, 0] / HEIGHT
    normals = [Plane.normal(joint.plane) for joint in joint_list([JOINTS[0], JOINTS[4]]).joints]
    rock = wedge_rock_mass(
        np.array(normals), Plane(FACE, TOWARD).normal(), Plane(0.0, TOWARD).normal(), HEIGHT * scale
    )
    toe, back, crest1, crest2 = rock.corners
    edges = [
        math.dist(p, q)
        for p, q in ((toe, back), (toe, crest1), (toe, crest2), (back, crest1), (back, crest2))
    ]
    assert max(edges) == pytest.approx(6.0, rel=1e-9)
    assert (
        closed_bench(ground(trace_m=np.full(n, 1e3)), at_toe, HEIGHT, FACE).block_height_m[0, 0]
        == HEIGHT
    )


@pytest.mark.parametrize(
    ("steep", "base", "forms"),
    [
        ("47.1/000", "20/180", True),
        ("46.9/000", "20/180", False),  # (90 - 75) + 32 = 47
        ("80/029.9", "20/180", True),
        ("80/030.1", "20/180", False),
        ("80/000", "20/150.1", True),
        ("80/000", "20/149.9", False),
        ("80/000", "20/000", False),
        ("80/000", "76/180", False),
    ],
)
def test_where_columns_form(steep: str, base: str, forms: bool) -> None:
    """At the limits of slip and of direction, either joint first."""
    both = Trials(np.array([0, 1]), np.array([1, 0]), np.zeros(2))
    assert closed_bench(ground((steep, base)), both, HEIGHT, FACE).forms[2].tolist() == [
        forms,
        forms,
    ]


def test_water_and_earthquake_do_not_help() -> None:
    """More fails under water and in an earthquake; what formed still forms."""
    joints = joint_list(list(JOINTS))
    trials = drawn_trials(joints, 2000, 1, anywhere=True)
    dry, wet, shaken = (
        closed_bench(ground(toe="anywhere", **load), trials, 15.0, FACE)
        for load in ({}, {"water": "full"}, {"seismic": 0.15})
    )
    for other in (wet, shaken):
        np.testing.assert_array_equal(other.forms, dry.forms)
        assert (other.fails >= dry.fails).all()
        assert other.fails.sum() > dry.fails.sum()


def test_places_along_a_bench() -> None:
    """Four places of 40 m, one of which loses 70 m: they fill 190 m, one whole stretch of 100 m."""
    n = 4
    failed = np.array([-1, 0, -1, -1])
    values = np.array([0.0, 500.0, 0.0, 0.0])
    nothing = np.zeros((3, n))
    bench = Bench(
        10.0,
        70.0,
        nothing > 0,
        nothing > 0,
        nothing,
        nothing,
        failed,
        values / 100.0,
        values,
        values,
        np.array([0.0, 70.0, 0.0, 0.0]),
    )
    steps = place_lengths(bench, 40.0)
    assert steps.tolist() == [40.0, 70.0, 40.0, 40.0]
    volumes, lost = stretch_volumes(bench, steps)
    assert volumes.tolist() == [500.0]
    assert lost == pytest.approx(70.0 / 190.0)


def test_quantiles_by_length() -> None:
    """A value that stands for three metres is three values of one metre."""
    values, weights = np.array([4.0, 0.0, 2.0]), np.array([3.0, 5.0, 2.0])
    spread = np.repeat(values, weights.astype(int))
    for share in (0.0, 0.3, 0.5, 0.51, 0.7, 0.71, 1.0):
        at = max(1, math.ceil(share * len(spread) - 1e-9))
        assert quantiles(values, [share], weights) == [np.sort(spread)[at - 1]]


@pytest.mark.parametrize(("count", "of"), [(0, 50), (3, 50), (25, 50), (50, 50)])
def test_wilson_against_scipy(count: int, of: int) -> None:
    """Limits of Wilson (1927)."""
    from scipy.stats import binomtest

    expected = binomtest(count, of).proportion_ci(method="wilson")
    assert wilson(count, of) == pytest.approx((expected.low, expected.high), abs=1e-12)


def test_bootstrap_against_surveys_drawn_again() -> None:
    """The scatter of shares with weighed trials is that of surveys really drawn again, all their pairs counted."""
    joints = joint_list(list(JOINTS))
    n = len(joints)
    trials = drawn_trials(joints, 20_000, 5, anywhere=False)
    bench = closed_bench(ground(), trials, HEIGHT, FACE)
    shares = bootstrapped_shares(joints, trials, bench.fails.any(axis=0)[:, None].astype(float), 1)[
        :, 0
    ]
    pairs = np.array(list(every_pair(n)))
    whole = closed_bench(
        ground(), Trials(pairs[:, 0], pairs[:, 1], np.zeros(len(pairs))), HEIGHT, FACE
    )
    table = np.zeros((n, n))
    table[pairs[:, 0], pairs[:, 1]] = whole.fails.any(axis=0)
    rng, drawn = np.random.default_rng(9), []
    for _ in range(2000):
        often = np.bincount(rng.integers(0, n, n), minlength=n).astype(float)
        each = np.outer(often, often)
        np.fill_diagonal(each, 0.0)
        drawn.append((each * table).sum() / each.sum())
    assert shares.mean() == pytest.approx(np.mean(drawn), abs=0.03)
    assert shares.std() == pytest.approx(
        np.std(drawn), rel=0.2
    )  # 200 surveys: 5 % of their own, twice that is rare


@pytest.fixture(scope="module")
def found() -> Any:
    return sk.bench_design(
        list(JOINTS),
        height=[10, 15],
        face="60:80:3",
        dip_direction=180,
        berm=[6, 12],
        c=4,
        phi=32,
        spacing=1.5,
        n=500,
        unit_weight=26,
        accept=0.5,
    )


def test_berms_and_angles(found: Any) -> None:
    """Catch width, berm needed and angles of every bench, recomputed."""
    assert len(found.benches) == 6
    for bench in found.benches:
        height, run = bench.height_m, bench.height_m / math.tan(math.radians(bench.face_dip_deg))
        catch = 0.2 * height + 4.5
        assert bench.catch_width_m == pytest.approx(catch, rel=1e-12)
        assert bench.berm_needed_m == pytest.approx(
            catch + bench.backbreak["quantiles"][0.8], rel=1e-12
        )
        angle = math.degrees(math.atan(height / (run + bench.berm_needed_m)))
        assert bench.inter_ramp_deg == pytest.approx(angle, rel=1e-12)
        left = math.degrees(math.atan(height / (run + bench.backbreak["quantiles"][0.8])))
        assert bench.effective_face_deg == pytest.approx(left, rel=1e-12)
        for berm in bench.berms:
            at_most = berm.berm_m - catch  # the curve says how much of the length loses no more
            below = (
                sum(value <= at_most + 1e-9 for value in bench.curve_m) - 1 if at_most >= 0.0 else 0
            )
            assert 100.0 * berm.reliability.share == pytest.approx(max(below, 0), abs=1.01)
            assert berm.inter_ramp_deg == pytest.approx(
                math.degrees(math.atan(height / (run + berm.berm_m))), rel=1e-12
            )
            assert berm.reliability.low <= berm.reliability.share <= berm.reliability.high
    assert found.best.inter_ramp_deg == max(bench.inter_ramp_deg for bench in found.benches)


def test_a_higher_reliability_needs_a_wider_berm() -> None:
    """The berm needed for itself reaches what it is needed for, and no less."""
    common: dict[str, Any] = {
        "height": 15,
        "face": 80,
        "dip_direction": 180,
        "c": 0,
        "phi": 30,
        "n": 1000,
    }
    needed = []
    for wanted in (0.6, 0.8, 0.95):
        own = sk.bench_design(list(JOINTS), reliability=wanted, **common)
        (bench,) = own.benches
        assert bench.berms[0].berm_m == bench.berm_needed_m
        assert bench.berms[0].reliability.share >= wanted
        needed.append(bench.berm_needed_m)
    assert needed == sorted(needed)
    assert needed[0] < needed[-1]


def test_pre_ie_agrees(found: Any) -> None:
    """On the forces of all blocks that stand by the closed form."""
    said = found.both
    assert said.agree + said.not_compared == said.looked_at > 500
    assert (said.disagree, said.without_answer, said.safe) == (0, 0, 0)
    assert said.largest < 1e-6
    assert f"PRE-IE agrees on {said.agree} of {said.looked_at}" in found.line
    assert found.exit_code == (0 if found.accepted else 1)
    met = [berm for berm in found.berms if berm.accepted]
    steepest = found.steepest_accepted
    assert (steepest is None) == (not met)
    assert steepest is None or steepest.inter_ramp_deg == max(berm.inter_ramp_deg for berm in met)
    assert ("steepest of these" in str(found)) == ("steepest accepted: " in found.line) == bool(met)


def test_json_page_and_pictures(found: Any, tmp_path: Path) -> None:
    """The JSON is JSON, has what a chart needs, and makes a page."""
    document = json.loads(json.dumps(found.to_dict(), allow_nan=False))
    bench = document["benches"][0]
    assert set(bench["probability"]) == {"wedge", "plane", "toppling", "any"}
    assert bench["reliability"][0]["reliability"]["of"] == 500
    assert document["best"]["berm_needed_m"] == found.best.berm_needed_m
    for what in found.charts:
        draw(document, what, tmp_path / f"{what}.png")
        assert (tmp_path / f"{what}.png").stat().st_size > 10_000
    assert "Bench design" in report_of(document, with_pictures=False).html
    assert found.sheet.tables["berms.csv"].csv().count("\n") == 13
    assert max(map(len, str(found).splitlines())) <= 100


def test_the_same_seed_gives_the_same(found: Any) -> None:
    """And another seed others, within their limits."""
    common: dict[str, Any] = {
        "height": 15,
        "face": 70,
        "dip_direction": 180,
        "c": 4,
        "phi": 32,
        "spacing": 1.5,
        "n": 300,
    }
    one, again, other = (sk.bench_design(list(JOINTS), seed=seed, **common) for seed in (1, 1, 2))
    assert one.benches == again.benches
    assert one.benches != other.benches
    share = one.benches[0].modes["any"]["fails"]
    assert share.low <= other.benches[0].modes["any"]["fails"].share <= share.high


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"height": None}, "E143"),
        ({"face": None}, "E143"),
        ({"dip_direction": None}, "E143"),
        ({"phi": None}, "E143"),
        ({"height": "0"}, "E116"),
        ({"height": "10kPa"}, "E107"),
        ({"face": "60:95:+5"}, "E101"),
        ({"berm": -1}, "E116"),
        ({"face": "60:80"}, "E312"),
        ({"reliability": "80"}, "E307"),
        ({"n": 10}, "E307"),
        ({"n": 150.5}, "E307"),
        ({"trace": 0}, "E116"),
        ({"repose": 80}, "E307"),
        ({"swell": 0.9}, "E307"),
        ({"lateral": 95}, "E307"),
        ({"n": 200_000, "height": "1:100:100"}, "E125"),
        ({"seismic": "0.1@090"}, "E122"),
        ({"toe": "crest"}, "E126"),
        ({"dip_direction": 400}, "E102"),
        ({"c": "5,6"}, "E109"),
        ({"water": "wet"}, "E"),
    ],
)
def test_bad_input(change: dict[str, Any], code: str) -> None:
    """Each with its code, and more than one at once."""
    given: dict[str, Any] = {
        "height": 10,
        "face": "65,75",
        "dip_direction": 180,
        "c": 5,
        "phi": 30,
        "n": 100,
    }
    with pytest.raises(DesignError) as refused:
        sk.bench_design(list(JOINTS), **(given | change | {"accept": 2}))
    codes = [fault.code for fault in refused.value.faults]
    assert any(one.startswith(code) for one in codes)
    assert any("accept" in fault.message for fault in refused.value.faults)


def test_command(tmp_path: Path) -> None:
    """Exit codes, files, notices."""
    survey = tmp_path / "few.csv"
    survey.write_text(
        "dip,dip_direction\n" + "\n".join(plane.replace("/", ",") for plane in JOINTS) + "\n"
    )
    words = [
        "bench-design",
        str(survey),
        "--height",
        "15",
        "--face",
        "75",
        "--dip-direction",
        "180",
        "--berm",
        "6,14",
        "--c",
        "0",
        "--phi",
        "30",
        "-n",
        "500",
    ]
    ran = slopekit(*words, "-o", str(tmp_path / "out"))
    assert ran.returncode == 0, ran.stderr
    assert {"W390", "W391", "W394"} <= set(ran.stdout.split())
    names = {path.name for path in (tmp_path / "out").iterdir()}
    pictures = {"backbreak.png"}
    assert names == {"bench-design.json", "bench-design.txt", "benches.csv", "berms.csv"} | pictures
    assert slopekit(*words, "--quiet", "--accept", "99%").returncode == 1
    refused = slopekit(*words, "--every", "0")
    assert (refused.returncode, refused.stderr[:4]) == (2, "E116")


def test_what_has_to_be_said(found: Any) -> None:
    """W395 where columns form under water; W353 where PRE-IE alone lets a block fail."""
    wet = sk.bench_design(
        list(JOINTS),
        height=10,
        face=75,
        dip_direction=180,
        c=4,
        phi=32,
        spacing=1.5,
        water="full",
        n=100,
    )
    assert "W395" in [notice.code for notice in wet.warnings]
    codes = [
        notice.code
        for notice in notices_of(found.given, found.benches, replace(found.both, unsafe=2))
    ]
    assert "W353" in codes


@pytest.mark.parametrize(("low", "is_accepted"), [(0.81, True), (0.79, False)])
def test_the_lower_limit_is_accepted_or_not(found: Any, low: float, is_accepted: bool) -> None:
    asked = replace(found.given, numbers={**found.given.numbers, "accept": 0.8})
    bench = found.benches[0]
    berms = tuple(
        replace(berm, reliability=replace(berm.reliability, low=low)) for berm in bench.berms
    )
    assert {
        berm.accepted for berm in with_acceptance(asked, replace(bench, berms=berms), True).berms
    } == {is_accepted}
    assert {
        berm.accepted for berm in with_acceptance(asked, replace(bench, berms=berms), False).berms
    } == {False}


def block_of(asked: BenchInputs, mode: int, planes: list[str], height: float) -> Any:
    """One block of a bench as a file of its own; a plane in the section, as the closed form has it."""
    names, seismic = (
        ["J1", "J2"][: len(planes)],
        {"k": asked.slope.seismic.coefficient, "toward": TOWARD},
    )
    return sk.load(
        {
            "slopekit": 1,
            "kind": ("wedge", "plane")[mode],
            "slope": {"face": [FACE, TOWARD], "upper": [0, TOWARD], "height": height},
            "joints": {
                name: {"plane": plane, "strength": "s"}
                for name, plane in zip(names, planes, strict=True)
            },
            "strength": {"s": {"c": COHESION, "phi": FRICTION}},
            "rock": {"unit_weight": UNIT_WEIGHT},
            "water": {"pressures": dict.fromkeys(names, 8)},
            "loads": {"seismic": seismic},
        }
    )


@pytest.mark.slow
def test_blocks_fail_as_single_designs_of_them_do() -> None:
    """Under water and an earthquake: those that PRE-IE alone lets fail, and some that stand or fail by both."""
    asked = ground(toe="anywhere", water="u=8kPa", seismic=0.05)
    planes = [joint.plane for joint in asked.joints.joints]
    trials = drawn_trials(asked.joints, 1000, 4, anywhere=True)
    closed = closed_bench(asked, trials, HEIGHT, FACE)
    (both,), said = limits.evaluated_benches(asked, trials, checked_crew(1, None), DESK)
    assert (both.fails >= closed.fails).all()
    seen = set[tuple[int, bool, bool]]()
    for mode in (WEDGE, PLANE):
        assert (both.fails[mode] & ~closed.fails[mode]).sum() == said[mode].unsafe
        fails = np.stack([closed.fails[mode], both.fails[mode]], axis=1)
        for pattern in ([False, True], [False, False], [True, True]):
            for row in np.flatnonzero(both.forms[mode] & (fails == pattern).all(axis=1))[
                :4
            ].tolist():
                joints = [planes[trials.first[row]], planes[trials.second[row]]]
                own = [f"{joint.dip_deg}/{joint.dip_direction_deg}" for joint in joints]
                section = [f"{joints[0].dip_deg}/{TOWARD}"]
                factors = factors_of(
                    block_of(
                        asked,
                        mode,
                        section if mode == PLANE else own,
                        float(both.block_height_m[mode, row]),
                    )
                )
                assert falls_short(factors.status, factors.limit, 1.0) == both.fails[mode, row]
                assert (
                    falls_short(factors.closed_status, factors.closed_form, 1.0)
                    == closed.fails[mode, row]
                )
                seen.add((mode, bool(closed.fails[mode, row]), bool(both.fails[mode, row])))
    assert {
        (WEDGE, False, True),
        (WEDGE, False, False),
        (PLANE, False, False),
        (PLANE, True, True),
    } <= seen


def test_planes_as_steep_as_their_friction_stand_by_both_methods() -> None:
    """F = tan φ / tan ψ = 1 without cohesion, at whole degrees: rounding makes none of them fail."""
    dips = range(20, 45)
    asked = ground([f"{dip}/180" for dip in dips])
    asked = replace(asked, cohesion_kpa=np.zeros(25), friction_deg=np.array(dips, dtype=float))
    first = np.arange(25)
    trials = Trials(first, np.roll(first, 1), np.zeros(25))
    (bench,), both = limits.evaluated_benches(asked, trials, checked_crew(1, None), DESK)
    assert bench.factor[PLANE] == pytest.approx(np.ones(25), rel=1e-12)
    assert bench.forms[PLANE].all()
    assert not bench.fails[PLANE].any()
    assert (both[PLANE].agree, both[PLANE].unsafe) == (25, 0)


def test_pre_ie_takes_the_pressure_that_was_given(monkeypatch: pytest.MonkeyPatch) -> None:
    """One mean pressure in place of a fill: on both joints of a wedge, on the one of a plane; both methods agree."""
    taken, solved = set(), limits.limits_on_arrays

    def limits_on_arrays(design: Any, *rest: Any) -> Any:
        taken.add((design.kind, design.water.mode, design.water.pressures_kpa))
        return solved(design, *rest)

    for module in (limits, joint_wedges):
        monkeypatch.setattr(module, "limits_on_arrays", limits_on_arrays)
    found = sk.bench_design(
        ["45/180", "70/120", "65/250"],
        height=10,
        face=75,
        dip_direction=180,
        c=15,
        phi=32,
        water="u=8kPa",
        n=200,
    )
    assert taken == {("wedge", "pressures", (8.0, 8.0)), ("plane", "pressures", (8.0,))}
    assert found.both.agree == found.both.looked_at > 12
    assert (found.both.disagree, found.both.safe) == (0, 0)
    assert found.both.unsafe <= found.both.governed < found.both.looked_at


def test_the_sheet_lists_what_was_read() -> None:
    """60:75:5 is five faces, as everywhere."""
    benches = sk.bench_design(
        ["45/115", "45/245"],
        height=10,
        face="60:75:5",
        berm="6:9:+1",
        dip_direction=180,
        c=5,
        phi=30,
        n=100,
    )
    said = " ".join(str(benches).split())
    assert "heights 10 m, face dips 60; 63.75; 67.5; 71.25; 75°, berms 6; 7; 8; 9 m" in said


def test_the_sheet_keeps_height_and_face_apart() -> None:
    """A face of 63.75° ran into the height."""
    found = sk.bench_design(
        list(JOINTS), height=10, face=63.75, dip_direction=180, c=0, phi=32, n=500
    )
    assert "10 m 63.75°" in str(found.sheet)


def test_sizes_of_the_survey_count_first(tmp_path: Path) -> None:
    """Columns of trace and spacing; how far it is from joint to joint along the bench follows from the spacings."""
    survey = tmp_path / "sizes.csv"
    survey.write_text(
        "set,dip,dip_direction,spacing (m),trace (m)\nA,60,140,2,8\nA,60,140,4,\nB,50,090,5,12\nB,50,090,,3\n"
    )
    found = sk.bench_design(
        str(survey), height=10, face=70, dip_direction=180, c=0, phi=30, trace=20, n=100
    )
    assert found.given.trace_m.tolist() == [8.0, 20.0, 12.0, 3.0]
    assert found.given.spacing_m[:3].tolist() == [2.0, 4.0, 5.0]
    assert math.isnan(found.given.spacing_m[3])
    # the bench runs east: a set is met sin(dip) |sin(dip direction)| / spacing times a metre
    often = (
        math.sin(math.radians(60.0)) * math.sin(math.radians(140.0)) / 3.0
        + math.sin(math.radians(50.0)) / 5.0
    )
    assert found.given.every_m == pytest.approx(1.0 / often, rel=1e-12)
    said = [notice.message for notice in found.warnings if notice.code == "W391"]
    assert not any("no trace length" in message or "along the bench" in message for message in said)
    assert any("1 of 4 joints have no spacing" in message for message in said)
