"""Plane failure per metre of slope (Hoek & Bray)."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from slopekit.closed_form.plane import OUTCOMES, PlaneArrays, plane_failures
from slopekit.core.arrays import Floats, cross
from slopekit.core.errors import Fault, GeometryError, Notice
from slopekit.core.orientation import Line, Plane
from slopekit.core.sheet import Section
from slopekit.core.units import is_unit_of, unit_of
from slopekit.design import words
from slopekit.design.fields import Field, declare, fields_of, group, number, orientation
from slopekit.design.ground_water import WORST, SlopeDesign, read_table
from slopekit.design.joints import JOINTS, joints_of, refinements, strengths_of
from slopekit.design.parts import Strength, Water
from slopekit.design.reading.nodes import NOTHING, Node
from slopekit.design.reading.reader import Reader
from slopekit.design.sections import read_common, read_water
from slopekit.extents import SectionGeometry
from slopekit.geometry.pressure import uniform_pieces
from slopekit.geometry.sections.section import (
    CRACK,
    FACE,
    J1,
    UPPER,
    PlaneSection,
    line_pairs,
    plane_section,
)
from slopekit.kinds.protocol import ClosedForm
from slopekit.kinds.single_block import worst_crack
from slopekit.kinds.single_block.closed_forms import (
    MISFITS,
    Arguments,
    ClosedForms,
    OnArrays,
    pressures_and_force,
)
from slopekit.kinds.single_block.held_bolts import Bounds, bounds_of, upward
from slopekit.kinds.single_block.one_block import SingleBlock, left_out_of_slope
from slopekit.kinds.single_block.one_block_limit import Cut, Interface, bedding_on
from slopekit.kinds.single_block.secants import other_strengths, steeper
from slopekit.kinds.solver_inputs import loads_in_slope, section_geometry
from slopekit.kinds.water import LocalSlope, OnFaces, standing_in_crack
from slopekit.kinds.words import (
    short,
    slope_sections,
    strength_in_words,
    water_in_words,
)
from slopekit.result import Result, Words

if TYPE_CHECKING:
    from slopekit.closed_form.sizes import PlaneSizes

WIDEST_DEG = 20.0  # degrees between the strikes of plane and face (Hoek & Bray 1981, ch. 7)
_OUTCOMES = (*("slides_on_J1" if name == "slides" else name for name in OUTCOMES), "E213")


@dataclass(frozen=True)
class VerticalCrack:
    """A vertical tension crack of a plane failure: depth or distance behind the crest, m; `Water` has its water."""

    EXTRA_KEYS: ClassVar[tuple[Field, ...]] = (
        declare(
            "water",
            "length",
            0.0,
            code="E118",
            label="water in the crack",
            or_measures=("pressure",),
            doc="depth of it (or `dry`, `full`, `50 %` of the pressure of a full crack; a mean pressure, `5 kPa`); "
            "triangular there, falling to nothing at the toe",
        ),
    )

    depth_m: float | None = number(
        "depth",
        "length",
        default=None,
        above=0.0,
        code="E120",
        example="4.35 m",
        left_out="by the distance",
    )
    distance_m: float | None = number(
        "distance",
        "length",
        default=None,
        axis="distance of the crack",
        left_out="by the depth",
        words=("worst",),
        doc="behind the crest; below 0 in the face; both where they agree; `worst`: "
        "where the closed form is lowest",
    )


@dataclass(frozen=True, kw_only=True)
class PlaneDesign(SlopeDesign):
    """Plane failure per metre of slope (Hoek & Bray; Wyllie & Mah): one joint, maybe a vertical tension crack."""

    EXTRA_KEYS: ClassVar[tuple[Field, ...]] = (JOINTS,)
    ATTRIBUTE_OF_KEY: ClassVar[Mapping[str, str]] = {
        "joints": "joint",
        "crack.water": "water.crack_water_m",
    }
    ALLOWS_FILL: ClassVar[bool] = True
    HAS_CLOSED_FORM = True

    joint: Plane
    joint_name: str
    face: Plane = orientation("slope.face", axis="the face", example="60/180")
    upper: Plane = orientation(
        "slope.upper", axis="the upper slope", default=None, example="0/180", left_out="level"
    )
    height_m: float = number("slope.height", "length", above=0.0, code="E116", example="12 m")
    strength: Strength
    crack: VerticalCrack | None = group("crack", VerticalCrack, default=None, left_out="no crack")
    refine: int = refinements()

    @property
    def wet_interfaces(self) -> tuple[str, ...]:
        """The joint, and the crack where there is one."""
        return (self.joint_name, "crack") if self.crack is not None else (self.joint_name,)

    @property
    def section_share(self) -> Any:
        """The fraction of the seismic load that acts out of the slope, in its section; a number or (n,)."""
        if self.seismic.trend_deg is None:
            return 1.0
        share: Any = np.cos(
            np.radians(np.subtract(self.seismic.trend_deg, self.face.dip_direction_deg))
        )
        return share

    def changes(self) -> Iterator[tuple[str, Self]]:
        """Yield designs with one input a little changed, by name."""
        if not self.water.has_table and (self.water.mode == "dry" or self.water.fill < 1.0):
            yield "full water", replace(self, water=Water("full", 1.0))
        yield from other_strengths(self)
        if self.joint.dip_deg <= 89.0:
            yield f"dip of {self.joint_name} +1°", replace(self, joint=steeper(self.joint))

    def plain(self, exact: bool = False) -> dict[str, Any]:
        """Return the attributes as JSON values, the depth of water in the crack with the crack."""
        document = super().plain(exact)
        depth = document.pop("crack_water_m", None)
        if document["crack"] is not None:
            document["crack"]["water_m"] = depth
        return document

    def in_own_names(self, sentence: str) -> str:
        """Return a sentence with the user's name of the joint in place of "its plane"."""
        return (
            sentence if self.joint_name == "J1" else sentence.replace("its plane", self.joint_name)
        )


def read_plane(reader: Reader) -> PlaneDesign:
    """Read the design of a plane failure.

    Raises
    ------
    DesignError
        With every fault found.
    """
    joints = joints_of(reader, 1)
    values = reader.fields(PlaneDesign)
    if values["upper"] is None and not reader.find("slope.upper"):
        values["upper"] = reader.default(
            "upper", Plane(0.0, 0.0 if values["face"] is not None else 180.0)
        )
    node = reader.find("crack")
    if node and not (node.get("depth") or node.get("distance")):
        reader.fault(
            "E143",
            "crack.depth is missing",
            node,
            "Add depth: 4.35 m, or distance: 4 m from the crest.",
        )
        node = NOTHING
    crack = VerticalCrack(**reader.fields(VerticalCrack, node)) if node else None
    strengths = strengths_of(reader, joints)
    names = [joint.name for joint in joints] or ["J1"]
    water = _water_of_plane(reader, names, node)
    common = read_common(reader)
    searched = node.get("distance").text == WORST
    if searched and node.get("depth"):
        reader.fault(
            "E112",
            "crack has depth and distance: worst: they exclude each other",
            node,
            "Keep one of them.",
        )
    design: PlaneDesign = reader.build(
        PlaneDesign,
        values,
        common,
        joint=joints[0].plane if joints else None,
        joint_name=names[0],
        crack=crack,
        strength=strengths[0] if strengths else None,
        water=water,
    )
    if not searched:
        return design
    return worst_crack.with_worst_crack(design, ON_ARRAYS, str(node.place))


def _water_of_plane(reader: Reader, names: Sequence[str], crack: Node) -> Water:
    """Return the water of the design, or that of its crack: fill, mean pressure, or depth."""
    in_crack, interfaces = crack.get("water"), [*names, "crack"] if crack else names
    water = read_table(reader) or read_water(reader, interfaces, len(interfaces))[0]
    if in_crack.value is None:
        return water
    value = reader.value(in_crack)
    unit = unit_of(value)
    is_pressure = is_unit_of(unit, "pressure")
    fills = in_crack.text in ("dry", "full") or unit == "%" or is_pressure
    if reader.find("water") if fills else water != Water():
        reader.fault(
            "E112", "crack.water and water both say how full it is", in_crack, "Keep one of them."
        )
    if not fills:
        return Water(crack_water_m=reader.field(fields_of(VerticalCrack)["water"], in_crack))
    if is_pressure:
        mean = reader.number(fields_of(Water)["pressures_kpa"], in_crack, "water pressure")
        return Water("pressures", 0.0, (0.0, mean)) if mean else Water()
    share = reader.faults.of(words.fill, value, str(in_crack.place))
    return Water("full", share) if share else Water()


def cut(design: PlaneDesign) -> Cut:
    """Cut the section and load it.

    Raises
    ------
    GeometryError
        Where the plane forms no block that can slide out; E213 where it strikes across the slope.
    """
    section = section_of(design)
    name, axes, bounding_planes = design.joint_name, _axes(design.face), bounds(design)
    flat = axes * [[1.0], [0.0], [1.0]]  # the position along the slope is ignored
    acting = loads_in_slope(design, section.block, bounding_planes, _full_water, axes[0], flat)
    bed = bedding_on(
        {J1: section.ends}, acting, section.block.centroid, [design.strength], in_section=True
    )
    is_cracked = section.crack_depth is not None
    left_out = ["the ends of the slope (per metre)", "deformation of the rock"]
    return Cut(
        section.block,
        acting,
        lambda refine: bed.scene(line_pairs(section, 2**refine)),
        [Interface(J1, name, design.strength)],
        lambda: section_geometry(section, name, axes, _crest_x(design)),
        left_out_of_slope(left_out, is_cracked, [design.strength]),
        {J1: name} | ({CRACK: "crack"} if is_cracked else {}) | design.ponded(FACE, UPPER),
        FACE,
        bounding_planes,
        design.refine,
        axes=axes,
    )


def _crest_x(design: PlaneDesign) -> float:
    """Return the position of the crest, out of the slope from the toe, m."""
    return (
        -design.height_m / math.tan(math.radians(design.face.dip_deg))
        if design.face.dip_deg < 90.0
        else 0.0
    )


def _signed_dip(plane: Plane, face: Plane) -> Any:
    """Return the dip (°), positive where a plane dips to the side of the face; angles may be arrays."""
    is_same_side = (
        np.cos(np.radians(np.subtract(plane.dip_direction_deg, face.dip_direction_deg))) >= 0.0
    )
    return np.where(is_same_side, plane.dip_deg, np.negative(plane.dip_deg))


def section_of(design: PlaneDesign) -> PlaneSection:
    """Return the section of the block. Raises GeometryError where the plane forms no block that can slide out."""
    for name, plane in ((design.joint_name, design.joint), ("the upper slope", design.upper)):
        difference_deg = _strike_difference(plane.dip_direction_deg, design.face.dip_direction_deg)
        if difference_deg > WIDEST_DEG and plane.dip_deg > 0.0:
            message = (
                f"{name} strikes {difference_deg:.1f}° from the face: plane failure "
                f"needs {WIDEST_DEG:.0f}° or less"
            )
            raise GeometryError(
                [
                    Fault(
                        "E213", message, "", "With a second joint it may form a wedge: kind: wedge."
                    )
                ]
            )
    crack = design.crack
    return plane_section(
        float(_signed_dip(design.joint, design.face)),
        design.face.dip_deg,
        float(_signed_dip(design.upper, design.face)),
        design.height_m,
        crack.depth_m if crack else None,
        crack.distance_m if crack else None,
    )


def _strike_difference(direction: Any, face: Any) -> Any:
    """Return the angle (°) between the strikes of planes from their dip directions, numbers or arrays."""
    difference_deg = np.abs(np.subtract(direction, face)) % 180.0
    return np.minimum(difference_deg, 180.0 - difference_deg)


def _axes(face: Plane) -> Floats:
    """Return the axes of the section as rows in east, north, up: out of the slope, along it, up."""
    outward = Line(face.dip_direction_deg, 0.0).vector()
    up = np.array([0.0, 0.0, 1.0])
    return np.array([outward, np.cross(up, outward), up])


def _full_water(slope: LocalSlope, unit_weight: Any) -> list[OnFaces]:
    """Return full water: to the top of the crack; without a crack γ_w H/2 halfway along the plane, 0 at its ends."""
    if slope.crack is not None:
        return standing_in_crack(slope, unit_weight)
    return [
        (
            slope.bounds.joints,
            uniform_pieces(
                slope.faces[list(slope.bounds.joints)], unit_weight * slope.extents[:, 2] / 4.0
            ),
        )
    ]


# -- the closed form ----------------------------------------------------------------------------------


def arguments(design: PlaneDesign) -> Arguments:
    """Return the arguments of Hoek & Bray's plane failure for a design, without its passive bolts."""
    face, crack = design.face, design.crack
    pressures, loads = pressures_and_force(design, 1, bounds, _full_water)
    has_pressures = pressures[0] is not None
    return loads | {
        "plane_dip_deg": _signed_dip(design.joint, face),
        "upper_dip_deg": _signed_dip(design.upper, face),
        "face_dip_deg": face.dip_deg,
        "face_direction": face.dip_direction_deg,
        "across": _strikes_across(design.joint, face) | _strikes_across(design.upper, face),
        "height_m": design.height_m,
        **_strength_arguments(design.joint_strengths),
        "unit_weight_kn_m3": design.rock.unit_weight_kn_m3,
        "crack_depth_m": None if crack is None else crack.depth_m,
        "crack_distance_m": None if crack is None else crack.distance_m,
        "water_in_crack_m": None if has_pressures else design.water.crack_water_m,
        "fill": 0.0 if has_pressures else design.water.fill,
        "pressure_kpa": pressures[0],
        "crack_pressure_kpa": pressures[1],
        "water_unit_weight_kn_m3": design.water_unit_weight_kn_m3,
        "seismic": design.seismic.coefficient * design.section_share,
    }


def _strength_arguments(strengths: Sequence[Strength]) -> Arguments:
    return {
        "cohesion_kpa": strengths[0].cohesion_kpa,
        "friction_deg": strengths[0].friction_angle_deg,
    }


def closed_forms(arguments: Mapping[str, Any], bolts: Sequence[Sequence[float]]) -> ClosedForms:
    """Return the closed forms of designs by Hoek & Bray's plane failure; each argument is a number or an array (n,).

    Parameters
    ----------
    bolts : east, north and up of the passive ones
    """
    columns = dict(arguments)
    misfit, across, face = (columns.pop(name) for name in ("misfit", "across", "face_direction"))
    east, north, up = (columns.pop(f"force_{name}") for name in ("east", "north", "up"))
    direction = np.radians(face)
    columns["force_kn"] = (
        None if up is None else (east * np.sin(direction) + north * np.cos(direction), up)
    )
    bolt_forces = [
        (east * np.sin(direction) + north * np.cos(direction), up) for east, north, up in bolts
    ]
    failures = plane_failures(PlaneArrays(**columns, passive_kn=bolt_forces))
    count = max(failures.outcome.size, np.size(across))
    outcome, factor = (
        np.broadcast_to(failures.outcome, count).copy(),
        np.broadcast_to(failures.factor, count).copy(),
    )
    outcome[np.broadcast_to(across, count)], factor[np.broadcast_to(across, count)] = (
        _OUTCOMES.index("E213"),
        np.nan,
    )
    return ClosedForms(
        _OUTCOMES, outcome, factor, [failures.normal_kn], [failures.length_m]
    ).refused(misfit, MISFITS)


def _strikes_across(plane: Plane, face: Plane) -> Any:
    """Return whether a plane strikes too far from the face for plane failure (Hoek & Bray 1981, ch. 7)."""
    difference_deg = _strike_difference(plane.dip_direction_deg, face.dip_direction_deg)
    return (difference_deg > WIDEST_DEG) & (np.asarray(plane.dip_deg) > 0.0)


def bounds(design: PlaneDesign) -> Bounds:
    """Return the planes that bound the block, striking along the slope as in the section of `section_of`."""
    outward = upward(90.0, design.face.dip_direction_deg) * [1.0, 1.0, 0.0]
    dips = [
        np.atleast_1d(_signed_dip(plane, design.face))
        for plane in (design.joint, design.face, design.upper)
    ]
    joint, *free = (upward(dip, design.face.dip_direction_deg) for dip in dips)
    slide, face, upper = (np.tan(np.radians(dip)) for dip in dips)
    height = np.atleast_1d(design.height_m)
    crest = -height / face  # out of the slope; the ground behind it falls with `upper`
    normals, offsets = (
        [-joint, *free],
        [0.0, 0.0, (height + upper * crest) * np.cos(np.radians(dips[2]))],
    )
    crack = design.crack
    if crack is not None:
        with np.errstate(divide="ignore", invalid="ignore"):
            behind = (
                np.atleast_1d(0.0 if crack.distance_m is None else crack.distance_m)
                if crack.depth_m is None
                else (height + crest * slide - crack.depth_m) / (slide - upper)
            )
        normals.append(-outward)
        offsets.append(behind - crest)
    bounded = bounds_of(normals, offsets, np.zeros(3), (0,), (1, 2), height)
    return replace(bounded, along=cross(np.array([0.0, 0.0, 1.0]), outward))


def _sizes(design: PlaneDesign) -> Mapping[str, Floats]:
    """Return the sizes of the blocks of a design whose numbers may be arrays, per metre; empty with a crack depth."""
    crack = design.crack
    if crack is not None and (crack.distance_m is None or crack.depth_m is not None):
        return {}
    extents = _extents(design, None if crack is None else crack.distance_m)
    return {
        "volume_m3": extents.area_m2,
        "height_m": extents.height_m,
        "setback_m": extents.setback_m,
    }


def _extents(design: PlaneDesign, distance_m: Any) -> "PlaneSizes":
    """Return the sizes with a crack at a distance (m) behind the crest, or without a crack (None)."""
    from slopekit.closed_form.sizes import plane_sizes

    slide, upper = (_signed_dip(plane, design.face) for plane in (design.joint, design.upper))
    return plane_sizes(slide, design.face.dip_deg, upper, design.height_m, distance_m)


def crack_reach(design: PlaneDesign) -> Floats:
    """Return the distance (n,) m behind the crest at which the plane comes out; the design's numbers may be arrays."""
    return _extents(design, None).setback_m


ON_ARRAYS = OnArrays(
    arguments,
    _strength_arguments,
    closed_forms,
    bounds,
    _sizes,
    crack_reach,
    None,
    _full_water,
    lambda design: upward(90.0, design.face.dip_direction_deg),  # out of the face
)


def closed_form(design: PlaneDesign, block_cut: Cut | None = None) -> ClosedForm:
    """Return the closed form of a design by Hoek & Bray's plane failure, as PRE-IE is compared with it.

    Raises
    ------
    GeometryError
        Where the plane forms no block that can slide out; as `cut`, without loading the section.
    """
    if block_cut is None:
        section_of(design)
    return ON_ARRAYS.closed_form(design)


def _notices(design: PlaneDesign, *_: object) -> Iterator[Notice]:
    yield from design.ground_notices(
        0.0, design.height_m, design.crack.distance_m if design.crack else None
    )
    share = design.section_share
    if design.seismic.coefficient and abs(share) < 1.0 - 1e-6:
        message = (
            f"the seismic load acts off the section: {share * 100:.0f} % of it acts out of the slope, "
            "the rest is left out"
        )
        yield Notice("W323", message)
    along = _axes(design.face)[1]
    shares = [bolt.toward.vector() @ along for bolt in design.bolts]
    shares += [
        np.array(force.components_kn) @ along / np.linalg.norm(force.components_kn)
        for force in design.forces
        if any(force.components_kn)
    ]
    most = max((abs(float(share_along)) for share_along in shares), default=0.0)
    if most > 1e-6:
        message = f"bolts or forces act along the slope (up to {most * 100:.0f} % of one): that part is left out"
        yield Notice("W323", message)


def _slope(design: PlaneDesign, result: Result) -> list[Section]:
    geometry, name = result.geometry, design.joint_name
    entries = [
        f"{name} {design.joint}  {design.joint.in_words()}  {strength_in_words(design.strength)}  "
        f"{short(geometry.areas_m2[name])} m long",
        f"face {design.face}  {design.face.in_words()}",
        f"upper {design.upper}  {design.upper.in_words()}",
    ]
    assert isinstance(geometry, SectionGeometry)
    if geometry.crack_depth_m is not None and geometry.crack_distance_m is not None:
        distance = geometry.crack_distance_m
        place = (
            f"{distance:.4g} m behind the crest"
            if distance >= 0.0
            else f"{-distance:.4g} m in front of the crest"
        )
        entries.append(
            f"crack vertical, {geometry.crack_depth_m:.4g} m deep, {place}{design.crack_in_words}"
        )
    return slope_sections(
        result,
        Section("PLANES", entries),
        water_in_words(result, 2.0, "falling to nothing at the toe"),
    )


KIND = SingleBlock(
    PlaneDesign,
    read_plane,
    Words(
        "plane failure, per metre",
        "block",
        "out of the slope",
        "Hoek & Bray closed form (plane failure)",
        "Hoek & Bray: forces only",
        {"slides_on_J1": "slides on its plane", "lifted": "contact lost on its plane (uplift)"},
    ),
    cut,
    closed_form,
    _slope,
    _notices,
    ON_ARRAYS,
)
