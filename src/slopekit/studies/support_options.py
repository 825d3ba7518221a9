"""What `slopekit support` is asked for, read and checked."""

import re
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Literal

from slopekit.design.words import above_zero, line_of_words
from slopekit.errors import DesignError, Fault
from slopekit.orientation import Line, number
from slopekit.units import quantity

Acts = Literal["active", "passive"]


@dataclass(frozen=True, slots=True)
class Options:
    """Options of a support study: kN, m, degrees.

    Attributes
    ----------
    target : factor of safety
    acts : how bolts act; toward : direction of their force on the block, None where none is given
    plunge : limits of the practical direction, None without
    capacity : of a bolt; spacing : None where it follows from the force; bond : anchorage behind the joint
    length : of every bolt, None where each is as long as it must be
    """

    target: float
    acts: tuple[Acts, ...]
    toward: Line | None
    plunge: tuple[float, float] | None
    capacity: float
    spacing: float | None
    bond: float
    length: float | None

    def to_dict(self) -> dict[str, Any]:
        """The options as JSON values."""
        return {
            "acts": list(self.acts), "toward": None if self.toward is None else asdict(self.toward),
            "plunge_deg": None if self.plunge is None else list(self.plunge), "bolt_capacity_kn": self.capacity,
            "spacing_m": self.spacing, "bond_m": self.bond, "length_m": self.length,
        }  # fmt: skip


def read_options(
    *, fos: object, acts: object, toward: object, plunge: object, bolt_capacity: object, spacing: object, bond: object,
    length: object,
) -> Options:  # fmt: skip
    """Read options as a user gives them.

    Raises
    ------
    DesignError
        E321 with every option that is not understood, and what `quantity` raises.
    """
    faults: list[Fault] = []

    def read(reader: Callable[[], Any]) -> Any:
        try:
            return reader()
        except DesignError as error:
            faults.extend(error.faults)
            return None

    def positive(value: object, kind: str, name: str, option: str) -> float | None:
        if value is None:
            return None
        return read(lambda: above_zero(value, kind, name, "E321", f"{option} {value}"))  # type: ignore[no-any-return]

    target = positive(fos, "ratio", "the target factor of safety", "--fos")
    capacity = positive(bolt_capacity, "force", "the capacity of a bolt", "--bolt-capacity")
    apart = positive(spacing, "length", "the spacing of the bolts", "--spacing")
    anchorage = positive(bond, "length", "the anchorage behind the joint", "--bond")
    long = positive(length, "length", "the length of the bolts", "--length")
    both = read(lambda: _acts(acts))
    line = toward if isinstance(toward, Line) or toward is None else read(
        lambda: line_of_words(toward, "the bolts", "E321", f"--toward {toward}")
    )  # fmt: skip
    limits = None if plunge is None else read(lambda: _plunges(plunge))
    if target is None and not faults:
        faults.append(Fault("E321", "the target factor of safety is missing", "--fos", "For example --fos 1.5."))
    if faults or target is None or capacity is None or anchorage is None:
        raise DesignError(faults or [Fault("E321", "capacity and bond are needed", "--bolt-capacity, --bond")])
    return Options(target, both, line, limits, capacity, apart, anchorage, long)


def _acts(value: object) -> tuple[Acts, ...]:
    if value is None or value == "both":
        return "active", "passive"
    if value == "active":
        return ("active",)
    if value == "passive":
        return ("passive",)
    advice = "Leave it out for both."
    raise DesignError([Fault("E321", f"bolts are active or passive, not {value}", f"--acts {value}", advice)])


def _plunges(value: object) -> tuple[float, float]:
    where = f"--plunge {value}"
    parts = re.split(r"\s*[,:]\s*", value.strip()) if isinstance(value, str) else value
    if not isinstance(parts, Sequence) or len(parts) != 2:
        advice = "Write least,most: --plunge -5,15; positive is downward into the rock."
        raise DesignError([Fault("E321", f"limits of plunge are two numbers, not {value}", where, advice)])
    low, high = (quantity(part, "angle", "a limit of plunge", where) for part in parts)
    if not -90.0 <= low <= high <= 90.0:
        message = f"limits of plunge run from low to high between -90 and 90, not {number(low)} to {number(high)}"
        raise DesignError([Fault("E321", message, where)])
    return low, high
