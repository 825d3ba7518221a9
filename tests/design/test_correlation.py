"""Correlation: names, pairs, coefficients that contradict each other."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slopekit.core.orientation import Line, Plane
from slopekit.design.reading.nodes import document_from
from slopekit.design.scatter.copula import (
    factor,
    normal_correlation,
)
from slopekit.design.scatter.correlation import check_correlation
from slopekit.design.scatter.distributions import Angles, Distribution, Fisher, Variable

DIP = Distribution("normal", {"mean": 45.0, "sd": 3.0}, "angle")
J1, J2 = (Variable(f"joints.{name}.plane", Fisher(Plane(45, 115), 100)) for name in ("J1", "J2"))
FACE = Variable("slope.face", Angles("plane", DIP, 180.0))
UPPER = Variable("slope.upper", Angles("plane", 10.0, DIP))
BOLT = Variable("support.bolts.0.toward", Fisher(Line(0, 10), 100))
NAMES = {
    "J1.phi": "strength.a.phi",
    "J2.phi": "strength.b.phi",
    "J1.c": "strength.a.c",
    "J3.phi": "strength.a.phi",
    "J1.plane": J1,
    "J2.plane": J2,
    "J1.plane.dip": J1.angles[0],
    "J1.plane.dip_direction": J1.angles[1],
    "slope.face": FACE,
    "slope.upper": UPPER,
    BOLT.path: BOLT,
}


def node(value):
    return document_from({"x": value}).root.get("x")


CORRELATIONS = [
    (
        "E106",
        {"J1.phi/J2.phi": "high"},
        "correlation J1.phi/J2.phi is 'high', a number is needed",
        "",
    ),
    ("E144", "0.8", "correlation is not a group of pairs", ""),
    ("E167", {"J1.phi": 0.8}, "J1.phi is not a pair of two names", ""),
    ("E167", {"J1.phi/J2.phi/J1.c": 0.8}, "is not a pair of two names", ""),
    (
        "E168",
        {"J1.phi/J2.pih": 0.8},
        "J2.pih is not a value that scatters in this design",
        "Did you mean J2.phi?",
    ),
    (
        "E167",
        {"J1.phi/J2.phi": 1.2},
        "correlation J1.phi/J2.phi is 1.2, it lies between -1 and 1",
        "",
    ),
    (
        "E151",
        {"J1.phi/J2.phi": 0.8, "J2.phi/J1.phi": 0.7},
        "J2.phi/J1.phi is the same pair as J1.phi/J2.phi",
        "",
    ),
    (
        "E151",
        {"J1.phi/J2.phi": 0.8, "J2.phi/J3.phi": 0.7},
        "J2.phi/J3.phi is the same pair as J1.phi/J2.phi",
        "",
    ),
    (
        "E151",
        {f"J1.plane/{BOLT.path}": 0.8, f"{BOLT.path}/J1.plane": 0.8},
        "is the same pair as J1.plane/support",
        "",
    ),
    (
        "E167",
        {"J1.phi/J1.phi": 0.8},
        "J1.phi is correlated with itself, that is always 1",
        "Leave it out.",
    ),
    (
        "E167",
        {"J1.phi/J3.phi": 0.8},
        "J1.phi and J3.phi are one value, strength.a.phi",
        "two strengths",
    ),
    ("E167", {"J1.plane/J1.plane": 0.8}, "J1.plane is correlated with itself", ""),
    (
        "E183",
        {"J1.phi/J2.phi": 0.9, "J2.phi/J1.c": 0.9, "J1.phi/J1.c": -0.9},
        "the correlations of J1.phi, J2.phi, J1.c contradict each other: their matrix has the eigenvalue -0.816",
        "Bring them nearer to 0. Pairs that are not given count as 0.",
    ),
    (
        "E183",
        {"J1.phi/J2.phi": 1, "J2.phi/J1.c": 1},
        "contradict each other",
        "Bring them nearer to 0.",
    ),
    (
        "E183",
        {"J1.plane/J2.plane": 1, f"J2.plane/{BOLT.path}": 1},
        "of J1.plane.dip, J2.plane.dip, support.bolts.0.toward.plunge contradict",
        "Bring them nearer to 0.",
    ),
    (
        "E167",
        {"J1.plane/J1.phi": 0.5},
        "J1.plane is an orientation, J1.phi is not: J1.plane/J1.phi does not say which",
        "Write J1.plane.dip/J1.phi or J1.plane.dip_direction/J1.phi.",
    ),
    (
        "E167",
        {"J1.phi/slope.face": 0.5},
        "slope.face is an orientation",
        "Write slope.face.dip/J1.phi.",
    ),
    (
        "E167",
        {"J1.plane.dip/J2.plane": 0.5},
        "J2.plane is an orientation, J1.plane.dip is not",
        "J2.plane.dip/J1.",
    ),
    (
        "E167",
        {"slope.face/slope.upper": 0.5},
        "of slope.face and slope.upper no angle scatters in both",
        "slope.face.dip, slope.upper.dip_direction",
    ),
    (
        "E167",
        {"J1.plane.dip/J1.plane.dip_direction": 0.5},
        "are of one Fisher distribution",
        "plane: {dip: {dist:",
    ),
]


@pytest.mark.parametrize(
    ("code", "given", "says", "advice"), CORRELATIONS, ids=lambda value: str(value)[:40]
)
def test_correlations_that_cannot_be(code, given, says, advice) -> None:
    _, faults = check_correlation(node(given), NAMES)
    assert {fault.code for fault in faults} == {code}
    assert says in faults[0].message
    assert advice in faults[0].advice


def test_correlations_that_can_be() -> None:
    pairs, faults = check_correlation(node({"J1.phi / J2.phi": "80 %", "J1.c/J1.phi": -0.5}), NAMES)
    assert faults == []
    assert pairs == (
        ("strength.a.phi", "strength.b.phi", 0.8),
        ("strength.a.c", "strength.a.phi", -0.5),
    )
    singular = {"J1.phi/J2.phi": 1.0, "J1.phi/J1.c": -1.0, "J2.phi/J1.c": -1.0}
    assert check_correlation(node(singular), NAMES)[1] == []
    assert check_correlation(node({}), NAMES) == ((), [])


def test_two_orientations_are_paired_angle_by_angle() -> None:
    pairs, _ = check_correlation(
        node({f"J1.plane/{BOLT.path}": 0.8, "slope.face/J2.plane": 0.5}), NAMES
    )
    assert pairs == (
        ("joints.J1.plane.dip", "support.bolts.0.toward.plunge", 0.8),
        ("joints.J1.plane.dip_direction", "support.bolts.0.toward.trend", 0.8),
        ("slope.face.dip", "joints.J2.plane.dip", 0.5),
    )


def test_an_unknown_name_where_nothing_scatters() -> None:
    _, faults = check_correlation(node({"J1.phi/J2.phi": 0.5}), {})
    assert [fault.advice for fault in faults] == ["Nothing in this design is a distribution."] * 2


def test_each_contradiction_is_a_fault_of_its_own() -> None:
    names = {name: name for name in "abcdefgh"}
    impossible = {"a/b": 1, "b/c": 1, "d/e": -1, "e/f": -1, "g/h": 0.9}
    _, faults = check_correlation(node(impossible), names)
    assert [fault.message.split(" contradict")[0] for fault in faults] == [
        "the correlations of a, b, c",
        "the correlations of d, e, f",
    ]


# -- matrices ---------------------------------------------------------------------------------------------------------


def test_ranks_and_normals() -> None:
    """Kruskal (1958): the probability of concordance of two normals, 1/2 + asin(r/2) 3/π by its definition."""
    ranks = np.linspace(-1, 1, 21)
    assert 6.0 / np.pi * np.arcsin(normal_correlation(ranks) / 2.0) == pytest.approx(
        ranks, abs=1e-12
    )
    assert normal_correlation(np.array([-1.0, 0.0, 1.0])).tolist() == [-1.0, 0.0, 1.0]


@settings(max_examples=60, deadline=None)
@given(st.integers(3, 6), st.integers(0, 2**32 - 1))
def test_the_factor_of_a_singular_matrix(count, seed) -> None:
    """L Lᵀ is the matrix, to 1e-6: these are singular, and √ halves the digits of what is left of their pivots."""
    vectors = np.random.default_rng(seed).standard_normal((count, count - 1))
    vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
    lower = factor(vectors @ vectors.T)
    assert lower @ lower.T == pytest.approx(vectors @ vectors.T, abs=1e-6)


def test_the_factor_of_the_same_value_several_times() -> None:
    assert factor(np.ones((3, 3))).tolist() == [[1.0]] * 3
    assert factor(np.array([[1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 1.0]])).shape == (3, 2)
