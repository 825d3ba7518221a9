"""Hundreds of bolts: what a study does not change is read once, and its faults are said every time."""

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.orientation import Line, parse_plane
from slopekit.design import sections
from slopekit.design.reading.files import with_values
from slopekit.kinds.single_block import held_bolts
from slopekit.kinds.wedge import ON_ARRAYS

COUNT = 40


def design_with(**first) -> dict:
    """A wedge with bolts on its face, the first otherwise."""
    rng = np.random.default_rng(3)
    bolts = []
    for _ in range(COUNT):
        z = rng.uniform(2.0, 28.0)
        head = [rng.uniform(-0.6, 0.6) * z, z / np.tan(np.radians(60.0)), z]
        bolts.append(
            {
                "force": 100,
                "toward": f"{rng.uniform(0, 20):.1f}/{rng.uniform(0, 20):.1f}",
                "head": head,
            }
        )
    for k in range(1, COUNT, 2):
        bolts[k]["length"] = 9
    bolts[0] |= first
    return {
        "slopekit": 1,
        "kind": "wedge",
        "slope": {"face": "60/180", "upper": "10/180", "height": 30},
        "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
        "strength": {"s": {"c": 20, "phi": 20}},
        "support": {"bolts": bolts},
    }


@pytest.fixture
def read(monkeypatch) -> list[object]:
    """What `read_bolt` was asked to read."""
    asked, bolt = [], sections.read_bolt

    def noted(reader, node):
        asked.append(node)
        return bolt(reader, node)

    monkeypatch.setattr(sections, "read_bolt", noted)
    return asked


def test_a_bolt_that_is_not_changed_is_not_read_again(read) -> None:
    design = sk.load(design_with())
    assert len(read) == COUNT
    higher = with_values(design, {"slope.height": 31})
    assert (len(read), higher.bolts) == (COUNT, design.bolts)
    stronger = with_values(design, {"support.bolts.7.force": 250})
    assert len(read) == COUNT + 1
    assert [bolt.force_kn for bolt in stronger.bolts] == [
        250.0 if k == 7 else 100.0 for k in range(COUNT)
    ]


@pytest.mark.parametrize(
    ("wrong", "code"),
    [({"force": "-5"}, "E124"), ({"toward": "400/5"}, "E124"), ({"lenght": 5}, "E142")],
)
def test_what_is_wrong_with_one_is_said_every_time(wrong, code) -> None:
    design = sk.load(design_with())
    for _ in range(2):
        with pytest.raises(sk.DesignError) as caught:
            sk.load(design_with(**wrong))
        assert caught.value.codes[0] == code
        with pytest.raises(sk.DesignError) as caught:
            with_values(design, {f"support.bolts.3.{key}": value for key, value in wrong.items()})
        assert caught.value.codes[0] == code


def test_loads_in_words_are_each_their_own() -> None:
    """The keys that a text stands for are nodes of a moment: what one of them says is no other's."""
    forces = [10.0 * k for k in range(1, COUNT)]
    design = design_with() | {
        "support": {"bolts": [f"{force} kN@000/10" for force in forces]},
        "loads": {"forces": [f"{force} kN@180/00" for force in forces], "seismic": "0.1 g@180"},
        "water": "u=5 kPa, 6 kPa",
    }
    for _ in range(3):
        loaded = sk.load(design)
        assert [bolt.force_kn for bolt in loaded.bolts] == forces
        assert [round(-force.components_kn[1], 9) for force in loaded.forces] == forces
        assert (loaded.seismic.coefficient, loaded.seismic.trend_deg) == (0.1, 180.0)
        assert loaded.water.pressures_kpa == (5.0, 6.0)


@pytest.mark.parametrize(
    ("force", "code"),
    [
        ("300 kN@180/10,5", "E106"),
        ("300 kN@180/10,passive", "E108"),
        ("300 kN@180/10 at [0,0,0]", "E108"),
        ({"force": "300 kN@180/10,passive", "at": [0, 1, 2]}, "E108"),
    ],
)
def test_nothing_behind_the_direction_of_a_force_is_passed_over(force, code) -> None:
    """A passive bolt under forces would act at any displacement."""
    with pytest.raises(sk.DesignError) as raised:
        sk.load(design_with() | {"loads": {"forces": [force]}})
    assert [fault.code for fault in raised.value.faults] == [code]


def test_a_force_in_words_may_have_its_place_beside_it() -> None:
    (written,) = sk.load(design_with() | {"loads": {"forces": ["300 kN@180/10"]}}).forces
    (placed,) = sk.load(
        design_with() | {"loads": {"forces": [{"force": "300 kN@180/10", "at": [0, 1, 2]}]}}
    ).forces
    assert placed.components_kn == written.components_kn
    assert (written.at_m, placed.at_m) == (None, (0.0, 1.0, 2.0))


def test_one_that_scatters_scatters_every_time() -> None:
    design = sk.load(design_with(force={"dist": "normal", "mean": 100, "sd": 5}))
    again = with_values(design, {"slope.height": 31})
    assert [variable.path for variable in again.variables] == ["support.bolts.0.force"]


def test_many_stand_as_each_does_alone() -> None:
    """Lines through four blocks, with 1 to 40 bolts at once."""
    design = sk.load(design_with(length=12))
    bounds = ON_ARRAYS.bounds(with_values(design, {"slope.height": 30}))
    moved = [
        ON_ARRAYS.bounds(with_values(design, {"slope.height": height}))
        for height in (22.0, 26.0, 33.0)
    ]
    before = held_bolts.head_offset(bounds, design.bolts)
    for own in (bounds, *moved):
        together = held_bolts.holding_bolts(own, design.bolts, before)
        for k, bolt in enumerate(design.bolts):
            alone = held_bolts.holding_bolts(own, [bolt], held_bolts.head_offset(bounds, [bolt]))
            assert alone[0].tolist() == together[0][k : k + 1].tolist()
            np.testing.assert_allclose(alone[1], together[1][k : k + 1], rtol=1e-12)
    assert 0 < held_bolts.holding_bolts(moved[0], design.bolts, before)[0].sum() < COUNT


def test_each_has_to_reach_behind_its_joint() -> None:
    """Where a line meets J1 and J2, which pass through the toe, by hand: a little shorter is too short (E212)."""
    normals = [parse_plane(plane, "").normal() for plane in ("45/115", "45/245")]
    given = design_with()["support"]["bolts"]
    for bolt in given[::8]:
        head, way = np.array(bolt["head"]), Line(*map(float, bolt["toward"].split("/"))).vector()
        leaves = min(t for normal in normals if (t := -(normal @ head) / (normal @ way)) > 0.0)
        for part, codes in ((1.001, None), (0.999, ("E212",))):
            design = design_with()
            design["support"]["bolts"] = [bolt | {"length": part * leaves}]
            if codes is None:
                sk.run(design)
                continue
            with pytest.raises(sk.GeometryError) as caught:
                sk.run(design)
            assert caught.value.codes == codes
            assert f"sound rock begins after {leaves:.4g} m" in caught.value.faults[0].message
