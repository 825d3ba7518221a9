"""The sliding mode of a wedge on two joints under a resultant force, over arrays, also with passive bolts.

Sources: Warburton (1981) and Goodman & Shi (1985), ch. 9 (the mode from the resultant). Vectors are three arrays, east,
north and up, each (m,) or (k, m) where k planes or points are taken at once: an operation of NumPy on one wedge takes
half a microsecond, whatever it does.
"""

import math
from collections.abc import Sequence
from typing import Any, Final, NamedTuple, Protocol

import numpy as np

from slopekit.closed_form.inputs import Codes, Columns, Value
from slopekit.closed_form.tolerances import PULLS_SETTLED, SMALL, SQUARE
from slopekit.core.array_types import Bools, Floats

Vector = tuple[Value, Value, Value]
Bolt = tuple[float, float, float]

#: Outcomes of a wedge that the planes form.
STATUSES: Final = (
    "slides_on_both",
    "slides_on_J1",
    "slides_on_J2",
    "slides_up",
    "lifted",
    "falls",
    "no_driving_force",
)
SLIDES_ON_J1, SLIDES_UP, LIFTED, FALLS, NO_DRIVING_FORCE = (
    np.int8(STATUSES.index(name))
    for name in ("slides_on_J1", "slides_up", "lifted", "falls", "no_driving_force")
)
J1, J2 = 0, 1
_ROUNDS: Final = 40  # over several bolts, one after the other


class WedgeSlide(NamedTuple):
    """Outcomes (m,), effective normal forces (2, m), driving and resisting forces (m,), resultant of the movement."""

    outcome: Codes
    normal: Floats
    driving: Floats
    resisting: Floats
    movement: Vector


def single_wedge(values: Any, number: int) -> Any:
    """Return the values (..., 1) of one wedge from arrays (..., n), or from tuples of them."""
    if isinstance(values, tuple):
        return tuple(single_wedge(component, number) for component in values)
    return values[..., number : number + 1]


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
        """The line (1, m) along which the wedge slides on both joints."""
        return self.line[0][None], self.line[1][None], self.line[2][None]

    def single(self, number: int) -> "JointPair":
        """Return the joints of one wedge, (2, 1), for any number of loads."""
        return JointPair(*(single_wedge(values, number) for values in self))

    def slide(self, load: Vector) -> WedgeSlide:
        """Return the mode of sliding under a resultant: off both, along one, or along both joints."""
        normal_load = dot(load, self.inward)
        remaining = normal_load[::-1] - normal_load * self.between
        on_single_joint, no_contact = (
            (normal_load < 0.0) & (remaining >= 0.0),
            (normal_load[0] >= 0.0) & (normal_load[1] >= 0.0),
        )
        along = dot(load, self.line)
        east, north, up = times(self.line, along)
        driving = np.abs(along)
        normal = remaining[::-1] / -self.share
        strength = self.bonds + normal * self.tangents
        resisting = strength[0] + strength[1]
        outcome = np.zeros(along.size, dtype=np.int8)
        not_on_both = np.flatnonzero(no_contact | on_single_joint[0] | on_single_joint[1])
        if not_on_both.size:
            joint, is_off = (
                np.where(on_single_joint[0, not_on_both], J1, J2),
                no_contact[not_on_both],
            )

            def joint_values(values: Floats) -> Floats:
                return np.broadcast_to(values, normal_load.shape)[joint, not_on_both]

            normal_force = np.where(is_off, 0.0, -normal_load[joint, not_on_both])
            force = [np.broadcast_to(component, along.shape)[not_on_both] for component in load]
            inward_east, inward_north, inward_up = map(joint_values, self.inward)
            movement = plus(
                (force[0], force[1], force[2]),
                times((inward_east, inward_north, inward_up), normal_force),
            )
            for component, value in zip((east, north, up), movement, strict=True):
                component[not_on_both] = value
            driving[not_on_both] = length(movement)
            normal[:, not_on_both] = 0.0
            normal[joint, not_on_both] = normal_force
            resisting[not_on_both] = np.where(
                is_off, 0.0, joint_values(self.bonds) + normal_force * joint_values(self.tangents)
            )
            outcome[not_on_both] = SLIDES_ON_J1 + joint
        outcome[up > 0.0] = SLIDES_UP
        if not_on_both.size:
            highest = np.broadcast_to(np.maximum(*self.inward[2]), along.shape)[not_on_both]
            outcome[not_on_both] = np.where(
                is_off, np.where(highest <= 0.0, FALLS, LIFTED), outcome[not_on_both]
            )
        outcome[driving <= SMALL * self.size] = NO_DRIVING_FORCE
        return WedgeSlide(outcome, normal, driving, resisting, (east, north, up))


# -- passive bolts ------------------------------------------------------------------------------------


class WedgeJoints(Protocol):
    """The joints of one wedge: normals into it (k, 1), lines of intersection (l, 1), size of its loads (1,)."""

    @property
    def inward(self) -> Vector: ...
    @property
    def lines(self) -> Vector: ...
    @property
    def size(self) -> Floats: ...
    def slide(self, load: Vector) -> WedgeSlide: ...


class WedgesJoints(WedgeJoints, Protocol):
    """The joints of many wedges."""

    def single(self, number: int) -> WedgeJoints: ...


def apply_passive_bolts(
    joints: WedgesJoints,
    load: Vector,
    columns: Columns,
    is_formed: Bools,
    slide: WedgeSlide,
    factor: Floats,
) -> None:
    """Update `slide` and `factor` in place for the wedges with passive bolts and a driving force, one by one."""
    bolts = columns["passive_kn"]
    for number in np.flatnonzero(
        is_formed & (slide.outcome != NO_DRIVING_FORCE) & bolts.any(axis=(1, 2))
    ).tolist():
        wedge_load = [float(np.broadcast_to(component, factor.size)[number]) for component in load]
        factor[number], first_loss = factor_with_bolts(
            joints.single(number), wedge_load, bolts[number]
        )
        slide.outcome[number], slide.normal[:, number] = (
            first_loss.outcome[0],
            first_loss.normal[:, 0],
        )
        slide.driving[number], slide.resisting[number] = (
            first_loss.driving[0],
            first_loss.resisting[0],
        )


def factor_with_bolts(
    joints: WedgeJoints, load: Sequence[float], bolts: Sequence[Bolt]
) -> tuple[float, WedgeSlide]:
    """Return the factor of safety of one wedge with passive bolts, and its sliding mode at the first loss."""
    from slopekit.closed_form.search import (
        loss_with_bolts,
        merged_bolts,
    )  # a plain wedge has no bolts to look for

    bolts = merged_bolts([(east, north, up) for east, north, up in bolts if east or north or up])

    def slide_at(reduction: Floats) -> WedgeSlide:
        return joints.slide(_load_with_pulls(joints, load, bolts, reduction))

    def evaluate(reduction: Floats) -> tuple[Bools, Bools]:
        slide = slide_at(reduction)
        no_contact = (slide.outcome == LIFTED) | (slide.outcome == FALLS)
        return (slide.outcome == NO_DRIVING_FORCE) | (
            ~no_contact & (reduction * slide.resisting >= slide.driving)
        ), no_contact

    east, north, up = (np.array([component]) for component in load)
    factor, reduction = loss_with_bolts(
        evaluate, joints.slide((east, north, up)).outcome[0] not in (LIFTED, FALLS)
    )
    return factor, slide_at(np.array([reduction]))


def _load_with_pulls(
    joints: WedgeJoints, load: Sequence[float], bolts: Sequence[Bolt], reduction: Floats
) -> Vector:
    """Return the load with bolts that pull between 0 and λ (r,) times their capacity, for the least movement."""
    pulls = np.zeros((len(bolts), reduction.size))
    settled = np.zeros(reduction.size, dtype=np.bool_)

    def load_under(pulls: Floats) -> Vector:
        east, north, up = (
            component + np.add.reduce(axis[:, None] * pulls)
            for component, axis in zip(load, np.transpose(bolts), strict=True)
        )
        return east, north, up

    for _ in range(_ROUNDS):
        previous = pulls.copy()
        total = load_under(pulls)
        for k, bolt in enumerate(bolts):
            other_load = less(total, times(bolt, pulls[k]))
            pulls[k] = _best_pull(joints, other_load, bolt, reduction)
            total = plus(other_load, times(bolt, pulls[k]))
        pulls[:, settled] = previous[:, settled]
        settled |= (np.abs(pulls - previous) <= PULLS_SETTLED * reduction).all(axis=0)
        if len(bolts) == 1 or settled.all():
            break
    return load_under(pulls)


def _best_pull(joints: WedgeJoints, load: Vector, bolt: Bolt, capacity: Floats) -> Floats:
    """Return the pull between 0 and `capacity` (r,) with which one bolt leaves the least movement.

    The movement along a bolt, R·b, rises with its pull p, linearly in each mode. If it extends the bolt even at full
    capacity, that is the pull; if it shortens the bolt, the pull is 0; else the pull stops the movement along the bolt,
    R·b = 0, in the mode of the wedge: one of four candidates.
    """
    along, across = dot(bolt, joints.lines), dot(bolt, joints.inward)
    square, pull = dot(bolt, bolt), dot(load, bolt)
    line_end = 2 + len(along)
    tries = np.zeros((line_end + len(across) + 1, capacity.size))
    tries[1] = capacity
    tries[2:line_end] = -dot(load, joints.lines) / along  # on two joints
    tries[line_end:-1] = (dot(load, joints.inward) * across - pull) / (
        square - across * across
    )  # on one
    tries[-1] = -pull / square  # off all
    np.copyto(tries, 0.0, where=~((tries >= 0.0) & (tries <= capacity)))
    east, north, up = (
        (component + tries * direction).ravel()
        for component, direction in zip(load, bolt, strict=True)
    )
    slide = joints.slide((east, north, up))
    extension = np.where(slide.outcome == NO_DRIVING_FORCE, 0.0, dot(slide.movement, bolt)).reshape(
        tries.shape
    )
    stopping_pull = np.take_along_axis(
        tries[2:], np.argmin(np.abs(extension[2:]), axis=0)[None], axis=0
    )[0]
    tolerance = (
        SQUARE * math.sqrt(square) * joints.size
    )  # a bolt square to the movement presses with all it has
    return np.where(
        extension[0] >= -tolerance,
        0.0,
        np.where(extension[1] <= tolerance, capacity, stopping_pull),
    )


# -- vectors ------------------------------------------------------------------------------------------


def rows(vector: Vector, index: int | slice | list[int]) -> Vector:
    return vector[0][index], vector[1][index], vector[2][index]


def dot(a: Sequence[Value], b: Sequence[Value]) -> Value:
    product = a[0] * b[0]
    product = product + a[1] * b[1]
    product += a[2] * b[2]
    return product


def cross(a: Vector, b: Vector, into: Vector = (None, None, None)) -> Vector:
    east, north, up = (
        np.multiply(a[i], b[j], out=buffer)
        for i, j, buffer in zip((1, 2, 0), (2, 0, 1), into, strict=True)
    )
    east -= a[2] * b[1]
    north -= a[0] * b[2]
    up -= a[1] * b[0]
    return east, north, up


def plus(a: Vector, b: Vector) -> Vector:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def less(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def times(a: Vector, factor: Value) -> Vector:
    return a[0] * factor, a[1] * factor, a[2] * factor


def length(a: Vector) -> Value:
    return np.sqrt(dot(a, a))
