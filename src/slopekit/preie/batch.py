"""The limits of n single blocks on flat joints, all at once: by their forces, on elastic beds, and the lower of both.

    limit = min(F_forces, F_bed)

as `one_block.flat_limit` has it for one block; rows are taken in chunks, so that memory does not grow with n.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import TypeVar

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints, NDArray, cross
from slopekit.preie.one_block.bed_limits import (
    SPLITS,
    BedLimits,
    BedStatus,
    follow_paths,
    running_limits,
)
from slopekit.preie.one_block.bed_path import lengths
from slopekit.preie.one_block.dilating import dilating_slides
from slopekit.preie.one_block.forces_limits import ForcesLimits, forces_limits
from slopekit.preie.one_block.polygon_bed import Beds, contact_rows, cross_2d
from slopekit.preie.system.model import local_axes
from slopekit.preie.tolerances import OPENS, SAME_LIMIT, TINY

#: Rows that are taken at a time: with fewer NumPy's calls take the time, with more memory grows (9 kB a row).
CHUNK = 4096
T = TypeVar("T", "BlockLimits", ForcesLimits)


@dataclass(frozen=True, kw_only=True)
class Blocks:
    """Single blocks on up to k flat contacts of up to c corners each.

    In a section, metre by metre, contacts are lines: c = 2, with the block on the left of the way from the first end to
    the second where x is to the right and z up; nothing moves along y or turns about x and z.

    Attributes
    ----------
    corners : (n, k, c, 3) m from the centroid of each block, anticlockwise as seen from outside the block
    counts : (n, k) corners of each contact; 0: a block has fewer contacts, but one at least
    cohesion : (n, k) kPa; tan_friction, tan_dilation : (n, k)
    laws : (n, k) curved laws, None where strength is that line
    load : (n, 6) kN and kN m about the centroid; bolts : (n, b, 6) passive ones at full capacity likewise
    """

    corners: Floats
    counts: Ints
    cohesion: Floats
    tan_friction: Floats
    tan_dilation: Floats
    laws: NDArray[np.object_]
    load: Floats
    bolts: Floats

    @property
    def unknowns(self) -> Ints:
        """Indices of the six rigid motions that the blocks have: three in a section."""
        return np.array([0, 2, 4]) if self.corners.shape[2] == 2 else np.arange(6)

    def take(self, rows: slice | Ints) -> "Blocks":
        """Return the blocks of these rows."""
        return Blocks(**{field.name: getattr(self, field.name)[rows] for field in fields(self)})

    def beds(self) -> Beds:
        """Return the elastic beds of the blocks, each scaled by its load, its area, and the distance of its corners."""
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
        axes, total_area = (
            local_axes(-outward[contacts] / area[contacts][:, None]),
            area.sum(axis=1),
        )
        middle, rows, plane = contact_rows(arms / length[block, None], corner, axes, columns)
        scale = np.broadcast_to((length ** (len(columns) // 3) / total_area)[:, None], counts.shape)
        units = np.stack([force] * 3 + [force * length] * 3, axis=1)
        pulls, capacity = (
            self.bolts / units[:, None],
            np.sqrt((self.bolts[:, :, :3] ** 2).sum(axis=2)) / force[:, None],
        )
        line = np.stack(
            [scale, self.cohesion * (total_area / force)[:, None], self.tan_friction], axis=2
        )[contacts]
        laws = self.laws[contacts]
        return Beds(
            contact=np.concatenate([[0], np.cumsum(contacts.sum(axis=1))]),
            corner=corner,
            axes=axes,
            middle=middle,
            rows=rows,
            plane=plane,
            line=line,
            load=np.ascontiguousarray((self.load / units)[:, columns]),
            bolt_rows=(pulls / np.maximum(capacity, TINY)[:, :, None])[:, :, columns],
            bolt_capacity=capacity,
            length=length,
            laws=tuple(laws) if any(laws) else (),
            stress_scale=np.repeat(force / total_area, contacts.sum(axis=1)),
            tan_dilation=self.tan_dilation[contacts],
        )


@dataclass(frozen=True)
class BlockLimits:
    """The limits of n single blocks.

    Attributes
    ----------
    factor : (n,) the lower of both limits, not a number where there is none, 0 without strength
    forces : (n,) factor of safety of the forces alone; forces_status : (n,) `ForcesStatus`
    bed : (n,) that on the elastic bed; bed_status : (n,) `BedStatus`, -1 where forces settled it
    pressed : (n, k) share of each contact that is pressed at the limit on the bed
    velocity : (n, 6) unit motion of the limit that governs, turns times the distance of the corners; 0 without one
    opens_partly, opens_wholly : (n, k) contacts of which this motion opens a part, and all of it
    normal : (n, k) kN that the contacts carry in that limit, not a number where a block rests at no strength
    dilates : (n,) whether that is a slide with the dilation of its contacts, all of them pressed
    """

    factor: Floats
    forces: Floats
    forces_status: Ints
    bed: Floats
    bed_status: Ints
    pressed: Floats
    velocity: Floats
    opens_partly: Bools
    opens_wholly: Bools
    normal: Floats
    dilates: Bools

    @property
    def moments_govern(self) -> Bools:
        """Whether (n,) moments lower the limit, or leave none."""
        return (self.bed_status >= 0) & ~(self.bed >= self.forces * (1.0 - SAME_LIMIT))


def limits_of_blocks(blocks: Blocks) -> BlockLimits:
    """Return the limits of single blocks by their forces and on their beds.

    Blocks whose elastic paths have to be followed are collected first, so that all take each step together.
    """
    slides, ends, chunks = list[ForcesLimits](), list[Floats](), list[BlockLimits]()
    for first in range(0, len(blocks.load), CHUNK):
        chunk = blocks.take(slice(first, first + CHUNK))
        beds = chunk.beds()
        slides.append(forces_limits(beds))
        by_beds, path_ends = running_limits(beds, slides[-1].slides)
        chunks.append(_limits_of_chunk(chunk, beds, slides[-1], by_beds))
        ends.append(path_ends)
    limits, by_forces, end = _joined(chunks), _joined(slides), np.concatenate(ends)
    paths = np.flatnonzero(~np.isnan(end))
    for rows in np.split(paths, range(CHUNK, len(paths), CHUNK)) if len(paths) else ():
        chunk, row_forces = (
            blocks.take(rows),
            ForcesLimits(*(getattr(by_forces, name)[rows] for name in _names(ForcesLimits))),
        )
        beds = chunk.beds()
        by_beds = BedLimits.none(beds, SPLITS[0])
        follow_paths(beds, by_beds, row_forces.slides[:, -1], end[rows])
        row_limits = _limits_of_chunk(chunk, beds, row_forces, by_beds)
        for name in _names(BlockLimits):
            getattr(limits, name)[rows] = getattr(row_limits, name)
    dilates = np.flatnonzero(
        (blocks.tan_dilation > 0.0).any(axis=1) & ~blocks.laws.astype(bool).any(axis=1)
    )
    for rows in np.split(dilates, range(CHUNK, len(dilates), CHUNK)) if len(dilates) else ():
        chunk = blocks.take(rows)
        tilted, by_forces, by_beds = dilating_slides(chunk.beds())
        pressed, row_limits = (
            by_beds.status == BedStatus.PRESSED,
            _limits_of_chunk(chunk, tilted, by_forces, by_beds),
        )
        for name in _names(BlockLimits):
            getattr(limits, name)[rows[pressed]] = getattr(row_limits, name)[pressed]
        limits.dilates[rows[pressed]] = True
    return limits


def _names(record: type) -> list[str]:
    return [field.name for field in fields(record)]


def _joined(records: Sequence[T]) -> T:
    """Return one record with the rows of several."""
    record_type = type(records[0])
    return record_type(
        *(
            np.concatenate([getattr(record, name) for record in records])
            for name in _names(record_type)
        )
    )


def _limits_of_chunk(
    blocks: Blocks, beds: Beds, by_forces: ForcesLimits, by_beds: BedLimits
) -> BlockLimits:
    """Return the limits of the blocks of one chunk, the lower of their limits by forces and on beds."""
    slides, forces, contacts = by_forces.slides, by_forces.factor, blocks.counts > 0
    has_bed = slides[:, -1] > 0.0
    bed, forces_govern = by_beds.factor, ~has_bed | (by_beds.factor > forces * (1.0 + SAME_LIMIT))
    rests, is_same = np.isfinite(bed), bed >= forces * (1.0 - SAME_LIMIT)
    velocity = np.where(forces_govern[:, None], slides[:, :-1], by_beds.velocity)
    opens_partly, opens_wholly = np.zeros((2, *contacts.shape), dtype=bool)
    opens_partly[contacts], opens_wholly[contacts] = opened(beds, velocity)
    pressed, normal = np.full((2, *contacts.shape), np.nan)
    pressed[contacts], normal[contacts] = pressed_parts(beds, by_beds.displacement)
    pressed[~rests], normal[~rests] = np.nan, np.nan
    normal[forces_govern] = by_forces.pushes[forces_govern]
    normal[~contacts] = np.nan
    motion, moves = np.zeros_like(blocks.load), beds.translations
    motion[:, blocks.unknowns] = velocity
    force = lengths(blocks.load[:, blocks.unknowns[:moves]]) / lengths(beds.load[:, :moves])
    return BlockLimits(
        factor=np.where(has_bed & ~rests, np.nan, np.where(is_same, forces, np.fmin(forces, bed))),
        forces=forces,
        forces_status=by_forces.status,
        bed=bed,
        bed_status=np.where(has_bed, by_beds.status, -1),
        pressed=pressed,
        velocity=motion,
        opens_partly=opens_partly,
        opens_wholly=opens_wholly,
        normal=normal * force[:, None],
        dilates=np.zeros(len(bed), dtype=bool),
    )


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
    corners, gaps, following = beds.plane, beds.motions(opening, 1)[:, 0], beds.following
    next_corners, next_gaps = corners[following], gaps[following]
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = corners + (gaps / (gaps - next_gaps))[:, None] * (next_corners - corners)
    leaves, comes = (gaps < 0.0) & (next_gaps >= 0.0), (gaps >= 0.0) & (next_gaps < 0.0)
    double = cross_2d(
        np.where(comes[:, None], crossing, corners),
        np.where(leaves[:, None], crossing, next_corners),
    )
    double *= (gaps < 0.0) | comes
    # ends of the new edge: where the outline leaves the pressed part, and where it returns
    ends, contact = np.zeros((2, len(beds.rows), 2)), beds.contact_of_corners
    for end, cut in enumerate((leaves, comes)):
        ends[end, contact[cut]] = crossing[cut]
    # of triangles with a third corner in the middle of the contact
    middle = (beds.rows[:, 0] * np.repeat(opening, np.diff(beds.contact), axis=0)).sum(axis=1)
    area = np.bincount(contact, double) + cross_2d(*ends)
    volume = area * middle + np.bincount(
        contact, double * (np.minimum(gaps, 0.0) + np.minimum(next_gaps, 0.0))
    )
    per_area, contact_area = beds.line[:, 0] * np.sign(area), beds.contact_moments[:, 0, 0]
    # of lines
    push = np.bincount(contact, np.maximum(-gaps, 0.0))
    share, is_line = (
        push / np.maximum(np.bincount(contact, np.abs(gaps)), TINY),
        np.diff(beds.corner) == 2,
    )
    share = np.where(is_line, share, 0.5 * per_area * area / contact_area)
    return share, np.where(is_line, 0.5 * share * push * contact_area, -per_area * volume / 6.0)
