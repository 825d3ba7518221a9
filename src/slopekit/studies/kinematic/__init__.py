"""A joint survey tested against a slope by orientation and friction."""

from slopekit.studies.kinematic.run import Kinematic, kinematic

__all__ = ["Kinematic", "kinematic"]
