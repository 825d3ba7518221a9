"""The command prob."""

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
    draw_to,
    folder_of,
    json_text,
    load_design,
    write,
)
from slopekit.cli.progress import progress

if TYPE_CHECKING:
    from slopekit.studies.probability import By


def add_to(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(prob)


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
    from slopekit.cli.common import number_of, whole_number
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
    record = study.to_dict()
    document, sheet = json_text(record), probability_sheet(study)
    if folder is not None:
        write(folder / "prob.json", document + "\n")
        write(folder / "prob.txt", sheet + "\n")
        write_samples(study, folder / "samples.csv")
        study.discard_journals()
    typer.echo(document if as_json else probability_line(study) if quiet else sheet)
    draw_to(record, "histogram", image, folder / "histogram.png" if folder else None)
    raise typer.Exit(study.exit_code)
