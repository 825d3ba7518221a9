"""The worst place of a tension crack in each sample, all samples at once: `crack: {distance: worst}`.

The place that is found is one more number of the sample. Whatever follows takes it as one that was drawn: the closed
form, bolts, sizes, PRE-IE.
"""

from dataclasses import dataclass, replace

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.core.errors import DesignError
from slopekit.design.common import Design
from slopekit.design.reading.files import with_values
from slopekit.design.scatter.distributions import Distribution, Variable
from slopekit.studies.prob.sampling import settings_of
from slopekit.studies.prob.vectorised import Vectorised, vectorised

PLACE = "crack.distance"
FEW_ALONE = 200  # samples that are drawn where each takes a second or more


@dataclass(frozen=True)
class CrackSearch:
    """The worst place of the crack of each sample.

    Attributes
    ----------
    design : with its crack at a place, one more number that scatters; bare : its closed form over arrays of samples
    """

    design: Design
    bare: Vectorised

    def __call__(self, values: Floats) -> tuple[Floats, Bools]:
        """Return samples (n, k) with their place (n, k + 1), and those (n,) in which no place gives a factor."""
        worst = self.bare.worst_cracks(values)
        assert worst is not None
        forms, found = worst
        blocks = ~np.array([name.startswith("E") for name in forms.names])[forms.outcome]
        nowhere = blocks & ~np.isfinite(found)
        # without a block any place says the same of it
        places = np.where(blocks & ~nowhere, found, self.design.crack.distance_m)  # type: ignore[attr-defined]
        return np.column_stack([values, places]), nowhere


def crack_search(design: Design, values: Floats) -> CrackSearch | None:
    """How the crack of the samples of a design is placed; None where it is not, or in each sample alone.

    Parameters
    ----------
    values : (n, k) some samples
    """
    searched, crack = getattr(design, "crack_searched", ""), getattr(design, "crack", None)
    if not searched or crack is None or any(bolt.acts == "passive" for bolt in design.bolts):
        return None
    try:
        fixed = with_values(design, {PLACE: float(crack.distance_m)})
    except DesignError:
        return None  # written in one word, 80/180@worst
    bare = vectorised(fixed, values, lambda row: settings_of(design.variables, values[row]))
    if bare is None or bare.worst_cracks(values) is None:
        return None
    variable = Variable(PLACE, Distribution("uniform", {"min": 0.0, "max": float(crack.distance_m)}, "length"))
    return CrackSearch(replace(fixed, variables=(*fixed.variables, variable)), bare)
