"""The commands that analyse nothing: lint, app, templates, doctor, explain."""

from pathlib import Path
from shlex import quote
from typing import Annotated

import typer

from slopekit._version import __version__
from slopekit.cli.common import CASE, FILE, JSON, SET, folded, json_text, load_design
from slopekit.cli.progress import watched
from slopekit.core.codec import json_of
from slopekit.core.errors import DesignError, Fault, Faults, writing
from slopekit.core.extras import require_extra
from slopekit.core.whole_files import whole_file
from slopekit.design.templates import names, path_of, summary


def lint(
    design: Annotated[str, FILE],
    sets: Annotated[list[str] | None, SET] = None,
    case: Annotated[str | None, CASE] = None,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Read and test a design file, run nothing."""
    from slopekit.kinds import implausible_inputs

    read = load_design(design, sets, case)
    slips = implausible_inputs(read)
    if as_json:
        document = {
            "slopekit": __version__,
            "kind": read.kind,
            "input_sha256": read.input_hash(),
            "inputs": read.inputs(),
            "assumed": dict(read.assumed),
            "defaults": list(read.reading.defaults),
            "warnings": json_of(slips),
            "errors": [],
            **(
                {
                    "cases": {
                        load_case.name: {
                            "sets": dict(load_case.sets),
                            "rules": [str(rule) for rule in load_case.design.rules],
                            "input_sha256": load_case.design.input_hash(),
                            "inputs": load_case.design.inputs(),
                        }
                        for load_case in read.cases
                    }
                }
                if read.cases
                else {}
            ),
        }
        typer.echo(json_text(document))
        return
    head = f"ok   {Path(design).name}: a {read.kind} design, sha {read.input_hash()[:6]}"
    typer.echo(f"{head} (whether it forms a block, run says)")
    if read.analysis.partial is not None:
        typer.echo(f"     partial factors: {read.analysis.partial.called}")
    for load_case in read.cases:
        rules = ", ".join(str(rule) for rule in load_case.design.rules) or "nothing"
        typer.echo(
            f"     case {load_case.name}: sets {load_case.in_words or 'nothing'}; asks for {rules}"
        )
    for name, value in read.assumed:
        typer.echo(f"     {name} is a distribution: run takes {value}")
    if read.reading.defaults:
        typer.echo(f"     left out, taken by default: {', '.join(read.reading.defaults)}")
    for notice in slips:
        typer.echo(f"     {notice}")


def _template_names(incomplete: str) -> list[str]:
    """The templates that begin so, for the shell."""
    return [name for name in names() if name.startswith(incomplete)]


def _codes(incomplete: str) -> list[str]:
    """The codes of messages that begin so, for the shell."""
    from slopekit.core.explanations import explanations

    return [code for code in explanations() if code.startswith(incomplete)]


_TEMPLATE = typer.Argument(help="A template, see list.", autocompletion=_template_names)
_CODE = typer.Argument(help="Codes such as E203.", metavar="CODE...", autocompletion=_codes)

templates = typer.Typer(
    name="templates", help="Starter design files.", rich_markup_mode=None, add_completion=False
)


@templates.callback(invoke_without_command=True)
def _templates(context: typer.Context) -> None:
    """Starter design files."""
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


@templates.command("list")
def list_templates() -> None:
    """The templates there are."""
    for name in names():
        typer.echo(f"{name:<20}{summary(name)}")


@templates.command("show")
def show_template(name: Annotated[str, _TEMPLATE]) -> None:
    """Print a template."""
    typer.echo(path_of(name).read_text(encoding="utf-8"), nl=False)


@templates.command("new")
def new_template(
    name: Annotated[str, _TEMPLATE],
    target: Annotated[str | None, typer.Argument(help="The file to write [NAME.yaml].")] = None,
) -> None:
    """Write a template to a file of your own; nothing is written over."""
    source = path_of(name)
    path = Path(target or source.name)
    if not path.parent.is_dir():
        raise DesignError([Fault("E129", f"there is no folder {path.parent}", str(path))])
    if path.exists():
        raise DesignError(
            [Fault("E129", f"{path} is there already", str(path), "Give another name.")]
        )
    with writing(path), whole_file(path, new=True) as file:
        file.write_text(source.read_text(encoding="utf-8"), encoding="utf-8")
    typer.echo(f"wrote {path}; try: slopekit run {quote(str(path))}")


def app(
    design: Annotated[
        str | None, typer.Argument(help="A design file (YAML) [the paper's wedge].")
    ] = None,
    port: Annotated[int, typer.Option(help="Port to listen on; 0: any that is free.")] = 0,
    no_browser: Annotated[
        bool, typer.Option("--no-browser", help="Print the address and open nothing.")
    ] = False,
) -> None:
    """Interactive app in the browser, on this machine alone (extra: app)."""
    if not 0 <= port <= 65535:
        raise DesignError(
            [Fault("E106", f"--port is {port}, a port lies between 0 and 65535", f"--port {port}")]
        )
    require_extra(
        "app", "the app needs", "starlette", "uvicorn", "websockets", "jinja2", where="slopekit app"
    )
    from slopekit.app.server import serve
    from slopekit.app.session import opened_file, opened_template

    def ready(address: str) -> None:
        typer.echo(f"slopekit app: {address}   (Ctrl-C ends it)")
        if not no_browser:
            import webbrowser

            webbrowser.open(address)

    serve(opened_template("wedge") if design is None else opened_file(Path(design)), port, ready)


def doctor() -> None:
    """Versions, drawing, a self test of a few seconds."""
    from slopekit.views.doctor import examination

    with watched("self test"):
        lines, sound = examination()
    typer.echo("\n".join(lines))
    raise typer.Exit(0 if sound else 5)


def explain(
    codes: Annotated[list[str] | None, _CODE] = None,
    all_codes: Annotated[
        bool, typer.Option("--all", help="Every message, as Markdown: docs/messages.md.")
    ] = False,
) -> None:
    """The long text of messages."""
    if all_codes != (not codes):
        raise DesignError(
            [Fault("E100", "explain takes codes or --all", "", "slopekit explain E203 W307")]
        )
    if not codes:
        from slopekit.views.messages import messages_page

        typer.echo(messages_page(), nl=False)
        return
    from slopekit.core.explanations import explanation

    texts, faults = list[str](), Faults()
    for code in codes:
        with faults.collecting():
            texts.append(explanation(code))
    faults.refuse()
    for line in "\n\n".join(dict.fromkeys(texts)).splitlines():
        typer.echo(folded(line))
