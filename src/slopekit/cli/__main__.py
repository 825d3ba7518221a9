"""`python -m slopekit.cli`."""

from slopekit.cli import start

start()
