"""What a kind of design says of itself, in one place: studies and views ask here, never which kind it is."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

from slopekit.core.errors import Notice
from slopekit.design.common import Design
from slopekit.design.reading.reader import Reader
from slopekit.evidence import Factors as Factors
from slopekit.evidence import WithoutBasal
from slopekit.result import Result, Words

if TYPE_CHECKING:
    from slopekit.core.sheet import Section
    from slopekit.kinds.single_block.closed_forms import OnArrays
    from slopekit.kinds.single_block.ladders import Ladder

D = TypeVar("D", bound=Design)


@dataclass(frozen=True)
class ClosedForm:
    """A closed form to compare with: its factor and status.

    Attributes
    ----------
    why_not : why it is not compared; empty where it is
    methods : factors of other methods of the kind (columns) by name; None where one has no answer
    table : of the columns of a row, empty of all else
    notices : what a reader must know of it
    """

    factor: float | None
    status: str
    why_not: str = ""
    methods: Mapping[str, float | None] = field(default_factory=dict)
    table: Sequence[Mapping[str, Any]] = ()
    notices: Sequence[Notice] = ()

    def figure(self, name: str, which: Any) -> float | None:
        """Return a number that published cases give beside the factor; None where there is none of that name."""
        return None

    def seismic_gain(self, k: float) -> "Gain | None":
        """Return how fast the mechanism at a yield coefficient gains on the ground; None where that is not known."""
        return None


@dataclass(frozen=True)
class Gain:
    """How fast a mechanism gains on shaken ground.

    Attributes
    ----------
    factor : acceleration of a block's centroid in parts of (a - k_y g)
    block : the name of that block, the one that moves farthest
    first : the factor right at k_y, where contacts change just above it and the factor is another; None otherwise
    """

    factor: float
    block: str
    first: float | None = None


def closed_form_notices(_: Design, __: Any, ___: Any, closed: ClosedForm) -> Sequence[Notice]:
    """Return what a reader must know of the closed form alone."""
    return closed.notices


@dataclass(frozen=True)
class Kind(ABC, Generic[D]):
    """A kind of design: what it is made of, in eight members. All else follows from these, of one block or of many.

    Attributes
    ----------
    record : the dataclass of its designs, whose fields declare the keys
    read : a design from a file, all faults at once
    words : what it calls things
    cut : the blocks, cut and loaded: `one_block_limit.Cut` or `many_blocks_scene.AssemblyScene`
    closed_form : on the same assumptions, of a design and what was cut of it; None in its place where a closed form is
        asked alone (`record.HAS_CLOSED_FORM`), in next to no time
    slope : what was analysed, on the sheet: joints and faces, size, loads
    notices : what a reader must know of a design, of what was cut, of its limit (`FoundLimit` of one block, the first
        `Failure` of many), of the closed form
    on_arrays : the closed form of many designs in one call, None where it takes them one by one; support is looked for
        where there is one: the block is a `Cut` with a free face
    """

    MOVES_MANY: ClassVar[bool]  #: Whether it has many blocks, whose path a load may drive.

    record: type[D]
    read: Callable[[Reader], D]
    words: Words
    cut: Callable[[D], Any]
    closed_form: Callable[[D, Any], ClosedForm]
    slope: "Callable[[D, Result], Iterable[Section]]"
    notices: Callable[[D, Any, Any, ClosedForm], Iterable[Notice]] = closed_form_notices
    on_arrays: "OnArrays[D] | None" = None

    @property
    def name(self) -> str:
        """The word behind `kind:`."""
        return self.record.__name__.removesuffix("Design").lower()

    @abstractmethod
    def analyse(self, design: D) -> Result:
        """Return the result of a design. Raises GeometryError where no block can be formed."""

    @abstractmethod
    def factors(self, design: D) -> Factors:
        """Return both factors of safety and nothing else, for studies that ask thousands of times."""

    @abstractmethod
    def ladder(self, design: D) -> "Ladder":
        """Return what `check` looks at: the result, and ways to its factor with more and less effort."""

    def without_basal(self, design: D) -> WithoutBasal | None:
        """Return what a block does that the one analysed is part of, and that may fail before it; None without one."""
        return None

    def reference_notices(self, design: D) -> tuple[Notice, ...]:
        """Return what is known of a factor from elsewhere and takes as long as it: said of one answer alone."""
        return ()

    def at_load(self, without: D, unit: D, target: float) -> float | None:
        """Return the multiplier of what one design has more of loads than another at which the factor is a target.

        None where the blocks do not stand without it, or stand with any of it.
        """
        return None

    def seismic_gain(self, without: D, unit: D, k: float, by_closed_form: bool) -> Gain | None:
        """Return how fast the blocks gain on the ground above k_y; None where their motion is none that settled.

        Of one block the k_y with a force along the sliding says it.
        """
        return None


def compare(
    factor: float | None, status: str, closed: ClosedForm, agree_within: float
) -> tuple[float | None, bool | None]:
    """Relative difference of the two methods on the same assumptions, and whether they agree."""
    if status == "not_converged":
        return None, False
    if closed.why_not:
        return None, None
    if not factor and not closed.factor:
        factor = None  # no strength at all: a status on both sides, no number
    if factor is None or closed.factor is None:
        held = closed.status == "no_driving_force" and status == "rotates"  # forces alone do not drive it, moments do
        return None, factor is None and not closed.factor and (status in (closed.status, "topples") or held)
    if closed.factor == 0.0:
        return None, False
    difference = abs(factor / closed.factor - 1.0)
    return difference, difference <= agree_within
