"""A design held against itself: how far two methods agree, what its number rests on, what accuracy costs."""

from slopekit.studies.check.run import Check, Finding, check

__all__ = ["Check", "Finding", "check"]
