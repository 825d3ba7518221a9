"""The loops of many blocks and of a cracked base compiled (`_kernels.c`), where there was a C compiler at the install.

Without, or with the environment variable SLOPEKIT_KERNELS=numpy, NumPy does the same, slower; both ways are tested.
SLOPEKIT_KERNELS=compiled asks for them: what is missing is an error then.
"""

import os
import zlib
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

from slopekit.core.errors import Fault, SlopekitError

_ROUTINES = {
    "cython_blas": ("dtrsm", "dgemm", "dsyrk", "dtrsv", "dgemv"),
    "cython_lapack": ("dgetrf", "dpotrf"),
}


def compiled(solvers: bool = True) -> Any:
    """Return the compiled kernels; None where NumPy is to do their work.

    Parameters
    ----------
    solvers : with SciPy's BLAS and LAPACK, which take time to load and which only the fronts need

    Raises
    ------
    SlopekitError
        E506 SLOPEKIT_KERNELS asks for them and they are not there, or it says neither numpy nor compiled.
    """
    kernels, missing = chosen(solvers)
    if kernels is None and os.environ.get("SLOPEKIT_KERNELS") == "compiled":
        raise SlopekitError([Fault("E506", f"SLOPEKIT_KERNELS=compiled, but {missing}")])
    return kernels


def chosen(solvers: bool = True) -> tuple[ModuleType | None, str]:
    """Return the module of compiled kernels and an empty text, or None and the reason why there is none."""
    setting = os.environ.get("SLOPEKIT_KERNELS", "")
    if setting not in ("", "numpy", "compiled"):
        raise SlopekitError(
            [Fault("E506", f"SLOPEKIT_KERNELS is {setting!r}: it may be numpy or compiled")]
        )
    return (
        (None, "SLOPEKIT_KERNELS=numpy")
        if setting == "numpy"
        else _bound_to_lapack()
        if solvers
        else _imported()
    )


@cache
def _imported() -> tuple[ModuleType | None, str]:
    """Import the module of compiled kernels; return None and the reason where it is missing or of another source."""
    try:
        module = import_module("slopekit.preie._kernels")
    except ImportError as error:
        return None, f"they were not compiled when slopekit was installed ({error})"
    source = Path(__file__).with_name("_kernels.c").read_bytes()
    if zlib.crc32(source) & 0x7FFFFFFF != module.SOURCE:
        return None, "they were compiled from another _kernels.c: install slopekit again"
    return module, ""


@cache
def _bound_to_lapack() -> tuple[ModuleType | None, str]:
    """Import the compiled kernels and bind them to SciPy's BLAS and LAPACK; return None and the reason without them."""
    module, missing = _imported()
    if module is None:
        return None, missing
    routines: dict[str, Any] = {}
    for library, names in _ROUTINES.items():
        offered = import_module(f"scipy.linalg.{library}").__pyx_capi__
        routines |= {name: offered[name] for name in names}
    try:
        module.bind(routines)
    except ValueError as error:
        return None, str(error)
    return module, ""
