"""Planes of joint sets: where they are, how they scatter, which of them are one plane."""

import math
from dataclasses import replace

import numpy as np
import pytest

from slopekit.core.errors import GeometryError
from slopekit.geometry.rock.bench import BODY_FACES, ConvexBody, bench_body
from slopekit.geometry.rock.joint_sets import JointSet, planes_of_sets

SOUTH, FLAT, EAST = np.array([0.0, -1.0, 0.0]), np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])


def normal(dip_deg: float, dip_direction_deg: float) -> np.ndarray:
    dip, direction = math.radians(dip_deg), math.radians(dip_direction_deg)
    return np.array(
        [math.sin(dip) * math.sin(direction), math.sin(dip) * math.cos(direction), math.cos(dip)]
    )


def moved(body: ConvexBody, by: np.ndarray) -> ConvexBody:
    return ConvexBody(
        body.normals, body.offsets + body.normals @ by, body.is_far, body.corners + by
    )


BOX = bench_body(SOUTH, FLAT, 10.0, 30.0, 20.0)


def planes(*sets: JointSet, body: ConvexBody = BOX, seed: int = 0):
    return planes_of_sets(sets, body, np.random.default_rng(seed))


def test_a_bench_by_hand() -> None:
    """Face 45° to the south, upper slope 10°: the back lies 20 m behind the crest, which is 10 m behind the toe."""
    body = bench_body(normal(45.0, 180.0), normal(10.0, 180.0), 10.0, 30.0, 20.0)
    tops = 10.0 + 20.0 * math.tan(math.radians(10.0))
    section = np.array([[0.0, 0.0], [10.0, 10.0], [30.0, tops], [30.0, 0.0]])
    expected = [[x, y, z] for x in (-15.0, 15.0) for y, z in section]
    assert body.corners == pytest.approx(np.array(expected), abs=1e-12)
    assert (body.corners @ body.normals.T <= body.offsets + 1e-12).all()
    assert [name for name, far in zip(BODY_FACES, body.is_far, strict=True) if not far] == [
        "face",
        "upper slope",
    ]


@pytest.mark.parametrize(
    ("face", "upper", "sizes", "code"),
    [
        (normal(0.5, 0.0), FLAT, (10.0, 30.0, 20.0), "E221"),
        (normal(60.0, 0.0), normal(60.0, 0.0), (10.0, 30.0, 20.0), "E209"),
        (normal(60.0, 0.0), normal(90.0, 90.0), (10.0, 30.0, 20.0), "E209"),
        (
            normal(60.0, 0.0),
            normal(40.0, 180.0),
            (10.0, 30.0, 20.0),
            "E209",
        ),  # behind the crest it falls below the toe
        (
            normal(60.0, 0.0),
            normal(40.0, 90.0),
            (10.0, 30.0, 20.0),
            "E209",
        ),  # along the crest it does
    ],
)
def test_no_bench(face, upper, sizes, code) -> None:
    with pytest.raises(GeometryError) as caught:
        bench_body(face, upper, *sizes)
    assert caught.value.codes == (code,)


def test_regular_planes_and_no_random_numbers() -> None:
    rng = np.random.default_rng(5)
    found = planes_of_sets([JointSet(FLAT, 2.5, 1000.0), JointSet(EAST, 4.0, 1.0)], BOX, rng)
    assert found.offsets.tolist() == [2.5, 5.0, 7.5, -11.0, -7.0, -3.0, 1.0, 5.0, 9.0, 13.0]
    assert found.joint.tolist() == [0] * 3 + [1] * 7
    assert rng.random() == np.random.default_rng(5).random()


@pytest.mark.parametrize("tilt_deg", [0.0, 1e-6])
def test_duplicates(tilt_deg) -> None:
    """The same set twice, once upside down, is one set; every second plane of half the spacing is new."""
    tilted = normal(tilt_deg, 30.0)
    found = planes(JointSet(FLAT, 2.0, 1.0), JointSet(-tilted, 1.0, -1.0))
    assert (found.joint == 0).sum() == 5
    assert sorted(found.offsets[found.joint == 1].round(6).tolist()) == [-8.0, -6.0, -4.0, -2.0]
    assert len(planes(JointSet(FLAT, 2.0, 1.0), JointSet(normal(0.01, 30.0), 2.0, 1.0))) == 10


def test_scattered_spacing() -> None:
    """Mean and standard deviation of many gaps; the plane at the offset stays."""
    found = planes(JointSet(EAST, 0.02, 0.5, spacing_scatter=0.3))
    gaps = np.diff(found.offsets)
    assert gaps.min() >= 0.002 * (1.0 - 1e-9)
    assert gaps.mean() == pytest.approx(0.02, rel=0.03)  # 1,500 gaps: 0.8 % standard error
    assert gaps.std() == pytest.approx(0.006, rel=0.06)
    assert np.abs(found.offsets - 0.5).min() < 1e-12


def test_scattered_normals() -> None:
    """Fisher: the root mean square angle is the scatter, and the mean direction is the set's."""
    mean = normal(50.0, 120.0)
    found = planes(JointSet(mean, 0.02, 0.0, scatter_deg=4.0))
    assert np.abs((found.normals**2).sum(axis=1) - 1.0).max() < 1e-12
    angles = np.degrees(np.arccos(found.normals @ mean))
    assert math.sqrt((angles**2).mean()) == pytest.approx(4.0, rel=0.06)
    middle = found.normals.mean(axis=0)
    assert math.degrees(math.acos(middle @ mean / math.sqrt(middle @ middle))) < 0.5


def test_where_scattered_normals_turn() -> None:
    """Each plane is turned about its point nearest the middle: along the mean normal through it they stay regular."""
    mean = normal(50.0, 120.0)
    found = planes(JointSet(mean, 0.5, 0.2, scatter_deg=10.0))
    middle = np.array([0.0, 10.0, 5.0])
    along = (found.offsets - found.normals @ middle) / (found.normals @ mean)
    steps = (along + middle @ mean - 0.2) / 0.5
    assert steps == pytest.approx(steps.round(), abs=1e-9)
    assert len(np.unique(steps.round())) == len(found)


def test_seeds() -> None:
    scattered = JointSet(normal(50.0, 120.0), 1.0, 0.0, 3.0, 0.2)
    first, again, other = planes(scattered), planes(scattered), planes(scattered, seed=1)
    assert (first.normals == again.normals).all()
    assert (first.offsets == again.offsets).all()
    assert len(first) != len(other) or (first.offsets != other.offsets).any()


def test_moved_to_map_coordinates() -> None:
    by = np.array([5e5, 4e6, 300.0])
    scattered = JointSet(normal(50.0, 120.0), 1.0, 0.25, 3.0, 0.2)
    here = planes(scattered)
    there = planes(
        replace(scattered, offset=0.25 + float(scattered.normal @ by)), body=moved(BOX, by)
    )
    assert there.normals == pytest.approx(here.normals, abs=1e-9)
    assert there.offsets - there.normals @ by == pytest.approx(here.offsets, abs=1e-8)


def test_too_many_planes() -> None:
    with pytest.raises(GeometryError, match=r"E220 joint set 1 has 1e\+10 planes"):
        planes(JointSet(FLAT, 1e-9))
