"""The numbers of a design: every key that is listed can be written back, and wrong ones name the nearest."""

import pytest

import slopekit as sk
from slopekit.design.reading.files import load, with_values
from slopekit.design.templates import names, path_of
from slopekit.studies.keys import key_of, keys_of, values_of
from slopekit.studies.ranges import parse_values, parse_within
from slopekit.studies.sweep import sweep

WEDGE = {
    "slopekit": 1,
    "kind": "wedge",
    "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
}


@pytest.mark.slow
@pytest.mark.parametrize("name", names())
def test_every_key_of_a_template_takes_its_own_value(name) -> None:
    """Writing the present value back leaves the design as it is, but for what two keys say of one thing."""
    design = load(path_of(name))
    keys = keys_of(design)
    assert len({key.path for key in keys}) == len(keys) >= 15
    for key in keys:
        if key.value is None:
            continue
        assert key.low <= key.value <= key.high or key.value == 0.0, key
        again = with_values(design, values_of(design, [key], [key.value]))
        if key.given:
            assert again.input_hash() == design.input_hash(), key.path


def test_keys_have_their_units_and_ranges() -> None:
    design = load(
        path_of("wedge"),
        [("support.bolts", '["200 kN@000/10"]'), ("crack", "{plane: 80/180, distance: 5}")],
    )
    wanted = {
        "strength.weak.phi": (20.0, "°", 0.0, 89.99),
        "strength.weak.c": (50.0, "kPa", 0.0, 1e5),
        "slope.height": (64.89, "m", 1e-3, 1e5),
        "slope.face.dip": (60.0, "°", 0.0, 90.0),
        "joints.J2.plane.dip_direction": (245.0, "°", 0.0, 360.0),
        "water.fill": (0.0, "", 0.0, 1.0),
        "loads.seismic.k": (0.0, "", 0.0, 2.0),
        "support.bolts.0.force": (200.0, "kN", 1e-6, 1e9),
        "support.bolts.0.toward.plunge": (10.0, "°", -90.0, 90.0),
        "rock.density": (2600.0, "kg/m³", 500.0, 1e4),
        "water.pressures.J1": (0.0, "kPa", 0.0, 1e5),
        "crack.distance": (5.0, "m", 1e-3, 1e5),
    }
    for path, expected in wanted.items():
        key = key_of(design, path)
        assert (key.value, key.unit, key.low, key.high) == expected, path


@pytest.mark.parametrize(
    ("given", "code", "says"),
    [
        ("phi", "E310", "Did you mean strength.weak.phi?"),
        ("strength.weka.phi", "E310", "Did you mean strength.weak.phi?"),
        ("slope.hieght", "E310", "Did you mean slope.height?"),
        ("cohesion", "E310", "Did you mean strength.weak.c?"),
        ("strength.wek.friction", "E310", "Did you mean strength.weak.phi?"),
        ("dip", "E310", "Did you mean one of slope.face.dip, slope.upper.dip, joints.J1.plane.dip"),
        ("support.bolts.0.force", "E310", "It has no bolts"),
        ("", "E310", "There are slope.face.dip"),
        ("slope.face", "E311", "Name one of slope.face.dip, slope.face.dip_direction."),
        ("strength.weak", "E311", "Name one of strength.weak.c"),
        ("title", "E311", "the text"),
        ("support.bolts", "E311", "a list of 0"),
    ],
)
def test_keys_that_are_none_name_the_nearest(given, code, says) -> None:
    with pytest.raises(sk.DesignError) as caught:
        key_of(load(path_of("wedge")), given)
    assert caught.value.codes == (code,)
    assert says in str(caught.value)


@pytest.mark.parametrize(
    ("word", "path"),
    [
        ("strength.weak.cohesion", "strength.weak.c"),
        ("strength.weak.friction_angle", "strength.weak.phi"),
        ("rock.gamma", "rock.unit_weight"),
        ("loads.kh", "loads.seismic.k"),
        ("joints.J1.plane.dipdir", "joints.J1.plane.dip_direction"),
    ],
)
def test_keys_are_read_by_what_engineers_call_them(word, path) -> None:
    assert key_of(load(path_of("wedge")), word) == key_of(load(path_of("wedge")), path)


def test_a_seismic_load_has_one_number_that_is_meant() -> None:
    for said in ({"loads": {"seismic": "0.1@170"}}, {"loads": {"seismic": {"k": 0.1}}}, {}):
        assert key_of(load(WEDGE | said), "loads.seismic").path == "loads.seismic.k"
    assert (
        key_of(load(WEDGE | {"loads": {"seismic": "0.1@170"}}), "loads.seismic.toward").value
        == 170.0
    )


def test_defaults_are_written_out_before_they_are_changed() -> None:
    """A wedge that names no face, no height and no strength takes the paper's."""
    design = load(WEDGE)
    for path, attribute in (("slope.face.dip", "face"), ("slope.upper.dip_direction", "upper")):
        key = key_of(design, path)
        assert not key.given
        changed = with_values(design, values_of(design, [key], [key.value + 1.0]))
        assert getattr(changed, attribute) != getattr(design, attribute)
        assert changed.height_m == design.height_m
    key = key_of(design, "strength.joints.phi")
    changed = with_values(design, values_of(design, [key], [25.0]))
    assert (changed.friction_angle_deg, changed.cohesion_kpa) == ((25.0, 25.0), design.cohesion_kpa)
    both = [key_of(design, "slope.face.dip"), key_of(design, "slope.face.dip_direction")]
    assert str(with_values(design, values_of(design, both, [70.0, 170.0])).face) == "70/170"


def test_what_scatters_has_its_own_numbers() -> None:
    scatters = {"weak": {"c": 50, "phi": {"dist": "normal", "mean": 20, "sd": 2, "min": 10}}}
    plane = {"dist": "fisher", "mean": "45/115", "k": 100}
    design = load(
        {
            **WEDGE,
            "strength": scatters,
            "joints": {
                "J1": {"plane": plane, "strength": "weak"},
                "J2": {"plane": "45/245", "strength": "weak"},
            },
            "correlation": {"J1.phi/joints.J1.plane.dip": 0.2},
        }
    )
    keys = {key.path: key for key in keys_of(design)}
    assert keys["strength.weak.phi"].scatters is not None
    assert [keys[f"strength.weak.phi.{name}"].value for name in ("mean", "sd", "min")] == [
        20.0,
        2.0,
        10.0,
    ]
    assert (keys["joints.J1.plane.mean.dip"].value, keys["joints.J1.plane.k"].value) == (
        45.0,
        100.0,
    )
    # a number in its place scatters no longer: the correlation that names it is left out with it
    changed = with_values(design, values_of(design, [keys["strength.weak.phi"]], [25.0]))
    assert changed.friction_angle_deg == (25.0, 25.0)
    assert changed.correlation == ()
    moved = with_values(design, values_of(design, [keys["strength.weak.phi.mean"]], [21.0]))
    assert len(moved.correlation) == 1


def test_directions_go_round() -> None:
    key = key_of(load(WEDGE | {"slope": {"face": "60/010"}}), "slope.face.dip_direction")
    assert parse_within(key, None) == (-170.0, 190.0)
    assert key.written(-20.0) == "340.0"
    assert key.distance(350.0, 10.0) == 20.0
    assert key.value_text(-20.0) == "340°"


@pytest.mark.parametrize(
    ("given", "values"),
    [
        ("60:80:5", (60.0, 65.0, 70.0, 75.0, 80.0)),
        ("60, 70,80 deg", None),
        ("60°,70 deg", (60.0, 70.0)),
        ("0:0.3:4", (0.0, 0.1, 0.2, 0.3)),
        ("80:60:3", (80.0, 70.0, 60.0)),
        ("60:80:+5", (60.0, 65.0, 70.0, 75.0, 80.0)),
        ("60:80:+7", (60.0, 67.0, 74.0)),
        ("80:60:-10", (80.0, 70.0, 60.0)),
        ("60°:61°:+0.5 deg", (60.0, 60.5, 61.0)),
        ("60:70:+5°", None),
        ("0:1:+0.1", (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)),
        ([60, "70"], (60.0, 70.0)),
        (60, (60.0,)),
    ],
)
def test_values_as_users_write_them(given, values) -> None:
    key = key_of(load(WEDGE), "slope.face.dip")
    if values is None:
        with pytest.raises(sk.DesignError) as caught:
            parse_values(key, given)
        assert caught.value.codes == ("E312",)
        assert "some values carry a unit" in str(caught.value)
    else:
        assert parse_values(key, given) == values


@pytest.mark.parametrize(
    ("given", "code"),
    [
        ("60:80", "E312"),
        ("60:80:1", "E312"),
        ("60:80:x", "E312"),
        ("60:60:3", "E312"),
        ("60,60", "E312"),
        ([], "E312"),
        ("", "E106"),
        ("60,x", "E106"),
        ("10m:20m:3", "E107"),
        ("60:80:1000000", "E312"),
        ("::", "E312"),
        ("60-80", "E312"),
        ("60..80", "E312"),
        ("60 to 80", "E312"),
    ],
)
def test_values_that_are_none(given, code) -> None:
    with pytest.raises(sk.DesignError) as caught:
        sweep(load(WEDGE), {"slope.face.dip": given})
    assert caught.value.codes == (code,)


@pytest.mark.parametrize(
    ("given", "code"),
    [
        ("10", "E312"),
        ("10:20:3", "E312"),
        ("20:10", "E312"),
        ("10:20ft", "E312"),
        ("10kPa:20kPa", "E107"),
        (":", "E312"),
        ((1, 2, 3), "E312"),
    ],
)
def test_ranges_that_are_none(given, code) -> None:
    with pytest.raises(sk.DesignError) as caught:
        parse_within(key_of(load(WEDGE), "slope.height"), given)
    assert caught.value.codes == (code,)


def test_a_design_without_a_file_has_no_keys() -> None:
    design = sk.wedge(dips=("45/115", "45/245")).design
    with pytest.raises(sk.DesignError) as caught:
        keys_of(design)
    assert caught.value.codes == ("E280",)


def test_a_range_of_directions_across_north_goes_the_short_way() -> None:
    """350:10 is 20° wide, in a sweep, a solve, a tornado and in a distribution, by file and by key."""
    design = sk.load(
        {
            "slopekit": 1,
            "kind": "wedge",
            "slope": {"face": "65/350", "upper": "12/000"},
            "joints": {"J1": {"plane": "45/060"}, "J2": {"plane": "50/290"}},
        }
    )
    key = "slope.face.dip_direction"
    swept = sk.sweep(design, {key: "350:10:5"}, closed_form=True)
    assert swept.values[0] == (350.0, 355.0, 360.0, 365.0, 370.0)
    assert [point.code for point in swept.points] == [""] * 5
    bar = next(
        bar
        for bar in sk.tornado(design, {key: "350:10"}, closed_form=True).bars
        if bar.key.path == key
    )
    assert (bar.low, bar.high) == (350.0, 370.0)


@pytest.mark.parametrize(
    "shape",
    [
        {"dist": "uniform", "min": 350, "max": 10},
        {"dist": "triangular", "min": 350, "mode": 355, "max": 10},
    ],
)
def test_a_distribution_of_directions_across_north(shape) -> None:
    """No direction is drawn outside the 20° between 350 and 10; the run takes one of them."""
    design = sk.load(
        {
            "slopekit": 1,
            "kind": "wedge",
            "slope": {"face": "65/355", "upper": "12/000"},
            "joints": {
                "J1": {"plane": {"dip": 45, "dip_direction": shape}},
                "J2": {"plane": "50/290"},
            },
        }
    )
    drawn = sk.prob(design, 200, by="closed-form")
    directions = drawn.samples.values[:, drawn.samples.names.index("joints.J1.plane.dip_direction")]
    off = (directions + 180.0) % 360.0 - 180.0
    assert -10.0 <= off.min() < -5.0
    assert 5.0 < off.max() <= 10.0
    centre = design.joints[0].dip_direction_deg
    assert min(centre, 360.0 - centre) <= 10.0
    ends = next(
        bar
        for bar in sk.tornado(design, closed_form=True).bars
        if bar.key.path == "joints.J1.plane.dip_direction"
    )
    assert ends.high - ends.low < 20.0


def test_water_of_a_crack_in_per_cent_is_sent_to_metres() -> None:
    plane = sk.load(path_of("plane"), set={"crack.water": "50 %"})
    with pytest.raises(sk.DesignError) as caught:
        key_of(plane, "crack.water")
    assert (
        caught.value.faults[0].advice
        == "Write it in m or kPa in the design, then a study can change it."
    )
