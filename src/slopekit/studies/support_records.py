"""What support is asked for, and what it came to: needs by method, patterns, cases, their JSON (a contract)."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

import numpy as np

from slopekit.arrays import Floats
from slopekit.design.common import Bolt, Design
from slopekit.design.words import above_zero, line_of_words
from slopekit.errors import DesignError, Fault, Faults, Notice
from slopekit.orientation import Line, number
from slopekit.studies.points import study_head
from slopekit.studies.support_directions import Optimum
from slopekit.studies.support_pattern import Layout
from slopekit.studies.support_search import Answer
from slopekit.units import quantity

Which = Literal["best", "given", "practical"]
Acts = Literal["active", "passive"]


@dataclass(frozen=True, slots=True)
class Options:
    """Options of a support study: kN, m, degrees.

    Attributes
    ----------
    target : factor of safety
    acts : how bolts act; toward : direction of their force on the block, None where none is given
    plunge : limits of the practical direction, None without
    capacity : of a bolt; spacing : None where it follows from the force; bond : anchorage behind the joint
    length : of every bolt, None where each is as long as it must be
    """

    target: float
    acts: tuple[Acts, ...]
    toward: Line | None
    plunge: tuple[float, float] | None
    capacity: float
    spacing: float | None
    bond: float
    length: float | None

    def to_dict(self) -> dict[str, Any]:
        """The options as JSON values."""
        return {
            "acts": list(self.acts), "toward": None if self.toward is None else asdict(self.toward),
            "plunge_deg": None if self.plunge is None else list(self.plunge), "bolt_capacity_kn": self.capacity,
            "spacing_m": self.spacing, "bond_m": self.bond, "length_m": self.length,
        }  # fmt: skip


def read_options(
    *, fos: object, acts: object, toward: object, plunge: object, bolt_capacity: object, spacing: object, bond: object,
    length: object,
) -> Options:  # fmt: skip
    """Read options as a user gives them.

    Raises
    ------
    DesignError
        E321 with every option that is not understood, and what `quantity` raises.
    """
    faults = Faults()

    def positive(value: object, kind: str, name: str, option: str) -> float | None:
        where = f"{option} {value}"
        return None if value is None else faults.of(lambda: above_zero(value, kind, name, "E321", where))

    target = positive(fos, "ratio", "the target factor of safety", "--fos")
    capacity = positive(bolt_capacity, "force", "the capacity of a bolt", "--bolt-capacity")
    apart = positive(spacing, "length", "the spacing of the bolts", "--spacing")
    anchorage = positive(bond, "length", "the anchorage behind the joint", "--bond")
    long = positive(length, "length", "the length of the bolts", "--length")
    both = faults.of(lambda: _acts(acts))
    line = toward if isinstance(toward, Line) or toward is None else faults.of(
        lambda: line_of_words(toward, "the bolts", "E321", f"--toward {toward}")
    )  # fmt: skip
    limits = None if plunge is None else faults.of(lambda: _plunges(plunge))
    if target is None and not faults:
        faults.append(Fault("E321", "the target factor of safety is missing", "--fos", "For example --fos 1.5."))
    if faults or target is None or capacity is None or anchorage is None or both is None:
        raise DesignError(faults or [Fault("E321", "capacity and bond are needed", "--bolt-capacity, --bond")])
    return Options(target, both, line, limits, capacity, apart, anchorage, long)


def _acts(value: object) -> tuple[Acts, ...]:
    if value is None or value == "both":
        return "active", "passive"
    if value == "active":
        return ("active",)
    if value == "passive":
        return ("passive",)
    advice = "Leave it out for both."
    raise DesignError([Fault("E321", f"bolts are active or passive, not {value}", f"--acts {value}", advice)])


def _plunges(value: object) -> tuple[float, float]:
    where = f"--plunge {value}"
    parts = re.split(r"\s*[,:]\s*", value.strip()) if isinstance(value, str) else value
    if not isinstance(parts, Sequence) or len(parts) != 2:
        advice = "Write least,most: --plunge -5,15; positive is downward into the rock."
        raise DesignError([Fault("E321", f"limits of plunge are two numbers, not {value}", where, advice)])
    low, high = (quantity(part, "angle", "a limit of plunge", where) for part in parts)
    if not -90.0 <= low <= high <= 90.0:
        message = f"limits of plunge run from low to high between -90 and 90, not {number(low)} to {number(high)}"
        raise DesignError([Fault("E321", message, where)])
    return low, high


@dataclass(frozen=True, slots=True)
class Need:
    """What one method needs.

    Attributes
    ----------
    force : kN (a plane's: per metre; a pressure: kPa), None where it cannot reach the target
    fos, status : with that force put back; without one the best that was met
    below : the factor just under the force, where it jumps over the target
    notice : why not, or what to know
    """

    force: float | None
    fos: float | None
    status: str
    below: float | None = None
    moments_govern: bool = False
    agree: bool | None = None
    notice: Notice | None = None

    def to_dict(self, name: str = "force_kn") -> dict[str, Any]:
        """The need as JSON values."""
        return {
            name: self.force, "fos": _finite(self.fos), "status": self.status, "reached": self.force is not None,
            "jumps_from": self.below, "moments_govern": self.moments_govern, "agree": self.agree,
            "notice": _notice(self.notice),
        }  # fmt: skip


@dataclass(frozen=True, slots=True)
class Pattern:
    """Bolts with their heads on the face.

    Attributes
    ----------
    layout : heads, rows, columns, spacing; None where no bolt can stand
    force : in all, kN (a plane's: per metre), None where none reaches the target with the moments
    each : kN of a bolt; lengths : (n,) m, least length of each with its anchorage; taken : (n,) m as designed
    asked, first : the force that is enough through the centroid, kN, and the factor that it gives with the heads
    need : PRE-IE with the heads where they are
    groups : how many bolts PRE-IE took them for
    notices : why there is none, or what to know
    """

    layout: Layout | None
    notices: tuple[Notice, ...]
    force: float | None = None
    each: float | None = None
    lengths: Floats = field(default_factory=lambda: np.zeros(0))
    taken: Floats = field(default_factory=lambda: np.zeros(0))
    per_m2: float | None = None
    asked: float | None = None
    first: float | None = None
    need: Need | None = None
    groups: int = 0

    @property
    def reached(self) -> bool:
        """Whether these bolts give the target: in number, length and strength."""
        return self.force is not None and not any(notice.code in ("E326", "E327", "E328") for notice in self.notices)

    def to_dict(self) -> dict[str, Any]:
        """The pattern as JSON values."""
        laid = self.layout
        return {
            "reached": self.reached,
            "bolts": None if laid is None else len(laid),
            "needed": None if laid is None else laid.needed,
            "rows": None if laid is None else laid.rows,
            "columns": None if laid is None else laid.columns,
            "spacing_m": None if laid is None else {"across": laid.across_m, "up": laid.up_m},
            "left_out": None if laid is None else laid.left_out,
            "force_kn": self.force,
            "each_kn": self.each,
            "per_m2_kn": self.per_m2,
            "shortest_m": float(self.lengths.min()) if len(self.lengths) else None,
            "longest_m": float(self.lengths.max()) if len(self.lengths) else None,
            "centroid_force_kn": self.asked,
            "fos_at_centroid_force": _finite(self.first),
            "pre_ie": None if self.need is None else self.need.to_dict(),
            "groups": self.groups,
            "heads_m": [] if laid is None else laid.heads_m.tolist(),
            "least_lengths_m": self.lengths.tolist(),
            "lengths_m": self.taken.tolist(),
            "notices": [_notice(notice) for notice in self.notices],
        }


@dataclass(frozen=True, slots=True)
class Case:
    """Bolts that act one way, in one direction.

    Attributes
    ----------
    which : best of all directions, given, or practical (best within limits of plunge)
    toward : None where no direction reaches the target
    closed_form : through the centroid, as it sees all forces; pre_ie : through the centroid, its own root
    most : force above which the closed form falls below the target again, None without an end
    optimum : evidence that the direction is the best, None for a given one
    pattern : heads on the face, of the direction that is built; None for others
    bolts : what goes into the design beside the bolts that are there, empty where the target is out of reach
    dilates : the joints dilate, which the closed form does not know: PRE-IE's number counts, even where it is less
    """

    acts: Literal["active", "passive"]
    which: Which
    toward: Line | None
    closed_form: Need
    pre_ie: Need | None
    most: float | None = None
    optimum: Optimum | None = None
    pattern: Pattern | None = None
    bolts: tuple[Bolt, ...] = ()
    dilates: bool = False

    @property
    def reached(self) -> bool:
        """Whether both methods reach the target: PRE-IE with the heads on the face where those are laid out."""
        if self.pattern is not None:
            return self.closed_form.force is not None and self.pattern.reached
        return self.force is not None

    @property
    def force(self) -> float | None:
        """The force to use, None where a method does not reach the target.

        With heads on the face it is PRE-IE's with their moments, through the centroid the larger of both methods'.
        """
        if self.closed_form.force is None:
            return None
        if self.pattern is not None and self.pattern.reached:
            return self.pattern.force
        if self.pre_ie is None or self.pre_ie.force is None:
            return None
        return self.pre_ie.force if self.dilates else max(self.closed_form.force, self.pre_ie.force)

    def to_dict(self, existing: Sequence[Bolt], unit: str) -> dict[str, Any]:
        """The case as JSON values."""
        best = self.optimum
        return {
            "acts": self.acts,
            "direction": self.which,
            "toward": None if self.toward is None else _line(self.toward),
            "reached": self.reached,
            "use_kn": self.force,
            "closed_form": self.closed_form.to_dict(),
            "pre_ie": None if self.pre_ie is None else self.pre_ie.to_dict(),
            "most_kn": self.most,
            "optimum": None if best is None else {
                "is_minimum": best.is_minimum, "scanned": best.scanned, "least_scanned_kn": _finite(best.least_scanned),
                "one_degree_off_kn": [_finite(force) for force in best.around],
            },
            "pattern": None if self.pattern is None else self.pattern.to_dict(),
            "support": {"bolts": [bolt_words(bolt) for bolt in (*existing, *self.bolts)]} if self.bolts else None,
            "yaml": snippet((*existing, *self.bolts)) if self.bolts else None,
        }  # fmt: skip


@dataclass(frozen=True, slots=True)
class Pressure:
    """An even pressure on the face, square to it: kPa by each method, the area and the point its force acts on."""

    closed_form: Need
    pre_ie: Need | None
    area: float
    toward: Line
    at: tuple[float, float, float]
    dilates: bool = False

    @property
    def use(self) -> float | None:
        """The pressure to use, kPa: the larger (of dilating joints PRE-IE's), None where a method has none."""
        if self.pre_ie is None or self.pre_ie.force is None or self.closed_form.force is None:
            return None
        return self.pre_ie.force if self.dilates else max(self.closed_form.force, self.pre_ie.force)

    def force_words(self) -> dict[str, Any] | None:
        """The force of the pressure to use, as a design file's `loads.forces` takes it."""
        if self.use is None:
            return None
        return {"force": self.use * self.area, "toward": _line_words(self.toward), "at": list(self.at)}

    def to_dict(self) -> dict[str, Any]:
        """The pressure as JSON values."""
        return {
            "use_kpa": self.use,
            "closed_form": self.closed_form.to_dict("pressure_kpa"),
            "pre_ie": None if self.pre_ie is None else self.pre_ie.to_dict("pressure_kpa"),
            "face_area_m2": self.area,
            "toward": _line(self.toward),
            "at_m": list(self.at),
            "force": self.force_words(),
        }


@dataclass(frozen=True, slots=True)
class Support:
    """What a design needs.

    Attributes
    ----------
    target : factor of safety; options : what was asked for
    closed_form, pre_ie : without more support
    cases : by how the bolts act and their direction, empty where nothing is needed
    pressure : on the face; None where nothing is needed
    weight : kN; face_area : m²; unit : kN, or kN/m of a plane
    """

    design: Design
    target: float
    options: Options
    closed_form: Answer
    pre_ie: Answer
    cases: tuple[Case, ...]
    pressure: Pressure | None
    weight: float
    face_area: float
    unit: str
    warnings: tuple[Notice, ...]
    dilates: bool = False
    seconds: float = field(default=0.0, compare=False)

    @property
    def stands(self) -> bool:
        """Whether both methods (of dilating joints PRE-IE) reach the target without more support."""
        return enough(self.target, self.closed_form, self.pre_ie, self.dilates)

    @property
    def built(self) -> tuple[Case, ...]:
        """The cases of the direction that is built: given, else practical, else best."""
        return tuple(case for case in self.cases if case.pattern is not None or case.which == built_way(self.options))

    @property
    def reached(self) -> bool:
        """Whether nothing is needed, or some bolts in the direction that is built give the target."""
        return self.stands or any(case.reached for case in self.built)

    def snippets(self) -> Mapping[str, str]:
        """What is to be built, as `support:` of a design file, by the name of a file: for each way the bolts act."""
        found = {}
        for case in self.built:
            if case.bolts:
                found[f"support-{case.acts}.yaml"] = snippet((*self.design.bolts, *case.bolts))
        return found

    @property
    def exit_code(self) -> int:
        """0 reached, 1 not reached, 4 the methods disagree or PRE-IE did not converge."""
        answers = [case.pre_ie for case in self.cases if case.pre_ie is not None]
        if self.pre_ie.agree is False or any(need.agree is False for need in answers):
            return 4
        return 0 if self.reached else 1

    def to_dict(self) -> dict[str, Any]:
        """The support as JSON values; times stand in a block of their own."""
        return {
            **study_head("support", self.design),
            "target_fos": self.target,
            "unit": self.unit,
            "reached": self.reached,
            "needed": not self.stands,
            "without": {
                "fos": {"limit": self.pre_ie.factor, "closed_form": self.closed_form.factor},
                "status": self.pre_ie.status, "closed_form_status": self.closed_form.status,
                "moments_govern": self.pre_ie.moments_govern, "agree": self.pre_ie.agree,
            },
            "weight_kn": self.weight,
            "face_area_m2": self.face_area,
            "dilates": self.dilates,
            "existing_bolts": len(self.design.bolts),
            "options": self.options.to_dict(),
            "bolts": [case.to_dict(self.design.bolts, self.unit) for case in self.cases],
            "pressure": None if self.pressure is None else self.pressure.to_dict(),
            "warnings": [notice.to_dict() for notice in self.warnings],
            "timing_s": {"total": self.seconds},
        }  # fmt: skip


def enough(target: float, closed_form: Answer, pre_ie: Answer, dilates: bool) -> bool:
    """Whether a design reaches a target as it is."""
    return pre_ie.level >= target and (dilates or closed_form.level >= target)


def built_way(options: Options) -> Which:
    """Which direction is built: the one given, else the practical one, else the best."""
    return "given" if options.toward is not None else "practical" if options.plunge is not None else "best"


# -- words and JSON -----------------------------------------------------------------------------------------------


def bolt_words(bolt: Bolt) -> dict[str, Any]:
    """A bolt as a design file writes it."""
    words: dict[str, Any] = {"force": bolt.force_kn, "toward": _line_words(bolt.toward), "acts": bolt.acts}
    if bolt.head_m is not None:
        words["head"] = list(bolt.head_m)
    if bolt.length_m is not None:
        words["length"] = bolt.length_m
    return words


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


def _line(line: Line) -> dict[str, float]:
    return {"trend_deg": line.trend_deg, "plunge_deg": line.plunge_deg}


def _line_words(line: Line) -> str:
    return f"{line.trend_deg!r}/{line.plunge_deg!r}"


def _notice(notice: Notice | None) -> dict[str, str] | None:
    return None if notice is None else notice.to_dict()


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None
