"""The value of one number of a design at which its probability of failure is a target.

The probability comes from samples drawn with the same random numbers at every value: it is a step function of the
value, so what is found is the place of a step, and the confidence limits of the estimate become limits of the value.

Where a closed form counts the failures, PRE-IE looks at some samples of what is found, as it does in `prob`. Where its
judgement is higher the value is moved until that judgement, the one `prob` leads with, is not above the target.
"""

import math
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import field, replace
from functools import partial
from typing import Any, ClassVar, TypeAlias

from slopekit.core.codec import json_of
from slopekit.core.errors import DesignError, Fault, Notice, SlopekitError
from slopekit.core.orientation import number
from slopekit.core.records import dataclass
from slopekit.design.common import Design
from slopekit.design.reading.files import with_values
from slopekit.kinds import likely_slips
from slopekit.notices import not_as_given
from slopekit.studies.keys import Key, key_of, keys_of, values_of
from slopekit.studies.protocol import Advance, StudyOutcome
from slopekit.studies.ranges import Within, parse_within
from slopekit.studies.solve.roots import Crossing, RootSearch, Sample, near_by, places
from slopekit.studies.solve.solutions import end_advice

_EVEN, _CLOSE, _EACH_DECADE = 9, 2, 1
_RESOLUTION, _RESOLUTION_OF_LIMITS = 1e-9, 1e-5
_ROUNDS, _HELD = 8, 0.05  # in which PRE-IE's judgement is brought to the target from below, within a part of it
_BY_PRE_IE = "The closed form is too low here: slopekit prob --by pre-ie, value by value."


@dataclass(frozen=True, slots=True)
class Estimate:
    """A probability of failure with its confidence limits; without limits they are None.

    `by` whom, in the words of `prob`; `disagree` : samples on which the methods disagree.
    """

    value: float
    low: float | None = None
    high: float | None = None
    by: str = ""
    disagree: int = field(default=0, metadata={"json": None})


#: What a design comes to; drawn with the same random numbers at every call.
FailureProbability: TypeAlias = Callable[[Design], "Estimate | float"]
_Tried: TypeAlias = "Estimate | Fault"


@dataclass(frozen=True, slots=True)
class ProbableValue:
    """A value at which the probability passes the target.

    Attributes
    ----------
    value : on the side where the probability is not above the target; estimate : the probability there
    counted : by the closed form, where PRE-IE's judgement is the higher and led to the value; else None
    bracket : the two sides of the step, each a value and its estimate
    rises : whether the probability rises with the value there
    limits : values between which the target lies within the confidence limits; None where an end was not found
    """

    value: float
    estimate: Estimate
    bracket: tuple[tuple[float, Estimate], tuple[float, Estimate]]
    rises: bool
    limits: tuple[float | None, float | None]
    counted: Estimate | None = None


@dataclass(frozen=True, slots=True, repr=False)
class ProbabilitySolution(StudyOutcome):
    """The value that was asked for.

    Attributes
    ----------
    roots : the one nearest to the present value first
    before : the probability of the design as it is, None where it forms no block
    least, most : (value, probability) where it is least and greatest
    reason : why there is no root
    """

    name: ClassVar[str] = "solve"
    design: Design
    key: Key
    target: float
    within: tuple[float, float]
    before: Estimate | None
    roots: tuple[ProbableValue, ...]
    least: tuple[float, float] | None
    most: tuple[float, float] | None
    evaluations: int
    reason: Fault | None
    warnings: tuple[Notice, ...] = ()
    seconds: float = field(default=0.0, compare=False)

    @property
    def answer(self) -> ProbableValue | None:
        """The value nearest to the present one, None where there is none."""
        return self.roots[0] if self.roots else None

    @property
    def exit_code(self) -> int:
        """0 found, 1 there is no such value, 4 the methods disagree at it or, without one, at the design as it is."""
        led = self.before if self.answer is None else self.answer.estimate
        if led is not None and led.disagree:
            return 4
        return 0 if self.roots else 1

    def to_dict(self) -> dict[str, Any]:
        """The solution as JSON values."""
        answer = self.answer
        return {
            **self.head(self.design),
            "key": self.key.path,
            "unit": self.key.unit,
            "target": {"probability_of_failure": self.target},
            "within": list(self.within),
            "before": {"value": self.key.value, "probability": json_of(self.before)},
            "value": None if answer is None else self.key.reduced(answer.value),
            "roots": [
                {
                    "value": self.key.reduced(root.value), "probability": json_of(root.estimate),
                    "counted": json_of(root.counted), "rises": root.rises, "limits": list(root.limits),
                    "bracket": [{"value": at, "probability": json_of(of)} for at, of in root.bracket],
                }
                for root in self.roots
            ],
            "reach": {
                name: None if end is None else {"value": self.key.reduced(end[0]), "probability": end[1]}
                for name, end in (("least", self.least), ("most", self.most))
            },
            "evaluations": self.evaluations,
            "reason": json_of(self.reason),
            "timing_s": {"total": self.seconds},
            **self.words(),
        }  # fmt: skip


def for_probability(
    design: Design,
    key: str,
    pf: float,
    failure_probability: FailureProbability,
    judged: FailureProbability | None = None,
    *,
    within: Within | None = None,
    advance: Advance = lambda _: None,
) -> ProbabilitySolution:
    """The value of one number of a design at which the probability of failure is a target.

    Parameters
    ----------
    key : dotted path, or `path=low:high`; of a distribution one of its numbers: strength.weak.phi.mean
    pf : the target, between 0 and 1
    failure_probability : of a design, with the same random numbers at every call
    judged : the same with PRE-IE's look at it, which takes longer: asked of the design and of what is found
    within : between which values to look

    Raises
    ------
    DesignError
        E280, E310, E311 for the key, E312 for the range, E314 for the target; E302 and others of the probability of
        the design as it is.
    """
    began = time.perf_counter()
    if not (math.isfinite(pf) and 0.0 < pf < 1.0):
        message = f"the target is a probability of failure of {number(pf)}, it lies between 0 and 1"
        raise DesignError([Fault("E314", message, "", "Write --pf 0.05 for 5 %.")])
    path, equals, text = key.partition("=")
    one = key_of(design, path)
    if one.scatters is not None or one.whole:
        what = "is a distribution: solve for one of its numbers" if one.scatters else "counts something"
        parts = [part.path for part in keys_of(design) if part.path.startswith(f"{one.path}.")]
        advice = f"Name {' or '.join(parts)}." if parts else ""
        raise DesignError([Fault("E311", f"{one.path} {what}", one.path, advice)])
    low, high = parse_within(one, text if equals else within)
    asked = _ProbabilityRequest(design, one, failure_probability, judged, advance)
    before = asked.lead(None)
    if isinstance(before, Fault) and before.code.startswith("E30"):
        raise DesignError([before])
    search = asked.search(pf, "value", high - low, _RESOLUTION)
    grid = places(low, high, one.value, even=_EVEN, close=_CLOSE, each_decade=_EACH_DECADE,
                  around_zero=one.role == "coordinate")  # fmt: skip
    if not equals and within is None:
        search.add(near_by(grid, low, high, one.value))
    crossings = search.crossings()
    if not crossings:
        search.add(grid)
        crossings = search.crossings()
    counted = [_value(crossing, asked.limits(search, pf, pf)) for crossing in crossings]
    held = [asked.held(search, pf, root) for root in counted]
    roots = [one for one in held if isinstance(one, ProbableValue)]
    roots.sort(key=lambda root: root.value if one.value is None else one.apart(root.value, one.value))
    reached = [(sample.at, sample.level + pf) for sample in search.samples if sample.level is not None]
    least = min(reached, key=lambda end: end[1], default=None)
    most = max(reached, key=lambda end: end[1], default=None)
    refused = next((one for one in held if isinstance(one, Fault)), None)
    reason = (
        None if roots else refused or asked.doubted(_reason(one, pf, (low, high), least, most, search.samples), before)
    )
    solution = ProbabilitySolution(
        design, one, pf, (low, high), None if isinstance(before, Fault) else before, tuple(roots), least, most,
        len(asked.known) + len(asked.led), reason,
    )  # fmt: skip
    dropped = refused if roots else None
    notices = (
        *_notices(solution, counted, dropped),
        *not_as_given(design, [one.path]),
        *likely_slips(design, [one.path]),
    )
    return replace(solution, warnings=notices, seconds=time.perf_counter() - began)


@dataclass(slots=True)
class _ProbabilityRequest:
    design: Design
    key: Key
    failure_probability: FailureProbability
    judged: FailureProbability | None
    advance: Advance
    known: dict[float | None, _Tried] = field(default_factory=dict)
    led: dict[float | None, _Tried] = field(default_factory=dict)
    limited: dict[tuple[float, float], list[float]] = field(default_factory=dict)

    def ask(self, value: float | None) -> _Tried:
        """The estimate at a value (None: the design as it is), or why there is none; each asked once."""
        if value not in self.known:
            self.known[value] = self._asked_of(self.failure_probability, value)
        return self.known[value]

    def lead(self, value: float | None) -> _Tried:
        """The same with PRE-IE's look at it, where a closed form counts."""
        counted = self.ask(value)
        if self.judged is None or isinstance(counted, Fault) or counted.by == "PRE-IE":
            return counted
        if value not in self.led:
            self.led[value] = self._asked_of(self.judged, value)
        return self.led[value]

    def _asked_of(self, function: FailureProbability, value: float | None) -> _Tried:
        try:
            values = {} if value is None else values_of(self.design, [self.key], [value])
            probability = function(with_values(self.design, values))
            return probability if isinstance(probability, Estimate) else Estimate(float(probability))
        except SlopekitError as error:
            return error.faults[0]
        finally:
            self.advance(1)

    def search(self, target: float, of: str, span: float, resolution: float) -> RootSearch[_Tried]:
        sample = partial(self.samples, target, of)
        return RootSearch(sample, span, resolution=resolution, same=math.inf)

    def samples(self, target: float, of: str, values: Sequence[float]) -> list[Sample[_Tried]]:
        sampled = []
        for value in values:
            tried = self.ask(value)
            share = None if isinstance(tried, Fault) else getattr(tried, of)
            label = tried.code if isinstance(tried, Fault) else ""
            sampled.append(Sample(value, None if share is None else share - target, label, tried))
        return sampled

    def crossings(
        self, search: RootSearch[_Tried], target: float, of: str, resolution: float = _RESOLUTION_OF_LIMITS
    ) -> list[Crossing[_Tried]]:
        """Where the probability, or one of its confidence limits, passes another target."""
        other = self.search(target, of, search.span, resolution)
        other.add([sample.at for sample in search.samples])
        return other.crossings()

    def limits(self, search: RootSearch[_Tried], low: float, high: float) -> list[float]:
        """Where the lower confidence limit passes one target, and the upper one the other."""
        key = low, high
        if key not in self.limited:
            crossings = [*self.crossings(search, low, "low"), *self.crossings(search, high, "high")]
            self.limited[key] = [crossing.best.at for crossing in crossings]
        return self.limited[key]

    def doubted(self, reason: Fault, before: _Tried) -> Fault:
        """Why the closed form has no value, E463 where PRE-IE's judgement of the design as it is lies above it."""
        counted = self.ask(None)
        if isinstance(before, Fault) or isinstance(counted, Fault) or before.value == counted.value:
            return reason
        message = f"by the closed form {reason.message}; as it is PRE-IE judges {before.value:.4g}"
        return Fault("E463", message, reason.where, _BY_PRE_IE)

    def held(self, search: RootSearch[_Tried], target: float, root: ProbableValue) -> "ProbableValue | Fault":
        """The value by the probability that `prob` leads with: where PRE-IE's judgement is higher, further off.

        The closed form may count only so much as PRE-IE adds to it; how much that is changes little with the value.
        """
        best, first, began = list[ProbableValue](), self.lead(root.value), self.key.shown(root.value, 7)
        places = [sample.at for sample in search.samples]
        unsafe, safe, end = root.value, None, min(places) if root.rises else max(places)
        at = root.value
        for _ in range(_ROUNDS):
            led, counted = self.lead(at), self.ask(at)
            if isinstance(led, Fault) or isinstance(counted, Fault):
                break
            more = led.value - counted.value
            if led.value <= target:
                if at == root.value and more == 0.0:
                    return replace(root, estimate=led)
                shift = [(a or 0.0) - (b or 0.0) for a, b in ((led.low, counted.low), (led.high, counted.high))]
                around = _around(self.limits(search, *(target - one for one in shift)), at)
                best.append(replace(root, value=at, estimate=led, counted=counted, limits=around))
                safe = at
                if led.value >= target * (1.0 - _HELD):
                    break
            else:
                unsafe = at
            at = self._between(search, target * (1.0 - _HELD / 2.0) - more, unsafe, end if safe is None else safe)
            if at in self.led:
                break
        if best:
            highest = max(best, key=lambda one: one.estimate.value)
            sides = [(one, self.led[one]) for one in sorted({unsafe, highest.value})]
            bracket = [(one, of) for one, of in sides if isinstance(of, Estimate)]
            return replace(highest, bracket=(bracket[0], bracket[-1]))
        if isinstance(first, Fault):
            return first
        message = f"the closed form counts a probability of failure of {number(target)} at {began}, PRE-IE judges it "
        message += f"{first.value:.4g}, and at no value tried is that below the target"
        return Fault("E463", message, "", _BY_PRE_IE)

    def _between(self, search: RootSearch[_Tried], aim: float, unsafe: float, safe: float) -> float:
        """Where the closed form counts so much, or else half way from a value that will not do to one that may."""
        low, high = min(unsafe, safe), max(unsafe, safe)
        crossings = self.crossings(search, aim, "value", _RESOLUTION) if aim > 0.0 else []
        inside = [one.best.at for one in crossings if low < one.best.at < high]
        return min(inside, key=lambda one: abs(one - unsafe), default=0.5 * (low + high))


def _value(crossing: Crossing[_Tried], limits: Sequence[float]) -> ProbableValue:
    """The value on the safe side of a step, and how far off the limits of the estimate put it."""
    ends = [end for end in (crossing.before, crossing.after) if isinstance(end.found, Estimate)]
    safe = crossing.best if crossing.best.level == 0.0 else min(ends, key=lambda end: end.level or 0.0)
    estimates = [(end.at, end.found) for end in ends if isinstance(end.found, Estimate)]
    assert isinstance(safe.found, Estimate)
    around = _around(limits, safe.at)
    return ProbableValue(safe.at, safe.found, (estimates[0], estimates[-1]), crossing.rises, around)


def _around(limits: Sequence[float], value: float) -> tuple[float | None, float | None]:
    """The nearest of them to both sides of a value."""
    return (_nearest([at for at in limits if at <= value], value), _nearest([at for at in limits if at > value], value))


def _nearest(limits: list[float], at: float) -> float | None:
    return min(limits, key=lambda one: abs(one - at), default=None)


def _reason(
    key: Key, target: float, within: tuple[float, float], least: tuple[float, float] | None,
    most: tuple[float, float] | None, samples: Sequence[Sample[_Tried]],
) -> Fault:  # fmt: skip
    span = f"from {key.shown(within[0], 7)} to {key.shown(within[1], 7)}"
    if least is None or most is None:
        first = next(sample.found for sample in samples if isinstance(sample.found, Fault))
        return Fault("E318", f"no value of {key.path} {span} gives a probability: {first.code} {first.message}")
    if least[1] == most[1]:
        text = f"the probability of failure does not depend on {key.path}: it is {least[1]:.6g} {span}"
        return Fault("E316", text)
    side, end = ("at most", most) if most[1] < target else ("at least", least)
    text = (
        f"no value of {key.path} {span} gives a probability of failure of {number(target)}: it is {side} "
        f"{end[1]:.6g}, at {key.shown(end[0], 7)}"
    )
    refused = [sample.found for sample in samples if isinstance(sample.found, Fault)]
    if refused:  # what was not computed is no proof
        codes = ", ".join(dict.fromkeys(fault.code for fault in refused))
        text += f"; {len(refused)} of {len(samples)} values tried give no probability ({codes}): it may lie among them"
    return Fault("E315", text, "", end_advice(key, end[0], within))


def _notices(
    solution: ProbabilitySolution, counted: Sequence[ProbableValue], dropped: Fault | None
) -> Iterable[Notice]:  # fmt: skip
    key, target = solution.key, number(solution.target)
    moved = [root for root in solution.roots if root.counted is not None]
    if moved and moved[0].counted is not None:
        near = min(counted, key=lambda one: abs(one.value - moved[0].value))
        yield Notice("W430", f"the value holds PRE-IE's judgement, the higher, which prob leads with: the closed form "
                             f"counts {moved[0].counted.value:.4g} there, and {target} at {key.shown(near.value)}: "
                             "do not use that")  # fmt: skip
    if dropped is not None:
        yield Notice("W430", f"a further value of the closed form is left out: {dropped.message}")
    if len(solution.roots) > 1:
        others = ", ".join(key.shown(root.value, 7) for root in solution.roots[1:])
        yield Notice("W356", f"{len(solution.roots)} values give {target}; further: {others}")
    answer = solution.answer
    if (
        answer is not None
        and answer.counted is None
        and abs(answer.estimate.value - solution.target) > 0.1 * solution.target
    ):
        (a, at_a), (b, at_b) = answer.bracket
        yield Notice("W357", f"the probability steps from {at_a.value:.4g} to {at_b.value:.4g} between "
                             f"{key.shown(a)} and {key.shown(b)}: more samples make smaller steps")  # fmt: skip
