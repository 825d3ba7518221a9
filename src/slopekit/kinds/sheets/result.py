"""The sheet of a result: one design on one screen, 100 columns, no colour needed. Never a bare factor of safety."""

from collections.abc import Iterator
from operator import attrgetter

import numpy as np

from slopekit._version import __version__
from slopekit.core.orientation import line_of
from slopekit.core.sheet import TIME, Column, Section, Sheet, Table, counted, factor_text
from slopekit.design.parts import FactoredNumber, PartialFactors
from slopekit.kinds import dilates, kind_of
from slopekit.kinds.sheets import shared
from slopekit.kinds.sheets.shared import Factor
from slopekit.kinds.words import line_in_words, short, times
from slopekit.notices import EXAMPLE_INPUTS_CODE
from slopekit.result import Result

_OPEN_ROUNDING = 5e-4  # of a joint: so little of it that opens is rounding
_LEAST_CHANGE = 5e-3  # of a factor


def sheet_of(result: Result) -> Sheet:
    """The sheet of a result of any kind."""
    design, tables = result.design, {}
    title = f"   {design.title}" if design.title else ""
    sections = [*kind_of(design).slope(design, result)]
    if design.analysis.partial is not None:
        sections.append(_partial_factors(design.analysis.partial))
    if design.bolts:  # most designs have none: they load nothing of it
        from slopekit.core.codec import json_of
        from slopekit.kinds.sheets.bolts import FILE, schedule, schedule_entries, schedule_table

        bolts = schedule({"inputs": design.inputs(), "geometry": json_of(result.geometry)})
        sections.append(Section("BOLTS", schedule_entries(bolts)))
        tables[FILE] = schedule_table(bolts)
    head = f"slopekit {__version__}   {result.kind}{title}"
    return Sheet(head, (*sections, *_sections(result)), tables, design.input_hash())


def _sections(result: Result) -> Iterator[Section]:
    """The sections below what was analysed, in order; those without entries print nothing."""
    many = result.findings
    yield Section("FORCES", (), details=shared.forces(result))
    yield Section("STATUS", [_status(result)])
    yield Section("FoS", [shared.factors_table(result, _factors(result))])
    if result.elastic is not None:  # others load nothing of it
        from slopekit.kinds.sheets.elastic import elastic_entries

        yield Section("ELASTIC", elastic_entries(result, result.elastic))
    yield Section("COLUMNS", shared.methods(result))
    yield Section("MOMENTS", moments(result))
    yield Section("STRENGTH", shared.curved_strength(result))
    yield Section("ALL PAIRS", shared.all_pairs(result))
    yield Section("SERIES", shared.series(result))
    yield Section("ACCEPT", shared.accept(result))
    yield Section("MODEL", (), details=[_model(result)])
    if many is None:
        yield Section("MECHANISM", shared.mechanisms(result))
        yield Section("MOVES", _large_movement(result), details=_movement(result))
    else:
        from slopekit.kinds.sheets import many_blocks

        yield from many_blocks.sections(result, many)
    times = "  ".join(
        f"{name.replace('_', ' ')} {seconds * 1e3:.1f} ms"
        for name, seconds in result.timing_s.items()
        if seconds > 5e-5
    )
    yield Section(TIME, [times])
    yield Section("SENSITIVITY", (), details=shared.governs(result))
    yield Section("NOT GIVEN", _not_given(result))
    yield Section(
        "NOTE", [str(notice) for notice in result.warnings if notice.code != EXAMPLE_INPUTS_CODE]
    )


def _status(result: Result) -> str:
    if result.findings is not None:
        from slopekit.kinds.sheets import many_blocks

        return many_blocks.status(result, result.findings)
    text, mechanism = result.status_text, result.limit_state.mechanism
    if mechanism is not None and result.status.startswith("slides") and result.words.along:
        slides, comma, rest = text.partition(",")
        text = f"{slides} toward {line_in_words(line_of(mechanism.displacement))}{comma}{rest}"
    return text


def _factors(result: Result) -> Iterator[Factor]:
    fos, many, limit = result.fos, result.findings is not None, "PRE-IE"
    secant, dilating = bool(result.limit_state.curved_strength) and not many, dilates(result.design)
    if many:
        from slopekit.kinds.sheets import many_blocks

        limit = many_blocks.limit_in_words(result)
    dilates_where = ", joints dilate as given" + ("" if many else " where all stay closed")
    limit += f"{dilates_where if dilating else ''}{result.words.assumes}"
    limit += ", strength of each node pair at its own normal traction" if secant else ""
    yield Factor(
        fos.limit, limit if fos.limit is not None or not many else f"{limit}: {result.status_text}"
    )
    if fos.lowest is not None and not many:
        yield Factor(fos.lowest, shared.LOWEST)
    no_comparison = result.status == "not_converged" and many  # nothing to agree with, or not to
    if fos.closed_form is not None or (result.agree is not None and not no_comparison):
        forces_note = ", forces only" if result.words.turns and not many else ""
        closed = f"{result.words.closed_form}{forces_note}{', zero dilation' if dilating else ''}"
        closed += ", secant at the mean normal traction of each plane" if secant else ""
        yield Factor(
            fos.closed_form, closed, shared.verdict(result, result.design.analysis.agree_within)
        )
    else:
        yield Factor(None, f"closed form: {result.words.no_closed_form}")
    if many and (fos.lowest is not None or fos.highest is not None):
        yield shared.locked_in(result)
    elif many and fos.limit is not None:
        yield Factor(None, "range for other load paths and locked-in stresses: not found")
    if fos.static_bound is not None:
        yield Factor(fos.static_bound, shared.UPPER_BOUND)
    elif fos.limit is not None:
        yield Factor(None, "upper bound: not found")
    if fos.all_pairs_failed is not None:
        criterion = (
            "no block is tied to bedrock by sticking pairs" if many else "the paper's criterion"
        )
        yield Factor(
            fos.all_pairs_failed, f"all pairs failed ({criterion}; depends on the stiffness)"
        )
    elif many and result.design.analysis.criterion == "all-pairs":
        yield Factor(None, "all pairs failed: asked for, and not found")


def moments(result: Result) -> list[str]:
    """Return what moments do to the factor of safety of one block, where they matter."""
    fos, forces = result.fos, result.comparisons.forces_only
    if not result.words.turns or not result.moments_govern:
        return []
    if result.status == "topples":
        unused = (
            ""
            if forces is None
            else f" (forces only would give {factor_text(forces)}: do not use it)"
        )
        return [f"they turn the {result.words.block} over{unused}"]
    if fos.limit is None:
        return []
    opened = [
        f"{(1.0 - opening['pressed_share']) * 100:.3g} % of {result.design.in_own_names(name)}"
        for name, opening in result.limit_state.openings.items()
        if opening["pressed_share"] < 1.0 - _OPEN_ROUNDING
    ]
    change = "lower the FoS"
    if opened:
        verbs = "open at failure and carry" if len(opened) > 1 else "opens at failure and carries"
        change = f"{' and '.join(opened)} {verbs} no cohesion: FoS"
    forces_note = (
        ""
        if forces is None
        else f" (forces only {factor_text(forces)}{_shares(fos.limit, result)})"
    )
    limit = factor_text(fos.limit)
    lines = [
        f"{change} {limit}{forces_note}" if opened else f"moments {change} to {limit}{forces_note}"
    ]
    closed, bound = factor_text(fos.closed_form), factor_text(fos.static_bound)
    if (
        fos.static_bound is not None
        and fos.closed_form is not None
        and float(bound) < float(closed)
    ):
        lines.append(
            f"no distribution of forces can balance at the closed form's {closed} (upper bound {bound})"
        )
    return lines


def _shares(limit: float, result: Result) -> str:
    """Return what of the forces' factor moments take, and what the cohesion of open parts, where both matter."""
    forces, on_pressed = result.comparisons.forces_only, result.comparisons.on_pressed
    if not forces or on_pressed is None:
        return ""
    lost, moments = 1.0 - on_pressed / forces, (on_pressed - limit) / forces
    if not min(lost, moments) > _LEAST_CHANGE:
        return ""
    return f"; moments alone take {moments * 100:.2g} %, cohesion lost {lost * 100:.2g} %"


def _model(result: Result) -> str:
    model, bed, balance = result.model, "", result.limit_state.balance
    if result.limit_state.openings and balance is not None:
        bed = f" (bound, displacements), the limit on {counted(balance.node_pairs, 'point')} of the elastic bed"
    refined = f", triangles split {times(model.refined)}" if model.refined else ""
    return (
        f"{counted(model.moving_blocks, 'moving block')}, {counted(model.unknowns, 'unknown')}, "
        f"{counted(model.node_pairs, 'node pair')}{refined}{bed}; left out: {', '.join(model.left_out)}"
    )


def _movement(result: Result) -> list[str]:
    """Displacement at full strength on elastic joints."""
    state = result.displacements.at_factor_one
    if state is None:
        is_stable = result.fos.limit is not None and result.fos.limit > 1.0
        return (
            ["no displacement at F = 1: no equilibrium was found on elastic joints"]
            if is_stable
            else []
        )
    failed, pairs = state.failed_pairs, result.model.node_pairs
    yielding = f"{failed} of {pairs} node pairs yield" if failed else "no yielding"
    return [
        f"displacement at F = 1 on elastic joints: {short(_size_m(result) * 1e3)} mm, {yielding} "
        f"({result.design.stiffness.in_words()})"
    ]


def _large_movement(result: Result) -> list[str]:
    """Return the caution of a displacement that is no small one."""
    if _size_m(result) <= 0.01 * float(result.geometry.volume_m3) ** (1.0 / 3.0):
        return []
    return [
        f"displacement at F = 1 {short(_size_m(result) * 1e3)} mm: too large for the theory of small displacements, "
        "not to be relied on"
    ]


def _size_m(result: Result) -> float:
    """Return the displacement of the centroid at full strength, m; 0 where it is not known."""
    state = result.displacements.at_factor_one
    return 0.0 if state is None else float(np.linalg.norm(state.movement.displacement))


def _not_given(result: Result) -> list[str]:
    """Return the inputs that took an example value, or one by a rule of the program."""
    example_inputs = ["φ" if name == "phi" else name for name in result.design.example_inputs]
    labels = {"seismic.trend": "seismic trend (LOADS says which is used)"}
    default_inputs = [
        labels.get(name, name)
        for name in result.design.reading.defaults
        if name not in result.design.example_inputs
    ]
    entries = [f"example values used: {', '.join(example_inputs)}"] if example_inputs else []
    return (
        ["; ".join([*entries, *([", ".join(default_inputs)] if default_inputs else [])])]
        if example_inputs or default_inputs
        else []
    )


def _partial_factors(partial: PartialFactors) -> Section:
    """Whose factors they are, what they have made, and how to read the factor of safety."""
    columns: list[Column[FactoredNumber]] = [
        Column("of", attrgetter("what"), "what", width=-47),
        Column(
            "characteristic", attrgetter("characteristic"), "characteristic", show=".5g", width=14
        ),
        Column(
            "factor",
            lambda row: f"{'/' if row.divided else 'x'} {row.factor:.4g}" if row.factor else "",
            "factor",
            width=9,
        ),
        Column("design", attrgetter("design"), "design", show=".5g", width=10),
        Column(" unit", attrgetter("unit"), "unit", width=-1, about=" {}"),
    ]
    title = partial.called + (f" ({partial.source})" if partial.source else "")
    end = "all numbers above are design values, and FoS is the over-design factor: 1 is enough"
    return Section("FACTORED", [f"{title}: {end}", Table(columns, partial.table)])
