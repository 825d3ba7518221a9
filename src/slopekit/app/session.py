"""One design under work: what it is now, what it was opened as, undo, redo, and what is not saved yet.

A change makes a new tree of the design (a tenth of a millisecond: no text is read again) and reads it; what it was
before is kept for undo. Nothing here is analysed.

>>> session = Session(opened_template("wedge"))
>>> session.set({"joints.J1.plane.dip": 50}, final=True)
>>> session.design.joints[0].dip_deg, session.changed, session.can_undo
(50.0, ['joints.J1.plane.dip'], True)
>>> session.undo()
>>> session.design.joints[0].dip_deg, session.changed
(45.0, [])
"""

import hashlib
import re
from collections.abc import Iterable, Mapping
from copy import copy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from slopekit.app import controls
from slopekit.core.errors import DesignError, Fault
from slopekit.design import templates
from slopekit.design.common import Design
from slopekit.design.reading.document import ALTERNATIVES, decoded, read_text, with_overrides
from slopekit.design.reading.files import design_of, load_document_design
from slopekit.design.reading.nodes import Document, Node, Place, cut, printable
from slopekit.design.reading.structure import WRITTEN_ANGLES
from slopekit.studies.keys import Key

_MOST_UNDONE = 500
_ANGLES = frozenset(angle for angles in WRITTEN_ANGLES.values() for angle in angles)
_NUMBER = re.compile(r"\s*[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d{1,2})?(?![\d,.e])", re.IGNORECASE)
_LONGEST = 2000  # letters of one value


@dataclass(frozen=True)
class Opened:
    """A design as it was opened.

    Attributes
    ----------
    text : as the file has it, empty where there is none
    path : the file, None of a template and of text that has none yet
    digest : SHA-256 of the file's bytes when it was read
    name : what it is called; cases : the names of its load cases, which `document` lacks
    """

    text: str
    path: Path | None
    digest: str
    name: str
    document: Document
    design: Design
    cases: tuple[str, ...] = ()


@dataclass(frozen=True)
class Moment:
    """A design at one moment: what an analysis is asked of, whatever is set meanwhile.

    `design` is the last sound one where there are `faults`; `cases` are the load cases that stand aside.
    """

    rev: int
    document: Document
    design: Design
    faults: tuple[Fault, ...] = ()
    cases: tuple[str, ...] = ()


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
    names = tuple(name for name, _ in document.root.get("cases").items())
    return Opened(text, path, digest, name, design.source, design, names)


def opened_file(path: Path) -> Opened:
    """A design of a file. Raises DesignError with every fault found."""
    from slopekit.design.reading.on_disk import read_bytes

    content = read_bytes(path)
    return opened_text(decoded(content, path.name), path.name, path, digest_of(content))


class Session:
    """A design under work.

    Attributes
    ----------
    opened : the design as it was opened; moment : the design as it is now
    """

    def __init__(self, opened: Opened) -> None:
        self.rev = 0
        self.open(opened)

    def open(self, opened: Opened) -> None:
        """Work on another design; the steps to undo are forgotten."""
        self.rev += 1
        self.opened_rev = self.rev
        self.opened = opened
        self.moment = Moment(self.rev, opened.document, opened.design, cases=opened.cases)
        self.done: list[Document] = []
        self.undone: list[Document] = []
        self.settled = opened.document
        self.opened_values = controls.values_of(opened.design)
        self._displayed_document, self._displayed_design, self._numbers = (
            opened.document,
            opened.design,
            self.opened_values,
        )

    # -- what it is ---------------------------------------------------------------------------------------------------

    @property
    def design(self) -> Design:
        """The last sound design."""
        return self.moment.design

    @property
    def live(self) -> str:
        """When it is answered: drag, release or button."""
        if not self.design.HAS_CLOSED_FORM:
            return self.design.ANSWERED
        return "drag" if self.design.analysis.criterion == "limit" else "release"

    @property
    def can_undo(self) -> bool:
        """Whether there is something to undo."""
        return bool(self.done) or self.moment.document is not self.settled

    @property
    def can_redo(self) -> bool:
        """Whether something was undone."""
        return bool(self.undone)

    @property
    def displayed_design(self) -> Design:
        """The design whose numbers the page shows: as written where that can be read, else the last sound one."""
        self._update_displayed()
        return self._displayed_design

    @property
    def numbers(self) -> Mapping[str, Key]:
        """The numbers by path, as `controls.values_of`."""
        self._update_displayed()
        return self._numbers

    def _update_displayed(self) -> None:
        if self._displayed_document is not self.moment.document:
            self._displayed_document, self._displayed_design = self.moment.document, self.design
            if self.design.source is not self.moment.document:
                self._displayed_design = replace(self.design, source=self.moment.document)
            try:
                self._numbers = controls.values_of(self._displayed_design)
            except DesignError:  # a distribution that is none
                self._displayed_design = self.design
                self._numbers = controls.values_of(self.design)

    @property
    def changed(self) -> list[str]:
        """The paths whose values differ from those of the opened design: numbers by value, words as written."""
        if self.moment.document is self.opened.document:
            return []
        numbers = self.numbers
        changed_numbers = [
            path
            for path, key in numbers.items()
            if controls.is_changed(key, self.opened_values.get(path))
        ]
        words = (
            path
            for path in differing_paths(self.opened.document.root, self.moment.document.root)
            if path not in numbers
        )
        return [
            *changed_numbers,
            *(
                path
                for path in words
                if not any(
                    f"{number_path}.".startswith(f"{path}.")
                    for number_path in (*changed_numbers, *numbers)
                )
            ),
        ]

    @property
    def is_saved(self) -> bool:
        """Whether there is nothing that a save would write."""
        return self.moment.document is self.opened.document or not differing_paths(
            self.opened.document.root, self.moment.document.root
        )

    def values_at(self, paths: Iterable[str]) -> dict[str, dict[str, Any]]:
        """Numbers as they stand now, by path; of paths that are numbers."""
        numbers = self.numbers
        return {
            path: {
                "value": key.value,
                "text": self._text_of(path, key),
                "given": key.given,
                "is_default": not key.given,
                "changed": controls.is_changed(key, self.opened_values.get(path)),
            }
            for path in paths
            if (key := numbers.get(path)) is not None
        }

    def _text_of(self, path: str, key: Key) -> str:
        """Return the text of a number's box; text that cannot be read as a number stands as written."""
        written = controls.text_at(self.moment.document, path)
        if written and self.moment.faults and not _NUMBER.match(written):
            return written
        return controls.text_of_number(key, written)

    # -- changes ------------------------------------------------------------------------------------------------------

    def set(self, values: Mapping[str, Any], final: bool) -> None:
        """Put values in place of those of the design; a run of changes that are not final is undone with the final one.

        Raises
        ------
        DesignError
            Where the values fit nowhere: nothing is changed then. An unsound design is kept, with `moment.faults`.
        """
        document = self.moment.document
        for path, value in values.items():
            document = self._with(document, path, value, self.displayed_design)
        self._become(document)
        if final:
            self.settle()

    def put(self, path: str, value: Any) -> None:
        """Put any value at a path, as one step. Raises DesignError where it fits nowhere."""
        self._become(with_overrides(self.moment.document, [(path, value)]))
        self.settle()

    def settle(self) -> None:
        """Make what was changed since the last time one step to undo."""
        if self.moment.document is not self.settled:
            self.done.append(self.settled)
            del self.done[:-_MOST_UNDONE]
            self.undone.clear()
            self.settled = self.moment.document

    def undo(self) -> None:
        """Go back one step; at the first there is nothing to do."""
        self.settle()
        if self.done:
            self.undone.append(self.settled)
            self.settled = self.done.pop()
            self._become(self.settled)

    def redo(self) -> None:
        """Redo the step that was undone last."""
        if self.undone and self.moment.document is self.settled:
            self.done.append(self.settled)
            self.settled = self.undone.pop()
            self._become(self.settled)

    def reset(self, path: str) -> None:
        """Put back at a path what the design was opened with."""
        text = controls.text_at(self.opened.document, path)
        old = self.opened_values.get(path)
        values: list[tuple[str, object]] = [(path, text)]
        if text is None and old is not None and old.written_out and old.value is not None:
            above = old.written_out[0][0]  # the orientation that was written out for it
            values = (
                [(above, None)]
                if self._others_as_opened(path)
                else [(path, old.written(old.value))]
            )
        elif text is None:
            values = self._family(path)
        document = self.moment.document
        for override in values:
            document = with_overrides(document, [override])
        self._become(
            replace(
                document, root=_without_empty_mappings(document.root, self.opened.document.root)
            )
        )
        self.settle()

    def _family(self, path: str) -> list[tuple[str, object]]:
        """Return the values to put back where a path had none: of the path and of the keys that exclude it."""
        top, _, rest = path.partition(".")
        keys, opened_node = ALTERNATIVES.get(top, ()), self.opened.document.root.get(top)
        if rest.partition(".")[0] not in keys:
            return [(path, None)]
        if opened_node and not opened_node.is_mapping:
            return [(top, opened_node)]
        present = [(f"{top}.{key}", node) for key in keys if (node := opened_node.get(key))]
        return [*((f"{top}.{key}", None) for key in keys), *present]

    def restore(self, document: Document) -> None:
        """Put another tree in place of that of the design: one that was not saved in an earlier session."""
        self._become(document)
        self.settle()

    def saved(self, opened: Opened) -> None:
        """Take a design as saved: changes are compared with the file from now on, and can still be undone."""
        self.settle()
        self.opened, self.opened_values = opened, controls.values_of(opened.design)
        self.settled = opened.document
        self.moment = Moment(self.rev, opened.document, self.design, cases=opened.cases)

    def saved_of(self, snapshot: "Session", saved_moment: Moment) -> None:
        """Take a snapshot as saved, unless the design was changed or another was opened meanwhile."""
        if self.moment is saved_moment:
            self.saved(snapshot.opened)
        elif self.opened_rev == snapshot.opened_rev:
            self.opened, self.opened_values = snapshot.opened, snapshot.opened_values

    def snapshot(self) -> "Session":
        """Return a copy of the session as it is now, for a thread."""
        session = copy(self)
        session.done, session.undone = list(self.done), list(self.undone)
        return session

    def _others_as_opened(self, path: str) -> bool:
        above = path.rpartition(".")[0]
        numbers = self.numbers
        return all(
            not controls.is_changed(key, self.opened_values.get(other_path))
            for other_path, key in numbers.items()
            if other_path != path and other_path.rpartition(".")[0] == above
        )

    def _with(self, document: Document, path: str, value: Any, design: Design) -> Document:
        """The tree with one value put in; numbers as the design has them."""
        key = self.numbers.get(path)
        written_out: list[tuple[str, object]] = []
        if key is not None and key.written_out and value is not None:
            written_out += key.written_out
        if isinstance(value, int | float) and not isinstance(value, bool):
            value = controls.text_for_file(design, key, path, float(value))
        if isinstance(value, str) and len(value) > _LONGEST:
            raise DesignError(
                [Fault("E541", f"{path} has {len(value)} letters, {_LONGEST} are the most", path)]
            )
        if path == "title" and isinstance(value, str):
            return _titled(document, value)
        document, path = self._oriented(document, path, value)
        for override in (*written_out, (path, value)):
            document = with_overrides(document, [override])
        return document

    def _oriented(self, document: Document, path: str, value: Any) -> tuple[Document, str]:
        """Return the tree and the path at which an angle is set: `45/115` sets the whole plane."""
        above, _, angle = path.rpartition(".")
        node = document.root.find(above)
        if angle not in _ANGLES or node.text is None:
            return document, path
        if isinstance(value, str) and "/" in value:
            return document, above
        if node.text.count("/") != 1 and self.design.source is not None:
            last = self.design.source.root.find(above).text
            if last is not None:
                return with_overrides(document, [(above, last)]), path
        return document, path

    def _become(self, document: Document) -> None:
        self.rev += 1
        try:
            design = replace(design_of(document, other_values=True), source=document)
        except DesignError as error:
            self.moment = Moment(
                self.rev, document, self.moment.design, error.faults, self.opened.cases
            )
            return
        self.moment = Moment(self.rev, document, design, cases=self.opened.cases)


def opened_template(name: str) -> Opened:
    """A template as a design without a file of its own. Raises DesignError E197 for a name that is none."""
    path = templates.path_of(name)
    return opened_text(path.read_text(encoding="utf-8"), path.name)


def _titled(document: Document, text: str) -> Document:
    """The title is words, whatever they begin with."""
    place = Place("--set", 0, 0, cut(f"title={text}"))
    return with_overrides(document, [("title", Node(printable(text), place, "title", place))])


def differing_paths(left_node: Node, right_node: Node) -> list[str]:
    """The paths at which two trees differ, each as high up as one of them has nothing or a value of another shape.

    >>> from slopekit.design.reading.nodes import document_from
    >>> a, b = (document_from({"slope": {"height": h}, "water": "dry"}).root for h in (10, 12))
    >>> differing_paths(a, b)
    ['slope.height']
    """
    if left_node is right_node:
        return []
    if not left_node or not right_node:
        return [(left_node or right_node).path]
    if left_node.is_mapping and right_node.is_mapping:
        keys = dict.fromkeys(
            [*(key for key, _ in left_node.items()), *(key for key, _ in right_node.items())]
        )
        return [
            path
            for key in keys
            for path in differing_paths(left_node.get(key), right_node.get(key))
        ]
    if (
        isinstance(left_node.value, list)
        and isinstance(right_node.value, list)
        and len(left_node.value) == len(right_node.value)
    ):
        return [
            path
            for a, b in zip(left_node.value, right_node.value, strict=True)
            for path in differing_paths(a, b)
        ]
    return [] if left_node.plain() == right_node.plain() else [right_node.path or left_node.path]


def _without_empty_mappings(node: Node, opened_node: Node) -> Node:
    """A tree without mappings that hold nothing and were not there before."""
    if not node.is_mapping:
        return node
    children = {
        key: _without_empty_mappings(below, opened_node.get(key)) for key, below in node.items()
    }
    remaining = {
        key: below for key, below in children.items() if below.value != {} or opened_node.get(key)
    }
    return (
        node
        if all(remaining.get(key) is below for key, below in node.items())
        else replace(node, value=remaining)
    )
