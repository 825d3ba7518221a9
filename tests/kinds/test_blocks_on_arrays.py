"""Blocks and loads of many designs as arrays: against each cut and loaded by itself."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import slopekit as sk
from benchmarks.batch import blocks_of as blocks_of_cuts
from benchmarks.ordinary_cuts import ordinary_cut
from slopekit.design.common import Design
from slopekit.kinds import cut, kind_of
from slopekit.kinds.plane import PlaneDesign
from slopekit.kinds.single_block.blocks_on_arrays import blocks_of, limits_on_arrays
from slopekit.kinds.wedge.design import wedge_design
from slopekit.preie.batch import Blocks
from slopekit.studies.evaluation.vectorised import vectorised

PLANE: dict[str, Any] = {
    "slopekit": 1,
    "kind": "plane",
    "slope": {"face": "65/170", "upper": "8/175", "height": 14},
    "joints": {"J1": {"plane": "38/185", "strength": "s"}},
    "strength": {"s": {"c": 12, "phi": 33}},
    "rock": {"unit_weight": 26},
}
WEDGE = PLANE | {
    "kind": "wedge",
    "slope": {"face": "65/185", "upper": "12/195", "height": 20},
    "joints": {
        "J1": {"plane": "45/105", "strength": "s"},
        "J2": {"plane": "70/235", "strength": "s"},
    },
}
OF_PLANES: dict[str, dict[str, Any]] = {
    "dry": {},
    "full": {"water": {"fill": 0.7}},
    "crack": {"crack": {"depth": 4}, "water": {"fill": 0.5}},
    "water in the crack": {"crack": {"distance": 2, "water": "2 m"}},
    "pressure": {"water": {"pressures": {"J1": 15}}, "loads": {"seismic": {"k": 0.1}}},
    "trend": {"loads": {"seismic": {"k": 0.1, "toward": 200}}},
    "forces": {
        "loads": {"forces": [{"force": 90, "toward": "180/20", "at": [0, 2, 9]}]},
        "support": {
            "bolts": [{"force": 100, "toward": "000/10", "head": [0, 2.3, 5], "length": 30}]
        },
    },
}

CUT_OFF = {"plane": "80/185", "distance": 3, "water": "30 %"}
OF_WEDGES: dict[str, dict[str, Any]] = {
    "crack fuller than the joints": {"crack": CUT_OFF | {"water": "80 %"}, "water": {"fill": 0.3}},
    "crack beside pressures": {"crack": CUT_OFF, "water": {"pressures": {"J1": 20, "J2": 5}}},
    "pressure in the crack": {
        "crack": CUT_OFF | {"water": None},
        "water": {"pressures": {"J2": 5, "crack": 12}},
    },
    "bolts and forces": {
        "loads": {"forces": [{"force": 90, "toward": "180/20", "at": [0, 2, 9]}]},
        "support": {
            "bolts": [{"force": 500, "toward": "000/10", "head": [-7, 6, 14], "length": 30}]
        },
    },
}


def on_arrays(design: Design) -> Blocks:
    """The same design as arrays of one."""
    kind = kind_of(design)
    assert kind.on_arrays is not None
    return blocks_of(design, kind.on_arrays, design.joint_strengths, 1)


def corners(blocks: Blocks, joint: int) -> list[tuple[float, ...]]:
    count = blocks.counts[0, joint]
    return sorted(map(tuple, blocks.corners[0, joint, :count].round(6).tolist()))


def test_forty_ordinary_cuts_have_the_loads_of_each_by_itself() -> None:
    """Force and moment about the centroid to 1e-9 of the largest, and the corners of the joints."""
    rng, designs = np.random.default_rng(3), list[Design]()
    while len(designs) < 40:
        try:
            design = wedge_design(ordinary_cut(rng))
            made = cut(design)
        except sk.GeometryError:
            continue
        designs.append(design)
        single, many = blocks_of_cuts([made]), on_arrays(design)
        assert many.load == pytest.approx(single.load, rel=0, abs=1e-9 * np.abs(single.load).max())
        assert many.counts.tolist() == single.counts.tolist()
        assert [corners(many, joint) for joint in range(2)] == [
            corners(single, joint) for joint in range(2)
        ]
        assert many.cohesion == pytest.approx(single.cohesion, rel=1e-15)
        assert many.tan_friction == pytest.approx(single.tan_friction, rel=1e-15)
    assert {bool(design.crack) for design in designs} == {True, False}  # type: ignore[attr-defined]
    assert sum(design.water.fill > 0.0 for design in designs) > 10
    assert sum(design.seismic.coefficient > 0.0 for design in designs) > 5


@pytest.mark.parametrize("name", OF_WEDGES)
def test_loads_of_a_wedge_are_those_of_its_cut(name: str) -> None:
    """Water in the crack of its own, mean pressures, heads of bolts: force and moment as the cut block has them."""
    design = sk.load(WEDGE | OF_WEDGES[name])
    single, many = blocks_of_cuts([cut(design)]), on_arrays(design)
    assert many.load == pytest.approx(single.load, rel=0, abs=1e-9 * np.abs(single.load).max())


@pytest.mark.parametrize("name", OF_PLANES)
def test_a_metre_of_a_plane_has_the_loads_of_the_section(name: str) -> None:
    """Force and moment in the axes of the section; what acts along the slope is left out of both."""
    design = sk.load(PLANE | OF_PLANES[name])
    made, many = cut(design), on_arrays(design)
    force, moment = made.loads.force, made.loads.moment
    assert many.load[0] == pytest.approx(
        [*force, *moment], abs=1e-9 * np.abs(made.loads.force).max()
    )
    assert many.counts.tolist() == [[2]]
    low, high = many.corners[0, 0]
    assert np.linalg.norm(high - low) == pytest.approx(
        sk.run(design).geometry.areas_m2["J1"], rel=1e-9
    )


def test_a_crack_cuts_the_block_and_one_behind_it_leaves_it_whole() -> None:
    """Two metres behind the crest, and 30 m, where the plane has come out."""
    design = sk.load(PLANE | {"crack": {"distance": 2}})
    kind = kind_of(design)
    assert kind.on_arrays is not None
    places: Any = np.array([2.0, 30.0])
    assert isinstance(design, PlaneDesign)
    assert design.crack is not None
    both = replace(design, crack=replace(design.crack, distance_m=places))
    found = limits_on_arrays(both, kind.on_arrays, design.joint_strengths, 2)
    whole = limits_on_arrays(replace(design, crack=None), kind.on_arrays, design.joint_strengths, 1)
    assert found.status.tolist() == ["slides_on_J1", "slides_on_J1"]
    assert found.limit[1] == pytest.approx(whole.limit[0], rel=1e-12)
    assert found.limit[0] == pytest.approx(sk.run(design).fos.limit, rel=1e-6)


def test_a_block_without_strength_has_a_status_and_no_number() -> None:
    """Beside one with strength: a factor of 0 would be a number that no strength gives."""
    design, bare = sk.load(PLANE), np.array([1.0, 0.0])
    kind = kind_of(design)
    assert kind.on_arrays is not None
    (strength,) = design.joint_strengths
    cohesion: Any = 12.0 * bare
    friction: Any = 33.0 * bare
    strengths = [replace(strength, cohesion_kpa=cohesion, friction_angle_deg=friction)]
    found = limits_on_arrays(design, kind.on_arrays, strengths, 2)
    assert found.status.tolist() == ["slides_on_J1"] * 2
    assert np.isnan(found.limit).tolist() == [False, True]
    assert found.forces[1] == 0.0


def test_a_wedge_that_hardly_daylights_is_weighed_as_the_closed_form_weighs_it() -> None:
    """Its line is 5e-8 rad steeper than the upper slope, and the wedge a million times as long as thick."""
    dips = 14.767444667665846 + np.array([3e-6, 1e-5, 1e-3])
    design = sk.load(
        {
            "slopekit": 1,
            "kind": "wedge",
            "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
        }
    )
    columns = vectorised(
        design,
        dips[:, None],
        lambda row: {"joints.J1.plane.dip": float(dips[row])},
        ["joints.J1.plane.dip"],
    )
    assert columns is not None
    found = columns.rows(dips[:, None]).limits()
    assert found.forces == pytest.approx(columns.rows(dips[:, None]).closed_form.factor, rel=1e-8)
