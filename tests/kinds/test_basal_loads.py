"""Water tables, surcharge and bolts on a wedge with a basal joint: what holds of two joints holds of three."""

import numpy as np
import pytest

import slopekit as sk
from slopekit.kinds.wedge import bounds, shape_of
from tests.kinds.test_basal import TROUGH, put

FILE = "templates/wedge-basal.yaml"


@pytest.mark.parametrize(
    "water",
    [
        {"water.mode": "table", "water.depth": "3 m", "loads.surcharge": "20 kPa"},
        {"water.mode": "table", "water.plane": "10/180@4m", "water.pond": "6 m"},
    ],
)
def test_both_methods_get_the_same_water(water) -> None:
    wet, dry = sk.run(FILE, set=water), sk.run(FILE)
    assert wet.difference == pytest.approx(0.0, abs=1e-9)
    assert wet.agree
    assert wet.fos.closed_form != pytest.approx(dry.fos.closed_form, abs=1e-6)


def test_a_drowned_block_has_its_weight_in_water() -> None:
    """A pond over all of the block bears its share of the weight, as Archimedes says: without cohesion F is as dry."""
    no_cohesion = {"strength.bedding.c": 0, "crack": None}
    drowned = sk.run(FILE, set=no_cohesion | {"water.mode": "table", "water.pond": "60 m"})
    dry = sk.run(FILE, set=no_cohesion)
    assert drowned.fos.closed_form == pytest.approx(dry.fos.closed_form, rel=1e-9)
    assert drowned.fos.limit == pytest.approx(dry.fos.limit, rel=1e-8)


def test_the_bounds_of_bolts_are_the_faces_of_the_block() -> None:
    design = sk.load(FILE)
    found, block = bounds(design), shape_of(design).block
    over = found.outward[:, 0] @ block.corners.T - found.offsets
    assert over.max() < 1e-9
    assert np.abs(over).min(axis=1) == pytest.approx(
        0.0, abs=1e-9
    )  # each plane has a corner of the block


STEEP = {
    "basal__plane": "45/262",
    "basal__height": 1,
    "joints__J1__plane": "60/100",
    "joints__J2__plane": "60/250",
}


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"basal__plane": "75/100", "basal__height": 25, "joints__J1__plane": "45/115"}, "E440"),
        ({"basal__plane": "35/45", "basal__height": 25, "joints__J1__plane": "60/100"}, "E442"),
        ({"basal__plane": "28/262", "basal__height": 6, "joints__J2__plane": "60/270"}, "E440"),
        (
            {
                "basal__plane": "60/100",
                "joints__J1__plane": "60/100",
                "joints__J2__plane": "78/262",
            },
            "E440",
        ),
        ({"basal__height": 1e9}, "E447"),
    ],
)
def test_what_cuts_no_block_has_a_code(change, code) -> None:
    change = {"joints__J2__plane": "60/250"} | change
    with pytest.raises(sk.SlopekitError) as caught:
        sk.run(put(TROUGH, **change))
    assert caught.value.codes == (code,)


@pytest.mark.parametrize(
    ("change", "code"),
    [(STEEP, "W410"), ({"basal__plane": "2/225", "basal__height": -8}, "W410")],
)
def test_what_a_reader_must_know_of_a_basal_joint(change, code) -> None:
    assert code in {notice.code for notice in sk.run(put(TROUGH, **change)).warnings}
