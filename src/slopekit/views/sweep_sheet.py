"""Sheets of sweeps: a curve as a table, a grid as a matrix; both with all their points, or as many as fit."""

import csv
import math
import textwrap
from collections.abc import Iterator, Sequence
from io import StringIO

from slopekit._version import __version__
from slopekit.design.common import Design
from slopekit.kinds import status_text
from slopekit.orientation import number
from slopekit.result import STATUSES
from slopekit.studies.keys import Key, in_words
from slopekit.studies.points import Point
from slopekit.studies.solutions import Method, point_record
from slopekit.studies.solve import factor_at
from slopekit.studies.sweep import Critical, Sweep, has_number
from slopekit.studies.tornado import RULE, Tornado, TornadoBar, status_of
from slopekit.views.entries import LABEL, WIDTH, block, factor_text

METHODS: dict[Method, str] = {"pre_ie": "limit, PRE-IE", "closed_form": "closed form"}
_COLUMNS: dict[Method, str] = {"pre_ie": "PRE-IE", "closed_form": "closed form"}
_MOST_ROWS = 100
_CELL = 9
_BRIEF = {"slides_on_both": "both", "no_driving_force": "stands", "not_converged": "no conv"}
_GOES = {"rises": "rises with it", "falls": "falls with it", "stays": "does not depend on it", "turns": "turns around"}
_MOST_LISTED = 12


def sweep_sheet(swept: Sweep) -> str:
    """The sheet of a sweep, lines joined, no trailing newline."""
    lines = head(swept.design, "sweep")
    for key, values in zip(swept.keys, swept.values, strict=True):
        span = f"{key.shown(min(values), 6)} to {key.shown(max(values), 6)}"
        lines += block("KEY", [f"{in_words(key)}; {span}, {counted(len(values), 'value')}"])
    if len(swept.keys) == 1:
        lines += block("CURVE", _curve(swept))
    else:
        lines += block("GRID", _grid(swept), hang=0)
    lines += block("SHAPE", _shape(swept))
    lines += block("PASSES", _critical(swept))
    lines += block("STATUS", _changes(swept))
    lines += block("COUNTED", [_counted(swept)])
    lines += block("REASONS", _reasons(swept))
    lines += block("NOTE", [str(notice) for notice in swept.warnings])
    return "\n".join(lines)


def sweep_line(swept: Sweep) -> str:
    """Points, factors between which they lie, disagreements and notices on one line."""
    parts = [counted(len(swept.points), "point")]
    for method in swept.asked:
        factors = [f for p in swept.points if (f := factor_at(p, method)) is not None and has_number(f)]
        span = f"{factor_text(min(factors)).strip()} to {factor_text(max(factors)).strip()}" if factors else "none"
        parts.append(f"{METHODS[method]} {span}")
    if len(swept.asked) > 1:
        parts.append(f"{swept.disagree} disagree" if swept.disagree else "agree")
    return "  ".join(parts + [notice.code for notice in swept.warnings])


def sweep_csv(swept: Sweep) -> str:
    """Every point on a line of its own."""
    out = StringIO()
    writer = csv.writer(out, lineterminator="\n")
    names = [f"{key.path} ({key.unit})" if key.unit else key.path for key in swept.keys]
    fields = list(point_record(Point(None)))
    writer.writerow([*names, *fields])
    for place, point in zip(swept.places, swept.points, strict=True):
        record = point_record(point)
        writer.writerow([*(repr(value) for value in place), *("" if record[f] is None else record[f] for f in fields)])
    return out.getvalue()


# -- what the sheets of studies share ---------------------------------------------------------------------------------


def head(design: Design, study: str) -> list[str]:
    """The first line: version, study, kind, hash, title."""
    title = f"   {design.title}" if design.title else ""
    text = f"slopekit {__version__}   {study}   {design.kind}   sha {design.input_hash()[:6]}{title}"
    return textwrap.wrap(text, WIDTH, subsequent_indent=" " * LABEL)


def status_words(kind: str, status: str) -> str:
    """A status as a sentence, a code as it is."""
    return status_text(kind, status) if status in STATUSES else status


def counted(count: int, what: str) -> str:
    """So many of something.

    >>> counted(1, "point"), counted(0, "point")
    ('1 point', '0 points')
    """
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def cell(factor: float | None) -> str:
    """A factor in a table; the status says why there is none."""
    return factor_text(factor).strip() if factor is not None and has_number(factor) else "none"


def check_word(point: Point) -> str:
    """What the methods make of each other at a point."""
    factors = point.factors
    if factors is None:
        return ""
    if factors.status == "not_converged":
        return "no convergence"
    word = {True: "agree", False: "DISAGREE", None: ""}[factors.agree]
    extra = ["moments govern"] if factors.moments_govern else []
    extra += [] if factors.settled else ["not settled"]
    return ", ".join([*([word] if word else []), *extra])


# -- a curve ----------------------------------------------------------------------------------------------------------


def _curve(swept: Sweep) -> list[str]:
    key, (_, points) = swept.keys[0], next(iter(swept.lines()))
    shown = _thinned(points, swept)
    two = len(swept.asked) > 1
    title = key.path if len(key.path) <= 22 else "…" + key.path[-21:]
    columns = "".join(f"{_COLUMNS[method]:>12}" for method in swept.asked)
    entries = [f"{title:<23}{'status':<17}{columns}   {'check' if two else ''}".rstrip()]
    before: str | None = None
    for value, point in shown:
        status = swept.status(point)
        mark = ">" if before is not None and status != before else " "  # the status has changed since the row above
        now = " now" if value == key.value else ""
        row = f"{key.shown(value, 8) + now:<21}{mark} "
        if point.factors is None:
            room = WIDTH - LABEL - 23
            entries.append(row + textwrap.shorten(f"{point.code} {point.message}", room, placeholder=" …"))
        else:
            factors = "".join(f"{cell(factor_at(point, method)):>12}" for method in swept.asked)
            entries.append(f"{row}{status:<17}{factors}   {check_word(point)}".rstrip())
        before = status
    if len(shown) < len(points):
        entries.append(f"… {len(points) - len(shown)} more points are left out here: see the JSON or the CSV")
    return entries


def _thinned(points: Sequence[tuple[float, Point]], swept: Sweep) -> list[tuple[float, Point]]:
    """All the points, or so many of them evenly, and those on both sides of a change of status."""
    if len(points) <= _MOST_ROWS:
        return list(points)
    every = math.ceil(len(points) / _MOST_ROWS * 2)
    statuses = [swept.status(point) for _, point in points]
    kept = {k for k in range(len(points)) if k % every == 0} | {0, len(points) - 1}
    changed = [k for k in range(1, len(points)) if statuses[k] != statuses[k - 1]][: _MOST_ROWS // 4]
    return [points[k] for k in sorted(kept | {j for k in changed for j in (k - 1, k)})]


# -- a grid -----------------------------------------------------------------------------------------------------------


def _grid(swept: Sweep) -> list[str]:
    """Factors by the method that counts; columns are the first key, rows the second."""
    first, second = swept.keys
    method = swept.asked[0]
    lines = list(swept.lines())
    across = [value for value, _ in lines[0][1]]
    rows = sorted(lines, key=lambda line: line[0] or 0.0)
    many = (WIDTH - LABEL - 14) // _CELL
    entries = [f"{METHODS[method]}; across {first.path}{_unit(first)}, down {second.path}{_unit(second)}"]
    for begin in range(0, len(across), many):
        entries.append(" " * 12 + "".join(f"{number(round(v, 6)):>{_CELL}}" for v in across[begin : begin + many]))
        for value, points in rows:
            cells = "".join(_mark(swept, point, method) for _, point in points[begin : begin + many])
            entries.append(f"{number(round(value or 0.0, 6)):>12}{cells}")
    if any(point.factors is not None and point.factors.moments_govern for point in swept.points):
        entries.append("* moments govern")
    if swept.disagree:
        entries.append("! the methods disagree, or no convergence")
    return entries


def _unit(key: Key) -> str:
    return f" ({key.unit})" if key.unit else ""


def _mark(swept: Sweep, point: Point, method: Method) -> str:
    factor = factor_at(point, method)
    status = swept.status(point)
    text = cell(factor) if has_number(factor) else _BRIEF.get(status, status)[: _CELL - 2]
    factors = point.factors
    mark = "!" if point.is_in_doubt else "*" if factors is not None and factors.moments_govern else " "
    return f"{text:>{_CELL - 1}}{mark}"


# -- what it comes to -------------------------------------------------------------------------------------------------


def _shape(swept: Sweep) -> list[str]:
    entries, said = list[str](), dict[str, list[str]]()
    with_first = "" if len(swept.keys) == 1 else f" along {swept.keys[0].path}"
    for method in swept.asked:
        shape = swept.shape(method)
        found = [
            (factor, place) for place, point in zip(swept.places, swept.points, strict=True)
            if (factor := factor_at(point, method)) is not None and has_number(factor)
        ]  # fmt: skip
        if not shape or not found:
            entries.append(f"{METHODS[method]}: no curve")
            continue
        least, most = (f"{cell(factor)} at {_place(swept, at)}" for factor, at in (min(found), max(found)))
        said.setdefault(f"{_GOES[shape]}{with_first}; least {least}, greatest {most}", []).append(METHODS[method])
    return [*entries, *(f"{' and '.join(methods)}: {text}" for text, methods in said.items())]


def _place(swept: Sweep, place: tuple[float, ...]) -> str:
    return ", ".join(key.shown(value, 6) for key, value in zip(swept.keys, place, strict=True))


def _critical(swept: Sweep) -> list[str]:
    if len(swept.keys) > 1:
        return _passes_of_a_grid(swept)
    found = swept.critical
    entries = []
    for level, what in swept.levels:
        own = [one for one in found if one.level == level]
        if not own:
            entries.append(f"{what}: not passed between neighbouring points")
        entries += list(_together(swept, what, own))
    if any(one.at is not None and one.how != "at a point" for one in found):
        entries.append(f"interpolated values are rough: slopekit solve finds {swept.keys[0].path} to every digit")
    return entries


def _together(swept: Sweep, what: str, found: Sequence[Critical]) -> Iterator[str]:
    """Each place once, with the methods that pass the level there alike."""
    said: dict[str, list[str]] = {}
    for one in found:
        said.setdefault(_passed(swept, one), []).append(METHODS[one.method])
    for text, methods in said.items():
        yield f"{what}: {text}, by {' and '.join(methods)}"


def _passed(swept: Sweep, one: Critical) -> str:
    key = swept.keys[0]
    a, b = (key.shown(end, 6) for end in one.between)
    if one.at is None:
        return f"between {a} and {b}, {one.how}"
    how = one.how if one.how == "at a point" else f"{one.how} between {a} and {b}"
    return f"{key.shown(one.at, 5)}, {how}"


def _passes_of_a_grid(swept: Sweep) -> list[str]:
    """The first key at which each level is passed, for each value of the second."""
    first, second = swept.keys
    method = swept.asked[0]
    entries = []
    for level, what in swept.levels:
        own = [one for one in swept.critical if one.level == level and one.method == method]
        own.sort(key=lambda one: one.line or 0.0)
        ats = [f"{second.shown(one.line or 0.0, 6)}: {_briefly(first, one)}" for one in own]
        entries.append(f"{what}, {first.path} interpolated: {'; '.join(ats) if ats else 'passed nowhere'}")
    return entries


def _briefly(key: Key, one: Critical) -> str:
    if one.at is not None:
        return key.shown(one.at, 5) + (" (status changes)" if one.how == "across a change of status" else "")
    return f"between {key.shown(one.between[0], 5)} and {key.shown(one.between[1], 5)}"


def _changes(swept: Sweep) -> list[str]:
    changes = swept.changes
    if not changes or len(swept.keys) > 1:
        return [f"{counted(len(changes), 'change')} of status between neighbours: see the JSON"] if changes else []
    key, kind = swept.keys[0], swept.design.kind
    entries = []
    for change in changes[:12]:
        a, b = (key.shown(end, 6) for end in change.between)
        one, other = (status_words(kind, status) for status in change.statuses)
        entries.append(f"between {a} and {b}: {one} -> {other}")
    if len(changes) > 12:
        entries.append(f"… {len(changes) - 12} more changes, see the JSON")
    return entries


def _counted(swept: Sweep) -> str:
    parts = ", ".join(f"{status_words(swept.design.kind, name)} {count}" for name, count in swept.counts.items())
    end = f"; {swept.disagree} disagree or did not converge" if len(swept.asked) > 1 or swept.disagree else ""
    return f"{counted(len(swept.points), 'point')}: {parts}{end}; {swept.seconds:.2f} s"


def _reasons(swept: Sweep) -> list[str]:
    """The first message of each code, for points without a block."""
    found: dict[str, str] = {}
    for place, point in zip(swept.places, swept.points, strict=True):
        if point.factors is None:
            found.setdefault(point.code, f"{point.code} at {_place(swept, place)}: {point.message}")
    return list(found.values())


def tornado_sheet(study: Tornado) -> str:
    """The sheet, lines joined, no trailing newline."""
    lines = head(study.design, "tornado")
    lines += block("RULE", [RULE])
    lines += block("NOW", [_now(study)])
    lines += block("BARS", _bars(study))
    lines += block("NOTHING", _without_effect(study))
    lines += block("STATUS", _statuses(study))
    lines += block("LEFT OUT", _left_out(study))
    end = f"; {study.disagree} disagree or did not converge" if len(study.asked) > 1 or study.disagree else ""
    lines += block("COUNTED", [f"{counted(len(study.points), 'point')}{end}; {study.seconds:.2f} s"])
    lines += block("NOTE", [str(notice) for notice in study.warnings])
    return "\n".join(lines)


def tornado_line(study: Tornado) -> str:
    """The three that do most on one line."""
    first = study.asked[0]
    most = [f"{bar.key.path} {_swing(bar.swings[first])}" for bar in study.bars[:3]]
    agree = [] if len(study.asked) < 2 else [f"{study.disagree} disagree" if study.disagree else "agree"]
    return "  ".join([*most, *agree, *(notice.code for notice in study.warnings)])


def _now(study: Tornado) -> str:
    factors = study.base.factors
    if factors is None:
        return f"no block: {study.base.code} {study.base.message}"
    shown = [f"{cell(factor_at(study.base, method))} {METHODS[method]}" for method in study.asked]
    return "   ".join([status_words(study.design.kind, status_of(study.base, study.asked[0])), *shown,
                       check_word(study.base)]).rstrip()  # fmt: skip


def _bars(study: Tornado) -> list[str]:
    main, *others = study.asked
    moved = [bar for bar in study.bars if bar.swings[main]]
    if not moved:
        return ["no number changes the factor of safety"]
    also = "".join(f"{METHODS[method]:>13}" for method in others)
    entries = [f"{'key':<29}{'from':>11}{'to':>11}{'FoS there':>17}{'swing':>9}{also}".rstrip()]
    for bar in moved:
        path = bar.key.path if len(bar.key.path) <= 28 else "…" + bar.key.path[-27:]
        ends = f"{_number(bar, bar.low):>11}{_number(bar, bar.high):>11}"
        factors = f"{_end(bar.at_low, study):>8} {_end(bar.at_high, study):>8}"
        closed = "".join(f"{_swing(bar.swings[method]):>13}" for method in others)
        entries.append(f"{path:<29}{ends}{factors}{_swing(bar.swings[main]):>9}{closed}".rstrip())
    return entries


def _number(bar: TornadoBar, value: float) -> str:
    unit = bar.key.unit.replace("kN/m³", "").replace("kg/m³", "")
    text = f"{bar.key.reduced(value):.5g}"
    return f"{text}°" if unit == "°" else f"{text} {unit}".strip()


def _end(point: Point, study: Tornado) -> str:
    method = study.asked[0]
    factor = factor_at(point, method)
    return cell(factor) if has_number(factor) else status_of(point, method)[:8]


def _swing(swing: float) -> str:
    return "∞" if math.isinf(swing) else f"{swing:.4f}" if swing < 1e3 else f"{swing:.4g}"


def _without_effect(study: Tornado) -> list[str]:
    first = study.asked[0]
    names = [bar.key.path for bar in study.bars if not bar.swings[first]]
    return [f"changes nothing: {', '.join(names)}"] if names else []


def _statuses(study: Tornado) -> list[str]:
    """Ends at which the block moves otherwise than it does now, or forms none."""
    method, kind = study.asked[0], study.design.kind
    now = status_of(study.base, method)
    entries = []
    for bar in study.bars:
        for value, point in ((bar.low, bar.at_low), (bar.high, bar.at_high)):
            status = status_of(point, method)
            wrong = point.factors is not None and point.factors.agree is False
            if status != now or wrong:
                said = status_words(kind, status) if point.factors is not None else f"{status} {point.message}"
                check = f" ({check_word(point)})" if check_word(point) not in ("", "agree") else ""
                entries.append(f"{bar.key.path} = {bar.key.shown(value, 6)}: {said}{check}")
    return entries


def _left_out(study: Tornado) -> list[str]:
    by_reason: dict[str, list[str]] = {}
    for path, why in study.left_out:
        by_reason.setdefault(why, []).append(path)
    entries = []
    for why, paths in by_reason.items():
        more = f", … ({len(paths)} in all)" if len(paths) > _MOST_LISTED else ""
        entries.append(f"{why}: {', '.join(paths[:_MOST_LISTED])}{more}")
    return entries
