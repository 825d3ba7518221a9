"""Stored answers as text: one line a value, compared number by number and word by word.

A document is written out as ``path = value`` lines, so that a line of `git diff` says by itself which key of which case
changed. Times and versions are left out or written as #. Long lists and packed arrays stand as a digest: how many,
least, greatest, sum and a sum with weights, by which their order counts; words by how often each occurs and a checksum.

Numbers are the same within `RELATIVE` of the greatest of their list, or within what `LOOSER` gives for their key, with
the reason: these are what another processor's matrix routines and vector units change (OPENBLAS_CORETYPE=Prescott and
NPY_DISABLE_CPU_FEATURES of all AVX against none of both), with room. In sheets only numbers of ten digits and more have
a tolerance: a rounded digit that turns is shown.
"""

import base64
import hashlib
import json
import math
import re
import zlib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from typing import Any

import numpy as np

RELATIVE = 1e-9
#: Case and key, relative and absolute tolerance, why; the first that fits counts.
LOOSER: tuple[tuple[re.Pattern[str], float, float, str], ...] = tuple(
    (re.compile(pattern), relative, absolute, why)
    for pattern, relative, absolute, why in (
        (
            r"balance\.(force|moment|pull|friction_excess)$",
            RELATIVE,
            1e-7,
            "parts of the load, left by the solvers",
        ),
        (
            r"(residual|mesh_change|_error|plane_error_m|largest_unbalanced_force)$",
            RELATIVE,
            1e-8,
            "left by rounding",
        ),
        (
            r"(difference|error|misses_by|findings\.\d+\.value)$",
            RELATIVE,
            1e-8,
            "two numbers that are nearly one",
        ),
        (r"orders$", 1e-6, 0.0, "of errors that are small themselves"),
        (
            r"(displacement_m|rotation_rad)$",
            RELATIVE,
            1e-14,
            "metres and radians of a bed: 0 of a symmetric slope",
        ),
        (
            r"^(\w+/)\S*(wall|blocks|bench|topple|goodman)\S* (mechanism|assembly|scene\.velocity)",
            1e-6,
            1e-6,
            "many blocks: the motion stops changing, it is not solved for",
        ),
        (
            r"(rotation|scene\.velocity)$",
            RELATIVE,
            1e-10,
            "of a motion of length 1: 0 where a block slides",
        ),
        (
            r"^(\w+/)\S*(bench|surface|ellipsoid|sphere|cylinder)\S* .*(static_bound|fos\.highest|ladder\.\d+\.fos)$",
            1e-6,
            0.0,
            "of a conic program, solved to 1e-6",
        ),
        (
            r"^designs/rich-wedge (forces_kn|scene\.pairs)",
            1e-7,
            0.0,
            "tractions of an iterated bed",
        ),
        (
            r"model\.passes$",
            0.25,
            3.0,
            "steps of a search: compiled kernels and NumPy round differently",
        ),
    )
)
RESIDUE = 1e-7  # a number of a sheet below this is rounding
LONG_LIST, LONG_TABLE, LONG_WORDS = 24, 40, 12
TIMES = {"timing_s", "seconds", "closed_form_seconds"}
TIMED = {"TIME", "CHEAPEST"}  # entries of sheets
VERSIONS = {"slopekit", "versions"}
_NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w])")
#: What is measured or installed, and what stands for it.
_MASKS = (
    (re.compile(r"\bslopekit \d+\.\d+\.\d+\S*"), "slopekit #"),
    (re.compile(r" *(?<![\w.])\d+(?:\.\d+)? (ms|µs)\b"), r" # \1"),
    (re.compile(r"; \d+(?:\.\d+)? s$"), "; # s"),
    (
        re.compile(r"\b\d+ factorisations"),
        "# factorisations",
    ),  # their number stands in model.passes
    (
        re.compile(r"^(Usage:).*\bslopekit\b"),
        r"\1 slopekit",
    ),  # the program that runs the cases names itself there
)

Section = list[str]


@dataclass(frozen=True)
class Difference:
    """What is not as stored: the case, its section, the key or line, the stored and the new text."""

    case: str
    section: str
    key: str
    old: str
    new: str

    def __str__(self) -> str:
        apart = _apart(self.old, self.new)
        return f"{self.case}  {self.section}  {self.key}\n    old  {self.old}\n    new  {self.new}{apart}"


# -- documents as lines -----------------------------------------------------------------------------------------------


def lines_of(document: Any) -> Section:
    """A document of JSON values as ``path = value`` lines, without its times and versions."""
    return [f"{path} = {text}" for path, text in _flat(document, "")]


def text_of(text: str) -> Section:
    """A sheet or another text as lines, without times and what follows from them, with # for versions."""
    kept: Section = []
    label, width = "", None
    for line in text.splitlines():
        if not line.startswith(" "):
            label, width = line.partition(" ")[0], None
        if label == "LADDER":  # of a check: its last two columns are times
            width = (
                line.index("error") + len("error")
                if re.search(r"error +ms +times$", line)
                else width
            )
        if label not in TIMED:
            kept.append(_masked(line[:width]).rstrip())
    return kept


def _masked(text: str) -> str:
    for pattern, new in _MASKS:
        text = pattern.sub(new, text)
    return text


def _flat(value: Any, path: str) -> Iterator[tuple[str, str]]:
    if isinstance(value, Mapping):
        if "zlib_base64" in value:
            array = _unpacked(value)
            ordered = not path.endswith(
                "triangles"
            )  # of a flat face: any of its triangulations is right
            yield (
                path,
                _nested(array.tolist())
                if array.size <= LONG_LIST and ordered
                else _digest(array, ordered),
            )
            return
        items = [(str(key), one) for key, one in value.items() if key not in TIMES]
        if not path or "sheet" in value:  # a document, or one within it
            items = [(key, one) for key, one in items if key not in VERSIONS]
        if not items:
            yield path, "{}"
        for key, one in items:
            yield from _flat(one, f"{path}.{key}" if path else key)
    elif isinstance(value, list | tuple):
        yield from _flat_list(list(value), path)
    else:
        yield path, _scalar(value)


def _flat_list(values: list[Any], path: str) -> Iterator[tuple[str, str]]:
    if values and all(isinstance(one, Mapping) for one in values):
        if len(values) <= LONG_TABLE:
            for k, one in enumerate(values):
                yield from _flat(one, f"{path}.{k}")
            return
        columns: dict[str, list[str]] = {}
        for one in values:
            for key, text in _flat(one, "") if one else [("", "{}")]:
                columns.setdefault(key, []).append(text)
        for key, texts in columns.items():
            yield f"{path}.*.{key}", _digest_of_texts(texts)
        return
    numbers = _numbers(values)
    if numbers is not None and numbers.size > LONG_LIST:
        yield path, _digest(numbers)
    elif any(isinstance(one, list | tuple | Mapping) for one in values) and numbers is None:
        for k, one in enumerate(values):
            yield from _flat(one, f"{path}.{k}")
    elif len(values) > LONG_LIST:
        yield path, _digest_of_texts([_scalar(one) for one in values])
    else:
        yield path, _nested(values)


def _nested(value: Any) -> str:
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_nested(one) for one in value) + "]"
    return _scalar(value)


def _scalar(value: Any) -> str:
    if isinstance(value, float):
        return f"{value + 0.0:.12g}" if math.isfinite(value) else repr(value)
    return json.dumps(_masked(value) if isinstance(value, str) else value, ensure_ascii=False)


def _numbers(values: list[Any]) -> np.ndarray | None:
    """A list, or a list of lists of one length, of numbers alone; None for any other."""
    flat = values
    if (
        values
        and all(isinstance(one, list | tuple) for one in values)
        and len({len(one) for one in values}) == 1
    ):
        flat = [part for one in values for part in one]
    if not flat or not all(
        isinstance(one, int | float) and not isinstance(one, bool) for one in flat
    ):
        return None
    return np.array(values, dtype=float)


def _unpacked(value: Mapping[str, Any]) -> np.ndarray:
    content = zlib.decompress(base64.b64decode(value["zlib_base64"]))
    return np.frombuffer(content, dtype=value["type"]).reshape(value["shape"])


def _digest(array: np.ndarray, ordered: bool = True) -> str:
    """Numbers in short; of whole numbers a checksum as well; what is not ordered by its range alone."""
    head = f"numbers {'x'.join(str(one) for one in array.shape)}"
    if array.size == 0:
        return head
    flat = array.astype(float).ravel()
    known = np.where(np.isfinite(flat), flat, 0.0)
    weights = np.cos(np.arange(1, flat.size + 1))
    parts = [
        ("least", known.min()),
        ("greatest", known.max()),
        ("sum", math.fsum(known)),
        ("weighted", math.fsum(known * weights)),
    ]
    text = " ".join(
        f"{name} {value + 0.0:.12g}" for name, value in (parts if ordered else parts[:2])
    )
    if not np.isfinite(flat).all():
        text += f" not finite {int((~np.isfinite(flat)).sum())}"
    if array.dtype.kind in "iub" and ordered:
        text += f" checksum {_checksum(array.astype(np.int64).tobytes())}"
    return f"{head} {text}"


def _digest_of_texts(texts: Sequence[str]) -> str:
    """A column: as numbers where most of it is, else as words; null counts as not given."""
    given = [text for text in texts if text != "null"]
    try:
        numbers = np.array([float(text) for text in given])
    except ValueError:
        pass
    else:
        if given:
            return f"{_digest(numbers)} null {len(texts) - len(given)}"
    counts = Counter(texts).most_common(LONG_WORDS)
    said = ", ".join(f"{text} {count}" for text, count in counts)
    return f"words {len(texts)} checksum {_checksum(chr(10).join(texts).encode())}: {said}"


def _checksum(content: bytes) -> str:
    return "x" + hashlib.sha256(content).hexdigest()[:12]


# -- comparing --------------------------------------------------------------------------------------------------------


def compare_values(case: str, section: str, old: Section, new: Section) -> list[Difference]:
    """Lines of values, key by key, in any order."""
    before, after = _by_key(old), _by_key(new)
    found = []
    for key in [*before, *(key for key in after if key not in before)]:
        if key not in after:
            found.append(Difference(case, section, key, before[key], "(gone)"))
        elif key not in before:
            found.append(Difference(case, section, key, "(not stored)", after[key]))
        elif not same_value(f"{case} {key}", before[key], after[key]):
            found.append(Difference(case, section, key, before[key], after[key]))
    return found


def compare_text(case: str, section: str, old: Section, new: Section) -> list[Difference]:
    """Lines of a text, in their order; where only rounding differs lines may break elsewhere."""
    if old == new:
        return []
    words_differ = (
        "\n".join(old).split() != "\n".join(new).split()
    )  # where they do not, the layout does
    if words_differ and _flowing(old) == _flowing(new):
        return []
    before, after = [_comparable(line) for line in old], [_comparable(line) for line in new]
    found = []
    for what, i, j, k, m in SequenceMatcher(None, before, after, autojunk=False).get_opcodes():
        if what == "equal":
            continue
        for n in range(max(j - i, m - k)):
            was = old[i + n] if i + n < j else "(no such line)"
            now = new[k + n] if k + n < m else "(gone)"
            if not (i + n < j and k + n < m and _same_line(was, now)):
                found.append(Difference(case, section, f"line {min(i + n, j) + 1}", was, now))
    return found


def same_value(where: str, old: str, new: str) -> bool:
    """Whether two texts of a value are one, each number within the tolerance of its case and key, all words equal."""
    if old == new:
        return True
    if '"' in old:
        return _same_line(old, new)
    before, after = _NUMBER.findall(old), _NUMBER.findall(new)
    if len(before) != len(after) or _NUMBER.split(old) != _NUMBER.split(new):
        return False
    a, b = [float(one) for one in before], [float(one) for one in after]
    relative, absolute = tolerance_of(where)
    scale = max(map(abs, _sizes(old, a) + _sizes(new, b)), default=0.0)
    return all(
        abs(x - y) <= max(absolute, relative * max(abs(x), abs(y), scale))
        for x, y in zip(a, b, strict=True)
    )


def tolerance_of(where: str) -> tuple[float, float]:
    """Relative and absolute tolerance of a case and key."""
    for pattern, relative, absolute, _ in LOOSER:
        if pattern.search(where):
            return relative, absolute
    return RELATIVE, 0.0


def kept(case: str, key_by_key: bool, old: Section, new: Section) -> Section:
    """What is to be stored: the new lines, of values that are the same the old ones, so that a store changes little."""
    if not key_by_key:
        return new if compare_text(case, "", old, new) else old
    before, found = _by_key(old), []
    for key, text in _by_key(new).items():
        same = key in before and same_value(f"{case} {key}", before[key], text)
        found.append(f"{key} = {before[key] if same else text}")
    return found


def _by_key(lines: Section) -> dict[str, str]:
    found: dict[str, str] = {}
    for line in lines:
        key, _, text = line.partition(" = ")
        found[key] = text
    return found


def _sizes(text: str, numbers: list[float]) -> list[float]:
    """The numbers that set the scale: of a digest least and greatest."""
    if text.startswith("numbers"):
        return [float(one) for one in re.findall(r"(?:least|greatest) (\S+)", text)]
    return numbers


def _comparable(line: str) -> str:
    """A line with its rounding written alike."""
    return _NUMBER.sub(lambda found: "0" if abs(float(found[0])) < RESIDUE else found[0], line)


def _flowing(lines: Section) -> list[str]:
    return _comparable("\n".join(lines)).split()


def _same_line(old: str, new: str) -> bool:
    before, after = _NUMBER.findall(_comparable(old)), _NUMBER.findall(_comparable(new))
    if len(before) != len(after) or _NUMBER.split(_comparable(old)) != _NUMBER.split(
        _comparable(new)
    ):
        return False
    return all(
        a == b
        or (_digits(a) >= 10 <= _digits(b) and math.isclose(float(a), float(b), rel_tol=RELATIVE))
        for a, b in zip(before, after, strict=True)
    )


def _digits(number: str) -> int:
    return len(re.sub(r"e.*|\D", "", number).lstrip("0"))


def _apart(old: str, new: str) -> str:
    """How far two single numbers are apart, relative to the old one."""
    try:
        a, b = float(old), float(new)
    except ValueError:
        return ""
    return f"   ({(b - a) / abs(a):+.1e} of it)" if a else f"   ({b - a:+.1e})"
