"""A design over arrays of samples, by both methods: each key that varies goes where its field says.

The arguments are asked of a design that has arrays in place of those numbers. At some samples the design is read as
well: where it has another argument (a column of a joint list stands for the strength), or where a key is not one number
of it (the direction of a force), there is no such evaluator, and the samples are read one by one. The worst place of a
crack is looked for in all samples at once: it is one more number of each.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints, NDArray
from slopekit.core.errors import DesignError
from slopekit.core.orientation import Plane
from slopekit.design.common import Design
from slopekit.design.fields import fields_of, parts_of
from slopekit.design.ground_water import SlopeDesign
from slopekit.design.parts import Force, Strength
from slopekit.design.reading.files import with_values
from slopekit.design.reading.reader import strength_of
from slopekit.kinds import kind_of
from slopekit.kinds.single_block.blocks_on_arrays import LimitsOfMany, limits_on_arrays
from slopekit.kinds.single_block.closed_forms import ClosedForms, OnArrays, passive_bolts
from slopekit.kinds.single_block.held_bolts import has_heads, holding_bolts, pulling, stand_off
from slopekit.kinds.single_block.secants import secant_strength
from slopekit.kinds.single_block.worst_crack import ENDLESS, WHERE, Cracked, reach_of_many, worst_of_many
from slopekit.studies.outcomes import ByMethod

#: A design's values at a sample: what `with_values` takes.
ValuesAt = Callable[[int], Mapping[str, object]]
_EXACT = 1e-12
_SMALL = 1e-6  # kPa, kN, m or degrees: below it an argument is nothing but rounding
_PROBES = 8
_TRACTION_KPA = 100.0  # at which laws of samples are compared
PLACE, ANYWHERE_M = "crack.distance", 1.0  # of a crack; and one that is looked for, before it is found
NO_PLACE = "E459"
"""The code of a crack of which no place gives a factor."""


@dataclass(frozen=True)
class Vectorised:
    """A design whose numbers by their keys are columns of samples (n, k).

    Attributes
    ----------
    before : (b,) how far before the face the heads of its bolts were laid out; None where they stay where they are
    searches_crack : the worst place of the crack is looked for in each sample, and is one more column behind its own
    forces : that act beside those of the design, on the crack that is worst without them
    """

    on_arrays: OnArrays[Any]
    design: Design
    keys: Sequence[str]
    before: Floats | None = None
    searches_crack: bool = False
    forces: tuple[Force, ...] = ()

    def rows(self, values: Floats) -> "DesignRows":
        """The designs of samples (n, k), with their cracks at the worst place."""
        if not self.searches_crack:
            return DesignRows(self, values, np.full(len(values), ""))
        design: Any = self.scattered(_with_crack(values, ANYWHERE_M))
        without, reach = reach_of_many(design, self.on_arrays, self.strengths(values))
        words = np.broadcast_to(np.array(without.names)[without.outcome], len(values))
        forms = ~np.char.startswith(words, "E")

        def cracked_at(rows: slice, places: Floats) -> Cracked:
            repeated = _with_crack(np.repeat(values[rows], places.shape[1], axis=0), places.ravel())
            cracked: Any = self.scattered(repeated)
            return cracked, self.strengths(repeated)

        places, where = worst_of_many(design, self.on_arrays, cracked_at, np.where(forms, reach, np.nan))
        known = np.isfinite(places)
        refused = np.where(forms | (words == ENDLESS), NO_PLACE, words)
        cracks = np.where(known, np.array(WHERE)[where], refused)
        return DesignRows(self, _with_crack(values, np.where(known, places, ANYWHERE_M)), cracks)

    def arguments(self, values: Floats) -> dict[str, Any]:
        """The arguments of all samples: (n,) of those that scatter; of curved strength at one traction."""
        design, strengths = DesignRows(self, values, np.full(len(values), "")).numbers
        lines = [secant_strength(strength, _TRACTION_KPA) for strength in strengths]
        pulls = {
            f"bolt{k}_{axis}": pull for k, bolt in enumerate(passive_bolts(design)) for axis, pull in enumerate(bolt)
        }
        return self.on_arrays.arguments(design) | self.on_arrays.strength_arguments(lines) | pulls

    def scattered(self, values: Floats) -> Design:
        """The design with columns of samples (n, k), or the numbers of one of them (k,), but for its strengths."""
        design, joints = self.design, self.design.wet_interfaces
        for path, column in zip(self.keys, values.T, strict=True):
            if not path.startswith("strength."):
                design = _put(design, _place(design, path), column, joints)
        if design.rock.density_kg_m3 is not None:
            weight = design.rock.density_kg_m3 * design.rock.gravity_m_s2 / 1e3
            design = replace(design, rock=replace(design.rock, unit_weight_kn_m3=weight))
        return design

    def strengths(self, values: Floats) -> Sequence[Strength]:
        """The strengths of its joints with such columns, or numbers."""
        design, strengths, joints = self.design, self.design.joint_strengths, self.design.wet_interfaces
        for path, column in zip(self.keys, values.T, strict=False):  # the place of a crack is no strength
            top, *below = path.split(".")
            if top == "strength":
                assert design.source is not None  # of which that is a key
                used = [strength_of(design.source.root, joint) for joint in joints[: len(strengths)]]
                strengths = [
                    _stronger(strength, below[1:], column) if name == below[0] else strength
                    for name, strength in zip(used, strengths, strict=True)
                ]
        return strengths


@dataclass(frozen=True, eq=False)
class DesignRows:
    """n designs at once, which differ in numbers.

    Attributes
    ----------
    values : (n, k) of the columns, the places of cracks that were looked for behind them
    cracks : (n,) of these where in its range each lies, as `WHERE` has it, or the code of why there is no worst place;
        "" where none is looked for
    """

    columns: Vectorised
    values: Floats
    cracks: NDArray[np.str_]

    def __len__(self) -> int:
        return len(self.values)

    def of(self, rows: Ints) -> "DesignRows":
        """Some of them, in the order of `rows`."""
        return DesignRows(self.columns, self.values[rows], self.cracks[rows])

    @cached_property
    def numbers(self) -> tuple[SlopeDesign, Sequence[Strength]]:
        """The design and the strengths of its joints with arrays in place of what differs.

        Bolts that do not hold the block of a row pull nothing there.
        """
        columns = self.columns
        design = columns.scattered(self.values)
        assert isinstance(design, SlopeDesign)
        bolts = map(pulling, design.bolts, self.holds) if has_heads(design.bolts) else design.bolts
        design = replace(design, bolts=tuple(bolts), forces=(*design.forces, *columns.forces))
        return design, columns.strengths(self.values)

    def design_at(self, row: int) -> tuple[SlopeDesign, Sequence[Strength]]:
        """One of the designs, with the bolts that hold its block, and the strengths of its joints."""
        columns, values = self.columns, self.values[row]
        design = columns.scattered(values)
        assert isinstance(design, SlopeDesign)
        holds = np.broadcast_to(self.holds, (len(design.bolts), len(self)))[:, row]
        bolts = tuple(bolt for bolt, does_hold in zip(design.bolts, holds, strict=True) if does_hold)
        return replace(design, bolts=bolts, crack_searched=str(self.cracks[row])), columns.strengths(values)

    @cached_property
    def holds(self) -> Bools:
        """Which bolts (b, n) hold the block of each row; (b, 1) where they are the same ones in all."""
        design = self.columns.scattered(self.values)
        return holding_bolts(self.columns.on_arrays.bounds(design), design.bolts, self.columns.before)[0]

    @cached_property
    def closed_form(self) -> ByMethod:
        """What the closed form says of each; no strength at all is a status, no number."""
        closed = self._each(self.columns.on_arrays.forms(*self.numbers))
        closed = replace(closed, factor=np.where(closed.factor > 0.0, closed.factor, np.nan))
        return closed.refused(self.cracks) if self.columns.searches_crack else closed

    def without_basal(self) -> ByMethod | None:
        """What acceptance of each is held against besides; None where there is nothing."""
        also = self.columns.on_arrays.also
        if also is None or getattr(self.columns.design, "basal", None) is None:
            return None
        return self._each(also(*self.numbers, self.columns.before))

    def _each(self, forms: ClosedForms) -> ByMethod:
        """What a closed form says of each; where nothing that differs is an argument all are alike."""
        outcome, factor = np.broadcast_to(forms.outcome, len(self)), np.broadcast_to(forms.factor, len(self))
        return ByMethod(forms.names, outcome.astype(np.int16), factor)

    def limits(self) -> LimitsOfMany:
        """What PRE-IE says of rows that form blocks by the closed form."""
        design, strengths = self.numbers
        return limits_on_arrays(design, self.columns.on_arrays, strengths, len(self))

    def dilation(self) -> tuple[Bools, Bools]:
        """In which rows (n,) a joint dilates, and in which by more than its friction angle, which no design may."""
        strengths = self.numbers[1]
        each = [np.broadcast_to(strength.dilation_deg, len(self)) for strength in strengths]
        most = [np.inf if strength.law else strength.friction_angle_deg for strength in strengths]
        beyond = [dilation > greatest for dilation, greatest in zip(each, most, strict=True)]
        return np.asarray(np.max(each, axis=0) > 0.0), np.asarray(np.any(beyond, axis=0))

    def sizes(self, forms: Bools) -> dict[str, Floats]:
        """The sizes of their blocks (n,) by their keys, nan where none forms; empty where none are known.

        Parameters
        ----------
        forms : (n,) which of them form a block
        """
        sizes = self.columns.on_arrays.sizes(self.numbers[0])
        return {key: np.where(forms, of, np.nan) for key, of in sizes.items()}


def _with_crack(values: Floats, places: Any) -> Floats:
    """Samples (n, k) with the places of their cracks behind them (n, k + 1)."""
    return np.column_stack([values, np.broadcast_to(places, len(values))])


def vectorised(
    design: Design, values: Floats, values_at: ValuesAt, keys: Sequence[str] | None = None
) -> Vectorised | None:
    """The columns of a design over its samples, None where there are none.

    A crack that is looked for without partial factors stands where no column says: such designs have none.

    Parameters
    ----------
    values : (n, k) samples; values_at : the values of the design's file at one of them, by its number
    keys : of the columns; None takes those of what scatters, and then heads of bolts stand on the face of each sample
    """
    if (on_arrays := kind_of(design).on_arrays) is None:
        return None
    before = None
    if keys is None:
        keys = [key for variable in design.variables for key in variable.columns]
        before = stand_off(on_arrays.bounds(design), design.bolts)
    searches_crack = bool(getattr(design, "crack_searched", ""))
    if searches_crack and design.analysis.partial is not None:
        return None
    if searches_crack:
        design, keys, values = with_values(design, {PLACE: ANYWHERE_M}), [*keys, PLACE], _with_crack(values, ANYWHERE_M)
    made = Vectorised(on_arrays, design, keys, before, searches_crack)
    rows, read = [], []
    for row in dict.fromkeys([*range(min(_PROBES, len(values))), *values.argmin(axis=0), *values.argmax(axis=0)]):
        try:
            sample = with_values(design, values_at(row))
        except DesignError:
            continue  # a sample that no design can have
        read.append(replace(made, design=sample, keys=()).arguments(np.zeros((1, 0))))
        rows.append(row)
    try:
        computed = made.arguments(values[rows]) if rows else {}
    except ValueError:
        return None
    same = (_same(computed[name], [arguments[name] for arguments in read]) for name in computed)
    return made if rows and all(same) else None


def _same(computed: Any, read: Sequence[Any]) -> bool:
    """Whether an argument, one for all or one for each, is what was read."""
    each, of_all = np.array(read, dtype=np.float64).ravel(), np.array(computed, dtype=np.float64)  # None is nan
    return np.allclose(
        of_all, each, rtol=_EXACT, atol=_EXACT * np.nan_to_num(np.abs(each)).max(initial=_SMALL), equal_nan=True
    )


def _stronger(strength: Strength, parts: Sequence[str], values: Floats) -> Strength:
    """A strength with values in place of one of its numbers, or of its law's; no closed form knows the stiffness."""
    straight = {field.path for field in fields_of(Strength).values() if field.is_attribute}
    law = strength.named_law
    if law is None or (law_with := _law_with(law, parts[0], values)) is None:
        changed: Strength = _put(strength, parts, values, ()) if parts[0] in straight else strength
        return changed
    if strength.law is not None:
        return replace(strength, law=law_with, cohesion_kpa=law_with.resistance(np.zeros(1)))
    line = law_with.straight
    return replace(
        strength, cohesion_kpa=line.cohesion_kpa, friction_angle_deg=line.friction_angle_deg, made_of=law_with
    )


def _law_with(law: Any, key: str, values: Floats) -> Any:
    """A law, or the one that waves lie on, with values in place of its number of a key; None where it has none."""
    from slopekit.design.strength_laws import fields_of_law  # most designs name no law

    name = next((name for name, field in fields_of_law(type(law)).items() if field.path == key), None)
    if name is not None:
        return replace(law, **{name: values})
    below = getattr(law, "law", None)
    changed = None if below is None else _law_with(below, key, values)
    return None if changed is None else replace(law, law=changed)


def _place(design: Design, path: str) -> list[str]:
    """The path of a number by the attributes of a design, where that is another than its key's."""
    above = next((key for key in design.INTO if f"{path}.".startswith(f"{key}.")), "")
    return f"{design.INTO[above]}{path.removeprefix(above)}".split(".") if above else path.split(".")


def _put(record: Any, parts: Sequence[str], values: Floats, names: Sequence[str]) -> Any:
    """A record with values in place of the number at a path below it.

    Parameters
    ----------
    names : of interfaces, in the order of whatever has one value for each

    Raises
    ------
    ValueError
        Where there is no such number.
    """
    if isinstance(record, Plane):  # of a joint, by its name
        parts = parts[-1:]
    if isinstance(record, Force) and record.toward is not None and parts[0] != "at":
        vector, toward = record.toward.vector().T, record.toward
        size: Any = sum(part * way for part, way in zip(record.components_kn, vector, strict=True))
        size, toward = (values, toward) if parts[0] == "force" else (size, _put(toward, parts[1:], values, ()))
        return replace(record, components_kn=tuple(size * part for part in toward.vector().T), toward=toward)
    if isinstance(record, tuple):
        k = names.index(parts[0]) if parts[0] in names else int(parts[0])
        return (*record[:k], _put(record[k], parts[1:], values, names), *record[k + 1 :])
    if record is None or isinstance(record, float):
        return values
    for name, of in parts_of(type(record)).items():
        if any(field.path.split(".") == list(parts) for field in fields_of(of).values()):
            return replace(record, **{name: _put(getattr(record, name), parts, values, names)})
    declared = fields_of(type(record))
    paths = {name: [name.removesuffix("_deg")] for name in record.__dataclass_fields__}
    paths |= {name: field.path.split(".") for name, field in declared.items() if field.is_attribute}
    fitting = [name for name, path in paths.items() if parts and list(parts[: len(path)]) == path]
    if not parts:  # a number that stands for a group: its first
        fitting = [name for name, field in declared.items() if field.is_number][:1]
    name = max(fitting, key=lambda one: len(paths[one]))
    return replace(record, **{name: _put(getattr(record, name), parts[len(paths[name]) :], values, names)})
