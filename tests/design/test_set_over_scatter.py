"""A number set in place of a distribution: its correlation goes with it, and that is said."""

import pytest

from slopekit.core.errors import DesignError
from slopekit.design.reading.files import load
from slopekit.design.templates import path_of
from slopekit.kinds import analyse
from slopekit.studies.prob import prob

SCATTER = path_of("wedge-scatter")


def test_a_number_takes_the_correlations_of_its_distribution_along() -> None:
    before, after = load(SCATTER), load(SCATTER, [("strength.clay.c", 15.0)])
    assert len(before.correlation) == 2
    assert after.correlation == (("strength.clay.phi", "strength.rough.phi", 0.3),)
    assert "strength.clay.c" not in {variable.path for variable in after.variables}
    said = "not used: correlation strength.clay.c / strength.clay.phi (a number was set in place of a distribution)"
    for notices in (analyse(after).warnings, prob(after, 50, by="closed-form").warnings):
        assert said in [notice.message for notice in notices if notice.code == "W366"]


@pytest.mark.parametrize(
    "overrides",
    [
        [("strength.clay.phi", 30), ("correlation", {"clay.c/clay.phi": 0.3})],
        [("correlation", {"clay.c/clay.psi": 0.3})],
    ],
)
def test_a_correlation_that_is_set_itself_is_still_refused(overrides) -> None:
    with pytest.raises(DesignError) as caught:
        load(SCATTER, overrides)
    assert {fault.code for fault in caught.value.faults} == {"E168"}


def test_a_file_that_was_wrong_before_stays_refused(tmp_path) -> None:
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text(SCATTER.read_text().replace("clay.phi/rough.phi", "clay.phi/rouhg.phi"))
    with pytest.raises(DesignError) as caught:
        load(wrong, [("strength.clay.phi", 30)])
    assert "E168" in {fault.code for fault in caught.value.faults}
