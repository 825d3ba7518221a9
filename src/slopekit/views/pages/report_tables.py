"""Tables of a result's page: those of the sheet as they are, and of the document what the sheet has no room for."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from slopekit.core.orientation import Line, millimetre
from slopekit.core.sheet import Verbatim, counted, head_of
from slopekit.design.parts import Bolt
from slopekit.kinds.words import bolt_text, more_of
from slopekit.views.pages.report_inputs import InputTable

Document = Mapping[str, Any]

_DIGITS, _DECIMALS = 9, 3  # signs of a number that nobody has rounded, of them behind the point
_LARGE = 1e5  # from here on five digits are fewer than those before the point


def parts(entries: Iterable[Any], captions: Sequence[str] = ()) -> Iterator[InputTable | Verbatim | str]:
    """The entries of a section of a sheet: texts, texts to be copied, tables without columns that have nothing."""
    left = iter(captions)
    for entry in entries:
        if isinstance(entry, str):
            yield entry
        elif "verbatim" in entry:
            yield Verbatim(str(entry["verbatim"]))
        elif rows := entry["shown"]:
            kept = [k for k, _ in enumerate(entry["columns"]) if any(row[k] for row in rows)]
            heads = tuple(head_of(entry["columns"][k]) for k in kept)
            values = zip(rows, entry["rows"], strict=True)
            cells = tuple(tuple(_cell(str(row[k]), own[k]) for k in kept) for row, own in values)
            texts = [all(isinstance(row[k], str) for row in entry["rows"]) for k in kept]
            yield InputTable(next(left, ""), heads, cells, entry["rest"], left=[*texts, False].index(False))


def _cell(shown: str, value: Any) -> str:
    """A cell as it is shown; every digit of a number is for machines.

    >>> _cell("155.629335909", 155.629335909), _cell("1.0000", 1.0), _cell("512300.125", 512300.125)
    ('155.63', '1.0000', '512300.125')
    """
    if not isinstance(value, float) or shown != str(value) or len(shown) <= _DIGITS:
        return shown
    if len(shown.partition(".")[2]) <= _DECIMALS:
        return shown
    return f"{value:.5g}" if abs(value) < _LARGE else millimetre(value)


def without_bolts(entries: Sequence[Any], bolts: Sequence[Document]) -> list[Any]:
    """Entries on loads, the bolts that a schedule lists counted in place of written out."""
    listed = {bolt_text(_bolt(one)) for one in bolts}
    kept = [one for one in entries if one not in listed]
    rest = more_of(len(bolts) - (len(entries) - len(kept)), "bolt")
    return [*(one for one in kept if one != rest), f"{counted(len(bolts), 'bolt')}, in the schedule"]


def _bolt(one: Document) -> Bolt:
    """A bolt of the inputs."""
    head = one["head_m"]
    return Bolt(one["force_kn"], Line(**one["toward"]), one["acts"], head and (head[0], head[1], head[2]),
                one["length_m"], one["block"])  # fmt: skip


# -- inputs ------------------------------------------------------------------------------------------------------------


def check_tables(document: Document) -> Iterator[InputTable]:
    """Balance of forces and moments, checks of the geometry, the size of the model."""
    rows = []
    if (balance := document["balance"]) is not None:
        rows += [
            ("largest unbalanced force of a block, part of its load", _small(balance["force"])),
            (
                "largest unbalanced moment of a block, part of its load times the model's length",
                _small(balance["moment"]),
            ),
            ("largest pull on a node pair, part of the mean normal force", _small(balance["pull"])),
            ("largest friction beyond the reduced strength, part of the load", _small(balance["friction_excess"])),
        ]
    assembly = document["assembly"]
    if assembly is not None:
        rows += [("groups of blocks that touch only through bedrock", str(assembly["components"])),
                 ("contacts", str(assembly["contacts"]))]  # fmt: skip
    if rows:
        yield InputTable("Checks of the answer", ("", "value"), tuple(rows))
    model = document["model"]
    size = [(words, str(model[key])) for key, words in
            (("moving_blocks", "moving blocks"), ("unknowns", "unknowns"), ("node_pairs", "node pairs"),
             ("refined", "times the triangles were split"), ("passes", "passes or factorisations"))]  # fmt: skip
    if model["mesh_change"] is not None:
        size.append(("change of the factor by the last split", _small(model["mesh_change"])))
    yield InputTable("Size of the model", ("", "number"), tuple(size))


# -- cells ------------------------------------------------------------------------------------------------------------


def _small(value: Any) -> str:
    return "0" if not value else f"{float(value):.2g}"
