"""How far admissible forces are, at one λ = 1/F, from those of a mechanism; and the least λ at which they get there.

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
from slopekit.preie.solvers.work_limit import PROGRAM, factorisation, spend
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

_SPARE = -1.0  # of the lighter block's load, that friction may fall short of its strength everywhere
_LEFT = 0.99  # of that: beyond it the distance says nothing of λ
_MOST_TRIALS = 60  # of λ
_MOST_TURNS = 2  # from one side to the other before the bracket is halved: Newton's method goes nowhere
_ROUNDED = 1e-4  # λ below which distances are rounding: blocks are locked unless a motion proves their bound
_LIFTED = 1e3  # λ up to which no forces are seen to balance: there are none, programs of more are badly scaled
_PAIRS_AN_UNKNOWN = 4.0  # node pairs that a program works on as on one unknown: one block may have thousands
_LONGEST_STRIDE = 10.0  # of λ: where one is known roughly, less to begin with


@dataclass(frozen=True)
class DistanceAt:
    """The distance s in parts of the load, infinite where the program gave up, and ds/dλ; N (m,) and a motion (N,).

    `is_infeasible`: no forces balance the loads, whatever friction carries.
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
    least : s_least; below zero there is so much to spare
    """

    def __init__(
        self, model: "AssemblyModel", velocity: Floats, bond: Floats, reduction: float, least: float = 0.0
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
        cohesion = np.where(model.bolted, 0.5 * cohesion, cohesion)  # about the middle of what a bolt may pull
        own = np.sqrt((model.load * model.load).sum(axis=1))
        lightest = LIGHTEST * float(own.max())
        # each block balances in parts of its own load, each contact counts by that of the lighter block
        self.parts = 1.0 / np.repeat(np.maximum(own, lightest), model.unknowns)
        lighter = np.minimum(own[model.plus], np.where(model.minus < 0, np.inf, own[model.minus]))
        weight = np.maximum(lighter[model.group_contact], lightest)
        statics, sticks = model.statics.tocoo(), np.flatnonzero(~slips)
        balance, sheared = self.parts[statics.row] * statics.data, statics.col >= pairs
        component = statics.col[sheared] - pairs
        along = balance[sheared] * direction.ravel()[component]
        carried = sparse.csc_matrix((along, (statics.row[sheared], component // tangents)), (len(self.parts), groups))
        pair_entries = carried[:, model.group_of_pair].tocoo()
        friction_of_pair = model.tan_friction[model.group_of_pair]
        # columns: N, T of what sticks, s; rows: N = 0 where it opens; N and s from below; and the cones: (s, balance),
        # block by block, of what moves, else balance before all others, and (room, T), friction by friction
        shut, every, width = int(opens.sum()), np.arange(pairs), len(sticks) * tangents
        moving = model.load.shape[0] if slips.any() else 0
        exact = 0 if moving else len(self.parts)
        lower, last = exact + shut, pairs + width
        blocks, self.balance = _cones(lower + pairs + 1, moving, model.unknowns)
        self.balance = self.balance if moving else np.arange(exact)
        heads, tails = _cones(lower + pairs + 1 + moving * (1 + model.unknowns), len(sticks), tangents)
        head_of, column_of = np.zeros(groups, dtype=np.int64), np.full(pairs + groups * tangents, -1)
        head_of[sticks] = heads
        column_of[:pairs] = every
        column_of[(pairs + sticks[:, None] * tangents + np.arange(tangents)).ravel()] = pairs + np.arange(width)
        kept, rough = column_of[statics.col] >= 0, np.flatnonzero(~slips[model.group_of_pair])
        entries = [
            (self.balance[statics.row[kept]], column_of[statics.col[kept]], balance[kept] + 0j),
            (
                self.balance[pair_entries.row],
                pair_entries.col,
                -1j * (pair_entries.data * friction_of_pair[pair_entries.col]),
            ),
            (exact + np.arange(shut), np.flatnonzero(opens), np.full(shut, 1.0 + 0j)),
            (lower + every, every, np.full(pairs, -1.0 + 0j)),
            ([lower + pairs], [last], [-1.0 + 0j]),
            (blocks, np.full(moving, last), np.full(moving, -1.0 + 0j)),
            (heads, np.full(len(sticks), last), -weight[sticks] + 0j),
            (head_of[model.group_of_pair[rough]], rough, -1j * friction_of_pair[rough]),
            (tails, pairs + np.arange(width), np.full(width, -1.0 + 0j)),
        ]
        rows, columns, values = (np.concatenate(parts) for parts in zip(*entries, strict=True))
        # entries of what stays and, imaginary, of what grows with λ: summed for a λ without SciPy's sparse sums
        count = lower + pairs + 1 + moving * (1 + model.unknowns) + len(sticks) * (1 + tangents)
        both = sparse.csc_matrix((values, (rows, columns)), (count, last + 1))
        both.eliminate_zeros()
        self.matrix, self.grows = both.real, both.imag
        self.of_still, self.of_grows = both.data.real.copy(), both.data.imag.copy()
        self.cost = sparse.csc_matrix((both.shape[1], both.shape[1]))
        self.right, self.right_grows = np.zeros((2, count))
        self.right[self.balance], self.right[lower + pairs] = -self.parts * model.load.ravel(), -least
        self.right_grows[self.balance] = carried @ cohesion - self.parts * model.mean_pulls
        self.right_grows[heads] = cohesion[sticks]
        self.cones = [
            clarabel.ZeroConeT(exact + shut), clarabel.NonnegativeConeT(pairs + 1),
            *[clarabel.SecondOrderConeT(1 + model.unknowns)] * moving,
            *[clarabel.SecondOrderConeT(1 + tangents)] * len(sticks),
        ]  # fmt: skip
        self.pairs = pairs

    def at(self, reduction: float, tolerance: float = SOLVED) -> DistanceAt:
        """The distance at one λ."""
        import clarabel

        spend(factorisation(max(len(self.parts), self.pairs / _PAIRS_AN_UNKNOWN)), PROGRAM)
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = tolerance
        settings.max_threads = 1
        settings.direct_solve_method = "qdldl"  # for these programs its fastest, from 1 to 600 blocks
        cost = np.zeros(self.matrix.shape[1])
        cost[-1] = 1.0
        self.matrix.data = self.of_still + reduction * self.of_grows
        right = self.right + reduction * self.right_grows
        solution = clarabel.DefaultSolver(self.cost, cost, self.matrix, right, self.cones, settings).solve()
        x, dual = np.array(solution.x), np.array(solution.z)
        motion = self.parts * dual[self.balance]
        normal = np.maximum(x[: self.pairs], 0.0)
        if not str(solution.status).startswith(("Solved", "AlmostSolved")):
            return DistanceAt(math.inf, 0.0, normal, motion, str(solution.status) == "PrimalInfeasible")
        return DistanceAt(float(x[-1]), float(dual @ (self.grows @ x - self.right_grows)), normal, motion)


def _cones(first: int, count: int, size: int) -> tuple[Ints, Ints]:
    """Return the rows of the heads (n,) of cones from a row on, and those of their other numbers (n size,)."""
    heads = first + np.arange(count) * (1 + size)
    return heads, (heads[:, None] + np.arange(1, 1 + size)).ravel()


def bound_by_programs(model: "AssemblyModel", start: float = 1.0, steps: int = 0) -> StaticBound | None:
    """The static bound by Newton on the distance at one λ, bracketed; None where that does not close or is not proved.

    Lifted where no λ however high balances the loads.

    Far less is to spare just above a λ where blocks jam than just below it: the bracket is halved there. What is known
    from rough programs says where to begin, and no more: where blocks jam it may be off by a few percent.

    Parameters
    ----------
    start : λ to begin with; steps : work done before
    """
    program = Distance(model, np.zeros(model.load.size), np.ones(len(model.control_area)), start, _SPARE)
    reduction, tolerance, low, high = start, ROUGHLY_SOLVED, 0.0, math.inf
    stride, proved = _LONGEST_STRIDE, 0.0
    is_short, turns = False, 0  # turns: trials in a row that ended on the other side than the one before
    best: DistanceAt | None = None
    motion = np.zeros(model.load.size)

    def bound(at: float | None, locked: bool = False) -> StaticBound:
        normal = np.zeros(len(model.control_area)) if best is None else best.normal_force
        return StaticBound(None if at is None else 1.0 / at, False, locked, motion, normal, steps)

    def ended(at: float, sure: bool) -> StaticBound | None:
        """The bound at a λ if that is sure or its motion proves it; below `_ROUNDED` blocks are locked otherwise."""
        found = bound(at)
        if sure or is_proved(model, found):
            return found
        return bound(None, locked=True) if at < _ROUNDED else None

    for _ in range(_MOST_TRIALS):
        steps += 1
        far = program.at(reduction, tolerance)
        if far.is_infeasible or (reduction > FARTHEST and proved > _LIFTED):
            return StaticBound(None, True, False, motion, far.normal_force, steps)
        newton = far.slope < 0.0 and _LEFT * _SPARE < far.distance < math.inf
        trial = reduction - far.distance / far.slope if newton else math.inf
        near_enough = newton and abs(trial / reduction - 1.0) < ROUGHLY_CLOSE
        turns = turns + 1 if is_short != (far.distance > 0.0) else 0
        is_short = far.distance > 0.0  # also where the program gave up: it did not find any
        if is_short:
            low = reduction
        else:
            high, best = reduction, far
        if 0.0 < far.distance < math.inf:
            proved, motion = reduction, far.motion
        if tolerance > SOLVED and (near_enough or high < low * (1.0 + ROUGHLY_CLOSE)):
            reduction = trial if near_enough else math.sqrt(low * high)
            tolerance, stride, low, high = SOLVED, 1.0 + ROUGHLY_CLOSE, 0.0, math.inf
            continue
        # a step of the distance where blocks jam is no root, nor is what is left of it as λ goes to nothing
        if newton and abs(trial / reduction - 1.0) < CLOSE and abs(far.distance) < ROUGHLY_SOLVED:
            best, motion = far, far.motion
            return ended(trial, False)
        if high < low * (1.0 + CLOSE):
            return ended(high, high > _ROUNDED and proved > (1.0 - BOUND_ACCURACY) * high)
        if reduction < LEAST_STRENGTH:
            return bound(None, locked=True)
        if low > FARTHEST:
            break
        if turns > _MOST_TURNS or not max(low, reduction / stride) < trial < min(high, reduction * stride):
            turns = 0
            if low > 0.0 and high < math.inf:
                trial = math.sqrt(low * high)
            else:
                trial = low * stride if low > 0.0 else high / stride
                stride = min(stride * stride, _LONGEST_STRIDE)
        reduction = trial
    return None
