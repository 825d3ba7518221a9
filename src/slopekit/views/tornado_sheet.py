"""The sheet of a tornado: each number of the design, its two ends, what they do."""

import math

from slopekit.studies.points import Point
from slopekit.studies.solve import factor_at
from slopekit.studies.sweep import has_number
from slopekit.studies.tornado import RULE, Tornado, TornadoBar, status_of
from slopekit.views.entries import block
from slopekit.views.sweep_sheet import METHODS, cell, check_word, counted, head, status_words

_MOST_LISTED = 12


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
