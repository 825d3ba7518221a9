"""Scenes, entrants and rows of ``python -m benchmarks``: speed against error, everything in one run.

Entrants on one model are timed in turns, so that the machine's mood hits all alike; the median counts. Scenes of many
blocks run in processes of their own with one thread.
"""

import json
import math
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

import slopekit as sk
from benchmarks.block_speed import scene_of, slides_at
from benchmarks.rivals import (
    Answer,
    OneBlock,
    conic_bisection,
    conic_passes,
    siconos,
    slopekit_limit,
)
from slopekit.closed_form.toppling import ColumnSlope, toppling_factor_of_safety
from slopekit.design.templates import path_of
from slopekit.kinds import cut, surface
from slopekit.kinds.wedge import closed_form
from slopekit.kinds.wedge.design import wedge_design
from slopekit.preie.many_blocks.blocks import limit_of_blocks
from slopekit.preie.one_block.flat_limit import flat_limit
from slopekit.preie.one_block.pairs_limit import pairs_limit
from slopekit.preie.one_block.slippage import slippable
from slopekit.preie.system.model import build_model
from tests.preie.block_scenes import GOODMAN_BRAY
from tests.support import PAPER

CLOSED, SLOPEKIT, COMMAND = "closed form", "slopekit limit", "slopekit command, cold"
CONIC, SEQUENCE, SICONOS, PUBLISHED = "conic bisection", "conic sequence", "Siconos", "the paper"
#: Every solver of the table, in its order.
RANGED = "slopekit with range"
SOLVERS = (CLOSED, SLOPEKIT, RANGED, SEQUENCE, CONIC, SICONOS, COMMAND, PUBLISHED)
#: How often short work is repeated.
TURNS = {"quick": 5, "full": 15}
_ENOUGH = 2.0  # s: what has taken as long is not repeated again


@dataclass(frozen=True)
class Row:
    """One line of a table; the error is relative to the reference (None: no number, or the reference itself)."""

    model: str
    blocks: int
    node_pairs: int
    solver: str
    effort: str
    seconds: float | None
    factor: float | None
    error: float | None
    to_closed_form: float | None
    to_slopekit: float | None
    estimated: bool = False
    note: str = ""


@dataclass(frozen=True)
class Case:
    """One model, its reference and who enters: (solver, effort, what it does)."""

    model: str
    blocks: int
    node_pairs: int
    reference: float
    entrants: Sequence[tuple[str, str, Callable[[], Answer]]]


def measured(case: Case, rounds: int) -> list[Row]:
    """Every entrant in turn, `rounds` times (once where it takes long): rows with medians and ratios."""
    answers: dict[int, Answer] = {}
    times: dict[int, list[float]] = {k: [] for k in range(len(case.entrants))}
    for turn in range(rounds + 1):  # the first warms up, and counts only for what is not repeated
        for k, (_, _, work) in enumerate(case.entrants):
            if turn and (
                not sum(times[k]) < _ENOUGH or answers[k].estimated
            ):  # nan: it never ended
                continue
            began = time.perf_counter()
            answers[k] = work()
            wall = time.perf_counter() - began
            told = answers[k].seconds
            times[k].append(wall if told is None else told)
    rows = []
    for k, (solver, effort, _) in enumerate(case.entrants):
        answer = answers[k]
        seconds = statistics.median(times[k][1:] or times[k])
        error = answer.within
        if answer.factor is not None:
            error = max(abs(answer.factor / case.reference - 1.0), answer.within or 0.0)
        rows.append(
            Row(
                case.model,
                case.blocks,
                case.node_pairs,
                solver,
                effort,
                seconds if math.isfinite(seconds) else None,
                answer.factor,
                error,
                None,
                None,
                answer.estimated,
                answer.note,
            )
        )
    return with_ratios(rows)


def with_ratios(rows: Sequence[Row]) -> list[Row]:
    """Times as multiples of the closed form's and of slopekit's on the same model."""

    def ratio(row: Row, solver: str) -> float | None:
        base = next(
            (
                other.seconds
                for other in rows
                if other.model == row.model and other.solver == solver
            ),
            None,
        )
        return row.seconds / base if base and row.seconds is not None else None

    return [
        replace(row, to_closed_form=ratio(row, CLOSED), to_slopekit=ratio(row, SLOPEKIT))
        for row in rows
    ]


def rivals_of(
    contacts,
    about: float,
    *,
    parts,
    widths,
    checks,
    budget: float,
    bound=None,
    siconos_budget: float | None = None,
):
    """The rivals on one model: conic sequences, bisections and Siconos (widths)."""
    wait = budget if siconos_budget is None else siconos_budget
    entrants = [
        (
            SEQUENCE,
            "1 pass" if part == 1.0 else f"to {part:g}",
            partial(conic_passes, contacts, part, 1 if part == 1.0 else 40),
        )
        for part in parts
    ]
    entrants += [
        (CONIC, f"to {width:g}", partial(conic_bisection, contacts, width, about, bound, budget))
        for width in widths
    ]
    return entrants + [
        (SICONOS, f"to {width:g}", partial(siconos, contacts, width, about, wait))
        for width in checks
    ]


def wedge(quick: bool) -> list[Row]:
    """The paper's wedge: one block, a closed form, node pairs 8 to 400."""
    design = wedge_design(PAPER)
    exact = closed_form(design).factor
    rows: list[Row] = []
    for refine in (0,) if quick else (0, 1, 2):
        scene = cut(design).scene_at(refine)
        flat = scene.model, scene.bedding.polygons, scene.bedding.centroid
        contacts = OneBlock(scene.model, lambda flat=flat: flat_limit(*flat).factor)
        pairs = len(contacts.control_area)
        entrants = [
            (CLOSED, "", lambda: Answer(closed_form(design).factor)),
            (SLOPEKIT, "", partial(slopekit_limit, contacts)),
            *rivals_of(
                contacts,
                exact,
                parts=(1.0, 1e-2, 1e-4, 1e-6),
                widths=(1e-2, 1e-4, 1e-6),
                checks=(1e-2, 1e-4, 1e-6) if refine < 2 else (1e-2, 1e-4),
                budget=20.0,
            ),
        ]
        rows += measured(
            Case(f"wedge, {pairs} pairs", 1, pairs, exact, entrants),
            TURNS["quick" if quick else "full"],
        )
    first = rows[0]
    said = Answer(1.554, 5.0, note="Sheng et al. 2023, their machine")
    rows += measured(
        Case(first.model, 1, first.node_pairs, exact, [(PUBLISHED, "their program", lambda: said)]),
        1,
    )
    return with_command(rows)


def with_command(rows: Sequence[Row]) -> list[Row]:
    """The rows of the paper's wedge with the cold command measured anew: the others stay."""
    command = [sys.executable, "-m", "slopekit.cli", "wedge", "--dips", *PAPER["dips"], "--json"]

    def cold() -> Answer:
        out = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        return Answer(json.loads(out)["fos"]["limit"])

    exact = closed_form(wedge_design(PAPER)).factor
    entrants = [(COMMAND, "from orientations", cold)]
    own = measured(Case(rows[0].model, 1, rows[0].node_pairs, exact, entrants), TURNS["full"])
    return with_ratios([*(row for row in rows if row.solver != COMMAND), *own])


def surface_contacts(normals: str, edge: float) -> OneBlock:
    """The model of the paper's ellipsoid that `kinds.surface` would solve: its stages, without its result."""
    design = sk.load(path_of("paper-ellipsoid"), set={"slip.normals": normals, "slip.edge": edge})
    mass, pairs = surface._cut(design)
    loads, centroid = surface._loads(design, mass, pairs), mass.centroid
    pairs = slippable(pairs, centroid, np.concatenate([loads.force, loads.moment])).pairs
    model = build_model(pairs, loads, centroid, surface.joint_strength([design.strength]))
    return OneBlock(model, lambda: pairs_limit(model).governing.factor)


def ellipsoid(quick: bool) -> list[Row]:
    """The paper's ellipsoid by mesh; the reference is the finest."""
    finest = sk.run(path_of("paper-ellipsoid"), set={"slip.edge": 1.21})
    exact, most = finest.fos.limit or math.nan, finest.model.node_pairs
    rows: list[Row] = []
    for normals, edges in (("true", (5, 2.5, 1.25)),):
        for edge in edges[:2] if quick else edges:
            contacts = surface_contacts(normals, edge)
            pairs = len(contacts.control_area)
            model = f"{normals} normals, {pairs:,} pairs"
            wait = 10.0 if quick else 60.0 if pairs < 500 else 30.0
            entrants = [
                (SLOPEKIT, "", partial(slopekit_limit, contacts, True)),
                *rivals_of(
                    contacts,
                    exact,
                    parts=(1.0, 1e-2, 1e-4),
                    widths=(1e-2, 1e-4),
                    checks=(1e-2,),
                    budget=25.0,
                    siconos_budget=wait,
                ),
            ]
            rows += measured(Case(model, 1, pairs, exact, entrants), TURNS["quick"])
    reference = Row(
        f"true normals, {most:,} pairs",
        1,
        most,
        SLOPEKIT,
        "the reference",
        finest.timing_s["solve"],
        exact,
        None,
        None,
        1.0,
    )
    return [*rows, reference]


def steps_to_the_limit(contacts, ranged: bool = False) -> Answer:
    """slopekit's own answer; noted with its steps, for "slides" only says that it ended at a limit, not how."""
    answer = slopekit_limit(contacts, ranged=ranged)
    return replace(answer, note=answer.note.removeprefix("slides, "))


def many(name: str, blocks: int, quick: bool, passes_at_1000: int) -> list[Row]:
    """One scene of many blocks; at 10,000 the conic sequence is estimated from one pass."""
    scene, phi, _ = scene_of(name, blocks)
    contacts = scene.model(phi)
    closed = CLOSED_FORMS[name]
    exact, bound = closed(), limit_of_blocks(contacts, ranged=False).static_bound
    large, small = len(scene) > 2000, len(scene) < 500
    budget = (15.0 if small else 20.0) if quick else (30.0 if small else 60.0)
    entrants = [
        (CLOSED, "", lambda: Answer(closed())),
        (SLOPEKIT, "", partial(steps_to_the_limit, contacts)),
        *([] if large else [(RANGED, "", partial(steps_to_the_limit, contacts, ranged=True))]),
        *rivals_of(
            contacts,
            exact,
            parts=(1.0,) if large else (1.0, 1e-2, 1e-4),
            widths=(1e-2, 1e-4) if small else (1e-2,),
            checks=(1e-2,),
            budget=0.0 if large else budget,
            bound=bound,
            siconos_budget=40.0 if large else budget,
        ),
    ]
    rows = measured(
        Case(f"{len(scene):,} blocks", len(scene), len(contacts.control_area), exact, entrants),
        TURNS["quick"],
    )
    if not large:
        return rows
    one = next(row for row in rows if row.solver == SEQUENCE)
    assert one.seconds is not None
    whole = replace(
        one,
        effort="to 0.0001",
        seconds=one.seconds * passes_at_1000,
        factor=None,
        error=None,
        estimated=True,
        note=f"1 pass times the {passes_at_1000} passes of 1,000 blocks, error of those",
    )
    return with_ratios([*rows, whole])


def columns_closed_form() -> float:
    """Goodman & Bray's columns, limit equilibrium."""
    factor, _ = toppling_factor_of_safety(ColumnSlope(GOODMAN_BRAY, 10.0, 1.0, 30.0, 25.0, 38.15))
    assert factor is not None
    return factor


CLOSED_FORMS: dict[str, Callable[[], float]] = {
    "columns": columns_closed_form,
    "wall": partial(slides_at, 35.0, 20.0),
    "stack": partial(slides_at, 35.0, 30.0),
}
SIZES = {"columns": (16, 1008, 10000), "wall": (100, 1000, 10000), "stack": (100, 1000, 10000)}


def many_sizes(name: str, quick: bool) -> list[Row]:
    """A scene at all its sizes, each in a process of its own with one thread."""
    rows: list[Row] = []
    for blocks in SIZES[name][:2] if quick else SIZES[name]:
        last = [row for row in rows if row.solver == SEQUENCE]
        passes = int(last[-1].note.split()[0]) if last else 0
        command = [
            sys.executable,
            "-m",
            "benchmarks",
            "case",
            name,
            str(blocks),
            str(passes),
            "quick" if quick else "",
        ]
        alone = os.environ | {
            "OPENBLAS_NUM_THREADS": "1",
            "OMP_NUM_THREADS": "1",
            "RAYON_NUM_THREADS": "1",
        }
        done = subprocess.run(command, capture_output=True, text=True, env=alone, check=False)
        if done.returncode:
            raise RuntimeError(f"{name}, {blocks} blocks: {done.stderr[-2000:]}")
        for found in json.loads(done.stdout.splitlines()[-1]):
            row = Row(**found)
            if row.solver == SEQUENCE and row.estimated:
                row = replace(row, error=last[-1].error)
            rows.append(row)
    return rows
