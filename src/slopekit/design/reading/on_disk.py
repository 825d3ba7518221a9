"""Files from the disk, of at most so many bytes, and what a name may have been meant for that none has."""

import os
import stat
from contextlib import suppress
from difflib import get_close_matches
from pathlib import Path

from slopekit.core.errors import DesignError, Fault
from slopekit.design.reading.nodes import cut, fail, printable

MAX_BYTES = 5_000_000
#: Whether designs may name files outside their own folder: an environment variable, so that workers have it too.
ALLOW_OUTSIDE = "SLOPEKIT_ALLOW_OUTSIDE"

_STDIN = "A file is needed; what a command pipes in is read as /dev/stdin, where the system has that."


def read_bytes(path: str | os.PathLike[str], most: int = MAX_BYTES, advice: str = "Decimate it.") -> bytes:
    """The bytes of a file that has at most so many; `advice` : what to do where it is larger.

    Raises
    ------
    DesignError
        E147 no such file (with the nearest name), E148 a folder or unreadable, E149 too large.
    """
    shown, name = cut(printable(str(path))), cut(printable(Path(path).name or str(path)))
    try:
        _refuse_device(path, shown)
        with open(path, "rb") as file:
            content = file.read(most + 1)
    except (FileNotFoundError, NotADirectoryError, ValueError):  # ValueError: a NUL or a surrogate in the name
        with suppress(OSError, ValueError):
            if Path(path).is_symlink():
                fail("E147", f"{name} leads to {os.readlink(path)}, which does not exist", shown)
        if not str(path):
            fail("E147", "the name of a file is empty", "''")
        advice = _STDIN if str(path) == "-" else _nearest_file(Path(path))
        raise DesignError([Fault("E147", f"{name} does not exist", shown, advice)]) from None
    except IsADirectoryError:
        inside = sorted(
            name for name in _names_in(Path(path)) if name.endswith((".yaml", ".yml", ".csv")) and name[0] != "."
        )[:5]
        advice = f"It holds {', '.join(inside)}." if inside else ""
        raise DesignError([Fault("E148", f"{name} is a folder, a file is needed", shown, advice)]) from None
    except OSError as error:
        message = f"{name} cannot be read: {(error.strerror or 'the system refuses').lower()}"
        raise DesignError([Fault("E148", message, shown)]) from None
    if len(content) > most:
        what = ", that is no design" if most == MAX_BYTES else ""
        advice = "Meshes stand in files of their own: mesh: slip.stl." if what else advice
        fail("E149", f"{name} is larger than {most / 1e6:g} MB{what}", shown, advice)
    return content


def _refuse_device(path: str | os.PathLike[str], shown: str) -> None:
    """E148 for a pipe with a name, a socket or a device, whose reading may wait without end.

    What the command's own caller hands over (`/dev/stdin`, the shell's `<(...)`) is open already, and is read.
    """
    mode = os.stat(path).st_mode
    handed_over = os.path.abspath(path).startswith(("/dev/fd/", "/dev/stdin", "/proc/self/fd/")) and stat.S_ISFIFO(mode)
    if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode) or handed_over):
        fail("E148", f"{cut(printable(Path(path).name))} is a pipe or a device, a file is needed", shown)


def _names_in(folder: Path) -> list[str]:
    with suppress(OSError, ValueError):
        return os.listdir(folder)
    return []


def _nearest_file(path: Path) -> str:
    with suppress(OSError, ValueError):
        if not path.parent.is_dir():
            there = f"There is no folder {printable(str(path.parent))}."
            return " ".join(filter(None, (there, _template(path))))
    names = {name.lower(): name for name in sorted(_names_in(path.parent))}
    near = get_close_matches(path.name.lower(), names, n=1) or [
        name for name in names if name.startswith(path.name.lower() + ".")
    ]
    return f"Did you mean {printable(str(path.parent / names[near[0]]))}?" if near else _template(path)


def _template(path: Path) -> str:
    """How to write a template of that name here; empty where there is none."""
    from slopekit.design.templates import path_of  # what is there is not asked for

    with suppress(DesignError):
        name = path_of(path.name).stem
        return f"{name} is a template: slopekit templates new {name} writes {name}.yaml."
    return ""
