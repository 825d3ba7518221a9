"""Correlation: names, pairs, coefficients that contradict each other, and the nearest that do not."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slopekit.core.orientation import Line, Plane
from slopekit.design.reading.nodes import document_from
from slopekit.design.scatter.copula import (
    EIGENVALUE_TOLERANCE,
    factor,
    nearest_correlation,
    nearest_ranks,
    normal_correlation,
    rank_correlation,
    smallest_eigenvalue,
)
from slopekit.design.scatter.correlation import check_correlation
from slopekit.design.scatter.distributions import Angles, Distribution, Fisher, Variable

DIP = Distribution("normal", {"mean": 45.0, "sd": 3.0}, "angle")
J1, J2 = (Variable(f"joints.{name}.plane", Fisher(Plane(45, 115), 100)) for name in ("J1", "J2"))
FACE = Variable("slope.face", Angles("plane", DIP, 180.0))
UPPER = Variable("slope.upper", Angles("plane", 10.0, DIP))
BOLT = Variable("support.bolts.0.toward", Fisher(Line(0, 10), 100))
NAMES = {
    "J1.phi": "strength.a.phi", "J2.phi": "strength.b.phi", "J1.c": "strength.a.c", "J3.phi": "strength.a.phi",
    "J1.plane": J1, "J2.plane": J2, "J1.plane.dip": J1.angles[0], "J1.plane.dip_direction": J1.angles[1],
    "slope.face": FACE, "slope.upper": UPPER, BOLT.path: BOLT,
}  # fmt: skip


def node(value):
    return document_from({"x": value}).root.get("x")


CORRELATIONS = [
    ("E106", {"J1.phi/J2.phi": "high"}, "correlation J1.phi/J2.phi is 'high', a number is needed", ""),
    ("E144", "0.8", "correlation is not a group of pairs", ""),
    ("E167", {"J1.phi": 0.8}, "J1.phi is not a pair of two names", ""),
    ("E167", {"J1.phi/J2.phi/J1.c": 0.8}, "is not a pair of two names", ""),
    ("E168", {"J1.phi/J2.pih": 0.8}, "J2.pih is not a value that scatters in this design", "Did you mean J2.phi?"),
    ("E167", {"J1.phi/J2.phi": 1.2}, "correlation J1.phi/J2.phi is 1.2, it lies between -1 and 1", ""),
    ("E151", {"J1.phi/J2.phi": 0.8, "J2.phi/J1.phi": 0.7}, "J2.phi/J1.phi is the same pair as J1.phi/J2.phi", ""),
    ("E151", {"J1.phi/J2.phi": 0.8, "J2.phi/J3.phi": 0.7}, "J2.phi/J3.phi is the same pair as J1.phi/J2.phi", ""),
    ("E151", {f"J1.plane/{BOLT.path}": 0.8, f"{BOLT.path}/J1.plane": 0.8}, "is the same pair as J1.plane/support", ""),
    ("E167", {"J1.phi/J1.phi": 0.8}, "J1.phi is correlated with itself, that is always 1", "Leave it out."),
    ("E167", {"J1.phi/J3.phi": 0.8}, "J1.phi and J3.phi are one value, strength.a.phi", "two strengths"),
    ("E167", {"J1.plane/J1.plane": 0.8}, "J1.plane is correlated with itself", ""),
    ("E183", {"J1.phi/J2.phi": 0.9, "J2.phi/J1.c": 0.9, "J1.phi/J1.c": -0.9},
     "the correlations of J1.phi, J2.phi, J1.c contradict each other: their matrix has the eigenvalue -0.816",
     "The nearest that can be: correlation: {J1.phi/J2.phi: 0.482, J2.phi/J1.c: 0.482, J1.phi/J1.c: -0.482}"),
    ("E183", {"J1.phi/J2.phi": 1, "J2.phi/J1.c": 1}, "contradict each other",
     "{J1.phi/J2.phi: 0.69, J2.phi/J1.c: 0.69} Pairs that are not given count as 0: give those too."),
    ("E183", {"J1.plane/J2.plane": 1, f"J2.plane/{BOLT.path}": 1},
     "of J1.plane.dip, J2.plane.dip, support.bolts.0.toward.plunge contradict",
     "{J1.plane/J2.plane: 0.69, J2.plane/support.bolts.0.toward: 0.69}"),
    ("E167", {"J1.plane/J1.phi": 0.5}, "J1.plane is an orientation, J1.phi is not: J1.plane/J1.phi does not say which",
     "Write J1.plane.dip/J1.phi or J1.plane.dip_direction/J1.phi."),
    ("E167", {"J1.phi/slope.face": 0.5}, "slope.face is an orientation", "Write slope.face.dip/J1.phi."),
    ("E167", {"J1.plane.dip/J2.plane": 0.5}, "J2.plane is an orientation, J1.plane.dip is not", "J2.plane.dip/J1."),
    ("E167", {"slope.face/slope.upper": 0.5}, "of slope.face and slope.upper no angle scatters in both",
     "slope.face.dip, slope.upper.dip_direction"),
    ("E167", {"J1.plane.dip/J1.plane.dip_direction": 0.5}, "are of one Fisher distribution", "plane: {dip: {dist:"),
]  # fmt: skip


@pytest.mark.parametrize(("code", "given", "says", "advice"), CORRELATIONS, ids=lambda value: str(value)[:40])
def test_correlations_that_cannot_be(code, given, says, advice) -> None:
    _, faults = check_correlation(node(given), NAMES)
    assert {fault.code for fault in faults} == {code}
    assert says in faults[0].message
    assert advice in faults[0].advice


def test_correlations_that_can_be() -> None:
    pairs, faults = check_correlation(node({"J1.phi / J2.phi": "80 %", "J1.c/J1.phi": -0.5}), NAMES)
    assert faults == []
    assert pairs == (("strength.a.phi", "strength.b.phi", 0.8), ("strength.a.c", "strength.a.phi", -0.5))
    singular = {"J1.phi/J2.phi": 1.0, "J1.phi/J1.c": -1.0, "J2.phi/J1.c": -1.0}
    assert check_correlation(node(singular), NAMES)[1] == []
    assert check_correlation(node({}), NAMES) == ((), [])


def test_two_orientations_are_paired_angle_by_angle() -> None:
    pairs, _ = check_correlation(node({f"J1.plane/{BOLT.path}": 0.8, "slope.face/J2.plane": 0.5}), NAMES)
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
        "the correlations of a, b, c", "the correlations of d, e, f",
    ]  # fmt: skip


# -- matrices ---------------------------------------------------------------------------------------------------------


@st.composite
def impossible(draw):
    """Symmetric matrices of 3 to 6 coefficients in steps of 0.05, some of the pairs not given (0), that cannot be."""
    count = draw(st.integers(3, 6))
    matrix, is_given = np.eye(count), np.eye(count, dtype=bool)
    for i, j in itertools.combinations(range(count), 2):
        if draw(st.booleans()) or count == 3:
            matrix[i, j] = matrix[j, i] = draw(st.integers(-20, 20)) / 20
            is_given[i, j] = is_given[j, i] = True
    return matrix, is_given


def test_published_nearest_matrix() -> None:
    """Higham (2002), IMA J. Numer. Anal. 22, the example of the introduction, to its four digits."""
    tridiagonal = np.eye(3) + np.eye(3, k=1) + np.eye(3, k=-1)
    found = nearest_correlation(tridiagonal, np.ones((3, 3), dtype=bool))
    assert found == pytest.approx(
        np.array([[1, 0.7607, 0.1573], [0.7607, 1, 0.7607], [0.1573, 0.7607, 1]]), abs=5e-5
    )  # fmt: skip


@settings(max_examples=60, deadline=None)
@given(impossible(), st.integers(0, 2**32 - 1))
def test_the_nearest_matrix_is_valid_and_nearest(given, seed) -> None:
    """Nearest of a convex set: (A - X) : (Y - X) <= 0 for every other Y of it, which is necessary and sufficient.

    Y are random correlation matrices with the same zeros, extreme ones among them. To 1e-7: the projections stop at a
    change of 1e-13, of which the slow ones are a millionth of the way.
    """
    matrix, is_given = given
    found = nearest_correlation(matrix, is_given)
    assert np.linalg.eigvalsh(found)[0] > -1e-7
    assert np.diag(found) == pytest.approx(1.0, abs=0)
    assert (found[~is_given] == 0.0).all()
    rng, count = np.random.default_rng(seed), len(matrix)
    for _ in range(100):
        vectors = rng.standard_normal((count, rng.integers(1, count + 1)))
        vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
        other = np.where(is_given, vectors @ vectors.T, 0.0)
        lowest = np.linalg.eigvalsh(other)[0]
        if lowest < 0.0:
            other = np.eye(count) + (other - np.eye(count)) / (1.0 - lowest)
        assert ((matrix - found) * (other - found)).sum() < 1e-7
    scaled = np.eye(count) + (matrix - np.eye(count)) / max(1.0, 1.0 - np.linalg.eigvalsh(matrix)[0])
    assert np.linalg.norm(matrix - found) <= np.linalg.norm(matrix - scaled) + 1e-9


@settings(max_examples=60, deadline=None)
@given(impossible())
def test_what_is_printed_can_be_typed_in(given) -> None:
    """Three decimals, valid as they stand, the pairs that are not given still 0, and within 0.02 of the nearest."""
    matrix, is_given = given
    printed = nearest_ranks(matrix, is_given)
    assert smallest_eigenvalue(printed) >= -EIGENVALUE_TOLERANCE
    assert np.round(printed, 3) == pytest.approx(printed, abs=1e-15)
    assert (printed[~is_given] == 0.0).all()
    assert normal_correlation(printed) == pytest.approx(
        nearest_correlation(normal_correlation(matrix), is_given), abs=0.02
    )  # fmt: skip


def test_ranks_and_normals() -> None:
    """Kruskal (1958): the probability of concordance of two normals, 1/2 + asin(r/2) 3/π by its definition."""
    ranks = np.linspace(-1, 1, 21)
    assert rank_correlation(normal_correlation(ranks)) == pytest.approx(ranks, abs=1e-12)
    assert normal_correlation(np.array([-1.0, 0.0, 1.0])).tolist() == [-1.0, 0.0, 1.0]


@settings(max_examples=60, deadline=None)
@given(impossible())
def test_the_factor_of_any_possible_matrix(given) -> None:
    """L Lᵀ is the matrix, to 1e-6: these are singular, and √ halves the digits of what is left of their pivots."""
    matrix, is_given = given
    possible = nearest_correlation(matrix, is_given)
    lower = factor(possible)
    assert lower @ lower.T == pytest.approx(possible, abs=1e-6)


def test_the_factor_of_the_same_value_several_times() -> None:
    assert factor(np.ones((3, 3))).tolist() == [[1.0]] * 3
    assert factor(np.array([[1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 1.0]])).shape == (3, 2)
