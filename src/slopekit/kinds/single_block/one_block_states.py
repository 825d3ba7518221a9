"""One block in arrays: its node pairs with the model made of them, and its answer as results have it.

Contact modes of node pairs, loads as arrows, displacements at strength reduction factors, the mechanism in true
proportions.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from slopekit.block_scene import OPEN, SLIP, STICK, Arrows, NodePairState
from slopekit.core.arrays import Bools, Floats, NDArray, frozen
from slopekit.evidence import Movement, ReductionStep
from slopekit.geometry.interfaces import NodePairs
from slopekit.loads import Loads
from slopekit.preie.motion.equilibrium import Equilibrium, equilibrium
from slopekit.preie.outcome import Limit, Outcome, opens
from slopekit.preie.system.contact import JointStiffness
from slopekit.preie.system.model import Model, local_axes

CLOSED = 1e-9  # normal force below this part of the largest is none
SLIPS = 1e-4  # slip beyond this part of the fastest motion is slip
_RISES = 1e-6  # a unit motion
#: Joints that a block slides on, by the sum of 1 for J1, 2 for J2, 4 for a basal joint; of two, the same but for 3.
_JOINTS = ("J2", "J1", "J2", "J1_and_J2", "basal", "J1_and_basal", "J2_and_basal")


@dataclass(frozen=True)
class Bedding:
    """The flat contacts of a block, for pairs of another kind on them.

    Attributes
    ----------
    polygons : interface -> (k, 3) corners in m, or (2, 3) ends of a line in a section; centroid : (3,) of the block
    model_of : the model on other node pairs
    """

    polygons: Mapping[int, Floats]
    centroid: Floats
    model_of: Callable[[NodePairs], Model]

    @property
    def size_m(self) -> float:
        """Root mean square distance of the corners from the centroid."""
        arms = np.concatenate(list(self.polygons.values())) - self.centroid
        return math.sqrt(float((arms * arms).sum()) / len(arms))

    def scene(self, pairs: NodePairs) -> "ContactModel":
        """The scene of node pairs on these contacts."""
        return ContactModel(pairs, self.model_of(pairs), self)


@dataclass(frozen=True)
class ContactModel:
    """Node pairs and the model made of them; `bedding` where the contacts are flat."""

    pairs: NodePairs
    model: Model
    bedding: Bedding | None = None


def opening_pairs(limit: Limit, model: Model, velocity: Floats, by_motion: bool = False) -> Bools:
    """Which node pairs the mechanism opens beyond what dilation opens, or has opened: (n,); `by_motion` the first."""
    reduced = model.tan_friction / limit.factor if limit.factor else np.zeros_like(model.tan_friction)
    is_open = opens(model, velocity, np.minimum(model.tan_dilation, reduced))
    return is_open if by_motion else is_open | (limit.bond == 0.0)


def pair_state(
    pairs: NodePairs, model: Model, limit: Limit, interfaces: Sequence[int], origin: Floats, axes: Floats
) -> NodePairState:
    """The node pairs of one block at the limit, in the user's axes; without a limit state they carry nothing.

    Parameters
    ----------
    interfaces : their ids, in the order of the result's joints
    origin : (3,) of the local axes; axes : (3, 3) rows are the local axes in those of the user
    """
    velocity = limit.velocity
    slip = model.slip(velocity)
    none = limit.normal_force <= CLOSED * max(float(limit.normal_force.max(initial=0.0)), 1e-300)
    opened = (opening_pairs(limit, model, velocity) if velocity.any() else none) | none
    is_known = limit.factor is not None or limit.outcome is Outcome.NO_DRIVING_FORCE
    normal = limit.normal_force * model.force_scale if is_known else np.zeros(len(pairs))
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
    loads: Loads, names: Mapping[str, str], origin: Floats, axes: Floats, pulls: Floats | None = None
) -> Arrows:  # fmt: skip
    """The loads on one block, in the user's axes; `names` are other names for some of them.

    Parameters
    ----------
    pulls : (b,) kN of the passive bolts at the limit; None where there is none, and their full capacity is given
    """
    acting = [(names.get(name, name), force, point) for name, force, point in loads.acting]
    first = len(acting) - len(loads.passive_forces)  # passive bolts come last
    for k, capacity in enumerate(loads.passive_forces):
        name, _, point = acting[first + k]
        if pulls is None:
            acting[first + k] = (f"{name}, full capacity", capacity, point)
        else:
            acting[first + k] = (name, pulls[k] * (capacity / math.sqrt(float(capacity @ capacity))), point)
    count = len(acting)
    return Arrows(
        tuple(name for name, _, _ in acting), np.arange(count), np.zeros(count, dtype=np.int64),
        frozen(np.reshape([force for _, force, _ in acting], (count, 3)) @ axes),
        frozen(np.reshape([point for _, _, point in acting], (count, 3)) @ axes + origin),
    )  # fmt: skip


def series_of(
    model: Model, factors: Sequence[float], stiffness: JointStiffness, bound: float | None, axes: Floats
) -> Iterator[ReductionStep]:
    """Rest at each factor, from one to the next; above the static bound there is none to look for."""
    last_rest: Equilibrium | None = None
    count = len(model.control_area)
    for factor in factors:
        if bound is not None and factor > bound * (1.0 + 1e-7):
            yield ReductionStep(factor, False, None, count)
            continue
        state = equilibrium(model, factor, stiffness, last_rest)
        if state.stands:
            last_rest = state
        movement = rigid_movement(model, state.displacement, axes) if state.stands else None
        yield ReductionStep(factor, state.stands, movement, state.failed_pairs if state.stands else count)


def rigid_movement(model: Model, displacement: Floats, axes: Floats) -> Movement:
    """A displacement (u,) of the model in m and radians, in the user's axes."""
    translation, rotation = model.moved(displacement)
    return Movement(frozen(translation @ axes), frozen(rotation @ axes))


def failure_mechanism(limit: Limit, model: Model, axes: Floats) -> Movement | None:
    """The mechanism in true proportions: displacement of the centroid in m, rotation in radians, largest size 1."""
    if limit.outcome in (Outcome.NO_DRIVING_FORCE, Outcome.NOT_CONVERGED) or not limit.velocity.any():
        return None
    displacement, rotation = model.moved(limit.velocity)
    rotation = rotation / model.length_scale
    size = math.sqrt(float(displacement @ displacement)) or model.length_scale * math.sqrt(float(rotation @ rotation))
    return Movement(frozen(displacement @ axes / size), frozen(rotation @ axes / size))


def motion_statuses(
    velocity: Floats, translations: int, partly: Bools, wholly: Bools, normal: Floats
) -> NDArray[np.str_]:
    """Return the statuses (n,) of blocks that slide or turn.

    Parameters
    ----------
    velocity : (n, u) unit motions, `translations` first, turns times the size of a block
    partly, wholly : (n, k) joints of which they open a part, and all of it; normal : (n, k) forces on them, or none
    """
    count, closed = len(normal[0]), ~wholly & np.isfinite(normal)
    moving, turning = ((motion * motion).sum(axis=1) for motion in np.split(velocity, [translations], axis=1))
    carries = np.where(closed, normal, -np.inf).argsort(axis=1, kind="stable")[:, ::-1][:, :2]  # of three joints two
    names = np.array(["slides_on_" + ("both" if count == 2 and k == 3 else joints) for k, joints in enumerate(_JOINTS)])
    joints = (2**carries * np.take_along_axis(closed, carries, axis=1)).sum(axis=1)
    slides = np.where(
        velocity[:, translations - 1] > _RISES, "slides_up", names[joints if count > 1 else np.ones_like(joints)]
    )
    return np.where(partly.any(axis=1) | (turning > moving), "rotates", slides)
