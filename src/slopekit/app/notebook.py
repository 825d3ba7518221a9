"""The scene of a result that turns in a notebook (extra: notebook), by the script of report and app."""

from importlib import import_module
from importlib.resources import files
from typing import Any

from slopekit.app.answers import scene_of
from slopekit.core.extras import require_extra
from slopekit.result import Result

Widget = Any  # of anywidget, which has no types


def view_of(result: Result) -> Widget:
    """The scene of a result as a widget that turns.

    Raises
    ------
    DesignError
        E140 without the extra notebook (anywidget).
    """
    require_extra("notebook", "views in a notebook need", "anywidget")
    anywidget, traitlets = import_module("anywidget"), import_module("traitlets")
    scene = traitlets.Any(scene_of(result)).tag(sync=True)
    return type("SlopekitWidget", (anywidget.AnyWidget,), {"_esm": _script(), "scene": scene})()


def _script() -> str:
    package = files("slopekit")
    scripts = (package / "views/templates/viewer.js", package / "app/page/widget.js")
    return "\n".join(script.read_text(encoding="utf-8") for script in scripts)
