"""`python -m slopekit.cli`."""

from slopekit.cli import main

main()
