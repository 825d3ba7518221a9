"""What an earthquake does to a slope: the yield coefficient and how far the block slides."""

from slopekit.studies.quake.run import Quake, Shaken, quake

__all__ = ["Quake", "Shaken", "quake"]
