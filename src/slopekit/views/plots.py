"""Every picture by its word, from any JSON that slopekit has written: what a document can give, and its drawing."""

import math
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from difflib import get_close_matches
from importlib import import_module
from numbers import Real
from pathlib import Path

from slopekit.core.codec import MISREAD, is_of_document
from slopekit.core.errors import DesignError, Fault
from slopekit.exchange.documents import Document
from slopekit.views.charts.drawing import FORMATS, new_figure, plain_numbers, save
from slopekit.views.charts.kinematic_charts import TESTS
from slopekit.views.solid.scenes import SCENES

SCENE_FORMATS = (".png", ".glb", ".gltf")


@dataclass(frozen=True)
class Chart:
    """A picture that matplotlib draws, all that is known of it.

    Attributes
    ----------
    shows : what is seen; wants : which file has the data
    drawn_by : module and function of `views.charts`, of a figure and a document
    given_by : whether a document has the data
    """

    shows: str
    wants: str
    drawn_by: str
    given_by: Callable[[Document], bool]

    @property
    def draw(self) -> Callable[..., None]:
        """Draws it, of a figure, a document and options; only now is loaded what draws."""
        module, function = self.drawn_by.split(".")
        draw_chart: Callable[..., None] = getattr(import_module(f"slopekit.views.charts.{module}"), function)
        return draw_chart


def _is_kinematic(document: Document) -> bool:
    return document.get("kind") == "kinematic"


def _is_survey(document: Document) -> bool:
    return document.get("kind") in _OF_SURVEYS


def _sweeps(document: Document, keys: int) -> bool:
    swept = document.get("keys")
    return document.get("study") == "sweep" and isinstance(swept, list) and len(swept) == keys


def _has_bolts(document: Document) -> bool:
    scene = document.get("scene")
    return isinstance(scene, Mapping) and scene.get("bolts") is not None


def _oriented(document: Document) -> bool:
    from slopekit.views.charts.orientation_charts import orientations_of

    if document.get("study", "prob") != "prob" and document.get("kind") != "combos":
        return False  # other studies change their design
    try:
        return orientations_of(document) is not None
    except DesignError:
        return False
    except MISREAD as error:
        if is_of_document(error):
            return False
        raise


#: Drawn by matplotlib, by their word.
CHARTS: Mapping[str, Chart] = {
    "stereonet": Chart(
        "planes, poles, lines, cones on the lower hemisphere",
        "a file with joints: slopekit kinematic, sets, run, wedge, combos or prob with -o DIR",
        "orientation_charts.draw_orientations", lambda of: _is_survey(of) or _oriented(of),
    ),
    "elevation": Chart(
        "the face with its bolts by number",
        "result.json of a design with bolts that have a head: slopekit run design.yaml -o DIR",
        "elevation.draw_elevation", _has_bolts,
    ),
    "histogram": Chart(
        "factors of safety, the probability of failure", "prob.json: slopekit prob design.yaml -o DIR",
        "probability_charts.draw_histogram", lambda of: of.get("study") == "prob",
    ),
    "curve": Chart(
        "the factor over one number", "sweep.json of one key: slopekit sweep design.yaml KEY=a:b:n -o DIR",
        "sweep_charts.draw_curve", lambda of: _sweeps(of, 1),
    ),
    "contour": Chart(
        "the factor over two numbers", "sweep.json of two keys: slopekit sweep design.yaml KEY=a:b:n KEY=a:b:n -o DIR",
        "sweep_charts.draw_contour", lambda of: _sweeps(of, 2),
    ),
    "backbreak": Chart(
        "how much of the crest is lost along the bench, by height and face angle",
        "bench-design.json: slopekit bench-design survey.csv -o DIR", "bench_charts.draw_backbreak",
        lambda document: document.get("study") == "bench-design",
    ),
    "tornado": Chart(
        "what each number does to the factor", "tornado.json: slopekit sweep design.yaml --tornado -o DIR",
        "sweep_charts.draw_tornado", lambda of: of.get("study") == "tornado",
    ),
    "motion": Chart(
        "acceleration, velocity and displacement in the record that moves the block most",
        "quake.json: slopekit quake design.yaml RECORD... -o DIR", "quake_charts.draw_motion",
        lambda of: of.get("study") == "quake" and of.get("motion") is not None,
    ),
    "six": Chart(
        "displacement and turning in six degrees of freedom",
        "quake.json: slopekit quake design.yaml RECORD... --six -o DIR", "quake_charts.draw_six",
        lambda of: of.get("study") == "quake" and of.get("six_motion") is not None,
    ),
    "speed-error": Chart(
        "time against error of the solver", "check.json: slopekit check design.yaml -o DIR",
        "charts.draw_speed_errors", lambda of: "ladder" in of,
    ),
    "reduction": Chart(
        "failed node pairs and displacement over the strength reduction factor",
        "result.json of a design with analysis.factors, or with analysis.criterion: all-pairs, "
        "by slopekit run design.yaml -o DIR",
        "charts.draw_reduction", lambda of: bool(of.get("series") or of.get("all_pairs")),
    ),
}  # fmt: skip
#: The stereonets of studies of surveys, which have no result behind them, by kind.
_OF_SURVEYS: Mapping[str, Chart] = {
    kind: replace(CHARTS["stereonet"], drawn_by=drawn_by)
    for kind, drawn_by in (
        ("kinematic", "kinematic_charts.draw_kinematic"),
        ("sets", "set_charts.draw_sets"),
    )
}
EVERY = (*SCENES, *CHARTS)


def _chart(what: str, document: Document) -> Chart:
    return _OF_SURVEYS[document["kind"]] if what == "stereonet" and _is_survey(document) else CHARTS[what]


def offers(document: Document) -> dict[str, str]:
    """What a document can give: the words, and what each picture shows."""
    scene = document.get("scene")
    pictures = dict[str, str]()
    if isinstance(scene, Mapping):
        lacks = {"displacement"} if scene.get("displacement") is None else set()
        pictures |= {what: one.shows for what, one in SCENES.items()
                     if what not in lacks and all(document.get(key) is not None for key in one.needs)}  # fmt: skip
    return pictures | {what: one.shows for what, one in CHARTS.items() if one.given_by(document)}


def draw(document: Document, what: str, path: Path, *, test: str | None = None, step: int = 1, name: str = "") -> None:
    """Draw a picture of a document to a file.

    Parameters
    ----------
    what : one of `EVERY`
    test : one of `kinematic_charts.TESTS`, the tests of a kinematic study that are drawn
    step : the mechanism of a scene, 1 the first
    name : what the document is called, for messages

    Raises
    ------
    DesignError
        E106 an option that is no number, E140 without the extra, E197 no such picture, E273 nothing to draw,
        E340 the document is damaged, E141 not a format, E313 an option of other pictures, E129 not writable.
    """
    called = name or "the document"
    check(document, what, path, called, test, step)
    try:
        if what in SCENES:
            from slopekit.views.solid import scenes

            scenes.draw(document, what, path, step)
            return
        figure = new_figure(path)
        with plain_numbers(), warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # a letter that the font has not, no contour between two
            is_test = what == "stereonet" and _is_kinematic(document)
            _chart(what, document).draw(figure, document, *((test,) if is_test else ()))
            save(figure, path)
    except MISREAD as error:
        if not is_of_document(error):  # the fault is ours, and shall be seen
            raise
        said = f"lacks {error}" if isinstance(error, KeyError) else f"{type(error).__name__}: {error}"
        message = f"{called} cannot be drawn as {what} ({said})"
        advice = "Was it changed, or written by an older slopekit? Make it again."
        raise DesignError([Fault("E340", message, "", advice)]) from error
    except DesignError as error:  # where it stands is the document
        faults = [Fault(fault.code, fault.message, fault.where or name, fault.advice) for fault in error.faults]
        raise DesignError(faults) from error


def check(document: Document, what: str, path: Path, name: str, test: str | None = None, step: int = 1) -> None:
    """Refuse what cannot be drawn before anything is loaded: E106, E197, E273, E141, E313."""
    given = offers(document)
    can = f"{name} can give {', '.join(given)}." if given else f"{name} has nothing that can be drawn."
    if what not in EVERY:
        near = get_close_matches(what.lower(), EVERY, n=1, cutoff=0.7)
        advice = (f"Did you mean {near[0]}? " if near else "") + can
        raise DesignError([Fault("E197", f"{what} is not a picture", what, advice)])
    scene = SCENES.get(what)
    many = scene is not None and "assembly" in scene.needs and document.get("assembly") is None
    if what not in given and (many or scene is None or not isinstance(document.get("scene"), Mapping)):
        wants = CHARTS[what].wants if scene is None else "result.json: slopekit run design.yaml -o DIR"
        if many:
            wants = "result.json of many blocks: bench, blocks, topple"
        raise DesignError([Fault("E273", f"{name} has no data for {what}", "", f"{can} {what} wants {wants}")])
    formats = SCENE_FORMATS if what in SCENES else FORMATS
    if path.suffix.lower() not in formats:
        message = f"{what} cannot be written as {path.suffix or 'a file without an ending'}"
        raise DesignError([Fault("E141", message, str(path), f"Known: {', '.join(formats)}.")])
    if not isinstance(step, Real) or not (math.isfinite(step) and step == int(step)):
        raise DesignError([Fault("E106", f"--step is {step!r}, a whole number is needed", "--step")])
    alien = [
        *(["--test"] if test is not None and not (what == "stereonet" and _is_kinematic(document)) else []),
        *(["--step"] if step != 1 and what != "mechanism" else []),
    ]
    if alien:
        message = f"{alien[0]} says nothing of this {what}"
        raise DesignError([Fault("E313", message, alien[0], "--test is of kinematic stereonets, --step of mechanism.")])
    if test is not None and test not in TESTS:
        advice = f"Known: {', '.join(TESTS)}."
        raise DesignError([Fault("E313", f"{test} is not a test", f"--test {test}", advice)])
