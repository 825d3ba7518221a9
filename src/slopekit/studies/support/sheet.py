"""The sheet of a support study: what each method needs, how it is built, and which number to use."""

from operator import attrgetter

from slopekit.core.sheet import Column, Entry, Section, Sheet, Table, Verbatim, counted, factor_text
from slopekit.kinds.sheets.bolts import schedule, schedule_entries
from slopekit.kinds.words import alike, bolt_text, line_in_words, short, size_number
from slopekit.studies.support.pattern import Layout
from slopekit.studies.support.records import BoltCase, Support, target_in_words
from slopekit.studies.support.search import Answer
from slopekit.studies.words import status_words, study_sheet

_ROLES = {"active": "a load, in full", "passive": "strength: capacity divided by FoS"}
_FEW = 12  # most bolts that the sheet prints for pasting


def sheet_of(support: Support) -> Sheet:
    """The sheet of a support study."""
    cases, design = _cases(support), support.design
    pressure = (
        []
        if support.pressure is None
        else [f"equivalent face pressure {short(support.pressure)} kPa"]
    )
    return study_sheet(
        support.design,
        "support",
        (
            Section("TARGET", _target(support)),
            Section(
                "BOLTS",
                schedule_entries(schedule({"inputs": design.inputs()}))
                or [*map(bolt_text, design.bolts)],
            ),
            *(
                Section(case.acts.upper(), [_ROLES[case.acts], *_case(support, case)])
                for case in support.cases
            ),
            Section("PRESSURE", pressure),
            Section("CASES", [cases] if cases.rows else []),
            Section("NOTE", [str(notice) for notice in support.warnings]),
            Section("PASTE", _paste(support)),
            Section("TIME", [f"{support.seconds:.2f} s"]),
        ),
        {"support.csv": cases},
    )


def line_of(support: Support) -> str:
    """Return a line each for active and passive bolts: reached or not, force, direction, number of bolts."""
    if support.stands:
        return f"reached  nothing needed  {level(support.pre_ie)}"
    lines = []
    for case in support.cases:
        entries = [
            case.acts,
            "reached" if case.reached else "not reached",
            "" if case.force is None else f"{size_number(case.force)} {support.unit}",
            "" if case.toward is None else f"toward {line_in_words(case.toward)}",
            ""
            if case.layout is None
            else f"{len(case.layout)} {'rows' if support.unit == 'kN/m' else 'bolts'}",
            *(f"NOT REACHED in {name}" for name, trial in case.trials.items() if trial.lacks),
            *dict.fromkeys(notice.code for notice in case.all_notices),
        ]
        lines.append("  ".join(filter(None, entries)))
    return "\n".join(lines)


def _cases(support: Support) -> Table[BoltCase]:
    """Return the active and passive bolts as a table for CSV and JSON; the text has sections instead."""
    size = alike(force for case in support.cases for force in (case.closed_form.force, case.force))
    columns: list[Column[BoltCase]] = [
        Column("bolts are", attrgetter("acts"), "acts"),
        Column(
            "toward",
            lambda case: None if case.toward is None else line_in_words(case.toward),
            "toward",
        ),
        Column(
            "closed form", attrgetter("closed_form.force"), "closed_form_kn", support.unit, size
        ),
        Column(
            "PRE-IE",
            lambda case: None if case.pre_ie is None else case.pre_ie.force,
            "pre_ie_kn",
            support.unit,
            size,
        ),
        Column("to use", attrgetter("force"), "use_kn", support.unit, size),
        Column(
            "FoS",
            lambda case: None if case.factors is None else case.factors.limit,
            "fos",
            show=".4f",
        ),
        Column(
            "reached",
            attrgetter("reached"),
            "reached",
            show=lambda is_reached: "yes" if is_reached else "no",
        ),
        Column("bolts", lambda case: None if case.layout is None else len(case.layout), "bolts"),
        Column("of each", attrgetter("each"), "each_kn", "kN", _size),
    ]
    return Table(columns, support.cases, said="")


def _size(value: float | None) -> str:
    return "" if value is None else short(value)


def level(answer: Answer) -> str:
    """Return the factor of an answer in words."""
    return "no FoS" if answer.factor is None else f"FoS {factor_text(answer.factor)}"


def _target(support: Support) -> list[str]:
    bare = support.pre_ie
    present = (
        f"as it stands {level(bare)} by PRE-IE, "
        f"{level(support.closed_form).removeprefix('FoS ')} by the closed form"
    )
    entries = [
        f"{target_in_words(support.design, support.target)}; {present}: {status_words(support.design, bare.status)}"
    ]
    if bare.moments_govern:
        entries.append(
            "moments govern: the closed form knows none, PRE-IE's numbers are those to use"
        )
    if support.stands:
        entries.append("reached: no more support is needed")
    return entries


def _case(support: Support, case: BoltCase) -> list[str]:
    """Return what bolts of one way to act need, and how they are built."""
    notices = [*map(str, case.all_notices), *([case.lacks] if case.lacks else [])]
    if case.toward is None:
        return notices
    chosen = (
        "the direction given" if support.options.toward else "optimum within the allowed plunge"
    )
    unit, closed, limit = support.unit, case.closed_form.force, case.pre_ie
    forces = (
        f"{_size(closed)} {unit} (closed form)"
        if closed is not None
        else "not reached by the closed form"
    )
    if limit is not None:
        forces += (
            f", {_size(limit.force)} (PRE-IE)"
            if limit.force is not None
            else ", not reached by PRE-IE"
        )
    forces += (
        f"; to use: {_size(case.force)}" if _size(case.force) not in ("", _size(closed)) else ""
    )
    lines = [f"{chosen} {line_in_words(case.toward)}: {forces}", *notices]
    if case.layout is None or case.each is None:
        return lines
    lines.append(_pattern_text(support, case.layout, case.each))
    if case.layout.left_out:
        lines.append(
            f"{counted(case.layout.left_out, 'place')} on the face left out: bolts from there miss the block"
        )
    low, high = case.lengths.min(), case.lengths.max()
    drilled = f"{low:.4g} m" + (f" to {high:.4g} m" if high > low else "")
    lines.append(f"length {drilled}, {support.options.bond:g} m of it anchorage behind the joint")
    if case.factors is not None:
        by_pre_ie, by_forces = (
            factor_text(case.factors.limit),
            factor_text(case.factors.closed_form),
        )
        lines.append(
            f"check with these bolts: FoS {by_pre_ie} by PRE-IE, {by_forces} by the closed form"
        )
    return [*lines, *([case.trial_words] if case.trial_words else [])]


def _pattern_text(support: Support, layout: Layout, bolt_force: float) -> str:
    """Return the number of bolts, their rows and columns, and the force in each."""
    if support.unit == "kN/m":
        rows = (
            "1 row"
            if layout.rows == 1
            else f"{layout.rows} rows, {layout.up_m:.3g} m from row to row"
        )
        bolts = f"{rows}, a bolt every {layout.across_m:.4g} m along the slope"
    else:
        needed_count = (
            "" if layout.needed == len(layout) else f" ({layout.needed} would do by their capacity)"
        )
        rows = f"{counted(layout.rows, 'row')} and {counted(layout.columns, 'column')}"
        spacing = f", {layout.across_m:.4g} m apart" if len(layout) > 1 else ""
        empty = layout.rows * layout.columns - len(layout)
        spacing += f" (the other {empty} places of that grid stay empty)" if empty else ""
        bolts = f"{counted(len(layout), 'bolt')}{needed_count} in {rows}{spacing}"
    return f"{bolts}, {size_number(bolt_force)} of {support.options.capacity:g} kN in each"


def _paste(support: Support) -> list[Entry]:
    """Return the bolts as YAML to paste into the design."""
    entries: list[Entry] = []
    for case in support.cases:
        if case.yaml is None:
            continue
        count = len(case.existing) + len(case.bolts)
        if count > _FEW:
            file = f"support-{case.acts}.yaml"
            entries.append(
                f"{case.acts}: {count} bolts with those of the design; -o DIR writes them to {file}"
            )
            continue
        per_metre = " (each row's bolts, per metre of slope)" if support.unit == "kN/m" else ""
        entries += [
            f"{case.acts}, in place of `support` in the design{per_metre}:",
            Verbatim(case.yaml),
        ]
    return entries
