"""The value of one number of a design that gives a factor of safety, or a probability of failure.

>>> import slopekit as sk
>>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
...          "strength": {"weak": {"c": 50, "phi": 20}}}
>>> found = solve(sk.load(wedge), "strength.weak.c", fos=1.5).answer
>>> round(found.value, 3), round(found.factor, 9)
(43.41, 1.5)
"""

from functools import partial
from typing import Annotated, Any, overload

from slopekit.core.errors import DesignError, Fault
from slopekit.design.common import Design
from slopekit.design.reading.files import Source
from slopekit.studies.cases import Cases
from slopekit.studies.prob import Probability, prob
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
    whole_number,
)
from slopekit.studies.ranges import Within
from slopekit.studies.running import checked_crew
from slopekit.studies.solve.by_factor import for_factor
from slopekit.studies.solve.by_probability import Estimate, ProbabilitySolution, for_probability
from slopekit.studies.solve.solutions import Solution

_ABOUT = 60  # evaluations: for the bar


@overload
def solve(
    design: Source, /, key: str, *, fos: float | None = None, pf: None = None, within: Within | None = None,
    n: None = None, seed: None = None, jobs: Any = 1, scheduler: str | None = None, desk: Workplace = DESK,
) -> Solution | Cases[Solution]: ...  # fmt: skip


@overload
def solve(
    design: Source, /, key: str, *, pf: float, fos: float | None = None, within: Within | None = None,
    n: int | None = None, seed: int | None = None, jobs: Any = 1, scheduler: str | None = None, desk: Workplace = DESK,
) -> ProbabilitySolution | Cases[ProbabilitySolution]: ...  # fmt: skip


@study
def solve(
    design: ADesign,
    key: Annotated[str, Argument("strength.weak.phi, or with a range: slope.height=10m:40m", "KEY")],
    *,
    fos: Annotated[float | None, Option("Factor of safety wanted [the acceptance rule's].", number_of)] = None,
    pf: Annotated[float | None, Option("Probability of failure wanted instead, 5% or 0.05.", number_of)] = None,
    within: Within | None = None,
    n: Annotated[int | None, Option("With --pf: samples [20000].", whole_number, "-n")] = None,
    seed: Annotated[int | None, Option("With --pf: seed of the random numbers [1].", whole_number)] = None,
    jobs: Jobs = 1,
    scheduler: Scheduler = None,
    desk: Workplace = DESK,
) -> Solution | ProbabilitySolution:
    """The value of any one number of a design that gives a target, by both methods.

    With --pf, --fos is what fails lies below [1], and the value holds the probability that `prob` leads with. Exit
    codes: 0 found, 1 there is no such value (the sheet says why), 4 the methods disagree at it.

    Raises
    ------
    DesignError
        E280 a design without a file, E310 and E311 for the key, E312 for the range, E313 for what does not go
        together, E314 for the target. Where no value gives the target, `answer` is None and `reason` says why.

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
    if pf is None:
        for name, given in (("n", n), ("seed", seed)):
            if given is not None:
                option = desk.named(name)
                message = f"{option} belongs to {desk.named('pf')}: a factor of safety needs no samples"
                raise DesignError([Fault("E313", message, option)])
        with desk.bar("evaluations", _ABOUT) as advance:
            return for_factor(design, key, fos, within, crew, advance)

    def failure_probability(changed: Design, **looks: Any) -> Estimate:
        """What `prob` leads with, of the same samples."""
        probability = prob(changed, n, seed=1 if seed is None else seed, fos=1.0 if fos is None else fos, jobs=jobs,
                           scheduler=scheduler, **looks)  # fmt: skip
        assert isinstance(probability, Probability)  # a case of a design has none itself
        lead = probability.leading
        if lead.probability is None or probability.forming.share is None:  # no block is no safety
            raise DesignError([Fault("E318", "no sample forms a block that could be judged")])
        disagree = probability.disagree or (
            0 if probability.confirmation is None else probability.confirmation.disagree
        )
        return Estimate(lead.probability, lead.low, lead.high, lead.by, disagree)

    counted = partial(failure_probability, confirm=0, near=0.0)  # without a look by PRE-IE: hundred times as quick
    with desk.bar("probabilities", _ABOUT) as advance:
        return for_probability(design, key, pf, counted, failure_probability, within=within, advance=advance)
