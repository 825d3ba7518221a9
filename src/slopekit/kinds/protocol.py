"""What a kind of design says of itself, in one place: studies and views ask here, never which kind it is."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from slopekit.core.codec import NO_JSON
from slopekit.core.errors import Notice
from slopekit.design.common import Answered, Design
from slopekit.design.parts import Strength
from slopekit.design.reading.reader import Reader
from slopekit.evidence import WithoutBasal
from slopekit.result import Result, Words

if TYPE_CHECKING:
    from slopekit.core.sheet import Section
    from slopekit.kinds.single_block.closed_forms import OnArrays
    from slopekit.kinds.single_block.ladders import Ladder

D = TypeVar("D", bound=Design)


@dataclass(frozen=True)
class ClosedForm:
    """A closed form to compare with: its factor and status; `why_not` says why it is not compared."""

    factor: float | None
    status: str
    why_not: str = ""


@dataclass(frozen=True)
class Factors:
    """What the two methods say of a design.

    Attributes
    ----------
    status : of PRE-IE, as `Result.status`; that of the closed form where PRE-IE was not asked; not_converged where
        neither settled to a factor nor to none
    limit : PRE-IE's factor of safety, None where nothing moves, or it was not asked
    closed_status, closed_form : of the closed form, None where the kind has none
    difference, agree : of the two on the same assumptions, None where they are not compared
    moments_govern : the limit lies below what the forces alone give
    notes : what a run says of the factor: how it was found, what it rests on, and what it leaves out
    also : what acceptance of a run is held against besides
    """

    status: str
    limit: float | None
    closed_status: str | None
    closed_form: float | None
    difference: float | None
    agree: bool | None
    moments_govern: bool
    notes: Sequence[Notice] = field(default=(), kw_only=True, metadata=NO_JSON)
    also: WithoutBasal | None = field(default=None, kw_only=True, metadata=NO_JSON)

    @property
    def factor(self) -> float | None:
        """The limit where there is one, else the closed form's factor."""
        return self.limit if self.limit is not None else self.closed_form


@dataclass(frozen=True)
class Gain:
    """How fast a mechanism gains on shaken ground.

    Attributes
    ----------
    factor : acceleration of a block's centroid in parts of (a - k_y g)
    block : the name of that block, the one that moves farthest
    alone_at : where the motion of all did not settle, the k_y of that block alone with all others held, whose factor
        it is; None otherwise
    first : the factor right at k_y, where contacts change just above it and the factor is another; None otherwise
    """

    factor: float
    block: str
    alone_at: float | None = None
    first: float | None = None


@dataclass(frozen=True)
class Kind(Generic[D]):
    """A kind of design.

    Attributes
    ----------
    record : the dataclass of its designs, whose fields declare the keys
    read : a design from a file, all faults at once
    words : what it calls things
    analyse : from a design to its result
    factors : both factors of safety and nothing else, for studies that ask thousands of times
    ladder : what `check` looks at: the result, and ways to its factor with more and less effort
    strengths : of the joints
    slope : what was analysed, on the sheet: joints and faces, size, loads
    closed_form : on the same assumptions, in next to no time; None where there is none
    on_arrays : the same for many designs in one call, None where it takes them one by one; support is looked for where
        there is one: the block is a `Cut` with a free face
    cut : the blocks, cut and loaded: `one_block.Cut` or `many_blocks_scene.AssemblyScene`
    beside : what is known of a factor from elsewhere and takes as long as it: said of one answer, not of thousands
    without_basal : a block that the one analysed is part of, and that may fail before it; None where there is none
    at_load : (without, unit, target) the multiplier of a load at which the factor is the target; None where a kind has
        no such path
    seismic_gain : (without, unit, k_y, by the closed form) how fast the mechanism at k_y gains on the ground; None of
        kinds of one block, whose k_y with a force along the sliding says it
    figures : numbers that published cases give beside the factors: name -> (design, which) -> number
    """

    record: type[D]
    read: Callable[[Reader], D]
    words: Words
    analyse: Callable[[D], Result]
    factors: Callable[[D], Factors]
    ladder: "Callable[[D], Ladder]"
    strengths: Callable[[D], Sequence[Strength]]
    slope: "Callable[[D, Result], Sequence[Section]]"
    cut: Callable[[D], Any]
    closed_form: Callable[[D], ClosedForm] | None = None
    on_arrays: "OnArrays[D] | None" = None
    beside: Callable[[D], tuple[Notice, ...]] = lambda _: ()
    without_basal: Callable[[D], WithoutBasal | None] = lambda _: None
    at_load: Callable[[D, D, float], float | None] | None = None
    seismic_gain: Callable[[D, D, float, bool], Gain | None] | None = None
    figures: Mapping[str, Callable[[D, Any], float]] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """The word behind `kind:`."""
        return self.record.__name__.removesuffix("Design").lower()

    @property
    def answered(self) -> Answered:
        """When a design under work is analysed: while a slider is dragged, when it is let go, at a button."""
        return "drag" if self.closed_form is not None else self.record.ANSWERED


def compare(
    factor: float | None, status: str, closed: ClosedForm, agree_within: float
) -> tuple[float | None, bool | None]:
    """Relative difference of the two methods on the same assumptions, and whether they agree."""
    if status == "not_converged":
        return None, False
    if closed.why_not:
        return None, None
    if not factor and not closed.factor:
        factor = None  # no strength at all: a status on both sides, no number (UX.md rule 2)
    if factor is None or closed.factor is None:
        held = closed.status == "no_driving_force" and status == "rotates"  # forces alone do not drive it, moments do
        return None, factor is None and not closed.factor and (status in (closed.status, "topples") or held)
    if closed.factor == 0.0:
        return None, False
    difference = abs(factor / closed.factor - 1.0)
    return difference, difference <= agree_within
