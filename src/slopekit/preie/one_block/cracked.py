"""The limit of one block on its no-tension elastic bed, with the forces that its joints carry there."""

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.records import dataclass
from slopekit.preie.one_block.bed_limits import SPLITS, BedStatus, Slides, bed_limits
from slopekit.preie.one_block.bed_path import COARSE, EARLY, STRONGEST, BedPath, lengths
from slopekit.preie.one_block.polygon_bed import BedSprings, PointForces, PolygonBed, beds_of

__all__ = ["STRONGEST", "CrackedBase", "cracked_base", "early_factor"]
_FIRST = np.zeros(1, dtype=np.int64)


@dataclass(frozen=True, slots=True)
class CrackedBase:
    """The limit of a block on its cracked base.

    Attributes
    ----------
    status : how the block ends
    factor : F, None where it is not at rest at any strength
    opening, velocity : (u,) elastic displacement and unit motion at the limit
    split : how often the triangles of pressed parts were split
    change : what splitting them once more does to F, in parts of it (first order); points : of the path
    early_factor : the largest F reached within `EARLY` elastic displacements, None where no path was followed
    """

    status: BedStatus
    factor: float | None
    opening: Floats
    velocity: Floats
    split: int = SPLITS[0]
    change: float = 0.0
    points: int = 0
    early_factor: float | None = None

    @property
    def runs(self) -> bool:
        """Whether the motion runs at a settled λ; else λ went through its least value with the block still at rest."""
        return self.status in (BedStatus.PRESSED, BedStatus.RUNS, BedStatus.CREEPS)

    @property
    def creeps(self) -> bool:
        """Whether it runs about an edge: F is that of the last point, below what a line of contact gives in the end."""
        return self.status is BedStatus.CREEPS

    def forces(self, bed: PolygonBed) -> PointForces:
        """Return what the points of its bed carry at the limit."""
        assert self.factor is not None
        springs = BedSprings(beds_of([bed]), self.split)
        if self.status in (BedStatus.PRESSED, BedStatus.RUNS):
            return springs.carried(bed, self.opening, self.velocity, 1.0 / self.factor, True)
        return springs.carried(bed, self.opening, self.opening, 1.0 / self.factor, False)


def guessed(bed: PolygonBed, factor: float) -> Slides:
    """Return no slide of forces alone, but a factor of about the right size."""
    return Slides(np.array([1.0 / factor]), np.zeros((1, len(bed.load))), np.zeros(len(bed.corners), dtype=bool))


def cracked_base(bed: PolygonBed, slides: Slides, splits: tuple[int, ...] = SPLITS) -> CrackedBase:
    """Return the limit of one block on its elastic bed.

    Parameters
    ----------
    slides : its slide by forces alone, or a guess; splits : of triangles, the next where the one before is too coarse
    """
    found = bed_limits(beds_of([bed]), slides, splits)
    status = BedStatus(int(found.status[0]))
    early = float(found.early[0])
    return CrackedBase(
        status=status,
        factor=None if status is BedStatus.NO_REST else 1.0 / float(found.reduction[0]),
        opening=found.displacement[0],
        velocity=found.velocity[0],
        split=int(found.split[0]),
        change=float(found.change[0]),
        points=int(found.steps[0]),
        early_factor=1.0 / early if np.isfinite(early) else None,
    )


def early_factor(bed: PolygonBed, base: CrackedBase) -> float | None:
    """Return F at `EARLY` elastic displacements of a block whose path was not followed to its running state."""
    if base.early_factor is not None or base.status is not BedStatus.RUNS or base.factor is None:
        return base.early_factor
    path = BedPath(BedSprings(beds_of([bed]), COARSE))
    stuck = path.rests(_FIRST, path.springs.bonded, np.ones(1), sticks=True)
    most, pressed = EARLY * lengths(stuck.x[:, :-1]), lengths(base.opening[None])
    if not stuck.settled[0] or not most[0] > pressed[0]:
        return None
    along = np.sqrt(most * most - pressed * pressed)
    start = np.append((base.opening + along * base.velocity) / most, -np.log(base.factor))[None]
    plane = np.append(base.velocity, 0.0)[None]
    found = path.on_planes(_FIRST, plane, along / most, most, start)
    return float(np.exp(-found.x[0, -1])) if found.settled[0] else None
