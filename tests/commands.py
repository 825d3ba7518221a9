"""A slopekit command in this process: what one of its own prints and ends with, without its start of half a second.

A few tests start a process all the same, where that is what they are about: `tests/test_cli.py`.
"""

import sys
from contextlib import chdir, redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import NamedTuple

from slopekit.cli import main


class Ran(NamedTuple):
    """Exit code and the two streams, named as those of `subprocess.run`."""

    returncode: int
    stdout: str
    stderr: str


def slopekit(*arguments: str, cwd: Path | None = None) -> Ran:
    """Run a command, in another folder where one is given."""
    out, err, before = StringIO(), StringIO(), sys.argv
    try:
        sys.argv = ["slopekit", *arguments]
        with chdir(cwd or "."), redirect_stdout(out), redirect_stderr(err):
            main()
    except SystemExit as end:
        return Ran(int(end.code or 0), out.getvalue(), err.getvalue())
    finally:
        sys.argv = before
    raise AssertionError("the command did not end")
