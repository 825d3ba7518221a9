"""What designs of every kind share, in m, kN, kPa, kN/m³ and degrees."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self, TypeAlias

from slopekit.core.codec import digest
from slopekit.core.orientation import Plane
from slopekit.core.orientation import number as shown
from slopekit.design.fields import Field, declare, group, number, part, parts_of, text
from slopekit.design.parts import (
    CASE_KEYS,
    Action,
    Bolt,
    Force,
    MeshFile,
    PartialFactors,
    Project,
    Rule,
    Seismic,
    Stiffness,
    Strength,
    Water,
    bolts_without,
    forces_without,
    listed,
)
from slopekit.design.reading.structure import Spec

if TYPE_CHECKING:
    from slopekit.design.reading.nodes import Document
    from slopekit.design.scatter.distributions import Variable

Criterion = Literal["limit", "all-pairs"]
#: When a design under work is analysed: when a slider is let go, at a button.
Answered = Literal["release", "button"]
#: Two coordinates of what scatters, by `Variable.coordinates`, and their rank correlation.
Pair: TypeAlias = tuple[str, str, float]


_RANGE = "out of range ({least} to {most})"


def _slips_of_unit_weight(
    value: float, name: str, written: str, called: Callable[[str], str]
) -> tuple[str, str, str] | None:
    """E110 with the likely slip of units."""
    message = f"{name} is {shown(value)} kN/m³, out of range (5 to 400)"
    if 500.0 <= value <= 10000.0:
        return "E110", message, f"{shown(value)} looks like a density: write {called('rock.density')} {shown(value)}."
    if 10000.0 < value <= 50000.0:
        return "E110", message, f"{shown(value)} looks like N/m³: write '{shown(value)} N/m3'."
    if 0.5 <= value < 5.0:
        return "E110", message, f"{shown(value)} looks like t/m³: write {called('rock.density')} '{shown(value)} t/m3'."
    return None


def _slips_of_density(
    value: float, name: str, written: str, called: Callable[[str], str]
) -> tuple[str, str, str] | None:
    """E111 with the likely slip of units."""
    message = f"{name} is {shown(value)} kg/m³, out of range (500 to 10000)"
    if 0.5 <= value <= 10.0:
        return "E111", message, f"{shown(value)} looks like t/m³: write '{shown(value)} t/m3'."
    if 10.0 < value <= 60.0:
        other = called("rock.unit_weight")
        return "E111", message, f"{shown(value)} looks like a unit weight: write {other} {shown(value)}."
    return None


#: Attributes that are no inputs of a single run.
_NO_INPUTS = ("crack_searched", "reading", "variables", "correlation", "source", "cases", "project")


#: Rock under elastic blocks does not give: the one word that its key takes.
BEDROCK = declare(
    "analysis.elastic.bedrock", "text", words=("rigid",), code="E288", left_out="rigid", example="rigid",
    doc="rock under elastic blocks does not give",
)  # fmt: skip


class DesignKeys:
    """What a kind says of the keys of its designs beside those that are its fields."""

    __slots__ = ()
    #: Whether water may be said as a part of full.
    FILLS: ClassVar[bool] = False
    #: Beside the attributes: keys that are read into several, top keys that must be there, and those that are not;
    #: what a design takes where they are left out, which the sheet says.
    ALSO: ClassVar[tuple[Field, ...]] = (
        declare("slopekit", "text", is_required=True, example="1", doc="version of the language"),
        declare("kind", "text", is_required=True, example="wedge", doc="what the design is"),
        declare(
            "strength",
            "group",
            of=Strength,
            many="names",
            at_least=1,
            example="{joint: {c: 50 kPa, phi: 20}}",
            left_out="required (a wedge: the paper's)",
        ),
        declare(
            "correlation",
            "ratio",
            -1.0,
            1.0,
            many="pairs",
            scatters=False,
            role="scatter",
            example="{J1.phi/J2.phi: 0.8}",
        ),
        BEDROCK,
        declare("cases", "group", of=CASE_KEYS, many="names", at_least=1, left_out="the design alone",
              example="{quake: {set: {loads.seismic.k: 0.1}}}", doc="[load cases](cases.md) by name"),
    )  # fmt: skip
    REQUIRED: ClassVar[tuple[str, ...]] = ("strength", "rock")
    WITHOUT: ClassVar[tuple[str, ...]] = ()
    DEFAULTS: ClassVar[Mapping[str, Any]] = {}
    #: How keys begin whose defaults stand for numbers of the slope.
    PAPER_KEYS: ClassVar[tuple[str, ...]] = ()
    #: The slope falls toward -x where nothing of a result says the way.
    FALLS_WEST: ClassVar[bool] = False
    #: Whether its closed form is asked alone, in next to no time.
    HAS_CLOSED_FORM: ClassVar[bool] = False
    #: When it is analysed under work, where it has none.
    ANSWERED: ClassVar[Answered] = "release"
    ACTIONS: ClassVar[Mapping[str, Action]] = {"water_unit_weight_kn_m3": "water"}
    #: Along what places of a water table are counted, and where a plane has its elevation, in words.
    ALONG: ClassVar[str] = ""
    PLANE_AT: ClassVar[str] = "at the origin"
    #: Attributes that hold what stands at a key of another path.
    INTO: ClassVar[Mapping[str, str]] = {}
    #: Attributes that inputs and their hash leave out where they are None: younger than the hashes that users keep.
    #: Those of bases count too, and other records have theirs.
    UNSAID: ClassVar[tuple[str, ...]] = ()


@dataclass(frozen=True, kw_only=True)
class Rock:
    """The rock: its weight, and for elastic blocks its stiffness."""

    ACTIONS: ClassVar[Mapping[str, Action]] = {"unit_weight_kn_m3": "weight", "density_kg_m3": "weight"}
    UNSAID: ClassVar[tuple[str, ...]] = ("modulus_kpa", "poisson")

    unit_weight_kn_m3: float = number(
        "rock.unit_weight", "unit weight", default=None, least=5.0, most=400.0, code="E110", label="unit weight",
        axis="unit weight of the rock", says=_RANGE, advice="Rock weighs 20 to 30 kN/m³.", check=_slips_of_unit_weight,
        left_out="by the density", doc="or density (E112)",
    )  # fmt: skip
    density_kg_m3: float | None = number(
        "rock.density", "density", default=None, least=500.0, most=10000.0, code="E111", example="2600 kg/m3",
        says=_RANGE, advice="Rock has 2000 to 3000 kg/m³.", check=_slips_of_density,
        left_out="required (a footing: no weight; blocks: each its own)", doc="or unit_weight (E112)",
    )  # fmt: skip
    gravity_m_s2: float = number(
        "rock.gravity", "acceleration", default=9.81, least=1.0, most=25.0, code="E127", says=_RANGE, axis="gravity",
        advice="9.81 m/s² is Earth's.",
    )  # fmt: skip
    modulus_kpa: float | None = number(
        "rock.modulus", "pressure", default=None, least=1e3, most=1e9, code="E284", example="20 GPa", role="setting",
        scatters=False, label="modulus", says="it lies between 1 MPa and 1000 GPa", left_out="20 GPa with --elastic",
        advice="Rock has 1 to 100 GPa: write '20 GPa'. A bare number is kPa.", doc="Young's modulus, for --elastic",
    )  # fmt: skip
    poisson: float | None = number(
        "rock.poisson", "ratio", default=None, least=0.0, most=0.49, code="E284", example="0.25", role="setting",
        scatters=False, label="Poisson's ratio", left_out="0.25 with --elastic", advice="Rock has 0.15 to 0.35.",
        doc="Poisson's ratio, for --elastic",
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Analysis:
    """How a design is analysed.

    Attributes
    ----------
    factors : strength reduction factors at which the displacements and failed pairs are wanted (the paper's Table 3)
    """

    UNSAID: ClassVar[tuple[str, ...]] = ("partial", "elastic_edge_m")

    criterion: Criterion = text(
        "analysis.criterion",
        default="limit",
        code="E126",
        words=("limit", "all-pairs"),
        left_out="limit",
        example="limit",
    )
    agree_within: float = number("analysis.agree_within", "ratio", default=0.01, above=0.0, below=1.0, code="E127",
                                 scatters=False, role="setting",
                                 doc="largest relative difference of the methods")  # fmt: skip
    factors: tuple[float, ...] = number(
        "analysis.factors", "ratio", default=(), above=0.0, code="E127", many="list", scatters=False, role="setting",
        example="[1.0, 1.1, 1.2]", label="factor",
        doc="reduction factors, at most 200: displacements and failed pairs at each",
    )  # fmt: skip
    elastic_edge_m: float | None = number(
        "analysis.elastic.edge", "length", default=None, above=0.0, code="E284", words=("auto",), example="auto",
        role="setting", scatters=False, label="edge", left_out="auto", advice="The longest edge of a finite element.",
        doc="longest edge of an element at contacts, for --elastic; `auto`: an eighth of the longest of the block",
    )  # fmt: skip
    partial: PartialFactors | None = group(
        "analysis.partial_factors", PartialFactors, default=None, forms=(Spec("value", example="DA1-C2"),),
        left_out="none",
        doc="[partial factors](cases.md#partial-factors): `DA1-C1`, `DA1-C2`, `DA2`, `DA3`, a file, or its keys",
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Reading:
    """What was found while a design was read.

    Attributes
    ----------
    defaults : names of the inputs that were left out
    left_out : what of the files that the design names is not used, in words
    read_as : what of them was read in another way than it stands there, in words
    """

    defaults: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()
    read_as: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Design(DesignKeys):
    """A complete and checked design: what every kind has.

    Attributes
    ----------
    variables : what scatters: numbers and orientations that were given as distributions
    correlation : pairs of them with their rank correlation
    source : the document it was read from, which studies read again with other values; None where it was not
    cases : its load cases, each a design of its own
    """

    title: str = text("title", default="", doc="text")
    project: Project = group("project", Project, default=Project(), left_out="nothing", doc="on pages only")
    rock: Rock = part(Rock)
    water_unit_weight_kn_m3: float = number(
        "water.unit_weight", "unit weight", default=9.81, least=5.0, most=15.0, code="E110", says=_RANGE,
        advice="Water weighs 9.81 kN/m³ (62.4 pcf).", label="unit weight of water",
    )  # fmt: skip
    water: Water = group("water", Water, default=Water(), forms=(Spec("value", example="dry"),), left_out="dry",
                         doc="`dry`, `full`, `50 %`, or by its keys")  # fmt: skip
    seismic: Seismic = number(
        "loads.seismic", "ratio", default=Seismic(), least=0.0, most=2.0, code="E122", of=Seismic, example="0.1",
        label="seismic coefficient", left_out="0", doc="fraction of g: `0.1`, `0.1@180`, or by its keys",
    )  # fmt: skip
    forces: tuple[Force, ...] = forces_without("block")
    bolts: tuple[Bolt, ...] = bolts_without("block")
    stiffness: Stiffness = Stiffness()
    rules: tuple[Rule, ...] = text(
        "acceptance.rules", default=(), example='["fos >= 1.5"]',
        doc="one or a list; `>=`, `>`, `<=`, `<` on `fos`, `fos.limit`, `fos.lowest`, `fos.closed_form`, "
        "`fos.static_bound`, `fos.all_pairs_failed`, `fos.residual`, on surfaces "
        "`fos.fellenius`, `fos.janbu`, `fos.bishop`",
        forms=(Spec("value", items=Spec("value", example='"fos >= 1.5"')),),
    )  # fmt: skip
    analysis: Analysis = part(Analysis)
    reading: Reading = field(default=Reading(), compare=False)
    variables: "tuple[Variable, ...]" = field(default=(), compare=False)
    correlation: tuple[Pair, ...] = field(default=(), compare=False)
    source: "Document | None" = field(default=None, compare=False, repr=False)
    cases: "tuple[LoadCase, ...]" = field(default=(), compare=False, repr=False)

    @property
    def assumed(self) -> tuple[tuple[str, str], ...]:
        """Inputs that were given as distributions, with the value that a deterministic run takes."""
        return tuple(pair for variable in self.variables for pair in variable.assumed())

    @property
    def is_wet(self) -> bool:
        """Whether there is water."""
        return self.water.is_wet

    @property
    def section_share(self) -> float | None:
        """The part of an earthquake that acts in the section of the design; None where it knows all of it."""
        return None

    @property
    def wet_interfaces(self) -> tuple[str, ...]:
        """The interfaces that may have a water pressure of their own, by the names of the file."""
        return ()

    @property
    def kind(self) -> str:
        """The kind as design files write it."""
        return type(self).__name__.removesuffix("Design").lower()

    def _single(self) -> "Design":
        """The design without what only studies use."""
        return replace(self, source=None, variables=(), correlation=(), cases=())

    @property
    def invented(self) -> tuple[str, ...]:
        """Numbers of the slope that were left out and taken from elsewhere, by name."""
        return tuple(name for name in self.reading.defaults if name in self.DEFAULTS)

    @property
    def accepted_fos(self) -> float | None:
        """The factor of safety that acceptance asks for; None where it asks for none."""
        return max((rule.value for rule in self.rules if rule.is_on_factor and rule.is_least), default=None)

    def place_of(self, above: str, key: str, number: int, count: int) -> str:
        """Where the item of that number (from 1) of a list of `count` was written: its line; empty where none knows."""
        if self.source is None:
            return ""
        listed = self.source.root.at(f"{above}.{key}")
        items = listed.elements
        return str((items[number - 1] if len(items) == count else listed).place)

    def in_own_names(self, sentence: str) -> str:
        """A sentence on what happens, joints by the names that the user gave them."""
        return sentence

    def changes(self) -> Iterator[tuple[str, Self]]:
        """Designs with one input a little changed, by name: SENSITIVITY says what they do to the closed form."""
        return iter(())

    def at_residual(self) -> Self:
        """The design with residual strength wherever there is one."""
        return self.each_strength(Strength.at_residual)

    @property
    def joint_strengths(self) -> Sequence[Strength]:
        """The strengths of its joints, in their order."""
        return tuple(_strengths(tuple(getattr(self, part.name) for part in fields(self))))

    def each_strength(self, change: Callable[[Strength], Strength]) -> Self:
        """The design with every strength changed."""
        return replace(self, **{part.name: _changed(getattr(self, part.name), change) for part in fields(self)})

    def beside(self) -> dict[str, Any]:
        """What JSON has beside the inputs: whose design it is, its partial factors; nothing without them."""
        project = self.project.given()
        entries: dict[str, Any] = {"project": project} if project else {}
        return (
            entries if self.analysis.partial is None else entries | {"partial_factors": self.analysis.partial.to_dict()}
        )

    def plain(self, exact: bool = False) -> dict[str, Any]:
        """The attributes as JSON values; planes as they are written unless every digit counts (`exact`)."""
        record: dict[str, Any] = _plain(self._single(), exact)
        water = record["water"]
        return record | {name: water.pop(name) for name in Water.UNSAID if name in water}

    def ground_in_words(self) -> list[str]:
        """Table, pond and surcharge as the sheet prints them."""
        load = getattr(self, "surcharge_kpa", None)
        said = [f"surcharge {shown(load)} kPa on the plan of the upper slope"] if load else []
        return [*self.water.table_in_words(self.ALONG, self.PLANE_AT), *said]

    def inputs(self) -> dict[str, Any]:
        """Every input as plain JSON values, the defaults written out; of what scatters the value that a run takes."""
        return {key: value for key, value in self.plain().items() if key not in (*_NO_INPUTS, "partial")}

    def input_hash(self) -> str:
        """SHA-256 of the kind and the inputs: equal designs give equal hashes.

        It is the hash of a single run: a design whose φ is a distribution of mean 20 has the hash of the one whose φ is
        20. What a study draws depends on `variables` and `correlation` too.
        """
        exact = self.plain(exact=True) | {"kind": self.kind}
        exact = {key: value for key, value in exact.items() if key not in _NO_INPUTS}
        exact |= dict.fromkeys(("defaults", "assumed", "left_out", "title"))
        return digest(exact)


@dataclass(frozen=True)
class LoadCase:
    """A load case: its name, what it sets (paths and what was written), the design with that, without cases."""

    name: str
    sets: tuple[tuple[str, str], ...]
    design: Design

    @property
    def in_words(self) -> str:
        """What it sets, for a table."""
        return ", ".join(f"{path} {value}" for path, value in self.sets)


def _changed(value: Any, change: Callable[[Strength], Strength]) -> Any:
    if isinstance(value, Strength):
        return change(value)
    return tuple(_changed(item, change) for item in value) if type(value) is tuple else value


def _strengths(value: Any) -> Iterator[Strength]:
    if isinstance(value, Strength):
        yield value
    elif type(value) is tuple:
        for item in value:
            yield from _strengths(item)


def _is_nothing(given: Any) -> bool:
    """Whether a value is None, or a tuple of nothing else."""
    return all(one is None for one in given) if isinstance(given, tuple) else given is None


def _plain(value: Any, exact: bool = False) -> Any:
    """Dataclasses and tuples as JSON values, planes in the way they are written unless every digit counts."""
    if isinstance(value, MeshFile):
        known = {"sha256": value.sha256} | ({"up": value.up} if value.up == "y" else {})
        return known if exact else {"file": value.name} | known
    if isinstance(value, Plane) and not exact:
        return str(value)
    if is_dataclass(value):
        unsaid = {name for own in listed(type(value), "UNSAID") for name in own}
        given = ((part.name, getattr(value, part.name)) for part in fields(value) if part.repr)
        record = {name: _plain(own, exact) for name, own in given if not (name in unsaid and _is_nothing(own))}
        for name in parts_of(type(value)):
            record |= record.pop(name)
        if hasattr(value, "resistance"):  # a law is written with its name, waves beside it
            inner = record.pop("law", {"law": getattr(value, "name", "")})
            record = inner | record
        return record
    return [_plain(item, exact) for item in value] if isinstance(value, tuple) else value
