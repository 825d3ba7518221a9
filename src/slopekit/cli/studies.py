"""Studies of one design: solve, support."""

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
    deliver,
    folder_of,
    load_design,
)
from slopekit.cli.progress import progress
from slopekit.errors import DesignError, Fault
from slopekit.studies.protocol import number_of, whole_number

if TYPE_CHECKING:
    from slopekit.design.common import Design
    from slopekit.studies.running import Crew
    from slopekit.studies.solutions import Solution
    from slopekit.studies.solve_probability import ProbabilitySolution

_ABOUT = 60  # evaluations: for the bar


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


def support(
    design: Annotated[str, FILE],
    fos: Annotated[str, typer.Option(help="The factor of safety that is wanted.")] = "1.5",
    acts: Annotated[str | None, typer.Option(help="active (a load) or passive (strength) [both].")] = None,
    toward: Annotated[
        str | None,
        typer.Option(help="Direction of the bolts' force on the block, into the rock.", metavar="TREND/PLUNGE"),
    ] = None,
    plunge: Annotated[
        str | None,
        typer.Option(help="Plunges that can be drilled, positive downward: -5,15.", metavar="LEAST,MOST"),
    ] = None,
    bolt_capacity: Annotated[str, typer.Option(help="Of one bolt.")] = "200 kN",
    spacing: Annotated[str | None, typer.Option(help="Of the heads on the face [what the force asks for].")] = None,
    bond: Annotated[str, typer.Option(help="Anchorage behind the deepest joint.")] = "3 m",
    length: Annotated[str | None, typer.Option(help="Of every bolt [each as long as it must be].")] = None,
    sets: Annotated[list[str] | None, SET] = None,
    as_json: Annotated[bool, JSON] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="A line for each way the bolts act.")] = False,
    output: Annotated[
        str | None, typer.Option("-o", help="Folder for support.json, support.txt and the bolts as YAML.")
    ] = None,
) -> None:
    """Bolts for a factor of safety: force, best direction, pattern on the face, length; and pressure.

    For a wedge or a plane. Bolts that the design has stay and count. Exit codes: 0 reached (or nothing is needed),
    1 not reached, 4 the methods disagree.
    """
    from slopekit.studies.support import support as study
    from slopekit.views.support_sheet import support_line, support_sheet

    folder = None if output is None else folder_of(Path(output))
    found = study(
        load_design(design, sets), fos, acts=acts, toward=toward, plunge=plunge, bolt_capacity=bolt_capacity,
        spacing=spacing, bond=bond, length=length,
    )  # fmt: skip
    deliver(found, "support", support_sheet(found), support_line(found), folder, as_json, quiet,
            tables=found.snippets() if folder else {})  # fmt: skip
    raise typer.Exit(found.exit_code)
