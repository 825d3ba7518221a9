"""The sheet: one wedge on one screen, 100 columns, no colour needed. Never a bare factor of safety."""

import textwrap

from slopekit._version import __version__
from slopekit.design.wedge import DEFAULT_NAMES
from slopekit.orientation import Line, line_of
from slopekit.result import STATUSES, WedgeResult

WIDTH = 100
_LABEL = 10


def wedge_sheet(result: WedgeResult) -> str:
    """The sheet of a wedge result, lines joined, no trailing newline."""
    lines = [f"slopekit {__version__}   wedge   sha {result.design.input_hash()[:6]}"]
    lines += _block("PLANES", _planes(result))
    lines += _block("SIZE", _size(result))
    lines += _block("LOADS", _loads(result))
    lines += _block("FORCES", _forces(result))
    lines += _block("STATUS", [_status(result)])
    lines += _block("FoS", _factors(result))
    lines += _block("ROTATION", [_rotation(result)])
    lines += _block("ALL PAIRS", _all_pairs(result))
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


def _planes(result: WedgeResult) -> list[str]:
    design, geometry = result.design, result.geometry
    entries = []
    for k, plane in enumerate(design.joints):
        extra = ""
        if design.dilation_deg[k]:
            extra += f"  ψ {design.dilation_deg[k]:.1f}°"
        if design.tension_kpa[k]:
            extra += f"  σt {design.tension_kpa[k]:.4g} kPa"
        area = _size_number(geometry.areas_m2[f"J{k + 1}"])
        entries.append(
            f"J{k + 1} {plane}  {plane.in_words()}  c {design.cohesion_kpa[k]:.1f} kPa  "
            f"φ {design.friction_angle_deg[k]:.1f}°{extra}  area {area} m²"
        )
    entries.append(f"face {design.face}  {design.face.in_words()}")
    entries.append(f"upper {design.upper}  {design.upper.in_words()}")
    if design.crack:
        area = _size_number(geometry.areas_m2["crack"])
        entries.append(
            f"crack {design.crack.plane}  {design.crack.plane.in_words()}, {design.crack.distance_m:.4g} m behind the "
            f"crest along J1  area {area} m²"
        )
    line = Line(geometry.line_trend_deg, geometry.line_plunge_deg)
    entries.append(
        f"line of intersection {_line(line)}, {_size_number(geometry.line_length_m)} m long, daylights at the toe"
    )
    return entries


def _line(line: Line) -> str:
    return f"{line.trend_deg % 360.0:03.0f}/{line.plunge_deg:.1f}"


def _size(result: WedgeResult) -> list[str]:
    geometry, design = result.geometry, result.design
    density = f" ({design.density_kg_m3:.5g} kg/m³)" if design.density_kg_m3 is not None else ""
    return [
        f"height {_size_number(design.height_m)} m (total {_size_number(geometry.total_height_m)} m)  "
        f"volume {_size_number(geometry.volume_m3)} m³  weight {_size_number(result.forces.weight)} kN  "
        f"unit weight {design.unit_weight_kn_m3:.5g} kN/m³{density}"
    ]


def _loads(result: WedgeResult) -> list[str]:
    design = result.design
    entries = []
    if design.water.mode != "dry":
        entries.append(f"water {design.water.in_words()}")
    if design.seismic.coefficient:
        trend = design.seismic.trend_deg
        toward = f"toward {trend:03.0f}" if trend is not None else "along the trend of the line of intersection"
        entries.append(f"seismic {design.seismic.coefficient:.4g} g {toward}")
    for force in design.forces:
        at = "" if force.at_m is None else " at ({:.6g}, {:.6g}, {:.6g})".format(*force.at_m)
        size = max(abs(part) for part in force.components_kn)
        parts = [0.0 if abs(part) < 1e-12 * size else part for part in force.components_kn]
        entries.append("force ({:.6g}, {:.6g}, {:.6g}) kN east, north, up".format(*parts) + at)
    for bolt in design.bolts:
        role = "a load" if bolt.acts == "active" else "capacity divided by F"
        at = "" if bolt.head_m is None else " from ({:.6g}, {:.6g}, {:.6g})".format(*bolt.head_m)
        entries.append(f"bolt {bolt.force_kn:.6g} kN toward {_line(bolt.toward)}{at}, {bolt.acts} ({role})")
    return entries or ["weight only: dry, no seismic, no forces, no bolts"]


def _forces(result: WedgeResult) -> list[str]:
    forces, areas = result.forces, result.geometry.areas_m2
    parts = []
    for joint, normal in forces.normal.items():
        if normal is not None:
            parts.append(f"N' {joint} {_size_number(normal)} kN ({normal / areas[joint]:.4g} kPa)")
    wet = [f"{name} {_size_number(push)} kN" for name, push in forces.water.items() if push]
    parts.append("water " + (", ".join(wet) if wet else "0"))
    if forces.driving is not None and forces.resisting is not None:
        alone = " (forces alone)" if result.moments_govern else ""
        parts.append(f"driving {_size_number(forces.driving)} kN")
        parts.append(f"resisting {_size_number(forces.resisting)} kN{alone}")
    return ["  ".join(parts)]


def _status(result: WedgeResult) -> str:
    text = STATUSES[result.status]
    if result.mechanism is not None and result.status.startswith("slides"):
        text += f", along {_line(line_of(result.mechanism.displacement))}"
    return text


def _factors(result: WedgeResult) -> list[str]:
    fos = result.fos
    entries = []
    assumption = "PRE-IE" if not any(result.design.dilation_deg) else "PRE-IE, joints dilate as given"
    entries.append(f"{_factor(fos.limit)}  limit, {assumption}       {_verdict(result)}")
    if result.moments_govern and result.forces_only is not None:
        entries.append(
            f"{_factor(result.forces_only)}  forces only, PRE-IE (no turning: the closed form's assumptions)"
        )
    zero = ", zero dilation" if any(result.design.dilation_deg) else ""
    entries.append(f"{_factor(fos.closed_form)}  Hoek & Bray closed form{zero}")
    if fos.static_bound is not None:
        entries.append(f"{_factor(fos.static_bound)}  static bound (joints free to dilate; upper bound)")
    if fos.all_pairs_failed is not None:
        entries.append(
            f"{_factor(fos.all_pairs_failed)}  all pairs failed (the paper's criterion; depends on the stiffness)"
        )
    return entries


def _factor(value: float | None) -> str:
    return "  none" if value is None else f"{value:.4f}" if value < 1e4 else f"{value:.4g}"


def _verdict(result: WedgeResult) -> str:
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


def _rotation(result: WedgeResult) -> str:
    if result.status == "topples":
        return "first: moments turn the wedge over before any strength is called on"
    if result.moments_govern and result.forces_only and result.fos.limit:
        less = (1.0 - result.fos.limit / result.forces_only) * 100
        return f"first: moments lower the limit by {less:.1f} % below what forces alone give"
    if result.status in ("lifted", "falls", "no_driving_force", "not_converged"):
        return "not asked: " + (
            "nothing drives the wedge" if result.status == "no_driving_force" else STATUSES[result.status]
        )
    return "not first: with moments the wedge slides at the same factor, or only at a higher one"


def _all_pairs(result: WedgeResult) -> list[str]:
    pairs = result.all_pairs
    if pairs is None:
        return []
    low, high = pairs.bracket
    if result.fos.all_pairs_failed is None:
        return ["not found: the search met no factor at which the wedge rests on sticking pairs"]
    how = "equilibrium lost there" if pairs.lost_equilibrium else "the wedge still stands there"
    law = result.design.stiffness
    shear = "Clough-Duncan" if law.shear_kn_m3 is None else f"{law.shear_kn_m3:.4g} kN/m³"
    entries = [f"bracket {low:.5f} to {high:.5f} ({how}); k_n {law.normal_kn_m3:.4g} kN/m³, k_t {shear}"]
    trials = sorted(pairs.history)
    counts = [count for _, count in trials]
    shown = [
        f"{factor:.5f}: {count}"
        for k, (factor, count) in enumerate(trials)
        if k in (0, len(trials) - 1) or counts[k - 1] != count or counts[k + 1] != count
    ]
    entries.append(f"failed pairs of {result.model.node_pairs} by factor  " + "  ".join(shown))
    return entries


def _accept(result: WedgeResult) -> list[str]:
    if result.accepted is None:
        return []
    verdict = "MET" if result.accepted else "NOT MET"
    if result.agree is False or result.status == "not_converged":
        verdict = "NOT MET (the methods disagree or did not converge: no number to judge)"
    elif result.criterion_fos is None and result.status != "no_driving_force":
        verdict = "NOT MET (no factor of safety)"
    return [f"fos >= {result.design.accept:g} ({result.design.criterion}): {verdict}"]


def _model(result: WedgeResult) -> list[str]:
    model = result.model
    refined = f", triangles split {_times(model.refined)}" if model.refined else ""
    return [
        f"{model.moving_blocks} moving block, {model.unknowns} unknowns, {model.node_pairs} node pairs{refined}; "
        f"left out: {', '.join(model.left_out)}"
    ]


def _times(count: int) -> str:
    return {1: "once", 2: "twice"}.get(count, f"{count} times")


def _moves(result: WedgeResult) -> list[str]:
    one = result.at_factor_one
    if one is None:
        return []
    size = float(one.movement.displacement @ one.movement.displacement) ** 0.5
    law = result.design.stiffness
    shear = "Clough-Duncan" if law.shear_kn_m3 is None else f"{law.shear_kn_m3:.4g} kN/m³"
    large = "; too much for small displacements: not to be relied on"
    return [
        f"at full strength the centroid settles by {_size_number(float(f'{size * 1e3:.3g}'))} mm, "
        f"{one.failed_pairs} of {result.model.node_pairs} node pairs have failed "
        f"(elastic bed: k_n {law.normal_kn_m3:.4g} kN/m³, k_t {shear})" + (large if _moves_far(result, size) else "")
    ]


def _moves_far(result: WedgeResult, size: float) -> bool:
    return size > 0.01 * result.design.height_m


def _time(result: WedgeResult) -> str:
    shown = ("cut", "mesh", "solve", "bound", "displacements", "all_pairs", "closed_form")
    parts = [f"{name.replace('_', ' ')} {result.timing_s[name] * 1e3:.1f} ms" for name in shown
             if result.timing_s.get(name, 0.0) > 5e-5]  # fmt: skip
    return "  ".join(parts)


def _governs(result: WedgeResult) -> list[str]:
    if result.moments_govern or result.status == "not_converged":
        return ["not given: it is read from the closed form, which does not govern here"]
    parts = []
    base = result.fos.closed_form
    for name, factor, status in result.governs:
        if factor is None:
            parts.append(f"{name}: {STATUSES.get(status, status)}")
        elif base is None or name == "full water":
            parts.append(f"{name}: {factor:.2f}")
        else:
            parts.append(f"{name} {factor - base:+.2f}")
    return [" | ".join(parts) + "   (closed form)"] if parts else []


def _defaults(result: WedgeResult) -> list[str]:
    names = result.design.defaults
    if not names:
        return ["none: every value was given"]
    ours = [DEFAULT_NAMES[name] for name in names if name != "seismic.trend"]
    parts = [", ".join(ours) + " (the paper's wedge)"] if ours else []
    if "seismic.trend" in names:
        parts.append("seismic trend (the line of intersection's)")
    return ["; ".join(parts)]


def _size_number(value: float) -> str:
    """Six significant digits without an exponent where a person would not write one."""
    if value == 0.0:
        return "0"
    if 1e5 <= abs(value) < 1e9:
        return f"{value:.0f}"
    if 1e-3 <= abs(value) < 1e5:
        return f"{value:.6g}" if abs(value) < 1e3 else f"{value:.1f}"
    return f"{value:.6g}"
