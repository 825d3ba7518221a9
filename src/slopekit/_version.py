"""The version, read by the build and printed on every sheet."""

__version__ = "0.1.0"
#: Of JSON documents: 2 since one rule gives one limit (CHANGELOG.md says what went).
FORMAT = 2
