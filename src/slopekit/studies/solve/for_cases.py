"""The value of one number that satisfies every load case: that of the case that governs, put into all others."""

from collections.abc import Mapping
from operator import attrgetter
from typing import Any

from slopekit.core.records import dataclass
from slopekit.core.sheet import Column, Section, Table
from slopekit.design.common import Design
from slopekit.kinds import also_falls_short
from slopekit.studies.cases import InCase, in_each_case
from slopekit.studies.keys import values_of
from slopekit.studies.points import Evaluation, Point, factor_at, status_of
from slopekit.studies.solve.solutions import Solution

_WITHIN = 1e-6  # that PRE-IE's own root may miss the target by


def options(design: Design, given: Mapping[str, Any]) -> dict[str, Any]:
    """What the study of a case takes: what was given."""
    return dict(given)


@dataclass(frozen=True, slots=True)
class SolutionForAll:
    """The value for all cases.

    Attributes
    ----------
    value : None where there is none; governing : the case that it is from
    rises : whether more of it is safer; inside : every case with the value; reason : why there is none
    """

    found: Mapping[str, Solution]
    value: float | None
    governing: str
    rises: bool
    inside: tuple[InCase, ...]
    reason: str

    @property
    def reached(self) -> bool:
        """Whether every case has its target."""
        return self.value is not None and all(one.met for one in self.inside)

    @property
    def exit_code(self) -> int:
        """0 found, 1 there is no such value, 4 the methods disagree."""
        if any(one.exit_code == 4 for one in self.found.values()):
            return 4
        return 0 if self.reached else 1

    @property
    def line(self) -> str:
        """The value and who governs it."""
        key = next(iter(self.found.values())).key
        if self.value is None or not self.reached:
            return f"{key.path}: no value for all {len(self.found)} cases: {self._why()}"
        than = "at least" if self.rises else "at most"
        return f"{key.path} {than} {key.shown(self.value)} for all {len(self.found)} cases, {self.governing} governs"

    def _why(self) -> str:
        if self.value is None:
            return self.reason
        short = ", ".join(one.case for one in self.inside if not one.met)
        key = next(iter(self.found.values())).key
        return f"at {key.shown(self.value)}, which {self.governing} needs, {short} has not its factor"

    def sections(self) -> list[Section]:
        """The value, and every case with it."""
        return [Section("FOR ALL", [self.line, *([] if self.value is None else [self._table()])])]

    def _table(self) -> Table[InCase]:
        key = next(iter(self.found.values())).key
        alone = Column[InCase]("alone it needs", attrgetter("own"), "own_value", key.unit,
                               show=lambda own: "nothing" if own is None else key.shown(own))  # fmt: skip
        return in_each_case("with it", self.inside, alone)

    def files(self) -> dict[str, str]:
        """None."""
        return {}

    def to_dict(self) -> dict[str, Any]:
        """As JSON values."""
        key = next(iter(self.found.values())).key
        return {
            "reached": self.reached, "key": key.path, "unit": key.unit, "value": self.value,
            "more_is_safer": self.rises, "governing": self.governing,
            "reason": None if self.reached else self._why(),
            "cases": self._table().records(),
        }  # fmt: skip


def for_all(solutions: Mapping[str, Solution], given: Mapping[str, Any]) -> SolutionForAll:
    """The value for all cases.

    Where the factor rises with the value the largest of the cases' own values governs, where it falls the smallest. A
    case that has its target at every value asks for nothing.
    """
    lows, highs = dict[str, float](), dict[str, float]()
    for name, one in solutions.items():
        if one.answer is not None:
            (lows if one.answer.rises else highs)[name] = one.answer.value
        elif one.pre_ie.least is None or one.pre_ie.least[1] < one.target:
            reason = f"{name} has none: {one.reason.message if one.reason else 'none was found'}"
            return SolutionForAll(solutions, None, name, True, (), reason)
    if not lows and not highs:
        name = next(iter(solutions))
        return SolutionForAll(solutions, None, name, True, (), "every case has its factor at every value")
    low = max(lows, key=lambda name: lows[name], default="")
    high = min(highs, key=lambda name: highs[name], default="")
    now = next(iter(solutions.values())).key.value
    if low and high and lows[low] > highs[high]:
        shown = solutions[low].key.shown
        reason = f"{low} needs at least {shown(lows[low])}, {high} at most {shown(highs[high])}"
        return SolutionForAll(solutions, None, low, True, (), reason)
    rises = bool(low) and (not high or now is None or abs(now - lows[low]) <= abs(now - highs[high]))
    governing = low if rises else high
    value = (lows if rises else highs)[governing]
    inside = tuple(_in_case(name, one, value) for name, one in solutions.items())
    return SolutionForAll(solutions, value, governing, rises, inside, "")


def _in_case(name: str, one: Solution, value: float) -> InCase:
    work, values = Evaluation(one.design, True), values_of(one.design, [one.key], [value])
    point = Point.from_record(work(values))
    limit, closed = factor_at(point, "pre_ie"), factor_at(point, "closed_form")
    met = limit is not None and limit >= one.target - _WITHIN
    also = None if point.factors is None else point.factors.also
    met = met and not also_falls_short(also, one.target, "")
    own = None if one.answer is None else one.answer.value
    return InCase(name, one.target, status_of(point, "pre_ie"), limit, closed, met, own)
