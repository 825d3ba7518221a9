"""Limits of size of `sk.wedge` and `slopekit wedge`: those of design files, which are tested against hand geometry."""

import pytest

import slopekit as sk
from slopekit.core.errors import DesignError, GeometryError
from tests.commands import slopekit

PAPER = {
    "slopekit": 1,
    "kind": "wedge",
    "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
}
DIPS = ("45/115", "45/245")


@pytest.mark.parametrize(
    ("limits", "flags"),
    [
        ({"bench_width": 6}, ["bench_width=6m"]),
        ({"trace_length": (30, 12)}, ["trace-length=30,12"]),
        ({"trace_length": {"J1": 10}, "persistence": 15}, None),
        ({"max_volume": "100 m3", "by": "scale"}, ["max_volume=100 m3", "by=scale"]),
    ],
)
def test_a_call_has_the_wedge_of_the_design_file(limits, flags) -> None:
    written = {
        key: list(value) if isinstance(value, tuple) else value for key, value in limits.items()
    }
    expected = sk.run(PAPER | {"limits": written})
    found = sk.wedge(DIPS, limits=limits)
    assert found.geometry.scaled == expected.geometry.scaled
    assert found.geometry.scaled["factor"] < 1.0
    assert (found.geometry.setback_m, found.fos.limit) == (
        expected.geometry.setback_m,
        expected.fos.limit,
    )
    if flags is not None:
        assert sk.wedge(DIPS, limits=flags).geometry.volume_m3 == expected.geometry.volume_m3


def test_the_bench_width_is_the_setback_and_what_is_smaller_is_smaller_by_powers_of_lengths() -> (
    None
):
    """By hand: lengths s, areas s², volume s³ of the wedge without a limit."""
    whole, small = sk.wedge(DIPS), sk.wedge(DIPS, limits={"bench_width": 6})
    scale = 6.0 / whole.geometry.setback_m
    assert small.geometry.setback_m == pytest.approx(6.0)
    assert small.geometry.areas_m2["J1"] == pytest.approx(
        scale**2 * whole.geometry.areas_m2["J1"], rel=1e-9
    )
    assert small.geometry.volume_m3 == pytest.approx(scale**3 * whole.geometry.volume_m3, rel=1e-9)


def test_a_filter_leaves_no_wedge() -> None:
    with pytest.raises(GeometryError, match="E486"):
        sk.wedge(DIPS, limits={"bench_width": 6, "by": "filter"})


@pytest.mark.parametrize(
    ("limits", "code"),
    [
        (7, "E142"),
        ("6m", "E142"),
        ({"bench_widht": 6}, "E142"),
        (["bench_width=6", "x"], "E142"),
        ({"bench_width": -6}, "E116"),
        ({"trace_length": (1, 2, 3)}, "E109"),
        ({"by": "shrink"}, "E126"),
        ({"min_volume": 9, "max_volume": 3}, "E116"),
    ],
)
def test_what_is_no_limit_is_refused(limits, code) -> None:
    with pytest.raises(DesignError) as refused:
        sk.wedge(DIPS, limits=limits)
    assert code in refused.value.codes


def test_the_command_takes_several() -> None:
    said = slopekit(
        "wedge",
        "--dips",
        *DIPS,
        "--limit",
        "bench_width=6m",
        "--limit",
        "max_volume=9000 m3",
        "--quiet",
    )
    assert (said.returncode, said.stderr) == (0, "")
    wrong = slopekit("wedge", "--dips", *DIPS, "--limit", "bench_widht=6m")
    assert wrong.returncode == 2
    assert "E142 bench_widht is no limit of size" in wrong.stderr
    assert "Did you mean bench_width?" in wrong.stderr
