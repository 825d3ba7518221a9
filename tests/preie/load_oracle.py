"""Judges of blocks under a load that is too much: what a slow history carries of it, and whether nothing could help.

`comes_on` brings the weight on first and the other loads after it, a little at a time, on the joints of
`path_oracle.history`. `tips_whatever_the_strength` checks by hand and by a linear program (HiGHS) that a motion is that
of a limit state under a part of the loads in which nothing slips where forces act: it is one at any greater strength.
"""

from dataclasses import replace

import numpy as np
from scipy.optimize import linprog

from slopekit.preie.system.assembly import AssemblyModel
from tests.preie.path_oracle import Joints, arrays_of, in_parts_of_blocks, unmoved

_STIFFNESS = 0.4  # k_t / k_n
_STEPS, _LEAST = 10, 2e-3  # of the loads: a step, and the shortest
_OF_FASTEST = 1e-6  # opening or slip that is none
_OUT_OF_BALANCE = 1e-6  # of a block's load


def comes_on(model: AssemblyModel, strength: float, cohesion: np.ndarray | None = None) -> float:
    """The part of the loads beside weight and water that is on when the blocks last come to rest; 0: none is.

    Joints are those of `path_oracle.history`, with slip that stays, at a strength λ. Every part is brought to rest by
    viscous flow from the rest before; where that runs, by a step half as long.
    """
    given, live = arrays_of(model), model.live.ravel()
    bonds, weight = given.cohesion if cohesion is None else cohesion, given.load - live
    state, part, step, first = unmoved(given), 0.0, 1.0 / _STEPS, True
    while first or part < 1.0:
        trial = 0.0 if first else min(1.0, part + step)
        joints = Joints(replace(given, load=weight + trial * live), bonds, _STIFFNESS)
        found, how, _, _ = joints.rest(state, strength, onward=True)
        if how == "rests":
            state, part, first = found, trial, False
        elif first or step < _LEAST:
            break
        else:
            step /= 2.0
    return part


def tips_whatever_the_strength(
    model: AssemblyModel, motion: np.ndarray, part: float, strength: float
) -> bool:
    """Whether a motion (n, u) is that of a limit state at a part of the live loads, at a strength λ and at all above.

    It opens contacts or leaves them closed and pushes none; the live loads drive it. Node pairs that it opens carry
    nothing, nor do those that slip; on all others there are forces N >= 0, |T| <= λ r, in balance with the loads. As
    nothing slips that carries a force, more friction or cohesion changes none of that.
    """
    given = in_parts_of_blocks(
        replace(arrays_of(model), load=(model.load - (1.0 - part) * model.live).ravel())
    )
    plain, v = arrays_of(model), motion.ravel()
    opening, slip = (
        plain.normal @ v,
        np.abs(plain.slip @ v).reshape(-1, plain.directions).max(axis=1),
    )
    least = _OF_FASTEST * max(float(np.abs(opening).max()), float(slip.max()))
    if opening.min() < -least or model.live.ravel() @ v <= 0.0 or not 0.0 < part < 1.0:
        return False
    held = slip <= least
    closed = (opening <= least) & held[given.group]
    pairs, groups = len(given.area), len(given.friction)
    balance = np.hstack([given.normal.T, given.slip.T])
    sums = np.zeros((groups, pairs))
    sums[given.group, np.arange(pairs)] = strength * given.friction[given.group]
    bonds, one = strength * given.of_groups(given.cohesion * closed), np.eye(groups)
    column, none = np.ones((len(balance), 1)), np.zeros((groups, 1))
    found = linprog(
        np.append(np.zeros(pairs + groups), 1.0),
        np.vstack(
            [
                np.hstack([balance, -column]),
                np.hstack([-balance, -column]),
                np.hstack([-sums, one, none]),
                np.hstack([-sums, -one, none]),
            ]
        ),
        np.concatenate([-given.load, given.load, bonds, bonds]),
        bounds=[(0.0, None if at else 0.0) for at in closed]
        + [(None, None) if at else (0.0, 0.0) for at in held]
        + [(0.0, None)],
    )
    return bool(found.status == 0 and found.fun < _OUT_OF_BALANCE)
