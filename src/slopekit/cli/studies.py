"""Studies of one design: prob, solve."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from slopekit.cli.common import (
    FILE,
    JOBS,
    JSON,
    SCHEDULER,
    SEED,
    SET,
    checked_image,
    deliver,
    folder_of,
    load_design,
)
from slopekit.cli.progress import progress
from slopekit.errors import DesignError, Fault
from slopekit.studies.protocol import number_of, whole_number

if TYPE_CHECKING:
    from slopekit.design.common import Design
    from slopekit.studies.probability import By
    from slopekit.studies.running import Crew
    from slopekit.studies.solutions import Solution
    from slopekit.studies.solve_probability import ProbabilitySolution

_ABOUT = 60  # evaluations: for the bar


def prob(
    design: Annotated[str, FILE],
    n: Annotated[str | None, typer.Option("-n", help="Samples [20000; 1000 where PRE-IE does them all].")] = None,
    method: Annotated[str, typer.Option(help="monte-carlo, latin-hypercube or sobol.")] = "monte-carlo",
    by: Annotated[str | None, typer.Option(help="closed-form or pre-ie: whose factors count.")] = None,
    fos: Annotated[str, typer.Option(help="What fails has a factor of safety below this.")] = "1",
    confirm: Annotated[str, typer.Option(help="Samples at random that PRE-IE looks at too.")] = "200",
    near: Annotated[str | None, typer.Option(help="It looks at all within this of the target [1%].")] = None,
    confidence: Annotated[str, typer.Option(help="Of the confidence limits.")] = "95%",
    accept: Annotated[
        str | None, typer.Option(help="Largest probability accepted; exit code 1 where the upper limit lies above.")
    ] = None,
    seed: Annotated[str, SEED] = "1",
    jobs: Annotated[str, JOBS] = "1",
    scheduler: Annotated[str | None, SCHEDULER] = None,
    sets: Annotated[list[str] | None, SET] = None,
    picture: Annotated[
        str | None, typer.Option(help="Draw a histogram to a .png, .svg or .pdf file (extra: plot).")
    ] = None,
    as_json: Annotated[bool, JSON] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="One line: the probability and its limits.")] = False,
    output: Annotated[str | None, typer.Option("-o", help="Folder for prob.json, .txt, samples.csv, picture.")] = None,
) -> None:
    """Probability of failure: Monte Carlo, Latin hypercube or Sobol on the distributions of a design.

    The closed form judges every sample; PRE-IE looks at some at random and at all near the target. Ctrl-C keeps what
    is done: the same command goes on from there. Exit codes: 0 done, 1 not accepted, 4 the methods disagree.
    """
    from slopekit.studies.probability import probability
    from slopekit.studies.probability_records import write_samples
    from slopekit.studies.running import checked_crew
    from slopekit.views.probability_sheet import probability_line, probability_sheet

    folder = None if output is None else folder_of(Path(output))
    image = checked_image(picture)
    study = probability(
        load_design(design, sets), None if n is None else whole_number(n, "-n"), seed=whole_number(seed, "--seed"),
        method=method, by=cast("By | None", by), target=number_of(fos, "--fos"),
        confirm_count=whole_number(confirm, "--confirm"), near=None if near is None else number_of(near, "--near"),
        confidence=number_of(confidence, "--confidence"),
        accept=None if accept is None else number_of(accept, "--accept"),
        crew=checked_crew(jobs, scheduler), folder=folder, bar=progress,
    )  # fmt: skip
    if folder is not None:
        write_samples(study, folder / "samples.csv")
    deliver(study, "prob", probability_sheet(study), probability_line(study), folder, as_json, quiet, what="histogram",
            image=image)  # fmt: skip
    if folder is not None:
        study.discard_journals()
    raise typer.Exit(study.exit_code)


def solve(
    design: Annotated[str, FILE],
    key: Annotated[str, typer.Argument(help="strength.weak.phi, or with a range: slope.height=10m:40m", metavar="KEY")],
    fos: Annotated[str | None, typer.Option(help="Factor of safety wanted [the acceptance rule's].")] = None,
    pf: Annotated[str | None, typer.Option("--pf", help="Probability of failure wanted instead, 5% or 0.05.")] = None,
    n: Annotated[str | None, typer.Option("-n", help="With --pf: samples [20000].")] = None,
    seed: Annotated[str | None, SEED] = None,
    jobs: Annotated[str, JOBS] = "1",
    scheduler: Annotated[str | None, SCHEDULER] = None,
    sets: Annotated[list[str] | None, SET] = None,
    as_json: Annotated[bool, JSON] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="One line: the value, status, check.")] = False,
    output: Annotated[str | None, typer.Option("-o", help="Folder for solve.json, solve.txt.")] = None,
) -> None:
    """The value of any one number of a design that gives a target, by both methods.

    With --pf, --fos is what fails lies below [1]. Exit codes: 0 found, 1 there is no such value (the sheet says why),
    4 the methods disagree at it.
    """
    from slopekit.studies.running import checked_crew

    folder = None if output is None else folder_of(Path(output))
    crew = checked_crew(jobs, scheduler)
    if pf is None and (n is not None or seed is not None):
        option = "-n" if n is not None else "--seed"
        raise DesignError([Fault("E313", f"{option} belongs to --pf: a factor of safety needs no samples", option)])
    read = load_design(design, sets)
    target = None if fos is None else number_of(fos, "--fos")
    solution: Solution | ProbabilitySolution
    if pf is not None:
        samples = None if n is None else whole_number(n, "-n")
        first = 1 if seed is None else whole_number(seed, "--seed")
        solution, sheet, line = _by_probability(read, key, number_of(pf, "--pf"), target, samples, first, crew)
    else:
        from slopekit.studies.solve import solve as solve_design
        from slopekit.views.solve_sheet import solve_line, solve_sheet

        with progress("evaluations", _ABOUT) as advance:
            solution = solve_design(read, key, fos=target, crew=crew, advance=advance)
        sheet, line = solve_sheet(solution), solve_line(solution)
    deliver(solution, "solve", sheet, line, folder, as_json, quiet)
    raise typer.Exit(solution.exit_code)


def _by_probability(
    design: "Design", key: str, pf: float, fos: float | None, n: int | None, seed: int, crew: "Crew"
) -> "tuple[ProbabilitySolution, str, str]":
    from slopekit.studies.solve_probability import solve_for_probability
    from slopekit.views.solve_sheet import probability_solution_line, probability_solution_sheet

    with progress("probabilities", _ABOUT) as advance:
        solution = solve_for_probability(design, key, pf, fos=fos, n=n, seed=seed, crew=crew, advance=advance)
    return solution, probability_solution_sheet(solution), probability_solution_line(solution)
