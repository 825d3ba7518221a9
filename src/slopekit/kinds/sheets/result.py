"""The sheet of a result: one design on one screen, 100 columns, no colour needed. Never a bare factor of safety."""

from collections.abc import Iterable, Iterator
from operator import attrgetter

import numpy as np

from slopekit._version import __version__
from slopekit.core.orientation import line_of
from slopekit.core.sheet import TIME, Column, Section, Sheet, Table, factor_text
from slopekit.design.parts import FactoredNumber, PartialFactors
from slopekit.kinds import dilates, kind_of
from slopekit.kinds.sheets import shared
from slopekit.kinds.sheets.shared import Factor
from slopekit.kinds.words import line_in_words, size_number
from slopekit.notices import INVENTED
from slopekit.result import Result

_WHOLE = 5e-4  # of a joint: so little of it that opens is rounding


def sheet_of(result: Result) -> Sheet:
    """The sheet of a result of any kind."""
    title = f"   {result.design.title}" if result.design.title else ""
    head = f"slopekit {__version__}   {result.kind}   sha {result.design.input_hash()[:6]}{title}"
    slope = tuple(kind_of(result.design).slope(result.design, result))
    own: Iterable[Section] = _sections(result)
    if result.findings is not None:
        from slopekit.kinds.sheets.many_blocks import sections_of_many

        own = sections_of_many(result, result.findings)
    if result.design.partial is not None:
        slope = (*slope, _partial_factors(result.design.partial))
    if not result.design.bolts:  # most designs have none: they load nothing of it
        return Sheet(head, (*slope, *own))
    from slopekit.core.codec import json_of
    from slopekit.kinds.sheets.bolts import FILE, schedule, schedule_entries, schedule_table

    bolts = schedule({"inputs": result.design.inputs(), "geometry": json_of(result.geometry)})
    return Sheet(head, (*slope, Section("BOLTS", schedule_entries(bolts)), *own), {FILE: schedule_table(bolts)})


def _sections(result: Result) -> Iterator[Section]:
    """The sections of one block below what was analysed, in order."""
    yield Section("FORCES", (), details=shared.forces(result))
    yield Section("STATUS", [_status(result)])
    yield Section("FoS", [shared.factors_table(result, _factors(result))])
    yield from shared.elastic(result)
    yield Section("COLUMNS", shared.methods(result))
    yield Section("MOMENTS", moments(result))
    yield Section("STRENGTH", shared.curved_strength(result))
    yield Section("ALL PAIRS", shared.all_pairs(result))
    yield Section("SERIES", shared.series(result))
    yield Section("ACCEPT", shared.accept(result))
    yield Section("MECHANISM", shared.mechanisms(result))
    yield Section("MODEL", (), details=_model(result))
    yield Section("MOVES", _large_movement(result), details=_movement(result))
    yield Section(TIME, [_time(result)])
    yield Section("SENSITIVITY", (), details=shared.governs(result))
    yield Section("NOT GIVEN", _not_given(result))
    yield Section("NOTE", [str(notice) for notice in result.warnings if notice.code != INVENTED])


def _status(result: Result) -> str:
    text = result.status_text
    if result.limit_state.mechanism is not None and result.status.startswith("slides") and result.words.along:
        text += f" toward {line_in_words(line_of(result.limit_state.mechanism.displacement))}"
    return text


def _factors(result: Result) -> Iterator[Factor]:
    fos, curved = result.fos, result.limit_state.curved_strength
    is_compared = fos.closed_form is not None or result.agree is not None
    is_dilating = dilates(result.design)
    limit = f"PRE-IE{', joints dilate as given' if is_dilating else ''}{result.words.assumes}"
    limit += ", strength of each node pair at its own normal traction" if curved else ""
    yield Factor(fos.limit, limit)
    if fos.lowest is not None:
        yield Factor(fos.lowest, shared.LOWEST)
    closed = f"closed form: {result.words.no_closed_form}"
    if is_compared:
        assumptions = [", forces only"] * result.words.turns + [", zero dilation"] * is_dilating
        closed = f"{result.words.closed_form}{''.join(assumptions)}"
        closed += ", secant at the mean normal traction of each plane" if curved else ""
    yield Factor(fos.closed_form, closed, shared.verdict(result) if is_compared else "")
    if fos.static_bound is not None:
        yield Factor(fos.static_bound, shared.UPPER_BOUND)
    elif fos.limit is not None:
        yield Factor(None, "upper bound: not found")
    if fos.all_pairs_failed is not None:
        yield Factor(fos.all_pairs_failed, "all pairs failed (the paper's criterion; depends on the stiffness)")


def moments(result: Result) -> list[str]:
    """Return what moments do to the factor of safety of one block, where they matter."""
    fos, forces = result.fos, result.comparisons.forces_only
    if not result.words.turns or not result.moments_govern:
        return []
    if result.status == "topples":
        unused = "" if forces is None else f" (forces only would give {factor_text(forces)}: do not use it)"
        return [f"they turn the {result.words.block} over{unused}"]
    if fos.limit is None:
        return []
    opened = [
        f"{(1.0 - opening.pressed_share) * 100:.3g} % of {name}"
        for name, opening in result.limit_state.openings.items()
        if opening.pressed_share < 1.0 - _WHOLE
    ]
    change = "lower the FoS"
    if opened:
        verbs = "open at failure and carry" if len(opened) > 1 else "opens at failure and carries"
        change = f"{' and '.join(opened)} {verbs} no cohesion: FoS"
    limit, alone = factor_text(fos.limit), "" if forces is None else f" (forces only {factor_text(forces)})"
    lines = [f"{change} {limit}{alone}" if opened else f"moments {change} to {limit}{alone}"]
    closed, bound = factor_text(fos.closed_form), factor_text(fos.static_bound)
    if fos.static_bound is not None and fos.closed_form is not None and float(bound) < float(closed):
        lines.append(f"no distribution of forces can balance at the closed form's {closed} (upper bound {bound})")
    return lines


def _model(result: Result) -> list[str]:
    model = result.model
    refined = f", triangles split {shared.times(model.refined)}" if model.refined else ""
    return [
        f"{model.moving_blocks} moving block, {model.unknowns} unknowns, {model.node_pairs} node pairs{refined}; "
        f"left out: {', '.join(model.left_out)}"
    ]


def _movement(result: Result) -> list[str]:
    """Displacement at full strength on elastic joints."""
    state = result.displacements.at_factor_one
    if state is None:
        stands = result.fos.limit is not None and result.fos.limit > 1.0
        return ["no displacement at F = 1: no equilibrium was found on elastic joints"] if stands else []
    failed, pairs = state.failed_pairs, result.model.node_pairs
    yielding = f"{failed} of {pairs} node pairs yield" if failed else "no yielding"
    return [
        f"displacement at F = 1 on elastic joints: {size_number(float(f'{_size_m(result) * 1e3:.3g}'))} mm, {yielding} "
        f"({result.design.stiffness.in_words()})"
    ]


def _large_movement(result: Result) -> list[str]:
    """Return the caution of a displacement that is no small one."""
    if _size_m(result) <= 0.01 * float(result.geometry.volume_m3) ** (1.0 / 3.0):
        return []
    return [f"{_size_m(result) * 1e3:.3g} mm at F = 1: too much for small displacements, not to be relied on"]


def _size_m(result: Result) -> float:
    """Return the displacement of the centroid at full strength, m; 0 where it is not known."""
    state = result.displacements.at_factor_one
    return 0.0 if state is None else float(np.linalg.norm(state.movement.displacement))


def _time(result: Result) -> str:
    shown = ("cut", "normals", "mesh", "solve", "bound", "displacements", "all_pairs", "series", "closed_form")
    parts = [f"{name.replace('_', ' ')} {result.timing_s[name] * 1e3:.1f} ms" for name in shown
             if result.timing_s.get(name, 0.0) > 5e-5]  # fmt: skip
    return "  ".join(parts)


def _not_given(result: Result) -> list[str]:
    """Return the inputs that took an example value, or a direction of the program's choice."""
    names = ["φ" if name == "phi" else name for name in result.design.defaults if name != "seismic.trend"]
    entries = [f"example values used: {', '.join(names)}"] if names else []
    if "seismic.trend" in result.design.defaults:
        entries.append("seismic trend (as under LOADS)")
    return ["; ".join(entries)] if entries else []


def _partial_factors(given: PartialFactors) -> Section:
    """Whose factors they are, what they have made, and how to read the factor of safety."""
    columns: list[Column[FactoredNumber]] = [
        Column("of", attrgetter("what"), "what", width=-47),
        Column("characteristic", attrgetter("characteristic"), "characteristic", show=".5g", width=14),
        Column("factor", _factor, "factor", width=9),
        Column("design", attrgetter("design"), "design", show=".5g", width=10),
        Column(" unit", attrgetter("unit"), "unit", width=-1, about=" {}"),
    ]
    said = given.called + (f" ({given.source})" if given.source else "")
    end = "all numbers above are design values, and FoS is the over-design factor: 1 is enough"
    return Section("FACTORED", [f"{said}: {end}", Table(columns, given.table)])


def _factor(row: FactoredNumber) -> str:
    return "" if row.factor is None else f"{'/' if row.divided else 'x'} {row.factor:.4g}"
