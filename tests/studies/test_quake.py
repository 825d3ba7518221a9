"""Earthquakes: sliding against formulas and programs, the factor against mechanics, the study as users meet it."""

import csv
import json
import math
import re
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

import slopekit as sk
from slopekit.design.templates import path_of
from slopekit.studies.quake import run as quake_run
from slopekit.studies.quake.records import record_of
from slopekit.studies.quake.run import _six_notices
from slopekit.studies.quake.six import (
    SixDofResponse,
    _ground_velocity,
    _refined_until_settled,
    _spatial_motion,
    slide,
)
from tests.commands import slopekit

G = 9.81
WEDGE = {
    "slopekit": 1,
    "kind": "wedge",
    "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
}
PLANE = {
    "slopekit": 1,
    "kind": "plane",
    "slope": {"face": "60/180", "height": 12, "upper": "0/180"},
    "joints": {"J1": {"plane": "35/180", "strength": "bedding"}},
    "strength": {"bedding": {"c": 20, "phi": 30}},
    "rock": {"density": 2600},
}
_SEARCHED: dict[str, tuple] = {}


@pytest.fixture(autouse=True)
def _each_design_is_searched_once(monkeypatch) -> None:
    """The yield coefficients of a design: for all tests of the file that shake it."""
    search = quake_run.yields_of

    def once(static, crew, advance):
        name = static.input_hash()
        if name not in _SEARCHED:
            _SEARCHED[name] = search(static, crew, advance)
        return _SEARCHED[name]

    monkeypatch.setattr(quake_run, "yields_of", once)


COARSE = {"slip.edge": 8}  # of a sphere of radius 10 m


def _sine(samples: int, peak: float, period: float = 1.0, after: float = 2.0):
    """One cycle, then quiet for `after` periods."""
    t = np.arange(int(samples * (1.0 + after)) + 1) * period / samples
    return t, np.where(t <= period * (1.0 + 1e-12), peak * np.sin(2.0 * np.pi * t / period), 0.0)


def _exact_sine(peak: float, limit: float, period: float) -> float:
    """One cycle that starts with a push, by its formula; the stop is a root."""
    w = 2.0 * math.pi / period
    t1 = math.asin(limit / peak) / w

    def velocity(t: float) -> float:
        return peak / w * (math.cos(w * t1) - math.cos(w * t)) - limit * (t - t1)

    t2 = brentq(velocity, period / 4.0 + t1, period, xtol=1e-15)
    moved = math.cos(w * t1) * (t2 - t1) - (math.sin(w * t2) - math.sin(w * t1)) / w
    return peak / w * moved - limit * (t2 - t1) ** 2 / 2.0


# -- sliding ----------------------------------------------------------------------------------------------------------


def test_a_rectangular_pulse() -> None:
    """Newmark 1965: V² / (2 g N) (1 - N/A)."""
    t, a = np.array([0.0, 0.0, 0.3, 0.3]), np.array([0.0, 0.5, 0.5, 0.0]) * G
    found = slide(t, a, 0.1 * G)
    v = 0.5 * G * 0.3
    assert found.displacement_m == pytest.approx(
        v * v / (2.0 * G * 0.1) * (1.0 - 0.1 / 0.5), rel=1e-14
    )
    assert found.displacement_m == pytest.approx(0.8829, abs=5e-7)
    rest = slide(
        np.append(t, 9.0), np.append(a, 0.0), 0.1 * G
    )  # the same with its quiet end in the record
    assert (rest.displacement_m, rest.after_m) == pytest.approx(
        (found.displacement_m, 0.0), rel=1e-14
    )


def test_a_triangular_pulse() -> None:
    """Slides from N/A of the rise; velocity (A - N)² T / 2A at the fall through N; then the cubic and the parabola."""
    peak, limit, long = 0.5 * G, 0.3 * G, 0.4
    t, a = np.array([0.0, long / 2.0, long]), np.array([0.0, peak, 0.0])
    s = 2.0 * peak / long
    x = (peak - limit) / s  # from start to peak, and from peak to the fall through N
    v = (peak - limit) * x
    rise = (
        s * x**3 / 6.0
        + (peak - limit) * x * x / 2.0
        + (peak - limit) * x * x / 2.0
        - s * x**3 / 6.0
    )
    y = brentq(lambda y: v - s * y * y / 2.0, 0.0, long / 2.0 - x, xtol=1e-16)
    assert slide(t, a, limit).displacement_m == pytest.approx(
        rise + v * y - s * y**3 / 6.0, rel=1e-12
    )


@pytest.mark.parametrize(
    ("peak", "limit", "period"), [(0.5, 0.2, 1.0), (0.3, 0.15, 0.4), (0.9, 0.5, 2.0)]
)
def test_a_sampled_sine_converges_as_the_square_of_the_step(peak, limit, period) -> None:
    exact = _exact_sine(peak * G, limit * G, period)
    errors = [
        abs(slide(*_sine(n, peak * G, period), limit * G).displacement_m / exact - 1.0)
        for n in (250, 500, 1000)
    ]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert np.all((orders > 1.7) & (orders < 2.4))
    assert errors[-1] < 2e-5


def test_the_sine_of_method_2() -> None:
    assert _exact_sine(0.5 * G, 0.2 * G, 1.0) == pytest.approx(0.2333261, abs=5e-8)
    assert slide(*_sine(1000, 0.5 * G), 0.2 * G).displacement_m == pytest.approx(
        0.2333261 * (1.0 - 8.1e-6), rel=1e-6
    )


@pytest.mark.parametrize(
    ("peak", "limit", "period", "samples", "published"),
    [
        (0.5, 0.2, 1.0, 400, 0.23322642813032185),
        (0.5, 0.2, 1.0, 1000, 0.23324501573169465),
        (0.4, 0.1, 0.5, 400, 0.07676832561867072),
        (0.3, 0.15, 2.0, 400, 0.377258438121223),
    ],
)
def test_pyslammer_says_the_same(peak, limit, period, samples, published) -> None:
    """pyslammer 0.2.2 (RigidAnalysis, 1 g = 9.80665) steps: within 4e-4 with 400 samples a cycle."""
    found = slide(*_sine(samples, peak * 9.80665, period), limit * 9.80665).displacement_m
    assert found == pytest.approx(published, rel=4e-4 * (400 / samples))


@given(st.integers(0, 2**31), st.floats(0.3, 4.0))
@settings(max_examples=20, deadline=None)
def test_any_record_against_fine_steps(seed, limit) -> None:
    """Velocity max(0, v + r dt) in 400 steps a sample: its error falls with the step."""
    rng = np.random.default_rng(seed)
    t = np.cumsum(rng.uniform(0.01, 0.03, 25))
    a = rng.normal(0.0, 4.0, 25)
    a[0] = 0.0
    fine = np.interp(np.linspace(0.0, 24.0, 24 * 400 + 1), np.arange(25), t)
    drive, v, d = np.interp(fine, t, a) - limit, 0.0, 0.0
    for r0, r1, h in zip(drive[:-1], drive[1:], np.diff(fine), strict=True):
        before, v = v, max(0.0, v + 0.5 * (r0 + r1) * h)
        d += 0.5 * (before + v) * h
    found = slide(t, a, limit)
    assert found.displacement[-1] == pytest.approx(d, rel=2e-3, abs=1e-6)
    assert found.velocity[-1] == pytest.approx(v, rel=2e-3, abs=2e-4)
    assert (np.diff(found.displacement) >= 0.0).all()
    cut = slide(
        np.insert(t, 12, 0.5 * (t[11] + t[12])), np.insert(a, 12, 0.5 * (a[11] + a[12])), limit
    )
    assert cut.displacement_m == pytest.approx(
        found.displacement_m, rel=1e-11, abs=1e-13
    )  # a sample more is no other


# -- the yield coefficient and the factor ------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def wedge():
    return sk.quake(sk.load(WEDGE), record_of("sine", *_sine(2000, 0.5 * G)))


def test_the_wedge_of_the_paper(wedge) -> None:
    """The prototype of shaking (docs/method.md): k_y 0.19624, factor 1.1057, 10 % more than plain Newmark has."""
    assert [one.method for one in wedge.yields] == ["pre_ie", "closed_form"]
    for one in wedge.yields:
        assert one.coefficient == pytest.approx(0.1962434791629, rel=1e-9)
        assert one.factor == pytest.approx(1.1057, abs=5e-5)
    at_yield = sk.run(WEDGE, set={"loads.seismic.k": wedge.coefficient})
    assert at_yield.fos.limit == pytest.approx(1.0, abs=1e-9)
    shaken = wedge.shaken[0]
    assert shaken.newmark_m == pytest.approx(
        _exact_sine(0.5 * G, wedge.coefficient * G, 1.0), rel=1e-5
    )
    assert shaken.as_recorded_m == pytest.approx(wedge.factor * shaken.newmark_m, rel=1e-12)
    assert wedge.agree
    assert wedge.exit_code == 0


@pytest.mark.parametrize(("dip", "phi", "cohesion"), [(35.0, 30.0, 20.0), (25.0, 35.0, 0.0)])
def test_a_plane_gains_by_cos_of_dip_less_phi_over_cos_phi(dip, phi, cohesion) -> None:
    b, f = math.radians(dip), math.radians(phi)
    changes = {
        "joints.J1.plane": f"{dip}/180",
        "strength.bedding.phi": phi,
        "strength.bedding.c": cohesion,
    }
    found = sk.quake(sk.load(PLANE, set=changes), "sine:0.9g,2Hz")
    for one in found.yields:
        assert one.factor == pytest.approx(math.cos(b - f) / math.cos(f), rel=1e-7)
    if not cohesion:
        assert found.coefficient == pytest.approx(math.tan(f - b), rel=1e-9)


@pytest.mark.slow
def test_a_bolt_and_a_curved_law_have_a_factor_too() -> None:
    """An active bolt is a load: it moves k_y and not the factor. A curved law has the slope at its own traction."""
    bolt = {"support": {"bolts": [{"force": "200 kN", "toward": "000/00", "acts": "active"}]}}
    held = sk.quake(sk.load(PLANE | bolt), "sine:0.9g,2Hz")
    assert held.coefficient > 1.2 * 0.14532323  # without it
    assert held.factor == pytest.approx(
        math.cos(math.radians(5.0)) / math.cos(math.radians(30.0)), rel=1e-6
    )
    curved = {"strength": {"bedding": {"law": "power", "a": 2.0, "b": 0.8}}}
    rough = sk.quake(sk.load(PLANE | curved), "sine:0.9g,2Hz")
    at = sk.run(PLANE | curved, set={"loads.seismic.k": rough.coefficient})
    traction = at.forces.normal["J1"] / at.geometry.areas_m2["J1"]
    slope = math.atan(2.0 * 0.8 * traction ** (0.8 - 1.0))
    assert rough.yields[1].factor == pytest.approx(
        math.cos(math.radians(35.0) - slope) / math.cos(slope), rel=1e-4
    )


@pytest.mark.slow
def test_curved_strength_parts_the_methods_and_not_their_agreement() -> None:
    """PRE-IE sees the traction of each pair, the closed form one a joint; held against each other as `run` does it."""
    found = sk.quake(sk.load(str(path_of("rough"))), "sine:0.9g,2Hz")
    ours, closed = found.yields
    assert 0.01 < closed.coefficient / ours.coefficient - 1.0 < 0.2
    assert sk.run(str(path_of("rough")), set={"loads.seismic.k": ours.coefficient}).agree
    assert (
        found.moments_govern
    )  # then the closed form's k_y is not compared, as nowhere where moments govern
    assert found.agree is None


@pytest.mark.slow
def test_columns_have_the_factor_of_the_one_that_goes_farthest_by_both_methods() -> None:
    found = sk.quake(sk.load(str(path_of("topple"))), "sine:0.2g,2Hz")
    ours, closed = found.yields
    assert ours.coefficient == pytest.approx(closed.coefficient, rel=1e-7)
    assert ours.status == "topples"
    assert ours.factor == pytest.approx(
        closed.factor, rel=1e-7
    )  # as k_y: the closed form's own root is as near
    assert (ours.factor_of, closed.factor_of) == ("C3", "C3")
    assert found.warnings == ()
    assert found.shaken[0].as_recorded_m == pytest.approx(
        ours.factor * found.shaken[0].newmark_m, rel=1e-12
    )
    assert "factor 0.921157 of C3" in str(found)
    blocks = sk.quake(sk.load(str(path_of("blocks"))), "sine:0.2g,2Hz")
    assert len(blocks.yields) == 1
    assert blocks.agree is None
    assert blocks.shaken[0].larger_m == 0.0  # k_y lies above the peak
    assert blocks.charts == ()


@pytest.mark.slow
def test_what_the_closed_form_says_nothing_of_is_not_compared() -> None:
    """Goodman and Bray's columns fall out of the slope, φ = 0 on a sphere is shaken along it: no disagreement."""
    columns = sk.load(path_of("topple"), {"columns.heights": [4, 6, 8]})
    for design, toward in ((columns, 90), (sk.load(path_of("sphere"), COARSE), 180)):
        found = sk.quake(design, "sine:0.2g,2Hz", toward=toward)
        ours, closed = found.yields
        assert ours.coefficient is not None
        assert closed.coefficient is None
        assert closed.before > 1.0
        assert found.agree is None
        assert found.exit_code == 0
        assert "it says nothing of shaking that way" in str(found)
        assert "not compared" in found.line
    reach = sk.quake(
        sk.load(PLANE), "sine:0.2g,2Hz"
    )  # both methods speak: a k_y that one lacks is a disagreement
    one = replace(reach.yields[1], coefficient=None)
    assert replace(reach, yields=(replace(reach.yields[0], agree=None), one)).agree is False


@pytest.mark.slow
def test_the_way_of_the_slope_named_is_the_way_of_the_slope() -> None:
    """A sphere toward 090 is compared with its closed form as without --toward; toward another trend it is not."""
    design = sk.load(path_of("sphere"), COARSE)
    own, named, off = (
        sk.quake(design, ["sine:0.5g,1Hz"], toward=toward) for toward in (None, 90.0, 60.0)
    )
    assert named.yields == own.yields
    assert named.agree
    assert off.agree is None
    assert off.coefficient > own.coefficient


@pytest.mark.slow
def test_a_section_shaken_along_its_face_says_what_is_left_out() -> None:
    """The part along the section alone is used: k_y over cos 60°."""
    design = sk.load("templates/plane.yaml")
    own, off = (sk.quake(design, ["sine:0.5g,1Hz"], toward=toward) for toward in (180.0, 120.0))
    assert off.coefficient == pytest.approx(
        own.coefficient / math.cos(math.radians(60.0)), rel=1e-6
    )
    said = [notice.message for notice in off.warnings if notice.code == "W323"]
    assert any("knows 50 % of the shaking alone" in message for message in said)
    assert "W323" not in [notice.code for notice in own.warnings]


@pytest.mark.slow
def test_joints_of_several_blocks_that_dilate_have_no_factor() -> None:
    found = sk.quake(
        sk.load(str(path_of("topple")), set={"strength.joint.dilation": 3}), "sine:0.2g,2Hz"
    )
    assert found.factor is None
    assert [notice.code for notice in found.warnings][:1] == ["W462"]
    assert found.yields[0].why_not.startswith("its joints dilate")


@pytest.mark.slow
def test_the_other_polarity_is_the_record_turned_round(wedge) -> None:
    record = wedge.shaken[0].record
    turned = sk.quake(wedge.design, record_of("turned", record.times_s, -record.accelerations))
    assert turned.shaken[0].as_recorded_m == wedge.shaken[0].reversed_m
    assert turned.shaken[0].reversed_m == wedge.shaken[0].as_recorded_m
    assert turned.motion["way"] == (
        "as recorded" if wedge.motion["way"] == "reversed" else "reversed"
    )


@pytest.mark.slow
def test_toward_another_trend_a_symmetric_wedge_sees_the_part_along_its_line(wedge) -> None:
    aside = sk.quake(sk.load(WEDGE), "sine:0.5g,1Hz", toward=150)
    assert aside.coefficient == pytest.approx(
        wedge.coefficient / math.cos(math.radians(30.0)), rel=1e-8
    )
    assert aside.factor == pytest.approx(wedge.factor * math.cos(math.radians(30.0)), rel=1e-6)
    assert aside.toward_deg == 150.0


@pytest.mark.slow
def test_toward_into_the_slope_is_said_with_the_way_out(wedge) -> None:
    """The wedge goes toward 180: toward 000 it would have to be pushed up, at seven times the k_y."""
    into = sk.quake(wedge.design, "sine:0.5g,1Hz", toward=0)
    assert into.yields[0].status == "slides_up"
    assert [notice.code for notice in into.warnings] == ["W328", "W379"]
    assert "toward 180 pushes out of it" in into.warnings[0].message
    nowhere = sk.quake(sk.load(PLANE), "sine:0.5g,1Hz", toward=20)
    assert nowhere.coefficient is None
    assert [notice.code for notice in nowhere.warnings] == ["W328", "W462"]
    assert "--toward 200" in nowhere.warnings[0].message
    for trend in (100, 240):
        assert "W328" not in [
            n.code for n in sk.quake(sk.load(PLANE), "sine:0.5g,1Hz", toward=trend).warnings
        ]


def test_peaks_are_scaled() -> None:
    found = sk.quake(sk.load(PLANE), ["sine:0.5g,1Hz", "triangular:0.2g,1s"], scale_pga=0.3)
    assert [one.record.pga_g for one in found.shaken] == pytest.approx([0.3, 0.3], rel=1e-14)
    sine = record_of("sine", *_sine(2000, 0.3 * 9.80665, after=0.0))
    exact = slide(sine.times_s, sine.accelerations, found.coefficient * G).displacement_m
    assert found.shaken[0].newmark_m == pytest.approx(exact, rel=1e-12)
    assert found.leading["median_m"] == pytest.approx(np.mean([one.mean_m for one in found.shaken]))


def test_percentiles_ask_for_seven_records(wedge) -> None:
    pulses = [f"triangular:0.{k}g,0.4s" for k in range(3, 10)]
    seven = sk.quake(wedge.design, pulses)
    means = [one.mean_m for one in seven.shaken]
    low, median, high = np.percentile(means, (16, 50, 84))
    assert tuple(seven.leading[key] for key in ("p16_m", "median_m", "p84_m")) == pytest.approx(
        (low, median, high)
    )
    assert "OVERALL 16th percentile" in " ".join(str(seven).split())
    six = sk.quake(wedge.design, pulses[:6])
    assert (six.leading["p16_m"], six.leading["p84_m"]) == (None, None)
    assert six.leading["median_m"] == pytest.approx(np.median(means[:6]))
    assert "OVERALL" not in str(six)


# -- as users meet it --------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_command_and_its_files(tmp_path) -> None:
    t, a = _sine(50, 0.45)
    record = tmp_path / "made.csv"
    record.write_text(
        "t (s),a (g)\n" + "".join(f"{x:.4f},{y:.9f}\n" for x, y in zip(t, a, strict=True))
    )
    out = tmp_path / "out"
    done = slopekit(
        "quake", str(path_of("plane")), str(record), "--scale-pga", "0.5", "-o", str(out)
    )
    assert done.returncode == 0
    document = json.loads((out / "quake.json").read_text(encoding="utf-8"))
    found = sk.quake(sk.load(str(path_of("plane"))), str(record), scale_pga=0.5)
    untimed = {"timing_s": None}
    assert document | untimed == found.to_dict() | untimed
    with (out / "quake.csv").open(encoding="utf-8") as file:
        assert float(next(csv.DictReader(file))["as_recorded_m"]) == found.shaken[0].as_recorded_m
    with (out / "motion.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) >= len(t)
    assert float(rows[-1]["v_m_s"]) == 0.0
    assert float(rows[-1]["d_m"]) == pytest.approx(found.shaken[0].larger_m, rel=1e-7)
    assert (out / "motion.png").stat().st_size > 10_000
    assert "the methods AGREE on k_y" in done.stdout
    assert found.line.startswith(f"k_y {found.coefficient:.6g}  factor {found.factor:.3f}")
    page = tmp_path / "page.html"
    assert slopekit("report", str(out / "quake.json"), "-o", str(page)).returncode == 0
    text = page.read_text(encoding="utf-8")
    assert "Earthquakes" in text
    assert f"{found.coefficient:.6f}" in text


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        ((), "E510"),
        (("nowhere.csv",), "E147"),
        (("sine:0.5g",), "E517"),
        (("0.3",), "E147"),
        (("sine:0.5g,1Hz", "--scale-pga", "30"), "E307"),
        (("sine:0.5g,1Hz", "--scale-pga", "x"), "E106"),
        (("sine:0.5g,1Hz", "--toward", "500"), "E122"),
        (("sine:0.5g,1Hz", "--set", "strength.weak.c=0", "--set", "strength.weak.phi=10"), "E520"),
    ],
)
def test_wrong_input_is_said(arguments, code) -> None:
    done = slopekit("quake", str(path_of("wedge")), *arguments)
    assert done.returncode == 2
    assert done.stderr.startswith(code)


def test_a_factor_just_below_one_is_not_said_to_be_one() -> None:
    """Goodman & Bray's columns, 0.99995684."""
    done = slopekit("quake", str(path_of("goodman-bray")), "sine:0.5g,1Hz")
    assert done.stderr.startswith("E520 ")
    assert "its factor of safety is 0.99995684\n" in done.stderr


@pytest.mark.parametrize(
    ("name", "arguments", "said"),
    [
        ("footing", (), "a footing has none"),
        ("footing", ("--toward", "90"), "a footing has none"),
        ("wall", ("--set", "loads={}"), "Give --toward 270"),
        ("wall", ("--toward", "45"), "--toward is 45"),
    ],
)
def test_designs_that_take_no_shaking_say_what_is_missing(name, arguments, said) -> None:
    """Not which key of the file nobody typed is wrong."""
    done = slopekit("quake", str(path_of(name)), "sine:0.5g,1Hz", *arguments)
    assert done.returncode == 2
    assert done.stderr.startswith("E253 ")
    assert said in done.stderr
    assert "loads.seismic.k=" not in done.stderr
    assert max(map(len, done.stderr.splitlines())) <= 100


@pytest.mark.slow
def test_node_pairs_are_made_finer_until_the_sliding_stays(wedge) -> None:
    """0.3 g across as well: on the 8 pairs of the analysis a corner opens with an eighth of a joint, and 9.5 % more."""
    sine = "sine:0.3g,2Hz"
    alone = sk.quake(wedge.design, sine, six=True)
    both = sk.quake(wedge.design, sine, six=True, across=sine)
    assert alone.in_six.pairs < both.in_six.pairs
    assert both.in_six.pairs > 100
    assert both.in_six.change < 0.01
    assert both.six[0].slid_m == pytest.approx(alone.six[0].slid_m, rel=1e-2)
    assert both.to_dict()["six_pairs"] == {"pairs": both.in_six.pairs, "change": both.in_six.change}
    assert f"{both.in_six.pairs} node pairs" in str(both)
    assert [notice.code for notice in both.warnings] == ["W379"]


def test_what_is_to_be_known_of_the_other_components_is_said_too(wedge) -> None:
    """The vertical one ends at 0.05 g x 0.1 s = 0.049 m/s, its peak; said once where a component stands twice."""
    up = record_of("up", [0.0, 0.01, 0.11, 0.12], [0.0, 0.05, 0.05, 0.0], "g")
    found = sk.quake(wedge.design, "sine:0.3g,2Hz", six=True, vertical=up)
    assert [(one.code, one.message.split(":")[0]) for one in found.warnings[:-1]] == [
        ("W460", "up"),
        ("W460", "up"),
    ]
    twice = sk.quake(wedge.design, up, six=True, vertical=up)
    assert [one.code for one in twice.warnings].count("W460") == 2


def _settles(monkeypatch, slid: list[tuple[float, float]], opens: bool) -> tuple[int, float]:
    """How often pairs are made finer, and the last change, where both polarities slide so far on each of them."""

    def shaken(block, _, pushes):
        far = slid[block.level][0 if pushes[0] > 0.0 else 1]
        part = 0.1 if opens else 0.0
        return SimpleNamespace(
            motion=np.array([[far, 0.0]]), ended="rest", opened=part, debonded=0.0
        )

    def on_pairs(level: int):
        return SimpleNamespace(level=level, area=np.ones(8 * 4**level), translations=2)

    monkeypatch.setattr("slopekit.studies.quake.six.shake", shaken)
    monkeypatch.setattr("slopekit.studies.quake.six._MAX_REFINEMENTS", len(slid) - 1)
    block, _, change = _refined_until_settled(on_pairs(0), 0, on_pairs, np.ones(1))
    return block.level, change


def test_where_joints_open_one_small_change_is_not_taken_for_settled(monkeypatch) -> None:
    """Few pairs may happen to agree; and the polarity that changes more counts."""
    late = [(1.0, 1.0), (1.001, 1.0), (1.3, 1.0), (1.302, 1.001)]
    assert _settles(monkeypatch, late, False) == (1, pytest.approx(0.001 / 1.001))
    assert _settles(monkeypatch, late, True) == (3, pytest.approx(0.002 / 1.302))
    assert _settles(monkeypatch, [(1.0, 1.0), (1.0, 2.0), (1.0, 2.5)], False) == (
        2,
        pytest.approx(0.2),
    )


def test_the_ground_between_two_samples_goes_by_the_integral_of_its_line() -> None:
    """v = ∫ (1 + 2 t) dt = t + t² for two seconds, then t - 2 s less of 5 m/s² in a second; as it is behind the end."""
    record = SimpleNamespace(
        times_s=np.array([0.0, 2.0, 3.0]),
        accelerations=np.array([1.0, 5.0, 0.0]),
        ground_velocity=np.array([0.0, 6.0, 8.5]),
    )
    found = _ground_velocity(record, np.array([0.0, 0.5, 1.5, 2.0, 2.4, 3.0, 7.0]))
    assert found == pytest.approx(
        [0.0, 0.75, 3.75, 6.0, 6.0 + 5.0 * 0.4 - 2.5 * 0.16, 8.5, 8.5], rel=1e-14
    )


def test_turning_is_in_degrees_about_the_axis_of_a_section() -> None:
    """x and z of a section that runs north and up, and the angle about the third axis."""
    axes = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    out = SimpleNamespace(
        times=np.array([0.0, 1.0]), motion=np.array([[0.0, 0.0, 0.0], [3.0, 4.0, 0.5]])
    )
    moved, turned_deg = _spatial_motion(
        out, SimpleNamespace(translations=2), SimpleNamespace(axes=axes)
    )
    assert moved[-1] == pytest.approx([0.0, 3.0, 4.0])
    assert turned_deg[-1] == pytest.approx([-90.0 / math.pi, 0.0, 0.0])


@pytest.mark.slow
def test_what_hangs_on_node_pairs_is_said(wedge, monkeypatch) -> None:
    """No finer ones than 20: 0.5 g across as well still changes by a fifth."""
    monkeypatch.setattr("slopekit.studies.quake.six._MAX_PAIRS", 20)
    found = sk.quake(wedge.design, "sine:0.5g,1Hz", six=True, across="sine:0.5g,1Hz")
    assert found.in_six.pairs == 20
    assert found.in_six.change > 0.1
    assert [notice.code for notice in found.warnings] == ["W379", "W312"]
    percent = re.search(r"still moved what slides by ([\d.]+) %", found.warnings[-1].message)
    assert float(percent[1]) == pytest.approx(100.0 * found.in_six.change, rel=0.05)  # two digits
    assert f"moved what slides by {percent[1]} % at most" in " ".join(str(found).split())


@pytest.mark.parametrize(
    ("change", "said"), [(0.009, []), (0.015, ["1.5 %"]), (1.274, ["130 %"]), (None, [])]
)
def test_what_changes_by_more_than_a_percent_is_not_settled(change, said) -> None:
    """As the manual has it: finer node pairs are made until they change no more than that."""
    notices = _six_notices(SixDofResponse((), None, 818, change))
    assert [notice.message.partition(" by ")[2].partition(":")[0] for notice in notices] == said


@pytest.mark.slow
def test_six_degrees_of_freedom(tmp_path) -> None:
    """A plane moves as in the slide one way, also with a push up; its work is balanced."""
    plane = sk.load(PLANE)
    alone = sk.quake(plane, "sine:0.5g,2Hz", six=True)
    assert [(one.way, one.ended) for one in alone.six] == [
        ("as recorded", "rest"),
        ("reversed", "rest"),
    ]
    exact = alone.shaken[0].as_recorded_m, alone.shaken[0].reversed_m
    assert [one.slid_m for one in alone.six] == pytest.approx(exact, rel=2e-3)
    down = math.radians(35.0)
    for one in alone.six:
        assert one.displacement_m == pytest.approx(
            one.slid_m * np.array([0.0, -math.cos(down), -math.sin(down)]), abs=1e-3 * one.slid_m
        )  # toward 180
        assert abs(one.work_kj.unbalanced) < 1e-9 * one.work_kj.put_in
    lifted = sk.quake(plane, "sine:0.5g,2Hz", six=True, vertical="sine:0.3g,2Hz")
    record = lifted.shaken[
        0
    ].record  # a push up takes tan(β - φ) of itself from the push out of the slope
    less = 1.0 - 0.6 * math.tan(math.radians(5.0))
    moved = (
        lifted.factor
        * slide(record.times_s, less * record.accelerations, lifted.coefficient * G).displacement_m
    )
    assert lifted.six[0].slid_m == pytest.approx(moved, rel=2e-3)
    assert moved < 0.95 * exact[0]
    document = json.loads(json.dumps(alone.to_dict(), allow_nan=False))
    assert document["six"][1]["slid_m"] == alone.six[1].slid_m
    assert document["six"][0]["work_kj"]["friction"] == alone.six[0].work_kj.friction
    assert "to rest" not in str(alone)
    assert f"{100.0 * alone.six[0].slid_m:.4g}" in str(alone)


PEAK, LEFT = {"c": 20, "phi": 30}, {"c": 12, "phi": 30}


@cache
def in_six(residual: bool):
    """The plane on its peak strength, and on what is left of it once it has slipped."""
    strength = PEAK | ({"residual": LEFT} if residual else {})
    return sk.quake(sk.load(PLANE | {"strength": {"bedding": strength}}), "sine:0.4g,2Hz", six=True)


@pytest.mark.slow
def test_six_degrees_of_freedom_fall_to_the_residual_strength() -> None:
    """It begins as on the peak strength and goes on as on the residual one: near what that gives from the beginning."""

    def slid(**strength) -> float:
        design = sk.load(PLANE | {"strength": {"bedding": strength}})
        return sk.quake(design, "sine:0.4g,2Hz", six=True).six[0].slid_m

    on_peak, falls = (in_six(residual).six[0].slid_m for residual in (False, True))
    assert slid(**PEAK, residual=PEAK) == pytest.approx(on_peak, rel=1e-9)
    assert 1.1 * on_peak < falls <= slid(**LEFT) < 1.2 * falls


def test_what_was_asked_for_leads_and_the_other_stands_beside() -> None:
    """Six degrees of freedom lose strength that one way keeps: line, sheet and JSON lead with them."""
    found = in_six(True)
    mean, largest = 0.5 * sum(one.slid_m for one in found.six), max(one.slid_m for one in found.six)
    one_way = found.shaken[0].mean_m
    assert mean > 1.05 * one_way
    assert [found.leading[key] for key in ("model", "median_m", "largest_m")] == [
        "six",
        mean,
        largest,
    ]
    assert found.one_way["median_m"] == one_way
    shown = f"{100.0 * mean:.4g} cm"
    assert found.line.index(shown) < found.line.index(f"{100.0 * one_way:.4g} cm")
    sheet = " ".join(str(found).split())
    assert sheet.index(shown) < sheet.index("SLIDES")
    document = found.to_dict()
    keys = list(document)
    assert keys.index("leading") < keys.index("beside") < keys.index("yield")
    assert sk.quake(sk.load(PLANE), "sine:0.4g,2Hz").leading["model"] == "one_way"


def test_a_step_that_is_refused_leaves_no_displacement_to_lead_with() -> None:
    found = in_six(False)
    refused = tuple(replace(one, ended="refused") for one in found.six)
    without = replace(found, in_six=replace(found.in_six, shaken=refused))
    assert without.leading["median_m"] is None
    assert "six degrees of freedom: no displacement" in without.line
    assert without.exit_code == 4


def test_a_step_that_is_refused_is_said(monkeypatch) -> None:
    from slopekit.preie.motion import shaking

    newton, calls = shaking._newton, []

    def until(*given):
        calls.append(0)
        return newton(*given) if len(calls) <= 20 else None

    monkeypatch.setattr(shaking, "_newton", until)
    found = sk.quake(sk.load(PLANE), "sine:0.5g,2Hz", six=True)
    assert [one.ended for one in found.six] == ["refused", "refused"]
    assert found.six[0].until_s == pytest.approx(20 * 0.005)
    assert found.exit_code == 4
    assert [notice.code for notice in found.warnings] == ["W464", "W464"]


@pytest.mark.parametrize(
    ("template", "arguments", "code"),
    [
        ("wedge", ("--vertical", "sine:0.3g,1Hz"), "E313"),
        ("wedge", ("--six", "--across", "sine:0.3g,1Hz", "--scale-pga", "0.3"), "E313"),
        ("wedge", ("sine:0.3g,1Hz", "--six", "--across", "sine:0.3g,1Hz"), "E313"),
        ("plane", ("--six", "--across", "sine:0.3g,1Hz"), "E313"),
        ("plane", ("--six", "--vertical", "nowhere.csv"), "E147"),
        ("blocks", ("--six",), "E288"),
        ("plane", ("--six", "--set", "strength.bedding.dilation=5"), "E288"),
    ],
)
def test_what_six_degrees_of_freedom_do_not_take(template, arguments, code) -> None:
    done = slopekit("quake", str(path_of(template)), "sine:0.2g,5Hz", *arguments)
    assert done.returncode == 2
    assert done.stderr.startswith(code)


def test_a_record_that_ends_while_the_block_slides() -> None:
    """Cut off at its peak: the block is brought to rest by its own weight, v² / (2 k_y g), and that is said."""
    cut_off = record_of("cut off", [0.0, 0.5], [0.0, 0.5 * G])
    found = sk.quake(sk.load(PLANE), cut_off)
    limit = found.coefficient * G
    v = (0.5 * G - limit) ** 2 / (2.0 * G)  # the push rises by 1 g a second
    assert found.shaken[0].after_m == pytest.approx(found.factor * v * v / (2.0 * limit), rel=1e-9)
    assert [notice.code for notice in found.warnings] == ["W460", "W464"]
    assert found.motion["t_s"][-1] == pytest.approx(0.5 + v / limit, rel=1e-9)


def test_what_no_shaking_moves_says_so() -> None:
    found = sk.quake(
        sk.load(PLANE, set={"joints.J1.plane": "5/180", "strength.bedding.phi": 75}),
        "sine:0.5g,1Hz",
    )
    assert found.coefficient is None
    assert [notice.code for notice in found.warnings] == ["W462"]
    assert found.agree
    assert "none: no k up to 2 moves it" in str(found)
    assert found.shaken[0].larger_m == 0.0
    assert (
        json.loads(json.dumps(found.to_dict(), allow_nan=False))["yield"][0]["coefficient"] is None
    )


@pytest.mark.slow
def test_where_moments_open_the_joint_the_coefficient_is_where_they_do() -> None:
    """Cohesion of 5 MPa on the pressed part of the joint alone: that goes to nothing before the block slides.

    By hand: N acts at e = M / N from the toe, so that 3 e are pressed: c 3 e + N tan φ = T where k is k_y.
    """
    strong = {"strength.bedding.c": "5 MPa"}
    found = sk.quake(sk.load(PLANE, set=strong), "sine:0.9g,2Hz")
    ours, closed = found.yields
    dip, phi = math.radians(35.0), math.radians(30.0)
    toe, back = 12.0 / math.tan(math.radians(60.0)), 12.0 / math.tan(dip)
    weight = 2.6 * 9.81 * 0.5 * (back - toe) * 12.0

    def excess(k: float) -> float:
        normal = weight * (math.cos(dip) - k * math.sin(dip))
        pressed = 3.0 * weight * ((toe + back) / 3.0 - 8.0 * k) / normal
        return (
            5000.0 * pressed + normal * math.tan(phi) - weight * (math.sin(dip) + k * math.cos(dip))
        )

    assert ours.coefficient == pytest.approx(brentq(excess, 0.9, 1.0, xtol=1e-15), rel=1e-9)
    assert ours.coefficient < 0.9 * closed.coefficient
    assert ours.why_not == "moments govern: it turns as it slides"
    assert found.moments_govern
    assert found.agree is None
    assert [notice.code for notice in found.warnings] == ["W462", "W353"]
    assert " cm  not compared  W462  W353" in found.line
    limits = [
        sk.run(PLANE, set=strong | {"loads.seismic.k": k * ours.coefficient}).fos.limit
        for k in (0.99, 0.999, 0.9999, 1.0, 1.0001, 1.001)
    ]
    assert limits == sorted(limits, reverse=True)
    assert limits[3] == pytest.approx(1.0, abs=1e-9)
    assert limits[2] - limits[4] < 0.05


def test_where_a_block_tips_before_it_slides_the_factor_jumps() -> None:
    """Friction of 85°, no cohesion: its weight goes through its toe at k = x / z, where it slides at F = 2."""
    rough = {"strength.bedding.c": 0, "strength.bedding.phi": 85}
    found = sk.quake(sk.load(PLANE, set=rough), "sine:0.9g,2Hz")
    ours, closed = found.yields
    x = (12.0 / math.tan(math.radians(60.0)) + 12.0 / math.tan(math.radians(35.0))) / 3.0
    assert ours.coefficient == pytest.approx(x / 8.0, rel=1e-5)
    assert closed.coefficient == pytest.approx(math.tan(math.radians(50.0)), rel=1e-9)
    assert ours.why_not == "moments open a joint there, the factor of safety jumps from 2 to 0"
    assert found.moments_govern
    assert found.agree is None
    assert [notice.code for notice in found.warnings] == ["W462", "W353", "W302", "W302"]
    assert " cm (W353)  not compared  W462  W353" in found.line


def test_a_plain_wedge_loads_nothing_of_it() -> None:
    import subprocess
    import sys

    code = (
        "import sys, slopekit as sk; sk.wedge(dips=('45/115', '45/245'));"
        "print([name for name in sys.modules if 'quake' in name])"
    )
    assert (
        subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True
        ).stdout
        == "[]\n"
    )


def test_a_displacement_of_kilometres_is_refused() -> None:
    """Every record of such at once, with the peak velocity of the ground that it would need: 0.5 g for 300 s."""
    pulses = ["rectangular:0.5g,300s", "rectangular:0.5g,0.3s", "rectangular:0.4g,500s"]
    with pytest.raises(sk.DesignError) as error:
        sk.quake(sk.load(WEDGE), pulses)
    assert error.value.codes == ("E524", "E524")
    first = error.value.faults[0].message
    assert first.startswith("rectangular:0.5g,300s: a displacement of ")
    assert f"with a peak velocity of the ground of {0.5 * 9.80665 * 300.0:.3g} m/s" in first


def test_a_slope_that_hardly_stands_is_named_as_the_reason() -> None:
    """At k_y = tan(φ - β) = 1e-6 it slides on for v² / 2 k g: kilometres, in a record that is right."""
    phi = 35.0 + math.degrees(1e-6)
    weak = sk.load(PLANE | {"strength": {"bedding": {"c": 0, "phi": phi}}})
    with pytest.raises(
        sk.DesignError, match=r"E524 north: a displacement of .* km is none of an earthquake"
    ) as error:
        sk.quake(weak, record_of("north", *_sine(50, 0.1 * G)))
    assert error.value.faults[0].advice.endswith("At a k_y next to 0 the slope hardly stands.")
    stands = sk.load(PLANE | {"strength": {"bedding": {"c": 0, "phi": 35.0 + math.degrees(1e-4)}}})
    far = sk.quake(stands, record_of("north", *_sine(50, 0.1 * G)))
    assert 10.0 < far.shaken[0].larger_m < 1000.0


def test_a_slope_that_nothing_holds_has_a_status_and_no_factor() -> None:
    """E520: lifted by its water it has no factor of safety; it was said to have 0."""
    lifted = "water={pressures: {J1: 400, J2: 400}}"
    done = slopekit("quake", str(path_of("wedge")), "sine:0.5g,1Hz", "--set", lifted)
    message = "E520 the slope does not stand without an earthquake: contact lost on both planes (uplift)\n"
    assert done.stderr.startswith(message)
