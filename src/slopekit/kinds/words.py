"""Text that the sheets of the kinds share: rounded numbers, strengths, loads, shortened lists of names."""

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TypeVar

from slopekit.block_scene import Sizes
from slopekit.core.orientation import Line, coordinates
from slopekit.core.sheet import Section, counted
from slopekit.design.common import Design
from slopekit.design.fields import fields_of
from slopekit.design.parts import Bolt, Force, Strength, listed
from slopekit.extents import SectionGeometry
from slopekit.result import Result

MOST_RUNS = 4
#: Statuses of many blocks.
BLOCKS_STATUSES: Mapping[str, str] = {
    "slides": "blocks slide",
    "topples": "blocks topple",
    "rotates": "blocks turn as they slide",
    "falls": "blocks fall: no strength that was tried holds them",
    "lifted": "blocks are lifted off: no strength that was tried holds them",
    "no_driving_force": "stands: every block stands without any strength",
}
WEIGHT_ONLY = "self-weight; dry"
_PUSHES = ("force", "surcharge")  # of what attributes do to a slope
_NUMBERS = r"([0-9]+)"
_FEW_LOADS = 8
_FEW_TRACES = 6
_MANY_KN = 100_000  # a force is in MN from here on
_HUGE = 1e9  # strengths from here on stand for joints that never fail
_SAME_HEIGHT = 1e-6  # of a height, which files give in as many digits

T = TypeVar("T")


# -- many names ---------------------------------------------------------------------------------------------------


def names_in_runs(names: Iterable[str], most: int = MOST_RUNS) -> str:
    """Return names in their order, three or more consecutive numbers as a run; after `most` runs only their number.

    >>> names_in_runs(["C1", "C2", "C3", "C5", "C7", "C8"])
    'C1 to C3, C5, C7, C8'
    >>> names_in_runs([f"B{2 * k}" for k in range(50)])
    'B0, B2, B4, B6, ... and 46 more'
    """
    runs = _runs(list(names))
    first_runs, rest = runs[:most], sum(len(run) for run in runs[most:])
    words = [", ".join(run) if len(run) < 3 else f"{run[0]} to {run[-1]}" for run in first_runs]
    return ", ".join([*words, f"... and {rest} more"] if rest else words)


def _runs(names: list[str]) -> list[list[str]]:
    runs: list[list[str]] = []
    last: list[str] = []
    for name in names:
        pieces = re.split(_NUMBERS, name)
        if runs and _follows(last, pieces):
            runs[-1].append(name)
        else:
            runs.append([name])
        last = pieces
    return runs


def _follows(former: Sequence[str], later: Sequence[str]) -> bool:
    """Return whether two names, split into texts and numbers, differ in one number only, which is larger by one."""
    if len(former) != len(later):
        return False
    changed = [k for k, (old, new) in enumerate(zip(former, later, strict=True)) if old != new]
    return (
        len(changed) == 1
        and changed[0] % 2 == 1
        and int(later[changed[0]]) == int(former[changed[0]]) + 1
    )


def in_order(names: Iterable[str], order: Mapping[str, int]) -> list[str]:
    """Return names in the order of the blocks, unknown names last."""
    return sorted(names, key=lambda name: order.get(name, len(order)))


def first_and_last(
    items: Sequence[T], first: int, last: int
) -> tuple[Sequence[T], int, Sequence[T]]:
    """Return the first and last of many items and the number between them; all items if only one would be left out.

    >>> first_and_last(range(6), 2, 1)
    (range(0, 2), 3, range(5, 6))
    """
    between = len(items) - first - last
    return (items, 0, ()) if between <= 1 else (items[:first], between, items[len(items) - last :])


def shortened(items: Sequence[str], most: int) -> list[str]:
    """Return the first of many items, and the number of the others.

    >>> shortened(["a", "b", "c", "d"], 2)
    ['a', 'b', '... and 2 more']
    """
    first, rest, _ = first_and_last(items, most, 0)
    return [*first, f"... and {rest} more"] if rest else list(first)


def times(count: int) -> str:
    """Return a count in words: never, once, twice, 3 times."""
    return {0: "never", 1: "once", 2: "twice"}.get(count, f"{count} times")


# -- one design ----------------------------------------------------------------------------------------------------


def slope_sections(
    result: Result, made_from: Section, loads: Sequence[str], size: Sequence[str] = ()
) -> list[Section]:
    """Return the sections of the analysed blocks, their size, and the loads on them.

    Parameters
    ----------
    made_from : joints and faces, sets, columns or blocks; loads, size : what the kind has to say of these
    """
    size_of = _size_of_block if result.findings is None else _size_of_blocks
    measured = size_of(result)
    return [
        made_from,
        replace(measured, entries=[*measured.entries, *size]),
        loads_section([*loads, *result.design.ground_in_words()], result),
    ]


def _size_of_block(result: Result) -> Section:
    """Return height, volume, weight and extent of one block; mass, unit weight and traces in the full sheet."""
    design, geometry = result.design, result.geometry
    per = " per metre" if isinstance(geometry, SectionGeometry) else ""
    total_m = geometry.total_height_m
    scaled = getattr(geometry, "scaled", None)
    height_m = getattr(design, "height_m", total_m) * (
        1.0 if scaled is None else scaled["factor"]
    )  # from toe to crest
    extent = [] if result.size is None else extents_in_words(result.size)
    traces = [] if result.size is None else traces_in_words(result.size)
    mass = [f"mass {short(result.mass_t)} t{per}"] if result.mass_t else []
    total = (
        []
        if math.isclose(total_m, height_m, rel_tol=_SAME_HEIGHT)
        else [f"the block {short(total_m)} m high"]
    )
    details = ["  ".join([*mass, *unit_weight_in_words(result), *total]), *traces]
    measured = _height_and_volume(height_m, geometry.volume_m3) + per
    return Section(
        "SIZE",
        ["  ".join([measured, weight_in_words(result), *extent])],
        details=[design.in_own_names(text) for text in details if text],
    )


def _size_of_blocks(result: Result) -> Section:
    """Return the numbers of blocks and contacts, height, volume and weight of an assembly."""
    geometry, findings, first = result.geometry, result.findings, result.size
    assert findings is not None
    bedrock = f" and {findings.fixed} of bedrock" if findings.fixed else ""
    groups = (
        f", in {findings.components} groups that touch only through bedrock"
        if findings.components > 1
        else ""
    )
    moving = counted(findings.blocks - findings.fixed, "block")
    entries = [
        f"{moving} that can move{bedrock}, {counted(findings.contacts, 'contact')}{groups}",
        f"{_height_and_volume(geometry.total_height_m, geometry.volume_m3)}  {weight_in_words(result)}",
    ]
    if first is not None:
        measured = [
            _height_and_volume(first.height_m, first.volume_m3),
            f"mass {mass_in_words(first.mass_t)}",
        ]
        entries.append(
            "  ".join(
                ["critical block or group: " + measured[0], measured[1], *extents_in_words(first)]
            )
        )
    return Section("SIZE", entries, details=unit_weight_in_words(result))


def _height_and_volume(height_m: float, volume_m3: float) -> str:
    return f"height {short(height_m)} m  volume {short(volume_m3)} m³"


def extents_in_words(sizes: Sizes) -> list[str]:
    """Return width along the crest and setback behind it in words, as far as they were measured.

    >>> extents_in_words(Sizes(5.0, 8.0, 2.0, {}))
    ['crest width 8 m, 2 m behind the crest']
    """
    width = [] if sizes.face_width_m is None else [f"crest width {short(sizes.face_width_m)} m"]
    setback = [f"{short(sizes.setback_m)} m behind the crest"] if sizes.setback_m else []
    return [", ".join([*width, *setback])] if width or setback else []


def traces_in_words(sizes: Sizes) -> list[str]:
    """Return the trace lengths on face and upper slope in words.

    >>> traces_in_words(Sizes(5.0, 8.0, 2.0, {"J1": {"face": 6.0, "upper": 3.0}, "J2": {"face": 7.25}}))
    ['traces on face + upper slope J1 6 + 3 m, J2 7.25 + 0 m']
    """
    traces = [
        f"{name} {short(lengths.get('face', 0.0))} + {short(lengths.get('upper', 0.0))} m"
        for name, lengths in sizes.trace_lengths_m.items()
        if "face" in lengths or "upper" in lengths
    ]
    return (
        [f"traces on face + upper slope {', '.join(shortened(traces, _FEW_TRACES))}"]
        if traces
        else []
    )


def mass_in_words(mass_t: float) -> str:
    """Return a mass in t, below 1 t in kg, in words.

    >>> mass_in_words(0.065), mass_in_words(112.04)
    ('65 kg', '112 t')
    """
    return f"{short(mass_t * 1e3)} kg" if mass_t < 1.0 else f"{short(mass_t)} t"


def force_in_words(force_kn: float) -> str:
    """Return a force in kN, a large one in MN, in words.

    >>> force_in_words(1241.4), force_in_words(5342525.1)
    ('1,240 kN', '5,340 MN')
    """
    return f"{short(force_kn)} kN" if abs(force_kn) < _MANY_KN else f"{short(force_kn / 1000)} MN"


def short(value: float) -> str:
    """Return a number in three digits, without an exponent where possible.

    >>> short(64.887), short(209461.3), short(2.5), short(1e-9)
    ('64.9', '209,000', '2.5', '1e-09')
    """
    rounded = float(f"{value:.3g}")
    return f"{rounded:,.0f}" if 1000 <= abs(rounded) < 10**9 else size_number(rounded)


def loads_section(kind_entries: list[str], result: Result) -> Section:
    """Return the section of the loads: entries of the kind, seismic load, forces and bolts."""
    design = result.design
    in_section = (
        result.findings is not None and getattr(result.geometry, "thickness_m", None) is not None
    )
    x_is_east = in_section or "x" in design.ALONG
    entries = kind_entries + seismic(design, result.words.seismic, x_is_east)
    forces, bolts = (
        [force_text(force) for force in design.forces],
        [bolt_text(bolt) for bolt in design.bolts],
    )
    if any(bolt.head_m is not None for bolt in design.bolts):  # the schedule has them
        bolts = [f"{counted(len(bolts), 'bolt')} (BOLTS)"]
    entries += [*shortened(forces, _FEW_LOADS), *shortened(bolts, _FEW_LOADS)]
    entries += _further_loads(design, " ".join(entries))
    if not entries and design.water.mode != "dry":
        entries = [f"water {design.water.in_words()}"]
    return Section("LOADS", entries or [WEIGHT_ONLY])


def _further_loads(design: Design, text: str) -> list[str]:
    """Return the loads of a design that the text does not name yet."""
    acting = {
        name
        for actions in listed(type(design), "ACTIONS")
        for name, action in actions.items()
        if action in _PUSHES
    }
    entries = []
    for name, field in fields_of(type(design)).items():
        is_load = field.is_attribute and (
            name in acting or field.path.partition(".")[0] in ("loads", "support")
        )
        if not is_load or name in ("seismic", "forces", "bolts"):
            continue
        value = getattr(design, name)
        is_there = value not in (None, (), field.default) and bool(value)
        is_shown = isinstance(value, int | float) and size_number(value) in text
        if is_there and field.key not in text and field.in_words not in text and not is_shown:
            size = f"{value:.6g} {field.unit}".rstrip() if isinstance(value, float) else str(value)
            entries.append(f"{field.in_words.replace('_', ' ')} {size}")
    return entries


def water_in_words(result: Result, highest_of_mean: float = 1.0, falls: str = "") -> list[str]:
    """Return the water of one block in words, unless it is a table: a fraction of full water, or a depth in the crack.

    Parameters
    ----------
    highest_of_mean : the highest pressure of full water in parts of the mean of an interface
    falls : where the pressure of water in the crack falls to nothing
    """
    water, areas = result.design.water, result.geometry.areas_m2
    if depth := water.crack_water_m:
        highest = f"{depth * result.design.water_unit_weight_kn_m3:.4g} kPa at its bottom"
        return [f"water {depth:.4g} m deep in the crack, {highest}, {falls}"]
    if water.has_table or (water.mode == "dry" and not water.crack_fill):
        return []
    if water.mode == "pressures" and water.crack_fill is None:
        if len(water.pressures_kpa) < 2:
            return [f"water {water.in_words()}"]
        pressure_by_name = zip(
            map(result.design.in_own_names, areas), water.pressures_kpa, strict=False
        )
        return [
            f"water of mean pressure {', '.join(f'{mean:g} kPa on {name}' for name, mean in pressure_by_name)}"
        ]
    means = [push / areas[name] for name, push in result.forces.water.items() if areas.get(name)]
    return [f"water {water.in_words()}, highest {highest_of_mean * max(means):.4g} kPa"]


def seismic(design: Design, direction: str, x_is_east: bool) -> list[str]:
    """Return the seismic load in words; empty without one."""
    if not design.seismic.coefficient:
        return []
    trend = design.seismic.trend_deg
    toward = f"toward {trend:03.0f}" if trend is not None else direction
    toward += " (x is 090)" if trend is not None and x_is_east else ""
    return [f"seismic {design.seismic.coefficient:.4g} g {toward}"]


def force_text(force: Force) -> str:
    """Return a force in words: its components, and the point where it acts."""
    block = "" if force.block is None else f" on {force.block}"
    point = "" if force.at_m is None else f" at {coordinates(force.at_m)}"
    size = max(abs(component) for component in force.components_kn)
    components = [
        0.0 if abs(component) < 1e-12 * size else component for component in force.components_kn
    ]
    return "force ({:.6g}, {:.6g}, {:.6g}) kN east, north, up".format(*components) + block + point


def bolt_text(bolt: Bolt) -> str:
    """Return a bolt in words: its force, its direction, and whether it is active or passive."""
    block = "" if bolt.block is None else f" on {bolt.block}"
    head = "" if bolt.head_m is None else f" from {coordinates(bolt.head_m)}"
    return (
        f"bolt {bolt.force_kn:.6g} kN toward {line_in_words(bolt.toward)}{block}{head}, {bolt.acts}"
    )


def weight_in_words(result: Result) -> str:
    """Return the weight of the moving blocks in words."""
    return (
        f"weight {force_in_words(result.forces.weight)}"
        if result.design.rock.unit_weight_kn_m3
        else "weightless"
    )


def unit_weight_in_words(result: Result) -> list[str]:
    """Return the unit weight of the rock in words, with the density that it was computed from."""
    design = result.design
    if not design.rock.unit_weight_kn_m3:
        return []
    density = (
        "" if design.rock.density_kg_m3 is None else f" ({design.rock.density_kg_m3:.5g} kg/m³)"
    )
    return [f"unit weight {design.rock.unit_weight_kn_m3:.5g} kN/m³{density}"]


def strength_in_words(strength: Strength, digits: str = ".1f") -> str:
    """Return a strength in words: cohesion, friction, and dilation, tension and residual strength where it has them.

    >>> strength_in_words(Strength(24.0, 20.0)), strength_in_words(Strength(0.04, 20.0))
    ('c 24.0 kPa  φ 20.0°', 'c 0.04 kPa  φ 20.0°')
    """
    cohesion, friction = strength.cohesion_kpa, strength.friction_angle_deg
    words = f"c {_in_digits(cohesion, digits)} kPa  φ {_in_digits(friction, digits)}°"
    if (law := strength.named_law) is not None:
        words = law.in_words()
    if strength.dilation_deg:
        words += f"  ψ {_in_digits(strength.dilation_deg, digits)}°"
    if strength.tension_kpa:
        words += f"  σt {strength.tension_kpa:.4g} kPa"
    if strength.residual is not None:
        words += f"  {strength.residual.in_words()}"
    return words


def _in_digits(value: float, digits: str) -> str:
    """Return a number in fixed digits, small and huge numbers in significant digits."""
    if value == 0.0 or 1.0 <= abs(value) < _HUGE:
        return f"{value:{digits}}"
    return f"{value:.3g}" if abs(value) < 1.0 else f"{value:.6g}"


def line_in_words(line: Line) -> str:
    """Return trend and plunge as the sheet prints them."""
    return f"{line.trend_deg % 360.0:03.0f}/{line.plunge_deg:.1f}"


def alike(numbers: Iterable[float | None]) -> Callable[[float | None], str]:
    """Return how to write the numbers of a column: all with as many decimals as give its least number four digits.

    The largest has six digits at most. Zeros at the ends of all are left out, and a dash stands for None.

    >>> show = alike([6.971, 4.9, 19.85, None])
    >>> show(6.971), show(4.9), show(19.85), show(None)
    ('6.971', '4.900', '19.850', '-')
    >>> alike([70174.93, 0.02])(70174.93), alike([4.0, 12.5])(4.0), alike([0.0])(0.0)
    ('70174.9', '4.0', '0')
    """
    sizes = [abs(size) for size in numbers if size and math.isfinite(size)] or [1.0]
    finest = max(
        min(3 - math.floor(math.log10(min(sizes))), 5 - math.floor(math.log10(max(sizes)))), 0
    )
    digits = max(len(f"{size:.{finest}f}".rstrip("0").partition(".")[2]) for size in sizes)
    return lambda size: "-" if size is None else f"{round(size, digits) + 0.0:.{digits}f}"


def size_number(value: float) -> str:
    """Return a number in six significant digits, without an exponent unless it is very large or small."""
    if value == 0.0:
        return "0"
    if 1e5 <= abs(value) < 1e9:
        return f"{value:.0f}"
    if 1e-3 <= abs(value) < 1e5:
        return f"{value:.6g}" if abs(value) < 1e3 else f"{value:.1f}"
    return f"{value:.6g}"
