"""The report of a result: one page of HTML that needs no network, made of the JSON. Needs the extra `report`."""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, NoReturn

from slopekit._version import __version__
from slopekit.core.codec import MISREAD, is_of_document
from slopekit.core.errors import DesignError, Fault, Notice, writing
from slopekit.core.extras import require_extra
from slopekit.core.whole_files import whole_file
from slopekit.exchange.documents import by_case, checked_document
from slopekit.kinds import words_named
from slopekit.views.pages.page_pictures import still_pictures
from slopekit.views.pages.page_tables import input_rows, section_entries, table
from slopekit.views.pages.report_words import answer
from slopekit.views.solid.viewer_data import viewer_data

_TEMPLATES = Path(__file__).parents[1] / "templates"
_NUMBER = re.compile(r"^(none|-)$|^[-+<>]? ?[\d(∞-][\d.,e+∞ ()-]*( %| kN| mm| kPa)?$")
#: Sections of a result's sheet by their label, as the page calls them; the others are called by the label itself.
_HEADINGS = {
    "FoS": "Factors of safety",
    "ACCEPT": "Acceptance",
    "FACTORED": "Partial factors",
    "FORCES": "Forces and moments",
    "MODEL": "Model and what it leaves out",
    "MOVES": "Movement",
    "MECHANISM": "Mechanisms in order",
    "TABLE": "Goodman & Bray's columns",
    "ELASTIC": "Elastic blocks",
    "METHODS": "Agreement of the methods",
    "SENSITIVITY": "What changes the factor most",
    "ALL PAIRS": "All-pairs search",
    "SERIES": "By strength reduction factor",
}
_FIRST = ("FoS", "ACCEPT", "FACTORED", "MOMENTS")  # before the picture of the slope
_OTHER_PLACES = ("STATUS", "NOTE", "NOT GIVEN")  # in the head, among the notices, behind the inputs
#: Where the whole of the verification is.
_VERIFICATION_SOURCE = "docs/verification.md of the source; slopekit check --suite makes it again"
NOT_MODELLED = (
    "Not modelled: deformation of the rock (but of elastic blocks), contact across the tension crack, suction, and the "
    "ends of joints."
)
#: What a page says of a project, and in which words.
PROJECT = {
    "name": "project",
    "client": "client",
    "number": "number",
    "author": "made by",
    "checker": "checked by",
    "revision": "revision",
    "date": "date",
}
_TITLES = {
    "sweep": "Sweep",
    "tornado": "What each number does",
    "prob": "Probability of failure",
    "solve": "Back-calculation",
    "cases": "Load cases",
    "support": "Support",
    "check": "Check of the methods",
    "combos": "Pairs of joints",
    "kinematic": "Kinematic tests",
    "bench-design": "Bench design",
    "quake": "Earthquakes",
    "sets": "Joint sets",
}


@dataclass(frozen=True)
class Report:
    """A page: its HTML, the words of its pictures, what it lacks and why, and what has to be said."""

    html: str
    pictures: tuple[str, ...]
    missing: tuple[str, ...]
    notices: tuple[Notice, ...]


def require_jinja(path: Path | str) -> None:
    """Raise E140 where no page can be made."""
    require_extra("report", "reports need", "jinja2", where=path)


def report_of(
    documents: Mapping[str, Any] | Sequence[Mapping[str, Any]],
    names: Sequence[str] = (),
    with_pictures: bool = True,
    project: Mapping[str, str] | None = None,
) -> Report:
    """The page of one document, or of several with a list of contents.

    Parameters
    ----------
    documents : JSON of results and studies; each result with a scene can be turned
    names : what they are called, for messages
    with_pictures : draw the still pictures as well; they take seconds and the extra `plot`
    project : what the head says beside what the designs say: keys of `PROJECT`

    Raises
    ------
    DesignError
        E140 without the extra, E340 no result or one that is damaged, E142 a key of the project.
    """
    document_list = [documents] if isinstance(documents, Mapping) else list(documents)
    several, document_names, short = _with_cases(document_list, names)
    require_jinja(document_names[0])
    project_head = _project(several, project or {})
    notices, missing, articles = list[Notice](), list[str](), list[dict[str, Any]]()
    views, verified = list[str](), set[str]()
    for k, (document, name) in enumerate(zip(several, document_names, strict=True), 1):
        view_notices: list[Notice] = []
        context = _article(document, name, document.get("sheet"))
        if not context["is_study"]:
            if view := _view(document, view_notices):
                views.append(view)
                context["view"] = len(views)
            if str(document["kind"]) in verified:  # the rows of a kind stand once
                context["verification"] = None
            verified.add(str(document["kind"]))
        pictures, missing_pictures = (
            still_pictures(document) if with_pictures else ([], ["all of them: left out as asked"])
        )
        context["notices"] += [(notice.code, notice.message) for notice in view_notices]
        articles.append(
            context
            | {
                "pictures": pictures,
                "missing": missing_pictures,
                "anchor": f"part-{k}",
                "name": short[k - 1],
            }
        )
        notices += view_notices
        missing += missing_pictures
    is_one = len(several) == 1
    html = _rendered(
        {
            "title": project_head.get("name")
            if not is_one and project_head.get("name")
            else articles[0]["title"],
            "project": [
                (PROJECT[key], project_head[key]) for key in PROJECT if key in project_head
            ],
            "articles": articles,
            "own_version": __version__,
            "views": [text.replace("<", "\\u003c") for text in views],
        }
    )
    seen = tuple(picture["what"] for article in articles for picture in article["pictures"])
    return Report(html, seen, tuple(missing), tuple(notices))


def _with_cases(
    documents: Sequence[Mapping[str, Any]], names: Sequence[str]
) -> tuple[list[Mapping[str, Any]], list[str], list[str]]:
    """The documents, load cases behind their table; what each is called in messages, and on the page."""
    several, document_names, case_of = list[Mapping[str, Any]](), list[str](), list[str]()
    for document, name in zip(
        documents, [*names, *[""] * (len(documents) - len(names))], strict=True
    ):
        cases = by_case(document, name=name) if document.get("study") == "cases" else {}
        several += [document, *cases.values()]
        document_names += [name, *(f"{name}, case {case}".lstrip(", ") for case in cases)]
        case_of += ["", *cases]
    short = [
        f"{k} {_short_name(document)}" + (f", {case}" if case else "")
        for k, (document, case) in enumerate(zip(several, case_of, strict=True), 1)
    ]
    return several, document_names, short


def _short_name(document: Mapping[str, Any]) -> str:
    study = str(document.get("study") or document.get("kind"))
    return _TITLES.get(study, study if "study" in document else "Result")


def _project(documents: Sequence[Mapping[str, Any]], inputs: Mapping[str, str]) -> dict[str, str]:
    """Return the project data of the head: those given, else those of the first design that has any."""
    unknown = [key for key in inputs if key not in PROJECT]
    if unknown:
        advice = f"Known: {', '.join(PROJECT)}."
        raise DesignError(
            [
                Fault("E142", f"{key} is not a key of a project", "--project", advice)
                for key in unknown
            ]
        )
    project: dict[str, str] = {}
    for document in documents:
        design_project = document.get("project")
        if isinstance(design_project, Mapping):
            project = {
                str(key): str(value) for key, value in design_project.items() if key in PROJECT
            } | project
    return project | {key: value for key, value in inputs.items() if value}


def _article(document: Mapping[str, Any], name: str, sheet: Any) -> dict[str, Any]:
    """Return the article of one document: its sheet without what stands on the page already."""
    is_result = "fos" in document and "status" in document and "study" not in document
    if not isinstance(sheet, Mapping):
        _refuse(document, name, is_result)
    try:  # only what reads the document: faults of the program itself go through
        if not is_result:
            return _study(document, sheet)
        article = _result(document, sheet)
    except MISREAD as error:
        if not is_of_document(error):
            raise
        detail = (
            f"lacks {error}" if isinstance(error, KeyError) else f"{type(error).__name__}: {error}"
        )
        noun = "result" if is_result else "study"
        message = f"the {noun} cannot be read as one ({detail})"
        advice = "Was it changed, or written by another version? Make it again: slopekit run DESIGN -o DIR."
        raise DesignError([Fault("E340", message, name, advice)]) from error
    return article | {"verification": _verification(str(document["kind"]))}


def _refuse(document: Mapping[str, Any], name: str, is_result: bool) -> NoReturn:
    """E340 of a document without a sheet: written by another version, or none that has one."""
    noun = (
        "a result"
        if is_result
        else f"a study ({document['study']})"
        if document.get("study")
        else ""
    )
    message = "this is another document of slopekit, report takes results and studies"
    if noun:
        message = f"this is {noun} without its sheet: another version wrote it"
    advice = "Make it again with -o DIR; give DIR/result.json of run or wedge, or the JSON of a study: sweep.json, ..."
    raise DesignError([Fault("E340", message, name, advice)])


def _view(document: Mapping[str, Any], notices: list[Notice]) -> str:
    """The data of the view to turn."""
    try:
        return json.dumps(viewer_data(document), separators=(",", ":"), allow_nan=False)
    except DesignError as error:
        reason = error.faults[0].message
        notices.append(
            Notice("W372", f"there is no view to turn, the scene cannot be read: {reason}")
        )
        return ""


def _study(document: Mapping[str, Any], sheet: Mapping[str, Any]) -> dict[str, Any]:
    """Return the content of a study's article: its line, then its sheet."""
    for key in ("slopekit", "study", "line"):
        if not isinstance(document[key], str):
            raise TypeError(f"{key} is no text")
    name = document["study"]
    survey, kind = document.get("survey"), str(document.get("kind") or "")
    survey_name = str(survey["name"]) if isinstance(survey, Mapping) and survey.get("name") else ""
    kind = "" if kind == name else kind  # a survey has none
    return _common_content(document, sheet) | {
        "is_study": True,
        "title": document.get("title") or survey_name or _TITLES.get(name, name),
        "kind": " · ".join(text for text in (_TITLES.get(name, name), kind) if text),
        "lines": [
            text.replace("  ", " · ") for text in document["line"].split("\n")
        ],  # blanks are one in HTML
    }


def _common_content(document: Mapping[str, Any], sheet: Mapping[str, Any]) -> dict[str, Any]:
    """Return the content that results and studies share: sheet by sections, notices, source."""
    sections = {label: list(section_entries(entries)) for label, entries in sheet.items()}
    return {
        "version": document["slopekit"],
        "sha": str(document.get("input_sha256") or ""),
        "view": 0,
        "sections": [
            (label, _heading(label), entries)
            for label, entries in sections.items()
            if entries and label != "NOTE"
        ],
        "notices": [
            (str(notice["code"]), str(notice["message"])) for notice in document["warnings"]
        ],
    }


def _heading(label: str) -> str:
    """The heading of a section of a sheet: RANDOM VARIABLES is a name in capitals, P(FoS < 1) is not."""
    is_name = label.isupper() and "(" not in label and "-" not in label
    return _HEADINGS.get(label, label.capitalize() if is_name else label)


def _result(document: Mapping[str, Any], sheet: Mapping[str, Any]) -> dict[str, Any]:
    """Return the content of a result's article: its answer, its sheet, its inputs."""
    for key in ("title", "slopekit", "input_sha256"):
        if not isinstance(document[key], str):
            raise TypeError(f"{key} is no text")
    inputs = document["inputs"]
    words = words_named(str(document["kind"]), inputs)
    has_closed_form = words.rests_on and document["fos"]["closed_form"] is not None
    basis = f"The closed form rests on {words.rests_on}." if has_closed_form else ""
    common = _common_content(document, sheet)
    sections = [section for section in common["sections"] if section[0] not in _OTHER_PLACES]
    return common | {
        "is_study": False,
        "title": document["title"] or words.title,
        "kind": words.title,
        "answer": answer(document, sheet.get("STATUS", [])),
        "basis": basis,
        "first": [section for section in sections if section[0] in _FIRST],
        "sections": [section for section in sections if section[0] not in _FIRST],
        "inputs": table(("", "value"), input_rows(inputs), text_columns=2),
        "not_modelled": NOT_MODELLED,
        "defaults": sheet.get("NOT GIVEN") or [str(section) for section in document["defaults"]],
        "has_bolts": isinstance(document.get("scene"), Mapping)
        and document["scene"].get("bolts") is not None,
    }


def _verification(kind: str) -> dict[str, Any]:
    """The rows of the shipped excerpt that stand for a kind; a bench is solved as blocks are."""
    excerpt = verification_excerpt()
    like = "blocks" if kind == "bench" else kind
    rows = []
    for row in excerpt["rows"]:
        if row["kind"] == like:
            verdict = {True: "within", False: "OUTSIDE", None: "not judged"}[row["ok"]]
            published = "" if row["published"] is None else str(row["published"])
            exact, value = (
                ("" if number is None else f"{number:.6g}")
                for number in (row["exact"], row["value"])
            )
            quantity = row["quantity"].replace("_", " ")
            rows.append((row["title"], quantity, published, exact, value, row["source"], verdict))
    head = ("case", "quantity", "published", "exact or other code", "slopekit", "source", "")
    sources = [
        (key, excerpt["sources"][key])
        for key in excerpt["sources"]
        if any(row["source"] == key and row["kind"] == like for row in excerpt["rows"])
    ]
    return {
        "version": excerpt["slopekit"],
        "counts": excerpt["counts"],
        "whole": _VERIFICATION_SOURCE,
        "sources": sources,
        "bench": kind == "bench",
        "table": table(head, rows, "Why a row is not judged stands in the whole.", text_columns=2),
    }


def verification_excerpt() -> dict[str, Any]:
    """The excerpt of docs/verification.json that came with this slopekit."""
    excerpt: dict[str, Any] = json.loads(
        Path(__file__).parents[1].joinpath("verification_excerpt.json").read_text(encoding="utf-8")
    )
    return excerpt


def _rendered(context: Mapping[str, Any]) -> str:
    from markupsafe import Markup

    assets = {
        name: Markup((_TEMPLATES / name).read_text(encoding="utf-8"))
        for name in ("report.css", "viewer.js", "report.js")
    }
    views = [Markup(text) for text in context["views"]]  # JSON without any <: it can end no script
    return str(
        _template().render(
            **{**context, "views": views},
            style=assets["report.css"],
            script=assets["viewer.js"] + assets["report.js"],
        )
    )


@cache
def _template() -> Any:
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(_TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.tests["figure"] = lambda text: bool(_NUMBER.match(str(text)))
    return environment.get_template("report.html.j2")


def write_report(
    documents: Sequence[Mapping[str, Any]],
    path: Path,
    names: Sequence[str] = (),
    with_pictures: bool = True,
    project: Mapping[str, str] | None = None,
) -> Report:
    """Make the page of documents and write it.

    Raises
    ------
    DesignError
        As `report_of`; E340 where one is none of slopekit's, E129 where the file cannot be written.
    """
    document_names = list(names) or ["the document"] * len(documents)
    checked = [
        checked_document(document, name)
        for document, name in zip(documents, document_names, strict=True)
    ]
    report = report_of(checked, list(names) or [str(path)], with_pictures, project)
    with writing(path), whole_file(path) as page:
        page.write_text(report.html, encoding="utf-8")
    return report
