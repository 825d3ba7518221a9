"""The interface of a kind of design: studies and views use these members and never test which kind it is."""

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

    def figure(self, name: str, column: Any) -> float | None:
        """Return a further quantity of published cases by its name (of a `column`); None where the kind has none."""
        return None

    def seismic_gain(self, k: float) -> "Gain | None":
        """Return the acceleration of the mechanism relative to the ground at a yield coefficient; None if unknown."""
        return None


@dataclass(frozen=True)
class Gain:
    """The acceleration of a mechanism relative to shaken ground.

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
    """Return the notices of the closed form alone."""
    return closed.notices


@dataclass(frozen=True)
class Kind(ABC, Generic[D]):
    """A kind of design, of one block or of many, defined by eight members.

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
        """Return the convergence ladder of a design for `check`: the result, and its factor at other efforts."""

    def without_basal(self, design: D) -> WithoutBasal | None:
        """Return the whole wedge that the analysed block is part of, and that may fail before it; None without one."""
        return None

    def reference_notices(self, design: D) -> tuple[Notice, ...]:
        """Return the notices that take as long as an analysis, so that a study gives them for one answer alone."""
        return ()

    def at_load(self, unloaded: D, unit: D, target: float) -> float | None:
        """Return the multiplier of the load difference between `unit` and `unloaded` at which the factor is a target.

        None where the blocks are unstable without the load, or stable under any multiple of it.
        """
        return None

    def seismic_gain(self, unloaded: D, unit: D, k: float, by_closed_form: bool) -> Gain | None:
        """Return the acceleration of the blocks relative to the ground above k_y; None where no motion settled.

        Single blocks have none: their k_y with a force along the sliding direction gives it.
        """
        return None


def compare(
    factor: float | None, status: str, closed: ClosedForm, agree_within: float
) -> tuple[float | None, bool | None]:
    """Return the relative difference of the two methods on the same assumptions, and whether they agree."""
    if status == "not_converged":
        return None, False
    if closed.why_not:
        return None, None
    if not factor and not closed.factor:
        factor = None  # no strength at all: a status on both sides, no number
    if factor is None or closed.factor is None:
        is_stable_without_moments = (
            closed.status == "no_driving_force" and status == "rotates"
        )  # forces alone do not drive it, moments do
        return None, factor is None and not closed.factor and (
            status in (closed.status, "topples") or is_stable_without_moments
        )
    if closed.factor == 0.0:
        return None, False
    difference = abs(factor / closed.factor - 1.0)
    return difference, difference <= agree_within
