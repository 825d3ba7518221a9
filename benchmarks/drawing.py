"""What drawing a sample costs, by method: `python -m benchmarks.drawing [samples]`.

Nanoseconds of processor time a sample on one core; the last column says how fast the machine was meanwhile.
The fourteen inputs of a wedge: both joints, face, upper slope (each by dip and dip direction, or by Fisher's
distribution), height, cohesion and friction angle of both joints, unit weight, water.
"""

import sys
import time
from collections.abc import Callable, Mapping

import numpy as np

from slopekit.core.orientation import Plane
from slopekit.design.common import Pair
from slopekit.design.scatter.distributions import Angles, Distribution, Fisher, Name, Variable
from slopekit.studies.prob.sampling import METHODS, samples

_REPEATS = 5


def _number(name: Name, **parameters: float) -> Distribution:
    return Distribution(name, parameters, "ratio")


def _normal(mean: float, sd: float) -> Distribution:
    return _number("normal", mean=mean, sd=sd)


_PLANES = {
    "joints.J1.plane": (45.0, 115.0),
    "joints.J2.plane": (45.0, 245.0),
    "slope.face": (60.0, 180.0),
    "slope.upper": (10.0, 180.0),
}
_ANGLES = tuple(
    Variable(path, Angles("plane", _normal(dip, 2.0), _normal(direction, 3.0)))
    for path, (dip, direction) in _PLANES.items()
)
_FISHER = tuple(Variable(path, Fisher(Plane(*angles), 200.0)) for path, angles in _PLANES.items())
_SIZES = (
    Variable("slope.height", _normal(64.89, 1.0)),
    Variable("rock.unit_weight", _normal(25.5, 0.5)),
)
_STRENGTHS = (
    Variable("strength.a.c", _number("lognormal", mean=50.0, sd=15.0)),
    Variable("strength.b.c", _number("lognormal", mean=50.0, sd=15.0)),
    Variable("strength.a.phi", _number("normal", mean=20.0, sd=2.0, min=14.0, max=26.0)),
    Variable("strength.b.phi", _number("normal", mean=20.0, sd=2.0, min=14.0, max=26.0)),
)
_WATER = Variable("water.fill", _number("normal", mean=0.5, sd=0.2, min=0.0, max=1.0))
_MIXED = (*_ANGLES, *_SIZES, *_STRENGTHS, _WATER)
_FEW: tuple[Pair, ...] = (
    ("strength.a.phi", "strength.b.phi", 0.6),
    ("strength.a.c", "strength.b.c", 0.6),
    ("strength.a.c", "strength.a.phi", -0.3),
    ("strength.b.c", "strength.b.phi", -0.3),
    ("joints.J1.plane.dip", "joints.J2.plane.dip", 0.5),
)


def _all_pairs(variables: tuple[Variable, ...], coefficient: float) -> tuple[Pair, ...]:
    names = [name for variable in variables for name in variable.coordinates]
    return tuple((a, b, coefficient) for k, a in enumerate(names) for b in names[:k])


_PLAIN = tuple(Variable(f"x{k}", _normal(10.0, 1.0)) for k in range(14))
CASES: Mapping[str, tuple[tuple[Variable, ...], tuple[Pair, ...]]] = {
    "14 normal": (_PLAIN, ()),
    "14 normal, all correlated": (_PLAIN, _all_pairs(_PLAIN, 0.3)),
    "15 mixed": (_MIXED, ()),
    "15 mixed, some correlated": (_MIXED, _FEW),
    "15 mixed, all correlated": (_MIXED, _all_pairs(_MIXED, 0.3)),
    "15 mixed, planes by Fisher": ((*_FISHER, *_SIZES, *_STRENGTHS, _WATER), _FEW[:4]),
}


def cost(case: str, method: str, n: int) -> float:
    """Seconds a sample, the least of several runs."""
    return min(_seconds(lambda: samples(*CASES[case], n, 1, method)) for _ in range(_REPEATS)) / n


def yardstick() -> float:
    """Seconds of one standard normal: what the machine does at this moment."""
    rng, numbers = np.random.Generator(np.random.SFC64(1)), np.empty(8192)
    return min(_seconds(lambda: rng.standard_normal(out=numbers)) for _ in range(200)) / len(
        numbers
    )


def _seconds(work: Callable[[], object]) -> float:
    began = time.process_time()
    work()
    return time.process_time() - began


def main(words: list[str]) -> None:
    """Print the table, with the cost of one standard normal before and after each row."""
    n = int(words[0]) if words else 2**19
    print(
        f"ns a sample, {n} samples".ljust(34)
        + "".join(method.rjust(17) for method in METHODS)
        + "   one normal"
    )
    for case in CASES:
        normal = [yardstick()]
        found = [cost(case, method, n) for method in METHODS]
        normal.append(yardstick())
        shown = " to ".join(f"{value * 1e9:.0f}" for value in sorted(normal))
        print(
            case.ljust(34) + "".join(f"{value * 1e9:17.0f}" for value in found) + shown.rjust(13),
            flush=True,
        )


if __name__ == "__main__":
    main(sys.argv[1:])
