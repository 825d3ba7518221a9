"""Wedges with a basal joint: PRE-IE against the closed form, geometry against a hand calculation, refusals, words."""

import dataclasses
import json
import math
from contextlib import suppress
from functools import cache

import numpy as np
import pytest

import slopekit as sk
from benchmarks.basal import Compared, compared_until
from slopekit.closed_form.basal import OUTCOMES, BasalWedgeArrays, basal_wedges
from slopekit.core.errors import DesignError, GeometryError
from slopekit.design.templates import path_of
from slopekit.kinds import words_named
from slopekit.kinds.wedge import closed_form
from slopekit.kinds.wedge.basal import crack_reach
from slopekit.views.pages.page_tables import input_rows
from tests.commands import slopekit
from tests.support import result_of

TEMPLATE = path_of("wedge-basal")
#: A trough along 180 with a level line, behind an upright face, over a basal joint that rises from 4 m into the slope.
TROUGH = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "90/180", "upper": "0/180", "height": 10},
    "joints": {
        "J1": {"plane": "60/090", "strength": "side"},
        "J2": {"plane": "60/270", "strength": "side"},
    },
    "basal": {"plane": "30/180", "height": 4, "strength": "base"},
    "strength": {"side": {"c": 0, "phi": 20}, "base": {"c": 20, "phi": 25}},
    "rock": {"unit_weight": 25},
}


@cache
def random_ones() -> list[Compared]:
    return compared_until(30)


@pytest.mark.slow
def test_thirty_random_wedges_agree_with_the_closed_form_to_1e_9() -> None:
    """`closed_form.basal` shares no line with the solver; where moments govern, the forces alone are compared."""
    blocks = [one for one in random_ones() if one.status[0] != "E"]
    assert len(blocks) == 30
    assert all(one.agree for one in blocks)
    differences = [one.difference for one in blocks if one.difference is not None]
    assert len(differences) > 22
    assert max(differences) < 1e-9
    assert {
        "slides_on_basal",
        "slides_on_J1_and_basal",
        "slides_on_J2_and_basal",
        "slides_on_J1_and_J2",
    } <= {one.status for one in blocks}


def put(design: dict, **values) -> dict:
    """A copy with values by their paths, dots written as two lines."""
    copy = json.loads(json.dumps(design))
    for path, value in values.items():
        *above, last = path.split("__")
        holder = copy
        for key in above:
            holder = holder.setdefault(key, {})
        holder[last] = value
    return copy


def test_volume_and_areas_by_hand() -> None:
    """z runs from 4 m to 10 m, the trough is 2z/√3 wide, the block reaches (z - 4) √3 behind the face."""
    found = sk.run(TROUGH)
    assert found.geometry.volume_m3 == pytest.approx(288.0, rel=1e-12)
    areas = {"J1": 36.0, "J2": 36.0, "basal": 4.0 / math.sqrt(3.0) * 42.0}
    assert found.geometry.areas_m2 == pytest.approx(areas, rel=1e-12)
    assert found.geometry.line_length_m == 0.0
    assert (
        found.status == "no_driving_force"
    )  # it would have to widen the trough to follow its base down
    assert found.agree


def test_a_block_that_leaves_its_sides_is_a_plane_failure() -> None:
    """Sides that open outward: F = (c A + W cos 30 tan φ) / (W sin 30) on the basal joint alone, as for any slab."""
    design = put(TROUGH, joints__J1__plane="80/100", joints__J2__plane="80/260")
    found = sk.run(design)
    weight, area = 25.0 * found.geometry.volume_m3, found.geometry.areas_m2["basal"]
    by_hand = 20.0 * area / (weight * 0.5) + math.tan(math.radians(25)) / math.tan(math.radians(30))
    assert found.status == "slides_on_basal"
    assert found.fos.closed_form == pytest.approx(by_hand, rel=1e-12)
    assert (found.comparisons.forces_only or found.fos.limit) == pytest.approx(by_hand, rel=1e-9)
    assert found.forces.normal["J1"] == found.forces.normal["J2"] == 0.0
    uplift = sk.run(put(design, water__pressures={"basal": 10.0}))
    pushed = (
        20.0 * area
        + (weight * math.cos(math.radians(30)) - 10.0 * area) * math.tan(math.radians(25))
    ) / (weight * 0.5)
    assert uplift.fos.closed_form == pytest.approx(pushed, rel=1e-12)


def test_what_it_shares_with_the_wedge_of_two_joints() -> None:
    """A flat basal joint a hair above the toe leaves all of its volume; a steep one, without cohesion, its factor."""
    wedge = {key: TROUGH[key] for key in ("slopekit", "kind", "rock")} | {
        "slope": {"face": "65/185", "upper": "12/195", "height": 30},
        "joints": {"J1": {"plane": "45/105"}, "J2": {"plane": "70/235"}},
        "strength": {"sand": {"c": 0, "phi": 25}},
    }
    two = sk.run(wedge)
    flat, steep = (
        sk.run(put(wedge, basal={"plane": plane, "height": 1e-3})) for plane in ("5/190", "40/190")
    )
    assert flat.geometry.volume_m3 == pytest.approx(two.geometry.volume_m3, rel=1e-6)
    assert steep.geometry.volume_m3 < 0.95 * two.geometry.volume_m3
    assert (two.status, steep.status) == ("slides_on_both", "slides_on_J1_and_J2")
    assert steep.fos.closed_form == pytest.approx(two.fos.closed_form, rel=1e-12)
    assert steep.comparisons.forces_only == pytest.approx(two.comparisons.forces_only, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("number", [1, 4, 20])
def test_turned_mirrored_moved_and_scaled_it_is_the_same(number) -> None:
    """By the closed form; c grows with the size."""
    one = [one.design for one in random_ones() if one.status[0] != "E"][number]
    design = put(
        {key: value for key, value in one.items() if key not in ("loads", "water", "support")}
    )
    factor = closed_form(sk.load(design)).factor

    def changed(turn, scale=1.0) -> dict:
        def plane(text: str) -> str:
            dip, _, direction = text.partition("/")
            return f"{dip}/{turn(float(direction)) % 360.0}"

        new = put(design)
        for holder in (
            *new["joints"].values(),
            new["basal"],
            *([new["crack"]] if "crack" in new else []),
        ):
            holder["plane"] = plane(holder["plane"])
        new["slope"] |= {key: plane(new["slope"][key]) for key in ("face", "upper")}
        for holder, key in (
            (new["slope"], "height"),
            (new["basal"], "height"),
            (new.get("crack", {}), "distance"),
        ):
            if key in holder:
                holder[key] *= scale
        for strength in new["strength"].values():
            strength["c"] *= scale
        return new

    for other in (
        changed(lambda at: at + 77.0),
        changed(lambda at: -at),
        changed(lambda at: at, 1e3),
        put(design, slope__origin=[5e5, 4e6, 120.0]),
    ):
        assert closed_form(sk.load(other)).factor == (factor and pytest.approx(factor, rel=1e-9))


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"basal__height": 11}, "E441"),
        ({"basal__plane": "30/000"}, "E443"),
        ({"basal__plane": "80/000", "basal__height": 9.9}, "E443"),
        ({"joints__J2__plane": "60/090"}, "E434"),
        ({"crack": {"plane": "90/180", "distance": 40}}, "E207"),
    ],
)
def test_planes_that_close_no_block_are_refused_alike_by_both_methods(change, code) -> None:
    design = put(TROUGH, **change)
    with pytest.raises(GeometryError) as refused:
        sk.run(design)
    assert refused.value.codes == (code,)
    with pytest.raises(GeometryError) as closed:
        closed_form(sk.load(design))
    assert closed.value.codes == (code,)


@pytest.mark.parametrize(
    ("change", "codes"),
    [
        ({"basal": {"plane": "30/180", "strength": "base"}}, ("E143",)),
        ({"basal__height": "4 kPa"}, ("E107",)),
        ({"basal__plane": "95/180"}, ("E101",)),
        ({"basal__strength": "bas"}, ("E176",)),
        ({"basal__high": 4}, ("E142",)),
        ({"joints": {"basal": {"plane": "60/090"}, "J2": {"plane": "60/270"}}}, ("E146",)),
        ({"water__pressures": [1, 2, 3, 4]}, ("E109",)),
    ],
)
def test_what_is_wrong_with_a_basal_joint_is_said(change, codes) -> None:
    with pytest.raises(DesignError) as refused:
        sk.load(put(TROUGH, **change))
    assert set(codes) <= set(refused.value.codes)


def test_a_call_takes_it_as_the_command_line_does() -> None:
    given = [
        "wedge",
        "--dips",
        "80/100",
        "78/262",
        "--face",
        "70/180",
        "--upper",
        "5/180",
        "--height",
        "20",
        "--basal",
        "28/185@4m",
        "--c",
        "0,0,10kPa",
        "--phi",
        "32,32,24",
        "--unit-weight",
        "26",
    ]
    code, out, _ = slopekit(*given, "--json")
    document = json.loads(out)
    from_file = sk.run(TEMPLATE, set={"crack": None})
    assert code == 0
    assert document["fos"]["limit"] == pytest.approx(from_file.fos.limit, rel=1e-12)
    assert list(document["geometry"]["areas_m2"]) == ["J1", "J2", "basal"]
    assert list(document["forces_kn"]["normal"]) == ["J1", "J2", "basal"]
    code, _, said = slopekit(*given[:10], "--basal", "28/185")
    assert code == 2
    assert "E447 basal is 28/185, it is written 20/180@5m" in said
    code, _, said = slopekit(*given[:12], "--c", "0,10")
    assert code == 2
    assert "three joints: give one value or three" in said


def test_studies_know_its_keys() -> None:
    design = sk.load(TEMPLATE)
    swept = sk.sweep(design, {"basal.plane.dip": [26.0, 30.0]})
    factors = [point.factors.closed_form for point in swept.points]
    assert [point.factors.agree for point in swept.points] == [True, True]
    assert factors[0] > factors[1]


def test_samples_that_scatter_are_evaluated_in_one_call() -> None:
    """The strength and the plane of a basal joint go where its fields say: one call gives what each design gives."""
    from slopekit.studies.evaluation.vectorised import vectorised

    document = put(TROUGH, joints__J1__plane="80/100", joints__J2__plane="80/260")
    document["basal"]["height"] = {"dist": "normal", "mean": 4, "sd": 0.2}
    document["strength"]["base"]["phi"] = {"dist": "normal", "mean": 25, "sd": 2}
    design = sk.load(document)
    keys = [key for variable in design.variables for key in variable.columns]
    values = np.array([[4.1, 24.0], [3.8, 27.0]])[
        :, [keys.index("basal.height"), keys.index("strength.base.phi")]
    ]
    asked = vectorised(
        design, values, lambda row: dict(zip(keys, values[row].tolist(), strict=True))
    )
    assert asked is not None
    one_by_one = [
        sk.run(document, set=dict(zip(keys, row.tolist(), strict=True))).fos.closed_form
        for row in values
    ]
    assert asked.rows(values).closed_form.factor == pytest.approx(one_by_one, rel=1e-12)


def test_passive_bolts_hold_what_active_ones_press() -> None:
    """A bolt square to the basal joint adds its normal force: F = (c A + (N + T) tan φ) / S where it acts as a load."""
    plain = BasalWedgeArrays(
        joint1_dip_deg=80.0,
        joint1_dip_direction_deg=100.0,
        joint2_dip_deg=80.0,
        joint2_dip_direction_deg=260.0,
        face_dip_deg=90.0,
        face_dip_direction_deg=180.0,
        upper_dip_deg=0.0,
        upper_dip_direction_deg=180.0,
        height_m=10.0,
        cohesion1_kpa=0.0,
        cohesion2_kpa=0.0,
        cohesion3_kpa=20.0,
        friction1_deg=20.0,
        friction2_deg=20.0,
        friction3_deg=25.0,
        unit_weight_kn_m3=25.0,
        basal_dip_deg=30.0,
        basal_dip_direction_deg=180.0,
        basal_height_m=4.0,
    )
    found = basal_wedges(plain)
    normal, driving, area = found.normal_kn[2, 0], found.driving_kn[0], found.areas_m2[2, 0]
    # square to a plane that dips 30° to the south: it drives nothing
    pressed = basal_wedges(
        dataclasses.replace(plain, force_kn=(0.0, 50.0, -math.sqrt(0.75) * 100.0))
    )
    assert OUTCOMES[pressed.outcome[0]] == "slides_on_basal"
    assert pressed.driving_kn[0] == pytest.approx(driving, rel=1e-12)
    assert pressed.factor[0] == pytest.approx(
        (20.0 * area + (normal + 100.0) * math.tan(math.radians(25))) / driving, rel=1e-12
    )
    # along the slide, upward, a passive bolt of T holds with T / F: F = (resisting + T) / driving
    held = basal_wedges(
        dataclasses.replace(plain, passive_kn=[(0.0, math.sqrt(0.75) * 50.0, 25.0)])
    )
    assert held.factor[0] == pytest.approx((found.resisting_kn[0] + 50.0) / driving, rel=1e-9)


def test_its_page_calls_it_by_its_name() -> None:
    """Title, what the closed form rests on, and the strengths with that of the third joint."""
    inputs = sk.load(TEMPLATE).inputs()
    said = words_named("wedge", inputs)
    assert (said.title, said.rests_on) == (
        "wedge on two joints and a basal joint",
        "vectors: forces only",
    )
    assert words_named("wedge", {}).title == "wedge on two joints"
    assert ("cohesion", "0, 0, 10 kPa") in input_rows(inputs)


CUT_OFF = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "60/180", "upper": "10/180", "height": 30},
    "joints": {
        "J1": {"plane": "45/115", "strength": "a"},
        "J2": {"plane": "50/240", "strength": "b"},
    },
    "basal": {"plane": "20/000", "height": 5, "strength": "c"},
    "strength": {"a": {"c": 10, "phi": 20}, "b": {"c": 15, "phi": 22}, "c": {"c": 5, "phi": 18}},
    "rock": {"unit_weight": 26},
    "acceptance": {"rules": ["fos >= 1.5"]},
}


@pytest.mark.parametrize(
    "change",
    [
        {},
        {"basal__plane": "15/180"},
        {"water": "full"},
        {"water__pressures": [3, 4, 5]},
        {"loads__seismic": {"k": 0.05, "toward": 170}},
        {
            "support__bolts": [
                {
                    "force": 400,
                    "toward": "000/05",
                    "acts": "passive",
                    "head": [0, -6, 12],
                    "length": 60,
                }
            ]
        },
        {"crack": {"plane": "90/180", "distance": "12 m"}, "water": "full"},
        {"loads__surcharge": "20 kPa"},
    ],
)
def test_the_wedge_whose_toe_is_cut_off_is_judged_too(change) -> None:
    """As the design without its basal joint, and its pressure, says of itself: another file, another closed form."""
    design = put(CUT_OFF, **change)
    found = sk.run(design)
    alone = put({key: value for key, value in design.items() if key != "basal"})
    del alone["strength"]["c"]
    if "pressures" in (alone.get("water") or ()):
        del alone["water"]["pressures"][2]
    whole = sk.run(alone)
    assert found.comparisons.without_basal.closed_form == pytest.approx(
        whole.fos.closed_form, rel=1e-12
    )
    assert whole.fos.closed_form < 1.5
    assert found.accepted is False
    assert found.exit_code == 1
    assert found.margin <= whole.fos.closed_form / 1.5 * (1.0 + 1e-12)
    said = next(str(notice) for notice in found.warnings if notice.code == "W410")
    assert f"FoS {whole.fos.closed_form:.4g} by the closed form" in said
    above, whole_row = found.to_dict()["mechanisms"]
    assert [row.blocks for row in found.mechanisms] == [("wedge",), ("whole wedge",)]
    assert (above["volume_m3"], above["height_m"]) == (
        found.geometry.volume_m3,
        found.size.height_m,
    )
    assert whole_row["volume_m3"] is None
    assert (above["mechanism"], above["fos"], above["mass_t"]) == (
        "block_above_basal",
        found.fos.limit,
        found.mass_t,
    )
    assert (whole_row["mechanism"], whole_row["fos"]) == (
        "whole_wedge",
        found.comparisons.without_basal.closed_form,
    )
    assert (
        f"whole_wedge {whole.fos.closed_form:.3f}" in found.line
        or found.fos.limit < whole.fos.closed_form
    )


def test_a_crack_may_be_fuller_than_the_joints() -> None:
    """Half the pressure of full water on the joints, all of it in the crack: by both methods as given in kPa."""
    crack = {"plane": "90/180", "distance": "6 m"}
    full = sk.run(put(SOCKET, crack=crack, water="full"))
    kpa = full.forces.water["J1"] / full.geometry.areas_m2["J1"]
    found = sk.run(put(SOCKET, crack=crack | {"water": "full"}, water="50 %"))
    given = sk.run(put(SOCKET, crack=crack, water__pressures=[kpa / 2, kpa / 2, kpa / 2, kpa]))
    assert found.agree is True
    assert found.fos.closed_form == pytest.approx(given.fos.closed_form, rel=1e-9)
    assert found.forces.water == pytest.approx(given.forces.water, rel=1e-9)
    assert found.fos.limit > 1.1 * full.fos.limit


def test_what_the_whole_wedge_keeps_is_met() -> None:
    """A rule below its factor; a wedge that does not daylight adds none."""
    met = sk.run(put(CUT_OFF, acceptance__rules=["fos >= 1.1"]))
    assert met.status == "no_driving_force"
    assert met.accepted is True
    assert met.margin == pytest.approx(met.comparisons.without_basal.closed_form / 1.1)
    assert {"W410"} <= {notice.code for notice in met.warnings}
    steep = {"joints__J1__plane": "88/100", "joints__J2__plane": "88/260", "basal__plane": "20/180"}
    other = sk.run(put(CUT_OFF, **steep))  # the line of J1 and J2 is steeper than the face
    assert other.comparisons.without_basal is None
    assert "W410" not in {notice.code for notice in other.warnings}


def test_a_basal_joint_into_the_slope_is_said() -> None:
    """Typed the wrong way round it holds all that lies on it."""
    said = [
        [
            notice.message
            for notice in sk.run(put(CUT_OFF, basal__plane=plane)).warnings
            if notice.code == "W410"
        ]
        for plane in ("20/000", "20/080", "20/180", "0/000")
    ]
    assert [any("dips into the slope" in message for message in each) for each in said] == [
        True,
        True,
        False,
        False,
    ]


#: A socket under a line of intersection that plunges into the slope: J1 and J2 alone cut no wedge (E204).
SOCKET = put(
    TROUGH,
    slope__face="74/180",
    joints__J1__plane="79/140",
    joints__J2__plane="62/320",
    basal__plane="27/163",
    basal__height=-3,
)


@pytest.mark.slow
@pytest.mark.parametrize("crack", [{"plane": "85/180"}, {"plane": "80/170", "water": "25 %"}])
def test_the_worst_crack_of_a_block_whose_sides_do_not_daylight(crack) -> None:
    """Scanned from the crest to behind the block, one at a time: nowhere lower than where it was put."""
    design = put(SOCKET, crack=crack)
    worst = sk.load(put(design, crack__distance="worst"))
    assert worst.crack is not None
    assert worst.crack_searched == "end"
    lowest = closed_form(worst).factor
    scanned = []
    for distance in np.linspace(1e-3, 20.0, 150):
        with suppress(GeometryError):  # behind the block
            scanned.append(
                closed_form(sk.load(put(design, crack__distance=float(distance)))).factor
            )
    assert 50 < len(scanned) < 150
    assert lowest <= min(scanned)
    assert lowest == pytest.approx(min(scanned), rel=1e-2)


@pytest.mark.parametrize("dip", ["85/180", "80/170", "70/195"])
def test_how_far_a_crack_still_cuts_the_block(dip) -> None:
    """A little before the reach it is one of its faces, a little behind it nothing is cut off."""
    (reach,) = crack_reach(sk.load(put(SOCKET, crack={"plane": dip, "distance": 1})))
    crack = {"plane": dip, "distance": 0.999 * reach}
    assert sk.run(put(SOCKET, crack=crack)).geometry.areas_m2["crack"] > 0.0
    with pytest.raises(GeometryError):
        sk.run(put(SOCKET, crack=crack | {"distance": 1.001 * reach}))


def test_a_block_that_only_a_crack_closes_has_no_farthest_crack() -> None:
    design = put(TROUGH, slope__upper="35/180", basal__plane="20/180")
    with pytest.raises(GeometryError, match="E443"):
        sk.run(design)
    cracked = put(design, crack={"plane": "85/180", "distance": 3})
    assert sk.run(cracked).geometry.volume_m3 > 0.0
    with pytest.raises(DesignError, match="E459 without the crack the block goes on"):
        sk.load(put(cracked, crack__distance="worst"))


def test_a_block_that_ends_before_the_crest_has_no_worst_crack() -> None:
    design = put(
        SOCKET,
        joints__J1__plane="84/048",
        joints__J2__plane="72/259",
        basal__plane="45/181",
        slope__face="63/180",
    )
    assert sk.run(put(design, basal__height=-2)).fos.limit is not None
    with pytest.raises(DesignError, match="E459 no place of the crack"):
        sk.load(put(design, basal__height=-2, crack={"plane": "85/180", "distance": "worst"}))


#: J1 and J2 mirror each other: their line plunges due south by atan(tan 80° cos 80°) = 44.6°, the face faces south.
MIRRORED = put(
    TROUGH,
    joints__J1__plane="80/100",
    joints__J2__plane="80/260",
    slope__face="70/180",
    slope__upper="5/180",
)


@pytest.mark.parametrize(("dip", "locked"), [(30, True), (40, True), (47, False), (50, False)])
def test_a_socket_that_closes_toward_the_face_is_no_block_that_could_fall(dip, locked) -> None:
    """Its roof falls outward at 44.6°: a base that is flatter locks it, a steeper one lets it out, by both methods.

    Without a crack behind it the rock between them goes on to the upper slope, or without end (Goodman & Shi).
    """
    steep = math.radians(80)
    assert math.degrees(math.atan(math.tan(steep) * math.cos(steep))) == pytest.approx(44.6, 1e-2)
    basal = {"plane": f"{dip}/180", "height": -3, "strength": "base"}
    design = put(MIRRORED, basal=basal, crack={"plane": "85/180", "distance": "3 m"})
    if not locked:
        assert sk.run(design).status != "no_driving_force"
        return
    for analysed in (sk.run, lambda given: closed_form(sk.load(given))):
        with pytest.raises(GeometryError, match="E232") as error:
            analysed(design)
        assert error.value.exit_code == 3
    with pytest.raises(GeometryError, match="E232 the block cannot leave the slope") as error:
        sk.run(design)
    assert error.value.faults[0].advice.endswith(
        "as the height of the basal joint is -3 m: was 3 m meant?"
    )
    swept = sk.sweep(sk.load(design), {"basal.height": [-3.0, 3.0]}, closed_form=True)
    assert [point.code for point in swept.points] == ["E232", ""]


def test_a_socket_asks_whether_its_height_was_meant() -> None:
    """It stands, and no strength is called on: the sheet says that its rule is met without a number."""
    basal = {"plane": "30/180", "height": -3, "strength": "base"}
    found = sk.run(put(MIRRORED, basal=basal, acceptance={"rules": ["fos >= 1.3"]}))
    assert (found.status, found.accepted) == ("no_driving_force", True)
    said = " ".join(str(found).split())
    assert "W410 a socket wedge: basal.height is -3 m, so it lies under J1 and J2" in said
    assert "(is 3 m meant?)" in said
    assert (
        "fos >= 1.3 (limit): MET (it stands without any strength: there is no factor to judge)"
        in said
    )


def test_the_height_of_the_slope_is_told_from_that_of_the_block() -> None:
    """The block above a basal joint is lower than its slope: `height 20 m (total 16.7 m)` read like a contradiction."""
    found = result_of("wedge-basal")
    corners = found.scene.shapes.solids.vertices[:, 2]
    size = found.sheet.full.partition("SIZE")[2].partition("LOADS")[0]
    assert size.split("  volume")[0].strip() == "height 20 m"
    assert f"the block {np.ptp(corners):.3g} m high" in size
    whole = result_of("wedge").sheet.full.partition("SIZE")[2].partition("LOADS")[0]
    assert whole.split("  volume")[0].strip() == "height 64.9 m"
    assert "the block 100 m high" in whole


def test_a_bolt_that_ends_below_the_basal_joint_does_not_hold_the_whole_wedge() -> None:
    """It ends in rock that is part of the wedge on J1 and J2: run alone that refuses it (E212) and has less without."""
    design = {
        "slopekit": 1,
        "kind": "wedge",
        "slope": {"face": "65/180", "upper": "5/180", "height": 20},
        "joints": {
            "J1": {"plane": "60/130", "strength": "a"},
            "J2": {"plane": "60/230", "strength": "a"},
        },
        "basal": {"plane": "20/180", "height": 6, "strength": "b"},
        "acceptance": {"rules": ["fos >= 1"]},
        "strength": {"a": {"c": 5, "phi": 34}, "b": {"c": 0, "phi": 36}},
        "rock": {"unit_weight": 26},
    }
    alone = {key: value for key, value in design.items() if key != "basal"} | {
        "strength": {"a": {"c": 5, "phi": 34}}
    }
    bolts = {
        length: {
            "bolts": [{"force": 1500, "toward": "000/60", "head": [0, 3.3, 7], "length": length}]
        }
        for length in (2.0, 2.5)
    }
    short, long = (sk.run(design | {"support": bolts[length]}) for length in (2.0, 2.5))
    with pytest.raises(sk.SlopekitError, match="E212"):
        sk.run(alone | {"support": bolts[2.0]})
    assert short.comparisons.without_basal.closed_form == pytest.approx(
        sk.run(alone).fos.closed_form, rel=1e-12
    )
    assert long.comparisons.without_basal.closed_form == pytest.approx(
        sk.run(alone | {"support": bolts[2.5]}).fos.closed_form, rel=1e-12
    )
    assert (short.accepted, long.accepted) == (False, True)
    assert "without the basal joint and 1 of 1 bolt (that end within it" in next(
        str(notice) for notice in short.warnings if notice.code == "W410"
    )
