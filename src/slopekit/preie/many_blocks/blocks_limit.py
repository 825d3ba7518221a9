"""What the limit of many blocks is: its factor, how sure it is, and what it was found with."""

from enum import StrEnum
from typing import Protocol

from slopekit.core.arrays import Floats
from slopekit.core.records import dataclass
from slopekit.preie.elastic_path.path_limit import PathLimit
from slopekit.preie.one_block.passes import Outcome

Span = tuple[float | None, float | None]
"""The lowest and highest factor of a mechanism; an end is None where it lies far beyond."""


class Basis(StrEnum):
    """How sure a factor is."""

    LIMIT = "limit state, exact for its contact modes"
    SETTLED = "limit of the elastic path, settled"
    PEAK = "last state at rest on the elastic path; its motion did not settle"
    ALONE = "one block that slides alone, by forces"
    NONE = "no factor"


@dataclass(frozen=True, slots=True)
class BlocksLimit:
    """The limit of an assembly.

    Attributes
    ----------
    outcome, factor : the factor is None where there is none
    basis : what the factor is
    change : width of the bracket in parts of the factor, 0 where a limit state was found
    velocity : (n, u) of the mechanism, its largest motion 1
    normal_force : (m,); friction : (g, t); in parts of the force scale
    bond : (m,) 0 where a pair has lost its cohesion
    static_bound : None where none was found, or none exists; locked : none does, joints that dilate would hold the
        blocks at any friction; lowest, highest : the range of the mechanism's factors, the
        lowest no more than the factor that finer node pairs gave before their motion had settled
    carried : part of the loads beside weight and water at which the blocks fail at full strength, where that was asked
    loads_last : whether those loads came on after weight and water; tips : the part of them at which the blocks tip
        then, in a motion that slips nowhere, at that factor and any lower one; None where no such motion was found
    begun : the factor at which all loads came on at once, where that is far below the static bound; fit_on : that at
        which they fit on last, between limits of other modes, where they do
    kept_share : the part of the motion's work that cohesion would do which it opens, and that the factor leaves out
    steps : factorisations of the path; bound_steps : of the bound
    spent : whether there is no factor because the work that is allowed was done (`solvers.work_limit`); `rested`: the
        factor at which all blocks were at rest last then, None where they were at none, or cohesion might yet be lost
    held : where it is spent, the factor of the group that was solved last, all others held, and how many blocks it has
    by_turns : of a search that gave up, the factors between which loads that come last fit on and do not by turns
    group : blocks that were not held when it was found, 0 where none was; then all came to rest but for `width` of it
    rounding : what the law of the joints is rounded by where all came to rest, in parts of their elastic energy
    """

    outcome: Outcome
    factor: float | None
    basis: Basis
    change: float
    velocity: Floats
    normal_force: Floats
    friction: Floats
    bond: Floats
    static_bound: float | None
    lowest: float | None
    highest: float | None
    carried: float | None
    loads_last: bool
    steps: int
    bound_steps: int
    group: int = 0
    width: float = 0.0
    rounding: float = 0.0
    spent: bool = False
    rested: float | None = None
    held: tuple[float, int] | None = None
    by_turns: tuple[float, float] | None = None
    tips: tuple[float, float] | None = None
    begun: float | None = None
    fit_on: float | None = None
    kept_share: float = 0.0
    locked: bool = False


class Proposal(Protocol):
    """Another way than the path to the limit of all blocks."""

    def limit(self, bond: Floats, falls: bool, top: float, peaks: bool = False) -> PathLimit | None:
        """The limit with some bonds (m,), at most `top`, or with `peaks` a peak; None where the way leads nowhere."""

    def limit_alone(self, bond: Floats, falls: bool) -> PathLimit | None:
        """That of the blocks which failed last, all others held; None where there is none."""

    def peak(self) -> PathLimit | None:
        """The peak of proposed blocks with which no limit was found last, where the path of all takes long."""

    def held(self) -> tuple[float, int] | None:
        """The factor of the blocks that were solved last, all others held, and how many they are; None where none."""

    def begins_with(self, motion: Floats) -> None:
        """Blocks that move in a motion (N,) of all, and their neighbours, are proposed first from now on."""

    def span(self, motion: Floats) -> Span | None:
        """The range of the mechanism that it found last, where that has this motion (n, u)."""
