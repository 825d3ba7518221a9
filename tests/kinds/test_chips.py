"""Chips: mechanisms lighter than 2 % of the median block are taken away first, and what is left is the answer."""

import math

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.orientation import Line
from slopekit.kinds import cut, kind_of
from slopekit.kinds.assemblies.many_blocks_scene import scene_loads
from tests.kinds.test_assembly import box, on_incline

BETA = 20.0


def slides(friction: float) -> float:
    return math.tan(math.radians(friction)) / math.tan(math.radians(BETA))


def design(high: float, on_wall: bool = False, friction: float = 30.0, **more) -> dict:
    """Three walls of 4 m³ on an incline, and a weaker piece 0.4 m long beside or on top of the first."""
    outlines = {f"wall{k}": box(20 * k, 0, 4, 1) for k in (1, 2, 3)}
    outlines["chip"] = box(21, 1, 0.4, high) if on_wall else box(0, 0, 0.4, high)
    made = on_incline(outlines, BETA, 35, **more)
    made["strength"]["weak"] = {"c": 0, "phi": friction}
    made["interfaces"] = {"default": "joint", "chip/wall1" if on_wall else "chip/base": "weak"}
    return made


def without_chip(given: dict) -> dict:
    blocks = {name: block for name, block in given["blocks"].items() if name != "chip"}
    strength = {"joint": given["strength"]["joint"]}
    return given | {"blocks": blocks, "interfaces": {"default": "joint"}, "strength": strength}


@pytest.mark.parametrize(("high", "is_chip"), [(0.199, True), (0.201, False)])
def test_a_piece_below_a_fiftieth_of_the_median_block_is_a_chip(high, is_chip) -> None:
    """The median of 4, 4, 4 m³ and the piece is 4 m³: 0.08 m³ of 25 kN/m³."""
    result = sk.run(design(high))
    assert result.fos.limit == pytest.approx(slides(35.0 if is_chip else 30.0), rel=1e-9)
    chips = result.findings.chips
    assert len(chips) == is_chip
    assert result.scene.factor[result.geometry.names.index("chip")] == pytest.approx(
        slides(30.0), rel=1e-9
    )
    if is_chip:
        assert chips[0].blocks == ("chip",)
        assert chips[0].fos == pytest.approx(slides(30.0), rel=1e-9)
        assert chips[0].size.mass_t == pytest.approx(0.0796 * 25.0 / 9.81, rel=1e-9)
        assert (
            "CHIPS     1 block (203 kg in all) too light to count, failing from FoS 1.586: taken"
            in str(result)
        )
        rows = result.to_dict()["mechanisms"]
        assert next((row["mechanism"], row["blocks"]) for row in rows) == ("chip", ["chip"])
        assert [row["fos"] for row in rows] == [chips[0].fos, result.fos.limit]


def test_a_chip_that_fails_after_the_first_mechanism_is_on_the_sheet() -> None:
    """The chip is held by friction of 40°, above the walls' 35°."""
    result = sk.run(design(0.1, friction=40.0, analysis={"mechanisms": 2}))
    rows = result.to_dict()["mechanisms"]
    assert [row["mechanism"] for row in rows] == ["first", "chip"]
    assert not result.findings.chips
    said = f"1 block (102 kg in all) too light to count, failing from FoS {slides(40.0):.3f}: taken away after"
    assert f"CHIPS {said}" in " ".join(str(result).split())


def test_what_counts_is_set_by_the_smallest_block() -> None:
    assert sk.run(design(0.1), set={"analysis.smallest_block": 0}).fos.limit == pytest.approx(
        slides(30.0), rel=1e-9
    )
    result = sk.run(design(0.3), set={"analysis.smallest_block": 0.04})
    assert result.fos.limit == pytest.approx(slides(35.0), rel=1e-9)
    with pytest.raises(sk.DesignError, match="E137"):
        sk.load(design(0.1), set={"analysis.smallest_block": 1.5})


def test_where_nothing_heavier_fails_a_chip_is_the_answer() -> None:
    """A wall on a level base stands without strength; 0.02 m³ on a ramp of 20° beside it slide."""
    drop = math.tan(math.radians(BETA))
    chip = [
        [1.0, 3.0 * drop],
        [1.4, 2.6 * drop],
        [1.4, 2.6 * drop + 0.05],
        [1.0, 3.0 * drop + 0.05],
    ]
    given = {
        "slopekit": 1,
        "kind": "blocks",
        "blocks": {
            "base": {"polygon": box(-10, -5, 60, 5), "fixed": True},
            "ramp": {"polygon": [[0, 0], [4, 0], [0, 4 * drop]], "fixed": True},
            "wall": {"polygon": box(20, 0, 4, 1)},
            "chip": {"polygon": chip},
        },
        "strength": {"joint": {"c": 0, "phi": 30}},
        "rock": {"unit_weight": 25},
    }
    result = sk.run(given)
    assert result.fos.limit == pytest.approx(slides(30.0), rel=1e-6)
    assert not result.findings.chips


def test_chips_of_one_factor_go_before_what_is_heavier() -> None:
    result = sk.run(design(0.1, friction=35.0))
    assert [chip.blocks for chip in result.findings.chips] == [("chip",)]
    assert set(result.findings.first.blocks) == {"wall1", "wall2", "wall3"}


def test_all_numbers_are_those_of_the_blocks_without_the_chip() -> None:
    """It lies on a wall, pulls it by a bolt, has water under it and a surcharge on it, and would run at once."""
    given = design(0.1, on_wall=True, friction=10.0, c=2)
    given["water"] = {"pressures": {"chip/wall1": "0.5 kPa"}}
    given["loads"] = {"surcharge": {"chip": "3 kPa"}}
    alone = without_chip(given) | {"water": "dry", "loads": {}}
    options = {"set": {"analysis.criterion": "all-pairs"}}
    result, expected = sk.run(given, **options), sk.run(alone, **options)
    assert result.findings.chips[0].fos < 1.0 < result.fos.limit
    for name in ("limit", "static_bound", "all_pairs_failed", "lowest", "highest"):
        assert getattr(result.fos, name) == pytest.approx(getattr(expected.fos, name), rel=1e-7), (
            name
        )
    ours, theirs = result.displacements.at_factor_one, expected.displacements.at_factor_one
    order = [sk.run(given).geometry.names.index(name) for name in expected.geometry.names]
    assert ours.block == theirs.block
    assert np.asarray(ours.block_movements)[order] == pytest.approx(
        np.asarray(theirs.block_movements), rel=1e-6, abs=1e-12
    )
    assert kind_of(sk.load(given)).factors(sk.load(given)).limit == pytest.approx(
        result.fos.limit, rel=1e-9
    )


@pytest.mark.parametrize("headed", ["chip", "wall1"])
def test_the_loads_of_what_is_left(headed) -> None:
    """An active bolt between the chip and the wall pulls neither once the chip is gone; other forces stay."""
    given = design(0.1, on_wall=True)
    given["loads"] = {"forces": [{"force": "5 kN", "toward": "270/00", "block": "wall2"}]}
    head = np.array(cut(sk.load(given)).assembly.centroids[-1])
    toward = "270/80"
    if headed == "wall1":
        head, toward = head + 0.6 * Line(270.0, 80.0).vector(), "090/-80"
    bolt = {
        "force": "40 kN",
        "toward": toward,
        "head": head.tolist(),
        "length": 0.6,
        "block": headed,
    }
    scene = cut(sk.load(given | {"support": {"bolts": [bolt]}}))
    gone = np.array([name == "chip" for name in scene.names])
    left, plain = (
        scene_loads(scene.without_blocks(gone)),
        scene_loads(cut(sk.load(without_chip(given)))),
    )
    assert np.abs(scene_loads(scene).forces[~gone] - plain.forces).max() > 30.0
    assert left.forces[~gone] == pytest.approx(plain.forces, abs=1e-9)
    assert left.moments[~gone] == pytest.approx(plain.moments, abs=1e-9)


@pytest.mark.parametrize("friction", [30.0, 10.0])
def test_a_load_grows_until_what_counts_fails(friction) -> None:
    """k = tan(φ - β) of the walls, where the chip fails at less, and where it does not stand at all."""
    still = design(0.1, friction=friction)
    still["loads"] = {"seismic": {"k": 0, "toward": 270}}
    shaken = still | {"loads": {"seismic": {"k": 1.0, "toward": 270}}}
    kind = kind_of(sk.load(still))
    expected = math.tan(math.radians(35.0 - BETA))
    assert kind.at_load(sk.load(still), sk.load(shaken), 1.0) == pytest.approx(expected, rel=1e-6)


def test_elastic_blocks_are_those_that_are_left() -> None:
    """The chip would not come to rest (W450)."""
    pytest.importorskip("skfem")
    given = design(0.1, on_wall=True, friction=10.0)
    given["rock"] |= {"modulus": "1 GPa", "poisson": 0.2}
    ours, theirs = (sk.run(one, elastic=True).elastic for one in (given, without_chip(given)))
    assert ours.factor == theirs.factor == 1.0
    assert ours.displacement_m == pytest.approx(theirs.displacement_m, rel=1e-6)


def test_check_climbs_with_what_is_left() -> None:
    ladder = kind_of(sk.load(design(0.1))).ladder(sk.load(design(0.1)))
    assert {rung.method for rung in ladder.rungs} == {"stiffness", "mesh"}
    assert [rung.factor for rung in ladder.rungs] == pytest.approx(
        [slides(35.0)] * len(ladder.rungs), rel=1e-6
    )


def test_chips_of_several_groups_that_do_not_stand_are_taken_from_each() -> None:
    """Two walls with a chip on each, which fall at once: k = tan(φ - β) of the walls all the same."""
    still = design(0.1, on_wall=True, friction=10.0)
    still["blocks"]["chip2"] = on_incline({"chip2": box(41, 1, 0.4, 0.1)}, BETA, 35)["blocks"][
        "chip2"
    ]
    still["interfaces"]["chip2/wall2"] = "weak"
    still["loads"] = {"seismic": {"k": 0, "toward": 270}}
    kind, shaken = kind_of(sk.load(still)), sk.load(still, set={"loads.seismic.k": 1})
    expected = math.tan(math.radians(35.0 - BETA))
    assert kind.at_load(sk.load(still), shaken, 1.0) == pytest.approx(expected, rel=1e-6)
    result = sk.run(still)
    assert {name for chip in result.findings.chips for name in chip.blocks} == {"chip", "chip2"}
    assert "3 slide (wall1 to wall3)" in str(result)
    assert "stay" not in str(result)
    assert result.forces.weight == pytest.approx(300.0, rel=1e-12)


def test_the_lowest_factor_is_no_higher_than_that_of_a_block_that_others_press_on() -> None:
    """Sideways thrust between steep joints carries the path to 0.765; by forces alone the wedge of S1 and S2 slides."""
    bench = {
        "slopekit": 1,
        "kind": "bench",
        "rock": {"unit_weight": 26},
        "slope": {"face": "72/090", "upper": "2/090", "height": 12, "length": 20},
        "sets": {
            "S1": {"plane": "40/085", "spacing": 2.5, "strength": "bed"},
            "S2": {"plane": "80/005", "spacing": 3, "strength": "joint"},
            "S3": {"plane": "75/265", "spacing": 3, "strength": "joint"},
        },
        "strength": {"bed": {"c": 0, "phi": 30}, "joint": {"c": 0, "phi": 35}},
    }
    found = sk.run(bench).fos
    wedge = sk.wedge(
        dips=("40/085", "80/005"), face="72/090", upper="2/090", height=5, c=0, phi=(30, 35)
    )
    assert found.lowest == pytest.approx(wedge.fos.closed_form, rel=1e-6)
    assert found.limit > 1.05 * found.lowest
