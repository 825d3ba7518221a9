"""slopekit: rock wedges and slopes by rigid blocks (PRE-IE), checked against closed forms.

>>> import slopekit as sk
>>> result = sk.wedge(dips=("45/115", "45/245"))
>>> result.status, round(result.fos.limit, 4), round(result.fos.closed_form, 4)
('slides_on_both', 1.5574, 1.5574)
"""

from typing import TYPE_CHECKING, Any

from slopekit._version import __version__
from slopekit.errors import DesignError, Fault, GeometryError, SlopekitError, SolverError
from slopekit.exchange_calls import export
from slopekit.picture_calls import plot
from slopekit.report_calls import report
from slopekit.study_calls import check, combos, kinematic, prob, solve, support, sweep, tornado

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

    from slopekit.design.common import Design
    from slopekit.result import Result

__all__ = [
    "DesignError", "Fault", "GeometryError", "SlopekitError", "SolverError", "__version__", "analyse", "check",
    "combos", "export", "kinematic", "load", "plot", "prob", "report", "run", "solve", "support", "sweep", "tornado",
    "wedge",
]  # fmt: skip


def wedge(
    dips: Any = None,
    *,
    face: Any = None,
    upper: Any = None,
    height: Any = None,
    c: Any = None,
    phi: Any = None,
    density: Any = None,
    unit_weight: Any = None,
    dilation: Any = None,
    tension: Any = None,
    water: Any = None,
    crack: Any = None,
    seismic: Any = None,
    forces: Any = None,
    bolts: Any = None,
    normal_stiffness: Any = None,
    shear_stiffness: Any = None,
    criterion: str | None = None,
    accept: float | None = None,
    agree_within: float | None = None,
    gravity: Any = None,
    water_unit_weight: Any = None,
    refine: int | None = None,
    origin: Any = None,
    **unknown: Any,
) -> "Result":
    """Analyse one wedge; what is left out takes the paper's wedge (Sheng et al. 2023, §4.1).

    Parameters
    ----------
    dips : the two joints, "45/115" or (45, 115) each: dip / dip direction, degrees
    face, upper : slope face and upper slope, the same way
    height : m, vertical, from the toe to where the trace of joint 1 meets the crest
    c, phi, dilation, tension : kPa, degrees, degrees, kPa; one value, or one for each joint
    density, unit_weight : kg/m³ or kN/m³; one of the two
    water : "dry", "full", a fraction or "50%" of full, or mean pressures in kPa on J1, J2 (and the crack)
    crack : "80/180@5m" or {"plane": ..., "distance": ...}; the distance from the crest along the trace of joint 1
    seismic : coefficient, or "0.1@180" with the trend it acts toward (else that of the line of intersection)
    forces : (east, north, up) kN through the centroid, "500kN@180/10", or {"force": ..., "at": (x, y, z)}
    bolts : "200kN@000/10,passive" or {"force", "toward", "acts", "head", "length"}; the toe is the origin
    normal_stiffness, shear_stiffness : kN/m³; "clough-duncan" for the paper's hyperbola (default)
    criterion : "limit", or "all-pairs" to add the paper's criterion
    accept : smallest factor of safety that is accepted; agree_within : largest relative difference of the methods
    gravity, water_unit_weight : 9.81 m/s², 9.81 kN/m³
    refine : how often the triangles of the joints are split in four
    origin : (east, north, up) of the toe, for map coordinates

    Raises
    ------
    DesignError
        With every fault of the input. GeometryError where the planes cut no wedge.
    """
    from slopekit.design.reading import wedge_design

    given = {key: value for key, value in locals().items() if key not in ("unknown", "wedge_design")}
    return analyse(wedge_design(given | unknown))


def load(source: "str | os.PathLike[str] | Mapping[str, Any]", set: "Mapping[str, Any] | None" = None) -> "Design":
    """Read and check a design file, or the same as a dict.

    Parameters
    ----------
    set : dotted paths and values that replace those of the file: {"strength.weak.phi": 25}

    Raises
    ------
    DesignError
        With every fault found.
    """
    from slopekit.design.files import load as load_design

    return load_design(source, tuple((set or {}).items()))


def analyse(design: "Design") -> "Result":
    """Analyse a loaded design of any kind. Raises GeometryError where no block can be formed."""
    from slopekit.kinds import analyse as analyse_design

    return analyse_design(design)


def run(
    source: "str | os.PathLike[str] | Mapping[str, Any] | Design", set: "Mapping[str, Any] | None" = None
) -> "Result":
    """Read, check and analyse a design file (or a dict, or a design that `load` has read).

    Raises
    ------
    DesignError
        With every fault of the input. GeometryError where no block can be formed.

    >>> import slopekit as sk
    >>> design = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
    >>> round(sk.run(design, set={"water": "full"}).fos.limit, 3)
    1.039
    """
    from slopekit.design.common import Design

    if not isinstance(source, Design):
        source = load(source, set)
    elif set:
        raise DesignError(
            [Fault("E160", "a design that is loaded takes no further values", "set", "Give set to load.")]
        )
    return analyse(source)
