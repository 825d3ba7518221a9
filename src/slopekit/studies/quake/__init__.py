"""Earthquakes: the yield coefficient of a slope and the displacement of its block."""

from slopekit.studies.quake.run import Quake, Shaken, quake

__all__ = ["Quake", "Shaken", "quake"]
