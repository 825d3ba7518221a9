"""slopekit: rock wedges and slopes by rigid blocks (PRE-IE), checked against closed forms.

>>> import slopekit as sk
>>> result = sk.wedge(dips=("45/115", "45/245"))
>>> result.status, round(result.fos.limit, 4), round(result.fos.closed_form, 4)
('slides_on_both', 1.5574, 1.5574)
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from slopekit._version import __version__
from slopekit.api import analyse, combos, kinematic, load, plot, prob, report, run, solve, sweep, tornado, wedge
from slopekit.errors import DesignError, Fault, GeometryError, SlopekitError, SolverError

if TYPE_CHECKING:
    from slopekit.exchange.export import export
    from slopekit.studies.check import check
    from slopekit.studies.support import support

__all__ = [
    "DesignError", "Fault", "GeometryError", "SlopekitError", "SolverError", "__version__", "analyse", "check",
    "combos", "export", "kinematic", "load", "plot", "prob", "report", "run", "solve", "support", "sweep", "tornado",
    "wedge",
]  # fmt: skip


#: Calls that are the function itself, from a module that loads when they are asked for.
_LATER = {"check": "studies.check", "export": "exchange.export", "support": "studies.support"}


def __getattr__(name: str) -> Any:
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"slopekit.{_LATER[name]}"), name)
