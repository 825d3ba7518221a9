"""Distributions: what is read, and every parameter that cannot be."""

import pytest

from slopekit.core.errors import DesignError
from slopekit.core.orientation import Line, Plane
from slopekit.design.reading.nodes import document_from
from slopekit.design.reading.structure import is_distribution
from slopekit.design.scatter.distributions import (
    Angles,
    Distribution,
    Fisher,
    Variable,
    read_angles,
    read_distribution,
    read_orientation,
)


def node(value):
    return document_from({"x": value}).root.get("x")


@pytest.mark.parametrize(
    ("given", "kind", "centre"),
    [
        ({"dist": "normal", "mean": 20, "sd": 2}, "angle", 20.0),
        (
            {"dist": "Normal", "mean": "20 kPa", "sd": "100 Pa", "min": 0, "max": "0.05 MPa"},
            "pressure",
            20.0,
        ),
        ({"dist": "normal", "mean": 20, "sd": 0}, "angle", 20.0),
        ({"dist": "lognormal", "mean": 5, "sd": 5}, "pressure", 5.0),
        ({"dist": "uniform", "min": 10, "max": "30 deg"}, "angle", 20.0),
        ({"dist": "triangular", "min": 0, "mode": 0, "max": 3}, "length", 1.0),
    ],
)
def test_what_a_single_run_takes(given, kind, centre) -> None:
    assert is_distribution(node(given))
    assert read_distribution(node(given), kind, "x").centre == pytest.approx(centre, rel=1e-15)


def test_parameters_are_in_base_units() -> None:
    given = node({"dist": "normal", "mean": "50 Pa", "sd": "0.001 MPa"})
    assert read_distribution(given, "pressure", "c") == Distribution(
        "normal", {"mean": 0.05, "sd": 1.0}, "pressure"
    )


def test_orientations() -> None:
    assert read_orientation(
        node({"dist": "fisher", "mean": "45/115", "k": 100}), "J1"
    ).mean == Plane(45, 115)
    assert read_orientation(
        node({"dist": "fisher", "mean": (45, 115), "k": 100}), "J1"
    ).centre == Plane(45, 115)
    assert read_orientation(
        node({"dist": "fisher", "mean": "000/-05", "k": 9}), "bolt", "line"
    ).mean == Line(0, -5)


# codes, mapping, first line of the first
NUMBERS = [
    (
        ("E105",),
        {"dist": "normal", "mean": "nan", "sd": 2},
        "mean of phi is nan, not a finite number",
    ),
    (("E106",), {"dist": "normal", "mean": "x", "sd": 2}, "mean of phi is 'x', a number is needed"),
    (("E106",), {"dist": "normal", "mean": {"a": 1}, "sd": 2}, "mean of phi is 'a group of keys'"),
    (("E107",), {"dist": "normal", "mean": "20 kPa", "sd": 2}, "not an angle"),
    (("E108",), {"dist": "normal", "mean": "20 grad", "sd": 2}, "unknown unit 'grad'"),
    (
        ("E165",),
        {"dist": "nromal", "mean": 20, "sd": 2},
        "the distribution of phi is 'nromal', which is not known",
    ),
    (("E165",), {"dist": ["normal"]}, "the distribution of phi is not named"),
    (("E165",), {"dist": "normal", "mean": 20}, "sd of phi is missing, normal needs mean, sd"),
    (
        ("E165", "E165"),
        {"dist": "uniform", "min": None},
        "min of phi is missing, uniform needs min, max",
    ),
    (("E165",), {"dist": "uniform", "min": 1, "max": 2, "mean": 1.5}, "uniform has no mean (phi)"),
    (("E165", "E165"), {"dist": "normal", "mean": 1, "std": 2}, "normal has no std (phi)"),
    (
        ("E186",),
        {"dist": "normal", "mean": 20, "sd": -2},
        "sd of phi is -2°, a standard deviation is never negative",
    ),
    (
        ("E186",),
        {"dist": "uniform", "min": 30, "max": 10},
        "min of phi is 30, it must be less than max, 10",
    ),
    (
        ("E186",),
        {"dist": "normal", "mean": 5, "sd": 1, "min": 5, "max": 5},
        "min of phi is 5, it must be less",
    ),
    (
        ("E186",),
        {"dist": "normal", "mean": 40, "sd": 2, "min": 10, "max": 30},
        "mean of phi is 40, beyond its max, 30",
    ),
    (
        ("E186",),
        {"dist": "triangular", "min": 10, "mode": 5, "max": 30},
        "mode of phi is 5, below its min, 10",
    ),
    (
        ("E186",),
        {"dist": "lognormal", "mean": 0, "sd": 2},
        "mean of phi is 0, a lognormal value is always more than 0",
    ),
    (
        ("E165",),
        {"dist": "fisher", "mean": "45/115", "k": 9},
        "phi is a number, fisher is for orientations",
    ),
    (
        ("E165", "E186", "E186"),
        {"dist": "normal", "mean": 1, "sd": -1, "min": 2, "max": 1, "k": 1},
        "normal has no k",
    ),
]
ORIENTATIONS = [
    (("E101",), {"dist": "fisher", "mean": "95/115", "k": 9}, "dip of mean of J1 is 95"),
    (("E104",), {"dist": "fisher", "mean": "N25E", "k": 9}, "mean of J1 is 'N25E'"),
    (("E106",), {"dist": "fisher", "mean": "45/115", "k": "x"}, "k of J1 is 'x'"),
    (("E165",), {"dist": "fischer", "mean": "45/115"}, "is 'fischer', which is not known"),
    (("E165",), {"dist": "fisher", "mean": "45/115"}, "k of J1 is missing, fisher needs mean, k"),
    (("E165",), {"dist": "fisher", "mean": "45/115", "k": 9, "sd": 1}, "fisher has no sd (J1)"),
    (
        ("E165",),
        {"dist": "fisher", "mean": "45/115", "k": 0},
        "k of J1 is 0, it must be more than 0",
    ),
    (
        ("E165",),
        {"dist": "normal", "mean": 4, "sd": 1},
        "J1 is an orientation, normal is for numbers",
    ),
]


@pytest.mark.parametrize(("codes", "given", "says"), NUMBERS, ids=lambda value: str(value)[:40])
def test_numbers_that_cannot_be(codes, given, says) -> None:
    with pytest.raises(DesignError) as caught:
        read_distribution(node(given), "angle", "phi")
    assert caught.value.codes == codes
    assert says in caught.value.faults[0].message
    assert caught.value.faults[0].where.startswith("design: x")


@pytest.mark.parametrize(
    ("codes", "given", "says"), ORIENTATIONS, ids=lambda value: str(value)[:40]
)
def test_orientations_that_cannot_be(codes, given, says) -> None:
    with pytest.raises(DesignError) as caught:
        read_orientation(node(given), "J1")
    assert caught.value.codes == codes
    assert says in caught.value.faults[0].message


def test_a_line_that_cannot_be() -> None:
    with pytest.raises(DesignError) as caught:
        read_orientation(node({"dist": "fisher", "mean": "180/100", "k": 9}), "bolt", "line")
    assert caught.value.codes == ("E165",)


def test_advice_names_the_nearest() -> None:
    for given, advice in (
        ({"dist": "nromal"}, "Did you mean normal?"),
        ({"dist": "weibull"}, "Known: normal, lognormal, uniform, triangular, fisher."),
        ({"dist": "normal", "mean": 1, "sd": 1, "maxi": 2}, "Did you mean max?"),
        ({"dist": "normal", "mean": 1, "sd": 1, "mode": 2}, "A mode belongs to {dist: triangular"),
    ):
        with pytest.raises(DesignError) as caught:
            read_distribution(node(given), "angle", "phi")
        assert advice in caught.value.faults[0].advice


# -- orientations by their angles -------------------------------------------------------------------------------------

DIP = {"dist": "normal", "mean": 45, "sd": 3}


def test_an_orientation_by_its_angles() -> None:
    both = read_angles(
        node({"dip": DIP, "dip_direction": {"dist": "uniform", "min": 350, "max": 380}}), "J1"
    )
    assert both.centre == Plane(45.0, 5.0)
    one = read_angles(node({"dip": DIP, "dip_direction": "0.5 rad"}), "J1")
    assert one == Angles(
        "plane", Distribution("normal", {"mean": 45.0, "sd": 3.0}, "angle"), 28.64788975654116
    )
    line = read_angles(node({"trend": 10, "plunge": DIP}), "bolt", "line")
    assert line.centre == Line(10.0, 45.0)


@pytest.mark.parametrize(
    ("codes", "given", "says"),
    [
        (
            ("E106",),
            {"dip": "steep", "dip_direction": 5},
            "dip of J1 is 'steep', a number is needed",
        ),
        (("E107",), {"dip": "45 m", "dip_direction": 5}, "dip of J1 has the unit m"),
        (
            ("E186",),
            {"dip": {"dist": "normal", "mean": 4, "sd": -1}, "dip_direction": 5},
            "sd of dip of J1 is -1",
        ),
        (
            ("E165",),
            {"dip": {"dist": "fisher", "mean": 4, "k": 9}, "dip_direction": 5},
            "dip of J1 is a number",
        ),
        (("E106", "E106"), {"dip": "a", "dip_direction": "b"}, "dip of J1 is 'a'"),
        ((), {"dip": 45}, ""),  # the checker of keys says what is missing
    ],
)
def test_angles_that_cannot_be(codes, given, says) -> None:
    with pytest.raises(DesignError) as caught:
        read_angles(node(given), "J1")
    assert caught.value.codes == codes
    assert not says or says in caught.value.faults[0].message


def test_columns_and_coordinates() -> None:
    """An orientation has two columns whatever of it scatters; only what scatters can be correlated."""
    dip = Distribution("normal", {"mean": 45.0, "sd": 3.0}, "angle")
    columns = ("J.dip", "J.dip_direction")
    assert (
        Variable("J", Fisher(Plane(45, 115), 9)).columns
        == Variable("J", Angles("plane", dip, 5.0)).columns
        == columns
    )
    assert Variable("J", Fisher(Plane(45, 115), 9)).coordinates == columns
    assert Variable("J", Angles("plane", dip, 5.0)).coordinates == ("J.dip",)
    assert Variable("J", Angles("plane", 5.0, dip)).coordinates == ("J.dip_direction",)
    assert Variable("L", Fisher(Line(45, 15), 9)).columns == ("L.trend", "L.plunge")
    assert Variable("L", Fisher(Line(45, 15), 9)).coordinates == ("L.plunge", "L.trend")
    assert Variable("x", dip).columns == Variable("x", dip).coordinates == ("x",)
