"""What the rim of a cap adds to the area within its chords, against spherical trigonometry."""

import math

import numpy as np
import pytest

from slopekit.geometry.solids import sliding_mass
from slopekit.geometry.solids.shapes import Ellipsoid
from tests.scenes import ground_about


@pytest.mark.parametrize(("level", "rel"), [(3, 2e-3), (4, 5e-4), (5, 1e-4)])
def test_strips_between_the_chords_and_the_rim_of_a_spherical_cap(level, rel) -> None:
    """Cap less its spherical triangles, each from the pole to a chord (L'Huilier, after Van Oosterom & Strackee 1983).

    A strip is taken as two thirds of chord times height: exact but for the square of its angle.
    """
    radius, depth = 10.0, 4.0
    shape = Ellipsoid(np.full(3, radius))
    body = shape.cutter(level)
    ground = ground_about(body, [(-30.0, -depth), (30.0, -depth)])
    mass = sliding_mass._with_rim_on_surface(sliding_mass.cut_mass(ground, body), shape.metric)
    sides = sliding_mass._edges(mass)
    a, b = (sides.ends[sides.rim] / radius).transpose(1, 0, 2)
    pole = np.array([0.0, 0.0, -1.0])
    triangles = 2.0 * np.arctan2(
        np.abs(np.cross(a, b) @ pole), 1.0 + (a * b).sum(axis=1) + a @ pole + b @ pole
    )
    cap = 2.0 * math.pi * (1.0 - depth / radius)
    strips = sliding_mass._rim_strips(mass, shape.metric).sum()
    assert strips == pytest.approx(radius**2 * (cap - float(triangles.sum())), rel=rel)
