"""The command line: parse, call one function, print, exit code. Everything else loads only when a command runs."""

import json
import os
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from slopekit._version import __version__
from slopekit.errors import DesignError, Fault, SlopekitError

if TYPE_CHECKING:
    from slopekit.design.common import Design
    from slopekit.result import Result

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    help="Rock wedges and slopes by rigid blocks (PRE-IE), checked against closed forms.",
)


def _version(show: bool) -> None:
    if show:
        typer.echo(f"slopekit {__version__}")
        raise typer.Exit


@app.callback()
def _slopekit(
    version: Annotated[bool, typer.Option("--version", callback=_version, is_eager=True, help="Version.")] = False,
) -> None:
    """Rock wedges and slopes by rigid blocks (PRE-IE), checked against closed forms."""


@app.command()
def wedge(
    dips: Annotated[tuple[str, str], typer.Option(help="The two joints, dip/dip direction each.", metavar="D/DD D/DD")],
    face: Annotated[str | None, typer.Option(help="Slope face, D/DD [60/180].")] = None,
    upper: Annotated[str | None, typer.Option(help="Upper slope, D/DD [10/180].")] = None,
    height: Annotated[str | None, typer.Option(help="Vertical, toe to crest at J1's trace [64.89 m].")] = None,
    c: Annotated[str | None, typer.Option("--c", help="Cohesion, one value or C1,C2 [50 kPa].")] = None,
    phi: Annotated[str | None, typer.Option(help="Friction angle, one value or P1,P2 [20].")] = None,
    density: Annotated[str | None, typer.Option(help="Density [2600 kg/m3].")] = None,
    unit_weight: Annotated[str | None, typer.Option(help="Unit weight, kN/m3, instead of a density.")] = None,
    dilation: Annotated[str | None, typer.Option(help="Dilation angle of the joints, 0 to phi [0].")] = None,
    tension: Annotated[str | None, typer.Option(help="Tensile strength of the joints [0 kPa].")] = None,
    water: Annotated[str | None, typer.Option(help="dry, full, 50%, u=9.8kPa or u=5kPa,8kPa[,crack] [dry].")] = None,
    crack: Annotated[str | None, typer.Option(help="Tension crack, D/DD@DIST from the crest along J1's trace.")] = None,
    seismic: Annotated[str | None, typer.Option(help="Pseudo-static coefficient, K or K@TREND.")] = None,
    force: Annotated[list[str] | None, typer.Option(help="F@TREND/PLUNGE, kN; repeat for more.")] = None,
    bolt: Annotated[list[str] | None, typer.Option(help="T@TREND/PLUNGE[,active|passive], kN; repeat.")] = None,
    normal_stiffness: Annotated[str | None, typer.Option(help="k_zz of closed joints [1e7 kN/m3].")] = None,
    shear_stiffness: Annotated[str | None, typer.Option(help="kN/m3, or clough-duncan [clough-duncan].")] = None,
    criterion: Annotated[str | None, typer.Option(help="limit, or all-pairs to add the paper's criterion.")] = None,
    accept: Annotated[
        str | None, typer.Option(help="Smallest factor of safety accepted; exit code 1 below it.")
    ] = None,
    agree_within: Annotated[str | None, typer.Option(help="Largest difference of the two methods [1%].")] = None,
    gravity: Annotated[str | None, typer.Option(help="[9.81 m/s2]")] = None,
    water_unit_weight: Annotated[str | None, typer.Option(help="[9.81 kN/m3]")] = None,
    refine: Annotated[str | None, typer.Option(help="Split the joints' triangles in four this often [0].")] = None,
    origin: Annotated[str | None, typer.Option(help="Map coordinates of the toe, E,N,Z.")] = None,
    picture: Annotated[str | None, typer.Option(help="Draw the wedge to a PNG file (extra: plot).")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON document on stdout, nothing else.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="One line: status, factor, check.")] = False,
    output: Annotated[str | None, typer.Option("-o", help="Folder for result.json and sheet.txt.")] = None,
) -> None:
    """One wedge from the command line. What is left out takes the paper's wedge, and the sheet says so."""
    from slopekit.analysis.wedge import analyse_wedge
    from slopekit.design.reading import wedge_design

    folder = None if output is None else _folder(Path(output))
    image = None if picture is None else _image(Path(picture))
    given: dict[str, Any] = {
        "dips": dips, "face": face, "upper": upper, "height": height, "c": c, "phi": phi, "density": density,
        "unit_weight": unit_weight, "dilation": dilation, "tension": tension, "water": water, "crack": crack,
        "seismic": seismic, "forces": force, "bolts": bolt, "normal_stiffness": normal_stiffness,
        "shear_stiffness": shear_stiffness, "criterion": criterion, "accept": accept, "agree_within": agree_within,
        "gravity": gravity, "water_unit_weight": water_unit_weight, "refine": refine, "origin": origin,
    }  # fmt: skip
    _finish(analyse_wedge(wedge_design(given, _option)), folder, image, as_json, quiet)


_JSON = typer.Option("--json", help="One JSON document on stdout, nothing else.")
_QUIET = typer.Option("--quiet", help="One line: status, factor, check.")
_FOLDER = typer.Option("-o", help="Folder for result.json and sheet.txt.")
_SET = typer.Option("--set", help="key=value, replaces a value of the file; repeat.", metavar="KEY=VALUE")
_FILE = typer.Argument(help="A design file (YAML).", metavar="DESIGN")


@app.command()
def run(
    design: Annotated[str, _FILE],
    sets: Annotated[list[str] | None, _SET] = None,
    picture: Annotated[str | None, typer.Option(help="Draw a wedge to a PNG file (extra: plot).")] = None,
    as_json: Annotated[bool, _JSON] = False,
    quiet: Annotated[bool, _QUIET] = False,
    output: Annotated[str | None, _FOLDER] = None,
) -> None:
    """Any design file: wedge, plane, footing, surface, bench, blocks, topple."""
    from slopekit.analysis import analyse

    folder = None if output is None else _folder(Path(output))
    image = None if picture is None else _image(Path(picture))
    _finish(analyse(_load(design, sets)), folder, image, as_json, quiet)


@app.command()
def check(
    design: Annotated[str | None, typer.Argument(help="A design file (YAML).", metavar="DESIGN")] = None,
    suite: Annotated[bool, typer.Option("--suite", help="The verification suite: published and exact cases.")] = False,
    sets: Annotated[list[str] | None, _SET] = None,
    picture: Annotated[str | None, typer.Option(help="Draw time against error to a PNG file (extra: plot).")] = None,
    as_json: Annotated[bool, _JSON] = False,
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
    folder = None if output is None else _folder(Path(output))
    if design is None:
        _check_suite(folder, as_json, quiet)
    from slopekit.studies.check import check as check_design
    from slopekit.views.check_sheet import check_line, check_picture, check_sheet, require_matplotlib

    image = None if picture is None else _image(Path(picture))
    if image is not None:
        require_matplotlib(image)
    checked = check_design(_load(design or "", sets))
    document = json.dumps(checked.to_dict(), ensure_ascii=False, indent=1, allow_nan=False)
    sheet = check_sheet(checked)
    if folder is not None:
        (folder / "check.json").write_text(document + "\n", encoding="utf-8")
        (folder / "check.txt").write_text(sheet + "\n", encoding="utf-8")
    typer.echo(document if as_json else check_line(checked) if quiet else sheet)
    for path in (image, folder / "speed-error.png" if folder else None):
        try:
            if path is not None:
                check_picture(checked, path)
        except DesignError as error:  # everything else is there: say what is missing
            _print_faults(error, plainly=True)
    raise typer.Exit(checked.exit_code)


def _check_suite(folder: Path | None, as_json: bool, quiet: bool) -> None:
    from slopekit.studies.suite import verify
    from slopekit.views.verification import summary, table, write

    verification = verify()
    if folder is not None:
        write(verification, folder)
    document = json.dumps(verification.to_dict(), ensure_ascii=False, indent=1, allow_nan=False) if as_json else ""
    typer.echo(document or (summary(verification) if quiet else table(verification)))
    raise typer.Exit(verification.exit_code)


@app.command()
def lint(
    design: Annotated[str, _FILE],
    sets: Annotated[list[str] | None, _SET] = None,
    as_json: Annotated[bool, _JSON] = False,
) -> None:
    """Read and test a design file, run nothing."""
    read = _load(design, sets)
    if as_json:
        document = {
            "slopekit": __version__, "kind": read.kind, "input_sha256": read.input_hash(), "inputs": read.inputs(),
            "assumed": dict(read.assumed), "defaults": list(read.defaults), "errors": [],
        }  # fmt: skip
        typer.echo(json.dumps(document, ensure_ascii=False, indent=1))
        return
    head = f"ok   {Path(design).name}: a {read.kind} design, sha {read.input_hash()[:6]}"
    typer.echo(f"{head} (whether it forms a block, run says)")
    for name, value in read.assumed:
        typer.echo(f"     {name} is a distribution: run takes {value}")
    if read.defaults:
        typer.echo(f"     left out, taken by default: {', '.join(read.defaults)}")


templates = typer.Typer(help="Starter design files.", no_args_is_help=True, rich_markup_mode=None)
app.add_typer(templates, name="templates")


@templates.command("list")
def list_templates() -> None:
    """The templates there are."""
    from slopekit.design.templates import names, summary

    for name in names():
        typer.echo(f"{name:<20}{summary(name)}")


@templates.command("show")
def show_template(name: Annotated[str, typer.Argument(help="A template, see list.")]) -> None:
    """Print a template."""
    from slopekit.design.templates import path_of

    typer.echo(path_of(name).read_text(encoding="utf-8"), nl=False)


@templates.command("new")
def new_template(
    name: Annotated[str, typer.Argument(help="A template, see list.")],
    target: Annotated[str | None, typer.Argument(help="The file to write [NAME.yaml].")] = None,
) -> None:
    """Write a template to a file of your own; nothing is written over."""
    from slopekit.design.templates import path_of

    source = path_of(name)
    path = Path(target or source.name)
    if not path.parent.is_dir():
        raise DesignError([Fault("E129", f"there is no folder {path.parent}", str(path))])
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(source.read_text(encoding="utf-8"))
    except FileExistsError:
        raise DesignError([Fault("E178", f"{path} is there already", str(path), "Give another name.")]) from None
    except OSError as error:
        reason = error.strerror or str(error)
        raise DesignError([Fault("E129", f"{path} cannot be written: {reason}", str(path))]) from None
    typer.echo(f"wrote {path}; try: slopekit run {path}")


@app.command()
def doctor() -> None:
    """Versions, drawing, a self test of a few seconds."""
    from slopekit.views.doctor import examination

    lines, sound = examination()
    typer.echo("\n".join(lines))
    raise typer.Exit(0 if sound else 5)


def _load(design: str, sets: list[str] | None) -> "Design":
    from slopekit.design.files import load
    from slopekit.design.overrides import parse_override

    faults: list[Fault] = []
    overrides: list[tuple[str, object]] = []
    for text in sets or []:
        try:
            overrides.append(parse_override(text))
        except DesignError as error:
            faults += error.faults
    if faults:
        raise DesignError(faults)
    return load(design, overrides)


def _finish(result: "Result", folder: Path | None, image: Path | None, as_json: bool, quiet: bool) -> None:
    """Write and print a result, and leave with its exit code."""
    from slopekit.views.sheet import sheet as make_sheet

    document = json.dumps(result.to_dict(), ensure_ascii=False, indent=1, allow_nan=False)
    sheet = make_sheet(result)
    if image is not None:
        from slopekit.views.scene import wedge_picture

        wedge_picture(result, image)
    if folder is not None:
        (folder / "result.json").write_text(document + "\n", encoding="utf-8")
        (folder / "sheet.txt").write_text(sheet + "\n", encoding="utf-8")
    typer.echo(document if as_json else _one_line(result) if quiet else sheet)
    raise typer.Exit(result.exit_code)


@app.command()
def explain(code: Annotated[str, typer.Argument(help="A code such as E203.")]) -> None:
    """The long text of a message."""
    from slopekit.explanations import explanation

    typer.echo(explanation(code))


def _one_line(result: "Result") -> str:
    """Status, factor, what governs and the check: never a bare factor of safety."""
    fos = result.criterion_fos
    agree = {True: "agree", False: "disagree", None: "not compared"}[result.agree]
    parts = [result.status, "none" if fos is None else f"{fos:.4f}", agree]
    if result.design.criterion == "all-pairs":
        limit, pairs = result.fos.limit, result.fos.all_pairs_failed
        shown = [
            f"{name} {'none' if value is None else f'{value:.4f}'}"
            for name, value in (("limit", limit), ("all-pairs", pairs))
        ]
        parts[1] = ", ".join(shown)
    parts += ["moments_govern"] if result.moments_govern else []
    parts += [] if result.accepted is None else ["met" if result.accepted else "not met"]
    parts += list(dict.fromkeys(notice.code for notice in result.warnings))
    return "  ".join(parts)


def _refuse_repeats(arguments: list[str]) -> None:
    """Refuse an option that takes one value and is given twice, which the parser would let the last one win."""
    names = [argument.partition("=")[0] for argument in arguments if argument.startswith("--")]
    twice = sorted({name for name in names if names.count(name) > 1} - {"--force", "--bolt", "--set"})
    if twice:
        raise DesignError([Fault("E133", f"{name} is given twice", name, "Give it once.") for name in twice])


def _option(key: str) -> str:
    singular = {"forces": "force", "bolts": "bolt"}
    return "--" + singular.get(key, key).replace("_", "-")


def _folder(folder: Path) -> Path:
    """Make a folder to write to, before any work is done."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        reason = error.strerror or str(error)
        raise DesignError([Fault("E129", f"the folder {folder} cannot be written: {reason}", str(folder))]) from None
    return folder


def _image(path: Path) -> Path:
    if path.suffix.lower() != ".png":
        raise DesignError([Fault("E141", f"the picture {path} is not a .png file", str(path))])
    if not path.parent.is_dir():
        raise DesignError([Fault("E129", f"there is no folder {path.parent} for the picture", str(path))])
    _folder(path.parent)
    return path


def _print_faults(error: SlopekitError, plainly: bool = False) -> None:
    if "--json" in sys.argv[1:] and not plainly:
        document = {"slopekit": __version__, "errors": [fault.to_dict() for fault in error.faults]}
        typer.echo(json.dumps(document, ensure_ascii=False, indent=1))
    for fault in error.faults:
        typer.echo(str(fault), err=True)


def main() -> None:
    """Run the command line; exit codes: 0 done, 1 criterion not met, 2 bad input, 3 no block, 4 disagree, 5 a bug."""
    try:
        _refuse_repeats(sys.argv[1:])
        code = app(standalone_mode=False)
    except SlopekitError as error:
        _print_faults(error)
        sys.exit(error.exit_code)
    except typer.Abort:
        sys.exit(130)
    except typer.TyperException as error:
        wrong = DesignError([Fault("E100", _said(error), "", "Try --help for the options.")])
        _print_faults(wrong)
        sys.exit(wrong.exit_code)
    except Exception as error:
        typer.echo(f"E599 a bug of ours: {type(error).__name__}: {error}", err=True)
        typer.echo(
            "     Please send us the command with this text. SLOPEKIT_DEBUG=1 prints where it happened.", err=True
        )
        if os.environ.get("SLOPEKIT_DEBUG"):
            raise
        sys.exit(5)
    sys.exit(code if isinstance(code, int) else 0)


def _said(error: typer.TyperException) -> str:
    format_message = getattr(error, "format_message", None)
    return str(format_message() if format_message else error)


if __name__ == "__main__":
    main()
