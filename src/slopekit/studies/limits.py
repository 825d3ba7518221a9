"""How much of what scatters lies beyond what a design takes: cohesion below 0, a friction angle of 90° and more."""

from collections.abc import Iterable
from dataclasses import dataclass

from slopekit.design.common import Design
from slopekit.design.distributions import Distribution, Variable
from slopekit.design.fields import Field, field_at
from slopekit.errors import DesignError, Fault
from slopekit.orientation import number
from slopekit.studies.marginals import tails

#: The largest share that is left to a study, which counts such samples as impossible.
MOST_BEYOND = 0.01


@dataclass(frozen=True, slots=True)
class Beyond:
    """The shares of a variable below and above the values that a design takes."""

    variable: Variable
    limits: Field
    below: float
    above: float

    @property
    def share(self) -> float:
        """Of both ends."""
        return self.below + self.above


def shares_beyond(variables: Iterable[Variable], record: type[Design]) -> tuple[Beyond, ...]:
    """The shares of every variable, exactly; none of an orientation, which beyond 90° is a plane written otherwise.

    Parameters
    ----------
    record : the dataclass of the design

    Limits that depend on other values (dilation below φ, a step lower than the columns) are seen in samples only.

    >>> from slopekit.kinds.wedge.design import WedgeDesign
    >>> cohesion = Variable("strength.weak.c", Distribution("uniform", {"min": -1.0, "max": 9.0}, "pressure"))
    >>> shares_beyond([cohesion], WedgeDesign)[0].below
    0.1
    """
    found = []
    for variable in variables:
        own, limits = variable.distribution, field_at(record, variable.path) or Field(variable.path)
        ends = (
            tails(own, limits.least, limits.most) if isinstance(own, Distribution) and not limits.turns else (0.0, 0.0)
        )
        found.append(Beyond(variable, limits, *ends))
    return tuple(found)


def checked_limits(design: Design) -> tuple[Beyond, ...]:
    """The shares of every variable of a design, each of them small.

    Raises
    ------
    DesignError
        E281 for every variable of which more than 1 % lies beyond its limits.

    >>> from slopekit.design.files import load
    >>> joints = {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}
    >>> weak = {"c": {"dist": "normal", "mean": 10, "sd": 8}, "phi": 30}
    >>> wedge = load({"slopekit": 1, "kind": "wedge", "joints": joints, "strength": {"weak": weak}})
    >>> checked_limits(wedge)
    Traceback (most recent call last):
    slopekit.errors.DesignError: E281 10.6 % of strength.weak.c lies below 0, where no design can be
         design: strength.weak.c = {dist: …, mean: …, sd: …}
         Add min: 0 to the distribution, or make it narrower.
    """
    found = shares_beyond(design.variables, type(design))
    faults = [_fault(one) for one in found if one.share > MOST_BEYOND]
    if faults:
        raise DesignError(faults)
    return found


def _fault(one: Beyond) -> Fault:
    own = one.variable.distribution
    assert isinstance(own, Distribution)
    ends, cures = [], []
    for key, side, share, limit in (
        ("min", "below", one.below, one.limits.least),
        ("max", "above", one.above, one.limits.most),
    ):
        if share > 0.0:
            ends.append(f"{share * 100:.3g} % of {one.variable.path} lies {side} {number(limit)}")
            cures.append(f"{key}: {number(limit)}")
    verb = "Give it" if any(cure.partition(":")[0] in own.parameters for cure in cures) else "Add"
    to = "" if verb == "Give it" else " to the distribution"
    advice = f"{verb} {' and '.join(cures)}{to}, or make it narrower."
    return Fault("E281", f"{', '.join(ends)}, where no design can be", one.variable.where, advice)
