"""The least force at which a method gives a wanted factor of safety, and the direction in which it is least.

The site is the design as support sees it: its block, its face, and its closed form asked with more force on it.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.codec import json_of
from slopekit.core.errors import Notice, fail
from slopekit.core.orientation import Line, line_of
from slopekit.design.common import Design
from slopekit.design.parts import Bolt, Force
from slopekit.kinds import factors_of, kind_of
from slopekit.kinds.protocol import Factors
from slopekit.kinds.single_block.closed_forms import OnArrays, passive_bolts
from slopekit.kinds.single_block.held_bolts import Bounds
from slopekit.studies.evaluation.columns import points_on_arrays
from slopekit.studies.evaluation.vectorised import Vectorised
from slopekit.studies.points import UNSETTLED, Method
from slopekit.studies.roots import RootSearch, Sample, level_at
from slopekit.studies.solve.factor_request import level_of

_WITHIN = 1.5e-7  # of the target: the least force gives it, or more by at most twice this part
_FURTHER = (1.0 + 1e-6, 1.003, 1.03, 1.12, 1.3, 1.7, 2.5, 4.0, 7.0, 12.0)  # times a guess, and the guess by them
_FINELY = {"resolution": 1e-10, "near": _WITHIN / (2.0 + _WITHIN), "same": 1e-6}  # as `RootSearch` has it,
_ROUGHLY = {"jump": 1e-3, "edge": 1e-3, "reach": 1e-3}  # and where there is no root
_TRIED = np.logspace(-4.0, 4.0, 65)  # times the weight: forces by which directions are compared
_HALVINGS = 30
_STEP_DEG = 5.0  # of trend and plunge as they are set out
_INTO_FACE_DEG = 5.0  # bolts point into the face by at least that
_FORCE = ("force_east", "force_north", "force_up")


@dataclass(frozen=True)
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
    def in_words(self) -> str:
        """The factor, or the status that stands for none."""
        return self.status.replace("_", " ") if self.factor is None else f"FoS {self.factor:.4f}"

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


@dataclass(frozen=True)
class Need:
    """What one method needs.

    Attributes
    ----------
    force : kN (a plane's: per metre), None where no force that was tried reaches the target
    answer : at that force; without one the best that was met, at the force `best`
    below : the factor just under the force, where it jumps over the target
    notice : why not, or what to know
    """

    force: float | None
    answer: Answer
    best: float = 0.0
    below: float | None = None
    notice: Notice | None = None

    def to_dict(self) -> dict[str, Any]:
        """As JSON values."""
        return {
            "force_kn": self.force, "fos": json_of(self.answer.factor), "status": self.answer.status,
            "jumps_from": self.below, "moments_govern": self.answer.moments_govern, "agree": self.answer.agree,
            "notice": json_of(self.notice), "reached": self.force is not None,
        }  # fmt: skip


@dataclass(frozen=True)
class Site:
    """A wedge or a plane failure that support is looked for.

    Attributes
    ----------
    design : as it stands; weight : kN
    face : (k, 3) free face of the block from the origin, m, anticlockwise from outside; area : m² (a plane's: per
        metre)
    origin : (3,) m, of the block in the coordinates of the user
    on_arrays : the closed form of many such designs
    bounds : the planes that bolts meet
    """

    design: Design
    weight: float
    face: Floats
    area: float
    origin: Floats
    on_arrays: OnArrays[Any]
    bounds: Bounds

    @property
    def in_section(self) -> bool:
        """Whether what acts along the slope is left out, and forces are per metre of slope."""
        return self.bounds.along is not None

    @property
    def unit(self) -> str:
        """What forces are counted in."""
        return "kN/m" if self.in_section else "kN"

    @property
    def inward(self) -> Floats:
        """Unit normal (3,) of the face into the rock."""
        normal = np.cross(self.face[2] - self.face[0], self.face[1] - self.face[0])
        return normal / math.sqrt(float(normal @ normal))

    def across(self, vectors: Floats) -> Floats:
        """Vectors (..., 3) as the block takes them: in a section without their part along it."""
        along = self.bounds.along
        return vectors if along is None else vectors - (vectors @ along[0])[..., None] * along[0]

    def with_bolts(self, *bolts: Bolt) -> Design:
        """The design with more bolts."""
        return replace(self.design, bolts=(*self.design.bolts, *bolts))

    def pressed(self, force: float, point: Floats) -> Design:
        """The design with one more force, kN, normal to the face, through a point (3,) of it."""
        east, north, up = (float(part) for part in force * self.inward)
        pressing = Force((east, north, up), self.place(point), toward=line_of(self.inward))
        return replace(self.design, forces=(*self.design.forces, pressing))

    def place(self, point: Floats) -> tuple[float, float, float]:
        """A point from the origin in the coordinates of the user."""
        east, north, up = (float(part) for part in point + self.origin)
        return east, north, up

    def answers(self, design: Design, key: str, method: Method, forces: Sequence[float]) -> list[Answer]:
        """What a method says of a design with a force of other sizes (kN) at a key, all at once on arrays."""
        columns, sizes, pre_ie = (
            Vectorised(self.on_arrays, design, [key]),
            np.array(forces)[:, None],
            method == "pre_ie",
        )
        points = points_on_arrays(columns, (), sizes, pre_ie)
        every = [
            (point and point.factors) or factors_of(columns.scattered(size), pre_ie)
            for size, point in zip(sizes, points, strict=True)
        ]
        return [method_answer(factors, method) for factors in every]


def method_answer(factors: Factors, method: Method) -> Answer:
    """What a method says among the factors of a design: PRE-IE none where it did not settle."""
    if method == "pre_ie":
        return Answer(factors.limit, factors.status, factors.moments_govern, factors.agree)
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
    if kind.on_arrays is None:
        message = f"support is for a wedge or a plane, this design is of kind {design.kind}"
        advice = (
            f"A design of kind {design.kind} takes no bolts."
            if "support" in type(design).WITHOUT
            else "Give the design a bolt, then sweep and solve change it: slopekit solve my.yaml "
            "support.bolts.0.force --fos 1.5"
        )
        fail("E288", message, "", advice)
    if any(strength.law for strength in design.joint_strengths):
        fail(
            "E288",
            "support takes Mohr-Coulomb strength: the directions it compares have one c and φ a joint",
            "",
            "Give the design a bolt, then solve changes it: slopekit solve my.yaml support.bolts.0.force --fos 1.5",
        )
    made = kind.cut(design)
    assert made.bounds is not None
    block = made.block
    weight, face = design.rock.unit_weight_kn_m3 * block.volume, block.faces[made.face] @ made.axes
    return Site(design, weight, face, block.areas[made.face], made.origin, kind.on_arrays, made.bounds)


# -- directions ----------------------------------------------------------------------------------------------------


def least_forces(site: Site, goal: float, directions: Floats) -> Floats:
    """The least active force (m,) along unit directions (m, 3) in east, north, up by the closed form; inf without.

    A passive bolt pulls with its capacity divided by the factor: it needs the goal times as much.
    """
    arguments = site.on_arrays.arguments(site.design)
    own = np.array([arguments[name] or 0.0 for name in _FORCE])
    for pull in passive_bolts(site.design):
        own += np.array(pull) / goal

    def reaches(forces: Floats) -> Any:
        total = (own + forces[..., None] * directions).reshape(-1, 3)
        forms = site.on_arrays.closed_forms(arguments | dict(zip(_FORCE, total.T, strict=True)), ())
        stays = np.array([name == "no_driving_force" for name in forms.names])[forms.outcome]
        return (stays | (np.nan_to_num(forms.factor) >= goal)).reshape(forces.shape)

    tried = site.weight * _TRIED
    met = reaches(np.broadcast_to(tried[:, None], (len(tried), len(directions))))
    first = met.argmax(axis=0)
    high = np.where(met.any(axis=0), tried[first], np.inf)
    low = np.where(first > 0, tried[first - 1], 0.0)
    known = np.isfinite(high)
    for _ in range(_HALVINGS if known.any() else 0):
        middle = np.where(known, 0.5 * (low + high), 0.0)
        enough = known & reaches(middle)
        low, high = np.where(enough, low, middle), np.where(enough, middle, high)
    return high


def best_direction(site: Site, goal: float, plunges: tuple[float, float]) -> Line | None:
    """The direction of least force into the face that plunges between limits (degrees); None where none gives the goal.

    Directions are those that are set out, in steps of 5°; in a section they stay across the slope.
    """
    low, high = plunges
    inward = line_of(site.inward)
    steps = [_STEP_DEG * k for k in range(math.ceil(low / _STEP_DEG), math.floor(high / _STEP_DEG) + 1)]
    trends = [inward.trend_deg, (inward.trend_deg + 180.0) % 360.0]
    if not site.in_section:
        trends = np.arange(0.0, 360.0, _STEP_DEG).tolist()
    lines = [Line(round(trend, 10) % 360.0, plunge) for trend in trends for plunge in steps or [low, high]]
    vectors = np.array([line.vector() for line in lines])
    into_face = vectors @ site.inward >= math.sin(math.radians(_INTO_FACE_DEG)) - 1e-12
    if not into_face.any():
        return None
    forces = np.full(len(lines), np.inf)
    forces[into_face] = least_forces(site, goal, vectors[into_face])
    best = int(forces.argmin())
    return lines[best] if math.isfinite(forces[best]) else None


# -- one direction -------------------------------------------------------------------------------------------------


def least_force(ask: Callable[[Sequence[float]], list[Answer]], target: float, guess: float) -> Need:
    """The least force near a guess that gives a level of `target`, or more by at most 3e-7 of it.

    Parameters
    ----------
    ask : forces to answers, without one less than the target
    """
    aim = target * (1.0 + _WITHIN)

    def samples(forces: Sequence[float]) -> list[Sample[Answer]]:
        return [
            Sample(force, level_of(answer.search_level, aim), answer.status, answer)
            for force, answer in zip(forces, ask(forces), strict=True)
        ]

    search = RootSearch(samples, guess, **_FINELY, **_ROUGHLY)
    search.look_outwards([0.0, *(guess * by for by in _FURTHER), *(guess / by for by in _FURTHER)], guess)
    for crossing in search.crossings():
        if abs(level_at(crossing.best)) <= search.near:
            return Need(crossing.best.at, crossing.best.found)
        if crossing.rises:
            below = None if crossing.how == "root" else crossing.before.found.search_level
            return Need(crossing.after.at, crossing.after.found, below=below)
    best = max(search.samples, key=lambda one: one.found.search_level)
    return Need(None, best.found, best.at)
