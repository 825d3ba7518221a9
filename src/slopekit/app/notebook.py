"""Scenes that turn and designs under sliders in a notebook (extra: notebook), by the script of report and app.

`Result.view` shows one scene; `explore` puts a design under sliders and answers while they move.
"""

import os
from collections.abc import Mapping, Sequence
from importlib import import_module
from importlib.resources import files
from typing import Any

from slopekit.app.answers import Answer, analysed, faulty, scene_of, waiting
from slopekit.app.controls import groups_of
from slopekit.app.session import Opened, Session, opened_file, opened_template
from slopekit.core.errors import DesignError, Fault, SlopekitError
from slopekit.core.taken import wrong_kind
from slopekit.design.common import Design
from slopekit.result import Result

Widget = Any  # of anywidget, which has no types
_OPEN = ("slope", "joints", "strength", "water", "columns", "footing", "weak_plane", "sets", "slip")
_TAKEN = "what load has read, the path of a design file, the same as a dict, or nothing"


def view_of(result: Result) -> Widget:
    """The scene of a result as a widget that turns.

    Raises
    ------
    DesignError
        E140 without the extra notebook (anywidget).
    """
    return _widget(what="view", scene=scene_of(result))


class Explorer:
    """A design under sliders: shows itself where a cell of a notebook ends with it.

    Attributes
    ----------
    widget : of anywidget; closes with `widget.close()`

    What stands on the sliders is `design`, its analysis `result`; a script may move them too, by `set`.
    """

    def __init__(self, session: Session, keys: Sequence[str] | None) -> None:
        self._session, self._keys = session, keys
        self._result: Result | None = None
        self.widget = _widget(what="explore", live=session.live, groups=self._groups(), answer=self._answer())
        self.widget.on_msg(lambda _, content, __: self._heard(content))

    @property
    def design(self) -> Design:
        """The design as it is now, the last sound one where the present values are none."""
        return self._session.design

    @property
    def result(self) -> Result | None:
        """Its analysis; None where it has faults or waits for its button."""
        return self._result

    @property
    def changed(self) -> list[str]:
        """The paths of the values that are not those of the design it began with."""
        return self._session.changed

    def set(self, values: Mapping[str, Any]) -> None:
        """Move sliders: dotted paths and values, as `set` of `sk.run`.

        Raises
        ------
        DesignError
            Where the values are none of the design: nothing is changed then.
        """
        before = self._session.now.document
        self._session.set(values, final=True)
        if self._session.now.faults:
            faults = self._session.now.faults
            self._session.undo()
            assert self._session.now.document is before
            raise DesignError(faults)
        self._tell()

    def _repr_mimebundle_(self, **asked: Any) -> Any:
        return self.widget._repr_mimebundle_(**asked)

    # -- what the page asks -------------------------------------------------------------------------------------------

    def _heard(self, content: Any) -> None:
        asked = content if isinstance(content, dict) else {}
        final, analyse = bool(asked.get("final", True)), asked.get("do") == "analyse"
        try:
            if asked.get("do") == "set" and isinstance(asked.get("values"), dict):
                self._session.set(asked["values"], final)
            elif asked.get("do") == "reset" and isinstance(asked.get("path"), str):
                self._session.reset(asked["path"])
        except SlopekitError as error:
            self.widget.send({"of": "answer", "answer": faulty(self._session.now, error.faults, final)})
            return
        self._tell(final, analyse)

    def _tell(self, final: bool = True, analyse: bool = False) -> None:
        answer, groups = self._answer(final, analyse), self._groups()
        self.widget.send({"of": "answer", "answer": answer, "groups": groups})
        if final:  # what another view of the same widget begins with
            self.widget.answer = answer
            if _paths(groups) != _paths(self.widget.groups):
                self.widget.groups = groups

    def _answer(self, final: bool = True, analyse: bool = False) -> Answer:
        now = self._session.now
        if self._session.live == "button" and not analyse:
            self._result = None
            return waiting(now, final, None)
        answer, self._result = analysed(now, final)
        return answer

    def _groups(self) -> list[dict[str, Any]]:
        groups = groups_of(self._session.design, self._session.opened.design)
        visible = []
        for group in groups:
            controls = [one for one in group["controls"] if self._is_shown(one["path"])]
            is_open = self._keys is not None or group["name"] in _OPEN
            if controls:
                visible.append({**group, "controls": controls, "open": is_open})
        return visible

    def _is_shown(self, path: str) -> bool:
        if self._keys is None:
            return path != "title"
        return any(path == key or path.startswith(f"{key}.") for key in self._keys)


def explore(source: Any = None, keys: Sequence[str] | None = None) -> Explorer:
    """Put a design under sliders in a notebook: both factors of safety and the scene answer while they move.

    Parameters
    ----------
    source : what `load` has read, the path of a design file, or the same as a dict [the paper's wedge]
    keys : dotted paths to show, or how they begin: ["strength", "water.fill"] [all]

    Returns
    -------
    `Explorer`: `.design`, `.result` and `.changed` are what the sliders stand at, `.set({...})` moves them.

    Raises
    ------
    DesignError
        With every fault of the design; E310 a key that is none of it, E140 without the extra notebook (anywidget).

    Notes
    -----
    Wedge, plane and footing answer while a slider moves, topple, blocks and surface when it is let go, bench on a
    button. Nothing is written.

    Examples
    --------
    >>> import slopekit as sk
    >>> design = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
    >>> under = sk.explore(design, ["joints", "water"])
    >>> under.set({"water.fill": "100 %"})
    >>> round(under.result.fos.limit, 3), under.changed
    (1.006, ['water.fill'])
    """
    session = Session(_opened(source))
    if keys is not None:
        if isinstance(keys, str) or not all(isinstance(key, str) for key in keys):
            raise wrong_kind("explore", "keys", "a list of dotted paths", keys)
        known = [one["path"] for group in groups_of(session.design, session.design) for one in group["controls"]]
        unknown = [key for key in keys if not any(path == key or path.startswith(f"{key}.") for path in known)]
        if unknown:
            from slopekit.studies.keys import key_of

            for key in unknown:
                key_of(session.design, key)  # says what is near
            raise DesignError([Fault("E310", f"there is no slider {key}", key) for key in unknown])
    return Explorer(session, keys)


def _opened(source: Any) -> Opened:
    if source is None:
        return opened_template("wedge")
    if isinstance(source, str | os.PathLike):
        from pathlib import Path

        return opened_file(Path(source))
    from slopekit.design.reading.files import load

    if isinstance(source, Mapping):
        source = load(source)
    if not isinstance(source, Design) or source.source is None:
        raise wrong_kind("explore", "source", _TAKEN, source)
    return Opened("", None, "", source.title or source.kind, source.source, source)


def _paths(groups: Sequence[Mapping[str, Any]]) -> list[str]:
    return [one["path"] for group in groups for one in group["controls"]]


def _widget(**values: Any) -> Widget:
    """A widget with traits of those names, which the script sees.

    Raises
    ------
    DesignError
        E140 without anywidget.
    """
    try:
        anywidget, traitlets = import_module("anywidget"), import_module("traitlets")
    except ImportError:
        advice = "pip install 'slopekit[notebook]'"
        message = "views and sliders in a notebook need the extra notebook (anywidget)"
        raise DesignError([Fault("E140", message, "", advice)]) from None
    own = {name: traitlets.Any(value).tag(sync=True) for name, value in values.items()}
    return type("SlopekitWidget", (anywidget.AnyWidget,), {"_esm": _script(), **own})()


def _script() -> str:
    at = files("slopekit")
    parts = (at / "views/templates/viewer.js", at / "app/page/widget.js")
    return "\n".join(part.read_text(encoding="utf-8") for part in parts)
