"""The closed form of a design over arrays of samples: each key that scatters goes where its field says.

The arguments are asked of a design that has arrays in place of those numbers. At some samples the design is read as
well: where it has another argument (a column of a joint list stands for the strength), or where a key is not one number
of it (the direction of a force), there is no such evaluator, and the samples are read one by one.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Floats
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
from slopekit.kinds.single_block.held_bolts import has_heads, held, pulling, stand_off
from slopekit.kinds.single_block.secants import secant_strength
from slopekit.kinds.single_block.worst_crack import ENDLESS, Cracked, reach_of_many, worst_of_many

#: A design's values at a sample: what `with_values` takes.
ValuesAt = Callable[[int], Mapping[str, object]]
_EXACT = 1e-12
_SMALL = 1e-6  # kPa, kN, m or degrees: below it an argument is nothing but rounding
_PROBES = 8
_TRACTION_KPA = 100.0  # at which laws of samples are compared
_CHUNK = 32768  # samples


@dataclass(frozen=True)
class Vectorised:
    """A closed form over samples (n, k), whose columns are numbers of a design by their keys.

    `before` (b,) is how far before the face the heads of its bolts were laid out; None where they stay where they are.
    """

    on_arrays: OnArrays[Any]
    design: Design
    keys: Sequence[str]
    before: Floats | None = None

    def __call__(self, values: Floats) -> ClosedForms:
        """Outcome and factor of every sample."""
        return _chunked(lambda chunk: self.on_arrays.forms(*self.at(chunk)), values)

    def also(self, values: Floats) -> ClosedForms | None:
        """What acceptance of every sample is held against besides; None where there is nothing."""
        also = self.on_arrays.also
        if also is None or getattr(self.design, "basal", None) is None:
            return None
        return _chunked(lambda chunk: also(*self.at(chunk), self.before), values)

    def dilation(self, values: Floats) -> tuple[Bools, Bools]:
        """In which samples (n,) a joint dilates, and in which by more than its friction angle, which no design may."""
        strengths = self._strengths(values)
        each = [np.broadcast_to(strength.dilation_deg, len(values)) for strength in strengths]
        most = [np.inf if strength.law else strength.friction_angle_deg for strength in strengths]
        beyond = [dilation > greatest for dilation, greatest in zip(each, most, strict=True)]
        return np.asarray(np.max(each, axis=0) > 0.0), np.asarray(np.any(beyond, axis=0))

    def limits(self, values: Floats) -> LimitsOfMany:
        """What PRE-IE says of some samples that form blocks by the closed form."""
        design, strengths = self.at(values)
        return limits_on_arrays(design, self.on_arrays, strengths, len(values))

    def at(self, values: Floats) -> tuple[SlopeDesign, Sequence[Strength]]:
        """The design and the strengths of its joints with arrays in place of what scatters."""
        design = self._scattered(values)
        assert isinstance(design, SlopeDesign)
        if has_heads(design.bolts):  # bolts that do not hold the block of a sample pull nothing
            design = replace(design, bolts=tuple(map(pulling, design.bolts, self.holds(values))))
        return design, self._strengths(values)

    def sizes(self, values: Floats, forms: Bools) -> dict[str, Floats]:
        """The sizes of the blocks of every sample (n,) by their keys, nan where none forms; empty where none are known.

        Parameters
        ----------
        forms : (n,) which samples form a block
        """
        sizes = self.on_arrays.sizes(self._scattered(values))
        return {} if sizes is None else {key: np.where(forms, of, np.nan) for key, of in sizes.columns.items()}

    def holds(self, values: Floats) -> Bools:
        """Which bolts (b, n) hold the block of each sample; (b, 1) where they are the same ones in all."""
        design = self._scattered(values)
        return held(self.on_arrays.bounds(design), design.bolts, self.before)[0]

    def worst_cracks(self, values: Floats) -> tuple[Floats, Bools]:
        """Where the crack of each sample is worst, and in which of those that form a block no place gives a factor.

        There, and without a block, it is where the design has it: any place says the same of a sample without a block.
        Bolts pull as they were laid out: those that a place of the crack frees are found with it.
        """
        on_arrays = self.on_arrays
        design: Any = self._scattered(values)
        without, reach = reach_of_many(design, on_arrays, self._strengths(values))
        words = np.broadcast_to(np.array(without.names)[without.outcome], len(values))
        endless = words == ENDLESS
        reach = np.where(endless, np.nan, reach)

        def cracked_at(rows: slice, places: Floats) -> Cracked:
            repeated = np.repeat(values[rows], places.shape[1], axis=0)
            cracked: Any = self._scattered(repeated)
            cracked = replace(cracked, crack=replace(cracked.crack, distance_m=places.ravel()))
            return cracked, self._strengths(repeated)

        forms, found = ~np.char.startswith(words, "E") | endless, worst_of_many(design, on_arrays, cracked_at, reach)[0]
        known = forms & np.isfinite(found)
        return np.where(known, found, design.crack.distance_m), forms & ~known

    def arguments(self, values: Floats) -> dict[str, Any]:
        """The arguments of all samples: (n,) of those that scatter; of curved strength at one traction."""
        design, strengths = self.at(values)
        lines = [secant_strength(strength, _TRACTION_KPA) for strength in strengths]
        pulls = {
            f"bolt{k}_{axis}": pull for k, bolt in enumerate(passive_bolts(design)) for axis, pull in enumerate(bolt)
        }
        return self.on_arrays.arguments(design) | self.on_arrays.strength_arguments(lines) | pulls

    def _scattered(self, values: Floats) -> Design:
        """The design with arrays in place of what scatters, but for its strengths."""
        design, joints = self.design, self.design.wet_interfaces
        for path, column in zip(self.keys, values.T, strict=True):
            if not path.startswith("strength."):
                design = _put(design, _place(design, path), column, joints)
        if design.rock.density_kg_m3 is not None:
            weight = design.rock.density_kg_m3 * design.rock.gravity_m_s2 / 1e3
            design = replace(design, rock=replace(design.rock, unit_weight_kn_m3=weight))
        return design

    def _strengths(self, values: Floats) -> Sequence[Strength]:
        """The strengths of its joints with arrays in place of what scatters."""
        design, strengths, joints = self.design, self.design.joint_strengths, self.design.wet_interfaces
        assert design.source is not None
        used = [strength_of(design.source.root, joint) for joint in joints[: len(strengths)]]
        for path, column in zip(self.keys, values.T, strict=True):
            top, *below = path.split(".")
            if top == "strength":
                strengths = [
                    _stronger(strength, below[1:], column) if name == below[0] else strength
                    for name, strength in zip(used, strengths, strict=True)
                ]
        return strengths


def _chunked(forms: Callable[[Floats], ClosedForms], values: Floats) -> ClosedForms:
    """The closed forms of all samples, so many at once that the faces of their blocks stay small in memory."""
    chunks = [values[first : first + _CHUNK] for first in range(0, len(values), _CHUNK)]
    results = [_spread(forms(chunk), len(chunk)) for chunk in chunks]
    outcome, factor = (np.concatenate([getattr(result, name) for result in results]) for name in ("outcome", "factor"))
    return ClosedForms(results[0].names, outcome, factor)


def _spread(forms: ClosedForms, count: int) -> ClosedForms:
    """The closed form of each sample where nothing that scatters is an argument: all are alike."""
    return ClosedForms(forms.names, np.broadcast_to(forms.outcome, count), np.broadcast_to(forms.factor, count))


def vectorised(
    design: Design, values: Floats, values_at: ValuesAt, keys: Sequence[str] | None = None
) -> Vectorised | None:
    """The evaluator of a design over its samples, None where there is none.

    Parameters
    ----------
    values : (n, k) samples; values_at : the values of the design's file at one of them, by its number
    keys : of the columns; None takes those of what scatters, and then heads of bolts stand on the face of each sample
    """
    if (on_arrays := kind_of(design).on_arrays) is None:
        return None
    before = None if keys is not None else stand_off(on_arrays.bounds(design), design.bolts)
    keys = [key for variable in design.variables for key in variable.columns] if keys is None else keys
    made = Vectorised(on_arrays, design, keys, before)
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
