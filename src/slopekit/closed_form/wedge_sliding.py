"""How a wedge on two joints moves under a resultant, over arrays, also with passive bolts.

Sources: Warburton (1981) and Goodman & Shi (1985), ch. 9 (the mode from the resultant). Vectors are three arrays, east,
north and up, each (m,) or (k, m) where k planes or points are taken at once: an operation of NumPy on one wedge takes
half a microsecond, whatever it does.
"""

import math
from collections.abc import Sequence
from typing import Any, Final, NamedTuple, Protocol

import numpy as np

from slopekit.closed_form.given import Codes, Columns, Value
from slopekit.closed_form.tolerances import PULLS_SETTLED, SMALL, SQUARE
from slopekit.core.array_types import Bools, Floats

Vector = tuple[Value, Value, Value]
Bolt = tuple[float, float, float]

#: What may become of a wedge that the planes cut.
STATUSES: Final = (
    "slides_on_both", "slides_on_J1", "slides_on_J2", "slides_up", "lifted", "falls", "no_driving_force",
)  # fmt: skip
SLIDES_ON_J1, SLIDES_UP, LIFTED, FALLS, STILL = (
    np.int8(STATUSES.index(name)) for name in ("slides_on_J1", "slides_up", "lifted", "falls", "no_driving_force")
)
J1, J2 = 0, 1
_ROUNDS: Final = 40  # over several bolts, one after the other


class WedgeSlide(NamedTuple):
    """Outcomes; effective normal forces (2, m); what drives, what resists; the resultant along the movement."""

    outcome: Codes
    normal: Floats
    driving: Floats
    resisting: Floats
    movement: Vector


def of_one(values: Any, one: int) -> Any:
    """Of arrays (..., n), and of tuples of such, what one wedge has (..., 1)."""
    if isinstance(values, tuple):
        return tuple(of_one(part, one) for part in values)
    return values[..., one : one + 1]


class JointPair(NamedTuple):
    """The two joints (2, m): normals into the wedge, the line of intersection, n₁·n₂ and 1 - (n₁·n₂)², strength."""

    inward: Vector
    line: Vector
    between: Floats
    share: Floats
    bonds: Floats
    tangents: Floats
    size: Floats

    @property
    def lines(self) -> Vector:
        """The lines (1, m) along which it slides on several joints."""
        return self.line[0][None], self.line[1][None], self.line[2][None]

    def of(self, one: int) -> "JointPair":
        """One wedge's, (2, 1): for any number of loads."""
        return JointPair(*(of_one(values, one) for values in self))

    def slide(self, load: Vector) -> WedgeSlide:
        """Mode of sliding from the resultant: off both, along one, along both joints."""
        on = dot(load, self.inward)
        rest = on[::-1] - on * self.between
        alone, lost = (on < 0.0) & (rest >= 0.0), (on[0] >= 0.0) & (on[1] >= 0.0)
        along = dot(load, self.line)
        east, north, up = times(self.line, along)
        driving = np.abs(along)
        normal = rest[::-1] / -self.share
        held = self.bonds + normal * self.tangents
        resisting = held[0] + held[1]
        outcome = np.zeros(along.size, dtype=np.int8)
        others = np.flatnonzero(lost | alone[0] | alone[1])
        if others.size:
            joint, off = np.where(alone[0, others], J1, J2), lost[others]

            def of_joint(values: Floats) -> Floats:
                return np.broadcast_to(values, on.shape)[joint, others]

            carried = np.where(off, 0.0, -on[joint, others])
            force = [np.broadcast_to(part, along.shape)[others] for part in load]
            one, two, three = map(of_joint, self.inward)
            way = plus((force[0], force[1], force[2]), times((one, two, three), carried))
            for part, value in zip((east, north, up), way, strict=True):
                part[others] = value
            driving[others] = length(way)
            normal[:, others] = 0.0
            normal[joint, others] = carried
            resisting[others] = np.where(off, 0.0, of_joint(self.bonds) + carried * of_joint(self.tangents))
            outcome[others] = SLIDES_ON_J1 + joint
        outcome[up > 0.0] = SLIDES_UP
        if others.size:
            highest = np.broadcast_to(np.maximum(*self.inward[2]), along.shape)[others]
            outcome[others] = np.where(off, np.where(highest <= 0.0, FALLS, LIFTED), outcome[others])
        outcome[driving <= SMALL * self.size] = STILL
        return WedgeSlide(outcome, normal, driving, resisting, (east, north, up))


# -- passive bolts ------------------------------------------------------------------------------------


class WedgeJoints(Protocol):
    """The joints of one wedge: normals into it (k, 1), lines of several (l, 1), the size of its loads (1,)."""

    @property
    def inward(self) -> Vector: ...
    @property
    def lines(self) -> Vector: ...
    @property
    def size(self) -> Floats: ...
    def slide(self, load: Vector) -> WedgeSlide: ...


class Beds(WedgeJoints, Protocol):
    """The joints of many wedges."""

    def of(self, one: int) -> WedgeJoints: ...


def under_bolts(
    beds: Beds, load: Vector, columns: Columns, those: Bools, slide: WedgeSlide, factor: Floats
) -> None:  # fmt: skip
    """Put into `slide` and `factor` what passive bolts make of those wedges that something drives, one by one."""
    bolts = columns["passive_kn"]
    for one in np.flatnonzero(those & (slide.outcome != STILL) & bolts.any(axis=(1, 2))).tolist():
        alone = [float(np.broadcast_to(part, factor.size)[one]) for part in load]
        factor[one], last = with_bolts(beds.of(one), alone, bolts[one])
        slide.outcome[one], slide.normal[:, one] = last.outcome[0], last.normal[:, 0]
        slide.driving[one], slide.resisting[one] = last.driving[0], last.resisting[0]


def with_bolts(bed: WedgeJoints, load: Sequence[float], bolts: Sequence[Bolt]) -> tuple[float, WedgeSlide]:
    """The factor of one wedge with passive bolts, and how it slides at the first loss."""
    from slopekit.closed_form.search import loss_with_bolts, together  # a plain wedge has no bolts to look for

    bolts = together([(east, north, up) for east, north, up in bolts if east or north or up])

    def at(reduction: Floats) -> WedgeSlide:
        return bed.slide(_pulled(bed, load, bolts, reduction))

    def holds_at(reduction: Floats) -> tuple[Bools, Bools]:
        slide = at(reduction)
        lost = (slide.outcome == LIFTED) | (slide.outcome == FALLS)
        return (slide.outcome == STILL) | (~lost & (reduction * slide.resisting >= slide.driving)), lost

    east, north, up = (np.array([part]) for part in load)
    factor, reduction = loss_with_bolts(holds_at, bed.slide((east, north, up)).outcome[0] not in (LIFTED, FALLS))
    return factor, at(np.array([reduction]))


def _pulled(bed: WedgeJoints, load: Sequence[float], bolts: Sequence[Bolt], reduction: Floats) -> Vector:
    """The load under bolts that pull between 0 and λ (r,) times their capacity, so as to leave the least movement."""
    pulls = np.zeros((len(bolts), reduction.size))
    settled = np.zeros(reduction.size, dtype=np.bool_)

    def under(pulls: Floats) -> Vector:
        east, north, up = (
            part + np.add.reduce(axis[:, None] * pulls) for part, axis in zip(load, np.transpose(bolts), strict=True)
        )
        return east, north, up

    for _ in range(_ROUNDS):
        before = pulls.copy()
        total = under(pulls)
        for k, bolt in enumerate(bolts):
            others = less(total, times(bolt, pulls[k]))
            pulls[k] = _best_pull(bed, others, bolt, reduction)
            total = plus(others, times(bolt, pulls[k]))
        pulls[:, settled] = before[:, settled]
        settled |= (np.abs(pulls - before) <= PULLS_SETTLED * reduction).all(axis=0)
        if len(bolts) == 1 or settled.all():
            break
    return under(pulls)


def _best_pull(bed: WedgeJoints, load: Vector, bolt: Bolt, most: Floats) -> Floats:
    """The pull between 0 and `most` (r,) with which one bolt leaves the least movement.

    The movement along a bolt, R·b, rises with its pull p, in a straight line in each mode. Where it draws the bolt out
    even under `most`, that is the pull; where it pushes the bolt in, nothing; else what stops it in the mode that then
    is the wedge's: R·b = 0 for that of four p.
    """
    along, across = dot(bolt, bed.lines), dot(bolt, bed.inward)
    square, pull = dot(bolt, bolt), dot(load, bolt)
    several = 2 + len(along)
    tries = np.zeros((several + len(across) + 1, most.size))
    tries[1] = most
    tries[2:several] = -dot(load, bed.lines) / along  # on two joints
    tries[several:-1] = (dot(load, bed.inward) * across - pull) / (square - across * across)  # on one
    tries[-1] = -pull / square  # off all
    np.copyto(tries, 0.0, where=~((tries >= 0.0) & (tries <= most)))
    east, north, up = ((part + tries * way).ravel() for part, way in zip(load, bolt, strict=True))
    slide = bed.slide((east, north, up))
    drawn = np.where(slide.outcome == STILL, 0.0, dot(slide.movement, bolt)).reshape(tries.shape)
    stops = np.take_along_axis(tries[2:], np.argmin(np.abs(drawn[2:]), axis=0)[None], axis=0)[0]
    none = SQUARE * math.sqrt(square) * bed.size  # a bolt square to the movement presses with all it has
    return np.where(drawn[0] >= -none, 0.0, np.where(drawn[1] <= none, most, stops))


# -- vectors ------------------------------------------------------------------------------------------


def rows(vector: Vector, which: int | slice | list[int]) -> Vector:
    return vector[0][which], vector[1][which], vector[2][which]


def dot(a: Sequence[Value], b: Sequence[Value]) -> Value:
    product = a[0] * b[0]
    product = product + a[1] * b[1]
    product += a[2] * b[2]
    return product


def cross(a: Vector, b: Vector, into: Vector = (None, None, None)) -> Vector:
    east, north, up = (np.multiply(a[i], b[j], out=out) for i, j, out in zip((1, 2, 0), (2, 0, 1), into, strict=True))
    east -= a[2] * b[1]
    north -= a[0] * b[2]
    up -= a[1] * b[0]
    return east, north, up


def plus(a: Vector, b: Vector) -> Vector:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def less(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def times(a: Vector, by: Value) -> Vector:
    return a[0] * by, a[1] * by, a[2] * by


def length(a: Vector) -> Value:
    return np.sqrt(dot(a, a))
