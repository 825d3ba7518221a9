"""Cohesion that decides, traces with hidden ends, columns that slide."""

from typing import Any

import slopekit as sk

PLANES = ("40/180", "40/181")
JOINTS = (
    "52/140",
    "58/150",
    "47/128",
    "61/222",
    "55/232",
    "66/215",
    "44/178",
    "52/186",
    "78/004",
    "18/175",
)
SMALL: dict[str, Any] = {"height": 12, "face": 70, "dip_direction": 180, "n": 2000}


# -- cohesion -------------------------------------------------------------------------------------------------------


def test_without_cohesion_is_a_run_with_c_0() -> None:
    """Another run, with c = 0 given, says the same; and its own block of numbers is absent."""
    with_c = sk.bench_design(list(JOINTS), c=10, phi=32, spacing=1.5, **SMALL)
    without = sk.bench_design(list(JOINTS), c=0, phi=32, spacing=1.5, **SMALL)
    bare, own = with_c.benches[0].bare, without.benches[0]
    assert bare["fails"] == {name: mode["fails"].share for name, mode in own.modes.items()}
    assert bare["fails_if_formed"] == {
        name: mode["fails_if_formed"].share for name, mode in own.modes.items()
    }
    assert bare["berm_needed_m"] == own.berm_needed_m
    assert own.bare is None
    assert with_c.to_dict()["benches"][0]["without_cohesion"]["decides"] is True
    assert without.to_dict()["benches"][0]["without_cohesion"] is None


def test_the_notice_stands_where_cohesion_decides_and_not_where_it_does_not() -> None:
    """10 kPa holds nearly all of it, 0.05 kPa next to nothing; one place more or less is within the limits."""
    decides = sk.bench_design(list(JOINTS), c=10, phi=32, **SMALL)
    said = next(str(one) for one in decides.warnings if one.code == "W422")
    bench = decides.benches[0]
    assert f"{100.0 * bench.bare['fails_if_formed']['any']:.3g} %" in said
    assert bench.bare["fails"]["any"] >= 2.0 * bench.modes["any"]["fails"].share
    assert bench.bare["fails"]["any"] > bench.modes["any"]["fails"].high
    little = sk.bench_design(list(JOINTS), c=0.05, phi=32, **SMALL)
    assert "W422" not in {one.code for one in little.warnings}
    assert little.benches[0].bare["decides"] is False
