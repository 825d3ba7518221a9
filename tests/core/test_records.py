"""Records are what `dataclasses` makes: in fields, comparison, text, copies, signatures and refusals."""

import copy
import dataclasses
import inspect
import pickle
import re
from typing import Any, ClassVar

import pytest

from slopekit.core.records import dataclass


@dataclass(frozen=True, slots=True)
class Point:
    """A point."""

    east: float
    north: float = 0.0
    names: list[str] = dataclasses.field(default_factory=list)
    hidden: int = dataclasses.field(default=7, repr=False, compare=False)
    of_all: ClassVar[int] = 3


@dataclasses.dataclass(frozen=True)
class Plain:
    """A point."""

    east: float
    north: float = 0.0
    names: list[str] = dataclasses.field(default_factory=list)
    hidden: int = dataclasses.field(default=7, repr=False, compare=False)
    of_all: ClassVar[int] = 3


@dataclass(frozen=True, kw_only=True)
class Raised(Point):
    up: float
    weight: float = dataclasses.field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "weight", 2 * self.up)


@dataclasses.dataclass(frozen=True, slots=True)
class OfAStranger(Point):
    strength: float = 5.0


@dataclass(frozen=True)
class Key:
    name: str
    number: int = 1


def test_a_record_is_what_dataclasses_makes() -> None:
    ours, theirs = Point(1.0, names=["a"]), Plain(1.0, names=["a"])
    assert repr(ours) == repr(theirs).replace("Plain", "Point")
    assert dataclasses.asdict(ours) == dataclasses.asdict(theirs)
    assert [(one.name, one.type) for one in dataclasses.fields(Point)] == [
        (one.name, one.type) for one in dataclasses.fields(Plain)
    ]
    assert [*inspect.signature(Point).parameters] == [*inspect.signature(Plain).parameters]
    assert Point.__match_args__ == Plain.__match_args__
    assert Point(1.0).names is not Point(1.0).names
    assert (Point.north, Point.of_all) == (Plain.north, 3)


def test_records_are_compared_by_the_fields_that_count() -> None:
    assert Point(1.0, hidden=1) == Point(1.0, hidden=2) != Point(2.0)
    assert Point(1.0) != Plain(1.0)
    assert {Key("a"): 1}[Key("a", 1)] == 1
    assert len({Key("a"), Key("a", 2)}) == 2


def test_a_record_is_never_written() -> None:
    point = Point(1.0)
    with pytest.raises(dataclasses.FrozenInstanceError, match="'east'"):
        point.east = 2.0  # type: ignore[misc]
    with pytest.raises(dataclasses.FrozenInstanceError, match="'east'"):
        del point.east  # type: ignore[misc]
    assert dataclasses.replace(point, north=4.0) == Point(1.0, 4.0)


def test_copies_and_pickles_are_equal() -> None:
    point = Raised(1.0, up=3.0)
    assert copy.copy(point) == copy.deepcopy(point) == pickle.loads(pickle.dumps(point)) == point
    assert point.weight == 6.0


@pytest.mark.parametrize("given", [((), {}), ((1, 2, 3, 4, 5), {}), ((1,), {"east": 1}), ((1,), {"west": 1})])
def test_what_is_not_a_record_s_is_refused(given: tuple[tuple[int, ...], dict[str, int]]) -> None:
    with pytest.raises(TypeError):
        Point(*given[0], **given[1])  # type: ignore[arg-type]


def test_records_and_dataclasses_of_others_inherit() -> None:
    assert OfAStranger(1.0, strength=6.0).strength == 6.0
    assert dataclasses.replace(OfAStranger(1.0), east=2.0).east == 2.0
    with pytest.raises(TypeError):
        Raised(1.0, 2.0, [], 7, 3.0)  # type: ignore[misc]
    with pytest.raises(TypeError):
        dataclasses.dataclass(type("Written", (Point,), {"__annotations__": {"b": int}}))


@pytest.mark.parametrize("before", [0, 50], ids=["the first", "after many"])
@pytest.mark.parametrize("given", [
    ((1,), {}), ((1, 2), {}), ((1,), {"north": 2, "up": 3}), ((), {"up": 3, "east": 1, "names": [4]}),
    ((), {}), ((1, 2, [], 3), {}), ((1,), {"east": 1}), ((1,), {"west": 1}), ((1,), {"twice": 1}),
])  # fmt: skip
def test_the_first_records_are_what_the_compiled_ones_are(
    before: int, given: tuple[tuple[int, ...], dict[str, int]]
) -> None:
    """Those of dataclasses, whose ``__init__`` is compiled at once, are the reference."""

    def made_by(decorator: Any) -> Any:
        @decorator(frozen=True)
        class One:
            east: float
            north: float = 0.0
            names: list[str] = dataclasses.field(default_factory=list)
            up: float = dataclasses.field(default=5.0, kw_only=True)
            twice: float = dataclasses.field(init=False)

            def __post_init__(self) -> None:
                object.__setattr__(self, "twice", 2 * self.east)

        return One

    ours, theirs = made_by(dataclass), made_by(dataclasses.dataclass)
    for number in range(before):
        assert ours(number).twice == 2 * number
    args, named = given
    try:
        expected = repr(theirs(*args, **named))
    except TypeError as error:
        with pytest.raises(TypeError, match=f"^{re.escape(str(error))}$"):
            ours(*args, **named)
    else:
        assert repr(ours(*args, **named)) == expected
