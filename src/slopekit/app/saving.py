"""Saving: what changed is put into the text of the file, line by line, shown first, and written as it was shown.

ruamel says where each value stands in the text; only there it is touched: comments, quotes, order and line ends stay.
What was written is read again before it counts: it has to be the same design.

>>> from slopekit.app.session import opened_text
>>> text = "slopekit: 1  # version\\nkind: wedge\\njoints: {J1: {plane: 45/115}, J2: {plane: '45/245'}}\\n"
>>> from slopekit.app.session import Session
>>> session = Session(opened_text(text, "my.yaml"))
>>> session.set({"joints.J2.plane.dip": 50, "slope.height": "20 m"}, final=True)
>>> print(edited(session.opened, session.moment.document), end="")
slopekit: 1  # version
kind: wedge
joints: {J1: {plane: 45/115}, J2: {plane: '50/245'}}
slope: {height: 20 m}
"""

import difflib
import json
import os
import re
import secrets
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from slopekit.app.session import Opened, Session, digest_of, opened_text
from slopekit.core.errors import DesignError, Fault, writing
from slopekit.core.synonyms import synonym
from slopekit.core.whole_files import whole_file
from slopekit.design.reading.document import read_text
from slopekit.design.reading.nodes import Document, Node, cut, find_invalid_character, printable

_PLAIN = re.compile(r"[\w°.+\-/][\w°²³.+\-/%]*(?: [\w°²³.+\-/%]+)*")
_NOT_PLAIN = re.compile(r"(?:~|null|-+)", re.IGNORECASE)
_ENDINGS = (".yaml", ".yml")
_MOST_KEPT = 10
_BOM = b"\xef\xbb\xbf"
_Edit = tuple[int, int, str]


def edited(opened: Opened, document: Document) -> str:
    """The text of the file with what changed in it.

    Raises
    ------
    DesignError
        E547 where the text cannot be changed so that it reads as the design.
    """
    if document is opened.document:
        return opened.text
    from ruamel.yaml import YAML
    from ruamel.yaml.error import YAMLError

    yaml = YAML(typ="safe", pure=True)
    try:
        top = yaml.compose(opened.text)
        edits = list(_edits(_Text(opened.text), top, opened.document.root, document.root))
        text = _applied(opened.text, edits)
        reread, faults = read_text(text, opened.name, opened.path)
    except (YAMLError, DesignError, LookupError, ValueError, TypeError) as error:
        raise _save_error(cut(str(error).partition("\n")[0])) from None
    root = {key: node.plain() for key, node in reread.root.items() if key != "cases"}
    if faults or root != document.root.plain():
        raise _save_error("other lines would have to change")
    return text


def _save_error(reason: str) -> DesignError:
    advice = "Copy the design from Hand over, or save under another name."
    return DesignError(
        [Fault("E547", f"the change cannot be put into the text of the file: {reason}", "", advice)]
    )


class _Text:
    """The text of a file, where its lines begin and end."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.newline = "\r\n" if "\r\n" in text else "\n"

    def start_of_line(self, index: int) -> int:
        """The start of the line that holds an index."""
        return self.text.rfind("\n", 0, index) + 1

    def end_of_line(self, index: int) -> int:
        """The end of the line that holds an index, without its line break."""
        line_end = re.compile(r"\r?\n|\Z").search(self.text, index)
        assert line_end is not None
        return line_end.start()


def _edits(text: _Text, item: Any, old: Node, new: Node) -> Iterator[_Edit]:
    """Iterate over the replacements in the text that turn the value `old` at `item` into `new`."""
    if old is new or old.plain() == new.plain():
        return
    if old.is_mapping and new.is_mapping and type(item).__name__ == "MappingNode":
        yield from _mapping_edits(text, item, old, new)
    elif (
        isinstance(old.value, list)
        and isinstance(new.value, list)
        and len(old.value) == len(new.value) == len(item.value)
    ):
        for below, old_element, new_element in zip(item.value, old.value, new.value, strict=True):
            yield from _edits(text, below, old_element, new_element)
    elif old.text is not None and new.text is not None:
        yield (
            item.start_mark.index,
            item.end_mark.index,
            _scalar(new.text, getattr(item, "style", None)),
        )
    else:
        yield item.start_mark.index, _end(item), in_brackets(new)


def _mapping_edits(text: _Text, item: Any, old_node: Node, new_node: Node) -> Iterator[_Edit]:
    keys = [key for key, _ in old_node.items()]
    words = [str(key.value) for key, _ in item.value]
    pairs = {
        synonym(word, keys) or word: pair for word, pair in zip(words, item.value, strict=True)
    }
    flow = bool(item.flow_style)
    for key, old_value in old_node.items():
        new_value = new_node.get(key)
        if new_value:
            yield from _edits(text, pairs[key][1], old_value, new_value)
    removed = [key for key, _ in old_node.items() if not new_node.get(key)]
    added = [key for key, _ in new_node.items() if not old_node.get(key)]
    for replaced_key, other_key in zip(removed, added, strict=False):  # another key in its place
        key, value = pairs[replaced_key]
        yield key.start_mark.index, _end(value), _entry(other_key, new_node)
    removed, added = removed[len(added) :], added[len(removed) :]
    if removed:
        yield from _removals(text, item, pairs, removed, flow)
    if not added:
        return
    if flow and pairs:
        index = _end(item.value[-1][1])
        yield index, index, "".join(f", {_entry(key, new_node)}" for key in added)
    elif not pairs:
        yield (
            item.start_mark.index,
            _end(item),
            f"{{{', '.join(_entry(key, new_node) for key in added)}}}",
        )
    else:
        index = text.end_of_line(max(_end(value) for _, value in item.value))
        indent = " " * item.value[0][0].start_mark.column
        yield (
            index,
            index,
            "".join(f"{text.newline}{indent}{_entry(key, new_node)}" for key in added),
        )


def _removals(
    text: _Text, item: Any, pairs: dict[str, Any], gone: list[str], flow: bool
) -> Iterator[_Edit]:
    """Iterate over the replacements that remove keys from a mapping."""
    names = list(pairs)
    remaining = [name for name in names if name not in gone]
    if not remaining:
        yield item.start_mark.index, _end(item), "{}"
    elif not flow:
        for name in gone:
            key, value = pairs[name]
            end = text.end_of_line(_end(value))
            yield (
                text.start_of_line(key.start_mark.index),
                min(end + len(text.newline), len(text.text)),
                "",
            )
    else:
        first = names.index(remaining[0])
        if first:
            yield pairs[names[0]][0].start_mark.index, pairs[remaining[0]][0].start_mark.index, ""
        for name in gone:
            if names.index(name) > first:
                yield _end(pairs[names[names.index(name) - 1]][1]), _end(pairs[name][1]), ""


def _end(item: Any) -> int:
    """Return the index at which a value ends in the text: a block with its last value, without comments after it."""
    if isinstance(item.value, str) or item.flow_style or not item.value:
        return int(item.end_mark.index)
    last = item.value[-1]
    return _end(last[1] if isinstance(last, tuple) else last)


def _entry(key: str, holder: Node) -> str:
    return f"{_scalar(key)}: {in_brackets(holder.get(key))}"


def in_brackets(node: Node) -> str:
    """A value in one line, as brackets hold it."""
    if node.is_mapping:
        return f"{{{', '.join(_entry(key, node) for key, _ in node.items())}}}"
    if isinstance(node.value, list):
        return f"[{', '.join(in_brackets(below) for below in node.elements)}]"
    return "null" if node.text is None else _scalar(node.text)


def _scalar(text: str, style: str | None = None) -> str:
    """A text as YAML has it, in the quotes that stood there, in none where none are needed."""
    if style == "'" and "\n" not in text:
        return "'" + text.replace("'", "''") + "'"
    if style is None and _PLAIN.fullmatch(text) and not _NOT_PLAIN.fullmatch(text):
        return text
    return json.dumps(text, ensure_ascii=False)


def _applied(text: str, edits: list[_Edit]) -> str:
    pieces, position = list[str](), 0
    for start, end, new in sorted(edits, key=lambda edit: edit[:2]):
        if start < position:
            raise ValueError("two changes meet in one place")
        pieces += [text[position:start], new]
        position = end
    return "".join([*pieces, text[position:]])


# -- the difference ---------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class SavedChange:
    """The change that a save would write: file, text, difference from the opened text, number of new lines."""

    target: Path | None
    text: str
    diff: str
    lines: int
    changed_on_disk: bool


def change_of(session: Session, file: str | None = None) -> SavedChange:
    """Return the change that a save of a session would write.

    Parameters
    ----------
    file : to save to, the file that was opened where None

    Raises
    ------
    DesignError
        E547 where the design has faults, or its text cannot be changed; E141 for a file that is no design file.
    """
    if session.moment.faults:
        advice = "Put right what the page marks, or undo it."
        raise DesignError(
            [
                Fault("E547", "the design has faults: it is not saved", "", advice),
                *session.moment.faults,
            ]
        )
    opened = session.opened
    target = _target(file) if file else opened.path
    text = edited(opened, session.moment.document)
    name = opened.name if target is None else target.name
    lines = list(
        difflib.unified_diff(_lines(opened.text), _lines(text), opened.name, name, n=2, lineterm="")
    )
    new = sum(line.startswith("+") for line in lines[2:])
    changed_on_disk = (
        target is not None
        and _is_same_file(target, opened.path)
        and digest_of_file(target) != opened.digest
    )
    return SavedChange(target, text, "\n".join(lines), new, changed_on_disk)


def _lines(text: str) -> list[str]:
    """The lines of a text; that the last has no end is a line of its own, as everywhere."""
    lines = text.splitlines()
    return (
        lines
        if not text or text.endswith("\n")
        else [*lines[:-1], f"{lines[-1]}\n\\ No newline at end of file"]
    )


def _target(file: str) -> Path:
    try:
        path = Path(file).expanduser()
        is_name = find_invalid_character(file) is None
        path.exists()
    except (OSError, RuntimeError):  # a name that is too long; ~ of a user that there is not
        is_name = False
    if not is_name:
        name = cut(printable(file))
        raise DesignError(
            [Fault("E547", f"no file can be called {name}", name, "Name it like slope.yaml.")]
        )
    if path.suffix.lower() not in _ENDINGS:
        raise DesignError(
            [
                Fault(
                    "E547",
                    f"{cut(file)} does not end in .yaml",
                    cut(file),
                    "Name it like slope.yaml.",
                )
            ]
        )
    return path


def _is_same_file(path: Path, opened_path: Path | None) -> bool:
    return opened_path is not None and os.path.realpath(path) == os.path.realpath(opened_path)


def digest_of_file(path: Path) -> str:
    """SHA-256 of what is on the disk now; empty where nothing can be read."""
    try:
        return digest_of(path.read_bytes())
    except OSError:
        return ""


def save(session: Session, file: str | None, seen: str) -> Path:
    """Write what changed, as it was shown.

    Parameters
    ----------
    seen : the difference that the user has looked at

    Raises
    ------
    DesignError
        E545 where the file changed on the disk or `seen` is another difference, E547 without a file, or where
        there is one of that name already, E129 where it cannot be written.
    """
    change, opened = change_of(session, file), session.opened
    target = change.target
    if target is None:
        raise DesignError(
            [Fault("E547", "there is no file yet: give it a name", "", "For example slope.yaml.")]
        )
    is_opened_file = _is_same_file(target, opened.path)
    if change.changed_on_disk:
        advice = "Open it again, or save under another name."
        raise DesignError(
            [
                Fault(
                    "E545",
                    f"{target.name} changed on the disk since it was read",
                    str(target),
                    advice,
                )
            ]
        )
    if not is_opened_file and target.exists():
        raise DesignError(
            [Fault("E547", f"{target} is there already", str(target), "Give another name.")]
        )
    if seen != change.diff:
        raise DesignError(
            [
                Fault(
                    "E545",
                    "the change is another than the one that was shown",
                    "",
                    "Look at it again.",
                )
            ]
        )
    content = change.text.encode()
    if is_opened_file and target.read_bytes().startswith(_BOM):
        content = _BOM + content
    _write(target, content, new=not is_opened_file)
    session.saved(opened_text(change.text, target.name, target, digest_of(content)))
    return target


def _write(target: Path, content: bytes, new: bool) -> None:
    """Write a file whole or not at all; a new one never over another."""
    with writing(target):
        try:
            with whole_file(target, new) as file:
                file.write_bytes(content)
        except FileExistsError:
            raise DesignError([Fault("E547", f"{target} is there already", str(target))]) from None


# -- what is not saved yet --------------------------------------------------------------------------------------------


def state_folder() -> Path:
    """Return the folder of the user's state, by the rule of the operating system."""
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Application Support"
    else:
        configured = os.environ.get("XDG_STATE_HOME", "")
        base = Path(configured) if os.path.isabs(configured) else Path.home() / ".local" / "state"
    return base / "slopekit" / "unsaved"


class Autosave:
    """One design that is not saved, kept in the state folder until it is."""

    def __init__(self, folder: Path | None = None) -> None:
        self.folder = state_folder() if folder is None else folder
        self.number = secrets.token_hex(8)

    def begin(self) -> None:
        """Keep another design from now on; what was kept stays where it is."""
        self.number = secrets.token_hex(8)

    @property
    def file(self) -> Path:
        """The file of this autosave."""
        return self.folder / f"{self.number}.json"

    def keep(self, session: Session, file: Path | None = None) -> None:
        """Autosave a design, or remove its autosave where it is saved; a read-only folder is no reason to stop."""
        file = file or self.file
        try:
            if session.is_saved:
                file.unlink(missing_ok=True)
                return
            opened = session.opened
            record = {
                "title": session.design.title or opened.name,
                "when": time.strftime("%Y-%m-%d %H:%M"),
                "name": opened.name,
                "path": None if opened.path is None else str(opened.path.absolute()),
                "digest": opened.digest,
                "opened": opened.text,
                "text": edited(opened, session.moment.document),
            }
            self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            with whole_file(file) as fresh:
                fresh.write_text(json.dumps(record), encoding="utf-8")
            for old in self._all()[_MOST_KEPT:]:
                old.unlink(missing_ok=True)
        except (OSError, DesignError):
            return

    def _all(self) -> list[Path]:
        """Return the files of all autosaves, the newest first."""
        try:
            return sorted(
                self.folder.glob("*.json"), key=lambda path: path.stat().st_mtime, reverse=True
            )
        except OSError:
            return []

    def offered(self) -> dict[str, str] | None:
        """The newest of other sessions: its title, when it was, its number."""
        for path in self._all():
            record = self._read(path)
            if path.stem != self.number and record is not None:
                return {"title": record["title"], "when": record["when"], "id": path.stem}
        return None

    def restore(self, number: str, session: Session) -> None:
        """Restore an autosaved design into a session.

        Raises
        ------
        DesignError
            E548 where there is nothing of that number, and what `load` says of what is no design.
        """
        paths = {path.stem: path for path in self._all()}
        record = self._read(paths[number]) if number in paths else None
        if record is None:
            raise DesignError([Fault("E548", "nothing unsaved is kept under that number")])
        path = None if record["path"] is None else Path(record["path"])
        opened = opened_text(record["opened"], record["name"], path, record["digest"])
        document, _ = read_text(record["text"], record["name"], path)
        bare = {key: node for key, node in document.root.items() if key != "cases"}
        session.open(opened)
        session.restore(replace(document, root=replace(document.root, value=bare)))
        self.number = number

    @staticmethod
    def _read(path: Path) -> dict[str, Any] | None:
        try:
            record = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        texts = ("title", "when", "name", "digest", "opened", "text")
        sound = isinstance(record, dict) and all(isinstance(record.get(key), str) for key in texts)
        return record if sound and isinstance(record.get("path"), str | None) else None
