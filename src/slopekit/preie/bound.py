"""The static bound: the largest F at which *some* admissible forces balance the loads.

It is the limit of joints that dilate by their whole (reduced) friction angle and keep their cohesion: an upper bound
on the limit factor, unsafe as an answer. Its dual: the largest λ = 1/F for which a velocity v exists with

    v_n >= λ tan φ |v_t|  on every pair,     P·v + λ (bolts drawn out) >= λ Σ c A |v_t|.

Both sides are used: a mechanism proposes λ, and forces that balance the loads at that λ prove it.
"""

import math
from dataclasses import dataclass

import numpy as np

from slopekit.arrays import Floats
from slopekit.preie.linear import bounded_least_squares
from slopekit.preie.model import Model

_MOST_STEPS = 40
_FEWEST_STEPS = 4  # trials without which no bracket closes
_MOST_WORK = 30_000  # trials times node pairs: some seconds of Clarabel
_CONIC_WIDTH = 1e-7  # the bracket of λ, in parts of it
_BEYOND = 1e3  # times the limit: joints that dilate lock the block, there is no bound worth a number
_BALANCED = 1e-9  # a shortfall this small, in parts of the load, is none
_PROVED = 1e-9
_TANGENT = 1e-9  # opening below this part of the slip is none


@dataclass(frozen=True, slots=True)
class StaticBound:
    """The bound (None: not found), whether a mechanism and forces prove it, the work done.

    `velocity` (u,) is its mechanism and `normal_force` (n,) what the pairs carry in it.
    """

    factor: float | None
    proved: bool
    steps: int
    velocity: Floats
    normal_force: Floats


def static_bound(model: Model, velocity: Floats, limit: float, of_its_motion: bool = True) -> StaticBound:
    """The static bound of a model whose limit factor and mechanism are known.

    Parameters
    ----------
    velocity : (u,) the limit mechanism; limit : the limit factor, a lower bound of the static bound
    of_its_motion : the limit counts all cohesion that its motion calls on; where it does not, as on a cracked base,
        its motion says nothing of the bound
    """
    if not of_its_motion:
        return _conic_bound(model, velocity, limit)
    if not model.tan_friction.any():
        slip = float(model.slip(velocity).max())
        if float(np.abs(model.normal_rows @ velocity).max()) <= _TANGENT * slip:
            # no friction, and nothing opens: the limit's mechanism is the bound's, and its forces balance
            return StaticBound(limit, True, 0, velocity, np.zeros(len(model.control_area)))
    if not len(model.bolt_capacity):
        flat = _one_plane_bound(model, velocity, limit)
        if flat is not None:
            return flat
        translating = _two_joint_bound(model, velocity, limit)
        if translating is not None:
            return translating
    return _conic_bound(model, velocity, limit)


def _one_plane_bound(model: Model, velocity: Floats, limit: float) -> StaticBound | None:
    """A block that slides on one plane without turning: its normal force is given, and the bound is the limit.

    Dilation does not help there: with v_n = λ tan φ |v_t| the load works N λ tan φ |v_t| less, which is what friction
    would have taken. The forces are proved to balance, with their moments.
    """
    most = model.translations
    normals = model.normal_rows[:, :most]
    turning = float(np.abs(velocity[most:]).max(initial=0.0))
    if np.abs(normals - normals[0]).max() > 1e-12 or turning > 1e-9 or len(np.unique(model.interface)) > 1:
        return None
    normal_force = _balancing(model, velocity[:most], 1.0 / limit)
    if normal_force is None:
        return None
    return StaticBound(limit, True, 0, velocity, normal_force)


def _two_joint_bound(model: Model, velocity: Floats, limit: float) -> StaticBound | None:
    """Both joints of a wedge opening along their friction cones without turning: three equations, then the proof."""
    normals, which = np.unique(model.normal_rows[:, :3].round(12), axis=0, return_index=True)
    if len(normals) != 2 or model.translations != 3:
        return None
    rows = model.rows[which, :, :3]
    tan_friction = model.tan_friction[which]
    cohesion = np.array([model.cohesion[model.interface == model.interface[k]].sum() for k in which])
    load = model.load[:3]
    v, reduction = velocity[:3] / math.sqrt(float(velocity[:3] @ velocity[:3])), 1.0 / limit
    steps = 0
    while steps < _MOST_STEPS:
        steps += 1
        motion = rows @ v
        slip = np.sqrt((motion[:, 1:] ** 2).sum(axis=1))
        if slip.min() <= 1e-12:
            return None
        slip_slope = np.einsum("kt,ktu->ku", motion[:, 1:] / slip[:, None], rows[:, 1:, :])
        out = np.array([
            *(motion[:, 0] - reduction * tan_friction * slip),
            float(load @ v) - reduction * float(cohesion @ slip),
            (float(v @ v) - 1.0) / 2.0,
        ])  # fmt: skip
        if np.abs(out).max() < 1e-14:
            break
        matrix = np.zeros((4, 4))
        matrix[:2, :3] = rows[:, 0, :] - (reduction * tan_friction)[:, None] * slip_slope
        matrix[:2, 3] = -tan_friction * slip
        matrix[2, :3] = load - reduction * (cohesion @ slip_slope)
        matrix[2, 3] = -float(cohesion @ slip)
        matrix[3, :3] = v
        try:
            step = -np.linalg.solve(matrix, out)
        except np.linalg.LinAlgError:
            return None
        v, reduction = v + step[:3], reduction + float(step[3])
    else:
        return None
    if not 0.0 < reduction <= (1.0 + _PROVED) / limit:
        return None
    normal_force = _balancing(model, v, reduction)
    if normal_force is None:
        return None
    return StaticBound(1.0 / reduction, True, steps, np.concatenate([v, np.zeros(model.unknowns - 3)]), normal_force)


def _balancing(model: Model, v: Floats, reduction: float) -> Floats | None:
    """Normal forces that balance the loads with their moments, shear on the edge of every friction cone against v."""
    motion = np.einsum("ntu,u->nt", model.rows[:, 1:, : len(v)], v)
    direction = motion / np.sqrt((motion * motion).sum(axis=1))[:, None]
    against = np.einsum("nt,ntu->nu", direction, model.rows[:, 1:, :])
    columns = model.normal_rows - (reduction * model.tan_friction)[:, None] * against
    target = -model.load + (reduction * model.cohesion) @ against
    normal_force, rest = bounded_least_squares(columns.T, target, np.full(len(columns), np.inf))
    return normal_force if float(np.abs(rest).max()) < _PROVED else None


def _conic_bound(model: Model, velocity: Floats, limit: float) -> StaticBound:
    """The least λ at which second-order cones of forces balance the loads: Newton in a bracket, with Clarabel.

    Each trial asks for the least t >= -1 such that N >= 0, |f_t| <= λ (c A + N tan φ) + t a and Bᵀ f + P = 0 (bolts
    pull with 0 to λ times their capacity); t <= 0 means they balance. The limit's own forces do: λ <= 1/limit.
    """
    most = min(_MOST_STEPS + 40, _MOST_WORK // len(model.control_area))
    if most < _FEWEST_STEPS:  # so many cones would take minutes
        return StaticBound(None, False, 0, velocity, np.zeros(len(model.control_area)))
    program = _ConicProgram(model)
    low, high = 0.0, 1.0 / limit
    best, steps, mechanism = program.solve(high), 1, velocity
    if best is None or best.shortfall > 1e-6:
        return StaticBound(None, False, steps, velocity, np.zeros(len(model.control_area)))
    guess, step = best.root(high), 0.9
    while high - low > _CONIC_WIDTH * high and steps < most:
        if not low < guess < high:
            guess = 0.5 * (low + high) if low > 0.0 else high * step
            step *= step
        # a guess at an end of the bracket closes in on it from the other side
        near = 0.3 * _CONIC_WIDTH * guess
        trial_at = min(guess + near, 0.5 * (guess + high)) if guess - low < near else guess
        trial_at = max(guess - near, 0.5 * (guess + low)) if high - guess < near else trial_at
        trial = program.solve(trial_at)
        steps += 1
        if trial is None:
            break
        if trial.shortfall <= _BALANCED:
            high, best = trial_at, trial
            if high * limit * _BEYOND < 1.0:
                break
        else:
            low, mechanism = trial_at, trial.velocity
        guess = trial.root(trial_at)
    if high * limit * _BEYOND < 1.0 or high - low > 10.0 * _CONIC_WIDTH * high:
        return StaticBound(None, False, steps, mechanism, best.normal_force)
    return StaticBound(max(1.0 / high, limit), True, steps, mechanism, best.normal_force)


@dataclass(frozen=True, slots=True)
class _Trial:
    """The shortfall t at a λ, its slope dt/dλ from the multipliers, the mechanism (u,) and the normal forces (n,)."""

    shortfall: float
    slope: float
    velocity: Floats
    normal_force: Floats

    def root(self, reduction: float) -> float:
        """Where Newton expects t = 0; not a number above 0 where the slope says nothing."""
        return reduction - self.shortfall / self.slope if self.slope < 0.0 else 0.0


class _ConicProgram:
    """The program of `_conic_bound`; only its right-hand side and one column entry a pair depend on λ."""

    def __init__(self, model: Model) -> None:
        from scipy import sparse  # only a bound that moments govern pays for SciPy and Clarabel

        self.model = model
        count, bolts, unknowns = len(model.control_area), len(model.bolt_capacity), model.unknowns
        width = 3 * count + bolts + 1
        balance = sparse.hstack(
            [
                sparse.csc_matrix(model.flat_rows.T),
                sparse.csc_matrix(model.bolt_rows.T),
                sparse.csc_matrix((unknowns, 1)),
            ]
        )
        pairs = np.arange(count)
        signs = sparse.csc_matrix(
            (np.full(count + 2 * bolts + 1, -1.0) * np.concatenate([np.ones(count + bolts), -np.ones(bolts), [1.0]]),
             (np.arange(count + 2 * bolts + 1),
              np.concatenate([3 * pairs, 3 * count + np.arange(bolts), 3 * count + np.arange(bolts), [width - 1]]))),
            shape=(count + 2 * bolts + 1, width),
        )  # fmt: skip
        rows = np.concatenate([3 * pairs, 3 * pairs, 3 * pairs + 1, 3 * pairs + 2])
        columns = np.concatenate([3 * pairs, np.full(count, width - 1), 3 * pairs + 1, 3 * pairs + 2])
        self.cone_shape = (rows, columns, (3 * count, width))
        self.top = sparse.vstack([balance, signs])
        self.cost = np.zeros(width)
        self.cost[-1] = 1.0
        self.none = sparse.csc_matrix((width, width))

    def solve(self, reduction: float) -> _Trial | None:
        """Least shortfall at a λ, or None where Clarabel gives up."""
        import clarabel
        from scipy import sparse

        model = self.model
        count, bolts, unknowns = len(model.control_area), len(model.bolt_capacity), model.unknowns
        rows, columns, shape = self.cone_shape
        values = np.concatenate(
            [-reduction * model.tan_friction, -model.control_area, np.full(count, -1.0), np.full(count, -1.0)]
        )
        cone_right = np.zeros(3 * count)
        cone_right[::3] = reduction * model.cohesion
        matrix = sparse.vstack([self.top, sparse.csc_matrix((values, (rows, columns)), shape=shape)]).tocsc()
        right = np.concatenate(
            [-model.load, np.zeros(count + bolts), reduction * model.bolt_capacity, [1.0], cone_right]
        )
        cones = [clarabel.ZeroConeT(unknowns), clarabel.NonnegativeConeT(count + 2 * bolts + 1)]
        cones += [clarabel.SecondOrderConeT(3)] * count
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        found = clarabel.DefaultSolver(self.none, self.cost, matrix, right, cones, settings).solve()
        forces, duals = np.array(found.x), np.array(found.z)
        velocity = duals[:unknowns]
        velocity = velocity if float(velocity @ model.load) > 0.0 else -velocity
        if str(found.status).endswith("PrimalInfeasible"):  # no shear, however strong: bolts have to hold it down
            return _Trial(math.inf, 0.0, velocity, np.zeros(count))
        if not str(found.status).endswith("olved"):
            return None
        normal = np.maximum(forces[: 3 * count : 3], 0.0)
        of_cones = duals[unknowns + count + 2 * bolts + 1 :][::3]
        of_bolts = duals[unknowns + count + bolts : unknowns + count + 2 * bolts]
        slope = -float(of_cones @ (model.cohesion + model.tan_friction * normal) + of_bolts @ model.bolt_capacity)
        return _Trial(float(found.obj_val), slope, velocity, normal)
