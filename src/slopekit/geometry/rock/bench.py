"""The rock mass of a bench: a convex body between the face, the upper slope and where the model ends."""

import math
from dataclasses import dataclass

import numpy as np

from slopekit.core.arrays import Bools, Floats, frozen
from slopekit.core.errors import Fault, GeometryError
from slopekit.geometry.tolerances import FLATTEST_FACE_DEG, SAME_DIP_DEG

#: The faces of a bench in the order of its planes.
BODY_FACES = ("face", "upper slope", "left end", "right end", "back", "bottom")


@dataclass(frozen=True)
class ConvexBody:
    """A convex body to cut into blocks: the points with `normals · x <= offsets`.

    Attributes
    ----------
    normals : (k, 3) unit, out of the body; offsets : (k,) m
    is_far : (k,) faces behind which the rock goes on: blocks that reach them are bedrock
    corners : (c, 3) m
    """

    normals: Floats
    offsets: Floats
    is_far: Bools
    corners: Floats

    @property
    def size(self) -> float:
        """The longest side of the box about the body, m."""
        return float(np.ptp(self.corners, axis=0).max())


def bench_body(
    face: Floats, upper: Floats, height: float, length: float, depth: float
) -> ConvexBody:
    """Return the convex body of a bench, whose toe runs along the strike of the face through the origin.

    In the middle of the bench the crest is `height` above the toe; the upper slope passes through it in any
    direction. The back stands upright and along the strike, `depth` behind the crest; the ends stand square to the
    strike. Ends, back and bottom (the level of the toe) are far: the rock goes on behind them.

    Parameters
    ----------
    face, upper : (3,) upward unit normals
    height, length, depth : m

    Returns
    -------
    ConvexBody
        Its planes in the order of `BODY_FACES`, its 8 corners: toe, crest, back and bottom of the back at the left
        end (seen from the air), then at the right end.

    Raises
    ------
    GeometryError
        E221 the face is nearly flat, E209 the upper slope makes no crest with it or falls below the toe.

    Examples
    --------
    >>> body = bench_body(np.array([0.0, -1.0, 0.0]), np.array([0.0, 0.0, 1.0]), 10.0, 30.0, 20.0)
    >>> np.ptp(body.corners, axis=0).tolist()
    [30.0, 20.0, 10.0]
    """
    horizontal = math.hypot(face[0], face[1])
    face_dip = math.degrees(math.atan2(horizontal, face[2]))
    if face_dip < FLATTEST_FACE_DEG:
        message = (
            f"the face dips {face_dip:.3g}°, less than {FLATTEST_FACE_DEG:g}°: this is no bench"
        )
        raise GeometryError([Fault("E221", message)])
    outward = np.array([face[0], face[1], 0.0]) / horizontal
    strike = np.array([-outward[1], outward[0], 0.0])  # to the right, seen from the air
    up = np.array([0.0, 0.0, 1.0])
    crest = up * height - outward * (height * max(face[2], 0.0) / horizontal)
    back_offset = depth - float(crest @ outward)
    normals = np.array([face, upper, -strike, strike, -outward, -up])
    offsets = np.array([0.0, float(upper @ crest), length / 2.0, length / 2.0, back_offset, 0.0])
    _check_upper(face_dip, outward, upper)
    corners = []
    for end, side in ((2, -strike), (3, strike)):
        toe = side * (length / 2.0)
        tops = [
            np.linalg.solve(normals[[first, 1, end]], offsets[[first, 1, end]]) for first in (0, 4)
        ]
        corners += [toe, *tops, toe - outward * back_offset]
        for name, top in zip(("crest", "top of the back"), tops, strict=True):
            if top[2] <= 1e-6 * height:
                message = (
                    f"the upper slope falls to {top[2]:.4g} m at the {BODY_FACES[end]} "
                    f"({name}), not above the toe"
                )
                raise GeometryError(
                    [Fault("E209", message, "", "Take a shorter or less deep bench.")]
                )
    return ConvexBody(
        frozen(normals),
        frozen(offsets),
        np.array([False, False, True, True, True, True]),
        frozen(corners),
    )


def _check_upper(face_dip: float, outward: Floats, upper: Floats) -> None:
    """Refuse an upper slope that is upright or, toward the face's dip direction, as steep as the face."""
    if upper[2] < math.sin(math.radians(SAME_DIP_DEG)):
        raise GeometryError(
            [Fault("E209", "the upper slope stands upright or overhangs: it is no upper slope")]
        )
    apparent = math.degrees(math.atan2(float(upper @ outward), upper[2]))
    if apparent > face_dip - SAME_DIP_DEG:
        message = (
            f"the upper slope falls at {apparent:.4g}° toward the face, which dips "
            f"{face_dip:.4g}°: they make no crest"
        )
        raise GeometryError(
            [Fault("E209", message, "", "The upper slope has to be flatter than the face.")]
        )
