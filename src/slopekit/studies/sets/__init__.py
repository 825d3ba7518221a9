"""A joint survey divided into joint sets, with the statistics of each."""

from slopekit.studies.sets.run import JointSets, sets

__all__ = ["JointSets", "sets"]
