"""Probability of failure: samples of what scatters, judged by the closed form, by PRE-IE, or by both."""

from slopekit.studies.prob.run import Asked, Probability, prob

__all__ = ["Asked", "Probability", "prob"]
