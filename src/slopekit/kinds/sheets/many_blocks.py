"""The sheet of many blocks: what moves, how, in what order; short even for ten thousand blocks."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from operator import attrgetter, itemgetter
from typing import Any

import numpy as np

from slopekit.core.orientation import line_of
from slopekit.core.sheet import Column, Entry, Section, Table, counted, factor_text
from slopekit.findings import (
    MOTIONS,
    SAME_FACTOR,
    AssemblyGeometry,
    Findings,
    GoverningInterface,
    Mechanism,
)
from slopekit.kinds.sheets.shared import short_or_dash
from slopekit.kinds.words import (
    in_order,
    line_in_words,
    mass_in_words,
    names_in_runs,
    short,
    size_number,
)
from slopekit.result import Result

_PLURALS = {
    "slides": "slide",
    "topples": "topple",
    "rotates": "turn",
    "falls": "fall",
    "lifts": "are lifted",
}
_MODE_VERBS = {
    "slides": "slide",
    "slides_up": "slide up",
    "topples": "topple",
    "rotates": "turn",
    "falls": "fall",
    "lifted": "lift",
    "no_driving_force": "stand",
    "not_converged": "unknown",
}
_MODES = {"slip": "slips", "open": "slips and opens", "stick": "sticks", "pull": "pulls"}
_MOST_INTERFACES = 6
_LEAST_SHARE = 1e-3  # of the work: less is not worth a line
_SHARE_ROUNDING = 1e-6  # shares that add up to one but for this
_FIRST_MECHANISMS, _LAST_MECHANISMS = 8, 2
#: What is checked, in words about its figure.
_CHECKS: Mapping[str, str] = {
    "volume_error": "the blocks' volumes add up to the rock's but for {error} of it",
    "area_error": "the two sides of the joints differ by {error} of their area",
    "plane_error_m": "corners at most {error} m off their planes",
    "largest_unbalanced_force": "largest unbalanced force {error} of the load",
    "joint_area_m2": "joint area {size} m²",
    "contact_length_m": "contact length {size} m",
    "contact_area_m2": "contact area {size} m²",
    "contact_tolerance_m": "contact tolerance {size} m",
    "corner_rounding_m": "corner rounding {size} m",
}
_MOST_ROWS, _FIRST_ROWS, _LAST_ROWS = 40, 20, 10


def sections(result: Result, findings: Findings) -> Iterator[Section]:
    """Iterate over the sections of many blocks: mechanisms in order, table of columns, checks."""
    first = findings.first
    yield Section("MOVES", (), details=_moves(result, first))
    remaining = [findings.standing] if findings.standing else []
    yield Section("CHIPS", _chips(findings))
    yield Section(
        "MECHANISM", _mechanisms(result, findings, _order(result)), hang=42, details=remaining
    )
    yield Section("TABLE", (), details=toppling_rows(result, findings.table))
    yield Section("CHECKS", (), details=_checks(result, findings, first))


def _order(result: Result) -> dict[str, int]:
    geometry = result.geometry
    names = geometry.names if isinstance(geometry, AssemblyGeometry) else ()
    return {name: k for k, name in enumerate(names)}


# -- the answer -----------------------------------------------------------------------------------------------------


def status(result: Result, findings: Findings) -> str:
    """The status, and which blocks move in which way."""
    first = findings.first
    if first is None or not first.blocks:
        return result.status_text
    words = _motions(first, _order(result))
    stable_count = (
        findings.blocks
        - findings.fixed
        - len(first.blocks)
        - sum(len(chip.blocks) for chip in findings.chips)
    )
    if stable_count > 0:
        words += f", {stable_count} {'stays' if stable_count == 1 else 'stay'}"
    return _joined(result.status_text, words)


def _joined(status: str, words: str) -> str:
    return f"{status}{';' if ':' in status else ':'} {words}" if words else status


def _motions(mechanism: Mechanism, order: Mapping[str, int]) -> str:
    """Return how many blocks move in which way, and which; the most frequent way first."""
    names_by_motion: dict[str, list[str]] = {}
    for name, motion in zip(mechanism.blocks, mechanism.how, strict=True):
        names_by_motion.setdefault(motion, []).append(name)
    words = []
    for motion, names in sorted(names_by_motion.items(), key=lambda entry: -len(entry[1])):
        verb = MOTIONS.get(motion, motion) if len(names) == 1 else _PLURALS.get(motion, motion)
        words.append(f"{len(names)} {verb} ({names_in_runs(in_order(names, order))})")
    return ", ".join(words)


def limit_in_words(result: Result) -> str:
    """Return the words that say what the factor is: the limit of the elastic path, or its last state at rest."""
    findings = result.findings
    if findings is None:
        return "PRE-IE"
    ratio = findings.shear_to_normal
    first = findings.first
    return (
        path_in_words("none", ratio)
        if first is None
        else path_in_words(first.basis, ratio, first.fos, first.change)
    )


def _moves(result: Result, first: Mechanism | None) -> list[Entry]:
    """The first mechanism: the fastest block, the interfaces that govern, the node pairs."""
    if first is None or not first.blocks:
        return [*_settles(result)]
    fastest, motion, toward, geometry = (
        first.blocks[0],
        first.how[0],
        _toward(first),
        result.geometry,
    )
    in_section = isinstance(geometry, AssemblyGeometry) and geometry.thickness_m is not None
    goes = toward and f" toward {toward}{' (x is 090)' if in_section else ''}"
    return [
        f"fastest {fastest}, which {MOTIONS.get(motion, motion)}{goes}",
        *governing(first.interfaces),
        *_pairs(first.pairs_by_mode),
        *_settles(result),
    ]


def _toward(mechanism: Mechanism) -> str:
    """The way that the fastest block of a mechanism goes; "" where it turns alone."""
    displacement = mechanism.displacement[0] if mechanism.blocks else np.zeros(3)
    return line_in_words(line_of(displacement)) if float(np.abs(displacement).max()) > 0.0 else ""


def _settles(result: Result) -> list[str]:
    """The block that moves most at full strength."""
    settled = result.displacements.at_factor_one
    if settled is None or settled.block is None:
        return []
    size = float(np.sqrt(settled.movement.displacement @ settled.movement.displacement))
    bed = result.design.stiffness.in_words()
    return [
        f"at full strength {settled.block} settles most, by {1e3 * size:.3g} mm (elastic bed: {bed})"
    ]


def governing(interfaces: Sequence[GoverningInterface]) -> list[Entry]:
    """The interfaces that govern with their shares; those left out by the rest of the work."""
    if not interfaces:
        return []
    printed = [
        interface for interface in interfaces[:_MOST_INTERFACES] if interface.share >= _LEAST_SHARE
    ] or interfaces[:1]
    bolts = any(interface.mode == "pull" for interface in interfaces)
    lost, carriers = (
        ("friction, cohesion and bolts", "interface and bolt")
        if bolts
        else ("friction and cohesion", "interface")
    )
    name_width, joint_width, mode_width = (
        2 + max(map(len, words))
        for words in zip(
            *(
                (interface.name, interface.joint, _MODES.get(interface.mode, interface.mode))
                for interface in printed
            ),
            strict=True,
        )
    )
    columns: list[Column[GoverningInterface]] = [
        Column(
            "share",
            attrgetter("share"),
            "share",
            show=lambda share: f"{share * 100:.1f} %",
            width=7,
        ),
        Column(carriers, attrgetter("name"), "name", width=-name_width, about="  {}"),
        Column("joint", attrgetter("joint"), "joint", width=-joint_width, about="  {}"),
        Column(
            "mode",
            attrgetter("mode"),
            "mode",
            "",
            lambda mode: _MODES.get(mode, mode),
            -mode_width,
            about="  {}",
        ),
        Column(
            "of", lambda interface: "T" if interface.mode == "pull" else "N'", width=1, about="  {}"
        ),
        Column("force", attrgetter("normal_kn"), "normal_kn", "kN", size_number, 1, about=" {} kN"),
        Column("mean stress", _mean_stress, "stress_kpa", "kPa", ".4g", 1, about=" ({} kPa)"),
    ]
    rest = ""
    remaining = 1.0 - sum(interface.share for interface in printed)
    if remaining > _SHARE_ROUNDING:
        are_all = sum(interface.share for interface in interfaces) > 1.0 - _SHARE_ROUNDING
        remainder = f"and {len(interfaces) - len(printed)} more" if are_all else "the others"
        share = f"{remaining * 100:5.1f}" if remaining >= _LEAST_SHARE else f"{'< 0.1':>5}"
        rest = f"{share} %  ... {remainder} together"
    return [
        f"share of the energy dissipated in {lost}, by {carriers}:",
        Table(columns, interfaces, printed, rest, headless=True),
    ]


def _mean_stress(interface: GoverningInterface) -> float | None:
    return interface.normal_kn / interface.area_m2 if interface.area_m2 else None


def _pairs(by_mode: Mapping[str, int]) -> list[str]:
    """Return how many node pairs stick, slip and are open, of all."""
    if not by_mode:
        return []
    verbs = {"stick": "stick", "slip": "slip", "open": "are open"}
    open_ = " (they carry nothing, or part)" if by_mode.get("open") else ""
    counts = [f"{count} {verbs.get(mode, mode)}" for mode, count in by_mode.items()]
    return [f"of {sum(by_mode.values())} node pairs " + ", ".join(counts) + open_]


# -- what comes after -----------------------------------------------------------------------------------------------


def _chips(findings: Findings) -> list[Entry]:
    """Return the entries on chips, too light to count: before the first mechanism, and after it."""
    chips, first = [row for row in findings.mechanisms if row.role == "chip"], len(findings.chips)
    stages = ((chips[:first], "first"), (chips[first:], "after the first mechanism"))
    return [_too_light(rows, stage) for rows, stage in stages if rows]


def _too_light(chips: Sequence[Mechanism], stage: str) -> str:
    number, mass = (
        sum(len(chip.blocks) for chip in chips),
        sum(chip.size.mass_t for chip in chips if chip.size),
    )
    factors = [chip.fos for chip in chips if chip.fos is not None]
    factor_note = (
        f"from FoS {factor_text(min(factors)).strip()}"
        if len(factors) == len(chips)
        else "whatever their strength"
    )
    return (
        f"{counted(number, 'block')} ({mass_in_words(mass)} in all) too light to count, failing {factor_note}: "
        f"taken away {stage} (analysis.smallest_block)"
    )


def _mechanisms(result: Result, findings: Findings, order: Mapping[str, int]) -> list[Entry]:
    """The mechanisms in the order in which they happen, and what is left."""
    mechanisms = findings.counted
    if len(mechanisms) < 2:
        return []
    highest: float | None = None
    rows = []
    for k, mechanism in enumerate(mechanisms, 1):
        at_once = k > 1 and _follows_at_once(mechanism, highest)
        text = _motions(mechanism, order)
        if mechanism.fos is None or not text:
            text = _joined(result.words.status(mechanism.status), text)
        rows.append((k, mechanism, ("at once: " if at_once else "") + text))
        highest = mechanism.fos if highest is None else max(highest, mechanism.fos or highest)
    columns: list[Column[tuple[int, Mechanism, str]]] = [
        Column("n", itemgetter(0), "n", width=3),
        Column("FoS", lambda row: row[1].fos, "fos", show=factor_text, width=9),
        Column(
            "m³",
            lambda row: row[1].size and row[1].size.volume_m3,
            "volume_m3",
            "m³",
            short_or_dash,
            9,
        ),
        Column(
            "t", lambda row: row[1].size and row[1].size.mass_t, "mass_t", "t", short_or_dash, 9
        ),
        Column(
            "mode",
            lambda row: row[1].status,
            "mode",
            show=lambda way: _MODE_VERBS.get(way, way),
            width=-11,
            about="  {}",
        ),
        Column("what fails once all before it is gone", itemgetter(2), "what", width=1),
        Column("the fastest toward", lambda row: _toward(row[1]), "toward"),
    ]
    table = Table(columns, rows, ends=(_FIRST_MECHANISMS, _LAST_MECHANISMS))
    hidden = [mechanism for _, mechanism, _ in table.left_out]
    factors = [mechanism.fos for mechanism in hidden if mechanism.fos is not None]
    factor_range = (
        f", FoS {factor_text(min(factors))} to {factor_text(max(factors))}" if factors else ""
    )
    blocks = counted(sum(len(mechanism.blocks) for mechanism in hidden), "block")
    return [replace(table, rest=f"... {len(hidden)} more: {blocks}{factor_range} ...")]


def _follows_at_once(mechanism: Mechanism, highest: float | None) -> bool:
    """Whether a mechanism needs no further loss of strength than those before it."""
    if mechanism.fos is None:
        return mechanism.status in ("falls", "lifted")
    return highest is not None and mechanism.fos <= highest * (1.0 + SAME_FACTOR)


# -- the evidence ---------------------------------------------------------------------------------------------------


def _checks(result: Result, findings: Findings, first: Mechanism | None) -> list[str]:
    entries = []
    if first is not None and first.fos is not None:
        steps = counted(result.model.passes, "factorisation", "factorisations")
        settled = (
            "settled"
            if first.change == 0.0
            else f"lies {first.change * 100:.2g} % from a strength at which they run"
        )
        entries.append(f"the limit {settled} after {steps}")
    balanced = (
        result.fos.limit is not None or result.status == "no_driving_force"
    )  # else there were none to balance
    entries += [
        _CHECKS.get(name, f"{name.replace('_', ' ')} {{size}}").format(
            error=f"{value:.2g}", size=short(value)
        )
        for name, value in findings.checks.items()
        if balanced or name != "largest_unbalanced_force"
    ]
    return ["; ".join(entries)] if entries else []


def _percent(fraction: float) -> str:
    """A part in percent: two digits, or whole."""
    return f"{fraction * 100:.2g}" if fraction < 0.995 else f"{fraction * 100:.0f}"


def path_in_words(
    basis: str, ratio: float | None, fos: float | None = None, change: float = 0.0
) -> str:
    """Return the words that say how a factor of many blocks was found.

    Parameters
    ----------
    basis, change : as of `findings.Mechanism`; ratio : k_t / k_n of the elastic joints, None where it is not known

    >>> path_in_words("limit", 0.4)
    'limit of the elastic path (k_t/k_n 0.4)'
    >>> path_in_words("peak", 0.4, 1.6, 0.005)
    'last stable state of the elastic path (k_t/k_n 0.4); fails at 1.608, 0.5 % higher'
    """
    if basis == "alone":
        return "limit: one block slides alone, by forces (no credit for turning)"
    path = "the elastic path" if ratio is None else f"the elastic path (k_t/k_n {ratio:g})"
    if basis != "peak":
        return f"limit of {path}" + (", settled" if basis == "settled" else "")
    runs = ""
    if fos is not None and change > 0.0:
        runs = (
            f"; fails at {factor_text(fos * (1.0 + change)).strip()}, {_percent(change)} % higher"
        )
    return f"last stable state of {path}{runs}"


def toppling_rows(result: Result, table: Sequence[Mapping[str, Any]]) -> list[Entry]:
    """Goodman & Bray's rows from the highest column down to the toe, with PRE-IE's mode beside theirs."""
    if not table:
        return []
    factor = result.fos.limit or result.fos.closed_form
    strength_note = f"strength divided by {factor_text(factor)}" if factor else "strength as given"
    by_number = sorted(table, key=itemgetter("n"))

    def column(title: str, unit: str, width: int = 0) -> Column[Mapping[str, Any]]:
        key = f"{title}_{unit.lower()}"
        return Column(title, itemgetter(key), key, unit, _cell, width)

    columns: list[Column[Mapping[str, Any]]] = [
        Column("n", itemgetter("n"), "n", width=4),
        *(column(title, "m", 8) for title in ("y", "M", "L")),
        *(column(title, "kN", 12) for title in ("P_topple", "P_slide", "P")),
        Column("mode", itemgetter("mode"), "mode", width=-9, about="  {}"),
        Column("PRE-IE", itemgetter("mode_preie"), "mode_preie", width=1, about=" | {}"),
        Column(
            "",
            lambda row: row["mode"] != row["mode_preie"],
            show=lambda differs: "<" if differs else "",
            width=1,
            about="  {}",
        ),
        *(column(title, "kN") for title in ("R", "S")),
    ]
    full_table = Table(
        columns,
        by_number[::-1],
        ends=(_FIRST_ROWS, _LAST_ROWS) if len(table) > _MOST_ROWS else None,
    )
    alike = sum(row["mode"] == row["mode_preie"] for row in table)
    different = [f"C{row['n']}" for row in by_number if row["mode"] != row["mode_preie"]]
    differing_columns = f"; not in {names_in_runs(different)}" if different else ""
    return [
        f"Goodman & Bray's columns, {strength_note}; y, M, L in m, P in kN (R and S on the bases: --json)",
        replace(
            full_table,
            rest=f" ... {len(full_table.left_out)} columns left out here (--json has them) ..."
            if full_table.left_out
            else "",
        ),
        f"the modes are the same in {alike} of {len(table)} columns{differing_columns}",
    ]


def _cell(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}" if abs(value) < 1e8 else f"{value:.5g}"
