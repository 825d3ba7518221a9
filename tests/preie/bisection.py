"""Bisection of a bound, begun at the number that is held against it: where it lies elsewhere the sides go apart."""

from collections.abc import Callable

_FARTHEST = 0.2  # of the number, to both sides


def around(
    stands: Callable[[float], bool], near: float | None, parts: float
) -> tuple[float, float] | None:
    """A factor at which forces exist and one at which none do, on both sides of `near`; None: it is not near."""
    apart = parts
    while near is not None and apart < _FARTHEST:
        low, high = near / (1.0 + apart), near * (1.0 + apart)
        if not stands(high) and stands(low):
            return low, high
        apart *= 10.0
    return None
