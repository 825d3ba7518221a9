"""The whole suite, run once for all tests that look at it: the workers of a test run share it through a file."""

import os
import pickle
import tempfile
from functools import cache
from pathlib import Path

from slopekit.studies.suite import Verification, verify


@cache
def the_suite() -> Verification:
    """Every case of the suite."""
    run = os.environ.get("PYTEST_XDIST_TESTRUNUID")
    if run is None:
        return verify()
    kept = Path(tempfile.gettempdir()) / f"slopekit-suite-{run}.pickle"
    if kept.exists():
        found: Verification = pickle.loads(kept.read_bytes())
        return found
    found = verify()
    with tempfile.NamedTemporaryFile(dir=kept.parent, delete=False) as file:
        file.write(pickle.dumps(found))
    Path(file.name).replace(kept)  # whole, or not there
    return found
