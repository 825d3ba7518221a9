"""Sources of an export: a result, its JSON as a dict, or the file that holds it."""

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

from slopekit.block_scene import BlockScene
from slopekit.core.errors import DesignError, Fault
from slopekit.exchange.documents import MAKE, Document, by_case, load_document
from slopekit.result import Result

if TYPE_CHECKING:
    from slopekit.studies.cases import Cases


@dataclass(frozen=True)
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


ExportInput: TypeAlias = "Result | Cases[Any] | Mapping[str, Any] | str | os.PathLike[str]"


def sources_of(result: ExportInput, case: str | None = None) -> dict[str, ExportSource]:
    """Return the export source of each load case, or of the one that is named, by name (empty without cases).

    Raises
    ------
    DesignError
        Those of `export_source`; E197 and E313 for the name of a case.
    """
    if isinstance(result, Result) and case is None:
        return {"": export_source(result)}
    document, file = load_document(result)
    name = "the result" if file is None else file.name
    return {
        case_name: export_source(case_document, f"{name}, case {case_name}" if case_name else name)
        for case_name, case_document in by_case(document, case, name).items()
    }


def export_source(result: "Result | Document", name: str = "") -> ExportSource:
    """A result, or its JSON, as a source.

    Raises
    ------
    DesignError
        E350 it holds no scene.
    """
    if isinstance(result, Result):
        document = {key: value for key, value in result.to_dict().items() if key != "scene"}
        return ExportSource(document, result.scene)
    scene = result.get("scene")
    if scene is None:
        raise DesignError([_no_scene(result, name)])
    return ExportSource(result, BlockScene.from_dict(scene))


def _no_scene(document: Mapping[str, Any], name: str) -> Fault:
    study = document.get("study")
    if study or "geometry" not in document:
        study_message = f"{name} is the result of {study or 'a study'}, it holds no blocks"
        return Fault(
            "E350", study_message, name, f"Files are made of the result of one design. {MAKE}"
        )
    message = f"{name} holds no scene: slopekit {document.get('slopekit')} wrote none"
    return Fault("E350", message, name, f"Make it again. {MAKE}")


#: One load of several of its kind.
NUMBERED = re.compile(r"^(active bolt|passive bolt|force) (\d+)(,.*)?$")


def bolt_of_load(document: Mapping[str, Any], name: str) -> tuple[str, int] | None:
    """Return how a bolt acts and its number in the design, from the name of its load; None for other loads.

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
    bolt_numbers = [
        k for k, bolt in enumerate(inputs.get("bolts") or [], 1) if bolt["acts"] == acts
    ]
    return (acts, bolt_numbers[number - 1]) if 0 < number <= len(bolt_numbers) else None
