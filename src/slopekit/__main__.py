"""`python -m slopekit`."""

from slopekit.cli import start

start()
