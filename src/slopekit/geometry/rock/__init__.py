"""The rock about a slope and the planes through it: what is cut, and into which blocks."""
