"""Rank the numbers of a design by their effect on its factor of safety, changed one at a time."""

from slopekit.studies.tornado.run import RULE, Tornado, TornadoBar, tornado

__all__ = ["RULE", "Tornado", "TornadoBar", "tornado"]
