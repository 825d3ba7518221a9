"""The limit of many blocks: its factor, what it rests on, and how it was found."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

from slopekit.core.arrays import Floats
from slopekit.preie.elastic_path.path_limit import PathLimit
from slopekit.preie.outcome import Outcome

Span = tuple[float | None, float | None]
"""The lowest and highest factor of a mechanism; an end is None where it lies far beyond."""


class Basis(StrEnum):
    """What a factor of many blocks rests on."""

    LIMIT = "limit state, exact for its contact modes"
    SETTLED = "limit of the elastic path, settled"
    PEAK = "last state at rest on the elastic path; its motion did not settle"
    ALONE = "one block that slides alone, by forces"
    NONE = "no factor"


@dataclass(frozen=True, kw_only=True)
class LimitSearch:
    """How the limit of an assembly was found: work, steps, groups.

    Attributes
    ----------
    steps : factorisations of the path; bound_steps : of the bound
    group : blocks that were not held when it was found, 0 where none was; then all came to rest but for `width` of it
    rounding : what the law of the joints is rounded by where all came to rest, in parts of their elastic energy
    spent : whether there is no factor because the work that is allowed was done (`solvers.work_limit`); `rested`: the
        factor at which all blocks were at rest last then, None where they were at none, or cohesion might yet be lost
    """

    steps: int = 0
    bound_steps: int = 0
    group: int = 0
    width: float = 0.0
    rounding: float = 0.0
    spent: bool = False
    rested: float | None = None


@dataclass(frozen=True)
class BlocksLimit(LimitSearch):
    """The limit of an assembly.

    Attributes
    ----------
    outcome, factor : the factor is None where there is none
    basis : what the factor is
    change : width of the bracket in parts of the factor, 0 where a limit state was found
    velocity : (n, u) of the mechanism, its largest motion 1
    normal_force : (m,); friction : (g, t); in parts of the force scale
    bond : (m,) share of the cohesion of a pair that acts
    static_bound : None where none was found, or none exists; locked : none does, joints that dilate would hold the
        blocks at any friction; lowest, highest : the range of the mechanism's factors, the
        lowest no more than the factor that finer node pairs gave before their motion had settled, and, where they
        crept to no exact limit state, than the factor at 30 elastic displacements
    multiplier : of the load that grows at the limit, where that was looked for
    tips : the part of the loads beside weight and water at which the blocks tip at that factor and any lower one, in a
        motion that slips nowhere; None where no such motion was found
    """

    outcome: Outcome
    factor: float | None
    basis: Basis
    change: float
    velocity: Floats
    normal_force: Floats
    friction: Floats
    bond: Floats
    static_bound: float | None = None
    lowest: float | None = None
    highest: float | None = None
    tips: tuple[float, float] | None = None
    locked: bool = False
    multiplier: float | None = None


class Proposal(Protocol):
    """Another way than the path of all blocks to their limit."""

    def limit(self, top: float) -> PathLimit | None:
        """The limit of all blocks, at most `top`; None where the way leads nowhere."""

    def span(self, motion: Floats, top: float | None) -> Span | None:
        """The range of the mechanism that it found last, where that has this motion (n, u), looked for up to `top`."""
