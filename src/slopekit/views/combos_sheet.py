"""The sheet of all pairs of a joint list: what became of them, and the worst of them twice; 100 columns."""

import csv
import io
import textwrap

from slopekit._version import __version__
from slopekit.core.sheet import WIDTH, block, factor_text
from slopekit.kinds import kind_named
from slopekit.kinds.words import WEIGHT_ONLY, size_number
from slopekit.orientation import number
from slopekit.studies.combos import Combos, PairCheck
from slopekit.studies.pairs import LIMITED_BY, NOT_REMOVABLE, PAIR_OUTCOMES

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
_MOST_JOINTS = 10
_MOST_ROWS = 50
_NAME = 11


def combos_sheet(found: Combos) -> str:
    """The sheet, lines joined, no trailing newline."""
    slope, n, m = found.given.slope, len(found.joints), len(found.pairs)
    sets = found.joints.sets()
    lines = textwrap.wrap(
        f"slopekit {__version__}   combos   sha {found.given.input_hash()[:6]}   {found.joints.name}", WIDTH
    )
    lines += block("SURVEY", [f"{n} joints{f' in {len(sets)} sets' if sets else ''}, {m} pairs"])
    lines += block("SLOPE", [
        f"face {slope.face}  {slope.face.in_words()}",
        f"upper {slope.upper}  {slope.upper.in_words() if slope.upper.dip_deg else 'level'}",
        f"height {size_number(slope.height_m)} m, the same for every pair: vertical, from the toe of a wedge up the "
        "dip of the face to the crest (H1 below: to where the trace of its first joint meets the crest)",
    ])  # fmt: skip
    lines += block("STRENGTH", [_strength(found)])
    lines += block("LOADS", _loads(found))
    lines += block("LIMITS", _limits(found))
    lines += block("PAIRS", _pairs(found), hang=4)
    lines += block("TARGET", _target(found))
    lines += block("WORST", _worst(found))
    lines += block("PRE-IE", _checked(found))
    lines += block("AGAIN", _again(found), hang=2)
    lines += block("JOINTS", _joints(found))
    lines += block("READS AS", [_MEANING])
    lines += block("DEFAULTS", _defaults(found))
    lines += block("TIME", [_time(found)])
    lines += block("NOTE", [str(notice) for notice in found.warnings])
    return "\n".join(lines)


def combos_line(found: Combos) -> str:
    """What became of the pairs, on one line."""
    parts = [f"{found.removable} of {len(found.pairs)} pairs removable"]
    if found.worst:
        first = found.worst[0]
        factor = first.closed_form if first.limit is None else first.limit
        parts.append(f"worst {' x '.join(first.names)} {first.status} {factor_text(factor).strip()}")
    if found.target is not None:
        parts.append(f"{found.target.below} below {found.target.fos:g}")
    if found.worst:
        parts.append(_agreement(found).split(";")[0])
    return "  ".join(parts)


def pairs_csv(found: Combos) -> str:
    """Every pair, the removable ones first and ranked; a value that does not apply is empty."""
    pairs, names = found.pairs, [joint.name for joint in found.joints.joints]
    ranked = pairs.ranked().tolist()
    order = ranked + sorted(set(range(len(pairs))) - set(ranked))
    limits = {pair.index: pair for pair in found.worst}
    first, second = pairs.shapes.first.tolist(), pairs.shapes.second.tolist()
    columns = [pairs.outcome.tolist()]
    columns += [values.tolist() for values in (
        pairs.factor, pairs.volume_m3, pairs.shapes.height_m, pairs.trend_deg, pairs.plunge_deg, pairs.shapes.scale,
    )]  # fmt: skip
    outcome, factor, volume, height, trend, plunge, scale = columns
    wedge = (pairs.volume_m3 > 0.0).tolist()
    text = io.StringIO()
    text.write("joint1,joint2,outcome,fos_closed_form,fos_limit,volume_m3,height_m,trend,plunge,scale,limited_by\n")
    writer = csv.writer(text, lineterminator="\n")
    for k in order:
        row: list[object] = [names[first[k]], names[second[k]], PAIR_OUTCOMES[outcome[k]]]
        checked = limits.get(k)
        row.append("" if factor[k] != factor[k] else f"{factor[k]:.9g}")
        row.append("" if checked is None or checked.limit is None else f"{checked.limit:.9g}")
        if wedge[k]:
            row += [f"{volume[k]:.6g}", f"{height[k]:.6g}", f"{trend[k]:.4f}", f"{plunge[k]:.4f}", f"{scale[k]:.6g}"]
            row.append(LIMITED_BY[pairs.shapes.limited_by[k]])
        else:
            row += [""] * 6
        writer.writerow(row)
    return text.getvalue()


def _strength(found: Combos) -> str:
    parts, given = [], found.given
    for name, unit, values, own in (
        ("c", " kPa", given.cohesion_kpa, given.own[0]), ("φ", "°", given.friction_deg, given.own[1]),
    ):  # fmt: skip
        low, high = float(values.min()), float(values.max())
        shown = f"{low:g}" if low == high else f"{low:g} to {high:g}"
        source = "" if own == 0 else " (the joints' own)" if own == len(values) else f" (own of {own}, else the option)"
        parts.append(f"{name} {shown}{unit}{source}")
    slope = given.slope
    density = "" if slope.density_kg_m3 is None else f" ({slope.density_kg_m3:.5g} kg/m³)"
    return f"{'  '.join(parts)}  unit weight {slope.unit_weight_kn_m3:.5g} kN/m³{density}"


def _loads(found: Combos) -> list[str]:
    slope, entries = found.given.slope, []
    if slope.water.mode == "pressures":
        entries.append(f"water u = {slope.water.pressures_kpa[0]:g} kPa on both joints, whatever the size")
    elif slope.water.mode != "dry":
        entries.append(f"water {slope.water.in_words()} (mean γw H/6, H the total height of each wedge)")
    if slope.seismic.coefficient:
        trend = slope.seismic.trend_deg
        toward = kind_named("wedge").words.seismic if trend is None else f"toward {trend:03.0f}"
        entries.append(f"seismic {slope.seismic.coefficient:.4g} g {toward}")
    return entries or [WEIGHT_ONLY.replace(", no forces, no bolts", "")]


def _limits(found: Combos) -> list[str]:
    limits = found.given.limits
    parts = [
        f"{name} {size_number(value)} {unit}"
        for name, value, unit in (
            ("persistence", limits.persistence_m, "m"), ("bench width", limits.bench_width_m, "m"),
            ("max volume", limits.max_volume_m3, "m³"), ("min volume", limits.min_volume_m3, "m³"),
        )
        if value is not None
    ]  # fmt: skip
    if not parts:
        return ["none: every wedge reaches from the toe of the slope to its crest"]
    removable = found.pairs.is_removable
    given = {1: limits.persistence_m, 2: limits.bench_width_m, 3: limits.max_volume_m3}
    scaled = [
        f"{int((removable & (found.pairs.shapes.limited_by == kind)).sum())} by {LIMITED_BY[kind]}"
        for kind, value in given.items() if value is not None
    ]  # fmt: skip
    return [", ".join(parts), *([f"made smaller, same shape, at the crest: {', '.join(scaled)}"] if scaled else [])]


def _pairs(found: Combos) -> list[str]:
    counts, m, removable = found.counts, len(found.pairs), found.removable
    rows = [_row("removable", removable, m)]
    rows.append(_row("  slide on both joints", counts["slides_on_both"], m))
    rows.append(_row("  slide on one joint", counts["slides_on_J1"] + counts["slides_on_J2"], m))
    for status in ("slides_up", "lifted", "falls", "no_driving_force"):
        if counts[status]:
            rows.append(_row(f"  {_PLURAL[status]}", counts[status], m))
    if found.given.limits.min_volume_m3 is not None:
        rows.append(
            _row(f"smaller than {size_number(found.given.limits.min_volume_m3)} m³", counts["below_min_volume"], m)
        )
    rows.append(_row("not removable", sum(counts[name] for name in _WHY), m))
    rows += [_row(f"  {why} ({_CODES[name]})", counts[name], m) for name, why in _WHY.items() if counts[name]]
    return rows


_PLURAL = {
    "slides_up": "slide up: the loads drive them", "lifted": "are pushed off both joints", "falls": "fall",
    "no_driving_force": "stand: nothing drives them",
}  # fmt: skip


def _row(what: str, count: int, whole: int) -> str:
    return f"{what:<58}{count:>9}{100.0 * count / whole:>9.2f} %"


def _target(found: Combos) -> list[str]:
    target = found.target
    if target is None:
        return []
    removable, m = found.removable, len(found.pairs)
    if not target.below:
        return [f"FoS {target.fos:g}: MET, none of {removable} removable pairs lies below"]
    head = f"FoS {target.fos:g}: NOT MET, {target.below} of {removable} removable pairs lie below"
    share = f"{100 * target.below / removable:.1f} %; {100 * target.below / m:.1f} % of all"
    by = f", {target.by_pre_ie_only} by PRE-IE only" if target.by_pre_ie_only else ""
    volumes = (
        f"volumes up to {size_number(target.largest_m3 or 0.0)} m³, median {size_number(target.median_m3 or 0.0)} m³"
    )
    return [f"{head} ({share}{by})", volumes]


def _worst(found: Combos) -> list[str]:
    if not found.worst:
        return [f"PRE-IE was not asked; {found.removable} pairs are ranked by the closed form in pairs.csv"] if (
            found.removable
        ) else ["no pair can leave the slope"]  # fmt: skip
    rows = [
        f"{'joints':<{2 * _NAME + 3}}{'slides on':<11}{'closed form':>11}{'PRE-IE':>9}{'':>3}{'m³':>9}{'H1 m':>10}"
        f"{'line':>12}"
    ]
    rows += [_worst_row(pair) for pair in found.worst[:_MOST_ROWS]]
    left = len(found.worst) - _MOST_ROWS
    return rows + ([f"and {left} more in combos.json"] if left > 0 else [])


def _worst_row(pair: PairCheck) -> str:
    names = " x ".join(name if len(name) <= _NAME else name[: _NAME - 1] + "…" for name in pair.names)
    mark = "M" if pair.moments_govern else "!" if pair.agree is False or not pair.settled else ""
    mark += "*" if pair.limited_by else ""
    line = f"{pair.trend_deg % 360.0:03.0f}/{pair.plunge_deg:.1f}"
    return (
        f"{names:<{2 * _NAME + 3}}{_SHORT.get(pair.status, pair.status):<11}{factor_text(pair.closed_form):>11}"
        f"{factor_text(pair.limit):>9}{mark:>3}{pair.volume_m3:>9.4g}{pair.height_m:>10.4g}{line:>12}"
    )


def _checked(found: Combos) -> list[str]:
    if not found.worst:
        return []
    entries = [_agreement(found)]
    if any(pair.moments_govern for pair in found.worst):
        entries.append("M  moments govern: the PRE-IE limit is the number to use, the closed form knows no moments")
    if any(pair.limited_by for pair in found.worst):
        entries.append("*  made smaller by a limit of size")
    if any(pair.agree is False or not pair.settled for pair in found.worst):
        entries.append("!  the methods disagree, or PRE-IE did not settle: no number to judge by")
    return entries


def _agreement(found: Combos) -> str:
    worst = found.worst
    agree, compared = sum(pair.agree is True for pair in worst), sum(pair.agree is not None for pair in worst)
    most = max((pair.difference for pair in worst if pair.difference is not None), default=0.0)
    word = "AGREE" if agree == compared and all(pair.settled for pair in worst) else "DISAGREE"
    governed = sum(pair.moments_govern for pair in worst)
    return (
        f"{agree} of {len(worst)} {word} within {found.given.slope.agree_within * 100:g} %; largest difference "
        f"{most * 100:.2g} %; moments govern {governed}"
    )


def _again(found: Combos) -> list[str]:
    """The worst pair as a command of its own."""
    if not found.worst:
        return []
    pair, given = found.worst[0], found.given
    slope, a = given.slope, int(found.pairs.shapes.first[found.worst[0].index])
    b = int(found.pairs.shapes.second[pair.index])
    own = [
        f"{number(float(values[a]))},{number(float(values[b]))}" for values in (given.cohesion_kpa, given.friction_deg)
    ]
    parts = [
        f"slopekit wedge --dips {pair.planes[0]} {pair.planes[1]} --face {slope.face} --upper {slope.upper}",
        f"--height {number(pair.height_m)} --c {own[0]} --phi {own[1]}",
        f"--unit-weight {number(slope.unit_weight_kn_m3)}",
    ]
    if slope.water.mode == "pressures":
        parts.append(f"--water u={number(slope.water.pressures_kpa[0])}")
    elif slope.water.mode == "full":
        parts.append(f"--water {number(slope.water.fill * 100)}%")
    if slope.water.mode != "dry" and slope.water_unit_weight_kn_m3 != 9.81:
        parts.append(f"--water-unit-weight {number(slope.water_unit_weight_kn_m3)}")
    if slope.seismic.coefficient:
        trend = slope.seismic.trend_deg
        parts.append(f"--seismic {number(slope.seismic.coefficient)}" + ("" if trend is None else f"@{number(trend)}"))
    return [" ".join(parts)]


def _joints(found: Combos) -> list[str]:
    target = 1.0 if found.target is None else found.target.fos
    most = found.partners()[:_MOST_JOINTS]
    if not most:
        return []
    return [f"in pairs below {target:g}: " + ", ".join(f"{name} ({times})" for name, times in most)]


def _defaults(found: Combos) -> list[str]:
    slope = found.given.slope
    names = {
        "upper": "upper slope level", "height": f"height {slope.height_m:g} m", "density": "density 2600 kg/m³",
        "seismic.trend": f"seismic trend ({kind_named('wedge').words.seismic})",
    }  # fmt: skip
    return [", ".join(names[name] for name in found.given.defaults)] if found.given.defaults else []


def _time(found: Combos) -> str:
    times, m = found.timing_s, len(found.pairs)
    rate = m / max(times["closed_form"], 1e-9)
    text = (
        f"reading {times['read'] * 1e3:.0f} ms  closed form {times['closed_form'] * 1e3:.0f} ms ({rate:,.0f} pairs/s)"
    )
    return f"{text}  PRE-IE {times['pre_ie'] * 1e3:.0f} ms" if found.worst else text


_MEANING = (
    "each pair by itself: whether its joints meet in the slope is not known, so counts are no probabilities. A wedge "
    "needs both joints as long as its edges, which --persistence limits"
)
