"""The command solve."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from slopekit.cli.common import (
    FILE,
    JOBS,
    JSON,
    SCHEDULER,
    SEED,
    SET,
    folder_of,
    json_text,
    load_design,
    number_of,
    whole_number,
    write,
)
from slopekit.cli.progress import progress

if TYPE_CHECKING:
    from slopekit.design.common import Design
    from slopekit.studies.running import Crew

_ABOUT = 60  # evaluations: for the bar


def add_to(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(solve)


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
    from slopekit.errors import DesignError, Fault
    from slopekit.studies.running import checked_crew

    folder = None if output is None else folder_of(Path(output))
    crew = checked_crew(jobs, scheduler)
    if pf is None and (n is not None or seed is not None):
        option = "-n" if n is not None else "--seed"
        raise DesignError([Fault("E313", f"{option} belongs to --pf: a factor of safety needs no samples", option)])
    read = load_design(design, sets)
    target = None if fos is None else number_of(fos, "--fos")
    if pf is not None:
        samples = None if n is None else whole_number(n, "-n")
        first = 1 if seed is None else whole_number(seed, "--seed")
        document, sheet, line, code = _by_probability(read, key, number_of(pf, "--pf"), target, samples, first, crew)
    else:
        from slopekit.studies.solve import solve as solve_design
        from slopekit.views.solve_sheet import solve_line, solve_sheet

        with progress("evaluations", _ABOUT) as advance:
            solution = solve_design(read, key, fos=target, crew=crew, advance=advance)
        document, code = json_text(solution.to_dict()), solution.exit_code
        sheet, line = solve_sheet(solution), solve_line(solution)
    if folder is not None:
        write(folder / "solve.json", document + "\n")
        write(folder / "solve.txt", sheet + "\n")
    typer.echo(document if as_json else line if quiet else sheet)
    raise typer.Exit(code)


def _by_probability(
    design: "Design", key: str, pf: float, fos: float | None, n: int | None, seed: int, crew: "Crew"
) -> tuple[str, str, str, int]:
    from slopekit.studies.solve_probability import solve_for_probability
    from slopekit.views.solve_sheet import probability_solution_line, probability_solution_sheet

    with progress("probabilities", _ABOUT) as advance:
        solution = solve_for_probability(design, key, pf, fos=fos, n=n, seed=seed, crew=crew, advance=advance)
    sheet, line = probability_solution_sheet(solution), probability_solution_line(solution)
    return json_text(solution.to_dict()), sheet, line, solution.exit_code
