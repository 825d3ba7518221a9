"""What slopekit is measured against, on the same models: conic solvers, Siconos.

One block (`Model`) and many (`AssemblyModel`) come in one form here, the attributes of the latter that
`assembly_oracle` reads: every rival is written once.
"""

import functools
import json
import math
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import clarabel
import numpy as np
import scipy.sparse as sp

from slopekit.preie.many_blocks.blocks import limit_of_blocks
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.system.model import Model
from tests.preie.assembly_oracle import conic_sequence

#: Where bisections start, in parts of the answer: no trial of theirs falls on it by chance.
BRACKET = (0.5, 1.9)
_BALANCED = 1e-9  # a shortfall this small, in parts of the load, is none
_MOST_OF_ONE = 2000  # node pairs of one block: nine times their square are the entries of the Delassus operator
_WORKER = Path(__file__).with_name("siconos_worker.py")
_PYTHONS = ("/usr/bin/python3", sys.executable)  # Debian's package is for the system's interpreter


@dataclass(frozen=True)
class Answer:
    """What a rival says.

    Attributes
    ----------
    factor : None where it says none
    seconds : where it keeps the time itself or estimates it (None: it is timed from outside; nan: it never ended)
    within : the error that is left open at least, where the factor was not come to step by step
    """

    factor: float | None
    seconds: float | None = None
    estimated: bool = False
    note: str = ""
    within: float | None = None


class OneBlock:
    """A model of one block under the names of an assembly: every node pair has its own friction force.

    `limit` is slopekit's own way to its factor.
    """

    def __init__(self, model: Model, limit: Callable[[], float | None]) -> None:
        pairs = len(model.control_area)
        self.limit = limit
        self.control_area, self.cohesion = model.control_area, model.cohesion
        self.tan_friction, self.load = model.tan_friction, model.load[None, :]
        self.group_first = self.group_of_pair = np.arange(pairs)
        self.slip_rows = model.rows[:, 1:, :]
        rows = np.concatenate([model.normal_rows, self.slip_rows.reshape(-1, model.unknowns)])
        self.kinematics = sp.csr_matrix(rows)
        self.statics = self.kinematics.T.tocsr()

    def by_group(self, of_pairs: np.ndarray) -> np.ndarray:
        return of_pairs


Contacts = OneBlock | AssemblyModel


def slopekit_limit(contacts: Contacts, curved: bool = False, ranged: bool = False) -> Answer:
    """slopekit's own answer; of many blocks with their static bound, which the path starts from, or the range too."""
    if isinstance(contacts, OneBlock):
        return Answer(contacts.limit())
    limit = limit_of_blocks(contacts, ranged)
    steps = f"bound {limit.bound_steps} steps, path {limit.steps} factorisations"
    return Answer(
        limit.factor, note=f"{limit.outcome.name.lower()}, {limit.basis.name.lower()}: {steps}"
    )


def conic_passes(contacts: Contacts, parts: float, most: int) -> Answer:
    """METHOD.md §4 plainly, until three factors lie within `parts`."""
    found = conic_sequence(contacts, parts=parts, most=most)
    settled = "" if found.settled or most == 1 else ", not settled"
    return Answer(
        found.factor, note=f"{found.passes} pass{'es' if found.passes > 1 else ''}{settled}"
    )


class Feasibility:
    """Whether admissible forces balance the loads at λ = 1/F: the static bound's question, put to Clarabel.

    Least t >= -1 with Bᵀ f + P = 0, N >= 0, |T_g| <= λ (c A + μ Σ N) + t A. The matrix is made once.
    """

    def __init__(self, contacts: Contacts) -> None:
        groups, width = contacts.slip_rows.shape[0], contacts.slip_rows.shape[1]
        pairs, unknowns = len(contacts.control_area), contacts.load.size
        self.size = pairs + groups * width + 1
        summed = sp.csr_matrix(
            (np.ones(pairs), (contacts.group_of_pair, np.arange(pairs))), (groups, pairs)
        )
        tips = np.arange(groups) * (1 + width)
        tip = sp.csr_matrix(
            (np.ones(groups), (tips, np.arange(groups))), (groups * (1 + width), groups)
        )
        sides = sp.csr_matrix(
            (
                np.ones(groups * width),
                ((tips[:, None] + 1 + np.arange(width)).ravel(), np.arange(groups * width)),
            ),
            (groups * (1 + width), groups * width),
        )
        balance = sp.hstack([contacts.statics, sp.csr_matrix((unknowns, 1))])
        least = sp.diags(np.r_[-np.ones(pairs), np.zeros(groups * width), -1.0]).tocsr()
        least = least[np.r_[np.arange(pairs), self.size - 1]]
        areas = summed @ contacts.control_area
        cones = sp.hstack(
            [sp.csr_matrix((tip.shape[0], pairs)), -sides, tip @ sp.csr_matrix(-areas[:, None])]
        )
        coupled = sp.hstack(
            [
                tip @ sp.diags(contacts.tan_friction) @ summed,
                sp.csr_matrix((tip.shape[0], groups * width + 1)),
            ]
        )
        self.matrix = sp.vstack([balance, least, cones]).tocsc()
        self.coupled = sp.vstack(
            [sp.csr_matrix((unknowns + pairs + 1, self.size)), coupled]
        ).tocsc()
        self.right = np.concatenate(
            [-contacts.load.ravel(), np.zeros(pairs), [1.0], np.zeros(tip.shape[0])]
        )
        self.cohesion = np.concatenate(
            [np.zeros(unknowns + pairs + 1), tip @ (summed @ contacts.cohesion)]
        )
        self.cones = [clarabel.ZeroConeT(unknowns), clarabel.NonnegativeConeT(pairs + 1)]
        self.cones += [clarabel.SecondOrderConeT(1 + width)] * groups
        self.cost = np.r_[np.zeros(self.size - 1), 1.0]
        self.none = sp.csc_matrix((self.size, self.size))

    def holds(self, factor: float) -> bool:
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.direct_solve_method = "qdldl"
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-10
        matrix = (self.matrix - self.coupled / factor).tocsc()
        right = self.right + self.cohesion / factor
        found = clarabel.DefaultSolver(
            self.none, self.cost, matrix, right, self.cones, settings
        ).solve()
        return "Infeasible" not in str(found.status) and float(found.obj_val) <= _BALANCED


def bisection_steps(width: float) -> int:
    """Steps to a relative width from the bracket that every bisection here is given."""
    return math.ceil(math.log2(math.log(BRACKET[1] / BRACKET[0]) / width))


def conic_bisection(
    contacts: Contacts, width: float, about: float, bound: float | None, budget: float
) -> Answer:
    """The static bound by bisection; where that would take more than `budget` seconds, one step times their number.

    Parameters
    ----------
    about : the bracket is `BRACKET` times that
    bound : the static bound by slopekit, which stands for the answer where only one step is taken
    """
    steps = bisection_steps(width)
    began = time.perf_counter()
    program = Feasibility(contacts)
    built = time.perf_counter() - began
    low, high = (end * about for end in BRACKET)
    for done in range(steps):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if program.holds(middle) else (low, middle)
        spent = time.perf_counter() - began - built
        if done == 0 and spent * steps > budget:
            note = f"1 of {steps} steps, {spent:.2g} s; " + (
                "F slopekit's bound" if bound else "F not found"
            )
            # without a bound to stand for the answer the width of a bracket that was never closed says nothing
            return Answer(bound, built + spent * steps, True, note, width if bound else None)
    return _bisected(math.sqrt(low * high), about, width, f"{steps} steps")


def _bisected(
    found: float, about: float, width: float, note: str, seconds: float | None = None
) -> Answer:
    """The middle of the last bracket, unless that lies at an end of the first: then the answer lies beyond."""
    if found > BRACKET[1] * about * (1.0 - 2.0 * width):
        return Answer(None, seconds, note=f"{note}; stands throughout the bracket")
    if found < BRACKET[0] * about * (1.0 + 2.0 * width):
        return Answer(None, seconds, note=f"{note}; slides throughout the bracket")
    return Answer(found, seconds, note=note)


@functools.cache
def siconos_python() -> str | None:
    """The first interpreter that has Siconos' solvers, None where there is none."""
    for python in _PYTHONS:
        try:
            done = subprocess.run(
                [python, "-c", "import siconos.numerics, scipy.sparse"], capture_output=True
            )
        except OSError:
            continue
        if done.returncode == 0:
            return python
    return None


@contextmanager
def _handed_over(contacts: Contacts) -> Iterator[Path]:
    """The frictional contact problem in a folder of its own: B by node pairs, load, friction, cohesion."""
    pairs, width = len(contacts.control_area), contacts.slip_rows.shape[1]
    group = contacts.group_of_pair
    rows = [contacts.kinematics[:pairs]]
    rows += [contacts.kinematics[pairs + group * width + k] for k in range(width)]
    order = np.arange((1 + width) * pairs).reshape(1 + width, pairs).T.ravel()
    matrix = sp.vstack(rows).tocsr()[order]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "problem.npz"
        shares = contacts.control_area / contacts.by_group(contacts.control_area)[group]
        cohesion = contacts.by_group(contacts.cohesion)[group] * shares
        np.savez(
            path,
            data=matrix.data,
            indices=matrix.indices,
            indptr=matrix.indptr,
            shape=matrix.shape,
            load=contacts.load,
            tan_friction=contacts.tan_friction[group],
            cohesion=cohesion,
        )
        yield path


def siconos(contacts: Contacts, width: float, about: float, budget: float) -> Answer:
    """Siconos (NSGS on the Delassus operator): does a step from rest leave the blocks at rest? Bisection on F.

    Where the whole would take longer than `budget`: its two checks beside `about`, times the number of steps.
    """
    python = siconos_python()
    if python is None:
        return Answer(
            None, math.nan, note="not installed (Debian: python3-siconos and python3-scipy)"
        )
    if isinstance(contacts, OneBlock) and len(contacts.control_area) > _MOST_OF_ONE:
        return Answer(
            None,
            math.nan,
            note="not tried: every pair of one block meets every other, a dense operator",
        )
    steps = bisection_steps(width)
    ends = [end * about for end in BRACKET]
    orders = json.dumps(
        {"about": about, "bracket": ends, "width": width, "steps": steps, "budget": budget}
    )
    with _handed_over(contacts) as path:
        command = [python, str(_WORKER), str(path), orders]
        try:
            out = subprocess.run(
                command, capture_output=True, text=True, timeout=budget, check=False
            ).stdout
        except subprocess.TimeoutExpired as late:
            out = late.stdout.decode() if isinstance(late.stdout, bytes) else late.stdout or ""
    return _judged([json.loads(line) for line in out.splitlines()], width, about, steps, budget)


def _judged(told: list[dict], width: float, about: float, steps: int, budget: float) -> Answer:
    """The answer of the worker's lines: two checks beside the answer, then, where time allows, a whole bisection."""
    checks = [line for line in told if "factor" in line]
    if not checks:
        return Answer(None, math.nan, note=f"gave up: no check within {budget:.0f} s")
    setup = told[0]["setup_s"]
    if told[-1].get("done"):
        lost = sum(not check["settled"] for check in checks[2:])
        note = f"{len(checks) - 2} checks" + (f", {lost} not settled" if lost else "")
        return _bisected(
            told[-1]["found"],
            about,
            width,
            note,
            setup + sum(check["seconds"] for check in checks[2:]),
        )
    if len(checks) > 2:
        return Answer(
            None,
            math.nan,
            note=f"gave up: {len(checks) - 2} of {steps} checks within {budget:.0f} s",
        )
    mean = float(np.mean([check["seconds"] for check in checks]))
    said = ", ".join(
        f"{'stands' if check['stands'] else 'slides'} at {check['factor'] / about:.4g} F"
        + ("" if check["settled"] else " (not settled)")
        for check in checks
    )
    right = len(checks) > 1 and checks[0]["stands"] and not checks[1]["stands"]
    return Answer(
        None, setup + mean * steps, True, f"{said}; {mean:.2g} s a check", width if right else None
    )
