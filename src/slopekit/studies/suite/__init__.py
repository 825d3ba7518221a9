"""The verification suite: what others say, beside what slopekit finds."""

from slopekit.studies.suite.run import Row, Verification, suite

__all__ = ["Row", "Verification", "suite"]
