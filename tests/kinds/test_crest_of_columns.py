"""Crest loss of toppling columns that were made from a slope, by trigonometry on the corners of their tops."""

import math

import pytest

import slopekit as sk


def columns(scale=1.0, friction=38.15, **slope):
    """Goodman & Bray's slope: base plane 30°, stepped by 5.7°."""
    made = {"height": 92.5 * scale, "face": 56.6, "upper": 4} | slope
    return {
        "slopekit": 1,
        "kind": "topple",
        "slope": made,
        "rock": {"unit_weight": 25},
        "columns": {
            "dip": 60,
            "width": 10.0 * scale,
            "base_angle": 35.7,
            "base": "j",
            "sides": "j",
        },
        "strength": {"j": {"c": 0, "phi": friction}},
    }


@pytest.mark.parametrize("friction", [38.15, 33.0])
def test_the_setback_is_from_the_crest_to_the_back_of_the_last_column_at_its_top(friction) -> None:
    result = sk.run(columns(friction=friction))
    mechanism = result.findings.first
    last = max(int(name[1:]) for name in mechanism.blocks)
    step = 10.0 * math.tan(math.radians(5.7))
    up = (last - 1) * step + result.design.heights_m[last - 1]  # square to the bases
    top_x = last * 10.0 * math.cos(math.radians(30.0)) - up * math.sin(math.radians(30.0))
    crest_x = 92.5 / math.tan(math.radians(56.6))
    assert mechanism.size.setback_m == pytest.approx(top_x - crest_x, rel=1e-9)
    assert top_x > crest_x
    # the top of the last column lies on the upper slope, but for the step that Goodman & Bray leave out
    z = up * math.cos(math.radians(30.0)) + last * 10.0 * math.sin(math.radians(30.0))
    assert z == pytest.approx(
        92.5 + (top_x - crest_x) * math.tan(math.radians(4.0)), abs=1.2 * step
    )


def test_lengths_areas_and_volumes_scale() -> None:
    one, other = (sk.run(columns(scale)) for scale in (1.0, 3.0))
    small, large = one.findings.first.size, other.findings.first.size
    assert large.setback_m == pytest.approx(3.0 * small.setback_m, rel=1e-9)
    assert large.volume_m3 == pytest.approx(
        9.0 * small.volume_m3, rel=1e-9
    )  # per metre along the strike
    assert other.fos.limit == pytest.approx(one.fos.limit, rel=1e-6)


def test_columns_by_their_heights_have_no_crest() -> None:
    design = columns()
    design["columns"] |= {"heights": [4, 8, 12, 9, 5]}
    del design["slope"]
    assert sk.run(design).findings.first.size.setback_m is None


def test_the_sheet_and_json_say_it() -> None:
    result = sk.run(columns())
    assert result.to_dict()["mechanism"]["setback_m"] == result.findings.first.size.setback_m
    setback = result.findings.first.size.setback_m
    assert f"{setback:.3g} m behind the crest" in " ".join(result.sheet.full.split())
