"""The least force at which a method gives a wanted factor of safety: any method, asked as a black box.

The site is the design as support sees it: what holds its block, its face, and both methods asked with more load on it.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.errors import DesignError, Fault
from slopekit.core.orientation import Line, line_of
from slopekit.core.records import dataclass
from slopekit.design.common import Design
from slopekit.design.parts import Bolt, Force
from slopekit.geometry.rock.cutting import Block
from slopekit.kinds import factors_of, kind_of
from slopekit.kinds.protocol import Factors
from slopekit.loads import Hull
from slopekit.preie.one_block.passes import Outcome
from slopekit.preie.system.model import Model
from slopekit.studies.points import UNSETTLED
from slopekit.studies.support.forces import BoltedBlock

#: Forces aim above the target by this part, so that rounding leaves none below it ...
AIM = 2e-8
#: ... and the root of PRE-IE lies above it by at most twice this part.
WITHIN = 1.5e-7
_OUTCOMES = {
    Outcome.NO_DRIVING_FORCE: "no_driving_force", Outcome.LIFTED: "lifted", Outcome.NOT_CONVERGED: "not_converged",
}  # fmt: skip
_SAME_WAY = 1e-12  # 1 - cosine of bolts that pull one way
_DOWN = (1.0 - 1e-6, 0.999, 0.97, 0.85, 0.6, 0.3, 0.1, 0.01)
_UP = (1.0 + 1e-6, 1.003, 1.03, 1.12, 1.3, 1.7, 2.5, 4.0, 7.0, 12.0)
_SHARES = (0.01, 0.1, 0.3, 0.6, 0.9)  # of the range of forces that the closed form allows
_MOST_HALVED = 6  # times, where too much force was tried and the factor has fallen
_MOST_ASKED = 24
_NARROW = 1e-10  # a bracket this narrow (in parts of the force) in which the factor still changes is a jump ...
_LEAP, _LEAPS_WITHIN = 1.05, 1e-3  # ... and one this narrow in which it changes that much


@dataclass(frozen=True, slots=True)
class Answer:
    """What one method says: factor of safety (None: none), and the status."""

    factor: float | None
    status: str
    moments_govern: bool = False
    agree: bool | None = None

    @property
    def level(self) -> float | None:
        """The factor: 0 where the block falls, inf where nothing drives it; None without convergence."""
        if self.factor is not None:
            return self.factor
        if self.status == UNSETTLED:
            return None
        return math.inf if self.status == "no_driving_force" else 0.0

    @property
    def search_level(self) -> float:
        """The level for a search, which goes on past a force without an answer as past one that is too small."""
        return self.level or 0.0

    def reaches(self, target: float) -> bool:
        """Whether there is an answer, and it is a target or more.

        >>> Answer(1.5, "slides").reaches(1.5), Answer(None, "no_driving_force").reaches(1.5)
        (True, True)
        >>> Answer(None, "not_converged").reaches(0.0), Answer(None, "falls").reaches(1.5)
        (False, False)
        """
        level = self.level
        return level is not None and level >= target


@dataclass(frozen=True, slots=True)
class Site:
    """A wedge or a plane failure that support is looked for.

    Attributes
    ----------
    design : as it stands
    block : in local axes, m; face : (k, 3) its free face, anticlockwise from outside; area : m² of that (a plane's: per
        metre); joints : faces of the block that rock lies behind
    inward : (3,) unit normal of the face into the rock, local axes
    axes : (3, 3) rows are the local axes, in east, north, up; origin : (3,) m of the local origin
    in_section : what acts along the slope is left out, forces are per metre of slope
    model : PRE-IE's, of the design as it stands; closed_form : asks that of a changed design
    outward : face of the block -> (3,) its unit normal; hull : the planes that bolts meet
    """

    design: Design
    block: Block
    face: Floats
    area: float
    joints: tuple[int, ...]
    inward: Floats
    axes: Floats
    origin: Floats
    in_section: bool
    model: Model
    closed_form: Callable[[Design], Answer]
    outward: Mapping[int, Floats]
    hull: Hull

    @property
    def unit(self) -> str:
        """What forces are counted in."""
        return "kN/m" if self.in_section else "kN"

    def local(self, vectors: Floats) -> Floats:
        """Vectors (..., 3) in east, north, up as the block takes them: in a section without their part along it."""
        turned: Floats = vectors @ self.axes.T
        if self.in_section:
            turned[..., 1] = 0.0
        return turned

    def world(self, vectors: Floats) -> Floats:
        """Vectors (..., 3) in local axes as east, north, up."""
        turned: Floats = vectors @ self.axes
        return turned

    def held(self, factor: float) -> BoltedBlock:
        """What holds the block at a factor."""
        model, most = self.model, self.model.translations
        scale = model.force_scale
        normals, first = np.unique(model.interface, return_index=True)
        bonds = np.array([model.cohesion[model.interface == joint].sum() for joint in normals]) * scale
        load = self._spread(model.load[:most]) * scale
        pulls = self._spread(model.bolt_rows[:, :most]) * (model.bolt_capacity * scale)[:, None]
        size = scale + float(model.bolt_capacity.sum()) * scale
        return BoltedBlock(
            load, self._spread(model.rows[first, 0, :most]), bonds, model.tan_friction[first],
            _by_direction(pulls / factor), factor, size,
        )  # fmt: skip

    def _spread(self, rows: Floats) -> Floats:
        if not self.in_section:
            return np.array(rows[..., :3])
        out = np.zeros((*rows.shape[:-1], 3))
        out[..., [0, 2]] = rows[..., :2]
        return out

    def with_bolts(self, *bolts: Bolt) -> Design:
        """The design with more bolts."""
        return replace(self.design, bolts=(*self.design.bolts, *bolts))

    def with_force(self, force: Floats, at: Floats) -> Design:
        """The design with one more force (3,) kN, through a point (3,) in local axes."""
        east, north, up = (float(part) for part in self.world(force))
        return replace(self.design, forces=(*self.design.forces, Force((east, north, up), self.place(at))))

    def place(self, point: Floats) -> tuple[float, float, float]:
        """A point in local axes in the coordinates of the user."""
        east, north, up = (float(part) for part in self.world(point) + self.origin)
        return east, north, up

    def line(self, direction: Floats) -> Line:
        """A direction in local axes as trend and plunge, to the last digits that mean something."""
        line = line_of(direction @ self.axes)
        return Line(round(line.trend_deg, 12) % 360.0, round(line.plunge_deg, 12) + 0.0)


def pre_ie(design: Design) -> Answer:
    """PRE-IE's answer to a design."""
    return limit_answer(factors_of(design))


def limit_answer(factors: Factors) -> Answer:
    """PRE-IE's answer among the factors of a design: none where it did not settle."""
    unsettled = factors.limit is None and not factors.settled
    status = UNSETTLED if unsettled else factors.status
    return Answer(factors.limit, status, factors.moments_govern, factors.agree)


def closed_form_answer(factors: Factors) -> Answer | None:
    """The closed form's answer among the factors of a design, None where it does not take the design."""
    if factors.closed_form is None and not factors.closed_status:
        return None
    return Answer(factors.closed_form, factors.closed_status or factors.status)


def site_of(design: Design) -> Site:
    """The site of a wedge or a plane.

    Raises
    ------
    DesignError
        E288 for other kinds, and for curved strength.
    GeometryError
        Where no block can be formed.
    """
    kind = kind_of(design)
    if kind.on_arrays is None or kind.closed_form is None:
        message = f"support is for a wedge or a plane, this design is of kind {design.kind}"
        advice = (
            f"A design of kind {design.kind} takes no bolts."
            if "support" in type(design).WITHOUT
            else "Give the design a bolt, then sweep and solve change it: slopekit solve my.yaml "
            "support.bolts.0.force --fos 1.5"
        )
        raise DesignError([Fault("E288", message, "", advice)])
    if any(strength.law for strength in kind.strengths(design)):
        message = "support takes Mohr-Coulomb strength: the directions it compares have one c and φ a joint"
        advice = "Give the design a bolt, then solve changes it: slopekit solve my.yaml support.bolts.0.force --fos 1.5"
        raise DesignError([Fault("E288", message, "", advice)])
    made, asked = kind.cut(design), kind.closed_form
    assert made.hull is not None
    model, block = made.scene_at(0).model, made.block

    def closed_form(changed: Design) -> Answer:
        answer = asked(changed)
        return Answer(answer.factor or None, answer.status)

    return Site(
        design, block, block.faces[made.face], block.areas[made.face], made.joints, -_outward(block.faces[made.face]),
        np.eye(3) if made.axes is None else made.axes, made.origin, model.translations == 2, model, closed_form,
        {plane: _outward(polygon) for plane, polygon in block.faces.items()}, made.hull(),
    )  # fmt: skip


def _outward(polygon: Floats) -> Floats:
    normal = np.cross(polygon[1] - polygon[0], polygon[2] - polygon[0])
    unit: Floats = normal / math.sqrt(float(normal @ normal))
    return unit


def _by_direction(pulls: Floats) -> Floats:
    """Pulls (b, 3) with those of one direction added up."""
    groups: list[Floats] = []
    for pull in pulls:
        size = math.sqrt(float(pull @ pull))
        for k, group in enumerate(groups):
            if float(group @ pull) >= (1.0 - _SAME_WAY) * size * math.sqrt(float(group @ group)):
                groups[k] = group + pull
                break
        else:
            groups.append(pull)
    return np.reshape(groups, (-1, 3))


@dataclass(frozen=True, slots=True)
class SearchResult:
    """What a search found.

    Attributes
    ----------
    force : None where no force that was tried reaches the target; answer : at that force, else the best that was met
    best_force : of that answer
    below : the level just under the force where the factor jumps over the target, None where it rises to it
    slope : change of the level with the force there, per kN; None where it is not known
    """

    force: float | None
    answer: Answer
    best_force: float
    below: float | None
    slope: float | None


def least_force(
    ask: Callable[[float], Answer], target: float, within: float, guess: float, at_zero: float, most: float,
    slope: float | None = None, upward: Sequence[float] | None = None,
) -> SearchResult:  # fmt: skip
    """The least force near a guess that gives a level of `target` to `target (1 + 2 within)`.

    Parameters
    ----------
    ask : force to answer
    guess : where to begin; most : a force that is not passed (inf: none)
    at_zero : the level without the force, less than the target
    slope : change of the level with the force, per kN, near the guess; None where it is not known
    upward : forces to try where the guess is not enough; None for a choice of them
    """
    tried: dict[float, Answer] = {}

    def level(force: float) -> float:
        if force not in tried:
            tried[force] = ask(force)
        return tried[force].search_level

    def met(force: float) -> bool:
        return target <= level(force) <= target * (1.0 + 2.0 * within)

    def found(force: float, below: float | None = None) -> SearchResult:
        others = [other for other in tried if other != force and 0.0 < level(other) < math.inf]
        near = min(others, key=lambda other: abs(other - force), default=0.0)
        other = level(near) if near else at_zero
        rate = (level(force) - other) / (force - near) if force != near and math.isfinite(level(force)) else None
        return SearchResult(force, tried[force], force, below, rate if rate and rate > 0.0 else slope)

    def rising(low: float, fallen: float) -> tuple[float, float]:
        """Return forces below and at the target before the level falls; the second is inf where it rises to less."""
        for _ in range(_MOST_HALVED):
            middle = 0.5 * (low + fallen)
            if level(middle) >= target:
                return low, middle
            low, fallen = (middle, fallen) if level(middle) > level(low) else (low, middle)
        return low, math.inf

    low, high = 0.0, math.inf
    if met(guess):
        return found(guess)
    if level(guess) >= target:
        high = guess
        for force in _downward(guess, level(guess), target, slope):
            if level(force) < target:
                low = force
                break
            high = force
    else:
        low = guess
        for force in _upward(guess, level(guess), at_zero, target, most, slope) if upward is None else upward:
            if level(force) >= target:
                high = force
            elif level(force) < level(low):
                low, high = rising(low, force)
            if math.isfinite(high):
                break
            low = force
    if not math.isfinite(high):
        best = max(tried, key=level)
        return SearchResult(None, tried[best], best, None, None)
    aim = target * (1.0 + within)
    ends = [(low, _height(level(low) if low else at_zero, aim)), (high, _height(level(high), aim))]
    path = sorted(ends, key=lambda end: -abs(end[1]))  # what was tried, the latest last
    while not met(high) and high - low > _NARROW * high and len(tried) < _MOST_ASKED:
        if high - low <= _LEAPS_WITHIN * high and level(high) > _LEAP * (level(low) if low else at_zero):
            break
        (one, before), (two, last) = path[-2:]
        middle = two - last * (two - one) / (last - before) if math.isfinite(last - before) and last != before else 0.0
        slow = len(path) > 3 and abs(last) > 0.5 * abs(path[-3][1])
        if slow or not low < middle < high:
            middle = 0.5 * (low + high)
        path.append((middle, _height(level(middle), aim)))
        if level(middle) < target:
            low = middle
        else:
            high = middle
    return found(high, None if met(high) else level(low) if low else at_zero)


def _downward(guess: float, level: float, target: float, slope: float | None) -> list[float]:
    """Forces below a guess to try in turn."""
    forces = [guess * share for share in _DOWN]
    straight = guess - 1.05 * (level - target) / slope if slope and math.isfinite(level) else 0.0
    if not 0.0 < straight < guess:
        return forces
    return [straight, *(force for force in forces if force < 0.99 * straight)]


def _upward(guess: float, level: float, at_zero: float, target: float, most: float, slope: float | None) -> list[float]:
    """Forces above a guess to try in turn: where a straight line leads, then further and further."""
    forces = [guess * factor for factor in _UP]
    straight = 0.0
    if slope:
        straight = guess + 1.05 * (target - level) / slope
    elif level > at_zero and math.isfinite(level):
        straight = guess + 1.05 * guess * (target - level) / (level - at_zero)
    if straight > guess:
        forces = [straight, *(force for force in forces if force > 1.01 * straight)]
    if not math.isfinite(most):
        return forces
    return sorted({force for force in forces if force < most} | {guess + share * (most - guess) for share in _SHARES})


def _height(level: float, aim: float) -> float:
    return math.log(level / aim) if 0.0 < level < math.inf else math.copysign(math.inf, level - aim)
