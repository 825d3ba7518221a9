"""Parsing YAML 1.2 into nodes with their places; scalars keep their text, errors of ruamel.yaml get plain messages."""

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from slopekit.core.errors import DesignError, Fault
from slopekit.design.reading.nodes import (
    MAX_DEPTH,
    MAX_VALUES,
    WIDTH,
    Node,
    Place,
    Value,
    cut,
    fail,
    fail_large,
    find_invalid_character,
    joined,
    printable,
)

_MAX_REPEATED = 50_000
NULLS = ("", "~", "null", "Null", "NULL")
LINE_END = re.compile(r"\r\n|\n|\r")
_PLAIN_TAGS = {
    f"tag:yaml.org,2002:{name}"
    for name in ("str", "int", "float", "bool", "null", "map", "seq", "timestamp", "value")
}
# pattern of ruamel.yaml's message, its meaning for a user, and advice
_PLAIN_MESSAGES = (
    (r"found character '\\t'", "a tab stands where YAML takes only spaces", "Indent with spaces."),
    (r"found character '(.)' that", "a value cannot start with {0}", "Put the value in quotes."),
    (
        r"mapping values are not",
        "a ':' where no key can stand",
        "Indent the keys of one level alike; put text that contains ': ' in quotes.",
    ),
    (r"unexpected end of stream", "a quote is opened here and never closed", "Close it."),
    (
        r"expected ',' or '([\]}])'",
        "a bracket is not closed, or a comma is missing",
        "Close it with {0}.",
    ),
    (
        r"expected the node content, but found '(.)'",
        "{0} stands where a value is needed",
        "Put text in quotes.",
    ),
    (
        r"could not find expected ':'",
        "a line that is no 'key: value'",
        "Put a colon and a space behind the key.",
    ),
    (
        r"expected '<document start>'",
        "text or a bracket stands behind the end of the design",
        "Indent the keys of one level alike.",
    ),
    (
        r"sequence entries are not",
        "a '- ' where no list can stand",
        "Begin the list on a line of its own.",
    ),
    (
        r"expected <block end>",
        "the indent does not fit the lines above",
        "Indent the keys of one level alike.",
    ),
    (
        r"found unknown escape character '(.)'",
        "\\{0} means nothing inside double quotes",
        "Use single quotes.",
    ),
)


def places_in(name: str, text: str) -> Callable[[int, int], Place]:
    """Return a function that gives the place of a line and a column of a file, both from 0."""
    shown_name, lines = printable(name), LINE_END.split(text)

    def place(line: int, column: int) -> Place:
        begin = 0 if column < WIDTH - 20 else column - WIDTH // 2
        written = lines[line] if line < len(lines) else ""
        excerpt = ("…" if begin else "") + written[begin : begin + 4 * WIDTH].strip()
        return Place(shown_name, line + 1, column + 1, cut(printable(excerpt)))

    return place


def tree_of(
    text: str, place: Callable[[int, int], Place], path: str = "", key_place: Place | None = None
) -> tuple[Node | None, list[Fault]]:
    """Return the tree of a YAML text (None if it is empty) and those faults that leave a usable tree.

    Parameters
    ----------
    place : gives the place of a line and a column, both from 0
    path, key_place : path and place of the key, where the text is a value of a design

    Raises
    ------
    DesignError
        E149 too many values, E150 broken YAML or values that contain themselves.
    """
    from ruamel.yaml import YAML  # 18 ms, needed for files only
    from ruamel.yaml.error import MarkedYAMLError, YAMLError, YAMLStreamError

    events = YAML(typ="safe", pure=True).parse(text)
    builder = _TreeBuilder(events, place)
    try:
        next(events)
        if _ends(next(events)):
            return None, []
        root = builder.node(next(events), path, key_place)
        next(events)
        end_event = next(events)
    except MarkedYAMLError as error:
        raise DesignError([_broken(error, place)]) from None
    except (
        YAMLError,
        YAMLStreamError,
        ValueError,
        OverflowError,
    ) as error:  # the last two are raised for an escape such as "\U00110000"
        message = f"broken YAML: {cut(printable(str(error) or type(error).__name__))}"
        raise DesignError([Fault("E150", message, str(place(0, 0)))]) from None
    if not _ends(end_event):
        mark = end_event.start_mark
        message = f"a second design starts in line {mark.line + 1}, a file holds one"
        fail(
            "E150",
            message,
            str(place(mark.line, mark.column)),
            "Put each design in a file of its own.",
        )
    return root, builder.faults


class _TreeBuilder:
    """Builds a tree from the events of ruamel's parser; aliases are expanded, each with its own path."""

    def __init__(self, events: Iterator[Any], place: Callable[[int, int], Place]) -> None:
        self.events, self.place = events, place
        self.faults: list[Fault] = []
        self.anchors: dict[str, Node | None] = {}  # None: its value is being read
        self.values = self.repeated = 0
        self.current_key: Place | None = None  # the key that is being read

    def node(self, event: Any, path: str, key_place: Place | None = None, depth: int = 0) -> Node:
        """Return the node of the value that begins with an event."""
        mark = event.start_mark
        place = self.place(mark.line, mark.column)
        self.values += 1
        if self.values > MAX_VALUES or depth >= MAX_DEPTH:
            fail_large(place, deep=self.values <= MAX_VALUES)
        kind = type(event).__name__
        if kind == "AliasEvent":
            if event.anchor not in self.anchors:
                message = (
                    "broken YAML: "
                    f"{cut(f'*{event.anchor} stands for nothing, no &{event.anchor} comes before it')}"
                )
                fail("E150", message, str(place), "Put text that starts with * in quotes.")
            return self.expand_alias(
                event.anchor, path, key_place, self.current_key or place, depth
            )
        if event.tag not in (None, "!", *_PLAIN_TAGS):
            short = event.tag.replace("tag:yaml.org,2002:", "!!")
            message = f"{path or 'the file'} has the tag {cut(printable(short))}, a design has none"
            advice = "Leave it out; put text that starts with ! in quotes."
            self.faults.append(Fault("E150", message, str(place), advice))
        if event.anchor is not None:
            self.anchors[event.anchor] = None
        value: Value
        if kind == "MappingStartEvent":
            value = self.mapping(path, depth + 1)
        elif kind == "SequenceStartEvent":
            value = []
            while not _ends(below := next(self.events)):
                value.append(self.node(below, joined(path, str(len(value))), None, depth + 1))
        else:
            value = self.scalar(event, path, place)
            if value is None and key_place is not None:
                place = key_place  # ruamel puts the empty value at the next token
        node = Node(value, place, path, key_place or place)
        if event.anchor is not None:
            self.anchors[event.anchor] = node
        return node

    def scalar(self, event: Any, path: str, place: Place) -> str | None:
        """Return the text of a scalar; None if it is empty."""
        text: str = event.value
        bad = find_invalid_character(text)
        if bad:
            message = f"{path or 'a value'} holds the character U+{ord(bad.group()):04X}, which is no text"
            self.faults.append(
                Fault("E159", message, str(place), "Leave out the escape that writes it.")
            )
        return None if bad or (not event.style and text in NULLS) else text

    def mapping(self, path: str, depth: int) -> dict[str, Node]:
        """Return keys with their nodes, up to the end of the group."""
        entries: dict[str, Node] = {}
        while not _ends(event := next(self.events)):
            faults_before = len(self.faults)
            key = self.node(event, path, None, depth)
            del self.faults[faults_before:]  # reported below as one fault of the key
            wrong = self.wrong_key(key, event, path, entries)
            self.faults += wrong
            self.current_key = key.place
            value = self.node(next(self.events), joined(path, key.text or ""), key.place, depth)
            if not wrong:
                entries[key.text or ""] = value
        return entries

    def wrong_key(
        self, key: Node, event: Any, path: str, entries: Mapping[str, Node]
    ) -> list[Fault]:
        """Return the faults of a key: no text, a merge key, or a duplicate of one in `entries`."""
        name, parent_text = key.text, f"under {path} " if path else ""
        if name is None:
            description = "empty" if key.value is None else "a list or has keys of its own"
            message, advice = (
                f"a key {parent_text}is {description}",
                "A key is a name, then a colon and a space: phi: 20.",
            )
            return [Fault("E150", message, str(key.place), advice)]
        if name == "<<" and not event.style:
            message = f"<< {parent_text}is a merge key of YAML 1.1, slopekit reads YAML 1.2"
            return [Fault("E150", message, str(key.place), "Write the keys out.")]
        if name in entries:
            lines = (
                f", in lines {entries[name].key_place.line} and {key.place.line}"
                if key.place.line
                else ""
            )
            message = f"{joined(path, name)} is given twice{lines}"
            return [Fault("E151", message, str(key.place), "Leave one of them out.")]
        return []

    def expand_alias(
        self, anchor: str, path: str, key_place: Place | None, place: Place, depth: int
    ) -> Node:
        """Return a copy of an anchor's node at the path of its alias."""
        node = self.anchors[anchor]
        if node is None:
            message = f"*{anchor} stands inside &{anchor}: {path or 'the file'} contains itself"
            raise DesignError([*self.faults, Fault("E150", message, str(place))])
        dots = [descendant.path.count(".") for descendant in node.walk()]
        self.repeated += len(dots)
        if self.repeated > _MAX_REPEATED:
            message = f"the aliases (*name) write out more than {_MAX_REPEATED} values"
            raise DesignError([*self.faults, Fault("E150", message, str(place))])
        if depth + max(dots) - dots[0] >= MAX_DEPTH:
            fail_large(place, deep=True)
        return replace(node.with_path(path), key_place=key_place or node.key_place)


def _ends(event: Any) -> bool:
    """Return whether an event ends a group of keys, a list or the text."""
    return type(event).__name__.endswith("EndEvent")


def _broken(error: Any, place: Callable[[int, int], Place]) -> Fault:
    """Return an error of ruamel's scanner or parser as a fault in plain words."""
    problem = str(error.problem or error.context or "not understood")
    mark = error.problem_mark or error.context_mark
    if (
        re.search("unexpected end of stream|could not find expected ':'", problem)
        and error.context_mark
    ):
        mark = error.context_mark
    words, advice = printable(problem), ""
    for pattern, meaning, remedy in _PLAIN_MESSAGES:
        match = re.search(pattern, problem)
        if match:
            words, advice = meaning.format(*match.groups()), remedy.format(*match.groups())
            break
    if error.context_mark and error.context_mark.line != mark.line:
        advice = (
            f"It belongs to what starts in line {error.context_mark.line + 1}. {advice}".rstrip()
        )
    return Fault("E150", f"broken YAML: {cut(words)}", str(place(mark.line, mark.column)), advice)
