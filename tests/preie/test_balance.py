"""The evidence of a limit: what its node-pair forces are worth, seen from outside."""

from dataclasses import replace

import numpy as np
import pytest

import slopekit as sk
from slopekit.kinds import cut
from slopekit.kinds.wedge.design import wedge_design
from slopekit.preie.many_blocks.blocks import limit_of_blocks
from slopekit.preie.motion.balance import balance_of_assembly, balances_of_block, worst_balance
from slopekit.preie.one_block.pairs_limit import pairs_limit
from tests.preie.block_scenes import wall

TURNING = {
    "dips": ("40/160", "80/220"),
    "face": "65/180",
    "upper": "0/180",
    "height": 10,
    "c": 20,
    "phi": 30,
}
SCENES = {
    "slides on both": {"dips": ("45/115", "45/245")},
    "turns": TURNING,
    "passive bolt": {"dips": ("45/115", "45/245"), "water": "full", "bolts": "2e5@000/0,passive"},
    "dilates": {"dips": ("45/115", "45/245"), "dilation": 10},
    "one joint leaves": {
        "dips": ("45/105", "70/235"),
        "face": "65/185",
        "upper": "12/195",
        "water": (290, 0),
    },
}


@pytest.mark.parametrize("name", SCENES)
def test_forces_balance_and_are_admissible(name) -> None:
    """To rounding where a state was solved exactly, to the settling of the passes (1e-7) elsewhere."""
    balance = sk.wedge(**SCENES[name]).limit_state.balance
    assert max(balance.force, balance.moment) < 1e-8
    assert balance.admissible_within(1e-7)


@pytest.fixture
def solved():
    model = cut(wedge_design(SCENES["turns"])).scene_at(1).model
    return model, pairs_limit(model)


@pytest.mark.parametrize(
    ("change", "figure"),
    [
        (lambda limit: replace(limit, normal_force=limit.normal_force * 1.01), "force"),
        (lambda limit: replace(limit, friction=limit.friction * 1.01), "friction_excess"),
        (
            lambda limit: replace(
                limit, normal_force=limit.normal_force - 2.0 * limit.normal_force.max()
            ),
            "pull",
        ),
        (lambda limit: replace(limit, factor=limit.factor * 1.01), "friction_excess"),
    ],
    ids=["more normal force", "more friction", "pulls", "less strength"],
)
def test_wrong_forces_are_seen(solved, change, figure) -> None:
    """One per cent off in any of them shows as a part of a per cent of the load or more."""
    model, analysis = solved
    wrong = change(analysis.governing)
    seen = worst_balance(
        balances_of_block(model, replace(analysis, governing=wrong, with_turning=wrong))
    )
    assert getattr(seen, figure) > 1e-4


def test_a_couple_is_seen_as_a_moment(solved) -> None:
    model, analysis = solved
    normal = analysis.governing.normal_force.copy()
    pressed = np.argsort(normal)[-2:]
    normal[pressed] += np.array([0.01, -0.01])  # the same push elsewhere
    wrong = replace(analysis.governing, normal_force=normal)
    assert (
        worst_balance(
            balances_of_block(model, replace(analysis, governing=wrong, with_turning=wrong))
        ).moment
        > 1e-4
    )


def test_many_blocks() -> None:
    """Running bond that slides as one: balanced to the settling of Newton; one per cent of friction more is seen."""
    scene = wall(4, 5)
    model = scene.model(35.0)
    limit = limit_of_blocks(model)
    forces = limit.normal_force, limit.friction
    found = worst_balance([balance_of_assembly(model, limit.factor, *forces, limit.bond)])
    assert max(found.force, found.moment, found.friction_excess, found.pull) < 1e-6
    more = worst_balance(
        [balance_of_assembly(model, limit.factor, forces[0], 1.01 * forces[1], limit.bond)]
    )
    assert more.friction_excess > 1e-3
    assert more.force > 1e-3
    assert worst_balance([]) is None
