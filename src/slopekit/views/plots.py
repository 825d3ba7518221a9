"""Every picture by its word, from any JSON that slopekit has written: what a document can give, and its drawing."""

import math
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from importlib import import_module
from numbers import Real
from pathlib import Path

from slopekit.core.codec import MISREAD, is_of_document
from slopekit.core.errors import DesignError, Fault, did_you_mean
from slopekit.exchange.documents import Document
from slopekit.views.charts.drawing import FORMATS, new_figure, plain_numbers, save
from slopekit.views.charts.kinematic_charts import TESTS
from slopekit.views.solid.scenes import SCENES

SCENE_FORMATS = (".png", ".glb", ".gltf")


@dataclass(frozen=True)
class Offer:
    """A picture, all that is known of it.

    Attributes
    ----------
    shows : what is seen; wants : which file has the data
    given_by : whether a document has the data
    drawn_by : of a chart the module and function of `views.charts`, of a figure and a document
    """

    shows: str
    wants: str
    given_by: Callable[[Document], bool]
    drawn_by: str = ""

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


def _shakes(motion: str, document: Document) -> bool:
    return document.get("study") == "quake" and document.get(motion) is not None


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


def _has_scene(document: Document) -> bool:
    return isinstance(document.get("scene"), Mapping)


def _has_in_scene(key: str, document: Document) -> bool:
    return _has_scene(document) and document["scene"].get(key) is not None


def _has_mechanism(document: Document) -> bool:
    return _has_scene(document) and document.get("mechanism") is not None


def _is_of_many(document: Document) -> bool:
    return _has_scene(document) and document.get("assembly") is not None


_RESULT = "result.json: slopekit run design.yaml -o DIR"
_OF_MANY = "result.json of many blocks: bench, blocks, topple"
#: Scenes of a result, by their word.
_SCENES: Mapping[str, Offer] = {
    "scene": Offer("the slope with its blocks and joints", _RESULT, _has_scene),
    "exploded": Offer("the blocks apart, their joints coloured", _RESULT, _has_scene),
    "tractions": Offer("node pairs by contact mode, and the tractions that they carry at the limit", _RESULT,
                       _has_scene),
    "forces": Offer("the loads, and the resultants on the joints, to scale", _RESULT, _has_scene),
    "displacement": Offer("the displacement at full strength, magnified", _RESULT,
                          partial(_has_in_scene, "displacement")),
    "mechanism": Offer("how the blocks move as they fail", _RESULT, _has_mechanism),
    "factors": Offer("blocks coloured by the factor of safety at which they fail", _OF_MANY, _is_of_many),
}  # fmt: skip
#: Drawn by matplotlib, by their word.
CHARTS: Mapping[str, Offer] = {
    "stereonet": Offer(
        "planes, poles, lines, cones on the lower hemisphere",
        "a file with joints: slopekit kinematic, sets, run, wedge, combos or prob with -o DIR",
        lambda of: _is_survey(of) or _oriented(of), "orientation_charts.draw_orientations",
    ),
    "elevation": Offer(
        "the face with its bolts by number",
        "result.json of a design with bolts that have a head: slopekit run design.yaml -o DIR",
        partial(_has_in_scene, "bolts"), "elevation.draw_elevation",
    ),
    "histogram": Offer(
        "factors of safety, the probability of failure", "prob.json: slopekit prob design.yaml -o DIR",
        lambda of: of.get("study") == "prob", "probability_charts.draw_histogram",
    ),
    "curve": Offer(
        "the factor over one number", "sweep.json of one key: slopekit sweep design.yaml KEY=a:b:n -o DIR",
        lambda of: _sweeps(of, 1), "sweep_charts.draw_curve",
    ),
    "contour": Offer(
        "the factor over two numbers", "sweep.json of two keys: slopekit sweep design.yaml KEY=a:b:n KEY=a:b:n -o DIR",
        lambda of: _sweeps(of, 2), "sweep_charts.draw_contour",
    ),
    "backbreak": Offer(
        "how much of the crest is lost along the bench, by height and face angle",
        "bench-design.json: slopekit bench-design survey.csv -o DIR",
        lambda of: of.get("study") == "bench-design",
        "bench_charts.draw_backbreak",
    ),
    "tornado": Offer(
        "what each number does to the factor", "tornado.json: slopekit sweep design.yaml --tornado -o DIR",
        lambda of: of.get("study") == "tornado", "sweep_charts.draw_tornado",
    ),
    "motion": Offer(
        "acceleration, velocity and displacement in the record that moves the block most",
        "quake.json: slopekit quake design.yaml RECORD... -o DIR", partial(_shakes, "motion"),
        "quake_charts.draw_motion",
    ),
    "speed-error": Offer(
        "time against error of the solver", "check.json: slopekit check design.yaml -o DIR",
        lambda of: "ladder" in of, "charts.draw_speed_errors",
    ),
    "reduction": Offer(
        "failed node pairs and displacement over the strength reduction factor",
        "result.json of a design with analysis.factors, or with analysis.criterion: all-pairs, "
        "by slopekit run design.yaml -o DIR",
        lambda of: bool(of.get("series") or of.get("all_pairs")), "charts.draw_reduction",
    ),
}  # fmt: skip
#: The stereonets of studies of surveys, which have no result behind them, by kind.
_OF_SURVEYS: Mapping[str, Offer] = {
    kind: replace(CHARTS["stereonet"], drawn_by=drawn_by)
    for kind, drawn_by in (
        ("kinematic", "kinematic_charts.draw_kinematic"),
        ("sets", "set_charts.draw_sets"),
    )
}
_OFFERS = {**_SCENES, **CHARTS}
EVERY = tuple(_OFFERS)


def offers(document: Document) -> dict[str, str]:
    """What a document can give: the words, and what each picture shows."""
    return {what: one.shows for what, one in _OFFERS.items() if one.given_by(document)}


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
            of_survey = what == "stereonet" and _is_survey(document)
            chart = _OF_SURVEYS[document["kind"]] if of_survey else CHARTS[what]
            chart.draw(figure, document, *((test,) if is_test else ()))
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
        advice = f"{did_you_mean(what, EVERY, cutoff=0.7)} {can}".lstrip()
        raise DesignError([Fault("E197", f"{what} is not a picture", what, advice)])
    wants = _OFFERS[what].wants
    # a scene itself says why it lacks what it draws
    is_scene = what in SCENES and _has_scene(document) and (wants != _OF_MANY or _is_of_many(document))
    if what not in given and not is_scene:
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
