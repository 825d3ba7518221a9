"""What each number of a design does to its factor of safety, one at a time."""

from slopekit.studies.tornado.run import RULE, Tornado, TornadoBar, tornado

__all__ = ["RULE", "Tornado", "TornadoBar", "tornado"]
