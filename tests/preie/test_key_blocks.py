"""Single blocks that slide out: all at once against one after the other, and by hand."""

import math

import numpy as np
import pytest

from slopekit.preie.many_blocks.key_blocks import sliding_factors

_PARALLEL = 1e-9


def one_by_one(normals, force, cohesion, tan_friction) -> float:
    """The same for one block, face by face and pair by pair."""
    lowest = math.inf
    for a in range(len(normals)):
        for b in range(a, len(normals)):
            if a == b:
                press = -float(force @ normals[a])
                along, carried = force + press * normals[a], np.array([press])
            else:
                line = np.cross(normals[a], normals[b])
                if line @ line < _PARALLEL:
                    continue
                along = line * (float(force @ line) / float(line @ line))
                carried = np.linalg.lstsq(
                    np.stack([normals[a], normals[b]], axis=1), along - force, rcond=None
                )[0]
            pull = math.sqrt(float(along @ along))
            if carried.min() < 0.0 or pull <= _PARALLEL * math.sqrt(float(force @ force)):
                continue
            opening = normals @ along / pull
            if opening.min() < -_PARALLEL:
                continue
            strength = float(cohesion[opening < _PARALLEL].sum())
            strength += sum(carried * tan_friction[[a, b][: len(carried)]])
            lowest = min(lowest, strength / pull)
    return lowest


@pytest.mark.parametrize("seed", range(2))
def test_all_blocks_at_once_are_one_after_the_other(seed) -> None:
    """200 blocks of one to eight faces, some of them in one plane, some blocks without weight."""
    rng = np.random.default_rng(seed)
    counts = rng.integers(1, 9, 200)
    block = np.repeat(np.arange(200), counts)
    normals = rng.normal(size=(len(block), 3)) + np.array([0.0, -0.6, 0.9])
    twice = rng.random(len(block) - 1) < 0.1
    normals[1:][twice] = normals[:-1][twice]
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    forces = rng.normal(size=(200, 3)) * 0.2 - np.array([0.0, 0.0, 1.0])
    forces[rng.random(200) < 0.05] = 0.0
    cohesion, tan_friction = rng.uniform(0.0, 3.0, len(block)), rng.uniform(0.0, 1.5, len(block))
    found = sliding_factors(block, normals, forces, cohesion, tan_friction)
    exact = [
        one_by_one(normals[block == k], forces[k], cohesion[block == k], tan_friction[block == k])
        for k in range(200)
    ]
    assert 20 < np.isfinite(found).sum() < 180
    assert found == pytest.approx(np.array(exact), rel=1e-9)


def test_a_symmetric_wedge_by_hand() -> None:
    """Two planes of dip 45 to both sides of a line that plunges 30: F = tan φ cot 30 / cos 45."""
    down = math.radians(30.0)
    across, up = np.array([1.0, 0.0, 0.0]), np.array([0.0, math.sin(down), math.cos(down)])
    normals = np.stack([(up + across), (up - across)]) / math.sqrt(2.0)
    force = np.array([[0.0, 0.0, -2.0]])
    found = sliding_factors(
        np.zeros(2, dtype=np.int64), normals, force, np.zeros(2), np.full(2, 0.6)
    )
    assert found == pytest.approx(0.6 / math.tan(down) * math.sqrt(2.0), rel=1e-12)


def test_a_block_that_another_face_stops_does_not_slide() -> None:
    """A plane that dips 30 towards +y, and a wall across it."""
    down = math.radians(30.0)
    normals = np.array([[0.0, math.sin(down), math.cos(down)], [0.0, -1.0, 0.0]])
    force = np.array([[0.0, 0.0, -1.0]])
    found = sliding_factors(
        np.zeros(2, dtype=np.int64), normals, force, np.ones(2), np.full(2, 0.6)
    )
    assert np.isinf(found).all()
