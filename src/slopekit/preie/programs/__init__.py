"""Cone programs: what can be proved of a factor, and the mechanism that costs least."""
