"""Evaluate a design over arrays of samples, by both methods: arrays take the place of the numbers that vary.

The arguments of the closed form are those of a design with arrays in place of its numbers. At some samples the design
is read from its file as well. Where that gives another argument (a column of a joint list stands for the strength), or
where a key is not one number of the design (the direction of a force), there are no arrays and the samples are read one
by one. The worst place of a crack is found in all samples at once, as a further column.
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
from slopekit.design.fields import fields_of, nested_records
from slopekit.design.ground_water import SlopeDesign
from slopekit.design.parts import Force, Strength
from slopekit.design.reading.files import with_values
from slopekit.design.reading.reader import strength_of
from slopekit.kinds import kind_of
from slopekit.kinds.single_block.blocks_on_arrays import LimitsOfMany, limits_on_arrays
from slopekit.kinds.single_block.closed_forms import ClosedForms, OnArrays, passive_bolts
from slopekit.kinds.single_block.held_bolts import has_heads, head_offset, holding_bolts, pulling
from slopekit.kinds.single_block.secants import secant_strength
from slopekit.kinds.single_block.worst_crack import (
    ENDLESS,
    WHERE,
    Cracked,
    reach_of_many,
    worst_of_many,
)
from slopekit.studies.outcomes import ByMethod

#: Returns the values of the design at a sample, by its number, as `with_values` takes them.
ValuesAt = Callable[[int], Mapping[str, object]]
_READ_TOLERANCE = 1e-12
_LEAST_ARGUMENT = 1e-6  # kPa, kN, m or degrees: a smaller argument is rounding
_PROBES = 8
_TRACTION_KPA = 100.0  # at which curved strength laws are compared
PLACE, ANYWHERE_M = (
    "crack.distance",
    1.0,
)  # the key of a crack's place; a provisional one where the worst is sought, m
NO_PLACE = "E459"
"""The code of a crack that has no factor at any place."""


@dataclass(frozen=True)
class Vectorised:
    """A design that takes columns of samples (n, k) in place of the numbers of its keys.

    Attributes
    ----------
    head_offsets : (b,) distance of the heads of its bolts in front of the face, m, which they keep; None where heads
        stay where they are
    searches_crack : the worst place of the crack is sought in each sample, and is a further last column
    forces : further forces, which act with the crack that is worst without them
    """

    on_arrays: OnArrays[Any]
    design: Design
    keys: Sequence[str]
    head_offsets: Floats | None = None
    searches_crack: bool = False
    forces: tuple[Force, ...] = ()

    def rows(self, values: Floats) -> "DesignRows":
        """Return the designs of samples (n, k), with their cracks at the worst place."""
        if not self.searches_crack:
            return DesignRows(self, values, np.full(len(values), ""))
        design: Any = self.scattered(_with_crack(values, ANYWHERE_M))
        uncracked, reach = reach_of_many(design, self.on_arrays, self.strengths(values))
        words = np.broadcast_to(np.array(uncracked.names)[uncracked.outcome], len(values))
        forms = ~np.char.startswith(words, "E")

        def cracked_at(rows: slice, places: Floats) -> Cracked:
            repeated = _with_crack(np.repeat(values[rows], places.shape[1], axis=0), places.ravel())
            cracked: Any = self.scattered(repeated)
            return cracked, self.strengths(repeated)

        places, locations = worst_of_many(
            design, self.on_arrays, cracked_at, np.where(forms, reach, np.nan)
        )
        has_place = np.isfinite(places)
        refused = np.where(forms | (words == ENDLESS), NO_PLACE, words)
        cracks = np.where(has_place, np.array(WHERE)[locations], refused)
        return DesignRows(
            self, _with_crack(values, np.where(has_place, places, ANYWHERE_M)), cracks
        )

    def arguments(self, values: Floats) -> dict[str, Any]:
        """Return the arguments of the closed form: (n,) of those that vary; curved strength at one traction."""
        design, strengths = DesignRows(self, values, np.full(len(values), "")).numbers
        lines = [secant_strength(strength, _TRACTION_KPA) for strength in strengths]
        pulls = {
            f"bolt{k}_{axis}": pull
            for k, bolt in enumerate(passive_bolts(design))
            for axis, pull in enumerate(bolt)
        }
        return self.on_arrays.arguments(design) | self.on_arrays.strength_arguments(lines) | pulls

    def scattered(self, values: Floats) -> Design:
        """Return the design with columns of samples (n, k), or the numbers of one sample (k,), except its strengths."""
        design, joints = self.design, self.design.wet_interfaces
        for path, column in zip(self.keys, values.T, strict=True):
            if not path.startswith("strength."):
                design = _with_values_at(design, _attribute_path(design, path), column, joints)
        if design.rock.density_kg_m3 is not None:
            weight = design.rock.density_kg_m3 * design.rock.gravity_m_s2 / 1e3
            design = replace(design, rock=replace(design.rock, unit_weight_kn_m3=weight))
        return design

    def strengths(self, values: Floats) -> Sequence[Strength]:
        """Return the strengths of the joints with columns of samples (n, k), or the numbers of one sample (k,)."""
        design, strengths, joints = (
            self.design,
            self.design.joint_strengths,
            self.design.wet_interfaces,
        )
        for path, column in zip(
            self.keys, values.T, strict=False
        ):  # without the last column, the place of a crack
            top, *below = path.split(".")
            if top == "strength":
                assert design.source is not None  # as a key of it is given
                file_strengths = [
                    strength_of(design.source.root, joint) for joint in joints[: len(strengths)]
                ]
                strengths = [
                    _with_strength_values(strength, below[1:], column)
                    if name == below[0]
                    else strength
                    for name, strength in zip(file_strengths, strengths, strict=True)
                ]
        return strengths


@dataclass(frozen=True, eq=False)
class DesignRows:
    """Designs (n) on arrays, which differ in the values of their keys.

    Attributes
    ----------
    values : (n, k) of the columns, the worst places of cracks last where these are sought
    cracks : (n,) where in its range the crack lies, as in `WHERE`, or the code of why there is no worst place; ""
        where none is sought
    """

    columns: Vectorised
    values: Floats
    cracks: NDArray[np.str_]

    def __len__(self) -> int:
        return len(self.values)

    def take(self, rows: Ints) -> "DesignRows":
        """Return the designs with numbers `rows`, in that order."""
        return DesignRows(self.columns, self.values[rows], self.cracks[rows])

    @cached_property
    def numbers(self) -> tuple[SlopeDesign, Sequence[Strength]]:
        """The design and the strengths of its joints, with arrays in place of the numbers that vary.

        Bolts that miss the block of a row have no force there.
        """
        columns = self.columns
        design = columns.scattered(self.values)
        assert isinstance(design, SlopeDesign)
        bolts = map(pulling, design.bolts, self.holds) if has_heads(design.bolts) else design.bolts
        design = replace(design, bolts=tuple(bolts), forces=(*design.forces, *columns.forces))
        return design, columns.strengths(self.values)

    def design_at(self, row: int) -> tuple[SlopeDesign, Sequence[Strength]]:
        """Return the design of a row with the bolts that hold its block, and the strengths of its joints."""
        columns, values = self.columns, self.values[row]
        design = columns.scattered(values)
        assert isinstance(design, SlopeDesign)
        holds = np.broadcast_to(self.holds, (len(design.bolts), len(self)))[:, row]
        bolts = tuple(
            bolt for bolt, does_hold in zip(design.bolts, holds, strict=True) if does_hold
        )
        return replace(
            design, bolts=bolts, crack_searched=str(self.cracks[row])
        ), columns.strengths(values)

    @cached_property
    def holds(self) -> Bools:
        """Which bolts (b, n) hold the block of each row; (b, 1) where they are the same ones in all."""
        design = self.columns.scattered(self.values)
        return holding_bolts(
            self.columns.on_arrays.bounds(design), design.bolts, self.columns.head_offsets
        )[0]

    @cached_property
    def closed_form(self) -> ByMethod:
        """The outcomes of the closed form; a factor of 0, without any strength, counts as none."""
        closed = self._by_row(self.columns.on_arrays.forms(*self.numbers))
        closed = replace(closed, factor=np.where(closed.factor > 0.0, closed.factor, np.nan))
        return closed.refused(self.cracks) if self.columns.searches_crack else closed

    def without_basal(self) -> ByMethod | None:
        """Return the outcomes of the wedges without basal plane, which acceptance requires too; None without any."""
        closed_form = self.columns.on_arrays.whole_wedges
        if closed_form is None or getattr(self.columns.design, "basal", None) is None:
            return None
        return self._by_row(closed_form(*self.numbers, self.columns.head_offsets))

    def _by_row(self, forms: ClosedForms) -> ByMethod:
        """Return the outcomes of a closed form by row, also where none of its arguments varies."""
        outcome, factor = (
            np.broadcast_to(forms.outcome, len(self)),
            np.broadcast_to(forms.factor, len(self)),
        )
        return ByMethod(forms.names, outcome.astype(np.int16), factor)

    def limits(self) -> LimitsOfMany:
        """Return the limits by PRE-IE of rows that form blocks by the closed form."""
        design, strengths = self.numbers
        return limits_on_arrays(design, self.columns.on_arrays, strengths, len(self))

    def dilation(self) -> tuple[Bools, Bools]:
        """Return in which rows (n,) a joint dilates, and in which by more than its friction angle, which is invalid."""
        strengths = self.numbers[1]
        dilations = [np.broadcast_to(strength.dilation_deg, len(self)) for strength in strengths]
        limits = [np.inf if strength.law else strength.friction_angle_deg for strength in strengths]
        exceeds = [dilation > limit for dilation, limit in zip(dilations, limits, strict=True)]
        return np.asarray(np.max(dilations, axis=0) > 0.0), np.asarray(np.any(exceeds, axis=0))

    def sizes(self, forms: Bools) -> dict[str, Floats]:
        """Return the sizes of the blocks (n,) by key, nan where no block forms; empty where the kind has no sizes.

        Parameters
        ----------
        forms : (n,) which of them form a block
        """
        sizes = self.columns.on_arrays.sizes(self.numbers[0])
        return {key: np.where(forms, values, np.nan) for key, values in sizes.items()}


def _with_crack(values: Floats, places: Any) -> Floats:
    """Return samples (n, k) with the places of their cracks as a last column (n, k + 1)."""
    return np.column_stack([values, np.broadcast_to(places, len(values))])


def vectorised(
    design: Design, values: Floats, values_at: ValuesAt, keys: Sequence[str] | None = None
) -> Vectorised | None:
    """Return the columns of a design on arrays, None where there are none.

    There are none where the worst crack is sought with partial factors: no column has the place of that crack.

    Parameters
    ----------
    values : (n, k) samples; values_at : the values of the design's file at one of them, by its number
    keys : of the columns; None takes those of the random variables, with heads of bolts on the face of each sample
    """
    if (on_arrays := kind_of(design).on_arrays) is None:
        return None
    head_offsets = None
    if keys is None:
        keys = [key for variable in design.variables for key in variable.columns]
        head_offsets = head_offset(on_arrays.bounds(design), design.bolts)
    searches_crack = bool(getattr(design, "crack_searched", ""))
    if searches_crack and design.analysis.partial is not None:
        return None
    if searches_crack:
        design, keys, values = (
            with_values(design, {PLACE: ANYWHERE_M}),
            [*keys, PLACE],
            _with_crack(values, ANYWHERE_M),
        )
    columns = Vectorised(on_arrays, design, keys, head_offsets, searches_crack)
    rows, read_arguments = [], []
    for row in dict.fromkeys(
        [*range(min(_PROBES, len(values))), *values.argmin(axis=0), *values.argmax(axis=0)]
    ):
        try:
            sample = with_values(design, values_at(row))
        except DesignError:
            continue  # a sample that no design can have
        read_arguments.append(replace(columns, design=sample, keys=()).arguments(np.zeros((1, 0))))
        rows.append(row)
    try:
        computed = columns.arguments(values[rows]) if rows else {}
    except ValueError:
        return None
    agreements = (
        _agrees(computed[name], [arguments[name] for arguments in read_arguments])
        for name in computed
    )
    return columns if rows and all(agreements) else None


def _agrees(computed: Any, read: Sequence[Any]) -> bool:
    """Return whether a computed argument, one for all or one a sample, equals the one of the design that was read."""
    read_numbers, computed_numbers = (
        np.array(read, dtype=np.float64).ravel(),
        np.array(computed, dtype=np.float64),
    )  # None is nan
    return np.allclose(
        computed_numbers,
        read_numbers,
        rtol=_READ_TOLERANCE,
        atol=_READ_TOLERANCE * np.nan_to_num(np.abs(read_numbers)).max(initial=_LEAST_ARGUMENT),
        equal_nan=True,
    )


def _with_strength_values(strength: Strength, steps: Sequence[str], values: Floats) -> Strength:
    """Return a strength with values in place of one of its numbers, or of its law's; stiffness has no effect."""
    straight = {field.path for field in fields_of(Strength).values() if field.is_attribute}
    law = strength.named_law
    if law is None or (law_with := _law_with(law, steps[0], values)) is None:
        changed: Strength = (
            _with_values_at(strength, steps, values, ()) if steps[0] in straight else strength
        )
        return changed
    if strength.law is not None:
        return replace(strength, law=law_with, cohesion_kpa=law_with.resistance(np.zeros(1)))
    line = law_with.straight
    return replace(
        strength,
        cohesion_kpa=line.cohesion_kpa,
        friction_angle_deg=line.friction_angle_deg,
        made_of=law_with,
    )


def _law_with(law: Any, key: str, values: Floats) -> Any:
    """Return a law, or the one below its waviness, with values in place of a number; None where it has no such key."""
    from slopekit.design.strength_laws import fields_of_law  # most designs name no law

    name = next(
        (name for name, field in fields_of_law(type(law)).items() if field.path == key), None
    )
    if name is not None:
        return replace(law, **{name: values})
    below = getattr(law, "law", None)
    changed = None if below is None else _law_with(below, key, values)
    return None if changed is None else replace(law, law=changed)


def _attribute_path(design: Design, path: str) -> list[str]:
    """Return the path of a number by the attributes of a design, which may differ from its key."""
    above = next((key for key in design.ATTRIBUTE_OF_KEY if f"{path}.".startswith(f"{key}.")), "")
    return (
        f"{design.ATTRIBUTE_OF_KEY[above]}{path.removeprefix(above)}".split(".")
        if above
        else path.split(".")
    )


def _with_values_at(record: Any, steps: Sequence[str], values: Floats, names: Sequence[str]) -> Any:
    """Return a record with values in place of the number at a path below it.

    Parameters
    ----------
    names : of interfaces, in the order of whatever has one value for each

    Raises
    ------
    ValueError
        Where there is no such number.
    """
    if isinstance(record, Plane):  # of a joint, by its name
        steps = steps[-1:]
    if isinstance(record, Force) and record.toward is not None and steps[0] != "at":
        vector, toward = record.toward.vector().T, record.toward
        size: Any = sum(
            component * cosine
            for component, cosine in zip(record.components_kn, vector, strict=True)
        )
        size, toward = (
            (values, toward)
            if steps[0] == "force"
            else (size, _with_values_at(toward, steps[1:], values, ()))
        )
        return replace(
            record,
            components_kn=tuple(size * component for component in toward.vector().T),
            toward=toward,
        )
    if isinstance(record, tuple):
        k = names.index(steps[0]) if steps[0] in names else int(steps[0])
        return (*record[:k], _with_values_at(record[k], steps[1:], values, names), *record[k + 1 :])
    if record is None or isinstance(record, float):
        return values
    for name, part_type in nested_records(type(record)).items():
        if any(field.path.split(".") == list(steps) for field in fields_of(part_type).values()):
            return replace(
                record, **{name: _with_values_at(getattr(record, name), steps, values, names)}
            )
    declared = fields_of(type(record))
    paths = {name: [name.removesuffix("_deg")] for name in record.__dataclass_fields__}
    paths |= {name: field.path.split(".") for name, field in declared.items() if field.is_attribute}
    fitting = [name for name, path in paths.items() if steps and list(steps[: len(path)]) == path]
    if not steps:  # a number that stands for a group: its first
        fitting = [name for name, field in declared.items() if field.is_number][:1]
    name = max(fitting, key=lambda candidate: len(paths[candidate]))
    return replace(
        record,
        **{name: _with_values_at(getattr(record, name), steps[len(paths[name]) :], values, names)},
    )
