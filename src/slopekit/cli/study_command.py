"""Commands made from functions that give a result or a study: options, one driver for files, printing, pictures."""

import inspect
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any, get_args, get_type_hints

import typer

from slopekit import api
from slopekit.cli import pictures
from slopekit.cli.common import (
    CASE,
    FOLDER,
    JSON,
    QUIET,
    SET,
    folder_of,
    json_text,
    load_design,
    repeated_options,
)
from slopekit.cli.progress import aside, progress, watched
from slopekit.core.errors import DesignError, Fault, writing
from slopekit.core.options import DESIGN, Argument, Option, Workplace, declared_option
from slopekit.core.progress import report_stage
from slopekit.core.report import Report
from slopekit.core.whole_files import whole_files
from slopekit.studies.protocol import VARIANTS, StudyOutcome, function_of

#: The functions that give a result; all other commands that are made so are studies.
_RESULTS: Mapping[str, Callable[..., Any]] = {"wedge": api.wedge, "run": api.run}
#: Options of every command by the parameter of the driver; `_RESULT_OPTIONS` are those that differ for results.
_OPTIONS = {
    "picture": typer.Option(help="Draw it to a .png, .svg or .pdf file (extra: plot)."),
    "as_json": JSON,
    "full": typer.Option(
        "--full", help="The whole sheet: model, forces, displacements, sensitivities, times."
    ),
    "quiet": typer.Option("--quiet", help="One line."),
    "output": typer.Option(
        "-o", help="Folder for the JSON, the sheet, tables as .csv and pictures."
    ),
}
_RESULT_OPTIONS = {
    "picture": typer.Option(
        help="Draw the slope and its blocks to a .png, .glb or .gltf file (extra: plot)."
    ),
    "no_pictures": typer.Option("--no-pictures", help="With -o: draw nothing."),
    "quiet": QUIET,
    "output": FOLDER,
}
_ORDER = ("sets", "case", "picture", "no_pictures", "as_json", "full", "quiet", "output")


def command_of(name: str) -> Callable[..., None]:
    """Return the function that Typer makes a command of, with the parameters of a study and of its variants."""
    main = _RESULTS.get(name) or function_of(name)
    variants = {flag: function_of(flag) for flag, (study, _) in VARIANTS.items() if study == name}
    functions = [main, *variants.values()]
    declared: dict[str, inspect.Parameter] = {}
    signatures = [inspect.signature(function).parameters for function in functions]
    for parameters in signatures:
        for key, parameter in parameters.items():
            always = all(key in names for names in signatures)
            for cli_parameter in _on_command_line(key, parameter, always):
                declared.setdefault(cli_parameter.name, cli_parameter)
    for flag, function in variants.items():
        first_line = (inspect.getdoc(function) or "").partition("\n")[0]
        declared[flag] = _parameter(flag, bool, typer.Option(f"--{flag}", help=first_line), False)
    options = dict(_OPTIONS) | (_RESULT_OPTIONS if name in _RESULTS else {})
    if name not in _RESULTS and not any(map(_draws, functions)):
        del options["picture"]
    if with_design := _takes_design(main):
        options |= {"sets": SET, "case": CASE}
    for key in (key for key in _ORDER if key in options):
        is_text = key in ("sets", "case", "picture", "output")
        type_: Any = (list[str] | None if key == "sets" else str | None) if is_text else bool
        declared[key] = _parameter(key, type_, options[key], None if is_text else False)

    def command(**arguments: Any) -> None:
        chosen = next((flag for flag in variants if arguments[flag]), "")
        if with_design:
            _check_design(name, variants, chosen, arguments)
        _drive(variants.get(chosen, main), arguments, chosen)

    command.__name__ = name
    command.__doc__ = _help_of(main)
    vars(command)["__signature__"] = inspect.Signature(list(declared.values()))
    command.__annotations__ = {
        cli_parameter.name: cli_parameter.annotation for cli_parameter in declared.values()
    }
    return command


# -- parameters -------------------------------------------------------------------------------------------------------


def _on_command_line(
    key: str, parameter: inspect.Parameter, always: bool
) -> list[inspect.Parameter]:
    """Return what a parameter of a study is on the command line: nothing, or one option or argument.

    `always`: the variants of the study have it too.
    """
    declaration = declared_option(parameter)
    if isinstance(declaration, Argument):
        needed = always and parameter.default is inspect.Parameter.empty and not declaration.many
        type_ = list[str] | None if declaration.many else str if needed else str | None
        key = declaration.called or key
        return [
            _parameter(
                key,
                type_,
                typer.Argument(help=declaration.help, metavar=declaration.metavar),
                ... if needed else None,
            )
        ]
    if declaration is None:
        return []
    if isinstance(parameter.default, bool):
        return [
            _parameter(
                key, bool, typer.Option(_flag(key, declaration), help=declaration.help), False
            )
        ]
    option = typer.Option(
        _flag(key, declaration),
        *declaration.also,
        help=declaration.help,
        metavar=declaration.metavar or None,
        autocompletion=declaration.completes,
    )
    needed = declaration.needed or parameter.default is inspect.Parameter.empty
    value_type: Any = {0: list[str], 1: str, 2: tuple[str, str]}[declaration.texts]
    return [
        _parameter(
            key, value_type if needed else value_type | None, option, ... if needed else None
        )
    ]


def _takes_design(function: Callable[..., StudyOutcome]) -> bool:
    return any(
        declared_option(parameter) == DESIGN
        for parameter in inspect.signature(function).parameters.values()
    )


def _draws(function: Callable[..., StudyOutcome]) -> bool:
    """Whether there are pictures of what a study comes to."""
    outcome = get_type_hints(function)["return"]
    return any(kind.charts is not StudyOutcome.charts for kind in get_args(outcome) or (outcome,))


def _parameter(name: str, type_: Any, declaration: Any, default: Any) -> inspect.Parameter:
    """A parameter as Typer reads it; `...` for one that is needed."""
    default = inspect.Parameter.empty if default is ... else default
    kind = inspect.Parameter.KEYWORD_ONLY
    return inspect.Parameter(name, kind, default=default, annotation=Annotated[type_, declaration])


def _flag(key: str, option: Option) -> str:
    return option.flag or "--" + key.replace("_", "-")


def _help_of(function: Callable[..., Any]) -> str:
    """Return the docstring of a function down to its parameters, the help of its command."""
    return (
        (inspect.getdoc(function) or "")
        .partition("\nParameters\n")[0]
        .partition("\nRaises\n")[0]
        .strip()
    )


# -- the driver -------------------------------------------------------------------------------------------------------


def _drive(function: Callable[..., Any], arguments: Mapping[str, Any], variant: str) -> None:
    """Read the arguments, call the function, write, print and draw its outcome, exit with its code."""
    faults, folder, image = repeated_options(sys.argv[1:]), None, None
    is_twice = bool(faults)
    if arguments["output"] is not None:
        folder = faults.of(folder_of, Path(arguments["output"]))
    image = faults.of(pictures.picture_of, arguments.get("picture"), "no_pictures" in arguments)
    values, used_names = dict[str, Any](), {*_ORDER, *VARIANTS}
    parameters = inspect.signature(function).parameters
    for key, parameter in parameters.items():
        used_names |= _names(key, parameter)
        if (value := faults.of(_value, key, parameter, arguments)) is not None:
            values[key] = value
    for name in arguments:
        if arguments[name] not in (None, False, []) and name not in used_names:
            option = "--" + name.replace("_", "-")
            faults.append(
                Fault("E313", f"{option} says nothing of a {variant}", option, "Leave it out.")
            )
    flags = {
        key: _flag(key, declaration)
        for key, parameter in parameters.items()
        if isinstance(declaration := declared_option(parameter), Option)
    }
    desk = Workplace(folder, progress, lambda key: flags.get(key) or "--" + key.replace("_", "-"))
    if "desk" in parameters:
        values["desk"] = desk
    if is_twice and function is api.wedge:
        faults.of(api.design_of_wedge, values)
    faults.refuse()
    with watched():
        outcome = function(**values)
        _deliver(outcome, folder, image, arguments)
        for step in desk.when_written:
            step()
    raise typer.Exit(outcome.exit_code)


def _check_design(
    name: str,
    variants: Mapping[str, Callable[..., StudyOutcome]],
    chosen: str,
    arguments: Mapping[str, Any],
) -> None:
    """Refuse a design beside a variant that takes none, neither of both (E143), and options of designs alone (E313)."""
    flags_without_design = [
        f"--{flag}" for flag, function in variants.items() if not _takes_design(function)
    ]
    if not flags_without_design:
        return
    without_design = f"--{chosen}" in flags_without_design
    if without_design != (arguments["design"] is None):
        message = f"{name} takes a design file or {' or '.join(flags_without_design)}" + (
            ", not both" if without_design else ""
        )
        raise DesignError(
            [
                Fault(
                    "E143",
                    message,
                    "",
                    f"slopekit {name} my.yaml, or slopekit {name} {flags_without_design[0]}",
                )
            ]
        )
    if without_design and (arguments["sets"] or arguments["case"] or arguments.get("picture")):
        message = (
            f"--set, --case and --picture belong to a design file, --{chosen} takes none of them"
        )
        raise DesignError([Fault("E313", message)])


def _names(key: str, parameter: inspect.Parameter) -> set[str]:
    """The name by which a command line gives a parameter, where it does."""
    declaration = declared_option(parameter)
    return set() if declaration is None else {getattr(declaration, "called", "") or key}


def _value(key: str, parameter: inspect.Parameter, arguments: Mapping[str, Any]) -> Any:
    """Return the value of a parameter from the command line, None where it was left out."""
    declaration = declared_option(parameter)
    if declaration is None:
        return None
    key = getattr(declaration, "called", "") or key
    text = arguments[key]
    if declaration == DESIGN:
        with watched("reading"):
            return load_design(text, arguments.get("sets"), arguments.get("case"))
    if isinstance(declaration, Argument) and declaration.many:
        return declaration.reads(text or [], key)
    if text is None or isinstance(text, bool):
        return text or None
    return declaration.reads(
        text, declaration.metavar if isinstance(declaration, Argument) else _flag(key, declaration)
    )


def _deliver(
    outcome: Report, folder: Path | None, image: Path | None, arguments: Mapping[str, Any]
) -> None:
    """Write, print and draw an outcome."""
    as_json, quiet = arguments["as_json"], arguments["quiet"]
    record = outcome.to_dict() if as_json or folder or image else {}
    document = json_text(record) if as_json or folder else ""
    text = "" if as_json or quiet else outcome.sheet.full if arguments["full"] else str(outcome)
    removed = list[Path]()
    if folder is not None:
        with writing(folder, "the folder "), whole_files(folder) as staging:
            _write(outcome, staging, document)
            removed = pictures.remove_older(outcome, folder)
    with aside():
        typer.echo(document if as_json else outcome.line if quiet else text)
    if folder is None and image is None:
        return
    report_stage("pictures", head=True)
    plain = bool(arguments.get("no_pictures"))
    for name, case_outcome in outcome.parts.items() or [("", outcome)]:
        case_record = record["cases"][name] if name else record
        case_image = (
            image and image.with_name(f"{image.stem}-{name}{image.suffix}") if name else image
        )
        pictures.draw(
            case_outcome, case_record, folder and folder / name, case_image, removed, plain=plain
        )


def _write(outcome: Report, folder: Path, document: str) -> None:
    """Write the JSON, the full sheet, tables and further files of an outcome; load cases in folders of their own."""
    base_name, sheet = outcome.file_names
    texts = {
        f"{base_name}.json": document + "\n",
        f"{sheet}.txt": outcome.sheet.full + "\n",
        **outcome.files(),
    }
    for name, content in texts.items():
        (folder / name).write_text(content, encoding="utf-8")
    for name, table in outcome.sheet.tables.items():
        with (folder / name).open("w", encoding="utf-8", newline="") as file:
            table.write(file)
    for name, case_outcome in outcome.parts.items():
        (folder / name).mkdir()
        _write(case_outcome, folder / name, json_text(case_outcome.to_dict()))
