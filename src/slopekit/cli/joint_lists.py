"""A command on a list of joints: combos."""

from pathlib import Path
from typing import Annotated

import typer

from slopekit.cli.common import JOBS, JSON, SCHEDULER, deliver, folder_of
from slopekit.cli.progress import progress

LIST = typer.Argument(help="A joint list (CSV): dip and dip direction, or strike by a convention.", metavar="JOINTS")
FACE = typer.Option(help="Slope face, D/DD: has to be given.")
CONVENTION = typer.Option(help="What a strike column means: right-hand-rule or left-hand-rule.")
SKIP_BAD = typer.Option("--skip-bad", help="Leave bad rows out, listed, where they would stop the run.")


def combos(
    joints: Annotated[str, LIST],
    face: Annotated[str | None, FACE] = None,
    upper: Annotated[str | None, typer.Option(help="Upper slope, D/DD [level].")] = None,
    height: Annotated[
        str | None, typer.Option(help="Vertical, from a wedge's toe up the dip of the face to the crest [15 m].")
    ] = None,
    c: Annotated[str | None, typer.Option("--c", help="Cohesion of joints without their own.")] = None,
    phi: Annotated[str | None, typer.Option(help="Friction angle of joints without their own.")] = None,
    density: Annotated[str | None, typer.Option(help="Density [2600 kg/m3].")] = None,
    unit_weight: Annotated[str | None, typer.Option(help="Unit weight, kN/m3, instead of a density.")] = None,
    water: Annotated[str | None, typer.Option(help="dry, full, 50% or u=9.8kPa [dry].")] = None,
    seismic: Annotated[str | None, typer.Option(help="Pseudo-static coefficient, K or K@TREND.")] = None,
    fos: Annotated[str | None, typer.Option(help="Target: exit code 1 where a removable pair lies below.")] = None,
    top: Annotated[str | None, typer.Option(help="How many of the worst PRE-IE looks at [10].")] = None,
    persistence: Annotated[str | None, typer.Option(help="Longest edge of a joint in a wedge, m.")] = None,
    bench_width: Annotated[str | None, typer.Option(help="How far behind the crest wedges reach, m.")] = None,
    max_volume: Annotated[str | None, typer.Option(help="Wedges are scaled down to it, m3.")] = None,
    min_volume: Annotated[str | None, typer.Option(help="Smaller wedges are left out, and counted, m3.")] = None,
    agree_within: Annotated[str | None, typer.Option(help="Largest difference of the two methods [1%].")] = None,
    gravity: Annotated[str | None, typer.Option(help="[9.81 m/s2]")] = None,
    water_unit_weight: Annotated[str | None, typer.Option(help="[9.81 kN/m3]")] = None,
    convention: Annotated[str | None, CONVENTION] = None,
    skip_bad: Annotated[bool, SKIP_BAD] = False,
    jobs: Annotated[str, JOBS] = "1",
    scheduler: Annotated[str | None, SCHEDULER] = None,
    as_json: Annotated[bool, JSON] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="One line: counts, the worst, agreement.")] = False,
    output: Annotated[str | None, typer.Option("-o", help="Folder for combos.json, combos.txt, pairs.csv.")] = None,
) -> None:
    """Every pair of a joint list as a wedge: removable or not and why, ranked; PRE-IE on the worst.

    Columns c and phi of the list count before --c and --phi. Exit codes: 0 done, 1 pairs below --fos, 2 bad input, 4
    the methods disagree.
    """
    from slopekit.studies.combos import combos as look_at
    from slopekit.studies.running import checked_crew
    from slopekit.views.combos_sheet import combos_line, combos_sheet, pairs_csv

    folder = None if output is None else folder_of(Path(output))
    given = {
        "face": face, "upper": upper, "height": height, "c": c, "phi": phi, "density": density,
        "unit_weight": unit_weight, "water": water, "seismic": seismic, "gravity": gravity,
        "water_unit_weight": water_unit_weight, "agree_within": agree_within,
    }  # fmt: skip
    limits = {
        "persistence": persistence, "bench_width": bench_width, "max_volume": max_volume, "min_volume": min_volume,
    }  # fmt: skip
    found = look_at(
        joints, given, convention=convention, skip_bad=skip_bad, fos=fos, top=top, limits=limits,
        crew=checked_crew(jobs, scheduler), bar=progress, option=_option,
    )  # fmt: skip
    tables = {"pairs.csv": pairs_csv(found)} if folder else {}
    deliver(found, "combos", combos_sheet(found), combos_line(found), folder, as_json, quiet, tables=tables)
    raise typer.Exit(found.exit_code)


def _option(key: str) -> str:
    return "--" + key.replace("_", "-")
