"""`slopekit combos`: every pair against the scalar closed form, sizes against corners, PRE-IE on the worst."""

import csv
import io
import json
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.errors import DesignError, GeometryError
from slopekit.core.orientation import Plane, line_of
from slopekit.studies.combos import Combos, combos
from slopekit.studies.combos import pairs as room
from slopekit.studies.combos.pairs import NOT_REMOVABLE, PAIR_OUTCOMES
from slopekit.studies.protocol import Workplace
from tests.closed_form.scalar_wedge import WedgeWater, hoek_bray_wedge
from tests.commands import slopekit
from tests.geometry.manifold_wedge import wedge_rock_mass

LIST = str(Path(__file__).parents[2] / "examples" / "joints.csv")
#: Moments govern: the limit is 1.578, the closed form 1.677.
ONE_PLANE = {
    "joints": ["45/160", "80/240"],
    "face": "65/180",
    "height": 10,
    "c": 20,
    "phi": 30,
    "unit_weight": 26,
}

#: Some joints of examples/joints.csv.
TURNS = {"N06": "40/128", "N08": "53/213", "N15": "48/142", "N39": "73/204", "N48": "58/138"}


def survey(seed: int, n: int) -> list[tuple[float, float]]:
    rng = np.random.default_rng(seed)
    return [(float(dip), float(way)) for dip, way in rng.uniform((5.0, 0.0), (89.0, 360.0), (n, 2))]


def refused(**inputs) -> DesignError:
    with pytest.raises(DesignError) as caught:
        sk.combos(
            **({"joints": ["45/115", "45/245"], "face": "65/180", "c": 5, "phi": 30} | inputs)
        )
    return caught.value


def outcomes(found: Combos) -> list[str]:
    return [PAIR_OUTCOMES[outcome] for outcome in found.pairs.outcome]


def corners_of(found: Combos, k: int) -> dict[str, np.ndarray]:
    """Toe, back and crests of a pair by the rock mass that PRE-IE cuts, m."""
    shapes, slope = found.pairs, found.given.slope
    planes = np.array(
        [found.joints.joints[j].plane.normal() for j in (shapes.first[k], shapes.second[k])]
    )
    rock = wedge_rock_mass(
        planes, slope.face.normal(), slope.upper.normal(), float(shapes.height_m[k])
    )
    return {
        "toe": rock.toe,
        "back": rock.back,
        "crest1": rock.crest1,
        "crest2": rock.crest2,
        "line": rock.line_of_intersection,
    }


# -- against the scalar closed form ------------------------------------------------------------------------------------

SLOPES = [
    {"face": "65/180"},
    {
        "face": "70/200",
        "upper": "15/230",
        "water": "40%",
        "seismic": "0.1",
    },  # a crest that is not level
    {"face": "85/010", "upper": "25/350", "water": "u=6kPa", "seismic": "0.1@015", "density": 2400},
    {
        "face": "60/090",
        "upper": "20/270",
        "water": "full",
        "persistence": 9,
        "bench_width": 4,
        "max_volume": 30,
    },
]


@pytest.mark.parametrize("slope", SLOPES, ids=lambda slope: slope["face"])
def test_every_pair_is_what_one_wedge_says(slope) -> None:
    """Outcome, factor, volume and line of 780 pairs: rock mass and scalar closed form at the height of the pair."""
    joints = survey(2, 40)
    found = sk.combos(joints, **slope, height=12, c=8, phi=31, closed_form=True)
    pairs, base = found.pairs, found.given.slope
    assert len(pairs) == 780
    assert sum(found.counts.values()) == 780
    water = WedgeWater(base.water.fill, base.water.pressures_kpa)
    checked = 0
    for k, outcome in enumerate(outcomes(found)):
        one, two = (Plane(*joints[j]) for j in (pairs.first[k], pairs.second[k]))
        height = float(pairs.height_m[k])
        if height <= 0.0:
            assert outcome in NOT_REMOVABLE.values()
            continue
        if outcome in NOT_REMOVABLE.values():
            with pytest.raises(GeometryError) as caught:
                corners_of(found, k)
            assert NOT_REMOVABLE[caught.value.codes[0]] == outcome
            continue
        corners = corners_of(found, k)
        answer = hoek_bray_wedge(
            (one, two),
            base.face,
            base.upper,
            height,
            (8, 8),
            (31, 31),
            base.rock.unit_weight_kn_m3,
            water=water,
            seismic=(base.seismic.coefficient, base.seismic.trend_deg),
        )
        assert outcome == answer.status
        assert pairs.volume_m3[k] == pytest.approx(answer.volume, rel=1e-9)
        line = line_of(corners["line"])
        assert math.cos(math.radians(pairs.trend_deg[k] - line.trend_deg)) == pytest.approx(
            1.0, abs=1e-9
        )
        assert pairs.plunge_deg[k] == pytest.approx(line.plunge_deg, abs=1e-6)
        if answer.factor is None:
            assert math.isnan(pairs.factor[k])
        else:
            assert pairs.factor[k] == pytest.approx(answer.factor, rel=1e-9)
        # the height is the slope's: up the dip of the face to the upper slope
        way, dip = math.radians(base.face.dip_direction_deg), math.radians(base.face.dip_deg)
        crest = np.array([-math.sin(way) / math.tan(dip), -math.cos(way) / math.tan(dip), 1.0])
        crest *= 12.0 * pairs.scale[k]
        assert base.upper.normal() @ crest == pytest.approx(
            base.upper.normal() @ corners["crest1"], rel=1e-9
        )
        checked += 1
    assert checked == found.removable > 100


def test_the_order_of_the_list_does_not_matter() -> None:
    """On a crest that is not level the heights of the two traces differ; the wedge of a pair stays the same."""
    joints = {f"J{k}": plane for k, plane in enumerate(survey(9, 30))}
    slope = {
        "face": "70/200",
        "upper": "15/240",
        "height": 9,
        "c": 5,
        "phi": 28,
        "closed_form": True,
    }
    forth, back = sk.combos(joints, **slope), sk.combos(dict(reversed(joints.items())), **slope)

    def by_names(found: Combos) -> dict:
        names, shapes = [joint.name for joint in found.joints.joints], found.pairs
        return {
            frozenset((names[a], names[b])): (outcome in NOT_REMOVABLE.values(), factor, volume)
            for a, b, outcome, factor, volume in zip(
                shapes.first,
                shapes.second,
                outcomes(found),
                found.pairs.factor,
                found.pairs.volume_m3,
                strict=True,
            )
        }

    one, other = by_names(forth), by_names(back)
    assert one.keys() == other.keys()
    for pair, values in one.items():
        assert other[pair] == pytest.approx(values, rel=1e-9, nan_ok=True)
    assert not np.allclose(forth.pairs.height_m[forth.pairs.is_removable], 9.0)


def test_a_joint_whose_trace_is_level_still_meets_a_crest_that_falls() -> None:
    """The rock mass asks for the other numbering (E206); pairs are numbered so that it is not needed."""
    slope = {"face": "65/180", "upper": "10/215", "height": 10, "c": 0, "phi": 30}
    for joints in (["40/180", "80/250"], ["80/250", "40/180"]):
        found = sk.combos(joints, **slope)
        assert found.removable == 1
        assert found.worst[0].agree
        assert set(found.worst[0].planes) == {Plane(40, 180), Plane(80, 250)}
    assert (
        sk.combos(["40/180", "80/250"], **(slope | {"upper": "0/180"})).counts["along_the_face"]
        == 1
    )


@pytest.mark.parametrize(
    ("outcome", "joints", "inputs"),
    [
        ("slides_on_both", ["45/115", "45/245"], {}),
        ("slides_on_J1", ["40/160", "80/220"], {}),
        ("slides_on_J2", ["80/220", "40/160"], {}),
        ("slides_up", ["45/115", "45/245"], {"seismic": "1.9@000"}),
        ("lifted", ["45/115", "45/245"], {"water": "u=90kPa"}),
        ("parallel", ["45/115", "45/115"], {}),
        ("too_steep", ["85/150", "85/210"], {}),
        ("into_the_slope", ["45/300", "45/060"], {}),
        ("flatter_than_upper_slope", ["45/100", "45/260"], {"upper": "12/180"}),
        ("along_the_face", ["40/180", "80/250"], {}),
        ("below_min_volume", ["45/115", "45/245"], {"min_volume": "1e6"}),
    ],
)
def test_outcomes(outcome, joints, inputs) -> None:
    found = sk.combos(joints, face="65/180", height=10, c=5, phi=30, closed_form=True, **inputs)
    assert {name: count for name, count in found.counts.items() if count} == {outcome: 1}
    assert found.removable == (
        outcome in found.counts and outcome not in (*NOT_REMOVABLE.values(), "below_min_volume")
    )


# -- limits of size ----------------------------------------------------------------------------------------------------


def longest_edge(corners: dict[str, np.ndarray]) -> float:
    edges = (
        ("toe", "back"),
        ("toe", "crest1"),
        ("toe", "crest2"),
        ("back", "crest1"),
        ("back", "crest2"),
    )
    return max(float(np.linalg.norm(corners[a] - corners[b])) for a, b in edges)


def behind_the_crest(corners: dict[str, np.ndarray]) -> float:
    edge = (corners["crest2"] - corners["crest1"])[:2]
    away = (corners["back"] - corners["crest1"])[:2]
    return abs(float(edge[0] * away[1] - edge[1] * away[0])) / float(np.linalg.norm(edge))


def longest_trace(corners: dict[str, np.ndarray]) -> float:
    crests = (corners["crest1"], corners["crest2"])
    ends = [corners["toe"], corners["back"]]
    return max(float(np.linalg.norm(crest - end)) for crest in crests for end in ends)


@pytest.mark.parametrize("upper", ["0/180", "12/225"])
@pytest.mark.parametrize(
    ("limit", "value", "size"),
    [
        ("persistence", 30.0, lambda corners, volume: longest_edge(corners)),
        ("bench_width", 3.0, lambda corners, volume: behind_the_crest(corners)),
        ("max_volume", 20.0, lambda corners, volume: volume),
        (
            "slope_length",
            5.0,
            lambda corners, volume: np.linalg.norm(corners["crest2"] - corners["crest1"]),
        ),
        ("trace_length", 15.0, lambda corners, volume: longest_trace(corners)),
    ],
)
def test_limits_scale_wedges_down_to_them(limit, value, size, upper) -> None:
    """Sizes from the corners of the rock mass; similar wedges, so volumes go with the cube of the scale."""
    joints, slope = (
        survey(5, 30),
        {"face": "65/180", "upper": upper, "height": 12, "c": 6, "phi": 30, "closed_form": True},
    )
    full, less = sk.combos(joints, **slope), sk.combos(joints, **slope, **{limit: value})
    removable = np.flatnonzero(full.pairs.is_removable)
    assert (less.pairs.is_removable == full.pairs.is_removable).all()
    scale = less.pairs.scale[removable]
    assert 0 < (scale < 1.0).sum() < len(scale)
    assert less.pairs.volume_m3[removable] == pytest.approx(
        full.pairs.volume_m3[removable] * scale**3, rel=1e-9
    )
    for k in removable:
        found = size(corners_of(less, k), less.pairs.volume_m3[k])
        if less.pairs.scale[k] < 1.0:
            assert found == pytest.approx(value, rel=1e-9)
        else:
            assert found <= value * (1 + 1e-9)
    slides = ~np.isnan(full.pairs.factor[removable])
    assert (
        less.pairs.factor[removable][slides] >= full.pairs.factor[removable][slides] * (1 - 1e-9)
    ).all()
    assert less.to_dict()["scaled_down"][limit] == (scale < 1.0).sum()


def test_larger_wedges_are_left_out_where_limits_filter() -> None:
    """Those that scaling makes smaller form no wedge then; the others are as they were. E126 another word."""
    joints, slope = (
        survey(5, 30),
        {"face": "65/180", "height": 12, "c": 6, "phi": 30, "top": 0, "bench_width": 3},
    )
    scaled, left = sk.combos(joints, **slope), sk.combos(joints, **slope, limit_by="filter")
    larger = scaled.pairs.is_removable & (scaled.pairs.scale < 1.0)
    assert left.counts["beyond_limits"] == larger.sum() > 0
    assert left.removable == scaled.removable - larger.sum() > 0
    kept = left.pairs.is_removable
    assert (left.pairs.scale == 1.0).all()
    assert (left.pairs.sizes.setback_m[kept] <= 3.0).all()
    assert left.pairs.factor[kept] == pytest.approx(scaled.pairs.factor[kept], nan_ok=True)
    assert "larger than the limits of size" in str(left.sheet)
    with pytest.raises(DesignError) as raised:
        sk.combos(joints, **slope, limit_by="cut")
    assert [fault.code for fault in raised.value.faults] == ["E126"]


def test_sizes_in_the_table_are_those_of_the_wedge_alone() -> None:
    """Setback and width of the worst pairs, from `slopekit wedge` of the same planes."""
    found = sk.combos(
        survey(5, 30), face="65/180", upper="12/225", c=6, phi=30, top=4, trace_length=9
    )
    for pair in found.worst:
        alone = sk.wedge(
            dips=pair.planes, face="65/180", upper="12/225", height=pair.height_m, c=6, phi=30
        )
        assert pair.extent_m["setback_m"] == pytest.approx(alone.geometry.setback_m, rel=1e-7)
        assert pair.extent_m["face_width_m"] == pytest.approx(alone.geometry.face_width_m, rel=1e-7)


def test_without_cohesion_size_does_not_matter() -> None:
    joints, slope = (
        survey(5, 30),
        {"face": "65/180", "c": 0, "phi": 30, "water": "30%", "closed_form": True},
    )
    full = sk.combos(joints, **slope).pairs
    less = sk.combos(joints, **slope, persistence=2, bench_width=0.5, max_volume="1 m3").pairs
    assert less.factor == pytest.approx(full.factor, rel=1e-9, nan_ok=True)
    assert (less.scale[less.is_removable] < 1.0).all()


def test_wedges_below_the_least_volume_are_counted_apart() -> None:
    joints, slope = (
        survey(5, 30),
        {"face": "65/180", "height": 6, "c": 5, "phi": 30, "closed_form": True},
    )
    all_, large = sk.combos(joints, **slope), sk.combos(joints, **slope, min_volume=10)
    small = all_.pairs.is_removable & (all_.pairs.volume_m3 < 10)
    assert large.counts["below_min_volume"] == small.sum() > 0
    assert large.removable == all_.removable - small.sum()
    assert sum(large.counts.values()) == 435
    least = float(np.sort(all_.pairs.volume_m3[all_.pairs.is_removable])[20])
    for part, below in ((0.999, 20), (1.001, 21)):
        assert (
            sk.combos(joints, **slope, min_volume=part * least).counts["below_min_volume"] == below
        )


# -- ranking, the target, PRE-IE ---------------------------------------------------------------------------------------


def test_ranking_and_the_target() -> None:
    joints = survey(21, 40)
    slope = {
        "face": "75/180",
        "height": 10,
        "c": 5,
        "phi": 30,
        "water": "50%",
        "fos": 1.3,
        "top": 5,
    }
    found, bare = sk.combos(joints, **slope), sk.combos(joints, **slope, closed_form=True)
    for study, factor, outcome in (
        (bare, bare.pairs.factor[bare.ranked], [outcomes(bare)[k] for k in bare.ranked]),
        (
            found,
            found.outcomes.limit.factor,
            [found.outcomes.limit.names[k] for k in found.outcomes.limit.outcome],
        ),
    ):
        order, pairs = study.ranked, study.pairs
        assert sorted(order) == np.flatnonzero(pairs.is_removable).tolist()
        free = [name in ("lifted", "topples") for name in outcome]
        assert 0 < sum(free) == free.index(False)
        factors = factor[sum(free) :]
        assert (np.diff(factors) >= 0.0).all()
        assert (np.diff(pairs.volume_m3[order][: sum(free)]) <= 0.0).all()
        assert study.target["below"] == sum(free) + (factors < 1.3).sum()
        assert (
            study.target["largest_volume_m3"]
            == pairs.volume_m3[order][: study.target["below"]].max()
        )
        assert [pair.index for pair in study.worst] == order[:5].tolist()
        assert study.exit_code == 1
    assert found.target["by_pre_ie_only"] == found.target["below"] - bare.target["below"] > 0
    easy = sk.combos(joints, face="75/180", height=10, c=500, phi=60, fos=1.3, closed_form=True)
    assert (easy.target["below"], easy.exit_code) == (0, 0)


def test_pre_ie_on_the_worst() -> None:
    """Forces alone agree with the closed form to 1e-6; moments may only lower the limit."""
    joints = (
        np.random.default_rng(4)
        .normal([[50.0, 130.0], [50.0, 230.0]], [5.0, 10.0], (8, 2, 2))
        .reshape(-1, 2)
    )
    found = sk.combos(joints, face="70/180", height=8, c=10, phi=33, top=5)
    assert len(found.worst) == 5
    assert all(pair.agree for pair in found.worst)
    for pair in found.worst:
        assert pair.limit is None or pair.limit <= pair.closed_form * (1 + 1e-6)
        assert pair.difference is None or pair.difference < 1e-6
        assert pair.closed_form == pytest.approx(found.pairs.factor[pair.index], rel=1e-9)
        one = sk.wedge(
            dips=pair.planes,
            face="70/180",
            upper="0/180",
            height=pair.height_m,
            c=10,
            phi=33,
            density=2600,
        )
        assert (one.status, one.fos.limit) == (pair.status, pytest.approx(pair.limit, rel=1e-7))
        assert one.geometry.volume_m3 == pytest.approx(pair.volume_m3, rel=1e-9)
    assert sk.combos(joints, face="70/180", c=10, phi=33, top=0).worst == ()


def test_moments_may_bring_a_pair_below_the_target() -> None:
    found = sk.combos(**ONE_PLANE, fos=1.6)
    assert found.worst[0].moments_govern
    assert found.worst[0].limit == pytest.approx(1.578, abs=5e-4)
    assert found.to_dict()["target"] | {"largest_volume_m3": 0, "median_volume_m3": 0} == {
        "fos": 1.6,
        "below": 1,
        "by_pre_ie_only": 1,
        "largest_volume_m3": 0,
        "median_volume_m3": 0,
    }
    assert found.exit_code == 1
    assert (
        sk.combos(**ONE_PLANE, fos=1.6, closed_form=True).exit_code == 0
    )  # the closed form alone does not see it
    said = {notice.code: notice.message for notice in found.warnings}
    assert (
        said["W353"]
        == "1 of 1 removable pairs fail by PRE-IE alone: the closed form balances no moments"
    )
    sheet = " ".join(str(found).split())
    assert (
        "NOT MET, 1 of 1 removable pairs lie below (100.0 %; 100.0 % of all, 1 by PRE-IE only)"
        in sheet
    )
    assert " M " in sheet


def test_all_pairs_are_judged_by_both_methods(tmp_path) -> None:
    """Moments take 06 x 39 from above the target, 1.343, to below it, 1.217; each limit is that of its own wedge."""
    bars: list[tuple[str, int, list[int]]] = []

    @contextmanager
    def bar(label: str, total: int) -> Iterator[Callable[[int], None]]:
        bars.append((label, total, []))
        yield bars[-1][2].append

    slope = {"face": "65/180", "c": 10, "phi": 30, "fos": 1.3}
    every = combos(TURNS, **slope, top="all", desk=Workplace(tmp_path, bar))
    assert every.removable == len(every.worst) > 3
    assert bars == [("pieces of 2048 pairs", 1, [0, 1])]
    assert [path.suffix for path in tmp_path.iterdir()] == [
        ".journal"
    ]  # until the results are written
    limits = [pair.limit for pair in every.worst]
    assert limits == sorted(limits)
    turns = every.worst[4]
    assert turns.names == ("N06", "N39")
    assert turns.closed_form > 1.34 > 1.3 > 1.22 > turns.limit
    for pair in every.worst:
        one = sk.wedge(
            dips=pair.planes,
            face="65/180",
            upper="0/180",
            height=pair.height_m,
            c=10,
            phi=30,
            density=2600,
        )
        assert (one.status, one.moments_govern) == (pair.status, pair.moments_govern)
        assert one.fos.limit == pytest.approx(pair.limit, rel=1e-6)
    rows = list(csv.DictReader(io.StringIO(every.sheet.tables["pairs.csv"].csv())))
    assert [row["fos_limit"] for row in rows[: len(limits)]] == [f"{limit:.9g}" for limit in limits]

    none = combos(TURNS, **slope, closed_form=True)
    assert none.target["below"] == (none.pairs.factor < 1.3).sum()
    assert every.target["below"] == sum(limit < 1.3 for limit in limits)
    assert every.target["by_pre_ie_only"] == every.target["below"] - none.target["below"] == 1
    assert "counted by PRE-IE\n" in str(every)
    assert f"{every.target['below']} below 1.3 by PRE-IE  agree on {len(limits)}" in every.line
    assert "counted by the closed form alone, which balances no moments" in " ".join(
        str(none).split()
    )
    assert none.line.endswith("below 1.3 by the closed form")
    assert (every.to_dict()["inputs"]["top"], every.charts) == ("all", ("stereonet",))


def test_what_is_in_doubt_counts_by_either_method() -> None:
    found = combos(TURNS, face="65/180", c=10, phi=30, fos=1.3, top="all")
    high = replace(found.outcomes.limit, factor=np.full(found.removable, 9.9))
    disputed = replace(
        found, outcomes=replace(found.outcomes, limit=high, agree=0 * found.outcomes.agree)
    )
    assert disputed.target["below"] == (found.pairs.factor < 1.3).sum()
    assert disputed.exit_code == 4
    assert "DISAGREE" in str(disputed)
    trusted = replace(found, outcomes=replace(found.outcomes, limit=high))
    assert trusted.target["below"] == 0
    assert (found.exit_code, trusted.exit_code) == (1, 0)


def test_other_workers_and_smaller_parts_give_the_same_numbers(monkeypatch) -> None:
    slope = {"face": "70/180", "c": 5, "phi": 30}
    alone = sk.combos(survey(3, 20), **slope, top=4).to_dict()
    monkeypatch.setattr(room, "_PAIRS_PER_PIECE", 37)
    together = sk.combos(survey(3, 20), **slope, top=4, jobs=2).to_dict()
    assert {**alone, "timing_s": 0} == {**together, "timing_s": 0}


def test_strengths_of_their_own(tmp_path) -> None:
    """Columns count before what is given for all; what is missing in both is named."""
    (tmp_path / "joints.csv").write_text(
        "name,dip,dd,c,phi\nA,45,115,12,\nB,45,245,,25\nC,50,240,7 kPa,40\n"
    )
    found = sk.combos(tmp_path / "joints.csv", face="65/180", c=3, phi=30)
    assert found.given.cohesion_kpa.tolist() == [12, 3, 7]
    assert found.given.friction_deg.tolist() == [30, 25, 40]
    wedge = sk.wedge(
        dips=("45/115", "45/245"), face="65/180", upper="0/180", height=15, c=(12, 3), phi=(30, 25)
    )
    assert found.pairs.factor[0] == pytest.approx(wedge.fos.closed_form, rel=1e-9)
    error = refused(joints=tmp_path / "joints.csv", c=None, phi=None)
    assert [(fault.code, fault.message) for fault in error.faults] == [
        ("E143", "c is missing for 1 of 3 joints: B (line 3)"),
        ("E143", "phi is missing for 1 of 3 joints: A (line 2)"),
    ]
    many = tmp_path / "many.csv"
    many.write_text(
        "name,dip,dd,c\n" + "".join(f"N{k},45,{k},{5 if k == 3 else ''}\n" for k in range(20))
    )
    assert refused(joints=many, c=None).faults[0].message.endswith("N8 (line 10) and 11 more")


# -- what is said ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("code", "inputs", "says"),
    [
        ("E143", {"face": None}, "face is missing"),
        ("E104", {"face": "65-180"}, "face is '65-180'"),
        ("E116", {"height": 0}, "height is 0, it must be more than 0"),
        ("E113", {"phi": 0.5}, "phi is 0.5°, that looks like radians"),
        ("E112", {"density": 2600, "unit_weight": 26}, "density and unit weight are both given"),
        ("E118", {"water": 50}, "water fills 5000 %"),
        ("E190", {"joints": ["45/115"]}, "joints holds 1 joint, two are needed"),
        ("E143", {"phi": None}, "phi is missing: joints has none"),
        ("E116", {"persistence": 0}, "persistence is 0, it must be more than 0"),
        ("E107", {"bench_width": "3 m3"}, "bench width has the unit m3"),
        (
            "E116",
            {"min_volume": 5, "max_volume": 1},
            "min volume 5 m³ is more than max volume 1 m³",
        ),
        ("E126", {"top": 2.5}, "top is 2.5, a whole number is needed"),
        ("E126", {"top": -1}, "top is -1"),
        ("E106", {"top": "every"}, "top is 'every'"),
        ("E307", {"fos": 0}, "fos is 0, it must be more than 0"),
        ("E109", {"c": (5, 6)}, "c has two values: the joints of a list are no J1 and J2"),
        ("E109", {"water": "u=5kPa,6kPa"}, "water has two values"),
        ("E313", {"jobs": 0}, "--jobs is 0"),
    ],
)
def test_faults(code, inputs, says) -> None:
    error = refused(**inputs)
    assert error.codes == (code,)
    assert says in error.faults[0].message


def test_all_faults_at_once(tmp_path) -> None:
    (tmp_path / "joints.csv").write_text("dip,dd\n45,115\n195,300\n")
    error = refused(
        joints=tmp_path / "joints.csv",
        face=None,
        height=-1,
        c=(1, 2),
        phi=0.5,
        persistence=-2,
        fos="x",
    )
    assert error.codes == ("E101", "E143", "E109", "E116", "E113", "E116", "E106")
    assert sk.combos(["45/115", "45/245"], face="65/180", c=(5, 5), phi=30).removable == 1


@pytest.mark.parametrize(
    ("face", "upper"), [("65/180", "65/180"), ("40/180", "60/180"), ("0/180", "0/180")]
)
def test_a_slope_without_a_crest(face, upper) -> None:
    with pytest.raises(GeometryError) as caught:
        sk.combos(["45/115", "45/245"], face=face, upper=upper, c=5, phi=30)
    assert caught.value.codes == ("E209",)


def test_bad_rows_stop_the_run_or_are_left_out_and_listed(tmp_path) -> None:
    (tmp_path / "joints.csv").write_text(
        "name,dip,dd,photo\nA,45,115,1\nB,195,200,2\nC,45,245,\n,,,\nD,x,1,\n"
        + "".join(f"E{k},80,{k},\n" for k in range(17))
    )
    assert refused(joints=tmp_path / "joints.csv").codes == ("E101", "E104")
    found = sk.combos(tmp_path / "joints.csv", face="65/180", c=5, phi=30, skip_bad=True)
    assert [joint.name for joint in found.joints.joints] == [
        "A",
        "C",
        *(f"E{k}" for k in range(17)),
    ]
    said = {notice.code: notice.message for notice in found.warnings}["W366"]
    assert "column photo" in said
    assert "line 3 (E101 dip of B is 195" in said
    assert "line 5 (empty cells)" in said
    assert "line 6 (E104 " in said
    (tmp_path / "strikes.csv").write_text("name,strike,dip\nA,25,45\nC,155,45\n")
    assert refused(joints=tmp_path / "strikes.csv").codes == ("E192",)
    right = sk.combos(
        tmp_path / "strikes.csv", face="65/180", c=5, phi=30, convention="right-hand-rule"
    )
    assert right.pairs.factor[0] == found.pairs.factor[0]


def test_json_sheet_and_table() -> None:
    found = sk.combos(
        survey(12, 40),
        face="65/180",
        c=5,
        phi=30,
        water="20%",
        fos=1.5,
        persistence=10,
        min_volume=0.2,
    )
    document = json.loads(json.dumps(found.to_dict(), allow_nan=False))
    assert document.keys() == {
        "slopekit",
        "format",
        "study",
        "kind",
        "survey",
        "input_sha256",
        "inputs",
        "defaults",
        "pairs",
        "counts",
        "removable",
        "scaled_down",
        "target",
        "worst",
        "methods",
        "warnings",
        "timing_s",
        "line",
        "sheet",
    }
    assert document["defaults"] == ["upper", "height", "density"]
    assert document["worst"][0].keys() >= {
        "joints",
        "planes",
        "status",
        "fos",
        "moments_govern",
        "volume_m3",
        "scale",
    }
    sheet = str(found)
    assert max(map(len, sheet.splitlines())) <= 100
    shown = [line.split() for line in sheet.splitlines() if line.endswith(" %")]
    totals = [int(words[-3]) for words in shown if words[0] in ("PAIRS", "smaller", "not")]
    assert sum(totals) == len(found.pairs) == 780
    rows = list(csv.DictReader(io.StringIO(found.sheet.tables["pairs.csv"].csv())))
    assert len(rows) == 780
    assert [row["outcome"] for row in rows].count("too_steep") == found.counts["too_steep"]
    assert rows[0]["joint1"] == found.worst[0].names[0]
    factors = [float(row["fos_limit"]) for row in rows if row["fos_limit"]]
    assert factors == sorted(factors)
    line = found.line
    assert line.startswith(f"{found.removable} of 780 pairs removable  worst ")
    assert f"{found.target['below']} below 1.5" in line
    small = sk.combos(["45/115", "45/245"], face="65/180", c=5, phi=30, min_volume=1e6)
    assert "1 pair can leave the slope, but smaller than the least volume asked for" in str(small)
    nothing = sk.combos(["45/300", "45/060"], face="65/180", c=5, phi=30)
    assert "no pair can leave the slope" in str(nothing)
    assert nothing.line == "0 of 1 pairs removable"
    assert nothing.exit_code == 0


def test_three_hundred_joints() -> None:
    """44,850 pairs take the closed form well below a second (0.1 s on an idle core)."""
    found = sk.combos(survey(1, 300), face="65/180", c=5, phi=30, persistence=10, closed_form=True)
    assert sum(found.counts.values()) == 44850
    assert found.removable > 3000
    assert found.timing_s["closed_form"] < 3.0  # loaded machines


def test_the_command(tmp_path) -> None:
    folder = tmp_path / "out"
    run = slopekit(
        "combos",
        LIST,
        "--face",
        "65/180",
        "--c",
        "5",
        "--phi",
        "30",
        "--fos",
        "1.3",
        "--top",
        "1",
        "--upper",
        "12/215",
        "--water",
        "2%",
        "--min-volume",
        "20",
        "--seismic",
        "0.05@170",
        "-o",
        str(folder),
    )
    assert (run.returncode, run.stderr) == (1, "")
    assert {path.name for path in folder.iterdir()} == {
        "combos.json",
        "combos.txt",
        "pairs.csv",
        "stereonet.png",
    }
    full = (folder / "combos.txt").read_text().splitlines()
    sheet = [line.partition("   sha ")[0] for line in full if not line.startswith("TIME ")]
    assert sheet == run.stdout.splitlines()
    assert any(line.startswith("TIME ") for line in full)
    again = " ".join(run.stdout.split()).partition("AGAIN slopekit ")[2].partition(" NOTE")[0]
    worst = json.loads((folder / "combos.json").read_text())["worst"][0]
    assert slopekit(*again.split(), "--quiet").stdout.split()[:2] == [
        worst["status"],
        f"{worst['fos']['limit']:.3f}",
    ]
    picture = folder / "x.png"
    undrawn = slopekit(
        "combos",
        LIST,
        "--face",
        "65/180",
        "--c",
        "5",
        "--phi",
        "30",
        "--top",
        "0",
        "--picture",
        str(picture),
    )
    assert (undrawn.returncode, picture.exists()) == (0, False)
    assert undrawn.stderr.startswith("E273 this combos has nothing to draw")
    wrong = slopekit("combos", LIST, "--c", "5", "--persistence", "-3", "--json")
    assert wrong.returncode == 2
    assert [fault["code"] for fault in json.loads(wrong.stdout)["errors"]] == [
        "E143",
        "E116",
        "E143",
    ]


def test_the_sheet_says_what_a_part_of_full_pressure_is() -> None:
    found = sk.combos(["45/115", "45/245"], face="60/180", height=10, c=5, phi=30, water="50%")
    assert "water 50 % of full pressure" in str(found)
