"""The limits of n single blocks on flat joints, all at once: by their forces, on their beds, and the lower of both.

    limit = min(F_forces, F_bed)

as `one_block.flat_limit` has it for one block; rows are taken in chunks, so that memory does not grow with n.
"""

from dataclasses import dataclass, fields
from enum import IntEnum
from itertools import chain, combinations

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints, cross
from slopekit.preie.one_block.bed_limits import SPLITS, BedLimits, follow_paths, running_limits
from slopekit.preie.one_block.bed_path import lengths
from slopekit.preie.one_block.polygon_bed import Beds, contact_rows, cross_2d
from slopekit.preie.solvers.linear import bounded_least_squares
from slopekit.preie.system.model import local_axes
from slopekit.preie.tolerances import NO_FORCE, OPENS, PARALLEL, SAME_LIMIT, TINY

#: Rows that are taken at a time: with fewer NumPy's calls take the time, with more memory grows (9 kB a row).
CHUNK = 4096


class ForcesStatus(IntEnum):
    """What the forces alone do to a block."""

    SLIDES = 0
    LIFTED = 1  # the load pulls it off every contact
    FALLS = 2  # so too, and no contact is below it
    NOT_DRIVEN = 3  # nothing drives it, but its moments need strength
    STANDS = 4  # pushes of its contacts balance the forces and the moments


@dataclass(frozen=True, kw_only=True)
class Blocks:
    """Single blocks on up to k flat contacts of up to c corners each, without passive bolts.

    In a section, metre by metre, contacts are lines: c = 2, with the block on the left of the way from the first end to
    the second where x is to the right and z up; nothing moves along y or turns about x and z.

    Attributes
    ----------
    corners : (n, k, c, 3) m from the centroid of each block, anticlockwise as seen from outside the block
    counts : (n, k) corners of each contact; 0: a block has fewer contacts, but one at least
    cohesion : (n, k) kPa; tan_friction : (n, k)
    load : (n, 6) kN and kN m about the centroid
    """

    corners: Floats
    counts: Ints
    cohesion: Floats
    tan_friction: Floats
    load: Floats

    @property
    def unknowns(self) -> Ints:
        """Which of the six motions the blocks have."""
        return np.array([0, 2, 4]) if self.corners.shape[2] == 2 else np.arange(6)

    def of(self, rows: slice | Ints) -> "Blocks":
        """Return some of them."""
        return Blocks(**{field.name: getattr(self, field.name)[rows] for field in fields(self)})

    def beds(self) -> Beds:
        """Return their elastic beds, each in parts of its load, its area, and the distance of its corners."""
        corners, counts, columns = self.corners, self.counts, self.unknowns
        used, contacts = np.arange(corners.shape[2]) < counts[:, :, None], counts > 0
        block = np.repeat(np.arange(len(counts)), used.sum(axis=(1, 2)))
        arms, corner = corners[used], np.concatenate([[0], np.cumsum(counts[contacts])])
        length = np.sqrt(np.bincount(block, (arms * arms).sum(axis=1)) / np.bincount(block))
        force = lengths(self.load[:, :3]) + lengths(self.load[:, 3:]) / length
        sides = np.where(used[:, :, 1:, None], corners[:, :, 1:] - corners[:, :, :1], 0.0)
        if len(columns) == 3:  # out of the block
            outward = cross(sides[:, :, 0], np.array([0.0, -1.0, 0.0]))
        else:
            outward = 0.5 * cross(sides[:, :, :-1], sides[:, :, 1:]).sum(axis=2)
        area = np.sqrt((outward * outward).sum(axis=2))
        axes, whole = local_axes(-outward[contacts] / area[contacts][:, None]), area.sum(axis=1)
        middle, rows, plane = contact_rows(arms / length[block, None], corner, axes, columns)
        scale = np.broadcast_to((length ** (len(columns) // 3) / whole)[:, None], counts.shape)
        line = np.stack([scale, self.cohesion * (whole / force)[:, None], self.tan_friction], axis=2)[contacts]
        return Beds(
            contact=np.concatenate([[0], np.cumsum(contacts.sum(axis=1))]),
            corner=corner,
            axes=axes,
            middle=middle,
            rows=rows,
            plane=plane,
            line=line,
            load=np.ascontiguousarray((self.load / np.stack([force] * 3 + [force * length] * 3, axis=1))[:, columns]),
            bolt_rows=np.zeros((len(counts), 0, len(columns))),
            bolt_capacity=np.zeros((len(counts), 0)),
            length=length,
        )


@dataclass(frozen=True)
class BlockLimits:
    """The limits of n single blocks.

    Attributes
    ----------
    factor : (n,) the lower of both limits, not a number where there is none, 0 without strength
    forces : (n,) factor of safety of the forces alone; forces_status : (n,) `ForcesStatus`
    bed : (n,) that on the elastic bed; bed_status : (n,) `BedStatus`, -1 where forces settled it
    early : (n,) the largest factor reached within 30 elastic displacements, where a path was followed
    pressed : (n, k) share of each contact that is pressed at the limit on the bed
    velocity : (n, 6) unit motion of the limit that governs, turns times the distance of the corners; 0 without one
    opens_partly, opens_wholly : (n, k) contacts of which this motion opens a part, and all of it
    normal : (n, k) kN that the contacts carry in that limit, not a number where a block rests at no strength
    """

    factor: Floats
    forces: Floats
    forces_status: Ints
    bed: Floats
    bed_status: Ints
    early: Floats
    pressed: Floats
    velocity: Floats
    opens_partly: Bools
    opens_wholly: Bools
    normal: Floats

    @property
    def moments_govern(self) -> Bools:
        """(n,) whether moments lower the limit, or leave none."""
        return (self.bed_status >= 0) & ~(self.bed >= self.forces * (1.0 - SAME_LIMIT))


def limits_of_blocks(blocks: Blocks) -> BlockLimits:
    """Return the limits of single blocks by their forces and on their beds.

    Blocks whose paths have to be followed are gathered first: all take each step together.
    """
    slides, ends, chunks = list[tuple[Ints, Floats, Floats]](), list[Floats](), list[BlockLimits]()
    for first in range(0, len(blocks.load), CHUNK):
        chunk = blocks.of(slice(first, first + CHUNK))
        beds = chunk.beds()
        slides.append(_slides(beds))
        found, rise = running_limits(beds, slides[-1][1])
        chunks.append(_limits(chunk, beds, slides[-1], found))
        ends.append(rise)
    slide, end = [np.concatenate(part) for part in zip(*slides, strict=True)], np.concatenate(ends)
    names = [field.name for field in fields(BlockLimits)]
    limits = BlockLimits(*(np.concatenate([getattr(chunk, name) for chunk in chunks]) for name in names))
    paths = np.flatnonzero(~np.isnan(end))
    for rows in np.split(paths, range(CHUNK, len(paths), CHUNK)) if len(paths) else ():
        status, velocity, pushes = (part[rows] for part in slide)
        chunk = blocks.of(rows)
        beds = chunk.beds()
        found = BedLimits.none(beds, SPLITS[0])
        follow_paths(beds, found, velocity[:, -1], end[rows])
        onward = _limits(chunk, beds, (status, velocity, pushes), found)
        for name in names:
            getattr(limits, name)[rows] = getattr(onward, name)
    return limits


def _slides(beds: Beds) -> tuple[Ints, Floats, Floats]:
    """Return what forces alone do to blocks, as of `forces_slides`; λ is not a number where no bed is looked at."""
    status, slides, pushes = forces_slides(beds)
    for row in np.flatnonzero(status == ForcesStatus.NOT_DRIVEN).tolist():
        if stands_without_strength(beds, row):
            status[row] = ForcesStatus.STANDS
    slides[status == ForcesStatus.NOT_DRIVEN, -1] = 1.0  # a guess
    slides[~np.isfinite(slides[:, -1]), -1] = np.nan  # nor of blocks without strength
    return status, slides, pushes


def _limits(blocks: Blocks, beds: Beds, slide: tuple[Ints, Floats, Floats], found: BedLimits) -> BlockLimits:
    """Return the limits of as many blocks as one chunk has, by what their forces do and what their beds do."""
    (status, slides, pushes), contacts = slide, blocks.counts > 0
    has_bed = slides[:, -1] > 0.0
    forces = np.where(status == ForcesStatus.SLIDES, np.where(has_bed, 1.0 / slides[:, -1], 0.0), np.nan)
    bed, forces_govern = found.factor, ~has_bed | (found.factor > forces * (1.0 + SAME_LIMIT))
    rests, same = np.isfinite(bed), bed >= forces * (1.0 - SAME_LIMIT)
    velocity = np.where(forces_govern[:, None], slides[:, :-1], found.velocity)
    opens_partly, opens_wholly = np.zeros((2, *contacts.shape), dtype=bool)
    opens_partly[contacts], opens_wholly[contacts] = opened(beds, velocity)
    pressed, normal = np.full((2, *contacts.shape), np.nan)
    pressed[contacts], normal[contacts] = pressed_parts(beds, found.displacement)
    pressed[~rests], normal[~rests] = np.nan, np.nan
    normal[forces_govern] = pushes[forces_govern]
    normal[~contacts] = np.nan
    motion, moves = np.zeros_like(blocks.load), beds.translations
    motion[:, blocks.unknowns] = velocity
    force = lengths(blocks.load[:, blocks.unknowns[:moves]]) / lengths(beds.load[:, :moves])
    return BlockLimits(
        factor=np.where(has_bed & ~rests, np.nan, np.where(same, forces, np.fmin(forces, bed))),
        forces=forces,
        forces_status=status,
        bed=bed,
        bed_status=np.where(has_bed, found.status, -1),
        early=1.0 / found.early,
        pressed=pressed,
        velocity=motion,
        opens_partly=opens_partly,
        opens_wholly=opens_wholly,
        normal=normal * force[:, None],
    )


def forces_slides(beds: Beds) -> tuple[Ints, Floats, Floats]:
    """Return what forces alone do to blocks (n,), how they slide (n, u + 1) as of `bed_limits`, and pushes (n, k).

    Contacts push with N >= 0 so as to leave the least of the load (Moreau's decomposition): of all sets of contacts
    that may carry it, it is that whose pushes are not negative and which no other contact would add to.
    """
    first, count = beds.contact[:-1], np.diff(beds.contact)
    most, blocks, moves = int(count.max()), len(count), beds.translations
    inside = np.arange(most) < count[:, None]
    place = np.where(inside, first[:, None] + np.arange(most), 0)
    normals = beds.rows[place, 0, :moves] * inside[:, :, None]
    load = beds.load[:, :moves]
    pushes, pull, found = np.zeros((blocks, most)), load.copy(), np.zeros(blocks, dtype=bool)
    for carriers in chain.from_iterable(combinations(range(most), size) for size in range(min(most, moves) + 1)):
        some = normals[:, carriers]
        gram = some @ some.transpose(0, 2, 1)
        good = ~found & inside[:, carriers].all(axis=1) & (np.linalg.det(gram) > PARALLEL)
        rows = np.flatnonzero(good)
        force = np.linalg.solve(gram[rows], -(some[rows] @ load[rows, :, None]))[:, :, 0]
        left = load[rows] + (force[:, None] @ some[rows])[:, 0]
        added = (normals[rows] @ left[:, :, None])[:, :, 0]
        fits = (force > 0.0).all(axis=1) & (added > -NO_FORCE).all(axis=1)
        rows = rows[fits]
        pushes[rows[:, None], list(carriers)] = force[fits]
        pull[rows], found[rows] = left[fits], True
    touching = pushes > 0.0
    area, line = beds.whole[place, 0, 0], beds.line[place]
    driving = lengths(pull)
    least = NO_FORCE * np.maximum(1.0, pushes.sum(axis=1))  # what wedges a block in may push far more than its load
    resisting = (touching * (line[:, :, 1] * area + line[:, :, 2] * pushes)).sum(axis=1)
    status = np.where(touching.any(axis=1), ForcesStatus.SLIDES, ForcesStatus.LIFTED)
    status = np.where(~touching.any(axis=1) & (normals[:, :, -1] <= 0.0).all(axis=1), ForcesStatus.FALLS, status)
    status = np.where(driving > least, status, ForcesStatus.NOT_DRIVEN)
    with np.errstate(divide="ignore"):
        reduction = np.where(status == ForcesStatus.SLIDES, driving / resisting, np.nan)
    slides = np.zeros((blocks, beds.load.shape[1] + 1))
    slides[:, :moves] = np.where(driving > least, 1.0 / np.maximum(driving, TINY), 0.0)[:, None] * pull
    slides[:, -1] = reduction
    return status, slides, pushes


def stands_without_strength(beds: Beds, block: int) -> bool:
    """Return whether pushes at the corners of a block balance its forces and moments."""
    corners = np.flatnonzero(
        (beds.contact[block] <= beds.contact_of_corners) & (beds.contact_of_corners < beds.contact[block + 1])
    )
    across = np.concatenate([np.ones((len(corners), 1)), beds.plane[corners]], axis=1)
    lifts = (across[:, None] @ beds.rows[beds.contact_of_corners[corners], :3])[:, 0]
    _, rest = bounded_least_squares(lifts.T, -beds.load[block], np.full(len(lifts), np.inf))
    return float(np.abs(rest).max()) < NO_FORCE


def opened(beds: Beds, motion: Floats) -> tuple[Bools, Bools]:
    """Return the contacts (m,) of which unit motions (n, u) of the blocks open a part, and those they open wholly."""
    gap, first, second = beds.motions(motion).T
    starts = beds.corner[:-1]
    widest, narrowest = np.maximum.reduceat(gap, starts), np.minimum.reduceat(gap, starts)
    slip = np.maximum.reduceat(np.sqrt(first * first + second * second), starts)
    size = np.maximum.reduceat(np.maximum(slip, widest), beds.contact[:-1])
    least = OPENS * np.repeat(size, np.diff(beds.contact))
    return (widest > least) & (narrowest <= least), narrowest > least


def pressed_parts(beds: Beds, opening: Floats) -> tuple[Floats, Floats]:
    """Return the pressed share (m,) of each contact, and its normal force, with openings (n, u) of the blocks."""
    here, gaps, after = beds.plane, beds.motions(opening, 1)[:, 0], beds.following
    there, to = here[after], gaps[after]
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = here + (gaps / (gaps - to))[:, None] * (there - here)
    leaves, comes = (gaps < 0.0) & (to >= 0.0), (gaps >= 0.0) & (to < 0.0)
    double = cross_2d(np.where(comes[:, None], crossing, here), np.where(leaves[:, None], crossing, there))
    double *= (gaps < 0.0) | comes
    # of the new edge: where the way round leaves the pressed part, and comes back
    ends, contact = np.zeros((2, len(beds.rows), 2)), beds.contact_of_corners
    for which, cut in enumerate((leaves, comes)):
        ends[which, contact[cut]] = crossing[cut]
    # of triangles with a third corner in the middle of the contact
    middle = (beds.rows[:, 0] * np.repeat(opening, np.diff(beds.contact), axis=0)).sum(axis=1)
    area = np.bincount(contact, double) + cross_2d(*ends)
    volume = area * middle + np.bincount(contact, double * (np.minimum(gaps, 0.0) + np.minimum(to, 0.0)))
    per_area, whole = beds.line[:, 0] * np.sign(area), beds.whole[:, 0, 0]
    # of lines
    push = np.bincount(contact, np.maximum(-gaps, 0.0))
    share, is_line = push / np.maximum(np.bincount(contact, np.abs(gaps)), TINY), np.diff(beds.corner) == 2
    share = np.where(is_line, share, 0.5 * per_area * area / whole)
    return share, np.where(is_line, 0.5 * share * push * whole, -per_area * volume / 6.0)
