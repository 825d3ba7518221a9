"""Entries that the sheets of one block and of many blocks share, and how they are folded."""

import textwrap

from slopekit.arrays import Floats
from slopekit.design.blocky import AssemblyDesign
from slopekit.design.common import Bolt, Design, Force, Rule, Strength
from slopekit.design.kinds import FootingDesign, PlaneDesign, SurfaceDesign
from slopekit.design.wedge import WedgeDesign
from slopekit.extents import SectionGeometry, SurfaceGeometry, WedgeGeometry
from slopekit.orientation import Line
from slopekit.result import STATUSES, Result, status_text

WIDTH = 100
LABEL = 10
#: The rules on cohesion where moments open part of a contact.
RULES = {
    "cracked_base": "cracked base", "by_mechanism": "by mechanism", "bond_gone": "bond gone",
    "forces_alone": "forces only",
}  # fmt: skip
WEIGHT_ONLY = "weight only: dry, no seismic, no forces, no bolts"
#: The way a seismic load acts where the design gives no trend.
OWN_WAY = {
    "wedge": "along the trend of the line of intersection", "plane": "out of the slope", "footing": "out of the face",
    "surface": "the way the profile falls", "bench": "the way the face dips", "topple": "out of the slope",
    "blocks": "the way the file says",
}  # fmt: skip


def planes(result: Result) -> tuple[str, list[str]]:
    """What the block lies on, in words, and the label of that."""
    design, geometry = result.design, result.geometry
    if isinstance(design, WedgeDesign) and isinstance(geometry, WedgeGeometry):
        return "PLANES", _wedge_planes(design, geometry)
    if isinstance(design, PlaneDesign) and isinstance(geometry, SectionGeometry):
        return "PLANES", _plane_planes(design, geometry)
    if isinstance(design, FootingDesign):
        area = size_number(design.length_m)
        words = f"weak plane dips {design.dip_deg:.6g}°, {area} m long  {_strength(design.strength)}"
        return "PLANES", [words]
    if isinstance(design, SurfaceDesign) and isinstance(geometry, SurfaceGeometry):
        return "SURFACE", _surface(design, geometry)
    return "PLANES", []


def size(result: Result) -> list[str]:
    """Height, volume, weight."""
    design, geometry = result.design, result.geometry
    weight = weight_in_words(result)
    volume = f"volume {size_number(geometry.volume_m3)} m³"
    if isinstance(geometry, WedgeGeometry) and isinstance(design, WedgeDesign):
        heights = f"height {size_number(design.height_m)} m (total {size_number(geometry.total_height_m)} m)"
    elif isinstance(geometry, SectionGeometry):
        heights = f"height {size_number(geometry.total_height_m)} m"
        if isinstance(design, PlaneDesign):
            heights = f"height {size_number(design.height_m)} m (total {size_number(geometry.total_height_m)} m)"
        volume += " per metre"
    elif isinstance(geometry, SurfaceGeometry):
        heights = f"height {size_number(geometry.total_height_m)} m"
    else:
        heights = ""
    return [f"{heights}  {volume}  {weight}"]


def weight_in_words(result: Result) -> str:
    """The weight of what moves, and the unit weight it comes from."""
    design = result.design
    if not design.unit_weight_kn_m3:
        return "weight left out"
    density = "" if design.density_kg_m3 is None else f" ({design.density_kg_m3:.5g} kg/m³)"
    return f"weight {size_number(result.forces.weight)} kN  unit weight {design.unit_weight_kn_m3:.5g} kN/m³{density}"


def dilates(design: Design) -> bool:
    """Whether any joint of the design dilates as it slips."""
    if isinstance(design, WedgeDesign):
        return any(design.dilation_deg)
    if isinstance(design, AssemblyDesign):
        return any(strength.dilation_deg for _, strength in design.strengths)
    strength = getattr(design, "strength", None)
    return isinstance(strength, Strength) and bool(strength.dilation_deg)


def line_in_words(line: Line) -> str:
    """Trend and plunge as the sheet prints them."""
    return f"{line.trend_deg % 360.0:03.0f}/{line.plunge_deg:.1f}"


def _strength(strength: Strength) -> str:
    words = f"c {strength.cohesion_kpa:.1f} kPa  φ {strength.friction_angle_deg:.1f}°"
    if strength.dilation_deg:
        words += f"  ψ {strength.dilation_deg:.1f}°"
    if strength.tension_kpa:
        words += f"  σt {strength.tension_kpa:.4g} kPa"
    return words


def _wedge_planes(design: WedgeDesign, geometry: WedgeGeometry) -> list[str]:
    entries = []
    for k, plane in enumerate(design.joints):
        extra = ""
        if design.dilation_deg[k]:
            extra += f"  ψ {design.dilation_deg[k]:.1f}°"
        if design.tension_kpa[k]:
            extra += f"  σt {design.tension_kpa[k]:.4g} kPa"
        area = size_number(geometry.areas_m2[f"J{k + 1}"])
        name, own = f"J{k + 1}", design.joint_names[k]
        name += "" if own == name else f" ({own})"
        entries.append(
            f"{name} {plane}  {plane.in_words()}  c {design.cohesion_kpa[k]:.1f} kPa  "
            f"φ {design.friction_angle_deg[k]:.1f}°{extra}  area {area} m²"
        )
    entries.append(f"face {design.face}  {design.face.in_words()}")
    entries.append(f"upper {design.upper}  {design.upper.in_words()}")
    if design.crack:
        area = size_number(geometry.areas_m2["crack"])
        entries.append(
            f"crack {design.crack.plane}  {design.crack.plane.in_words()}, {design.crack.distance_m:.4g} m behind the "
            f"crest along J1  area {area} m²"
        )
    line = Line(geometry.line_trend_deg, geometry.line_plunge_deg)
    length = size_number(geometry.line_length_m)
    entries.append(f"line of intersection {line_in_words(line)}, {length} m long, daylights at the toe")
    return entries


def _plane_planes(design: PlaneDesign, geometry: SectionGeometry) -> list[str]:
    area = size_number(geometry.areas_m2[design.joint_name])
    entries = [
        f"{design.joint_name} {design.joint}  {design.joint.in_words()}  {_strength(design.strength)}  {area} m long",
        f"face {design.face}  {design.face.in_words()}",
        f"upper {design.upper}  {design.upper.in_words()}",
    ]
    if geometry.crack_depth_m is not None and geometry.crack_distance_m is not None:
        off = geometry.crack_distance_m
        where = f"{off:.4g} m behind the crest" if off >= 0.0 else f"{-off:.4g} m in front of the crest"
        entries.append(f"crack vertical, {geometry.crack_depth_m:.4g} m deep, {where}")
    return entries


def _surface(design: SurfaceDesign, geometry: SurfaceGeometry) -> list[str]:
    area = size_number(geometry.areas_m2["slip surface"])
    ground = (
        f"ground mesh {design.ground_mesh.name}"
        if design.ground_mesh is not None
        else "ground profile " + " ".join(f"({x:.6g}, {z:.6g})" for x, z in design.profile_m or ())
    )
    lets = {0: "no motion exactly", 1: "one motion"}.get(geometry.motions, f"{geometry.motions} motions")
    turned = f", turned by {geometry.misfit_deg:.2g}° to follow it" if geometry.misfit_deg else ""
    return [
        f"{design.slip.in_words()}  {_strength(design.strength)}  area {area} m²",
        f"normals {geometry.normals}, edges {geometry.edge_m:.3g} m; the surface lets {lets} through{turned}",
        ground,
    ]


def size_number(value: float) -> str:
    """Six significant digits without an exponent where a person would not write one."""
    if value == 0.0:
        return "0"
    if 1e5 <= abs(value) < 1e9:
        return f"{value:.0f}"
    if 1e-3 <= abs(value) < 1e5:
        return f"{value:.6g}" if abs(value) < 1e3 else f"{value:.1f}"
    return f"{value:.6g}"


def block(label: str, entries: list[str], hang: int = 3) -> list[str]:
    """A label and its entries, folded to the width of the sheet; what is folded hangs in by `hang`."""
    lines: list[str] = []
    for k, entry in enumerate(entries):
        head = f"{label if k == 0 else '':<{LABEL}}"
        indent = " " * (LABEL + hang)
        lines += textwrap.wrap(head + entry, WIDTH, subsequent_indent=indent, drop_whitespace=True) or [head]
    return lines


def loads(result: Result) -> list[str]:
    """What acts on one block beside its weight."""
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
    entries += seismic(design, result.kind == "surface")
    entries += [force_text(force) for force in design.forces]
    entries += [bolt_text(bolt) for bolt in design.bolts]
    return entries or [WEIGHT_ONLY]


def seismic(design: Design, in_section: bool) -> list[str]:
    """The seismic load, if there is one."""
    if not design.seismic.coefficient:
        return []
    trend = design.seismic.trend_deg
    toward = f"toward {trend:03.0f}" if trend is not None else OWN_WAY[design.kind]
    toward += " (x is 090)" if trend is not None and in_section else ""
    return [f"seismic {design.seismic.coefficient:.4g} g {toward}"]


def force_text(force: Force) -> str:
    """A force by its components, and where it acts."""
    on = "" if force.block is None else f" on {force.block}"
    at = "" if force.at_m is None else " at ({:.6g}, {:.6g}, {:.6g})".format(*force.at_m)
    size = max(abs(part) for part in force.components_kn)
    parts = [0.0 if abs(part) < 1e-12 * size else part for part in force.components_kn]
    return "force ({:.6g}, {:.6g}, {:.6g}) kN east, north, up".format(*parts) + on + at


def bolt_text(bolt: Bolt) -> str:
    """A bolt by its force, its direction, and how it acts."""
    role = "a load" if bolt.acts == "active" else "capacity divided by F"
    on = "" if bolt.block is None else f" on {bolt.block}"
    at = "" if bolt.head_m is None else " from ({:.6g}, {:.6g}, {:.6g})".format(*bolt.head_m)
    return f"bolt {bolt.force_kn:.6g} kN toward {line_in_words(bolt.toward)}{on}{at}, {bolt.acts} ({role})"


def methods(result: Result) -> list[str]:
    """The methods of columns, which know other mechanics: printed beside, not compared."""
    if not result.methods:
        return []
    names = {"fellenius": "Fellenius", "janbu": "Janbu (simplified)", "bishop": "Bishop (simplified)",
             "all_equilibrium": "all equilibrium"}  # fmt: skip
    found = [f"{names[name]} {factor_text(value).strip()}" for name, value in result.methods.items()]
    return ["  ".join(found) + "   (other mechanics: not compared)"]


def series(result: Result) -> list[str]:
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


def factor_text(value: float | None) -> str:
    """A factor of safety with four decimals, six columns wide below 10."""
    return "  none" if value is None else f"{value:.4f}" if value < 1e4 else f"{value:.4g}"


def verdict(result: Result) -> str:
    """Whether the limit agrees with the closed form, and by how much it differs."""
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


def all_pairs(result: Result) -> list[str]:
    """The search of the paper's criterion: its bracket and the failed pairs of its trials."""
    pairs = result.all_pairs
    if pairs is None:
        return []
    low, high = pairs.bracket
    if result.fos.all_pairs_failed is None:
        rests = "the blocks rest" if result.findings is not None else "the block rests"
        return [f"not found: the search met no factor at which {rests} on sticking pairs"]
    stands = "the blocks still stand there" if result.findings is not None else "the block still stands there"
    how = "equilibrium lost there" if pairs.lost_equilibrium else stands
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


def accept(result: Result) -> list[str]:
    """The acceptance rules, each with its judgement."""
    return [f"{rule}{_judged_on(result, rule)}: {_judgement(result, rule)}" for rule in result.design.rules]


def _judged_on(result: Result, rule: Rule) -> str:
    named: str = result.design.criterion if rule.name == "fos" else ""
    return f" ({named})" if named else ""


def _judgement(result: Result, rule: Rule) -> str:
    if result.judged(rule):
        lowest = result.fos.lowest
        if lowest is not None and rule.name in ("fos", "fos.limit") and not rule.met(lowest):
            return f"MET, but not for every locked-in force (same mechanism down to {lowest:.4g})"
        return "MET"
    if result.agree is False or result.status == "not_converged":
        return "NOT MET (the methods disagree or did not converge: no number to judge)"
    if result.fos.limit is None and result.status != "no_driving_force":
        return "NOT MET (no factor of safety)"
    if result.value_of(rule) is None:
        return "NOT MET (there is no such number here)"
    return "NOT MET"


def times(count: int) -> str:
    """How often, in words."""
    return {1: "once", 2: "twice"}.get(count, f"{count} times")


def cohesion(result: Result) -> list[str]:
    """Where moments open part of a contact with cohesion: the factor by each rule, and the evidence."""
    found = result.cohesion_under_moments
    if found is None:
        return []
    named = {"cracked_base": found.cracked_base, "by_mechanism": found.by_mechanism, "bond_gone": found.bond_gone}
    parts = [f"{RULES[name]} {'none' if value is None else f'{value:.4g}'}" for name, value in named.items()]
    said = f"{', '.join(parts)}; used: {RULES[found.rule]}"
    for name, contact in found.evidence.items():
        said += f"; {name} {_share(contact.pressed_share)} pressed"
        if contact.resultant_m is not None:
            said += f", force at {_place(contact.resultant_m)}"
        if contact.opens_at_m is not None:
            said += f", opens from {_place(contact.opens_at_m)}"
    return [said]


def _share(part: float) -> str:
    return f"{part * 100:.3g} %"


def _place(point: Floats) -> str:
    return "(" + ", ".join(f"{value:.4g}" for value in point.tolist()) + ")"


def governs(result: Result) -> list[str]:
    """What changes the factor of safety most, by the closed form."""
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
