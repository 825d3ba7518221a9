"""The report of `slopekit doctor`: versions, what can be drawn and read, and a self test against known answers."""

import importlib
import os
import platform
import time
from importlib import metadata

from slopekit._needs import NEEDED, fits, plain, required_versions
from slopekit._version import __version__

_EXTRAS = {
    "pyvista": "plot",
    "matplotlib": "plot",
    "jinja2": "report",
    "ezdxf": "cad",
    "distributed": "dask",
    "openpyxl": "survey",
    "anywidget": "notebook",
    "scikit-fem": "elastic",
    "starlette": "app",
    "uvicorn": "app",
    "websockets": "app",
}


def examination() -> tuple[list[str], bool]:
    """The lines to print, and whether everything that slopekit needs works."""
    lines = [
        f"slopekit {__version__}, Python {platform.python_version()}, {platform.platform(terse=True)}, "
        f"{os.cpu_count()} cores"
    ]
    sound, bounds = True, required_versions()
    for name in (*NEEDED, *_EXTRAS):
        version, extra = _version(name), _EXTRAS.get(name)
        if extra and version is None:
            lines.append(f"{'-':8}{name} not installed (extra: {extra})")
            continue
        is_importable = version is not None and (extra is not None or _imports(name))
        requirement = bounds.get(plain(name), "")
        verdict = (
            "MISSING"
            if not is_importable
            else "ok"
            if fits(version or "", requirement)
            else "WRONG"
        )
        wish = f", slopekit wants {requirement}" if verdict == "WRONG" else ""
        sound = sound and verdict == "ok"
        lines.append(f"{verdict:8}{name} {version or ''}".rstrip() + wish)
    lines.append(_kernels())
    for name, test in (
        ("templates", _templates),
        ("the paper's wedge, both methods", lambda: _both("wedge", 1e-9)),
        ("a plane failure", lambda: _both("plane", 1e-8)),
        ("the sphere with φ = 0", lambda: _both("sphere", 1e-4)),
        ("Goodman & Bray's columns", lambda: _both("goodman-bray", 1e-8)),
        ("drawing off-screen", _drawing),
    ):
        began = time.perf_counter()
        try:
            outcome, passed = test()
        except Exception as error:  # whatever is broken here is what the doctor is asked about
            outcome, passed = f"{type(error).__name__}: {error}".splitlines()[0], False
        sound = sound and passed
        took = (time.perf_counter() - began) * 1e3
        lines.append(f"{'ok' if passed else 'FAILS':8}{name}: {outcome} ({took:.0f} ms)")
    lines.append(
        "all is well"
        if sound
        else "something is wrong: see the lines marked MISSING, WRONG or FAILS"
    )
    return lines, sound


def _kernels() -> str:
    try:
        from slopekit.preie.kernels import chosen

        kernels, missing = chosen()
    except ImportError as error:  # of what is marked as missing above
        kernels, missing = None, str(error)
    return (
        f"{'ok':8}compiled kernels"
        if kernels
        else f"{'-':8}no compiled kernels, NumPy does it: {missing}"
    )


def _version(name: str) -> str | None:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None


def _imports(name: str) -> bool:
    try:
        importlib.import_module(name)
    except ImportError:
        return False
    return True


def _templates() -> tuple[str, bool]:
    from slopekit.design.reading.files import load
    from slopekit.design.templates import names, path_of

    templates = names()
    for name in templates:
        load(path_of(name))
    return f"{len(templates)} read", bool(templates)


def _both(name: str, tolerance: float) -> tuple[str, bool]:
    """Both methods on a template."""
    from slopekit.design.reading.files import load
    from slopekit.design.templates import path_of
    from slopekit.kinds import analyse

    fos = analyse(load(path_of(name))).fos
    if fos.limit is None or fos.closed_form is None:
        return "no factor", False
    return f"{fos.limit:.8f} and {fos.closed_form:.8f}", abs(
        fos.limit - fos.closed_form
    ) < tolerance


def _drawing() -> tuple[str, bool]:
    if _version("pyvista") is None:
        return "not installed (extra: plot), nothing else needs it", True
    import tempfile
    from pathlib import Path

    from slopekit.kinds import analyse
    from slopekit.kinds.wedge.design import wedge_design
    from slopekit.views.solid.scenes import draw

    with tempfile.TemporaryDirectory() as place:
        target = Path(place) / "wedge.png"
        draw(analyse(wedge_design({"dips": ("45/115", "45/245")})).to_dict(), "scene", target)
        return f"a picture of {target.stat().st_size // 1000} kB", target.stat().st_size > 10_000
