"""Berms: the formulas against a few lines of their own, the spill against a sum over small columns.

Independent sources: points of a bench drawn one by one; numerical integration of the pile. The catch widths of 5, 10
and 15 m benches are those printed by Kuchling (kuchling.com, pit wall angles and bench width): 5.5, 6.5 and 7.5 m.
"""

import math

import numpy as np
import pytest

from slopekit.closed_form.berms import (
    catch_width,
    cone_spill_width,
    effective_face_angle,
    inter_ramp_angle,
    prism_spill_width,
)


def test_published_catch_widths() -> None:
    """0.2 H + 4.5 m as printed for three heights."""
    assert catch_width([5.0, 10.0, 15.0]).tolist() == pytest.approx([5.5, 6.5, 7.5], abs=1e-12)


@pytest.mark.parametrize(("height", "berm"), [(5.0, 2.4), (10.0, 4.8), (15.0, 7.1)])
def test_published_inter_ramp_angle(height: float, berm: float) -> None:
    """Kuchling: an inter-ramp angle of 50° and a face of 70° leave 2.4, 4.8, 7.1 m (to 0.1 m: 0.3°)."""
    assert inter_ramp_angle(height, 70.0, berm) == pytest.approx(50.0, abs=0.35)


def test_angles_against_points() -> None:
    """A bench drawn: toe, crest, next toe; and with the crest gone by 2.5 m."""
    toe, crest = np.array([0.0, 0.0]), np.array([12.0 / math.tan(math.radians(68.0)), 12.0])
    next_toe, broken = crest + np.array([6.2, 0.0]), crest + np.array([2.5, 0.0])
    angle = math.degrees(math.atan2(*(next_toe - toe)[::-1]))
    assert inter_ramp_angle(12.0, 68.0, 6.2) == pytest.approx(angle, rel=1e-12)
    left = math.degrees(math.atan2(*(broken - toe)[::-1]))
    assert effective_face_angle(12.0, 68.0, 2.5) == pytest.approx(left, rel=1e-12)
    # what is lost of the berm goes to the face: the stack is as steep as before
    assert inter_ramp_angle(12.0, left, 6.2 - 2.5) == pytest.approx(angle, rel=1e-12)


@pytest.mark.parametrize(("face", "repose"), [(90.0, 37.0), (65.0, 37.0), (75.0, 30.0)])
def test_cone_against_a_sum_of_columns(face: float, repose: float) -> None:
    """The pile over a fine grid of the floor and the face: its volume is what was spilled, swollen."""
    volume, swell = 40.0, 1.5
    width = float(cone_spill_width(volume, face, repose, swell))
    back, flat = (1.0 / math.tan(math.radians(angle)) for angle in (face, repose))
    tip = width / (flat - back)
    behind = tip * back  # the tip lies so far behind the toe, over the face
    x = np.linspace(-behind, width, 1601)
    y = np.linspace(-tip * flat, tip * flat, 1601)
    xs, ys = np.meshgrid((x[1:] + x[:-1]) / 2.0, (y[1:] + y[:-1]) / 2.0, indexing="ij")
    top = tip - np.hypot(xs + behind, ys) / flat
    ground = np.where(xs < 0.0, -xs / back if back > 1e-12 else 0.0, 0.0)
    pile = np.maximum(0.0, top - ground).sum() * (x[1] - x[0]) * (y[1] - y[0])
    assert pile == pytest.approx(volume * swell, rel=2e-4)  # the grid's own error


def test_prism_against_its_triangle() -> None:
    """A triangle between floor, face and the angle of repose."""
    width = float(prism_spill_width(9.0, 70.0, 35.0, 1.4))
    back, flat = (1.0 / math.tan(math.radians(angle)) for angle in (70.0, 35.0))
    tip = width / (flat - back)
    corners = np.array([[0.0, 0.0], [width, 0.0], [-tip * back, tip]])
    x, z = corners.T
    area = abs(np.dot(x, np.roll(z, -1)) - np.dot(z, np.roll(x, -1))) / 2.0
    assert area == pytest.approx(9.0 * 1.4, rel=1e-12)


def test_no_spill_on_a_flat_face() -> None:
    """Broken rock stays on a face that is flatter than its angle of repose."""
    assert float(cone_spill_width(10.0, 30.0, 37.0)) == 0.0
    assert float(prism_spill_width(10.0, 30.0, 37.0)) == 0.0
