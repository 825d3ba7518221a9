"""The sheet: one design on one screen, 100 columns, no colour needed. Never a bare factor of safety."""

import textwrap
from collections.abc import Iterator
from typing import Any

from slopekit._version import __version__
from slopekit.core.sheet import WIDTH, block, factor_text
from slopekit.kinds import dilates, kind_of
from slopekit.kinds.words import SheetPart, line_in_words, size_number
from slopekit.notices import INVENTED
from slopekit.orientation import line_of
from slopekit.result import Result
from slopekit.views.assembly_sheet import assembly_parts
from slopekit.views.entries import (
    accept,
    all_pairs,
    cohesion,
    curved_strength,
    forces,
    governs,
    leading,
    methods,
    series,
    times,
    verdict,
)

_NARROW = 2e-3  # a range of factors narrower than this part is not printed: node pairs are not refined any closer


def sheet(result: Result) -> str:
    """The sheet of a result of any kind, lines joined, no trailing newline."""
    title = f"   {result.design.title}" if result.design.title else ""
    lines = textwrap.wrap(
        f"slopekit {__version__}   {result.kind}   sha {result.design.input_hash()[:6]}{title}", WIDTH
    )
    for part in _parts(result):
        lines += block(part.label, part.entries, part.hang)
    return "\n".join(lines)


def document_of(result: Result) -> dict[str, Any]:
    """The JSON of a result with the words of its sheet, `sheet`: entries by label; times stand in their own block."""
    words = {part.label: part.entries for part in _parts(result) if part.entries and part.label != "TIME"}
    return result.to_dict() | {"sheet": words}


def _parts(result: Result) -> Iterator[SheetPart]:
    """The parts below the head line, in order; those without entries print nothing."""
    yield from kind_of(result.design).slope(result.design, result)
    if result.design.bolts:
        from slopekit.views.bolt_schedule import schedule, schedule_lines

        document = {"inputs": result.design.inputs(), "geometry": result.geometry.to_dict()}
        yield SheetPart("BOLTS", schedule_lines(schedule(document)))
    if result.findings is not None:
        yield from assembly_parts(result, result.findings)
        return
    yield SheetPart("FORCES", forces(result))
    yield SheetPart("STATUS", [_status(result)])
    yield SheetPart("FoS", _factors(result))
    yield SheetPart("COLUMNS", methods(result))
    yield SheetPart("ROTATION", _rotation(result))
    yield SheetPart("STRENGTH", curved_strength(result))
    yield SheetPart("COHESION", cohesion(result))
    yield SheetPart("ALL PAIRS", all_pairs(result))
    yield SheetPart("SERIES", series(result))
    yield SheetPart("ACCEPT", accept(result))
    yield SheetPart("MODEL", _model(result))
    yield SheetPart("MOVES", _moves(result))
    yield SheetPart("TIME", [_time(result)])
    yield SheetPart("GOVERNS", governs(result))
    yield SheetPart("DEFAULTS", _defaults(result))
    yield SheetPart("NOTE", [str(one) for one in result.warnings if one.code != INVENTED])


def _status(result: Result) -> str:
    text = result.status_text
    if result.mechanism is not None and result.status.startswith("slides") and result.words.along:
        text += f", along {line_in_words(line_of(result.mechanism.displacement))}"
    return text


def _factors(result: Result) -> list[str]:
    fos = result.fos
    entries = leading(result)
    dilating = dilates(result.design)
    assumption = "PRE-IE, joints dilate as given" if dilating else "PRE-IE"
    assumption += result.words.assumes
    curved = result.curved_strength
    if curved is not None:
        assumption += ", strength of each node pair at its own normal traction"
    if (fos.closed_form is None and result.agree is None) or curved is not None:
        entries.append(f"{factor_text(fos.limit)}  limit, {assumption}")
    else:
        entries.append(f"{factor_text(fos.limit)}  limit, {assumption}       {verdict(result)}")
    if fos.lowest is not None and (fos.highest is None or fos.highest > (1.0 + _NARROW) * fos.lowest):
        ends = f"{factor_text(fos.lowest).strip()} .. {factor_text(fos.highest).strip()}"
        entries.append(f"{ends}  same mechanism, whatever forces are locked in")
    if result.moments_govern and result.forces_only is not None:
        entries.append(
            f"{factor_text(result.forces_only)}  forces only, PRE-IE (no turning: the closed form's assumptions)"
        )
    if curved is not None and curved.mean_stress is not None and fos.closed_form is not None:
        entries.append(f"{factor_text(curved.mean_stress)}  one traction a plane, PRE-IE       {verdict(result)}")
    zero = ", zero dilation" if dilating else ""
    zero += "" if curved is None else ", secant at the mean normal traction of each plane"
    if fos.closed_form is None and result.agree is None:
        entries.append(f"  none  closed form: {result.words.no_closed_form}")
    else:
        entries.append(f"{factor_text(fos.closed_form)}  {result.words.closed_form}{zero}")
    if fos.static_bound is not None:
        entries.append(f"{factor_text(fos.static_bound)}  static bound (joints free to dilate; upper bound)")
    if fos.all_pairs_failed is not None:
        entries.append(
            f"{factor_text(fos.all_pairs_failed)}  all pairs failed (the paper's criterion; depends on the stiffness)"
        )
    return entries


def _rotation(result: Result) -> list[str]:
    if not result.words.turns:
        return []
    what = result.words.block
    if result.status == "topples":
        return [f"first: moments turn the {what} over, {result.turns_over}"]
    if result.moments_govern and result.forces_only and result.fos.limit:
        less = (1.0 - result.fos.limit / result.forces_only) * 100
        return [f"first: moments lower the limit by {less:.1f} % below what forces alone give"]
    if result.status in ("lifted", "falls", "no_driving_force", "not_converged"):
        because = f"nothing drives the {what}" if result.status == "no_driving_force" else result.status_text
        return [f"not asked: {because}"]
    return [f"not first: with moments the {what} slides at the same factor, or only at a higher one"]


def _model(result: Result) -> list[str]:
    model = result.model
    refined = f", triangles split {times(model.refined)}" if model.refined else ""
    return [
        f"{model.moving_blocks} moving block, {model.unknowns} unknowns, {model.node_pairs} node pairs{refined}; "
        f"left out: {', '.join(model.left_out)}"
    ]


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


def _defaults(result: Result) -> list[str]:
    names = result.design.defaults
    if not names:
        return ["none of the paper's wedge was taken"] if kind_of(result.design).paper_keys else []
    ours = ["φ" if name == "phi" else name for name in names if name != "seismic.trend"]
    parts = [", ".join(ours) + " (the paper's wedge)"] if ours else []
    if "seismic.trend" in names:
        parts.append(f"seismic trend ({result.words.seismic})")
    return ["; ".join(parts)]
