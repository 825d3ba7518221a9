"""How fast several blocks gain on shaken ground, from the equation of motion on their springs.

Nothing of `motion.seismic_gain` is asked but the mass: implicit Euler, contacts open and slip as the springs say. The
law is holonomic (no memory of slip), which a push that never turns round does not notice.
"""

from typing import Any

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.design.common import Design
from slopekit.design.reading.files import with_values
from slopekit.kinds import cut
from slopekit.kinds.assemblies.many_blocks_scene import scene_loads
from slopekit.kinds.assemblies.many_blocks_states import gyration
from slopekit.kinds.solver_inputs import joint_strength
from slopekit.preie.elastic_path.contact_model import ElasticContactModel
from slopekit.preie.elastic_path.contact_states import Drive
from slopekit.preie.elastic_path.flow import viscous_relaxation
from slopekit.preie.many_blocks.ravelling import critical_load
from slopekit.preie.motion.seismic_gain import mass_of

_KEY = "loads.seismic.k"
_STEP = 10.0  # times the period of a spring: they follow and do not ring
_NEARER = (
    0.0,
    0.5,
    0.9,
    0.99,
    0.999,
)  # parts of the load at which the blocks are brought to rest before
_MOST = 60


def rate_above(design: Design, block: str, above: float, steps: int = 100) -> float:
    """Acceleration of the centroid of a block (a name) per unit of k, so much above k_y, from the equation of motion.

    Raises
    ------
    RuntimeError
        Where a step does not settle.
    """
    without, unit = (with_values(design, {_KEY: k}) for k in (0.0, 1.0))
    scene = cut(without)
    first, second = scene_loads(scene), scene_loads(cut(unit))
    ramp = (second.forces - first.forces, second.moments - first.moments)
    found = critical_load(scene.assembly, first, ramp, joint_strength(scene.strengths), 1.0)
    assert found is not None
    multiplier, failure = found
    part = failure.parts[0]
    model, load = part.model, multiplier + above
    blocks = mass_of(model, first.weights, gyration(scene))
    count, size = model.load.shape
    mass = np.zeros((count * size, count * size))
    for k, one in enumerate(blocks):
        mass[k * size : (k + 1) * size, k * size : (k + 1) * size] = one
    bed = ElasticContactModel(
        model, Drive(model.load.ravel(), model.live.ravel(), 1.0), part.limit.bond
    )
    at: Floats = bed.elastic_displacement
    for share in _NEARER:
        at = viscous_relaxation(bed, at, share * multiplier, 0.0, runs_at=1e3).displacement
    which = model.moving.tolist().index(scene.names.index(block))
    moves = slice(which * size, which * size + (2 if size == 3 else 3))
    velocity, speeds = np.zeros(count * size), []
    for _ in range(steps):
        velocity = _stepped(bed, mass, at, velocity, load)
        at = at + _STEP * velocity
        speeds.append(float(np.linalg.norm(velocity[moves])))
    half = steps // 2
    return (speeds[-1] - speeds[half]) / (_STEP * (steps - 1 - half)) / above


def _stepped(
    bed: ElasticContactModel, mass: Floats, at: Floats, before: Floats, load: float
) -> Floats:
    """Velocity at the end of a step."""

    def unbalanced(velocity: Floats) -> tuple[Any, Floats]:
        there = bed.forces(at + _STEP * velocity, load)
        return there, mass @ (velocity - before) / _STEP - there.unbalanced

    velocity = before
    there, out = unbalanced(velocity)
    for _ in range(_MOST):
        size = float(np.abs(out).max())
        if size <= max(1e-9, there.rounding):
            return velocity
        stiffness = bed.stiffness.dense(bed.tangent(there, load))
        way, length = -np.linalg.solve(mass / _STEP + _STEP * stiffness, out), 1.0
        while True:
            trial = velocity + length * way
            there, out = unbalanced(trial)
            if float(np.abs(out).max()) < size * (1.0 - 0.1 * length) or length < 1e-3:
                break
            length *= 0.5
        velocity = trial
    raise RuntimeError(f"a step did not settle: {size:g}")
