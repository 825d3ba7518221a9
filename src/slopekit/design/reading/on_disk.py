"""Reading files of limited size, with advice about the nearest name where a file does not exist."""

import os
import stat
from contextlib import suppress
from difflib import get_close_matches
from pathlib import Path

from slopekit.core.errors import DesignError, Fault
from slopekit.design.reading.nodes import cut, fail, printable

MAX_BYTES = 5_000_000
#: The environment variable that allows designs to name files outside their folder; worker processes inherit it.
ALLOW_OUTSIDE = "SLOPEKIT_ALLOW_OUTSIDE"

_STDIN = (
    "A file is needed; what a command pipes in is read as /dev/stdin, where the system has that."
)


def read_bytes(
    path: str | os.PathLike[str], most: int = MAX_BYTES, advice: str = "Decimate it."
) -> bytes:
    """Read a file of at most `most` bytes; `advice` is for a larger file.

    Raises
    ------
    DesignError
        E147 no such file (with the nearest name), E148 a folder or unreadable, E149 too large.
    """
    path_text, name = cut(printable(str(path))), cut(printable(Path(path).name or str(path)))
    try:
        _refuse_device(path, path_text)
        with open(path, "rb") as file:
            content = file.read(most + 1)
    except (
        FileNotFoundError,
        NotADirectoryError,
        ValueError,
    ):  # ValueError: a NUL or a surrogate in the name
        with suppress(OSError, ValueError):
            if Path(path).is_symlink():
                fail(
                    "E147", f"{name} leads to {os.readlink(path)}, which does not exist", path_text
                )
        if not str(path):
            fail("E147", "the name of a file is empty", "''")
        advice = _STDIN if str(path) == "-" else _nearest_file(Path(path))
        raise DesignError([Fault("E147", f"{name} does not exist", path_text, advice)]) from None
    except IsADirectoryError:
        design_files = sorted(
            name
            for name in _names_in(Path(path))
            if name.endswith((".yaml", ".yml", ".csv")) and name[0] != "."
        )[:5]
        advice = f"It holds {', '.join(design_files)}." if design_files else ""
        raise DesignError(
            [Fault("E148", f"{name} is a folder, a file is needed", path_text, advice)]
        ) from None
    except OSError as error:
        message = f"{name} cannot be read: {(error.strerror or 'the system refuses').lower()}"
        raise DesignError([Fault("E148", message, path_text)]) from None
    if len(content) > most:
        design_clause = ", that is no design" if most == MAX_BYTES else ""
        advice = "Meshes stand in files of their own: mesh: slip.stl." if design_clause else advice
        fail("E149", f"{name} is larger than {most / 1e6:g} MB{design_clause}", path_text, advice)
    return content


def _refuse_device(path: str | os.PathLike[str], path_text: str) -> None:
    """Raise E148 for a named pipe, a socket or a device, where reading may never end.

    Pipes from the command's caller (`/dev/stdin`, the shell's `<(...)`) are already open, and are allowed.
    """
    mode = os.stat(path).st_mode
    handed_over = os.path.abspath(path).startswith(
        ("/dev/fd/", "/dev/stdin", "/proc/self/fd/")
    ) and stat.S_ISFIFO(mode)
    if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode) or handed_over):
        fail(
            "E148",
            f"{cut(printable(Path(path).name))} is a pipe or a device, a file is needed",
            path_text,
        )


def _names_in(folder: Path) -> list[str]:
    with suppress(OSError, ValueError):
        return os.listdir(folder)
    return []


def _nearest_file(path: Path) -> str:
    with suppress(OSError, ValueError):
        if not path.parent.is_dir():
            folder_text = f"There is no folder {printable(str(path.parent))}."
            return " ".join(filter(None, (folder_text, _template(path))))
    names = {name.lower(): name for name in sorted(_names_in(path.parent))}
    close_names = get_close_matches(path.name.lower(), names, n=1) or [
        name for name in names if name.startswith(path.name.lower() + ".")
    ]
    return (
        f"Did you mean {printable(str(path.parent / names[close_names[0]]))}?"
        if close_names
        else _template(path)
    )


def _template(path: Path) -> str:
    """Return the advice how to write the template of this name; empty where there is none."""
    from slopekit.design.templates import path_of  # imported only where a file is missing

    with suppress(DesignError):
        name = path_of(path.name).stem
        return f"{name} is a template: slopekit templates new {name} writes {name}.yaml."
    return ""
