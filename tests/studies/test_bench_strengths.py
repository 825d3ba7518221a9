"""Strengths of benches that scatter, cohesion that decides, traces with hidden ends."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.errors import DesignError
from slopekit.design.joint_lists import joint_list
from slopekit.studies.bench_design.bench import bench_of
from slopekit.studies.bench_design.columns import confirmed_columns
from slopekit.studies.bench_design.run import accepted
from slopekit.studies.bench_design.strengths import drawn_strength, with_drawn
from slopekit.studies.bench_design.trials import drawn_trials
from slopekit.studies.protocol import DESK
from slopekit.studies.running import checked_crew
from tests.commands import slopekit

PLANES = ("40/180", "40/181")
JOINTS = ("52/140", "58/150", "47/128", "61/222", "55/232", "66/215", "44/178", "52/186", "78/004", "18/175")
SMALL: dict[str, Any] = {"height": 12, "face": 70, "dip_direction": 180, "n": 2000, "confirm": 0, "near": 0}


def normal_below(value: float, mean: float, sd: float) -> float:
    return 0.5 * math.erfc((mean - value) / (sd * math.sqrt(2.0)))


def test_planes_without_cohesion_fail_as_often_as_their_friction_is_below_their_dip() -> None:
    """F = tan φ / tan ψ: P(F < 1) = P(φ < 40°), within four deviations of 20,000 places, for each way to write it."""
    own = SMALL | {"n": 20_000, "c": 0}
    wanted = normal_below(40.0, 42.0, 3.0)
    for given in ("normal:42,3", "{dist: normal, mean: 42, sd: 3}", {"dist": "normal", "mean": "42 deg", "sd": 3}):
        found = sk.bench_design(list(PLANES), phi=given, **own)
        share = found.benches[0].modes["plane"].fails_if_formed
        assert share.of == 20_000
        assert share.share == pytest.approx(wanted, abs=4.0 * math.sqrt(wanted * (1.0 - wanted) / share.of))
    fixed = sk.bench_design(list(PLANES), phi=42, **own)
    assert fixed.benches[0].modes["plane"].fails.share == 0.0


def test_both_joints_of_a_wedge_have_their_own() -> None:
    """Where φ of two joints is below 30 or above 50 by halves, a quarter of the places has both below."""
    found = sk.bench_design(["50/140", "50/220"], c=0, phi="uniform:0,80", **(SMALL | {"n": 8000}))
    low = sk.bench_design(["50/140", "50/220"], c=0, phi=20, **SMALL).benches[0].modes["wedge"].fails_if_formed.share
    high = sk.bench_design(["50/140", "50/220"], c=0, phi=70, **SMALL).benches[0].modes["wedge"].fails_if_formed.share
    assert (low, high) == (1.0, 0.0)
    # of a symmetric wedge F = g (tan φ1 + tan φ2): the share by a sum over a fine grid of both
    design = {"dips": ("50/140", "50/220"), "face": "70/180", "upper": "0/180", "height": 12, "c": 0}
    g = sk.wedge(**design, phi=(30, 30)).fos.closed_form / (2.0 * math.tan(math.radians(30)))
    tangents = np.tan(np.radians((np.arange(800) + 0.5) / 10.0))
    wanted = float((g * (tangents[:, None] + tangents) < 1.0).mean())
    share = found.benches[0].modes["wedge"].fails_if_formed
    assert share.share == pytest.approx(wanted, abs=4.0 * math.sqrt(wanted * (1.0 - wanted) / share.of))


def test_a_joint_with_its_own_value_keeps_it() -> None:
    listed = joint_list(list(PLANES)).joints
    joints = [replace(listed[0], friction_angle_deg=50.0), replace(listed[1], friction_angle_deg=30.0)]
    found = sk.bench_design(joints, c=0, phi="normal:10,1", **SMALL)
    firsts = found.benches[0].modes["plane"].fails_if_formed.share
    assert 0.45 < firsts < 0.55  # the first joint of a place is either of the two
    assert "(2 joints with their own)" in " ".join(str(found.sheet).split())


def test_pre_ie_looks_at_the_strengths_that_were_drawn() -> None:
    own = SMALL | {"confirm": 6}
    found = sk.bench_design(list(JOINTS), c="lognormal:5,3", phi="normal:32,3", **own)
    assert found.checked.said.samples == found.checked.blocks == 6
    assert (found.checked.said.agree, found.checked.said.disagree) == (6, 0)
    document = found.to_dict()["inputs"]["drawn"]
    assert document["c"] == {"dist": "lognormal", "mean": 5.0, "sd": 3.0, "min": 0.0, "max": 1e9}
    again = sk.bench_design(list(JOINTS), c="lognormal:5,3", phi="normal:32,3", **SMALL)
    other = sk.bench_design(list(JOINTS), c="lognormal:5,3.1", phi="normal:32,3", **SMALL)
    assert again.to_dict()["benches"] == found.to_dict()["benches"]
    assert other.given.input_hash() != again.given.input_hash()
    assert "c drawn at each place (lognormal, mean 5, sd 3 kPa)" in " ".join(str(found.sheet).split())


@pytest.mark.parametrize(
    ("key", "given", "code"),
    [
        ("c", "normal:10", "E165"), ("c", "normal:10,3,1", "E165"), ("c", "normal:10,,", "E165"),
        ("c", "norml:10,3", "E165"), ("c", "fisher:10,3", "E165"), ("c", "normal:10,-3", "E186"),
        ("c", "normal:10,30", "E281"), ("phi", "normal:85,8", "E281"), ("phi", "uniform:40,20", "E186"),
        ("c", "{dist: normal, mean: 10", "E160"), ("c", "{mean: 10}", "E165"), ("c", {}, "E165"),
        ("c", "normal:10 m,3", "E107"), ("phi", "normal:a,3", "E106"), ("c", "lognormal:0,3", "E186"),
    ],
)  # fmt: skip
def test_what_is_no_distribution_is_said(key, given, code) -> None:
    with pytest.raises(DesignError) as refused:
        drawn_strength(key, given, f"--{key}")
    assert refused.value.codes[0] == code
    assert all(fault.where.startswith(f"--{key}") for fault in refused.value.faults)


def test_on_the_command_line(tmp_path) -> None:
    joints = tmp_path / "joints.csv"
    joints.write_text("dip,dip direction\n" + "\n".join(one.replace("/", ",") for one in JOINTS))
    given = ["bench-design", str(joints), "--height", "12", "--face", "70", "--dip-direction", "180", "-n", "500",
             "--confirm", "0"]  # fmt: skip
    code, out, _ = slopekit(*given, "--c", "normal:10kPa,3kPa", "--phi", "triangular:25,30,38")
    assert code == 0
    assert "φ drawn at each place (triangular, min 25, mode 30, max 38°)" in " ".join(out.split())
    code, _, said = slopekit(*given, "--c", "normal:10", "--phi", "30")
    assert code == 2
    assert "E165 normal:10 has 1 number," in said
    assert "--c normal:10" in said
    assert "E109" not in said
    assert "E106" not in said


# -- cohesion -------------------------------------------------------------------------------------------------------


def test_without_cohesion_is_a_run_with_c_0() -> None:
    """Another run, with c = 0 given, says the same; and its own block of numbers is absent."""
    with_c = sk.bench_design(list(JOINTS), c=10, phi=32, spacing=1.5, **SMALL)
    without = sk.bench_design(list(JOINTS), c=0, phi=32, spacing=1.5, **SMALL)
    bare, own = with_c.benches[0].bare, without.benches[0]
    assert bare.fails == {name: mode.fails.share for name, mode in own.modes.items()}
    assert bare.fails_if_formed == {name: mode.fails_if_formed.share for name, mode in own.modes.items()}
    assert bare.berm_needed_m == own.berm_needed_m
    assert own.bare is None
    assert "COHESION" in str(with_c.sheet)
    assert "COHESION" not in str(without.sheet)
    assert with_c.to_dict()["benches"][0]["without_cohesion"]["decides"] is True
    assert without.to_dict()["benches"][0]["without_cohesion"] is None


def test_the_notice_stands_where_cohesion_decides_and_not_where_it_does_not() -> None:
    """10 kPa holds nearly all of it, 0.05 kPa next to nothing; one place more or less is within the limits."""
    decides = sk.bench_design(list(JOINTS), c=10, phi=32, **SMALL)
    said = next(str(one) for one in decides.warnings if one.code == "W422")
    bench = decides.benches[0]
    assert f"{100.0 * bench.bare.fails_if_formed['any']:.3g} %" in said
    assert bench.bare.fails["any"] >= 2.0 * bench.modes["any"].fails.share
    assert bench.bare.fails["any"] > bench.modes["any"].fails.high
    little = sk.bench_design(list(JOINTS), c=0.05, phi=32, **SMALL)
    assert "W422" not in {one.code for one in little.warnings}
    assert little.benches[0].bare.decides is False


# -- traces ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("ends", "words"), [([2, 2], ""), ([1, 2], "1 with a hidden end"),
                                             ([None, 2], "1 without a word of their ends")])  # fmt: skip
def test_traces_taken_as_whole_are_said(ends, words) -> None:
    listed = joint_list(list(PLANES)).joints
    joints = [replace(one, trace_m=20.0, ends=seen) for one, seen in zip(listed, ends, strict=True)]
    found = sk.bench_design(joints, c=0, phi=30, **SMALL)
    said = [str(one) for one in found.warnings if "taken as whole" in one.message]
    assert bool(said) == bool(words)
    assert all(words in one for one in said)


def test_traces_of_sets_and_of_options_are_not_measured() -> None:
    sets = {"sets": {"A": {"plane": "50/150", "trace": 10}, "B": {"plane": "60/220", "trace": 12}}}
    for joints, more in ((sets, {}), (list(PLANES), {"trace": 15})):
        found = sk.bench_design(joints, c=0, phi=30, **SMALL, **more)
        assert not any("taken as whole" in one.message for one in found.warnings)


# -- columns --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("c", "phi", "slides"), [(0, 40, False), (0, 10, True), (3, 10, True), (60, 10, False)])
def test_columns_that_slide_on_their_base_are_said(c, phi, slides) -> None:
    """One column 8 m wide, square on its base: `topple`'s own answer for it, by PRE-IE, says whether it slides."""
    joints = [replace(one, spacing_m=8.0) for one in joint_list(["72/000", "18/180"]).joints]
    own = SMALL | {"n": 100, "toe": "bench"}
    found = sk.bench_design(joints, c=c, phi=phi, **own)
    assert found.given.every_m is None  # both strike along the bench: their spacing says nothing of places along it
    assert found.benches[0].modes["toppling"].forms.count == 100
    assert found.benches[0].modes["toppling"].fails.count == 0
    said = [str(one) for one in found.warnings if one.code == "W395"]
    # down the side of the first column, from the crest to the base
    height = (12.0 - 12.0 / math.tan(math.radians(70)) * math.tan(math.radians(18))) * math.sin(math.radians(72))
    column = sk.run({
        "slopekit": 1, "kind": "topple", "columns": {"dip": 72, "width": 8, "heights": [height]},
        "strength": {"s": {"c": c, "phi": phi}}, "rock": {"density": 2600},
    })  # fmt: skip
    assert (column.fos.limit < 1.0) is slides
    assert bool(said) is slides
    # where the base is the first joint it fails as a plane too; at the other places nothing else does
    counted = 100.0 * found.benches[0].modes["any"].fails.share
    assert 0.0 < counted < 100.0 or not slides
    assert all("100 of 100 columns" in one for one in said)
    assert all(f"fails at {counted:.1f} % of the places, with them at 100.0 %" in one for one in said)


def with_columns(**more: Any) -> tuple[Any, Any]:
    """Joints of which columns form on bases that are not square to them; what was found, and the places."""
    planes = ["80/000", "76/008", "70/355", "30/180", "38/175", "22/186", "45/183"]
    joints = [replace(one, spacing_m=1.0 + 0.3 * k) for k, one in enumerate(joint_list(planes).joints)]
    found = sk.bench_design(joints, c=2, phi="normal:30,4", every=5, **(SMALL | {"n": 400, "confirm": 12} | more))
    return found, with_drawn(found.given, drawn_trials(found.joints, 400, 1, anywhere=True))


def test_pre_ie_and_the_criterion_of_columns_say_the_same() -> None:
    """PRE-IE on the column cut to its shape knows nothing of the criterion, nor of the formula of W395."""
    found, _ = with_columns()
    said = found.columns
    assert said.samples >= 12
    assert (said.pre_ie_only, said.closed_form_only, said.unanswered) == (0, 0, 0)
    assert said.topple > 0
    assert said.stand > 0
    assert said.topple + said.stand == said.samples
    assert said.slide > 0
    assert found.to_dict()["pre_ie_columns"]["topple_by_pre_ie_only"] == 0
    assert "turn over by both" in " ".join(str(found.sheet).split())
    assert with_columns(confirm=0)[0].columns is None


def test_columns_that_turn_over_by_pre_ie_alone_bar_their_bench() -> None:
    """A criterion that is wrong, slenderness the wrong way up, is found out."""
    found, places = with_columns()
    asked = found.given
    bench = bench_of(asked.ground(12.0), places, 12.0, 70.0)
    said = confirmed_columns(asked, places, [replace(bench, factor=1.0 / bench.factor)], checked_crew(1, None), DESK)
    assert said.pre_ie_only > 0
    assert said.closed_form_only > 0
    assert said.doubted == {(12.0, 70.0)}
    asks = replace(asked, numbers={**asked.numbers, "accept": 0.0})
    assert not accepted(asks, found.benches[0], None, said).berms[0].accepted
    assert accepted(asks, found.benches[0], None, found.columns).berms[0].accepted
