"""The sheet of a result: one design on one screen, 100 columns, no colour needed. Never a bare factor of safety."""

from collections.abc import Iterable, Iterator
from operator import attrgetter

from slopekit._version import __version__
from slopekit.core.orientation import line_of
from slopekit.core.sheet import Column, Section, Sheet, Table
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
    yield Section("FORCES", shared.forces(result))
    yield Section("STATUS", [_status(result)])
    yield Section("FoS", [shared.factors_table(result, _factors(result))])
    yield from shared.elastic(result)
    yield Section("COLUMNS", shared.methods(result))
    yield Section("MOMENTS", _moments(result))
    yield Section("STRENGTH", shared.curved_strength(result))
    yield Section("ALL PAIRS", shared.all_pairs(result))
    yield Section("SERIES", shared.series(result))
    yield Section("ACCEPT", shared.accept(result))
    yield Section("MECHANISM", shared.mechanisms(result))
    yield Section("MODEL", _model(result))
    yield Section("MOVES", _moves(result))
    yield Section("TIME", [_time(result)])
    yield Section("GOVERNS", shared.governs(result))
    yield Section("DEFAULTS", _defaults(result))
    yield Section("NOTE", [str(notice) for notice in result.warnings if notice.code != INVENTED])


def _status(result: Result) -> str:
    text = result.status_text
    if result.mechanism is not None and result.status.startswith("slides") and result.words.along:
        text += f", along {line_in_words(line_of(result.mechanism.displacement))}"
    return text


def _factors(result: Result) -> Iterator[Factor]:
    fos, curved = result.fos, result.curved_strength
    compared = fos.closed_form is not None or result.agree is not None
    dilating = dilates(result.design)
    assumption = "limit, PRE-IE, joints dilate as given" if dilating else "limit, PRE-IE"
    assumption += result.words.assumes
    if curved:
        assumption += ", strength of each node pair at its own normal traction"
    yield Factor(fos.limit, assumption, shared.verdict(result) if compared else "")
    if fos.lowest is not None:
        yield Factor(fos.lowest, "lowest, for a joint stiffness ratio of 0.1 to 1 and where the joints creep open")
    if result.moments_govern and result.forces_only is not None:
        yield Factor(result.forces_only, "forces only, PRE-IE (no moments: the closed form's assumptions)")
    zero = ", zero dilation" if dilating else ""
    zero += "" if not curved else ", secant at the mean normal traction of each plane"
    closed = f"{result.words.closed_form}{zero}" if compared else f"closed form: {result.words.no_closed_form}"
    yield Factor(fos.closed_form, closed)
    if fos.static_bound is not None:
        yield Factor(fos.static_bound, "static bound (joints free to dilate; upper bound)")
    if fos.all_pairs_failed is not None:
        yield Factor(fos.all_pairs_failed, "all pairs failed (the paper's criterion; depends on the stiffness)")


def _moments(result: Result) -> list[str]:
    """What moments do to the factor of safety, where they matter."""
    fos, forces = result.fos, result.forces_only
    if not result.words.turns or not result.moments_govern:
        return []
    if result.status == "topples":
        unused = "" if forces is None else f" (forces alone would give {forces:.4g}: do not use it)"
        return [f"they turn the {result.words.block} over, {result.turns_over}{unused}"]
    if fos.limit is None:
        return []
    opened = [
        f"{(1.0 - opening.pressed_share) * 100:.3g} % of {name}"
        for name, opening in result.openings.items()
        if opening.pressed_share < 1.0 - _WHOLE
    ]
    change = "lower the FoS"
    if opened:
        verbs = "open at failure and carry" if len(opened) > 1 else "opens at failure and carries"
        change = f"{' and '.join(opened)} {verbs} no cohesion there: FoS"
    alone = "" if forces is None else f" (forces alone {forces:.4g})"
    lines = [f"{change} {fos.limit:.4g}{alone}" if opened else f"moments {change} to {fos.limit:.4g}{alone}"]
    if fos.static_bound is not None and fos.closed_form is not None and fos.static_bound < fos.closed_form:
        lines.append(
            f"no distribution of forces can balance at the closed form's {fos.closed_form:.4g} "
            f"(upper bound {fos.static_bound:.4g})"
        )
    return lines


def _model(result: Result) -> list[str]:
    model = result.model
    refined = f", triangles split {shared.times(model.refined)}" if model.refined else ""
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
