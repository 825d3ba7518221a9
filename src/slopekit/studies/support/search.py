"""Find the least bolt force that gives a target factor of safety, and the direction in which it is least.

A site is what support needs of a design: its block, its free face, and its closed form under further forces.
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

_TARGET_TOLERANCE = (
    1.5e-7  # relative; the least force gives the target, or more by at most twice this
)
_GUESS_RATIOS = (
    1.0 + 1e-6,
    1.003,
    1.03,
    1.12,
    1.3,
    1.7,
    2.5,
    4.0,
    7.0,
    12.0,
)  # of a trial force to the guess, and of the guess to a trial force
_ROOT_PRECISION = {
    "resolution": 1e-10,
    "near": _TARGET_TOLERANCE / (2.0 + _TARGET_TOLERANCE),
    "level_tolerance": 1e-6,
}  # options of `RootSearch` for a root,
_NO_ROOT_PRECISION = {
    "jump": 1e-3,
    "edge": 1e-3,
    "reach": 1e-3,
}  # and for jumps, domain edges and extremes
_TRIAL_FORCES = np.logspace(
    -4.0, 4.0, 65
)  # in weights of the block: forces by which directions are compared
_HALVINGS = 30
_STEP_DEG = 5.0  # step of trend and plunge: bolts are set out to this angle
_INTO_FACE_DEG = 5.0  # least angle between a bolt and the face
_FORCE_NAMES = ("force_east", "force_north", "force_up")


@dataclass(frozen=True)
class Answer:
    """The factor of safety by one method (None where there is none), and the status."""

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
        """The level for a root search, which takes a force without an answer (0) as one that is too small."""
        return self.level or 0.0

    def reaches(self, target: float) -> bool:
        """Return whether there is a factor of at least the target.

        >>> Answer(1.5, "slides").reaches(1.5), Answer(None, "no_driving_force").reaches(1.5)
        (True, True)
        >>> Answer(None, "not_converged").reaches(0.0), Answer(None, "falls").reaches(1.5)
        (False, False)
        """
        level = self.level
        return level is not None and level >= target


@dataclass(frozen=True)
class Need:
    """The force that one method needs for the target factor.

    Attributes
    ----------
    force : kN (a plane's: per metre), None where no force that was tried reaches the target
    answer : the factor at that force; where there is none the best one found, at the force `best` (kN)
    below : the factor just below the force, where it jumps across the target
    notice : why no force reaches the target, or a warning
    """

    force: float | None
    answer: Answer
    best: float = 0.0
    below: float | None = None
    notice: Notice | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return the need as JSON values."""
        return {
            "force_kn": self.force,
            "fos": json_of(self.answer.factor),
            "status": self.answer.status,
            "jumps_from": self.below,
            "moments_govern": self.answer.moments_govern,
            "agree": self.answer.agree,
            "notice": json_of(self.notice),
            "reached": self.force is not None,
        }


@dataclass(frozen=True)
class Site:
    """A wedge or a plane failure for which support is sought.

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
        """Whether the design is a section: forces are per metre of slope, without components along it."""
        return self.bounds.along is not None

    @property
    def unit(self) -> str:
        """The unit of forces, kN, or kN/m of a section."""
        return "kN/m" if self.in_section else "kN"

    @property
    def inward(self) -> Floats:
        """Unit normal (3,) of the face into the rock."""
        normal = np.cross(self.face[2] - self.face[0], self.face[1] - self.face[0])
        return normal / math.sqrt(float(normal @ normal))

    def across(self, vectors: Floats) -> Floats:
        """Return vectors (..., 3) as they act on the block: in a section without their component along the slope."""
        along = self.bounds.along
        return vectors if along is None else vectors - (vectors @ along[0])[..., None] * along[0]

    def with_bolts(self, *bolts: Bolt) -> Design:
        """Return the design with further bolts."""
        return replace(self.design, bolts=(*self.design.bolts, *bolts))

    def pressed(self, force: float, point: Floats) -> Design:
        """Return the design with a further force (kN) normal to the face, into the rock, through a point (3,) of it."""
        east, north, up = (float(component) for component in force * self.inward)
        pressing = Force((east, north, up), self.place(point), toward=line_of(self.inward))
        return replace(self.design, forces=(*self.design.forces, pressing))

    def place(self, point: Floats) -> tuple[float, float, float]:
        """Return a point (3,), m from the origin, in the coordinates of the user."""
        east, north, up = (float(coordinate) for coordinate in point + self.origin)
        return east, north, up

    def answers(
        self, design: Design, key: str, method: Method, forces: Sequence[float]
    ) -> list[Answer]:
        """Return the answers of a method for values (kN) of a force of the design, by its key, on arrays."""
        columns, sizes, pre_ie = (
            Vectorised(self.on_arrays, design, [key]),
            np.array(forces)[:, None],
            method == "pre_ie",
        )
        points = points_on_arrays(columns, (), sizes, pre_ie)
        all_factors = [
            (point and point.factors) or factors_of(columns.scattered(size), pre_ie)
            for size, point in zip(sizes, points, strict=True)
        ]
        return [method_answer(factors, method) for factors in all_factors]


def method_answer(factors: Factors, method: Method) -> Answer:
    """Return the answer of one method among the factors of a design; no factor where PRE-IE did not converge."""
    if method == "pre_ie":
        return Answer(factors.limit, factors.status, factors.moments_govern, factors.agree)
    return Answer(factors.closed_form, factors.closed_status or factors.status)


def site_of(design: Design) -> Site:
    """Return the site of a wedge or a plane.

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
    cut_block = kind.cut(design)
    assert cut_block.bounds is not None
    block = cut_block.block
    weight, face = (
        design.rock.unit_weight_kn_m3 * block.volume,
        block.faces[cut_block.face] @ cut_block.axes,
    )
    return Site(
        design,
        weight,
        face,
        block.areas[cut_block.face],
        cut_block.origin,
        kind.on_arrays,
        cut_block.bounds,
    )


# -- directions ----------------------------------------------------------------------------------------------------


def least_forces(site: Site, goal: float, directions: Floats) -> Floats:
    """Return the least active force (m,), kN, along unit directions (m, 3) by the closed form; inf without any.

    Directions are east, north, up. A passive bolt pulls with its capacity divided by the factor: its least force is
    `goal` times that.
    """
    arguments = site.on_arrays.arguments(site.design)
    applied_force = np.array([arguments[name] or 0.0 for name in _FORCE_NAMES])
    for pull in passive_bolts(site.design):
        applied_force += np.array(pull) / goal

    def reaches(forces: Floats) -> Any:
        total = (applied_force + forces[..., None] * directions).reshape(-1, 3)
        forms = site.on_arrays.closed_forms(
            arguments | dict(zip(_FORCE_NAMES, total.T, strict=True)), ()
        )
        stays = np.array([name == "no_driving_force" for name in forms.names])[forms.outcome]
        return (stays | (np.nan_to_num(forms.factor) >= goal)).reshape(forces.shape)

    trial_forces = site.weight * _TRIAL_FORCES
    is_reached = reaches(
        np.broadcast_to(trial_forces[:, None], (len(trial_forces), len(directions)))
    )
    first = is_reached.argmax(axis=0)
    high = np.where(is_reached.any(axis=0), trial_forces[first], np.inf)
    low = np.where(first > 0, trial_forces[first - 1], 0.0)
    is_bracketed = np.isfinite(high)
    for _ in range(_HALVINGS if is_bracketed.any() else 0):
        middle = np.where(is_bracketed, 0.5 * (low + high), 0.0)
        is_enough = is_bracketed & reaches(middle)
        low, high = np.where(is_enough, low, middle), np.where(is_enough, middle, high)
    return high


def best_direction(site: Site, goal: float, plunges: tuple[float, float]) -> Line | None:
    """Return the direction of least force into the face, with a plunge between limits (degrees); None without any.

    Directions are tried in steps of 5°, to which bolts are set out; in a section they stay across the slope.
    """
    low, high = plunges
    inward = line_of(site.inward)
    steps = [
        _STEP_DEG * k for k in range(math.ceil(low / _STEP_DEG), math.floor(high / _STEP_DEG) + 1)
    ]
    trends = [inward.trend_deg, (inward.trend_deg + 180.0) % 360.0]
    if not site.in_section:
        trends = np.arange(0.0, 360.0, _STEP_DEG).tolist()
    lines = [
        Line(round(trend, 10) % 360.0, plunge)
        for trend in trends
        for plunge in steps or [low, high]
    ]
    vectors = np.array([line.vector() for line in lines])
    into_face = vectors @ site.inward >= math.sin(math.radians(_INTO_FACE_DEG)) - 1e-12
    if not into_face.any():
        return None
    forces = np.full(len(lines), np.inf)
    forces[into_face] = least_forces(site, goal, vectors[into_face])
    best = int(forces.argmin())
    return lines[best] if math.isfinite(forces[best]) else None


# -- one direction -------------------------------------------------------------------------------------------------


def least_force(
    evaluate: Callable[[Sequence[float]], list[Answer]], target: float, guess: float
) -> Need:
    """Return the least force near a guess that gives the factor `target`, or more by at most 3e-7 of it.

    Parameters
    ----------
    evaluate : returns the answers at forces (kN); without force the factor is less than the target
    """
    aimed_factor = target * (1.0 + _TARGET_TOLERANCE)

    def samples(forces: Sequence[float]) -> list[Sample[Answer]]:
        return [
            Sample(force, level_of(answer.search_level, aimed_factor), answer.status, answer)
            for force, answer in zip(forces, evaluate(forces), strict=True)
        ]

    search = RootSearch(samples, guess, **_ROOT_PRECISION, **_NO_ROOT_PRECISION)
    search.search_outwards(
        [
            0.0,
            *(guess * ratio for ratio in _GUESS_RATIOS),
            *(guess / ratio for ratio in _GUESS_RATIOS),
        ],
        guess,
    )
    for crossing in search.crossings():
        if abs(level_at(crossing.best)) <= search.near:
            return Need(crossing.best.place, crossing.best.evaluation)
        if crossing.rises:
            below = None if crossing.how == "root" else crossing.lower.evaluation.search_level
            return Need(crossing.upper.place, crossing.upper.evaluation, below=below)
    best = max(search.samples, key=lambda sample: sample.evaluation.search_level)
    return Need(None, best.evaluation, best.place)
