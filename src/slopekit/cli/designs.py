"""Commands on one design: wedge, run, check, lint."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from slopekit._version import __version__
from slopekit.cli.common import (
    FILE,
    JSON,
    SET,
    checked_image,
    deliver,
    draw_to,
    folder_of,
    json_text,
    load_design,
)
from slopekit.cli.progress import progress, watched
from slopekit.errors import DesignError, Fault

if TYPE_CHECKING:
    pass

SCENE_ENDINGS = (".png", ".glb", ".gltf")
_PICTURE = typer.Option(help="Draw the slope and its blocks to a .png, .glb or .gltf file (extra: plot).")
_NO_PICTURES = typer.Option("--no-pictures", help="With -o: draw nothing.")
_PICTURES = ("scene", "elevation", "mechanism", "stereonet", "reduction")


def check(
    design: Annotated[str | None, typer.Argument(help="A design file (YAML).", metavar="DESIGN")] = None,
    suite: Annotated[bool, typer.Option("--suite", help="The verification suite: published and exact cases.")] = False,
    sets: Annotated[list[str] | None, SET] = None,
    picture: Annotated[
        str | None, typer.Option(help="Draw time against error to a .png, .svg or .pdf file (extra: plot).")
    ] = None,
    as_json: Annotated[bool, JSON] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="One line: the verdict.")] = False,
    output: Annotated[str | None, typer.Option("-o", help="Folder for check.json, check.txt, speed-error.png.")] = None,
) -> None:
    """Closed form against PRE-IE on a design, speed against error; or the verification suite.

    Takes a few seconds for one block, up to minutes for a bench. Exit codes: 0 consistent or nothing independent to
    judge by, 1 consistent but an acceptance rule is not met, 4 not consistent. With --suite -o DIR writes
    verification.md and verification.json.
    """
    if suite != (design is None):
        message = "check takes a design file or --suite" + (", not both" if suite else "")
        raise DesignError([Fault("E270", message, "", "slopekit check my.yaml, or slopekit check --suite")])
    if suite and (sets or picture):
        raise DesignError([Fault("E271", "--set and --picture belong to a design file, --suite takes neither")])
    folder = None if output is None else folder_of(Path(output))
    if design is None:
        _check_suite(folder, as_json, quiet)
    from slopekit.studies.check import check as check_design
    from slopekit.views.check_sheet import check_line, check_sheet

    image = checked_image(picture)
    read = load_design(design or "", sets)
    with watched():
        checked = check_design(read)
    deliver(checked, "check", check_sheet(checked), check_line(checked), folder, as_json, quiet, what="speed-error",
            image=image)  # fmt: skip
    if folder is not None and checked.normals:
        draw_to(checked.to_dict(), "normals", folder / "normals.png")
    raise typer.Exit(checked.exit_code)


def _check_suite(folder: Path | None, as_json: bool, quiet: bool) -> None:
    from slopekit.studies.references import chosen
    from slopekit.studies.suite import verify
    from slopekit.views.verification import summary, table, write

    with progress("cases", len(chosen(None))) as advance:
        verification = verify(progress=lambda _done, _of: advance(1))
    if folder is not None:
        write(verification, folder)
    document = json_text(verification.to_dict()) if as_json else ""
    typer.echo(document or (summary(verification) if quiet else table(verification)))
    raise typer.Exit(verification.exit_code)


def lint(
    design: Annotated[str, FILE],
    sets: Annotated[list[str] | None, SET] = None,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Read and test a design file, run nothing."""
    read = load_design(design, sets)
    if as_json:
        document = {
            "slopekit": __version__, "kind": read.kind, "input_sha256": read.input_hash(), "inputs": read.inputs(),
            "assumed": dict(read.assumed), "defaults": list(read.defaults), "errors": [],
        }  # fmt: skip
        typer.echo(json_text(document))
        return
    head = f"ok   {Path(design).name}: a {read.kind} design, sha {read.input_hash()[:6]}"
    typer.echo(f"{head} (whether it forms a block, run says)")
    for name, value in read.assumed:
        typer.echo(f"     {name} is a distribution: run takes {value}")
    if read.defaults:
        typer.echo(f"     left out, taken by default: {', '.join(read.defaults)}")
