"""Every picture by its word, from any JSON that slopekit has written: what a document can give, and its drawing."""

import math
import warnings
from collections.abc import Mapping
from importlib import import_module
from numbers import Real
from pathlib import Path
from typing import NamedTuple

from slopekit.core.codec import MISREAD, is_of_document
from slopekit.core.errors import DesignError, Fault, did_you_mean
from slopekit.exchange.documents import Document
from slopekit.views.charts.drawing import FORMATS, new_figure, save
from slopekit.views.charts.survey_charts import TESTS
from slopekit.views.solid.scenes import SCENES

SCENE_FORMATS = (".png", ".glb", ".gltf")
_RESULT = "result.json: slopekit run design.yaml -o DIR"


class Offer(NamedTuple):
    """A picture: what is seen, which file has the data, and of a chart the module and function of `views.charts`."""

    shows: str
    wants: str
    drawn_by: str = ""


OFFERS: Mapping[str, Offer] = {
    "scene": Offer("the slope with its blocks and joints", _RESULT),
    "exploded": Offer("the blocks apart, their joints coloured", _RESULT),
    "tractions": Offer(
        "node pairs by contact mode, and the tractions that they carry at the limit", _RESULT
    ),
    "forces": Offer("the loads, and the resultants on the joints, to scale", _RESULT),
    "displacement": Offer("the displacement at full strength, magnified", _RESULT),
    "mechanism": Offer("how the blocks move as they fail", _RESULT),
    "factors": Offer(
        "blocks coloured by the factor of safety at which they fail",
        "result.json of many blocks: bench, blocks, topple",
    ),
    "stereonet": Offer(
        "planes, poles, lines, cones on the lower hemisphere",
        "a file with joints: slopekit kinematic, sets, run, wedge, combos or prob with -o DIR",
        "orientation_charts.draw_orientations",
    ),
    "elevation": Offer(
        "the face with its bolts by number",
        "result.json of a design with bolts that have a head: slopekit run design.yaml -o DIR",
        "elevation.draw_elevation",
    ),
    "histogram": Offer(
        "factors of safety, the probability of failure",
        "prob.json: slopekit prob design.yaml -o DIR",
        "charts.draw_histogram",
    ),
    "curve": Offer(
        "the factor over one number",
        "sweep.json of one key: slopekit sweep design.yaml KEY=a:b:n -o DIR",
        "sweep_charts.draw_curve",
    ),
    "contour": Offer(
        "the factor over two numbers",
        "sweep.json of two keys: slopekit sweep design.yaml KEY=a:b:n KEY=a:b:n -o DIR",
        "sweep_charts.draw_contour",
    ),
    "backbreak": Offer(
        "how much of the crest is lost along the bench, by height and face angle",
        "bench-design.json: slopekit bench-design survey.csv -o DIR",
        "charts.draw_backbreak",
    ),
    "tornado": Offer(
        "what each number does to the factor",
        "tornado.json: slopekit sweep design.yaml --tornado -o DIR",
        "sweep_charts.draw_tornado",
    ),
    "motion": Offer(
        "acceleration, velocity and displacement in the record that moves the block most",
        "quake.json: slopekit quake design.yaml RECORD... -o DIR",
        "charts.draw_motion",
    ),
    "speed-error": Offer(
        "time against error of the solver",
        "check.json: slopekit check design.yaml -o DIR",
        "charts.draw_speed_errors",
    ),
    "reduction": Offer(
        "failed node pairs and displacement over the strength reduction factor",
        "result.json of a design with analysis.factors, or with analysis.criterion: all-pairs, "
        "by slopekit run design.yaml -o DIR",
        "charts.draw_reduction",
    ),
}
EVERY = tuple(OFFERS)
#: Who draws the stereonet of a study of a survey, which has no result behind it, by kind.
_OF_SURVEYS = {"kinematic": "survey_charts.draw_kinematic", "sets": "survey_charts.draw_sets"}


def offers(document: Document) -> dict[str, str]:
    """Return the pictures that a document can give: name and what each shows."""
    is_of_scene = isinstance(document.get("scene"), Mapping)
    scene = document["scene"] if is_of_scene else {}
    study, keys = document.get("study"), document.get("keys")
    swept = len(keys) if study == "sweep" and isinstance(keys, list) else 0
    is_available = {
        **dict.fromkeys(("scene", "exploded", "tractions", "forces"), is_of_scene),
        "displacement": scene.get("displacement") is not None,
        "mechanism": is_of_scene and document.get("mechanism") is not None,
        "factors": is_of_scene and document.get("assembly") is not None,
        "stereonet": document.get("kind") in _OF_SURVEYS or _is_oriented(document),
        "elevation": scene.get("bolts") is not None,
        "histogram": study == "prob",
        "curve": swept == 1,
        "contour": swept == 2,
        "backbreak": study == "bench-design",
        "tornado": study == "tornado",
        "motion": study == "quake" and document.get("motion") is not None,
        "speed-error": "ladder" in document,
        "reduction": bool(document.get("series") or document.get("all_pairs")),
    }
    return {picture: offer.shows for picture, offer in OFFERS.items() if is_available[picture]}


def _is_oriented(document: Document) -> bool:
    from slopekit.views.charts.orientation_charts import orientations_of

    if document.get("study", "prob") != "prob" and document.get("kind") != "combos":
        return False  # other studies change their design
    try:
        return bool(orientations_of(document).joints)
    except DesignError:
        return False
    except MISREAD as error:
        if is_of_document(error):
            return False
        raise


def draw(
    document: Document,
    picture: str,
    path: Path,
    *,
    test: str | None = None,
    step: int = 1,
    name: str = "",
) -> None:
    """Draw a picture of a document to a file.

    Parameters
    ----------
    picture : one of `EVERY`
    test : one of `survey_charts.TESTS`, the tests of a kinematic study that are drawn
    step : the mechanism of a scene, 1 the first
    name : what the document is called, for messages

    Raises
    ------
    DesignError
        E106 an option that is no number, E140 without the extra, E197 no such picture, E273 nothing to draw,
        E340 the document is damaged, E141 not a format, E313 an option of other pictures, E129 not writable.
    """
    document_name = name or "the document"
    check(document, picture, path, document_name, test, step)
    try:
        if picture in SCENES:
            from slopekit.views.solid import scenes

            scenes.draw(document, picture, path, step)
            return
        with new_figure(path) as figure, warnings.catch_warnings():
            warnings.simplefilter(
                "ignore", UserWarning
            )  # a letter that the font has not, no contour between two
            drawn_by = OFFERS[picture].drawn_by
            if picture == "stereonet":
                drawn_by = _OF_SURVEYS.get(str(document.get("kind")), drawn_by)
            module, function = drawn_by.split(".")
            chart = getattr(import_module(f"slopekit.views.charts.{module}"), function)
            chart(figure, document, **{} if test is None else {"test": test})
            save(figure, path)
    except MISREAD as error:
        if not is_of_document(error):  # the fault is ours, and shall be seen
            raise
        detail = (
            f"lacks {error}" if isinstance(error, KeyError) else f"{type(error).__name__}: {error}"
        )
        message = f"{document_name} cannot be drawn as {picture} ({detail})"
        advice = "Was it changed, or written by an older slopekit? Make it again."
        raise DesignError([Fault("E340", message, "", advice)]) from error
    except DesignError as error:  # where it stands is the document
        faults = [
            Fault(fault.code, fault.message, fault.where or name, fault.advice)
            for fault in error.faults
        ]
        raise DesignError(faults) from error


def check(
    document: Document, picture: str, path: Path, name: str, test: str | None = None, step: int = 1
) -> None:
    """Refuse what cannot be drawn before anything is loaded: E106, E197, E273, E141, E313."""
    available = offers(document)
    available_text = (
        f"{name} can give {', '.join(available)}."
        if available
        else f"{name} has nothing that can be drawn."
    )
    if picture not in EVERY:
        advice = f"{did_you_mean(picture, EVERY, cutoff=0.7)} {available_text}".lstrip()
        raise DesignError([Fault("E197", f"{picture} is not a picture", picture, advice)])
    is_scene = (
        picture in SCENES and picture != "factors" and "scene" in available
    )  # it says itself why it lacks what it draws
    if picture not in available and not is_scene:
        message = f"{name} has no data for {picture}"
        raise DesignError(
            [
                Fault(
                    "E273", message, "", f"{available_text} {picture} wants {OFFERS[picture].wants}"
                )
            ]
        )
    formats = SCENE_FORMATS if picture in SCENES else FORMATS
    if path.suffix.lower() not in formats:
        message = f"{picture} cannot be written as {path.suffix or 'a file without an ending'}"
        raise DesignError([Fault("E141", message, str(path), f"Known: {', '.join(formats)}.")])
    if not isinstance(step, Real) or not (math.isfinite(step) and step == int(step)):
        raise DesignError(
            [Fault("E106", f"--step is {step!r}, a whole number is needed", "--step")]
        )
    takes_test = picture == "stereonet" and document.get("kind") == "kinematic"
    if test is not None and not takes_test:
        raise _foreign_option("--test", picture)
    if step != 1 and picture != "mechanism":
        raise _foreign_option("--step", picture)
    if test is not None and test not in TESTS:
        advice = f"Known: {', '.join(TESTS)}."
        raise DesignError([Fault("E313", f"{test} is not a test", f"--test {test}", advice)])


def _foreign_option(option: str, picture: str) -> DesignError:
    advice = "--test is of kinematic stereonets, --step of mechanism."
    return DesignError([Fault("E313", f"{option} says nothing of this {picture}", option, advice)])
