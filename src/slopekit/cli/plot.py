"""The command plot: pictures of anything that slopekit has written."""

from pathlib import Path
from typing import Annotated

import typer

from slopekit.cli.common import folder_of, number_of, whole_number

_WHAT = typer.Argument(help="The picture; without it: the pictures that this file can give.", metavar="WHAT")


def add_to(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(plot)


def plot(
    result: Annotated[str, typer.Argument(help="JSON that slopekit wrote (result.json, sweep.json), or its folder.",
                                          metavar="RESULT")],
    what: Annotated[str | None, _WHAT] = None,
    output: Annotated[str | None, typer.Option("-o", help="The file [RESULT-WHAT.png]; charts .png .svg .pdf, "
                                               "scenes .png .glb .gltf.")] = None,
    show: Annotated[bool, typer.Option("--show", help="Open a window, write nothing.")] = False,
    equal_angle: Annotated[bool, typer.Option("--equal-angle", help="Stereonet: equal angle, not equal area.")] = False,
    test: Annotated[str | None, typer.Option(help="Stereonet of kinematic: planar, wedge or toppling [all].")] = None,
    explode: Annotated[str | None, typer.Option(help="exploded: how far blocks are drawn apart.")] = None,
    magnify: Annotated[str | None, typer.Option(help="displacement, mechanism: drawn times this.")] = None,
    step: Annotated[str, typer.Option(help="mechanism: which one, 1 the first.")] = "1",
) -> None:  # fmt: skip
    """A picture of any JSON that slopekit wrote (extra: plot).

    Scenes: scene exploded tractions forces displacement mechanism factors ravelling. Charts: stereonet histogram curve
    contour tornado speed-error reduction normals. Without WHAT: those that the file can give.
    """
    from slopekit.views import plots

    path = plots.document_file(Path(result))
    document = plots.read_document(path)
    if what is None:
        typer.echo(_listed(path, plots.offers(document)))
        return
    options = plots.Options(
        show=show, net="angle" if equal_angle else "area", test=test,
        explode=None if explode is None else number_of(explode, "--explode"),
        magnify=None if magnify is None else number_of(magnify, "--magnify"), step=whole_number(step, "--step"),
    )  # fmt: skip
    target = path.with_name(f"{path.stem}-{what}.png") if output is None else Path(output)
    if target.is_dir():
        target = target / f"{path.stem}-{what}.png"
    plots.check(document, what, target, options, path.name)
    if not show:
        folder_of(target.parent)
    plots.draw(document, what, None if show else target, options, path.name)
    if not show:
        typer.echo(f"wrote {target}")


def _listed(path: Path, given: dict[str, str]) -> str:
    if not given:
        return f"{path.name} has nothing that can be drawn"
    lines = [f"{path.name} can give", *(f"  {what:<14}{shows}" for what, shows in given.items())]
    return "\n".join([*lines, f"for example: slopekit plot {path} {next(iter(given))}"])
