"""The sheet of forces on single columns: each method's, where it acts, every column by itself; 100 columns."""

from operator import attrgetter

from slopekit.core.sheet import Column, Entry, Section, Sheet, Table, Verbatim
from slopekit.kinds.words import line_in_words, size_number
from slopekit.studies.support.columns.records import ByColumn, ColumnSupport, Held
from slopekit.studies.support.sheet import level, needed
from slopekit.studies.words import head, status_words

_WHERE = {
    "toe": "the toe block", "crest": "the crest, the tallest column",
    "least": "the column that needs least by Goodman & Bray",
}  # fmt: skip
_ROLES = {
    "active": "a load: it counts in full, whatever the columns do",
    "passive": "strength: its capacity is divided by FoS, and it pulls only as the column moves",
}


def sheet_of(found: ColumnSupport) -> Sheet:
    """The sheet of support for columns."""
    roles = [
        Section(acts.upper(), [_ROLES[acts], *(entry for one in own for entry in _held(found, one))])
        for acts in ("active", "passive")
        if (own := [one for one in found.held if one.acts == acts])
    ]
    table = _by_column(found)
    return Sheet(head(found.design, "support"), (
        Section("TARGET", _target(found)),
        *roles,
        Section("COLUMNS", [
            "active force on one column alone, by Goodman & Bray's table: kN per metre of slope; its height is above "
            "the base", table,
        ] if table.rows else []),
        Section("USE", _use(found)),
        Section("NOTE", [*([found.why_no_closed_form] if found.why_no_closed_form else []), *map(str, found.warnings)]),
        Section("PASTE", _paste(found)),
        Section("TIME", [f"{found.seconds:.2f} s"]),
    ), {"support.csv": _cases(found)})  # fmt: skip


def line_of(found: ColumnSupport) -> str:
    """A line for each way the anchor acts: reached, force, column."""
    if found.stands:
        return f"reached  nothing needed  {level(found.pre_ie)}"
    lines = []
    for acts in found.options.acts:
        best = found.least(acts)
        if best is not None:
            line = f"{acts}  reached  {size_number(best.use_kn or 0.0)} {found.unit}  on {best.column}"
            lines.append(f"{line}  toward {line_in_words(best.toward)}")
        else:
            codes = dict.fromkeys(said.code for one in found.held if one.acts == acts for said in one.notices)
            lines.append("  ".join([acts, "not reached", *codes]))
    return "\n".join(lines)


def _target(found: ColumnSupport) -> list[str]:
    now = f"as it stands {level(found.pre_ie)} by PRE-IE"
    now += "" if found.closed_form is None else f", {level(found.closed_form)} by Goodman & Bray"
    entries = [f"FoS {found.target:g}; {now}: {status_words(found.design, found.pre_ie.status)}"]
    return [*entries, "reached: no more support is needed"] if found.stands else entries


def _held(found: ColumnSupport, one: Held) -> list[str]:
    said = [] if one.closed_form is None else [needed(one.closed_form, found.unit, "Goodman & Bray")]
    said.append(needed(one.pre_ie, found.unit, "PRE-IE"))
    x, _, z = one.at
    lines = [
        f"{one.column}, {_WHERE[one.where]}: {';  '.join(said)}",
        f"toward {line_in_words(one.toward)}, {one.height:.4g} m above its base on its outer side "
        f"(x {x:.4g}, z {z:.4g})",
    ]
    if one.use_kn:
        capacity = found.options.capacity
        lines.append(f"one anchor of {capacity:g} kN every {capacity / one.use_kn:.3g} m along the slope")
    return [*lines, *map(str, one.notices)]


def _by_column(found: ColumnSupport) -> Table[ByColumn]:
    columns: list[Column[ByColumn]] = [
        Column("column", attrgetter("column"), "column", width=-10),
        Column("acts at", attrgetter("height"), "height_m", "m", ".4g", width=10),
        Column("force", attrgetter("force"), "force_kn", found.unit, _size, width=14),
    ]
    return Table(columns, found.columns)


def _size(value: float | None) -> str:
    return "never enough" if value is None else size_number(value)


def _cases(found: ColumnSupport) -> Table[Held]:
    columns: list[Column[Held]] = [
        Column("anchor is", attrgetter("acts"), "acts"),
        Column("column", attrgetter("column"), "column"),
        Column("height", attrgetter("height"), "height_m", "m"),
        Column("Goodman & Bray", lambda one: one.closed_form and one.closed_form.force, "closed_form_kn", found.unit),
        Column("PRE-IE", attrgetter("pre_ie.force"), "pre_ie_kn", found.unit),
        Column("to use", attrgetter("use_kn"), "use_kn", found.unit),
        Column("reached", attrgetter("reached"), "reached", show=lambda reached: "yes" if reached else "no"),
    ]
    return Table(columns, found.held, said="")


def _use(found: ColumnSupport) -> list[str]:
    lines = []
    for acts in found.options.acts if found.held else ():
        best = found.least(acts)
        if best is None:
            lines.append(f"{acts}: the target is not reached on any of these columns; see above")
            continue
        why = "the larger of both methods" if best.closed_form is not None else "PRE-IE's"
        lines.append(f"{acts}: {size_number(best.use_kn or 0.0)} {found.unit} on {best.column}   ({why})")
    return lines


def _paste(found: ColumnSupport) -> list[Entry]:
    thick = found.thickness
    per = "" if thick == 1.0 else f" (for the {thick:g} m of this design)"
    entries: list[Entry] = []
    for name, text in found.files().items():
        entries += [f"{name.removesuffix('.yaml')}, in place of `support` in the design{per}:", Verbatim(text)]
    return entries
