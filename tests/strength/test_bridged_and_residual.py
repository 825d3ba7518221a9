"""Rock bridges by persistence, and residual strength, against the same strengths typed as c and φ."""

import math

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.errors import DesignError
from slopekit.strength.bridged import Bridged
from tests.strength.test_keys import KINDS, WEDGE

BRIDGED = {
    "law": "bridged",
    "c": "10 kPa",
    "phi": 30,
    "c_rock": "2 MPa",
    "phi_rock": 45,
    "persistence": "97 %",
}
#: Jennings by hand: 0.97 * 10 + 0.03 * 2000, and 0.97 tan 30° + 0.03 tan 45°.
COHESION, TANGENT = 69.7, 0.97 / math.sqrt(3.0) + 0.03
LINE = {"c": COHESION, "phi": math.degrees(math.atan(TANGENT))}
INCLINED = {
    **KINDS["blocks"],
    "blocks": {
        "base": {"polygon": [[0, 0], [2, 1], [2, -1], [0, -1]], "fixed": True},
        "B1": {"polygon": [[0, 0], [2, 1], [1.8, 1.4], [-0.2, 0.4]]},
    },
}
SCENES = {**KINDS, "blocks": INCLINED}
PLANE = {**KINDS["plane"], "crack": {"distance": "2 m"}, "water": {"fill": "50 %"}}


def run(design, strength, **more):
    """The result of a design with one strength."""
    return sk.run({**design, "strength": {"joint": strength}, **more})


def test_jennings_by_hand() -> None:
    """Jennings (1970): both parts of the strength weighted by their areas."""
    found = Bridged(10.0, 30.0, 2000.0, 45.0, 0.97).resistance(np.array([-1.0, 0.0, 100.0]))
    assert found == pytest.approx([COHESION, COHESION, COHESION + 100.0 * TANGENT], rel=1e-14)
    assert Bridged(10.0, 30.0, 2000.0, 45.0, 1.0).straight.friction_angle_deg == pytest.approx(
        30.0, rel=1e-14
    )
    assert Bridged(10.0, 30.0, 2000.0, 45.0, 0.0).straight.cohesion_kpa == 2000.0


@pytest.mark.parametrize("kind", ["wedge", "plane", "footing", "blocks"])
def test_a_bridged_joint_is_the_line_that_it_makes(kind) -> None:
    """The same factors as with that c and φ, by both methods, on kinds of one block and of many."""
    one, other = run(SCENES[kind], BRIDGED), run(SCENES[kind], LINE)
    assert one.status == other.status
    assert one.fos.limit == pytest.approx(other.fos.limit, rel=1e-9)
    assert one.fos.static_bound == pytest.approx(other.fos.static_bound, rel=1e-6)
    assert (one.fos.closed_form or 0.0) == pytest.approx(other.fos.closed_form or 0.0, rel=1e-12)
    assert "bridged: 97 %" in " ".join(str(one.sheet).split())


def test_waves_on_a_bridged_joint() -> None:
    """They add their tangent to its line."""
    waves = math.degrees(math.atan(TANGENT + math.tan(math.radians(5.0))))
    one, other = run(WEDGE, {**BRIDGED, "waviness": 5}), run(WEDGE, {"c": COHESION, "phi": waves})
    assert one.fos.limit == pytest.approx(other.fos.limit, rel=1e-8)


@pytest.mark.parametrize(
    "design", [WEDGE, PLANE, KINDS["footing"], INCLINED], ids=lambda one: one["kind"]
)
@pytest.mark.parametrize("peak", [{"c": 60, "phi": 40}, BRIDGED], ids=["line", "bridged"])
def test_both_factors_are_those_of_two_runs(design, peak) -> None:
    """The residual factors of both methods are those of the design with the residual strength as its only one."""
    left = {"c": 5, "phi": 25}
    found, alone = run(design, {**peak, "dilation": 3, "residual": left}), run(design, left)
    assert found.fos.limit == run(design, {**peak, "dilation": 3}).fos.limit
    left = found.comparisons.residual
    assert (left.limit, left.closed_form) == (
        alone.fos.limit,
        alone.fos.closed_form,
    )
    assert left.agree == alone.agree
    assert found.to_dict()["residual"]["limit"] == alone.fos.limit
    assert str(found.sheet).count("residual strength") >= (1 if alone.fos.limit is None else 2) - (
        alone.fos.closed_form is None
    )
    assert "residual" not in alone.to_dict()


def test_what_the_peak_alone_meets() -> None:
    """W417 where the rule on the limit is met and the residual factor breaks it; `fos.residual` judges that itself."""
    strength = {"c": 50, "phi": 35, "residual": {"c": 0, "phi": 20}}
    found = run(WEDGE, strength, acceptance={"rules": ["fos >= 1.5"]})
    assert found.accepted
    assert "W417" in [notice.code for notice in found.warnings]
    strict = run(WEDGE, strength, acceptance={"rules": ["fos >= 1.5", "fos.residual >= 1.2"]})
    assert strict.accepted is False
    assert strict.exit_code == 1
    lower = run(WEDGE, strength, acceptance={"rules": ["fos >= 0.5"]})
    assert "W417" not in [notice.code for notice in lower.warnings]


def test_a_residual_factor_above_the_peak_is_said() -> None:
    """W417: a curved law cannot be held against c and φ when it is read, its factors can."""
    law = {"law": "barton-bandis", "jrc": 4, "jcs": "20 MPa", "phi_r": 22}
    found = run(WEDGE, {**law, "residual": {"c": 0, "phi": 50}})
    assert "W417" in [notice.code for notice in found.warnings]


@pytest.mark.parametrize(
    ("strength", "code"),
    [
        ({"c": 10, "phi": 30, "residual": {"c": 20, "phi": 25}}, "E453"),
        ({"c": 10, "phi": 30, "residual": {"c": 0, "phi": 31}}, "E453"),
        ({"c": 10, "phi": 30, "residual": {"c": 0}}, "E143"),
        ({"c": 10, "phi": 30, "residual": {"c": 0, "phi": 90}}, "E115"),
        ({"c": 10, "phi": 30, "residual": {"c": 0, "phi": 20, "psi": 1}}, "E142"),
        ({"c": 10, "phi": 30, "residual": 20}, "E144"),
        ({**BRIDGED, "persistence": 1.2}, "E127"),
        ({**BRIDGED, "c_rock": -1}, "E114"),
        ({"law": "bridged", "c": 1, "phi": 30, "persistence": 0.9}, "E143"),
        ({"c": 10, "phi": 30, "persistence": 0.9}, "E142"),
    ],
)
def test_faults(strength, code) -> None:
    """What is wrong is said by its code."""
    with pytest.raises(DesignError) as found:
        run(WEDGE, strength)
    assert code in found.value.codes


def test_the_residual_factors_agree_on_forces_alone_where_moments_govern_them() -> None:
    """A wedge half full of water: its two residual factors differ, and the sheet says what of them was compared."""
    strength = {"c": 10, "phi": 28, "residual": {"c": 5, "phi": 26}}
    joints = {"J1": {"plane": "45/130"}, "J2": {"plane": "60/220"}}
    slope = {"face": "65/180", "upper": "5/180", "height": 15}
    found = run(WEDGE | {"slope": slope, "joints": joints, "water": "50%"}, strength)
    left = found.comparisons.residual
    assert left.agree
    assert left.moments_govern
    assert left.limit < 0.99 * left.closed_form
    row = str(found.sheet).partition("residual strength, PRE-IE")[2]
    assert " ".join(row.split()).startswith("AGREE on forces alone within")
