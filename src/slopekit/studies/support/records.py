"""Options and results of a support study: needs by method, patterns, load cases, and their JSON (a contract)."""

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
from slopekit.kinds import dilates, whole_wedge_notice
from slopekit.kinds.protocol import Factors
from slopekit.studies.points import point_of
from slopekit.studies.protocol import StudyOutcome, numbers_given
from slopekit.studies.support.pattern import Layout
from slopekit.studies.support.search import Answer, Need, method_answer

FORCE_STEP_KN = 10.0  # to which the force of a bolt is rounded up as it is built
DRILLABLE_DEG = (0.0, 30.0)  # default limits of the plunge of bolts
_NUMBERS = {
    "fos": declare("the target factor of safety", "ratio", 0.0, above=True, code="E307"),
    "bolt_capacity": declare(
        "the capacity of a bolt", "force", 0.0, default=200.0, above=True, code="E307"
    ),
    "spacing": declare("the spacing of the bolts", "length", 0.0, above=True, code="E307"),
    "bond": declare(
        "the anchorage behind the joint", "length", 0.0, default=3.0, above=True, code="E307"
    ),
    "length": declare("the length of the bolts", "length", 0.0, above=True, code="E307"),
}
_FIVE_DIGITS_UP = Context(prec=5, rounding=ROUND_CEILING)
Acts = Literal["active", "passive"]


@dataclass(frozen=True)
class SupportOptions:
    """The options of a support study, in kN, m and degrees.

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
    *,
    fos: object,
    acts: object,
    toward: object,
    plunge: object,
    bolt_capacity: object,
    spacing: object,
    bond: object,
    length: object,
    option_name: Callable[[str], str],
) -> SupportOptions:
    """Read options as a user gives them; `option_name` returns the name of an option for messages.

    Raises
    ------
    DesignError
        E307 with every option that is not understood, and what `quantity` raises.
    """
    faults = Faults()
    inputs = {
        "fos": fos,
        "bolt_capacity": bolt_capacity,
        "spacing": spacing,
        "bond": bond,
        "length": length,
    }
    target, capacity, spacing_m, bond_m, length_m = numbers_given(
        _NUMBERS, inputs, option_name, faults
    ).values()
    both = faults.of(lambda: _acts(acts, f"{option_name('acts')} {acts}"))
    line = (
        toward
        if isinstance(toward, Line) or toward is None
        else faults.of(
            lambda: line_of_words(toward, "the bolts", "E307", f"{option_name('toward')} {toward}")
        )
    )
    limits = None if plunge is None else faults.of(lambda: _plunges(plunge, option_name("plunge")))
    faults.refuse()
    assert (  # noqa: PT018
        target is not None and capacity is not None and bond_m is not None and both is not None
    )
    return SupportOptions(target, both, line, limits, capacity, spacing_m, bond_m, length_m)


def _acts(value: object, location: str) -> tuple[Acts, ...]:
    choices: dict[str, tuple[Acts, ...]] = {
        "active": ("active",),
        "passive": ("passive",),
        "both": ("active", "passive"),
    }
    if value is not None and str(value) not in choices:
        fail(
            "E307", f"bolts are active or passive, not {value}", location, "Leave it out for both."
        )
    return choices.get(str(value), choices["both"])


def _plunges(value: object, option: str) -> tuple[float, float]:
    location = f"{option} {value}"
    limits = re.split(r"\s*[,:]\s*", value.strip()) if isinstance(value, str) else value
    if not isinstance(limits, Sequence) or len(limits) != 2:
        fail(
            "E307",
            f"limits of plunge are two numbers, not {value}",
            location,
            f"Write least,most: {option} -5,15; positive is downward into the rock.",
        )
    low, high = (quantity(limit, "angle", "a limit of plunge", location) for limit in limits)
    if not -90.0 <= low <= high <= 90.0:
        fail(
            "E307",
            f"limits of plunge run from low to high between -90 and 90, not {number(low)} to {number(high)}",
            location,
        )
    return low, high


@dataclass(frozen=True)
class BoltCase:
    """Bolts that are all active or all passive, with what they need and how they are built.

    Attributes
    ----------
    toward : direction of their force on the block, None where none reaches the target
    closed_form : the need of the closed form along that direction; pre_ie : that of PRE-IE with the heads on the face,
        None where it was not evaluated
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
        """The notices on the need of each method, and on the layout."""
        needs = [need.notice for need in (self.closed_form, self.pre_ie) if need is not None]
        return (*(notice for notice in needs if notice is not None), *self.notices)

    @property
    def pattern(self) -> dict[str, Any] | None:
        """The heads of the bolts, their force and lengths, as JSON values; None where there is no layout."""
        layout = self.layout
        if layout is None:
            return None
        pattern: dict[str, Any] = json_of(
            {
                "bolts": len(layout),
                "needed": layout.needed,
                "rows": layout.rows,
                "columns": layout.columns,
                "spacing_m": {"across": layout.across_m, "up": layout.up_m},
                "left_out": layout.left_out,
                "heads_m": layout.heads_m,
                "each_kn": self.each,
                "lengths_m": self.lengths,
            }
        )
        return pattern

    @property
    def check(self) -> dict[str, Any] | None:
        """The factors of the design with the bolts as built, by both methods; None where there are no bolts."""
        if self.factors is None:
            return None
        both = {"limit": self.factors.limit, "closed_form": self.factors.closed_form}
        return {"fos": both, "status": self.factors.status, "met": not self.lacks}

    @property
    def other_cases(self) -> dict[str, Any]:
        """The factors with the same bolts in the other load cases, by name; None where a case cannot be run."""
        return {name: trial.check for name, trial in self.trials.items()}

    @property
    def trial_words(self) -> str:
        """The factor with the same bolts in each other load case, or what is lacking there."""
        lacks = {name: trial.lacks for name, trial in self.trials.items()}
        tried = {
            name: trial.factors
            for name, trial in self.trials.items()
            if trial.factors and not trial.lacks
        }
        answers = lacks | {
            name: method_answer(factors, "pre_ie").in_words for name, factors in tried.items()
        }
        return (
            f"{self.acts} bolts in the other cases: {'; '.join(map(' '.join, answers.items()))}"
            if answers
            else ""
        )

    def solved_in(self, design: Design, target: float) -> "BoltCase":
        """Return the case with the factors of another design with the same bolts, held against a target."""
        point = point_of(replace(design, bolts=(*design.bolts, *self.bolts)), {})
        lacks = f"{point.code} {point.message}"
        if point.factors is not None:
            closed, limit = (
                method_answer(point.factors, "closed_form"),
                method_answer(point.factors, "pre_ie"),
            )
            both = f"{limit.in_words} by PRE-IE; {closed.in_words} by the closed form"
            lacks = f"solved again with these bolts {both}"
            if meets_target(target, closed, limit, dilates(design)):
                lacks = " ".join(
                    map(str, whole_wedge_notice(point.also, target, "with these bolts"))
                )
        return replace(
            self, factors=point.factors, lacks=lacks and f"NOT REACHED, FoS {target:g}: {lacks}"
        )

    @property
    def support(self) -> dict[str, Any] | None:
        """All bolts as `support` of a design; None where the target is out of reach."""
        return (
            {"bolts": [bolt_words(bolt) for bolt in (*self.existing, *self.bolts)]}
            if self.bolts
            else None
        )

    @property
    def yaml(self) -> str | None:
        """All bolts as the text of a design file; comments say where they do not reach the target."""
        if not self.bolts:
            return None
        lacks = [
            self.lacks,
            *(f"in {name} {trial.lacks}" for name, trial in self.trials.items() if trial.lacks),
        ]
        comments = "".join(f"# {line}\n" for text in lacks for line in textwrap.wrap(text, 97))
        return comments + yaml_snippet((*self.existing, *self.bolts))


@dataclass(frozen=True, repr=False)
class Support(StudyOutcome):
    """The outcome of a support study: the bolts, or the pressure on the face, that a design needs.

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
        """Return the outcomes by load case, with the strongest bolts tried in every other case."""

        def with_trials(name: str, bolts: BoltCase) -> BoltCase:
            if bolts.force != max(
                outcome.force_of(bolts.acts) or 0.0 for outcome in outcomes.values()
            ):
                return bolts
            remaining = {key: outcome for key, outcome in outcomes.items() if key != name}
            return replace(
                bolts,
                trials={
                    key: bolts.solved_in(load_case.design, load_case.target)
                    for key, load_case in remaining.items()
                },
            )

        return {
            name: replace(outcome, cases=tuple(with_trials(name, bolts) for bolts in outcome.cases))
            for name, outcome in outcomes.items()
        }

    def force_of(self, acts: Acts) -> float | None:
        """Return the force (kN or kN/m) of active or passive bolts, None where they do not reach the target."""
        return next((case.force for case in self.cases if case.acts == acts and case.reached), None)

    @property
    def trial_lines(self) -> list[str]:
        """The factors with the bolts in the other load cases, a line for each kind of bolt tried there."""
        return [case.trial_words for case in self.cases if case.trials]

    @property
    def reached(self) -> bool:
        """Whether nothing is needed, or some bolts give the target."""
        return self.stands or any(case.reached for case in self.cases)

    def files(self) -> dict[str, str]:
        """Return the bolts to build as `support:` of a design file, by file name: active and passive ones."""
        return {f"support-{case.acts}.yaml": case.yaml for case in self.cases if case.yaml}

    @property
    def stands(self) -> bool:
        """Whether both methods (of dilating joints PRE-IE) reach the target without further support."""
        return meets_target(self.target, self.closed_form, self.pre_ie, self.dilates)

    @property
    def needed(self) -> bool:
        """Whether the target needs further support."""
        return not self.stands

    @property
    def without(self) -> dict[str, Any]:
        """The factors without further support, as JSON values."""
        return {
            "fos": {"limit": self.pre_ie.factor, "closed_form": self.closed_form.factor},
            "status": self.pre_ie.status,
            "closed_form_status": self.closed_form.status,
            "moments_govern": self.pre_ie.moments_govern,
            "agree": self.pre_ie.agree,
        }

    @property
    def margin(self) -> float:
        """The negative of the least force that reaches the target: the load case that needs most governs."""
        return -min(
            (case.force for case in self.cases if case.reached and case.force is not None),
            default=0.0,
        )

    def case_columns(self) -> list[Column[Any]]:
        """Return the columns of the load case table: the target factor, and the force of active and passive bolts."""
        return [
            Column("wanted", attrgetter("target"), "target_fos", show=".4g", width=8),
            Column(
                "bolts",
                lambda outcome: (
                    "none needed"
                    if outcome.stands
                    else "reached"
                    if outcome.reached
                    else "NOT REACHED"
                ),
                "bolts",
                width=13,
            ),
            *(
                Column(
                    f"{acts} {self.unit}",
                    partial(Support.force_of, acts=acts),
                    f"{acts}_kn",
                    self.unit,
                    ".1f",
                    15,
                )
                for acts in self.options.acts
            ),
        ]

    @property
    def exit_code(self) -> int:
        """0 reached by active and by passive bolts, as far as asked for, in every load case; 1 not (or W507).

        4 where the methods disagree, or without convergence.
        """
        tried = [bolts for case in self.cases for bolts in (case, *case.trials.values())]
        answers = [
            self.pre_ie,
            *(
                method_answer(bolts.factors, "pre_ie")
                for bolts in tried
                if bolts.factors is not None
            ),
        ]
        if any(
            answer.agree is False or (answer.level is None and not self.reached)
            for answer in answers
        ):
            return 4
        falls_short = any(notice.code == "W507" for notice in self.warnings)
        all_reach = self.stands or all(bolts.reached for bolts in tried)
        return 1 if falls_short or not all_reach else 0

    def to_dict(self) -> dict[str, Any]:
        """The support as JSON values; times stand in a block of their own."""
        return {
            **self.head(self.design),
            **record_of(self),
            "timing_s": {"total": self.seconds},
            **self.words(),
        }


def target_in_words(design: Design, target: float) -> str:
    """Return the target factor in words, compared with the one of the acceptance rules."""
    accepted_fos = design.accepted_fos
    relation = (
        ""
        if accepted_fos is None or target > accepted_fos
        else f"below the {accepted_fos:g} that acceptance asks for"
    )
    relation = "what acceptance asks for" if target == accepted_fos else relation
    return f"FoS {target:g}{f', {relation}' if relation else ''}"


def meets_target(target: float, closed_form: Answer, pre_ie: Answer, dilates: bool = False) -> bool:
    """Return whether a design reaches a target by both methods, of dilating joints by PRE-IE."""
    return pre_ie.reaches(target) and (dilates or closed_form.reaches(target))


# -- words and JSON -----------------------------------------------------------------------------------------------


def bolt_words(bolt: Bolt) -> dict[str, Any]:
    """Return a bolt as the mapping of a design file."""
    toward = f"{bolt.toward.trend_deg!r}/{bolt.toward.plunge_deg!r}"
    words: dict[str, Any] = {"force": bolt.force_kn, "toward": toward, "acts": bolt.acts}
    if bolt.head_m is not None:
        words["head"] = list(bolt.head_m)
    if bolt.length_m is not None:
        words["length"] = bolt.length_m
    return words


def built_force(needed_kn: float, capacity_kn: float) -> float:
    """Return the force of a bolt as built, kN: rounded up to 10 kN, and no more than its capacity.

    >>> built_force(113.1, 150.0), built_force(120.0, 150.0), built_force(142.0, 145.0)
    (120.0, 120.0, 145.0)
    """
    return max(
        min(math.ceil(needed_kn / FORCE_STEP_KN - 1e-9) * FORCE_STEP_KN, capacity_kn), needed_kn
    )


def as_written(bolt: Bolt) -> Bolt:
    """Return a bolt rounded as a design file writes it: its force has five digits, rounded up.

    >>> as_written(Bolt(118.9495989254, Line(0.0, 10.0), "active")).force_kn
    118.95
    """
    toward = Line(float(f"{bolt.toward.trend_deg:.10g}"), float(f"{bolt.toward.plunge_deg:.10g}"))
    east, north, up = (round(coordinate, 6) + 0.0 for coordinate in bolt.head_m or (0.0, 0.0, 0.0))
    force = float(_FIVE_DIGITS_UP.create_decimal(repr(float(bolt.force_kn))))
    return replace(
        bolt,
        force_kn=force,
        toward=toward,
        head_m=None if bolt.head_m is None else (east, north, up),
    )


def yaml_snippet(bolts: Sequence[Bolt]) -> str:
    """Return `support:` of a design file with these bolts, in lines of at most 100 columns."""
    lines = ["support:", "  bolts:"]
    for bolt in bolts:
        toward = f"{bolt.toward.trend_deg:.10g}/{bolt.toward.plunge_deg:.10g}"
        line = f"    - {{force: {bolt.force_kn:.13g} kN, toward: {toward}, acts: {bolt.acts}"
        if bolt.head_m is not None:
            head = ", ".join(f"{round(coordinate, 6) + 0.0:.12g}" for coordinate in bolt.head_m)
            line += f", head: [{head}]"
        if bolt.length_m is not None:
            line += f", length: {bolt.length_m:.10g} m"
        if len(line) > 98 and bolt.head_m is not None:
            first_line, head_text = line.split(", head", 1)
            lines.append(first_line + ",")
            line = "       head" + head_text
        lines.append(line + "}")
    return "\n".join(lines) + "\n"
