"""Bolts, or a pressure on the face, that give a wedge or a plane a factor of safety."""

from slopekit.studies.support.records import Support
from slopekit.studies.support.run import support

__all__ = ["Support", "support"]
