"""The footing on a weak plane (Sheng et al. 2023, §3.3)."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from slopekit.closed_form.plane import OUTCOMES, PlaneArrays, plane_failures
from slopekit.core.errors import Fault, MisfitError
from slopekit.core.sheet import Section
from slopekit.design.common import Design
from slopekit.design.fields import Field, count, declare, group, number
from slopekit.design.parts import Action, Stiffness, Strength
from slopekit.design.reading.reader import Reader
from slopekit.design.sections import read_common, read_strengths
from slopekit.geometry.pressure import resultant
from slopekit.geometry.sections.section import J1, PlaneSection, footing_section, line_pairs
from slopekit.kinds.protocol import ClosedForm
from slopekit.kinds.single_block.closed_forms import DILATES, ClosedForms
from slopekit.kinds.single_block.one_block import SingleBlock
from slopekit.kinds.single_block.one_block_limit import Cut, Interface, bedding_on
from slopekit.kinds.single_block.secants import on_secants, other_strengths
from slopekit.kinds.solver_inputs import section_geometry
from slopekit.kinds.words import size_number, slope_sections, strength_in_words
from slopekit.loads import PointForce, block_loads
from slopekit.result import Result, Words

NAME = "weak plane"


@dataclass(frozen=True)
class Uplift:
    """Water on the weak plane: kPa at both ends, linear between, or a part of full pressure; less by drains."""

    ACTIONS: ClassVar[Mapping[str, Action]] = {"toe_kpa": "water", "heel_kpa": "water"}

    toe_kpa: float | None = number(
        "toe",
        "pressure",
        default=None,
        least=0.0,
        code="E118",
        label="uplift at the toe",
        left_out="0",
        axis="uplift at the toe",
        doc="where the plane daylights in the face",
    )
    heel_kpa: float | None = number(
        "heel",
        "pressure",
        default=None,
        least=0.0,
        code="E118",
        label="uplift at the heel",
        left_out="0",
        axis="uplift at the heel",
        doc="at the back end of the plane; linear between",
    )
    fill: float | None = number(
        "fill",
        "ratio",
        default=None,
        least=0.0,
        most=1.0,
        code="E118",
        label="uplift",
        left_out="by toe and heel",
        axis="part of full uplift",
        doc="part of full pressure, in their place: water up to the top, held by the face",
    )
    drain: float = number(
        "drain",
        "ratio",
        default=0.0,
        least=0.0,
        most=1.0,
        code="E118",
        label="what drains take off",
        example="50 %",
        axis="what drains take off",
        left_out="no drains",
        doc="part of the pressure that drains take off, everywhere",
    )


@dataclass(frozen=True, kw_only=True)
class FootingDesign(Design):
    """A footing above a weak plane that daylights in a vertical face (Sheng et al. 2023, §3.3), per metre.

    `load_at_m` is the distance of the load from the face, None for the middle of the top. A unit weight of 0 leaves
    the weight of the rock out, as the paper does.
    """

    EXTRA_KEYS: ClassVar[tuple[Field, ...]] = (
        declare(
            "weak_plane.strength", "text", left_out="the only one", doc="a name under strength"
        ),
    )
    REQUIRED: ClassVar[tuple[str, ...]] = ("strength",)
    OMITTED_IF_NONE: ClassVar[tuple[str, ...]] = ("uplift",)
    ACTIONS: ClassVar[Mapping[str, Action]] = {"load_kn": "force"}
    WITHOUT: ClassVar[tuple[str, ...]] = ("water", "loads", "support")
    HAS_CLOSED_FORM = True

    load_kn: float = number(
        "footing.load", "force", above=0.0, code="E123", example="1500 kN", doc="downward"
    )
    load_at_m: float | None = number(
        "footing.at",
        "length",
        default=None,
        least=0.0,
        code="E118",
        words=("middle",),
        example="middle",
        label="place of the load",
        value_attribute="at_m",
        left_out="middle",
        doc="from the face; `middle`: over the middle of the plane",
    )
    dip_deg: float = number(
        "weak_plane.dip",
        "angle",
        above=0.0,
        most=89.9,
        code="E101",
        example="45",
        label="dip of the weak plane",
    )
    length_m: float = number(
        "weak_plane.length", "length", above=0.0, code="E116", example="7.07 m"
    )
    pairs: int = count(
        "weak_plane.pairs",
        3,
        2001,
        default=9,
        is_odd=True,
        code="E137",
        advice="Simpson's rule takes two pairs an element and one more.",
    )
    strength: Strength
    uplift: Uplift | None = group("uplift", Uplift, default=None, left_out="dry", axis="uplift")

    @property
    def ends_kpa(self) -> tuple[float, float]:
        """The water pressure at the toe and at the heel of the plane, kPa."""
        water = self.uplift
        if water is None:
            return 0.0, 0.0
        deep = self.length_m * math.sin(math.radians(self.dip_deg))
        full = (water.toe_kpa or 0.0, water.heel_kpa or 0.0)
        if water.fill is not None:
            full = (water.fill * self.water_unit_weight_kn_m3 * deep, 0.0)
        undrained = 1.0 - water.drain
        return undrained * full[0], undrained * full[1]

    @property
    def is_wet(self) -> bool:
        """Whether water presses on the plane."""
        return any(self.ends_kpa)

    @property
    def uplift_kn(self) -> float:
        """The uplift of the water on the plane, kN per metre."""
        return 0.5 * sum(self.ends_kpa) * self.length_m

    @property
    def middle_m(self) -> float:
        """The distance of the middle of the plane from the face, m."""
        return self.length_m * math.cos(math.radians(self.dip_deg)) / 2.0

    @property
    def at_m(self) -> float:
        """The distance of the load from the face, m."""
        return self.middle_m if self.load_at_m is None else self.load_at_m

    def changes(self) -> Iterator[tuple[str, Self]]:
        """Yield designs with one input a little changed, by name."""
        yield "load +10 %", replace(self, load_kn=self.load_kn * 1.1)
        yield from other_strengths(self)
        if self.dip_deg < 88.0:
            yield "dip +1°", replace(self, dip_deg=self.dip_deg + 1.0)


def read_footing(reader: Reader) -> FootingDesign:
    """Read the design of a footing on a weak plane.

    Raises
    ------
    DesignError
        With every fault found; E137 for a number of node pairs that the rule does not take.
    """
    values = reader.fields(FootingDesign)
    user = (
        "weak_plane",
        reader.find("weak_plane.strength"),
        reader.find("weak_plane") or reader.root,
    )
    strength = read_strengths(reader, [user])[0]
    common = read_common(reader)
    if common["unit_weight_kn_m3"] is None:
        common["unit_weight_kn_m3"] = 0.0  # the paper leaves the weight out
    if not any(node.find("stiffness.shear") for _, node in reader.names("strength")):
        # a seam with a modulus: G is a third of E for ν = 0.5, as the paper has it
        normal = common["stiffness"].normal_kn_m3
        common["stiffness"] = Stiffness(normal, normal / 3.0)
    return reader.build(FootingDesign, values, common, strength=strength, uplift=_uplift(reader))


def _uplift(reader: Reader) -> Uplift | None:
    node = reader.find("uplift")
    if not node.items():
        return None
    values = reader.fields(Uplift, node)
    ends = [key for key in ("toe", "heel") if node.get(key)]
    if node.get("fill") and ends:
        message = f"uplift has fill and {' and '.join(ends)}: they exclude each other"
        reader.fault("E112", message, node.get(ends[0]), "Keep one of them.")
    elif not node.get("fill") and not ends:
        advice = "Write uplift: {toe: 20 kPa, heel: 5 kPa} or {fill: 100 %}."
        reader.fault("E118", "uplift says no pressure", node, advice)
    return None if values["drain"] is None else Uplift(**values)


def cut(design: FootingDesign) -> Cut:
    """Load the block above the weak plane. Raises GeometryError E219 where the load stands beside it."""
    section = _block(design)
    push = PointForce(
        np.array([0.0, 0.0, -design.load_kn]), np.array([-design.at_m, 0.0, section.bottom[2]])
    )
    plane, (toe, heel) = section.block.faces[J1], design.ends_kpa
    pressures = toe + (heel - toe) * plane[:, 0] / section.bottom[0]
    (thrust,), (point,) = resultant([(plane[None], pressures[None])], plane[None])
    x, _, z = section.bottom / section.length  # up along the plane, into the slope
    uplift = {f"water {J1}": PointForce(thrust * np.array([z, 0.0, -x]), point)} if thrust else {}
    acting = block_loads(
        section.block, design.rock.unit_weight_kn_m3, np.zeros(3), pushes={"footing": push} | uplift
    )
    bed = bedding_on(
        {J1: section.ends}, acting, section.block.centroid, [design.strength], in_section=True
    )
    left_out = [
        "bedrock (no unknowns)",
        "deformation of the footing and the rock",
        "the length of the footing (per metre)",
        *([] if design.rock.unit_weight_kn_m3 else ["the weight of the rock"]),
    ]
    return Cut(
        section.block,
        acting,
        lambda refine: bed.scene(line_pairs(section, (design.pairs - 1) // 2 * 2**refine)),
        [Interface(J1, NAME, design.strength)],
        lambda: section_geometry(section, NAME),
        left_out,
        {J1: NAME} if design.uplift_kn else {},
    )


def closed_form(design: FootingDesign, _: Cut | None = None) -> ClosedForm:
    """Return the closed form of a design: a plane failure below level ground behind a vertical face, under the load."""
    _block(design)

    names = tuple("slides_on_J1" if name == "slides" else name for name in OUTCOMES)

    def on_lines(lines: Sequence[Strength]) -> ClosedForms:
        failures = plane_failures(
            PlaneArrays(
                face_dip_deg=90.0,
                upper_dip_deg=0.0,
                plane_dip_deg=design.dip_deg,
                height_m=design.length_m * math.sin(math.radians(design.dip_deg)),
                cohesion_kpa=lines[0].cohesion_kpa,
                friction_deg=lines[0].friction_angle_deg,
                unit_weight_kn_m3=design.rock.unit_weight_kn_m3,
                pressure_kpa=design.uplift_kn / design.length_m,
                force_kn=(0.0, -design.load_kn),
            )
        )
        return ClosedForms(
            names, failures.outcome, failures.factor, [failures.normal_kn], [failures.length_m]
        )

    closed = on_secants([design.strength], on_lines, ClosedForms.tractions_kpa).form()
    return replace(closed, why_not=DILATES if design.strength.dilation_deg else "")


def _block(design: FootingDesign) -> PlaneSection:
    """Return the section of the block. Raises MisfitError where the load stands beside it."""
    section = footing_section(design.dip_deg, design.length_m)
    place, width = design.at_m, -float(section.bottom[0])
    if not 0.0 <= place <= width:
        raise MisfitError(
            [
                Fault(
                    "E219",
                    f"the load stands {place:.6g} m from the face, the block is {width:.6g} m wide",
                )
            ]
        )
    return section


def _slope(design: FootingDesign, result: Result) -> list[Section]:
    length = size_number(design.length_m)
    words = f"weak plane dips {design.dip_deg:.6g}°, {length} m long  {strength_in_words(design.strength)}"
    eccentricity = design.at_m - design.middle_m
    place = (
        "over the middle of the plane"
        if not eccentricity
        else f"{abs(eccentricity):.4g} m off the middle of the plane"
    )
    toe, heel = design.ends_kpa
    wet = (
        [f"uplift {toe:.4g} kPa at the toe, {heel:.4g} kPa at the heel"] if design.uplift_kn else []
    )
    acting = [f"footing {size_number(design.load_kn)} kN, {place}", *wet]
    return slope_sections(result, Section("PLANES", [words]), acting)


KIND = SingleBlock(
    FootingDesign,
    read_footing,
    Words(
        "footing above a weak plane, per metre",
        "block",
        "out of the face",
        "closed form",
        "limit equilibrium",
        {
            "slides_on_J1": "slides on the weak plane",
            "lifted": "contact lost on the weak plane (uplift)",
        },
        horizontal="x",
    ),
    cut,
    closed_form,
    _slope,
)
