"""slopekit: rock wedges and slopes by rigid blocks (PRE-IE), checked against closed forms.

>>> import slopekit as sk
>>> result = sk.wedge(dips=("45/115", "45/245"))
>>> result.status, round(result.fos.limit, 4), round(result.fos.closed_form, 4)
('slides_on_both', 1.5574, 1.5574)
"""

from slopekit._version import __version__

TYPE_CHECKING = (
    False  # typing's takes 10 ms to load, in which Ctrl-C would end a command with a traceback
)
if TYPE_CHECKING:
    from typing import Any

    from slopekit.api import analyse, load, plot, report, run, wedge
    from slopekit.core.errors import DesignError, Fault, GeometryError, SlopekitError, SolverError
    from slopekit.exchange.export import export
    from slopekit.result import Result as Result
    from slopekit.studies.bench_design import BenchDesigns as BenchDesigns
    from slopekit.studies.bench_design import bench_design
    from slopekit.studies.cases import Cases as Cases
    from slopekit.studies.check import Check as Check
    from slopekit.studies.check import check
    from slopekit.studies.combos import Combos as Combos
    from slopekit.studies.combos import combos
    from slopekit.studies.evaluation import evaluate
    from slopekit.studies.kinematic import Kinematic as Kinematic
    from slopekit.studies.kinematic import kinematic
    from slopekit.studies.prob import Probability as Probability
    from slopekit.studies.prob import prob
    from slopekit.studies.quake import Quake as Quake
    from slopekit.studies.quake import quake
    from slopekit.studies.sets import JointSets as JointSets
    from slopekit.studies.sets import sets
    from slopekit.studies.solve import Solution as Solution
    from slopekit.studies.solve import solve
    from slopekit.studies.support import Support as Support
    from slopekit.studies.support import support
    from slopekit.studies.sweep import Sweep as Sweep
    from slopekit.studies.sweep import sweep
    from slopekit.studies.tornado import Tornado as Tornado
    from slopekit.studies.tornado import tornado

__all__ = [
    "DesignError",
    "Fault",
    "GeometryError",
    "SlopekitError",
    "SolverError",
    "__version__",
    "analyse",
    "bench_design",
    "check",
    "combos",
    "evaluate",
    "export",
    "kinematic",
    "load",
    "plot",
    "prob",
    "quake",
    "report",
    "run",
    "sets",
    "solve",
    "support",
    "sweep",
    "tornado",
    "wedge",
]


#: Names that are imported on first access, and their modules, so that the command line sets the garbage collector
#: before anything is loaded (1 to 2 ms of a cold wedge); functions of studies: `slopekit.studies.protocol.STUDIES`.
_LAZY_EXPORTS = {
    **dict.fromkeys(("analyse", "load", "plot", "report", "run", "wedge"), "api"),
    **dict.fromkeys(
        ("DesignError", "Fault", "GeometryError", "SlopekitError", "SolverError"), "core.errors"
    ),
    "BenchDesigns": "studies.bench_design",
    "Cases": "studies.cases",
    "Check": "studies.check",
    "Combos": "studies.combos",
    "evaluate": "studies.evaluation",
    "export": "exchange.export",
    "JointSets": "studies.sets",
    "Kinematic": "studies.kinematic",
    "Probability": "studies.prob",
    "Quake": "studies.quake",
    "Result": "result",
    "Solution": "studies.solve",
    "Support": "studies.support",
    "Sweep": "studies.sweep",
    "Tornado": "studies.tornado",
}


def __getattr__(name: str) -> "Any":
    from importlib import import_module

    from slopekit.core.argument_checks import with_checked_arguments

    if name in _LAZY_EXPORTS:
        attribute = getattr(import_module(f"slopekit.{_LAZY_EXPORTS[name]}"), name)
        return attribute if isinstance(attribute, type) else with_checked_arguments(attribute)
    from slopekit.studies.protocol import STUDIES, VARIANTS, function_of

    command = name.replace("_", "-")
    if command not in STUDIES and command not in VARIANTS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return with_checked_arguments(function_of(command))


def __dir__() -> list[str]:
    from slopekit.studies.protocol import STUDIES

    return sorted({*__all__, *(name.replace("-", "_") for name in STUDIES)})
