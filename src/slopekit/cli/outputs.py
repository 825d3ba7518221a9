"""The commands that read results and studies: plot, export, report."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from slopekit._version import __version__
from slopekit.cli.common import CASE, JSON, folder_of, json_text
from slopekit.cli.progress import watched
from slopekit.core.errors import DesignError, Fault
from slopekit.studies.protocol import whole_number

if TYPE_CHECKING:
    from slopekit.exchange.export import Written


def _pictures(incomplete: str) -> list[str]:
    """The pictures that begin so, for the shell, whatever the file can give."""
    from slopekit.views.plots import EVERY

    return [picture for picture in EVERY if picture.startswith(incomplete)]


_WHAT = typer.Argument(
    help="The picture; without it: the pictures that this file can give.",
    metavar="WHAT",
    autocompletion=_pictures,
)


_TEST = "Stereonet of kinematic: planar, wedge, toppling (flexural, direct) [all]."


def plot(
    result: Annotated[
        str,
        typer.Argument(
            help="JSON that slopekit wrote (result.json, sweep.json), or its folder.",
            metavar="RESULT",
        ),
    ],
    what: Annotated[str | None, _WHAT] = None,
    case: Annotated[str | None, CASE] = None,
    output: Annotated[
        str | None,
        typer.Option(
            "-o", help="The file [RESULT-WHAT.png]; charts .png .svg .pdf, scenes .png .glb .gltf."
        ),
    ] = None,
    test: Annotated[str | None, typer.Option(help=_TEST)] = None,
    step: Annotated[str, typer.Option(help="mechanism: which one, 1 the first.")] = "1",
) -> None:
    """A picture of any JSON that slopekit wrote (extra: plot).

    Scenes: scene exploded tractions forces displacement mechanism factors. Charts: stereonet elevation
    histogram curve contour tornado speed-error reduction motion. Without WHAT: those that the file can give.
    """
    from slopekit.exchange.documents import by_case, document_file, read_document
    from slopekit.views import plots

    path = document_file(Path(result))
    documents = by_case(read_document(path), case, path.name)
    if what is None:
        pictures = {
            word: shows
            for case_document in documents.values()
            for word, shows in plots.offers(case_document).items()
        }
        cases = ", ".join(documents)
        typer.echo(
            _available_pictures(
                path, pictures, f"{path.name}, load cases {cases}," if cases else path.name
            )
        )
        return
    number = whole_number(step, "--step")
    drawable = {
        name: case_document
        for name, case_document in documents.items()
        if len(documents) == 1 or what in plots.offers(case_document)
    }
    for name, document in (drawable or documents).items():
        suffix = f"-{name}" if name and (case is None or output is None) else ""
        target = path.with_name(f"{path.stem}-{what}{suffix}.png")
        if output is not None:
            given_path = Path(output)
            case_path = given_path.with_name(f"{given_path.stem}{suffix}{given_path.suffix}")
            target = given_path / target.name if given_path.is_dir() else case_path
        plots.check(document, what, target, path.name, test, number)
        folder_of(target.parent)
        with watched(what):
            plots.draw(document, what, target, test=test, step=number, name=path.name)
        typer.echo(f"wrote {target}")
    if drawable and len(drawable) < len(documents):
        typer.echo(
            f"no {what} of {', '.join(name for name in documents if name not in drawable)}",
            err=True,
        )


def _available_pictures(path: Path, pictures: dict[str, str], name: str) -> str:
    if not pictures:
        return f"{name} has nothing that can be drawn"
    lines = [
        f"{name} can give",
        *(f"  {picture:<14}{shows}" for picture, shows in pictures.items()),
    ]
    return "\n".join([*lines, f"for example: slopekit plot {path} {next(iter(pictures))}"])


def export(
    result: Annotated[
        str,
        typer.Argument(help="A result: DIR of run -o DIR, or its result.json.", metavar="RESULT"),
    ],
    output: Annotated[
        str,
        typer.Option("-o", help="The file: .stl .obj .glb .vtu .dxf (extra: cad).", metavar="FILE"),
    ],
    case: Annotated[str | None, CASE] = None,
    as_json: Annotated[bool, JSON] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="The names of the files only.")] = False,
) -> None:
    """Blocks and bolts of a result for CAD, ParaView and others, in your own coordinates."""
    from slopekit.exchange.export import export as export_result

    with watched("export"):
        done = export_result(result, Path(output), case=case)
    if as_json:
        typer.echo(json_text({"slopekit": __version__, **done.to_dict()}))
    elif quiet:
        typer.echo("\n".join(str(path) for path in done.files))
    else:
        for entry in done.written:
            typer.echo("\n".join(_export_lines(entry)))
        for notice in done.warnings:
            typer.echo(f"NOTE      {notice}")


def _export_lines(entry: "Written") -> list[str]:
    """Return the lines that tell a person what was exported."""
    counts = [
        f"{count} {word if count != 1 else word[:-1]}"
        for count, word in (
            (entry.blocks, "blocks"),
            (entry.interfaces, "interface polygons"),
            (entry.pairs, "node pairs"),
            (entry.bolts, "bolts"),
        )
        if count
    ]
    files = [str(path) for path in entry.files]
    if len(entry.files) > 4:
        files = [str(entry.files[0]), f"and {len(entry.files) - 1} files beside it"]
    return [
        f"WROTE     {', '.join(files)}",
        f"          {entry.format}, metres: {', '.join(counts)}, {entry.volume_m3:.9g} m³",
        f"PRECISION {entry.precision}",
    ]


def report(
    results: Annotated[
        list[str],
        typer.Argument(
            help="JSON of results and studies, or their folders; several make one page with a list of contents.",
            metavar="RESULT...",
        ),
    ],
    output: Annotated[
        str | None, typer.Option("-o", help="The page to write, .html [report.html beside it].")
    ] = None,
    project: Annotated[
        list[str] | None,
        typer.Option(
            help="For the head: name, client, number, author, checker, revision, date; repeat.",
            metavar="KEY=VALUE",
        ),
    ] = None,
    no_pictures: Annotated[
        bool,
        typer.Option(
            "--no-pictures",
            help="Without still pictures: quicker, smaller; the view to turn stays.",
        ),
    ] = False,
    as_json: Annotated[bool, JSON] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing on success.")] = False,
) -> None:
    """One self-contained page of results and studies: answers, checks, pictures, a view to turn (extra: report)."""
    from slopekit.exchange.documents import document_file, read_document
    from slopekit.views.pages.report import require_jinja, write_report

    sources = [document_file(Path(result)) for result in results]
    target = sources[0].parent / "report.html" if output is None else Path(output)
    if target.is_dir():
        target = target / "report.html"
    if target.suffix.lower() not in (".html", ".htm"):
        raise DesignError(
            [Fault("E141", f"the page {target} is not a .html file", str(target), "-o report.html")]
        )
    require_jinja(target)
    project_texts = _project(project or [])
    documents = [read_document(source) for source in sources]
    folder_of(target.parent)
    with watched("pictures" if not no_pictures else "page"):
        page = write_report(
            documents, target, [str(source) for source in sources], not no_pictures, project_texts
        )
    size = target.stat().st_size
    if as_json:
        document = {
            "slopekit": __version__,
            "report": str(target),
            "bytes": size,
            "pictures": list(page.pictures),
            "missing": list(page.missing),
            "warnings": [n.to_dict() for n in page.notices],
        }
        typer.echo(json_text(document))
    elif not quiet:
        typer.echo(f"wrote {target} ({size / 1e3:.0f} kB)")
        for missing_picture in dict.fromkeys(page.missing):
            typer.echo(f"     not drawn: {missing_picture}")
        for notice in page.notices:
            typer.echo(f"     {notice}")


def _project(texts: list[str]) -> dict[str, str]:
    project = dict[str, str]()
    for text in texts:
        key, equals, value = text.partition("=")
        if not equals:
            raise DesignError(
                [Fault("E142", f"{text} gives the project no value", text, "--project client=NAME")]
            )
        project[key.strip()] = value.strip()
    return project
