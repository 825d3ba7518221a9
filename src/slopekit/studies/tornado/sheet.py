"""The sheet of a tornado study: its bars as a table, the one with the largest swing first."""

import math

from slopekit.core.sheet import Column, Section, Sheet, Table, is_number
from slopekit.studies.keys import listed
from slopekit.studies.points import Method, Point, factor_at, status_of
from slopekit.studies.tornado.run import RULE, Tornado, TornadoBar
from slopekit.studies.words import METHODS, cell, check_word, status_words, study_sheet

_VALUE = 12  # characters of a value with its unit


def sheet_of(study: Tornado) -> Sheet:
    """Return the sheet of a tornado study."""
    effective = [bar for bar in study.bars if bar.swings[study.asked[0]] != 0.0]
    without_effect = [bar.key.path for bar in study.bars if bar.swings[study.asked[0]] == 0.0]
    return study_sheet(
        study.design,
        "tornado",
        (
            Section("RULE", [RULE]),
            Section("NOW", [_present_state(study)]),
            Section(
                "BARS",
                [
                    _bars(study, effective)
                    if effective
                    else "no number changes the factor of safety"
                ],
            ),
            Section("NO EFFECT", [", ".join(without_effect)] if without_effect else []),
            Section("LEFT OUT", _left_out(study)),
            Section("TIME", [f"{study.seconds:.2f} s"]),
            Section("NOTE", [str(notice) for notice in study.warnings]),
        ),
    )


def line_of(study: Tornado) -> str:
    """Return the three numbers with the largest swing on one line."""
    first = study.asked[0]
    most = [f"{bar.key.path} {_swing(bar.swings[first])}" for bar in study.bars[:3]]
    agree = (
        []
        if len(study.asked) < 2
        else [f"{study.disagree} disagree" if study.disagree else "agree"]
    )
    return "  ".join([*most, *agree, *dict.fromkeys(notice.code for notice in study.warnings)])


def _present_state(study: Tornado) -> str:
    if study.base.factors is None:
        return f"no block: {study.base.code} {study.base.message}"
    factors = [f"{cell(factor_at(study.base, method))} {METHODS[method]}" for method in study.asked]
    return "   ".join(
        [
            status_words(study.design, status_of(study.base, study.asked[0])),
            *factors,
            check_word(study.base),
        ]
    ).rstrip()


def _bars(study: Tornado, bars: list[TornadoBar]) -> Table[TornadoBar]:
    main, *other_methods = study.asked
    columns: list[Column[TornadoBar]] = [
        Column(
            "key",
            "key.path",
            "key",
            width=-28,
            show=lambda path: path if len(path) <= 27 else "…" + path[-26:],
        ),
        Column(
            "from",
            lambda bar: bar.key.reduced(bar.low),
            "low",
            width=_VALUE,
            text=lambda bar: _number(bar, bar.low),
        ),
        Column(
            "to",
            lambda bar: bar.key.reduced(bar.high),
            "high",
            width=_VALUE,
            text=lambda bar: _number(bar, bar.high),
        ),
        Column("", lambda bar: _end(bar.at_low, main), "fos_low", show=_end_text, width=8),
        Column(
            "FoS there", lambda bar: _end(bar.at_high, main), "fos_high", show=_end_text, width=9
        ),
        Column("swing", f"swings.{main}", "swing", show=_swing, width=9),
        *(
            Column(METHODS[method], f"swings.{method}", f"swing_{method}", show=_swing, width=12)
            for method in other_methods
        ),
    ]
    return Table(columns, bars)


def _number(bar: TornadoBar, value: float) -> str:
    """Return a value with its unit, in as many digits as fit its column."""
    texts = [bar.key.value_text(value, digits).replace("e+0", "e") for digits in (5, 4, 3)]
    return next((text for text in texts if len(text) < _VALUE), texts[-1])


def _end(point: Point, method: Method) -> float | str:
    """Return the factor at an end, or the status where there is none."""
    factor = factor_at(point, method)
    return factor if factor is not None and is_number(factor) else status_of(point, method)[:8]


def _end_text(end: float | str) -> str:
    return cell(end) if isinstance(end, float) else end


def _swing(swing: float | None) -> str:
    """Return the swing of the factor in words; a dash where an end has no factor."""
    if swing is None:
        return "-"
    return "∞" if math.isinf(swing) else f"{swing:.4f}" if swing < 1e3 else f"{swing:.4g}"


def _left_out(study: Tornado) -> list[str]:
    by_reason: dict[str, list[str]] = {}
    for path, reason in study.left_out:
        by_reason.setdefault(reason, []).append(path)
    return [f"{reason}: {listed(paths)}" for reason, paths in by_reason.items()]
