"""The worst place of a tension crack in each sample, all samples at once: `crack: {distance: worst}`.

The place that is found is one more number of the sample. Whatever follows takes it as one that was drawn: the closed
form, bolts, sizes, PRE-IE.
"""

from dataclasses import replace

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.core.errors import DesignError
from slopekit.design.common import Design
from slopekit.design.reading.files import with_values
from slopekit.design.scatter.distributions import Distribution, Variable
from slopekit.studies.prob.sampling import Samples
from slopekit.studies.prob.vectorised import vectorised

PLACE = "crack.distance"
FEW_ALONE = 200  # samples that are drawn where each takes a second or more


def cracked(design: Design, samples: Samples) -> tuple[Design, Samples, Bools] | None:
    """A design with its crack at a place, which its samples say, and those (n,) in which no place gives a factor.

    None where no crack was looked for, or it is looked for in each sample alone.
    """
    searched, crack = getattr(design, "crack_searched", ""), getattr(design, "crack", None)
    if not searched or crack is None or any(bolt.acts == "passive" for bolt in design.bolts):
        return None
    try:
        fixed = with_values(design, {PLACE: float(crack.distance_m)})
    except DesignError:
        return None  # written in one word, 80/180@worst
    fast = vectorised(fixed, samples.values, samples.settings)
    worst = None if fast is None else fast.worst_cracks(samples.values)
    if worst is None:
        return None
    bare, at = worst
    blocks = ~np.array([name.startswith("E") for name in bare.names])[bare.outcome]
    known = blocks & np.isfinite(at)
    # without a block any place says the same of it
    places: Floats = np.where(known, at, crack.distance_m)
    own = places[known] if known.any() else places
    variable = Variable(PLACE, Distribution("uniform", {"min": float(own.min()), "max": float(own.max())}, "length"))
    values = np.asfortranarray(np.column_stack([samples.values, places]))
    values.setflags(write=False)
    placed = Samples((*samples.variables, variable), (*samples.names, PLACE), values, samples.replicate)
    return replace(fixed, variables=(*fixed.variables, variable)), placed, blocks & ~known
