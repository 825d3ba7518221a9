"""Columns made from a slope: Goodman & Bray's (1976) construction against their published list, and refusals."""

import math

import pytest

import slopekit as sk
from slopekit.core.errors import DesignError

PUBLISHED = (
    4,
    8,
    12,
    16,
    20,
    24,
    28,
    32,
    36,
    40,
    34,
    28,
    22,
    16,
    10,
    4,
)  # cases.json 5a_goodman_bray
#: The dips at which a₁ and a₂ are the 5.0 m that the book rounds them to; it prints 56.6 and 4.
FACE, UPPER = 30.0 + math.degrees(math.atan(0.5)), 30.0 - math.degrees(math.atan(0.5))


def design(slope=None, strength=38.15, **columns) -> dict:
    made = {
        "slopekit": 1,
        "kind": "topple",
        "columns": {"dip": 60, "width": 10, "base_step": 1} | columns,
        "strength": {"joint": {"c": 0, "phi": strength}},
        "rock": {"unit_weight": 25},
    }
    if slope is not None:
        made["slope"] = slope
    made["columns"] = {key: value for key, value in made["columns"].items() if value is not None}
    return made


def test_the_published_columns_come_out_of_the_slope() -> None:
    """Rounded as the book rounds, they are its list; as it prints the slope, they are it within the rounding of a₂."""
    exact = sk.load(design({"height": 92.5, "face": FACE, "upper": UPPER}))
    assert exact.heights_m == pytest.approx(PUBLISHED, rel=1e-12)
    printed = sk.load(design({"height": 92.5, "face": 56.6, "upper": 4}))
    assert len(printed.heights_m) == 16
    assert printed.heights_m[:10] == pytest.approx(PUBLISHED[:10], rel=2e-3)
    # behind the crest a₂ = 10 tan 26 = 4.877 m and not 5.0: 0.123 m more with each of six columns, and 0.076 m of C10
    assert [
        own - book for own, book in zip(printed.heights_m[10:], PUBLISHED[10:], strict=True)
    ] == pytest.approx([0.0763 + 0.12267 * n for n in range(1, 7)], abs=1e-3)


def test_its_factor_is_the_published_one_and_prei_e_says_the_same() -> None:
    """F = 1.00 at φ = 38.15° is published; printed dips leave the rest a little larger."""
    found = sk.run(design({"height": 92.5, "face": 56.6, "upper": 4}))
    assert found.status == "topples"
    assert found.fos.closed_form == pytest.approx(1.0, abs=5e-3)
    assert found.agree
    listed = sk.run(design(heights=list(PUBLISHED)))
    of_slope = sk.run(design({"height": 92.5, "face": FACE, "upper": UPPER}))
    assert of_slope.fos.closed_form == pytest.approx(listed.fos.closed_form, rel=1e-12)
    assert "made from a slope 92.5 m high, face 56.6°, upper slope 4°" in " ".join(
        str(found.sheet).split()
    )
    assert "slope_height_m" in found.to_dict()["inputs"]
    assert "slope_height_m" not in listed.to_dict()["inputs"]


def test_a_base_angle_stands_for_a_step() -> None:
    """b = Δx tan(ψ_b - ψ_p)."""
    angle = 30.0 + math.degrees(math.atan(0.1))
    by_angle = sk.load(
        design({"height": 92.5, "face": 56.6, "upper": 4}, base_step=None, base_angle=angle)
    )
    by_step = sk.load(design({"height": 92.5, "face": 56.6, "upper": 4}))
    assert by_angle.base_step_m == pytest.approx(1.0, rel=1e-12)
    assert by_angle.heights_m == pytest.approx(by_step.heights_m, rel=1e-12)
    assert sk.load(
        design(heights=[4, 8], base_step=None, base_angle=angle)
    ).base_step_m == pytest.approx(1.0)


def test_studies_change_the_slope() -> None:
    """The columns are made again at each height: a lower slope has fewer, and stands better."""
    asked = sk.load(design({"height": 92.5, "face": 56.6, "upper": 4}))
    swept = sk.sweep(asked, {"slope.height": [40.0, 92.5]})
    low, high = (point.factors.closed_form for point in swept.points)
    assert low > high
    assert len(sk.load(design({"height": 40, "face": 56.6, "upper": 4})).heights_m) < 16


@pytest.mark.parametrize(
    ("slope", "columns", "code"),
    [
        (None, {}, "E448"),
        ({"height": 92.5, "face": 56.6}, {"heights": [4, 8]}, "E448"),
        ({"height": 92.5, "face": 56.6}, {"base_angle": 36}, "E448"),
        ({"height": 92.5}, {}, "E448"),
        ({"face": 56.6}, {}, "E448"),
        ({"height": 92.5, "face": 34}, {}, "E450"),
        ({"height": 92.5, "face": 56.6}, {"base_step": None, "base_angle": 20}, "E450"),
        ({"height": 92.5, "face": 56.6, "upper": 40}, {}, "E450"),
        ({"height": 92.5, "face": 56.6, "upper": 4}, {"width": 1e-4, "base_step": 0}, "E450"),
        ({"height": 92.5, "face": 36, "upper": 4}, {}, "E450"),
        ({"height": 92.5, "face": 92}, {}, "E101"),
        ({"height": 0, "face": 56.6}, {}, "E116"),
        ({"height": "5 kPa", "face": 56.6}, {}, "E107"),
        ({"height": 92.5, "face": "60/180"}, {}, "E108"),
    ],
)
def test_a_slope_that_makes_no_columns_is_refused(slope, columns, code) -> None:
    with pytest.raises(DesignError) as refused:
        sk.load(design(slope, **columns))
    assert code in refused.value.codes, refused.value
