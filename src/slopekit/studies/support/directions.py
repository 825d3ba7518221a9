"""The least force by the closed form: along a direction, and within limits of plunge.

The forces come from `forces`; each is put back into the closed form itself before it counts.
"""

import math
from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.core.errors import Notice
from slopekit.core.orientation import Line
from slopekit.core.records import dataclass
from slopekit.design.parts import Bolt
from slopekit.studies.support.forces import BoltedBlock, least_along, most_along
from slopekit.studies.support.search import Answer, SearchResult, Site, least_force

_CLOSER = 0.4  # what a grid of nine by nine closes in by
_ALL_ROUNDS, _GO_ON = 6, 2
_STARTS = 8
_SAME = 1e-9
_ROUNDING = 1e-12
_FLAT = 1e-9  # what rounding a direction may add to the least force
STEP_DEG = 5.0  # of trend and plunge as they are set out
INTO_FACE_DEG = 5.0  # the practical optimum points into the face by at least that
_SAMPLES = np.concatenate([[0.0], np.logspace(-4.0, 4.0, 33)])  # forces in parts of the loads, where none reaches
NO_STRENGTH = Notice(
    "E322", "the joints have no strength: a load can only balance the block, and passive bolts would hang it up alone"
)  # fmt: skip


def polished(
    force: Callable[[Floats], Floats], starts: Floats, lowest: Sequence[float], highest: Sequence[float]
) -> tuple[Floats, float] | None:
    """The least of a function of two angles within a box, from several starts, by grids that close in on the least.

    Parameters
    ----------
    force : (m, 2) angles to (m,) forces, inf where there is none
    starts : (s, 2)

    Returns
    -------
    angles (2,) and the force there, None where no start has one
    """
    bottom, top = np.array(lowest), np.array(highest)
    steps = np.stack(np.meshgrid(np.linspace(-1.0, 1.0, 9), np.linspace(-1.0, 1.0, 9)), axis=-1).reshape(-1, 2)
    best, reach, rounds = np.clip(starts, bottom, top), 2.0, 0
    while reach > 1e-9:
        tried = np.clip(best[:, None, :] + steps * reach, bottom, top)
        values = force(tried.reshape(-1, 2)).reshape(len(best), -1)
        least = values.argmin(axis=1)
        best = tried[np.arange(len(best)), least]
        reach, rounds = reach * _CLOSER, rounds + 1
        if rounds == _ALL_ROUNDS:  # the most promising go on
            best = best[np.argsort(values.min(axis=1))[:_GO_ON]]
    values = force(best)
    k = int(values.argmin())
    return (best[k], float(values[k])) if math.isfinite(values[k]) else None


@dataclass(frozen=True, slots=True)
class Way:
    """A direction and the least force along it, by the closed form.

    Attributes
    ----------
    direction : (3,) local axes, unit length in space
    force : kN, None where no force that way reaches the target; most : above it the factor falls below again
    answer : at that force; without one the best that the direction gives
    below : the factor just under the force, where it jumps over the target; None where it rises to it
    notice : why not, or what to know
    """

    direction: Floats
    force: float | None
    most: float
    answer: Answer
    below: float | None
    notice: Notice | None


class BoltDirections:
    """Directions of bolts that act one way, at one factor of safety.

    Parameters
    ----------
    factor : what the force shall give; passive : whether its capacity is divided by that factor
    """

    def __init__(self, site: Site, factor: float, passive: bool) -> None:
        self.site, self.factor, self.passive = site, factor, passive
        self.held: BoltedBlock = site.held(factor)
        self.times = factor if passive else 1.0
        self.acts: Literal["active", "passive"] = "passive" if passive else "active"

    def forces(self, world: Floats) -> Floats:
        """Least capacities (m,) along unit directions (m, 3) in east, north, up."""
        least = least_along(self.held, self.site.local(world), self.passive)
        capacities: Floats = least * self.times
        return capacities

    def ask(self, direction: Floats, force: float) -> Answer:
        """The closed form with that much more."""
        return self.site.closed_form(self.site.with_bolts(self.bolt(self.site.line(direction), force)))

    def bolt(self, line: Line, force: float) -> Bolt:
        """A bolt without a head."""
        return Bolt(force, line, self.acts)

    # -- the best direction -------------------------------------------------------------------------------

    def within(self, plunges: tuple[float, float], target: float, at_zero: Answer) -> Way | None:
        """The direction of the least force among those that plunge between limits (degrees) and point into the face."""
        if self._balances_only():
            return None
        low, high = plunges
        trends = np.arange(0.0, 360.0, 2.0)
        steps = np.linspace(low, high, 2 + int((high - low) / 2.0))
        grid = np.stack(np.meshgrid(trends, steps), axis=-1).reshape(-1, 2)
        scan = self._of_angles(grid)
        starts = grid[np.argsort(scan)[:_STARTS]]
        polish = polished(self._of_angles, starts, (-1e9, low), (1e9, high))
        if polish is None:
            return None
        best_way = self._put_back(*self._rounded(self._direction(polish[0]), polish[1]), target, at_zero)
        return None if best_way.force is None else best_way

    def drillable(self, plunges: tuple[float, float], target: float, at_zero: Answer) -> Way | None:
        """The best way within limits of plunge at angles that are set out: full steps of 5° beside the best of all.

        In a section the trend stays across the slope. Without such angles within the limits, or where no force along
        them reaches the target, it is the best way itself.
        """
        best_way = self.within(plunges, target, at_zero)
        if best_way is None:
            return None
        line = self.site.line(best_way.direction)
        trends, steps = ([math.floor(angle / STEP_DEG) * STEP_DEG, math.ceil(angle / STEP_DEG) * STEP_DEG]
                         for angle in (line.trend_deg, line.plunge_deg))  # fmt: skip
        trends = [line.trend_deg] if self.site.in_section else trends
        angles = np.array([
            [trend % 360.0, plunge] for trend in trends for plunge in steps if plunges[0] <= plunge <= plunges[1]
        ]).reshape(-1, 2)  # fmt: skip
        forces = self._of_angles(angles)
        if not np.isfinite(forces).any():
            return best_way
        least = int(forces.argmin())
        rounded = self._put_back(self._direction(angles[least]), float(forces[least]), target, at_zero)
        return best_way if rounded.force is None else rounded

    def _of_angles(self, angles: Floats) -> Floats:
        world = _vectors(angles)
        return np.where(self._into_face(world), self.forces(world), np.inf)

    def _into_face(self, world: Floats) -> Bools:
        into: Bools = world @ self.site.world(self.site.inward) >= math.sin(math.radians(INTO_FACE_DEG)) - _ROUNDING
        return into

    def _balances_only(self) -> bool:
        """Whether nothing has strength that could be divided by a factor: loads balance exactly, or not at all."""
        return not self.held.has_strength and len(self.held.pulls) == 0

    def _direction(self, angles: Floats) -> Floats:
        """Local axes; in a section the direction keeps its length in space."""
        direction: Floats = _vectors(angles[None, :])[0] @ self.site.axes.T
        return direction

    def _rounded(self, direction: Floats, force: float) -> tuple[Floats, float]:
        """A direction to a ten-thousandth of a degree with the least force along it, where that is as little."""
        line = self.site.line(direction)
        short = self._direction(np.array([round(line.trend_deg, 4) % 360.0, round(line.plunge_deg, 4)]))
        least = float(self.forces(self.site.world(short)[None, :])[0])
        return (short, least) if least <= force * (1.0 + _FLAT) else (direction, force)

    # -- one direction --------------------------------------------------------------------------------------

    def along(self, direction: Floats, target: float, at_zero: Answer) -> Way:
        """The least force along one direction (local axes)."""
        if self._balances_only():
            return Way(direction, None, math.inf, at_zero, None, NO_STRENGTH)
        force = float(self.forces(self.site.world(direction)[None, :])[0])
        if math.isfinite(force):
            way = self._put_back(direction, force, target, at_zero)
            if way.force is not None:
                return way
        return self._out_of_reach(direction, target, at_zero)

    def _put_back(self, direction: Floats, force: float, target: float, at_zero: Answer) -> Way:
        """The closed form at a force that the sets gave; where it says otherwise, its own root near by."""
        most = math.inf
        if not self.passive:
            most = most_along(self.held, self.site.local(self.site.world(direction)[None, :])[0], force)
        answer = self.ask(direction, force)
        if abs(answer.search_level / self.factor - 1.0) <= _SAME:
            return Way(direction, force, most, answer, None, None)
        root = least_force(
            lambda tried: self.ask(direction, tried),
            target,
            self.factor / target - 1.0,
            force,
            at_zero.search_level,
            most,
        )
        if root.force is None:
            return Way(direction, None, math.inf, root.answer, None, None)
        return self._found(direction, root, most)

    def _found(self, direction: Floats, root: SearchResult, most: float) -> Way:
        assert root.force is not None
        notice = None
        if root.below is not None:
            from_ = f"{root.below:.4g}" if root.below > 0.0 else "none (the block has no hold)"
            to = "no driving force" if math.isinf(root.answer.search_level) else f"{root.answer.search_level:.4g}"
            notice = Notice("E325", f"FoS jumps over the target at {root.force:.6g} {self.site.unit}, from {from_} to "
                            f"{to}: contact is won there. A little less force loses it: go above")  # fmt: skip
        return Way(direction, root.force, most, root.answer, root.below, notice)

    def _out_of_reach(self, direction: Floats, target: float, at_zero: Answer) -> Way:
        """The best that a direction gives, and what stands against more."""
        size, best, best_force = self.held.size, at_zero, 0.0
        answers = [at_zero] + [self.ask(direction, share * size) for share in _SAMPLES[1:]]
        for share, answer in zip(_SAMPLES, answers, strict=True):
            if answer.search_level > best.search_level:
                best, best_force = answer, share * size
        enough = next((k for k, answer in enumerate(answers) if answer.reaches(target)), None)
        if enough is not None:  # where bolts pull in part, the sets do not have it
            root = least_force(
                lambda tried: self.ask(direction, tried), target, self.factor / target - 1.0,
                float(_SAMPLES[enough]) * size, at_zero.search_level, math.inf,
            )  # fmt: skip
            if root.force is not None:
                return self._found(direction, root, math.inf)
        unit, shown = self.site.unit, f"{best.search_level:.4g}"
        level = [answer.level for answer in answers]
        gained = best.search_level > at_zero.search_level * (1.0 + _SAME)
        last = answers[-1].status
        if self.passive:
            why = (
                "the movement does not draw them out: they add nothing"
                if not gained
                else f"they pull no more than stops the movement along them: at best FoS {shown}"
            )
            return Way(direction, None, math.inf, best, None, Notice("E322", why))
        if not gained:
            why = "force that way drives the block, or lifts it, as much as it holds it: it adds nothing"
        elif best_force >= _SAMPLES[-2] * size:
            why = f"force that way adds to what drives as to what holds: FoS tends to {shown}, however strong"
        else:
            why = f"at best FoS {shown} at {best_force:.4g} {unit}; more force lowers it again"
        if last in ("lifted", "falls") and level[-1] == 0.0:
            why += ", and in the end lifts the block off"
        return Way(direction, None, math.inf, best, None, Notice("E322", why))


def _angles(world: Floats) -> Floats:
    """Trend and plunge (m, 2) of unit vectors, degrees."""
    trend = np.degrees(np.arctan2(world[:, 0], world[:, 1]))
    return np.stack([trend, -np.degrees(np.arcsin(np.clip(world[:, 2], -1.0, 1.0)))], axis=1)


def _vectors(angles: Floats) -> Floats:
    trend, plunge = np.radians(angles[:, 0]), np.radians(angles[:, 1])
    flat = np.cos(plunge)
    return np.stack([np.sin(trend) * flat, np.cos(trend) * flat, -np.sin(plunge)], axis=1)
