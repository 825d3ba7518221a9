"""`slopekit export` and `sk.export`: one function from a result to files, and what was written in words."""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from slopekit.core.errors import DesignError, Fault, Notice, writing
from slopekit.core.records import dataclass
from slopekit.core.whole_files import whole_files
from slopekit.exchange.dxf import write_dxf
from slopekit.exchange.picking import WHAT, Picked, WrittenBlock, names_of, picked, volume_of, with_bolts, words_of_what
from slopekit.exchange.solids import Files, write_glb, write_obj, write_stl
from slopekit.exchange.source import ExportSource, Given, sources_of
from slopekit.exchange.vtu import write_vtu

if TYPE_CHECKING:
    pass

_SMOOTH = 1e-6  # of the volume: what flat triangles leave of a curved body is said above it


@dataclass(frozen=True, slots=True)
class Format:
    """What a format holds: parts, and whether several at once; who writes it.

    `needs` a module, of an extra; `is_rounded`: coordinates from each block's own middle are float32.
    """

    name: str
    write: Callable[[Path, Picked], Files]
    parts: tuple[str, ...] = WHAT
    several: bool = True
    needs: tuple[str, str] | None = None
    is_rounded: bool = False


#: Formats by the suffix of the file.
FORMATS: Mapping[str, Format] = {
    ".stl": Format("STL", write_stl, WHAT[:2], several=False),
    ".obj": Format("OBJ", write_obj, WHAT[:2]),
    ".glb": Format("GLB", write_glb, is_rounded=True),
    ".gltf": Format("glTF", write_glb, is_rounded=True),
    ".vtu": Format("VTU", write_vtu),
    ".dxf": Format("DXF", write_dxf, needs=("ezdxf", "cad")),
}


@dataclass(frozen=True, slots=True)
class Written:
    """One export.

    Attributes
    ----------
    files : written, the first is the one asked for; format, precision : in words
    blocks, interfaces, pairs, bolts : how many; volume_m3 : of the blocks as they were written, None without blocks
    case : the load case it is of, empty without
    """

    files: tuple[Path, ...]
    format: str
    precision: str
    blocks: int
    interfaces: int
    pairs: int
    volume_m3: float | None
    bolts: int = 0
    case: str = ""

    def to_dict(self) -> dict[str, Any]:
        """As JSON values."""
        record = asdict(self) | {"files": [str(path) for path in self.files]}
        return record if self.case else {key: value for key, value in record.items() if key != "case"}


@dataclass(frozen=True, slots=True)
class Export:
    """What `export` wrote, and what a reader must know of it."""

    written: tuple[Written, ...]
    warnings: tuple[Notice, ...] = ()

    @property
    def files(self) -> tuple[Path, ...]:
        """Every file."""
        return tuple(path for one in self.written for path in one.files)

    def to_dict(self) -> dict[str, Any]:
        """As JSON values."""
        return {
            "written": [one.to_dict() for one in self.written],
            "warnings": [notice.to_dict() for notice in self.warnings],
        }


def export(
    result: Given,
    path: str | os.PathLike[str],
    *,
    what: str | Sequence[str] | None = None,
    blocks: str | Sequence[str] | None = None,
    moving: bool = False,
    case: str | None = None,
) -> Export:
    """Write the blocks, interfaces, node pairs or bolts of a result to a file of another program.

    Parameters
    ----------
    result : a result, its JSON as a dict, or the path of the JSON file or of the folder of result.json
    path : the file, its format by the suffix: .stl .obj .glb .gltf .vtu .dxf (.dxf needs the extra `cad`)
    what : "blocks", "interfaces", "pairs", "bolts", or several of them [blocks; with bolts that have a head where the
        format holds both]
    blocks : names of the blocks wanted, as a sequence or as "B1,B7"; moving : leave bedrock out
    case : one of the load cases of the result, by name; without it each has a file of its own, NAME-CASE.dxf beside
        `path`

    Raises
    ------
    DesignError
        E129, E140, E141, E197, E273, E313, E340 and E350: see `slopekit explain`.

    Notes
    -----
    Coordinates are m, east, north, up, those of the design with its `origin`. The volume of what was written is counted
    again, m³, and stands in `written[i].volume_m3` to be held against `result.geometry.volume_m3`.

    Examples
    --------
    >>> import slopekit as sk, tempfile, pathlib
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     done = sk.export(sk.wedge(dips=("45/115", "45/245")), pathlib.Path(folder) / "wedge.stl")
    >>> done.written[0].blocks, round(done.written[0].volume_m3)
    (1, 209461)
    """
    words = words_of_what("blocks" if what is None else what)
    target = _target(Path(path), words)
    sources, names = sources_of(result, case), names_of(blocks)
    has_bolts = what is None and "bolts" in FORMATS[target.suffix.lower()].parts
    chosen = {name: picked(one.scene, words, names, moving, one.is_section) for name, one in sources.items()}
    written, said = list[Written](), dict[Notice, list[str]]()
    for name, source in sources.items():
        part = with_bolts(chosen[name], names, moving) if has_bolts else chosen[name]
        is_alone = case is not None or not name
        file = target if is_alone else target.with_name(f"{target.stem}-{name}{target.suffix}")
        written.append(_written_file(file, part, name))
        for notice in dict.fromkeys(_notices(source, part)):
            said.setdefault(notice, []).append(name)
    notices = [
        one if len(whose) == len(sources) else Notice(one.code, f"{', '.join(whose)}: {one.message}")
        for one, whose in said.items()
    ]
    return Export(tuple(written), (*notices, *_alike(list(sources), list(chosen.values()))))


def _written_file(path: Path, part: Picked, name: str) -> Written:
    """One file of one case."""
    form = FORMATS[path.suffix.lower()]
    with writing(path), whole_files(path.parent) as staging:  # VTU has a file more for each part
        files, precision = form.write(staging / path.name, part)
    return _described(form, [path.with_name(file.name) for file in files], precision, part, name)


def _alike(names: list[str], parts: list[Picked]) -> list[Notice]:
    """W376 where every load case has the same blocks."""
    first, *others = [
        [(one.name, one.vertices.tobytes(), one.triangles.tobytes()) for one in part.bodies] for part in parts
    ]  # fmt: skip
    if not others or not first or any(other != first for other in others):
        return []
    message = f"the blocks are the same in {', '.join(names[:-1])} and {names[-1]}"
    return [Notice("W376", f"{message}: --case NAME writes one")]


def _target(path: Path, words: Sequence[str]) -> Path:
    """The file to write, refused before any work is done; E129, E140, E141, E313."""
    file_format = _format(path.suffix.lower(), str(path))
    lacking = [word for word in words if word not in file_format.parts]
    if lacking:
        able = [suffix for suffix, one in FORMATS.items() if lacking[0] in one.parts]
        message = f"{file_format.name} files hold no {lacking[0]}"
        raise DesignError([Fault("E313", message, f"--what {','.join(words)}", f"Write {' or '.join(able)}.")])
    if len(words) > 1 and not file_format.several:
        message = f"{file_format.name} files hold one part at a time, not {' and '.join(words)}"
        able = [suffix for suffix, one in FORMATS.items() if one.several and set(words) <= set(one.parts)]
        raise DesignError([Fault("E313", message, f"--what {','.join(words)}", f"Write {' or '.join(able)}.")])
    _refuse_without(file_format, str(path))
    if path.is_dir():
        raise DesignError([Fault("E129", f"{path} cannot be written: it is a folder", str(path))])
    _refuse_unwritable(path.parent)
    return path


def _format(suffix: str, where: str) -> Format:
    file_format = FORMATS.get(suffix)
    if file_format is None:
        near = get_close_matches(suffix, FORMATS, n=1)
        shown = f"the suffix {suffix}" if suffix else "a file without suffix"
        advice = f"There are: {' '.join(FORMATS)}.{f' Did you mean {near[0]}?' if near else ''}"
        raise DesignError([Fault("E141", f"{shown} is no format that slopekit writes", where, advice)])
    return file_format


def _refuse_without(file_format: Format, where: str) -> None:
    """E140 where the module that a format needs is not installed."""
    if file_format.needs is None:
        return
    module, extra = file_format.needs
    try:
        __import__(module)
    except ImportError:
        message, advice = (
            f"{file_format.name} files need the extra {extra} ({module})",
            f"pip install 'slopekit[{extra}]'",
        )
        raise DesignError([Fault("E140", message, where, advice)]) from None


def _refuse_unwritable(folder: Path) -> None:
    """E129 where a file cannot be made in a folder."""
    import tempfile

    with writing(folder, "the folder "), tempfile.TemporaryFile(dir=folder):
        pass


def _described(form: Format, files: Sequence[Path], precision: str, chosen: Picked, case: str) -> Written:
    """What was written."""
    volume = sum(_volume(body, form.is_rounded) for body in chosen.bodies) if chosen.bodies else None
    return Written(
        tuple(files), form.name, precision, len(chosen.bodies), len(chosen.contacts), len(chosen.pairs), volume,
        len(chosen.bolts), case,
    )  # fmt: skip


def _volume(body: WrittenBlock, is_rounded: bool) -> float:
    """The volume (m³) of a block as it stands in the file."""
    if not is_rounded:
        return body.volume
    return volume_of(body.local.astype(np.float32).astype(np.float64), body.triangles)


def _notices(source: ExportSource, chosen: Picked) -> Iterator[Notice]:
    """What the files do not say themselves: W376 flat triangles for a curved body."""
    true = float((source.document.get("geometry") or {}).get("volume_m3") or 0.0)
    if source.is_curved and chosen.bodies and true > 0.0:
        flat = sum(body.volume for body in chosen.bodies)
        share, word = abs(1.0 - flat / true), "less" if flat < true else "more"
        if share > _SMOOTH:
            message = f"the mass is written with flat triangles: {flat:.6g} m³"
            yield Notice("W376", f"{message}, {share * 100:.2g} % {word} than the curved body's {true:.6g} m³")
