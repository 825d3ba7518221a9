"""The mutations of `benchmarks.fuzz`: file `index` of a seed is always the same."""

import json
import random
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from benchmarks.fuzz_seeds import EXTREMES, FRAGMENTS, SEEDS, SPICES, WRONG
from slopekit.design.reading.nodes import Node
from slopekit.design.reading.yaml import places_in, tree_of

_PLAIN = re.compile(r"[A-Za-z0-9_.+/-][A-Za-z0-9_.+/ °%<>=@-]*[A-Za-z0-9_.+/°%-]|[A-Za-z0-9]")


class Keys(list[tuple[str, Any]]):
    """Keys with their values, in order; one may stand twice."""


@dataclass(frozen=True)
class Case:
    """One mutated file: its bytes, what follows its `--set`, and how it was made."""

    index: int
    content: bytes
    sets: tuple[str, ...]
    origin: str


# -- trees ------------------------------------------------------------------------------------------------------------


def _tree(node: Node) -> Any:
    if node.is_mapping:
        return Keys((key, _tree(below)) for key, below in node.items())
    return [_tree(below) for below in node.elements] if isinstance(node.value, list) else node.value


def _parsed(text: str) -> Any:
    root, _ = tree_of(text, places_in("seed", text))
    return None if root is None else _tree(root)


def _holders(tree: Any) -> Iterator[Any]:
    """Every list and every group of keys, the outermost first."""
    if isinstance(tree, list):
        yield tree
        for part in tree:
            yield from _holders(part[1] if isinstance(tree, Keys) else part)


def _leaves(tree: Any) -> list[tuple[Any, int, str]]:
    """Every single value as its holder, its number there, and the key it stands under."""
    found = []

    def visit(holder: Any, name: str) -> None:
        for k, part in enumerate(holder):
            key, value = part if isinstance(holder, Keys) else (name, part)
            if isinstance(value, list):
                visit(value, key)
            else:
                found.append((holder, k, key))

    visit(tree, "")
    return found


def _get(holder: Any, k: int) -> Any:
    return holder[k][1] if isinstance(holder, Keys) else holder[k]


def _put(holder: Any, k: int, value: Any) -> None:
    holder[k] = (holder[k][0], value) if isinstance(holder, Keys) else value


def _copy(tree: Any) -> Any:
    if isinstance(tree, Keys):
        return Keys((key, _copy(value)) for key, value in tree)
    return [_copy(part) for part in tree] if isinstance(tree, list) else tree


def _paths(tree: Any, path: str = "") -> list[str]:
    found = [path] if path else []
    for k, part in enumerate(tree if isinstance(tree, list) else ()):
        key, value = part if isinstance(tree, Keys) else (str(k), part)
        found += _paths(value, f"{path}.{key}" if path else key)
    return found


def _scalar(value: Any) -> str:
    if value is None:
        return ""
    text = str(value)
    return (
        text
        if _PLAIN.fullmatch(text) and text not in ("null", "~")
        else json.dumps(text, ensure_ascii=False)
    )


def _flow(tree: Any) -> str:
    if isinstance(tree, Keys):
        return (
            "{" + ", ".join(f"{_scalar(key)}: {_flow(value)}".rstrip() for key, value in tree) + "}"
        )
    if isinstance(tree, list):
        return "[" + ", ".join(_flow(part) if part is not None else "~" for part in tree) + "]"
    return _scalar(tree)


def _dump(tree: Any) -> str:
    """A tree as YAML: the two outer levels as blocks, the rest in brackets."""
    if not isinstance(tree, Keys):
        return _flow(tree) + "\n"
    lines = []
    for key, value in tree:
        if isinstance(value, Keys) and value and len(_flow(value)) > 60:
            lines.append(f"{_scalar(key)}:")
            lines += [f"  {_scalar(name)}: {_flow(below)}".rstrip() for name, below in value]
        else:
            lines.append(f"{_scalar(key)}: {_flow(value)}".rstrip())
    return "\n".join(lines) + "\n"


# -- mutations of trees -----------------------------------------------------------------------------------------------


def _numbers(text: str) -> list[re.Match[str]]:
    return list(re.finditer(r"\d+\.?\d*(?:[eE][+-]?\d+)?", text))


def _extreme(tree: Any, rng: random.Random) -> None:
    """One value replaced by another that its key may have."""
    leaves = [leaf for leaf in _leaves(tree) if leaf[2] in EXTREMES]
    if leaves:
        holder, k, key = rng.choice(leaves)
        _put(holder, k, rng.choice(EXTREMES[key]))


def _scaled(tree: Any, rng: random.Random) -> None:
    """One number larger or smaller, a little or by powers of ten, its unit kept."""
    leaves = [
        leaf
        for leaf in _leaves(tree)
        if leaf[2] != "slopekit" and _numbers(str(_get(*leaf[:2]) or ""))
    ]
    if leaves:
        holder, k, _ = rng.choice(leaves)
        text = str(_get(holder, k))
        match = rng.choice(_numbers(text))
        factor = (
            10.0 ** rng.choice((-6, -3, -2, -1, 1, 2, 3, 6))
            if rng.random() < 0.4
            else rng.uniform(0.3, 1.8)
        )
        _put(
            holder,
            k,
            text[: match.start()] + f"{float(match.group()) * factor:.6g}" + text[match.end() :],
        )


def _spice(tree: Any, rng: random.Random) -> None:
    """A whole section another way: water, cracks, bolts, forces, seismic, profiles, surfaces."""
    kind = dict(tree).get("kind") if isinstance(tree, Keys) else None
    choices = SPICES.get(str(kind), ())
    if choices:
        key, text = rng.choice(choices)
        value = _parsed(f"{key}: {text}")[0][1]
        places = [k for k, (name, _) in enumerate(tree) if name == key]
        if places:
            tree[places[0]] = (key, value)
        else:
            tree.append((key, value))


def _drop(tree: Any, rng: random.Random) -> None:
    holders = [holder for holder in _holders(tree) if holder]
    if holders:
        holder = rng.choice(holders)
        del holder[rng.randrange(len(holder))]


def _double(tree: Any, rng: random.Random) -> None:
    holders = [holder for holder in _holders(tree) if holder]
    if holders:
        holder = rng.choice(holders)
        holder.insert(rng.randrange(len(holder) + 1), _copy(rng.choice(holder)))


def _typo(text: str, rng: random.Random) -> str:
    k = rng.randrange(max(1, len(text)))
    return rng.choice(
        (
            text[:k] + text[k + 1 :],
            text[:k] + rng.choice("aeioux_9ßφ.-/ ") + text[k:],
            text.upper(),
            text.title(),
            text[:k] + text[k + 1 : k + 2] + text[k : k + 1] + text[k + 2 :],
            text + "s",
            text.replace("_", "-"),
            "",
            rng.choice(WRONG["texts"]),
        )
    )


def _rename(tree: Any, rng: random.Random) -> None:
    holders = [holder for holder in _holders(tree) if isinstance(holder, Keys) and holder]
    if holders:
        holder = rng.choice(holders)
        k = rng.randrange(len(holder))
        holder[k] = (_typo(holder[k][0], rng), holder[k][1])


def _retype(tree: Any, rng: random.Random) -> None:
    """A list for keys, keys for a value, a value for a list."""
    holders = [holder for holder in _holders(tree) if holder]
    if holders:
        holder = rng.choice(holders)
        k = rng.randrange(len(holder))
        value = _get(holder, k)
        options: list[Any] = [
            [value],
            Keys([("value", value)]),
            None,
            "",
            "true",
            [],
            Keys(),
            [[value, value], value],
            "5",
            Keys([("dist", "normal"), ("mean", value), ("sd", "1")]),
        ]
        if isinstance(value, Keys):
            options.append([part for _, part in value])
        elif isinstance(value, list):
            options.append(Keys((str(n), part) for n, part in enumerate(value)))
        _put(holder, k, rng.choice(options))


def _wrong_value(tree: Any, rng: random.Random) -> None:
    leaves = _leaves(tree)
    if leaves:
        holder, k, _ = rng.choice(leaves)
        _put(holder, k, rng.choice(WRONG[rng.choice(tuple(WRONG))]))


def _wrong_unit(tree: Any, rng: random.Random) -> None:
    leaves = [leaf for leaf in _leaves(tree) if re.match(r"^[\d.]", str(_get(*leaf[:2])))]
    if leaves:
        holder, k, _ = rng.choice(leaves)
        _put(
            holder,
            k,
            re.split(r"[^\d.eE]", str(_get(holder, k)))[0] + " " + rng.choice(WRONG["units"]),
        )


def _swap(tree: Any, rng: random.Random) -> None:
    leaves = (
        _leaves(tree)
        if rng.random() < 0.7
        else [(h, k, "") for h in _holders(tree) for k in range(len(h))]
    )
    if len(leaves) > 1:
        (a, i, _), (b, j, _) = rng.sample(leaves, 2)
        first, second = _copy(_get(a, i)), _copy(_get(b, j))
        _put(a, i, second)
        _put(b, j, first)


def _nest(tree: Any, rng: random.Random) -> None:
    holders = [holder for holder in _holders(tree) if holder]
    if holders:
        holder = rng.choice(holders)
        k, value = rng.randrange(len(holder)), "1"
        deep: Any = _get(holder, k) if rng.random() < 0.5 else value
        for _ in range(rng.choice((2, 5, 30, 120))):
            deep = [deep] if rng.random() < 0.5 else Keys([("a", deep)])
        _put(holder, k, deep)


def _insert(tree: Any, rng: random.Random) -> None:
    """A key of some other design, where it may or may not belong."""
    holders = [holder for holder in _holders(tree) if isinstance(holder, Keys)]
    if holders:
        key, _, value = rng.choice(FRAGMENTS).partition(": ")
        rng.choice(holders).append((key, _parsed(f"a: {value}")[0][1]))


def _other_kind(tree: Any, rng: random.Random) -> None:
    for k, (key, _) in enumerate(tree if isinstance(tree, Keys) else ()):
        if key == "kind":
            tree[k] = (
                key,
                rng.choice(
                    ("wedge", "plane", "footing", "surface", "topple", "bench", "Wedge", "")
                ),
            )


Mutation = Callable[[Any, random.Random], None]
_LEGAL: tuple[Mutation, ...] = (_extreme, _extreme, _scaled, _spice)
_ILL: tuple[Mutation, ...] = (
    _drop,
    _double,
    _rename,
    _retype,
    _wrong_value,
    _wrong_value,
    _wrong_unit,
    _swap,
    _nest,
    _insert,
    _other_kind,
)


# -- mutations of text ------------------------------------------------------------------------------------------------


def broken_text(text: str, rng: random.Random) -> tuple[bytes, str]:
    """A text that may or may not still be YAML."""
    how = rng.choice(
        (
            "character",
            "delete",
            "truncate",
            "tab",
            "indent",
            "line gone",
            "line twice",
            "lines swapped",
            "quote",
            "control",
            "second",
            "ending",
            "utf-16",
            "latin-1",
            "bytes",
            "alias",
            "tag",
            "merge",
        )
    )
    k, lines = rng.randrange(len(text) + 1), text.split("\n")
    line = rng.randrange(len(lines))
    if how == "character":
        text = text[:k] + rng.choice("[]{}:,&*!|>'\"%@`#?-~\\<=\n\t ") + text[k:]
    elif how == "delete":
        text = text[:k] + text[k + rng.choice((1, 1, 3, 20)) :]
    elif how == "truncate":
        text = text[:k]
    elif how == "tab":
        lines[line] = "\t" + lines[line]
    elif how == "indent":
        lines[line] = (
            " " * rng.randrange(1, 5) + lines[line] if rng.random() < 0.6 else lines[line].lstrip()
        )
    elif how == "line gone":
        del lines[line]
    elif how == "line twice":
        lines.insert(line, lines[line])
    elif how == "lines swapped":
        other = rng.randrange(len(lines))
        lines[line], lines[other] = lines[other], lines[line]
    elif how == "quote":
        lines[line] = lines[line].replace(
            ": ", rng.choice((": '", ': "', ":", " : ", ":: ", ": |", ": >\n")), 1
        )
    elif how == "control":
        text = (
            text[:k]
            + rng.choice(("\x00", "\x07", "\x1b", "\x7f", "\x85", "\u2028", "\ufeff", "\ufffe"))
            + text[k:]
        )
    elif how == "second":
        text = (
            text
            + rng.choice(("---\n", "...\n", "---\nkind: wedge\n", "--- a\n", "%YAML 1.1\n---\n"))
            + text
        )
    elif how == "ending":
        text = text.replace("\n", rng.choice(("\r\n", "\r", "\n\n", "\u2029", "\x0c\n")))
    elif how in ("utf-16", "latin-1"):
        return text.encode(how, "replace"), how
    elif how == "bytes":
        content = bytearray(text.encode())
        for _ in range(rng.randrange(1, 4)):
            content[rng.randrange(len(content))] = rng.randrange(256)
        return bytes(content), how
    elif how == "alias":
        text = (
            text.replace(": {", ": &a {", 1).replace(": ", ": *a ", 1)
            if rng.random() < 0.5
            else f"a: &a\n{text}b: *a"
        )
    elif how == "tag":
        text = text.replace(
            ": ", rng.choice((": !!float ", ": !x ", ": !!python/object:os.system ", ": !!set ")), 1
        )
    else:
        lines[line] = "<<: {a: 1}"
    if how in ("tab", "indent", "line gone", "line twice", "lines swapped", "quote", "merge"):
        text = "\n".join(lines)
    return text.encode("utf-8", "surrogatepass"), how


def _sets(tree: Any, rng: random.Random) -> tuple[str, ...]:
    found = []
    for _ in range(rng.choice((1, 1, 2))):
        path = rng.choice(_paths(tree) or ["slope"])
        key = path.rpartition(".")[2]
        values = (
            EXTREMES.get(key, WRONG["texts"])
            if rng.random() < 0.7
            else WRONG[rng.choice(tuple(WRONG))]
        )
        value = str(rng.choice(values))
        if rng.random() < 0.15:
            path = rng.choice(
                (_typo(path, rng), f"{path}.0", f"{path}.x", f".{path}", f"{path}.", f"{path}.99")
            )
        if rng.random() < 0.1:
            value = rng.choice(
                ("[1, 2", "{a: 1}", "[]", "{}", "'", '"x"', "[1, [2, {a: b}]]", "null", "=", "a=b")
            )
        found.append(f"{path}={value}" if rng.random() < 0.97 else path)
    return tuple(found)


def case(index: int, seed: int, names: Sequence[str] = tuple(SEEDS)) -> Case:
    """File `index` of a seed, made of one of the designs `names`."""
    rng = random.Random(f"{seed}/{index}")
    name = rng.choice(names)
    tree = _copy(_trees()[name])
    # half of the files are legal but extreme, a third wrong somewhere in the tree, the rest wrong as text
    share = rng.random()
    made: list[str] = []
    for _ in range(rng.choice((1, 1, 2, 3)) if share < 0.85 else 0):
        mutation = rng.choice(_LEGAL if share < 0.55 or rng.random() < 0.3 else _ILL)
        mutation(tree, rng)
        made.append(mutation.__name__.strip("_"))
    sets = _sets(tree, rng) if rng.random() < 0.12 else ()
    content = _dump(tree).encode("utf-8", "surrogatepass")
    if share >= 0.85:
        content, how = broken_text(SEEDS[name] if rng.random() < 0.7 else _dump(tree), rng)
        made.append(f"text: {how}")
    return Case(index, content, sets, f"{name}: {', '.join(made)}{' --set' if sets else ''}")


def keys_of(texts: Iterable[str]) -> set[str]:
    """Every key that stands in designs."""
    holders = (
        holder for text in texts for holder in _holders(_parsed(text)) if isinstance(holder, Keys)
    )
    return {key for holder in holders for key, _ in holder}


@cache
def _trees() -> dict[str, Any]:
    return {name: _parsed(text) for name, text in SEEDS.items()}
