"""The templates of designs to start from, in the wheel or in the checkout of an editable install."""

from pathlib import Path

from slopekit.core.errors import DesignError, Fault, did_you_mean

_PACKAGE = Path(__file__).resolve().parent.parent
_PLACES = (_PACKAGE / "templates", _PACKAGE.parent.parent / "templates")


def folder() -> Path:
    """Return the folder of the templates.

    Raises
    ------
    DesignError
        E197 if neither the package nor the checkout has one.
    """
    for place in _PLACES:
        if any(place.glob("*.yaml")):
            return place
    raise DesignError(
        [Fault("E197", "this installation has no templates", "", "Install slopekit again.")]
    )


def names() -> list[str]:
    """Return the templates' names, sorted."""
    return sorted(path.stem for path in folder().glob("*.yaml"))


def path_of(name: str) -> Path:
    """Return the path of a template's file.

    Raises
    ------
    DesignError
        E197 for an unknown name, with the nearest one.
    """
    template_names = names()
    stem = name.removesuffix(".yaml").removesuffix(".yml")
    if stem not in template_names:
        advice = did_you_mean(stem, template_names, f"There are: {', '.join(template_names)}.")
        raise DesignError([Fault("E197", f"{name} is not a template", "", advice)])
    return folder() / f"{stem}.yaml"


def summary(name: str) -> str:
    """Return the description of a template, from the comment in its first line."""
    return path_of(name).read_text(encoding="utf-8").partition("\n")[0].lstrip("# ").strip()
