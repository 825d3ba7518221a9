"""Optional packages (extras): whether they are installed, and the fault that names them."""

from importlib.util import find_spec

from slopekit.core.errors import DesignError, Fault


def require_extra(extra: str, purpose: str, *modules: str, where: object = "") -> None:
    """Raise E140 where a module of an extra is not installed, before any work is done.

    Parameters
    ----------
    purpose : what needs it, with its verb; where : what the fault is of

    >>> require_extra("plot", "drawing needs", "no_such_module")
    Traceback (most recent call last):
    slopekit.core.errors.DesignError: E140 drawing needs the extra plot (no_such_module)
         pip install 'slopekit[plot]'
    """
    if missing := [name for name in modules if not is_installed(name)]:
        message = f"{purpose} the extra {extra} ({', '.join(missing)})"
        raise DesignError([Fault("E140", message, str(where), f"pip install 'slopekit[{extra}]'")])


def is_installed(module: str) -> bool:
    """Whether a module could be imported."""
    try:
        return find_spec(module) is not None
    except ValueError:  # what was put out of reach
        return False
