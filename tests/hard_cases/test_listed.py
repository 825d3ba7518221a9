"""METHOD.md §7, line by line: cases that prototypes failed on. Each gives the exact number, or says why it does not."""

import math

import pytest

import slopekit as sk
from tests.hard_cases import exact
from tests.hard_cases.cases import (
    PAPER,
    STEEP,
    WYLLIE,
    Case,
    bench,
    columns,
    footing,
    plane,
    stack,
    wedge,
)
from tests.hard_cases.catalogue import apart, beneath_the_face, pulled
from tests.hard_cases.sweeps import PASSES, ROUNDING, SECTION, SPACE, Sweep, point, verdict

FAR = {"origin": (5e5, 4e6, 1e3)}

#: Joints, size and strength of one wedge after the other; the exact answer is that of the same numbers.
WEDGES: dict[str, Case] = {
    "joints 0.2° apart": apart(0.2),
    "joints 0.02° apart (at 45 m of height 48 km long, 10 m wide)": apart(0.02),
    "joints 0.02° apart, no cohesion": apart(0.02, 0.0),
    "joints 0.002° apart": apart(0.002),
    "plunge 0.1° below the face": beneath_the_face(0.1),
    "plunge 0.01° below the face": beneath_the_face(0.01),
    "plunge 0.001° below the face": beneath_the_face(0.001),
    "3° wedge": wedge(dips=((3, 100), (3, 260))),
    "0.05° wedge": wedge(dips=((0.05, 100), (0.05, 260))),
    "89° wedge": wedge(dips=((89.3, 120), (89.3, 240)), face=(89.5, 180), upper=(5, 180)),
    "89.95° wedge": wedge(dips=((89.949, 120), (89.949, 240)), face=(89.98, 180), upper=(5, 180)),
    "vertical face": wedge(face=(90, 180)),
    "one plane nearly unloaded": wedge(dips=((40, 160), (80, 250)), face=(65, 180)),
    "one plane unloaded": wedge(dips=((40, 160), (80, 235)), face=(65, 180)),
    "contact lost on one plane": wedge(WYLLIE, water=(98.1, 98.1)),
    "contact lost on both planes": wedge(WYLLIE, water=(180.0, 180.0)),
    "water four times what floats it": wedge(PAPER, water=(1500.0, 1500.0)),
    "pulled so hard that sliding reverses": pulled(0.8),
    "no friction": wedge(PAPER, phi=0),
    "no cohesion": wedge(PAPER, c=0),
    "no strength": wedge(PAPER, c=0, phi=0),
    "friction of 89°": wedge(PAPER, phi=89),
    "1 mm": wedge(PAPER, c=0, height=1e-3),
    "100 km": wedge(PAPER, c=0, height=1e5),
    "upper slope dips into the hill": wedge(upper=(10, 0)),
    "upper slope dips along the strike": wedge(PAPER, upper=(20, 90)),
    "map coordinates": wedge(PAPER, 4e6),
    "earthquake that lifts": wedge(STEEP, seismic=(1.5, 180.0)),
}


def assert_sound(case: Case, tolerance=ROUNDING, statuses=()) -> None:
    """Within the tolerance, or below the forces alone where moments govern; nothing else."""
    sweep = Sweep("", "", lambda _: case, (0.0, 1.0), tolerance, "", statuses=statuses)
    found = point(case)
    assert verdict(sweep, found) in ("agrees", "moments govern"), found


@pytest.mark.parametrize("name", WEDGES)
def test_wedges(name) -> None:
    """Against 50 digits, to 1e-9: seven of sixteen digits go to the condition of the thinnest."""
    assert_sound(WEDGES[name], statuses=("rotates",))


@pytest.mark.parametrize(
    "change",
    [
        {"bolts": "3e6@000/-20"},
        {"bolts": "5e6@000/-10"},
        {"crack": "85/180@0.01", "face": "60/180", "upper": "10/180"},
        {"crack": "85/180@0.01", "water": "full"},
        {"bolts": "3e6@000/-20,passive"},
        FAR,
    ],
    ids=str,
)
def test_what_the_reference_leaves_out_agrees_with_the_closed_form(change) -> None:
    """Bolts that reverse the sliding and cracks just behind the crest: the two methods share no line."""
    result = sk.wedge(dips=("45/115", "45/245"), **change)
    assert result.comparisons.forces_only == pytest.approx(result.fos.closed_form, rel=1e-9)
    assert result.agree
    if result.moments_govern:
        assert (result.fos.limit or 0.0) < result.fos.closed_form
    else:
        assert result.fos.limit == pytest.approx(result.fos.closed_form, rel=1e-9)
    assert result.fos.static_bound is None or result.fos.limit <= result.fos.static_bound * (
        1 + 1e-7
    )


@pytest.mark.parametrize("gap", [1e-6, 1e-8])
def test_a_sheet_far_thinner_than_any_joint_still_has_its_number(gap) -> None:
    """Plunge 1e-8° below the face, 10 m high and a nanometre thick: eight digits of its shape go in the corners."""
    found = point(beneath_the_face(gap))
    assert found.refused == ""
    assert found.error < 1e-13 / gap


def test_map_coordinates_come_back_to_the_last_digit() -> None:
    near, far = sk.wedge(**WYLLIE), sk.wedge(**WYLLIE, **FAR)
    assert far.fos == near.fos
    assert far.geometry.volume_m3 == near.geometry.volume_m3
    corner = far.to_dict()["geometry"]["corners_m"]["toe"]
    assert corner == [5e5, 4e6, 1e3]


def test_water_up_to_and_past_the_loss_of_contact() -> None:
    """METHOD.md §3: 0.44458 for 0.44459, 0.8082 for 0.8083, 0.22290 for 0.22290 in a prototype; here exact."""
    mean = 1.5 * 9.81 * 40.0 / 6.0
    for u in (mean * 0.5, mean, (0.0, mean)):
        water = u if isinstance(u, tuple) else (u, u)
        assert_sound(wedge(WYLLIE, water=water), PASSES)
    lost = point(wedge(WYLLIE, water=(mean, mean)))
    assert lost.forces_only == pytest.approx(0.44458819909110614, rel=1e-5)
    assert 0.9 * lost.forces_only < lost.limit < lost.forces_only


@pytest.mark.parametrize("ratio", [1, 1e3, 1e6])
def test_agreement_does_not_depend_on_the_joint_stiffness(ratio) -> None:
    assert_sound(wedge(PAPER, normal_stiffness=1e7, shear_stiffness=1e7 / ratio))


@pytest.mark.parametrize("refine", [0, 1, 2, 3])
def test_the_mesh_does_not_matter_for_a_wedge_that_opens(refine) -> None:
    """The bed has the exact polygons; 1,500 separate springs a joint: 0.7050 to 0.7056."""
    result = sk.wedge(
        dips=("45/105", "70/235"), face="65/185", upper="12/195", water=(290, 0), refine=refine
    )
    assert result.comparisons.forces_only == pytest.approx(0.8803428271540841, rel=1e-9)
    assert result.comparisons.forces_only == pytest.approx(result.fos.closed_form, rel=1e-9)
    assert result.fos.limit == pytest.approx(0.7050040977, rel=1e-8)


def test_where_the_bed_holds_more_the_forces_alone_govern() -> None:
    """One plane unloaded: Hoek & Bray 1.538, on the bed 1.578 (separate springs 1.5776 to 1.5789)."""
    single = {
        "dips": ("40/160", "80/220"),
        "face": "65/180",
        "upper": "0/180",
        "height": 10,
        "c": 20,
        "phi": 30,
    }
    result = sk.wedge(**single, unit_weight=26)
    assert not result.moments_govern
    assert result.agree
    assert result.status == "slides_on_J1"
    assert result.fos.limit == pytest.approx(1.5377593, rel=1e-6)
    assert "W312" not in [notice.code for notice in result.warnings]


# -- the other kinds -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "case",
    [
        plane(dip=59.999),
        plane(upper=34.999),
        plane(face=89.9995, dip=89.999),
        plane(height=1e-3, c=0.0),
        plane(height=1e5, c=0.0),
        plane(pressure=80.0),
        plane(c=0.0, phi=0.0),
        plane(force=(-2000.0, 0.0)),
        footing(dip=89.9),
        footing(dip=0.01),
        footing(load=1e8),
        footing(c=0.0, phi=0.0),
    ],
)
def test_planes_and_footings(case) -> None:
    """Closed forms of one plane, to 1e-9."""
    assert_sound(case)


@pytest.mark.parametrize(
    ("case", "statuses"),
    [
        (stack(dip=0.0), ()),
        (stack(c=0.0, phi=0.0), ("falls",)),
        (stack(dip=40.0, phi=89.0), ()),
        (stack(30, 1, 30, many=6, shift=4e6), ()),
        (stack(c=3.0, pressure=30.0), ()),
        (columns(size=1e-3), ()),
        (stack(1, 2, math.degrees(math.atan(0.5)) + 0.1), ()),
        (stack(1, 2, math.degrees(math.atan(0.5)) - 0.1), ()),
    ],
)
def test_blocks_on_inclines(case, statuses) -> None:
    """A block on a horizontal plane, one without strength, and its centre of gravity on either side of its edge."""
    assert_sound(case, SECTION, statuses)


def test_centre_of_gravity_exactly_above_an_edge_is_a_status_either_way() -> None:
    """At tan β = b/h the exact number is that of sliding, a hair beyond there is none."""
    found = point(stack(1.0, 2.0, math.degrees(math.atan(0.5)), phi=50.0))
    assert found.status in ("slides", "topples", "not_converged")
    if found.limit is not None:
        sliding = exact.tangent(50) / exact.tangent(math.degrees(math.atan(0.5)))
        assert found.limit == pytest.approx(float(sliding), rel=SECTION[0])


def test_a_block_on_ground_that_hardly_dips_has_no_driving_force() -> None:
    """At 1e-9° F is 4e10: what drives is less than a millionth of the strength, and the status says so."""
    found = point(stack(dip=1e-9))
    assert (found.status, found.limit) == ("no_driving_force", None)
    assert found.exact > 1e10


@pytest.mark.parametrize("offset", [1e-12, 1e-6])
def test_duplicate_planes_are_one(offset) -> None:
    """A fourth set a hair from the first: merged, the same factor."""
    double = bench(
        more={"S4": {"plane": [45, 170], "spacing": 9.0, "offset": offset, "strength": "joint"}}
    )
    found = point(double)
    assert found.limit == pytest.approx(found.exact, rel=SPACE[0])


def test_the_same_set_twice_is_refused() -> None:
    double = bench(
        more={"S4": {"plane": [45, 170], "spacing": 9.0, "offset": 0.0, "strength": "joint"}}
    )
    assert point(double).refused == "E151"


@pytest.mark.parametrize("shift", [0.0, 4e6])
def test_planes_through_one_vertex(shift) -> None:
    """All three sets pass through the toe, mid-length: eight blocks share that point."""
    found = point(bench(spacings=(7.0, 10.0, 10.0), offsets=(0.0, 0.0, 0.0), shift=shift))
    assert found.limit == pytest.approx(found.exact, rel=SPACE[0])
    assert found.status == "slides"


@pytest.mark.parametrize("size", [1e-3, 1e5])
def test_how_columns_fail_does_not_depend_on_their_size(size) -> None:
    """Without cohesion nothing has a length: the status, and how each column moves, are those at size 1."""
    one, other = (sk.run(columns(size=s).design) for s in (1.0, size))
    assert other.status == one.status
    ways = [
        dict(zip(r.findings.first.blocks, r.findings.first.how, strict=True)) for r in (one, other)
    ]
    assert ways[0] == ways[1]


# -- the reference itself, against what is in print -------------------------------------------------------------


def test_the_reference_gives_published_numbers() -> None:
    """Sheng et al. 2023 (1.5574 at g = 9.81); Wyllie & Mah 2004, plane; Goodman & Bray 1976; Hungr et al. 1989."""
    assert float(exact.wedge(**PAPER).factor) == pytest.approx(1.5574, abs=5e-5)
    assert float(exact.wedge(**{**PAPER, "unit_weight": 25.588}).factor) == pytest.approx(
        1.556, abs=5e-4
    )
    cracked = exact.plane_failure(60, 35, 12, 25, 37, 26, crack_depth=4.35, water_depth=3)
    assert float(cracked.factor) == pytest.approx(1.25, abs=5e-3)
    assert float(columns().answer().factor) == pytest.approx(1.0, abs=1e-3)
    assert float(
        exact.sphere_without_friction(10, 5, math.degrees(math.atan(0.5)), 20, 20).factor
    ) == pytest.approx(1.4016, abs=5e-5)
    assert float(exact.footing(1500, 45, 5 * math.sqrt(2), 200, 0).factor) == pytest.approx(
        4 / 3, rel=1e-12
    )
