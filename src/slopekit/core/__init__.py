"""The lowest layer: sheets, units, orientations, faults, and dataclasses as JSON."""
