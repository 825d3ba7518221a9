"""The value of one number of a design that gives a factor of safety, or a probability of failure."""

from slopekit.studies.solve.by_probability import ProbabilitySolution
from slopekit.studies.solve.run import solve
from slopekit.studies.solve.solutions import Solution

__all__ = ["ProbabilitySolution", "Solution", "solve"]
