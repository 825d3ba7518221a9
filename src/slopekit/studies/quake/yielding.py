"""The yield coefficient of a design by both methods, and how fast a block gains on the ground above it.

Above k_y the block slides: its acceleration against the ground is κ (a - k_y g), not a - k_y g. κ is the derivative of
the net driving force by k, in parts of the weight: cos(β - φ) / cos φ on a plane. At factor 1 a force along the sliding
is as good as one of inertia, so κ follows from how much such a force moves k_y, by any method. Of several blocks each
has the inertia of its own motion, and κ is that of the block that goes farthest (`Kind.seismic_gain`).
"""

import math
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from slopekit.core.codec import NO_JSON
from slopekit.core.errors import DesignError, Fault, NoConvergenceError, Notice, fail
from slopekit.core.orientation import number, opposite
from slopekit.design.common import Design
from slopekit.design.parts import Force
from slopekit.design.reading.files import with_values
from slopekit.design.registry import KINDS, record_of
from slopekit.kinds import analyse, kind_of
from slopekit.kinds.protocol import Gain
from slopekit.studies.points import UNSETTLED, Method, factor_at, point_of, status_of
from slopekit.studies.protocol import Advance
from slopekit.studies.roots import RootSearch
from slopekit.studies.running import ALONE, Crew
from slopekit.studies.solve.factor_request import FactorRequest
from slopekit.studies.solve.run import for_factor
from slopekit.studies.solve.solutions import NO_CONVERGENCE, Solution
from slopekit.studies.words import status_words

KEY, TOWARD = "loads.seismic.k", "loads.seismic.toward"
MOST_K = 2.0  # where a design's coefficient ends
_SOME_K = 0.1  # a coefficient to ask whether the design takes one
_PUSH = 0.02  # of the yield coefficient, in parts of the weight: how much a force along the sliding moves it
_LEAST_PUSH = 1e-3
_CLOSE = {"resolution": 1e-12, "near": 1e-13}  # how near these are found
_NEAR = (1e-3, 1e-2, 0.1, 0.5)  # of it, to both sides: where the moved ones are looked for
_METHODS: tuple[Method, ...] = ("pre_ie", "closed_form")
NO_FORM = "it says nothing of shaking that way"
_DILATES = "its joints dilate: it rises as it slides"
_JUST_ABOVE = 1.0 + 1e-7  # of k_y: the block moves as it will, and no elastic state at rest is asked for


@dataclass(frozen=True)
class Yield:
    """The yield coefficient by one method.

    Attributes
    ----------
    method : pre_ie or closed_form
    coefficient : None where no k up to 2 moves the block
    status : how it moves there
    factor : κ, None where there is none; why_not says why
    factor_of : of several blocks the one whose centroid it is for, the farthest; "" of one block
    first_factor : the factor right at the coefficient, where contacts change just above it and it becomes `factor`
    notes : what a run says of the factor at the coefficient, without one of that without an earthquake
    before : the factor of safety without an earthquake; inf where nothing drives
    agree : whether the methods agree there on the same assumptions; None where that is not judged
    """

    method: Method
    coefficient: float | None
    status: str
    factor: float | None
    why_not: str
    before: float
    agree: bool | None = None
    factor_of: str = ""
    first_factor: float | None = None
    notes: tuple[Notice, ...] = field(default=(), metadata=NO_JSON)

    @property
    def jumps(self) -> bool:
        """Whether moments open a joint at the coefficient, and the factor of safety jumps across 1."""
        return self.why_not.startswith("moments open")


def static_design(design: Design, toward: float | None, named: str = "toward") -> Design:
    """The design without its earthquake, which pushes another way where that is given.

    Raises
    ------
    DesignError
        E280 a design without a file, E122 a direction that is none, E253 a design that takes no shaking this way.
    """
    values: dict[str, object] = {KEY: 0.0}
    if toward is not None and not 0.0 <= toward <= 360.0:
        fail("E122", f"{named} is {number(toward)}, it lies between 0 and 360", named)
    if toward is not None:
        values[TOWARD] = float(toward)
    try:
        with_values(design, values | {KEY: _SOME_K})
    except DesignError as error:
        codes = {fault.code for fault in error.faults}
        if not codes <= {"E142", "E253"}:
            raise
        raise DesignError([_takes_none(design, toward, named, "E142" in codes)]) from None
    return with_values(design, values)


def _takes_none(design: Design, toward: float | None, named: str, has_no_key: bool) -> Fault:
    """E253: no seismic coefficient, no direction of it, or one that leaves the section."""
    if has_no_key:
        message = f"quake needs a design with a seismic coefficient: a {design.kind} has none"
        known = ", ".join(name for name in KINDS if "loads" not in record_of(name).WITHOUT)
        return Fault("E253", message, "", f"Kinds with loads.seismic.k: {known}.")
    if toward is None:
        message = "quake needs the direction of the shaking: the blocks do not say which way they fall"
    else:
        message = f"{named} is {number(toward)}: a section is shaken toward 090 or 270"
    return Fault("E253", message, "", f"Give {named} 270 (or 090): x is east (090), -x west (270).")


def way_out(static: Design, ours: Yield, advance: Advance) -> tuple[float, float] | None:
    """Return the trend opposite to the shaking and half of its k_y, where that is above the k_y there; else None."""
    trend = static.seismic.trend_deg
    if trend is None:
        return None
    half, back = 0.5 * (ours.coefficient or MOST_K), opposite(trend)
    factor = factor_at(point_of(static, {KEY: half, TOWARD: back}), "pre_ie")
    advance(1)
    return (back, half) if factor is not None and factor < 1.0 else None


def check_stands(static: Design) -> None:
    """Refuse a slope that does not stand without an earthquake, or has no factor of safety: E520."""
    point = point_of(static, {})
    before = factor_at(point, "pre_ie")
    if before is None:
        ends = status_of(point, "pre_ie")
        said = NO_CONVERGENCE if ends == UNSETTLED else f"PRE-IE ends as {ends}"
        said = f"{point.code} {point.message}" if point.code else said
        fault = Fault("E520", f"the design has no factor of safety without an earthquake: {said}")
        raise (NoConvergenceError if ends == UNSETTLED else DesignError)([fault])
    also = point.also
    if before > 1.0 and also is not None and also.falls_short(1.0):
        fail(
            "E520",
            f"the slope does not stand without an earthquake: {also.WHAT}: {also.in_words()}{also.ALONE}",
            "",
            "Give it strength or support that holds it first.",
        )
    if before <= 1.0:
        shown = f"{before:.4g}" if before < 0.9995 else f"{before:.8g}"  # 0.99996 is not 1
        has = f"its factor of safety is {shown}"
        if before == 0.0:  # nothing holds it: a status, no number
            has = status_words(static, status_of(point, "pre_ie"))
        fail(
            "E520",
            f"the slope does not stand without an earthquake: {has}",
            "",
            "Give it strength or support that holds it first.",
        )


def yields_of(static: Design, crew: Crew, advance: Advance) -> tuple[Yield, ...]:
    """The yield coefficient by PRE-IE, and by the closed form where there is one, of a slope that stands."""
    solution = for_factor(static, KEY, 1.0, None, crew, advance)
    reason = solution.pre_ie.reason
    if reason is not None and (solution.is_open or reason.code in ("E318", "E319")):  # not found is not "no k moves it"
        raise (NoConvergenceError if solution.is_open else DesignError)([reason])
    request = FactorRequest(static, solution.key, 0.0, MOST_K, 1.0, ALONE, advance)
    request = replace(request, columns=request.on_arrays)
    ours, closed = (_yield_by(request, solution, method) for method in _METHODS)
    if closed is not None and closed.coefficient is None and ours is not None and ours.coefficient is not None:
        at = point_of(static, {KEY: ours.coefficient})
        advance(1)
        if at.factors is not None and not at.has_closed_form and closed.before > 1.0:
            closed = replace(closed, why_not=NO_FORM)
    return tuple(one for one in (ours, closed) if one is not None)


def _yield_by(request: FactorRequest, solution: Solution, method: Method) -> Yield | None:
    """The yield coefficient by one method; None where it says nothing of the design."""
    before, answers = factor_at(solution.before, method), solution.pre_ie
    if before is None or (method == "closed_form" and not solution.before.has_closed_form):
        return None
    if before <= 1.0:
        return Yield(method, None, status_of(solution.before, method), None, "it does not hold at k = 0", before)
    if method == "closed_form" and solution.closed_form is not None:
        answers = solution.closed_form
    roots = [one for one in (*answers.roots, *answers.others) if one.value > 0.0]
    first = min(roots, key=lambda one: one.value, default=None)
    if first is None:
        notes = tuple(solution.before.notes) if method == "pre_ie" else ()
        return Yield(method, None, "", None, f"no k up to {MOST_K:g} moves it", before, notes=notes)
    found = Yield(method, first.value, first.status, None, "", before, first.both.agree, notes=first.notes)
    if answers.method != method:  # a closed form that comes with PRE-IE: columns
        found = replace(found, coefficient=_root(request, method, first.value), agree=None, notes=())
    elif first not in answers.roots and method == "pre_ie":
        (_, stands), (_, falls) = first.bracket
        why = f"moments open a joint there, the factor of safety jumps from {stands:.3g} to {falls:.3g}"
        return replace(found, why_not=why, notes=())
    if found.coefficient is None:
        return replace(found, why_not=f"no k up to {MOST_K:g} moves it")
    gain = _gain(request, method, found.coefficient)
    if isinstance(gain, str):
        return replace(found, why_not=gain)
    return replace(found, factor=gain.factor, factor_of=gain.block, first_factor=gain.first)


def _root(request: FactorRequest, method: Method, start: float) -> float | None:
    """Return the yield coefficient by a method near another one; None where none is found."""
    search = RootSearch(partial(request.samples, method), MOST_K, **_CLOSE)
    near = (start * by for part in _NEAR for by in (1.0 - part, 1.0 + part))
    search.look_outwards((0.0, *(k for k in near if k <= MOST_K), MOST_K), start)
    return next((crossing.best.at for crossing in search.crossings() if crossing.how == "root"), None)


def _gain(request: FactorRequest, method: Method, k: float) -> Gain | str:
    """How fast the block gains on the ground at a yield coefficient, or why that is not known."""
    static, advance, kind = request.design, request.advance, kind_of(request.design)
    dilates = any(strength.dilation_deg for strength in static.joint_strengths)
    if kind.MOVES_MANY:
        advance(1)
        unit = with_values(static, {KEY: 1.0})
        gain = None if dilates else kind.seismic_gain(static, unit, k, method == "closed_form")
        return _DILATES if dilates else gain or "the motion of the blocks did not settle"
    result = analyse(with_values(static, {KEY: k * _JUST_ABOVE}))
    advance(1)
    mechanism = result.limit_state.mechanism
    if mechanism is None or not result.status.startswith("slides"):
        return f"the block does not slide ({result.status})"
    if result.moments_govern and method == "pre_ie":
        return "moments govern: it turns as it slides"
    if dilates:
        return _DILATES
    along = mechanism.displacement
    along = along / math.sqrt(float(along @ along))
    push = max(_PUSH * k, _LEAST_PUSH)
    forces = [Force(tuple(np.asarray(side * push * result.forces.weight * along).tolist())) for side in (-1.0, 1.0)]
    starts = [k + push, k - push if k > push else 0.5 * k]
    pushed = [replace(request, forces=(force,), points={}) for force in forces]
    moved = [_root(one, method, start) for one, start in zip(pushed, starts, strict=True)]
    if moved[0] is None or moved[1] is None or not moved[0] > moved[1]:
        return "another way to move is as near"
    return Gain(2.0 * push / (moved[0] - moved[1]), "")


def shown_k(k: float | None) -> str:
    """A coefficient as sentences have it."""
    return f"above {MOST_K:g}" if k is None else number(float(f"{k:.6g}"))
