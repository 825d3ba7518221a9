"""The report of a result: one page of HTML that needs no network, made of the JSON. Needs the extra `report`."""

import base64
import json
import re
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NoReturn

from slopekit._version import __version__
from slopekit.core.errors import DesignError, Fault, Notice, writing
from slopekit.kinds import words_named
from slopekit.views import report_tables as tables
from slopekit.views.plots import checked_document
from slopekit.views.report_inputs import Table, input_tables, value_text, words
from slopekit.views.report_tables import parts
from slopekit.views.report_words import answer, force_notes, meaning
from slopekit.views.viewer_data import viewer_data

_TEMPLATES = Path(__file__).parent / "templates"
_DAMAGED = (KeyError, IndexError, TypeError, ValueError, AttributeError, ArithmeticError)
_NUMBER = re.compile(r"^(none|-)$|^[-+<>]? ?[\d(∞-][\d.,e+∞ ()-]*( %| kN| mm| kPa)?$")
#: Sections of the sheet by the part of the page that has them, in its order. What says the slope differs by kind.
_SECTIONS = {
    "factors": ("FoS",), "rules": ("ACCEPT",), "bolts": ("BOLTS",), "forces": ("FORCES",),
    "moments": ("ROTATION", "MOVES"), "assembly": ("NEXT", "BY BLOCK", "TABLE"), "checks": ("CHECKS",),
    "searches": ("STRENGTH", "COHESION", "ALL PAIRS", "SERIES", "COLUMNS", "METHODS", "GOVERNS"),
}  # fmt: skip
_SLOPE = ("PLANES", "SURFACE", "SETS", "COLUMNS", "BLOCKS", "SIZE", "LOADS")
#: The tables of a section by its label, as the page calls them one after the other.
_CAPTIONS = {
    "FoS": ("Factors of safety",), "BOLTS": ("Schedule",), "FORCES": ("On the joints", "As a whole"),
    "MOVES": ("What governs",), "NEXT": ("Mechanisms in order",), "BY BLOCK": ("Factor by block",),
    "TABLE": ("Goodman & Bray's columns",),
    "ALL PAIRS": ("All-pairs search",), "SERIES": ("By strength reduction factor",), "COLUMNS": ("Methods of columns",),
    "METHODS": ("Methods of columns",), "GOVERNS": ("What changes the factor most",),
}  # fmt: skip
#: Where the whole of the verification is.
_WHOLE = "docs/verification.md of the source; slopekit check --suite makes it again"
NOT_MODELLED = (
    "Not modelled: deformation of the rock, contact across the tension crack, suction, and the ends of joints."
)
#: Pictures of a result in the order of the page, those of blocks for many blocks only.
_OF_RESULT = ("scene", "elevation", "stereonet", "tractions", "mechanism", "factors", "ravelling", "reduction")
_SCENES = ("scene", "exploded", "tractions", "forces", "displacement", "mechanism", "factors", "ravelling")
_TYPES = {".png": "image/png", ".svg": "image/svg+xml"}
_LARGEST_SVG = 250_000  # bytes; beyond that a PNG is smaller and as legible


#: What a page says of a project, and in which words.
PROJECT = {
    "name": "project", "client": "client", "number": "number", "author": "made by", "checker": "checked by",
    "revision": "revision", "date": "date",
}  # fmt: skip
_TITLES = {
    "sweep": "Sweep", "tornado": "What each number does", "prob": "Probability of failure", "solve": "Back-calculation",
    "support": "Support", "check": "Check of the methods", "combos": "Pairs of joints", "kinematic": "Kinematic tests",
    "bench-design": "Bench design",
    "sets": "Joint sets",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Report:
    """A page: its HTML, the words of its pictures, what it lacks and why, and what has to be said."""

    html: str
    pictures: tuple[str, ...]
    missing: tuple[str, ...]
    notices: tuple[Notice, ...]


def require_jinja(where: Path | str) -> None:
    """Raise E140 where no page can be made."""
    if find_spec("jinja2") is None:
        advice = "In slopekit's folder: pip install '.[report]'"
        raise DesignError([Fault("E140", "reports need the extra report (jinja2)", str(where), advice)])


def report_of(
    documents: Mapping[str, Any] | Sequence[Mapping[str, Any]], names: Sequence[str] = (), with_pictures: bool = True,
    project: Mapping[str, str] | None = None,
) -> Report:  # fmt: skip
    """The page of one document, or of several with a list of contents.

    Parameters
    ----------
    documents : JSON of results and studies; the view to turn is that of the first result
    names : what they are called, for messages
    with_pictures : draw the still pictures as well; they take seconds and the extra `plot`
    project : what the head says beside what the designs say: keys of `PROJECT`

    Raises
    ------
    DesignError
        E140 without the extra, E371 neither result nor study, E372 one that is damaged, E376 a key of the project.
    """
    several = [documents] if isinstance(documents, Mapping) else list(documents)
    called = [*names, *[""] * (len(several) - len(names))]
    require_jinja(called[0])
    said = _project(several, project or {})
    notices, missing, articles, data = list[Notice](), list[str](), list[dict[str, Any]](), ""
    for k, (document, name) in enumerate(zip(several, called, strict=True), 1):
        own: list[Notice] = []
        context = _article(document, name)
        if "fos" in document and "status" in document and not data:
            data = _view(document, own)
            context["with_view"] = bool(data)
        found, left = still_pictures(document) if with_pictures else ([], ["all of them: left out as asked"])
        context["notices"] += [(one.code, one.message) for one in own]
        articles.append(context | {"pictures": found, "missing": left, "anchor": f"part-{k}"})
        notices += own
        missing += left
    html = _rendered({
        "title": said.get("name") if len(several) > 1 and said.get("name") else articles[0]["title"],
        "project": [(PROJECT[key], said[key]) for key in PROJECT if key in said],
        "articles": articles, "own_version": __version__, "view_data": data.replace("<", "\\u003c"),
    })  # fmt: skip
    drawn = tuple(picture.what for article in articles for picture in article["pictures"])
    return Report(html, drawn, tuple(missing), tuple(notices))


def _project(documents: Sequence[Mapping[str, Any]], given: Mapping[str, str]) -> dict[str, str]:
    """What the head says: what was given, else what the first design says that says anything."""
    unknown = [key for key in given if key not in PROJECT]
    if unknown:
        advice = f"Known: {', '.join(PROJECT)}."
        raise DesignError([Fault("E376", f"{key} is not a key of a project", "--project", advice) for key in unknown])
    found: dict[str, str] = {}
    for document in documents:
        own = document.get("project")
        if isinstance(own, Mapping):
            found = {str(key): str(value) for key, value in own.items() if key in PROJECT} | found
    return found | {key: value for key, value in given.items() if value}


def _article(document: Mapping[str, Any], name: str) -> dict[str, Any]:
    """What the page says of one document."""
    is_result = "fos" in document and "status" in document and "study" not in document
    sheet = document.get("sheet")
    if not isinstance(sheet, Mapping):
        _refuse(document, name, is_result)
    try:  # only what reads the document: faults of the program itself go through
        if not is_result:
            return _study(document, sheet)
        found = _read(document, sheet)
    except _DAMAGED as error:
        said = f"lacks {error}" if isinstance(error, KeyError) else f"{type(error).__name__}: {error}"
        what = "result" if is_result else "study"
        message = f"the {what} cannot be read as one ({said})"
        advice = "Was it changed, or written by another version? Make it again: slopekit run DESIGN -o DIR."
        raise DesignError([Fault("E372", message, name, advice)]) from error
    return found | {"verification": _verification(str(document["kind"]))}


def _refuse(document: Mapping[str, Any], name: str, is_result: bool) -> NoReturn:
    study = document.get("study")
    if isinstance(study, str):
        message = f"this is a study ({study}) without its sheet: another version wrote it"
        advice = f"Make it again: slopekit {study} ... -o DIR, then give DIR/{study}.json."
    elif is_result:
        message = "this is a result without its sheet: another version wrote it"
        advice = "Make it again: slopekit run DESIGN -o DIR, then give DIR/result.json."
    else:
        message = "this is another document of slopekit, report takes results and studies"
        advice = "Give result.json of run or wedge, or the JSON of a study: sweep.json, prob.json, ..."
    raise DesignError([Fault("E371", message, name, advice)])


def _view(document: Mapping[str, Any], notices: list[Notice]) -> str:
    """The data of the view to turn."""
    try:
        return json.dumps(viewer_data(document), separators=(",", ":"), allow_nan=False)
    except DesignError as error:
        why = error.faults[0].message
        notices.append(Notice("W372", f"there is no view to turn, the scene cannot be read: {why}"))
        return ""


def _study(document: Mapping[str, Any], sheet: Mapping[str, Any]) -> dict[str, Any]:
    """What the page says of a study: its line, then its sheet as it stands in the JSON."""
    for key in ("slopekit", "study", "line"):
        if not isinstance(document[key], str):
            raise TypeError(f"{key} is no text")
    name = document["study"]
    title = document.get("title") or _TITLES.get(name, name)
    kind = str(document.get("kind") or "")
    sections = [(label, list(parts(entries))) for label, entries in sheet.items() if label != "NOTE"]
    return {
        "is_study": True, "title": title, "kind": " · ".join(one for one in (_TITLES.get(name, name), kind) if one),
        "version": document["slopekit"], "sha": str(document.get("input_sha256") or ""),
        "line": document["line"].replace("  ", " · "),  # blanks that set its parts off are one in HTML
        "sections": sections, "notices": [(one["code"], one["message"]) for one in document["warnings"]],
        "with_view": False,
    }  # fmt: skip


def _read(document: Mapping[str, Any], sheet: Mapping[str, Any]) -> dict[str, Any]:
    """What the page says of a document."""
    for key in ("title", "slopekit", "input_sha256"):
        if not isinstance(document[key], str):
            raise TypeError(f"{key} is no text")
    title, inputs = words_named(str(document["kind"])).title, document["inputs"]
    has_methods = bool(document["methods"])  # the methods of columns, not the columns of a topple, are called so
    sections = {
        part: [(label, list(parts(_entries(sheet, label), _CAPTIONS.get(label, ())))) for label in labels
               if _entries(sheet, label) and (label != "COLUMNS" or has_methods)]
        for part, labels in _SECTIONS.items()
    }  # fmt: skip
    return sections | {
        "title": document["title"] or title, "kind": title, "version": document["slopekit"],
        "is_study": False, "sha": document["input_sha256"], "with_view": False,
        "answer": answer(document, _entries(sheet, "STATUS")), "meaning": meaning(document),
        "rests_on": words_named(str(document["kind"])).rests_on if document["fos"]["closed_form"] is not None else "",
        "notices": [(one["code"], one["message"]) for one in document["warnings"]],
        "slope": [(label.lower(), _entries(sheet, label)) for label in _SLOPE if _entries(sheet, label)
                  and (label != "COLUMNS" or not has_methods)],
        "inputs": list(input_tables(inputs, "BOLTS" in sheet)), "force_notes": force_notes(document),
        "has_bolts": isinstance(document.get("scene"), Mapping) and document["scene"].get("bolts") is not None,
        "movement": [one for one in (tables.motion_table(document),) if one is not None],
        "later": list(tables.later_mechanisms(document)), "evidence": list(tables.check_tables(document)),
        "left_out": [str(one) for one in document["model"]["left_out"]], "not_modelled": NOT_MODELLED,
        "defaults": _entries(sheet, "DEFAULTS") or [str(one) for one in document["defaults"]],
        "assumed": [(key, value_text("", value)) for key, value in document["assumed"].items()],
        "times": tables.time_table(document),
    }  # fmt: skip


def _entries(sheet: Mapping[str, Any], label: str) -> list[Any]:
    found = sheet.get(label, [])
    if not isinstance(found, list) or not all(isinstance(entry, str | Mapping) for entry in found):
        raise TypeError(f"sheet.{label} is no list of texts and tables")
    return found


def _verification(kind: str) -> dict[str, Any]:
    """The rows of the shipped excerpt that stand for a kind; a bench is solved as blocks are."""
    found = verification_excerpt()
    like = "blocks" if kind == "bench" else kind
    rows = []
    for row in found["rows"]:
        if row["kind"] == like:
            judged = {True: "within", False: "OUTSIDE", None: "not judged"}[row["ok"]]
            shown = ["" if row[key] is None else str(row[key]) for key in ("published",)]
            exact, value = (("" if one is None else f"{one:.6g}") for one in (row["exact"], row["value"]))
            rows.append((row["title"], words(row["quantity"]), *shown, exact, value, row["source"], judged))
    head = ("case", "quantity", "published", "exact or other code", "slopekit", "source", "")
    sources = [(key, found["sources"][key]) for key in found["sources"]
               if any(row["source"] == key and row["kind"] == like for row in found["rows"])]  # fmt: skip
    return {
        "version": found["slopekit"], "counts": found["counts"], "whole": _WHOLE, "sources": sources,
        "bench": kind == "bench",
        "table": Table("", head, tuple(rows), "Why a row is not judged stands in the whole.", left=2),
    }  # fmt: skip


def verification_excerpt() -> dict[str, Any]:
    """The excerpt of docs/verification.json that came with this slopekit."""
    found: dict[str, Any] = json.loads(
        Path(__file__).with_name("verification_excerpt.json").read_text(encoding="utf-8")
    )
    return found


def _rendered(context: Mapping[str, Any]) -> str:
    from markupsafe import Markup

    own = {name: Markup((_TEMPLATES / name).read_text(encoding="utf-8")) for name in ("report.css", "viewer.js")}
    data = Markup(context["view_data"])  # JSON without any <: it can end no script
    return str(_template().render(**{**context, "view_data": data}, style=own["report.css"], script=own["viewer.js"]))


@cache
def _template() -> Any:
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(_TEMPLATES), autoescape=True, undefined=StrictUndefined, trim_blocks=True,
        lstrip_blocks=True,
    )  # fmt: skip
    environment.tests["figure"] = lambda text: bool(_NUMBER.match(str(text)))
    return environment.get_template("report.html.j2")


def write_report(
    documents: Sequence[Mapping[str, Any]], path: Path, names: Sequence[str] = (), with_pictures: bool = True,
    project: Mapping[str, str] | None = None,
) -> Report:  # fmt: skip
    """Make the page of documents and write it.

    Raises
    ------
    DesignError
        As `report_of`; E341 where one is none of slopekit's, E129 where the file cannot be written.
    """
    called = list(names) or ["the document"] * len(documents)
    own = [checked_document(document, name) for document, name in zip(documents, called, strict=True)]
    made = report_of(own, list(names) or [str(path)], with_pictures, project)
    with writing(path):
        path.write_text(made.html, encoding="utf-8")
    return made


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture: its word, what it shows, and itself as a data URI."""

    what: str
    caption: str
    uri: str

    @property
    def is_chart(self) -> bool:
        """Whether it is a chart, in place of a scene."""
        return self.what not in _SCENES


def still_pictures(document: Mapping[str, Any]) -> tuple[list[Picture], list[str]]:
    """The pictures that can be drawn of a document, and sentences on those that cannot, with the code of each."""
    from slopekit.views.plots import offers

    offered = offers(document)
    names = [what for what in _OF_RESULT if what in offered] if "fos" in document else list(offered)
    if document.get("assembly") is not None:
        names = _of_many(names, document["assembly"])
    found: list[Picture] = []
    missing: dict[str, list[str]] = {}
    for what in names:
        try:
            found.append(Picture(what, offered[what], picture_of(document, what)))
        except DesignError as error:
            fault = error.faults[0]
            missing.setdefault(f"{fault.code} {fault.message}", []).append(what)
    return found, [f"{', '.join(whats)}: {why}" for why, whats in missing.items()]


def _of_many(names: list[str], assembly: Mapping[str, Any]) -> list[str]:
    """Without pictures that would show one colour: factors and order say something where several differ."""
    factors = [value for value in assembly["factor_by_block"].values() if value is not None]
    left = {"tractions"}
    left |= set() if factors and max(factors) > 1.02 * min(factors) else {"factors"}
    left |= set() if len(assembly["mechanisms"]) > 1 else {"ravelling"}
    return [what for what in names if what not in left]


def picture_of(document: Mapping[str, Any], what: str) -> str:
    """A picture of a document as a data URI.

    Raises
    ------
    DesignError
        As `slopekit.views.plots.draw`.
    """
    from slopekit.views.plots import draw

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{what}.{'png' if what in _SCENES else 'svg'}"
        draw(document, what, path)
        if path.suffix == ".svg" and path.stat().st_size > _LARGEST_SVG:
            path = path.with_suffix(".png")
            draw(document, what, path)
        data = base64.b64encode(path.read_bytes()).decode()
    return f"data:{_TYPES[path.suffix]};base64,{data}"
