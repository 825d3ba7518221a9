"""Passive bolts in a model: how fast a motion draws each out, by rigid kinematics at its own point."""

import numpy as np
import pytest

from slopekit.geometry.interfaces import node_pairs
from slopekit.loads import Loads
from slopekit.preie.system.model import JointStrength, build_model


@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (0.3, -0.2, 0.5)])
def test_a_bolt_shortens_by_the_motion_of_its_point(turn) -> None:
    """d·(u + ω x r), r from the centroid to the bolt: both from the test's own numbers."""
    square = np.array([[0.0, 0.0, 0.0], [0.0, 2.0, 0.0], [2.0, 2.0, 0.0], [2.0, 0.0, 0.0]])
    centroid, at, pull = (
        np.array([1.0, 1.0, 1.0]),
        np.array([2.0, 1.5, 5.0]),
        np.array([3.0, 0.0, 4.0]),
    )
    weight = np.array([0.0, 0.0, -50.0])
    loads = Loads(weight, np.zeros(3), {"weight": weight}, pull[None], at[None])
    one = np.ones(1)
    model = build_model(
        node_pairs({0: square}), loads, centroid, JointStrength(0 * one, one, 0 * one, 0 * one)
    )
    moved, rotation = np.array([0.1, 0.4, -0.2]), np.array(turn)
    expected = (pull / 5.0) @ (moved + np.cross(rotation, at - centroid))
    # unknowns are displacements in parts of the length scale, and rotations
    unknowns = np.concatenate([moved / model.length_scale, rotation])
    assert float(model.bolt_rows[0] @ unknowns) * model.length_scale == pytest.approx(
        expected, rel=1e-12
    )
    assert model.bolt_capacity[0] * model.force_scale == pytest.approx(5.0)
