"""The sheet: one design on one screen, 100 columns, no colour needed. Never a bare factor of safety."""

import textwrap

from slopekit._version import __version__
from slopekit.design.common import Rule
from slopekit.design.kinds import FootingDesign, PlaneDesign
from slopekit.design.wedge import DEFAULT_NAMES, WedgeDesign
from slopekit.orientation import line_of
from slopekit.result import STATUSES, Result, status_text
from slopekit.views.words import dilates, line_in_words, planes, size, size_number

WIDTH = 100
_LABEL = 10
_OWN_WAY = {
    "wedge": "along the trend of the line of intersection", "plane": "out of the slope", "footing": "out of the face",
    "surface": "the way the profile falls",
}  # fmt: skip
_CLOSED_FORMS = {
    "wedge": "Hoek & Bray closed form", "plane": "Hoek & Bray closed form (plane failure)",
    "footing": "closed form", "surface": "closed form (φ = 0, turning about its axis)",
}  # fmt: skip


def sheet(result: Result) -> str:
    """The sheet of a result of any kind, lines joined, no trailing newline."""
    title = f"   {result.design.title}" if result.design.title else ""
    lines = textwrap.wrap(
        f"slopekit {__version__}   {result.kind}   sha {result.design.input_hash()[:6]}{title}", WIDTH
    )
    label, entries = planes(result)
    lines += _block(label, entries)
    lines += _block("SIZE", size(result))
    lines += _block("LOADS", _loads(result))
    lines += _block("FORCES", _forces(result))
    lines += _block("STATUS", [_status(result)])
    lines += _block("FoS", _factors(result))
    lines += _block("COLUMNS", _methods(result))
    lines += _block("ROTATION", _rotation(result))
    lines += _block("ALL PAIRS", _all_pairs(result))
    lines += _block("SERIES", _series(result))
    lines += _block("ACCEPT", _accept(result))
    lines += _block("MODEL", _model(result))
    lines += _block("MOVES", _moves(result))
    lines += _block("TIME", [_time(result)])
    lines += _block("GOVERNS", _governs(result))
    lines += _block("DEFAULTS", _defaults(result))
    lines += _block("NOTE", [str(notice) for notice in result.warnings])
    return "\n".join(lines)


def _block(label: str, entries: list[str]) -> list[str]:
    """A label and its entries, folded to the width of the sheet."""
    lines: list[str] = []
    for k, entry in enumerate(entries):
        head = f"{label if k == 0 else '':<{_LABEL}}"
        indent = " " * (_LABEL + 3)
        lines += textwrap.wrap(head + entry, WIDTH, subsequent_indent=indent, drop_whitespace=True) or [head]
    return lines


def _loads(result: Result) -> list[str]:
    design = result.design
    entries = []
    if isinstance(design, FootingDesign):
        off = design.eccentricity_m
        place = "over the middle of the plane" if not off else f"{abs(off):.4g} m off the middle of the plane"
        entries.append(f"footing {size_number(design.load_kn)} kN, {place}")
    if design.water.mode != "dry" or design.water.crack_fill:
        entries.append(f"water {design.water.in_words()}")
    elif isinstance(design, PlaneDesign) and design.crack is not None and design.crack.water_m:
        entries.append(f"water {design.crack.water_m:.4g} m deep in the crack, falling to nothing at the toe")
    if design.seismic.coefficient:
        trend = design.seismic.trend_deg
        toward = f"toward {trend:03.0f}" if trend is not None else _OWN_WAY[result.kind]
        toward += " (x is 090)" if trend is not None and result.kind == "surface" else ""
        entries.append(f"seismic {design.seismic.coefficient:.4g} g {toward}")
    for force in design.forces:
        at = "" if force.at_m is None else " at ({:.6g}, {:.6g}, {:.6g})".format(*force.at_m)
        size = max(abs(part) for part in force.components_kn)
        parts = [0.0 if abs(part) < 1e-12 * size else part for part in force.components_kn]
        entries.append("force ({:.6g}, {:.6g}, {:.6g}) kN east, north, up".format(*parts) + at)
    for bolt in design.bolts:
        role = "a load" if bolt.acts == "active" else "capacity divided by F"
        at = "" if bolt.head_m is None else " from ({:.6g}, {:.6g}, {:.6g})".format(*bolt.head_m)
        entries.append(f"bolt {bolt.force_kn:.6g} kN toward {line_in_words(bolt.toward)}{at}, {bolt.acts} ({role})")
    return entries or ["weight only: dry, no seismic, no forces, no bolts"]


def _forces(result: Result) -> list[str]:
    forces, areas = result.forces, result.geometry.areas_m2
    parts = []
    for joint, normal in forces.normal.items():
        if normal is not None:
            parts.append(f"N' {joint} {size_number(normal)} kN ({normal / areas[joint]:.4g} kPa)")
    wet = [f"{name} {size_number(push)} kN" for name, push in forces.water.items() if push]
    parts.append("water " + (", ".join(wet) if wet else "0"))
    if forces.driving is not None and forces.resisting is not None:
        alone = " (forces alone)" if result.moments_govern else ""
        parts.append(f"driving {size_number(forces.driving)} kN")
        parts.append(f"resisting {size_number(forces.resisting)} kN{alone}")
    return ["  ".join(parts)]


def _status(result: Result) -> str:
    text = result.status_text
    if result.mechanism is not None and result.status.startswith("slides") and result.kind == "wedge":
        text += f", along {line_in_words(line_of(result.mechanism.displacement))}"
    return text


def _factors(result: Result) -> list[str]:
    fos = result.fos
    entries = []
    dilating = dilates(result.design)
    assumption = "PRE-IE, joints dilate as given" if dilating else "PRE-IE"
    if result.kind == "surface":
        assumption += " (normal stresses of a rigid mass on an even elastic bed)"
    if fos.closed_form is None and result.agree is None:
        entries.append(f"{_factor(fos.limit)}  limit, {assumption}")
    else:
        entries.append(f"{_factor(fos.limit)}  limit, {assumption}       {_verdict(result)}")
    if result.moments_govern and result.forces_only is not None:
        entries.append(
            f"{_factor(result.forces_only)}  forces only, PRE-IE (no turning: the closed form's assumptions)"
        )
    zero = ", zero dilation" if dilating else ""
    if fos.closed_form is None and result.agree is None:
        entries.append("  none  closed form: there is none for this surface; judge by bound and columns")
    else:
        entries.append(f"{_factor(fos.closed_form)}  {_CLOSED_FORMS[result.kind]}{zero}")
    if fos.static_bound is not None:
        entries.append(f"{_factor(fos.static_bound)}  static bound (joints free to dilate; upper bound)")
    if fos.all_pairs_failed is not None:
        entries.append(
            f"{_factor(fos.all_pairs_failed)}  all pairs failed (the paper's criterion; depends on the stiffness)"
        )
    return entries


def _methods(result: Result) -> list[str]:
    """The methods of columns, which know other mechanics: printed beside, not compared."""
    if not result.methods:
        return []
    names = {"fellenius": "Fellenius", "janbu": "Janbu (simplified)", "bishop": "Bishop (simplified)",
             "all_equilibrium": "all equilibrium"}  # fmt: skip
    found = [f"{names[name]} {_factor(value).strip()}" for name, value in result.methods.items()]
    return ["  ".join(found) + "   (other mechanics: not compared)"]


def _series(result: Result) -> list[str]:
    """Displacements and failed pairs by strength reduction factor (the paper's Table 3)."""
    if not result.series:
        return []
    horizontal = "x" if result.kind == "footing" else "horizontal"
    entries = [f"factor   {horizontal + ' / mm':>16}{'up / mm':>12}{'failed of ' + str(result.model.node_pairs):>14}"]
    for step in result.series:
        if step.movement is None:
            entries.append(f"{step.factor:6.4f}   {'does not come to rest':>28}{step.failed_pairs:>14}")
            continue
        x, y, z = (float(part) * 1e3 for part in step.movement.displacement)
        across = x if horizontal == "x" else (x * x + y * y) ** 0.5
        entries.append(f"{step.factor:6.4f}   {across:16.4f}{z:12.4f}{step.failed_pairs:14d}")
    return entries


def _factor(value: float | None) -> str:
    return "  none" if value is None else f"{value:.4f}" if value < 1e4 else f"{value:.4g}"


def _verdict(result: Result) -> str:
    within = f"limit {result.design.agree_within * 100:g} %"
    if result.agree is None:
        return "not compared with the closed form"
    against = "forces only against closed form: " if result.moments_govern else ""
    word = "AGREE" if result.agree else "DISAGREE"
    if result.difference is None:
        return f"{against}{word} (no number from either)" if result.agree else f"{against}{word}"
    percent = result.difference * 100
    shown = "< 0.0001 %" if percent < 1e-4 else f"{percent:.4f} %"
    return f"{against}difference {shown}   {word} ({within})"


def _rotation(result: Result) -> list[str]:
    if result.kind == "surface":
        return []
    what = "wedge" if result.kind == "wedge" else "block"
    if result.status == "topples":
        return [f"first: moments turn the {what} over before any strength is called on"]
    if result.moments_govern and result.forces_only and result.fos.limit:
        less = (1.0 - result.fos.limit / result.forces_only) * 100
        return [f"first: moments lower the limit by {less:.1f} % below what forces alone give"]
    if result.status in ("lifted", "falls", "no_driving_force", "not_converged"):
        because = f"nothing drives the {what}" if result.status == "no_driving_force" else result.status_text
        return [f"not asked: {because}"]
    return [f"not first: with moments the {what} slides at the same factor, or only at a higher one"]


def _all_pairs(result: Result) -> list[str]:
    pairs = result.all_pairs
    if pairs is None:
        return []
    low, high = pairs.bracket
    if result.fos.all_pairs_failed is None:
        return ["not found: the search met no factor at which the block rests on sticking pairs"]
    how = "equilibrium lost there" if pairs.lost_equilibrium else "the block still stands there"
    entries = [f"bracket {low:.5f} to {high:.5f} ({how}); {result.design.stiffness.in_words()}"]
    trials = sorted(pairs.history)
    counts = [count for _, count in trials]
    shown = [
        f"{factor:.5f}: {count}"
        for k, (factor, count) in enumerate(trials)
        if k in (0, len(trials) - 1) or counts[k - 1] != count or counts[k + 1] != count
    ]
    entries.append(f"failed pairs of {result.model.node_pairs} by factor  " + "  ".join(shown))
    return entries


def _accept(result: Result) -> list[str]:
    return [f"{rule}{_judged_on(result, rule)}: {_judgement(result, rule)}" for rule in result.design.rules]


def _judged_on(result: Result, rule: Rule) -> str:
    return f" ({result.design.criterion})" if rule.name == "fos" else ""


def _judgement(result: Result, rule: Rule) -> str:
    if result.judged(rule):
        return "MET"
    if result.agree is False or result.status == "not_converged":
        return "NOT MET (the methods disagree or did not converge: no number to judge)"
    if result.fos.limit is None and result.status != "no_driving_force":
        return "NOT MET (no factor of safety)"
    if result.value_of(rule) is None:
        return "NOT MET (there is no such number here)"
    return "NOT MET"


def _model(result: Result) -> list[str]:
    model = result.model
    refined = f", triangles split {_times(model.refined)}" if model.refined else ""
    return [
        f"{model.moving_blocks} moving block, {model.unknowns} unknowns, {model.node_pairs} node pairs{refined}; "
        f"left out: {', '.join(model.left_out)}"
    ]


def _times(count: int) -> str:
    return {1: "once", 2: "twice"}.get(count, f"{count} times")


def _moves(result: Result) -> list[str]:
    one = result.at_factor_one
    if one is None:
        return []
    size = float(one.movement.displacement @ one.movement.displacement) ** 0.5
    large = "; too much for small displacements: not to be relied on"
    return [
        f"at full strength the centroid settles by {size_number(float(f'{size * 1e3:.3g}'))} mm, "
        f"{one.failed_pairs} of {result.model.node_pairs} node pairs have failed "
        f"(elastic bed: {result.design.stiffness.in_words()})" + (large if _moves_far(result, size) else "")
    ]


def _moves_far(result: Result, size: float) -> bool:
    return bool(size > 0.01 * float(result.geometry.volume_m3) ** (1.0 / 3.0))


def _time(result: Result) -> str:
    shown = ("cut", "normals", "mesh", "solve", "bound", "displacements", "all_pairs", "series", "closed_form")
    parts = [f"{name.replace('_', ' ')} {result.timing_s[name] * 1e3:.1f} ms" for name in shown
             if result.timing_s.get(name, 0.0) > 5e-5]  # fmt: skip
    return "  ".join(parts)


def _governs(result: Result) -> list[str]:
    if not result.governs:
        return []
    if result.moments_govern or result.status == "not_converged":
        return ["not given: it is read from the closed form, which does not govern here"]
    parts = []
    base = result.fos.closed_form
    for name, factor, status in result.governs:
        if factor is None:
            parts.append(f"{name}: {status_text(result.kind, status) if status in STATUSES else status}")
        elif base is None or name == "full water":
            parts.append(f"{name}: {factor:.2f}")
        else:
            parts.append(f"{name} {factor - base:+.2f}")
    return [" | ".join(parts) + "   (closed form)"] if parts else []


def _defaults(result: Result) -> list[str]:
    names = result.design.defaults
    if not names:
        return ["none of the paper's wedge was taken"] if isinstance(result.design, WedgeDesign) else []
    ours = [DEFAULT_NAMES[name] for name in names if name != "seismic.trend"]
    parts = [", ".join(ours) + " (the paper's wedge)"] if ours else []
    if "seismic.trend" in names:
        parts.append(f"seismic trend ({_OWN_WAY[result.kind]})")
    return ["; ".join(parts)]
