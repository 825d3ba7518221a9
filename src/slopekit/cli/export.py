"""The command export: blocks, interfaces and node pairs of a result as files of other programs."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from slopekit._version import __version__
from slopekit.cli.common import JSON, json_text

if TYPE_CHECKING:
    from slopekit.exchange.export import Written


def add_to(app: typer.Typer) -> None:
    """Add this command."""
    app.command()(export)


def export(
    result: Annotated[str, typer.Argument(help="A result: DIR of run -o DIR, or its result.json.", metavar="RESULT")],
    output: Annotated[
        str | None, typer.Option("-o", help="The file: .stl .obj .glb .gltf .vtu .dxf (extra: cad).", metavar="FILE")
    ] = None,
    what: Annotated[str, typer.Option(help="blocks, interfaces, pairs; several with commas.")] = "blocks",
    blocks: Annotated[str | None, typer.Option(help="Only these: B1,B7.", metavar="NAMES")] = None,
    moving: Annotated[bool, typer.Option("--moving", help="Leave bedrock out.")] = False,
    binary: Annotated[bool, typer.Option("--binary", help="STL in binary: float32, smaller.")] = False,
    split: Annotated[
        str | None, typer.Option(help="A folder for one mesh a block and blocks.yaml that reads them.", metavar="DIR")
    ] = None,
    split_as: Annotated[str, typer.Option("--as", help="Meshes of --split: stl or obj.")] = "stl",
    as_json: Annotated[bool, JSON] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="The names of the files only.")] = False,
) -> None:
    """Blocks, interfaces or node pairs of a result for CAD, ParaView and other programs, in your own coordinates."""
    from slopekit.exchange.export import export as export_result

    done = export_result(
        result, None if output is None else Path(output), what=what, blocks=blocks, moving=moving, binary=binary,
        split=None if split is None else Path(split), split_as=split_as,
    )  # fmt: skip
    if as_json:
        typer.echo(json_text({"slopekit": __version__, **done.to_dict()}))
    elif quiet:
        typer.echo("\n".join(str(path) for path in done.files))
    else:
        for one in done.written:
            typer.echo("\n".join(_lines(one)))
        for notice in done.warnings:
            typer.echo(f"NOTE      {notice}")
        if split is not None and done.files and done.written[-1].files[0].suffix == ".yaml":
            typer.echo(f"try: slopekit run {done.written[-1].files[0]}")


def _lines(one: "Written") -> list[str]:
    """What was written, for a person."""
    counts = [
        f"{count} {word if count != 1 else word[:-1]}"
        for count, word in ((one.blocks, "blocks"), (one.interfaces, "interface polygons"), (one.pairs, "node pairs"))
        if count
    ]
    volume = "" if one.volume_m3 is None else f", {one.volume_m3:.9g} m³"
    files = [str(path) for path in one.files]
    if len(one.files) > 4:
        files = [str(one.files[0]), f"and {len(one.files) - 1} files beside it"]
    return [
        f"WROTE     {', '.join(files)}",
        f"          {one.format}, metres: {', '.join(counts)}{volume}",
        f"PRECISION {one.precision}",
    ]
