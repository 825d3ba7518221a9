"""The command report: the JSON of a result as one self-contained page."""

from pathlib import Path
from typing import Annotated

import typer

from slopekit._version import __version__
from slopekit.cli.common import JSON, folder_of, json_text
from slopekit.errors import DesignError, Fault


def add_to(app: typer.Typer) -> None:
    """Add this command."""
    app.command()(report)


def report(
    result: Annotated[str, typer.Argument(help="result.json of run or wedge, or its folder.", metavar="RESULT")],
    output: Annotated[str | None, typer.Option("-o", help="The page to write, .html [report.html beside it].")] = None,
    no_pictures: Annotated[
        bool, typer.Option("--no-pictures", help="Without still pictures: quicker, smaller; the view to turn stays.")
    ] = False,
    as_json: Annotated[bool, JSON] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing on success.")] = False,
) -> None:
    """One self-contained page of a result: the answer, its check, pictures, a view to turn (extra: report)."""
    from slopekit.views.plots import read_document
    from slopekit.views.report import require_jinja, write_report

    source = Path(result)
    source = source / "result.json" if source.is_dir() else source
    target = source.parent / "report.html" if output is None else Path(output)
    if target.is_dir():
        target = target / "report.html"
    if target.suffix.lower() not in (".html", ".htm"):
        raise DesignError([Fault("E373", f"the page {target} is not a .html file", str(target), "-o report.html")])
    require_jinja(target)
    document = read_document(source)
    folder_of(target.parent)
    made = write_report(document, target, str(source), not no_pictures)
    size = target.stat().st_size
    if as_json:
        said = {
            "slopekit": __version__, "report": str(target), "bytes": size, "pictures": list(made.pictures),
            "missing": list(made.missing), "warnings": [{"code": n.code, "message": n.message} for n in made.notices],
        }  # fmt: skip
        typer.echo(json_text(said))
    elif not quiet:
        typer.echo(f"wrote {target} ({size / 1e3:.0f} kB)")
        for one in made.missing:
            typer.echo(f"     not drawn: {one}")
        for notice in made.notices:
            typer.echo(f"     {notice}")
