"""The distance of admissible forces at one λ = 1/F from those of a mechanism, and the least λ at which it vanishes.

    minimise s >= s_least:    B_nᵀ N + B_tᵀ T + P = 0,    N >= 0 (0 where it opens),
    |T_g| <= λ (c_g + μ_g Σ N) + s    where it does not slip,    |T_g + λ (c_g + μ_g Σ N) e_g| <= s    where it does

One cone program for 1 to n blocks, in a section (cones of two numbers: a linear program, by Clarabel in a third of the
time that HiGHS takes) and in space. Its matrix and right-hand side are linear in λ, its dual gives ds/dλ and a motion.

With no motion at all nothing opens or slips, and s = 0 at the least λ for which some admissible forces balance the
loads: the static bound.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from slopekit.core.arrays import Floats, Ints
from slopekit.preie.programs.bound import StaticBound, is_proved
from slopekit.preie.solvers.work_limit import CONE_PROGRAM_FACTORISATIONS, factorisation, spend
from slopekit.preie.tolerances import (
    BOUND_ACCURACY,
    CLOSE,
    FARTHEST,
    LEAST_STRENGTH,
    LIGHTEST,
    NO_MOTION,
    ROUGHLY_CLOSE,
    ROUGHLY_SOLVED,
    SOLVED,
    TINY,
)

if TYPE_CHECKING:  # one block needs no sparse matrices before it comes to programs
    from slopekit.preie.system.assembly import AssemblyModel

_SPARE = (
    -1.0
)  # of the lighter block's load: spare strength, below zero, up to which the distance is resolved
_USABLE_SPARE = 0.99  # of that: beyond it the distance does not depend on λ
_MOST_TRIALS = 60  # of λ
_MOST_TURNS = 2  # changes of side in a row after which the bracket is halved, as Newton's method does not converge
_LOCKED_BELOW = 1e-4  # λ below which distances are rounding: blocks are locked unless a motion proves their bound
_LIFTED_BEYOND = 1e3  # λ without balance from which blocks count as lifted: programs of larger λ are badly scaled
_PAIRS_AN_UNKNOWN = (
    4.0  # node pairs that a program works on as on one unknown: one block may have thousands
)
_LONGEST_STRIDE = 10.0  # largest ratio of λ between trials; less at first where λ is known roughly


@dataclass(frozen=True)
class DistanceEvaluation:
    """Result of the program at one λ: the distance s in parts of the load, infinite without convergence, and ds/dλ.

    `normal_force` (m,), `motion` (N,). `is_infeasible`: no forces balance the loads, whatever friction carries.
    """

    distance: float
    slope: float
    normal_force: Floats
    motion: Floats
    is_infeasible: bool = False


class Distance:
    """The program of this module for one mechanism.

    Parameters
    ----------
    velocity : (N,) of the mechanism; bond : (m,) 0 where a pair has lost its cohesion
    reduction : λ at which it moves: there no joint dilates by more than λ tan φ, and one that slip opens by more is
        open, at any other λ as well
    least : s_least; below zero the program measures spare strength up to it
    """

    def __init__(
        self,
        model: "AssemblyModel",
        velocity: Floats,
        bond: Floats,
        reduction: float,
        least: float = 0.0,
    ) -> None:
        import clarabel
        from scipy import sparse

        opening, slip = model.opening_and_slip(velocity)
        size = np.sqrt((slip * slip).sum(axis=1))
        fastest = max(float(np.abs(opening).max()), float(size.max()), TINY)
        pairs, groups, tangents = len(opening), *slip.shape
        dilation = np.minimum(model.tan_dilation, reduction * model.tan_friction)
        opens = opening - (dilation * size)[model.group_of_pair] > NO_MOTION * fastest
        opens[model.joint_pairs.stop :] = True
        slips = size > NO_MOTION * fastest
        direction = np.where(slips[:, None], slip / np.maximum(size, TINY)[:, None], 0.0)
        cohesion = model.by_group(model.cohesion * bond)
        cohesion = np.where(model.bolted, 0.5 * cohesion, cohesion)  # about the mean pull of a bolt
        block_loads = np.sqrt((model.load * model.load).sum(axis=1))
        lightest = LIGHTEST * float(block_loads.max())
        # the balance of each block is scaled by its load, each contact by the load of its lighter block
        self.scale = 1.0 / np.repeat(np.maximum(block_loads, lightest), model.unknowns)
        lighter = np.minimum(
            block_loads[model.plus], np.where(model.minus < 0, np.inf, block_loads[model.minus])
        )
        weight = np.maximum(lighter[model.group_contact], lightest)
        statics, sticks = model.statics.tocoo(), np.flatnonzero(~slips)
        balance, sheared = self.scale[statics.row] * statics.data, statics.col >= pairs
        component = statics.col[sheared] - pairs
        along = balance[sheared] * direction.ravel()[component]
        friction_columns = sparse.csc_matrix(
            (along, (statics.row[sheared], component // tangents)), (len(self.scale), groups)
        )
        pair_entries = friction_columns[:, model.group_of_pair].tocoo()
        friction_of_pair = model.tan_friction[model.group_of_pair]
        # columns: N, T of what sticks, s; rows: N = 0 where it opens; N and s from below; and the cones: (s, balance),
        # block by block, of what moves, else balance before all others, and (room, T), friction by friction
        shut, pair_numbers, width = int(opens.sum()), np.arange(pairs), len(sticks) * tangents
        moving = model.load.shape[0] if slips.any() else 0
        exact = 0 if moving else len(self.scale)
        lower, last = exact + shut, pairs + width
        blocks, self.balance = _cones(lower + pairs + 1, moving, model.unknowns)
        self.balance = self.balance if moving else np.arange(exact)
        heads, tails = _cones(
            lower + pairs + 1 + moving * (1 + model.unknowns), len(sticks), tangents
        )
        head_of, column_of = (
            np.zeros(groups, dtype=np.int64),
            np.full(pairs + groups * tangents, -1),
        )
        head_of[sticks] = heads
        column_of[:pairs] = pair_numbers
        column_of[(pairs + sticks[:, None] * tangents + np.arange(tangents)).ravel()] = (
            pairs + np.arange(width)
        )
        has_column, rough = column_of[statics.col] >= 0, np.flatnonzero(~slips[model.group_of_pair])
        entries = [
            (
                self.balance[statics.row[has_column]],
                column_of[statics.col[has_column]],
                balance[has_column] + 0j,
            ),
            (
                self.balance[pair_entries.row],
                pair_entries.col,
                -1j * (pair_entries.data * friction_of_pair[pair_entries.col]),
            ),
            (exact + np.arange(shut), np.flatnonzero(opens), np.full(shut, 1.0 + 0j)),
            (lower + pair_numbers, pair_numbers, np.full(pairs, -1.0 + 0j)),
            ([lower + pairs], [last], [-1.0 + 0j]),
            (blocks, np.full(moving, last), np.full(moving, -1.0 + 0j)),
            (heads, np.full(len(sticks), last), -weight[sticks] + 0j),
            (head_of[model.group_of_pair[rough]], rough, -1j * friction_of_pair[rough]),
            (tails, pairs + np.arange(width), np.full(width, -1.0 + 0j)),
        ]
        rows, columns, values = (np.concatenate(arrays) for arrays in zip(*entries, strict=True))
        # real parts are constant, imaginary parts grow with λ: both are added up at a λ without SciPy's sparse sums
        count = lower + pairs + 1 + moving * (1 + model.unknowns) + len(sticks) * (1 + tangents)
        complex_matrix = sparse.csc_matrix((values, (rows, columns)), (count, last + 1))
        complex_matrix.eliminate_zeros()
        self.matrix, self.growing_matrix = complex_matrix.real, complex_matrix.imag
        self.constant_data, self.growing_data = (
            complex_matrix.data.real.copy(),
            complex_matrix.data.imag.copy(),
        )
        self.cost = sparse.csc_matrix((complex_matrix.shape[1], complex_matrix.shape[1]))
        self.right, self.growing_right = np.zeros((2, count))
        self.right[self.balance], self.right[lower + pairs] = (
            -self.scale * model.load.ravel(),
            -least,
        )
        self.growing_right[self.balance] = (
            friction_columns @ cohesion - self.scale * model.mean_pulls
        )
        self.growing_right[heads] = cohesion[sticks]
        self.cones = [
            clarabel.ZeroConeT(exact + shut),
            clarabel.NonnegativeConeT(pairs + 1),
            *[clarabel.SecondOrderConeT(1 + model.unknowns)] * moving,
            *[clarabel.SecondOrderConeT(1 + tangents)] * len(sticks),
        ]
        self.pairs = pairs

    def evaluate(self, reduction: float, tolerance: float = SOLVED) -> DistanceEvaluation:
        """Solve the program at one λ."""
        import clarabel

        spend(
            factorisation(max(len(self.scale), self.pairs / _PAIRS_AN_UNKNOWN)),
            CONE_PROGRAM_FACTORISATIONS,
        )
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = tolerance
        settings.max_threads = 1
        settings.direct_solve_method = (
            "qdldl"  # for these programs its fastest, from 1 to 600 blocks
        )
        cost = np.zeros(self.matrix.shape[1])
        cost[-1] = 1.0
        self.matrix.data = self.constant_data + reduction * self.growing_data
        right = self.right + reduction * self.growing_right
        solution = clarabel.DefaultSolver(
            self.cost, cost, self.matrix, right, self.cones, settings
        ).solve()
        x, dual = np.array(solution.x), np.array(solution.z)
        motion = self.scale * dual[self.balance]
        normal = np.maximum(x[: self.pairs], 0.0)
        if not str(solution.status).startswith(("Solved", "AlmostSolved")):
            return DistanceEvaluation(
                math.inf, 0.0, normal, motion, str(solution.status) == "PrimalInfeasible"
            )
        return DistanceEvaluation(
            float(x[-1]),
            float(dual @ (self.growing_matrix @ x - self.growing_right)),
            normal,
            motion,
        )


def _cones(first: int, count: int, size: int) -> tuple[Ints, Ints]:
    """Return the rows of the first entries (n,) of cones from a row on, and of their other entries (n size,)."""
    heads = first + np.arange(count) * (1 + size)
    return heads, (heads[:, None] + np.arange(1, 1 + size)).ravel()


def bound_by_programs(
    model: "AssemblyModel", start: float = 1.0, steps: int = 0
) -> StaticBound | None:
    """Return the static bound by a bracketed Newton method on the distance; None where it does not converge.

    It is lifted where no λ balances the loads, and None too where its motion does not prove it.

    Where blocks jam the distance has a kink, and the bracket is halved. Programs with a rough tolerance only give the
    first λ of the exact ones: where blocks jam they may be off by a few percent.

    Parameters
    ----------
    start : first λ; steps : of earlier work, counted in the result
    """
    program = Distance(
        model, np.zeros(model.load.size), np.ones(len(model.control_area)), start, _SPARE
    )
    reduction, tolerance, low, high = start, ROUGHLY_SOLVED, 0.0, math.inf
    stride, proved = _LONGEST_STRIDE, 0.0
    is_short, turns = (
        False,
        0,
    )  # turns: trials in a row that changed side
    best: DistanceEvaluation | None = None
    motion = np.zeros(model.load.size)

    def bound(bound_reduction: float | None, locked: bool = False) -> StaticBound:
        normal = np.zeros(len(model.control_area)) if best is None else best.normal_force
        return StaticBound(
            None if bound_reduction is None else 1.0 / bound_reduction,
            False,
            locked,
            motion,
            normal,
            steps,
        )

    def confirmed_bound(bound_reduction: float, is_certain: bool) -> StaticBound | None:
        """Return the bound at a λ if certain or proved by its motion; below `_LOCKED_BELOW` otherwise locked blocks."""
        candidate = bound(bound_reduction)
        if is_certain or is_proved(model, candidate):
            return candidate
        return bound(None, locked=True) if bound_reduction < _LOCKED_BELOW else None

    for _ in range(_MOST_TRIALS):
        steps += 1
        evaluation = program.evaluate(reduction, tolerance)
        if evaluation.is_infeasible or (reduction > FARTHEST and proved > _LIFTED_BEYOND):
            return StaticBound(None, True, False, motion, evaluation.normal_force, steps)
        newton = evaluation.slope < 0.0 and _USABLE_SPARE * _SPARE < evaluation.distance < math.inf
        trial = reduction - evaluation.distance / evaluation.slope if newton else math.inf
        near_enough = newton and abs(trial / reduction - 1.0) < ROUGHLY_CLOSE
        turns = turns + 1 if is_short != (evaluation.distance > 0.0) else 0
        is_short = evaluation.distance > 0.0  # also where the program did not converge
        if is_short:
            low = reduction
        else:
            high, best = reduction, evaluation
        if 0.0 < evaluation.distance < math.inf:
            proved, motion = reduction, evaluation.motion
        if tolerance > SOLVED and (near_enough or high < low * (1.0 + ROUGHLY_CLOSE)):
            reduction = trial if near_enough else math.sqrt(low * high)
            tolerance, stride, low, high = SOLVED, 1.0 + ROUGHLY_CLOSE, 0.0, math.inf
            continue
        # neither a kink of the distance where blocks jam nor its remainder as λ vanishes is a root
        if (
            newton
            and abs(trial / reduction - 1.0) < CLOSE
            and abs(evaluation.distance) < ROUGHLY_SOLVED
        ):
            best, motion = evaluation, evaluation.motion
            return confirmed_bound(trial, False)
        if high < low * (1.0 + CLOSE):
            return confirmed_bound(
                high, high > _LOCKED_BELOW and proved > (1.0 - BOUND_ACCURACY) * high
            )
        if reduction < LEAST_STRENGTH:
            return bound(None, locked=True)
        if low > FARTHEST:
            break
        if turns > _MOST_TURNS or not max(low, reduction / stride) < trial < min(
            high, reduction * stride
        ):
            turns = 0
            if low > 0.0 and high < math.inf:
                trial = math.sqrt(low * high)
            else:
                trial = low * stride if low > 0.0 else high / stride
                stride = min(stride * stride, _LONGEST_STRIDE)
        reduction = trial
    return None
