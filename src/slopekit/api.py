"""The functions of scripts: `sk.wedge`, `sk.run`, the studies, pictures and the report; code is loaded on the call."""

import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, overload

from slopekit.core.argument_checks import wrong_kind
from slopekit.core.errors import DesignError, Fault, Notice, writing
from slopekit.core.options import DESIGN, DESK, Option, Workplace, documented

if TYPE_CHECKING:
    from slopekit.design.common import Design
    from slopekit.design.reading.files import Source
    from slopekit.result import Result
    from slopekit.studies.cases import Cases
    from slopekit.views.notebook import Drawing


ELASTIC = Option("Elastic blocks beside the rigid ones (extra: elastic).")


_ELASTIC_OPTIONS = ("modulus", "poisson", "edge")
_OPTIONS_NOT_IN_DESIGN = ("desk", "elastic")


@documented
def wedge(
    dips: Annotated[
        Any,
        Option(
            "The two joints, dip/dip direction each.", metavar="D/DD D/DD", texts=2, needed=True
        ),
    ] = None,
    *,
    face: Annotated[Any, Option("Slope face, D/DD [60/180].")] = None,
    upper: Annotated[Any, Option("Upper slope, D/DD [10/180].")] = None,
    height: Annotated[Any, Option("Vertical, toe to crest at J1's trace [64.89 m].")] = None,
    c: Annotated[Any, Option("Cohesion, one value or C1,C2[,basal] [50 kPa].")] = None,
    phi: Annotated[Any, Option("Friction angle, one value or P1,P2[,basal] [20].")] = None,
    density: Annotated[Any, Option("Density [2600 kg/m3].")] = None,
    unit_weight: Annotated[Any, Option("Unit weight, kN/m3, instead of a density.")] = None,
    dilation: Annotated[Any, Option("Dilation angle of the joints, 0 to phi [0].")] = None,
    tension: Annotated[Any, Option("Tensile strength of the joints [0 kPa].")] = None,
    water: Annotated[
        Any, Option("dry, full, 50%, u=9.8kPa or u=5kPa,8kPa[,basal][,crack] [dry].")
    ] = None,
    crack: Annotated[
        Any, Option("Tension crack, D/DD@DIST from the crest along J1's trace.")
    ] = None,
    basal: Annotated[Any, Option("Basal joint, D/DD@HEIGHT over the toe on J1's trace.")] = None,
    seismic: Annotated[Any, Option("Pseudo-static coefficient, K or K@TREND.")] = None,
    forces: Annotated[
        Any, Option("F@TREND/PLUNGE, kN; repeat for more.", flag="--force", texts=0)
    ] = None,
    bolts: Annotated[
        Any, Option("T@TREND/PLUNGE[,active|passive], kN; repeat.", flag="--bolt", texts=0)
    ] = None,
    normal_stiffness: Annotated[Any, Option("k_zz of closed joints [1e7 kN/m3].")] = None,
    shear_stiffness: Annotated[Any, Option("kN/m3, or clough-duncan [clough-duncan].")] = None,
    criterion: Annotated[
        str | None, Option("limit, or all-pairs to add the paper's criterion.")
    ] = None,
    accept: Annotated[
        float | None,
        Option(
            "Smallest factor of safety accepted; exit code 1 below it.",
            flag="--accept-fos",
            also=("--accept",),
        ),
    ] = None,
    agree_within: Annotated[
        float | None, Option("Largest difference of the two methods [1%].")
    ] = None,
    gravity: Annotated[Any, Option("Acceleration of gravity [9.81 m/s2].")] = None,
    water_unit_weight: Annotated[Any, Option("Unit weight of water [9.81 kN/m3].")] = None,
    limits: Annotated[
        Any,
        Option(
            "Limit of size, as in design files: bench_width=6m; repeat.", flag="--limit", texts=0
        ),
    ] = None,
    refine: Annotated[
        int | None, Option("Split the joints' triangles in four this often [0].")
    ] = None,
    origin: Annotated[Any, Option("Map coordinates of the toe, E,N,Z.")] = None,
    modulus: Annotated[Any, Option("Young's modulus of elastic rock [20 GPa].")] = None,
    poisson: Annotated[Any, Option("Its Poisson's ratio [0.25].")] = None,
    edge: Annotated[Any, Option("Longest edge of its finite elements [auto].")] = None,
    elastic: Annotated[bool, ELASTIC] = False,
    desk: Workplace = DESK,
    **unknown: Any,
) -> "Result":
    """One wedge of two joints. What is left out takes the paper's wedge (Sheng et al. 2023, §4.1): the sheet says so.

    Returns
    -------
    Result
        `status` in a word, `fos.limit` (PRE-IE, the answer), `fos.closed_form` (Hoek & Bray), `fos.static_bound`,
        `agree`, `warnings` (notices with their codes), `to_dict()` (the JSON), `sheet` (the text).

    Raises
    ------
    DesignError
        With every fault of the input.
    GeometryError
        Where the planes cut no wedge.

    Notes
    -----
    The limit is the largest F at which node-pair forces balance all loads, moments too, with the strength
    (c + σ tan φ) / F and slip that does not dilate the joints. Where the wedge slides along the line of intersection,
    of plunge ψ, without turning, it is that of the closed form::

        F = (c₁ A₁ + c₂ A₂ + N₁ tan φ₁ + N₂ tan φ₂) / (W sin ψ)

    with A in m², c in kPa, and in kN the weight W and the effective normal forces N₁ and N₂, which balance W square to
    the line; other loads join W. Frame: east, north, up; m, kN, kPa, kN/m³, degrees.

    Values are written as on the command line, "45/115" or "5 kPa", or as Python has them: planes (45, 115), numbers,
    (J1, J2) where the joints differ, forces (east, north, up) in kN or {"force": ..., "at": (x, y, z)}, bolts
    {"force", "toward", "acts", "head", "length"}, a crack {"plane": ..., "distance": ...}, a basal joint {"plane": ...,
    "height": ...}, the origin (E, N, Z). `limits` are those of design files: {"bench_width": 6,
    "trace_length": (10, 12), "by": "filter"}. Of a crack {"water": "3 m"} says how deep the water stands in it.

    References
    ----------
    Sheng, Li, Liu & Qi (2023), Applied Sciences 13, 7301. Hoek & Bray (1981), Rock Slope Engineering, ch. 8.

    Examples
    --------
    >>> import slopekit as sk
    >>> dry = sk.wedge(dips=("45/115", "45/245"))
    >>> dry.status, round(dry.fos.limit, 4), round(dry.fos.closed_form, 4), dry.agree
    ('slides_on_both', 1.5574, 1.5574, True)
    >>> wet = sk.wedge(dips=("45/115", "45/245"), water="full", accept=1.2)
    >>> round(wet.fos.limit, 4), wet.accepted
    (1.006, False)
    """
    arguments = {name: value for name, value in locals().items() if name != "unknown"} | unknown
    if not isinstance(elastic, bool):
        raise wrong_kind("wedge", "elastic", "True or False", elastic)
    design = design_of_wedge(arguments)
    from slopekit.kinds import analyse as analyse_design

    result = analyse_design(design, elastic)
    idle = [name for name in _ELASTIC_OPTIONS if arguments[name] is not None]
    if not idle or elastic:
        return result
    message = f"{' and '.join(idle)}: of elastic blocks, which were not asked for (--elastic); nothing was done with it"
    return replace(result, warnings=(*result.warnings, Notice("W366", message)))


def design_of_wedge(arguments: Mapping[str, Any]) -> "Design":
    """Return the checked design of the arguments of `wedge`, by name, without analysing it.

    Raises
    ------
    DesignError
        With every fault of the input.
    """
    from slopekit.kinds.wedge.design import wedge_design

    desk = arguments.get("desk", DESK)
    inputs = {key: value for key, value in arguments.items() if key not in _OPTIONS_NOT_IN_DESIGN}
    return wedge_design(inputs) if desk is DESK else wedge_design(inputs, desk.named)


def load(
    source: str | os.PathLike[str] | Mapping[str, Any],
    set: Mapping[str, Any] | None = None,
    case: str | None = None,
    *,
    allow_outside: bool = False,
) -> "Design":
    """Read and check a design file, or the same as a dict.

    Parameters
    ----------
    source : the path of a YAML file, or a mapping with its keys
    set : dotted paths and values that replace those of the file: {"strength.weak.phi": 25}
    case : one of its load cases by name; a design with cases goes through `analyse` and every study case by case
    allow_outside : whether the file may name meshes and joint lists outside its own folder

    Returns
    -------
    Design
        Of its `kind`, every value in m, kN, kPa, kN/m³ and degrees; `analyse` and the studies take it.

    Raises
    ------
    DesignError
        With every fault found, each with line and column.

    Examples
    --------
    >>> import slopekit as sk
    >>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
    >>> design = sk.load(wedge, set={"rock.density": "2.7 t/m3"})
    >>> design.kind, round(design.rock.unit_weight_kn_m3, 3)
    ('wedge', 26.487)
    """
    from slopekit.design.reading.files import load as load_design
    from slopekit.design.reading.named_files import files_outside

    with files_outside(allow_outside):
        return load_design(source, tuple((set or {}).items()), case)


def analyse(design: "Source", elastic: bool = False) -> "Result | Cases[Result]":
    """Analyse a design of any kind: a `Result`; with load cases `Cases`, whose `.cases` has a `Result` of each.

    Parameters
    ----------
    design : what `load` returns, the path of a design file, or the same as a dict
    elastic : elastic blocks beside the rigid ones (extra: elastic)

    Raises
    ------
    GeometryError
        Where no block can be formed.
    DesignError
        E140 without the extra, E125 and E288 what elastic blocks do not take.

    Examples
    --------
    >>> import slopekit as sk
    >>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
    >>> result = sk.analyse(sk.load(wedge))
    >>> result.status, round(result.fos.static_bound, 4)
    ('slides_on_both', 1.5868)
    >>> cases = sk.load(wedge | {"cases": {"dry": {"set": {"water": "dry"}}, "rain": {"set": {"water": "full"}}}})
    >>> {name: round(one.fos.limit, 3) for name, one in sk.analyse(cases).cases.items()}
    {'dry': 1.557, 'rain': 1.006}
    """
    from slopekit.design.reading.files import design_from
    from slopekit.kinds import analyse as analyse_design

    design = design_from(design, "analyse")
    if design.cases:
        from slopekit.studies.cases import each_case

        return each_case(analyse_design, "run", design, {"elastic": True} if elastic else {})
    return analyse_design(design, elastic)


@overload
def run(
    source: "Source",
    set: Mapping[str, Any] | None = None,
    *,
    case: str,
    elastic: bool = False,
) -> "Result": ...


@overload
def run(
    source: "Source",
    set: Mapping[str, Any] | None,
    case: str,
    elastic: bool = False,
) -> "Result": ...


@overload
def run(
    source: "Source",
    set: Mapping[str, Any] | None = None,
    case: str | None = None,
    elastic: bool = False,
) -> "Result | Cases[Result]": ...


@documented
def run(
    source: Annotated["Source", DESIGN],
    set: Mapping[str, Any] | None = None,
    case: str | None = None,
    elastic: Annotated[bool, ELASTIC] = False,
) -> "Result | Cases[Result]":
    """Any design file: wedge, plane, footing, surface, bench, blocks, topple.

    Raises
    ------
    DesignError
        With every fault of the input.
    GeometryError
        Where no block can be formed.

    Notes
    -----
    A script gives the path, the same as a dict, or a design that `load` has read; `set` replaces values of it, `case`
    names one of its load cases. What comes back is a `Result`, of a design with cases `Cases`: `.cases[NAME]`; a
    script with types says which: ``assert isinstance(r, sk.Result)``, or gives `case`.

    One block gets the limit of rigid blocks, as `wedge` does. Of many blocks it is the limit of the elastic path:
    joints without tension, k_t/k_n 0.4, whose strength goes down until the blocks no longer come to rest.

    References
    ----------
    Sheng, Li, Liu & Qi (2023), Applied Sciences 13, 7301; the closed form of each kind names its own.

    Examples
    --------
    >>> import slopekit as sk
    >>> design = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
    >>> round(sk.run(design, set={"water": "full"}).fos.limit, 3)
    1.006
    """
    from slopekit.design.reading.files import design_from

    if isinstance(source, str | os.PathLike | Mapping):
        return analyse(load(source, set, case), elastic)
    source = design_from(source, "run", "source")
    if set:
        raise DesignError(
            [
                Fault(
                    "E160",
                    "a design that is loaded takes no further values",
                    "set",
                    "Give set to load.",
                )
            ]
        )
    if case is not None:
        from slopekit.design.cases import case_named

        source = case_named(source, case).design
    return analyse(source, elastic)


# -- pictures and pages -----------------------------------------------------------------------------------------------


@overload
def plot(source: Any, what: None = None) -> dict[str, str]: ...


@overload
def plot(
    source: Any,
    what: str,
    path: str | os.PathLike[str] | None = None,
    *,
    test: str | None = None,
    step: int = 1,
) -> "Drawing": ...


def plot(
    source: Any,
    what: str | None = None,
    path: str | os.PathLike[str] | None = None,
    *,
    test: str | None = None,
    step: int = 1,
) -> "Drawing | dict[str, str]":
    """Draw a picture of a result or a study (extra: plot). Without `what` it lists the pictures that this one can give.

    Parameters
    ----------
    source : what `sk.run`, `sk.wedge`, `sk.sweep`, ... return, their `to_dict()`, or the path of their JSON or folder
    what : scene, exploded, tractions, forces, displacement, mechanism, factors, ravelling, stereonet, elevation,
        histogram, curve, contour, tornado, speed-error or reduction [nothing is drawn: the words that it can
        give]
    path : the file: .png, .svg or .pdf; scenes .png, .glb or .gltf [beside the JSON, or in this folder: NAME-WHAT.png]
    test : of the stereonet of a kinematic study; step : of mechanism

    Returns
    -------
    Drawing or dict
        The path written, which shows itself in a notebook; without `what` the pictures by their word, and what they
        show.

    Raises
    ------
    DesignError
        E106, E141, E197, E273, E313 and E340 for what cannot be drawn, E140 without the extra.

    Examples
    --------
    >>> import slopekit as sk
    >>> wedge = sk.wedge(dips=("45/115", "45/245"))
    >>> sorted(sk.plot(wedge))
    ['displacement', 'exploded', 'forces', 'mechanism', 'scene', 'stereonet', 'tractions']

    ``sk.plot(wedge, "exploded", "wedge.png")`` then draws one.
    """
    from slopekit.exchange.documents import by_case, load_document
    from slopekit.views import plots
    from slopekit.views.notebook import Drawing

    document, file = load_document(source)
    name = (
        str(document.get("study") or document.get("kind") or "result")
        if file is None
        else file.stem
    )
    if what is None:
        return plots.offers(document)
    folder = Path() if file is None else file.parent
    target = folder / f"{name}-{what}.png" if path is None else Path(path)
    if document.get("study") == "cases":
        message = "these are load cases: a picture is of one of them"
        advice = f"Give its result, .cases[{next(iter(by_case(document)))!r}]."
        raise DesignError([Fault("E313", message, what, advice)])
    plots.draw(document, what, target, test=test, step=step, name=name)
    return Drawing(target)


def report(
    results: Any,
    path: str | os.PathLike[str] = "report.html",
    *,
    pictures: bool = True,
    project: Mapping[str, str] | None = None,
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
    Path
        The path written.

    Raises
    ------
    DesignError
        E140 without the extra, E147 to E149 and E340 for what is no result, E142 for the project,
        E129 where the page cannot be written.

    Examples
    --------
    >>> import slopekit as sk, tempfile, pathlib
    >>> wedge = sk.wedge(dips=("45/115", "45/245"))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     page = sk.report(wedge, pathlib.Path(folder) / "wedge.html", pictures=False)
    ...     "<title>" in page.read_text(encoding="utf-8")
    True
    """
    from slopekit.views.pages.report import write_report

    target = Path(path)
    with writing(target):
        target = target / "report.html" if target.is_dir() else target
    several = list(results) if isinstance(results, list | tuple) else [results]
    if not several:
        raise wrong_kind("report", "results", "one result or study, or more", results)
    write_report(
        [_document(source) for source in several], target, with_pictures=pictures, project=project
    )
    return target


def _document(source: Any) -> Mapping[str, Any]:
    """Return the JSON document of a result, a study, or the path of one."""
    from slopekit.exchange.documents import load_document

    if not isinstance(source, str | os.PathLike | Mapping) and not hasattr(source, "to_dict"):
        raise wrong_kind("report", "results", "results, studies, or paths of their JSON", source)
    return load_document(source)[0]
