"""A block on its springs, shaken: against the exact slide, rocking, free flight, its work, steps that do not settle."""

import math
from dataclasses import replace

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.arrays import frozen
from slopekit.geometry.interfaces import node_pairs
from slopekit.kinds import cut
from slopekit.loads import Loads
from slopekit.preie.motion import shaking
from slopekit.preie.motion.shaking import inertia_of, shake, shaken_block
from slopekit.preie.system.contact import JointStiffness
from slopekit.preie.system.model import JointStrength, build_model
from slopekit.studies.quake.six import slide

G = 9.81
STEP = 0.005
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


def _block(design, normal=1e7, shear=4e6, residual=None):
    made = cut(sk.load(design))
    model = made.scene_at(made.refine).model
    mass = -made.loads.components["weight"][2] / G
    volume, inertia = inertia_of(list(made.block.faces.values()), made.block.centroid)
    assert volume == pytest.approx(made.block.volume, rel=1e-12)
    return shaken_block(
        model, mass, inertia * mass / volume, JointStiffness(normal, 0.0, shear), residual
    )


def _sine(peak, cycles=1, seconds=1.6):
    """Times and one push a step: the mean of a sampled sine of 1 Hz, then quiet."""
    t = np.arange(round(seconds / STEP) + 1) * STEP
    a = np.where(t <= cycles + 1e-9, peak * G * np.sin(2.0 * np.pi * t), 0.0)
    return t, a, 0.5 * (a[1:] + a[:-1])


def _slid(out, translations):
    return float(np.sqrt((out.motion[-1][:translations] ** 2).sum()))


@pytest.mark.parametrize("peak", [0.3, 0.5])
def test_a_wedge_on_hard_springs_slides_as_the_exact_slide_has_it(peak) -> None:
    """To 0.2 %: implicit Euler with 200 steps a cycle; springs a hundred times the default's give 1e-5 m."""
    t, a, push = _sine(peak)
    exact = 1.1056884868 * slide(t, a, 0.19624347916 * G).displacement_m
    out = shake(_block(WEDGE, 1e9, 5e8), STEP, push[:, None] * np.array([0.0, -1.0, 0.0]))
    assert out.ended == "rest"
    assert _slid(out, 3) == pytest.approx(exact, rel=2e-3)
    line = cut(sk.load(WEDGE)).block.corners
    line = line[line[:, 1].argmin()] - line[line[:, 1].argmax()]  # toe less the far end of the line
    assert out.motion[-1][:3] / _slid(out, 3) == pytest.approx(
        line / np.sqrt(line @ line), abs=1e-4
    )
    assert np.abs(out.motion[-1][3:]).max() < 1e-6
    assert (out.slipped, out.opened, out.debonded) == (1.0, 0.0, 0.0)


def test_what_springs_add_falls_with_their_stiffness() -> None:
    """The wedge sinks between its joints as friction turns round: some W / kA, a tenth with ten times the stiffness."""
    t, a, push = _sine(0.5)
    exact = 1.1056884868 * slide(t, a, 0.19624347916 * G).displacement_m
    more = [
        _slid(shake(_block(WEDGE, k, 0.5 * k), STEP, push[:, None] * np.array([0.0, -1.0, 0.0])), 3)
        - exact
        for k in (1e7, 1e8)
    ]
    assert 0.002 < more[0] < 0.004
    assert 3.0 < more[0] / more[1] < 10.0


def test_a_plane_and_its_work() -> None:
    t, a, push = _sine(0.5)
    out = shake(_block(PLANE), STEP, push[:, None] * np.array([1.0, 0.0]))
    factor = math.cos(math.radians(5.0)) / math.cos(math.radians(30.0))
    assert _slid(out, 2) == pytest.approx(
        factor * slide(t, a, 0.14532323258 * G).displacement_m, rel=2e-3
    )
    work = out.work
    assert abs(work.unbalanced) < 1e-9 * work.put_in
    assert work.friction == pytest.approx(work.put_in, rel=0.01)
    assert 0.0 < work.damped < 0.01 * work.put_in
    assert abs(work.kinetic) < 1e-6 * work.put_in
    # of its own: gravity falls by the drop, the shaking pushes mass over the way that the block moves
    block = _block(PLANE)
    fell = -out.motion[-1][1] * block.mass[0, 0] * G
    pushed = float((np.diff(out.motion[: len(push) + 1, 0]) * push).sum()) * block.mass[0, 0]
    assert work.put_in == pytest.approx(fell + pushed, rel=1e-9)


def _rigid(pushes, net, step, parts=20):
    """Sliding of a rigid block, both ways, in fine steps: `net(push, way)` m/s² of what drives less what resists.

    Parameters
    ----------
    net : of a push and the way that the block moves, 1 or -1, its acceleration along the sliding
    """
    moved = speed = 0.0
    for push in [*pushes, *np.zeros((round(2.0 / step), pushes.shape[1]))]:
        for _ in range(parts):
            if speed:
                gained = net(push, math.copysign(1.0, speed))
            else:
                gained = max(net(push, 1.0), 0.0) + min(net(push, -1.0), 0.0)
            after = speed + step / parts * gained
            after = 0.0 if after * speed < 0.0 else after
            moved, speed = moved + 0.5 * step / parts * (speed + after), after
    return moved


@pytest.mark.parametrize(("dip", "phi", "peak", "sign"), [(5, 15, 0.6, -1.0), (12, 20, 0.9, -1.0)])
def test_a_plane_slides_both_ways(dip, phi, peak, sign) -> None:
    """A flat plane that strong shaking drives up the dip as well: against a rigid block in fine steps."""
    design = PLANE | {
        "joints": {"J1": {"plane": f"{dip}/180", "strength": "bedding"}},
        "strength": {"bedding": {"c": 0, "phi": phi}},
    }
    step = 0.5 * STEP  # where it turns round half a step is lost: 0.4 % with the whole one
    a = sign * peak * G * np.sin(2.0 * np.pi * step * np.arange(round(2.0 / step) + 1))
    pushes = 0.5 * (a[1:] + a[:-1])[:, None] * np.array([1.0, 0.0])
    out = shake(_block(design, 1e9, 4e8), step, pushes)
    cos, sin, tan = (
        math.cos(math.radians(dip)),
        math.sin(math.radians(dip)),
        math.tan(math.radians(phi)),
    )

    def net(push, way):
        return G * sin + push[0] * cos - way * tan * (G * cos - push[0] * sin)

    along = out.motion[:, :2] @ np.array([cos, -sin])
    assert np.diff(along).min() < -5e-4  # it goes up too
    assert along[-1] == pytest.approx(_rigid(pushes, net, step), rel=1.5e-3)


@pytest.mark.parametrize("way", [(0.0, -1.0, 0.4), (-0.15, -1.0, 0.2)])
def test_a_wedge_in_three_components_slides_as_two_planes_in_balance_say(way) -> None:
    """Normal forces from balance across the line of two planes, friction along it: no joint opens in one cycle."""
    given = WEDGE | {
        "joints": {"J1": {"plane": "52/129"}, "J2": {"plane": "48/234"}},
        "strength": {"joint": {"c": 41, "phi": 29}},
    }
    _, _, push = _sine(0.45, seconds=1.2)
    pushes = push[:, None] * np.array(way)
    out = shake(_block(given, 1e9, 5e8), STEP, pushes)
    made = cut(sk.load(given))
    normals, areas = [], []
    for interface in made.interfaces:
        face = made.block.faces[interface.key]
        around = face - face[0]
        vector = 0.5 * np.cross(around[1:-1], around[2:]).sum(axis=0)
        areas.append(np.sqrt(vector @ vector))
        normals.append(vector / areas[-1] * np.sign((made.block.centroid - face[0]) @ vector))
    line = np.cross(*normals)
    line *= -np.sign(line[2]) / np.sqrt(line @ line)
    mass, tan = -made.loads.components["weight"][2] / G, math.tan(math.radians(29.0))
    split = np.linalg.inv(np.stack([*normals, line], axis=1))

    def net(push, way):
        first, second, along = split @ (push + np.array([0.0, 0.0, -G]))
        return along - way * (41.0 * sum(areas) / mass - tan * (first + second))

    assert (out.opened, out.debonded) == (0.0, 0.0)
    assert out.motion[-1, :3] @ line == pytest.approx(_rigid(pushes, net, STEP), rel=2e-3)


@pytest.mark.parametrize(
    ("way", "metres"),
    [
        ((0.0, -1.0, 2.0 / 3.0), 0.5661870),
        ((0.0, -1.0, -2.0 / 3.0), 0.4987371),
    ],
)
def test_a_second_program_says_the_same(way, metres) -> None:
    """The prototype of shaking, written separately (1e7, 5e6 kN/m³, 0.5 g, two cycles); a rise helps, a fall holds."""
    _, _, push = _sine(0.5, cycles=2, seconds=2.0)
    assert _slid(
        shake(_block(WEDGE, 1e7, 5e6), STEP, push[:, None] * np.array(way)), 3
    ) == pytest.approx(metres, rel=1e-5)


@pytest.mark.slow
def test_shaking_across_pulls_joints_open_and_does_not_depend_on_the_step() -> None:
    """The same record across the slope as well: a joint opens and loses its bond, the wedge slides a quarter more."""
    found = []
    for step in (STEP, 0.5 * STEP):
        t = np.arange(round(2.0 / step) + 1) * step
        a = 0.5 * G * np.sin(2.0 * np.pi * t)
        out = shake(
            _block(WEDGE, 1e7, 5e6),
            step,
            0.5 * (a[1:] + a[:-1])[:, None] * np.array([-1.0, -1.0, 0.0]),
        )
        assert out.ended == "rest"
        assert out.opened > 0.3
        assert out.debonded > out.opened
        assert abs(out.work.unbalanced) < 1e-9 * out.work.put_in
        found.append(_slid(out, 3))
    assert found[0] == pytest.approx(found[1], rel=5e-3)
    assert 1.2 < found[0] / 0.5306221 < 1.35


def test_strength_falls_to_the_residual_one_after_slip() -> None:
    """More than on peak strength, not more than on the residual one from the beginning."""
    _, _, push = _sine(0.4, seconds=1.1)
    pushes = push[:, None] * np.array([1.0, 0.0])
    weak = {"strength": {"bedding": {"c": 12, "phi": 30}}}
    residual = np.full(6, 12.0), np.full(6, math.tan(math.radians(30.0)))
    peak, brittle, after = (
        _slid(shake(block, STEP, pushes), 2)
        for block in (_block(PLANE), _block(PLANE, residual=residual), _block(PLANE | weak))
    )
    assert peak < 0.9 * brittle
    assert 0.9 * after < brittle <= after


# -- a box on a floor -----------------------------------------------------------------------------------------------


def _box(width=1.0, height=3.0, phi=60.0, weight=78.0):
    """A box of 1 m depth: its base on the plane z = 0."""
    base = np.array([[0.0, 0.0, 0.0], [width, 0.0, 0.0], [width, 1.0, 0.0], [0.0, 1.0, 0.0]])
    pairs = node_pairs({0: base[::-1]})
    pairs = replace(pairs, normals=frozen(np.tile([0.0, 0.0, 1.0], (len(pairs), 1))))
    force = frozen([0.0, 0.0, -weight])
    none = frozen(np.zeros((0, 3)))
    loads = Loads(force, frozen(np.zeros(3)), {"weight": force}, none, none)
    law = JointStrength(
        *(np.array([value]) for value in (0.0, math.tan(math.radians(phi)), 0.0, 0.0))
    )
    model = build_model(pairs, loads, np.array([width / 2.0, 0.5, height / 2.0]), law)
    mass = weight / G
    inertia = mass / 12.0 * np.diag([1.0 + height**2, width**2 + height**2, 1.0 + width**2])
    block = shaken_block(model, mass, inertia, JointStiffness(1e9, 0.0, 1e9), None)
    assert block is not None
    return block


@pytest.mark.parametrize(("push", "rocks"), [(0.31, False), (0.36, True)])
def test_a_box_rocks_where_the_push_passes_width_over_height(push, rocks) -> None:
    """Housner 1963: a slender block begins to rock at g b/h = 1/3; a push of 0.15 s, then it comes back."""
    out = shake(
        _box(), STEP, np.vstack([np.tile([push * G, 0.0, 0.0], (30, 1)), np.zeros((40, 3))])
    )
    turned = float(np.abs(out.motion[:, 4]).max())
    assert (turned > 1e-3) is rocks
    assert out.opened < 1.0
    if rocks:  # about its edge: θ'' = (m a h/2 - W b/2) / I_edge at first
        inertia = (1.0 + 9.0) / 12.0 + (1.0 + 9.0) / 4.0
        rate = (push * G * 1.5 - G * 0.5) / inertia
        assert out.motion[20, 4] == pytest.approx(0.5 * rate * (20 * STEP) ** 2, rel=0.2)
        assert abs(out.work.unbalanced) < 1e-8 * out.work.put_in


@pytest.mark.slow
def test_a_box_that_rocks_knocks_as_housner_has_it() -> None:
    """The first angle by hand; after a knock (1 - 1.5 sin² α)² of it: less with long steps, which damp (Housner)."""
    alpha, inertia = math.atan(1.0 / 3.0), (1.0 + 9.0) / 3.0
    up, back = (0.45 * G * 1.5 - 0.5 * G) / inertia, 0.5 * G / inertia
    first = 0.5 * up * 0.15**2 * (1.0 + up / back)
    found = []
    for step in (4.0 * 5e-4, 5e-4):
        out = shake(
            _box(),
            step,
            np.vstack(
                [
                    np.tile([0.45 * G, 0.0, 0.0], (round(0.15 / step), 1)),
                    np.zeros((round(0.55 / step), 3)),
                ]
            ),
        )
        angle = out.motion[: round(0.7 / step), 4]
        peaks = abs(angle.max()), abs(angle.min())
        assert max(peaks) == pytest.approx(first, rel=0.02)
        found.append(min(peaks) / max(peaks))
    knock = (1.0 - 1.5 * math.sin(alpha) ** 2) ** 2
    assert found[0] < found[1] < knock
    assert found[1] == pytest.approx(knock, rel=0.07)


def test_a_box_that_is_thrown_flies_as_bodies_do() -> None:
    """A push up of 2 g for 0.1 s: v = g t, height ½ g t² then v²/2g; it has left its floor."""
    box = _box()
    out = shake(box, STEP, np.tile([0.0, 0.0, 2.0 * G], (20, 1)))
    assert (out.opened, out.debonded) == (1.0, 1.0)
    height = out.motion[:, 2].max()
    assert height == pytest.approx(
        0.5 * G * 0.1**2 + (G * 0.1) ** 2 / (2.0 * G), rel=0.06
    )  # Euler: h of the steps


# -- steps that do not settle ---------------------------------------------------------------------------------------


def test_a_step_that_does_not_settle_is_halved(monkeypatch) -> None:
    push = np.tile([0.5 * G, 0.0], (30, 1))
    plain = shake(_block(PLANE), STEP, push)
    newton = shaking._newton

    def stubborn(block, state, length, *more):
        return newton(block, state, length, *more) if length < 0.3 * STEP else None

    monkeypatch.setattr(shaking, "_newton", stubborn)
    out = shake(_block(PLANE), STEP, push)
    assert out.halved == 2 * (len(out.times) - 1)
    assert out.steps == 4 * (len(out.times) - 1)
    assert _slid(out, 2) == pytest.approx(_slid(plain, 2), rel=0.02)


def test_a_step_that_never_settles_is_refused_not_taken(monkeypatch) -> None:
    push = np.tile([0.5 * G, 0.0], (30, 1))
    plain = shake(_block(PLANE), STEP, push)
    newton, calls = shaking._newton, []

    def until(*given):
        calls.append(0)
        return newton(*given) if len(calls) <= 20 else None

    monkeypatch.setattr(shaking, "_newton", until)
    out = shake(_block(PLANE), STEP, push)
    assert out.ended == "refused"
    assert len(out.times) == 21
    np.testing.assert_array_equal(out.motion, plain.motion[:21])
