"""The sheet of a study of benches: what fails by height and face, what berm keeps the catch width, the methods."""

from collections.abc import Callable
from typing import Any

from slopekit.core.orientation import number
from slopekit.core.sheet import Column, Section, Sheet, Table
from slopekit.studies.bench_design.bench import MODES
from slopekit.studies.bench_design.given import UNITS
from slopekit.studies.bench_design.outcomes import OfBench, OfBerm
from slopekit.studies.bench_design.run import BenchDesigns
from slopekit.studies.prob.estimates import Share
from slopekit.studies.surveys import codes_of, inputs_in_words, study_sheet, survey_entry


def sheet_of(study: BenchDesigns) -> Sheet:
    """The sheet of a study of benches."""
    fails, backbreak, needed, berms = _fails(study), _backbreak(study), _needed(study), _berms(study)
    inputs = study.given.to_dict() | {"water": study.given.slope.water.in_words()}
    every = {column.key: column for table in (fails, backbreak, needed) for column in table.columns}
    return study_sheet("bench-design", study.joints, study.given.input_hash(), (
        Section("SURVEY", [survey_entry(study.joints)]),
        Section("INPUTS", inputs_in_words(inputs, study.given.defaults, UNITS)),
        Section("FAILS", [_OF_PLACES, fails]),
        Section("BACKBREAK", [_backbreak_said(study), backbreak]),
        Section("BERMS", [_OF_BERMS, berms] if study.given.berms_m is not None else []),
        Section("NEEDED", [_needed_said(study), needed]),
        Section("BEST", _best(study)),
        Section("METHODS", _methods(study)),
        Section("TIME", [f"{study.seconds:.1f} s"]),
        Section("NOTE", [str(notice) for notice in study.warnings]),
    ), {"benches.csv": Table(list(every.values()), study.benches), "berms.csv": berms})  # fmt: skip


def line_of(study: BenchDesigns) -> str:
    """The best bench on one line."""
    best, wanted = study.best, study.given.number("reliability")
    said = "" if study.accepted is None else "  ACCEPTED" if study.accepted else "  NOT ACCEPTED"
    both = study.both
    agree = f"  PRE-IE agrees on {both.agree} of {both.looked_at} that stand" if both.looked_at else ""
    steepest = study.steepest_accepted
    line = (
        f"steepest accepted: {_in_words(steepest)}{agree}{said}"
        if steepest is not None
        else (
            f"steepest: {number(best.height_m)} m at {number(best.face_dip_deg)}°, berm {best.berm_needed_m:.1f} m for "
            f"{number(100.0 * wanted)} %, inter-ramp {best.inter_ramp_deg:.1f}°{agree}{said}"
        )
    )
    return "  ".join([line, *codes_of(study.warnings)])


def _size_columns() -> list[Column[Any]]:
    return [
        Column("height", lambda row: row.height_m, "height_m", "m", ".4g", 7,
               text=lambda row: f"{row.height_m:.4g} m"),
        Column("face", lambda row: row.face_dip_deg, "face_dip_deg", "°", ".4g", 7,
               text=lambda row: f"{row.face_dip_deg:.4g}°"),
    ]  # fmt: skip


def _fails(study: BenchDesigns) -> Table[OfBench]:
    """How often something forms and fails."""

    def of(mode: str, what: str) -> Callable[[OfBench], Any]:
        def value(row: OfBench) -> float | None:
            share = row.modes[mode][what].share
            return None if share is None else 100.0 * share

        return value

    columns = _size_columns()
    for mode in MODES:
        columns += [
            Column("topple" if mode == "toppling" else mode, of(mode, "forms"), f"{mode}_forms", "%", ".1f", 9),
            Column("fails", of(mode, "fails"), f"{mode}_fails", "%", ".1f", 7),
        ]
    columns += [
        Column("any fails", of("any", "fails"), "any_fails", "%", ".1f", 11),
        Column(
            "limits", lambda row: row.modes["any"]["fails"].low, "any_fails_low", width=15,
            text=lambda row: _between(row.modes["any"]["fails"]),
        ),
    ]  # fmt: skip
    return Table(columns, study.benches)


def _backbreak(study: BenchDesigns) -> Table[OfBench]:
    """Distributions: of the crest, of the face, of the volume."""

    def at(share: float) -> Callable[[OfBench], Any]:
        return lambda row: row.backbreak["quantiles"][share]

    return Table([
        *_size_columns(),
        Column("mean", lambda row: row.backbreak["mean"], "backbreak_mean_m", "m", ".2f", 8),
        *(Column(f"{100 * share:.0f} %", at(share), f"backbreak_{100 * share:.0f}_m", "m", ".2f", 7)
          for share in (0.8, 0.9, 0.95)),
        Column("most", lambda row: row.backbreak["max"], "backbreak_max_m", "m", ".2f", 8),
        Column("face left", lambda row: row.effective_face_deg, "effective_face_deg", "°", ".1f", 11),
        Column("m³", lambda row: row.volume_m3["mean"] if row.volume_m3 else None, "volume_per_100_m_mean_m3", "m³",
               ".0f", 8),
        Column("95 %", lambda row: row.volume_m3["quantiles"][0.95] if row.volume_m3 else None,
               "volume_per_100_m_95_m3", "m³", ".0f", 8),
        Column("lost", lambda row: 100.0 * row.crest_lost, "crest_lost_percent", "%", ".1f", 7),
    ], study.benches)  # fmt: skip


def _berms(study: BenchDesigns) -> Table[OfBerm]:
    """What each berm keeps."""
    columns: list[Column[OfBerm]] = [
        *_size_columns(),
        Column("berm", lambda row: row.berm_m, "berm_m", "m", ".2f", 7),
        Column("catch", lambda row: row.catch_width_m, "catch_width_m", "m", ".2f", 7),
        Column("kept, %", lambda row: 100.0 * (row.reliability.share or 0.0), "reliability_percent", "%", ".1f", 9),
        Column("limits", lambda row: row.reliability.low, "reliability_low", width=15,
               text=lambda row: _between(row.reliability)),
        Column("left 80 %", lambda row: row.left_m[0.8], "berm_left_80_m", "m", ".2f", 10),
        Column("95 %", lambda row: row.left_m[0.95], "berm_left_95_m", "m", ".2f", 7),
        Column("spill, %", lambda row: 100.0 * row.spill_kept, "spill_kept_percent", "%", ".1f", 9),
        Column("ramp", lambda row: row.inter_ramp_deg, "inter_ramp_deg", "°", ".1f", 7),
    ]  # fmt: skip
    if study.accepted is not None:
        columns.append(
            Column("", lambda row: row.accepted, "accepted", width=4, show=lambda ok: " ok" if ok else " NO")
        )
    return Table(columns, study.berms)


def _needed(study: BenchDesigns) -> Table[OfBench]:
    """The berm for the reliability that is wanted."""
    return Table([
        *_size_columns(),
        Column("catch", lambda row: row.catch_width_m, "catch_width_m", "m", ".2f", 8),
        Column("backbreak", lambda row: row.berm_needed_m - row.catch_width_m, "backbreak_m", "m", ".2f", 11),
        Column("berm needed", lambda row: row.berm_needed_m, "berm_needed_m", "m", ".2f", 13),
        Column("inter-ramp", lambda row: row.inter_ramp_deg, "inter_ramp_at_berm_needed_deg", "°", ".1f", 12),
    ], study.benches)  # fmt: skip


def _methods(study: BenchDesigns) -> list[str]:
    both = study.both
    if not both.looked_at:
        return ["by the closed form no wedge and no plane stands"]
    return [f"{both.looked_at} blocks of all benches stand by the closed form: of these", *both.in_words()]


def _between(share: Share) -> str:
    return f"{100.0 * share.low:.1f} to {100.0 * share.high:.1f}"


def _best(study: BenchDesigns) -> list[str]:
    best, asked = study.best, study.given
    wanted = number(100.0 * asked.number("reliability"))
    entries = [
        f"steepest inter-ramp angle at {wanted} %: {best.inter_ramp_deg:.1f}° with benches of {number(best.height_m)} "
        f"m at {number(best.face_dip_deg)}° and berms of {best.berm_needed_m:.2f} m (catch {best.catch_width_m:.2f} m "
        f"and {best.berm_needed_m - best.catch_width_m:.2f} m of backbreak)"
    ]
    least = asked.numbers["accept"]
    if least is not None:
        met, steepest = [berm for berm in study.berms if berm.accepted], study.steepest_accepted
        verdict = (
            f"{len(met)} of {len(study.berms)} reach {number(100.0 * least)} % with the lower limit"
            if met else f"none reaches {number(100.0 * least)} % with the lower limit"
        )  # fmt: skip
        entries.append(f"{'ACCEPTED' if met else 'NOT ACCEPTED'}: {verdict}")
        if steepest is not None:
            entries.append(f"steepest of these: {_in_words(steepest)}")
    return entries


def _in_words(berm: OfBerm) -> str:
    return (
        f"{number(berm.height_m)} m at {number(berm.face_dip_deg)}°, berm {berm.berm_m:.2f} m, inter-ramp "
        f"{berm.inter_ramp_deg:.1f}°"
    )


_OF_PLACES = "per cent of the places: a block forms, and fails; topple: columns"
_OF_BERMS = (
    "per cent of the length that keeps the catch width; m of the berm that are left on 80 and 95 % of it; per cent of "
    "the places whose broken rock such a berm holds; inter-ramp angle of the design"
)


def _backbreak_said(study: BenchDesigns) -> str:
    wanted = number(100.0 * study.given.number("reliability"))
    return (
        f"m behind the crest by share of the length; face left: angle at {wanted} %; m³ that fail on 100 m, mean and "
        "95 % of such lengths; lost: per cent of the crest"
    )


def _needed_said(study: BenchDesigns) -> str:
    wanted = number(100.0 * study.given.number("reliability"))
    return f"so that {wanted} % of the length keeps the catch width"
