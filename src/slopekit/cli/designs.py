"""Commands on one design: wedge, run, lint."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from slopekit._version import __version__
from slopekit.cli.common import (
    FILE,
    FOLDER,
    JSON,
    QUIET,
    SET,
    draw_to,
    folder_of,
    image_of,
    json_text,
    load_design,
    write,
)
from slopekit.cli.progress import watched
from slopekit.errors import DesignError, Fault

if TYPE_CHECKING:
    from slopekit.result import Result

SCENE_ENDINGS = (".png", ".glb", ".gltf")
_PICTURE = typer.Option(help="Draw the slope and its blocks to a .png, .glb or .gltf file (extra: plot).")
_NO_PICTURES = typer.Option("--no-pictures", help="With -o: draw nothing.")
_PICTURES = ("scene", "elevation", "mechanism", "stereonet", "reduction")


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
        str | None,
        typer.Option("--accept-fos", "--accept", help="Smallest factor of safety accepted; exit code 1 below it."),
    ] = None,
    agree_within: Annotated[str | None, typer.Option(help="Largest difference of the two methods [1%].")] = None,
    gravity: Annotated[str | None, typer.Option(help="[9.81 m/s2]")] = None,
    water_unit_weight: Annotated[str | None, typer.Option(help="[9.81 kN/m3]")] = None,
    refine: Annotated[str | None, typer.Option(help="Split the joints' triangles in four this often [0].")] = None,
    origin: Annotated[str | None, typer.Option(help="Map coordinates of the toe, E,N,Z.")] = None,
    picture: Annotated[str | None, _PICTURE] = None,
    no_pictures: Annotated[bool, _NO_PICTURES] = False,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON document on stdout, nothing else.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="One line: status, factor, check.")] = False,
    output: Annotated[str | None, FOLDER] = None,
) -> None:
    """One wedge from the command line. What is left out takes the paper's wedge, and the sheet says so."""
    from slopekit.kinds import analyse
    from slopekit.kinds.wedge.design import wedge_design

    folder = None if output is None else folder_of(Path(output))
    image = _scene_of(picture)
    given: dict[str, Any] = {
        "dips": dips, "face": face, "upper": upper, "height": height, "c": c, "phi": phi, "density": density,
        "unit_weight": unit_weight, "dilation": dilation, "tension": tension, "water": water, "crack": crack,
        "seismic": seismic, "forces": force, "bolts": bolt, "normal_stiffness": normal_stiffness,
        "shear_stiffness": shear_stiffness, "criterion": criterion, "accept": accept, "agree_within": agree_within,
        "gravity": gravity, "water_unit_weight": water_unit_weight, "refine": refine, "origin": origin,
    }  # fmt: skip
    read = wedge_design(given, _option)
    with watched():
        result = analyse(read)
    _finish(result, folder, image, no_pictures, as_json, quiet)


def run(
    design: Annotated[str, FILE],
    sets: Annotated[list[str] | None, SET] = None,
    picture: Annotated[str | None, _PICTURE] = None,
    no_pictures: Annotated[bool, _NO_PICTURES] = False,
    as_json: Annotated[bool, JSON] = False,
    quiet: Annotated[bool, QUIET] = False,
    output: Annotated[str | None, FOLDER] = None,
) -> None:
    """Any design file: wedge, plane, footing, surface, bench, blocks, topple."""
    from slopekit.kinds import analyse

    folder = None if output is None else folder_of(Path(output))
    image = _scene_of(picture)
    read = load_design(design, sets)
    with watched():
        result = analyse(read)
    _finish(result, folder, image, no_pictures, as_json, quiet)


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


def _finish(result: "Result", folder: Path | None, image: Path | None, plain: bool, as_json: bool, quiet: bool) -> None:
    """Write and print a result, draw it where that was asked for, and leave with its exit code."""
    record = result.to_dict() if as_json or folder or image else {}
    document = json_text(record) if as_json or folder else ""
    sheet = str(result) if folder or not (as_json or quiet) else ""
    if folder is not None:
        write(folder / "result.json", document + "\n")
        write(folder / "sheet.txt", sheet + "\n")
        _write_schedule(result, folder)
    typer.echo(document if as_json else result.line if quiet else sheet)
    if image is not None:
        draw_to(record, "scene", image)
    if folder is not None:
        _draw_all(record, folder, plain)
    raise typer.Exit(result.exit_code)


def _write_schedule(result: "Result", folder: Path) -> None:
    """The bolts as a table of their own; that of an earlier result goes where there are none."""
    path = folder / "bolts.csv"
    if not result.design.bolts and not path.exists():
        return
    from slopekit.kinds.sheets.bolts import FILE, schedule_table

    if result.design.bolts:
        write(path, result.sheet.tables[FILE].csv())
        return
    head = schedule_table([]).csv().strip()
    try:
        old = path.is_file() and path.read_text(encoding="utf-8", errors="replace").startswith(head)
        if old:
            path.unlink()
            typer.echo(f"the bolts of an earlier result were removed: {FILE}", err=True)
    except OSError as error:
        message = f"{folder} holds the bolts of an earlier result: {error.strerror or error}"
        raise DesignError([Fault("E129", message, str(folder))]) from None


def _draw_all(record: dict[str, Any], folder: Path, plain: bool) -> None:
    """The pictures that say most of a result, those of them that it can give; those of an earlier result go."""
    old = [name for name in _PICTURES if (folder / f"{name}.png").exists()]
    try:
        for name in old:
            (folder / f"{name}.png").unlink()
    except OSError as error:
        message = f"{folder} holds pictures of an earlier result: {error.strerror or error}"
        raise DesignError([Fault("E129", message, str(folder))]) from None
    drawn = [] if plain else _drawn(record, folder)
    gone = ", ".join(f"{name}.png" for name in old if name not in drawn)
    if gone:
        typer.echo(f"pictures of an earlier result were removed: {gone}", err=True)


def _drawn(record: dict[str, Any], folder: Path) -> list[str]:
    """Draw what the result can give; the names of what was drawn."""
    from slopekit.views.plots import offers
    from slopekit.views.rendering import require_drawing

    try:
        require_drawing(folder)
    except DesignError as error:  # everything else is there: say once what is missing
        (fault,) = error.faults
        left = f"pictures are left out: {fault.code} {fault.message}"
        typer.echo(f"result.json and sheet.txt are written, {left}", err=True)
        return []
    given = offers(record)
    for what in _PICTURES:
        if what in given:
            draw_to(record, what, folder / f"{what}.png")
    return [what for what in _PICTURES if (folder / f"{what}.png").exists()]


def _scene_of(picture: str | None) -> Path | None:
    """The picture asked for, refused before any work is done where it cannot be drawn or written."""
    if picture is None:
        return None
    image = image_of(Path(picture), SCENE_ENDINGS)
    if image.suffix.lower() == ".png":
        from slopekit.views.rendering import require_drawing

        require_drawing(image)
    return image


def _option(key: str) -> str:
    singular = {"forces": "force", "bolts": "bolt"}
    return "--" + singular.get(key, key).replace("_", "-")
