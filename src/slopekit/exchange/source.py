"""Where what is exported comes from: a result, its JSON as a dict, or the file that holds it."""

import json
import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from slopekit.block_scene import BlockScene
from slopekit.core.errors import DesignError, Fault
from slopekit.core.records import dataclass

if TYPE_CHECKING:
    from slopekit.result import Result
    from slopekit.studies.cases import Cases

_MOST_BYTES = 2_000_000_000
_RESULT = "result.json"  # what `run -o DIR` calls it
_MAKE = "slopekit run design.yaml -o DIR makes one: DIR/result.json."


@dataclass(frozen=True, slots=True)
class ExportSource:
    """A result to export: its JSON, and the scene that stands in it."""

    document: Mapping[str, Any]
    scene: BlockScene

    @property
    def is_curved(self) -> bool:
        """Whether the block lies on a curved slip surface."""
        return "slip" in (self.document.get("inputs") or {})

    @property
    def is_section(self) -> bool:
        """Whether the blocks are drawn out of a vertical section."""
        return (self.document.get("geometry") or {}).get("thickness_m") is not None


Given: TypeAlias = "Result | Cases[Any] | Mapping[str, Any] | str | os.PathLike[str]"


def sources_of(given: Given, case: str | None = None) -> dict[str, ExportSource]:
    """What `source_of` makes, of each load case by its name or of the one that is named; without cases by no name.

    Raises
    ------
    DesignError
        Those of `source_of`; E197 and E313 for the name of a case.
    """
    from slopekit.result import Result

    if isinstance(given, Result) and case is None:
        return {"": source_of(given)}
    document, name = _document(given)
    if document.get("study") != "cases" and case is None:
        return {"": source_of(document, name)}
    from slopekit.studies.cases import of_cases  # most results have none

    return {own: source_of(one, f"{name}, case {own}") for own, one in of_cases(document, case, name).items()}


def source_of(given: Given, name: str = "") -> ExportSource:
    """A result, its JSON, or the path of its JSON file or of the folder of result.json, as a source.

    Raises
    ------
    DesignError
        E147 to E149 the file cannot be read, E340 it is no result of slopekit, E350 it holds no scene.
    """
    from slopekit.result import Result

    if isinstance(given, Result):
        own = {key: value for key, value in given.to_dict().items() if key != "scene"}
        return ExportSource(own, given.scene)
    document, called = _document(given)
    name = name or called
    if "slopekit" not in document:
        raise DesignError([Fault("E340", f"{name} is not a result of slopekit: it has no key slopekit", name, _MAKE)])
    if "errors" in document:
        message = f"{name} holds the faults of a run, not its result"
        raise DesignError([Fault("E340", message, name, "Mend the design and run it again.")])
    scene = document.get("scene")
    if scene is None:
        raise DesignError([_no_scene(document, name)])
    return ExportSource(document, BlockScene.from_dict(scene))


def _document(given: object) -> tuple[Mapping[str, Any], str]:
    """The JSON of what is given, and what to call it in a fault."""
    if isinstance(given, Mapping):
        return given, "the result"
    if isinstance(given, str | os.PathLike):
        path = Path(given)
        if path.is_dir() and (path / _RESULT).is_file():
            path = path / _RESULT
        return _read(path), path.name
    name = type(given).__name__
    to_dict = getattr(given, "to_dict", None)
    if callable(to_dict) and not isinstance(given, type):
        document = to_dict()
        if isinstance(document, Mapping):
            return document, f"the {name}"
    raise DesignError([Fault("E340", f"{name} is not a result of slopekit, its JSON or its path", name, _MAKE)])


def _no_scene(document: Mapping[str, Any], name: str) -> Fault:
    study = document.get("study")
    if study or "geometry" not in document:
        what = f"{name} is the result of {study or 'a study'}, it holds no blocks"
        return Fault("E350", what, name, f"Files are made of the result of one design. {_MAKE}")
    message = f"{name} holds no scene: slopekit {document.get('slopekit')} wrote none"
    return Fault("E350", message, name, f"Make it again. {_MAKE}")


def _read(path: Path) -> Mapping[str, Any]:
    """The JSON object of a file."""
    from slopekit.design.reading.on_disk import read_bytes

    try:
        document = json.loads(read_bytes(path, _MOST_BYTES).decode("utf-8-sig"))
    except (UnicodeDecodeError, json.JSONDecodeError) as error:
        advice = f"A design is run first. {_MAKE}" if path.suffix.lower() in (".yaml", ".yml") else _MAKE
        message = f"{path.name} is not a result of slopekit: it is no JSON ({str(error)[:80]})"
        raise DesignError([Fault("E340", message, str(path), advice)]) from None
    if not isinstance(document, dict):
        raise DesignError([Fault("E340", f"{path.name} is not a result of slopekit: no keys", str(path), _MAKE)])
    return document


#: One load of several of its kind.
NUMBERED = re.compile(r"^(active bolt|passive bolt|force) (\d+)(,.*)?$")


def bolt_of_load(document: Mapping[str, Any], name: str) -> tuple[str, int] | None:
    """How the bolt acts that a load of a scene is, and its number as the design lists it; None for other loads.

    A scene numbers active and passive bolts each for themselves, and those of many blocks that are active after the
    forces.

    >>> bolts = [{"acts": "passive"}, {"acts": "active"}]
    >>> bolt_of_load({"inputs": {"bolts": bolts}}, "active bolt 1")
    ('active', 2)
    """
    match, inputs = NUMBERED.match(name), document.get("inputs") or {}
    if match is None:
        return None
    acts, number = match[1].removesuffix(" bolt"), int(match[2])
    if acts == "force":
        acts, number = "active", number - len(inputs.get("forces") or [])
        if document.get("assembly") is None:
            return None
    own = [k for k, bolt in enumerate(inputs.get("bolts") or [], 1) if bolt["acts"] == acts]
    return (acts, own[number - 1]) if 0 < number <= len(own) else None
