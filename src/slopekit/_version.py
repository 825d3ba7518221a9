"""The version, read by the build and printed on every sheet."""

__version__ = "0.1.0"
