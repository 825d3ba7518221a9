"""The whole suite, run once for all tests that look at it: the workers of a test run share it through a file."""

import os
import pickle
from functools import cache
from pathlib import Path

from slopekit.studies.suite import Verification, suite


@cache
def the_suite(own: Path) -> Verification:
    """Every case of the suite; `own` is the temporary folder of this worker, beside those of the others."""
    if "PYTEST_XDIST_WORKER" not in os.environ:
        return suite()
    kept = own.parent / "suite.pickle"
    if kept.exists():
        found: Verification = pickle.loads(kept.read_bytes())
        return found
    found = suite()
    part = own / "suite.pickle"
    part.write_bytes(pickle.dumps(found))
    part.replace(kept)  # whole, or not there
    return found
