"""YAML 1.2 to located nodes: the text of every scalar kept, whatever ruamel.yaml says of a slip in plain words."""

import re
from collections.abc import Callable
from types import SimpleNamespace
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
    fail_large,
    joined,
    no_text,
    printable,
)

_MAX_REPEATED = 50_000
NULLS = ("", "~", "null", "Null", "NULL")
LINE_END = re.compile(r"\r\n|\n|\r")
_PLAIN_TAGS = {
    f"tag:yaml.org,2002:{name}" for name in ("str", "int", "float", "bool", "null", "map", "seq", "timestamp", "value")
}
# what ruamel.yaml says, what that means to a user, what to type instead
_IN_WORDS = (
    (r"found character '\\t'", "a tab stands where YAML takes only spaces", "Indent with spaces."),
    (r"found character '(.)' that", "a value cannot start with {0}", "Put the value in quotes."),
    (r"mapping values are not", "a ':' where no key can stand", "Indent the keys of one level alike; put text that "
     "contains ': ' in quotes."),
    (r"unexpected end of stream", "a quote is opened here and never closed", "Close it."),
    (r"expected ',' or '([\]}])'", "a bracket is not closed, or a comma is missing", "Close it with {0}."),
    (r"expected the node content, but found '(.)'", "{0} stands where a value is needed", "Put text in quotes."),
    (r"could not find expected ':'", "a line that is no 'key: value'", "Put a colon and a space behind the key."),
    (r"expected '<document start>'", "text or a bracket stands behind the end of the design", "Indent the keys of one "
     "level alike."),
    (r"sequence entries are not", "a '- ' where no list can stand", "Begin the list on a line of its own."),
    (r"expected <block end>", "the indent does not fit the lines above", "Indent the keys of one level alike."),
    (r"found undefined alias '(.*)'", "*{0} stands for nothing, no &{0} comes before it", "Put text that starts "
     "with * in quotes."),
    (r"found unknown escape character '(.)'", "\\{0} means nothing inside double quotes", "Use single quotes."),
)  # fmt: skip


# lists of numbers, and lists of those, in one line: ruamel would make some twenty steps of every number
_NUMBER = r" *[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)? *"
_LIST = rf"\[{_NUMBER}(?:,{_NUMBER})*\]"
NUMBERS = re.compile(rf"(?<![^\s\[{{,:])(?:{_LIST}|\[ *{_LIST} *(?:, *{_LIST} *)*\])")
_TOKEN = re.compile(r"[\[\]]|[^\[\], ]+")
_STAND_IN = "\ue000"
_LARGE = 20_000


class SourceLines:
    """The lines of a file, for the places of its values."""

    def __init__(self, name: str, text: str) -> None:
        self.name, self.lines = printable(name), LINE_END.split(text)
        self.shown = -1, ""  # the line that places were asked of last, as they show it

    def place(self, line: int, column: int) -> Place:
        """The place of a line and a column, both from 0."""
        begin = 0 if column < WIDTH - 20 else column - WIDTH // 2
        if begin or line != self.shown[0]:
            text = self.lines[line] if line < len(self.lines) else ""
            part = cut(printable(("…" if begin else "") + text[begin : begin + 4 * WIDTH].strip()))
            if begin:
                return Place(self.name, line + 1, column + 1, part)
            self.shown = line, part
        return Place(self.name, line + 1, column + 1, self.shown[1])


def composed(text: str, source: SourceLines) -> Any:
    """ruamel's node tree; whatever it raises becomes a fault.

    In a large text each list of numbers goes through ruamel as one word of the same length, which `_numbers` then
    reads: ten thousand polygons take a second instead of ten. Where such a word turns up anywhere but as a value
    of its own, or anything is wrong, the text itself is read.
    """
    if len(text) > _LARGE and _STAND_IN not in text:
        try:
            return _composed(NUMBERS.sub(lambda match: _STAND_IN * len(match.group()), text), source, text)
        except _NotAlone:
            pass
        except DesignError as error:
            if error.codes == ("E149",):
                raise
    return _composed(text, source)


class _NotAlone(Exception):
    """The stand-in of a list of numbers is part of something else."""


def _like_ruamel(value: "str | list[SimpleNamespace]", at: SimpleNamespace) -> SimpleNamespace:
    """What the tree builder looks at in a node of ruamel's: a number, or a list."""
    return SimpleNamespace(value=value, start_mark=at, tag="tag:yaml.org,2002:str", anchor=None, style=None)


def _numbers(text: str, at: SimpleNamespace) -> SimpleNamespace:
    """A list of numbers (or of such lists) that stands in one line."""
    items: list[SimpleNamespace] = []
    above: list[list[SimpleNamespace]] = []
    holder = items
    for match in _TOKEN.finditer(text, 1):
        token = match.group()
        if token == "]":
            holder = above.pop() if above else items
            continue
        inner: list[SimpleNamespace] = []
        mark = SimpleNamespace(line=at.line, column=at.column + match.start())
        holder.append(_like_ruamel(inner if token == "[" else token, mark))
        if token == "[":
            above.append(holder)
            holder = inner
    return _like_ruamel(items, at)


def _composed(text: str, source: SourceLines, original: str = "") -> Any:
    from ruamel.yaml import YAML  # 18 ms, needed for files only
    from ruamel.yaml.composer import Composer
    from ruamel.yaml.error import MarkedYAMLError, YAMLError, YAMLStreamError

    class Counting(Composer):
        values = 0
        nesting = 0

        def compose_node(self, parent: Any, index: Any) -> Any:
            self.values += 1
            if self.values > MAX_VALUES or self.nesting >= MAX_DEPTH:
                mark = self.parser.peek_event().start_mark
                fail_large(source.place(mark.line, mark.column), deep=self.values <= MAX_VALUES)
            self.nesting += 1
            node = super().compose_node(parent, index)
            self.nesting -= 1
            return node

        def compose_scalar_node(self, anchor: Any) -> Any:
            node = super().compose_scalar_node(anchor)
            if not original or _STAND_IN not in node.value:
                return node
            mark = node.start_mark
            match = NUMBERS.match(original, mark.index)
            if match is None or node.style or anchor is not None or node.value != _STAND_IN * len(match.group()):
                raise _NotAlone
            self.values += match.group().count(",") + match.group().count("[")  # its numbers, and lists in it
            if self.values > MAX_VALUES:
                fail_large(source.place(mark.line, mark.column), deep=False)
            return _numbers(match.group(), SimpleNamespace(line=mark.line, column=mark.column))

    yaml = YAML(typ="safe", pure=True)
    yaml.Composer = Counting
    yaml.composer.warn_double_anchors = False
    try:
        return yaml.compose(text)
    except MarkedYAMLError as error:
        raise DesignError([_broken(error, source)]) from None
    except (YAMLError, YAMLStreamError, ValueError, OverflowError) as error:  # the last two of an escape: "\U00110000"
        message = f"broken YAML: {cut(printable(str(error) or type(error).__name__))}"
        raise DesignError([Fault("E150", message, str(source.place(0, 0)))]) from None


def _broken(error: Any, source: SourceLines) -> Fault:
    """A fault of ruamel's scanner or parser, in plain words."""
    problem = str(error.problem or error.context or "not understood")
    mark = error.problem_mark or error.context_mark
    if error.context == "expected a single document in the stream":
        place = source.place(mark.line, mark.column)
        message = f"a second design starts in line {place.line}, a file holds one"
        return Fault("E150", message, str(place), "Put each design in a file of its own.")
    if re.search("unexpected end of stream|could not find expected ':'", problem) and error.context_mark:
        mark = error.context_mark
    words, advice = printable(problem), ""
    for pattern, meaning, remedy in _IN_WORDS:
        match = re.search(pattern, problem)
        if match:
            words, advice = meaning.format(*match.groups()), remedy.format(*match.groups())
            break
    where = str(source.place(mark.line, mark.column)) if mark else source.name
    if error.context_mark and mark and error.context_mark.line != mark.line:
        advice = f"It belongs to what starts in line {error.context_mark.line + 1}. {advice}".rstrip()
    return Fault("E150", f"broken YAML: {cut(words)}", where, advice)


class TreeBuilder:
    """ruamel's nodes to ours, collecting faults; aliases are written out, each with its own path."""

    def __init__(self, place: Callable[[int, int], Place]) -> None:
        self.place = place
        self.faults: list[Fault] = []
        self.seen: set[int] = set()
        self.above: list[int] = []
        self.repeated = 0
        self.inside: Place | None = None  # the key that is being read: an alias in a list has no place of its own

    def build(self, item: Any, path: str, key_place: Place | None = None) -> Node:
        place = self.place(item.start_mark.line, item.start_mark.column)
        if id(item) in self.above:
            message = f"*{item.anchor} stands inside &{item.anchor}: {path or 'the file'} contains itself"
            raise DesignError([*self.faults, Fault("E150", message, str(self.inside or place))])
        self.repeated += id(item) in self.seen
        if self.repeated > _MAX_REPEATED:
            message = f"the aliases (*name) write out more than {_MAX_REPEATED} values"
            raise DesignError([*self.faults, Fault("E150", message, str(self.inside or place))])
        if len(self.above) >= MAX_DEPTH:
            fail_large(self.inside or place, deep=True)
        self.seen.add(id(item))
        tag = str(item.tag)
        if tag not in _PLAIN_TAGS:
            short = tag.replace("tag:yaml.org,2002:", "!!")
            message = f"{path or 'the file'} has the tag {cut(printable(short))}, a design has none"
            self.faults.append(
                Fault("E150", message, str(place), "Leave it out; put text that starts with ! in quotes.")
            )
        self.above.append(id(item))
        value: Value
        if isinstance(item.value, str):
            value = self.scalar(item, path, place)
            if value is None and key_place is not None:
                place = key_place  # ruamel puts the empty value at the next token
        elif item.value and isinstance(item.value[0], tuple):
            value = self.mapping(item, path)
        elif type(item).__name__ == "MappingNode":
            value = {}
        else:
            value = [self.build(part, joined(path, str(k))) for k, part in enumerate(item.value)]
        self.above.pop()
        return Node(value, place, path, key_place or place)

    def scalar(self, item: Any, path: str, place: Place) -> str | None:
        bad = no_text(item.value)
        if bad:
            message = f"{path or 'a value'} holds the character U+{ord(bad.group()):04X}, which is no text"
            self.faults.append(Fault("E159", message, str(place), "Leave out the escape that writes it."))
            return None
        text: str = item.value
        return None if not item.style and text in NULLS else text

    def mapping(self, item: Any, path: str) -> dict[str, Node]:
        entries: dict[str, Node] = {}
        for key, value in item.value:
            place = self.place(key.start_mark.line, key.start_mark.column)
            if not isinstance(key.value, str) or (not key.style and key.value in NULLS) or no_text(key.value):
                shown = "empty" if isinstance(key.value, str) else "a list or has keys of its own"
                advice = "A key is a name, then a colon and a space: phi: 20."
                self.faults.append(Fault("E150", f"a key {_under(path)}is {shown}", str(place), advice))
                continue
            name = key.value
            if name == "<<" and not key.style:
                message = f"<< {_under(path)}is a merge key of YAML 1.1, slopekit reads YAML 1.2"
                self.faults.append(Fault("E150", message, str(place), "Write the keys out."))
                continue
            if name in entries:
                lines = f"{entries[name].key_place.line} and {place.line}"
                message = f"{joined(path, name)} is given twice, in lines {lines}"
                if not place.line:
                    message = f"{joined(path, name)} is given twice"
                self.faults.append(Fault("E151", message, str(place), "Leave one of them out."))
                continue
            self.inside = place
            entries[name] = self.build(value, joined(path, name), place)
        return entries


def _under(path: str) -> str:
    return f"under {path} " if path else ""
