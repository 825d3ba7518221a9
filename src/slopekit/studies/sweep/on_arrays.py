"""Points of a design all at once, where its kind takes arrays.

A few places and the extreme ones are analysed as designs of their own, and those with a value that the reader of files
refuses, or with nearly parallel joints. Where a run says of the inputs of one of a few what it does not say of all, or
arrays find another answer there, no place is taken on arrays.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.core.errors import DesignError, Notice
from slopekit.design.common import Design
from slopekit.design.ground_water import SlopeDesign
from slopekit.design.parts import Strength
from slopekit.design.reading.files import with_values
from slopekit.evidence import WithoutBasal
from slopekit.kinds import kind_of
from slopekit.kinds.protocol import Factors
from slopekit.kinds.single_block.blocks_on_arrays import LimitsOfMany, limits_on_arrays, shaken_toward
from slopekit.kinds.single_block.held_bolts import nearly_parallel
from slopekit.kinds.single_block.one_block_notices import lost_contact, shaking, without_strength
from slopekit.studies.keys import Key, values_of
from slopekit.studies.outcomes import ByMethod, agreement
from slopekit.studies.points import Point
from slopekit.studies.prob.vectorised import Vectorised, vectorised

#: What a run says because of its answer; all else that it says follows from the inputs.
_OF_ANSWERS = ("W307", "W308", "W328")
_WHOLE = "{whole}"  # stands in a notice for what acceptance is held against besides
_SAME = 1e-6  # of a factor: what arrays and a run make of the same design
_FEW = 9


def some_of(places: Floats) -> list[int]:
    """Return the numbers of places (n, k) that are designs of their own: a few, and the extreme ones."""
    few = np.linspace(0, len(places) - 1, _FEW).astype(np.int64)
    return sorted({int(row) for row in (*few, *places.argmin(axis=0), *places.argmax(axis=0))})


@dataclass(frozen=True)
class PointsOnArrays:
    """The points of a design with other values of some keys, all at once.

    Attributes
    ----------
    columns : the design with arrays in place of its numbers; pre_ie : False asks the closed form alone
    said : what a run says of the inputs; alone : (n,) places that are designs of their own
    """

    columns: Vectorised
    pre_ie: bool
    said: tuple[Notice, ...]
    alone: Bools

    def __call__(self, places: Floats) -> list[Point | None]:
        """Return the points at places (n, k), None where no block forms or none is compared: a run says why."""
        forms, also = self.columns(places), self.columns.also(places)
        words, factor = np.array(forms.names)[forms.outcome], np.where(forms.factor > 0.0, forms.factor, np.nan)
        rows, points = np.flatnonzero(~np.char.startswith(words, "E")), list[Point | None]([None] * len(places))
        closed = ByMethod.of(words[rows].tolist(), factor[rows])
        for row, factors in zip(rows.tolist(), self._factors(places[rows], closed) if len(rows) else (), strict=True):
            whole = None
            if also is not None and (status := also.names[also.outcome[row]]):
                whole = WithoutBasal(status, _known(also.factor[row]))
            if factors is not None:
                points[row] = Point(replace(factors, also=whole, notes=_said(factors.notes, _WHOLE, whole)))
        return points

    def _factors(self, places: Floats, closed: ByMethod) -> Iterator[Factors | None]:
        if not self.pre_ie:
            for status, factor in zip(closed.words, closed.factor, strict=True):
                yield Factors(status, None, status, _known(factor), None, None, False, True)
            return
        design, strengths = self.columns.at(places)
        limits = limits_on_arrays(design, self.columns.on_arrays, strengths, len(places))
        closed = closed.refused(limits.status)
        limit = ByMethod.of(limits.status.tolist(), limits.limit)
        both = agreement(limit, limits.forces, closed, design.analysis.agree_within)
        notes = self._notes(design, strengths, limits)
        for row, (status, other) in enumerate(zip(limit.words, closed.words, strict=True)):
            yield None if status.startswith("E") or both.agree[row] < 0 else Factors(
                status, _known(limit.factor[row]), other, _known(closed.factor[row]), _known(both.difference[row]),
                bool(both.agree[row]), bool(both.moments_govern[row]), True, notes=(*self.said, *next(notes)),
            )  # fmt: skip

    def _notes(
        self, design: SlopeDesign, strengths: Sequence[Strength], limits: LimitsOfMany
    ) -> Iterator[tuple[Notice, ...]]:
        """Yield what a run says of each answer."""
        found, rows, count = limits.found, limits.rows, len(limits.status)
        assert found is not None
        cohesion, friction, shaken = (
            np.stack([np.broadcast_to(number, count)[rows] for number in numbers], axis=1)
            for numbers in (
                [one.cohesion_kpa for one in strengths], [one.friction_angle_deg for one in strengths],
                [design.seismic.coefficient],
            )
        )  # fmt: skip
        answered = ~np.isnan(found.factor)
        loses = (answered & ~found.moments_govern)[:, None] & (found.normal == 0.0) & (cohesion > 0.0)
        bare = np.all((cohesion == 0.0) & (friction == 0.0), axis=1)
        along = np.full(len(rows), np.nan)
        if shaken.any():
            moved = found.velocity[:, :3]
            size = np.sqrt((moved * moved).sum(axis=1))
            ways = shaken_toward(design, self.columns.on_arrays, count)[rows]
            shows = answered & (shaken[:, 0] > 0.0) & (size > 0.0)
            along[shows] = (ways * moved).sum(axis=1)[shows] / size[shows]
        joints, block = design.wet_interfaces, kind_of(design).words.block
        for lost, cosine, nothing in zip(loses, along.tolist(), bare, strict=True):
            yield (
                *(lost_contact(joints[k]) for k in np.flatnonzero(lost)),
                *(() if np.isnan(cosine) else shaking(cosine)),
                *([without_strength(block)] if nothing else ()),
            )


def points_on_arrays(
    design: Design, keys: Sequence[Key], places: Floats, known: Mapping[int, Point], pre_ie: bool
) -> PointsOnArrays | None:
    """Return what finds all points of a design at once, None where it has to be asked place by place.

    Parameters
    ----------
    places : (n, k) values of the keys; known : points that were analysed as designs, by the numbers of their places
    """
    if any(bolt.head_m is not None for bolt in design.bolts):
        return None
    try:  # with whatever has to be written first
        fullest = with_values(design, values_of(design, keys, places[places[:, 0].argmax()].tolist()))
    except DesignError:
        return None
    columns = vectorised(
        fullest, places, lambda row: values_of(design, keys, places[row].tolist()), [key.path for key in keys]
    )
    of_inputs = {
        tuple(note for note in _said(point.notes, point.also, _WHOLE) if note.code not in _OF_ANSWERS)
        for point in known.values()
        if point.factors is not None
    }
    if columns is None or (pre_ie and not columns.has_limits) or len(of_inputs) != 1:
        return None
    with np.errstate(divide="ignore", invalid="ignore"):  # at places whose planes cut no block
        alone = nearly_parallel(columns.on_arrays.bounds(columns.at(places)[0]), len(places))
    for key, values in zip(keys, places.T, strict=True):
        alone |= np.isin(values, [value for value in np.unique(values).tolist() if _refused(design, key, value)])
    at_once = PointsOnArrays(columns, pre_ie, of_inputs.pop(), alone)
    compared = [row for row in known if not alone[row]]
    found = at_once(places[compared]) if compared else []
    return at_once if all(map(_alike, found, (known[row] for row in compared))) else None


def _refused(design: Design, key: Key, value: float) -> bool:
    """Whether the reader of files refuses a value: a friction angle that looks like radians."""
    try:
        with_values(design, values_of(design, [key], [value]))
    except DesignError:
        return True
    return False


def _said(
    notes: Iterable[Notice], of: WithoutBasal | str | None, other: WithoutBasal | str | None
) -> tuple[Notice, ...]:
    """Return notices with the words of one thing in place of those of another; as they are without either."""
    old, new = (one.in_words() if isinstance(one, WithoutBasal) else one for one in (of, other))
    if old is None or new is None:
        return tuple(notes)
    return tuple(replace(note, message=note.message.replace(old, new)) for note in notes)


def _alike(one: Point | None, other: Point) -> bool:
    """Whether arrays say what a run says."""
    ours, runs = None if one is None else one.factors, other.factors
    if ours is None or runs is None:
        return ours is runs
    (a, b), (c, d) = (
        ([of.limit or np.nan, of.closed_form or np.nan],
         (of.status, of.closed_status, of.agree, of.moments_govern, set(of.notes)))
        for of in (ours, runs)
    )  # fmt: skip
    return b == d and np.allclose(a, c, rtol=_SAME, atol=0.0, equal_nan=True)


def _known(value: float) -> float | None:
    return None if np.isnan(value) else float(value)
