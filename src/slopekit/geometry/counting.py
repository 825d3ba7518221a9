"""How many blocks planes cut a body into, before it is cut."""

import math

import numpy as np

from slopekit.arrays import Floats
from slopekit.errors import Fault, GeometryError
from slopekit.geometry.combs import Comb

__all__ = ["count_cells", "refuse_too_many", "too_many"]

_CLEARLY = 1.5  # planes through one line or point cut fewer cells than are counted: refuse before cutting above this
_ENOUGH = 50  # times max_blocks: stop counting
_INSIDE = 1e-9  # of the body: lines and points that touch it no deeper are outside
_PARALLEL = 1e-9


def refuse_too_many(
    normals: Floats, offsets: Floats, faces: tuple[Floats, Floats], combs: list[Comb], max_blocks: int
) -> None:
    """Refuse planes that cut many more blocks than allowed.

    Parameters
    ----------
    normals (p, 3), offsets (p,) : of the planes; combs : those that do not meet within the body
    faces : normals (k, 3) and offsets (k,) of the body, `normal · x <= offset`

    Raises
    ------
    GeometryError
        E220 more blocks than `max_blocks`.
    """
    if math.prod(len(comb.planes) + 1 for comb in combs) <= max_blocks:
        return
    count = count_cells(normals, offsets, faces, combs, _ENOUGH * max_blocks)
    if count > _CLEARLY * max_blocks:
        raise too_many(count, max_blocks, "more than " if count > _ENOUGH * max_blocks else "about ")


def too_many(count: int, max_blocks: int, about: str = "") -> GeometryError:
    """The refusal, with what to change."""
    message = f"the joint sets cut the bench into {about}{count:,} blocks, more than max_blocks = {max_blocks:,}"
    factor = math.ceil(100.0 * (count / max_blocks) ** (1.0 / 3.0)) / 100.0
    advice = f"Take all spacings {factor:.3g} times as large, a smaller bench, or raise max_blocks."
    return GeometryError([Fault("E220", message, "", advice)])


def count_cells(
    normals: Floats, offsets: Floats, faces: tuple[Floats, Floats], combs: list[Comb], enough: int = 2**62
) -> int:
    """Cells of a convex body cut by planes: 1 + planes + lines + points in which they meet within the body.

    Exact for planes in general position (Zaslavsky 1975); an upper bound where more planes share a line or a point.
    Counting stops when there are more than `enough`.
    """
    order = np.concatenate([*(comb.planes for comb in combs), np.zeros(0, dtype=np.int64)]).astype(np.int64)
    comb = np.repeat(np.arange(len(combs)), [len(part.planes) for part in combs])
    normals, offsets = normals[order], offsets[order]
    total = 1 + len(order)
    for i in range(len(order)):
        rest = int(np.searchsorted(comb, comb[i], side="right"))  # planes of its own comb do not meet it
        across = np.cross(normals[i], normals[rest:])
        squared = (across * across).sum(axis=1)
        meets = squared > _PARALLEL**2
        j, across, squared = rest + np.flatnonzero(meets), across[meets], squared[meets, None]
        point = (offsets[i] * np.cross(normals[j], across) + offsets[j, None] * np.cross(across, normals[i])) / squared
        along = across / np.sqrt(squared)
        low, high = _clip(point, along, *faces)
        hit = high - low > _INSIDE
        j, point, along, low, high = j[hit], point[hit], along[hit], low[hit], high[hit]
        total += len(j)
        if len(j):
            rate = along @ normals[rest:].T
            with np.errstate(divide="ignore", invalid="ignore"):
                at = (offsets[rest:] - point @ normals[rest:].T) / rate
            third = (np.abs(rate) > _PARALLEL) & (comb[rest:] > comb[j, None])
            total += int((third & (at > low[:, None] + _INSIDE) & (at < high[:, None] - _INSIDE)).sum())
        if total > enough:
            break
    return total


def _clip(point: Floats, along: Floats, normals: Floats, offsets: Floats) -> tuple[Floats, Floats]:
    """Where lines enter and leave a convex body; they leave before they enter where they miss it."""
    low, high = np.full(len(point), -math.inf), np.full(len(point), math.inf)
    for normal, offset in zip(normals, offsets, strict=True):
        rate, room = along @ normal, offset - point @ normal
        with np.errstate(divide="ignore", invalid="ignore"):
            at = room / rate
        high = np.where(rate > _PARALLEL, np.minimum(high, at), high)
        low = np.where(rate < -_PARALLEL, np.maximum(low, at), low)
        high = np.where((np.abs(rate) <= _PARALLEL) & (room < _INSIDE), -math.inf, high)
    return low, high
