"""The paper's criterion for many blocks against closed forms and against its search for one block."""

import math

import numpy as np
import pytest

from slopekit.arrays import frozen
from slopekit.preie.contact import JointStiffness
from slopekit.preie.reduction import all_pairs_failed
from slopekit.preie.rest import AtRest, RestOutcome
from slopekit.preie.untied import all_blocks_untied, blocks_untied
from tests.preie.sections import block_in_space, columns, paper_wedge, stack, wall

EVEN = JointStiffness(tangential=1e6)
PAPER = JointStiffness()


def tan(degrees: float) -> float:
    return math.tan(math.radians(degrees))


@pytest.mark.parametrize(("sticking", "untied"), [
    ([True, True, True], [False, False, False]),
    ([False, True, True], [True, True, True]),
    ([True, False, True], [False, True, True]),
    ([True, True, False], [False, False, True]),
])  # fmt: skip
def test_a_block_is_tied_by_a_chain_to_bedrock(sticking, untied) -> None:
    """Three blocks on top of each other: what lies above a contact that slips is untied."""
    model = stack(3, 20.0, 35.0)
    none, pairs = np.zeros(3), np.zeros(6)
    sticks = np.array(sticking)
    state = AtRest(
        RestOutcome.STANDS, 1.0, frozen(np.zeros((3, 3))), frozen(pairs), frozen(none[:, None]), pairs > 0.0,
        pairs == 0.0, sticks, ~sticks, 0.0, 0, 0, frozen(np.zeros((3, 3))),
    )  # fmt: skip
    assert blocks_untied(model, state).tolist() == untied
    assert state.failed == sticking.count(False)


@pytest.mark.parametrize(
    ("count", "limit"),
    [(1, None), (4, None), (1, tan(35.0) / tan(20.0)), (12, tan(35.0) / tan(20.0))],  # far slower without a limit
    ids=["1, no limit", "4, no limit", "1, limit", "12, limit"],
)
@pytest.mark.parametrize("stiffness", [EVEN, PAPER], ids=["constant", "clough-duncan"])
def test_blocks_on_an_incline_come_untied_where_they_slide(count: int, stiffness, limit) -> None:
    """F = tan φ / tan β: even slip, every contact at once, and no equilibrium above."""
    found = all_blocks_untied(stack(count, 20.0, 35.0, width=3.0 * count), stiffness, limit, 1e-6)
    assert found.factor == pytest.approx(tan(35.0) / tan(20.0), rel=2e-6)
    assert found.all_factor == pytest.approx(tan(35.0) / tan(20.0), rel=2e-6)
    low, high = found.bracket
    assert low < high <= low * (1.0 + 1e-6)


def test_a_block_in_space_on_an_incline() -> None:
    """The same, with a friction force for every node pair; pairs differ only by their slip, which is nearly even."""
    found = all_blocks_untied(block_in_space(20.0, 35.0, height=0.05), EVEN, tan(35.0) / tan(20.0), 1e-6)
    assert found.all_factor == pytest.approx(tan(35.0) / tan(20.0), rel=1e-3)
    assert found.all_factor <= tan(35.0) / tan(20.0)


@pytest.mark.parametrize(("stiffness", "near"), [(PAPER, 1.5539), (JointStiffness(tangential=4e6), 1.10)])
def test_one_block_is_the_papers_criterion(stiffness, near: float) -> None:
    """Table 4's wedge: `reduction.all_pairs_failed` to its own bracket; 1.10 is METHOD.md's, to 2 %."""
    assembly, model = paper_wedge()
    ours = all_blocks_untied(assembly, stiffness, 1.5573963, 1e-5)
    theirs = all_pairs_failed(model, stiffness)
    assert ours.factor == pytest.approx(theirs.factor, rel=2e-5)
    assert ours.factor == pytest.approx(near, rel=2e-2)
    assert ours.factor == ours.all_factor
    assert not ours.lost_equilibrium
    assert ours.untied.tolist() == [True]
    assert ours.untied_at[0] == ours.factor


def test_columns_that_slide_come_untied_and_those_that_topple_fall() -> None:
    """Columns 1 to 3 slide in the closed form; the others turn about their edges, or stand, and stick.

    Relaxation (test_rest) has the end between 1.015 and 1.03, above the limit of 0.99996.
    """
    found = all_blocks_untied(columns(), EVEN)
    assert found.untied.tolist() == 3 * [True] + 13 * [False]
    assert found.factor < 0.99996
    assert not found.lost_equilibrium
    assert found.all_lost_equilibrium
    assert 1.015 < found.all_factor < 1.03
    assert np.isinf(found.untied_at[4:]).all()


def test_nothing_is_looked_for_above_the_limit() -> None:
    """A limit factor that is given ends the search, although elastic columns would stand a little more."""
    found = all_blocks_untied(columns(), EVEN, 0.99996)
    assert found.all_lost_equilibrium
    assert found.all_factor == 0.99996
    assert found.history[-1][0] <= 0.99996


def test_a_wall_comes_untied_from_block_to_block() -> None:
    """Running bond on 20° at φ = 35°: it slides as a whole at tan φ / tan β, after single blocks have slipped."""
    exact = tan(35.0) / tan(20.0)
    found = all_blocks_untied(wall(5, 4), PAPER, exact)
    assert found.factor is not None
    assert 1.0 < found.factor < exact
    assert not found.lost_equilibrium
    assert 0 < found.untied.sum() < len(found.untied)
    assert found.all_factor == pytest.approx(exact, rel=1e-4)
    assert (found.untied_at[found.untied] <= found.factor).all()
