"""Toppling columns on a stepped base, with Goodman & Bray's table to compare PRE-IE with."""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from slopekit.closed_form.toppling import (
    ColumnSlope,
    TopplingTable,
    seismic_gain,
    toe_force_required,
    toppling_factor_of_safety,
    toppling_table,
)
from slopekit.core.arrays import Floats
from slopekit.core.errors import DesignError, Notice
from slopekit.core.orientation import number as number_text
from slopekit.core.sheet import Section, counted
from slopekit.design.fields import Field, declare, number
from slopekit.design.parts import Action, Water
from slopekit.design.reading.reader import Reader
from slopekit.design.sections import strength_names
from slopekit.geometry.sections.columns import (
    BASE,
    RISER,
    column_assembly,
    column_outlines,
    slope_heights,
    too_many_columns,
)
from slopekit.kinds.assemblies.many_blocks import (
    ManyBlocks,
    contact_areas,
    named_strength,
    water_of_blocks,
)
from slopekit.kinds.assemblies.many_blocks_design import (
    MOST_BLOCKS,
    NamedDesign,
    Point2,
    common_attributes,
    named_pressures,
    read_pressures,
    read_surcharges,
    water_by,
)
from slopekit.kinds.assemblies.many_blocks_scene import (
    AssemblyScene,
    scene_loads,
    with_ground,
    with_loads,
)
from slopekit.kinds.protocol import ClosedForm, Gain
from slopekit.kinds.words import BLOCKS_STATUSES, first_and_last, slope_sections
from slopekit.result import Result, Words

_FAILING_MARGIN = 1e-6  # the table is that of columns which just fail
_MOST_HEIGHTS = 20


_WESTWARD = 270.0  # columns rise toward +x and fall toward -x


@dataclass(frozen=True, kw_only=True)
class ToppleDesign(NamedDesign):
    """Columns on a stepped base (Goodman & Bray 1976), numbered C1, C2, ... from the toe upward; per `thickness_m`.

    Attributes
    ----------
    dip_deg : of the columns, into the slope: the base of each dips 90° less out of it
    width_m : of every column, along the base
    heights_m : from the toe upward, square to the base
    base_step_m : how much the base of each column lies above that of the one below, square to the base
    base, sides : names of the strengths
    pressures_kpa : mean water pressure on the bases and on the sides
    slope_height_m, slope_face_deg, slope_upper_deg, base_angle_deg : what heights and step were made from, None where
        they were given themselves
    """

    OMITTED_IF_NONE: ClassVar[tuple[str, ...]] = (
        "slope_height_m",
        "slope_face_deg",
        "slope_upper_deg",
        "base_angle_deg",
    )
    ACTIONS: ClassVar[Mapping[str, Action]] = {"pressures_kpa": "water"}

    FALLS_WEST = True
    EXTRA_KEYS: ClassVar[tuple[Field, ...]] = (
        declare("columns.base", "text", left_out="the only one", doc="strength of the bases"),
        declare(
            "columns.sides", "text", left_out="the only one", doc="strength between the columns"
        ),
    )

    dip_deg: float = number(
        "columns.dip",
        "angle",
        above=0.0,
        below=90.0,
        code="E101",
        example="60",
        label="dip of the columns",
        advice="Columns dip into the slope; their base falls out of it, normal to them.",
    )
    width_m: float = number(
        "columns.width",
        "length",
        above=0.0,
        code="E240",
        example="10 m",
        doc="of every column, along the base",
    )
    heights_m: tuple[float, ...] = number(
        "columns.heights",
        "length",
        default=(),
        above=0.0,
        code="E240",
        many="list",
        at_least=1,
        example="[4, 10, 16]",
        label="height of C{k}",
        left_out="those of the slope",
        doc="from the toe upward, normal to the base",
    )
    base_step_m: float = number(
        "columns.base_step",
        "length",
        default=0.0,
        least=0.0,
        code="E240",
        says="it lies from 0 to less than the lowest column",
        doc="how much each base lies above that of the column below, normal to it",
    )
    base_angle_deg: float | None = number(
        "columns.base_angle",
        "angle",
        default=None,
        above=0.0,
        below=90.0,
        code="E101",
        example="36",
        label="base angle",
        axis="base angle",
        left_out="by the step",
        doc="dip of the stepped base as a whole, in place of base_step",
    )
    slope_height_m: float | None = number(
        "slope.height",
        "length",
        default=None,
        above=0.0,
        code="E116",
        example="92.5 m",
        label="height of the slope",
        left_out="by the heights",
        doc="vertical, from the foot of C1 to the crest: makes the heights of the columns",
    )
    slope_face_deg: float | None = number(
        "slope.face",
        "angle",
        default=None,
        above=0.0,
        below=90.0,
        code="E101",
        example="56.6",
        label="dip of the face",
        axis="dip of the face",
        left_out="by the heights",
        doc="dip alone",
    )
    slope_upper_deg: float | None = number(
        "slope.upper",
        "angle",
        default=None,
        least=0.0,
        below=90.0,
        code="E101",
        example="4",
        label="dip of the upper slope",
        axis="dip of the upper slope",
        left_out="0 with a slope",
        doc="dip alone",
    )
    thickness_m: float = number("columns.thickness", "length", default=1.0, above=0.0, code="E240")
    base: str
    sides: str
    water: Water = water_by(
        declare(
            "pressures.base", "pressure", 0.0, axis="water pressure on the bases", example="5 kPa"
        ),
        declare(
            "pressures.sides", "pressure", 0.0, axis="water pressure on the sides", example="3 kPa"
        ),
        excluded_keys=("depth",),
    )
    pressures_kpa: Point2 = (0.0, 0.0)

    @property
    def wet_interfaces(self) -> tuple[str, ...]:
        """The bases of the columns, and their sides."""
        return "base", "sides"

    @property
    def block_names(self) -> tuple[str, ...]:
        """The names of the columns, from the toe upward."""
        return column_names(len(self.heights_m))


def column_names(columns: int) -> tuple[str, ...]:
    """Return the names of columns: C1, C2, ..."""
    return tuple(f"C{column}" for column in range(1, columns + 1))


def read_topple(reader: Reader) -> ToppleDesign:
    """Read the design of columns on a stepped base.

    Raises
    ------
    DesignError
        With every fault found: E101 a dip, E240 a size or step that cannot be, E448 and E450 a slope that makes no
        columns, and those of every assembly.
    """
    node = reader.find("columns")
    values = reader.fields(ToppleDesign)
    values |= _from_slope(reader, values)
    heights, step, below = (
        values["heights_m"] or (),
        values["base_step_m"],
        reader.find("columns.base_step"),
    )
    shortest = min(heights, default=None)
    if step is not None and shortest is not None and step >= shortest:
        limits = f"from 0 to less than the lowest column ({number_text(shortest)} m)"
        reader.fault("E240", f"base_step is {number_text(step)}, it lies {limits}", below)
    users = [(name, node.get(name), node) for name in ("base", "sides")] if node else []
    base, sides = strength_names(reader, users) or (None, None)
    interfaces = dict.fromkeys(("base", "sides", *(name for name, _ in named_pressures(reader))))
    water = read_pressures(reader, list(interfaces))
    names = dict.fromkeys(column_names(len(heights)), True)
    return reader.build(
        ToppleDesign,
        values,
        common_attributes(reader, names, True, _WESTWARD, water),
        base=base,
        sides=sides,
        pressures_kpa=water.pressures_kpa or (0.0, 0.0),
        surcharges_kpa=tuple(read_surcharges(reader, names)),
    )


def _from_slope(reader: Reader, values: Mapping[str, Any]) -> dict[str, Any]:
    """Return heights and step of the columns where the design gives a slope or a base angle instead."""
    heights, slope = reader.find("columns.heights"), reader.find("slope")
    step, angle = reader.find("columns.base_step"), reader.find("columns.base_angle")
    faults_before = len(reader.faults)
    if not heights and not slope:
        advice = "Give columns.heights, or slope: {height: 92.5 m, face: 56.6, upper: 4}."
        reader.fault(
            "E448",
            "the columns have no heights, and there is no slope to make them from",
            slope,
            advice,
        )
    if heights and slope:
        reader.fault(
            "E448",
            "columns.heights and slope both say how high the columns are",
            slope,
            "Keep one of them.",
        )
    if step and angle:
        message = "columns.base_step and columns.base_angle both say how the base is stepped"
        reader.fault("E448", message, angle, "Keep one of them.")
    for key in ("height", "face") if slope else ():
        if not slope.get(key):
            reader.fault(
                "E448", f"slope.{key} is missing: the columns are made from height and face", slope
            )
    dip, width = values["dip_deg"], values["width_m"]
    if len(reader.faults) > faults_before or dip is None or width is None:
        return {}
    attributes: dict[str, Any] = {}
    base = 90.0 - dip
    stepped = values["base_step_m"]
    if angle and values["base_angle_deg"] is not None:
        stepped = width * math.tan(math.radians(values["base_angle_deg"] - base))
        attributes["base_step_m"] = stepped
        if stepped < 0.0:
            message = f"base angle is {number_text(values['base_angle_deg'])}°, it is not below the dip of the bases"
            reader.fault(
                "E450",
                f"{message}, {number_text(base)}°",
                angle,
                "They dip 90° less than the columns.",
            )
            return {"base_step_m": None}
    if (
        not slope
        or values["slope_height_m"] is None
        or values["slope_face_deg"] is None
        or stepped is None
    ):
        return attributes
    upper = values["slope_upper_deg"] or 0.0
    base_angle = base + math.degrees(math.atan(stepped / width))
    face = values["slope_face_deg"]
    if face <= base_angle:
        message = f"the face dips {number_text(face)}°, no more than the base of the columns ({base_angle:.4g}°)"
        reader.fault(
            "E450", message, reader.find("slope.face"), "No column stands above such a base."
        )
    elif upper >= base_angle:
        message = (
            f"the upper slope dips {number_text(upper)}°, no less than the base of "
            f"the columns ({base_angle:.4g}°)"
        )
        reader.fault("E450", f"{message}: they never end", reader.find("slope.upper"))
    elif too_many_columns(values["slope_height_m"], face, upper, base, width, stepped, MOST_BLOCKS):
        message = f"the slope takes more than {MOST_BLOCKS} columns of {number_text(width)} m"
        reader.fault("E450", message, reader.find("columns.width"), "Give wider columns.")
    else:
        attributes["heights_m"] = slope_heights(
            values["slope_height_m"], face, upper, base, width, stepped
        )
        if not attributes["heights_m"]:
            message = (
                f"no column of {number_text(width)} m stands higher than its step on this slope"
            )
            reader.fault(
                "E450",
                message,
                reader.find("columns.width"),
                "Give narrower columns, or a smaller step.",
            )
    return attributes


def cut(design: ToppleDesign) -> AssemblyScene:
    """Return the columns with their loads. Raises GeometryError and DesignError as `with_ground` and `with_loads`."""
    return with_loads(design, _columns_with_water(design), 270.0)


def _crest_x(design: ToppleDesign) -> float | None:
    """Return the distance (m) of the crest from the foot of C1, into the slope; None for columns without a slope."""
    if design.slope_height_m is None or design.slope_face_deg is None:
        return None
    return design.slope_height_m / math.tan(math.radians(design.slope_face_deg))


def _columns_with_water(design: ToppleDesign) -> AssemblyScene:
    heights = np.array(design.heights_m)
    assembly = column_assembly(
        design.dip_deg, design.width_m, heights, design.base_step_m, design.thickness_m
    )
    outlines, bedrock = column_outlines(design.dip_deg, design.width_m, heights, design.base_step_m)
    base, sides = design.strength(design.base), design.strength(design.sides)
    joint = assembly.patches.joint
    number_text = dict(zip(design.block_names, outlines, strict=True)) | {
        "bedrock": np.asarray(bedrock)
    }
    scene = AssemblyScene(
        assembly,
        design.block_names,
        ("base", "sides", "riser"),
        (base, sides, base),
        np.full(len(assembly), design.rock.unit_weight_kn_m3),
        np.where(
            joint == BASE,
            design.pressures_kpa[0],
            np.where(joint == RISER, 0.0, design.pressures_kpa[1]),
        ),
        number_text,
        {},
        (),
        (),
        thickness=design.thickness_m,
        crest_x=_crest_x(design),
    )
    return with_ground(design, scene)


@dataclass(frozen=True, kw_only=True)
class GoodmanBray(ClosedForm):
    """The closed form of a row of columns by Goodman & Bray's method."""

    design: ToppleDesign

    def figure(self, name: str, column: Any) -> float | None:
        if name == "toe_force_kn":
            return toe_force_required(column_slope(self.design))
        if name == "column_force_kn":
            return float(toppling_table(column_slope(self.design)).force_kn[int(column or 1) - 1])
        return None

    def seismic_gain(self, k: float) -> Gain | None:
        toward = self.design.seismic.trend_deg
        if why_no_table(self.design) or (toward is not None and toward <= 180.0):
            return None
        try:
            factor, column = seismic_gain(replace(column_slope(self.design), seismic=k))
        except DesignError:
            return None
        return Gain(factor, self.design.block_names[column - 1])


def goodman_bray(design: ToppleDesign, _: AssemblyScene | None) -> GoodmanBray:
    """Return the closed form of a row of columns, with its table at the factor where the columns are at their limit."""

    def form(
        reason: str, factor: float | None = None, status: str = "", table: Iterable[Any] = ()
    ) -> GoodmanBray:
        notices = [Notice("W310", reason)] if reason else []
        return GoodmanBray(
            factor or None, status, reason, table=tuple(table), notices=notices, design=design
        )

    if reason := why_no_table(design):
        return form(reason)
    try:
        slope = column_slope(design)
        factor, status = toppling_factor_of_safety(slope)
        table = toppling_table(slope, (factor or 1.0) * (1.0 + _FAILING_MARGIN))
    except DesignError as error:
        return form(
            f"Goodman & Bray's method does not take these columns: {error.faults[0].message}"
        )
    return form(
        _why_not(design, table, slope.loads is not None, factor), factor, status, _columns(table)
    )


def _why_not(
    design: ToppleDesign, table: TopplingTable, is_loaded: bool, factor: float | None
) -> str:
    """Return in words why the factor of the method is not compared with PRE-IE's; empty where it is."""
    base, sides = design.strength(design.base), design.strength(design.sides)
    rough = math.tan(math.radians(base.friction_angle_deg)) * math.tan(
        math.radians(sides.friction_angle_deg)
    )
    if factor and rough >= factor**2:
        return (
            f"at {factor:.4g} the columns are so rough (tan φ tan φ of the sides above 1) that Goodman & Bray's "
            "sliding has no meaning: not compared"
        )
    if not table.base_holds.all():
        lifted = ", ".join(f"C{n + 1}" for n in np.flatnonzero(~table.base_holds)[:5])
        return f"Goodman & Bray's forces are not admissible at {lifted} (lifted, or slipping back): not compared"
    sliding = _pushed_columns(table) if is_loaded else []
    if sliding:
        return (
            f"Goodman & Bray's P act at the tops of columns, and {sliding[0]}, which slides, need not press there: it "
            "is above one that topples: not compared"
        )
    return ""


def _pushed_columns(table: TopplingTable) -> list[str]:
    """Return the columns that slide above a toppling column, driven by water or a load on their tops."""
    topples = [k for k, mode in enumerate(table.modes) if mode == "topple"]
    return [
        f"C{k + 1}"
        for k, mode in enumerate(table.modes)
        if mode == "slide" and topples and k > topples[0]
    ]


def why_no_table(design: ToppleDesign) -> str:
    """Return in words why Goodman & Bray's method does not apply to a design; empty where it does."""
    sides, base = design.strength(design.sides), design.strength(design.base)
    reasons = {
        "knows one friction angle for all bases": bool(sides.law or base.law),
        "knows no cohesion on the sides of columns": bool(sides.cohesion_kpa),
        "is without forces and bolts on single columns": bool(design.forces or design.bolts),
        "knows no dilation": bool(sides.dilation_deg or base.dilation_deg),
    }
    first = next((reason for reason, holds in reasons.items() if holds), "")
    return first and f"the closed form (Goodman & Bray) {first}: not compared"


def _columns(table: TopplingTable) -> Iterator[Mapping[str, Any]]:
    for k in range(len(table.heights_m)):
        yield {
            "n": k + 1,
            "y_m": float(table.heights_m[k]),
            "M_m": _finite(table.upper_contact_m[k]),
            "L_m": _finite(table.lower_contact_m[k]),
            "P_topple_kn": _finite(table.topple_force_kn[k]),
            "P_slide_kn": _finite(table.slide_force_kn[k]),
            "P_kn": _finite(table.force_kn[k]),
            "R_kn": _finite(table.normal_kn[k]),
            "S_kn": _finite(table.shear_kn[k]),
            "mode": table.modes[k],
        }


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def column_slope(design: ToppleDesign) -> ColumnSlope:
    base, sides = design.strength(design.base), design.strength(design.sides)
    toward, k = design.seismic.trend_deg, design.seismic.coefficient
    return ColumnSlope(
        heights_m=design.heights_m,
        width_m=design.width_m,
        step_m=design.base_step_m,
        base_dip_deg=90.0 - design.dip_deg,
        unit_weight_kn_m3=design.rock.unit_weight_kn_m3,
        friction_angle_deg=base.friction_angle_deg,
        side_friction_angle_deg=sides.friction_angle_deg,
        cohesion_kpa=base.cohesion_kpa,
        seismic=k if toward is None or toward > 180.0 else -k,
        loads=_loads(design),
    )


def _loads(design: ToppleDesign) -> Floats | None:
    """Return water and surcharge on the columns (n, 3) for Goodman & Bray's method, from the integrals of PRE-IE.

    Per metre: down along the bases, square into them, and the moment about the outer corner of each base.
    """
    if not (design.water.has_table or design.surcharges_kpa or any(design.pressures_kpa)):
        return None
    scene = _columns_with_water(design)
    loads = scene_loads(replace(scene, unit_weights=np.zeros(len(scene.assembly))))
    count = len(design.heights_m)
    forces, moments = (
        loads.forces[:count] / design.thickness_m,
        loads.moments[:count, 1] / design.thickness_m,
    )
    dip = math.radians(90.0 - design.dip_deg)
    down, into = (
        np.array([-math.cos(dip), 0.0, -math.sin(dip)]),
        np.array([math.sin(dip), 0.0, -math.cos(dip)]),
    )
    along, normal = forces @ down, forces @ into
    turning = (
        along * np.array(design.heights_m) / 2.0 - normal * design.width_m / 2.0 - moments
    )  # +y turns into the slope
    return np.column_stack([along, normal, turning])


def _slope(design: ToppleDesign, result: Result) -> list[Section]:
    heights = design.heights_m
    count = len(heights)
    step = (
        f", each {design.base_step_m:.6g} m above the one below"
        if design.base_step_m
        else ", in one plane"
    )
    entries = [
        f"{counted(count, 'column')}, C1 at the toe, {design.width_m:.6g} m wide, dip {number_text(design.dip_deg)}° "
        f"into the slope, {design.thickness_m:.6g} m thick along the strike",
        f"bases dip {number_text(90.0 - design.dip_deg)}° out of the slope"
        + (step if count > 1 else ""),
    ]
    if design.slope_height_m is not None and design.slope_face_deg is not None:
        crest = heights.index(max(heights)) + 1
        entries.append(
            f"made from a slope {design.slope_height_m:.6g} m high, face {number_text(design.slope_face_deg)}°, upper "
            f"slope {number_text(design.slope_upper_deg or 0.0)}°, as Goodman & Bray do: crest at C{crest}"
        )
    low, high = min(heights), max(heights)
    if low == high:
        entries.append(f"heights {'all ' if count > 1 else ''}{high:.6g} m")
    else:
        first, between, last = first_and_last(
            [f"{height:.6g}" for height in heights], _MOST_HEIGHTS - 4, 4
        )
        listed = ", ".join([*first, *([f"... {between} more ..."] if between else []), *last])
        tallest = f"C{heights.index(high) + 1}"
        entries.append(
            f"heights {low:.6g} to {high:.6g} m ({tallest} the tallest), from the toe upward: {listed}"
        )
    if design.base == design.sides:
        entries.append(f"bases and sides  {named_strength(design, design.base)}")
    else:
        entries += [
            f"{surface}  {named_strength(design, name)}"
            for surface, name in (("bases", design.base), ("sides", design.sides))
        ]
    wet = list(zip(("bases", "sides"), design.pressures_kpa, strict=True))
    return slope_sections(
        result,
        Section("COLUMNS", entries),
        water_of_blocks(wet),
        contact_areas(result.geometry.areas_m2),
    )


KIND = ManyBlocks(
    ToppleDesign,
    read_topple,
    Words(
        "toppling columns",
        "topple",
        "out of the slope",
        "Goodman & Bray closed form",
        "Goodman & Bray",
        BLOCKS_STATUSES,
        "Goodman & Bray's method does not take this design (see NOTE)",
    ),
    cut,
    goodman_bray,
    _slope,
)
