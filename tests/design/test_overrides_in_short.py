"""Values put below what a file says in short: `water: dry`, `seismic: 0.1@180`, `200 kN@000/10,passive`."""

import pytest

from slopekit.core.errors import DesignError
from slopekit.design.reading.document import with_overrides
from slopekit.design.reading.files import load, with_values
from slopekit.design.reading.nodes import document_from

WEDGE = {
    "slopekit": 1,
    "kind": "wedge",
    "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": [45, 245]}},
}


@pytest.mark.parametrize(
    ("file", "override", "plain"),
    [
        ({"water": "dry"}, ("water.fill", "0.5"), {"water": {"fill": "0.5"}}),
        ({"water": "full"}, ("water.fill", "0.5"), {"water": {"fill": "0.5"}}),
        (
            {"water": "full"},
            ("water.unit_weight", "9.9"),
            {"water": {"mode": "full", "unit_weight": "9.9"}},
        ),
        (
            {"water": "50 %"},
            ("water.unit_weight", "9.9"),
            {"water": {"fill": "50 %", "unit_weight": "9.9"}},
        ),
        (
            {"water": "u=5kPa, 8kPa"},
            ("water.pressures.0", "6"),
            {"water": {"pressures": ["6", "8kPa"]}},
        ),
        ({"water": "dry"}, ("water.pressures.J1", "6"), {"water": {"pressures": {"J1": "6"}}}),
        (
            {"loads": {"seismic": "0.1"}},
            ("loads.seismic.k", "0.2"),
            {"loads": {"seismic": {"k": "0.2"}}},
        ),
        (
            {"loads": {"seismic": "0.1@170"}},
            ("loads.seismic.k", "0.2"),
            {"loads": {"seismic": {"k": "0.2", "toward": "170"}}},
        ),
        ({}, ("loads.seismic.k", "0.2"), {"loads": {"seismic": {"k": "0.2"}}}),
        (
            {"support": {"bolts": ["200 kN@000/10, passive"]}},
            ("support.bolts.0.force", "300"),
            {"support": {"bolts": [{"force": "300", "toward": "000/10", "acts": "passive"}]}},
        ),
        (
            {"support": {"bolts": ["200 kN@000/10"]}},
            ("support.bolts.0.toward.plunge", "5"),
            {"support": {"bolts": [{"force": "200 kN", "toward": "000/5"}]}},
        ),
        (
            {"loads": {"forces": ["5 kN@180/10"]}},
            ("loads.forces.0.force", "6"),
            {"loads": {"forces": [{"force": "6", "toward": "180/10"}]}},
        ),
    ],
)
def test_what_is_in_short_is_written_out(file, override, plain) -> None:
    """Hand-written long forms: the rest of what the file says stays."""
    assert with_overrides(document_from(file), [override]).root.plain() == plain


@pytest.mark.parametrize(
    ("changes", "same"),
    [
        ({"water": "dry"}, {"water.fill": 0.5}),
        ({"loads": {"seismic": 0.1}}, {"loads.seismic.k": 0.2}),
        ({}, {"loads.seismic.k": 0.2}),
        ({"support": {"bolts": ["200 kN@000/10,passive"]}}, {"support.bolts.0.force": 300}),
    ],
)
def test_a_design_takes_them(changes, same) -> None:
    """The same design as one that says so itself."""
    bolt = {"force": 300, "toward": "000/10", "acts": "passive"}
    long = {
        "water.fill": {"water": {"fill": 0.5}},
        "loads.seismic.k": {"loads": {"seismic": {"k": 0.2}}},
        "support.bolts.0.force": {"support": {"bolts": [bolt]}},
    }
    expected = load(WEDGE | long[next(iter(same))])
    assert with_values(load(WEDGE | changes), same).input_hash() == expected.input_hash()


def test_what_an_earlier_set_says_gives_way_to_a_study() -> None:
    """Only what is set in the same call excludes: a study of a design that was loaded with --set water.mode=full."""
    loaded = load(WEDGE, [("water.mode", "full")])
    assert with_values(loaded, {"water.fill": 0.25}).water.fill == 0.25
    assert (
        with_values(
            load(WEDGE, [("rock.density", 2500)]), {"rock.unit_weight": 25}
        ).rock.unit_weight_kn_m3
        == 25.0
    )
    with pytest.raises(DesignError) as caught:
        with_values(loaded, {"rock.density": 2500, "rock.unit_weight": 25})
    assert caught.value.codes == ("E112",)


def test_the_mean_of_an_orientation_that_scatters_has_its_angles() -> None:
    plane = {"dist": "fisher", "mean": "45/115", "k": 100}
    design = load(WEDGE | {"joints": {"J1": {"plane": plane}, "J2": {"plane": [45, 245]}}})
    other = with_values(
        design, {"joints.J1.plane.mean.dip": 50, "joints.J2.plane.dip_direction": 240}
    )
    assert [str(plane) for plane in other.joints] == ["50/115", "45/240"]


def test_what_stands_for_nothing_longer_is_refused_still() -> None:
    for path in ("slope.height.x", "title.x"):
        with pytest.raises(DesignError) as caught:
            with_values(load(WEDGE | {"slope": {"height": "10 m"}, "title": "T"}), {path: 1})
        assert caught.value.codes == ("E160",)


def test_a_strength_that_is_none_of_the_files_is_a_slip() -> None:
    """`--set` makes it a new one, which nothing uses: the advice is the name that is there, not to use it."""
    strength = {"weak": {"c": 0, "phi": 20}}
    with pytest.raises(DesignError) as caught:
        load(WEDGE | {"strength": strength}, (("strength.week.phi", 20), ("strength.week.c", 0)))
    assert [(fault.code, fault.advice) for fault in caught.value.faults] == [
        ("E195", "Did you mean weak?")
    ]
