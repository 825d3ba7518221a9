"""Bolts that satisfy every load case of a design: those of the case that governs, tried in all others."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from operator import attrgetter
from typing import Any

from slopekit.core.errors import GeometryError
from slopekit.core.records import dataclass
from slopekit.core.sheet import Column, Section, Table, counted, factor_text
from slopekit.design.parts import Bolt
from slopekit.kinds import also_falls_short, dilates, factors_of
from slopekit.studies.support.records import Acts, BoltCase, Support, enough, snippet
from slopekit.studies.support.search import closed_form_answer, limit_answer


@dataclass(frozen=True, slots=True)
class InCase:
    """A load case with the bolts: what it asks for, what both methods give, whether that is enough.

    Attributes
    ----------
    status : of PRE-IE, or why there is none
    """

    case: str
    target: float
    status: str
    limit: float | None
    closed_form: float | None
    met: bool


@dataclass(frozen=True, slots=True)
class Tried:
    """Bolts in all cases.

    Attributes
    ----------
    acts : how they act; governing : the case that they were found for
    bolts : as they are built; inside : every case with them
    """

    acts: Acts
    governing: str
    bolts: tuple[Bolt, ...]
    inside: tuple[InCase, ...]

    @property
    def force(self) -> float:
        """Of all of them, kN."""
        return sum(bolt.force_kn for bolt in self.bolts)

    @property
    def met(self) -> bool:
        """Whether every case is satisfied by bolts that there are."""
        return all(one.met for one in self.inside)


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
                    "force_kn": one.force, "yaml": self._yaml(one),
                    "cases": _table(one.inside).records(),
                } for one in self.tried
            ],
            "lacking": list(self.lacking),
        }  # fmt: skip


def _what(one: Tried, supports: Mapping[str, Support]) -> str:
    unit = next(iter(supports.values())).unit
    return f"{counted(len(one.bolts), f'{one.acts} bolt')}, {one.force:.1f} {unit} in all"


def _table(inside: Sequence[InCase]) -> Table[InCase]:
    def factor(value: float | None) -> str:
        return factor_text(value).strip()

    columns: list[Column[InCase]] = [
        Column("with them", attrgetter("case"), "case", width=-22),
        Column("asks", attrgetter("target"), "target_fos", show=".4g", width=7),
        Column("FoS", attrgetter("limit"), "limit", show=factor, width=9),
        Column("closed form", attrgetter("closed_form"), "closed_form", show=factor, width=13),
        Column("met", attrgetter("met"), "met", show=lambda met: "yes" if met else "NO", width=6),
        Column("  status", attrgetter("status"), "status", width=-1, about="  {}"),
    ]
    return Table(columns, inside)


def for_all(supports: Mapping[str, Support]) -> SupportForAll:
    """Bolts for all cases, for each way they act.

    The bolts of the case that needs most force come first: with them the others are asked. Where one of them is not
    satisfied, those of every other case are tried, and the ones of least force that satisfy all are taken.
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
    every = [first, *(_tried(acts, name, built[name], supports) for name in names[1:])]
    return min(every, key=lambda one: (not one.met, one.force))


def _tried(acts: Acts, governing: str, case: BoltCase, supports: Mapping[str, Support]) -> Tried:
    """Every load case with the bolts that were found for one of them."""
    return Tried(acts, governing, case.bolts, tuple(_in_case(name, one, case.bolts) for name, one in supports.items()))


def _in_case(name: str, one: Support, bolts: tuple[Bolt, ...]) -> InCase:
    design = replace(one.design, bolts=(*one.design.bolts, *bolts))
    try:
        both = factors_of(design)
    except GeometryError as error:  # another block, which these bolts miss
        return InCase(name, one.target, error.codes[0], None, None, False)
    reached = enough(one.target, closed_form_answer(both), limit_answer(both), dilates(design))
    met = reached and not also_falls_short(both.also, one.target, "")
    return InCase(name, one.target, both.status, both.limit, both.closed_form, met)
