"""Studies of one design: support."""

from pathlib import Path
from typing import Annotated

import typer

from slopekit.cli.common import FILE, JSON, SET, deliver, folder_of, load_design


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
