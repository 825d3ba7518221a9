"""The limit state of one block as pictures and files have it: node pairs by contact mode, loads as arrows."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from slopekit.arrays import Bools, Floats, frozen
from slopekit.block_scene import OPEN, SLIP, STICK, Arrows, NodePairState
from slopekit.geometry.interfaces import NodePairs
from slopekit.loads import Loads
from slopekit.preie.model import Model, local_axes
from slopekit.preie.passes import Limit, Outcome

TURNS = 1e-5  # opening beyond this part of the slip counts as opening
CLOSED = 1e-9  # normal force below this part of the largest is none
SLIPS = 1e-4  # slip beyond this part of the fastest motion is slip


def opening_pairs(limit: Limit, model: Model, velocity: Floats, by_motion: bool = False) -> Bools:
    """Which node pairs the mechanism opens beyond what dilation opens, or has opened: (n,); `by_motion` the first."""
    opening, slip = model.relative(velocity)[:, 0], model.slip(velocity)
    if model.dilates and limit.factor:
        opening = opening - np.minimum(model.tan_dilation, model.tan_friction / limit.factor) * slip
    opens: Bools = opening > TURNS * max(float(slip.max()), float(opening.max()))
    if not by_motion:
        opens |= limit.bond == 0.0
    return opens


def pair_state(
    pairs: NodePairs, model: Model, limit: Limit, interfaces: Sequence[int], origin: Floats, turn: Floats | None
) -> NodePairState:
    """The node pairs of one block at the limit, in the user's axes; without a limit state they carry nothing.

    Parameters
    ----------
    interfaces : their ids, in the order of the result's joints
    origin : (3,) of the local axes; turn : (3, 3) rows are the local axes in those of the user
    """
    axes = np.eye(3) if turn is None else turn
    velocity = limit.velocity_of(model)
    slip = model.slip(velocity)
    none = limit.normal_force <= CLOSED * max(float(limit.normal_force.max(initial=0.0)), 1e-300)
    opened = (opening_pairs(limit, model, velocity) if velocity.any() else none) | none
    known = limit.factor is not None or limit.outcome is Outcome.NO_DRIVING_FORCE
    normal = limit.normal_force * model.force_scale if known else np.zeros(len(pairs))
    mode = np.where(opened, OPEN, np.where(slip > SLIPS * max(float(slip.max()), 1e-300), SLIP, STICK))
    shear = np.zeros((len(pairs), 3))
    if limit.friction is not None:
        shear = np.einsum("nt,ntx->nx", limit.friction, local_axes(pairs.normals)[:, 1:]) * model.force_scale
    index = {key: k for k, key in enumerate(interfaces)}
    return NodePairState(
        frozen(pairs.points @ axes + origin), np.array([index[key] for key in pairs.interface.tolist()]),
        pairs.control_areas, frozen(pairs.normals @ axes), pairs.plus, pairs.minus,
        frozen(normal), frozen(shear @ axes), mode.astype(np.int64),
    )  # fmt: skip


def arrows(
    loads: Loads, names: Mapping[str, str], origin: Floats, turn: Floats | None, pulls: Floats | None = None
) -> Arrows:  # fmt: skip
    """The loads on one block, in the user's axes; `names` are other names for some of them.

    Parameters
    ----------
    pulls : (b,) kN of the passive bolts at the limit; None where there is none, and their full capacity is given
    """
    axes = np.eye(3) if turn is None else turn
    acting = [(names.get(name, name), force, at) for name, force, at in loads.acting]
    first = len(acting) - len(loads.passive_forces)  # passive bolts come last
    for k, capacity in enumerate(loads.passive_forces):
        name, _, at = acting[first + k]
        if pulls is None:
            acting[first + k] = (f"{name}, full capacity", capacity, at)
        else:
            unit = capacity / math.sqrt(float(capacity @ capacity))
            acting[first + k] = (name, pulls[k] * unit, at)
    count = len(acting)
    return Arrows(
        tuple(name for name, _, _ in acting), np.arange(count), np.zeros(count, dtype=np.int64),
        frozen(np.reshape([force for _, force, _ in acting], (count, 3)) @ axes),
        frozen(np.reshape([at for _, _, at in acting], (count, 3)) @ axes + origin),
    )  # fmt: skip
