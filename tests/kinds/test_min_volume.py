"""W505: small pieces that are joined to their neighbours or left out."""

from dataclasses import replace

import numpy as np
import pytest

import slopekit as sk
from slopekit.design.templates import path_of
from slopekit.geometry.rock import splitting
from slopekit.kinds import cut


def test_pieces_joined_until_nothing_is_left_say_so() -> None:
    """The template's 137 cells (132 blocks and 5 slivers) all lie below 500 m³: two blocks, on no bedrock, fell without
    a factor and without a word on the key."""
    bench = path_of("bench")
    with pytest.raises(sk.GeometryError, match="E225 none of the 2 blocks can move") as refused:
        sk.run(bench, set={"cut.min_volume": 500})
    assert refused.value.faults[0].advice.endswith(
        "deeper bench, or a cut.min_volume below 500 m3."
    )
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
        splitting,
        "cut_bench",
        lambda *given: replace(made(*given), slivers_left_out=2, volume_left_out=0.125),
    )
    (message,) = [
        one.message for one in cut(sk.load(path_of("bench"))).notices if one.code == "W505"
    ]
    assert message == "0.125 m³ of rock is left out: slivers below 0.01 m³ without a neighbour"
