"""The sheet of many blocks: what moves, how, in what order; short even for ten thousand blocks."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from slopekit.core.sheet import counted, factor_text
from slopekit.findings import (
    MOTIONS,
    SAME_FACTOR,
    AssemblyGeometry,
    Column,
    Findings,
    GoverningInterface,
    Mechanism,
    at_once,
)
from slopekit.kinds import dilates
from slopekit.kinds.words import SheetPart, first_and_last, in_order, line_in_words, names_in_runs, size_number
from slopekit.orientation import line_of
from slopekit.result import Result
from slopekit.views.entries import (
    accept,
    all_pairs,
    curved_strength,
    forces,
    governs,
    leading,
    methods,
    series,
    verdict,
)

_PLURALS = {"slides": "slide", "topples": "topple", "rotates": "turn", "falls": "fall", "lifts": "are lifted"}
_WAYS = {
    "slides": "slide", "slides_up": "slide up", "topples": "topple", "rotates": "turn", "falls": "fall",
    "lifted": "lift", "no_driving_force": "stand", "not_converged": "unknown",
}  # fmt: skip
_MODES = {"slip": "slips", "open": "slips and opens", "stick": "sticks", "pull": "pulls"}
_MOST_INTERFACES = 6
_SHARE = 1e-3  # of the work: less is not worth a line
_WHOLE = 1e-6  # shares that add up to one but for this
_MOST_FACTORS = 6
_FIRST_MECHANISMS, _LAST_MECHANISMS = 8, 2
#: What is checked, in words about its figure.
_CHECKS: Mapping[str, str] = {
    "volume_error": "the blocks' volumes add up to the rock's but for {} of it",
    "area_error": "the two sides of the joints differ by {} of their area",
    "plane_error_m": "corners at most {} m off their planes",
    "largest_unbalanced_force": "largest unbalanced force {} of the load",
}
_MEASURED = 1e-2  # what is as large is no rounding error
_UNITS = {"m3": "m³", "m2": "m²", "m": "m", "kn": "kN", "kpa": "kPa", "deg": "°", "s": "s", "mb": "MB"}
_MOST_ROWS, _FIRST_ROWS, _LAST_ROWS = 40, 20, 10


def assembly_parts(result: Result, findings: Findings) -> Iterator[SheetPart]:
    """The parts of the sheet below what was analysed, in order; those without entries print nothing."""
    order = _order(result)
    first = findings.mechanisms[0] if findings.mechanisms else None
    yield SheetPart("FORCES", forces(result))
    yield SheetPart("STATUS", [_status(result, findings, order)])
    yield SheetPart("FoS", _factors(result))
    yield SheetPart("STRENGTH", curved_strength(result))
    yield SheetPart("ALL PAIRS", all_pairs(result))
    yield SheetPart("ACCEPT", accept(result))
    yield SheetPart("MOVES", _moves(result, first))
    yield SheetPart("NEXT", _next(result, findings, order), hang=32)
    yield SheetPart("BY BLOCK", _by_block(findings, order))
    yield SheetPart("TABLE", toppling_rows(result, findings.table))
    yield SheetPart("METHODS", methods(result))
    yield SheetPart("SERIES", series(result))
    yield SheetPart("CHECKS", _checks(result, findings, first))
    yield SheetPart("MODEL", _model(result))
    yield SheetPart("TIME", [_time(result.timing_s)] if result.timing_s else [])
    yield SheetPart("GOVERNS", governs(result))
    yield SheetPart("DEFAULTS", _defaults(result))
    yield SheetPart("NOTE", [str(notice) for notice in result.warnings])


def _order(result: Result) -> dict[str, int]:
    geometry = result.geometry
    names = geometry.names if isinstance(geometry, AssemblyGeometry) else ()
    return {name: k for k, name in enumerate(names)}


# -- the answer -----------------------------------------------------------------------------------------------------


def _status(result: Result, findings: Findings, order: Mapping[str, int]) -> str:
    if not findings.mechanisms or not findings.mechanisms[0].blocks:
        return result.status_text
    first = findings.mechanisms[0]
    words = _motions(first, order)
    still = findings.blocks - findings.fixed - len(first.blocks)
    if still > 0:
        words += f", {still} {'stays' if still == 1 else 'stay'}"
    return _joined(result.status_text, words)


def _joined(status: str, words: str) -> str:
    return f"{status}{';' if ':' in status else ':'} {words}" if words else status


def _motions(mechanism: Mechanism, order: Mapping[str, int]) -> str:
    """How many blocks move in which way, and which: the most frequent way first."""
    ways: dict[str, list[str]] = {}
    for block in mechanism.blocks:
        ways.setdefault(block.how, []).append(block.name)
    words = []
    for how, names in sorted(ways.items(), key=lambda way: -len(way[1])):
        verb = MOTIONS.get(how, how) if len(names) == 1 else _PLURALS.get(how, how)
        words.append(f"{len(names)} {verb} ({names_in_runs(in_order(names, order))})")
    return ", ".join(words)


def _factors(result: Result) -> list[str]:
    fos, dilating = result.fos, dilates(result.design)
    compared = fos.closed_form is not None or result.agree is not None
    limit = f"{factor_text(fos.limit)}  {limit_in_words(result)}{', joints dilate as given' if dilating else ''}"
    if fos.limit is None:
        limit += f": {result.status_text}"
    entries = [*leading(result), limit]
    if compared:
        zero = ", zero dilation" if dilating else ""
        closed = f"{factor_text(fos.closed_form)}  {result.words.closed_form}{zero}"
        entries.append(f"{closed}       {verdict(result)}")
    else:
        instead = "; the static bound is an upper bound, no answer" if fos.static_bound is not None else ""
        entries.append(f"  none  closed form: {result.words.no_closed_form}{instead}")
    if fos.lowest is not None or fos.highest is not None:
        ends = f"{factor_text(fos.lowest).strip()} .. {factor_text(fos.highest).strip()}"
        entries.append(f"{ends}  same mechanism, whatever forces are locked in")
    elif fos.limit is not None:
        entries.append("  none  same mechanism, whatever forces are locked in: no range was found")
    if fos.static_bound is not None:
        above = ""
        if fos.limit:
            more = (fos.static_bound / fos.limit - 1.0) * 100
            above = f", {more:.1f} % above the limit" if more >= 0.05 else ", no higher than the limit"
        proved = "" if result.static_bound_proved else ", not proved"
        entries.append(
            f"{factor_text(fos.static_bound)}  static bound (joints free to dilate; upper bound{proved}){above}"
        )
    elif fos.limit is not None:
        entries.append("  none  static bound: not found")
    if fos.all_pairs_failed is not None:
        entries.append(
            f"{factor_text(fos.all_pairs_failed)}  all pairs failed (no block is tied to bedrock by sticking pairs; "
            "depends on the stiffness)"
        )
    elif result.design.criterion == "all-pairs":
        entries.append("  none  all pairs failed: asked for, and not found")
    return entries


def limit_in_words(result: Result) -> str:
    """What the headline is: of many blocks the limit of the elastic path, or where it was last at rest."""
    findings = result.findings
    if findings is None:
        return "limit, PRE-IE"
    ratio = findings.shear_to_normal
    if not findings.mechanisms:
        return path_in_words("none", ratio)
    first = findings.mechanisms[0]
    return path_in_words(first.basis, ratio, first.fos, first.change)


def _moves(result: Result, first: Mechanism | None) -> list[str]:
    """The first mechanism: the fastest block, the interfaces that govern, the node pairs."""
    if first is None or not first.blocks:
        return _settles(result)
    fastest = first.blocks[0]
    goes = ""
    if float(np.abs(fastest.displacement).max()) > 0.0:
        geometry = result.geometry
        in_section = isinstance(geometry, AssemblyGeometry) and geometry.thickness_m is not None
        axis = " (x is 090)" if in_section else ""
        goes = f" toward {line_in_words(line_of(fastest.displacement))}{axis}"
    entries = [f"fastest {fastest.name}, which {MOTIONS.get(fastest.how, fastest.how)}{goes}"]
    entries += _governing(first.interfaces)
    entries += _pairs(first.pairs_by_mode)
    return entries + _settles(result)


def _settles(result: Result) -> list[str]:
    """The block that moves most at full strength."""
    one = result.at_factor_one
    if one is None or one.block is None:
        return []
    size = float(np.sqrt(one.movement.displacement @ one.movement.displacement))
    bed = result.design.stiffness.in_words()
    return [f"at full strength {one.block} settles most, by {1e3 * size:.3g} mm (elastic bed: {bed})"]


def _governing(interfaces: Sequence[GoverningInterface]) -> list[str]:
    """The interfaces that govern with their shares; those left out by the rest of the work."""
    if not interfaces:
        return []
    shown = [one for one in interfaces[:_MOST_INTERFACES] if one.share >= _SHARE] or interfaces[:1]
    wide, joints, modes = (
        max(map(len, words))
        for words in zip(*((one.name, one.joint, _MODES.get(one.mode, one.mode)) for one in shown), strict=True)
    )
    bolts = any(one.mode == "pull" for one in interfaces)
    lost, by = (
        ("friction, cohesion and bolts", "interface and bolt") if bolts else ("friction and cohesion", "interface")
    )
    entries = [f"share of the work lost in {lost}, by {by}:"]
    for one in shown:
        pressure = f" ({one.normal_kn / one.area_m2:.4g} kPa)" if one.area_m2 else ""
        sign = "T" if one.mode == "pull" else "N'"
        entries.append(
            f"{one.share * 100:5.1f} %  {one.name:<{wide}}  {one.joint:<{joints}}  "
            f"{_MODES.get(one.mode, one.mode):<{modes}}  {sign} {size_number(one.normal_kn)} kN{pressure}"
        )
    rest = 1.0 - sum(one.share for one in shown)
    if rest > _WHOLE:
        are_all = sum(one.share for one in interfaces) > 1.0 - _WHOLE
        which = f"and {len(interfaces) - len(shown)} more" if are_all else "the others"
        share = f"{rest * 100:5.1f}" if rest >= _SHARE else f"{'< 0.1':>5}"
        entries.append(f"{share} %  ... {which} together")
    return entries


def _pairs(by_mode: Mapping[str, int]) -> list[str]:
    """How many node pairs stick, slip and are open, of all."""
    if not by_mode:
        return []
    verbs = {"stick": "stick", "slip": "slip", "open": "are open"}
    parts = [f"{count} {verbs.get(mode, mode)}" for mode, count in by_mode.items()]
    return [f"of {sum(by_mode.values())} node pairs " + ", ".join(parts)]


# -- what comes after -----------------------------------------------------------------------------------------------


def _next(result: Result, findings: Findings, order: Mapping[str, int]) -> list[str]:
    """The mechanisms in the order in which they happen, and what is left."""
    mechanisms = findings.mechanisms
    left = [findings.standing] if findings.standing else []
    if len(mechanisms) < 2:
        return left
    highest: float | None = None
    rows = []
    for k, one in enumerate(mechanisms, 1):
        at_once = k > 1 and _follows_at_once(one, highest)
        bound = "none" if one.static_bound is None else factor_text(one.static_bound)
        text = _motions(one, order)
        if one.fos is None or not text:
            text = _joined(result.words.status(one.status), text)
        way = _WAYS.get(one.status, one.status)
        rows.append(f"{k:>3}{factor_text(one.fos):>9}{bound:>9}  {way:<8} " + ("at once: " if at_once else "") + text)
        highest = one.fos if highest is None else max(highest, one.fos or highest)
    shown, between, last = first_and_last(rows, _FIRST_MECHANISMS, _LAST_MECHANISMS)
    entries = ["  n      FoS    bound  mode     what fails, once all that failed before is taken away", *shown]
    if between:
        hidden = mechanisms[len(shown) : len(shown) + between]
        blocks = sum(len(one.blocks) for one in hidden)
        factors = [one.fos for one in hidden if one.fos is not None]
        within = f", FoS {factor_text(min(factors))} to {factor_text(max(factors))}" if factors else ""
        entries.append(f"... {between} more: {counted(blocks, 'block')}{within} ...")
    return [*entries, *last, *left]


def _follows_at_once(one: Mechanism, highest: float | None) -> bool:
    """Whether a mechanism needs no further loss of strength than those before it."""
    if one.fos is None:
        return one.status in ("falls", "lifted")
    return highest is not None and one.fos <= highest * (1.0 + SAME_FACTOR)


def _by_block(findings: Findings, order: Mapping[str, int]) -> list[str]:
    """The lowest factors with the blocks that fail at them, those of mechanisms that follow at once apart."""
    follow = at_once(((one.fos, (b.name for b in one.blocks)) for one in findings.mechanisms), findings.factor_by_block)
    groups: dict[str, list[str]] = {}
    numbers: dict[str, float] = {}
    for name, factor in findings.factor_by_block.items():
        shown = factor_text(factor).strip()
        groups.setdefault(shown, []).append(name)
        if factor is not None:
            numbers[shown] = factor
    if len(groups) < 2:
        return []  # STATUS has said it
    lowest, rest, _ = first_and_last(sorted(numbers, key=lambda shown: numbers[shown]), _MOST_FACTORS, 0)
    parts = []
    for shown in lowest:
        names = in_order(groups.pop(shown), order)
        text = names_in_runs((name for name in names if name not in follow), 2)
        after = names_in_runs((name for name in names if name in follow), 2)
        parts.append(f"{shown} {text}" + (f", then at once {after}" if after else ""))
    without = groups.pop("none", [])
    if rest:
        blocks = sum(len(names) for names in groups.values())
        parts.append(f"... and {counted(blocks, 'block')} up to {factor_text(max(numbers.values()))}")
    if without:
        parts.append(f"without a number {names_in_runs(in_order(without, order), 2)}")
    return [" | ".join(parts)]


# -- the evidence ---------------------------------------------------------------------------------------------------


def _checks(result: Result, findings: Findings, first: Mechanism | None) -> list[str]:
    entries = []
    if first is not None and first.fos is not None:
        steps = counted(result.model.passes, "factorisation", "factorisations")
        settled = (
            "settled" if first.change == 0.0 else f"lies {first.change * 100:.2g} % from a strength at which they run"
        )
        entries.append(f"the limit {settled} after {steps}")
    balanced = result.fos.limit is not None or result.status == "no_driving_force"  # else there were none to balance
    entries += [
        _check(name, value) for name, value in findings.checks.items() if balanced or name != "largest_unbalanced_force"
    ]
    return ["; ".join(entries)] if entries else []


def _check(name: str, value: float) -> str:
    """A check in words; one that has none is named by its key, the unit at its end."""
    if name in _CHECKS:
        return _CHECKS[name].format(f"{value:.2g}")
    shown = size_number(float(f"{value:.4g}")) if abs(value) >= _MEASURED or not value else f"{value:.2g}"
    words, _, unit = name.rpartition("_")
    if unit in _UNITS and words:
        return f"{words.replace('_', ' ')} {shown} {_UNITS[unit]}"
    return f"{name.replace('_', ' ')} {shown}"


def _model(result: Result) -> list[str]:
    model = result.model
    left_out = ", ".join(model.left_out) or "nothing"
    return [
        f"{counted(model.moving_blocks, 'moving block')}, {counted(model.unknowns, 'unknown')}, "
        f"{counted(model.node_pairs, 'node pair')}; left out: {left_out}"
    ]


def _time(timing_s: Mapping[str, float]) -> str:
    parts = []
    for name, seconds in timing_s.items():
        if seconds > 5e-5:
            shown = f"{seconds:.2f} s" if seconds >= 10.0 else f"{seconds * 1e3:.1f} ms"
            parts.append(f"{name.replace('_', ' ')} {shown}")
    return "  ".join(parts)


def _defaults(result: Result) -> list[str]:
    ours = {
        "upper": "upper slope (level)", "length": "length (twice the height)", "depth": "depth (the height)",
        "seismic.trend": f"seismic trend ({result.words.seismic})",
    }  # fmt: skip
    names = [ours.get(name, name) for name in result.design.defaults]
    return [", ".join(names)] if names else []


def path_in_words(basis: str, ratio: float | None, fos: float | None = None, change: float = 0.0) -> str:
    """What a factor of many blocks is.

    Parameters
    ----------
    basis, change : as of `findings.Mechanism`; ratio : k_t / k_n of the elastic joints, None where it is not known

    >>> path_in_words("limit", 0.4)
    'limit of the elastic path (k_t/k_n 0.4)'
    >>> path_in_words("peak", 0.4, 1.6, 0.005)
    'peak of the elastic path (k_t/k_n 0.4): last state at rest; the blocks run at 1.6080, 0.5 % higher'
    """
    path = "the elastic path" if ratio is None else f"the elastic path (k_t/k_n {ratio:g})"
    if basis != "peak":
        return f"limit of {path}" + (", settled" if basis == "settled" else "")
    runs = ""
    if fos is not None and change > 0.0:
        runs = f"; the blocks run at {factor_text(fos * (1.0 + change)).strip()}, {change * 100:.2g} % higher"
    return f"peak of {path}: last state at rest{runs}"


def toppling_rows(result: Result, table: Sequence[Column]) -> list[str]:
    """Goodman & Bray's rows from the highest column down to the toe, with PRE-IE's mode beside theirs."""
    if not table:
        return []
    factor = result.fos.limit or result.fos.closed_form
    at = f"strength divided by {factor_text(factor)}" if factor else "strength as given"
    by_number = sorted(table, key=lambda column: column.n)
    rows = [_row(column) for column in reversed(by_number)]
    shown, between, last = (rows, 0, ()) if len(rows) <= _MOST_ROWS else first_and_last(rows, _FIRST_ROWS, _LAST_ROWS)
    entries = [
        f"Goodman & Bray's columns, {at}; y, M, L in m, P in kN (R and S on the bases: --json)",
        f"{'n':>4}{'y':>8}{'M':>8}{'L':>8}{'P_topple':>12}{'P_slide':>12}{'P':>12}  {'mode':<7} | PRE-IE",
        *shown,
    ]
    if between:
        entries.append(f" ... {between} columns left out here (--json has them) ...")
    alike = sum(column.mode == column.mode_preie for column in table)
    different = [f"C{column.n}" for column in by_number if column.mode != column.mode_preie]
    where = f"; not in {names_in_runs(different)}" if different else ""
    words = f"the modes are the same in {alike} of {len(table)} columns{where}"
    unbounded = any(abs(value) == np.inf for column in table for value in (column.p_topple, column.p_slide) if value)
    note = ["∞: with sides that rough no force between two columns makes a difference"] if unbounded else []
    return [*entries, *last, words, *note]


def _row(column: Column) -> str:
    lengths = "".join(f"{_cell(value, 2):>8}" for value in (column.y, column.m, column.l))
    forces = "".join(f"{_cell(value, 2):>12}" for value in (column.p_topple, column.p_slide, column.p))
    differs = "" if column.mode == column.mode_preie else "  <"
    return f"{column.n:>4}{lengths}{forces}  {column.mode:<7} | {column.mode_preie}{differs}"


def _cell(value: float | None, digits: int) -> str:
    if value is None or np.isnan(value):
        return "-"
    if np.isinf(value):
        return "∞" if value > 0.0 else "-∞"
    return f"{value:.{digits}f}" if abs(value) < 1e8 else f"{value:.5g}"
