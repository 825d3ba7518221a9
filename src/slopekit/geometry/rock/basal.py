"""A wedge on three joints: its planes in the local frame, and the block that they cut out of the rock.

Two joints and the face meet in the origin. The basal joint meets the trace of J1 on the face at a height above it: the
block lies above the basal joint, between the traces; where that height is below 0, it lies under the origin (a socket
wedge). J1 and J2 need not daylight: the basal joint does.
"""

import math
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from slopekit.core.arrays import Floats, cross, frozen
from slopekit.core.errors import Fault, GeometryError
from slopekit.core.orientation import number
from slopekit.geometry.rock.cutting import Block, half_spaces_cut
from slopekit.geometry.rock.rockmass import traces_of
from slopekit.geometry.tolerances import SAME_DIRECTION

J1, J2, BASAL, FACE, UPPER, CRACK = range(6)
PLANE_NAMES = ("J1", "J2", "basal", "face", "upper slope", "crack")
_NONE = 1e-12  # of the surface of the block: a face below it is none, as in `closed_form.basal`
_ON_PLANE = 1e-9  # of the largest distance: corners of the box about the block, which is a box with room to spare


@dataclass(frozen=True)
class BasalRockMass:
    """The planes of a wedge on three joints.

    Attributes
    ----------
    outward : plane id -> (3,) unit normal out of the block; offsets : plane id -> m; the block is normal · x <= offset
    line : (3,) unit vector along the intersection of J1 and J2, downward
    crest1, crest2 : (3,) where the traces of the joints on the face meet the crest
    basal_at : (3,) where the basal joint meets the trace of J1
    """

    outward: dict[int, Floats]
    offsets: dict[int, float]
    line: Floats
    crest1: Floats
    crest2: Floats
    basal_at: Floats


def basal_rock_mass(
    joints: Floats, face: Floats, upper: Floats, height: float, basal: Floats, basal_height: float,
    crack: Floats | None = None, distance: float = 0.0,
) -> BasalRockMass:  # fmt: skip
    """The planes of a wedge between two joints, above a basal joint, maybe before a tension crack.

    Parameters
    ----------
    joints : (2, 3); face, upper, basal, crack : (3,) upward unit normals
    height : vertical (m), from the origin to where the trace of J1 meets the crest
    basal_height : vertical (m), from the origin to where the basal joint meets the trace of J1; below 0 for a socket
    distance : of the crack from the crest along the trace of J1 on the upper slope (m)

    Raises
    ------
    GeometryError
        E206, E209 as for two joints; E434 J1 and J2 are parallel.
    """
    across = cross(joints[0], joints[1])
    if (sine := math.sqrt(float(across @ across))) < SAME_DIRECTION:
        degrees = math.degrees(math.asin(min(1.0, sine)))
        message = (
            f"J1 and J2 are parallel (to {degrees:.2g}°): they meet the face in no common point, over which the basal "
            "joint has its height"
        )
        advice = "Two joints of one set with a base between them: kind: plane on the base, per metre, or kind: bench."
        raise GeometryError([Fault("E434", message, "", advice)])
    line, crest1, crest2, offset = traces_of(joints, face, upper, height, daylights=False)
    at = crest1 * (basal_height / height)
    below = -1.0 if basal_height < 0.0 else 1.0
    sides = {
        J1: math.copysign(1.0, float(joints[0] @ crest2)) * below,
        J2: math.copysign(1.0, float(joints[1] @ crest1)) * below,
    }
    outward = {J1: -sides[J1] * joints[0], J2: -sides[J2] * joints[1], FACE: face, UPPER: upper, BASAL: -basal}
    offsets = {J1: 0.0, J2: 0.0, FACE: 0.0, UPPER: offset, BASAL: -float(basal @ at)}
    if crack is not None:
        trace = _behind(joints[0], upper, face)
        ahead = float(crack @ trace) * distance
        sign = 1.0 if ahead > 0.0 else -1.0  # the crest lies in front of it
        outward[CRACK], offsets[CRACK] = sign * crack, sign * (float(crack @ crest1) + ahead)
    down = line if line[2] < 0.0 else -line
    return BasalRockMass(outward, offsets, frozen(down), frozen(crest1), frozen(crest2), frozen(at))


def trace_behind(rock: BasalRockMass) -> Floats:
    """The unit vector (3,) along J1's trace on the upper slope, away from the crest."""
    return _behind(rock.outward[J1], rock.outward[UPPER], rock.outward[FACE])


def _behind(joint: Floats, upper: Floats, face: Floats) -> Floats:
    trace = cross(joint, upper)
    return trace / math.copysign(math.sqrt(float(trace @ trace)), -float(face @ trace))


def cut_basal_wedge(rock: BasalRockMass) -> Block:
    """The block on three joints, its faces by plane id.

    Raises
    ------
    GeometryError
        E441 nothing lies above the basal joint, E443 no closed block, E442 the block has no part of the face, E440 the
        basal joint does not bound it, E440 J1 or J2 does not, E207 the crack does not, E232 the block cannot leave.
    """
    for plane, name in ((J1, "J1"), (J2, "J2")):
        sine = cross(rock.outward[plane], rock.outward[BASAL])
        if math.sqrt(float(sine @ sine)) < SAME_DIRECTION:
            message = f"{name} is parallel to the basal joint: they cannot both bound a block"
            raise GeometryError([Fault("E440", message, "", "Give the basal joint another orientation.")])
    corners = _corners(rock)
    try:
        block = half_spaces_cut(rock.outward, rock.offsets, corners) if len(corners) else None
    except GeometryError:
        corners = corners[:0]
    if not len(corners):  # what has an end or not has a corner
        message = "between J1 and J2 no rock lies above the basal joint and below the ground"
        advice = "It passes over the crest: give it a lower height."
        raise GeometryError([Fault("E441", message, "", advice)])
    if block is None:
        message = "J1, J2 and the basal joint close no block: between them the rock goes on without end"
        advice = "A basal joint that rises into the slope more steeply than the upper slope, or a crack, closes it."
        raise GeometryError([Fault("E443", message, "", advice)])
    least = _NONE * sum(block.areas.values())
    missing = [plane for plane in rock.outward if block.areas.get(plane, 0.0) <= least]
    if FACE in missing:
        message = "the block above the basal joint has no part of the face: the basal joint does not daylight there"
        raise GeometryError([Fault("E442", message, "", "Give it a flatter dip, or another height.")])
    if BASAL in missing:
        message = "the basal joint misses the wedge: J1 and J2 alone bound it"
        raise GeometryError([Fault("E440", message, "", "Leave the basal joint out, or give it another height.")])
    for plane, name in ((J1, "J1"), (J2, "J2")):
        if plane in missing:
            message = f"{name} does not bound the block above the basal joint: it is cut off before"
            raise GeometryError([Fault("E440", message, "", "Give the basal joint another dip direction or height.")])
    if CRACK in missing:
        message = "the crack does not bound the block above the basal joint"
        advice = "It passes behind the block, or in front of it: leave it out or move it."
        raise GeometryError([Fault("E207", message, "", advice)])
    if not _leaves(rock, [plane for plane in (FACE, UPPER) if plane not in missing]):
        message = "the block cannot leave the slope: its joints let it move into the rock behind the crack alone"
        height = float(rock.basal_at[2])
        shown, meant = (number(float(f"{size:.6g}")) for size in (height, -height))
        advice = f"It lies under J1 and J2, as the height of the basal joint is {shown} m: was {meant} m meant?"
        raise GeometryError([Fault("E232", message, "", advice)])
    return block


def _leaves(rock: BasalRockMass, free: list[int]) -> bool:
    """Whether a movement that opens no joint the wrong way leads out of a free face of the block.

    The movements fill the cone n·s >= 0 of the normals into the block, whose edges are the lines of two joints.
    """
    inward = {plane: -rock.outward[plane] for plane in (J1, J2, BASAL)}
    for one, other, third in ((J1, J2, BASAL), (J1, BASAL, J2), (J2, BASAL, J1)):
        line = cross(inward[one], inward[other])
        edge = line * math.copysign(1.0, float(line @ inward[third]))
        if any(float(edge @ rock.outward[plane]) > SAME_DIRECTION for plane in free):
            return True
    return False


def _corners(rock: BasalRockMass) -> Floats:
    """The corners of the block (n, 3), with other points where they span no box: a box is all they are for."""
    normals, offsets = np.array(list(rock.outward.values())), np.array(list(rock.offsets.values()))
    vertices = []
    for planes in combinations(range(len(offsets)), 3):
        three = normals[list(planes)]
        if abs(float(np.linalg.det(three))) < SAME_DIRECTION**2:
            continue
        corner = np.linalg.solve(three, offsets[list(planes)])
        size = max(float(np.abs(corner).max()), float(np.abs(offsets).max()))
        if (normals @ corner - offsets <= _ON_PLANE * size).all():
            vertices.append(corner)
    corners = np.array(vertices)
    spans = len(vertices) > 3 and (np.ptp(corners, axis=0) > _ON_PLANE * np.abs(corners).max()).all()
    if spans or not vertices:
        return corners.reshape(-1, 3)
    size = float(np.abs([rock.crest1, rock.crest2, rock.basal_at, *vertices]).max())
    return np.concatenate([corners, corners[:1] - size, corners[:1] + size])  # it goes on without end
