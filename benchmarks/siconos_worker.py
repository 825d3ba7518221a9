"""Runs in the interpreter that has Siconos: is a pile of blocks at rest at a factor, and bisection on it.

``python3 siconos_worker.py problem.npz ORDERS``, orders as JSON: `about` (the answer), `bracket` and `steps` of the
bisection, its `width`, the `budget` in seconds. It prints one JSON line a check.

One implicit Euler step from rest (unit time): M v = P + Bᵀ r with Signorini's and Coulomb's laws between v and r,
solved by non-smooth Gauss-Seidel (Acary & Brogliato) from where the check before ended. The blocks stand where no
acceleration is left. Cohesion moves the tips of the cones by c A / tan φ: pairs may pull that much, here only.
"""

import json
import sys
import time
import warnings

import numpy as np
import scipy.sparse as sp
import siconos.numerics as sn

_MOST_ITERATIONS = 100_000
_PRECISE = 1e-3  # of the wanted width: the tolerance of a check
_TIGHTER = 6  # times a tenth of it, where something moves
_STAYS = 0.1  # an acceleration that changes by less is one
_MOVES = 0.1  # of the wanted width: an acceleration in parts of g that is no rest


class Pile:
    """The Delassus operator of a problem, made once; masses do not matter to rest, weights are taken."""

    def __init__(self, path):
        held = np.load(path)
        matrix = sp.csr_matrix(
            (held["data"], held["indices"], held["indptr"]), tuple(held["shape"])
        )
        load, self.tan_friction = held["load"], held["tan_friction"]
        blocks, unknowns = load.shape
        translations = 2 if unknowns == 3 else 3
        self.dimension = matrix.shape[0] // len(self.tan_friction)
        squares = np.asarray(matrix.multiply(matrix).sum(axis=0)).reshape(blocks, unknowns)
        self.mass = np.repeat(
            np.sqrt((load[:, :translations] ** 2).sum(axis=1))[:, None], unknowns, axis=1
        )
        self.mass[:, translations:] *= (
            squares[:, translations:] / squares[:, :translations].mean(axis=1)[:, None]
        )
        self.mass = self.mass.ravel()
        pull = np.zeros(matrix.shape[0])
        pull[:: self.dimension] = held["cohesion"] / self.tan_friction
        self.matrix, self.load = matrix, load.ravel() - matrix.T @ pull
        light = matrix @ sp.diags(1.0 / self.mass)
        delassus = (light @ matrix.T).tocsc()
        delassus.indices, delassus.indptr = (
            delassus.indices.astype(np.int64),
            delassus.indptr.astype(np.int64),
        )
        self.kept = delassus  # Siconos keeps pointers into it
        built = sn.SBM_from_csparse(self.dimension, delassus)
        self.operator = built[1] if isinstance(built, (tuple, list)) else built
        self.free = light @ self.load
        self.forces = np.zeros(len(self.free))

    def check(self, factor, width):
        """Whether it stands, whether that is settled, the largest acceleration left.

        An acceleration that goes away with the tolerance is the solver's, not the pile's.
        """
        problem = sn.FrictionContactProblem(
            self.dimension, self.operator, self.free, self.tan_friction / factor
        )
        flat = self.dimension == 2
        options = sn.SolverOptions(
            sn.SICONOS_FRICTION_2D_NSGS if flat else sn.SICONOS_FRICTION_3D_NSGS
        )
        solve = sn.fc2d_nsgs_sbm if flat else sn.fc3d_nsgs
        before = np.inf
        for digit in range(_TIGHTER):
            options.iparam[0], options.dparam[0] = _MOST_ITERATIONS, _PRECISE * width / 10.0**digit
            failed = solve(problem, self.forces, np.zeros(len(self.free)), options)
            moves = float(np.abs((self.matrix.T @ self.forces + self.load) / self.mass).max())
            stands, stays = moves < _MOVES * width, abs(moves - before) < _STAYS * moves
            if stands or stays or failed:
                break
            before = moves
        return stands, bool((stands or stays) and not failed), moves


def told(**facts):
    print(json.dumps(facts), flush=True)


def main(path, about, bracket, width, steps, budget):
    began = time.perf_counter()
    pile = Pile(path)
    told(setup_s=time.perf_counter() - began)

    def checked(factor):
        start = time.perf_counter()
        stands, settled, moves = pile.check(factor, width)
        seconds = time.perf_counter() - start
        told(factor=factor, stands=stands, settled=settled, moves=moves, seconds=seconds)
        return stands, seconds

    spent = 0.0
    for beside in (1.0 - width, 1.0 + width):
        _, seconds = checked(beside * about)
        spent += seconds
    if spent / 2 * steps > budget:
        return
    pile.forces[:] = 0.0
    low, high = bracket
    for _ in range(steps):
        middle = (low * high) ** 0.5
        stands, _ = checked(middle)
        low, high = (middle, high) if stands else (low, middle)
    told(done=True, found=(low * high) ** 0.5)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    main(sys.argv[1], **json.loads(sys.argv[2]))
