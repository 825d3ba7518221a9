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
from slopekit.studies.running import ALONE, ExecutorOptions
from slopekit.studies.solve.factor_request import FactorRequest
from slopekit.studies.solve.run import for_factor
from slopekit.studies.solve.solutions import NO_CONVERGENCE, Solution
from slopekit.studies.words import status_words

KEY, TOWARD = "loads.seismic.k", "loads.seismic.toward"
MOST_K = 2.0  # where a design's coefficient ends
_TRIAL_K = 0.1  # a coefficient to ask whether the design takes one
_PUSH = 0.02  # of the yield coefficient, in parts of the weight: how much a force along the sliding moves it
_MIN_PUSH = 1e-3
_ROOT_TOLERANCES = {"resolution": 1e-12, "near": 1e-13}  # how near these are found
_SEARCH_FRACTIONS = (
    1e-3,
    1e-2,
    0.1,
    0.5,
)  # of it, to both sides: where the moved ones are looked for
_METHODS: tuple[Method, ...] = ("pre_ie", "closed_form")
NO_FORM = "it says nothing of shaking that way"
_DILATES = "its joints dilate: it rises as it slides"
_ABOVE_YIELD = (
    1.0 + 1e-7
)  # of k_y: the block moves as it will, and no elastic state at rest is asked for


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


def static_design(design: Design, toward: float | None, option: str = "toward") -> Design:
    """The design without its earthquake, which pushes another way where that is given.

    Raises
    ------
    DesignError
        E280 a design without a file, E122 a direction that is none, E253 a design that takes no shaking this way.
    """
    values: dict[str, object] = {KEY: 0.0}
    if toward is not None and not 0.0 <= toward <= 360.0:
        fail("E122", f"{option} is {number(toward)}, it lies between 0 and 360", option)
    if toward is not None:
        values[TOWARD] = float(toward)
    try:
        with_values(design, values | {KEY: _TRIAL_K})
    except DesignError as error:
        codes = {fault.code for fault in error.faults}
        if not codes <= {"E142", "E253"}:
            raise
        raise DesignError([_no_shaking_fault(design, toward, option, "E142" in codes)]) from None
    return with_values(design, values)


def _no_shaking_fault(design: Design, toward: float | None, option: str, has_no_key: bool) -> Fault:
    """E253: no seismic coefficient, no direction of it, or one that leaves the section."""
    if has_no_key:
        message = f"quake needs a design with a seismic coefficient: a {design.kind} has none"
        kinds = ", ".join(name for name in KINDS if "loads" not in record_of(name).WITHOUT)
        return Fault("E253", message, "", f"Kinds with loads.seismic.k: {kinds}.")
    if toward is None:
        message = (
            "quake needs the direction of the shaking: the blocks do not say which way they fall"
        )
    else:
        message = f"{option} is {number(toward)}: a section is shaken toward 090 or 270"
    return Fault(
        "E253", message, "", f"Give {option} 270 (or 090): x is east (090), -x west (270)."
    )


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
    static_factor = factor_at(point, "pre_ie")
    if static_factor is None:
        status = status_of(point, "pre_ie")
        reason = NO_CONVERGENCE if status == UNSETTLED else f"PRE-IE ends as {status}"
        reason = f"{point.code} {point.message}" if point.code else reason
        fault = Fault("E520", f"the design has no factor of safety without an earthquake: {reason}")
        raise (NoConvergenceError if status == UNSETTLED else DesignError)([fault])
    whole_wedge = point.also
    if static_factor > 1.0 and whole_wedge is not None and whole_wedge.falls_short(1.0):
        fail(
            "E520",
            f"the slope does not stand without an earthquake: {whole_wedge.WHAT}: "
            f"{whole_wedge.in_words()}{whole_wedge.ALONE}",
            "",
            "Give it strength or support that holds it first.",
        )
    if static_factor <= 1.0:
        digits = (
            f"{static_factor:.4g}" if static_factor < 0.9995 else f"{static_factor:.8g}"
        )  # 0.99996 is not 1
        description = f"its factor of safety is {digits}"
        if static_factor == 0.0:  # nothing holds it: a status, no number
            description = status_words(static, status_of(point, "pre_ie"))
        fail(
            "E520",
            f"the slope does not stand without an earthquake: {description}",
            "",
            "Give it strength or support that holds it first.",
        )


def yields_of(static: Design, crew: ExecutorOptions, advance: Advance) -> tuple[Yield, ...]:
    """The yield coefficient by PRE-IE, and by the closed form where there is one, of a slope that stands."""
    solution = for_factor(static, KEY, 1.0, None, crew, advance)
    reason = solution.pre_ie.reason
    if reason is not None and (
        solution.is_open or reason.code in ("E318", "E319")
    ):  # not found is not "no k moves it"
        raise (NoConvergenceError if solution.is_open else DesignError)([reason])
    request = FactorRequest(static, solution.key, 0.0, MOST_K, 1.0, ALONE, advance)
    request = replace(request, columns=request.on_arrays)
    pre_ie, closed_form = (_yield_by(request, solution, method) for method in _METHODS)
    if (
        closed_form is not None
        and closed_form.coefficient is None
        and pre_ie is not None
        and pre_ie.coefficient is not None
    ):
        yield_point = point_of(static, {KEY: pre_ie.coefficient})
        advance(1)
        if (
            yield_point.factors is not None
            and not yield_point.has_closed_form
            and closed_form.before > 1.0
        ):
            closed_form = replace(closed_form, why_not=NO_FORM)
    return tuple(method_yield for method_yield in (pre_ie, closed_form) if method_yield is not None)


def _yield_by(request: FactorRequest, solution: Solution, method: Method) -> Yield | None:
    """Return the yield coefficient by one method; None where the method does not apply to the design."""
    static_factor, answers = factor_at(solution.before, method), solution.pre_ie
    if static_factor is None or (method == "closed_form" and not solution.before.has_closed_form):
        return None
    if static_factor <= 1.0:
        return Yield(
            method,
            None,
            status_of(solution.before, method),
            None,
            "it does not hold at k = 0",
            static_factor,
        )
    if method == "closed_form" and solution.closed_form is not None:
        answers = solution.closed_form
    roots = [root for root in (*answers.roots, *answers.others) if root.value > 0.0]
    first = min(roots, key=lambda root: root.value, default=None)
    if first is None:
        notes = tuple(solution.before.notes) if method == "pre_ie" else ()
        return Yield(
            method, None, "", None, f"no k up to {MOST_K:g} moves it", static_factor, notes=notes
        )
    method_yield = Yield(
        method,
        first.value,
        first.status,
        None,
        "",
        static_factor,
        first.both.agree,
        notes=first.notes,
    )
    if answers.method != method:  # a closed form that comes with PRE-IE: columns
        method_yield = replace(
            method_yield, coefficient=_root(request, method, first.value), agree=None, notes=()
        )
    elif first not in answers.roots and method == "pre_ie":
        (_, stable_factor), (_, failing_factor) = first.bracket
        reason = (
            "moments open a joint there, the factor of safety jumps "
            f"from {stable_factor:.3g} to {failing_factor:.3g}"
        )
        return replace(method_yield, why_not=reason, notes=())
    if method_yield.coefficient is None:
        return replace(method_yield, why_not=f"no k up to {MOST_K:g} moves it")
    gain = _gain(request, method, method_yield.coefficient)
    if isinstance(gain, str):
        return replace(method_yield, why_not=gain)
    return replace(method_yield, factor=gain.factor, factor_of=gain.block, first_factor=gain.first)


def _root(request: FactorRequest, method: Method, start: float) -> float | None:
    """Return the yield coefficient by a method near another one; None where none is found."""
    search = RootSearch(partial(request.samples, method), MOST_K, **_ROOT_TOLERANCES)
    candidates = (
        start * ratio
        for fraction in _SEARCH_FRACTIONS
        for ratio in (1.0 - fraction, 1.0 + fraction)
    )
    search.search_outwards((0.0, *(k for k in candidates if k <= MOST_K), MOST_K), start)
    return next(
        (crossing.best.place for crossing in search.crossings() if crossing.how == "root"), None
    )


def _gain(request: FactorRequest, method: Method, k: float) -> Gain | str:
    """Return how fast the block gains on the ground at a yield coefficient, or why that is not known."""
    static, advance, kind = request.design, request.advance, kind_of(request.design)
    dilates = any(strength.dilation_deg for strength in static.joint_strengths)
    if kind.MOVES_MANY:
        advance(1)
        unit = with_values(static, {KEY: 1.0})
        gain = None if dilates else kind.seismic_gain(static, unit, k, method == "closed_form")
        return _DILATES if dilates else gain or "the motion of the blocks did not settle"
    result = analyse(with_values(static, {KEY: k * _ABOVE_YIELD}))
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
    push = max(_PUSH * k, _MIN_PUSH)
    forces = [
        Force(tuple(np.asarray(side * push * result.forces.weight * along).tolist()))
        for side in (-1.0, 1.0)
    ]
    starts = [k + push, k - push if k > push else 0.5 * k]
    pushed_requests = [replace(request, forces=(force,), points={}) for force in forces]
    coefficients = [
        _root(pushed_request, method, start)
        for pushed_request, start in zip(pushed_requests, starts, strict=True)
    ]
    if coefficients[0] is None or coefficients[1] is None or not coefficients[0] > coefficients[1]:
        return "another way to move is as near"
    return Gain(2.0 * push / (coefficients[0] - coefficients[1]), "")


def shown_k(k: float | None) -> str:
    """A coefficient as sentences have it."""
    return f"above {MOST_K:g}" if k is None else number(float(f"{k:.6g}"))
