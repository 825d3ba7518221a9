"""The whole suite, run once for all tests that look at it."""

from functools import cache

from slopekit.studies.suite import Verification, verify


@cache
def the_suite() -> Verification:
    """Every case of the suite."""
    return verify()
