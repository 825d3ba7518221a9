"""The sheet of all pairs of a joint list: what became of them, and the worst of them twice."""

from collections.abc import Callable
from operator import itemgetter
from typing import Any

import numpy as np

from slopekit.core.orientation import number
from slopekit.core.sheet import Column, Entry, Section, Sheet, Table, counted, factor_text
from slopekit.kinds import kind_named
from slopekit.kinds.wedge.limits import LIMITED_BY
from slopekit.kinds.words import WEIGHT_ONLY, size_number
from slopekit.studies.combos.pairs import NOT_REMOVABLE, PAIR_OUTCOMES
from slopekit.studies.combos.run import Combos, PairCheck, Target
from slopekit.studies.surveys import codes_of, head, survey_entry

_WHY = {
    "parallel": "the joints are parallel",
    "too_steep": "their line plunges steeper than the face",
    "into_the_slope": "it is level, or plunges into the slope",
    "flatter_than_upper_slope": "it is flatter than the upper slope",
    "along_the_face": "a joint strikes with the face, or is parallel to it",
    "no_wedge": "the planes enclose no wedge",
}
_CODES = {name: code for code, name in NOT_REMOVABLE.items()}
_SHORT = {
    "slides_on_both": "both", "slides_on_J1": "first", "slides_on_J2": "second", "slides_up": "up", "rotates": "turns",
    "no_driving_force": "stands", "not_converged": "no conv.",
}  # fmt: skip
_MOST_ROWS = 50
_NAME = 11


def sheet_of(combos: Combos) -> Sheet:
    """The sheet of all pairs."""
    slope, pairs = combos.given.slope, _every_pair(combos)
    return Sheet(head("combos", combos.joints, combos.given.input_hash()), (
        Section("SURVEY", [survey_entry(combos.joints)]),
        Section("SLOPE", [
            f"face {slope.face}  {slope.face.in_words()}",
            f"upper {slope.upper}  {slope.upper.in_words() if slope.upper.dip_deg else 'level'}",
            f"height {size_number(slope.height_m)} m, the same for every pair: vertical, from the toe of a wedge up "
            "the dip of the face to the crest (H1 below: to where the trace of its first joint meets the crest)",
        ]),
        Section("STRENGTH", [_strength(combos)]),
        Section("LOADS", _loads(combos)),
        Section("LIMITS", _limits(combos)),
        Section("PAIRS", [_outcomes(combos)], hang=4),
        Section("TARGET", _target(combos)),
        Section("WORST", [_no_worst(combos) if not combos.worst else pairs]),
        Section("PRE-IE", _checked(combos)),
        Section("AGAIN", _again(combos), hang=2),
        Section("READS AS", [_MEANING]),
        Section("DEFAULTS", _defaults(combos)),
        Section("TIME", [f"{combos.timing_s['total']:.2f} s"]),
        Section("NOTE", [str(notice) for notice in combos.warnings]),
    ), {"pairs.csv": pairs})  # fmt: skip


def line_of(combos: Combos) -> str:
    """What became of the pairs, on one line."""
    parts = [f"{combos.removable} of {len(combos.pairs)} pairs removable"]
    if combos.worst:
        first = combos.worst[0]
        parts.append(f"worst {' x '.join(first.names)} {first.status} {factor_text(first.factor).strip()}")
    if combos.target is not None:
        parts.append(f"{combos.target.below} below {combos.target.fos:g} by {_judges(combos.target)}")
    if combos.worst:
        parts.append(_agreement(combos).split(";")[0])
    return "  ".join([*parts, *codes_of(combos.warnings)])


def _every_pair(combos: Combos) -> Table[int]:
    """Every pair, the removable ones first and ranked; the worst are shown."""
    pairs, shapes, joints = combos.pairs, combos.pairs.shapes, combos.joints.joints
    looked = {pair.index: pair for pair in combos.worst}
    is_wedge = pairs.volume_m3 > 0.0
    ranked = [*looked, *(k for k in pairs.ranked().tolist() if k not in looked)]
    shown, left = list(looked)[:_MOST_ROWS], len(looked) - _MOST_ROWS

    def of_joint(which: Any) -> Callable[[int], str]:
        return lambda k: joints[which[k]].name

    def of_wedge(values: Any) -> Callable[[int], float | None]:
        return lambda k: values[k] if is_wedge[k] else None

    def factor(k: int) -> float | None:
        return None if np.isnan(pairs.factor[k]) else pairs.factor[k]

    return Table([
        Column("joints", lambda k: looked[k].names, show=_names, width=-2 * _NAME - 3),
        Column("first joint", of_joint(shapes.first), "joint1"),
        Column("second joint", of_joint(shapes.second), "joint2"),
        Column("slides on", lambda k: looked[k].status, show=lambda status: _SHORT.get(status, status), width=-11),
        Column("outcome", lambda k: PAIR_OUTCOMES[pairs.outcome[k]], "outcome"),
        Column("closed form", factor, "fos_closed_form", show=factor_text, width=11, exact=".9g"),
        Column("PRE-IE", lambda k: looked[k].limit if k in looked else None, "fos_limit", show=factor_text, width=9,
               exact=".9g"),
        Column("", lambda k: _mark(looked[k]), width=3),
        Column("m³", of_wedge(pairs.volume_m3), "volume_m3", "m³", ".4g", 9, ".6g"),
        Column("H1 m", of_wedge(shapes.height_m), "height_m", "m", ".4g", 10, ".6g"),
        Column("line", lambda k: f"{pairs.trend_deg[k] % 360.0:03.0f}/{pairs.plunge_deg[k]:.1f}", width=12),
        Column("trend", of_wedge(pairs.trend_deg), "trend", "°", exact=".4f"),
        Column("plunge", of_wedge(pairs.plunge_deg), "plunge", "°", exact=".4f"),
        Column("setback m", of_wedge(shapes.sizes.setback_m), "setback_m", "m", exact=".6g"),
        Column("face width m", of_wedge(shapes.sizes.face_width_m), "face_width_m", "m", exact=".6g"),
        Column("scale", of_wedge(shapes.scale), "scale", exact=".6g"),
        Column("made smaller by", lambda k: LIMITED_BY[shapes.by[k]] if is_wedge[k] else "", "limited_by"),
    ], ranked + np.flatnonzero(~pairs.is_removable).tolist(), shown,
        f"and {left} more in combos.json" if left > 0 else "")  # fmt: skip


def _names(names: tuple[str, str]) -> str:
    return " x ".join(name if len(name) <= _NAME else name[: _NAME - 1] + "…" for name in names)


def _mark(pair: PairCheck) -> str:
    mark = "M" if pair.moments_govern else "!" if pair.is_in_doubt else ""
    return mark + ("*" if pair.limited_by else "")


def _strength(combos: Combos) -> str:
    parts, given = [], combos.given
    for name, unit, values, own in (
        ("c", " kPa", given.cohesion_kpa, given.own[0]), ("φ", "°", given.friction_deg, given.own[1]),
    ):  # fmt: skip
        low, high = float(values.min()), float(values.max())
        shown = f"{low:g}" if low == high else f"{low:g} to {high:g}"
        source = "" if own == 0 else " (the joints' own)" if own == len(values) else f" (own of {own}, else the option)"
        parts.append(f"{name} {shown}{unit}{source}")
    slope = given.slope
    density = "" if slope.rock.density_kg_m3 is None else f" ({slope.rock.density_kg_m3:.5g} kg/m³)"
    return f"{'  '.join(parts)}  unit weight {slope.rock.unit_weight_kn_m3:.5g} kN/m³{density}"


def _loads(combos: Combos) -> list[str]:
    slope, entries = combos.given.slope, []
    if slope.water.mode == "pressures":
        entries.append(f"water u = {slope.water.pressures_kpa[0]:g} kPa on both joints, whatever the size")
    elif slope.water.mode != "dry":
        entries.append(f"water {slope.water.in_words()} (mean γw H/6, H the total height of each wedge)")
    if slope.seismic.coefficient:
        trend = slope.seismic.trend_deg
        toward = kind_named("wedge").words.seismic if trend is None else f"toward {trend:03.0f}"
        entries.append(f"seismic {slope.seismic.coefficient:.4g} g {toward}")
    return entries or [WEIGHT_ONLY.replace(", no forces, no bolts", "")]


def _limits(combos: Combos) -> list[str]:
    named = zip((*LIMITED_BY[1:], "min volume"), combos.given.limits_of_all.values(), strict=False)
    limits = {name: value for name, value in named if value is not None}
    parts = [f"{name} {size_number(value)} {'m³' if 'volume' in name else 'm'}" for name, value in limits.items()]
    if not parts:
        return ["none: every wedge reaches from the toe of the slope to its crest"]
    if combos.given.limits.by == "filter":
        return [", ".join(parts), f"left out, larger than that: {counted(combos.counts['beyond_limits'], 'pair')}"]
    removable = combos.pairs.is_removable
    scaled = [
        f"{int((removable & (combos.pairs.shapes.by == kind)).sum())} by {name}"
        for kind, name in enumerate(LIMITED_BY) if name in limits
    ]  # fmt: skip
    return [", ".join(parts), *([f"made smaller, same shape, at the crest: {', '.join(scaled)}"] if scaled else [])]


def _outcomes(combos: Combos) -> Table[tuple[str, int]]:
    counts, whole, least = combos.counts, len(combos.pairs), combos.given.limits.min_volume_m3
    rows = [
        ("removable", combos.removable),
        ("  slide on both joints", counts["slides_on_both"]),
        ("  slide on one joint", counts["slides_on_J1"] + counts["slides_on_J2"]),
        *((f"  {words}", counts[status]) for status, words in _PLURAL.items() if counts[status]),
        *([] if least is None else [(f"smaller than {size_number(least)} m³", counts["below_min_volume"])]),
        *([] if combos.given.limits.by == "scale" else [("larger than the limits of size", counts["beyond_limits"])]),
        ("not removable", sum(counts[name] for name in _WHY)),
        *((f"  {why} ({_CODES[name]})", counts[name]) for name, why in _WHY.items() if counts[name]),
    ]  # fmt: skip
    return Table([
        Column("outcome", itemgetter(0), width=-58), Column("pairs", itemgetter(1), width=9),
        Column("share", lambda row: 100.0 * row[1] / whole, "", "%", lambda share: f"{share:.2f} %", 11),
    ], rows, headless=True)  # fmt: skip


_PLURAL = {
    "slides_up": "slide up: the loads drive them", "lifted": "are pushed off both joints", "falls": "fall",
    "no_driving_force": "stand: nothing drives them",
}  # fmt: skip


def _target(combos: Combos) -> list[str]:
    """What lies below, and whose count that is."""
    target = combos.target
    if target is None:
        return []
    by_closed_form = target.removable - target.judged_by_pre_ie
    whose = f"counted by {_judges(target)}"
    if by_closed_form:
        some = f"PRE-IE for {target.judged_by_pre_ie} of them, the closed form for the other {by_closed_form}, which"
        whose = f"counted by {some if target.judged_by_pre_ie else 'the closed form alone, which'} knows no moments: "
        whose += "--top all asks PRE-IE of every removable pair"
    if not target.below:
        return [f"FoS {target.fos:g}: MET, none of {target.removable} removable pairs lies below", whose]
    head = f"FoS {target.fos:g}: NOT MET, {target.below} of {target.removable} removable pairs lie below"
    share = f"{100 * target.below / target.removable:.1f} %; {100 * target.below / target.pairs:.1f} % of all"
    by = f", {target.by_pre_ie_only} by PRE-IE only" if target.by_pre_ie_only else ""
    volumes = (
        f"volumes up to {size_number(target.largest_m3 or 0.0)} m³, median {size_number(target.median_m3 or 0.0)} m³"
    )
    return [f"{head} ({share}{by})", whose, volumes]


def _judges(target: Target) -> str:
    """Whose count it is."""
    if not target.judged_by_pre_ie:
        return "the closed form"
    return "PRE-IE" if target.judged_by_pre_ie == target.removable else "PRE-IE and the closed form"


def _no_worst(combos: Combos) -> Entry:
    if not combos.removable:
        small = combos.counts.get("below_min_volume", 0)
        those = f"{counted(small, 'pair')} can leave the slope, but smaller than the least volume asked for"
        return those if small else "no pair can leave the slope"
    return f"PRE-IE was not asked; {combos.removable} pairs are ranked by the closed form in pairs.csv"


def _checked(combos: Combos) -> list[str]:
    if not combos.worst:
        return []
    entries = [_agreement(combos)]
    if any(pair.moments_govern for pair in combos.worst):
        entries.append("M  moments govern: the PRE-IE limit is the number to use, the closed form knows no moments")
    if any(pair.limited_by for pair in combos.worst):
        entries.append("*  made smaller by a limit of size")
    if any(pair.is_in_doubt for pair in combos.worst):
        entries.append("!  the methods disagree, or PRE-IE did not settle: no number to judge by")
    return entries


def _agreement(combos: Combos) -> str:
    worst = combos.worst
    agree, compared = sum(pair.agree is True for pair in worst), sum(pair.agree is not None for pair in worst)
    most = max((pair.difference for pair in worst if pair.difference is not None), default=0.0)
    word = "AGREE" if agree == compared and all(pair.settled for pair in worst) else "DISAGREE"
    governed = sum(pair.moments_govern for pair in worst)
    within = combos.given.slope.analysis.agree_within * 100
    return (
        f"{agree} of {len(worst)} {word} within {within:g} %; largest difference "
        f"{most * 100:.2g} %; moments govern {governed}"
    )


def _again(combos: Combos) -> list[str]:
    """The worst pair as a command of its own."""
    if not combos.worst:
        return []
    pair, given = combos.worst[0], combos.given
    slope, a = given.slope, int(combos.pairs.shapes.first[combos.worst[0].index])
    b = int(combos.pairs.shapes.second[pair.index])
    own = [
        f"{number(float(values[a]))},{number(float(values[b]))}" for values in (given.cohesion_kpa, given.friction_deg)
    ]
    parts = [
        f"slopekit wedge --dips {pair.planes[0]} {pair.planes[1]} --face {slope.face} --upper {slope.upper}",
        f"--height {number(pair.height_m)} --c {own[0]} --phi {own[1]}",
        f"--unit-weight {number(slope.rock.unit_weight_kn_m3)}",
    ]
    if slope.water.mode == "pressures":
        parts.append(f"--water u={number(slope.water.pressures_kpa[0])}")
    elif slope.water.mode == "full":
        parts.append(f"--water {number(slope.water.fill * 100)}%")
    if slope.seismic.coefficient:
        trend = slope.seismic.trend_deg
        parts.append(f"--seismic {number(slope.seismic.coefficient)}" + ("" if trend is None else f"@{number(trend)}"))
    return [" ".join(parts)]


def _defaults(combos: Combos) -> list[str]:
    slope = combos.given.slope
    names = {
        "upper": "upper slope level", "height": f"height {slope.height_m:g} m", "density": "density 2600 kg/m³",
        "seismic.trend": f"seismic trend ({kind_named('wedge').words.seismic})",
    }  # fmt: skip
    return [", ".join(names[name] for name in combos.given.defaults)] if combos.given.defaults else []


_MEANING = (
    "each pair by itself: whether its joints meet in the slope is not known, so counts are no probabilities. A wedge "
    "needs both joints as long as its edges, which --persistence limits"
)
