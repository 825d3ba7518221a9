"""`sk.plot`: pictures of results and studies, or of the JSON that they write; loads its code only when it is called."""

import os
from pathlib import Path
from typing import Any, overload


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
) -> Path | None: ...


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
) -> Path | dict[str, str] | None:
    """Draw a picture of a result or a study (extra: plot).

    Parameters
    ----------
    source : what `sk.run`, `sk.wedge`, `sk.sweep`, ... return, their `to_dict()`, or the path of their JSON or folder
    what : scene, exploded, tractions, forces, displacement, mechanism, factors, ravelling, stereonet, histogram, curve,
        contour, tornado, speed-error, reduction or normals [nothing is drawn: the words that it can give]
    path : the file: .png, .svg or .pdf; scenes .png, .glb or .gltf [beside the JSON, or in this folder: NAME-WHAT.png]
    show : a window in place of a file
    equal_angle, test : of stereonets
    explode : of exploded; magnify : of displacement and mechanism; step : of mechanism

    Returns
    -------
    The path written, None where a window was shown; without `what` the pictures by their word, and what they show.

    Raises
    ------
    DesignError
        E106, E340 to E347 for what cannot be drawn, E140 without the extra.
    """
    from slopekit.views import plots

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
    return None if show else target
