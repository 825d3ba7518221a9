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
    "slopekit": 1, "kind": "wedge", "slope": {"face": "60/180", "upper": "10/180", "height": 64.89},
    "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}, "rock": {"unit_weight": 25.506},
}  # fmt: skip


def by_hand(dilation_deg: float, cohesion: float, friction_deg: float, weight: float, area: float) -> float:
    """Half of the wedge in its plane of symmetry: slip and friction of a joint leave the line of intersection.

    With l down the line, m square to it and up, n·m = k and v = cos θ l + sin θ m: sin θ = sin ψ / k, and the friction
    acts against d = (v - sin ψ n) / cos ψ.
    """
    first, second = (np.array([math.sin(math.radians(d)) * s, math.cos(math.radians(d)) * s, s])
                     for d, s in ((115, math.sin(math.pi / 4)), (245, math.sin(math.pi / 4))))  # fmt: skip
    line = np.cross(first, second)
    line *= -np.sign(line[2]) / np.linalg.norm(line)
    up = np.cross(line, [1.0, 0.0, 0.0])
    up *= np.sign(up[2])
    k, sine = float(first @ up), math.sin(math.radians(dilation_deg))
    theta, cosine = math.asin(sine / k), math.cos(math.radians(dilation_deg))
    drag = np.array([math.cos(theta) / cosine, (math.sin(theta) - sine * k) / cosine])
    load, tangent = 0.5 * weight * np.array([-line[2], -up[2]]), math.tan(math.radians(friction_deg))
    # N k m - λ (c A + N tan φ) d + load = 0: by l λ (c A + N tan φ) is known, by m then N
    carried = load[0] / drag[0]
    push = (carried * drag[1] - load[1]) / k
    return (cohesion * area + push * tangent) / carried


@pytest.mark.parametrize("dilation", [0.0, 5.0, 12.0, 20.0])
def test_a_symmetric_wedge(dilation: float) -> None:
    strength = {"c": 50, "phi": 20, "dilation": dilation}
    found = sk.run(WEDGE | {"strength": {"s": strength}})
    weight, area = found.geometry.volume_m3 * 25.506, found.geometry.areas_m2["J1"]
    factor, angle = 1.0, dilation
    for _ in range(60):  # no joint dilates by more than what is left of its friction angle
        factor = by_hand(angle, 50.0, 20.0, weight, area)
        angle = min(dilation, math.degrees(math.atan(math.tan(math.radians(20.0)) / factor)))
    assert found.fos.limit == pytest.approx(factor, rel=1e-9)


def random_design(rng: np.random.Generator) -> Design:
    strengths = {
        name: {"c": rng.uniform(0, 40), "phi": rng.uniform(20, 42), "dilation": rng.uniform(0, 12)} for name in "st"
    }
    planes = {"J1": (rng.uniform(30, 60), rng.uniform(95, 150)), "J2": (rng.uniform(35, 70), rng.uniform(210, 260))}
    joints = {name: {"plane": [*plane], "strength": s} for s, (name, plane) in zip("st", planes.items(), strict=True)}
    face = {"face": f"{rng.uniform(65, 85)}/180", "upper": f"{rng.uniform(0, 15)}/180", "height": rng.uniform(5, 40)}
    return sk.load({"slopekit": 1, "kind": "wedge", "slope": face, "joints": joints, "strength": strengths,
                    "rock": {"unit_weight": 25}, "water": {"fill": rng.uniform(0, 0.5)}})  # fmt: skip


@pytest.mark.slow
def test_wedges_on_the_elastic_path() -> None:
    """The path is followed on node pairs at the corners: where all are pressed in the end it ends at the slide."""
    rng, pressed = np.random.default_rng(4), 0
    for _ in range(40):
        try:
            design = random_design(rng)
            scene = kind_of(design).cut(design).scene_at(0)
        except SlopekitError:
            continue
        model, bedding = scene.model, scene.bedding
        exact = flat_limit(model, bedding.polygons, bedding.centroid).exact
        path = _elastic_path_limit(model, model.cohesion, elastic_displacement(model))
        is_pressed = path.factor is not None and bool((path.normal_force > 0.0).all())
        assert (exact is not None) == is_pressed
        if exact is not None:
            assert exact.factor == pytest.approx(path.factor, rel=1e-8)
            assert exact.normal_force == pytest.approx(path.normal_force, abs=0.01 * path.normal_force.max())
            pressed += 1
    assert pressed > 5
