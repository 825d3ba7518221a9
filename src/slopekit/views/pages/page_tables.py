"""The tables of a page: those of a sheet as its JSON has them, and the inputs of a design by name."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from slopekit.core.orientation import millimetre, number
from slopekit.core.sheet import head_of

Table = Mapping[str, Any]
_DIGITS, _DECIMALS = 9, 3  # signs of a number that nobody has rounded, of them behind the point
_LARGE = 1e5  # from here on five digits are fewer than those before the point
_UNITS = {
    "_kn_m3": " kN/m³",
    "_kg_m3": " kg/m³",
    "_m_s2": " m/s²",
    "_m3": " m³",
    "_m2": " m²",
    "_kpa": " kPa",
    "_deg": "°",
    "_kn": " kN",
    "_m": " m",
}
_PRINTED_ELSEWHERE = (
    "title",
    "rules",
    "joint_names",
)  # by the head of the page, by ACCEPT and by PLANES
_COORDINATES = (
    "origin_m",
    "head_m",
    "at_m",
    "centre_m",
    "polygon_m",
    "profile_m",
    "table_points_m",
)
_ROUNDING = 1e-12  # of the largest of several values
_MOST_VALUES = 24  # rows or values of one kind


def table(
    head: Sequence[str], rows: Sequence[Sequence[str]], note: str = "", text_columns: int = 1
) -> Table:
    """Return a table for the template: heads, rows of texts, a note beneath; the first `text_columns` are words.

    >>> table(("case", "FoS"), [("dry", "1.557")])["rows"]
    [('dry', '1.557')]
    """
    return {"head": head, "rows": rows, "note": note, "left": text_columns}


def section_entries(entries: Iterable[Any]) -> Iterator[Table | str]:
    """The entries of a section of a sheet's JSON: texts, verbatim texts, tables without their empty columns.

    Raises
    ------
    TypeError
        Where the entries are not those of a sheet.
    """
    if not isinstance(entries, list) or not all(
        isinstance(entry, str | Mapping) for entry in entries
    ):
        raise TypeError("a section of the sheet is no list of texts and tables")
    for entry in entries:
        if isinstance(entry, str) or "verbatim" in entry:
            yield entry
        elif rows := entry["shown"]:
            filled_columns = [
                k for k, _ in enumerate(entry["columns"]) if any(row[k] for row in rows)
            ]
            heads = [head_of(entry["columns"][k]) for k in filled_columns]
            values = zip(rows, entry["rows"], strict=True)
            cells = [
                [_cell(str(row[k]), exact[k]) for k in filled_columns] for row, exact in values
            ]
            is_text = [
                all(isinstance(row[k], str) for row in entry["rows"]) for k in filled_columns
            ]
            yield table(heads, cells, entry["rest"], text_columns=[*is_text, False].index(False))


def _cell(text: str, value: Any) -> str:
    """A cell as it is shown; every digit of a number is for machines.

    >>> _cell("155.629335909", 155.629335909), _cell("1.0000", 1.0), _cell("512300.125", 512300.125)
    ('155.63', '1.0000', '512300.125')
    """
    if not isinstance(value, float) or text != str(value) or len(text) <= _DIGITS:
        return text
    if len(text.partition(".")[2]) <= _DECIMALS:
        return text
    return f"{value:.5g}" if abs(value) < _LARGE else millimetre(value)


def input_rows(inputs: Mapping[str, Any]) -> list[tuple[str, str]]:
    """The inputs of a design by name, with their units; what was not given is left out.

    >>> input_rows({"height_m": 15.0, "water": {"mode": "dry"}, "crack": None})
    [('height', '15 m'), ('water: mode', 'dry')]
    """
    rows = list[tuple[str, str]]()
    for key, value in inputs.items():
        if value in (None, "", []) or key in _PRINTED_ELSEWHERE:
            continue
        name = key.removesuffix(_suffix(key)).replace("_", " ")
        is_list = isinstance(value, list)
        if is_list and all(
            isinstance(entry, list) and isinstance(entry[-1], Mapping) for entry in value
        ):
            value = dict(value)  # strengths by name
        if isinstance(value, Mapping):
            rows += [(f"{name}: {below}", text) for below, text in input_rows(value)]
        elif is_list and any(isinstance(entry, Mapping) for entry in value):
            rows += [
                (
                    f"{name} {entry.get('name', k)}",
                    "; ".join(f"{key} {text}" for key, text in input_rows(entry) if key != "name"),
                )
                for k, entry in enumerate(value[:_MOST_VALUES], 1)
                if entry
            ]
            rows += (
                [(f"... {len(value) - _MOST_VALUES} more", "in the JSON")]
                if len(value) > _MOST_VALUES
                else []
            )
        else:
            rows.append((name, value_text(key, value)))
    return rows


def value_text(key: str, value: Any) -> str:
    """A value, or several, with the unit that the key has; coordinates to the millimetre, a rounding of 0 as 0.

    >>> value_text("spacing_m", 3.5), value_text("force_kn", [1.0, 2e-17]), value_text("fixed", True)
    ('3.5 m', '1, 0 kN', 'yes')
    >>> value_text("head_m", [512300.25, 4187650.0])
    '512300.250, 4187650.000 m'
    """
    unit = _UNITS.get(_suffix(key), "")
    if isinstance(value, list):
        more = (
            f", ... and {len(value) - _MOST_VALUES} more (in the JSON)"
            if len(value) > _MOST_VALUES
            else ""
        )
        return f"{', '.join(_value_without_unit(key, number) for number in _rounded(value[:_MOST_VALUES]))}{more}{unit}"
    return f"{_value_without_unit(key, value)}{unit}"


def _rounded(values: list[Any]) -> list[Any]:
    """Numbers without what rounding left of a zero."""
    if not all(isinstance(number, int | float) for number in values):
        return values
    least = _ROUNDING * max(map(abs, values), default=0.0)
    return [number if abs(number) > least else 0.0 for number in values]


def _value_without_unit(key: str, value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list):
        return f"({', '.join(_value_without_unit(key, element) for element in value)})"
    if isinstance(value, int | float):
        return millimetre(value) if key in _COORDINATES else number(float(value))
    return str(value)


def _suffix(key: str) -> str:
    return next((suffix for suffix in _UNITS if key.endswith(suffix)), "")
