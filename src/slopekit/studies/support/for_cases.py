"""Bolts that satisfy every load case of a design: those of the case that governs, tried in all others."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from operator import attrgetter
from typing import Any

from slopekit.core.errors import GeometryError
from slopekit.core.records import dataclass
from slopekit.core.sheet import Column, Section, Table, counted
from slopekit.design.common import Design
from slopekit.design.parts import Bolt
from slopekit.kinds import also_falls_short, dilates, factors_of
from slopekit.studies.cases import InCase, in_each_case
from slopekit.studies.support.records import Acts, BoltCase, Support, built_force, enough, snippet, written
from slopekit.studies.support.search import closed_form_answer, limit_answer

_RAISED, _LEAST, _MOST = 16, 1.001, 1.5  # rounds in which forces are raised; by so much at least, at most
_CLOSE = 1.002  # of forces that satisfy all and that do not
_OVER = 1e-4  # of a bolt's capacity: the force on a metre of slope is written with five digits, rounded up


def options(design: Design, given: Mapping[str, Any]) -> dict[str, Any]:
    """What the study of a case takes: the factor that its acceptance asks for, where no other is wanted."""
    asked = design.accepted_fos
    return {**({} if asked is None else {"fos": asked}), **given}


@dataclass(frozen=True, slots=True)
class Tried:
    """Bolts in all cases.

    Attributes
    ----------
    acts : how they act; governing : the case that they were found for
    bolts : as they are built; raised : how much more force they have than that case alone needs, 1 for none
    inside : every case with them; most : force of the strongest, kN
    capacity : of a bolt, kN; slice_m : the length of slope that a force in the design stands for, 1 in space
    """

    acts: Acts
    governing: str
    bolts: tuple[Bolt, ...]
    raised: float
    inside: tuple[InCase, ...]
    capacity: float
    slice_m: float

    @property
    def force(self) -> float:
        """Of all of them, kN."""
        return sum(bolt.force_kn for bolt in self.bolts)

    @property
    def met(self) -> bool:
        """Whether every case is satisfied by bolts that there are."""
        return all(one.met for one in self.inside) and self.most <= self.capacity * (1.0 + _OVER)

    @property
    def most(self) -> float:
        """The force of the strongest bolt, kN."""
        return self.slice_m * max((bolt.force_kn for bolt in self.bolts), default=0.0)


@dataclass(frozen=True, slots=True)
class SupportForAll:
    """What satisfies all cases, for each way the bolts act; nothing where all stand as they are."""

    found: Mapping[str, Support]
    tried: tuple[Tried, ...]
    lacking: tuple[str, ...]

    @property
    def stands(self) -> bool:
        """Whether no case needs anything."""
        return all(one.stands for one in self.found.values())

    @property
    def best(self) -> Tried | None:
        """The bolts of least force that satisfy all cases."""
        return min((one for one in self.tried if one.met), key=lambda one: one.force, default=None)

    @property
    def governing(self) -> str:
        """The case whose bolts satisfy all; else the first that lacks them."""
        if self.best is not None:
            return self.best.governing
        return next((name for name, one in self.found.items() if not one.reached), next(iter(self.found)))

    @property
    def exit_code(self) -> int:
        """0 found or nothing needed, 1 no bolts satisfy all cases, 4 the methods disagree."""
        if any(one.exit_code == 4 for one in self.found.values()):
            return 4
        return 0 if self.stands or self.best is not None else 1

    @property
    def line(self) -> str:
        """What satisfies all cases."""
        if self.stands:
            return f"all {len(self.found)} cases stand as they are"
        one = self.best
        if one is None:
            return f"NOT REACHED in all cases: {'; '.join(self.lacking) or 'see the cases'}"
        return f"{_what(one, self.found)} for all {len(self.found)} cases, {one.governing} governs"

    def sections(self) -> list[Section]:
        """What satisfies all, and every case with it."""
        if self.stands or not (self.tried or self.lacking):
            return [Section("FOR ALL", [self.line])]
        return [Section("FOR ALL", [*self._entries(), *self.lacking])]

    def _entries(self) -> list[Any]:
        entries: list[Any] = []
        for one in self.tried:
            said = f"{one.acts}: {_what(one, self.found)}; {one.governing} governs"
            if one.raised > 1.0:
                said += f", its force raised by {(one.raised - 1.0) * 100:.2g} % for the other cases"
            entries += [said if one.met else f"{said}: NOT REACHED", _table(one.inside)]
        return entries

    def files(self) -> dict[str, str]:
        """`support:` of a design file for each way the bolts act."""
        return {f"support-{one.acts}.yaml": self._yaml(one) for one in self.tried if one.met}

    def _yaml(self, one: Tried) -> str:
        existing = {support.design.bolts for support in self.found.values()}
        if len(existing) == 1:
            return snippet((*next(iter(existing)), *one.bolts))
        return "# beside the bolts that are there: they differ from case to case\n" + snippet(one.bolts)

    def to_dict(self) -> dict[str, Any]:
        """As JSON values."""
        best = self.best
        return {
            "reached": self.exit_code == 0, "stands": self.stands, "governing": self.governing,
            "acts": None if best is None else best.acts,
            "bolts": [
                {
                    "acts": one.acts, "governing": one.governing, "met": one.met, "count": len(one.bolts),
                    "force_kn": one.force, "raised": one.raised, "yaml": self._yaml(one),
                    "cases": _table(one.inside).records(),
                } for one in self.tried
            ],
            "lacking": list(self.lacking),
        }  # fmt: skip


def _what(one: Tried, supports: Mapping[str, Support]) -> str:
    unit = next(iter(supports.values())).unit
    return f"{counted(len(one.bolts), f'{one.acts} bolt')}, {one.force:.1f} {unit} in all"


def _table(inside: Sequence[InCase]) -> Table[InCase]:
    return in_each_case("with them", inside, Column("status", attrgetter("status"), "status"))


def for_all(supports: Mapping[str, Support], given: Mapping[str, Any]) -> SupportForAll:
    """Bolts for all cases, for each way they act.

    The bolts of the case that needs most force come first: with them the others are asked. Where one of them is not
    satisfied, the bolts of every case are tried with more force, and those of least force are taken.
    """
    if all(one.stands for one in supports.values()):
        return SupportForAll(supports, (), ())
    tried, lacking = list[Tried](), list[str]()
    for acts in next(iter(supports.values())).options.acts:
        built = {
            name: case for name, one in supports.items() for case in one.cases if case.acts == acts and not one.stands
        }
        short = [name for name, case in built.items() if not case.reached or not case.bolts]
        if short:
            lacking.append(f"{acts} bolts alone do not satisfy {', '.join(short)}")
            continue
        tried.append(_for_all(acts, built, supports))
    return SupportForAll(supports, tuple(tried), tuple(lacking))


def _for_all(acts: Acts, built: Mapping[str, BoltCase], supports: Mapping[str, Support]) -> Tried:
    def total(name: str) -> float:
        return sum(bolt.force_kn for bolt in built[name].bolts)

    names = sorted(built, key=total, reverse=True)
    first = _tried(acts, names[0], built[names[0]], supports)
    if first.met:
        return first
    raised = [_raised(first if name == names[0] else _tried(acts, name, built[name], supports), supports)
              for name in names]  # fmt: skip
    return min(raised, key=lambda one: (not one.met, one.force))


def _tried(acts: Acts, governing: str, case: BoltCase, supports: Mapping[str, Support]) -> Tried:
    """Every load case with the bolts that were found for one of them."""
    capacity = supports[governing].options.capacity
    return Tried(acts, governing, case.bolts, 1.0, _in_cases(case.bolts, supports), capacity, case.slice_m)


def _with_more(first: Tried, factor: float, supports: Mapping[str, Support]) -> Tried:
    """Every load case with bolts of so much more force, up to full steps as they are built."""
    slice_m = first.slice_m
    bolts = tuple(
        written(replace(bolt, force_kn=built_force(slice_m * bolt.force_kn * factor, first.capacity) / slice_m))
        for bolt in first.bolts
    )
    return replace(first, bolts=bolts, raised=factor, inside=_in_cases(bolts, supports))


def _in_cases(bolts: tuple[Bolt, ...], supports: Mapping[str, Support]) -> tuple[InCase, ...]:
    return tuple(_in_case(name, one, bolts) for name, one in supports.items())


def _in_case(name: str, one: Support, bolts: tuple[Bolt, ...]) -> InCase:
    design = replace(one.design, bolts=(*one.design.bolts, *bolts))
    try:
        both = factors_of(design)
    except GeometryError as error:  # another block, which these bolts miss
        return InCase(name, one.target, error.codes[0], None, None, False)
    reached = enough(one.target, closed_form_answer(both), limit_answer(both), dilates(design))
    met = reached and not also_falls_short(both.also, one.target, "")
    return InCase(name, one.target, both.status, both.limit, both.closed_form, met)


def _raised(one: Tried, supports: Mapping[str, Support]) -> Tried:
    """Bolts with so much force that all cases are satisfied, within a part of it; the last where no force does it."""
    first, low, high = one, 1.0, math.inf
    best = one
    for _ in range(_RAISED):
        lacking = [row for row in one.inside if not row.met]
        if not lacking:
            best, high = one, one.raised
        else:
            best, low = (one, one.raised) if math.isinf(high) else (best, one.raised)
        if high <= low * _CLOSE:
            break
        step = max(_more(row, supports[row.case]) for row in lacking) if math.isinf(high) else math.sqrt(high / low)
        one = _with_more(first, low * step, supports)
    return best


def _more(row: InCase, support: Support) -> float:
    """By how much force has to grow, from what it has brought so far."""
    level = min((value for value in (row.limit, row.closed_form) if value is not None), default=0.0)
    bare = min(support.pre_ie.search_level, support.closed_form.search_level)
    rise = level - bare
    if not (rise > 0.0 and math.isfinite(rise)):
        return _MOST
    return min(max(1.0 + 1.01 * (row.target - level) / rise, _LEAST), _MOST)
