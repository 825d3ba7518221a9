"""The sheet of support: what each method needs, how it is built, and which number to use; 100 columns."""

import math
from operator import attrgetter

from slopekit.core.sheet import Column, Entry, Section, Sheet, Table, Verbatim, counted, factor_text
from slopekit.design.common import Design
from slopekit.kinds.sheets.bolts import schedule, schedule_entries
from slopekit.kinds.words import bolt_text, line_in_words, size_number
from slopekit.studies.support.records import BoltCase, FacePressure, Need, Pattern, Support, wanted_in_words
from slopekit.studies.support.search import Answer
from slopekit.studies.words import head, status_words

_ROLES = {"active": "a load, in full", "passive": "strength: capacity divided by FoS"}
_WHICH = {
    "given": "the direction given",
    "practical": "optimum within the allowed plunge",
}
_FEW = 12  # bolts that are printed to be pasted


def sheet_of(support: Support) -> Sheet:
    """The sheet of a support study."""
    roles = [_role(support, acts) for acts in ("active", "passive")]
    cases = _cases(support)
    return Sheet(head(support.design, "support"), (
        Section("TARGET", _target(support)),
        Section("BOLTS", _own_bolts(support.design)),
        *roles,
        Section("PRESSURE", _pressure(support.pressure) if support.pressure is not None else ()),
        Section("CASES", [cases] if cases.rows else []),
        Section("USE", _use(support)),
        Section("NOTE", [str(notice) for notice in support.warnings]),
        Section("PASTE", _paste(support)),
        Section("TIME", [f"{support.seconds:.2f} s"]),
    ), {"support.csv": cases})  # fmt: skip


def _role(support: Support, acts: str) -> Section:
    """Return what bolts of one kind of action need: how they are built, the lengths and moments in the full sheet."""
    cases = [case for case in support.cases if case.acts == acts]
    if not cases:
        return Section(acts.upper(), [])
    entries, details = [_ROLES[acts]], list[str]()
    for case in cases:
        shown, more = _case(support, case)
        entries += shown
        details += more
    return Section(acts.upper(), entries, details=details)


def _own_bolts(design: Design) -> list[Entry]:
    """The bolts that the design has: the schedule of its result, or a few without a head one by one."""
    of_result = schedule_entries(schedule({"inputs": design.inputs()}))
    return of_result or [bolt_text(bolt) for bolt in design.bolts]


def line_of(support: Support) -> str:
    """A line for each way the bolts act: reached, force, direction, bolts."""
    if support.stands:
        return f"reached  nothing needed  {level(support.pre_ie)}"
    lines = []
    for case in support.cases:
        parts = [case.acts, "reached" if case.reached else "not reached"]
        parts += [] if case.force is None else [f"{size_number(case.force)} {support.unit}"]
        parts += [] if case.toward is None else [f"toward {line_in_words(case.toward)}"]
        pattern = case.pattern
        if pattern is not None and pattern.layout is not None:
            parts.append(f"{len(pattern.layout)} {'rows' if support.unit == 'kN/m' else 'bolts'}")
        needs = [need.notice for need in (case.closed_form, case.pre_ie) if need and need.notice]
        parts += list(dict.fromkeys(notice.code for notice in (*needs, *(pattern.notices if pattern else ()))))
        lines.append("  ".join(parts))
    return "\n".join(lines)


def _cases(support: Support) -> Table[BoltCase]:
    """What the sections of active and passive bolts say, in rows; text has the sections."""

    def laid(case: BoltCase, what: str) -> int | None:
        layout = case.pattern.layout if case.pattern is not None else None
        return None if layout is None else len(layout) if what == "bolts" else getattr(layout, what)

    def put_back(case: BoltCase) -> float | None:
        need = case.pattern.need if case.pattern is not None and case.pattern.need is not None else case.pre_ie
        return None if need is None else need.fos

    columns: list[Column[BoltCase]] = [
        Column("bolts are", attrgetter("acts"), "acts"),
        Column("direction", attrgetter("which"), "direction"),
        Column("toward", lambda case: None if case.toward is None else line_in_words(case.toward), "toward"),
        Column("closed form", attrgetter("closed_form.force"), "closed_form_kn", support.unit, _size),
        Column(
            "PRE-IE", lambda case: None if case.pre_ie is None else case.pre_ie.force, "pre_ie_kn", support.unit, _size
        ),
        Column("to use", attrgetter("use_kn"), "use_kn", support.unit, _size),
        Column("FoS put back", put_back, "fos", show=".4f"),
        Column("reached", attrgetter("reached"), "reached", show=_yes),
        Column("heads", lambda case: laid(case, "bolts"), "bolts"),
        Column("rows", lambda case: laid(case, "rows"), "rows"),
        Column("columns", lambda case: laid(case, "columns"), "columns"),
        Column("of each", lambda case: None if case.pattern is None else case.pattern.each, "each_kn", "kN", _size),
    ]
    return Table(columns, support.cases, said="")


def _yes(reached: bool) -> str:
    return "yes" if reached else "no"


def _size(value: float | None) -> str:
    return "" if value is None else size_number(value)


def _needed_by_both(one: BoltCase | FacePressure, unit: str) -> str:
    if needed(one.closed_form, unit, "") == needed(one.pre_ie, unit, ""):
        return f"{needed(one.pre_ie, unit, '').strip()} by both methods"
    return f"{needed(one.closed_form, unit, 'closed form')};  {needed(one.pre_ie, unit, 'PRE-IE')}"


def _need_notices(one: BoltCase | FacePressure) -> list[str]:
    """What is to be known of what each method needs."""
    return [str(need.notice) for need in (one.closed_form, one.pre_ie) if need and need.notice]


def level(answer: Answer) -> str:
    """The factor of an answer."""
    return "no FoS" if answer.factor is None else f"FoS {factor_text(answer.factor)}"


def _target(support: Support) -> list[str]:
    bare = support.pre_ie
    now = f"as it stands {level(bare)} by PRE-IE, {level(support.closed_form).removeprefix('FoS ')} by the closed form"
    entries = [f"{wanted_in_words(support.design, support.target)}; {now}: {status_words(support.design, bare.status)}"]
    if bare.moments_govern:
        entries.append("moments govern: the closed form knows none, PRE-IE's numbers are those to use")
    if support.stands:
        entries.append("reached: no more support is needed")
    return entries


def _case(support: Support, case: BoltCase) -> tuple[list[str], list[str]]:
    """Return the lines of a case and those of the full sheet."""
    head = _WHICH[case.which]
    if case.toward is None:
        return [f"{head}: none.  {case.closed_form.notice}"], []
    lines = [f"{head} {line_in_words(case.toward)}: {_needed_by_both(case, support.unit)}", *_need_notices(case)]
    needed_by_moments, details = case.pre_ie, list[str]()
    if (
        case.which != "given"
        and needed_by_moments is not None
        and (needed_by_moments.force is None or needed_by_moments.force > 1.05 * (case.closed_form.force or 0.0))
    ):
        lines.append(
            "the optimum is that of the forces only: where the block turns, PRE-IE may need less in another direction, "
            "for example normal to the face (--toward)"
        )
    if case.most is not None and case.pattern is not None:
        details.append(
            f"no more than {size_number(case.most)} {support.unit}: beyond that FoS falls below the target again"
        )
    if case.pattern is not None:
        shown, more = _pattern(support, case, case.pattern)
        lines += shown
        details += more
    return lines, details


def needed(need: Need | None, unit: str, name: str) -> str:
    """What a method needs, and the factor with it."""
    if need is None:
        return f"{name} not asked"
    if need.force is None:
        return f"{name} not reached" + (f" (at best FoS {factor_text(need.fos)})" if need.fos is not None else "")
    fos = "stands" if need.fos is None else f"FoS {factor_text(need.fos)}"
    if need.force == 0.0:
        return f"{name} needs none ({fos} as it is)"
    return f"{name} {size_number(need.force)} {unit} ({fos})"


def _pattern(support: Support, case: BoltCase, pattern: Pattern) -> tuple[list[str], list[str]]:
    """Return the lines of a bolt pattern on the face and those of the full sheet."""
    laid = pattern.layout
    if laid is None:
        return [f"on the face: none.  {notice}" for notice in pattern.notices], []
    lines, details = [str(notice) for notice in pattern.notices], _with_moments(support, pattern)
    if pattern.each is not None:
        lines.append(f"{_rows(support, pattern)}; equivalent face pressure {pattern.per_m2:.4g} kPa")
    if laid.left_out:
        lines.append(f"{counted(laid.left_out, 'place')} on the face left out: bolts from there miss the block")
    low, high = pattern.taken.min(), pattern.taken.max()
    drilled = f"{low:.4g} m" + (f" to {high:.4g} m" if high > low else "")
    lines.append(f"length {drilled}, {support.options.bond:g} m of it anchorage behind the joint")
    if case.factors is not None:
        limit, closed_form = factor_text(case.factors.limit), factor_text(case.factors.closed_form)
        lines.append(f"check with these bolts: FoS {limit} by PRE-IE, {closed_form} by the closed form")
    is_turning = pattern.need is not None and pattern.need.moments_govern
    if pattern.groups < len(laid) and case.acts == "passive" and is_turning:
        details.append(f"PRE-IE took the {len(laid)} bolts as {pattern.groups} groups, each at the middle of its heads")
    return lines, details


def _with_moments(support: Support, pattern: Pattern) -> list[str]:
    """Return what the force gives with the heads on the face, and the least lengths."""
    details: list[str] = []
    if pattern.first is not None and pattern.asked is not None:
        level_ = "nothing drives the block" if math.isinf(pattern.first) else f"FoS {factor_text(pattern.first)}"
        text = f"heads on the face: at {size_number(pattern.asked)} {support.unit} PRE-IE gives {level_}"
        if pattern.force is not None and abs(pattern.force / pattern.asked - 1.0) > 1e-6:
            text += f" with their moments; {size_number(pattern.force)} {support.unit} reach the target"
        details.append(text)
    shortest, longest = pattern.lengths.min(), pattern.lengths.max()
    span = f"{shortest:.4g} m" if len(pattern.lengths) == 1 else f"{shortest:.4g} m (shortest) to {longest:.4g} m"
    return [*details, f"least length {span}"]


def _rows(support: Support, pattern: Pattern) -> str:
    """Return the number of bolts, their rows and columns, and the force in each."""
    laid = pattern.layout
    assert laid is not None
    assert pattern.each is not None
    if support.unit == "kN/m":
        rows = "1 row" if laid.rows == 1 else f"{laid.rows} rows, {laid.up_m:.3g} m from row to row"
        bolts = f"{rows}, a bolt every {laid.across_m:.4g} m along the slope"
    else:
        needed_count = "" if laid.needed == len(laid) else f" ({laid.needed} would do by their capacity)"
        rows = f"{counted(laid.rows, 'row')} and {counted(laid.columns, 'column')}"
        apart = f", {laid.across_m:.4g} m apart" if len(laid) > 1 else ""
        bolts = f"{counted(len(laid), 'bolt')}{needed_count} in {rows}{apart}"
    return f"{bolts}, {size_number(pattern.each)} of {support.options.capacity:g} kN in each"


def _pressure(pressure: FacePressure) -> list[str]:
    where = f"uniform, normal to the face ({line_in_words(pressure.toward)})"
    return [f"{where}: {_needed_by_both(pressure, 'kPa')}", *_need_notices(pressure)]


def _use(support: Support) -> list[str]:
    lines = []
    for case in support.cases:
        if case.toward is None or case.force is None:
            lines.append(f"{case.acts}: the target is not reached; see above")
            continue
        if case.bolts and case.lacks:
            lines.append(f"{case.acts}: {case.lacks}")
            continue
        closed = case.closed_form.force or 0.0
        why = "both methods"
        if support.dilates:
            why = "PRE-IE's: the joints dilate, which the closed form does not know"
        elif case.force > closed * (1.0 + 1e-6):
            why = f"moments govern: the closed form's {size_number(closed)} {support.unit} are not enough"
            if not closed:
                why = "moments govern: the closed form sees nothing to hold"
        lost = case.pattern is not None and not case.pattern.reached
        but = " as a force through the centroid; the bolts above do not reach the target" if lost else ""
        lines.append(
            f"{case.acts}: {size_number(case.force)} {support.unit} toward {line_in_words(case.toward)}{but}   ({why})"
        )
    if support.pressure is not None and support.pressure.use is not None:
        lines.append(f"pressure: {size_number(support.pressure.use)} kPa")
    return lines


def _paste(support: Support) -> list[Entry]:
    """The bolts as YAML, to be pasted."""
    entries: list[Entry] = []
    for case in support.cases:
        if case.yaml is None:
            entries += [f"{case.acts}: nothing to paste. {case.lacks}"] if case.lacks else []
            continue
        count = len(case.existing) + len(case.bolts)
        if count > _FEW:
            entries.append(f"{case.acts}: {count} bolts; -o DIR writes them to support-{case.acts}.yaml")
            continue
        each = " (each row's bolts, per metre of slope)" if support.unit == "kN/m" else ""
        entries += [f"{case.acts}, in place of `support` in the design{each}:", Verbatim(case.yaml)]
    return entries
