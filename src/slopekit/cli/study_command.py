"""A command made of its function, of a result or a study: options, one driver for files, printing, pictures, exit."""

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
    repeats,
)
from slopekit.cli.progress import aside, progress, watched
from slopekit.core.errors import DesignError, Fault, writing
from slopekit.core.onlooker import say
from slopekit.core.options import DESIGN, Argument, Option, Workplace, given_by
from slopekit.core.shown import Shown
from slopekit.core.whole_files import whole_files
from slopekit.studies.protocol import VARIANTS, StudyOutcome, function_of

#: The functions that give a result; all other commands that are made so are studies.
_RESULTS: Mapping[str, Callable[..., Any]] = {"wedge": api.wedge, "run": api.run}
#: What every command has, by the parameter of the driver: those of studies, and what is another for results.
_OPTIONS = {
    "picture": typer.Option(help="Draw it to a .png, .svg or .pdf file (extra: plot)."),
    "as_json": JSON,
    "full": typer.Option("--full", help="The whole sheet: model, forces, displacements, sensitivities, times."),
    "quiet": typer.Option("--quiet", help="One line."),
    "output": typer.Option("-o", help="Folder for the JSON, the sheet, tables as .csv and pictures."),
}
_OF_RESULTS = {
    "picture": typer.Option(help="Draw the slope and its blocks to a .png, .glb or .gltf file (extra: plot)."),
    "no_pictures": typer.Option("--no-pictures", help="With -o: draw nothing."),
    "quiet": QUIET, "output": FOLDER,
}  # fmt: skip
_ORDER = ("sets", "case", "picture", "no_pictures", "as_json", "full", "quiet", "output")


def command_of(name: str) -> Callable[..., None]:
    """What Typer makes a command of: one with the parameters of the function, and of those of its variants."""
    main = _RESULTS.get(name) or function_of(name)
    variants = {flag: function_of(flag) for flag, (of, _) in VARIANTS.items() if of == name}
    functions = [main, *variants.values()]
    declared: dict[str, inspect.Parameter] = {}
    signatures = [inspect.signature(function).parameters for function in functions]
    for parameters in signatures:
        for key, parameter in parameters.items():
            always = all(key in others for others in signatures)
            for own in _on_command_line(key, parameter, always):
                declared.setdefault(own.name, own)
    for flag, function in variants.items():
        first_line = (inspect.getdoc(function) or "").partition("\n")[0]
        declared[flag] = _parameter(flag, bool, typer.Option(f"--{flag}", help=first_line), False)
    options = dict(_OPTIONS) | (_OF_RESULTS if name in _RESULTS else {})
    if name not in _RESULTS and not any(map(_draws, functions)):
        del options["picture"]
    if with_design := _takes_design(main):
        options |= {"sets": SET, "case": CASE}
    for key in (key for key in _ORDER if key in options):
        is_text = key in ("sets", "case", "picture", "output")
        type_: Any = (list[str] | None if key == "sets" else str | None) if is_text else bool
        declared[key] = _parameter(key, type_, options[key], None if is_text else False)

    def command(**given: Any) -> None:
        chosen = next((flag for flag in variants if given[flag]), "")
        if with_design:
            _check_design(name, variants, chosen, given)
        _drive(variants.get(chosen, main), given, chosen)

    command.__name__ = name
    command.__doc__ = _help_of(main)
    vars(command)["__signature__"] = inspect.Signature(list(declared.values()))
    command.__annotations__ = {own.name: own.annotation for own in declared.values()}
    return command


# -- parameters -------------------------------------------------------------------------------------------------------


def _on_command_line(key: str, parameter: inspect.Parameter, always: bool) -> list[inspect.Parameter]:
    """What a parameter of a study is on the command line: nothing, or one option or argument.

    `always`: the variants of the study have it too.
    """
    how = given_by(parameter)
    if isinstance(how, Argument):
        needed = always and parameter.default is inspect.Parameter.empty and not how.many
        type_ = list[str] | None if how.many else str if needed else str | None
        key = how.called or key
        return [_parameter(key, type_, typer.Argument(help=how.help, metavar=how.metavar), ... if needed else None)]
    if how is None:
        return []
    if isinstance(parameter.default, bool):
        return [_parameter(key, bool, typer.Option(_flag(key, how), help=how.help), False)]
    option = typer.Option(
        _flag(key, how), *how.also, help=how.help, metavar=how.metavar or None, autocompletion=how.completes
    )
    needed = how.needed or parameter.default is inspect.Parameter.empty
    of: Any = {0: list[str], 1: str, 2: tuple[str, str]}[how.texts]
    return [_parameter(key, of if needed else of | None, option, ... if needed else None)]


def _takes_design(function: Callable[..., StudyOutcome]) -> bool:
    return any(given_by(parameter) == DESIGN for parameter in inspect.signature(function).parameters.values())


def _draws(function: Callable[..., StudyOutcome]) -> bool:
    """Whether there are pictures of what a study comes to."""
    outcome = get_type_hints(function)["return"]
    return any(kind.charts is not StudyOutcome.charts for kind in get_args(outcome) or (outcome,))


def _parameter(name: str, type_: Any, how: Any, default: Any) -> inspect.Parameter:
    """A parameter as Typer reads it; `...` for one that is needed."""
    default = inspect.Parameter.empty if default is ... else default
    kind = inspect.Parameter.KEYWORD_ONLY
    return inspect.Parameter(name, kind, default=default, annotation=Annotated[type_, how])


def _flag(key: str, how: Option) -> str:
    return how.flag or "--" + key.replace("_", "-")


def _help_of(function: Callable[..., Any]) -> str:
    """The docstring down to its parameters: what a command line has to say."""
    return (inspect.getdoc(function) or "").partition("\nParameters\n")[0].partition("\nRaises\n")[0].strip()


# -- the driver -------------------------------------------------------------------------------------------------------


def _drive(function: Callable[..., Any], given: Mapping[str, Any], variant: str) -> None:
    """Read what was given, call the function, write and print and draw what it comes to, leave with its exit code."""
    faults, folder, image = repeats(sys.argv[1:]), None, None
    is_twice = bool(faults)
    if given["output"] is not None:
        folder = faults.of(folder_of, Path(given["output"]))
    image = faults.of(pictures.picture_of, given.get("picture"), "no_pictures" in given)
    values, taken = dict[str, Any](), {*_ORDER, *VARIANTS}
    parameters = inspect.signature(function).parameters
    for key, parameter in parameters.items():
        taken |= _names(key, parameter)
        if (value := faults.of(_value, key, parameter, given)) is not None:
            values[key] = value
    for name in given:
        if given[name] not in (None, False, []) and name not in taken:
            option = "--" + name.replace("_", "-")
            faults.append(Fault("E313", f"{option} says nothing of a {variant}", option, "Leave it out."))
    flags = {key: _flag(key, how) for key, one in parameters.items() if isinstance(how := given_by(one), Option)}
    desk = Workplace(folder, progress, lambda key: flags.get(key) or "--" + key.replace("_", "-"))
    if "desk" in parameters:
        values["desk"] = desk
    if is_twice and function is api.wedge:
        faults.of(api.design_of_wedge, values)
    faults.refuse()
    with watched():
        outcome = function(**values)
        _deliver(outcome, folder, image, given)
        for step in desk.when_written:
            step()
    raise typer.Exit(outcome.exit_code)


def _check_design(
    name: str, variants: Mapping[str, Callable[..., StudyOutcome]], chosen: str, given: Mapping[str, Any]
) -> None:
    """Refuse a design and a variant without one (E143), neither of both, and what belongs to a design (E313)."""
    alone = [f"--{flag}" for flag, function in variants.items() if not _takes_design(function)]
    if not alone:
        return
    of_its_own = f"--{chosen}" in alone
    if of_its_own != (given["design"] is None):
        message = f"{name} takes a design file or {' or '.join(alone)}" + (", not both" if of_its_own else "")
        raise DesignError([Fault("E143", message, "", f"slopekit {name} my.yaml, or slopekit {name} {alone[0]}")])
    if of_its_own and (given["sets"] or given["case"] or given.get("picture")):
        message = f"--set, --case and --picture belong to a design file, --{chosen} takes none of them"
        raise DesignError([Fault("E313", message)])


def _names(key: str, parameter: inspect.Parameter) -> set[str]:
    """The name by which a command line gives a parameter, where it does."""
    how = given_by(parameter)
    return set() if how is None else {getattr(how, "called", "") or key}


def _value(key: str, parameter: inspect.Parameter, given: Mapping[str, Any]) -> Any:
    """What a parameter of the study is given, None where that is left to it."""
    how = given_by(parameter)
    if how is None:
        return None
    key = getattr(how, "called", "") or key
    text = given[key]
    if how == DESIGN:
        with watched("reading"):
            return load_design(text, given.get("sets"), given.get("case"))
    if isinstance(how, Argument) and how.many:
        return how.reads(text or [], key)
    if text is None or isinstance(text, bool):
        return text or None
    return how.reads(text, how.metavar if isinstance(how, Argument) else _flag(key, how))


def _deliver(outcome: Shown, folder: Path | None, image: Path | None, given: Mapping[str, Any]) -> None:
    """Write, print and draw what a function came to."""
    as_json, quiet = given["as_json"], given["quiet"]
    record = outcome.to_dict() if as_json or folder or image else {}
    document = json_text(record) if as_json or folder else ""
    text = "" if as_json or quiet else outcome.sheet.full if given["full"] else str(outcome)
    removed = list[Path]()
    if folder is not None:
        with writing(folder, "the folder "), whole_files(folder) as staging:
            _write(outcome, staging, document)
            removed = pictures.remove_older(outcome, folder)
    with aside():
        typer.echo(document if as_json else outcome.line if quiet else text)
    if folder is None and image is None:
        return
    say("pictures", head=True)
    plain = bool(given.get("no_pictures"))
    for name, part in outcome.parts.items() or [("", outcome)]:
        own = record["cases"][name] if name else record
        beside = image and image.with_name(f"{image.stem}-{name}{image.suffix}") if name else image
        pictures.draw(part, own, folder and folder / name, beside, removed, plain=plain)


def _write(outcome: Shown, folder: Path, document: str) -> None:
    """The JSON, the full sheet, the tables and further files; what it is made of in folders of their own."""
    own, sheet = outcome.file_names
    texts = {f"{own}.json": document + "\n", f"{sheet}.txt": outcome.sheet.full + "\n", **outcome.files()}
    for name, content in texts.items():
        (folder / name).write_text(content, encoding="utf-8")
    for name, table in outcome.sheet.tables.items():
        with (folder / name).open("w", encoding="utf-8", newline="") as file:
            table.write(file)
    for name, part in outcome.parts.items():
        (folder / name).mkdir()
        _write(part, folder / name, json_text(part.to_dict()))
