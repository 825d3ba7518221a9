"""Formulas on arrays, recorded once and repeated on one chunk of numbers after the other, in memory that stays near.

Written as usual, a formula in NumPy takes fresh memory for every sum, and that costs as much as the sum. Played from a
tape, every step writes to one of a few rows that the cache holds, and Python does nothing but call NumPy.
"""

from collections.abc import Iterable, Mapping
from functools import partial
from typing import Any, Final

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
_LINE: Final = 8  # float64 in a line of the cache
_BOOLS: Final = {np.less, np.greater, np.less_equal, np.greater_equal, np.bitwise_and, np.bitwise_or, np.invert}
_OUT_BY_NAME: Final = {np.maximum, np.minimum}  # NumPy warns of a third argument


class Step(NDArrayOperatorsMixin):
    """A value on a tape: what is given, or what a step makes of others. Operators and ufuncs add further steps."""

    __slots__ = ("inputs", "makes_bools", "name", "number", "tape", "ufunc")

    def __init__(self, tape: "Tape", ufunc: np.ufunc | None, inputs: tuple[Any, ...], name: str = "") -> None:
        self.tape, self.ufunc, self.inputs, self.name = tape, ufunc, inputs, name
        self.makes_bools = ufunc in _BOOLS
        self.number = len(tape.steps)
        tape.steps.append(self)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        return Step(self.tape, ufunc, inputs) if method == "__call__" and not options else NotImplemented


class Tape:
    """The steps of a formula.

    >>> tape = Tape()
    >>> given = tape.given({"a": np.zeros(1), "b": 3.0})
    >>> line = 2.0 * given["a"] + given["b"] * given["b"]
    >>> player = Player(tape, length=2, kept=[line])
    >>> player.play({"a": np.array([1.0, 2.0])})
    >>> player.of(line).tolist()
    [11.0, 13.0]
    """

    def __init__(self) -> None:
        self.steps: list[Step] = []

    def given(self, values: Mapping[str, float | Floats]) -> dict[str, Any]:
        """Stand-ins for the arrays, to write formulas with; a float stays one, and is computed with only once."""
        return {
            name: value if isinstance(value, float) else Step(self, None, (), name) for name, value in values.items()
        }

    def last_reads(self, kept: Iterable[Any]) -> dict[int, int]:
        """For each step that leads to one that is kept: the last step that reads it."""
        last = {step.number: len(self.steps) for step in kept if isinstance(step, Step)}
        for step in reversed(self.steps):
            if step.number in last:
                for value in step.inputs:
                    if isinstance(value, Step):
                        last.setdefault(value.number, step.number)
        return last


class Player:
    """A tape with rows to play it in, for chunks of one length.

    Parameters
    ----------
    kept : the values that are read afterwards; steps that lead to none of them are left out
    """

    def __init__(self, tape: Tape, length: int, kept: Iterable[Any]) -> None:
        last = tape.last_reads(kept)
        self._rows: dict[int, Any] = {}
        self._calls: list[tuple[Any, list[Any]]] = []
        self._given: list[tuple[list[Any], int, str]] = []
        free: dict[bool, list[Any]] = {True: [], False: []}
        for step in tape.steps:
            if step.ufunc is None or step.number not in last:
                continue
            arguments: list[Any] = []
            for place, value in enumerate(step.inputs):
                if not isinstance(value, Step):
                    arguments.append(np.asarray(value))  # as a plain float it would take longer in every call
                elif value.ufunc is None:
                    arguments.append(None)
                    self._given.append((arguments, place, value.name))
                else:
                    arguments.append(self._rows[value.number])
            # what no later step reads makes room, for this step as well: each element is read before it is written
            read = {value.number: value for value in step.inputs if isinstance(value, Step) and value.ufunc}
            for number, value in read.items():
                if last[number] == step.number:
                    free[value.makes_bools].append(self._rows[number])
            spare = free[step.makes_bools]
            row = spare.pop() if spare else _row(length, step.makes_bools)
            self._rows[step.number] = row
            if step.ufunc in _OUT_BY_NAME:
                self._calls.append((partial(step.ufunc, out=row), arguments))
            else:
                arguments.append(row)
                self._calls.append((step.ufunc, arguments))

    def play(self, values: Mapping[str, Any]) -> None:
        """Compute all that is kept from the arrays of a chunk."""
        for arguments, place, name in self._given:
            arguments[place] = values[name]
        for call, arguments in self._calls:
            call(*arguments)

    def of(self, value: Any) -> Any:
        """A kept value of the last chunk, to be read before the next; what is no step is its own value."""
        return self._rows[value.number] if isinstance(value, Step) else value


def _row(length: int, of_bools: bool) -> Any:
    """Memory that starts on a line of the cache."""
    if of_bools:
        return np.empty(length, dtype=np.bool_)
    block = np.empty(length + 2 * _LINE)
    first = (-block.ctypes.data // block.itemsize) % _LINE
    return block[first : first + length]
