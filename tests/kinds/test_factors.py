"""The quick evaluation against the whole analysis: the same numbers and words, whatever governs."""

import pytest

import slopekit as sk
from slopekit.design.reading.files import load, with_values
from slopekit.kinds import factors_of
from slopekit.kinds.protocol import ClosedForm, compare
from slopekit.kinds.wedge.design import wedge_design

FILES = [f"templates/{name}.yaml" for name in ("wedge", "plane", "footing", "topple", "cylinder")]


def same(design, whole=None) -> None:
    """Of one design; its whole analysis may be there already."""
    quick, whole = factors_of(design), whole or sk.analyse(design)
    assert (quick.status, quick.limit, quick.closed_form) == (
        whole.status,
        whole.fos.limit,
        whole.fos.closed_form,
    )
    assert (quick.agree, quick.difference) == (whole.agree, whole.difference)
    assert quick.moments_govern == whole.moments_govern
    alone = factors_of(design, pre_ie=False)
    if quick.closed_status is not None:
        assert (alone.status, alone.limit, alone.factor) == (
            quick.closed_status,
            None,
            quick.closed_form,
        )


@pytest.mark.parametrize("file", FILES)
def test_templates(file: str) -> None:
    same(load(file))


def test_dilating_joints_are_not_compared() -> None:
    quick = factors_of(load("templates/wedge.yaml", [("strength.weak.dilation", 5)]))
    assert quick.agree is None
    assert quick.limit > quick.closed_form


def test_other_values_are_read_as_those_of_the_file() -> None:
    design = load("templates/wedge.yaml", [("slope.height", "30 m")])
    other = with_values(design, {"strength.weak.phi": 25, "slope.face": "62/180"})
    assert (other.friction_angle_deg, other.face.dip_deg, other.height_m) == (
        (25.0, 25.0),
        62.0,
        30.0,
    )
    assert (
        other.input_hash()
        == load(
            "templates/wedge.yaml",
            [("slope.height", "30 m"), ("strength.weak.phi", 25), ("slope.face", "62/180")],
        ).input_hash()
    )


def test_a_design_without_a_file_has_no_values_to_change() -> None:
    with pytest.raises(sk.DesignError) as caught:
        with_values(wedge_design({"dips": ["45/115", "45/245"]}), {"slope.height": 30})
    assert caught.value.codes == ("E280",)
    joints = {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}
    assert "source" not in load({"slopekit": 1, "kind": "wedge", "joints": joints}).inputs()


def test_a_number_against_no_strength_at_all_is_a_disagreement() -> None:
    """Nothing to divide by: no difference, and never agreement; of nothing on both sides the status decides."""
    nothing = ClosedForm(0.0, "slides_on_J1")
    assert compare(1.2, "slides_on_J1", nothing, 0.01) == (None, False)
    assert compare(None, "slides_on_J1", nothing, 0.01) == (None, True)
    assert compare(None, "slides_on_J2", nothing, 0.01) == (None, False)
