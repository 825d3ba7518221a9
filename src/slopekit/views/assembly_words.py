"""Designs of many blocks in words: joint sets, columns, the user's blocks; many names in few words."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

from slopekit.design.blocky import AssemblyDesign, BenchDesign, BlocksDesign, JointSetInput, ToppleDesign
from slopekit.design.common import Design, Strength
from slopekit.orientation import Plane, number
from slopekit.views.entries import factor_text
from slopekit.views.words import size_number

MOST_RUNS = 4
_MOST_HEIGHTS = 20
_MOST_INTERFACES = 3
_NUMBERS = re.compile(r"([0-9]+)")

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Part:
    """A label of the sheet, its entries, and how far folded lines hang in."""

    label: str
    entries: list[str]
    hang: int = 3


# -- many names ---------------------------------------------------------------------------------------------------


def names_in_runs(names: Iterable[str], most: int = MOST_RUNS) -> str:
    """Names in the order given, three or more that count up as a run; after `most` runs only how many are left.

    >>> names_in_runs(["C1", "C2", "C3", "C5", "C7", "C8"])
    'C1 to C3, C5, C7, C8'
    >>> names_in_runs([f"B{2 * k}" for k in range(50)])
    'B0, B2, B4, B6, ... and 46 more'
    """
    runs = _runs(list(names))
    shown, rest = runs[:most], sum(len(run) for run in runs[most:])
    words = [", ".join(run) if len(run) < 3 else f"{run[0]} to {run[-1]}" for run in shown]
    return ", ".join([*words, f"... and {rest} more"] if rest else words)


def _runs(names: list[str]) -> list[list[str]]:
    runs: list[list[str]] = []
    last: list[str] = []
    for name in names:
        parts = _NUMBERS.split(name)
        if runs and _follows(last, parts):
            runs[-1].append(name)
        else:
            runs.append([name])
        last = parts
    return runs


def _follows(before: Sequence[str], after: Sequence[str]) -> bool:
    """Whether two names differ in one number alone, which is one more: texts and numbers take turns."""
    if len(before) != len(after):
        return False
    changed = [k for k, (old, new) in enumerate(zip(before, after, strict=True)) if old != new]
    return len(changed) == 1 and changed[0] % 2 == 1 and int(after[changed[0]]) == int(before[changed[0]]) + 1


def in_order(names: Iterable[str], order: Mapping[str, int]) -> list[str]:
    """Names in the order of the blocks; those that are none of them last."""
    return sorted(names, key=lambda name: order.get(name, len(order)))


def first_and_last(items: Sequence[T], first: int, last: int) -> tuple[Sequence[T], int, Sequence[T]]:
    """The first and last of many items and how many lie between them; all of them where one line saves nothing.

    >>> first_and_last(range(6), 2, 1)
    (range(0, 2), 3, range(5, 6))
    """
    between = len(items) - first - last
    if between <= 1:
        return items, 0, ()
    return items[:first], between, items[len(items) - last :]


def counted(count: int, one: str, many: str = "") -> str:
    """A count with its word.

    >>> counted(1, "block"), counted(3, "block"), counted(2, "mass", "masses")
    ('1 block', '3 blocks', '2 masses')
    """
    return f"{count} {one if count == 1 else many or one + 's'}"


# -- designs --------------------------------------------------------------------------------------------------------


def design_in_words(design: Design, areas: Mapping[str, float]) -> Part:
    """Everything the blocks are made from, with the label of that."""
    if isinstance(design, BenchDesign):
        return Part("SETS", _bench(design, areas))
    if isinstance(design, ToppleDesign):
        return Part("COLUMNS", _columns(design))
    if isinstance(design, BlocksDesign):
        return Part("BLOCKS", _blocks(design))
    return Part("BLOCKS", [])


def in_section(design: Design) -> bool:
    """Whether the blocks lie in a vertical section: x is 090, and nothing acts along y."""
    return isinstance(design, ToppleDesign) or (isinstance(design, BlocksDesign) and design.in_section)


def water_in_words(design: Design) -> list[str]:
    """Mean water pressures by what they act on."""
    if isinstance(design, BenchDesign):
        pressures = [(one.name, one.pressure_kpa) for one in design.sets]
    elif isinstance(design, ToppleDesign):
        pressures = list(zip(("bases", "sides"), design.pressures_kpa, strict=True))
    elif isinstance(design, BlocksDesign):
        pressures = [(f"{one}/{other}", pressure) for one, other, pressure in design.pressures_kpa]
    else:
        return []
    wet = [f"u = {pressure:g} kPa on {name}" for name, pressure in pressures if pressure]
    shown, rest, _ = first_and_last(wet, 6, 0)
    more = [f"... and {rest} more"] if rest else []
    return ["water " + ", ".join([*shown, *more])] if wet else []


def strength_in_words(strength: Strength) -> str:
    """Cohesion and friction with the digits they were given in."""
    words = f"c {strength.cohesion_kpa:.6g} kPa  φ {strength.friction_angle_deg:.6g}°"
    if strength.law is not None:
        words = strength.law.in_words()
    if strength.dilation_deg:
        words += f"  ψ {strength.dilation_deg:.6g}°"
    if strength.tension_kpa:
        words += f"  σt {strength.tension_kpa:.4g} kPa"
    return words


def _named(design: AssemblyDesign, name: str) -> str:
    """A strength with its name, where there are several to tell apart."""
    words = strength_in_words(design.strength(name))
    return words if len(design.strengths) == 1 else f"{name}: {words}"


def _bench(design: BenchDesign, areas: Mapping[str, float]) -> list[str]:
    entries = []
    for one in design.sets:
        area = f"  area {size_number(areas[one.name])} m²" if one.name in areas else ""
        entries.append(
            f"{one.name} {one.plane}  {one.plane.in_words()}, every {one.spacing_m:.6g} m{_regularity(design, one)}  "
            f"{_named(design, one.strength)}{area}"
        )
    entries.append(_surface("face", design.face))
    entries.append(_surface("upper", design.upper))
    toe = "" if not any(design.origin_m) else " (mid-toe at {:.10g}, {:.10g}, {:.10g})".format(*design.origin_m)
    entries.append(
        f"bench {design.length_m:.6g} m along the strike{toe}, rock modelled to {design.depth_m:.6g} m behind the crest"
    )
    return entries


def _regularity(design: BenchDesign, one: JointSetInput) -> str:
    """Where the set lies, and how it scatters."""
    words = ""
    if one.offset_m:
        side = "above" if one.offset_m > 0.0 else "below"
        words += f" (one plane {abs(one.offset_m):.6g} m {side} mid-toe)"
    turned = f"normals scatter by {one.scatter_deg:.4g}°" if one.scatter_deg else ""
    uneven = f"distances scatter by {one.spacing_scatter * 100:.4g} %" if one.spacing_scatter else ""
    if turned or uneven:
        words += f", {' and '.join(filter(None, (turned, uneven)))} (seed {design.seed})"
    return words


def _surface(name: str, plane: Plane) -> str:
    return f"{name} {plane}  " + (plane.in_words() if plane.dip_deg else "level")


def _columns(design: ToppleDesign) -> list[str]:
    heights = design.heights_m
    count = len(heights)
    rows = "" if design.rows == 1 else f" in each of {design.rows} rows side by side"
    step = f", each {design.base_step_m:.6g} m above the one below" if design.base_step_m else ", in one plane"
    entries = [
        f"{counted(count, 'column')}{rows}, C1 at the toe, {design.width_m:.6g} m wide, dip {number(design.dip_deg)}° "
        f"into the slope, {design.thickness_m:.6g} m thick along the strike",
        f"bases dip {number(90.0 - design.dip_deg)}° out of the slope" + (step if count > 1 else ""),
    ]
    low, high = min(heights), max(heights)
    if low == high:
        entries.append(f"heights {'all ' if count > 1 else ''}{high:.6g} m")
    else:
        shown, between, last = first_and_last([f"{height:.6g}" for height in heights], _MOST_HEIGHTS - 4, 4)
        listed = ", ".join([*shown, *([f"... {between} more ..."] if between else []), *last])
        tallest = f"C{heights.index(high) + 1}"
        entries.append(f"heights {low:.6g} to {high:.6g} m ({tallest} the tallest), from the toe upward: {listed}")
    if design.base == design.sides:
        return [*entries, f"bases and sides  {_named(design, design.base)}"]
    return [*entries, f"bases  {_named(design, design.base)}", f"sides  {_named(design, design.sides)}"]


def _blocks(design: BlocksDesign) -> list[str]:
    moving = [block.name for block in design.blocks if not block.fixed]
    fixed = [block.name for block in design.blocks if block.fixed]
    shape = f"polygons of a section {design.thickness_m:.6g} m thick" if design.in_section else "closed meshes"
    within = design.contact_tolerance_m
    touch = "" if within is None else f"; faces nearer than {within * 1e3:.6g} mm touch"
    entries = [
        f"{shape}{touch}",
        f"can move: {names_in_runs(moving)}; bedrock: {names_in_runs(fixed) or 'none'}",
    ]
    for name, strength in design.strengths:
        pairs = [f"{one}/{other}" for one, other, own in design.interfaces if own == name]
        shown, rest, _ = first_and_last(pairs, _MOST_INTERFACES, 0)
        listed = ", ".join([*shown, *([f"... and {rest} more"] if rest else [])])
        on = [f"on {counted(len(pairs), 'named interface')} ({listed})"] if pairs else []
        if name == design.default_strength:
            on.insert(0, "on every other interface" if design.interfaces else "on every interface")
        entries.append(f"{name}  {strength_in_words(strength)}  {' and '.join(on) or 'on no interface'}")
    return entries + _own_weights(design)


def _own_weights(design: BlocksDesign) -> list[str]:
    """Which blocks have a unit weight of their own, lightest first."""
    by_weight: dict[float, list[str]] = {}
    for block in design.blocks:
        own = block.unit_weight_kn_m3
        if own is not None and not block.fixed and own != design.unit_weight_kn_m3:
            by_weight.setdefault(own, []).append(block.name)
    if not by_weight:
        return []
    listed = [f"{weight:.5g} kN/m³ {names_in_runs(names)}" for weight, names in sorted(by_weight.items())]
    shown, rest, last = first_and_last(listed, 3, 1)
    more = [f"... {rest} more ..."] if rest else []
    return ["own unit weights: " + "; ".join([*shown, *more, *last])]


def path_in_words(basis: str, ratio: float | None, fos: float | None = None, change: float = 0.0) -> str:
    """What a factor of many blocks is.

    Parameters
    ----------
    basis, change : as of `findings.Mechanism`; ratio : k_t / k_n of the elastic joints, None where it is not known

    >>> path_in_words("limit", 0.4)
    'limit of the elastic path (k_t/k_n 0.4)'
    >>> path_in_words("peak", 0.4, 1.6, 0.005)
    'peak of the elastic path (k_t/k_n 0.4): last state at rest; the blocks run at 1.6080, 0.5 % higher'
    """
    path = "the elastic path" if ratio is None else f"the elastic path (k_t/k_n {ratio:g})"
    if basis != "peak":
        return f"limit of {path}" + (", settled" if basis == "settled" else "")
    runs = ""
    if fos is not None and change > 0.0:
        runs = f"; the blocks run at {factor_text(fos * (1.0 + change)).strip()}, {change * 100:.2g} % higher"
    return f"peak of {path}: last state at rest{runs}"
