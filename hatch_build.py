"""Compiles `slopekit/preie/_kernels.c` where there is a C compiler; without one slopekit installs as pure Python.

And makes the page of the package of README.md.

CC and CFLAGS are heeded as usual. A wheel with the kernels fits this machine and every Python from 3.11 on; an editable
install finds them in the source tree.
"""

import os
import re
import shlex
import subprocess
import sys
import sysconfig
import tempfile
import zlib
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from hatchling.metadata.plugin.interface import MetadataHookInterface

_FOLDER = Path("slopekit", "preie")
_NAME = "_kernels.abi3.so"


class ReadmeHook(MetadataHookInterface):
    """README.md as a page by itself: links into the sources become their words in italics, pictures are left out."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Add the page."""
        text = Path(self.root, "README.md").read_text(encoding="utf-8")
        metadata["readme"] = {"content-type": "text/markdown", "text": page_of(text)}


def page_of(readme: str) -> str:
    """A README without relative links; the code in it as it is."""
    parts = re.split(r"(^```.*?^```$)", readme, flags=re.MULTILINE | re.DOTALL)
    for k in range(0, len(parts), 2):
        parts[k] = re.sub(r"\[?!\[[^]]*\]\((?!https?:)[^)]*\)(?:\]\([^)]*\))?\n*", "", parts[k])
        parts[k] = re.sub(r"\[([^][]+)\]\((?!https?:)[^)]*\)", r"*\1*", parts[k])
    return "".join(parts)


class KernelsHook(BuildHookInterface[Any]):
    """Adds the compiled kernels to a wheel."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile, into the source tree for an editable install, else aside."""
        source = Path(self.root, "src", _FOLDER, "_kernels.c")
        self._aside = tempfile.TemporaryDirectory()
        editable = version == "editable"
        target = (source.parent if editable else Path(self._aside.name)) / _NAME
        target.unlink(missing_ok=True)
        failure = _compiled(source, target)
        if failure:
            self.app.display_warning(
                f"the kernels are not compiled ({failure}): NumPy does their work, slower"
            )
            return
        build_data["pure_python"] = False
        build_data["tag"] = f"cp311-abi3-{_platform()}"
        if not editable:
            build_data["force_include"][str(target)] = str(Path(_FOLDER, _NAME))

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        """Drop what was compiled aside."""
        self._aside.cleanup()


def _compiled(source: Path, target: Path) -> str:
    """What went wrong; empty where nothing did."""
    if os.name == "nt":
        return "not on Windows yet"
    compiler = os.environ.get("CC") or sysconfig.get_config_var("CC") or "cc"
    number = zlib.crc32(source.read_bytes()) & 0x7FFFFFFF  # kernels.py takes no others
    command = [
        *shlex.split(compiler),
        "-O3",
        "-fno-math-errno",
        "-fno-trapping-math",
        *shlex.split(os.environ.get("CFLAGS", "")),
        "-fPIC",
        "-shared",
        *(["-undefined", "dynamic_lookup"] if sys.platform == "darwin" else []),
        f"-DSOURCE={number}",
        f"-I{sysconfig.get_path('include')}",
        str(source),
        "-o",
        str(target),
        "-lm",
    ]
    try:
        done = subprocess.run(command, capture_output=True, text=True)
    except OSError as error:
        return str(error)
    if done.returncode:
        lines = [line for line in done.stderr.splitlines() if "error" in line] or [
            f"{compiler} failed"
        ]
        return lines[0]
    return ""


def _platform() -> str:
    """This machine in a wheel's name, without what it promises of its C library."""
    from packaging.tags import platform_tags

    return next(name for name in platform_tags() if not name.startswith(("manylinux", "musllinux")))
