"""Commands on what slopekit has written: plot, export, report."""

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

    return [what for what in EVERY if what.startswith(incomplete)]


_WHAT = typer.Argument(
    help="The picture; without it: the pictures that this file can give.", metavar="WHAT", autocompletion=_pictures
)


_TEST = "Stereonet of kinematic: planar, wedge, toppling (flexural, direct) [all]."


def plot(
    result: Annotated[str, typer.Argument(help="JSON that slopekit wrote (result.json, sweep.json), or its folder.",
                                          metavar="RESULT")],
    what: Annotated[str | None, _WHAT] = None,
    case: Annotated[str | None, CASE] = None,
    output: Annotated[str | None, typer.Option("-o", help="The file [RESULT-WHAT.png]; charts .png .svg .pdf, "
                                               "scenes .png .glb .gltf.")] = None,
    test: Annotated[str | None, typer.Option(help=_TEST)] = None,
    step: Annotated[str, typer.Option(help="mechanism: which one, 1 the first.")] = "1",
) -> None:  # fmt: skip
    """A picture of any JSON that slopekit wrote (extra: plot).

    Scenes: scene exploded tractions forces displacement mechanism factors. Charts: stereonet elevation
    histogram curve contour tornado speed-error reduction motion. Without WHAT: those that the file can give.
    """
    from slopekit.exchange.documents import by_case, document_file, read_document
    from slopekit.views import plots

    path = document_file(Path(result))
    documents = by_case(read_document(path), case, path.name)
    if what is None:
        given = {word: shows for one in documents.values() for word, shows in plots.offers(one).items()}
        cases = ", ".join(documents)
        typer.echo(_listed(path, given, f"{path.name}, load cases {cases}," if cases else path.name))
        return
    number = whole_number(step, "--step")
    wanted = {name: one for name, one in documents.items() if len(documents) == 1 or what in plots.offers(one)}
    for name, document in (wanted or documents).items():
        own = f"-{name}" if name and (case is None or output is None) else ""
        target = path.with_name(f"{path.stem}-{what}{own}.png")
        if output is not None:
            given_path = Path(output)
            beside = given_path.with_name(f"{given_path.stem}{own}{given_path.suffix}")
            target = given_path / target.name if given_path.is_dir() else beside
        plots.check(document, what, target, path.name, test, number)
        folder_of(target.parent)
        with watched(what):
            plots.draw(document, what, target, test=test, step=number, name=path.name)
        typer.echo(f"wrote {target}")
    if wanted and len(wanted) < len(documents):
        typer.echo(f"no {what} of {', '.join(name for name in documents if name not in wanted)}", err=True)


def _listed(path: Path, given: dict[str, str], own: str) -> str:
    if not given:
        return f"{own} has nothing that can be drawn"
    lines = [f"{own} can give", *(f"  {what:<14}{shows}" for what, shows in given.items())]
    return "\n".join([*lines, f"for example: slopekit plot {path} {next(iter(given))}"])


def export(
    result: Annotated[str, typer.Argument(help="A result: DIR of run -o DIR, or its result.json.", metavar="RESULT")],
    output: Annotated[str, typer.Option("-o", help="The file: .stl .obj .glb .vtu .dxf (extra: cad).", metavar="FILE")],
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
        for one in done.written:
            typer.echo("\n".join(_lines(one)))
        for notice in done.warnings:
            typer.echo(f"NOTE      {notice}")


def _lines(one: "Written") -> list[str]:
    """What was written, for a person."""
    counts = [
        f"{count} {word if count != 1 else word[:-1]}"
        for count, word in (
            (one.blocks, "blocks"),
            (one.interfaces, "interface polygons"),
            (one.pairs, "node pairs"),
            (one.bolts, "bolts"),
        )
        if count
    ]
    files = [str(path) for path in one.files]
    if len(one.files) > 4:
        files = [str(one.files[0]), f"and {len(one.files) - 1} files beside it"]
    return [
        f"WROTE     {', '.join(files)}",
        f"          {one.format}, metres: {', '.join(counts)}, {one.volume_m3:.9g} m³",
        f"PRECISION {one.precision}",
    ]


def report(
    results: Annotated[
        list[str],
        typer.Argument(
            help="JSON of results and studies, or their folders; several make one page with a list of contents.",
            metavar="RESULT...",
        ),
    ],
    output: Annotated[str | None, typer.Option("-o", help="The page to write, .html [report.html beside it].")] = None,
    project: Annotated[
        list[str] | None,
        typer.Option(
            help="For the head: name, client, number, author, checker, revision, date; repeat.", metavar="KEY=VALUE"
        ),
    ] = None,
    no_pictures: Annotated[
        bool, typer.Option("--no-pictures", help="Without still pictures: quicker, smaller; the view to turn stays.")
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
        raise DesignError([Fault("E141", f"the page {target} is not a .html file", str(target), "-o report.html")])
    require_jinja(target)
    said = _project(project or [])
    documents = [read_document(source) for source in sources]
    folder_of(target.parent)
    with watched("pictures" if not no_pictures else "page"):
        made = write_report(documents, target, [str(source) for source in sources], not no_pictures, said)
    size = target.stat().st_size
    if as_json:
        told = {
            "slopekit": __version__, "report": str(target), "bytes": size, "pictures": list(made.pictures),
            "missing": list(made.missing), "warnings": [n.to_dict() for n in made.notices],
        }  # fmt: skip
        typer.echo(json_text(told))
    elif not quiet:
        typer.echo(f"wrote {target} ({size / 1e3:.0f} kB)")
        for one in dict.fromkeys(made.missing):
            typer.echo(f"     not drawn: {one}")
        for notice in made.notices:
            typer.echo(f"     {notice}")


def _project(texts: list[str]) -> dict[str, str]:
    project = dict[str, str]()
    for text in texts:
        key, equals, value = text.partition("=")
        if not equals:
            raise DesignError([Fault("E142", f"{text} gives the project no value", text, "--project client=NAME")])
        project[key.strip()] = value.strip()
    return project
