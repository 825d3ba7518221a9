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
from slopekit.design.fields import field_at, fields_of, parts_of
from slopekit.design.ground_water import SlopeDesign
from slopekit.design.parts import Strength
from slopekit.design.reading.files import with_values
from slopekit.design.reading.reader import strength_of
from slopekit.kinds import kind_of
from slopekit.kinds.single_block.blocks_on_arrays import LimitsOfMany, limits_on_arrays
from slopekit.kinds.single_block.closed_forms import Arguments, ClosedForms, OnArrays
from slopekit.kinds.single_block.held_bolts import held, pulling
from slopekit.kinds.single_block.worst_crack import worst_of_many
from slopekit.studies.evaluation.bolts import as_laid_out, standing

#: A design's values at a sample: what `with_values` takes.
ValuesAt = Callable[[int], Mapping[str, object]]
_EXACT = 1e-12
_SMALL = 1e-6  # kPa, kN, m or degrees: below it an argument is nothing but rounding
_PROBES = 8
_CHUNK = 32768  # samples


@dataclass(frozen=True)
class Vectorised:
    """A closed form over samples (n, k), whose columns are numbers of a design by their keys.

    `before` (b,) is how far before the face the heads of its bolts were laid out.
    """

    on_arrays: OnArrays[Any]
    design: Design
    keys: Sequence[str]
    before: Floats

    def __call__(self, values: Floats) -> ClosedForms:
        """Outcome and factor of every sample; of a design without passive bolts."""
        return _chunked(lambda chunk: self.on_arrays.closed_forms(self.arguments(chunk), ()), values)

    def also(self, values: Floats) -> ClosedForms | None:
        """What acceptance of every sample is held against besides; None where there is nothing."""
        also, strengths_of = self.on_arrays.also, self.on_arrays.of_strengths
        if also is None or getattr(self.design, "basal", None) is None:
            return None
        return _chunked(
            lambda chunk: also(self._standing(chunk), strengths_of(self._strengths(chunk)), self.before), values
        )

    def takes(self, pre_ie: bool) -> bool:
        """Whether both methods, or the closed form alone, take all samples at once: no passive bolts, no dilation."""
        design, on_arrays = self.design, self.on_arrays
        if any(bolt.acts == "passive" for bolt in design.bolts):
            return False
        dilates = any(strength.dilation_deg for strength in on_arrays.strengths(design))
        dilates |= any(key.endswith(".dilation") for key in self.keys)
        return not pre_ie or (on_arrays.full is not None and not dilates)

    def limits(self, values: Floats) -> LimitsOfMany:
        """What PRE-IE says of some samples that form blocks by the closed form."""
        design, strengths = self.at(values)
        return limits_on_arrays(design, self.on_arrays, strengths, len(values))

    def at(self, values: Floats) -> tuple[SlopeDesign, Sequence[Strength]]:
        """The design and the strengths of its joints with arrays in place of what scatters."""
        design = self._standing(values)
        assert isinstance(design, SlopeDesign)
        return design, self._strengths(values)

    def sizes(self, values: Floats, forms: Bools) -> dict[str, Floats]:
        """The sizes of the blocks of every sample (n,) by their keys, nan where none forms; empty where none are known.

        Parameters
        ----------
        forms : (n,) which samples form a block
        """
        sizes = None if self.on_arrays.sizes is None else self.on_arrays.sizes(self._scattered(values))
        return {} if sizes is None else {key: np.where(forms, of, np.nan) for key, of in sizes.columns.items()}

    def holds(self, values: Floats) -> Bools:
        """Which bolts (b, n) hold the block of each sample."""
        return self._holds(self._scattered(values), len(values))

    def _holds(self, design: Design, count: int) -> Bools:
        holds = held(self.on_arrays.bounds(design), design.bolts, self.before)[0]
        return np.broadcast_to(holds, (len(design.bolts), count))

    def worst_cracks(self, values: Floats) -> tuple[ClosedForms, Floats] | None:
        """Of each sample what it is without its crack, and where a crack is worst; None where they are asked alone.

        Bolts pull as they were laid out: those that a place of the crack frees are found with it.
        """
        on_arrays = self.on_arrays
        design: Any = self._scattered(values)
        reach = None if on_arrays.crack_reach_m is None else on_arrays.crack_reach_m(design)
        if reach is None or on_arrays.bolts(self.design):
            return None

        def arguments(rows: slice, places: Floats) -> Arguments:
            repeated = np.repeat(values[rows], places.shape[1], axis=0)
            cracked: Any = self._scattered(repeated)
            cracked = replace(cracked, crack=replace(cracked.crack, distance_m=places.ravel()))
            return on_arrays.arguments(cracked) | on_arrays.of_strengths(self._strengths(repeated))

        places = worst_of_many(design, on_arrays, arguments, np.broadcast_to(reach, len(values)))
        bare = on_arrays.arguments(replace(design, crack=None)) | on_arrays.of_strengths(self._strengths(values))
        bare |= dict.fromkeys(name for name in bare if "crack" in name)
        return _spread(on_arrays.closed_forms(bare, ()), len(values)), places

    def arguments(self, values: Floats) -> Arguments:
        """The arguments of all samples: (n,) of those that scatter."""
        return self.on_arrays.arguments(self._standing(values)) | self.on_arrays.of_strengths(self._strengths(values))

    def _standing(self, values: Floats) -> Design:
        """The design with arrays for what scatters; bolts that do not hold the block of a sample pull nothing."""
        design = self._scattered(values)
        if any(bolt.head_m is not None for bolt in design.bolts):
            design = replace(design, bolts=tuple(map(pulling, design.bolts, self._holds(design, len(values)))))
        return design

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
        design, strengths, joints = self.design, self.on_arrays.strengths(self.design), self.design.wet_interfaces
        assert design.source is not None
        used = [strength_of(design.source.root, joint) for joint in joints[: len(strengths)]]
        straight = {field.path for field in fields_of(Strength).values() if field.is_attribute}
        for path, column in zip(self.keys, values.T, strict=True):
            top, *below = path.split(".")
            if top == "strength" and below[1] in straight:  # no closed form knows the stiffness
                strengths = [
                    _put(strength, below[1:], column, ()) if name == below[0] else strength
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
    keys : of the columns; None takes those of what scatters
    """
    kind = kind_of(design)
    on_arrays = kind.on_arrays
    if on_arrays is None:
        return None
    if any(strength.named_law for strength in kind.strengths(design)):
        # curved strength asks the closed form again and again, sample by sample; straight laws have keys of their own
        return None
    keys = [key for variable in design.variables for key in variable.columns] if keys is None else keys
    before = as_laid_out(design)
    sizes = [key for key in keys if (field := field_at(type(design), key)) is not None and field.shape.coordinates]
    made = Vectorised(on_arrays, with_values(design, dict.fromkeys(sizes, 1.0)), keys, before)  # sizes are multiplied
    rows, read = [], []
    for row in dict.fromkeys([*range(min(_PROBES, len(values))), *values.argmin(axis=0), *values.argmax(axis=0)]):
        try:
            sample = with_values(design, values_at(row))
        except DesignError:
            continue  # a sample that no design can have
        read.append(_pulled(on_arrays.arguments(standing(sample, before)), design))
        rows.append(row)
    try:
        computed = made.arguments(values[rows]) if rows else {}
    except ValueError:
        return None
    same = (_same(computed[name], [arguments[name] for arguments in read]) for name in computed)
    return made if rows and all(same) else None


def _pulled(arguments: Arguments, design: Design) -> Arguments:
    """The arguments of a sample: active bolts that do not hold it pull with nothing."""
    pulls = any(bolt.acts == "active" for bolt in design.bolts)
    return {name: 0.0 if pulls and value is None and name.startswith("force_") else value
            for name, value in arguments.items()}  # fmt: skip


def _same(computed: Any, read: Sequence[float | None]) -> bool:
    """Whether an argument, one for all or one for each, is what was read."""
    each, of_all = np.array(read, dtype=np.float64), np.array(computed, dtype=np.float64)  # None is nan
    return np.allclose(
        of_all, each, rtol=_EXACT, atol=_EXACT * np.nan_to_num(np.abs(each)).max(initial=_SMALL), equal_nan=True
    )


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
    new: dict[str, Any] = {}
    if isinstance(record, Plane):
        new[f"{parts[-1]}_deg"] = values
        return replace(record, **new)
    if isinstance(record, tuple):
        if not parts:
            return tuple(values * part for part in record)  # the size of a force
        k = names.index(parts[0]) if parts[0] in names else int(parts[0])
        return (*record[:k], _put(record[k], parts[1:], values, names), *record[k + 1 :])
    if record is None or isinstance(record, float):
        return values
    for name, of in parts_of(type(record)).items():
        if any(field.path.split(".") == list(parts) for field in fields_of(of).values()):
            return replace(record, **{name: _put(getattr(record, name), parts, values, names)})
    declared = fields_of(type(record))
    paths = {name: [name] for name in record.__dataclass_fields__}
    paths |= {name: field.path.split(".") for name, field in declared.items() if field.is_attribute}
    fitting = [name for name, path in paths.items() if parts and list(parts[: len(path)]) == path]
    if not parts:  # a number that stands for a group: its first
        fitting = [name for name, field in declared.items() if field.is_number][:1]
    name = max(fitting, key=lambda one: len(paths[one]))
    new[name] = _put(getattr(record, name), parts[len(paths[name]) :], values, names)
    return replace(record, **new)
