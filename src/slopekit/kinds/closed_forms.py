"""What designs give to a closed form over arrays, and what it says of them."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeAlias

import numpy as np
from numpy.typing import NDArray

from slopekit.arrays import Floats
from slopekit.design.common import Design
from slopekit.errors import Fault, GeometryError
from slopekit.kinds.protocol import ClosedForm, D

#: The arguments of a closed form by name; None for what a design does not have.
Arguments: TypeAlias = dict[str, float | None]


@dataclass(frozen=True, slots=True)
class ClosedForms:
    """A closed form of n designs: names of outcomes, the number of each design's (n,), factors (n,) or nan."""

    names: tuple[str, ...]
    outcome: NDArray[np.int8]
    factor: Floats

    def of(self, design: int = 0) -> ClosedForm:
        """One of them.

        Raises
        ------
        GeometryError
            Its planes cut no block.
        """
        name, factor = self.names[self.outcome[design]], float(self.factor[design])
        if name.startswith("E"):
            raise GeometryError([Fault(name, "the planes enclose no block")])
        return ClosedForm(None if math.isnan(factor) else factor, name)


@dataclass(frozen=True, slots=True)
class OnArrays(Generic[D]):
    """A closed form that takes many designs in one call.

    Attributes
    ----------
    arguments : of a design, but for its passive bolts; bolts : these, at full capacity
    closed_forms : designs by their arguments and the bolts that they share; each of the arguments is one number for all
        of them or an array
    """

    arguments: Callable[[D], Arguments]
    bolts: Callable[[D], Sequence[Sequence[float]]]
    closed_forms: Callable[[Mapping[str, Any], Sequence[Sequence[float]]], ClosedForms]

    def of(self, design: D) -> ClosedForm:
        """One design. Raises GeometryError where its planes cut no block."""
        return self.closed_forms(self.arguments(design), self.bolts(design)).of()

    def answers(self, designs: Sequence[D], nothing: str) -> list[tuple[float | None, str]]:
        """Factor and status of each of several designs, in one call for all that have the same arguments and bolts.

        Parameters
        ----------
        nothing : the status of planes that cut no block
        """
        given = [self.arguments(design) for design in designs]
        alike: dict[tuple[tuple[str, ...], tuple[tuple[float, ...], ...]], list[int]] = {}
        for number, (design, arguments) in enumerate(zip(designs, given, strict=True)):
            missing = tuple(name for name, value in arguments.items() if value is None)
            alike.setdefault((missing, tuple(tuple(bolt) for bolt in self.bolts(design))), []).append(number)
        found: dict[int, tuple[float | None, str]] = {}
        for (_, bolts), numbers in alike.items():
            columns: dict[str, Any] = {}
            for name, first in given[numbers[0]].items():
                values = [given[number][name] for number in numbers]
                columns[name] = first if values.count(first) == len(values) else np.array(values)
            forms = self.closed_forms(columns, bolts)
            for place, number in enumerate(numbers):
                try:
                    form = forms.of(place if forms.outcome.size > 1 else 0)
                except GeometryError:
                    found[number] = None, nothing
                else:
                    found[number] = form.factor, form.status
        return [found[number] for number in range(len(designs))]


def force_on(design: Design) -> Arguments:
    """The sum of the forces and the active bolts: east, north, up; None without any."""
    pulls: list[Sequence[float]] = [force.components_kn for force in design.forces]
    pulls += _bolts(design, "active")
    names = ("force_east", "force_north", "force_up")
    return dict(zip(names, np.sum(pulls, axis=0).tolist(), strict=True)) if pulls else dict.fromkeys(names)


def passive_bolts(design: Design) -> list[list[float]]:
    """East, north and up of each passive bolt at full capacity, kN."""
    return _bolts(design, "passive")


def _bolts(design: Design, acts: str) -> list[list[float]]:
    return [(bolt.force_kn * bolt.toward.vector()).tolist() for bolt in design.bolts if bolt.acts == acts]
