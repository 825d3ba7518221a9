"""The starter designs: shipped in the wheel, and found in the checkout of an editable install."""

from pathlib import Path

from slopekit.core.errors import DesignError, Fault, did_you_mean

_PACKAGE = Path(__file__).resolve().parent.parent
_PLACES = (_PACKAGE / "templates", _PACKAGE.parent.parent / "templates")


def folder() -> Path:
    """The folder of the templates.

    Raises
    ------
    DesignError
        E197 where neither the package nor the checkout has one.
    """
    for place in _PLACES:
        if any(place.glob("*.yaml")):
            return place
    raise DesignError([Fault("E197", "this installation has no templates", "", "Install slopekit again.")])


def names() -> list[str]:
    """The templates' names, sorted."""
    return sorted(path.stem for path in folder().glob("*.yaml"))


def path_of(name: str) -> Path:
    """The file of a template.

    Raises
    ------
    DesignError
        E197 for a name that is no template, with the nearest one.
    """
    known = names()
    wanted = name.removesuffix(".yaml").removesuffix(".yml")
    if wanted not in known:
        advice = did_you_mean(wanted, known, f"There are: {', '.join(known)}.")
        raise DesignError([Fault("E197", f"{name} is not a template", "", advice)])
    return folder() / f"{wanted}.yaml"


def summary(name: str) -> str:
    """What a template is, from the comment in its first line."""
    return path_of(name).read_text(encoding="utf-8").partition("\n")[0].lstrip("# ").strip()
