"""Entries that the sheets of one block and of many blocks share."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from decimal import ROUND_CEILING, Context
from functools import partial
from operator import attrgetter, itemgetter
from typing import TYPE_CHECKING

from slopekit.core.sheet import Column, Entry, Table, factor_text
from slopekit.design.parts import Rule
from slopekit.evidence import Factors, ReductionStep, WithoutBasal
from slopekit.kinds.words import alike, short
from slopekit.notices import EXAMPLE_INPUTS_CODE
from slopekit.result import METHODS, RULE_QUANTITIES, STATUSES, Result

if TYPE_CHECKING:
    from slopekit.findings import Mechanism

UPPER_BOUND = "upper bound (associated flow), not for design"
LOWEST = "lowest estimate, for a joint stiffness ratio of 0.1 to 1 and where joints creep open"
_FEW_TRIALS = 6  # of a search, at each end
_LEAST_PERCENT = 1e-4  # a smaller difference of two methods is not told apart from rounding


def forces(result: Result) -> list[Entry]:
    """Normal forces by interface, water, and what drives and resists along the movement."""
    acting, areas = result.forces, result.geometry.areas_m2
    # a resultant has no mean by the area of a curved surface
    pressures_kpa = result.design.water.pressures_kpa if "slip" in result.design.inputs() else ()

    def stress(name: str) -> float | None:
        normal, area = acting.normal.get(name), areas.get(name)
        return None if normal is None or not area else normal / area

    def pressure(name: str) -> float:
        water, area = acting.water.get(name), areas.get(name)
        return (
            pressures_kpa[0]
            if pressures_kpa and water is not None
            else water / area
            if water and area
            else 0.0
        )

    names = list(dict.fromkeys([*acting.normal, *acting.water]))

    def numbers(
        title: str, number: Callable[[str], float | None], key: str, unit: str, width: int
    ) -> Column[str]:
        return Column(title, number, key, unit, alike(map(number, names)), width)

    at_limit = [
        numbers("N'", acting.normal.get, "normal_kn", "kN", 14),
        numbers("mean σ'", stress, "stress_kpa", "kPa", 12),
    ]
    columns: list[Column[str]] = [
        Column("on (m², kN, kPa)", str, "interface", show=result.design.in_own_names, width=-18),
        numbers("area", areas.get, "area_m2", "m²", 12),
        *(at_limit if result.fos.limit is not None and any(map(acting.normal.get, names)) else ()),
        numbers("water", lambda name: acting.water.get(name) or 0.0, "water_kn", "kN", 14),
        numbers("mean u", pressure, "pressure_kpa", "kPa", 12),
    ]
    forces_note = " (forces alone)" if result.moments_govern else ""
    sums_of_loads = [
        ("weight", acting.weight),
        (f"driving, along the slide{forces_note}", acting.driving),
        ("resisting", acting.resisting),
    ]
    sums: list[Column[tuple[str, float | None]]] = [
        Column("load", itemgetter(0), width=-40),
        Column(
            "force",
            itemgetter(1),
            unit="kN",
            show=alike(map(itemgetter(1), sums_of_loads)),
            width=14,
        ),
    ]
    return [
        Table(columns, names),
        Table(sums, [row for row in sums_of_loads if row[1] is not None], headless=True),
    ]


def short_or_dash(value: float | None) -> str:
    """A size in three digits; a dash where it was not measured."""
    return "-" if value is None else short(value)


@dataclass(frozen=True)
class Factor:
    """A line of the block FoS: the factor, or a range of them, what it is, and what the check says of it."""

    value: float | None
    what: str
    check: str = ""
    to: float | None = None


def leading(result: Result) -> list[Factor]:
    """The number that acceptance hangs on where it lies below the limit: it stands first."""
    if result.leading is None:
        return []
    name, value = result.leading
    estimate = "lowest estimate" if name == "lowest" else RULE_QUANTITIES[name]
    return [Factor(value, f"{estimate}: the factor that ACCEPT is held against")]


def factors_table(result: Result, rows: Iterable[Factor]) -> Table[Factor]:
    """The factors of safety, each with what it is: that which acceptance hangs on, `rows`, those after slip."""
    columns: list[Column[Factor]] = [
        Column("factor", attrgetter("value"), "factor", show=factor_text, width=1),
        Column(
            "to",
            attrgetter("to"),
            "to",
            show=lambda to: "" if to is None else factor_text(to),
            width=1,
            about=" .. {}",
        ),
        Column("what it is", attrgetter("what"), "what", width=1, about="  {}"),
        Column("check", attrgetter("check"), "check", width=1, about="     {}"),
    ]
    return Table(columns, [*leading(result), *rows, *_residual(result)], headless=True)


def locked_in(result: Result) -> Factor:
    """Return the range of factors of the mechanism, or its lowest estimate where the range was not looked for."""
    if result.fos.highest is not None:
        return Factor(
            result.fos.lowest,
            "range for other load paths and locked-in stresses",
            to=result.fos.highest,
        )
    return Factor(
        result.fos.lowest,
        "lowest estimate, for other load paths, before blocks creep and of blocks alone; locked-in stresses not "
        "looked at",
    )


def _residual(result: Result) -> list[Factor]:
    """The factors on residual strength, after slip."""
    residual = result.comparisons.residual
    if residual is None:
        return []
    status = result.design.in_own_names(result.words.status(residual.status))
    differs = "" if residual.status == result.status else f": {status}"
    tolerance = result.design.analysis.agree_within
    verdict_text = verdict(residual, tolerance) if residual.agree is not None else ""
    rows = [Factor(residual.limit, f"residual strength, PRE-IE{differs}", verdict_text)]
    if residual.closed_form is not None:
        rows.append(Factor(residual.closed_form, f"residual strength, {result.words.closed_form}"))
    return rows


def methods(result: Result) -> list[Entry]:
    """The methods of columns, which know other mechanics: printed beside, not compared."""
    if not result.comparisons.methods:
        return []
    columns: list[Column[tuple[str, float | None]]] = [
        Column("method", lambda row: METHODS[row[0]], "method"),
        Column("factor", itemgetter(1), "factor", show=lambda factor: factor_text(factor).strip()),
    ]
    rows, remark = list(result.comparisons.methods.items()), "other mechanics: not compared"
    text = "  ".join(" ".join(column.shown(row) for column in columns) for row in rows)
    return [Table(columns, rows, rest=remark, said=f"{text}   ({remark})")]


def series(result: Result) -> list[Entry]:
    """Displacements and failed pairs by strength reduction factor (the paper's Table 3)."""
    if not result.series:
        return []
    horizontal = result.words.horizontal

    def displacement_mm(step: ReductionStep, k: int) -> float | None:
        return None if step.movement is None else float(step.movement.displacement[k]) * 1e3

    def horizontal_mm(step: ReductionStep) -> float | None:
        x, y = displacement_mm(step, 0), displacement_mm(step, 1)
        return (
            None if x is None or y is None else x if horizontal == "x" else (x * x + y * y) ** 0.5
        )

    def in_millimetres(value: float | None) -> str:
        return "no rest" if value is None else f"{value:.4f}"

    horizontals = () if horizontal == "x" else (("east", 0), ("north", 1))
    columns: list[Column[ReductionStep]] = [
        Column("factor", attrgetter("factor"), "factor", show=".4f", width=-9),
        Column(f"{horizontal} / mm", horizontal_mm, f"{horizontal}_mm", "mm", in_millimetres, 16),
        Column("up / mm", lambda step: displacement_mm(step, 2), "up_mm", "mm", in_millimetres, 12),
        Column(
            f"failed pairs of {result.model.node_pairs}",
            attrgetter("failed_pairs"),
            "failed_pairs",
            width=22,
        ),
        *(
            Column(f"{title} / mm", partial(displacement_mm, k=k), f"{title}_mm", "mm", ".4f")
            for title, k in horizontals
        ),
    ]
    return [Table(columns, result.series)]


def verdict(factors: Result | Factors, agree_within: float) -> str:
    """Whether the limit agrees with the closed form, and by how much it differs."""
    if factors.agree is None:
        return "not compared with the closed form"
    text = judged_difference(factors.difference, factors.agree, agree_within)
    return text.replace("AGREE", "AGREE on forces alone") if factors.moments_govern else text


def judged_difference(difference: float | None, agree: bool, agree_within: float) -> str:
    """The difference of two methods and the word for it."""
    word = "AGREE" if agree else "DISAGREE"
    if difference is None:
        return f"{word} (no number from either)" if agree else word
    percent = _rounded_up(max(difference * 100.0, _LEAST_PERCENT))
    return (
        f"{word} within {percent} %"
        if agree
        else f"{word} by {percent} % (limit {agree_within * 100:g} %)"
    )


def _rounded_up(value: float) -> str:
    """Return a number in two digits that is no less.

    >>> _rounded_up(0.0001), _rounded_up(0.0104), _rounded_up(1.004), _rounded_up(12.0)
    ('0.0001', '0.011', '1.1', '12')
    """
    return f"{float(Context(prec=2, rounding=ROUND_CEILING).create_decimal(repr(value))):g}"


def all_pairs(result: Result) -> list[Entry]:
    """The search of the paper's criterion: its bracket and the failed pairs of its trials."""
    pairs = result.displacements.all_pairs
    if pairs is None:
        return []
    low, high = pairs.bracket
    if result.fos.all_pairs_failed is None:
        return ["not found: the search met no factor with equilibrium on sticking pairs"]
    bracket_note = (
        "equilibrium lost there" if pairs.lost_equilibrium else "still in equilibrium there"
    )
    columns: list[Column[tuple[float, int]]] = [
        Column("factor", itemgetter(0), "factor", show=".5f", width=9),
        Column(
            f"failed pairs of {result.model.node_pairs}", itemgetter(1), "failed_pairs", width=26
        ),
    ]
    return [
        f"bracket {low:.5f} to {high:.5f} ({bracket_note}); {result.design.stiffness.in_words()}",
        Table(columns, sorted(pairs.history), ends=(_FEW_TRIALS, _FEW_TRIALS), rest="..."),
    ]


def accept(result: Result) -> list[str]:
    """The acceptance rules, each with its judgement."""
    return [
        f"{rule}{judged_on(result, rule)}: {_judgement(result, rule)}"
        for rule in result.design.rules
    ]


def judged_on(result: Result, rule: Rule) -> str:
    """The number that a rule judged, and why that: a bare `fos` is the criterion's, of blocks the first to fail."""
    value, name = result.value_of(rule), result.name_of(rule)
    number_name = {"limit": "limit", **RULE_QUANTITIES}[name]
    if value is None:
        return f" ({result.design.analysis.criterion})" if rule.name == "fos" else ""
    text = (
        f"{number_name} {judged_factor(value, [rule])}"
        if rule.name == "fos"
        else judged_factor(value, [rule])
    )
    if rule.name == "fos" and result.design.analysis.criterion == "all-pairs":
        compared = "the limit" if name == "all_pairs_failed" else "the factor of all pairs"
        text += f", no higher than {compared}"
    if name == "limit" and result.findings is not None and result.size is not None:
        text += f" of the critical block or group, {short(result.size.volume_m3)} m³"
    return f" ({text})"


def judged_factor(value: float, rules: Iterable[Rule]) -> str:
    """Return a factor in three decimals, or as many as show on which side of every rule it lies.

    >>> judged_factor(1.55739, []), judged_factor(1.49996, [Rule("fos", ">=", 1.5)])
    ('1.557', '1.49996')
    """
    rules = list(rules)
    texts = (factor_text(value).strip(), *(f"{value:.{digits}f}" for digits in range(3, 16)))
    verdicts = [rule.is_met_by(value) for rule in rules]
    return next(
        (text for text in texts if [rule.is_met_by(float(text)) for rule in rules] == verdicts),
        repr(value),
    )


def _judgement(result: Result, rule: Rule) -> str:
    if result.meets(rule):
        lowest = result.fos.lowest
        if result.value_of(rule) is None:  # nothing drives it
            return "MET (it stands without any strength: there is no factor to judge)"
        if lowest is None or not (rule.is_on_factor and rule.is_least):
            return "MET"
        if rule.is_met_by(lowest):
            return f"MET (lowest estimate {judged_factor(lowest, [rule])})"
        return f"MET, but not by the lowest estimate {judged_factor(lowest, [rule])}"
    whole_wedge = result.comparisons.without_basal
    if whole_wedge is not None and not whole_wedge.meets(rule):
        return f"NOT MET ({whole_wedge.WHAT}: {whole_wedge.in_words()})"
    if result.agree is False or result.status == "not_converged":
        return "NOT MET (the methods disagree or did not converge: no number to judge)"
    if result.fos.limit is None and result.status != "no_driving_force":
        return "NOT MET (no factor of safety)"
    return "NOT MET (there is no such number here)" if result.value_of(rule) is None else "NOT MET"


def mechanisms(result: Result) -> list[Entry]:
    """Return the mechanisms of a block above a basal joint: that block, and the whole wedge by its closed form."""
    if result.comparisons.without_basal is None:
        return []

    def status(word: str) -> str:
        return result.design.in_own_names(result.words.status(word))

    columns: list[Column[Mechanism]] = [
        Column("FoS", attrgetter("fos"), "fos", show=factor_text, width=9),
        Column(
            "m³", lambda row: row.size and row.size.volume_m3, "volume_m3", "m³", short_or_dash, 11
        ),
        Column("t", lambda row: row.size and row.size.mass_t, "mass_t", "t", short_or_dash, 11),
        Column("block", lambda row: row.blocks[0], "block", width=-14, about="  {}"),
        Column("status", attrgetter("status"), "status", width=1, show=status, about="{}"),
    ]
    return [Table(columns, result.mechanisms)]


def curved_strength(result: Result) -> list[str]:
    """Return the entries on curved strength: the line of each joint at its mean normal traction, and its error."""
    entries = []
    for name, line in result.limit_state.curved_strength.items():
        low, high = line["range_kpa"]
        place = f"{name} at {line['traction_kpa']:.4g} kPa (node pairs {low:.4g} .. {high:.4g})"
        secant = f"c {line['cohesion_kpa']:.4g} kPa  φ {line['friction_angle_deg']:.2f}°, the secant of its law"
        entries.append(f"{result.design.in_own_names(place)}: {secant}")
    return entries


def why_no_sensitivity(result: Result) -> str:
    """Return why SENSITIVITY is not given though the closed form has it; empty where it is given."""
    if result.comparisons.governs and (result.moments_govern or result.status == "not_converged"):
        return "not given: it is read from the closed form, which does not govern here"
    return ""


def governs(result: Result) -> list[Entry]:
    """Return the entries on what changes the factor of safety most, by the closed form."""
    if not result.comparisons.governs:
        return []
    if reason := why_no_sensitivity(result):
        return [reason]
    base = result.fos.closed_form

    def change(row: tuple[str, float | None, str]) -> float | None:
        return None if row[1] is None or base is None else row[1] - base

    def status_after(row: tuple[str, float | None, str]) -> str:
        return (
            result.design.in_own_names(result.words.status(row[2]))
            if row[2] in STATUSES
            else row[2]
        )

    columns: list[Column[tuple[str, float | None, str]]] = [
        Column(
            "changed input", itemgetter(0), "change", show=result.design.in_own_names, width=-24
        ),
        Column(
            "closed form",
            itemgetter(1),
            "fos",
            show=lambda factor: factor_text(factor).strip(),
            width=12,
        ),
        Column(
            "change",
            change,
            "difference",
            show=lambda difference: "-" if difference is None else f"{difference:+.4f}",
            width=10,
        ),
        Column("then", status_after, "then", width=1, about="  {}"),
    ]
    return [Table(columns, result.comparisons.governs, rest="One at a time, by the closed form.")]


# -- on one line -----------------------------------------------------------------------------------------------------


def line_of(result: Result) -> str:
    """A result on one line, `--quiet`: status, factors, what governs, the check, codes of notices; never a bare factor.

    The factor that acceptance hangs on comes first; those of several stand by their names.
    """
    limit, whole_wedge = result.fos.limit, result.comparisons.without_basal
    factors = [("", limit)]
    if result.design.analysis.criterion == "all-pairs":
        factors = [("limit", limit), ("all-pairs", result.fos.all_pairs_failed)]
    if result.leading is not None:
        name, value = result.leading
        title = {"all_pairs_failed": "all-pairs", WithoutBasal.NAME: WithoutBasal.NAME}.get(
            name
        ) or RULE_QUANTITIES[name]
        factors = [
            (title, value),
            ("limit", limit),
            *(entry for entry in factors[1:] if entry[0] != title),
        ]
    elastic = result.comparisons.elastic
    if elastic is not None and elastic.limit is not None:
        factors.append(("elastic", elastic.limit))
    rules = [rule for rule in result.design.rules if rule.is_on_factor]
    factor_texts = [
        f"{name} {'none' if value is None else judged_factor(value, rules)}".strip()
        for name, value in factors
    ]
    texts = [
        result.status,
        ", ".join(factor_texts),
        {True: "agree", False: "disagree", None: "not compared"}[result.agree],
    ]
    texts += ["moments_govern"] if result.moments_govern else []
    if (
        whole_wedge is not None
        and whole_wedge.factor is not None
        and whole_wedge.NAME not in dict(factors)
    ):
        texts += (
            [f"{whole_wedge.NAME} {factor_text(whole_wedge.factor)}"]
            if limit is None or whole_wedge.factor < limit
            else []
        )
    texts += [] if result.accepted is None else ["met" if result.accepted else "not met"]
    codes = {entry.code: entry.code for entry in result.warnings}
    if EXAMPLE_INPUTS_CODE in codes:
        codes[EXAMPLE_INPUTS_CODE] += f" ({', '.join(result.design.example_inputs)})"
    return "  ".join([*texts, *codes.values()])
