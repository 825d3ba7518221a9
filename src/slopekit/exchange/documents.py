"""JSON that slopekit wrote, read again: of a file, a folder, a result or a study."""

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeAlias

from slopekit.core.codec import finite
from slopekit.core.errors import DesignError, Fault
from slopekit.design.reading.nodes import cut
from slopekit.design.reading.on_disk import read_bytes

Document: TypeAlias = Mapping[str, Any]
_MOST_BYTES = 2_000_000_000
MAKE = "slopekit run design.yaml -o DIR makes one: DIR/result.json."


def load_document(source: Any) -> tuple[Document, Path | None]:
    """The JSON of a result, a study, their `to_dict()`, or the path of their JSON or folder; and the file, if any.

    Raises
    ------
    DesignError
        E147 to E149 for a file, E340 what slopekit has not written.
    """
    if isinstance(source, str | os.PathLike):
        file = document_file(Path(source))
        return read_document(file), file
    to_dict = getattr(source, "to_dict", None)
    document = to_dict() if callable(to_dict) and not isinstance(source, type) else source
    name = type(source).__name__
    if not isinstance(document, Mapping):
        raise DesignError(
            [Fault("E340", f"{name} is not a result of slopekit, its JSON or its path", name, MAKE)]
        )
    return checked_document(document, name), None


def read_document(path: Path) -> Document:
    """The JSON of a file.

    Raises
    ------
    DesignError
        E147 to E149 for the file, E340 no JSON of slopekit's.
    """
    content = read_bytes(path, _MOST_BYTES)
    try:
        document = json.loads(
            content.decode("utf-8-sig"), parse_float=finite, parse_constant=finite
        )
    except (ValueError, RecursionError) as error:  # UnicodeDecodeError among them
        raise DesignError([_no_json(path, content, error)]) from None
    return checked_document(document, path.name)


def _no_json(path: Path, content: bytes, error: Exception) -> Fault:
    """E340, with what the file is in place of JSON."""
    message = f"{path.name} is not JSON: {error}" if content.strip() else f"{path.name} is empty"
    advice = "slopekit run design.yaml -o DIR writes result.json; --json > file.json will do too."
    if path.suffix.lower() in (".yaml", ".yml"):
        advice = f"It looks like a design: slopekit run {path} -o DIR writes result.json, which can be drawn."
    elif content.lstrip()[:1] in (b"{", b"["):
        advice = "Was it written to the end? Make it again."
    elif path.suffix.lower() == ".csv":
        advice = f"It is a table: give the JSON that was written beside it. {advice}"
    return Fault("E340", message, str(path), advice)


def document_file(path: Path) -> Path:
    """The file that a path means: of a folder its result.json, or the only JSON of slopekit that it holds.

    Raises
    ------
    DesignError
        E148 where a folder holds none, or more than one.
    """
    try:
        if not path.is_dir():
            return path
        if (path / "result.json").is_file():
            return path / "result.json"
        json_files = sorted(
            file for file in path.iterdir() if file.suffix.lower() == ".json" and file.is_file()
        )
        slopekit_files = [file for file in json_files if b'"slopekit"' in _begin(file)]
    except OSError as error:
        message = (
            f"{cut(str(path))} cannot be read: {(error.strerror or 'the system refuses').lower()}"
        )
        raise DesignError([Fault("E148", message, cut(str(path)))]) from None
    if len(slopekit_files) == 1:
        return slopekit_files[0]
    names = [file.name for file in slopekit_files or json_files]
    more = f" and {len(names) - 6} more" if len(names) > 6 else ""
    advice = f"It holds {', '.join(names[:6])}{more}." if names else "It holds no JSON."
    raise DesignError([Fault("E148", f"{path} is a folder, a file is needed", str(path), advice)])


def _begin(file: Path) -> bytes:
    with file.open("rb") as opened:
        return opened.read(4096)


def checked_document(document: Any, name: str) -> Document:
    """A document if slopekit has written it, else E340."""
    if not isinstance(document, Mapping) or "slopekit" not in document:
        message = f"{name} is not of slopekit: it has no key slopekit"
        raise DesignError(
            [Fault("E340", message, name, "Give a file that slopekit wrote with -o or --json.")]
        )
    if "errors" in document and "kind" not in document:
        codes = [
            str(fault.get("code")) for fault in document["errors"] if isinstance(fault, Mapping)
        ]
        message = f"{name} holds the faults of a run that failed ({', '.join(codes)}), no result"
        raise DesignError([Fault("E340", message, name, "Repair its input, and run it again.")])
    if not isinstance(document.get("kind", ""), str) or (
        "version" in document and "kind" not in document
    ):
        raise DesignError([Fault("E340", f"{name} is no result of slopekit", name)])
    return document


def by_case(document: Document, case: str | None = None, name: str = "") -> dict[str, Document]:
    """The documents of the load cases of a document by their names; {"": itself} without any, see `of_cases`."""
    from slopekit.studies.cases import of_cases  # most documents have none

    if document.get("study") != "cases" and case is None:
        return {"": document}
    return {
        case_name: checked_document(case_document, f"{name}, case {case_name}")
        for case_name, case_document in of_cases(document, case, name).items()
    }
