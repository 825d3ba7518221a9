"""What a script calls: `sk.wedge`, `sk.run`, the studies, pictures and the report; each loads its code when called."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, overload

from slopekit.core.options import DESIGN, DESK, Desk, Option, documented
from slopekit.errors import DesignError, Fault

if TYPE_CHECKING:
    from slopekit.design.common import Design
    from slopekit.result import Result
    from slopekit.studies.combos import Combos
    from slopekit.studies.keys import Within
    from slopekit.studies.kinematic import Kinematic
    from slopekit.studies.probability import Probability
    from slopekit.studies.solutions import Solution
    from slopekit.studies.solve_probability import ProbabilitySolution
    from slopekit.views.notebook import Drawing


@documented
def wedge(
    dips: Annotated[
        Any, Option("The two joints, dip/dip direction each.", metavar="D/DD D/DD", texts=2, needed=True)
    ] = None,
    *,
    face: Annotated[Any, Option("Slope face, D/DD [60/180].")] = None,
    upper: Annotated[Any, Option("Upper slope, D/DD [10/180].")] = None,
    height: Annotated[Any, Option("Vertical, toe to crest at J1's trace [64.89 m].")] = None,
    c: Annotated[Any, Option("Cohesion, one value or C1,C2 [50 kPa].")] = None,
    phi: Annotated[Any, Option("Friction angle, one value or P1,P2 [20].")] = None,
    density: Annotated[Any, Option("Density [2600 kg/m3].")] = None,
    unit_weight: Annotated[Any, Option("Unit weight, kN/m3, instead of a density.")] = None,
    dilation: Annotated[Any, Option("Dilation angle of the joints, 0 to phi [0].")] = None,
    tension: Annotated[Any, Option("Tensile strength of the joints [0 kPa].")] = None,
    water: Annotated[Any, Option("dry, full, 50%, u=9.8kPa or u=5kPa,8kPa[,crack] [dry].")] = None,
    crack: Annotated[Any, Option("Tension crack, D/DD@DIST from the crest along J1's trace.")] = None,
    seismic: Annotated[Any, Option("Pseudo-static coefficient, K or K@TREND.")] = None,
    forces: Annotated[Any, Option("F@TREND/PLUNGE, kN; repeat for more.", flag="--force", texts=0)] = None,
    bolts: Annotated[Any, Option("T@TREND/PLUNGE[,active|passive], kN; repeat.", flag="--bolt", texts=0)] = None,
    normal_stiffness: Annotated[Any, Option("k_zz of closed joints [1e7 kN/m3].")] = None,
    shear_stiffness: Annotated[Any, Option("kN/m3, or clough-duncan [clough-duncan].")] = None,
    criterion: Annotated[str | None, Option("limit, or all-pairs to add the paper's criterion.")] = None,
    accept: Annotated[float | None, Option("Smallest factor of safety accepted; exit code 1 below it.")] = None,
    agree_within: Annotated[float | None, Option("Largest difference of the two methods [1%].")] = None,
    gravity: Annotated[Any, Option("Acceleration of gravity [9.81 m/s2].")] = None,
    water_unit_weight: Annotated[Any, Option("Unit weight of water [9.81 kN/m3].")] = None,
    refine: Annotated[int | None, Option("Split the joints' triangles in four this often [0].")] = None,
    origin: Annotated[Any, Option("Map coordinates of the toe, E,N,Z.")] = None,
    desk: Desk = DESK,
    **unknown: Any,
) -> "Result":
    """One wedge of two joints. What is left out takes the paper's wedge (Sheng et al. 2023, §4.1): the sheet says so.

    Raises
    ------
    DesignError
        With every fault of the input. GeometryError where the planes cut no wedge.

    Notes
    -----
    Values are written as on the command line, "45/115" or "5 kPa", or as Python has them: planes (45, 115), numbers,
    (J1, J2) where the joints differ, forces (east, north, up) in kN or {"force": ..., "at": (x, y, z)}, bolts
    {"force", "toward", "acts", "head", "length"}, a crack {"plane": ..., "distance": ...}, the origin (E, N, Z).
    """
    from slopekit.kinds.wedge.design import wedge_design

    given = {key: value for key, value in locals().items() if key not in ("unknown", "desk", "wedge_design")} | unknown
    return analyse(wedge_design(given) if desk is DESK else wedge_design(given, desk.named))


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


@documented
def run(
    source: Annotated["str | os.PathLike[str] | Mapping[str, Any] | Design", DESIGN],
    set: "Mapping[str, Any] | None" = None,
) -> "Result":
    """Any design file: wedge, plane, footing, surface, bench, blocks, topple.

    Raises
    ------
    DesignError
        With every fault of the input. GeometryError where no block can be formed.

    Notes
    -----
    A script gives the path, the same as a dict, or a design that `load` has read; `set` replaces values of it.

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


# -- studies ----------------------------------------------------------------------------------------------------------


def prob(
    design: "Design",
    n: int | None = None,
    *,
    seed: int = 1,
    method: str = "monte-carlo",
    by: Any = None,
    target: float = 1.0,
    confirm: int = 200,
    near: float | None = None,
    confidence: float = 0.95,
    accept: float | None = None,
    jobs: Any = 1,
    scheduler: str | None = None,
    executor: Any = None,
) -> "Probability":
    """The probability that the factor of safety of a design, with numbers that scatter, lies below a target.

    Parameters
    ----------
    n : samples: 20,000 by the closed form, 1,000 where PRE-IE has to be asked
    seed : the same seed gives the same numbers; method : monte-carlo, latin-hypercube or sobol
    by : closed-form or pre-ie; left out, the closed form where the kind has one that knows all of the design
    confirm : samples at random that PRE-IE looks at; near : besides all within this part of the target
    confidence : of the limits; accept : largest probability accepted
    jobs : processes; scheduler : of a Dask cluster; executor : any of `concurrent.futures`

    Raises
    ------
    DesignError
        E302 nothing scatters, E307 and E308 for what is not understood.
    """
    from slopekit.studies.probability import probability
    from slopekit.studies.running import checked_crew

    return probability(
        design, n, seed=seed, method=method, by=by, target=target, confirm_count=confirm, near=near,
        confidence=confidence, accept=accept, crew=checked_crew(jobs, scheduler, executor),
    )  # fmt: skip


def solve(
    design: "Design",
    key: str,
    *,
    fos: float | None = None,
    pf: float | None = None,
    within: "Within | None" = None,
    n: int | None = None,
    seed: int = 1,
    jobs: Any = 1,
    scheduler: str | None = None,
) -> "Solution | ProbabilitySolution":
    """The value of one number of a loaded design that gives a factor of safety, or a probability of failure.

    Parameters
    ----------
    key : dotted path
    fos : the target; left out, the design's acceptance rule. With `pf`: what fails lies below it [1]
    pf : a probability of failure as the target; n, seed : of its samples
    within : (low, high) or "lo:hi", between which to look

    Raises
    ------
    DesignError
        With every fault of the input. Where no value gives the target, `answer` is None and `reason` says why.

    >>> import slopekit as sk
    >>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
    >>> round(sk.solve(sk.load(wedge), "water.fill", fos=1.2).answer.value, 4)
    0.6894
    """
    from slopekit.studies.running import checked_crew

    crew = checked_crew(jobs, scheduler)
    if pf is not None:
        from slopekit.studies.solve_probability import solve_for_probability

        return solve_for_probability(design, key, pf, fos=fos, n=n, seed=seed, within=within, crew=crew)
    from slopekit.studies.solve import solve as solve_design

    return solve_design(design, key, fos=fos, within=within, crew=crew)


def combos(
    joints: Any,
    *,
    face: Any = None,
    upper: Any = None,
    height: Any = None,
    c: Any = None,
    phi: Any = None,
    density: Any = None,
    unit_weight: Any = None,
    water: Any = None,
    seismic: Any = None,
    gravity: Any = None,
    water_unit_weight: Any = None,
    agree_within: Any = None,
    fos: Any = None,
    top: Any = None,
    persistence: Any = None,
    bench_width: Any = None,
    max_volume: Any = None,
    min_volume: Any = None,
    convention: str | None = None,
    skip_bad: bool = False,
    jobs: Any = 1,
    scheduler: str | None = None,
) -> "Combos":
    """Every pair of a joint survey as a wedge in a slope: removable or not and why, ranked; PRE-IE on the worst.

    Parameters
    ----------
    joints : path of a list (CSV, .xlsx, text of Dips, CloudCompare), a pandas or polars frame with such columns, planes
        ("45/115", (45, 115)), an (n, 2) array or {name: plane}
    face, upper : dip / dip direction; upper [level]
    height : of the slope, vertical, from the toe of a wedge up the dip of the face to the crest [15 m]
    c, phi : of joints whose own columns are empty
    density, unit_weight, water, seismic, gravity, water_unit_weight, agree_within : as for `wedge`
    fos : target; top : how many of the worst PRE-IE looks at [10]
    persistence, bench_width, max_volume : wedges are scaled down to these; min_volume : smaller ones are left out
    convention : what a strike column means, "RHR" or "LHR"; skip_bad : leave bad rows out, listed
    jobs, scheduler : who does PRE-IE's part

    Raises
    ------
    DesignError
        With every fault of the input. GeometryError where the slope has no crest.
    """
    from slopekit.studies.combos import combos as look_at
    from slopekit.studies.running import checked_crew

    slope = {
        "face": face, "upper": upper, "height": height, "c": c, "phi": phi, "density": density,
        "unit_weight": unit_weight, "water": water, "seismic": seismic, "gravity": gravity,
        "water_unit_weight": water_unit_weight, "agree_within": agree_within,
    }  # fmt: skip
    limits = {
        "persistence": persistence, "bench_width": bench_width, "max_volume": max_volume, "min_volume": min_volume,
    }  # fmt: skip
    return look_at(
        joints, slope, convention=convention, skip_bad=skip_bad, fos=fos, top=top, limits=limits,
        crew=checked_crew(jobs, scheduler),
    )  # fmt: skip


def kinematic(
    joints: Any,
    *,
    face: Any = None,
    phi: Any = None,
    lateral: Any = None,
    lateral_toppling: Any = None,
    faces: Any = None,
    convention: str | None = None,
    skip_bad: bool = False,
) -> "Kinematic":
    """Test a joint survey against a slope: planar and wedge sliding, flexural and direct toppling.

    Parameters
    ----------
    joints : path of a list (CSV, .xlsx, text of Dips, CloudCompare), a pandas or polars frame with such columns, planes
        ("45/115", (45, 115)), an (n, 2) array or {name: plane}
    face : dip / dip direction
    phi : friction angle of joints without their own [30]; lateral, lateral_toppling : limits in degrees [20, 30]
    faces : dips of the face to go through, "45:90:5" or a list
    convention : what a strike column means, "RHR" or "LHR"; skip_bad : leave bad rows out, listed

    Raises
    ------
    DesignError
        With every fault of the input.

    >>> import slopekit as sk
    >>> sk.kinematic(["40/175", "75/010"], face="65/180", phi=30).joint_names("planar")
    ('J1',)
    """
    from slopekit.studies.kinematic import kinematic as test

    return test(joints, face, phi, lateral, lateral_toppling, faces, convention, skip_bad)


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
    from slopekit.result import Result
    from slopekit.views.plots import document_file, read_document
    from slopekit.views.sheet import document_of

    if isinstance(source, Result):
        return document_of(source)
    if isinstance(source, Mapping):
        return source
    if callable(own := getattr(source, "to_dict", None)):
        found: Mapping[str, Any] = own()
        return found
    return read_document(document_file(Path(source)))
