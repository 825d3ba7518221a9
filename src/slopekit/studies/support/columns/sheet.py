"""The sheet of forces on single columns: each method's, where it acts, every column by itself; 100 columns."""

from operator import attrgetter

from slopekit.core.orientation import millimetre
from slopekit.core.sheet import Column, Entry, Section, Sheet, Table, Verbatim
from slopekit.kinds.words import line_in_words, size_number
from slopekit.studies.support.columns.records import ByColumn, ColumnSupport, HoldingForce
from slopekit.studies.support.records import wanted_in_words
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


def sheet_of(support: ColumnSupport) -> Sheet:
    """The sheet of support for columns."""
    roles = [
        Section(acts.upper(), [_ROLES[acts], *(entry for one in own for entry in _held(support, one))])
        for acts in ("active", "passive")
        if (own := [one for one in support.held if one.acts == acts])
    ]
    table = _by_column(support)
    return Sheet(head(support.design, "support"), (
        Section("TARGET", _target(support)),
        *roles,
        Section("COLUMNS", [
            "active force on one column alone, by Goodman & Bray's table: kN per metre of slope; its height is above "
            "the base", table,
        ] if table.rows else []),
        Section("USE", _use(support)),
        Section("NOTE", [
            *([support.why_no_closed_form] if support.why_no_closed_form else []), *map(str, support.warnings),
        ]),
        Section("PASTE", _paste(support)),
        Section("TIME", [f"{support.seconds:.2f} s"]),
    ), {"support.csv": _cases(support)})  # fmt: skip


def line_of(support: ColumnSupport) -> str:
    """A line for each way the anchor acts: reached, force, column."""
    if support.stands:
        return f"reached  nothing needed  {level(support.pre_ie)}"
    lines = []
    for acts in support.options.acts:
        best = support.least(acts)
        if best is not None:
            line = f"{acts}  reached  {size_number(best.use_kn or 0.0)} {support.unit}  on {best.column}"
            lines.append(f"{line}  toward {line_in_words(best.toward)}")
        else:
            codes = dict.fromkeys(said.code for one in support.held if one.acts == acts for said in one.notices)
            lines.append("  ".join([acts, "not reached", *codes]))
    return "\n".join(lines)


def _target(support: ColumnSupport) -> list[str]:
    now = f"as it stands {level(support.pre_ie)} by PRE-IE"
    now += "" if support.closed_form is None else f", {level(support.closed_form)} by Goodman & Bray"
    wanted = wanted_in_words(support.design, support.target)
    entries = [f"{wanted}; {now}: {status_words(support.design, support.pre_ie.status)}"]
    return [*entries, "reached: no more support is needed"] if support.stands else entries


def _held(support: ColumnSupport, one: HoldingForce) -> list[str]:
    said = [] if one.closed_form is None else [needed(one.closed_form, support.unit, "Goodman & Bray")]
    said.append(needed(one.pre_ie, support.unit, "PRE-IE"))
    x, _, z = one.at
    lines = [
        f"{one.column}, {_WHERE[one.where]}: {';  '.join(said)}",
        f"toward {line_in_words(one.toward)}, {one.height:.4g} m above its base on its outer side "
        f"(x {millimetre(x)}, z {millimetre(z)})",
    ]
    if one.use_kn:
        capacity = support.options.capacity
        lines.append(f"one anchor of {capacity:g} kN every {capacity / one.use_kn:.3g} m along the slope")
    return [*lines, *map(str, one.notices)]


def _by_column(support: ColumnSupport) -> Table[ByColumn]:
    columns: list[Column[ByColumn]] = [
        Column("column", attrgetter("column"), "column", width=-10),
        Column("acts at", attrgetter("height"), "height_m", "m", ".4g", width=10),
        Column("force", attrgetter("force"), "force_kn", support.unit, _size, width=14),
    ]
    return Table(columns, support.columns)


def _size(value: float | None) -> str:
    return "never enough" if value is None else size_number(value)


def _cases(support: ColumnSupport) -> Table[HoldingForce]:
    columns: list[Column[HoldingForce]] = [
        Column("anchor is", attrgetter("acts"), "acts"),
        Column("column", attrgetter("column"), "column"),
        Column("height", attrgetter("height"), "height_m", "m"),
        Column("Goodman & Bray", lambda one: one.closed_form and one.closed_form.force, "closed_form_kn", support.unit),
        Column("PRE-IE", attrgetter("pre_ie.force"), "pre_ie_kn", support.unit),
        Column("to use", attrgetter("use_kn"), "use_kn", support.unit),
        Column("reached", attrgetter("reached"), "reached", show=lambda reached: "yes" if reached else "no"),
    ]
    return Table(columns, support.held, said="")


def _use(support: ColumnSupport) -> list[str]:
    lines = []
    for acts in support.options.acts if support.held else ():
        best = support.least(acts)
        if best is None:
            lines.append(f"{acts}: the target is not reached on any of these columns; see above")
            continue
        why = "the larger of both methods" if best.closed_form is not None else "PRE-IE's"
        lines.append(f"{acts}: {size_number(best.use_kn or 0.0)} {support.unit} on {best.column}   ({why})")
    return lines


def _paste(support: ColumnSupport) -> list[Entry]:
    thick = support.thickness
    per = "" if thick == 1.0 else f" (for the {thick:g} m of this design)"
    entries: list[Entry] = []
    for name, text in support.files().items():
        entries += [f"{name.removesuffix('.yaml')}, in place of `support` in the design{per}:", Verbatim(text)]
    return entries
