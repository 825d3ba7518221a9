"""W503: a headline that is the factor of a chip says so, and how to come to the larger mechanisms, in keys that do."""

import math
from dataclasses import replace

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.errors import Notice
from slopekit.design.templates import path_of
from slopekit.geometry.rock import splitting
from slopekit.kinds import cut, kind_of
from slopekit.kinds.assemblies.many_blocks_notices import said_of_size
from slopekit.kinds.assemblies.many_blocks_scene import scene_loads
from slopekit.kinds.solver_inputs import joint_strength
from slopekit.preie.many_blocks.ravelling import ravel
from tests.kinds.test_assembly import BENCH, box, on_incline


def beside_a_chip(high: float, mechanisms: int = 1) -> dict:
    """4 m³ beside a weaker piece 0.4 m long, 1 m thick: on the incline each slides at tan φ / tan β."""
    design = on_incline({"chip": box(0, 0, 0.4, high), "wall": box(20, 0, 4, 1)}, 20, 35)
    design["strength"] = {"weak": {"c": 0, "phi": 30}, "joint": {"c": 0, "phi": 35}}
    design["interfaces"] = {"default": "joint", "chip/base": "weak"}
    return design | {"analysis": {"mechanisms": mechanisms}}


def said(design: dict) -> list[str]:
    return [notice.message for notice in sk.run(design).warnings if notice.code == "W503"]


def test_the_factor_of_a_chip_says_that_it_is_one() -> None:
    """0.04 of 4.04 m³ are 0.99 %, and 0.04 m³ of 25 kN/m³ weigh 101.9 kg; 0.0408 of 4.0408 m³ are more than 1 %."""
    (chip,) = said(beside_a_chip(0.1))
    assert chip.startswith("the factor of safety is that of 0.04 m³ (101.9 kg), 0.99 % of the 4.04 m³ that can move")
    assert chip.endswith("; analysis.mechanisms: 3 goes on to what fails after it")  # there is no min_volume of blocks
    assert said(beside_a_chip(0.102)) == []


def test_the_mechanisms_asked_for_are_named_with_their_factors() -> None:
    """What is asked for leads there: the larger block is n 2 of MECHANISM, which has the volumes."""
    result = sk.run(beside_a_chip(0.1, mechanisms=3))
    factor = math.tan(math.radians(35)) / math.tan(math.radians(20))
    (chip,) = [notice.message for notice in result.warnings if notice.code == "W503"]
    assert chip.endswith(f"; the first larger one under MECHANISM, n 2, has {factor:.4f}, those before it taken away")
    rows = [line.split()[:3] for line in str(result).splitlines() if line.strip().startswith(("1 ", "2 "))]
    assert [(n, volume) for n, _, volume in rows] == [("1", "0.04"), ("2", "4")]
    assert rows[1][1] == f"{factor:.3f}"


def test_only_chips_were_asked_for() -> None:
    """Two chips first: the larger block comes with more mechanisms, as many as are named."""
    design = beside_a_chip(0.05, mechanisms=2)
    design["blocks"]["other"] = on_incline({"other": box(40, 0, 0.4, 0.05)}, 20, 35)["blocks"]["other"]
    design["strength"]["weaker"] = {"c": 0, "phi": 28}
    design["interfaces"]["other/base"] = "weaker"
    (chip,) = said(design)
    assert chip.endswith("; analysis.mechanisms: 4 goes on to what fails after it")
    (chip,) = said(design | {"analysis": {"mechanisms": 4}})
    assert "n 3, has" in chip


@pytest.mark.parametrize(("boulder", "joins"), [(False, True), (True, False)])
def test_a_bench_joins_what_is_smaller_than_min_volume(boulder, joins, monkeypatch) -> None:
    """Up to a boulder: a mechanism of several m³ is no piece to be left to its neighbours."""
    if boulder:
        monkeypatch.setattr("slopekit.kinds.assemblies.many_blocks_notices._BOULDER_M3", 0.0)
    design = sk.load(BENCH)
    scene = cut(design)
    ravelling = ravel(scene.assembly, scene_loads(scene), joint_strength(scene.strengths), ranged=False)
    volumes = np.where(scene.assembly.fixed, np.inf, scene.assembly.volumes)
    assert volumes.min() < 0.01 * volumes[np.isfinite(volumes)].sum()
    ravelling.failures[0].blocks[:] = volumes.argmin()  # as if the smallest went first
    (notice,) = said_of_size(design, scene, ravelling)
    key = "; a cut.min_volume above"
    assert (key in notice.message) == joins
    if joins:
        above = float(notice.message.partition(key)[2].split()[0]) * 1.001
        joined = cut(sk.load(BENCH, set={"cut.min_volume": f"{above} m3"})).assembly
        assert joined.volumes.min() > volumes.min() * 1.0005
        assert len(joined) < len(scene.assembly)


def test_studies_hear_it_too() -> None:
    """`solve` and `quake` ask for factors alone."""
    design = sk.load(beside_a_chip(0.1))
    assert [type(note) for note in kind_of(design).factors(design).notes] == [Notice]


def test_pieces_joined_until_nothing_is_left_say_so() -> None:
    """The template's 137 cells (132 blocks and 5 slivers) all lie below 500 m³: two blocks, on no bedrock, fell without
    a factor and without a word on the key."""
    bench = path_of("bench")
    with pytest.raises(sk.GeometryError, match="E225 none of the 2 blocks can move") as refused:
        sk.run(bench, set={"cut.min_volume": 500})
    assert refused.value.faults[0].advice.endswith("deeper bench, or a cut.min_volume below 500 m3.")
    whole, coarse = cut(sk.load(bench)), cut(sk.load(bench, set={"cut.min_volume": 50}))
    (said,) = [one.message for one in coarse.notices if one.code == "W505"]
    small = whole.assembly.volumes < 50.0
    assert small.all()
    assert "hold 100 % of the rock" in said
    assert f": {len(coarse.assembly)} of {len(small) + 5} blocks are left, " in said
    assert "W505" not in {one.code for one in whole.notices}


@pytest.mark.parametrize(("beside", "is_said"), [(1.001, True), (0.999, False)])
def test_slivers_are_a_hundredth_of_the_rock_at_most(beside, is_said) -> None:
    """A `min_volume` just above and just below the block with which the smallest first hold more than that."""
    bench = path_of("bench")
    volumes = np.sort(cut(sk.load(bench)).assembly.volumes)
    first_above = np.searchsorted(np.cumsum(volumes), 0.01 * volumes.sum())
    joined = cut(sk.load(bench, set={"cut.min_volume": volumes[first_above] * beside}))
    assert ("W505" in {one.code for one in joined.notices}) == is_said


def test_rock_that_is_left_out_is_said(monkeypatch) -> None:
    """Slivers without a neighbour are no part of any block: how many m³ that is stands on the short sheet."""
    made = splitting.cut_bench
    monkeypatch.setattr(
        splitting, "cut_bench", lambda *given: replace(made(*given), slivers_left_out=2, volume_left_out=0.125)
    )
    (message,) = [one.message for one in cut(sk.load(path_of("bench"))).notices if one.code == "W505"]
    assert message == "0.125 m³ of rock is left out: slivers below 0.01 m³ without a neighbour"
