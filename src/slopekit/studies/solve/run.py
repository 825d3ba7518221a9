"""The value of one number of a design that gives a factor of safety.

>>> import slopekit as sk
>>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
...          "strength": {"weak": {"c": 50, "phi": 20}}}
>>> found = solve(sk.load(wedge), "strength.weak.c", fos=1.5).answer
>>> round(found.value, 3), round(found.factor, 9)
(43.41, 1.5)
"""

from typing import Annotated

from slopekit.studies.protocol import (
    DESK,
    ADesign,
    Argument,
    Jobs,
    Option,
    Scheduler,
    Workplace,
    number_of,
    study,
)
from slopekit.studies.ranges import Within
from slopekit.studies.running import checked_crew
from slopekit.studies.solve.by_factor import for_factor
from slopekit.studies.solve.solutions import Solution

_ABOUT = 60  # evaluations: for the bar


@study
def solve(
    design: ADesign,
    key: Annotated[str, Argument("strength.weak.phi, or with a range: slope.height=10m:40m", "KEY")],
    *,
    fos: Annotated[float | None, Option("Factor of safety wanted [the acceptance rule's].", number_of)] = None,
    within: Within | None = None,
    jobs: Jobs = 1,
    scheduler: Scheduler = None,
    desk: Workplace = DESK,
) -> Solution:
    """The value of any one number of a design that gives a factor of safety, by both methods.

    Exit codes: 0 found, 1 there is no such value (the sheet says why), 4 the methods disagree at it.

    Raises
    ------
    DesignError
        E280 a design without a file, E310 and E311 for the key, E312 for the range, E314 for the target.
        Where no value gives the target, `answer` is None and `reason` says why.

    Notes
    -----
    In Python `within` may be the range, (low, high) or "lo:hi". The roots of F(value) - target are found by bracketing,
    all that the range has; `rounded` is the first in four digits, on the safe side.

    Examples
    --------
    >>> import slopekit as sk
    >>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
    >>> round(sk.solve(sk.load(wedge), "water.fill", fos=1.2).answer.value, 4)
    0.6805
    """
    crew = checked_crew(jobs, scheduler)
    with desk.bar("evaluations", _ABOUT) as advance:
        return for_factor(design, key, fos, within, crew, advance)
