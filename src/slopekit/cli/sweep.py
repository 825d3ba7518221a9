"""The command sweep: curves, grids, tornados."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from slopekit.cli.common import (
    FILE,
    JOBS,
    JSON,
    SCHEDULER,
    SET,
    checked_image,
    draw_to,
    folder_of,
    json_text,
    load_design,
    number_of,
    write,
)
from slopekit.cli.progress import progress
from slopekit.errors import DesignError, Fault

if TYPE_CHECKING:
    from slopekit.studies.sweep import Methods, Sweep
    from slopekit.studies.tornado import Tornado

_KEYS = typer.Argument(help="KEY=from:to:how many, KEY=a,b,c; one key or two. With --tornado KEY=lo:hi.",
                       metavar="KEY=VALUES")  # fmt: skip


def add_to(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(sweep)


def sweep(
    design: Annotated[str, FILE],
    keys: Annotated[list[str] | None, _KEYS] = None,
    tornado: Annotated[bool, typer.Option("--tornado", help="Every number of the design, one at a time.")] = False,
    closed_form: Annotated[bool, typer.Option("--closed-form", help="The closed form alone: quick.")] = False,
    pre_ie: Annotated[bool, typer.Option("--pre-ie", help="PRE-IE alone.")] = False,
    fos: Annotated[str | None, typer.Option(help="A factor of safety: where it is passed is said.")] = None,
    jobs: Annotated[str, JOBS] = "1",
    scheduler: Annotated[str | None, SCHEDULER] = None,
    sets: Annotated[list[str] | None, SET] = None,
    picture: Annotated[str | None, typer.Option(help="Draw it to a .png, .svg or .pdf file (extra: plot).")] = None,
    as_json: Annotated[bool, JSON] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="One line: points, factors, check.")] = False,
    output: Annotated[str | None, typer.Option("-o", help="Folder for sweep.json, .txt, .csv and a picture.")] = None,
) -> None:
    """A design at many values of one number (a curve) or of two (a grid), or of each in turn (--tornado).

    Points that form no block are kept, with their reason. Exit codes: 0 done, 3 no point forms a block, 4 the methods
    disagree at a point, or no convergence.
    """
    folder = None if output is None else folder_of(Path(output))
    image = checked_image(picture)
    if closed_form and pre_ie:
        raise DesignError([Fault("E313", "--closed-form and --pre-ie exclude each other", "", "Leave both out.")])
    if tornado and fos is not None:
        raise DesignError([Fault("E313", "--fos says nothing of a tornado", "--fos", "Leave it out.")])
    methods: Methods = "closed-form" if closed_form else "pre-ie" if pre_ie else "both"
    given = _given(keys or [])
    study = (_tornado if tornado else _sweep)(design, sets, given, methods, fos, jobs, scheduler, folder)
    _finish(study, folder, image, as_json, quiet)


def _given(keys: list[str]) -> dict[str, str]:
    """Paths and what follows their equals signs."""
    faults, found = [], dict[str, str]()
    for text in keys:
        path, equals, values = text.partition("=")
        path = path.strip()
        if not equals:
            advice = f"Write {path}=60:80:5 (from, to, how many), or {path}=60,70,80."
            faults.append(Fault("E312", f"{path} has no values", text, advice))
        elif path in found:
            faults.append(Fault("E313", f"{path} is given twice", text, "Give it once."))
        found[path] = values
    if faults:
        raise DesignError(faults)
    return found


def _sweep(
    design: str, sets: list[str] | None, given: dict[str, str], methods: "Methods", fos: str | None, jobs: str,
    scheduler: str | None, folder: Path | None,
) -> "Sweep":  # fmt: skip
    from slopekit.studies.running import checked_crew
    from slopekit.studies.sweep import one_or_two
    from slopekit.studies.sweep import sweep as sweep_design

    one_or_two(given)
    target = None if fos is None else number_of(fos, "--fos")
    return sweep_design(load_design(design, sets), given, methods=methods, fos=target,
                        crew=checked_crew(jobs, scheduler), folder=folder, bar=progress)  # fmt: skip


def _tornado(
    design: str, sets: list[str] | None, given: dict[str, str], methods: "Methods", _fos: str | None, jobs: str,
    scheduler: str | None, folder: Path | None,
) -> "Tornado":  # fmt: skip
    from slopekit.studies.running import checked_crew
    from slopekit.studies.tornado import tornado as tornado_of

    crew = checked_crew(jobs, scheduler)
    return tornado_of(load_design(design, sets), given, methods=methods, crew=crew, folder=folder, bar=progress)


def _finish(study: "Sweep | Tornado", folder: Path | None, image: Path | None, as_json: bool, quiet: bool) -> None:
    """Write and print a study, draw it where matplotlib is there, and leave with its exit code."""
    from slopekit.studies.sweep import Sweep
    from slopekit.views.sweep_sheet import sweep_csv, sweep_line, sweep_sheet, tornado_line, tornado_sheet

    name, record = "sweep" if isinstance(study, Sweep) else "tornado", study.to_dict()
    document = json_text(record)
    if isinstance(study, Sweep):
        sheet, line = sweep_sheet(study), sweep_line(study)
        what = "curve" if len(study.keys) == 1 else "contour"
    else:
        sheet, line, what = tornado_sheet(study), tornado_line(study), "tornado"
    if folder is not None:
        write(folder / f"{name}.json", document + "\n")
        write(folder / f"{name}.txt", sheet + "\n")
        if isinstance(study, Sweep):
            write(folder / "sweep.csv", sweep_csv(study))
    typer.echo(document if as_json else line if quiet else sheet)
    draw_to(record, what, image, folder / f"{what}.png" if folder else None)
    raise typer.Exit(study.exit_code)
