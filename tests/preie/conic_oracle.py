"""Another solver for the same questions: SciPy matrices and Clarabel's interior point method, bisection on F."""

import math

import clarabel
import numpy as np
import scipy.sparse as sp

from slopekit.preie.system.model import Model
from tests.preie.bisection import around


def solve(model: Model, elastic: float, top: np.ndarray, right: np.ndarray, fixed: np.ndarray):
    """Minimise x_last + elastic energy over pair forces in cones |f_t| <= right + (top, fixed)·(N, x_last), in balance.

    Parameters
    ----------
    top, right, fixed : (n,) cone of pair k: right_k + top_k N_k + fixed_k x_last
    """
    count, unknowns = len(model.control_area), model.unknowns
    width = 3 * count + 1
    balance = np.hstack([model.flat_rows.T, np.zeros((unknowns, 1))])
    push = np.zeros((count + 1, width))
    push[np.arange(count), 3 * np.arange(count)] = push[count, -1] = -1.0  # N >= 0, x_last >= -1
    rows, bounds = [balance, push], [-model.load, np.append(np.zeros(count), 1.0)]
    cones = [clarabel.ZeroConeT(unknowns), clarabel.NonnegativeConeT(count + 1)]
    for k in range(count):
        cone = np.zeros((3, width))
        cone[0, 3 * k], cone[0, -1] = -top[k], -fixed[k]
        cone[1, 3 * k + 1] = cone[2, 3 * k + 2] = -1.0
        rows.append(cone)
        bounds.append(np.array([right[k], 0.0, 0.0]))
        cones.append(clarabel.SecondOrderConeT(3))
    cost = np.append(np.zeros(width - 1), 1.0)
    energy = sp.diags(np.append(np.repeat(elastic / model.control_area, 3), 0.0)).tocsc()
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    matrix = sp.csc_matrix(np.vstack(rows))
    return clarabel.DefaultSolver(
        energy, cost, matrix, np.concatenate(bounds), cones, settings
    ).solve()


def shortfall(model: Model, reduction: float) -> float:
    """Least t such that forces within t of the reduced friction cones balance the loads (0 or less: they balance)."""
    cohesion, tan_friction = reduction * model.cohesion, reduction * model.tan_friction
    return float(solve(model, 0.0, tan_friction, cohesion, model.control_area).obj_val)


def static_bound(model: Model, near: float | None = None, parts: float = 1e-7) -> float:
    """The largest F at which admissible forces balance the loads, by bisection, at `near` first."""

    def stands(factor: float) -> bool:
        return shortfall(model, 1.0 / factor) <= 1e-10

    low, high = around(stands, near, parts) or (1e-4, 1e4)
    while high > low * (1.0 + parts):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if stands(middle) else (low, middle)
    return low


def frozen_friction_limit(model: Model, passes: int = 60) -> float:
    """METHOD.md §4, conic sequence with every bond whole: friction frozen at the normal forces of the last pass."""
    normal, factor = model.control_area, 0.0
    nothing = np.zeros(len(normal))
    for _ in range(passes):
        strength = model.cohesion + model.tan_friction * normal
        found = np.array(solve(model, 1e-6, nothing, nothing, strength).x)
        if abs(1.0 / found[-1] - factor) < 1e-9 * factor:
            break
        factor, normal = 1.0 / found[-1], np.maximum(found[:-1:3], 0.0)
    return factor


def sparse_shortfall(model: Model, reduction: float) -> float:
    """`shortfall` for some hundred pairs and passive bolts (0 to λ of their capacity): the same program, sparse."""
    count, bolts, unknowns = len(model.control_area), len(model.bolt_capacity), model.unknowns
    width, pairs = 3 * count + bolts + 1, np.arange(count)
    balance = sp.hstack(
        [
            sp.csc_matrix(model.flat_rows.T),
            sp.csc_matrix(model.bolt_rows.T),
            sp.csc_matrix((unknowns, 1)),
        ]
    )
    bounded = np.concatenate([3 * pairs, 3 * count + np.arange(bolts), [width - 1]])
    push = sp.csc_matrix(
        (-np.ones(len(bounded)), (np.arange(len(bounded)), bounded)), (len(bounded), width)
    )
    weak = sp.csc_matrix(
        (np.ones(bolts), (np.arange(bolts), 3 * count + np.arange(bolts))), (bolts, width)
    )
    at = (
        np.concatenate([3 * pairs, 3 * pairs, 3 * pairs + 1, 3 * pairs + 2]),
        np.concatenate([3 * pairs, np.full(count, width - 1), 3 * pairs + 1, 3 * pairs + 2]),
    )
    values = np.concatenate(
        [-reduction * model.tan_friction, -model.control_area, -np.ones(2 * count)]
    )
    cone_right = np.zeros(3 * count)
    cone_right[::3] = reduction * model.cohesion
    right = [
        -model.load,
        np.append(np.zeros(count + bolts), 1.0),
        reduction * model.bolt_capacity,
        cone_right,
    ]
    cones = [clarabel.ZeroConeT(unknowns), clarabel.NonnegativeConeT(len(bounded) + bolts)]
    cones += [clarabel.SecondOrderConeT(3)] * count
    matrix = sp.vstack(
        [balance, push, weak, sp.csc_matrix((values, at), (3 * count, width))]
    ).tocsc()
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    cost = np.append(np.zeros(width - 1), 1.0)
    none = sp.csc_matrix((width, width))
    found = clarabel.DefaultSolver(
        none, cost, matrix, np.concatenate(right), cones, settings
    ).solve()
    return math.inf if "Infeasible" in str(found.status) else float(found.obj_val)


def sparse_static_bound(
    model: Model, low: float, parts: float = 1e-7, near: float | None = None
) -> float:
    """The static bound at or above a factor that is known to stand, by bisection, at `near` first."""

    def stands(factor: float) -> bool:
        return sparse_shortfall(model, 1.0 / factor) <= 1e-9

    if (sides := around(stands, near, parts)) is None:
        high = low
        while stands(high):
            low, high = high, 1.2 * high
        sides = low, high
    low, high = sides
    while high > low * (1.0 + parts):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if stands(middle) else (low, middle)
    return low
