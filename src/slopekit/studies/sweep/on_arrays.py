"""Points of a design all at once, where its kind takes arrays.

The first places and the extreme ones are analysed as designs of their own. Where a run says of the inputs of one of
them what it does not say of all, or arrays find another answer there, no place is taken on arrays.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.errors import DesignError, Notice
from slopekit.design.common import Design
from slopekit.design.ground_water import SlopeDesign
from slopekit.design.parts import Strength
from slopekit.design.reading.files import with_values
from slopekit.evidence import WithoutBasal
from slopekit.kinds import kind_of
from slopekit.kinds.protocol import Factors
from slopekit.kinds.single_block.blocks_on_arrays import AnswersOnArrays, answers_on_arrays, shaken_toward
from slopekit.kinds.single_block.one_block_notices import lost_contact, shaking, without_strength
from slopekit.studies.keys import Key, values_of
from slopekit.studies.outcomes import ByMethod, agreement
from slopekit.studies.points import Point
from slopekit.studies.prob.vectorised import Vectorised, vectorised
from slopekit.studies.running import Record

#: What a run says because of its answer; all else that it says follows from the inputs.
_OF_ANSWERS = ("W307", "W308", "W328")
_WHOLE = "{whole}"  # stands in a notice for what acceptance is held against besides
_SAME = 1e-6  # of a factor: what arrays and a run make of the same design
_FIRST = 8


def probes_of(places: Floats) -> list[int]:
    """Return the numbers of places (n, k) that are designs of their own: the first ones, and the extreme."""
    return list(dict.fromkeys([*range(min(_FIRST, len(places))), *places.argmin(axis=0), *places.argmax(axis=0)]))


@dataclass(frozen=True)
class PointsOnArrays:
    """The points of a design with other values of some keys, all at once.

    Attributes
    ----------
    columns : the design with arrays in place of its numbers; pre_ie : False asks the closed form alone
    said : what a run says of the inputs
    """

    columns: Vectorised
    pre_ie: bool
    said: tuple[Notice, ...] = ()

    def __call__(self, places: Floats) -> Record:
        """Return the records of the points at places (n, k), None where no block forms: what a worker does."""
        return {"points": [None if point is None else point.to_record() for point in self.points(places)]}

    def points(self, places: Floats) -> list[Point | None]:
        """Return the points at places (n, k), None where no block forms: its own analysis says why."""
        forms, also = self.columns(places), self.columns.also(places)
        closed = ByMethod.of(np.array(forms.names)[forms.outcome].tolist(), forms.factor)
        rows, points = np.flatnonzero(~closed.among("E")), list[Point | None]([None] * len(places))
        if not len(rows):
            return points
        factor = np.where(closed.factor > 0.0, closed.factor, np.nan)
        closed = ByMethod(closed.names, closed.outcome[rows], factor[rows])
        found = self._by_both(places[rows], closed) if self.pre_ie else _by_closed_form(closed)
        for row, factors in zip(rows.tolist(), found, strict=True):
            if factors is not None:
                whole = None
                if also is not None and (status := also.names[also.outcome[row]]):
                    whole = WithoutBasal(status, _known(also.factor[row]))
                points[row] = Point(replace(factors, also=whole, notes=_said(factors.notes, _WHOLE, whole)))
        return points

    def _by_both(self, places: Floats, closed: ByMethod) -> Iterator[Factors | None]:
        design, strengths = self.columns.at(places)
        answers = answers_on_arrays(design, self.columns.on_arrays, strengths, len(places))
        closed = closed.refused(answers.limits.status)
        limit = ByMethod.of(answers.limits.status.tolist(), answers.limits.limit)
        both = agreement(limit, answers.limits.forces, closed, design.analysis.agree_within)
        notes = iter(self._notes(design, strengths, answers))
        for row, (status, other) in enumerate(zip(_words(limit), _words(closed), strict=True)):
            if status.startswith("E"):
                yield None
                continue
            yield Factors(
                status,
                _known(limit.factor[row]),
                other,
                _known(closed.factor[row]),
                _known(both.difference[row]),
                None if both.agree[row] < 0 else bool(both.agree[row]),
                bool(both.moments_govern[row]),
                True,
                notes=(*self.said, *next(notes)),
            )

    def _notes(
        self, design: SlopeDesign, strengths: Sequence[Strength], answers: AnswersOnArrays
    ) -> Iterator[tuple[Notice, ...]]:
        """Yield what a run says of each answer."""
        found, rows, count = answers.found, answers.rows, len(answers.limits.status)
        if found is None:
            return
        joints, block = design.wet_interfaces, kind_of(design).words.block
        cohesion, friction = (
            np.stack([np.broadcast_to(getattr(one, name), count)[rows] for one in strengths], axis=1)
            for name in ("cohesion_kpa", "friction_angle_deg")
        )
        answered = ~np.isnan(found.factor)
        loses = (answered & ~found.moments_govern)[:, None] & (found.normal == 0.0) & (cohesion > 0.0)
        bare = np.all((cohesion == 0.0) & (friction == 0.0), axis=1)
        along = np.full(len(rows), np.nan)
        if np.any(design.seismic.coefficient):
            ways, moved = shaken_toward(design, self.columns.on_arrays, count)[rows], found.velocity[:, :3]
            shaken = answered & (np.broadcast_to(design.seismic.coefficient, count)[rows] > 0.0)
            size = np.sqrt((moved * moved).sum(axis=1))
            along[shaken] = ((ways * moved).sum(axis=1) / np.where(size > 0.0, size, np.nan))[shaken]
        for lost, own, nothing in zip(loses.tolist(), along.tolist(), bare.tolist(), strict=True):
            yield (
                *(lost_contact(joints[k]) for k, of in enumerate(lost) if of),
                *(shaking(own) if own == own else ()),
                *([without_strength(block)] if nothing else ()),
            )


def points_on_arrays(
    design: Design, keys: Sequence[Key], places: Floats, probes: Sequence[tuple[int, Point]], pre_ie: bool
) -> PointsOnArrays | None:
    """Return what finds all points of a design at once, None where it has to be asked place by place.

    Parameters
    ----------
    places : (n, k) values of the keys; probes : numbers of places and their points, each analysed as a design
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
    if columns is None or (pre_ie and not columns.has_limits):
        return None
    said = {
        tuple(note for note in _said(point.notes, point.also, _WHOLE) if note.code not in _OF_ANSWERS)
        for _, point in probes
        if point.factors is not None
    }
    if len(said) != 1:
        return None
    made = PointsOnArrays(columns, pre_ie, *said)
    found = made.points(places[[row for row, _ in probes]])
    return made if all(_alike(*both) for both in zip(found, (point for _, point in probes), strict=True)) else None


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
    if one is None or one.factors is None or other.factors is None:
        return one is None and other.factors is None
    ours, runs = one.factors, other.factors
    words = (ours.status, ours.closed_status, ours.agree, ours.moments_govern, set(ours.notes))
    return words == (runs.status, runs.closed_status, runs.agree, runs.moments_govern, set(runs.notes)) and all(
        (a is None) == (b is None) and (a is None or b is None or abs(a - b) <= _SAME * b)
        for a, b in ((ours.limit, runs.limit), (ours.closed_form, runs.closed_form))
    )


def _by_closed_form(closed: ByMethod) -> Iterator[Factors]:
    for status, factor in zip(_words(closed), closed.factor.tolist(), strict=True):
        yield Factors(status, None, status, _known(factor), None, None, False, True)


def _words(method: ByMethod) -> list[str]:
    words: list[str] = np.array(method.names, dtype=object)[method.outcome].tolist()
    return words


def _known(value: float) -> float | None:
    return None if value != value else float(value)
