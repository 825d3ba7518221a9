"""The sheet of a study of benches: failures by height and face angle, berms, agreement of the methods."""

from collections.abc import Sequence
from typing import Any

from slopekit.core.orientation import number
from slopekit.core.sheet import Column, Section, Sheet, Table
from slopekit.studies.bench_design.bench import MODES
from slopekit.studies.bench_design.inputs import UNITS
from slopekit.studies.bench_design.outcomes import BenchStatistics, BermStatistics
from slopekit.studies.bench_design.run import BenchDesigns
from slopekit.studies.prob.estimates import Share
from slopekit.studies.surveys import codes_of, inputs_in_words, study_sheet, survey_entry


def sheet_of(study: BenchDesigns) -> Sheet:
    """Return the sheet of a study of benches."""
    both, reliability = study.both, number(100.0 * study.given.number("reliability"))
    inputs = study.given.to_dict() | {"water": study.given.slope.water.in_words()}
    berms = Table([*_BERMS, *([] if study.accepted is None else [_ACCEPTED])], study.berms)
    columns = {column.key: column for column in (*_FAILS, *_BACKBREAK, *_NEEDED)}
    return study_sheet(
        "bench-design",
        study.joints,
        study.given.input_hash(),
        (
            Section("SURVEY", [survey_entry(study.joints)]),
            Section("INPUTS", inputs_in_words(inputs, study.given.defaults, UNITS)),
            Section("FAILS", [_FAILS_LEGEND, Table(_FAILS, study.benches)]),
            Section(
                "BACKBREAK",
                [_BACKBREAK_LEGEND.format(reliability), Table(_BACKBREAK, study.benches)],
            ),
            Section("BERMS", [_BERMS_LEGEND, berms] if study.given.berms_m is not None else []),
            Section("NEEDED", [_NEEDED_LEGEND.format(reliability), Table(_NEEDED, study.benches)]),
            Section("BEST", _best(study)),
            Section(
                "METHODS",
                [
                    f"{both.looked_at} blocks of all benches stand by the closed form: of these",
                    *both.in_words(),
                ]
                if both.looked_at
                else ["by the closed form no wedge and no plane stands"],
            ),
            Section("TIME", [f"{study.seconds:.1f} s"]),
            Section("NOTE", [str(notice) for notice in study.warnings]),
        ),
        {"benches.csv": Table(list(columns.values()), study.benches), "berms.csv": berms},
    )


def line_of(study: BenchDesigns) -> str:
    """Return the steepest accepted bench, or the steepest one, on one line."""
    best, reliability = study.best, study.given.number("reliability")
    acceptance = (
        "" if study.accepted is None else "  ACCEPTED" if study.accepted else "  NOT ACCEPTED"
    )
    both = study.both
    agree = (
        f"  PRE-IE agrees on {both.agree} of {both.looked_at} that stand" if both.looked_at else ""
    )
    steepest = study.steepest_accepted
    line = (
        f"steepest accepted: {_berm_text(steepest)}{agree}{acceptance}"
        if steepest is not None
        else (
            f"steepest: {number(best.height_m)} m at {number(best.face_dip_deg)}°, berm {best.berm_needed_m:.1f} m for "
            f"{number(100.0 * reliability)} %, inter-ramp {best.inter_ramp_deg:.1f}°{agree}{acceptance}"
        )
    )
    return "  ".join([line, *codes_of(study.warnings)])


_SIZE: Sequence[Column[Any]] = (
    Column("height", "height_m", "height_m", "m", "{:.4g} m", 7),
    Column("face", "face_dip_deg", "face_dip_deg", "°", "{:.4g}°", 7),
)
_FAILS: Sequence[Column[BenchStatistics]] = (
    *_SIZE,
    *(
        Column(title, f"modes.{mode}.{what}.percent", f"{mode}_{what}", "%", ".1f", width)
        for mode in MODES
        for title, what, width in (
            ("topple" if mode == "toppling" else mode, "forms", 9),
            ("fails", "fails", 7),
        )
    ),
    Column("any fails", "modes.any.fails.percent", "any_fails", "%", ".1f", 11),
    Column(
        "limits",
        "modes.any.fails.low",
        "any_fails_low",
        width=15,
        text=lambda row: _limits_text(row.modes["any"]["fails"]),
    ),
)
_BACKBREAK: Sequence[Column[BenchStatistics]] = (
    *_SIZE,
    Column("mean", "backbreak.mean", "backbreak_mean_m", "m", ".2f", 8),
    Column("80 %", lambda row: row.backbreak["quantiles"][0.8], "backbreak_80_m", "m", ".2f", 7),
    Column("90 %", lambda row: row.backbreak["quantiles"][0.9], "backbreak_90_m", "m", ".2f", 7),
    Column("95 %", lambda row: row.backbreak["quantiles"][0.95], "backbreak_95_m", "m", ".2f", 7),
    Column("most", "backbreak.max", "backbreak_max_m", "m", ".2f", 8),
    Column("face left", "effective_face_deg", "effective_face_deg", "°", ".1f", 11),
    Column("m³", "volume_m3.mean", "volume_per_100_m_mean_m3", "m³", ".0f", 8),
    Column(
        "95 %",
        lambda row: row.volume_m3 and row.volume_m3["quantiles"][0.95],
        "volume_per_100_m_95_m3",
        "m³",
        ".0f",
        8,
    ),
    Column("lost", lambda row: 100.0 * row.crest_lost, "crest_lost_percent", "%", ".1f", 7),
)
_BERMS: Sequence[Column[BermStatistics]] = (
    *_SIZE,
    Column("berm", "berm_m", "berm_m", "m", ".2f", 7),
    Column("catch", "catch_width_m", "catch_width_m", "m", ".2f", 7),
    Column("kept, %", "reliability.percent", "reliability_percent", "%", ".1f", 9),
    Column(
        "limits",
        "reliability.low",
        "reliability_low",
        width=15,
        text=lambda row: _limits_text(row.reliability),
    ),
    Column("left 80 %", lambda row: row.left_m[0.8], "berm_left_80_m", "m", ".2f", 10),
    Column("95 %", lambda row: row.left_m[0.95], "berm_left_95_m", "m", ".2f", 7),
    Column("spill, %", lambda row: 100.0 * row.spill_kept, "spill_kept_percent", "%", ".1f", 9),
    Column("ramp", "inter_ramp_deg", "inter_ramp_deg", "°", ".1f", 7),
)
_ACCEPTED: Column[BermStatistics] = Column(
    "", "accepted", "accepted", width=4, show=lambda ok: " ok" if ok else " NO"
)
_NEEDED: Sequence[Column[BenchStatistics]] = (
    *_SIZE,
    Column("catch", "catch_width_m", "catch_width_m", "m", ".2f", 8),
    Column(
        "backbreak",
        lambda row: row.berm_needed_m - row.catch_width_m,
        "backbreak_m",
        "m",
        ".2f",
        11,
    ),
    Column("berm needed", "berm_needed_m", "berm_needed_m", "m", ".2f", 13),
    Column("inter-ramp", "inter_ramp_deg", "inter_ramp_at_berm_needed_deg", "°", ".1f", 12),
)


def _limits_text(share: Share) -> str:
    return f"{100.0 * share.low:.1f} to {100.0 * share.high:.1f}"


def _best(study: BenchDesigns) -> list[str]:
    best, inputs = study.best, study.given
    reliability = number(100.0 * inputs.number("reliability"))
    entries = [
        f"steepest inter-ramp angle at {reliability} %: {best.inter_ramp_deg:.1f}° with benches of "
        f"{number(best.height_m)} m at {number(best.face_dip_deg)}° and berms of {best.berm_needed_m:.2f} m "
        f"(catch {best.catch_width_m:.2f} m and {best.berm_needed_m - best.catch_width_m:.2f} m of backbreak)"
    ]
    least = inputs.numbers["accept"]
    if least is not None:
        accepted_berms, steepest = (
            [berm for berm in study.berms if berm.accepted],
            study.steepest_accepted,
        )
        verdict = (
            f"{len(accepted_berms)} of {len(study.berms)} reach {number(100.0 * least)} % with the lower limit"
            if accepted_berms
            else f"none reaches {number(100.0 * least)} % with the lower limit"
        )
        entries.append(f"{'ACCEPTED' if accepted_berms else 'NOT ACCEPTED'}: {verdict}")
        if steepest is not None:
            entries.append(f"steepest of these: {_berm_text(steepest)}")
    return entries


def _berm_text(berm: BermStatistics) -> str:
    return (
        f"{number(berm.height_m)} m at {number(berm.face_dip_deg)}°, berm {berm.berm_m:.2f} m, inter-ramp "
        f"{berm.inter_ramp_deg:.1f}°"
    )


_FAILS_LEGEND = "per cent of the places: a block forms, and fails; topple: columns"
_BERMS_LEGEND = (
    "per cent of the length that keeps the catch width; m of the berm that are left on 80 and 95 % of it; per cent of "
    "the places whose broken rock such a berm holds; inter-ramp angle of the design"
)
_BACKBREAK_LEGEND = (
    "m behind the crest by share of the length; face left: angle at {} %; m³ that fail on 100 m, mean and 95 % of such "
    "lengths; lost: per cent of the crest"
)
_NEEDED_LEGEND = "so that {} % of the length keeps the catch width"
