"""Water tables, surcharge and bolts on a wedge with a basal joint: what holds of two joints holds of three."""

import numpy as np
import pytest

import slopekit as sk
from slopekit.kinds.wedge import basal, bounds

FILE = "templates/wedge-basal.yaml"


@pytest.mark.parametrize(
    "water",
    [
        {"water.mode": "table", "water.depth": "6 m"},
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
    found, block = bounds(design), basal.block_of(design)
    over = found.outward[:, 0] @ block.corners.T - found.offsets
    assert over.max() < 1e-9
    assert np.abs(over).min(axis=1) == pytest.approx(0.0, abs=1e-9)  # each plane has a corner of the block
