"""Probability of failure: samples of what scatters, judged by the closed form, by PRE-IE, or by both."""

from slopekit.studies.prob.run import Probability, ProbabilityOptions, prob

__all__ = ["Probability", "ProbabilityOptions", "prob"]
