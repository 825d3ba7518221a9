"""What support is asked for, and what it came to: needs by method, patterns, cases, their JSON (a contract)."""

import math
import re
import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from decimal import ROUND_CEILING, Context
from functools import partial
from operator import attrgetter
from typing import Any, ClassVar, Literal

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.codec import json_of, record_of
from slopekit.core.errors import Faults, Notice, fail
from slopekit.core.orientation import Line, number
from slopekit.core.sheet import Column
from slopekit.core.units import quantity
from slopekit.design.common import Design
from slopekit.design.fields import declare
from slopekit.design.parts import Bolt
from slopekit.design.words import line_of_words
from slopekit.kinds import also_falls_short, dilates
from slopekit.kinds.protocol import Factors
from slopekit.studies.points import point_of
from slopekit.studies.protocol import StudyOutcome, numbers_given
from slopekit.studies.support.pattern import Layout
from slopekit.studies.support.search import Answer, Need, method_answer

FORCE_STEP_KN = 10.0  # of the force of a bolt as it is built
DRILLABLE_DEG = (0.0, 30.0)  # plunges of bolts, where nobody says others
_NUMBERS = {
    "fos": declare("the target factor of safety", "ratio", 0.0, above=True, code="E307"),
    "bolt_capacity": declare("the capacity of a bolt", "force", 0.0, default=200.0, above=True, code="E307"),
    "spacing": declare("the spacing of the bolts", "length", 0.0, above=True, code="E307"),
    "bond": declare("the anchorage behind the joint", "length", 0.0, default=3.0, above=True, code="E307"),
    "length": declare("the length of the bolts", "length", 0.0, above=True, code="E307"),
}
_UP = Context(prec=5, rounding=ROUND_CEILING)
Acts = Literal["active", "passive"]


@dataclass(frozen=True)
class SupportOptions:
    """Options of a support study: kN, m, degrees.

    Attributes
    ----------
    target : factor of safety
    acts : how bolts act; toward : direction of their force on the block, None where none is given
    plunge : limits of the practical direction, degrees; None where a direction is given and no limits
    capacity : of a bolt; spacing : None where it follows from the force; bond : anchorage behind the joint
    length : of every bolt, None where each is as long as it must be
    """

    target: float = field(metadata={"json": None})
    acts: tuple[Acts, ...]
    toward: Line | None
    plunge: tuple[float, float] | None = field(metadata={"json": "plunge_deg"})
    capacity: float = field(metadata={"json": "bolt_capacity_kn"})
    spacing: float | None = field(metadata={"json": "spacing_m"})
    bond: float = field(metadata={"json": "bond_m"})
    length: float | None = field(metadata={"json": "length_m"})


def read_options(
    *, fos: object, acts: object, toward: object, plunge: object, bolt_capacity: object, spacing: object, bond: object,
    length: object, named: Callable[[str], str],
) -> SupportOptions:  # fmt: skip
    """Read options as a user gives them; `named` says how a fault names them.

    Raises
    ------
    DesignError
        E307 with every option that is not understood, and what `quantity` raises.
    """
    faults = Faults()
    given = {"fos": fos, "bolt_capacity": bolt_capacity, "spacing": spacing, "bond": bond, "length": length}
    target, capacity, apart, anchorage, long = numbers_given(_NUMBERS, given, named, faults).values()
    both = faults.of(lambda: _acts(acts, f"{named('acts')} {acts}"))
    line = toward if isinstance(toward, Line) or toward is None else faults.of(
        lambda: line_of_words(toward, "the bolts", "E307", f"{named('toward')} {toward}")
    )  # fmt: skip
    limits = None if plunge is None else faults.of(lambda: _plunges(plunge, named("plunge")))
    faults.refuse()
    assert target is not None and capacity is not None and anchorage is not None and both is not None  # noqa: PT018
    return SupportOptions(target, both, line, limits, capacity, apart, anchorage, long)


def _acts(value: object, where: str) -> tuple[Acts, ...]:
    choices: dict[str, tuple[Acts, ...]] = {
        "active": ("active",),
        "passive": ("passive",),
        "both": ("active", "passive"),
    }
    if value is not None and str(value) not in choices:
        fail("E307", f"bolts are active or passive, not {value}", where, "Leave it out for both.")
    return choices.get(str(value), choices["both"])


def _plunges(value: object, option: str) -> tuple[float, float]:
    where = f"{option} {value}"
    parts = re.split(r"\s*[,:]\s*", value.strip()) if isinstance(value, str) else value
    if not isinstance(parts, Sequence) or len(parts) != 2:
        fail(
            "E307",
            f"limits of plunge are two numbers, not {value}",
            where,
            f"Write least,most: {option} -5,15; positive is downward into the rock.",
        )
    low, high = (quantity(part, "angle", "a limit of plunge", where) for part in parts)
    if not -90.0 <= low <= high <= 90.0:
        fail(
            "E307",
            f"limits of plunge run from low to high between -90 and 90, not {number(low)} to {number(high)}",
            where,
        )
    return low, high


@dataclass(frozen=True)
class BoltCase:
    """Bolts that act one way.

    Attributes
    ----------
    toward : direction of their force on the block, None where none reaches the target
    closed_form : what it needs along that direction; pre_ie : what that needs with the heads on the face, None where it
        was not asked
    layout : heads on the face, None where no bolt can stand
    force : that both methods need (of dilating joints PRE-IE), kN or kN/m; None where one cannot reach the target
    each : kN of a bolt as it is built: up to 10 kN, at most its capacity
    lengths : (n,) m as they are built, up to 0.1 m
    bolts : what goes into the design beside the bolts that are there; empty where the target is out of reach
    existing : the bolts that are there
    factors : of the design with `bolts`, which it was solved again with; None without any
    lacks : what is reached with `bolts`, where that is not the target; why there are none
    trials : of the load case whose bolts are the strongest, the same bolts solved again in each other load case
    notices : why there is no layout, or what to know of it
    """

    JSON_ALSO: ClassVar = ("reached", "pattern", "check", "other_cases", "support", "yaml")
    acts: Acts
    toward: Line | None
    closed_form: Need
    pre_ie: Need | None = None
    layout: Layout | None = field(default=None, metadata={"json": None})
    force: float | None = field(default=None, metadata={"json": "use_kn"})
    each: float | None = field(default=None, metadata={"json": None})
    lengths: Floats = field(default_factory=lambda: np.zeros(0), metadata={"json": None})
    bolts: tuple[Bolt, ...] = field(default=(), metadata={"json": None})
    existing: tuple[Bolt, ...] = field(default=(), metadata={"json": None})
    factors: Factors | None = field(default=None, metadata={"json": None})
    lacks: str = field(default="", metadata={"json": None})
    trials: Mapping[str, "BoltCase"] = field(default_factory=dict, metadata={"json": None})
    notices: tuple[Notice, ...] = ()

    @property
    def reached(self) -> bool:
        """Whether both methods reach the target, solved again with the bolts as they are built."""
        return self.factors is not None and not self.lacks

    @property
    def all_notices(self) -> tuple[Notice, ...]:
        """What is to be known of what each method needs, and of the layout."""
        needs = [need.notice for need in (self.closed_form, self.pre_ie) if need is not None]
        return (*(notice for notice in needs if notice is not None), *self.notices)

    @property
    def pattern(self) -> dict[str, Any] | None:
        """Where the bolts stand, their force and their lengths, as JSON values; None where none can stand."""
        laid = self.layout
        if laid is None:
            return None
        pattern: dict[str, Any] = json_of({
            "bolts": len(laid), "needed": laid.needed, "rows": laid.rows, "columns": laid.columns,
            "spacing_m": {"across": laid.across_m, "up": laid.up_m}, "left_out": laid.left_out,
            "heads_m": laid.heads_m, "each_kn": self.each, "lengths_m": self.lengths,
        })  # fmt: skip
        return pattern

    @property
    def check(self) -> dict[str, Any] | None:
        """What both methods say of the design with the bolts as they are built; None where none are."""
        if self.factors is None:
            return None
        both = {"limit": self.factors.limit, "closed_form": self.factors.closed_form}
        return {"fos": both, "status": self.factors.status, "met": not self.lacks}

    @property
    def other_cases(self) -> dict[str, Any]:
        """What both methods say with the same bolts in the other load cases, by name; None where they cannot be run."""
        return {name: trial.check for name, trial in self.trials.items()}

    @property
    def trial_words(self) -> str:
        """The factor with the same bolts in each other load case, or what is lacking there."""
        lacks = {name: trial.lacks for name, trial in self.trials.items()}
        tried = {name: trial.factors for name, trial in self.trials.items() if trial.factors and not trial.lacks}
        answers = lacks | {name: method_answer(factors, "pre_ie").in_words for name, factors in tried.items()}
        return f"{self.acts} bolts in the other cases: {'; '.join(map(' '.join, answers.items()))}" if answers else ""

    def solved_in(self, design: Design, target: float) -> "BoltCase":
        """The same bolts in a design that is solved again with them, held against a target."""
        point = point_of(replace(design, bolts=(*design.bolts, *self.bolts)), {})
        lacks = f"{point.code} {point.message}"
        if point.factors is not None:
            closed, limit = method_answer(point.factors, "closed_form"), method_answer(point.factors, "pre_ie")
            both = f"{limit.in_words} by PRE-IE; {closed.in_words} by the closed form"
            lacks = f"solved again with these bolts {both}"
            if enough(target, closed, limit, dilates(design)):
                lacks = " ".join(map(str, also_falls_short(point.also, target, "with these bolts")))
        return replace(self, factors=point.factors, lacks=lacks and f"NOT REACHED, FoS {target:g}: {lacks}")

    @property
    def support(self) -> dict[str, Any] | None:
        """All bolts as `support` of a design; None where the target is out of reach."""
        return {"bolts": [bolt_words(bolt) for bolt in (*self.existing, *self.bolts)]} if self.bolts else None

    @property
    def yaml(self) -> str | None:
        """The same as the text of a design file, whose first lines say so where the bolts do not give the target."""
        if not self.bolts:
            return None
        lacks = [self.lacks, *(f"in {name} {trial.lacks}" for name, trial in self.trials.items() if trial.lacks)]
        comments = "".join(f"# {line}\n" for text in lacks for line in textwrap.wrap(text, 97))
        return comments + snippet((*self.existing, *self.bolts))


@dataclass(frozen=True, repr=False)
class Support(StudyOutcome):
    """What a design needs.

    Attributes
    ----------
    target : factor of safety; options : what was asked for
    closed_form, pre_ie : without more support
    cases : by how the bolts act, empty where nothing is needed
    pressure : even pressure normal to the face that gives the target by both methods, kPa; None where nothing is needed
        or none does
    unit : kN, or kN/m of a plane
    dilates : the joints dilate, which the closed form does not know: PRE-IE's number counts, even where it is less
    """

    name: ClassVar[str] = "support"
    JSON_ALSO: ClassVar = ("reached", "needed", "without")
    design: Design = field(metadata={"json": None})
    target: float = field(metadata={"json": "target_fos"})
    options: SupportOptions
    closed_form: Answer = field(metadata={"json": None})
    pre_ie: Answer = field(metadata={"json": None})
    cases: tuple[BoltCase, ...] = field(metadata={"json": "bolts"})
    pressure: float | None = field(metadata={"json": "pressure_kpa"})
    unit: str
    warnings: tuple[Notice, ...]
    dilates: bool = False

    @classmethod
    def over_cases(cls, outcomes: Mapping[str, "Support"]) -> dict[str, "Support"]:
        """By load case, with the bolts of the case that needs the greatest force tried in every other one."""

        def tried(name: str, bolts: BoltCase) -> BoltCase:
            if bolts.force != max(outcome.force_of(bolts.acts) or 0.0 for outcome in outcomes.values()):
                return bolts
            rest = {key: outcome for key, outcome in outcomes.items() if key != name}
            return replace(bolts, trials={key: bolts.solved_in(one.design, one.target) for key, one in rest.items()})

        return {
            name: replace(outcome, cases=tuple(tried(name, bolts) for bolts in outcome.cases))
            for name, outcome in outcomes.items()
        }

    def force_of(self, acts: Acts) -> float | None:
        """The force of bolts that act one way, None where they do not reach the target."""
        return next((case.force for case in self.cases if case.acts == acts and case.reached), None)

    @property
    def trial_lines(self) -> list[str]:
        """How the bolts do in the other load cases, where they were tried there."""
        return [case.trial_words for case in self.cases if case.trials]

    @property
    def reached(self) -> bool:
        """Whether nothing is needed, or some bolts give the target."""
        return self.stands or any(case.reached for case in self.cases)

    def files(self) -> dict[str, str]:
        """What is to be built, as `support:` of a design file, by the name of a file: for each way the bolts act."""
        return {f"support-{case.acts}.yaml": case.yaml for case in self.cases if case.yaml}

    @property
    def stands(self) -> bool:
        """Whether both methods (of dilating joints PRE-IE) reach the target as it is."""
        return enough(self.target, self.closed_form, self.pre_ie, self.dilates)

    @property
    def needed(self) -> bool:
        """Whether it does not stand as it is."""
        return not self.stands

    @property
    def without(self) -> dict[str, Any]:
        """What both methods say without more support, and of each other."""
        return {
            "fos": {"limit": self.pre_ie.factor, "closed_form": self.closed_form.factor},
            "status": self.pre_ie.status, "closed_form_status": self.closed_form.status,
            "moments_govern": self.pre_ie.moments_govern, "agree": self.pre_ie.agree,
        }  # fmt: skip

    @property
    def margin(self) -> float:
        """Of load cases that one governs which needs the greatest force."""
        return -min((case.force for case in self.cases if case.reached and case.force is not None), default=0.0)

    def case_columns(self) -> list[Column[Any]]:
        """The factor wanted of each load case, and the force that active and passive bolts need for it."""
        return [
            Column("wanted", attrgetter("target"), "target_fos", show=".4g", width=8),
            Column("bolts", lambda one: "none needed" if one.stands else "reached" if one.reached else "NOT REACHED",
                   "bolts", width=13),
            *(Column(f"{acts} {self.unit}", partial(Support.force_of, acts=acts), f"{acts}_kn", self.unit, ".1f", 15)
              for acts in self.options.acts),
        ]  # fmt: skip

    @property
    def exit_code(self) -> int:
        """0 reached by active and by passive bolts, as far as asked for, in every load case; 1 not (or W507).

        4 where the methods disagree, or without convergence.
        """
        tried = [bolts for case in self.cases for bolts in (case, *case.trials.values())]
        answers = [
            self.pre_ie,
            *(method_answer(bolts.factors, "pre_ie") for bolts in tried if bolts.factors is not None),
        ]
        if any(answer.agree is False or (answer.level is None and not self.reached) for answer in answers):
            return 4
        falls_short = any(notice.code == "W507" for notice in self.warnings)
        all_reach = self.stands or all(bolts.reached for bolts in tried)
        return 1 if falls_short or not all_reach else 0

    def to_dict(self) -> dict[str, Any]:
        """The support as JSON values; times stand in a block of their own."""
        return {**self.head(self.design), **record_of(self), "timing_s": {"total": self.seconds}, **self.words()}


def wanted_in_words(design: Design, target: float) -> str:
    """The target beside what acceptance asks for."""
    asked = design.accepted_fos
    beside = "" if asked is None or target > asked else f"below the {asked:g} that acceptance asks for"
    beside = "what acceptance asks for" if target == asked else beside
    return f"FoS {target:g}{f', {beside}' if beside else ''}"


def enough(target: float, closed_form: Answer, pre_ie: Answer, dilates: bool = False) -> bool:
    """Whether a design reaches a target as it is."""
    return pre_ie.reaches(target) and (dilates or closed_form.reaches(target))


# -- words and JSON -----------------------------------------------------------------------------------------------


def bolt_words(bolt: Bolt) -> dict[str, Any]:
    """A bolt as a design file writes it."""
    toward = f"{bolt.toward.trend_deg!r}/{bolt.toward.plunge_deg!r}"
    words: dict[str, Any] = {"force": bolt.force_kn, "toward": toward, "acts": bolt.acts}
    if bolt.head_m is not None:
        words["head"] = list(bolt.head_m)
    if bolt.length_m is not None:
        words["length"] = bolt.length_m
    return words


def built_force(needed_kn: float, capacity_kn: float) -> float:
    """The force of a bolt as it is built: up to 10 kN, and no more than its capacity.

    >>> built_force(113.1, 150.0), built_force(120.0, 150.0), built_force(142.0, 145.0)
    (120.0, 120.0, 145.0)
    """
    return max(min(math.ceil(needed_kn / FORCE_STEP_KN - 1e-9) * FORCE_STEP_KN, capacity_kn), needed_kn)


def written(bolt: Bolt) -> Bolt:
    """A bolt with the digits that it is written with; its force has five, rounded up: a little more than is needed.

    >>> written(Bolt(118.9495989254, Line(0.0, 10.0), "active")).force_kn
    118.95
    """
    toward = Line(float(f"{bolt.toward.trend_deg:.10g}"), float(f"{bolt.toward.plunge_deg:.10g}"))
    east, north, up = (round(part, 6) + 0.0 for part in bolt.head_m or (0.0, 0.0, 0.0))
    force = float(_UP.create_decimal(repr(float(bolt.force_kn))))
    return replace(bolt, force_kn=force, toward=toward, head_m=None if bolt.head_m is None else (east, north, up))


def snippet(bolts: Sequence[Bolt]) -> str:
    """`support:` of a design file with these bolts, lines of at most 100 columns."""
    lines = ["support:", "  bolts:"]
    for bolt in bolts:
        toward = f"{bolt.toward.trend_deg:.10g}/{bolt.toward.plunge_deg:.10g}"
        line = f"    - {{force: {bolt.force_kn:.13g} kN, toward: {toward}, acts: {bolt.acts}"
        if bolt.head_m is not None:
            head = ", ".join(f"{round(part, 6) + 0.0:.12g}" for part in bolt.head_m)
            line += f", head: [{head}]"
        if bolt.length_m is not None:
            line += f", length: {bolt.length_m:.10g} m"
        if len(line) > 98 and bolt.head_m is not None:
            before, after = line.split(", head", 1)
            lines.append(before + ",")
            line = "       head" + after
        lines.append(line + "}")
    return "\n".join(lines) + "\n"
