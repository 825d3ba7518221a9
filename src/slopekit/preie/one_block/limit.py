"""Which of two limits of one block governs, that of its forces alone or that with its moments."""

from dataclasses import dataclass, replace

from slopekit.preie.outcome import Limit, Outcome
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import SAME_LIMIT


@dataclass(frozen=True)
class LimitAnalysis:
    """The limit that governs, that of the forces alone, and that with turning; all the same where there is one limit.

    `model`: where laws are curved, the model with the line of each pair at its own traction; None where none is.
    """

    governing: Limit
    forces_only: Limit
    with_turning: Limit
    moments_govern: bool
    model: Model | None = None

    @property
    def balanced(self) -> Limit:
        """The limit whose forces balance the moments too, where there is one.

        Where the forces alone govern although the block could be held to more by its moments, the state with turning
        is that one: it stands at a higher factor, so at the limit too.
        """
        turning, factor = self.with_turning, self.governing.factor
        if factor is None or turning.factor is None or turning.outcome is not Outcome.SLIDES:
            return self.governing
        return turning if turning.factor >= factor * (1.0 - SAME_LIMIT) else self.governing


def governed(alone: Limit, turning: Limit) -> LimitAnalysis:
    """Which of two limits governs, that of the forces alone or that with turning (it has a factor)."""
    assert turning.factor is not None
    if alone.factor is None or turning.factor < alone.factor * (1.0 - SAME_LIMIT):
        return LimitAnalysis(turning, alone, turning, True)
    if turning.factor < alone.factor * (1.0 + SAME_LIMIT):
        # the same slide with its moments balanced: the factor of the forces, the normal forces of the moments
        return LimitAnalysis(replace(turning, factor=alone.factor), alone, turning, False)
    return LimitAnalysis(alone, alone, turning, False)
