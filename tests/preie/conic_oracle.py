"""Another solver for the same questions: SciPy matrices and Clarabel's interior point method, bisection on F."""

import math

import clarabel
import numpy as np
import scipy.sparse as sp

from slopekit.preie.model import Model


def shortfall(model: Model, reduction: float) -> float:
    """Least t such that forces within t of the reduced friction cones balance the loads (0 or less: they balance)."""
    count, unknowns = len(model.control_area), model.unknowns
    width = 3 * count + 1
    balance = np.hstack([model.flat_rows.T, np.zeros((unknowns, 1))])
    push = np.zeros((count, width))
    push[np.arange(count), 3 * np.arange(count)] = -1.0
    floor = np.zeros((1, width))
    floor[0, -1] = -1.0
    rows, right, cones = [balance, floor, push], [-model.load, [1.0], np.zeros(count)], []
    cones = [clarabel.ZeroConeT(unknowns), clarabel.NonnegativeConeT(1), clarabel.NonnegativeConeT(count)]
    for k in range(count):
        cone = np.zeros((3, width))
        cone[0, 3 * k], cone[0, -1] = -reduction * model.tan_friction[k], -model.control_area[k]
        cone[1, 3 * k + 1] = cone[2, 3 * k + 2] = -1.0
        rows.append(cone)
        right.append([reduction * model.cohesion[k], 0.0, 0.0])
        cones.append(clarabel.SecondOrderConeT(3))
    cost = np.zeros(width)
    cost[-1] = 1.0
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    solver = clarabel.DefaultSolver(
        sp.csc_matrix((width, width)), cost, sp.csc_matrix(np.vstack(rows)), np.concatenate(right), cones, settings
    )
    return float(solver.solve().obj_val)


def static_bound(model: Model) -> float:
    """The largest F at which admissible forces balance the loads, by bisection."""
    low, high = 1e-4, 1e4
    for _ in range(48):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if shortfall(model, middle) <= 1e-10 else (middle, high)
    return 1.0 / high


def frozen_friction_limit(model: Model, passes: int = 60) -> float:
    """METHOD.md §4, conic sequence with every bond whole: friction frozen at the normal forces of the last pass."""
    count, unknowns = len(model.control_area), model.unknowns
    width = 3 * count + 1
    normal = model.control_area.copy()
    balance = np.hstack([model.flat_rows.T, np.zeros((unknowns, 1))])
    push = np.zeros((count, width))
    push[np.arange(count), 3 * np.arange(count)] = -1.0
    elastic = sp.diags(np.append(np.repeat(1e-6 / model.control_area, 3), 0.0)).tocsc()
    factor = 0.0
    for _ in range(passes):
        rows, right = [balance, push], [-model.load, np.zeros(count)]
        cones = [clarabel.ZeroConeT(unknowns), clarabel.NonnegativeConeT(count)]
        for k, strength in enumerate(model.cohesion + model.tan_friction * normal):
            cone = np.zeros((3, width))
            cone[0, -1] = -strength
            cone[1, 3 * k + 1] = cone[2, 3 * k + 2] = -1.0
            rows.append(cone)
            right.append(np.zeros(3))
            cones.append(clarabel.SecondOrderConeT(3))
        cost = np.zeros(width)
        cost[-1] = 1.0
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        solver = clarabel.DefaultSolver(
            elastic, cost, sp.csc_matrix(np.vstack(rows)), np.concatenate(right), cones, settings
        )
        found = np.array(solver.solve().x)
        renewed = np.maximum(found[:-1:3], 0.0)
        if abs(1.0 / found[-1] - factor) < 1e-9 * factor:
            break
        factor, normal = 1.0 / found[-1], renewed
    return factor
