"""Frozen friction and the static bound by a general conic solver (Clarabel): no line in common but the matrix B."""

import math
import time
from dataclasses import dataclass

import clarabel
import numpy as np
import scipy.sparse as sp

from slopekit.preie.system.assembly import AssemblyModel
from tests.preie.bisection import around


@dataclass(frozen=True)
class Found:
    """What Clarabel says: minimiser, its cost, seconds in the solver, and steps."""

    status: str
    load_factor: float
    shed: float
    normal: np.ndarray
    friction: np.ndarray
    cost: float
    seconds: float
    steps: int


class FrozenFriction:
    """Minimise λ + M σ + ε/2 fᵀ C f over N >= 0, σ >= 0, |T| <= λ r + t (Σ N - N̂) with Bᵀ f + (1 - σ) P = 0.

    All but r, t and N̂ is made once: a sequence of passes solves it again and again.
    """

    def __init__(self, model: AssemblyModel, elastic: float = 0.0, most_load: float = 1e3) -> None:
        self.program = program = _Program(model, 2)
        load = model.load.ravel()
        self.balance = sp.hstack(
            [model.statics, sp.csc_matrix((len(load), 1)), sp.csc_matrix(-load[:, None])]
        )
        areas = program.by_group @ model.control_area
        give = np.concatenate(
            [1.0 / model.control_area, np.repeat(1.0 / areas, program.width), [0.0, 0.0]]
        )
        self.energy = sp.diags(elastic * give).tocsc()
        self.most_load = most_load

    def solved(self, strength, dilation=0.0, reference=0.0, tolerance: float = 1e-8) -> Found:
        """The minimiser for strengths (g,) r, dilations t and their reference N̂ (arrays, or one for all)."""
        program = self.program
        strength, dilation, reference = (
            np.asarray(part) * np.ones(program.groups) for part in (strength, dilation, reference)
        )
        cost = np.append(np.zeros(program.unknowns - 2), [1.0, self.most_load])
        top = sp.hstack(
            [
                sp.diags(dilation) @ program.by_group,
                program.none,
                sp.csc_matrix(strength[:, None]),
                sp.csc_matrix((program.groups, 1)),
            ]
        )
        found = program.solved(
            self.energy, cost, self.balance, top, -dilation * reference, 0.0, tolerance
        )
        x = np.array(found.x)
        return Found(
            str(found.status),
            float(x[-2]),
            float(x[-1]),
            x[: program.pairs],
            x[program.pairs : -2].reshape(-1, program.width),
            float(found.obj_val),
            float(found.solve_time),
            int(found.iterations),
        )


@dataclass(frozen=True)
class Sequence:
    """A sequence of passes: its last factor, whether it settled, passes, and seconds in all and in each."""

    factor: float
    settled: bool
    passes: int
    seconds: float
    each: tuple[float, ...]


def conic_sequence(
    model: AssemblyModel,
    parts: float = 1e-4,
    steady: int = 3,
    most: int = 40,
    tolerance: float = 1e-8,
    elastic: float = 1e-6,
) -> Sequence:
    """METHOD.md §4, plainly: friction frozen at the normal forces of the last pass until the factor stays.

    Parameters
    ----------
    parts, steady : it has settled when so many factors lie within this part
    """
    began = time.perf_counter()
    program = FrozenFriction(model, elastic)
    normal, factors, each = model.control_area, [], []
    while len(factors) < most:
        at = time.perf_counter()
        strength = model.by_group(model.cohesion) + model.tan_friction * model.by_group(normal)
        found = program.solved(strength, tolerance=tolerance)
        each.append(time.perf_counter() - at)
        normal = np.maximum(found.normal, 0.0)
        factors.append(1.0 / found.load_factor)
        recent = factors[-steady:]
        if len(recent) == steady and max(recent) - min(recent) < parts * max(recent):
            break
    settled = len(recent) == steady and max(recent) - min(recent) < parts * max(recent)
    return Sequence(factors[-1], settled, len(factors), time.perf_counter() - began, tuple(each))


def shortfall(model: AssemblyModel, load_factor: float) -> float:
    """Least t such that forces with |T| <= λ (c A + μ Σ N) + t A balance the loads; 0 or less where they hold."""
    program = _Program(model, 1)
    load, areas = model.load.ravel(), program.by_group @ model.control_area
    balance = sp.hstack([model.statics, sp.csc_matrix((len(load), 1))])
    coupled = sp.diags(load_factor * model.tan_friction) @ program.by_group
    top = sp.hstack([coupled, program.none, sp.csc_matrix(areas[:, None])])
    cost = np.zeros(program.unknowns)
    cost[-1] = 1.0
    cohesion = load_factor * (program.by_group @ model.cohesion)
    none = sp.csc_matrix((program.unknowns, program.unknowns))
    found = program.solved(none, cost, balance, top, cohesion, -1.0, 1e-11)
    return math.inf if "Infeasible" in str(found.status) else float(found.obj_val)


def static_bound(model: AssemblyModel, parts: float = 1e-7, near: float | None = None) -> float:
    """The largest factor F = 1/λ at which admissible forces balance the loads, by bisection, at `near` first."""

    def stands(factor: float) -> bool:
        return shortfall(model, 1.0 / factor) <= 1e-9

    low, high = around(stands, near, parts) or (0.05, 50.0)
    while high > low * (1.0 + parts):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if stands(middle) else (low, middle)
    return low


class _Program:
    """Normal forces (m), friction forces (g t) and `extra` more unknowns."""

    def __init__(self, model: AssemblyModel, extra: int) -> None:
        self.model = model
        self.pairs, self.groups = len(model.control_area), len(model.tan_friction)
        self.of_pair = np.searchsorted(model.group_first, np.arange(self.pairs), side="right") - 1
        self.by_group = sp.csr_matrix(
            (np.ones(self.pairs), (self.of_pair, np.arange(self.pairs))),
            shape=(self.groups, self.pairs),
        )
        self.width = model.slip_rows.shape[1]
        self.frictions, self.extra = self.groups * self.width, extra
        self.unknowns = self.pairs + self.frictions + extra
        self.none = sp.csr_matrix((self.groups, self.frictions))

    def solved(self, energy, cost, balance, top, top_constant, least: float, tolerance: float):
        """Clarabel's answer with |T_g| <= top x + top_constant, N >= 0 and the extra unknowns >= least."""
        pairs, groups, width = self.pairs, self.groups, self.width
        bounded = np.concatenate(
            [np.arange(pairs), self.unknowns - self.extra + np.arange(self.extra)]
        )
        at_least = sp.csr_matrix(
            (-np.ones(len(bounded)), (np.arange(len(bounded)), bounded)),
            shape=(len(bounded), self.unknowns),
        )
        bounds = np.concatenate([np.zeros(pairs), np.full(self.extra, -least)])
        friction = sp.csr_matrix(
            (
                np.ones(self.frictions),
                (np.arange(self.frictions), pairs + np.arange(self.frictions)),
            ),
            shape=(self.frictions, self.unknowns),
        )
        cones = [clarabel.ZeroConeT(balance.shape[0]), clarabel.NonnegativeConeT(len(bounded))]
        if width == 1:  # |T| <= r is two inequalities
            rows, right = [friction - top, -friction - top], [top_constant, top_constant]
            cones.append(clarabel.NonnegativeConeT(2 * groups))
        else:
            tips = (1 + width) * np.arange(groups)
            order = np.argsort(
                np.concatenate([tips, (tips[:, None] + 1 + np.arange(width)).ravel()])
            )
            rows = [sp.vstack([-top, -friction]).tocsr()[order]]
            right = [np.concatenate([top_constant, np.zeros(self.frictions)])[order]]
            cones += [clarabel.SecondOrderConeT(1 + width)] * groups
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.direct_solve_method = "qdldl"
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = tolerance
        matrix = sp.vstack([balance, at_least, *rows]).tocsc()
        right = np.concatenate([-self.model.load.ravel(), bounds, *right])
        return clarabel.DefaultSolver(energy, cost, matrix, right, cones, settings).solve()
