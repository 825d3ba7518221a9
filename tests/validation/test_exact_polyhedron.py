"""Volume, areas and total height against the polyhedron of the same planes in exact rational arithmetic."""

import math
from fractions import Fraction

import numpy as np
import pytest

import slopekit as sk
from tests.support import random_wedge, upward_normal


def exact(wedge) -> tuple[float, float, list[float], float]:
    """Volume, total height and areas of the tetrahedron, from Fractions of the floating-point normals."""
    n1, n2, nf, nu = (
        [Fraction(float(x)) for x in upward_normal(plane)]
        for plane in (*wedge["dips"], wedge["face"], wedge["upper"])
    )
    trace1, trace2, line = cross(n1, nf), cross(n2, nf), cross(n1, n2)
    crest1 = scaled(trace1, Fraction(wedge["height"]) / trace1[2])
    offset = dot(nu, crest1)
    crest2, back = scaled(trace2, offset / dot(nu, trace2)), scaled(line, offset / dot(nu, line))
    volume = abs(dot(crest1, cross(crest2, back))) / 6
    heights = [Fraction(0), crest1[2], crest2[2], back[2]]
    areas = [math.sqrt(dot(v, v)) / 2 for v in (cross(crest1, back), cross(crest2, back))]
    return float(volume), float(max(heights) - min(heights)), areas


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def scaled(a, by):
    return [x * by for x in a]


def wedges():
    rng = np.random.default_rng(5)
    yield from (
        {**random_wedge(rng), "water": None, "bolts": None, "seismic": None} for _ in range(40)
    )
    for a, b in (
        ((45, 179.99), (45, 180.01)),
        ((63.35, 150), (63.35, 210)),
        ((3, 100), (3, 260)),
        ((89, 95), (60, 200)),
    ):
        for height in (1e-3, 10.0, 1e5):
            yield {"dips": (a, b), "face": (60, 180), "upper": (0, 180), "height": height}


@pytest.mark.parametrize("wedge", list(wedges()), ids=lambda w: f"{w['dips']}-{w['height']:.4g}")
def test_size_of_the_wedge(wedge) -> None:
    """To 1e-10: the condition of near-parallel joints (0.02°) costs six digits of sixteen. No strength needed."""
    geometry = sk.wedge(**{**wedge, "c": 0.0, "phi": 0.0}).geometry
    volume, total, areas = exact(wedge)
    assert geometry.volume_m3 == pytest.approx(volume, rel=1e-10)
    assert geometry.total_height_m == pytest.approx(total, rel=1e-10)
    assert [geometry.areas_m2["J1"], geometry.areas_m2["J2"]] == pytest.approx(areas, rel=1e-10)
