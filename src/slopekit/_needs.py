"""The libraries that slopekit requires, their versions, and the message where one is missing; imports none of them."""

import re
from importlib import metadata

NEEDED = (
    "numpy",
    "scipy",
    "manifold3d",
    "trimesh",
    "clarabel",
    "threadpoolctl",
    "ruamel.yaml",
    "typer",
)
_ADVICE = (
    "Install slopekit again with pip, which brings it; `slopekit doctor` says what else is missing."
)


def missing_library_message(error: ModuleNotFoundError) -> str:
    """Return E140 in words where a required library is missing, "" where another module is.

    >>> print(missing_library_message(ModuleNotFoundError("No module named 'numpy'", name="numpy")))
    E140 numpy, which slopekit needs, is not installed
         Install slopekit again with pip, which brings it; `slopekit doctor` says what else is missing.
    >>> missing_library_message(ModuleNotFoundError("No module named 'slopekit.nothing'", name="slopekit.nothing"))
    ''
    """
    root = (error.name or "").partition(".")[0]
    name = next(
        (requirement for requirement in NEEDED if requirement.partition(".")[0] == root), ""
    )
    return f"E140 {name}, which slopekit needs, is not installed\n     {_ADVICE}" if name else ""


def required_versions() -> dict[str, str]:
    """Return the required versions of all libraries by their `plain` names; empty where slopekit is not installed."""
    try:
        lines = metadata.requires("slopekit") or []
    except metadata.PackageNotFoundError:
        return {}
    versions: dict[str, str] = {}
    for line in lines:
        name, bounds = re.split(r"(?=[<>=!~])|$", line.partition(";")[0].strip(), maxsplit=1)
        versions.setdefault(plain(name), bounds.strip())
    return versions


def plain(name: str) -> str:
    """Return the normalised name of a library, the same for all its spellings.

    >>> plain("ruamel.yaml"), plain("Scikit_FEM ")
    ('ruamel-yaml', 'scikit-fem')
    """
    return re.sub(r"[-_.]+", "-", name.strip()).lower()


def fits(version: str, bounds: str) -> bool:
    """Return whether a version lies within bounds.

    >>> fits("0.28.0", ">=0.26,<0.29"), fits("0.29", ">=0.26,<0.29"), fits("2.4.6rc1", ">=1.26"), fits("1.9", ">=1.11")
    (True, False, True, False)
    """
    for clause in filter(None, bounds.split(",")):
        bound = clause.strip().lstrip("<>=!~")
        sign, installed, required = (
            clause.strip().removesuffix(bound),
            _numbers(version),
            _numbers(bound.strip()),
        )
        installed, required = (
            row + (0,) * (max(len(installed), len(required)) - len(row))
            for row in (installed, required)
        )
        if not {
            ">=": installed >= required,
            "<": installed < required,
            "<=": installed <= required,
            ">": installed > required,
            "==": installed == required,
            "!=": installed != required,
        }.get(sign, True):
            return False
    return True


def _numbers(version: str) -> tuple[int, ...]:
    """Return the numbers of a version: (1, 26, 4) of 1.26.4rc1."""
    return tuple(
        int(number) for number in re.split(r"[^\d.]", version, maxsplit=1)[0].split(".") if number
    )
