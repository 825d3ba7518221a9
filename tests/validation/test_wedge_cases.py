"""Published and exact wedges (shared/cases/cases.json; sources in each case)."""

import json
from pathlib import Path

import numpy as np
import pytest

import slopekit as sk

CASES = json.loads((Path(__file__).parent / "wedge_cases.json").read_text())


@pytest.fixture(scope="module")
def solved() -> dict[str, "sk.wedge"]:
    return {case["id"]: sk.wedge(**case["inputs"]) for case in CASES}


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["id"])
def test_factor_of_safety(case, solved) -> None:
    """To 1e-5; the cases that are not exact recomputations are printed with six digits."""
    result = solved[case["id"]]
    if case["mode"] == "lift":
        assert result.status == "lifted"
        assert result.fos.limit is None
        assert result.fos.closed_form is None
        return
    assert result.fos.closed_form == pytest.approx(case["fos_limit"], rel=1e-5)
    if result.moments_govern:  # the closed form knows no moments (uplift opens a joint)
        assert result.comparisons.forces_only == pytest.approx(case["fos_limit"], rel=1e-5)
        assert result.fos.limit < case["fos_limit"]
    else:
        assert result.fos.limit == pytest.approx(case["fos_limit"], rel=1e-5)
    assert result.agree


def test_moments_govern_only_where_the_sources_say_so(solved) -> None:
    assert [key for key, result in solved.items() if result.moments_govern] == [
        "9_W&M wedge water u=1.50 x gw*Hw/6"
    ]


@pytest.mark.parametrize(
    "case", [case for case in CASES if case["fos_static_bound"]], ids=lambda case: case["id"]
)
def test_static_bound(case, solved) -> None:
    result = solved[case["id"]]
    if (
        result.limit_state.openings
    ):  # the source balances forces only: an upper bound of the bound with moments
        assert result.fos.limit < result.fos.static_bound < case["fos_static_bound"]
    else:
        assert result.fos.static_bound == pytest.approx(case["fos_static_bound"], rel=1e-5)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["id"])
def test_size(case, solved) -> None:
    """Volume and areas: to 1e-10 where the source is exact, else to its printed digits."""
    geometry = solved[case["id"]].geometry
    printed = 0.0 if case["exact"] else 6e-7
    assert geometry.volume_m3 == pytest.approx(case["volume"], rel=1e-10, abs=printed)
    assert list(geometry.areas_m2.values()) == pytest.approx(case["areas"], rel=1e-10, abs=printed)


@pytest.mark.parametrize(
    "case", [case for case in CASES if case["mode"] in ("12", "both planes")], ids=lambda c: c["id"]
)
def test_normal_forces(case, solved) -> None:
    normal = list(solved[case["id"]].forces.normal.values())
    printed = 0.0 if case["exact"] else 6e-4
    assert np.array(normal) == pytest.approx(np.array(case["normal"]), rel=1e-9, abs=printed)
