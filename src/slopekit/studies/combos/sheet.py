"""The sheet of all pairs of a joint list: their outcomes, the worst pairs, the agreement of the methods."""

from operator import itemgetter

import numpy as np

from slopekit.core.orientation import number
from slopekit.core.sheet import Column, Entry, Section, Sheet, Table, counted, factor_text
from slopekit.kinds.wedge.limits import LIMITED_BY
from slopekit.kinds.words import alike, short, size_number
from slopekit.studies.combos.pairs import NOT_REMOVABLE, PAIR_OUTCOMES
from slopekit.studies.combos.run import Combos, PairCheck
from slopekit.studies.surveys import codes_of, inputs_in_words, study_sheet, survey_entry

_REASONS = {
    "parallel": "the joints are parallel",
    "too_steep": "their line plunges steeper than the face",
    "into_the_slope": "it is level, or plunges into the slope",
    "flatter_than_upper_slope": "it is flatter than the upper slope",
    "along_the_face": "a joint strikes with the face, or is parallel to it",
    "no_wedge": "the planes enclose no wedge",
}
_CODE_BY_OUTCOME = {name: code for code, name in NOT_REMOVABLE.items()}
_STATUS_LABELS = {
    "slides_on_both": "both",
    "slides_on_J1": "first",
    "slides_on_J2": "second",
    "slides_up": "up",
    "rotates": "turns",
    "no_driving_force": "stands",
    "not_converged": "no conv.",
}
_MAX_ROWS = 50
_NAME_WIDTH = 11


def sheet_of(combos: Combos) -> Sheet:
    """Return the sheet of all pairs."""
    pairs = _pair_table(combos)
    inputs = combos.given.to_dict() | {"water": combos.given.slope.water.in_words()}
    return study_sheet(
        "combos",
        combos.joints,
        combos.given.input_hash(),
        (
            Section("SURVEY", [survey_entry(combos.joints)]),
            Section("INPUTS", inputs_in_words(inputs, combos.given.defaults)),
            Section("PAIRS", [_outcomes(combos)], hang=4),
            Section("TARGET", _target(combos)),
            Section("WORST", [_worst_remark(combos) if not combos.worst else pairs]),
            Section("METHODS", _methods(combos)),
            Section("AGAIN", _wedge_command(combos), hang=2),
            Section("TIME", [f"{combos.timing_s['total']:.2f} s"]),
            Section("NOTE", [str(notice) for notice in combos.warnings]),
        ),
        {"pairs.csv": pairs},
    )


def line_of(combos: Combos) -> str:
    """Return removable pairs, the worst pair and the target on one line."""
    phrases = [f"{combos.removable} of {len(combos.pairs)} pairs removable"]
    if combos.worst:
        first = combos.worst[0]
        fos = first.limit if combos.outcomes.pre_ie else first.closed_form
        phrases.append(f"worst {' x '.join(first.names)} {first.status} {factor_text(fos).strip()}")
    if combos.target is not None:
        phrases.append(
            f"{combos.target['below']} below {combos.target['fos']:g} by {_governing_method(combos)}"
        )
    if combos.both is not None and combos.worst:
        phrases.append(combos.both.in_words()[0].split(";")[0])
    return "  ".join([*phrases, *codes_of(combos.warnings)])


def _pair_table(combos: Combos) -> Table[int]:
    """Return the table of all pairs, removable ones first and ranked; a sheet shows the worst."""
    pairs, joints = combos.pairs, combos.joints.joints
    checks = {pair.index: pair for pair in combos.worst}
    worst, hidden_count, limit = (
        list(checks)[:_MAX_ROWS],
        len(checks) - _MAX_ROWS,
        np.full(len(pairs), np.nan),
    )
    limit[combos.ranked] = combos.outcomes.limit.factor
    extents = pairs.sizes
    volume, height, setback, width, trend, plunge, scale = (
        np.where(pairs.volume_m3 > 0.0, values, np.nan)
        for values in (
            pairs.volume_m3,
            pairs.height_m,
            extents.setback_m,
            extents.face_width_m,
            pairs.trend_deg,
            pairs.plunge_deg,
            pairs.scale,
        )
    )
    by_pre_ie: Column[int] = Column(
        "PRE-IE", limit, "fos_limit", show=factor_text, blank=" none", width=9, exact=".9g"
    )
    return Table(
        [
            Column(
                "joints", lambda k: checks[k].names, show=_pair_name, width=-2 * _NAME_WIDTH - 3
            ),
            Column("first joint", lambda k: joints[pairs.first[k]].name, "joint1"),
            Column("second joint", lambda k: joints[pairs.second[k]].name, "joint2"),
            Column(
                "slides on",
                lambda k: checks[k].status,
                show=lambda status: _STATUS_LABELS.get(status, status),
                width=-11,
            ),
            Column("outcome", lambda k: PAIR_OUTCOMES[pairs.outcome[k]], "outcome"),
            Column(
                "closed form",
                pairs.factor,
                "fos_closed_form",
                show=factor_text,
                blank=" none",
                width=11,
                exact=".9g",
            ),
            *([by_pre_ie] if combos.outcomes.pre_ie else []),
            Column("", lambda k: _remark_mark(checks[k]), width=3),
            Column("m³", volume, "volume_m3", "m³", alike(pairs.volume_m3[worst]), 9, ".6g"),
            Column("H1 m", height, "height_m", "m", alike(pairs.height_m[worst]), 10, ".6g"),
            Column(
                "line",
                lambda k: f"{pairs.trend_deg[k] % 360.0:03.0f}/{pairs.plunge_deg[k]:.1f}",
                width=12,
            ),
            Column("trend", trend, "trend", "°", exact=".4f"),
            Column("plunge", plunge, "plunge", "°", exact=".4f"),
            Column("setback m", setback, "setback_m", "m", exact=".6g"),
            Column("face width m", width, "face_width_m", "m", exact=".6g"),
            Column("scale", scale, "scale", exact=".6g"),
            Column(
                "made smaller by",
                lambda k: LIMITED_BY[pairs.by[k]] if volume[k] > 0.0 else "",
                "limited_by",
            ),
        ],
        combos.ranked.tolist() + np.flatnonzero(~pairs.is_removable).tolist(),
        worst,
        f"and {hidden_count} more in combos.json" if hidden_count > 0 else "",
    )


def _pair_name(names: tuple[str, str]) -> str:
    return " x ".join(
        name if len(name) <= _NAME_WIDTH else name[: _NAME_WIDTH - 1] + "…" for name in names
    )


def _remark_mark(pair: PairCheck) -> str:
    mark = "!" if pair.agree is False else "M" if pair.moments_govern else ""
    return mark + ("*" if pair.limited_by else "")


def _outcomes(combos: Combos) -> Table[tuple[str, int]]:
    counts, n_pairs, least = combos.counts, len(combos.pairs), combos.given.limits.min_volume_m3
    rows = [
        ("removable", combos.removable),
        ("  slide on both joints", counts["slides_on_both"]),
        ("  slide on one joint", counts["slides_on_J1"] + counts["slides_on_J2"]),
        *(
            (f"  {words}", counts[status])
            for status, words in _STATUS_PLURALS.items()
            if counts[status]
        ),
        *(
            []
            if least is None
            else [(f"smaller than {size_number(least)} m³", counts["below_min_volume"])]
        ),
        *(
            []
            if combos.given.limits.by == "scale"
            else [("larger than the limits of size", counts["beyond_limits"])]
        ),
        ("not removable", sum(counts[name] for name in _REASONS)),
        *(
            (f"  {reason} ({_CODE_BY_OUTCOME[name]})", counts[name])
            for name, reason in _REASONS.items()
            if counts[name]
        ),
    ]
    return Table(
        [
            Column("outcome", itemgetter(0), width=-58),
            Column("pairs", itemgetter(1), width=9),
            Column(
                "share",
                lambda row: 100.0 * row[1] / n_pairs,
                "",
                "%",
                lambda share: f"{share:.3g} %",
                11,
            ),
        ],
        rows,
        headless=True,
    )


_STATUS_PLURALS = {
    "slides_up": "slide up: the loads drive them",
    "lifted": "contact lost on both joints (uplift)",
    "falls": "fall",
    "no_driving_force": "stand: nothing drives them",
}


def _target(combos: Combos) -> list[str]:
    """Return the number of pairs below the target, the method that counts, and their volumes."""
    target, removable = combos.target, combos.removable
    if target is None:
        return []
    fos, below = target["fos"], target["below"]
    count_source = f"counted by {_governing_method(combos)}"
    if not combos.outcomes.pre_ie:
        count_source += " alone, which balances no moments"
    if not below:
        return [f"FoS {fos:g}: MET, none of {removable} removable pairs lies below", count_source]
    head = f"FoS {fos:g}: NOT MET, {below} of {removable} removable pairs lie below"
    share = f"{100 * below / removable:.1f} %; {100 * below / len(combos.pairs):.1f} % of all"
    pre_ie_only = f", {target['by_pre_ie_only']} by PRE-IE only" if target["by_pre_ie_only"] else ""
    largest, median = (
        short(target[f"{statistic}_volume_m3"]) for statistic in ("largest", "median")
    )
    return [
        f"{head} ({share}{pre_ie_only})",
        count_source,
        f"volumes up to {largest} m³, median {median} m³",
    ]


def _governing_method(combos: Combos) -> str:
    """Return the method whose factors count, in words."""
    return "PRE-IE" if combos.outcomes.pre_ie else "the closed form"


def _worst_remark(combos: Combos) -> Entry:
    if not combos.removable:
        small = combos.counts.get("below_min_volume", 0)
        too_small = f"{counted(small, 'pair')} can leave the slope, but smaller than the least volume asked for"
        return too_small if small else "no pair can leave the slope"
    return f"{combos.removable} pairs are ranked in pairs.csv"


def _methods(combos: Combos) -> list[str]:
    if combos.both is None:
        return []
    entries = combos.both.in_words()
    if any(pair.moments_govern for pair in combos.worst):
        entries.append("M  moments govern: the closed form is too high")
    if any(pair.limited_by for pair in combos.worst):
        entries.append("*  made smaller by a limit of size")
    if combos.both.disagree:
        entries.append("!  the methods disagree: no number to judge by")
    return entries


def _wedge_command(combos: Combos) -> list[str]:
    """Return the worst pair as a `slopekit wedge` command."""
    if not combos.worst:
        return []
    pair, inputs = combos.worst[0], combos.given
    slope, a = inputs.slope, int(combos.pairs.first[combos.worst[0].index])
    b = int(combos.pairs.second[pair.index])
    strengths = [
        f"{number(float(values[a]))},{number(float(values[b]))}"
        for values in (inputs.cohesion_kpa, inputs.friction_deg)
    ]
    options = [
        f"slopekit wedge --dips {pair.planes[0]} {pair.planes[1]} --face {slope.face} --upper {slope.upper}",
        f"--height {number(pair.height_m)} --c {strengths[0]} --phi {strengths[1]}",
        f"--unit-weight {number(slope.rock.unit_weight_kn_m3)}",
    ]
    if slope.water.mode == "pressures":
        options.append(f"--water u={number(slope.water.pressures_kpa[0])}")
    elif slope.water.mode == "full":
        options.append(f"--water {number(slope.water.fill * 100)}%")
    if slope.seismic.coefficient:
        trend = slope.seismic.trend_deg
        options.append(
            f"--seismic {number(slope.seismic.coefficient)}"
            + ("" if trend is None else f"@{number(trend)}")
        )
    return [" ".join(options)]
