"""A design file as located nodes: every value knows its dotted path and the line and column it stands at.

YAML 1.2, read as text: scalars keep what the user wrote, so that 045 stays 045 and no number is rounded here.
"""

import os
import re
from collections.abc import Callable, ItemsView, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from difflib import get_close_matches
from numbers import Real
from pathlib import Path
from typing import Any, NoReturn, TypeAlias

from slopekit.errors import DesignError, Fault
from slopekit.orientation import Line, Plane

Value: TypeAlias = "dict[str, Node] | list[Node] | str | None"
Plain: TypeAlias = "dict[str, Plain] | list[Plain] | str | None"
Exclusive: TypeAlias = Mapping[str, Sequence[str]]

#: Keys that exclude each other: a `--set` of one drops the others of the file.
ALTERNATIVES: Exclusive = {
    "water": ("mode", "fill", "pressures"),
    "rock": ("density", "unit_weight"),
    "crack": ("depth", "distance"),
}
MAX_BYTES = 5_000_000
_MAX_VALUES = 100_000
_MAX_REPEATED = 50_000
_MAX_DEPTH = 100
_WIDTH = 80
_NULLS = ("", "~", "null", "Null", "NULL")
_LINE_END = re.compile(r"\r\n|\n|\r")
_NO_TEXT = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x84\x86-\x9f\ud800-\udfff\ufffe\uffff]")
_PLAIN_TAGS = {
    f"tag:yaml.org,2002:{name}" for name in ("str", "int", "float", "bool", "null", "map", "seq", "timestamp", "value")
}
_DOTTED_KEYS = ("correlation",)  # the keys of these mappings are names with dots: J1.phi/J2.phi
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


@dataclass(frozen=True, slots=True)
class Place:
    """Where something was written; `line` 0 is a value from `--set` or from Python.

    >>> print(Place("north-wall.yaml", 6, 8, "J1: {plane: 95/115, strength: weak}"))
    north-wall.yaml:6:8  J1: {plane: 95/115, strength: weak}
    >>> print(Place("--set", 0, 0, "strength.weak.phi=25"))
    --set strength.weak.phi=25
    """

    file: str
    line: int
    column: int
    source: str

    def __str__(self) -> str:
        if self.line:
            return f"{self.file}:{self.line}:{self.column}  {self.source}".rstrip()
        return f"{self.file}{' ' if self.is_set else ': '}{self.source}"

    @property
    def is_set(self) -> bool:
        """Whether the value came by `--set`."""
        return not self.line and self.file == "--set"


@dataclass(frozen=True, slots=True)
class Node:
    """A value of a design: keys with nodes, a list of nodes, the text as written, or None where nothing was written.

    `place` is where the value begins, `key_place` where its key stands (for a list item, the item itself).
    """

    value: Value
    place: Place
    path: str
    key_place: Place

    @property
    def is_mapping(self) -> bool:
        """Whether the value has keys."""
        return isinstance(self.value, dict)

    @property
    def name(self) -> str:
        """The last part of the path: the key, or the index in a list."""
        return self.path.rpartition(".")[2]

    @property
    def text(self) -> str | None:
        """The text of a scalar; None for anything else."""
        return self.value if isinstance(self.value, str) else None

    @property
    def elements(self) -> tuple["Node", ...]:
        """The items of a list; nothing for anything else."""
        return tuple(self.value) if isinstance(self.value, list) else ()

    def get(self, key: str) -> "Node | None":
        """The node of a key, None where there is none or where the value has no keys."""
        return self.value.get(key) if isinstance(self.value, dict) else None

    def items(self) -> "ItemsView[str, Node]":
        """Keys and their nodes, in the order of the file; nothing where the value has no keys."""
        return (self.value if isinstance(self.value, dict) else {}).items()

    def plain(self) -> Plain:
        """The value as dicts, lists, texts and None.

        >>> document_from({"slope": {"height": 64.89, "face": (60, 180)}}).root.plain()
        {'slope': {'height': '64.89', 'face': ['60', '180']}}
        """
        if isinstance(self.value, dict):
            return {key: node.plain() for key, node in self.value.items()}
        if isinstance(self.value, list):
            return [node.plain() for node in self.value]
        return self.value


@dataclass(frozen=True, slots=True)
class Document:
    """A design as it was written: its tree, its name, and its file where it came from one."""

    root: Node
    name: str
    path: Path | None = None


def load_document(
    path: str | os.PathLike[str],
    overrides: Sequence[tuple[str, object]] = (),
    alternatives: Exclusive = ALTERNATIVES,
) -> Document:
    """Read a design file and put the overrides in.

    Parameters
    ----------
    path : the file
    overrides : dotted path and value, as `with_overrides` takes them
    alternatives : keys that exclude each other, by the path of their mapping

    Raises
    ------
    DesignError
        E147 to E149 and E159 for the file, E150 to E158 for its YAML, E160 to E163 for the overrides: every fault
        that could be found.
    """
    file = Path(path)
    text = _decoded(read_bytes(path), file.name)
    source = _Source(file.name, text)
    builder = _Builder(source.place)
    top = _composed(text, source)
    start = source.place(0, 0)
    if top is None:
        _fail(
            "E156", f"{file.name} is empty", str(path), "slopekit templates show wedge prints a design to start from."
        )
    root = builder.build(top, "", start)
    if root.value is None and not builder.faults:
        _fail("E156", f"{file.name} holds no design", str(start), "slopekit templates show wedge prints a design.")
    if not root.is_mapping and not builder.faults:
        shown = "a list" if isinstance(root.value, list) else f"the text {_cut(repr(root.value))}"
        advice = "A design starts with keys: slopekit: 1, then kind: wedge."
        _fail("E157", f"{file.name} holds {shown}, not keys with values", str(root.place), advice)
    document = Document(root, file.name, file)
    faults = builder.faults
    try:
        document = with_overrides(document, overrides, alternatives)
    except DesignError as error:
        faults += error.faults
    if faults:
        raise DesignError(dict.fromkeys(faults))
    return document


def document_from(mapping: Mapping[str, Any], name: str = "design") -> Document:
    """The tree of a Python mapping, the same as its YAML would give; None means not given.

    Raises
    ------
    DesignError
        E163 for a value that no design file could hold, E154 for a mapping that contains itself.

    >>> print(document_from({"strength": {"weak": {"phi": 25}}}).root.get("strength").get("weak").get("phi").place)
    design: strength.weak.phi = 25
    """
    faults: list[Fault] = []
    root = _from_python(mapping, "", lambda path, value: _python_place(name, path, value), faults)
    if not root.is_mapping and not faults:
        faults.append(Fault("E157", f"{name} is {type(mapping).__name__}, not keys with values", name))
    if faults:
        raise DesignError(faults)
    return Document(root, name)


def parse_override(text: str) -> tuple[str, str]:
    """Split what follows `--set` into its dotted path and its value.

    Raises
    ------
    DesignError
        E160 without an equals sign or without a path.

    >>> parse_override("strength.weak.phi=25")
    ('strength.weak.phi', '25')
    """
    path, equals, value = text.partition("=")
    if not equals or not path.strip():
        advice = "Write --set key=value, for example --set strength.weak.phi=25."
        _fail("E160", f"--set {_cut(text)} is not key=value", f"--set {_cut(text)}", advice)
    return path.strip(), value.strip()


def with_overrides(
    document: Document, overrides: Sequence[tuple[str, object]], alternatives: Exclusive = ALTERNATIVES
) -> Document:
    """A copy of the document with some values replaced.

    Parameters
    ----------
    overrides : dotted path (list items by their number from 0) and value: text is read as YAML reads it inside
        brackets, other Python values as `document_from` takes them; null or None removes the key
    alternatives : keys that exclude each other: setting one drops the others, unless they were set as well

    Raises
    ------
    DesignError
        E151 a path set twice, E160 not a path or broken YAML, E161 a path through a value, E162 no such list item.

    >>> design = document_from({"water": {"mode": "full"}, "support": {"bolts": [{"force": "200 kN"}]}})
    >>> changed = with_overrides(design, [("water.fill", "50 %"), ("support.bolts.0.acts", "passive")])
    >>> changed.root.plain()
    {'water': {'fill': '50 %'}, 'support': {'bolts': [{'force': '200 kN', 'acts': 'passive'}]}}
    """
    root, faults, seen = document.root, list[Fault](), set[str]()
    for path, value in overrides:
        shown = value if isinstance(value, str) else _shown(value)
        place = Place("--set", 0, 0, _cut(f"{path}={shown}"))
        if path in seen:
            faults.append(Fault("E151", f"{path} is set twice", str(place), "Leave one of them out."))
            continue
        seen.add(path)
        try:
            parts = _parts(path, place)
            new = _override_value(value, path, place)
            root = _replaced(root, parts, new if new.value is not None else None, place)
        except DesignError as error:
            faults += error.faults
            continue
        if new.value is not None:
            root = _without_alternatives(root, path, alternatives)
    if faults:
        raise DesignError(faults)
    return replace(document, root=root)


# -- the file ---------------------------------------------------------------------------------------------------------


def read_bytes(path: str | os.PathLike[str]) -> bytes:
    """The bytes of a file of at most `MAX_BYTES`.

    Raises
    ------
    DesignError
        E147 no such file (with the nearest name), E148 a folder or unreadable, E149 too large.
    """
    shown, name = _cut(_printable(str(path))), _cut(_printable(Path(path).name or str(path)))
    try:
        with open(path, "rb") as file:
            content = file.read(MAX_BYTES + 1)
    except (FileNotFoundError, NotADirectoryError, ValueError):  # ValueError: a NUL or a surrogate in the name
        raise DesignError([Fault("E147", f"{name} does not exist", shown, _nearest_file(Path(path)))]) from None
    except IsADirectoryError:
        inside = sorted(name for name in _names_in(Path(path)) if name.endswith((".yaml", ".yml", ".csv")))[:5]
        advice = f"It holds {', '.join(inside)}." if inside else ""
        raise DesignError([Fault("E148", f"{name} is a folder, a file is needed", shown, advice)]) from None
    except OSError as error:
        message = f"{name} cannot be read: {(error.strerror or 'the system refuses').lower()}"
        raise DesignError([Fault("E148", message, shown)]) from None
    if len(content) > MAX_BYTES:
        message = f"{name} is larger than {MAX_BYTES / 1e6:g} MB, that is no design or joint list"
        _fail("E149", message, shown, "Meshes stand in files of their own: mesh: slip.stl.")
    return content


def _names_in(folder: Path) -> list[str]:
    with suppress(OSError, ValueError):
        return os.listdir(folder)
    return []


def _nearest_file(path: Path) -> str:
    with suppress(OSError, ValueError):
        if not path.parent.is_dir():
            return f"There is no folder {_printable(str(path.parent))}."
    names = {name.lower(): name for name in sorted(_names_in(path.parent))}
    near = get_close_matches(path.name.lower(), names, n=1) or [
        name for name in names if name.startswith(path.name.lower() + ".")
    ]
    return f"Did you mean {_printable(str(path.parent / names[near[0]]))}?" if near else ""


def _decoded(content: bytes, name: str) -> str:
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        _fail("E159", f"{name} is UTF-16, a design file is UTF-8", name, "Save it again as UTF-8.")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        message = f"line {line} of {name} is not UTF-8 (byte 0x{content[error.start]:02x})"
        _fail("E159", message, f"{name}:{line}", "Save it again as UTF-8: ° and φ are written in two bytes there.")
    bad = _NO_TEXT.search(text)
    if bad:
        line = len(_LINE_END.findall(text, 0, bad.start())) + 1
        message = f"line {line} of {name} holds the character U+{ord(bad.group()):04X}, which is no text"
        _fail("E159", message, f"{name}:{line}", "Is this a design file? Save it again as UTF-8 text.")
    return text


class _Source:
    """The lines of a file, for the places of its values."""

    def __init__(self, name: str, text: str) -> None:
        self.name, self.lines = _printable(name), _LINE_END.split(text)

    def place(self, line: int, column: int) -> Place:
        """The place of a line and a column, both from 0."""
        text = self.lines[line] if line < len(self.lines) else ""
        begin = 0 if column < _WIDTH - 20 else column - _WIDTH // 2
        part = ("…" if begin else "") + text[begin : begin + 4 * _WIDTH].strip()
        return Place(self.name, line + 1, column + 1, _cut(_printable(part)))


# -- YAML -------------------------------------------------------------------------------------------------------------


def _composed(text: str, source: _Source) -> Any:
    """ruamel's node tree; whatever it raises becomes a fault."""
    from ruamel.yaml import YAML  # 18 ms, needed for files only
    from ruamel.yaml.composer import Composer
    from ruamel.yaml.error import MarkedYAMLError, YAMLError, YAMLStreamError

    class Counting(Composer):
        values = 0

        def compose_node(self, parent: Any, index: Any) -> Any:
            self.values += 1
            if self.values > _MAX_VALUES or self.depth >= _MAX_DEPTH:
                mark = self.parser.peek_event().start_mark
                _fail_large(source.place(mark.line, mark.column), deep=self.values <= _MAX_VALUES)
            return super().compose_node(parent, index)

    yaml = YAML(typ="safe", pure=True)
    yaml.Composer = Counting
    yaml.composer.warn_double_anchors = False
    try:
        return yaml.compose(text)
    except MarkedYAMLError as error:
        raise DesignError([_broken(error, source)]) from None
    except (
        YAMLError, YAMLStreamError, ArithmeticError, AssertionError, AttributeError, LookupError, RuntimeError,
        TypeError, ValueError,
    ) as error:  # fmt: skip
        line = getattr(getattr(yaml, "_reader", None), "line", 0)
        message = f"broken YAML: {_cut(_printable(str(error) or type(error).__name__))}"
        raise DesignError([Fault("E150", message, str(source.place(line, 0)))]) from None


def _fail_large(place: Place, deep: bool) -> NoReturn:
    if deep:
        _fail("E149", f"values are nested more than {_MAX_DEPTH} deep", str(place), "Is there a bracket left open?")
    advice = "Large meshes stand in files of their own: mesh: slip.stl."
    _fail("E149", f"there are more than {_MAX_VALUES} values", str(place), advice)


def _broken(error: Any, source: _Source) -> Fault:
    """A fault of ruamel's scanner or parser, in plain words."""
    problem = str(error.problem or error.context or "not understood")
    mark = error.problem_mark or error.context_mark
    if error.context == "expected a single document in the stream":
        place = source.place(mark.line, mark.column)
        message = f"a second design starts in line {place.line}, a file holds one"
        return Fault("E155", message, str(place), "Put each design in a file of its own.")
    if re.search("unexpected end of stream|could not find expected ':'", problem) and error.context_mark:
        mark = error.context_mark
    words, advice = _printable(problem), ""
    for pattern, meaning, remedy in _IN_WORDS:
        match = re.search(pattern, problem)
        if match:
            words, advice = meaning.format(*match.groups()), remedy.format(*match.groups())
            break
    where = str(source.place(mark.line, mark.column)) if mark else source.name
    if error.context_mark and mark and error.context_mark.line != mark.line:
        advice = f"It belongs to what starts in line {error.context_mark.line + 1}. {advice}".rstrip()
    return Fault("E150", f"broken YAML: {_cut(words)}", where, advice)


class _Builder:
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
            raise DesignError([*self.faults, Fault("E154", message, str(self.inside or place))])
        self.repeated += id(item) in self.seen
        if self.repeated > _MAX_REPEATED:
            message = f"the aliases (*name) write out more than {_MAX_REPEATED} values"
            raise DesignError([*self.faults, Fault("E154", message, str(self.inside or place))])
        if len(self.above) >= _MAX_DEPTH:
            _fail_large(self.inside or place, deep=True)
        self.seen.add(id(item))
        tag = str(item.tag)
        if tag not in _PLAIN_TAGS:
            short = tag.replace("tag:yaml.org,2002:", "!!")
            message = f"{path or 'the file'} has the tag {_cut(_printable(short))}, a design has none"
            self.faults.append(
                Fault("E153", message, str(place), "Leave it out; put text that starts with ! in quotes.")
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
            value = [self.build(part, _joined(path, str(k))) for k, part in enumerate(item.value)]
        self.above.pop()
        return Node(value, place, path, key_place or place)

    def scalar(self, item: Any, path: str, place: Place) -> str | None:
        bad = _NO_TEXT.search(item.value)
        if bad:
            message = f"{path or 'a value'} holds the character U+{ord(bad.group()):04X}, which is no text"
            self.faults.append(Fault("E159", message, str(place), "Leave out the escape that writes it."))
            return None
        text: str = item.value
        return None if not item.style and text in _NULLS else text

    def mapping(self, item: Any, path: str) -> dict[str, Node]:
        entries: dict[str, Node] = {}
        for key, value in item.value:
            place = self.place(key.start_mark.line, key.start_mark.column)
            if not isinstance(key.value, str) or (not key.style and key.value in _NULLS) or _NO_TEXT.search(key.value):
                shown = "empty" if isinstance(key.value, str) else "a list or has keys of its own"
                advice = "A key is a name, then a colon and a space: phi: 20."
                self.faults.append(Fault("E158", f"a key {_under(path)}is {shown}", str(place), advice))
                continue
            name = key.value
            if name == "<<" and not key.style:
                message = f"<< {_under(path)}is a merge key of YAML 1.1, slopekit reads YAML 1.2"
                self.faults.append(Fault("E152", message, str(place), "Write the keys out."))
                continue
            if name in entries:
                lines = f"{entries[name].key_place.line} and {place.line}"
                message = f"{_joined(path, name)} is given twice, in lines {lines}"
                if not place.line:
                    message = f"{_joined(path, name)} is given twice"
                self.faults.append(Fault("E151", message, str(place), "Leave one of them out."))
                continue
            self.inside = place
            entries[name] = self.build(value, _joined(path, name), place)
        return entries


def _joined(path: str, name: str) -> str:
    return f"{path}.{name}" if path else name


def _under(path: str) -> str:
    return f"under {path} " if path else ""


# -- values from Python and from --set --------------------------------------------------------------------------------


def _from_python(
    value: Any, path: str, place_of: Callable[[str, Any], Place], faults: list[Fault], above: tuple[int, ...] = ()
) -> Node:
    place = place_of(path, value)
    made: Value = None
    if id(value) in above:
        faults.append(Fault("E154", f"{path or 'the design'} contains itself", str(place)))
    elif len(above) > _MAX_DEPTH:
        _fail_large(place, deep=True)
    elif hasattr(value, "tolist") and hasattr(value, "dtype"):
        return _from_python(value.tolist(), path, place_of, faults, above)
    elif isinstance(value, Mapping):
        made = {}
        for key, part in value.items():
            if part is None:
                continue
            name = str(key)
            if name in made:
                faults.append(Fault("E151", f"{_joined(path, name)} is given twice", str(place)))
            made[name] = _from_python(part, _joined(path, name), place_of, faults, (*above, id(value)))
    elif isinstance(value, list | tuple):
        made = [
            _from_python(part, _joined(path, str(k)), place_of, faults, (*above, id(value)))
            for k, part in enumerate(value)
        ]
    elif value is not None:
        made = _text_of(value)
        if made is None or _NO_TEXT.search(made):
            shown = f"of the type {type(value).__name__}" if made is None else repr(made)
            advice = "Give numbers, texts, lists and dicts."
            faults.append(Fault("E163", f"{path or 'the value'} is {shown}, no design holds that", str(place), advice))
    return Node(made, place, path, place)


def _text_of(value: object) -> str | None:
    """What a design file would have for this value; None where it could have nothing."""
    if isinstance(value, str):
        return str(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, Plane):
        return f"{value.dip_deg!r}/{value.dip_direction_deg!r}"
    if isinstance(value, Line):
        return f"{value.trend_deg!r}/{value.plunge_deg!r}"
    if isinstance(value, os.PathLike):
        path = os.fspath(value)
        return path if isinstance(path, str) else None
    if isinstance(value, int):
        return str(value) if value.bit_length() < 1024 else ("inf" if value > 0 else "-inf")
    if isinstance(value, Real):
        return repr(float(value))
    return None


def _python_place(name: str, path: str, value: object) -> Place:
    return Place(name, 0, 0, _cut(f"{path} = {_shown(value)}" if path else _shown(value)))


def _shown(value: object) -> str:
    if isinstance(value, Mapping):
        return f"{{{_cut(', '.join(f'{key}: …' for key in list(value)[:9]))}}}"
    if isinstance(value, list | tuple):
        return f"a list of {len(value)}"
    text = _text_of(value)
    return _printable(text) if text is not None else f"a {type(value).__name__}"


def _override_value(value: object, path: str, place: Place) -> Node:
    faults: list[Fault] = []
    if not isinstance(value, str):
        node = _from_python(value, path, lambda _path, _value: place, faults)
    elif value.lstrip()[:1] in ("[", "{", "'", '"'):
        try:
            item = _composed(value.strip(), _Source("--set", value.strip()))
        except DesignError as error:
            fault = error.faults[0]
            message = f"the value of --set {path} is {fault.message}"
            raise DesignError([Fault("E160", message, str(place), fault.advice)]) from None
        builder = _Builder(lambda _line, _column: place)
        node, faults = builder.build(item, path, place), builder.faults
    else:
        text = value.strip()
        if _NO_TEXT.search(text):
            _fail("E160", f"the value of --set {path} is no text", _printable(str(place)))
        node = Node(None if text in _NULLS else text, place, path, place)
    if faults:
        raise DesignError(faults)
    return node


def _parts(path: str, place: Place) -> list[str]:
    parts = path.split(".")
    if not all(part.strip() for part in parts) or _NO_TEXT.search(path):
        advice = "Write --set key=value, for example --set strength.weak.phi=25."
        _fail("E160", f"{_cut(_printable(path))!r} is no path to a key", _printable(str(place)), advice)
    if len(parts) > _MAX_DEPTH:
        _fail_large(place, deep=True)
    if parts[0] in _DOTTED_KEYS and len(parts) > 2:
        parts[1:] = [".".join(parts[1:])]
    return parts


def _replaced(node: Node, parts: list[str], new: Node | None, place: Place) -> Node:
    """A copy of `node` with the value at `parts` replaced, or removed where `new` is None."""
    if isinstance(node.value, list):
        return replace(node, value=_replaced_item(node, node.value, parts, new, place))
    if isinstance(node.value, str):
        message = f"{node.path} is the value {_cut(node.value)}, it has no {parts[0]}"
        _fail("E161", message, str(place), f"Set it as a whole: --set {node.path}=…")
    entries = dict(node.value or {})
    key = parts[0]
    if len(parts) == 1:
        if new is None:
            entries.pop(key, None)
        else:
            old = entries.get(key)
            entries[key] = new if old is None else replace(new, path=old.path)
    else:
        path = _joined(node.path, key)
        below = entries.get(key) or Node(None, place, path, place)
        if new is None and below.value is None:
            return node
        entries[key] = _replaced(below, parts[1:], new, place)
    return replace(node, value=entries)


def _replaced_item(node: Node, items: list[Node], parts: list[str], new: Node | None, place: Place) -> list[Node]:
    if not re.fullmatch(r"[0-9]{1,9}", parts[0]):
        message = f"{node.path} is a list, {parts[0]} is no number of an item"
        _fail("E162", message, str(place), f"Its items are {node.path}.0 to {node.path}.{max(len(items) - 1, 0)}.")
    index = int(parts[0])
    if index >= len(items):
        items_are = f"Its items are {node.path}.0 to {node.path}.{len(items) - 1}." if items else "It is empty."
        _fail("E162", f"{node.path} has {len(items)} items, there is no item {index}", str(place), items_are)
    copy = list(items)
    if len(parts) > 1:
        copy[index] = _replaced(items[index], parts[1:], new, place)
    elif new is None:
        advice = f"Set the whole list: --set {node.path}=[…]"
        _fail("E162", f"{node.path}.{index} cannot be taken out of its list", str(place), advice)
    else:
        copy[index] = new
    return copy


def _without_alternatives(root: Node, path: str, alternatives: Exclusive) -> Node:
    for parent, keys in alternatives.items():
        given = next((key for key in keys if f"{path}.".startswith(f"{parent}.{key}.")), None)
        if given is None:
            continue
        above: Node | None = root
        for part in parent.split("."):
            above = above.get(part) if above else None
        for key in keys:
            other = above.get(key) if above else None
            if key != given and other is not None and not other.key_place.is_set and not _holds_set(other):
                root = _replaced(root, [*parent.split("."), key], None, other.place)
    return root


def _holds_set(node: Node) -> bool:
    parts = node.elements or [part for _, part in node.items()]
    return node.place.is_set or any(_holds_set(part) for part in parts)


# -- small things -----------------------------------------------------------------------------------------------------


def _cut(text: str) -> str:
    return text if len(text) <= _WIDTH else text[: _WIDTH - 1].rstrip() + "…"


def _printable(text: str) -> str:
    return text if text.isprintable() else "".join(c if c.isprintable() else " " if c.isspace() else "�" for c in text)


def _fail(code: str, message: str, where: str = "", advice: str = "") -> NoReturn:
    raise DesignError([Fault(code, message, where, advice)])
