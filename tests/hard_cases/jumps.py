"""Where an answer changes by a jump: the place in 50 digits and in slopekit, and the values on both sides."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

from tests.hard_cases import exact
from tests.hard_cases.cases import PAPER, STEEP, WYLLIE, Case, plane, stack, wedge
from tests.hard_cases.catalogue import facing, pulled
from tests.hard_cases.exact import Exact, Number, mp
from tests.hard_cases.sweeps import Point, point

#: How far a jump may be off, in parts of the parameter, and why.
CLOSE = 1e-9, "the mode comes from signs, which rounding moves by 1e-13 of the load"
REVERSAL = (
    5e-6,
    "within this, what drives is less than a millionth of the strength: F is above 1e5 on both sides",
)
TIPPING = (
    1e-5,
    "one block: its path settles to 1e-6, and what lacks less than that to balance still stands",
)
EDGE = (
    1e-6,
    "many blocks: a limit state is admissible to 1e-7 of the load, and what lacks less to balance still stands",
)


@dataclass(frozen=True)
class Jump:
    """One jump along one parameter.

    Attributes
    ----------
    name, label : what jumps, and the parameter with its unit
    at : the case at a value
    low, high : a bracket of the jump, and of no other one
    exact_before : whether an answer of the reference is on the lower side
    before : the same of slopekit's; None: its forces alone are nearer to the exact number of the lower side
    tolerance : of the place, relative, with its cause; error : of the values on both sides, relative
    tested : whether the tests take it; where moments govern a point may take seconds, and the benchmark does
    """

    name: str
    label: str
    at: Callable[[float], Case]
    low: float
    high: float
    exact_before: Callable[[Exact], bool]
    before: Callable[[Point], bool] | None = None
    tolerance: tuple[float, str] = CLOSE
    error: float = 1e-6
    tested: bool = True


@dataclass(frozen=True)
class Located:
    """A jump that was found: its place in the reference and in slopekit, and what both have on either side."""

    exact_place: float
    place: float
    below: Point
    above: Point

    @property
    def off(self) -> float:
        """Distance of the two places in parts of the parameter."""
        return abs(self.place / self.exact_place - 1.0)


@cache
def exact_place(jump: Jump) -> float:
    """The place of a jump in the reference, to the last bit of a float."""
    return _bisected(
        lambda value: jump.exact_before(jump.at(value).answer()), jump.low, jump.high, 0.0
    )


def located(jump: Jump) -> Located:
    """Bisect a jump in both; slopekit's to a thousandth of the tolerance."""
    wanted = exact_place(jump)
    is_before = side_of(jump, wanted)
    low, high = jump.low, jump.high
    for reach in (jump.tolerance[0], 1e-3):  # mostly it is very near
        ends = wanted * (1.0 - reach), wanted * (1.0 + reach)
        if is_before(point(jump.at(ends[0]))) and not is_before(point(jump.at(ends[1]))):
            low, high = ends
            break
    place = _bisected(
        lambda value: is_before(point(jump.at(value))), low, high, 1e-3 * jump.tolerance[0]
    )
    return Located(wanted, place, *sides(jump, wanted))


def sides(jump: Jump, wanted: float) -> tuple[Point, Point]:
    """What slopekit and the reference have just below and just above, as far off as the place may be."""
    reach = jump.tolerance[0]
    below, above = wanted * (1.0 - reach), wanted * (1.0 + reach)
    return point(jump.at(below), below), point(jump.at(above), above)


def side_of(jump: Jump, wanted: float) -> Callable[[Point], bool]:
    """Whether a point of slopekit is on the lower side of a jump whose place is known."""
    if jump.before is not None:
        return jump.before
    below, above = (
        jump.at(wanted * factor).answer().as_float for factor in (1.0 - 1e-12, 1.0 + 1e-12)
    )
    assert below is not None
    assert above is not None
    middle = 0.5 * (below + above)
    return lambda found: ((found.forces_only or 0.0) > middle) == (below > above)


def _bisected(before: Callable[[float], bool], low: float, high: float, resolution: float) -> float:
    if not before(low) or before(high):
        raise ArithmeticError("the ends do not bracket the jump")
    while high - low > resolution * abs(high):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        low, high = (middle, high) if before(middle) else (low, middle)
    return low


def _touching(*planes: str) -> Callable[[Exact], bool]:
    return lambda answer: answer.contact == planes


def _not(status: str) -> tuple[Callable[[Exact], bool], Callable[[Point], bool]]:
    return (lambda answer: answer.status != status), (lambda found: found.status != status)


def _has_number(found: Point) -> bool:
    return found.limit is not None


def _pulled_off(share: float) -> Case:
    """The paper's wedge pulled outward square to J2; at 1 nothing is left of the normal force on J2."""
    answer = exact.wedge(**PAPER)
    outward = [float(x * answer.normal[1]) for x in exact.plane_normal(PAPER["dips"][1])]
    return wedge(PAPER, forces=[tuple(share * x for x in outward)])


def _pushed_plane(k: float) -> Case:
    """A plane failure without cohesion and with much friction, shaken until its block tips about the toe."""
    case = plane(c=0.0, phi=60.0, seismic=k)

    def answer() -> Exact:
        found = case.answer()
        x, z = triangle_centroid(60.0, 35.0, 12.0)
        return replace(found, status="topples", factor=None) if mp.mpf(k) * z > -x else found

    return replace(case, answer=answer)


def triangle_centroid(face: float, dip: float, height: float) -> tuple[Number, Number]:
    """Centroid (x, z) of the block between a face, a level top and a plane through the toe."""
    h = mp.mpf(height)
    return -(h / exact.tangent(face) + h / exact.tangent(dip)) / 3, 2 * h / 3


_UP, _LIFTED, _TOPPLES = _not("slides_up"), _not("lifted"), _not("topples")
_KPA = "mean water pressure, kPa"
_TIPS = math.degrees(math.atan(0.5))

JUMPS = [
    Jump(
        "Wyllie & Mah's wedge, water on both: J2 loses contact and its cohesion",
        _KPA,
        lambda u: wedge(WYLLIE, water=(u, u)),
        60.0,
        130.0,
        _touching("J1", "J2"),
    ),
    Jump(
        "Wyllie & Mah's wedge, water on both: it is lifted",
        _KPA,
        lambda u: wedge(WYLLIE, water=(u, u)),
        130.0,
        200.0,
        *_LIFTED,
        tested=False,
    ),
    Jump(
        "Wyllie & Mah's wedge, water on J2: J2 loses contact",
        _KPA,
        lambda u: wedge(WYLLIE, water=(0.0, u)),
        50.0,
        150.0,
        _touching("J1", "J2"),
    ),
    Jump(
        "Wyllie & Mah's wedge, water on J1: J1 loses contact",
        _KPA,
        lambda u: wedge(WYLLIE, water=(u, 0.0)),
        100.0,
        240.0,
        _touching("J1", "J2"),
        tested=False,
    ),
    Jump(
        "paper's wedge, water on both: both joints lose contact at once",
        _KPA,
        lambda u: wedge(PAPER, water=(u, u)),
        300.0,
        450.0,
        *_LIFTED,
    ),
    Jump(
        "paper's wedge pulled off J2: J2 loses contact",
        "pull, parts of the normal force",
        _pulled_off,
        0.5,
        1.5,
        _touching("J1", "J2"),
    ),
    Jump(
        "wedge, dip direction of J2: J2 comes into contact",
        "dip direction, degrees",
        facing,
        235.0,
        255.0,
        _touching("J1"),
    ),
    Jump(
        "paper's wedge pulled uphill: sliding reverses",
        "pull, parts of the weight",
        pulled,
        0.2,
        0.6,
        *_UP,
        REVERSAL,
    ),
    Jump(
        "plane pulled uphill: sliding reverses",
        "pull out of the rock, kN",
        lambda x: plane(force=(-x, 0.0)),
        800.0,
        2000.0,
        *_UP,
        REVERSAL,
    ),
    Jump(
        "steep wedge, earthquake: it is lifted",
        "seismic coefficient",
        lambda k: wedge(STEEP, seismic=(k, 180.0)),
        0.8,
        1.6,
        *_LIFTED,
    ),
    Jump(
        "plane, earthquake: it is lifted",
        "seismic coefficient",
        lambda k: plane(seismic=k),
        0.8,
        1.9,
        *_LIFTED,
    ),
    Jump("plane, water: it is lifted", _KPA, lambda u: plane(pressure=u), 50.0, 80.0, *_LIFTED),
    Jump(
        "plane, earthquake, c = 0: it tips about its toe",
        "seismic coefficient",
        _pushed_plane,
        0.5,
        1.9,
        _TOPPLES[0],
        _has_number,
        TIPPING,
    ),
    Jump(
        "block of 1 m by 2 m: its centre of gravity passes its edge",
        "dip, degrees",
        lambda dip: stack(1.0, 2.0, dip, phi=50.0),
        0.9 * _TIPS,
        1.1 * _TIPS,
        _TOPPLES[0],
        _has_number,
        EDGE,
    ),
    Jump(
        "stack of six: its centre of gravity passes its edge",
        "dip, degrees",
        lambda dip: stack(3.0, 1.0, dip, phi=50.0, many=6),
        0.9 * _TIPS,
        1.1 * _TIPS,
        _TOPPLES[0],
        _has_number,
        EDGE,
    ),
    Jump(
        "block on wet ground: the pressure lets it tip",
        _KPA,
        lambda u: stack(pressure=u),
        15.0,
        23.0,
        _TOPPLES[0],
        _has_number,
        EDGE,
    ),
]
