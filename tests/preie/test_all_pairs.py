"""The paper's criterion against closed forms, and for one block in both of its writings."""

import math

import numpy as np
import pytest

from slopekit.preie.motion.all_pairs import all_pairs_failed, blocks_detached
from slopekit.preie.motion.settlement import settlement
from slopekit.preie.system.contact import JointStiffness
from tests.preie.sections import block_in_space, columns, paper_wedge, stack, wall

EVEN = JointStiffness(tangential=1e6)
PAPER = JointStiffness()


def tan(degrees: float) -> float:
    return math.tan(math.radians(degrees))


@pytest.mark.parametrize(
    ("sticking", "detached"),
    [
        ([True, True, True], [False, False, False]),
        ([False, True, True], [True, True, True]),
        ([True, False, True], [False, True, True]),
        ([True, True, False], [False, False, True]),
    ],
)
def test_a_block_is_tied_by_a_chain_to_bedrock(sticking, detached) -> None:
    """Three blocks on top of each other: what lies above a contact that slips is detached."""
    assert blocks_detached(stack(3, 20.0, 35.0), np.array(sticking)).tolist() == detached


@pytest.mark.parametrize(
    ("count", "limit"),
    [
        (1, None),
        (4, None),
        (1, tan(35.0) / tan(20.0)),
        (12, tan(35.0) / tan(20.0)),
    ],  # far slower without a limit
    ids=["1, no limit", "4, no limit", "1, limit", "12, limit"],
)
@pytest.mark.parametrize("stiffness", [EVEN, PAPER], ids=["constant", "clough-duncan"])
def test_blocks_on_an_incline_come_untied_where_they_slide(count: int, stiffness, limit) -> None:
    """F = tan φ / tan β: even slip, every contact at once, and no equilibrium above."""
    found = all_pairs_failed(
        stack(count, 20.0, 35.0, width=3.0 * count), stiffness, limit, relative=1e-6
    )
    assert found.factor == pytest.approx(tan(35.0) / tan(20.0), rel=2e-6)
    low, high = found.bracket
    assert low < high <= low * (1.0 + 1e-6)


def test_a_block_in_space_on_an_incline() -> None:
    """The same, with a friction force for every node pair; pairs differ only by their slip, which is nearly even."""
    exact = tan(35.0) / tan(20.0)
    found = all_pairs_failed(block_in_space(20.0, 35.0, height=0.05), EVEN, exact, relative=1e-6)
    assert found.factor == pytest.approx(exact, rel=1e-3)
    assert found.factor <= exact


@pytest.mark.parametrize(
    ("stiffness", "near"), [(PAPER, 1.5539), (JointStiffness(tangential=4e6), 1.10)]
)
def test_one_block_is_the_papers_criterion(stiffness, near: float) -> None:
    """Table 4's wedge as one block and as an assembly of one; 1.10 is METHOD.md's, to 2 %."""
    assembly, model = paper_wedge()
    ours = all_pairs_failed(assembly, stiffness, 1.5573963)
    theirs = all_pairs_failed(model, stiffness)
    assert ours.factor == pytest.approx(theirs.factor, rel=1e-4)
    assert ours.factor == pytest.approx(near, rel=2e-2)
    assert not ours.lost_equilibrium


def test_columns_that_slide_come_untied_before_the_rest_topples() -> None:
    """Columns 1 to 3 slide in the closed form; the others turn about their edges, or stand, and stick."""
    found = all_pairs_failed(columns(), EVEN, 0.99996)
    assert found.factor < 0.99996
    assert not found.lost_equilibrium
    at_rest = settlement(columns(), EVEN, found.factor)
    assert blocks_detached(columns(), ~at_rest.slips).tolist() == 3 * [True] + 13 * [False]


def test_nothing_is_looked_for_above_the_limit() -> None:
    """A limit factor that is given ends the search: a block that tips sticks to the end."""
    found = all_pairs_failed(stack(1, 40.0, 60.0, width=1.0), EVEN, 1.0)
    assert found.lost_equilibrium
    assert found.factor == 1.0
    assert max(factor for factor, _ in found.history) < 1.0


def test_a_wall_comes_untied_from_block_to_block() -> None:
    """Running bond on 20° at φ = 35°: it slides as a whole at tan φ / tan β, after single blocks have slipped."""
    exact = tan(35.0) / tan(20.0)
    found = all_pairs_failed(wall(5, 4), PAPER, exact)
    assert 1.0 < found.factor < exact
    assert not found.lost_equilibrium
