"""What slopekit cannot do without, and what it says where that is missing; loads nothing of it."""

import re
from importlib import metadata

NEEDED = ("numpy", "scipy", "manifold3d", "trimesh", "clarabel", "threadpoolctl", "ruamel.yaml", "typer")
_ADVICE = "Install slopekit again with pip, which brings it; `slopekit doctor` says what else is missing."


def said_of(error: ModuleNotFoundError) -> str:
    """E140 in words where a library is missing that slopekit needs, "" where something else is.

    >>> print(said_of(ModuleNotFoundError("No module named 'numpy'", name="numpy")))
    E140 numpy, which slopekit needs, is not installed
         Install slopekit again with pip, which brings it; `slopekit doctor` says what else is missing.
    >>> said_of(ModuleNotFoundError("No module named 'slopekit.nothing'", name="slopekit.nothing"))
    ''
    """
    root = (error.name or "").partition(".")[0]
    name = next((one for one in NEEDED if one.partition(".")[0] == root), "")
    return f"E140 {name}, which slopekit needs, is not installed\n     {_ADVICE}" if name else ""


def wanted() -> dict[str, str]:
    """The versions that this slopekit asks for, by `plain` names; none where it is not installed."""
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
    """A library's name as all spellings of it have it.

    >>> plain("ruamel.yaml"), plain("Scikit_FEM ")
    ('ruamel-yaml', 'scikit-fem')
    """
    return re.sub(r"[-_.]+", "-", name.strip()).lower()


def fits(version: str, bounds: str) -> bool:
    """Whether a version is one that is asked for.

    >>> fits("0.28.0", ">=0.26,<0.29"), fits("0.29", ">=0.26,<0.29"), fits("2.4.6rc1", ">=1.26"), fits("1.9", ">=1.11")
    (True, False, True, False)
    """
    for one in filter(None, bounds.split(",")):
        bound = one.strip().lstrip("<>=!~")
        sign, have, asked = one.strip().removesuffix(bound), _numbers(version), _numbers(bound.strip())
        have, asked = (row + (0,) * (max(len(have), len(asked)) - len(row)) for row in (have, asked))
        if not {">=": have >= asked, "<": have < asked, "<=": have <= asked, ">": have > asked,
                "==": have == asked, "!=": have != asked}.get(sign, True):  # fmt: skip
            return False
    return True


def _numbers(version: str) -> tuple[int, ...]:
    """1.26.4rc1 as (1, 26, 4)."""
    return tuple(int(part) for part in re.split(r"[^\d.]", version, maxsplit=1)[0].split(".") if part)
