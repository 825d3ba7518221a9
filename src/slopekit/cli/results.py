"""What the commands of results, wedge and run, have of their own: their files, the schedule of bolts, the pictures."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import typer

from slopekit.cli.common import FOLDER, QUIET, draw_to
from slopekit.cli.progress import aside
from slopekit.core.errors import DesignError, Fault

#: The options of every command that are other ones for results.
OPTIONS = {
    "picture": typer.Option(help="Draw the slope and its blocks to a .png, .glb or .gltf file (extra: plot)."),
    "no_pictures": typer.Option("--no-pictures", help="With -o: draw nothing."),
    "quiet": QUIET, "output": FOLDER,
}  # fmt: skip
_PICTURES = ("scene", "elevation", "mechanism", "stereonet", "reduction")


def remove_older(record: dict[str, Any], folder: Path) -> list[Path]:
    """Remove the pictures of an earlier result, and its bolts where this one has none; the pictures removed."""
    _remove_schedule(record, folder)
    return remove([folder / f"{what}.png" for what in _PICTURES], "pictures")


def finish(
    record: dict[str, Any], folder: Path | None, image: Path | None, plain: bool, removed: Sequence[Path]
) -> None:  # fmt: skip
    """Draw the pictures of a result; say which of the `removed` ones of an earlier result it has not."""
    if image is not None:
        draw_to(record, "scene", image)
    if folder is not None:
        drawn = [] if plain else _drawn(record, folder)
        gone = ", ".join(path.name for path in removed if path.parent == folder and path.stem not in drawn)
        if gone:
            with aside():
                typer.echo(f"pictures of an earlier result were removed: {gone}", err=True)


def _remove_schedule(record: dict[str, Any], folder: Path) -> None:
    path = folder / "bolts.csv"
    if record["inputs"].get("bolts") or not path.is_file():
        return
    from slopekit.kinds.sheets.bolts import schedule_table

    if path.read_bytes().startswith(schedule_table([]).csv().strip().encode()):
        remove([path], "the bolts")
        with aside():
            typer.echo(f"the bolts of an earlier result were removed: {path.name}", err=True)


def remove(paths: Sequence[Path], what: str) -> list[Path]:
    """Remove those of the files that are there, and return them; E129 where one cannot be removed."""
    present = [path for path in paths if path.exists()]
    try:
        for path in present:
            path.unlink()
    except OSError as error:
        folder = paths[0].parent
        message = f"{folder} holds {what} of an earlier result: {error.strerror or error}"
        raise DesignError([Fault("E129", message, str(folder))]) from None
    return present


def _drawn(record: dict[str, Any], folder: Path) -> list[str]:
    """Draw what the result can give; the names of what was drawn."""
    from slopekit.views.plots import offers
    from slopekit.views.solid.rendering import require_drawing

    try:
        require_drawing(folder)
    except DesignError as error:  # everything else is there: say once what is missing
        (fault,) = error.faults
        left = f"pictures are left out: {fault.code} {fault.message}"
        with aside():
            typer.echo(f"result.json and sheet.txt are written, {left}", err=True)
        return []
    given = offers(record)
    for what in _PICTURES:
        if what in given:
            draw_to(record, what, folder / f"{what}.png")
    return [what for what in _PICTURES if (folder / f"{what}.png").exists()]
