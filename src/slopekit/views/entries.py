"""Entries that the sheets of one block and of many blocks share, and how they are folded."""

from slopekit.arrays import Floats
from slopekit.core.sheet import factor_text
from slopekit.design.common import Rule
from slopekit.kinds.words import first_and_last, size_number
from slopekit.result import JUDGED, STATUSES, Result

#: The rules on cohesion where moments open part of a contact.
RULES = {
    "cracked_base": "cracked base", "by_mechanism": "by mechanism", "bond_gone": "bond gone",
    "forces_alone": "forces only",
}  # fmt: skip


def forces(result: Result) -> list[str]:
    """Normal forces by interface, water, and what drives and resists along the movement."""
    found, areas = result.forces, result.geometry.areas_m2
    parts = []
    for joint, normal in found.normal.items():
        if normal is not None:
            area = areas.get(joint)
            parts.append(f"N' {joint} {size_number(normal)} kN" + (f" ({normal / area:.4g} kPa)" if area else ""))
    shown, rest, _ = first_and_last(parts, 6, 0)
    more = [f"... and {rest} more"] if rest else []
    wet = [f"{name} {size_number(push)} kN" for name, push in found.water.items() if push]
    some, others, _ = first_and_last(wet, 6, 0)
    water = "water " + (", ".join([*some, *([f"... and {others} more"] if others else [])]) or "0")
    held = [
        f"{what} {size_number(value)} kN"
        for what, value in (("driving", found.driving), ("resisting", found.resisting))
        if value is not None
    ]
    alone = " (forces alone)" if result.moments_govern and held else ""
    return ["  ".join([*shown, *more, water, *held]) + alone]


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
    horizontal = result.words.horizontal
    entries = [f"factor   {horizontal + ' / mm':>16}{'up / mm':>12}{'failed of ' + str(result.model.node_pairs):>14}"]
    for step in result.series:
        if step.movement is None:
            entries.append(f"{step.factor:6.4f}   {'does not come to rest':>28}{step.failed_pairs:>14}")
            continue
        x, y, z = (float(part) * 1e3 for part in step.movement.displacement)
        across = x if horizontal == "x" else (x * x + y * y) ** 0.5
        entries.append(f"{step.factor:6.4f}   {across:16.4f}{z:12.4f}{step.failed_pairs:14d}")
    return entries


def leading(result: Result) -> list[str]:
    """The number that acceptance hangs on where it lies below the limit: it stands first."""
    if result.leading is None:
        return []
    name, value = result.leading
    what = "lowest of the same mechanism, whatever forces are locked in" if name == "lowest" else JUDGED[name]
    return [f"{factor_text(value)}  {what}: the factor that ACCEPT hangs on"]


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


def _said(result: Result, status: str) -> str:
    return result.design.in_own_names(result.words.status(status)) if status in STATUSES else status


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


def curved_strength(result: Result) -> list[str]:
    """Where strength is curved: the line of each joint at its mean normal traction, and what the mean leaves out."""
    found = result.curved_strength
    if found is None:
        return []
    said = []
    for name, line in found.lines.items():
        low, high = line.range_kpa
        said.append(
            f"{name} at {line.traction_kpa:.4g} kPa (node pairs {low:.4g} .. {high:.4g}): "
            f"c {line.cohesion_kpa:.4g} kPa  φ {line.friction_angle_deg:.2f}°, the secant of its law"
        )
    if found.gap is not None:
        said.append(
            f"the tractions of the node pairs lower the limit by {-found.gap * 100:.2f} % below that of one mean "
            "traction a joint"
        )
    return said


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
            parts.append(f"{name}: {_said(result, status)}")
        elif base is None or name == "full water":
            parts.append(f"{name}: {factor:.2f}")
        else:
            parts.append(f"{name} {factor - base:+.2f}")
    return [" | ".join(parts) + "   (closed form)"] if parts else []
