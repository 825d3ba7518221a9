"""The statuses of many single blocks, in the words of a single analysis."""

import numpy as np

from slopekit.core.arrays import NDArray
from slopekit.kinds.single_block.one_block_states import motion_statuses
from slopekit.preie.batch import BlockLimits
from slopekit.preie.one_block.bed_limits import BedStatus
from slopekit.preie.one_block.forces_limits import ForcesStatus


def block_statuses(limits: BlockLimits) -> NDArray[np.str_]:
    """Return the statuses (n,) of blocks by their limits; contacts are J1, J2 and a basal joint, in this order."""
    ends = [
        limits.bed_status == BedStatus.NO_REST,
        *(limits.forces_status == end for end in (ForcesStatus.STANDS, ForcesStatus.LIFTED, ForcesStatus.FALLS)),
    ]
    slides = motion_statuses(limits.velocity, 3, limits.opens_partly, limits.opens_wholly, limits.normal)
    return np.select(ends, ["topples", "no_driving_force", "lifted", "falls"], slides)
