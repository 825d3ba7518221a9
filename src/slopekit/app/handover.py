"""Files to download from the app: page, DXF, JSON, design, and the command line that gives the same numbers.

>>> from slopekit.app.session import Session, opened_template
>>> session = Session(opened_template("wedge"))
>>> session.set({"strength.weak.phi": 25, "water.fill": 0.5}, final=True)
>>> command_of(session).split(" --set ", 1)[1]
'strength.weak.phi=25 --set water.mode=null --set water.fill=0.5'
"""

import json
import shlex
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from slopekit.app.saving import digest_of_file, edited, in_brackets
from slopekit.app.session import Session, differing_paths
from slopekit.core.errors import DesignError, Fault
from slopekit.design import templates
from slopekit.design.reading.nodes import Node

FORMATS = ("page", "dxf", "json", "command", "yaml")
_BRACKETS = ("[", "{", "'", '"')


#: A file to be downloaded by its name, and what is in it; nothing of it is on the disk.
File = tuple[str, bytes]


def file_of(format_name: str, session: Session, document: Mapping[str, Any] | None) -> File:
    """A file of a design and its result.

    Parameters
    ----------
    document : the JSON of its result; of yaml it is not needed

    Raises
    ------
    DesignError
        E541 for what is none, E548 without a result, E140 without the extra.
    """
    stem = Path(session.opened.name).stem or "design"
    if format_name == "yaml":
        return f"{stem}.yaml", edited(session.opened, session.moment.document).encode()
    if format_name not in FORMATS:
        raise DesignError(
            [Fault("E541", f"{format_name!r} is nothing to hand over: {', '.join(FORMATS)}")]
        )
    if document is None:
        raise DesignError(
            [Fault("E548", "there is no result of this design yet", "", "Analyse it first.")]
        )
    if format_name == "json":
        return f"{stem}.json", json.dumps(
            document, ensure_ascii=False, indent=1, allow_nan=False
        ).encode()
    if format_name == "dxf":
        return f"{stem}.dxf", _dxf(document, stem)
    from slopekit.views.pages.report import report_of

    return f"{stem}.html", report_of(document, with_pictures=False).html.encode()


def _dxf(document: Mapping[str, Any], stem: str) -> bytes:
    """The writer of DXF needs a file: it stands in a folder of its own that is gone afterwards."""
    from slopekit.exchange.export import export

    with tempfile.TemporaryDirectory(prefix="slopekit-") as folder:
        path = Path(folder) / f"{stem}.dxf"
        export(document, path)
        return path.read_bytes()


def command_of(session: Session) -> str:
    """The command line that gives the numbers on the page; of a design without a file that of its YAML once saved.

    It is written for a shell of POSIX.
    """
    words = ["slopekit", "run", str(_file(session))]
    if session.opened.path is not None or _template(session) is not None:
        words += [word for setting in settings(session) for word in ("--set", setting)]
    words += (
        ["--set", "cases=null"] if session.opened.cases else []
    )  # they stand aside on the page too
    return shlex.join(words)


def note_of(session: Session) -> str:
    """Return what the user must do before the command line gives these numbers; empty where nothing.

    Raises
    ------
    DesignError
        The faults of the design; E545 where its file changed on the disk: the line would give other numbers.
    """
    opened = session.opened
    if session.moment.faults:
        raise DesignError(session.moment.faults)
    if opened.path is not None and digest_of_file(opened.path) != opened.digest:
        advice = (
            "Open it again, or save under another name: the command line would give other numbers."
        )
        raise DesignError(
            [Fault("E545", f"{opened.name} changed on the disk since it was read", "", advice)]
        )
    if opened.path is None and _template(session) is None:
        return f"First save the design as {opened.name}, or download its YAML: the line reads that file."
    return ""


def _file(session: Session) -> Path:
    opened = session.opened
    return opened.path or _template(session) or Path(opened.name)


def _template(session: Session) -> Path | None:
    """The shipped file of a design that began as one."""
    name = session.opened.name.removesuffix(".yaml")
    if session.opened.path is not None or name not in templates.names():
        return None
    path = templates.path_of(name)
    return path if path.read_text(encoding="utf-8") == session.opened.text else None


def settings(session: Session) -> list[str]:
    """Return the values of `--set` that turn the file into the design."""
    opened_root, root = session.opened.document.root, session.moment.document.root
    return [f"{path}={_value(root.find(path))}" for path in differing_paths(opened_root, root)]


def _value(node: Node) -> str:
    if node.value is None:
        return "null"
    if node.text is None:
        return in_brackets(node)
    return (
        json.dumps(node.text, ensure_ascii=False)
        if node.text.lstrip()[:1] in _BRACKETS
        else node.text
    )
