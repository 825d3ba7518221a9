"""Water and surcharge on the single blocks of n designs at once, cut by their planes."""

from typing import Any

import numpy as np

from slopekit.design.ground_water import SlopeDesign
from slopekit.geometry.polytopes import Polytopes, polytopes
from slopekit.kinds.single_block.closed_forms import MISFITS
from slopekit.kinds.single_block.held_bolts import Bounds
from slopekit.kinds.water import FullWater, LocalSlope, means_and_rest


def blocks_within(bounds: Bounds, count: int) -> Polytopes:
    """Return the blocks of n designs; of a slope that goes on alike along itself a metre, with the ends last."""
    outward, offsets = list(bounds.outward), list(bounds.offsets)
    if bounds.along is not None:
        outward += [bounds.along, -bounds.along]
        offsets += [np.full(1, 0.5)] * 2
    return polytopes(
        np.stack([np.broadcast_to(normals, (count, 3)) for normals in outward], axis=1),
        np.stack([np.broadcast_to(offset, count) for offset in offsets], axis=1),
        np.broadcast_to(bounds.size, count),
    )


def slope_of(bounds: Bounds, solids: Polytopes, full: FullWater) -> LocalSlope:
    """Return the blocks in their slopes, in east, north and up from the toe."""
    face, upper = bounds.free
    cracks = [plane for plane in range(len(bounds.outward)) if plane not in (*bounds.joints, *bounds.free)]
    out = solids.outward[:, face] * [1.0, 1.0, 0.0]
    return LocalSlope(
        solids.faces.swapaxes(0, 1), solids.corners(), bounds.joints, cracks[0] if cracks else None, (face, upper),
        solids.outward[:, (face, upper)].swapaxes(0, 1),
        solids.offsets[:, (face, upper)].T, -out / np.sqrt((out * out).sum(axis=1))[:, None], bounds.along, full,
        np.eye(3), float(bounds.origin[2]),
    )  # fmt: skip


def integrated_loads(design: SlopeDesign, bounds: Bounds, full: FullWater) -> tuple[list[Any], list[Any], Any]:
    """Return what water and surcharge are to the closed form of n designs, each (n,), or a number of one.

    Parameters
    ----------
    design : whose numbers may be arrays (n,); bounds : the planes of its blocks

    Returns
    -------
    mean pressures of the joints and the crack, kPa; the sum of all else east, north and up, kN; which of `MISFITS`
    refuses a block, below 0 where none does
    """
    solids = blocks_within(bounds, bounds.offsets.shape[1])
    with np.errstate(divide="ignore", invalid="ignore"):
        means, rest, misfits = means_and_rest(design, slope_of(bounds, solids, full))
    is_cut = (solids.counts[:, list(bounds.joints)] > 0).any(axis=1)
    codes = ["E208", *(fault.code for _, fault in misfits)]
    misfit = np.select([~is_cut, *(where for where, _ in misfits)], [MISFITS.index(code) for code in codes], -1)
    values = [*means, *rest.T, misfit]
    of_one = [own[0] if len(own) == 1 else own for own in values]
    return of_one[: len(means)], of_one[len(means) : -1], of_one[-1]
