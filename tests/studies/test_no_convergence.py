"""Where PRE-IE does not converge a study says so, refuses no input, and ends with 4: what it asks may be there."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.errors import DesignError
from slopekit.design.templates import path_of
from slopekit.kinds import factors_of
from slopekit.kinds.assemblies import many_blocks
from slopekit.kinds.protocol import Factors
from slopekit.kinds.single_block.ladders import Rung
from slopekit.studies import points
from slopekit.studies.check import run as checking
from slopekit.studies.combos import run as combos
from slopekit.studies.outcomes import ByMethod
from slopekit.studies.points import Point
from slopekit.studies.quake import yielding
from slopekit.studies.roots import Sample
from slopekit.studies.running import ALONE
from slopekit.studies.solve import factor_request
from slopekit.studies.solve import run as solving
from tests.commands import slopekit
from tests.studies.test_solve_load import _slab

PHI = "strength.joint.phi"  # of the slab: F = tan φ / tan 20°, 1 at 20


def without_a_number(
    monkeypatch, low: float, high: float, code: str = "not_converged", message: str = ""
) -> None:
    """PRE-IE does not converge, or the input is refused, between two values of a key."""
    own = factor_request.FactorRequest.samples

    def samples(self, method, values):
        return [
            replace(one, level=None, label=code, evaluation=Point(None, code, message))
            if low < one.place < high
            else one
            for one in own(self, method, values)
        ]

    monkeypatch.setattr(factor_request.FactorRequest, "samples", samples)


@pytest.mark.slow
def test_a_target_among_values_at_which_pre_ie_does_not_converge(monkeypatch) -> None:
    without_a_number(monkeypatch, 18.0, 22.0)
    found = sk.solve(_slab(), PHI, fos=1.0)
    assert found.answer is None
    assert found.reason.code == "E319"
    assert found.reason.message.endswith(", where PRE-IE did not converge")
    assert found.reason.advice == f"Fewer or larger blocks, or a narrower range: {PHI}=lo:hi."
    assert found.exit_code == 4
    assert "refused" not in str(found).lower()
    assert "UNSETTLED" in str(found.sheet)
    assert "not_converged" not in str(found)
    (stretch,) = found.to_dict()["pre_ie"]["refused"]
    assert (stretch["code"], stretch["message"]) == ("not_converged", "PRE-IE did not converge")


@pytest.mark.slow
def test_an_input_that_is_refused_is_no_lack_of_convergence(monkeypatch) -> None:
    without_a_number(monkeypatch, 18.0, 22.0, "E113", "it looks like radians")
    found = sk.solve(_slab(), PHI, fos=1.0)
    assert found.reason.message.endswith(", where the input is refused: E113 it looks like radians")
    assert "REFUSED" in str(found.sheet)
    assert "UNSETTLED" not in str(found.sheet)
    assert found.exit_code == 1


@pytest.mark.slow
@pytest.mark.parametrize(
    ("low", "target", "code", "said"),
    [
        (50.0, 90.0, "E315", "; from 5"),  # what is known ends there
        (-1.0, 9.0, "E318", "gives a block with a factor: PRE-IE did not converge"),
    ],
)
def test_what_was_not_computed_is_no_proof(monkeypatch, low, target, code, said) -> None:
    without_a_number(monkeypatch, low, 91.0)
    found = sk.solve(_slab(), f"{PHI}=10:80", fos=target)
    assert found.reason.code == code
    assert said in found.reason.message
    assert (" PRE-IE did not converge: it may lie there" in found.reason.message) == (
        code == "E315"
    )
    assert found.exit_code == 4


def test_a_sweep_that_meets_no_convergence_ends_with_four(monkeypatch) -> None:
    factors = Factors("not_converged", None, None, None, None, False, False)
    monkeypatch.setattr(points, "factors_of", lambda *_: factors)
    assert sk.sweep(_slab(), {PHI: [20.0, 30.0]}).exit_code == 4
    assert Point(factors).is_in_doubt
    assert not Point(Factors("slides", 1.2, None, None, None, None, False)).is_in_doubt


def test_a_motion_that_did_not_settle_has_no_factor(monkeypatch) -> None:
    assert factors_of(_slab()).limit is not None
    monkeypatch.setattr(many_blocks, "LIMIT_SETTLED", -1.0)
    lost = factors_of(_slab())
    assert (lost.status, lost.limit) == ("not_converged", None)
    assert Point(lost).is_in_doubt


def test_a_search_that_leads_nowhere_finds_no_coefficient() -> None:
    """Where the level is the same everywhere there is no root, nor where it lies beyond what a coefficient may be."""
    for level, root in ((lambda k: 0.5 - k, 0.5), (lambda _: 0.3, None), (lambda k: 5.0 - k, None)):
        request = SimpleNamespace(
            samples=lambda _, ks, level=level: [Sample(k, level(k), "", None) for k in ks]
        )
        found = yielding._root(request, "pre_ie", 0.2)
        assert found == (None if root is None else pytest.approx(root, rel=1e-12))


def test_an_earthquake_on_a_slope_without_a_factor(monkeypatch) -> None:
    monkeypatch.setattr(
        points,
        "factors_of",
        lambda *_: Factors("not_converged", None, None, None, None, False, False),
    )
    with pytest.raises(
        DesignError, match="without an earthquake: PRE-IE did not converge"
    ) as error:
        yielding.check_stands(_slab())
    assert (error.value.codes, error.value.exit_code) == (("E520",), 4)


def test_no_k_is_found_where_pre_ie_does_not_converge(monkeypatch) -> None:
    """It is not said that no earthquake moves the blocks; a sound input is not refused."""
    monkeypatch.setattr(solving, "load_path_end", lambda _: None)
    without_a_number(monkeypatch, 0.01, 10.0)
    with pytest.raises(DesignError) as error:
        yielding.yields_of(_slab(), ALONE, lambda _: None)
    assert error.value.exit_code == 4


def test_the_command_ends_as_the_study_does(monkeypatch) -> None:
    """A wall of blocks whose friction angle is looked for: exit 4 and the reason in its words, not refused input."""
    without_a_number(monkeypatch, 0.0, 91.0)
    done = slopekit("solve", "templates/blocks.yaml", f"{PHI}=20:40", "--fos", "1.5")
    assert done.returncode == 4
    assert "gives a block with a factor: PRE-IE did not converge" in " ".join(done.stdout.split())


# -- no answer is never compared with a target -------------------------------------------------------------------------


def test_a_block_that_slides_without_a_factor_fails() -> None:
    """Closed forms over many samples: not a number reaches no target, whichever way it is compared."""
    factor, outcome = np.array([1.5, 1.4, np.nan, np.nan]), np.array([0, 0, 0, 1])
    names = ("slides_on_both", "no_driving_force")
    assert ByMethod(names, outcome, factor).falls_short(1.5).tolist() == [False, True, True, False]


def test_a_pair_without_convergence_is_not_among_those_that_stand() -> None:
    """The worst come first: what has no factor before what slides at 3, and that before what stands."""
    limit = ByMethod.from_words(
        ("no_driving_force", "not_converged", "slides_on_both"), [None, None, 3.0]
    )
    assert combos._rank_order(limit, np.ones(3)).tolist() == [1, 2, 0]


def test_a_mesh_without_a_factor_is_no_convergence() -> None:
    """0 in place of a factor made a number that is none, which no comparison found off."""
    design = sk.load(path_of("wedge"))
    result = sk.run(design)
    rungs = tuple(Rung("mesh", "", 10**k, None, factor, 0.0) for k, factor in ((4, 1.5), (5, 0.0)))
    said = checking._convergence(result, rungs, "")
    assert (said.met, said.value) == (False, None)
