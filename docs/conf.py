"""The site: Sphinx with MyST and furo, from these pages as they are.

    python -m sphinx -W --keep-going -E -b html docs OUT

The index is the table of contents: its links, heading by heading, make the toctrees. Nothing is fetched.
"""

import inspect
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sphinx.application import Sphinx

sys.path.insert(0, str(Path(__file__).parents[1] / "src"))

from slopekit import __version__

project = "slopekit"
author = "The slopekit founders"
copyright = author
version = release = __version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
source_suffix = {".md": "markdown"}
root_doc = "index"
html_theme = "furo"
html_math_renderer = "mathml"  # made here by docutils: browsers draw it, nothing is fetched
html_title = f"slopekit {release}"
html_show_sourcelink = False
smartquotes = False  # --set is two hyphens
default_role = "code"  # docstrings write `name`

myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 4
suppress_warnings = ["myst.strikethrough"]
highlight_language = "text"  # a fence without a language is what a terminal shows

napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_preprocess_types = False
autodoc_member_order = "bysource"
autodoc_typehints = "none"

_HIDDEN = (
    "desk",
    "unknown",
)  # of a signature: for the command line, and for the names that it has not


def contents(index: str) -> str:
    """The toctrees of the index: the pages that it links to, under the heading that they stand under."""
    parts = re.split(r"^#+ (.*)$", index, flags=re.MULTILINE)
    listed: list[str] = []
    seen: set[str] = set()
    for head, text in zip(parts[3::2], parts[4::2], strict=True):
        pages = [
            page
            for page in re.findall(r"\]\(([\w/-]+)\.md\)", text)
            if not (page in seen or seen.add(page))
        ]
        if pages:
            listed += [
                "",
                "```{toctree}",
                ":hidden:",
                ":maxdepth: 1",
                f":caption: {head}",
                "",
                *pages,
                "```",
            ]
    return "\n".join([index, *listed, ""])


def on_the_site(text: str) -> str:
    """A page whose links out of the docs are words alone: README, templates and the like are not on the site."""
    return re.sub(
        r"\[([^\]]+)\]\((?:\.\./)+(?:[A-Z_]+(?:\.md)?|(?:templates|examples|\.github)/[^)]*)\)",
        r"\1",
        text,
    )


def _as_pages(_app: "Sphinx", name: str, source: list[str]) -> None:
    source[0] = on_the_site(contents(source[0]) if name == root_doc else source[0])


def _described(
    _app: "Sphinx", _what: str, _name: str, _of: Any, _options: Any, lines: list[str]
) -> None:
    lines[:] = as_numpydoc(lines)


def as_numpydoc(lines: list[str]) -> list[str]:
    """`name : what it is` on one line, as docstrings here have it, becomes a name and an indented description."""
    inside = False
    found: list[str] = []
    for number, line in enumerate(lines):
        if number + 1 < len(lines) and re.fullmatch(r"-+", lines[number + 1]):
            inside = line in ("Parameters", "Attributes")
        if inside and re.match(r"\w[\w, ]* : ", line):
            for one in re.split(r"; (?=\w[\w, ]* : )", line):
                name, _, said = one.partition(" : ")
                found += [
                    name,
                    "    " + re.sub(r"(?<=\w)@(?=\w)", r"\\@", said),
                ]  # no address of mail
        else:
            found.append(line)
    return found


def _signature(
    _app: "Sphinx",
    what: str,
    name: str,
    obj: Any,
    _options: Any,
    signature: str | None,
    returns: str | None,
) -> tuple[str | None, str | None]:
    """Names and defaults: what the annotations say of the command line stands under Parameters."""
    if what != "function":
        return signature, returns
    own, bare = inspect.signature(obj), inspect.Parameter.empty
    kept = [
        one.replace(annotation=bare) for key, one in own.parameters.items() if key not in _HIDDEN
    ]
    return str(own.replace(parameters=kept, return_annotation=inspect.Signature.empty)), None


def _formula(writer: Any, node: Any) -> None:
    from docutils.nodes import SkipNode
    from docutils.utils.math.latex2mathml import tex2mathml

    is_block = node.tagname == "math_block"
    formula = tex2mathml(node.astext().strip(), as_block=is_block)
    writer.body.append(f'<div class="math">{formula}</div>\n' if is_block else formula)
    raise SkipNode


def setup(app: "Sphinx") -> dict[str, bool]:
    """Sphinx asks for it."""
    app.add_html_math_renderer("mathml", (_formula, None), (_formula, None))
    app.connect("source-read", _as_pages)
    app.connect("autodoc-process-docstring", _described, priority=400)  # before napoleon's
    app.connect("autodoc-process-signature", _signature)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
