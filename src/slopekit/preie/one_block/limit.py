"""The governing limit of one block: that of its forces alone or that with its moments."""

from dataclasses import dataclass, replace

from slopekit.preie.outcome import Limit, Outcome
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import SAME_LIMIT


@dataclass(frozen=True)
class LimitAnalysis:
    """The governing limit, the limit of the forces alone, and the limit with turning; equal where there is only one.

    `model`: with curved laws the model with the strength line of each pair at its own traction; None without.
    """

    governing: Limit
    forces_only: Limit
    with_turning: Limit
    moments_govern: bool
    model: Model | None = None

    @property
    def balanced(self) -> Limit:
        """The limit whose forces balance the moments as well, where there is one.

        Where the forces alone govern it is the limit with turning: that state is in equilibrium at a higher factor, and
        so at the limit.
        """
        turning, factor = self.with_turning, self.governing.factor
        if factor is None or turning.factor is None or turning.outcome is not Outcome.SLIDES:
            return self.governing
        return turning if turning.factor >= factor * (1.0 - SAME_LIMIT) else self.governing


def governing_limit(forces_only: Limit, with_turning: Limit) -> LimitAnalysis:
    """Return the analysis with the governing one of two limits: of the forces alone, or with turning (has a factor)."""
    assert with_turning.factor is not None
    if forces_only.factor is None or with_turning.factor < forces_only.factor * (1.0 - SAME_LIMIT):
        return LimitAnalysis(with_turning, forces_only, with_turning, True)
    if with_turning.factor < forces_only.factor * (1.0 + SAME_LIMIT):
        # the same slide with its moments balanced: the factor of the forces, the normal forces of the moments
        return LimitAnalysis(
            replace(with_turning, factor=forces_only.factor), forces_only, with_turning, False
        )
    return LimitAnalysis(forces_only, forces_only, with_turning, False)
