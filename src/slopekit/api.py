"""What a script calls: `sk.wedge`, `sk.run`, the studies, pictures and the report; each loads its code when called."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

from slopekit.errors import DesignError, Fault

if TYPE_CHECKING:
    from slopekit.design.common import Design
    from slopekit.result import Result
    from slopekit.views.notebook import Drawing


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
    from slopekit.kinds.wedge.design import wedge_design

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


# -- pictures and pages -----------------------------------------------------------------------------------------------


@overload
def plot(source: Any, what: None = None) -> dict[str, str]: ...


@overload
def plot(
    source: Any,
    what: str,
    path: "str | os.PathLike[str] | None" = None,
    *,
    show: bool = False,
    equal_angle: bool = False,
    test: str | None = None,
    explode: float | None = None,
    magnify: float | None = None,
    step: int = 1,
) -> "Drawing | None": ...


def plot(
    source: Any,
    what: str | None = None,
    path: "str | os.PathLike[str] | None" = None,
    *,
    show: bool = False,
    equal_angle: bool = False,
    test: str | None = None,
    explode: float | None = None,
    magnify: float | None = None,
    step: int = 1,
) -> "Drawing | dict[str, str] | None":
    """Draw a picture of a result or a study (extra: plot).

    Parameters
    ----------
    source : what `sk.run`, `sk.wedge`, `sk.sweep`, ... return, their `to_dict()`, or the path of their JSON or folder
    what : scene, exploded, tractions, forces, displacement, mechanism, factors, ravelling, stereonet, elevation,
        histogram, curve, contour, tornado, speed-error, reduction or normals [nothing is drawn: the words that it can
        give]
    path : the file: .png, .svg or .pdf; scenes .png, .glb or .gltf [beside the JSON, or in this folder: NAME-WHAT.png]
    show : a window in place of a file
    equal_angle, test : of stereonets
    explode : of exploded; magnify : of displacement and mechanism; step : of mechanism

    Returns
    -------
    The path written, which shows itself in a notebook, None where a window was shown; without `what` the pictures by
    their word, and what they show.

    Raises
    ------
    DesignError
        E106, E340 to E347 for what cannot be drawn, E140 without the extra.
    """
    from slopekit.views import plots
    from slopekit.views.notebook import Drawing

    folder, name = Path(), ""
    if isinstance(source, str | os.PathLike):
        file = plots.document_file(Path(source))
        document, folder, name = plots.read_document(file), file.parent, file.stem
    else:
        given = source.to_dict() if hasattr(source, "to_dict") else source
        document = plots.checked_document(given, type(source).__name__)
        name = str(document.get("study") or document.get("kind") or "result")
    if what is None:
        return plots.offers(document)
    target = folder / f"{name}-{what}.png" if path is None else Path(path)
    options = plots.Options(show, "angle" if equal_angle else "area", test, explode, magnify, step)
    plots.draw(document, what, None if show else target, options, name)
    return None if show else Drawing(target)


def report(
    results: Any,
    path: "str | os.PathLike[str]" = "report.html",
    *,
    pictures: bool = True,
    project: "Mapping[str, str] | None" = None,
) -> "Path":
    """Write a page of HTML that needs no network, of a result, a study, or several of them (extra: report).

    Parameters
    ----------
    results : what `sk.run`, `sk.sweep`, ... return, their `to_dict()`, the path of their JSON or folder; or a list
    path : of the page, or the folder for report.html
    pictures : draw the still pictures as well (extra: plot); those that cannot be drawn are named in the page
    project : name, client, number, author, checker, revision, date for the head of the page

    Returns
    -------
    the path written

    Raises
    ------
    DesignError
        E140 without the extra, E147 to E149, E340, E341, E371 and E372 for what is no result, E376 for the project,
        E129 where the page cannot be written.
    """
    from slopekit.views.report import write_report

    target = Path(path)
    target = target / "report.html" if target.is_dir() else target
    several = list(results) if isinstance(results, list | tuple) else [results]
    write_report([_document(one) for one in several], target, with_pictures=pictures, project=project)
    return target


def _document(source: Any) -> "Mapping[str, Any]":
    """The JSON of anything that has one."""
    from slopekit.views.plots import document_file, read_document

    if isinstance(source, Mapping):
        return source
    if callable(own := getattr(source, "to_dict", None)):
        found: Mapping[str, Any] = own()
        return found
    return read_document(document_file(Path(source)))
