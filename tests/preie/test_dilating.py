"""One block on joints that dilate: a symmetric wedge by hand, and the elastic path on node pairs, another program."""

import math

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.errors import SlopekitError
from slopekit.design.common import Design
from slopekit.kinds import kind_of
from slopekit.preie.one_block.flat_limit import flat_limit
from slopekit.preie.one_block.pairs_limit import _elastic_path_limit, elastic_displacement

WEDGE = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "60/180", "upper": "10/180", "height": 64.89},
    "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
    "rock": {"unit_weight": 25.506},
}


def by_hand(
    dilation_deg: float,
    cohesion: float,
    friction_deg: float,
    weight: float,
    area: float,
    bolt: np.ndarray,
) -> float:
    """Half of the wedge in its plane of symmetry: slip and friction of a joint leave the line of intersection.

    With l down the line, m square to it and up, n·m = k and v = cos θ l + sin θ m: sin θ = sin ψ / k, and the friction
    acts against d = (v - sin ψ n) / cos ψ. A passive bolt pulls λ T, half of it here, where v draws it out.
    """
    first, second = (
        np.array([math.sin(math.radians(d)) * s, math.cos(math.radians(d)) * s, s])
        for d, s in ((115, math.sin(math.pi / 4)), (245, math.sin(math.pi / 4)))
    )
    line = np.cross(first, second)
    line *= -np.sign(line[2]) / np.linalg.norm(line)
    up = np.cross(line, [1.0, 0.0, 0.0])
    up *= np.sign(up[2])
    k, sine = float(first @ up), math.sin(math.radians(dilation_deg))
    theta, cosine = math.asin(sine / k), math.cos(math.radians(dilation_deg))
    drag = np.array([math.cos(theta) / cosine, (math.sin(theta) - sine * k) / cosine])
    load, tangent = (
        0.5 * weight * np.array([-line[2], -up[2]]),
        math.tan(math.radians(friction_deg)),
    )
    pull = 0.5 * np.array([bolt @ line, bolt @ up])
    pull *= pull @ [math.cos(theta), math.sin(theta)] < 0.0
    # N (k m - λ tan φ d) = λ (c A d - T b) - load: both sides are parallel, a square equation in λ
    normal, held = np.array([0.0, k]), cohesion * area * drag - pull

    def across(one: np.ndarray, other: np.ndarray) -> float:
        return float(one[0] * other[1] - one[1] * other[0])

    square = (
        -tangent * across(drag, held),
        across(normal, held) + tangent * across(drag, load),
        -across(normal, load),
    )
    return 1.0 / float(max(np.roots(np.trim_zeros(square, "f")), key=lambda root: 1.0 / root))


TOWARD = {"into the slope": (0.0, 10.0), "out of it": (180.0, 10.0)}


@pytest.mark.parametrize("toward", [None, *TOWARD])
@pytest.mark.parametrize("dilation", [0.0, 5.0, 12.0, 20.0])
def test_a_symmetric_wedge(dilation: float, toward: str | None) -> None:
    """Its factor, and forces of node pairs that balance the load, whatever they were found by."""
    trend, plunge = TOWARD[toward] if toward else (0.0, 0.0)
    force = 2e5 if toward else 0.0
    strength = {"c": 50, "phi": 20, "dilation": dilation}
    design = WEDGE | {"strength": {"s": strength}}
    if toward:
        bolt = {"force": force, "toward": {"trend": trend, "plunge": plunge}, "acts": "passive"}
        design |= {"support": {"bolts": [bolt]}}
    found = sk.run(design)
    weight, area = found.geometry.volume_m3 * 25.506, found.geometry.areas_m2["J1"]
    turn, dip = math.radians(trend), math.radians(plunge)
    way = force * np.array(
        [math.sin(turn) * math.cos(dip), math.cos(turn) * math.cos(dip), -math.sin(dip)]
    )
    factor, angle = 1.0, dilation
    for _ in range(60):  # no joint dilates by more than what is left of its friction angle
        factor = by_hand(angle, 50.0, 20.0, weight, area, way)
        angle = min(dilation, math.degrees(math.atan(math.tan(math.radians(20.0)) / factor)))
    assert found.fos.limit == pytest.approx(factor, rel=1e-9)
    balance = found.limit_state.balance
    assert max(balance.force, balance.moment) < 1e-9
    assert balance.admissible_within(1e-9)


WEDGES = {  # bolts, and joints that dilate by all of the friction that is left: the load does no work on the slide
    "slides": {
        "dips": ("42.5/128.3", "59.1/252.3"),
        "face": "61/180",
        "upper": "1.8/180",
        "height": 8.6,
        "c": 0,
        "phi": (31.8, 21.2),
        "unit_weight": 25.8,
        "water": "43%",
        "dilation": 17.7,
        "bolts": ["1619kN@342/-6,active"],
    },
    "up": {
        "dips": ("50.1/119.3", "73/252.9"),
        "face": "59.3/180",
        "upper": "12.9/180",
        "height": 8.3,
        "c": 0,
        "phi": (29.3, 20.9),
        "unit_weight": 26.7,
        "water": "65.3%",
        "dilation": 18.7,
        "bolts": ["5897kN@7/12,active"],
    },
}


@pytest.mark.parametrize("name", WEDGES)
def test_joints_that_dilate_by_all_of_their_friction_have_the_static_bound(name) -> None:
    """Associated flow, no cohesion: the limit is the bound that a program finds on node pairs."""
    found = sk.wedge(**WEDGES[name])
    assert found.fos.limit > 1.005 * found.fos.closed_form
    assert found.fos.limit == pytest.approx(found.fos.static_bound, rel=1e-6)
    assert max(found.limit_state.balance.force, found.limit_state.balance.moment) < 1e-9


def random_design(rng: np.random.Generator, bolted: bool) -> Design:
    least, most = (-40, 20) if bolted else (0, 12)  # of cohesion, half of it none; of dilation
    strengths = {
        name: {
            "c": max(rng.uniform(least, 40), 0),
            "phi": rng.uniform(20, 42),
            "dilation": rng.uniform(0, most),
        }
        for name in "st"
    }
    planes = {
        "J1": (rng.uniform(30, 60), rng.uniform(95, 150)),
        "J2": (rng.uniform(35, 70), rng.uniform(210, 260)),
    }
    joints = {
        name: {"plane": [*plane], "strength": s}
        for s, (name, plane) in zip("st", planes.items(), strict=True)
    }
    face = {
        "face": f"{rng.uniform(65, 85)}/180",
        "upper": f"{rng.uniform(0, 15)}/180",
        "height": rng.uniform(5, 40),
    }
    design = {
        "slopekit": 1,
        "kind": "wedge",
        "slope": face,
        "joints": joints,
        "strength": strengths,
        "rock": {"unit_weight": 25},
        "water": {"fill": rng.uniform(0, 0.5)},
    }
    if bolted:
        toward, acts = (
            f"{rng.uniform(0, 20):.1f}/{rng.uniform(-15, 15):.1f}",
            str(rng.choice(["active", "passive"])),
        )
        bolt = {"force": rng.uniform(1e2, 4e3), "toward": toward, "acts": acts}
        design |= {"support": {"bolts": [bolt]}}
    return sk.load(design)


@pytest.mark.slow
@pytest.mark.parametrize(("bolted", "count", "within"), [(False, 40, 1e-8), (True, 60, 1e-7)])
def test_wedges_on_the_elastic_path(bolted, count, within) -> None:
    """The path is followed on node pairs at the corners: where all are pressed in the end it ends at the slide.

    Past the dilation that friction leaves it settles to a few parts in 1e8.
    """
    rng, pressed = np.random.default_rng(4), 0
    for _ in range(count):
        try:
            design = random_design(rng, bolted)
            scene = kind_of(design).cut(design).scene_at(0)
        except SlopekitError:
            continue
        model, bedding = scene.model, scene.bedding
        exact = flat_limit(model, bedding.polygons, bedding.centroid).exact
        path = _elastic_path_limit(model, model.cohesion, elastic_displacement(model))
        is_pressed = path.factor is not None and bool((path.normal_force > 0.0).all())
        assert (exact is not None) == is_pressed
        if exact is not None:
            assert exact.factor == pytest.approx(path.factor, rel=within)
            assert exact.normal_force == pytest.approx(
                path.normal_force, abs=1e-6 * path.normal_force.max()
            )
            pressed += 1
    assert pressed > 5
