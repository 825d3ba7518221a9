"""Tables of a result's page: those of the sheet as they are, and of the document what the sheet has no room for."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from slopekit.core.codec import from_json
from slopekit.core.orientation import line_of, millimetre
from slopekit.core.sheet import Section, Verbatim, head_of
from slopekit.findings import GoverningInterface
from slopekit.kinds.sheets.many_blocks import governing
from slopekit.kinds.words import line_in_words
from slopekit.views.pages.report_inputs import InputTable

Document = Mapping[str, Any]

_DIGITS, _DECIMALS = 9, 3  # signs of a number that nobody has rounded, of them behind the point
_LARGE = 1e5  # from here on five digits are fewer than those before the point
_MOST_MECHANISMS = 3  # whose interfaces are listed


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


def motion_table(document: Document) -> InputTable | None:
    """Movement of one block in the mechanism and at full strength."""
    rows = []
    mechanism, one = document["mechanism"], document["at_factor_one"]
    if mechanism is not None and document["assembly"] is None:
        rows.append(
            ("in the mechanism (no size, the direction counts)", _vector(mechanism["displacement"], 4),
             _toward(mechanism["displacement"]), _vector(mechanism["rotation"], 3) + " per m")
        )  # fmt: skip
    if one is not None:
        whose = f" (block {one['block']}, which moves most)" if one.get("block") else ""
        rows.append(
            (f"at full strength on the elastic bed{whose}",
             _vector([1e3 * v for v in one["displacement_m"]], 4) + " mm", _toward(one["displacement_m"]),
             _vector(one["rotation_rad"], 3) + " rad")
        )  # fmt: skip
    head = ("", "displacement of the centroid (east, north, up)", "toward", "rotation about it")
    return InputTable("Movement", head, tuple(rows), left=4) if rows else None


def later_mechanisms(document: Document) -> Iterator[InputTable | Verbatim | str]:
    """The interfaces that govern the mechanisms after the first."""
    for k, one in enumerate((document["assembly"] or {"mechanisms": ()})["mechanisms"][:_MOST_MECHANISMS], 1):
        if k > 1:
            section = Section("", governing([from_json(GoverningInterface, own) for own in one["interfaces"]]))
            yield from parts(section.to_list(), [f"Interfaces that govern mechanism {k}"])


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


def time_table(document: Document) -> InputTable | None:
    """Times of the stages; they alone differ from run to run."""
    rows = tuple((name.replace("_", " "), f"{seconds * 1e3:.1f}") for name, seconds in document["timing_s"].items()
                 if seconds >= 5e-5)  # fmt: skip
    return InputTable("Times", ("stage", "ms"), rows, "Wall time; it alone differs from run to run.") if rows else None


# -- cells ------------------------------------------------------------------------------------------------------------


def _small(value: Any) -> str:
    return "0" if not value else f"{float(value):.2g}"


def _vector(values: Any, digits: int) -> str:
    size = max(abs(float(value)) for value in values)
    parts = [0.0 if abs(float(value)) < max(1e-9 * size, 1e-13) else float(value) for value in values]
    return "(" + ", ".join(f"{part:.{digits}g}" for part in parts) + ")"


def _toward(values: Any) -> str:
    vector = np.array([float(value) for value in values])
    return line_in_words(line_of(vector)) if float(np.abs(vector).max()) > 0.0 else "-"
