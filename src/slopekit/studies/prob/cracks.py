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
from slopekit.studies.evaluation.vectorised import Vectorised, vectorised
from slopekit.studies.prob.sampling import settings_of

PLACE = "crack.distance"
FEW_ALONE = 200  # samples that are drawn where each takes a second or more


def crack_search(design: Design, values: Floats) -> tuple[Design, Vectorised] | None:
    """The design with its crack at a place, one more number that scatters, and its closed form over arrays of samples.

    None where no crack is looked for, or where the place that is found is no number of the file.

    Parameters
    ----------
    values : (n, k) some samples
    """
    searched, crack = getattr(design, "crack_searched", ""), getattr(design, "crack", None)
    if not searched or crack is None:
        return None
    try:
        fixed = with_values(design, {PLACE: float(crack.distance_m)})
    except DesignError:
        return None  # written in one word, 80/180@worst
    fast = vectorised(fixed, values, lambda row: settings_of(design.variables, values[row]))
    if fast is None:
        return None
    variable = Variable(PLACE, Distribution("uniform", {"min": 0.0, "max": float(crack.distance_m)}, "length"))
    return replace(fixed, variables=(*fixed.variables, variable)), fast


def placed(search: Vectorised, values: Floats) -> tuple[Floats, Bools]:
    """Samples (n, k) with the worst place of their crack (n, k + 1), and in which (n,) no place gives a factor."""
    places, nowhere = search.worst_cracks(values)
    return np.column_stack([values, places]), nowhere
