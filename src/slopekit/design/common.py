"""The base of the designs of every kind, and its records of rock and analysis; in m, kN, kPa, kN/m³ and degrees."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self, TypeAlias

from slopekit.core.codec import digest
from slopekit.core.orientation import Plane
from slopekit.core.orientation import number as number_text
from slopekit.design.fields import (
    Field,
    declare,
    group,
    nested_record,
    nested_records,
    number,
    text,
)
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
#: When the app analyses a changed design: on release of a slider, or at a button.
Answered = Literal["release", "button"]
#: Two coordinates of random variables (`Variable.coordinates`) and their rank correlation.
Pair: TypeAlias = tuple[str, str, float]


_RANGE = "out of range ({least} to {most})"


def _unit_weight_fault(
    value: float, name: str, written: str, written_key: Callable[[str], str]
) -> tuple[str, str, str] | None:
    """Return fault E110 for a unit weight that is probably a number in another unit; None if no other unit fits."""
    message = f"{name} is {number_text(value)} kN/m³, out of range (5 to 400)"
    if 500.0 <= value <= 10000.0:
        return (
            "E110",
            message,
            f"{number_text(value)} looks like a density: write {written_key('rock.density')} {number_text(value)}.",
        )
    if 10000.0 < value <= 50000.0:
        return (
            "E110",
            message,
            f"{number_text(value)} looks like N/m³: write '{number_text(value)} N/m3'.",
        )
    if 0.5 <= value < 5.0:
        return (
            "E110",
            message,
            f"{number_text(value)} looks like t/m³: write {written_key('rock.density')} '{number_text(value)} t/m3'.",
        )
    return None


def _density_fault(
    value: float, name: str, written: str, written_key: Callable[[str], str]
) -> tuple[str, str, str] | None:
    """Return fault E111 for a density that is probably a number in another unit; None if no other unit fits."""
    message = f"{name} is {number_text(value)} kg/m³, out of range (500 to 10000)"
    if 0.5 <= value <= 10.0:
        return (
            "E111",
            message,
            f"{number_text(value)} looks like t/m³: write '{number_text(value)} t/m3'.",
        )
    if 10.0 < value <= 60.0:
        unit_weight_key = written_key("rock.unit_weight")
        return (
            "E111",
            message,
            f"{number_text(value)} looks like a unit weight: write {unit_weight_key} {number_text(value)}.",
        )
    return None


#: Attributes that are no inputs of a single run.
_NO_INPUTS = ("crack_searched", "reading", "variables", "correlation", "source", "cases", "project")


#: The rock under elastic blocks is rigid: the only word that its key allows.
BEDROCK = declare(
    "analysis.elastic.bedrock",
    "text",
    words=("rigid",),
    code="E288",
    left_out="rigid",
    example="rigid",
    doc="rock under elastic blocks does not give",
)


class DesignKeys:
    """Class variables of a design: its keys that are no fields, defaults, and properties of its kind."""

    __slots__ = ()
    #: Whether water may be given as a fraction of full pressure.
    ALLOWS_FILL: ClassVar[bool] = False
    #: Keys besides those of attributes (`EXTRA_KEYS`), required top-level keys, inherited keys not allowed here, and
    #: defaults of missing keys, which the sheet lists.
    EXTRA_KEYS: ClassVar[tuple[Field, ...]] = (
        declare("slopekit", "text", is_required=True, example="1", doc="version of the language"),
        declare("kind", "text", is_required=True, example="wedge", doc="what the design is"),
        declare(
            "strength",
            "group",
            record_type=Strength,
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
        declare(
            "cases",
            "group",
            record_type=CASE_KEYS,
            many="names",
            at_least=1,
            left_out="the design alone",
            example="{quake: {set: {loads.seismic.k: 0.1}}}",
            doc="[load cases](cases.md) by name",
        ),
    )
    REQUIRED: ClassVar[tuple[str, ...]] = ("strength", "rock")
    WITHOUT: ClassVar[tuple[str, ...]] = ()
    DEFAULTS: ClassVar[Mapping[str, Any]] = {}
    #: Beginnings of the keys whose defaults replace numbers of the slope.
    PAPER_KEYS: ClassVar[tuple[str, ...]] = ()
    #: Whether the slope falls toward -x where the result has no direction.
    FALLS_WEST: ClassVar[bool] = False
    #: Whether the kind has a closed form that can be computed by itself, almost instantly.
    HAS_CLOSED_FORM: ClassVar[bool] = False
    #: When the app analyses a changed design without a closed form.
    ANSWERED: ClassVar[Answered] = "release"
    ACTIONS: ClassVar[Mapping[str, Action]] = {"water_unit_weight_kn_m3": "water"}
    #: In words: the axis along which points of a water table are given, and where a plane's elevation applies.
    ALONG: ClassVar[str] = ""
    PLANE_AT: ClassVar[str] = "at the origin"
    #: Attributes that hold the value of a key with another path.
    ATTRIBUTE_OF_KEY: ClassVar[Mapping[str, str]] = {}
    #: Attributes that inputs and their hash omit where they are None, so that hashes kept from older versions hold.
    #: Those of base classes are added; other records have their own.
    OMITTED_IF_NONE: ClassVar[tuple[str, ...]] = ()


@dataclass(frozen=True, kw_only=True)
class Rock:
    """The rock: its weight and, for elastic blocks, its stiffness."""

    ACTIONS: ClassVar[Mapping[str, Action]] = {
        "unit_weight_kn_m3": "weight",
        "density_kg_m3": "weight",
    }
    OMITTED_IF_NONE: ClassVar[tuple[str, ...]] = ("modulus_kpa", "poisson")

    unit_weight_kn_m3: float = number(
        "rock.unit_weight",
        "unit weight",
        default=None,
        least=5.0,
        most=400.0,
        code="E110",
        label="unit weight",
        axis="unit weight of the rock",
        says=_RANGE,
        advice="Rock weighs 20 to 30 kN/m³.",
        check=_unit_weight_fault,
        left_out="by the density",
        doc="or density (E112)",
    )
    density_kg_m3: float | None = number(
        "rock.density",
        "density",
        default=None,
        least=500.0,
        most=10000.0,
        code="E111",
        example="2600 kg/m3",
        says=_RANGE,
        advice="Rock has 2000 to 3000 kg/m³.",
        check=_density_fault,
        left_out="required (a footing: no weight; blocks: each its own)",
        doc="or unit_weight (E112)",
    )
    gravity_m_s2: float = number(
        "rock.gravity",
        "acceleration",
        default=9.81,
        least=1.0,
        most=25.0,
        code="E127",
        says=_RANGE,
        axis="gravity",
        advice="9.81 m/s² is Earth's.",
    )
    modulus_kpa: float | None = number(
        "rock.modulus",
        "pressure",
        default=None,
        least=1e3,
        most=1e9,
        code="E284",
        example="20 GPa",
        role="setting",
        scatters=False,
        label="modulus",
        says="it lies between 1 MPa and 1000 GPa",
        left_out="20 GPa with --elastic",
        advice="Rock has 1 to 100 GPa: write '20 GPa'. A bare number is kPa.",
        doc="Young's modulus, for --elastic",
    )
    poisson: float | None = number(
        "rock.poisson",
        "ratio",
        default=None,
        least=0.0,
        most=0.49,
        code="E284",
        example="0.25",
        role="setting",
        scatters=False,
        label="Poisson's ratio",
        left_out="0.25 with --elastic",
        advice="Rock has 0.15 to 0.35.",
        doc="Poisson's ratio, for --elastic",
    )


@dataclass(frozen=True, kw_only=True)
class Analysis:
    """The settings of the analysis of a design.

    Attributes
    ----------
    factors : strength reduction factors at which displacements and failed pairs are reported (the paper's Table 3)
    """

    OMITTED_IF_NONE: ClassVar[tuple[str, ...]] = ("partial", "elastic_edge_m")

    criterion: Criterion = text(
        "analysis.criterion",
        default="limit",
        code="E126",
        words=("limit", "all-pairs"),
        left_out="limit",
        example="limit",
    )
    agree_within: float = number(
        "analysis.agree_within",
        "ratio",
        default=0.01,
        above=0.0,
        below=1.0,
        code="E127",
        scatters=False,
        role="setting",
        doc="largest relative difference of the methods",
    )
    factors: tuple[float, ...] = number(
        "analysis.factors",
        "ratio",
        default=(),
        above=0.0,
        code="E127",
        many="list",
        scatters=False,
        role="setting",
        example="[1.0, 1.1, 1.2]",
        label="factor",
        doc="reduction factors, at most 200: displacements and failed pairs at each",
    )
    elastic_edge_m: float | None = number(
        "analysis.elastic.edge",
        "length",
        default=None,
        above=0.0,
        code="E284",
        words=("auto",),
        example="auto",
        role="setting",
        scatters=False,
        label="edge",
        left_out="auto",
        advice="The longest edge of a finite element.",
        doc="longest edge of an element at contacts, for --elastic; `auto`: an eighth of the longest of the block",
    )
    partial: PartialFactors | None = group(
        "analysis.partial_factors",
        PartialFactors,
        default=None,
        forms=(Spec("value", example="DA1-C2"),),
        left_out="none",
        doc="[partial factors](cases.md#partial-factors): `DA1-C1`, `DA1-C2`, `DA2`, `DA3`, a file, or its keys",
    )


@dataclass(frozen=True, kw_only=True)
class Reading:
    """Notes made while a design was read.

    Attributes
    ----------
    defaults : names of the inputs that took their defaults
    left_out : unused contents of the files that the design names, in words
    read_as : contents of these files that were interpreted in another way than they are written, in words
    """

    defaults: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()
    read_as: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Design(DesignKeys):
    """A complete and checked design: the attributes that every kind has.

    Attributes
    ----------
    variables : the random variables: numbers and orientations given as distributions
    correlation : pairs of their coordinates with the rank correlation
    source : the document that the design was read from, which studies read again with other values; None without one
    cases : the load cases, each with a design of its own
    """

    title: str = text("title", default="", doc="text")
    project: Project = group(
        "project", Project, default=Project(), left_out="nothing", doc="on pages only"
    )
    rock: Rock = nested_record(Rock)
    water_unit_weight_kn_m3: float = number(
        "water.unit_weight",
        "unit weight",
        default=9.81,
        least=5.0,
        most=15.0,
        code="E110",
        says=_RANGE,
        advice="Water weighs 9.81 kN/m³ (62.4 pcf).",
        label="unit weight of water",
    )
    water: Water = group(
        "water",
        Water,
        default=Water(),
        forms=(Spec("value", example="dry"),),
        left_out="dry",
        doc="`dry`, `full`, `50 %`, or by its keys",
    )
    seismic: Seismic = number(
        "loads.seismic",
        "ratio",
        default=Seismic(),
        least=0.0,
        most=2.0,
        code="E122",
        record_type=Seismic,
        example="0.1",
        label="seismic coefficient",
        left_out="0",
        doc="fraction of g: `0.1`, `0.1@180`, or by its keys",
    )
    forces: tuple[Force, ...] = forces_without("block")
    bolts: tuple[Bolt, ...] = bolts_without("block")
    stiffness: Stiffness = Stiffness()
    rules: tuple[Rule, ...] = text(
        "acceptance.rules",
        default=(),
        example='["fos >= 1.5"]',
        doc="one or a list; `>=`, `>`, `<=`, `<` on `fos`, `fos.limit`, `fos.lowest`, `fos.closed_form`, "
        "`fos.static_bound`, `fos.all_pairs_failed`, `fos.residual`, on surfaces "
        "`fos.fellenius`, `fos.janbu`, `fos.bishop`",
        forms=(Spec("value", items=Spec("value", example='"fos >= 1.5"')),),
    )
    analysis: Analysis = nested_record(Analysis)
    reading: Reading = field(default=Reading(), compare=False)
    variables: "tuple[Variable, ...]" = field(default=(), compare=False)
    correlation: tuple[Pair, ...] = field(default=(), compare=False)
    source: "Document | None" = field(default=None, compare=False, repr=False)
    cases: "tuple[LoadCase, ...]" = field(default=(), compare=False, repr=False)

    @property
    def assumed(self) -> tuple[tuple[str, str], ...]:
        """Names of the inputs given as distributions, each with the value of a deterministic run."""
        return tuple(pair for variable in self.variables for pair in variable.assumed())

    @property
    def is_wet(self) -> bool:
        """Whether there is water."""
        return self.water.is_wet

    @property
    def section_share(self) -> float | None:
        """The fraction of the seismic load that acts in the plane of a section; None for designs in space."""
        return None

    @property
    def wet_interfaces(self) -> tuple[str, ...]:
        """The names (as in the file) of the interfaces that may have a water pressure of their own."""
        return ()

    @property
    def kind(self) -> str:
        """The name of the kind in design files."""
        return type(self).__name__.removesuffix("Design").lower()

    def _single(self) -> "Design":
        """Return the design without the attributes that only studies use."""
        return replace(self, source=None, variables=(), correlation=(), cases=())

    @property
    def example_inputs(self) -> tuple[str, ...]:
        """Names of the numbers of the slope that were missing and took the kind's example values."""
        return tuple(name for name in self.reading.defaults if name in self.DEFAULTS)

    @property
    def accepted_fos(self) -> float | None:
        """The factor of safety that the acceptance rules require; None where they require none."""
        return max(
            (rule.value for rule in self.rules if rule.is_on_factor and rule.is_least), default=None
        )

    def place_of(self, above: str, key: str, number: int, count: int) -> str:
        """Return the place of entry `number` (from 1) of a list of `count` in the file; empty where it is unknown."""
        if self.source is None:
            return ""
        listed = self.source.root.find(f"{above}.{key}")
        items = listed.elements
        return str((items[number - 1] if len(items) == count else listed).place)

    def in_own_names(self, sentence: str) -> str:
        """Return a sentence of a result with the user's names of the joints."""
        return sentence

    def changes(self) -> Iterator[tuple[str, Self]]:
        """Yield designs with one input changed a little, by its name; SENSITIVITY reports their closed forms."""
        return iter(())

    def at_residual(self) -> Self:
        """Return the design with residual strengths wherever they are defined."""
        return self.each_strength(Strength.at_residual)

    @property
    def joint_strengths(self) -> Sequence[Strength]:
        """The strengths of the joints, in order."""
        return tuple(_strengths(tuple(getattr(self, attribute.name) for attribute in fields(self))))

    def each_strength(self, change: Callable[[Strength], Strength]) -> Self:
        """Return the design with `change` applied to every strength."""
        return replace(
            self,
            **{
                attribute.name: _changed(getattr(self, attribute.name), change)
                for attribute in fields(self)
            },
        )

    def extra_json(self) -> dict[str, Any]:
        """Return the JSON entries besides the inputs: project and partial factors, where the design has them."""
        project = self.project.filled_keys()
        entries: dict[str, Any] = {"project": project} if project else {}
        return (
            entries
            if self.analysis.partial is None
            else entries | {"partial_factors": self.analysis.partial.to_dict()}
        )

    def plain(self, exact: bool = False) -> dict[str, Any]:
        """Return the attributes as JSON values; planes as texts, or with all digits if `exact`."""
        record: dict[str, Any] = _plain(self._single(), exact)
        water = record["water"]
        return record | {name: water.pop(name) for name in Water.OMITTED_IF_NONE if name in water}

    def ground_in_words(self) -> list[str]:
        """Return the lines of the sheet about the water table, the pond and the surcharge."""
        load = getattr(self, "surcharge_kpa", None)
        sentences = (
            [f"surcharge {number_text(load)} kPa on the plan of the upper slope"] if load else []
        )
        return [*self.water.table_in_words(self.ALONG, self.PLANE_AT), *sentences]

    def inputs(self) -> dict[str, Any]:
        """Return every input as JSON values, with defaults; of distributions the value of a deterministic run."""
        return {
            key: value for key, value in self.plain().items() if key not in (*_NO_INPUTS, "partial")
        }

    def input_hash(self) -> str:
        """Return the SHA-256 of the kind and the inputs; equal designs give equal hashes.

        It is the hash of a deterministic run: a design whose φ has a distribution of mean 20 has the hash of a design
        whose φ is 20, although the samples of a study also depend on `variables` and `correlation`.
        """
        exact = self.plain(exact=True) | {"kind": self.kind}
        exact = {key: value for key, value in exact.items() if key not in _NO_INPUTS}
        exact |= dict.fromkeys(("defaults", "assumed", "left_out", "title"))
        return digest(exact)


@dataclass(frozen=True)
class LoadCase:
    """A load case: its name, the keys it sets (paths with texts as written) and the design with these values."""

    name: str
    sets: tuple[tuple[str, str], ...]
    design: Design

    @property
    def in_words(self) -> str:
        """The keys and values that the case sets, for a table."""
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


def _is_unset(value: Any) -> bool:
    """Return whether a value is None or a tuple of None only."""
    return all(entry is None for entry in value) if isinstance(value, tuple) else value is None


def _plain(value: Any, exact: bool = False) -> Any:
    """Return dataclasses and tuples as JSON values; planes as texts, or with all digits if `exact`."""
    if isinstance(value, MeshFile):
        mesh_record = {"sha256": value.sha256} | ({"up": value.up} if value.up == "y" else {})
        return mesh_record if exact else {"file": value.name} | mesh_record
    if isinstance(value, Plane) and not exact:
        return str(value)
    if is_dataclass(value):
        omitted_if_none = {
            name for names in listed(type(value), "OMITTED_IF_NONE") for name in names
        }
        attributes = (
            (attribute.name, getattr(value, attribute.name))
            for attribute in fields(value)
            if attribute.repr
        )
        record = {
            name: _plain(attribute_value, exact)
            for name, attribute_value in attributes
            if not (name in omitted_if_none and _is_unset(attribute_value))
        }
        for name in nested_records(type(value)):
            record |= record.pop(name)
        if hasattr(
            value, "resistance"
        ):  # a strength law: its own keys with its name, next to those of waviness
            inner = record.pop("law", {"law": getattr(value, "name", "")})
            record = inner | record
        return record
    return [_plain(item, exact) for item in value] if isinstance(value, tuple) else value
