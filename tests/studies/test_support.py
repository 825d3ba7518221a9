"""`slopekit support`: forces put back, optima against brute force and book formulas, heads and lengths, refusals.

Nothing here takes the forces from slopekit's own algebra: they are put back as bolts of a new design, directions are
tried one by one with the closed form, heads and lengths are measured against planes through the toe.
"""

import json
import math
from dataclasses import replace
from html import escape
from pathlib import Path

import numpy as np
import pytest
from ruamel.yaml import YAML

import slopekit as sk
from slopekit.core.errors import DesignError, Notice
from slopekit.core.orientation import Line, line_of
from slopekit.design.parts import Bolt
from slopekit.design.templates import path_of
from slopekit.kinds import cut, factors_of
from slopekit.kinds.single_block.held_bolts import bolt_exit
from slopekit.kinds.wedge import bounds, closed_form
from slopekit.kinds.wedge.design import wedge_design
from slopekit.kinds.words import short
from slopekit.loads import check_bolt_anchorage
from slopekit.studies import points
from slopekit.studies.support import run as module
from slopekit.studies.support.search import (
    Answer,
    Site,
    best_direction,
    least_force,
    least_forces,
    site_of,
)
from tests.closed_form.scalar_wedge import hoek_bray_wedge
from tests.commands import slopekit
from tests.support import random_wedge, upward_normal

PLANE = {
    "slopekit": 1,
    "kind": "plane",
    "slope": {"face": "60/180", "height": 12},
    "rock": {"unit_weight": 26},
    "joints": {"J1": {"plane": "35/180"}},
    "strength": {"s": {"c": 25, "phi": 37}},
}
WEDGE = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "65/180", "upper": "0/180", "height": 10},
    "joints": {"J1": {"plane": "45/125"}, "J2": {"plane": "50/235"}},
    "strength": {"s": {"c": 5, "phi": 25}},
    "rock": {"unit_weight": 26},
}
#: cases.json, 9_single-plane: slides on J1 alone, where moments govern
ONE_PLANE = WEDGE | {
    "joints": {"J1": {"plane": "45/160"}, "J2": {"plane": "80/240"}},
    "strength": {"s": {"c": 20, "phi": 30}},
}
#: a slab on a gentle plane, three times as high as it is deep: it turns over before it slides
SLAB = PLANE | {
    "slope": {"face": "85/180", "height": 10, "upper": "0/180"},
    "joints": {"J1": {"plane": "30/180"}},
    "crack": {"distance": 0.5},
    "strength": {"s": {"c": 5, "phi": 40}},
    "loads": {"seismic": 0.1},
}


def loaded(design: dict, **values):
    return sk.load(design, set=values)


def put_back(design, *bolts: dict, forces=()):
    """Both factors of a design with more bolts and forces, read again from its document."""
    document = design.source.root.plain()
    document.setdefault("support", {}).setdefault("bolts", [])
    document["support"]["bolts"] = [*document["support"]["bolts"], *bolts]
    if forces:
        document.setdefault("loads", {})["forces"] = list(forces)
    found = factors_of(sk.load(document))
    return found.closed_form, found.limit


def as_bolt(force: float, line: Line, acts: str) -> dict:
    return {"force": force, "toward": f"{line.trend_deg!r}/{line.plunge_deg!r}", "acts": acts}


def pulled_at_middle(design, case):
    """A design with the force that PRE-IE needs, on one bolt from the middle of the heads."""
    place = site_of(design).place(case.layout.middle_m)
    return replace(
        design, bolts=(*design.bolts, Bolt(case.pre_ie.force, case.toward, case.acts, place))
    )


def notices_of(found) -> dict[str, str]:
    return {notice.code: notice.message for case in found.cases for notice in case.all_notices}


# -- put back --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", [0, 1])  # every branch that five take
def test_forces_on_random_planes_give_the_target_when_put_back(seed) -> None:
    """Both methods, active and passive, given and best direction, pressure: within 1e-6, never below."""
    rng = np.random.default_rng(seed)
    face, dip = rng.uniform(50, 85), rng.uniform(25, 45)
    design = loaded(
        PLANE,
        slope={"face": f"{face}/140", "height": float(rng.uniform(5, 40)), "upper": "5/140"},
        joints={"J1": {"plane": f"{dip}/{rng.uniform(130, 150)}"}},
        strength={"s": {"c": float(rng.uniform(0, 10)), "phi": float(rng.uniform(15, 30))}},
        loads={"seismic": float(rng.uniform(0, 0.15))},
        water={"fill": float(rng.uniform(0, 0.4))},
    )
    bare = factors_of(design)
    target = round(bare.closed_form * float(rng.uniform(1.1, 2.0)), 3)
    found = sk.support(design, target, toward=(300.0, 5.0))  # 20° off the section
    assert found.reached
    for case in found.cases:
        bolt = as_bolt(case.closed_form.force, case.toward, case.acts)
        assert put_back(design, bolt)[0] == pytest.approx(target, abs=1e-6)
        limit = factors_of(pulled_at_middle(design, case)).limit
        assert limit == pytest.approx(target, abs=1e-6)
        assert limit >= target
        assert case.pre_ie.answer.factor == pytest.approx(target, abs=1e-6)
    site = site_of(design)
    press = factors_of(site.pressed(found.pressure * site.area, site.face.mean(axis=0)))
    assert min(press.limit, press.closed_form) == pytest.approx(target, abs=1e-6)


#: random wedges that slide: dry, wet, with an earthquake
SEEDS = (0, 73, 88)


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_forces_on_random_wedges_give_the_target_when_put_back(seed) -> None:
    given = random_wedge(np.random.default_rng(seed))
    design = wedge_design(given)
    target = round(closed_form(design).factor * 1.3, 2)
    weight = -float(cut(design).loads.components["weight"][2])
    acts = "passive" if SEEDS.index(seed) % 2 else "active"
    toward = ((given["face"][1] + 180.0) % 360.0, 5.0) if seed < 40 else None
    found = sk.support(design, target, acts=acts, toward=toward, bolt_capacity=weight)
    assert found.reached
    for case in found.cases:
        assert toward is None or _pair(case.toward) == toward
        bolt = {"force": case.closed_form.force, "toward": _pair(case.toward), "acts": acts}
        closed = wedge_design(given | {"bolts": [*given.get("bolts", ()), bolt]})
        assert closed_form(closed).factor == pytest.approx(target, abs=1e-6)
        assert closed_form(closed).factor >= target
        assert factors_of(pulled_at_middle(design, case)).limit == pytest.approx(target, abs=1e-6)


def _pair(line: Line) -> tuple[float, float]:
    return line.trend_deg, line.plunge_deg


# -- the best direction ------------------------------------------------------------------------------------------


def _brute(given: dict, directions: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """Factors (f, d) of active forces along directions: Hoek & Bray's wedge, one call each, 0 without a number."""
    design = wedge_design(given)
    planes = design.joints, design.face, design.upper, design.height_m
    strength = design.cohesion_kpa, design.friction_angle_deg, design.rock.unit_weight_kn_m3
    out = np.zeros((len(forces), len(directions)))
    for i, force in enumerate(forces):
        for j, direction in enumerate(directions):
            out[i, j] = (
                hoek_bray_wedge(*planes, *strength, forces=[(force * direction).tolist()]).factor
                or 0.0
            )
    return out


@pytest.mark.parametrize(
    ("dips", "strength", "target"),
    [
        ((("45/160"), ("80/240")), (0, 45), 1.8),  # on J1 alone
        (
            (("45/125"), ("50/235")),
            (5, 25),
            6.0,
        ),  # on both, and so much that the mode changes on the way
    ],
)
def test_no_direction_that_is_set_out_needs_less(dips, strength, target) -> None:
    """Brute force: at every smaller force no direction in steps of 5° gives the target."""
    given = {
        "dips": dips,
        "face": "65/180",
        "upper": "0/180",
        "height": 10,
        "c": strength[0],
        "phi": strength[1],
        "unit_weight": 26,
    }
    site = site_of(wedge_design(given))
    best = best_direction(site, target, (-90.0, 90.0))
    (force,) = least_forces(site, target, best.vector()[None, :])
    every = [
        Line(trend, plunge).vector() for trend in range(0, 360, 15) for plunge in range(-85, 90, 10)
    ]
    into_face = [way for way in every if way @ site.inward > math.sin(math.radians(5.0))]
    less = _brute(given, np.array(into_face), force * np.array([0.2, 0.6, 0.9, 0.9999]))
    assert less.max() < target
    assert _brute(given, best.vector()[None, :], np.array([force]))[0, 0] == pytest.approx(
        target, abs=1e-6
    )


@pytest.mark.parametrize(("cohesion", "phi"), [(0.0, 40.0), (10.0, 15.0)])
def test_the_best_direction_on_a_plane_is_hoek_and_brays(phi, cohesion) -> None:
    """Wyllie & Mah (2004), eq. 6.24: F (W sin ψ - T cos θ) = c L + (W cos ψ + T sin θ) tan φ.

    The least T has tan θ = tan φ / F; θ is the angle of the bolt above the plane. A passive bolt pulls with T / F, so
    that it needs F times as much.
    """
    face, psi, height, target = 60.0, 35.0, 12.0, 1.9
    design = loaded(PLANE, strength={"s": {"c": cohesion, "phi": phi}})
    dip, slope = math.radians(psi), math.tan(math.radians(phi))
    corner = height * (1.0 / math.tan(dip) - 1.0 / math.tan(math.radians(face)))  # of the level top
    weight, length = 26.0 * 0.5 * height * corner, height / math.sin(dip)
    theta = math.atan(slope / target)
    lacking = target * weight * math.sin(dip) - cohesion * length - weight * math.cos(dip) * slope
    force = lacking / (target * math.cos(theta) + slope * math.sin(theta))
    plunge = math.degrees(theta) - psi
    along = np.array([Line(0.0, plunge + off).vector() for off in (0.0, -2.0, 2.0)])
    least = least_forces(site_of(design), target, along)
    assert least[0] == pytest.approx(force, rel=1e-6)
    assert least[0] < least[1:].min()
    active, passive = sk.support(design, target).cases
    assert abs(active.toward.plunge_deg - max(plunge, 0.0)) <= 2.5
    assert passive.toward == active.toward
    assert passive.closed_form.force == pytest.approx(target * active.closed_form.force, rel=1e-6)


def test_limits_of_plunge_hold_and_their_best_is_the_best_within() -> None:
    """Against every direction within the limits on a grid of 2° and 1°, each solved by bisection on the closed form."""
    design = loaded(WEDGE)
    case = sk.support(design, 1.6, acts="active", plunge="10,30").cases[0]
    assert 10.0 <= case.toward.plunge_deg <= 30.0
    given = {
        "dips": ("45/125", "50/235"),
        "face": "65/180",
        "upper": "0/180",
        "height": 10,
        "c": 5,
        "phi": 25,
        "unit_weight": 26,
    }
    grid = [
        Line(t, p).vector()
        for t in np.arange(300.0, 420.0, 4.0)
        for p in (10.0, 11.0, 14.0, 20.0, 30.0)
    ]
    assert (
        _brute(given, np.array(grid), case.closed_form.force * np.array([0.7, 0.999])).max() < 1.6
    )
    assert sk.support(design, 1.6, acts="active", plunge="12,13").cases[0].toward.plunge_deg in (
        12.0,
        13.0,
    )


# -- bolts that are there, and what is enough already ------------------------------------------------------------------


def test_bolts_of_the_design_stay_and_count() -> None:
    bare = sk.support(loaded(WEDGE), 1.6, toward="000/10").cases
    for acts, case in zip(("active", "passive"), bare, strict=True):
        half = as_bolt(case.closed_form.force / 2.0, case.toward, acts)
        design = loaded(WEDGE | {"support": {"bolts": [half]}})
        other = next(
            c for c in sk.support(design, 1.6, acts=acts, toward="000/10").cases if c.acts == acts
        )
        assert other.closed_form.force == pytest.approx(case.closed_form.force / 2.0, rel=1e-6)
        assert other.yaml.count("acts:") == 1 + len(other.bolts)


def test_a_slope_that_is_stable_enough_needs_nothing() -> None:
    found = sk.support(loaded(PLANE), 1.2)
    assert found.stands
    assert found.exit_code == 0
    assert found.cases == ()
    assert found.to_dict()["needed"] is False
    assert "no more support is needed" in str(found)
    assert found.line.startswith("reached  nothing needed")


def test_what_only_moments_ask_for_is_found_by_pre_ie_alone() -> None:
    """ONE_PLANE: 1.578 with moments, 1.677 without; the target lies between."""
    case = sk.support(loaded(ONE_PLANE), 1.6, acts="active").cases[0]
    assert case.closed_form.force == 0.0
    assert case.pre_ie.force > 0.0
    assert case.reached
    assert factors_of(pulled_at_middle(loaded(ONE_PLANE), case)).limit == pytest.approx(
        1.6, abs=1e-6
    )


def test_joints_that_dilate_need_what_pre_ie_says() -> None:
    """The closed form knows no dilation: its force is shown, PRE-IE's smaller one is the one to use."""
    design = loaded(WEDGE, **{"strength.s.dilation": 6})
    case = sk.support(design, 1.6, acts="active").cases[0]
    assert case.pre_ie.force < 0.99 * case.closed_form.force
    assert case.force == case.pre_ie.force
    assert factors_of(pulled_at_middle(design, case)).limit == pytest.approx(1.6, abs=1e-6)


# -- heads on the face -------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def turning():
    return sk.support(loaded(ONE_PLANE), 1.8, bolt_capacity=150.0, bond=2.5)


@pytest.mark.slow
def test_moments_govern_and_the_larger_number_is_the_one_to_use(turning) -> None:
    for case in turning.cases:
        assert case.pre_ie.force > 1.05 * case.closed_form.force
        assert case.force == case.pre_ie.force
        assert case.pre_ie.answer.moments_govern
        assert case.pre_ie.answer.factor == pytest.approx(1.8, abs=1e-6)
        assert f"to use: {short(case.force)}" in " ".join(str(turning).split())
    sheet = str(turning)
    assert "moments govern: the closed form knows none" in sheet
    assert max(map(len, sheet.splitlines())) <= 100


@pytest.mark.slow
def test_heads_lie_on_the_face_and_bolts_reach_behind_the_joint(turning) -> None:
    """Measured against planes through the toe: the face, and the first joint that each bolt meets."""
    case = turning.cases[0]
    laid = case.layout
    geometry = sk.run(ONE_PLANE).geometry
    toe, crest1, crest2 = (geometry.corners_m[name] for name in ("toe", "crest_J1", "crest_J2"))
    shares = np.linalg.solve(
        np.array([toe, crest1, crest2]).T + 1.0, laid.heads_m.T + 1.0
    ).T  # barycentric
    assert np.abs(laid.heads_m @ upward_normal((65.0, 180.0))).max() < 1e-9
    assert shares.min() > 0.0
    assert np.abs(shares.sum(axis=1) - 1.0).max() < 1e-9
    joints = np.array([upward_normal((45.0, 160.0)), upward_normal((80.0, 240.0))])
    reach = -(laid.heads_m @ joints.T) / (case.toward.vector() @ joints.T)
    deepest = np.where(reach > 1e-9, reach, np.inf).min(axis=1)
    assert laid.sound_m == pytest.approx(deepest, abs=1e-9)
    assert case.lengths == pytest.approx(np.ceil((deepest + 2.5) * 10.0) / 10.0, abs=1e-9)
    apart = laid.heads_m[:, None, :] - laid.heads_m[None, :, :]
    away = np.sqrt((apart**2).sum(axis=2))
    assert away[away > 0.0].min() == pytest.approx(laid.across_m, rel=1e-9)
    assert len(laid) >= laid.needed
    assert len(laid) >= case.force / 150.0
    assert case.each == math.ceil(case.force / len(laid) / 10.0) * 10.0
    assert len(np.unique(laid.heads_m[:, 2].round(6))) == laid.rows


def test_the_loads_own_check_passes_every_bolt_and_refuses_shorter_ones(turning) -> None:
    """The check that `run` makes of each bolt: E212 where it ends before the joint."""
    planes = bounds(
        wedge_design(
            {"dips": ("45/160", "80/240"), "face": "65/180", "upper": "0/180", "height": 10.0}
        )
    )
    case = turning.cases[0]
    sound, is_anchored = bolt_exit(planes, case.layout.heads_m, case.toward.vector())
    assert is_anchored.all()
    assert sound == pytest.approx(case.layout.sound_m, abs=1e-9)
    for reach, length in zip(sound.tolist(), case.layout.sound_m + 2.5, strict=True):
        check_bolt_anchorage("bolt", reach, True, length, "")
        with pytest.raises(sk.GeometryError) as caught:
            check_bolt_anchorage("bolt", reach, True, length - 2.5001, "")
        assert caught.value.codes == ("E212",)


@pytest.mark.parametrize(
    ("design", "capacity", "fos", "acts"),
    [
        (PLANE, 20.0, 1.7, "active"),
        (PLANE, 97.3, 2.345, "passive"),
        (WEDGE, 400.0, 1.7, "active"),
    ],
    ids=["plane, many", "plane", "wedge, few"],
)
def test_the_yaml_pasted_into_the_design_meets_the_target(
    design, capacity, fos, acts, tmp_path
) -> None:
    """Every digit comes from the text alone: design file + snippet -> `run`; never below, and hardly above.

    Set out in the field's steps: 10 kN, 0.1 m and 5°.
    """
    found = sk.support(loaded(design), fos, acts=acts, bolt_capacity=capacity)
    assert found.reached
    pasted = _pasted(design, found, acts, tmp_path).fos
    assert fos <= pasted.limit <= fos * 1.05
    assert pasted.closed_form >= fos
    (case,) = found.cases
    slice_m = case.layout.across_m if found.unit == "kN/m" else 1.0
    each = case.force * slice_m / len(case.bolts)
    for bolt in case.bolts:  # up to 10 kN a bolt, but no more than it can take
        assert slice_m * bolt.force_kn == pytest.approx(
            min(10.0 * math.ceil(each / 10.0), capacity), rel=1e-4
        )
        assert bolt.length_m == pytest.approx(round(bolt.length_m, 1), abs=1e-12)
        assert bolt.toward.plunge_deg % 5.0 == 0.0
        assert bolt.toward.trend_deg % 5.0 == 0.0


def test_what_is_to_be_pasted_is_the_same_everywhere() -> None:
    found = sk.support(loaded(PLANE), 1.9, acts="active")
    (text,) = found.files().values()
    assert text in f"{found}\n"
    assert found.to_dict()["bolts"][0]["yaml"] == text
    assert {"verbatim": text} in found.to_dict()["sheet"]["PASTE"]
    assert f"<pre>{escape(text)}</pre>" in found.sheet._repr_html_()


@pytest.mark.parametrize("acts", ["active", "passive"])
def test_the_yaml_of_bolts_whose_moments_govern_meets_the_target(turning, acts, tmp_path) -> None:
    assert 1.8 <= _pasted(ONE_PLANE, turning, acts, tmp_path).fos.limit <= 1.8 * 1.02


@pytest.mark.slow
def test_bolts_that_are_enough_are_kept_where_fewer_would_not_be() -> None:
    """Three passive bolts ask for what two could take, and two for more than that: three are built."""
    found = sk.support(loaded(ONE_PLANE), 1.8, acts="passive", bolt_capacity=250.0, bond=2.5)
    (case,) = (case for case in found.cases if case.bolts)
    assert len(case.bolts) == 3
    assert case.force <= 3 * 250.0
    assert 1.8 <= case.factors.limit <= 1.8 * 1.02
    assert found.reached


def test_where_the_target_is_not_reached_there_is_nothing_to_paste(monkeypatch) -> None:
    """One force through the centroid gives the target when it is run, and cannot be built: it is no file."""
    short = sk.support(loaded(PLANE), 2, acts="active", length="5 m")
    bare = short.pre_ie.factor
    assert (short.reached, short.files(), short.cases[0].support) == (False, {}, None)
    said = " ".join(str(short).split())
    assert f"NOT REACHED, FoS 2: no bolts give it (E212), without them FoS {bare:.4f}" in said
    assert max(map(len, str(short).splitlines())) <= 100
    reached = sk.support(loaded(PLANE), 2, acts="active")
    assert [one[:8] for one in reached.files().values()] == ["support:"]
    at_no_force = [Answer(factors.limit, factors.status) for factors in [factors_of(loaded(PLANE))]]
    answers = Site.answers

    def without_bolts(self, design, key, method, forces):
        return (
            at_no_force * len(forces)
            if method == "pre_ie"
            else answers(self, design, key, method, forces)
        )

    monkeypatch.setattr(Site, "answers", without_bolts)
    none = sk.support(loaded(PLANE), 2, acts="active")  # bolts that hold nothing
    assert none.files() == {}
    assert "NOT REACHED, FoS 2: no bolts give it (E329)" in " ".join(str(none).split())


@pytest.mark.slow
@pytest.mark.parametrize("capacity", [150.0, 5.0], ids=["few", "more than 50"])
def test_bolts_that_fall_short_when_they_are_solved_again_are_not_reached(
    monkeypatch, capacity
) -> None:
    """Of any number of bolts: the file says so first, and so do the line, the sheet and the exit code."""
    monkeypatch.setattr(module, "built_force", lambda needed, _: 0.9 * needed)
    found = sk.support(loaded(ONE_PLANE), 1.8, acts="active", bolt_capacity=capacity)
    (text,) = found.files().values()
    first, rest = text.split("\n", 1)
    assert first.startswith("# NOT REACHED, FoS 1.8: solved again with these bolts FoS 1.")
    pasted = sk.run(ONE_PLANE | YAML(typ="safe").load(rest[rest.index("support:") :]))
    assert f"FoS {pasted.fos.limit:.4f} by PRE-IE" in first
    assert (len(pasted.design.bolts) > 50) is (capacity == 5.0)
    assert (found.reached, found.exit_code) == (False, 1)
    assert found.line.startswith("active  not reached")
    assert "NOT REACHED, FoS 1.8: solved again" in " ".join(str(found).split())
    assert found.to_dict()["bolts"][0]["check"]["met"] is False


def test_bolts_whose_design_has_no_answer_reach_nothing(monkeypatch) -> None:
    """PRE-IE that does not converge with the bolts is no factor: not reached, and exit code 4 as `run` has it."""
    honest = points.factors_of

    def lost(design, _):  # with the bolts as they are built, which are several
        gone = {"limit": None, "status": "not_converged", "agree": None}
        return replace(honest(design), **gone if len(design.bolts) > 1 else {})

    monkeypatch.setattr(points, "factors_of", lost)
    found = sk.support(loaded(PLANE), 1.9, acts="active")
    assert (found.reached, found.exit_code) == (False, 4)
    assert "not converged by PRE-IE; FoS 1.9" in found.cases[0].lacks
    assert found.cases[0].yaml.startswith("# NOT REACHED")


def test_bolts_closer_than_a_metre_are_noted() -> None:
    for design in (PLANE, WEDGE):
        close = sk.support(loaded(design), 1.9, acts="active", bolt_capacity=3.0)
        assert close.reached
        assert "W311" in notices_of(close)
        assert "W311" in close.line
        assert "closer than 1 m" in " ".join(str(close).split())
        wide = sk.support(loaded(design), 1.9, acts="active", bolt_capacity=400.0)
        assert "W311" not in notices_of(wide)


def _pasted(design: dict, found, acts: str, folder: Path):
    text = found.files()[f"support-{acts}.yaml"]
    assert max(map(len, text.splitlines())) <= 100
    body = "\n".join(f"{key}: {json.dumps(value)}" for key, value in design.items())
    (folder / "design.yaml").write_text(f"{body}\n{text}", encoding="utf-8")
    result = sk.run(folder / "design.yaml")
    case = next(case for case in found.cases if case.acts == acts)
    assert len(result.design.bolts) == len(case.layout)
    assert "W311" not in {notice.code for notice in result.warnings}  # every bolt has its head
    return result


def test_map_coordinates_move_the_heads_with_the_toe() -> None:
    at = [500_000.0, 4_000_000.0, 1000.0]
    near = sk.support(loaded(WEDGE), 1.9, acts="active").cases[0]
    far = sk.support(loaded(WEDGE, **{"slope.origin": at}), 1.9, acts="active").cases[0]
    assert far.layout.heads_m - at == pytest.approx(near.layout.heads_m, abs=1e-6)
    assert far.closed_form.force == pytest.approx(near.closed_form.force, rel=1e-9)


#: a wedge whose middle stands before its tension crack
CRACKED = WEDGE | {
    "slope": {"face": "65/180", "upper": "0/180", "height": 30},
    "crack": {"plane": "80/180", "distance": 8},
}


@pytest.mark.parametrize(
    ("design", "fos"),
    [(PLANE | {"crack": {"depth": 4.35, "water": 3.0}}, 1.5), (CRACKED, 1.3)],
    ids=["plane", "wedge"],
)
def test_bolts_hold_behind_the_joint_where_they_cross_the_tension_crack_first(design, fos) -> None:
    """No place is left out: rock hangs on the joint behind the crack as before it; the reach is that to the joint.

    Measured against the joints' planes through the toe; without the crack the same bolts of the same length are taken.
    """
    found = sk.support(loaded(design), fos, acts="active", bolt_capacity=1e3)
    case = found.cases[0]
    laid, way = case.layout, case.toward.vector()
    assert (found.exit_code, laid.left_out) == (0, 0)
    dips = [joint["plane"].split("/") for joint in design["joints"].values()]
    joints = np.array([upward_normal((float(dip), float(direction))) for dip, direction in dips])
    reach = -(laid.heads_m @ joints.T) / (joints @ way)
    assert laid.sound_m == pytest.approx(
        np.where(reach > 1e-9, reach, np.inf).min(axis=1), abs=1e-9
    )
    bolted = design | {"support": case.support}
    with_crack = sk.run(bolted)
    assert with_crack.fos.limit >= fos
    crack = (
        sk.run(design).geometry.crack_distance_m + 12.0 / math.tan(math.radians(60.0))
        if fos == 1.5
        else 0.0
    )
    ends = laid.heads_m + laid.sound_m[:, None] * way
    assert (ends[:, 1].max() > crack) if fos == 1.5 else len(laid) == 14
    longest = int(np.argmax(laid.sound_m))
    short = [dict(bolt) for bolt in case.support["bolts"]]
    short[longest]["length"] = float(laid.sound_m[longest]) - 0.01
    with pytest.raises(sk.GeometryError, match=r"E212 bolt .* sound rock begins after"):
        sk.run(design | {"support": {"bolts": short}})


def test_a_bolt_that_comes_out_behind_the_crack_is_anchored_in_nothing() -> None:
    """Steeply upward it meets the upper slope before the joint, with the crack in the crest and in the face alike."""
    for distance in (3.0, -2.0):
        design = PLANE | {"crack": {"distance": distance}}
        bolt = {
            "force": 10,
            "toward": "000/-33",
            "acts": "active",
            "head": [0, 1, math.tan(math.radians(60.0))],
        }
        with pytest.raises(sk.GeometryError, match="E211"):
            sk.run(design | {"support": {"bolts": [bolt]}})
        sk.run(design | {"support": {"bolts": [bolt | {"toward": "000/0"}]}})


def test_rows_and_columns_are_even_over_the_face() -> None:
    """Every place of the grid that lies a quarter of the spacing within the face has its bolt."""
    found = sk.support(loaded(CRACKED), 1.3, acts="active", bolt_capacity=500.0)
    case = found.cases[0]
    laid = case.layout
    assert laid.across_m == laid.up_m == round(laid.across_m, 1)
    up = np.array([0.0, math.cos(math.radians(65.0)), math.sin(math.radians(65.0))])
    heads = np.stack([laid.heads_m[:, 0], laid.heads_m @ up], axis=1)
    corners = sk.run(CRACKED).geometry.corners_m
    face = np.array(
        [[corners[name][0], np.dot(corners[name], up)] for name in ("toe", "crest_J2", "crest_J1")]
    )
    centre = face.mean(axis=0)
    step = laid.across_m * np.stack(np.meshgrid(range(-40, 41), range(-40, 41)), axis=-1).reshape(
        -1, 2
    )
    grid = heads[0] + step
    within = np.ones(len(grid), dtype=bool)
    for a, b in zip(face, np.roll(face, -1, axis=0), strict=True):
        inward = np.array([a[1] - b[1], b[0] - a[0]]) / math.dist(a, b)
        inward *= np.sign(inward @ (centre - a))
        within &= (grid - a) @ inward >= 0.25 * laid.across_m - 1e-9
    assert within.sum() == len(laid)
    assert laid.left_out == 0
    places = laid.rows * laid.columns
    assert places > len(laid)
    said = (
        f"{laid.across_m:g} m apart (the other {places - len(laid)} places of that grid stay empty)"
    )
    assert said in " ".join(str(found).split())


# -- where there is no answer ------------------------------------------------------------------------------------------


def test_other_kinds_are_refused() -> None:
    with pytest.raises(DesignError) as caught:
        sk.support(sk.load(path_of("footing")))
    assert caught.value.codes == ("E288",)
    fault = caught.value.faults[0]
    assert (fault.message[-15:], fault.advice) == (
        "of kind footing",
        "A design of kind footing takes no bolts.",
    )


def test_every_option_that_is_not_understood_is_named_at_once() -> None:
    with pytest.raises(DesignError) as caught:
        sk.support(
            loaded(PLANE),
            -1,
            acts="both ways",
            toward="up",
            plunge="20,10",
            bolt_capacity="5 m",
            spacing=0,
            bond="x",
            length=-3,
        )
    assert sorted(caught.value.codes) == [
        "E106",
        "E107",
        "E307",
        "E307",
        "E307",
        "E307",
        "E307",
        "E307",
    ]
    for plunge in ("5", (1, 2, 3), "-100,5"):
        with pytest.raises(DesignError, match="E307 limits of plunge"):
            sk.support(loaded(PLANE), plunge=plunge)


OUT_OF_REACH = [
    (
        "E322",
        PLANE,
        {"toward": "180/10", "acts": "active"},
        "it drives the block as much as it holds it",
    ),
    ("E322", PLANE, {"toward": "000/75", "acts": "active", "fos": 2.5}, "at best FoS"),
    (
        "E322",
        WEDGE,
        {"toward": "270/-30", "acts": "active", "fos": 2},
        "at best FoS 1.296 at 3922 kN",
    ),
    (
        "E322",
        WEDGE,
        {"plunge": "80,85", "acts": "active"},
        "no direction into the face that plunges 80 to 85",
    ),
    (
        "E322",
        PLANE,
        {"toward": "000/80", "acts": "passive"},
        "the movement does not draw passive bolts out",
    ),
    ("E322", WEDGE, {"toward": "275/0", "acts": "passive", "fos": 1.8}, "at best FoS"),
    ("E322", PLANE | {"strength": {"s": {"c": 0, "phi": 0}}}, {}, "the joints have no strength"),
    (
        "E211",
        PLANE,
        {"toward": "000/-60", "acts": "active", "fos": 1.7},
        "the force points out of the face",
    ),
    (
        "E212",
        PLANE,
        {"length": "5 m", "acts": "active", "fos": 2},
        "bolts are too short at 5 m: the longest needs",
    ),
    (
        "E328",
        WEDGE,
        {"spacing": "8 m", "acts": "active", "bolt_capacity": 1},
        "at a spacing of 8 m the face holds 1 ",
    ),
    ("E328", WEDGE, {"acts": "active", "bolt_capacity": "1 N"}, "no pattern is laid"),
    ("E328", PLANE, {"acts": "active", "bolt_capacity": "1 N"}, "no pattern is laid"),
    ("E329", SLAB, {"acts": "active", "fos": 2.5}, "moments turn the block"),
]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("code", "design", "options", "says"), OUT_OF_REACH, ids=lambda value: str(value)[:12]
)
def test_what_cannot_be_reached_says_why(code, design, options, says) -> None:
    options = {"fos": 1.9} | options
    fos = options.pop("fos")
    found = sk.support(loaded(design), fos, **options)
    said = notices_of(found)
    assert says in said[code]
    assert f"{code} " in str(found).replace("\n", " ")
    assert not found.reached
    assert found.exit_code == 1
    assert code in found.line


def test_a_slab_that_turns_over_is_held_by_heads_on_the_face() -> None:
    """Forces from 67.0 to 72.8 kN/m give the target and no others: with more the slab topples into the face."""
    found = sk.support(loaded(SLAB), 2.5, acts="active", plunge="-30,0")
    case = found.cases[0]
    assert case.reached
    document = found.to_dict()["bolts"][0]
    limit = sk.run(SLAB | {"support": document["support"]}).fos.limit
    assert 2.5 <= limit <= 2.5 * 1.02


def test_a_factor_that_jumps_over_the_target_is_said_to_jump() -> None:
    """Water that lifts the block takes its cohesion; the force that closes the plane again brings all of it back."""
    design = loaded(PLANE, water={"pressures": {"J1": 80}}, strength={"s": {"c": 200, "phi": 37}})
    assert factors_of(design, pre_ie=False).closed_status == "lifted"
    case = sk.support(design, 1.5, acts="active").cases[0]
    assert case.closed_form.notice.code == "E325"
    assert case.closed_form.below == 0.0
    bolt = as_bolt(case.closed_form.force, case.toward, "active")
    assert put_back(design, bolt)[0] > 1.5
    assert put_back(design, bolt | {"force": 0.999 * case.closed_form.force})[0] is None


def test_a_search_brackets_smooth_kinked_and_jumping_levels() -> None:
    """`least_force` on functions whose roots are known."""

    def answers(level):
        return lambda forces: [Answer(level(force), "slides") for force in forces]

    smooth = least_force(answers(lambda force: 1.0 + force / (1.0 + force)), 1.5, 0.1)
    assert smooth.force == pytest.approx(
        1.0, rel=2e-6
    )  # 3e-7 of the target over the slope there, 1/4
    assert smooth.answer.level >= 1.5
    assert smooth.below is None
    down = least_force(answers(lambda force: 1.0 + force), 1.5, 40.0)
    assert down.force == pytest.approx(0.5, rel=1e-6)
    jump = least_force(answers(lambda force: 1.0 if force < 7.0 else 2.0), 1.5, 1.0)
    assert jump.force == pytest.approx(7.0, rel=2e-3)
    assert jump.force >= 7.0
    assert jump.below == 1.0
    never = least_force(answers(lambda force: 1.4 - 1.0 / (1.0 + force)), 1.5, 1.0)
    assert never.force is None
    assert never.answer.level < 1.4
    window = least_force(answers(lambda force: 2.0 if 3.0 < force < 4.0 else 1.0), 1.5, 2.9)
    assert 3.0 < window.force < 4.0


def test_a_force_without_convergence_is_no_answer() -> None:
    """Without convergence there is no level: no target is reached, and a search goes on."""
    assert Answer(None, "not_converged").level is None
    assert not Answer(None, "not_converged").reaches(0.0)
    assert Answer(None, "no_driving_force").level == math.inf
    assert Answer(None, "lifted").level == 0.0
    lost = least_force(lambda forces: [Answer(None, "not_converged") for _ in forces], 1.5, 1.0)
    assert lost.force is None


def test_section_and_space_have_the_same_sense_of_into_the_rock() -> None:
    """The inward normal of a face that dips 60° toward 180 plunges 30° toward 000."""
    for design in (loaded(PLANE), loaded(WEDGE, **{"slope.face": "60/180"})):
        site = site_of(design)
        line = line_of(site.inward)
        assert (line.trend_deg % 360.0, line.plunge_deg) == pytest.approx((0.0, 30.0), abs=1e-9)


# -- the command -------------------------------------------------------------------------------------------------------


def test_the_command_writes_prints_and_leaves_with_its_code(tmp_path: Path) -> None:
    plane = str(path_of("plane"))
    run = slopekit("support", plane, "--fos", "1.5", "--json", "-o", str(tmp_path / "out"))
    assert run.returncode == 0
    assert run.stderr == ""
    document = json.loads(run.stdout)
    assert document.keys() == {
        "slopekit",
        "format",
        "study",
        "kind",
        "title",
        "input_sha256",
        "inputs",
        "target_fos",
        "unit",
        "reached",
        "needed",
        "without",
        "dilates",
        "options",
        "bolts",
        "pressure_kpa",
        "warnings",
        "timing_s",
        "line",
        "sheet",
    }
    assert document["bolts"][0].keys() == {
        "acts",
        "toward",
        "reached",
        "use_kn",
        "closed_form",
        "pre_ie",
        "pattern",
        "check",
        "other_cases",
        "support",
        "yaml",
        "notices",
    }
    assert document["unit"] == "kN/m"
    assert [bolt["acts"] for bolt in document["bolts"]] == ["active", "passive"]
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == [
        "support-active.yaml",
        "support-passive.yaml",
        "support.csv",
        "support.json",
        "support.txt",
    ]
    sheet = (tmp_path / "out" / "support.txt").read_text(encoding="utf-8")
    assert [line.split()[0] for line in sheet.splitlines() if line[:1].isupper()] == [
        "TARGET",
        "ACTIVE",
        "PASSIVE",
        "PRESSURE",
        "PASTE",
        "TIME",
    ]


def test_the_command_refuses_and_says_so_in_its_exit_code() -> None:
    plane = str(path_of("plane"))
    short = slopekit(
        "support",
        plane,
        "--quiet",
        "--toward",
        "180/10",
        "--acts",
        "active",
        "--set",
        "crack.water=1 m",
        "--fos",
        "1.5",
    )
    assert (short.returncode, short.stdout) == (1, "active  not reached  toward 180/10.0  E322\n")
    wrong = slopekit("support", plane, "--plunge", "-5", "--json")
    assert wrong.returncode == 2
    assert json.loads(wrong.stdout)["errors"][0]["code"] == "E307"
    other = slopekit("support", str(path_of("bench")))
    assert other.returncode == 2
    assert other.stderr.startswith(
        "E288 support is for a wedge or a plane, this design is of kind bench"
    )
    assert "Give the design a bolt, then sweep and solve change it" in other.stderr


def test_distributions_are_named_in_the_sheet() -> None:
    design = loaded(PLANE, **{"strength.s.phi": {"dist": "normal", "mean": 37, "sd": 2}})
    found = sk.support(design, 1.9, acts="active")
    assert isinstance(found.warnings[0], Notice)
    assert "W320 distributions are taken at their means: strength.s.phi 37" in str(found)


@pytest.mark.parametrize(
    ("rules", "target"), [(["fos >= 2.1", "fos.limit > 1.9"], 2.1), (["fos.lowest >= 3"], 1.5)]
)
def test_the_factor_that_acceptance_asks_for_is_wanted(rules, target) -> None:
    """Bolts for 1.5 reached their own target and left the design's, 2.1, unmet with exit code 0."""
    design = loaded(ONE_PLANE | {"acceptance": {"rules": rules}})
    found = sk.support(design, acts="active", bolt_capacity=1e4)
    assert found.target == target
    assert ("W332" in {notice.code for notice in found.warnings}) is (target == 1.5)
    assert ("what acceptance asks for" in str(found.sheet)) is (target == 2.1)
    below = sk.support(design, 1.3, acts="active", bolt_capacity=1e4)
    assert ("below the 2.1 that acceptance asks for" in str(below.sheet)) is (target == 2.1)
