"""The pictures of an outcome: the one of `--picture`, and those in the folder of `-o`."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import typer

from slopekit.cli.common import folder_of, print_faults
from slopekit.cli.progress import aside
from slopekit.core.errors import DesignError, Fault
from slopekit.core.progress import report_stage
from slopekit.core.report import Report
from slopekit.studies.protocol import StudyOutcome

_RESULT_PICTURES = ("scene", "elevation", "mechanism", "stereonet", "reduction")


def picture_of(picture: str | None, of_result: bool) -> Path | None:
    """Return the path of `--picture`; refuse it before any work is done where it cannot be drawn."""
    if picture is None:
        return None
    from slopekit.views.charts.drawing import FORMATS, require_matplotlib

    path, endings = Path(picture), (".png", ".glb", ".gltf") if of_result else FORMATS
    if path.suffix.lower() not in endings:
        listed_endings = f"{', '.join(endings[:-1])} or {endings[-1]}"
        advice = f"Give it one of these endings: {', '.join(endings)}."
        raise DesignError(
            [Fault("E141", f"the picture {path} is not a {listed_endings} file", str(path), advice)]
        )
    if not path.parent.is_dir():
        raise DesignError(
            [Fault("E129", f"there is no folder {path.parent} for the picture", str(path))]
        )
    folder_of(path.parent)
    if not of_result:
        require_matplotlib(path)
    elif path.suffix.lower() == ".png":
        from slopekit.views.solid.rendering import require_drawing

        require_drawing(path)
    return path


def draw(
    outcome: Report,
    record: dict[str, Any],
    folder: Path | None,
    image: Path | None,
    removed: Sequence[Path],
    *,
    plain: bool = False,
) -> None:
    """Draw an outcome: its first picture to `image`, all of them into a folder.

    Parameters
    ----------
    removed : the pictures of an earlier outcome; those of the folder that are not drawn again are said
    plain : draw none into the folder
    """
    charts = outcome.charts if isinstance(outcome, StudyOutcome) else ("scene",)
    if image is not None and charts:
        _draw_to(record, charts[0], image)
    elif image is not None:
        message = f"this {outcome.name} has nothing to draw: {image} is not written"
        print_faults(DesignError([Fault("E273", message, "--picture")]), plainly=True)
    if folder is not None:
        if not isinstance(outcome, StudyOutcome):
            charts = () if plain else _pictures_of_result(record, folder)
        for picture in charts:
            _draw_to(record, picture, folder / f"{picture}.png")
        say_removed([path for path in removed if path.parent == folder and not path.exists()])


def say_removed(paths: Sequence[Path], description: str = "pictures") -> None:
    """Say which files of an earlier outcome are gone."""
    if paths:
        with aside():
            names = ", ".join(path.name for path in paths)
            typer.echo(f"{description} of an earlier result were removed: {names}", err=True)


def _pictures_of_result(record: dict[str, Any], folder: Path) -> tuple[str, ...]:
    """Return the pictures that a result can give; none where they cannot be drawn, with one line on stderr."""
    from slopekit.views.plots import offers
    from slopekit.views.solid.rendering import require_drawing

    try:
        require_drawing(folder)
    except DesignError as error:
        (fault,) = error.faults
        message = f"pictures are left out: {fault.code} {fault.message}"
        with aside():
            typer.echo(f"result.json and sheet.txt are written, {message}", err=True)
        return ()
    available = offers(record)
    return tuple(picture for picture in _RESULT_PICTURES if picture in available)


def _draw_to(document: dict[str, Any], picture: str, path: Path) -> None:
    """Draw a picture; a fault is printed and the command goes on.

    A file that cannot be written ends the command with exit code 2.
    """
    from slopekit.views.plots import draw

    report_stage(picture)
    try:
        draw(document, picture, path)
    except DesignError as error:
        print_faults(error, plainly=True)
        if "E129" in error.codes:
            raise typer.Exit(error.exit_code) from None


def remove_older(outcome: Report, folder: Path) -> list[Path]:
    """Remove the pictures of an earlier outcome, and its bolts where this one has none; the pictures removed."""
    if outcome.parts:
        return [
            path
            for name, case_outcome in outcome.parts.items()
            for path in remove_older(case_outcome, folder / name)
        ]
    if isinstance(outcome, StudyOutcome):
        return _remove([folder / f"{picture}.png" for picture in outcome.charts], "pictures")
    path = folder / "bolts.csv"
    if path.is_file() and not outcome.to_dict()["inputs"].get("bolts"):
        from slopekit.kinds.sheets.bolts import schedule_table

        if path.read_bytes().startswith(schedule_table([]).csv().strip().encode()):
            say_removed(_remove([path], "the bolts"), "the bolts")
    return _remove([folder / f"{picture}.png" for picture in _RESULT_PICTURES], "pictures")


def _remove(paths: Sequence[Path], description: str) -> list[Path]:
    """Remove those of the files that are there, and return them; E129 where one cannot be removed."""
    present = [path for path in paths if path.exists()]
    try:
        for path in present:
            path.unlink()
    except OSError as error:
        folder = paths[0].parent
        message = f"{folder} holds {description} of an earlier result: {error.strerror or error}"
        raise DesignError([Fault("E129", message, str(folder))]) from None
    return present
