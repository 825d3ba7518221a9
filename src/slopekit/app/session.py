"""One design under work: what it is now, what it was opened as, undo, redo, and what is not saved yet.

A change makes a new tree of the design (a tenth of a millisecond: no text is read again) and reads it; what it was
before is kept for undo. Nothing here is analysed.

>>> session = Session.of_template("wedge")
>>> session.set({"joints.J1.plane.dip": 50}, final=True)
>>> session.design.joints[0].dip_deg, session.changed, session.can_undo
(50.0, ['joints.J1.plane.dip'], True)
>>> session.undo()
>>> session.design.joints[0].dip_deg, session.changed
(45.0, [])
"""

import hashlib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from slopekit.app import controls
from slopekit.core.errors import DesignError, Fault
from slopekit.core.records import dataclass
from slopekit.design import templates
from slopekit.design.common import Design
from slopekit.design.document import read_text
from slopekit.design.files import design_of, load_document_design
from slopekit.design.nodes import Document, Node
from slopekit.design.overrides import with_overrides

#: What is answered while a slider is dragged, when it is let go, and when a button is pressed.
LIVE: Mapping[str, str] = {
    "wedge": "drag", "plane": "drag", "footing": "drag", "topple": "release", "blocks": "release", "surface": "release",
    "bench": "button",
}  # fmt: skip
_MOST_UNDONE = 500
_LONGEST = 2000  # letters of one value


@dataclass(frozen=True, slots=True)
class Opened:
    """A design as it was opened.

    Attributes
    ----------
    text : as the file has it, empty where there is none
    path : the file, None of a template and of text that has none yet
    digest : SHA-256 of the file's bytes when it was read
    name : what it is called; where : the folder that its other files (meshes, joint lists) stand in
    """

    text: str
    path: Path | None
    digest: str
    name: str
    document: Document
    design: Design


@dataclass(frozen=True, slots=True)
class Moment:
    """A design at one moment: what an analysis is asked of, whatever is set meanwhile.

    `design` is the last sound one where there are `faults`.
    """

    rev: int
    document: Document
    design: Design
    faults: tuple[Fault, ...] = ()


def digest_of(content: bytes) -> str:
    """SHA-256 of a file, as hexadecimal digits."""
    return hashlib.sha256(content).hexdigest()


def opened_text(text: str, name: str, path: Path | None = None, digest: str = "") -> Opened:
    """A design of the text of a file.

    Raises
    ------
    DesignError
        With every fault found.
    """
    document, faults = read_text(text, name, path)
    design = load_document_design(document, faults)
    assert design.source is not None
    return Opened(text, path, digest, name, design.source, design)


def opened_file(path: Path) -> Opened:
    """A design of a file. Raises DesignError with every fault found."""
    from slopekit.design.document import decoded
    from slopekit.design.on_disk import read_bytes

    content = read_bytes(path)
    return opened_text(decoded(content, path.name), path.name, path, digest_of(content))


class Session:
    """A design under work.

    Attributes
    ----------
    opened : as it was opened; now : at this moment
    """

    def __init__(self, opened: Opened) -> None:
        self.rev = 0
        self.open(opened)

    @classmethod
    def of_template(cls, name: str) -> "Session":
        """A session that begins with a template. Raises DesignError E177 for a name that is none."""
        return cls(opened_template(name))

    def open(self, opened: Opened) -> None:
        """Take another design; there is nothing to undo then."""
        self.rev += 1
        self.opened = opened
        self.now = Moment(self.rev, opened.document, opened.design)
        self.done: list[Document] = []
        self.undone: list[Document] = []
        self.settled = opened.document
        self.before = controls.values_of(opened.design)

    # -- what it is ---------------------------------------------------------------------------------------------------

    @property
    def design(self) -> Design:
        """The last sound design."""
        return self.now.design

    @property
    def live(self) -> str:
        """When it is answered: drag, release or button."""
        found = LIVE.get(self.design.kind, "release")
        return "release" if found == "drag" and self.design.criterion != "limit" else found

    @property
    def can_undo(self) -> bool:
        """Whether there is something to undo."""
        return bool(self.done) or self.now.document is not self.settled

    @property
    def can_redo(self) -> bool:
        """Whether something was undone."""
        return bool(self.undone)

    @property
    def changed(self) -> list[str]:
        """The paths of what is another than when the design was opened: numbers by value, words as written."""
        if self.now.document is self.opened.document:
            return []
        now = controls.values_of(replace(self.design, source=self.now.document))
        found = [path for path, key in now.items() if controls.is_changed(key, self.before.get(path))]
        words = (path for path in different(self.opened.document.root, self.now.document.root) if path not in now)
        return [*found, *(path for path in words if not any(one.startswith(f"{path}.") for one in found))]

    @property
    def is_saved(self) -> bool:
        """Whether there is nothing that a save would write."""
        return self.now.document is self.opened.document or not different(
            self.opened.document.root, self.now.document.root
        )

    # -- changes ------------------------------------------------------------------------------------------------------

    def set(self, values: Mapping[str, Any], final: bool) -> None:
        """Put values in place of those of the design; a run of changes that are not final is undone with the final one.

        Raises
        ------
        DesignError
            Where the values fit nowhere: nothing is changed then. What is no sound design is, with `now.faults`.
        """
        document = self.now.document
        for path, value in values.items():
            document = self._with(document, path, value)
        self._become(document)
        if final:
            self.settle()

    def settle(self) -> None:
        """Make what was changed since the last time one step to undo."""
        if self.now.document is not self.settled:
            self.done.append(self.settled)
            del self.done[:-_MOST_UNDONE]
            self.undone.clear()
            self.settled = self.now.document

    def undo(self) -> None:
        """Go back one step; at the first there is nothing to do."""
        self.settle()
        if self.done:
            self.undone.append(self.settled)
            self.settled = self.done.pop()
            self._become(self.settled)

    def redo(self) -> None:
        """Go forth again."""
        if self.undone and self.now.document is self.settled:
            self.done.append(self.settled)
            self.settled = self.undone.pop()
            self._become(self.settled)

    def reset(self, path: str) -> None:
        """Put back at a path what the design was opened with."""
        text = controls.text_at(self.opened.document, path)
        old = self.before.get(path)
        if text is not None:
            self.set({path: text}, final=True)
        elif old is not None and old.written_out and old.value is not None and self._others_as_opened(path):
            self.set({old.written_out[0][0]: None}, final=True)  # the orientation that was written out for it
        elif old is not None and old.written_out and old.value is not None:
            self.set({path: old.written(old.value)}, final=True)
        else:
            self.set({path: None}, final=True)

    def _others_as_opened(self, path: str) -> bool:
        above = path.rpartition(".")[0]
        now = controls.values_of(replace(self.design, source=self.now.document))
        return all(
            not controls.is_changed(key, self.before.get(other))
            for other, key in now.items() if other != path and other.rpartition(".")[0] == above
        )  # fmt: skip

    def _with(self, document: Document, path: str, value: Any) -> Document:
        """The tree with one value put in."""
        key = controls.values_of(replace(self.design, source=document)).get(path) if "." in path else None
        given: list[tuple[str, object]] = []
        if key is not None and key.written_out and value is not None:
            given += key.written_out
        if isinstance(value, int | float) and not isinstance(value, bool):
            value = controls.written(replace(self.design, source=document), path, float(value))
        if isinstance(value, str) and len(value) > _LONGEST:
            raise DesignError([Fault("E541", f"{path} has {len(value)} letters, {_LONGEST} are the most", path)])
        if path == "title" and isinstance(value, str):
            return _titled(document, value)
        for one in (*given, (path, value)):
            document = with_overrides(document, [one])
        return document

    def _become(self, document: Document) -> None:
        self.rev += 1
        try:
            design = replace(design_of(document, other_values=True), source=document)
        except DesignError as error:
            self.now = Moment(self.rev, document, self.now.design, error.faults)
            return
        self.now = Moment(self.rev, document, design)


def opened_template(name: str) -> Opened:
    """A template as a design without a file of its own. Raises DesignError E177 for a name that is none."""
    path = templates.path_of(name)
    return opened_text(path.read_text(encoding="utf-8"), path.name)


def _titled(document: Document, text: str) -> Document:
    """The title is words, whatever they begin with."""
    from slopekit.design.nodes import Place, cut, printable

    place = Place("--set", 0, 0, cut(f"title={text}"))
    return with_overrides(document, [("title", Node(printable(text), place, "title", place))])


def different(one: Node | None, other: Node | None) -> list[str]:
    """The paths at which two trees differ, each as high up as one of them has nothing or a value of another shape.

    >>> from slopekit.design.nodes import document_from
    >>> a, b = (document_from({"slope": {"height": h}, "water": "dry"}).root for h in (10, 12))
    >>> different(a, b)
    ['slope.height']
    """
    if one is other:
        return []
    if one is None or other is None:
        there = one or other
        return [there.path] if there is not None else []
    if one.is_mapping and other.is_mapping:
        keys = dict.fromkeys([*(key for key, _ in one.items()), *(key for key, _ in other.items())])
        return [path for key in keys for path in different(one.get(key), other.get(key))]
    if isinstance(one.value, list) and isinstance(other.value, list) and len(one.value) == len(other.value):
        return [path for a, b in zip(one.value, other.value, strict=True) for path in different(a, b)]
    return [] if one.plain() == other.plain() else [other.path or one.path]


def at(root: Node, path: str) -> Node | None:
    """The node at a dotted path; keys may have dots (of correlations)."""
    node: Node | None = root
    parts = path.split(".") if path else []
    while parts and node is not None:
        if isinstance(node.value, list):
            part = parts.pop(0)
            node = node.elements[int(part)] if part.isdigit() and int(part) < len(node.elements) else None
            continue
        for count in range(1, len(parts) + 1):
            below = node.get(".".join(parts[:count]))
            if below is not None:
                node, parts = below, parts[count:]
                break
        else:
            return None
    return node


__all__ = ["LIVE", "Moment", "Opened", "Session", "at", "different", "opened_file", "opened_template", "opened_text"]
